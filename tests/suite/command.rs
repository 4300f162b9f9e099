//! What the command promises: exit codes, messages that say what is wrong and where, files whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub const CASE: &str = r#"title = "Block"
[mesh]
rectangle = { width = 1.0, height = 1.0, nx = 4, ny = 4 }
[material]
lambda = 1.0
mu = 1.0
[load]
body = ["0", "-4 + 10*x"]
[boundary.top]
displacement = ["0", "0"]
[boundary.bottom]
contact = { gap = "0" }
[output]
probes = [[0.0, 0.0], [0.3, 0.1]]
"#;

/// The mesh of the case.
pub const RECTANGLE: &str = "rectangle = { width = 1.0, height = 1.0, nx = 4, ny = 4 }";

/// The case, the first text of each edit replaced by the second.
pub fn edited(edits: &[[&str; 2]]) -> String {
    edits.iter().fold(CASE.to_owned(), |text, [old, new]| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    })
}

/// A fresh folder with the edited case as `case.toml` in it.
pub fn folder(test: &str, edits: &[[&str; 2]]) -> PathBuf {
    with_files(test, &[("case.toml", &edited(edits))])
}

/// A fresh folder with the case of a shoe that a point holds, and its mesh.
pub fn shoe(test: &str) -> PathBuf {
    let case = r#"
title = "Shoe"
mesh.gmsh = "pivot.msh"
material = { young = 1, poisson = 0.3 }
point.pivot.displacement = ["0", "-0.01"]
boundary.foot.contact.gap = "0.002*x"
"#;
    with_files(test, &[("pivot.msh", include_str!("../meshes/pivot.msh")), ("case.toml", case)])
}

/// A fresh folder with these files in it.
pub fn with_files(test: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
    folder
}

pub fn signorini(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_program"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// The exit code and what is on standard error.
pub fn ended(output: &Output) -> (Option<i32>, &str) {
    (output.status.code(), text(&output.stderr))
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

pub const FILES: [&str; 5] =
    ["contact.csv", "contact.vtu", "picture.svg", "result.json", "solution.vtu"];

#[test]
fn a_solved_case_writes_its_files_and_says_so_with_exit_code_0() {
    let folder = folder("solved", &[]);
    let output = signorini(&folder, &["solve", "case.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(names(&folder.join("out/case")), FILES);
    let said = text(&output.stdout);
    for line in [
        "Block\n",
        "  contact      bottom: force ",
        "  solved       exactly for this mesh, to ",
        " digits, rounding included; how far the mesh is off: --certificate\n",
    ] {
        assert!(said.contains(line), "{said}");
    }
    assert_eq!(text(&output.stderr), "");
    let rows = fs::read_to_string(folder.join("out/case/contact.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 2 * 4);
    assert!(
        rows.starts_with("arc,x,y,u_n,gap,sigma_n,lambda,pressure,boundary\n0.0,0.0,0.0,"),
        "{rows}"
    );
}

#[test]
fn how_it_was_solved_is_printed_on_demand() {
    let folder = folder("verbose", &[]);
    let output = signorini(&folder, &["solve", "case.toml"]);
    let brief = text(&output.stdout).to_owned();
    let output = signorini(&folder, &["solve", "case.toml", "--verbose"]);
    let said = text(&output.stdout);
    for line in [
        "  mesh         32 P1 triangles, 50 unknowns, 4 contact edges",
        "kappa = 0.5 < 1",
        "  newton       converged in ",
        "  accuracy     ",
        "  balance      ",
    ] {
        assert!(said.contains(line) && !brief.contains(line), "{line}: {said}");
    }
}

#[test]
fn a_boundary_that_carries_only_rounding_is_not_in_contact() {
    let lifted = [["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\", \"4\"]"]];
    let folder = folder("lifted", &lifted);
    let output = signorini(&folder, &["solve", "case.toml"]);
    let said = text(&output.stdout);
    assert!(said.contains("  contact      bottom: no contact\n"), "{said}");
}

/// The reaction of the top of a block that a force presses on the floor, as the summary has it.
#[test]
fn a_force_is_spread_over_its_boundary_and_forces_are_those_of_the_whole_thickness() {
    let units = "[units]\nlength = \"mm\"\nforce = \"N\"\n[load]";
    for (thickness, unit) in [("", "N/mm"), ("[body]\nthickness = 20\n", "N")] {
        let pressed = [
            ["displacement = [\"0\", \"0\"]", "force = [0, -0.5]"],
            ["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\", \"0\"]"],
            ["[load]", &format!("{thickness}{units}")],
        ];
        let folder = folder(&format!("force-{}", unit.len()), &pressed);
        let output = signorini(&folder, &["solve", "case.toml"]);
        let said = text(&output.stdout);
        let expected = format!("bottom: force 0.5 {unit} (0, 0.5), length 1 mm\n");
        assert!(said.contains(&expected), "{said}{}", text(&output.stderr));
        let results = fs::read_to_string(folder.join("out/case/result.json")).unwrap();
        let results: serde_json::Value = serde_json::from_str(&results).unwrap();
        let force = results["quantities"]["contact_force"].as_f64().unwrap();
        approx::assert_relative_eq!(force, 0.5, max_relative = 1e-9);
    }
}

#[test]
fn quiet_prints_nothing_and_out_names_the_folder() {
    let folder = folder("quiet", &[]);
    let output = signorini(&folder, &["solve", "case.toml", "--quiet", "--out", "here/there"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
    assert_eq!(names(&folder.join("here/there")), FILES);
}

#[test]
fn everything_but_the_seconds_is_the_same_to_the_bit_in_a_second_run() {
    let folder = folder("twice", &[]);
    for degree in ["method.degree=1", "method.degree=2"] {
        let [a, b] = ["a", "b"].map(|out| {
            let arguments = ["solve", "case.toml", "--out", out, "--set", degree];
            assert!(signorini(&folder, &arguments).status.success());
            FILES.map(|name| {
                let text = fs::read_to_string(folder.join(out).join(name)).unwrap();
                text.split("\"seconds\"").next().unwrap().to_owned()
            })
        });
        assert!(a == b, "{degree}");
    }
}

#[test]
fn check_reports_and_writes_nothing() {
    let folder = folder("check", &[]);
    let output = signorini(&folder, &["check", "case.toml"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(
        text(&output.stdout),
        "Block
  mesh         32 P1 triangles, 50 unknowns, 4 contact edges, h = 0.3536
  boundaries   bottom: contact, initial gap 0, length 1
               top: displacement prescribed, length 1
               left: nothing is prescribed, length 1
               right: nothing is prescribed, length 1
  body         total load (0, 1)
  held         by its supports
  prescribed   10 of the unknowns
  coercivity   gamma0 = 0.05893 (limit 0.1179 at the edge (0, 0)-(0.25, 0)), kappa = 0.5 < 1: coercive
  quadrature   exact: contact edges are cut at the roots of P
"
    );
    assert_eq!(names(&folder), ["case.toml"]);
}

#[test]
fn check_says_what_acts_on_each_boundary_and_what_contact_holds() {
    let edits = [
        ["displacement = [\"0\", \"0\"]", "force = [0, -3]"],
        ["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\", \"0\"]"],
        [
            "contact = { gap = \"0\" }",
            "contact = { gap = \"0.1*x\" }\n[boundary.left]\nnormal = 0\n[boundary.edge]\nwhere = \"x > 0.99 and y < 0.6\"\npressure = 2",
        ],
    ];
    let output = signorini(&folder("check-listed", &edits), &["check", "case.toml"]);
    let said = text(&output.stdout);
    assert_eq!(ended(&output), (Some(0), ""));
    for line in [
        "boundaries   bottom: contact, initial gap from 0 at (0, 0) to 0.1, length 1",
        "edge: pressure, total load (-1, 0), length 0.5",
        "left: displacement along the normal prescribed, length 1",
        "top: traction, total load (0, -3), length 1",
        "right: nothing is prescribed, length 1",
    ] {
        assert!(said.contains(line), "{line} in {said}");
    }
    let edits = [
        edits[0],
        edits[1],
        ["contact = { gap = \"0\" }", "contact = {}\n[boundary.left]\nnormal = 0"],
    ];
    let output = signorini(&folder("check-held", &edits), &["check", "case.toml"]);
    let lifted = [["displacement = [\"0\", \"0\"]", "force = [0, 3]"], edits[1]];
    let not_held = signorini(&folder("check-not-held", &lifted), &["check", "case.toml"]);
    assert_eq!(not_held.status.code(), Some(2));
    let listed = "top: traction, total load (0, 3), length 1";
    assert!(text(&not_held.stdout).contains(listed), "{}", text(&not_held.stdout));
    let held = "held         by contact: supports leave 1 rigid motion free, and the loads press the body against what stops it";
    assert!(text(&output.stdout).contains(held), "{}", text(&output.stdout));
}

#[test]
fn new_writes_a_pair_for_bodies_that_touch_each_other() {
    let folder = with_files("new_pair", &[]);
    for (mesh, pairs) in [
        ("reference/pairs/apart.msh", &["\"low\", \"up\""][..]),
        ("cases/pin_lug.msh", &["\"hole\", \"pin\""]),
        (
            "cases/stack.msh",
            &["\"lower_top\", \"middle_bottom\"", "\"middle_top\", \"upper_bottom\""],
        ),
        // Bodies that share the nodes of their line are glued there, as far as a mesh can say.
        ("reference/pairs/joined.msh", &[]),
    ] {
        let name = Path::new(mesh).file_name().unwrap().to_str().unwrap();
        fs::copy(crate::common::root().join(mesh), folder.join(name)).unwrap();
        let output = signorini(&folder, &["new", name]);
        assert_eq!(output.status.code(), Some(0), "{mesh}: {output:?}");
        let case = name.replace(".msh", ".toml");
        let text = fs::read_to_string(folder.join(&case)).unwrap();
        assert_eq!(text.matches("[[pair]]").count(), pairs.len(), "{text}");
        assert!(pairs.iter().all(|pair| text.contains(pair)), "{text}");
    }
    // What it writes can be solved at once, unless a body would slide off the other one.
    let output = signorini(&folder, &["solve", "stack.toml"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

/// What `new` writes for any mesh is a case that is sound and can be solved.
#[test]
fn new_writes_a_case_that_can_be_solved_and_replaces_no_file() {
    let meshes = [
        "msh41",
        "numbers_only",
        "no_curves",
        "one_surface_clockwise",
        "quadrangles",
        "meshio_bare",
    ];
    let folder = with_files("new", &[]);
    let variants = crate::common::root().join("tests/meshes/variants");
    for name in meshes {
        let mesh = format!("{name}.msh");
        fs::copy(variants.join(&mesh), folder.join(&mesh)).unwrap();
        let output = signorini(&folder, &["new", &mesh]);
        assert_eq!(ended(&output), (Some(0), ""), "{name}");
        let case = format!("{name}.toml");
        let next = format!("next         signorini check {case}; signorini solve {case}\n");
        assert!(text(&output.stdout).ends_with(&next), "{}", text(&output.stdout));
        let solved = signorini(&folder, &["solve", &case, "--quiet"]);
        assert_eq!(ended(&solved), (Some(0), ""), "{name}");
    }
    let written = fs::read_to_string(folder.join("one_surface_clockwise.toml")).unwrap();
    for part in [
        "[material.left]",
        "[material.right]",
        "[boundary.top]     # length 2, x = 0 to 2, y = 1\n",
    ] {
        assert!(written.contains(part), "{written}");
    }
    let written = fs::read_to_string(folder.join("no_curves.toml")).unwrap();
    assert!(
        written.contains("[boundary.bottom]") && written.contains("where = \"y < "),
        "{written}"
    );
    let again = signorini(&folder, &["new", "msh41.msh"]);
    let said = "error: msh41.toml: there is such a file; expected another name: --out CASE.toml\n";
    assert_eq!(ended(&again), (Some(2), said));
    let other = signorini(&folder, &["new", "msh41.msh", "--out", "other.toml", "--quiet"]);
    assert_eq!((ended(&other), text(&other.stdout)), ((Some(0), ""), ""));
    let missing = signorini(&folder, &["new", "nothing.msh"]);
    assert_eq!(ended(&missing), (Some(2), "error: nothing.msh: there is no such file\n"));
}

/// A table of quantities alone asks for the certificate that has them.
#[test]
fn the_table_certify_alone_is_not_without_effect() {
    let with = [["[output]", "[certify]\nquantities = [\"force bottom\"]\n[output]"]];
    let output = signorini(&folder("certify-alone", &with), &["solve", "case.toml"]);
    assert!(text(&output.stdout).contains(", proved between "), "{}", text(&output.stdout));
    let control = signorini(&folder("certify-not", &[]), &["solve", "case.toml"]);
    assert!(!text(&control.stdout).contains(", proved between "), "control");
}

/// Cases that are wrong in a way that shows only on the mesh: exit code 2, the message, and nothing written.
#[test]
fn wrong_cases_end_with_exit_code_2_and_write_nothing() {
    let left = "[boundary.left]\ndisplacement";
    let rows: [(&str, &[[&str; 2]], &str); 14] = [
        (
            "missing",
            &[["mu = 1.0", ""]],
            "case.toml:4: [material]: found lambda; expected lambda and mu, young and poisson, stiffness, or orthotropic",
        ),
        (
            "limit",
            &[["[load]", "[method]\ngamma0 = 0.2\n[load]"]],
            "case.toml: gamma0 = 0.2 gives kappa = 1.6971, and coercivity needs kappa < 1: expected gamma0 below 0.1178511301977579, the limit set by the contact edge from (0, 0) to (0.25, 0); lower gamma0, say \"auto\", or set allow_noncoercive = true to go on without any promise",
        ),
        (
            "limit-p2",
            &[["[load]", "[method]\ngamma0 = 0.1\ndegree = 2\n[load]"]],
            "case.toml: gamma0 = 0.1 gives kappa = 2.5456, and coercivity needs kappa < 1: expected gamma0 below 0.039283710065919304, the limit set by the contact edge from (0, 0) to (0.25, 0); lower gamma0, say \"auto\", or set allow_noncoercive = true to go on without any promise",
        ),
        (
            "free",
            &[["[boundary.top]\ndisplacement = [\"0\", \"0\"]\n", ""]],
            "case.toml: the body is not held: nothing stops the rotation about (0, 0.5): u_x off the line y = 0.5 would stop it, or u_y off x = 0; the loads drive it with a moment of 1.333; expected a support that stops it, such as displacement = [0, 0] or normal = 0 on a boundary, or loads that press the body against its obstacles (contact can push, not pull)",
        ),
        (
            "sliding",
            &[
                ["displacement = [\"0\", \"0\"]", "displacement = [\"free\", \"0\"]"],
                ["body = [\"0\"", "body = [\"1\""],
            ],
            "case.toml: the body is not held: nothing stops the translation along (1, 0): u_x would stop it; the loads drive it with a force of 1; expected a support that stops it, such as displacement = [0, 0] or normal = 0 on a boundary, or loads that press the body against its obstacles (contact can push, not pull)",
        ),
        (
            "sliding-up",
            &[["displacement = [\"0\", \"0\"]", "displacement = [\"0\", \"free\"]"]],
            "case.toml: the body is not held: nothing stops the rotation about (0, 1): u_x off the line y = 1 would stop it, or u_y off x = 0; the loads drive it with a moment of 1.333; expected a support that stops it, such as displacement = [0, 0] or normal = 0 on a boundary, or loads that press the body against its obstacles (contact can push, not pull)",
        ),
        (
            "disagree",
            &[["[output]", &format!("{left} = [\"0.1\", \"0\"]\n[output]")]],
            "case.toml: the displacement boundaries 'left' and 'top' meet at (0, 1) and disagree there: u_x = 0.1 and 0; expected one value",
        ),
        (
            "infinite-load",
            &[["-4 + 10*x", "1/(x - x)"]],
            "case.toml: [load] body[1] is inf at (0.011727519257667005, 0.0005501388317558017); expected a finite number at every point of the mesh",
        ),
        (
            "nan-load",
            &[["-4 + 10*x", "sqrt(-x)"]],
            "case.toml: [load] body[1] is NaN at (0.011727519257667005, 0.0005501388317558017); expected a finite number at every point of the mesh",
        ),
        (
            "infinite-gap",
            &[["gap = \"0\"", "gap = \"1/x\""]],
            "case.toml: [boundary.bottom] contact.gap is inf at (0, 0); expected a finite number at every point of the mesh",
        ),
        (
            "infinite-displacement",
            &[["displacement = [\"0\", \"0\"]", "displacement = [\"0\", \"1/(x - 0.5)\"]"]],
            "case.toml: [boundary.top] displacement[1] is inf at (0.5, 1); expected a finite number at every point of the mesh",
        ),
        (
            "infinite-traction",
            &[["[output]", "[boundary.left]\ntraction = [\"0\", \"exp(1000*(1 + y))\"]\n[output]"]],
            "case.toml: [boundary.left] traction[1] is inf at (0, 0.23827248074233298); expected a finite number at every point of the mesh",
        ),
        (
            "probe",
            &[["[0.3, 0.1]", "[0.3, -0.1]"]],
            "case.toml:14: [output] probes[1] = [0.3, -0.1]; expected a point of the body",
        ),
        (
            "no-contact",
            &[["contact = { gap = \"0\" }", "traction = [\"0\", \"0\"]"]],
            "case.toml:9: [boundary]: found no contact; expected one boundary with contact, such as [boundary.bottom] contact = { gap = \"0\" }, or a [[pair]] of boundaries",
        ),
    ];
    let mut wrong = Vec::new();
    for (test, edits, expected) in rows {
        let folder = folder(test, edits);
        let output = signorini(&folder, &["solve", "case.toml"]);
        let expected = format!("error: {expected}\n");
        if ended(&output) != (Some(2), &expected) {
            wrong.push(format!("{test}: {:?}\n{expected}", ended(&output)));
        }
        assert_eq!(names(&folder), ["case.toml"], "{test}");
        assert!(output.stdout.is_empty());
        let check = signorini(&folder, &["check", "case.toml"]);
        assert_eq!(ended(&check), ended(&output), "{test}");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Cases without a result: exit code 1, the message from its beginning to its end, and no files.
#[test]
fn cases_that_cannot_be_solved_or_written_end_with_exit_code_1() {
    for (test, edit, out, beginning, end) in [
        (
            "history",
            "[solver]\nmax_iterations = 1\n[load]",
            "out",
            "error: case.toml: no convergence: the relative residual is ",
            " after 1 Newton step, all that max_iterations allows; expected at most 1e-10\nresiduals: ",
        ),
        (
            "indefinite",
            "[method]\ngamma0 = 2\nallow_noncoercive = true\n[load]",
            "out",
            "error: case.toml: the tangent is not positive definite: gamma0 is beyond the true limit of coercivity, ",
            "J_h is not convex and a solution need not exist; lower gamma0\n",
        ),
        (
            "unwritable",
            "[load]",
            "case.toml/out",
            "error: cannot make the folder case.toml/out: ",
            "Not a directory\n",
        ),
    ] {
        let folder = folder(test, &[["[load]", edit]]);
        let output = signorini(&folder, &["solve", "case.toml", "--out", out]);
        let (code, said) = ended(&output);
        assert_eq!(code, Some(1), "{said}");
        assert!(said.starts_with(beginning) && said.contains(end), "{said}");
        assert_eq!(names(&folder), ["case.toml"]);
    }
}

#[test]
fn a_case_without_a_certificate_has_all_other_results_and_exit_code_3() {
    // A point is held, which a true solution does not feel.
    let folder = shoe("no-certificate");
    fs::create_dir_all(folder.join("out/case")).unwrap();
    fs::write(folder.join("out/case/certificate.json"), "of an earlier run").unwrap();
    let output = signorini(&folder, &["solve", "case.toml", "--certificate"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stdout).starts_with("Shoe: proved; NO certificate: "));
    let names = names(&folder.join("out/case"));
    assert!(names.contains(&"result.json".to_owned()), "{names:?}");
    assert!(!names.contains(&"certificate.json".to_owned()), "{names:?}");
}

#[test]
fn wrong_arguments_end_with_exit_code_2_and_what_was_probably_meant() {
    let folder = folder("tips", &[]);
    let tips @ [solve, set, json, commands, out, one] = [
        "tip: a case is solved by 'signorini solve CASE.toml'",
        "'--set method.degree=2'",
        "'--json'",
        "tip: the commands are new, check, solve",
        "'--out DIR'",
        "tip: one case at a time",
    ];
    for (arguments, tip) in [
        (&["case.toml"][..], solve),
        (&["solve", "case.toml", "--degree", "2"], set),
        (&["solve", "case.toml", "--jsn"], json),
        (&["run", "case.toml"], commands),
        (&["solve", "case.toml", "-o", "out"], out),
        (&["solve", "case.toml", "other.toml"], one),
        (&["solve"], ""),
        (&["slove", "case.toml"], ""),
        (&["solve", "nowhere.toml"], ""),
    ] {
        let output = signorini(&folder, arguments);
        let said = text(&output.stderr);
        assert!(output.status.code() == Some(2) && said.starts_with("error: "), "{said}");
        for other in tips {
            assert_eq!(said.contains(other), other == tip, "{arguments:?}: {said}");
        }
    }
}
