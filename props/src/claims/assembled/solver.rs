//! The same numbers by the solver.

use signorini::contact::Discretization;
use signorini::linear::matrix;
use signorini::linear::matrix::{LowerTriangle, Neighbours, Numbering};
use signorini::proof::Unproved;
use signorini::results::{
    MethodReport, NewtonReport, Report, RouteName, Solution, Status, Verdict,
};
use signorini::solve::iterate::Evaluated;

use super::definition::Named;

/// The report that goes with a displacement that nothing was solved for.
pub fn unsolved() -> Report {
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
    Report {
        newton,
        method,
        enclosure: Err(Unproved::NotHeld),
        verdict: Verdict::Proved,
        plays: Vec::new(),
    }
}

/// The same numbers by the solver, in the same order.
pub(super) fn assembled(
    d: &Discretization<'_>,
    u: &[[f64; 2]],
    numbering: Option<&Numbering>,
) -> Vec<Named<f64>> {
    let flat = |field: &[[f64; 2]]| field.as_flattened().to_vec();
    let solution = Solution::new(d, Evaluated::new(d, u.to_vec()), unsolved());
    let q = &solution.quantities;
    // In order along the edge.
    let sorted =
        |p: Vec<f64>| [0, 2, 1].into_iter().filter_map(|a| p.get(a).copied()).collect::<Vec<_>>();
    let line = || d.contact.iter();
    let points = || solution.contact.iter().flat_map(|edge| &edge.points);
    let mut all = vec![
        ("prescribed data", flat(&d.constraints.lift())),
        ("C_h", vec![d.coercivity.constant]),
        ("kappa", vec![d.kappa()]),
        ("limit", vec![d.coercivity.limit()]),
        ("sigma_n(u)", line().flat_map(|e| e.sigma_n(u)).collect()),
        ("P(u)", line().flat_map(|e| sorted(e.p(u))).collect()),
        ("u_n", points().map(|point| point.u_n).collect()),
        ("gap", points().map(|point| point.gap).collect()),
        ("sigma_n(u^h)", points().map(|point| point.sigma_n).collect()),
        ("arc", points().map(|point| point.arc).collect()),
        ("lambda^h", points().map(|point| point.lambda).collect()),
        ("peak pressure", vec![q.peak_pressure]),
        ("contact force", vec![q.contact_force]),
        ("contact resultant", q.contact_resultant.to_vec()),
        ("mean stress", solution.stress.iter().flat_map(|(s, _)| s.components()).collect()),
        ("a(u, v)", flat(&d.internal_forces(u).values)),
        ("a(u, u)", vec![q.energy]),
        ("L(v)", flat(&d.load)),
        ("L(u)", vec![q.work]),
        ("A(u, v) - L(v)", flat(&d.linear_residual(u).values)),
        ("residual", flat(&d.residual(u).values)),
        ("J_h", vec![d.energy(u)]),
        ("reactions", q.reactions.values().flatten().copied().collect()),
    ];
    let matrices = numbering.map(|numbering| {
        let neighbours = Neighbours::new(&d.space);
        let assembled = [
            matrix::assemble_stiffness(d, numbering, &neighbours),
            matrix::assemble(d, numbering, &neighbours),
        ];
        // A matrix that is not assembled is not what it should be.
        assembled.map(|matrix| matrix.map_or(Vec::new(), |m| entries(&m, numbering.count)))
    });
    let [stiffness, matrix] = matrices.unwrap_or_default();
    all.extend([("a(., .)", stiffness), ("A(., .)", matrix)]);
    all
}

/// All entries of the lower triangle, column by column, zeros included; NaN if its rows are not in increasing order from
/// the diagonal on.
pub(super) fn entries(matrix: &LowerTriangle, count: usize) -> Vec<f64> {
    let mut all = Vec::new();
    for column in 0..count {
        let range = matrix.starts[column]..matrix.starts[column + 1];
        let rows = &matrix.rows[range.clone()];
        let mut values = vec![0.0; count - column];
        for (row, value) in rows.iter().zip(&matrix.values[range]) {
            values[row - column] = *value;
        }
        if rows.first() != Some(&column) || rows.windows(2).any(|w| w[0] >= w[1]) {
            values.fill(f64::NAN);
        }
        all.extend(values);
    }
    all
}

/// The free degrees of freedom in the order of their numbers.
pub(super) fn numbered(numbering: &Numbering) -> Vec<(usize, usize)> {
    let mut order = vec![(0, 0); numbering.count];
    for (node, numbers) in numbering.of.iter().enumerate() {
        for (c, number) in numbers.iter().enumerate() {
            if let Some(number) = number {
                order[*number] = (node, c);
            }
        }
    }
    order
}
