//! L(v) = int_Omega f . v + int_{Gamma_N} t . v for every basis function v; in a body of revolution with the weight r, for a radian.

use std::collections::BTreeMap;

use super::data::{DataError, checked};
use super::element::{Degree, with_element};
use super::function::{Function, SharedFunction};
use super::graded_quadrature::{Features, Rule};
use super::problem::{Condition, Problem, SurfaceForce};
use super::space::Space;
use crate::kernel::PreciseBall;
use crate::kernel::{Element, Scalar};
use crate::quote::key;

/// The degree up to which loads that are no polynomials are integrated exactly.
const ENOUGH: u32 = 7;

/// The largest degree of a rule: beyond it no digit changes.
const PLENTY: u32 = 24;

/// [`ENOUGH`] for a load with a kink, whose triangles and edges are cut there: it comes from an exact solution, and its
/// quadrature error must not show beside the error of the method.
const ENOUGH_AT_KINKS: u32 = 13;

/// The number of points along each direction that the rule for a load times a shape function of degree `shape` has: n are exact
/// for degree 2n - 2 on a triangle, 2n - 1 on an edge.
fn points(load: &dyn Function, shape: usize) -> usize {
    let enough = if load.kink().is_some() { ENOUGH_AT_KINKS } else { ENOUGH };
    let degree = load.degree().unwrap_or(enough).min(PLENTY) as usize + shape;
    degree.div_ceil(2) + 1
}

/// The load is zero everywhere.
fn vanishes(load: &dyn Function) -> bool {
    load.degree() == Some(0) && load.at([0.0, 0.0]) == 0.0
}

/// L at every node and component, prescribed or not.
///
/// # Errors
/// [`DataError::NotFinite`] where a load has no value, and unknown boundary names.
pub fn assemble(problem: &Problem, space: &Space) -> Result<Vec<[f64; 2]>, DataError> {
    in_doubles(problem, space, enough(tested(problem, space)))
}

/// The degree of the test functions: shape functions, in a body of revolution times r.
fn tested(problem: &Problem, space: &Space) -> usize {
    space.degree().number() + usize::from(problem.material.are_of_revolution())
}

/// [`assemble`] at points, as many along each direction as `points` says for a load.
///
/// # Errors
/// As [`assemble`].
pub fn assemble_with(
    problem: &Problem,
    space: &Space,
    points: impl Fn(&dyn Function) -> usize + Copy,
) -> Result<Vec<[f64; 2]>, DataError> {
    in_doubles(problem, space, Rules { points, corners: false })
}

fn in_doubles(
    problem: &Problem,
    space: &Space,
    rules: Rules<impl Fn(&dyn Function) -> usize + Copy>,
) -> Result<Vec<[f64; 2]>, DataError> {
    let mut load = vec![[0.0; 2]; space.nodes().len()];
    let add = |force: Force| force.add_to(&force.shapes.in_doubles, &mut load);
    each_force(problem, space, rules, add)?;
    Ok(load)
}

/// The rules for loads.
#[derive(Clone, Copy)]
struct Rules<P> {
    /// The number of points along each direction for a load.
    points: P,
    /// Affine forces on the body are taken at the corners of triangles, not at points.
    corners: bool,
}

/// The rules that lose nothing of a load times functions of degree `shape`.
fn enough(shape: usize) -> Rules<impl Fn(&dyn Function) -> usize + Copy> {
    Rules { points: move |load: &dyn Function| points(load, shape), corners: true }
}

/// Where a force on the body is evaluated.
enum BodyRule {
    /// At the corners of triangles.
    Corners,
    Points(Rule),
}

impl<P: Fn(&dyn Function) -> usize> Rules<P> {
    /// The rule on edges.
    fn on_edges(&self, load: &dyn Function) -> Rule {
        Rule::new(Features { kink: load.kink(), singular: None }, (self.points)(load))
    }

    /// The rule on triangles for a load, times a weight of this degree.
    fn on_triangles(&self, load: &dyn Function, weight: u32) -> BodyRule {
        let is_affine = load.degree().is_some_and(|degree| degree + weight <= 1);
        if self.corners && is_affine && load.kink().is_none() {
            return BodyRule::Corners;
        }
        BodyRule::Points(self.on_edges(load))
    }
}

/// L at every node and component.
pub(crate) struct LoadVector {
    /// In doubles.
    pub(crate) in_doubles: Vec<[f64; 2]>,
    /// The loads with bounds of their rounding.
    pub(crate) in_balls: Vec<[PreciseBall; 2]>,
}

/// [`assemble`] in doubles and in balls: the forces at the points of the rules, weight times value, are doubles and evaluated
/// once, for a load may be slow; their sums are computed in both.
///
/// # Errors
/// As [`assemble`].
pub(crate) fn assemble_twice(problem: &Problem, space: &Space) -> Result<LoadVector, DataError> {
    let mut in_doubles = vec![[0.0; 2]; space.nodes().len()];
    let mut in_balls = vec![[PreciseBall::from(0.0); 2]; space.nodes().len()];
    // Those at corners with one factor at a node, as [`Shapes::for_corner`] says, are added up before they are multiplied by it.
    let none = [[PreciseBall::from(0.0); 2]; 2];
    let mut at_corners = vec![none; space.nodes().len()];
    each_force(problem, space, enough(tested(problem, space)), |force| {
        force.add_to(&force.shapes.in_doubles, &mut in_doubles);
        let Some(corner) = force.shapes.corner else {
            return force.add_to(&force.shapes.in_balls, &mut in_balls);
        };
        for (j, &node) in force.nodes.iter().enumerate() {
            at_corners[node][force.c][usize::from(j % 3 != corner)] += force.value.into();
        }
    })?;
    let factors = [0, 1].map(|k| Shapes::for_corner(space.degree(), k).in_balls);
    let vertices = space.mesh().vertices().len();
    for (node, (load, sums)) in in_balls.iter_mut().zip(&at_corners).enumerate() {
        let j = if node < vertices { 0 } else { 3 };
        for c in (0..2).filter(|&c| sums[c] != none[c]) {
            load[c] += sums[c][0] * factors[0][j] + sums[c][1] * factors[1][j];
        }
    }
    Ok(LoadVector { in_doubles, in_balls })
}

/// The shape functions at a point of a triangle or an edge.
struct Shapes {
    /// The corner, where they are those of [`Shapes::for_corner`].
    corner: Option<usize>,
    in_doubles: Vec<f64>,
    in_balls: Vec<PreciseBall>,
}

impl Shapes {
    /// At barycentric coordinates.
    fn inside(degree: Degree, l: [f64; 3]) -> Self {
        with_element!(degree, E => Shapes {
            corner: None,
            in_doubles: E::values(l).to_vec(),
            in_balls: E::values(l.map(PreciseBall::from)).to_vec(),
        })
    }

    /// For an affine load, whose value is that at the corners times their barycentric coordinates: the integrals of corner k's times
    /// the shape functions, beside a third of the area. They differ between corners and middles of edges, and between corner k with
    /// the edge opposite (nodes k and 3 + k) and the others; that is all.
    fn for_corner(degree: Degree, k: usize) -> Self {
        let ratio = |a: i32, b: i32| PreciseBall::from(a) / PreciseBall::from(b);
        let near = |i: usize| std::array::from_fn(|j| ratio(if i == j { 3 } else { 1 }, 5));
        let points = [[ratio(1, 3); 3], near(0), near(1), near(2)];
        // Exact for cubic polynomials.
        let weights = [ratio(-9, 16), ratio(25, 48), ratio(25, 48), ratio(25, 48)];
        let mut in_balls = vec![PreciseBall::from(0); degree.nodes_per_triangle()];
        for (l, weight) in points.into_iter().zip(weights) {
            let values = with_element!(degree, E => E::values(l).to_vec());
            let weight = weight * PreciseBall::from(3) * l[k];
            in_balls.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        let in_doubles = in_balls.iter().map(|ball| ball.head()).collect();
        Shapes { corner: Some(k), in_doubles, in_balls }
    }

    /// Between the ends of an edge, from 0 to 1.
    fn on_edge(degree: Degree, s: f64) -> Self {
        with_element!(degree, E => Shapes {
            corner: None,
            in_doubles: E::edge_values(s).to_vec(),
            in_balls: E::edge_values(PreciseBall::from(s)).to_vec(),
        })
    }
}

/// Weight times value of a load at a point of its rule.
struct Force<'a> {
    /// The component.
    c: usize,
    value: f64,
    /// The nodes of the triangle or the edge.
    nodes: &'a [usize],
    shapes: &'a Shapes,
}

impl Force<'_> {
    fn add_to<S>(&self, shapes: &[S], load: &mut [[S; 2]])
    where
        S: Scalar + From<f64>,
    {
        let value = <S as From<f64>>::from(self.value);
        for (&node, &shape) in self.nodes.iter().zip(shapes) {
            load[node][self.c] += value * shape;
        }
    }
}

/// The resultants of the loads.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Resultants {
    /// The resultant of the forces on the body and on parts of it.
    pub(crate) body: [f64; 2],
    /// The resultants of the boundaries on which a traction or a pressure is given, by name.
    pub(crate) boundaries: BTreeMap<String, [f64; 2]>,
}

impl Resultants {
    /// The axial forces of a whole revolution, and the radial ones of a radian, where these are those of a radian.
    #[must_use]
    pub(crate) fn of_the_revolution(mut self) -> Self {
        let forces = self.boundaries.values_mut().chain([&mut self.body]);
        forces.for_each(|f| f[1] *= std::f64::consts::TAU);
        self
    }

    /// The resultants on a body of this thickness.
    #[must_use]
    pub(crate) fn times(mut self, thickness: f64) -> Self {
        let forces = self.boundaries.values_mut().chain([&mut self.body]);
        forces.flatten().for_each(|f| *f *= thickness);
        self
    }
}

/// The resultants of the loads of a problem.
///
/// # Errors
/// As [`assemble`].
pub(crate) fn resultants(problem: &Problem, space: &Space) -> Result<Resultants, DataError> {
    let mut all = Resultants::default();
    let rules = enough(space.degree().number());
    each_force_on_body(problem, space, rules, |force| all.body[force.c] += force.value)?;
    for (name, condition) in &problem.conditions {
        let mut sum = [0.0; 2];
        let add = |force: Force| sum[force.c] += force.value;
        each_force_of(problem, (name, condition), space, rules, add)?;
        if condition.has_load() {
            all.boundaries.insert(name.clone(), sum);
        }
    }
    Ok(all)
}

/// Calls `add` with each force at each point.
fn each_force(
    problem: &Problem,
    space: &Space,
    rules: Rules<impl Fn(&dyn Function) -> usize + Copy>,
    mut add: impl FnMut(Force),
) -> Result<(), DataError> {
    each_force_on_body(problem, space, rules, &mut add)?;
    for (name, condition) in &problem.conditions {
        each_force_of(problem, (name, condition), space, rules, &mut add)?;
    }
    Ok(())
}

/// Takes a force at its place: with the weight r in a body of revolution.
fn weighted(problem: &Problem, mut add: impl FnMut(Force)) -> impl FnMut(Force, [f64; 2]) {
    let of_revolution = problem.material.are_of_revolution();
    move |force: Force, [r, _]: [f64; 2]| {
        let radius = if of_revolution { r } else { 1.0 };
        add(Force { value: force.value * radius, ..force });
    }
}

fn each_force_on_body(
    problem: &Problem,
    space: &Space,
    rules: Rules<impl Fn(&dyn Function) -> usize>,
    add: impl FnMut(Force),
) -> Result<(), DataError> {
    let mut add = weighted(problem, add);
    let weight = u32::from(problem.material.are_of_revolution());
    let rule = |load: &dyn Function| rules.on_triangles(load, weight);
    for (c, f) in acting(&problem.body_force) {
        let what = || format!("[load] body[{c}]");
        each_body_force(c, f, &rule(f), space, 0..space.elements().len(), what, &mut add)?;
    }
    for SurfaceForce { surface, triangles, force } in &problem.surface_forces {
        for (c, f) in acting(force) {
            let what = || format!("[load.{}] body[{c}]", key(surface));
            let triangles = triangles.iter().copied();
            each_body_force(c, f, &rule(f), space, triangles, what, &mut add)?;
        }
    }
    Ok(())
}

/// Calls `add` with each force on a boundary with this name and condition.
fn each_force_of(
    problem: &Problem,
    (name, condition): (&str, &Condition),
    space: &Space,
    rules: Rules<impl Fn(&dyn Function) -> usize>,
    add: impl FnMut(Force),
) -> Result<(), DataError> {
    let mut add = weighted(problem, add);
    let rule = |load: &dyn Function| rules.on_edges(load);
    match condition {
        Condition::Traction(traction) | Condition::Mixed { traction, .. } => {
            let is_held = |c: usize| match condition {
                Condition::Mixed { displacement, .. } => displacement[c].is_some(),
                _ => false,
            };
            for (c, t) in acting(traction).filter(|(c, _)| !is_held(*c)) {
                let what = || format!("[boundary.{}] traction[{c}]", key(name));
                let value = |x, n| checked(t.on_boundary(x, n), x, what);
                each_force_on_boundary(name, c, value, &rule(t), space, &mut add)?;
            }
        }
        Condition::Pressure(p) => {
            let what = || format!("[boundary.{}] pressure", key(name));
            for c in 0..2 {
                let value = |x, n: [f64; 2]| Ok(-n[c] * checked(p.on_boundary(x, n), x, what)?);
                each_force_on_boundary(name, c, value, &rule(&**p), space, &mut add)?;
            }
        }
        _ => {}
    }
    Ok(())
}

/// The components of a load that act somewhere.
fn acting(load: &[SharedFunction; 2]) -> impl Iterator<Item = (usize, &dyn Function)> {
    load.iter().map(|f| &**f).enumerate().filter(|(_, f)| !vanishes(*f))
}

fn each_body_force(
    c: usize,
    f: &dyn Function,
    rule: &BodyRule,
    space: &Space,
    triangles: impl Iterator<Item = usize>,
    what: impl Fn() -> String,
    mut add: impl FnMut(Force, [f64; 2]),
) -> Result<(), DataError> {
    let mut wrong = None;
    let value = |x: [f64; 2]| checked(f.at(x), x, &what);
    let mut act = |nodes: &[usize], x: [f64; 2], f, weight: f64, shapes: &Shapes| match f {
        Ok(f) => add(Force { c, value: weight * f, nodes, shapes }, x),
        Err(error) => wrong = wrong.take().or(Some(error)),
    };
    match rule {
        BodyRule::Corners => {
            let shapes = [0, 1, 2].map(|k| Shapes::for_corner(space.degree(), k));
            let mesh = space.mesh();
            // Once at each vertex, at which some six triangles have a corner.
            let mut values: Vec<Option<f64>> = vec![None; mesh.vertices().len()];
            for t in triangles {
                let weight = mesh.triangle(t).double_area().abs() / 6.0;
                for (&v, shapes) in mesh.triangles()[t].iter().zip(&shapes) {
                    let x = mesh.vertices()[v];
                    let f = values[v].map_or_else(|| value(x), Ok);
                    values[v] = f.as_ref().ok().copied();
                    act(space.nodes_of(t), x, f, weight, shapes);
                }
            }
        }
        BodyRule::Points(rule) => {
            let shapes_at = |l| Shapes::inside(space.degree(), l);
            // The same on every triangle that is not cut.
            let known: Vec<([f64; 3], Shapes)> = rule.plain().map(|l| (l, shapes_at(l))).collect();
            for t in triangles {
                let (nodes, mut expected) = (space.nodes_of(t), known.iter());
                let triangle = space.mesh().triangle(t);
                rule.on_triangle(&triangle, |l, x, weight| match expected.next() {
                    Some((at, shapes)) if *at == l => act(nodes, x, value(x), weight, shapes),
                    _ => act(nodes, x, value(x), weight, &shapes_at(l)),
                });
            }
        }
    }
    wrong.map_or(Ok(()), Err)
}

/// A traction's component c, `value` of the place and the outward normal.
fn each_force_on_boundary(
    name: &str,
    c: usize,
    value: impl Fn([f64; 2], [f64; 2]) -> Result<f64, DataError>,
    rule: &Rule,
    space: &Space,
    mut add: impl FnMut(Force, [f64; 2]),
) -> Result<(), DataError> {
    let mut wrong = None;
    for &edge in space.mesh().edges_of(name)? {
        let (length, normal) = space.mesh().length_and_normal(edge);
        let ends = space.mesh().places_of_ends(edge);
        let nodes = &space.edge_nodes(edge).collect::<Vec<_>>();
        rule.on_edge(ends, [], |point| match value(point.x, normal.into()) {
            Ok(t) => {
                let value = point.weight * length * t;
                let shapes = &Shapes::on_edge(space.degree(), point.s);
                add(Force { c, value, nodes, shapes }, point.x);
            }
            Err(error) => wrong = wrong.take().or(Some(error)),
        });
    }
    wrong.map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::io::Expression;
    use crate::kernel::{Material, Plane};
    use crate::model::Mesh;

    /// Some ten operations on numbers of size 1; in balls, with twice the digits, the square.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn forces_at_corners_that_are_added_up_before_they_are_multiplied_are_those_in_doubles() {
        let corners = vec![[0.0, 0.0], [1.0, 0.1], [0.9, 0.8], [-0.2, 1.0]];
        let mesh = Mesh::new(corners, vec![[0, 1, 2], [2, 3, 0]], []).unwrap();
        let affine = |text: &str| -> SharedFunction {
            Arc::new(text.parse::<Expression>().expect("a valid expression"))
        };
        let force = [affine("1 + 2*x - y"), affine("x - 3*y")];
        let problem =
            Problem::new(mesh, Material::lame(1.0, 1.0, Plane::Strain), force, BTreeMap::new());
        for degree in [Degree::One, Degree::Two] {
            let space = Space::new(&problem.mesh, degree);
            let load = assemble_twice(&problem, &space).unwrap();
            let at_points = assemble_with(&problem, &space, |_| 3).unwrap();
            let balls = || load.in_balls.as_flattened().iter();
            for in_doubles in [&load.in_doubles, &at_points] {
                for (ball, double) in balls().zip(in_doubles.as_flattened()) {
                    assert!((ball.head() - double).abs() < ROUNDING, "{ball:?} {double}");
                    assert!(ball.radius() < ROUNDING * ROUNDING, "{ball:?}");
                }
            }
            // Control: no two forces are the same, so that one in another's place is seen.
            let mut forces: Vec<f64> = balls().map(|ball| ball.head()).collect();
            forces.sort_unstable_by(f64::total_cmp);
            assert!(forces.windows(2).all(|pair| pair[1] - pair[0] > 1e-6), "{forces:?}");
        }
    }
}
