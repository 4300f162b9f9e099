//! Random data for the exact and the doubles engine, by proptest: counted by class, shrunk when a predicate fails, and
//! failures remembered in `props/regressions/`.
//!
//! The seed is fixed unless the environment gives another one: `PROPS_SEED=random` draws one, `PROPS_SEED=<number>`
//! takes that; a failure prints it.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::OnceLock;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{
    Config, FileFailurePersistence, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner,
};

use crate::Verdict;
use crate::numbers::Exact;
use crate::statement::Statement;

/// The seed of this process.
pub fn seed() -> u64 {
    static SEED: OnceLock<u64> = OnceLock::new();
    *SEED.get_or_init(|| match std::env::var("PROPS_SEED").as_deref() {
        Err(_) => 2013,
        Ok("random") => {
            let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
            let seed = now.map_or(1, |d| d.as_nanos() as u64);
            eprintln!("PROPS_SEED={seed}");
            seed
        }
        Ok(text) => text.parse().expect("PROPS_SEED is 'random' or a number"),
    })
}

fn runner(cases: u32) -> TestRunner {
    let regressions = concat!(env!("CARGO_MANIFEST_DIR"), "/regressions/draws.txt");
    let config = Config {
        cases,
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(regressions))),
        ..Config::default()
    };
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed().to_le_bytes());
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &bytes))
}

/// Draws `cases` times, runs the predicate and counts the classes.
///
/// # Errors
/// The shrunk data for which it fails, or the class that no draw hit.
pub fn hold<D: Debug>(
    cases: u32,
    strategy: impl Strategy<Value = D>,
    classes: &[&'static str],
    predicate: impl Fn(&D) -> Verdict,
) -> Result<String, String> {
    let counts: RefCell<BTreeMap<&'static str, u32>> = RefCell::default();
    let result = runner(cases).run(&strategy, |data| {
        let class = match predicate(&data) {
            Verdict::Holds(class) => class,
            Verdict::Vacuous => "hypothesis not met",
            Verdict::Fails(why) => return Err(TestCaseError::fail(why)),
        };
        *counts.borrow_mut().entry(class).or_default() += 1;
        Ok(())
    });
    let counts = counts.into_inner();
    match result {
        Err(TestError::Fail(why, data)) => {
            return Err(format!("{why} fails for {data:?} (PROPS_SEED={})", seed()));
        }
        Err(TestError::Abort(why)) => return Err(why.to_string()),
        Ok(()) => {}
    }
    for class in classes {
        if !counts.contains_key(class) {
            return Err(format!("no draw hit the class '{class}': {counts:?}"));
        }
    }
    let counts: Vec<String> = counts.iter().map(|(class, n)| format!("{class} {n}")).collect();
    Ok(format!("{cases} draws: {}", counts.join(", ")))
}

/// The control of [`hold`]: some draw must make the predicate fail.
///
/// # Errors
/// That none did.
pub fn reject<D: Debug>(
    cases: u32,
    strategy: impl Strategy<Value = D>,
    predicate: impl Fn(&D) -> Verdict,
) -> Result<String, String> {
    let mut runner = runner(cases);
    for draw in 0..cases {
        let tree = strategy.new_tree(&mut runner).map_err(|why| why.to_string())?;
        let data = tree.current();
        if let Verdict::Fails(why) = predicate(&data) {
            return Ok(format!("rejected at draw {draw}: {why}"));
        }
    }
    Err(format!("the planted mistake was not rejected in {cases} draws"))
}

/// A small rational number as numerator and denominator; ties and zeros are frequent.
pub fn ratio() -> impl Strategy<Value = (i64, i64)> {
    prop_oneof![
        4 => (-4_i64..=4, Just(1_i64)),
        2 => (-12_i64..=12, 1_i64..=6),
        1 => (-1000_i64..=1000, 1_i64..=97),
    ]
}

/// A positive small rational number.
pub fn positive() -> impl Strategy<Value = (i64, i64)> {
    prop_oneof![3 => (1_i64..=12, 1_i64..=6), 1 => (1_i64..=1000, 1_i64..=97)]
}

/// A list of rational numbers in which some repeat another, or its negative.
pub fn ratios(length: usize) -> impl Strategy<Value = Vec<(i64, i64)>> {
    prop::collection::vec((ratio(), 0_u8..8, any::<prop::sample::Index>()), length).prop_map(
        |drawn| {
            let mut values: Vec<(i64, i64)> = Vec::new();
            for (value, relation, other) in drawn {
                let value = match (values.is_empty(), relation) {
                    (false, 0) => values[other.index(values.len())],
                    (false, 1) => {
                        let (n, d) = values[other.index(values.len())];
                        (-n, d)
                    }
                    _ => value,
                };
                values.push(value);
            }
            values
        },
    )
}

/// Any finite double: edge values, random bits, small integers, and neighbours and opposites of the others in the list.
pub fn doubles(length: usize) -> impl Strategy<Value = Vec<f64>> {
    let one = prop_oneof![
        3 => prop::sample::select(EDGES),
        3 => any::<u64>().prop_map(f64::from_bits),
        2 => (-9_i8..=9).prop_map(f64::from),
        2 => -1.0_f64..1.0,
    ];
    prop::collection::vec((one, 0_u8..10, any::<prop::sample::Index>()), length).prop_map(|drawn| {
        let mut values: Vec<f64> = Vec::new();
        for (value, relation, other) in drawn {
            let near = |values: &[f64]| values[other.index(values.len())];
            let value = match (values.is_empty(), relation) {
                (false, 0) => near(&values),
                (false, 1) => -near(&values),
                (false, 2) => near(&values).next_up(),
                (false, 3) => near(&values).next_down(),
                _ => value,
            };
            values.push(if value.is_finite() { value } else { 0.0 });
        }
        values
    })
}

const EDGES: &[f64] = &[
    0.0,
    -0.0,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    -f64::MIN_POSITIVE,
    2.225_073_858_507_201e-308,
    f64::EPSILON,
    1.0,
    -1.0,
    1.0 + f64::EPSILON,
    1.0 - f64::EPSILON / 2.0,
    1e-160,
    -1e-160,
    1e160,
    -1e160,
    9_007_199_254_740_993.0,
    f64::MAX,
    f64::MIN,
];

/// Draws of the unknowns of a statement.
const DRAWS: u32 = 2000;

fn at_ratios(statement: &Statement, values: &[(i64, i64)]) -> Verdict {
    Exact::scope(|| {
        let mut values: Vec<Exact> = values.iter().map(|&(n, d)| Exact::ratio(n, d)).collect();
        (statement.prepare)(&mut values);
        (statement.exact)(&values)
    })
}

/// Tests a statement over exact rationals.
///
/// # Errors
/// As [`hold`].
pub fn hold_exactly(statement: &Statement) -> Result<String, String> {
    let strategy = ratios(statement.variables.len());
    hold(DRAWS, strategy, statement.classes, |v| at_ratios(statement, v))
}

/// Tests a statement over all finite doubles.
///
/// # Errors
/// As [`hold`].
pub fn hold_in_doubles(statement: &Statement) -> Result<String, String> {
    let strategy = doubles(statement.variables.len());
    hold(10 * DRAWS, strategy, statement.classes, |v| (statement.doubles)(v))
}

/// The control of [`hold_in_doubles`].
///
/// # Errors
/// As [`reject`].
pub fn reject_in_doubles(statement: &Statement) -> Result<String, String> {
    let strategy = doubles(statement.variables.len());
    reject(10 * DRAWS, strategy, |v| (statement.doubles)(v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_of_doubles_are_finite_and_contain_ties_neighbours_and_zeros() {
        let mut runner = runner(1);
        let (mut ties, mut neighbours, mut zeros) = (0, 0, 0);
        for _ in 0..1000 {
            let v = doubles(2).new_tree(&mut runner).unwrap().current();
            assert!(v.iter().all(|x| x.is_finite()));
            ties += i32::from(v[0] == v[1]);
            neighbours += i32::from(v[0].next_up() == v[1] || v[1].next_up() == v[0]);
            zeros += i32::from(v[0] == 0.0);
        }
        assert!(ties > 50 && neighbours > 100 && zeros > 30, "{ties} {neighbours} {zeros}");
    }

    #[test]
    fn a_class_that_no_draw_hits_is_an_error() {
        let result = hold(10, Just(1), &["seen", "never seen"], |_| Verdict::Holds("seen"));
        assert!(result.unwrap_err().contains("'never seen'"));
    }

    #[test]
    fn a_control_that_nothing_rejects_is_an_error() {
        assert!(reject(10, Just(1), |_| Verdict::Holds("")).is_err());
        assert!(reject(10, Just(1), |_| Verdict::Fails("no")).is_ok());
    }
}
