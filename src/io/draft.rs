//! A first case file for a mesh, as `signorini new` writes it: every boundary of the mesh with its length, and a support, a floor and
//! a material to begin with, so that it can be solved at once and changed line by line.

use std::fmt::Write;
use std::path::Path;

use super::numbers::short;
use crate::contact::Pair;
use crate::model::tree::Bounds;
use crate::model::{BoundaryEdge, Mesh};
use crate::quote::{self, number};

/// The largest number of boundaries that are listed; more are counted.
const MOST: usize = 100;

/// A part of the boundary that the draft puts to use.
struct Used {
    name: String,
    /// The condition that names it, unless the mesh does.
    place: Option<String>,
}

/// The text of a case file for this mesh, which it calls `gmsh`, with these pairs of boundaries that touch each other.
pub(crate) fn draft(title: &str, gmsh: &Path, mesh: &Mesh, pairs: &[Pair]) -> String {
    let mut text = format!(
        "# Replace material, support and floor by yours: those below make a first run. docs/case.md lists all keys.\ntitle = {}\n\n[mesh]\ngmsh = {}\n",
        string(title),
        string(&gmsh.to_string_lossy())
    );
    materials(mesh, &mut text);
    let in_pair =
        |name: &str| pairs.iter().any(|pair| pair.boundaries.iter().any(|other| other == name));
    let [bottom, top] = used(mesh, &in_pair);
    let bounds = Bounds::around(mesh.vertices().iter().copied());
    let [low, high] = [bounds.low, bounds.high];
    text += "\n# The boundaries of the mesh. Conditions: displacement, traction, pressure, force, normal, tangential, contact; without one a\n# boundary is free.\n";
    let names: Vec<&str> = mesh.boundary_names().collect();
    let is_used = |name: &str| name == bottom.name || name == top.name || in_pair(name);
    for name in names.iter().take(MOST).filter(|name| !is_used(name)) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "# [boundary.{}]     # {}", key(name), seen(mesh, name));
    }
    if names.len() > MOST {
        let _ = writeln!(text, "# ... and {} more", names.len() - MOST);
    }
    let push = number(rounded((high[1] - low[1]) / 1000.0));
    let _ = write!(
        text,
        "\n[boundary.{}]     # {}\n{}displacement = [\"0\", \"-{push}\"]     # pushed down by a thousandth of the height\n\n[boundary.{}]     # {}\n{}contact = {{ obstacle = \"floor\" }}\n\n[obstacle.floor]\nplane = {{ point = [{}, {}], normal = [0, 1] }}     # just below the body\n",
        key(&top.name),
        described(mesh, &top),
        placed(&top),
        key(&bottom.name),
        described(mesh, &bottom),
        placed(&bottom),
        number((low[0] + high[0]) / 2.0),
        number(low[1])
    );
    for Pair { boundaries: [first, second], .. } in pairs {
        let _ = write!(
            text,
            "\n[[pair]]     # two bodies that touch each other; law = \"bonded\" glues them\nboundaries = [{}, {}]\n",
            string(first),
            string(second)
        );
    }
    text
}

/// The material of the whole body, or of each surface if each triangle is in one of them.
fn materials(mesh: &Mesh, text: &mut String) {
    const STEEL: &str = "young = 210000.0     # steel, in N and mm\npoisson = 0.3\n";
    let mut count = vec![0_usize; mesh.triangles().len()];
    mesh.surfaces().values().flatten().for_each(|&t| count[t] += 1);
    if mesh.surfaces().len() > 1 && count.iter().all(|&count| count == 1) {
        for name in mesh.surfaces().keys() {
            let _ = write!(text, "\n[material.{}]\n{STEEL}", key(name));
        }
    } else {
        let _ = write!(text, "\n[material]\n{STEEL}");
    }
}

/// The boundary that is lowest and the one that is highest, by the mesh's names, or else by their places; none that touches another one.
fn used(mesh: &Mesh, in_pair: &dyn Fn(&str) -> bool) -> [Used; 2] {
    let mut by_height: Vec<(f64, &str)> = Vec::new();
    for name in mesh.boundary_names().filter(|name| !in_pair(name)) {
        let edges = mesh.edges_of(name).unwrap_or_default();
        if !edges.is_empty() {
            by_height.push((mean_height(mesh, edges), name));
        }
    }
    by_height.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let [(low, bottom), .., (high, top)] = by_height[..]
        && low < high
        && mesh.check_apart([bottom, top]).is_ok()
    {
        return [bottom, top].map(|name| Used { name: name.to_owned(), place: None });
    }
    let Bounds { low, high } = Bounds::around(mesh.vertices().iter().copied());
    let height = high[1] - low[1];
    let free_name = |wanted: &str| {
        let is_taken = |name: &str| mesh.boundary_names().any(|other| other == name);
        let numbered = (2..).map(|n| format!("{wanted}_{n}"));
        let mut all = std::iter::once(wanted.to_owned()).chain(numbered);
        all.find(|name| !is_taken(name)).unwrap_or_else(|| wanted.to_owned())
    };
    // Straight sides first; of a round body a growing part, until there is an edge.
    let is_there = |holds: &dyn Fn(f64) -> bool| {
        mesh.outline().iter().any(|&edge| mesh.places_of_ends(edge).iter().all(|p| holds(p[1])))
    };
    let find = |level: &dyn Fn(f64) -> f64, holds: &dyn Fn(f64, f64) -> bool| {
        let levels = [1e-6, 0.05, 0.25, 0.5].map(level);
        levels.into_iter().find(|&at| is_there(&|y| holds(y, at))).unwrap_or(level(0.5))
    };
    let below = find(&|share| low[1] + share * height, &|y, at| y < at);
    let above = find(&|share| high[1] - share * height, &|y, at| y > at);
    [
        Used { name: free_name("bottom"), place: Some(format!("y < {}", number(below))) },
        Used { name: free_name("top"), place: Some(format!("y > {}", number(above))) },
    ]
}

fn mean_height(mesh: &Mesh, edges: &[BoundaryEdge]) -> f64 {
    let weighted = |&edge: &BoundaryEdge| {
        let [a, b] = mesh.places_of_ends(edge);
        let length = mesh.length_and_normal(edge).0;
        [length, length * (a[1] / 2.0 + b[1] / 2.0)]
    };
    let [length, moment] =
        edges.iter().map(weighted).fold([0.0; 2], |sum, next| [sum[0] + next[0], sum[1] + next[1]]);
    moment / length
}

fn placed(used: &Used) -> String {
    used.place.as_ref().map_or(String::new(), |place| format!("where = \"{place}\"\n"))
}

fn described(mesh: &Mesh, used: &Used) -> String {
    match used.place {
        None => seen(mesh, &used.name),
        Some(_) => "a part of the outline, named by its place".to_owned(),
    }
}

/// The length of a boundary, and the box around it.
fn seen(mesh: &Mesh, name: &str) -> String {
    let edges = mesh.edges_of(name).unwrap_or_default();
    let length: f64 = edges.iter().map(|&edge| mesh.length_and_normal(edge).0).sum();
    let ends = edges.iter().flat_map(|&edge| mesh.places_of_ends(edge));
    let Bounds { low, high } = Bounds::around(ends);
    let [x, y] = [0, 1].map(|c| match [low[c], high[c]].map(|at| short(at, 4)) {
        [from, to] if from == to => from,
        [from, to] => format!("{from} to {to}"),
    });
    format!("length {}, x = {x}, y = {y}", short(length, 4))
}

/// A number to two digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

/// A key of TOML, in quotes if it needs them.
fn key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { string(name) }
}

/// A text of TOML: those of JSON are texts of TOML, too.
fn string(text: &str) -> String {
    quote::in_json(&serde_json::Value::from(text).to_string())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn each_surface_has_a_material_where_no_triangle_is_left_out_or_in_two() {
        let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let headers = |surfaces: &[(&str, &[usize])]| {
            let mesh = Mesh::new(square.clone(), vec![[0, 1, 2], [0, 2, 3]], []).unwrap();
            let named = surfaces.iter().map(|(name, of)| ((*name).to_owned(), of.to_vec()));
            let mesh = mesh.with_names(named.collect(), BTreeMap::new()).unwrap();
            let mut text = String::new();
            materials(&mesh, &mut text);
            text.lines().filter(|line| line.starts_with('[')).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(headers(&[("a", &[0]), ("b", &[1])]), "[material.a] [material.b]");
        for surfaces in [
            &[("a", &[0][..]), ("all", &[0, 1])][..],
            &[("a", &[0]), ("b", &[])],
            &[("all", &[0, 1])],
            &[],
        ] {
            assert_eq!(headers(surfaces), "[material]", "{surfaces:?}");
        }
    }
}
