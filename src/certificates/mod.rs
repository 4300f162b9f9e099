//! How far a displacement is from the solution of (1)-(2): an upper bound of |u - v|_a without an unknown constant.
//!
//! Docs: docs/a-posteriori.md, sections 7.2 to 7.4.
//!
//! | module | what it does |
//! | --- | --- |
//! | `proof` | the checker, of the crate `signorini-audit`: it evaluates a certificate |
//! | `parts`, `contact`, `field`, `data` | the problem and its discrete solution, as certificates see them |
//! | `admissible` | v |
//! | `tie` | v where two bodies do not open |
//! | `pressed` | y, the displacement under the pressures of tau |
//! | `tractions`, `quarters`, `divide`, `build` | tau: moments of tractions; the triangles in four; those that are cut; all together |
//! | `sweeps` | a better tau |
//! | `oscillation` | data outside the exact class |
//! | `binding` | whether a certificate is one of a problem |
//! | `encode` | certificates as files |
//! | `quantities`, `lifting` | forces between two numbers, and where contact can act, by `signorini_audit::forces`; the displacements that prove them |
//! | `adapt` | meshes that are refined until the bound meets a target |

pub mod adapt;
mod admissible;
pub mod binding;
mod bubbles;
mod build;
mod contact;
mod data;
mod divide;
#[cfg(feature = "files")]
mod encode;
mod errors;
mod field;
mod lifting;
mod oscillation;
mod parts;
mod pressed;
pub mod quantities;
mod quarters;
mod sweeps;
mod tie;
mod tractions;

pub use self::adapt::{AdaptError, Adapted, Target, adapt, adapt_to};
use nalgebra::Vector2;

use self::balanced::Balanced;
use self::build::Built;
use self::certificate::Shape;
#[cfg(feature = "files")]
pub use self::encode::encode;
pub use self::errors::CertifyError;
use self::field::Field;
use self::parts::ProblemParts;
pub use self::proof::{Certificate, Proof, Rejection};
pub use signorini_audit::forces::Ramp;
#[cfg(feature = "files")]
pub use signorini_audit::format;
use signorini_audit::{balanced, certificate};
pub use signorini_audit::{dual, forces, proof};

use self::proof::{Piece, Role};
pub use self::quantities::ProvedQuantities;
use crate::contact::Law;
use crate::kernel::{Ball, Scalar, Triangle};
use crate::memory;
use crate::model::law::Bound;
use crate::model::{Degree, Mesh, Problem};
use crate::quote::quoted;
use crate::results::Solution;

/// The number of times that the stress is improved around every vertex.
const SWEEPS: usize = 2;

/// As [`SWEEPS`], with two bodies: the fans of narrow triangles between them are far from what they start with.
const SWEEPS_FOR_PAIRS: usize = 6;

/// The number of sweeps where forces are asked for, of tau and of the rho of dual pairs.
const SWEEPS_FOR_FORCES: usize = 16;

/// The number of times that v is pushed out of the obstacle by what the check finds it to be inside.
const PUSHES: usize = 5;

/// The bytes that a certificate takes for each triangle while it is made: the second derivatives of the sweeps, 700, and
/// the forces, wrenches and tractions in doubles and in intervals.
const PER_TRIANGLE: u64 = 3000;

/// As [`PER_TRIANGLE`], with forces to second order, on a mesh of so many triangles: the dual solutions and their factors, whose size
/// grows like N log N. Measured: 10 kB for 7,200 triangles, 14.6 kB for 115,200.
fn per_triangle_with_forces(triangles: usize) -> u64 {
    5000 + 600 * u64::from(triangles.max(1).ilog2() + 1)
}

/// A bound of the distance from the true solution.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Continuous {
    /// |u - v|_a is at most this.
    pub bound: f64,
    /// The bound over |v|_a.
    pub relative: f64,
    /// v, at the vertices, and at the middles of the edges if it is quadratic.
    pub displacement: Vec<[f64; 2]>,
    /// True if every step is proved, rounding included.
    pub rigorous: bool,
    /// Why it is not rigorous.
    pub reason: Option<String>,
    /// The square root of each triangle's share in the square of the bound, and |v - w|_a there, by the triangles of the mesh.
    pub indicators: Vec<f64>,
    /// The difference between the problem that is bounded and the one that is meant, if there is one; `rigorous` is about the
    /// former.
    pub problem: Option<String>,
    /// J(u) lies between these; `None` where the data are outside the exact class.
    pub energy: Option<[f64; 2]>,
    /// The compliance L(u) lies between these; `None` where J(u) is not bounded, or where displacements or gaps other than 0
    /// are prescribed beside the loads.
    pub compliance: Option<[f64; 2]>,
    /// The certificate.
    pub certificate: Certificate,
    /// The proved bound.
    pub proof: Proof,
    /// |v - w|_a is at most this, for the field w that was given.
    pub clipping: f64,
    /// |u - w|_a is at most this.
    pub of_field: f64,
    /// The largest |w - u_D| at the nodes of Gamma_D and, where w is quadratic or u_D is, of the bulges between them: bounds in
    /// the energy norm don't see a w that is moved as a whole.
    pub missed: f64,
    /// Proved forces and zones of contact.
    pub quantities: ProvedQuantities,
}

/// Certifies the `solution` of `problem`.
///
/// # Errors
/// Data that don't make the problem; a solution that no certificate can be made for, with the reason.
pub fn certify(problem: &Problem, solution: &Solution) -> Result<Continuous, CertifyError> {
    certify_with(problem, solution, &Asked::default())
}

/// Options of a certificate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// Contact forces, each of the boundary with this name and of the pressure times this weight: they are proved to second
    /// order, by dual pairs, which costs some certificates more for each.
    pub forces: Vec<(String, Option<Ramp>)>,
}

/// Certifies the `solution` of `problem`, and what is asked beside.
///
/// # Errors
/// As [`certify`].
pub fn certify_with(
    problem: &Problem,
    solution: &Solution,
    asked: &Asked,
) -> Result<Continuous, CertifyError> {
    certify_near(problem, solution, (&solution.displacement, &solution.displacement), asked)
}

/// Certifies any displacement `field` of `problem`, given at the vertices of the mesh, and at the middles of its edges if it is
/// quadratic on the triangles. The stress comes from our own `solution`; v is the field, clipped into the admissible set, or
/// our own solution, whichever gives the smaller bound of the field's own error: what is clipped at vertices only may cost
/// more than the way to a good solution.
///
/// # Errors
/// As [`certify`].
pub fn certify_field(
    problem: &Problem,
    solution: &Solution,
    field: &[[f64; 2]],
) -> Result<Continuous, CertifyError> {
    let clipped = certify_near(problem, solution, (field, field), &Asked::default())?;
    if clipped.clipping == 0.0 || field == solution.displacement {
        return Ok(clipped);
    }
    let own = certify_near(problem, solution, (&solution.displacement, field), &Asked::default())?;
    Ok(if own.of_field < clipped.of_field { own } else { clipped })
}

/// The bound for v = `start` clipped, and how far that is from `field`.
fn certify_near(
    problem: &Problem,
    solution: &Solution,
    (start, field): (&[[f64; 2]], &[[f64; 2]]),
    asked: &Asked,
) -> Result<Continuous, CertifyError> {
    // The problem, as certificates see it.
    let quadratic = check(problem, solution, start, asked)?;
    let u = &*solution.displacement;
    let mut parts = ProblemParts::new(problem, solution.degree, &solution.pieces, (u, quadratic))?;
    // y, under the pressures of tau.
    let y = pressed::displacement(&mut parts, solution.degree, u)?;
    let mesh = &problem.mesh;
    let [y, start, w] = [&y, start, field].map(|nodal| Field::new(mesh, nodal));
    let missed = parts.missed(&w?);
    // v, and a tau from y.
    let (v, mut built) = pushed_out(&parts, &y?, start?)?;
    // A better tau.
    let sweeps = match (asked.forces.is_empty(), problem.pairs.is_empty()) {
        (true, true) => SWEEPS,
        (true, false) => SWEEPS_FOR_PAIRS,
        (false, _) => SWEEPS_FOR_FORCES,
    };
    let topology = sweeps::improve(&mut built.certificate, sweeps, false)?;
    // The bound and the forces, in balls.
    let certificate = &built.certificate;
    let state = certificate.balanced::<Ball>(topology)?;
    let proof = certificate.sum(&state)?;
    let quantities = quantities::prove(&parts, (solution, &v), &built, (&state, &proof), asked);
    let bound = certificate.with_lifts(proof.bound);
    // Of a body that hardly strains the energy norm is rounding.
    let hardly_strains = solution.enclosure.as_ref().is_ok_and(|e| e.hardly_strains);
    let relative = match proof.norm {
        norm if norm > 0.0 && !hardly_strains => (Ball::point(bound) / Ball::point(norm)).upper(),
        _ => f64::INFINITY,
    };
    let energy = energy(&parts, &built, &proof);
    // Doubling is exact.
    let compliance =
        energy.filter(|_| is_loaded_only(certificate)).map(|[low, high]| [-2.0 * high, -2.0 * low]);
    // The field that was given.
    let distances = distances(mesh, &built, field);
    let square = |&d: &f64| Ball::point(d) * Ball::point(d);
    let clipping = distances.iter().map(square).fold(Ball::from(0), |sum, d| sum + d);
    let clipping = clipping.sqrt().upper();
    let of_field = if clipping == 0.0 {
        bound
    } else {
        let shape = built.shape(mesh, field);
        let as_it_is = bound_at(&built.certificate, state, &proof, (shape, &distances));
        let beside = (clipping + certificate.lift()).next_up();
        let [as_it_is, beside] = [as_it_is, beside].map(Ball::point);
        let together = (as_it_is * as_it_is + beside * beside).sqrt().upper();
        together.min((bound + clipping).next_up())
    };
    let indicators = indicators(mesh, &built, &proof, &distances);
    let problem = certificate.problem(&proof);
    let Built { certificate, oscillation, .. } = built;
    Ok(Continuous {
        bound,
        relative,
        displacement: v.nodal(mesh),
        rigorous: oscillation.reason.is_none(),
        reason: oscillation.reason,
        problem,
        indicators,
        energy,
        compliance,
        certificate,
        proof,
        clipping,
        of_field,
        missed,
        quantities,
    })
}

/// Fields whose distance on a triangle is below this part of the bound, shared out equally, differ by rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// The root of the right side of the theorem with the strain of another displacement w; what contact adds stays that of v.
/// `distances` are upper bounds of |v - w|_a on the triangles. Where that is the rounding of their data, the root of the
/// share grows by it at most, by the triangle inequality, since what contact adds is not negative.
fn bound_at(
    certificate: &Certificate,
    mut state: Balanced<Ball>,
    proof: &Proof,
    (field, distances): (Shape<Ball>, &[f64]),
) -> f64 {
    state.v = field;
    let positive = |x: Ball| x.split(|_| Ball::from(0), |x| x);
    let negligible = NEGLIGIBLE * proof.bound / (proof.shares.len() as f64).sqrt();
    let mut sum = Ball::from(0);
    for (t, (&share, &distance)) in proof.shares.iter().zip(distances).enumerate() {
        sum += if distance <= negligible {
            let root = positive(Ball::point(share)).sqrt() + Ball::point(distance);
            root * root
        } else {
            let (_, apart) = state.stresses(certificate, t);
            certificate.share(&state, t, &apart)
        };
    }
    positive(sum).sqrt().upper()
}

/// Refuses what no certificate is about, and what takes more memory than there is; returns whether v is quadratic beside a solution that is.
fn check(
    problem: &Problem,
    solution: &Solution,
    start: &[[f64; 2]],
    asked: &Asked,
) -> Result<bool, CertifyError> {
    if problem.material.are_of_revolution() {
        return Err(CertifyError::Unsupported(
            "the body is one of revolution, and certificates are about plane bodies".to_owned(),
        ));
    }
    check_laws(solution)?;
    // Beside a quadratic v each is cut in four.
    let quadratic = solution.degree == Degree::Two && start.len() > problem.mesh.vertices().len();
    let quarters = if quadratic { 4 } else { 1 };
    let triangles = problem.mesh.triangles().len();
    let per_triangle =
        if asked.forces.is_empty() { PER_TRIANGLE } else { per_triangle_with_forces(triangles) };
    memory::check(quarters * per_triangle * triangles as u64)?;
    Ok(quadratic)
}

/// v from `start`, pushed out of the obstacle as far as balls ask for, and the certificate of it with the stress of `y`.
fn pushed_out(
    parts: &ProblemParts,
    y: &Field,
    mut start: Field,
) -> Result<(Field, Built), CertifyError> {
    // Between tied bodies v has values of its own where nodes face edges, and along an arc it follows the obstacle, as only a
    // quadratic one does.
    if parts.contact.iter().any(|contact| contact.is_tied() || contact.turns()) {
        start.bulges.get_or_insert_with(|| vec![[0.0; 2]; parts.mesh.edge_count()]);
    }
    let (mut further, mut pushes) = (vec![0.0; parts.contact.len()], 0);
    loop {
        let v = admissible::admissible(parts, &start, &further);
        let mut built = build::build(parts, y, &v);
        tie::tie(&mut built.certificate)?;
        let found = built.penetrations(parts);
        if found.is_empty() || pushes == PUSHES {
            return Ok((v, built));
        }
        found.iter().for_each(|&(k, by)| further[k] += 2.0 * by);
        pushes += 1;
    }
}

/// J(u) lies between these; the energy of friction is not in J(v), and data outside the exact class leave nothing to say.
fn energy(parts: &ProblemParts, built: &Built, proof: &Proof) -> Option<[f64; 2]> {
    let has_friction = parts.contact.iter().any(|contact| contact.has_friction());
    (built.oscillation.reason.is_none() && !has_friction).then(|| {
        let b = Ball::point(proof.bound);
        let below = Ball::point(proof.energy[0]) - b * b / Ball::from(2);
        [below.lower(), proof.energy[1]]
    })
}

/// The root of each triangle's share in the square of the bound, and the distance of v from the field there, which are `distances` on the
/// triangles of the certificate.
fn indicators(mesh: &Mesh, built: &Built, proof: &Proof, distances: &[f64]) -> Vec<f64> {
    let mut shares = vec![0.0; mesh.triangles().len()];
    built.origins.iter().zip(&proof.shares).for_each(|(&t, share)| shares[t] += share);
    built.oscillation.lifts.iter().for_each(|(&t, z)| shares[t] += z * z);
    let mut apart = vec![0.0; shares.len()];
    built.origins.iter().zip(distances).for_each(|(&t, d)| apart[t] += d * d);
    let both = |(share, distance): (f64, &f64)| share.max(0.0).sqrt() + distance.sqrt();
    shares.into_iter().zip(&apart).map(both).collect()
}

/// Refuses the laws of contact that no certificate is about.
fn check_laws(solution: &Solution) -> Result<(), CertifyError> {
    for piece in &solution.pieces {
        let has_slipped = piece.geometry.nodes.iter().any(|node| node.slip != 0.0);
        let why = match piece.geometry.law {
            Law::Friction(_) if has_slipped => "has slipped in a load step before",
            Law::Contact | Law::Sliding | Law::Bonded | Law::Friction(Bound::Tresca(_)) => continue,
            Law::Friction(_) => {
                "has friction that depends on the pressure; certificates are for a given bound, { tresca = ... }"
            }
        };
        let name = quoted(piece.boundary(), '\'');
        return Err(CertifyError::Unsupported(format!("the boundary {name} {why}")));
    }
    Ok(())
}

/// Returns whether u_D = 0 and g = 0, so that with u all its multiples t u, t >= 0, are admissible: then a(u, u) = L(u) and
/// J(u) = -L(u) / 2.
fn is_loaded_only(certificate: &Certificate) -> bool {
    let is_zero = |gap: [f64; 2]| gap == [0.0; 2];
    let data = certificate.curved.iter().flat_map(|curved| &curved.data);
    let at_cuts = certificate.curved.iter().flat_map(|curved| &curved.prescribed);
    let prescribed = certificate.prescribed.iter().chain(at_cuts);
    data.into_iter().all(|&bulge| is_zero(bulge))
        && prescribed.flatten().flatten().all(|&u| u == 0.0)
        && certificate.edges.iter().all(|edge| match edge.role {
            Role::Contact { gap, law, .. } => is_zero(gap) && is_zero(law.offset()),
            _ => true,
        })
}

/// Upper bounds of |v - w|_a on the triangles of a certificate, for its v and a field w.
fn distances(mesh: &Mesh, built: &Built, w: &[[f64; 2]]) -> Vec<f64> {
    let certificate = &built.certificate;
    let ends = w.split_at(mesh.vertices().len()).0;
    let affine = certificate.curved.is_none() && ends.len() == w.len();
    let (v, w) = (certificate.shape::<Ball>(), built.shape::<Ball>(mesh, w));
    let minus = |a: Vec<Vector2<Ball>>, b: Vec<Vector2<Ball>>| -> Vec<Vector2<Ball>> {
        a.into_iter().zip(b).map(|(a, b)| a - b).collect()
    };
    let bulges = match (v.bulges, w.bulges) {
        (Some(v), Some(w)) => Some(minus(v, w)),
        (v, w) => v.or(w),
    };
    let difference = Shape { points: minus(v.points, w.points), bulges };
    let places = certificate.places::<Ball>();
    let distance = |(piece, &t): (&Piece, &usize)| {
        let same = |k: &usize| {
            certificate.displacement[*k] == ends[*k] && !certificate.frames.contains_key(k)
        };
        if affine && mesh.triangles()[t].iter().all(same) {
            return 0.0;
        }
        let triangle = Triangle { vertices: piece.vertices.map(|p| places[p]) };
        let stress = difference.stress(piece, &triangle);
        let square = stress.energy(&piece.material(), triangle.double_area());
        square.split(|_| Ball::from(0), |square| square).sqrt().upper()
    };
    certificate.pieces.iter().zip(&built.origins).map(distance).collect()
}
