//! Functions of the place: loads, gaps, prescribed displacements and distances. A closure is a function; types that know more
//! (constant, affine, zero) say so.

use std::sync::Arc;

use crate::kernel::Ball;

/// A function of the place, such as a component of the body force.
pub trait Function: Send + Sync {
    /// The value at `x`; NaN or infinite where the function has none, which the assembly reports as an error.
    fn at(&self, x: [f64; 2]) -> f64;

    /// The value at `x` on the boundary with the outward normal `n`: a traction may depend on the normal.
    fn on_boundary(&self, x: [f64; 2], _n: [f64; 2]) -> f64 {
        self.at(x)
    }

    /// The degree in x and y, if the function is known to be a polynomial, on the boundary too: it is then integrated
    /// exactly, with no more points than that takes.
    fn degree(&self) -> Option<u32> {
        None
    }

    /// A ball that contains the exact value at `x`, where [`Function::at`] has what doubles make of it; `None` if that is the
    /// exact one or there is no other.
    fn enclosed(&self, _x: [f64; 2]) -> Option<Ball> {
        None
    }

    /// c, if the function is smooth only on either side of the line x = c: its integrals are cut there.
    fn kink(&self) -> Option<f64> {
        None
    }
}

impl<F: Fn([f64; 2]) -> f64 + Send + Sync> Function for F {
    fn at(&self, x: [f64; 2]) -> f64 {
        self(x)
    }
}

/// A constant function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constant(pub f64);

impl Function for Constant {
    fn at(&self, _: [f64; 2]) -> f64 {
        self.0
    }

    fn degree(&self) -> Option<u32> {
        Some(0)
    }
}

/// A [`Function`] that several problems share.
pub type SharedFunction = Arc<dyn Function>;
