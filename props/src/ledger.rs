//! `VERIFY.md`: the ledger of the claims, printed from the claims themselves.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

use crate::claim::{Check, Claim, Engine, Stated, Subject};
use crate::claims;
use crate::harness::Harness;
use crate::items::{ITEMS, Item, Place};
use crate::paper;
use crate::proof::tree;
use crate::receipt::{self, hash, root};
use crate::solvers;

const HEAD: &str = "\
# What is verified

`cargo run -p props -- ledger` prints this page from the claims; a test compares. Read the sentences, look
links up. An item of the paper has the lines that its checks call (*Code*), others that it
is about (*Uncalled*), and its checks; a check leads to the function that states what is compared, a control to its mistake, § to a
row. Numbers without a row were rows that are tests now.

The paper is F. Chouly, P. Hild, *A Nitsche-based method for unilateral contact problems: numerical analysis*, SIAM J.
Numer. Anal. 51 (2013) 1295-1307. n is the outward normal, sigma_n negative in compression, P(v) = v_n - g - gamma sigma_n(v)
with a gap g (0 in the paper), P0 its linear part, lambda^h = -(1/gamma)[P(u^h)]+, |.|_1 the norm of H^1(Omega),
|v|_a^2 = a(v, v).
";

const BODY: &str = "\
## What a check says

A statement is a Rust function, generic over the number type. It compares the kernel's own functions with the paper's formulas, or
is a step of the paper's algebra, which calls nothing of the kernel (most of rows 11 and 15). It *holds*, with the class of its
data (each must be reached), is *vacuous*, where its hypothesis is not met, or *fails*. Other checks assemble on random bodies,
solve, or compare doubles with exact numbers. Every row has **controls**: planted mistakes, which the same check must reject. A
check's label is its strongest:

- **Rocq**: the statement, written by hand in [`paper.v`](props/rocq/paper.v), is a theorem over the reals; neither the function nor the
  engine that found its *proof* is trusted.
- **proof**: every comparison of polynomials forks the path, and each path that fails contradicts itself, by a certificate (a sum of
  products of facts and squares that is positive and zero): the statement holds over every ordered field, so over the reals.
- **exact**: rationals, random or given, without a tolerance; 200 draws of a statement, more until 100 meet its hypothesis; of
  bodies 3 to 90.
- **doubles**: 5,000 random draws with edge values and ties (bitwuzla was asked about all finite doubles), or a comparison with
  exact rationals and a stated bound.
- **Kani**: the model checker has decided a harness for all its numbers, by a receipt made of these files.
- **all cases**: each of at most 2^20 cases is run. **draws**: random draws of a harness, *and no more is known*; `for_all` in its
  name is what Kani is asked.

Receipts are in `props/receipts`. Promises beyond the paper are tested in `props/tests/program`, beside exact rationals, and in `tests/suite`.

## What is trusted

**The trusted core** of what the program computes is what `cargo tree -p signorini-audit -e normal` lists: `src/audit`, which checks
certificates of the error, `src/kernel`, their vectors, a reader of JSON; no solver, no mesh, no linear algebra.
[`check_bound.py`](reference/check_bound.py) checks the same certificates with nothing of it, from their documented format.

For this page: the compiler, the standard library, num-rational, num-bigint, proptest, and faer for eigenvalues in doubles. For a
*proof*: [rationals](props/rational/src/lib.rs), [polynomials](props/src/proof/polynomial.rs),
[symbols](props/src/proof/symbol.rs), the [forking of paths](props/src/proof/explorer.rs) and the
[checker of certificates](props/src/proof/certificate.rs), not the search for them;
[`check_certificates.py`](reference/check_certificates.py) checks exported proofs again with fractions alone, not that their polynomials are
those of the function. On meshes: the definitions written out
([fields](props/src/naive.rs), [bodies](props/src/bodies.rs), [method](props/src/bodies/definition.rs),
[matrices](props/src/discrete.rs)), [exact elimination](props/src/elimination.rs), the
[counts of roundings](props/src/claims/assembled/compare.rs), the [number types](props/src/numbers/mod.rs). For harnesses: the
[stand-in of Kani](props/src/harness.rs). Random bodies are two or four triangles, isotropic or with a tensor that couples all strains;
gamma is gamma0 times a drawn number there, and gamma0 h_T on meshes of the solver.

## Errata of the paper

In (17) and (18) the integral of (sigma_n(u) + [P(u^h)]+/gamma) sigma_n(u - v^h) lacks a factor gamma: its dimension is
stress^2 length, that of the other terms gamma stress^2 length. As printed both are false at points:

- (17) with gamma = 2, sigma_n(u) = -1, all else 0: 0 + 2 <= 1; with the factor 2 <= 2.
- (18) with z = sigma_n(u - v^h) = 1, gamma = 1/4, beta_2 = 1: 1 <= 1/8 + 1/8; with the factor 1/4 <= 1/4.

With it both are proved, and used so: the theorem stands (row 11). In section 2.3 the set of the
multipliers is printed as L^2(Gamma_C), for its nonpositive functions. Before (23) the last equality is h_T <= h.

## What is taken from analysis

No check establishes these. Where an item has them, or other items, as *Unchecked*, its checks start from them.

- **H1**: Korn's inequality alpha |v|_1^2 <= a(v, v), with meas(Gamma_D) > 0, on every body; alpha is not computed.
- **H2**: Green's formula, but for affine fields, and inside the residuals of row 8.
- **H3**: |v|_a^2 <= M |v|_1^2; M is a number for isotropic A only (row 15).
- **H4**: the Cauchy-Schwarz and triangle inequalities of norms.
- **H5**: what holds at points of Gamma_C holds for integrals, and what holds on edges or triangles for meshes: on paper
  (`docs/theory.md`, 2.3, 3.2, 8), and run where an *exact* check integrates over bodies.
- **H6**: the traces u_n and sigma_n exist, and are square integrable.
";

/// With this begins a line of links, which is not read but looked up.
const LINKS: &str = "- ";

/// What introduces the lists at the end, which are not read but looked up.
const LISTS: &str = "\
## Lists to look things up in

The proofs, as `reference/check_certificates.py` reads them: how many paths, how many of them are refuted, and a hash of the tree of
questions, answers and ends; whether it was drawn, too; its theorem.

";

/// The text of `VERIFY.md`.
///
/// # Errors
/// A file of the sources that can't be read, and a name that does not stand in them once.
pub fn ledger() -> Result<String, String> {
    let (claims, places) = (claims::all(), Places::read()?);
    let mut text =
        format!("{HEAD}\n## State\n\n{}\n{BODY}\n## The items of the paper\n", state(&claims));
    for item in ITEMS {
        text += &of_item(item, &claims, &places)?;
    }
    text += "\n## The rows\n";
    for claim in &claims {
        text += &row(claim, &places)?;
    }
    let changed = receipt::changed_files();
    let changed = if changed.is_empty() { "nothing".to_owned() } else { changed.join(", ") };
    let proofs = proofs(&claims, &places)?;
    let ranges = ranges(&claims::harnesses());
    Ok(format!(
        "{text}\n{LISTS}{proofs}\n{ranges}\n\nChanged since the receipt of Kani: {changed}.\n"
    ))
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
            for (number, line) in text.lines().enumerate() {
                if texts.iter().any(|text| line.contains(text)) {
                    found.push(format!("{file}#L{}", number + 1));
                }
            }
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
            Subject::Statement(_) => self.of_claims(&[format!("fn {name}<")]),
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
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        paths.push(entry?.path());
    }
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

fn is_a_statement(check: &Check) -> bool {
    matches!(check.subject, Subject::Statement(_))
}

/// What stands in front of checks of one name, and its rank: the strongest of what was said of them, for Rocq includes a proof,
/// and the list of the proofs says which were drawn; and doubles beside it.
fn label(checks: &[&Check]) -> (usize, String) {
    let of = |engine| checks.iter().any(|check| check.engine == engine);
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
    Ok(format!("[{}]({})", check.name, places.of(check)?))
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
    let mut links = linked("Code", item.code, places)?;
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
            is_a_statement(checks[0]) == statement && checks.iter().any(|c| c.engine == engine)
        };
        evidence.iter().filter(asked).count()
    };
    let drawn = drawn_too(&evidence);
    let harnesses = claims::harnesses();
    let theorems = paper::theorems();
    let proved = theorems.iter().filter(|theorem| theorem.is_proved()).count();
    let twins = paper::receipt().count("refused", "proved");
    let (rocq, doubles) = (paper::receipt(), solvers::in_all_doubles());
    let more = claims.iter().filter(|claim| !claim.is_about_the_paper());
    let more: Vec<&str> = more.map(|claim| claim.id).collect();
    format!(
        "- {} rows are about the paper, rows {} about more: {} statements proved, {} of them drawn, too; {} more checks in exact \
         numbers, {} statements and {} other checks in doubles, {} harnesses; {} controls. `cargo test` runs all of them.\n\
         - {} ({}): {proved} of {} theorems, with the axioms of the classical reals; {twins} false twins are refused.\n\
         - {} ({}): each of the {} failing paths of the statements in doubles is impossible over all finite doubles; {} of the controls' \
         are possible.\n\
         - {}\n\
         - The whole solver, of which rows see small meshes only, is compared with FEniCSx, which shares nothing but the case files: with stored \
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
    let holds: Vec<&str> =
        harnesses.iter().filter(|h| h.counterexample.is_none()).map(|h| h.name).collect();
    let ending = |ends: &[&str]| {
        holds.iter().filter(|name| ends.iter().any(|end| name.ends_with(end))).count()
    };
    let over_doubles = ending(&["_for_all_doubles", "_for_all_finite_doubles"]);
    let over_numbers = ending(&["_for_all_doubles_but_nan"]);
    let over_words = ending(&["i16"]);
    let over_bytes = holds
        .iter()
        .filter(|name| name.contains("for_all_i8") || name.ends_with("i8_gamma"))
        .count();
    format!(
        "Of the {} harnesses that must hold, {over_doubles} range over all doubles or all finite ones, {over_numbers} over all but NaN, \
         {over_words} over i16, {over_bytes} over bytes, {} over smaller sets, which their names say.",
        holds.len(),
        holds.len() - over_doubles - over_numbers - over_words - over_bytes,
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

/// How many statements are both proved and drawn.
fn drawn_too(evidence: &[Vec<&Check>]) -> usize {
    let both = |checks: &&Vec<&Check>| {
        [Engine::Proof, Engine::Exact].iter().all(|e| checks.iter().any(|c| c.engine == *e))
    };
    evidence.iter().filter(both).count()
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
        match control.subject {
            Subject::Function(_, Stated::At(function)) => {
                let asked = format!("[`{}`]({})", parts(function).1, places.of(control)?);
                let place = places.registered(control)?;
                at.entry(asked).or_default().push(format!("[{name}]({place})"));
            }
            // Evidence by another engine has the same name.
            _ if name == control.name => {
                shown.push(format!(
                    "[{name}]({}) in doubles, where rounding breaks it",
                    places.of(control)?
                ));
            }
            _ => shown.push(format!("[{name}]({})", places.of(control)?)),
        }
    }
    let of_function =
        |(asked, controls): (String, Vec<String>)| format!("in {asked}: {}", controls.join(", "));
    shown.extend(at.into_iter().map(of_function));
    let _ = writeln!(text, "\n{LINKS}*Controls:* {}.", shown.join(", "));
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(claim: &Claim) -> impl Iterator<Item = &Check> {
        claim.checks.iter().filter(|check| !check.control)
    }

    fn words(text: &str) -> usize {
        text.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
    }

    /// The links of a text, each with what it shows and where it leads.
    fn links(text: &str) -> impl Iterator<Item = (&str, &str)> {
        text.match_indices("](").filter_map(|(middle, _)| {
            let start = text[..middle].rfind('[')?;
            let end = middle + text[middle..].find(')')?;
            Some((&text[start + 1..middle], &text[middle + 2..end]))
        })
    }

    /// What is read aloud: all before the lists, without the lines of links and without names, which are looked up.
    fn read_aloud(page: &str) -> String {
        let (prose, _) = page.split_once(LISTS).expect("the lists");
        let (front, items) = prose.split_once("## The items of the paper").expect("the items");
        let items = items.lines().filter(|line| !line.starts_with(LINKS)).collect::<Vec<_>>();
        let mut read = format!("{front}{}", items.join("\n"));
        for (shown, place) in links(prose) {
            let is_name = shown.contains(['_', '`', '§']);
            let link = format!("[{shown}]({place})");
            read = read.replace(&link, if is_name { "" } else { shown });
        }
        read
    }

    #[test]
    fn verify_md_is_what_the_claims_print() {
        let stored = std::fs::read_to_string(root().join("VERIFY.md")).unwrap_or_default();
        let printed = ledger().expect("each name stands in the sources");
        assert!(stored == printed, "stale: cargo run -p props -- ledger > VERIFY.md");
    }

    #[test]
    fn verify_md_is_read_aloud_in_a_quarter_of_an_hour() {
        let page = ledger().expect("each name stands in the sources");
        assert!(words(&page) <= 4500, "{} words", words(&page));
        // At 150 words a minute.
        let read = words(&read_aloud(&page));
        assert!((1500..=2300).contains(&read), "{read} words of prose");
        // A sentence counts, and so do the words of a link that are no name; a line of links does not.
        let text = format!(
            "One [two three](a.rs) [`four`](a.rs#L1).\n## The items of the paper\nFive.\n{LINKS}[six_seven](a.rs#L6) eight.\n{LISTS}ten"
        );
        assert_eq!(words(&read_aloud(&text)), words("One two three Five"));
    }

    /// What is wrong with the links to lines of a page: each must lead to a line that has the name which the link shows, or the
    /// header of the function that a check of this name is stated by.
    fn astray(page: &str, checks: &[Check], places: &Places) -> Vec<String> {
        let mut found = Vec::new();
        for (shown, place) in links(page) {
            let Some((file, line)) = place.split_once("#L") else { continue };
            let text = places.files.iter().find(|(name, _)| name == file).map(|(_, text)| text);
            let line = line.parse().ok().and_then(|line: usize| text?.lines().nth(line - 1));
            let is_shown = |name: &str| name.trim_start_matches("control_") == shown;
            let stated = checks.iter().find_map(|check| match check.subject {
                Subject::Function(_, stated) if is_shown(check.name) => Some(stated),
                _ => None,
            });
            let has = |line: &str| match stated {
                // A control whose mistake stands in the line leads there.
                Some(Stated::At(_)) => line.contains(shown),
                Some(Stated::In(function)) => {
                    let name = parts(function).1;
                    ['<', '('].iter().any(|end| line.contains(&format!("fn {name}{end}")))
                }
                None => line.contains(shown.trim_matches('`')),
            };
            if !line.is_some_and(has) {
                found.push(format!("{shown}: {place}"));
            }
        }
        found
    }

    #[test]
    fn each_link_leads_to_a_line_with_the_name_that_it_shows_or_with_the_function_that_states_it() {
        let (page, places) = (ledger().expect("a page"), Places::read().expect("the sources"));
        let checks: Vec<Check> = claims::all().into_iter().flat_map(|claim| claim.checks).collect();
        assert_eq!(astray(&page, &checks, &places), Vec::<String>::new());
        assert!(links(&page).filter(|(_, place)| place.contains("#L")).count() > 400);
        // A link that is a line off, one to a function that states another check, one to a file that is not there.
        let right =
            places.of(checks.iter().find(|c| c.name == "positive_part_satisfies_4").unwrap());
        let (file, line) = right.as_deref().unwrap().split_once("#L").unwrap();
        let off = format!("{file}#L{}", line.parse::<usize>().unwrap() + 1);
        for (name, place) in [
            ("positive_part_satisfies_4", off.as_str()),
            ("12_and_the_bound_of_phi_hold_on_random_bodies_for_p1", right.as_deref().unwrap()),
            ("`pressure`", "src/kernel/no_such_file.rs#L1"),
        ] {
            assert_eq!(astray(&format!("[{name}]({place})"), &checks, &places).len(), 1, "{name}");
        }
    }

    #[test]
    fn the_controls_that_are_counted_are_those_that_are_listed() {
        let page = ledger().expect("a page");
        let lines = page.lines().filter(|line| line.starts_with("- *Controls:*"));
        let listed = lines.flat_map(links).filter(|(shown, _)| !shown.starts_with('`')).count();
        let checks = claims::all().into_iter().flat_map(|claim| claim.checks);
        assert!(page.contains(&format!("; {listed} controls.")), "{listed}");
        // What is asked can fail: one of them is a control of two engines.
        assert!(listed < checks.filter(|check| check.control).count());
    }

    /// A name that is called, behind that of a module or a type, or `.` for a method.
    type Call<'a> = (&'a str, &'a str);

    /// A function: its name, its file, the header of the `impl` around it, whether it is a method, and what it calls.
    struct Function<'a> {
        name: &'a str,
        file: &'a str,
        header: &'a str,
        is_method: bool,
        calls: Vec<Call<'a>>,
    }

    /// A name that is called, with the file of the function that it means, if that is known.
    type Reached<'a> = (&'a str, Option<&'a str>);

    /// The functions of the sources, which of them have a name, and what each one calls.
    struct Functions<'a> {
        all: Vec<Function<'a>>,
        named: BTreeMap<&'a str, Vec<usize>>,
        called: Vec<Vec<(&'a str, Option<usize>)>>,
        imported: BTreeMap<&'a str, BTreeSet<&'a str>>,
    }

    /// The names in the imports of a text.
    fn imports(text: &str) -> BTreeSet<&str> {
        let statements = text.split("use ").skip(1).filter_map(|rest| rest.split(';').next());
        statements.flat_map(|names| names.split(|c| !is_name(c))).collect()
    }

    fn is_name(c: char) -> bool {
        c.is_alphanumeric() || c == '_'
    }

    /// The functions of a text.
    fn functions<'a>(file: &'a str, text: &'a str) -> Vec<Function<'a>> {
        let mut found = Vec::new();
        let mut header = "";
        let mut at = 0;
        for line in text.split_inclusive('\n') {
            let start = at;
            at += line.len();
            match () {
                () if line.starts_with("impl") => header = line,
                () if line.starts_with('}') => header = "",
                () => {}
            }
            let word =
                ["fn ", "holds ", "fails "].iter().find_map(|s| line.find(s).map(|i| i + s.len()));
            let Some(word) = word.filter(|_| !line.trim_start().starts_with("//")) else {
                continue;
            };
            let part = &text[start + word..];
            let end = part.find(|c| !is_name(c)).unwrap_or(0);
            let Some(open) = part.find('{').filter(|_| end > 0) else { continue };
            let mut depth = 0;
            let close = part[open..].find(|c| {
                depth += i32::from(c == '{') - i32::from(c == '}');
                depth == 0
            });
            let body = &part[open..close.map_or(part.len(), |close| open + close)];
            let (name, is_method) = (&part[..end], part[..open].contains("self"));
            found.push(Function { name, file, header, is_method, calls: calls(body) });
        }
        found
    }

    impl<'a> Functions<'a> {
        fn of(places: &'a Places) -> Self {
            // What runs the checks knows all of them.
            let runs = |file: &str| {
                let name = file.strip_prefix("props/src/").unwrap_or_default();
                let is_definition = ["bodies", "naive", "discrete", "elimination", "numbers/"];
                let of_claims = ["claims/", "sharpness", "problems"];
                let mut known = is_definition.iter().chain(&of_claims);
                file.starts_with("props/") && !known.any(|start| name.starts_with(start))
            };
            let files = places.files.iter().filter(|(file, _)| !runs(file));
            let all = files.flat_map(|(file, text)| functions(file, text));
            let all: Vec<Function> = all
                .filter(|function| !["claim", "checks", "all"].contains(&function.name))
                .collect();
            let mut named: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
            for (i, function) in all.iter().enumerate() {
                named.entry(function.name).or_default().push(i);
            }
            let files = places.files.iter();
            let imported = files.map(|(file, text)| (file.as_str(), imports(text))).collect();
            let mut functions = Functions { all, named, called: Vec::new(), imported };
            let called = functions.all.iter().map(|f| functions.meant_by(f.file, &f.calls));
            functions.called = called.collect();
            functions
        }

        /// Whether a file, or the one above it where it has all of that, imports this name.
        fn imports(&self, file: &str, name: &str) -> bool {
            let above = file.rsplit_once('/').map(|(folder, _)| format!("{folder}.rs"));
            let names = |file: &str| self.imported.get(file).is_some_and(|n| n.contains(name));
            names(file) || above.is_some_and(|above| names(&above) || self.has(&above, name))
        }

        fn has(&self, file: &str, name: &str) -> bool {
            let of = self.named.get(name).into_iter().flatten();
            of.copied().any(|i| self.all[i].file == file)
        }

        /// Which functions a name in a file means: those of the module or the type before the name; else those of this file, or the only one
        /// of props/src or of all.
        fn meant(&self, file: &str, (before, name): Call) -> Vec<usize> {
            let Some(all) = self.named.get(name) else { return Vec::new() };
            let of = |is_meant: &dyn Fn(&Function) -> bool| -> Vec<usize> {
                all.iter().copied().filter(|&i| is_meant(&self.all[i])).collect()
            };
            let is_in = |f: &Function| {
                let mut modules = f.file.trim_end_matches(".rs").split('/');
                modules.any(|module| module == before)
                    || f.header.split(|c| !is_name(c)).any(|name| name == before)
            };
            let is_path = before.starts_with(char::is_alphabetic);
            let mut meant = if is_path { of(&is_in) } else { Vec::new() };
            // Another module than those with the functions.
            let beside = ["self", "super", "crate"];
            if is_path && before.starts_with(char::is_lowercase) && !beside.contains(&before) {
                return meant;
            }
            // A method, one of the crates below; or a function that the file has, or imports.
            let is_such = |f: &Function| {
                let is_below = |folder| file.starts_with(folder) && !f.file.starts_with(folder);
                let is_near = !["src/kernel/", "src/"].iter().any(is_below);
                match before {
                    "." => f.is_method && is_near,
                    _ => is_path || !f.is_method && (f.file == file || self.imports(file, name)),
                }
            };
            if meant.is_empty() {
                meant = of(&|f| f.file == file && is_such(f));
            }
            if meant.is_empty() {
                let all: Vec<usize> = of(&is_such);
                let near = of(&|f| f.file.starts_with("props/src/") && is_such(f));
                let is_near = file.starts_with("props/src/") && !near.is_empty();
                let found = if is_near { near } else { all };
                meant = if found.len() == 1 { found } else { Vec::new() };
            }
            meant
        }

        /// What is called by these calls in a file, by the functions that they mean, and so on: each name with the file of the function
        /// that it means, or without one where it means none or any of several.
        fn reached(&self, file: &str, calls: &[Call<'a>]) -> BTreeSet<Reached<'a>> {
            let mut found = BTreeSet::new();
            let mut seen = vec![false; self.all.len()];
            let mut left = self.meant_by(file, calls);
            while let Some((name, meant)) = left.pop() {
                found.insert((name, meant.map(|i| self.all[i].file)));
                if let Some(i) = meant.filter(|&i| !std::mem::replace(&mut seen[i], true)) {
                    left.extend(&self.called[i]);
                }
            }
            found
        }

        /// The names of calls in a file, each with a function that it means or without one.
        fn meant_by(&self, file: &str, calls: &[Call<'a>]) -> Vec<(&'a str, Option<usize>)> {
            let of = |&(before, name): &Call<'a>| {
                let meant = self.meant(file, (before, name));
                let is_one = self.named.get(name).is_some_and(|all| all.len() == 1);
                let is_unsure = meant.is_empty() || before == "." && !is_one;
                let none = is_unsure.then_some((name, None));
                meant.into_iter().map(move |i| (name, Some(i))).chain(none)
            };
            calls.iter().flat_map(of).collect()
        }
    }

    /// The names that are called in a text, or given to a function by themselves, and constants; each with the name of the module or
    /// of the type before it.
    fn calls(text: &str) -> Vec<Call<'_>> {
        let mut found = Vec::new();
        let mut end = 0;
        while let Some(start) = text[end..].find(is_name).map(|start| end + start) {
            end = text[start..].find(|c| !is_name(c)).map_or(text.len(), |length| start + length);
            let (before, name, after) = (&text[..start], &text[start..end], &text[end..]);
            let path = before.strip_suffix("::");
            let path = path.map(|path| &path[path.rfind(|c| !is_name(c)).map_or(0, |at| at + 1)..]);
            let start = before.strip_suffix("::").map_or(before, |b| b.trim_end_matches(is_name));
            let is_argument = start.trim_end().ends_with(['(', ','])
                && after.trim_start().starts_with([')', ',']);
            let is_constant =
                !name.contains(char::is_lowercase) && name.starts_with(char::is_alphabetic);
            let is_called = after.starts_with('(') || after.starts_with("::<");
            if is_called || is_argument || is_constant {
                let beside = if before.ends_with('.') { "." } else { "" };
                found.push((path.unwrap_or(beside), name));
            }
        }
        found
    }

    /// All that a check calls.
    fn called_by<'a>(
        check: &'a Check,
        places: &'a Places,
        functions: &Functions<'a>,
    ) -> Option<BTreeSet<Reached<'a>>> {
        let place = match check.subject {
            Subject::Function(..) => places.registered(check),
            _ => places.of(check),
        };
        let file = place.ok()?.split('#').next()?.to_owned();
        let (file, text) = places.files.iter().find(|(name, _)| *name == file)?;
        let Subject::Function(..) = check.subject else {
            return Some(functions.reached(file, &[("", check.name)]));
        };
        let (_, text) = text.split_once(&format!("!(\"{}\",", check.name))?;
        let (_, run) = text.split_once("=>")?;
        let mut depth = 1;
        let end = run.find(|c| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            depth == 0
        });
        Some(functions.reached(file, &calls(&run[..end?])))
    }

    #[test]
    fn a_check_runs_the_function_that_its_link_leads_to() {
        let places = Places::read().expect("the sources");
        let functions = Functions::of(&places);
        let checks: Vec<Check> = claims::all().into_iter().flat_map(|claim| claim.checks).collect();
        let (mut count, mut strangers) = (0, 0);
        for check in &checks {
            let Subject::Function(_, stated) = check.subject else { continue };
            let names = called_by(check, &places, &functions).expect("a line of a row");
            let name = parts(stated.by()).1;
            let calls = |asked: &str| names.iter().any(|(name, _)| *name == asked);
            assert!(calls(&name), "{} does not call {name}", check.name);
            strangers += usize::from(calls("monotone_on_bodies"));
            count += 1;
        }
        assert!(count > 50, "{count}");
        // What is asked can fail: two checks call this one.
        assert_eq!(strangers, 2);
        let text = "fn a() { b(); }\nfn b() { c(); }\nfn d() { e(); }\n";
        let places = Places { files: vec![("src/a.rs".to_owned(), text.to_owned())] };
        let names = Functions::of(&places).reached("src/a.rs", &[("", "a")]);
        let here = Some("src/a.rs");
        assert_eq!(names.into_iter().collect::<Vec<_>>(), [("a", here), ("b", here), ("c", None)]);
    }

    /// The lines of code that no check of an item calls.
    fn not_called<'i>(
        item: &'i Item,
        code: &'i [Place],
        claims: &'i [Claim],
        (places, functions): (&'i Places, &Functions<'i>),
    ) -> Vec<&'i str> {
        let mut called = BTreeSet::new();
        for (_, check) in item.found(claims) {
            called.extend(called_by(check, places, functions).expect("a check stands in a file"));
        }
        let is_called = |&&(file, start): &&Place| {
            // A constant, or a function; of another line, the one around it.
            let (_, text) = places.files.iter().find(|(name, _)| name == file).expect("a file");
            let line = places.line((file, start)).expect("a line");
            let lines: Vec<&str> = text.lines().take(line).collect();
            let start = if start.starts_with("const ") { "const " } else { "fn " };
            let header = lines.iter().rev().find_map(|line| line.split_once(start));
            let name = header.and_then(|(_, rest)| rest.split(|c| !is_name(c)).next());
            name.is_some_and(|name| {
                [None, Some(file)].iter().any(|&of| called.contains(&(name, of)))
            })
        };
        code.iter().filter(|place| !is_called(place)).map(|(_, start)| *start).collect()
    }

    #[test]
    fn the_code_of_an_item_is_called_by_its_checks() {
        let (claims, places) = (claims::all(), Places::read().expect("the sources"));
        let functions = Functions::of(&places);
        let mut uncalled = 0;
        for item in ITEMS {
            let not_called = |code| not_called(item, code, &claims, (&places, &functions));
            assert_eq!(not_called(item.code), Vec::<&str>::new(), "{}", item.name);
            assert_eq!(not_called(item.uncalled).len(), item.uncalled.len(), "{}", item.name);
            uncalled += item.uncalled.len();
        }
        assert!(uncalled >= 8, "{uncalled}");
        // What is asked can fail for lines that checks of other items call.
        let of_k = ITEMS.iter().find(|item| item.name == "K").expect("an item");
        for place in [
            ("props/src/bodies/definition.rs", "pub fn big_a("),
            ("src/kernel/contact.rs", "pub fn pressure(&self)"),
        ] {
            assert_eq!(not_called(of_k, &[place], &claims, (&places, &functions)), [place.1]);
        }
    }

    #[test]
    fn a_name_that_does_not_stand_in_the_sources_once_has_no_link() {
        let places = Places::read().expect("the sources");
        assert!(places.of_claims(&["fn no_such_predicate<".to_owned()]).is_err());
        assert!(places.line(("src/kernel/contact.rs", "pub fn no_such_function")).is_err());
        assert!(places.line(("src/kernel/no_such_file.rs", "")).is_err());
    }

    /// What a predicate must not look at: then it could answer each engine as that likes.
    const BESIDE_THE_NUMBERS: [&str; 14] = [
        "type_name",
        "TypeId",
        "Any",
        "is::<",
        "downcast",
        "size_of",
        "format!",
        "{:?}",
        "static ",
        "Cell",
        "Atomic",
        "env::",
        "thread",
        "catch_unwind",
    ];

    /// The functions of a source that are generic over the number type and look at something else, with what they look at.
    fn curious(source: &str) -> Vec<String> {
        let mut found = Vec::new();
        for part in source.split("fn ").skip(1) {
            let Some((header, rest)) = part.split_once('{') else { continue };
            if !header.contains(": Ordered") {
                continue;
            }
            let mut depth = 1;
            let end = rest.find(|c| {
                depth += i32::from(c == '{') - i32::from(c == '}');
                depth == 0
            });
            let body = &rest[..end.unwrap_or(rest.len())];
            let looks = BESIDE_THE_NUMBERS.iter().filter(|word| body.contains(**word));
            let name = header.split(['<', '(']).next().unwrap_or(header);
            found.extend(looks.map(|word| format!("{name}: {word}")));
        }
        found
    }

    #[test]
    fn predicates_look_at_their_numbers_only() {
        let cheat =
            "fn zero<S: Ordered>([a]: [S; 1]) -> Verdict { if type_name::<S>() == \"f64\" {} }";
        assert_eq!(curious(cheat), ["zero: type_name"]);
        let cheat =
            "fn one<S: Ordered>([a]: [S; 1]) -> Verdict { if (&a as &dyn Any).is::<Sym>() {} }";
        assert_eq!(curious(cheat), ["one: Any", "one: is::<"]);
        let cheat =
            "fn two<S: Ordered>([a]: [S; 1]) -> Verdict { if std::env::args().count() == 0 {} }";
        assert_eq!(curious(cheat), ["two: env::"]);
        assert!(curious("fn name<S: Ordered>() {} fn other() { type_name::<f64>() }").is_empty());
        let (mut folders, mut files) = (vec![root().join("props/src/claims")], 0);
        while let Some(folder) = folders.pop() {
            for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if path.is_dir() {
                    folders.push(path);
                } else {
                    files += 1;
                    let found = curious(&std::fs::read_to_string(&path).unwrap());
                    assert!(found.is_empty(), "{}: {found:?}", path.display());
                }
            }
        }
        assert!(files > 20, "{files}");
    }

    #[test]
    fn every_row_has_two_engines_or_a_reason_and_a_control() {
        for claim in &claims::all() {
            // A harness is not counted: a receipt may stop standing behind it at any time.
            let mut kinds: Vec<Engine> = evidence(claim).map(|check| check.engine).collect();
            kinds.retain(|&engine| engine != Engine::Harness);
            kinds.sort_unstable();
            kinds.dedup();
            let is_excused = claim.limits.contains("One engine: ");
            assert!((kinds.len() > 1) != is_excused, "row {}: {kinds:?}", claim.id);
            assert!(claim.checks.iter().any(|check| check.control), "row {}", claim.id);
        }
    }

    #[test]
    fn every_harness_has_a_false_twin_and_there_are_at_least_25() {
        let harnesses = claims::harnesses();
        let twins = harnesses.iter().filter(|harness| harness.counterexample.is_some()).count();
        assert!(twins >= 25, "{twins}");
        assert_eq!(2 * twins, harnesses.len());
    }
}
