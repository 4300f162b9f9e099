//! What is no body of revolution is refused, with the place, what was found and what was expected.

use signorini::certificates::certify;
use signorini::kernel::{Material, Plane};
use signorini::model::{Condition, Materials, Problem};
use signorini::solve::check;

use super::*;

fn message(problem: &Problem) -> String {
    check(problem, &method(Degree::One, EXACT)).unwrap_err().to_string()
}

fn block(inner: f64) -> Problem {
    Problem::of(meridian([inner, inner + 1.0], 1.0, [3, 3], false), elastic(1.0, 0.3))
        .with("top", flat_roller())
        .with("bottom", Condition::contact(|_| 0.0))
}

#[test]
fn bodies_beyond_the_axis_and_next_to_it_are_refused() {
    for (inner, found) in [(-0.25, "(-0.25, 0)"), (1e-17, "(1e-17, 0)")] {
        let said = message(&block(inner));
        assert!(said.contains("the body of revolution is a vertex at"), "{said}");
        assert!(said.contains(found) && said.contains("the axis, which is x = 0"), "{said}");
    }
    // The controls: on the axis, and off it.
    for inner in [0.0, 0.5] {
        check(&block(inner), &method(Degree::One, EXACT)).unwrap();
    }
}

#[test]
fn conditions_on_the_axis_and_oblique_supports_are_refused() {
    let said = message(&block(0.0).with("left", Condition::roller()));
    assert!(said.contains("condition on the axis") && said.contains("'left'"), "{said}");
    let mesh = meridian([1.0, 2.0], 1.0, [2, 2], false);
    let leaning = moved_to(&mesh, |[x, y]| [x + 0.3 * y, y]);
    let problem = Problem::of(leaning, elastic(1.0, 0.3))
        .with("left", Condition::roller())
        .with("bottom", Condition::contact(|_| 0.0));
    let said = message(&problem);
    assert!(said.contains("oblique support") && said.contains("'left'"), "{said}");
    // Control: an upright one.
    let upright = Problem::of(mesh, elastic(1.0, 0.3))
        .with("left", Condition::roller())
        .with("top", Condition::pressure(|_| 0.01))
        .with("bottom", Condition::contact(|_| 0.0));
    check(&upright, &method(Degree::One, EXACT)).unwrap();
}

#[test]
fn a_body_is_one_of_revolution_in_all_its_parts() {
    let of = |plane| Material::young_poisson(1.0, 0.3, plane);
    let mut problem = block(0.0);
    let half: Vec<usize> = (0..9).collect();
    problem.material =
        Materials::in_parts(of(Plane::Axisymmetric), 18, [(of(Plane::Strain), &half[..])]);
    let said = message(&problem);
    assert!(said.contains("the plane is axisymmetric for some materials only"), "{said}");
}

#[test]
fn a_single_row_of_triangles_that_may_turn_is_refused_and_two_rows_may_not() {
    // Two triangles beside each other whose middles have one height; the hoop strain of P1 sees the middles alone.
    let vertices = vec![[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, -1.0]];
    let row = Mesh::new(
        vec![[1.0, 0.0], [2.0, 0.0], [1.5, 0.9]],
        vec![[0, 1, 2]],
        [("bottom".to_owned(), vec![[0, 1]])],
    )
    .unwrap();
    let apart =
        |mesh| Problem::of(mesh, elastic(1.0, 0.3)).with("bottom", Condition::contact(|_| 0.1));
    let said = message(&apart(row));
    assert!(said.contains("the body is not held") && said.contains("rotation"), "{said}");
    let two =
        Mesh::new(vertices, vec![[0, 1, 2], [0, 3, 1]], [("bottom".to_owned(), vec![[0, 3]])])
            .unwrap();
    // The load drives the body away from the floor.
    let said = message(&apart(two).with_body_force(|_| 0.0, |_| 0.1));
    assert!(said.contains("translation along (0, 1)") && !said.contains("rotation"), "{said}");
}

#[test]
fn certificates_of_bodies_of_revolution_are_refused_with_a_sentence() {
    let problem = block(0.0).with("bottom", Condition::contact(|_| -0.01));
    let s = solved(&problem, Degree::One);
    let said = certify(&problem, &s).unwrap_err().to_string();
    assert!(said.contains("the body is one of revolution"), "{said}");
}
