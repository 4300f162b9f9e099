//! Cases as people reported them when they went wrong, each with what the command says and writes of it now.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::command::{shoe, signorini, with_files};
use super::common::root;

/// What the command prints, with this exit code.
fn said(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = signorini(folder, arguments);
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text:?}");
    text.concat()
}

fn result(folder: &Path, out: &str) -> Value {
    let text = fs::read_to_string(folder.join(out).join("result.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// A floor whose normal points away from the body.
const WRONG_SIDE: &str = r#"
mesh.rectangle = { width = 1, height = 1, nx = 8, ny = 8 }
material = { lambda = 1, mu = 1 }
load.body = ["0", "-0.01"]
boundary.top.displacement = ["0", "0"]
boundary.bottom.contact.obstacle = "floor"
obstacle.floor.plane = { point = [0, -0.001], normal = [0, -1] }
"#;

#[test]
fn an_obstacle_on_the_other_side_of_the_body_is_refused_with_the_place() {
    let right = WRONG_SIDE.replace("[0, -1]", "[0, 1]");
    let folder = with_files("wrong-side", &[("wrong.toml", WRONG_SIDE), ("right.toml", &right)]);
    for task in ["solve", "check"] {
        let message = said(&folder, &[task, "wrong.toml"], 2);
        let place = "[obstacle.floor] lies on the other side of the body: from (0, 0) on the boundary 'bottom' its direction (0, 1) leads into the body";
        assert!(message.contains(place), "{message}");
        said(&folder, &[task, "right.toml"], 0);
    }
}

/// Half a disk in 16 triangles, flat side down, `contact` being all of the round one: its lowest edges face away from what is
/// above.
fn dome() -> String {
    let at = |k: usize| (std::f64::consts::PI * k as f64 / 16.0).sin_cos();
    let mut nodes = "1 0 0 0\n".to_owned();
    let mut elements = String::new();
    for k in 0..=16 {
        let (sine, cosine) = at(k);
        nodes += &format!("{} {cosine} {sine} 0\n", k + 2);
    }
    for k in 0..16 {
        elements += &format!("{} 1 2 1 1 {} {}\n", k + 1, k + 2, k + 3);
        elements += &format!("{} 2 2 3 3 1 {} {}\n", k + 17, k + 2, k + 3);
    }
    elements += "33 1 2 2 2 18 1\n34 1 2 2 2 1 2\n";
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"dome\"\n1 2 \"flat\"\n2 3 \"body\"\n$EndPhysicalNames\n\
         $Nodes\n18\n{nodes}$EndNodes\n$Elements\n34\n{elements}$EndElements\n"
    )
}

#[test]
fn edges_beside_an_obstacle_may_face_away_from_it() {
    let case = r#"
mesh.gmsh = "dome.msh"
material = { young = 5, poisson = 0.49 }
boundary.flat.displacement = [0, 0]
boundary.dome.contact.obstacle = "lid"
obstacle.lid.distance = "(0.9 + 0.3*x - y)/sqrt(1.09)"
"#;
    // The lid leans: its direction and the normals of the lowest edges on the right are more than a right angle apart.
    let folder = with_files("dome", &[("dome.msh", &dome()), ("case.toml", case)]);
    said(&folder, &["check", "case.toml"], 0);
    let turned =
        ["check", "case.toml", "--set", "obstacle.lid.distance=(y - 0.9 - 0.3*x)/sqrt(1.09)"];
    let message = said(&folder, &turned, 2);
    assert!(message.contains("lies on the other side of the body"), "{message}");
}

#[test]
fn contact_that_touches_nothing_and_an_overlap_before_loading_are_remarked_with_their_places() {
    let case = r#"
units = { length = "mm", force = "N" }
mesh.rectangle = { width = 1, height = 1, nx = 8, ny = 8 }
material = { lambda = 1, mu = 1 }
boundary.top.displacement = ["0", "-0.01*x"]
boundary.bottom.contact.obstacle = "floor"
obstacle.floor.plane = { point = [0, -0.1], normal = [0, 1] }
boundary.right.contact.gap = "0.5 - 0.1*y"
"#;
    let folder = with_files("remarks", &[("case.toml", case)]);
    let message = said(&folder, &["solve", "case.toml"], 0);
    for remark in [
        "'bottom' touches nothing: it is nearest to 'floor' at (1, 0), where a gap of 0.09",
        "'right' touches nothing: it is nearest to its obstacle at (1, 1), where a gap of 0.4",
    ] {
        assert!(message.contains(remark), "{message}");
    }
    assert_eq!(result(&folder, "out/case")["remarks"].as_array().unwrap().len(), 2);
    let overlapping = "obstacle.floor.plane.point=[0, 0.02]";
    for task in ["solve", "check"] {
        let message = said(&folder, &[task, "case.toml", "--set", overlapping], 0);
        let remark = "the body overlaps 'floor' by 0.02 mm at (0, 0) before loading: is it in the right place, and is the body on the right side of it?";
        assert!(message.contains(remark), "{message}");
        assert!(!message.contains("'bottom' touches nothing"), "{message}");
    }
    let rounded = "obstacle.floor.plane.point=[0, 1e-12]";
    let message = said(&folder, &["check", "case.toml", "--set", rounded], 0);
    assert!(!message.contains("overlaps"), "{message}");
}

#[test]
fn an_exact_solution_of_a_corner_has_its_errors_in_result_json() {
    let case = r#"
mesh.trapezoid = { omega = 3.0, n = 32 }
material = { lambda = 1, mu = 1 }
exact = { solution = "corner", omega = 3.0 }
boundary = { bottom = "contact", left = "traction", right = "displacement", top = "displacement" }
"#;
    let folder = with_files("corner", &[("case.toml", case)]);
    for degree in ["1", "2"] {
        let degree = format!("method.degree={degree}");
        said(&folder, &["solve", "case.toml", "--set", &degree], 0);
        let result = result(&folder, "out/case");
        assert_eq!(result["verdict"], "proved");
        let given = result["errors"]["energy"].as_f64().is_some_and(|error| error > 0.0);
        let remarked = result["remarks"].to_string().contains("the errors are not given");
        assert!(given != remarked, "{}", result["remarks"]);
    }
}

/// A field on a finer mesh, and one in a file of another kind.
#[test]
fn a_field_on_another_mesh_is_not_certified() {
    let case = "mesh.rectangle = { width = 1, height = 1, nx = 8, ny = 8 }\nmaterial = { lambda = 1, mu = 1 }\nload.body = [\"0\", \"-4 + 10*x\"]\nboundary.top.displacement = [\"0\", \"0\"]\nboundary.bottom.contact.gap = 0\n";
    let folder = with_files("fields", &[("case.toml", case)]);
    // The same displacement at n cells a side.
    let certify = |n: u32, uy: f64, code: i32| {
        let at = |i: u32| f64::from(i) / f64::from(n);
        let rows = (0..=n).flat_map(|j| (0..=n).map(move |i| (at(i), at(j))));
        let rows: String = rows.map(|(x, y)| format!("{x},{y},0,{uy}\n")).collect();
        fs::write(folder.join("field.csv"), format!("x,y,ux,uy\n{rows}")).unwrap();
        said(&folder, &["certify", "case.toml", "--displacement", "field.csv"], code)
    };
    let message = certify(8, 0.0, 0);
    assert!(message.contains("  prescribed   the field misses it by at most 0;"), "{message}");
    let message = certify(16, 0.0, 2);
    let problem = "208 of its 289 points lie at no vertex of the case's mesh, the first at ";
    assert!(message.contains(problem), "{message}");
    // A field that is moved as a whole is said to miss what is prescribed.
    let message = certify(8, -1e8, 0);
    assert!(message.contains("the field misses it by at most 1e8;"), "{message}");
    fs::write(folder.join("field.vtu"), "<VTKFile>").unwrap();
    let message = said(&folder, &["certify", "case.toml", "--displacement", "field.vtu"], 2);
    assert!(message.contains("expected a file that ends in .csv"), "{message}");
}

#[test]
fn what_is_proved_of_a_load_that_is_no_polynomial_names_the_quadrature() {
    let case = r#"
mesh.rectangle = { width = 1, height = 1, nx = 8, ny = 8 }
material = { lambda = 1, mu = 1 }
load.body = ["0", "-0.1*(1 + sin(3*x)*cos(2*y))"]
boundary.top.displacement = ["0", "0"]
boundary.bottom.contact.gap = 0.001
"#;
    let folder = with_files("quadrature", &[("case.toml", case)]);
    let message = said(&folder, &["solve", "case.toml", "--report", "--verbose"], 0);
    let words = "rounding included, with the loads as quadrature gives them";
    assert!(message.contains(words), "{message}");
    assert!(fs::read_to_string(folder.join("out/case/report.html")).unwrap().contains(words));
    let discrete = &result(&folder, "out/case")["certificate"]["discrete"];
    assert_eq!(discrete["problem"], "the loads as quadrature gives them");
    assert_eq!(discrete["rigorous"], true);
}

/// A leaf spring that touches a cylinder along a part of one edge.
#[test]
fn a_body_that_stands_on_less_than_an_edge_is_proved() {
    let leaf = r#"
mesh.rectangle = { width = 100, height = 4, nx = 200, ny = 8 }
material = { young = 206e3, poisson = 0.3 }
boundary.left.normal = 0
boundary.right.traction = [0, -0.2]
obstacle.cylinder.circle = { center = [0, -150], radius = 150, side = "outside" }
boundary.bottom.contact.obstacle = "cylinder"
method.degree = 2
"#;
    let folder = with_files("leaf", &[("leaf.toml", leaf)]);
    said(&folder, &["solve", "leaf.toml"], 0);
    let result = result(&folder, "out/leaf");
    assert_eq!((&result["verdict"], &result["method"]["slides"]), (&"proved".into(), &0.into()));
}

/// A block on the floor between two walls, or beside one, that it does not touch.
#[test]
fn solve_and_sweep_agree_where_a_body_may_still_slide() {
    let both = r#"
mesh.rectangle = { width = 10, height = 10, nx = 10, ny = 10 }
material = { young = 210e3, poisson = 0.3 }
boundary.top.traction = [0, "-20 - x"]
obstacle.ground.plane = { point = [0, 0], normal = [0, 1] }
obstacle.west.plane = { point = [-1, 0], normal = [1, 0] }
obstacle.east.plane = { point = [11, 0], normal = [-1, 0] }
boundary.bottom.contact.obstacle = "ground"
boundary.left.contact.obstacle = "west"
boundary.right.contact.obstacle = "east"
"#;
    let one: String =
        both.lines().filter(|line| !line.contains("east")).map(|l| format!("{l}\n")).collect();
    let one = one.replace("boundary.right", "# boundary.right");
    let folder = with_files("slide", &[("both.toml", both), ("one.toml", &one)]);
    let loads = "boundary.top.traction=[0,\"-10-x\"],[0,\"-20-x\"]";
    for (name, ends) in [("both", true), ("one", false)] {
        let file = format!("{name}.toml");
        let message = said(&folder, &["solve", &file], 0);
        assert!(message.contains("the body can still move along (1, 0)"), "{message}");
        assert!(message.contains("'left' touches nothing: it is nearest to 'west'"), "{message}");
        said(&folder, &["sweep", &file, "--quiet", "--files", "--out", "swept", "--set", loads], 0);
        let [alone, last] = [result(&folder, &format!("out/{name}")), result(&folder, "swept/2")];
        let largest = |result: &Value| result["quantities"]["max_displacement"].as_f64().unwrap();
        // Newton's method ends at 1e-10.
        approx::assert_relative_eq!(largest(&alone), largest(&last), max_relative = 1e-8);
        assert_eq!(alone["method"]["slides"], 1);
        let play = &alone["play"][0];
        assert_eq!(play["most"].is_number(), ends, "{play}");
        assert!(play["least"].is_number(), "{play}");
    }
}

#[test]
fn a_shoe_on_a_pivot_without_loads_is_held_by_what_it_presses() {
    let folder = shoe("pivot");
    said(&folder, &["solve", "case.toml", "--quiet"], 0);
    let result = result(&folder, "out/case");
    assert_eq!((&result["verdict"], &result["method"]["slides"]), (&"proved".into(), &0.into()));
    assert!(result["quantities"]["contact_force"].as_f64().unwrap() > 0.0);
}

const SMALL: &str = r#"
mesh.rectangle = { width = 1, height = 1, nx = 2, ny = 2 }
material = { young = 1, poisson = 0.3 }
boundary.top.displacement = ["0", "-0.1"]
boundary.bottom.contact = {}
"#;

#[test]
fn units_with_control_characters_forge_no_lines_and_leave_the_picture_whole() {
    let forged = "units = { length = \"mm\\u001b\\nerror: this line is of the case file\\n  proved       all\", force = \"N\" }";
    let folder = with_files("units", &[("case.toml", &format!("{forged}\n{SMALL}"))]);
    let message = said(&folder, &["solve", "case.toml"], 0);
    let forges = |line: &str| line.starts_with("error") || line.starts_with("  proved       all");
    assert!(!message.lines().any(forges) && !message.contains('\u{1b}'), "{message}");
    let picture = fs::read_to_string(folder.join("out/case/picture.svg")).unwrap();
    assert!(!picture.chars().any(|c| c.is_control() && c != '\n'));
}

#[test]
fn a_picture_that_doubles_cannot_hold_costs_nothing_else() {
    let large = SMALL.replace("height = 1,", "height = 100,").replace("-0.1", "-10");
    let stretched = format!("{large}output.stretch = 1.5e308\n");
    let folder = with_files("picture", &[("case.toml", &large), ("stretched.toml", &stretched)]);
    said(&folder, &["solve", "case.toml", "--out", "out", "--quiet"], 0);
    assert!(folder.join("out/picture.svg").exists(), "control");
    let message = said(&folder, &["solve", "stretched.toml", "--out", "out", "--report"], 3);
    assert!(message.contains("; NO picture: "), "{message}");
    assert!(!folder.join("out/picture.svg").exists() && folder.join("out/report.html").exists());
    let result = result(&folder, "out");
    assert_eq!(result["verdict"], "proved");
    assert!(result["missing"][0].as_str().unwrap().ends_with("expected a finite number"));
}

/// A step too few on a finer level, and a first level that ends before its last correction is known.
#[test]
fn steps_that_run_out_on_a_finer_level_of_adapt_lose_nothing() {
    let target = ["adapt.target=\"0.01 %\"", "adapt.max_unknowns=2500"];
    let coarse = ["method.degree=1", "method.gamma0=auto"];
    let cases = root().join("cases");
    let folder = with_files("steps", &[]);
    let adapted = |cells: usize, steps: usize| {
        let steps = format!("solver.max_iterations={steps}");
        let cells = ["nx", "ny"].map(|n| format!("mesh.rectangle.{n}={cells}"));
        let file = cases.join("block.toml").display().to_string();
        let mut arguments = vec!["solve", &file, "--out", "out"];
        for setting in target.iter().chain(&coarse).chain([&&*cells[0], &&*cells[1], &&*steps]) {
            arguments.extend(["--set", setting]);
        }
        said(&folder, &arguments, 3);
        result(&folder, "out")
    };
    let result = adapted(2, 3);
    let missing = result["missing"][0].as_str().unwrap();
    assert!(missing.contains("level 2 has no solution: no convergence: "), "{missing}");
    assert!(missing.ends_with("expected at most 1e-10"), "{missing}");
    let levels = result["adapt"]["levels"].as_array().unwrap();
    assert_eq!((levels.len(), &result["adapt"]["level"]), (2, &1.into()));
    assert_eq!(levels[1]["bound"], result["certificate"]["continuous"]["bound"]);
    adapted(4, 4);
}

/// A block tilted onto a floor, by its distance.
const STRIP: &str = r#"
mesh.rectangle = { width = 1, height = 1, nx = 32, ny = 32 }
material = { lambda = 1, mu = 1 }
boundary.top.displacement = ["0", "-0.1 + 0.15*x"]
obstacle.o = { distance = "y" }
boundary.bottom.contact = { obstacle = "o" }
"#;

#[test]
fn the_strip_of_a_bound_with_a_reservation_says_so() {
    let round = STRIP.replace("distance = \"y\"", "distance = \"y + 0*sin(x)\"");
    let folder = with_files("strip", &[("plane.toml", STRIP), ("round.toml", &round)]);
    let said_below = |case: &str| {
        said(&folder, &["solve", case, "--certificate", "--report", "--out", "out"], 0);
        let read = |file: &str| fs::read_to_string(folder.join("out").join(file)).unwrap();
        let (picture, report) = (read("picture.svg"), read("report.html"));
        let has = |words: &str| picture.contains(words) && report.contains(words);
        assert!(has("mean opening ≤") && has("mean pressure ≤"), "{case}");
        [has("proved:"), has("with a reservation:")]
    };
    assert_eq!(said_below("round.toml"), [false, true]);
    assert_eq!(said_below("plane.toml"), [true, false], "control");
}
