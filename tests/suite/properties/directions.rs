//! The direction of contact as a field n~ (docs/theory.md, 2.1): where the boundary of the body bends, it turns along an edge.
//!
//! P(v) at a node a is n~_a . v - gamma s(v) - g, where s is affine on the edge with the values n~ . sigma(v) n at its ends; and
//! an edge counts (2 - cos) times in kappa for P2, cos = n~ . n~' at its ends. Here for the solver's own functionals, on a body
//! whose side of contact is bent, against displacements and stresses of random fields.

use std::collections::BTreeMap;

use approx::abs_diff_eq;
use signorini::contact::Piece;
use signorini::kernel::triangle::on_edge;
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Problem, Rectangle};
use signorini::nalgebra::Vector2;
use signorini::solve::{Method, discretize};

use super::{Outcome, field, for_all, properties, text};
use crate::common::moved_to;

/// A block of 2 x 1 whose lower side is bent upwards: 4 edges with a bend of some 10 degrees at each vertex.
fn bent(plane: Plane) -> Result<Problem, String> {
    let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Left };
    let grid = cells.mesh().map_err(text)?;
    let place = |[x, y]: [f64; 2]| [x, y + 0.3 * (1.0 - y) * (x - 1.0) * (x - 1.0)];
    Ok(Problem::of(moved_to(&grid, place), Material::lame(1.5, 1.0, plane))
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|[x, y]| 0.1 * x - 0.2 * y)))
}

/// n~ at the nodes of an edge; the planted mistake takes the facet's normal.
type Directions = fn(&Piece) -> Vec<Vector2<f64>>;

fn functionals_on(degree: Degree, plane: Plane, directions: Directions) -> Outcome {
    let problem = bent(plane)?;
    let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
    if d.contact.iter().all(|edge| given(edge) == facets(edge)) {
        return Err("the direction of contact turns nowhere".to_owned());
    }
    let of_edge = |edge: &Piece, v: &[[f64; 2]]| {
        let vectors = d.space.on_triangle(edge.edge().triangle, v);
        let triangle = problem.mesh.triangle(edge.edge().triangle);
        let material = problem.material.of(edge.edge().triangle);
        let n = directions(edge);
        // n~ . sigma(v) n at the start and at the end: the first two nodes.
        let stress = [0, 1].map(|a| {
            let l = on_edge(edge.edge().local, a as f64);
            let barycentric = triangle.barycentric_gradients();
            let sigma =
                material.stress(degree.displacement_gradient(l, barycentric, |j| vectors[j]));
            n[a].dot(&sigma.traction(edge.normal()))
        });
        // Some hundred roundings of numbers up to 100.
        let near = |found: f64, expected: f64| abs_diff_eq!(found, expected, epsilon = 1e-11);
        let found = edge.sigma_n(v);
        if !(near(found[0], stress[0]) && near(found[1], stress[1])) {
            return Err(format!("s(v) = {found:?}, by definition {stress:?}"));
        }
        let p = edge.p(v);
        let nodes = degree.edge_nodes(edge.edge().local);
        for (a, (node, s)) in nodes.zip(degree.edge_positions()).enumerate() {
            let along = (1.0 - s) * stress[0] + s * stress[1];
            let expected =
                n[a].dot(&vectors[node]) - edge.gamma * along - edge.geometry.nodes[a].gap;
            if !near(p[a], expected) {
                return Err(format!("P(v) = {}, by definition {expected}", p[a]));
            }
        }
        Ok(())
    };
    let nodes = d.space.nodes().len();
    for_all(4, field(nodes), |v| d.contact.iter().try_for_each(|edge| of_edge(edge, &v)))
}

fn facets(edge: &Piece) -> Vec<Vector2<f64>> {
    vec![edge.normal(); edge.geometry.nodes.len()]
}

fn given(edge: &Piece) -> Vec<Vector2<f64>> {
    edge.geometry.nodes.iter().map(|node| node.direction).collect()
}

/// C_h by its definition, an edge counted `factor` of the cosine times; and (11) with kappa for random fields.
fn kappa_on(degree: Degree, factor: fn(f64) -> f64) -> Outcome {
    let problem = bent(Plane::Strain)?;
    let d = discretize(&problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let mut lengths: BTreeMap<usize, f64> = BTreeMap::new();
    for edge in &d.contact {
        let cosine = edge.geometry.nodes[0].direction.dot(&edge.geometry.nodes[1].direction);
        let counted = if degree.number() == 1 { 1.0 } else { factor(cosine) };
        *lengths.entry(edge.edge().triangle).or_default() += counted * edge.length;
    }
    // p (p + 1) / 2
    let trace = if degree == Degree::One { 1.0 } else { 3.0 };
    let mut most: f64 = 0.0;
    for (&t, length) in &lengths {
        let stiffness = problem.material.of(t).normal_stiffness(Vector2::<f64>::y());
        let area = problem.mesh.triangle(t).double_area() / 2.0;
        let size = problem.mesh.diameter(t);
        most = most.max(trace * stiffness * size * length / area);
    }
    if !abs_diff_eq!(d.coercivity.constant, most, epsilon = 1e-13 * most) {
        return Err(format!("C_h = {}, by definition {most}", d.coercivity.constant));
    }
    for_all(200, field(d.space.nodes().len()), |v| {
        let mut sum = 0.0;
        for edge in &d.contact {
            let [start, end] = edge.sigma_n(&v);
            let square = (start * start + start * end + end * end) / 3.0;
            sum += edge.gamma * edge.length * square;
        }
        let allowed = d.kappa() * d.strain_energy(&v);
        if !(sum <= allowed) {
            return Err(format!("(11) fails: {sum:e}, {allowed:e} is allowed"));
        }
        Ok(())
    })
}

properties! {
    functionals_along_directions_that_turn_are_their_definitions: functionals_on(Degree::One, Plane::Strain, given),
        functionals_on(Degree::Two, Plane::Strain, given), functionals_on(Degree::Two, Plane::Stress, given);
        not functionals_on(Degree::Two, Plane::Strain, facets);
    kappa_counts_edges_along_which_the_direction_turns: kappa_on(Degree::One, |cosine| 2.0 - cosine),
        kappa_on(Degree::Two, |cosine| 2.0 - cosine); not kappa_on(Degree::Two, |_| 1.0);
}
