//! Receipts of runs of other programs, tables in `props/receipts`, and what those of the model checker Kani say of a harness.
//!
//! ```text
//! cargo kani 2>&1 | tee LOG               at the root, with Kani installed
//! cargo run -p props -- receipt LOG       writes props/receipts/kani-DATE.tsv
//! ```
//!
//! Such a receipt says which harness got which verdict, in how many seconds, by which versions, and for which sources (see
//! [`crate::fingerprint`]). It stands behind a harness as long as the harness and all that it reaches are what they were.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::fingerprint::Sources;
use crate::harness::Harness;

/// The root of the workspace.
pub(crate) fn root() -> &'static Path {
    let props = Path::new(env!("CARGO_MANIFEST_DIR"));
    props.parent().unwrap_or(props)
}

/// The output of a program, run at the root.
pub(crate) fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).current_dir(root()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

fn directory() -> PathBuf {
    root().join("props/receipts")
}

/// A receipt as it is stored: lines `# HEAD`, the names of the columns, and rows of columns between tabs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// When: year-month-day, in UTC.
    pub date: String,
    /// Versions, commit, machine: a line for each.
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

    /// The receipts in `props/receipts` whose names are `prefix` and a date, the oldest first.
    ///
    /// # Errors
    /// A file that can't be read, or that is no receipt.
    pub fn stored(prefix: &str) -> Result<Vec<Table>, String> {
        let directory = directory();
        let failed = |why: io::Error| format!("{}: {why}", directory.display());
        let mut tables = Vec::new();
        for entry in std::fs::read_dir(&directory).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if let Some(date) = name.strip_prefix(prefix).and_then(|n| n.strip_suffix(".tsv")) {
                tables.push(Table::parse(date, &std::fs::read_to_string(&path).map_err(failed)?)?);
            }
        }
        tables.sort_by(|a, b| a.date.cmp(&b.date));
        Ok(tables)
    }
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

/// One harness of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its path in the crate where it stood.
    pub harness: String,
    /// The verdict.
    pub answer: Answer,
    /// How long it took, where that is known.
    pub seconds: String,
    /// How many conditions were decided, where that is known.
    pub conditions: String,
    /// The fingerprint of the sources that it was about.
    pub sources: String,
}

/// One run of the model checker over the harnesses.
#[derive(Clone, Debug, PartialEq)]
pub struct Receipt {
    /// When: year-month-day, in UTC.
    pub date: String,
    /// Versions, commit, machine: a line for each.
    pub head: Vec<String>,
    /// The harnesses.
    pub runs: Vec<Run>,
}

const COLUMNS: [&str; 6] = ["harness", "expected", "verdict", "seconds", "conditions", "sources"];

/// What is expected of a harness: a false twin must fail.
fn expected(harness: &str) -> &'static str {
    if own_name(harness).starts_with("control_") { "should_panic" } else { "success" }
}

impl Receipt {
    fn table(&self) -> Table {
        let row = |run: &Run| {
            let verdict = ANSWERS.iter().find(|(_, answer)| *answer == run.answer);
            let verdict = verdict.map_or("", |(name, _)| name);
            let Run { harness, seconds, conditions, sources, .. } = run;
            [harness, expected(harness), verdict, seconds, conditions, sources]
                .map(str::to_owned)
                .into()
        };
        let rows = self.runs.iter().map(row).collect();
        let columns = COLUMNS.map(str::to_owned).into();
        Table { date: self.date.clone(), head: self.head.clone(), columns, rows }
    }

    /// A receipt as it is stored.
    ///
    /// # Errors
    /// A row that is none of a receipt.
    pub fn of(table: &Table) -> Result<Receipt, String> {
        let wrong = |what: String| format!("{}: no row of a receipt: {what}", table.date);
        if table.columns != COLUMNS {
            return Err(wrong(table.columns.join(" ")));
        }
        let run = |row: &Vec<String>| {
            let answer = ANSWERS.into_iter().find(|(name, _)| *name == row[2]);
            let (Some((_, answer)), true) = (answer, row[1] == expected(&row[0])) else {
                return Err(wrong(row.join(" ")));
            };
            let [harness, seconds, conditions, sources] = [0, 3, 4, 5].map(|at| row[at].clone());
            Ok(Run { harness, answer, seconds, conditions, sources })
        };
        let runs = table.rows.iter().map(run).collect::<Result<_, _>>()?;
        Ok(Receipt { date: table.date.clone(), head: table.head.clone(), runs })
    }

    /// A receipt from what Kani printed, one harness after the other.
    ///
    /// # Errors
    /// A log without harnesses, with one that does not exist, or of several threads, which are mixed up.
    pub fn from_log(
        date: &str,
        log: &str,
        hashes: &BTreeMap<String, String>,
    ) -> Result<Receipt, String> {
        if log.lines().any(|line| line.starts_with("Thread ")) {
            return Err(
                "the log of several threads is mixed up: run cargo kani without -j".to_owned()
            );
        }
        let version = |start: &str| log.lines().map(str::trim).find(|line| line.starts_with(start));
        let head = ["Kani Rust Verifier ", "CBMC "].into_iter().filter_map(version);
        let head = head.map(str::to_owned).collect();
        let mut runs = Vec::new();
        for block in log.split("Checking harness ").skip(1) {
            let name = block.lines().next().unwrap_or_default().trim_end_matches('.');
            let Some(sources) = hashes.get(own_name(name)) else {
                return Err(format!(
                    "the log has the harness '{name}', which these sources have not"
                ));
            };
            runs.push(run(name, block, sources));
        }
        if runs.is_empty() {
            return Err("no line of the log begins with 'Checking harness': \
                        it is the output of cargo kani that is needed"
                .to_owned());
        }
        Ok(Receipt { date: date.to_owned(), head, runs })
    }
}

/// The name of a harness without the modules in front of it, which may be others after a move: no two have the same.
fn own_name(path: &str) -> &str {
    path.rsplit("::").next().unwrap_or(path)
}

/// What Kani printed about one harness.
fn run(name: &str, block: &str, sources: &str) -> Run {
    let after = |start: &str| block.lines().find_map(|line| line.trim().strip_prefix(start));
    let none = ["timed out", "CBMC failed", "Status: ERROR", "out of memory"];
    let answer = match after("VERIFICATION:- ") {
        _ if none.iter().any(|sign| block.contains(sign)) => Answer::NoAnswer,
        Some(verdict) if verdict.starts_with("SUCCESSFUL") => Answer::Verified,
        Some(_) => Answer::Failed,
        None => Answer::NoAnswer,
    };
    let seconds = after("Verification Time: ").and_then(|t| t.trim_end_matches('s').parse().ok());
    let conditions =
        after("** ").and_then(|rest| rest.split(" of ").nth(1)?.split(' ').next()).unwrap_or("");
    Run {
        harness: name.to_owned(),
        answer,
        seconds: seconds.map_or(String::new(), |s: f64| format!("{s:.2}")),
        conditions: conditions.to_owned(),
        sources: sources.to_owned(),
    }
}

/// What is known of a harness from the receipts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The model checker has this answer for these sources, on this date.
    Answered(Answer, String),
    /// It was run for other sources only.
    Changed,
    /// It never was.
    Never,
}

impl Standing {
    /// What a harness has of these receipts: of several runs about these sources, a failure counts most, and any verdict
    /// more than none.
    fn of(harness: &str, sources: &str, receipts: &[Receipt]) -> Standing {
        let runs = || {
            let all = receipts.iter().flat_map(|of| of.runs.iter().map(move |run| (of, run)));
            all.filter(|(_, run)| own_name(&run.harness) == harness)
        };
        for answer in [Answer::Failed, Answer::Verified, Answer::NoAnswer] {
            if let Some((receipt, _)) =
                runs().rfind(|(_, r)| r.sources == sources && r.answer == answer)
            {
                return Standing::Answered(answer, receipt.date.clone());
            }
        }
        if runs().next().is_some() { Standing::Changed } else { Standing::Never }
    }

    /// Whether a receipt says that the model checker has verified it.
    pub fn is_verified(&self) -> bool {
        matches!(self, Standing::Answered(Answer::Verified, _))
    }
}

impl std::fmt::Display for Standing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Standing::Answered(Answer::Verified, date) => write!(f, "verified by receipt {date}"),
            Standing::Answered(Answer::Failed, date) => write!(f, "REFUTED by receipt {date}"),
            Standing::Answered(Answer::NoAnswer, date) => write!(f, "no answer by receipt {date}"),
            Standing::Changed => write!(f, "never run since the sources changed"),
            Standing::Never => write!(f, "never run"),
        }
    }
}

/// The receipts of the model checker, the oldest first.
///
/// # Errors
/// A file that can't be read, or that is no receipt.
pub fn stored() -> Result<Vec<Receipt>, String> {
    Table::stored("kani-")?.iter().map(Receipt::of).collect()
}

/// What stands behind a harness.
pub fn standing(harness: &Harness) -> Standing {
    static STANDINGS: OnceLock<BTreeMap<String, Standing>> = OnceLock::new();
    let standings = STANDINGS.get_or_init(|| {
        let receipts = stored().expect("props/receipts can be read");
        let hashes = Sources::read(root()).expect("the sources can be read").fingerprints();
        let of = |(harness, sources): (String, String)| {
            let standing = Standing::of(&harness, &sources, &receipts);
            (harness, standing)
        };
        hashes.into_iter().map(of).collect()
    });
    standings.get(harness.name).cloned().unwrap_or(Standing::Never)
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

/// Writes the receipt of a run of which Kani's output is in the file `log`, and answers where.
///
/// # Errors
/// A log that is none, or that is older than the sources.
pub fn make(log: &Path) -> io::Result<PathBuf> {
    let at = |why: io::Error| io::Error::new(why.kind(), format!("{}: {why}", log.display()));
    let text = std::fs::read_to_string(log).map_err(at)?;
    let ended = std::fs::metadata(log).and_then(|data| data.modified()).map_err(at)?;
    let log = std::path::absolute(log)?.display().to_string();
    let date = output("date", &["-u", "-r", &log, "+%Y-%m-%d"]);
    let date = date.ok_or_else(|| io::Error::other("the program date does not tell when"))?;
    let hashes = Sources::read(root())?.fingerprints();
    let mut receipt = Receipt::from_log(&date, &text, &hashes).map_err(io::Error::other)?;
    let seconds: f64 = receipt.runs.iter().filter_map(|run| run.seconds.parse::<f64>().ok()).sum();
    let newest = newest(&[root().join("src/kernel"), root().join("props/src")])?;
    if newest > ended.checked_sub(Duration::from_secs_f64(seconds)).unwrap_or(ended) {
        return Err(io::Error::other(format!(
            "{log}: the kernel or the harnesses were changed after this run began; run cargo kani again"
        )));
    }
    let commit = output("git", &["rev-parse", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let changes = output("git", &["status", "--porcelain", "--", "src", "props/src"]);
    let changed = if changes.is_some_and(|files| files.is_empty()) { "" } else { ", changed" };
    receipt.head.push(format!("commit {commit}{changed}"));
    receipt.head.push(format!(
        "{} {}, {} harnesses in {seconds:.0} s, {} not run",
        std::env::consts::OS,
        std::env::consts::ARCH,
        receipt.runs.len(),
        hashes.len() - receipt.runs.len()
    ));
    let path = directory().join(format!("kani-{}.tsv", receipt.date));
    std::fs::write(&path, receipt.table().text())?;
    Ok(path)
}

/// When a file below the directories was changed last.
fn newest(directories: &[PathBuf]) -> io::Result<SystemTime> {
    let mut latest = UNIX_EPOCH;
    for directory in directories {
        for entry in std::fs::read_dir(directory)? {
            let (path, data) = entry.and_then(|entry| Ok((entry.path(), entry.metadata()?)))?;
            latest = latest.max(if data.is_dir() { newest(&[path])? } else { data.modified()? });
        }
    }
    Ok(latest)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::claim::Subject;
    use crate::claims;

    /// All harnesses of the claims.
    fn harnesses() -> Vec<Harness> {
        let checks = claims::all().into_iter().flat_map(|claim| claim.checks);
        checks
            .filter_map(|check| match check.subject {
                Subject::Harness(harness) => Some(harness),
                _ => None,
            })
            .collect()
    }

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

    fn hashes() -> BTreeMap<String, String> {
        ["holds", "control_fails", "wrong", "slow", "ended"]
            .map(|name| (name.to_owned(), format!("hash of {name}")))
            .into()
    }

    fn receipt() -> Receipt {
        Receipt::from_log("2026-11-21", LOG, &hashes()).expect("a log")
    }

    #[test]
    fn a_log_of_kani_becomes_a_receipt_and_the_receipt_is_read_as_it_was() {
        let receipt = receipt();
        let found: Vec<_> =
            receipt.runs.iter().map(|r| (r.answer, &*r.seconds, &*r.conditions)).collect();
        use Answer::{Failed, NoAnswer, Verified};
        let expected = [
            (Verified, "0.45", "36"),
            (Verified, "12.50", "35"),
            (Failed, "1.00", "5"),
            (NoAnswer, "", ""),
            (NoAnswer, "", ""),
        ];
        assert_eq!(found, expected);
        let versions = [
            "Kani Rust Verifier 0.67.0 (cargo plugin)",
            "CBMC version 6.6.0 (cbmc-6.6.0) 64-bit x86_64 linux",
        ];
        assert_eq!(receipt.head, versions);
        let text = receipt.table().text();
        assert!(text.contains("claims::a::control_fails\tshould_panic\tverified\t12.50\t35\t"));
        let read = |text: &str| Receipt::of(&Table::parse("2026-11-21", text)?);
        assert_eq!(read(&text), Ok(receipt));
        assert!(read(&text.replace("should_panic", "success")).is_err());
        assert!(read(&text.replace("verified", "perhaps")).is_err());
        assert!(read(&text.replace("\t12.50", "")).is_err());
    }

    #[test]
    fn what_is_no_log_is_refused() {
        let error = |log: &str| Receipt::from_log("", log, &hashes()).unwrap_err();
        assert!(error("test result: ok").contains("output of cargo kani"));
        assert!(error("Checking harness claims::b::gone...\n").contains("'claims::b::gone'"));
        assert!(error("Thread 0: Checking harness claims::a::holds...\n").contains("without -j"));
    }

    #[test]
    fn a_receipt_stands_behind_the_sources_it_is_about_and_no_others() {
        let receipts = [receipt()];
        let of = |name: &str, sources: &str| Standing::of(name, sources, &receipts).to_string();
        assert_eq!(of("holds", "hash of holds"), "verified by receipt 2026-11-21");
        assert_eq!(of("holds", "another hash"), "never run since the sources changed");
        assert_eq!(of("wrong", "hash of wrong"), "REFUTED by receipt 2026-11-21");
        assert_eq!(of("slow", "hash of slow"), "no answer by receipt 2026-11-21");
        assert_eq!(of("new", "hash of new"), "never run");
    }

    #[test]
    fn a_verdict_counts_more_than_none_and_a_failure_most() {
        let mut receipts = vec![receipt(); 3];
        let slow =
            |receipts: &[Receipt]| Standing::of("slow", "hash of slow", receipts).to_string();
        receipts[1].runs[3].answer = Answer::Verified;
        receipts[1].date = "2026-11-22".to_owned();
        assert_eq!(slow(&receipts), "verified by receipt 2026-11-22");
        receipts[0].runs[3].answer = Answer::Failed;
        assert_eq!(slow(&receipts), "REFUTED by receipt 2026-11-21");
    }

    #[test]
    fn every_receipt_names_a_harness_once_and_none_refutes_one() {
        for receipt in stored().expect("receipts") {
            let mut seen = BTreeSet::new();
            for run in &receipt.runs {
                let what = format!("receipt {}: {}", receipt.date, run.harness);
                assert!(seen.insert(own_name(&run.harness)), "{what} is there twice");
            }
        }
        for harness in harnesses() {
            let standing = standing(&harness);
            let refuted = matches!(standing, Standing::Answered(Answer::Failed, _));
            assert!(!refuted, "{}: {standing}", harness.path());
        }
    }

    #[test]
    fn the_harnesses_in_the_sources_are_those_of_the_claims_and_no_two_have_one_name() {
        let sources = Sources::read(root()).expect("the sources").fingerprints();
        let mut claimed: Vec<&str> = harnesses().iter().map(|harness| harness.name).collect();
        claimed.sort_unstable();
        assert!(claimed.len() > 50 && sources.keys().eq(&claimed), "{sources:?}\n{claimed:?}");
    }
}
