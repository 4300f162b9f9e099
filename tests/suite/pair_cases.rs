//! Cases with pairs: what is read of them, and from which meshes.

use approx::{abs_diff_eq, assert_abs_diff_eq};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use signorini::contact::contact_line::assemble;
use signorini::contact::{Law, Piece};
use signorini::io::Case;
use signorini::model::Condition;
use signorini::model::Degree;
use signorini::model::Space;

fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pair_cases").join(test);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Two blocks in MSH 2.2, the upper one `gap` above the lower one, and narrower; or, `joined`, as wide and on the same nodes.
fn blocks(gap: f64, joined: bool) -> String {
    let (mut nodes, mut elements) = (Vec::new(), Vec::new());
    let mut grid = |[x0, x1]: [f64; 2], y0: f64, [nx, ny]: [usize; 2], names: [usize; 3]| {
        let first = nodes.len();
        for j in 0..=ny {
            for i in 0..=nx {
                let x = x0 + (x1 - x0) * i as f64 / nx as f64;
                nodes.push([x, y0 + j as f64 / ny as f64]);
            }
        }
        let at = |i: usize, j: usize| first + j * (nx + 1) + i + 1;
        let [low, high, surface] = names;
        for i in 0..nx {
            for (name, j) in [(low, 0), (high, ny)] {
                elements.push(format!("1 2 {name} {name} {} {}", at(i, j), at(i + 1, j)));
            }
            for j in 0..ny {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                elements.push(format!("2 2 {surface} {surface} {a} {b} {c}"));
                elements.push(format!("2 2 {surface} {surface} {a} {c} {d}"));
            }
        }
    };
    if joined {
        grid([0.0, 1.0], 0.0, [6, 8], [1, 4, 5]);
        // The upper four rows are another surface.
        for element in &mut elements {
            let numbers: Vec<usize> =
                element.split(' ').map(|word| word.parse().unwrap()).collect();
            if numbers[0] == 2 && numbers[4..].iter().all(|&node| node > 4 * 7) {
                *element = element.replacen("2 2 5 5", "2 2 6 6", 1);
            }
        }
    } else {
        grid([0.0, 1.0], 0.0, [6, 6], [1, 2, 5]);
        grid([0.25, 0.75], 1.0 + gap, [4, 8], [3, 4, 6]);
    }
    let mut text = String::from(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n1 1 \"floor\"\n1 2 \"low\"\n1 3 \"up\"\n1 4 \"load\"\n2 5 \"lower\"\n2 6 \"upper\"\n$EndPhysicalNames\n",
    );
    text += &format!("$Nodes\n{}\n", nodes.len());
    for (k, [x, y]) in nodes.iter().enumerate() {
        text += &format!("{} {x:?} {y:?} 0\n", k + 1);
    }
    text += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
    for (k, element) in elements.iter().enumerate() {
        text += &format!("{} {element}\n", k + 1);
    }
    text + "$EndElements\n"
}

const CASE: &str = r#"
title = "Two blocks"
[mesh]
gmsh = "blocks.msh"
[material]
young = 1e6
poisson = 0.3
[boundary.floor]
displacement = [0, 0]
[boundary.load]
displacement = [0, -0.1]
"#;

fn read(folder: &Path, mesh: &str, rest: &str) -> Result<Case, String> {
    fs::write(folder.join("blocks.msh"), mesh).unwrap();
    let text = format!("{CASE}{rest}");
    let case = Case::parse(&folder.join("case.toml"), &text, &[]);
    case.map_err(|error| error.to_string().replace(&format!("{}/", folder.display()), ""))
}

/// The pieces of the pairs of a case.
fn pieces(case: &Case, degree: Degree) -> Vec<Piece> {
    let space = Space::new(&case.problem.mesh, degree);
    let mut pieces = assemble(&case.problem, &space, 1.0).unwrap();
    pieces.retain(|piece| piece.geometry.stretches.len() == 2);
    pieces
}

fn gaps(piece: &Piece) -> Vec<f64> {
    piece.geometry.nodes.iter().map(|node| node.gap).collect()
}

const PAIR: &str = "[[pair]]\nboundaries = [\"low\", \"up\"]\n";

#[test]
fn blocks_that_touch_are_read_as_a_pair_and_refused_without_one() {
    let folder = folder("touching");
    let mesh = blocks(0.0, false);
    let case = read(&folder, &mesh, PAIR).unwrap();
    assert!(case.problem.conditions.values().all(|c| !matches!(c, Condition::Contact { .. })));
    let pieces = pieces(&case, Degree::One);
    let length: f64 = pieces.iter().map(|piece| piece.length).sum();
    assert_abs_diff_eq!(length, 0.5, epsilon = 1e-14);
    assert!(pieces.iter().flat_map(gaps).all(|gap| gap.abs() < 1e-15));
    let refused = read(&folder, &mesh, "boundary.up.contact = {}\n").err().unwrap();
    assert!(refused.contains("expected one vertex there (mesh.merge makes them one), or two bodies that are a [[pair]]"), "{refused}");
    // Control: a pair of boundaries that do not touch there.
    let other = "[[pair]]\nboundaries = [\"low\", \"floor\"]\n";
    assert!(read(&folder, &mesh, other).is_err());
}

#[test]
fn merging_leaves_the_boundaries_of_a_pair_apart() {
    let folder = folder("merged");
    let merged = CASE.replace("\"blocks.msh\"", "\"blocks.msh\"\nmerge = 1e-6");
    fs::write(folder.join("blocks.msh"), blocks(1e-9, false)).unwrap();
    let vertices = |rest: &str| {
        let text = format!("{merged}{rest}");
        let case = Case::parse(&folder.join("case.toml"), &text, &[]);
        case.map(|case| case.problem.mesh.vertices().len())
    };
    let apart = vertices(PAIR).unwrap();
    assert_eq!(apart, 7 * 7 + 5 * 9);
    // Control: without the pair, the vertices at (1/2, 1) become one, and then a vertex hangs in an edge.
    assert!(vertices("[boundary.up]\ncontact = {}\n").is_err());
}

#[test]
fn surfaces_that_share_nodes_are_split_along_their_common_curve() {
    let folder = folder("surfaces");
    let mesh = blocks(0.0, true);
    let glued = read(&folder, &mesh, "[boundary.low]\ncontact = {}\n");
    assert!(glued.is_err(), "'low' has no edge");
    let split = "[[pair]]\nsurfaces = [\"lower\", \"upper\"]\nlaw = \"bonded\"\n";
    let case = read(&folder, &mesh, split).unwrap();
    let pair = &case.problem.pairs[0];
    assert_eq!(pair.boundaries, ["lower|upper", "upper|lower"]);
    assert_eq!(pair.law, Law::Bonded);
    assert_eq!(case.problem.mesh.vertices().len(), 7 * 9 + 7);
    let pieces = pieces(&case, Degree::One);
    assert_eq!(pieces.len(), 6);
    for piece in pieces {
        assert_eq!(gaps(&piece), [0.0; 2]);
        assert_eq!(<[f64; 2]>::from(piece.geometry.nodes[0].direction), [0.0, 1.0]);
    }
    let said = read(&folder, &mesh, "[[pair]]\nsurfaces = [\"lower\", \"rubber\"]\n").err();
    assert_eq!(
        said.as_deref(),
        Some("case.toml:12: [[pair]]: no surface named 'rubber'; this mesh has: lower, upper")
    );
}

#[test]
fn keys_of_a_pair_are_read_and_set_by_its_number() {
    let folder = folder("set");
    fs::write(folder.join("blocks.msh"), blocks(0.01, false)).unwrap();
    let text = format!("{CASE}{PAIR}clearance = \"auto\"\n");
    let parse = |settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
        Case::parse(&folder.join("case.toml"), &text, &settings)
    };
    let case = parse(&[]).unwrap();
    let pair = &case.problem.pairs[0];
    assert!(pair.clearance.is_none() && pair.reach.is_none() && pair.law == Law::Contact);
    assert_abs_diff_eq!(gaps(&pieces(&case, Degree::One)[0])[0], 0.01, epsilon = 1e-15);
    let case =
        parse(&["pair.0.clearance=0.1*x", "pair.0.reach=0.2", "pair.0.law=sliding"]).unwrap();
    let pair = &case.problem.pairs[0];
    assert_eq!(pair.clearance.as_ref().unwrap().at([3.0, 0.0]), 0.1 * 3.0);
    assert_eq!((pair.reach, pair.law), (Some(0.2), Law::Sliding));
    let error = parse(&["pair.1.reach=0.2"]).err().unwrap().to_string();
    assert!(
        error.ends_with("found pair.1; expected a key of one of the tables pair.0 to pair.0"),
        "{error}"
    );
}

#[test]
fn in_the_cases_with_pairs_points_of_both_boundaries_face_each_other() {
    // The whole length of the shorter boundary, or what the reach leaves of it.
    let root = crate::common::root();
    for (name, lengths) in [
        ("pin_lug", &[std::f64::consts::PI * 10.025][..]),
        ("press_fit", &[std::f64::consts::FRAC_PI_2 * 30.0]),
        ("cylinders", &[]),
        ("mindlin", &[]),
        ("stack", &[22.0, 22.0]),
    ] {
        let case = Case::read(&root.join(format!("cases/{name}.toml"))).unwrap();
        for degree in [Degree::One, Degree::Two] {
            let mut all = BTreeMap::<String, f64>::new();
            for piece in pieces(&case, degree) {
                *all.entry(piece.boundary().to_string()).or_default() += piece.length;
            }
            for (length, expected) in all.values().zip(lengths) {
                // A polygon of edges of 1/10 of the radius is shorter than its arc by 1/2400.
                assert!(abs_diff_eq!(length / expected, 1.0, epsilon = 2e-3), "{name}: {length}");
            }
            assert_eq!(all.len(), lengths.len().max(1), "{name}");
        }
    }
}
