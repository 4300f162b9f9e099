//! Certificates that are made by hand, of dyadic numbers, so that tractions are doubles and equilibrium is exact: v has random
//! nodal values, and tau is affine, in equilibrium with a constant body force,
//!
//! tau_xx = a + b x + c y, tau_yy = d + e x + f y, tau_xy = h y, body force (-b - h, -f), no shear at y = 0.
//!
//! v is affine on the triangles, or quadratic with random bulges on the edges; then so are u_D and g. What the checker finds is
//! compared with integrals of the definitions over rationals, by the model of `naive`.

use std::collections::BTreeMap;

use approx::abs_diff_eq;
use proptest::prelude::*;
use signorini::certificates::proof::{Certificate, Curved, Edge, Law, Piece, Role};
use signorini::kernel::{Ball, Enclosing, Material, Plane, PreciseBall};

use props::bodies::whole;
use props::ensure;
use props::naive::{Field, Hooke, Line, integral_of_affine};
use props::numbers::Exact;
use props::verdict::Verdict;

/// A certificate by hand, in sixteenths: cells of a rectangle, v, tau and the gap.
#[derive(Clone, Debug)]
pub struct Draw {
    pub cells: [usize; 2],
    /// Which diagonal each cell has.
    pub left: bool,
    pub lame: [i32; 2],
    /// v at the vertices.
    pub v: Vec<[i32; 2]>,
    /// a, b, c, d, e, f, h
    pub tau: [i32; 7],
    pub gap: [i32; 2],
    pub oscillation: i32,
    /// Bulges on the edges, in turn, in sixty-fourths; none where v is affine.
    pub curve: Vec<[i32; 2]>,
}

pub fn sixteenth(k: i32) -> f64 {
    f64::from(k) / 16.0
}

/// `strip`: one cell beside the other, upwards, so that the triangles form a chain.
pub fn draws_of(strip: bool) -> impl Strategy<Value = Draw> {
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
    pub fn tau<S>(&self, [x, y]: [S; 2], unit: S) -> [S; 3]
    where
        S: From<i32> + Copy + std::ops::Add<Output = S> + std::ops::Mul<Output = S>,
    {
        let [a, b, c, d, e, f, h] = self.tau.map(|k| unit * S::from(k));
        [a + b * x + c * y, d + e * x + f * y, h * y]
    }

    /// The body force.
    pub fn body(&self) -> [f64; 2] {
        let [_, b, _, _, _, f, h] = self.tau.map(sixteenth);
        [-b - h, -f]
    }

    pub fn certificate(&self) -> Certificate {
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
                Role::Contact { pressure: at.map(|t| t[1]), gap, along: None, law: Law::Contact }
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
    pub fn turned(&self) -> Certificate {
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
    pub fn by_definition(&self, certificate: &Certificate) -> Definition {
        let exact = Exact::of_double;
        let [zero, one, two] = [0, 1, 2].map(Exact::from);
        let [lambda, mu] = self.lame.map(|k| exact(sixteenth(k)));
        let hooke = Hooke::Isotropic { lambda, mu };
        let tau = |x: [Exact; 2]| self.tau(x, one / Exact::from(16));
        let curved = certificate.curved.as_ref();
        let bulge = |e: usize| curved.map_or([zero; 2], |curved| curved.bulges[e].map(exact));
        let gap_bulge = |e: usize| curved.map_or(zero, |curved| exact(curved.data[e][0]));
        let body = self.body().map(exact);
        let mut squares = Vec::new();
        let (mut norm, mut energy) = (zero, zero);
        for piece in &certificate.pieces {
            let bulges = curved.map(|curved| &curved.bulges[..]);
            let v = field(certificate, piece, &certificate.displacement, bulges);
            let off = [0, 1, 2].map(|k| {
                let (sigma, tau) = (hooke.stress(v.strain(k)), tau(v.vertices[k]));
                [0, 1, 2].map(|c| sigma[c] - tau[c])
            });
            squares.push(integral_of_affine(v.area(), off, off.map(|s| hooke.strain(s))));
            let internal = v.energy(&v, &hooke);
            norm += internal;
            energy += internal / two - v.load(0, |_| body[0]) - v.load(1, |_| body[1]);
        }
        let (mut contact, mut supports) = (zero, zero);
        for (e, edge) in certificate.edges.iter().enumerate() {
            let [p, q] = edge.ends.map(|k| certificate.vertices[k].map(exact));
            let [v, w] = edge.ends.map(|k| certificate.displacement[k].map(exact));
            let normal = [q[1] - p[1], p[0] - q[0]];
            // tau times the normal, which is as long as the edge.
            let force = [p, q].map(|x| {
                let [xx, yy, xy] = tau(x);
                [xx * normal[0] + xy * normal[1], xy * normal[0] + yy * normal[1]]
            });
            // An affine function times a quadratic one that is given with its bulge.
            let integral = |f: [Exact; 2], g: [Exact; 2], bulge: Exact| {
                let g = Line::quadratic(g[0], (g[0] + g[1]) / two + bulge, g[1]);
                whole(&Line::affine(f[0], f[1]).by(&g))
            };
            let work = |c: usize, force: [[Exact; 2]; 2]| {
                integral(force.map(|f| f[c]), [v[c], w[c]], bulge(e)[c])
            };
            match edge.role {
                Role::Contact { gap, .. } => {
                    // n = (0, -1)
                    let beyond = [-v[1] - exact(gap[0]), -w[1] - exact(gap[1])];
                    let between = -bulge(e)[1] - gap_bulge(e);
                    contact += two * integral(force.map(|f| -f[1]), beyond, between);
                }
                Role::Supported { along, .. } => {
                    let d = along.map(exact);
                    let across = force.map(|[x, y]| {
                        let along = (x * d[0] + y * d[1]) / (d[0] * d[0] + d[1] * d[1]);
                        [x - along * d[0], y - along * d[1]]
                    });
                    supports -= work(0, across) + work(1, across);
                }
                Role::Loaded(_) | Role::Pressed(_) => energy -= work(0, force) + work(1, force),
                _ => {}
            }
        }
        Definition { squares, contact, norm, energy, supports }
    }
}

/// The displacement with these values at the vertices and these bulges on the edges, on a triangle.
pub fn field(
    certificate: &Certificate,
    piece: &Piece,
    at: &[[f64; 2]],
    bulges: Option<&[[f64; 2]]>,
) -> Field<Exact> {
    let vertices = piece.vertices.map(|k| certificate.vertices[k].map(Exact::of_double));
    let v = piece.vertices.map(|k| at[k].map(Exact::of_double));
    let mut nodal = v.to_vec();
    if let Some(bulges) = bulges {
        nodal.extend((0..3).map(|i| {
            let bulge = bulges[piece.edges[i]].map(Exact::of_double);
            let ends = [v[(i + 1) % 3], v[(i + 2) % 3]];
            [0, 1].map(|c| (ends[0][c] + ends[1][c]) / Exact::from(2) + bulge[c])
        }));
    }
    Field { vertices, nodal }
}

/// |C eps(v) - tau|^2 on each triangle, 2 int tau_n (v_n - g), |v|_a^2 and J(v), of which minus the work of what is given beside supports
/// is apart.
pub struct Definition {
    pub squares: Vec<Exact>,
    pub contact: Exact,
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
pub fn evaluated<S: Enclosing>(draw: &Draw, share: f64) -> Verdict {
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
            ensure!(abs_diff_eq!(to_double(found), square, epsilon = CLOSE * (1.0 + square)));
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

/// The square of the bound less 2 J(v) is -2 J*(tau), the same for every v: for tau in equilibrium with a load that is affine on
/// each triangle, int tau : eps(w) is the work of the loads. With `exchanged` the vertices of the other certificate are.
pub fn duality_gap(draw: &Draw, exchanged: bool) -> Verdict {
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
        let proof = certificate.evaluate::<PreciseBall>().ok()?;
        let (square, twice) = (proof.bound * proof.bound, proof.energy[0] + proof.energy[1]);
        Some((square - twice, 1.0 + square + twice.abs()))
    };
    let (Some((one, size)), Some((other, other_size))) = (of(&one), of(&other)) else {
        return Verdict::Fails("both are accepted");
    };
    ensure!(abs_diff_eq!(one, other, epsilon = CLOSE * (size + other_size)));
    Verdict::Holds("always")
}

pub fn to_double(x: Exact) -> f64 {
    use num_traits::ToPrimitive;
    x.value().to_f64().unwrap_or(f64::NAN)
}

pub const CLASSES: [&str; 3] = ["exact data", "exact data, v quadratic", "data that oscillate"];

/// A certificate held along (1, 1) alone at the top and along (1, -1) at the left side, so that v . d and the parts of tau N are
/// doubles still; tau's traction across is the one that is given.
pub fn supported(draw: &Draw) -> Certificate {
    // v is known as balls, which a margin keeps off the obstacle.
    let mut certificate = Draw { gap: [1, draw.gap[1].max(0)], ..draw.clone() }.turned();
    certificate.prescribed.fill([None; 2]);
    let v = certificate.displacement.clone();
    for (e, edge) in certificate.edges.iter_mut().enumerate() {
        let [p, q] = edge.ends.map(|k| certificate.vertices[k]);
        let left = p[0] == 0.0 && q[0] == 0.0;
        let length = if left { p[1] - q[1] } else { 1.0 };
        let (d, traction) = match edge.role {
            // The cells are one wide.
            Role::Held(_, force) => ([1.0, 1.0], force),
            Role::Loaded(traction) if left => ([1.0, -1.0], traction),
            _ => continue,
        };
        let along = |f: [f64; 2]| f[0] * d[0] + f[1] * d[1];
        edge.role = Role::Supported {
            along: d,
            force: traction.map(|t| length * along(t) / 2.0),
            traction: traction.map(|t| (d[0] * t[1] - d[1] * t[0]) / 2.0),
        };
        for k in edge.ends {
            let before = certificate.frames.insert(k, d);
            if before.is_some_and(|before| before != d) || certificate.prescribed[k][1].is_some() {
                certificate.frames.remove(&k);
                certificate.prescribed[k] = v[k].map(Some);
            } else {
                certificate.prescribed[k] = [Some(along(v[k])), None];
            }
        }
        if let Some(curved) = &mut certificate.curved {
            curved.data[e] = [along(curved.bulges[e]), 0.0];
        }
    }
    certificate
}

/// The checker against the definitions where bodies are held along directions; `work` is the share of the work of what is given
/// beside them that is counted.
pub fn evaluated_with_supports(draw: &Draw, work: f64) -> Verdict {
    evaluated_of::<Ball>(draw, supported(draw), [1.0, work])
}

/// Tractions on inner edges and on Gamma_D that are out of balance by what the checker may add: it finds the balanced ones
/// again, for the triangles form a chain. With `gross` something else is added too.
pub fn balanced(draw: &Draw, gross: bool) -> Verdict {
    let certificate = draw.turned();
    let Ok(before) = certificate.evaluate::<PreciseBall>() else {
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
    let Ok(after) = moved.evaluate::<PreciseBall>() else {
        return Verdict::Fails("what is out of balance is balanced");
    };
    // A bound is a root: near zero it is known to half the digits.
    let [before, after] = [before.bound, after.bound].map(|b| b * b);
    ensure!(abs_diff_eq!(after, before, epsilon = 1e-9 * (1.0 + before)));
    Verdict::Holds("always")
}
