//! Broken case files and meshes, each with the message that a person gets. `bad_input/cases.txt` and `bad_input/meshes.txt` have
//! edits of good files, `OLD => NEW` with `\n` for the end of a line, and under each the message.

use std::fs;
use std::path::{Path, PathBuf};

use signorini::io::{Case, gmsh};
use signorini::model::Mesh;
use signorini::solve::check;

use super::common::root;

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

/// Compares the message about each edit of `good` with the one in the table.
fn compare_edits(table: &str, good: &str, message_about: impl Fn(&str) -> String) {
    let mut lines = table.lines().filter(|line| !line.is_empty() && !line.starts_with("# "));
    let mut rows = Vec::new();
    while let (Some(edit), Some(expected)) = (lines.next(), lines.next()) {
        let (old, new) = edit.split_once(" =>").unwrap();
        let [old, new] = [old, new.trim_start()].map(|text| text.replace("\\n", "\n"));
        rows.push((message_about(&edited(good, [&old, &new])), expected.trim_start()));
    }
    assert!(rows.len() >= 30);
    compare(rows);
}

/// The message about the case `text` beside the mesh file `mesh`.
fn message_of(test: &str, text: &str, mesh: &[u8]) -> String {
    let directory = directory(test);
    fs::write(directory.join("bad.toml"), text).unwrap();
    fs::write(directory.join("bad.msh"), mesh).unwrap();
    message(&directory)
}

/// The message about a case on the mesh file `bytes`, without what is always before it.
fn message_of_mesh(test: &str, bytes: &[u8]) -> String {
    let message = message_of(test, &edited(CASE, WITH_MESH), bytes);
    message.strip_prefix("bad.toml:3: [mesh] gmsh: ").unwrap_or(&message).to_owned()
}

#[test]
fn each_mistake_in_a_case_gets_its_message() {
    let table = include_str!("bad_input/cases.txt");
    compare_edits(table, CASE, |text| message_of("cases", text, b""));
}

#[test]
fn each_mistake_in_a_mesh_gets_its_message() {
    let table = include_str!("bad_input/meshes.txt");
    compare_edits(table, MESH, |text| message_of_mesh("meshes", text.as_bytes()));
}

#[test]
fn the_files_are_good_before_the_edits() {
    for case in [CASE.to_owned(), edited(CASE, WITH_MESH)] {
        assert_eq!(message_of("good", &case, MESH.as_bytes()), "nothing: the case was read");
    }
}

#[test]
fn files_that_cannot_be_read_are_named_with_the_reason() {
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
fn absurd_files_are_refused_in_a_line() {
    let message_of = |edit: [&str; 2]| message_of("absurd", &edited(CASE, edit), b"");
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

#[test]
fn seams_that_do_not_quite_match_and_what_merges_them() {
    // The upper triangle on a node of its own beside node 3.
    let torn = [
        ["1 5 1 9\n2 1 0 5\n1\n2\n3\n4\n9\n", "1 6 1 9\n2 1 0 6\n1\n2\n3\n4\n5\n9\n"],
        ["0.5 0.5 0", "1.000001 1 0\n0.5 0.5 0"],
        ["2 3 4\n", "2 5 4\n"],
        ["5 1 3 4", "5 1 5 4"],
    ]
    .into_iter()
    .fold(MESH.to_owned(), |text, edit| edited(&text, edit));
    let gmsh = edited(CASE, WITH_MESH);
    let message_with = |merge: &str| {
        let text = edited(&gmsh, ["\"bad.msh\"\n", &format!("\"bad.msh\"\n{merge}\n")]);
        message_of("seams", &text, torn.as_bytes())
    };
    let near = "bad.toml:3: [mesh] gmsh: bad.msh: vertices 3 at (1, 1) and 5 at (1.000001, 1) are 1e-6 apart with no triangle between them, beside edges of length 1: the body would be torn there; expected one vertex, or a gap of more than 0.001 times the edge (mesh.merge = 1e-6 makes them one; two bodies that touch each other are a [[pair]]) (the numbers are tags of the file)";
    let share = "expected a share of the body's size, above 0 and at most 0.01";
    compare([
        (message_with(""), near.to_owned()),
        (message_with("merge = 1e-7"), near.to_owned()),
        (message_with("merge = 1e-6"), "nothing: the case was read".to_owned()),
        (message_with("merge = 0"), format!("bad.toml:4: [mesh] merge = 0; {share}")),
        (message_with("merge = 0.1"), format!("bad.toml:4: [mesh] merge = 0.1; {share}")),
    ]);
}

#[test]
fn a_boundary_without_an_edge_in_the_mesh_is_refused() {
    let message_after = |edit| message_of_mesh("empty", edited(MESH, edit).as_bytes());
    compare([
        (
            message_after(["1 1 1 1\n1 1 2\n", "1 1 1 0\n"]),
            "bad.toml:12: [boundary.bottom]: found no edge in this mesh; expected at least one",
        ),
        (
            message_after(["1 1 \"bottom\"", "1 1 \"floor\""]),
            "bad.toml:12: [boundary.bottom]: no boundary named 'bottom'; this mesh has: floor, top",
        ),
    ]);
}

#[test]
fn binary_meshes_that_are_cut_or_damaged_are_refused() {
    const BINARY: &[u8] = include_bytes!("../meshes/square-binary.msh");
    let with = |at: usize, byte: u8| {
        let mut bytes = BINARY.to_vec();
        bytes[at] = byte;
        bytes
    };
    let noise: Vec<u8> = (0..5000_u32).map(|i| (i * i * 31 % 251) as u8).collect();
    compare([
        (
            message_of_mesh("binary", b"\x89PNG\r\n\x1a\n"),
            "bad.msh:1: this is no Gmsh mesh: expected a section $MeshFormat; gmsh -2 PART.geo makes PART.msh from a geometry",
        ),
        (
            message_of_mesh("binary", &BINARY[..20]),
            "bad.msh:3: the file ends, expected the number 1, which shows the order of the bytes: it is cut short",
        ),
        (
            message_of_mesh("binary", &BINARY[..26]),
            "bad.msh, byte 25: found '$', expected $EndMeshFormat",
        ),
        (
            message_of_mesh("binary", &BINARY[..BINARY.len() - 20]),
            "bad.msh, byte 2590: the file ends, expected the tag of a node: it is cut short",
        ),
        (
            message_of_mesh("binary", &[&BINARY[..200], &noise].concat()),
            "bad.msh, byte 5200: the file ends, expected the tag of a physical group: it is cut short",
        ),
        (
            message_of_mesh("binary", &[&BINARY[..20], &[0, 0, 0, 1]].concat()),
            "bad.msh, byte 20: found the bytes of a big-endian machine, expected little-endian numbers: export the mesh as text (Mesh.Binary = 0)",
        ),
        (
            message_of_mesh("binary", &with(25, 0)),
            "bad.msh, byte 25: found '\\0EndMeshFormat', expected $EndMeshFormat",
        ),
    ]);
}

/// Every cut of a file is an error; of some, what a person reads.
#[test]
fn text_meshes_that_are_cut() {
    for file in [MESH.as_bytes(), include_bytes!("../meshes/square-binary.msh")] {
        for length in 0..file.len() - 1 {
            let read = gmsh::from_bytes(&file[..length], Path::new("x.msh"), None, &[]);
            assert!(read.is_err(), "cut at {length}");
        }
    }
    let message_at =
        |end: &str| message_of_mesh("cut", &MESH.as_bytes()[..MESH.find(end).unwrap()]);
    compare([
        (
            message_at("$Nodes"),
            "bad.msh: there is no section $Nodes; expected MSH 4.1 or 2.2 with $Nodes and $Elements",
        ),
        (
            message_at("1 1 0\n0 1 0\n"),
            "bad.msh:27: the file ends, expected a coordinate of a node: it is cut short",
        ),
        (message_at("$EndNodes"), "bad.msh:30: the file ends, expected $EndNodes: it is cut short"),
    ]);
}

#[test]
fn lists_that_are_no_mesh_are_refused_by_number_and_boundaries_run_in_either_direction() {
    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mesh = |vertices: &[[f64; 2]], triangles: &[[usize; 3]], edge: [usize; 2]| {
        let named = [("a".to_owned(), vec![edge])];
        Mesh::new(vertices.to_vec(), triangles.to_vec(), named)
    };
    let said = |vertices: &[[f64; 2]], triangles: &[[usize; 3]], edge| {
        let mesh = mesh(vertices, triangles, edge);
        let edges = mesh.and_then(|mesh| mesh.edges_of("a").map(<[_]>::len));
        edges.map_or_else(|error| error.to_string(), |count| format!("{count} edge"))
    };
    let two = [[0, 1, 2], [0, 2, 3]];
    let twice = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-0.0, 0.0], [0.0, 1.0]];
    let across = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 3.0]];
    let hanging = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [1.0, 1.0], [2.0, 2.0]];
    compare([
        (said(&SQUARE, &two, [1, 0]), "1 edge"),
        (said(&SQUARE, &two, [0, 1]), "1 edge"),
        (
            said(&SQUARE, &two, [0, 2]),
            "boundary 'a': its edge from (0, 0) to (1, 1) lies inside the body, between two triangles; nothing can be prescribed there",
        ),
        (
            said(&SQUARE, &[[0, 1, 2], [0, 2, 7]], [0, 1]),
            "triangle 1 names vertex 7; expected one of the 4 vertices of this mesh",
        ),
        (said(&SQUARE, &[[0, 1, 2]], [0, 1]), "vertex 3 at (0, 1) belongs to no triangle"),
        (
            said(&twice, &[[0, 1, 2], [3, 2, 4]], [0, 1]),
            "vertices 0 and 3 are both at (0, 0); expected one vertex there (mesh.merge makes them one), or two bodies that are a [[pair]]",
        ),
        (
            said(&across, &[[0, 1, 2], [0, 1, 3]], [0, 1]),
            "triangles 0 and 1 overlap: both lie on the same side of the edge from vertex 0 to vertex 1",
        ),
        (
            said(&hanging, &[[0, 1, 2], [1, 4, 3], [3, 4, 2]], [0, 1]),
            "vertex 3 at (1, 1) hangs inside the edge between vertices 1 and 2 of triangle 0: neighbours must share whole edges",
        ),
        (
            Mesh::new(SQUARE.to_vec(), two.to_vec(), [])
                .unwrap()
                .edges_of("a")
                .unwrap_err()
                .to_string(),
            "no boundary named 'a'; this mesh has: none (in Gmsh a Physical Curve is one, in a case file where = \"abs(y) < 1e-9\" makes one)",
        ),
    ]);
}

#[test]
fn nodes_have_as_many_parameters_as_their_entity_has_dimensions_and_none_in_a_volume() {
    let mesh = |last: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"bottom\"\n1 2 \"top\"\n2 3 \"body\"\n$EndPhysicalNames\n\
             $ParametricNodes\n4\n1 0 0 0 0 1\n2 1 0 0 1 1 0.5\n3 1 1 0 2 1 0.1 0.2\n4 0 1 0 {last}\n$EndParametricNodes\n\
             $Elements\n4\n1 1 2 1 1 1 2\n2 1 2 2 2 3 4\n3 2 2 3 3 1 2 3\n4 2 2 3 3 1 3 4\n$EndElements\n"
        )
    };
    let about = |last: &str| message_of_mesh("parametric", mesh(last).as_bytes());
    assert_eq!(about("3 1"), "nothing: the case was read");
    for missing in ["1 1", "2 1 0.5"] {
        assert!(about(missing).contains("expected a parameter of a node"), "{missing}");
    }
}

/// Two blocks with a side that has no condition yet.
const BLOCKS: &str = r#"
mesh.gmsh = "blocks.msh"
material.lower = { young = 1, poisson = 0.3 }
material.upper = { young = 3, poisson = 0.2 }
boundary.base.displacement = [0, 0]
boundary.top.displacement = ["0", "-0.01"]
[[pair]]
boundaries = ["table", "foot"]
"#;

#[test]
fn what_has_no_value_is_named_by_its_own_key() {
    let file = root().join("tests/recorded/blocks.toml");
    let about = |settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
        let case = Case::parse(&file, BLOCKS, &settings).unwrap();
        check(&case.problem, &case.method).err().map_or(String::new(), |error| error.to_string())
    };
    assert_eq!(about(&[]), "");
    // Beside another key of the kind that has a value: the wrong one must not be called.
    for (settings, what) in [
        (&["load.body=['1/(x - x)', 1]"][..], "[load] body[0]"),
        (&["load.body=[1, '1/(x - x)']"], "[load] body[1]"),
        (&["load.upper.body=[1, '1/(x - x)']", "load.body=[1, 1]"], "[load.upper] body[1]"),
        (&["boundary.flank.traction=['1/(x - x)', 1]"], "[boundary.flank] traction[0]"),
        (&["boundary.flank.traction=[1, '1/(x - x)']"], "[boundary.flank] traction[1]"),
        (&["boundary.flank.pressure='1/(x - x)'"], "[boundary.flank] pressure"),
        (&["boundary.flank.displacement=['1/(x - x)', 1]"], "[boundary.flank] displacement[0]"),
        (
            &["boundary.flank.displacement=['free', '1/(x - x)']"],
            "[boundary.flank] displacement[1]",
        ),
        (&["boundary.flank={normal='1/(x - x)', tangential=1}"], "[boundary.flank] normal"),
        (&["boundary.flank={normal=1, tangential='1/(x - x)'}"], "[boundary.flank] tangential"),
        (&["boundary.flank.contact.gap='1/(x - x)'"], "[boundary.flank] contact.gap"),
        (
            &["boundary.flank.contact={gap=1, friction.tresca='1/(x - x)'}"],
            "[boundary.flank] contact.friction.tresca",
        ),
        (
            &["boundary.flank.contact.obstacle='wall'", "obstacle.wall.distance='1/(x - x)'"],
            "[obstacle.wall]",
        ),
        (&["pair.0.clearance='1/(x - x)'"], "the clearance between 'table' and 'foot'"),
        (
            &["pair.0.friction.tresca='1/(x - x)'"],
            "the slip bound of the pair of 'table' and 'foot'",
        ),
    ] {
        let message = about(settings);
        assert!(message.starts_with(&format!("{what} is ")), "{settings:?}: {message}");
    }
}
