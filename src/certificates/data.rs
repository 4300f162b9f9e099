//! The loads of a problem as a certificate has them: f affine on triangles and t affine along edges, with the moments of the
//! true ones.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::certificate::Role;
pub(super) use crate::contact::contact_line::bulge_of;
use crate::kernel::{Ball, Enclosing, Triangle};
use crate::model::graded_quadrature::{Features, Rule};
use crate::model::mesh::length;
use crate::model::{Function, Problem, SharedFunction};

/// Quadrature points in each direction.
pub(super) const POINTS: usize = 8;

/// The body forces of a problem as a certificate needs them.
pub(super) struct Data<'a> {
    /// The forces on the whole body, then those on its parts.
    forces: Vec<(&'a [SharedFunction; 2], [Rule; 2])>,
    /// Which of the latter act on a triangle.
    local: BTreeMap<usize, Vec<usize>>,
}

/// The function is a polynomial of at most this degree.
pub(super) fn is_within(function: &SharedFunction, degree: u32) -> bool {
    function.degree().is_some_and(|d| d <= degree)
}

impl<'a> Data<'a> {
    pub(crate) fn new(problem: &'a Problem) -> Self {
        let parts = problem.surface_forces.iter().map(|part| &part.force);
        let all = std::iter::once(&problem.body_force).chain(parts);
        let mut local: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (k, part) in problem.surface_forces.iter().enumerate() {
            part.triangles.iter().for_each(|&t| local.entry(t).or_default().push(k + 1));
        }
        Data { forces: all.map(|f| (f, [0, 1].map(|c| rule(&*f[c])))).collect(), local }
    }

    /// The component c of each force that acts on triangle `t`, with its rule.
    pub(crate) fn acting(&self, t: usize) -> impl Iterator<Item = (usize, &SharedFunction, &Rule)> {
        let here = self.local.get(&t).into_iter().flatten().copied();
        std::iter::once(0).chain(here).flat_map(|k| {
            let (functions, rules) = &self.forces[k];
            (0..2).map(move |c| (c, &functions[c], &rules[c]))
        })
    }

    /// f on a part of triangle `t` at the part's vertices, affine between them: f itself where it is affine, else with the same
    /// moments. f_a = (12 F_a - 3 sum F) / |T| for F_a = int f l_a.
    pub(crate) fn body_on(&self, t: usize, part: &Triangle<f64>) -> [Vector2<f64>; 3] {
        let mut body = [Vector2::zeros(); 3];
        for (c, f, rule) in self.acting(t) {
            let mut add = |values: [f64; 3]| (0..3).for_each(|a| body[a][c] += values[a]);
            match f.degree() {
                Some(0) => add([f.at(part.vertices[0].into()); 3]),
                Some(1) => add(part.vertices.map(|x| f.at(x.into()))),
                _ => {
                    let mut moments = [0.0; 3];
                    rule.on_triangle(part, |l, x, weight| {
                        let value = weight * f.at(x);
                        (0..3).for_each(|a| moments[a] += l[a] * value);
                    });
                    let (total, area) = (moments.iter().sum::<f64>(), part.double_area() / 2.0);
                    add(moments.map(|m| (12.0 * m - 3.0 * total) / area));
                }
            }
        }
        body
    }
}

/// A given traction.
#[derive(Clone, Copy)]
pub(super) enum Traction<'a> {
    /// Its components.
    Vector(&'a [SharedFunction; 2]),
    /// -p n
    Pressure(&'a SharedFunction),
    /// A component; the other is held.
    Component(usize, &'a SharedFunction),
}

impl Traction<'_> {
    /// Returns whether the traction is affine along a straight edge.
    pub(crate) fn is_affine(&self) -> bool {
        match self {
            Traction::Vector(t) => t.iter().all(|f| is_within(f, 1)),
            Traction::Pressure(f) | Traction::Component(_, f) => is_within(f, 1),
        }
    }

    pub(crate) fn at(&self, x: [f64; 2], n: [f64; 2]) -> [f64; 2] {
        match self {
            Traction::Vector(t) => [0, 1].map(|c| t[c].on_boundary(x, n)),
            Traction::Pressure(p) => {
                let pressure = p.on_boundary(x, n);
                n.map(|n| -n * pressure)
            }
            Traction::Component(c, f) => {
                let mut t = [0.0; 2];
                t[*c] = f.on_boundary(x, n);
                t
            }
        }
    }

    pub(crate) fn rule(&self) -> Rule {
        match self {
            // One rule for both components: that of the one that asks for most.
            Traction::Vector([x, y]) => rule(&**if demand(x) > demand(y) { x } else { y }),
            Traction::Pressure(f) | Traction::Component(_, f) => rule(&***f),
        }
    }

    /// int_E t phi for both ends of an edge.
    pub(crate) fn moments(&self, ends: [[f64; 2]; 2]) -> [Vector2<f64>; 2] {
        let (length, unit) = length_and_normal(ends);
        let mut moments = [Vector2::zeros(); 2];
        self.rule().on_edge(ends, [], |point| {
            let t = Vector2::from(self.at(point.x, unit));
            moments[0] += t * ((1.0 - point.s) * point.weight * length);
            moments[1] += t * (point.s * point.weight * length);
        });
        moments
    }

    /// t_h at both ends of an edge: t itself where it is affine, else the affine function that has its moments.
    fn affine_values(&self, ends: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let (length, unit) = length_and_normal(ends);
        if self.is_affine() {
            return ends.map(|x| self.at(x, unit));
        }
        force_of(&self.moments(ends)).map(|f| f.map(|f| f / length))
    }

    /// t_h as the role of an edge.
    pub(crate) fn affine(&self, ends: [[f64; 2]; 2]) -> Role {
        let (_, unit) = length_and_normal(ends);
        let role = match self {
            Traction::Pressure(p) if self.is_affine() => {
                Role::Pressed(ends.map(|x| p.on_boundary(x, unit)))
            }
            Traction::Pressure(_) => {
                Role::Pressed(self.affine_values(ends).map(|t| -(t[0] * unit[0] + t[1] * unit[1])))
            }
            _ => Role::Loaded(self.affine_values(ends)),
        };
        // No load has one role only.
        if role == Role::Pressed([0.0; 2]) { Role::Loaded([[0.0; 2]; 2]) } else { role }
    }

    /// The component of t_h across the direction `d`, along d turned to the left, at both ends.
    pub(crate) fn across(&self, d: [f64; 2], ends: [[f64; 2]; 2]) -> [f64; 2] {
        self.affine_values(ends).map(|t| d[0] * t[1] - d[1] * t[0])
    }
}

/// The affine force, per unit of an edge's parameter, that has the moments `m` with the hat functions of the ends.
pub(super) fn force_of(m: &[Vector2<f64>; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|k| [0, 1].map(|c| 4.0 * m[k][c] - 2.0 * m[1 - k][c]))
}

pub(super) fn length_and_normal(ends: [[f64; 2]; 2]) -> (f64, [f64; 2]) {
    let normal = Vector2::new(ends[1][1] - ends[0][1], ends[0][0] - ends[1][0]);
    let length = length(normal);
    (length, (normal / length).into())
}

/// Orders functions by the rule that they need: those with a kink and those of no known degree come last.
pub(super) fn demand(function: &SharedFunction) -> (bool, u32) {
    (function.kink().is_some(), function.degree().unwrap_or(u32::MAX))
}

/// A rule for a function of the place.
pub(super) fn rule(function: &dyn Function) -> Rule {
    // n points are exact for the square of a polynomial of degree n - 1.
    let known = function.degree().and_then(|degree| usize::try_from(degree).ok());
    let points = known.map_or(POINTS, |degree| POINTS.min(degree + 1));
    Rule::new(Features { kink: function.kink(), singular: None }, points)
}

/// Data that doubles know to this part of their size are taken for known.
const KNOWN: f64 = 1e-10;

/// The amount by which `f` may be off at some of these places, where its terms cancel in doubles and that is not negligible
/// beside its values.
pub(super) fn cancellation(
    f: &SharedFunction,
    places: impl Iterator<Item = [f64; 2]>,
) -> Option<f64> {
    let (mut off, mut size) = (0.0_f64, 0.0_f64);
    for x in places {
        let value = f.at(x);
        let apart = f.enclosed(x)? - Ball::exactly(value);
        let here = apart.upper().max(-apart.lower());
        // A value without a bound is off by any amount.
        off = if here.is_nan() { f64::INFINITY } else { off.max(here) };
        size = size.max(value.abs());
    }
    (off > KNOWN * size).then_some(off)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    /// 1 at x = 0 and less elsewhere, which may be off by so much there.
    struct Rounded(f64);

    impl Function for Rounded {
        fn at(&self, [x, _]: [f64; 2]) -> f64 {
            1.0 - x
        }

        fn enclosed(&self, [x, _]: [f64; 2]) -> Option<Ball> {
            Some(Ball::exactly(1.0 - x) - Ball::exactly(x * self.0))
        }
    }

    #[test]
    fn data_cancel_where_they_are_off_by_more_than_is_known_of_their_largest_value() {
        let places = || [[0.0, 0.0], [1.0, 0.0]].into_iter();
        let found = |off: f64| {
            let f: SharedFunction = Arc::new(Rounded(off));
            cancellation(&f, places())
        };
        for sign in [1.0, -1.0] {
            assert_eq!(found(sign * 0.99e-10), None);
            assert!(found(sign * 1.01e-10).is_some_and(|off| (1.01e-10..1.02e-10).contains(&off)));
        }
        assert_eq!(found(f64::NAN), Some(f64::INFINITY));
        // Control: beside the value there alone it would be off.
        let f: SharedFunction = Arc::new(Rounded(0.99e-10));
        assert!(cancellation(&f, places().skip(1)).is_some());
    }
}
