//! Method (8) on a mesh: all its parts in one place, and its [residual](super::residual) in doubles: zero at the solution on
//! the free degrees of freedom, the reaction on the prescribed ones.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::Vector2;

use super::contact_line::{Coercivity, ContactLine, Gamma};
use super::law::EdgeRule;
use super::piece::{Piece, PieceGeometry};
use super::stress_points::{Nodal, StressPoint, each_stress};
use crate::held::solvability;
use crate::held::solvability::{NotHeld, Slides};
use crate::kernel::PreciseBall;
use crate::linear::dense::inner;
use crate::model::constraints::{Constraints, in_frame};
use crate::model::data::DataError;
use crate::model::element::Degree;
use crate::model::law::{Bound, Law};
use crate::model::loads::LoadVector;
use crate::model::problem::Problem;
use crate::model::revolution;
use crate::model::rigid::FreeMotion;
use crate::model::space::Space;
use crate::model::{loads, material};

/// The data of method (8).
pub struct Discretization<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// V^h without conditions.
    pub space: Space<'a>,
    /// Gamma_D.
    pub constraints: Constraints,
    /// L(v) for every basis function.
    pub load: Vec<[f64; 2]>,
    /// The load with bounds of its rounding.
    pub enclosed_load: Vec<[PreciseBall; 2]>,
    /// C_h of kappa = gamma0 C_h.
    pub coercivity: Coercivity,
    /// gamma along Gamma_C.
    pub(crate) gamma: Gamma,
    /// gamma0 of (7), or the smallest where each triangle has its own.
    pub gamma0: f64,
    /// Gamma_C.
    pub contact: Vec<Piece>,
    /// The rule for the contact terms.
    pub rule: EdgeRule,
    /// The rigid motions that supports leave free, part by part.
    pub(crate) motions: Vec<FreeMotion>,
    /// Where there are any and contact holds the body: those that it does not stop.
    pub(crate) slides: Option<Slides>,
}

/// A functional of a displacement u at every basis function, and for each value the sum of the magnitudes of the products that
/// were added: this sum times the unit roundoff is the size of the rounding error.
#[derive(Clone, Debug)]
pub struct Functional {
    /// The values.
    pub values: Vec<[f64; 2]>,
    /// The sums of magnitudes.
    pub magnitudes: Vec<[f64; 2]>,
    /// a(u, u), from the strains: forces times displacements would cancel where a body moves far and bends little.
    pub(crate) energy: f64,
}

impl Functional {
    fn zero(nodes: usize) -> Self {
        let zero = || vec![[0.0; 2]; nodes];
        Functional { values: zero(), magnitudes: zero(), energy: 0.0 }
    }

    fn add(&mut self, node: usize, value: Vector2<f64>, magnitude: f64) {
        for c in 0..2 {
            self.values[node][c] += value[c];
            self.magnitudes[node][c] += magnitude;
        }
    }
}

impl<'a> Discretization<'a> {
    /// The discretization of `problem` with the given degree of V^h, gamma or gamma0 (as a function of the coercivity constant)
    /// and edge rule.
    ///
    /// # Errors
    /// Materials that are not stable, data that are not finite on the mesh, displacement boundaries that disagree, a rigid
    /// motion that neither they stop nor contact with the loads as they are, no contact boundary, a gamma0 that is not
    /// positive, a rule without points.
    pub fn new<G: Into<Gamma>>(
        problem: &'a Problem,
        degree: Degree,
        gamma: impl FnOnce(&Coercivity) -> G,
        rule: EdgeRule,
    ) -> Result<Self, DataError> {
        Self::of(problem, degree, Box::new(|coercivity| gamma(coercivity).into()), rule)
    }

    /// As [`Discretization::new`], which every caller would compile anew.
    fn of(
        problem: &'a Problem,
        degree: Degree,
        gamma: Box<dyn FnOnce(&Coercivity) -> Gamma + '_>,
        rule: EdgeRule,
    ) -> Result<Self, DataError> {
        for &material in problem.material.distinct() {
            material::stable(material)?;
        }
        problem.mesh.check_apart(problem.conditions.keys().map(String::as_str))?;
        revolution::check(problem)?;
        let space = Space::new(&problem.mesh, degree);
        let line = ContactLine::new(problem, &space)?;
        let coercivity = line.coercivity(problem)?;
        let gamma = gamma(&coercivity);
        let gamma0 = coercivity.gamma0(gamma);
        if !(gamma0 > 0.0 && gamma0.is_finite()) {
            let (what, expected) = ("gamma0", "a positive number");
            return Err(DataError::Value { what, found: gamma0.to_string(), expected });
        }
        if matches!(&rule, EdgeRule::Gauss(points) if points.is_empty()) {
            let (what, expected) = ("the rule for contact edges", "one with points");
            return Err(DataError::Value { what, found: "empty".to_owned(), expected });
        }
        let mut constraints = Constraints::new(problem, &space)?;
        let LoadVector { in_doubles: load, in_balls: enclosed_load } =
            loads::assemble_twice(problem, &space)?;
        let contact = line.with_gamma(problem, &space, gamma);
        let (parts, motions) = constraints.free_motions(&space);
        let mut slides = None;
        if !motions.is_empty() {
            let rounding = rounding_of_directions(&constraints, &space, &contact);
            let sliding = solvability::slides(&motions, &parts, &space, &load, &contact, rounding)
                .map_err(|NotHeld { motions, drive }| {
                    // The force is that of the whole body, the loads are those of a radian.
                    let whole = if problem.material.are_of_revolution() { TAU } else { 1.0 };
                    DataError::RigidMotion { motions, drive: drive.map(|drive| whole * drive) }
                })?;
            constraints = constraints.pinned(&sliding.basis, &vec![[0.0; 2]; space.nodes().len()]);
            slides = Some(sliding);
        }
        Ok(Discretization {
            problem,
            space,
            constraints,
            load,
            enclosed_load,
            coercivity,
            gamma,
            gamma0,
            contact,
            rule,
            motions,
            slides,
        })
    }

    /// The discretization of a body whose motions `slides` are not stopped: one component for each is held where `u` has it.
    #[must_use]
    pub(crate) fn sliding(&self, slides: Slides, u: &[[f64; 2]]) -> Self {
        Discretization {
            constraints: self.constraints.clone().pinned(&slides.basis, u),
            slides: Some(slides),
            space: self.space.clone(),
            load: self.load.clone(),
            enclosed_load: self.enclosed_load.clone(),
            contact: self.contact.clone(),
            rule: self.rule.clone(),
            motions: self.motions.clone(),
            ..*self
        }
    }

    /// The discretization with a given slip bound where this one has Coulomb's friction: at the start, at the end and in the middle of a
    /// piece, from its number and its coefficient.
    #[must_use]
    pub(crate) fn with_slip_bounds(&self, bound: impl Fn(usize, f64) -> [f64; 3]) -> Self {
        let mut contact = self.contact.clone();
        for (e, piece) in contact.iter_mut().enumerate() {
            if let Law::Friction(Bound::Coulomb(mu)) = piece.geometry.law {
                let law = Law::Friction(Bound::Given(bound(e, mu)));
                piece.geometry = Arc::new(PieceGeometry { law, ..(*piece.geometry).clone() });
            }
        }
        Discretization {
            constraints: self.constraints.clone(),
            slides: self.slides.clone(),
            space: self.space.clone(),
            load: self.load.clone(),
            enclosed_load: self.enclosed_load.clone(),
            contact,
            rule: self.rule.clone(),
            motions: self.motions.clone(),
            ..*self
        }
    }

    /// Returns whether piece `e` of Gamma_C presses in no solution, because the loads drive the body away from it or not towards it.
    pub fn is_idle(&self, e: usize) -> bool {
        self.slides.as_ref().is_some_and(|slides| slides.is_idle(e))
    }

    /// The amount by which the directions of supports and of contact may be off because vertices are rounded.
    pub(crate) fn rounding_of_directions(&self) -> f64 {
        rounding_of_directions(&self.constraints, &self.space, &self.contact)
    }

    /// kappa = gamma0 C_h.
    pub fn kappa(&self) -> f64 {
        self.gamma0 * self.coercivity.constant
    }

    /// R(u; v) for every basis function v.
    pub fn residual(&self, u: &[[f64; 2]]) -> Functional {
        let mut r = self.linear_residual(u);
        for piece in &self.contact {
            let force = piece.contribution(&self.rule, &piece.p(u)).force;
            piece.each_force(&piece.p0, &force, |node, f| r.add(node, f, norm_1(f)));
        }
        r
    }

    /// A(u, v) - L(v) for every basis function v.
    pub fn linear_residual(&self, u: &[[f64; 2]]) -> Functional {
        self.linear_residual_by(u)
    }

    /// [`Discretization::linear_residual`] of a displacement that is known to more than double precision.
    pub(crate) fn linear_residual_by(&self, u: &(impl Nodal<f64> + ?Sized)) -> Functional {
        let mut r = self.internal_forces_of(|_| true, u);
        for piece in &self.contact {
            let factors = piece.stress_factors(&piece.stress(u));
            piece.each_force(&piece.sigma_n, &factors, |node, f| r.add(node, f, norm_1(f)));
        }
        for (node, load) in self.load.iter().enumerate() {
            r.add(node, -Vector2::from(*load), load[0].abs().max(load[1].abs()));
        }
        r
    }

    /// a(u, v) = int sigma(u):eps(v) for every basis function v.
    pub fn internal_forces(&self, u: &[[f64; 2]]) -> Functional {
        self.internal_forces_of(|_| true, u)
    }

    /// The share of the triangles with nodes that are `taken` in [`Discretization::internal_forces`].
    pub(crate) fn internal_forces_of(
        &self,
        taken: impl Fn(&[usize]) -> bool,
        u: &(impl Nodal<f64> + ?Sized),
    ) -> Functional {
        let mut forces = Functional::zero(self.space.nodes().len());
        // The lift of no prescribed displacement.
        if u.is_zero() {
            return forces;
        }
        let itself = |triangle| triangle;
        each_stress(&self.space, &self.problem.material, (taken, itself), u, |point| {
            let &StressPoint { nodal, slopes, gradient, weight, .. } = point;
            let [xx, yy, xy] = point.stress.components();
            let shear = xy * (gradient.m12 + gradient.m21);
            forces.energy += weight * (xx * gradient.m11 + yy * gradient.m22 + shear);
            let strain: f64 = nodal.iter().zip(slopes).map(|(u, g)| norm_1(*u) * norm_1(*g)).sum();
            let mut most = weight * material::largest_entry(point.material) * strain;
            if let Some(hoop) = &point.hoop {
                forces.energy += hoop.work();
                most = hoop.most * (most + weight * hoop.stress.abs());
            }
            point.each_force(|node, force, slope| forces.add(node, force, most * norm_1(slope)));
        });
        forces
    }

    /// a(u, u) = int sigma(u):eps(u).
    pub fn strain_energy(&self, u: &[[f64; 2]]) -> f64 {
        self.internal_forces(u).energy
    }

    /// The Euclidean norm of a functional over the free degrees of freedom.
    pub(crate) fn free_norm(&self, functional: &[[f64; 2]]) -> f64 {
        let frames = self.constraints.frames();
        let nodes = functional.iter().zip(self.constraints.values()).enumerate();
        let free = nodes.flat_map(|(node, (&f, prescribed))| {
            let f = frames.get(&node).map_or(f, |&axis| in_frame(axis, f));
            f.into_iter().zip(prescribed).filter(|(_, p)| p.is_none()).map(|(f, _)| f * f)
        });
        free.sum::<f64>().sqrt()
    }

    /// J_h(u) = 1/2 A(u, u) + 1/2 int (1/gamma) \[P(u)\]+^2 - L(u), whose derivative is the residual.
    pub fn energy(&self, u: &[[f64; 2]]) -> f64 {
        let mut energy = self.strain_energy(u) / 2.0 - inner(&self.load, u);
        for piece in &self.contact {
            let contact = piece.contribution(&self.rule, &piece.p(u)).energy;
            energy += contact - piece.squared_stress(u) / 2.0;
        }
        energy
    }
}

fn rounding_of_directions(constraints: &Constraints, space: &Space, contact: &[Piece]) -> f64 {
    let stretches = contact.iter().flat_map(|piece| &piece.geometry.stretches);
    let edges = stretches.map(|stretch| stretch.edge);
    constraints.rounding().max(space.mesh().turned_by_rounding(edges))
}

fn norm_1(v: Vector2<f64>) -> f64 {
    v[0].abs() + v[1].abs()
}

#[cfg(test)]
mod tests {
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    use super::*;
    use crate::contact::EdgeRule;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Mesh, Problem};

    /// Two triangles between these corners, the first side `bottom` and so on.
    fn square(corners: [[f64; 2]; 4], plane: Plane) -> Problem {
        let named = ["bottom", "right", "top", "left"].into_iter().enumerate();
        let named = named.map(|(k, name)| (name.to_owned(), vec![[k, (k + 1) % 4]]));
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], named).unwrap();
        Problem::of(mesh, Material::lame(1.0, 1.0, plane))
            .with("bottom", Condition::contact(|_| 0.0))
    }

    fn discretized(problem: &Problem) -> Discretization<'_> {
        Discretization::new(problem, Degree::One, |c| c.limit() / 2.0, EdgeRule::Exact).unwrap()
    }

    #[test]
    fn forces_on_a_roller_are_free_along_it_and_held_across() {
        // Standing on a corner: rollers on the two upper sides.
        let on_corner = [[0.0, 0.0], [1.0, 1.0], [0.0, 2.0], [-1.0, 1.0]];
        let problem = square(on_corner, Plane::Strain)
            .with("right", Condition::roller())
            .with("top", Condition::roller());
        let d = discretized(&problem);
        let norm = |node: usize, force: [f64; 2]| {
            let mut all = vec![[0.0; 2]; 4];
            all[node] = force;
            d.free_norm(&all)
        };
        // The normals of right and top are (1, 1) and (-1, 1), times the root of 1/2.
        assert_abs_diff_eq!(norm(1, [3.0, 3.0]), 0.0, epsilon = 1e-14);
        assert_relative_eq!(norm(1, [3.0, -3.0]), 18.0_f64.sqrt());
        assert_abs_diff_eq!(norm(3, [-3.0, 3.0]), 0.0, epsilon = 1e-14);
        assert_relative_eq!(norm(3, [3.0, 3.0]), 18.0_f64.sqrt());
        assert_eq!(norm(2, [3.0, 4.0]), 0.0);
        assert_eq!(norm(0, [3.0, 4.0]), 5.0);
    }

    #[test]
    fn a_ring_that_moves_off_the_axis_as_a_whole_is_strained_along_its_hoops() {
        let problem = square([[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]], Plane::Axisymmetric)
            .with("top", Condition::Displacement([None, Some(Arc::new(|_| 0.0))]));
        let d = discretized(&problem);
        // Moved by the same to the bit, and by hardly another amount at one node.
        let [same, other] =
            [[[1.0, 0.5]; 4], [[1.0 + 1e-9, 0.5], [1.0, 0.5], [1.0, 0.5], [1.0, 0.5]]];
        let [forces, near] = [same, other].map(|u| d.internal_forces(&u));
        assert!(forces.energy > 1.0);
        assert_relative_eq!(forces.energy, near.energy, max_relative = 1e-8);
        for (f, g) in forces.values.as_flattened().iter().zip(near.values.as_flattened()) {
            assert_abs_diff_eq!(f, g, epsilon = 1e-8);
        }
        let work: f64 = forces.values.iter().map(|[r, z]| r + 0.5 * z).sum();
        assert_relative_eq!(work, forces.energy, max_relative = 1e-14);
        // The control: along the axis it moves without strain.
        assert_eq!(d.internal_forces(&[[0.0, 0.5]; 4]).energy, 0.0);
    }

    #[test]
    fn a_rule_for_contact_edges_without_points_is_refused_and_one_with_a_point_is_not() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let problem = square(corners, Plane::Strain).with("top", Condition::clamped());
        let by = |points: Vec<(f64, f64)>| {
            let rule = EdgeRule::Gauss(points);
            let d = Discretization::new(&problem, Degree::One, |c| c.limit() / 2.0, rule);
            d.map(|_| ()).map_err(|error| error.to_string())
        };
        let error = by(Vec::new()).unwrap_err();
        assert!(error.contains("the rule for contact edges"), "{error}");
        assert_eq!(by(vec![(0.5, 1.0)]), Ok(()));
    }

    #[test]
    fn what_forces_are_added_up_of_has_the_same_magnitudes_in_a_body_that_is_turned_half_way_round()
    {
        let corners = [[0.0, 0.0], [3.0, 0.5], [2.5, 2.0], [-0.5, 1.5]];
        let u = [[0.5, 0.25], [-1.0, 0.75], [0.25, -2.0], [1.5, 1.0]];
        let opposite = |points: [[f64; 2]; 4]| points.map(|x| x.map(|c| -c));
        let forces = |corners, u: [[f64; 2]; 4]| {
            let problem = square(corners, Plane::Strain)
                .with("right", Condition::clamped())
                .with("top", Condition::traction(|_| -1.0, |_| 2.0));
            let d = discretized(&problem);
            [d.residual(&u), d.linear_residual(&u), d.internal_forces(&u)]
        };
        let straight = forces(corners, u);
        let turned = forces(opposite(corners), opposite(u));
        for (k, (a, b)) in straight.iter().zip(&turned).enumerate() {
            assert_eq!(a.magnitudes, b.magnitudes, "{k}");
            // None is less than what it is the magnitude of, and contact adds to that.
            let pairs = || a.values.as_flattened().iter().zip(a.magnitudes.as_flattened());
            assert!(pairs().all(|(value, most)| value.abs() <= most * (1.0 + 1e-14)), "{k}");
        }
        // Controls: values change their sign but for the load's, and a larger displacement has larger magnitudes.
        assert_ne!(straight[2].values, turned[2].values);
        assert_ne!(
            straight[2].magnitudes,
            forces(corners, u.map(|u| u.map(|c| 2.0 * c)))[2].magnitudes
        );
    }
}
