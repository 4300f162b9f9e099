//! Forces of the true solution between two numbers, and where contact can act (docs/a-posteriori.md, 7.7).

use std::sync::Arc;

use approx::assert_relative_eq;
use signorini::certificates::dual::WrongPair;
use signorini::certificates::forces::{Evidence, Motion, WrongLifting};
use signorini::certificates::proof::{Certificate, Role};
use signorini::certificates::quantities::{Limit, Name};
use signorini::certificates::{
    Asked, Continuous, Ramp, Target, adapt, adapt_to, certify, certify_with, forces,
};
use signorini::exact::Exact;
use signorini::exact::{Kind, Patch};
use signorini::io::certificate::{self, Header};
use signorini::kernel::Ball;
use signorini::model::Degree;
use signorini::model::{Condition, Perturbation, Problem, Structured};
use signorini::results::Solution;
use signorini::solve::{Method, Settings, solve};

use super::certify::accepts;
use super::common::exact::singular;
use super::common::*;

/// The unit square on a floor, its top pushed down by 0.1 at the left and raised by 0.05 at the right.
pub fn tilted_punch(n: usize) -> Problem {
    let top = ["0", "-0.1 + 0.15*x"].map(|u| Some(expression(u)));
    let material = unit_material();
    let problem = Problem::of(unit_square(n).mesh().unwrap(), material);
    Problem { body_force: [expression("0"), expression("0")], ..problem }
        .with("top", Condition::Displacement(top))
        .with("bottom", Condition::Contact { gap: expression("0") })
}

/// Its contact force: P2 on 256 x 256 cells has 0.0867719534, P2 on adapted meshes 0.0867715163.
const FORCE: f64 = 0.086_771_5;

fn solved(problem: &Problem, degree: Degree) -> Solution {
    let method = Method { degree, ..Method::default() };
    solve(problem, &method, &Settings::default()).unwrap().0
}

fn certified(problem: &Problem, degree: Degree) -> Continuous {
    certify(problem, &solved(problem, degree)).unwrap()
}

fn interval(certified: &Continuous, name: Name, boundary: &str) -> [f64; 2] {
    let of = certified.quantities.list.iter().find(|q| q.name == name && q.boundary == boundary);
    of.unwrap().interval.clone().unwrap()
}

/// Half the width of an interval over the contact force of the tilted punch, in per cent.
fn half_width([low, high]: [f64; 2]) -> f64 {
    100.0 * (high - low) / 2.0 / FORCE
}

#[test]
fn the_force_of_the_tilted_punch_lies_between_two_numbers_that_near_each_other_as_h() {
    for (n, half) in [(8, 16.5), (16, 8.4), (32, 4.4)] {
        let c = certified(&tilted_punch(n), Degree::One);
        let force = interval(&c, Name::ContactForce, "bottom");
        assert!(c.rigorous && force[0] <= FORCE && FORCE <= force[1], "n = {n}: {force:?}");
        assert!(half_width(force) <= 1.3 * half, "n = {n}: {} %", half_width(force));
        // With the whole bound in place of M it would be beyond that.
        assert!(half_width(force) * c.bound / c.quantities.mean_stress > 1.3 * half);
        // M is between a half and 1 / sqrt 2 of the bound.
        let ratio = c.quantities.mean_stress / c.bound;
        assert!((0.5 - 1e-12..0.71).contains(&ratio), "M is {ratio} of the bound");
        // Nothing else holds the body: the reaction is minus the force, within both intervals.
        let reaction = interval(&c, Name::Reaction(1), "top");
        assert!(reaction[0] <= -FORCE && -FORCE <= reaction[1]);
        let [low, high] = interval(&c, Name::PeakPressure, "bottom");
        assert!(0.08 < low && low < 0.3 && high == f64::INFINITY, "peak at least {low}");
    }
}

pub fn by_a_dual_pair(problem: &Problem, degree: Degree) -> Continuous {
    let asked = Asked { forces: vec![("bottom".to_owned(), None)] };
    certify_with(problem, &solved(problem, degree), &asked).unwrap()
}

/// How far the ends of the contact force of the tilted punch are from it by dual pairs, in per cent.
fn ends_to_second_order(n: usize) -> [f64; 2] {
    let c = by_a_dual_pair(&tilted_punch(n), Degree::One);
    assert!(c.rigorous && !c.quantities.evidence.pairs.is_empty());
    let ends = interval(&c, Name::ContactForce, "bottom");
    assert!(ends[0] <= FORCE && FORCE <= ends[1], "n = {n}: {ends:?}");
    // The checker finds the same again.
    let again = c.certificate.prove_forces(&c.quantities.evidence).unwrap();
    assert!(again.iter().flatten().any(|found| *found == ends));
    let relative = |end: f64| 100.0 * (end - FORCE).abs() / FORCE;
    let ends = ends.map(relative);
    eprintln!("n = {n}: {ends:?} %");
    ends
}

/// On n cells a side, what the ends are at most off, in per cent; from level to level the lower one falls by 2^1.3.
fn to_second_order(levels: &[(usize, [f64; 2])]) {
    let mut before = f64::INFINITY;
    for &(n, most) in levels {
        let ends = ends_to_second_order(n);
        assert!(ends[0] <= 1.3 * most[0] && ends[1] <= 1.3 * most[1], "n = {n}: {ends:?}");
        assert!(ends[0] <= before / 1.3_f64.exp2(), "n = {n}: {} after {before}", ends[0]);
        before = ends[0];
    }
}

#[test]
fn by_dual_pairs_the_lower_end_is_of_second_order() {
    to_second_order(&[(8, [3.6, 9.3]), (16, [1.35, 3.9]), (32, [0.52, 1.73])]);
}

#[test]
#[ignore = "a minute: run by .ci/run"]
fn by_dual_pairs_the_lower_end_is_of_second_order_on_fine_meshes() {
    to_second_order(&[(32, [0.52, 1.73]), (64, [0.21, 0.93])]);
    let c = certified(&tilted_punch(64), Degree::One);
    let half = half_width(interval(&c, Name::ContactForce, "bottom"));
    assert!(half <= 1.3 * 2.4, "{half} %");
}

#[test]
fn forces_in_files_are_verified_and_refused_without_their_names() {
    for degree in DEGREES {
        let c = by_a_dual_pair(&tilted_punch(4), degree);
        assert!(!c.quantities.evidence.pairs.is_empty());
        let (header, bytes) = encoded(&c);
        assert_eq!(accepts(&header, &bytes), Ok(()));
        let (certificate, claim) = certificate::decode(&header, &bytes).unwrap();
        assert_eq!((&certificate, &claim.forces), (&c.certificate, &c.quantities.evidence));
        let unnamed = Header { boundaries: vec!["bottom".to_owned()], ..header };
        assert!(accepts(&unnamed, &bytes).is_err());
    }
}

#[test]
fn forces_that_are_not_what_their_data_give_are_refused() {
    let weight = Ramp { axis: 0, between: [0.0, 0.25], width: 0.125 };
    let asked = Asked { forces: vec![("bottom".to_owned(), Some(weight))] };
    let problem = tilted_punch(8);
    let c = certify_with(&problem, &solved(&problem, Degree::One), &asked).unwrap();
    let place = |evidence: &Evidence| {
        let of =
            |(target, _): &(forces::ForceTarget, _)| target.motion == Motion::Along(Some(weight));
        evidence.liftings.iter().position(of).unwrap()
    };
    type Change<'a> = (&'a str, &'a dyn Fn(&mut Evidence));
    let changes: [Change; 6] = [
        ("as it was", &|_| {}),
        ("a narrower interval", &|e| {
            let k = place(e);
            e.between.as_mut().unwrap().liftings[k][0] += 1e-6;
        }),
        ("a narrower interval of a pair", &|e| {
            e.between.as_mut().unwrap().pairs[0][0] += 1e-6;
        }),
        ("another patch", &|e| {
            let k = place(e);
            let further = Ramp { between: [0.0, 0.26], ..weight };
            e.liftings[k].0.motion = Motion::Along(Some(further));
        }),
        ("another w", &|e| {
            let k = place(e);
            e.liftings[k].1.vertices[40][1] += 1e-3;
        }),
        ("another rho", &|e| {
            let inner = e.pairs[0].1.roles.iter_mut().find_map(|role| match role {
                Role::Inner(force) => Some(force),
                _ => None,
            });
            inner.unwrap()[0][0] += 1e-3;
        }),
    ];
    for (what, change) in changes {
        let mut c = c.clone();
        change(&mut c.quantities.evidence);
        let (header, bytes) = encoded(&c);
        assert_eq!(accepts(&header, &bytes).is_ok(), what == "as it was", "{what}");
    }
}

#[test]
fn of_a_patch_test_the_force_is_known_to_twelve_digits() {
    let p = 0.25;
    let material = unit_material();
    let patches = [
        (Patch::compression(material, p), p),
        (Patch::inclined(material, p, 0.125, 0.0625), p),
        (Patch::interference(material, 0.25), 0.75),
    ];
    for (k, (patch, force)) in patches.into_iter().enumerate() {
        for degree in DEGREES {
            let kinds = [("top", Kind::Displacement), ("bottom", Kind::Contact)];
            let sides = [("left", Kind::Traction), ("right", Kind::Traction)];
            let kinds = kinds.into_iter().chain(sides).map(|(name, kind)| (name.to_owned(), kind));
            let solution: Exact = Arc::new(patch.clone());
            let problem =
                study::problem(&solution, unit_square(4).mesh().unwrap(), &kinds.collect());
            let c = by_a_dual_pair(&problem, degree);
            let [low, high] = interval(&c, Name::ContactForce, "bottom");
            eprintln!("{k} {degree:?}: {} {} rigorous {}", low - force, high - force, c.rigorous);
            assert!(
                low <= force + 1e-13 && force - 1e-13 <= high,
                "{k} {degree:?}: [{low}, {high}]"
            );
            assert!(high - low <= 1e-12, "{k} {degree:?}: [{low}, {high}]");
        }
    }
}

#[test]
fn of_a_body_that_contact_alone_holds_the_force_is_the_load() {
    let case = case("disk_force.toml", &[]);
    let c = certified(&case.problem, Degree::One);
    let load = 8.5;
    let [low, high] = interval(&c, Name::ContactComponent(1), "contact");
    eprintln!("{} {}", low - load, high - load);
    assert!(low <= load + 1e-11 && load - 1e-11 <= high, "[{low}, {high}]");
    assert!(high - low <= 1e-9, "[{low}, {high}]");
    // Control: one part in ten million more is not in it.
    assert!(high < load * (1.0 + 1e-7));
}

#[test]
fn a_dual_pair_bounds_the_force_on_a_round_body_over_a_floor() {
    let case = case("disk.toml", &[]);
    let asked = Asked { forces: vec![("contact".to_owned(), None)] };
    let solution = solved(&case.problem, Degree::One);
    let nearer = certify_with(&case.problem, &solution, &asked).unwrap();
    let first = certify(&case.problem, &solution).unwrap();
    assert!(!nearer.quantities.evidence.pairs.is_empty());
    let [first, nearer] = [&first, &nearer].map(|c| interval(c, Name::ContactForce, "contact"));
    let finer = solved(&case.problem, Degree::Two).boundaries[0].force;
    eprintln!("{first:?} {nearer:?} {finer}");
    assert!(nearer[0] <= finer && finer <= nearer[1], "{nearer:?}, {finer}");
    assert!(nearer[1] - nearer[0] < 0.6 * (first[1] - first[0]), "{nearer:?}, {first:?}");
}

#[test]
fn a_dual_stress_that_is_not_one_is_refused() {
    let c = by_a_dual_pair(&tilted_punch(8), Degree::One);
    // A traction on Gamma_N.
    let mut evidence = c.quantities.evidence.clone();
    let roles = &mut evidence.pairs[0].1.roles;
    let free = roles.iter_mut().find(|role| matches!(role, Role::Loaded(_))).unwrap();
    *free = Role::Loaded([[1e-9, 0.0]; 2]);
    let found = c.certificate.prove_forces(&evidence);
    assert!(matches!(found, Err(WrongPair::Differs { .. })), "{found:?}");
    // What holds the body holds one component only.
    let mut evidence = c.quantities.evidence.clone();
    let is_top = |edge: &usize| matches!(c.certificate.edges[*edge].role, Role::Held(..));
    let top = (0..c.certificate.edges.len()).find(is_top).unwrap();
    let Role::Held([true, true], _) = evidence.pairs[0].1.roles[top] else { panic!("held") };
    evidence.pairs[0].1.roles[top] = Role::Held([false, true], [[0.0; 2]; 2]);
    let found = c.certificate.prove_forces(&evidence);
    assert!(matches!(found, Err(WrongPair::Differs { what: "edge", .. })), "{found:?}");
    // An edge less.
    let mut evidence = c.quantities.evidence.clone();
    evidence.pairs[0].1.roles.pop();
    assert!(matches!(c.certificate.prove_forces(&evidence), Err(WrongPair::Differs { .. })));
    // Contact holds w along an axis alone, not where its direction turns away from one.
    let roles = &c.certificate.edges;
    let holds = |e: &usize| {
        matches!(roles[*e].role, Role::Contact { .. })
            && matches!(c.quantities.evidence.pairs[0].1.roles[*e], Role::Held(..))
    };
    let held = (0..roles.len()).find(holds).unwrap();
    let mut turned = c.certificate.clone();
    if let Role::Contact { along, pressure, gap, .. } = &mut turned.edges[held].role {
        (*along, *pressure) = (Some([[0.0, -1.0], [1e-9, -1.0]]), [pressure[0]; 2]);
        *gap = gap.map(|gap| gap + 1e-6);
    }
    let found = turned.prove_forces(&c.quantities.evidence);
    assert!(matches!(found, Err(WrongPair::Differs { what: "edge", .. })), "{found:?}");
    // A w that is not 0 where the body is held.
    let mut evidence = c.quantities.evidence.clone();
    let held = c.certificate.edges.iter().find(|edge| matches!(edge.role, Role::Held(..))).unwrap();
    evidence.pairs[0].1.w.vertices[held.ends[0]][1] = 1e-9;
    assert!(matches!(c.certificate.prove_forces(&evidence), Err(WrongPair::Rejected(_))));
}

#[test]
#[ignore = "a minute: run by .ci/run"]
fn adapted_to_a_fifth_of_a_per_cent_the_force_is_known_to_four_fifths_of_that() {
    let target = Target { relative: 0.002, max_unknowns: 20_000 };
    let method = Method { degree: Degree::Two, ..Method::default() };
    let (_, adapted) =
        adapt(tilted_punch(4), &method, &Settings::default(), target, &|_| {}).unwrap();
    let c = adapted.certified.unwrap();
    let force = interval(&c, Name::ContactForce, "bottom");
    let bound = 100.0 * adapted.levels.last().unwrap().relative;
    eprintln!("{:?} {force:?} +-{} %", adapted.levels.last(), half_width(force));
    assert!(c.rigorous && force[0] <= FORCE && FORCE <= force[1], "{force:?}");
    assert!(bound <= 0.2 && half_width(force) <= 0.8 * bound, "{} %, {bound} %", half_width(force));
}

#[test]
#[ignore = "a minute: run by .ci/run"]
fn adapted_to_the_force_it_is_known_to_a_fiftieth_of_a_per_cent_with_ten_thousand_unknowns() {
    let target = Target { relative: 0.000_2, max_unknowns: 10_000 };
    let method = Method { degree: Degree::Two, ..Method::default() };
    let goal = (target, Some("bottom"));
    let how = (&method, &Settings::default());
    let (_, adapted) = adapt_to(tilted_punch(4), how, goal, &Asked::default(), &|_| {}).unwrap();
    for level in &adapted.levels {
        eprintln!("{level:?}");
    }
    let c = adapted.certified.unwrap();
    let force = interval(&c, Name::ContactForce, "bottom");
    eprintln!("{force:?} +-{} %", half_width(force));
    assert!(c.rigorous && force[0] <= FORCE && FORCE <= force[1], "{force:?}");
    assert!(adapted.unmet.is_none() && half_width(force) <= 0.02, "{} %", half_width(force));
    assert!(adapted.levels.iter().all(|level| level.unknowns <= 10_000));
    // The level that is given is the one with the nearest numbers.
    let within = |level: &adapt::AdaptedLevel| level.force.unwrap();
    let best = adapted.levels.iter().map(within).fold(f64::INFINITY, f64::min);
    assert_eq!(within(&adapted.levels[adapted.level]), best);
    // Control: to first order it is not.
    let evidence = Evidence { pairs: Vec::new(), ..c.quantities.evidence };
    let first = c.certificate.prove_forces(&evidence).unwrap();
    let whole = |(target, _): &(forces::ForceTarget, _)| target.motion == Motion::Along(None);
    let k = evidence.liftings.iter().position(whole).unwrap();
    assert!(half_width(first[k].clone().unwrap()) > 0.05);
}

#[test]
fn a_level_says_half_the_width_of_its_force_over_the_middle() {
    let target = Target { relative: 1e-4, max_unknowns: 200 };
    let how = (&Method::default(), &Settings::default());
    let goal = (target, Some("bottom"));
    let (_, adapted) = adapt_to(tilted_punch(4), how, goal, &Asked::default(), &|_| {}).unwrap();
    let [low, high] = interval(&adapted.certified.unwrap(), Name::ContactForce, "bottom");
    let middle = low / 2.0 + high / 2.0;
    let said = adapted.levels[adapted.level].force.unwrap();
    // Three roundings.
    assert_relative_eq!(said, (high - middle) / middle, max_relative = 1e-12);
}

#[test]
fn components_of_a_force_along_an_axis_have_the_sign_that_the_obstacle_pushes_with() {
    // The obstacle is below, then above: its force on the body points away from it.
    for (side, other, sign) in [("bottom", "top", 1.0), ("top", "bottom", -1.0)] {
        let pushed = ["0".to_owned(), format!("{sign} * (0.15*x - 0.2)")];
        let pushed = pushed.map(|u| Some(expression(&u)));
        let problem = Problem::of(unit_square(8).mesh().unwrap(), unit_material());
        let problem = Problem { body_force: [expression("0"), expression("0")], ..problem }
            .with(other, Condition::Displacement(pushed))
            .with(side, Condition::Contact { gap: expression("0") });
        let c = certified(&problem, Degree::One);
        let force = interval(&c, Name::ContactForce, side);
        let along = interval(&c, Name::ContactComponent(1), side);
        assert_eq!(interval(&c, Name::ContactComponent(0), side), [0.0; 2]);
        let expected = if sign > 0.0 { force } else { [-force[1], -force[0]] };
        assert_eq!(along, expected);
        // Control: there is a force, on the side of its interval.
        let of = |q: &&signorini::certificates::quantities::Quantity| {
            q.name == Name::ContactComponent(1)
        };
        let value = c.quantities.list.iter().find(of).unwrap().value;
        assert!(force[0] > 0.0 && along[0] <= value && value <= along[1], "{along:?} {value}");
    }
}

#[test]
fn no_more_contact_and_no_more_opening_than_the_zones_say() {
    let fine = solved(&tilted_punch(64), Degree::Two);
    for n in [8, 16, 32] {
        let c = certified(&tilted_punch(n), Degree::One);
        let mut limits = [0, 0];
        for zone in &c.quantities.zones {
            let within =
                fine.contact.iter().flat_map(|edge| edge.points.windows(2)).filter(|pair| {
                    let middle = (pair[0].arc + pair[1].arc) / 2.0;
                    zone.from < middle && middle < zone.to
                });
            let sum = |of: &dyn Fn(usize, &[_]) -> f64| {
                within.clone().fold(0.0, |sum, pair: &[signorini::results::ContactPoint]| {
                    sum + (of(0, pair) + of(1, pair)) / 2.0 * (pair[1].arc - pair[0].arc)
                })
            };
            let (found, most) = match zone.limit {
                Limit::Force(most) => {
                    limits[0] += 1;
                    (sum(&|k, p: &[signorini::results::ContactPoint]| -p[k].lambda), most)
                }
                Limit::Slip(_) => panic!("there is no friction"),
                Limit::Opening(most) => {
                    limits[1] += 1;
                    (sum(&|k, p| (p[k].gap - p[k].u_n).max(0.0)), most)
                }
            };
            assert!(found <= most, "n = {n}: {found} in {zone:?}");
        }
        // On 8 cells the bound of the opening is as large as what the boundary is bent by.
        assert!(limits[0] > 0 && (n == 8 || limits[1] > 0), "n = {n}: zones of both kinds");
    }
    // Nearly nothing of the force beyond three quarters.
    let c = certified(&tilted_punch(32), Degree::One);
    let beyond =
        c.quantities.zones.iter().find(|zone| zone.from <= 0.79 && zone.to == 1.0).unwrap();
    assert!(matches!(beyond.limit, Limit::Force(most) if most <= 0.006 * FORCE), "{beyond:?}");
}

/// A bar that its own weight presses on the floor with its far part only, body and floor moved by 1.
const MOVED: &str = r#"
mesh.rectangle = { width = 5, height = 1, nx = 4, ny = 1 }
material = { lambda = 1, mu = 1 }
load.body = ["0", "-0.01"]
boundary.left.displacement = ["-0.02*y", "-1"]
boundary.bottom.contact = { gap = "1" }
"#;

#[test]
fn what_tells_of_an_opening_does_not_depend_on_where_the_body_is_moved() {
    let openings = |text: &str| {
        let case = crate::common::case_of(text, &[]);
        let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
        let c = certify(&case.problem, &solution).unwrap();
        let all = c.quantities.zones.into_iter();
        all.filter(|zone| matches!(zone.limit, Limit::Opening(_))).count()
    };
    let at_rest = MOVED.replacen("\"-1\"", "\"0\"", 1).replacen("gap = \"1\"", "gap = \"0\"", 1);
    // It is open from 0.10 to 0.75: that the integral of the opening is below 0.153 tells nothing.
    assert_eq!([openings(MOVED), openings(&at_rest)], [0, 0]);
    // Control: on a fine mesh it tells.
    let fine = MOVED.replacen("nx = 4, ny = 1", "nx = 80, ny = 16", 1);
    assert!(openings(&fine) > 0);
}

/// Where the end of contact is known in closed form, (b) of docs/theory.md, 10.3, held all around: int min(1, 4 x) |sigma_n|.
const WEIGHTED: f64 = 0.155_228_476_579_77;

fn weighted_force(n: usize, perturbation: Option<Perturbation>, degree: Degree) -> [f64; 2] {
    let kinds = [("bottom", Kind::Contact), ("left", Kind::Displacement)];
    let more = [("right", Kind::Displacement), ("top", Kind::Displacement)];
    let kinds = kinds.into_iter().chain(more).map(|(name, kind)| (name.to_owned(), kind));
    let mesh = Structured::Rectangle(unit_square(n)).mesh(perturbation).unwrap();
    let problem = study::problem(&singular(0.5), mesh, &kinds.collect());
    let weight = Ramp { axis: 0, between: [0.25, 1.0], width: 0.25 };
    let asked = Asked { forces: vec![("bottom".to_owned(), Some(weight))] };
    let c = certify_with(&problem, &solved(&problem, degree), &asked).unwrap();
    // The whole force has no bound: at a corner contact meets a support under pressure, or nearly so.
    let of = |weight| {
        c.quantities.list.iter().find(|q| q.name == Name::ContactForce && q.weight == weight)
    };
    let whole = of(None).unwrap().interval.clone();
    assert!(whole.is_err_and(|why| why.contains("'bottom'")));
    of(Some(weight)).unwrap().interval.clone().unwrap()
}

fn contains_the_weighted_force(n: usize, perturbation: Option<Perturbation>, degree: Degree) {
    let [low, high] = weighted_force(n, perturbation, degree);
    eprintln!("{n} {perturbation:?} {degree:?}: {low} {high}");
    assert!(
        low <= WEIGHTED && WEIGHTED <= high,
        "{n} {perturbation:?} {degree:?}: [{low}, {high}]"
    );
    assert!(high - low < 1.5 * WEIGHTED, "{n} {perturbation:?} {degree:?}: [{low}, {high}]");
}

#[test]
fn a_weighted_force_that_is_known_lies_between_its_numbers() {
    for degree in DEGREES {
        for n in [8, 16] {
            contains_the_weighted_force(n, None, degree);
        }
        for seed in 1..=3 {
            contains_the_weighted_force(12, Some(Perturbation { amount: 0.2, seed }), degree);
        }
    }
}

#[test]
#[ignore = "a minute: run by .ci/run"]
fn a_weighted_force_that_is_known_lies_between_its_numbers_on_many_meshes() {
    for degree in DEGREES {
        for n in [8, 16, 32, 64] {
            contains_the_weighted_force(n, None, degree);
        }
        for seed in 1..=20 {
            contains_the_weighted_force(12, Some(Perturbation { amount: 0.2, seed }), degree);
        }
    }
}

#[test]
fn evidence_that_is_wrong_at_one_vertex_of_the_boundary_is_refused() {
    let problem = tilted_punch(8);
    let c = certified(&problem, Degree::One);
    let evidence = &c.quantities.evidence;
    let as_made = c.certificate.prove_forces(evidence).unwrap();
    assert!(as_made.iter().all(Result::is_ok));
    let vertex =
        |place: [f64; 2]| problem.mesh.vertices().iter().position(|x| *x == place).unwrap();
    let (pressed, held, inside) = (vertex([0.25, 0.0]), vertex([0.5, 1.0]), vertex([0.5, 0.5]));
    for (vertex, component) in [(pressed, 1), (held, 0), (inside, 1)] {
        let mut evidence = evidence.clone();
        // It covers small misses, at a price.
        evidence.cover = None;
        for (_, w) in &mut evidence.liftings {
            w.vertices[vertex][component] += 1e-6;
        }
        let found = c.certificate.prove_forces(&evidence).unwrap();
        for (found, as_made) in found.iter().zip(&as_made) {
            match found {
                Err(WrongLifting::OnContact { .. }) if vertex == pressed => {}
                Err(WrongLifting::OnSupport { .. }) if vertex == held => {}
                // Inside the body w is free.
                Ok(ends) if vertex == inside => {
                    let [low, high] = as_made.clone().unwrap();
                    assert!(ends[0] <= high && low <= ends[1]);
                }
                other => panic!("vertex {vertex}: {other:?}"),
            }
        }
    }
}

#[test]
fn a_bulge_of_w_where_the_body_is_held_is_refused() {
    let c = certified(&tilted_punch(4), Degree::Two);
    let is_held = |edge: &usize| matches!(c.certificate.edges[*edge].role, Role::Held(..));
    let held = (0..c.certificate.edges.len()).find(is_held).unwrap();
    for size in [0.0, 1e-6] {
        let mut evidence = c.quantities.evidence.clone();
        assert!(!evidence.liftings.is_empty());
        for (_, w) in &mut evidence.liftings {
            w.beyond.as_mut().unwrap()[1][held][0] += size;
        }
        for found in c.certificate.prove_forces(&evidence).unwrap() {
            let is_refused = matches!(found, Err(WrongLifting::OnSupport { edge }) if edge == held);
            assert!(if size == 0.0 { found.is_ok() } else { is_refused }, "{size}: {found:?}");
        }
    }
}

#[test]
fn the_checker_reports_the_intervals_that_were_proved() {
    for degree in DEGREES {
        let c = certified(&tilted_punch(4), degree);
        let (header, bytes) = encoded(&c);
        let audit = signorini::certificates::format::audit(header, &bytes).unwrap();
        let mut signs = [0, 0];
        for force in audit.forces() {
            let is = |q: &&signorini::certificates::quantities::Quantity| {
                let name = match q.name {
                    Name::Reaction(k) => ["reaction force x", "reaction force y"][k],
                    name => match name {
                        Name::ContactForce => "contact force",
                        Name::ContactMoment => "contact moment",
                        Name::ReactionMoment => "reaction moment",
                        _ => "another one",
                    },
                };
                force.name == format!("{name} of {:?}", q.boundary)
            };
            let quantity = c.quantities.list.iter().find(is).unwrap();
            assert_eq!(Ok(force.between), quantity.interval, "{}", force.name);
            // Minus an interval would be another one.
            let [low, high] = force.between;
            assert!(low != -high, "{}", force.name);
            signs[usize::from(high < 0.0)] += 1;
        }
        assert!(signs[0] >= 1 && signs[1] >= 1, "{signs:?}");
    }
}

/// The places on Gamma_C, y = 0, where v is known, with g - v_n there: the vertices and the cuts of a v that is affine.
fn gaps_of(certificate: &Certificate) -> Vec<(f64, f64)> {
    let at = |k: usize| (certificate.vertices[k], certificate.displacement[k]);
    let vertices = (0..certificate.vertices.len()).map(at);
    let cuts = certificate.cuts.iter().map(|cut| {
        let [(x, v), (y, w)] = cut.ends.map(at);
        let between = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|c| a[c] + cut.at * (b[c] - a[c]));
        (between(x, y), between(v, w))
    });
    vertices.chain(cuts).filter(|(x, _)| x[1] == 0.0).map(|(x, v)| (x[0], v[1])).collect()
}

/// The edges of Gamma_C with tau_n at their ends.
fn pressures_of(certificate: &Certificate) -> Vec<([f64; 2], [f64; 2])> {
    let at = |k: usize| {
        certificate.vertices.get(k).map_or_else(
            || {
                let cut = certificate.cuts[k - certificate.vertices.len()];
                let [a, b] = cut.ends.map(|end| certificate.vertices[end][0]);
                a + cut.at * (b - a)
            },
            |x| x[0],
        )
    };
    let edges = certificate.edges.iter().filter_map(|edge| match edge.role {
        Role::Contact { pressure, .. } => Some((edge.ends.map(at), pressure)),
        _ => None,
    });
    edges.collect()
}

#[test]
fn limits_of_zones_and_the_peak_are_what_the_theorem_says_of_the_certificate() {
    for n in [8, 16] {
        let c = certified(&tilted_punch(n), Degree::One);
        let square = c.quantities.mean_stress.powi(2);
        let (gaps, pressures) = (gaps_of(&c.certificate), pressures_of(&c.certificate));
        let mut limits = [0, 0];
        let [force, _] = interval(&c, Name::ContactForce, "bottom");
        let (mut peak, mut forgetful) = (force, force);
        for zone in &c.quantities.zones {
            let [from, to] = zone.ends.map(|x| x[0]);
            let (told, least) = match zone.limit {
                Limit::Force(most) => {
                    limits[0] += 1;
                    peak = peak.max((force - most) / (1.0 - (to - from)));
                    forgetful = forgetful.max(force / (1.0 - (to - from)));
                    let inside = gaps.iter().filter(|(x, _)| from <= *x && *x <= to);
                    (most, inside.fold(f64::INFINITY, |least, (_, gap)| least.min(*gap)))
                }
                Limit::Slip(_) => panic!("there is no friction"),
                Limit::Opening(most) => {
                    limits[1] += 1;
                    let inside =
                        pressures.iter().filter(|([a, b], _)| from <= a.min(*b) && a.max(*b) <= to);
                    let least =
                        inside.fold(f64::INFINITY, |least, (_, [p, q])| least.min(-p).min(-q));
                    (most, least)
                }
            };
            // M^2 over the least gap, or over the least pressure: known to the balls in which it is found.
            approx::assert_relative_eq!(told, square / least, max_relative = 1e-9);
        }
        // On eight cells the bound is as large as what the boundary is bent by, and tells of no opening.
        assert!(limits[0] > 0 && (limits[1] > 0 || n == 8), "n = {n}: zones of both kinds");
        let [found, _] = interval(&c, Name::PeakPressure, "bottom");
        approx::assert_relative_eq!(found, peak, max_relative = 1e-9);
        // Control: without what may be elsewhere it would be another number.
        assert!(forgetful > (1.0 + 1e-6) * peak, "n = {n}: {forgetful} {peak}");
    }
}

#[test]
fn zones_are_measured_from_where_their_own_boundary_begins() {
    // The floor runs to the right from (0, 0), the left side down to it from (0, 1); there nothing touches.
    let problem = tilted_punch(8).with("left", Condition::Contact { gap: expression("1") });
    let c = certified(&problem, Degree::One);
    let mut zones = [0, 0];
    for zone in &c.quantities.zones {
        let is_left = zone.ends.iter().all(|x| x[0] == 0.0);
        let along = zone.ends.map(|[x, y]| if is_left { 1.0 - y } else { x });
        approx::assert_abs_diff_eq!(&along[..], &[zone.from, zone.to][..], epsilon = 1e-12);
        zones[usize::from(is_left)] += 1;
    }
    assert!(zones[0] > 0 && zones[1] > 0, "{zones:?}");
}

#[test]
fn a_weight_with_kinks_inside_edges_has_the_force_of_a_uniform_pressure_times_its_integral() {
    let p = 0.25;
    let patch: Exact = Arc::new(Patch::compression(unit_material(), p));
    for degree in DEGREES {
        for n in [4, 5, 7] {
            let kinds = [("top", Kind::Displacement), ("bottom", Kind::Contact)];
            let sides = [("left", Kind::Traction), ("right", Kind::Traction)];
            let kinds = kinds.into_iter().chain(sides).map(|(name, kind)| (name.to_owned(), kind));
            let problem = study::problem(&patch, unit_square(n).mesh().unwrap(), &kinds.collect());
            let weight = Ramp { axis: 0, between: [0.31, 0.62], width: 0.17 };
            let asked = Asked { forces: vec![("bottom".to_owned(), Some(weight))] };
            let c = certify_with(&problem, &solved(&problem, degree), &asked).unwrap();
            let of = |q: &&_| {
                let q: &signorini::certificates::quantities::Quantity = q;
                q.name == Name::ContactForce && q.weight == Some(weight)
            };
            let quantity = c.quantities.list.iter().find(of).unwrap();
            let [low, high] = quantity.interval.clone().unwrap();
            let force = p * (0.31 + 0.17);
            assert!(low <= force && force <= high, "{degree:?}, n = {n}: [{low}, {high}], {force}");
            // What w misses between the vertices is less than the force.
            assert!(high - low < 2.0 * force, "{degree:?}, n = {n}: [{low}, {high}]");
            // Control: the weight that is straight between the vertices has another force, which is not in the middle.
            let nodes: Vec<f64> =
                (0..=n).map(|k| weight.at(Ball::point(k as f64 / n as f64)).centre()).collect();
            let straight: f64 =
                nodes.windows(2).map(|w| (w[0] + w[1]) / 2.0 / n as f64).sum::<f64>() * p;
            assert!((straight - force).abs() > 1e-4, "n = {n}: {straight} {force}");
        }
    }
}

#[test]
fn the_value_beside_the_interval_of_a_weighted_force_is_that_of_the_discrete_pressure() {
    let problem = tilted_punch(16);
    let weight = Ramp { axis: 0, between: [0.25, 1.0], width: 0.25 };
    let asked = Asked { forces: vec![("bottom".to_owned(), Some(weight))] };
    for degree in DEGREES {
        let solution = solved(&problem, degree);
        let c = certify_with(&problem, &solution, &asked).unwrap();
        let of = |q: &&_| {
            let q: &signorini::certificates::quantities::Quantity = q;
            q.name == Name::ContactForce && q.weight == Some(weight)
        };
        let value = c.quantities.list.iter().find(of).unwrap().value;
        // Straight between the nodes.
        let mut expected = 0.0;
        for edge in &solution.contact {
            for pair in edge.points.windows(2) {
                let [a, b] = [0, 1].map(|k| {
                    let x = pair[k].place[0];
                    -pair[k].lambda * (4.0 * x).min(1.0)
                });
                expected += (a + b) / 2.0 * (pair[1].arc - pair[0].arc);
            }
        }
        approx::assert_relative_eq!(value, expected, max_relative = 1e-12);
        // Control: with the pressure of one end it is another number.
        let of_the_start: f64 = (solution.contact.iter())
            .flat_map(|edge| edge.points.windows(2))
            .map(|pair| {
                let [a, b] = [0, 1].map(|k| (4.0 * pair[k].place[0]).min(1.0));
                -pair[0].lambda * (a + b) / 2.0 * (pair[1].arc - pair[0].arc)
            })
            .sum();
        assert!((of_the_start - expected).abs() > 1e-3 * expected, "{of_the_start} {expected}");
    }
}
