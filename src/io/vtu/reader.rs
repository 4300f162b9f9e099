//! A displacement on the points of a VTU file, and the triangles between them.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use flate2::read::ZlibDecoder;

use crate::memory;
use crate::quote;

/// The most points of a cell of VTK's, of degree 2.
const POINTS_OF_A_CELL: usize = 27;

/// The triangles of a VTU file.
#[derive(Debug, PartialEq)]
pub(in crate::io) struct Triangles {
    /// Their corners by the points of the file.
    pub corners: Vec<[usize; 3]>,
    /// The triangles have a point in the middle of each side, too.
    pub quadratic: bool,
}

/// Places with the displacement there.
pub(in crate::io) type Points = Vec<([f64; 2], [f64; 2])>;

/// The displacement at the points, and the triangles if the file has cells.
pub(in crate::io) fn from_vtu(text: &str) -> Result<(Points, Option<Triangles>), String> {
    let file = Reader::new(text)?;
    Ok((file.points()?, file.triangles()?))
}

/// The text of a file, and the tags of two of its elements.
pub(super) struct Reader<'a> {
    text: &'a str,
    head: &'a str,
    piece: &'a str,
}

impl<'a> Reader<'a> {
    pub(super) fn new(text: &'a str) -> Result<Self, String> {
        let head =
            tag(text, "VTKFile").ok_or("it has no element <VTKFile>; expected a VTU file")?;
        if text.matches("<Piece").count() > 1 {
            return Err("it has several pieces; expected one".to_owned());
        }
        Ok(Reader { text, head, piece: tag(text, "Piece").unwrap_or_default() })
    }

    /// The attribute `name` of the piece, `NumberOfPoints` or `NumberOfCells`.
    fn count(&self, name: &str) -> Option<usize> {
        attribute(self.piece, name)?.trim().parse().ok()
    }

    /// The arrays of the element `name`.
    pub(super) fn arrays(&self, name: &str) -> Vec<ArrayText<'a>> {
        let Some(from) = self.text.find(&format!("<{name}")) else { return Vec::new() };
        let Some((section, _)) = self.text[from..].split_once(&format!("</{name}>")) else {
            return Vec::new();
        };
        let array = |part: &'a str| {
            let (attributes, rest) = part.split_once('>')?;
            // An empty array closes itself.
            let is_empty = attributes.ends_with('/');
            let text = if is_empty { "" } else { rest.split("</DataArray").next()? };
            Some(ArrayText { attributes, text: text.trim() })
        };
        section.split("<DataArray").skip(1).filter_map(array).collect()
    }

    fn points(&self) -> Result<Points, String> {
        let places = self.arrays("Points");
        let places = places.first().ok_or("it has no <Points>")?;
        let mut vectors = self.arrays("PointData");
        vectors.retain(|array| (2..=3).contains(&array.components()));
        let is_named = |array: &&ArrayText| matches!(array.name(), Some("displacement" | "u"));
        let field = match (vectors.iter().find(is_named), vectors.as_slice()) {
            (Some(field), _) | (None, [field]) => field,
            _ => {
                let names = quote::names(vectors.iter().filter_map(ArrayText::name));
                return Err(format!(
                    "its vectors on points are [{names}]; expected one called displacement or u, or just one"
                ));
            }
        };
        let (dim, components) = (places.components().max(2), field.components());
        let said = self.count("NumberOfPoints").ok_or("its <Piece> has no NumberOfPoints")?;
        let (x, u) = (self.numbers(places, said)?, self.numbers(field, said)?);
        let count = x.len() / dim;
        if count != u.len() / components || x.len() % dim != 0 {
            let (x, u) = (x.len(), u.len());
            return Err(format!("{x} coordinates and {u} components of vectors don't fit"));
        }
        if said != count {
            return Err(format!("it says NumberOfPoints = {said}, and points are there: {count}"));
        }
        let pairs = x.chunks_exact(dim).zip(u.chunks_exact(components));
        Ok(pairs.map(|(x, u)| ([x[0], x[1]], [u[0], u[1]])).collect())
    }

    /// The triangles, if there are cells; points and lines may be among them.
    fn triangles(&self) -> Result<Option<Triangles>, String> {
        let cells = self.arrays("Cells");
        let named = |name: &str| cells.iter().find(|array| array.name() == Some(name));
        let (Some(count), Some(types), Some(offsets), Some(connectivity)) =
            (self.count("NumberOfCells"), named("types"), named("offsets"), named("connectivity"))
        else {
            return Ok(None);
        };
        let points = self.count("NumberOfPoints").unwrap_or(0);
        let (types, offsets) = (self.numbers(types, count)?, self.numbers(offsets, count)?);
        let connectivity = self.numbers(connectivity, count.saturating_mul(POINTS_OF_A_CELL))?;
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
                let said = "it has triangles with three points and with six; expected one kind";
                return Err(said.to_owned());
            }
            triangles.quadratic = quadratic;
            let corners = connectivity.get(from..).and_then(|rest| rest.first_chunk::<3>());
            let Some(corners) = corners.map(|corners| corners.map(|point| point as usize)) else {
                return Err(format!("its cell {k} has points that its connectivity lacks"));
            };
            if corners.iter().any(|&point| point >= points) {
                return Err(format!("its cell {k} names a point that it does not have"));
            }
            triangles.corners.push(corners);
        }
        Ok((!triangles.corners.is_empty()).then_some(triangles))
    }

    /// The numbers of an array, the components of `count` points or cells.
    pub(super) fn numbers(&self, array: &ArrayText, count: usize) -> Result<Vec<f64>, String> {
        let name = quote::cut(array.name().unwrap_or("Points"));
        match attribute(array.attributes, "format") {
            Some("ascii") | None => {
                let number = |word: &str| {
                    let wrong = |_| format!("{name}: {} is no number", quote::quoted(word, '\''));
                    word.parse().map_err(wrong)
                };
                array.text.split_whitespace().map(number).collect()
            }
            Some("binary") => {
                // No number has more bytes than a double. As bytes, as code and as doubles at a time.
                let most = count.saturating_mul(8).saturating_mul(array.components());
                memory::check((most as u64).saturating_mul(3))
                    .map_err(|lack| format!("{name}: {lack}"))?;
                let bytes =
                    self.bytes(array.text, most).map_err(|problem| format!("{name}: {problem}"))?;
                if attribute(self.head, "byte_order").is_some_and(|order| order != "LittleEndian") {
                    return Err("its byte order is not LittleEndian".to_owned());
                }
                let kind = attribute(array.attributes, "type").unwrap_or_default();
                doubles(&bytes, kind).ok_or_else(|| {
                    let kind = quote::quoted(kind, '\'');
                    format!("{name} has the type {kind}; expected Float64 or Float32")
                })
            }
            Some(other) => {
                let other = quote::quoted(other, '\'');
                Err(format!("{name} has the format {other}; expected ascii or binary"))
            }
        }
    }

    /// The bytes of a base64 array: its length, then the data; or, compressed, the number of blocks, their size, the size of the
    /// last one, their compressed sizes, and in a code of its own the blocks. All together are at most `most` bytes.
    fn bytes(&self, code: &str, most: usize) -> Result<Vec<u8>, String> {
        const EARLY: &str = "the code ends too early";
        const LARGE: &str = "a length is too large";
        let word = if attribute(self.head, "header_type") == Some("UInt64") { 8 } else { 4 };
        let whole = |bytes: &[u8], k: usize| -> Result<usize, String> {
            let bytes = bytes.get(k * word..(k + 1) * word).ok_or(EARLY)?;
            let value = bytes.iter().rev().fold(0_u64, |value, &b| value << 8 | u64::from(b));
            usize::try_from(value).map_err(|_| LARGE.to_owned())
        };
        let code: Vec<u8> = code.bytes().filter(|b| !b.is_ascii_whitespace()).collect();
        let Some(compressor) = attribute(self.head, "compressor").filter(|c| !c.is_empty()) else {
            let bytes = decode(&code)?;
            let end = word.checked_add(whole(&bytes, 0)?).ok_or(LARGE)?;
            return Ok(bytes.get(word..end).ok_or(EARLY)?.to_vec());
        };
        if compressor != "vtkZLibDataCompressor" {
            let found = quote::quoted(compressor, '\'');
            return Err(format!("it is compressed by {found}; expected vtkZLibDataCompressor"));
        }
        let code_length = |words: usize| words.checked_mul(word).map(|n| n.div_ceil(3) * 4);
        let split = |words: usize| code_length(words).and_then(|end| code.split_at_checked(end));
        let (start, _) = split(1).ok_or(EARLY)?;
        let count = whole(&decode(start)?, 0)?;
        let (header, data) = count.checked_add(3).and_then(split).ok_or(EARLY)?;
        let (header, data) = (decode(header)?, decode(data)?);
        let (full, last) = (whole(&header, 1)?, whole(&header, 2)?);
        let (mut all, mut from) = (Vec::new(), 0_usize);
        for k in 0..count {
            let end = from.checked_add(whole(&header, 3 + k)?).ok_or(LARGE)?;
            let block = data.get(from..end).ok_or(EARLY)?;
            let size = if k + 1 == count && last > 0 { last } else { full };
            if size > most - all.len() {
                return Err(format!("it is longer than the {most} bytes that its points can have"));
            }
            let mut plain = ZlibDecoder::new(block).take(size as u64);
            plain
                .read_to_end(&mut all)
                .map_err(|e| format!("block {k} can't be decompressed: {e}"))?;
            from = end;
        }
        Ok(all)
    }
}

/// The tag of the first element `name`, without its angle brackets.
fn tag<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    text[text.find(&format!("<{name}"))? + 1..].split('>').next()
}

/// The value of an attribute in a tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let mut rest = tag;
    loop {
        let (before, behind) = rest.split_once('=')?;
        let behind = behind.trim_start();
        let mark = ['"', '\''].into_iter().find(|&mark| behind.starts_with(mark))?;
        let (value, next) = behind[1..].split_once(mark)?;
        if before.split_whitespace().next_back() == Some(name) {
            return Some(value);
        }
        rest = next;
    }
}

/// One array of a file: its attributes and its text.
pub(super) struct ArrayText<'a> {
    attributes: &'a str,
    text: &'a str,
}

impl<'a> ArrayText<'a> {
    fn name(&self) -> Option<&'a str> {
        attribute(self.attributes, "Name")
    }

    fn components(&self) -> usize {
        let components = attribute(self.attributes, "NumberOfComponents");
        components.and_then(|n| n.parse().ok()).unwrap_or(1)
    }
}

/// The little-endian numbers in `bytes` of one of VTK's types, as doubles.
fn doubles(bytes: &[u8], kind: &str) -> Option<Vec<f64>> {
    fn each<const N: usize>(bytes: &[u8], number: fn([u8; N]) -> f64) -> Vec<f64> {
        bytes.as_chunks().0.iter().map(|&bytes| number(bytes)).collect()
    }
    Some(match kind {
        "Float64" => each(bytes, f64::from_le_bytes),
        "Float32" => each(bytes, |b| f32::from_le_bytes(b).into()),
        "UInt8" => each(bytes, |b| u8::from_le_bytes(b).into()),
        "Int8" => each(bytes, |b| i8::from_le_bytes(b).into()),
        "UInt32" => each(bytes, |b| u32::from_le_bytes(b).into()),
        "Int32" => each(bytes, |b| i32::from_le_bytes(b).into()),
        "UInt64" => each(bytes, |b| u64::from_le_bytes(b) as f64),
        "Int64" => each(bytes, |b| i64::from_le_bytes(b) as f64),
        _ => return None,
    })
}

/// The bytes of a base64 code.
fn decode(code: &[u8]) -> Result<Vec<u8>, String> {
    BASE64.decode(code).map_err(|e| format!("it is no base64: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::vtu::encode;

    fn base64(parts: &[&[u8]]) -> String {
        let mut code = Vec::new();
        parts.iter().for_each(|part| encode(part, &mut code));
        String::from_utf8(code).unwrap()
    }

    /// A file of `points` points: their places, and a displacement, as arrays with these attributes and this text.
    fn file(head: &str, points: usize, [places, field]: [[&str; 2]; 2]) -> String {
        let array = |name: &str, [attributes, text]: [&str; 2]| {
            format!("<DataArray Name=\"{name}\" type=\"Float64\" {attributes}>{text}</DataArray>")
        };
        format!(
            "<VTKFile {head}><Piece NumberOfPoints=\"{points}\"><Points>{}</Points><PointData>{}{}\
             </PointData></Piece></VTKFile>",
            array("Points", places),
            array("p", ["", "1 2 3"]),
            array("u", field)
        )
    }

    const ZLIB: &str = "compressor=\"vtkZLibDataCompressor\"";
    const IN_THE_PLANE: &str = "NumberOfComponents=\"2\" format=\"binary\"";

    #[test]
    fn text_and_compressed_arrays_are_read() {
        let places = ["NumberOfComponents=\"3\" format=\"ascii\"", "0 0 0 1 0 0 0 1 0"];
        let expected =
            vec![([0.0, 0.0], [0.5, -2.0]), ([1.0, 0.0], [0.0, 0.0]), ([0.0, 1.0], [1.0, 3.0])];
        let ascii = ["NumberOfComponents=\"2\" format=\"ascii\"", "0.5 -2 0 0 1 3"];
        assert_eq!(from_vtu(&file("", 3, [places, ascii])), Ok((expected.clone(), None)));
        let numbers: Vec<u8> =
            [0.5, -2.0, 0.0, 0.0, 1.0, 3.0_f64].iter().flat_map(|x| x.to_le_bytes()).collect();
        let packed = super::super::compressed(&numbers);
        let header: Vec<u8> =
            [1, 48, 48, packed.len() as u32].iter().flat_map(|n| n.to_le_bytes()).collect();
        // In the layout that meshio writes: the header in a code of its own.
        let compressed = [IN_THE_PLANE, &base64(&[&header, &packed])];
        let head = format!("header_type=\"UInt32\" {ZLIB}");
        assert_eq!(from_vtu(&file(&head, 3, [places, compressed])), Ok((expected, None)));
    }

    #[test]
    fn integers_are_read_with_their_sign() {
        for (kind, bytes, expected) in [
            ("Int8", vec![255], -1.0),
            ("UInt8", vec![255], 255.0),
            ("Int32", (-1_i32).to_le_bytes().to_vec(), -1.0),
            ("UInt32", u32::MAX.to_le_bytes().to_vec(), 4294967295.0),
            ("Int64", (-1_i64).to_le_bytes().to_vec(), -1.0),
            ("UInt64", (1_u64 << 63).to_le_bytes().to_vec(), 2f64.powi(63)),
        ] {
            assert_eq!(doubles(&bytes, kind), Some(vec![expected]), "{kind}");
        }
        let field = [IN_THE_PLANE, &base64(&[&[4, 0, 0, 0, 0, 0, 0, 0]])];
        let text = file("", 1, [["NumberOfComponents=\"2\"", "1 2"], field]);
        let text = text.replace("\"u\" type=\"Float64\"", "\"u\" type=\"Float16\"");
        let error = from_vtu(&text).unwrap_err();
        assert_eq!(error, "u has the type 'Float16'; expected Float64 or Float32");
    }

    #[test]
    fn compressed_blocks_longer_than_the_points_are_refused_unread() {
        let packed = super::super::compressed(&vec![0; 1 << 20]);
        let words = [1, 1 << 20, 0, packed.len() as u32];
        let header: Vec<u8> = words.iter().flat_map(|n| n.to_le_bytes()).collect();
        let array = [IN_THE_PLANE, &base64(&[&header, &packed])];
        let error = from_vtu(&file(ZLIB, 9, [array; 2])).unwrap_err();
        assert_eq!(error, "Points: it is longer than the 144 bytes that its points can have");
        // Three times the bytes of so many points are 32 beyond the largest number.
        let error = from_vtu(&file(ZLIB, 384_307_168_202_282_326, [array; 2])).unwrap_err();
        assert!(error.starts_with("Points: this needs 18446744073709551615 bytes"), "{error}");
        let points = from_vtu(&file(ZLIB, 1 << 16, [array; 2])).unwrap().0;
        assert_eq!(points.len(), 1 << 16, "control: as many as it says");
    }

    #[test]
    fn cells_that_are_no_triangles_are_refused_but_for_points_and_lines() {
        let cells = |types: &str, offsets: &str| {
            let array = |name: &str, numbers: &str| {
                format!("<DataArray Name=\"{name}\" type=\"Int64\">{numbers}</DataArray>")
            };
            let arrays = [
                array("connectivity", "0 1 0 1 2 2 3 0 9 9 9 9"),
                array("offsets", offsets),
                array("types", types),
            ]
            .concat();
            let count = types.split(' ').count();
            let piece = format!("Piece NumberOfPoints=\"4\" NumberOfCells=\"{count}\"");
            let text = format!("<Cells>{arrays}</Cells>");
            Reader { text: &text, head: "", piece: &piece }.triangles()
        };
        let corners = vec![[0, 1, 2], [2, 3, 0]];
        assert_eq!(cells("3 5 69", "2 5 8"), Ok(Some(Triangles { corners, quadratic: false })));
        assert_eq!(cells("3", "2"), Ok(None));
        for (types, offsets, said) in [
            ("9", "4", "type 9 with 4 points"),
            ("5 22", "3 9", "with three points and with six"),
            ("5 5", "9 12", "type 5 with 9 points"),
            ("3 5", "8 11", "names a point"),
            ("3 5", "10 13", "connectivity lacks"),
            ("3 5", "2", "has others"),
        ] {
            let error = cells(types, offsets).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn what_is_missing_is_named() {
        assert!(from_vtu("<VTKFile>").unwrap_err().contains("<Points>"));
        let place = ["NumberOfComponents=\"3\"", "1 2 0"];
        assert_eq!(from_vtu(&file("", 1, [place; 2])), Ok((vec![([1.0, 2.0], [1.0, 2.0])], None)));
        let error = from_vtu(&file("", 2, [place; 2])).unwrap_err();
        assert_eq!(error, "it says NumberOfPoints = 2, and points are there: 1");
    }
}
