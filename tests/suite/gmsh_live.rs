//! Reads files that the installed Gmsh has just written, in text and binary. A fresh Gmsh shows what the committed files in
//! `tests/meshes` can't: that the format is still the one that is read here.

use approx::{abs_diff_eq, assert_abs_diff_eq};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use signorini::io::{Case, gmsh};
use signorini::model::Mesh;
use signorini::solve::solve;

/// Runs `gmsh -2 -format msh41` with more arguments on a file of the project.
fn mesh(geometry: &str, output: &str, more: &[&str]) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gmsh_live");
    fs::create_dir_all(&directory).unwrap();
    let file = directory.join(output);
    let run = Command::new("gmsh")
        .args(["-2", "-format", "msh41", "-o"])
        .arg(&file)
        .args(more)
        .arg(crate::common::root().join(geometry))
        .output()
        .unwrap_or_else(|e| panic!("gmsh can't be run ({e}): install it, in Debian as `gmsh`"));
    assert!(run.status.success(), "gmsh failed:\n{}", String::from_utf8_lossy(&run.stderr));
    file
}

fn read(file: &Path) -> Mesh {
    gmsh::read(file, None, &[]).unwrap_or_else(|e| panic!("{e}")).mesh
}

fn area(mesh: &Mesh) -> f64 {
    (0..mesh.triangles().len()).map(|t| mesh.triangle(t).double_area() / 2.0).sum()
}

fn length(mesh: &Mesh, boundary: &str) -> f64 {
    let edges = mesh.edges_of(boundary).unwrap();
    edges.iter().map(|&edge| mesh.length_and_normal(edge).0).sum()
}

#[test]
#[ignore = "needs gmsh: run by .ci/run"]
fn fresh_text_and_binary_files_give_the_same_mesh() {
    let text = read(&mesh("tests/meshes/square.geo", "text.msh", &[]));
    for (output, more) in [
        ("binary.msh", &["-bin"][..]),
        ("all.msh", &["-save_all"]),
        ("parametric.msh", &["-parametric", "-bin", "-save_all"]),
    ] {
        let other = read(&mesh("tests/meshes/square.geo", output, more));
        assert_eq!(text.triangles().len(), other.triangles().len(), "{output}");
        assert!(abs_diff_eq!(area(&text), area(&other), epsilon = 1e-12), "{output}");
        assert!(text.boundary_names().eq(other.boundary_names()), "{output}");
        for name in text.boundary_names() {
            assert!(
                abs_diff_eq!(length(&text, name), length(&other, name), epsilon = 1e-12),
                "{output} {name}"
            );
        }
    }
}

#[test]
#[ignore = "needs gmsh: run by .ci/run"]
fn a_fresh_disk_is_half_a_disk_that_touches_the_floor() {
    let disk = read(&mesh("cases/disk.geo", "disk.msh", &[]));
    assert_abs_diff_eq!(area(&disk), std::f64::consts::FRAC_PI_2, epsilon = 0.01);
    // The contact arc reaches to 30 degrees on both sides; the free arcs from there to 90.
    assert_abs_diff_eq!(length(&disk, "contact"), std::f64::consts::FRAC_PI_3, epsilon = 1e-3);
    assert_abs_diff_eq!(length(&disk, "free"), 2.0 * std::f64::consts::FRAC_PI_3, epsilon = 1e-2);
    assert_abs_diff_eq!(length(&disk, "top"), 2.0, epsilon = 1e-12);
    assert!(disk.vertices().contains(&[0.0, 0.0]));
}

/// The older format, and elements of second order with straight edges, are the same mesh; curved edges are refused.
#[test]
#[ignore = "needs gmsh: run by .ci/run"]
fn older_files_and_straight_elements_of_second_order_give_the_same_mesh() {
    let new = read(&mesh("tests/meshes/square.geo", "new.msh", &[]));
    for (output, more) in [
        ("old.msh", &["-format", "msh22"][..]),
        ("old_binary.msh", &["-format", "msh22", "-bin"]),
        ("quadratic.msh", &["-order", "2", "-setnumber", "Mesh.SecondOrderLinear", "1"]),
        (
            "old_quadratic.msh",
            &[
                "-format",
                "msh22",
                "-order",
                "2",
                "-setnumber",
                "Mesh.SecondOrderLinear",
                "1",
                "-bin",
            ],
        ),
    ] {
        let other = read(&mesh("tests/meshes/square.geo", output, more));
        // A text has sixteen digits, and a double may need seventeen.
        for (a, b) in new.vertices().iter().zip(other.vertices()) {
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-15, "{output} {a:?} {b:?}");
        }
        assert_eq!(new.triangles(), other.triangles(), "{output}");
        for name in new.boundary_names() {
            assert_eq!(new.edges_of(name), other.edges_of(name), "{output} {name}");
        }
    }
    let curved = mesh("cases/disk.geo", "curved.msh", &["-order", "2"]);
    let message =
        gmsh::read(&curved, None, &[]).err().map_or("no error".to_owned(), |e| e.to_string());
    assert!(message.contains("is curved: node"), "{message}");
}

/// The bracket of `cases`, meshed afresh in every variant of the format and solved: one result.
#[test]
#[ignore = "needs gmsh: run by .ci/run"]
fn every_fresh_variant_of_the_bracket_gives_the_same_result() {
    let text = fs::read_to_string(crate::common::root().join("cases/bracket.toml")).unwrap();
    let mut answers: Vec<(&str, Vec<f64>)> = Vec::new();
    for (output, more) in [
        ("bracket.msh", &[][..]),
        ("bracket_binary.msh", &["-bin"]),
        ("bracket_22.msh", &["-format", "msh22"]),
        ("bracket_22_binary.msh", &["-format", "msh22", "-bin"]),
        ("bracket_all.msh", &["-save_all", "-parametric", "-bin"]),
        ("bracket_2.msh", &["-order", "2", "-setnumber", "Mesh.SecondOrderLinear", "1"]),
    ] {
        let file = mesh("cases/bracket.geo", output, more);
        let case = file.with_file_name("case.toml");
        let text = text.replace("\"bracket.msh\"", &format!("\"{output}\""));
        let case = Case::parse(&case, &text, &[]).unwrap_or_else(|e| panic!("{output}: {e}"));
        let (s, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        let of_boundary = |b: &signorini::results::ContactBoundary| {
            [b.force, b.resultant[0], b.resultant[1], b.moment, b.length, b.peak_pressure]
        };
        let mut numbers = vec![s.quantities.energy, s.quantities.work];
        numbers.extend(s.boundaries.iter().flat_map(of_boundary));
        answers.push((output, numbers));
    }
    let (_, first) = &answers[0];
    assert_eq!(first.len(), 2 + 2 * 6);
    let largest = first.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    for (output, numbers) in &answers {
        for (a, b) in first.iter().zip(numbers) {
            assert!(
                abs_diff_eq!(a, b, epsilon = 1e-9 * a.abs().max(1e-3 * largest)),
                "{output}: {a} {b}"
            );
        }
    }
}
