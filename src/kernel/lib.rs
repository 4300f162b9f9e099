//! The verified core: what method (8) computes at one point, on one triangle and on one contact edge.
//!
//! It is made of pure functions of plain data, generic over the number type ([`Scalar`]), so that the very code that solves a
//! user's problem in doubles can be run over exact rationals, over symbols and with its rounding enclosed. Sign tests are its only
//! branches; it allocates nothing, reads nothing and has no panic.
//! Vectors and matrices are nalgebra's, with the dimension as a parameter where the formula is that of any dimension.
//! Numbered quantities that are no vectors stay arrays: barycentric coordinates, the values of all shape functions, the nodes
//! of an element.
//!
//! | module | in the paper |
//! | --- | --- |
//! | [`scalar`] | the numbers and the one question asked of them |
//! | [`positive_part`](mod@positive_part) | \[.\]+ and (4) |
//! | [`material`] | sigma = A eps in (1), plane strain and plane stress |
//! | [`triangle`] | T, its area, normals and barycentric gradients |
//! | [`element`] | V^h: P1, and P2 of Remark 3.7; a(.,.) on one triangle |
//! | [`contact`] | conditions (2), equation (5), P_gamma, lambda^h |
//! | [`law`] | (5) as an equation for contact, and for interfaces that also pull |
//! | [`contact_edge`] | P_gamma and sigma_n as functionals on one edge of Gamma_C |
//! | [`edge_integral`] | the integrals over one edge in (8) and in J_h |
//! | [`axial`] | not in the paper: the weight r and the hoop strain of bodies of revolution |
//! | [`friction`] | not in the paper: Tresca's and Coulomb's friction at a point and over one edge |
//! | [`squares`] | not in the paper: the energies of a strain and of a stress as sums of squares |
//! | [`composite`] | not in the paper: stresses in equilibrium, for certificates |
//! | [`ball`] | not in the paper: numbers with their rounding enclosed |
//! | [`double_double`] | not in the paper: numbers of twice the precision |
//! | [`enclosing`] | not in the paper: what may be concluded from these |

pub mod axial;
pub mod ball;
pub mod composite;
pub mod contact;
pub mod contact_edge;
pub mod double_double;
pub mod edge_integral;
pub mod element;
pub mod enclosing;
pub mod friction;
pub mod law;
pub mod material;
pub mod positive_part;
pub mod scalar;
pub mod squares;
pub mod triangle;

pub use ball::{Ball, PreciseBall};
pub use contact::ContactPoint;
pub use contact_edge::ContactEdge;
pub use double_double::DoubleDouble;
pub use edge_integral::EdgeIntegrals;
pub use element::{Element, P1, P2};
pub use enclosing::Enclosing;
pub use law::Response;
pub use material::{Material, Plane, Stress};
pub use positive_part::{positive_part, positive_part_slope};
pub use scalar::Scalar;
pub use squares::Squares;
pub use triangle::Triangle;
