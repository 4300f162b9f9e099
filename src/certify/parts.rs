//! A problem and its discrete solution as certificates see them: what every boundary edge prescribes, and the edges of Gamma_C.

use std::collections::{BTreeMap, BTreeSet};

use super::contact::Contact;
use super::data::{Traction, bulge_of, is_within};
use super::errors::CertifyError;
use crate::fem::constraints::Constraints;
use crate::fem::{BoundaryEdge, Condition, Mesh, Problem, SharedFunction, Space, contact_line};
use crate::kernel::Material;
use crate::kernel::edge_integral::ExactEdge;
use crate::solve::Solution;

/// What a boundary edge prescribes.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// The components that are held, and the functions that they are, if these may be other than affine.
    Held([bool; 2], [Option<&'a SharedFunction>; 2]),
    /// The traction.
    Loaded(Traction<'a>),
    /// Nothing: traction 0.
    Free,
    /// Gamma_C, and which of its edges.
    Contact(usize),
}

/// The parts of a problem that certificates are made from.
pub(super) struct Parts<'a> {
    pub problem: &'a Problem,
    pub mesh: &'a Mesh,
    /// Gamma_C.
    pub contact: Vec<Contact>,
    /// u_D at the vertices.
    pub prescribed: Vec<[Option<f64>; 2]>,
    /// What boundary edges are, by their numbers in the mesh.
    pub boundary: BTreeMap<usize, Boundary<'a>>,
}

impl<'a> Parts<'a> {
    /// # Errors
    /// Conditions that no composite stress can satisfy.
    pub fn new<E, const N: usize, const M: usize>(
        problem: &'a Problem,
        solution: &Solution,
    ) -> Result<Self, CertifyError>
    where
        E: ExactEdge<f64, N, M>,
    {
        let space = Space::<E, N, M>::new(&problem.mesh);
        let constraints = Constraints::new(problem, &space)?;
        let contact = contact_line::assemble(problem, &space, solution.gamma.gamma)?;
        let contact = contact.iter().map(|edge| {
            let u = space.on_triangle(edge.edge.triangle, &solution.displacement);
            Contact::new::<E, N, M>(problem, edge, &u)
        });
        let contact: Vec<Contact> = contact.collect();
        let unsupported = |why: String| Err(CertifyError::Unsupported(why));
        if let Some(motion) = constraints.free_motions(&space).1.first() {
            return unsupported(format!(
                "the supports leave free a {motion}; contact may, but a stress that is proved is balanced by the traction on them: expected supports that hold the body without contact"
            ));
        }
        if let Some(point) = problem.points.first() {
            return unsupported(format!(
                "[point.{}] holds a point, which a true solution does not feel",
                point.name
            ));
        }
        if !constraints.frames().is_empty() {
            return unsupported("a support holds an oblique direction".to_owned());
        }
        let mesh = &problem.mesh;
        let number = |edge: BoundaryEdge| mesh.triangle_edges()[edge.triangle][edge.local];
        let mut boundary: BTreeMap<usize, Boundary> =
            mesh.outline().iter().map(|&edge| (number(edge), Boundary::Free)).collect();
        for (name, condition) in &problem.conditions {
            // The names were found when the problem was discretised.
            for &edge in mesh.edges_of(name).unwrap_or_default() {
                let what = match condition {
                    Condition::Displacement(functions) => Boundary::Held(
                        [functions[0].is_some(), functions[1].is_some()],
                        functions.each_ref().map(Option::as_ref),
                    ),
                    Condition::Mixed { displacement, traction } => {
                        let held = [0, 1].map(|c| displacement[c].is_some());
                        let vanishes = |c: usize| {
                            let t = &traction[c];
                            t.degree() == Some(0) && t.at([0.0; 2]) == 0.0
                        };
                        if !(0..2).all(|c| held[c] || vanishes(c)) {
                            return unsupported(format!(
                                "'{name}' has a traction beside a prescribed component"
                            ));
                        }
                        Boundary::Held(held, displacement.each_ref().map(Option::as_ref))
                    }
                    Condition::Support { normal, tangential } => {
                        let affine = |f: &SharedFunction| is_within(f, 1);
                        if ![normal, tangential].into_iter().flatten().all(affine) {
                            return unsupported(format!("the support of '{name}' is not affine"));
                        }
                        let n = mesh.length_and_normal(edge).1;
                        let held = match (normal.is_some(), tangential.is_some()) {
                            (true, true) => [true, true],
                            (along, across) if n[0] == 0.0 => [across, along],
                            (along, across) if n[1] == 0.0 => [along, across],
                            _ => {
                                return unsupported(format!("'{name}' holds an oblique direction"));
                            }
                        };
                        Boundary::Held(held, [None; 2])
                    }
                    Condition::Traction(traction) => Boundary::Loaded(Traction::Vector(traction)),
                    Condition::Pressure(p) => Boundary::Loaded(Traction::Pressure(p)),
                    Condition::Contact { .. } | Condition::Obstacle(..) => continue,
                };
                let what = match what {
                    Boundary::Held([false, false], _) => Boundary::Free,
                    what => what,
                };
                boundary.insert(number(edge), what);
            }
        }
        for (k, edge) in contact.iter().enumerate() {
            boundary.insert(number(edge.edge), Boundary::Contact(k));
        }
        let prescribed = constraints.values()[..mesh.vertices().len()].to_vec();
        Ok(Parts { problem, mesh, contact, prescribed, boundary })
    }

    /// Gives v the bulges of u_D on Gamma_D.
    pub fn hold_between(&self, bulges: &mut [[f64; 2]]) {
        for (corners, edges) in self.mesh.triangles().iter().zip(self.mesh.triangle_edges()) {
            for (local, &e) in edges.iter().enumerate() {
                let Some(Boundary::Held(held, _)) = self.boundary.get(&e) else { continue };
                let ends = [1, 2].map(|k| self.mesh.vertices()[corners[(local + k) % 3]]);
                let data = self.prescribed_bulge(e, ends);
                (0..2).filter(|&c| held[c]).for_each(|c| bulges[e][c] = data[c]);
            }
        }
    }

    /// u_D beyond the mean of the ends in the middle of an edge of Gamma_D; 0 where it is known to be affine.
    pub fn prescribed_bulge(&self, e: usize, ends: [[f64; 2]; 2]) -> [f64; 2] {
        let Some(Boundary::Held(held, functions)) = self.boundary.get(&e) else { return [0.0; 2] };
        [0, 1].map(|c| match functions[c] {
            Some(f) if held[c] => bulge_of(f, ends),
            _ => 0.0,
        })
    }

    /// The contact boundaries whose direction turns along an edge, so that it and the gap are known at vertices only.
    pub fn turning(&self) -> BTreeSet<&str> {
        let turning = self.contact.iter().filter(|edge| edge.turns());
        turning.map(|edge| &*edge.boundary).collect()
    }

    /// What triangle `t` is made of.
    pub fn material(&self, t: usize) -> &Material<f64> {
        self.problem.material.of(t)
    }
}
