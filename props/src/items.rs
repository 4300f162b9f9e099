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
    /// The lines that its checks call.
    pub code: &'static [Place],
    /// Lines of the program that it is about, which none of its checks calls.
    pub uncalled: &'static [Place],
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
    Item { name, says, code, uncalled: &[], missing }
}

impl Item {
    const fn beside(self, uncalled: &'static [Place]) -> Item {
        Item { uncalled, ..self }
    }
}

const POSITIVE_PART: Place = ("src/kernel/positive_part.rs", "pub fn positive_part<");
const PRESSURE: Place = ("src/kernel/contact.rs", "pub fn pressure(&self)");
const P: Place = ("src/kernel/contact.rs", "pub fn p(&self)");
const P0: Place = ("src/kernel/contact.rs", "pub fn p0(&self)");
const STRESS: Place = ("src/kernel/material.rs", "pub fn stress<");
const INTEGRALS: Place = ("src/kernel/edge_integral.rs", "fn exact_with(p: [S; 2]");
const GAUSS: Place = ("src/kernel/edge_integral.rs", "pub fn gauss<");
const PIECE_P: Place = ("src/contact/piece.rs", "pub fn p(");
const PIECE_P0: Place = ("src/contact/piece.rs", "pub fn p0(");
const FORCES: Place = ("src/contact/residual.rs", "pub fn add_internal_forces<");
const PRODUCT: Place = ("src/contact/piece.rs", "pub fn add_stresses(");
const RESIDUAL: Place = ("src/contact/discretization.rs", "pub fn residual(");
const LINEAR: Place = ("src/contact/residual.rs", "pub fn linear_residual<");
const REACTIONS: Place = ("props/src/discrete.rs", "pub fn reactions(");
const B: Place = ("props/src/bodies/definition.rs", "pub fn b(");
const A: Place = ("props/src/bodies/definition.rs", "pub fn a(");
const BIG_A: Place = ("props/src/bodies/definition.rs", "pub fn big_a(");
const TRACES: Place = ("props/src/bodies/definition.rs", "pub fn traces(");
const CONTACT: Place = ("props/src/bodies/definition.rs", "pub fn contact_on(");
const MATRICES: Place = ("props/src/bodies/definition.rs", "pub fn matrices_on(");
const DEFINED_PART: Place = ("props/src/naive.rs", "pub fn positive_part_times(");
const BOUND: Place = ("study/src/interpolation.rs", "pub fn bound(");
const COROLLARY: Place = ("study/src/a_priori.rs", "pub fn corollary_bound<");
const BODIES: Place = ("props/src/bodies.rs", "pub fn bodies(");
const PROBLEMS: Place = ("props/src/claims/assembled/draw.rs", "pub(crate) fn problems(");
const SOLVED: Place = ("props/src/claims/one_solution.rs", "pub fn problems(");
const AFFINE: Place = ("props/src/claims/lemma_3_1.rs", "fn affine_solution(");
const CURVED: Place = ("props/src/claims/curved.rs", "fn curved_bodies(");
const SAMPLES: Place = ("props/src/claims/known.rs", "pub(super) fn samples(");
const TRAPEZOID: Place = ("props/src/sharpness.rs", "pub fn trapezoid(");
const ONE_TRIANGLE: Place = ("props/src/claims/theorem_3_3.rs", "pub fn one_triangle<");
const TRIANGLES: Place = ("props/src/claims/interpolation.rs", "fn draws_of(");
const POINT: Place = ("props/src/claims/prop_2_1.rs", "fn point<");
const POINT_AND_MU: Place = ("props/src/claims/mixed.rs", "fn point<");
const THREE_POINTS: Place = ("props/src/claims/theorem_3_4.rs", "fn point<");

/// The bodies, problems and points on which checks run.
#[rustfmt::skip]
pub const ON: &[Place] = &[BODIES, PROBLEMS, SOLVED, AFFINE, CURVED, SAMPLES, TRAPEZOID, ONE_TRIANGLE, TRIANGLES, POINT, POINT_AND_MU, THREE_POINTS];

/// Lines of which an item has those that its checks call, and no other.
#[cfg(test)]
pub const KERNEL: &[Place] =
    &[POSITIVE_PART, PRESSURE, P, P0, LINEAR, FORCES, PRODUCT, PIECE_P0, INTEGRALS, GAUSS];

/// All of them.
#[rustfmt::skip]
pub const ITEMS: &[Item] = &[
    item("(1)", "equilibrium, Hooke's law with a tensor A, boundary conditions", &[STRESS, A, BODIES, AFFINE],
        "H2; f; the boundary conditions away from Gamma_C, but on bodies with affine fields"),
    item("(2)", "the contact conditions", &[("src/kernel/contact.rs", "pub fn violation("), PRESSURE, P, P0, POSITIVE_PART, POINT],
        "(iv), no shear, for which (8) has no term, but for the solutions of row 8"),
    item("V", "displacements in H^1 that vanish on Gamma_D", &[], "that V is complete")
        .beside(&[("src/model/constraints.rs", "pub struct Constraints")]),
    item("K", "the cone v_n <= 0 in V", &[A, BODIES, AFFINE], "as (3)")
        .beside(&[("src/audit/balanced.rs", "pub fn penetrations(")]),
    item("L", "the loads", &[("src/model/loads.rs", "pub(crate) fn assemble_twice("), ("props/src/claims/assembled/definition.rs", "pub(crate) fn load<"), PROBLEMS],
        "that L is continuous; loads of degree above 2, but by `tests/suite/properties/places.rs`"),
    item("V^h", "piecewise polynomials of degree 1 or 2", &[("src/kernel/element.rs", "fn values<")],
        "continuity: triangles share their nodes")
        .beside(&[("src/model/space.rs", "pub struct Space")]),
    item("(3)", "find u in K with a(u, v - u) >= L(v - u) for all v in K", &[A, BODIES, AFFINE],
        "that it has one solution (Stampacchia); that it is (1)-(2): H2, H5; (3) itself, but for affine u and v - u a shape function of P1 or its opposite"),
    item("(4)", "a <= [a]+, a [a]+ = [a]+^2", &[POSITIVE_PART], ""),
    item("Proposition 2.1", "with gamma > 0, (2)(i)-(iii) on Gamma_C are equivalent to (5)", &[PRESSURE, P, P0, POSITIVE_PART, POINT], "H6"),
    item("(5)", "sigma_n = -(1/gamma)[u_n - gamma sigma_n]+", &[PRESSURE, P, P0, POSITIVE_PART, POINT], "H6"),
    item("Remark 2.2", "gamma may be a positive function on Gamma_C", &[PRESSURE, P, P0, POSITIVE_PART, POINT],
        "that gamma is measurable: it is constant on each edge"),
    item("(6)", "a(u, v) - int gamma sigma_n(u) sigma_n(v) + int (1/gamma)[P(u)]+ P0(v) = L(v), from a(u, v) - int sigma_n(u) v_n = L(v) and (5)", &[PRESSURE, P, P0, POSITIVE_PART, B, BIG_A, CONTACT, BODIES, AFFINE], "H2, H5, H6"),
    item("(7)", "gamma(x) = gamma0 h_T for x in T", &[("src/contact/contact_line.rs", "let gamma = gamma0(t) * mesh.diameter(t);"), PROBLEMS],
        "meshes of more than eight triangles"),
    item("Remark 2.3", "(8) holds formally for u", &[PRESSURE, P, P0, POSITIVE_PART], "H2, H5, H6"),
    item("(8)", "the method: A_gamma(u^h, v^h) + int (1/gamma)[P(u^h)]+ P0(v^h) = L(v^h) for all v^h in V^h", &[LINEAR, FORCES, PRODUCT, PIECE_P, PIECE_P0, INTEGRALS, GAUSS, POSITIVE_PART, REACTIONS, BIG_A, CONTACT, TRACES, DEFINED_PART, BODIES, PROBLEMS],
        "loads and gaps of degree above 2; P2 without quadrature error, but in doubles (`assembled.rs`, `edges.rs` in `props/tests/program`); meshes of more than eight triangles, but beside other programs. The first exact check has n = (5/13, -12/13), the solver's doubles for |E|, h_T, the gap (within 1e-9) and lambda of plane stress, the sum of contact terms of `reactions`")
        .beside(&[RESIDUAL]),
    item("P_gamma, A_gamma", "v_n - gamma sigma_n(v); a(u, v) - int gamma sigma_n(u) sigma_n(v)", &[P, P0, PRESSURE, POSITIVE_PART, ("src/kernel/contact_edge.rs", "pub fn new<"), ("src/kernel/contact_edge.rs", "pub fn stress_product("), LINEAR, FORCES, PRODUCT, PIECE_P, PIECE_P0, INTEGRALS, GAUSS, BIG_A, TRACES, POINT, PROBLEMS],
        "as (7)"),
    item("(9)", "lambda^h is the L^2-projection of -(1/gamma)P(u^h) on the nonpositive mu", &[PRESSURE, P, P0, POSITIVE_PART, B, TRACES, BODIES, POINT_AND_MU],
        "H5, but for affine mu and P1"),
    item("(10)", "(9) with the weight gamma", &[PRESSURE, P, P0, POSITIVE_PART, B, TRACES, BODIES, POINT_AND_MU], "H5, but for affine mu and P1"),
    item("the mixed problem", "(8) is a mixed method with stabilisation; sigma_n(u^h) is not lambda^h", &[PRESSURE, P, P0, POSITIVE_PART, INTEGRALS, B, TRACES, BODIES, POINT_AND_MU, ONE_TRIANGLE],
        "H5, but for P1, and for P2 by the points of a rule"),
    item("Lemma 3.1", "consistency: the solution u of (1)-(2), in H^(3/2 + nu) with nu > 0, is one of (8)", &[LINEAR, FORCES, PRODUCT, PIECE_P, PIECE_P0, INTEGRALS, GAUSS, P, P0, POSITIVE_PART, B, BIG_A, CONTACT, TRACES, BODIES, PROBLEMS, AFFINE, CURVED, SAMPLES],
        "H2, H5, H6; solutions other than affine ones and, for isotropic A, a curved one and, by quadrature up to 1e-4, drawn smooth ones, ends of contact and corners: for others it is (6), or `tests/suite/tensor.rs`")
        .beside(&[RESIDUAL]),
    item("Lemma 3.2", "A_gamma is elliptic on V^h for small gamma0, C independent of gamma0 and h", &[("src/kernel/contact_edge.rs", "pub fn coercivity_constant<"), ("src/kernel/material.rs", "pub fn normal_stiffness<"), MATRICES, BODIES],
        "H1, H5; an A that varies inside a triangle"),
    item("(11)", "|gamma^1/2 sigma_n(v^h)|^2 <= C gamma0 |v^h|_1^2", &[("src/kernel/contact_edge.rs", "pub fn coercivity_constant<"), ("src/kernel/material.rs", "pub fn normal_stiffness<"), MATRICES, ("props/src/bodies/definition.rs", "pub fn a_on("), ("props/src/bodies/definition.rs", "fn stresses_on("), BODIES],
        "H3, H5; an elliptic A is assumed; `lemma_3_2_holds_with_constants_without_h` starts from (11) in |.|_a; an A that varies inside a triangle"),
    item("a(., .)", "it is continuous in |.|_1", &[STRESS, POSITIVE_PART],
        "H4; an A that is not isotropic")
        .beside(&[("src/kernel/element.rs", "pub fn stiffness<")]),
    item("Theorem 3.3", "(8) has one solution for small gamma0", &[POSITIVE_PART, LINEAR, FORCES, PRODUCT, PIECE_P, PIECE_P0, INTEGRALS, GAUSS, REACTIONS, B, BODIES, SOLVED],
        "(11), H5; P1 with a cut edge (6 draws), whose solution is irrational: an iterate of Newton's method is taken for it (the solver's u~ is within 2^-40 |u~|_a of either); that a(., .) is positive definite on V^h, but on the meshes of row 10; that a strongly convex function on R^N has one minimiser: in place of Brezis (`docs/theory.md`, 3.2)"),
    item("(12)", "B^h is strongly monotone", &[LINEAR, FORCES, PRODUCT, PIECE_P, PIECE_P0, INTEGRALS, GAUSS, POSITIVE_PART, B, A, BIG_A, CONTACT, DEFINED_PART, REACTIONS, BODIES, PROBLEMS, TRAPEZOID],
        "H1, (11), H5; bodies (P2 by a rule of two points) take the definitions, which the first exact check compares with the loops; attained to 1 % for v^h = 0, no contact"),
    item("Theorem 3.4", "for small gamma0, |u - u^h|_1 + |gamma^1/2 (sigma_n(u) + [P(u^h)]+/gamma)| <= C inf over v^h of (|u - v^h|_1 + |gamma^-1/2 (u_n - v_n^h)| + |gamma^1/2 sigma_n(u - v^h)|)", &[PRESSURE, P, P0, POSITIVE_PART, THREE_POINTS],
        "(8), (11), H2, H4, H5, H6; the printed form, but by (13): proof and Rocq have [9.1] of `docs/theory.md`, squared, in |.|_a, with P0(u - v^h) for u_n - v_n^h, from [9.4]")
        .beside(&[("study/src/a_priori.rs", "pub fn plain_squared<"), ("props/tests/program/a_priori.rs", "pub fn plain_bound_is_that_of_theorem_3_4<")]),
    item("(13)", "Theorem 3.4 with C independent of h and u", &[],
        "H1, H3, H4 and all of Theorem 3.4; squared: roots of sums and the infimum are not run"),
    item("(14)", "ellipticity, Young, (8) and Green", &[P, P0, POSITIVE_PART, THREE_POINTS],
        "H1, H2, H3, (8), and H5 for its last step"),
    item("(15)", "u_n <= 0 is used", &[P, P0, POSITIVE_PART, THREE_POINTS], "H5; the sum of these terms with (14)"),
    item("(16)", "Young's inequality with beta_1", &[], "H5"),
    item("(17)", "the bound of T (errata)", &[PRESSURE, P, P0, POSITIVE_PART, THREE_POINTS], "H5"),
    item("(18)", "Young's inequality with beta_2 (errata)", &[], "H5"),
    item("(19)", "the second term of (17)", &[],
        "(11) for v^h - u^h, H3, H4"),
    item("(20)", "(18) and (19) in (17), and the last estimate", &[],
        "(15) to (19) as integrals: H5"),
    item("Theorem 3.5", "the rate of convergence", &[],
        "H1, H3, (13) squared, (22)-(24); a bound with numbers for P1, nu = 1/2, isotropic A and exact integrals is on paper (`docs/theory.md`, 9.6; c_T as quoted), tested beside errors, as are the rates (`tests/suite/convergence.rs`)")
        .beside(&[BOUND]),
    item("(21)", "h^(1/2 + nu), C independent of h and u", &[],
        "as Theorem 3.5; rates at corners (nu < 1/2) are observed there, too")
        .beside(&[BOUND]),
    item("(22)-(24)", "interpolation estimates",
        &[("study/src/interpolation.rs", "pub fn gradient_constant_squared<"), ("study/src/interpolation.rs", "pub fn trace_constant_squared<"), STRESS, POSITIVE_PART, TRIANGLES],
        "the L^2 part of (22); for P1 (22) but on quadratics (c_T is Kobayashi's), (23) but on polynomials (Wirtinger's inequality), the trace inequality but on affine functions, nu < 1/2 (both on paper: `docs/theory.md`, 9.6, 9.7); an A that is not isotropic; P2 (literature)"),
    item("Corollary 3.6", "the rate of the normal stress", &[],
        "(11), (21), (22), (24), H4, H6")
        .beside(&[COROLLARY, ("props/tests/program/a_priori.rs", "pub fn corollary_bound_is_that_of_corollary_3_6<")]),
    item("(25)", "|gamma^1/2 sigma_n(u - u^h)| falls at the same rate, C independent of h and u", &[],
        "Corollary 3.6, (21), (22), (24); the rate is observed by `tests/suite/convergence.rs`")
        .beside(&[COROLLARY]),
    item("Remark 3.7", "quadratic elements", &[("src/kernel/element.rs", "const TRACE_CONSTANT: i32 = 3;"), MATRICES, BODIES],
        "as Theorem 3.4, H3; (22)-(24) for quadratic elements, and (25) for nu > 1/2; the rates 3/2 and 2 are observed by `tests/suite/convergence.rs`"),
];

impl Item {
    /// The checks that are about it, controls apart, with their rows.
    pub fn found<'a>(&self, claims: &'a [Claim]) -> Vec<(&'a Claim, &'a Check)> {
        let checks = claims.iter().flat_map(|c| c.checks.iter().map(move |check| (c, check)));
        checks.filter(|(_, check)| !check.control && check.items.contains(&self.name)).collect()
    }
}
