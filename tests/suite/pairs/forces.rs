//! Forces between tied and rough bodies: the true ones lie between their numbers, and what is tampered with is refused.

use approx::assert_abs_diff_eq;
use signorini::certificates::forces::{Evidence, Motion, WrongLifting};
use signorini::certificates::proof::Role;
use signorini::certificates::quantities::Name;
use signorini::certificates::{Certificate, Continuous, format};

use super::certified::{certified, held_beside_glue, rough, squares, tied};
use super::*;
use crate::common::{DEGREES, encoded, expression};

const FIRST: &str = "upper.bottom";
const SECOND: &str = "lower.bottom";

fn interval(c: &Continuous, name: Name, boundary: &str) -> [f64; 2] {
    let is = |q: &&signorini::certificates::quantities::Quantity| {
        q.name == name && q.boundary == boundary
    };
    c.quantities.list.iter().find(is).unwrap().interval.clone().unwrap()
}

/// Force along the direction, components and moment on the first body, of a solution on a fine mesh.
fn values(problem: &Problem) -> [(Name, f64); 4] {
    let of = proved(problem, &method(Degree::Two)).boundaries[0].clone();
    let [x, y] = of.resultant;
    [
        (Name::ContactForce, of.force),
        (Name::ContactComponent(0), x),
        (Name::ContactComponent(1), y),
        (Name::ContactMoment, of.moment),
    ]
}

/// The forces lie between their numbers on finer and finer meshes, which come nearer by `rate`; of what is 0 by symmetry they are 0.
fn near_each_other(
    of: &dyn Fn([usize; 2]) -> Problem,
    names: &[Name],
    degree: Degree,
    (rate, most): (f64, f64),
) {
    let true_ones = values(&of([44, 28]));
    let mut last = [f64::INFINITY; 4];
    for cells in [[11, 7], [22, 14]] {
        let c = certified(&of(cells), degree);
        for (&(name, value), last) in true_ones.iter().zip(&mut last) {
            if !names.contains(&name) {
                continue;
            }
            let [low, high] = interval(&c, name, FIRST);
            println!("{degree:?} {cells:?} {name:?}: {low} <= {value} <= {high}");
            // The fine mesh is off, too.
            let off = 0.02 * (high - low);
            assert!(low - off <= value && value <= high + off, "{name:?}");
            assert!((high - low) * rate <= *last, "{name:?} {}", high - low);
            *last = high - low;
            let width = high - low;
            // What holds the second body below has the same forces, but for the place of the moment.
            let same = match name {
                Name::ContactComponent(k) => interval(&c, Name::Reaction(k), SECOND),
                Name::ContactMoment => interval(&c, Name::ReactionMoment, SECOND),
                _ => continue,
            };
            assert!(same[0] - off <= value && value <= same[1] + off, "{name:?} {same:?}");
            // Glue moves with what it holds.
            let is_tied = c
                .certificate
                .edges
                .iter()
                .any(|edge| matches!(edge.role, Role::Contact { law, .. } if law.is_tied()));
            let wider = (same[1] - same[0]) / width;
            println!("    at the floor {wider} times as wide");
            assert!(!is_tied || wider <= 1.5, "{name:?}: {wider}");
        }
        let [low, high] = interval(&c, Name::ContactComponent(1), FIRST);
        let half = (high - low) / 2.0 / true_ones[2].1.abs();
        assert!(cells[0] == 11 || half <= most, "{half}");
    }
}

const ACROSS: [Name; 3] =
    [Name::ContactComponent(0), Name::ContactComponent(1), Name::ContactMoment];

#[test]
fn the_true_force_between_tied_bodies_lies_between_its_numbers() {
    for (degree, rate, most) in [(Degree::One, 1.5, 0.2), (Degree::Two, 1.4, 0.1)] {
        for moduli in [[1.0, 1.0], [1.0, 10.0]] {
            let glued = |cells| tied(cells, moduli, Law::Bonded);
            near_each_other(&glued, &ACROSS, degree, (rate, most));
            let sliding = |cells| tied(cells, moduli, Law::Sliding);
            let names = [Name::ContactForce, Name::ContactComponent(1), Name::ContactMoment];
            near_each_other(&sliding, &names, degree, (rate, most));
        }
    }
    // They pull: the force along the direction is negative.
    let [_, high] = interval(
        &certified(&tied([22, 14], [1.0, 1.0], Law::Sliding), Degree::One),
        Name::ContactForce,
        FIRST,
    );
    assert!(high < 0.0, "{high}");
}

#[test]
fn the_true_force_between_rough_bodies_lies_between_its_numbers() {
    for (degree, rate, most) in [(Degree::One, 1.5, 0.2), (Degree::Two, 1.4, 0.1)] {
        let of = |cells| rough(squares(cells, [1.0, 3.0]).problem());
        let names = [
            Name::ContactForce,
            Name::ContactComponent(0),
            Name::ContactComponent(1),
            Name::ContactMoment,
        ];
        near_each_other(&of, &names, degree, (rate, most));
    }
}

#[test]
fn of_glue_under_a_load_the_force_is_the_load() {
    for degree in DEGREES {
        let load = Condition::Traction(["0.03", "0.02 - 0.1*x"].map(expression));
        let problem = tied([5, 7], [2.0, 1.0], Law::Bonded).with("upper.top", load);
        let c = certified(&problem, degree);
        // On y = 1: the moment about the origin is int x t_y - y t_x.
        let true_ones = [-0.03, -(0.02 - 0.05), -(0.01 - 0.1 / 3.0 - 0.03)];
        for (name, value) in ACROSS.into_iter().zip(true_ones) {
            let [low, high] = interval(&c, name, FIRST);
            assert!(low <= value && value <= high, "{name:?}: {low} {high} {value}");
            assert!(high - low <= 1e-8, "{degree:?} {name:?}: {}", high - low);
        }
    }
}

/// Whether the file of a certificate with this evidence is accepted.
fn accepts(c: &Continuous, change: impl Fn(&mut Evidence)) -> Result<(), String> {
    let mut c = c.clone();
    change(&mut c.quantities.evidence);
    let (header, bytes) = encoded(&c);
    format::audit(header, &bytes).map(|_| ()).map_err(|error| error.to_string())
}

/// An end of an edge of the first body on the second one, if it is a vertex.
fn facing(certificate: &Certificate) -> usize {
    let ends = certificate.facing.iter().filter_map(|(&e, &other)| {
        let first = matches!(certificate.edges[e].role, Role::Contact { .. });
        certificate.edges[other].ends.into_iter().find(|&p| first && p < certificate.vertices.len())
    });
    ends.into_iter().next().unwrap()
}

#[test]
fn forces_beside_tied_bodies_that_are_tampered_with_are_refused() {
    for (law, degree) in
        [Law::Sliding, Law::Bonded].into_iter().flat_map(|law| DEGREES.map(|d| (law, d)))
    {
        let c = certified(&tied([4, 6], [1.0, 2.0], law), degree);
        let evidence = &c.quantities.evidence;
        let there = facing(&c.certificate);
        let place = |motion: Motion| {
            let of = |(target, _): &(signorini::certificates::forces::ForceTarget, _)| {
                target.motion == motion
                    && target.boundary.is_some_and(|b| evidence.names[b] == FIRST)
            };
            evidence.liftings.iter().position(of)
        };
        let moment = place(Motion::Turn).unwrap();
        assert_eq!(accepts(&c, |_| {}), Ok(()));
        // Less than the data give.
        let narrow = accepts(&c, |e| e.between.as_mut().unwrap().liftings[moment][0] += 1e-9);
        assert!(narrow.unwrap_err().contains("it is said to be between"));
        // Another w on the second body is another one on the first, too: it proves something else.
        let moved = accepts(&c, |e| e.liftings[moment].1.vertices[there][1] += 1e-3);
        assert!(moved.unwrap_err().contains("it is said to be between"));
        // Between tied bodies no force along the direction is known with a weight, and along that of glue, which has none, not at all.
        let mut along = evidence.clone();
        let weight = (law == Law::Sliding).then_some(signorini::certificates::forces::Ramp {
            axis: 0,
            between: [0.0, 0.5],
            width: 0.1,
        });
        along.liftings[moment].0.motion = Motion::Along(weight);
        let found = &c.certificate.prove_forces(&along).unwrap()[moment];
        assert!(matches!(found, Err(WrongLifting::Tied { .. })), "{found:?}");
    }
}

#[test]
fn a_point_that_is_held_and_tied_has_one_w() {
    for degree in DEGREES {
        let problem = held_beside_glue();
        let c = certified(&problem, degree);
        // The lower body moves where the upper one is held.
        let [low, high] = interval(&c, Name::ContactComponent(1), FIRST);
        assert!(low < high && high.is_finite());
        // With walls that hold both, no force of the glue alone is bounded.
        let both = |name: &str| ["left", "right"].map(|side| format!("{name}.{side}"));
        let held = both("lower").iter().fold(problem.clone(), |problem, name| {
            problem.with(name, Condition::displacement(|_| 0.0, |_| 0.0))
        });
        let c_held = certified(&held, degree);
        for quantity in c_held.quantities.list.iter().filter(|q| q.boundary == FIRST) {
            let why = quantity.interval.clone().unwrap_err();
            assert!(why.contains("the force of one alone has no bound"), "{why}");
        }
        let [low, high] = interval(&c, Name::Reaction(1), SECOND);
        assert!(low < high && high.is_finite());
        let evidence = &c.quantities.evidence;
        let corner = c.certificate.vertices.iter().enumerate().filter(|(_, x)| **x == [0.0, 0.0]);
        let second = corner.map(|(p, _)| p).max().unwrap();
        let mut moved = evidence.clone();
        moved.liftings.iter_mut().for_each(|(_, w)| w.vertices[second][0] += 1e-12);
        let found = c.certificate.prove_forces(&moved).unwrap();
        let refused = |r: &Result<_, _>| matches!(r, Err(WrongLifting::OnSupport { .. }));
        assert!(!found.is_empty() && found.iter().all(refused), "{found:?}");
    }
}

#[test]
fn forces_beside_friction_that_are_tampered_with_are_refused() {
    for degree in DEGREES {
        let c = certified(&rough(squares([7, 5], [1.0, 3.0]).problem()), degree);
        let evidence = &c.quantities.evidence;
        let of = |(target, _): &(signorini::certificates::forces::ForceTarget, _)| {
            target.motion == Motion::Axis(0)
                && target.boundary.is_some_and(|b| evidence.names[b] == FIRST)
        };
        let shear = evidence.liftings.iter().position(of).unwrap();
        assert_eq!(accepts(&c, |_| {}), Ok(()));
        let narrow = accepts(&c, |e| e.between.as_mut().unwrap().liftings[shear][1] -= 1e-9);
        assert!(narrow.unwrap_err().contains("it is said to be between"));
        // Where it is not asked for, the same w misses by 1 across the direction, and that costs the integral of the bound on either side.
        let width = |e: &Evidence| {
            let [low, high] = c.certificate.prove_forces(e).unwrap()[shear].clone().unwrap();
            high - low
        };
        let mut elsewhere = evidence.clone();
        let far =
            signorini::certificates::forces::Ramp { axis: 0, between: [9.0, 10.0], width: 1.0 };
        elsewhere.liftings[shear].0.motion = Motion::Along(Some(far));
        let price = (width(&elsewhere) - width(evidence)) / 2.0;
        // int 0.005 + 0.014 x over the unit interval.
        assert_abs_diff_eq!(price, 0.012, epsilon = 1e-9);
    }
}
