//! solution.vtu and contact.vtu: unstructured grids for ParaView and everything else that is built on VTK.
//!
//! The numbers stand in the file as base64, which keeps every double as it is and costs no formatting. Compressed by zlib the file
//! would be a fifth smaller, and writing would take as long again; as raw bytes at the end it would be a quarter smaller, but meshio
//! 5.3.5 confuses their offsets.
//! Vectors get a third component 0 and symmetric tensors all six, XX, YY, ZZ, XY, YZ, XZ, because VTK knows space only.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;

use super::files::{NotFinite, check_finite};
use crate::model::Degree;

/// Cells of one kind, with data on their points and on the cells themselves.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a> {
    pub(crate) kind: CellKind,
    pub(crate) points: &'a [[f64; 2]],
    /// The points of one cell after the other, each cell in the order of the elements of [`crate::kernel`].
    pub(crate) connectivity: &'a [usize],
    pub(crate) point_data: &'a [DataArray<'a>],
    pub(crate) cell_data: &'a [DataArray<'a>],
}

/// The kind of the cells of a grid. A quadratic line has its start, its end, its middle.
#[derive(Clone, Copy)]
pub(super) enum CellKind {
    Triangle(Degree),
    Line(Degree),
}

impl CellKind {
    /// VTK's number for this cell, and for each of its nodes in VTK's order the place of the node in our order.
    ///
    /// A quadratic triangle has in VTK, after its corners, the midpoints of the edges 01, 12, 20. Our node 3 + i is the
    /// midpoint of the edge opposite vertex i, so these three are our nodes 5, 3, 4.
    fn vtk(self) -> (u8, &'static [usize]) {
        match self {
            CellKind::Triangle(Degree::One) => (5, &[0, 1, 2]),
            CellKind::Triangle(Degree::Two) => (22, &[0, 1, 2, 5, 3, 4]),
            CellKind::Line(Degree::One) => (3, &[0, 1]),
            CellKind::Line(Degree::Two) => (21, &[0, 1, 2]),
        }
    }
}

/// A value for each point or cell: a number, a vector or a symmetric tensor.
#[derive(Clone, Copy)]
pub(super) struct DataArray<'a> {
    name: &'static str,
    /// The numbers of one value after the other.
    numbers: &'a [f64],
    /// The count of numbers of a value; its further components are 0.
    given: usize,
    /// The names of the components, where there are several.
    components: &'static [&'static str],
}

impl<'a> DataArray<'a> {
    pub(crate) fn scalars(name: &'static str, numbers: &'a [f64]) -> Self {
        DataArray { name, numbers, given: 1, components: &[] }
    }

    pub(crate) fn vectors(name: &'static str, vectors: &'a [[f64; 2]]) -> Self {
        let numbers = vectors.as_flattened();
        DataArray { name, numbers, given: 2, components: &["X", "Y", "Z"] }
    }

    /// Symmetric tensors as `[xx, yy, zz, xy]`.
    pub(crate) fn symmetric_tensors(name: &'static str, tensors: &'a [[f64; 4]]) -> Self {
        let components = &["XX", "YY", "ZZ", "XY", "YZ", "XZ"];
        DataArray { name, numbers: tensors.as_flattened(), given: 4, components }
    }

    /// The bytes of all values.
    fn bytes(&self) -> usize {
        size_of_val(self.numbers) / self.given * self.components.len().max(1)
    }

    fn append_to(&self, data: &mut Vec<u8>) {
        match (self.given, self.components.len()) {
            (2, 3) => append::<2, 3>(self.numbers, data),
            (4, 6) => append::<4, 6>(self.numbers, data),
            _ => append::<1, 1>(self.numbers, data),
        }
    }
}

/// Appends values of G numbers, each with zeros up to C of them.
fn append<const G: usize, const C: usize>(numbers: &[f64], data: &mut Vec<u8>) {
    let (values, start) = (numbers.as_chunks::<G>().0, data.len());
    data.resize(start + values.len() * C * size_of::<f64>(), 0);
    let places = data[start..].as_chunks_mut::<8>().0.as_chunks_mut::<C>().0;
    for (place, value) in places.iter_mut().zip(values) {
        place.iter_mut().zip(value).for_each(|(place, number)| *place = number.to_le_bytes());
    }
}

pub(super) fn vtu(grid: &Grid) -> Result<Vec<u8>, NotFinite> {
    let places = DataArray::vectors("Points", grid.points);
    for array in grid.point_data.iter().chain(grid.cell_data).chain([&places]) {
        check_finite(array.name, array.numbers.chunks(array.given))?;
    }
    let (kind, order) = grid.kind.vtk();
    let (points, cells) = (grid.points.len(), grid.connectivity.len() / order.len());
    let arrays = grid.point_data.iter().chain(grid.cell_data).chain([&places]);
    let bytes: usize = arrays.map(DataArray::bytes).sum();
    let integers = size_of::<usize>() * (grid.connectivity.len() + 2 * cells);
    let mut file = Writer::default();
    // At once: a file that grows is copied from place to place.
    file.bytes.reserve((bytes + integers) / 3 * 4 + (1 << 14));
    file.line("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">");
    file.line(&format!(
        "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"
    ));
    file.data("PointData", grid.point_data);
    file.data("CellData", grid.cell_data);
    file.line("<Points>");
    file.data_array(&places);
    file.line("</Points>\n<Cells>");
    let nodes = grid.connectivity.chunks_exact(order.len());
    file.integers("connectivity", points, nodes.flat_map(|cell| order.iter().map(|&i| cell[i])));
    file.integers("offsets", cells * order.len(), (1..=cells).map(|cell| cell * order.len()));
    file.array("type=\"UInt8\" Name=\"types\"", |data| data.resize(data.len() + cells, kind));
    file.line("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>");
    Ok(file.bytes)
}

/// The file as far as it is written.
#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    /// The array at hand, kept for its memory.
    data: Vec<u8>,
}

impl Writer {
    fn line(&mut self, line: &str) {
        self.bytes.extend_from_slice(line.as_bytes());
        self.bytes.push(b'\n');
    }

    /// An array of the bytes that `append` adds, after their number.
    fn array(&mut self, attributes: &str, append: impl FnOnce(&mut Vec<u8>)) {
        self.line(&format!("<DataArray {attributes} format=\"binary\">"));
        self.data.clear();
        self.data.extend_from_slice(&[0; 8]);
        append(&mut self.data);
        let length = (self.data.len() - 8) as u64;
        self.data[..8].copy_from_slice(&length.to_le_bytes());
        encode(&self.data, &mut self.bytes);
        self.line("\n</DataArray>");
    }

    /// An array of numbers of nodes, in half the bytes where the `largest` allows that.
    fn integers(&mut self, name: &str, largest: usize, numbers: impl Iterator<Item = usize>) {
        let bytes = if i32::try_from(largest).is_ok() { 4 } else { 8 };
        self.array(&format!("type=\"Int{}\" Name=\"{name}\"", 8 * bytes), |data| {
            numbers.for_each(|n| data.extend_from_slice(&(n as u64).to_le_bytes()[..bytes]));
        });
    }

    fn data_array(&mut self, array: &DataArray) {
        let components = array.components;
        let mut attributes = format!("type=\"Float64\" Name=\"{}\"", array.name);
        if !components.is_empty() {
            attributes.push_str(&format!(" NumberOfComponents=\"{}\"", components.len()));
        }
        for (i, name) in components.iter().enumerate() {
            attributes.push_str(&format!(" ComponentName{i}=\"{name}\""));
        }
        self.array(&attributes, |data| array.append_to(data));
    }

    /// The first array of scalars is the one that the file opens with.
    fn data(&mut self, tag: &str, arrays: &[DataArray]) {
        match arrays.iter().find(|array| array.components.is_empty()) {
            Some(array) => self.line(&format!("<{tag} Scalars=\"{}\">", array.name)),
            None => self.line(&format!("<{tag}>")),
        }
        arrays.iter().for_each(|array| self.data_array(array));
        self.line(&format!("</{tag}>"));
    }
}

/// Appends the base64 code of `data`.
fn encode(data: &[u8], to: &mut Vec<u8>) {
    let start = to.len();
    to.resize(start + data.len().div_ceil(3) * 4, b'=');
    // There is room for the code.
    let _ = BASE64.encode_slice(data, &mut to[start..]);
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const POINTS: [[f64; 2]; 6] =
        [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]];
    const NODES: [usize; 6] = [0, 1, 2, 3, 4, 5];
    const DISPLACEMENT: [[f64; 2]; 6] = [[0.5, -0.25]; 6];
    const STRESS: [[f64; 4]; 1] = [[1.0, 2.0, 3.0, 4.0]];

    fn with<R>(f: impl FnOnce(Grid) -> R) -> R {
        f(Grid {
            kind: CellKind::Triangle(Degree::Two),
            points: &POINTS,
            connectivity: &NODES,
            point_data: &[DataArray::vectors("displacement", &DISPLACEMENT)],
            cell_data: &[
                DataArray::symmetric_tensors("stress", &STRESS),
                DataArray::scalars("von_mises", &[5.0]),
            ],
        })
    }

    /// The arrays of a file that this module wrote, by the names of their elements and their own.
    pub(crate) fn arrays(file: &[u8]) -> Vec<([String; 2], Vec<f64>)> {
        let text = std::str::from_utf8(file).unwrap();
        let (mut all, mut element) = (Vec::new(), String::new());
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            let Some(attributes) = line.strip_prefix("<DataArray ") else {
                if !line.starts_with("</") {
                    element = line.trim_matches(['<', '>']).split(' ').next().unwrap().to_owned();
                }
                continue;
            };
            let value = |name: &str| attributes.split(&format!("{name}=\"")).nth(1).unwrap();
            let value = |name: &str| value(name).split('"').next().unwrap();
            let bytes = BASE64.decode(lines.next().unwrap()).unwrap();
            let (length, plain) = bytes.split_first_chunk().unwrap();
            assert_eq!(u64::from_le_bytes(*length), plain.len() as u64);
            let numbers = match value("type") {
                "UInt8" => plain.iter().copied().map(f64::from).collect(),
                "Int32" => {
                    plain.as_chunks().0.iter().map(|n| f64::from(i32::from_le_bytes(*n))).collect()
                }
                _ => plain.as_chunks().0.iter().map(|n| f64::from_le_bytes(*n)).collect(),
            };
            all.push(([element.clone(), value(" Name").to_owned()], numbers));
        }
        all
    }

    /// The description, and the numbers of the arrays in their order.
    fn split(file: &[u8]) -> (String, Vec<Vec<f64>>) {
        let text = std::str::from_utf8(file).unwrap();
        let description: Vec<&str> = text.lines().filter(|line| line.starts_with('<')).collect();
        (description.join("\n"), arrays(file).into_iter().map(|(_, numbers)| numbers).collect())
    }

    #[test]
    fn the_description_names_every_array() {
        let (text, arrays) = split(&with(|grid| vtu(&grid)).unwrap());
        let xyz = r#"ComponentName0="X" ComponentName1="Y" ComponentName2="Z""#;
        let expected = format!(
            r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
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
<DataArray type="Int32" Name="connectivity" format="binary">
</DataArray>
<DataArray type="Int32" Name="offsets" format="binary">
</DataArray>
<DataArray type="UInt8" Name="types" format="binary">
</DataArray>
</Cells>
</Piece>
</UnstructuredGrid>
</VTKFile>"#
        );
        assert_eq!(text, expected);
        assert_eq!(arrays[0], [0.5, -0.25, 0.0].repeat(6));
        assert_eq!(arrays[1], [1.0, 2.0, 3.0, 4.0, 0.0, 0.0]);
        assert_eq!(arrays[2], [5.0]);
    }

    #[test]
    fn midpoints_of_a_quadratic_triangle_lie_between_the_corners_that_vtk_expects() {
        let (_, arrays) = split(&with(|grid| vtu(&grid)).unwrap());
        let (points, nodes) = (&arrays[3], &arrays[4]);
        let place = |node: f64| [points[3 * node as usize], points[3 * node as usize + 1]];
        for (middle, [start, end]) in [(3, [0, 1]), (4, [1, 2]), (5, [2, 0])] {
            let ([a, b], [c, d]) = (place(nodes[start]), place(nodes[end]));
            assert_eq!(place(nodes[middle]), [(a + c) / 2.0, (b + d) / 2.0]);
        }
    }

    #[test]
    fn numbers_of_nodes_beyond_32_bits_are_whole() {
        let large = 1 << 40;
        let mut file = Writer::default();
        file.integers("connectivity", large, [7, large].into_iter());
        let code = BASE64.encode([16, 7, large].map(|n| (n as u64).to_le_bytes()).concat());
        let text = format!(
            "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"binary\">\n{code}\n</DataArray>\n"
        );
        assert_eq!(String::from_utf8(file.bytes).unwrap(), text);
    }

    #[test]
    fn every_kind_has_its_number_and_all_its_nodes() {
        for (kind, number, nodes) in [
            (CellKind::Triangle(Degree::One), 5.0, 3),
            (CellKind::Triangle(Degree::Two), 22.0, 6),
            (CellKind::Line(Degree::One), 3.0, 2),
            (CellKind::Line(Degree::Two), 21.0, 3),
        ] {
            let (_, arrays) = split(&with(|grid| vtu(&Grid { kind, ..grid })).unwrap());
            assert_eq!(arrays[6], vec![number; 6 / nodes]);
            let ends: Vec<f64> = (1..=6 / nodes).map(|cell| (cell * nodes) as f64).collect();
            assert_eq!(arrays[5], ends);
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused_by_name() {
        with(|grid| {
            let stress = [[1.0, 2.0, f64::NAN, 4.0]];
            let stress = [DataArray::symmetric_tensors("stress", &stress)];
            let error = vtu(&Grid { cell_data: &stress, ..grid }).unwrap_err().to_string();
            assert_eq!(error, "stress[0] is NaN or infinite; expected a finite number");
        });
    }
}
