//! Meshes as other people have them, written by Gmsh and meshio (`tests/meshes/variants/make.py`): what is read of each, without a
//! word or with a remark, or with which words it is refused. A mesh that is read must be the square (or two of them side by
//! side): its area, and the contact force of a block pushed onto a floor.

use std::path::{Path, PathBuf};

use approx::abs_diff_eq;
use signorini::io::{Case, FileError, gmsh};
use signorini::model::{Diagonal, Mesh, MeshError, Rectangle};
use signorini::solve::solve;

use crate::common::{constant, function};

/// How the boundaries of a mesh are named.
#[derive(Clone, Copy)]
enum Named {
    /// The case calls them `bottom` and `top`, as the mesh does.
    Names,
    /// By the numbers of their groups.
    Numbers,
    /// The mesh does not, so the case names them by their places.
    Places,
}
use Named::{Names, Numbers, Places};

const SPLIT: &str = "of the mesh are split into two triangles each, along their shorter diagonal";
const NO_ENTITIES: &str = "the mesh file has names of groups, but no $Entities";

/// The meshes that are read, with how their boundaries are named, their area, and what the remark has, if there is one.
const READ: [(&str, Named, f64, &str); 39] = [
    ("msh41", Names, 1.0, ""),
    ("msh41_binary", Names, 1.0, ""),
    ("msh22", Names, 1.0, ""),
    ("msh22_binary", Names, 1.0, ""),
    ("msh21", Names, 1.0, ""),
    ("msh2", Names, 1.0, ""),
    ("parametric_22", Names, 1.0, ""),
    ("comment_first", Names, 1.0, ""),
    ("no_entities", Places, 1.0, NO_ENTITIES),
    ("unnamed_unused", Names, 1.0, ""),
    ("numbers_only", Numbers, 1.0, ""),
    ("numbers_only_22_binary", Numbers, 1.0, ""),
    ("no_curves", Places, 1.0, ""),
    ("no_groups", Places, 1.0, ""),
    ("points", Names, 1.0, ""),
    ("curves_in_two_groups", Names, 1.0, ""),
    ("curves_in_two_groups_22", Names, 1.0, ""),
    ("surface_in_two_groups", Names, 1.0, ""),
    ("surface_in_two_groups_22", Names, 1.0, ""),
    ("curve_inside", Names, 1.0, ""),
    ("curve_outside", Names, 1.0, ""),
    ("clockwise", Names, 1.0, ""),
    ("clockwise_22", Names, 1.0, ""),
    ("one_surface_clockwise", Names, 2.0, ""),
    ("partitions", Names, 1.0, ""),
    ("partitions_binary", Names, 1.0, ""),
    ("partitions_with_ghosts", Names, 1.0, ""),
    ("partitions_22", Names, 1.0, ""),
    ("quadrangles", Names, 1.0, SPLIT),
    ("quadrangles_order_2", Names, 1.0, SPLIT),
    ("quadrangles_and_triangles", Names, 2.0, SPLIT),
    ("order_2", Names, 1.0, ""),
    ("order_3", Names, 1.0, ""),
    ("z_is_2", Names, 1.0, "the mesh lies in the plane z = 2"),
    ("meshio_names", Names, 1.0, ""),
    ("meshio_bare", Places, 1.0, ""),
    ("meshio_bare_binary", Places, 1.0, ""),
    ("meshio_clockwise", Places, 1.0, ""),
    ("meshio_of_abaqus", Places, 1.0, ""),
];

/// The meshes that are refused, with the words.
const REFUSED: [(&str, &str); 7] = [
    (
        "msh1",
        ":1: this is MSH 1; expected MSH 4.1 or 2.2: gmsh OLD.msh -save -format msh41 -o NEW.msh converts it",
    ),
    (
        "msh40",
        ":2: the version of the format is '4'; expected 4.1 or 2.2: gmsh OLD.msh -save -format msh41 -o NEW.msh converts it",
    ),
    (
        "body_3d",
        "is a 4-node tetrahedron (type 4): 3D is not solved; expected a plane mesh of triangles, gmsh -2",
    ),
    ("shell_3d", "3D is not solved; expected a mesh in a plane z = constant"),
    ("curved", "is curved: node"),
    (
        "one_partition",
        "the file has triangles of 1 of the 2 partitions of the mesh; expected all of them in one file",
    ),
    (
        "second_partition_22",
        "the file has triangles of partition 2 of the mesh, and none of partition 1",
    ),
];

fn file(name: &str) -> PathBuf {
    crate::common::root().join("tests/meshes/variants").join(format!("{name}.msh"))
}

/// A block on this mesh, pushed onto a floor.
fn case_on(mesh: &str, named: Named) -> String {
    let ([top, bottom], places) = match named {
        Names => (["top", "bottom"], ["", ""]),
        Numbers => (["3", "1"], ["", ""]),
        Places => (["top", "bottom"], ["where = \"y > 1 - 1e-9\"", "where = \"abs(y) < 1e-9\""]),
    };
    format!(
        "mesh.gmsh = \"{mesh}.msh\"\nmaterial = {{ young = 1, poisson = 0 }}\n[boundary.{top}]\n{}\ndisplacement = [0, -0.01]\n[boundary.{bottom}]\n{}\ncontact = {{}}\n",
        places[0], places[1]
    )
}

fn read(mesh: &str, text: &str) -> Case {
    Case::parse(&file(mesh), text, &[]).unwrap_or_else(|error| panic!("{mesh}: {error}"))
}

#[test]
fn meshes_of_every_variant_are_the_square_that_they_are() {
    for (name, named, area, remark) in READ {
        let case = read(name, &case_on(name, named));
        let mesh = &case.problem.mesh;
        let found: f64 =
            (0..mesh.triangles().len()).map(|t| mesh.triangle(t).double_area() / 2.0).sum();
        // Gmsh writes 16 digits of coordinates of about 1.
        assert!(abs_diff_eq!(found, area, epsilon = 1e-12), "{name}: area {found}");
        match (remark, case.remarks.as_slice()) {
            ("", []) => {}
            (remark, [found]) if !remark.is_empty() => assert!(found.contains(remark), "{found}"),
            (_, remarks) => panic!("{name}: {remarks:?}"),
        }
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        // Without lateral strain: E times 0.01 on the width. The solver's tolerance is 1e-10.
        let force = solution.quantities.contact_force;
        assert!(abs_diff_eq!(force, 0.01 * area, epsilon = 1e-9), "{name}: force {force}");
    }
}

#[test]
fn meshes_that_are_refused_say_what_they_are_and_what_helps() {
    for (name, words) in REFUSED {
        let error = gmsh::read(&file(name), None, &[]).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(words), "{name}: {error}");
    }
}

#[test]
fn every_variant_is_in_one_of_the_lists() {
    let folder = file("x");
    let mut names: Vec<String> = std::fs::read_dir(folder.parent().unwrap())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "msh"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let mut listed: Vec<&str> =
        READ.iter().map(|row| row.0).chain(REFUSED.map(|row| row.0)).collect();
    // These have tests of their own.
    listed.extend(["first_partition_22", "meshio_quadrangles"]);
    listed.sort_unstable();
    assert_eq!(names, listed);
}

#[test]
fn a_first_partition_may_be_a_part_and_is_read_with_a_remark() {
    let made = gmsh::read(&file("first_partition_22"), None, &[]).unwrap();
    assert!(made.remarks[0].starts_with("all triangles are in partition 1"), "{:?}", made.remarks);
}

#[test]
fn line_ends_of_other_systems_and_sections_of_no_use_are_passed_over() {
    let text = std::fs::read(file("msh41")).unwrap();
    let other = String::from_utf8(text.clone()).unwrap().replace('\n', "\r\n").into_bytes();
    let more = b"$Comments\n$Nodes is\n\xff not a section here\n$EndComments\n";
    let read = |bytes: &[u8]| gmsh::from_bytes(bytes, &file("msh41"), None, &[]).unwrap().mesh;
    for bytes in [other, [&text, &more[..]].concat()] {
        assert_eq!(read(&bytes).vertices(), read(&text).vertices());
    }
}

#[test]
fn rectangles_are_split_along_one_diagonal_and_the_number_is_said() {
    let made = gmsh::read(&file("meshio_quadrangles"), None, &[]).unwrap();
    assert_eq!(made.mesh.triangles().len(), 6);
    let expected = format!("3 quadrangles {SPLIT}");
    assert_eq!(made.remarks, [expected]);
}

/// The case of the table, with more text behind it.
fn error_with(mesh: &str, more: &str) -> String {
    let text = case_on(mesh, Names) + more;
    let case = Case::parse(&file(mesh), &text, &[]);
    case.err().map_or("read".to_owned(), |error| error.error.to_string())
}

#[test]
fn groups_that_overlap_are_refused_only_if_both_are_used() {
    for mesh in ["curves_in_two_groups", "curves_in_two_groups_22"] {
        assert_eq!(error_with(mesh, ""), "read", "control");
        let error = error_with(mesh, "[boundary.all]\ntraction = [0, 0]\n");
        let expected = "belongs to the boundaries 'all' and 'bottom'; expected a condition on one of them only";
        assert!(
            error.starts_with("[boundary]: the edge from (") && error.ends_with(expected),
            "{error}"
        );
    }
    for mesh in ["surface_in_two_groups", "surface_in_two_groups_22"] {
        let with = |materials: &[&str]| {
            let each = |name: &&str| format!("material.{name} = {{ young = 1, poisson = 0 }}\n");
            let materials: String = materials.iter().map(each).collect();
            let text =
                case_on(mesh, Names).replace("material = { young = 1, poisson = 0 }\n", &materials);
            Case::parse(&file(mesh), &text, &[])
                .err()
                .map_or("read".to_owned(), |e| e.error.to_string())
        };
        assert_eq!([with(&["body"]), with(&["domain"])], ["read", "read"]);
        let error = with(&["body", "domain"]);
        let expected = "[material]: found materials for the surfaces 'body' and 'domain', which share a triangle around";
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn curves_that_are_no_boundaries_are_errors_only_where_they_are_used() {
    for (mesh, curve, expected) in [
        (
            "curve_inside",
            "cut",
            "[boundary.cut]: boundary 'cut': its edge from (0.5, 0.5) to (0.5, 0.8) lies inside the body",
        ),
        (
            "curve_outside",
            "far",
            "[boundary.far]: boundary 'far': no triangle has an edge from (2, 0.5) to (2, 0.8)",
        ),
    ] {
        let error = error_with(mesh, &format!("[boundary.{curve}]\ntraction = [0, 0]\n"));
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn a_point_is_one_vertex() {
    assert_eq!(error_with("points", "[point.5]\ndisplacement = [0, \"free\"]\n").as_str(), "read");
    let error = error_with("points", "[point.p]\ndisplacement = [0, \"free\"]\n");
    assert_eq!(error, "[point.p]: 2 points have the name 'p'; expected one");
}

#[test]
fn triangles_that_run_both_ways_on_one_surface_are_refused() {
    let text = std::fs::read_to_string(file("msh22")).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let first = lines.iter().position(|line| line.contains(" 2 2 3 1 ")).unwrap();
    let mut words: Vec<&str> = lines[first].split(' ').collect();
    words.swap(5, 6);
    lines[first] = words.join(" ");
    let mixed = lines.join("\n") + "\n";
    let error = gmsh::from_bytes(mixed.as_bytes(), Path::new("x.msh"), None, &[]).map(|_| ());
    let error = error.unwrap_err().to_string();
    let expected = "list its vertices counter-clockwise (the numbers are tags of the file; others of its surface run counter-clockwise)";
    assert!(error.contains(expected), "{error}");
    assert!(gmsh::from_bytes(text.as_bytes(), Path::new("x.msh"), None, &[]).is_ok(), "control");
}

#[test]
fn boundaries_by_place_are_refused_where_they_mean_nothing() {
    let with = |place: &str| {
        let text = case_on("no_curves", Places).replace("abs(y) < 1e-9", place);
        Case::parse(&file("no_curves"), &text, &[])
            .err()
            .map_or("read".to_owned(), |e| e.error.to_string())
    };
    for (place, expected) in [
        ("abs(y) < 1e-9", "read"),
        ("-1 <= y <= 0 and x >= 0", "read"),
        (
            "y < -1",
            "[boundary.bottom] where: no edge of the boundary has both ends where this holds; the body lies in 0 <= x <= 1, 0 <= y <= 1",
        ),
        (
            "y == 0",
            "[boundary.bottom] where = \"y == 0\": column 3: found '=', expected a comparison: <, <=, > or >=, such as abs(y) < 1e-9",
        ),
    ] {
        assert_eq!(with(place), expected);
    }
    let error = with("y < 2");
    assert!(error.contains("belongs to the boundaries 'bottom' and 'top'"), "{error}");
    let error = error_with("msh41", "[boundary.left]\nwhere = \"x < 1e-9\"\n");
    assert!(
        error.starts_with("[boundary.left]: found none; expected either displacement"),
        "{error}"
    );
    let text =
        case_on("msh41", Names).replace("[boundary.top]\n", "[boundary.top]\nwhere = \"y > 0.9\"");
    let error = Case::parse(&file("msh41"), &text, &[]).err().unwrap().error.to_string();
    let expected = "[boundary.top] where: the mesh has a boundary named 'top' already; expected another name beside where";
    assert_eq!(error, expected);
}

#[test]
fn a_boundary_by_place_holds_what_the_same_boundary_holds_by_name() {
    let solved = |text: &str| {
        let case = read("msh41", text);
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        solution.displacement
    };
    let by_place = case_on("msh41", Places)
        .replace("boundary.top", "boundary.upper")
        .replace("boundary.bottom", "boundary.lower");
    assert_eq!(solved(&case_on("msh41", Names)), solved(&by_place));
}

#[test]
fn a_side_of_a_rectangle_without_cells_is_named() {
    for (nx, ny, said) in [(0, 3, "nx = 0;"), (3, 0, "ny = 0;")] {
        let rectangle = Rectangle { width: 8.0, height: 1.0, nx, ny, diagonal: Diagonal::Right };
        let error = rectangle.mesh().unwrap_err().to_string();
        assert!(error.starts_with(said), "{error}");
    }
}

#[test]
fn an_edge_that_is_listed_twice_is_one_edge_of_its_boundary() {
    let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mesh = |edges: Vec<[usize; 2]>| {
        let named = [("all round".to_owned(), edges)];
        Mesh::new(square.clone(), vec![[0, 1, 2], [0, 2, 3]], named).unwrap()
    };
    let once = vec![[0, 1], [1, 2], [2, 3]];
    let again = vec![[0, 1], [1, 2], [0, 1], [2, 3], [2, 1], [3, 2]];
    let [once, again] =
        [once, again].map(|edges| mesh(edges).edges_of("all round").unwrap().to_vec());
    assert_eq!(once.len(), 3);
    assert_eq!(once, again);
}

/// A mesh and functions of the program that calls: `[mesh]` and expressions of a case file in another way.
#[test]
fn a_case_on_a_given_mesh_and_functions_is_that_of_the_file_that_says_the_same() {
    const CASE: &str = "material = { young = 1, poisson = 0 }\n[boundary.left]\ndisplacement = [0, 0]\n\
         [boundary.bottom]\ncontact = {}\n[boundary.top]\ntraction = [X, Y]\n";
    let text = |x: &str, y: &str| CASE.replace('X', x).replace('Y', y);
    let file = Path::new("case");
    let square = Rectangle { width: 2.0, height: 1.0, nx: 3, ny: 2, diagonal: Diagonal::Right };
    let of_table = "mesh.rectangle = { width = 2, height = 1, nx = 3, ny = 2 }\n";
    let functions = [function(|[x, y]| x - 3.0 * y), constant(0.25)];
    let on_mesh = |text: &str| Case::on_mesh(file, text, square.mesh().unwrap(), &functions);
    let solved = |case: Case| {
        assert_eq!(case.problem.mesh.triangles(), square.mesh().unwrap().triangles());
        solve(&case.problem, &case.method, &case.settings).unwrap().0.displacement
    };
    let said = |case: Result<Case, _>| case.err().map(|error: FileError| error.error.to_string());

    let expected = of_table.to_owned() + &text("\"x - 3*y\"", "0.25");
    let expected = solved(Case::parse(file, &expected, &[]).unwrap());
    let given = text("\"@0\"", "\"@1\"");
    let is_expected = |case: Case| {
        let pairs = std::iter::zip(solved(case), &expected);
        // Displacements of 16, and an expression that is a polynomial is integrated by another rule than a function.
        pairs.flat_map(|(u, v)| [u[0] - v[0], u[1] - v[1]]).all(|apart| apart.abs() < 1e-11)
    };
    assert!(is_expected(on_mesh(&given).unwrap()));
    // Control: the functions exchanged.
    assert!(!is_expected(on_mesh(&text("\"@1\"", "\"@0\"")).unwrap()));

    let beside = "[mesh]: found a mesh beside the one that is given; expected one of the two";
    assert_eq!(said(on_mesh(&(of_table.to_owned() + &given))).as_deref(), Some(beside));
    let missing = said(Case::parse(file, &text("0", "0"), &[])).unwrap();
    assert!(missing.contains("[mesh]") && missing.contains("rectangle"), "{missing}");
    // A function that is not there, or none at all, is an expression, and none of these begins so.
    for wrong in ["@2", "@", "@-1", "@x"] {
        let error = said(on_mesh(&text(&format!("\"{wrong}\""), "0"))).unwrap();
        assert!(error.contains(&format!("\"{wrong}\"")), "{error}");
    }

    let pair = "[[pair]]\nboundaries = [\"bottom\", \"top\"]\nclearance = \"@1\"\n";
    let pairs = Case::pairs(file, &(text("0", "0") + pair), &functions).unwrap();
    let [pair] = &pairs[..] else { panic!("{} pairs", pairs.len()) };
    assert_eq!(pair.boundaries, ["bottom", "top"]);
    assert_eq!(pair.clearance.as_ref().map(|clearance| clearance.at([0.0; 2])), Some(0.25));
}

#[test]
fn two_vertices_at_one_place_are_refused_with_their_numbers_and_the_place() {
    let of = |apart: [f64; 2]| {
        let vertices = [[0.0, 0.0], [0.5, -2.0], [1.0, 0.0], [2.0, 0.5], apart, [2.0, 3.0]];
        let triangles = vec![[0, 1, 2], [4, 3, 5]];
        Mesh::new(vertices.to_vec(), triangles, std::iter::empty::<(String, Vec<[usize; 2]>)>())
    };
    for (place, vertices) in [([0.5, -2.0], [1, 4]), ([1.0, -0.0], [2, 4])] {
        let Err(MeshError::Duplicate { vertices: found, x, y }) = of(place) else {
            panic!("{place:?}: expected two vertices at one place")
        };
        assert_eq!((found, [x, y]), (vertices, place));
        // A zero has no sign in a message.
        assert!(y.is_sign_positive() || y == -2.0, "{y}");
    }
    // Control: beside it is another vertex.
    assert!(!matches!(of([0.5, -2.0 + 1e-12]), Err(MeshError::Duplicate { .. })));
}
