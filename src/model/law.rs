//! The laws of the interfaces along Gamma_C: how the two sides act on each other. Their integrals in method (8) are in `contact::law` and
//! `contact::friction`.

use super::element::Degree;
use super::function::SharedFunction;
use crate::kernel::{Response, Scalar};

/// How the two sides of Gamma_C act on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Law {
    /// Unilateral contact without friction, conditions (2).
    #[default]
    Contact,
    /// Sliding without lift-off: no jump along the direction of contact.
    Sliding,
    /// No jump at all: meshes that do not match, glued.
    Bonded,
    /// Contact, and friction across up to a bound.
    Friction(Bound),
}

impl Law {
    /// Responses to each component of the jump by itself: along the direction of contact, and across if the law feels that, but
    /// for friction.
    pub(crate) fn responses(self) -> &'static [Response] {
        match self {
            Law::Contact | Law::Friction(_) => &[Response::Unilateral],
            Law::Sliding => &[Response::Bilateral],
            Law::Bonded => &[Response::Bilateral, Response::Bilateral],
        }
    }

    /// The number of components of the jump that it feels.
    pub(crate) fn components(self) -> usize {
        match self {
            Law::Friction(_) => 2,
            _ => self.responses().len(),
        }
    }

    /// The values of P at the nodes of a piece, component after component, at which the interface gives way to none: pressed and
    /// sticking.
    pub fn closed(self, degree: Degree) -> Vec<f64> {
        let nodes = degree.nodes_per_edge();
        let value = |i: usize| if i < nodes { 1.0 } else { 0.0 };
        (0..self.components() * nodes).map(value).collect()
    }
}

/// The law of friction on a part of Gamma_C.
#[non_exhaustive]
#[derive(Clone)]
pub enum Friction {
    /// Tresca's: |sigma_t| <= s with a given slip bound s >= 0, a stress, pressed or not; where the body slides, sigma_t has this
    /// size and is directed against the slip.
    Tresca(SharedFunction),
    /// Coulomb's: the same with s = mu |sigma_n| for this coefficient mu >= 0.
    Coulomb(f64),
}

impl Friction {
    /// Tresca's law with this slip bound.
    pub fn tresca(bound: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> Self {
        Friction::Tresca(std::sync::Arc::new(bound))
    }
}

/// The bound of the shear stress on a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// s at the start and at the end.
    Tresca([f64; 2]),
    /// mu
    Coulomb(f64),
    /// s at the start, at the end and in the middle, quadratic for quadratic elements; none where it is negative. It is what Coulomb's
    /// law has for a given pressure.
    Given([f64; 3]),
}

impl Bound {
    /// m at the nodes of the piece, where P_n has the values `normal`.
    pub(crate) fn at_nodes<S: Scalar + From<f64>>(self, gamma: S, normal: &[S]) -> Vec<S> {
        let exact = <S as From<f64>>::from;
        match self {
            Bound::Tresca(ends) => {
                let [start, end] = ends.map(|s| gamma * exact(s));
                let middle = (start + end) / <S as From<i32>>::from(2);
                [start, end, middle].into_iter().take(normal.len()).collect()
            }
            Bound::Coulomb(mu) => normal.iter().map(|&p| exact(mu) * p).collect(),
            Bound::Given(s) => s.into_iter().take(normal.len()).map(|s| gamma * exact(s)).collect(),
        }
    }

    /// The slip bound in the middle, where P_n / gamma has this mean.
    pub(crate) fn mean(self, pressure: f64) -> f64 {
        match self {
            Bound::Tresca([start, end]) => (start + end) / 2.0,
            Bound::Coulomb(mu) => mu * pressure.max(0.0),
            Bound::Given([.., middle]) => middle.max(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_a_slip_bound_is_that_over_the_edge_or_of_the_mean_pressure() {
        assert_eq!(Bound::Tresca([1.0, 4.0]).mean(7.0), 2.5);
        assert_eq!(Bound::Coulomb(0.5).mean(4.0), 2.0);
        assert_eq!(Bound::Coulomb(0.5).mean(-4.0), 0.0);
    }
}
