//! The headline statements of the paper for Rocq: `props/rocq/paper.v`, written by hand, with the proofs that the engine's
//! certificates give ([`crate::proof::rocq`]), and what Rocq said of them by the newest receipt (`.ci/rocq.py`).

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::OnceLock;

use crate::claim::Engine;
use crate::claims;
use crate::proof::rocq;
use crate::receipt::hash;
use crate::solvers::Receipt;

const PAPER: &str = include_str!("../rocq/paper.v");

/// Where the tactics begin: what stands before are the definitions.
const TACTICS: &str = "(** The tactics of the proofs.";

/// A theorem of `PAPER`.
pub struct Theorem {
    /// Its name.
    pub name: &'static str,
    /// From its name to before `Qed`.
    text: &'static str,
    /// The predicate whose paths prove it; without one it is proved by hand.
    pub predicate: Option<&'static str>,
    /// A text in it, and what makes it false in its place.
    planted: Option<(&'static str, &'static str)>,
}

/// What `text` has between `open` and ` *)`.
fn comment(text: &'static str, open: &str) -> Option<&'static str> {
    text.split_once(open).and_then(|(_, rest)| rest.split_once(" *)")).map(|(inside, _)| inside)
}

/// The theorems in their order.
pub fn theorems() -> Vec<Theorem> {
    let theorem = |text: &'static str| Theorem {
        name: text.split(' ').next().unwrap_or_default(),
        text: text.split("Qed.\n").next().unwrap_or_default(),
        predicate: comment(text, "(* paths of "),
        planted: comment(text, "(* false: ").and_then(|planted| planted.split_once(" => ")),
    };
    PAPER.split("\nTheorem ").skip(1).map(theorem).collect()
}

impl Theorem {
    /// The hash of what it says: definitions and statement, without the proof, which is Rocq's to judge.
    fn digest(&self) -> String {
        let definitions = PAPER.split(TACTICS).next().unwrap_or_default();
        let statement = self.text.split("Proof.").next().unwrap_or_default();
        hash(&format!("{definitions}Theorem {statement}"))
    }

    /// Whether Rocq has proved this very statement, by the newest receipt.
    pub fn is_proved(&self) -> bool {
        let row = receipt().answers(self.name);
        row.is_some_and(|row| row[0] == self.digest() && row[2..] == ["proved"])
    }
}

/// The newest receipt.
pub fn receipt() -> &'static Receipt {
    static RECEIPT: OnceLock<Receipt> = OnceLock::new();
    RECEIPT.get_or_init(|| Receipt::of_solvers("rocq-"))
}

/// The files for Rocq, by their paths: `paper.v`, and of each theorem that has one, the false statement with the same proof.
///
/// # Errors
/// A predicate that is no claim or is not proved, and a planted mistake that is not in its theorem.
pub fn files() -> Result<BTreeMap<String, String>, String> {
    let statements = claims::statements(Engine::Proof);
    let mut paper = PAPER.split("\nTheorem ").next().unwrap_or_default().to_owned();
    let mut files = BTreeMap::new();
    for Theorem { name, text, predicate, planted } in theorems() {
        let mut text = format!("Theorem {text}");
        if let Some(predicate) = predicate {
            let statement =
                statements.get(predicate).ok_or(format!("{name}: {predicate} is no claim"))?;
            let comment = format!("(* paths of {predicate} *)");
            text = text.replace(&comment, &rocq::tactics(statement)?);
        }
        paper += &format!("\n{text}Qed.\nPrint Assumptions {name}.\n");
        let Some((old, new)) = planted else { continue };
        if !text.contains(old) {
            return Err(format!("{name}: '{old}' is not in it"));
        }
        let imports = "Require Import Reals Lra.\nFrom Signorini Require Import paper.\n";
        let twin = text.replacen(old, new, 1);
        files.insert(
            format!("false/{name}.v"),
            format!("{imports}Open Scope R_scope.\n\n{twin}Qed.\n"),
        );
    }
    files.insert("paper.v".to_owned(), paper);
    Ok(files)
}

/// Writes the [`files`] into `directory` and answers how many theorems there are.
///
/// # Errors
/// Those of [`files`], and whatever keeps them from being written.
pub fn export(directory: &Path) -> io::Result<usize> {
    std::fs::create_dir_all(directory.join("false"))?;
    for (path, text) in files().map_err(io::Error::other)? {
        std::fs::write(directory.join(path), text)?;
    }
    Ok(theorems().len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rocq_has_proved_each_theorem_as_it_stands_by_the_newest_receipt() {
        let theorems = theorems();
        assert!(theorems.len() >= 20, "{}", theorems.len());
        for theorem in &theorems {
            let again = "props -- export --rocq DIR, then .ci/rocq.py DIR --receipt props/receipts";
            assert!(theorem.is_proved(), "{}: cargo run -p {again}", theorem.name);
        }
        assert_eq!(receipt().rows.len(), theorems.len());
    }

    #[test]
    fn each_theorem_with_a_predicate_is_exported_beside_a_false_statement() {
        let files = files().expect("files for Rocq");
        let paper = &files["paper.v"];
        for Theorem { name, predicate, planted, .. } in theorems() {
            assert!(paper.contains(&format!("Print Assumptions {name}.")), "{name}");
            assert_eq!(predicate.is_some(), planted.is_some(), "{name}");
            assert_eq!(planted.is_some(), files.contains_key(&format!("false/{name}.v")), "{name}");
        }
        assert!(!paper.contains("(* paths of"));
    }
}
