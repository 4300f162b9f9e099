//! The hoop strain of a body of revolution in the stress on a piece of Gamma_C.

use nalgebra::{Matrix2, Vector2};

use crate::kernel::axial::{mass, projected, shares, value_at};
use crate::kernel::triangle::on_edge;
use crate::kernel::{Element, Material, Scalar};

/// The hoop strain in the functional of the stress s(v) = n~ . sigma(v) n on an edge of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct HoopStress<S, const N: usize> {
    /// The part of each node's v_r in s at the two ends of a piece of the edge.
    pub(super) at_ends: [[S; N]; 2],
    /// The sums of these: s of the displacement e_r, which is no rigid motion.
    pub(super) ring: [S; 2],
}

impl<S: Scalar, const N: usize> HoopStress<S, N> {
    /// At the `places` of the ends on edge `i` (mod 3) of a triangle with these `radii`, with the unit outward normal `n` and the
    /// directions n~ at the ends.
    pub(super) fn new<E: Element<N, M>, const M: usize>(
        radii: [S; 3],
        (i, places): (usize, [S; 2]),
        n: Vector2<S>,
        directions: [Vector2<S>; 2],
        material: &Material<S>,
    ) -> Self {
        let mass = mass::<E, S, N, M>(radii);
        let shares = shares::<E, N, M>();
        let (stress, _) = material.stress_of_revolution(Matrix2::zeros(), S::from(1));
        let traction = directions.map(|d| stress.traction(n).dot(&d));
        let at_ends = |means: [S; 3]| {
            let theta = projected(&mass, means, E::POINTS);
            [0, 1].map(|a| traction[a] * value_at::<E, S, N, M>(theta, on_edge(i, places[a])))
        };
        let of_node = |j: usize| at_ends(shares.map(|row| S::from(row[j]) / S::from(30)));
        let nodes: [[S; 2]; N] = std::array::from_fn(of_node);
        let ring = at_ends(shares.map(|row| S::from(row.iter().sum::<i32>()) / S::from(30)));
        HoopStress { at_ends: [0, 1].map(|a| std::array::from_fn(|j| nodes[j][a])), ring }
    }
}
