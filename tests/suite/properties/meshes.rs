//! Meshes on the way to a problem: what is none is refused, vertices that are meant to be one are merged and no others, and a
//! refined problem has the materials and loads of the coarse one; triangles are marked and refined until the target is met.

use std::cell::Cell;
use std::collections::BTreeMap;

use proptest::array::uniform4;
use proptest::collection::vec;
use signorini::certificates::adapt::{THETA, Target, adapt, marked};
use signorini::kernel::{Material, Plane};
use signorini::model::merge::merge;
use signorini::model::{
    Condition, DataError, Diagonal, Materials, Mesh, MeshError, Problem, Rectangle, SurfaceForce,
};
use signorini::solve::{Method, Settings, SolveError, discretize};

use super::{Outcome, for_all, properties, text};
use crate::common::constant;

/// Two squares in one mesh with nothing joined: of side 1 in the origin, and of side `side` with its lower left corner at `at`.
fn squares(at: [f64; 2], side: f64) -> Result<Mesh, MeshError> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let other = corners.map(|[x, y]| [at[0] + side * x, at[1] + side * y]);
    let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    Mesh::new([corners, other].concat(), triangles, [])
}

/// What is said of pairs of squares; a seam is `seam` wide.
fn refused(seam: f64) -> Outcome {
    let near = |e: &MeshError| matches!(e, MeshError::Near { .. });
    let hanging = |e: &MeshError| matches!(e, MeshError::Hanging { .. });
    let overlapping = |e: &MeshError| matches!(e, MeshError::Overlapping { .. });
    type Reason<'a> = Option<&'a dyn Fn(&MeshError) -> bool>;
    let cases: [([f64; 2], f64, Reason); 8] = [
        ([1.1, 0.0], 1.0, None),
        // Beside an edge by a little more than 1e-3 of the smaller square.
        ([1.000_55, 0.3], 0.5, None),
        // Corner to corner, and corner to edge.
        ([1.0 + seam, 0.0], 1.0, Some(&near)),
        ([1.0 + seam, 0.3], 0.5, Some(&hanging)),
        // Across each other in a corner; one inside the other; one on the other.
        ([0.9, 0.9], 1.0, Some(&overlapping)),
        ([0.3, 0.6], 0.2, Some(&overlapping)),
        ([0.6, 0.2], 0.2, Some(&overlapping)),
        ([-0.2, -0.3], 2.0, Some(&overlapping)),
    ];
    for (at, side, expected) in &cases {
        let right = match (squares(*at, *side), expected) {
            (Ok(_), None) => true,
            (Err(error), Some(reason)) => reason(&error),
            _ => false,
        };
        if !right {
            return Err(format!("a square of side {side} at {at:?}: not what was expected"));
        }
    }
    Ok(())
}

/// Vertices are one if and only if a chain of steps within `share` of the body's size joins them, where `told` is asked for.
fn merged(share: f64, told: f64) -> Outcome {
    let joined = Cell::new(0);
    // Places, and others next to them: in tenths of the body, and of three of these steps.
    let places = vec(uniform4(0..=10), 12);
    for_all(40, places, |places: Vec<[i32; 4]>| {
        let mut vertices = vec![[0.0, 0.0], [1.0, 1.0]];
        for place in places {
            let [x, y, dx, dy] = place.map(|c| f64::from(c) / 10.0);
            let by = [dx, dy].map(|c| (2.0 * c - 1.0) * 1.5 * share);
            vertices.extend([[x, y], [x + by[0], y + by[1]]]);
        }
        let extent = |c: usize| {
            let coordinates = || vertices.iter().map(|v| v[c]);
            coordinates().fold(0.0, f64::max) - coordinates().fold(1.0, f64::min)
        };
        let distance = share * extent(0).max(extent(1));
        let merged = merge(&vertices, told, |_, _| false);
        // By spreading the smallest number along steps.
        let mut first: Vec<usize> = (0..vertices.len()).collect();
        for _ in 0..vertices.len() {
            for (i, a) in vertices.iter().enumerate() {
                for (j, b) in vertices.iter().enumerate() {
                    if (a[0] - b[0]).hypot(a[1] - b[1]) <= distance {
                        first[i] = first[i].min(first[j]);
                    }
                }
            }
        }
        for i in 0..vertices.len() {
            for j in 0..i {
                if (first[i] == first[j]) != (merged[i] == merged[j]) {
                    return Err(format!("{:?} and {:?}", vertices[i], vertices[j]));
                }
                joined.set(joined.get() + usize::from(first[i] == first[j]));
            }
        }
        Ok(())
    })?;
    if joined.get() == 0 { Err("nothing was merged".to_owned()) } else { Ok(()) }
}

fn block(load: f64) -> Result<Problem, String> {
    let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Left };
    let mesh = cells.mesh().map_err(text)?;
    let held = Condition::Displacement([0.0, -0.02].map(|u| Some(constant(u))));
    let floor = Condition::contact(|_| 0.01);
    let conditions = BTreeMap::from([("top".to_owned(), held), ("bottom".to_owned(), floor)]);
    let soft = Material::lame(1.0, 1.0, Plane::Strain);
    let parts = [2.0, 3.0].map(|s| Material::lame(s, s, Plane::Strain));
    let members = [vec![1, 4, 5], vec![7, 12]];
    let parts = parts.into_iter().zip(members.iter().map(Vec::as_slice));
    let count = mesh.triangles().len();
    let material = Materials::in_parts(soft, count, parts);
    let mut problem = Problem::new(mesh, material, [0.1, load].map(constant), conditions);
    problem.surface_forces.push(SurfaceForce {
        surface: "part".to_owned(),
        triangles: vec![0, 3, 4, 9],
        force: [0.2, 0.3].map(constant),
    });
    Ok(problem)
}

/// After refinement each triangle has the material and the loads of the one that its middle lies in, but for the loads of the
/// first `without` triangles.
fn refined(without: usize) -> Outcome {
    let (before, coarse) = (block(-0.1)?, block(-0.1)?);
    let newest = coarse.mesh.opposite_longest();
    let finer = coarse.mesh.bisected(&newest, &[2, 4, 9]).map_err(text)?;
    let mut after = coarse.refined(finer);
    after.surface_forces[0].triangles.retain(|&t| t >= without);
    let count = after.mesh.triangles().len();
    for t in 0..count {
        let middle = after.mesh.triangle(t).point([1.0 / 3.0; 3]);
        let (origin, _) = before.mesh.locate(middle.into()).ok_or("a triangle off the body")?;
        let loaded = |problem: &Problem, t| problem.surface_forces[0].triangles.contains(&t);
        if after.material.of(t) != before.material.of(origin) {
            return Err(format!("the material of triangle {t}, a part of {origin}"));
        }
        if loaded(&after, t) != loaded(&before, origin) {
            return Err(format!("the loads on triangle {t}, a part of {origin}"));
        }
    }
    Ok(())
}

/// The marked triangles are the fewest whose shares make up `theta` of the whole; a target is met by the last level and by none
/// before.
fn adapted(theta: f64) -> Outcome {
    for_all(100, vec(0..1000, 20), |thousandths: Vec<i32>| {
        let indicators: Vec<f64> = thousandths.into_iter().map(|i| f64::from(i) / 1000.0).collect();
        let mut squares: Vec<f64> = indicators.iter().map(|i| i * i).collect();
        squares.sort_by(|a, b| b.total_cmp(a));
        let whole: f64 = squares.iter().sum();
        let largest = |count: usize| squares[..count].iter().sum::<f64>();
        let fewest = (1..=20).find(|&n| largest(n) >= theta * whole * (1.0 - 1e-12));
        let found = marked(&indicators);
        let sum: f64 = found.iter().map(|&t| indicators[t] * indicators[t]).sum();
        if Some(found.len()) != fewest || !(sum >= theta * whole * (1.0 - 1e-12)) {
            return Err(format!("marked: {found:?}"));
        }
        Ok(())
    })?;
    let go = |relative: f64| {
        let target = Target { relative, max_unknowns: 4000 };
        adapt(block(-0.1)?, &Method::default(), &Settings::default(), target, &|_| {})
            .map(|(_, adapted)| adapted)
            .map_err(text)
    };
    let first = go(10.0)?.levels[0].relative;
    let relative = first / 2.0;
    let found = go(relative)?;
    let (last, before) = found.levels.split_last().ok_or("no level")?;
    let is_met = |level: &signorini::certificates::adapt::AdaptedLevel| level.relative <= relative;
    let only_last = is_met(last) && !before.iter().any(is_met);
    if before.is_empty() || !(found.unmet.is_none() && only_last) {
        return Err(format!("a target of {relative}: {:?}", found.levels));
    }
    Ok(())
}

/// Data that are not finite are refused: a load, a gap, a prescribed displacement, each of value `value`.
fn not_finite(value: f64) -> Outcome {
    for kind in 0..3 {
        let mut problem = block(if kind == 0 { value } else { -0.1 })?;
        if kind == 1 {
            let floor = Condition::contact(move |_| value);
            problem.conditions.insert("bottom".to_owned(), floor);
        } else if kind == 2 {
            let held = Condition::Displacement([Some(constant(value)), None]);
            problem.conditions.insert("left".to_owned(), held);
            problem.conditions.remove("top");
        }
        match discretize(&problem, &Method::default()) {
            Err(SolveError::Data(DataError::NotFinite { .. })) => {}
            _ => return Err(format!("datum {kind} of value {value} is not called infinite")),
        }
    }
    Ok(())
}

properties! {
    meshes_that_are_none_are_refused: refused(1e-5), refused(0.45e-3); not refused(1e-2);
    vertices_are_merged_by_chains_of_short_steps: merged(1e-3, 1e-3); not merged(1e-3, 0.5e-3);
    refined_problems_have_the_same_materials_and_loads: refined(0); not refined(2);
    meshes_are_refined_until_the_target_is_met: adapted(THETA); not adapted(0.9);
    data_that_are_not_finite_are_refused: not_finite(f64::INFINITY), not_finite(f64::NAN); not not_finite(1e300);
}
