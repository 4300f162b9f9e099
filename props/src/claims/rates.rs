//! Theorem 3.5, Corollary 3.6 and Remark 3.7: rates of convergence. They are statements about h -> 0, with constants that
//! depend on the unknown solution: they can be observed on exact solutions, not established by running code.

use crate::claim::Claim;

/// The row of the rates.
pub fn claim() -> Claim {
    Claim {
        id: "12",
        items: &["Theorem 3.5", "(21)", "(22)-(24)", "Corollary 3.6", "(25)", "Remark 3.7"],
        title: "Rates of convergence",
        paper: "|u - u^h|_1 + |gamma^1/2 (sigma_n(u) + (1/gamma)[P_gamma(u^h)]+)| <= C h^(1/2 + nu) |u|_(3/2 + nu), 0 < nu <= 1/2; the same rate for |gamma^1/2 sigma_n(u - u_h)|; for quadratic elements 0 < nu <= 3/2.",
        statement: "To be observed on exact solutions by the convergence study, which does not exist yet. The step from (13) with its constant to the rate of Corollary 3.6 is proved in row 11.",
        numbers: "None yet.",
        kernel: &[],
        preconditions: "The regularity of the solution.",
        limits: "The rates themselves: the interpolation estimates (22)-(24) are taken from the literature, and an observed rate is no proof.",
        single: None,
        checks: Vec::new(),
    }
}
