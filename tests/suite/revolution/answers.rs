//! Answers that are known from formulas.

use std::f64::consts::{PI, TAU};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use signorini::contact::contact_line::Coercivity;
use signorini::kernel::{Material, Plane};
use signorini::model::{Condition, Degree, Mesh, Obstacle, Problem, Space};
use signorini::nalgebra::Matrix2;
use signorini::results::Solution;
use signorini::solve::{Gamma0, Method, discretize};

use super::*;

/// Some hundred operations on numbers of size 1, times the condition of these small systems.
const PATCH: f64 = 1e-12;

/// A cylinder that is pressed on the floor, held by nothing else: u_z = -p z / E, u_r = nu p r / E.
fn pressed_cylinder(degree: Degree, material: Material<f64>) -> Solution {
    let floor = Obstacle::Plane { point: [0.0, 0.0], normal: [0.0, 1.0] };
    let problem = Problem::of(meridian([0.0, 1.0], 2.0, [5, 8], true), material)
        .with("bottom", Condition::obstacle("floor", floor))
        .with("top", Condition::pressure(|_| 0.01));
    solved(&problem, degree)
}

#[test]
fn a_cylinder_on_the_floor_is_exact_held_by_contact_alone() {
    for degree in DEGREES {
        let s = pressed_cylinder(degree, elastic(2.0, 0.3));
        for (&[r, z], u) in s.nodes.iter().zip(&s.displacement) {
            let expected = [0.3 * 0.01 * r / 2.0, -0.01 * z / 2.0];
            assert_abs_diff_eq!(u[..], expected[..], epsilon = PATCH);
        }
        // The force of the whole revolution, along the axis.
        assert_relative_eq!(s.quantities.contact_force, 0.01 * PI, max_relative = PATCH);
        let resultant = s.boundaries[0].resultant;
        assert_abs_diff_eq!(resultant[..], [0.0, 0.01 * PI][..], epsilon = PATCH);
        assert_relative_eq!(s.boundaries[0].peak_pressure, 0.01, max_relative = PATCH);
        for (stress, hoop) in &s.stress {
            let [rr, zz, rz] = stress.components();
            assert_abs_diff_eq!(
                [rr, zz, *hoop, rz][..],
                [0.0, -0.01, 0.0, 0.0][..],
                epsilon = PATCH
            );
        }
        let [low, high] = s.enclosure.unwrap().intervals.contact[0].force;
        assert!(low <= 0.01 * PI && 0.01 * PI <= high && high - low < 1e-10);
    }
}

/// The control of the test above: a plate of the same section is no cylinder.
#[test]
fn control_a_plate_widens_otherwise_than_a_cylinder() {
    let floor = Obstacle::Plane { point: [0.0, 0.0], normal: [0.0, 1.0] };
    let problem = Problem::of(
        meridian([0.0, 1.0], 2.0, [5, 8], true),
        Material::young_poisson(2.0, 0.3, Plane::Strain),
    )
    .with("bottom", Condition::obstacle("floor", floor))
    .with("top", Condition::pressure(|_| 0.01))
    .with("left", Condition::roller());
    let s = solved(&problem, Degree::One);
    let widest = s.displacement.iter().map(|u| u[0]).fold(0.0, f64::max);
    assert!((widest - 0.3 * 0.01 / 2.0).abs() > 1e-4);
    assert_relative_eq!(s.quantities.contact_force, 0.01, max_relative = PATCH);
}

#[test]
fn an_orthotropic_cylinder_widens_by_its_own_ratio() {
    use signorini::model::material::{Across, Orthotropic, stable_orthotropic};
    // e1 along r, e2 along z, e3 along the hoop; r and hoop alike, or the axis would be singular.
    let across = Across { e3: 2.0, nu13: 0.4, nu23: 0.15 };
    let moduli =
        Orthotropic { e1: 2.0, e2: 1.0, nu12: 0.3, g12: 0.5, angle: 0.0, across: Some(across) };
    let material = stable_orthotropic(moduli).unwrap().of_revolution(across.e3);
    for degree in DEGREES {
        let s = pressed_cylinder(degree, material);
        for (&[r, z], u) in s.nodes.iter().zip(&s.displacement) {
            // nu_21 = nu_12 e2 / e1 = 0.15 = nu_23.
            let expected = [0.15 * 0.01 * r, -0.01 * z];
            assert_abs_diff_eq!(u[..], expected[..], epsilon = PATCH);
        }
    }
}

/// A tube in a rigid sleeve, u_z = 0 at its ends: u_r = A r + B / r.
pub(super) fn sleeve(n: usize, degree: Degree) -> (f64, [f64; 2]) {
    let (lambda, mu, pressure, gap) = (1.0, 0.8, 0.02, 0.005);
    // A b + B / b = g and 2 (lambda + mu) A - 2 mu B / a^2 = -p for a = 1, b = 2.
    let k = 2.0 * (lambda + mu);
    let b = (pressure + k * gap / 2.0) / (2.0 * mu + k / 4.0);
    let a = gap / 2.0 - b / 4.0;
    let problem = Problem::of(
        meridian([1.0, 2.0], 1.0, [n, n], false),
        Material::lame(lambda, mu, Plane::Axisymmetric),
    )
    .with("left", Condition::pressure(move |_| pressure))
    .with("right", Condition::contact(move |_| gap))
    .with("bottom", flat_roller())
    .with("top", flat_roller());
    let s = solved(&problem, degree);
    let expected = -(k * a - 2.0 * mu * b / 4.0);
    let area = TAU * 2.0;
    let exact = move |[r, _]: [f64; 2]| {
        ([a * r + b / r, 0.0], Matrix2::new(a - b / (r * r), 0.0, 0.0, 0.0), a + b / (r * r))
    };
    assert!(s.boundaries[0].resultant[1].abs() < 1e-12);
    (s.boundaries[0].force / area / expected - 1.0, errors(&problem, &s, &exact))
}

fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).abs().log2()
}

#[test]
fn a_tube_in_a_sleeve_converges_as_it_should() {
    for degree in DEGREES {
        let p = degree.number() as f64;
        let ((_, coarse), (off, fine)) = (sleeve(8, degree), sleeve(16, degree));
        assert_abs_diff_eq!(order(coarse[0], fine[0]), p, epsilon = 0.1);
        assert_abs_diff_eq!(order(coarse[1], fine[1]), p + 1.0, epsilon = 0.1);
        assert!(off.abs() < if p == 1.0 { 1e-3 } else { 1e-5 }, "{off:?}");
    }
}

/// The largest displacement of a hollow ball, 1 to 2, under a pressure of 1 inside over Lame's, of n x 2 n cells in the quarter of the meridian
/// above z = 0, in a rigid shell that it does not reach; the polygon of the mesh is the body.
pub(super) fn hollow_ball(n: usize, degree: Degree) -> f64 {
    let (inner, outer, young, poisson) = (1.0_f64, 2.0_f64, 1e3, 0.3);
    let flat = meridian([inner, outer], 1.0, [n, 2 * n], false);
    let turned = moved_to(&flat, |[radius, turn]| {
        let (sine, cosine) = (turn * PI / 2.0).sin_cos();
        // No r of 1e-17 on the axis.
        [if turn == 1.0 { 0.0 } else { radius * cosine }, radius * sine]
    });
    let problem = Problem::of(turned, elastic(young, poisson))
        .with("left", Condition::pressure(|_| 1.0))
        .with("right", Condition::contact(|_| 1.0))
        .with("bottom", flat_roller());
    let s = solved(&problem, degree);
    let bulk = inner.powi(3) / (young * (outer.powi(3) - inner.powi(3)));
    let exact = (1.0 - 2.0 * poisson) * bulk * inner
        + (1.0 + poisson) * bulk * outer.powi(3) / (2.0 * inner * inner);
    let found = s.displacement.iter().map(|[r, z]| r.hypot(*z)).fold(0.0, f64::max);
    found / exact - 1.0
}

#[test]
fn a_hollow_ball_widens_as_lame_says() {
    for degree in DEGREES {
        let [coarse, fine] = [8, 16].map(|n| hollow_ball(n, degree).abs());
        // The largest is found at the axis, where a value has no weight: less than order 2 for P1.
        assert!(order(coarse, fine) > if degree == Degree::One { 1.4 } else { 0.9 });
        assert!(fine < [1e-2, 1e-4][degree.number() - 1], "{fine:e}");
    }
}

/// The smooth solution with an end of contact at r = c: q = 8 [r - c]+^5, k = 3 [c^2 - r^2]+^3, (lambda + 2 mu) p = -k,
/// u = (-z q', q + z p).
pub(super) fn with_an_end_of_contact(n: usize, degree: Degree) -> (f64, [f64; 2]) {
    const C: f64 = 0.75;
    let (lambda, mu) = (1.0, 1.0);
    let stiffness = lambda + 2.0 * mu;
    // q', q'', q''' and q.
    let q = |r: f64| {
        let d = (r - C).max(0.0);
        [8.0 * d.powi(5), 40.0 * d.powi(4), 160.0 * d.powi(3), 480.0 * d.powi(2)]
    };
    // p, p', p''.
    let p = move |r: f64| {
        let d = (C * C - r * r).max(0.0);
        let of = [3.0 * d.powi(3), -18.0 * r * d.powi(2), -18.0 * d.powi(2) + 72.0 * r * r * d];
        of.map(|k| -k / stiffness)
    };
    let exact = move |[r, z]: [f64; 2]| {
        let ([q, q1, q2, _], [p, p1, _]) = (q(r), p(r));
        let hoop = if r > 0.0 { -z * q1 / r } else { 0.0 };
        ([-z * q1, q + z * p], Matrix2::new(-z * q2, -q1, q1 + z * p1, p), hoop)
    };
    let force = move |[r, z]: [f64; 2]| {
        let ([_, q1, q2, q3], [_, p1, p2]) = (q(r), p(r));
        let (first, second) = (q1 / r, p1 / r);
        let slope = q3 + (q2 - first) / r;
        let axial = lambda * (q2 + first) - mu * z * (p2 + second);
        [stiffness * z * slope - (lambda + mu) * p1, axial]
    };
    let clamped = move || Condition::displacement(move |x| exact(x).0[0], move |x| exact(x).0[1]);
    let problem = Problem::of(
        meridian([0.0, 1.0], 1.0, [n, n], false),
        Material::lame(lambda, mu, Plane::Axisymmetric),
    )
    .with_body_force(move |x| force(x)[0], move |x| force(x)[1])
    .with("top", clamped())
    .with("right", clamped())
    .with("bottom", Condition::contact(|_| 0.0));
    let s = solved(&problem, degree);
    let force = 0.75 * PI * C.powi(8);
    (s.quantities.contact_force / force - 1.0, errors(&problem, &s, &exact))
}

#[test]
fn a_smooth_solution_with_an_end_of_contact_has_orders_1_2_and_2_3() {
    for degree in DEGREES {
        let p = degree.number() as f64;
        let (coarse, fine) =
            (with_an_end_of_contact(16, degree), with_an_end_of_contact(32, degree));
        for (k, expected) in [p, p + 1.0].into_iter().enumerate() {
            let found = order(coarse.1[k], fine.1[k]);
            assert_abs_diff_eq!(found, expected, epsilon = 0.1);
        }
        assert!(fine.0.abs() < if p == 1.0 { 0.03 } else { 1e-3 }, "{}", fine.0);
    }
}

#[test]
fn far_from_the_axis_a_body_is_in_plane_strain() {
    let conditions = |problem: Problem| {
        problem
            .with("top", Condition::displacement(|_| 0.0, |[x, _]| -0.01 * (1.0 + x.fract())))
            .with("bottom", Condition::contact(|_| 0.0))
    };
    for degree in DEGREES {
        let solve_at = |inner: f64, plane: Plane| {
            let mesh = meridian([inner, inner + 1.0], 1.0, [6, 6], false);
            solved(&conditions(Problem::of(mesh, Material::young_poisson(1.0, 0.3, plane))), degree)
        };
        let flat = solve_at(0.0, Plane::Strain);
        let mut last = f64::INFINITY;
        for radius in [1e3, 1e5] {
            let s = solve_at(radius, Plane::Axisymmetric);
            let per_length = s.quantities.contact_force / (TAU * radius);
            let off = (per_length / flat.quantities.contact_force - 1.0).abs();
            // The mean radius is half a width further out: 5e-6 at 1e5, and as much again is allowed.
            assert!(off < 1.0 / radius, "{off:e} at {radius}");
            assert!(off < last / 30.0);
            last = off;
        }
    }
}

#[test]
fn lengths_times_a_power_of_two_give_the_same_to_the_bit() {
    let scaled = |k: i32, degree: Degree| {
        let unit = 2.0_f64.powi(k);
        let mesh = moved_to(&meridian([0.0, 1.0], 1.0, [4, 4], true), |x| x.map(|c| c * unit));
        let problem = Problem::of(mesh, elastic(1.0, 0.3))
            .with("top", Condition::displacement(|_| 0.0, move |_| -0.01 * unit))
            .with("bottom", Condition::contact(move |[x, _]| 0.001 * x));
        solved(&problem, degree)
    };
    for degree in DEGREES {
        let one = scaled(0, degree);
        // The root of the scale of the matrix, E r, is a power of two as well.
        let other = scaled(4, degree);
        for (a, b) in one.displacement.iter().zip(&other.displacement) {
            assert_eq!(a.map(|c| c * 16.0), *b);
        }
        assert_eq!(one.quantities.contact_force * 256.0, other.quantities.contact_force);
    }
}

/// int gamma sigma_n(v)^2 <= kappa a(v, v), attained for P1 by v = n (n . (x - m)) with v_r = 0 in the middle m: on every triangle off
/// the axis.
#[test]
fn kappa_is_attained_by_p1_and_not_exceeded() {
    let mut random = Random(5);
    let mut by_the_plane = 0.0_f64;
    for degree in DEGREES {
        for k in 0..50 {
            let inner = if k % 2 == 0 { 0.0 } else { random.decades(-2.0, 2.0) };
            let mut corner =
                |x: f64, y: f64| [inner + x + random.next() / 4.0, y + random.next() / 4.0];
            let (a, b, c) = (corner(0.3, 0.0), corner(1.5, 0.1), corner(0.9, 1.2));
            let c = if k % 4 == 0 { [0.0, c[1]] } else { c };
            let named = [("bottom".to_owned(), vec![[0, 1]])];
            let mesh = Mesh::new(vec![a, b, c], vec![[0, 1, 2]], named).unwrap();
            let [n, m] = {
                let t = mesh.triangle(0);
                {
                    let n = t.scaled_normal(2);
                    [n / n[0].hypot(n[1]), t.point([1.0 / 3.0; 3])]
                }
            };
            let problem = pressed_down(Problem::of(mesh, elastic(1.0, 0.3)))
                .with("bottom", Condition::contact(|_| 0.0));
            let space = Space::new(&problem.mesh, degree);
            let d = discretize(&problem, &Method { degree, ..Method::default() }).unwrap();
            let quotient =
                |v: &[[f64; 2]]| d.contact[0].squared_stress(v) / (0.5 * d.strain_energy(v));
            for _ in 0..20 {
                let v = random.field(space.nodes().len());
                assert!(quotient(&v) <= 1.0 + 1e-12, "{degree:?} {k}");
            }
            if degree == Degree::One {
                let v: Vec<[f64; 2]> = space
                    .nodes()
                    .iter()
                    .map(|&x| {
                        let along = n[0] * (x[0] - m[0]) + n[1] * (x[1] - m[1]);
                        [n[0] * along, n[1] * along]
                    })
                    .collect();
                assert_abs_diff_eq!(quotient(&v), 1.0, epsilon = 1e-9);
                // |E| / |T| in place of the constant with the weight would be exceeded by r_E / r_c.
                let radii = problem.mesh.triangle(0).vertices.map(|x| x[0]);
                let of_edge = (radii[0] + radii[1]) / 2.0;
                by_the_plane =
                    by_the_plane.max(quotient(&v) * 3.0 * of_edge / radii.iter().sum::<f64>());
            }
        }
    }
    // The corner opposite is on the axis: the control.
    assert_abs_diff_eq!(by_the_plane, 1.5, epsilon = 1e-9);
}

/// A body that its weight presses down.
fn pressed_down(problem: Problem) -> Problem {
    Problem { body_force: [constant(0.0), constant(-1.0)], ..problem }
}

/// The largest eigenvalue of int gamma s(v)^2 beside a(v, v) for gamma0 at its limit, over all v.
fn largest_quotient(problem: &Problem, degree: Degree) -> f64 {
    let gamma0 = Gamma0::Value(Coercivity::new(problem, degree).unwrap().limit());
    let method = Method { degree, gamma0, allow_noncoercive: true, ..Method::default() };
    let d = discretize(problem, &method).unwrap();
    let count = 2 * d.space.nodes().len();
    let unit = |i: usize| {
        let mut v = vec![[0.0; 2]; count / 2];
        v[i / 2][i % 2] = 1.0;
        v
    };
    let squared =
        |v: &[[f64; 2]]| d.contact.iter().map(|piece| piece.squared_stress(v)).sum::<f64>();
    let forces_of = |v: &[[f64; 2]]| d.internal_forces(v).values.into_flattened();
    let mut stiffness: Vec<Vec<f64>> = (0..count).map(|j| forces_of(&unit(j))).collect();
    // The translation along the axis has neither stress nor energy: it is given one.
    let scale = (0..count).map(|i| stiffness[i][i]).fold(0.0, f64::max);
    for i in (1..count).step_by(2) {
        (1..count).step_by(2).for_each(|j| stiffness[i][j] += scale / count as f64);
    }
    let factor = cholesky(stiffness);
    let felt: Vec<usize> = (0..count).filter(|&i| squared(&unit(i)) > 0.0).collect();
    let product = |a: usize, b: usize| {
        let (mut sum, mut difference) = (unit(a), unit(a));
        sum[b / 2][b % 2] += 1.0;
        difference[b / 2][b % 2] -= 1.0;
        (squared(&sum) - squared(&difference)) / 4.0
    };
    let stress: Vec<Vec<f64>> =
        felt.iter().map(|&a| felt.iter().map(|&b| product(a, b)).collect()).collect();
    // v -> K^-1 S v tends to the largest; the quotient of v is one of the numbers below it.
    let mut random = Random(1);
    let mut v = random.field(count / 2).into_flattened();
    let mut largest = 0.0_f64;
    for _ in 0..100 {
        let mut image = vec![0.0; count];
        for (row, &a) in stress.iter().zip(&felt) {
            image[a] = row.iter().zip(&felt).map(|(entry, &b)| entry * v[b]).sum();
        }
        solve_by(&factor, &mut image);
        let size = image.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        v = image.into_iter().map(|x| x / size).collect();
        let nodal: Vec<[f64; 2]> = v.chunks_exact(2).map(|u| [u[0], u[1]]).collect();
        largest = largest.max(squared(&nodal) / d.strain_energy(&nodal));
    }
    largest
}

/// L with L L' = `matrix`, which is symmetric and positive definite.
fn cholesky(mut matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for i in 0..matrix.len() {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| matrix[i][k] * matrix[j][k]).sum();
            let rest = matrix[i][j] - known;
            matrix[i][j] = if i == j { rest.sqrt() } else { rest / matrix[j][j] };
            assert!(matrix[i][j].is_finite(), "no positive pivot at {i}");
        }
    }
    matrix
}

/// Solves L L' x = b in place of b.
fn solve_by(l: &[Vec<f64>], b: &mut [f64]) {
    for i in 0..b.len() {
        let known: f64 = (0..i).map(|k| l[i][k] * b[k]).sum();
        b[i] = (b[i] - known) / l[i][i];
    }
    for i in (0..b.len()).rev() {
        let known: f64 = (i + 1..b.len()).map(|k| l[k][i] * b[k]).sum();
        b[i] = (b[i] - known) / l[i][i];
    }
}

#[test]
fn no_mesh_has_an_eigenvalue_above_kappa() {
    let mut random = Random(11);
    let mut most = 0.0_f64;
    for k in 0..100 {
        let degree = DEGREES[k % 2];
        let inner = if k % 4 < 2 { 0.0 } else { random.decades(-2.0, 1.0) };
        let cells = [random.whole(1, 3), random.whole(2, 3)];
        let mesh = meridian([inner, inner + 1.0], random.decades(-0.5, 0.5), cells, true);
        let problem = pressed_down(Problem::of(mesh, elastic(1.0, random.between(-0.3, 0.45))))
            .with("bottom", Condition::contact(|_| 0.0))
            .with("right", Condition::contact(|_| 0.0));
        let found = largest_quotient(&problem, degree);
        // The eigenvalue is off by rounding times the condition of these small matrices.
        assert!(found <= 1.0 + 1e-9, "{degree:?} {k}: {found}");
        most = most.max(found);
    }
    assert!(most > 0.5, "{most}");
}

/// The unit square as Gmsh has it is the meridian of a cylinder.
#[test]
fn a_cylinder_on_a_mesh_of_gmsh_is_exact() {
    for degree in ["1", "2"] {
        let case = case_of(
            r#"
            mesh.gmsh = "../reference/cases/square.msh"
            material = { young = 2.0, poisson = 0.3 }
            body.plane = "axisymmetric"
            boundary.top.pressure = 0.01
            boundary.bottom.contact.gap = 0
            "#,
            &[&format!("method.degree={degree}")],
        );
        let settings = Settings { proof: ENCLOSED, ..case.settings };
        let (s, _) = solve(&case.problem, &case.method, &settings).unwrap();
        for (&[r, z], u) in s.nodes.iter().zip(&s.displacement) {
            let expected = [0.3 * 0.01 * r / 2.0, -0.01 * z / 2.0];
            assert_abs_diff_eq!(u[..], expected[..], epsilon = PATCH);
        }
        assert!(s.enclosure.unwrap().relative.unwrap() <= ENCLOSED);
    }
}

/// In triangles far longer than they are wide, next to the axis, where hoops are strained most.
#[test]
fn forces_of_hoops_are_within_the_sums_of_their_magnitudes() {
    for degree in DEGREES {
        let problem = Problem::of(meridian([0.0, 1.0], 50.0, [6, 2], false), elastic(1.0, 0.3))
            .with("bottom", Condition::contact(|_| 0.0))
            .with("top", Condition::roller());
        let d = discretize(&problem, &method(degree, EXACT)).unwrap();
        for power in 0..3 {
            let u = d.space.nodes().iter().map(|[r, _]| [r.powi(power), 0.0]).collect::<Vec<_>>();
            let forces = d.internal_forces(&u);
            for (force, most) in forces.values.iter().zip(&forces.magnitudes) {
                assert!(force[0].abs() <= most[0], "{degree:?} {power}: {force:?} {most:?}");
            }
        }
    }
}
