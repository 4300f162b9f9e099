//! What the program promises beyond the paper, beside exact rationals: the enclosure that each solve reports, the certificates of the
//! error and of forces, balls and double-doubles, directions of contact. Data are drawn by `props::draws`; each check has a
//! control, a planted mistake that it must reject.
//!
//! A part of it alone: `cargo test -p props program::balls::`.

/// Tests by their names: `NAME => OUTCOME;`.
macro_rules! checks {
    ($($name:ident => $run:expr;)+) => {$(
        mod $name {
            #[allow(unused_imports, reason = "an outcome may need nothing")]
            use super::*;

            #[test]
            fn check() {
                if let Err(why) = props::draws::named(stringify!($name), || $run) {
                    panic!("{why}");
                }
            }
        }
    )+};
}

use props::proof::sampler::Random;

/// A number between 0 and 1.
fn share(random: &mut Random) -> f64 {
    random.below(1001) as f64 / 1000.0
}

/// A vector for each of so many nodes, with components between -1 and 1.
fn random_field(random: &mut Random, nodes: usize) -> Vec<[f64; 2]> {
    (0..nodes).map(|_| [0, 1].map(|_| random.below(2001) as f64 / 1000.0 - 1.0)).collect()
}

mod a_priori;
mod assembled;
mod at_points;
mod attained;
mod balls;
mod by_hand;
mod certified;
mod directions;
mod edges;
mod enclosure;
mod error_bound;
mod forces;
mod geometry;
mod material;
mod pressed;
mod quantities;
mod rationals;
mod refusals;
mod revolution;
mod rounding;
mod sharpness;
mod solved;
