//! What a mesh and its data say of places: which triangle a point is in, which rigid motions supports leave free and how these
//! are called, where a boundary is curved, and that loads are integrated exactly as far as they are said to be.

use std::sync::Arc;

use approx::abs_diff_eq;
use proptest::array::uniform3;
use proptest::sample::select;
use proptest::strategy::Strategy;
use signorini::contact::{Piece, contact_line};
use signorini::model::constraints::Constraints;
use signorini::model::{
    Condition, Degree, Diagonal, Function, Mesh, PointSupport, Problem, Rectangle, SharedFunction,
    Space, loads,
};

use super::{Outcome, any_order, for_all, properties, text};
use crate::common::{constant, polygon, unit_material};

fn body(mesh: Mesh) -> Problem {
    Problem::of(mesh, unit_material())
}

/// A rectangle with its vertices moved at random, in cells of side 1 before.
fn moved([nx, ny]: [usize; 2], seed: u64) -> Result<Mesh, String> {
    let (width, height) = (nx as f64, ny as f64);
    let cells = Rectangle { width, height, nx, ny, diagonal: Diagonal::Crossed };
    cells.perturbed(0.2, seed).map_err(text)
}

/// Points of each triangle, corners and points of edges among them, are found in a triangle that has them, a shift of `off`
/// along x counted; points beside the body are not found.
fn located(off: f64) -> Outcome {
    let mesh = moved([3, 2], 7)?;
    let weights = uniform3(0_u8..4).prop_filter("a point", |weights| *weights != [0; 3]);
    for_all(480, (0..mesh.triangles().len(), weights), |(t, weights)| {
        let weights = weights.map(f64::from);
        let sum: f64 = weights.iter().sum();
        let x = mesh.triangle(t).point(weights.map(|w| w / sum));
        let (found, at) = mesh.locate([x.x + off, x.y]).ok_or(format!("{x:?} is nowhere"))?;
        let there = mesh.triangle(found).point(at);
        // Some ten roundings beside a determinant of a hundredth.
        if !(at.iter().all(|&l| l >= -1e-11) && abs_diff_eq!(there, x, epsilon = 1e-11)) {
            return Err(format!("{x:?} is found at {there:?}"));
        }
        Ok(())
    })?;
    for outside in [[-0.001, 1.0], [3.001, 1.0], [1.5, -0.001], [1.5, 2.001]] {
        if mesh.locate(outside).is_some() {
            return Err(format!("{outside:?} is in the body"));
        }
    }
    Ok(())
}

/// A polynomial of this degree along x + y / 2 from x + y / 2 = `from` on, of which so much is told.
#[derive(Clone, Copy)]
struct Power {
    degree: u32,
    from: Option<f64>,
    told: bool,
}

impl Function for Power {
    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let along = match self.from {
            Some(c) => (x - c).max(0.0),
            None => x + y / 2.0,
        };
        along.powi(self.degree as i32)
    }

    fn degree(&self) -> Option<u32> {
        self.told.then_some(self.degree)
    }

    fn kink(&self) -> Option<f64> {
        self.from
    }
}

/// Body forces and tractions of degree 7 that tell nothing, of degree 13 with a kink, and of any degree that is told are
/// integrated as by thirty points a direction, in bodies of revolution too; those that tell nothing have a degree `higher` by that.
fn integrated(degree: Degree, higher: u32) -> Outcome {
    let told = |degree| Power { degree, from: None, told: true };
    let mut powers = vec![
        Power { degree: 7 + higher, from: None, told: false },
        Power { degree: 13 + higher, from: Some(0.4), told: false },
    ];
    powers.extend([1, 2, 3, 5, 8, 12, 17].map(told));
    let cells = Rectangle { width: 1.0, height: 1.0, nx: 1, ny: 1, diagonal: Diagonal::Left };
    let materials = [unit_material(), unit_material().of_revolution(1.0)];
    for (power, material) in powers.iter().flat_map(|power| materials.map(|m| (power, m))) {
        let (power_of, kink) = (power.degree, power.from);
        let power: SharedFunction = Arc::new(*power);
        let mut problem = Problem::of(cells.mesh().map_err(text)?, material);
        problem.body_force = [Arc::clone(&power), constant(0.0)];
        for name in ["right", "top"] {
            let traction = Condition::Traction([constant(0.0), Arc::clone(&power)]);
            problem.conditions.insert(name.to_owned(), traction);
        }
        let space = Space::new(&problem.mesh, degree);
        let found = loads::assemble(&problem, &space).map_err(text)?;
        let many = loads::assemble_with(&problem, &space, |_| 30).map_err(text)?;
        let size = many.as_flattened().iter().fold(0.0, |most: f64, l| most.max(l.abs()));
        let pairs = found.as_flattened().iter().zip(many.as_flattened());
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if !(off <= 1e-13 * size) {
            return Err(format!("degree {power_of}, kink {kink:?}: off by {:e}", off / size));
        }
    }
    Ok(())
}

/// What the supports of a problem leave free, in words, with how far each motion moves the place `x`.
fn free(problem: &Problem, x: [f64; 2]) -> Result<Vec<(String, f64)>, String> {
    let space = Space::new(&problem.mesh, Degree::One);
    let constraints = Constraints::new(problem, &space).map_err(text)?;
    let (_, motions) = constraints.free_motions(&space);
    let said = |m: &signorini::model::FreeMotion| {
        let [ux, uy] = m.at(x);
        (format!("{m}: {}", m.remedy()), ux.hypot(uy))
    };
    Ok(motions.iter().map(said).collect())
}

/// A block held in a point turns about it; rollers leave it free along them. The point is said to be `off` along x.
fn named(off: f64) -> Outcome {
    let cells = Rectangle { width: 4.0, height: 2.0, nx: 4, ny: 2, diagonal: Diagonal::Left };
    let block = || cells.mesh().map(body).map_err(text);
    let expect = |found: Vec<(String, f64)>, words: String| match &found[..] {
        [(said, moved)] if said.contains(&words) && *moved <= 1e-12 => Ok(()),
        _ => Err(format!("{found:?}; expected one: {words}")),
    };
    let vertices = block()?.mesh.vertices().to_vec();
    for (vertex, &[x, y]) in vertices.iter().enumerate() {
        let mut problem = block()?;
        let displacement = [0.01, 0.0].map(|u| Some(constant(u)));
        problem.points.push(PointSupport { name: "pin".to_owned(), vertex, displacement });
        let about = x + off;
        let words = format!(
            "rotation about ({about}, {y}): u_x off the line y = {y} would stop it, or u_y off x = {about}"
        );
        expect(free(&problem, [x, y])?, words)?;
    }
    for (side, held, words) in [
        ("top", [None, Some(constant(0.0))], "translation along (1, 0): u_x would stop it"),
        ("left", [Some(constant(0.0)), None], "translation along (0, 1): u_y would stop it"),
    ] {
        let mut problem = block()?;
        problem.conditions.insert(side.to_owned(), Condition::Displacement(held));
        match &free(&problem, [0.0; 2])?[..] {
            [(said, _)] if said == words => {}
            found => return Err(format!("{found:?}; expected {words}")),
        }
    }
    Ok(())
}

/// The edges of a polygon of `corners` corners are those of a curve where these are many, and are straight where they are few.
fn curved(corners: usize, expected: bool) -> Outcome {
    let mut problem = body(polygon(corners, 1));
    let contact = Condition::contact(|_| 0.0);
    problem.conditions.insert("rim".to_owned(), contact);
    let space = Space::new(&problem.mesh, Degree::One);
    let line = contact_line::assemble(&problem, &space, 1e-3).map_err(text)?;
    match line.iter().position(|edge| edge.geometry.curved != expected) {
        Some(e) => Err(format!("{corners} corners: edge {e} is not what it should be")),
        None => Ok(()),
    }
}

/// The constant of a line is the largest of its triangles', the typical one that in the middle of their order, and a local
/// gamma is reported as its kappa times the limit, all `times` that.
fn ordered(times: f64) -> Outcome {
    for_all(6, (select(&[1, 4, 9][..]), 0_u64..1000), |(nx, seed)| {
        let mesh = moved([nx, 1], seed)?;
        let mut problem = body(mesh);
        let contact = Condition::contact(|_| 0.0);
        problem.conditions.insert("bottom".to_owned(), contact);
        let space = Space::new(&problem.mesh, Degree::One);
        // Each edge by itself: gamma of kappa = 1 is h_T over the constant of its triangle.
        let local = contact_line::Gamma::Local(1.0);
        let line = contact_line::assemble(&problem, &space, local).map_err(text)?;
        let h = |e: &Piece| problem.mesh.diameter(e.edge().triangle);
        let mut constants: Vec<f64> = line.iter().map(|edge| h(edge) / edge.gamma).collect();
        constants.sort_by(f64::total_cmp);
        let found = contact_line::Coercivity::new(&problem, Degree::One).map_err(text)?;
        let largest = constants[constants.len() - 1];
        let expected = [
            (found.constant, largest),
            (found.typical, constants[constants.len() / 2]),
            (found.gamma0(contact_line::Gamma::Local(0.3)), 0.3 / largest),
            (found.gamma0(contact_line::Gamma::Uniform(0.3)), 0.3),
        ];
        for (found, expected) in expected {
            if !abs_diff_eq!(found, times * expected, epsilon = 1e-12 * expected) {
                return Err(format!("{found} and not {expected}"));
            }
        }
        Ok(())
    })
}

/// The edges of a contact line on these sides of a body of twelve cells, whose vertices are numbered and whose edges are listed
/// in any order, follow each other, but for as many `breaks`.
fn chained(sides: &[&str], breaks: usize) -> Outcome {
    let vertices = moved([12, 1], 0)?.vertices().len();
    let data = (0_u64..1000, any_order(vertices), any_order(12 * sides.len()));
    for_all(10, data, |(seed, number, order)| {
        let straight = moved([12, 1], seed)?;
        let mut vertices = vec![[0.0; 2]; number.len()];
        for (&x, &k) in straight.vertices().iter().zip(&number) {
            vertices[k] = x;
        }
        let triangles = straight.triangles().iter().map(|t| t.map(|v| number[v])).collect();
        let mut edges = Vec::new();
        for side in sides {
            let of_side = straight.edges_of(side).map_err(text)?;
            edges.extend(of_side.iter().map(|&edge| straight.ends(edge).map(|v| number[v])));
        }
        let edges = order.into_iter().map(|e| edges[e]).collect();
        let mesh = Mesh::new(vertices, triangles, [("contact".to_owned(), edges)]);
        let mut problem = body(mesh.map_err(text)?);
        let contact = Condition::contact(|_| 0.0);
        problem.conditions.insert("contact".to_owned(), contact);
        let space = Space::new(&problem.mesh, Degree::One);
        let line = contact_line::assemble(&problem, &space, 1e-3).map_err(text)?;
        let ends = |edge: &Piece| problem.mesh.ends(edge.edge());
        let found = line.windows(2).filter(|pair| ends(&pair[0])[1] != ends(&pair[1])[0]).count();
        if (line.len(), found) != (12 * sides.len(), breaks) {
            return Err(format!("{} edges with {found} breaks, expected {breaks}", line.len()));
        }
        Ok(())
    })
}

properties! {
    contact_edges_follow_each_other: chained(&["bottom"], 0), chained(&["bottom", "top"], 1);
        not chained(&["bottom", "top"], 0);
    points_are_found_in_their_triangles: located(0.0); not located(0.01);
    loads_are_integrated_exactly_to_their_degrees: integrated(Degree::One, 0), integrated(Degree::Two, 0);
        not integrated(Degree::One, 2);
    free_motions_are_called_what_they_are: named(0.0); not named(0.25);
    many_corners_are_a_curve: curved(48, true), curved(4, false); not curved(4, true);
    constants_of_a_line_are_its_largest_and_its_middle_one: ordered(1.0); not ordered(1.001);
}
