//! Bodies that no support holds, or not enough of them: contact does, because the loads press. The answers are known from
//! equilibrium, and from the same bodies on supports that happen to carry nothing.

use approx::assert_abs_diff_eq;
use signorini::fem::{Condition, DataError, Mesh, Obstacle, PointSupport, Problem, Side};
use signorini::kernel::{Material, Plane};
use signorini::solve::{
    Course, Degree, Method, RouteName, Settings, Solution, SolveError, solve, solve_along,
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
    assert_eq!(s.method.route, RouteName::Assembled);
    assert!(s.newton.residual <= 1e-10 && s.method.forward_error <= 1e-10);
    assert!(s.newton.iterations() <= 25);
    s
}

#[test]
fn a_block_on_a_floor_carries_its_weight_and_stays_where_it_is() {
    for degree in DEGREES {
        let mesh = skewed_square(6, signorini::fem::Diagonal::Crossed);
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
            assert!(s.enclosure.is_ok(), "{:?}", s.enclosure.err());
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
        assert!((force - 3.0).abs() < 1e-9, "{force}");
    }
    assert!(in_code.quantities.reactions["left"][0].abs() < 1e-9);
    assert!(
        in_code.displacement != in_case.displacement,
        "control: the top is held in one of them"
    );
}
