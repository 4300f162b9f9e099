//! Our results against the stored ones of the independent reference in FEniCSx (`reference/results`): energies, contact
//! force and length, peak pressure, the largest displacement, the displacement at every probe, and for each contact boundary
//! its force, moment, length of contact and largest recovered pressure; with friction the shear force, where it sticks and slides, the slip
//! and the work.
//!
//! Both sides solve the same discrete problem, so they differ by rounding and by what is left of the residual: 1e-10
//! relative, for displacements relative to the largest one, for forces to the forces at work, for work to the energy.
//!
//! Cases with an exact solution also store the errors. There both sides integrate functions that are singular, each by its
//! own rule (16 points in each direction and 24 graded ones there, 10 and 20 here): 1e-8 relative. Where the discrete
//! solution is the exact one (the patch tests), the errors are rounding: up to a thousand roundoffs of the solution's size, the
//! bound of the patch tests.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use approx::abs_diff_eq;
use serde_json::Value;
use sha2::{Digest, Sha256};
use signorini::io::Case;
use signorini::io::outputs::{self, Extra};
use signorini::io::result::result_json;
use signorini::solve::solve;

use crate::common::root;

const TOLERANCE: f64 = 1e-10;
const TOLERANCE_OF_ERRORS: f64 = 1e-8;
const ROUNDING: f64 = 1000.0 * f64::EPSILON;

fn stored_in(folder: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(root().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    files
}

/// The numbers of a JSON value with their paths.
fn numbers(path: &str, value: &Value, all: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(number) => all.push((path.to_owned(), number.as_f64().unwrap())),
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                numbers(&format!("{path}[{i}]"), item, all);
            }
        }
        Value::Object(members) => {
            for (name, member) in members {
                numbers(&format!("{path}.{name}"), member, all);
            }
        }
        _ => {}
    }
}

/// What the reference says of each contact boundary.
const OF_A_BOUNDARY: [&str; 5] = ["force", "resultant", "moment", "length", "peak_pressure"];
const OF_FRICTION: [&str; 6] = ["shear", "sticks", "slides", "slip", "dissipated", "across_gaps"];

/// What both must agree on, with the difference that is allowed.
fn compared(results: &Value) -> Vec<(String, f64, f64)> {
    let q = &results["quantities"];
    let number = |value: &Value| value.as_f64().unwrap();
    let length = number(&q["max_displacement"]);
    let force = number(&q["contact_force"]).abs()
        + q["reactions"]
            .as_object()
            .unwrap()
            .values()
            .flat_map(|r| r.as_array().unwrap())
            .map(|r| number(r).abs())
            .sum::<f64>();
    let energy = number(&q["a_uu"]);
    // Tractions that balance among themselves show in neither: energy / length is a force, too.
    let force = force + energy / length.max(f64::MIN_POSITIVE);
    let allowed = |path: &str, value: f64| {
        if path.contains("errors") {
            TOLERANCE_OF_ERRORS * value + ROUNDING * (length + energy.sqrt())
        } else if path.contains("moment") {
            TOLERANCE * force * number(&results["mesh"]["h_max"])
        } else if path.contains("reactions") || path.contains("resultant") {
            TOLERANCE * force
        } else if path.contains("probes") {
            TOLERANCE * length
        } else if path.contains("work") {
            TOLERANCE * energy
        } else {
            TOLERANCE * value.abs()
        }
    };
    let mut all = Vec::new();
    for section in ["mesh", "gamma", "quantities", "errors"] {
        if let Some(value) = results.get(section) {
            numbers(section, value, &mut all);
        }
    }
    for (i, boundary) in results["contact"].as_array().unwrap().iter().enumerate() {
        for name in OF_A_BOUNDARY {
            numbers(&format!("contact[{i}].{name}"), &boundary[name], &mut all);
        }
        for name in OF_FRICTION {
            let value = &boundary["friction"][name];
            numbers(&format!("contact[{i}].friction.{name}"), value, &mut all);
        }
    }
    if let Some(probes) = results.get("probes") {
        numbers("probes", probes, &mut all);
    }
    all.into_iter()
        .map(|(path, value)| {
            let allowed = allowed(&path, value);
            (path, value, allowed)
        })
        .collect()
}

fn ours(path: &Path, settings: &[String]) -> Value {
    let case = Case::parse(path, &fs::read_to_string(path).unwrap(), settings).unwrap();
    let solved = solve(&case.problem, &case.method, &case.settings).unwrap().into();
    let results = outputs::results(&case, &solved, Duration::ZERO, Extra::default()).unwrap();
    serde_json::from_str(&result_json(&results).unwrap()).unwrap()
}

fn sha256(file: &Path) -> String {
    let content = fs::read(file).unwrap();
    Sha256::digest(&content).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn our_results_agree_with_the_stored_ones_of_fenicsx() {
    let mut bad = Vec::new();
    for file in stored_in("reference/results") {
        let stored: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
        let provenance = &stored["provenance"];
        let case = &root().join(provenance["case"].as_str().unwrap());
        let hash = sha256(case);
        if provenance["case_sha256"] != Value::String(hash) {
            bad.push(format!("{}: {} has changed since", file.display(), case.display()));
            continue;
        }
        let ours = ours(case, &[]);
        // All that is said of friction, for the command reads results of the engine.
        let said = |of: &Value| -> Vec<String> {
            let all = of["contact"].as_array().unwrap().iter();
            let frictions = all.filter_map(|boundary| boundary.get("friction")?.as_object());
            frictions.flat_map(|friction| friction.keys().cloned()).collect()
        };
        let [a, b] = [&stored, &ours].map(|of| BTreeSet::from_iter(said(of)));
        assert_eq!(a, b, "{}", file.display());
        let (theirs, ours) = (compared(&stored), compared(&ours));
        assert_eq!(theirs.len(), ours.len(), "{}", file.display());
        for ((path, a, allowed), (name, b, _)) in theirs.iter().zip(&ours) {
            assert_eq!(path, name);
            if !abs_diff_eq!(a, b, epsilon = *allowed) {
                bad.push(format!(
                    "{}: {path} = {b:e}, stored {a:e}, off by {:.1e}, allowed {allowed:.1e}",
                    file.display(),
                    (a - b).abs()
                ));
            }
        }
    }
    assert!(bad.is_empty(), "{} differences\n{}", bad.len(), bad.join("\n"));
}

/// The control: where friction is a little less or more, forces of friction differ by more than the tolerance.
#[test]
fn the_stored_results_notice_another_friction() {
    for (name, boundary, law, other) in [
        ("friction-drag-p1-gauss11", "bottom", "coulomb", "0.3999"),
        ("friction-journal-p2-exact", "arc", "coulomb", "0.3001"),
        ("friction-tresca-p2-exact", "bottom", "tresca", "\"0.02001 + 0.03*x\""),
    ] {
        let text =
            fs::read_to_string(root().join(format!("reference/results/{name}.json"))).unwrap();
        let stored: Value = serde_json::from_str(&text).unwrap();
        let case = &root().join(stored["provenance"]["case"].as_str().unwrap());
        let setting = format!("boundary.{boundary}.contact.friction.{law}={other}");
        let theirs = compared(&stored);
        let ours = compared(&ours(case, &[setting]));
        // With Gauss points lengths change by whole shares of an edge.
        for of in ["shear", "slip", "dissipated"] {
            let differs =
                |((path, a, allowed), (_, b, _)): (&(String, f64, f64), &(String, f64, f64))| {
                    path.ends_with(&format!("friction.{of}")) && (a - b).abs() > 1e3 * allowed
                };
            assert!(theirs.iter().zip(&ours).any(differs), "{name}: {of}");
        }
    }
}

/// Eleven points of Gauss's rule on an edge, exact to degree 21, miss little of what the kinks of friction do: it is near what is exact,
/// and not it.
#[test]
fn gauss_points_come_close_to_the_exact_integrals_of_friction() {
    for case in ["tresca", "drag", "stay", "journal", "grain"] {
        for degree in 1..=2 {
            let [exact, gauss] = ["exact", "gauss11"].map(|rule| {
                let name = format!("reference/results/friction-{case}-p{degree}-{rule}.json");
                let stored: Value =
                    serde_json::from_str(&fs::read_to_string(root().join(name)).unwrap()).unwrap();
                stored["contact"][0]["friction"]["shear"].as_f64().unwrap()
            });
            let off = (gauss / exact - 1.0).abs();
            // A kink between points that are 0.13 of an edge apart: that squared, times the edge's share of the line.
            assert!(off < 2e-3 && off > 1e-12, "{case} P{degree}: {off:e}");
        }
    }
}

/// The largest difference of a stored result of two bodies from ours, as the case is or with another setting: forces relative to the
/// largest force, energies to a(u, u), displacements to the largest one, lengths that stick or slide to their sum.
fn difference_of_pair(stored: &Value, setting: Option<&str>) -> f64 {
    let path = &root().join(stored["provenance"]["case"].as_str().unwrap());
    let settings: Vec<String> = setting.map(str::to_owned).into_iter().collect();
    let text = fs::read_to_string(path).unwrap();
    let case = Case::parse(path, &text, &settings).unwrap();
    let (s, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let (q, pair) = (&s.quantities, &s.boundaries[0]);
    let two =
        |name: &str, ours: [f64; 2], of: &Value| [0, 1].map(|c| (ours[c], number(&of[name][c])));
    let mut forces = vec![(pair.force, number(&stored["force"]))];
    forces.push((pair.moment, number(&stored["moment"])));
    forces.extend(two("resultant", pair.resultant, stored));
    for name in ["base", "top"] {
        forces.extend(two(name, q.reactions[name], &stored["reactions"]));
    }
    let energies = [(q.energy, number(&stored["a_uu"])), (q.work, number(&stored["work"]))];
    let off = |numbers: &[(f64, f64)], scale: f64| {
        numbers.iter().map(|(a, b)| (a - b).abs() / scale).fold(0.0, f64::max)
    };
    let force = forces.iter().map(|(_, stored)| stored.abs()).fold(0.0, f64::max);
    let mut most = off(&forces, force).max(off(&energies, energies[0].1));
    assert_eq!(pair.friction.is_some(), stored.get("friction").is_some());
    if let Some(friction) = pair.friction {
        let [sticks, slides] = ["sticks", "slides"].map(|key| number(&stored["friction"][key]));
        most =
            most.max(off(&[(friction.sticks, sticks), (friction.slides, slides)], sticks + slides));
    }
    // Each body has nodes of its own, by the triangles of its surface.
    for (name, triangles) in case.problem.mesh.surfaces() {
        let rows = stored["displacement"][name].as_array().unwrap();
        let nodes = triangles
            .iter()
            .flat_map(|t| &s.elements[s.nodes_per_triangle * t..s.nodes_per_triangle * (t + 1)]);
        let nodes: BTreeSet<usize> = nodes.copied().collect();
        assert_eq!(nodes.len(), rows.len(), "{name}");
        for row in rows {
            let row: Vec<f64> = row.as_array().unwrap().iter().map(number).collect();
            let away = |&node: &usize| {
                let [x, y] = s.nodes[node];
                (x - row[0]).hypot(y - row[1])
            };
            let node = nodes.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
            assert!(away(&node) < 1e-9, "{row:?}");
            let displacement = [0, 1].map(|c| (s.displacement[node][c], row[2 + c]));
            most = most.max(off(&displacement, q.max_displacement));
        }
    }
    most
}

#[test]
fn pairs_agree_with_those_of_fenicsx_whether_their_meshes_match_or_not() {
    let files = stored_in("reference/results/pairs");
    assert_eq!(files.len(), 13, "{files:?}");
    for file in files {
        let stored: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
        let case = &root().join(stored["provenance"]["case"].as_str().unwrap());
        assert_eq!(stored["provenance"]["case_sha256"], sha256(case), "{}", file.display());
        let off = difference_of_pair(&stored, None);
        println!("{}: {off:.1e}", file.display());
        assert!(off <= TOLERANCE, "{}: off by {off:e}", file.display());
        // The control: another gamma is another discrete solution.
        assert!(difference_of_pair(&stored, Some("method.kappa=0.55")) > 1e3 * TOLERANCE);
        // So is that of another friction.
        if let Some(law) =
            ["coulomb", "tresca"].into_iter().find(|&law| file.to_string_lossy().contains(law))
        {
            let other = if law == "coulomb" { "0.3001" } else { "\"0.01501 + 0.01*x\"" };
            let setting = format!("pair.0.friction.{law}={other}");
            assert!(difference_of_pair(&stored, Some(&setting)) > 1e3 * TOLERANCE);
        }
    }
}

/// GetFEM's multipliers are affine on the upper body's edges, the stress at its corners is singular: energies differ by 0.3 %, the largest
/// displacement, beside a corner, by 0.5 %, the force by 0.04 %.
#[test]
fn a_pair_agrees_with_getfem_to_the_error_of_the_mesh() {
    let text = fs::read_to_string(root().join("reference/results/getfem/apart.json")).unwrap();
    let stored: Value = serde_json::from_str(&text).unwrap();
    let mesh = &root().join(stored["provenance"]["mesh"].as_str().unwrap());
    assert_eq!(stored["provenance"]["mesh_sha256"], sha256(mesh));
    let path = &root().join("reference/pairs/apart-p2.toml");
    let text = fs::read_to_string(path).unwrap();
    let off = |clearance: &str| {
        let settings = [format!("pair.0.clearance=\"{clearance}\"")];
        let case = Case::parse(path, &text, &settings).unwrap();
        let (s, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        let q = &s.quantities;
        [
            ("a_uu", q.energy, 1e-2),
            ("work", q.work, 1e-2),
            ("force", s.boundaries[0].force, 2e-3),
            ("max_displacement", q.max_displacement, 1e-2),
        ]
        .map(|(name, ours, most)| {
            let off = (ours / stored[name].as_f64().unwrap() - 1.0).abs();
            println!("{name}: {off:.1e}");
            off <= most
        })
    };
    assert_eq!(off("0"), [true; 4]);
    // The control: with a clearance there is less of a force.
    assert!(!off("0.002")[2]);
}

/// GetFEM's operator for Coulomb's law in the same method, whose integrals have 32 points on an edge: a kink between two of them leaves
/// some 1e-6 of the forces.
#[test]
fn a_dragged_pad_agrees_with_getfem() {
    let text = fs::read_to_string(root().join("reference/results/getfem/drag.json")).unwrap();
    let stored: Value = serde_json::from_str(&text).unwrap();
    let path = &root().join(stored["provenance"]["case"].as_str().unwrap());
    assert_eq!(stored["provenance"]["case_sha256"], sha256(path));
    let off = |settings: &[String]| {
        let ours = ours(path, settings);
        let top = &ours["quantities"]["reactions"]["top"];
        let numbers = [
            ("a_uu", &ours["quantities"]["a_uu"]),
            ("shear", &top[0]),
            ("force", &ours["contact"][0]["force"]),
            ("slip", &ours["contact"][0]["friction"]["slip"]),
        ];
        let off = |(name, ours): (&str, &Value)| {
            let off = (ours.as_f64().unwrap() / stored[name].as_f64().unwrap() - 1.0).abs();
            println!("{name}: {off:.1e}");
            off
        };
        numbers.map(off).into_iter().fold(0.0, f64::max)
    };
    assert!(off(&[]) <= 5e-6);
    // The control: a coefficient that is off by a hundredth.
    assert!(off(&["boundary.bottom.contact.friction.coulomb=0.396".to_owned()]) > 1e-3);
}
