//! Certificates of bodies that are held along a direction alone, at any angle, and of tractions beside what is prescribed: a body
//! that is turned has the bound of the body as it stands, an exact solution stays below its bound whichever of its data are
//! prescribed, and what is changed is rejected.

use crate::certify::accepts;
use crate::common::exact::{on_square, singular, smooth};
use crate::common::*;
use approx::abs_diff_eq;
use signorini::certificates::proof::Role;
use signorini::certificates::{Continuous, certify};
use signorini::exact::Kind;
use signorini::io::certificate;
use signorini::model::Degree;
use signorini::model::{Condition, Mesh, Problem, SharedFunction};
use signorini::results::Solution;
use signorini::solve::{Settings, solve};
use study::Ladder;

/// A block on a roller at its left side, fixed at its top by its normal and its tangent, pressed on a floor that slopes; turned
/// by an angle. The displacement along the normal of the roller is `on_roller` of X and Y, the coordinates of the block as it
/// stands.
pub fn turned_block(n: usize, angle: f64, on_roller: &str) -> Problem {
    let (sin, cos) = f64::sin_cos(angle);
    let [own_x, own_y] = [format!("({cos:?}*x + {sin:?}*y)"), format!("({cos:?}*y - {sin:?}*x)")];
    let own = |text: &str| expression(&text.replace('X', &own_x).replace('Y', &own_y));
    let [fx, fy] = ["0.8", "(-1 - X)"];
    Problem::new(
        moved_to(&unit_square(n).mesh().unwrap(), |x| turned(angle, x)),
        unit_material(),
        [
            own(&format!("{cos:?}*{fx} - {sin:?}*{fy}")),
            own(&format!("{sin:?}*{fx} + {cos:?}*{fy}")),
        ],
        conditions([
            ("top", Condition::Support { normal: Some(own("0.1*X")), tangential: Some(own("0")) }),
            ("left", Condition::Support { normal: Some(own(on_roller)), tangential: None }),
            ("right", Condition::Pressure(own("0.2 + Y"))),
            ("bottom", Condition::Contact { gap: own("0.1 - 0.2*X") }),
        ]),
    )
}

pub fn certified(problem: &Problem, degree: Degree) -> (Solution, Continuous) {
    let (solution, _) = solve(problem, &method(degree, EXACT), &Settings::default()).unwrap();
    let certified = certify(problem, &solution).unwrap();
    (solution, certified)
}

/// That of the solver and of the places, and the margin by which a v that is rounded is kept off an oblique floor.
const ROUNDING: f64 = 1e-7;

const ANGLES: [f64; 4] = [0.3, 0.5 * std::f64::consts::FRAC_PI_2, 2.0, -1.1];

#[test]
fn a_body_that_is_turned_has_the_bound_of_the_body_as_it_stands() {
    for degree in DEGREES {
        let (_, still) = certified(&turned_block(8, 0.0, "0"), degree);
        let has_frames = |c: &Continuous| !c.certificate.frames.is_empty();
        assert!(still.rigorous && !has_frames(&still));
        for angle in ANGLES {
            let (_, turned) = certified(&turned_block(8, angle, "0"), degree);
            assert!(turned.rigorous && has_frames(&turned), "{:?}", turned.reason);
            let apart = (turned.bound / still.bound - 1.0).abs();
            assert!(apart < ROUNDING, "{degree:?}, {angle}: {} {}", turned.bound, still.bound);
            let ([low, high], [l, h]) = (turned.energy.unwrap(), still.energy.unwrap());
            assert!(
                abs_diff_eq!(low, l, epsilon = ROUNDING)
                    && abs_diff_eq!(high, h, epsilon = ROUNDING),
                "{low} {l} {high} {h}"
            );
            let (header, bytes) = encoded(&turned);
            assert_eq!(accepts(&header, &bytes), Ok(()), "{degree:?}, {angle}");
        }
    }
}

/// Of degree 2 v follows it exactly; of degree 1 it costs its oscillation.
#[test]
fn supports_that_are_not_affine_cost_what_they_cost_at_any_angle() {
    let parabola = "0.05*(1 - Y)*Y";
    for degree in DEGREES {
        let (_, still) = certified(&turned_block(8, 0.0, parabola), degree);
        assert_eq!(still.rigorous, degree == Degree::Two, "{:?}", still.reason);
        assert_eq!(still.certificate.lift() > 0.0, degree == Degree::One);
        for angle in ANGLES {
            // A product of two affine functions of x and y, not expanded, is known to be of degree 2.
            let (_, turned) = certified(&turned_block(8, angle, parabola), degree);
            assert_eq!((turned.rigorous, &turned.reason), (still.rigorous, &still.reason));
            let apart = (turned.bound / still.bound - 1.0).abs();
            assert!(apart < ROUNDING, "{degree:?}, {angle}: {} {}", turned.bound, still.bound);
        }
    }
}

/// The exact solution with other conditions on one side, and its error beside the bound.
fn with(
    ladder: &Ladder,
    level: usize,
    side: &str,
    other: impl Fn([SharedFunction; 2], [SharedFunction; 2]) -> Condition,
) -> (Continuous, f64) {
    let mut problem = ladder.problem(level).unwrap();
    let Condition::Displacement([Some(x), Some(y)]) =
        Kind::Displacement.condition(&ladder.solution)
    else {
        unreachable!()
    };
    let Condition::Traction(traction) = Kind::Traction.condition(&ladder.solution) else {
        unreachable!()
    };
    problem.conditions.insert(side.to_owned(), other([x, y], traction));
    let (_, certified) = certified(&problem, ladder.method.degree);
    let v = &certified.displacement;
    let error = error_of(&problem, &ladder.solution, v);
    (certified, error)
}

/// (a) with one component of its displacement on the left, and the traction of the other; either component.
#[test]
fn a_traction_beside_a_prescribed_component_is_certified() {
    for degree in DEGREES {
        let ladder = on_square(&smooth(4.0, 3.0, 1.0 / 3.0), degree, 8);
        for level in 0..2 {
            for held in 0..2 {
                let (certified, error) = with(&ladder, level, "left", |[x, y], traction| {
                    let mut displacement = [Some(x), Some(y)];
                    displacement[1 - held] = None;
                    Condition::Mixed { displacement, traction }
                });
                let ratio = certified.bound / error;
                assert!((1.0..2.0).contains(&ratio), "{degree:?}, {level}, {held}: {ratio}");
                let given = certified.certificate.edges.iter().any(|edge| {
                    matches!(edge.role, Role::Supported { traction, .. } if traction != [0.0; 2])
                });
                let reason = certified.reason.unwrap();
                assert!(given && reason.contains("the traction of 'left'"), "{reason}");
            }
        }
    }
}

/// Control: the bound is one of the problem with that traction. Without it the true solution is another, and the bound of its
/// distance from the old v, by the old stress, is none: the checker finds the stress out of balance.
#[test]
fn control_another_traction_beside_a_support_is_rejected() {
    let problem = with_shear();
    for degree in DEGREES {
        let (_, certified) = certified(&problem, degree);
        assert!(certified.rigorous, "{:?}", certified.reason);
        let (header, bytes) = encoded(&certified);
        let (good, claim) = certificate::decode(&header, &bytes).unwrap();
        assert!(good.audit(&claim).is_ok());
        for change in [0.0, 0.99, 1.0 + 1e-9] {
            let mut other = good.clone();
            for edge in &mut other.edges {
                if let Role::Supported { traction, .. } = &mut edge.role {
                    traction.iter_mut().for_each(|q| *q *= change);
                }
            }
            assert!(other.audit(&claim).is_err(), "{degree:?}: {change}");
        }
    }
}

/// A block between a roller that drags it upwards and a floor.
pub fn with_shear() -> Problem {
    let (zero, one) = (|| expression("0"), |text: &str| Some(expression(text)));
    Problem::new(
        unit_square(4).mesh().unwrap(),
        unit_material(),
        [zero(), expression("-1")],
        conditions([
            ("top", Condition::Displacement([one("0"), one("-0.1*x")])),
            (
                "left",
                Condition::Mixed {
                    displacement: [one("0.01*(1 - y)"), None],
                    traction: [zero(), expression("0.3 + 0.2*y")],
                },
            ),
            ("bottom", Condition::Contact { gap: zero() }),
        ]),
    )
}

/// The potential energy of the solution on a fine mesh is in the interval that a coarse one gives, work of the traction included.
#[test]
fn tractions_beside_supports_are_in_the_potential_energy() {
    let mut before: Option<[f64; 2]> = None;
    for (n, degree) in [(4, Degree::One), (8, Degree::One), (8, Degree::Two), (16, Degree::Two)] {
        let problem = Problem { mesh: unit_square(n).mesh().unwrap(), ..with_shear() };
        let (_, certified) = certified(&problem, degree);
        let [low, high] = certified.energy.unwrap();
        if let Some([l, h]) = before {
            assert!(low.max(l) <= high.min(h) && high - low < 0.7 * (h - l), "{n}: {low} {high}");
        }
        before = Some([low, high]);
    }
}

/// The normal and the tangent of a side along an axis prescribe what its components do: so do those that are not affine.
#[test]
fn supports_that_are_not_affine_have_the_bound_of_the_same_displacement() {
    for degree in DEGREES {
        let ladder = on_square(&singular(1.0 / 3.0), degree, 8);
        // n = (1, 0), t = (0, 1)
        let (support, error) = with(&ladder, 0, "right", |[x, y], _| Condition::Support {
            normal: Some(x),
            tangential: Some(y),
        });
        let (displacement, _) =
            with(&ladder, 0, "right", |[x, y], _| Condition::Displacement([Some(x), Some(y)]));
        let apart = (support.bound / displacement.bound - 1.0).abs();
        assert!(apart < 1e-9, "{degree:?}: {} {}", support.bound, displacement.bound);
        assert!(support.bound > error && support.certificate.lift() > 0.0);
    }
}

/// A file of another version is told by its number, whatever else has changed since.
#[test]
fn a_certificate_of_an_older_format_is_refused_by_its_number() {
    let folder = std::env::temp_dir().join(format!("signorini-format-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let json = folder.join(certificate::FILES[0]);
    std::fs::write(&json, "{\"format\": 6, \"counts\": {\"vertices\": 9}}").unwrap();
    let error = certificate::audit(&json).unwrap_err().to_string();
    assert!(error.contains("of format 6; expected 10"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Two supports that turn by hardly more than coordinates are rounded: where they meet one direction is held, and it is that of one of them.
#[test]
fn supports_that_are_nearly_parallel_have_no_certificate() {
    let certified = |slope: f64| {
        let floor = [[0.0, 0.0], [1.0, 0.0], [2.0, slope]];
        let vertices = floor.into_iter().chain([[2.0, 1.0], [1.0, 1.0], [0.0, 1.0]]).collect();
        let triangles = vec![[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4]];
        let named = [
            ("flat", vec![[0, 1]]),
            ("sloping", vec![[1, 2]]),
            ("right", vec![[2, 3]]),
            ("left", vec![[5, 0]]),
        ];
        let named = named.map(|(name, edges)| (name.to_owned(), edges));
        let mesh = Mesh::new(vertices, triangles, named).unwrap();
        let of = conditions([
            ("flat", Condition::roller()),
            ("sloping", Condition::roller()),
            ("right", Condition::clamped()),
            ("left", Condition::Contact { gap: expression("0") }),
        ]);
        let problem = Problem::new(mesh, unit_material(), ["-0.1", "-1"].map(expression), of);
        let how = method(Degree::One, EXACT);
        let (solution, _) = solve(&problem, &how, &Settings::default()).unwrap();
        certify(&problem, &solution).map(|_| ()).map_err(|error| error.to_string())
    };
    for slope in [1e-9, 1e-12] {
        let error = certified(slope).unwrap_err();
        assert!(error.contains("the support of 'sloping' holds turns"), "{slope}: {error}");
    }
    assert_eq!(certified(0.0), Ok(()), "control: parallel ones");
}
