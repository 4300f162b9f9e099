//! `VERIFY.md`: the ledger of the claims, printed from the claims themselves.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::claim::{Check, Claim, Engine};
use crate::claims;
use crate::items::ITEMS;
use crate::paper;
use crate::proof::explorer::explore;
use crate::solvers::Field;
use crate::statement::Statement;

const HEAD: &str = "\
# What is verified

Printed by `cargo run -p props -- ledger > VERIFY.md` from the claims themselves; a test fails when it is stale, so what it
says holds of the commit that it is in.

The paper is F. Chouly, P. Hild, *A Nitsche-based method for unilateral contact problems: numerical analysis*, SIAM J.
Numer. Anal. 51 (2013) 1295-1307. n is the outward normal, sigma_n is negative in compression, P(v) = v_n - g - gamma
sigma_n(v) with a gap g (the paper has g = 0), P0 its linear part, gamma = gamma0 h_T, lambda^h = -(1/gamma)[P(u^h)]+;
|.|_1 is the norm of H^1(Omega), |v|_a^2 = a(v, v).
";

const BODY: &str = "\
## What a check says

A statement is a Rust function, generic over the number type, that compares the kernel's own functions with the paper's formulas.
It answers *holds*, with the class of its data, *vacuous* (the hypothesis is not met), or *fails*; each class that it names must
be reached. Several engines run it; other checks assemble on random bodies, solve, or compare doubles with exact numbers. Every
row has **controls**: planted mistakes, which the same check must reject.

| engine | numbers | what a pass means |
| --- | --- | --- |
| Rocq | the reals | the statement, written by hand in `props/rocq/paper.v`, is a theorem: neither the predicate nor the engine that found its proof is trusted |
| proof | polynomials over Q | every comparison forks the path, and each path that fails contradicts itself, by a certificate (a sum of products of facts and squares that is positive and zero): the statement holds over every ordered field, so over the reals |
| exact | rationals | random data without a tolerance, 500 draws of a statement and more until 100 of them meet its hypothesis |
| doubles | f64 | random finite doubles with edge values and ties, 20,000 draws; or a comparison with exact rationals and a stated bound, or with intervals rounded outwards |
| Kani | f64, small integers | the bounded model checker has decided a harness for all numbers that it ranges over, by a receipt that is about these very sources |
| all cases | bits, bytes | each of at most 2^20 cases is run |
| draws | f64, integers | a harness without a receipt: run on random draws, **and no more is known** |

`cargo install --locked kani-verifier && cargo kani setup` installs Kani, `cargo kani` at the root runs every harness (minutes on
two busy cores, 1 GiB): a harness that passes holds for all numbers that it ranges over, and its false twin fails.

Receipts are in `props/receipts`; each has a hash of what it is about, and a test fails when another thing stands there now. The
whole solver is compared with FEniCSx, which shares nothing with it but the case files (`reference/`): what the rows can't see.
`cargo run -p props -- audit` runs every row and writes `target/audit/index.html`: **the page**, with the statement of each row
as it is checked, and each check with what it found. How engines are run and a row is added: CONTRIBUTING.md.

## What is trusted

**The trusted core** of what the program computes is a list that `cargo tree -p signorini-audit -e normal` prints: `src/audit`,
which checks certificates of the error, `src/kernel`, their vectors, a reader of JSON; no solver, no mesh, no linear algebra.
`reference/check_bound.py` checks the same certificates with nothing of it, from their documented format.

The compiler, the standard library, num-rational, num-bigint, proptest, and faer for eigenvalues in doubles. Of this crate, the
arithmetic of polynomials, the forking of paths and the checker of certificates (`polynomial.rs`, `symbol.rs`, `explorer.rs`,
`certificate.rs` in `props/src/proof`); the search for certificates is not trusted, and `reference/check_certificates.py`
checks them again with fractions and nothing else. It can't see that the polynomials are those of the predicate; what Rocq has
proved needs neither. For the rows that assemble on meshes, the transcription of the definitions in `props/src/naive.rs`,
`bodies.rs` and `discrete.rs`; exact elimination (`elimination.rs`), the counts of
roundings in `claims/assembled/compare.rs`, the number types in `numbers`, and the stand-in of the model checker
(`harness.rs`). A is any tensor of section 2.1 in
the plane: random bodies have lambda and mu or a tensor that couples all strains, those on which the solver's own doubles are compared
with the definitions, too. Exact solutions that are not affine
(rows 8, 11, 12, 15, 17), the enclosures of row 10 and the certificates of rows 24 and 26 are of isotropic bodies;
`tests/suite/tensor.rs` has others.

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
pub fn ledger() -> String {
    let claims = claims::all();
    let mut text = format!(
        "{HEAD}\n## State\n\n{}\n{BODY}\n## The items of the paper\n\n\
         | item | what it says | rows | evidence | not checked, or taken from the literature |\n\
         | --- | --- | --- | --- | --- |\n",
        state(&claims)
    );
    for item in ITEMS {
        let found = item.found(&claims);
        let mut rows: Vec<String> =
            found.iter().map(|(claim, _)| format!("[{0}](#row-{0})", claim.id)).collect();
        rows.dedup();
        let evidence = match found.len() {
            0 => "none".to_owned(),
            n => format!("{n}: {}", engines(found.iter().map(|(_, check)| *check))),
        };
        let rows = rows.join(", ");
        let says = item.says.replace('|', "\\|");
        let missing = item.missing.replace('|', "\\|");
        let _ = writeln!(text, "| {} | {} | {rows} | {evidence} | {missing} |", item.name, says);
    }
    claims.iter().for_each(|claim| text += &row(claim));
    text + &proofs()
}

/// What holds by which engines, and what the receipts are about.
fn state(claims: &[Claim]) -> String {
    let checks = || claims.iter().flat_map(|claim| &claim.checks);
    let receipt = |field: Field| {
        let receipt = field.receipt();
        format!("{} ({})", receipt.solvers.join(", "), receipt.date)
    };
    let harnesses = || checks().filter(|check| check.engine == Engine::Harness);
    let verified = harnesses().filter(|check| check.engine_name() == "Kani").count();
    let theorems = paper::theorems();
    let proved = theorems.iter().filter(|theorem| theorem.is_proved()).count();
    let rocq = paper::receipt();
    format!(
        "- {} rows: {}. `cargo test` runs all of them.\n\
         - Rocq: {proved} of {} theorems over the reals, by {} ({}); each false twin is refused, and the axioms are those of the \
         classical reals.\n\
         - Solvers: the failing paths of the proofs were given to {}; the statements in doubles, over all finite doubles, to {}.\n\
         - Kani: {verified} of {} harnesses verified by receipt; the others are run on random draws, or on all of their cases.\n\
         - The solver's results: compared with FEniCSx and scikit-fem by `.ci/run`.\n",
        claims.len(),
        counted(&checks().collect::<Vec<_>>()),
        theorems.len(),
        rocq.solvers.join(", "),
        rocq.date,
        receipt(Field::Reals),
        receipt(Field::Doubles),
        harnesses().count(),
    )
}

/// How many of these checks there are by each engine, and how many controls.
fn counted(checks: &[&Check]) -> String {
    let mut counts: BTreeMap<(Engine, &str), usize> = BTreeMap::new();
    for check in checks.iter().filter(|check| !check.control) {
        *counts.entry((check.engine, check.engine_name())).or_default() += 1;
    }
    let mut listed: Vec<String> =
        counts.iter().map(|((_, name), n)| format!("{name} {n}")).collect();
    let controls = checks.iter().filter(|check| check.control).count();
    listed.push(format!("{controls} control{}", if controls == 1 { "" } else { "s" }));
    listed.join(", ")
}

/// The proofs one by one, as `reference/check_certificates.py` reads them.
fn proofs() -> String {
    let theorems = paper::theorems();
    let line = |(name, statement): (&&str, &Statement)| {
        let paths = explore(statement.variables.len(), statement.symbolic);
        let refuted = paths.iter().filter(|path| path.verdict.fails()).count();
        let by = theorems.iter().filter(|t| t.is_proved() && t.predicate == Some(*name));
        let rocq: String = by.map(|theorem| format!(". Rocq: `{}`", theorem.name)).collect();
        let classes = statement.classes.join(" | ");
        format!("- `{name}`: {}/{refuted}; {classes}{rocq}\n", paths.len())
    };
    let lines: String = claims::statements(Engine::Proof).iter().map(line).collect();
    format!(
        "\n## The proofs\n\nEach statement with its paths, those of them that a certificate refutes (11/6), and the classes that it reaches; with the \
         theorem that Rocq proved from the same certificates.\n\n{lines}"
    )
}

/// The engines of these checks.
pub fn engines<'a>(checks: impl Iterator<Item = &'a Check>) -> String {
    let mut engines: Vec<(Engine, &str)> =
        checks.map(|check| (check.engine, check.engine_name())).collect();
    engines.sort_unstable();
    engines.dedup();
    engines.into_iter().map(|(_, name)| name).collect::<Vec<_>>().join(", ")
}

/// A row as a paragraph.
fn row(claim: &Claim) -> String {
    let Claim { id, title, paper, limits, .. } = claim;
    let items: Vec<&str> = claim.items().map(|item| item.name).collect();
    let single = claim.single.map_or(String::new(), |why| format!(" **One engine:** {why}"));
    format!(
        "\n### Row {id}\n\n**{title}** ({}). **The paper:** {paper} **Evidence:** {}. **Not established:** {limits}{single}\n",
        items.join(", "),
        counted(&claim.checks.iter().collect::<Vec<_>>()),
    )
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn evidence(claim: &Claim) -> impl Iterator<Item = &Check> {
        claim.checks.iter().filter(|check| !check.control)
    }

    fn root() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace")
    }

    #[test]
    fn verify_md_is_what_the_claims_print() {
        let stored = std::fs::read_to_string(root().join("VERIFY.md")).unwrap_or_default();
        assert!(stored == ledger(), "stale: cargo run -p props -- ledger > VERIFY.md");
    }

    /// What a predicate must not look at: then it could answer each engine as that likes.
    const BESIDE_THE_NUMBERS: [&str; 8] =
        ["type_name", "TypeId", "size_of", "format!", "{:?}", "static ", "Cell", "Atomic"];

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
            assert!((kinds.len() > 1) != claim.single.is_some(), "row {}: {kinds:?}", claim.id);
            assert!(claim.checks.iter().any(|check| check.control), "row {}", claim.id);
        }
    }

    #[test]
    fn every_harness_has_a_false_twin_and_there_are_at_least_25() {
        let claims = claims::all();
        let harnesses = |control: bool| {
            let all = claims.iter().flat_map(|c| &c.checks).filter(|c| c.engine == Engine::Harness);
            all.filter(|check| check.control == control).count()
        };
        assert!(harnesses(false) >= 25, "{}", harnesses(false));
        assert_eq!(harnesses(false), harnesses(true));
    }
}
