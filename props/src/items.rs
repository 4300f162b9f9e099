//! The numbered items of the paper, and for each the checks that are about it: `items.txt`.

use crate::claim::{Check, Claim};

/// A numbered item of the paper.
#[derive(Clone, Debug)]
pub struct Item {
    /// Its number, or a name for what the paper has not.
    pub name: &'static str,
    /// What it says, in a few words.
    pub says: &'static str,
    /// What is not checked, or taken from the literature; empty where that is nothing.
    pub missing: &'static str,
    /// Rows, and names of checks in them.
    pub checks: Vec<(&'static str, Vec<&'static str>)>,
}

/// All of them, in the order of the paper.
pub fn items() -> Vec<Item> {
    let item = |block: &'static str| {
        let mut lines = block.lines();
        let (name, says) = lines.next().and_then(|head| head.split_once(": ")).unwrap_or_default();
        let mut item = Item { name, says, missing: "", checks: Vec::new() };
        for line in lines {
            match line.strip_prefix("- ") {
                Some(missing) => item.missing = missing,
                None => {
                    let mut words = line.split(' ');
                    item.checks.extend(words.next().map(|row| (row, words.collect())));
                }
            }
        }
        item
    };
    include_str!("items.txt").split("\n\n").skip(1).map(item).collect()
}

impl Item {
    /// The checks themselves, controls apart, with their rows.
    pub fn found<'a>(&self, claims: &'a [Claim]) -> Vec<(&'a Claim, &'a Check)> {
        let mut found = Vec::new();
        for (row, names) in &self.checks {
            let claim = claims.iter().filter(|claim| claim.id == *row);
            let of = claim.flat_map(|claim| claim.checks.iter().map(move |check| (claim, check)));
            found.extend(of.filter(|(_, check)| !check.control && names.contains(&check.name)));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims;

    #[test]
    fn every_check_named_for_an_item_is_evidence_of_its_row() {
        let claims = claims::all();
        assert!(items().len() > 40);
        for item in items() {
            assert!(!item.says.is_empty(), "{item:?}");
            for (row, names) in &item.checks {
                let claim = claims.iter().find(|claim| claim.id == *row).expect("a row");
                for name in names {
                    let evidence = |check: &&Check| check.name == *name && !check.control;
                    let found = claim.checks.iter().find(evidence);
                    assert!(found.is_some(), "{}: row {row} has no check {name}", item.name);
                }
            }
            assert!(!item.missing.is_empty() || !item.found(&claims).is_empty(), "{}", item.name);
        }
    }

    #[test]
    fn an_item_and_a_row_name_each_other() {
        for claim in claims::all() {
            let of = |item: &Item| item.checks.iter().any(|(row, _)| *row == claim.id);
            let mut by_item: Vec<&str> =
                items().into_iter().filter(of).map(|item| item.name).collect();
            let mut by_row = claim.items.to_vec();
            by_item.sort_unstable();
            by_row.sort_unstable();
            assert_eq!(by_item, by_row, "row {}", claim.id);
        }
    }
}
