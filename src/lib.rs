//! Unilateral (Signorini) contact in linear elasticity by Nitsche's method.
#[cfg(not(kani))]
pub mod fem;
#[cfg(not(kani))]
pub mod io;
pub mod kernel;
#[cfg(not(kani))]
pub mod solve;
