//! A certificate as two files: certificate.json, which says what is claimed and which arrays there are, and certificate.bin,
//! which holds them. docs/certificates.md, "The files", says what each of their words is.
//!
//! An array that a reader does not know is refused: what it says may change what the others prove. So a new one is added by its
//! name, in [`encode`] and [`decode`], without another version of the format; files without it stay what they are.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::certificate::{Certificate, Curved, Cut, Edge, Law, Lift, Piece, Reservations, Role};
use super::checks::Rejection;
use super::dual::Dual;
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
    /// The thickness of the body, if it is known: the forces of the arrays are those of a body that is 1 thick.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
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

/// A force of the true solution, or a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct ProvedForce {
    /// In words.
    pub name: String,
    /// True for a moment, false for a force.
    pub is_moment: bool,
    /// The numbers that it lies between, for a body that is 1 thick.
    pub between: [f64; 2],
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
    pub fn forces(&self) -> impl Iterator<Item = ProvedForce> {
        let forces = &self.forces;
        let between = forces.between.iter().flat_map(|between| &between.liftings);
        let pairs = forces.between.as_ref().map_or(&[][..], |between| &between.pairs);
        forces.liftings.iter().zip(between).map(|((target, _), &ends)| {
            let [low, high] = forces.nearest(*target, ends, pairs);
            let edges = self.certificate.edges.iter().zip(&forces.of);
            let laws = edges.filter_map(|(edge, of)| match edge.role {
                Role::Contact { law, .. } if *of == target.boundary => Some(law),
                _ => None,
            });
            let laws: Vec<Law> = laws.collect();
            let kind = if laws.is_empty() { "reaction" } else { "contact" };
            // Bodies that are tied pull, too.
            let pulls = laws.into_iter().any(Law::is_tied);
            let low_along = if pulls { low } else { low.max(0.0) };
            let name = target.boundary.and_then(|k| forces.names.get(k));
            let name = name.map_or("", String::as_str);
            let (what, ends) = match target.motion {
                Motion::Along(None) => ("force".to_owned(), [low_along, high]),
                Motion::Along(Some(Ramp { axis, between: [from, to], width })) => {
                    let along = ["x", "y"][axis];
                    let words = format!("force {along} {from} {to} ramp {width}");
                    (words, [low_along, high])
                }
                Motion::Axis(c) => (["force x", "force y"][c].to_owned(), [-high, -low]),
                Motion::Turn => ("moment".to_owned(), [-high, -low]),
            };
            let is_moment = target.motion == Motion::Turn;
            let name = format!("{kind} {what} of {name:?}");
            ProvedForce { name, is_moment, between: ends }
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
        thickness: None,
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
    check_header(header, bytes)?;
    let mut arrays = ArrayReader::new(&header.arrays, bytes)?;
    let tensors = arrays.next("tensors")?.map(|c| Material::tensor(c, None));
    let tensors: Vec<Material<f64>> = tensors.collect();
    let lift = |(corners, norm)| Lift { corners, norm };
    let mut certificate = Certificate {
        vertices: arrays.next("vertices")?.collect(),
        displacement: arrays.next("displacement")?.collect(),
        curved: None,
        prescribed: arrays.next("prescribed")?.map(given).collect::<Result<_, _>>()?,
        frames: BTreeMap::new(),
        cuts: arrays.next("cuts")?.map(|(ends, at)| Cut { ends, at }).collect(),
        pieces: arrays.next("triangles")?.map(|t| piece(t, &tensors)).collect::<Result<_, _>>()?,
        edges: arrays.next("edges")?.enumerate().map(edge).collect::<Result<_, _>>()?,
        lifts: arrays.next("lifts")?.map(lift).collect(),
        polygon: arrays.next("polygon")?.collect(),
        facing: BTreeMap::new(),
    };
    add_pairs(&mut certificate, &mut arrays)?;
    add_directions(&mut certificate, &mut arrays)?;
    add_laws(&mut certificate, &mut arrays)?;
    for (point, d) in arrays.next("frames")? {
        if certificate.frames.insert(point, d).is_some() {
            return Err(format!("two frames at point {point}"));
        }
    }
    certificate.curved = match header.degree {
        1 => None,
        2 => Some(curved(&mut arrays)?),
        other => return Err(format!("the degree of v is {other}; expected 1 or 2")),
    };
    let shares = arrays.next("shares")?.collect();
    let forces = forces(header, &certificate, &mut arrays)?;
    arrays.end()?;
    Ok((certificate, Claim { shares, bound: header.bound, forces }))
}

fn check_header(header: &Header, bytes: &[u8]) -> Result<(), String> {
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
    Ok(())
}

/// Which edges face each other.
fn add_pairs(certificate: &mut Certificate, arrays: &mut ArrayReader) -> Result<(), String> {
    for [e, other] in arrays.next::<[usize; 2]>("pairs")? {
        for [e, other] in [[e, other], [other, e]] {
            if certificate.facing.insert(e, other).is_some() {
                return Err(format!("edge {e} faces two edges"));
            }
        }
    }
    Ok(())
}

/// The directions of contact and of supports that are not along normals.
fn add_directions(certificate: &mut Certificate, arrays: &mut ArrayReader) -> Result<(), String> {
    for (e, d) in arrays.next::<(usize, [[f64; 2]; 2])>("directions")? {
        match certificate.edges.get_mut(e).map(|edge| &mut edge.role) {
            Some(Role::Contact { along: along @ None, .. }) => *along = Some(d),
            Some(Role::Supported { along: along @ [0.0, 0.0], .. }) if d[0] == d[1] => {
                *along = d[0];
            }
            _ => return Err(format!("a direction for edge {e}, which has none, or has one")),
        }
    }
    Ok(())
}

/// The laws of contact other than that without friction.
fn add_laws(certificate: &mut Certificate, arrays: &mut ArrayReader) -> Result<(), String> {
    for (e, number, [shear, beside]) in arrays.next::<(usize, usize, [[f64; 2]; 2])>("laws")? {
        match (certificate.edges.get_mut(e).map(|edge| &mut edge.role), number) {
            (Some(Role::Contact { law: law @ Law::Contact, .. }), 1..=3) => {
                *law = match number {
                    1 if [shear, beside] == [[0.0; 2]; 2] => Law::Sliding,
                    2 => Law::Bonded { shear, offset: beside },
                    3 => Law::Friction { shear, bound: beside },
                    _ => return Err(format!("edge {e} slides, with numbers of its own")),
                };
            }
            _ => return Err(format!("a law for edge {e}, which has none, or has one")),
        }
    }
    Ok(())
}

/// The part of a v of degree 2 that is not affine.
fn curved(arrays: &mut ArrayReader) -> Result<Curved, String> {
    let (bulges, data) = arrays.next::<([f64; 2], [f64; 2])>("bulges")?.unzip();
    let prescribed = arrays.next("prescribed at cuts")?.map(given);
    Ok(Curved {
        at_cuts: arrays.next("displacement at cuts")?.collect(),
        prescribed: prescribed.collect::<Result<_, _>>()?,
        bulges,
        data,
    })
}

/// Motion, boundary and the axis of its weight; where the weight is 1, and the width over which it falls; what the force lies
/// between.
type ForceEntry = ([usize; 3], [f64; 3], [f64; 2]);

/// The role of an edge, with its four numbers.
type RoleEntry = (usize, [[f64; 2]; 2]);

/// The forces, with what proves them.
fn forces(
    header: &Header,
    certificate: &Certificate,
    arrays: &mut ArrayReader,
) -> Result<Evidence, String> {
    let names = header.boundaries.clone();
    let of = boundaries(&names, certificate, arrays)?;
    let (targets, between) = targets(&names, arrays)?;
    let Some((&of_cover, between)) = between.split_first() else {
        let alone = !names.is_empty() || of.iter().any(Option::is_some);
        return if alone {
            Err("boundaries without forces".to_owned())
        } else {
            Ok(Evidence::default())
        };
    };
    let named = certificate.edges.iter().zip(&of).all(|(edge, of)| !is_named(edge) || of.is_some());
    if !named || targets[0].motion != Motion::Along(None) {
        return Err("a force or an edge is that of no boundary".to_owned());
    }
    let mut all = displacements("w", targets.len(), certificate, arrays)?;
    let is_zero = |w: &Lifting| {
        let beyond = w.beyond.iter().flatten().flatten();
        w.vertices.iter().chain(beyond).all(|&w| w == [0.0; 2])
    };
    let cover = all.next().filter(|w| of_cover != [0.0; 2] || !is_zero(w));
    let targets = &targets[1..];
    let liftings = targets.iter().copied().zip(all).collect();
    let (pairs, of_pairs) = dual_pairs(targets, certificate, arrays)?;
    let between = Some(Between { cover: of_cover, liftings: between.to_vec(), pairs: of_pairs });
    Ok(Evidence { names, of, cover, liftings, pairs, between })
}

/// A boundary by its number, from 1; 0 says that there is none.
fn boundary(number: usize, names: &[String]) -> Result<Option<usize>, String> {
    match number.checked_sub(1) {
        Some(k) if k >= names.len() => Err(format!("there is no boundary {number}")),
        found => Ok(found),
    }
}

/// The boundary of each edge.
fn boundaries(
    names: &[String],
    certificate: &Certificate,
    arrays: &mut ArrayReader,
) -> Result<Vec<Option<usize>>, String> {
    let mut of = vec![None; certificate.edges.len()];
    for (e, number) in arrays.next::<(usize, usize)>("boundaries")? {
        if !certificate.edges.get(e).is_some_and(|edge| is_named(edge) && of[e].is_none()) {
            return Err(format!("edge {e} has a boundary twice, or holds nothing"));
        }
        of[e] = boundary(number, names)?;
    }
    Ok(of)
}

/// Each force, w0 first, and what it is said to lie between.
fn targets(
    names: &[String],
    arrays: &mut ArrayReader,
) -> Result<(Vec<ForceTarget>, Vec<[f64; 2]>), String> {
    let (mut targets, mut between) = (Vec::new(), Vec::new());
    for ([motion, of, axis], [from, to, width], ends) in arrays.next::<ForceEntry>("forces")? {
        let weight = match axis {
            0 if [from, to, width] == [0.0; 3] => None,
            // Its kinks lie one after the other.
            1 | 2 if from <= to && 0.0 < width && (to - from + width).is_finite() => {
                Some(Ramp { axis: axis - 1, between: [from, to], width })
            }
            _ => return Err("a weight is none".to_owned()),
        };
        let motion = match (motion, weight) {
            (0, weight) => Motion::Along(weight),
            (1 | 2, None) => Motion::Axis(motion - 1),
            (3, None) => Motion::Turn,
            _ => return Err(format!("there is no motion {motion} with this weight")),
        };
        let boundary = boundary(of, names)?;
        if boundary.is_none() != targets.is_empty() {
            return Err("a force is that of no boundary".to_owned());
        }
        targets.push(ForceTarget { boundary, motion });
        between.push(ends);
    }
    Ok((targets, between))
}

fn displacements(
    prefix: &str,
    count: usize,
    certificate: &Certificate,
    arrays: &mut ArrayReader,
) -> Result<impl Iterator<Item = Lifting> + use<>, String> {
    let [of_cuts, of_bulges] = ["at cuts", "bulges"].map(|what| format!("{prefix} {what}"));
    let at_vertices = arrays.lists(prefix, count, certificate.vertices.len())?;
    let beyond = if arrays.has(&of_bulges) {
        let at_cuts = arrays.lists(&of_cuts, count, certificate.cuts.len())?;
        let bulges = arrays.lists(&of_bulges, count, certificate.edges.len())?;
        at_cuts.into_iter().zip(bulges).map(|(a, b)| Some([a, b])).collect()
    } else {
        vec![None; count]
    };
    let all = at_vertices.into_iter().zip(beyond);
    Ok(all.map(|(vertices, beyond)| Lifting { vertices, beyond }))
}

/// Dual pairs of forces, and what each is said to prove.
type DualPairs = (Vec<(ForceTarget, Dual)>, Vec<[f64; 2]>);

/// Dual pairs for some of the forces.
fn dual_pairs(
    targets: &[ForceTarget],
    certificate: &Certificate,
    arrays: &mut ArrayReader,
) -> Result<DualPairs, String> {
    let of_pairs = arrays.next::<(usize, [f64; 2])>("dual forces")?;
    let (forces, between): (Vec<usize>, Vec<[f64; 2]>) = of_pairs.unzip();
    let duals = displacements("dual w", forces.len(), certificate, arrays)?;
    let roles = arrays.lists("dual edges", forces.len(), certificate.edges.len())?;
    let mut pairs = Vec::with_capacity(forces.len());
    for ((force, w), roles) in forces.into_iter().zip(duals).zip(roles) {
        let target = targets.get(force).ok_or("a dual pair is for no force")?;
        let along = |(e, (number, numbers)): (usize, RoleEntry)| {
            Ok(match (role(e, number, numbers)?, certificate.edges[e].role) {
                (Role::Supported { force, traction, .. }, Role::Supported { along, .. }) => {
                    Role::Supported { along, force, traction }
                }
                (role, _) => role,
            })
        };
        let roles = roles.into_iter().enumerate().map(along).collect::<Result<_, String>>()?;
        pairs.push((*target, Dual { w, roles }));
    }
    Ok((pairs, between))
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
    let number = |boundary: &Option<usize>| boundary.map_or(0, |k| k + 1);
    let named =
        certificate.edges.iter().zip(of).enumerate().filter(|(_, (edge, _))| is_named(edge));
    out.add("boundaries", named.map(|(e, (_, of))| (e, number(of))));
    let of_w0 = ForceTarget { boundary: None, motion: Motion::Along(None) };
    let targets = std::iter::once(&of_w0).chain(liftings.iter().map(|(target, _)| target));
    let ends = std::iter::once(&between.cover).chain(&between.liftings);
    let entry = |(target, &ends): (&ForceTarget, &[f64; 2])| -> ForceEntry {
        let (motion, weight) = match target.motion {
            Motion::Along(weight) => (0, weight),
            Motion::Axis(c) => (c + 1, None),
            Motion::Turn => (3, None),
        };
        let (axis, [from, to], width) =
            weight.map_or((0, [0.0; 2], 0.0), |r| (r.axis + 1, r.between, r.width));
        ([motion, number(&target.boundary), axis], [from, to, width], ends)
    };
    out.add("forces", targets.zip(ends).map(entry));
    let none = || Lifting {
        vertices: vec![[0.0; 2]; certificate.vertices.len()],
        beyond: liftings.iter().any(|(_, w)| w.beyond.is_some()).then(|| {
            [certificate.cuts.len(), certificate.edges.len()].map(|count| vec![[0.0; 2]; count])
        }),
    };
    let cover = cover.clone().unwrap_or_else(none);
    let all = || std::iter::once(&cover).chain(liftings.iter().map(|(_, w)| w));
    write_displacements("w", all, out);
    let place = |target: &ForceTarget| liftings.iter().position(|(other, _)| other == target);
    let served = pairs.iter().zip(&between.pairs);
    let served = served.filter_map(|((target, pair), &ends)| Some((place(target)?, pair, ends)));
    let served: Vec<(usize, &Dual, [f64; 2])> = served.collect();
    out.add("dual forces", served.iter().map(|&(force, _, ends)| (force, ends)));
    let pairs = || served.iter().map(|&(_, pair, _)| pair);
    write_displacements("dual w", || pairs().map(|pair| &pair.w), out);
    out.add("dual edges", pairs().flat_map(|pair| &pair.roles).map(role_entry));
}

fn write_displacements<'a, W: Iterator<Item = &'a Lifting>>(
    prefix: &str,
    all: impl Fn() -> W,
    out: &mut ArrayWriter,
) {
    out.add(prefix, all().flat_map(|w| &w.vertices).copied());
    for (k, what) in ["at cuts", "bulges"].into_iter().enumerate() {
        let beyond = all().flat_map(|w| &w.beyond).flat_map(|both| &both[k]);
        out.add(&format!("{prefix} {what}"), beyond.copied());
    }
}

fn arrays(certificate: &Certificate, shares: &[f64]) -> ArrayWriter {
    let mut out = ArrayWriter::default();
    let prescribed =
        |data: &[Option<f64>; 2]| data.map(|u| (usize::from(u.is_some()), u.unwrap_or(0.0)));
    out.add("vertices", certificate.vertices.iter().copied());
    out.add("displacement", certificate.displacement.iter().copied());
    out.add("prescribed", certificate.prescribed.iter().map(prescribed));
    out.add("cuts", certificate.cuts.iter().map(|cut| (cut.ends, cut.at)));
    let mut tensors: Vec<Material<f64>> = Vec::new();
    for material in certificate.pieces.iter().map(|piece| piece.material) {
        if !material.is_isotropic() && !tensors.contains(&material) {
            tensors.push(material);
        }
    }
    let moduli = |material: &Material<f64>| match tensors.iter().position(|t| t == material) {
        Some(place) => [place as f64, 0.0],
        None => [material.lambda(), material.mu()],
    };
    let piece = |piece: &Piece| -> PieceEntry {
        let Piece { vertices, edges, body, oscillation, ref material } = *piece;
        ([vertices, edges], moduli(material), body, oscillation)
    };
    out.add("triangles", certificate.pieces.iter().map(piece));
    out.add("tensors", tensors.iter().map(Material::stiffness));
    let edges = certificate.edges.iter();
    out.add("edges", edges.map(|edge| -> EdgeEntry { (edge.ends, role_entry(&edge.role)) }));
    // Those of contact that are not the edges' normals, and those of edges that are held along one alone.
    let direction = |(e, edge): (usize, &Edge)| match edge.role {
        Role::Contact { along, .. } => Some((e, along?)),
        Role::Supported { along, .. } => Some((e, [along; 2])),
        _ => None,
    };
    out.add("directions", certificate.edges.iter().enumerate().filter_map(direction));
    let law = |(e, edge): (usize, &Edge)| -> Option<(usize, usize, [[f64; 2]; 2])> {
        let Role::Contact { law, .. } = edge.role else { return None };
        match law {
            Law::Contact => None,
            Law::Sliding => Some((e, 1, [[0.0; 2]; 2])),
            Law::Bonded { shear, offset } => Some((e, 2, [shear, offset])),
            Law::Friction { shear, bound } => Some((e, 3, [shear, bound])),
        }
    };
    out.add("laws", certificate.edges.iter().enumerate().filter_map(law));
    out.add("frames", certificate.frames.iter().map(|(&point, &d)| (point, d)));
    if let Some(Curved { at_cuts, prescribed: data_at_cuts, bulges, data }) = &certificate.curved {
        out.add("displacement at cuts", at_cuts.iter().copied());
        out.add("prescribed at cuts", data_at_cuts.iter().map(prescribed));
        out.add("bulges", bulges.iter().zip(data).map(|(&bulge, &data)| (bulge, data)));
    }
    out.add("lifts", certificate.lifts.iter().map(|lift| (lift.corners, lift.norm)));
    out.add("polygon", certificate.polygon.iter().copied());
    let is_second = |e: &usize| certificate.edges[*e].role == Role::Facing;
    let pairs = certificate.facing.iter().filter(|(_, other)| is_second(other));
    out.add("pairs", pairs.map(|(&e, &other)| [e, other]));
    out.add("shares", shares.iter().copied());
    out
}

/// A number or numbers in words of eight bytes each, least significant first.
trait Words: Sized {
    /// Adds `f` for each double, `n` for each whole number.
    fn name(name: &mut String);

    fn write(&self, bytes: &mut Vec<u8>);

    fn read(words: &mut impl Iterator<Item = u64>) -> Self;
}

impl Words for f64 {
    fn name(name: &mut String) {
        name.push('f');
    }

    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_bits().to_le_bytes());
    }

    fn read(words: &mut impl Iterator<Item = u64>) -> f64 {
        f64::from_bits(words.next().unwrap_or_default())
    }
}

impl Words for usize {
    fn name(name: &mut String) {
        name.push('n');
    }

    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&(*self as u64).to_le_bytes());
    }

    /// A number that names nothing is as good as the largest.
    fn read(words: &mut impl Iterator<Item = u64>) -> usize {
        usize::try_from(words.next().unwrap_or_default()).unwrap_or(usize::MAX)
    }
}

impl<T: Words, const N: usize> Words for [T; N] {
    fn name(name: &mut String) {
        (0..N).for_each(|_| T::name(name));
    }

    fn write(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|x| x.write(bytes));
    }

    fn read(words: &mut impl Iterator<Item = u64>) -> [T; N] {
        std::array::from_fn(|_| T::read(words))
    }
}

macro_rules! words_of_tuple {
    ($($kind:ident $place:tt),+) => {
        impl<$($kind: Words),+> Words for ($($kind,)+) {
            fn name(name: &mut String) {
                $($kind::name(name);)+
            }

            fn write(&self, bytes: &mut Vec<u8>) {
                $(self.$place.write(bytes);)+
            }

            fn read(words: &mut impl Iterator<Item = u64>) -> Self {
                ($($kind::read(words),)+)
            }
        }
    };
}
words_of_tuple!(A 0, B 1);
words_of_tuple!(A 0, B 1, C 2);
words_of_tuple!(A 0, B 1, C 2, D 3);

fn name_of<T: Words>() -> String {
    let mut name = String::new();
    T::name(&mut name);
    name
}

/// Arrays one after the other.
#[derive(Default)]
struct ArrayWriter {
    arrays: Vec<Array>,
    bytes: Vec<u8>,
}

impl ArrayWriter {
    fn add<T: Words>(&mut self, name: &str, entries: impl Iterator<Item = T>) {
        let words = name_of::<T>();
        let before = self.bytes.len();
        self.bytes.reserve(8 * words.len() * entries.size_hint().0);
        entries.for_each(|entry| entry.write(&mut self.bytes));
        let entries = (self.bytes.len() - before) / (8 * words.len());
        if entries > 0 {
            self.arrays.push(Array { name: name.to_owned(), words, entries });
        }
    }
}

/// The arrays that have not been read yet: their words, in letters and in bytes.
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
    fn next<T: Words>(
        &mut self,
        name: &str,
    ) -> Result<impl ExactSizeIterator<Item = T> + use<'a, T>, String> {
        let words = name_of::<T>();
        let (said, array) = self.0.remove(name).unwrap_or((&words, &[]));
        if said != words {
            return Err(format!("{name:?} has entries of the words {said:?}; expected {words:?}"));
        }
        let entries = array.chunks_exact(words.len());
        Ok(entries.map(|entry| T::read(&mut entry.iter().map(|word| u64::from_le_bytes(*word)))))
    }

    /// The entries of an array in lists of so many each.
    fn lists<T: Words>(
        &mut self,
        name: &str,
        count: usize,
        each: usize,
    ) -> Result<Vec<Vec<T>>, String> {
        let mut entries = self.next(name)?;
        if Some(entries.len()) != count.checked_mul(each) {
            let found = entries.len();
            return Err(format!("{name:?} has {found} entries; expected {count} times {each}"));
        }
        Ok((0..count).map(|_| entries.by_ref().take(each).collect()).collect())
    }

    /// Tells whether an array is there and not read yet.
    fn has(&self, name: &str) -> bool {
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

/// Each component: 1 and its value, or 0 and 0.
fn given(data: [(usize, f64); 2]) -> Result<[Option<f64>; 2], String> {
    let component = |data: (usize, f64)| match data {
        (0, 0.0) => Ok(None),
        (1, value) => Ok(Some(value)),
        _ => Err("a prescribed value is neither there nor not".to_owned()),
    };
    Ok([component(data[0])?, component(data[1])?])
}

/// Vertices and edges; lambda and mu, or the number of a tensor and 0, as no material has mu = 0; body force; oscillation.
type PieceEntry = ([[usize; 3]; 2], [f64; 2], [[f64; 2]; 3], f64);

fn piece(
    ([vertices, edges], [lambda, mu], body, oscillation): PieceEntry,
    tensors: &[Material<f64>],
) -> Result<Piece, String> {
    let material = if mu == 0.0 {
        let place = lambda as usize;
        let found = tensors.get(place).filter(|_| place as f64 == lambda);
        *found.ok_or_else(|| format!("there is no tensor {lambda}"))?
    } else {
        Material::lame(lambda, mu, Plane::Strain)
    };
    Ok(Piece { vertices, edges, material, body, oscillation })
}

/// The ends of an edge, and its role.
type EdgeEntry = ([usize; 2], RoleEntry);

fn role_entry(role: &Role) -> RoleEntry {
    match *role {
        Role::Inner(force) => (0, force),
        Role::Held(held, force) => (usize::from(held[0]) + 2 * usize::from(held[1]), force),
        Role::Loaded(traction) => (4, traction),
        Role::Pressed(pressure) => (5, [pressure, [0.0; 2]]),
        Role::Contact { pressure, gap, .. } => (6, [pressure, gap]),
        Role::Supported { force, traction, .. } => (7, [force, traction]),
        Role::Facing => (8, [[0.0; 2]; 2]),
    }
}

/// The role of edge `e`, but for its directions.
fn role(e: usize, number: usize, [start, end]: [[f64; 2]; 2]) -> Result<Role, String> {
    Ok(match number {
        0 => Role::Inner([start, end]),
        held @ 1..=3 => Role::Held([held & 1 != 0, held & 2 != 0], [start, end]),
        4 => Role::Loaded([start, end]),
        5 if end == [0.0; 2] && start != [0.0; 2] => Role::Pressed(start),
        6 => Role::Contact { pressure: start, gap: end, along: None, law: Law::Contact },
        7 => Role::Supported { along: [0.0; 2], force: start, traction: end },
        8 if [start, end] == [[0.0; 2]; 2] => Role::Facing,
        _ => return Err(format!("edge {e} has an unknown role")),
    })
}

fn edge((e, (ends, (number, numbers))): (usize, EdgeEntry)) -> Result<Edge, String> {
    Ok(Edge { ends, role: role(e, number, numbers)? })
}

/// The steps of the 64-bit FNV-1a hash, word by word.
pub fn hash(bytes: &[u8]) -> String {
    let (words, rest) = bytes.as_chunks::<8>();
    let rest = rest.iter().map(|&byte| u64::from(byte));
    let words = words.iter().map(|&word| u64::from_le_bytes(word)).chain(rest);
    let step = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", words.fold(0xcbf2_9ce4_8422_2325, step))
}
