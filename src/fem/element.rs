//! The element of V^h chosen at run time: shapes, nodes and polynomials on an edge as the elements of the kernel, `P1` and `P2`,
//! have them, for a [`Degree`]. What sums over all triangles goes through `with_element` and is compiled for each element.

use nalgebra::{SMatrix, SVector};

use crate::kernel::contact_edge;
use crate::kernel::edge_integral;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{Element, P1, P2, Scalar};

/// The polynomial degree of V^h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degree {
    /// P1, section 2.2.
    One,
    /// P2, Remark 3.7.
    Two,
}

/// Calls a function that is generic over the element, its nodes on a triangle and those on an edge, for a degree.
macro_rules! with_element {
    ($degree:expr, $f:ident$(::<$other:ty>)?($($argument:expr),* $(,)?)) => {
        match $degree {
            $crate::fem::Degree::One => {
                $f::<$crate::kernel::P1, 3, 2 $(, $other)?>($($argument),*)
            }
            $crate::fem::Degree::Two => {
                $f::<$crate::kernel::P2, 6, 3 $(, $other)?>($($argument),*)
            }
        }
    };
}
pub(crate) use with_element;

impl Degree {
    /// 1 or 2.
    pub fn number(self) -> usize {
        match self {
            Degree::One => 1,
            Degree::Two => 2,
        }
    }

    /// The nodes on a triangle: 3 or 6.
    pub fn nodes_per_triangle(self) -> usize {
        match self {
            Degree::One => 3,
            Degree::Two => 6,
        }
    }

    /// The nodes on an edge: 2 or 3.
    pub fn nodes_per_edge(self) -> usize {
        self.number() + 1
    }

    /// The nodes of a triangle on its edge `i` (mod 3): start, end, then the midpoint if there is one.
    pub fn edge_nodes(self, i: usize) -> Vec<usize> {
        match self {
            Degree::One => P1::edge_nodes(i).into(),
            Degree::Two => P2::edge_nodes(i).into(),
        }
    }

    /// Where on an edge its nodes lie, from 0 to 1.
    pub fn edge_positions(self) -> Vec<f64> {
        match self {
            Degree::One => P1::edge_positions().into(),
            Degree::Two => P2::edge_positions().into(),
        }
    }

    /// The shape functions of an edge at `s` in \[0, 1\].
    pub fn edge_values<S: Scalar>(self, s: S) -> Vec<S> {
        match self {
            Degree::One => P1::edge_values(s).into(),
            Degree::Two => P2::edge_values(s).into(),
        }
    }

    /// The shape functions at the barycentric coordinates `l`.
    pub fn values<S: Scalar>(self, l: [S; 3]) -> Vec<S> {
        match self {
            Degree::One => P1::values(l).into(),
            Degree::Two => P2::values(l).into(),
        }
    }

    /// The gradient du_i/dx_j at `l` of a displacement with these values at the nodes of the triangle.
    pub fn displacement_gradient<S: Scalar, const D: usize>(
        self,
        l: [S; 3],
        barycentric: [SVector<S, D>; 3],
        nodal: impl Fn(usize) -> SVector<S, D>,
    ) -> SMatrix<S, D, D> {
        match self {
            Degree::One => {
                displacement_gradient(&std::array::from_fn(&nodal), &P1::gradients(l, barycentric))
            }
            Degree::Two => {
                displacement_gradient(&std::array::from_fn(&nodal), &P2::gradients(l, barycentric))
            }
        }
    }

    /// The share of an edge in kappa_T / gamma0 of its triangle: [`contact_edge::coercivity_constant`].
    pub fn coercivity_constant<S: Scalar>(
        self,
        stiffness: S,
        diameter: S,
        contact_length: S,
        area: S,
    ) -> S {
        match self {
            Degree::One => contact_edge::coercivity_constant::<P1, S, 3, 2>(
                stiffness,
                diameter,
                contact_length,
                area,
            ),
            Degree::Two => contact_edge::coercivity_constant::<P2, S, 6, 3>(
                stiffness,
                diameter,
                contact_length,
                area,
            ),
        }
    }

    /// The amount by which the length of an edge counts more where the direction of contact turns:
    /// [`contact_edge::turning_factor`].
    pub fn turning_factor<S: Scalar>(self, cosine: S) -> S {
        match self {
            Degree::One => contact_edge::turning_factor::<P1, S, 3, 2>(cosine),
            Degree::Two => contact_edge::turning_factor::<P2, S, 6, 3>(cosine),
        }
    }

    /// Calls `f` at the points, with their weights, of a rule that is exact for a product of two gradients.
    pub fn at_stiffness_points<S: Scalar>(self, f: impl FnMut([S; 3], S)) {
        match self {
            Degree::One => P1::at_stiffness_points(f),
            Degree::Two => P2::at_stiffness_points(f),
        }
    }
}

/// The value at `s` of the polynomial on an edge with these values at its nodes, two or three.
pub fn value_at<S: Scalar>(p: &[S], s: S) -> S {
    match *p {
        [start, end] => edge_integral::value_at::<P1, S, 3, 2>([start, end], s),
        _ => edge_integral::value_at::<P2, S, 6, 3>([p[0], p[1], p[2]], s),
    }
}

/// The places inside (0, 1) where it changes its sign, in no particular order.
pub fn roots(p: &[f64]) -> Vec<f64> {
    match *p {
        [start, end] => edge_integral::roots::<P1, 3, 2>([start, end]).collect(),
        _ => edge_integral::roots::<P2, 6, 3>([p[0], p[1], p[2]]).collect(),
    }
}

/// Its largest value on the edge.
pub fn maximum(p: &[f64]) -> f64 {
    match *p {
        [start, end] => edge_integral::maximum::<P1, 3, 2>([start, end]),
        _ => edge_integral::maximum::<P2, 6, 3>([p[0], p[1], p[2]]),
    }
}

/// Its Bernstein coefficients: it lies between the least and the largest.
pub fn bernstein<S: Scalar>(p: &[S]) -> Vec<S> {
    let mut coefficients = p.to_vec();
    if let [start, end, middle] = &mut coefficients[..] {
        *middle = S::from(2) * *middle - (*start + *end) / S::from(2);
    }
    coefficients
}
