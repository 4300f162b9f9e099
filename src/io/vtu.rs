//! solution.vtu and contact.vtu: unstructured grids for ParaView and everything else that is built on VTK.
//!
//! The numbers are appended as raw bytes, which keeps every double as it is and costs no formatting. Vectors get a third
//! component 0 and symmetric tensors all six, XX, YY, ZZ, XY, YZ, XZ, because VTK knows space only.

use std::fmt::Write;

use super::data::{DataError, check_finite, check_length, check_points};

/// Cells of one kind, with the fields on their points and on the cells themselves.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// What the cells are.
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

/// What the cells of a grid are.
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
    let mut file = Parts::default();
    file.xml.push_str("<?xml version=\"1.0\"?>\n");
    file.xml.push_str("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n");
    file.xml.push_str("<UnstructuredGrid>\n");
    file.line(format_args!("<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"));
    file.fields("PointData", grid.point_data);
    file.fields("CellData", grid.cell_data);
    file.line(format_args!("<Points>"));
    file.field(&Field { name: "Points", values: Values::Vectors(grid.points) });
    file.line(format_args!("</Points>"));
    file.line(format_args!("<Cells>"));
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
    file.line(format_args!("</Cells>"));
    file.xml.push_str("</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
    let mut bytes = file.xml.into_bytes();
    bytes.extend_from_slice(&file.data);
    bytes.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
    Ok(bytes)
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

/// The two parts of the file: the description, and the bytes of the arrays that it refers to by their offsets.
#[derive(Default)]
struct Parts {
    xml: String,
    data: Vec<u8>,
}

impl Parts {
    fn line(&mut self, line: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.xml, "{line}");
    }

    /// An array: its length in bytes, then the bytes that `append` adds.
    fn array(&mut self, attributes: &str, append: impl FnOnce(&mut Vec<u8>)) {
        let start = self.data.len();
        self.line(format_args!("<DataArray {attributes} format=\"appended\" offset=\"{start}\"/>"));
        self.data.extend_from_slice(&[0; 8]);
        append(&mut self.data);
        let length = (self.data.len() - start - 8) as u64;
        self.data[start..start + 8].copy_from_slice(&length.to_le_bytes());
    }

    fn field(&mut self, field: &Field) {
        let components = field.values.components();
        let mut attributes = format!(
            "type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\"",
            field.name,
            components.len().max(1)
        );
        for (i, name) in components.iter().enumerate() {
            let _ = write!(attributes, " ComponentName{i}=\"{name}\"");
        }
        self.array(&attributes, |data| field.values.append_to(data));
    }

    /// The first field of scalars is the one that the file opens with.
    fn fields(&mut self, tag: &str, fields: &[Field]) {
        let first = fields.iter().find(|field| matches!(field.values, Values::Scalars(_)));
        match first {
            Some(field) => self.line(format_args!("<{tag} Scalars=\"{}\">", field.name)),
            None => self.line(format_args!("<{tag}>")),
        }
        fields.iter().for_each(|field| self.field(field));
        self.line(format_args!("</{tag}>"));
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

    /// The description, and the arrays that it refers to, in the order of their offsets.
    fn split(file: &[u8]) -> (String, Vec<Vec<u8>>) {
        let start = file.iter().position(|&byte| byte == b'_').unwrap();
        let start = start + file[start..].windows(2).position(|w| w == b"\n_").unwrap() + 2;
        let end = file.len() - b"\n</AppendedData>\n</VTKFile>\n".len();
        let text = String::from_utf8(file[..start].to_vec()).unwrap();
        let data = &file[start..end];
        let mut arrays = Vec::new();
        let mut at = 0;
        while at < data.len() {
            assert!(text.contains(&format!("offset=\"{at}\"/>")), "no array at {at}");
            let length = u64::from_le_bytes(data[at..at + 8].try_into().unwrap()) as usize;
            arrays.push(data[at + 8..at + 8 + length].to_vec());
            at += 8 + length;
        }
        assert_eq!(text.matches("<DataArray").count(), arrays.len());
        (text, arrays)
    }

    fn numbers(bytes: &[u8]) -> Vec<f64> {
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    fn integers(bytes: &[u8]) -> Vec<i64> {
        bytes.chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    #[test]
    fn the_description_names_every_array_with_its_place() {
        let (text, arrays) = split(&with(|grid| vtu(&grid)).unwrap());
        let xyz = r#"ComponentName0="X" ComponentName1="Y" ComponentName2="Z""#;
        let expected = format!(
            r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<UnstructuredGrid>
<Piece NumberOfPoints="6" NumberOfCells="1">
<PointData>
<DataArray type="Float64" Name="displacement" NumberOfComponents="3" {xyz} format="appended" offset="0"/>
</PointData>
<CellData Scalars="von_mises">
<DataArray type="Float64" Name="stress" NumberOfComponents="6" ComponentName0="XX" ComponentName1="YY" ComponentName2="ZZ" ComponentName3="XY" ComponentName4="YZ" ComponentName5="XZ" format="appended" offset="152"/>
<DataArray type="Float64" Name="von_mises" NumberOfComponents="1" format="appended" offset="208"/>
</CellData>
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" {xyz} format="appended" offset="224"/>
</Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="appended" offset="376"/>
<DataArray type="Int64" Name="offsets" format="appended" offset="432"/>
<DataArray type="UInt8" Name="types" format="appended" offset="448"/>
</Cells>
</Piece>
</UnstructuredGrid>
<AppendedData encoding="raw">
_"#
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
