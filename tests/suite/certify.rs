//! Section 7 of docs/a-posteriori.md on exact solutions: the bound of |u - v|_a is never below the true error, and not far above
//! it; what is proved without quadrature says so; and what the bound would be worth with a part of it left out.
//!
//! Effectivity is bound over error. What is expected: below 2 where the solution is smooth and below 3 where it is singular,
//! which is what the stress costs.

use super::certified_supports::{self, turned_block, with_shear};
use super::quantities;
use crate::common::exact::{
    corner, moved, on_square, on_trapezoid, singular, smooth, smooth_with_gap,
};
use crate::common::*;
use std::sync::Arc;

use approx::assert_relative_eq;
use signorini::certificates::forces::Evidence;
use signorini::certificates::proof::{Claim, Edge, Role};
use signorini::certificates::{Continuous, Rejection, certify, certify_field};
use signorini::io::Case;
use signorini::io::certificate::{self, Header};
use signorini::io::result::ContinuousCertificate;
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Obstacle, PointSupport, Problem, SharedFunction, Side};
use signorini::results::Solution;
use signorini::solve::{Gamma0, Method, Settings, discretize, solve};
use study::Ladder;

/// The bounds on so many levels of a ladder, each of which is above the true error of the same field, by less than a factor.
fn bounds<const LEVELS: usize>(what: &str, ladder: &Ladder, limit: f64) -> [f64; LEVELS] {
    std::array::from_fn(|level| {
        let (_, problem, solution) = ladder.solve(level).unwrap();
        let certified = certify(&problem, &solution).unwrap();
        let error = error_of(&problem, &ladder.solution, &certified.displacement);
        let effectivity = certified.bound / error;
        assert!(
            1.0 <= effectivity && effectivity < limit,
            "{what}, level {level}: bound {} for the error {error}, effectivity {effectivity:.3}",
            certified.bound
        );
        certified.bound
    })
}

/// The bounds of singular solutions, on meshes with vertices moved at random, too.
fn bounds_of_singular_solutions(degree: Degree, limit: f64) {
    for c in [0.5, 1.0 / 3.0] {
        let ladder = on_square(&singular(c), degree, 8);
        bounds::<2>(&format!("(b) c = {c}"), &ladder, limit);
        bounds::<2>(&format!("(b) c = {c} moved"), &moved(ladder), limit);
    }
    bounds::<2>("(c)", &on_trapezoid(&corner(0.75).0, 0.75, degree, 8), 3.0);
}

#[test]
fn the_bound_is_above_the_error_and_below_twice_or_at_a_corner_thrice_the_error() {
    for (what, solution) in [
        ("(a) 3 2", smooth(3.0, 2.0, 1.0 / 3.0)),
        ("(a) 4 3", smooth(4.0, 3.0, 1.0 / 3.0)),
        ("(a) 4 3 with a gap", smooth_with_gap()),
    ] {
        bounds::<2>(what, &on_square(&solution, Degree::One, 8), 2.0);
    }
    bounds_of_singular_solutions(Degree::One, 2.0);
}

/// The stress is affine on three parts of each quarter of a triangle: a little farther from that of a smooth u than C eps(u^h)
/// is.
#[test]
fn the_bound_of_p2_falls_with_h_squared_and_is_below_twice_or_thrice_the_error() {
    for (what, solution) in
        [("(a) 4 3", smooth(4.0, 3.0, 1.0 / 3.0)), ("(a) 4 3 with a gap", smooth_with_gap())]
    {
        let [_, coarse, fine] = bounds(what, &on_square(&solution, Degree::Two, 8), 2.0);
        let rate = (coarse / fine).log2();
        assert!((1.9..2.2).contains(&rate), "{what}: {rate}");
    }
    // The body force jumps inside triangles: above the error, and not of its order.
    bounds::<2>("(a) 3 2", &on_square(&smooth(3.0, 2.0, 1.0 / 3.0), Degree::Two, 8), 5.0);
    bounds_of_singular_solutions(Degree::Two, 3.0);
}

#[test]
fn any_field_has_its_error_bounded() {
    DEGREES.into_iter().for_each(any_field_of);
}

fn any_field_of(degree: Degree) {
    let ladder = on_square(&singular(0.5), degree, 8);
    let (_, problem, solution) = ladder.solve(0).unwrap();
    let most = if degree == Degree::One { 2.0 } else { 3.0 };
    let mut random = Random(5);
    for size in [1e-4, 1e-3, 1e-2, 0.1, 1.0] {
        let noise = random.field(solution.displacement.len());
        let field: Vec<[f64; 2]> = solution
            .displacement
            .iter()
            .zip(&noise)
            .map(|(u, r)| [u[0] + size * r[0], u[1] + size * r[1]])
            .collect();
        let certified = certify_field(&problem, &solution, &field).unwrap();
        let error = error_of(&problem, &ladder.solution, &field);
        let effectivity = certified.of_field / error;
        assert!((1.0..most).contains(&effectivity), "{size}: {effectivity}");
        // Far from u the error of tau hardly counts.
        assert!(size < 0.1 || effectivity < 1.1, "{size}: {effectivity}");
        let sum: f64 = certified.indicators.iter().map(|x| x * x).sum();
        assert!(sum.sqrt() <= certified.bound + certified.clipping);
    }
}

#[test]
fn fields_that_penetrate_are_bounded_by_less_than_twice_their_error() {
    let (solution, _) = corner(0.75);
    let ladder = on_trapezoid(&solution, 0.75, Degree::One, 8);
    for level in 0..3 {
        let (_, problem, solution) = ladder.solve(level).unwrap();
        let method =
            Method { gamma0: Gamma0::Value(solution.gamma.gamma0 / 8.0), ..Method::default() };
        let (other, _) = solve(&problem, &method, &Settings::default()).unwrap();
        for field in [&solution.displacement, &other.displacement] {
            let certified = certify_field(&problem, &solution, field).unwrap();
            let ratio = certified.of_field / error_of(&problem, &ladder.solution, field);
            assert!((1.0..2.0).contains(&ratio), "level {level}: {ratio}");
            assert!(certified.clipping > 0.0);
        }
        // Control: by the triangle inequality it would be more.
        let certified = certify_field(&problem, &solution, &solution.displacement).unwrap();
        let error = error_of(&problem, &ladder.solution, &solution.displacement);
        assert!(certified.bound + certified.clipping > 2.0 * error, "level {level}");
    }
}

/// Of u^h, which goes through the obstacle, and of v, which does not, each is above its own error.
#[test]
fn the_error_of_the_solution_as_it_is_written_is_bounded_too() {
    let (solution, _) = corner(0.75);
    for degree in DEGREES {
        let ladder = on_trapezoid(&solution, 0.75, degree, 8);
        let (_, problem, solution) = ladder.solve(1).unwrap();
        let result = certify(&problem, &solution);
        let said = serde_json::to_value(ContinuousCertificate::from(&result)).unwrap();
        let said = ["bound", "of_solution"].map(|key| said[key].as_f64().unwrap());
        let certified = result.unwrap();
        let fields = [&certified.displacement, &solution.displacement];
        for (bound, field) in said.into_iter().zip(fields) {
            let ratio = bound / error_of(&problem, &ladder.solution, field);
            assert!((1.0..3.0).contains(&ratio), "{degree:?}: {ratio}");
        }
        // Control: they are two numbers.
        assert!(said[0] != said[1] && certified.clipping > 0.0);
    }
}

/// A clamped block with data of the exact class, that bends so that a part of its lower side stays in contact.
fn block(n: usize) -> (Problem, Solution) {
    block_of(n, Degree::One)
}

fn block_of(n: usize, degree: Degree) -> (Problem, Solution) {
    let problem = Problem::new(
        unit_square(n).mesh().unwrap(),
        unit_material(),
        [expression("0.8"), expression("-1")],
        conditions([
            ("top", Condition::Displacement([Some(expression("0")), Some(expression("0.1*x"))])),
            ("left", Condition::Pressure(expression("0.2 + y"))),
            ("bottom", Condition::Contact { gap: expression("0.1 - 0.2*x") }),
        ]),
    );
    let method = crate::common::method(degree, EXACT);
    let (solution, _) = solve(&problem, &method, &Settings::default()).unwrap();
    (problem, solution)
}

#[test]
fn a_quadratic_v_is_bounded_rigorously_and_encloses_the_potential_energy_more_closely() {
    for n in [8, 16] {
        let certified = |degree| {
            let (problem, solution) = block_of(n, degree);
            certify(&problem, &solution).unwrap()
        };
        let (one, two) = (certified(Degree::One), certified(Degree::Two));
        assert!(two.rigorous && two.reason.is_none());
        assert!(two.bound < 0.5 * one.bound, "{n}: {} {}", two.bound, one.bound);
        let ([low, high], [finer_low, finer_high]) = (one.energy.unwrap(), two.energy.unwrap());
        assert!(finer_low < finer_high && low.max(finer_low) <= high.min(finer_high));
        // All of its numbers lie within rounding of doubles.
        let quick = two.certificate.evaluate::<f64>().unwrap().bound;
        assert!(quick <= two.proof.bound && two.proof.bound <= (1.0 + 1e-9) * quick);
    }
}

#[test]
fn fields_of_other_degrees_are_bounded_by_the_stress_of_any_solution() {
    let ladder = on_square(&singular(0.5), Degree::Two, 8);
    let (_, problem, quadratic) = ladder.solve(0).unwrap();
    let (_, _, affine) = on_square(&singular(0.5), Degree::One, 8).solve(0).unwrap();
    for (solution, field) in [(&quadratic, &affine), (&affine, &quadratic)] {
        let certified = certify_field(&problem, solution, &field.displacement).unwrap();
        let ratio = certified.of_field / error_of(&problem, &ladder.solution, &field.displacement);
        // By the stress of the affine solution the bound of a quadratic field is that of the former.
        let most = if field.degree == Degree::One { 2.0 } else { 12.0 };
        assert!((1.0..most).contains(&ratio), "{:?}: {ratio}", field.degree);
    }
    let wrong = certify_field(&problem, &affine, &affine.displacement[1..]).unwrap_err();
    assert!(wrong.to_string().starts_with("the displacement has 80 values; expected"), "{wrong}");
}

#[test]
fn data_of_the_exact_class_make_the_bound_rigorous_and_enclose_the_potential_energy() {
    let mut before: Option<(f64, [f64; 2])> = None;
    for n in [4, 8, 16, 32] {
        let (problem, solution) = block(n);
        let certified = certify(&problem, &solution).unwrap();
        assert!(certified.rigorous && certified.reason.is_none());
        let [low, high] = certified.energy.unwrap();
        assert!(low < high);
        if let Some((bound, [coarse_low, coarse_high])) = before {
            // All contain J(u), and they shrink with h.
            assert!(low.max(coarse_low) <= high.min(coarse_high));
            assert!(high - low < 0.5 * (coarse_high - coarse_low), "{n}");
            assert!(certified.bound < 0.7 * bound, "{n}: {} after {bound}", certified.bound);
            // J(v) - J(u) is at least half the square of the error: seen from the finer mesh.
            assert!(coarse_high - high <= 0.5 * bound * bound);
        }
        before = Some((certified.bound, [low, high]));
    }
}

#[test]
fn where_loads_are_the_only_data_the_compliance_is_enclosed() {
    let loaded = |n: usize, gap: &str, lift: &str| {
        let problem = Problem::new(
            unit_square(n).mesh().unwrap(),
            unit_material(),
            [expression("0.8"), expression("-1")],
            conditions([
                ("top", Condition::Displacement([Some(expression("0")), Some(expression(lift))])),
                ("bottom", Condition::Contact { gap: expression(gap) }),
            ]),
        );
        let (solution, _) = solve(&problem, &Method::default(), &Settings::default()).unwrap();
        (certify(&problem, &solution).unwrap(), solution.quantities.work)
    };
    let (fine, work) = loaded(64, "0", "0");
    let [fine_low, fine_high] = fine.compliance.unwrap();
    for n in [4, 8, 16] {
        let (coarse, _) = loaded(n, "0", "0");
        let [low, high] = coarse.compliance.unwrap();
        // Both contain L(u), and what the finest mesh says of it is inside all others.
        assert!(low < work && work < high && low < fine_low && fine_high < high, "{n}");
        let [below, above] = coarse.energy.unwrap();
        assert_eq!([-2.0 * above, -2.0 * below], [low, high]);
    }
    // A gap or a support that moves does work of its own: no statement.
    for (gap, lift) in [("0.01", "0"), ("0", "-0.01")] {
        let (other, work) = loaded(8, gap, lift);
        assert!(other.compliance.is_none());
        // And rightly: here L(u) = -2 J(u) is wrong.
        let [low, high] = other.energy.unwrap();
        assert!(!(-2.0 * high..=-2.0 * low).contains(&work), "{gap} {lift}");
    }
}

#[test]
fn the_cases_have_certificates_and_say_what_they_prove() {
    // The distance to a plane is affine, that to a circle is not.
    for (name, rigorous, reason) in [
        ("disk.toml", true, ""),
        ("bracket.toml", true, ""),
        ("gap.toml", false, "the gap of 'bottom' is not known to be affine"),
        ("block.toml", true, ""),
        ("pin.toml", false, "on 'hole' a direction and a gap that are affine and quadratic"),
    ] {
        let mut of_degree_1 = f64::INFINITY;
        for degree in DEGREES {
            let degree_of = format!("method.degree={}", degree.number());
            let Case { problem, method, settings, .. } =
                case(name, &[&degree_of, "method.gamma0=auto"]);
            let (solution, _) = solve(&problem, &method, &settings).unwrap();
            let certified = certify(&problem, &solution).unwrap();
            let said = certified.reason.clone().unwrap_or_default();
            // That gap is a square of x.
            let followed = name == "gap.toml" && degree == Degree::Two;
            assert_eq!(certified.rigorous, rigorous || followed, "{name}: {said}");
            if degree == Degree::One {
                assert!(said.contains(reason), "{name}: {said}");
                assert!(certified.relative < 0.6, "{name}: {}", certified.relative);
                of_degree_1 = certified.bound;
            } else {
                assert!(certified.bound < of_degree_1, "{name}: {}", certified.bound);
            }
            let (header, bytes) = encoded(&certified);
            assert_eq!(accepts(&header, &bytes), Ok(()), "{name}");
        }
    }
}

#[test]
fn a_gap_along_a_direction_that_turns_is_that_of_the_problem_that_is_bounded() {
    let round = polygon(24, 2).with_boundary("upper", |[_, y]| y > 0.2).unwrap();
    let round = round.with_boundary("lower", |[_, y]| y < 0.2).unwrap();
    let straight = unit_square(3).mesh().unwrap().with_boundary("upper", |[_, y]| y == 1.0);
    let straight = straight.unwrap().with_boundary("lower", |[_, y]| y == 0.0).unwrap();
    for (mesh, turns) in [(round, true), (straight, false)] {
        let supports = [
            ("upper", Condition::Displacement(["0", "0"].map(|zero| Some(expression(zero))))),
            ("lower", Condition::Contact { gap: expression("0.01*exp(x)") }),
        ];
        let loads = ["0", "-1"].map(expression);
        let problem = Problem::new(mesh, unit_material(), loads, conditions(supports));
        for degree in DEGREES {
            let method = method(degree, EXACT);
            let (solution, _) = solve(&problem, &method, &Settings::default()).unwrap();
            let said = certify(&problem, &solution).unwrap().reason.unwrap_or_default();
            // The straight side is the control: there v lacks something of the gap.
            assert_eq!(said.contains("the gap of 'lower'"), !turns, "{degree:?}: {said}");
            let bounded = "has on 'lower' a direction and a gap that are affine and quadratic";
            assert_eq!(said.contains(bounded), turns, "{degree:?}: {said}");
        }
    }
}

#[test]
fn the_normal_as_a_direction_is_the_normal() {
    let (problem, solution) = block(8);
    let mut certificate = certify(&problem, &solution).unwrap().certificate;
    let along_the_normal = certificate.prove().unwrap().bound;
    for edge in &mut certificate.edges {
        if let Role::Contact { along, .. } = &mut edge.role {
            *along = Some([[0.0, -1.0]; 2]);
            // Where v touches to the last bit, intervals can't tell along a direction.
            for p in edge.ends {
                if let Some(v) = certificate.displacement.get_mut(p) {
                    v[1] += 1e-15;
                }
            }
        }
    }
    let along_a_direction = certificate.prove().unwrap().bound;
    assert_relative_eq!(along_a_direction, along_the_normal, max_relative = 1e-11);
    // Control: in another direction the same tractions have no friction to balance them, or v goes through.
    for edge in &mut certificate.edges {
        if let Role::Contact { along, .. } = &mut edge.role {
            *along = Some([[0.6, -0.8]; 2]);
        }
    }
    let other = certificate.prove().map(|proof| proof.bound);
    assert!(other.as_ref().map_or(true, |&bound| bound > 1.5 * along_the_normal), "{other:?}");
}

#[test]
fn on_a_round_obstacle_bounds_on_two_meshes_are_above_the_distance_of_their_solutions() {
    // A circle under a straight edge: the direction of contact turns along every edge.
    let certified = |n: usize| {
        let circle = Obstacle::Circle { center: [0.4, -3.0], radius: 3.0, side: Side::Outside };
        let problem = Problem::of(unit_square(n).mesh().unwrap(), unit_material())
            .with_body_force(|_| 0.3, |_| -1.0)
            .with("top", Condition::displacement(|_| 0.0, |_| -0.1))
            .with("bottom", Condition::Obstacle("pin".into(), circle));
        let (solution, _) = solve(&problem, &Method::default(), &Settings::default()).unwrap();
        let certified = certify(&problem, &solution).unwrap();
        let turning = certified.certificate.edges.iter().filter(
            |edge| matches!(edge.role, Role::Contact { along: Some([a, b]), .. } if a != b),
        );
        // Each has two parts, each with a pressure of its own, but for an end where nothing presses.
        assert!((n..=2 * n).contains(&turning.count()));
        assert!(!certified.rigorous);
        (problem, solution.displacement, certified.of_field)
    };
    let (fine_problem, fine, fine_bound) = certified(64);
    let d = discretize(&fine_problem, &Method::default()).unwrap();
    for n in [8, 16, 32] {
        let (coarse_problem, u, bound) = certified(n);
        // The coarse one on the fine mesh, which has all edges of the coarse one.
        let coarse_mesh = &coarse_problem.mesh;
        let refined = fine_problem.mesh.vertices().iter().map(|&x| {
            let (t, l) = coarse_mesh.locate(x).unwrap();
            let corners = coarse_mesh.triangles()[t].map(|k| u[k]);
            [0, 1].map(|c| (0..3).map(|k| l[k] * corners[k][c]).sum::<f64>())
        });
        let difference: Vec<[f64; 2]> =
            refined.zip(&fine).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
        let distance = d.strain_energy(&difference).sqrt();
        assert!(distance <= bound + fine_bound, "{n}: {distance}");
        // Neither is the bound far above: what is left is the error of the fine solution.
        assert!(bound <= 2.0 * (distance + fine_bound), "{n}: {bound}");
    }
}

/// Half of the bound, or a third of it, would else be the pressure times what v is off the obstacle; of degree 1, where the
/// direction turns, a sixth.
#[test]
fn v_is_put_on_the_curved_obstacle_that_it_presses() {
    for (name, degree, most) in [("disk", 2, 0.025), ("pin", 2, 0.012), ("pin", 1, 0.105)] {
        let case = case(&format!("{name}.toml"), &[&format!("method.degree={degree}")]);
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        let certified = certify(&case.problem, &solution).unwrap();
        assert!(certified.relative <= most, "{name}, {degree}: {}", certified.relative);
    }
}

#[test]
fn balls_intervals_and_doubles_agree_to_rounding() {
    let (problem, solution) = block(8);
    let certificate = certify(&problem, &solution).unwrap().certificate;
    let proved = certificate.prove().unwrap().bound;
    let quick = certificate.evaluate::<f64>().unwrap().bound;
    assert!(quick <= proved && proved <= (1.0 + 1e-9) * quick, "{quick} {proved}");
}

/// lambda = 0: on the unit square the floor at height d makes u = (0, d (1 - y)); without it (g = 0) u = 0. v and tau of
/// the first are admissible for the second, with |C eps(v) - tau| = 0.
fn raised_floor(d: f64) -> Continuous {
    let problem = Problem::new(
        unit_square(4).mesh().unwrap(),
        Material::lame(0.0, 1.0, Plane::Strain),
        [expression("0"), expression("0")],
        conditions([("top", Condition::clamped()), ("bottom", Condition::contact(move |_| -d))]),
    );
    let (solution, _) = solve(&problem, &Method::default(), &Settings::default()).unwrap();
    certify(&problem, &solution).unwrap()
}

#[test]
fn control_without_the_contact_term_there_would_be_no_bound() {
    let d = 0.25;
    let certified = raised_floor(d);
    let error = 2.0_f64.sqrt() * d;
    let mut certificate = certified.certificate;
    let with_the_floor = certificate.prove().unwrap();
    // What is left when the contact term is dropped: nothing, though u is far away.
    // (but for the root of the margin by which v is kept off the floor, 1e-11).
    assert!(with_the_floor.bound < 1e-4, "{}", with_the_floor.bound);
    for edge in &mut certificate.edges {
        if let Role::Contact { gap, .. } = &mut edge.role {
            *gap = [0.0; 2];
        }
    }
    let without = certificate.prove().unwrap();
    let effectivity = without.bound / error;
    assert!((1.0..1.5).contains(&effectivity), "{effectivity}");
}

#[test]
fn control_a_wrong_load_is_seen_by_the_bound() {
    let (problem, solution) = block(8);
    let certified = certify(&problem, &solution).unwrap();
    let mut certificate = certified.certificate;
    certificate.pieces.iter_mut().for_each(|piece| piece.body.iter_mut().for_each(|f| f[1] *= 4.0));
    let bound = certificate.prove().unwrap().bound;
    assert!(bound > 3.0 * certified.bound, "{bound} {}", certified.bound);
}

#[test]
fn a_function_without_a_degree_makes_the_bound_say_that_it_rests_on_quadrature() {
    let problem = crate::common::block(unit_square(8).mesh().unwrap());
    assert_eq!(problem.body_force[1].degree(), None);
    let (solution, _) = solve(&problem, &Method::default(), &Settings::default()).unwrap();
    let certified = certify(&problem, &solution).unwrap();
    assert!(!certified.rigorous && certified.energy.is_none());
    let reason = certified.reason.unwrap();
    assert!(reason.starts_with("the body force is not known to be affine"), "{reason}");
}

/// A cubic traction beside one that is 0: of the rule of the latter, one point, the middle of the edge, sees nothing of the former.
#[test]
fn the_bound_counts_a_traction_whose_other_component_is_constant() {
    let of = |n: usize, degree: u32, y: &str| {
        let text = format!(
            "mesh.rectangle = {{ width = 1.0, height = 1.0, nx = {n}, ny = {n} }}\n\
             material = {{ young = 1.0, poisson = 0.3 }}\nmethod.degree = {degree}\n[boundary]\n\
             bottom.contact = {{ gap = \"0\" }}\nleft.displacement = [\"0\", \"0\"]\n\
             top.traction = [\"(x - 0.5)^3\", \"{y}\"]\n"
        );
        let case = case_of(&text, &[]);
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        (case.problem, solution)
    };
    let norm = |solution: &Solution| solution.quantities.energy.sqrt();
    let (problem, solution) = of(1, 1, "0");
    let bound = certify(&problem, &solution).unwrap().bound;
    let error = norm(&of(16, 2, "0").1) - norm(&solution);
    assert!(bound > error, "{bound} for an error of {error} or more");
    for degree in [1, 2] {
        let [plain, cubic] = ["0", "0 * x^3"].map(|y| {
            let (problem, solution) = of(2, degree, y);
            certify(&problem, &solution).unwrap().bound
        });
        assert_relative_eq!(plain, cubic, max_relative = 1e-12);
    }
}

#[test]
fn an_oscillation_below_zero_is_refused() {
    let (problem, solution) = block(4);
    let certificate = certify(&problem, &solution).unwrap().certificate;
    let with = |oscillation: f64| {
        let mut certificate = certificate.clone();
        certificate.pieces[0].oscillation = oscillation;
        certificate.prove()
    };
    assert!(with(1e-3).is_ok());
    for oscillation in [-1e-3, -f64::MIN_POSITIVE, f64::INFINITY, f64::NAN] {
        let found = with(oscillation);
        let is_refused = matches!(found, Err(Rejection::Wrong { what: "triangle", index: 0, .. }));
        assert!(is_refused, "{oscillation}: {found:?}");
    }
}

#[test]
fn a_couple_on_an_edge_leaves_its_triangles_out_of_balance() {
    let (problem, solution) = block(4);
    let certificate = certify(&problem, &solution).unwrap().certificate;
    let is_inner = |edge: &Edge| matches!(edge.role, Role::Inner(_));
    let vertices = certificate.vertices.len();
    let e = certificate
        .edges
        .iter()
        .position(|edge| is_inner(edge) && edge.ends.iter().all(|&p| p < vertices))
        .unwrap();
    let audited = |size: f64| {
        let mut certificate = certificate.clone();
        let [a, b] = certificate.edges[e].ends.map(|p| certificate.vertices[p]);
        let across = [b[1] - a[1], a[0] - b[0]];
        if let Role::Inner(force) = &mut certificate.edges[e].role {
            for c in 0..2 {
                force[0][c] += size * across[c];
                force[1][c] -= size * across[c];
            }
        }
        // Who tampers can compute shares and bound, too.
        let proof = certificate.prove().unwrap();
        let (bound, forces) = (2.0 * proof.bound, Evidence::default());
        certificate.audit(&Claim { shares: proof.shares, bound, forces })
    };
    assert!(audited(0.0).is_ok());
    let found = audited(1e-3);
    assert!(matches!(found, Err(Rejection::OutOfBalance { .. })), "{found:?}");
}

/// The certificate of the block as files.
fn written(n: usize, degree: Degree) -> (Header, Vec<u8>) {
    let (problem, solution) = block_of(n, degree);
    encoded(&certify(&problem, &solution).unwrap())
}

/// Whether the checker accepts these files.
pub fn accepts(header: &Header, bytes: &[u8]) -> Result<(), String> {
    let (certificate, claim) = certificate::decode(header, bytes)?;
    certificate.audit(&claim).map(|_| ()).map_err(|e| e.to_string())
}

/// Where contact ends, and the middles of edges, are no doubles: in balls they are as uncertain as their coordinates are large,
/// and the triangles are small beside these.
#[test]
fn certificates_of_bodies_far_from_the_origin_are_accepted() {
    let [far, small] = [3000.1, 0.1];
    for (degree, place, angle) in [
        (Degree::One, small, 0.0),
        (Degree::Two, small, 0.0),
        (Degree::One, far, 0.0),
        (Degree::Two, far, 0.0),
        (Degree::One, far, 0.5),
        (Degree::Two, far, 0.5),
    ] {
        let (sin, cos) = f64::sin_cos(angle);
        let there = |x| turned(angle, x).map(|c| place + c);
        // It presses on the left, and lifts on the right.
        let down = format!("4 - 10*({cos:?}*(x - {place:?}) + {sin:?}*(y - {place:?}))");
        let zero = || expression("0");
        let problem = Problem::new(
            moved_to(&unit_square(8).mesh().unwrap(), there),
            unit_material(),
            [sin, -cos].map(|along| expression(&format!("{along:?}*({down})"))),
            conditions([
                ("top", Condition::Displacement([Some(zero()), Some(zero())])),
                ("bottom", Condition::Contact { gap: zero() }),
            ]),
        );
        let method = Method { degree, gamma0: Gamma0::Auto, ..Method::default() };
        let (solution, _) = solve(&problem, &method, &Settings::default()).unwrap();
        let certified = certify(&problem, &solution).unwrap();
        assert_eq!(certified.reason, None);
        assert!(!certified.certificate.cuts.is_empty());
        let most = if degree == Degree::One { 0.4 } else { 0.1 };
        assert!(certified.relative < most, "{place} {angle}: {}", certified.relative);
        let (header, bytes) = encoded(&certified);
        assert_eq!(accepts(&header, &bytes), Ok(()), "{place} {angle}");
    }
}

/// The reader of decimals may be one double off; many certificates, for it rarely is.
#[test]
fn certificates_are_accepted_from_their_files() {
    let folder =
        std::env::temp_dir().join(format!("signorini-certificates-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for n in 2..14 {
        let (header, bytes) = written(n, if n % 3 == 0 { Degree::Two } else { Degree::One });
        // An array of another degree is none.
        assert!(accepts(&Header { degree: 3 - header.degree, ..header.clone() }, &bytes).is_err());
        let json = folder.join(certificate::FILES[0]);
        std::fs::write(&json, serde_json::to_vec(&header).unwrap()).unwrap();
        std::fs::write(folder.join(certificate::FILES[1]), bytes).unwrap();
        let audit = certificate::audit(&json).unwrap();
        assert!(audit.reservations.is_empty() && audit.proof.bound <= audit.header.bound, "{n}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// What a word of certificate.bin is.
#[derive(Clone, Copy, PartialEq)]
enum Word {
    /// An index, a role, or whether there is a number.
    Whole,
    Number,
    /// A gap: no bound feels it where there is no pressure, so the hash alone protects it.
    Gap,
    /// A displacement or a stress that proves a force, which is near the best: an interval feels the square of a change only.
    Best,
    /// A bulge of v: the work of C eps(u^h) - tau with a bulge is 0, so that a bound feels the square of a change only, which is
    /// to be more than a rounding error of the bound.
    Bulge,
}

fn kind(header: &Header, bytes: &[u8], word: usize) -> Word {
    let (mut first, mut edges) = (0, 0);
    for array in &header.arrays {
        let each = array.words.len();
        if array.name == "edges" {
            edges = first;
        }
        if word < first + array.entries * each {
            let (entry, inside) = ((word - first) / each, (word - first) % each);
            let is_contact_edge = |e: usize| bytes[8 * (edges + 7 * e + 2)] == 6;
            return match (&*array.name, inside) {
                // No force is that of such a boundary: a case compares the names.
                ("boundaries", 1) => Word::Gap,
                (_, i) if &array.words[i..=i] == "n" => Word::Whole,
                ("edges", 5..) if is_contact_edge(entry) => Word::Gap,
                ("bulges", 0 | 1) => Word::Bulge,
                ("bulges", 2) if is_contact_edge(entry) => Word::Gap,
                ("dual forces", _) => Word::Number,
                (name, _) if name.starts_with("w") || name.starts_with("dual") => Word::Best,
                _ => Word::Number,
            };
        }
        first += array.entries * each;
    }
    unreachable!("the arrays have all words")
}

/// Changes one word: a number beyond its last bits, in sign or in size, or an index.
fn tamper(bytes: &mut [u8], word: usize, is: Word, random: &mut Random) -> bool {
    let place = 8 * word..8 * word + 8;
    let old = u64::from_le_bytes(bytes[place.clone()].try_into().unwrap());
    let value = f64::from_bits(old);
    let how = random.next();
    let new = match is {
        Word::Gap => old,
        Word::Whole if how < 0.0 => old.wrapping_add(1),
        Word::Whole => old.wrapping_add(2 + (100.0 * (1.0 + random.next())) as u64),
        Word::Number | Word::Bulge | Word::Best => {
            // A triangle may be out of balance by 128 units of rounding of the dozen forces on it, of which this may be one of
            // the smaller.
            let least = match is {
                Word::Best => 1e-4,
                Word::Bulge => 1e-5,
                _ => 1e-10,
            };
            let changed = match how {
                // The square of a change of a small number is a rounding error.
                _ if is == Word::Best && value.abs() < 1e-3 => value + random.next(),
                h if h < -0.5 => -value,
                h if h < 0.0 && value != 0.0 => value * (1.0 + least * (1.5 + random.next())),
                h if h < 0.5 && value != 0.0 => value * (1.0 + 0.1 * random.next()),
                _ => value + random.next(),
            };
            // 0 and -0 are the same number.
            if changed == value { old } else { changed.to_bits() }
        }
    };
    bytes[place].copy_from_slice(&new.to_le_bytes());
    new != old
}

#[test]
fn a_thousand_tampered_certificates_are_rejected() {
    tampered(Degree::One);
}

#[test]
fn a_thousand_tampered_certificates_of_a_quadratic_v_are_rejected() {
    tampered(Degree::Two);
}

/// Of a body with oblique supports, pressures and a gap, of one with a traction beside a support, and of one with forces.
fn tampered(degree: Degree) {
    for (certified, array) in [
        (certified_supports::certified(&turned_block(4, 0.3, "0.01*(1 - Y)"), degree).1, "frames"),
        (certified_supports::certified(&with_shear(), degree).1, "edges"),
        (quantities::by_a_dual_pair(&quantities::tilted_punch(4), degree), "dual forces"),
    ] {
        let (header, bytes) = encoded(&certified);
        assert!(header.arrays.iter().any(|a| a.name == array && a.entries > 0), "{array}");
        rejects_what_is_tampered(&header, &bytes);
    }
}

/// A thousand changes of single words, each of which makes the checker reject the certificate.
fn rejects_what_is_tampered(header: &Header, bytes: &[u8]) {
    let mut random = Random(11);
    let words = bytes.len() / 8;
    let mut done = 0;
    let mut accepted = Vec::new();
    while done < 1000 {
        let word = random.below(words);
        let mut changed = bytes.to_vec();
        if !tamper(&mut changed, word, kind(header, bytes, word), &mut random) {
            continue;
        }
        done += 1;
        // Who tampers can compute a hash, too.
        let mut forged = header.clone();
        assert!(accepts(&forged, &changed).is_err(), "the hash of word {word}");
        forged.hash = certificate::hash(&changed);
        if accepts(&forged, &changed).is_ok() {
            let (old, new) = (&bytes[8 * word..8 * word + 8], &changed[8 * word..8 * word + 8]);
            let number = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap());
            accepted.push((word, number(old), number(new)));
        }
    }
    assert!(accepted.is_empty(), "{} accepted: {accepted:?} of {words} words", accepted.len());
}

#[test]
fn a_certificate_without_its_last_triangle_or_with_another_claim_is_rejected() {
    let (header, bytes) = written(4, Degree::One);
    let mut short = header.clone();
    let triangles = short.arrays.iter_mut().find(|array| array.name == "triangles").unwrap();
    triangles.entries -= 1;
    assert!(accepts(&short, &bytes).is_err());
    let (mut certificate, mut claim) = certificate::decode(&header, &bytes).unwrap();
    certificate.pieces.pop();
    claim.shares.pop();
    assert!(certificate.audit(&claim).is_err());
    let (certificate, claim) = certificate::decode(&header, &bytes).unwrap();
    let fewer = Claim { shares: claim.shares[1..].to_vec(), ..claim.clone() };
    assert!(matches!(certificate.audit(&fewer), Err(Rejection::Length { .. })));
    let mut claim = claim;
    claim.bound *= 0.99;
    assert!(matches!(certificate.audit(&claim), Err(Rejection::Bound { .. })));
}

#[test]
fn control_the_signs_are_what_rejects_a_tension_with_a_consistent_claim() {
    // The whole contact line in tension, balanced anew: every number fits, and only the sign is wrong.
    let (problem, solution) = block(8);
    let mut certificate = certify(&problem, &solution).unwrap().certificate;
    for edge in &mut certificate.edges {
        if let Role::Contact { pressure, .. } = &mut edge.role {
            *pressure = pressure.map(|p| p + 0.5);
        }
    }
    let refused = certificate.prove();
    assert!(matches!(refused, Err(Rejection::Tension { .. })), "{refused:?}");
    // Without the line Gamma_C the same stress passes: as a given pressure.
    for edge in &mut certificate.edges {
        if let Role::Contact { pressure, .. } = edge.role {
            edge.role = Role::Pressed(pressure.map(|p| -p));
        }
    }
    assert!(certificate.prove().is_ok());
}

#[test]
fn a_point_is_named_as_in_the_case_file() {
    let (mut problem, solution) = block(4);
    let mut said = |value: f64| {
        let u_x: SharedFunction = Arc::new(move |_: [f64; 2]| value);
        let displacement = [Some(u_x), None];
        problem.points = vec![PointSupport { name: "a b".to_owned(), vertex: 0, displacement }];
        match discretize(&problem, &Method::default()) {
            Err(error) => error.to_string(),
            Ok(_) => certify(&problem, &solution).unwrap_err().to_string(),
        }
    };
    let holds = said(0.0);
    assert!(holds.contains("[point.\"a b\"] holds a point"), "{holds}");
    let value = said(f64::NAN);
    assert!(value.contains("[point.\"a b\"] displacement[0]"), "{value}");
}
