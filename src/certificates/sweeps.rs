//! A better stress: minimises |C eps(v) - tau| over the stresses in equilibrium, vertex by vertex.
//!
//! Stresses that may be added to tau have no divergence, and no traction where the boundary prescribes it. Each is the stress of an
//! Airy function, tau = (Phi_yy, Phi_xx, -Phi_xy), and the composite stresses are those of the composite cubics of Hsieh,
//! Clough and Tocher, whose unknowns are Phi and grad Phi at vertices and one normal slope for each edge. Along an edge
//! tau N = dq/ds with q = (Phi_y, -Phi_x) = (1 - s) q_a + s q_b + 4 s (1 - s) z, so that
//!
//! tau N = q_b - q_a + 4 z at the start, q_b - q_a - 4 z at the end,   z . N = 3/2 (Phi_b - Phi_a) - 3/4 (q_a + q_b) . N,
//!
//! since the integral of grad Phi along the edge, which is that of q . N, is Phi_b - Phi_a; z . E is the edge's own
//! unknown. One sweep goes to every vertex and solves for its three unknowns and those of its edges together. A triangle has
//! twelve unknowns, three for each vertex and one for each edge; the energy's second derivative by them is computed once for
//! each shape of triangle that is met, and the small systems of the vertices are factorised once. What a body force that is
//! not constant bends tau by is not seen here: it falls with h^2, and where v is quadratic to see it gains nothing.

use std::collections::VecDeque;

use nalgebra::Vector2;

use super::balanced::{Balanced, Change, Topology, Unbalanced};
use super::certificate::{Certificate, Edge, Law, Role, turned};
use super::proof::Rejection;
use crate::kernel::composite::{Composite, Frame, Loads};
use crate::kernel::{Material, Stress, Triangle};

/// The unknowns of a triangle: Phi, Phi_x, Phi_y at its vertices, then those of its edges.
const UNKNOWNS: usize = 12;

/// The second derivative of |C eps(v) - tau|^2 / 2 on a triangle by its unknowns, over its largest entry: it is what the sweeps
/// read again and again, and need not be known to more digits than the best step. So triangles of one material whose edges are
/// the same to single precision share it.
struct ScaledHessian {
    hessian: [[f32; UNKNOWNS]; UNKNOWNS],
    /// Its largest entry.
    scale: f64,
}

/// The number of Hessians that are looked through: meshes that were refined have few, others as many as triangles.
const RECENT: usize = 8;

/// A Hessian that was met, by its number, with what it depends on, two edges and the moduli, and the stresses of the unknowns.
struct Met {
    shape: ([[f32; 2]; 2], Material<f64>),
    number: usize,
    units: [[f64; UNKNOWNS]; FEATURES],
}

/// Improves the tractions of `certificate` in `count` sweeps, and leaves them in equilibrium up to rounding; `on_rollers`
/// those of edges that are held along their normal, an axis, too. Returns how its triangles and edges hang together.
///
/// # Errors
/// A condition of the theorem that does not hold.
pub(super) fn improve(
    certificate: &mut Certificate,
    count: usize,
    on_rollers: bool,
) -> Result<Topology, Rejection> {
    let mut state = certificate.balanced::<f64>(certificate.topology()?)?;
    let mut sweeps = Sweeps::new(certificate, &state, on_rollers);
    for sweep in 0..count {
        sweeps.go(sweep % 2 == 1);
    }
    give(&state, certificate);
    sweeps.add_to(certificate, &state);
    // The sums have left their rounding errors.
    rebalance(&mut state, certificate)?;
    give(&state, certificate);
    Ok(state.topology)
}

/// Gives the edges of the certificate the tractions that balance.
fn give(state: &Balanced<f64>, certificate: &mut Certificate) {
    for (e, &now) in state.balance.forces.iter().enumerate() {
        let units = certificate.units(e, &state.points);
        match &mut certificate.edges[e].role {
            Role::Inner(force) | Role::Held(_, force) => *force = now.map(Into::into),
            Role::Supported { along, force, .. } => {
                let d = Vector2::from(*along);
                *force = now.map(|f| f.dot(&d) / d.dot(&d));
            }
            Role::Contact { pressure, law, .. } if law.is_tied() => {
                // Where the direction turns it is one, and so is the work on both ends.
                let work = [0, 1].map(|k| now[k].dot(&units[k]));
                let square = [0, 1].map(|k| units[k].dot(&units[k]));
                if units[0] != units[1] {
                    *pressure = [(work[0] + work[1]) / (square[0] + square[1]); 2];
                    continue;
                }
                for k in 0..2 {
                    let unit = units[k];
                    pressure[k] = work[k] / square[k];
                    if let Law::Bonded { shear, .. } = law {
                        shear[k] = now[k].dot(&turned(unit)) / unit.dot(&unit);
                    }
                }
            }
            Role::Loaded(_) | Role::Pressed(_) | Role::Contact { .. } | Role::Facing => {}
        }
    }
    for &Change { edge, factors } in &state.balance.changes {
        if let Role::Contact { pressure, .. } = &mut certificate.edges[edge].role {
            (0..2).for_each(|k| pressure[k] = (pressure[k] * (1.0 + factors[k])).min(0.0));
        }
    }
}

/// Takes over the forces that the certificate has now on edges between triangles and of Gamma_D.
fn rebalance(state: &mut Balanced<f64>, certificate: &Certificate) -> Result<(), Unbalanced> {
    let now = certificate.tractions(&state.points);
    for ((force, edge), now) in state.forces.iter_mut().zip(&certificate.edges).zip(now) {
        let is_given = match edge.role {
            Role::Contact { law, .. } => !law.is_tied(),
            role => matches!(role, Role::Loaded(_) | Role::Pressed(_) | Role::Facing),
        };
        if !is_given {
            *force = now;
        }
    }
    for &Change { edge, factors } in &state.balance.changes {
        (0..2).for_each(|k| state.forces[edge][k] *= 1.0 + factors[k]);
    }
    certificate.face(&mut state.forces);
    let Balanced { points, triangles, topology, forces, balance, .. } = state;
    *balance = certificate.equilibrium((points, triangles), topology, forces)?;
    Ok(())
}

/// An unknown of a triangle as an unknown of a star.
#[derive(Clone, Copy)]
struct StarUnknown {
    triangle: usize,
    unknown: usize,
    in_star: usize,
    /// -1 where an edge runs the other way round in the triangle.
    sign: f64,
}

/// The triangles around a point, whose unknowns there change together: those of the point that are free, then one for each free
/// edge at it.
#[derive(Default)]
struct Star {
    /// Triangle by triangle.
    places: Vec<StarUnknown>,
    own: Vec<usize>,
    edges: Vec<usize>,
    /// The lower half of the factor of the star's system, row by row; none where the unknowns are not independent.
    factor: Vec<f64>,
}

struct Sweeps {
    hessians: Vec<ScaledHessian>,
    /// The Hessian of each triangle, and the derivative at the present stress.
    energies: Vec<(usize, [f64; UNKNOWNS])>,
    stars: Vec<Star>,
    /// The unknowns: of the points, and of the edges.
    at_points: Vec<[f64; 3]>,
    on_edges: Vec<f64>,
}

impl Sweeps {
    fn new(certificate: &Certificate, state: &Balanced<f64>, on_rollers: bool) -> Sweeps {
        let points = state.points.len();
        // The edges whose traction is free, and which of Phi, Phi_x and Phi_y are at the points.
        let is_free =
            |edge: &Edge| matches!(edge.role, Role::Inner(_) | Role::Held([true, true], _));
        let mut free = vec![[true; 3]; points];
        for edge in certificate.edges.iter().filter(|edge| !is_free(edge)) {
            let may = if on_rollers { along_the_normal(edge, state) } else { [false; 3] };
            for p in edge.ends {
                (0..3).for_each(|k| free[p][k] &= may[k]);
            }
        }
        let own = |free: [bool; 3]| (0..3).filter(|&k| free[k]).collect();
        let star = |free| Star { own: own(free), ..Star::default() };
        let mut stars: Vec<Star> = free.into_iter().map(star).collect();
        for (triangle, piece) in certificate.pieces.iter().enumerate() {
            for (local, &point) in piece.vertices.iter().enumerate() {
                let Star { places, own, edges, .. } = &mut stars[point];
                let at_point = own.iter().enumerate();
                places.extend(at_point.map(|(in_star, &k)| StarUnknown {
                    triangle,
                    unknown: 3 * local + k,
                    in_star,
                    sign: 1.0,
                }));
                for side in [(local + 1) % 3, (local + 2) % 3] {
                    let e = piece.edges[side];
                    if !is_free(&certificate.edges[e]) {
                        continue;
                    }
                    let seen = edges.iter().position(|&other| other == e);
                    let in_star = own.len() + seen.unwrap_or(edges.len());
                    if seen.is_none() {
                        edges.push(e);
                    }
                    let is_left = state.topology.owners[e][0] == Some(triangle);
                    let sign = if is_left { 1.0 } else { -1.0 };
                    places.push(StarUnknown { triangle, unknown: 9 + side, in_star, sign });
                }
            }
        }
        let (hessians, energies) = energies(certificate, state);
        for star in &mut stars {
            star.factorise(&hessians, &energies);
        }
        let on_edges = vec![0.0; certificate.edges.len()];
        Sweeps { hessians, energies, stars, at_points: vec![[0.0; 3]; points], on_edges }
    }

    /// To every point and its star, forwards or backwards.
    fn go(&mut self, backwards: bool) {
        let points = self.at_points.len();
        let mut values = Vec::new();
        for k in 0..points {
            self.minimise(if backwards { points - 1 - k } else { k }, &mut values);
        }
    }

    fn minimise(&mut self, point: usize, x: &mut Vec<f64>) {
        let Sweeps { hessians, energies, stars, at_points, on_edges } = self;
        let star = &stars[point];
        if star.factor.is_empty() {
            return;
        }
        x.clear();
        x.resize(star.unknowns(), 0.0);
        for &StarUnknown { triangle, unknown, in_star, sign } in &star.places {
            x[in_star] -= sign * energies[triangle].1[unknown];
        }
        substitute(&star.factor, x);
        for &StarUnknown { triangle, unknown, in_star, sign } in &star.places {
            let (number, gradient) = &mut energies[triangle];
            let ScaledHessian { hessian, scale } = &hessians[*number];
            let value = x[in_star] * sign * scale;
            let row = &hessian[unknown];
            gradient.iter_mut().zip(row).for_each(|(sum, &h)| *sum += value * f64::from(h));
        }
        let (own, of_edges) = x.split_at(star.own.len());
        star.own.iter().zip(own).for_each(|(&k, x)| at_points[point][k] += x);
        star.edges.iter().zip(of_edges).for_each(|(&e, x)| on_edges[e] += x);
    }

    /// Adds the stress of the unknowns to the tractions of the certificate.
    fn add_to(&self, certificate: &mut Certificate, state: &Balanced<f64>) {
        for (edge, on_edge) in certificate.edges.iter_mut().zip(&self.on_edges) {
            let (held, force) = match &mut edge.role {
                Role::Inner(force) => ([true; 2], force),
                Role::Held(held, force) => (*held, force),
                _ => continue,
            };
            let ends = edge.ends.map(|p| state.points[p]);
            for (side, &p) in edge.ends.iter().enumerate() {
                let modes = modes(ends, side == 1);
                for (value, mode) in self.at_points[p].iter().zip(&modes) {
                    add(force, held, *value, mode);
                }
                if side == 0 {
                    add(force, held, *on_edge, &modes[3]);
                }
            }
        }
    }
}

impl Star {
    fn unknowns(&self) -> usize {
        self.own.len() + self.edges.len()
    }

    fn factorise(&mut self, hessians: &[ScaledHessian], energies: &[(usize, [f64; UNKNOWNS])]) {
        let n = self.unknowns();
        let mut matrix = vec![0.0; n * n];
        for places in self.places.chunk_by(|a, b| a.triangle == b.triangle) {
            let ScaledHessian { hessian, scale } = &hessians[energies[places[0].triangle].0];
            for a in places {
                for b in places {
                    let h = f64::from(hessian[a.unknown][b.unknown]);
                    matrix[a.in_star * n + b.in_star] += scale * a.sign * b.sign * h;
                }
            }
        }
        if n > 0 {
            self.factor = factor_positive(&mut matrix, n).unwrap_or_default();
        }
    }
}

fn add(force: &mut [[f64; 2]; 2], held: [bool; 2], factor: f64, mode: &[Vector2<f64>; 2]) {
    for (force, mode) in force.iter_mut().zip(mode) {
        (0..2).filter(|&c| held[c]).for_each(|c| force[c] += factor * mode[c]);
    }
}

/// Which of Phi, Phi_x and Phi_y are free at the ends of an edge that is not free itself: where it is held along its normal,
/// an axis, Phi and the slope along the edge are, which leave tau N along the normal.
fn along_the_normal(edge: &Edge, state: &Balanced<f64>) -> [bool; 3] {
    let [a, b] = edge.ends.map(|p| state.points[p]);
    match edge.role {
        Role::Held([true, false], _) if a.x == b.x => [true, false, true],
        Role::Held([false, true], _) if a.y == b.y => [true, true, false],
        _ => [false; 3],
    }
}

/// The number of [`features`].
const FEATURES: usize = 21;

/// |C eps(v) - tau|^2 / 2 on the triangles, as a function of their unknowns.
fn energies(
    certificate: &Certificate,
    state: &Balanced<f64>,
) -> (Vec<ScaledHessian>, Vec<(usize, [f64; UNKNOWNS])>) {
    let (mut hessians, mut recent) = (Vec::new(), VecDeque::with_capacity(RECENT));
    let mut energies = Vec::with_capacity(certificate.pieces.len());
    for (t, piece) in certificate.pieces.iter().enumerate() {
        let triangle = &state.triangles[t];
        let single = |edge: Vector2<f64>| [edge.x as f32, edge.y as f32];
        let shape = ([0, 1].map(|i| single(triangle.edge(i))), piece.material);
        let known = recent.iter().position(|met: &Met| met.shape == shape);
        let known = known.unwrap_or_else(|| {
            let units = units(triangle, &piece.material);
            recent.truncate(RECENT - 1);
            recent.push_front(Met { shape, number: hessians.len(), units });
            hessians.push(hessian_of(&units));
            0
        });
        let Met { number, units, .. } = &recent[known];
        let tau = Composite::new(&Frame::new(triangle), &state.loads(piece, t));
        let distance = tau.distance_from(&state.v.stress(piece, triangle));
        let distance = features(&distance, triangle, &piece.material);
        let mut gradient = [0.0; UNKNOWNS];
        for (row, distance) in units.iter().zip(distance) {
            gradient.iter_mut().zip(row).for_each(|(sum, unit)| *sum -= unit * distance);
        }
        energies.push((*number, gradient));
    }
    (hessians, energies)
}

/// The [`features`] of the stresses of a triangle's unknowns, with edges that go round it.
fn units(triangle: &Triangle<f64>, material: &Material<f64>) -> [[f64; UNKNOWNS]; FEATURES] {
    let frame = Frame::new(triangle);
    let mut all = [[[Vector2::zeros(); 2]; 3]; UNKNOWNS];
    for side in 0..3 {
        let vertices = [1, 2].map(|k| (side + k) % 3);
        let places = vertices.map(|vertex| triangle.vertices[vertex]);
        for (k, vertex) in vertices.into_iter().enumerate() {
            let [phi, phi_x, phi_y, own] = modes(places, k == 1);
            let at_vertex = [phi, phi_x, phi_y].into_iter().zip(&mut all[3 * vertex..]);
            at_vertex.for_each(|(mode, forces)| forces[side] = mode);
            all[9 + side][side] = own;
        }
    }
    let (mut units, body) = ([[0.0; UNKNOWNS]; FEATURES], [Vector2::zeros(); 3]);
    for (k, forces) in all.into_iter().enumerate() {
        let tau = features(&Composite::new(&frame, &Loads { forces, body }), triangle, material);
        units.iter_mut().zip(tau).for_each(|(row, value)| row[k] = value);
    }
    units
}

/// The products of the columns.
fn hessian_of(units: &[[f64; UNKNOWNS]; FEATURES]) -> ScaledHessian {
    let mut exact = [[0.0; UNKNOWNS]; UNKNOWNS];
    for unit in units {
        for (row, a) in exact.iter_mut().zip(unit) {
            row.iter_mut().zip(unit).for_each(|(sum, b)| *sum += a * b);
        }
    }
    let scale = exact.as_flattened().iter().fold(0.0, |most: f64, h| most.max(h.abs()));
    ScaledHessian { hessian: exact.map(|row| row.map(|h| (h / scale) as f32)), scale }
}

/// Numbers whose sum of squares is [`Composite::energy`] of a stress that is not bent.
///
/// On a part with the corners a, b and the centre c, a^2 + b^2 + c^2 + (a + b + c)^2 is, with s = a + b + 2/3 c,
/// 3/2 s^2 + 1/2 (a - b)^2 + 4/3 c^2.
fn features(
    tau: &Composite<f64>,
    triangle: &Triangle<f64>,
    material: &Material<f64>,
) -> [f64; FEATURES] {
    let squares = material.squares();
    let [bulk, shear, other] = squares.pivots();
    // |T|/144 over the moduli
    let roots = [shear, other, bulk].map(|m| (triangle.double_area() / (288.0 * m)).sqrt());
    let mut all = [0.0; FEATURES];
    let on_part = |[a, b]: [Stress<f64>; 2]| {
        [(1.5_f64.sqrt(), a + b + tau.centre / 1.5), (0.5_f64.sqrt(), a - b)]
    };
    let stresses = tau.corners.into_iter().flat_map(on_part).chain([(2.0, tau.centre)]);
    for (three, (factor, s)) in all.as_chunks_mut::<3>().0.iter_mut().zip(stresses) {
        let parts = squares.parts(s);
        *three = [0, 1, 2].map(|k| factor * roots[k] * parts[k]);
    }
    all
}

/// The forces at start and end of an edge for unit values, at one of its ends, of Phi, Phi_x and Phi_y, and of the
/// edge's own unknown.
fn modes([start, end]: [Vector2<f64>; 2], at_end: bool) -> [[Vector2<f64>; 2]; 4] {
    let along = end - start;
    let squared = along.dot(&along);
    let normal = Vector2::new(along.y, -along.x);
    let sign = if at_end { 1.0 } else { -1.0 };
    let bubble = |z: Vector2<f64>, q: Vector2<f64>| [q * sign + z * 4.0, q * sign - z * 4.0];
    let slope = |q: Vector2<f64>| bubble(normal * (-0.75 * q.dot(&normal) / squared), q);
    [
        bubble(normal * (sign * 1.5) / squared, Vector2::zeros()),
        slope(-Vector2::y()),
        slope(Vector2::x()),
        bubble(along / squared, Vector2::zeros()),
    ]
}

/// The lower half of the Cholesky factor of a small positive definite matrix, row by row, which the matrix is overwritten with; none if
/// it is not definite, as for a star whose unknowns are not independent. The diagonal holds the reciprocals.
pub(super) fn factor_positive(matrix: &mut [f64], n: usize) -> Option<Vec<f64>> {
    for i in 0..n {
        let (above, row) = matrix.split_at_mut(i * n);
        let row = &mut row[..n];
        let whole = row[i];
        for j in 0..i {
            let other = &above[j * n..j * n + j + 1];
            let sum: f64 = row[..j].iter().zip(other).map(|(a, b)| a * b).sum();
            row[j] = (row[j] - sum) * other[j];
        }
        let pivot = whole - row[..i].iter().map(|a| a * a).sum::<f64>();
        if !(pivot > 1e-13 * whole) {
            return None;
        }
        row[i] = 1.0 / pivot.sqrt();
    }
    let rows = matrix.chunks_exact(n).enumerate();
    Some(rows.flat_map(|(i, row)| &row[..=i]).copied().collect())
}

/// Solves with that factor, in place.
pub(super) fn substitute(factor: &[f64], x: &mut [f64]) {
    let n = x.len();
    let mut rest = factor;
    for i in 0..n {
        let (row, below) = rest.split_at(i + 1);
        rest = below;
        let sum: f64 = row[..i].iter().zip(&*x).map(|(a, b)| a * b).sum();
        x[i] = (x[i] - sum) * row[i];
    }
    let mut rest = factor;
    for i in (0..n).rev() {
        let (above, row) = rest.split_at(rest.len() - i - 1);
        rest = above;
        x[i] *= row[i];
        let known = x[i];
        x[..i].iter_mut().zip(row).for_each(|(x, a)| *x -= known * a);
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::kernel::Plane;

    #[test]
    fn squares_of_the_features_of_a_stress_add_up_to_its_energy() {
        let vertices = [[0.3, -0.2], [2.0, 0.1], [0.7, 1.9]].map(Vector2::from);
        let triangle = Triangle { vertices };
        let material = Material::lame(1.3, 0.7, Plane::Strain);
        let squares = |tau: &Composite<f64>| {
            features(tau, &triangle, &material).iter().map(|x| x * x).sum::<f64>()
        };
        let body = [Vector2::zeros(); 3];
        let mut sizes = [0.0; 7];
        for (side, k, c) in (0..12).map(|n| (n / 4, n / 2 % 2, n % 2)) {
            let mut forces = [[Vector2::zeros(); 2]; 3];
            forces[side][k][c] = 1.0;
            forces[(side + 1) % 3][1 - k][1 - c] = -0.3;
            let tau = Composite::new(&Frame::new(&triangle), &Loads { forces, body });
            let energy = tau.energy(&material, triangle.double_area());
            // Some fifty roundings of positive terms.
            assert_relative_eq!(squares(&tau), energy, max_relative = 1e-13);
            for (size, part) in
                sizes.iter_mut().zip(tau.corners.as_flattened().iter().chain([&tau.centre]))
            {
                *size += part.components().iter().map(|c| c.abs()).sum::<f64>();
            }
        }
        // Control: each part of a stress was there.
        assert!(sizes.iter().all(|size| *size > 0.1), "{sizes:?}");
    }
}
