//! scratch
use std::collections::BTreeMap;
use std::sync::Arc;
use signorini::fem::{Diagonal, Friction, Rectangle, Structured};
use signorini::solve::{Degree, Gamma0, Method, Settings, discretize, solve};
use signorini::study::exact::{Kind, SlipTip, StickSlip};
use signorini::study::{Exact, Ladder};
use signorini::{Condition, Material, Plane, Problem};
fn main() {
    for degree in [Degree::One, Degree::Two] {
        for n in [8, 16, 32, 64] {
            for s in [0.0, 0.05, 0.2, 100.0] {
                if degree == Degree::Two && n > 32 { continue }
                let mesh = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Crossed }.mesh().unwrap();
                let mut problem = Problem::of(mesh, Material::lame(1.0, 1.0, Plane::Strain))
                    .with("top", Condition::displacement(|[x, _]| 0.02 + 0.01 * x, |[x, _]| -0.05 - 0.02 * x))
                    .with("bottom", Condition::contact(|_| 0.0));
                problem = problem.with_friction("bottom", Friction::tresca(move |_| s));
                let method = Method { degree, ..Method::default() };
                let d = discretize(&problem, &method).unwrap();
                match solve(&problem, &method, &Settings::default()) {
                    Ok((solution, _)) => {
                        let e = solution.enclosure.as_ref();
                        println!("P{} n {n:3} s {s:6}: kappa {:.3} {:?} steps {} {} {:?} J {:.9} {:?} imbalance {:.1e}", degree.number(), d.kappa(), solution.method.route, solution.newton.iterations(), solution.verdict.name(), e.ok().and_then(|e| e.relative), d.energy(&solution.displacement), solution.boundaries[0].friction.map(|f| (f.shear, f.sticks, f.slides, f.slip, f.dissipated)), solution.balance.imbalance);
                    }
                    Err(e) => println!("P{} n {n} s {s}: {e}", degree.number()),
                }
            }
        }
    }
    let material = Material::lame(1.0, 1.0, Plane::Strain);
    let e: Exact = Arc::new(StickSlip { material, c: 1.0 / 3.0, k: 4.0, m: 3.0, a: 16.0, b: 0.2, bound: 0.05, pressure: 0.5 });
    let f: Exact = Arc::new(SlipTip { material, c: 0.5, amplitude: 0.02, bound: 0.05, pressure: 0.5 });
    for (name, solution) in [("e", e), ("f", f)] {
        for degree in [Degree::One, Degree::Two] {
            let n = if degree == Degree::One { 8 } else { 4 };
            let kinds: BTreeMap<String, Kind> = [("bottom", Kind::Contact), ("top", Kind::Displacement), ("left", Kind::Displacement), ("right", Kind::Displacement)].map(|(a, b)| (a.to_owned(), b)).into();
            let ladder = Ladder { solution: Arc::clone(&solution), kinds, body: Structured::Rectangle(Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right }), perturbation: None, method: Method { degree, gamma0: Gamma0::Auto, ..Method::default() }, settings: Settings::default() };
            let mut last = 0.0;
            for level in 0..4 {
                match ladder.solve(level) {
                    Ok((l, _, s)) => { println!("{name} P{} level {level}: energy {:.4e} rate {:.3} residual {:.3e} steps {} {} {:?}", degree.number(), l.errors.energy, (last / l.errors.energy as f64).log2(), l.errors.contact_residual, l.newton_steps, s.verdict.name(), s.method.route); last = l.errors.energy; }
                    Err(e) => println!("{name} {e}"),
                }
            }
        }
    }
}
