//! A certificate as two files: certificate.json, which says what is claimed and which arrays there are, and certificate.bin, which
//! holds them. docs/certificates.md, "The files", says what each of their words is.
//!
//! An array that a reader does not know is refused: what it says may change what the others prove. So a new one is added by its
//! name, here in `layout`, [`encode`] and [`decode`], without another version of the format; files without it stay what they are.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::certificate::{Certificate, Curved, Cut, Edge, Lift, Piece, Reservations, Role};
use super::checks::Rejection;
use super::proof::{Claim, Proof};

/// The format that is written and read.
const FORMAT: u32 = 7;

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
    /// What certificate.bin holds, one after the other.
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
    /// How many entries it has.
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
    pub const EDGES: Layout = ("edges", "nnnffff");
    pub const DIRECTIONS: Layout = ("directions", "nffff");
    pub const FRAMES: Layout = ("frames", "nff");
    pub const AT_CUTS: Layout = ("displacement at cuts", "ff");
    pub const PRESCRIBED_AT_CUTS: Layout = ("prescribed at cuts", "nfnf");
    pub const BULGES: Layout = ("bulges", "ffff");
    pub const LIFTS: Layout = ("lifts", "nnnf");
    pub const POLYGON: Layout = ("polygon", "n");
    pub const SHARES: Layout = ("shares", "f");
}
use layout::Layout;

/// What every version of the format has.
#[derive(Deserialize)]
struct Version {
    format: u32,
}

/// Why a certificate is not accepted. The first two may quote the file: a terminal is to get them escaped.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum AuditError {
    #[error("{0}")]
    Header(String),
    #[error("{0}")]
    Arrays(String),
    #[error("rejected: {0}")]
    Rejected(#[from] Rejection),
}

/// What an audit found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Audit {
    /// What is claimed.
    pub header: Header,
    /// What it is claimed of.
    pub certificate: Certificate,
    /// What was proved anew.
    pub proof: Proof,
    /// What the arrays say of the problem that they don't have.
    pub reservations: Reservations,
}

const STATEMENT: &str = "|u - v|_a <= bound for the solution u of the contact problem with these data and the displacement v";

/// certificate.json and certificate.bin of a certificate and what it proves.
pub fn encode(title: &str, certificate: &Certificate, proof: &Proof) -> (Header, Vec<u8>) {
    let Writer { arrays, bytes } = arrays(certificate, &proof.shares);
    let header = Header {
        format: FORMAT,
        title: title.to_owned(),
        statement: STATEMENT.to_owned(),
        degree: if certificate.curved.is_some() { 2 } else { 1 },
        // Two doubles more: whoever reads the decimals of a number may be off by one.
        bound: certificate.with_lifts(proof.bound).next_up().next_up(),
        arrays,
        hash: hash(&bytes),
    };
    (header, bytes)
}

/// The header in the bytes of certificate.json.
///
/// # Errors
/// [`AuditError::Header`].
pub fn read_header(header: &[u8]) -> Result<Header, AuditError> {
    let none = |e| AuditError::Header(format!("no certificate: {e}"));
    let Version { format } = serde_json::from_slice(header).map_err(none)?;
    if format != FORMAT {
        return Err(AuditError::Header(format!(
            "the certificate is of format {format}; expected {FORMAT}, the one that this program writes and verifies"
        )));
    }
    serde_json::from_slice(header).map_err(none)
}

/// Verifies everything anew, from the header and the bytes of certificate.bin.
///
/// # Errors
/// Bytes that are no certificate; whatever [`Certificate::audit`] rejects.
pub fn audit(header: Header, arrays: &[u8]) -> Result<Audit, AuditError> {
    let (certificate, claim) = decode(&header, arrays).map_err(AuditError::Arrays)?;
    let proof = certificate.audit(&claim)?;
    let reservations = certificate.reservations();
    Ok(Audit { header, certificate, proof, reservations })
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
        return Err(format!("its hash is {found}; certificate.json says {:?}", header.hash));
    }
    let mut arrays = Reader::new(&header.arrays, bytes)?;
    let mut certificate = Certificate {
        vertices: arrays.next(layout::VERTICES)?.map(numbers).collect(),
        displacement: arrays.next(layout::DISPLACEMENT)?.map(numbers).collect(),
        curved: None,
        prescribed: arrays.next(layout::PRESCRIBED)?.map(given).collect::<Result<_, _>>()?,
        frames: BTreeMap::new(),
        cuts: arrays.next(layout::CUTS)?.map(cut).collect(),
        pieces: arrays.next(layout::TRIANGLES)?.map(piece).collect(),
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
    arrays.end()?;
    Ok((certificate, Claim { shares, bound: header.bound }))
}

fn arrays(certificate: &Certificate, shares: &[f64]) -> Writer {
    let mut out = Writer::default();
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
    out.add(
        layout::TRIANGLES,
        certificate.pieces.iter().map(|piece| {
            let ([a, b, c], [d, e, f]) = (piece.vertices, piece.edges);
            let ([lambda, mu], [p, q, r]) = (words(&piece.material), piece.body.map(|f| words(&f)));
            let [a, b, c, d, e, f] = [a, b, c, d, e, f].map(|i| i as u64);
            let oscillation = piece.oscillation.to_bits();
            [a, b, c, d, e, f, lambda, mu, p[0], p[1], q[0], q[1], r[0], r[1], oscillation]
        }),
    );
    out.add(
        layout::EDGES,
        certificate.edges.iter().map(|edge| {
            let (role, [start, end]) = match edge.role {
                Role::Inner(force) => (0, force),
                Role::Held(held, force) => (u64::from(held[0]) + 2 * u64::from(held[1]), force),
                Role::Loaded(traction) => (4, traction),
                Role::Pressed(pressure) => (5, [pressure, [0.0; 2]]),
                Role::Contact { pressure, gap, .. } => (6, [pressure, gap]),
                Role::Supported { force, traction, .. } => (7, [force, traction]),
            };
            let ([a, b], [c, d], [e, f]) =
                (edge.ends.map(|p| p as u64), words(&start), words(&end));
            [a, b, role, c, d, e, f]
        }),
    );
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

/// Arrays one after the other.
#[derive(Default)]
struct Writer {
    arrays: Vec<Array>,
    bytes: Vec<u8>,
}

impl Writer {
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
struct Reader<'a>(BTreeMap<&'a str, (&'a str, &'a [[u8; 8]])>);

impl<'a> Reader<'a> {
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
            Ok(Reader(found))
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

fn piece(words: [u64; 15]) -> Piece {
    let [a, b, c, d, e, f, lambda, mu, body @ .., oscillation] = words;
    let [p, q, r, s, t, u] = numbers(body);
    Piece {
        vertices: [a, b, c].map(index),
        edges: [d, e, f].map(index),
        material: numbers([lambda, mu]),
        body: [[p, q], [r, s], [t, u]],
        oscillation: f64::from_bits(oscillation),
    }
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
