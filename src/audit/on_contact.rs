//! An edge of Gamma_C in a certificate: what v . d - g is at most, and the contact term of the theorem.
//! v . d - g is known not to be positive where its Bernstein coefficients are not.

use nalgebra::Vector2;

use crate::kernel::Enclosing;
use crate::kernel::contact_edge::integral_of_product;

/// v and g on an edge of Gamma_C.
pub(super) struct OnEdge<S> {
    /// v at both ends.
    pub(crate) v: [Vector2<S>; 2],
    /// g at both ends.
    pub(crate) gap: [f64; 2],
    /// The bulges of both; `None` where they are affine.
    pub(crate) bulges: Option<(Vector2<S>, f64)>,
}

/// An edge of Gamma_C.
pub(super) struct OnContact<S> {
    /// An upper bound of v_n - g, the Bernstein coefficients of it or of a multiple: none may be positive.
    pub(crate) beyond: [S; 4],
    /// 2 int tau_n (v_n - g)
    pub(crate) term: S,
}

/// Contact along the normal. All is in units of the length, which is needed only where there is a gap.
pub(super) fn along_the_normal<S: Enclosing>(
    shape: &OnEdge<S>,
    normal: Vector2<S>,
    [p, q]: [S; 2],
    length: impl Fn() -> S,
) -> OnContact<S> {
    let axis = (0..2).find(|&c| normal[1 - c].ends() == [0.0; 2]);
    let less_gap = |v: Vector2<S>, gap: f64| match axis {
        _ if gap == 0.0 => v.dot(&normal),
        // Where v is on the obstacle to the last bit, nothing is left.
        Some(c) if normal[c].is_positive() => (v[c] - S::exactly(gap)) * normal[c],
        Some(c) => (v[c] + S::exactly(gap)) * normal[c],
        None => v.dot(&normal) - length() * S::exactly(gap),
    };
    let [a, b] = [0, 1].map(|k| less_gap(shape.v[k], shape.gap[k]));
    let bulge = shape.bulges.map(|(v, gap)| less_gap(v, gap));
    // 4 s (1 - s) has the Bernstein coefficients 0, 2, 0 and, times p (1 - s) + q s, the integral (p + q) / 3.
    let integral = integral_of_product([p, q], [a, b]);
    let integral = bulge.map_or(integral, |bulge| integral + (p + q) * bulge / S::from(3));
    let middle = bulge.map_or(a, |bulge| (a + b) / S::from(2) + S::from(2) * bulge);
    OnContact { beyond: [a, middle, middle, b], term: S::from(2) * integral }
}

/// Contact along a direction d that is affine between the ends, with tau N = |E| p d: p is constant where d `turns`. The mean
/// of the Bernstein coefficients of v . d - g is its integral; it is at most their largest.
pub(super) fn along_directions<S: Enclosing>(
    shape: &OnEdge<S>,
    (d, turns): ([Vector2<S>; 2], bool),
    [p, q]: [S; 2],
    length: S,
) -> OnContact<S> {
    let (v, [g, h]) = (shape.v, shape.gap.map(S::exactly));
    let (two, three) = (S::from(2), S::from(3));
    let first = v[0].dot(&d[0]) - g;
    let last = v[1].dot(&d[1]) - h;
    let (beyond, integral) = if let Some((bulge, gap)) = shape.bulges {
        let gap = S::exactly(gap);
        // v and g have the middle coefficients (v_0 + v_1) / 2 + 2 b; v . d is a cubic, of which two are the thirds of these.
        let (middle, between) = ((v[0] + v[1]) / two + bulge * two, (g + h) / two + gap * two);
        let one = (middle.dot(&d[0]) - between) * two + v[0].dot(&d[1]) - g;
        let other = (middle.dot(&d[1]) - between) * two + v[1].dot(&d[0]) - h;
        let integral = if turns {
            p * (three * first + one + other + three * last) / S::from(12)
        } else {
            let beyond = bulge.dot(&d[0]) - gap;
            integral_of_product([p, q], [first, last]) + (p + q) * beyond / three
        };
        ([first, one, other, last], integral)
    } else {
        let middle = v[0].dot(&d[1]) + v[1].dot(&d[0]) - g - h;
        let integral = if turns {
            p * (two * first + middle + two * last) / S::from(6)
        } else {
            integral_of_product([p, q], [first, last])
        };
        ([first, middle, middle, last], integral)
    };
    OnContact { beyond, term: two * length * integral }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On an edge along (4, 3), of length 5, whose outward vector of this length is (3, -4): v . n - 5 g is 5/4 and 11/8 at its ends.
    #[test]
    fn the_gap_is_taken_from_the_motion_along_an_oblique_normal() {
        let v = [[0.5, -0.25], [0.0, -0.5]].map(Vector2::from);
        let shape = OnEdge { v, gap: [0.25, 0.125], bulges: None };
        let found = along_the_normal(&shape, Vector2::new(3.0, -4.0), [-1.0, -2.0], || 5.0);
        assert_eq!(found.beyond, [1.25, 1.25, 1.25, 1.375]);
        // 2 int p (v . n - 5 g), with p from -1 to -2: exact but for the third.
        assert!((found.term + 11.875 / 3.0).abs() < 1e-15 * 10.0, "{}", found.term);
    }
}
