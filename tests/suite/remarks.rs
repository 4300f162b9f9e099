//! Remarks: each is given where it is true, with its place and both numbers, and not where it is not.

use signorini::contact::Pair;
use signorini::io::Case;
use signorini::kernel::{Material, Plane};
use signorini::model::{Condition, Diagonal, Mesh, Obstacle, Problem, Rectangle, Side};
use signorini::solve::{Method, Settings, SolveError, solve};

use super::common::{DEGREES, case, case_of, named_edges, root};

/// The remarks on the solution of a case.
fn of(case: &Case) -> Vec<String> {
    of_problem(&case.problem, &case.method)
}

fn of_problem(problem: &Problem, method: &Method) -> Vec<String> {
    let (solution, _) = solve(problem, method, &Settings::default()).unwrap();
    solution.remarks(problem)
}

/// There is a remark that has all these words if `given`, else none that begins with the first of them.
fn expect(given: bool, remarks: &[String], words: &[&str], what: &str) {
    let found = remarks.iter().any(|remark| {
        if given {
            words.iter().all(|word| remark.contains(word))
        } else {
            remark.contains(words[0])
        }
    });
    assert_eq!(found, given, "{what}: {words:?} in {remarks:#?}");
}

/// A roller of radius 5, pushed by 0.02 into a block with edges of 2: right is 466, the force found is 282.
const ROLLER: &str = r#"
units = { length = "mm", force = "N" }
mesh.rectangle = { width = 40, height = 20, nx = 20, ny = 10, diagonal = "crossed" }
material = { young = 70e3, poisson = 0.33 }
boundary.bottom.displacement = [0, 0]
obstacle.roller.circle = { center = [20, 24.98], radius = 5, side = "outside" }
boundary.top.contact.obstacle = "roller"
"#;

#[test]
fn contact_shorter_than_four_edges_is_remarked_with_place_lengths_and_remedy() {
    let words = [
        "contact of 'top' around (20, 20) is 0.12 long, the edges there 2",
        "--within \"force top 5 %\"",
        "is even below force / length",
    ];
    expect(true, &of(&case_of(ROLLER, &[])), &words, "roller");
    let disk = |depth: &str| {
        let setting = format!("boundary.top.displacement=[0,-{depth}]");
        of(&case("disk.toml", &[&setting]))
    };
    // 0.14, 0.7, 4.0 and 20 edges across the contact.
    for (depth, given, below) in [
        ("1e-5", true, true),
        ("1e-4", true, true),
        ("1e-3", false, false),
        ("0.015", false, false),
    ] {
        let remarks = disk(depth);
        expect(given, &remarks, &["contact of 'contact' around ("], depth);
        expect(below, &remarks, &["is even below force / length"], depth);
    }
}

#[test]
fn contact_all_along_a_boundary_is_resolved_by_few_edges() {
    // Two edges, pressed all along; and a hole that its pin presses all round.
    let block = "
        mesh.rectangle = { width = 1, height = 1, nx = 2, ny = 2 }
        material = { young = 1, poisson = 0.3 }
        boundary.top.displacement = [0, -0.001]
        boundary.bottom.contact = {}
    ";
    expect(false, &of(&case_of(block, &[])), &["contact of"], "block");
    let fit = case("pin.toml", &["obstacle.pin.circle.radius=20.05"]);
    expect(false, &of(&fit), &["contact of"], "press fit");
}

#[test]
fn a_gap_that_the_mesh_does_not_resolve_is_remarked_before_solving_and_after() {
    let punch = r#"
mesh.rectangle = { width = 40, height = 20, nx = 40, ny = 20, diagonal = "crossed" }
material = { young = 70e3, poisson = 0.33 }
boundary.bottom.displacement = [0, 0]
boundary.top.contact.gap = "-0.02 + 1 - sqrt(max(1 - max(abs(x-20)-4,0)^2, 0)) + 10*max(abs(x-20)-5,0)"
method.degree = 2
"#;
    let words = ["the gap of 'top' at (", "is -0.0445"];
    expect(true, &of(&case_of(punch, &[])), &words, "punch");
    let fine = ["mesh.rectangle.nx=80", "mesh.rectangle.ny=40"];
    expect(false, &of(&case_of(punch, &fine)), &words, "finer");
    let parabola = ["boundary.top.contact.gap=0.001*(x-20)^2-0.02"];
    expect(false, &of(&case_of(punch, &parabola)), &words, "a parabola is quadratic");
}

/// An arm that a support pushes along x below a circle of radius 0.5, 0.05 above it.
fn pushed(by: f64, obstacle: Obstacle) -> Vec<String> {
    let mesh = Rectangle { width: 26.0, height: 2.0, nx: 104, ny: 8, diagonal: Diagonal::Right };
    let problem =
        Problem::of(mesh.mesh().unwrap(), Material::young_poisson(2800.0, 0.38, Plane::Stress))
            .with("left", Condition::displacement(move |_| by, |_| 0.0))
            .with("top", Condition::obstacle("edge", obstacle));
    of_problem(&problem, &Method::default())
}

#[test]
fn motion_too_large_for_the_linearised_gap_is_remarked_with_both_distances() {
    let circle = || Obstacle::Circle { center: [13.0, 2.55], radius: 0.5, side: Side::Outside };
    let words = [
        "'top' at (",
        "its distance from 'edge' is then",
        "as the gap at the undeformed place has it",
    ];
    expect(true, &pushed(0.8, circle()), &words, "0.8");
    expect(false, &pushed(0.01, circle()), &words, "0.01");
    // The distance from a plane is linear, however far it goes.
    let plane = Obstacle::Plane { point: [0.0, 2.01], normal: [0.0, -1.0] };
    expect(false, &pushed(0.8, plane), &words, "plane");
}

/// The block of `pushed`, of whose top only an eighth to the right of its middle may touch a circle around a point below that.
fn beside_a_circle(by: f64, side: Side) -> Vec<String> {
    let mesh = Rectangle { width: 26.0, height: 2.0, nx: 104, ny: 8, diagonal: Diagonal::Right };
    let near = |[x, y]: [f64; 2]| y == 2.0 && (13.0..=13.25).contains(&x);
    let mesh = mesh.mesh().unwrap().with_boundary("near", near).unwrap();
    let (center, radius) = match side {
        Side::Inside => ([13.0, 1.0], 1.05),
        Side::Outside => ([13.0, 3.0], 0.95),
    };
    let problem = Problem::of(mesh, Material::young_poisson(2800.0, 0.38, Plane::Stress))
        .with("left", Condition::displacement(move |_| by, |_| 0.0))
        .with("near", Condition::obstacle("edge", Obstacle::Circle { center, radius, side }));
    of_problem(&problem, &Method::default())
}

#[test]
fn a_motion_into_an_obstacle_that_the_linearised_gap_does_not_see_is_remarked_without_pressure() {
    // (12.45, 2) is 0.0913 beyond the radius of 1.05 around (13, 1), and the tangent at (13.25, 2) is 0.213 away.
    let words = ["'near' at (13.25, 2) moves by 0.8", "'edge' is then -0.0913, not 0.213"];
    // To the left the linearised gap opens, and the circle is nearer than its tangent.
    expect(true, &beside_a_circle(-0.8, Side::Inside), &words, "into the circle");
    expect(false, &beside_a_circle(-0.01, Side::Inside), &words, "a little");
    // Off a circle that bends away both distances differ as much, and nothing is inside.
    expect(false, &beside_a_circle(0.8, Side::Outside), &["'near' at"], "off the circle");
}

/// The disk of the folder `cases`, its contact line cut to |x| <= `half`.
fn short_line(half: f64) -> Problem {
    let mut problem = case("disk.toml", &[]).problem;
    let mut edges = named_edges(&problem.mesh);
    let vertices = problem.mesh.vertices().to_vec();
    let inside = |edge: &[usize; 2]| edge.iter().all(|&v| vertices[v][0].abs() <= half + 1e-9);
    edges.get_mut("contact").unwrap().retain(inside);
    problem.mesh = Mesh::new(vertices.clone(), problem.mesh.triangles().to_vec(), edges).unwrap();
    problem
}

#[test]
fn a_contact_line_that_ends_before_contact_does_is_remarked_with_the_vertex_inside() {
    let words =
        ["on the boundary beside 'contact', ends 0.00", "inside 'floor'", "make 'contact' longer"];
    for (half, given) in [(0.06, true), (0.5, false), (0.15, false)] {
        let remarks = of_problem(&short_line(half), &Method::default());
        expect(given, &remarks, &words, &half.to_string());
        // The pressure is unbounded where the line ends and contact does not.
        expect(given, &remarks, &["is at the end of the contact boundary"], &half.to_string());
    }
    // The same without an obstacle: a gap goes on where the boundary goes on straight.
    let mesh = Rectangle { width: 2.0, height: 1.0, nx: 32, ny: 16, diagonal: Diagonal::Crossed };
    let mesh = mesh.mesh().unwrap();
    let part = |most: f64, beyond: f64| {
        let mut edges = named_edges(&mesh);
        let x = |v: usize| mesh.vertices()[v][0];
        edges.get_mut("bottom").unwrap().retain(|e| e.iter().all(|&v| x(v) <= most));
        let mesh = Mesh::new(mesh.vertices().to_vec(), mesh.triangles().to_vec(), edges).unwrap();
        Problem::of(mesh, Material::young_poisson(1.0, 0.3, Plane::Strain))
            .with("top", Condition::displacement(|_| 0.0, |_| -0.01))
            .with("bottom", Condition::contact(move |[x, _]| if x > 1.0 { beyond } else { 0.0 }))
    };
    let words = ["on the boundary beside 'bottom', ends 0.0"];
    let remarks = |most: f64, beyond: f64| of_problem(&part(most, beyond), &Method::default());
    expect(true, &remarks(1.0, 0.0), &words, "half the side");
    expect(false, &remarks(2.0, 0.0), &words, "the whole side");
    // What was inside before the body moved is not what the motion does.
    expect(false, &remarks(1.0, -0.02), &words, "inside before");
    expect(true, &remarks(1.0, -1e-13), &words, "inside before by rounding");
}

#[test]
fn a_support_that_holds_a_corner_inside_the_obstacle_is_refused_with_the_place() {
    let pushed = "
        mesh.rectangle = { width = 1, height = 1, nx = 32, ny = 32 }
        material = { young = 1, poisson = 0.3 }
        boundary.left.displacement = [0, -0.01]
        boundary.bottom.contact.gap = 0
    ";
    let outcome = |settings: &[&str]| {
        let case = case_of(pushed, settings);
        solve(&case.problem, &case.method, &case.settings).map(|_| ())
    };
    let words = "'left' holds (0, 0) by 0.01 inside the obstacle of 'bottom'";
    for settings in [
        &[][..],
        &["method.degree=2"],
        &["boundary.left.displacement=[0,0]", "boundary.bottom.contact.gap=-0.01"],
        &["boundary.left.displacement=[\"free\",-0.01]", "boundary.right.normal=0"],
        &["boundary.left={normal=0,tangential=0.01}"],
    ] {
        let settings: Vec<&str> = settings.to_vec();
        let case = settings.iter().any(|s| s.starts_with("boundary.left={"));
        let text = if case {
            pushed.replace("boundary.left.displacement = [0, -0.01]", "")
        } else {
            pushed.to_owned()
        };
        let case = case_of(&text, &settings);
        let error = solve(&case.problem, &case.method, &case.settings).map(|_| ()).unwrap_err();
        assert!(matches!(error, SolveError::Data(_)), "{error}");
        assert!(error.to_string().starts_with(words), "{settings:?}: {error}");
    }
    // Of several supports the one that holds the corner is named.
    let settings = ["boundary.left={normal=0}", "boundary.right.displacement=[\"free\",-0.02]"];
    let text = pushed.replace("boundary.left.displacement = [0, -0.01]", "");
    let case = case_of(&text, &settings);
    let error = solve(&case.problem, &case.method, &case.settings).map(|_| ()).unwrap_err();
    let words = "'right' holds (1, 0) by 0.02 inside the obstacle of 'bottom'";
    assert!(error.to_string().starts_with(words), "{error}");
    // It touches exactly; it is off; its component along the floor's normal is free.
    for settings in [
        &["boundary.left.displacement=[0,0]"][..],
        &["boundary.left.displacement=[0,0.01]"],
        &["boundary.bottom.contact.gap=0.01"],
        &["boundary.left.displacement=[-0.01,\"free\"]", "load.body=[0,-0.001]"],
    ] {
        assert_eq!(outcome(settings), Ok(()), "{settings:?}");
    }
}

#[test]
fn linear_triangles_that_lock_are_remarked() {
    let block = |settings: &[&str]| {
        case_of(
            "
            mesh.rectangle = { width = 1, height = 1, nx = 8, ny = 8 }
            material = { young = 1.4, poisson = 0.4995 }
            boundary.top.displacement = [0, -0.02]
            boundary.bottom.contact.gap = \"0.5*(x - 0.5)^2\"
            ",
            settings,
        )
    };
    let words = ["is nearly incompressible (Poisson's ratio 0.", "method.degree = 2"];
    for (settings, given) in [
        (&[][..], true),
        (&["material.poisson=0.48"], true),
        (&["material.poisson=0.47"], false),
        (&["method.degree=2"], false),
        (&["material.plane=stress"], false),
    ] {
        expect(given, &of(&block(settings)), &words, &format!("{settings:?}"));
    }
    // C of the same material, and one that a fibre makes stiff.
    let tensor = |c: [f64; 6], given: bool| {
        let mut case = block(&[]);
        case.problem.material = Material::tensor(c, Some([0.5, 0.5, 0.0])).into();
        expect(
            given,
            &of(&case),
            &["is nearly incompressible (as with a Poisson's ratio of"],
            "tensor",
        );
    };
    tensor([500.0, 499.0, 0.0, 500.0, 0.0, 0.5], true);
    tensor([500.0, 1.0, 0.0, 5.0, 0.0, 1.0], false);
}

/// One to three blocks, one above the other; of three the lower two are a pair.
fn blocks(count: usize) -> Problem {
    let one = Rectangle { width: 1.0, height: 1.0, nx: 4, ny: 4, diagonal: Diagonal::Right };
    let one = one.mesh().unwrap();
    let n = one.vertices().len();
    let (mut vertices, mut triangles, mut named) = (Vec::new(), Vec::new(), Vec::new());
    for (i, body) in ["low", "high", "higher"].into_iter().enumerate().take(count) {
        vertices.extend(one.vertices().iter().map(|[x, y]| [*x, y + 1.01 * i as f64]));
        triangles.extend(one.triangles().iter().map(|t| t.map(|v| v + i * n)));
        for (name, edges) in named_edges(&one) {
            let moved = edges.into_iter().map(|edge| edge.map(|v| v + i * n)).collect();
            named.push((format!("{body} {name}"), moved));
        }
    }
    let mesh = Mesh::new(vertices, triangles, named).unwrap();
    let problem = Problem::of(mesh, Material::young_poisson(1e6, 0.0, Plane::Strain));
    match count {
        1 => problem
            .with("low top", Condition::displacement(|_| 0.0, |_| -0.001))
            .with("low bottom", Condition::contact(|_| 0.0)),
        2 => problem
            .with("low bottom", Condition::clamped())
            .with("high top", Condition::displacement(|_| 0.0, |_| -0.001))
            .with("high bottom", Condition::contact(|_| 0.0)),
        _ => Problem {
            pairs: vec![Pair::new("low top", "high bottom")],
            ..problem
                .with("low bottom", Condition::clamped())
                .with("high top", Condition::displacement(|_| 0.0, |_| -0.02))
                .with("higher top", Condition::displacement(|_| 0.0, |_| -0.001))
                .with("higher bottom", Condition::contact(|_| 0.0))
        },
    }
}

#[test]
fn separate_bodies_are_remarked_and_the_one_that_carries_nothing_is_named() {
    let words = [
        "the mesh has 2 separate bodies",
        "the one with 'low bottom', 'low left', 'low right' and 'low top' carries nothing",
    ];
    expect(true, &of_problem(&blocks(2), &Method::default()), &words, "two");
    expect(false, &of_problem(&blocks(1), &Method::default()), &["separate bodies"], "one");
    let three = of_problem(&blocks(3), &Method::default());
    expect(true, &three, &words[..1], "two of three are a pair");
    expect(false, &three, &["carries nothing"], "two of three are a pair");
}

#[test]
fn a_separate_body_without_a_pair_and_a_support_is_refused_with_its_place() {
    let push = Condition::traction(|_| 0.0, |_| -1.0);
    // Also if nothing pushes: then the body may be anywhere.
    for top in [Some(push), None] {
        let mut problem = blocks(2).with("low top", Condition::contact(|_| 1.0));
        problem.conditions.retain(|name, _| name.starts_with("low"));
        problem.conditions.extend(top.map(|push| ("high top".to_owned(), push)));
        let error = solve(&problem, &Method::default(), &Settings::default()).unwrap_err();
        let text = error.to_string();
        assert!(error.is_wrong_case(), "{text}");
        for word in ["the body is not held", "of the part of the body at (0.", "expected a support"]
        {
            assert!(text.contains(word), "{word}: {text}");
        }
    }
    // Control: on the lower one it is held, and not refused.
    assert!(solve(&blocks(2), &Method::default(), &Settings::default()).is_ok());
}

#[test]
fn peaks_without_a_bound_are_remarked_where_the_angle_or_the_fibres_make_them() {
    for (name, settings, given) in [
        ("corner.toml", &[][..], true),
        ("wood.toml", &[], true),
        ("wood.toml", &["material.orthotropic.angle=0"], false),
        ("block.toml", &[], false),
        ("gap.toml", &[], false),
    ] {
        expect(
            given,
            &of(&case(name, settings)),
            &["the peak pressure of 'bottom'", "at the end of the contact boundary, (0, 0)"],
            name,
        );
    }
}

#[test]
fn the_largest_strain_has_its_place() {
    let case = case("cantilever.toml", &[]);
    let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
    // At the clamped end, below or above, where a beam bends most.
    let [x, y] = solution.largest_strain_at;
    assert!(x < 0.1 && (y - 0.5).abs() > 0.4, "{x} {y}");
    expect(
        true,
        &solution.remarks(&case.problem),
        &["the largest strain is 11.4 %, at ("],
        "cantilever",
    );
}

#[test]
fn a_body_at_rest_is_proved() {
    for degree in DEGREES {
        let degree = format!("method.degree={}", degree.number());
        let case = case("disk.toml", &["boundary.top.displacement=[0,0]", &degree]);
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        assert_eq!(solution.verdict.reason(), None);
        assert_eq!(solution.quantities.max_displacement, 0.0);
    }
}

/// The remarks on the cases that come with the program: all of them are true. That of `smooth`, whose contact reaches to x = 1/3 and
/// is found up to 1/6 on its eight cells, too.
#[test]
fn the_shipped_cases_have_no_other_remarks_than_these() {
    let known: [(&str, &[&str]); 11] = [
        ("block", &["the largest strain", "the largest displacement"]),
        ("bracket", &[]),
        ("cantilever", &["the largest strain"]),
        ("corner", &["the peak pressure", "the largest strain", "the largest displacement"]),
        ("disk", &[]),
        ("disk_force", &[]),
        ("gap", &["the largest strain"]),
        ("pin", &[]),
        ("singular", &["the largest strain", "the largest displacement"]),
        ("smooth", &["contact of 'bottom'", "the largest strain", "the largest displacement"]),
        ("wood", &["the peak pressure"]),
    ];
    let folder = root().join("cases");
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .filter_map(|entry| {
            entry.unwrap().file_name().to_str()?.strip_suffix(".toml").map(str::to_owned)
        })
        .collect();
    names.sort();
    for name in names {
        let Some((_, expected)) = known.iter().find(|(known, _)| *known == name) else { continue };
        let remarks = of(&case(&format!("{name}.toml"), &[]));
        assert_eq!(remarks.len(), expected.len(), "{name}: {remarks:#?}");
        for (remark, start) in remarks.iter().zip(*expected) {
            assert!(remark.starts_with(start), "{name}: {remark}");
        }
    }
}

/// The rings overlap by 0.03; their least radius is 29.985, and the box around the narrower one is 30 wide.
#[test]
fn bodies_of_a_pair_that_overlap_by_more_than_a_hundredth_of_their_size_are_remarked() {
    let words =
        ["the bodies of 'shaft' and 'bore' overlap by 0.6", "strains are taken to be small"];
    for (given, clearance) in [(true, "-0.6"), (false, "-0.2")] {
        let setting = format!("pair.0.clearance={clearance}");
        let case = case("press_fit.toml", &[&setting, "method.degree=1"]);
        expect(given, &of(&case), &words, clearance);
    }
}

/// A block that is pressed down widens by a third of what it is pressed by, towards a wall that stands there to rounding.
#[test]
fn a_wall_that_bears_no_more_than_rounding_is_not_touched() {
    for (nearer, touches) in [(1e-13, false), (1e-6, true)] {
        let text = format!(
            r#"
mesh.rectangle = {{ width = 1, height = 1, nx = 3, ny = 3 }}
material = {{ lambda = 1, mu = 1 }}
boundary.left.displacement = ["0", "free"]
boundary.top.displacement = ["free", "-0.1"]
boundary.bottom.contact = {{ gap = "0" }}
boundary.right.contact = {{ gap = "0.1/3 - {nearer}" }}
"#
        );
        expect(!touches, &of(&case_of(&text, &[])), &["'right' touches nothing"], &text);
    }
}
