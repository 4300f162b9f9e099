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
mod rounding;
mod sharpness;
mod solved;
