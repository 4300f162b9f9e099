//! Properties of the solver and of what it is given, on random or on many data: each with a mistake in the check itself that it
//! must notice.

mod bodies;
mod conditions;
mod directions;
mod given;
mod integration;
mod matrix;
mod meshes;
mod places;
mod postprocess;
mod refinement;
mod verdict;

use proptest::array::uniform2;
use proptest::collection::vec;
use proptest::strategy::{Just, Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};

/// What was found where a property does not hold.
type Outcome = Result<(), String>;

/// What holds of as many draws of `data`, the same in each run; else what was found with data as small as they can be made. No failure is
/// kept in a file: the next run finds the same.
fn for_all<D: Strategy>(draws: u32, data: D, holds: impl Fn(D::Value) -> Outcome) -> Outcome {
    let config = Config { cases: draws, failure_persistence: None, ..Config::default() };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let found = TestRunner::new_with_rng(config, rng)
        .run(&data, |data| holds(data).map_err(TestCaseError::fail));
    found.map_err(|error| match error {
        TestError::Fail(why, data) => format!("{why}, of {data:?}"),
        TestError::Abort(why) => why.to_string(),
    })
}

/// One draw of `data`, the same in each run.
fn one<D: Strategy>(data: D) -> Result<D::Value, String> {
    let tree = data.new_tree(&mut TestRunner::deterministic()).map_err(text)?;
    Ok(tree.current())
}

/// A vector at each node, with components below 1.
fn field(nodes: usize) -> impl Strategy<Value = Vec<[f64; 2]>> {
    vec(uniform2(-1.0..1.0), nodes)
}

/// The numbers below `count` in any order.
fn any_order(count: usize) -> impl Strategy<Value = Vec<usize>> {
    Just((0..count).collect::<Vec<usize>>()).prop_shuffle()
}

/// The words of an error that a check did not expect.
fn text(error: impl ToString) -> String {
    error.to_string()
}

/// Tests: what holds, and after `not` the control, which must not.
macro_rules! properties {
    ($($name:ident: $($holds:expr),+; not $($fails:expr),+;)+) => {$(
        #[test]
        fn $name() {
            $(assert_eq!($holds, Ok(()));)+
            $(assert!($fails.is_err(), "not noticed: {}", stringify!($fails));)+
        }
    )+};
}
use properties;
