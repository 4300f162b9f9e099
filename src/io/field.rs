//! A displacement that another program computed: VTU or CSV, read at the vertices of a mesh.
//!
//! - `.csv`: a first line with the names x, y, ux, uy (in any order, among others), then a line for each point.
//! - `.vtu`: the points, and on them the vectors called `displacement` or `u`, or the only ones there are. Numbers in text or
//!   base64, as they are or compressed by zlib: what this program, meshio, FEniCSx, GetFEM and scikit-fem write. Not the
//!   appended section that VTK itself prefers.
//!
//! Points are matched to vertices by their place. A field on quadratic triangles of VTU (with six points each, VTK's types 22 and
//! 69) is read at the middles of the edges, too. A field with points elsewhere, on other triangles, or with several values at one
//! place, is refused: a bound would be of another field.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;
use thiserror::Error;

use super::input::{self, InputError};
use crate::fem::{Degree, Mesh, Space};
use crate::memory;
use crate::quote;

/// Why there is no field.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the message of each variant says what it is")]
#[non_exhaustive]
pub enum FieldError {
    #[error("{}: {error}", quote::path(path))]
    Read { path: PathBuf, error: InputError },
    #[error("{}: {problem}", quote::path(path))]
    Format { path: PathBuf, problem: String },
}

/// The most bytes of a file: the text of some ten million points.
const MOST: u64 = 2 << 30;

/// A point is a vertex when it is this near, in units of the body's extent: coordinates written in single precision pass.
const NEAR: f64 = 1e-6;

/// The displacement in the file at the vertices of `mesh` and, if it is quadratic, at the middles of its edges: at the nodes of
/// degree 1 or 2.
///
/// # Errors
/// A file that can't be read or understood, that lacks a node of the mesh or has points that are none, or two values at one, or
/// triangles that are not those of the mesh.
pub fn read_field(path: &Path, mesh: &Mesh) -> Result<Vec<[f64; 2]>, FieldError> {
    let bytes = input::read(path, MOST)
        .map_err(|error| FieldError::Read { path: path.to_owned(), error })?;
    let text = String::from_utf8_lossy(&bytes);
    let field = match path.extension().and_then(|e| e.to_str()) {
        Some("csv") => from_csv(&text).map(|points| (points, None)),
        Some("vtu") => from_vtu(&text).and_then(|points| Ok((points, triangles_of(&text)?))),
        _ => Err("expected a file that ends in .vtu or .csv".to_owned()),
    };
    field
        .and_then(|(points, triangles)| at_nodes(&points, mesh, triangles.as_ref()))
        .map_err(|problem| FieldError::Format { path: path.to_owned(), problem })
}

/// The triangles of a VTU file.
struct Triangles {
    /// Their corners by the points of the file.
    corners: Vec<[usize; 3]>,
    /// Each has a point in the middle of each side, too.
    quadratic: bool,
}

/// Places with displacements.
type Points = Vec<([f64; 2], [f64; 2])>;

fn at_nodes(
    points: &Points,
    mesh: &Mesh,
    triangles: Option<&Triangles>,
) -> Result<Vec<[f64; 2]>, String> {
    let quadratic = triangles.is_some_and(|triangles| triangles.quadratic);
    let vertices = mesh.vertices().len();
    let nodes: Vec<[f64; 2]> = if quadratic {
        Space::new(mesh, Degree::Two).nodes().to_vec()
    } else {
        mesh.vertices().to_vec()
    };
    let extent = (0..2)
        .map(|c| {
            let of =
                |pick: fn(f64, f64) -> f64, start| nodes.iter().map(|x| x[c]).fold(start, pick);
            of(f64::max, f64::NEG_INFINITY) - of(f64::min, f64::INFINITY)
        })
        .fold(0.0, f64::max);
    let width = 4.0 * NEAR * extent;
    // From a vertex on, so that the numbers of the cells near the body are small wherever it lies.
    let origin = nodes[0];
    let cell = |x: [f64; 2]| [0, 1].map(|c| ((x[c] - origin[c]) / width).floor() as i64);
    let mut grid: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for (k, &x) in nodes.iter().enumerate() {
        grid.entry(cell(x)).or_default().push(k);
    }
    let distance = |k: usize, x: [f64; 2]| (nodes[k][0] - x[0]).hypot(nodes[k][1] - x[1]);
    let nearest = |x: [f64; 2]| {
        let [i, j] = cell(x);
        let around = |i: i64| i.saturating_sub(1)..=i.saturating_add(1);
        let cells = around(i).flat_map(|i| around(j).map(move |j| [i, j]));
        cells
            .filter_map(|cell| grid.get(&cell))
            .flatten()
            .copied()
            .min_by(|&a, &b| distance(a, x).total_cmp(&distance(b, x)))
            .filter(|&k| distance(k, x) <= NEAR * extent)
    };
    let what = if quadratic { "vertex or middle of an edge" } else { "vertex" };
    let size = points.iter().flat_map(|(_, u)| u).fold(0.0_f64, |max, u| max.max(u.abs()));
    // The nearest point to each node.
    let mut found: Vec<Option<usize>> = vec![None; nodes.len()];
    let (mut elsewhere, mut node_of) = (Vec::new(), Vec::with_capacity(points.len()));
    for (i, &(x, u)) in points.iter().enumerate() {
        if !x.iter().chain(&u).all(|c| c.is_finite()) {
            return Err(format!(
                "point {i} has a number that is NaN or infinite; expected finite ones"
            ));
        }
        let Some(k) = nearest(x) else {
            elsewhere.push(x);
            continue;
        };
        node_of.push(k);
        let Some(other) = found[k].replace(i) else { continue };
        let (y, w) = points[other];
        if (0..2).any(|c| (u[c] - w[c]).abs() > NEAR * size) {
            return Err(format!(
                "points {other} and {i} lie at one {what}, ({}, {}), and have the displacements ({}, {}) and ({}, {}); expected one",
                x[0], x[1], w[0], w[1], u[0], u[1]
            ));
        }
        if distance(k, y) < distance(k, x) {
            found[k] = Some(other);
        }
    }
    if let Some(x) = elsewhere.first() {
        return Err(format!(
            "{} of its {} points lie at no {what} of the case's mesh, the first at ({}, {}); expected a field on that mesh, as what it does elsewhere would not be seen",
            elsewhere.len(),
            points.len(),
            x[0],
            x[1]
        ));
    }
    let value = |(k, found): (usize, Option<usize>)| match found {
        Some(i) => Ok(points[i].1),
        None => Err(format!(
            "none of its {} points lies at {} of the mesh, ({}, {}); expected the displacement at every {}",
            points.len(),
            if k < vertices { format!("vertex {k}") } else { "the middle of an edge".to_owned() },
            nodes[k][0],
            nodes[k][1],
            if quadratic { "vertex and every middle of an edge" } else { "vertex" }
        )),
    };
    let values = found.into_iter().enumerate().map(value).collect::<Result<_, _>>()?;
    if let Some(triangles) = triangles {
        check_triangles(triangles, &node_of, mesh)?;
    }
    Ok(values)
}

/// The triangles of a file are those of the mesh: on others, such as those along the other diagonals of a grid, the same
/// values are another field. `node_of` tells the node of each point.
fn check_triangles(triangles: &Triangles, node_of: &[usize], mesh: &Mesh) -> Result<(), String> {
    let sorted = |mut corners: [usize; 3]| {
        corners.sort_unstable();
        corners
    };
    let mut rest: BTreeSet<[usize; 3]> = mesh.triangles().iter().copied().map(sorted).collect();
    for (k, corners) in triangles.corners.iter().enumerate() {
        let nodes = corners.map(|point| node_of[point]);
        if !rest.remove(&sorted(nodes)) {
            return Err(format!(
                "its triangle {k} is none of the case's mesh, or comes twice; expected a field on that mesh, as on other triangles the same values are another field"
            ));
        }
    }
    if rest.is_empty() {
        return Ok(());
    }
    let (lacking, all) = (rest.len(), mesh.triangles().len());
    Err(format!("it lacks {lacking} of the {all} triangles of the case's mesh; expected all"))
}

/// The most points of a cell of VTK's, of degree 2.
const POINTS_OF_A_CELL: usize = 27;

/// The triangles of a VTU file, if it has cells; points and lines may be among them.
fn triangles_of(text: &str) -> Result<Option<Triangles>, String> {
    let head = text.find("<VTKFile").and_then(|from| text[from..].split('>').next());
    let cells = section(text, "Cells").map(arrays).unwrap_or_default();
    let named = |name: &str| cells.iter().find(|array| array.attribute("Name") == Some(name));
    let (Some(head), Some(count), Some(types), Some(offsets), Some(connectivity)) = (
        head,
        count(text, "NumberOfCells"),
        named("types"),
        named("offsets"),
        named("connectivity"),
    ) else {
        return Ok(None);
    };
    let points = self::count(text, "NumberOfPoints").unwrap_or(0);
    let types = numbers(types, head, count)?;
    let offsets = numbers(offsets, head, count)?;
    let connectivity = numbers(connectivity, head, count.saturating_mul(POINTS_OF_A_CELL))?;
    if types.len() != count || offsets.len() != count {
        return Err(format!("it says NumberOfCells = {count}, and has others"));
    }
    let mut triangles = Triangles { corners: Vec::new(), quadratic: false };
    let mut start = 0.0;
    for (k, (kind, end)) in types.into_iter().zip(offsets).enumerate() {
        let (from, size) = (start as usize, end - start);
        start = end;
        let quadratic = match (kind as u8, size as usize) {
            // Points and lines.
            (1..=4 | 21 | 68, _) => continue,
            (5 | 69, 3) => false,
            (22 | 69, 6) => true,
            _ => {
                return Err(format!(
                    "its cell {k} is of VTK's type {kind} with {size} points; expected triangles with three points (5, 69) or six (22, 69)"
                ));
            }
        };
        if !triangles.corners.is_empty() && quadratic != triangles.quadratic {
            return Err("it has triangles with three points and with six; expected one kind".into());
        }
        triangles.quadratic = quadratic;
        let corners = connectivity.get(from..from.saturating_add(3));
        let Some(&[a, b, c]) = corners.and_then(|corners| corners.first_chunk()) else {
            return Err(format!("its cell {k} has points that its connectivity lacks"));
        };
        let corners = [a, b, c].map(|point| point as usize);
        if corners.iter().any(|&point| point >= points) {
            return Err(format!("its cell {k} names a point that it does not have"));
        }
        triangles.corners.push(corners);
    }
    Ok((!triangles.corners.is_empty()).then_some(triangles))
}

fn from_csv(text: &str) -> Result<Points, String> {
    let mut lines = text.lines().enumerate();
    let (_, head) = lines.next().ok_or("the file is empty; expected x,y,ux,uy")?;
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let column = |name: &str| {
        names.iter().position(|n| *n == name).ok_or_else(|| {
            format!(
                "line 1 has no column '{name}' among {}; expected x, y, ux and uy, with commas between",
                quote::names(names.iter().copied())
            )
        })
    };
    let columns = [column("x")?, column("y")?, column("ux")?, column("uy")?];
    let mut points = Vec::new();
    for (i, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |c: usize| {
            let cell = cells.get(c).copied().unwrap_or_default();
            cell.parse::<f64>().map_err(|_| {
                let cell = quote::quoted(cell, '\'');
                format!("line {}: {cell} is no number; expected {}", i + 1, names[c])
            })
        };
        let [x, y, u, v] = columns.map(number);
        points.push(([x?, y?], [u?, v?]));
    }
    Ok(points)
}

/// One array of a VTU file: its attributes and its text.
struct Array<'a> {
    attributes: &'a str,
    text: &'a str,
}

impl<'a> Array<'a> {
    fn attribute(&self, name: &str) -> Option<&'a str> {
        attribute(self.attributes, name)
    }

    fn components(&self) -> usize {
        self.attribute("NumberOfComponents").and_then(|n| n.parse().ok()).unwrap_or(1)
    }
}

fn attribute<'a>(attributes: &'a str, name: &str) -> Option<&'a str> {
    let mut rest = attributes;
    loop {
        let place = rest.find(name)?;
        let before = rest[..place].chars().next_back();
        rest = &rest[place + name.len()..];
        let Some(value) = rest.trim_start().strip_prefix('=') else { continue };
        let value = value.trim_start();
        let Some(quote) = value.chars().next().filter(|c| ['"', '\''].contains(c)) else {
            continue;
        };
        if before.is_none_or(char::is_whitespace) {
            return value[1..].split(quote).next();
        }
    }
}

/// The text between `<tag ...>` and `</tag>`.
fn section<'a>(text: &'a str, tag: &str) -> Option<&'a str> {
    let from = text.find(&format!("<{tag}"))?;
    let inside = &text[from + text[from..].find('>')? + 1..];
    Some(&inside[..inside.find(&format!("</{tag}>"))?])
}

fn arrays(section: &str) -> Vec<Array<'_>> {
    let parts = section.split("<DataArray").skip(1);
    parts
        .filter_map(|part| {
            let (attributes, rest) = part.split_once('>')?;
            // An empty array closes itself.
            let text =
                if attributes.ends_with('/') { "" } else { rest.split("</DataArray").next()? };
            Some(Array { attributes, text: text.trim() })
        })
        .collect()
}

fn from_vtu(text: &str) -> Result<Points, String> {
    let head = text
        .find("<VTKFile")
        .and_then(|from| text[from..].split('>').next())
        .ok_or("it has no element <VTKFile>; expected a VTU file")?;
    if text.matches("<Piece").count() > 1 {
        return Err("it has several pieces; expected one".to_owned());
    }
    let places = section(text, "Points").map(arrays).unwrap_or_default();
    let places = places.first().ok_or("it has no <Points>")?;
    let fields = section(text, "PointData").map(arrays).unwrap_or_default();
    let vectors: Vec<&Array> =
        fields.iter().filter(|a| (2..=3).contains(&a.components())).collect();
    let named = vectors
        .iter()
        .find(|a| ["displacement", "u"].iter().any(|name| a.attribute("Name") == Some(name)));
    let field = match (named, vectors.as_slice()) {
        (Some(field), _) => field,
        (None, [only]) => only,
        _ => {
            let names = quote::names(vectors.iter().filter_map(|a| a.attribute("Name")));
            return Err(format!(
                "its vectors on points are [{names}]; expected one called displacement or u, or just one"
            ));
        }
    };
    let (dim, components) = (places.components().max(2), field.components());
    let points = count(text, "NumberOfPoints").ok_or("its <Piece> has no NumberOfPoints")?;
    let (x, u) = (numbers(places, head, points)?, numbers(field, head, points)?);
    if x.len() / dim != u.len() / components || x.len() % dim != 0 {
        return Err(format!(
            "{} coordinates and {} components of vectors don't fit",
            x.len(),
            u.len()
        ));
    }
    if points != x.len() / dim {
        let has = x.len() / dim;
        return Err(format!("it says NumberOfPoints = {points}, and points are there: {has}"));
    }
    let pairs = x.chunks_exact(dim).zip(u.chunks_exact(components));
    Ok(pairs.map(|(x, u)| ([x[0], x[1]], [u[0], u[1]])).collect())
}

/// The attribute `name` of the piece, `NumberOfPoints` or `NumberOfCells`.
fn count(text: &str, name: &str) -> Option<usize> {
    let piece = text.find("<Piece").and_then(|from| text[from..].split('>').next())?;
    attribute(piece, name)?.trim().parse().ok()
}

/// The numbers of an array, the components of `count` points or cells.
fn numbers(array: &Array, head: &str, count: usize) -> Result<Vec<f64>, String> {
    let name = quote::cut(array.attribute("Name").unwrap_or("Points"));
    let bytes = match array.attribute("format") {
        Some("ascii") | None => {
            let number = |word: &str| {
                let wrong = |_| format!("{name}: {} is no number", quote::quoted(word, '\''));
                word.parse().map_err(wrong)
            };
            return array.text.split_whitespace().map(number).collect();
        }
        Some("binary") => {
            // No number has more bytes than a double. As bytes, as code and as doubles at a time.
            let most = count.saturating_mul(8 * array.components());
            memory::check(3 * most as u64).map_err(|lack| format!("{name}: {lack}"))?;
            blocks(array.text, head, most).map_err(|problem| format!("{name}: {problem}"))?
        }
        Some(other) => {
            let other = quote::quoted(other, '\'');
            return Err(format!("{name} has the format {other}; expected ascii or binary"));
        }
    };
    if attribute(head, "byte_order").is_some_and(|order| order != "LittleEndian") {
        return Err("its byte order is not LittleEndian".to_owned());
    }
    fn each<const N: usize>(bytes: &[u8], number: fn([u8; N]) -> f64) -> Vec<f64> {
        bytes.as_chunks().0.iter().map(|&bytes| number(bytes)).collect()
    }
    match array.attribute("type") {
        Some("Float64") => Ok(each(&bytes, f64::from_le_bytes)),
        Some("Float32") => Ok(each(&bytes, |b| f32::from_le_bytes(b).into())),
        Some("UInt8") => Ok(each(&bytes, |b| u8::from_le_bytes(b).into())),
        Some("Int8") => Ok(each(&bytes, |b| i8::from_le_bytes(b).into())),
        Some("UInt32") => Ok(each(&bytes, |b| u32::from_le_bytes(b).into())),
        Some("Int32") => Ok(each(&bytes, |b| i32::from_le_bytes(b).into())),
        Some("UInt64") => Ok(each(&bytes, |b| u64::from_le_bytes(b) as f64)),
        Some("Int64") => Ok(each(&bytes, |b| i64::from_le_bytes(b) as f64)),
        other => {
            let other = quote::quoted(other.unwrap_or_default(), '\'');
            Err(format!("{name} has the type {other}; expected Float64 or Float32"))
        }
    }
}

/// The bytes of a base64 array: its length, then the data; or, compressed, the number of blocks, their size, the size of the
/// last one, their compressed sizes, and in a code of its own the blocks. All together are at most `most` bytes.
fn blocks(code: &str, head: &str, most: usize) -> Result<Vec<u8>, String> {
    let word = match attribute(head, "header_type") {
        Some("UInt64") => 8,
        _ => 4,
    };
    let whole = |bytes: &[u8], k: usize| -> Result<usize, String> {
        let bytes = bytes.get(k * word..(k + 1) * word).ok_or("the code ends too early")?;
        let value = bytes.iter().rev().fold(0_u64, |value, &b| value << 8 | u64::from(b));
        usize::try_from(value).map_err(|_| "a length is too large".to_owned())
    };
    let code: Vec<u8> = code.bytes().filter(|b| !b.is_ascii_whitespace()).collect();
    let Some(compressor) = attribute(head, "compressor").filter(|c| !c.is_empty()) else {
        let bytes = decode(&code)?;
        let length = whole(&bytes, 0)?;
        let end = word.checked_add(length).ok_or("a length is too large")?;
        return bytes
            .get(word..end)
            .map(<[u8]>::to_vec)
            .ok_or("the code ends too early".to_owned());
    };
    if compressor != "vtkZLibDataCompressor" {
        let found = quote::quoted(compressor, '\'');
        return Err(format!("it is compressed by {found}; expected vtkZLibDataCompressor"));
    }
    let code_length = |bytes: usize| bytes.div_ceil(3) * 4;
    let start = decode(code.get(..code_length(word)).ok_or("the code ends too early")?)?;
    let count = whole(&start, 0)?;
    let header_code = count
        .checked_add(3)
        .and_then(|words| words.checked_mul(word))
        .map(code_length)
        .and_then(|length| code.get(..length))
        .ok_or("the code ends too early")?;
    let header = decode(header_code)?;
    let (full, last) = (whole(&header, 1)?, whole(&header, 2)?);
    let data = decode(&code[header_code.len()..])?;
    let (mut all, mut from) = (Vec::new(), 0_usize);
    for k in 0..count {
        let length = whole(&header, 3 + k)?;
        let end = from.checked_add(length).ok_or("a length is too large")?;
        let block = data.get(from..end).ok_or("the code ends too early")?;
        let size = if k + 1 == count && last > 0 { last } else { full };
        if size > most - all.len() {
            return Err(format!("it is longer than the {most} bytes that its points can have"));
        }
        let plain = decompress_to_vec_zlib_with_limit(block, size)
            .map_err(|e| format!("block {k} can't be decompressed: {e}"))?;
        all.extend(plain);
        from = end;
    }
    Ok(all)
}

/// The bytes of a base64 code (RFC 4648, section 4).
fn decode(code: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(code.len() / 4 * 3);
    let (mut bits, mut held) = (0_u32, 0);
    for &letter in code.iter().take_while(|&&letter| letter != b'=') {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err(format!("'{}' is no letter of base64", char::from(letter))),
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::{Diagonal, Rectangle};
    use crate::io::vtu::{CellKind, Field, Grid, Values, vtu};

    fn mesh() -> Mesh {
        let diagonal = Diagonal::Right;
        Rectangle { width: 1.0, height: 2.0, nx: 3, ny: 2, diagonal }.mesh().unwrap()
    }

    fn field(mesh: &Mesh) -> Vec<[f64; 2]> {
        mesh.vertices().iter().map(|[x, y]| [x - y, 0.1 * x]).collect()
    }

    #[test]
    fn what_this_program_writes_is_read_back_to_the_bit() {
        let mesh = mesh();
        let u = field(&mesh);
        let file = vtu(&Grid {
            kind: CellKind::Triangle,
            points: mesh.vertices(),
            connectivity: mesh.triangles().as_flattened(),
            point_data: &[Field { name: "displacement", values: Values::Vectors(&u) }],
            cell_data: &[],
        });
        let text = String::from_utf8(file.unwrap()).unwrap();
        let triangles = triangles_of(&text).unwrap();
        assert!(!triangles.as_ref().unwrap().quadratic);
        assert_eq!(at_nodes(&from_vtu(&text).unwrap(), &mesh, triangles.as_ref()).unwrap(), u);
    }

    #[test]
    fn a_field_on_other_triangles_with_the_same_points_is_refused() {
        let mesh = mesh();
        let read = |connectivity: &[usize], points: &Points| {
            let places: Vec<[f64; 2]> = points.iter().map(|&(x, _)| x).collect();
            let values: Vec<[f64; 2]> = points.iter().map(|&(_, u)| u).collect();
            let file = vtu(&Grid {
                kind: CellKind::Triangle,
                points: &places,
                connectivity,
                point_data: &[Field { name: "u", values: Values::Vectors(&values) }],
                cell_data: &[],
            });
            let text = String::from_utf8(file.unwrap()).unwrap();
            at_nodes(&from_vtu(&text).unwrap(), &mesh, triangles_of(&text).unwrap().as_ref())
        };
        let points: Points = mesh.vertices().iter().copied().zip(field(&mesh)).collect();
        let own = mesh.triangles().as_flattened();
        assert_eq!(read(own, &points), Ok(field(&mesh)));
        // Turned round, and each with points of its own.
        let turned: Vec<usize> = own.iter().rev().copied().collect();
        assert!(read(&turned, &points).is_ok());
        let apart: Points = own.iter().map(|&k| points[k]).collect();
        assert!(read(&(0..own.len()).collect::<Vec<_>>(), &apart).is_ok());
        let left = Rectangle { width: 1.0, height: 2.0, nx: 3, ny: 2, diagonal: Diagonal::Left };
        let left = left.mesh().unwrap();
        assert_eq!(left.vertices(), mesh.vertices());
        let error = read(left.triangles().as_flattened(), &points).unwrap_err();
        assert!(error.starts_with("its triangle 0 is none of the case's mesh"), "{error}");
        let error = read(&own[3..], &points).unwrap_err();
        assert_eq!(error, "it lacks 1 of the 12 triangles of the case's mesh; expected all");
        let error = read(&[own, &own[..3]].concat(), &points).unwrap_err();
        assert!(error.starts_with("its triangle 12"), "{error}");
    }

    #[test]
    fn cells_that_are_no_triangles_are_refused_but_for_points_and_lines() {
        let cells = |types: &str, offsets: &str| {
            let array = |name: &str, numbers: &str| {
                format!("<DataArray Name=\"{name}\" type=\"Int64\">{numbers}</DataArray>")
            };
            let count = types.split(' ').count();
            triangles_of(&format!(
                "<VTKFile><Piece NumberOfPoints=\"4\" NumberOfCells=\"{count}\"><Cells>{}{}{}</Cells></Piece></VTKFile>",
                array("connectivity", "0 1 0 1 2 2 3 0 9 9 9 9"),
                array("offsets", offsets),
                array("types", types)
            ))
        };
        let found = cells("3 5 69", "2 5 8").unwrap().unwrap();
        assert_eq!((found.corners, found.quadratic), (vec![[0, 1, 2], [2, 3, 0]], false));
        assert!(cells("3", "2").unwrap().is_none());
        for (types, offsets, said) in [
            ("9", "4", "type 9 with 4 points"),
            ("5 22", "3 9", "with three points and with six"),
            ("5 5", "9 12", "type 5 with 9 points"),
            ("3 5", "8 11", "names a point"),
            ("3 5", "10 13", "connectivity lacks"),
            ("3 5", "2", "has others"),
        ] {
            let error = cells(types, offsets).err().unwrap();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn a_field_on_quadratic_triangles_is_read_at_the_middles_of_the_edges_too() {
        let mesh = mesh();
        let space = Space::new(&mesh, Degree::Two);
        let u: Vec<[f64; 2]> = space.nodes().iter().map(|[x, y]| [x * x, 0.3 * x * y]).collect();
        let file = vtu(&Grid {
            kind: CellKind::QuadraticTriangle,
            points: space.nodes(),
            connectivity: space.connectivity(),
            point_data: &[Field { name: "displacement", values: Values::Vectors(&u) }],
            cell_data: &[],
        });
        let text = String::from_utf8(file.unwrap()).unwrap();
        let triangles = triangles_of(&text).unwrap();
        assert!(triangles.as_ref().unwrap().quadratic);
        let mut points = from_vtu(&text).unwrap();
        assert_eq!(at_nodes(&points, &mesh, triangles.as_ref()).unwrap(), u);
        let error = at_nodes(&points, &mesh, None).unwrap_err();
        let middles = mesh.edge_count();
        assert!(error.starts_with(&format!("{middles} of its {} points", u.len())), "{error}");
        // Where the middle of one edge is missing, that is said.
        points.pop();
        let error = at_nodes(&points, &mesh, triangles.as_ref()).unwrap_err();
        assert!(error.contains("at the middle of an edge of the mesh"), "{error}");
    }

    #[test]
    fn a_place_may_come_twice_with_one_value_only() {
        let mesh = mesh();
        let u = field(&mesh);
        let mut points: Points = mesh.vertices().iter().copied().zip(u.iter().copied()).collect();
        points.extend(points.clone());
        assert_eq!(at_nodes(&points, &mesh, None).unwrap(), u);
        let last = points.len() - 1;
        points[last].1[1] += 0.01;
        let error = at_nodes(&points, &mesh, None).unwrap_err();
        let pair = format!("points {} and {last} lie at one vertex", last / 2);
        assert!(error.starts_with(&pair), "{error}");
    }

    #[test]
    fn csv_is_read_in_any_order_of_columns_and_points() {
        let mesh = mesh();
        let u = field(&mesh);
        let mut text = "uy, x, y, ux\n".to_owned();
        for ([x, y], [a, b]) in mesh.vertices().iter().zip(&u).rev() {
            text.push_str(&format!("{b},{x},{y},{a}\n"));
        }
        assert_eq!(at_nodes(&from_csv(&text).unwrap(), &mesh, None).unwrap(), u);
    }

    /// In the layout that meshio writes: text, and zlib with a header of its own code.
    #[test]
    fn text_and_compressed_arrays_are_read() {
        let ascii = r#"<VTKFile type="UnstructuredGrid"><Piece NumberOfPoints="3"><Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0</DataArray></Points>
<PointData><DataArray type="Float64" Name="p" format="ascii">1 2 3</DataArray>
<DataArray type="Float64" Name="u" NumberOfComponents="2" format="ascii">0.5 -2 0 0 1 3</DataArray></PointData></Piece></VTKFile>"#;
        let expected =
            vec![([0.0, 0.0], [0.5, -2.0]), ([1.0, 0.0], [0.0, 0.0]), ([0.0, 1.0], [1.0, 3.0])];
        assert_eq!(from_vtu(ascii).unwrap(), expected);
        let numbers: Vec<u8> =
            [0.5, -2.0, 0.0, 0.0, 1.0, 3.0_f64].iter().flat_map(|x| x.to_le_bytes()).collect();
        let packed = miniz_oxide::deflate::compress_to_vec_zlib(&numbers, 6);
        let header: Vec<u8> =
            [1, 48, 48, packed.len() as u32].iter().flat_map(|n| n.to_le_bytes()).collect();
        let mut code = Vec::new();
        crate::io::vtu::encode(&header, &mut code);
        crate::io::vtu::encode(&packed, &mut code);
        let code = String::from_utf8(code).unwrap();
        let compressed = ascii
            .replace(
                "type=\"UnstructuredGrid\"",
                "header_type=\"UInt32\" compressor=\"vtkZLibDataCompressor\"",
            )
            .replace(
                "Name=\"u\" NumberOfComponents=\"2\" format=\"ascii\">0.5 -2 0 0 1 3",
                &format!("Name=\"u\" NumberOfComponents=\"2\" format=\"binary\">{code}"),
            );
        assert_eq!(from_vtu(&compressed).unwrap(), expected);
    }

    /// A field of one point, (1, 2), whose displacement is this array of this type, in base64.
    fn of_one_point(kind: &str, bytes: &[u8]) -> Result<Points, String> {
        let mut code = Vec::new();
        crate::io::vtu::encode(&[&(bytes.len() as u32).to_le_bytes(), bytes].concat(), &mut code);
        let code = String::from_utf8(code).unwrap();
        from_vtu(&format!(
            "<VTKFile><Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Float64\" \
             NumberOfComponents=\"3\">1 2 0</DataArray></Points><PointData><DataArray Name=\"u\" \
             type=\"{kind}\" NumberOfComponents=\"2\" format=\"binary\">{code}</DataArray>\
             </PointData></Piece></VTKFile>"
        ))
    }

    #[test]
    fn integers_are_read_with_their_sign() {
        let pair = |a: &[u8], b: &[u8]| [a, b].concat();
        for (kind, bytes, expected) in [
            ("Int8", pair(&(-1_i8).to_le_bytes(), &[7]), [-1.0, 7.0]),
            ("UInt8", pair(&[255], &[7]), [255.0, 7.0]),
            ("Int32", pair(&(-1_i32).to_le_bytes(), &7_i32.to_le_bytes()), [-1.0, 7.0]),
            ("UInt32", pair(&u32::MAX.to_le_bytes(), &[7, 0, 0, 0]), [4294967295.0, 7.0]),
            ("Int64", pair(&(-1_i64).to_le_bytes(), &7_i64.to_le_bytes()), [-1.0, 7.0]),
            (
                "UInt64",
                pair(&(1_u64 << 63).to_le_bytes(), &7_u64.to_le_bytes()),
                [2f64.powi(63), 7.0],
            ),
        ] {
            assert_eq!(of_one_point(kind, &bytes), Ok(vec![([1.0, 2.0], expected)]), "{kind}");
        }
        assert!(of_one_point("Float16", &[0; 4]).unwrap_err().contains("has the type 'Float16'"));
    }

    #[test]
    fn compressed_blocks_longer_than_the_points_are_refused_unread() {
        let packed = miniz_oxide::deflate::compress_to_vec_zlib(&vec![0; 1 << 20], 9);
        let file = |points: usize| {
            let words = [1, 1 << 20, 0, packed.len() as u32];
            let header: Vec<u8> = words.iter().flat_map(|n| n.to_le_bytes()).collect();
            let mut code = Vec::new();
            crate::io::vtu::encode(&header, &mut code);
            crate::io::vtu::encode(&packed, &mut code);
            let array = format!(
                "<DataArray type=\"Float64\" NumberOfComponents=\"2\" Name=\"u\" format=\"binary\">{}</DataArray>",
                String::from_utf8(code).unwrap()
            );
            format!(
                "<VTKFile compressor=\"vtkZLibDataCompressor\"><Piece NumberOfPoints=\"{points}\">\
                 <Points>{array}</Points><PointData>{array}</PointData></Piece></VTKFile>"
            )
        };
        let error = from_vtu(&file(9)).unwrap_err();
        assert_eq!(error, "u: it is longer than the 144 bytes that its points can have");
        assert_eq!(from_vtu(&file(1 << 16)).unwrap().len(), 1 << 16, "control: as many as it says");
    }

    #[test]
    fn a_small_body_far_from_the_origin_finds_its_points() {
        let at = |x: f64| 1e5 + x * 2f64.powi(-33);
        let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|x| x.map(at));
        let none: [(String, Vec<[usize; 2]>); 0] = [];
        let mesh = Mesh::new(places.to_vec(), vec![[0, 1, 2], [0, 2, 3]], none).unwrap();
        let points: Points = places.iter().map(|&x| (x, [0.0, -1e-13])).collect();
        assert_eq!(at_nodes(&points, &mesh, None), Ok(vec![[0.0, -1e-13]; 4]));
    }

    #[test]
    fn what_is_missing_is_named() {
        let mesh = mesh();
        let mut points: Points = mesh.vertices().iter().map(|&x| (x, [0.0; 2])).collect();
        points.remove(4);
        let error = at_nodes(&points, &mesh, None).unwrap_err();
        assert!(error.contains("at vertex 4 of the mesh, (0, 1)"), "{error}");
        assert!(from_csv("x,y,u\n").unwrap_err().contains("no column 'ux'"));
        assert!(
            from_csv("x,y,ux,uy\n1,2,a,4\n").unwrap_err().starts_with("line 2: 'a' is no number")
        );
        let long = from_csv(&format!("x,y,ux,uy\n1,2,\u{7}{},4\n", "7x".repeat(99))).unwrap_err();
        assert!(long.len() < 120 && long.contains("'\\u{7}7x7x"), "{long}");
        assert!(from_vtu("<VTKFile>").unwrap_err().contains("<Points>"));
        let one = "type=\"Float64\" NumberOfComponents=\"3\">1 2 0</DataArray>";
        let file = |points: usize| {
            format!(
                "<VTKFile><Piece NumberOfPoints=\"{points}\"><Points><DataArray {one}</Points>\
                 <PointData><DataArray Name=\"u\" {one}</PointData></Piece></VTKFile>"
            )
        };
        assert_eq!(from_vtu(&file(1)).unwrap(), [([1.0, 2.0], [1.0, 2.0])]);
        let error = from_vtu(&file(2)).unwrap_err();
        assert_eq!(error, "it says NumberOfPoints = 2, and points are there: 1");
    }
}
