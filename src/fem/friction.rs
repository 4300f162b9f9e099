//! Friction on parts of Gamma_C as data: which law, and how much.

use super::function::SharedFunction;

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
