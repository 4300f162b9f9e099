//! Patch tests: exact solutions that lie in P1 (docs/theory.md, 10.5), so method (8) must reproduce them to rounding on any mesh,
//! with P1 and P2, by exact and by Gauss quadrature, for every law. Consistency (Lemma 3.1) at its plainest.

use std::sync::Arc;

use approx::abs_diff_eq;
use signorini::exact::Exact;
use signorini::exact::{Kind, Patch};
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Diagonal, Problem};
use signorini::nalgebra::Vector2;
use signorini::results::Solution;
use signorini::solve::{Settings, solve};

use super::tensor::{FULL, spruce};
use crate::common::*;

/// The solutions d1 to d5, and whether there is contact.
fn patches(material: Material<f64>) -> [(Exact, bool); 5] {
    let p = 0.3;
    [
        (Arc::new(Patch::compression(material, p)), true),
        (Arc::new(Patch::separation(material, p, 0.02)), false),
        (Arc::new(Patch::inclined(material, p, 0.05, 0.1)), true),
        (Arc::new(Patch::grazing(material)), false),
        (Arc::new(Patch::interference(material, 0.02)), true),
    ]
}

fn problem(solution: &Exact, diagonal: Diagonal) -> Problem {
    let kinds = [
        ("top", Kind::Displacement),
        ("left", Kind::Traction),
        ("right", Kind::Traction),
        ("bottom", Kind::Contact),
    ];
    let kinds = kinds.map(|(name, kind)| (name.to_owned(), kind)).into();
    study::problem(solution, skewed_square(6, diagonal), &kinds)
}

fn solved(problem: &Problem, degree: Degree) -> Solution {
    solve(problem, &method(degree, EXACT), &Settings::default()).unwrap().0
}

/// The bound of the patch tests: displacements of size 0.1 and stresses of size 1 through some 100 unknowns, each a sum of
/// about ten products; a thousand rounding errors cover it with room for the condition of the matrix, times the moduli.
const BOUND: f64 = 1000.0 * f64::EPSILON;

fn largest_error(solution: &Exact, s: &Solution) -> f64 {
    let mut error: f64 = 0.0;
    for (&node, u) in s.nodes.iter().zip(&s.displacement) {
        let exact = solution.displacement(node);
        error = error.max((u[0] - exact[0]).abs()).max((u[1] - exact[1]).abs());
    }
    let sigma_n = solution.stress([0.5, 0.0]).normal(Vector2::new(0.0, -1.0));
    for point in s.contact.iter().flat_map(|e| &e.points) {
        error = error.max((point.sigma_n - sigma_n).abs()).max((point.lambda - sigma_n).abs());
    }
    error
}

#[test]
fn patches_are_reproduced_to_rounding_on_skewed_meshes() {
    for material in [
        unit_material(),
        Material::lame(3.0, 0.7, Plane::Strain),
        Material::tensor(FULL, None),
        spruce(30.0),
    ] {
        let bound = BOUND * material.stiffness().into_iter().fold(1.0, f64::max);
        for (k, (solution, has_contact)) in patches(material).into_iter().enumerate() {
            for diagonal in [Diagonal::Left, Diagonal::Right, Diagonal::Crossed] {
                for (degree, quadrature) in
                    DEGREES.into_iter().flat_map(|d| [(d, EXACT), (d, GAUSS)])
                {
                    let problem = problem(&solution, diagonal);
                    let method = method(degree, quadrature);
                    let (s, _) = solve(&problem, &method, &Settings::default()).unwrap();
                    let here = format!("d{} {material:?} {diagonal:?} {method:?}", k + 1);
                    let error = largest_error(&solution, &s);
                    assert!(error <= bound, "{here}: {error:e}");
                    let covered = s.quantities.contact_length;
                    let length = f64::from(u8::from(has_contact));
                    assert!(abs_diff_eq!(covered, length, epsilon = BOUND), "{here}: {covered}");
                }
            }
        }
    }
}

/// A thousandth more of the modulus along y, or of the one that shear and strain along y have in common.
#[test]
fn control_a_patch_with_a_wrong_modulus_is_not_reproduced() {
    for (material, modulus) in [(unit_material(), 3), (Material::tensor(FULL, None), 4)] {
        for (solution, _) in patches(material).into_iter().filter(|(_, has_contact)| *has_contact) {
            let mut problem = problem(&solution, Diagonal::Crossed);
            let mut c = material.stiffness();
            c[modulus] *= 1.001;
            problem.material = Material::tensor(c, None).into();
            let error = largest_error(&solution, &solved(&problem, Degree::One));
            assert!(error > 1e6 * BOUND, "{solution:?}: {error:e}");
        }
    }
}

#[test]
fn grazing_without_load_stays_exactly_at_rest() {
    let [.., (grazing, _), _] = patches(unit_material());
    let s = solved(&problem(&grazing, Diagonal::Right), Degree::Two);
    assert!(s.displacement.iter().all(|u| *u == [0.0, 0.0]));
    assert_eq!(s.newton.residual, 0.0);
    assert_eq!(s.quantities.contact_force, 0.0);
}
