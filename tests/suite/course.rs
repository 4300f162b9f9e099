//! A solve that starts from the solution of another: fewer Newton steps, the same result.

use std::cell::Cell;

use signorini::io::Case;
use signorini::results::{RouteName, Solution};
use signorini::solve;
use signorini::solve::{Course, Phase};

use crate::common::case;

/// The solution, and how many Newton steps somebody who watches has counted.
fn solved(case: &Case, start: Option<&Solution>) -> (Solution, usize) {
    let steps = Cell::new(0);
    let watcher = |phase: Phase| {
        if let Phase::Newton { .. } = phase {
            steps.set(steps.get() + 1);
        }
    };
    let course = start.map_or(Course::default(), |start| {
        Course::default().from_displacement(&start.displacement)
    });
    let course = course.watched_by(&watcher);
    let solved = solve::solve_along(&case.problem, &case.method, &case.settings, course);
    (solved.unwrap().0, steps.get())
}

fn distance(a: &Solution, b: &Solution) -> f64 {
    let pairs = a.displacement.as_flattened().iter().zip(b.displacement.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / a.quantities.max_displacement
}

#[test]
fn load_steps_from_the_last_one_take_fewer_newton_steps_to_the_same_solution() {
    // Both routes: `condensed` for the block, `assembled` for the strip, whose contact edges are many beside it.
    let gap = "boundary.bottom.contact.gap=\"0.001*x\"";
    let strip = ["mesh.rectangle.ny=1", "mesh.rectangle.height=0.05", "mesh.rectangle.nx=64", gap];
    let mut routes = Vec::new();
    for (file, settings, key, values) in [
        ("block.toml", &[][..], "load.body", ["[\"0\",\"-4+10*x\"]", "[\"0\",\"-4+9*x\"]"]),
        (
            "block.toml",
            &["method.degree=2", "method.gamma0=auto"],
            "load.body",
            ["[\"0\",\"-4+10*x\"]", "[\"0\",\"-4.5+10*x\"]"],
        ),
        (
            "disk.toml",
            &[],
            "boundary.top.displacement",
            ["[\"0\",\"-0.015\"]", "[\"0\",\"-0.020\"]"],
        ),
        ("block.toml", &strip, "load.body", ["[\"0\",\"-1\"]", "[\"0\",\"-1.01\"]"]),
    ] {
        let with = |value: &str| {
            let set = format!("{key}={value}");
            case(file, &[settings, &["method.gamma0=auto", &set]].concat())
        };
        let (first, _) = solved(&with(values[0]), None);
        let (afresh, many) = solved(&with(values[1]), None);
        let (from, few) = solved(&with(values[1]), Some(&first));
        routes.push(from.method.route);
        assert!(few < many, "{file}: {few} steps from the last solution, {many} afresh");
        assert!(distance(&afresh, &from) < 1e-9, "{file}: {:e}", distance(&afresh, &from));
        assert!(distance(&first, &from) > 1e-3, "{file}: the step changes nothing");
    }
    assert!([RouteName::Condensed, RouteName::Assembled].iter().all(|r| routes.contains(r)));
}

#[test]
fn a_start_on_other_nodes_is_none_and_a_bad_one_does_no_harm() {
    let block = case("block.toml", &[]);
    let (afresh, steps) = solved(&block, None);
    let coarse = ["mesh.rectangle.nx=8", "method.gamma0=auto"];
    let (coarse, _) = solved(&case("block.toml", &coarse), None);
    let (same, as_many) = solved(&block, Some(&coarse));
    assert_eq!((same.displacement, as_many), (afresh.displacement.clone(), steps));
    // The load the other way round: nothing that touched then touches now.
    let (other, _) = solved(&case("block.toml", &["load.body=[\"0\",\"6-10*x\"]"]), None);
    let (from, _) = solved(&block, Some(&other));
    assert!(distance(&afresh, &from) < 1e-9);
}
