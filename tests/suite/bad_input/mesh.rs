//! Mistakes in meshes: rectangles, and files of Gmsh.

use std::fs;

use super::*;

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
fn meshes_of_gmsh() {
    compare(
        [
            // The format.
            (
                ["$MeshFormat\n4.1 0 8", "# a picture\n4.1 0 8"],
                "bad.msh:1: this is no Gmsh mesh: expected $MeshFormat on its first line; gmsh -2 PART.geo makes PART.msh from a geometry",
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
                "bad.msh: curve 1 belongs to the physical curves bottom, top; expected it in one of them only",
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
        ]
        .map(|(edit, expected)| (message_of_mesh("meshes", edited(MESH, edit).as_bytes()), expected)),
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
fn binary_meshes_that_are_cut_or_damaged() {
    const BINARY: &[u8] = include_bytes!("../../meshes/square-binary.msh");
    let message_of = |bytes: &[u8]| message_of_mesh("binary", bytes);
    let with = |at: usize, byte: u8| {
        let mut bytes = BINARY.to_vec();
        bytes[at] = byte;
        bytes
    };
    let noise: Vec<u8> = (0..5000_u32).map(|i| (i * i * 31 % 251) as u8).collect();
    compare([
        (
            message_of(b"\x89PNG\r\n\x1a\n"),
            "bad.msh:1: this is no Gmsh mesh: expected $MeshFormat on its first line; gmsh -2 PART.geo makes PART.msh from a geometry",
        ),
        (
            message_of(&[]),
            "bad.msh:1: this is no Gmsh mesh: expected $MeshFormat on its first line; gmsh -2 PART.geo makes PART.msh from a geometry",
        ),
        (
            message_of(&BINARY[..20]),
            "bad.msh:3: the file ends, expected the number 1, which shows the order of the bytes: it is cut short",
        ),
        (message_of(&BINARY[..26]), "bad.msh, byte 25: found '$', expected $EndMeshFormat"),
        (
            message_of(&BINARY[..200]),
            "bad.msh, byte 200: the file ends, expected the number of physical groups of an entity: it is cut short",
        ),
        (
            message_of(&BINARY[..BINARY.len() / 2]),
            "bad.msh, byte 1305: the file ends, expected the tag of an entity: it is cut short",
        ),
        (
            message_of(&BINARY[..BINARY.len() - 20]),
            "bad.msh, byte 2590: the file ends, expected the tag of a node: it is cut short",
        ),
        (
            message_of(&[&BINARY[..200], &noise].concat()),
            "bad.msh, byte 5200: the file ends, expected the tag of a physical group: it is cut short",
        ),
        (
            message_of(&with(25, 0)),
            "bad.msh, byte 25: found '\\0EndMeshFormat', expected $EndMeshFormat",
        ),
    ]);
}

#[test]
fn text_meshes_that_are_cut() {
    let message_at =
        |end: &str| message_of_mesh("cut", &MESH.as_bytes()[..MESH.find(end).unwrap()]);
    compare([
        (
            message_at("$Entities"),
            "bad.msh: there is no section $Entities; expected MSH 4.1 with $Entities, $Nodes and $Elements",
        ),
        (
            message_at("$Nodes"),
            "bad.msh: there is no section $Nodes; expected MSH 4.1 with $Entities, $Nodes and $Elements",
        ),
        (
            message_at("1 1 0\n0 1 0\n"),
            "bad.msh:27: the file ends, expected a coordinate of a node: it is cut short",
        ),
        (message_at("$EndNodes"), "bad.msh:30: the file ends, expected $EndNodes: it is cut short"),
        (
            message_at("$Elements"),
            "bad.msh: there is no section $Elements; expected MSH 4.1 with $Entities, $Nodes and $Elements",
        ),
        (
            message_at("3 1 1\n3 4 1"),
            "bad.msh:37: the file ends, expected the tag of an entity: it is cut short",
        ),
        (
            message_at("$EndElements"),
            "bad.msh:42: the file ends, expected $EndElements: it is cut short",
        ),
    ]);
}
