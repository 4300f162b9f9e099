//! `VERIFY.md`: the ledger of the claims, printed from the claims themselves.

use std::fmt::Write;

use crate::claim::{Check, Claim, Engine};
use crate::claims;
use crate::items::ITEMS;

/// What stands before the items, in Markdown.
pub const HEAD: &str = "\
# What is verified, and how

Printed by `cargo run -p props -- ledger > VERIFY.md` from the claims themselves; a test fails when it is stale.

## For the auditor

The paper is F. Chouly, P. Hild, *A Nitsche-based method for unilateral contact problems: numerical analysis*, SIAM J.
Numer. Anal. 51 (2013) 1295-1307. Each of its items has a row below: its words, the statement as it is checked, the code
that it is about, the evidence, and what that does not establish. Conventions: n is the outward normal, sigma_n is
negative in compression, P(v) = v_n - g - gamma sigma_n(v) with a gap g (the paper has g = 0), P0 its linear part,
gamma = gamma0 h_T, lambda^h = -(1/gamma)[P(u^h)]+.

A statement is an ordinary Rust function, generic over the number type, that calls the kernel's own functions and
compares them with the paper's formulas. It answers *holds*, with the class of its data, *vacuous* (the hypothesis is not
met), or *fails*. A check named alike under several engines is one function, run by each of them; the others are functions
of their own, for one engine: they assemble on random bodies, solve, or compare doubles with exact numbers.

| engine | numbers | what a pass means |
| --- | --- | --- |
| proof | symbols: polynomials over Q | every comparison forks the path; each path that ends in *fails* contradicts itself, by a certificate (a sum of products of the path's facts and of squares that is positive and zero) that a checker of 40 lines verifies. So it holds over every ordered field, hence over R |
| exact | rationals | random data, no tolerance at all; 2000 draws of each statement |
| doubles | f64 | random finite doubles with edge values, ties and neighbours, 20000 draws of each statement; or a comparison with exact rationals and a stated bound; or an enclosure by intervals, rounded outwards |
| Kani | f64, small integers | the bounded model checker Kani has decided a harness, for all numbers that it ranges over, and a receipt in `props/receipts` is about these very sources |
| all cases | bits, bytes | the harness ranges over at most 2^20 cases, and each of them is run |
| draws | f64, integers | neither: **the harness is run on random draws, and no more is known**; where its name in the source says `for_all`, it says `for_random` here. A false twin is run at the counterexample that is stored with it |

A further opinion, not part of `cargo test`: `cargo run -p props -- smt DIR` writes every failing path of the proofs as a
problem for z3 and cvc5, and every failing path of the statements in doubles, over all finite doubles, for bitwuzla;
`.ci/smt.py DIR` runs them and fails on a contradiction, or where no solver confirms a path. What bitwuzla answers decides
a statement for all finite doubles. The answers are kept, with a hash of each problem and the versions of the solvers, and a
test fails when a problem that was asked is another one now, or when a solver contradicts.

**Receipts** (`props/receipts`): `cargo kani` at the root runs the model checker, which is not part of `cargo test`; `cargo
run -p props -- receipt LOG` keeps what it printed, and `.ci/smt.py DIR --receipt props/receipts` what the solvers answered. A
receipt stands behind a harness as long as the harness, the items of the kernel and of this crate that it reaches, Kani's flags
and the packages are the same (`props/src/fingerprint.rs`: by content, wherever they stand); then \"verified by receipt\" stands
beside it below, for a control that exactly its planted mistake fails.

**The certificates** of the proofs can be checked without this crate: `cargo run -p props -- export DIR` writes each proof
as text, its paths with every question and answer, its facts and its certificates, and `python3
reference/check_certificates.py DIR VERIFY.md`, which uses fractions and nothing else, checks that the paths leave no point
out and that each one that fails contradicts itself. That the polynomials are those of the predicate it can't see: this is
what remains to trust, with the predicate itself.

**The reference.** An engine of another kind: an independent program in FEniCSx (`reference/fenicsx`) solves the same case
files, and `cargo test --test suite reference` compares the whole solver with its stored results, one file for each case in
`reference/results/`. It sees what the rows can't: the solution of the discrete problem, on meshes of any size.

| row | what is compared | stored results |
| --- | --- | --- |
| 6, method (8) | energies, contact force, length and peak, reactions, displacement at every vertex of the small meshes: 1e-10 relative; P1 and P2, exact and by 4 Gauss points | `block-*`, `cantilever-*`, `disk` |
| 6, with a gap | the same | `gap-*`, `smooth-gap-*`, `patch-d3-*`, `patch-d5-*` |
| 8, consistency | the same where the exact solution is discrete: its errors are rounding on both sides | `patch-*` |
| 12, rates, P2 of Remark 3.7 | the same, and the errors in all norms: 1e-8 relative | `smooth-*`, `singular-*`, `corner-*` |

Its controls are in `reference/tests`: penalty in place of Nitsche, |E| in place of h_T and gamma inverted disagree with
the stored results by far more than the tolerance. It does not establish that both programs read the paper rightly where
they read it alike.

A check is no check if it can't fail. Every class of data that a statement names must be hit (it names at least one), every
row has a **control**, a planted mistake that the same check must reject (of a statement: in the conclusion that the
control names), and a harness has a false twin, which must fail on the counterexample
that is stored with it.

**The trusted core** of what the program computes is a list that `cargo tree -p signorini-audit -e normal` prints: the crate `src/audit`,
which checks certificates of the error, the crate `src/kernel`, their vectors, a reader of JSON; no solver, no mesh, no linear algebra
(`.ci/run` fails when they are in it). `reference/check_bound.py` checks the same certificates with nothing of it, from their documented
format (`docs/certificates.md`).

**What is trusted:** the compiler and the standard library; num-rational and num-bigint; of this crate, the arithmetic of
polynomials, the forking of paths and the checker (`props/src/proof/polynomial.rs`, `symbol.rs`, `explorer.rs`,
`certificate.rs`), which have tests of their own: every random point lies on exactly one path and has its verdict, and the
checker refuses bad certificates of each kind. The search for certificates is not trusted. For the rows that assemble
on meshes, the naive transcription of the definitions in `props/src/naive.rs`; for the definite matrices of rows 9 and
10, the exact elimination in `elimination.rs`; for the enclosed integrals of row 8, `enclosure.rs` and the intervals of
row 13; for the rounding bounds of rows 5 and 6, the counts of roundings in `claims/assembled/compare.rs`. For what is drawn: the
bodies and the definitions on them in `bodies.rs` and `discrete.rs`, the number types in `numbers`, the counting of draws in
`draws.rs` with proptest, the stand-in of the model checker in `harness.rs`; for eigenvalues in doubles faer.

**How to run:** `cargo run -p props -- audit` runs every row and writes `target/audit/index.html` (a page with the
provenance of the run, the items of the paper one by one, and links to the functions), the same as JSON and as JUnit;
`cargo run -p props -- audit 9` runs row 9 and writes files of its own; `cargo test -p props` runs all of it with the engines' own tests. Each check draws
from the seed and its own name, and replays the failures that it remembers (`props/regressions`) before; the page counts
both. `PROPS_SEED=random` draws other random data and prints the seed; `PROPS_SEED=<number>` repeats it.

**Mistakes planted in the sources:** `.ci/planted.py` plants those of `props/planted.toml`, one at a time, and asks the check
that is named there. `cargo mutants -F src/kernel/contact.rs` (with cargo-nextest) plants small ones in a file of kernel,
assembly, solver or certificates, and asks the claims alone; with `--workspace --config .cargo/mutants-proof.toml` in the trusted part of the proof engine, and asks
the engine's own tests. What came of it: `props/mutants.md`. All harnesses take Kani 0.67 some 12 minutes and 1 GiB on two loaded cores.

**How to add a row:** write the predicate in `props/src/claims/`, generic over `Ordered`, with `given!` for hypotheses and
`ensure!` for conclusions; plant a mistake as a control; list both in a `Claim`, and the claim in `claims::all`; print the
ledger again.

## Errata of the paper

In (17) and (18) the integral of (sigma_n(u) + [P(u^h)]+/gamma) sigma_n(u - v^h) lacks a factor gamma. As printed it has
the dimension stress^2 length, beside terms of dimension gamma stress^2 length, and both are false at points:

- (17) with gamma = 2, sigma_n(u) = -1 and all else 0: the left side is 0 + 2, the right side 1. With the factor: 2 <= 2.
- (18) with z = sigma_n(u - v^h) = 1, gamma = 1/4, beta_2 = 1: 1 <= 1/8 + 1/8. With the factor: 1/4 <= 1/4.

With the factor gamma both are proved, and the rest of the proof uses them in that form: the theorem stands (row 11).

In section 2.3 the set of the multipliers is printed as L^2(Gamma_C); it is the cone of the nonpositive functions in it.
";

/// The text of `VERIFY.md`.
pub fn ledger() -> String {
    let claims = claims::all();
    let mut text = format!(
        "{HEAD}\n## The items\n\nThe evidence for an item is those checks of its rows that are about it, listed in \
         `props/src/items.rs` and item by item on the page of the audit. The last column is what nothing here checks.\n\n\
         | item | what it says | rows | evidence | taken from analysis and literature |\n\
         | --- | --- | --- | --- | --- |\n"
    );
    for item in ITEMS {
        let rows: Vec<String> =
            item.checks().iter().map(|(id, _)| format!("[{id}](#row-{id})")).collect();
        let found = item.found(&claims);
        let evidence = match found.len() {
            0 => "none".to_owned(),
            1 => format!("1 check: {}", engines(found.iter().map(|(_, check)| *check))),
            n => format!("{n} checks: {}", engines(found.iter().map(|(_, check)| *check))),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {evidence} | {} |",
            item.name,
            item.says,
            rows.join(", "),
            item.literature().unwrap_or_default()
        );
    }
    for claim in &claims {
        text += &row(claim);
    }
    text
}

/// The engines of these checks.
pub fn engines<'a>(checks: impl Iterator<Item = &'a Check>) -> String {
    let mut engines: Vec<(Engine, &str)> =
        checks.map(|check| (check.engine, check.engine_name())).collect();
    engines.sort_unstable();
    engines.dedup();
    engines.into_iter().map(|(_, name)| name).collect::<Vec<_>>().join(", ")
}

fn evidence(claim: &Claim) -> impl Iterator<Item = &Check> {
    claim.checks.iter().filter(|check| !check.control)
}

/// The directory under `src` where an item of a claim is: that of the kernel unless its path begins with another one.
pub fn source(path: &str) -> &str {
    let first = path.split("::").next().unwrap_or(path);
    if ["audit", "certify", "fem", "solve"].contains(&first) { first } else { "kernel" }
}

fn row(claim: &Claim) -> String {
    let mut text =
        format!("\n## Row {}\n\n**{}** ({})\n\n", claim.id, claim.title, claim.items.join(", "));
    let mut line = |name: &str, content: &str| {
        let _ = writeln!(text, "- **{name}:** {content}");
    };
    line("The paper", claim.paper);
    line("As checked", claim.statement);
    line("Numbers", claim.numbers);
    let (solver, kernel): (Vec<&str>, Vec<&str>) =
        claim.kernel.iter().partition(|path| source(path) != "kernel");
    for (of, paths) in [("Code (`src/kernel`)", kernel), ("Code (`src`)", solver)] {
        if !paths.is_empty() {
            let paths: Vec<String> = paths.iter().map(|path| format!("`{path}`")).collect();
            line(of, &paths.join(", "));
        }
    }
    line("Assumed", claim.preconditions);
    line("Not established", claim.limits);
    if let Some(why) = claim.single {
        line("Why one engine", why);
    }
    let _ = writeln!(
        text,
        "- **Run:** `cargo run -p props -- audit {id}`, or `cargo test -p props every_check_of_row_{id}_passes`\n",
        id = claim.id
    );
    text += "| engine | evidence |\n| --- | --- |\n";
    for check in evidence(claim) {
        text += &line_of(check);
    }
    text += "\n| engine | control: a planted mistake that is rejected |\n| --- | --- |\n";
    for check in claim.checks.iter().filter(|check| check.control) {
        text += &line_of(check);
    }
    text
}

/// A check in the table of its row, with what a receipt says of it.
fn line_of(check: &Check) -> String {
    let receipt = check.receipt().map_or(String::new(), |receipt| format!(": {receipt}"));
    format!("| {} | `{}`{receipt} |\n", check.engine_name(), check.shown_name())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn root() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace")
    }

    #[test]
    fn verify_md_is_what_the_claims_print() {
        let stored = std::fs::read_to_string(root().join("VERIFY.md")).unwrap_or_default();
        assert!(stored == ledger(), "stale: cargo run -p props -- ledger > VERIFY.md");
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

    /// The type of an `impl` header without the word `impl`: what follows its generics, and the trait if there is one.
    fn subject(header: &str) -> String {
        let mut depth = 0;
        let generics = header.find(|c| {
            depth += i32::from(c == '<') - i32::from(c == '>');
            depth == 0
        });
        let rest = header[generics.map_or(0, |i| i + 1)..].rsplit(" for ").next().unwrap();
        rest.trim_start().chars().take_while(char::is_ascii_alphanumeric).collect()
    }

    #[test]
    fn every_item_of_a_row_exists() {
        for path in claims::all().iter().flat_map(|c| c.kernel) {
            let directory = source(path);
            let inside = path.strip_prefix(&format!("{directory}::")).unwrap_or(path);
            let (module, name) =
                (inside.split("::").next().unwrap(), inside.rsplit("::").next().unwrap());
            let source =
                std::fs::read_to_string(root().join(format!("src/{directory}/{module}.rs")));
            let source = source.unwrap_or_else(|why| panic!("{path}: {why}"));
            let declared = [format!("fn {name}("), format!("fn {name}<")];
            assert!(declared.iter().any(|d| source.contains(d)), "{path}");
        }
    }

    /// The public functions of the kernel, as `module::Type::function` or `module::function`, read off its source.
    fn kernel_functions() -> Vec<String> {
        let mut found = Vec::new();
        for entry in std::fs::read_dir(root().join("src/kernel")).unwrap() {
            let path = entry.unwrap().path();
            let module = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let source = std::fs::read_to_string(&path).unwrap();
            let code = source.split("#[cfg(test)]").next().unwrap();
            let mut of = String::new();
            for line in code.lines() {
                if let Some(header) = line.strip_prefix("impl") {
                    of = subject(header) + "::";
                } else if line == "}" {
                    of.clear();
                }
                if let Some(rest) = line.trim_start().strip_prefix("pub fn ") {
                    let name: String = rest
                        .chars()
                        .take_while(|c| c.is_ascii_alphanumeric() || *c == '_')
                        .collect();
                    found.push(format!("{module}::{of}{name}"));
                }
            }
        }
        found
    }

    #[test]
    fn every_public_function_of_the_kernel_meets_a_claim() {
        let claims = claims::all();
        let functions = kernel_functions();
        assert!(functions.len() > 30, "{functions:?}");
        for function in functions {
            let met = claims.iter().any(|c| c.kernel.contains(&function.as_str()));
            assert!(met, "{function} is in no row");
        }
    }
}
