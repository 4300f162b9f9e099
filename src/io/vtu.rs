//! solution.vtu and contact.vtu: unstructured grids for ParaView and everything else that is built on VTK.
//!
//! The numbers stand in the file compressed by zlib, in blocks, as base64, which keeps every double as it is and costs no
//! formatting. (Raw bytes at the end of the file would be a quarter smaller, but meshio 5.3.5 confuses their offsets.)
//! Vectors get a third component 0 and symmetric tensors all six, XX, YY, ZZ, XY, YZ, XZ, because VTK knows space only.

use miniz_oxide::deflate::compress_to_vec_zlib;

use super::data::{DataError, check_finite, check_length, check_points};

/// Cells of one kind, with the fields on their points and on the cells themselves.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// The kind of the cells.
    pub kind: CellKind,
    /// The points.
    pub points: &'a [[f64; 2]],
    /// The points of one cell after the other, each cell in the order of the elements of [`crate::kernel`].
    pub connectivity: &'a [usize],
    /// A value for each point.
    pub point_data: &'a [Field<'a>],
    /// A value for each cell.
    pub cell_data: &'a [Field<'a>],
}

/// The kind of the cells of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// A P1 triangle.
    Triangle,
    /// A P2 triangle.
    QuadraticTriangle,
    /// A P1 edge: start, end.
    Line,
    /// A P2 edge: start, end, middle.
    QuadraticLine,
}

impl CellKind {
    /// VTK's number for this cell, and for each of its nodes in VTK's order the place of the node in our order.
    ///
    /// A quadratic triangle has in VTK, after its corners, the midpoints of the edges 01, 12, 20. Our node 3 + i is the
    /// midpoint of the edge opposite vertex i, so these three are our nodes 5, 3, 4.
    fn vtk(self) -> (u8, &'static [usize]) {
        match self {
            CellKind::Triangle => (5, &[0, 1, 2]),
            CellKind::QuadraticTriangle => (22, &[0, 1, 2, 5, 3, 4]),
            CellKind::Line => (3, &[0, 1]),
            CellKind::QuadraticLine => (21, &[0, 1, 2]),
        }
    }
}

/// A field by name.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// The name that the reader of the file sees.
    pub name: &'static str,
    /// Its values, in the order of the points or cells.
    pub values: Values<'a>,
}

/// The values of a field.
#[derive(Clone, Copy, Debug)]
pub enum Values<'a> {
    /// Numbers.
    Scalars(&'a [f64]),
    /// Vectors in the plane.
    Vectors(&'a [[f64; 2]]),
    /// Symmetric tensors as `[xx, yy, zz, xy]`; the components yz and xz are 0.
    SymmetricTensors(&'a [[f64; 4]]),
}

impl Values<'_> {
    fn len(&self) -> usize {
        match self {
            Values::Scalars(values) => values.len(),
            Values::Vectors(values) => values.len(),
            Values::SymmetricTensors(values) => values.len(),
        }
    }

    fn check_finite(&self, name: &str) -> Result<(), DataError> {
        match self {
            Values::Scalars(values) => check_finite(name, values.chunks(1)),
            Values::Vectors(values) => check_finite(name, values.iter().map(<[f64; 2]>::as_slice)),
            Values::SymmetricTensors(values) => {
                check_finite(name, values.iter().map(<[f64; 4]>::as_slice))
            }
        }
    }

    /// The names of the components, where there are several.
    fn components(&self) -> &'static [&'static str] {
        match self {
            Values::Scalars(_) => &[],
            Values::Vectors(_) => &["X", "Y", "Z"],
            Values::SymmetricTensors(_) => &["XX", "YY", "ZZ", "XY", "YZ", "XZ"],
        }
    }

    fn append_to(&self, data: &mut Vec<u8>) {
        let mut append = |number: f64| data.extend_from_slice(&number.to_le_bytes());
        match self {
            Values::Scalars(values) => values.iter().for_each(|&a| append(a)),
            Values::Vectors(values) => {
                values.iter().for_each(|&[x, y]| [x, y, 0.0].into_iter().for_each(&mut append));
            }
            Values::SymmetricTensors(values) => {
                for &[xx, yy, zz, xy] in *values {
                    [xx, yy, zz, xy, 0.0, 0.0].into_iter().for_each(&mut append);
                }
            }
        }
    }
}

/// The bytes of the file.
///
/// # Errors
/// Fields that are longer or shorter than the grid, cells with points that don't exist, numbers that are not finite.
pub fn vtu(grid: &Grid) -> Result<Vec<u8>, DataError> {
    grid.check()?;
    let (kind, order) = grid.kind.vtk();
    let (points, cells) = (grid.points.len(), grid.connectivity.len() / order.len());
    let mut file = File::default();
    file.line("<?xml version=\"1.0\"?>");
    file.line("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">");
    file.line("<UnstructuredGrid>");
    file.line(&format!("<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"));
    file.fields("PointData", grid.point_data);
    file.fields("CellData", grid.cell_data);
    file.line("<Points>");
    file.field(&Field { name: "Points", values: Values::Vectors(grid.points) });
    file.line("</Points>");
    file.line("<Cells>");
    file.array("type=\"Int64\" Name=\"connectivity\"", |data| {
        for cell in grid.connectivity.chunks_exact(order.len()) {
            order.iter().for_each(|&i| data.extend_from_slice(&(cell[i] as u64).to_le_bytes()));
        }
    });
    file.array("type=\"Int64\" Name=\"offsets\"", |data| {
        for cell in 1..=cells {
            data.extend_from_slice(&((cell * order.len()) as u64).to_le_bytes());
        }
    });
    file.array("type=\"UInt8\" Name=\"types\"", |data| data.resize(data.len() + cells, kind));
    file.line("</Cells>");
    file.line("</Piece>");
    file.line("</UnstructuredGrid>");
    file.line("</VTKFile>");
    Ok(file.bytes)
}

impl Grid<'_> {
    fn check(&self) -> Result<(), DataError> {
        let (_, order) = self.kind.vtk();
        let (points, cells) = (self.points.len(), self.connectivity.len().div_ceil(order.len()));
        check_length("connectivity", self.connectivity.len(), cells * order.len())?;
        check_points("connectivity", self.connectivity, points)?;
        Values::Vectors(self.points).check_finite("points")?;
        for (fields, count) in [(self.point_data, points), (self.cell_data, cells)] {
            for field in fields {
                check_length(field.name, field.values.len(), count)?;
                field.values.check_finite(field.name)?;
            }
        }
        Ok(())
    }
}

/// The bytes of a block before they are compressed.
const BLOCK: usize = 1 << 20;

/// Fast: doubles do not get much smaller by more effort.
const LEVEL: u8 = 1;

/// The file as far as it is written.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    /// The array at hand, kept for its memory.
    data: Vec<u8>,
}

impl File {
    fn line(&mut self, line: &str) {
        self.bytes.extend_from_slice(line.as_bytes());
        self.bytes.push(b'\n');
    }

    /// An array of the bytes that `append` adds: the number of blocks, the size of a block, what is left for the last one (0
    /// if that is whole) and the size of each once compressed; then the blocks.
    fn array(&mut self, attributes: &str, append: impl FnOnce(&mut Vec<u8>)) {
        self.line(&format!("<DataArray {attributes} format=\"binary\">"));
        self.data.clear();
        append(&mut self.data);
        let size = self.data.len().clamp(1, BLOCK);
        let blocks = self.data.chunks(size).map(|block| compress_to_vec_zlib(block, LEVEL));
        let blocks: Vec<Vec<u8>> = blocks.collect();
        let mut header = vec![blocks.len(), size, self.data.len() % size];
        header.extend(blocks.iter().map(Vec::len));
        let bytes = header.into_iter().flat_map(|n| (n as u64).to_le_bytes());
        encode(&bytes.collect::<Vec<u8>>(), &mut self.bytes);
        encode(&blocks.concat(), &mut self.bytes);
        self.line("\n</DataArray>");
    }

    fn field(&mut self, field: &Field) {
        let components = field.values.components();
        let mut attributes = format!("type=\"Float64\" Name=\"{}\"", field.name);
        if !components.is_empty() {
            attributes.push_str(&format!(" NumberOfComponents=\"{}\"", components.len()));
        }
        for (i, name) in components.iter().enumerate() {
            attributes.push_str(&format!(" ComponentName{i}=\"{name}\""));
        }
        self.array(&attributes, |data| field.values.append_to(data));
    }

    /// The first field of scalars is the one that the file opens with.
    fn fields(&mut self, tag: &str, fields: &[Field]) {
        let first = fields.iter().find(|field| matches!(field.values, Values::Scalars(_)));
        match first {
            Some(field) => self.line(&format!("<{tag} Scalars=\"{}\">", field.name)),
            None => self.line(&format!("<{tag}>")),
        }
        fields.iter().for_each(|field| self.field(field));
        self.line(&format!("</{tag}>"));
    }
}

/// Appends the base64 code (RFC 4648, section 4) of `data`.
pub(super) fn encode(data: &[u8], to: &mut Vec<u8>) {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let letters = |[a, b, c]: [u8; 3]| {
        let bits = u32::from_be_bytes([0, a, b, c]);
        [18, 12, 6, 0].map(|shift| ALPHABET[(bits >> shift & 63) as usize])
    };
    to.reserve(data.len().div_ceil(3) * 4);
    let (triples, rest) = data.as_chunks();
    for &triple in triples {
        to.extend_from_slice(&letters(triple));
    }
    match *rest {
        [a] => {
            to.extend_from_slice(&letters([a, 0, 0])[..2]);
            to.extend_from_slice(b"==");
        }
        [a, b] => {
            to.extend_from_slice(&letters([a, b, 0])[..3]);
            to.push(b'=');
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Element, P2};

    const POINTS: [[f64; 2]; 6] =
        [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]];
    const NODES: [usize; 6] = [0, 1, 2, 3, 4, 5];
    const DISPLACEMENT: [[f64; 2]; 6] = [[0.5, -0.25]; 6];
    const STRESS: [[f64; 4]; 1] = [[1.0, 2.0, 3.0, 4.0]];

    fn with<R>(f: impl FnOnce(Grid) -> R) -> R {
        f(Grid {
            kind: CellKind::QuadraticTriangle,
            points: &POINTS,
            connectivity: &NODES,
            point_data: &[Field { name: "displacement", values: Values::Vectors(&DISPLACEMENT) }],
            cell_data: &[
                Field { name: "stress", values: Values::SymmetricTensors(&STRESS) },
                Field { name: "von_mises", values: Values::Scalars(&[5.0]) },
            ],
        })
    }

    /// The description, and the arrays in their order.
    fn split(file: &[u8]) -> (String, Vec<Vec<u8>>) {
        let is_array = |line: &&str| !line.starts_with('<');
        let text = std::str::from_utf8(file).unwrap();
        let description =
            text.lines().filter(|line| !is_array(line)).collect::<Vec<_>>().join("\n");
        let array = |line: &str| {
            let count = integers(&decode(&line[..12]))[0] as usize;
            let (header, data) = line.split_at(((3 + count) * 8).div_ceil(3) * 4);
            let (header, mut data) = (integers(&decode(header)), decode(data));
            let mut plain = Vec::new();
            for (i, &size) in header[3..].iter().enumerate() {
                let rest = data.split_off(size as usize);
                let block = miniz_oxide::inflate::decompress_to_vec_zlib(&data).unwrap();
                let last = i + 1 == count && header[2] != 0;
                assert_eq!(block.len() as i64, header[if last { 2 } else { 1 }]);
                plain.extend(block);
                data = rest;
            }
            assert!(data.is_empty());
            plain
        };
        (description, text.lines().filter(is_array).map(array).collect())
    }

    /// The bytes of a base64 code, bit by bit.
    fn decode(code: &str) -> Vec<u8> {
        let digit = |letter: u8| match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => panic!("{letter}"),
        };
        assert_eq!(code.len() % 4, 0);
        let digits: Vec<u8> = code.trim_end_matches('=').bytes().map(digit).collect();
        let bit = |i: usize| digits[i / 6] >> (5 - i % 6) & 1;
        let byte = |i: usize| (0..8).fold(0, |byte, j| 2 * byte + bit(8 * i + j));
        (0..digits.len() * 6 / 8).map(byte).collect()
    }

    #[test]
    fn base64_is_that_of_rfc_4648() {
        for (text, expected) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            let mut code = Vec::new();
            encode(text.as_bytes(), &mut code);
            assert_eq!(code, expected.as_bytes());
        }
        let all: Vec<u8> = (0..=255).collect();
        let mut code = Vec::new();
        encode(&all, &mut code);
        assert_eq!(decode(&String::from_utf8(code).unwrap()), all);
    }

    fn numbers(bytes: &[u8]) -> Vec<f64> {
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    fn integers(bytes: &[u8]) -> Vec<i64> {
        bytes.chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    #[test]
    fn the_description_names_every_array() {
        let (text, arrays) = split(&with(|grid| vtu(&grid)).unwrap());
        let xyz = r#"ComponentName0="X" ComponentName1="Y" ComponentName2="Z""#;
        let expected = format!(
            r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
<UnstructuredGrid>
<Piece NumberOfPoints="6" NumberOfCells="1">
<PointData>
<DataArray type="Float64" Name="displacement" NumberOfComponents="3" {xyz} format="binary">
</DataArray>
</PointData>
<CellData Scalars="von_mises">
<DataArray type="Float64" Name="stress" NumberOfComponents="6" ComponentName0="XX" ComponentName1="YY" ComponentName2="ZZ" ComponentName3="XY" ComponentName4="YZ" ComponentName5="XZ" format="binary">
</DataArray>
<DataArray type="Float64" Name="von_mises" format="binary">
</DataArray>
</CellData>
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" {xyz} format="binary">
</DataArray>
</Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="binary">
</DataArray>
<DataArray type="Int64" Name="offsets" format="binary">
</DataArray>
<DataArray type="UInt8" Name="types" format="binary">
</DataArray>
</Cells>
</Piece>
</UnstructuredGrid>
</VTKFile>"#
        );
        assert_eq!(text, expected);
        assert_eq!(numbers(&arrays[0]), [0.5, -0.25, 0.0].repeat(6));
        assert_eq!(numbers(&arrays[1]), [1.0, 2.0, 3.0, 4.0, 0.0, 0.0]);
        assert_eq!(numbers(&arrays[2]), [5.0]);
        assert_eq!(integers(&arrays[5]), [6]);
        assert_eq!(arrays[6], [22]);
    }

    #[test]
    fn midpoints_of_a_quadratic_triangle_lie_between_the_corners_that_vtk_expects() {
        let (_, arrays) = split(&with(|grid| vtu(&grid)).unwrap());
        let points = numbers(&arrays[3]);
        let place = |node: i64| [points[3 * node as usize], points[3 * node as usize + 1]];
        let nodes = integers(&arrays[4]);
        for (middle, [start, end]) in [(3, [0, 1]), (4, [1, 2]), (5, [2, 0])] {
            let ([a, b], [c, d]) = (place(nodes[start]), place(nodes[end]));
            assert_eq!(place(nodes[middle]), [(a + c) / 2.0, (b + d) / 2.0]);
        }
    }

    #[test]
    fn the_order_of_a_quadratic_triangle_follows_from_the_element() {
        let (_, order) = CellKind::QuadraticTriangle.vtk();
        for (place, [start, end]) in [(3, [0, 1]), (4, [1, 2]), (5, [2, 0])] {
            let edge = (0..3).map(P2::edge_nodes).find(|&[a, b, _]| [a, b] == [start, end]);
            assert_eq!(edge.map(|[_, _, middle]| middle), Some(order[place]));
        }
    }

    #[test]
    fn arrays_of_several_blocks_are_whole() {
        let points: Vec<[f64; 2]> = (0..100_000).map(|i| [f64::from(i), 0.5]).collect();
        let connectivity: Vec<usize> = (0..100_000 - 1).flat_map(|i| [i, i + 1]).collect();
        let grid = Grid {
            kind: CellKind::Line,
            points: &points,
            connectivity: &connectivity,
            point_data: &[],
            cell_data: &[],
        };
        let file = vtu(&grid).unwrap();
        let (_, arrays) = split(&file);
        let expected = points.iter().flat_map(|&[x, y]| [x, y, 0.0]);
        assert!(arrays[0].len() > 2 * BLOCK && numbers(&arrays[0]).into_iter().eq(expected));
        assert!(file.len() < 2_000_000, "{}", file.len());
    }

    #[test]
    fn every_kind_has_its_number_and_all_its_nodes() {
        for (kind, number, nodes) in [
            (CellKind::Triangle, 5, 3),
            (CellKind::QuadraticTriangle, 22, 6),
            (CellKind::Line, 3, 2),
            (CellKind::QuadraticLine, 21, 3),
        ] {
            let grid = Grid {
                kind,
                points: &POINTS,
                connectivity: &NODES,
                point_data: &[],
                cell_data: &[],
            };
            let (_, arrays) = split(&vtu(&grid).unwrap());
            assert_eq!(arrays[3], vec![number; 6 / nodes]);
            let ends: Vec<i64> = (1..=6 / nodes).map(|cell| (cell * nodes) as i64).collect();
            assert_eq!(integers(&arrays[2]), ends);
        }
    }

    #[test]
    fn data_that_do_not_fit_are_refused_by_name() {
        let message = |grid: Grid| vtu(&grid).unwrap_err().to_string();
        with(|grid| {
            let short = [Field { name: "u_n", values: Values::Scalars(&[1.0; 5]) }];
            assert_eq!(
                message(Grid { point_data: &short, ..grid }),
                "u_n has 5 entries; expected 6"
            );
            let nan = [[1.0, 2.0, f64::NAN, 4.0]];
            let nan = [Field { name: "stress", values: Values::SymmetricTensors(&nan) }];
            assert_eq!(
                message(Grid { cell_data: &nan, ..grid }),
                "stress[0] is NaN or infinite; expected a finite number"
            );
            assert_eq!(
                message(Grid { connectivity: &[0, 1, 2, 3, 4, 6], ..grid }),
                "connectivity names point 6; expected one of the 6 points"
            );
            assert_eq!(
                message(Grid { connectivity: &NODES[..4], ..grid }),
                "connectivity has 4 entries; expected 6"
            );
        });
    }
}
