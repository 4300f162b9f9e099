//! Units do not matter within the range that doubles can multiply: a body whose lengths, moduli and data are multiplied by
//! factors has the same solution, proved as well; beyond that range the solver says so.

use std::collections::BTreeMap;

use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Condition, Diagonal, Obstacle, Problem, Rectangle, Side};
use signorini::results::Solution;
use signorini::solve::{Course, Gamma0, Method, Settings, SolveError, check, solve, solve_along};

use crate::common::{DEGREES, constant};

/// Factors of lengths and moduli, and of displacements and gaps beside lengths.
#[derive(Clone, Copy, Debug)]
struct Scale {
    length: f64,
    modulus: f64,
    data: f64,
}

const ONE: Scale = Scale { length: 1.0, modulus: 1.0, data: 1.0 };

/// A block above the floor, its upper side moved down, sheared on the right, and where data have the size of lengths, with a
/// pin at its left side, whose gap is one.
fn block(scale: Scale) -> Problem {
    let Scale { length: l, modulus: e, data } = scale;
    let (u, s) = (l * data, e * data);
    let mesh = Rectangle { width: l, height: l, nx: 8, ny: 8, diagonal: Diagonal::Right };
    let moved = Condition::displacement(|_| 0.0, move |_| -0.05 * u);
    let shear = Condition::traction(|_| 0.0, move |_| 0.01 * s);
    let mut conditions = BTreeMap::from([
        ("top".to_owned(), moved),
        ("right".to_owned(), shear),
        ("bottom".to_owned(), Condition::contact(move |_| u / 32.0)),
    ]);
    if data == 1.0 {
        let (center, radius) = ([-2.0 * l, 0.5 * l], 2.0 * l);
        let pin = Obstacle::Circle { center, radius, side: Side::Outside };
        conditions.insert("left".to_owned(), Condition::Obstacle("pin".to_owned(), pin));
    }
    let force = [constant(-0.1 * s / l), constant(-s / l)];
    Problem::new(mesh.mesh().unwrap(), Material::lame(e, e, Plane::Strain), force, conditions)
}

fn solved(scale: Scale, method: &Method) -> Result<Solution, SolveError> {
    solve(&block(scale), method, &Settings::default()).map(|solved| solved.0)
}

/// The displacement, the contact force and the energy without their units.
fn without_units(solution: &Solution, scale: Scale) -> Vec<f64> {
    let Scale { length: l, modulus: e, data } = scale;
    let (u, q) = (l * data, &solution.quantities);
    let displacement = solution.displacement.as_flattened().iter().map(|c| c / u);
    displacement.chain([q.contact_force / (e * u), q.energy / (e * u) / u]).collect()
}

/// The largest difference to the body of [`ONE`] (with these data), or `None` where the numbers are out of range. An
/// answer is proved.
fn off(scale: Scale, degree: Degree) -> Option<f64> {
    let method = Method { degree, ..Method::default() };
    let one = Scale { data: if scale.data == 1.0 { 1.0 } else { 0.5 }, ..ONE };
    let expected = without_units(&solved(one, &method).unwrap(), one);
    let solution = match solved(scale, &method) {
        Ok(solution) => solution,
        Err(SolveError::OutOfRange) => return None,
        Err(error) => panic!("{degree:?}, {scale:?}: {error}"),
    };
    let proved = solution.enclosure.as_ref().ok().and_then(|enclosure| enclosure.relative);
    assert!(proved.is_some_and(|relative| relative < 1e-6), "{degree:?}, {scale:?}: {proved:?}");
    let found = without_units(&solution, scale);
    Some(found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
}

#[test]
fn lengths_and_moduli_from_1e_minus_30_to_1e30_have_the_same_solution() {
    for degree in DEGREES {
        for length in [1e-30, 1e-6, 1e3, 1e30] {
            for modulus in [1e-30, 1e12, 1e30] {
                let off = off(Scale { length, modulus, data: 1.0 }, degree);
                assert!(off.is_some_and(|off| off < 1e-12), "{length}, {modulus}: {off:?}");
            }
        }
    }
}

#[test]
fn small_loads_in_si_and_in_mm_and_mpa_have_the_same_solution() {
    for degree in DEGREES {
        for (length, modulus) in [(1e-6, 1e12), (0.1, 2.1e11), (100.0, 2.1e5)] {
            for data in [1e-30, 1e-9, 1e-3] {
                let off = off(Scale { length, modulus, data }, degree);
                assert!(off.is_some_and(|off| off < 1e-12), "{length}, {modulus}, {data}: {off:?}");
            }
        }
    }
}

#[test]
fn numbers_that_doubles_cannot_multiply_are_refused() {
    for degree in DEGREES {
        for (length, modulus, data) in [
            (1e-50, 1.0, 1.0),
            (1e50, 1.0, 1.0),
            (1.0, 1e-90, 1.0),
            (1.0, 1e90, 1.0),
            (1.0, 1.0, 1e-150),
            (1.0, 1.0, 1e150),
        ] {
            let found = off(Scale { length, modulus, data }, degree);
            assert_eq!(found, None, "{length}, {modulus}, {data}");
        }
    }
}

#[test]
fn control_a_load_of_another_size_is_noticed() {
    let one = solved(ONE, &Method::default()).unwrap();
    let mut problem = block(ONE);
    problem.body_force = [constant(-0.1), constant(-1.0 - 1e-10)];
    let other = solve(&problem, &Method::default(), &Settings::default()).unwrap().0;
    let pairs = without_units(&other, ONE).into_iter().zip(without_units(&one, ONE));
    assert!(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > 1e-12);
}

#[test]
fn a_solve_from_a_solution_takes_fewer_steps_in_any_units() {
    let scale = Scale { length: 1e-20, modulus: 1e20, data: 1.0 };
    let method = Method { degree: Degree::Two, ..Method::default() };
    let solution = solved(scale, &method).unwrap();
    let start = Course::default().from_displacement(&solution.displacement);
    let (again, _) = solve_along(&block(scale), &method, &Settings::default(), start).unwrap();
    let [steps, from_start] = [&solution, &again].map(|s| s.newton.iterations());
    assert!(from_start < steps, "{from_start} steps from the solution, {steps} without");
}

#[test]
fn errors_name_places_in_the_units_of_the_case() {
    let far = Scale { length: 128.0, modulus: 1e6, data: 1.0 };
    let mut loose = block(far);
    loose.conditions.remove("top");
    loose.conditions.remove("left");
    let message = check(&loose, &Method::default()).unwrap_err().to_string();
    assert!(message.contains("a force of 12800000;"), "{message}");
    let strong = Method { gamma0: Gamma0::Value(1.0), ..Method::default() };
    let message = check(&block(far), &strong).unwrap_err().to_string();
    assert!(message.contains("gamma0 = 1 gives kappa"), "{message}");
    assert!(message.contains("(0, 16)"), "{message}");
}
