//! The fields of a solution for other programs: solution.vtu, contact.vtu and contact.csv.

use std::path::{Path, PathBuf};

use super::csv;
use super::files::{NotFinite, Output};
use super::input::Failure;
use super::vtu::{CellKind, DataArray, Grid, vtu};
use crate::kernel::Stress;
use crate::model::{Mesh, Problem};
use crate::results::solution::{ContactEdge, ContactPoint};
use crate::results::{Solution, stresses};

impl Solution {
    /// Writes solution.vtu, contact.vtu and contact.csv into `folder`, of `problem`, which is the one that this solves;
    /// returns their paths.
    ///
    /// # Errors
    /// A folder or file that can't be written, a number that is not finite.
    pub fn write(&self, problem: &Problem, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
        let mut output = Output::new(folder)?;
        stage_fields(&mut output, self, problem, None)?;
        output.publish(&[])
    }
}

/// Makes and stages the files. `indicators` are the shares of the triangles in the bound of the error, if there is a bound.
pub(super) fn stage_fields(
    output: &mut Output,
    solution: &Solution,
    problem: &Problem,
    indicators: Option<&[f64]>,
) -> Result<(), Failure> {
    output.stage_made("solution.vtu", solution_vtu(solution, problem, indicators))?;
    output.stage_made("contact.vtu", contact_vtu(solution))?;
    output.stage_made("contact.csv", contact_csv(solution))
}

/// The number of the physical surface of each triangle, from 1 on in alphabetical order; 0 in none.
fn surface_numbers(mesh: &Mesh) -> Vec<f64> {
    let mut numbers = vec![0.0; mesh.triangles().len()];
    for (number, triangles) in (1_u32..).zip(mesh.surfaces().values()) {
        triangles.iter().for_each(|&t| numbers[t] = f64::from(number));
    }
    numbers
}

fn solution_vtu(
    s: &Solution,
    problem: &Problem,
    indicators: Option<&[f64]>,
) -> Result<Vec<u8>, NotFinite> {
    let all = |(stress, zz): &(Stress<f64>, f64)| {
        let [xx, yy, xy] = stress.components();
        [xx, yy, *zz, xy]
    };
    let stress: Vec<[f64; 4]> = s.stress.iter().map(all).collect();
    let mut cell_data = vec![
        DataArray::symmetric_tensors("stress", &stress),
        DataArray::scalars("von_mises", &s.von_mises),
    ];
    let surfaces = surface_numbers(&problem.mesh);
    if !problem.mesh.surfaces().is_empty() {
        cell_data.push(DataArray::scalars("surface", &surfaces));
    }
    let of_revolution = problem.material.are_of_revolution();
    let hoop: Vec<f64> = s.stress.iter().map(|(_, hoop)| *hoop).collect();
    if of_revolution {
        cell_data.push(DataArray::scalars("hoop_stress", &hoop));
    }
    if let Some(indicators) = indicators {
        cell_data.push(DataArray::scalars("error_bound", indicators));
    }
    let nodal = s.nodal_stresses(problem);
    let von_mises: Vec<f64> = nodal.iter().map(|&stress| stresses::von_mises(stress)).collect();
    let (first, second): (Vec<f64>, Vec<f64>) =
        nodal.iter().map(|&stress| stresses::principal_in_plane(stress).into()).unzip();
    let nodal_hoop: Vec<f64> = nodal.iter().map(|stress| stress[2]).collect();
    let mut point_data = vec![
        DataArray::vectors("displacement", &s.displacement),
        DataArray::symmetric_tensors("nodal_stress", &nodal),
        DataArray::scalars("nodal_von_mises", &von_mises),
        DataArray::scalars("principal_1", &first),
        DataArray::scalars("principal_2", &second),
    ];
    if of_revolution {
        point_data.push(DataArray::scalars("nodal_hoop_stress", &nodal_hoop));
    }
    vtu(&Grid {
        kind: CellKind::Triangle(s.degree),
        points: &s.nodes,
        connectivity: &s.elements,
        point_data: &point_data,
        cell_data: &cell_data,
    })
}

/// A number at a point of a contact boundary, by its name in contact.vtu and contact.csv.
type ContactNumber = (&'static str, fn(&ContactPoint) -> f64);

/// u . n~ (between two bodies the jump of that), the gap g, n~ . sigma(u) n (negative in compression), the contact pressure lambda^h
/// (never positive), and the recovered pressure (never negative); where there is friction also the slip u_t and the shear stress of
/// friction along t, n~ turned to the left.
const CONTACT_NUMBERS: [ContactNumber; 7] = [
    ("u_n", |p| p.u_n),
    ("gap", |p| p.gap),
    ("sigma_n", |p| p.sigma_n),
    ("lambda", |p| p.lambda),
    ("pressure", |p| p.pressure),
    ("u_t", |p| p.u_t),
    ("shear", |p| p.shear),
];

fn contact_numbers(s: &Solution) -> &'static [ContactNumber] {
    let friction = s.boundaries.iter().any(|boundary| boundary.friction.is_some());
    if friction { &CONTACT_NUMBERS } else { &CONTACT_NUMBERS[..5] }
}

fn contact_vtu(s: &Solution) -> Result<Vec<u8>, NotFinite> {
    let degree = s.degree.number();
    let per_edge = degree + 1;
    let connectivity: Vec<usize> = (0..s.contact.len())
        .flat_map(|e| {
            let first = e * per_edge;
            // Ends first, then what lies between them.
            [first, first + degree].into_iter().chain(first + 1..first + degree)
        })
        .collect();
    let points = || s.contact.iter().flat_map(|edge| &edge.points);
    let places: Vec<[f64; 2]> = points().map(|p| p.place).collect();
    let displacement: Vec<[f64; 2]> = points().map(|p| p.displacement).collect();
    let direction: Vec<[f64; 2]> = points().map(|p| p.direction).collect();
    // What is left of the gap: for a picture, as it follows from two others.
    let opening: ContactNumber = ("opening", |p| p.gap - p.u_n);
    let named = contact_numbers(s).iter().chain([&opening]);
    let numbers: Vec<(&str, Vec<f64>)> =
        named.map(|(name, of)| (*name, points().map(of).collect())).collect();
    let mut point_data = vec![DataArray::vectors("displacement", &displacement)];
    point_data.extend(numbers.iter().map(|(name, numbers)| DataArray::scalars(name, numbers)));
    point_data.push(DataArray::vectors("direction", &direction));
    vtu(&Grid {
        kind: CellKind::Line(s.degree),
        points: &places,
        connectivity: &connectivity,
        point_data: &point_data,
        cell_data: &[],
    })
}

/// A row for each node of each contact edge: arc length from the start of the boundary, place in the undeformed body, the
/// numbers there.
fn contact_csv<'s>(s: &'s Solution) -> Result<String, NotFinite> {
    let named = contact_numbers(s);
    let row = |p: &ContactPoint| {
        let [x, y] = p.place;
        let numbers = named.iter().map(|(_, of)| of(p));
        [p.arc, x, y].into_iter().chain(numbers).collect::<Vec<f64>>()
    };
    let of_edge = |edge: &'s ContactEdge| edge.points.iter().map(|p| (row(p), &*edge.boundary));
    let rows: Vec<(Vec<f64>, &str)> = s.contact.iter().flat_map(of_edge).collect();
    let names: Vec<&str> = named.iter().map(|(name, _)| *name).collect();
    csv::table(&[&["arc", "x", "y"], &names[..], &["boundary"]].concat(), &rows)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::io::vtu::tests::arrays;
    use crate::kernel::{Material, Plane};
    use crate::model::{Condition, Degree, Diagonal, Rectangle};
    use crate::solve::{Method, Settings, solve};

    /// A block with two surfaces, pressed on a floor at one end.
    fn solved() -> (Problem, Solution) {
        let cells = Rectangle { width: 2.0, height: 1.0, nx: 4, ny: 2, diagonal: Diagonal::Left };
        let surfaces = [("hard".to_owned(), vec![0, 3]), ("soft".to_owned(), vec![5])];
        let mesh = cells.mesh().unwrap().with_names(surfaces.into(), [].into()).unwrap();
        let problem = Problem::of(mesh, Material::lame(1.5, 1.0, Plane::Strain))
            .with("top", Condition::displacement(|_| 0.01, |[x, _]| 0.02 * x - 0.03))
            .with("bottom", Condition::contact(|[x, _]| 0.001 * x));
        let method = Method { degree: Degree::Two, ..Method::default() };
        let (solution, _) = solve(&problem, &method, &Settings::default()).unwrap();
        (problem, solution)
    }

    #[test]
    fn each_array_of_the_solution_has_the_numbers_of_its_name() {
        let (problem, s) = solved();
        let indicators: Vec<f64> = (0..16).map(|t| f64::from(t) + 0.5).collect();
        let arrays = arrays(&solution_vtu(&s, &problem, Some(&indicators)).unwrap());
        let array = |section: &str, name: &str| -> Vec<f64> {
            let array = arrays.iter().find(|(names, _)| *names == [section, name]);
            array.unwrap().1.clone()
        };
        let of_cell = |name: &str| array("CellData", name);
        let (stress, von_mises) = (of_cell("stress"), of_cell("von_mises"));
        for (t, (own, zz)) in s.stress.iter().enumerate() {
            let [xx, yy, xy] = own.components();
            assert_eq!(stress[6 * t..6 * t + 6], [xx, yy, *zz, xy, 0.0, 0.0]);
            let squares = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
            // Some ten roundings.
            let expected = (squares / 2.0 + 3.0 * xy * xy).sqrt();
            assert_relative_eq!(von_mises[t], expected, max_relative = 1e-13);
        }
        let surface = of_cell("surface");
        let expected = |t: usize| {
            [(0, 1.0), (3, 1.0), (5, 2.0)].iter().find(|(of, _)| *of == t).map_or(0.0, |of| of.1)
        };
        assert!((0..16).all(|t| surface[t] == expected(t)), "{surface:?}");
        assert_eq!(of_cell("error_bound"), indicators);
        let of_point = |name: &str| array("PointData", name);
        let displacement = of_point("displacement");
        let (nodal, first, second) =
            (of_point("nodal_stress"), of_point("principal_1"), of_point("principal_2"));
        for (node, u) in s.displacement.iter().enumerate() {
            assert_eq!(displacement[3 * node..3 * node + 3], [u[0], u[1], 0.0]);
            let [xx, yy, _, xy] = [0, 1, 2, 3].map(|c| nodal[6 * node + c]);
            let size = xx.abs() + yy.abs() + xy.abs();
            assert!(first[node] >= second[node]);
            assert!((first[node] + second[node] - xx - yy).abs() <= 1e-13 * size);
            assert!(
                (first[node] * second[node] - (xx * yy - xy * xy)).abs() <= 1e-13 * size * size
            );
        }
        // Control: the principal stresses are two.
        assert!(first.iter().zip(&second).any(|(a, b)| a > b));
    }

    #[test]
    fn each_column_of_the_contact_has_the_numbers_of_its_name() {
        let (_, s) = solved();
        let text = contact_csv(&s).unwrap();
        let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<&str>>());
        let names = rows.next().unwrap();
        let mut apart = 0;
        for (row, point) in rows.zip(s.contact.iter().flat_map(|edge| &edge.points)) {
            let number = |name: &str| -> f64 {
                row[names.iter().position(|of| *of == name).unwrap()].parse().unwrap()
            };
            let found =
                ["arc", "x", "y", "u_n", "gap", "sigma_n", "lambda", "pressure"].map(number);
            let [x, y] = s.nodes[point.node.unwrap()];
            let [_, uy] = s.displacement[point.node.unwrap()];
            let expected = [x, x, y, -uy, point.gap, point.sigma_n, point.lambda, point.pressure];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() <= 1e-15, "{found} {expected}");
            }
            apart += i32::from(point.lambda != -point.pressure && point.gap != 0.0);
        }
        assert!(apart > 2, "control: columns are not the same");
        let arrays = arrays(&contact_vtu(&s).unwrap());
        let opening = arrays.iter().find(|(names, _)| *names == ["PointData", "opening"]).unwrap();
        let points = s.contact.iter().flat_map(|edge| &edge.points);
        let left = points.map(|point| point.gap - point.u_n);
        assert_eq!(opening.1, left.collect::<Vec<f64>>());
    }
}
