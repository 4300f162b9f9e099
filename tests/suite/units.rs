//! Units do not matter: a body whose lengths, moduli and data are multiplied by powers of two has the same solution, bit for
//! bit, in its own units; where its numbers leave the range of doubles, the solver says that.

use std::collections::BTreeMap;

use signorini::fem::{Condition, Diagonal, Obstacle, Problem, Rectangle, Side};
use signorini::kernel::{Material, Plane};
use signorini::solve::{
    Course, Degree, Gamma0, Method, Settings, Solution, SolveError, check, solve, solve_along,
};

use crate::common::constant;

/// Binary logarithms of what lengths, moduli, and displacements beside lengths are multiplied by.
#[derive(Clone, Copy, Debug)]
struct Scale {
    length: i32,
    modulus: i32,
    data: i32,
}

const ONE: Scale = Scale { length: 0, modulus: 0, data: 0 };

impl Scale {
    fn displacement(self) -> i32 {
        self.length + self.data
    }

    fn stress(self) -> i32 {
        self.modulus + self.data
    }

    fn force(self) -> i32 {
        self.stress() + self.length
    }

    fn energy(self) -> i32 {
        self.force() + self.displacement()
    }

    fn method(self, degree: Degree, gamma0: Gamma0) -> Method {
        let gamma0 = match gamma0 {
            Gamma0::Value(gamma0) => Gamma0::Value(gamma0 * times(-self.modulus)),
            other => other,
        };
        Method { degree, gamma0, ..Method::default() }
    }
}

fn times(exponent: i32) -> f64 {
    2.0_f64.powi(exponent)
}

/// A block above the floor, its upper side moved down, sheared on the right, and where data have the size of lengths, with a
/// pin at its left side, whose gap is one.
fn block(scale: Scale) -> Problem {
    let (l, e) = (times(scale.length), times(scale.modulus));
    let (u, s) = (times(scale.displacement()), times(scale.stress()));
    let mesh = Rectangle { width: l, height: l, nx: 8, ny: 8, diagonal: Diagonal::Right };
    let moved = Condition::Displacement([Some(constant(0.0)), Some(constant(-0.05 * u))]);
    let shear = Condition::Traction([constant(0.0), constant(0.01 * s)]);
    let mut conditions = BTreeMap::from([
        ("top".to_owned(), moved),
        ("right".to_owned(), shear),
        ("bottom".to_owned(), Condition::Contact { gap: constant(u / 32.0) }),
    ]);
    if scale.data == 0 {
        let (center, radius) = ([-2.0 * l, 0.5 * l], 2.0 * l);
        let pin = Obstacle::Circle { center, radius, side: Side::Outside };
        conditions.insert("left".to_owned(), Condition::Obstacle("pin".to_owned(), pin));
    }
    let force = [constant(-0.1 * s / l), constant(-s / l)];
    Problem::new(mesh.mesh().unwrap(), Material::lame(e, e, Plane::Strain), force, conditions)
}

fn solved(scale: Scale, degree: Degree, gamma0: Gamma0) -> Result<Solution, SolveError> {
    let method = scale.method(degree, gamma0);
    solve(&block(scale), &method, &Settings::default()).map(|solved| solved.0)
}

/// What is reported of it, each number by its unit, and what has none.
fn in_its_units(solution: &Solution, scale: Scale) -> Vec<f64> {
    let mut all: Vec<f64> = Vec::new();
    let mut add = |exponent: i32, values: &[f64]| {
        all.extend(
            values.iter().map(|v| v * times(-exponent / 2) * times(exponent / 2 - exponent)),
        );
    };
    let q = &solution.quantities;
    add(scale.length, solution.nodes.as_flattened());
    add(scale.displacement(), solution.displacement.as_flattened());
    add(scale.displacement(), &[q.max_displacement]);
    add(scale.stress(), &solution.von_mises);
    add(scale.force(), &[q.contact_force, q.contact_resultant[0], q.reactions["top"][1]]);
    add(scale.force() + scale.length, &[q.reaction_moments["top"]]);
    add(scale.energy(), &[q.energy, q.work, solution.balance.contact]);
    add(scale.data, &[solution.largest_strain]);
    add(-scale.modulus, &[solution.gamma.gamma0]);
    add(scale.modulus, &[solution.gamma.coercivity.constant]);
    for boundary in &solution.boundaries {
        add(scale.length, &[boundary.length, boundary.peak_at[0], boundary.peak_at[1]]);
        add(scale.stress(), &[boundary.peak_pressure]);
        add(scale.displacement(), &[boundary.penetration]);
    }
    for point in solution.contact.iter().flat_map(|edge| &edge.points) {
        add(scale.length, &[point.arc]);
        add(scale.displacement(), &[point.u_n, point.gap]);
        add(scale.stress(), &[point.sigma_n, point.lambda, point.pressure]);
    }
    let enclosure = solution.enclosure.as_ref().unwrap();
    add(scale.energy(), &enclosure.intervals.energy);
    add(scale.displacement(), &enclosure.nodes);
    add(0, &[enclosure.kappa, enclosure.relative.unwrap()]);
    add(0, &solution.newton.residuals);
    add(0, &[solution.method.forward_error, solution.method.condition]);
    all
}

/// Bodies as [`block`] scales them, all with the bits of the one for [`ONE`], or refused because energies are no doubles.
fn same_bits_or_out_of_range(one: Scale, scales: &[Scale], degree: Degree, gamma0: Gamma0) {
    let bits = in_its_units(&solved(one, degree, gamma0).unwrap(), one);
    let mut refused = 0;
    for &scale in scales {
        match solved(scale, degree, gamma0) {
            Ok(other) => {
                let found = in_its_units(&other, scale);
                let off = found.iter().zip(&bits).position(|(a, b)| a != b);
                let off = off.map(|i| (i, found[i], bits[i]));
                assert!(
                    off.is_none() && found.len() == bits.len(),
                    "{degree:?}, {scale:?}: {off:?}"
                );
            }
            Err(SolveError::OutOfRange) => {
                assert!(scale.energy().abs() > 1000, "{degree:?}, {scale:?}");
                refused += 1;
            }
            Err(error) => panic!("{degree:?}, {scale:?}: {error}"),
        }
    }
    assert!(0 < refused && 2 * refused < scales.len(), "{refused} of {} refused", scales.len());
}

const CHOICES: [(Degree, Gamma0); 3] = [
    (Degree::One, Gamma0::Auto),
    (Degree::Two, Gamma0::Value(0.01)),
    (Degree::Two, Gamma0::Local(0.3)),
];

/// 2^498 is 1e150.
const FAR: i32 = 498;

#[test]
fn lengths_and_moduli_from_1e_minus_150_to_1e150_scale_the_solution_to_the_bit() {
    for (degree, gamma0) in CHOICES {
        let moduli = [-FAR, -60, 0, 301, FAR];
        let of_length = |length| moduli.map(|modulus| Scale { length, modulus, data: 0 });
        let scales = [-FAR, -301, 0, 40, FAR].map(of_length);
        same_bits_or_out_of_range(ONE, scales.as_flattened(), degree, gamma0);
    }
}

#[test]
fn loads_from_1e_minus_150_to_1e150_scale_the_solution_to_the_bit() {
    for (degree, gamma0) in CHOICES {
        // Without the pin, whose gap is a length.
        let data = [-FAR, -60, 1, 301, FAR];
        let of_length = |length| data.map(|data| Scale { length, modulus: 7, data });
        let scales = [-200, 0, 301].map(of_length);
        let one = Scale { data: 1, ..ONE };
        same_bits_or_out_of_range(one, scales.as_flattened(), degree, gamma0);
    }
}

#[test]
fn control_a_factor_that_is_no_power_of_two_changes_bits() {
    let one = solved(ONE, Degree::One, Gamma0::Auto).unwrap();
    let mut problem = block(ONE);
    problem.body_force = [constant(-0.1), constant(-1.0 - f64::EPSILON)];
    let other = solve(&problem, &Method::default(), &Settings::default()).unwrap().0;
    assert!(in_its_units(&other, ONE) != in_its_units(&one, ONE));
}

#[test]
fn the_outline_and_a_start_have_the_units_of_the_case() {
    let scale = Scale { length: -FAR, modulus: 301, data: 0 };
    let method = scale.method(Degree::Two, Gamma0::Auto);
    let solution = solved(scale, Degree::Two, Gamma0::Auto).unwrap();
    let outline = check(&block(scale), &method).unwrap();
    assert_eq!(outline.gamma.gamma0, solution.gamma.gamma0);
    assert_eq!(outline.gamma.coercivity, solution.gamma.coercivity);
    for start in [
        Course::default().from(&solution),
        Course::default().from_displacement(&solution.displacement),
    ] {
        let (again, _) = solve_along(&block(scale), &method, &Settings::default(), start).unwrap();
        let [steps, from_start] = [&solution, &again].map(|s| s.newton.iterations());
        assert!(from_start < steps, "{from_start} steps from the solution, {steps} without");
    }
}

#[test]
fn what_is_wrong_is_told_in_the_units_of_the_case() {
    let far = Scale { length: 7, modulus: 20, data: 0 };
    let mut loose = block(far);
    loose.conditions.remove("top");
    loose.conditions.remove("left");
    let message = check(&loose, &Method::default()).unwrap_err().to_string();
    assert!(message.contains("(64, 64)"), "{message}");
    let strong = Method { gamma0: Gamma0::Value(1.0), ..Method::default() };
    let message = check(&block(far), &strong).unwrap_err().to_string();
    assert!(message.contains("gamma0 = 1 gives kappa"), "{message}");
    assert!(message.contains("(0, 16)"), "{message}");
}
