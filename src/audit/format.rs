//! A certificate as two files: certificate.json, which says what is claimed and which arrays there are, and certificate.bin,
//! which holds them. docs/certificates.md, "The files", says what each of their words is.
//!
//! An array that a reader does not know is refused: what it says may change what the others prove. So a new one is added by its
//! name, here in `layout`, [`encode`] and [`decode`], without another version of the format; files without it stay what they are.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::certificate::{Certificate, Curved, Cut, Edge, Lift, Piece, Reservations, Role};
use super::checks::Rejection;
use super::forces::{Between, Evidence, ForceTarget, Lifting, Motion, Ramp};
use super::proof::{Claim, Proof};
use crate::kernel::{Material, Plane};

/// The format that is written and read.
const FORMAT: u32 = 10;

/// certificate.json.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// The version of the format.
    pub format: u32,
    /// The title of the case.
    pub title: String,
    /// In words.
    pub statement: String,
    /// The degree of v: 1 or 2.
    pub degree: u8,
    /// |u - v|_a is at most this.
    pub bound: f64,
    /// The boundaries on which there are forces, and all others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub boundaries: Vec<String>,
    /// The arrays of certificate.bin, in their order.
    pub arrays: Vec<Array>,
    /// A hash of certificate.bin, in hexadecimal digits: against accidents, not against intent.
    pub hash: String,
}

/// An array of certificate.bin.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// The words of an entry: `f` for a double, `n` for a whole number, of eight bytes each, least significant first.
    pub words: String,
    /// The number of entries that it has.
    pub entries: usize,
}

/// Name and words of the arrays.
mod layout {
    pub type Layout = (&'static str, &'static str);
    pub const VERTICES: Layout = ("vertices", "ff");
    pub const DISPLACEMENT: Layout = ("displacement", "ff");
    pub const PRESCRIBED: Layout = ("prescribed", "nfnf");
    pub const CUTS: Layout = ("cuts", "nnf");
    pub const TRIANGLES: Layout = ("triangles", "nnnnnnfffffffff");
    pub const TENSORS: Layout = ("tensors", "ffffff");
    pub const EDGES: Layout = ("edges", "nnnffff");
    pub const DIRECTIONS: Layout = ("directions", "nffff");
    pub const FRAMES: Layout = ("frames", "nff");
    pub const AT_CUTS: Layout = ("displacement at cuts", "ff");
    pub const PRESCRIBED_AT_CUTS: Layout = ("prescribed at cuts", "nfnf");
    pub const BULGES: Layout = ("bulges", "ffff");
    pub const LIFTS: Layout = ("lifts", "nnnf");
    pub const POLYGON: Layout = ("polygon", "n");
    pub const SHARES: Layout = ("shares", "f");
    pub const BOUNDARIES: Layout = ("boundaries", "nn");
    pub const FORCES: Layout = ("forces", "nnnfffff");
    pub const W: Layout = ("w", "ff");
    pub const W_AT_CUTS: Layout = ("w at cuts", "ff");
    pub const W_BULGES: Layout = ("w bulges", "ff");
    pub const DUAL_FORCES: Layout = ("dual forces", "nff");
    pub const DUAL_W: Layout = ("dual w", "ff");
    pub const DUAL_W_AT_CUTS: Layout = ("dual w at cuts", "ff");
    pub const DUAL_W_BULGES: Layout = ("dual w bulges", "ff");
    pub const DUAL_EDGES: Layout = ("dual edges", "nffff");
}
use layout::Layout;

/// The part that all versions of the format share.
#[derive(Deserialize)]
struct FormatVersion {
    format: u32,
}

/// Why a certificate is not accepted. The first two may quote the file: a terminal is to get them escaped.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum Refused {
    #[error("{0}")]
    Header(String),
    #[error("{0}")]
    Arrays(String),
    #[error("rejected: {0}")]
    Rejected(#[from] Rejection),
}

/// The findings of an audit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Audit {
    /// The claim.
    pub header: Header,
    /// The certificate that it is made of.
    pub certificate: Certificate,
    /// The proof, evaluated anew.
    pub proof: Proof,
    /// Forces of the true solution, each between two numbers.
    pub forces: Evidence,
    /// Differences between the arrays and the problem, derived from the arrays.
    pub reservations: Reservations,
}

impl Audit {
    /// The forces that are proved, by their names, with what they lie between: those of obstacles and supports on the body.
    pub fn forces(&self) -> impl Iterator<Item = (String, [f64; 2])> {
        let forces = &self.forces;
        let between = forces.between.iter().flat_map(|between| &between.liftings);
        let pairs = forces.between.as_ref().map_or(&[][..], |between| &between.pairs);
        forces.liftings.iter().zip(between).map(|((target, _), &ends)| {
            let [low, high] = forces.nearest(*target, ends, pairs);
            let edges = self.certificate.edges.iter().zip(&forces.of);
            let is_contact = |(edge, of): (&Edge, &Option<usize>)| {
                *of == target.boundary && matches!(edge.role, Role::Contact { .. })
            };
            let kind = if edges.into_iter().any(is_contact) { "contact" } else { "reaction" };
            let name = target.boundary.and_then(|k| forces.names.get(k));
            let name = name.map_or("", String::as_str);
            let (what, ends) = match target.motion {
                Motion::Along(None) => ("force".to_owned(), [low.max(0.0), high]),
                Motion::Along(Some(Ramp { axis, between: [from, to], width })) => {
                    let along = ["x", "y"][axis];
                    let words = format!("force {along} {from} {to} ramp {width}");
                    (words, [low.max(0.0), high])
                }
                Motion::Axis(c) => (["force x", "force y"][c].to_owned(), [-high, -low]),
                Motion::Turn => ("moment".to_owned(), [-high, -low]),
            };
            (format!("{kind} {what} of {name:?}"), ends)
        })
    }
}

const STATEMENT: &str = "|u - v|_a <= bound for the solution u of the contact problem with these data and the displacement v";

/// certificate.json and certificate.bin of a certificate and what it proves, with forces.
pub fn encode(
    title: &str,
    certificate: &Certificate,
    proof: &Proof,
    forces: &Evidence,
) -> (Header, Vec<u8>) {
    let mut out = arrays(certificate, &proof.shares);
    let boundaries = match &forces.between {
        Some(between) => {
            add_forces(certificate, forces, between, &mut out);
            forces.names.clone()
        }
        None => Vec::new(),
    };
    let ArrayWriter { arrays, bytes } = out;
    let header = Header {
        format: FORMAT,
        title: title.to_owned(),
        statement: STATEMENT.to_owned(),
        degree: if certificate.curved.is_some() { 2 } else { 1 },
        // Two doubles more: whoever reads the decimals of a number may be off by one.
        bound: certificate.with_lifts(proof.bound).next_up().next_up(),
        boundaries,
        arrays,
        hash: hash(&bytes),
    };
    (header, bytes)
}

/// The header in the bytes of certificate.json.
///
/// # Errors
/// [`Refused::Header`].
pub fn read_header(header: &[u8]) -> Result<Header, Refused> {
    let none = |e| {
        Refused::Header(format!(
            "this is no certificate: {e}; expected certificate.json, as signorini solve --certificate writes it"
        ))
    };
    let FormatVersion { format } = serde_json::from_slice(header).map_err(none)?;
    if format != FORMAT {
        return Err(Refused::Header(format!(
            "the certificate is of format {format}; expected {FORMAT}, the one that this program writes and verifies"
        )));
    }
    serde_json::from_slice(header).map_err(none)
}

/// Verifies everything anew, from the header and the bytes of certificate.bin.
///
/// # Errors
/// Bytes that are no certificate; whatever [`Certificate::audit`] rejects.
pub fn audit(header: Header, arrays: &[u8]) -> Result<Audit, Refused> {
    let (certificate, claim) = decode(&header, arrays).map_err(Refused::Arrays)?;
    let proof = certificate.audit(&claim)?;
    let reservations = certificate.reservations();
    let forces = claim.forces;
    Ok(Audit { header, certificate, proof, forces, reservations })
}

/// The certificate and the claim in the arrays.
///
/// # Errors
/// A reason, in words, why they are none.
pub fn decode(header: &Header, bytes: &[u8]) -> Result<(Certificate, Claim), String> {
    if header.format != FORMAT {
        return Err(format!("the format is {}; expected {FORMAT}", header.format));
    }
    if header.statement != STATEMENT {
        return Err("it states something else than this program can verify".to_owned());
    }
    let found = hash(bytes);
    if found != header.hash {
        return Err(format!("its hash is {found}; certificate.json says {:?}", header.hash));
    }
    let mut arrays = ArrayReader::new(&header.arrays, bytes)?;
    let tensors = arrays.next(layout::TENSORS)?.map(|c| Material::tensor(numbers(c), None));
    let tensors: Vec<Material<f64>> = tensors.collect();
    let mut certificate = Certificate {
        vertices: arrays.next(layout::VERTICES)?.map(numbers).collect(),
        displacement: arrays.next(layout::DISPLACEMENT)?.map(numbers).collect(),
        curved: None,
        prescribed: arrays.next(layout::PRESCRIBED)?.map(given).collect::<Result<_, _>>()?,
        frames: BTreeMap::new(),
        cuts: arrays.next(layout::CUTS)?.map(cut).collect(),
        pieces: arrays
            .next(layout::TRIANGLES)?
            .map(|words| piece(words, &tensors))
            .collect::<Result<_, _>>()?,
        edges: arrays.next(layout::EDGES)?.enumerate().map(edge).collect::<Result<_, _>>()?,
        lifts: arrays.next(layout::LIFTS)?.map(lift).collect(),
        polygon: arrays.next(layout::POLYGON)?.map(|[e]| index(e)).collect(),
    };
    for [e, a, b, c, d] in arrays.next(layout::DIRECTIONS)? {
        let (e, d) = (index(e), [numbers([a, b]), numbers([c, d])]);
        match certificate.edges.get_mut(e).map(|edge| &mut edge.role) {
            Some(Role::Contact { along: along @ None, .. }) => *along = Some(d),
            Some(Role::Supported { along: along @ [0.0, 0.0], .. }) if d[0] == d[1] => {
                *along = d[0];
            }
            _ => return Err(format!("a direction for edge {e}, which has none, or has one")),
        }
    }
    for [point, x, y] in arrays.next(layout::FRAMES)? {
        let point = index(point);
        if certificate.frames.insert(point, numbers([x, y])).is_some() {
            return Err(format!("two frames at point {point}"));
        }
    }
    match header.degree {
        1 => {}
        2 => {
            let of_both = |[a, b, c, d]: [u64; 4]| (numbers([a, b]), numbers([c, d]));
            let (bulges, data) = arrays.next(layout::BULGES)?.map(of_both).unzip();
            let prescribed = arrays.next(layout::PRESCRIBED_AT_CUTS)?.map(given);
            certificate.curved = Some(Curved {
                at_cuts: arrays.next(layout::AT_CUTS)?.map(numbers).collect(),
                prescribed: prescribed.collect::<Result<_, _>>()?,
                bulges,
                data,
            });
        }
        other => return Err(format!("the degree of v is {other}; expected 1 or 2")),
    }
    let shares = arrays.next(layout::SHARES)?.map(|[share]| f64::from_bits(share)).collect();
    let forces = forces(header, &certificate, &mut arrays)?;
    arrays.end()?;
    Ok((certificate, Claim { shares, bound: header.bound, forces }))
}

/// Lists of so many entries each, one after the other.
fn lists<T>(
    name: &str,
    entries: impl ExactSizeIterator<Item = T>,
    count: usize,
    each: usize,
) -> Result<Vec<Vec<T>>, String> {
    if Some(entries.len()) != count.checked_mul(each) {
        let found = entries.len();
        return Err(format!("{name:?} has {found} entries; expected {count} times {each}"));
    }
    let mut entries = entries;
    Ok((0..count).map(|_| entries.by_ref().take(each).collect()).collect())
}

/// The forces, with what proves them.
fn forces(
    header: &Header,
    certificate: &Certificate,
    arrays: &mut ArrayReader,
) -> Result<Evidence, String> {
    let (vertices, cuts) = (certificate.vertices.len(), certificate.cuts.len());
    let edges = certificate.edges.len();
    let names = header.boundaries.clone();
    let boundary = |word: u64| match index(word).checked_sub(1) {
        Some(k) if k >= names.len() => Err(format!("there is no boundary {word}")),
        found => Ok(found),
    };
    let mut of = vec![None; edges];
    for [e, word] in arrays.next(layout::BOUNDARIES)? {
        let edge = certificate.edges.get(index(e)).filter(|edge| is_named(edge));
        let place = edge.and_then(|_| of.get_mut(index(e)).filter(|of| of.is_none()));
        *place.ok_or_else(|| format!("edge {e} has a boundary twice, or holds nothing"))? =
            boundary(word)?;
    }
    let mut between = Vec::new();
    let mut targets = Vec::new();
    for [motion, of, axis, numbers @ ..] in arrays.next::<8>(layout::FORCES)? {
        let [from, to, width, low, high]: [f64; 5] = numbers.map(f64::from_bits);
        let weight = match axis {
            0 if [from, to, width] == [0.0; 3] => None,
            // Its kinks lie one after the other.
            1 | 2 if from <= to && 0.0 < width && (to - from + width).is_finite() => {
                Some(Ramp { axis: index(axis) - 1, between: [from, to], width })
            }
            _ => return Err("a weight is none".to_owned()),
        };
        let motion = match (motion, weight) {
            (0, weight) => Motion::Along(weight),
            (1 | 2, None) => Motion::Axis(index(motion) - 1),
            (3, None) => Motion::Turn,
            _ => return Err(format!("there is no motion {motion} with this weight")),
        };
        let boundary = boundary(of)?;
        // w0 comes first.
        if boundary.is_none() != targets.is_empty() {
            return Err("a force is that of no boundary".to_owned());
        }
        targets.push(ForceTarget { boundary, motion });
        between.push([low, high]);
    }
    let Some((&of_cover, between)) = between.split_first() else {
        return Ok(Evidence::default());
    };
    let named = certificate.edges.iter().zip(&of).all(|(edge, of)| !is_named(edge) || of.is_some());
    if !named || targets[0].motion != Motion::Along(None) {
        return Err("a force or an edge is that of no boundary".to_owned());
    }
    let (count, targets) = (targets.len(), targets.split_off(1));
    let list = |arrays: &mut ArrayReader, layout: Layout, count: usize, each: usize| {
        lists(layout.0, arrays.next(layout)?.map(numbers), count, each)
    };
    let displacements = |arrays: &mut ArrayReader, layouts: [Layout; 3], count: usize| {
        let at_vertices = list(arrays, layouts[0], count, vertices)?;
        let beyond = if arrays.has(layouts[2]) {
            let at_cuts = list(arrays, layouts[1], count, cuts)?;
            let bulges = list(arrays, layouts[2], count, edges)?;
            at_cuts.into_iter().zip(bulges).map(|(a, b)| Some([a, b])).collect()
        } else {
            vec![None; count]
        };
        Ok::<_, String>(at_vertices.into_iter().zip(beyond))
    };
    let layouts = [layout::W, layout::W_AT_CUTS, layout::W_BULGES];
    let mut all = displacements(arrays, layouts, count)?
        .map(|(vertices, beyond)| Lifting { vertices, beyond });
    let is_zero = |w: &Lifting| {
        let beyond = w.beyond.iter().flatten().flatten();
        w.vertices.iter().chain(beyond).all(|&w| w == [0.0; 2])
    };
    let cover = all.next().filter(|w| of_cover != [0.0; 2] || !is_zero(w));
    let liftings = targets.iter().copied().zip(all).collect();
    let of_pairs = arrays.next(layout::DUAL_FORCES)?;
    let of_pairs: Vec<(u64, [f64; 2])> =
        of_pairs.map(|[force, low, high]| (force, numbers([low, high]))).collect();
    let layouts = [layout::DUAL_W, layout::DUAL_W_AT_CUTS, layout::DUAL_W_BULGES];
    let duals = displacements(arrays, layouts, of_pairs.len())?;
    let (name, words) = (layout::DUAL_EDGES.0, arrays.next(layout::DUAL_EDGES)?);
    let roles = lists(name, words, of_pairs.len(), edges)?;
    let mut pairs = Vec::with_capacity(of_pairs.len());
    for ((&(force, _), (w, beyond)), roles) in of_pairs.iter().zip(duals).zip(roles) {
        let target = targets.get(index(force)).ok_or("a dual pair is for no force")?;
        let along = |(e, [role, a, b, c, d]): (usize, [u64; 5])| {
            let edge = edge((e, [0, 0, role, a, b, c, d]))?;
            Ok(match (edge.role, certificate.edges[e].role) {
                (Role::Supported { force, traction, .. }, Role::Supported { along, .. }) => {
                    Role::Supported { along, force, traction }
                }
                (role, _) => role,
            })
        };
        let roles = roles.into_iter().enumerate().map(along).collect::<Result<_, String>>()?;
        pairs.push((*target, certificate.with_dual(w, beyond, roles)));
    }
    let between = Some(Between {
        cover: of_cover,
        liftings: between.to_vec(),
        pairs: of_pairs.into_iter().map(|(_, ends)| ends).collect(),
    });
    Ok(Evidence { names, of, cover, liftings, pairs, between })
}

/// An edge that holds something has the name of its boundary.
fn is_named(edge: &Edge) -> bool {
    matches!(edge.role, Role::Held(..) | Role::Supported { .. } | Role::Contact { .. })
}

/// Adds forces, with what proves them.
fn add_forces(
    certificate: &Certificate,
    forces: &Evidence,
    between: &Between,
    out: &mut ArrayWriter,
) {
    let Evidence { of, cover, liftings, pairs, .. } = forces;
    let words = |xs: &[f64; 2]| xs.map(f64::to_bits);
    let number = |boundary: &Option<usize>| boundary.map_or(0, |k| k as u64 + 1);
    let named =
        certificate.edges.iter().zip(of).enumerate().filter(|(_, (edge, _))| is_named(edge));
    out.add(layout::BOUNDARIES, named.map(|(e, (_, of))| [e as u64, number(of)]));
    let of_w0 = ForceTarget { boundary: None, motion: Motion::Along(None) };
    let targets = std::iter::once(&of_w0).chain(liftings.iter().map(|(target, _)| target));
    let ends = std::iter::once(&between.cover).chain(&between.liftings);
    out.add(
        layout::FORCES,
        targets.zip(ends).map(|(target, [low, high])| {
            let (motion, weight) = match target.motion {
                Motion::Along(weight) => (0, weight),
                Motion::Axis(c) => (c as u64 + 1, None),
                Motion::Turn => (3, None),
            };
            let (axis, [from, to], width) =
                weight.map_or((0, [0.0; 2], 0.0), |r| (r.axis as u64 + 1, r.between, r.width));
            let [a, b, c, d, e] = [from, to, width, *low, *high].map(f64::to_bits);
            [motion, number(&target.boundary), axis, a, b, c, d, e]
        }),
    );
    let none = || Lifting {
        vertices: vec![[0.0; 2]; certificate.vertices.len()],
        beyond: liftings.iter().any(|(_, w)| w.beyond.is_some()).then(|| {
            [certificate.cuts.len(), certificate.edges.len()].map(|count| vec![[0.0; 2]; count])
        }),
    };
    let cover = cover.clone().unwrap_or_else(none);
    let all = || std::iter::once(&cover).chain(liftings.iter().map(|(_, w)| w));
    out.add(layout::W, all().flat_map(|w| &w.vertices).map(words));
    for (k, layout) in [layout::W_AT_CUTS, layout::W_BULGES].into_iter().enumerate() {
        out.add(layout, all().flat_map(|w| &w.beyond).flat_map(|both| &both[k]).map(words));
    }
    let place = |target: &ForceTarget| liftings.iter().position(|(other, _)| other == target);
    let served = pairs.iter().zip(&between.pairs);
    let served = served.filter_map(|((target, pair), ends)| Some((place(target)?, pair, ends)));
    let served: Vec<(usize, &Certificate, &[f64; 2])> = served.collect();
    let ends = |&(force, _, ends): &(usize, &Certificate, &[f64; 2])| {
        let [low, high] = words(ends);
        [force as u64, low, high]
    };
    out.add(layout::DUAL_FORCES, served.iter().map(ends));
    let pairs = || served.iter().map(|&(_, pair, _)| pair);
    out.add(layout::DUAL_W, pairs().flat_map(|pair| &pair.displacement).map(words));
    let curved = || pairs().flat_map(|pair| &pair.curved);
    out.add(layout::DUAL_W_AT_CUTS, curved().flat_map(|curved| &curved.at_cuts).map(words));
    out.add(layout::DUAL_W_BULGES, curved().flat_map(|curved| &curved.bulges).map(words));
    out.add(
        layout::DUAL_EDGES,
        pairs().flat_map(|pair| &pair.edges).map(|edge| {
            let [_, _, role, a, b, c, d] = edge_words(edge);
            [role, a, b, c, d]
        }),
    );
}

fn arrays(certificate: &Certificate, shares: &[f64]) -> ArrayWriter {
    let mut out = ArrayWriter::default();
    let double = |x: &f64| x.to_bits();
    let words = |xs: &[f64; 2]| xs.map(f64::to_bits);
    let prescribed = |data: &[Option<f64>; 2]| {
        let [x, y] = data.map(|u| (u64::from(u.is_some()), u.unwrap_or(0.0).to_bits()));
        [x.0, x.1, y.0, y.1]
    };
    out.add(layout::VERTICES, certificate.vertices.iter().map(words));
    out.add(layout::DISPLACEMENT, certificate.displacement.iter().map(words));
    out.add(layout::PRESCRIBED, certificate.prescribed.iter().map(prescribed));
    let cut = |Cut { ends: [a, b], at }: &Cut| [*a as u64, *b as u64, at.to_bits()];
    out.add(layout::CUTS, certificate.cuts.iter().map(cut));
    let mut tensors: Vec<Material<f64>> = Vec::new();
    for material in certificate.pieces.iter().map(|piece| piece.material) {
        if !material.is_isotropic() && !tensors.contains(&material) {
            tensors.push(material);
        }
    }
    out.add(
        layout::TRIANGLES,
        certificate.pieces.iter().map(|piece| {
            let ([a, b, c], [d, e, f]) = (piece.vertices, piece.edges);
            let [lambda, mu] = if piece.material.is_isotropic() {
                [piece.material.lambda(), piece.material.mu()].map(f64::to_bits)
            } else {
                {
                    let place = tensors.iter().position(|tensor| *tensor == piece.material);
                    [(place.unwrap_or(0) as f64).to_bits(), 0]
                }
            };
            let [p, q, r] = piece.body.map(|f| words(&f));
            let [a, b, c, d, e, f] = [a, b, c, d, e, f].map(|i| i as u64);
            let oscillation = piece.oscillation.to_bits();
            [a, b, c, d, e, f, lambda, mu, p[0], p[1], q[0], q[1], r[0], r[1], oscillation]
        }),
    );
    out.add(layout::TENSORS, tensors.iter().map(|material| material.stiffness().map(f64::to_bits)));
    out.add(layout::EDGES, certificate.edges.iter().map(edge_words));
    // Those of contact that are not the edges' normals, and those of edges that are held along one alone.
    out.add(
        layout::DIRECTIONS,
        certificate.edges.iter().enumerate().filter_map(|(e, edge)| {
            let [d, f] = match edge.role {
                Role::Contact { along, .. } => along?,
                Role::Supported { along, .. } => [along; 2],
                _ => return None,
            };
            let ([a, b], [c, d]) = (words(&d), words(&f));
            Some([e as u64, a, b, c, d])
        }),
    );
    out.add(
        layout::FRAMES,
        certificate.frames.iter().map(|(&point, d)| {
            let [x, y] = words(d);
            [point as u64, x, y]
        }),
    );
    if let Some(Curved { at_cuts, prescribed: data_at_cuts, bulges, data }) = &certificate.curved {
        out.add(layout::AT_CUTS, at_cuts.iter().map(words));
        out.add(layout::PRESCRIBED_AT_CUTS, data_at_cuts.iter().map(prescribed));
        out.add(
            layout::BULGES,
            bulges.iter().zip(data).map(|(bulge, data)| {
                let ([a, b], [c, d]) = (words(bulge), words(data));
                [a, b, c, d]
            }),
        );
    }
    out.add(
        layout::LIFTS,
        certificate.lifts.iter().map(|lift| {
            let [a, b, c] = lift.corners.map(|p| p as u64);
            [a, b, c, lift.norm.to_bits()]
        }),
    );
    out.add(layout::POLYGON, certificate.polygon.iter().map(|&e| [e as u64]));
    out.add(layout::SHARES, shares.iter().map(|x| [double(x)]));
    out
}

fn edge_words(edge: &Edge) -> [u64; 7] {
    let words = |xs: &[f64; 2]| xs.map(f64::to_bits);
    let (role, [start, end]) = match edge.role {
        Role::Inner(force) => (0, force),
        Role::Held(held, force) => (u64::from(held[0]) + 2 * u64::from(held[1]), force),
        Role::Loaded(traction) => (4, traction),
        Role::Pressed(pressure) => (5, [pressure, [0.0; 2]]),
        Role::Contact { pressure, gap, .. } => (6, [pressure, gap]),
        Role::Supported { force, traction, .. } => (7, [force, traction]),
    };
    let ([a, b], [c, d], [e, f]) = (edge.ends.map(|p| p as u64), words(&start), words(&end));
    [a, b, role, c, d, e, f]
}

/// Arrays one after the other.
#[derive(Default)]
struct ArrayWriter {
    arrays: Vec<Array>,
    bytes: Vec<u8>,
}

impl ArrayWriter {
    fn add<const N: usize>(&mut self, layout: Layout, entries: impl Iterator<Item = [u64; N]>) {
        let (name, words) = layout;
        debug_assert_eq!(words.len(), N);
        let before = self.bytes.len();
        self.bytes.reserve(8 * N * entries.size_hint().0);
        entries.flatten().for_each(|word| self.bytes.extend_from_slice(&word.to_le_bytes()));
        let entries = (self.bytes.len() - before) / (8 * N);
        if entries > 0 {
            self.arrays.push(Array { name: name.to_owned(), words: words.to_owned(), entries });
        }
    }
}

/// The arrays that have not been read yet.
struct ArrayReader<'a>(BTreeMap<&'a str, (&'a str, &'a [[u8; 8]])>);

impl<'a> ArrayReader<'a> {
    fn new(arrays: &'a [Array], bytes: &'a [u8]) -> Result<Self, String> {
        let (mut rest, none) = bytes.as_chunks::<8>();
        let mut found = BTreeMap::new();
        for Array { name, words, entries } in arrays {
            let length = entries.checked_mul(words.len());
            let Some((here, after)) = length.and_then(|length| rest.split_at_checked(length))
            else {
                return Err(format!("it ends before the last word of {name:?}"));
            };
            rest = after;
            if found.insert(name.as_str(), (words.as_str(), here)).is_some() {
                return Err(format!("two arrays are called {name:?}"));
            }
        }
        if rest.is_empty() && none.is_empty() {
            Ok(ArrayReader(found))
        } else {
            Err("it has more bytes than the arrays".to_owned())
        }
    }

    /// The entries of an array; none if it is left out.
    fn next<const N: usize>(
        &mut self,
        (name, words): Layout,
    ) -> Result<impl ExactSizeIterator<Item = [u64; N]> + use<'a, N>, String> {
        let (said, array) = self.0.remove(name).unwrap_or((words, &[]));
        if said != words || words.len() != N {
            return Err(format!("{name:?} has entries of the words {said:?}; expected {words:?}"));
        }
        Ok(array.as_chunks::<N>().0.iter().map(|entry| entry.map(u64::from_le_bytes)))
    }

    /// Tells whether an array is there and not read yet.
    fn has(&self, (name, _): Layout) -> bool {
        self.0.contains_key(name)
    }

    fn end(self) -> Result<(), String> {
        match self.0.keys().next() {
            None => Ok(()),
            Some(name) => {
                Err(format!("an array is called {name:?}, which this program does not know"))
            }
        }
    }
}

/// A number that names nothing is as good as the largest.
fn index(word: u64) -> usize {
    usize::try_from(word).unwrap_or(usize::MAX)
}

fn numbers<const N: usize>(words: [u64; N]) -> [f64; N] {
    words.map(f64::from_bits)
}

fn given([a, u, b, v]: [u64; 4]) -> Result<[Option<f64>; 2], String> {
    let component = |there: u64, value: f64| match (there, value) {
        (0, 0.0) => Ok(None),
        (1, value) => Ok(Some(value)),
        _ => Err("a prescribed value is neither there nor not".to_owned()),
    };
    Ok([component(a, f64::from_bits(u))?, component(b, f64::from_bits(v))?])
}

fn cut([a, b, at]: [u64; 3]) -> Cut {
    Cut { ends: [a, b].map(index), at: f64::from_bits(at) }
}

fn lift([a, b, c, norm]: [u64; 4]) -> Lift {
    Lift { corners: [a, b, c].map(index), norm: f64::from_bits(norm) }
}

fn piece(words: [u64; 15], tensors: &[Material<f64>]) -> Result<Piece, String> {
    let [a, b, c, d, e, f, lambda, mu, body @ .., oscillation] = words;
    let [p, q, r, s, t, u] = numbers(body);
    // No material has mu = 0: then the first of the two is the number of a tensor.
    let [lambda, mu] = numbers([lambda, mu]);
    let material = if mu == 0.0 {
        let place = lambda as usize;
        let found = tensors.get(place).filter(|_| place as f64 == lambda);
        *found.ok_or_else(|| format!("there is no tensor {lambda}"))?
    } else {
        Material::lame(lambda, mu, Plane::Strain)
    };
    Ok(Piece {
        vertices: [a, b, c].map(index),
        edges: [d, e, f].map(index),
        material,
        body: [[p, q], [r, s], [t, u]],
        oscillation: f64::from_bits(oscillation),
    })
}

fn edge((e, [a, b, role, p, q, r, s]): (usize, [u64; 7])) -> Result<Edge, String> {
    let (start, end) = (numbers([p, q]), numbers([r, s]));
    let role = match role {
        0 => Role::Inner([start, end]),
        held @ 1..=3 => Role::Held([held & 1 != 0, held & 2 != 0], [start, end]),
        4 => Role::Loaded([start, end]),
        5 if end == [0.0; 2] && start != [0.0; 2] => Role::Pressed(start),
        6 => Role::Contact { pressure: start, gap: end, along: None },
        7 => Role::Supported { along: [0.0; 2], force: start, traction: end },
        _ => return Err(format!("edge {e} has an unknown role")),
    };
    Ok(Edge { ends: [a, b].map(index), role })
}

/// The steps of the 64-bit FNV-1a hash, word by word.
pub fn hash(bytes: &[u8]) -> String {
    let (words, rest) = bytes.as_chunks::<8>();
    let rest = rest.iter().map(|&byte| u64::from(byte));
    let words = words.iter().map(|&word| u64::from_le_bytes(word)).chain(rest);
    let step = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", words.fold(0xcbf2_9ce4_8422_2325, step))
}
