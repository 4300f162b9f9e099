//! Materials and loads of the body: `[material]` and `[load]` of a case file, for the whole body or for its
//! physical surfaces one by one.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::expression::Expression;
use super::mistake::{CaseError, CaseMistake};
use super::table::{Table, Value};
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

/// The materials as read, not yet on a mesh.
pub(super) enum MaterialTable<'s> {
    Whole(Table<'s>, Material<f64>, MaterialEcho),
    BySurface {
        table: Table<'s>,
        materials: Vec<(Value<'s>, &'s str, Material<f64>, MaterialEcho)>,
    },
}

/// Returns whether the key of `[material]` is the name of a surface.
fn is_a_surface(table: &Table, key: &str) -> bool {
    !KEYS.contains(&key) && table.get(key).is_some_and(|value| value.is_table())
}

pub(super) fn read_materials<'s>(table: Table<'s>) -> Result<MaterialTable<'s>, CaseError> {
    let named: Vec<&str> = table.keys().filter(|key| is_a_surface(&table, key)).collect();
    if named.is_empty() {
        table.only(&KEYS)?;
        let (material, echo) = read_material(&table, Plane::Strain)?;
        return Ok(MaterialTable::Whole(table, material, echo));
    }
    if let Some(key) = table.keys().find(|key| MODULI.contains(key)) {
        return Err(table.wrong(CaseMistake::Combination {
            name: table.name().to_owned(),
            found: format!("{key} beside [material.{}]", shown(named[0])),
            expected: "one material for the whole body, or one for each physical surface"
                .to_owned(),
        }));
    }
    let mut known = named.clone();
    known.push("plane");
    table.only(&known)?;
    let plane = read_plane(&table, Plane::Strain)?;
    let mut materials: Vec<(Value<'s>, &'s str, Material<f64>, MaterialEcho)> = Vec::new();
    for key in named {
        let value = table.require(key, "a table")?;
        let one = value.section(format!("[material.{}]", shown(key)))?;
        one.only(&KEYS)?;
        let (material, echo) = read_material(&one, plane)?;
        if let Some((_, other, _, first)) = materials.first()
            && first.plane != echo.plane
        {
            return Err(one.wrong(CaseMistake::Combination {
                name: one.name().to_owned(),
                found: format!(
                    "plane {} beside plane {} in [material.{}]",
                    echo.plane,
                    first.plane,
                    shown(other)
                ),
                expected: "the same for the whole body".to_owned(),
            }));
        }
        materials.push((value, key, material, echo));
    }
    Ok(MaterialTable::BySurface { table, materials })
}

impl MaterialTable<'_> {
    /// The one material of the whole body, if there is one.
    pub fn only(&self) -> Result<Material<f64>, CaseError> {
        let beside_exact = |table: &Table, found: &str, expected: &str| {
            table.wrong(CaseMistake::Combination {
                name: table.name().to_owned(),
                found: format!("{found} beside [exact]"),
                expected: expected.to_owned(),
            })
        };
        match self {
            MaterialTable::Whole(_, material, _) if material.is_isotropic() => Ok(*material),
            MaterialTable::Whole(table, ..) => Err(beside_exact(
                table,
                "a material that is not isotropic",
                "lambda and mu, or young and poisson",
            )),
            MaterialTable::BySurface { table, .. } => {
                Err(beside_exact(table, "materials by surface", "one material for the whole body"))
            }
        }
    }

    /// The material of each triangle: each has exactly one, each surface of the mesh its own.
    pub fn on_the_mesh(self, mesh: &Mesh) -> Result<(Materials, Vec<MaterialEcho>), CaseError> {
        let (table, materials) = match self {
            MaterialTable::Whole(_, material, echo) => {
                let surfaces = mesh.surfaces().keys().cloned().collect();
                return Ok((material.into(), vec![MaterialEcho { surfaces, ..echo }]));
            }
            MaterialTable::BySurface { table, materials } => (table, materials),
        };
        let wrong = |found: String, expected: &str| {
            let (name, expected) = (table.name().to_owned(), expected.to_owned());
            table.wrong(CaseMistake::Combination { name, found, expected })
        };
        let mut covered = vec![false; mesh.triangles().len()];
        let mut parts = Vec::new();
        let mut echoes = Vec::new();
        for (value, key, material, echo) in &materials {
            let name = || format!("[material.{}]", shown(key));
            let triangles = on_surface(mesh, value, key, name)?;
            triangles.iter().for_each(|&t| covered[t] = true);
            parts.push((*material, triangles));
            echoes.push(MaterialEcho { surfaces: vec![(*key).to_owned()], ..echo.clone() });
        }
        let without = |name: &&String| materials.iter().all(|(_, key, ..)| key != name);
        if let Some(name) = mesh.surfaces().keys().find(without) {
            let found = format!("no material for the surface {}", quoted(name, '\''));
            return Err(wrong(found, &format!("[material.{}]", shown(name))));
        }
        if let Some(t) = covered.iter().position(|covered| !covered) {
            let [x, y] = mesh.triangle(t).point([1.0 / 3.0; 3]).into();
            let found = format!(
                "a triangle around ({}, {}) that belongs to no physical surface",
                quote::number(x),
                quote::number(y)
            );
            return Err(wrong(found, "all of the body in physical surfaces with a material each"));
        }
        let rest = materials[0].2;
        Ok((Materials::in_parts(rest, covered.len(), parts), echoes))
    }
}

/// The triangles of a surface, of which there must be some.
fn on_surface<'m>(
    mesh: &'m Mesh,
    value: &Value,
    key: &str,
    name: impl Fn() -> String,
) -> Result<&'m [usize], CaseError> {
    match mesh.surface(key) {
        Err(error) => Err(value.mistake(CaseMistake::Mesh { name: name(), error })),
        Ok([]) => Err(value.mistake(CaseMistake::Combination {
            name: name(),
            found: "no triangle in this mesh".to_owned(),
            expected: "at least one".to_owned(),
        })),
        Ok(triangles) => Ok(triangles),
    }
}

fn read_plane(table: &Table, default: Plane) -> Result<Plane, CaseError> {
    match table.get("plane") {
        Some(plane) => plane.one_of(&[("strain", Plane::Strain), ("stress", Plane::Stress)]),
        None => Ok(default),
    }
}

fn read_material(table: &Table, plane: Plane) -> Result<(Material<f64>, MaterialEcho), CaseError> {
    let plane = read_plane(table, plane)?;
    let wrong = |found: String, expected: &str| {
        let (name, expected) = (table.name().to_owned(), expected.to_owned());
        table.wrong(CaseMistake::Combination { name, found, expected })
    };
    let isotropic = |material, moduli| (material, MaterialEcho::new(&material, Some(moduli)));
    let tensor = |material| (material, MaterialEcho::new(&material, None));
    let (material, echo) = match MODULI.map(|key| table.get(key)) {
        [Some(lambda), Some(mu), None, None, None, None] => {
            let mu = mu.number_that(|mu| mu > 0.0, "a positive number")?;
            let least = quote::number(-2.0 / 3.0 * mu);
            let expected = format!("a number above {least}, for 3 lambda + 2 mu > 0");
            let lambda = lambda.number_that(|l| 3.0 * l + 2.0 * mu > 0.0, &expected)?;
            // E = mu (3 lambda + 2 mu) / (lambda + mu) and nu = lambda / (2 (lambda + mu)), so that nothing overflows that
            // need not.
            let ratio = lambda / (lambda + mu);
            isotropic(Material::lame(lambda, mu, plane), [mu * (2.0 + ratio), ratio / 2.0])
        }
        [None, None, Some(young), Some(poisson), None, None] => {
            let young = young.number_that(|e| e > 0.0, "a positive number")?;
            let expected = "a number above -1 and below 0.5";
            let poisson = poisson.number_that(|nu| -1.0 < nu && nu < 0.5, expected)?;
            isotropic(Material::young_poisson(young, poisson, plane), [young, poisson])
        }
        [None, None, None, None, Some(stiffness), None] => {
            let across = match (plane, table.get("across")) {
                (Plane::Strain, Some(across)) => Some(numbers(&across, ACROSS)?),
                (Plane::Stress, None) => None,
                (Plane::Strain, None) => {
                    return Err(wrong(
                        "stiffness in plane strain without across".to_owned(),
                        TELLS,
                    ));
                }
                (Plane::Stress, Some(_)) => {
                    return Err(wrong("across in plane stress".to_owned(), "plane strain with it"));
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
        return Err(wrong("across without stiffness".to_owned(), "both, or neither"));
    }
    let stiffness = largest_entry(&material);
    if stiffness > 0.0 && stiffness.is_finite() {
        Ok((material, echo))
    } else {
        let found =
            format!("moduli with lambda + 2 mu = {} in the plane", quote::number(stiffness));
        Err(wrong(found, "a positive finite sum; choose other units"))
    }
}

const SIX: &str = "a list of six numbers: C11, C12, C16, C22, C26, C66";

const ACROSS: &str =
    "a list of three numbers a, b, c: sigma_zz = a sigma_xx + b sigma_yy + c sigma_xy";

const TELLS: &str = "plane = \"stress\", or across = [a, b, c] with sigma_zz = a sigma_xx + b sigma_yy + c sigma_xy";

/// A list of `N` numbers.
fn numbers<const N: usize>(list: &Value, expected: &str) -> Result<[f64; N], CaseError> {
    let items = list.items()?;
    let all = items.iter().map(Value::number).collect::<Result<Vec<f64>, _>>()?;
    all.try_into().map_err(|_| list.wrong(expected))
}

/// The material, or the reason why there is none, at the place of its moduli.
fn checked(
    moduli: &Value,
    material: Result<Material<f64>, MaterialError>,
) -> Result<Material<f64>, CaseError> {
    let name = || moduli.name().to_owned();
    material.map_err(|error| moduli.mistake(CaseMistake::Material { name: name(), error }))
}

/// Moduli along and across an axis: in plane strain those across the plane, too.
fn read_orthotropic(
    moduli: &Value,
    plane: Plane,
) -> Result<Result<Material<f64>, MaterialError>, CaseError> {
    let table = moduli.section(moduli.name().to_owned())?;
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
    let angle = table.get("angle").map_or(Ok(0.0), |angle| angle.number())?;
    let [e1, e2, nu12, g12] = [number("e1")?, number("e2")?, number("nu12")?, number("g12")?];
    Ok(stable_orthotropic(Orthotropic { e1, e2, nu12, g12, angle, across }))
}

/// A body force on one surface: where it stands, the surface, and f.
type OnSurface<'s> = (Value<'s>, &'s str, [SharedFunction; 2]);

/// The loads as read, not yet on a mesh.
pub(super) struct LoadTable<'s> {
    pub body: [SharedFunction; 2],
    by_surface: Vec<OnSurface<'s>>,
}

pub(super) fn read_loads<'s>(
    root: &Table<'s>,
    solution: Option<&Exact>,
) -> Result<LoadTable<'s>, CaseError> {
    let table = root.section("load")?;
    let mut loads = LoadTable { body: [zero(), zero()], by_surface: Vec::new() };
    if let Some(solution) = solution {
        return match table {
            None => Ok(LoadTable { body: exact::body_force(solution), ..loads }),
            Some(table) => Err(table.wrong(CaseMistake::Combination {
                name: table.name().to_owned(),
                found: "loads beside [exact]".to_owned(),
                expected: "one of the two: an exact solution supplies its own".to_owned(),
            })),
        };
    }
    let Some(table) = table else { return Ok(loads) };
    let named: Vec<&str> =
        table.keys().filter(|key| table.get(key).is_some_and(|value| value.is_table())).collect();
    let mut known = vec!["body"];
    known.extend(&named);
    table.only(&known)?;
    for key in named {
        let value = table.require(key, "a table")?;
        let one = value.section(format!("[load.{}]", shown(key)))?;
        one.only(&["body"])?;
        let body = functions(&one.require("body", "a list of two: one for x, one for y")?)?;
        loads.by_surface.push((value, key, body));
    }
    if let Some(body) = table.get("body") {
        loads.body = functions(&body)?;
    }
    Ok(loads)
}

impl LoadTable<'_> {
    /// The forces on single surfaces, on their triangles.
    pub fn on_the_mesh(
        self,
        mesh: &Mesh,
    ) -> Result<([SharedFunction; 2], Vec<SurfaceForce>), CaseError> {
        let mut forces = Vec::new();
        for (value, key, force) in self.by_surface {
            let triangles = on_surface(mesh, &value, key, || format!("[load.{}]", shown(key)))?;
            let (surface, triangles) = (key.to_owned(), triangles.to_vec());
            forces.push(SurfaceForce { surface, triangles, force });
        }
        Ok((self.body, forces))
    }
}

/// Two components.
pub(super) fn functions(value: &Value) -> Result<[SharedFunction; 2], CaseError> {
    let [x, y] = value.pair()?;
    Ok([x.function()?, y.function()?])
}

pub(super) fn zero() -> SharedFunction {
    constant(0.0)
}

pub(super) fn constant(value: f64) -> SharedFunction {
    Arc::new(Expression::from(value))
}
