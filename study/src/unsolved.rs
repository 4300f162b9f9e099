//! What is reported of any displacement.

use signorini::contact::Discretization;
use signorini::proof::Unproved;
use signorini::results::{
    MethodReport, NewtonReport, Report, RouteName, Solution, Status, Verdict,
};
use signorini::solve::iterate::Evaluated;

/// A displacement, by its values at the nodes (lengths), with stresses, pressures and resultants, as if it were a solution; nothing
/// is solved.
pub fn unsolved(d: &Discretization<'_>, u: Vec<[f64; 2]>) -> Solution {
    let newton = NewtonReport {
        status: Status::Converged,
        residuals: Vec::new(),
        residual: 0.0,
        factorizations: 0,
    };
    let method = MethodReport {
        route: RouteName::Condensed,
        predicted_operations: 0.0,
        condition: 1.0,
        forward_error: 0.0,
        threads: 1,
        slides: 0,
    };
    let report = Report {
        newton,
        method,
        enclosure: Err(Unproved::NotHeld),
        verdict: Verdict::Proved,
        plays: Vec::new(),
    };
    Solution::new(d, Evaluated::new(d, u), report)
}
