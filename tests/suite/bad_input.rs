//! Broken case files and meshes, each with the message that a person gets. Every row is one edit of a good file: what is
//! replaced, by what, and the message. Where the message begins with a place, so does the row.

use std::fs;
use std::path::{Path, PathBuf};

use signorini::io::case::Case;

const CASE: &str = r#"title = "Block"
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
fn compare(rows: impl IntoIterator<Item = (String, String)>) {
    let mut count = 0;
    for (found, expected) in rows {
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
        (message(&directory), expected.to_owned())
    }));
}

fn compare_meshes(test: &str, rows: &[([&str; 2], &str)]) {
    let directory = directory(test);
    fs::write(directory.join("bad.toml"), edited(CASE, WITH_MESH)).unwrap();
    compare(rows.iter().map(|&(edit, expected)| {
        fs::write(directory.join("bad.msh"), edited(MESH, edit)).unwrap();
        (message(&directory), format!("bad.toml:3: [mesh] gmsh: {expected}"))
    }));
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
    compare(
        [
            (message(&directory.join("nowhere")), "bad.toml: there is no such file"),
            (message(&directory_as_case), "bad.toml: this is a directory; expected a file"),
            (write(b"title = \"\xff\""), "bad.toml: byte 10 is not UTF-8; expected a text file"),
            (
                write(b""),
                r#"bad.toml: [mesh] is missing; expected rectangle = { .. } or gmsh = ".." in it"#,
            ),
            (write(&[0; 100]), "bad.toml:1: invalid TOML: key with no value, expected `=`"),
            (
                write(edited(CASE, WITH_MESH).replace("bad.msh", "nowhere.msh").as_bytes()),
                "bad.toml:3: [mesh] gmsh: nowhere.msh: there is no such file",
            ),
            (
                write(edited(CASE, WITH_MESH).replace("bad.msh", "").as_bytes()),
                r#"bad.toml:3: [mesh] gmsh = ""; expected the name of a mesh file"#,
            ),
        ]
        .map(|(found, expected)| (found, expected.to_owned())),
    );
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
                "bad.toml:1: unknown key 'titel'; expected title, mesh, material, load, exact, boundary, obstacle, point, method, solver, output or units",
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
                "bad.toml:8: unknown key 'loads'; expected title, mesh, material, load, exact, boundary, obstacle, point, method, solver, output or units",
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
                "bad.toml:7: unknown key 'nu' in [material]; expected lambda, mu, young, poisson or plane",
            ),
            (
                ["mu = 1.0", "mu = \"1.0\""],
                r#"bad.toml:6: [material] mu = "1.0"; expected a number"#,
            ),
            (["mu = 1.0", "mu = true"], "bad.toml:6: [material] mu = true; expected a number"),
            (
                ["mu = 1.0", "mu = 1,0"],
                "bad.toml:6: invalid TOML: unexpected key or value, expected newline, `#`",
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
fn meshes_of_rectangles() {
    compare_cases(
        "rectangles",
        &[
            (
                ["[mesh]\nrectangle =", "#"],
                r#"bad.toml: [mesh] is missing; expected rectangle = { .. } or gmsh = ".." in it"#,
            ),
            (
                ["rectangle = {", "#"],
                "bad.toml:2: [mesh]: found none; expected exactly one of rectangle, trapezoid, gmsh",
            ),
            (
                ["rectangle = {", "gmsh = \"a.msh\"\nrectangle = {"],
                "bad.toml:2: [mesh]: found rectangle and gmsh; expected exactly one of rectangle, trapezoid, gmsh",
            ),
            (
                ["rectangle = {", "trapezoid = { omega = 1.5, n = 4 }\nrectangle = {"],
                "bad.toml:2: [mesh]: found rectangle and trapezoid; expected exactly one of rectangle, trapezoid, gmsh",
            ),
            ([WITH_MESH[0], "rectangle = 3"], "bad.toml:3: [mesh] rectangle = 3; expected a table"),
            ([WITH_MESH[0], "gmsh = 3"], "bad.toml:3: [mesh] gmsh = 3; expected a text in quotes"),
            (
                ["width = 1.0, ", ""],
                "bad.toml:3: [mesh] rectangle.width is missing; expected a length",
            ),
            (
                ["width = 1.0", "width = 0"],
                "bad.toml:3: [mesh] rectangle.width = 0; expected a positive number",
            ),
            (
                ["width = 1.0", "width = -1.0"],
                "bad.toml:3: [mesh] rectangle.width = -1.0; expected a positive number",
            ),
            (
                ["height = 1.0", "height = nan"],
                "bad.toml:3: [mesh] rectangle.height = nan; expected a finite number",
            ),
            (
                ["height = 1.0", "hight = 1.0"],
                "bad.toml:3: unknown key 'hight' in [mesh] rectangle; expected width, height, nx, ny or diagonal",
            ),
            (
                ["nx = 4", "nx = 0"],
                "bad.toml:3: [mesh] rectangle.nx = 0; expected a whole number from 1 to 4000000",
            ),
            (
                ["nx = 4", "nx = -4"],
                "bad.toml:3: [mesh] rectangle.nx = -4; expected a whole number from 1 to 4000000",
            ),
            (
                ["nx = 4", "nx = 4.0"],
                "bad.toml:3: [mesh] rectangle.nx = 4.0; expected a whole number from 1 to 4000000",
            ),
            (
                ["nx = 4", "nx = 99999999999999999999"],
                "bad.toml:3: [mesh] rectangle.nx = 99999999999999999999; expected a whole number from 1 to 4000000",
            ),
            (
                ["nx = 4, ny = 4", "nx = 4000, ny = 4000"],
                "bad.toml:3: [mesh] rectangle: nx = 4000 and ny = 4000 make more than 4000000 cells; expected fewer",
            ),
            (
                ["diagonal = \"right\"", "diagonal = \"up\""],
                r#"bad.toml:3: [mesh] rectangle.diagonal = "up"; expected "right", "left" or "crossed""#,
            ),
            (
                ["diagonal = \"right\"", "diagonal = 1"],
                r#"bad.toml:3: [mesh] rectangle.diagonal = 1; expected "right", "left" or "crossed""#,
            ),
        ],
    );
}

#[test]
fn materials() {
    compare_cases(
        "materials",
        &[
            (
                ["[material]\nlambda = 1.0\nmu = 1.0\nplane = \"strain\"\n", ""],
                "bad.toml: [material] is missing; expected lambda and mu, or young and poisson in it",
            ),
            (
                ["lambda = 1.0\n", ""],
                "bad.toml:4: [material]: found mu; expected lambda and mu, or young and poisson",
            ),
            (
                ["lambda = 1.0\nmu = 1.0\n", ""],
                "bad.toml:4: [material]: found none; expected lambda and mu, or young and poisson",
            ),
            (
                ["lambda = 1.0", "young = 2.5"],
                "bad.toml:4: [material]: found mu and young; expected lambda and mu, or young and poisson",
            ),
            (
                ["lambda = 1.0", "lambda = 1.0\nyoung = 2.5"],
                "bad.toml:4: [material]: found lambda, mu and young; expected lambda and mu, or young and poisson",
            ),
            (
                ["mu = 1.0", "mu = -1.0"],
                "bad.toml:6: [material] mu = -1.0; expected a positive number",
            ),
            (["mu = 1.0", "mu = 0"], "bad.toml:6: [material] mu = 0; expected a positive number"),
            (
                ["lambda = 1.0", "lambda = -1"],
                "bad.toml:5: [material] lambda = -1; expected a number above -0.6666666666666666, for 3 lambda + 2 mu > 0",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 0\npoisson = 0.3"],
                "bad.toml:5: [material] young = 0; expected a positive number",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 1.0\npoisson = 0.5"],
                "bad.toml:6: [material] poisson = 0.5; expected a number above -1 and below 0.5",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 1.0\npoisson = -1"],
                "bad.toml:6: [material] poisson = -1; expected a number above -1 and below 0.5",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 1e308\npoisson = 0.4999999"],
                "bad.toml:4: [material]: found moduli with lambda + 2 mu = inf in the plane; expected a positive finite sum",
            ),
            (
                ["plane = \"strain\"", "plane = \"stain\""],
                r#"bad.toml:7: [material] plane = "stain"; expected "strain" or "stress""#,
            ),
        ],
    );
}

#[test]
fn loads_and_expressions() {
    compare_cases(
        "loads",
        &[
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\"]"],
                "bad.toml:9: [load] body = a list of 1; expected a list of two: one for x, one for y",
            ),
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\", \"0\", \"0\"]"],
                "bad.toml:9: [load] body = a list of 3; expected a list of two: one for x, one for y",
            ),
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = \"0\""],
                r#"bad.toml:9: [load] body = "0"; expected a list of two: one for x, one for y"#,
            ),
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = [true, -4]"],
                r#"bad.toml:9: [load] body[0] = true; expected a number, or an expression in quotes, such as "2*x""#,
            ),
            (
                ["body =", "bodyforce ="],
                "bad.toml:9: unknown key 'bodyforce' in [load]; expected body",
            ),
            (
                ["-4 + 10*x", "-4 + 10*z"],
                r#"bad.toml:9: [load] body[1] = "-4 + 10*z": column 9: found 'z', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", "4 +"],
                r#"bad.toml:9: [load] body[1] = "4 +": column 4: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", "2x"],
                r#"bad.toml:9: [load] body[1] = "2x": column 2: found 'x', expected an operator (+ - * / ^) or the end"#,
            ),
            (
                ["-4 + 10*x", "tan(x)"],
                r#"bad.toml:9: [load] body[1] = "tan(x)": column 1: found 'tan', expected one of the functions sqrt, sin, cos, exp, abs, min, max"#,
            ),
            (
                ["-4 + 10*x", "10*nan"],
                r#"bad.toml:9: [load] body[1] = "10*nan": column 4: found 'nan', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", "1/0"],
                r#"bad.toml:9: [load] body[1] = "1/0", which is inf; expected a finite value"#,
            ),
            (
                ["-4 + 10*x", "sqrt(-1)"],
                r#"bad.toml:9: [load] body[1] = "sqrt(-1)", which is NaN; expected a finite value"#,
            ),
            (
                ["-4 + 10*x", "free"],
                r#"bad.toml:9: [load] body[1] = "free": column 1: found 'free', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", ""],
                r#"bad.toml:9: [load] body[1] = "": column 1: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
        ],
    );
}

#[test]
fn boundaries() {
    compare_cases(
        "boundaries",
        &[
            (
                ["[boundary.bottom]\ncontact = { gap = \"0\" }\n", ""],
                r#"bad.toml:10: [boundary]: found no contact; expected one boundary with contact, such as [boundary.bottom] contact = { gap = "0" }"#,
            ),
            (
                [
                    "[boundary.top]\ndisplacement = [\"0\", \"free\"]\n[boundary.bottom]\ncontact = { gap = \"0\" }\n",
                    "",
                ],
                r#"bad.toml: [boundary] is missing; expected one boundary with contact, such as [boundary.bottom] contact = { gap = "0" }"#,
            ),
            (
                ["[boundary.bottom]", "[boundary.botom]"],
                "bad.toml:12: [boundary.botom]: no boundary named 'botom'; this mesh has: bottom, left, right, top",
            ),
            (
                ["[boundary.bottom]", "[boundary.\"the floor\"]"],
                r#"bad.toml:12: [boundary."the floor"]: no boundary named 'the floor'; this mesh has: bottom, left, right, top"#,
            ),
            (
                ["[boundary.bottom]", "[boundary.top]"],
                "bad.toml:12: invalid TOML at 'top': duplicate key",
            ),
            (
                ["[boundary.top]\n", "[boundary.top]\ntraction = [\"1\", \"0\"]\n"],
                "bad.toml:11: [boundary.top] traction[0] = \"1\"; expected 0: the displacement is given in this component, so its traction is the reaction ([boundary.top])",
            ),
            (
                ["[boundary.top]\n", "[boundary.top]\ncontact = {}\n"],
                "bad.toml:10: [boundary.top]: found displacement and contact; expected either displacement, traction, pressure, normal, tangential or contact",
            ),
            (
                ["displacement = [\"0\", \"free\"]\n", ""],
                "bad.toml:10: [boundary.top]: found none; expected either displacement, traction, pressure, normal, tangential or contact",
            ),
            (
                ["displacement =", "displacment ="],
                "bad.toml:11: unknown key 'displacment' in [boundary.top]; expected displacement, traction, pressure, normal, tangential or contact",
            ),
            (
                ["displacement = [\"0\", \"free\"]", "displacement = [\"0\", \"fixed\"]"],
                r#"bad.toml:11: [boundary.top] displacement[1] = "fixed": column 1: found 'fixed', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["displacement = [\"0\", \"free\"]", "displacement = [\"0\", \"x*\"]"],
                r#"bad.toml:11: [boundary.top] displacement[1] = "x*": column 3: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["displacement = [\"0\", \"free\"]", "displacement = \"0\""],
                r#"bad.toml:11: [boundary.top] displacement = "0"; expected a list of two: one for x, one for y"#,
            ),
            (
                ["displacement = [\"0\", \"free\"]", "traction = [\"0\", \"free\"]"],
                r#"bad.toml:11: [boundary.top] traction[1] = "free": column 1: found 'free', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = true"],
                r#"bad.toml:13: [boundary.bottom] contact = true; expected a table, such as { gap = "0" } or { obstacle = "floor" }"#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = { gap = false }"],
                r#"bad.toml:13: [boundary.bottom] contact.gap = false; expected a number, or an expression in quotes, such as "2*x""#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = { gap = \"x^\" }"],
                r#"bad.toml:13: [boundary.bottom] contact.gap = "x^": column 3: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = { friction = 0.3 }"],
                "bad.toml:13: unknown key 'friction' in [boundary.bottom] contact; expected gap or obstacle",
            ),
            (
                ["[boundary.bottom]\ncontact", "[boundary]\nbottom"],
                "bad.toml:13: unknown key 'gap' in [boundary.bottom]; expected displacement, traction, pressure, normal, tangential or contact",
            ),
        ],
    );
}

#[test]
fn methods_solvers_and_outputs() {
    compare_cases(
        "methods",
        &[
            (["degree = 1", "degree = 3"], "bad.toml:15: [method] degree = 3; expected 1 or 2"),
            (["degree = 1", "degree = 1.0"], "bad.toml:15: [method] degree = 1.0; expected 1 or 2"),
            (
                ["degree = 1", "degree = 1\ntheta = 1"],
                "bad.toml:16: unknown key 'theta' in [method]; expected degree, gamma0, kappa, contact_quadrature or allow_noncoercive",
            ),
            (
                ["gamma0 = 0.1", "gamma0 = 0"],
                r#"bad.toml:16: [method] gamma0 = 0; expected a positive number or "auto""#,
            ),
            (
                ["gamma0 = 0.1", "gamma0 = -0.1"],
                r#"bad.toml:16: [method] gamma0 = -0.1; expected a positive number or "auto""#,
            ),
            (
                ["gamma0 = 0.1", "gamma0 = inf"],
                "bad.toml:16: [method] gamma0 = inf; expected a finite number",
            ),
            (
                ["gamma0 = 0.1", "gamma0 = \"automatic\""],
                r#"bad.toml:16: [method] gamma0 = "automatic"; expected a positive number or "auto""#,
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = \"gauss\""],
                r#"bad.toml:17: [method] contact_quadrature = "gauss"; expected "exact" or { gauss = points per edge }"#,
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = 4"],
                r#"bad.toml:17: [method] contact_quadrature = 4; expected "exact" or { gauss = points per edge }"#,
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = { gauss = 0 }"],
                "bad.toml:17: [method] contact_quadrature.gauss = 0; expected a whole number from 1 to 64",
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = { gauss = 65 }"],
                "bad.toml:17: [method] contact_quadrature.gauss = 65; expected a whole number from 1 to 64",
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = { points = 4 }"],
                "bad.toml:17: unknown key 'points' in [method] contact_quadrature; expected gauss",
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = {}"],
                "bad.toml:17: [method] contact_quadrature.gauss is missing; expected a number of points per edge",
            ),
            (
                ["tolerance = 1e-10", "tolerance = 0"],
                "bad.toml:20: [solver] tolerance = 0; expected a number above 0 and below 1",
            ),
            (
                ["tolerance = 1e-10", "tolerance = 1"],
                "bad.toml:20: [solver] tolerance = 1; expected a number above 0 and below 1",
            ),
            (
                ["tolerance = 1e-10", "tolerance = nan"],
                "bad.toml:20: [solver] tolerance = nan; expected a finite number",
            ),
            (
                ["max_iterations = 50", "max_iterations = 0"],
                "bad.toml:21: [solver] max_iterations = 0; expected a whole number from 1 to 1000000",
            ),
            (
                ["[0, 1], [0.5, 0.5]", "[0, 1, 0]"],
                "bad.toml:23: [output] probes[0] = a list of 3; expected a list of two: one for x, one for y",
            ),
            (
                ["[0, 1], [0.5, 0.5]", "[0, 1], [0.5, nan]"],
                "bad.toml:23: [output] probes[1][1] = nan; expected a finite number",
            ),
            (
                ["[[0, 1], [0.5, 0.5]]", "[0, 1]"],
                "bad.toml:23: [output] probes[0] = 0; expected a list of two: one for x, one for y",
            ),
            (
                ["[[0, 1], [0.5, 0.5]]", "\"all\""],
                r#"bad.toml:23: [output] probes = "all"; expected a list"#,
            ),
        ],
    );
}

#[test]
fn meshes_of_gmsh() {
    compare_meshes(
        "meshes",
        &[
            // The format.
            (
                ["$MeshFormat\n4.1 0 8", "# a picture\n4.1 0 8"],
                "bad.msh:1: this is no Gmsh mesh: expected $MeshFormat on its first line",
            ),
            (
                ["4.1 0 8", "2.1 0 8"],
                "bad.msh:2: the version of the format is '2.1'; expected '4.1' or '2.2': export the mesh with gmsh -format msh41",
            ),
            (
                ["4.1 0 8", "4.1 2 8"],
                "bad.msh:2: found 2, expected 0 for a text file or 1 for a binary file",
            ),
            (["4.1 0 8", "4.1 0 4"], "bad.msh:2: found 4, expected 8, the size of a number"),
            // Names and groups.
            (
                ["1 1 \"bottom\"", "1 1 bottom"],
                "bad.msh:6: found 'bottom', expected the name of a physical group in quotes",
            ),
            (
                ["1 1 \"bottom\"\n", ""],
                "bad.msh:8: found '$EndPhysicalNames', expected a dimension from 0 to 3",
            ),
            (
                ["3\n1 1 \"bottom\"\n", "2\n"],
                r#"bad.msh: physical curve 1 has no name; expected one, as in Physical Curve("floor", 1) = {1};"#,
            ),
            (
                ["1 0 0 0 1 0 0 1 1 0", "1 0 0 0 1 0 0 2 1 2 0"],
                "bad.msh: curve 1 belongs to the physical curves 'bottom' and 'top'; expected it in one of them only",
            ),
            (
                ["1 0 0 0 1 0 0 1 1 0", "1 0 0 0 1 0 0 1 7 0"],
                r#"bad.msh: physical curve 7 has no name; expected one, as in Physical Curve("floor", 7) = {1};"#,
            ),
            (
                ["0 3 1 0\n1 0 0 0 1 0 0 1 1 0\n", "0 2 1 0\n"],
                "bad.msh: element 1 lies on curve 1, which is not in $Entities",
            ),
            // Nodes.
            (
                ["1 0 0\n", "1 zero 0\n"],
                "bad.msh:26: found 'zero', expected a coordinate of a node",
            ),
            (
                ["1 0 0\n", "1 0\n"],
                "bad.msh:27: node 2 has z = 1; expected a mesh in the plane z = 0",
            ),
            (
                ["1 0 0\n", "1 nan 0\n"],
                "bad.msh: vertex 2 is at (1, NaN); expected finite coordinates (the numbers are tags of the file)",
            ),
            (
                ["1 0 0\n", "1 0 0.25\n"],
                "bad.msh:26: node 2 has z = 0.25; expected a mesh in the plane z = 0",
            ),
            (
                ["1 0 0\n", "0 0 0\n"],
                "bad.msh: vertices 1 and 2 are both at (0, 0); expected one vertex there (the numbers are tags of the file)",
            ),
            (
                ["1 0 0\n", "2 2 0\n"],
                "bad.msh: triangle 4 (vertices 1, 2, 3) is flat: its area 0 is nothing beside its diameter 2.8284271247461903 (the numbers are tags of the file)",
            ),
            (
                ["3\n4\n9\n", "3\n3\n9\n"],
                "bad.msh: there is a second node 3; expected a tag of its own for each node",
            ),
            (["2 1 0 5", "7 1 0 5"], "bad.msh:19: found 7, expected a dimension from 0 to 3"),
            // Elements.
            (
                ["4 1 2 3\n", "4 1 3 2\n"],
                "bad.msh: triangle 4 (vertices 1, 3, 2) has area -0.5: list its vertices counter-clockwise (the numbers are tags of the file; in Gmsh, turn the curve loop of the surface round)",
            ),
            (["4 1 2 3\n", "4 1 2 8\n"], "bad.msh: element 4 names node 8, which is not in $Nodes"),
            (["4 1 2 3\n", "4 1 2 -3\n"], "bad.msh:40: found '-3', expected the tag of a node"),
            (
                ["4 1 2 3\n", "4 1 2\n"],
                "bad.msh:42: found '$EndElements', expected the tag of a node",
            ),
            (
                ["1 1 2\n1 2 1 1", "1 1 9\n1 2 1 1"],
                "bad.msh: boundary 'bottom': no triangle has an edge between vertices 1 and 9 (the numbers are tags of the file)",
            ),
            (
                ["1 2 1 1\n2 3 4\n", "1 2 1 1\n2 2 1\n"],
                "bad.msh: the edge between vertices 2 and 1 belongs to boundary 'bottom' and again to boundary 'top'; expected one name for it (the numbers are tags of the file)",
            ),
            (
                ["1 1 1 1\n1 1 2", "1 1 26 1\n1 1 2"],
                "bad.msh:34: element 1 is a 4-node line (type 26); expected 2-node lines and 3-node triangles: export with element order 1",
            ),
            (
                ["2 1 2 2\n", "2 1 21 2\n"],
                "bad.msh:40: element 4 is a 10-node triangle (type 21); expected 2-node lines and 3-node triangles: export with element order 1",
            ),
            (
                ["2 1 2 2\n", "2 1 3 2\n"],
                "bad.msh:40: element 4 is a 4-node quadrangle (type 3); expected 3-node triangles: do not recombine the mesh",
            ),
            (
                ["2 1 2 2\n", "2 1 99 2\n"],
                "bad.msh:40: element 4 is a kind of element that has no use here (type 99); expected 2-node lines and 3-node triangles",
            ),
            (
                ["2 1 2 2\n4 1 2 3\n5 1 3 4\n", "2 1 2 0\n"],
                "bad.msh: the mesh has no triangle; expected at least one (mesh with gmsh -2, and where curves have a physical group, give the surface one too)",
            ),
            (
                ["2 1 2 2\n4 1 2 3\n", "2 1 2 99999999999999999999\n4 1 2 3\n"],
                "bad.msh:39: found '99999999999999999999', expected a number of elements",
            ),
            (
                ["2 1 2 2\n4 1 2 3\n", "2 1 2 9999999999999999999\n4 1 2 3\n"],
                "bad.msh:42: found '$EndElements', expected the tag of an element",
            ),
            // Sections.
            (["$EndNodes\n", ""], "bad.msh:30: found '$Elements', expected $EndNodes"),
            (
                ["$EndNodes\n", "$EndNodes\n$Comments\nwithout end\n"],
                "bad.msh:45: the file ends, expected $EndComments: it is cut short",
            ),
            (
                ["$EndElements\n", "$EndElements\n$Elements\n0 0 0 0\n$EndElements\n"],
                "bad.msh:43: there is a second section $Elements; expected one",
            ),
            (
                ["$EndElements\n", "$EndElements\nand more\n"],
                "bad.msh:43: found 'and more', expected a section such as $Nodes",
            ),
        ],
    );
}

#[test]
fn seams_that_do_not_quite_match_and_what_merges_them() {
    let directory = directory("seams");
    // The upper triangle on a node of its own beside node 3.
    let torn = [
        ["1 5 1 9\n2 1 0 5\n1\n2\n3\n4\n9\n", "1 6 1 9\n2 1 0 6\n1\n2\n3\n4\n5\n9\n"],
        ["0.5 0.5 0", "1.000001 1 0\n0.5 0.5 0"],
        ["2 3 4\n", "2 5 4\n"],
        ["5 1 3 4", "5 1 5 4"],
    ]
    .into_iter()
    .fold(MESH.to_owned(), |text, edit| edited(&text, edit));
    fs::write(directory.join("bad.msh"), torn).unwrap();
    let gmsh = edited(CASE, WITH_MESH);
    let message_with = |merge: &str| {
        let text = gmsh.replacen("\"bad.msh\"\n", &format!("\"bad.msh\"\n{merge}\n"), 1);
        fs::write(directory.join("bad.toml"), text).unwrap();
        message(&directory)
    };
    let near = "bad.toml:3: [mesh] gmsh: bad.msh: vertices 3 at (1, 1) and 5 at (1.000001, 1) are 1e-6 apart with no triangle between them, beside edges of length 1: the body would be torn there; expected one vertex, or a gap of more than 0.001 times the edge (mesh.merge = 1e-6 makes them one) (the numbers are tags of the file)";
    let share = "expected a share of the body's size, above 0 and at most 0.01";
    compare([
        (message_with(""), near.to_owned()),
        (message_with("merge = 1e-7"), near.to_owned()),
        (message_with("merge = 1e-6"), "nothing: the case was read".to_owned()),
        (message_with("merge = 0"), format!("bad.toml:4: [mesh] merge = 0; {share}")),
        (message_with("merge = 0.1"), format!("bad.toml:4: [mesh] merge = 0.1; {share}")),
    ]);
    compare_cases(
        "merge",
        &[(
            ["[material]", "merge = 1e-6\n[material]"],
            "bad.toml:2: [mesh]: found rectangle and merge; expected merge beside gmsh only",
        )],
    );
}

#[test]
fn boundaries_of_gmsh_meshes() {
    let directory = directory("empty");
    fs::write(directory.join("bad.toml"), edited(CASE, WITH_MESH)).unwrap();
    let message_after = |edit| {
        fs::write(directory.join("bad.msh"), edited(MESH, edit)).unwrap();
        message(&directory)
    };
    compare(
        [
            (message_after(["1 1 1 1\n1 1 2\n", "1 1 1 0\n"]), "bad.toml:12: [boundary.bottom]: found no edge in this mesh; expected at least one"),
            (message_after(["1 1 \"bottom\"", "1 1 \"floor\""]), "bad.toml:12: [boundary.bottom]: no boundary named 'bottom'; this mesh has: floor, top"),
        ]
        .map(|(found, expected)| (found, expected.to_owned())),
    );
}

#[test]
fn binary_meshes_that_are_cut_or_damaged() {
    const BINARY: &[u8] = include_bytes!("../meshes/square-binary.msh");
    let directory = directory("binary");
    fs::write(directory.join("bad.toml"), edited(CASE, WITH_MESH)).unwrap();
    let message_of = |bytes: &[u8]| {
        fs::write(directory.join("bad.msh"), bytes).unwrap();
        message(&directory)
    };
    let with = |at: usize, byte: u8| {
        let mut bytes = BINARY.to_vec();
        bytes[at] = byte;
        bytes
    };
    let noise: Vec<u8> = (0..5000_u32).map(|i| (i * i * 31 % 251) as u8).collect();
    compare(
        [
            (message_of(b"\x89PNG\r\n\x1a\n"), "bad.toml:3: [mesh] gmsh: bad.msh:1: this is no Gmsh mesh: expected $MeshFormat on its first line"),
            (message_of(&[]), "bad.toml:3: [mesh] gmsh: bad.msh:1: this is no Gmsh mesh: expected $MeshFormat on its first line"),
            (message_of(&BINARY[..20]), "bad.toml:3: [mesh] gmsh: bad.msh:3: the file ends, expected the number 1, which shows the order of the bytes: it is cut short"),
            (message_of(&BINARY[..26]), "bad.toml:3: [mesh] gmsh: bad.msh, byte 25: found '$', expected $EndMeshFormat"),
            (message_of(&BINARY[..200]), "bad.toml:3: [mesh] gmsh: bad.msh, byte 200: the file ends, expected the number of physical groups of an entity: it is cut short"),
            (message_of(&BINARY[..BINARY.len() / 2]), "bad.toml:3: [mesh] gmsh: bad.msh, byte 1305: the file ends, expected the tag of an entity: it is cut short"),
            (message_of(&BINARY[..BINARY.len() - 20]), "bad.toml:3: [mesh] gmsh: bad.msh, byte 2590: the file ends, expected the tag of a node: it is cut short"),
            (message_of(&[&BINARY[..200], &noise].concat()), "bad.toml:3: [mesh] gmsh: bad.msh, byte 5200: the file ends, expected the tag of a physical group: it is cut short"),
            (message_of(&with(25, 0)), "bad.toml:3: [mesh] gmsh: bad.msh, byte 25: found '\\0EndMeshFormat', expected $EndMeshFormat"),
        ]
        .map(|(found, expected)| (found, expected.to_owned())),
    );
}

#[test]
fn text_meshes_that_are_cut() {
    let directory = directory("cut");
    fs::write(directory.join("bad.toml"), edited(CASE, WITH_MESH)).unwrap();
    let message_at = |end: &str| {
        let length = MESH.find(end).unwrap();
        fs::write(directory.join("bad.msh"), &MESH[..length]).unwrap();
        message(&directory)
    };
    compare(
        [
            (message_at("$Entities"), "bad.toml:3: [mesh] gmsh: bad.msh: there is no section $Entities; expected MSH 4.1 with $Entities, $Nodes and $Elements"),
            (message_at("$Nodes"), "bad.toml:3: [mesh] gmsh: bad.msh: there is no section $Nodes; expected MSH 4.1 with $Entities, $Nodes and $Elements"),
            (message_at("1 1 0\n0 1 0\n"), "bad.toml:3: [mesh] gmsh: bad.msh:27: the file ends, expected a coordinate of a node: it is cut short"),
            (message_at("$EndNodes"), "bad.toml:3: [mesh] gmsh: bad.msh:30: the file ends, expected $EndNodes: it is cut short"),
            (message_at("$Elements"), "bad.toml:3: [mesh] gmsh: bad.msh: there is no section $Elements; expected MSH 4.1 with $Entities, $Nodes and $Elements"),
            (message_at("3 1 1\n3 4 1"), "bad.toml:3: [mesh] gmsh: bad.msh:37: the file ends, expected the tag of an entity: it is cut short"),
            (message_at("$EndElements"), "bad.toml:3: [mesh] gmsh: bad.msh:42: the file ends, expected $EndElements: it is cut short"),
        ]
        .map(|(found, expected)| (found, expected.to_owned())),
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
    compare(
        [
            (message_of(["-4 + 10*x", &"(".repeat(mib)]), r#"bad.toml:9: [load] body[1] = "((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((...": column 201: found '(', expected at most 200 levels of nesting"#),
            (message_of(["mu = 1.0", &format!("mu = {}", "[".repeat(mib))]), "bad.toml:6: invalid TOML at '[': cannot recurse further; max recursion depth met"),
            (message_of(["mu = 1.0", &format!("mu{} = 1.0", ".a".repeat(mib))]), "bad.toml:6: invalid TOML: recursion limit"),
            (message_of(["mu = 1.0", &format!("mu = \"{}\"", "1".repeat(mib))]), r#"bad.toml:6: [material] mu = "111111111111111111111111111111111111111111111111111111111111..."; expected a number"#),
            (message_of(["mu = 1.0", &format!("{} = 1.0", "m".repeat(mib))]), "bad.toml:6: unknown key 'mmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmm...' in [material]; expected lambda, mu, young, poisson or plane"),
            (message_of(["mu = 1.0", &format!("mu = 1{}.0", "0".repeat(mib))]), "bad.toml:6: [material] mu = 100000000000000000000000000000000000000000000000000000000000...; expected a finite number"),
            (message_of(["[[0, 1], [0.5, 0.5]]", &format!("[{}]", "0,".repeat(mib))]), "bad.toml:23: [output] probes[0] = 0; expected a list of two: one for x, one for y"),
        ]
        .map(|(found, expected)| (found, expected.to_owned())),
    );
}
