//! Receipts of runs of other programs, tables in `props/receipts`, and what the newest one of the model checker Kani says of a
//! harness.
//!
//! ```text
//! cargo kani 2>&1 | tee LOG               at the root, with Kani installed, at a commit
//! cargo run -p props -- receipt LOG       writes props/receipts/kani-DATE.tsv, and nothing else does
//! ```
//!
//! Such a receipt says at which commit which harness got which verdict, in how many seconds and by which versions, and has a
//! hash of each file of the kernel, of each file that a harness stands in and of what all harnesses share, as they are in that
//! commit. It stands behind a harness as long as these files are what they were.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, OnceLock};

use sha2::{Digest, Sha256};

use crate::harness::Harness;
use crate::proof::{Known, once};

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

/// What a program prints at the root.
fn output(program: &str, arguments: &[&str]) -> io::Result<String> {
    let output = Command::new(program).args(arguments).current_dir(root()).output()?;
    if !output.status.success() {
        let (what, why) = (arguments.join(" "), String::from_utf8_lossy(&output.stderr));
        return Err(io::Error::other(format!("{program} {what}: {}", why.trim())));
    }
    String::from_utf8(output.stdout).map_err(io::Error::other)
}

fn git(arguments: &[&str]) -> io::Result<String> {
    output("git", arguments)
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

    /// The text of a receipt.
    pub fn text(&self) -> String {
        let head = self.head.iter().map(|line| format!("# {line}\n"));
        let rows = [&self.columns].into_iter().chain(&self.rows);
        head.chain(rows.map(|row| row.join("\t") + "\n")).collect()
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
            let date = name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(".tsv"));
            dates.extend(date.map(str::to_owned));
        }
        let date = dates.last().ok_or(format!("{}: no {prefix}DATE.tsv", folder.display()))?;
        let text = std::fs::read_to_string(folder.join(format!("{prefix}{date}.tsv")));
        Table::parse(date, &text.map_err(failed)?)
    }
}

/// As it must be: a harness holds, a false twin fails.
const VERIFIED: &str = "verified";

/// The contrary.
const FAILED: &str = "failed";

/// It ran out of time or of memory, or the solver refused the problem.
const NO_ANSWER: &str = "no answer";

/// The columns of a receipt of the model checker. Seconds and conditions are empty where they are not known.
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

/// One run of the model checker over the harnesses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Receipt {
    /// Versions and machine, the commit, and in the rows the [`COLUMNS`].
    table: Table,
    /// Of which sources.
    commit: String,
    /// The files that the answers hang on, each with its hash.
    files: BTreeMap<String, String>,
    /// What the model checker said of the harnesses, by their paths.
    answers: BTreeMap<String, String>,
}

impl Receipt {
    /// A receipt as it is stored.
    ///
    /// # Errors
    /// A table without a commit, or with a row that is none of a receipt.
    fn of(table: Table) -> Result<Receipt, String> {
        let wrong = |what: String| format!("kani-{}.tsv: no row of a receipt: {what}", table.date);
        if table.columns != COLUMNS {
            return Err(wrong(table.columns.join(" ")));
        }
        let mut answers = BTreeMap::new();
        for row in &table.rows {
            let is_known = [VERIFIED, FAILED, NO_ANSWER].contains(&row[2].as_str());
            if !is_known || row[1] != expected(&row[0]) {
                return Err(wrong(row.join(" ")));
            }
            answers.insert(row[0].clone(), row[2].clone());
        }
        let (mut commit, mut files) = (String::new(), BTreeMap::new());
        for line in &table.head {
            match *line.split(' ').collect::<Vec<_>>() {
                ["commit", of] => commit = of.to_owned(),
                ["file", file, hash] => {
                    files.insert(file.to_owned(), hash.to_owned());
                }
                _ => {}
            }
        }
        if commit.is_empty() {
            return Err(format!("kani-{}.tsv: expected a line '# commit HASH'", table.date));
        }
        Ok(Receipt { table, commit, files, answers })
    }

    /// A receipt from what Kani printed, one harness after the other; still without the files.
    ///
    /// # Errors
    /// A log without harnesses, or of several threads, which are mixed up.
    fn from_log(date: &str, commit: &str, log: &str) -> Result<Receipt, String> {
        if log.lines().any(|line| line.starts_with("Thread ")) {
            return Err(
                "the log of several threads is mixed up: run cargo kani without -j".to_owned()
            );
        }
        let version = |start: &str| log.lines().map(str::trim).find(|line| line.starts_with(start));
        let head = ["Kani Rust Verifier ", "CBMC "].into_iter().filter_map(version);
        let mut head: Vec<String> = head.map(str::to_owned).collect();
        let rows: Vec<Vec<String>> = log.split("Checking harness ").skip(1).map(row).collect();
        if rows.is_empty() {
            return Err("no line of the log begins with 'Checking harness': \
                        it is the output of cargo kani that is needed"
                .to_owned());
        }
        let seconds: f64 = rows.iter().filter_map(|row| row[3].parse::<f64>().ok()).sum();
        let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
        head.push(format!("{os} {arch}, {} harnesses in {seconds:.0} s", rows.len()));
        head.push(format!("commit {commit}"));
        let columns = COLUMNS.map(str::to_owned).into();
        Receipt::of(Table { date: date.to_owned(), head, columns, rows })
    }

    /// The files that the answers hang on, with their hashes in the commit of the run.
    fn files_of_the_commit(&self) -> io::Result<BTreeMap<String, String>> {
        let listed =
            git(&["ls-tree", "-r", "--name-only", &self.commit, "src/kernel", "props/src"])?;
        let of_harnesses: BTreeSet<String> =
            self.answers.keys().map(|path| file_of(path)).collect();
        let files = listed.lines().filter(|file| is_shared(file) || of_harnesses.contains(*file));
        let hashed = |file: &str| {
            let text = git(&["show", &format!("{}:{file}", self.commit)])?;
            Ok((file.to_owned(), hash(&text)))
        };
        files.map(hashed).collect()
    }

    /// The files of the receipt that are not now what they were, or are no more.
    fn changed(&self) -> Vec<String> {
        let now = |file: &str| std::fs::read_to_string(root().join(file)).map(|text| hash(&text));
        let differs = |(file, then): &(&String, &String)| now(file).ok().as_ref() != Some(*then);
        self.files.iter().filter(differs).map(|(file, _)| file.clone()).collect()
    }

    /// Whether it stands behind a harness, with the files that have changed since.
    fn stands_behind(&self, path: &str, changed: &[String]) -> bool {
        let (name, file) = (own_name(path), file_of(path));
        let verified =
            self.answers.iter().any(|(of, said)| own_name(of) == name && said == VERIFIED);
        let differs = changed.iter().any(|changed| is_shared(changed) || *changed == file);
        verified && self.files.contains_key(&file) && !differs
    }
}

fn is_shared(file: &str) -> bool {
    SHARED.iter().any(|shared| file.starts_with(shared))
}

/// What Kani printed about one harness, as a row.
fn row(block: &str) -> Vec<String> {
    let after = |start: &str| block.lines().find_map(|line| line.trim().strip_prefix(start));
    let none = ["timed out", "CBMC failed", "Status: ERROR", "out of memory"];
    let verdict = match after("VERIFICATION:- ") {
        _ if none.iter().any(|sign| block.contains(sign)) => NO_ANSWER,
        Some(verdict) if verdict.starts_with("SUCCESSFUL") => VERIFIED,
        Some(_) => FAILED,
        None => NO_ANSWER,
    };
    let seconds = after("Verification Time: ").and_then(|t| t.trim_end_matches('s').parse().ok());
    let seconds = seconds.map_or(String::new(), |s: f64| format!("{s:.2}"));
    let conditions =
        after("** ").and_then(|rest| rest.split(" of ").nth(1)?.split(' ').next()).unwrap_or("");
    let harness = block.lines().next().unwrap_or_default().trim_end_matches('.');
    [harness, expected(harness), verdict, &seconds, conditions].map(str::to_owned).into()
}

/// The newest receipt of the model checker, with the files that have changed since: read once.
fn newest() -> &'static (Receipt, Vec<String>) {
    static NEWEST: OnceLock<(Receipt, Vec<String>)> = OnceLock::new();
    NEWEST.get_or_init(|| {
        let receipt = Table::newest("kani-").and_then(Receipt::of);
        let receipt = receipt.unwrap_or_else(|why| panic!("props/receipts: {why}"));
        let changed = receipt.changed();
        (receipt, changed)
    })
}

/// Whether the model checker has verified a harness, for these sources.
pub fn is_verified(harness: &Harness) -> bool {
    let (receipt, changed) = newest();
    receipt.stands_behind(&harness.path(), changed)
}

/// The files that have changed since the newest receipt of the model checker.
pub fn changed_files() -> &'static [String] {
    &newest().1
}

/// What the newest receipt says of these harnesses, as a sentence of `VERIFY.md`, and what `cargo test` makes of the others.
pub fn said(harnesses: &[Harness]) -> String {
    let (receipt, changed) = newest();
    let Receipt { table: Table { date, .. }, commit, answers, .. } = receipt;
    let known = |answer| answers.values().filter(|known| *known == answer).count();
    let standing = harnesses.iter().filter(|harness| is_verified(harness)).count();
    let but = [(FAILED, "not"), (NO_ANSWER, "without an answer")]
        .map(|(answer, words)| (known(answer), words))
        .map(
            |(count, words)| if count == 0 { String::new() } else { format!(", {count} {words}") },
        );
    format!(
        "Kani ({date}, at `{}`): {} of {} harnesses as expected{}; {} files (last line) have changed since, so it \
         stands behind {standing} of the {} harnesses of today.",
        &commit[..commit.len().min(7)],
        known(VERIFIED),
        answers.len(),
        but.concat(),
        changed.len(),
        harnesses.len(),
    )
}

/// Whether a harness is decided by running it on all its values, which are few: asked once.
pub fn is_decided(harness: &Harness) -> bool {
    static DECIDED: Known<String, bool> = Mutex::new(BTreeMap::new());
    *once(&DECIDED, harness.path(), || harness.is_decided())
}

/// Writes the receipt of a run and answers where. `log` is what `cargo kani` printed, of the commit that is checked out.
///
/// # Errors
/// A log that is none, sources that are not those of the commit or are newer than the log, and a commit that git does not have.
pub fn make(log: &Path) -> io::Result<PathBuf> {
    let at = |why: io::Error| io::Error::new(why.kind(), format!("{}: {why}", log.display()));
    let text = std::fs::read_to_string(log).map_err(at)?;
    let changes = git(&["status", "--porcelain", "--", "src/kernel", "props/src"])?;
    if !changes.is_empty() {
        return Err(io::Error::other(format!(
            "these files are not those of the commit; commit them and run cargo kani again:\n{changes}"
        )));
    }
    let commit = git(&["rev-parse", "HEAD"])?.trim().to_owned();
    let path = std::path::absolute(log)?.display().to_string();
    let written = output("date", &["-u", "-r", &path, "+%s %F"])?;
    let (seconds, date) = written.trim().split_once(' ').unwrap_or_default();
    let committed = git(&["log", "-1", "--format=%ct"])?;
    if committed.trim().parse::<u64>().ok() > seconds.parse().ok() {
        return Err(io::Error::other(format!(
            "{} is older than the commit {commit}: run cargo kani again",
            log.display()
        )));
    }
    let receipt = Receipt::from_log(date, &commit, &text).map_err(io::Error::other)?;
    let files = receipt.files_of_the_commit()?;
    let mut table = receipt.table;
    table.head.extend(files.iter().map(|(file, hash)| format!("file {file} {hash}")));
    let path = root().join(format!("props/receipts/kani-{date}.tsv"));
    std::fs::write(&path, table.text())?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims;

    const LOG: &str = "\
Kani Rust Verifier 0.67.0 (cargo plugin)
   Compiling props v0.1.0
Checking harness claims::a::holds...
CBMC version 6.6.0 (cbmc-6.6.0) 64-bit x86_64 linux
RESULTS:
SUMMARY:
 ** 0 of 36 failed (1 unreachable)

VERIFICATION:- SUCCESSFUL
Verification Time: 0.4532s

Checking harness claims::a::control_fails...
 ** 1 of 35 failed
Failed Checks: assertion failed: a < b
VERIFICATION:- SUCCESSFUL (encountered one or more panics as expected)
Verification Time: 12.5s

Checking harness claims::a::wrong...
 ** 1 of 5 failed (2 unreachable)
Failed Checks: assertion failed: a < b
VERIFICATION:- FAILED
Verification Time: 1s

Checking harness claims::a::slow...
CBMC timed out. You may want to rerun your proof with a larger timeout
VERIFICATION:- FAILED

Checking harness claims::a::ended...
";

    fn receipt() -> Receipt {
        let mut receipt = Receipt::from_log("2026-11-21", "c0ffee", LOG).expect("a log");
        receipt.files = [("props/src/claims/a.rs".to_owned(), "0123".to_owned())].into();
        receipt
    }

    #[test]
    fn a_log_of_kani_becomes_a_receipt_and_the_receipt_is_read_as_it_was() {
        let receipt = Receipt::from_log("2026-11-21", "c0ffee", LOG).expect("a log");
        let text = receipt.table.text();
        let rows = "\
claims::a::holds\tsuccess\tverified\t0.45\t36
claims::a::control_fails\tshould_panic\tverified\t12.50\t35
claims::a::wrong\tsuccess\tfailed\t1.00\t5
claims::a::slow\tsuccess\tno answer\t\t
claims::a::ended\tsuccess\tno answer\t\t
";
        assert!(text.ends_with(rows), "{text}");
        let read = |text: &str| Receipt::of(Table::parse("2026-11-21", text)?);
        assert_eq!(read(&text), Ok(receipt));
        assert!(read(&text.replace("should_panic", "success")).is_err());
        assert!(read(&text.replace("verified", "perhaps")).is_err());
        assert!(read(&text.replace("\t12.50", "")).is_err());
        assert!(read(&text.replace("# commit c0ffee\n", "")).unwrap_err().contains("commit"));
    }

    #[test]
    fn what_is_no_log_is_refused() {
        let error = |log: &str| Receipt::from_log("", "", log).unwrap_err();
        assert!(error("test result: ok").contains("output of cargo kani"));
        assert!(error("Thread 0: Checking harness claims::a::holds...\n").contains("without -j"));
    }

    #[test]
    fn a_receipt_stands_behind_files_that_have_not_changed_and_no_others() {
        let receipt = receipt();
        let of = |path: &str, changed: &[&str]| {
            receipt.stands_behind(
                path,
                &changed.iter().map(|&file| file.to_owned()).collect::<Vec<_>>(),
            )
        };
        assert!(of("claims::a::holds", &[]));
        assert!(of("claims::a::holds", &["props/src/claims/b.rs"]));
        assert!(!of("claims::a::holds", &["props/src/claims/a.rs"]));
        assert!(!of("claims::a::holds", &["src/kernel/ball.rs"]));
        for other in ["claims::b::holds", "claims::a::wrong", "claims::a::new"] {
            assert!(!of(other, &[]), "{other}");
        }
        assert_eq!(receipt.changed(), ["props/src/claims/a.rs"]);
    }

    #[test]
    fn the_receipt_has_the_hashes_of_its_commit_and_refutes_no_harness() {
        let (receipt, _) = newest();
        let mut seen = BTreeSet::new();
        for (path, answer) in &receipt.answers {
            assert!(seen.insert(own_name(path)), "{path} is there twice");
            assert!(answer != FAILED, "{path} is refuted");
        }
        assert!(receipt.files.keys().any(|file| file == "src/kernel/positive_part.rs"));
        // A shallow clone and an unpacked archive do not have the commit.
        if git(&["cat-file", "-e", &receipt.commit]).is_err() {
            eprintln!("not compared with its files: this copy has no commit {}", receipt.commit);
            return;
        }
        let theirs = receipt.files_of_the_commit().expect("the files of the commit");
        assert_eq!(receipt.files, theirs, "made by another program than props receipt");
        let mut forged = receipt.clone();
        forged.files.insert("src/kernel/positive_part.rs".to_owned(), hash("another file"));
        assert_ne!(forged.files, theirs);
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
