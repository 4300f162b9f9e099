//! Units do not matter: a body whose lengths, moduli and loads are multiplied by powers of two has the same solution, bit for
//! bit, in its own units; where its numbers leave the range of doubles, the solver says that.

use std::collections::BTreeMap;

use signorini::fem::{Condition, Diagonal, Problem, Rectangle};
use signorini::kernel::{Material, Plane};
use signorini::solve::{Degree, Method, Settings, Solution, SolveError, solve};

use crate::common::constant;

/// A block on the floor, half a cell above it, its upper side moved down; 2^length long, of moduli 2^modulus.
fn block(length: i32, modulus: i32) -> Problem {
    let (l, e) = (2.0_f64.powi(length), 2.0_f64.powi(modulus));
    let mesh = Rectangle { width: l, height: l, nx: 8, ny: 8, diagonal: Diagonal::Right };
    let moved = Condition::Displacement([Some(constant(0.0)), Some(constant(-0.05 * l))]);
    Problem::new(
        mesh.mesh().unwrap(),
        Material::lame(e, e, Plane::Strain),
        [constant(0.0), constant(-e / l)],
        BTreeMap::from([
            ("top".to_owned(), moved),
            ("bottom".to_owned(), Condition::Contact { gap: constant(l / 32.0) }),
        ]),
    )
}

fn solved(degree: Degree, length: i32, modulus: i32) -> Result<Solution, SolveError> {
    let method = Method { degree, ..Method::default() };
    solve(&block(length, modulus), &method, &Settings::default()).map(|solved| solved.0)
}

/// Displacements over lengths, pressures over moduli, residuals.
fn in_its_units(solution: &Solution, length: i32, modulus: i32) -> Vec<f64> {
    let (l, e) = (2.0_f64.powi(-length), 2.0_f64.powi(-modulus));
    let displacements = solution.displacement.as_flattened().iter().map(|u| u * l);
    let q = &solution.quantities;
    let others = [q.max_displacement * l, q.contact_force * l * e, q.peak_pressure * e];
    let energies = [q.energy * l * l * e, q.work * l * l * e];
    let relative = solution.newton.residuals.iter().copied();
    displacements.chain(others).chain(energies).chain(relative).collect()
}

#[test]
fn powers_of_two_scale_the_solution_to_the_bit() {
    for degree in [Degree::One, Degree::Two] {
        let one = solved(degree, 0, 0).unwrap();
        let enclosed = one.enclosure.as_ref().unwrap().relative;
        for (length, modulus) in
            [(1, 0), (40, -30), (-100, 60), (200, 0), (-200, 0), (0, 300), (0, -300), (150, 150)]
        {
            let other = solved(degree, length, modulus).unwrap();
            let same = in_its_units(&other, length, modulus) == in_its_units(&one, 0, 0);
            assert!(same, "{degree:?}, lengths 2^{length}, moduli 2^{modulus}");
            assert_eq!(other.enclosure.unwrap().relative, enclosed);
        }
    }
}

#[test]
fn control_a_factor_that_is_no_power_of_two_changes_bits() {
    let one = solved(Degree::One, 0, 0).unwrap();
    let mut problem = block(0, 0);
    problem.body_force = [constant(0.0), constant(-1.0 - f64::EPSILON)];
    let other = solve(&problem, &Method::default(), &Settings::default()).unwrap().0;
    assert!(in_its_units(&other, 0, 0) != in_its_units(&one, 0, 0));
}

/// Up to 1e+-150 in lengths, in moduli, or in both.
#[test]
fn extreme_units_give_the_same_solution_or_say_that_they_are_out_of_range() {
    for degree in [Degree::One, Degree::Two] {
        let one = in_its_units(&solved(degree, 0, 0).unwrap(), 0, 0);
        let largest = one.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut refused = 0;
        for length in [-498, -300, 0, 300, 498] {
            for modulus in [-498, -300, 0, 300, 498] {
                match solved(degree, length, modulus) {
                    Err(SolveError::OutOfRange) => refused += 1,
                    Err(error) => panic!("2^{length}, 2^{modulus}: {error}"),
                    Ok(other) => {
                        // All but the residuals, which are rounding.
                        let values = in_its_units(&other, length, modulus);
                        let count =
                            one.len() - solved(degree, 0, 0).unwrap().newton.residuals.len();
                        for (a, b) in one.iter().zip(&values).take(count) {
                            let off = (a - b).abs();
                            assert!(off <= 1e-12 * largest, "2^{length}, 2^{modulus}: {a} {b}");
                        }
                    }
                }
            }
        }
        assert!(0 < refused && refused < 20, "{refused} of 25 refused");
    }
}
