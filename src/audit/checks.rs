//! Conditions of a certificate that come before its evaluation: its indices name things that exist, its triangles hang
//! together along its edges, v is what is prescribed, and no force acts where nothing holds.

use std::collections::{BTreeMap, BTreeSet};

use thiserror::Error;

use super::balance::Unbalanced;
use super::certificate::{Certificate, Curved, Edge, Law, Lift, Owners, Role, axis, is_oblique};
use crate::kernel::{Ball, Material};

/// Why a certificate proves nothing.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum Rejection {
    #[error("{what} has {found} entries; expected {expected}")]
    Length { what: &'static str, found: usize, expected: usize },
    #[error("{what} {index}: {problem}")]
    Wrong { what: &'static str, index: usize, problem: &'static str },
    #[error("edge {edge} has tau_n = {value} on Gamma_C; expected no tension")]
    Tension { edge: usize, value: f64 },
    #[error(
        "edge {edge} has the traction {shear} across the direction of contact; expected no more than the bound {bound}"
    )]
    Friction { edge: usize, shear: f64, bound: f64 },
    #[error(
        "edge {edge}: v_n - g can't be shown to be <= 0 (a Bernstein coefficient is up to {value}, per unit of length where contact is along the normal)"
    )]
    Penetration { edge: usize, value: f64 },
    #[error("{}; expected the prescribed {expected}", at.says(*found))]
    NotPrescribed { at: Prescribed, found: f64, expected: f64 },
    #[error("triangle {triangle} is not counter-clockwise, or too flat to tell")]
    Orientation { triangle: usize },
    #[error(transparent)]
    Unbalanced(#[from] Unbalanced),
    #[error(
        "triangle {triangle} is not in equilibrium: its tractions and its body force don't balance to rounding"
    )]
    OutOfBalance { triangle: usize },
    #[error("triangle {triangle} claims the share {claimed}; its data give {found}")]
    Share { triangle: usize, claimed: f64, found: f64 },
    #[error("the claimed bound is {claimed}; the data give {found}")]
    Bound { claimed: f64, found: f64 },
    #[error("force {force}: {problem}")]
    Force { force: usize, problem: String },
    #[error("the bound is not a finite number")]
    NotFinite,
}

/// A value of u_D: at a point, or in the middle of an edge beyond the mean of its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prescribed {
    /// The number of the edge in place of that of the point.
    pub is_between: bool,
    /// The number of the point or the edge.
    pub index: usize,
    /// The component; `None` is that along the direction that is held.
    pub component: Option<usize>,
}

impl Prescribed {
    fn says(self, found: f64) -> String {
        let Prescribed { is_between, index, component } = self;
        let (v, along) = match component {
            Some(c) => (["v_x", "v_y"][c], ""),
            None => ("v . d", " along the direction that is held"),
        };
        if is_between {
            format!("edge {index}: in the middle {v} is {found} beyond the mean of the ends{along}")
        } else {
            format!("point {index}: {v} = {found}{along}")
        }
    }
}

const AXES: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// The error of an edge along which p d is not affine.
pub(super) const VARIES: &str = "a pressure that varies along a direction that turns";

/// v . d is w: to rounding where d is oblique, for there doubles can't be nearer.
fn check_along(v: [f64; 2], d: [f64; 2], w: f64, at: Prescribed) -> Result<(), Rejection> {
    let [x, y] = [v[0] * d[0], v[1] * d[1]];
    let allowed =
        if is_oblique(d) { 16.0 * f64::EPSILON * (x.abs() + y.abs() + w.abs()) } else { 0.0 };
    check_value((x + y - w).abs() <= allowed, at, x + y, w)
}

fn check_value(is: bool, at: Prescribed, found: f64, expected: f64) -> Result<(), Rejection> {
    if is { Ok(()) } else { Err(Rejection::NotPrescribed { at, found, expected }) }
}

/// The law has finite entries and positive eigenvalues.
fn is_elliptic(material: &Material<f64>) -> bool {
    let pivots = || material.map(Ball::point).squares().pivots();
    material.stiffness().iter().all(|c| c.is_finite()) && pivots().iter().all(|p| p.lower() > 0.0)
}

/// d has a length between 1/2 and 2.
fn has_length(d: [f64; 2]) -> bool {
    (0.25..=4.0).contains(&(d[0] * d[0] + d[1] * d[1]))
}

/// A point with supports along `all` of these directions is held along d: by the first one, or all round by two.
fn is_held(all: &[[f64; 2]], d: [f64; 2]) -> bool {
    let is_along_first = |d: [f64; 2]| all.first().is_some_and(|f| f[0] * d[1] == f[1] * d[0]);
    is_along_first(d) || !all.iter().all(|&other| is_along_first(other))
}

pub(super) fn wrong(what: &'static str, index: usize, problem: &'static str) -> Rejection {
    Rejection::Wrong { what, index, problem }
}

fn require(
    holds: bool,
    what: &'static str,
    index: usize,
    problem: &'static str,
) -> Result<(), Rejection> {
    if holds { Ok(()) } else { Err(wrong(what, index, problem)) }
}

/// There are as many entries as there should be.
pub(super) fn length(what: &'static str, found: usize, expected: usize) -> Result<(), Rejection> {
    if found == expected { Ok(()) } else { Err(Rejection::Length { what, found, expected }) }
}

fn is_finite(values: &[f64]) -> bool {
    values.iter().all(|x| x.is_finite())
}

fn are_finite(what: &'static str, values: &[[f64; 2]]) -> Result<(), Rejection> {
    let mut all = values.iter().enumerate();
    all.try_for_each(|(i, x)| require(is_finite(x), what, i, "a number is not finite"))
}

impl Certificate {
    /// The fields have the lengths that they should, and their numbers are finite.
    pub(super) fn check_fields(&self) -> Result<(), Rejection> {
        let (vertices, cuts, edges) = (self.vertices.len(), self.cuts.len(), self.edges.len());
        length("displacement", self.displacement.len(), vertices)?;
        length("prescribed", self.prescribed.len(), vertices)?;
        are_finite("displacement", &self.displacement)?;
        if let Some(Curved { at_cuts, prescribed, bulges, data }) = &self.curved {
            length("prescribed at cuts", prescribed.len(), cuts)?;
            for (what, values, expected) in [
                ("v at cuts", at_cuts, cuts),
                ("bulges", bulges, edges),
                ("bulges of data", data, edges),
            ] {
                length(what, values.len(), expected)?;
                are_finite(what, values)?;
            }
        }
        for (i, edge) in self.edges.iter().enumerate() {
            let numbers = match edge.role {
                Role::Inner(f) | Role::Held(_, f) | Role::Loaded(f) => is_finite(f.as_flattened()),
                Role::Pressed(p) => is_finite(&p),
                Role::Supported { along, force, traction } => {
                    is_finite(&force) && is_finite(&traction) && has_length(along)
                }
                Role::Contact { pressure, gap, along, law } => {
                    let beside = match law {
                        Law::Friction { bound, .. } => bound,
                        _ => law.offset(),
                    };
                    [pressure, gap, law.shear(), beside].iter().all(|numbers| is_finite(numbers))
                        && along.is_none_or(|d| is_finite(d.as_flattened()))
                }
                Role::Facing => true,
            };
            require(numbers, "edge", i, "expected finite numbers")?;
        }
        Ok(())
    }

    /// The indices name things that exist, and the numbers are finite.
    pub(super) fn check_shape(&self) -> Result<(), Rejection> {
        self.check_fields()?;
        let (vertices, points) = (self.vertices.len(), self.vertices.len() + self.cuts.len());
        if self.pieces.is_empty() {
            return Err(Rejection::Length { what: "triangles", found: 0, expected: 1 });
        }
        are_finite("vertex", &self.vertices)?;
        for (i, cut) in self.cuts.iter().enumerate() {
            let lies = 0.0 < cut.at && cut.at < 1.0 && cut.ends.iter().all(|&end| end < vertices);
            require(lies, "cut", i, "expected a place between two vertices")?;
        }
        let mut elliptic = None;
        for (i, piece) in self.pieces.iter().enumerate() {
            let exists = piece.vertices.iter().all(|&p| p < points)
                && piece.edges.iter().all(|&e| e < self.edges.len());
            require(exists, "triangle", i, "a vertex or an edge does not exist")?;
            // Neighbours mostly have one material.
            if elliptic != Some(piece.material) {
                elliptic = is_elliptic(&piece.material).then_some(piece.material);
            }
            require(
                is_finite(piece.body.as_flattened()) && elliptic.is_some(),
                "triangle",
                i,
                "expected mu > 0, lambda + mu > 0 (a tensor with positive eigenvalues) and a finite body force",
            )?;
            let measured = piece.oscillation >= 0.0 && piece.oscillation.is_finite();
            require(measured, "triangle", i, "expected an oscillation that is not negative")?;
        }
        for (&point, &d) in &self.frames {
            let is_held = matches!(self.at_own(point), Some((_, [Some(_), None])));
            let right = is_held && has_length(d) && is_oblique(d);
            require(right, "point", point, "expected a value along an oblique direction")?;
        }
        for (i, &Edge { ends: [a, b], .. }) in self.edges.iter().enumerate() {
            let is_edge = a < points && b < points && a != b;
            require(is_edge, "edge", i, "expected two different vertices")?;
        }
        let mut lifted = BTreeSet::new();
        for (i, &Lift { mut corners, norm }) in self.lifts.iter().enumerate() {
            corners.sort_unstable();
            let distinct = corners[0] < corners[1] && corners[1] < corners[2];
            let measured = norm >= 0.0 && norm.is_finite();
            let right = distinct && corners[2] < vertices && measured && lifted.insert(corners);
            require(right, "lift", i, "expected a triangle of its own and its norm")?;
        }
        for (i, &e) in self.polygon.iter().enumerate() {
            require(e < self.edges.len(), "edge of the polygon", i, "this edge does not exist")?;
        }
        self.check_facing()?;
        self.check_laws()
    }

    /// Tractions are within the bounds of friction; and where two bodies are tied, each point of the first one has one place on the
    /// second, which is tied to none, and its v is what is prescribed there.
    fn check_laws(&self) -> Result<(), Rejection> {
        let (mut ties, mut seconds) = (BTreeMap::new(), BTreeSet::new());
        for (e, edge) in self.edges.iter().enumerate() {
            let Role::Contact { pressure, gap, along, law } = edge.role else { continue };
            if let Law::Friction { shear, bound } = law
                && let Some(k) = (0..2).find(|&k| !(shear[k].abs() <= bound[k]))
            {
                return Err(Rejection::Friction { edge: e, shear: shear[k], bound: bound[k] });
            }
            if !law.is_tied() {
                continue;
            }
            let is_right = |[d, end]: &[[f64; 2]; 2]| {
                let along = match law {
                    Law::Sliding => d == end || d[0] * end[1] != d[1] * end[0],
                    _ => [d, end] == [&AXES[0]; 2],
                };
                has_length(*d) && has_length(*end) && along && self.curved.is_some()
            };
            let (Some(&other), Some(d)) = (self.facing.get(&e), along.filter(is_right)) else {
                return Err(wrong("edge", e, "expected two bodies, tied along a direction"));
            };
            let varies = d[0] != d[1] && pressure[0] != pressure[1];
            require(!varies, "edge", e, VARIES)?;
            for (k, p) in edge.ends.into_iter().enumerate() {
                let second = self.edges[other].ends[1 - k];
                let jump = [gap[k], law.offset()[k]];
                let tie = (second, law.is_bonded(), d[k], jump);
                seconds.insert(second);
                let is_one = *ties.entry(p).or_insert(tie) == tie;
                require(is_one, "point", p, "is tied to two places")?;
            }
        }
        for (&p, &(second, is_bonded, d, jump)) in &ties {
            let (Some((_, given)), Some((there, _))) = (self.at_own(p), self.at_own(second)) else {
                return Err(wrong("point", p, "is tied, and has no value of its own"));
            };
            let is_moved = |c: usize| is_bonded || d[c] != 0.0;
            let slides = !is_bonded && axis(d).is_none();
            let is_given = |c: usize| match given[c] {
                None => true,
                Some(_) if !is_moved(c) => axis(d).is_some(),
                // The other component is moved.
                Some(_) if slides && given[1 - c].is_none() => true,
                Some(value) => {
                    jump[usize::from(is_bonded && c == 1)] == 0.0
                        && there[c] == value
                        && !self.frames.contains_key(&second)
                }
            };
            let moves = seconds.contains(&p) || self.frames.contains_key(&p);
            let right = !moves && is_given(0) && is_given(1);
            require(right, "point", p, "is tied to another place than what is prescribed")?;
        }
        Ok(())
    }

    /// The edges of two bodies face each other one to one, and contact between them has a direction.
    fn check_facing(&self) -> Result<(), Rejection> {
        let is_pair = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|e| self.edges.get(e).map(|edge| edge.role));
            matches!((a, b), (Some(Role::Contact { along: Some(_), .. }), Some(Role::Facing)))
        };
        for (&e, &other) in &self.facing {
            let faces =
                self.facing.get(&other) == Some(&e) && (is_pair(e, other) || is_pair(other, e));
            require(faces, "edge", e, "expected contact along a direction and what faces it")?;
        }
        for (e, edge) in self.edges.iter().enumerate() {
            let is_alone = edge.role == Role::Facing && !self.facing.contains_key(&e);
            require(!is_alone, "edge", e, "faces no edge")?;
        }
        Ok(())
    }

    /// v = u_D at both ends of the edges of Gamma_D, nothing is prescribed elsewhere, and there is no force in a direction
    /// that is not held.
    pub(super) fn check_displacement(&self) -> Result<(), Rejection> {
        let count = self.vertices.len() + self.curved.as_ref().map_or(0, |_| self.cuts.len());
        let mut held_at = vec![Vec::new(); count];
        for edge in &self.edges {
            for point in edge.ends {
                let Some(at) = held_at.get_mut(point) else { continue };
                match edge.role {
                    Role::Held(held, _) => {
                        at.extend((0..2).filter(|&c| held[c]).map(|c| AXES[c]));
                    }
                    Role::Supported { along, .. } => at.push(along),
                    _ => {}
                }
            }
        }
        for (point, held) in held_at.iter().enumerate() {
            let Some((_, data)) = self.at_own(point) else { continue };
            let frame = self.frames.get(&point);
            let axes = frame.map_or(AXES, |&d| [d, d]);
            let is_right = (0..2).all(|c| data[c].is_none() || is_held(held, axes[c]));
            require(is_right, "point", point, "a prescribed value off Gamma_D")?;
        }
        for (e, edge) in self.edges.iter().enumerate() {
            match edge.role {
                Role::Held(held, force) => {
                    let pulls = |c: usize| force[0][c] != 0.0 || force[1][c] != 0.0;
                    let is_free = (0..2).any(|c| !held[c] && pulls(c));
                    require(!is_free, "edge", e, "a force where nothing is held")?;
                    for point in edge.ends {
                        self.check_components(e, point, held)?;
                    }
                }
                Role::Supported { along, .. } => {
                    for point in edge.ends {
                        self.check_along(e, point, along)?;
                    }
                }
                _ => {}
            }
        }
        self.curved.as_ref().map_or(Ok(()), |curved| self.check_between(curved))
    }

    /// v = u_D at an end of edge `e` in the components that are held.
    fn check_components(&self, e: usize, point: usize, held: [bool; 2]) -> Result<(), Rejection> {
        let missing = || wrong("edge", e, "an end without a prescribed value");
        let (v, data) = self.at_own(point).ok_or_else(missing)?;
        if self.frames.contains_key(&point) {
            return Err(missing());
        }
        for component in (0..2).filter(|&c| held[c]) {
            let (found, expected) = (v[component], data[component].ok_or_else(missing)?);
            let at = Prescribed { is_between: false, index: point, component: Some(component) };
            check_value(found == expected, at, found, expected)?;
        }
        Ok(())
    }

    /// v . d is prescribed at an end of edge `e`: along that d, along an axis that d is, or with both components, and then w
    /// = v . d.
    fn check_along(&self, e: usize, point: usize, d: [f64; 2]) -> Result<(), Rejection> {
        let missing =
            || wrong("edge", e, "an end without a value along the direction that is held");
        let Some(&frame) = self.frames.get(&point) else {
            let oblique = is_oblique(d);
            return self.check_components(e, point, d.map(|c| oblique || c != 0.0));
        };
        let (v, data) = self.at_own(point).ok_or_else(missing)?;
        let expected = data[0].filter(|_| frame == d).ok_or_else(missing)?;
        let at = Prescribed { is_between: false, index: point, component: None };
        check_along(v, d, expected, at)
    }

    /// v = u_D between the ends of the edges of Gamma_D, and there are bulges of data where there are such data only.
    fn check_between(&self, curved: &Curved) -> Result<(), Rejection> {
        for (e, edge) in self.edges.iter().enumerate() {
            let (bulge, data) = (curved.bulges[e], curved.data[e]);
            let held = match edge.role {
                Role::Held(held, _) => held,
                Role::Contact { law, .. } => [data[0] != 0.0, law.is_bonded() && data[1] != 0.0],
                Role::Supported { along: d, .. } => {
                    let at = Prescribed { is_between: true, index: e, component: None };
                    check_along(bulge, d, data[0], at)?;
                    [data[0] != 0.0, false]
                }
                Role::Inner(_) | Role::Loaded(_) | Role::Pressed(_) | Role::Facing => [false; 2],
            };
            let is_held = matches!(edge.role, Role::Held(..));
            for component in 0..2 {
                let (found, expected) = (bulge[component], data[component]);
                let is_data = held[component] || expected == 0.0;
                require(is_data, "edge", e, "a bulge of data where there are none")?;
                let at = Prescribed { is_between: true, index: e, component: Some(component) };
                let is_free = !(is_held && held[component]);
                check_value(is_free || found == expected, at, found, expected)?;
            }
        }
        Ok(())
    }

    /// The triangles of each edge.
    pub(super) fn owners(&self) -> Result<Owners, Rejection> {
        let mut owners = vec![[None; 2]; self.edges.len()];
        for (t, piece) in self.pieces.iter().enumerate() {
            for local in 0..3 {
                let e = piece.edges[local];
                let seen = [piece.vertices[(local + 1) % 3], piece.vertices[(local + 2) % 3]];
                let [a, b] = self.edges[e].ends;
                let other = || wrong("triangle", t, "one of its edges joins other vertices");
                let side = [[a, b], [b, a]].iter().position(|ends| seen == *ends);
                let side = side.ok_or_else(other)?;
                let is_second = owners[e][side].replace(t).is_some();
                require(!is_second, "edge", e, "two triangles on the same side")?;
            }
        }
        for (e, (owner, edge)) in owners.iter().zip(&self.edges).enumerate() {
            let inner = matches!(edge.role, Role::Inner(_));
            require(
                owner[0].is_some() && owner[1].is_some() == inner,
                "edge",
                e,
                "expected two triangles at an inner edge, one on the left at others",
            )?;
        }
        Ok(owners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::Cut;
    use crate::certificate::tests::piece;

    #[test]
    fn a_cut_lies_between_its_ends() {
        let answer = |at: f64| {
            let certificate = Certificate {
                vertices: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
                displacement: vec![[0.0; 2]; 3],
                prescribed: vec![[None; 2]; 3],
                cuts: vec![Cut { ends: [0, 1], at }],
                pieces: vec![piece([0, 1, 2], [0; 3], 1.0)],
                ..Certificate::default()
            };
            certificate.check_shape()
        };
        let refused = Err(wrong("cut", 0, "expected a place between two vertices"));
        for at in [0.0, -0.0, -0.5, 1.0, 1.5, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(answer(at), refused, "{at}");
        }
        // Control: between them it is something else that is missing.
        for at in [f64::MIN_POSITIVE, 0.5, 1.0 - f64::EPSILON] {
            assert_ne!(answer(at), refused, "{at}");
        }
    }

    #[test]
    fn a_point_is_held_all_round_by_directions_that_are_neither_one_nor_opposite() {
        for again in [[3.0, 4.0], [-3.0, -4.0], [6.0, 8.0]] {
            let held = |d| is_held(&[[3.0, 4.0], again], d);
            assert!(held([-1.5, -2.0]) && !held([1.0, 0.0]) && !held([4.0, 3.0]));
        }
        // Controls: another direction holds it all round, and none does not.
        assert!(is_held(&[[3.0, 4.0], [-3.0, -4.0], [4.0, 3.0]], [1.0, 0.0]));
        assert!(!is_held(&[], [1.0, 0.0]));
    }
}
