//! What the library and the command promise, in one program: one to link, one to start. A part of it alone:
//! `cargo test --test suite patch::`.

mod common;

mod adapt;
mod audit;
mod bad_input;
mod bodies;
mod certified_contact;
mod certified_supports;
mod certify;
mod command;
mod convergence;
mod course;
mod documents;
#[cfg(unix)]
mod doors;
mod enclosure;
mod exact;
mod figure;
mod forged;
mod friction;
mod friction_certified;
mod friction_integrals;
mod fuzz;
mod gmsh_live;
mod held;
mod meshes;
mod method;
mod pair_cases;
mod pairs;
mod parts;
mod patch;
mod peaks;
mod printed;
mod properties;
mod quantities;
mod recorded;
mod recovered;
mod reference;
mod refused;
mod remarks;
mod reported;
mod revolution;
mod routes;
mod set_and_sweep;
mod tensor;
mod units;
