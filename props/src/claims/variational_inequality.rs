//! The variational inequality (3) and the contact conditions (2).
//!
//! By Green's formula a(u, v - u) - L(v - u) = int sigma_n(u) (v_n - u_n) for the solution u of (1), so (3) is the
//! inequality sigma_n(u) (v_n - u_n) >= 0 for v_n <= g, integrated. At a point it is equivalent to (2), given u_n <= g.

use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

/// (2) gives the integrand of (3) its sign, for every admissible v.
pub fn conditions_2_give_the_sign_of_3<S: Ordered>([u, g, s, v]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero);
    given!(v <= g);
    ensure!(s * (v - u) >= zero);
    Verdict::Holds(if s < zero { "contact" } else { "no force" })
}

/// The converse: the sign for v = u - 1 and for v = g is (2)(ii) and (iii).
pub fn the_sign_of_3_gives_conditions_2<S: Ordered>([u, g, s]: [S; 3]) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    given!(u <= g);
    given!(s * (u - one - u) >= zero && s * (g - u) >= zero);
    ensure!(s <= zero);
    ensure!(s * (u - g) == zero);
    Verdict::Holds(if s < zero { "contact" } else { "no force" })
}

/// Without (2)(iii).
pub fn control_sign_of_3_without_complementarity<S: Ordered>([u, g, s, v]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && v <= g);
    ensure!(s * (v - u) >= zero);
    Verdict::Holds("always")
}

/// For every v, admissible or not.
pub fn control_sign_of_3_for_every_v<S: Ordered>([u, g, s, v]: [S; 4]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero);
    ensure!(s * (v - u) >= zero);
    Verdict::Holds("always")
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::Claim;
    use crate::claims::lemma_3_1::inequality_3_at_affine_solutions;

    /// The row of (3).
    pub fn claim() -> Claim {
        Claim {
            id: "16",
            title: "The variational inequality",
            paper: "",
            limits: "",
            checks: [
                statements! {
                    proved + tested conditions_2_give_the_sign_of_3[u_n, g, sigma_n, v_n]: "contact", "no force"
                        about "(3)";
                    proved + tested the_sign_of_3_gives_conditions_2[u_n, g, sigma_n]: "contact", "no force"
                        about "(3)";
                    refuted control_sign_of_3_without_complementarity[u_n, g, sigma_n, v_n]
                        fails "s * (v - u) >= zero";
                    refuted control_sign_of_3_for_every_v[u_n, g, sigma_n, v_n] fails "s * (v - u) >= zero";
                },
                vec![
                    exact!("inequality_3_holds_at_affine_solutions_on_random_bodies", in lemma_3_1::inequality_3, draws 60 => inequality_3_at_affine_solutions()).about(&["(3)", "K"]),
                ],
            ]
            .concat(),
        }
    }
}
