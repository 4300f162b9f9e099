//! Two deformable bodies (theory.md, 12): the law of an interface as one equation, and one weighted flux for both sides.

use signorini::kernel::Response;

use crate::claim::Claim;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

const BOTH: [Response; 2] = [Response::Unilateral, Response::Bilateral];

/// y and -sigma satisfy the law, said by what is forbidden and by Fenchel's gap.
fn is_law<S: Ordered>(law: Response, y: S, sigma: S) -> bool {
    let zero = S::from(0);
    law.forbidden_jump(y) == zero
        && law.forbidden_stress(sigma) == zero
        && law.fenchel_gap(y, sigma) == zero
}

/// Whether gamma sigma = -q(y - gamma sigma), for a candidate of q.
fn is_equation<S: Ordered>([y, sigma, gamma]: [S; 3], q: impl Fn(S) -> S) -> bool {
    gamma * sigma == -q(y - gamma * sigma)
}

/// What satisfies the law satisfies the equation.
pub fn a_law_gives_the_one_equation<S: Ordered>([y, sigma, gamma]: [S; 3]) -> Verdict {
    given!(gamma > S::from(0));
    for law in BOTH {
        if is_law(law, y, sigma) {
            ensure!(is_equation([y, sigma, gamma], |p| law.q(p)));
        }
    }
    Verdict::Holds("always")
}

/// And what satisfies the equation satisfies the law.
pub fn the_one_equation_gives_the_law<S: Ordered>([y, sigma, gamma]: [S; 3]) -> Verdict {
    given!(gamma > S::from(0));
    for law in BOTH {
        if is_equation([y, sigma, gamma], |p| law.q(p)) {
            ensure!(is_law(law, y, sigma));
        }
    }
    Verdict::Holds("always")
}

/// With q(p) = p for contact, a stress that pulls.
pub fn control_bodies_in_contact_pull<S: Ordered>([y, sigma, gamma]: [S; 3]) -> Verdict {
    given!(gamma > S::from(0) && is_equation([y, sigma, gamma], |p| p));
    ensure!(is_law(Response::Unilateral, y, sigma));
    Verdict::Holds("always")
}

/// (q(a) - q(b))^2 <= (q(a) - q(b)) (a - b): of q the theory of method (8) uses nothing else.
pub fn q_of_every_law_is_firmly_nonexpansive<S: Ordered>([a, b]: [S; 2]) -> Verdict {
    for law in BOTH {
        let difference = law.q(a) - law.q(b);
        ensure!(difference * difference <= difference * (a - b));
    }
    Verdict::Holds("always")
}

/// The gap psi(y) + psi*(-sigma) + sigma y is not negative.
pub fn the_gap_of_fenchel_is_not_negative<S: Ordered>([y, sigma]: [S; 2]) -> Verdict {
    let zero = S::from(0);
    for law in BOTH {
        if law.forbidden_jump(y) == zero && law.forbidden_stress(sigma) == zero {
            ensure!(law.fenchel_gap(y, sigma) >= zero);
        }
    }
    Verdict::Holds("always")
}

/// \[C\] at a point: u with sigma satisfies the law; y and tau are allowed. G - A - B = (sigma - tau) (j(u) - j(v)), all three >= 0.
pub fn identity_c_holds_at_a_point<S: Ordered>([y_u, y_v, sigma, tau]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    for law in BOTH {
        let is_allowed = law.forbidden_jump(y_v) == zero && law.forbidden_stress(tau) == zero;
        if is_law(law, y_u, sigma) && is_allowed {
            let [g, a, b] =
                [law.fenchel_gap(y_v, tau), law.fenchel_gap(y_v, sigma), law.fenchel_gap(y_u, tau)];
            ensure!(g - a - b == (sigma - tau) * (y_u - y_v));
            ensure!(g >= zero && a >= zero && b >= zero);
        }
    }
    Verdict::Holds("always")
}

/// Without the law of u, the term sigma y(u) is left.
pub fn control_identity_c_without_the_law_of_the_solution<S: Ordered>(
    [y_u, y_v, sigma, tau]: [S; 4],
) -> Verdict {
    let law = Response::Bilateral;
    let [g, a, b] =
        [law.fenchel_gap(y_v, tau), law.fenchel_gap(y_v, sigma), law.fenchel_gap(y_u, tau)];
    ensure!(g - a - b == (sigma - tau) * (y_u - y_v));
    Verdict::Holds("always")
}

/// Gamma s^2 <= gamma_1 s_1^2 + gamma_2 s_2^2 for a mean s of s_1 and s_2, both sides times Gamma = gamma_1 + gamma_2; `flux` is Gamma s.
fn mean_flux<S: Ordered>([gamma_1, gamma_2, s_1, s_2]: [S; 4], flux: S) -> Verdict {
    let squares = gamma_1 * s_1 * s_1 + gamma_2 * s_2 * s_2;
    ensure!(flux * flux <= (gamma_1 + gamma_2) * squares);
    Verdict::Holds("always")
}

/// The mean with the weights gamma_i / Gamma: what is left is gamma_1 gamma_2 (s_1 - s_2)^2.
pub fn one_weighted_flux_costs_no_more_than_that_of_each_body<S: Ordered>(v: [S; 4]) -> Verdict {
    let ([gamma_1, gamma_2, s_1, s_2], zero) = (v, S::from(0));
    given!(gamma_1 > zero && gamma_2 > zero);
    let (both, apart) = (gamma_1 * gamma_2, s_1 - s_2);
    ensure!(both > zero);
    ensure!(apart * apart >= zero);
    ensure!(both * (apart * apart) >= zero);
    mean_flux(v, gamma_1 * s_1 + gamma_2 * s_2)
}

/// The mean with equal weights.
pub fn control_equal_weights_for_unequal_bodies<S: Ordered>(v: [S; 4]) -> Verdict {
    let [gamma_1, gamma_2, s_1, s_2] = v;
    given!(gamma_1 > S::from(0) && gamma_2 > S::from(0));
    mean_flux(v, (gamma_1 + gamma_2) * (s_1 + s_2) / S::from(2))
}

/// d . (r(x) - r(y)) for the rigid motion r(x) = a + w (-x_2, x_1).
fn jump_of_motion<S: Ordered>([x, y, d, a]: [[S; 2]; 4], w: S) -> S {
    let moved = |x: [S; 2]| [a[0] - w * x[1], a[1] + w * x[0]];
    let [of_x, of_y] = [moved(x), moved(y)];
    d[0] * (of_x[0] - of_y[0]) + d[1] * (of_x[1] - of_y[1])
}

/// Points that differ by a multiple of d do not move against each other along d.
pub fn a_rigid_motion_opens_no_central_pair<S: Ordered>(
    [x, y, d_x, d_y, gap, a, b, w]: [S; 8],
) -> Verdict {
    let other = [x + gap * d_x, y + gap * d_y];
    ensure!(jump_of_motion([[x, y], other, [d_x, d_y], [a, b]], w) == S::from(0));
    Verdict::Holds("always")
}

/// Points that do not.
pub fn control_a_rigid_motion_opens_no_pair_at_all<S: Ordered>(
    [x, y, d_x, d_y, gap, a, b, w]: [S; 8],
) -> Verdict {
    let other = [x + gap * d_x, y];
    let zero = S::from(0);
    ensure!(jump_of_motion([[x, y], other, [d_x, d_y], [a, b]], w) == zero);
    Verdict::Holds("always")
}

/// The row of pairs.
pub fn claim() -> Claim {
    Claim {
        id: "17",
        title: "Two deformable bodies",
        paper: "\"The extension to two elastic bodies in contact can be easily made, at least for small strain models\": (8) with the jump of the displacements and one weighted stress of both sides (theory.md, 12).",
        limits: "On curved interfaces the pieces are those of the mesh, with directions and gaps as they are found. On meshes that do not match: `tests/suite/pairs/balance.rs`, forces and moments that cancel, and (11) for all fields, by eigenvalues.",
        single: None,
        checks: statements! {
            proved + tested a_law_gives_the_one_equation[y, sigma, gamma];
            proved + tested the_one_equation_gives_the_law[y, sigma, gamma];
            proved + tested q_of_every_law_is_firmly_nonexpansive[a, b];
            proved + tested the_gap_of_fenchel_is_not_negative[y, sigma];
            proved + tested identity_c_holds_at_a_point[y_u, y_v, sigma, tau];
            proved + tested one_weighted_flux_costs_no_more_than_that_of_each_body[gamma_1, gamma_2, s_1, s_2];
            proved + tested a_rigid_motion_opens_no_central_pair[x, y, d_x, d_y, gap, a, b, w];
            refuted control_bodies_in_contact_pull[y, sigma, gamma]
                fails "is_law(Response::Unilateral, y, sigma)";
            refuted control_identity_c_without_the_law_of_the_solution[y_u, y_v, sigma, tau]
                fails "g - a - b == (sigma - tau) * (y_u - y_v)";
            refuted control_equal_weights_for_unequal_bodies[gamma_1, gamma_2, s_1, s_2]
                fails "flux * flux <= (gamma_1 + gamma_2) * squares";
            refuted control_a_rigid_motion_opens_no_pair_at_all[x, y, d_x, d_y, gap, a, b, w]
                fails "jump_of_motion([[x, y], other, [d_x, d_y], [a, b]], w) == zero";
        },
    }
}
