//! The files of a solved case: solution.vtu, contact.vtu, contact.csv, picture.svg and result.json, written together or
//! not at all.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use thiserror::Error;

use super::case::Case;
use super::csv::{ContactRow, contact_csv};
use super::data::DataError;
use super::files::{Output, WriteError};
use super::numbers::short;
use super::picture::{ContactSample, Scene, picture};
use super::result::{GammaChoice, MeshSizes, NewtonHistory, Results, Seconds, result_json};
use super::vtu::{CellKind, Field, Grid, Values, vtu};
use crate::fem;
use crate::kernel::Stress;
use crate::memory::{self, OutOfMemory};
use crate::solve::solution::ContactValues;
use crate::solve::{Solution, Times};

/// The names of the files of a solved case; the last one says that the set is whole.
pub const FILES: [&str; 5] =
    ["solution.vtu", "contact.vtu", "contact.csv", "picture.svg", "result.json"];

/// The same of the engine fenicsx.
pub const FILES_OF_FENICSX: [&str; 3] = ["solution.xdmf", "solution.h5", "result.json"];

/// Those of the first list that are not in the second: left from another kind of run.
pub fn only_in(names: &[&'static str], others: &[&str]) -> Vec<&'static str> {
    names.iter().copied().filter(|name| !others.contains(name)).collect()
}

/// Why the files of a run could not be written.
#[derive(Debug, Error)]
pub enum OutputError {
    /// A file or folder.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// What was to go into a file.
    #[error("{file} cannot be made: {error}")]
    Data {
        /// The name of the file.
        file: &'static str,
        /// What is wrong with its data.
        error: DataError,
    },
    /// The memory for what goes into the files.
    #[error("the files cannot be made: {0}")]
    OutOfMemory(#[from] OutOfMemory),
    /// A solution and a case that don't belong together.
    #[error(transparent)]
    Problem(#[from] fem::DataError),
}

/// Writes the files of a case into `folder`; returns their paths and the content of result.json.
///
/// # Errors
/// A folder or file that can't be written, a number that is not finite.
pub fn write(
    folder: &Path,
    case: &Case,
    solution: &Solution,
    read: Duration,
    times: Times,
) -> Result<(Vec<PathBuf>, Results), OutputError> {
    let start = Instant::now();
    memory::check(bytes_to_write(solution))?;
    let mut output = Output::new(folder)?;
    output.replaces(&only_in(&FILES_OF_FENICSX, &FILES));
    let mut stage = |file, bytes: Result<Vec<u8>, DataError>| -> Result<(), OutputError> {
        let bytes = bytes.map_err(|error| OutputError::Data { file, error })?;
        Ok(output.stage(file, &bytes)?)
    };
    stage("solution.vtu", solution_vtu(solution))?;
    stage("contact.vtu", contact_vtu(solution))?;
    stage("contact.csv", contact_csv(&contact_rows(solution)).map(String::into_bytes))?;
    stage("picture.svg", draw(case, solution).map(String::into_bytes))?;
    let seconds = Seconds::new(read, &times, start.elapsed());
    let results = results(case, solution, seconds)?;
    stage("result.json", result_json(&results).map(String::into_bytes))?;
    Ok((output.publish()?, results))
}

/// The bytes that making one file after the other takes at most: the numbers of solution.vtu once as they are and once as
/// text, the triangles of picture.svg by their places, and as they are sorted by their stress.
fn bytes_to_write(s: &Solution) -> u64 {
    const PER_NODE: u64 = 160;
    const PER_DRAWN_TRIANGLE: u64 = 400;
    let drawn = s.von_mises.len() as u64 * if s.degree == 1 { 1 } else { 4 };
    PER_NODE * s.nodes.len() as u64 + PER_DRAWN_TRIANGLE * drawn
}

/// The content of result.json.
///
/// # Errors
/// Those of [`Solution::errors`], should `solution` not be one of this case.
pub fn results(
    case: &Case,
    solution: &Solution,
    seconds: Seconds,
) -> Result<Results, fem::DataError> {
    let mesh = &case.problem.mesh;
    let triangles = 0..mesh.triangles().len();
    let probes = case.probes.iter().filter_map(|&[x, y]| {
        let (t, l) = mesh.locate([x, y])?;
        let [u_x, u_y] = solution.displacement_at(t, l);
        Some([x, y, u_x, u_y])
    });
    let errors = match &case.exact {
        Some(exact) => Some(solution.errors(&case.problem, &*exact.solution)?),
        None => None,
    };
    Ok(Results {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: Some(case.file.display().to_string()),
        title: case.title.clone(),
        mesh: MeshSizes {
            vertices: mesh.vertices().len(),
            triangles: mesh.triangles().len(),
            dofs: 2 * solution.nodes.len(),
            contact_edges: solution.contact.len(),
            h_max: triangles.map(|t| mesh.diameter(t)).fold(0.0, f64::max),
        },
        gamma: GammaChoice::from(&solution.gamma),
        newton: NewtonHistory {
            iterations: solution.newton.iterations(),
            residuals: solution.newton.residuals.clone(),
            residual: solution.newton.residual,
            factorizations: solution.newton.factorizations,
            status: solution.newton.status,
        },
        method: Some(solution.method),
        quantities: solution.quantities.clone(),
        probes: probes.collect(),
        errors,
        seconds,
    })
}

fn solution_vtu(s: &Solution) -> Result<Vec<u8>, DataError> {
    let all = |(stress, zz): &(Stress<f64>, f64)| {
        let [xx, yy, xy] = stress.components();
        [xx, yy, *zz, xy]
    };
    let stress: Vec<[f64; 4]> = s.stress.iter().map(all).collect();
    vtu(&Grid {
        kind: if s.degree == 1 { CellKind::Triangle } else { CellKind::QuadraticTriangle },
        points: &s.nodes,
        connectivity: &s.elements,
        point_data: &[Field { name: "displacement", values: Values::Vectors(&s.displacement) }],
        cell_data: &[
            Field { name: "stress", values: Values::SymmetricTensors(&stress) },
            Field { name: "von_mises", values: Values::Scalars(&s.von_mises) },
        ],
    })
}

/// Each edge has points of its own, for sigma_n and lambda^h jump from edge to edge.
fn contact_vtu(s: &Solution) -> Result<Vec<u8>, DataError> {
    let points: Vec<&ContactValues> = s.contact.iter().flat_map(|edge| &edge.points).collect();
    let per_edge = s.degree + 1;
    let connectivity: Vec<usize> = (0..s.contact.len())
        .flat_map(|e| {
            let first = e * per_edge;
            // Ends first, then what lies between them.
            [first, first + s.degree].into_iter().chain(first + 1..first + s.degree)
        })
        .collect();
    let places: Vec<[f64; 2]> = points.iter().map(|p| s.nodes[p.node]).collect();
    let displacement: Vec<[f64; 2]> = points.iter().map(|p| s.displacement[p.node]).collect();
    let scalars = |of: fn(&ContactValues) -> f64| points.iter().map(|p| of(p)).collect::<Vec<_>>();
    let (u_n, gap) = (scalars(|p| p.u_n), scalars(|p| p.gap));
    let (sigma_n, lambda) = (scalars(|p| p.sigma_n), scalars(|p| p.lambda));
    vtu(&Grid {
        kind: if s.degree == 1 { CellKind::Line } else { CellKind::QuadraticLine },
        points: &places,
        connectivity: &connectivity,
        point_data: &[
            Field { name: "displacement", values: Values::Vectors(&displacement) },
            Field { name: "u_n", values: Values::Scalars(&u_n) },
            Field { name: "gap", values: Values::Scalars(&gap) },
            Field { name: "sigma_n", values: Values::Scalars(&sigma_n) },
            Field { name: "lambda", values: Values::Scalars(&lambda) },
        ],
        cell_data: &[],
    })
}

fn contact_rows(s: &Solution) -> Vec<ContactRow> {
    let row = |p: &ContactValues| {
        let [x, y] = s.nodes[p.node];
        let ContactValues { arc, u_n, gap, sigma_n, lambda, .. } = *p;
        ContactRow { arc, x, y, u_n, gap, sigma_n, lambda }
    };
    s.contact.iter().flat_map(|edge| edge.points.iter().map(row)).collect()
}

fn draw(case: &Case, s: &Solution) -> Result<String, DataError> {
    let mesh = &case.problem.mesh;
    let ends = mesh.outline().iter().map(|&edge| (edge, mesh.ends(edge)));
    let (triangles, von_mises, outline): (Vec<[usize; 3]>, Vec<f64>, Vec<[usize; 2]>) =
        if s.degree == 1 {
            let outline = ends.map(|(_, ends)| ends).collect();
            (mesh.triangles().to_vec(), s.von_mises.clone(), outline)
        } else {
            // A quadratic triangle is drawn as four, its edges as two.
            let (elements, _) = s.elements.as_chunks::<6>();
            let quarters =
                |&[a, b, c, d, e, f]: &[usize; 6]| [[a, f, e], [f, b, d], [e, d, c], [d, e, f]];
            let halves = ends.flat_map(|(edge, [a, b])| {
                let middle = elements[edge.triangle][3 + edge.local];
                [[a, middle], [middle, b]]
            });
            (
                elements.iter().flat_map(quarters).collect(),
                s.von_mises.iter().flat_map(|&v| [v; 4]).collect(),
                halves.collect(),
            )
        };
    let gamma = &s.gamma;
    picture(&Scene {
        title: &case.title,
        subtitle: &format!(
            "P{}, {} unknowns, gamma0 = {}, kappa = {}",
            s.degree,
            2 * s.nodes.len(),
            short(gamma.gamma0, 3),
            short(gamma.kappa, 3)
        ),
        points: &s.nodes,
        displacement: &s.displacement,
        triangles: &triangles,
        von_mises: &von_mises,
        outline: &outline,
        contact: &contact_parts(s),
    })
}

/// The connected parts of the contact line.
fn contact_parts(s: &Solution) -> Vec<Vec<ContactSample>> {
    let mut parts: Vec<Vec<ContactSample>> = Vec::new();
    let mut end = None;
    for edge in &s.contact {
        let samples = edge.points.iter().map(|p| ContactSample {
            position: s.nodes[p.node],
            normal: edge.normal,
            displacement: s.displacement[p.node],
            gap: p.gap,
            pressure: -p.lambda,
        });
        match parts.last_mut() {
            Some(part) if end == edge.points.first().map(|p| p.node) => part.extend(samples),
            _ => parts.push(samples.collect()),
        }
        end = edge.points.last().map(|p| p.node);
    }
    parts
}
