//! Receipts of runs of the model checker Kani, `props/receipts/kani-DATE.tsv`: which harness got which verdict, in how many
//! seconds, by which versions, and for which sources (see [`crate::fingerprint`]).
//!
//! ```text
//! cargo kani 2>&1 | tee LOG               at the root, with Kani installed
//! cargo run -p props -- receipt LOG       writes props/receipts/kani-DATE.tsv
//! ```
//!
//! A receipt stands behind a harness as long as the harness and all that it reaches are what they were.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::fingerprint::Sources;
use crate::harness::Harness;

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

impl Answer {
    fn name(self) -> &'static str {
        ANSWERS.into_iter().find(|(_, answer)| *answer == self).map_or("", |(name, _)| name)
    }
}

/// One harness of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its path in the crate where it stood.
    pub harness: String,
    /// Whether it is a false twin, which must fail.
    pub control: bool,
    /// The verdict.
    pub answer: Answer,
    /// How long it took, where that is known.
    pub seconds: Option<f64>,
    /// How many conditions were decided, where that is known.
    pub conditions: Option<u32>,
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

const COLUMNS: &str = "harness\texpected\tverdict\tseconds\tconditions\tsources";

impl Receipt {
    /// The text of a receipt.
    pub fn text(&self) -> String {
        let mut text: String = self.head.iter().map(|line| format!("# {line}\n")).collect();
        let _ = writeln!(text, "{COLUMNS}");
        for run in &self.runs {
            let expected = expected(run.control);
            let seconds = run.seconds.map_or(String::new(), |s| format!("{s:.2}"));
            let conditions = run.conditions.map_or(String::new(), |n| n.to_string());
            let _ = writeln!(
                text,
                "{}\t{expected}\t{}\t{seconds}\t{conditions}\t{}",
                run.harness,
                run.answer.name(),
                run.sources
            );
        }
        text
    }

    /// Reads the text of a receipt.
    ///
    /// # Errors
    /// The line that is none of a receipt.
    pub fn parse(date: &str, text: &str) -> Result<Receipt, String> {
        let (mut head, mut runs, mut columns) = (Vec::new(), Vec::new(), false);
        for (number, line) in text.lines().enumerate() {
            let wrong = |what: &str| format!("line {}: {what}: {line}", number + 1);
            if let Some(comment) = line.strip_prefix("# ") {
                head.push(comment.to_owned());
            } else if line == COLUMNS {
                columns = true;
            } else if !columns {
                return Err(wrong("expected the names of the columns"));
            } else {
                let fields: Vec<&str> = line.split('\t').collect();
                let [harness, control, answer, seconds, conditions, sources] = fields[..] else {
                    return Err(wrong("expected six columns"));
                };
                let answer = ANSWERS.into_iter().find(|(name, _)| *name == answer);
                let known = [expected(false), expected(true)].contains(&control);
                let seconds = Some(seconds).filter(|s| !s.is_empty()).map(str::parse).transpose();
                let conditions = Some(conditions).filter(|s| !s.is_empty()).map(str::parse);
                let (Some((_, answer)), true, Ok(seconds), Ok(conditions)) =
                    (answer, known, seconds, conditions.transpose())
                else {
                    return Err(wrong("no verdict or no number"));
                };
                runs.push(Run {
                    harness: harness.to_owned(),
                    control: control == expected(true),
                    answer,
                    seconds,
                    conditions,
                    sources: sources.to_owned(),
                });
            }
        }
        Ok(Receipt { date: date.to_owned(), head, runs })
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
        let mut head = Vec::new();
        for version in ["Kani Rust Verifier ", "CBMC version ", "CBMC "] {
            let line = log.lines().map(str::trim).find(|line| line.starts_with(version));
            if let Some(line) = line
                && !head.iter().any(|known: &String| known.starts_with("CBMC"))
            {
                head.push(line.to_owned());
            }
        }
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
        if log.lines().any(|line| line.starts_with("Thread ")) {
            return Err(
                "the log of several threads is mixed up: run cargo kani without -j".to_owned()
            );
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

fn expected(control: bool) -> &'static str {
    if control { "should_panic" } else { "success" }
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
    let of =
        after("** ").and_then(|rest| rest.split(" of ").nth(1)?.split(' ').next()?.parse().ok());
    let control = own_name(name).starts_with("control_");
    Run {
        harness: name.to_owned(),
        control,
        answer,
        seconds,
        conditions: of,
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
            receipts.iter().flat_map(|receipt| {
                receipt
                    .runs
                    .iter()
                    .filter(|r| own_name(&r.harness) == harness)
                    .map(move |run| (receipt, run))
            })
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

/// The root of the workspace.
pub(crate) fn root() -> &'static Path {
    let props = Path::new(env!("CARGO_MANIFEST_DIR"));
    props.parent().unwrap_or(props)
}

fn directory() -> PathBuf {
    root().join("props/receipts")
}

/// The receipts in `props/receipts`, the oldest first.
///
/// # Errors
/// A file that can't be read, or that is no receipt.
pub fn stored() -> Result<Vec<Receipt>, String> {
    let directory = directory();
    let failed = |why: io::Error| format!("{}: {why}", directory.display());
    let mut receipts = Vec::new();
    for entry in std::fs::read_dir(&directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if let Some(date) = name.strip_prefix("kani-").and_then(|rest| rest.strip_suffix(".tsv")) {
            let text = std::fs::read_to_string(&path).map_err(failed)?;
            receipts.push(Receipt::parse(date, &text).map_err(|why| format!("{name}: {why}"))?);
        }
    }
    receipts.sort_by(|a, b| a.date.cmp(&b.date));
    Ok(receipts)
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
    let hashes = Sources::read(root())?.fingerprints();
    let mut receipt = Receipt::from_log(&date(ended), &text, &hashes).map_err(io::Error::other)?;
    let seconds: f64 = receipt.runs.iter().filter_map(|run| run.seconds).sum();
    let newest = newest(&[root().join("src/kernel"), root().join("props/src")])?;
    if newest > ended.checked_sub(Duration::from_secs_f64(seconds)).unwrap_or(ended) {
        return Err(io::Error::other(format!(
            "{}: the kernel or the harnesses were changed after this run began; run cargo kani again",
            log.display()
        )));
    }
    let missing = hashes.len() - receipt.runs.len();
    receipt.head.push(format!("commit {}", commit()));
    receipt.head.push(format!(
        "{} {}, {} harnesses in {seconds:.0} s, {missing} not run",
        std::env::consts::OS,
        std::env::consts::ARCH,
        receipt.runs.len()
    ));
    let path = directory().join(format!("kani-{}.tsv", receipt.date));
    std::fs::write(&path, receipt.text())?;
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

/// The commit that is checked out, and whether kernel or harnesses differ from it.
fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).current_dir(root()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "HEAD"]) else { return "unknown".to_owned() };
    match git(&["status", "--porcelain", "--", "src", "props/src"]) {
        Some(changes) if changes.is_empty() => commit,
        _ => format!("{commit}, changed"),
    }
}

/// The day of a time, in UTC: by the calendar of eras of 400 years that begin with March.
fn date(time: SystemTime) -> String {
    let days = time.duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs() / 86_400);
    let (era, day) = ((days + 719_468) / 146_097, (days + 719_468) % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + era * 400 + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
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
            receipt.runs.iter().map(|r| (r.control, r.answer, r.seconds, r.conditions)).collect();
        use Answer::{Failed, NoAnswer, Verified};
        let expected = [
            (false, Verified, Some(0.4532), Some(36)),
            (true, Verified, Some(12.5), Some(35)),
            (false, Failed, Some(1.0), Some(5)),
            (false, NoAnswer, None, None),
            (false, NoAnswer, None, None),
        ];
        assert_eq!(found, expected);
        let versions = [
            "Kani Rust Verifier 0.67.0 (cargo plugin)",
            "CBMC version 6.6.0 (cbmc-6.6.0) 64-bit x86_64 linux",
        ];
        assert_eq!(receipt.head, versions);
        let mut read = Receipt::parse("2026-11-21", &receipt.text()).expect("a receipt");
        read.runs[0].seconds = Some(0.4532);
        assert_eq!(read, receipt);
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
    fn days_are_those_of_the_calendar() {
        let at = |days: u64| date(UNIX_EPOCH + Duration::from_secs(86_400 * days + 3600));
        assert_eq!(
            [0, 58, 59, 11_016, 19_782].map(at),
            ["1970-01-01", "1970-02-28", "1970-03-01", "2000-02-29", "2024-02-29"]
        );
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
