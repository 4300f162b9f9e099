//! A problem in units of its own, powers of two times those of its case, so that all bodies of one shape are solved with the same
//! numbers: units don't matter. docs/theory.md, 5.10.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::function::{Function, SharedFunction};
use super::mesh::Mesh;
use super::problem::{Condition, PointSupport, Problem, SurfaceForce};
use super::units::{Units, exponent, scaled};
use crate::kernel::Material;

/// Loads on the body are looked at on so many triangles.
const SAMPLES: usize = 4096;

impl Problem {
    /// The units in which the body is between 1 and 2 long, its stiffest material has a modulus between 1 and 2, and the
    /// loads and prescribed displacements, or, where there are none, the gaps, move it by about 1.
    pub fn own_units(&self) -> Units {
        let mesh = &self.mesh;
        let extent = |c: usize| {
            let coordinates = || mesh.vertices().iter().map(|v| v[c]);
            let low = coordinates().fold(f64::INFINITY, f64::min);
            coordinates().fold(f64::NEG_INFINITY, f64::max) - low
        };
        let length = exponent(f64::max(extent(0), extent(1))).unwrap_or(0);
        let stiffness = self.material.distinct().iter().map(Material::normal_stiffness);
        let modulus = stiffness.fold(0.0, f64::max);
        let modulus = exponent(modulus).unwrap_or(0);
        let of_loads = self.size_of_loads(Units::new(length, modulus, 0));
        let displacement = of_loads.or_else(|| size_of_gaps(self)).unwrap_or(length);
        Units::new(length, modulus, displacement)
    }

    /// The binary logarithm of the largest displacement that is prescribed or that a load would cause in a body like this.
    fn size_of_loads(&self, units: Units) -> Option<i32> {
        let mesh = &self.mesh;
        let all = 0..mesh.triangles().len();
        let on_area = |force: &[SharedFunction; 2], triangles: &mut dyn Iterator<Item = usize>| {
            let places = triangles.map(|t| mesh.vertices()[mesh.triangles()[t][0]]);
            let values = places.flat_map(|x| force.each_ref().map(|f| f.at(x)));
            Some(exponent(largest(values))? - units.force_per_area())
        };
        let step = all.len() / SAMPLES + 1;
        let mut sizes = vec![on_area(&self.body_force, &mut all.step_by(step))];
        for SurfaceForce { triangles, force, .. } in &self.surface_forces {
            let step = triangles.len() / SAMPLES + 1;
            sizes.push(on_area(force, &mut triangles.iter().copied().step_by(step)));
        }
        for (name, condition) in &self.conditions {
            let stress = |f: &SharedFunction| {
                let values = along(mesh, name).map(|(x, n)| f.on_boundary(x, n));
                Some(exponent(largest(values))? - units.stress())
            };
            let displacement =
                |f: &SharedFunction| exponent(largest(along(mesh, name).map(|(x, _)| f.at(x))));
            match condition {
                Condition::Displacement(u) => {
                    sizes.extend(u.iter().flatten().map(displacement));
                }
                Condition::Traction(t) => sizes.extend(t.iter().map(stress)),
                Condition::Pressure(p) => sizes.push(stress(p)),
                Condition::Mixed { displacement: u, traction } => {
                    sizes.extend(u.iter().flatten().map(displacement));
                    sizes.extend(traction.iter().map(stress));
                }
                Condition::Support { normal, tangential } => {
                    sizes.extend([normal, tangential].into_iter().flatten().map(displacement));
                }
                Condition::Contact { .. } | Condition::Obstacle(..) => {}
            }
        }
        for PointSupport { vertex, displacement, .. } in &self.points {
            let at = |f: &SharedFunction| exponent(f.at(*mesh.vertices().get(*vertex)?));
            sizes.extend(displacement.iter().flatten().map(at));
        }
        sizes.into_iter().flatten().max()
    }
}

/// The places where the edges of a boundary begin, with their normals.
fn along(mesh: &Mesh, name: &str) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let edges = mesh.edges_of(name).unwrap_or_default();
    edges
        .iter()
        .map(|&edge| (mesh.vertices()[mesh.ends(edge)[0]], mesh.length_and_normal(edge).1.into()))
}

/// The largest magnitude of those that are finite.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|v| v.is_finite()).fold(0.0, |most, v| most.max(v.abs()))
}

/// The binary logarithm of the largest gap.
fn size_of_gaps(problem: &Problem) -> Option<i32> {
    let gaps = problem.conditions.iter().flat_map(|(name, condition)| {
        along(&problem.mesh, name).map(move |(x, _)| match condition {
            Condition::Contact { gap } => gap.at(x),
            Condition::Obstacle(_, obstacle) => {
                obstacle.closest(x, String::new).map_or(0.0, |closest| closest.gap)
            }
            _ => 0.0,
        })
    });
    exponent(largest(gaps))
}

/// A function in other units: of places in units of 2^length, with values in units of 2^value.
struct Seen {
    function: SharedFunction,
    length: i32,
    value: i32,
}

impl Function for Seen {
    fn at(&self, x: [f64; 2]) -> f64 {
        scaled(self.function.at(x.map(|c| scaled(c, self.length))), -self.value)
    }

    fn on_boundary(&self, x: [f64; 2], n: [f64; 2]) -> f64 {
        scaled(self.function.on_boundary(x.map(|c| scaled(c, self.length)), n), -self.value)
    }

    fn degree(&self) -> Option<u32> {
        self.function.degree()
    }

    fn kink(&self) -> Option<f64> {
        self.function.kink().map(|c| scaled(c, -self.length))
    }
}

impl Problem {
    /// The same problem in these units.
    #[must_use]
    pub fn in_units(&self, units: Units) -> Problem {
        let seen = |f: &SharedFunction, value: i32| -> SharedFunction {
            Arc::new(Seen { function: Arc::clone(f), length: units.length(), value })
        };
        let moved = |f: &SharedFunction| seen(f, units.displacement());
        let components =
            |u: &[Option<SharedFunction>; 2]| u.each_ref().map(|u| u.as_ref().map(moved));
        let both = |f: &[SharedFunction; 2], value: i32| f.each_ref().map(|f| seen(f, value));
        let condition = |condition: &Condition| match condition {
            Condition::Displacement(u) => Condition::Displacement(components(u)),
            Condition::Traction(t) => Condition::Traction(both(t, units.stress())),
            Condition::Pressure(p) => Condition::Pressure(seen(p, units.stress())),
            Condition::Mixed { displacement, traction } => Condition::Mixed {
                displacement: components(displacement),
                traction: both(traction, units.stress()),
            },
            Condition::Support { normal, tangential } => Condition::Support {
                normal: normal.as_ref().map(moved),
                tangential: tangential.as_ref().map(moved),
            },
            Condition::Contact { gap } => Condition::Contact { gap: moved(gap) },
            Condition::Obstacle(name, obstacle) => Condition::Obstacle(
                name.clone(),
                obstacle.seen(units.length(), units.displacement()),
            ),
        };
        let surface_force = |f: &SurfaceForce| SurfaceForce {
            surface: f.surface.clone(),
            triangles: f.triangles.clone(),
            force: both(&f.force, units.force_per_area()),
        };
        let point = |p: &PointSupport| PointSupport {
            name: p.name.clone(),
            vertex: p.vertex,
            displacement: components(&p.displacement),
        };
        let conditions = self.conditions.iter().map(|(name, c)| (name.clone(), condition(c)));
        let modulus = |m: &Material<f64>| m.map(|m| scaled(m, -units.modulus()));
        Problem {
            mesh: self.mesh.scaled(-units.length()),
            material: self.material.map(modulus),
            body_force: both(&self.body_force, units.force_per_area()),
            surface_forces: self.surface_forces.iter().map(surface_force).collect(),
            conditions: conditions.collect::<BTreeMap<_, _>>(),
            points: self.points.iter().map(point).collect(),
        }
    }
}
