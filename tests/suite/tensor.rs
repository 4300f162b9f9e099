//! Laws A of (1) that are not isotropic: solutions in closed form, and the same body described in two ways.

use std::sync::Arc;

use approx::{abs_diff_eq, assert_abs_diff_eq, assert_relative_eq};

use crate::common::exact::on_square;
use crate::common::*;
use signorini::certificates::{certify, format};
use signorini::exact::Exact;
use signorini::exact::Smooth;
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::material::{
    Across, Orthotropic, eigenvalues, least_eigenvalue, stable, stable_orthotropic,
};
use signorini::model::{Condition, Diagonal, Mesh, Obstacle, Problem};
use signorini::nalgebra::Matrix2;
use signorini::results::{Solution, Verdict};
use signorini::solve::{Settings, solve};
use study::Ladder;

/// Entries of one size that couple all strains: eigenvalues 2.3, 5.2 and 13.5.
pub const FULL: [f64; 6] = [12.0, 3.0, 2.0, 5.0, -1.0, 2.0];

/// Spruce, in GPa, its fibres at an angle.
pub fn spruce(angle: f64) -> Material<f64> {
    let moduli = Orthotropic { e1: 12.0, e2: 0.6, nu12: 0.4, g12: 0.7, angle, across: None };
    stable_orthotropic(moduli).unwrap()
}

fn solved(problem: &Problem, degree: Degree) -> Solution {
    let (solution, _) = solve(problem, &method(degree, EXACT), &Settings::default()).unwrap();
    assert_eq!(solution.verdict, Verdict::Proved);
    solution
}

/// The difference of the two laws is orthogonal to what no turn changes: of a tensor, C_iijj and C_ijij.
#[test]
fn the_isotropic_law_next_to_a_tensor_has_its_traces_and_those_of_the_turned_tensor() {
    let traces = |m: Material<f64>| {
        let [xx, xy, _, yy, _, shear] = m.stiffness();
        [xx + yy + 2.0 * xy, xx + yy + 2.0 * shear]
    };
    let nearest = |m: Material<f64>| Material::lame(m.lambda(), m.mu(), Plane::Strain);
    for m in [spruce(0.0), spruce(30.0), Material::tensor(FULL, None)] {
        let (nearest, traces_of) = (traces(nearest(m)), traces(m));
        assert_abs_diff_eq!(nearest[0], traces_of[0], epsilon = 1e-14);
        assert_abs_diff_eq!(nearest[1], traces_of[1], epsilon = 1e-14);
    }
    // A dozen operations on numbers of size 1 to 10.
    let [straight, turned] = [spruce(0.0), spruce(30.0)].map(nearest);
    assert_relative_eq!(straight.lambda(), turned.lambda(), max_relative = 1e-13);
    assert_relative_eq!(straight.mu(), turned.mu(), max_relative = 1e-13);
    // Control: the law itself is turned.
    assert!((spruce(0.0).stiffness()[0] - spruce(30.0).stiffness()[0]).abs() > 1.0);
}

/// Solution (a) solves (2) for every tensor with C26 = 0.
#[test]
fn the_rates_of_theorem_3_5_hold_for_a_tensor() {
    let c = [9.0, 2.0, 1.5, 4.0, 0.0, 1.3];
    let material = Material::tensor(c, None);
    let solution: Exact =
        Arc::new(Smooth { material, c: 1.0 / 3.0, k: 4.0, m: 3.0, ap: 16.0, aq: 8.0, gap: vec![] });
    for (degree, rate) in [(Degree::One, 1.0), (Degree::Two, 2.0)] {
        let ladder: Ladder = on_square(&solution, degree, 8);
        let errors = [0, 1, 2].map(|level| {
            let (found, problem, s) = ladder.solve(level).unwrap();
            let certified = certify(&problem, &s).unwrap();
            let energy = found.errors.energy;
            assert!(
                certified.bound >= energy * (1.0 - 1e-9) && certified.bound < 2.5 * energy,
                "{}",
                certified.bound / energy
            );
            energy
        });
        let found = (errors[1] / errors[2]).log2();
        assert!(abs_diff_eq!(found, rate, epsilon = 0.12), "{degree:?}: {found}, {errors:?}");
    }
}

/// A block that is tilted onto a floor, its right half lifting off.
fn tilted(mesh: Mesh, material: Material<f64>) -> Problem {
    let mut problem = block(mesh);
    problem.material = material.into();
    problem
}

/// The same body, turned: mesh, material, obstacle and data.
#[test]
fn a_body_that_is_turned_with_its_fibres_has_the_same_answers() {
    let turn = 25.0_f64;
    let about = move |x: [f64; 2]| turned(turn.to_radians(), x);
    let back = move |x: [f64; 2]| turned(-turn.to_radians(), x);
    let problem = |angle: f64, is_turned: bool| {
        let mesh = unit_square(8).perturbed(0.2, 3).unwrap();
        let force = |[x, _]: [f64; 2]| [0.2, -0.4 + 1.0 * x];
        let mut problem = tilted(mesh, spruce(angle));
        let mut normal = [0.0, 1.0];
        if is_turned {
            problem.mesh = moved_to(&problem.mesh, about);
            normal = about(normal);
        }
        let of = move |c: usize| {
            function(move |x| if is_turned { about(force(back(x)))[c] } else { force(x)[c] })
        };
        problem.body_force = [of(0), of(1)];
        let floor = Obstacle::Plane { point: [0.0, 0.0], normal };
        let contact = Condition::Obstacle("floor".to_owned(), floor);
        problem.conditions.insert("bottom".to_owned(), contact);
        problem
    };
    for degree in DEGREES {
        let straight = solved(&problem(35.0, false), degree);
        let turned = solved(&problem(35.0 + turn, true), degree);
        let numbers = |s: &Solution| {
            let q = &s.quantities;
            [s.gamma.gamma0, q.energy, q.contact_force, q.contact_length, q.peak_pressure]
        };
        for (a, b) in numbers(&straight).into_iter().zip(numbers(&turned)) {
            // Data and mesh are turned with a rounding error each.
            assert_relative_eq!(a, b, max_relative = 1e-10);
        }
        for (a, b) in straight.displacement.iter().zip(&turned.displacement) {
            let a = about(*a);
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-11, "{a:?} {b:?}");
        }
        // Control: the fibres stay where they were.
        let other = solved(&problem(35.0, true), degree);
        assert!((other.quantities.energy / straight.quantities.energy - 1.0).abs() > 1e-3);
    }
}

#[test]
fn certificates_of_tensors_are_written_read_and_accepted_and_a_wrong_law_is_not() {
    let problem = tilted(skewed_square(6, Diagonal::Left), spruce(20.0));
    for degree in DEGREES {
        let s = solved(&problem, degree);
        let certified = certify(&problem, &s).unwrap();
        assert!(certified.relative < 1.0, "{}", certified.relative);
        let encode = |certificate| {
            signorini::certificates::encode(
                "spruce",
                certificate,
                &certified.proof,
                &Default::default(),
            )
        };
        let (header, bytes) = encode(&certified.certificate);
        assert!(header.arrays.iter().any(|array| array.name == "tensors" && array.entries == 1));
        let audit = format::audit(header, &bytes).unwrap();
        assert_eq!(audit.certificate, certified.certificate);
        assert!(audit.proof.bound <= certified.bound * (1.0 + 1e-12));
        // Control: half of one shear modulus is another problem, and a larger bound.
        let mut wrong = certified.certificate.clone();
        let mut c = wrong.pieces[0].material.stiffness();
        c[5] *= 0.5;
        wrong.pieces.iter_mut().for_each(|piece| piece.material = Material::tensor(c, None));
        let (header, bytes) = encode(&wrong);
        assert!(format::audit(header, &bytes).is_err());
        // Control: a law that is not elliptic.
        let mut wrong = certified.certificate.clone();
        wrong.pieces[3].material = Material::tensor([1.0, 2.0, 0.0, 1.0, 0.0, 1.0], None);
        let (header, bytes) = encode(&wrong);
        assert!(format::audit(header, &bytes).unwrap_err().to_string().contains("triangle 3"));
    }
}

#[test]
fn kappa_has_the_normal_stiffness_of_the_tensor_and_an_oblique_obstacle_its_component() {
    let material = Material::tensor(FULL, None);
    let s = solved(&tilted(unit_square(4).mesh().unwrap(), material), Degree::One);
    // C22 of a floor: h |E| / |T| = 2 sqrt 2 on right isosceles triangles.
    assert_relative_eq!(s.gamma.coercivity.constant, 5.0 * 8.0_f64.sqrt(), max_relative = 1e-14);
}

#[test]
fn laws_that_are_not_elliptic_are_refused_with_their_smallest_eigenvalue() {
    // The eigenvalues are 3, -1 and 2.
    let refused = stable(Material::tensor([1.0, 2.0, 0.0, 1.0, 0.0, 1.0], None)).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the smallest eigenvalue of the stiffness [1, 2, 0, 1, 0, 1] is -1; expected an elliptic law: a positive one, at least 1e-10 of the largest"
    );
    for bad in [[0.0; 6], [f64::NAN; 6], [1.0, 0.0, 0.0, 1e-11, 0.0, 1.0], [f64::INFINITY; 6]] {
        assert!(stable(Material::tensor(bad, None)).is_err(), "{bad:?}");
    }
    let moduli = Orthotropic { e1: 1.0, e2: 1.0, nu12: 1.01, g12: 1.0, angle: 10.0, across: None };
    assert!(stable_orthotropic(moduli).unwrap_err().to_string().contains("eigenvalue"));
    // The proved eigenvalue is the computed one, and not above it.
    for material in [Material::tensor(FULL, None), spruce(77.0)] {
        let [least, largest] = eigenvalues(&material);
        let proved = least_eigenvalue(&material);
        assert!(proved <= least && least <= proved * (1.0 + 1e-11) && proved < largest);
    }
}

#[test]
fn orthotropic_moduli_that_are_equal_in_all_directions_are_young_and_poisson() {
    let (young, nu) = (2.5, 0.25);
    let across = Some(Across { e3: young, nu13: nu, nu23: nu });
    for (across, plane) in [(None, Plane::Stress), (across, Plane::Strain)] {
        let g12 = young / (2.0 * (1.0 + nu));
        let moduli = Orthotropic { e1: young, e2: young, nu12: nu, g12, angle: 33.0, across };
        let (found, expected) =
            (stable_orthotropic(moduli).unwrap(), Material::young_poisson(young, nu, plane));
        for (a, b) in found.stiffness().iter().zip(expected.stiffness()) {
            assert!(abs_diff_eq!(*a, b, epsilon = 1e-14), "{plane:?}: {found:?}");
        }
        let stress = expected.stress(signorini::nalgebra::Matrix2::new(0.3, 0.2, -0.7, 0.9));
        let [a, b] = [found, expected].map(|m| m.stress_zz(stress));
        assert_abs_diff_eq!(a, b, epsilon = 1e-15 * 20.0);
    }
}

const WOOD: &str = r#"
[mesh]
rectangle = { width = 1, height = 1, nx = 4, ny = 4 }
[material]
orthotropic = { e1 = 12, e2 = 0.6, nu12 = 0.4, g12 = 0.7, angle = 30 }
plane = "stress"
[boundary.top]
displacement = [0, -0.01]
[boundary.bottom]
contact = {}
"#;

#[test]
fn cases_have_the_materials_that_they_say() {
    let read = |text: &str| case_of(text, &[]);
    let case = read(WOOD);
    assert_eq!(case.problem.material, spruce(30.0).into());
    let stiffness = spruce(30.0).stiffness();
    let orthotropic = WOOD.lines().find(|line| line.starts_with("orthotropic")).unwrap();
    let entries = read(&WOOD.replace(orthotropic, &format!("stiffness = {stiffness:?}")));
    assert_eq!(entries.problem.material, case.problem.material);
    let across = "stiffness = [12, 3, 2, 5, -1, 2]\nacross = [0.3, 0.2, 0.1]";
    let strain = read(&WOOD.replace(orthotropic, across).replace("stress", "strain"));
    let expected = Material::tensor(FULL, Some([0.3, 0.2, 0.1]));
    assert_eq!(strain.problem.material, expected.into());
    // Control: another angle.
    let other = read(&WOOD.replace("angle = 30", "angle = 31"));
    assert_ne!(other.problem.material, case.problem.material);
}

#[test]
fn a_hoop_strain_acts_on_a_tensor_as_its_law_says_and_by_a_symmetric_one() {
    let [c, a, e] = [&[7.0, 2.0, 1.0, 5.0, -1.0, 3.0][..], &[0.25, 0.5, -0.125], &[4.0]];
    let c: [f64; 6] = std::array::from_fn(|k| c[k]);
    let material = Material::tensor(c, Some([a[0], a[1], a[2]])).of_revolution(e[0]);
    // The strains e_rr, e_zz, gamma and that of the hoop, one at a time; the stresses that go with them.
    let columns: [[f64; 4]; 4] = std::array::from_fn(|k| {
        let unit: [f64; 4] = std::array::from_fn(|i| f64::from(u8::from(i == k)));
        let gradient = Matrix2::new(unit[0], unit[2], 0.0, unit[1]);
        let (stress, hoop) = material.stress_of_revolution(gradient, unit[3]);
        let [rr, zz, rz] = stress.components();
        [rr, zz, rz, hoop]
    });
    let [c11, c12, c16, c22, c26, c66] = c;
    let rows = [[c11, c12, c16], [c12, c22, c26], [c16, c26, c66]];
    let of_hoop = rows.map(|row| row[0] * a[0] + row[1] * a[1] + row[2] * a[2]);
    for i in 0..3 {
        assert_eq!(columns[i][..3], rows[i]);
        assert_eq!([columns[3][i], columns[i][3]], [of_hoop[i]; 2]);
    }
    let own: f64 = of_hoop.iter().zip(a).map(|(stress, factor)| stress * factor).sum();
    assert_eq!(columns[3][3], own + e[0]);
}
