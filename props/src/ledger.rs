//! `VERIFY.md`: the ledger of the claims, printed from the claims themselves.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

use crate::claim::{Check, Claim, Engine, Subject};
use crate::claims;
use crate::items::{ITEMS, Item, Place};
use crate::paper;
use crate::proof::tree;
use crate::receipt::{self, hash, root};
use crate::solvers;

const HEAD: &str = "\
# What is verified

Printed by `cargo run -p props -- ledger > VERIFY.md` from the claims themselves; a test fails when it is stale. Each name is a
link to the line of the sources that is meant: an item of the paper leads to the line of the program that it is about and to its
checks, a check to its predicate or to the function that runs it. §9 is row 9.

The paper is F. Chouly, P. Hild, *A Nitsche-based method for unilateral contact problems: numerical analysis*, SIAM J.
Numer. Anal. 51 (2013) 1295-1307. n is the outward normal, sigma_n is negative in compression, P(v) = v_n - g - gamma
sigma_n(v) with a gap g (the paper has g = 0), P0 its linear part, gamma = gamma0 h_T, lambda^h = -(1/gamma)[P(u^h)]+;
|.|_1 is the norm of H^1(Omega), |v|_a^2 = a(v, v).
";

const BODY: &str = "\
## What a check says

A statement is a Rust function, generic over the number type, that compares the kernel's own functions with the paper's formulas,
or is a step of the paper's algebra, which calls nothing of the kernel (most of rows 11 and 15). It answers *holds*, with the class of its data (each must be reached), *vacuous* (the hypothesis
is not met), or *fails*. Other checks assemble on random bodies, solve, or compare doubles with exact numbers. Every row has
**controls**: planted mistakes, which the same check must reject.

- **Rocq**, the reals: the statement, written by hand in `props/rocq/paper.v`, is a theorem; neither the predicate nor the engine that
  found its proof is trusted.
- **proof**, polynomials over Q: every comparison forks the path, and each path that fails contradicts itself, by a certificate (a sum of
  products of facts and squares that is positive and zero): the statement holds over every ordered field, so over the reals. 11/6
  are its paths and those that are refuted; the sixteen digits are a hash of the tree of its questions, answers and ends.
- **exact**, rationals: random data without a tolerance; 200 draws of a statement, and more until 100 meet its hypothesis.
- **doubles**: 5,000 random finite doubles with edge values and ties; or a comparison with exact rationals and a stated bound.
- **Kani**: the bounded model checker has decided a harness for all numbers that it ranges over, and the newest receipt was made of
  these very files.
- **all cases**: each of at most 2^20 cases is run. **draws**: a harness on random draws, *and no more is known*.

Each harness of Kani has a false twin, which must fail. Receipts are in `props/receipts`, written by `props receipt`,
`.ci/rocq.py` and `.ci/smt.py`. The whole solver is compared with FEniCSx, which shares nothing with it but the case files
(`reference/`): what the rows can't see. What the program promises beyond the paper is tested: enclosures and certificates beside
exact rationals in `props/tests/program`, the rest in `tests/suite`. CONTRIBUTING.md says how engines are run and a row is added.

## What is trusted

**The trusted core** of what the program computes is a list that `cargo tree -p signorini-audit -e normal` prints: `src/audit`,
which checks certificates of the error, `src/kernel`, their vectors, a reader of JSON; no solver, no mesh, no linear algebra.
`reference/check_bound.py` checks the same certificates with nothing of it, from their documented format.

The compiler, the standard library, num-rational, num-bigint, proptest, and faer for eigenvalues in doubles. Of this crate, the
arithmetic of rational numbers and of polynomials, the forking of paths and the checker of certificates (`numbers/rational.rs`, and
`polynomial.rs`, `symbol.rs`, `explorer.rs`, `certificate.rs` in `proof`, below `props/src`); the search for certificates is not trusted. `reference/check_certificates.py` checks exported
proofs again with fractions and nothing else, and that each tree is the one whose hash stands here; that its polynomials are those
of the predicate it can't see. What Rocq has proved needs neither. For the rows that assemble on meshes, the definitions written
out in `props/src/naive.rs`, `bodies.rs` and `discrete.rs`; exact elimination (`elimination.rs`), the counts of roundings in
`claims/assembled/compare.rs`, the number types in `numbers`, and the stand-in of the model checker (`harness.rs`). Random bodies
have lambda and mu or a tensor that couples all strains. Exact solutions that are not affine (row 8) are of isotropic
bodies; `tests/suite/tensor.rs` has others.

## Errata of the paper

In (17) and (18) the integral of (sigma_n(u) + [P(u^h)]+/gamma) sigma_n(u - v^h) lacks a factor gamma. As printed it has
the dimension stress^2 length, beside terms of dimension gamma stress^2 length, and both are false at points:

- (17) with gamma = 2, sigma_n(u) = -1 and all else 0: the left side is 0 + 2, the right side 1. With the factor: 2 <= 2.
- (18) with z = sigma_n(u - v^h) = 1, gamma = 1/4, beta_2 = 1: 1 <= 1/8 + 1/8. With the factor: 1/4 <= 1/4.

With the factor gamma both are proved, and the rest of the proof uses them in that form: the theorem stands (row 11). In
section 2.3 the set of the multipliers is printed as L^2(Gamma_C); it is the cone of the nonpositive functions in it.
In the line before (23) the last equality is an inequality: h_T <= h.
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
    for claim in &claims {
        text += &row(claim, &places)?;
    }
    Ok(text)
}

/// The lines of the sources by what stands in them.
struct Places {
    /// File, from the root, and text.
    files: Vec<(String, String)>,
}

impl Places {
    fn read() -> Result<Places, String> {
        let mut files = Vec::new();
        for folder in ["props/src/claims", "src", "study/src"] {
            add(&root().join(folder), &mut files).map_err(|why| format!("{folder}: {why}"))?;
        }
        Ok(Places { files })
    }

    /// The one line of a file of the claims that has one of these texts.
    fn find(&self, texts: &[String]) -> Result<String, String> {
        let mut found = Vec::new();
        for (file, text) in self.files.iter().filter(|(file, _)| file.starts_with("props/")) {
            for (number, line) in text.lines().enumerate() {
                if texts.iter().any(|text| line.contains(text)) {
                    found.push(format!("{file}#L{}", number + 1));
                }
            }
        }
        match &found[..] {
            [place] => Ok(place.clone()),
            _ => Err(format!("{texts:?} stands at {found:?} in props/src/claims, expected once")),
        }
    }

    /// Where a check is to be read: its predicate, its harness, or the function that runs it.
    fn of(&self, check: &Check) -> Result<String, String> {
        let name = check.name;
        match check.subject {
            Subject::Statement(_) => self.find(&[format!("fn {name}<")]),
            Subject::Harness(_) => {
                self.find(&["holds ", "fails "].map(|kind| format!(" {kind}{name}(")))
            }
            Subject::Function(_) => self.find(&[format!("\"{name}\"")]),
        }
    }

    /// The line of a place of the program.
    fn line(&self, (file, text): Place) -> Result<usize, String> {
        let source = self.files.iter().find(|(name, _)| name == file);
        let (_, source) = source.ok_or(format!("there is no file {file}"))?;
        let line = source.lines().position(|line| line.trim_start().starts_with(text));
        line.map(|line| line + 1).ok_or(format!("no line of {file} begins with '{text}'"))
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

/// Everything that was said of checks of one name.
fn engines(checks: &[&Check]) -> String {
    let mut names: Vec<(Engine, &str)> =
        checks.iter().map(|c| (c.engine, c.engine_name())).collect();
    names.sort_unstable();
    names.dedup();
    let mut names: Vec<&str> = names.into_iter().map(|(_, name)| name).collect();
    if is_a_statement(checks[0]) && theorem(checks[0].name).is_some() {
        names.insert(0, "Rocq");
    }
    names.join(", ")
}

fn link(check: &Check, places: &Places) -> Result<String, String> {
    Ok(format!("[{}]({})", check.shown_name(), places.of(check)?))
}

/// Links to checks, those that the same engines were asked together, the strongest first.
fn grouped<'a>(checks: impl Iterator<Item = &'a Check>, places: &Places) -> Result<String, String> {
    let mut groups: BTreeMap<(Vec<Engine>, String), Vec<String>> = BTreeMap::new();
    for checks in by_name(checks) {
        let order = checks.iter().map(|check| check.engine).collect();
        groups.entry((order, engines(&checks))).or_default().push(link(checks[0], places)?);
    }
    let text = groups
        .into_iter()
        .map(|((_, engines), links)| format!(" *{engines}:* {}.", links.join(", ")));
    Ok(text.collect())
}

fn of_item(item: &Item, claims: &[Claim], places: &Places) -> Result<String, String> {
    let found = item.found(claims);
    let mut rows: Vec<&str> = found.iter().map(|(claim, _)| claim.id).collect();
    rows.dedup();
    let rows: Vec<String> = rows.iter().map(|id| format!("[§{id}](#row-{id})")).collect();
    let mut text = format!("\n**{}** {}", item.name, item.says);
    if !rows.is_empty() {
        let _ = write!(text, ", {}", rows.join(" "));
    }
    text.push('.');
    for (n, &place) in item.code.iter().enumerate() {
        let (file, start) = place;
        let name = start.trim_start_matches("pub ").trim_end_matches(['(', '<', ')']);
        let name = name.trim_end_matches("(&self").rsplit("fn ").next().unwrap_or(name);
        let before = if n == 0 { " *Code:* " } else { ", " };
        let _ = write!(text, "{before}[`{name}`]({file}#L{})", places.line(place)?);
    }
    text += &grouped(found.iter().map(|(_, check)| *check), places)?;
    if !item.missing.is_empty() {
        let _ = write!(text, " *Not checked:* {}.", item.missing);
    }
    Ok(text + "\n")
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
    let holds: Vec<&str> =
        harnesses.iter().filter(|h| h.counterexample.is_none()).map(|h| h.name).collect();
    let over_doubles = holds.iter().filter(|name| name.ends_with("doubles")).count();
    let over_words = holds.iter().filter(|name| name.ends_with("i16")).count();
    let over_bytes = holds
        .iter()
        .filter(|name| name.contains("for_all_i8") || name.ends_with("i8_gamma"))
        .count();
    format!(
        "- {} rows about the paper, and row 13 about the numbers of the computer: {} statements proved, {} of them also drawn over \
         rationals; {} more in exact numbers, {} statements and {} other checks in doubles, {} harnesses; {} controls. `cargo test` \
         runs all of them, harnesses on draws.\n\
         - Rocq: {proved} of {} theorems over the reals, by {} ({}); {twins} false twins are refused, and the axioms are those of the \
         classical reals.\n\
         - Doubles: {} found each of the {} failing paths of these statements impossible over all finite doubles ({}); of the controls \
         it found {} possible.\n\
         - Kani: {}\n\
         - Of the {} harnesses that must hold, {over_doubles} range over all doubles or all finite ones, {over_words} over i16, \
         {over_bytes} over bytes; {} range over smaller sets, which their names say.\n\
         - The solver's results: compared with FEniCSx and scikit-fem by `.ci/run`.\n",
        claims.len() - 1,
        of(Engine::Proof, true),
        drawn,
        of(Engine::Exact, false) + of(Engine::Exact, true) - drawn,
        of(Engine::Doubles, true),
        of(Engine::Doubles, false),
        holds.len(),
        checks().filter(|check| check.control).count(),
        theorems.len(),
        rocq.head.join(", "),
        rocq.date,
        doubles.head.join(", "),
        doubles.count("unsat", "unsat"),
        doubles.date,
        doubles.count("unknown", "sat"),
        receipt::said(&harnesses),
        holds.len(),
        holds.len() - over_doubles - over_words - over_bytes,
    )
}

/// How many statements are both proved and drawn.
fn drawn_too(evidence: &[Vec<&Check>]) -> usize {
    let both = |checks: &&Vec<&Check>| {
        [Engine::Proof, Engine::Exact].iter().all(|e| checks.iter().any(|c| c.engine == *e))
    };
    evidence.iter().filter(both).count()
}

/// A row: its proofs one a line, as `reference/check_certificates.py` reads them, its other checks, and its controls.
fn row(claim: &Claim, places: &Places) -> Result<String, String> {
    let Claim { id, title, paper, limits, .. } = claim;
    let mut text = format!(
        "\n### Row {id}\n\n**{title}.** **Paper:** {paper} **Not established:** {limits}\n\n"
    );
    let mut others: Vec<&Check> = Vec::new();
    for checks in by_name(claim.checks.iter().filter(|check| !check.control)) {
        let proof = checks.iter().find(|check| check.engine == Engine::Proof);
        let Some(Check { subject: Subject::Statement(statement), .. }) = proof else {
            others.extend(checks);
            continue;
        };
        let ([paths, refuted], tree) = tree(statement);
        let _ = write!(text, "- {}: {paths}/{refuted} {}", link(checks[0], places)?, hash(&tree));
        let also: Vec<&Check> =
            checks.iter().copied().filter(|check| check.engine != Engine::Proof).collect();
        if !also.is_empty() {
            let _ = write!(
                text,
                ", {}",
                also.iter().map(|c| c.engine.name()).collect::<Vec<_>>().join(", ")
            );
        }
        if let Some(name) = theorem(checks[0].name) {
            let _ = write!(text, ", Rocq `{name}`");
        }
        text.push('\n');
    }
    if !others.is_empty() {
        let _ = writeln!(text, "\n{}", grouped(others.into_iter(), places)?.trim_start());
    }
    let controls = by_name(claim.checks.iter().filter(|check| check.control));
    let links: Result<Vec<String>, String> =
        controls.iter().map(|checks| link(checks[0], places)).collect();
    let _ = writeln!(text, "\n*Controls:* {}.", links?.join(", ").replace("[control_", "["));
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(claim: &Claim) -> impl Iterator<Item = &Check> {
        claim.checks.iter().filter(|check| !check.control)
    }

    #[test]
    fn verify_md_is_what_the_claims_print() {
        let stored = std::fs::read_to_string(root().join("VERIFY.md")).unwrap_or_default();
        let printed = ledger().expect("each name stands in the sources");
        assert!(stored == printed, "stale: cargo run -p props -- ledger > VERIFY.md");
        // A quarter of an hour at 300 words a minute.
        let is_word = |word: &&str| word.contains(char::is_alphanumeric);
        let words = printed.split_whitespace().filter(is_word).count();
        assert!(words <= 4500, "{words} words");
    }

    #[test]
    fn a_name_that_does_not_stand_in_the_sources_once_has_no_link() {
        let places = Places::read().expect("the sources");
        assert!(places.find(&["fn no_such_predicate<".to_owned()]).is_err());
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
