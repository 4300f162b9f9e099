//! Materials and loads of the body: `[material]` and `[load]` of a case file, for the whole body or for its
//! physical surfaces one by one.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::expression::Expression;
use super::mistake::{CaseError, CaseMistake};
use super::table::{Table, Value};
use crate::fem::exact;
use crate::fem::material::largest_entry;
use crate::fem::{Exact, Materials, Mesh, SharedFunction, SurfaceForce};
use crate::kernel::{Material, Plane};
use crate::quote::{self, key as shown, quoted};

const MODULI: [&str; 4] = ["lambda", "mu", "young", "poisson"];

/// A material as the case has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MaterialEcho {
    /// The physical surfaces made of it; none if the mesh has no named surface.
    pub surfaces: Vec<String>,
    /// Young's modulus.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// "strain" or "stress".
    pub plane: String,
}

/// The materials as read, not yet on a mesh.
pub(super) enum MaterialTable<'s> {
    Whole(Material<f64>, MaterialEcho),
    BySurface {
        table: Table<'s>,
        materials: Vec<(Value<'s>, &'s str, Material<f64>, MaterialEcho)>,
    },
}

pub(super) fn read_materials<'s>(table: Table<'s>) -> Result<MaterialTable<'s>, CaseError> {
    let named: Vec<&str> =
        table.keys().filter(|key| table.get(key).is_some_and(|value| value.is_table())).collect();
    if named.is_empty() {
        table.only(&["lambda", "mu", "young", "poisson", "plane"])?;
        let (material, echo) = read_material(&table, Plane::Strain)?;
        return Ok(MaterialTable::Whole(material, echo));
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
        one.only(&["lambda", "mu", "young", "poisson", "plane"])?;
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
        match self {
            MaterialTable::Whole(material, _) => Ok(*material),
            MaterialTable::BySurface { table, .. } => Err(table.wrong(CaseMistake::Combination {
                name: table.name().to_owned(),
                found: "materials by surface beside [exact]".to_owned(),
                expected: "one material for the whole body".to_owned(),
            })),
        }
    }

    /// The material of each triangle: each has exactly one, each surface of the mesh its own.
    pub fn on_the_mesh(self, mesh: &Mesh) -> Result<(Materials, Vec<MaterialEcho>), CaseError> {
        let (table, materials) = match self {
            MaterialTable::Whole(material, echo) => {
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
    let (material, [young, poisson]) = match MODULI.map(|key| table.get(key)) {
        [Some(lambda), Some(mu), None, None] => {
            let mu = mu.number_that(|mu| mu > 0.0, "a positive number")?;
            let least = quote::number(-2.0 / 3.0 * mu);
            let expected = format!("a number above {least}, for 3 lambda + 2 mu > 0");
            let lambda = lambda.number_that(|l| 3.0 * l + 2.0 * mu > 0.0, &expected)?;
            // E = mu (3 lambda + 2 mu) / (lambda + mu) and nu = lambda / (2 (lambda + mu)), so that nothing overflows that
            // need not.
            let ratio = lambda / (lambda + mu);
            (Material::lame(lambda, mu, plane), [mu * (2.0 + ratio), ratio / 2.0])
        }
        [None, None, Some(young), Some(poisson)] => {
            let young = young.number_that(|e| e > 0.0, "a positive number")?;
            let expected = "a number above -1 and below 0.5";
            let poisson = poisson.number_that(|nu| -1.0 < nu && nu < 0.5, expected)?;
            (Material::young_poisson(young, poisson, plane), [young, poisson])
        }
        _ => return Err(table.combination(&MODULI, "lambda and mu, or young and poisson")),
    };
    let stiffness = largest_entry(&material);
    if stiffness > 0.0 && stiffness.is_finite() {
        let plane = if plane == Plane::Strain { "strain" } else { "stress" }.to_owned();
        Ok((material, MaterialEcho { surfaces: Vec::new(), young, poisson, plane }))
    } else {
        Err(table.wrong(CaseMistake::Combination {
            name: table.name().to_owned(),
            found: format!("moduli with lambda + 2 mu = {} in the plane", quote::number(stiffness)),
            expected: "a positive finite sum; choose other units".to_owned(),
        }))
    }
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
