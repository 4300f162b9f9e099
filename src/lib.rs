//! Unilateral (Signorini) contact in linear elasticity by Nitsche's method, after Chouly & Hild, *A Nitsche-based method
//! for unilateral contact problems: numerical analysis*, SIAM J. Numer. Anal. 51 (2013) 1295-1307 ("the paper").
//!
//! Linear elastic, small displacements and rotations, plane strain, plane stress or bodies of revolution. Contact is with rigid obstacles
//! and between deformable bodies, without friction or with Tresca's or Coulomb's: they push and never pull; gap and direction are those of
//! the undeformed bodies. Not computed: 3D, large displacements or sliding, friction in bodies of revolution,
//! plasticity and other nonlinear materials, dynamics, thermal strain.
//!
//! A block on a rigid floor, whose right half the load lifts off; more in the folder
//! `examples`, where `first_contact.rs` is a tutorial.
//!
//! ```
//! use signorini::{Condition, Diagonal, Material, Method, Obstacle, Plane, Problem, Rectangle, Settings, solve};
//!
//! let (nx, ny, diagonal) = (16, 16, Diagonal::Right);
//! let mesh = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal }.mesh()?;
//! let floor = Obstacle::Plane { point: [0.0, 0.0], normal: [0.0, 1.0] };
//! let problem = Problem::of(mesh, Material::lame(1.0, 1.0, Plane::Strain))
//!     .with_body_force(|_| 0.0, |[x, _]| -4.0 + 10.0 * x)
//!     .with("top", Condition::clamped())
//!     .with("bottom", Condition::obstacle("floor", floor));
//! let (solution, _) = solve(&problem, &Method::default(), &Settings::default())?;
//! assert!((solution.quantities.contact_force - 0.42).abs() < 0.01);
//! let stress = solution.largest_stresses(&problem).unwrap().von_mises;
//! assert!(stress.value > 4.0 && stress.at[1] > 0.9);
//! solution.write(&problem, &std::env::temp_dir().join("signorini-example"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A body of revolution has its meridian for a mesh: x is the distance from the axis x = 0 and y the place along it. Energies and forces
//! along the axis are those of the whole revolution.
//!
//! ```
//! use signorini::{Condition, Diagonal, Material, Method, Plane, Problem, Rectangle, Settings, solve};
//!
//! let (nx, ny, diagonal) = (8, 8, Diagonal::Right);
//! let mesh = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal }.mesh()?;
//! let cylinder = Problem::of(mesh, Material::young_poisson(2.0, 0.3, Plane::Axisymmetric))
//!     .with("top", Condition::pressure(|_| 0.01))
//!     .with("bottom", Condition::contact(|_| 0.0));
//! let (solution, _) = solve(&cylinder, &Method::default(), &Settings::default())?;
//! let force = 0.01 * std::f64::consts::PI;
//! assert!((solution.quantities.contact_force - force).abs() < 1e-12);
//! assert!(solution.largest_stresses(&cylinder).unwrap().hoop.is_some());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The problem
//!
//! An elastic body is clamped (or moved) on Gamma_D, loaded in Omega and on Gamma_N, and may touch a rigid obstacle along
//! Gamma_C, at the initial distance g along the outward normal n:
//!
//! - (1) div sigma(u) + f = 0, sigma(u) = A eps(u), with the data on Gamma_D and Gamma_N;
//! - (2) u_n - g <= 0, sigma_n(u) <= 0, sigma_n(u) (u_n - g) = 0, sigma_t(u) = 0 on Gamma_C.
//!
//! # The method
//!
//! For any gamma > 0, (2)(i)-(iii) say the same as the one equation (5): sigma_n(u) = -(1/gamma) \[P(u)\]+ with
//! P(u) = u_n - g - gamma sigma_n(u) (Proposition 2.1). Put into Green's formula it gives (6), and on a finite element
//! space V^h, with gamma = gamma0 h_T (7), **method (8)**: find u^h in V^h such that for all v^h in V^h
//!
//! A(u^h, v^h) + int (1/gamma) \[P(u^h)\]+ P0(v^h) = L(v^h),
//!
//! with A(u, v) = a(u, v) - int gamma sigma_n(u) sigma_n(v) and P0 the linear part of P. Its left side less its right is the
//! derivative of J_h(v) = 1/2 A(v, v) + 1/2 int (1/gamma) \[P(v)\]+^2 - L(v), which is strictly convex as long as
//! kappa = gamma0 C_h < 1: that is what "gamma0 sufficiently small" means here (Lemma 3.2, Theorem 3.3).
//!
//! # Where the paper's formulas live
//!
//! | paper | here |
//! | --- | --- |
//! | sigma = A eps in (1) | [`kernel::material`] |
//! | \[.\]+ and (4) | [`kernel::positive_part`](mod@kernel::positive_part) |
//! | (2), (5), P_gamma, lambda^h of section 2.3 | [`kernel::contact`] |
//! | V^h: P1, and P2 of Remark 3.7; a(.,.) on a triangle | [`kernel::element`], [`model::space`] |
//! | P_gamma and sigma_n on an edge, the constant of (11) | [`kernel::contact_edge`] |
//! | the integrals over Gamma_C in (8), without quadrature error | [`kernel::edge_integral`] |
//! | the weight r and the hoop strain of bodies of revolution (not in the paper) | [`kernel::axial`] |
//! | T^h and h_T | [`model::mesh`] |
//! | Gamma_D, L, Gamma_C with (7), kappa | [`model::constraints`], [`model::loads`], [`contact::contact_line`] |
//! | (8) itself, J_h | [`contact::discretization`] |
//! | A_gamma as a matrix | [`linear::matrix`] |
//! | the solution of (8): the algorithm on one page | [`solve`](mod@solve) |
//! | Newton's method; its tangents by the body condensed to its contact edges, or assembled | [`solve::newton`], [`solve::condensed`], [`solve::assembled`] |
//! | the proof of a solve (not in the paper) | [`proof::enclosure`] |
//!
//! # What is stable
//!
//! The items that the first page and the pages of its modules list, such as [`Problem`] and [`solve::Settings`], but for those of [`exact`].
//! These, and the modules below the modules, are the inside of the solver: shown to those who read the method, reached by tests, benches and
//! the claims, they may change with any version.
//!
//! # Features
//!
//! `cli` (default) is the command; it needs `files`: case files ([`io::Case`]), result.json and pictures. Without both
//! (`default-features = false`), the library depends on no parser and writes no files but VTU and CSV.
//!
//! # Speed
//!
//! A dev build of a program solves some 80 times slower than a release build. This in its `Cargo.toml` has the solver optimised there, too:
//!
//! ```toml
//! [profile.dev.package."*"]
//! opt-level = 2
//! ```
//!
//! Proofs of what the code relies on are in `docs/theory.md`; what has been verified, and how, is in `VERIFY.md`.

// What the command alone uses, and its features alone switch on, is no mistake without it.
#![cfg_attr(not(feature = "cli"), allow(dead_code))]

/// The vectors and matrices of the interface.
pub use nalgebra;
/// The verified core, a crate of its own.
pub use signorini_kernel as kernel;
/// Makes a number type an entry of nalgebra's vectors.
pub use signorini_kernel::entry_of_nalgebra;

#[cfg(not(kani))]
pub mod certificates;
#[cfg(all(not(kani), feature = "cli"))]
pub mod command;
#[cfg(not(kani))]
pub mod contact;
#[cfg(not(kani))]
pub mod exact;
#[cfg(not(kani))]
pub(crate) mod held;
#[cfg(not(kani))]
pub mod io;
#[cfg(not(kani))]
pub mod linear;
#[cfg(not(kani))]
pub(crate) mod memory;
#[cfg(not(kani))]
pub mod model;
#[cfg(not(kani))]
pub mod proof;
#[cfg(not(kani))]
pub(crate) mod quote;
#[cfg(not(kani))]
pub mod results;
#[cfg(not(kani))]
pub mod solve;

// For a program with its problem in code.
#[cfg(all(not(kani), feature = "files"))]
pub use io::Case;
#[cfg(not(kani))]
pub use kernel::{Material, Plane};
#[cfg(not(kani))]
pub use model::{Condition, Degree, Diagonal, Mesh, Obstacle, Problem, Rectangle, Side};
#[cfg(not(kani))]
pub use results::Solution;
#[cfg(not(kani))]
pub use solve::{Gamma0, Method, Settings, solve};
