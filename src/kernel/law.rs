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

    /// The part of a jump that is not allowed, y - prox(y): 0 if and only if psi(y) is finite.
    pub fn forbidden_jump<S: Scalar>(self, y: S) -> S {
        self.q(y)
    }

    /// The part of a stress that is not allowed: 0 if and only if psi*(-sigma) is finite.
    pub fn forbidden_stress<S: Scalar>(self, sigma: S) -> S {
        match self {
            Response::Unilateral => positive_part(sigma),
            Response::Bilateral => S::from(0),
        }
    }

    /// Fenchel's gap psi(y) + psi*(-sigma) + sigma y of an allowed jump and an allowed stress: never negative, and 0 if and only if
    /// they satisfy the law.
    pub fn fenchel_gap<S: Scalar>(self, y: S, sigma: S) -> S {
        sigma * y
    }
}
