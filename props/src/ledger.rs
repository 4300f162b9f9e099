//! `VERIFY.md`: the ledger of the claims, printed from the claims themselves.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

use crate::claim::{Check, Claim, Engine, Stated, Subject};
use crate::claims;
use crate::harness::Harness;
use crate::items::{ITEMS, Item, ON, Place};
use crate::paper;
use crate::proof::tree;
use crate::receipt::{self, hash, root};
use crate::solvers;

/// The page, with names in braces where what is printed is to be.
const TEXT: &str = include_str!("ledger.md");

/// With this begins a line of links, which is not read but looked up.
const LINKS: &str = "- ";

/// The text of `VERIFY.md`.
///
/// # Errors
/// A file of the sources that can't be read, and a name that does not stand in them once.
pub fn ledger() -> Result<String, String> {
    let (claims, places) = (claims::all(), Places::read()?);
    let items = ITEMS.iter().map(|item| of_item(item, &claims, &places));
    let rows = claims.iter().map(|claim| row(claim, &places));
    let standing = claims::harnesses().iter().any(receipt::is_verified);
    let changed = receipt::changed_files().join(", ");
    let text = TEXT.replace("{state}", state(&claims).trim_end());
    let text = text.replace("{kani}", if standing { "" } else { " (now of no check)" });
    let text = text.replace("{items}", items.collect::<Result<String, _>>()?.trim());
    let text = text.replace("{rows}", rows.collect::<Result<String, _>>()?.trim());
    let text = text.replace("{proofs}", proofs(&claims, &places)?.trim_end());
    let text = text.replace("{ranges}", &ranges(&claims::harnesses()));
    Ok(text.replace("{changed}", if changed.is_empty() { "nothing" } else { &changed }))
}

/// The lines of the sources by what stands in them.
struct Places {
    /// File, from the root, and text.
    files: Vec<(String, String)>,
}

impl Places {
    fn read() -> Result<Places, String> {
        let mut files = Vec::new();
        for folder in ["props/src", "props/tests", "src", "study/src"] {
            add(&root().join(folder), &mut files).map_err(|why| format!("{folder}: {why}"))?;
        }
        let theorems =
            std::fs::read_to_string(root().join(PAPER)).map_err(|why| format!("{PAPER}: {why}"))?;
        files.push((PAPER.to_owned(), theorems));
        Ok(Places { files })
    }

    /// The one line of these files that has one of these texts.
    fn find(&self, is_asked: impl Fn(&str) -> bool, texts: &[String]) -> Result<String, String> {
        let mut found = Vec::new();
        for (file, text) in self.files.iter().filter(|(file, _)| is_asked(file)) {
            let starts = texts.iter().flat_map(|asked| text.match_indices(asked.as_str()));
            let before = starts.map(|(start, _)| text[..start].matches('\n').count());
            let numbers: BTreeSet<usize> = before.collect();
            found.extend(numbers.iter().map(|number| format!("{file}#L{}", number + 1)));
        }
        match &found[..] {
            [place] => Ok(place.clone()),
            _ => Err(format!("{texts:?} stands at {found:?}, expected once")),
        }
    }

    fn of_claims(&self, texts: &[String]) -> Result<String, String> {
        self.find(|file| file.starts_with(CLAIMS), texts)
    }

    /// Where a check is to be read: its predicate, its harness, or the function that states what is compared.
    fn of(&self, check: &Check) -> Result<String, String> {
        let name = check.name;
        match check.subject {
            Subject::Statement(_) => {
                let place = self.of_claims(&[format!("fn {name}<")])?;
                let (file, _) = place.split_once('#').unwrap_or_default();
                let text = self.files.iter().find(|(name, _)| name == file);
                match text.and_then(|(_, text)| comparing(text, name)) {
                    _ if check.control => Ok(place),
                    Some(of) => self.find(|name| name == file, &[format!("fn {of}<")]),
                    None => Err(format!("{name} compares nothing")),
                }
            }
            Subject::Harness(_) => {
                self.of_claims(&["holds ", "fails "].map(|kind| format!(" {kind}{name}(")))
            }
            Subject::Function(_, stated) => {
                let (module, function) = parts(stated.by());
                let row = self.registered(check)?;
                let row = row.split('#').next().unwrap_or_default();
                let is_asked = |file: &str| match &module {
                    Some(module) => {
                        file.starts_with(CLAIMS) && file.ends_with(&format!("/{module}.rs"))
                    }
                    None => file == row,
                };
                self.find(is_asked, &['<', '('].map(|end| format!("fn {function}{end}")))
            }
        }
    }

    /// The line of a row's list with a check that is a function of its own.
    fn registered(&self, check: &Check) -> Result<String, String> {
        self.of_claims(&[format!("!(\"{}\",", check.name)])
    }

    /// The line of a place of the program.
    fn line(&self, (file, text): Place) -> Result<usize, String> {
        let source = self.files.iter().find(|(name, _)| name == file);
        let (_, source) = source.ok_or(format!("there is no file {file}"))?;
        let line = source.lines().position(|line| {
            let line = line.trim_start();
            line.strip_prefix("Theorem ").unwrap_or(line).starts_with(text)
        });
        line.map(|line| line + 1).ok_or(format!("no line of {file} begins with '{text}'"))
    }
}

/// The function of a text that compares for this one: itself, or where it compares nothing the one that it calls.
fn comparing<'a>(text: &'a str, name: &'a str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!("fn {name}<"))?;
    let body = rest.split("\n}").next()?;
    if body.contains("ensure!") {
        return Some(name);
    }
    let words = body.split(|c: char| !(c.is_alphanumeric() || c == '_'));
    let called = |word: &&str| *word != name && text.contains(&format!("fn {word}<"));
    words.filter(called).find_map(|word| comparing(text, word))
}

/// Where the theorems are.
const PAPER: &str = "props/rocq/paper.v";

/// Where the claims are.
const CLAIMS: &str = "props/src/claims/";

/// The module, where there is one, and the name of a function.
fn parts(function: &str) -> (Option<String>, String) {
    let path = function.replace(' ', "");
    match path.rsplit_once("::") {
        Some((module, name)) => (Some(module.to_owned()), name.to_owned()),
        None => (None, path),
    }
}

/// Adds the sources below a folder, in the order of their names.
fn add(folder: &Path, files: &mut Vec<(String, String)>) -> std::io::Result<()> {
    let entries = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut paths: Vec<_> = entries.collect::<std::io::Result<_>>()?;
    paths.sort();
    for path in paths {
        if path.is_dir() {
            add(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let name = path.strip_prefix(root()).unwrap_or(&path).display().to_string();
            files.push((name, std::fs::read_to_string(&path)?));
        }
    }
    Ok(())
}

/// Checks of one name, as one: a statement that several engines are asked.
fn by_name<'a>(checks: impl Iterator<Item = &'a Check>) -> Vec<Vec<&'a Check>> {
    let mut named: Vec<Vec<&Check>> = Vec::new();
    for check in checks {
        match named.iter_mut().find(|of| of[0].name == check.name) {
            Some(of) => of.push(check),
            None => named.push(vec![check]),
        }
    }
    named
}

/// The theorem that Rocq has proved from the certificates of a predicate.
fn theorem(name: &str) -> Option<&'static str> {
    static PROVED: OnceLock<BTreeMap<&'static str, &'static str>> = OnceLock::new();
    let proved = PROVED.get_or_init(|| {
        let theorems = paper::theorems().into_iter().filter(|theorem| theorem.is_proved());
        theorems.filter_map(|theorem| Some((theorem.predicate?, theorem.name))).collect()
    });
    proved.get(name).copied()
}

fn are_by(engine: Engine, checks: &[&Check]) -> bool {
    checks.iter().any(|check| check.engine == engine)
}

fn is_a_statement(check: &Check) -> bool {
    matches!(check.subject, Subject::Statement(_))
}

/// What stands in front of checks of one name, and its rank: the strongest of what was said of them, for Rocq includes a proof,
/// and the list of the proofs says which were drawn; and doubles beside it.
fn label(checks: &[&Check]) -> (usize, String) {
    let of = |engine| are_by(engine, checks);
    let is_theorem = is_a_statement(checks[0]) && theorem(checks[0].name).is_some();
    let (rank, strongest) = match () {
        () if is_theorem && of(Engine::Proof) => (0, "Rocq"),
        () if of(Engine::Proof) => (1, "proof"),
        () if of(Engine::Exact) => (2, "exact"),
        () if of(Engine::Doubles) => return (3, "doubles".to_owned()),
        () => (4, checks[0].engine_name()),
    };
    let doubles = if of(Engine::Doubles) { ", doubles" } else { "" };
    (rank, format!("{strongest}{doubles}"))
}

fn link(check: &Check, places: &Places) -> Result<String, String> {
    let draws = if check.draws == 0 { String::new() } else { format!(" ({} draws)", check.draws) };
    Ok(format!("[{}]({}){draws}", check.name, places.of(check)?))
}

/// Links to checks, those of one label together, the strongest first.
fn grouped<'a>(checks: impl Iterator<Item = &'a Check>, places: &Places) -> Result<String, String> {
    let mut groups: BTreeMap<(usize, String), Vec<String>> = BTreeMap::new();
    for checks in by_name(checks) {
        groups.entry(label(&checks)).or_default().push(link(checks[0], places)?);
    }
    let text =
        groups.into_iter().map(|((_, label), links)| format!(" *{label}:* {}.", links.join(", ")));
    Ok(text.collect())
}

/// From so many checks on, an item that has all those of another one names that.
const MANY: usize = 8;

/// The checks of an item, and the item whose checks these include, if those are many.
fn beyond<'a>(item: &Item, claims: &'a [Claim]) -> (Option<&'static str>, Vec<&'a Check>) {
    let checks = |item: &Item| -> Vec<&'a Check> {
        item.found(claims).into_iter().map(|(_, check)| check).collect()
    };
    let names = |item: &Item| -> BTreeSet<&str> { checks(item).iter().map(|c| c.name).collect() };
    let all = names(item);
    let included = ITEMS.iter().filter(|other| other.name != item.name).find_map(|other| {
        let theirs = names(other);
        (theirs.len() >= MANY && theirs.len() < all.len() && theirs.is_subset(&all))
            .then_some((other.name, theirs))
    });
    let mut own = checks(item);
    own.retain(|check| !included.as_ref().is_some_and(|(_, theirs)| theirs.contains(check.name)));
    (included.map(|(name, _)| name), own)
}

/// What a line that checks call is: of the program, of the definitions beside it, or what both run on.
fn kind(place: &Place) -> &'static str {
    match place {
        _ if ON.contains(place) => "On",
        (file, _) if file.starts_with("props/") => "Defined",
        _ => "Code",
    }
}

/// Links to lines of the program.
fn linked(label: &str, code: &[Place], places: &Places) -> Result<String, String> {
    let one = |&(file, start): &Place| {
        let name = match start.split_once("fn ") {
            Some((_, name)) => name.split(['<', '(']).next().unwrap_or(name),
            None => start
                .trim_start_matches("pub ")
                .trim_start_matches("let ")
                .trim_end_matches(['<', ';']),
        };
        Ok(format!("[`{name}`]({file}#L{})", places.line((file, start))?))
    };
    let links: Result<Vec<String>, String> = code.iter().map(one).collect();
    Ok(if code.is_empty() { String::new() } else { format!(" *{label}:* {}.", links?.join(", ")) })
}

/// The theorem with the name of an item that Rocq has proved without the paths of a predicate.
fn by_hand(item: &Item) -> Vec<Place> {
    let name = item.name.to_lowercase().replace([' ', '.'], "_");
    let theorems = paper::theorems().into_iter().filter(|theorem| theorem.is_proved());
    let found = theorems.filter(|theorem| theorem.predicate.is_none() && theorem.name == name);
    found.map(|theorem| (PAPER, theorem.name)).collect()
}

/// The anchor that GitHub makes of the heading of a row.
fn anchor(Claim { id, title, .. }: &Claim) -> String {
    let kept = |c: &char| c.is_alphanumeric() || [' ', '-', '_'].contains(c);
    format!("{id} {title}")
        .to_lowercase()
        .chars()
        .filter(kept)
        .collect::<String>()
        .replace(' ', "-")
}

fn of_item(item: &Item, claims: &[Claim], places: &Places) -> Result<String, String> {
    let found = item.found(claims);
    let mut rows: Vec<&Claim> = found.iter().map(|(claim, _)| *claim).collect();
    rows.dedup_by_key(|claim| claim.id);
    let rows: Vec<String> =
        rows.iter().map(|claim| format!("[§{}](#{})", claim.id, anchor(claim))).collect();
    let mut text = format!("\n**{}** {}", item.name, item.says);
    if !rows.is_empty() {
        let _ = write!(text, ", {}", rows.join(" "));
    }
    text.push('.');
    if !item.missing.is_empty() {
        let _ = write!(text, " *Unchecked:* {}.", item.missing);
    }
    let mut links = String::new();
    for label in ["Code", "Defined", "On"] {
        let is_such = |place: &&Place| label == kind(place);
        let code: Vec<Place> = item.code.iter().copied().filter(|place| is_such(&place)).collect();
        links += &linked(label, &code, places)?;
    }
    links += &linked("Uncalled", item.uncalled, places)?;
    links += &linked("Rocq, by hand", &by_hand(item), places)?;
    let (included, own) = beyond(item, claims);
    if let Some(included) = included {
        let _ = write!(links, " Those of {included}, and:");
    }
    links += &grouped(own.into_iter(), places)?;
    if !links.is_empty() {
        let _ = write!(text, "\n{LINKS}{}", links.trim_start());
    }
    Ok(text + "\n")
}

/// The controls of a row, each once.
fn controls(claim: &Claim) -> Vec<Vec<&Check>> {
    by_name(claim.checks.iter().filter(|check| check.control))
}

/// What holds by which engines, and what the receipts are about.
fn state(claims: &[Claim]) -> String {
    let checks = || claims.iter().flat_map(|claim| &claim.checks);
    let evidence: Vec<Vec<&Check>> = by_name(checks().filter(|check| !check.control));
    let of = |engine: Engine, statement: bool| {
        let asked = |checks: &&Vec<&Check>| {
            is_a_statement(checks[0]) == statement && are_by(engine, checks)
        };
        evidence.iter().filter(asked).count()
    };
    let both =
        |checks: &&Vec<&Check>| [Engine::Proof, Engine::Exact].iter().all(|&e| are_by(e, checks));
    let drawn = evidence.iter().filter(both).count();
    let harnesses = claims::harnesses();
    let theorems = paper::theorems();
    let proved = theorems.iter().filter(|theorem| theorem.is_proved()).count();
    let twins = paper::receipt().count("refused", "proved");
    let (rocq, doubles) = (paper::receipt(), solvers::in_all_doubles());
    let more = claims.iter().filter(|claim| !claim.is_about_the_paper());
    let more: Vec<&str> = more.map(|claim| claim.id).collect();
    format!(
        "- {} rows are about the paper, rows {} about what it has not: {} statements proved, {} of them drawn, too; {} other checks in exact \
         numbers, {} statements and {} other checks in doubles, {} harnesses; {} controls. `cargo test` runs all of them.\n\
         - {} ({}): {proved} of {} theorems, with the axioms of the classical reals; {twins} false twins are refused.\n\
         - {} ({}): each of the {} failing paths of the statements in doubles is impossible over all finite doubles; {} of the controls' \
         are possible.\n\
         - {}\n\
         - The whole solver (rows see small meshes only) is compared with FEniCSx, which shares only the case files: with stored \
         results by `cargo test` ([`reference.rs`](tests/suite/reference.rs)), with new ones, and scikit-fem's, by [`.ci/run`](.ci/run).\n",
        claims.iter().filter(|claim| claim.is_about_the_paper()).count(),
        joined(&more),
        of(Engine::Proof, true),
        drawn,
        of(Engine::Exact, false) + of(Engine::Exact, true) - drawn,
        of(Engine::Doubles, true),
        of(Engine::Doubles, false),
        harnesses.iter().filter(|harness| harness.counterexample.is_none()).count(),
        claims.iter().map(|claim| controls(claim).len()).sum::<usize>(),
        rocq.head.join(", "),
        rocq.date,
        theorems.len(),
        doubles.head.join(", "),
        doubles.date,
        doubles.count("unsat", "unsat"),
        doubles.count("unknown", "sat"),
        receipt::said(&harnesses),
    )
}

/// Over what the harnesses range.
fn ranges(harnesses: &[Harness]) -> String {
    let must_hold = || harnesses.iter().filter(|harness| harness.counterexample.is_none());
    let decided = must_hold().filter(|harness| receipt::is_decided(harness)).count();
    let holds: Vec<&str> = must_hold().map(|harness| harness.name).collect();
    let ending = |ends: &[&str]| {
        holds.iter().filter(|name| ends.iter().any(|end| name.ends_with(end))).count()
    };
    let over_doubles = ending(&["_for_all_doubles", "_for_all_finite_doubles"]);
    let over_numbers = ending(&["_for_all_doubles_but_nan"]);
    let (over_words, over_bytes) = (ending(&["i16"]), ending(&["for_all_i8", "i8_gamma"]));
    format!(
        "Of the {} harnesses that must hold, {over_doubles} range over all doubles or all finite ones, {over_numbers} over all but NaN, \
         {over_words} over i16, {over_bytes} over bytes, {} over smaller sets, which their names say. `cargo test` runs {decided} on all \
         their cases and {} on draws.",
        holds.len(),
        holds.len() - over_doubles - over_numbers - over_words - over_bytes,
        holds.len() - decided,
    )
}

/// Words in a sentence: a, b and c.
fn joined(words: &[&str]) -> String {
    match words {
        [] => "none".to_owned(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The proofs of all rows, one a line, as `reference/check_certificates.py` reads them.
fn proofs(claims: &[Claim], places: &Places) -> Result<String, String> {
    let mut text = String::new();
    let evidence = claims.iter().flat_map(|claim| &claim.checks).filter(|check| !check.control);
    for checks in by_name(evidence) {
        let proof = checks.iter().find(|check| check.engine == Engine::Proof);
        let Some(Check { subject: Subject::Statement(statement), .. }) = proof else { continue };
        let ([paths, refuted], tree) = tree(statement);
        let _ = write!(text, "- {}: {paths}/{refuted} {}", link(checks[0], places)?, hash(&tree));
        for check in checks.iter().filter(|check| check.engine != Engine::Proof) {
            let _ = write!(text, ", {}", check.engine.name());
        }
        if let Some(name) = theorem(checks[0].name) {
            let _ = write!(text, ", Rocq `{name}`");
        }
        text.push('\n');
    }
    Ok(text)
}

/// A row: the paper's words, the checks that no item has, and the controls.
fn row(claim: &Claim, places: &Places) -> Result<String, String> {
    let Claim { id, title, paper, limits, .. } = claim;
    let mut text = format!("\n### §{id} {title}\n\n");
    if !paper.is_empty() {
        let _ = writeln!(text, "*Paper:* {paper}");
    }
    if !limits.is_empty() {
        let _ = writeln!(text, "*Not established:* {limits}");
    }
    let (of_items, others): (Vec<&Check>, Vec<&Check>) = claim
        .checks
        .iter()
        .filter(|check| !check.control)
        .partition(|check| !check.items.is_empty());
    let has = |item: &&Item| of_items.iter().any(|check| check.items.contains(&item.name));
    let items: Vec<&str> = ITEMS.iter().filter(has).map(|item| item.name).collect();
    let mut links = String::new();
    if !items.is_empty() {
        let _ = write!(links, "Those of {}", items.join(", "));
        links += if others.is_empty() { "." } else { ", and:" };
    }
    links += &grouped(others.into_iter(), places)?;
    if !paper.is_empty() || !limits.is_empty() {
        text.push('\n');
    }
    let _ = write!(text, "{LINKS}{}", links.trim_start());
    let controls = controls(claim);
    let mut shown = Vec::new();
    let mut at: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for control in controls.iter().map(|checks| checks[0]) {
        let name = control.name.trim_start_matches("control_");
        let place = places.of(control)?;
        if let Subject::Function(_, Stated::At(function)) = control.subject {
            let asked = format!("[`{}`]({place})", parts(function).1);
            let line = places.registered(control)?;
            at.entry(asked).or_default().push(format!("[{name}]({line})"));
            continue;
        }
        // Evidence by another engine has the same name.
        let is_evidence = name == control.name;
        let why = if is_evidence { " in doubles, where rounding breaks it" } else { "" };
        shown.push(format!("[{name}]({place}){why}"));
    }
    let of_function =
        |(asked, controls): (String, Vec<String>)| format!("in {asked}: {}", controls.join(", "));
    shown.extend(at.into_iter().map(of_function));
    let _ = writeln!(text, "\n{LINKS}*Controls:* {}.", shown.join(", "));
    Ok(text)
}

#[cfg(test)]
#[path = "../tests/ledger.rs"]
mod tests;
