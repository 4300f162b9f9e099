//! A certificate as it is written: certificate.json and certificate.bin, in the words and arrays of [`format`](mod@super::format), whose
//! reader is the checker's.

use super::certificate::{Certificate, Curved, Edge, Law, Piece, Role};
use super::dual::Dual;
use super::forces::{Between, Evidence, ForceTarget, Lifting, Motion};
use super::format::{
    Array, EdgeEntry, FORMAT, ForceEntry, Header, PieceEntry, RoleEntry, STATEMENT, Words, hash,
    is_named, name_of,
};
use super::proof::Proof;
use crate::kernel::Material;

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
        let mut write = |_, word: u64| {
            self.bytes.extend_from_slice(&word.to_le_bytes());
            word
        };
        entries.for_each(|entry| {
            let _ = entry.replaced(&mut write);
        });
        let entries = (self.bytes.len() - before) / (8 * words.len());
        if entries > 0 {
            self.arrays.push(Array { name: name.to_owned(), words, entries });
        }
    }
}
