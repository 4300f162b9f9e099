//! What an audit found: a page to attach to a review, and its twin in JSON. Both say where it was run, and on what.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::{Value, json};

use crate::claim::{Check, Claim, Outcome};
use crate::draws;
use crate::items::{ITEMS, Item};
use crate::receipt::output;

/// A check that was run.
pub struct Line {
    /// The row.
    pub row: &'static str,
    /// The check.
    pub check: Check,
    /// How long it took.
    pub seconds: f64,
    /// What it answered.
    pub outcome: Outcome,
}

/// Everything that the page and its twin show.
pub struct Report {
    /// Where and on what it was run. What is not known says so.
    pub provenance: Vec<(&'static str, String)>,
    /// The rows that were run.
    pub claims: Vec<Claim>,
    /// Whether these are all.
    pub complete: bool,
    /// What was found.
    pub lines: Vec<Line>,
}

/// The provenance of what this process does now.
pub fn provenance() -> Vec<(&'static str, String)> {
    let said = |program, arguments: &[&str]| {
        output(program, arguments).unwrap_or_else(|| "unknown".to_owned())
    };
    let changed = match output("git", &["status", "--porcelain"]).map(|files| files.lines().count())
    {
        Some(0) => "no".to_owned(),
        Some(n) => format!("YES: {n} files differ from the commit"),
        None => "unknown".to_owned(),
    };
    let cores = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
    let profile = if cfg!(debug_assertions) { "with" } else { "without" };
    vec![
        ("commit", said("git", &["rev-parse", "HEAD"])),
        ("changed since", changed),
        ("Cargo.lock (git hash-object)", said("git", &["hash-object", "Cargo.lock"])),
        ("compiler", said("rustc", &["--version"])),
        ("build", format!("{profile} debug assertions")),
        ("host", said("uname", &["-srm"])),
        ("processors", cores.to_string()),
        ("date", said("date", &["-u", "+%Y-%m-%dT%H:%M:%SZ"])),
        ("seed of the draws", draws::seed().to_string()),
    ]
}

impl Report {
    fn failed(&self) -> usize {
        self.lines.iter().filter(|line| line.outcome.is_err()).count()
    }

    fn of(&self, row: &str) -> impl Iterator<Item = &Line> {
        self.lines.iter().filter(move |line| line.row == row)
    }

    fn summary(&self) -> String {
        let controls = self.lines.iter().filter(|line| line.check.control).count();
        let rows = if self.claims.len() == 1 { "row" } else { "rows" };
        let part = if self.complete { "" } else { " This is a part of the ledger, not all of it." };
        format!(
            "{} checks and {controls} controls in {} {rows}: {}.{part}",
            self.lines.len() - controls,
            self.claims.len(),
            match self.failed() {
                0 => "all passed".to_owned(),
                n => format!("{n} FAILED"),
            }
        )
    }

    /// How many checks, controls apart, there are by each engine.
    fn by_engine(&self) -> String {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for line in self.lines.iter().filter(|line| !line.check.control) {
            *counts.entry(line.check.engine_name()).or_default() += 1;
        }
        let listed: Vec<String> = counts.iter().map(|(name, n)| format!("{name} {n}")).collect();
        let drawn = counts.get("draws").map_or(String::new(), |n| {
            format!("; {n} harnesses were only run on random draws: no receipt of the model checker is about these sources")
        });
        format!("Checks by engine: {}{drawn}.", listed.join(", "))
    }

    /// The items that are shown: of a part of the ledger, those that its checks are about.
    fn items(&self) -> impl Iterator<Item = &'static Item> {
        let shown = |item: &&Item| self.complete || !item.found(&self.claims).is_empty();
        ITEMS.iter().filter(shown)
    }

    /// What a check of a row answered: that it passed, or not.
    fn outcome_of(&self, claim: &Claim, check: &Check) -> Option<bool> {
        let same =
            |line: &&Line| line.check.name == check.name && line.check.engine == check.engine;
        self.of(claim.id).find(same).map(|line| line.outcome.is_ok())
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// What a link to an item or a check can point to.
fn anchor(parts: &[&str]) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    parts.join(" ").chars().map(plain).collect()
}

fn link(parts: &[&str], shown: &str) -> String {
    format!("<a href=\"#{}\">{}</a>", anchor(parts), escape(shown))
}

/// A table of cells in HTML; the rows that are `true` are marked as bad.
fn table(head: &[&str], rows: impl Iterator<Item = (bool, Vec<String>)>) -> String {
    let mut text = format!("<table><tr><th>{}</tr>", head.join("<th>"));
    for (bad, cells) in rows {
        let class = if bad { " class=\"bad\"" } else { "" };
        let _ = write!(text, "<tr{class}><td>{}</tr>", cells.join("<td>"));
    }
    text + "</table>"
}

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:64em;margin:2em auto;padding:0 1em}\
    table{border-collapse:collapse;width:100%;margin:.6em 0}\
    td,th{border:1px solid #bbb;padding:.2em .5em;text-align:left;vertical-align:top}\
    code{overflow-wrap:anywhere;font-size:.9em}td:first-child{white-space:nowrap}.bad{background:#fdd}\
    .verdict{font-size:1.2em;border-left:.4em solid #393;padding-left:.6em}.verdict.bad{border-color:#c22}\
    nav{display:flex;flex-wrap:wrap;gap:0 .8em}nav a{white-space:nowrap}@media print{nav{display:none}}\
    @media(max-width:40em){table{display:block;overflow-x:auto}td:first-child{white-space:normal}}";

/// The page: the verdict first, then where it was run, the rows in short, the items of the paper, the rows with their checks.
pub fn html(report: &Report) -> String {
    let bad = if report.failed() > 0 { " bad" } else { "" };
    let rows: Vec<String> =
        report.claims.iter().map(|c| link(&["row", c.id], &format!("Row {}", c.id))).collect();
    let provenance =
        report.provenance.iter().map(|(name, value)| (false, vec![escape(name), escape(value)]));
    let in_short = report.claims.iter().map(|claim| {
        let controls = report.of(claim.id).filter(|line| line.check.control).count();
        let failed = report.of(claim.id).filter(|line| line.outcome.is_err()).count();
        let seconds: f64 = report.of(claim.id).map(|line| line.seconds).sum();
        let checks = report.of(claim.id).count() - controls;
        let numbers = [checks, controls, failed].map(|n| n.to_string());
        let row = [link(&["row", claim.id], claim.id), escape(claim.title)];
        (failed > 0, [&row[..], &numbers, &[format!("{seconds:.2}")]].concat())
    });
    let items: Vec<String> =
        report.items().map(|item| link(&["item", item.name], item.name)).collect();
    let mut text = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <title>signorini: audit</title><style>{STYLE}</style><h1>signorini: audit</h1><p class=\"verdict{bad}\">{}</p><p>{}</p>\
         <nav>{}</nav><h2>Provenance</h2>{}<h2>Summary</h2>{}\
         <p>What the engines are, what is trusted, and the errata of the paper: VERIFY.md.</p>\
         <h2>Items of the paper</h2><nav>{}</nav>",
        escape(&report.summary()),
        escape(&report.by_engine()),
        rows.concat(),
        table(&["what", "value"], provenance),
        table(&["row", "title", "checks", "controls", "failed", "seconds"], in_short),
        items.concat(),
    );
    report.items().for_each(|item| text += &item_view(item, report));
    report.claims.iter().for_each(|claim| text += &row_view(claim, report));
    text + "</html>\n"
}

/// An item, with the checks that are about it.
fn item_view(item: &Item, report: &Report) -> String {
    let Item { name, says, missing } = item;
    let mut text =
        format!("<h3 id=\"{}\">{}</h3><p>{}.", anchor(&["item", name]), escape(name), escape(says));
    if !missing.is_empty() {
        let missing = escape(missing);
        let _ = write!(text, " <b>Not checked, or taken from the literature:</b> {missing}.");
    }
    let found = item.found(&report.claims);
    if found.is_empty() {
        return text + "</p><p>No check is about it.</p>";
    }
    let rows = found.into_iter().map(|(claim, check)| {
        let word = match report.outcome_of(claim, check) {
            Some(true) => "ok",
            Some(false) => "FAILED",
            None => "not run",
        };
        let name = link(&["check", claim.id, check.engine.name(), check.name], &check.shown_name());
        let row = link(&["row", claim.id], claim.id);
        (word != "ok", vec![row, name, check.engine_name().to_owned(), word.to_owned()])
    });
    text + "</p>" + &table(&["row", "check", "engine", "outcome"], rows)
}

fn row_view(claim: &Claim, report: &Report) -> String {
    let id = claim.id;
    let items: Vec<String> =
        claim.items().map(|item| link(&["item", item.name], item.name)).collect();
    let mut text = format!(
        "<h2 id=\"{}\">Row {id}: {}</h2><p>{}</p>",
        anchor(&["row", id]),
        escape(claim.title),
        items.join(", ")
    );
    for (name, content) in [
        ("The paper", claim.paper),
        ("As checked", claim.statement),
        ("Numbers", claim.numbers),
        ("Assumed", claim.preconditions),
        ("Not established", claim.limits),
        ("Why one engine", claim.single.unwrap_or_default()),
    ] {
        if !content.is_empty() {
            let _ = write!(text, "<p><b>{name}:</b> {}</p>", escape(content));
        }
    }
    let lines = report.of(id).map(|Line { check, seconds, outcome, .. }| {
        let (word, detail) = match outcome {
            Ok(evidence) => ("ok", evidence),
            Err(why) => ("FAILED", why),
        };
        let receipt = check.receipt().map_or(String::new(), |receipt| format!("; {receipt}"));
        let cells = vec![
            check.engine_name().to_owned(),
            format!(
                "<code id=\"{}\">{}</code>{}",
                anchor(&["check", id, check.engine.name(), check.name]),
                escape(&check.shown_name()),
                if check.control { " (control)" } else { "" }
            ),
            format!("{word}: {}", escape(&(detail.clone() + &receipt))),
            format!("{seconds:.2}"),
        ];
        (outcome.is_err(), cells)
    });
    let run = format!("<p><b>Run:</b> <code>cargo run -p props -- audit {id} [NAME]</code></p>");
    text + &run + &table(&["engine", "check", "outcome", "seconds"], lines)
}

/// The same as JSON.
pub fn json(report: &Report) -> String {
    let checks: Vec<Value> = report
        .lines
        .iter()
        .map(|Line { row, check, seconds, outcome }| {
            let (Ok(said) | Err(said)) = outcome;
            json!({
                "row": row, "engine": check.engine_name(), "name": check.shown_name(), "control": check.control,
                "passed": outcome.is_ok(), "seconds": seconds, "said": said, "receipt": check.receipt(),
            })
        })
        .collect();
    let of_item = |item: &Item| {
        let found = item.found(&report.claims).into_iter();
        let one = |(claim, check): (&Claim, &Check)| json!({"row": claim.id, "engine": check.engine_name(), "name": check.shown_name()});
        let missing = Some(item.missing).filter(|missing| !missing.is_empty());
        let checks: Vec<Value> = found.map(one).collect();
        json!({"name": item.name, "says": item.says, "literature": missing, "checks": checks})
    };
    let provenance: BTreeMap<&str, &String> =
        report.provenance.iter().map(|(name, value)| (*name, value)).collect();
    let all = json!({
        "schema": 1, "complete": report.complete, "failed": report.failed(), "provenance": provenance,
        "items": ITEMS.iter().map(of_item).collect::<Vec<_>>(), "checks": checks,
    });
    format!("{all:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims;

    fn report(outcome: Outcome) -> Report {
        let claims: Vec<Claim> = claims::all().into_iter().take(1).collect();
        let check = claims[0].checks[0];
        assert_eq!(check.name, "positive_part_satisfies_4");
        Report {
            provenance: vec![("commit", "c0ffee".to_owned())],
            lines: vec![Line { row: "1", check, seconds: 0.5, outcome }],
            claims,
            complete: false,
        }
    }

    #[test]
    fn the_page_escapes_what_it_shows_and_marks_failures() {
        let page = html(&report(Err("a < b".to_owned())));
        for part in [
            "FAILED: a &lt; b",
            "1 checks and 0 controls in 1 row: 1 FAILED. This is a part",
            "Checks by engine: proof 1.",
            "href=\"#item--4-\"",
            "id=\"item--4-\"",
            "a &lt;= [a]+",
            "c0ffee",
            "id=\"check-1-proof-positive-part-satisfies-4\"",
            "href=\"#check-1-proof-positive-part-satisfies-4\"",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(html(&report(Ok(String::new()))).contains("all passed"));
    }

    #[test]
    fn the_twin_in_json_says_what_was_found() {
        let found: Value =
            serde_json::from_str(&json(&report(Err("say \"no\"".to_owned())))).unwrap();
        assert_eq!(found["checks"][0]["said"], "say \"no\"");
        assert_eq!(found["failed"], 1);
        assert_eq!(found["checks"][0]["name"], "positive_part_satisfies_4");
        assert_eq!(found["items"].as_array().map(Vec::len), Some(ITEMS.len()));
    }
}
