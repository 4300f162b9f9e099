//! Bodies that no support holds, or not enough of them: contact does, because the loads press. The answers are known from
//! equilibrium, and from the same bodies on supports that happen to carry nothing.

use approx::{abs_diff_eq, assert_abs_diff_eq};
use signorini::contact::{Discretization, EdgeRule, Friction, contact_line};
use signorini::kernel::{Material, Plane};
use signorini::linear::system::System;
use signorini::model::Degree;
use signorini::model::{
    Condition, DataError, Diagonal, Mesh, Obstacle, PointSupport, Problem, Rectangle, Side, Space,
};
use signorini::results::{RouteName, Solution};
use signorini::solve::accuracy::Outcome;
use signorini::solve::{
    Course, Method, Settings, SolveError, Times, discretize, route, solve, solve_along,
};

use crate::common::*;

/// What a load of 0.1 may be off in the sum of contact forces: the last step of Newton's method leaves rounding errors only,
/// times the condition of these small systems.
const SOLVED: f64 = 1e-12;

fn block_under(mesh: Mesh, [fx, fy]: [f64; 2], parts: Vec<(&'static str, Condition)>) -> Problem {
    let conditions = parts.into_iter().map(|(name, c)| (name.to_owned(), c)).collect();
    let material = Material::young_poisson(1.0, 0.3, Plane::Strain);
    Problem::new(mesh, material, [constant(fx), constant(fy)], conditions)
}

fn solved(problem: &Problem, degree: Degree) -> Solution {
    let (s, _) = solve(problem, &method(degree, EXACT), &Settings::default()).unwrap();
    // A small body has contact all around it.
    assert_eq!(s.method.route == RouteName::Condensed, s.newton.factorizations == 1);
    assert!(s.newton.residual <= 1e-10 && s.method.forward_error <= 1e-10);
    assert!(s.newton.iterations() <= 25);
    s
}

/// A body that contact alone holds, by a route.
fn by(name: RouteName, system: &System) -> Outcome {
    route::by(name, system, &Settings::default(), &mut Times::default()).unwrap()
}

#[test]
fn a_body_that_contact_holds_is_factored_once_and_both_routes_find_the_same() {
    // Far from the walls before the loads press, without friction and with it, and squeezed.
    let far = Condition::contact(|_| 0.3);
    let floor = Condition::contact(|[x, _]| 0.01 * (x - 0.6) * (x - 0.6));
    let flat = || ("bottom", Condition::contact(|_| 0.0));
    let body = |force, parts| block_under(skewed_square(6, Diagonal::Crossed), force, parts);
    let rough = Friction::tresca(|_| 0.05);
    let problems = [
        body([-0.02, -0.1], vec![("bottom", floor), ("left", far)]),
        body([0.01, -0.1], vec![flat()]).with_friction("bottom", rough),
        body([0.0; 2], vec![flat(), ("top", Condition::contact(|_| -0.01))]),
    ];
    for problem in problems {
        for degree in DEGREES {
            let d = discretize(&problem, &method(degree, EXACT)).unwrap();
            let system = System::new(&d).unwrap();
            let [one, each] = [RouteName::Condensed, RouteName::Assembled].map(|r| by(r, &system));
            assert_eq!(one.factorizations, 1);
            assert!(each.factorizations > 1, "the control");
            let [few, many] = [&one, &each].map(|outcome| outcome.residuals.len());
            assert!(few <= many + 2, "{few} steps condensed, {many} assembled");
            let size = each.u.as_flattened().iter().fold(0.0, |m: f64, u| m.max(u.abs()));
            for (a, b) in one.u.as_flattened().iter().zip(each.u.as_flattened()) {
                // Both are proved to 1e-9 or better, and this near as measured.
                assert_abs_diff_eq!(a, b, epsilon = 1e-11 * size);
            }
            assert!(one.radius() <= 2.0 * each.radius().max(1e-13), "the same is proved");
        }
    }
}

#[test]
fn a_block_on_a_floor_carries_its_weight_and_stays_where_it_is() {
    for degree in DEGREES {
        let mesh = skewed_square(6, signorini::model::Diagonal::Crossed);
        let s = solved(
            &block_under(mesh, [0.0, -0.1], vec![("bottom", Condition::contact(|_| 0.0))]),
            degree,
        );
        assert_abs_diff_eq!(s.quantities.contact_force, 0.1, epsilon = SOLVED);
        assert_eq!(s.method.slides, 1, "it may slide along the floor");
        let mean: f64 = s.displacement.iter().map(|u| u[0]).sum();
        // The one of least norm of all solutions: a sum of some hundred displacements.
        assert_abs_diff_eq!(mean, 0.0, epsilon = 100.0 * SOLVED);
    }
}

#[test]
fn a_block_in_a_corner_leans_on_floor_and_wall() {
    for degree in DEGREES {
        let parts =
            vec![("bottom", Condition::contact(|_| 0.0)), ("left", Condition::contact(|_| 0.001))];
        let s = solved(&block_under(unit_square(8).mesh().unwrap(), [-0.02, -0.1], parts), degree);
        let resultant = s.quantities.contact_resultant;
        assert_abs_diff_eq!(resultant[..], [0.02, 0.1][..], epsilon = SOLVED);
        assert_eq!(s.method.slides, 0);
    }
}

#[test]
fn a_block_on_a_round_floor_touches_it_in_the_middle() {
    for degree in DEGREES {
        let gap = |[x, _]: [f64; 2]| 0.2 * (x - 0.5) * (x - 0.5);
        let whole = block_under(
            unit_square(8).mesh().unwrap(),
            [0.0, -0.1],
            vec![("bottom", Condition::contact(gap))],
        );
        let whole = solved(&whole, degree);
        assert!(whole.quantities.contact_length < 0.9);
        let resultant = whole.quantities.contact_resultant;
        assert_abs_diff_eq!(resultant[..], [0.0, 0.1][..], epsilon = SOLVED);
    }
}

/// A body without loads.
fn unloaded(mesh: Mesh, parts: Vec<(&'static str, Condition)>) -> Problem {
    block_under(mesh, [0.0, 0.0], parts)
}

#[test]
fn bodies_without_loads_are_held_by_what_squeezes_them() {
    for degree in DEGREES {
        let cell = || unit_square(4).mesh().unwrap();
        let tight =
            |sides: [&'static str; 4]| sides.map(|side| (side, Condition::contact(|_| -0.005)));
        let squeezed = unloaded(cell(), tight(["left", "right", "bottom", "top"]).into());
        let s = solved(&squeezed, degree);
        // Strains of -0.01 both ways: a pressure of 0.01 E / ((1 + nu) (1 - 2 nu)) on four sides of length 1, but for what
        // Nitsche's method lets through, which is nothing here.
        let pressure = 0.01 / (1.3 * 0.4);
        assert_abs_diff_eq!(s.quantities.contact_force, 4.0 * pressure, epsilon = SOLVED);
        assert_eq!(s.method.slides, 0);

        let held = |u_x, u_y| Condition::Displacement([u_x, u_y]);
        let roller = ("left", held(Some(constant(0.0)), None));
        let [floor, ceiling] = ["bottom", "top"].map(|side| (side, Condition::contact(|_| -0.005)));
        let shrunk = solved(&unloaded(cell(), vec![roller, floor, ceiling]), degree);
        let pressure = 0.01 / (1.0 - 0.09);
        assert_abs_diff_eq!(shrunk.quantities.contact_force, 2.0 * pressure, epsilon = SOLVED);

        let platen = ("top", held(None, Some(constant(-0.01))));
        let parts = vec![platen, ("bottom", Condition::contact(|_| 0.0))];
        let pressed = solved(&unloaded(cell(), parts), degree);
        assert_abs_diff_eq!(pressed.quantities.contact_force, pressure, epsilon = SOLVED);
        let [play] = pressed.plays[..] else { panic!("{:?}", pressed.plays) };
        assert_eq!((play.along, play.least, play.most), (Some([1.0, 0.0]), None, None));

        // A point above the middle is pushed down, and the floor stops the rotation about it.
        let mesh = cell();
        let at = mesh.vertices().iter().position(|&x| x == [0.5, 1.0]).unwrap();
        let mut pivot =
            unloaded(mesh, vec![("bottom", Condition::contact(|[x, _]| 0.002 * (x - 0.5)))]);
        let displacement = [0.0, -0.01].map(|u| Some(constant(u)));
        pivot.points.push(PointSupport { name: "pivot".to_owned(), vertex: at, displacement });
        let s = solved(&pivot, degree);
        assert_eq!(s.method.slides, 0);
        assert!(s.quantities.contact_force > 1e-3, "{}", s.quantities.contact_force);
    }
}

/// A block on a floor under a load that grows to the right, beside walls at these gaps.
fn beside_walls(gaps: [Option<f64>; 2]) -> Problem {
    let mut parts = vec![("bottom", Condition::contact(|_| 0.0))];
    for (side, gap) in ["left", "right"].into_iter().zip(gaps) {
        parts.extend(gap.map(|gap| (side, Condition::contact(move |_| gap))));
    }
    let mut problem = block_under(unit_square(6).mesh().unwrap(), [0.0, 0.0], parts);
    problem.body_force = [constant(0.0), function(|[x, _]| -0.02 - 0.01 * x)];
    problem
}

#[test]
fn a_block_between_walls_that_it_does_not_touch_is_where_its_displacement_is_least() {
    for degree in DEGREES {
        for gaps in [[Some(0.1), Some(0.1)], [Some(0.1), None], [Some(-0.03), Some(0.2)]] {
            let problem = beside_walls(gaps);
            let s = solved(&problem, degree);
            // From where it leans on the right wall, and from twice the load.
            let start: Vec<[f64; 2]> =
                s.displacement.iter().map(|u| [u[0] + 0.1, 2.0 * u[1]]).collect();
            let again = Course::default().from_displacement(&start);
            let settings = Settings::default();
            let (again, _) =
                solve_along(&problem, &method(degree, EXACT), &settings, again).unwrap();
            for (a, b) in s.displacement.iter().zip(&again.displacement) {
                assert_abs_diff_eq!(a[..], b[..], epsilon = 100.0 * SOLVED);
            }
            let mean: f64 = s.displacement.iter().map(|u| u[0]).sum();
            let pushed = gaps[0].is_some_and(|gap| gap < 0.0);
            assert!(if pushed { mean > 0.01 } else { mean.abs() < 100.0 * SOLVED }, "{mean}");
            let [play] = s.plays[..] else { panic!("{:?}", s.plays) };
            assert_eq!(play.along, Some([1.0, 0.0]));
            let side = s.displacement.iter().zip(&s.nodes);
            let least = side.filter(|(_, x)| x[0] == 0.0).map(|(u, _)| u[0]).fold(1.0, f64::min);
            let gap = gaps[0].unwrap();
            // Until P is zero somewhere: at the gap but for gamma times a stress.
            assert_abs_diff_eq!(play.least.unwrap(), -gap - least, epsilon = 1e-3);
            assert_eq!(play.most.is_some(), gaps[1].is_some());
            let side = s.displacement.iter().zip(&s.nodes);
            let most = side.filter(|(_, x)| x[0] == 1.0).map(|(u, _)| u[0]).fold(-1.0, f64::max);
            if let Some(gap) = gaps[1] {
                assert_abs_diff_eq!(play.most.unwrap(), gap - most, epsilon = 1e-3);
            }
            assert!(s.enclosure.is_ok(), "{:?}", s.enclosure.err());
        }
    }
}

#[test]
fn a_bulge_of_a_wall_that_is_not_touched_moves_no_body() {
    // One edge of P2 along the wall: P is negative there, and Bernstein's coefficient of its middle positive.
    let mesh = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 1, diagonal: Diagonal::Right };
    let gap = |[_, y]: [f64; 2]| 0.001 + 0.4 * (y - 0.5).powi(2);
    let parts = vec![("bottom", Condition::contact(|_| 0.0)), ("left", Condition::contact(gap))];
    let s = solved(&block_under(mesh.mesh().unwrap(), [0.0, -0.001], parts), Degree::Two);
    assert!(s.displacement.iter().all(|u| u[0].abs() < 1e-3), "{:?}", s.displacement);
    let [play] = s.plays[..] else { panic!("{:?}", s.plays) };
    assert!(play.least.is_some_and(|least| (-1e-3..=0.0).contains(&least)), "{play:?}");
    assert_eq!(play.most, None);
}

#[test]
fn a_wall_that_no_load_presses_is_left_out_of_the_energy_and_two_walls_may_squeeze() {
    for degree in DEGREES {
        for (gaps, is_left_out) in [([None, Some(0.0)], true), ([Some(0.1), Some(0.0)], false)] {
            let problem = beside_walls(gaps);
            let rule = EdgeRule::Exact;
            let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, rule).unwrap();
            let pieces = d.contact.iter().enumerate();
            let found: Vec<(String, bool)> =
                pieces.map(|(e, piece)| (piece.boundary().to_string(), d.is_idle(e))).collect();
            // Control: the floor carries the load.
            let is_right =
                |(name, idle): &(String, bool)| *idle == (is_left_out && name != "bottom");
            assert!(found.len() > 6 && found.iter().all(is_right), "{gaps:?}: {found:?}");
        }
    }
}

#[test]
fn a_shaft_that_the_loads_turn_in_its_bearing_is_refused_with_the_moment() {
    let mesh = polygon(32, 1);
    let bearing = Obstacle::Circle { center: [0.0; 2], radius: 1.0, side: Side::Inside };
    let condition = Condition::Obstacle("bearing".to_owned(), bearing);
    let mut problem = block_under(mesh, [0.0, -0.1], vec![("rim", condition)]);
    assert_eq!(solved(&problem, Degree::One).plays.len(), 1, "it may turn");
    problem.body_force[1] = function(|[x, _]| -0.1 - 0.01 * x);
    let error = solve(&problem, &method(Degree::One, EXACT), &Settings::default()).unwrap_err();
    let SolveError::Data(DataError::RigidMotion { motions, drive }) = &error else {
        panic!("{error}")
    };
    // int -0.01 x^2 over a polygon of 32 corners.
    assert_eq!(motions.len(), 1);
    assert_abs_diff_eq!(drive.unwrap(), -0.01 * std::f64::consts::PI / 4.0, epsilon = 2e-4);
    assert!(error.to_string().contains("rotation about (0, 0)"), "{error}");
    assert!(error.to_string().contains("drive it with a moment of -0.007"), "{error}");
}

#[test]
fn how_far_a_body_may_slide_does_not_depend_on_where_it_is() {
    for degree in DEGREES {
        let plays = |[p, q]: [f64; 2]| {
            let problem = beside_walls([Some(0.1), Some(0.2)]);
            let mesh = moved_to(&problem.mesh, |[x, y]| [x + p, y + q]);
            let mut moved = Problem { mesh, ..problem };
            moved.body_force[1] = function(move |[x, _]| -0.02 - 0.01 * (x - p));
            let s = solved(&moved, degree);
            let [play] = s.plays[..] else { panic!("{:?}", s.plays) };
            (play.along, play.least.unwrap(), play.most.unwrap())
        };
        let (along, least, most) = plays([0.0; 2]);
        assert!(along.is_some() && least < -0.05 && most > 0.1, "{least} {most}");
        for by in [[16.0, 0.0], [-3.0, 5.0], [0.0, -40.0]] {
            let there = plays(by);
            let [a, b] = [there.0, along].map(Option::unwrap);
            assert_abs_diff_eq!(a[..], b[..], epsilon = 1e-9);
            // Coordinates that are 40 times as large lose as many digits.
            assert_abs_diff_eq!(there.1, least, epsilon = 1e-9);
            assert_abs_diff_eq!(there.2, most, epsilon = 1e-9);
        }
        // Control: it does depend on the gap.
        let nearer = solved(&beside_walls([Some(0.1), Some(0.15)]), degree);
        assert!((nearer.plays[0].most.unwrap() - most).abs() > 0.04);
    }
}

#[test]
fn a_traction_along_a_component_that_is_held_does_nothing() {
    for degree in DEGREES {
        let solve_with = |[x, y]: [f64; 2]| {
            let side = Condition::Mixed {
                displacement: [Some(constant(0.0)), None],
                traction: [constant(x), constant(y)],
            };
            let parts = vec![("left", side), ("bottom", Condition::contact(|_| 0.0))];
            solved(&block_under(unit_square(4).mesh().unwrap(), [0.01, -0.1], parts), degree)
        };
        let (without, with) = (solve_with([0.0, -0.02]), solve_with([0.5, -0.02]));
        assert_eq!(without.displacement, with.displacement);
        assert_eq!(without.quantities.reactions, with.quantities.reactions);
        // What holds it carries the load along x, the floor what acts along y.
        assert_abs_diff_eq!(with.quantities.reactions["left"][0], -0.01, epsilon = SOLVED);
        assert_abs_diff_eq!(with.quantities.contact_force, 0.12, epsilon = SOLVED);
        // Control: along the free one it does.
        assert!(solve_with([0.0, -0.03]).displacement != without.displacement);
    }
}

#[test]
fn on_a_round_obstacle_u_n_and_gap_are_along_the_radius() {
    let (center, radius) = ([0.45, -2.0], 2.0);
    for degree in DEGREES {
        let round = Obstacle::Circle { center, radius, side: Side::Outside };
        let pushed = Condition::Displacement([0.02, -0.05].map(|u| Some(constant(u))));
        let parts =
            vec![("top", pushed), ("bottom", Condition::Obstacle("round".to_owned(), round))];
        let problem = unloaded(unit_square(6).mesh().unwrap(), parts);
        let (s, _) = solve(&problem, &method(degree, EXACT), &Settings::default()).unwrap();
        let mut off_the_normal = 0.0_f64;
        for (edge, piece) in s.contact.iter().zip(&s.pieces) {
            for point in &edge.points {
                let (x, u) = (point.place, point.displacement);
                let to = [center[0] - x[0], center[1] - x[1]];
                let far = to[0].hypot(to[1]);
                let u_n = (u[0] * to[0] + u[1] * to[1]) / far;
                assert_abs_diff_eq!(point.u_n, u_n, epsilon = SOLVED);
                assert_abs_diff_eq!(point.gap, far - radius, epsilon = SOLVED);
                let along_normal = u[0] * piece.normal()[0] + u[1] * piece.normal()[1];
                off_the_normal = off_the_normal.max((u_n - along_normal).abs());
            }
        }
        // Control: along the normal of the edges it would be something else.
        assert!(off_the_normal > 1e-3, "{off_the_normal}");
    }
}

#[test]
fn an_edge_that_faces_away_is_refused_inside_an_obstacle_and_not_where_it_only_begins_there() {
    // The upper half of a disk faces away from a floor.
    let contact = |height: f64| {
        let floor = Obstacle::Plane { point: [0.0, height], normal: [0.0, 1.0] };
        let condition = Condition::Obstacle("floor".to_owned(), floor);
        let problem = block_under(polygon(12, 1), [0.0, 0.0], vec![("rim", condition)]);
        let space = Space::new(&problem.mesh, Degree::One);
        contact_line::assemble(&problem, &space, 0.01).map(|line| line.len())
    };
    // The first edge of the upper half goes from height 0 to 1/2.
    assert_eq!(contact(0.2), Ok(12));
    assert!(matches!(contact(0.6), Err(DataError::WrongSide { .. })), "{:?}", contact(0.6));
}

/// A whole force in code and in a case file, beside a component that is held, is the force that the floor gives back.
#[test]
fn a_whole_force_is_spread_over_its_boundary_also_beside_a_component_that_is_held() {
    let mesh = unit_square(4).mesh().unwrap();
    let force = Condition::force([0.0, -3.0], &mesh, "top").unwrap();
    let unknown = Condition::force([0.0, -3.0], &mesh, "roof").err().unwrap().to_string();
    assert!(unknown.starts_with("no boundary named 'roof'"), "{unknown}");
    let problem = Problem::of(mesh, unit_material())
        .with("top", force)
        .with("left", Condition::normal(|_| 0.0))
        .with("bottom", Condition::contact(|_| 0.0));
    let (in_code, _) = solve(&problem, &Method::default(), &Settings::default()).unwrap();
    let text = "mesh.rectangle = { width = 1, height = 1, nx = 4, ny = 4 }
        material = { lambda = 1, mu = 1 }
        boundary.top = { displacement = [0, \"free\"], force = [0, -3] }
        boundary.bottom.contact = {}";
    let case = case_of(text, &[]);
    let (in_case, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
    for solution in [&in_code, &in_case] {
        // The tolerance of the solver is 1e-10 of the loads.
        let force = solution.quantities.contact_force;
        assert_abs_diff_eq!(force, 3.0, epsilon = 1e-9);
    }
    assert!(in_code.quantities.reactions["left"][0].abs() < 1e-9);
    assert!(
        in_code.displacement != in_case.displacement,
        "control: the top is held in one of them"
    );
}

/// A block that falls by 1 onto a floor and against a wall; gamma times the pressure is some 1e-18 beside the gap, so that P in doubles
/// has no digit of it.
#[test]
fn a_block_that_falls_far_lands_on_floor_and_wall() {
    let text = "
        mesh.rectangle = { width = 1, height = 1, nx = 8, ny = 8 }
        material = { young = 1, poisson = 0.999999 }
        load.body = [-3e-10, -1e-9]
        boundary.left.contact.gap = 1
        boundary.bottom.contact.gap = 1
    ";
    for (degree, poisson) in [(2, "0.499999"), (1, "0.4999")] {
        let degree = format!("method.degree={degree}");
        let case = case_of(&text.replace("0.999999", poisson), &[&degree]);
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        let displacement = solution.quantities.max_displacement;
        // It moves by the gap in both directions, and hardly strains.
        assert!(
            abs_diff_eq!(displacement, 2.0_f64.sqrt(), epsilon = 1e-8),
            "{degree}: {displacement}"
        );
        assert!(solution.plays.is_empty() && solution.balance.imbalance.abs() < 1e-8);
    }
}

/// Of a beam of 1 : 10^4 that lies on the floor A alone has a factor in doubles by luck; with the pressed edges it has one.
#[test]
fn a_slender_beam_that_lies_on_a_floor_is_proved_by_what_it_presses() {
    let text = r#"
        mesh.rectangle = { width = 10000, height = 1, nx = 100, ny = 1, diagonal = "crossed" }
        material = { young = 1, poisson = 0.3 }
        load.body = [0, -1e-4]
        boundary.left.displacement = [0, 0]
        boundary.bottom.contact.gap = 0.02
        method.degree = 2
    "#;
    for cells in ["100", "110", "180"] {
        let case = case_of(text, &[&format!("mesh.rectangle.nx={cells}")]);
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        assert_eq!(solution.verdict.reason(), None, "{cells}");
    }
}
