//! Rigid obstacles as geometry. Where the body is at x, the obstacle's closest point lies at the distance g = phi(x) in the
//! direction n~ = -grad phi(x), with the signed distance phi from the obstacle, positive on the body's side: g is the gap
//! and n~ the direction of contact.
//!
//! | obstacle | phi | n~ |
//! | --- | --- | --- |
//! | plane through p, unit normal m towards the body | (x - p) . m | -m |
//! | circle of radius R around c, the body outside | \|x - c\| - R | -(x - c)/\|x - c\| |
//! | the same, the body inside | R - \|x - c\| | (x - c)/\|x - c\| |
//! | a line of sides and arcs, the body on its left | the distance from the closest point, negative on the right | -grad phi |
//! | the same, the body on its right | minus that | -grad phi |
//! | a distance by its expression | phi(x) | -grad phi(x) |
//!
//! phi is a distance only where \|grad phi\| = 1. An expression whose gradient is off by more than [`MOST_OFF`] at a node
//! is refused; within it phi / \|grad phi\| is taken, which has the same zeros and is the distance to first order.

use std::fmt;
use std::sync::Arc;

use nalgebra::Vector2;

use super::data::{DataError, finite};
use super::function::Function;
use super::mesh::length;
use super::path::{Beside, Path};

/// The largest deviation of |grad phi| from 1. An expression that is no distance (x^2 - 1, 2 x) is off by far more nearly
/// everywhere; one that is a distance on the obstacle is off by its curvature times the gap, which is small where contact is.
pub(crate) const MOST_OFF: f64 = 0.1;

/// A rigid obstacle.
#[derive(Clone)]
#[non_exhaustive]
pub enum Obstacle {
    /// The half plane behind a straight line.
    Plane {
        /// A point of the line.
        point: [f64; 2],
        /// The unit normal, out of the obstacle, towards the body.
        normal: [f64; 2],
    },
    /// A disk that the body lies outside of (a pin), or a hole that it lies in (a bearing).
    Circle {
        /// c
        center: [f64; 2],
        /// R
        radius: f64,
        /// Where the body is.
        side: Side,
    },
    /// The region beyond a line of straight sides and arcs.
    Path {
        /// The line.
        path: Arc<Path>,
        /// Where the body is.
        body: Hand,
    },
    /// The set where a signed distance is negative.
    Distance(Arc<dyn Distance>),
}

/// On which side of a circle the body is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The obstacle is the disk.
    Outside,
    /// The obstacle is all but the disk.
    Inside,
}

/// On which side of a line the body is, for somebody who walks along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// On the left.
    Left,
    /// On the right.
    Right,
}

/// A signed distance with its gradient.
pub trait Distance: Function {
    /// grad phi at `x`.
    fn gradient(&self, x: [f64; 2]) -> [f64; 2];
}

impl fmt::Debug for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Obstacle::Plane { point, normal } => write!(f, "plane at {point:?}, normal {normal:?}"),
            Obstacle::Circle { center, radius, side } => {
                write!(f, "circle around {center:?}, radius {radius}, body {side:?}")
            }
            Obstacle::Path { path, body } => write!(f, "{path:?}, body {body:?}"),
            Obstacle::Distance(_) => write!(f, "distance"),
        }
    }
}

/// The obstacle as seen from a point of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// g: negative where the obstacle reaches into the body.
    pub gap: f64,
    /// n~, a unit vector from the body towards the obstacle.
    pub direction: Vector2<f64>,
}

impl Obstacle {
    /// Gap and direction at `x`; messages call the obstacle `what()`.
    ///
    /// # Errors
    /// A distance without a value there, or with a gradient that is none of a distance; the centre of a circle, which has
    /// no closest point.
    pub fn closest(&self, x: [f64; 2], what: impl Fn() -> String) -> Result<Closest, DataError> {
        let no_distance = |length: f64| DataError::NoDistance {
            what: what(),
            length,
            x: x[0],
            y: x[1],
            least: 1.0 - MOST_OFF,
            most: 1.0 + MOST_OFF,
        };
        match self {
            Obstacle::Plane { point, normal } => Ok(Closest {
                gap: (x[0] - point[0]) * normal[0] + (x[1] - point[1]) * normal[1],
                direction: Vector2::zeros() - Vector2::from(*normal),
            }),
            Obstacle::Circle { center, radius, side } => {
                let out = Vector2::from(x) - Vector2::from(*center);
                let distance = length(out);
                if distance == 0.0 {
                    return Err(DataError::NoClosestPoint { what: what(), x: x[0], y: x[1] });
                }
                let out = out / distance;
                Ok(match side {
                    Side::Outside => {
                        Closest { gap: distance - radius, direction: Vector2::zeros() - out }
                    }
                    Side::Inside => Closest { gap: radius - distance, direction: out },
                })
            }
            Obstacle::Path { path, body } => {
                let Beside { left, growth } = path.beside(x.into());
                Ok(match body {
                    Hand::Left => Closest { gap: left, direction: -growth },
                    Hand::Right => Closest { gap: -left, direction: growth },
                })
            }
            Obstacle::Distance(distance) => {
                let value = finite(&**distance, x, &what)?;
                let gradient = Vector2::from(distance.gradient(x));
                let length = length(gradient);
                if (length - 1.0).abs() <= MOST_OFF {
                    Ok(Closest {
                        gap: value / length,
                        direction: Vector2::zeros() - gradient / length,
                    })
                } else {
                    Err(no_distance(length))
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the distance from the circle of radius 2 around (1, 0).
    struct Twice;

    impl Function for Twice {
        fn at(&self, [x, y]: [f64; 2]) -> f64 {
            2.0 * ((x - 1.0).hypot(y) - 2.0)
        }
    }

    impl Distance for Twice {
        fn gradient(&self, [x, y]: [f64; 2]) -> [f64; 2] {
            let r = (x - 1.0).hypot(y);
            [2.0 * (x - 1.0) / r, 2.0 * y / r]
        }
    }

    #[test]
    fn what_is_no_distance_is_refused_and_so_is_the_centre_of_a_circle() {
        let circle = Obstacle::Circle { center: [1.0, 0.0], radius: 2.0, side: Side::Outside };
        for (obstacle, x, said) in [
            (
                Obstacle::Distance(Arc::new(Twice)),
                [4.0, 4.0],
                "o has a gradient of length 2 at (4, 4); expected a distance there",
            ),
            (circle, [1.0, 0.0], "o has no closest point to (1, 0), its centre"),
        ] {
            let error = obstacle.closest(x, || "o".to_owned()).unwrap_err();
            assert!(error.to_string().starts_with(said), "{error}");
        }
    }
}
