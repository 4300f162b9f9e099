//! Random data for the exact and the doubles engine, by proptest: counted by class, shrunk when a predicate fails, and
//! failures remembered in `props/regressions/`, a file for each check, and replayed before its next draws.
//!
//! The seed is fixed unless the environment gives another one: `PROPS_SEED=random` draws one, `PROPS_SEED=<number>`
//! takes that; a failure prints it. Each check draws from it and its own name, so no two see the same data. `PROPS_DRAWS=10` draws
//! ten times as many of everything.

use std::cell::{Cell, RefCell};
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

/// Elliptic laws A that couple all strains, C11, C12, C16, C22, C26, C66: positive by their rows.
pub fn tensors() -> impl Strategy<Value = [f64; 6]> {
    let diagonal = [1.0_f64..2.0, 1.0_f64..2.0, 0.7_f64..1.5];
    (diagonal, prop::array::uniform3(-0.3_f64..0.3))
        .prop_map(|([a, b, c], [p, q, r])| [a, p, q, b, r, c])
}

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

/// How many times as many draws there shall be: `PROPS_DRAWS`, or 1.
pub fn times() -> u32 {
    let asked = std::env::var("PROPS_DRAWS");
    asked.map_or(1, |text| text.parse().expect("PROPS_DRAWS is a number"))
}

thread_local! {
    /// The check that is run.
    static CHECK: Cell<&'static str> = const { Cell::new("") };
}

/// Runs `work` as the check with this name: its draws are its own, and so are the failures that it remembers.
pub fn named<T>(check: &'static str, work: impl FnOnce() -> T) -> T {
    let before = CHECK.replace(check);
    let result = work();
    CHECK.set(before);
    result
}

/// The seed of this process and the name of the check, mixed (FNV-1a), and which round of draws it is.
fn seed_of_check(round: u32) -> [u8; 32] {
    let start = seed() ^ 0xcbf2_9ce4_8422_2325;
    let name = CHECK.get().bytes();
    let mixed =
        name.fold(start, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed().to_le_bytes());
    bytes[8..16].copy_from_slice(&mixed.to_le_bytes());
    bytes[16..20].copy_from_slice(&round.to_le_bytes());
    bytes
}

/// The failures that the check remembers.
fn regressions() -> String {
    let name = if CHECK.get().is_empty() { "unnamed" } else { CHECK.get() };
    format!("{}/regressions/{name}.txt", env!("CARGO_MANIFEST_DIR"))
}

/// How many failures are replayed before the first draw.
fn replays() -> usize {
    let kept = std::fs::read_to_string(regressions()).unwrap_or_default();
    kept.lines().filter(|line| line.starts_with("cc ")).count()
}

fn runner(cases: u32, round: u32) -> TestRunner {
    // The name of the file lives as long as the process: there is one for each check.
    let file: &'static str = Box::leak(regressions().into_boxed_str());
    let config = Config {
        cases,
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..Config::default()
    };
    TestRunner::new_with_rng(
        config,
        TestRng::from_seed(RngAlgorithm::ChaCha, &seed_of_check(round)),
    )
}

/// Under this name the draws are counted of which a predicate says nothing.
const NOT_MET: &str = "hypothesis not met";

/// So many rounds are drawn at most until enough draws met the hypothesis and each class was hit. A class of one draw in ten, and
/// ten draws a round: it is missed by all of them once in 10^18 seeds; by the first alone, once in three.
const ROUNDS: u32 = 40;

/// The same for a statement over rationals, and how many draws are enough: few meet a hypothesis of several comparisons.
const ROUNDS_OF_RATIOS: u32 = 1000;
const ENOUGH_RATIOS: u32 = 100;

/// Draws `cases` times, runs the predicate, in a scope of exact numbers, and counts the classes; as often again while no draw
/// met the hypothesis or a class was not hit.
///
/// # Errors
/// The shrunk data for which it fails, the class that no draw hit, or that no draw met the hypothesis.
pub fn hold<D: Debug>(
    cases: u32,
    strategy: impl Strategy<Value = D>,
    classes: &[&'static str],
    predicate: impl Fn(&D) -> Verdict,
) -> Result<String, String> {
    hold_until([ROUNDS, 1], times() * cases, strategy, classes, predicate)
}

/// The same in at most so many rounds, until so many draws met the hypothesis.
fn hold_until<D: Debug>(
    [rounds, enough]: [u32; 2],
    cases: u32,
    strategy: impl Strategy<Value = D>,
    classes: &[&'static str],
    predicate: impl Fn(&D) -> Verdict,
) -> Result<String, String> {
    let counts: RefCell<BTreeMap<&'static str, u32>> = RefCell::default();
    let replays = replays();
    let missed = || classes.iter().find(|&&class| !counts.borrow().contains_key(class));
    let met = || -> u32 {
        let counts = counts.borrow();
        counts.iter().filter(|(class, _)| **class != NOT_MET).map(|(_, count)| count).sum()
    };
    let mut drawn = 0;
    for round in 0..rounds {
        let runs = Cell::new(0);
        let result = runner(cases, round).run(&strategy, |data| {
            runs.set(runs.get() + 1);
            let class = match Exact::scope(|| predicate(&data)) {
                Verdict::Holds(class) => class,
                Verdict::Vacuous => NOT_MET,
                Verdict::Fails(why) => return Err(TestCaseError::fail(why)),
            };
            if runs.get() > replays {
                *counts.borrow_mut().entry(class).or_default() += 1;
            }
            Ok(())
        });
        match result {
            Err(TestError::Fail(why, data)) => {
                return Err(format!("{why} fails for {data:?} (PROPS_SEED={})", seed()));
            }
            Err(TestError::Abort(why)) => return Err(why.to_string()),
            Ok(()) => drawn += cases,
        }
        if met() >= enough && missed().is_none() {
            break;
        }
    }
    let (met, missed) = (met(), missed());
    let counts = counts.borrow();
    if met == 0 {
        return Err(format!("no draw met the hypothesis: {counts:?}"));
    }
    if let Some(class) = missed {
        return Err(format!("no draw hit the class '{class}': {counts:?}"));
    }
    let counts: Vec<String> = counts.iter().map(|(class, n)| format!("{class} {n}")).collect();
    let replayed = if replays == 0 { String::new() } else { format!(", {replays} replayed") };
    Ok(format!("{drawn} draws{replayed}: {}", counts.join(", ")))
}

/// The control of [`hold`]: some draw must make the predicate fail. It takes as many as it needs, at most four times
/// [`DRAWS_OF_DOUBLES`].
///
/// # Errors
/// That none did.
pub fn reject<D: Debug>(
    strategy: impl Strategy<Value = D>,
    predicate: impl Fn(&D) -> Verdict,
) -> Result<String, String> {
    let mut runner = runner(1, 0);
    for draw in 0..4 * DRAWS_OF_DOUBLES {
        let tree = strategy.new_tree(&mut runner).map_err(|why| why.to_string())?;
        let data = tree.current();
        if let Verdict::Fails(why) = Exact::scope(|| predicate(&data)) {
            return Ok(format!("rejected at draw {draw}: {why}"));
        }
    }
    Err(format!("the planted mistake was not rejected in {} draws", 4 * DRAWS_OF_DOUBLES))
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

/// A list of numbers each of which, one time in so many, is made of one before it in the first of these ways, and likewise for the
/// others.
fn related<T: Copy + Debug>(
    length: usize,
    number: impl Strategy<Value = T>,
    one_in: u8,
    ways: &'static [fn(T) -> T],
) -> impl Strategy<Value = Vec<T>> {
    let drawn = (number, 0..one_in, any::<prop::sample::Index>());
    prop::collection::vec(drawn, length).prop_map(|drawn| {
        let mut values: Vec<T> = Vec::new();
        for (value, way, other) in drawn {
            let way = ways.get(usize::from(way)).filter(|_| !values.is_empty());
            values.push(way.map_or(value, |way| way(values[other.index(values.len())])));
        }
        values
    })
}

/// A list of rational numbers in which some repeat another, or its negative.
pub fn ratios(length: usize) -> impl Strategy<Value = Vec<(i64, i64)>> {
    related(length, ratio(), 8, &[|value| value, |(n, d)| (-n, d)])
}

/// Any finite double: edge values, random bits, small integers, and neighbours and opposites of the others in the list.
pub fn doubles(length: usize) -> impl Strategy<Value = Vec<f64>> {
    let one = prop_oneof![
        3 => prop::sample::select(EDGES),
        3 => any::<u64>().prop_map(f64::from_bits),
        2 => (-9_i8..=9).prop_map(f64::from),
        2 => -1.0_f64..1.0,
    ];
    let ways: &[fn(f64) -> f64] =
        &[|x| x, |x| -x, |x| finite(x.next_up()), |x| finite(x.next_down())];
    related(length, one.prop_map(finite), 10, ways)
}

fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
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
pub const DRAWS: u32 = 200;

/// The same over doubles; and of a control over anything, at most four times as many.
pub const DRAWS_OF_DOUBLES: u32 = 5_000;

fn at_ratios(statement: &Statement, values: &[(i64, i64)]) -> Verdict {
    Exact::scope(|| {
        let mut values: Vec<Exact> = values.iter().copied().map(Exact::from).collect();
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
    let until = [ROUNDS_OF_RATIOS, ENOUGH_RATIOS];
    hold_until(until, times() * DRAWS, strategy, statement.classes, |v| at_ratios(statement, v))
}

/// Tests a statement over all finite doubles.
///
/// # Errors
/// As [`hold`].
pub fn hold_in_doubles(statement: &Statement) -> Result<String, String> {
    let strategy = doubles(statement.variables.len());
    hold(DRAWS_OF_DOUBLES, strategy, statement.classes, |v| (statement.doubles)(v))
}

/// The control of [`hold_in_doubles`]: the conclusion that the statement names fails.
///
/// # Errors
/// As [`reject`], and that it names none.
pub fn reject_in_doubles(statement: &Statement) -> Result<String, String> {
    let Some(conclusion) = statement.conclusion else {
        return Err("a control names the conclusion that must fail".to_owned());
    };
    let strategy = doubles(statement.variables.len());
    reject(strategy, |v| match (statement.doubles)(v) {
        Verdict::Fails(why) if why != conclusion => Verdict::Vacuous,
        verdict => verdict,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_of_doubles_are_finite_and_contain_ties_neighbours_and_zeros() {
        let mut runner = runner(1, 0);
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
    fn checks_of_different_names_draw_different_data() {
        let first = || doubles(9).new_tree(&mut runner(1, 0)).unwrap().current();
        let [a, b, again] = ["one", "other", "one"].map(|name| named(name, first));
        assert!(a != b && a == again);
    }

    #[test]
    fn a_class_that_no_draw_hits_is_an_error() {
        let result = hold(10, Just(1), &["seen", "never seen"], |_| Verdict::Holds("seen"));
        assert!(result.unwrap_err().contains("'never seen'"));
    }

    #[test]
    fn draws_go_on_until_a_rare_class_was_hit() {
        let class = |&n: &u32| Verdict::Holds(if n == 0 { "rare" } else { "usual" });
        let found = hold(2, 0_u32..8, &["rare", "usual"], class).unwrap();
        assert!(found.contains("rare"), "{found}");
        let once = hold(2, 0_u32..8, &["usual"], class).unwrap();
        assert!(once.starts_with("2 draws"), "{once}");
    }

    #[test]
    fn draws_go_on_until_one_meets_the_hypothesis() {
        let rare = |&n: &u32| if n == 0 { Verdict::Holds("met") } else { Verdict::Vacuous };
        let found = hold(1, 0_u32..8, &[], rare).unwrap();
        assert!(found.contains("met 1") && found.contains(NOT_MET), "{found}");
    }

    #[test]
    fn a_hypothesis_that_no_draw_meets_is_an_error() {
        let result = hold(10, Just(1), &[], |_| Verdict::Vacuous);
        assert!(result.unwrap_err().contains("no draw met the hypothesis"));
    }

    #[test]
    fn a_control_that_nothing_rejects_is_an_error() {
        assert!(reject(Just(1), |_| Verdict::Holds("")).is_err());
        assert!(reject(Just(1), |_| Verdict::Fails("no")).is_ok());
    }
}
