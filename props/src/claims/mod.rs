//! The claims, one file per item. Each file has the predicates first, then the harnesses of the model checker, and last
//! the row of the ledger with its checks.

#[cfg(not(kani))]
pub mod assembled;
#[cfg(not(kani))]
pub mod consistent;
pub mod constants;
#[cfg(not(kani))]
pub mod curved;
pub mod discrete_forms;
pub mod floating_point;
pub mod friction;
#[cfg(not(kani))]
pub mod interpolation;
#[cfg(not(kani))]
mod known;
pub mod lemma_3_1;
pub mod lemma_3_2;
pub mod method;
pub mod mixed;
#[cfg(not(kani))]
pub mod one_solution;
#[cfg(not(kani))]
pub mod pairs;
pub mod positive_part;
pub mod prop_2_1;
#[cfg(not(kani))]
pub mod revolution;
#[cfg(not(kani))]
pub mod tensor;
pub mod theorem_3_3;
pub mod theorem_3_4;
pub mod variational_inequality;

#[cfg(not(kani))]
use std::collections::BTreeMap;

#[cfg(not(kani))]
use crate::claim::{Check, Claim, Engine, Subject};
#[cfg(not(kani))]
use crate::harness::Harness;
#[cfg(not(kani))]
use crate::statement::Statement;

/// All claims, in the order of the paper.
#[cfg(not(kani))]
pub fn all() -> Vec<Claim> {
    let mut claims = vec![
        positive_part::claim(),
        prop_2_1::claim(),
        prop_2_1::remark_2_2(),
        discrete_forms::claim(),
        lemma_3_1::green(),
        method::claim(),
        mixed::claim(),
        lemma_3_1::consistency(),
        lemma_3_2::claim(),
        theorem_3_3::claim(),
        theorem_3_4::claim(),
        floating_point::claim(),
        constants::claim(),
        revolution::claim(),
        variational_inequality::claim(),
        pairs::claim(),
        friction::claim(),
    ];
    claims.sort_by_key(|claim| claim.id.parse::<u32>().expect("the id of a row is a number"));
    claims
}

/// The statements of which this engine is asked, each once, by their names, and whether it is a control.
#[cfg(not(kani))]
pub fn asked(engine: Engine) -> BTreeMap<&'static str, (Statement, bool)> {
    let statement = |check: Check| match check.subject {
        Subject::Statement(of) if check.engine == engine => Some((of.name, (of, check.control))),
        _ => None,
    };
    all().into_iter().flat_map(|claim| claim.checks).filter_map(statement).collect()
}

/// Those that must hold.
#[cfg(not(kani))]
pub fn statements(engine: Engine) -> BTreeMap<&'static str, Statement> {
    let asked = asked(engine).into_iter().filter(|(_, (_, control))| !control);
    asked.map(|(name, (statement, _))| (name, statement)).collect()
}

/// The harnesses of all claims.
#[cfg(not(kani))]
pub fn harnesses() -> Vec<Harness> {
    let harness = |check: Check| match check.subject {
        Subject::Harness(harness) => Some(harness),
        _ => None,
    };
    all().into_iter().flat_map(|claim| claim.checks).filter_map(harness).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many draws an outcome speaks of.
    fn drawn(said: &str) -> u32 {
        let before = said.match_indices(" draws").map(|(at, _)| said[..at].rsplit(' ').next());
        before.flatten().filter_map(|number| number.parse::<u32>().ok()).sum()
    }

    #[test]
    fn the_draws_of_an_outcome_are_counted() {
        assert_eq!(drawn("P1: 60 draws: open 3, cut 57; P2 by points: 15 draws: cut 15"), 75);
        assert_eq!(drawn("two triangles, P1 and P2: attained up to 9"), 0);
    }

    fn passes(id: &str) {
        let claim = all().into_iter().find(|c| c.id == id).expect("a row");
        let mut failures = Vec::new();
        for check in &claim.checks {
            let enough = |said: &str| drawn(said) >= check.draws * crate::draws::times();
            let said = check.run().and_then(|said| if enough(&said) { Ok(()) } else { Err(said) });
            if let Err(why) = said {
                failures.push(format!("{} ({}): {why}", check.name, check.engine.name()));
            }
        }
        assert!(failures.is_empty(), "row {id}:\n{}", failures.join("\n"));
    }

    macro_rules! rows {
        ($($test:ident $id:literal),* $(,)?) => {
            $(#[test]
            fn $test() {
                passes($id);
            })*

            #[test]
            fn every_row_has_its_test() {
                let ids: Vec<&str> = all().iter().map(|c| c.id).collect();
                assert_eq!(ids, [$($id),*]);
            }
        };
    }

    rows! {
        every_check_of_row_1_passes "1",
        every_check_of_row_2_passes "2",
        every_check_of_row_3_passes "3",
        every_check_of_row_4_passes "4",
        every_check_of_row_5_passes "5",
        every_check_of_row_6_passes "6",
        every_check_of_row_7_passes "7",
        every_check_of_row_8_passes "8",
        every_check_of_row_9_passes "9",
        every_check_of_row_10_passes "10",
        every_check_of_row_11_passes "11",
        every_check_of_row_13_passes "13",
        every_check_of_row_15_passes "15",
        every_check_of_row_16_passes "16",
        every_check_of_row_17_passes "17",
        every_check_of_row_18_passes "18",
        every_check_of_row_27_passes "27",
    }
}
