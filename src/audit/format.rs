//! A certificate as two files: certificate.json, which says what is claimed and which arrays there are, and certificate.bin,
//! which holds them. docs/certificates.md, "The files", says what each of their words is.
//!
//! An array that a reader does not know is refused: what it says may change what the others prove. So a new one is added by its
//! name, in [`decode`] and where certificates are written, without another version of the format; files without it stay what they are.

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
pub const FORMAT: u32 = 10;

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
                Motion::Along(ramp) => {
                    let words = |Ramp { axis, between: [from, to], width }| {
                        format!("force {} {from} {to} ramp {width}", ["x", "y"][axis])
                    };
                    (ramp.map_or("force".to_owned(), words), [low_along, high])
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

/// The statement of each certificate.
pub const STATEMENT: &str = "|u - v|_a <= bound for the solution u of the contact problem with these data and the displacement v";

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
pub type ForceEntry = ([usize; 3], [f64; 3], [f64; 2]);

/// The role of an edge, with its four numbers.
pub type RoleEntry = (usize, [[f64; 2]; 2]);

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
pub fn is_named(edge: &Edge) -> bool {
    matches!(edge.role, Role::Held(..) | Role::Supported { .. } | Role::Contact { .. })
}

/// A number or numbers in words of eight bytes each, least significant first.
pub trait Words: Copy {
    /// With 0 for each word.
    const ZERO: Self;

    /// Puts others in place of its words: `word` gets `f` for a double and `n` for a whole number, and the word.
    #[must_use]
    fn replaced(self, word: &mut impl FnMut(char, u64) -> u64) -> Self;
}

impl Words for f64 {
    const ZERO: f64 = 0.0;

    fn replaced(self, word: &mut impl FnMut(char, u64) -> u64) -> f64 {
        f64::from_bits(word('f', self.to_bits()))
    }
}

impl Words for usize {
    const ZERO: usize = 0;

    /// A number that names nothing is as good as the largest.
    fn replaced(self, word: &mut impl FnMut(char, u64) -> u64) -> usize {
        usize::try_from(word('n', self as u64)).unwrap_or(usize::MAX)
    }
}

impl<T: Words, const N: usize> Words for [T; N] {
    const ZERO: [T; N] = [T::ZERO; N];

    fn replaced(self, word: &mut impl FnMut(char, u64) -> u64) -> [T; N] {
        self.map(|x| x.replaced(word))
    }
}

macro_rules! words_of_tuple {
    ($($kind:ident $place:tt),+) => {
        impl<$($kind: Words),+> Words for ($($kind,)+) {
            const ZERO: Self = ($($kind::ZERO,)+);

            fn replaced(self, word: &mut impl FnMut(char, u64) -> u64) -> Self {
                ($(self.$place.replaced(word),)+)
            }
        }
    };
}
words_of_tuple!(A 0, B 1);
words_of_tuple!(A 0, B 1, C 2);
words_of_tuple!(A 0, B 1, C 2, D 3);

/// The letters of all words of an entry.
pub fn name_of<T: Words>() -> String {
    let mut name = String::new();
    let _ = T::ZERO.replaced(&mut |letter, word| {
        name.push(letter);
        word
    });
    name
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
        let read = |entry: &[[u8; 8]]| {
            let mut bytes = entry.iter().copied();
            T::ZERO.replaced(&mut |_, _| bytes.next().map_or(0, u64::from_le_bytes))
        };
        Ok(array.chunks_exact(words.len()).map(read))
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
pub type PieceEntry = ([[usize; 3]; 2], [f64; 2], [[f64; 2]; 3], f64);

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
pub type EdgeEntry = ([usize; 2], RoleEntry);

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_prescribed_component_is_read_from_its_own_entry() {
        assert_eq!(given([(1, 2.0), (1, 3.0)]), Ok([Some(2.0), Some(3.0)]));
        assert_eq!(given([(0, 0.0), (1, 3.0)]), Ok([None, Some(3.0)]));
        assert_eq!(given([(1, 2.0), (0, 0.0)]), Ok([Some(2.0), None]));
        for wrong in [(0, 1.0), (2, 1.0)] {
            assert!(given([wrong, (0, 0.0)]).is_err() && given([(0, 0.0), wrong]).is_err());
        }
    }

    #[test]
    fn the_number_of_a_tensor_is_one_of_those_that_there_are() {
        let tensors = [1.0, 2.0].map(|c| Material::lame(c, c, Plane::Strain));
        let read = |number: f64| piece(([[0; 3]; 2], [number, 0.0], [[0.0; 2]; 3], 0.0), &tensors);
        for (number, tensor) in [0.0, 1.0].into_iter().zip(tensors) {
            assert_eq!(read(number).map(|piece| piece.material), Ok(tensor));
        }
        for number in [-1.0, -0.5, 0.5, 1.0 + f64::EPSILON, 2.0, f64::NAN, f64::INFINITY] {
            assert_eq!(read(number), Err(format!("there is no tensor {number}")));
        }
    }
}
