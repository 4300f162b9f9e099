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

/// What an interface answers to one component of the jump.
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

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [Response; 2] = [Response::Unilateral, Response::Bilateral];

    /// Small numbers, so that products are exact.
    fn numbers() -> impl Iterator<Item = f64> + Clone {
        (-8..=8).map(|i| f64::from(i) / 4.0)
    }

    /// The law itself, jump and stress allowed and without a gap, against the equation with gamma = 1/2.
    fn equation_is_law(response: Response, q: impl Fn(f64) -> f64) -> bool {
        numbers().all(|y| {
            numbers().all(|sigma| {
                let allowed =
                    response.forbidden_jump(y) == 0.0 && response.forbidden_stress(sigma) == 0.0;
                let law = allowed && response.fenchel_gap(y, sigma) == 0.0;
                law == (sigma == -2.0 * q(y - sigma / 2.0))
            })
        })
    }

    #[test]
    fn the_equation_says_the_law_and_another_q_does_not() {
        for response in BOTH {
            assert!(equation_is_law(response, |p| response.q(p)), "{response:?}");
            assert!(!equation_is_law(response, |p| 2.0 * response.q(p)), "{response:?}");
        }
        assert!(!equation_is_law(Response::Unilateral, |p| Response::Bilateral.q(p)));
    }

    #[test]
    fn q_is_firmly_nonexpansive_and_twice_q_is_not() {
        let firm = |q: &dyn Fn(f64) -> f64| {
            numbers().all(|a| {
                numbers().all(|b| {
                    let d = q(a) - q(b);
                    d * d <= d * (a - b)
                })
            })
        };
        for response in BOTH {
            assert!(firm(&|p| response.q(p)), "{response:?}");
            assert!(!firm(&|p| 2.0 * response.q(p)), "{response:?}");
        }
    }

    #[test]
    fn the_gap_of_what_is_allowed_is_not_negative() {
        for response in BOTH {
            for y in numbers().filter(|&y| response.forbidden_jump(y) == 0.0) {
                for sigma in numbers().filter(|&s| response.forbidden_stress(s) == 0.0) {
                    assert!(response.fenchel_gap(y, sigma) >= 0.0, "{response:?} {y} {sigma}");
                }
            }
        }
    }
}
