//! The files of a solved case: solution.vtu, contact.vtu, contact.csv, picture.svg and result.json, written together or
//! not at all.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use thiserror::Error;

use super::case::{Case, Units};
use super::certificate;
use super::csv::{ContactRow, contact_csv};
use super::data::DataError;
use super::files::{Output, WriteError};
use super::numbers::short;
use super::picture::{ContactSample, Scene, picture};
use super::result::{
    Adaptation, Certificates, Choices, DiscreteCertificate, GammaChoice, MeshSizes, NewtonHistory,
    Results, SCHEMA, Seconds, StressPeak, StressPeaks, result_json,
};
use super::vtu::{CellKind, Field, Grid, Values, vtu};
use crate::certify::{CertifyError, Continuous, certify};
use crate::fem::{self, Space, contact_line::Gamma};
use crate::kernel::{P2, Stress};
use crate::memory::{self, OutOfMemory};
use crate::solve::solution::ContactValues;
use crate::solve::{Extreme, Solution, Times, Verdict, stresses};

/// The names of the files of a solved case; the last one says that the set is whole.
pub const FILES: [&str; 5] =
    ["solution.vtu", "contact.vtu", "contact.csv", "picture.svg", "result.json"];

/// The field of a displacement from elsewhere that is certified.
const CERTIFIED: &str = "certified.vtu";

/// The same of the engine fenicsx.
pub const FILES_OF_FENICSX: [&str; 3] = ["solution.xdmf", "solution.h5", "result.json"];

/// Those of the first list that are not in the second: left from another kind of run.
pub fn only_in(names: &[&'static str], others: &[&str]) -> Vec<&'static str> {
    names.iter().copied().filter(|name| !others.contains(name)).collect()
}

/// Why the files of a run could not be written.
#[derive(Debug, Error)]
#[non_exhaustive]
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

/// What is known of the distance from the true solution, and how long it took to know.
#[derive(Clone, Debug)]
pub struct Certified {
    /// The bound, or why there is none.
    pub result: Result<Continuous, CertifyError>,
    /// The time.
    pub time: Duration,
    /// How the mesh was adapted to it, if it was.
    pub adaptation: Option<Adaptation>,
}

impl Certified {
    /// Certifies a solution.
    pub fn new(case: &Case, solution: &Solution) -> Self {
        let start = Instant::now();
        let result = certify(&case.problem, solution);
        Certified { result, time: start.elapsed(), adaptation: None }
    }

    /// Adds what is known to the content of result.json; `asked` says whether a certificate was asked for.
    pub fn add_to(&self, results: &mut Results, asked: bool) {
        if let (Err(error), true) = (&self.result, asked) {
            results.missing.push(format!("certificate: {error}"));
        }
        if let Some(Adaptation { reason: Some(reason), .. }) = &self.adaptation {
            results.missing.push(format!("mesh that meets the target of [adapt]: {reason}"));
        }
        results.seconds.certify += self.time.as_secs_f64();
        results.certificate.get_or_insert_default().continuous = Some((&self.result).into());
        results.adapt.clone_from(&self.adaptation);
    }
}

/// Writes the files of a case into `folder`; returns their paths and the content of result.json. `certificate` asks for
/// the files certificate.json and certificate.bin, too; where there is no certificate, all else is written.
///
/// # Errors
/// A folder or file that can't be written, a number that is not finite.
pub fn write(
    folder: &Path,
    case: &Case,
    solution: &Solution,
    read: Duration,
    times: Times,
    certified: Option<&Certified>,
    certificate: bool,
) -> Result<(Vec<PathBuf>, Results), OutputError> {
    let start = Instant::now();
    memory::check(bytes_to_write(solution))?;
    let mut output = Output::new(folder)?;
    output.replaces(&only_in(&FILES_OF_FENICSX, &FILES));
    output.replaces(&[CERTIFIED]);
    let continuous = certified.and_then(|c| c.result.as_ref().ok());
    if !(certificate && continuous.is_some()) {
        output.replaces(&certificate::FILES);
    }
    let mut stage = |file, bytes: Result<Vec<u8>, DataError>| -> Result<(), OutputError> {
        let bytes = bytes.map_err(|error| OutputError::Data { file, error })?;
        Ok(output.stage(file, &bytes)?)
    };
    let indicators = continuous.map(|c| c.indicators.as_slice());
    stage("solution.vtu", solution_vtu(solution, &case.problem, indicators))?;
    stage("contact.vtu", contact_vtu(solution))?;
    stage("contact.csv", contact_csv(&contact_rows(solution)).map(String::into_bytes))?;
    stage("picture.svg", draw(case, solution).map(String::into_bytes))?;
    if let (Some(continuous), true) = (continuous, certificate) {
        for (file, bytes) in certificate_files(&case.title, continuous) {
            stage(file, bytes)?;
        }
    }
    let mut results = results(case, solution, Seconds::new(read, &times, start.elapsed()))?;
    if let Some(certified) = certified {
        certified.add_to(&mut results, certificate);
    }
    stage("result.json", result_json(&results).map(String::into_bytes))?;
    Ok((output.publish()?, results))
}

/// Writes what is certified of a displacement from elsewhere: certified.vtu with the `field`, its admissible part and the
/// bound of its error by triangles, certificate.json and certificate.bin.
///
/// # Errors
/// A folder or file that can't be written.
pub fn write_certified(
    folder: &Path,
    case: &Case,
    field: &[[f64; 2]],
    certified: &Continuous,
) -> Result<Vec<PathBuf>, OutputError> {
    let mut output = Output::new(folder)?;
    let mesh = &case.problem.mesh;
    let space = Space::<P2, 6, 3>::new(mesh);
    // The one of degree 1 has its values at the middles of edges, too, where the other is of degree 2.
    let nodes = field.len().max(certified.displacement.len());
    let [field, admissible] = [field, &certified.displacement].map(|values| {
        let mut all = values.to_vec();
        all.resize(nodes, [0.0; 2]);
        if values.len() < nodes {
            for element in space.elements() {
                for i in 0..3 {
                    let [a, b] = [1, 2].map(|k| all[element[(i + k) % 3]]);
                    all[element[3 + i]] = [0, 1].map(|c| (a[c] + b[c]) / 2.0);
                }
            }
        }
        all
    });
    let quadratic = nodes > mesh.vertices().len();
    let grid = vtu(&Grid {
        kind: if quadratic { CellKind::QuadraticTriangle } else { CellKind::Triangle },
        points: if quadratic { space.nodes() } else { mesh.vertices() },
        connectivity: if quadratic {
            space.elements().as_flattened()
        } else {
            mesh.triangles().as_flattened()
        },
        point_data: &[
            Field { name: "displacement", values: Values::Vectors(&field) },
            Field { name: "admissible", values: Values::Vectors(&admissible) },
        ],
        cell_data: &[Field { name: "error_bound", values: Values::Scalars(&certified.indicators) }],
    });
    let grid = grid.map_err(|error| OutputError::Data { file: CERTIFIED, error })?;
    output.stage(CERTIFIED, &grid)?;
    for (file, bytes) in certificate_files(&case.title, certified) {
        let bytes = bytes.map_err(|error| OutputError::Data { file, error })?;
        output.stage(file, &bytes)?;
    }
    Ok(output.publish()?)
}

/// certificate.json and certificate.bin.
fn certificate_files(
    title: &str,
    certified: &Continuous,
) -> [(&'static str, Result<Vec<u8>, DataError>); 2] {
    let (header, arrays) = certificate::encode(title, &certified.certificate, &certified.proof);
    let text = serde_json::to_vec_pretty(&header)
        .map_err(|_| DataError::NotFinite { place: certificate::FILES[0].to_owned() });
    [(certificate::FILES[0], text), (certificate::FILES[1], Ok(arrays))]
}

/// The bytes that making one file after the other takes at most: the numbers of solution.vtu once as they are and once as
/// text, the triangles of picture.svg by their places, and as they are sorted by their stress.
fn bytes_to_write(s: &Solution) -> u64 {
    const PER_NODE: u64 = 260;
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
    let probes: Vec<[f64; 4]> = probes.collect();
    let mut discrete = DiscreteCertificate::from(&solution.enclosure);
    discrete.unique &= solution.method.slides == 0;
    if let Ok(enclosure) = &solution.enclosure {
        let places = case.probes.iter().filter_map(|&x| mesh.locate(x));
        let off = places.map(|(t, l)| solution.displacement_error_at(&enclosure.nodes, t, l));
        discrete.probes = off.collect();
    }
    let errors = match &case.exact {
        Some(exact) => Some(solution.errors(&case.problem, &*exact.solution)?),
        None => None,
    };
    Ok(Results {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: Some(case.file.display().to_string()),
        schema: SCHEMA,
        title: case.title.clone(),
        verdict: Some(solution.verdict.name().to_owned()),
        reason: solution.verdict.reason().map(str::to_owned),
        missing: Vec::new(),
        units: case.units.clone(),
        thickness: case.thickness,
        materials: case.materials.clone(),
        choices: Some(Choices::from(&case.method)),
        remarks: remarks(case, solution),
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
        contact: solution.boundaries.clone(),
        stress: stress_peaks(case, solution),
        reaction_moments: solution.quantities.reaction_moments.clone(),
        balance: Some(solution.balance),
        probes,
        certificate: Some(Certificates { discrete: Some(discrete), continuous: None }),
        adapt: None,
        errors,
        seconds,
    })
}

/// Strains above this are more than small-strain theory is for.
const LARGE_STRAIN: f64 = 0.05;

/// Displacements above this share of the body's size likewise.
const LARGE_DISPLACEMENT: f64 = 0.1;

/// A triangle whose limit of gamma0 is this many times below the median of the line spoils the line.
const SLIVER: f64 = 8.0;

/// What a person should know before the numbers are used.
fn remarks(case: &Case, solution: &Solution) -> Vec<String> {
    let mut remarks = Vec::new();
    let coercivity = solution.gamma.coercivity;
    let uniform = matches!(solution.gamma.gamma, Gamma::Uniform(_));
    if uniform && coercivity.constant > SLIVER * coercivity.typical {
        let [[a, b], [c, d]] = coercivity.limiting_edge;
        remarks.push(format!(
            "the triangle at the contact edge from ({}, {}) to ({}, {}) sets gamma0 for the whole line, {:.0} times below what half of its triangles allow; method.kappa = 0.5 lets each edge have its own",
            short(a, 3), short(b, 3), short(c, 3), short(d, 3), coercivity.constant / coercivity.typical
        ));
    }
    let length = case.units.as_ref().map_or(String::new(), |units| format!(" {}", units.length));
    let strain = solution.largest_strain;
    if strain > LARGE_STRAIN {
        remarks.push(format!(
            "the largest strain is {} %: strains are taken to be small (below {} %); check load, modulus and units",
            short(100.0 * strain, 3),
            short(100.0 * LARGE_STRAIN, 3)
        ));
    }
    let vertices = case.problem.mesh.vertices();
    let extent = |c: usize| {
        let (low, high) = vertices
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x[c]), h.max(x[c])));
        high - low
    };
    let size = extent(0).max(extent(1));
    let largest = solution.quantities.max_displacement;
    if largest > LARGE_DISPLACEMENT * size {
        remarks.push(format!(
            "the largest displacement is {}{length}, the body is {}{length} long: displacements are taken to be small; check load, modulus and units",
            short(largest, 3),
            short(size, 3)
        ));
    }
    remarks
}

/// The largest stresses with the names of the physical surfaces that they are in.
fn stress_peaks(case: &Case, solution: &Solution) -> Option<StressPeaks> {
    let surfaces = case.problem.mesh.surfaces();
    let peak = |extreme: Extreme| {
        let inside =
            |(_, triangles): &(&String, &Vec<usize>)| triangles.contains(&extreme.triangle);
        let surface = surfaces.iter().find(inside).map(|(name, _)| name.clone());
        StressPeak { value: extreme.value, at: extreme.at, surface }
    };
    solution.largest_stresses(&case.problem).map(|largest| StressPeaks {
        von_mises: peak(largest.von_mises),
        principal_max: peak(largest.principal_max),
        principal_min: peak(largest.principal_min),
    })
}

/// For each triangle the number of its physical surface, from 1 on in alphabetical order; 0 in none.
fn surface_numbers(mesh: &fem::Mesh) -> Vec<f64> {
    let mut numbers = vec![0.0; mesh.triangles().len()];
    for (number, triangles) in (1_u32..).zip(mesh.surfaces().values()) {
        triangles.iter().for_each(|&t| numbers[t] = f64::from(number));
    }
    numbers
}

fn solution_vtu(
    s: &Solution,
    problem: &fem::Problem,
    indicators: Option<&[f64]>,
) -> Result<Vec<u8>, DataError> {
    let all = |(stress, zz): &(Stress<f64>, f64)| {
        let [xx, yy, xy] = stress.components();
        [xx, yy, *zz, xy]
    };
    let stress: Vec<[f64; 4]> = s.stress.iter().map(all).collect();
    let mut cell_data = vec![
        Field { name: "stress", values: Values::SymmetricTensors(&stress) },
        Field { name: "von_mises", values: Values::Scalars(&s.von_mises) },
    ];
    let surfaces = surface_numbers(&problem.mesh);
    if !problem.mesh.surfaces().is_empty() {
        cell_data.push(Field { name: "surface", values: Values::Scalars(&surfaces) });
    }
    if let Some(indicators) = indicators {
        cell_data.push(Field { name: "error_bound", values: Values::Scalars(indicators) });
    }
    let nodal = s.nodal_stresses(problem);
    let von_mises: Vec<f64> = nodal.iter().map(|&stress| stresses::von_mises(stress)).collect();
    let (first, second): (Vec<f64>, Vec<f64>) =
        nodal.iter().map(|&stress| stresses::principal_in_plane(stress).into()).unzip();
    vtu(&Grid {
        kind: if s.degree == 1 { CellKind::Triangle } else { CellKind::QuadraticTriangle },
        points: &s.nodes,
        connectivity: &s.elements,
        point_data: &[
            Field { name: "displacement", values: Values::Vectors(&s.displacement) },
            Field { name: "nodal_stress", values: Values::SymmetricTensors(&nodal) },
            Field { name: "nodal_von_mises", values: Values::Scalars(&von_mises) },
            Field { name: "principal_1", values: Values::Scalars(&first) },
            Field { name: "principal_2", values: Values::Scalars(&second) },
        ],
        cell_data: &cell_data,
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
    let pressure = scalars(|p| p.pressure);
    let direction: Vec<[f64; 2]> = points.iter().map(|p| p.direction).collect();
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
            Field { name: "pressure", values: Values::Scalars(&pressure) },
            Field { name: "direction", values: Values::Vectors(&direction) },
        ],
        cell_data: &[],
    })
}

fn contact_rows(s: &Solution) -> Vec<ContactRow<'_>> {
    let mut rows = Vec::new();
    for edge in &s.contact {
        for p in &edge.points {
            let [x, y] = s.nodes[p.node];
            let ContactValues { arc, u_n, gap, sigma_n, lambda, pressure, .. } = *p;
            let boundary = &*edge.boundary;
            rows.push(ContactRow { arc, x, y, u_n, gap, sigma_n, lambda, pressure, boundary });
        }
    }
    rows
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
    let (contact, surfaces) = contact_parts(s);
    let unit = case.units.as_ref().map(Units::stress);
    picture(&Scene {
        title: &case.title,
        subtitle: &format!(
            "{}P{}, {} unknowns, gamma0 = {}, kappa = {}",
            match s.verdict {
                Verdict::Proved => "",
                Verdict::NotProved(_) => "NOT PROVED (result.json says why): ",
            },
            s.degree,
            2 * s.nodes.len(),
            short(gamma.gamma0, 3),
            short(gamma.kappa, 3)
        ),
        points: &s.nodes,
        displacement: &s.displacement,
        triangles: &triangles,
        von_mises: &von_mises,
        unit: unit.as_deref(),
        interfaces: &interfaces(case, s),
        outline: &outline,
        contact: &contact,
        surfaces: &surfaces,
    })
}

/// The edges between triangles of different materials, for P2 in two halves.
fn interfaces(case: &Case, s: &Solution) -> Vec<[usize; 2]> {
    let (mesh, materials) = (&case.problem.mesh, &case.problem.material);
    let mut found = Vec::new();
    if materials.only().is_some() {
        return found;
    }
    let mut material_at = BTreeMap::new();
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let material = materials.place_of(t);
        for i in 0..3 {
            let [a, b] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
            match material_at.insert([a.min(b), a.max(b)], material) {
                Some(other) if other != material && s.degree == 1 => found.push([a, b]),
                Some(other) if other != material => {
                    let middle = s.elements[6 * t + 3 + i];
                    found.extend([[a, middle], [middle, b]]);
                }
                _ => {}
            }
        }
    }
    found
}

/// The connected parts of the contact line, and the number of each one's boundary.
fn contact_parts(s: &Solution) -> (Vec<Vec<ContactSample>>, Vec<usize>) {
    let mut parts: Vec<Vec<ContactSample>> = Vec::new();
    let (mut surfaces, mut surface) = (Vec::new(), 0);
    let mut end = None;
    let mut boundary = "";
    for edge in &s.contact {
        if *edge.boundary != *boundary {
            end = None;
            surface += 1;
        }
        boundary = &edge.boundary;
        let samples = edge.points.iter().map(|p| ContactSample {
            position: s.nodes[p.node],
            normal: p.direction,
            displacement: s.displacement[p.node],
            gap: p.gap,
            pressure: p.pressure,
        });
        match parts.last_mut() {
            Some(part) if end.is_some() && end == edge.points.first().map(|p| p.node) => {
                part.extend(samples)
            }
            _ => {
                parts.push(samples.collect());
                surfaces.push(surface);
            }
        }
        end = edge.points.last().map(|p| p.node);
    }
    (parts, surfaces)
}
