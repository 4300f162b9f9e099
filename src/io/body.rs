//! Materials and loads of the body: `[material]` and `[load]` of a case file, for the whole body or for its
//! physical surfaces one by one.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::expression::Expression;
use super::input::FileError;
use super::table::{Spot, Table, Value};
use crate::fem::exact;
use crate::fem::material::{
    Across, MaterialError, Orthotropic, largest_entry, stable, stable_orthotropic,
};
use crate::fem::{Exact, Materials, Mesh, SharedFunction, SurfaceForce};
use crate::kernel::{Material, Plane};
use crate::quote::{self, key as shown, quoted};

const MODULI: [&str; 6] = ["lambda", "mu", "young", "poisson", "stiffness", "orthotropic"];

const KEYS: [&str; 8] =
    ["lambda", "mu", "young", "poisson", "stiffness", "across", "orthotropic", "plane"];

/// The moduli that a material may be given by.
pub(super) const EXPECTED: &str = "lambda and mu, young and poisson, stiffness, or orthotropic";

/// A material as the case has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MaterialEcho {
    /// The physical surfaces made of it; none if the mesh has no named surface.
    pub surfaces: Vec<String>,
    /// Young's modulus of a material that is isotropic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub young: Option<f64>,
    /// Its Poisson's ratio.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poisson: Option<f64>,
    /// `[C11, C12, C16, C22, C26, C66]` of one that is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<[f64; 6]>,
    /// "strain" or "stress".
    pub plane: String,
}

impl MaterialEcho {
    fn new(material: &Material<f64>, moduli: Option<[f64; 2]>) -> Self {
        let stiffness = moduli.is_none().then(|| material.stiffness());
        let [young, poisson] = [0, 1].map(|k| moduli.map(|moduli| moduli[k]));
        let plane = if material.plane() == Plane::Strain { "strain" } else { "stress" }.to_owned();
        MaterialEcho { surfaces: Vec::new(), young, poisson, stiffness, plane }
    }

    /// The largest of the numbers that it is given by, but for Poisson's ratio.
    pub(super) fn stiffest(&self) -> f64 {
        let entries = self.stiffness.iter().flatten().chain(&self.young);
        entries.fold(0.0, |most: f64, c| most.max(c.abs()))
    }
}

/// A material of one surface: where it stands, and the surface.
type OfSurface<'s> = (Spot<'s>, &'s str, Material<f64>, MaterialEcho);

/// The materials as read, not yet on a mesh.
pub(super) enum MaterialTable<'s> {
    Whole(Spot<'s>, Material<f64>, MaterialEcho),
    BySurface { at: Spot<'s>, materials: Vec<OfSurface<'s>> },
}

pub(super) fn read_materials<'s>(table: Table<'s>) -> Result<MaterialTable<'s>, FileError> {
    let mut known = table.keys_of_tables();
    known.retain(|key| !KEYS.contains(key));
    let Some(first) = known.first().map(|key| table.under_header(key).name) else {
        let (material, echo) = read_material(&table, Plane::Strain)?;
        return Ok(MaterialTable::Whole(table.at, material, echo));
    };
    if let Some(key) = table.keys().find(|key| MODULI.contains(key)) {
        let expected = "one material for the whole body, or one for each physical surface";
        return Err(table.at.found(&format!("{key} beside {first}"), expected));
    }
    let surfaces = known.clone();
    known.push("plane");
    table.only(&known)?;
    let plane = read_plane(&table, Plane::Strain)?;
    let mut materials: Vec<OfSurface> = Vec::new();
    for key in surfaces {
        let one = table.subsection(key)?;
        let (material, echo) = read_material(&one, plane)?;
        if let Some((.., other)) = materials.first()
            && other.plane != echo.plane
        {
            let found = format!("plane {} beside plane {} in {first}", echo.plane, other.plane);
            return Err(one.at.found(&found, "the same for the whole body"));
        }
        materials.push((one.at, key, material, echo));
    }
    Ok(MaterialTable::BySurface { at: table.at, materials })
}

impl MaterialTable<'_> {
    /// The one material of the whole body, if there is one.
    pub fn only(&self) -> Result<Material<f64>, FileError> {
        let (at, found, expected) = match self {
            MaterialTable::Whole(_, material, _) if material.is_isotropic() => {
                return Ok(*material);
            }
            MaterialTable::Whole(at, ..) => {
                (at, "a material that is not isotropic", "lambda and mu, or young and poisson")
            }
            MaterialTable::BySurface { at, .. } => {
                (at, "materials by surface", "one material for the whole body")
            }
        };
        Err(at.found(&format!("{found} beside [exact]"), expected))
    }

    /// The material of each triangle: each has exactly one, each surface of the mesh its own.
    pub fn on_the_mesh(self, mesh: &Mesh) -> Result<(Materials, Vec<MaterialEcho>), FileError> {
        let (at, materials) = match self {
            MaterialTable::Whole(_, material, echo) => {
                let surfaces = mesh.surfaces().keys().cloned().collect();
                return Ok((material.into(), vec![MaterialEcho { surfaces, ..echo }]));
            }
            MaterialTable::BySurface { at, materials } => (at, materials),
        };
        let mut covered = vec![false; mesh.triangles().len()];
        let mut parts = Vec::new();
        let mut echoes = Vec::new();
        for (at, key, material, echo) in &materials {
            let triangles = on_surface(mesh, at, key)?;
            triangles.iter().for_each(|&t| covered[t] = true);
            parts.push((*material, triangles));
            echoes.push(MaterialEcho { surfaces: vec![(*key).to_owned()], ..echo.clone() });
        }
        let without = |name: &&String| materials.iter().all(|(_, key, ..)| key != name);
        if let Some(name) = mesh.surfaces().keys().find(without) {
            let found = format!("no material for the surface {}", quoted(name, '\''));
            return Err(at.found(&found, &format!("[material.{}]", shown(name))));
        }
        if let Some(t) = covered.iter().position(|covered| !covered) {
            let place: [f64; 2] = mesh.triangle(t).point([1.0 / 3.0; 3]).into();
            let [x, y] = place.map(quote::number);
            let found = format!("a triangle around ({x}, {y}) that belongs to no physical surface");
            let expected = "all of the body in physical surfaces with a material each";
            return Err(at.found(&found, expected));
        }
        let rest = materials[0].2;
        Ok((Materials::in_parts(rest, covered.len(), parts), echoes))
    }
}

/// The triangles of a surface, of which there must be some.
fn on_surface<'m>(mesh: &'m Mesh, at: &Spot, key: &str) -> Result<&'m [usize], FileError> {
    match mesh.surface(key) {
        Err(error) => Err(at.mesh(error)),
        Ok([]) => Err(at.found("no triangle in this mesh", "at least one")),
        Ok(triangles) => Ok(triangles),
    }
}

fn read_plane(table: &Table, default: Plane) -> Result<Plane, FileError> {
    let planes = [("strain", Plane::Strain), ("stress", Plane::Stress)];
    Ok(table.optional("plane", |plane| plane.one_of(&planes))?.unwrap_or(default))
}

fn read_material(table: &Table, plane: Plane) -> Result<(Material<f64>, MaterialEcho), FileError> {
    table.only(&KEYS)?;
    let plane = read_plane(table, plane)?;
    let isotropic = |material, moduli| (material, MaterialEcho::new(&material, Some(moduli)));
    let tensor = |material| (material, MaterialEcho::new(&material, None));
    let (material, echo) = match MODULI.map(|key| table.get(key)) {
        [Some(lambda), Some(mu), None, None, None, None] => {
            let mu = mu.positive()?;
            let least = quote::number(-2.0 / 3.0 * mu);
            let expected = format!("a number above {least}, for 3 lambda + 2 mu > 0");
            let lambda = lambda.number_that(|l| 3.0 * l + 2.0 * mu > 0.0, &expected)?;
            // E = mu (3 lambda + 2 mu) / (lambda + mu) and nu = lambda / (2 (lambda + mu)), so that nothing overflows that
            // need not.
            let ratio = lambda / (lambda + mu);
            isotropic(Material::lame(lambda, mu, plane), [mu * (2.0 + ratio), ratio / 2.0])
        }
        [None, None, Some(young), Some(poisson), None, None] => {
            let young = young.positive()?;
            let expected = "a number above -1 and below 0.5";
            let poisson = poisson.number_that(|nu| -1.0 < nu && nu < 0.5, expected)?;
            isotropic(Material::young_poisson(young, poisson, plane), [young, poisson])
        }
        [None, None, None, None, Some(stiffness), None] => {
            let across = match (plane, table.get("across")) {
                (Plane::Strain, Some(across)) => Some(numbers(&across, ACROSS)?),
                (Plane::Stress, None) => None,
                (Plane::Strain, None) => {
                    return Err(table.at.found("stiffness in plane strain without across", TELLS));
                }
                (Plane::Stress, Some(_)) => {
                    return Err(table.at.found("across in plane stress", "plane strain with it"));
                }
            };
            tensor(checked(
                &stiffness,
                stable(Material::tensor(numbers(&stiffness, SIX)?, across)),
            )?)
        }
        [None, None, None, None, None, Some(moduli)] => {
            tensor(checked(&moduli, read_orthotropic(&moduli, plane)?)?)
        }
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

/// A list of `N` numbers.
fn numbers<const N: usize>(list: &Value, expected: &str) -> Result<[f64; N], FileError> {
    let items = list.items()?;
    let all = items.iter().map(Value::number).collect::<Result<Vec<f64>, _>>()?;
    all.try_into().map_err(|_| list.wrong(expected))
}

/// The material, or the reason why there is none, at the place of its moduli.
fn checked(
    moduli: &Value,
    material: Result<Material<f64>, MaterialError>,
) -> Result<Material<f64>, FileError> {
    material.map_err(|error| moduli.at.wrong(format!("{}: {error}", moduli.at.name)))
}

/// Moduli along and across an axis: in plane strain those across the plane, too.
fn read_orthotropic(
    moduli: &Value,
    plane: Plane,
) -> Result<Result<Material<f64>, MaterialError>, FileError> {
    let table = moduli.table()?;
    let mut keys = vec!["e1", "e2", "nu12", "g12", "angle"];
    if plane == Plane::Strain {
        keys.extend(["e3", "nu13", "nu23"]);
    }
    table.only(&keys)?;
    let across = match plane {
        Plane::Stress => None,
        Plane::Strain => {
            let expected = "a number, in plane strain";
            let number = |key| table.require(key, expected)?.number();
            Some(Across { e3: number("e3")?, nu13: number("nu13")?, nu23: number("nu23")? })
        }
    };
    let number = |key| table.require(key, "a number")?.number();
    let angle = table.optional("angle", Value::number)?.unwrap_or(0.0);
    let [e1, e2, nu12, g12] = [number("e1")?, number("e2")?, number("nu12")?, number("g12")?];
    Ok(stable_orthotropic(Orthotropic { e1, e2, nu12, g12, angle, across }))
}

/// A body force on one surface: where it stands, the surface, and f.
type OnSurface<'s> = (Spot<'s>, &'s str, [SharedFunction; 2]);

/// The loads as read, not yet on a mesh.
pub(super) struct LoadTable<'s> {
    body: [SharedFunction; 2],
    by_surface: Vec<OnSurface<'s>>,
}

pub(super) fn read_loads<'s>(
    root: &Table<'s>,
    solution: Option<&Exact>,
) -> Result<LoadTable<'s>, FileError> {
    let table = root.section("load")?;
    let mut by_surface = Vec::new();
    if let (Some(_), Some(table)) = (solution, &table) {
        let expected = "one of the two: an exact solution supplies its own";
        return Err(table.at.found("loads beside [exact]", expected));
    }
    let Some(table) = table else {
        let body = solution.map_or_else(|| [constant(0.0), constant(0.0)], exact::body_force);
        return Ok(LoadTable { body, by_surface });
    };
    let surfaces = table.keys_of_tables();
    table.only(&[&["body"], surfaces.as_slice()].concat())?;
    for key in surfaces {
        let one = table.subsection(key)?;
        one.only(&["body"])?;
        let body = one.require("body", "a list of two: one for x, one for y")?.functions()?;
        by_surface.push((one.at, key, body));
    }
    let body = table.optional("body", Value::functions)?;
    Ok(LoadTable { body: body.unwrap_or_else(|| [constant(0.0), constant(0.0)]), by_surface })
}

impl LoadTable<'_> {
    /// The forces on single surfaces, on their triangles.
    pub fn on_the_mesh(
        self,
        mesh: &Mesh,
    ) -> Result<([SharedFunction; 2], Vec<SurfaceForce>), FileError> {
        let mut forces = Vec::new();
        for (at, key, force) in self.by_surface {
            let triangles = on_surface(mesh, &at, key)?.to_vec();
            forces.push(SurfaceForce { surface: key.to_owned(), triangles, force });
        }
        Ok((self.body, forces))
    }
}

pub(super) fn constant(value: f64) -> SharedFunction {
    Arc::new(Expression::from(value))
}
