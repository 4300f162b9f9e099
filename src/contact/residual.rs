//! The loops of the residual of method (8),
//!
//! R(u; v) = A(u, v) + int (1/gamma) \[P(u)\]+ P0(v) - L(v),
//!
//! over any numbers, for every basis function v and straight from the definitions: stresses are integrated against strains,
//! no matrix is involved. The solver uses doubles ([`Discretization::residual`]), and
//! [double-doubles](crate::kernel::double_double) where forces cancel; balls bound the rounding; over rationals `props`
//! compares the loops with the definitions.

use nalgebra::Vector2;

use super::discretization::Discretization;
use super::piece::{Piece, Side, SideData, Stretch};
use super::stress_points::each_stress;
use crate::kernel::DoubleDouble;
use crate::kernel::{Scalar, Triangle};
use crate::model::material::Materials;
use crate::model::space::Space;

/// Adds a(u, v) for every basis function v.
pub fn add_internal_forces<S: Scalar + From<f64>>(
    space: &Space,
    materials: &Materials,
    u: &[[S; 2]],
    forces: &mut [[S; 2]],
) {
    add_forces_of(space, materials, |_| true, (u, forces));
}

/// Adds to a(u, v) what the triangles with nodes that are `taken` have in it.
fn add_forces_of<S: Scalar + From<f64>>(
    space: &Space,
    materials: &Materials,
    taken: impl Fn(&[usize]) -> bool,
    (u, forces): (&[[S; 2]], &mut [[S; 2]]),
) {
    each_stress(space, materials, (taken, exactly), u, |point| {
        point.each_force(|node, force, _| {
            forces[node][0] += force[0];
            forces[node][1] += force[1];
        });
    });
}

/// A(u, v) - L(v) for every basis function v, with these pieces of Gamma_C.
pub fn linear_residual<S: Scalar + From<f64>>(
    d: &Discretization,
    pieces: &[Piece<S>],
    u: &[[S; 2]],
) -> Vec<[S; 2]> {
    let nothing = vec![[S::from(0); 2]; u.len()];
    residual_with(d, pieces, (|_| true, nothing), u)
}

/// [`linear_residual`], the triangles whose nodes are not `taken` having these forces.
fn residual_with<S: Scalar + From<f64>>(
    d: &Discretization,
    pieces: &[Piece<S>],
    (taken, mut forces): (impl Fn(&[usize]) -> bool, Vec<[S; 2]>),
    u: &[[S; 2]],
) -> Vec<[S; 2]> {
    for (force, load) in forces.iter_mut().zip(&d.load) {
        *force = [0, 1].map(|c| force[c] - <S as From<f64>>::from(load[c]));
    }
    add_forces_of(&d.space, &d.problem.material, taken, (u, &mut forces));
    pieces.iter().for_each(|piece| piece.add_stresses(u, &mut forces));
    forces
}

/// A(u, v) - L(v) for every basis function v, and the values of P(u) at the nodes of each piece, by double-doubles; the triangles whose
/// nodes are not `taken` have the forces `others`.
pub fn evaluate(
    d: &Discretization,
    u: &[[DoubleDouble; 2]],
    (taken, others): (impl Fn(&[usize]) -> bool, &[[f64; 2]]),
) -> (Vec<[f64; 2]>, Vec<DoubleDouble>) {
    let pieces: Vec<Piece<DoubleDouble>> = d.contact.iter().map(|e| exact_piece(d, e)).collect();
    let others = others.iter().map(|f| f.map(DoubleDouble::from)).collect();
    let forces = residual_with(d, &pieces, (taken, others), u);
    let p = pieces.iter().flat_map(|piece| piece.p(u)).collect();
    (forces.into_iter().map(|f| f.map(DoubleDouble::head)).collect(), p)
}

/// A piece of doubles in other numbers.
pub fn exact_piece<S: Scalar + From<f64>>(d: &Discretization, piece: &Piece) -> Piece<S> {
    let exact = <S as From<f64>>::from;
    piece_with(d, piece, |side, _| (exact(side.length), side.normal.map(exact), exact(side.gamma)))
}

/// A piece whose sides have these lengths of their edges, normals and gammas.
pub fn piece_with<S: Scalar + From<f64>>(
    d: &Discretization,
    piece: &Piece,
    numbers: impl Fn(&Side, &Stretch) -> (S, Vector2<S>, S),
) -> Piece<S> {
    let data = |(side, stretch): (&Side, &Stretch)| {
        let (length, normal, gamma) = numbers(side, stretch);
        let t = stretch.edge.triangle;
        let (doubles, material) = (d.space.mesh().triangle(t), d.problem.material.of(t));
        let radii = material.radii(&doubles).map(|radii| radii.map(<S as From<f64>>::from));
        let material = material.map(<S as From<f64>>::from);
        SideData { triangle: exactly(doubles), material, length, normal, gamma, radii }
    };
    let sides: Vec<SideData<S>> =
        piece.sides.iter().zip(&piece.geometry.stretches).map(data).collect();
    Piece::new(&piece.geometry, &d.space, piece.start, &sides)
}

/// A triangle of doubles in other numbers, moved so that its first vertex is the origin: far from there sides lose digits.
pub fn exactly<S: Scalar + From<f64>>(t: Triangle<f64>) -> Triangle<S> {
    let first = t.vertices[0];
    let moved = |x: f64, from: f64| {
        let difference = DoubleDouble::sum(x, -from);
        S::from(difference.head()) + S::from(difference.tail())
    };
    Triangle { vertices: t.vertices.map(|x| x.zip_map(&first, moved)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_that_doubles_round_are_exact() {
        let [a, b, c] = [[0.1, 1e8], [1e8, 0.1], [1e8, 1e8]];
        let t = Triangle { vertices: [a, b, c].map(Vector2::from) };
        let moved: Triangle<DoubleDouble> = exactly(t);
        for (vertex, at) in moved.vertices.iter().zip([a, b, c]) {
            for i in 0..2 {
                let off = vertex[i] + DoubleDouble::from(a[i]) - DoubleDouble::from(at[i]);
                assert_eq!(off.head(), 0.0);
            }
        }
        // The control: a double does not hold them.
        let rounded = DoubleDouble::from(b[0] - a[0]) + DoubleDouble::from(a[0]);
        assert_ne!((rounded - DoubleDouble::from(b[0])).head(), 0.0);
    }
}
