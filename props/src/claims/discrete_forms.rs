//! V^h, a(.,.), P_gamma and A_gamma of section 2.2: what the kernel computes is what the definitions say.
//!
//! The elements reproduce every polynomial of their degree and its gradient; on random meshes over rationals, the loops of the
//! solver equal the transcription in `naive`.

use signorini::kernel::triangle::on_edge;
use signorini::kernel::{Element, P1, P2, Triangle};
use signorini::nalgebra::Vector2;

use crate::harness::any;
use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given, harnesses};

fn triangle<S>([ax, ay, bx, by, cx, cy]: [S; 6]) -> Triangle<S> {
    Triangle { vertices: [Vector2::new(ax, ay), Vector2::new(bx, by), Vector2::new(cx, cy)] }
}

/// Edges, area and normals of a triangle without a division.
pub fn triangle_geometry_is_its_definition<S: Ordered>(v: [S; 6]) -> Verdict {
    let (t, zero) = (triangle(v), S::from(0));
    let [ax, ay, bx, by, cx, cy] = v;
    let shoelace = ax * (by - cy) + bx * (cy - ay) + cx * (ay - by);
    ensure!(t.double_area() == shoelace);
    ensure!(t.edge(0) == Vector2::new(cx - bx, cy - by));
    ensure!(t.edge(1) == Vector2::new(ax - cx, ay - cy));
    ensure!(t.edge(2) == Vector2::new(bx - ax, by - ay));
    for i in 0..3 {
        let (edge, n) = (t.edge(i), t.scaled_normal(i));
        // As long as the edge, across it, and away from the opposite vertex when the area is positive.
        ensure!(n[0] * edge[0] + n[1] * edge[1] == zero);
        ensure!(n[0] * n[0] + n[1] * n[1] == edge[0] * edge[0] + edge[1] * edge[1]);
        let (from, to) = (t.vertices[i], t.vertices[(i + 1) % 3]);
        ensure!(n[0] * (to[0] - from[0]) + n[1] * (to[1] - from[1]) == shoelace);
    }
    Verdict::Holds("always")
}

/// The barycentric gradients are dual to the vertices.
pub fn barycentric_gradients_are_dual_to_the_vertices<S: Ordered>(v: [S; 6]) -> Verdict {
    let t = triangle(v);
    given!(t.double_area() > S::from(0));
    let gradients = t.barycentric_gradients();
    for i in 0..3 {
        for (j, k) in [(1, 0), (2, 0)] {
            let d = [0, 1].map(|c| t.vertices[j][c] - t.vertices[k][c]);
            let change = i32::from(i == j) - i32::from(i == k);
            ensure!(gradients[i][0] * d[0] + gradients[i][1] * d[1] == S::from(change));
        }
    }
    Verdict::Holds("always")
}

/// A point by its barycentric coordinates, and the points of an edge: s = 0 is vertex i + 1, s = 1 vertex i + 2.
pub fn points_of_edges_run_from_start_to_end<S: Ordered>(
    [ax, ay, bx, by, cx, cy, s]: [S; 7],
) -> Verdict {
    let t = triangle([ax, ay, bx, by, cx, cy]);
    for i in 0..3 {
        let [start, end] = [t.vertices[(i + 1) % 3], t.vertices[(i + 2) % 3]];
        let point = t.point(on_edge(i, s));
        for c in 0..2 {
            ensure!(point[c] == start[c] + s * (end[c] - start[c]));
        }
    }
    Verdict::Holds("always")
}

/// The quadratic with these coefficients in the barycentric coordinates l_0, l_1, and its derivatives by them.
fn quadratic<S: Ordered>(c: [S; 6], [x, y, _]: [S; 3]) -> [S; 3] {
    let two = S::from(2);
    [
        c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y,
        c[1] + two * c[3] * x + c[4] * y,
        c[2] + c[4] * x + two * c[5] * y,
    ]
}

/// An element reproduces a polynomial from its values at the nodes: values and gradients at l, traces on the edges at s.
/// The nodes are where `edge_nodes` and `edge_positions` say.
fn reproduces<E: Element<N, M>, S: Ordered, const N: usize, const M: usize>(
    c: [S; 6],
    [x, y]: [S; 2],
) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    let l = [x, y, one - x - y];
    let mut nodal = [zero; N];
    for i in 0..3 {
        for (node, s) in E::edge_nodes(i).into_iter().zip(E::edge_positions()) {
            nodal[node] = quadratic(c, on_edge(i, s))[0];
        }
    }
    let combined = |weights: [S; N]| (0..N).fold(zero, |sum, j| sum + weights[j] * nodal[j]);
    let [value, dx, dy] = quadratic(c, l);
    ensure!(combined(E::values(l)) == value);
    // In the coordinates l_0, l_1 the barycentric gradients are these.
    let barycentric = [[one, zero], [zero, one], [-one, -one]].map(Vector2::from);
    let gradients = E::gradients(l, barycentric);
    ensure!(combined(gradients.map(|g| g[0])) == dx && combined(gradients.map(|g| g[1])) == dy);
    for i in 0..3 {
        let shapes = E::edge_values(x);
        let trace = (0..M).fold(zero, |sum, a| sum + shapes[a] * nodal[E::edge_nodes(i)[a]]);
        ensure!(trace == quadratic(c, on_edge(i, x))[0]);
    }
    Verdict::Holds("always")
}

/// P1: every affine function.
pub fn p1_reproduces_affine_functions<S: Ordered>([c0, c1, c2, x, y]: [S; 5]) -> Verdict {
    let zero = S::from(0);
    ensure!(P1::DEGREE == 1);
    reproduces::<P1, S, 3, 2>([c0, c1, c2, zero, zero, zero], [x, y])
}

/// P2: every quadratic function.
pub fn p2_reproduces_quadratic_functions<S: Ordered>(
    [c0, c1, c2, c3, c4, c5, x, y]: [S; 8],
) -> Verdict {
    ensure!(P2::DEGREE == 2);
    reproduces::<P2, S, 6, 3>([c0, c1, c2, c3, c4, c5], [x, y])
}

/// The rule for the element matrix is exact for products of two gradients: its mean of a polynomial of degree 2 (p - 1),
/// at least 1, is the mean over the triangle.
fn rule_is_exact<E: Element<N, M>, S: Ordered, const N: usize, const M: usize>(
    c: [S; 6],
) -> Verdict {
    let (zero, one) = (S::from(0), S::from(1));
    let (mut mean, mut weights, mut inside) = (zero, zero, true);
    E::at_stiffness_points(|l: [S; 3], weight| {
        mean += weight * quadratic(c, l)[0];
        weights += weight;
        inside = inside && l[0] + l[1] + l[2] == one;
    });
    ensure!(weights == one && inside);
    // The means of x, y, x^2, xy, y^2 are 1/3, 1/3, 1/6, 1/12, 1/6.
    let exact = S::from(12) * c[0] + S::from(4) * (c[1] + c[2]) + S::from(2) * (c[3] + c[5]) + c[4];
    ensure!(S::from(12) * mean == exact);
    Verdict::Holds("always")
}

/// The rules of P1 and P2.
pub fn stiffness_rules_are_exact<S: Ordered>(c: [S; 6]) -> Verdict {
    let zero = S::from(0);
    let affine = rule_is_exact::<P1, S, 3, 2>([c[0], c[1], c[2], zero, zero, zero]);
    ensure!(!affine.fails());
    rule_is_exact::<P2, S, 6, 3>(c)
}

/// P1 does not reproduce quadratic functions.
pub fn control_p1_reproduces_quadratic_functions<S: Ordered>(
    [c0, c1, c2, c3, c4, c5, x, y]: [S; 8],
) -> Verdict {
    reproduces::<P1, S, 3, 2>([c0, c1, c2, c3, c4, c5], [x, y])
}

/// The barycentric gradients without the minus sign: inward normals are outward ones.
pub fn control_gradients_along_the_outward_normals<S: Ordered>(v: [S; 6]) -> Verdict {
    let t = triangle(v);
    given!(t.double_area() > S::from(0));
    let g = t.scaled_normal(0) / t.double_area();
    let d = [0, 1].map(|c| t.vertices[0][c] - t.vertices[1][c]);
    ensure!(g[0] * d[0] + g[1] * d[1] == S::from(1));
    Verdict::Holds("always")
}

harnesses! {
    /// The nodes of the edges: each vertex is the end of one edge and the start of the next; middles are their own.
    holds edge_nodes_follow_each_other_for_all_edges() {
        let i: usize = any();
        crate::harness::assume(i < 3);
        let ([_, end], [start, _]) = (P1::edge_nodes(i), P1::edge_nodes(i + 1));
        assert!(end == start);
        let ([a, b, middle], [first, second]) = (P2::edge_nodes(i), P1::edge_nodes(i));
        assert!(first == a && second == b && a != i && b != i && middle == 3 + i);
    }
    /// The false twin: edges are numbered by their start.
    fails control_edges_start_at_the_vertex_with_their_number([0.0]) {
        let i: usize = any();
        crate::harness::assume(i < 3);
        assert!(P1::edge_nodes(i)[0] == i);
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::claim::{Claim, model_checked};
    use crate::claims::assembled;

    /// The row of section 2.2's definitions.
    pub fn claim() -> Claim {
        Claim {
            id: "5",
            title: "gamma, P_gamma and A_gamma",
            paper: "",
            limits: "",
            checks: [
                statements! {
                    proved + tested triangle_geometry_is_its_definition[ax, ay, bx, by, cx, cy];
                    proved + tested barycentric_gradients_are_dual_to_the_vertices[ax, ay, bx, by, cx, cy];
                    proved + tested points_of_edges_run_from_start_to_end[ax, ay, bx, by, cx, cy, s];
                    proved + tested p1_reproduces_affine_functions[c0, c1, c2, x, y] about "V^h";
                    proved + tested p2_reproduces_quadratic_functions[c0, c1, c2, c3, c4, c5, x, y] about "V^h";
                    proved + tested stiffness_rules_are_exact[c0, c1, c2, c3, c4, c5];
                    refuted control_p1_reproduces_quadratic_functions[c0, c1, c2, c3, c4, c5, x, y]
                        fails "trace == quadratic(c, on_edge(i, x))[0]";
                    refuted control_gradients_along_the_outward_normals[ax, ay, bx, by, cx, cy]
                        fails "g[0] * d[0] + g[1] * d[1] == S::from(1)";
                },
                vec![
                    exact!("the_loops_of_the_solver_over_rationals_are_the_definitions", in compare::loops, draws 47 => assembled::loops_over_rationals()).about(&["P_gamma, A_gamma", "(8)", "Lemma 3.1", "(12)"]),
                    doubles!("gamma_of_the_solver_is_gamma0_times_the_diameter", in roots::gamma_is, draws 80 => assembled::gamma_by_the_diameter()).about(&["(7)"]),
                    doubles!("control_gamma_by_the_length_of_the_edge", in roots::gamma_by_the_edge => assembled::gamma_by_the_edge()),
                    exact!("control_the_loops_of_the_solver_beside_other_definitions", in assembled::loops_beside_other_definitions => assembled::loops_beside_other_definitions()),
                ],
                model_checked(HARNESSES, &[]),
            ]
            .concat(),
        }
    }
}
