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
//! unknown. One sweep goes to every vertex and solves for its three unknowns and those of its edges together.

use nalgebra::Vector2;

use super::build::{at_point, place};
use super::proof::{Balanced, Certificate, Owner, Rejection, Role, displacement_gradient};
use crate::kernel::composite::{Composite, Loads};
use crate::kernel::{Stress, Triangle};

/// A triangle's energy as a function of the forces on its edges.
struct Energy {
    /// The second derivative.
    hessian: [[f64; 12]; 12],
    /// The derivative at the present forces.
    gradient: [f64; 12],
}

/// Improves the tractions of `certificate` in `count` sweeps, and leaves them in equilibrium up to rounding.
///
/// # Errors
/// A condition of the theorem that does not hold.
pub(super) fn improve(certificate: &mut Certificate, count: usize) -> Result<(), Rejection> {
    let state = balance(certificate)?;
    sweep(certificate, &state.owners, &state.loads, count);
    // Each update has left its rounding errors.
    balance(certificate)?;
    Ok(())
}

/// Gives the edges the tractions that balance, in doubles.
fn balance(certificate: &mut Certificate) -> Result<Balanced<f64>, Rejection> {
    let state = certificate.balanced::<f64>()?;
    for (edge, owner) in certificate.edges.iter_mut().zip(&state.owners) {
        let Some(Owner { piece, local }) = owner[0] else { continue };
        if let Role::Inner(force) | Role::Held(_, force) = &mut edge.role {
            *force = state.loads[piece].forces[local].map(Into::into);
        }
    }
    Ok(state)
}

fn sweep(
    certificate: &mut Certificate,
    owners: &[[Option<Owner>; 2]],
    loads: &[Loads<f64>],
    count: usize,
) {
    let points: Vec<Vector2<f64>> = (0..certificate.vertices.len() + certificate.cuts.len())
        .map(|p| place(certificate, p))
        .collect();
    let mut stars = vec![Vec::new(); points.len()];
    for (t, piece) in certificate.pieces.iter().enumerate() {
        for local in 0..3 {
            stars[piece.vertices[local]].push((t, local));
        }
    }
    // Whose traction is free.
    let free_edge: Vec<bool> = certificate
        .edges
        .iter()
        .map(|edge| matches!(edge.role, Role::Inner(_) | Role::Held([true, true], _)))
        .collect();
    let mut free_vertex = vec![true; points.len()];
    for (edge, free) in certificate.edges.iter().zip(&free_edge) {
        if !free {
            edge.ends.iter().for_each(|&p| free_vertex[p] = false);
        }
    }
    let mut energies: Vec<Energy> =
        (0..loads.len()).map(|t| energy(certificate, &points, t, &loads[t])).collect();
    let star = Star { points: &points, owners, free_edge: &free_edge, free_vertex: &free_vertex };
    for sweep in 0..count {
        for k in 0..points.len() {
            let vertex = if sweep % 2 == 0 { k } else { points.len() - 1 - k };
            star.minimise(vertex, &stars[vertex], &mut energies, certificate);
        }
    }
}

/// |C eps(v) - tau|^2 / 2 on triangle `t`.
fn energy(
    certificate: &Certificate,
    points: &[Vector2<f64>],
    t: usize,
    loads: &Loads<f64>,
) -> Energy {
    let piece = &certificate.pieces[t];
    let triangle = Triangle { vertices: piece.vertices.map(|p| points[p]) };
    let double_area = triangle.double_area();
    let material = piece.material::<f64>();
    let v = piece.vertices.map(|p| value(certificate, p));
    let sigma = material.stress(displacement_gradient(&triangle, &v));
    let distance =
        features(&Composite::new(&triangle, loads).distance_from(sigma), &material, double_area);
    let mut units = [[0.0; 36]; 12];
    for (k, unit) in units.iter_mut().enumerate() {
        let mut unit_load =
            Loads { forces: [[Vector2::zeros(); 2]; 3], body: [Vector2::zeros(); 3] };
        unit_load.forces[k / 4][k / 2 % 2][k % 2] = 1.0;
        let tau = Composite::new(&triangle, &unit_load);
        *unit = features(&tau, &material, double_area);
    }
    let inner = |a: &[f64; 36], b: &[f64; 36]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut hessian = [[0.0; 12]; 12];
    for i in 0..12 {
        for j in 0..=i {
            hessian[i][j] = inner(&units[i], &units[j]);
            hessian[j][i] = hessian[i][j];
        }
    }
    Energy { hessian, gradient: units.each_ref().map(|unit| -inner(unit, &distance)) }
}

/// Numbers whose products are those of [`Composite::product`].
fn features(
    tau: &Composite<f64>,
    material: &crate::kernel::Material<f64>,
    double_area: f64,
) -> [f64; 36] {
    let scale = double_area / 288.0;
    let deviator = (scale / material.mu()).sqrt();
    let sphere = (scale / (material.lambda() + material.mu())).sqrt();
    let mut all = [0.0; 36];
    let mut k = 0;
    let mut put = |s: Stress<f64>| {
        let [xx, yy, xy] = s.components();
        all[k] = deviator * (xx - yy);
        all[k + 1] = deviator * 2.0 * xy;
        all[k + 2] = sphere * (xx + yy);
        k += 3;
    };
    let centre = tau.centre;
    for [a, b] in tau.corners {
        put(a);
        put(b);
        put(centre);
        put(a + b + centre);
    }
    all
}

/// v at point `p`.
pub(super) fn value(certificate: &Certificate, p: usize) -> Vector2<f64> {
    at_point(&certificate.displacement, &certificate.cuts, p)
}

struct Star<'a> {
    points: &'a [Vector2<f64>],
    owners: &'a [[Option<Owner>; 2]],
    free_edge: &'a [bool],
    free_vertex: &'a [bool],
}

impl Star<'_> {
    fn minimise(
        &self,
        vertex: usize,
        triangles: &[(usize, usize)],
        energies: &mut [Energy],
        certificate: &mut Certificate,
    ) {
        let mut edges: Vec<usize> = Vec::with_capacity(triangles.len() + 1);
        for &(t, local) in triangles {
            for k in 1..3 {
                let e = certificate.pieces[t].edges[(local + k) % 3];
                if !edges.contains(&e) {
                    edges.push(e);
                }
            }
        }
        // The unknowns: those of the vertex, then one for each free edge.
        let own = if self.free_vertex[vertex] { 3 } else { 0 };
        let mut unknown = own;
        let numbers: Vec<Option<usize>> = edges
            .iter()
            .map(|&e| {
                self.free_edge[e].then(|| {
                    unknown += 1;
                    unknown - 1
                })
            })
            .collect();
        if unknown == 0 {
            return;
        }
        let forces: Vec<[[Vector2<f64>; 2]; 4]> = edges
            .iter()
            .map(|&e| {
                let ends = certificate.edges[e].ends;
                modes(ends.map(|p| self.points[p]), ends[1] == vertex)
            })
            .collect();
        let mut matrix = vec![0.0; unknown * unknown];
        let mut right = vec![0.0; unknown];
        let mut columns: Vec<(usize, usize, [f64; 12])> = Vec::with_capacity(5 * triangles.len());
        for &(t, local) in triangles {
            let piece = &certificate.pieces[t];
            let first = columns.len();
            let mut mine = [[0.0; 12]; 3];
            for k in 1..3 {
                let side = (local + k) % 3;
                let Some(place) = edges.iter().position(|&e| e == piece.edges[side]) else {
                    continue;
                };
                let left = self.owners[edges[place]][0].is_some_and(|owner| owner.piece == t);
                let outward = |[a, b]: [Vector2<f64>; 2]| {
                    if left { [a[0], a[1], b[0], b[1]] } else { [-b[0], -b[1], -a[0], -a[1]] }
                };
                for (mine, force) in mine.iter_mut().zip(&forces[place]).take(own) {
                    mine[4 * side..4 * side + 4].copy_from_slice(&outward(*force));
                }
                if let Some(number) = numbers[place] {
                    let mut column = [0.0; 12];
                    column[4 * side..4 * side + 4].copy_from_slice(&outward(forces[place][3]));
                    columns.push((t, number, column));
                }
            }
            columns
                .extend(mine.into_iter().take(own).enumerate().map(|(k, column)| (t, k, column)));
            let energy = &energies[t];
            for (_, i, a) in &columns[first..] {
                let image = energy.hessian.each_ref().map(|row| inner(row, a));
                right[*i] -= inner(&energy.gradient, a);
                for (_, j, b) in &columns[first..] {
                    matrix[i * unknown + j] += inner(&image, b);
                }
            }
        }
        if !solve_positive(&mut matrix, &mut right) {
            return;
        }
        for (t, number, column) in &columns {
            let energy = &mut energies[*t];
            for (gradient, row) in energy.gradient.iter_mut().zip(&energy.hessian) {
                *gradient += right[*number] * inner(row, column);
            }
        }
        for ((&e, number), modes) in edges.iter().zip(&numbers).zip(&forces) {
            let (Role::Inner(force) | Role::Held(_, force)) = &mut certificate.edges[e].role else {
                continue;
            };
            if number.is_none() {
                continue;
            }
            let factors = (0..own).map(|k| (k, right[k])).chain(number.map(|n| (3, right[n])));
            for (k, factor) in factors {
                for end in 0..2 {
                    for c in 0..2 {
                        force[end][c] += factor * modes[k][end][c];
                    }
                }
            }
        }
    }
}

fn inner(a: &[f64; 12], b: &[f64; 12]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
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

/// Solves a small positive definite system in place by Cholesky's method; false if it is not definite, as it is for a
/// star whose unknowns are not independent.
fn solve_positive(matrix: &mut [f64], right: &mut [f64]) -> bool {
    let n = right.len();
    for j in 0..n {
        let whole = matrix[j * n + j];
        let mut pivot = whole;
        for k in 0..j {
            pivot -= matrix[j * n + k] * matrix[j * n + k];
        }
        if !(pivot > 1e-13 * whole) {
            return false;
        }
        let root = pivot.sqrt();
        matrix[j * n + j] = root;
        for i in j + 1..n {
            let mut entry = matrix[i * n + j];
            for k in 0..j {
                entry -= matrix[i * n + k] * matrix[j * n + k];
            }
            matrix[i * n + j] = entry / root;
        }
    }
    for i in 0..n {
        for k in 0..i {
            right[i] -= matrix[i * n + k] * right[k];
        }
        right[i] /= matrix[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            right[i] -= matrix[k * n + i] * right[k];
        }
        right[i] /= matrix[i * n + i];
    }
    true
}
