//! The claims of the paper as executable statements about `signorini`.
//!
//! A statement is written once, generic over the number type ([`Ordered`]), calls the kernel's own functions, and answers
//! a [`Verdict`]. Engines run it: `proof` over symbols, `draws` over rationals and doubles, and the `harness`es of the
//! model checker. [`claims`] are the rows of the ledger `VERIFY.md`.

#[cfg(all(test, not(kani)))]
extern crate self as props;

#[cfg(not(kani))]
pub mod audit;
#[cfg(not(kani))]
pub mod bodies;
#[cfg(not(kani))]
#[macro_use]
pub mod claim;
pub mod claims;
#[cfg(not(kani))]
pub mod discrete;
#[cfg(not(kani))]
pub mod draws;
#[cfg(not(kani))]
pub mod elimination;
#[cfg(not(kani))]
pub mod export;
pub mod harness;
#[cfg(not(kani))]
pub mod items;
#[cfg(not(kani))]
pub mod ledger;
#[cfg(not(kani))]
pub mod naive;
pub mod numbers;
#[cfg(not(kani))]
pub mod paper;
#[cfg(not(kani))]
pub mod problems;
#[cfg(not(kani))]
pub mod proof;
#[cfg(not(kani))]
pub mod receipt;
#[cfg(not(kani))]
pub mod sharpness;
#[cfg(not(kani))]
pub mod solvers;
#[cfg(not(kani))]
pub mod statement;
pub mod verdict;

#[cfg(all(test, not(kani)))]
#[path = "../tests/program/main.rs"]
mod program;

pub use verdict::{Ordered, Verdict};
