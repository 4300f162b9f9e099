//! The files of a solved case: solution.vtu, contact.vtu, contact.csv, picture.svg, result.json and, on demand, report.html
//! and the certificate, written together or not at all.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::case::Case;
use super::certificate;
use super::fields::stage_fields;
use super::files::{NotFinite, Output};
use super::input::Failure;
use super::picture::{Scene, draw};
use super::remarks::{Words, remarks};
use super::report;
use super::result::{
    Adaptation, Certificates, Choices, ContinuousCertificate, DiscreteCertificate, GammaChoice,
    MeshSizes, NewtonHistory, Results, SCHEMA, Seconds, StressPeak, StressPeaks, result_json,
};
use super::revolution;
use super::run::Solved;
use super::vtu::{CellKind, DataArray, Grid, vtu};
use crate::certificates::Continuous;
use crate::exact::Errors;
use crate::memory;
use crate::model::{Degree, Space};
use crate::results::{Extreme, Solution};
use crate::solve::{ContactQuadrature, Gamma0, Method};

const PICTURE: &str = "picture.svg";

/// The names of all files that a solve may write into its folder, by this program or by the engine fenicsx. Those of an earlier
/// run that a run does not write itself are removed. The last one says that a set is whole.
pub(crate) const FILES: [&str; 11] = [
    "solution.vtu",
    "contact.vtu",
    "contact.csv",
    PICTURE,
    report::FILE,
    CERTIFIED,
    certificate::FILES[0],
    certificate::FILES[1],
    "solution.xdmf",
    "solution.h5",
    "result.json",
];

/// The field of a displacement from elsewhere that is certified.
const CERTIFIED: &str = "certified.vtu";

/// Files that are written on demand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extra {
    /// certificate.json and certificate.bin, where there is a certificate.
    pub certificate: bool,
    /// report.html.
    pub report: bool,
}

/// The files of a case as they were written.
#[derive(Debug)]
pub struct Written {
    /// The paths of the files.
    pub files: Vec<PathBuf>,
    /// The content of result.json.
    pub(crate) results: Results,
    /// The content of the picture.
    pub(crate) scene: Scene,
}

/// Writes the files of a case into `folder`. Where there is no
/// certificate that was asked for, or no picture, all else is written.
pub fn write(
    folder: &Path,
    case: &Case,
    solved: &Solved,
    read: Duration,
    extra: Extra,
) -> Result<Written, Failure> {
    let start = Instant::now();
    let solution = &solved.solution;
    memory::check(bytes_to_write(solution))
        .map_err(|lack| Failure::failed(format!("the files cannot be made: {lack}")))?;
    let mut output = Output::new(folder)?;
    let continuous = solved.certified.as_ref().and_then(|c| c.as_ref().ok());
    let mut results = results(case, solved, read, extra)?;
    let indicators = continuous.map(|c| c.indicators.as_slice());
    stage_fields(&mut output, solution, &case.problem, indicators)?;
    let scene = Scene::of(case, solution, &results);
    let picture = draw(std::slice::from_ref(&scene)).unwrap_or_else(|error| {
        results.missing.push(format!("picture: {error}"));
        Vec::new()
    });
    let picture = picture.concat();
    if extra.report {
        output.stage(report::FILE, report::html(case, &results, &picture))?;
    }
    if !picture.is_empty() {
        output.stage(PICTURE, picture)?;
    }
    if let (Some(continuous), true) = (continuous, extra.certificate || case.asks_for_certificate())
    {
        stage_certificate(&mut output, case, continuous)?;
    }
    results.seconds.write = start.elapsed().as_secs_f64();
    output.stage_made("result.json", result_json(&results))?;
    Ok(Written { files: output.publish(&FILES)?, results, scene })
}

/// The pictures of the runs of a series, which are drawn again on one scale when all are solved.
#[derive(Debug, Default)]
pub(crate) struct Series {
    scenes: Vec<(PathBuf, Scene)>,
    triangles: usize,
}

/// The most triangles of a series that are kept to be drawn again, about 100 bytes each; the pictures of a longer series have each their own
/// scale.
const MOST_KEPT: usize = 5_000_000;

impl Series {
    /// Keeps the scene of the picture in `folder`.
    pub(crate) fn add(&mut self, folder: PathBuf, scene: Scene) {
        self.triangles += scene.triangles();
        if self.triangles <= MOST_KEPT {
            self.scenes.push((folder, scene));
        } else {
            self.scenes.clear();
        }
    }

    /// Draws all pictures again on one scale, where there are several; one that cannot be drawn by itself is left out.
    ///
    /// # Errors
    /// A picture that can't be written.
    pub(crate) fn draw(self) -> Result<(), Failure> {
        if self.scenes.len() < 2 {
            return Ok(());
        }
        let drawn = self.scenes.into_iter().filter(|(folder, _)| folder.join(PICTURE).exists());
        let (folders, scenes): (Vec<PathBuf>, Vec<Scene>) = drawn.unzip();
        // Where one scale takes a picture beyond the range of doubles, all keep their own.
        for (folder, picture) in folders.iter().zip(draw(&scenes).unwrap_or_default()) {
            let mut output = Output::new(folder)?;
            output.stage(PICTURE, picture)?;
            output.publish(&[])?;
        }
        Ok(())
    }
}

/// Writes what is certified of a displacement from elsewhere: certified.vtu with the `field`, its admissible part and the
/// bound of its error by triangles, certificate.json and certificate.bin.
pub(crate) fn write_certified(
    folder: &Path,
    case: &Case,
    field: &[[f64; 2]],
    certified: &Continuous,
) -> Result<Vec<PathBuf>, Failure> {
    let mut output = Output::new(folder)?;
    let mesh = &case.problem.mesh;
    let space = Space::new(mesh, Degree::Two);
    let nodes = field.len().max(certified.displacement.len());
    let [field, admissible] =
        [field, &certified.displacement].map(|values| at_nodes(values, nodes, &space));
    let (degree, points, connectivity) = if nodes > mesh.vertices().len() {
        (Degree::Two, space.nodes(), space.connectivity())
    } else {
        (Degree::One, mesh.vertices(), mesh.triangles().as_flattened())
    };
    let grid = vtu(&Grid {
        kind: CellKind::Triangle(degree),
        points,
        connectivity,
        point_data: &[
            DataArray::vectors("displacement", &field),
            DataArray::vectors("admissible", &admissible),
        ],
        cell_data: &[DataArray::scalars("error_bound", &certified.indicators)],
    });
    output.stage_made(CERTIFIED, grid)?;
    stage_certificate(&mut output, case, certified)?;
    output.publish(&[])
}

/// The values at `nodes` nodes: those of degree 1 take the means of the ends at the middles of edges, where there are some.
fn at_nodes(values: &[[f64; 2]], nodes: usize, space: &Space) -> Vec<[f64; 2]> {
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
}

fn stage_certificate(
    output: &mut Output,
    case: &Case,
    certified: &Continuous,
) -> Result<(), Failure> {
    let forces = &certified.quantities.evidence;
    let (mut header, arrays) =
        certificate::encode(&case.title, &certified.certificate, &certified.proof, forces);
    header.thickness = case.thickness;
    let text = serde_json::to_vec_pretty(&header)
        .map_err(|_| NotFinite { place: certificate::FILES[0].to_owned() });
    output.stage_made(certificate::FILES[0], text)?;
    output.stage(certificate::FILES[1], arrays)
}

/// The bytes that making one file after the other takes at most: the numbers of solution.vtu once as they are and once as
/// text, the triangles of picture.svg by their places, and as they are sorted by their stress.
fn bytes_to_write(s: &Solution) -> u64 {
    const PER_NODE: u64 = 260;
    const PER_DRAWN_TRIANGLE: u64 = 400;
    let drawn = s.von_mises.len() as u64 * if s.degree == Degree::One { 1 } else { 4 };
    PER_NODE * s.nodes.len() as u64 + PER_DRAWN_TRIANGLE * drawn
}

/// The content of result.json of a solved case that was read in the time `read`, and of which `extra` was asked for.
pub fn results(
    case: &Case,
    solved: &Solved,
    read: Duration,
    extra: Extra,
) -> Result<Results, Failure> {
    let solution = &solved.solution;
    let mesh = &case.problem.mesh;
    let mut discrete = DiscreteCertificate::from(&solution.enclosure);
    discrete.unique &= solution.method.slides == 0;
    let mut probes = Vec::new();
    for &[x, y] in &case.probes {
        let Some((t, l)) = mesh.locate([x, y]) else { continue };
        let [u_x, u_y] = solution.displacement_at(t, l);
        probes.push([x, y, u_x, u_y]);
        if let Ok(enclosure) = &solution.enclosure {
            discrete.probes.push(solution.displacement_error_at(&enclosure.nodes, t, l));
        }
    }
    let errors =
        case.exact.as_ref().map(|exact| Errors::of(solution, &case.problem, &*exact.solution));
    let known = solved.adaptation.as_ref().filter(|adaptation| adaptation.met);
    let known_force = known.and_then(|adaptation| adaptation.force.clone());
    let words = Words { known_force, ..case.words() };
    let mut remarks: Vec<String> = case.remarks.clone();
    remarks.extend(self::remarks(&case.problem, solution, &words));
    remarks.extend(revolution::remark(case));
    let errors = errors.filter(Errors::is_finite);
    if case.exact.is_some() && errors.is_none() {
        remarks.push(NO_ERRORS.to_owned());
    }
    let mut results = Results {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: Some(case.file.display().to_string()),
        schema: SCHEMA,
        title: case.title.clone(),
        step: case.step,
        verdict: Some(solution.verdict.name().to_owned()),
        reason: solution.verdict.reason().map(str::to_owned),
        missing: Vec::new(),
        units: case.units.clone(),
        thickness: case.thickness,
        materials: case.materials.clone(),
        choices: Some(choices(&case.method)),
        remarks,
        mesh: MeshSizes::new(mesh, solution.nodes.len(), solution.pieces.len()),
        gamma: GammaChoice::from(&solution.gamma),
        newton: NewtonHistory::from(&solution.newton),
        method: Some(solution.method),
        play: solution.plays.clone(),
        quantities: solution.quantities.clone(),
        contact: solution.boundaries.clone(),
        stress: stress_peaks(case, solution),
        reaction_moments: solution.quantities.reaction_moments.clone(),
        balance: Some(solution.balance),
        probes,
        certificate: Some(Certificates {
            discrete: Some(discrete),
            continuous: solved.certified.as_ref().map(ContinuousCertificate::from),
        }),
        adapt: solved.adaptation.clone(),
        errors,
        seconds: seconds(solved, read),
    };
    let is_asked = extra.certificate || case.asks_for_certificate();
    if let (Some(Err(error)), true) = (&solved.certified, is_asked) {
        results.missing.push(format!("certificate: {error}"));
    }
    results.of_thickness(case.thickness.unwrap_or(1.0));
    if let Some(Adaptation { reason: Some(reason), .. }) = &solved.adaptation {
        results.missing.push(format!("mesh that meets the target of [adapt]: {reason}"));
    }
    Ok(results)
}

fn choices(method: &Method) -> Choices {
    Choices {
        degree: method.degree.number(),
        gamma0_auto: method.gamma0 == Gamma0::Auto,
        contact_quadrature: match method.quadrature {
            ContactQuadrature::Exact => "exact".to_owned(),
            ContactQuadrature::Gauss(points) => points.to_string(),
        },
        allow_noncoercive: method.allow_noncoercive,
    }
}

/// The seconds of each part of the work before the files are written.
fn seconds(solved: &Solved, read: Duration) -> Seconds {
    Seconds {
        read: read.as_secs_f64(),
        assemble: solved.times.assemble().as_secs_f64(),
        solve: solved.times.solve().as_secs_f64(),
        certify: solved.times.certify.as_secs_f64(),
        write: 0.0,
    }
}

/// The reason why there are no errors where there is an exact solution.
const NO_ERRORS: &str = "the errors are not given: near its singular point the exact solution is beyond the range of doubles";

/// The largest stresses with the names of the physical surfaces that they are in.
fn stress_peaks(case: &Case, solution: &Solution) -> Option<StressPeaks> {
    let mesh = &case.problem.mesh;
    let surfaces = || case.materials.iter().flat_map(|material| &material.surfaces);
    let peak = |extreme: Extreme| {
        let inside = |name: &&String| {
            mesh.surface(name).is_ok_and(|triangles| triangles.contains(&extreme.triangle))
        };
        let surface = surfaces().find(inside).cloned();
        StressPeak { value: extreme.value, at: extreme.at, surface }
    };
    solution.largest_stresses(&case.problem).map(|largest| StressPeaks {
        von_mises: peak(largest.von_mises),
        principal_max: peak(largest.principal_max),
        principal_min: peak(largest.principal_min),
        hoop_max: largest.hoop.map(|[most, _]| peak(most)),
        hoop_min: largest.hoop.map(|[_, least]| peak(least)),
    })
}
