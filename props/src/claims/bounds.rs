//! The bound of the distance from the true solution, and the checker of its certificates (docs/theory.md, 7.2 and 7.3).
//!
//! At a point, with e, t, s for the strains of v, of C^-1 tau and of u, the theorem is |e - t|^2 = |e - s|^2 + |s - t|^2 + 2 (e - s) :
//! C (s - t), and what contact adds to the integral of the last product is not negative.
//!
//! The checker is given certificates that are made by hand, of dyadic numbers, so that tractions are doubles and equilibrium is
//! exact: v has random nodal values, and tau is affine, in equilibrium with a constant body force,
//!
//! tau_xx = a + b x + c y, tau_yy = d + e x + f y, tau_xy = h y, body force (-b - h, -f), no shear at y = 0.
//!
//! v is affine on the triangles, or quadratic with random bulges on the edges; then so are u_D and g.
//!
//! What it finds is compared with integrals of the definitions over rationals; and what is not as the theorem asks is refused.

mod supports;

use std::collections::BTreeMap;

use proptest::prelude::*;
use signorini::certify::Rejection;
use signorini::certify::proof::{Certificate, Claim as Said, Curved, Edge, Piece, Role};
use signorini::kernel::{Ball, Enclosing, Interval, Material, Plane};
use signorini::nalgebra::Matrix2;

use super::{attained, checker, distance};
use crate::claim::{Claim, Outcome, model_checked, noticed, proved, refuted, tested, text};
use crate::numbers::Exact;
use crate::verdict::{Ordered, Verdict};
use crate::{draws, ensure, given, statement};

/// The inner product of two strains in C.
fn product<S: Ordered>(material: &Material<S>, a: Matrix2<S>, b: Matrix2<S>) -> S {
    let [xx, yy, xy] = material.stress(a).components();
    xx * b.m11 + yy * b.m22 + xy * (b.m12 + b.m21)
}

/// The square of C e - tau splits, with C s = sigma(u) and C t = tau; given as differences from s.
pub fn the_square_of_the_bound_splits_at_a_point<S: Ordered>(
    [exx, eyy, exy, txx, tyy, txy, lambda, mu]: [S; 8],
) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    // e - s and s - t.
    let (e, t) = (Matrix2::new(exx, exy, exy, eyy), Matrix2::new(txx, txy, txy, tyy));
    let squares = product(&material, e, e) + product(&material, t, t);
    ensure!(product(&material, e + t, e + t) == squares + two * product(&material, e, t));
    ensure!(product(&material, e, e) >= zero);
    Verdict::Holds("always")
}

/// What contact adds: (v_n - u_n)(sigma_n - tau_n) + tau_n (v_n - g) is not negative where u satisfies (2), v_n <= g and
/// tau_n <= 0; and it is sigma_n (v_n - g) where u_n = g.
pub fn what_contact_adds_is_not_negative<S: Ordered>([u, s, v, t, g]: [S; 5]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero);
    given!(v <= g && t <= zero);
    let added = (v - u) * (s - t) + t * (v - g);
    ensure!(added == s * (v - g) + t * (u - g));
    ensure!(added >= zero);
    Verdict::Holds(if s < zero { "pressed" } else { "not pressed" })
}

/// Under a tension tau_n.
pub fn control_contact_adds_under_tension<S: Ordered>([u, s, v, t, g]: [S; 5]) -> Verdict {
    let zero = S::from(0);
    given!(u <= g && s <= zero && s * (u - g) == zero && v <= g);
    ensure!((v - u) * (s - t) + t * (v - g) >= zero);
    Verdict::Holds("always")
}

/// A certificate by hand, in sixteenths: cells of a rectangle, v, tau and the gap.
#[derive(Clone, Debug)]
struct Draw {
    cells: [usize; 2],
    /// Which diagonal each cell has.
    left: bool,
    lame: [i32; 2],
    /// v at the vertices.
    v: Vec<[i32; 2]>,
    /// a, b, c, d, e, f, h
    tau: [i32; 7],
    gap: [i32; 2],
    oscillation: i32,
    /// Bulges on the edges, in turn, in sixty-fourths; none where v is affine.
    curve: Vec<[i32; 2]>,
}

fn sixteenth(k: i32) -> f64 {
    f64::from(k) / 16.0
}

/// `strip`: one cell beside the other, upwards, so that the triangles form a chain.
fn draws_of(strip: bool) -> impl Strategy<Value = Draw> {
    let cells = if strip { (1..=1_usize, 2..=4_usize) } else { (1..=3_usize, 1..=3_usize) };
    let tau = prop::array::uniform7(-16..=16);
    let v = prop::collection::vec([-32..=32, -32..=32], 16);
    let lame = [-4..=32, 8..=32];
    let curve = prop_oneof![Just(Vec::new()), prop::collection::vec([-16..=16, -16..=16], 7)];
    (cells, any::<bool>(), lame, v, tau, [-8..=16, -8..=8], 0..=2, curve).prop_map(
        |(cells, left, lame, v, [a, b, c, d, e, f, h], gap, oscillation, curve)| Draw {
            cells: [cells.0, cells.1],
            left,
            lame,
            v,
            // On Gamma_C, y = 0 and x >= 0, tau_yy is not positive.
            tau: [a, b, c, -i32::abs(d), -i32::abs(e), f, h],
            gap,
            oscillation: oscillation * 4,
            curve,
        },
    )
}

impl Draw {
    /// tau at a place, xx, yy, xy.
    fn tau<S>(&self, [x, y]: [S; 2], unit: S) -> [S; 3]
    where
        S: From<i32> + Copy + std::ops::Add<Output = S> + std::ops::Mul<Output = S>,
    {
        let [a, b, c, d, e, f, h] = self.tau.map(|k| unit * S::from(k));
        [a + b * x + c * y, d + e * x + f * y, h * y]
    }

    /// The body force.
    fn body(&self) -> [f64; 2] {
        let [_, b, _, _, _, f, h] = self.tau.map(sixteenth);
        [-b - h, -f]
    }

    fn certificate(&self) -> Certificate {
        let [nx, ny] = self.cells;
        let number = |i: usize, j: usize| j * (nx + 1) + i;
        let mut vertices = Vec::new();
        for j in 0..=ny {
            // Cells of different heights.
            let y = (j * (j + 1)) as f64 / 2.0;
            vertices.extend((0..=nx).map(|i| [i as f64, y]));
        }
        let mut corners = Vec::new();
        for j in 0..ny {
            for i in 0..nx {
                let [a, b, c, d] =
                    [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
                let two = if self.left { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] };
                corners.extend(two);
            }
        }
        let top = number(0, ny);
        let gap_at = |x: f64| sixteenth(self.gap[0]) + sixteenth(self.gap[1]) * x;
        let displacement: Vec<[f64; 2]> = vertices
            .iter()
            .enumerate()
            .map(|(k, &[x, y])| {
                let v = self.v[k % self.v.len()].map(sixteenth);
                // -v_y <= g on Gamma_C, by a margin where the checker rounds |E| g.
                let margin = if self.gap == [0; 2] { 0.0 } else { sixteenth(1) };
                if y == 0.0 { [v[0], v[1].max(margin - gap_at(x))] } else { v }
            })
            .collect();
        let prescribed = (0..vertices.len())
            .map(|k| if k < top { [None; 2] } else { displacement[k].map(Some) })
            .collect();
        let mut edges: Vec<Edge> = Vec::new();
        let mut known: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let width = nx as f64;
        let role = |ends: [usize; 2]| {
            let [p, q] = ends.map(|k| vertices[k]);
            let normal = [q[1] - p[1], p[0] - q[0]];
            let at = [p, q].map(|x| self.tau(x, 1.0 / 16.0));
            let force = at.map(|[xx, yy, xy]| {
                [xx * normal[0] + xy * normal[1], xy * normal[0] + yy * normal[1]]
            });
            if p[1] == 0.0 && q[1] == 0.0 {
                let gap = [gap_at(p[0]), gap_at(q[0])];
                Role::Contact { pressure: at.map(|t| t[1]), gap, along: None }
            } else if ends.iter().all(|&k| k >= top) {
                Role::Held([true; 2], force)
            } else if p[0] == 0.0 && q[0] == 0.0 {
                Role::Loaded(at.map(|[xx, _, xy]| [-xx, -xy]))
            } else if p[0] == width && q[0] == width && self.tau[6] == 0 {
                Role::Pressed(at.map(|[xx, ..]| -xx))
            } else if p[0] == width && q[0] == width {
                Role::Loaded(at.map(|[xx, _, xy]| [xx, xy]))
            } else {
                Role::Inner(force)
            }
        };
        let mut pieces = Vec::new();
        for piece in corners {
            let own = [0, 1, 2].map(|i| {
                let ends = [piece[(i + 1) % 3], piece[(i + 2) % 3]];
                let mut key = ends;
                key.sort_unstable();
                *known.entry(key).or_insert_with(|| {
                    edges.push(Edge { ends, role: role(ends) });
                    edges.len() - 1
                })
            });
            pieces.push(Piece {
                vertices: piece,
                edges: own,
                material: {
                    let [lambda, mu] = self.lame.map(sixteenth);
                    Material::lame(lambda, mu, Plane::Strain)
                },
                body: [self.body(); 3],
                oscillation: sixteenth(self.oscillation),
            });
        }
        let curved = (!self.curve.is_empty()).then(|| self.curved(&edges));
        let (cuts, frames) = (Vec::new(), BTreeMap::new());
        let lists = Certificate { pieces, edges, ..Certificate::default() };
        Certificate { vertices, cuts, displacement, curved, prescribed, frames, ..lists }
    }

    /// The bulges of v: those of u_D on Gamma_D, and on Gamma_C as large as g asks for.
    fn curved(&self, edges: &[Edge]) -> Curved {
        let of = |e: usize| self.curve[e % self.curve.len()].map(|k| sixteenth(k) / 4.0);
        let mut curved = Curved::default();
        for (e, edge) in edges.iter().enumerate() {
            let mut bulge = of(e);
            let data = match edge.role {
                Role::Held(..) => bulge,
                Role::Contact { .. } => {
                    let gap = of(e + 1)[0];
                    // v_n = -v_y, by a margin where the checker rounds |E| g.
                    let margin = if self.gap == [0; 2] && gap == 0.0 { 0.0 } else { 1.0 / 64.0 };
                    bulge[1] = bulge[1].max(margin - gap);
                    [gap, 0.0]
                }
                _ => [0.0; 2],
            };
            curved.bulges.push(bulge);
            curved.data.push(data);
        }
        curved
    }

    /// The same with every other inner edge named from its other side.
    fn turned(&self) -> Certificate {
        let mut certificate = self.certificate();
        for edge in certificate.edges.iter_mut().step_by(2) {
            if let Role::Inner([start, end]) = edge.role {
                let minus = |f: [f64; 2]| f.map(|x| -x);
                edge.ends.reverse();
                edge.role = Role::Inner([minus(end), minus(start)]);
            }
        }
        certificate
    }

    /// By the definitions, over rationals.
    fn by_definition(&self, certificate: &Certificate) -> Definition {
        let exact = Exact::of_double;
        let [zero, one, two, six] = [0, 1, 2, 6].map(Exact::from);
        let [lambda, mu] = self.lame.map(|k| exact(sixteenth(k)));
        let material = Material::lame(lambda, mu, Plane::Strain);
        let places: Vec<[Exact; 2]> = certificate.vertices.iter().map(|x| x.map(exact)).collect();
        let v: Vec<[Exact; 2]> = certificate.displacement.iter().map(|x| x.map(exact)).collect();
        let curved = certificate.curved.as_ref();
        let bulge = |e: usize| curved.map_or([zero; 2], |curved| curved.bulges[e].map(exact));
        let gap_bulge = |e: usize| curved.map_or(zero, |curved| exact(curved.data[e][0]));
        // s : C^-1 s for s = xx, yy, xy.
        let complementary = |[xx, yy, xy]: [Exact; 3]| {
            let trace = lambda / (two * (lambda + mu)) * (xx + yy);
            (xx * (xx - trace) + yy * (yy - trace) + two * xy * xy) / (two * mu)
        };
        let mean = |p: [Exact; 2], q: [Exact; 2]| [0, 1].map(|c| (p[c] + q[c]) / two);
        let unit = one / Exact::from(16);
        let body = self.body().map(exact);
        let mut squares = Vec::new();
        let (mut norm, mut energy) = (zero, zero);
        for piece in &certificate.pieces {
            let [a, b, c] = piece.vertices.map(|k| places[k]);
            let cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let area = cross / two;
            let nodal = piece.vertices.map(|k| v[k]);
            let bulges = piece.edges.map(bulge);
            // v at a place, by its barycentric coordinates, which are ratios of areas.
            let cross_of = |p: [Exact; 2], q: [Exact; 2], r: [Exact; 2]| {
                (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
            };
            let v_at = |x: [Exact; 2]| {
                let l = [cross_of(x, b, c), cross_of(x, c, a), cross_of(x, a, b)];
                let l = l.map(|part| part / cross);
                [0, 1].map(|d| {
                    (0..3).fold(zero, |sum, i| {
                        let four = Exact::from(4) * l[(i + 1) % 3] * l[(i + 2) % 3];
                        sum + nodal[i][d] * l[i] + bulges[i][d] * four
                    })
                })
            };
            // grad v by differences over a length of 1, which are exact for a quadratic.
            let sigma = |x: [Exact; 2]| {
                let half = one / two;
                let along = |d: usize| {
                    let moved =
                        |by: Exact| v_at([0, 1].map(|k| if k == d { x[k] + by } else { x[k] }));
                    let (ahead, behind) = (moved(half), moved(-half));
                    [0, 1].map(|k| ahead[k] - behind[k])
                };
                let [[xx, yx], [xy, yy]] = [along(0), along(1)];
                material.stress(Matrix2::new(xx, xy, yx, yy)).components()
            };
            // The middles of the edges: exact for quadratics, such as squares of affine functions.
            let middles = [mean(a, b), mean(b, c), mean(c, a)];
            let over = |f: &dyn Fn([Exact; 2]) -> Exact| {
                area * middles.iter().fold(zero, |sum, &x| sum + f(x)) / Exact::from(3)
            };
            squares.push(over(&|x| {
                let (sigma, tau) = (sigma(x), self.tau(x, unit));
                complementary([0, 1, 2].map(|k| sigma[k] - tau[k]))
            }));
            let internal = over(&|x| complementary(sigma(x)));
            norm += internal;
            let work = over(&|x| {
                let v = v_at(x);
                v[0] * body[0] + v[1] * body[1]
            });
            energy += internal / two - work;
        }
        let (mut contact, mut supports) = (zero, zero);
        for (e, edge) in certificate.edges.iter().enumerate() {
            let [p, q] = edge.ends.map(|k| places[k]);
            let [v, w] = edge.ends.map(|k| v[k]);
            // Simpson's rule is exact for an affine function times a quadratic, which is given with its bulge.
            let simpson = |f: [Exact; 2], g: [Exact; 2], bulge: Exact| {
                let middle = (g[0] + g[1]) / two + bulge;
                (f[0] * g[0] + two * (f[0] + f[1]) * middle + f[1] * g[1]) / six
            };
            match edge.role {
                Role::Contact { gap, .. } => {
                    let tau = [p, q].map(|x| self.tau(x, unit)[1]);
                    let beyond = [-v[1] - exact(gap[0]), -w[1] - exact(gap[1])];
                    let between = -bulge(e)[1] - gap_bulge(e);
                    contact += two * (q[0] - p[0]) * simpson(tau, beyond, between);
                }
                Role::Supported { along, .. } => {
                    let (normal, d) = ([q[1] - p[1], p[0] - q[0]], along.map(exact));
                    let across = [p, q].map(|x| {
                        let [xx, yy, xy] = self.tau(x, unit);
                        let [x, y] =
                            [[xx, xy], [xy, yy]].map(|row| row[0] * normal[0] + row[1] * normal[1]);
                        let along = (x * d[0] + y * d[1]) / (d[0] * d[0] + d[1] * d[1]);
                        [x - along * d[0], y - along * d[1]]
                    });
                    for c in 0..2 {
                        let given = across.map(|f| f[c]);
                        supports -= simpson(given, [v[c], w[c]], bulge(e)[c]);
                    }
                }
                Role::Loaded(_) | Role::Pressed(_) => {
                    let normal = q[1] - p[1];
                    for (c, component) in [0, 2].into_iter().enumerate() {
                        let force = [p, q].map(|x| self.tau(x, unit)[component] * normal);
                        energy -= simpson(force, [v[c], w[c]], bulge(e)[c]);
                    }
                }
                _ => {}
            }
        }
        Definition { squares, contact, norm, energy, supports }
    }
}

/// |C eps(v) - tau|^2 on each triangle, 2 int tau_n (v_n - g), |v|_a^2 and J(v), of which minus the work of what is given beside supports
/// is apart.
struct Definition {
    squares: Vec<Exact>,
    contact: Exact,
    norm: Exact,
    energy: Exact,
    supports: Exact,
}

/// What is left of a square: the checker carries what each triangle is out of balance by, in numbers that are rounded, from
/// triangle to triangle and adds the squares of differences that are as far off.
const CLOSE: f64 = 1e-10;

/// |a - b| <= `CLOSE` size
fn near(a: f64, b: Exact, size: Exact) -> bool {
    (Exact::of_double(a) - b).abs() <= Exact::of_double(CLOSE) * size
}

/// The checker against the definitions; the square of its bound is `share` of what it says.
fn evaluated<S: Enclosing>(draw: &Draw, share: f64) -> Verdict {
    evaluated_of::<S>(draw, draw.turned(), [share, 1.0])
}

/// The same of a certificate with the same tau; `work` is the share of the work of what is given beside supports that is counted.
fn evaluated_of<S: Enclosing>(
    draw: &Draw,
    certificate: Certificate,
    [share, work]: [f64; 2],
) -> Verdict {
    let Ok(proof) = certificate.evaluate::<S>() else {
        return Verdict::Fails("the certificate is accepted");
    };
    Exact::scope(|| {
        let mut definition = draw.by_definition(&certificate);
        definition.energy += Exact::of_double(work) * definition.supports;
        let (zero, one) = (Exact::from(0), Exact::from(1));
        let total = definition.squares.iter().fold(zero, |sum, &s| sum + s);
        let size = one + total + definition.contact.abs();
        let found = Exact::of_double(share) * Exact::of_double(proof.bound);
        let found = found * Exact::of_double(proof.bound);
        if draw.oscillation == 0 {
            let square = total + definition.contact;
            ensure!(square >= zero);
            ensure!(found >= square);
            ensure!(found - square <= Exact::of_double(CLOSE) * size);
        } else {
            // (|.|_T + o)^2 = |.|_T^2 + 2 o |.|_T + o^2, with roots in doubles.
            let o = sixteenth(draw.oscillation);
            let roots: f64 = definition.squares.iter().map(|s| to_double(*s).sqrt()).sum();
            let more = 2.0 * o * roots + o * o * definition.squares.len() as f64;
            let square = to_double(total) + to_double(definition.contact) + more;
            ensure!((to_double(found) - square).abs() <= CLOSE * (1.0 + square));
        }
        ensure!(near(proof.norm * proof.norm, definition.norm, one + definition.norm));
        let magnitude = size + definition.norm + definition.energy.abs();
        ensure!(proof.energy.iter().all(|&e| near(e, definition.energy, magnitude)));
        ensure!(Exact::of_double(proof.energy[0]) <= definition.energy);
        ensure!(definition.energy <= Exact::of_double(proof.energy[1]));
        Verdict::Holds(match (draw.oscillation, draw.curve.len()) {
            (0, 0) => "exact data",
            (0, _) => "exact data, v quadratic",
            _ => "data that oscillate",
        })
    })
}

/// The load at each vertex of a triangle is counted in J(v): int l_a v = |T|/12 (v_0 + v_1 + v_2 + v_a); or that of the first
/// vertex for all.
fn loads_at_vertices(draw: &Draw, own: bool) -> Verdict {
    // What bulges do is seen by the square of the bound less twice the energy.
    let plain = Draw { curve: Vec::new(), ..draw.clone() }.certificate();
    let more = |t: usize, i: usize| draw.v[(3 * t + i) % draw.v.len()].map(sixteenth);
    let mut loaded = plain.clone();
    for (t, piece) in loaded.pieces.iter_mut().enumerate() {
        for i in 0..3 {
            (0..2).for_each(|c| piece.body[i][c] += more(t, i)[c]);
        }
    }
    let Ok(proof) = loaded.evaluate::<Ball>() else {
        return Verdict::Fails("the certificate is accepted");
    };
    Exact::scope(|| {
        let definition = draw.by_definition(&plain);
        let (mut energy, mut size) = (definition.energy, Exact::from(1) + definition.norm);
        for (t, piece) in plain.pieces.iter().enumerate() {
            let [a, b, c] = piece.vertices.map(|k| plain.vertices[k].map(Exact::of_double));
            let cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let v = piece.vertices.map(|k| plain.displacement[k].map(Exact::of_double));
            for i in 0..3 {
                for c in 0..2 {
                    let nodal = v[0][c] + v[1][c] + v[2][c] + v[i][c];
                    let force = Exact::of_double(more(t, if own { i } else { 0 })[c]);
                    let work = force * nodal * cross / Exact::from(24);
                    energy -= work;
                    size += work.abs();
                }
            }
        }
        ensure!(Exact::of_double(proof.energy[0]) <= energy);
        ensure!(energy <= Exact::of_double(proof.energy[1]));
        ensure!(proof.energy.iter().all(|&e| near(e, energy, size + energy.abs())));
        Verdict::Holds("always")
    })
}

/// The square of the bound less 2 J(v) is -2 J*(tau), the same for every v: for tau in equilibrium with a load that is affine on
/// each triangle, int tau : eps(w) is the work of the loads. With `exchanged` the vertices of the other certificate are.
fn duality_gap(draw: &Draw, exchanged: bool) -> Verdict {
    let mut one = draw.certificate();
    for (t, piece) in one.pieces.iter_mut().enumerate() {
        piece.oscillation = 0.0;
        for i in 0..3 {
            let more = draw.v[(3 * t + i) % draw.v.len()].map(sixteenth);
            (0..2).for_each(|c| piece.body[i][c] += more[c]);
        }
    }
    let mut other = one.clone();
    let curve = draw.curve.iter().rev().copied().collect();
    let v = Draw { v: draw.v.iter().rev().copied().collect(), curve, ..draw.clone() }.certificate();
    if let (Some(curved), Some(moved)) = (&mut other.curved, v.curved) {
        for ((bulge, moved), edge) in curved.bulges.iter_mut().zip(moved.bulges).zip(&v.edges) {
            if !matches!(edge.role, Role::Held(..) | Role::Contact { .. }) {
                *bulge = moved;
            }
        }
    }
    for (k, moved) in v.displacement.into_iter().enumerate() {
        if other.prescribed[k] == [None; 2] {
            other.displacement[k] = moved;
        }
    }
    if exchanged {
        other.pieces.iter_mut().for_each(|piece| piece.body.rotate_left(1));
    }
    let of = |certificate: &Certificate| {
        let proof = certificate.evaluate::<Interval>().ok()?;
        let (square, twice) = (proof.bound * proof.bound, proof.energy[0] + proof.energy[1]);
        Some((square - twice, 1.0 + square + twice.abs()))
    };
    let (Some((one, size)), Some((other, other_size))) = (of(&one), of(&other)) else {
        return Verdict::Fails("both are accepted");
    };
    ensure!((one - other).abs() <= CLOSE * (size + other_size));
    Verdict::Holds("always")
}

fn to_double(x: Exact) -> f64 {
    use num_traits::ToPrimitive;
    x.value().to_f64().unwrap_or(f64::NAN)
}

const CLASSES: [&str; 3] = ["exact data", "exact data, v quadratic", "data that oscillate"];

fn bounds_are_the_definitions() -> Outcome {
    let balls = draws::hold(60, draws_of(false), &CLASSES, |draw| evaluated::<Ball>(draw, 1.0))?;
    let intervals =
        draws::hold(40, draws_of(false), &CLASSES, |draw| evaluated::<Interval>(draw, 1.0))?;
    Ok(format!("in balls: {balls}; in intervals: {intervals}"))
}

/// Tractions on inner edges and on Gamma_D that are out of balance by what the checker may add: it finds the balanced ones
/// again, for the triangles form a chain. With `gross` something else is added too.
fn balanced(draw: &Draw, gross: bool) -> Verdict {
    let certificate = draw.turned();
    let Ok(before) = certificate.evaluate::<Interval>() else {
        return Verdict::Fails("the certificate is accepted");
    };
    let mut moved = certificate.clone();
    for (e, edge) in moved.edges.iter_mut().enumerate() {
        let [p, q] = edge.ends.map(|k| certificate.vertices[k]);
        let part = |k: usize| sixteenth(draw.v[(e + k) % draw.v.len()][k % 2]);
        let turn = if gross { [part(3), part(4)] } else { [0.0; 2] };
        match &mut edge.role {
            Role::Inner([start, end]) => {
                // A constant, and (2 s - 1) N times a factor.
                let normal = [q[1] - p[1], p[0] - q[0]];
                for c in 0..2 {
                    start[c] += part(c) - part(2) * normal[c] + turn[c];
                    end[c] += part(c) + part(2) * normal[c];
                }
            }
            Role::Held(_, [start, end]) => {
                for c in 0..2 {
                    start[c] += part(c);
                    end[c] += part(c);
                }
                start[1] -= part(2);
                end[1] += part(2);
            }
            _ => {}
        }
    }
    let Ok(after) = moved.evaluate::<Interval>() else {
        return Verdict::Fails("what is out of balance is balanced");
    };
    // A bound is a root: near zero it is known to half the digits.
    let [before, after] = [before.bound, after.bound].map(|b| b * b);
    ensure!((after - before).abs() <= 1e-9 * (1.0 + before));
    Verdict::Holds("always")
}

/// One thing that the theorem does not allow.
type Tampering = (&'static str, fn(&mut Certificate), fn(&Rejection) -> bool);

fn of_contact(certificate: &mut Certificate, change: impl Fn(&mut Role)) {
    let contact = |edge: &&mut Edge| matches!(edge.role, Role::Contact { .. });
    certificate.edges.iter_mut().filter(contact).take(1).for_each(|edge| change(&mut edge.role));
}

/// What is wrong with a force in a direction that is free.
const NOT_HELD: &str = "a force where nothing is held";

/// Lets all held edges go but for one component, in which they stay held, and puts a force on the first of them.
fn hold_one(certificate: &mut Certificate, component: usize, force: [[f64; 2]; 2]) {
    let mut first = Some(force);
    for edge in &mut certificate.edges {
        if let Role::Held(held, old) = &mut edge.role {
            held[1 - component] = false;
            old.iter_mut().for_each(|f| f[1 - component] = 0.0);
            *old = first.take().unwrap_or(*old);
        }
    }
    certificate.prescribed.iter_mut().for_each(|data| data[1 - component] = None);
    release_bulges(certificate, 1 - component);
}

/// Takes the bulges of u_D in a component away.
fn release_bulges(certificate: &mut Certificate, component: usize) {
    let Some(curved) = &mut certificate.curved else { return };
    for (data, edge) in curved.data.iter_mut().zip(&certificate.edges) {
        if !IS_CONTACT(&edge.role) {
            data[component] = 0.0;
        }
    }
}

/// The vertices of the first edge of Gamma_C.
fn ends_on_contact(certificate: &Certificate) -> [usize; 2] {
    let contact = |edge: &&Edge| matches!(edge.role, Role::Contact { .. });
    certificate.edges.iter().find(contact).map_or([0; 2], |edge| edge.ends)
}

const TAMPERINGS: [Tampering; 22] = [
    (
        "a tension at one end",
        |c| {
            of_contact(c, |role| {
                if let Role::Contact { pressure, .. } = role {
                    pressure[1] = 1e-3;
                }
            });
        },
        |why| matches!(why, Rejection::Tension { .. }),
    ),
    (
        "a pressure that is no number",
        |c| {
            of_contact(c, |role| {
                if let Role::Contact { pressure, .. } = role {
                    pressure[0] = f64::NAN;
                }
            });
        },
        |_| true,
    ),
    (
        "v through the obstacle by 1e-6",
        |c| {
            let [a, _] = ends_on_contact(c);
            let Some(Role::Contact { gap, .. }) =
                c.edges.iter().map(|e| e.role).find(|r| matches!(r, Role::Contact { .. }))
            else {
                return;
            };
            c.displacement[a][1] = -gap[0] - 1e-6;
        },
        |why| matches!(why, Rejection::Penetration { .. }),
    ),
    (
        "a gap that is smaller than v takes",
        |c| {
            of_contact(c, |role| {
                if let Role::Contact { gap, .. } = role {
                    *gap = [-3.0; 2];
                }
            });
        },
        |why| matches!(why, Rejection::Penetration { .. }),
    ),
    (
        "v through the obstacle between the ends of an edge along which the direction turns",
        |c| {
            let [a, b] = ends_on_contact(c);
            // v . d is 0 at both ends and positive between them; on the next edge v stays below its gap.
            c.displacement[a] = [0.0625, 0.0];
            c.displacement[b] = [0.0, -0.0625];
            of_contact(c, |role| {
                *role = Role::Contact {
                    pressure: [-1.0; 2],
                    gap: [0.0; 2],
                    along: Some([[0.0, -1.0], [1.0, 0.0]]),
                };
            });
        },
        |why| matches!(why, Rejection::Penetration { .. }),
    ),
    (
        "a pressure that varies along a direction that turns",
        |c| {
            of_contact(c, |role| {
                *role = Role::Contact {
                    pressure: [-1.0, -2.0],
                    gap: [9.0; 2],
                    along: Some([[0.0, -1.0], [0.6, -0.8]]),
                };
            });
        },
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a prescribed value that v misses by a rounding error",
        |c| {
            if let Some(value) = c.prescribed.last_mut().and_then(|p| p[0].as_mut()) {
                *value = value.next_up();
            }
        },
        |why| matches!(why, Rejection::NotPrescribed { .. }),
    ),
    (
        "an end of Gamma_D without a prescribed value",
        |c| {
            if let Some(values) = c.prescribed.last_mut() {
                values[1] = None;
            }
        },
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a prescribed value off Gamma_D",
        |c| c.prescribed[0] = [Some(c.displacement[0][0]), None],
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a force where nothing is held, at the start",
        |c| hold_one(c, 0, [[0.0, 1.0], [0.0, 0.0]]),
        |why| matches!(why, Rejection::Wrong { what: "edge", problem: NOT_HELD, .. }),
    ),
    (
        "a force where nothing is held, at the end",
        |c| hold_one(c, 1, [[0.0, 0.0], [1.0, 0.0]]),
        |why| matches!(why, Rejection::Wrong { what: "edge", problem: NOT_HELD, .. }),
    ),
    (
        "a body that nothing holds",
        |c| {
            for edge in &mut c.edges {
                match &mut edge.role {
                    Role::Held(_, force) => edge.role = Role::Loaded(*force),
                    Role::Contact { pressure, .. } => *pressure = [0.0; 2],
                    _ => {}
                }
            }
            c.prescribed.fill([None; 2]);
            (0..2).for_each(|component| release_bulges(c, component));
        },
        |why| matches!(why, Rejection::Unbalanced(_)),
    ),
    (
        "a triangle that is clockwise",
        |c| c.vertices[0] = [5.0, 5.0],
        |why| matches!(why, Rejection::Orientation { .. }),
    ),
    (
        "a triangle without area",
        |c| c.vertices[0] = c.vertices[1],
        |why| matches!(why, Rejection::Orientation { .. }),
    ),
    (
        "a shear modulus of zero",
        |c| c.pieces[0].material = Material::lame(1.0, 0.0, Plane::Strain),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "lambda + mu that is not positive",
        |c| {
            let mu = c.pieces[0].material.mu();
            c.pieces[0].material = Material::lame(-mu, mu, Plane::Strain);
        },
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a negative oscillation",
        |c| c.pieces[0].oscillation = -1e-3,
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a place that is no number",
        |c| c.vertices[1][0] = f64::NAN,
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a displacement that is missing",
        |c| {
            c.displacement.pop();
        },
        |why| matches!(why, Rejection::Length { .. }),
    ),
    (
        "a triangle with an edge of other vertices",
        |c| c.pieces[0].edges.swap(0, 1),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "an inner edge with one triangle",
        |c| {
            c.pieces.pop();
        },
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "an inner edge that is called loaded, where tractions may jump",
        |c| {
            let inner = |edge: &&mut Edge| matches!(edge.role, Role::Inner(_));
            c.edges.iter_mut().find(inner).into_iter().for_each(|edge| {
                edge.role = Role::Loaded([[0.0; 2]; 2]);
            });
        },
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
];

/// v_n - g on the first edge of Gamma_C with the values 0, 0 and -1 at its start, middle and end: 1/8 at a quarter.
fn through_between_the_nodes(certificate: &mut Certificate) {
    let [a, b] = ends_on_contact(certificate);
    certificate.displacement[a] = [0.0; 2];
    certificate.displacement[b] = [0.0, 1.0];
    let first = certificate.edges.iter().position(|e| matches!(e.role, Role::Contact { .. }));
    of_contact(certificate, |role| {
        if let Role::Contact { gap, .. } = role {
            *gap = [0.0; 2];
        }
    });
    if let (Some(e), Some(curved)) = (first, &mut certificate.curved) {
        curved.bulges[e] = [0.0, -0.5];
        curved.data[e] = [0.0; 2];
    }
}

/// A change of the bulges of the first edge of a kind.
fn of_bulges(
    certificate: &mut Certificate,
    of: impl Fn(&Role) -> bool,
    change: impl Fn(&mut [f64; 2], &mut [f64; 2]),
) {
    let first = certificate.edges.iter().position(|edge| of(&edge.role));
    if let (Some(e), Some(curved)) = (first, &mut certificate.curved) {
        change(&mut curved.bulges[e], &mut curved.data[e]);
    }
}

const IS_HELD: fn(&Role) -> bool = |role| matches!(role, Role::Held(..));
const IS_INNER: fn(&Role) -> bool = |role| matches!(role, Role::Inner(_));
const IS_CONTACT: fn(&Role) -> bool = |role| matches!(role, Role::Contact { .. });

/// What else the theorem does not allow of a v that is quadratic.
const QUADRATIC_TAMPERINGS: [Tampering; 9] = [
    (
        "v through the obstacle between the three nodes of an edge",
        through_between_the_nodes,
        |why| matches!(why, Rejection::Penetration { .. }),
    ),
    (
        "a gap that bulges into v",
        |c| of_bulges(c, IS_CONTACT, |_, data| data[0] = -9.0),
        |why| matches!(why, Rejection::Penetration { .. }),
    ),
    (
        "v through the obstacle between the ends of an edge along which the direction turns",
        |c| {
            of_contact(c, |role| {
                *role = Role::Contact {
                    pressure: [-1.0; 2],
                    gap: [9.0; 2],
                    along: Some([[0.0, -1.0], [0.6, -0.8]]),
                };
            });
            of_bulges(c, IS_CONTACT, |bulge, _| *bulge = [0.0, -30.0]);
        },
        |why| matches!(why, Rejection::Penetration { .. }),
    ),
    (
        "a prescribed bulge that v misses by a rounding error",
        |c| of_bulges(c, IS_HELD, |bulge, _| bulge[0] = bulge[0].next_up()),
        |why| matches!(why, Rejection::NotPrescribedBetween { component: 0, .. }),
    ),
    (
        "a bulge of data inside the body",
        |c| of_bulges(c, IS_INNER, |_, data| data[1] = 0.125),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a second bulge of a gap",
        |c| of_bulges(c, IS_CONTACT, |_, data| data[1] = 0.125),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a bulge that is no number",
        |c| of_bulges(c, IS_INNER, |bulge, _| bulge[0] = f64::NAN),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a bulge that is missing",
        |c| c.curved.iter_mut().for_each(|curved| curved.bulges.truncate(3)),
        |why| matches!(why, Rejection::Length { .. }),
    ),
    (
        "a value at a cut that is not there",
        |c| c.curved.iter_mut().for_each(|curved| curved.at_cuts.push([0.0; 2])),
        |why| matches!(why, Rejection::Length { .. }),
    ),
];

/// A test of v_n - g at start, middle and end of an edge takes a v that goes through the obstacle.
fn three_nodes_tell() -> Outcome {
    let mut certificate = quadratic_example().certificate();
    through_between_the_nodes(&mut certificate);
    let first = certificate.edges.iter().position(|edge| IS_CONTACT(&edge.role));
    let (Some(e), Some(curved)) = (first, &certificate.curved) else {
        return Err("no contact, or v is affine".to_owned());
    };
    let ends = certificate.edges[e].ends.map(|k| -certificate.displacement[k][1]);
    let at = |s: f64| (1.0 - s) * ends[0] + s * ends[1] - 4.0 * s * (1.0 - s) * curved.bulges[e][1];
    let accepted = [0.0, 0.5, 1.0].into_iter().all(|s| at(s) <= 0.0);
    let most = (0..=64).map(|k| at(f64::from(k) / 64.0)).fold(f64::NEG_INFINITY, f64::max);
    if accepted && most > 0.0 {
        return Err(format!("accepted, and v is {most} through the obstacle"));
    }
    Ok("refused".to_owned())
}

/// Nothing acts on a body at rest, u = 0; v has bulges inside, so |v|_a is its error. With or without these in C eps(v).
fn of_a_body_at_rest(draw: &Draw, with_bulges: bool) -> Verdict {
    let curve = if draw.curve.is_empty() { vec![[5, -3], [2, 7]] } else { draw.curve.clone() };
    let rest = Draw {
        v: vec![[0; 2]; draw.v.len()],
        tau: [0; 7],
        gap: [0; 2],
        oscillation: 0,
        curve,
        ..draw.clone()
    };
    let mut certificate = rest.certificate();
    if let Some(curved) = &mut certificate.curved {
        for (e, edge) in certificate.edges.iter().enumerate() {
            curved.data[e] = [0.0; 2];
            if !IS_INNER(&edge.role) {
                curved.bulges[e] = [0.0; 2];
            }
        }
    }
    let error = Exact::scope(|| to_double(rest.by_definition(&certificate).norm).sqrt());
    if !with_bulges {
        certificate.curved = None;
    }
    let Ok(proof) = certificate.evaluate::<Ball>() else {
        return Verdict::Fails("the certificate is accepted");
    };
    ensure!(proof.bound >= error * (1.0 - 1e-12));
    Verdict::Holds("always")
}

/// What is claimed of a certificate that is as it was made.
fn claimed(certificate: &Certificate) -> Result<Said, String> {
    let proof = certificate.evaluate::<Ball>().map_err(text)?;
    Ok(Said { shares: proof.shares, bound: proof.bound, forces: Default::default() })
}

/// A body of 2 x 2 cells that the draws above may be.
fn example() -> Draw {
    let v = (0..16).map(|k| [(k * 7) % 11 - 5, (k * 5) % 13 - 6]).collect();
    let (cells, lame, tau) = ([2, 2], [12, 16], [3, -4, 5, -6, -2, 1, 2]);
    Draw { cells, left: true, lame, v, tau, gap: [2, 1], oscillation: 0, curve: Vec::new() }
}

/// The same with a v that is quadratic.
fn quadratic_example() -> Draw {
    Draw { curve: (0..5).map(|k| [(k * 7) % 11 - 5, (k * 5) % 9 - 4]).collect(), ..example() }
}

/// Every tampering is refused, for its own reason; without one the certificate is accepted.
fn refusals(tamper: bool) -> Outcome {
    let quadratic = TAMPERINGS.iter().chain(&QUADRATIC_TAMPERINGS);
    let all = TAMPERINGS.iter().map(|tampering| (example(), tampering));
    for (draw, (what, change, reason)) in
        all.chain(quadratic.map(|tampering| (quadratic_example(), tampering)))
    {
        let good = draw.certificate();
        good.evaluate::<Ball>().map_err(|e| format!("refused as it was made: {e}"))?;
        let mut certificate = good;
        if tamper {
            change(&mut certificate);
        }
        for found in [certificate.evaluate::<Ball>(), certificate.evaluate::<Interval>()] {
            match found {
                Ok(proof) => return Err(format!("{what}: accepted with {}", proof.bound)),
                Err(why) if !reason(&why) => return Err(format!("{what}: refused, but: {why}")),
                Err(_) => {}
            }
        }
    }
    let good = example().certificate();
    // What is claimed must follow, and the certificate be as it was made.
    let said = claimed(&good)?;
    good.audit(&said).map_err(|e| format!("refused as it was made: {e}"))?;
    let smaller = Said { bound: said.bound.next_down(), ..said.clone() };
    let mut other = said.clone();
    other.shares[0] = other.shares[0].next_up();
    let fewer = Said { shares: said.shares[1..].to_vec(), ..said.clone() };
    for wrong in [smaller, other, fewer] {
        if good.audit(&wrong).is_ok() {
            return Err("a claim that does not follow is accepted".to_owned());
        }
    }
    let mut unbalanced = good;
    for edge in &mut unbalanced.edges {
        if let Role::Inner(force) = &mut edge.role {
            force[0][0] += 1e-9;
            break;
        }
    }
    match unbalanced.audit(&claimed(&unbalanced)?) {
        Err(Rejection::OutOfBalance { .. }) => {}
        other => return Err(format!("a traction that is off by 1e-9: {other:?}")),
    }
    let count = 2 * TAMPERINGS.len() + QUADRATIC_TAMPERINGS.len();
    Ok(format!("{count} tamperings and 4 claims"))
}

/// The row.
pub fn claim() -> Claim {
    let squares = statement!(
        the_square_of_the_bound_splits_at_a_point,
        [exx, eyy, exy, txx, tyy, txy, lambda, mu],
        ["always"]
    )
    .with_hints(|v| vec![v[0] + v[1], v[0] - v[1], v[2]]);
    let contact =
        statement!(what_contact_adds_is_not_negative, [u, s, v, t, g], ["pressed", "not pressed"]);
    Claim {
        id: "24",
        items: &["the error bound"],
        title: "The bound of the distance from the true solution, and its checker",
        paper: "Nothing: the estimates of the paper have unknown constants.",
        statement: "|u - v|_a^2 + |sigma(u) - tau|^2 <= |C eps(v) - tau|^2 + 2 int tau_n (v_n - g), in the norm of C^-1, for v that is admissible and tau in equilibrium with the loads, without shear and tension on Gamma_C (docs/theory.md, 7.2): at a point the squares split, and what contact adds to the integral of their product is not negative. The checker of certificates, on certificates of random v, affine or quadratic on the triangles, and affine tau that are made by hand of dyadic numbers: the square of its bound, |v|_a and J(v) are the integrals of their definitions, never below, to 1e-10; with data that oscillate, each triangle's share has its term; the square of the bound less 2 J(v) is the same for every v, where loads are affine on each triangle, too; tractions that are out of balance by what the checker may add are balanced again; where the direction of contact turns, the same for certificates of the solver's, and what a larger gap adds is its work. It refuses what the theorem does not allow, for its own reason, in 22 ways for a v that is affine and 31 for one that is quadratic, among them a tension, a penetration of 1e-6 or between the ends of an edge or its three nodes, where a test at the nodes sees none, a prescribed value or bulge missed by a rounding error, a body that nothing holds; of bodies that are held along oblique directions alone, with tractions across, the same integrals, and 17 more ways, among them a support that is turned at one end and a value along it that v misses by 1e-12; a bound without the curvature of v is too small; and the audit refuses a claim that is smaller by one double, another share, and a traction that is off by 1e-9. What it concludes from balls, a sign, an order, an end, and nothing from a NaN, are harnesses of the model checker, on the functions that it calls. The checker over balls of doubles is never below the same source over exact rationals, P1 and P2, with body forces that are constant or affine, and the potential energy encloses it; what balls lose on a triangle is bounded by its shape: forces known to r make stresses known to 48 h^3 r / (2 |T|)^2. The intervals of J(u) on a coarse and on a fine mesh meet, and so do those of the compliance, which is given where loads alone act. What loads and bent displacements cost on a triangle is its definition, with Korn's constant; what displacements lack between the vertices is in the bound, and data outside the exact class, scaled, scale it. A field that is moved raises the bound at least by what moves it. A quadratic displacement that is the solution, with its affine stress, is certified with a bound of rounding errors by P2. On 60 exact solutions with drawn parameters, (a), (b) and (c) of docs/theory.md, 10, P1 and P2, the true error is never above the bound. That 1,000 tampered certificates are rejected: tests/suite/certify.rs.",
        numbers: "every ordered field at a point (proof); balls and intervals against rationals, in which a root is rounded to 2^-200; doubles for the true errors.",
        kernel: &[
            "material::Material::stress",
            "composite::Affine::of_displacement",
            "composite::Affine::at_corner",
            "composite::Affine::at",
            "composite::Affine::mean",
            "composite::Affine::energy",
            "composite::Frame::new",
            "composite::Composite::new",
            "composite::Composite::bent",
            "composite::Composite::at",
            "composite::Composite::distance_from",
            "composite::Composite::energy",
            "composite::Loads::resultant",
            "composite::Composite::resultant",
            "composite::Wrench::about",
            "composite::Wrench::plus",
            "composite::Wrench::on_edge",
            "composite::complementary",
            "material::Material::map",
            "audit::proof::Certificate::evaluate",
            "audit::proof::Certificate::audit",
        ],
        preconditions: "The data are those of the certificate: the checker does not see the problem that it was made for; `signorini audit --case` compares them with it (tests/suite/audit.rs). Green's formula.",
        limits: "Pieces that are cut, and how a certificate is made of a problem (`certify::build`, `sweeps`, `oscillation`), are looked at through their results only: a mistake there makes the bound of another problem, or a larger one. 60 solutions are samples; true errors are by quadrature. Trusted: the checker, balls, IEEE 754.",
        single: None,
        checks: [
            vec![
                proved(squares),
                proved(contact),
                tested(contact),
                exact!("the_checker_finds_what_the_definitions_say" => bounds_are_the_definitions()),
                doubles!("tractions_out_of_balance_are_balanced_again" => draws::hold(60, draws_of(true), &["always"], |draw| balanced(draw, false))),
                doubles!("the_checker_refuses_what_the_theorem_does_not_allow" => refusals(true)),
                refuted(statement!(
                    control_contact_adds_under_tension,
                    [u, s, v, t, g],
                    fails "(v - u) * (s - t) + t * (v - g) >= zero"
                )),
                exact!("control_a_bound_a_millionth_too_small" => draws::reject(draws_of(false), |draw| evaluated::<Ball>(draw, 1.0 - 1e-6))),
                doubles!("control_tractions_that_no_balance_takes" => draws::reject(draws_of(true), |draw| balanced(draw, true))),
                doubles!("control_certificates_as_they_were_made_are_refused" => noticed(refusals(false))),
                doubles!("the_square_of_the_bound_less_twice_the_energy_depends_on_tau_alone" => draws::hold(60, draws_of(false), &["always"], |draw| duality_gap(draw, false))),
                doubles!("control_the_loads_of_vertices_exchanged" => draws::reject(draws_of(false), |draw| duality_gap(draw, true))),
                exact!("the_potential_energy_has_the_load_of_each_vertex" => draws::hold(40, draws_of(false), &["always"], |draw| loads_at_vertices(draw, true))),
                exact!("control_the_load_of_the_first_vertex_at_all" => draws::reject(draws_of(false), |draw| loads_at_vertices(draw, false))),
                exact!("the_curvature_of_v_is_in_the_bound" => draws::hold(40, draws_of(false), &["always"], |draw| of_a_body_at_rest(draw, true))),
                exact!("control_the_curvature_of_v_dropped" => draws::reject(draws_of(false), |draw| of_a_body_at_rest(draw, false))),
                doubles!("control_v_tested_at_three_nodes_of_an_edge" => noticed(three_nodes_tell())),
            ],
            supports::checks(),
            distance::checks(),
            attained::of_turning_contact().to_vec(),
            checker::HARNESSES.iter().copied().map(model_checked).collect(),
        ]
        .concat(),
    }
}
