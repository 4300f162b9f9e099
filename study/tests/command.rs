//! The command `study convergence`: what it prints, what it writes, and what it refuses.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The root of the repository, where the cases are.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// An empty folder of this test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The exit code and the message.
fn ended(output: &Output) -> (Option<i32>, &str) {
    (output.status.code(), std::str::from_utf8(&output.stderr).unwrap())
}

fn run(case: &str, more: &[&str], out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_study"))
        .args(["convergence", case, "--out"])
        .arg(out)
        .args(more)
        .current_dir(ROOT)
        .output()
        .unwrap()
}

#[test]
fn tables_csv_and_figure_come_out_for_every_degree_and_mesh() {
    let out = folder("convergence-study").join("out");
    let more = ["--levels", "2", "--degree", "1,2", "--mesh", "structured,perturbed"];
    let output = run("cases/smooth.toml", &more, &out);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    for table in ["P1, structured", "P1, perturbed", "P2, structured", "P2, perturbed"] {
        assert!(text.contains(table), "{text}");
    }
    let csv = fs::read_to_string(out.join("convergence.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 4 * 2);
    assert!(fs::read_to_string(out.join("convergence.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn cases_that_cannot_be_studied_are_refused_and_nothing_is_written() {
    let out = folder("convergence-refused").join("out");
    let loads = out.with_file_name("loads.toml");
    let text = fs::read_to_string(Path::new(ROOT).join("cases/singular.toml")).unwrap();
    fs::write(&loads, text + "\n[load]\nbody = [\"0\", \"1\"]\n").unwrap();
    for (case, expected) in [
        (
            "cases/block.toml",
            "error: cases/block.toml: [exact] is missing; errors are measured against an exact solution\n",
        ),
        (
            "reference/cases/patch-d1-p1-exact.toml",
            "expected rectangle or trapezoid, which can be refined",
        ),
        (loads.to_str().unwrap(), "[load]: found loads beside [exact]"),
    ] {
        let output = run(case, &[], &out);
        let (code, said) = ended(&output);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(expected), "{said}");
        assert!(!out.exists(), "nothing is written");
    }
}

#[test]
fn a_corner_whose_errors_doubles_cannot_hold_says_so() {
    let out = folder("convergence-corner").join("out");
    let with = |omega: &str| {
        let [mesh, exact] =
            ["mesh.trapezoid.omega", "exact.omega"].map(|key| format!("{key}={omega}"));
        let more = ["--levels", "1", "--set", &mesh, "--set", &exact];
        let output = run("cases/corner.toml", &more, &out);
        let (code, said) = ended(&output);
        (code, said.to_owned())
    };
    let (code, said) = with("2.9");
    assert!(code == Some(1) && said.contains("beyond the range of doubles"), "{code:?}: {said}");
    assert_eq!(with("2.7").0, Some(0), "control");
}
