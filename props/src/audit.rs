//! Runs the rows of the ledger: progress and a table on the terminal, and a page to attach to a review.

use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write as _};
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::claim::{Claim, Outcome};
use crate::claims;

struct Result {
    row: &'static str,
    engine: &'static str,
    name: String,
    receipt: Option<String>,
    control: bool,
    seconds: f64,
    outcome: Outcome,
}

/// Runs the row with this id, or all of them. True if every check passed.
///
/// # Errors
/// An unknown id, or a page that can't be written.
pub fn audit(id: Option<&str>) -> io::Result<bool> {
    let claims: Vec<Claim> =
        claims::all().into_iter().filter(|c| id.is_none_or(|id| c.id == id)).collect();
    if claims.is_empty() {
        let known: Vec<&str> = claims::all().iter().map(|c| c.id).collect();
        let message = format!("no such row; the rows are {}", known.join(", "));
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    let results: Vec<Result> = claims.iter().flat_map(run).collect();
    println!("\n{}", table(&claims, &results));
    let page = page_path();
    std::fs::create_dir_all(page.parent().expect("a directory"))?;
    std::fs::write(&page, html(&claims, &results))?;
    println!("written: {}", page.display());
    Ok(results.iter().all(|r| r.outcome.is_ok()))
}

fn page_path() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("target"),
        PathBuf::from,
    );
    target.join("audit/index.html")
}

fn run(claim: &Claim) -> Vec<Result> {
    println!("row {}: {}", claim.id, claim.title);
    let one = |check: &crate::claim::Check| {
        let (engine, name, receipt) = (check.engine_name(), check.shown_name(), check.receipt());
        print!("  {engine:7} {name} ... ");
        let _ = io::stdout().flush();
        let start = Instant::now();
        let outcome = check.run();
        let seconds = start.elapsed().as_secs_f64();
        match &outcome {
            Ok(evidence) => println!("{} ({seconds:.2} s) {evidence}", paint("ok", "32")),
            Err(why) => println!("{} ({seconds:.2} s) {why}", paint("FAILED", "31")),
        }
        let (row, control) = (claim.id, check.control);
        Result { row, engine, name, receipt, control, seconds, outcome }
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

fn table(claims: &[Claim], results: &[Result]) -> String {
    let mut text = format!(
        "{:>4} {:>6} {:>8} {:>6} {:>8}  title\n",
        "row", "checks", "controls", "failed", "seconds"
    );
    for claim in claims {
        let of: Vec<&Result> = results.iter().filter(|r| r.row == claim.id).collect();
        let controls = of.iter().filter(|r| r.control).count();
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

fn html(claims: &[Claim], results: &[Result]) -> String {
    let failed = results.iter().filter(|r| r.outcome.is_err()).count();
    let mut text = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>signorini: audit</title><style>\
         body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}\
         table{{border-collapse:collapse;width:100%}}td,th{{border:1px solid #ccc;padding:.2em .5em;\
         text-align:left;vertical-align:top}}code{{overflow-wrap:anywhere}}.bad{{background:#fdd}}\
         </style><h1>signorini: audit</h1><p>{} checks, {failed} failed; seed {}.</p>",
        results.len(),
        crate::draws::seed()
    );
    for claim in claims {
        let _ = write!(
            text,
            "<h2 id=\"row-{}\">Row {}: {}</h2><p><b>The paper:</b> {}</p><p><b>As checked:</b> {}</p>\
             <p><b>Numbers:</b> {}</p><p><b>Assumed:</b> {}</p><p><b>Not established:</b> {}</p>",
            claim.id,
            claim.id,
            escape(claim.title),
            escape(claim.paper),
            escape(claim.statement),
            escape(claim.numbers),
            escape(claim.preconditions),
            escape(claim.limits)
        );
        text += "<table><tr><th>engine<th>check<th>outcome<th>seconds</tr>";
        for r in results.iter().filter(|r| r.row == claim.id) {
            let (class, word, detail) = match &r.outcome {
                Ok(evidence) => ("good", "ok", evidence),
                Err(why) => ("bad", "FAILED", why),
            };
            let kind = if r.control { " (control)" } else { "" };
            let receipt = r.receipt.as_ref().map_or(String::new(), |text| format!("; {text}"));
            let _ = write!(
                text,
                "<tr class=\"{class}\"><td>{}<td><code>{}</code>{kind}<td>{word}: {}{receipt}<td>{:.2}</tr>",
                r.engine,
                r.name,
                escape(detail),
                r.seconds
            );
        }
        text += "</table>";
    }
    text + "</html>\n"
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_escapes_what_it_shows_and_marks_failures() {
        let claims: Vec<Claim> = claims::all().into_iter().take(1).collect();
        let result = Result {
            row: "1",
            engine: "proof",
            name: "name".to_owned(),
            receipt: None,
            control: false,
            seconds: 0.0,
            outcome: Err("a < b".to_owned()),
        };
        let page = html(&claims, &[result]);
        assert!(page.contains("FAILED: a &lt; b") && page.contains("1 checks, 1 failed"));
        assert!(page.contains("a &lt;= [a]+"));
    }

    #[test]
    fn an_unknown_row_names_the_known_ones() {
        assert!(audit(Some("99")).unwrap_err().to_string().contains("the rows are 1, 2, 3"));
    }
}
