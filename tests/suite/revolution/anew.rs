//! Method (8) for P1 bodies of revolution written out anew, with Gauss points, and mistakes in it: what the solver says solves the right
//! equations and none of the wrong ones.

use signorini::model::{Condition, Obstacle, Problem};
use signorini::results::Solution;

use super::*;

/// The right equations, or those of a mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Told {
    Right,
    /// [P]+ with the weight 1.
    NoWeight,
    /// [P]+ with r of the middle of the edge.
    MiddleWeight,
    /// s(v) without the hoop strain.
    NoHoopInS,
    /// Hooke's law of plane strain.
    NoHoopInTheLaw,
    /// u_r / r at the nodes.
    HoopAtNodes,
}

const MISTAKES: [Told; 4] =
    [Told::NoWeight, Told::MiddleWeight, Told::NoHoopInS, Told::NoHoopInTheLaw];

const LAME: [f64; 2] = [1.3, 0.8];

/// A body whose bottom is in contact with the floor z = -gap(r), with a pressure on its top.
struct Body<'a> {
    problem: &'a Problem,
    gap: fn(f64) -> f64,
    pressure: f64,
    gamma0: f64,
}

impl Body<'_> {
    /// The residual of a radian at each node.
    fn residual(&self, u: &[[f64; 2]], told: Told) -> Vec<[f64; 2]> {
        let mesh = &self.problem.mesh;
        let [lambda, mu] = LAME;
        let mut residual = vec![[0.0; 2]; u.len()];
        for (t, nodes) in mesh.triangles().iter().enumerate() {
            let triangle = mesh.triangle(t);
            let (area, slopes) = (triangle.double_area() / 2.0, triangle.barycentric_gradients());
            let middle = triangle.vertices.map(|x| x[0]).iter().sum::<f64>() / 3.0;
            let theta = if told == Told::HoopAtNodes {
                nodes.iter().map(|&k| u[k][0] / mesh.vertices()[k][0]).sum::<f64>() / 3.0
            } else {
                nodes.iter().map(|&k| u[k][0]).sum::<f64>() / (3.0 * middle)
            };
            let felt = if told == Told::NoHoopInTheLaw { 0.0 } else { theta };
            let [rr, zz, rz] = stress_in_meridian(u, nodes, slopes, felt);
            let strains = (rr + zz - 2.0 * lambda * felt) / (2.0 * (lambda + mu));
            let hoop = lambda * strains + (lambda + 2.0 * mu) * theta;
            for (slope, &node) in slopes.iter().zip(nodes) {
                let [r, z] = &mut residual[node];
                *r += area * (middle * (rr * slope[0] + rz * slope[1]) + hoop / 3.0);
                *z += area * middle * (rz * slope[0] + zz * slope[1]);
            }
        }
        for &edge in mesh.edges_of("top").unwrap() {
            let ends = mesh.ends(edge);
            let [a, b] = ends.map(|k| mesh.vertices()[k][0]);
            for (&node, (own, other)) in ends.iter().zip([(a, b), (b, a)]) {
                residual[node][1] += self.pressure * (b - a).abs() * (2.0 * own + other) / 6.0;
            }
        }
        for &edge in mesh.edges_of("bottom").unwrap() {
            self.add_contact(u, told, mesh.ends(edge), &mut residual);
        }
        residual
    }

    fn add_contact(&self, u: &[[f64; 2]], told: Told, ends: [usize; 2], sum: &mut [[f64; 2]]) {
        let mesh = &self.problem.mesh;
        let [lambda, mu] = LAME;
        let owner = mesh.triangles().iter().position(|t| ends.iter().all(|k| t.contains(k)));
        let t = owner.unwrap();
        let (nodes, triangle) = (mesh.triangles()[t], mesh.triangle(t));
        let slopes = triangle.barycentric_gradients();
        let middle = triangle.vertices.map(|x| x[0]).iter().sum::<f64>() / 3.0;
        let gamma = self.gamma0
            * (0..3).map(|i| triangle.edge(i)).map(|e| e[0].hypot(e[1])).fold(0.0, f64::max);
        // s of each shape function, and of u; n = (0, -1).
        let of_hoop = if told == Told::NoHoopInS { 0.0 } else { lambda / (3.0 * middle) };
        let s = [0, 1, 2]
            .map(|k| [lambda * slopes[k][0] + of_hoop, (lambda + 2.0 * mu) * slopes[k][1]]);
        let of_u: f64 = (0..3).map(|k| s[k][0] * u[nodes[k]][0] + s[k][1] * u[nodes[k]][1]).sum();
        let radii = ends.map(|k| mesh.vertices()[k][0]);
        let length = (radii[1] - radii[0]).abs();
        let at = |values: [f64; 2], x: f64| values[0] + (values[1] - values[0]) * x;
        let p = [0, 1].map(|i| -u[ends[i]][1] - (self.gap)(radii[i]) - gamma * of_u);
        let weight = |x: f64| match told {
            Told::NoWeight => 1.0,
            Told::MiddleWeight => at(radii, 0.5),
            _ => at(radii, x),
        };
        let root = if p[0] * p[1] < 0.0 { p[0] / (p[0] - p[1]) } else { 1.0 };
        let far = 0.6_f64.sqrt() / 2.0;
        let gauss = [(0.5 - far, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.5 + far, 5.0 / 18.0)];
        for [from, to] in [[0.0, root], [root, 1.0]] {
            for (place, share) in gauss {
                let (x, share) = (from + (to - from) * place, share * (to - from) * length);
                let pressed = at(p, x).max(0.0) / gamma * weight(x) * share;
                let stressed = gamma * at(radii, x) * of_u * share;
                for (i, &node) in ends.iter().enumerate() {
                    sum[node][1] -= pressed * [1.0 - x, x][i];
                }
                for (s, &node) in s.iter().zip(&nodes) {
                    for c in 0..2 {
                        sum[node][c] -= (gamma * pressed + stressed) * s[c];
                    }
                }
            }
        }
    }
}

fn stress_in_meridian(
    u: &[[f64; 2]],
    nodes: &[usize; 3],
    slopes: [signorini::nalgebra::Vector2<f64>; 3],
    theta: f64,
) -> [f64; 3] {
    let [lambda, mu] = LAME;
    let slope = |c: usize, d: usize| (0..3).map(|k| u[nodes[k]][c] * slopes[k][d]).sum::<f64>();
    let [rr, zz, rz] = [slope(0, 0), slope(1, 1), slope(0, 1) + slope(1, 0)];
    let trace = lambda * (rr + zz + theta);
    [trace + 2.0 * mu * rr, trace + 2.0 * mu * zz, mu * rz]
}

fn cylinder() -> Problem {
    let material = Material::lame(LAME[0], LAME[1], Plane::Axisymmetric);
    Problem::of(meridian([0.0, 1.0], 1.0, [5, 6], true), material)
}

fn gamma0_of(s: &Solution) -> f64 {
    s.gamma.gamma0
}

/// The largest residual where nothing is prescribed: on the axis u_r is, and both components are on the boundary `held`.
fn largest(body: &Body, held: Option<&str>, u: &[[f64; 2]], told: Told) -> f64 {
    let mesh = &body.problem.mesh;
    let on = |node: usize| {
        held.is_some_and(|name| {
            mesh.edges_of(name).unwrap().iter().any(|&e| mesh.ends(e).contains(&node))
        })
    };
    let residual = body.residual(u, told).into_iter().enumerate();
    residual
        .filter(|(node, _)| !on(*node))
        .map(|(node, [r, z])| {
            let r = if mesh.vertices()[node][0] == 0.0 { 0.0 } else { r };
            r.abs().max(z.abs())
        })
        .fold(0.0, |most, size| if (size + most).is_nan() { f64::NAN } else { size.max(most) })
}

#[test]
fn the_cylinder_on_the_floor_solves_the_equations_written_anew_and_those_of_no_mistake() {
    const PRESSURE: f64 = 0.01;
    let [lambda, mu] = LAME;
    let floor = Obstacle::Plane { point: [0.0, 0.0], normal: [0.0, 1.0] };
    let problem = cylinder()
        .with("bottom", Condition::obstacle("floor", floor))
        .with("top", Condition::pressure(|_| PRESSURE));
    let s = solved(&problem, Degree::One);
    let young = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
    let poisson = lambda / (2.0 * (lambda + mu));
    let exact: Vec<[f64; 2]> = (s.nodes.iter())
        .map(|[r, z]| [poisson * PRESSURE * r / young, -PRESSURE * z / young])
        .collect();
    let body = Body { problem: &problem, gap: |_| 0.0, pressure: PRESSURE, gamma0: gamma0_of(&s) };
    // A load on one edge has this size.
    let unit = PRESSURE / 25.0;
    assert!(largest(&body, None, &exact, Told::Right) < 1e-13 * unit);
    assert!(largest(&body, None, &s.displacement, Told::Right) < 1e-10 * unit);
    for mistake in MISTAKES {
        let found = largest(&body, None, &exact, mistake);
        assert!(found > 0.01 * unit, "{mistake:?}: {:e}", found / unit);
    }
    // On the axis that is 0 / 0.
    assert!(largest(&body, None, &exact, Told::HoopAtNodes).is_nan());
}

#[test]
fn a_solution_with_a_cut_edge_solves_the_equations_written_anew_and_those_of_no_mistake() {
    let gap = |r: f64| 0.05 * r * r - 0.01;
    let problem = cylinder()
        .with("top", Condition::displacement(|_| 0.0, |[r, _]| 0.002 * r))
        .with("bottom", Condition::contact(move |[r, _]| gap(r)));
    let s = solved(&problem, Degree::One);
    let ends = s.contact.iter().map(|edge| [0, 1].map(|i| edge.points[i].lambda < 0.0));
    assert!(ends.clone().any(|[a, b]| a != b), "no edge is cut");
    let body = Body { problem: &problem, gap, pressure: 0.0, gamma0: gamma0_of(&s) };
    let unit = s.quantities.contact_force / 100.0;
    assert!(largest(&body, Some("top"), &s.displacement, Told::Right) < 1e-10 * unit);
    for mistake in MISTAKES {
        let found = largest(&body, Some("top"), &s.displacement, mistake);
        assert!(found > 0.01 * unit, "{mistake:?}: {:e}", found / unit);
    }
}
