//! A proof as tactics for Rocq: the questions of the predicate's paths as case distinctions, and for each path that fails the
//! products of its certificate, of which linear arithmetic makes the contradiction. The statement is not written here but by
//! hand, in `props/rocq/paper.v`, with the names of the predicate's unknowns: Rocq decides whether these tactics prove it.

use std::fmt::Write;

use super::certificate::{Certificate, Term};
use super::explorer::{Fact, Path, Sense};
use super::polynomial::Polynomial;
use super::symbol::Step;
use super::{Fate, analyse};
use crate::statement::Statement;
use crate::verdict::Verdict;

/// A path, with its certificate if it fails.
type Branch<'a> = (&'a Path, Option<&'a Certificate>);

/// Tactics that close a goal about the unknowns of the statement. The tactics `of_sign`, `other_inverses`, `product` and
/// `settle` are those of `props/rocq/paper.v`.
///
/// # Errors
/// The first path that fails and is not refuted.
pub fn tactics(statement: &Statement) -> Result<String, String> {
    let analysis = analyse(statement);
    let mut branches: Vec<Branch<'_>> = analysis.paths.iter().map(|path| (path, None)).collect();
    for (number, fate) in &analysis.fates {
        let Fate::Impossible(certificate) = fate else {
            return Err(format!("{}: path {number} is not refuted", statement.name));
        };
        branches[*number].1 = Some(certificate);
    }
    let mut text = "unfold Rdiv in *.\n".to_owned();
    let paths = analysis.paths.iter();
    let most = paths.max_by_key(|path| path.variables).map(|path| path.names(statement.variables));
    tree(&branches, 0, &Names(most.unwrap_or_default()), &mut text);
    Ok(text)
}

/// The names of the variables.
struct Names(Vec<String>);

impl Names {
    /// A sum of products, each power written out.
    fn polynomial(&self, p: &Polynomial) -> String {
        let term = |(monomial, coefficient): (&Vec<u16>, &num_rational::BigRational)| {
            let powers = monomial.iter().enumerate();
            let factors = powers.flat_map(|(i, &e)| vec![self.0[i].clone(); usize::from(e)]);
            let constant = format!("({coefficient})");
            let constant = (coefficient != &super::polynomial::integer(1) || monomial.is_empty())
                .then_some(constant);
            constant.into_iter().chain(factors).collect::<Vec<_>>().join(" * ")
        };
        let terms: Vec<String> = p.terms().map(term).collect();
        if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") }
    }

    fn related(&self, p: &Polynomial, relation: &str) -> String {
        let p = self.polynomial(p);
        match relation {
            ">" => format!("0 < {p}"),
            ">=" => format!("0 <= {p}"),
            _ => format!("{p} {relation} 0"),
        }
    }

    fn fact(&self, fact: &Fact) -> String {
        self.related(&fact.polynomial, fact.sense.relation())
    }

    /// The product of facts and squares without its weight.
    fn product(&self, facts: &[Fact], term: &Term) -> String {
        let factors = term.facts.iter().map(|&f| self.polynomial(&facts[f].polynomial));
        let squares = term.squares.iter().map(|q| {
            let q = self.polynomial(q);
            format!("({q}) * ({q})")
        });
        factors.chain(squares).map(|f| format!("({f})")).collect::<Vec<_>>().join(" * ")
    }
}

/// The paths that have their first `depth` steps in common.
fn tree(branches: &[Branch<'_>], depth: usize, names: &Names, text: &mut String) {
    let (first, certificate) = branches[0];
    let indent = "  ".repeat(depth);
    match first.steps.get(depth) {
        None => match (certificate, first.verdict) {
            (Some(certificate), _) => contradiction(first, certificate, names, &indent, text),
            (None, Verdict::Fails(_)) => unreachable!("a path that fails has a certificate here"),
            (None, _) => {
                let _ = writeln!(text, "{indent}settle.");
            }
        },
        Some(Step::Inverted(p, variable)) => {
            let (p, v) = (names.polynomial(p), &names.0[*variable]);
            let _ = writeln!(
                text,
                "{indent}assert (I{depth} : ({p}) * / ({p}) = 1) by (apply Rinv_r; lra).\n\
                 {indent}first [assert (S{depth} : 0 < / ({p})) by (apply Rinv_0_lt_compat; lra) \
                 | assert (S{depth} : / ({p}) < 0) by (apply Rinv_lt_0_compat; lra)].\n\
                 {indent}remember (/ ({p})) as {v} eqn:E{depth}; clear E{depth}; other_inverses {v}."
            );
            tree(branches, depth + 1, names, text);
        }
        Some(Step::Asked(p, _)) => {
            let mut groups: Vec<&[Branch<'_>]> = Vec::new();
            let mut rest = branches;
            while let Some((head, _)) = rest.first() {
                let same = |b: &&Branch<'_>| b.0.steps.get(depth) == head.steps.get(depth);
                let (group, others) = rest.split_at(rest.iter().take_while(same).count());
                groups.push(group);
                rest = others;
            }
            let relations: Vec<String> = groups
                .iter()
                .map(|group| match &group[0].0.steps[depth] {
                    Step::Asked(p, signs) => names.related(p, signs.relation().unwrap_or("?")),
                    Step::Inverted(..) => unreachable!("one question after the same answers"),
                })
                .collect();
            let (any, p) = (relations.join(" \\/ "), names.polynomial(p));
            let pattern = vec![format!("A{depth}"); groups.len()];
            let pattern = pattern.into_iter().rev().reduce(|rest, a| format!("[{a} | {rest}]"));
            let pattern = pattern.unwrap_or_default();
            let _ = writeln!(text, "{indent}assert (A{depth} : {any}) by of_sign ({p}).");
            let _ = writeln!(text, "{indent}destruct A{depth} as {pattern}.");
            for group in groups {
                let _ = writeln!(text, "{indent}{{");
                tree(group, depth + 1, names, text);
                let _ = writeln!(text, "{indent}}}");
            }
        }
    }
}

fn contradiction(
    path: &Path,
    certificate: &Certificate,
    names: &Names,
    indent: &str,
    text: &mut String,
) {
    let mut used: Vec<usize> = certificate.terms.iter().flat_map(|t| t.facts.clone()).collect();
    used.extend(certificate.multiples.iter().map(|&(_, fact)| fact));
    used.sort_unstable();
    used.dedup();
    let _ = writeln!(text, "{indent}exfalso.");
    for &f in &used {
        let _ = writeln!(text, "{indent}assert (F{f} : {}) by lra.", names.fact(&path.facts[f]));
    }
    let kept: Vec<String> = used.iter().map(|f| format!("F{f}")).collect();
    let _ = writeln!(text, "{indent}clear - {}.", kept.join(" "));
    for (i, term) in certificate.terms.iter().enumerate() {
        if term.facts.len() + 2 * term.squares.len() < 2 {
            continue;
        }
        let strict = term.squares.is_empty()
            && term.facts.iter().all(|&f| path.facts[f].sense == Sense::Positive);
        let relation = if strict { "<" } else { "<=" };
        let product = names.product(&path.facts, term);
        let _ = writeln!(text, "{indent}assert (T{i} : 0 {relation} {product}) by product.");
    }
    for (i, (multiplier, fact)) in certificate.multiples.iter().enumerate() {
        if multiplier.as_constant().is_some() {
            continue;
        }
        let (q, p) =
            (names.polynomial(multiplier), names.polynomial(&path.facts[*fact].polynomial));
        let _ = writeln!(
            text,
            "{indent}assert (M{i} : ({q}) * ({p}) = 0) by (rewrite F{fact}; apply Rmult_0_r)."
        );
    }
    let _ = writeln!(text, "{indent}lra.");
}
