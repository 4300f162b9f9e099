//! The items of the paper in its order. A check names those that it is about ([`Check::items`](crate::claim::Check::items)); only
//! these checks stand behind an item.

use crate::claim::{Check, Claim};

/// A numbered item of the paper.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Its number, or a name for what the paper has not.
    pub name: &'static str,
    /// What it says, in a few words.
    pub says: &'static str,
    /// The lines of the program that it is about.
    pub code: &'static [Place],
    /// What is not checked, or taken from the literature; empty where that is nothing.
    pub missing: &'static str,
}

/// A place in the sources: a file, and the text with which a line of it begins.
pub type Place = (&'static str, &'static str);

const fn item(
    name: &'static str,
    says: &'static str,
    code: &'static [Place],
    missing: &'static str,
) -> Item {
    Item { name, says, code, missing }
}

const POSITIVE_PART: Place = ("src/kernel/positive_part.rs", "pub fn positive_part<");
const PRESSURE: Place = ("src/kernel/contact.rs", "pub fn pressure(&self)");
const P: Place = ("src/kernel/contact.rs", "pub fn p(&self)");
const P0: Place = ("src/kernel/contact.rs", "pub fn p0(&self)");
const EDGE: Place = ("src/kernel/contact_edge.rs", "pub fn new<");
const STRESSES: Place = ("src/kernel/contact_edge.rs", "pub fn stress_product(");
const COERCIVITY: Place = ("src/kernel/contact_edge.rs", "pub fn coercivity_constant<");
const STIFFNESS: Place = ("src/kernel/material.rs", "pub fn normal_stiffness<");
const INTEGRALS: Place = ("src/kernel/edge_integral.rs", "pub trait ExactEdge<");
const RESIDUAL: Place = ("src/contact/discretization.rs", "pub fn residual(");

/// All of them.
#[rustfmt::skip]
pub const ITEMS: &[Item] = &[
    item("(1)", "equilibrium, Hooke's law with a tensor A, boundary conditions",
        &[("src/kernel/material.rs", "pub fn stress<")],
        "Green's formula for fields that are not affine (row 8 has it inside the residual, for a piecewise polynomial one); the boundary conditions away from Gamma_C, but on bodies with affine fields"),
    item("(2)", "the contact conditions", &[("src/kernel/contact.rs", "pub fn violation(")],
        "(iv), no shear, but for the solutions of row 8: it is natural in (8)"),
    item("V", "displacements in H^1 that vanish on Gamma_D", &[],
        "that V is complete: taken from analysis"),
    item("K", "the cone v_n <= 0 in V", &[],
        "for the shape functions of P1 and their opposites"),
    item("L", "the loads", &[("src/model/loads.rs", "pub fn assemble(")],
        "that L is continuous: taken from analysis; loads of degree above 2 but by `tests/suite/properties/places.rs`"),
    item("V^h", "piecewise polynomials of degree 1 or 2", &[("src/kernel/element.rs", "pub trait Element<")],
        "that they are continuous: triangles share their nodes (`src/model/space.rs`)"),
    item("(3)", "the variational inequality", &[],
        "that it has one solution (Stampacchia); that it is (1)-(2) for all v in K: at a point, and for the shape functions of P1 at affine solutions"),
    item("(4)", "a <= [a]+, a [a]+ = [a]+^2", &[POSITIVE_PART], ""),
    item("Proposition 2.1", "(2)(i)-(iii) are equivalent to (5)", &[PRESSURE],
        "that the traces u_n and sigma_n exist: it is about the numbers at a point"),
    item("(5)", "sigma_n = -(1/gamma)[u_n - gamma sigma_n]+", &[PRESSURE], "it is about the numbers at a point"),
    item("Remark 2.2", "gamma may be a function", &[PRESSURE],
        "that gamma is measurable: in the code it is constant on each edge"),
    item("(6)", "Nitsche's form of Green's formula", &[P0], "Green's formula for fields that are not affine"),
    item("(7)", "gamma = gamma0 h_T", &[("src/contact/contact_line.rs", "pub fn gamma0(")],
        "meshes of more than eight triangles"),
    item("Remark 2.3", "(8) holds formally for the exact solution", &[], "the regularity that the formula asks for"),
    item("(8)", "the method", &[RESIDUAL, INTEGRALS],
        "loads and gaps of degree above 2; P2 with exact contact integrals, but in doubles (`props/tests/program/assembled.rs`); meshes of more than eight triangles, but by comparison with other programs"),
    item("P_gamma, A_gamma", "v_n - gamma sigma_n(v); a(u, v) - int gamma sigma_n(u) sigma_n(v)", &[P, EDGE, STRESSES],
        "the solver's own, on meshes of more than eight triangles"),
    item("(9)", "lambda^h is a projection", &[PRESSURE],
        "for all mu in L^2: at a point; as an integral for drawn affine mu and P1"),
    item("(10)", "(9) with the weight gamma", &[PRESSURE],
        "that (9) and (10) for all mu are equivalent: at a point; the step to integrals is on the page (theory.md, 8) and not run"),
    item("the mixed problem", "(8) as a mixed method, after (10); sigma_n(u^h) is not lambda^h", &[PRESSURE],
        "that its solution solves (8): at a point; the step to integrals is on the page (theory.md, 8) and not run; P2 by points only"),
    item("Lemma 3.1", "consistency", &[RESIDUAL],
        "solutions other than affine ones, a curved one (isotropic A), and, by quadrature, drawn smooth ones, ends of contact and corners: for all others it is (6)"),
    item("Lemma 3.2", "A_gamma is elliptic, C independent of gamma0 and h", &[COERCIVITY],
        "Korn's inequality alpha |v|_1^2 <= a(v, v), with meas(Gamma_D) > 0: a hypothesis on every body; an A that varies inside a triangle; from an edge to any mesh it is a sum over edges: on the page (theory.md, 2.3), run on random bodies"),
    item("(11)", "|gamma^1/2 sigma_n(v^h)|^2 <= C gamma0 |v^h|_1^2", &[COERCIVITY, STIFFNESS],
        "from a(v, v) to |v|_1^2 it is the continuity of a(., .), a hypothesis; an A that varies inside a triangle; from a point to an edge and to a mesh as Lemma 3.2"),
    item("a(., .)", "it is continuous in |.|_1", &[("src/kernel/element.rs", "pub fn stiffness<")],
        "an A that is not isotropic; from a(v, v) to a(u, v) it is the Cauchy-Schwarz inequality"),
    item("Theorem 3.3", "(8) has one solution", &[POSITIVE_PART, RESIDUAL],
        "that a(., .) is positive definite on V^h, but on the meshes of row 10; that a strongly convex function on R^N has one minimiser, where its gradient vanishes: in place of Brezis, docs/theory.md, 3.2"),
    item("(12)", "B^h is strongly monotone", &[POSITIVE_PART, INTEGRALS],
        "Korn's inequality, with meas(Gamma_D) > 0; from a point to any mesh it is a sum over edges: on the page (theory.md, 3.2), run on random bodies with the definitions written out, which rows 5 and 6 compare with the solver's"),
    item("Theorem 3.4", "the abstract error estimate", &[PRESSURE, ("study/src/a_priori.rs", "pub fn plain_squared<")],
        "Green's formula for u and the Cauchy-Schwarz inequality: the proof is about the numbers that the integrals are; it is in |.|_a, for |.|_1 see (13)"),
    item("(13)", "the same in |.|_1, C independent of h and u", &[],
        "Korn's inequality, continuity of a(., .), Green's formula for u and the Cauchy-Schwarz inequality"),
    item("(14)", "ellipticity, Young, (8) and Green", &[],
        "ellipticity, continuity, Green's formula and (8), which are its hypotheses"),
    item("(15)", "u_n <= 0 is used", &[PRESSURE], "at a point, and of the terms with u_n: the sum with (14) is not run"),
    item("(16)", "Young's inequality with beta_1", &[], "at a point"),
    item("(17)", "the bound of T (with the factor gamma: errata)", &[PRESSURE], "at a point"),
    item("(18)", "Young's inequality with beta_2 (with the factor gamma: errata)", &[], "at a point"),
    item("(19)", "the second term of (17)", &[],
        "that (11) holds for w; from |.|_a to |.|_1 it is the continuity of a(., .): hypotheses"),
    item("(20)", "(18) and (19) in (17), and the last estimate", &[], "(17), (18) and (19), which are its hypotheses"),
    item("Theorem 3.5", "the rate of convergence", &[("study/src/interpolation.rs", "pub fn bound(")],
        "Korn's inequality: numbers and rates are of |.|_a; for P1, nu = 1/2, isotropic A and exact integrals the number is proved on the page (theory.md, 9.6), on c_T of (22) as quoted, and compared with errors of the solver (`tests/suite/convergence.rs`); for other nu and P2 (22)-(24) are hypotheses, and the rates are observed there on finitely many meshes"),
    item("(21)", "h^(1/2 + nu), C independent of h and u", &[],
        "as Theorem 3.5; the rate is observed at corners (nu < 1/2) by `tests/suite/convergence.rs`"),
    item("(22)-(24)", "interpolation estimates",
        &[("study/src/interpolation.rs", "pub fn gradient_constant_squared<"), ("study/src/interpolation.rs", "pub fn trace_constant_squared<")],
        "the L^2 part of (22); (22) for P1 and nu = 1/2 but on quadratics: c_T is Kobayashi's; (23) but on polynomials: Wirtinger's inequality; the trace inequality but on affine functions: it is proved on the page (theory.md, 9.6) and not run; an A that is not isotropic; 0 < nu < 1/2 is proved on the page (theory.md, 9.7) and not run; P2: Brenner and Scott; Ern and Guermond; Hild and Renard; Fritz, Hueeber and Wohlmuth"),
    item("Corollary 3.6", "the rate of the normal stress", &[("study/src/a_priori.rs", "pub fn corollary_bound<")],
        "(22) and (24): hypotheses; that sigma_n(u) is square integrable"),
    item("(25)", "|gamma^1/2 sigma_n(u - u^h)| falls at the same rate", &[],
        "(22) and (24): hypotheses; the rate is observed by `tests/suite/convergence.rs`"),
    item("Remark 3.7", "quadratic elements", &[("src/kernel/element.rs", "impl Element<6, 3> for P2")],
        "(22)-(24) for quadratic elements; the rates 3/2 and 2 are observed by `tests/suite/convergence.rs`; (25) for nu > 1/2"),
];

impl Item {
    /// The checks that are about it, controls apart, with their rows.
    pub fn found<'a>(&self, claims: &'a [Claim]) -> Vec<(&'a Claim, &'a Check)> {
        let checks = claims.iter().flat_map(|c| c.checks.iter().map(move |check| (c, check)));
        checks.filter(|(_, check)| !check.control && check.items.contains(&self.name)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims;

    #[test]
    fn an_item_has_checks_or_says_what_is_missing_and_a_check_names_items_that_exist() {
        let claims = claims::all();
        assert!(ITEMS.len() >= 40);
        for item in ITEMS {
            assert!(!item.says.is_empty(), "{item:?}");
            assert!(!item.missing.is_empty() || !item.found(&claims).is_empty(), "{}", item.name);
        }
        for check in claims.iter().flat_map(|claim| &claim.checks) {
            let known = |name: &&str| ITEMS.iter().any(|item| item.name == *name);
            assert!(check.items.iter().all(known), "{}: {:?}", check.name, check.items);
        }
    }
}
