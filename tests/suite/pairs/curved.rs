//! Curved boundaries: rings that are pressed into each other, and cylinders; the gap is that between the smooth boundaries.

use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::common::case;

/// A quarter of a ring of modulus 1 from radius 1 to 2.002 in one of modulus 2 from 1.998 to 3, with these numbers of edges on the
/// quarter.
fn rings(edges: [usize; 2], swapped: bool) -> Problem {
    let quarter = [FRAC_PI_2, 0.0];
    let inner = ring([0.0; 2], [1.0, RADII[0]], quarter);
    let outer = ring([0.0; 2], [RADII[1], 3.0], quarter);
    let block = |name, n, modulus, map| Block {
        name,
        cells: [n, n / 3],
        material: young(modulus, 0.3),
        map,
    };
    let mut sides = ["inner.top", "outer.bottom"];
    if swapped {
        sides.reverse();
    }
    let mut problem = bodies(
        &[block("inner", edges[0], 1.0, &inner), block("outer", edges[1], 2.0, &outer)],
        &[Pair::new(sides[0], sides[1])],
    );
    for name in ["inner", "outer"] {
        for side in ["left", "right"] {
            problem = problem.with(format!("{name}.{side}"), Condition::roller());
        }
    }
    problem
}

const RADII: [f64; 2] = [2.002, 1.998];

/// The pressure for each unit of the mean radius, with the radii as they are and one force for each angle on both rings.
fn pressure_of_rings() -> f64 {
    let [inner, outer] = RADII;
    let (modulus, poisson) = (1.0 / (1.0 - 0.3 * 0.3), 0.3 / 0.7);
    // The displacement of a ring under a pressure of 1, over its radius.
    let squares = |a: f64, b: f64| (b * b + a * a) / (b * b - a * a);
    let shrinks = (squares(1.0, inner) - poisson) / modulus;
    let widens = (squares(outer, 3.0) + poisson) / (2.0 * modulus);
    (inner - outer) / (shrinks + widens) / ((inner + outer) / 2.0)
}

/// The mean pressure and the least and largest on a piece, over the expected one.
fn pressures(d: &Discretization, u: &[[f64; 2]]) -> [f64; 3] {
    let arc = FRAC_PI_2 * (RADII[0] + RADII[1]) / 2.0;
    let expected = pressure_of_rings();
    let forces: Vec<(f64, f64)> = d
        .contact
        .iter()
        .map(|piece| (piece.contribution(&d.rule, &piece.p(u)).resultant, piece.length))
        .collect();
    let mean = forces.iter().map(|(force, _)| force).sum::<f64>() / arc;
    let pieces = || forces.iter().map(|(force, length)| force / length / expected);
    [mean / expected, pieces().fold(f64::INFINITY, f64::min), pieces().fold(0.0, f64::max)]
}

#[test]
fn rings_press_on_each_other_as_lame_says() {
    for (degree, edges, mean, piece) in
        [(Degree::One, [32, 44], 1.5e-3, 1e-2), (Degree::Two, [16, 22], 5e-4, 5e-2)]
    {
        let problem = rings(edges, false);
        let s = proved(&problem, &method(degree));
        let d = discretize(&problem, &method(degree)).unwrap();
        let [found, least, most] = pressures(&d, &s.displacement);
        println!("{degree:?} {edges:?}: mean {found}, pieces {least} to {most}");
        assert!((found - 1.0).abs() <= mean, "{degree:?}: {found}");
        assert!(least >= 1.0 - piece && most <= 1.0 + piece, "{degree:?}: {least} {most}");
    }
}

#[test]
fn control_the_gap_between_polygons_is_noticed() {
    let problem = rings([32, 44], false);
    let plant = |d: &Discretization| {
        let mesh = d.space.mesh();
        with_geometry(d, |geometry| {
            for a in 0..geometry.nodes.len() {
                let [first, second] =
                    [0, 1].map(|i| Vector2::from(geometry.stretches[i].place(mesh, a)));
                geometry.nodes[a].gap = (second - first).dot(&geometry.nodes[a].direction);
            }
        })
    };
    let u = with_planted(&problem, &method(Degree::One), plant).unwrap();
    let mut d = discretize(&problem, &method(Degree::One)).unwrap();
    d.contact = plant(&d);
    let [found, ..] = pressures(&d, &u);
    // The mean pressure is off by 1.5e-3 at most with the gap between the circles.
    assert!((found - 1.0).abs() > 5e-3, "{found}");
}

/// How far the displacements of both orders of the bodies are apart, with pieces changed.
fn difference_of_orders(degree: Degree, change: fn(&Discretization) -> Vec<Piece>) -> f64 {
    let [a, b] = [false, true]
        .map(|swapped| with_planted(&rings([8, 11], swapped), &method(degree), change).unwrap());
    apart(&a, &b) / largest(&a)
}

#[test]
fn on_curved_boundaries_the_order_of_the_bodies_does_not_matter() {
    for degree in [Degree::One, Degree::Two] {
        let off = difference_of_orders(degree, |d| d.contact.clone());
        assert!(off <= 1e-13, "{degree:?}: {off:e}");
    }
    // The controls: the direction is the first body's, or the middle that of its side.
    let first_normal = |d: &Discretization| {
        with_geometry(d, |geometry| {
            let (_, normal) = d.space.mesh().length_and_normal(geometry.stretches[0].edge);
            geometry.nodes.iter_mut().for_each(|node| node.direction = normal);
        })
    };
    assert!(difference_of_orders(Degree::One, first_normal) > 1e-6);
    let first_middle = |d: &Discretization| {
        with_geometry(d, |geometry| {
            let positions = &mut geometry.stretches[0].positions;
            positions[2] = (positions[0] + positions[1]) / 2.0;
        })
    };
    let off = difference_of_orders(Degree::Two, first_middle);
    assert!(off > 1e-12, "{off:e}");
}

/// Hertz: the right halves of cylinders of steel and cast iron, of the case `cylinders`.
#[test]
fn cylinders_press_on_each_other_as_hertz_says() {
    for (degree, most, width) in [("1", 2e-2, 2e-2), ("2", 4e-3, 4e-3)] {
        let case = case("cylinders.toml", &[&format!("method.degree={degree}")]);
        let s = proved(&case.problem, &case.method);
        let force = 2.0 * s.boundaries[0].force;
        let plane = |modulus: f64, poisson: f64| (1.0 - poisson * poisson) / modulus;
        let modulus = 1.0 / (plane(210_000.0, 0.3) + plane(110_000.0, 0.26));
        let radius = 1.0 / (1.0 / 50.0 + 1.0 / 25.0);
        let peak = (force * modulus / (PI * radius)).sqrt();
        let half = (4.0 * force * radius / (PI * modulus)).sqrt();
        let found = s.boundaries[0].peak_pressure / peak;
        // The half width by the second moment of the pressure: (4 int p x^2 / F)^(1/2).
        let d = discretize(&case.problem, &case.method).unwrap();
        let moment: f64 = d
            .contact
            .iter()
            .flat_map(|piece| {
                let p = piece.p(&s.displacement);
                let force = piece.contribution(&d.rule, &p).force;
                let mesh = d.space.mesh();
                let place = |a: usize| piece.geometry.stretches[0].place(mesh, a)[0];
                (0..force.len()).map(|a| force[a] * place(a).powi(2)).collect::<Vec<_>>()
            })
            .sum();
        let second = (4.0 * 2.0 * moment / force).sqrt() / half;
        println!("degree {degree}: p0 {found}, a {second}, {} steps", s.newton.iterations());
        assert!((found - 1.0).abs() <= most, "degree {degree}: p0 off by {found}");
        assert!((second - 1.0).abs() <= width, "degree {degree}: a off by {second}");
    }
}
