//! The checker of certificates: it evaluates a bound of the distance |u - v|_a to the true solution of a contact problem from the
//! numbers of a certificate, and trusts nothing else: no solver, no mesh, no linear algebra. With the kernel it is the trusted
//! core; `cargo tree -p signorini-audit` lists all that it depends on.
//!
//! Docs: docs/a-posteriori.md, sections 7.2 to 7.4; docs/certificates.md.
//!
//! | module | what it does |
//! | --- | --- |
//! | [`certificate`] | v, tau and the problem that they belong to, as numbers |
//! | [`format`](mod@format) | the same as two files |
//! | `checks`, `on_contact` | what they must satisfy; the edges of Gamma_C |
//! | `balance`, [`balanced`] | tractions in exact equilibrium |
//! | [`proof`] | the bound |
//! | [`forces`], [`dual`] | forces of the true solution between two numbers; to second order |
#![cfg(not(kani))]

mod balance;
pub mod balanced;
pub mod certificate;
mod checks;
pub mod dual;
pub mod forces;
#[cfg(feature = "files")]
pub mod format;
mod on_contact;
pub mod proof;

pub(crate) use signorini_kernel as kernel;
