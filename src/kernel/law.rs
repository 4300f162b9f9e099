//! The law of an interface for one component at a point: a closed convex function psi of the jump y = j - g, 0 where y is allowed
//! and infinite elsewhere, with -sigma in the subdifferential of psi at y.
//!
//! With q(p) = p - prox(p), prox being the allowed jump that is nearest to p, the law is the one equation
//! sigma = -(1/gamma) q(y - gamma sigma): for contact that is equation (5). q is monotone and firmly nonexpansive,
//! (q(a) - q(b))^2 <= (q(a) - q(b)) (a - b), and of q nothing else is used in the theory of method (8).
//!
//! | | allowed jumps | q(p) | allowed stresses |
//! | --- | --- | --- | --- |
//! | unilateral | y <= 0 | \[p\]+ | sigma <= 0 |
//! | bilateral | y = 0 | p | all |

use super::{Scalar, positive_part};

/// The answer of an interface to one component of the jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Contact: pushes, and lets go.
    Unilateral,
    /// No jump: pushes and pulls.
    Bilateral,
}

impl Response {
    /// q(p) = p - prox(p)
    pub fn q<S: Scalar>(self, p: S) -> S {
        match self {
            Response::Unilateral => positive_part(p),
            Response::Bilateral => p,
        }
    }
}
