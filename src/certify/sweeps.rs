//! A better stress: minimises |C eps(v) - tau| over the stresses in equilibrium, vertex by vertex.
//!
//! What may be added to tau has no divergence and no traction where the boundary prescribes one: it is the stress of an
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

use nalgebra::Vector2;

use super::balanced::{Balanced, Topology};
use super::certificate::{Certificate, Edge, Role};
use super::proof::Rejection;
use crate::kernel::composite::{Composite, Frame, Loads};
use crate::kernel::{Material, Stress, Triangle};

/// The unknowns of a triangle: Phi, Phi_x, Phi_y at its vertices, then those of its edges.
const UNKNOWNS: usize = 12;

/// Columns of a block of products.
const BLOCK: usize = 4;

/// The second derivative of |C eps(v) - tau|^2 / 2 on a triangle by its unknowns, over its largest entry: it is what the sweeps
/// read again and again, and need not be known to more digits than the best step. So triangles of one material whose edges are
/// the same to single precision share it.
struct ScaledHessian {
    hessian: [[f32; UNKNOWNS]; UNKNOWNS],
    /// Its largest entry.
    scale: f64,
}

/// The number of forms that are looked through: meshes that were refined have few, others as many as triangles.
const RECENT: usize = 8;

/// The key of a form: two edges and the moduli.
type ElementKey = ([[f32; 2]; 2], Material<f64>);

/// A form that was met, by its number, with the stresses of its unknowns.
struct Met {
    shape: ElementKey,
    form: u32,
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
    state.give(certificate);
    sweeps.add_to(certificate, &state);
    // The sums have left their rounding errors.
    state.rebalance(certificate)?;
    state.give(certificate);
    Ok(state.topology)
}

/// The triangles around each point, one list after the other: the list of point p is `of[first[p]..first[p + 1]]`.
struct Stars {
    first: Vec<usize>,
    of: Vec<(usize, usize)>,
}

impl Stars {
    fn new(certificate: &Certificate, points: usize) -> Stars {
        let mut first = vec![0; points + 1];
        for piece in &certificate.pieces {
            piece.vertices.iter().for_each(|&p| first[p + 1] += 1);
        }
        for p in 0..points {
            first[p + 1] += first[p];
        }
        let mut next = first.clone();
        let mut of = vec![(0, 0); 3 * certificate.pieces.len()];
        for (t, piece) in certificate.pieces.iter().enumerate() {
            for (local, &p) in piece.vertices.iter().enumerate() {
                of[next[p]] = (t, local);
                next[p] += 1;
            }
        }
        Stars { first, of }
    }

    fn around(&self, point: usize) -> &[(usize, usize)] {
        &self.of[self.first[point]..self.first[point + 1]]
    }
}

struct Sweeps {
    /// The edges of each triangle.
    edges: Vec<[usize; 3]>,
    forms: Vec<ScaledHessian>,
    /// The form of each triangle, and the derivative at the present stress.
    energies: Vec<(u32, [f64; UNKNOWNS])>,
    /// The sign of each edge's own unknown in a triangle: -1 where the edge runs the other way round.
    signs: Vec<[f64; 3]>,
    stars: Stars,
    /// Whose traction is free.
    free_edge: Vec<bool>,
    /// Which of Phi, Phi_x and Phi_y.
    free_point: Vec<[bool; 3]>,
    /// The unknowns: of the points, and of the edges.
    at_points: Vec<[f64; 3]>,
    on_edges: Vec<f64>,
    /// The systems of the stars: of each triangle in the order of `stars.of` the numbers of the edges beside its vertex; the
    /// free edges at the points, and the factors, each with the place where a point's begin. A point has no factor before
    /// the first sweep.
    sides: Vec<[Option<u32>; 2]>,
    star_edges: Vec<usize>,
    first_edge: Vec<usize>,
    factors: Vec<f64>,
    first_factor: Vec<usize>,
}

impl Sweeps {
    fn new(certificate: &Certificate, state: &Balanced<f64>, on_rollers: bool) -> Sweeps {
        let points = state.points.len();
        let free_edge: Vec<bool> = certificate
            .edges
            .iter()
            .map(|edge| matches!(edge.role, Role::Inner(_) | Role::Held([true, true], _)))
            .collect();
        let mut free_point = vec![[true; 3]; points];
        for (edge, free) in certificate.edges.iter().zip(&free_edge) {
            if !free {
                let may = if on_rollers { along_the_normal(edge, state) } else { [false; 3] };
                for p in edge.ends {
                    (0..3).for_each(|k| free_point[p][k] &= may[k]);
                }
            }
        }
        let stars = Stars::new(certificate, points);
        let (forms, energies) = energies(certificate, state);
        let sign = |t: usize| {
            let piece = &certificate.pieces[t];
            piece.edges.map(|e| match state.topology.owners[e][0] {
                Some(owner) if owner.piece == t => 1.0,
                _ => -1.0,
            })
        };
        let mut sweeps = Sweeps {
            forms,
            energies,
            signs: (0..certificate.pieces.len()).map(sign).collect(),
            sides: Vec::with_capacity(stars.of.len()),
            stars,
            star_edges: Vec::with_capacity(2 * free_edge.len()),
            first_edge: Vec::with_capacity(points + 1),
            factors: Vec::new(),
            first_factor: Vec::with_capacity(points + 1),
            edges: certificate.pieces.iter().map(|piece| piece.edges).collect(),
            free_point,
            at_points: vec![[0.0; 3]; points],
            on_edges: vec![0.0; free_edge.len()],
            free_edge,
        };
        sweeps.number();
        let size = |n: usize| n * (n + 1) / 2;
        sweeps.factors.reserve_exact((0..points).map(|point| size(sweeps.unknowns(point))).sum());
        sweeps.first_factor.push(0);
        sweeps
    }

    /// To every point and its star, forwards or backwards.
    fn go(&mut self, backwards: bool) {
        let points = self.at_points.len();
        let (mut values, mut matrix) = (Vec::new(), Vec::new());
        for k in 0..points {
            let point = if backwards { points - 1 - k } else { k };
            // The first sweep goes forwards, and finds a star in the cache.
            if self.first_factor.len() == point + 1 {
                self.factorise(point, &mut matrix);
            }
            self.minimise(point, &mut values);
        }
    }

    /// The number of unknowns that a point has.
    fn own(&self, point: usize) -> usize {
        self.free_point[point].iter().filter(|&&free| free).count()
    }

    /// Numbers the unknowns of every star: those of the point, if it is free, then one for each free edge at it.
    fn number(&mut self) {
        for point in 0..self.at_points.len() {
            let first = self.star_edges.len();
            self.first_edge.push(first);
            for &(triangle, local) in self.stars.around(point) {
                self.sides.push([1, 2].map(|k| {
                    let e = self.edges[triangle][(local + k) % 3];
                    if !self.free_edge[e] {
                        return None;
                    }
                    let seen = &self.star_edges[first..];
                    let place = seen.iter().position(|&other| other == e).unwrap_or(seen.len());
                    if place == seen.len() {
                        self.star_edges.push(e);
                    }
                    u32::try_from(place).ok()
                }));
            }
        }
        self.first_edge.push(self.star_edges.len());
    }

    /// The number of unknowns that a star has.
    fn unknowns(&self, point: usize) -> usize {
        self.own(point) + self.first_edge[point + 1] - self.first_edge[point]
    }

    /// The triangles of a star, each with its unknowns there and their numbers in the star.
    fn star(&self, point: usize) -> impl Iterator<Item = (usize, Places)> {
        let own = self.own(point);
        let free = self.free_point[point];
        let of = self.stars.first[point]..self.stars.first[point + 1];
        self.stars.of[of.clone()].iter().zip(&self.sides[of]).map(
            move |(&(triangle, local), sides)| {
                let mut places = Places { count: 0, of: [(0, 0, 0.0); 5] };
                let unknowns = (0..3).filter(|&k| free[k]).enumerate();
                unknowns.for_each(|(place, k)| places.push((3 * local + k, place, 1.0)));
                for (k, place) in sides.iter().enumerate() {
                    let side = (local + 1 + k) % 3;
                    let sign = self.signs[triangle][side];
                    place.iter().for_each(|&p| places.push((9 + side, own + p as usize, sign)));
                }
                (triangle, places)
            },
        )
    }

    /// The factor of the system of the next star, the rows of its lower half; none where there are no unknowns, or where these
    /// are not independent.
    fn factorise(&mut self, point: usize, matrix: &mut Vec<f64>) {
        let n = self.unknowns(point);
        matrix.clear();
        matrix.resize(n * n, 0.0);
        for (triangle, places) in self.star(point) {
            let ScaledHessian { hessian, scale } = &self.forms[self.energies[triangle].0 as usize];
            for &(a, i, sign) in places.all() {
                for &(b, j, other) in places.all() {
                    matrix[i * n + j] += scale * sign * other * f64::from(hessian[a][b]);
                }
            }
        }
        if n > 0 && factor_positive(matrix, n) {
            for (i, row) in matrix.chunks_exact(n).enumerate() {
                self.factors.extend_from_slice(&row[..=i]);
            }
        }
        self.first_factor.push(self.factors.len());
    }

    fn minimise(&mut self, point: usize, x: &mut Vec<f64>) {
        let factor = &self.factors[self.first_factor[point]..self.first_factor[point + 1]];
        if factor.is_empty() {
            return;
        }
        let own = self.own(point);
        x.clear();
        x.resize(self.unknowns(point), 0.0);
        for (triangle, places) in self.star(point) {
            let gradient = &self.energies[triangle].1;
            places.all().iter().for_each(|&(a, i, sign)| x[i] -= sign * gradient[a]);
        }
        substitute(factor, x);
        let mut energies = std::mem::take(&mut self.energies);
        for (triangle, places) in self.star(point) {
            let (form, gradient) = &mut energies[triangle];
            let ScaledHessian { hessian, scale } = &self.forms[*form as usize];
            let mut sum = *gradient;
            for &(a, i, sign) in places.all() {
                let value = x[i] * sign * scale;
                sum.iter_mut().zip(&hessian[a]).for_each(|(sum, &h)| *sum += value * f64::from(h));
            }
            *gradient = sum;
        }
        self.energies = energies;
        let values = self.at_points[point].iter_mut().zip(self.free_point[point]);
        for ((value, _), x) in values.filter(|(_, free)| *free).zip(&x[..own]) {
            *value += x;
        }
        let free = self.first_edge[point]..self.first_edge[point + 1];
        for (&e, x) in self.star_edges[free].iter().zip(&x[own..]) {
            self.on_edges[e] += x;
        }
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

/// The unknowns of a triangle in a star, each with its number in the star and its sign in the triangle.
struct Places {
    count: usize,
    of: [(usize, usize, f64); 5],
}

impl Places {
    fn push(&mut self, place: (usize, usize, f64)) {
        self.of[self.count] = place;
        self.count += 1;
    }

    fn all(&self) -> &[(usize, usize, f64)] {
        &self.of[..self.count]
    }
}

/// The number of [`features`].
const FEATURES: usize = 21;

/// |C eps(v) - tau|^2 / 2 on the triangles, as a function of their unknowns.
fn energies(
    certificate: &Certificate,
    state: &Balanced<f64>,
) -> (Vec<ScaledHessian>, Vec<(u32, [f64; UNKNOWNS])>) {
    let (mut forms, mut recent): (Vec<ScaledHessian>, Vec<Met>) =
        (Vec::new(), Vec::with_capacity(RECENT));
    let mut energies = Vec::with_capacity(certificate.pieces.len());
    let mut oldest = 0;
    for (t, piece) in certificate.pieces.iter().enumerate() {
        let triangle = &state.triangles[t];
        let single = |edge: Vector2<f64>| [edge.x as f32, edge.y as f32];
        let shape = ([0, 1].map(|i| single(triangle.edge(i))), piece.material);
        let known = recent.iter().position(|met| met.shape == shape).unwrap_or_else(|| {
            let units = units(triangle, &Roots::of(&piece.material, triangle));
            let form = forms.len() as u32;
            forms.push(form_of(&units));
            let met = Met { shape, form, units };
            if recent.len() < RECENT {
                recent.push(met);
                return recent.len() - 1;
            }
            oldest = (oldest + 1) % RECENT;
            recent[oldest] = met;
            oldest
        });
        let Met { form, units, .. } = &recent[known];
        let distance = state.without_bending(certificate, t).1;
        let distance = features(&distance, &Roots::of(&piece.material, triangle));
        let mut gradient = [0.0; UNKNOWNS];
        for (row, distance) in units.iter().zip(distance) {
            gradient.iter_mut().zip(row).for_each(|(sum, unit)| *sum -= unit * distance);
        }
        energies.push((*form, gradient));
    }
    (forms, energies)
}

/// The energy of a stress on a triangle as squares.
struct Roots {
    /// The roots of |T|/144 over the moduli of [`Squares`]: for the deviator, the shear and the sphere.
    roots: [f64; 3],
    /// Its L.
    coupling: [f64; 3],
}

impl Roots {
    fn of(material: &Material<f64>, triangle: &Triangle<f64>) -> Self {
        let scale = triangle.double_area() / 288.0;
        let squares = material.squares();
        let [sphere, deviator, shear] = squares.pivots();
        Roots {
            roots: [deviator, shear, sphere].map(|modulus| (scale / modulus).sqrt()),
            coupling: squares.beyond.map_or([0.0; 3], |(_, coupling)| coupling),
        }
    }
}

/// The [`features`] of the stresses of a triangle's unknowns, with edges that go round it.
fn units(triangle: &Triangle<f64>, roots: &Roots) -> [[f64; UNKNOWNS]; FEATURES] {
    let frame = Frame::new(triangle);
    let mut units = [[0.0; UNKNOWNS]; FEATURES];
    let (zero, body) = ([[Vector2::zeros(); 2]; 3], [Vector2::zeros(); 3]);
    let mut put = |k: usize, forces: [[Vector2<f64>; 2]; 3]| {
        let tau = features(&Composite::new(&frame, &Loads { forces, body }), roots);
        units.iter_mut().zip(tau).for_each(|(row, value)| row[k] = value);
    };
    let mut at_vertices = [zero; 9];
    for side in 0..3 {
        let vertices = [1, 2].map(|k| (side + k) % 3);
        let places = vertices.map(|vertex| triangle.vertices[vertex]);
        for (k, vertex) in vertices.into_iter().enumerate() {
            let modes = modes(places, k == 1);
            (0..3).for_each(|c| at_vertices[3 * vertex + c][side] = modes[c]);
            if k == 0 {
                let mut forces = zero;
                forces[side] = modes[3];
                put(9 + side, forces);
            }
        }
    }
    for (k, forces) in at_vertices.into_iter().enumerate() {
        put(k, forces);
    }
    units
}

fn form_of(units: &[[f64; UNKNOWNS]; FEATURES]) -> ScaledHessian {
    let exact = gram(units);
    let scale = exact.as_flattened().iter().fold(0.0, |most: f64, h| most.max(h.abs()));
    ScaledHessian { hessian: exact.map(|row| row.map(|h| (h / scale) as f32)), scale }
}

/// The products of the columns, by blocks that stay in registers; the upper half is the lower one.
fn gram(rows: &[[f64; UNKNOWNS]; FEATURES]) -> [[f64; UNKNOWNS]; UNKNOWNS] {
    let mut products = [[0.0; UNKNOWNS]; UNKNOWNS];
    for i in (0..UNKNOWNS).step_by(BLOCK) {
        for j in (0..=i).step_by(BLOCK) {
            let mut block = [[0.0; BLOCK]; BLOCK];
            for row in rows {
                for (sums, a) in block.iter_mut().zip(&row[i..i + BLOCK]) {
                    sums.iter_mut().zip(&row[j..j + BLOCK]).for_each(|(sum, b)| *sum += a * b);
                }
            }
            for (k, sums) in block.iter().enumerate() {
                products[i + k][j..j + BLOCK].copy_from_slice(sums);
                (0..BLOCK).for_each(|l| products[j + l][i + k] = sums[l]);
            }
        }
    }
    products
}

/// Numbers whose sum of squares is [`Composite::energy`] of a stress that is not bent.
///
/// On a part with the corners a, b and the centre c, a^2 + b^2 + c^2 + (a + b + c)^2 is, with s = a + b + 2/3 c,
/// 3/2 s^2 + 1/2 (a - b)^2 + 4/3 c^2.
fn features(tau: &Composite<f64>, roots: &Roots) -> [f64; FEATURES] {
    let ([deviator, shear, sphere], [a, b, c]) = (roots.roots, roots.coupling);
    let mut all = [0.0; FEATURES];
    let mut k = 0;
    let mut put = |factor: f64, s: Stress<f64>| {
        let [xx, yy, xy] = s.components();
        let mean = xx + yy;
        let apart = xx - yy - a * mean;
        all[k] = factor * deviator * apart;
        all[k + 1] = factor * shear * (2.0 * xy - b * mean - c * apart);
        all[k + 2] = factor * sphere * mean;
        k += 3;
    };
    for [a, b] in tau.corners {
        put(1.5_f64.sqrt(), a + b + tau.centre / 1.5);
        put(0.5_f64.sqrt(), a - b);
    }
    put(2.0, tau.centre);
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

/// The Cholesky factor of a small positive definite matrix, in its lower half; false if it is
/// not definite, as for a star whose unknowns are not independent. The diagonal holds the reciprocals.
pub(super) fn factor_positive(matrix: &mut [f64], n: usize) -> bool {
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
            return false;
        }
        row[i] = 1.0 / pivot.sqrt();
    }
    true
}

/// Solves with that factor, of which the rows of the lower half are given, in place.
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
