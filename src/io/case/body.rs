//! The tables \[material\] and \[load\] of a case file, for the whole body or for its physical surfaces one by one.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::table::{Spot, Table, Value};
use crate::exact::{self, Exact};
use crate::io::expression::Expression;
use crate::io::input::FileError;
use crate::kernel::{Material, Plane};
use crate::model::material::{
    Across, MaterialError, Orthotropic, largest_entry, stable, stable_orthotropic,
};
use crate::model::{Materials, Mesh, SharedFunction, SurfaceForce};
use crate::quote::{self, key as shown, quoted};

const MODULI: [&str; 6] = ["lambda", "mu", "young", "poisson", "stiffness", "orthotropic"];

const KEYS: [&str; 8] =
    ["lambda", "mu", "young", "poisson", "stiffness", "across", "orthotropic", "plane"];

/// The moduli that a material may be given by.
pub(super) const EXPECTED: &str = "lambda and mu, young and poisson, stiffness, or orthotropic";

pub(super) const PLANES: [(&str, Plane); 3] =
    [("strain", Plane::Strain), ("stress", Plane::Stress), ("axisymmetric", Plane::Axisymmetric)];

/// A material as the case has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub(crate) struct MaterialEcho {
    /// The physical surfaces made of it; none if the mesh has no named surface.
    pub(crate) surfaces: Vec<String>,
    /// Young's modulus of a material that is isotropic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) young: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) poisson: Option<f64>,
    /// `[C11, C12, C16, C22, C26, C66]` of one that is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) stiffness: Option<[f64; 6]>,
    /// "strain", "stress" or "axisymmetric".
    pub(crate) plane: String,
}

impl MaterialEcho {
    fn new(material: &Material<f64>, moduli: Option<[f64; 2]>) -> Self {
        let stiffness = moduli.is_none().then(|| material.stiffness());
        let [young, poisson] = [0, 1].map(|k| moduli.map(|moduli| moduli[k]));
        let plane = PLANES.into_iter().find(|(_, plane)| *plane == material.plane());
        let plane = plane.map_or("", |(name, _)| name).to_owned();
        MaterialEcho { surfaces: Vec::new(), young, poisson, stiffness, plane }
    }

    /// The largest of the numbers that it is given by, but for Poisson's ratio.
    pub(in crate::io) fn stiffest(&self) -> f64 {
        let entries = self.stiffness.iter().flatten().chain(&self.young);
        entries.fold(0.0, |most: f64, c| most.max(c.abs()))
    }
}

/// The material of each triangle, and the materials as the case has them: one for the whole body, or one for each physical
/// surface of the mesh. `of_body` is the plane that the table of the body says.
pub(super) fn read_materials(
    table: &Table,
    mesh: &Mesh,
    of_body: Option<Plane>,
) -> Result<(Materials, Vec<MaterialEcho>), FileError> {
    let default = of_body.unwrap_or(Plane::Strain);
    let mut surfaces = table.keys_of_tables();
    surfaces.retain(|key| !KEYS.contains(key));
    let Some(first) = surfaces.first().map(|key| table.under_header(key).name) else {
        let (material, echo) = read_material(table, default)?;
        agrees(table, of_body, &echo)?;
        let surfaces = mesh.surfaces().keys().cloned().collect();
        return Ok((material.into(), vec![MaterialEcho { surfaces, ..echo }]));
    };
    if let Some(key) = table.keys().find(|key| MODULI.contains(key)) {
        let expected = "one material for the whole body, or one for each physical surface";
        return Err(table.at.found(&format!("{key} beside {first}"), expected));
    }
    table.only(&[&surfaces[..], &["plane"]].concat())?;
    let plane = read_plane(table, default)?;
    let mut parts: Vec<(Material<f64>, &[usize])> = Vec::new();
    let mut echoes: Vec<MaterialEcho> = Vec::new();
    for &key in &surfaces {
        let one = table.subsection(key)?;
        let (material, echo) = read_material(&one, plane)?;
        agrees(&one, of_body, &echo)?;
        if let Some(other) = echoes.first()
            && other.plane != echo.plane
        {
            let found = format!("plane {} beside plane {} in {first}", echo.plane, other.plane);
            return Err(one.at.found(&found, "the same for the whole body"));
        }
        parts.push((material, on_surface(mesh, &one.at, key)?));
        echoes.push(MaterialEcho { surfaces: vec![key.to_owned()], ..echo });
    }
    let mut covered: Vec<Option<usize>> = vec![None; mesh.triangles().len()];
    for (part, (_, triangles)) in parts.iter().enumerate() {
        for &t in *triangles {
            if let Some(first) = covered[t].replace(part) {
                let [first, second] = [first, part].map(|part| quoted(surfaces[part], '\''));
                let [x, y] = centre(mesh, t);
                let found = format!(
                    "materials for the surfaces {first} and {second}, which share a triangle around ({x}, {y})"
                );
                return Err(table.at.found(&found, "one material for each triangle"));
            }
        }
    }
    if let Some(t) = covered.iter().position(|part| part.is_none()) {
        if let Some((name, _)) = mesh.surfaces().iter().find(|(_, of)| of.contains(&t)) {
            let found = format!("no material for the surface {}", quoted(name, '\''));
            return Err(table.at.found(&found, &format!("[material.{}]", shown(name))));
        }
        let [x, y] = centre(mesh, t);
        let found = format!("a triangle around ({x}, {y}) that belongs to no physical surface");
        let expected = "all of the body in physical surfaces with a material each";
        return Err(table.at.found(&found, expected));
    }
    Ok((Materials::in_parts(parts[0].0, covered.len(), parts), echoes))
}

/// The centre of a triangle, in words.
fn centre(mesh: &Mesh, t: usize) -> [String; 2] {
    <[f64; 2]>::from(mesh.triangle(t).point([1.0 / 3.0; 3])).map(quote::number)
}

/// The one isotropic material of the body, which an exact solution needs; `table` is \[material\].
pub(super) fn only_isotropic(
    materials: &Materials,
    table: &Table,
) -> Result<Material<f64>, FileError> {
    let (found, expected) = match materials.only() {
        Some(material) if material.plane() == Plane::Axisymmetric => {
            ("a body of revolution", "a plane body: the exact solutions are plane")
        }
        Some(material) if material.is_isotropic() => return Ok(*material),
        Some(_) => ("a material that is not isotropic", "lambda and mu, or young and poisson"),
        None => ("materials by surface", "one material for the whole body"),
    };
    Err(table.at.found(&format!("{found} beside [exact]"), expected))
}

/// The triangles of a surface, of which there must be some.
fn on_surface<'m>(mesh: &'m Mesh, at: &Spot, key: &str) -> Result<&'m [usize], FileError> {
    match mesh.surface(key) {
        Err(error) => Err(at.about(error)),
        Ok([]) => Err(at.found("no triangle in this mesh", "at least one")),
        Ok(triangles) => Ok(triangles),
    }
}

/// Checks that a material has the plane of the body, if its table says one.
fn agrees(table: &Table, of_body: Option<Plane>, echo: &MaterialEcho) -> Result<(), FileError> {
    match PLANES.iter().find(|(_, plane)| of_body == Some(*plane)) {
        Some((name, _)) if *name != echo.plane => {
            let found = format!("plane {} beside [body] plane {name}", echo.plane);
            Err(table.at.found(&found, "the same, or one of the two"))
        }
        _ => Ok(()),
    }
}

fn read_plane(table: &Table, default: Plane) -> Result<Plane, FileError> {
    Ok(table.optional("plane", |plane| plane.one_of(&PLANES))?.unwrap_or(default))
}

fn read_material(table: &Table, plane: Plane) -> Result<(Material<f64>, MaterialEcho), FileError> {
    table.only(&KEYS)?;
    let plane = read_plane(table, plane)?;
    let isotropic = |material, moduli| (material, MaterialEcho::new(&material, Some(moduli)));
    let tensor = |material| (material, MaterialEcho::new(&material, None));
    let value = |key| table.require(key, EXPECTED);
    let (material, echo) = match table.given(&MODULI)[..] {
        ["lambda", "mu"] => {
            let mu = value("mu")?.positive()?;
            let least = quote::number(-2.0 / 3.0 * mu);
            let expected = format!("a number above {least}, for 3 lambda + 2 mu > 0");
            let lambda = value("lambda")?.number_that(|l| 3.0 * l + 2.0 * mu > 0.0, &expected)?;
            // E = mu (3 lambda + 2 mu) / (lambda + mu) and nu = lambda / (2 (lambda + mu)), so that nothing overflows that
            // need not.
            let ratio = lambda / (lambda + mu);
            isotropic(Material::lame(lambda, mu, plane), [mu * (2.0 + ratio), ratio / 2.0])
        }
        ["young", "poisson"] => {
            let young = value("young")?.positive()?;
            let expected = "a number above -1 and below 0.5";
            let poisson = value("poisson")?.number_that(|nu| -1.0 < nu && nu < 0.5, expected)?;
            isotropic(Material::young_poisson(young, poisson, plane), [young, poisson])
        }
        ["stiffness"] => {
            let across = match (plane, table.get("across")) {
                (Plane::Strain, Some(across)) => Some(numbers(&across, ACROSS)?),
                (Plane::Stress, None) => None,
                (Plane::Strain, None) => {
                    return Err(table.at.found("stiffness in plane strain without across", TELLS));
                }
                (Plane::Stress, Some(_)) => {
                    return Err(table.at.found("across in plane stress", "plane strain with it"));
                }
                (Plane::Axisymmetric, _) => {
                    let found = "stiffness in a body of revolution";
                    return Err(table.at.found(found, "orthotropic, whose third axis is the hoop"));
                }
            };
            let stiffness = value("stiffness")?;
            let entries = numbers(&stiffness, SIX)?;
            let material = stable(Material::tensor(entries, across));
            tensor(material.map_err(|error| stiffness.at.about(error.to_string()))?)
        }
        ["orthotropic"] => tensor(read_orthotropic(&value("orthotropic")?, plane)?),
        _ => return Err(table.combination(&MODULI, EXPECTED)),
    };
    if table.get("across").is_some() && table.get("stiffness").is_none() {
        return Err(table.at.found("across without stiffness", "both, or neither"));
    }
    let stiffness = largest_entry(&material);
    if stiffness > 0.0 && stiffness.is_finite() {
        Ok((material, echo))
    } else {
        let found =
            format!("moduli with lambda + 2 mu = {} in the plane", quote::number(stiffness));
        Err(table.at.found(&found, "a positive finite sum; choose other units"))
    }
}

const SIX: &str = "a list of six numbers: C11, C12, C16, C22, C26, C66";

const ACROSS: &str =
    "a list of three numbers a, b, c: sigma_zz = a sigma_xx + b sigma_yy + c sigma_xy";

const TELLS: &str = "plane = \"stress\", or across = [a, b, c] with sigma_zz = a sigma_xx + b sigma_yy + c sigma_xy";

fn numbers<const N: usize>(list: &Value, expected: &str) -> Result<[f64; N], FileError> {
    let items = list.items()?;
    let all = items.iter().map(Value::number).collect::<Result<Vec<f64>, _>>()?;
    all.try_into().map_err(|_| list.wrong(expected))
}

/// Moduli along and across an axis: in plane strain those across the plane, too.
fn read_orthotropic(moduli: &Value, plane: Plane) -> Result<Material<f64>, FileError> {
    let table = moduli.table()?;
    let mut keys = vec!["e1", "e2", "nu12", "g12", "angle"];
    if plane != Plane::Stress {
        keys.extend(["e3", "nu13", "nu23"]);
    }
    table.only(&keys)?;
    let number = |key, expected| table.require(key, expected)?.number();
    let across = |expected| {
        let out = |key| number(key, expected);
        Ok(Some(Across { e3: out("e3")?, nu13: out("nu13")?, nu23: out("nu23")? }))
    };
    let across = match plane {
        Plane::Stress => None,
        Plane::Strain => across("a number, in plane strain")?,
        Plane::Axisymmetric => across("a number, in a body of revolution")?,
    };
    let angle = table.optional("angle", Value::number)?.unwrap_or(0.0);
    let [e1, e2, nu12, g12] = ["e1", "e2", "nu12", "g12"].map(|key| number(key, "a number"));
    let (e1, e2, nu12, g12) = (e1?, e2?, nu12?, g12?);
    let material = stable_orthotropic(Orthotropic { e1, e2, nu12, g12, angle, across });
    let unstable = |error: MaterialError| moduli.at.about(error.to_string());
    let Some(Across { e3, .. }) = across.filter(|_| plane == Plane::Axisymmetric) else {
        return material.map_err(unstable);
    };
    if angle % 90.0 != 0.0 {
        let expected = "a multiple of 90: in a body of revolution the axes of a material are r, z and the hoop";
        return Err(moduli.at.found(&format!("angle {}", quote::number(angle)), expected));
    }
    material.and_then(|material| stable(material.of_revolution(e3))).map_err(unstable)
}

/// The force on the whole body, and those on its surfaces; an exact solution has its own.
pub(super) fn read_loads(
    root: &Table,
    solution: Option<&Exact>,
    mesh: &Mesh,
) -> Result<([SharedFunction; 2], Vec<SurfaceForce>), FileError> {
    let none = || [constant(0.0), constant(0.0)];
    let Some(table) = root.section("load")? else {
        return Ok((solution.map_or_else(none, exact::body_force), Vec::new()));
    };
    if solution.is_some() {
        let expected = "one of the two: an exact solution supplies its own";
        return Err(table.at.found("loads beside [exact]", expected));
    }
    let surfaces = table.keys_of_tables();
    table.only(&[&["body"], surfaces.as_slice()].concat())?;
    let mut forces = Vec::new();
    for key in surfaces {
        let one = table.subsection(key)?;
        one.only(&["body"])?;
        let force = one.require("body", "a list of two: one for x, one for y")?.functions()?;
        let triangles = on_surface(mesh, &one.at, key)?.to_vec();
        forces.push(SurfaceForce { surface: key.to_owned(), triangles, force });
    }
    Ok((table.optional("body", Value::functions)?.unwrap_or_else(none), forces))
}

pub(super) fn constant(value: f64) -> SharedFunction {
    Arc::new(Expression::from(value))
}
