//! What a person gets of a body of revolution: summary, files, report, sweep; and what is refused in the case file.

use std::path::Path;
use std::process::{Command, Output};

use approx::abs_diff_eq;
const CASE: &str = r#"title = "Cylinder"
mesh.rectangle = { width = 1.0, height = 1.0, nx = 6, ny = 6 }
material = { young = 1.0, poisson = 0.3 }
[body]
plane = "axisymmetric"
[boundary.top]
displacement = ["free", -0.02]
[boundary.bottom]
contact.obstacle = "it"
"#;

const FLOOR: &str = "[obstacle.it]\nplane = { point = [0, 0], normal = [0, 1] }\n";

fn signorini(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_program"))
        .args(arguments)
        .current_dir(crate::common::root())
        .output()
        .unwrap()
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("revolution").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The case written into a folder of its own and solved; standard output or error, whichever there is, and the exit code.
fn solved(name: &str, text: &str, more: &[&str]) -> (String, Option<i32>) {
    let folder = folder(name);
    let file = folder.join("case.toml");
    std::fs::write(&file, text).unwrap();
    let out = folder.join("out");
    let mut arguments = vec!["solve", file.to_str().unwrap(), "--out", out.to_str().unwrap()];
    arguments.extend(more);
    let output = signorini(&arguments);
    let said = if output.stdout.is_empty() { output.stderr } else { output.stdout };
    (String::from_utf8(said).unwrap(), output.status.code())
}

#[test]
fn the_summary_says_what_each_obstacle_is_all_round_and_that_forces_are_of_the_whole() {
    let circle = |r: f64| {
        format!(
            "[obstacle.it]\ncircle = {{ center = [{r}, -1.0], radius = 1, side = \"outside\" }}\n"
        )
    };
    let plane = |[r, z]: [f64; 2], point: [f64; 2]| {
        format!("[obstacle.it]\nplane = {{ point = {point:?}, normal = [{r}, {z}] }}\n")
    };
    for (name, obstacle, shape) in [
        ("plane", plane([0.0, 1.0], [0.0, 0.0]), "a plane"),
        ("cone", plane([0.05, 1.0], [0.0, 0.0]), "a cone"),
        ("sphere", circle(0.0), "a sphere"),
        ("torus", circle(0.5), "a torus"),
    ] {
        let (said, code) = solved(name, &(CASE.to_owned() + &obstacle), &[]);
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains(&format!("the obstacle 'it' is {shape}\n")), "{said}");
        assert!(said.contains("forces along y and energies are those of the whole revolution"));
        assert!(said.contains("hoop from "), "{said}");
        // There are no certificates to ask for.
        assert!(said.contains("solved       exactly for this mesh"));
        assert!(!said.contains("--certificate"), "{said}");
    }
    let hub = folder("hub");
    let output = signorini(&["solve", "cases/hub.toml", "--out", hub.to_str().unwrap()]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("the obstacle 'shaft' is a cylinder\n"), "{said}");
    // The control: a plane body has none of that.
    let (said, _) = solved("strain", &(CASE.replace("axisymmetric", "strain") + FLOOR), &[]);
    assert!(said.contains("solved       exactly"), "{said}");
    assert!(!said.contains("hoop") && !said.contains("body of revolution"), "{said}");
}

#[test]
fn all_files_have_the_hoop_stress_or_the_mirror_image() {
    let (said, code) = solved("files", &(CASE.to_owned() + FLOOR), &["--report"]);
    assert_eq!(code, Some(0), "{said}");
    let read = |file: &str| std::fs::read_to_string(folder("files/out").join(file)).unwrap();
    let result: serde_json::Value = serde_json::from_str(&read("result.json")).unwrap();
    // A pressure of 0.02 on pi, and no radial force but that of a radian.
    let reaction = &result["quantities"]["reactions"]["top"];
    let whole = 0.02 * std::f64::consts::PI;
    assert!(abs_diff_eq!(reaction[1].as_f64().unwrap(), -whole, epsilon = 1e-12), "{reaction}");
    assert_eq!(reaction[0].as_f64(), Some(0.0));
    for key in ["hoop_max", "hoop_min"] {
        assert!(result["stress"][key]["value"].as_f64().unwrap().abs() < 1e-12);
    }
    let vtu =
        String::from_utf8_lossy(&std::fs::read(folder("files/out").join("solution.vtu")).unwrap())
            .into_owned();
    assert!(vtu.contains("\"hoop_stress\"") && vtu.contains("\"nodal_hoop_stress\""));
    let picture = read("picture.svg");
    assert!(picture.contains("scale(-1"), "no mirror image");
    assert!(read("report.html").contains("those of the whole revolution"));
    solved("flat", &(CASE.replace("axisymmetric", "strain") + FLOOR), &[]);
    let flat = std::fs::read_to_string(folder("flat/out").join("picture.svg")).unwrap();
    assert!(!flat.contains("scale(-1"), "the control: a plane body has no mirror image");
}

#[test]
fn a_sweep_has_forces_of_the_whole_revolution() {
    let folder = folder("sweep");
    let file = folder.join("case.toml");
    std::fs::write(&file, CASE.to_owned() + FLOOR).unwrap();
    let out = folder.join("out");
    let out = out.to_str().unwrap();
    let values = "material.young=1,2";
    let output = signorini(&["sweep", file.to_str().unwrap(), "--set", values, "--out", out]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = std::fs::read_to_string(folder.join("out/sweep.csv")).unwrap();
    let lines: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let column = lines[0].iter().position(|name| *name == "contact_force").unwrap();
    for (line, young) in lines[1..].iter().zip([1.0, 2.0]) {
        let force: f64 = line[column].parse().unwrap();
        assert!(
            abs_diff_eq!(force, young * 0.02 * std::f64::consts::PI, epsilon = 1e-12),
            "{table}"
        );
    }
}

#[test]
fn a_certificate_that_is_asked_for_is_missing_with_its_reason_and_exit_code_3() {
    let (said, code) = solved("certificate", &(CASE.to_owned() + FLOOR), &["--certificate"]);
    assert_eq!(code, Some(3), "{said}");
    assert!(
        said.contains("the body is one of revolution, and certificates are about plane bodies")
    );
}

#[test]
fn what_a_body_of_revolution_has_not_is_refused_with_place_found_and_expected() {
    let case = CASE.to_owned() + FLOOR;
    let with = |old: &str, new: &str| {
        assert!(case.contains(old), "{old}");
        case.replacen(old, new, 1)
    };
    let orthotropic = |rest: &str| {
        format!(
            "material.orthotropic = {{ e1 = 2, e2 = 1, nu12 = 0.3, g12 = 0.5, e3 = 2, nu13 = 0.4, nu23 = 0.15{rest} }}"
        )
    };
    let material = "material = { young = 1.0, poisson = 0.3 }";
    let right = |condition: &str| {
        with("[boundary.top]", &format!("[boundary.right]\n{condition}\n[boundary.top]"))
    };
    for (name, text, said) in [
        (
            "thickness",
            with("[body]\n", "[body]\nthickness = 2\n"),
            "expected no thickness: the results of a body of revolution are those of the whole of it",
        ),
        (
            "radial",
            right("force = [1, 0]"),
            "expected [0, Fz] on a body of revolution, whose radial forces cancel all round",
        ),
        ("torque", right("torque = 1"), "torsion is not computed by this program"),
        (
            "friction",
            with("contact.obstacle = \"it\"", "contact = { obstacle = \"it\", friction = 0.3 }"),
            "expected no friction in a body of revolution, where it is not computed by this program",
        ),
        (
            "axis",
            with("[boundary.top]", "[boundary.left]\nnormal = 0\n[boundary.top]"),
            "the condition on the axis of revolution is one on the boundary 'left'",
        ),
        (
            "angle",
            with(material, &orthotropic(", angle = 30")),
            "a multiple of 90: in a body of revolution the axes of a material are r, z and the hoop",
        ),
        (
            "stiffness",
            with(material, "material.stiffness = [12, 3, 2, 5, -1, 2]"),
            "orthotropic, whose third axis is the hoop",
        ),
        (
            "two",
            with(material, "material = { young = 1.0, poisson = 0.3, plane = \"stress\" }"),
            "plane stress beside [body] plane axisymmetric",
        ),
        (
            "away",
            with("displacement = [\"free\", -0.02]", "force = [0, 1]"),
            "the loads drive it with a force of 1;",
        ),
    ] {
        let (found, code) = solved(name, &text, &[]);
        assert_eq!(code, Some(2), "{name}: {found}");
        assert!(found.contains(said), "{name}: {found}");
    }
    // The controls: what differs from these in one word is solved.
    for (name, text) in
        [("as it is", case.clone()), ("by 90", with(material, &orthotropic(", angle = 180")))]
    {
        let (found, code) = solved(name, &text, &[]);
        assert_eq!(code, Some(0), "{found}");
    }
}

/// A Gmsh file of two triangles: the square from r to r + 1.
fn gmsh([inner, next]: [f64; 2]) -> String {
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"bottom\"\n1 2 \"top\"\n2 3 \"body\"\n$EndPhysicalNames\n\
         $Nodes\n6\n1 {inner} 0 0\n2 {far} 0 0\n3 {far} 1 0\n4 {next} 1 0\n5 {far} 2 0\n6 {inner} 2 0\n$EndNodes\n\
         $Elements\n6\n1 1 2 1 1 1 2\n2 1 2 2 2 5 6\n3 2 2 3 3 1 2 3\n4 2 2 3 3 1 3 4\n5 2 2 3 3 4 3 5\n6 2 2 3 3 4 5 6\n$EndElements\n",
        far = inner.max(0.0) + 1.0,
    )
}

#[test]
fn vertices_next_to_the_axis_are_moved_onto_it_with_a_remark_and_those_beyond_it_are_refused() {
    let solve = |name: &str, radii: [f64; 2]| {
        std::fs::write(folder(name).join("body.msh"), gmsh(radii)).unwrap();
        let mesh = "mesh.rectangle = { width = 1.0, height = 1.0, nx = 6, ny = 6 }";
        solved(name, &(CASE.replace(mesh, "mesh.gmsh = \"body.msh\"") + FLOOR), &[])
    };
    let (said, code) = solve("snapped", [0.0, 1e-17]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("a vertex next to the axis was moved onto it"), "{said}");
    let (said, code) = solve("snapped below", [0.0, -1e-17]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("a vertex next to the axis was moved onto it"), "{said}");
    let (said, code) = solve("not snapped", [0.0, 0.0]);
    assert_eq!(code, Some(0), "{said}");
    assert!(!said.contains("next to the axis"), "{said}");
    let (said, code) = solve("beyond", [-0.25, 0.0]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("a vertex at (-0.25, 0)") && said.contains("the axis, which is x = 0"),
        "{said}"
    );
}
