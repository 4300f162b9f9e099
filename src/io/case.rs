//! The case file: one contact problem and how to solve it, in TOML.
//!
//! ```toml
//! title = "Block pressed on a rigid floor"  # default: the name of the file
//! [mesh]                                    # required: one of rectangle, gmsh
//! rectangle = { width = 1.0, height = 1.0, nx = 32, ny = 32, diagonal = "right" }   # right (default) | left | crossed
//! # gmsh = "bracket.msh"                    # MSH 4.1, relative to this file; boundaries are its physical curves
//! # merge = 1e-6                            # beside gmsh: nodes within that share of the body's size become one
//! # trapezoid = { omega = 2.0, n = 32 }     # (0,0), (1,0), (1,1), (cot omega, 1), for the exact solution "corner"
//! # perturb = { amount = 0.2, seed = 1 }    # beside rectangle or trapezoid: vertices moved by up to so many cells
//! [material]                                # required
//! lambda = 1.0                              # lambda and mu, or young and poisson: those of the three-dimensional body
//! mu = 1.0
//! plane = "strain"                          # strain (default) | stress
//! # stiffness = [12, 3, 2, 5, -1, 2]        # or the law in the plane, C11, C12, C16, C22, C26, C66; in plane strain with
//! # across = [0.3, 0.3, 0]                  # sigma_zz = 0.3 sigma_xx + 0.3 sigma_yy
//! # orthotropic = { e1 = 12, e2 = 0.6, nu12 = 0.4, g12 = 0.7, angle = 30 }   # in plane strain with e3, nu13, nu23
//! [load]
//! body = ["0", "-4 + 10*x"]                 # force per area; expressions in x, y; default 0
//! [boundary.top]                            # the sides of a rectangle are left, right, bottom, top
//! displacement = ["0", "0"]                 # "free" for a component that is not prescribed
//! [boundary.right]
//! traction = ["0", "0"]                     # the default for a boundary that is not named
//! [boundary.bottom]                         # at least one boundary has contact
//! contact = { gap = "0" }                   # along the outward normal; default 0; or { obstacle = "floor" }
//! [method]
//! degree = 1                                # 1 (default) | 2
//! gamma0 = 0.1                              # a number > 0, or "auto" (default): half the coercivity limit
//! contact_quadrature = "exact"              # "exact" (default) or { gauss = 4 }: points per edge, 1 to 64
//! allow_noncoercive = false                 # true: solve although kappa >= 1, without any promise
//! [solver]
//! tolerance = 1e-10                         # relative residual; between 0 and 1
//! max_iterations = 200
//! [adapt]                                   # refine the mesh until the error is proved to be as small as this
//! target = "1 %"                            # of the energy norm
//! # target = { force = "bottom", within = "1 %" }   # or until the contact force lies between two numbers so near to each other
//! max_unknowns = 500000                     # the default
//! [certify]                                 # contact forces that are to be proved to second order
//! quantities = ["force bottom", "force bottom x 0 0.25 ramp 0.1"]
//! [output]
//! probes = [[0.5, 0.5]]                     # places where result.json gives the displacement
//! stretch = 50                              # the picture magnifies displacement and gap by this; default: a round factor
//! [exact]                                   # instead of [load]: a built-in exact solution, which supplies all data;
//! solution = "singular"                     # result.json then has the errors
//! c = 0.5
//! amplitude = 1.0
//! [boundary]                                # and then each boundary has a kind only: displacement, traction or contact
//! top = "displacement"
//! ```
//!
//! For parts (see docs/parts.md):
//!
//! ```toml
//! [units]                                   # words for labels, no conversion
//! length = "mm"
//! force = "N"
//! [body]
//! thickness = 10                            # across the plane: forces are then those of the whole body
//! [obstacle.floor]                          # one of plane, circle, distance
//! plane = { point = [0, 0], normal = [0, 1] }                        # the normal towards the body
//! # circle = { center = [0, 0], radius = 20, side = "outside" }      # where the body is: outside | inside
//! # distance = "sqrt(x^2 + y^2) - 20"       # signed, positive on the body's side
//! [material.steel]                          # instead of [material]: one for each physical surface of the mesh
//! young = 210000
//! poisson = 0.3
//! [load.steel]                              # a force on one physical surface, beside that of [load]
//! body = [0, -7.7e-5]
//! [boundary.bore]
//! pressure = "2 + x"                        # the traction -p n
//! [boundary.lug]
//! force = [0, -500]                         # the whole force, spread evenly over the boundary
//! [boundary.symmetry]
//! normal = 0                                # u . n at any angle; and tangential = u . t, t being n turned to the left
//! [boundary.slider]
//! displacement = [0, "free"]                # with a traction in the component that is free
//! traction = [0, -5]
//! [point.pivot]                             # a physical point of the mesh
//! displacement = [0, 0]
//! ```
//!
//! Numbers serve as expressions. The grammar of expressions is in [`expression`](super::expression), the parameters of the
//! exact solutions in `exact.rs`. A key that is not listed here is an error, and so is a list of the wrong length, a number
//! that is NaN or infinite, and a boundary with more than one of displacement, traction and contact. Integers serve as
//! numbers. The material is stable: mu > 0 and 3 lambda + 2 mu > 0, that is young > 0 and -1 < poisson < 1/2; the eigenvalues of a
//! tensor are positive.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use toml::de::DeTable;

use super::body::{self, MaterialEcho, read_loads, read_materials};
use super::boundaries::{on_the_mesh, read_boundaries, read_points};
use super::exact::read_exact;
use super::input::{self, InputError, MOST_OF_A_CASE};
use super::meshed::{Meshed, read_mesh};
use super::method::{read_method, read_quantities, read_settings, read_target};
use super::mistake::no_toml;
pub use super::mistake::{CaseError, CaseMistake, Place};
use super::setting;
use super::source::Source;
use super::table::{Table, Value};
use crate::certify::{Asked, Target};
use crate::fem::exact::Kind;
use crate::fem::{Condition, Exact, Mesh, Perturbation, Problem, Structured};
use crate::memory;
use crate::quote;
use crate::solve::{Method, Settings};

/// A contact problem and how to solve it.
#[non_exhaustive]
pub struct Case {
    /// The file it was read from, or what stands in its place.
    pub file: PathBuf,
    /// A line for people.
    pub title: String,
    /// The problem.
    pub problem: Problem,
    /// By which variant of method (8).
    pub method: Method,
    /// The accuracy.
    pub settings: Settings,
    /// How small the error is to be, if the mesh is to be adapted until that is proved.
    pub adapt: Option<Target>,
    /// The boundary whose contact force that is about, if it is not about the energy norm.
    pub adapt_force: Option<String>,
    /// Quantities to be proved beside the bound.
    pub asked: Asked,
    /// The places where the displacement is wanted.
    pub probes: Vec<[f64; 2]>,
    /// The materials as the case has them.
    pub materials: Vec<MaterialEcho>,
    /// The units of the case, if it names them.
    pub units: Option<Units>,
    /// The thickness of the body across the plane, if the case gives it.
    pub thickness: Option<f64>,
    /// The amount by which the picture magnifies displacement and gap, if the case says so.
    pub stretch: Option<f64>,
    /// The exact solution, if there is one.
    pub exact: Option<ExactCase>,
    /// The text that it was read from, with a comment for each setting laid over it.
    pub text: String,
    /// The files that all this was read from.
    pub sources: Vec<PathBuf>,
}

/// The units of a case: words for labels. The numbers are consistent by themselves.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Units {
    /// The unit of lengths.
    pub length: String,
    /// The unit of forces.
    pub force: String,
}

impl Units {
    /// The unit of forces: of the whole body if its thickness is known, else per length across the plane.
    pub fn force(&self, thickness: Option<f64>) -> String {
        let across = if thickness.is_some() { String::new() } else { format!("/{}", self.length) };
        format!("{}{across}", self.force)
    }

    /// The unit of moments and energies, likewise.
    pub fn moment(&self, thickness: Option<f64>) -> String {
        let across = if thickness.is_some() { String::new() } else { format!("/{}", self.length) };
        format!("{} {}{across}", self.force, self.length)
    }

    /// The unit of stresses.
    pub fn stress(&self) -> String {
        match (&*self.force, &*self.length) {
            ("N", "mm") => "MPa".to_owned(),
            ("N", "m") => "Pa".to_owned(),
            (force, length) => format!("{force}/{length}^2"),
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
    /// The case in this file, its mesh made or read.
    ///
    /// # Errors
    /// The first mistake found, with its place. What depends on the discrete problem (rigid motions left free, kappa >= 1,
    /// expressions without a value somewhere on the mesh) is found when it is solved.
    pub fn read(file: &Path) -> Result<Case, CaseError> {
        Case::parse(file, &Case::text(file)?, &[])
    }

    /// The text of this file.
    ///
    /// # Errors
    /// A file that can't be read, or is no text.
    pub fn text(file: &Path) -> Result<String, CaseError> {
        let bytes = input::read(file, MOST_OF_A_CASE).map_err(CaseMistake::from);
        bytes.and_then(text).map_err(|mistake| CaseError {
            file: file.to_owned(),
            place: Place::File,
            mistake: Box::new(mistake),
        })
    }

    /// The text of a stream, such as standard input, which messages call `name`.
    ///
    /// # Errors
    /// As [`Case::text`].
    pub fn text_from(stream: impl Read, name: &Path) -> Result<String, CaseError> {
        let bytes = input::read_from(stream, MOST_OF_A_CASE).map_err(CaseMistake::from);
        bytes.and_then(text).map_err(|mistake| CaseError {
            file: name.to_owned(),
            place: Place::File,
            mistake: Box::new(mistake),
        })
    }

    /// The case with this text. Messages call it `file`, and a mesh file is looked for beside that. Each of the `settings`
    /// (`method.gamma0=1e-3`: a key, `=`, and a value as TOML has it) adds a key or replaces its value.
    ///
    /// # Errors
    /// As [`Case::read`]; for a mistake in a setting, the place is that setting.
    pub fn parse(file: &Path, text: &str, settings: &[String]) -> Result<Case, CaseError> {
        parse(Source { file, text, settings }, None)
    }

    /// The case with this text, which has no \[mesh\], on this mesh.
    ///
    /// # Errors
    /// As [`Case::parse`].
    pub fn on_mesh(file: &Path, text: &str, mesh: Mesh) -> Result<Case, CaseError> {
        parse(Source { file, text, settings: &[] }, Some(mesh))
    }
}

fn parse(source: Source, mesh: Option<Mesh>) -> Result<Case, CaseError> {
    let entries = DeTable::parse(source.text).map_err(|e| {
        let start = e.span().map(|span| span.start).or_else(|| deepest(&e, source.text));
        source.wrong(start, no_toml(&e, source.text))
    })?;
    let layers = setting::layers(&source);
    let mut entries = entries.into_inner();
    setting::lay(source, &layers, &mut entries)?;
    let mut case = case(source.file, &Table::whole(source, &entries), mesh)?;
    case.text = source.text.to_owned();
    for setting in source.settings {
        case.text += &format!("# --set {}\n", setting.replace('\n', " "));
    }
    Ok(case)
}

/// Where the first key with more parts than the TOML reader takes stands: of that mistake it does not give the place.
fn deepest(error: &toml::de::Error, text: &str) -> Option<usize> {
    const MOST_PARTS: usize = 80;
    let is_deep = |line: &&str| line.matches('.').nth(MOST_PARTS - 1).is_some();
    let line = text.split('\n').find(is_deep).filter(|_| error.message() == "recursion limit")?;
    Some(line.as_ptr() as usize - text.as_ptr() as usize)
}

fn text(bytes: Vec<u8>) -> Result<String, CaseMistake> {
    // What the TOML reader and the expressions make of it.
    memory::check(MEMORY_PER_BYTE * bytes.len() as u64).map_err(InputError::from)?;
    String::from_utf8(bytes)
        .map_err(|e| CaseMistake::NoText { byte: e.utf8_error().valid_up_to() + 1 })
}

/// The bytes of memory that a byte of a case file takes at most while it is read: 241 in a list of tables of one number.
const MEMORY_PER_BYTE: u64 = 400;

/// `given` is the mesh, if it is not the case that says which.
fn case(file: &Path, root: &Table, given: Option<Mesh>) -> Result<Case, CaseError> {
    root.only(&[
        "title", "mesh", "material", "load", "exact", "boundary", "obstacle", "point", "method",
        "solver", "adapt", "certify", "output", "units", "body",
    ])?;
    let title = match root.get("title") {
        Some(title) => title.text()?.to_owned(),
        None => file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let mesh = match (given, root.section("mesh")?) {
        (Some(_), Some(table)) => {
            return Err(table.wrong(CaseMistake::Combination {
                name: table.name().to_owned(),
                found: "a mesh beside the one that is given".to_owned(),
                expected: "one of the two".to_owned(),
            }));
        }
        (Some(mesh), None) => Body::Given(mesh),
        (None, _) => {
            Body::Told(root.required_section("mesh", "rectangle = { .. } or gmsh = \"..\" in it")?)
        }
    };
    let material = root.required_section("material", &format!("{} in it", body::EXPECTED))?;
    let materials = read_materials(material)?;
    let solution = match root.section("exact")? {
        Some(table) => Some(read_exact(&table, materials.only()?)?),
        None => None,
    };
    let loads = read_loads(root, solution.as_ref())?;
    let boundaries = read_boundaries(root, solution.as_ref())?;
    let method = read_method(root.section("method")?)?;
    let settings = read_settings(root.section("solver")?)?;
    let adapt = root.section("adapt")?.map(|table| read_target(&table)).transpose()?;
    let (adapt, adapt_force) = adapt.unzip();
    let adapt_force = adapt_force.flatten();
    let quantities = root.section("certify")?.map(|table| read_quantities(&table)).transpose()?;
    let quantities = quantities.unwrap_or_default();
    let output = root.section("output")?;
    let units = root.section("units")?.map(|table| read_units(&table)).transpose()?;
    let thickness = match root.section("body")? {
        Some(table) => Some(read_thickness(&table)?),
        None => None,
    };
    let stretch = read_stretch(output.as_ref())?;
    // The mesh, and what needs it, comes last: it is what takes time.
    let Meshed { mesh, structured, perturbation, file: mesh_file } = match mesh {
        Body::Given(mesh) => Meshed { mesh, structured: None, perturbation: None, file: None },
        Body::Told(table) => read_mesh(&table, file.parent().unwrap_or(Path::new("")))?,
    };
    let kinds = boundaries.iter().filter_map(|b| Some((b.key.to_owned(), b.kind?))).collect();
    let conditions = on_the_mesh(&mesh, boundaries, thickness)?;
    let of_forces = quantities.iter().map(|(name, _, value)| (&**name, value));
    for (name, value) in of_forces.chain(adapt_force.iter().map(|(name, value)| (*name, value))) {
        if !matches!(
            conditions.get(name),
            Some(Condition::Contact { .. } | Condition::Obstacle(..))
        ) {
            return Err(value.wrong("the name of a contact boundary"));
        }
    }
    let (material, materials) = materials.on_the_mesh(&mesh)?;
    let (body_force, surface_forces) = loads.on_the_mesh(&mesh)?;
    let points = read_points(root, &mesh)?;
    let probes = read_probes(output.as_ref(), &mesh)?;
    Ok(Case {
        file: file.to_owned(),
        title,
        problem: Problem { mesh, material, body_force, surface_forces, conditions, points },
        materials,
        units,
        thickness,
        stretch,
        method,
        settings,
        adapt,
        adapt_force: adapt_force.map(|(name, _)| name.to_owned()),
        asked: Asked {
            forces: quantities.into_iter().map(|(name, weight, _)| (name, weight)).collect(),
        },
        probes,
        exact: solution.map(|solution| ExactCase { solution, kinds, structured, perturbation }),
        text: String::new(),
        sources: std::iter::once(file.to_owned()).chain(mesh_file).collect(),
    })
}

/// Where the mesh comes from.
enum Body<'s> {
    Given(Mesh),
    Told(Table<'s>),
}

fn read_units(table: &Table) -> Result<Units, CaseError> {
    table.only(&["length", "force"])?;
    // Labels of summaries, tables and pictures: one line each.
    let word = |key: &str, example: &str| table.require(key, example)?.text().map(quote::line);
    Ok(Units { length: word("length", "such as \"mm\"")?, force: word("force", "such as \"N\"")? })
}

fn read_thickness(table: &Table) -> Result<f64, CaseError> {
    table.only(&["thickness"])?;
    let expected = "a positive number";
    table.require("thickness", expected)?.number_that(|t| t > 0.0 && t.is_finite(), expected)
}

fn read_stretch(output: Option<&Table>) -> Result<Option<f64>, CaseError> {
    let Some(output) = output else { return Ok(None) };
    output.only(&["probes", "stretch"])?;
    let read = |value: Value| value.number_that(|s| s > 0.0, "a positive number");
    output.get("stretch").map(read).transpose()
}

fn read_probes(output: Option<&Table>, mesh: &Mesh) -> Result<Vec<[f64; 2]>, CaseError> {
    let Some(output) = output else { return Ok(Vec::new()) };
    let Some(probes) = output.get("probes") else { return Ok(Vec::new()) };
    let place = |probe: &Value| {
        let [x, y] = probe.pair()?;
        Ok([x.number()?, y.number()?])
    };
    let probes = probes.items()?;
    let places: Vec<[f64; 2]> = probes.iter().map(place).collect::<Result<_, CaseError>>()?;
    match places.iter().position(|&place| mesh.locate(place).is_none()) {
        None => Ok(places),
        Some(i) => Err(probes[i].wrong_as(format!("{:?}", places[i]), "a point of the body")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::Ramp;
    use crate::io::method::MOST_UNKNOWNS;
    use crate::kernel::{Material, Plane};
    use crate::solve::{ContactQuadrature, Degree, Gamma0};

    fn read(text: &str) -> Result<Case, CaseError> {
        let file = Path::new("x.toml");
        let entries = DeTable::parse(text).unwrap();
        case(file, &Table::whole(Source { file, text, settings: &[] }, entries.get_ref()), None)
    }

    const SMALL: &str = "
        mesh.rectangle = { width = 2, height = 1.0, nx = 2, ny = 1 }
        material = { young = 2.5, poisson = 0.25 }
        boundary.bottom.contact = {}
    ";

    #[test]
    fn what_is_not_said_has_its_default() {
        let case = read(SMALL).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(case.title, "x");
        assert_eq!(case.method, Method::default());
        assert_eq!(case.settings, Settings::default());
        assert!(case.probes.is_empty());
        assert_eq!(case.adapt, None);
        assert_eq!(case.problem.material, Material::young_poisson(2.5, 0.25, Plane::Strain).into());
        assert_eq!(case.problem.mesh.vertices()[5], [2.0, 1.0]);
        assert_eq!(case.problem.mesh.triangles()[0], [0, 1, 4], "the diagonal is right");
        assert_eq!(case.problem.body_force.each_ref().map(|f| f.degree()), [Some(0); 2]);
        assert_eq!(case.problem.conditions.len(), 1);
        let Some(Condition::Contact { gap }) = case.problem.conditions.get("bottom") else {
            panic!("no contact")
        };
        assert_eq!((gap.degree(), gap.at([0.5, 0.5])), (Some(0), 0.0));
    }

    #[test]
    fn everything_that_can_be_said_is_read() {
        let case = read(
            r#"
            title = "All"
            [mesh]
            rectangle = { width = 2, height = 1.0, nx = 2, ny = 1, diagonal = "crossed" }
            [material]
            lambda = -0.5
            mu = 1
            plane = "stress"
            [load]
            body = ["x", "-4 + 10*y"]
            [boundary.left]
            displacement = ["y", "free"]
            [boundary.top]
            traction = ["0", "-x"]
            [boundary.bottom]
            contact = { gap = "0.1*x^2" }
            [method]
            degree = 2
            gamma0 = 1
            contact_quadrature = { gauss = 4 }
            allow_noncoercive = true
            [solver]
            tolerance = 1e-8
            max_iterations = 7
            proof = 1e-7
            [output]
            probes = [[0, 1], [0.5, 0.25]]
            "#,
        )
        .unwrap_or_else(|e| panic!("{e}"));
        let p = [2.0, 3.0];
        assert_eq!(case.title, "All");
        assert_eq!(case.problem.mesh.triangles().len(), 8);
        assert_eq!(case.problem.material, Material::lame(-0.5, 1.0, Plane::Stress).into());
        assert_eq!(case.problem.body_force.each_ref().map(|f| f.at(p)), [2.0, 26.0]);
        let conditions = &case.problem.conditions;
        let Condition::Displacement([Some(x), None]) = &conditions["left"] else { panic!() };
        let Condition::Traction([_, y]) = &conditions["top"] else { panic!() };
        let Condition::Contact { gap } = &conditions["bottom"] else { panic!() };
        assert_eq!([x.at(p), y.at(p), gap.at(p)], [3.0, -2.0, 0.4]);
        assert_eq!(
            case.method,
            Method {
                degree: Degree::Two,
                gamma0: Gamma0::Value(1.0),
                quadrature: ContactQuadrature::Gauss(4),
                allow_noncoercive: true,
            }
        );
        assert_eq!(case.settings, Settings { tolerance: 1e-8, max_iterations: 7, proof: 1e-7 });
        assert_eq!(case.probes, [[0.0, 1.0], [0.5, 0.25]]);
    }

    #[test]
    fn the_echo_of_lame_coefficients_does_not_overflow_where_the_moduli_do_not() {
        for [lambda, mu, young, poisson] in [
            [1.0, 1.0, 2.5, 0.25],
            [1.0, 1e300, 2e300, 5e-301],
            [1e308, 1e290, 3e290, 0.5],
            [-0.5, 1.0, 1.0, -0.5],
        ] {
            let material = format!("{{ lambda = {lambda:e}, mu = {mu:e} }}");
            let text = SMALL.replace("{ young = 2.5, poisson = 0.25 }", &material);
            let case = read(&text).unwrap_or_else(|e| panic!("{e}"));
            let echo = &case.materials[0];
            // The three roundings of the quotient and of the factor of mu.
            approx::assert_relative_eq!(
                echo.young.unwrap(),
                young,
                max_relative = 4.0 * f64::EPSILON
            );
            approx::assert_relative_eq!(
                echo.poisson.unwrap(),
                poisson,
                max_relative = 4.0 * f64::EPSILON
            );
        }
    }

    #[test]
    fn a_target_is_a_share_in_percent() {
        let with = |adapt: &str| read(&format!("{SMALL}\n{adapt}")).map(|case| case.adapt);
        let target = with("adapt.target = \"0.5 %\"").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(target, Some(Target { relative: 0.005, max_unknowns: MOST_UNKNOWNS }));
        for wrong in ["\"0 %\"", "\"100 %\"", "\"1\"", "0.01", "\"%\"", "\"nan %\""] {
            let error = with(&format!("adapt.target = {wrong}")).unwrap_err().to_string();
            assert!(error.contains("such as \"1 %\""), "{error}");
        }
        let error = with("adapt.max_unknowns = 10").unwrap_err().to_string();
        assert!(error.contains("target"), "{error}");
    }

    #[test]
    fn a_target_may_be_a_force_and_forces_are_asked_for_by_their_boundary() {
        let with = |settings: &str| read(&format!("{SMALL}\n{settings}"));
        let case = with("adapt.target = { force = \"bottom\", within = \"0.1 %\" }").unwrap();
        assert_eq!(case.adapt.map(|target| target.relative), Some(0.001));
        assert_eq!(case.adapt_force.as_deref(), Some("bottom"));
        let case =
            with("certify.quantities = [\"force bottom\", \"force bottom x 0 0.25 ramp 0.1\"]");
        let ramp = Ramp { axis: 0, between: [0.0, 0.25], width: 0.1 };
        let expected = [None, Some(ramp)].map(|weight| ("bottom".to_owned(), weight));
        assert_eq!(case.unwrap().asked.forces, expected);
        for (wrong, expected) in [
            ("adapt.target = { force = \"top\", within = \"0.1 %\" }", "contact boundary"),
            ("adapt.target = { force = \"bottom\" }", "within"),
            ("certify.quantities = [\"force top\"]", "contact boundary"),
            ("certify.quantities = [\"peak bottom\"]", "force NAME"),
            ("certify.quantities = [\"force bottom x 1 0 ramp 0.1\"]", "force NAME"),
            ("certify.quantities = [\"force bottom z 0 1 ramp 0.1\"]", "force NAME"),
            ("certify.quantities = [\"force bottom x 0 1 ramp 0\"]", "force NAME"),
        ] {
            let error = with(wrong).err().unwrap().to_string();
            assert!(error.contains(expected), "{wrong}: {error}");
        }
    }

    #[test]
    fn every_committed_case_can_be_read() {
        let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
        let mut count = 0;
        for file in std::fs::read_dir(cases).unwrap().map(|entry| entry.unwrap().path()) {
            if file.extension().is_some_and(|e| e == "toml") {
                Case::read(&file).unwrap_or_else(|e| panic!("{e}"));
                count += 1;
            }
        }
        assert!(count >= 4);
    }
}
