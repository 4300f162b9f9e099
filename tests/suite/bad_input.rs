//! Broken case files and meshes, each with the message that a person gets. Every row is one edit of a good file: what is
//! replaced, by what, and the message. Where the message begins with a place, so does the row.

mod mesh;
mod problem;

use std::fs;
use std::path::{Path, PathBuf};

use signorini::io::case::Case;

pub const CASE: &str = r#"title = "Block"
[mesh]
rectangle = { width = 1.0, height = 1.0, nx = 4, ny = 4, diagonal = "right" }
[material]
lambda = 1.0
mu = 1.0
plane = "strain"
[load]
body = ["0", "-4 + 10*x"]
[boundary.top]
displacement = ["0", "free"]
[boundary.bottom]
contact = { gap = "0" }
[method]
degree = 1
gamma0 = 0.1
contact_quadrature = "exact"
allow_noncoercive = false
[solver]
tolerance = 1e-10
max_iterations = 50
[output]
probes = [[0, 1], [0.5, 0.5]]
"#;

/// Two triangles: the square with the corners 1, 2, 3, 4 and its diagonal from 1 to 3; node 9 is used by none.
const MESH: &str = r#"$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "bottom"
1 2 "top"
2 3 "body"
$EndPhysicalNames
$Entities
0 3 1 0
1 0 0 0 1 0 0 1 1 0
2 0 1 0 1 1 0 1 2 0
3 0 0 0 0 1 0 0 0
1 0 0 0 1 1 0 1 3 0
$EndEntities
$Nodes
1 5 1 9
2 1 0 5
1
2
3
4
9
0 0 0
1 0 0
1 1 0
0 1 0
0.5 0.5 0
$EndNodes
$Elements
4 5 1 5
1 1 1 1
1 1 2
1 2 1 1
2 3 4
1 3 1 1
3 4 1
2 1 2 2
4 1 2 3
5 1 3 4
$EndElements
"#;

const WITH_MESH: [&str; 2] = [
    "rectangle = { width = 1.0, height = 1.0, nx = 4, ny = 4, diagonal = \"right\" }",
    "gmsh = \"bad.msh\"",
];

/// A directory of its own for each test, as tests run side by side.
fn directory(test: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bad_input").join(test);
    fs::create_dir_all(&directory).unwrap();
    directory
}

/// The message about bad.toml in this directory, with paths relative to it.
fn message(directory: &Path) -> String {
    let error = Case::read(&directory.join("bad.toml")).err();
    let message = error.map_or("nothing: the case was read".to_owned(), |e| e.to_string());
    message.replace(&format!("{}/", directory.display()), "")
}

/// `text` with one edit. A row that replaces nothing is itself a mistake.
fn edited(text: &str, [old, new]: [&str; 2]) -> String {
    assert_eq!(text.matches(old).count(), 1, "{old:?} should be there once");
    text.replacen(old, new, 1)
}

/// Compares all messages before it complains, so that one run shows all that changed.
fn compare<E: AsRef<str>>(rows: impl IntoIterator<Item = (String, E)>) {
    let mut count = 0;
    for (found, expected) in rows {
        let expected = expected.as_ref();
        if found != expected {
            println!("found:    {found}\nexpected: {expected}\n");
            count += 1;
        }
    }
    assert_eq!(count, 0, "messages that are not as expected, shown above");
}

fn compare_cases(test: &str, rows: &[([&str; 2], &str)]) {
    let directory = directory(test);
    compare(rows.iter().map(|&(edit, expected)| {
        fs::write(directory.join("bad.toml"), edited(CASE, edit)).unwrap();
        (message(&directory), expected)
    }));
}

/// The message about a case on the mesh file `bytes`, without what is always before it.
fn message_of_mesh(test: &str, bytes: &[u8]) -> String {
    let directory = directory(test);
    fs::write(directory.join("bad.toml"), edited(CASE, WITH_MESH)).unwrap();
    fs::write(directory.join("bad.msh"), bytes).unwrap();
    let message = message(&directory);
    message.strip_prefix("bad.toml:3: [mesh] gmsh: ").unwrap_or(&message).to_owned()
}

#[test]
fn the_files_are_good_before_the_edits() {
    let directory = directory("good");
    fs::write(directory.join("bad.toml"), CASE).unwrap();
    assert_eq!(message(&directory), "nothing: the case was read");
    fs::write(directory.join("bad.toml"), edited(CASE, WITH_MESH)).unwrap();
    fs::write(directory.join("bad.msh"), MESH).unwrap();
    assert_eq!(message(&directory), "nothing: the case was read");
}

#[test]
fn files_that_cannot_be_read() {
    let directory = directory("unreadable");
    let file = directory.join("bad.toml");
    let directory_as_case = directory.join("directory");
    fs::create_dir_all(directory_as_case.join("bad.toml")).unwrap();
    let write = |bytes: &[u8]| {
        fs::write(&file, bytes).unwrap();
        message(&directory)
    };
    compare([
        (message(&directory.join("nowhere")), "bad.toml: there is no such file"),
        (message(&directory_as_case), "bad.toml: this is a directory; expected a file"),
        (
            write(b"title = \"\xff\""),
            "bad.toml: byte 10 is not UTF-8; expected a text file, saved as UTF-8",
        ),
        (
            write(b""),
            r#"bad.toml: [mesh] is missing; expected rectangle = { .. } or gmsh = ".." in it"#,
        ),
        (write(&[0; 100]), "bad.toml:1: invalid TOML: expected KEY = VALUE"),
        (
            write(MESH.as_bytes()),
            "bad.toml:1: invalid TOML: this is a Gmsh mesh; expected a case file, which names it: [mesh] gmsh = \"FILE.msh\"",
        ),
        (
            write(b"{\"mesh\": {}}"),
            "bad.toml:1: invalid TOML: this is a JSON or an XML file; expected a case file in TOML",
        ),
        (
            write(edited(CASE, WITH_MESH).replace("bad.msh", "nowhere.msh").as_bytes()),
            "bad.toml:3: [mesh] gmsh: nowhere.msh: there is no such file",
        ),
        (
            write(edited(CASE, WITH_MESH).replace("bad.msh", "").as_bytes()),
            r#"bad.toml:3: [mesh] gmsh = ""; expected the name of a mesh file"#,
        ),
    ]);
}

#[test]
fn keys_tables_and_types() {
    compare_cases(
        "keys",
        &[
            (
                ["title = \"Block\"", "title = 3"],
                "bad.toml:1: title = 3; expected a text in quotes",
            ),
            (
                ["title = \"Block\"", "titel = \"Block\""],
                "bad.toml:1: unknown key 'titel'; expected title, mesh, material, load, exact, boundary, obstacle, point, method, solver, adapt, certify, output, units or body",
            ),
            (
                ["title = \"Block\"", "title = Block"],
                "bad.toml:1: invalid TOML at 'Block': expected a value; a text must be in quotes",
            ),
            (
                ["title = \"Block\"", "title = \"Block"],
                r#"bad.toml:1: invalid TOML: invalid basic string, expected `"`"#,
            ),
            (["[load]", "[load"], "bad.toml:8: invalid TOML: unclosed table, expected `]`"),
            (
                ["[load]", "[loads]"],
                "bad.toml:8: unknown key 'loads'; expected title, mesh, material, load, exact, boundary, obstacle, point, method, solver, adapt, certify, output, units or body",
            ),
            (
                ["[load]", "[exact]"],
                "bad.toml:8: [exact] solution is missing; expected the name of an exact solution",
            ),
            (["[load]", "[material]"], "bad.toml:8: invalid TOML at 'material': duplicate key"),
            (
                ["title = \"Block\"", "method = \"P1\""],
                "bad.toml:14: invalid TOML at 'method': duplicate key",
            ),
            (
                ["title = \"Block\"", "title = \"Block\"\ntitle = \"Block\""],
                "bad.toml:2: invalid TOML at 'title': duplicate key",
            ),
            (["mu = 1.0", "mu = 1.0\nmu = 2.0"], "bad.toml:7: invalid TOML at 'mu': duplicate key"),
            (
                ["mu = 1.0", "mu = 1.0\nnu = 0.3"],
                "bad.toml:7: unknown key 'nu' in [material]; expected lambda, mu, young, poisson, stiffness, across, orthotropic or plane",
            ),
            (
                ["mu = 1.0", "mu = 80 GPa"],
                "bad.toml:6: invalid TOML at '80 GPa': expected a number, without a unit ([units] names the units)",
            ),
            (
                ["mu = 1.0", "mu = \"80 GPa\""],
                "bad.toml:6: [material] mu = \"80 GPa\"; expected a number, without quotes and without a unit",
            ),
            (
                ["mu = 1.0", "mu = 1.0 // shear"],
                "bad.toml:6: invalid TOML at '1.0 // shear': expected a value; a comment begins with #",
            ),
            (
                ["mu = 1.0", "mu = .5"],
                "bad.toml:6: invalid TOML: expected a digit before the decimal point (0.5, not .5)",
            ),
            (
                ["[\"0\", \"free\"]", "[“0”, “free”]"],
                "bad.toml:11: invalid TOML at '“0”': expected straight quotes (\") around a text",
            ),
            (
                ["[\"0\", \"free\"]", "[\"0\", \"free\""],
                "bad.toml:12: invalid TOML: expected ',' or ']'; is a list or a text above not closed?",
            ),
            (
                ["[\"0\", \"free\"]", "[\"0\", \"fre\"]"],
                "bad.toml:11: [boundary.top] displacement[1] = \"fre\"; expected an expression, or \"free\"",
            ),
            (
                [WITH_MESH[0], "gmsh = \"C:\\mesh\\part.msh\""],
                "bad.toml:3: invalid TOML: a backslash in \"...\" begins an escape; expected '/' in a path, or the text in '...'",
            ),
            (
                ["mu = 1.0", "mu = \"1.0\""],
                r#"bad.toml:6: [material] mu = "1.0"; expected a number"#,
            ),
            (["mu = 1.0", "mu = true"], "bad.toml:6: [material] mu = true; expected a number"),
            (
                ["mu = 1.0", "mu = 1,0"],
                "bad.toml:6: invalid TOML: expected a value; an expression must be in quotes (\"0.1 - x\"), a list in brackets, and decimals have a point (0.5, not 0,5)",
            ),
            (
                ["mu = 1.0", "mu = "],
                "bad.toml:6: invalid TOML: expected a value; a text must be in quotes",
            ),
            (["mu = 1.0", "mu = nan"], "bad.toml:6: [material] mu = nan; expected a finite number"),
            (["mu = 1.0", "mu = inf"], "bad.toml:6: [material] mu = inf; expected a finite number"),
            (
                ["mu = 1.0", "mu = -inf"],
                "bad.toml:6: [material] mu = -inf; expected a finite number",
            ),
            (
                ["mu = 1.0", "mu = 1e999"],
                "bad.toml:6: [material] mu = 1e999; expected a finite number",
            ),
            (
                ["mu = 1.0", "mu = [1.0]"],
                "bad.toml:6: [material] mu = a list of 1; expected a number",
            ),
            (
                ["mu = 1.0", "mu = 2024-01-01"],
                "bad.toml:6: [material] mu = 2024-01-01; expected a number",
            ),
            (
                ["allow_noncoercive = false", "allow_noncoercive = \"no\""],
                r#"bad.toml:18: [method] allow_noncoercive = "no"; expected true or false"#,
            ),
        ],
    );
}

#[test]
fn absurd_files() {
    let directory = directory("absurd");
    let message_of = |edit: [&str; 2]| {
        fs::write(directory.join("bad.toml"), edited(CASE, edit)).unwrap();
        message(&directory)
    };
    let mib = 1 << 20;
    compare([
        (
            message_of(["-4 + 10*x", &"(".repeat(mib)]),
            r#"bad.toml:9: [load] body[1] = "((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((...": column 201: found '(', expected at most 200 levels of nesting"#,
        ),
        (
            message_of(["mu = 1.0", &format!("mu = {}", "[".repeat(mib))]),
            "bad.toml:6: invalid TOML at '[': cannot recurse further; max recursion depth met",
        ),
        (
            message_of(["mu = 1.0", &format!("mu{} = 1.0", ".a".repeat(mib))]),
            "bad.toml:6: invalid TOML: recursion limit",
        ),
        (
            message_of(["mu = 1.0", &format!("mu = \"{}\"", "1".repeat(mib))]),
            r#"bad.toml:6: [material] mu = "111111111111111111111111111111111111111111111111111111111111..."; expected a number"#,
        ),
        (
            message_of(["mu = 1.0", &format!("{} = 1.0", "m".repeat(mib))]),
            "bad.toml:6: unknown key 'mmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmm...' in [material]; expected lambda, mu, young, poisson, stiffness, across, orthotropic or plane",
        ),
        (
            message_of(["mu = 1.0", &format!("mu = 1{}.0", "0".repeat(mib))]),
            "bad.toml:6: [material] mu = 100000000000000000000000000000000000000000000000000000000000...; expected a finite number",
        ),
        (
            message_of(["[[0, 1], [0.5, 0.5]]", &format!("[{}]", "0,".repeat(mib))]),
            "bad.toml:23: [output] probes[0] = 0; expected a list of two: one for x, one for y",
        ),
    ]);
}
