//! The fields of a solution for other programs: solution.vtu, contact.vtu and contact.csv.

use std::path::{Path, PathBuf};

use super::csv;
use super::files::{NotFinite, Output};
use super::input::Failure;
use super::vtu::{CellKind, DataArray, Grid, vtu};
use crate::kernel::Stress;
use crate::model::{Mesh, Problem};
use crate::results::solution::ContactPoint;
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
        output.publish()
    }
}

/// Makes and stages the files. `indicators` are the shares of the triangles in the bound of the error, if it is known.
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

/// Those of a solution.
fn contact_numbers(s: &Solution) -> &'static [ContactNumber] {
    let friction = s.boundaries.iter().any(|boundary| boundary.friction.is_some());
    if friction { &CONTACT_NUMBERS } else { &CONTACT_NUMBERS[..5] }
}

/// The file contact.vtu.
fn contact_vtu(s: &Solution) -> Result<Vec<u8>, NotFinite> {
    let edges = s.contact_points();
    let degree = s.degree.number();
    let per_edge = degree + 1;
    let connectivity: Vec<usize> = (0..edges.len())
        .flat_map(|e| {
            let first = e * per_edge;
            // Ends first, then what lies between them.
            [first, first + degree].into_iter().chain(first + 1..first + degree)
        })
        .collect();
    let points = || edges.iter().flatten();
    let places: Vec<[f64; 2]> = points().map(|p| p.place).collect();
    let displacement: Vec<[f64; 2]> = points().map(|p| p.displacement).collect();
    let direction: Vec<[f64; 2]> = points().map(|p| p.direction).collect();
    let named = contact_numbers(s).iter();
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
fn contact_csv(s: &Solution) -> Result<String, NotFinite> {
    let named = contact_numbers(s);
    let row = |p: &ContactPoint| {
        let [x, y] = p.place;
        let numbers = named.iter().map(|(_, of)| of(p));
        [p.arc, x, y].into_iter().chain(numbers).collect::<Vec<f64>>()
    };
    let edges = s.contact_points();
    let rows: Vec<(Vec<f64>, &str)> =
        edges.iter().flatten().map(|p| (row(p), p.boundary)).collect();
    let names: Vec<&str> = named.iter().map(|(name, _)| *name).collect();
    csv::table(&[&["arc", "x", "y"], &names[..], &["boundary"]].concat(), &rows)
}
