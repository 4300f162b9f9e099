//! The element of V^h chosen at run time: shapes, nodes and polynomials on an edge as the elements of the kernel, `P1` and `P2`,
//! have them, for a [`Degree`]. What sums over all triangles goes through `with_element` and is compiled for each element.

use nalgebra::{SMatrix, SVector};

use crate::kernel::axial;
use crate::kernel::contact_edge;
use crate::kernel::edge_integral;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{Element, P2, Scalar};

/// The polynomial degree of V^h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degree {
    /// P1, section 2.2.
    One,
    /// P2, Remark 3.7.
    Two,
}

/// Evaluates an expression in which `E` is the element of a degree.
macro_rules! with_element {
    ($degree:expr, $E:ident => $expression:expr) => {
        match $degree {
            $crate::model::Degree::One => {
                type $E = $crate::kernel::P1;
                $expression
            }
            $crate::model::Degree::Two => {
                type $E = $crate::kernel::P2;
                $expression
            }
        }
    };
}
pub(crate) use with_element;

impl Degree {
    /// 1 or 2.
    pub fn number(self) -> usize {
        with_element!(self, E => E::DEGREE)
    }

    /// The nodes on a triangle: 3 or 6.
    pub(crate) fn nodes_per_triangle(self) -> usize {
        3 * self.number()
    }

    /// The nodes on an edge: 2 or 3.
    pub fn nodes_per_edge(self) -> usize {
        self.number() + 1
    }

    /// The nodes of a triangle on its edge `i` (mod 3): start, end, then the midpoint if there is one.
    pub fn edge_nodes(self, i: usize) -> impl Iterator<Item = usize> {
        P2::edge_nodes(i).into_iter().take(self.nodes_per_edge())
    }

    /// Where on an edge its nodes lie, from 0 to 1.
    pub fn edge_positions(self) -> impl Iterator<Item = f64> {
        P2::edge_positions().into_iter().take(self.nodes_per_edge())
    }

    /// The shape functions of an edge at `s` in \[0, 1\].
    pub fn edge_values<S: Scalar>(self, s: S) -> Vec<S> {
        with_element!(self, E => E::edge_values(s).into())
    }

    /// The shape functions at the barycentric coordinates `l`.
    pub(crate) fn values<S: Scalar>(self, l: [S; 3]) -> Vec<S> {
        with_element!(self, E => E::values(l).into())
    }

    /// The gradient du_i/dx_j at `l` of a displacement with these values at the nodes of the triangle.
    pub fn displacement_gradient<S: Scalar, const D: usize>(
        self,
        l: [S; 3],
        barycentric: [SVector<S, D>; 3],
        nodal: impl Fn(usize) -> SVector<S, D>,
    ) -> SMatrix<S, D, D> {
        with_element!(self, E => {
            displacement_gradient(&std::array::from_fn(&nodal), &E::gradients(l, barycentric))
        })
    }

    /// The hoop strain on a triangle with these `radii`, at the points of the stiffness rule: [`axial::hoop_strain`].
    pub fn hoop_strain<S: Scalar>(self, radii: [S; 3], radial: impl Fn(usize) -> S) -> [S; 3] {
        with_element!(self, E => {
            axial::hoop_strain::<E, _, _, _>(radii, &std::array::from_fn(radial))
        })
    }

    /// The value at `l` of a function of degree p - 1 with these values at the points of the stiffness rule.
    pub fn value_from_points<S: Scalar>(self, at_points: [S; 3], l: [S; 3]) -> S {
        with_element!(self, E => axial::value_at::<E, _, _, _>(at_points, l))
    }

    /// The share of an edge in kappa_T / gamma0 of its triangle: [`contact_edge::coercivity_constant`].
    pub fn coercivity_constant<S: Scalar>(
        self,
        stiffness: S,
        diameter: S,
        length: S,
        area: S,
    ) -> S {
        with_element!(self, E => {
            contact_edge::coercivity_constant::<E, _, _, _>(stiffness, diameter, length, area)
        })
    }

    /// The amount by which the length of an edge counts more where the direction of contact turns:
    /// [`contact_edge::turning_factor`].
    pub(crate) fn turning_factor<S: Scalar>(self, cosine: S) -> S {
        with_element!(self, E => contact_edge::turning_factor::<E, _, _, _>(cosine))
    }

    /// The length by which an edge counts in kappa, along which the direction of contact turns by an angle with this cosine, if it does,
    /// of one component or of both; in a body of revolution with r at the two ends of the piece, and at the start and the end of the
    /// edge and opposite.
    pub(crate) fn counted_length<S: Scalar>(
        self,
        length: S,
        turning: Option<(S, bool)>,
        radii: Option<([S; 2], [S; 3])>,
        root: impl Fn(S) -> S,
    ) -> S {
        let Some((piece, [start, end, opposite])) = radii else {
            return match turning {
                None => length,
                Some((cosine, false)) => self.turning_factor(cosine) * length,
                Some((cosine, true)) => self.turning_factor_of_both(cosine, root) * length,
            };
        };
        let (turning, sharp, plane) = with_element!(self, E => (
            turning.map(|(cosine, both)| match both {
                false => axial::turning_factor::<E, _, _, _>(piece, cosine, &root),
                true => axial::turning_factor_of_both::<E, _, _, _>(piece, &root),
            }),
            axial::trace_constant::<E, _, _, _>([start, end], opposite, &root),
            E::TRACE_CONSTANT,
        ));
        let length = turning.map_or(length, |turning| turning * length);
        length * sharp / S::from(plane)
    }

    /// As [`Degree::turning_factor`], where the component across acts as well: [`contact_edge::turning_factor_of_both`].
    pub(crate) fn turning_factor_of_both<S: Scalar>(self, cosine: S, root: impl Fn(S) -> S) -> S {
        with_element!(self, E => contact_edge::turning_factor_of_both::<E, _, _, _>(cosine, root))
    }

    /// Calls `f` at the points, with their weights, of a rule that is exact for a product of two gradients.
    pub(crate) fn at_stiffness_points<S: Scalar>(self, f: impl FnMut([S; 3], S)) {
        with_element!(self, E => E::at_stiffness_points(f));
    }

    /// The value at `s` of the polynomial on an edge with the values `p` at its nodes.
    pub fn value_at<S: Scalar>(self, p: &[S], s: S) -> S {
        with_element!(self, E => {
            edge_integral::value_at::<E, _, _, _>(std::array::from_fn(|a| p[a]), s)
        })
    }

    /// The places inside (0, 1) where that polynomial changes its sign, in no particular order.
    pub(crate) fn roots(self, p: &[f64]) -> Vec<f64> {
        with_element!(self, E => {
            edge_integral::roots::<E, _, _>(std::array::from_fn(|a| p[a])).collect()
        })
    }

    /// The largest value of that polynomial on the edge.
    pub(crate) fn maximum(self, p: &[f64]) -> f64 {
        with_element!(self, E => edge_integral::maximum::<E, _, _>(std::array::from_fn(|a| p[a])))
    }

    /// The place inside (0, 1) where that polynomial is largest or least of all, if there is one.
    pub(crate) fn vertex(self, p: &[f64]) -> Option<f64> {
        if self == Degree::One {
            return None;
        }
        let [start, middle, end] = [0.0, 0.5, 1.0].map(|s| self.value_at(p, s));
        // Where the polynomial is affine the quotient is infinite or no number.
        let s = (3.0 * start + end - 4.0 * middle) / (4.0 * (start + end - 2.0 * middle));
        (0.0 < s && s < 1.0).then_some(s)
    }

    /// The Bernstein coefficients of that polynomial, which lies between the least and the largest of them.
    pub(crate) fn bernstein<S: Scalar>(self, p: &[S]) -> Vec<S> {
        let mut coefficients = p.to_vec();
        if self == Degree::Two {
            coefficients[2] = S::from(2) * p[2] - (p[0] + p[1]) / S::from(2);
        }
        coefficients
    }
}
