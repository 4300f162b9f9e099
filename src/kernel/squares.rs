//! The energy of a strain and of a stress as sums of three squares with positive factors, for any law A of (1).
//!
//! With the components (xx + yy, xx - yy, 2 xy) of a stress s and of a strain e, sigma:eps = s . e / 2, and the law is s = 2 B e
//! with B symmetric. B = L D L^T, L unit lower triangular, D = diag(K, M, G), so that
//!
//! sigma:eps = K p_0^2 + M p_1^2 + G p_2^2 for p = L^T e,
//! tau : C^-1 tau = (p_0^2/K + p_1^2/M + p_2^2/G) / 4 for p = L^-1 s.
//!
//! A is elliptic if and only if K, M and G are positive. Where A is isotropic, L = I, K = lambda + mu, M = G = mu: nothing cancels
//! near incompressibility, and so it is with tensors, whose largest entry comes first then.

use super::{Scalar, Stress};

/// K, M, G and L of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Squares<S> {
    /// K
    pub bulk: S,
    /// M
    pub shear: S,
    /// G and the entries (1, 0), (2, 0), (2, 1) of L; `None` where G = M and L = I.
    pub beyond: Option<(S, [S; 3])>,
}

impl<S: Scalar> Squares<S> {
    /// The squares of an isotropic law.
    pub(crate) fn isotropic(lambda: S, mu: S) -> Self {
        Squares { bulk: lambda + mu, shear: mu, beyond: None }
    }

    /// The squares of a law with the entries C11, C12, C16, C22, C26, C66.
    pub(crate) fn of_tensor([xx, xy, xz, yy, yz, zz]: [S; 6]) -> Self {
        let (two, four) = (S::from(2), S::from(4));
        let twice = xy + xy;
        let bulk = (xx + yy + twice) / four;
        let across = [(xx - yy) / four, (xz + yz) / two];
        let l = across.map(|entry| entry / bulk);
        let shear = (xx + yy - twice) / four - l[0] * across[0];
        let mixed = (xz - yz) / two - l[0] * across[1];
        let last = mixed / shear;
        let other = zz - l[1] * across[1] - last * mixed;
        Squares { bulk, shear, beyond: Some((other, [l[0], l[1], last])) }
    }

    /// p_1, p_2 and p_0 of a stress.
    pub fn parts(&self, tau: Stress<S>) -> [S; 3] {
        let [xx, yy, xy] = tau.components();
        let (sphere, deviator, shear) = (xx + yy, xx - yy, xy + xy);
        match self.beyond {
            None => [deviator, shear, sphere],
            Some((_, [a, b, c])) => {
                let deviator = deviator - a * sphere;
                [deviator, shear - b * sphere - c * deviator, sphere]
            }
        }
    }

    /// The products of two stresses, linear in both: p_1 q_1 + (M/G) p_2 q_2, and p_0 q_0.
    #[inline]
    pub fn products(&self, a: Stress<S>, b: Stress<S>) -> [S; 2] {
        let (a, b) = (self.parts(a), self.parts(b));
        let second = a[1] * b[1];
        let second = match self.beyond {
            None => second,
            Some((other, _)) => self.shear / other * second,
        };
        [a[0] * b[0] + second, a[2] * b[2]]
    }

    /// 4 a : C^-1 b from these products, or from sums of them.
    #[inline]
    pub fn per_moduli(&self, [shear, bulk]: [S; 2]) -> S {
        shear / self.shear + bulk / self.bulk
    }

    /// tau : C^-1 tau.
    pub fn of_stress(&self, tau: Stress<S>) -> S {
        self.per_moduli(self.products(tau, tau)) / S::from(4)
    }

    /// K, M, G: all positive where A is elliptic.
    pub fn pivots(&self) -> [S; 3] {
        [self.bulk, self.shear, self.beyond.map_or(self.shear, |(other, _)| other)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pivot_is_not_positive_where_the_law_is_not_elliptic() {
        let squares = Squares::of_tensor([1.0, 2.0, 0.0, 1.0, 0.0, 1.0]);
        assert!(squares.pivots().iter().any(|&pivot| pivot <= 0.0));
    }
}
