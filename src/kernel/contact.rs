//! Contact at one point of Gamma_C: conditions (2), their reformulation (5), the operator P_gamma and the pressure
//! lambda^h of section 2.3, with an initial gap g (the paper has g = 0).
//!
//! Signs: sigma_n is negative in compression, u_n - g is positive in penetration.

use super::{Scalar, positive_part};

/// The four numbers that meet at a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint<S> {
    /// u_n = u . n, the displacement along the outward normal (a length).
    pub u_n: S,
    /// g, the initial distance to the obstacle along n (a length).
    pub gap: S,
    /// sigma_n = n . sigma n (a stress).
    pub sigma_n: S,
    /// gamma = gamma0 h_T > 0 of (7) (length / stress).
    pub gamma: S,
}

/// How far conditions (2) are from holding, each kept apart; all three are zero exactly when (2)(i)-(iii) hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation<S> {
    /// \[u_n - g\]+: the violation of (i).
    pub penetration: S,
    /// \[sigma_n\]+: the violation of (ii).
    pub tension: S,
    /// sigma_n (u_n - g): the violation of (iii).
    pub product: S,
}

impl<S: Scalar> ContactPoint<S> {
    /// P(u) = u_n - g - gamma sigma_n: P_gamma of the paper, with the gap.
    pub fn p(&self) -> S {
        self.p0() - self.gap
    }

    /// P0(u) = u_n - gamma sigma_n: the linear part of P.
    pub fn p0(&self) -> S {
        self.u_n - self.gamma * self.sigma_n
    }

    /// lambda^h = -(1/gamma) \[P(u)\]+ of section 2.3: never positive. Equation (5) says that it is sigma_n.
    pub fn pressure(&self) -> S {
        pressure(self.p(), self.gamma)
    }

    /// How far (2) is from holding.
    pub fn violation(&self) -> Violation<S> {
        let opening = self.u_n - self.gap;
        Violation {
            penetration: positive_part(opening),
            tension: positive_part(self.sigma_n),
            product: self.sigma_n * opening,
        }
    }
}

/// lambda^h = -(1/gamma) \[P\]+ from P itself.
pub fn pressure<S: Scalar>(p: S, gamma: S) -> S {
    -(positive_part(p) / gamma)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_is_not_no_contact() {
        let point = ContactPoint { u_n: f64::NAN, gap: 0.0, sigma_n: 0.0, gamma: 1.0 };
        assert!(point.pressure().is_nan());
    }
}
