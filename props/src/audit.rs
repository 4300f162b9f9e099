//! Runs the rows of the ledger: each check with what it found, and a table.

use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write as _};
use std::time::Instant;

use crate::claim::{Check, Claim, Outcome};
use crate::claims;
use crate::draws;

/// A check that was run.
struct Line {
    row: &'static str,
    check: Check,
    seconds: f64,
    outcome: Outcome,
}

/// Runs the row with this id, or all of them; of a row, the checks with this name, or all of them. True if every check
/// passed.
///
/// # Errors
/// An unknown id or name.
pub fn audit(id: Option<&str>, name: Option<&str>) -> io::Result<bool> {
    let mut claims: Vec<Claim> =
        claims::all().into_iter().filter(|c| id.is_none_or(|id| c.id == id)).collect();
    if claims.is_empty() {
        let known: Vec<&str> = claims::all().iter().map(|c| c.id).collect();
        return Err(io::Error::other(format!("no such row; the rows are {}", known.join(", "))));
    }
    for claim in &mut claims {
        claim.checks.retain(|check| name.is_none_or(|name| check.name == name));
    }
    if claims.iter().all(|claim| claim.checks.is_empty()) {
        return Err(io::Error::other(format!("row {} has no such check", id.unwrap_or("?"))));
    }
    let lines: Vec<Line> = claims.iter().flat_map(run).collect();
    println!("\n{}{}", table(&claims, &lines), failures(&lines));
    Ok(lines.iter().all(|line| line.outcome.is_ok()))
}

fn run(claim: &Claim) -> Vec<Line> {
    println!("row {}: {}", claim.id, claim.title);
    let one = |check: &Check| {
        let (engine, name) = (check.engine_name(), check.name);
        print!("  {engine:7} {name} ... ");
        let _ = io::stdout().flush();
        let start = Instant::now();
        let outcome = check.run();
        let seconds = start.elapsed().as_secs_f64();
        match &outcome {
            Ok(evidence) => println!("{} ({seconds:.2} s) {evidence}", paint("ok", "32")),
            Err(why) => println!("{} ({seconds:.2} s) {why}", paint("FAILED", "31")),
        }
        Line { row: claim.id, check: *check, seconds, outcome }
    };
    claim.checks.iter().map(one).collect()
}

fn paint(text: &str, colour: &str) -> String {
    if io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        format!("\x1b[{colour}m{text}\x1b[0m")
    } else {
        text.to_owned()
    }
}

fn table(claims: &[Claim], lines: &[Line]) -> String {
    let mut text = format!(
        "{:>4} {:>6} {:>8} {:>6} {:>8}  title\n",
        "row", "checks", "controls", "failed", "seconds"
    );
    for claim in claims {
        let of: Vec<&Line> = lines.iter().filter(|r| r.row == claim.id).collect();
        let controls = of.iter().filter(|r| r.check.control).count();
        let failed = of.iter().filter(|r| r.outcome.is_err()).count();
        let seconds: f64 = of.iter().map(|r| r.seconds).sum();
        let _ = writeln!(
            text,
            "{:>4} {:>6} {controls:>8} {failed:>6} {seconds:>8.2}  {}",
            claim.id,
            of.len() - controls,
            claim.title
        );
    }
    text
}

/// The checks that failed, each with its reason and the command that repeats it: the last lines, which a log keeps.
fn failures(lines: &[Line]) -> String {
    let failed = lines.iter().filter_map(|line| Some((line, line.outcome.as_ref().err()?)));
    let one = |(line, why): (&Line, &String)| {
        let Line { row, check, .. } = line;
        format!(
            "FAILED in row {row}: {} {}: {why}\n  again: PROPS_SEED={} cargo run -p props -- audit {row} {}\n",
            check.engine_name(),
            check.name,
            draws::seed(),
            check.name
        )
    };
    failed.map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim::{Engine, Stated, by};

    #[test]
    fn what_failed_is_named_last_with_its_reason_and_the_command_that_repeats_it() {
        let line = |name, outcome| {
            let check = by(Engine::Exact, name, Stated::In("line"), || Err(String::new()));
            Line { row: "10", check, seconds: 0.5, outcome }
        };
        let found = failures(&[
            line("this_one", Ok("fine".into())),
            line("that_one", Err("left >= right fails".into())),
        ]);
        let seed = draws::seed();
        let expected = format!(
            "FAILED in row 10: exact that_one: left >= right fails\n  again: PROPS_SEED={seed} cargo run -p props -- audit 10 that_one\n"
        );
        assert_eq!(found, expected);
    }

    #[test]
    fn an_unknown_row_names_the_known_ones_and_an_unknown_check_is_an_error() {
        let why = audit(Some("99"), None).unwrap_err().to_string();
        assert!(why.contains("the rows are 1, 2, 3"), "{why}");
        let why = audit(Some("1"), Some("nothing")).unwrap_err().to_string();
        assert!(why.contains("row 1 has no such check"), "{why}");
    }
}
