//! A certificate as files: certificate.json, which says what is claimed, and certificate.bin, which holds the arrays.
//!
//! certificate.bin is a sequence of words of eight bytes, least significant first: doubles (f) and whole numbers (n).
//!
//! | array | words for each entry |
//! | --- | --- |
//! | vertices | x y (f) |
//! | displacement, of the vertices | v_x v_y (f) |
//! | prescribed, of the vertices | 1 and u_D, or 0 and 0, for each component (n f n f) |
//! | cuts | the two vertices (n n), the place between them (f) |
//! | triangles | 3 points, 3 edges (n), lambda, mu, the body force at the three points, the oscillation (f) |
//! | edges | start, end, role (n), four numbers of the role (f) |
//! | directions, of contact where it does not act along the normal, and of role 7 | the edge (n), d at its start and at its end (f) |
//! | frames: points that are held along an oblique direction alone | the point (n), d (f) |
//! | if v is quadratic: v at the cuts | v_x v_y (f) |
//! | if v is quadratic: prescribed, of the cuts | as of the vertices (n f n f) |
//! | if v is quadratic: bulges, of the edges | of v, and of the data: u_D, or g and 0, or 0 0 (f f f f) |
//! | shares, of the triangles | the claimed share in the square of the bound (f) |
//!
//! A bulge is the value in the middle of an edge less the mean of its ends. Points are vertices, then cuts. Roles: 0 inner (tau N at start and end), 1, 2, 3 held in x, in y, in both (tau N at start
//! and end), 4 given traction (t at start and end), 5 given pressure (p at start and end, 0 0), 6 contact (tau_n at start and
//! end, g at start and end), 7 held along the direction d alone (tau N . d at start and end, the traction that is given along d turned to
//! the left at start and end; d is the same at both). In a frame the first of the prescribed numbers is u_D . d, and v is the vector nearest
//! to the doubles of the file that has it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::input::{self, InputError};
use crate::certify::Continuous;
use crate::certify::proof::{Certificate, Claim, Curved, Cut, Edge, Piece, Proof, Rejection, Role};
use crate::quote;

/// The names of the files: the claim, and the arrays beside it.
pub const FILES: [&str; 2] = ["certificate.json", "certificate.bin"];

/// The most bytes of a file: some ten million triangles.
const MOST: u64 = 4 << 30;

/// The format that this program writes and reads.
const FORMAT: u32 = 6;

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
    /// The bound that the arrays prove; the rest of `bound` is the lift of what u_D and g lack.
    pub proved: f64,
    /// Every step is proved.
    pub rigorous: bool,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// How many entries the arrays have.
    pub counts: Counts,
    /// A hash of certificate.bin, in hexadecimal digits: against accidents, not against intent.
    pub hash: String,
}

/// How many entries the arrays have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// Vertices.
    pub vertices: usize,
    /// Points between vertices.
    pub cuts: usize,
    /// Triangles.
    pub triangles: usize,
    /// Edges.
    pub edges: usize,
    /// Directions of contact, and of edges that are held along one alone.
    pub directions: usize,
    /// Points that are held along an oblique direction alone.
    pub frames: usize,
}

/// What every version of the format has.
#[derive(Deserialize)]
struct Version {
    format: u32,
}

/// Why a certificate is not accepted.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum AuditError {
    #[error("{}: {error}", quote::path(path))]
    Read { path: PathBuf, error: InputError },
    #[error("{}: {problem}", quote::path(path))]
    Format { path: PathBuf, problem: String },
    #[error("rejected: {0}")]
    Rejected(#[from] Rejection),
}

/// What an audit found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Audit {
    /// What is claimed.
    pub header: Header,
    /// What was proved anew.
    pub proof: Proof,
}

const STATEMENT: &str = "|u - v|_a <= bound for the solution u of the contact problem with these data and the displacement v";

/// certificate.json and certificate.bin.
pub fn encode(title: &str, certified: &Continuous) -> (Header, Vec<u8>) {
    let certificate = &certified.certificate;
    let bytes = arrays(certificate, &certified.proof.shares);
    let header = Header {
        format: FORMAT,
        title: title.to_owned(),
        statement: STATEMENT.to_owned(),
        degree: if certificate.curved.is_some() { 2 } else { 1 },
        bound: beyond_reading(certified.bound),
        proved: beyond_reading(certified.proof.bound),
        rigorous: certified.rigorous,
        reason: certified.reason.clone(),
        counts: counts(certificate),
        hash: hash(&bytes),
    };
    (header, bytes)
}

/// Two doubles more: whoever reads the decimals of a number may be off by one.
fn beyond_reading(bound: f64) -> f64 {
    bound.next_up().next_up()
}

/// Reads certificate.json and the arrays beside it, and verifies everything anew.
///
/// # Errors
/// Files that can't be read or are no certificate; whatever [`Certificate::audit`] rejects; a bound below the proved one.
pub fn audit(path: &Path) -> Result<Audit, AuditError> {
    let read = |path: &Path| {
        input::read(path, MOST).map_err(|error| AuditError::Read { path: path.to_owned(), error })
    };
    let text = read(path)?;
    let wrong =
        |path: &Path, problem: String| AuditError::Format { path: path.to_owned(), problem };
    let none = |e| wrong(path, format!("no certificate: {e}"));
    let Version { format } = serde_json::from_slice(&text).map_err(none)?;
    if format != FORMAT {
        return Err(wrong(
            path,
            format!(
                "the certificate is of format {format}; expected {FORMAT}, the one that this program writes and verifies"
            ),
        ));
    }
    let header: Header = serde_json::from_slice(&text).map_err(none)?;
    let arrays = path.with_file_name(FILES[1]);
    let bytes = read(&arrays)?;
    let (certificate, claim) =
        decode(&header, &bytes).map_err(|problem| wrong(&arrays, problem))?;
    let proof = certificate.audit(&claim)?;
    if !(header.bound >= proof.bound) {
        return Err(Rejection::Bound { claimed: header.bound, found: proof.bound }.into());
    }
    if header.rigorous && (header.bound > header.proved || header.reason.is_some()) {
        return Err(wrong(
            path,
            "a rigorous bound is the proved one, without a reservation".to_owned(),
        ));
    }
    if header.rigorous && certificate.pieces.iter().any(|piece| piece.oscillation != 0.0) {
        return Err(wrong(path, "a rigorous bound has no oscillation by quadrature".to_owned()));
    }
    Ok(Audit { header, proof })
}

/// The certificate and the claim in the arrays.
///
/// # Errors
/// What makes them none, in words.
pub fn decode(header: &Header, bytes: &[u8]) -> Result<(Certificate, Claim), String> {
    if header.format != FORMAT {
        return Err(format!("the format is {}; expected {FORMAT}", header.format));
    }
    if header.statement != STATEMENT {
        return Err("it states something else than this program can verify".to_owned());
    }
    let found = hash(bytes);
    if found != header.hash {
        return Err(format!("its hash is {found}; certificate.json says {}", header.hash));
    }
    if ![1, 2].contains(&header.degree) {
        return Err(format!("the degree of v is {}; expected 1 or 2", header.degree));
    }
    let Counts { vertices, cuts, triangles, edges, directions, frames } = header.counts;
    let quadratic = header.degree == 2;
    let words = |entries: usize, each: usize| entries.checked_mul(each);
    let expected = [
        words(vertices, 8),
        words(cuts, 3),
        words(triangles, 16),
        words(edges, 7),
        words(directions, 5),
        words(frames, 3),
        words(cuts, if quadratic { 6 } else { 0 }),
        words(edges, if quadratic { 4 } else { 0 }),
    ]
    .into_iter()
    .try_fold(0_usize, |sum, words| sum.checked_add(words?))
    .and_then(|words| words.checked_mul(8));
    if expected != Some(bytes.len()) {
        return Err(format!("{} bytes are not what the counts ask for", bytes.len()));
    }
    let mut words = Words { bytes };
    let mut certificate = Certificate {
        vertices: (0..vertices).map(|_| words.pair()).collect(),
        displacement: (0..vertices).map(|_| words.pair()).collect(),
        curved: None,
        prescribed: Vec::with_capacity(vertices),
        frames: BTreeMap::new(),
        cuts: Vec::with_capacity(cuts),
        pieces: Vec::with_capacity(triangles),
        edges: Vec::with_capacity(edges),
    };
    for _ in 0..vertices {
        certificate.prescribed.push(words.prescribed()?);
    }
    for _ in 0..cuts {
        certificate.cuts.push(Cut { ends: [words.index(), words.index()], at: words.number() });
    }
    for _ in 0..triangles {
        certificate.pieces.push(Piece {
            vertices: [words.index(), words.index(), words.index()],
            edges: [words.index(), words.index(), words.index()],
            material: words.pair(),
            body: [words.pair(), words.pair(), words.pair()],
            oscillation: words.number(),
        });
    }
    for e in 0..edges {
        let ends = [words.index(), words.index()];
        let role = words.whole();
        let (start, end) = (words.pair(), words.pair());
        let role = match role {
            0 => Role::Inner([start, end]),
            held @ 1..=3 => Role::Held([held & 1 != 0, held & 2 != 0], [start, end]),
            4 => Role::Loaded([start, end]),
            5 if end == [0.0; 2] && start != [0.0; 2] => Role::Pressed(start),
            6 => Role::Contact { pressure: start, gap: end, along: None },
            7 => Role::Supported { along: [0.0; 2], force: start, traction: end },
            _ => return Err(format!("edge {e} has an unknown role")),
        };
        certificate.edges.push(Edge { ends, role });
    }
    for _ in 0..directions {
        let (e, d) = (words.index(), [words.pair(), words.pair()]);
        match certificate.edges.get_mut(e).map(|edge| &mut edge.role) {
            Some(Role::Contact { along: along @ None, .. }) => *along = Some(d),
            Some(Role::Supported { along: along @ [0.0, 0.0], .. }) if d[0] == d[1] => {
                *along = d[0];
            }
            _ => return Err(format!("a direction for edge {e}, which has none, or has one")),
        }
    }
    for _ in 0..frames {
        let (point, d) = (words.index(), words.pair());
        if certificate.frames.insert(point, d).is_some() {
            return Err(format!("two frames at point {point}"));
        }
    }
    if quadratic {
        let at_cuts = (0..cuts).map(|_| words.pair()).collect();
        let prescribed = (0..cuts).map(|_| words.prescribed()).collect::<Result<_, _>>()?;
        let (bulges, data) = (0..edges).map(|_| (words.pair(), words.pair())).unzip();
        certificate.curved = Some(Curved { at_cuts, prescribed, bulges, data });
    }
    let shares = (0..triangles).map(|_| words.number()).collect();
    Ok((certificate, Claim { shares, bound: header.proved }))
}

fn counts(certificate: &Certificate) -> Counts {
    Counts {
        vertices: certificate.vertices.len(),
        cuts: certificate.cuts.len(),
        triangles: certificate.pieces.len(),
        edges: certificate.edges.len(),
        directions: directions(certificate).count(),
        frames: certificate.frames.len(),
    }
}

fn arrays(certificate: &Certificate, shares: &[f64]) -> Vec<u8> {
    let Counts { vertices, cuts, triangles, edges, directions: turned, frames } =
        counts(certificate);
    let curved = if certificate.curved.is_some() { 6 * cuts + 4 * edges } else { 0 };
    let words =
        8 * vertices + 3 * cuts + 16 * triangles + 7 * edges + 5 * turned + 3 * frames + curved;
    let mut bytes = Vec::with_capacity(8 * words);
    let mut word = |word: u64| bytes.extend_from_slice(&word.to_le_bytes());
    let number = |x: f64| x.to_bits();
    let index = |i: usize| i as u64;
    for pair in certificate.vertices.iter().chain(&certificate.displacement) {
        pair.iter().for_each(|&x| word(number(x)));
    }
    let prescribed = |data: &[[Option<f64>; 2]], word: &mut dyn FnMut(u64)| {
        for data in data.iter().flatten() {
            word(u64::from(data.is_some()));
            word(number(data.unwrap_or(0.0)));
        }
    };
    prescribed(&certificate.prescribed, &mut word);
    for cut in &certificate.cuts {
        cut.ends.iter().for_each(|&i| word(index(i)));
        word(number(cut.at));
    }
    for piece in &certificate.pieces {
        piece.vertices.iter().chain(&piece.edges).for_each(|&i| word(index(i)));
        piece.material.iter().chain(piece.body.as_flattened()).for_each(|&x| word(number(x)));
        word(number(piece.oscillation));
    }
    for edge in &certificate.edges {
        edge.ends.iter().for_each(|&i| word(index(i)));
        let (role, [start, end]) = match edge.role {
            Role::Inner(force) => (0, force),
            Role::Held(held, force) => (u64::from(held[0]) + 2 * u64::from(held[1]), force),
            Role::Loaded(traction) => (4, traction),
            Role::Pressed(pressure) => (5, [pressure, [0.0; 2]]),
            Role::Contact { pressure, gap, .. } => (6, [pressure, gap]),
            Role::Supported { force, traction, .. } => (7, [force, traction]),
        };
        word(role);
        start.iter().chain(&end).for_each(|&x| word(number(x)));
    }
    for (e, along) in directions(certificate) {
        word(index(e));
        along.as_flattened().iter().for_each(|&x| word(number(x)));
    }
    for (&point, d) in &certificate.frames {
        word(index(point));
        d.iter().for_each(|&x| word(number(x)));
    }
    if let Some(Curved { at_cuts, prescribed: data_at_cuts, bulges, data }) = &certificate.curved {
        at_cuts.iter().flatten().for_each(|&x| word(number(x)));
        prescribed(data_at_cuts, &mut word);
        let of_edges = bulges.iter().zip(data).flat_map(|(bulge, data)| [bulge, data]);
        of_edges.flatten().for_each(|&x| word(number(x)));
    }
    shares.iter().for_each(|&x| word(number(x)));
    bytes
}

/// The directions of contact that are not the edges' normals, and of edges that are held along one alone, with the edges.
fn directions(certificate: &Certificate) -> impl Iterator<Item = (usize, [[f64; 2]; 2])> {
    certificate.edges.iter().enumerate().filter_map(|(e, edge)| match edge.role {
        Role::Contact { along, .. } => Some((e, along?)),
        Role::Supported { along, .. } => Some((e, [along; 2])),
        _ => None,
    })
}

/// The words that are left; zeros when there are none, which the lengths rule out.
struct Words<'a> {
    bytes: &'a [u8],
}

impl Words<'_> {
    fn whole(&mut self) -> u64 {
        match self.bytes.split_first_chunk::<8>() {
            Some((word, rest)) => {
                self.bytes = rest;
                u64::from_le_bytes(*word)
            }
            None => 0,
        }
    }

    /// A number that names nothing is as good as the largest.
    fn index(&mut self) -> usize {
        usize::try_from(self.whole()).unwrap_or(usize::MAX)
    }

    fn number(&mut self) -> f64 {
        f64::from_bits(self.whole())
    }

    fn prescribed(&mut self) -> Result<[Option<f64>; 2], String> {
        let mut component = || match (self.whole(), self.number()) {
            (0, 0.0) => Ok(None),
            (1, value) => Ok(Some(value)),
            _ => Err("a prescribed value is neither there nor not".to_owned()),
        };
        Ok([component()?, component()?])
    }

    fn pair(&mut self) -> [f64; 2] {
        [self.number(), self.number()]
    }
}

/// The steps of the 64-bit FNV-1a hash, word by word.
pub fn hash(bytes: &[u8]) -> String {
    let (words, rest) = bytes.as_chunks::<8>();
    let rest = rest.iter().map(|&byte| u64::from(byte));
    let words = words.iter().map(|&word| u64::from_le_bytes(word)).chain(rest);
    let step = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", words.fold(0xcbf2_9ce4_8422_2325, step))
}
