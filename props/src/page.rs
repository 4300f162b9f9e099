//! What an audit found: a page to attach to a review, and its twin in JSON. Both say where it was run, and on what.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::claim::{Claim, Outcome};
use crate::items::{Item, items};
use crate::{draws, ledger};

/// A check that was run.
pub struct Line {
    /// The row.
    pub row: &'static str,
    /// By which means.
    pub engine: &'static str,
    /// Its name.
    pub name: String,
    /// Its name in the sources.
    pub declared: &'static str,
    /// What a receipt says of it.
    pub receipt: Option<String>,
    /// Whether it is a control.
    pub control: bool,
    /// How long it took.
    pub seconds: f64,
    /// What it answered.
    pub outcome: Outcome,
}

/// Where and on what an audit was run. What is not known says so.
pub struct Provenance(Vec<(&'static str, String)>);

/// The root of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").components().fold(
        PathBuf::new(),
        |mut path, part| {
            if part.as_os_str() == ".." {
                path.pop();
            } else {
                path.push(part);
            }
            path
        },
    )
}

/// The output of a program, run at the root.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).current_dir(root()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

impl Provenance {
    /// That of this process, now.
    pub fn now() -> Provenance {
        let known = |text: Option<String>| text.unwrap_or_else(|| "unknown".to_owned());
        let changed =
            output("git", &["status", "--porcelain"]).map(|files| match files.lines().count() {
                0 => "no".to_owned(),
                n => format!("YES: {n} files differ from the commit"),
            });
        let cores = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
        let profile = if cfg!(debug_assertions) { "with" } else { "without" };
        Provenance(vec![
            ("commit", known(output("git", &["rev-parse", "HEAD"]))),
            ("changed since", known(changed)),
            ("Cargo.lock (git hash-object)", known(output("git", &["hash-object", "Cargo.lock"]))),
            ("compiler", known(output("rustc", &["--version"]))),
            ("build", format!("{profile} debug assertions")),
            ("host", known(output("uname", &["-srm"]))),
            ("processors", cores.to_string()),
            ("date", known(output("date", &["-u", "+%Y-%m-%dT%H:%M:%SZ"]))),
            ("seed of the draws", draws::seed().to_string()),
        ])
    }
}

/// Everything that the page and its twin show.
pub struct Report {
    /// Where it was run.
    pub provenance: Provenance,
    /// The rows that were run.
    pub claims: Vec<Claim>,
    /// Whether these are all.
    pub complete: bool,
    /// What was found.
    pub lines: Vec<Line>,
}

impl Report {
    fn failed(&self) -> usize {
        self.lines.iter().filter(|line| line.outcome.is_err()).count()
    }

    fn of(&self, row: &str) -> impl Iterator<Item = &Line> {
        self.lines.iter().filter(move |line| line.row == row)
    }

    fn summary(&self) -> String {
        let controls = self.lines.iter().filter(|line| line.control).count();
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
}

/// How many checks, controls apart, there are by each engine.
fn by_engine(report: &Report) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for line in report.lines.iter().filter(|line| !line.control) {
        *counts.entry(line.engine).or_default() += 1;
    }
    let listed: Vec<String> = counts.iter().map(|(name, n)| format!("{name} {n}")).collect();
    let drawn = match counts.get("draws") {
        Some(n) => format!(
            "; {n} harnesses were only run on random draws, for no receipt of the model checker is about these sources"
        ),
        None => String::new(),
    };
    format!("Checks by engine: {}{drawn}.", listed.join(", "))
}

/// What a link can point to.
fn slug(text: &str) -> String {
    let plain: String = text
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' })
        .collect();
    plain.trim_matches('-').to_owned()
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:64em;margin:2em auto;padding:0 1em}\
    table{border-collapse:collapse;width:100%;margin:.6em 0}\
    td,th{border:1px solid #bbb;padding:.2em .5em;text-align:left;vertical-align:top}\
    code{overflow-wrap:anywhere;font-size:.9em}td:first-child{white-space:nowrap}\
    .bad{background:#fdd}.control td:nth-child(2){padding-left:1.5em}\
    .verdict{font-size:1.2em;border-left:.4em solid #393;padding-left:.6em}.verdict.bad{border-color:#c22}\
    nav{display:flex;flex-wrap:wrap;gap:0 .8em}nav a{white-space:nowrap}@media print{nav{display:none}}\
    @media(max-width:40em){table{display:block;overflow-x:auto}td:first-child{white-space:normal}}";

/// The page. `at` is where it will be: links to the sources are relative to that.
pub fn html(report: &Report, at: &Path) -> String {
    let sources = Sources::read(at);
    let bad = if report.failed() > 0 { " bad" } else { "" };
    let mut text = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width\"><title>signorini: audit</title><style>{STYLE}</style>\
         <h1>signorini: audit</h1><p class=\"verdict{bad}\">{}</p><p>{}</p><nav><a href=\"#provenance\">Provenance</a>\
         <a href=\"#summary\">Summary</a><a href=\"#items\">Items of the paper</a>",
        escape(&report.summary()),
        escape(&by_engine(report)),
    );
    for claim in &report.claims {
        let _ = write!(text, "<a href=\"#row-{0}\">Row {0}</a>", claim.id);
    }
    text += "</nav><h2 id=\"provenance\">Provenance</h2><table>";
    for (name, value) in &report.provenance.0 {
        let _ = write!(text, "<tr><td>{name}<td><code>{}</code></tr>", escape(value));
    }
    text += "</table><h2 id=\"summary\">Summary</h2><table><tr><th>row<th>title<th>checks<th>controls<th>failed<th>seconds</tr>";
    for claim in &report.claims {
        let controls = report.of(claim.id).filter(|line| line.control).count();
        let failed = report.of(claim.id).filter(|line| line.outcome.is_err()).count();
        let seconds: f64 = report.of(claim.id).map(|line| line.seconds).sum();
        let _ = write!(
            text,
            "<tr class=\"{}\"><td><a href=\"#row-{id}\">{id}</a><td>{}<td>{}<td>{controls}<td>{failed}<td>{seconds:.2}</tr>",
            if failed > 0 { "bad" } else { "" },
            escape(claim.title),
            report.of(claim.id).count() - controls,
            id = claim.id,
        );
    }
    let _ = write!(
        text,
        "</table><p>What the engines are, what is trusted, and the errata of the paper: <a href=\"{}VERIFY.md\">VERIFY.md</a>.</p>\
         <h2 id=\"items\">Items of the paper</h2><nav>",
        escape(&sources.up)
    );
    // A part of the ledger says nothing of the others.
    let shown = |item: &&Item| report.complete || !item.found(&report.claims).is_empty();
    for item in items().iter().filter(shown) {
        let _ = write!(text, "<a href=\"#{}\">{}</a>", item_anchor(item), escape(item.name));
    }
    text += "</nav>";
    for item in items().iter().filter(shown) {
        text += &item_view(item, report);
    }
    for claim in &report.claims {
        text += &row_view(claim, report, &sources);
    }
    text + "</html>\n"
}

fn item_anchor(item: &Item) -> String {
    format!("item-{}", slug(item.name))
}

/// An item, with the checks that are about it.
fn item_view(item: &Item, report: &Report) -> String {
    let mut text = format!(
        "<h3 id=\"{}\">{}</h3><p>{}.",
        item_anchor(item),
        escape(item.name),
        escape(item.says)
    );
    if !item.missing.is_empty() {
        let missing = escape(item.missing);
        let _ = write!(text, " <b>Not checked, or taken from the literature:</b> {missing}.");
    }
    text += "</p>";
    let found = item.found(&report.claims);
    if found.is_empty() {
        return text + "<p>No check is about it.</p>";
    }
    text += "<table><tr><th>row<th>check<th>engine<th>outcome</tr>";
    for (claim, check) in found {
        let line = report.of(claim.id).find(|line| {
            !line.control && line.declared == check.name && line.engine == check.engine_name()
        });
        let (class, word) = match line.map(|line| &line.outcome) {
            Some(Ok(_)) => ("", "ok"),
            Some(Err(_)) => ("bad", "FAILED"),
            None => ("bad", "not run"),
        };
        let _ = write!(
            text,
            "<tr class=\"{class}\"><td><a href=\"#row-{id}\">{id}</a><td><a href=\"#{anchor}\"><code>{}</code></a><td>{}<td>{word}</tr>",
            check.shown_name(),
            check.engine_name(),
            id = claim.id,
            anchor = anchor(claim.id, check.engine_name(), check.name),
        );
    }
    text + "</table>"
}

fn anchor(row: &str, engine: &str, name: &str) -> String {
    format!("check-{row}-{engine}-{name}")
}

/// The items of a row, with links.
fn items_of(claim: &Claim) -> String {
    let all = items();
    let link = |name: &&str| match all.iter().find(|item| item.name == *name) {
        Some(item) => format!("<a href=\"#{}\">{}</a>", item_anchor(item), escape(name)),
        None => escape(name),
    };
    claim.items.iter().map(link).collect::<Vec<_>>().join(", ")
}

fn row_view(claim: &Claim, report: &Report, sources: &Sources) -> String {
    let id = claim.id;
    let mut text = format!(
        "<h2 id=\"row-{id}\">Row {id}: {}</h2><p>{}</p>",
        escape(claim.title),
        items_of(claim)
    );
    let mut line = |name: &str, content: &str| {
        let _ = write!(text, "<p><b>{name}:</b> {}</p>", escape(content));
    };
    line("The paper", claim.paper);
    line("As checked", claim.statement);
    line("Numbers", claim.numbers);
    line("Assumed", claim.preconditions);
    line("Not established", claim.limits);
    if let Some(why) = claim.single {
        line("Why one engine", why);
    }
    let code: Vec<String> = claim.kernel.iter().map(|path| sources.of_item(path)).collect();
    if !code.is_empty() {
        let _ = write!(text, "<p><b>Code:</b> {}</p>", code.join(", "));
    }
    let _ = write!(
        text,
        "<p><b>Run:</b> <code>cargo run -p props -- audit {id}</code>, one check: <code>cargo run -p props -- audit {id} NAME</code></p>\
         <table><tr><th>engine<th>check<th>outcome<th>seconds</tr>"
    );
    for line in report.of(id) {
        let (class, word, detail) = match &line.outcome {
            Ok(evidence) => ("", "ok", evidence),
            Err(why) => (" bad", "FAILED", why),
        };
        let control = if line.control { "control" } else { "" };
        let receipt = line.receipt.as_deref().map_or(String::new(), |r| format!("; {}", escape(r)));
        let _ = write!(
            text,
            "<tr class=\"{control}{class}\" id=\"{}\"><td>{}<td>{}{}<td>{word}: {}<td>{:.2}</tr>",
            anchor(id, line.engine, line.declared),
            line.engine,
            sources.link(&line.name, sources.names.get(line.declared).copied()),
            if line.control { " (control)" } else { "" },
            escape(detail) + &receipt,
            line.seconds
        );
    }
    text + "</table>"
}

/// Where things are declared: the lines of the sources, and how a page refers to them.
struct Sources {
    files: Vec<(String, Vec<String>)>,
    /// From the page to the root.
    up: String,
    /// Of each function of the claims, and each name of a check: file and line.
    names: BTreeMap<String, (usize, usize)>,
}

impl Sources {
    fn read(at: &Path) -> Sources {
        let root = root();
        let mut files = Vec::new();
        for directory in ["src", "props/src/claims"] {
            files_below(&root, &root.join(directory), &mut files);
        }
        files.sort();
        let folder = at.parent().unwrap_or(at);
        let up = match folder.strip_prefix(&root) {
            Ok(inside) => "../".repeat(inside.components().count()),
            Err(_) => format!("{}/", root.display()),
        };
        let mut names = BTreeMap::new();
        for (file, (path, lines)) in files.iter().enumerate() {
            if path.starts_with("props/") {
                for (line, text) in lines.iter().enumerate() {
                    for name in declared(text) {
                        names.entry(name).or_insert((file, line + 1));
                    }
                }
            }
        }
        Sources { files, up, names }
    }

    fn link(&self, text: &str, place: Option<(usize, usize)>) -> String {
        let text = escape(text);
        match place {
            Some((file, line)) => {
                let path = &self.files[file].0;
                format!(
                    "<a href=\"{}{path}\" title=\"{path}:{line}\"><code>{text}</code></a> <small>{path}:{line}</small>",
                    escape(&self.up)
                )
            }
            None => format!("<code>{text}</code>"),
        }
    }

    /// An item of the code, `module::Type::function` as in [`Claim::kernel`].
    fn of_item(&self, path: &str) -> String {
        let directory = ledger::source(path);
        let inside = path.strip_prefix(&format!("{directory}::")).unwrap_or(path);
        let (module, name) =
            (inside.split("::").next().unwrap_or(""), inside.rsplit("::").next().unwrap_or(""));
        let file = format!("src/{directory}/{module}.rs");
        let declared = [format!("fn {name}("), format!("fn {name}<")];
        let place = self.files.iter().position(|(path, _)| *path == file).and_then(|at| {
            let lines = self.files[at].1.iter();
            let mut found =
                lines.enumerate().filter(|(_, l)| declared.iter().any(|d| l.contains(d)));
            found.next().map(|(line, _)| (at, line + 1))
        });
        self.link(path, place)
    }
}

/// The sources below a folder, by their paths from the root.
fn files_below(root: &Path, folder: &Path, files: &mut Vec<(String, Vec<String>)>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            files_below(root, &path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let name = path.strip_prefix(root).unwrap_or(&path).display().to_string();
            files.push((name, text.lines().map(str::to_owned).collect()));
        }
    }
}

/// The names that a line of a claim declares: of a function, of a harness, of a check in quotes.
fn declared(line: &str) -> Vec<String> {
    let word = |text: &str| -> String {
        text.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect()
    };
    let line = line.trim_start();
    let starts = ["pub fn ", "fn ", "holds ", "fails "];
    let mut names: Vec<String> =
        starts.iter().filter_map(|start| line.strip_prefix(start)).map(word).collect();
    names.extend(line.split('"').skip(1).step_by(2).filter(|n| word(n) == **n).map(str::to_owned));
    names.retain(|name| name.contains('_'));
    names
}

/// A text in JSON.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' => quoted += "\\\"",
            '\\' => quoted += "\\\\",
            '\n' => quoted += "\\n",
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04x}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

/// The same as JSON.
pub fn json(report: &Report) -> String {
    let provenance: Vec<String> = report
        .provenance
        .0
        .iter()
        .map(|(name, value)| format!("{}: {}", quoted(name), quoted(value)))
        .collect();
    let checks: Vec<String> = report
        .lines
        .iter()
        .map(|line| {
            let (passed, said) = match &line.outcome {
                Ok(said) => (true, said),
                Err(said) => (false, said),
            };
            format!(
                "{{\"row\": {}, \"engine\": {}, \"name\": {}, \"control\": {}, \"passed\": {passed}, \"seconds\": {:.3}, \"said\": {}, \"receipt\": {}}}",
                quoted(line.row),
                quoted(line.engine),
                quoted(&line.name),
                line.control,
                line.seconds,
                quoted(said),
                line.receipt.as_deref().map_or("null".to_owned(), quoted)
            )
        })
        .collect();
    let items: Vec<String> = items()
        .iter()
        .map(|item| {
            let checks: Vec<String> = item
                .found(&report.claims)
                .iter()
                .map(|(claim, check)| {
                    let (row, name) = (quoted(claim.id), quoted(&check.shown_name()));
                    format!(
                        "{{\"row\": {row}, \"engine\": {}, \"name\": {name}}}",
                        quoted(check.engine_name())
                    )
                })
                .collect();
            format!(
                "{{\"name\": {}, \"says\": {}, \"literature\": {}, \"checks\": [{}]}}",
                quoted(item.name),
                quoted(item.says),
                if item.missing.is_empty() { "null".to_owned() } else { quoted(item.missing) },
                checks.join(", ")
            )
        })
        .collect();
    format!(
        "{{\n\"schema\": 1,\n\"complete\": {},\n\"failed\": {},\n\"provenance\": {{{}}},\n\"items\": [\n{}\n],\n\"checks\": [\n{}\n]\n}}\n",
        report.complete,
        report.failed(),
        provenance.join(", "),
        items.join(",\n"),
        checks.join(",\n")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims;

    fn report(outcome: Outcome) -> Report {
        let line = Line {
            row: "1",
            engine: "proof",
            name: "positive_part_satisfies_4".to_owned(),
            declared: "positive_part_satisfies_4",
            receipt: None,
            control: false,
            seconds: 0.5,
            outcome,
        };
        Report {
            provenance: Provenance(vec![("commit", "c0ffee".to_owned())]),
            claims: claims::all().into_iter().take(1).collect(),
            complete: false,
            lines: vec![line],
        }
    }

    #[test]
    fn the_page_escapes_what_it_shows_and_marks_failures() {
        let at = root().join("target/audit/row-1.html");
        let page = html(&report(Err("a < b".to_owned())), &at);
        for part in [
            "FAILED: a &lt; b",
            "1 checks and 0 controls in 1 row: 1 FAILED. This is a part",
            "Checks by engine: proof 1.",
            "../../VERIFY.md",
            "href=\"#item-4\"",
            "id=\"item-4\"",
            "a &lt;= [a]+",
            "c0ffee",
            "id=\"check-1-proof-positive_part_satisfies_4\"",
            "href=\"#check-1-proof-positive_part_satisfies_4\"",
            "../../props/src/claims/positive_part.rs",
            "../../src/kernel/positive_part.rs",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(html(&report(Ok(String::new())), &at).contains("all passed"));
    }

    #[test]
    fn every_check_and_every_item_of_the_code_has_a_place() {
        let sources = Sources::read(&root().join("target/audit/index.html"));
        for claim in claims::all() {
            for check in &claim.checks {
                assert!(sources.names.contains_key(check.name), "{}", check.name);
            }
            for path in claim.kernel {
                assert!(sources.of_item(path).contains("href"), "{path}");
            }
        }
    }

    #[test]
    fn json_quotes_what_it_contains() {
        let report = report(Err("say \"no\"\n<\\>".to_owned()));
        assert!(json(&report).contains(r#""said": "say \"no\"\n<\\>""#));
        assert!(json(&report).contains("\"failed\": 1"));
    }
}
