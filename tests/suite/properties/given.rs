//! What a problem is made of before anything is solved: structured meshes and their families, exact solutions and the rates
//! that they promise, and the numbers that methods, settings and materials may have.

use std::collections::BTreeMap;
use std::sync::Arc;

use approx::abs_diff_eq;
use proptest::array::uniform2;
use signorini::exact::Exact;
use signorini::exact::{Corner, Kind, Singular, Smooth};
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::graded_quadrature::{Features, Rule};
use signorini::model::material::stable;
use signorini::model::{
    Condition, DataError, Diagonal, Mesh, Perturbation, Problem, Rectangle, Structured, Trapezoid,
};
use signorini::solve::{
    ContactQuadrature, Gamma0, MOST_GAUSS_POINTS, MOST_ITERATIONS, Method, Settings, SolveError,
    discretize,
};
use study::Ladder;
use study::ladder::{fitted_slope, rates};

use super::{Outcome, for_all, properties, text};
use crate::common::{constant, unit_material};

/// A place of the unit square on its way to a mesh: the rectangle's, or the trapezoid's of an angle.
type Map = Box<dyn Fn([f64; 2]) -> [f64; 2]>;

/// The vertices of `mesh` are those of nx x ny cells of the unit square under `map`, with the middles of the cells if these are
/// crossed, each off by at most `amount` cells in the square; the corners are where they are, and the sides on their lines.
fn laid_out(
    mesh: &Mesh,
    [nx, ny]: [usize; 2],
    crossed: bool,
    map: &Map,
    back: &Map,
    amount: f64,
) -> Result<(), String> {
    let mut places = Vec::new();
    for j in 0..=ny {
        places.extend((0..=nx).map(|i| [i as f64, j as f64]));
    }
    if crossed {
        for j in 0..ny {
            places.extend((0..nx).map(|i| [i as f64 + 0.5, j as f64 + 0.5]));
        }
    }
    let cells = [nx as f64, ny as f64];
    let in_square = |place: [f64; 2]| [place[0] / cells[0], place[1] / cells[1]];
    let mut left: Vec<[f64; 2]> = mesh.vertices().to_vec();
    for place in places {
        let straight = map(in_square(place));
        let off = |x: &[f64; 2]| {
            let at = back(*x);
            [0, 1].map(|c| (at[c] * cells[c] - place[c]).abs())
        };
        let moves = [0, 1].map(|c| 0.0 < place[c] && place[c] < cells[c]);
        let near = left.iter().position(|x| {
            let off = off(x);
            (0..2).all(|c| off[c] <= if moves[c] { amount } else { 0.0 } + 1e-12)
        });
        let found = near.ok_or(format!("no vertex at {straight:?}"))?;
        left.swap_remove(found);
    }
    let triangles = nx * ny * if crossed { 4 } else { 2 };
    if !left.is_empty() || mesh.triangles().len() != triangles {
        return Err(format!("{} vertices and {} triangles", left.len(), mesh.triangles().len()));
    }
    for (name, c, at) in [("left", 0, 0.0), ("right", 0, 1.0), ("bottom", 1, 0.0), ("top", 1, 1.0)]
    {
        let edges = mesh.edges_of(name).map_err(text)?;
        let ends = edges.iter().flat_map(|&e| mesh.ends(e)).map(|v| back(mesh.vertices()[v]));
        if edges.len() != [ny, nx][c] || { ends }.any(|x| (x[c] - at).abs() > 1e-12) {
            return Err(format!("the side {name}"));
        }
    }
    Ok(())
}

/// Rectangles and trapezoids, refined and moved at random, are laid out as they are said to be, where a trapezoid has
/// `turned` times its angle.
fn structured(turned: f64) -> Outcome {
    let diagonals = [Diagonal::Left, Diagonal::Right, Diagonal::Crossed];
    // Cells, sides in units and tenths, the angle in hundredths.
    let data = || (uniform2(1_usize..=4), uniform2(1..=40), 160..280, uniform2(0_u64..1000));
    for (diagonal, factor) in diagonals.into_iter().flat_map(|d| [1, 2, 3].map(|n| (d, n))) {
        for_all(1, data(), |([nx, ny], [width, height], angle, seeds)| {
            let (width, height) = (f64::from(width), 0.1 * f64::from(height));
            let rectangle = Rectangle { width, height, nx, ny, diagonal };
            let n = nx;
            let omega = 0.01 * f64::from(angle) * turned;
            let lean = 1.0 / (omega / turned).tan();
            let bodies: [(Structured, [usize; 2], bool, Map, Map); 2] = [
                (
                    Structured::Rectangle(rectangle),
                    [nx, ny],
                    diagonal == Diagonal::Crossed,
                    Box::new(move |[s, t]| [width * s, height * t]),
                    Box::new(move |[x, y]| [x / width, y / height]),
                ),
                (
                    Structured::Trapezoid(Trapezoid { omega, n }),
                    [n, n],
                    false,
                    Box::new(move |[s, t]| [s + (1.0 - s) * t * lean, t]),
                    Box::new(move |[x, t]| [(x - t * lean) / (1.0 - t * lean), t]),
                ),
            ];
            for (body, cells, crossed, map, back) in &bodies {
                let cells = cells.map(|n| factor * n);
                for (amount, seed) in [0.0, 0.2].into_iter().zip(seeds) {
                    let moved = (amount > 0.0).then_some(Perturbation { amount, seed });
                    let mesh = body.refined(factor).mesh(moved).map_err(text)?;
                    laid_out(&mesh, cells, *crossed, map, back, amount)
                        .map_err(|why| format!("{body:?} refined by {factor}, {moved:?}: {why}"))?;
                }
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// The exact solutions promise min(p, s - 1), s being their regularity plus `more`; the wedge's exponent is the root of its
/// equation; and one gamma0 for a ladder is half the least limit of its levels.
fn promised(more: f64) -> Outcome {
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    let omega: f64 = 2.2;
    let corner = Corner::new(material, omega).ok_or("no wedge of this angle")?;
    let alpha = corner.alpha();
    let wedge = (2.0 * alpha * omega).sin() + alpha * (2.0 * omega).sin();
    if !(wedge.abs() <= 1e-14 && 0.5 < alpha && alpha < 1.0) {
        return Err(format!("alpha = {alpha}: {wedge:e} is left of the equation of the wedge"));
    }
    let smooth = |k: f64, m: f64| -> Exact {
        Arc::new(Smooth { material, c: 0.5, k, m, ap: 1.0, aq: 1.0, gap: vec![0.0] })
    };
    let end: Exact = Arc::new(Singular { material, c: 0.5, amplitude: 1.0 });
    // [t]+^k is in H^s for s < k + 1/2; p' and q are in u, so that s is the least of k - 1/2 and m + 1/2.
    let known: [(Exact, f64); 5] = [
        (smooth(4.0, 2.0), 2.5),
        (smooth(3.0, 4.0), 2.5),
        (smooth(3.25, 2.5), 2.75),
        (end, 2.5),
        (Arc::new(corner), 1.0 + alpha),
    ];
    let square = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 2, diagonal: Diagonal::Left };
    for (i, (solution, regularity)) in known.iter().enumerate() {
        for (degree, p) in [(Degree::One, 1.0), (Degree::Two, 2.0_f64)] {
            let kinds = [("bottom", Kind::Contact), ("top", Kind::Displacement)];
            let ladder = Ladder {
                solution: Arc::clone(solution),
                kinds: BTreeMap::from(kinds.map(|(name, kind)| (name.to_owned(), kind))),
                body: Structured::Rectangle(square),
                perturbation: Some(Perturbation { amount: 0.1, seed: 3 }),
                method: Method { degree, ..Method::default() },
                settings: Settings::default(),
            };
            let expected = p.min(regularity + more - 1.0);
            let found = ladder.promised_rate();
            if !abs_diff_eq!(found, expected, epsilon = 1e-12) {
                return Err(format!("solution {i} promises {found}, expected {expected}"));
            }
            let mut least = f64::INFINITY;
            for level in 0..3 {
                let cells = ladder.problem(level).map_err(text)?.mesh.triangles().len();
                if cells != 8 << (2 * level) {
                    return Err(format!("{cells} triangles on level {level}"));
                }
                least = least.min(ladder.outline(level).map_err(text)?.gamma.coercivity.limit());
            }
            let with_one = ladder.with_one_gamma0(3).map_err(text)?.method.gamma0;
            if with_one != Gamma0::Value(least / 2.0) {
                return Err(format!("{with_one:?} for a least limit of {least}"));
            }
        }
    }
    let h = [0.5, 0.3, 0.1, 0.02];
    let errors = h.map(|h: f64| 3.0 * h.powf(1.25));
    let slopes = rates(&h, &errors).into_iter().chain([fitted_slope(&h, &errors)]);
    if { slopes }.any(|slope| !abs_diff_eq!(slope, 1.25, epsilon = 1e-12)) {
        return Err("a power of h has another slope".to_owned());
    }
    Ok(())
}

/// Methods and settings with these numbers are taken or refused; the limits are `wider`.
fn limits(wider: f64) -> Outcome {
    let (nan, just) = (f64::NAN, 1e-9);
    let [most_steps, most_points] = [MOST_ITERATIONS, MOST_GAUSS_POINTS].map(|most| most as f64);
    type Row<'a> = (&'a str, &'a dyn Fn(f64) -> bool, &'a [f64], &'a [f64]);
    // What takes a number, and numbers that are taken and refused.
    let rows: [Row; 5] = [
        (
            "tolerance",
            &|t| Settings::new(t, 10).is_ok(),
            &[1e-300, 1.0 - just],
            &[0.0, 1.0, 1.0 + wider, 5.0, -1e-9, nan],
        ),
        (
            "steps",
            &|n| Settings::new(1e-10, n as usize).is_ok(),
            &[1.0, most_steps],
            &[0.0, most_steps + 1.0],
        ),
        (
            "Gauss points",
            &|n| ContactQuadrature::gauss(n as usize).is_ok(),
            &[1.0, most_points],
            &[0.0, most_points + 1.0],
        ),
        (
            "Poisson's ratio in plane stress",
            &|nu| stable(Material::young_poisson(1.0, nu, Plane::Stress)).is_ok(),
            &[just - 1.0, -0.7, 0.3, 0.5 - just],
            &[-1.0 - just, -1.5, 0.5 + just + 1.0],
        ),
        (
            "gamma0",
            &|g| Gamma0::value(g).is_ok() && Gamma0::local(g).is_ok(),
            &[1e-300],
            &[0.0, -1.0, f64::INFINITY, nan],
        ),
    ];
    for (what, is_taken, taken, refused) in rows {
        if let Some(value) = taken.iter().find(|&&value| !is_taken(value)) {
            return Err(format!("{what} of {value} is refused"));
        }
        if let Some(value) = refused.iter().find(|&&value| is_taken(value)) {
            return Err(format!("{what} of {value} is taken"));
        }
    }
    Ok(())
}

/// A unit square on a floor, with conditions on top and to the left.
fn square(top: Condition, left: Condition) -> Result<Problem, String> {
    let cells = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 2, diagonal: Diagonal::Right };
    Ok(Problem::of(cells.mesh().map_err(text)?, unit_material())
        .with("top", top)
        .with("left", left)
        .with("bottom", Condition::contact(|_| 0.0)))
}

/// Whether two sides that meet in a vertex, and prescribe values that differ by `by` there, are refused. For component 2 the
/// left side is a support: u . n = -u_x.
fn disagreement(by: f64, component: usize) -> Result<bool, String> {
    let values = |by: f64| {
        let value = |c| Some(constant(1.0 + if c == component { by } else { 0.0 }));
        Condition::Displacement([0, 1].map(value))
    };
    let left = if component == 2 {
        Condition::Support { normal: Some(constant(-1.0 - by)), tangential: None }
    } else {
        values(by)
    };
    let problem = square(values(0.0), left)?;
    let method = Method { degree: Degree::One, ..Method::default() };
    match discretize(&problem, &method) {
        Ok(_) => Ok(false),
        Err(SolveError::Data(DataError::Disagree { .. })) => Ok(true),
        Err(other) => Err(other.to_string()),
    }
}

/// Values of size 1 agree to within `least`, the rounding of expressions that mean the same.
fn disagreements(least: f64) -> Outcome {
    for component in [0, 1, 2] {
        for by in [0.0, 1e-13, 1e-11, 1e-9, 1e-6, 1e-4, 1e-3, 9e-3, 1e-2, 0.1, -1e-6] {
            let expected = f64::abs(by) > least;
            if disagreement(by, component)? != expected {
                return Err(format!("component {component}, values that differ by {by}"));
            }
        }
    }
    Ok(())
}

/// The load of tractions on a side that is held in x: those along y are in it, those along x are not.
fn load_on_a_held_side(tractions: [f64; 2]) -> Result<Vec<[f64; 2]>, String> {
    let top = Condition::Mixed {
        displacement: [Some(constant(0.0)), None],
        traction: tractions.map(constant),
    };
    let left = Condition::Displacement([0, 1].map(|_| Some(constant(0.0))));
    let problem = square(top, left)?;
    Ok(discretize(&problem, &Method::default()).map_err(text)?.load)
}

fn same_loads(one: [f64; 2], other: [f64; 2]) -> Outcome {
    let (one, other) = (load_on_a_held_side(one)?, load_on_a_held_side(other)?);
    let loaded = one.iter().flatten().filter(|&&f| f != 0.0).count();
    if one == other && loaded > 0 { Ok(()) } else { Err(format!("{one:?} and {other:?}")) }
}

/// int_0^1 \[s - c\]+ ds = (1 - c)^2/2 by a rule on an edge, near its ends too, that is told to cut at c, or not.
fn kinks(told: bool) -> Outcome {
    for_all(500, (0.0..1.0, 0_usize..3), |(c, side)| {
        let c = [c, 1e-7 + 1e-2 * c, 1.0 - 1e-7 - 1e-2 * c][side];
        let (mut sum, mut total) = (0.0, 0.0);
        Rule::new(Features::default(), 4).on_edge(
            [[0.5, 1.0], [0.5, 3.0]],
            told.then_some(c),
            |point| {
                sum += point.weight * (point.s - c).max(0.0);
                total += point.weight;
            },
        );
        let near = |a: f64, b: f64| abs_diff_eq!(a, b, epsilon = 32.0 * f64::EPSILON);
        if !(near(sum, (1.0 - c) * (1.0 - c) / 2.0) && near(total, 1.0)) {
            return Err(format!("a kink at {c}: {sum:e}"));
        }
        Ok(())
    })
}

properties! {
    structured_meshes_are_laid_out_as_they_say: structured(1.0); not structured(1.001);
    exact_solutions_promise_their_rates: promised(0.0); not promised(0.5);
    numbers_beyond_their_limits_are_refused: limits(1e-9); not limits(-1e-9);
    prescribed_displacements_that_disagree_are_refused: disagreements(1e-12); not disagreements(1e-2);
    tractions_along_what_is_held_are_no_load: same_loads([7.0, -1.0], [0.0, -1.0]);
        not same_loads([0.0, -2.0], [0.0, -1.0]);
    edges_are_cut_where_the_rule_is_told_to: kinks(true); not kinks(false);
}
