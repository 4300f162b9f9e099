//! The case file: one contact problem and how to solve it, in TOML. docs/case.md lists the keys, and a test compares that page
//! with the reader.
//!
//! Numbers serve as expressions, integers as numbers; the grammar of expressions is in [`expression`](super::expression). A key
//! that is not known is an error, and so is a list of the wrong length, a number that is NaN or infinite, and a boundary with
//! more than one of displacement, traction and contact.

mod beyond;
mod body;
mod boundary;
mod exact;
mod friction;
mod mesh;
mod method;
mod pairs;
mod source;
mod table;

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub(crate) use self::body::MaterialEcho;
use self::body::{PLANES, only_isotropic, read_loads, read_materials};
use self::boundary::{Depth, read_boundaries, read_points};
use self::exact::read_exact;
use self::friction::read_friction;
use self::mesh::{Meshed, read_mesh};
use self::method::{read_method, read_quantities, read_settings, read_target};
use self::source::Source;
use self::table::{Table, Value};
use super::input::{self, Failure, FileError, MOST_OF_A_CASE, Position};
use super::remarks::Words;
use crate::certificates::{Asked, Target};
use crate::contact::Pair;
use crate::exact::{Exact, Kind};
use crate::kernel::Plane;
use crate::memory;
use crate::model::{Degree, Mesh, Perturbation, Problem, SharedFunction, Structured};
use crate::quote;
use crate::solve::{Method, Settings};

/// A contact problem and how to solve it.
#[non_exhaustive]
pub struct Case {
    /// The file it was read from, or the name that stands in its place.
    pub file: PathBuf,
    /// A line for people.
    pub title: String,
    /// The problem.
    pub problem: Problem,
    /// Its load steps, a case for each \[\[step\]\]; each begins where the one before ends.
    pub steps: Vec<Case>,
    /// The number of the load step that it is, from 1, if it is one.
    pub(crate) step: Option<usize>,
    /// The variant of method (8).
    pub method: Method,
    /// The accuracy.
    pub settings: Settings,
    /// The target of the error, if the mesh is to be adapted until it is proved; and the boundary whose contact force it is
    /// about, if it is not about the energy norm.
    pub(crate) adapt: Option<(Target, Option<String>)>,
    /// Quantities to be proved beside the bound.
    pub(crate) asked: Asked,
    /// The places where the displacement is wanted.
    pub(crate) probes: Vec<[f64; 2]>,
    pub(crate) materials: Vec<MaterialEcho>,
    pub(crate) units: Option<Units>,
    /// The thickness of the body across the plane, if the case gives it; 1 for a body of revolution, whose results are those of the
    /// whole of it.
    pub(crate) thickness: Option<f64>,
    /// The number of vertices of a body of revolution that were next to its axis and have been moved onto it.
    pub(crate) snapped: usize,
    /// The amount by which the picture magnifies displacement and gap, if the case says so.
    pub(crate) stretch: Option<f64>,
    /// The exact solution, if there is one.
    pub exact: Option<ExactCase>,
    /// The text that it was read from, with a comment for each setting laid over it.
    pub(crate) text: String,
    /// Decisions made when the mesh was read, in sentences for people.
    pub remarks: Vec<String>,
    /// The files that all this was read from.
    pub sources: Vec<PathBuf>,
}

/// The units of a case: words for labels. The numbers are consistent by themselves.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Units {
    pub(crate) length: String,
    pub(crate) force: String,
}

/// The quantity that a number measures. Forces, and moments as energies, are those of the whole body if its thickness is known, else
/// per length across the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    Length,
    /// A stress or a pressure.
    Stress,
    Force,
    /// A moment or an energy.
    Moment,
}

impl Units {
    /// The unit of a measure on a body whose thickness is known or not.
    pub(crate) fn of(&self, measure: Measure, thickness: Option<f64>) -> String {
        let Units { length, force } = self;
        let per = if thickness.is_some() { String::new() } else { format!("/{length}") };
        match (measure, &**force, &**length) {
            (Measure::Length, ..) => length.clone(),
            (Measure::Stress, "N", "mm") => "MPa".to_owned(),
            (Measure::Stress, "N", "m") => "Pa".to_owned(),
            (Measure::Stress, ..) => format!("{force}/{length}^2"),
            (Measure::Force, ..) => format!("{force}{per}"),
            (Measure::Moment, ..) => format!("{force} {length}{per}"),
        }
    }
}

/// An exact solution and the meshes on which it can be approximated.
#[non_exhaustive]
pub struct ExactCase {
    /// The solution.
    pub solution: Exact,
    /// The condition on each boundary.
    pub kinds: BTreeMap<String, Kind>,
    /// The mesh as a structured one, unless it came from a file.
    pub structured: Option<Structured>,
    /// The displacement of its vertices.
    pub perturbation: Option<Perturbation>,
}

impl Case {
    /// Returns whether the case itself asks for a certificate: it has quantities in \[certify\], which nothing else proves.
    pub(crate) fn asks_for_certificate(&self) -> bool {
        !self.asked.forces.is_empty()
    }

    /// The case in this file, its mesh made or read.
    ///
    /// # Errors
    /// The first mistake found, with its place. What depends on the discrete problem (rigid motions left free, kappa >= 1,
    /// expressions without a value somewhere on the mesh) is found when it is solved.
    pub fn read(file: &Path) -> Result<Case, FileError> {
        Case::parse(file, &Case::text(file)?, &[])
    }

    /// The text of this file.
    ///
    /// # Errors
    /// A file that can't be read, or is no text.
    pub fn text(file: &Path) -> Result<String, FileError> {
        text(input::read(file, MOST_OF_A_CASE)?, file)
    }

    /// The text of a stream, such as standard input, which messages call `name`.
    ///
    /// # Errors
    /// As [`Case::text`].
    pub(crate) fn text_from(stream: impl Read, name: &Path) -> Result<String, FileError> {
        let bytes = input::read_from(stream, MOST_OF_A_CASE);
        text(bytes.map_err(|error| error.at(name, Position::File))?, name)
    }

    /// The case with this text. Messages call it `file`, and a mesh file is looked for beside that. Each of the `settings`
    /// (`method.gamma0=1e-3`: a key, `=`, and a value as TOML has it) adds a key or replaces its value.
    ///
    /// # Errors
    /// As [`Case::read`]; for a mistake in a setting, the place is that setting.
    pub fn parse(file: &Path, text: &str, settings: &[String]) -> Result<Case, FileError> {
        parse(Source { file, text, settings, functions: &[] }, None)
    }

    /// The pairs of boundaries that the case with this text has, by which its mesh is checked; `functions` as in [`Case::on_mesh`].
    ///
    /// # Errors
    /// As [`Case::parse`].
    pub fn pairs(
        file: &Path,
        text: &str,
        functions: &[SharedFunction],
    ) -> Result<Vec<Pair>, FileError> {
        let source = Source { file, text, settings: &[], functions };
        let entries = source.entries(&[])?;
        Ok(pairs::of_boundaries(&pairs::read_pairs(&Table::whole(source, &entries))?))
    }

    /// The case with this text, which has no \[mesh\], on this mesh. Where the text has `"@0"`, `"@1"`, .. in place of an expression,
    /// these `functions` stand.
    ///
    /// # Errors
    /// As [`Case::parse`].
    pub fn on_mesh(
        file: &Path,
        text: &str,
        mesh: Mesh,
        functions: &[SharedFunction],
    ) -> Result<Case, FileError> {
        parse(Source { file, text, settings: &[], functions }, Some(mesh))
    }

    /// The units of these measures, if the case has units.
    pub(super) fn units_of<const N: usize>(&self, measures: [Measure; N]) -> Option<[String; N]> {
        let units = self.units.as_ref()?;
        Some(measures.map(|measure| units.of(measure, self.thickness)))
    }

    /// The words of its remarks.
    pub(super) fn words(&self) -> Words {
        let units = self.units_of([Measure::Length, Measure::Stress]);
        Words { units, known_force: None, is_step: self.step.is_some() }
    }
}

fn parse(source: Source, mesh: Option<Mesh>) -> Result<Case, FileError> {
    let layers = source.layers();
    let entries = source.entries(&layers)?;
    let count = read_steps(&Table::whole(source, &entries))?;
    let step = |i: usize| {
        let entries = source.entries_of_step(&layers, i)?;
        let step = case(source.file, &Table::whole(source, &entries), mesh.clone())?;
        Ok(Case { text: source.said(), step: Some(i + 1), ..step })
    };
    let steps = (0..count).map(step).collect::<Result<Vec<Case>, FileError>>()?;
    let whole = case(source.file, &Table::whole(source, &entries), mesh)?;
    Ok(Case { text: source.said(), steps, ..whole })
}

fn text(bytes: Vec<u8>, file: &Path) -> Result<String, FileError> {
    let wrong = |error: Failure| error.at(file, Position::File);
    // The memory of the TOML reader and the expressions.
    memory::check(MEMORY_PER_BYTE * bytes.len() as u64).map_err(|lack| wrong(lack.into()))?;
    String::from_utf8(bytes).map_err(|error| {
        let byte = error.utf8_error().valid_up_to() + 1;
        wrong(format!("byte {byte} is not UTF-8; expected a text file, saved as UTF-8").into())
    })
}

/// The bytes of memory that a byte of a case file takes at most while it is read: 241 in a list of tables of one number.
const MEMORY_PER_BYTE: u64 = 400;

/// `given` is the mesh, if it is not the case that says which.
fn case(file: &Path, root: &Table, given: Option<Mesh>) -> Result<Case, FileError> {
    root.only(&[
        "title", "mesh", "material", "load", "exact", "boundary", "obstacle", "pair", "point",
        "method", "solver", "adapt", "certify", "output", "units", "body", "step",
    ])?;
    let title = match root.get("title") {
        Some(title) => title.text()?.to_owned(),
        None => file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let mesh = root.section("mesh")?;
    let of_file = mesh.is_some_and(|mesh| mesh.get("gmsh").is_some());
    // On meshes of parts quadratic elements are nearer at equal time: the table is in docs/case.md.
    let degree = if of_file { Degree::Two } else { Degree::One };
    let default = Method { degree, ..Method::default() };
    let method = root.optional_section("method", |table| read_method(table, default.clone()));
    let method = method?.unwrap_or(default);
    let settings = root.optional_section("solver", read_settings)?.unwrap_or_default();
    let units = root.optional_section("units", read_units)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let declared = pairs::read_pairs(root)?;
    let Meshed { mesh, structured, perturbation, file: mesh_file, remarks } =
        read_mesh(root, given, folder, &pairs::of_boundaries(&declared))?;
    let mut mesh = pairs::split(mesh, &declared)?;
    let table = root.required_section("material", &format!("{} in it", body::EXPECTED))?;
    let body = root.section("body")?;
    let plane = body.as_ref().map(read_plane_of_body).transpose()?.flatten();
    let (material, materials) = read_materials(&table, &mesh, plane)?;
    let of_revolution = material.are_of_revolution();
    let thickness = body.as_ref().map(|body| read_thickness(body, of_revolution)).transpose()?;
    let thickness = if of_revolution { Some(1.0) } else { thickness.flatten() };
    let snapped = if of_revolution { mesh.snap_to_axis() } else { 0 };
    let solution = root
        .optional_section("exact", |exact| read_exact(exact, only_isotropic(&material, &table)?))?;
    let (body_force, surface_forces) = read_loads(root, solution.as_ref(), &mesh)?;
    if let (Some(pair), Some(_)) = (root.get("pair"), &solution) {
        return Err(pair.at.found("a pair beside [exact]", "the contact of the exact solution"));
    }
    let pairs = pairs::on_mesh(root, declared, &mesh, of_revolution)?;
    let depth = if of_revolution { Depth::Revolution } else { Depth::Of(thickness.unwrap_or(1.0)) };
    let (conditions, kinds) = read_boundaries(root, solution.as_ref(), &mesh, depth, &pairs)?;
    let friction = read_friction(root, of_revolution)?;
    let points = read_points(root, &mesh)?;
    let adapt = root.optional_section("adapt", |table| read_target(table, &conditions, &pairs))?;
    let asked = root.optional_section("certify", |table| read_quantities(table, &conditions))?;
    let output = root.optional_section("output", |table| read_output(table, &mesh))?;
    let (probes, stretch) = output.unwrap_or_default();
    Ok(Case {
        file: file.to_owned(),
        title,
        problem: Problem {
            mesh,
            material,
            body_force,
            surface_forces,
            conditions,
            friction,
            points,
            pairs,
            slip: Vec::new(),
        },
        steps: Vec::new(),
        step: None,
        materials,
        units,
        thickness,
        snapped,
        stretch,
        method,
        settings,
        adapt,
        asked: asked.unwrap_or_default(),
        probes,
        exact: solution.map(|solution| ExactCase { solution, kinds, structured, perturbation }),
        text: String::new(),
        remarks,
        sources: std::iter::once(file.to_owned()).chain(mesh_file).collect(),
    })
}

/// The keys of a load step: what moves and loads the body, and where obstacles are. The mesh and the method stay.
const OF_A_STEP: [&str; 6] = ["title", "boundary", "load", "pair", "obstacle", "point"];

/// The number of load steps, whose tables have no other keys than these.
fn read_steps(root: &Table) -> Result<usize, FileError> {
    let Some(all) = root.get("step") else { return Ok(0) };
    if all.is_table() {
        return Err(all.wrong("a list of tables, each under [[step]]"));
    }
    for beside in ["adapt", "exact", "certify"] {
        if root.get(beside).is_some() {
            let found = format!("[[step]] beside [{beside}]");
            return Err(all
                .at
                .found(&found, "one of both: steps are solved on one mesh, without certificates"));
        }
    }
    let steps = all.items()?;
    for step in &steps {
        let table = step.section("[[step]]".to_owned())?;
        table.only(&OF_A_STEP)?;
        for key in ["boundary", "load", "obstacle", "point"] {
            if let Some(value) = table.get(key).filter(|value| !value.is_table()) {
                return Err(
                    value.wrong("a table, such as boundary.top.displacement = [\"0.1\", \"0\"]")
                );
            }
        }
    }
    Ok(steps.len())
}

fn read_units(table: &Table) -> Result<Units, FileError> {
    table.only(&["length", "force"])?;
    // Labels of summaries, tables and pictures: one line each.
    let word = |key: &str, example: &str| table.require(key, example)?.text().map(quote::line);
    Ok(Units { length: word("length", "such as \"mm\"")?, force: word("force", "such as \"N\"")? })
}

fn read_plane_of_body(table: &Table) -> Result<Option<Plane>, FileError> {
    table.only(&["thickness", "plane"])?;
    if table.given(&["thickness", "plane"]).is_empty() {
        return Err(table.at.found("nothing", "thickness or plane"));
    }
    table.optional("plane", |plane| plane.one_of(&PLANES))
}

/// The thickness of a plane body.
fn read_thickness(table: &Table, of_revolution: bool) -> Result<Option<f64>, FileError> {
    match table.get("thickness") {
        Some(thickness) if of_revolution => Err(thickness.wrong(
            "no thickness: the results of a body of revolution are those of the whole of it",
        )),
        Some(thickness) => Ok(Some(thickness.positive()?)),
        None => Ok(None),
    }
}

/// The probes, and the amount by which the picture magnifies.
fn read_output(table: &Table, mesh: &Mesh) -> Result<(Vec<[f64; 2]>, Option<f64>), FileError> {
    table.only(&["probes", "stretch"])?;
    let stretch = table.optional("stretch", Value::positive)?;
    let probes = table.optional("probes", Value::items)?.unwrap_or_default();
    let place = |probe: &Value| {
        let place = probe.vector()?;
        match mesh.locate(place) {
            Some(_) => Ok(place),
            None => Err(probe.wrong_as(&format!("{place:?}"), "a point of the body")),
        }
    };
    Ok((probes.iter().map(place).collect::<Result<_, _>>()?, stretch))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_thickness_forces_and_moments_are_per_unit_of_it() {
        let all = [Measure::Length, Measure::Stress, Measure::Force, Measure::Moment];
        let of = |length: &str, force: &str, thickness| {
            let units = Units { length: length.to_owned(), force: force.to_owned() };
            all.map(|measure| units.of(measure, thickness))
        };
        assert_eq!(of("mm", "N", None), ["mm", "MPa", "N/mm", "N mm/mm"]);
        assert_eq!(of("m", "N", Some(2.0)), ["m", "Pa", "N", "N m"]);
        assert_eq!(of("cm", "kN", Some(1.0)), ["cm", "kN/cm^2", "kN", "kN cm"]);
    }

    #[test]
    fn the_echo_of_lame_coefficients_does_not_overflow_where_the_moduli_do_not() {
        for [lambda, mu, young, poisson] in [
            [1.0, 1.0, 2.5, 0.25],
            [1.0, 1e300, 2e300, 5e-301],
            [1e308, 1e290, 3e290, 0.5],
            [-0.5, 1.0, 1.0, -0.5],
        ] {
            let text = format!(
                "mesh.rectangle = {{ width = 2, height = 1.0, nx = 2, ny = 1 }}
                 material = {{ lambda = {lambda:e}, mu = {mu:e} }}
                 boundary.bottom.contact = {{}}"
            );
            let case = Case::parse(Path::new("x.toml"), &text, &[]).unwrap();
            let echo = &case.materials[0];
            let found = [echo.young.unwrap(), echo.poisson.unwrap()];
            // The three roundings of the quotient and of the factor of mu.
            let max_relative = 4.0 * f64::EPSILON;
            approx::assert_relative_eq!(found[0], young, max_relative = max_relative);
            approx::assert_relative_eq!(found[1], poisson, max_relative = max_relative);
        }
    }
}
