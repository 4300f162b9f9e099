//! Receipts of runs of other programs, tables in `props/receipts`, and what the newest one of the model checker Kani says of a
//! harness.
//!
//! ```text
//! cargo kani 2>&1 | tee LOG               at the root, with Kani installed, at a commit
//! .ci/kani_receipt.py LOG                 writes props/receipts/kani-DATE.tsv, and nothing else does
//! ```
//!
//! Such a receipt says at which commit which harness got which verdict, in how many seconds and by which versions, and has a
//! hash of each file of the kernel, of each file that a harness stands in and of what all harnesses share, as they are in that
//! commit. It stands behind a harness as long as these files are what they were.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;
use std::sync::OnceLock;

use sha2::{Digest, Sha256};

use crate::harness::Harness;

/// What each harness may reach, beside the file that it stands in.
const SHARED: [&str; 4] =
    ["src/kernel/", "props/src/harness.rs", "props/src/verdict.rs", "props/src/numbers/whole.rs"];

/// The root of the workspace.
pub(crate) fn root() -> &'static Path {
    let props = Path::new(env!("CARGO_MANIFEST_DIR"));
    props.parent().unwrap_or(props)
}

/// The hash by which a receipt knows a text.
pub fn hash(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest[..8].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A receipt as it is stored: lines `# HEAD`, the names of the columns, and rows of columns between tabs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// When: year-month-day, in UTC.
    pub date: String,
    /// Versions, commit, machine, files: a line for each.
    pub head: Vec<String>,
    /// The names of the columns.
    pub columns: Vec<String>,
    /// As many fields each as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads the text of a receipt.
    ///
    /// # Errors
    /// A row that has not as many fields as there are columns.
    pub fn parse(date: &str, text: &str) -> Result<Table, String> {
        let fields = |line: &str| line.split('\t').map(str::to_owned).collect::<Vec<_>>();
        let head = text.lines().filter_map(|line| line.strip_prefix("# ")).map(str::to_owned);
        let mut rows = text.lines().filter(|line| !line.starts_with('#')).map(fields);
        let columns = rows.next().unwrap_or_default();
        let rows: Vec<Vec<String>> = rows.collect();
        if let Some(wrong) = rows.iter().find(|row| row.len() != columns.len()) {
            return Err(format!("{date}: expected {} columns: {}", columns.len(), wrong.join(" ")));
        }
        Ok(Table { date: date.to_owned(), head: head.collect(), columns, rows })
    }

    /// The newest receipt in `props/receipts` whose name is `prefix` and a date.
    ///
    /// # Errors
    /// A file that can't be read, or that is no receipt, and that there is none.
    pub fn newest(prefix: &str) -> Result<Table, String> {
        let folder = root().join("props/receipts");
        let failed = |why: io::Error| format!("{}: {why}", folder.display());
        let mut dates = BTreeSet::new();
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let name = entry.map_err(failed)?.file_name().to_string_lossy().into_owned();
            dates.extend(dated(&name, prefix).map(str::to_owned));
        }
        let date = dates.last().ok_or(format!("{}: no {prefix}DATE.tsv", folder.display()))?;
        let text = std::fs::read_to_string(folder.join(format!("{prefix}{date}.tsv")));
        Table::parse(date, &text.map_err(failed)?)
    }
}

/// The date in the name of a receipt.
fn dated<'a>(name: &'a str, prefix: &str) -> Option<&'a str> {
    name.strip_prefix(prefix)?.strip_suffix(".tsv")
}

/// What the model checker said of a harness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It holds; or, of a false twin, it fails as it must.
    Verified,
    /// The contrary.
    Failed,
    /// It ran out of time or of memory, or the solver refused the problem.
    NoAnswer,
}

const ANSWERS: [(&str, Answer); 3] =
    [("verified", Answer::Verified), ("failed", Answer::Failed), ("no answer", Answer::NoAnswer)];

/// One run of the model checker over the harnesses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Receipt {
    /// When: year-month-day, in UTC.
    pub date: String,
    /// Of which sources.
    pub commit: String,
    /// The files that the answers hang on, each with its hash.
    pub files: BTreeMap<String, String>,
    /// The harnesses by their paths in this crate, with the verdicts.
    pub runs: Vec<(String, Answer)>,
}

const COLUMNS: [&str; 5] = ["harness", "expected", "verdict", "seconds", "conditions"];

/// What is expected of a harness: a false twin must fail.
fn expected(harness: &str) -> &'static str {
    if own_name(harness).starts_with("control_") { "should_panic" } else { "success" }
}

/// The name of a harness without the modules in front of it: no two have the same.
fn own_name(path: &str) -> &str {
    path.rsplit("::").next().unwrap_or(path)
}

/// The file in which a harness with this path stands.
fn file_of(path: &str) -> String {
    let module = path.rsplit_once("::").map_or("lib", |(module, _)| module);
    format!("props/src/{}.rs", module.replace("::", "/"))
}

impl Receipt {
    /// A receipt as it is stored.
    ///
    /// # Errors
    /// A table without a commit, or with a row that is none of a receipt.
    pub fn of(table: &Table) -> Result<Receipt, String> {
        let wrong = |what: String| format!("kani-{}.tsv: no row of a receipt: {what}", table.date);
        if !table.columns.starts_with(&COLUMNS.map(str::to_owned)) {
            return Err(wrong(table.columns.join(" ")));
        }
        let run = |row: &Vec<String>| {
            let answer = ANSWERS.into_iter().find(|(name, _)| *name == row[2]);
            let (Some((_, answer)), true) = (answer, row[1] == expected(&row[0])) else {
                return Err(wrong(row.join(" ")));
            };
            Ok((row[0].clone(), answer))
        };
        let runs = table.rows.iter().map(run).collect::<Result<_, _>>()?;
        let mut receipt = Receipt { date: table.date.clone(), runs, ..Receipt::default() };
        for line in &table.head {
            match *line.split(' ').collect::<Vec<_>>() {
                ["commit", commit] => receipt.commit = commit.to_owned(),
                ["file", file, hash] => {
                    receipt.files.insert(file.to_owned(), hash.to_owned());
                }
                _ => {}
            }
        }
        if receipt.commit.is_empty() {
            return Err(format!("kani-{}.tsv: expected a line '# commit HASH'", table.date));
        }
        Ok(receipt)
    }

    /// The files of the receipt that are not now what they were, or are no more.
    fn changed(&self) -> Vec<String> {
        let now = |file: &str| std::fs::read_to_string(root().join(file)).map(|text| hash(&text));
        let differs = |(file, then): &(&String, &String)| now(file).ok().as_ref() != Some(*then);
        self.files.iter().filter(differs).map(|(file, _)| file.clone()).collect()
    }

    /// What it says of a harness, with the files that have changed since.
    fn standing(&self, path: &str, changed: &[String]) -> Standing {
        let name = own_name(path);
        let Some((_, answer)) = self.runs.iter().find(|(harness, _)| own_name(harness) == name)
        else {
            return Standing::Never;
        };
        let file = file_of(path);
        let moved = !self.files.contains_key(&file);
        if moved || changed.iter().any(|changed| is_shared(changed) || *changed == file) {
            return Standing::Changed;
        }
        Standing::Answered(*answer)
    }
}

fn is_shared(file: &str) -> bool {
    SHARED.iter().any(|shared| file.starts_with(shared))
}

/// What the newest receipt says of a harness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The model checker has this answer for these sources.
    Answered(Answer),
    /// It was run before a file changed that the answer may hang on.
    Changed,
    /// It was not run.
    Never,
}

/// The newest receipt of the model checker, with the files that have changed since: read once.
fn newest() -> &'static (Receipt, Vec<String>) {
    static NEWEST: OnceLock<(Receipt, Vec<String>)> = OnceLock::new();
    NEWEST.get_or_init(|| {
        let receipt = Table::newest("kani-").and_then(|table| Receipt::of(&table));
        let receipt = receipt.unwrap_or_else(|why| panic!("props/receipts: {why}"));
        let changed = receipt.changed();
        (receipt, changed)
    })
}

/// What stands behind a harness.
pub fn standing(harness: &Harness) -> Standing {
    let (receipt, changed) = newest();
    receipt.standing(&harness.path(), changed)
}

/// What the newest receipt says of these harnesses, as a sentence of `VERIFY.md`.
pub fn said(harnesses: &[Harness]) -> String {
    let (receipt, changed) = newest();
    let Receipt { date, commit, runs, .. } = receipt;
    let known = |answer| runs.iter().filter(|(_, of)| *of == answer).count();
    let standing = harnesses
        .iter()
        .filter(|harness| standing(harness) == Standing::Answered(Answer::Verified));
    let since = if changed.is_empty() { "nothing".to_owned() } else { changed.join(", ") };
    format!(
        "{} harnesses were run at `{}` on {date}: {} as expected, {} not, {} without an answer; changed since: {since}. That \
         stands behind {} of the {} harnesses of today; the others count as draws.",
        runs.len(),
        &commit[..commit.len().min(7)],
        known(Answer::Verified),
        known(Answer::Failed),
        known(Answer::NoAnswer),
        standing.count(),
        harnesses.len(),
    )
}

/// Whether a harness is decided by running it on all its values, which are few: asked once.
pub fn is_decided(harness: &Harness) -> bool {
    thread_local! {
        static DECIDED: RefCell<BTreeMap<String, bool>> = const { RefCell::new(BTreeMap::new()) };
    }
    let known = DECIDED.with_borrow(|decided| decided.get(&harness.path()).copied());
    known.unwrap_or_else(|| {
        let decided = harness.is_decided();
        DECIDED.with_borrow_mut(|all| all.insert(harness.path(), decided));
        decided
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims;

    const TABLE: &str = "\
# Kani Rust Verifier 0.67.0 (cargo plugin)
# commit c0ffee
# file props/src/claims/a.rs 0123
harness\texpected\tverdict\tseconds\tconditions
claims::a::holds\tsuccess\tverified\t0.45\t36
claims::a::control_fails\tshould_panic\tverified\t12.50\t35
claims::a::wrong\tsuccess\tfailed\t1.00\t5
claims::a::slow\tsuccess\tno answer\t\t
";

    fn read(text: &str) -> Result<Receipt, String> {
        Receipt::of(&Table::parse("2026-11-21", text)?)
    }

    #[test]
    fn a_receipt_that_is_none_is_refused() {
        let found: Vec<Answer> =
            read(TABLE).unwrap().runs.into_iter().map(|(_, answer)| answer).collect();
        use Answer::{Failed, NoAnswer, Verified};
        assert_eq!(found, [Verified, Verified, Failed, NoAnswer]);
        assert!(read(&TABLE.replace("should_panic", "success")).is_err());
        assert!(read(&TABLE.replace("verified", "perhaps")).is_err());
        assert!(read(&TABLE.replace("\t12.50", "")).is_err());
        assert!(read(&TABLE.replace("# commit c0ffee\n", "")).unwrap_err().contains("commit"));
    }

    #[test]
    fn a_receipt_stands_behind_files_that_have_not_changed_and_no_others() {
        let receipt = read(TABLE).unwrap();
        let of = |path: &str, changed: &[&str]| {
            receipt.standing(path, &changed.iter().map(|&file| file.to_owned()).collect::<Vec<_>>())
        };
        let verified = Standing::Answered(Answer::Verified);
        assert_eq!(of("claims::a::holds", &[]), verified);
        assert_eq!(of("claims::a::holds", &["props/src/claims/b.rs"]), verified);
        assert_eq!(of("claims::a::holds", &["props/src/claims/a.rs"]), Standing::Changed);
        assert_eq!(of("claims::a::holds", &["src/kernel/ball.rs"]), Standing::Changed);
        assert_eq!(of("claims::b::holds", &[]), Standing::Changed);
        assert_eq!(of("claims::a::wrong", &[]), Standing::Answered(Answer::Failed));
        assert_eq!(of("claims::a::new", &[]), Standing::Never);
        assert_eq!(receipt.changed(), ["props/src/claims/a.rs"]);
    }

    /// The text of a file in a commit; nothing where this copy does not have it: a shallow clone, an unpacked archive.
    fn in_commit(commit: &str, file: &str) -> Option<String> {
        let of = format!("{commit}:{file}");
        let mut git = std::process::Command::new("git");
        let shown = git.args(["show", &of]).current_dir(root()).output();
        let output = shown.ok().filter(|output| output.status.success())?;
        String::from_utf8(output.stdout).ok()
    }

    #[test]
    fn the_receipt_has_the_hashes_of_its_commit_and_refutes_no_harness() {
        let (receipt, _) = newest();
        let mut seen = BTreeSet::new();
        for (harness, answer) in &receipt.runs {
            assert!(seen.insert(own_name(harness)), "{harness} is there twice");
            assert!(*answer != Answer::Failed, "{harness} is refuted");
            assert!(
                receipt.files.contains_key(&file_of(harness)),
                "no hash of the file of {harness}"
            );
        }
        assert!(receipt.files.contains_key("src/kernel/positive_part.rs"));
        if in_commit(&receipt.commit, "Cargo.toml").is_none() {
            eprintln!("not compared with its files: this copy has no commit {}", receipt.commit);
            return;
        }
        let is_of_commit = |file: &str, known: &str| {
            in_commit(&receipt.commit, file).is_some_and(|text| hash(&text) == known)
        };
        for (file, known) in &receipt.files {
            assert!(
                is_of_commit(file, known),
                "{file}: made by another program than .ci/kani_receipt.py"
            );
            assert!(!is_of_commit(file, "another file"), "control");
        }
    }

    #[test]
    fn harnesses_stand_in_the_files_that_their_paths_name_and_no_two_have_one_name() {
        let harnesses = claims::harnesses();
        assert!(harnesses.len() > 50, "{}", harnesses.len());
        let mut seen = BTreeSet::new();
        for harness in &harnesses {
            let file = file_of(&harness.path());
            let text = std::fs::read_to_string(root().join(&file)).unwrap_or_default();
            assert!(text.contains(&format!(" {}(", harness.name)), "{} in {file}", harness.name);
            assert!(seen.insert(harness.name), "{} is there twice", harness.name);
        }
        // Flags change answers, and no receipt has them.
        let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("Cargo.toml");
        assert!(!manifest.contains("metadata.kani"), "flags of Kani belong into the receipt");
    }
}
