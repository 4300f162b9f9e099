use crate::common::exact::{corner, moved, on_square, on_trapezoid, singular, smooth, smooth_with_gap};
use signorini::certify::certify;
use signorini::fem::{Errors, Space, contact_line};
use signorini::kernel::{P2};
use signorini::solve::{Degree, Ladder};

fn go(what: &str, ladder: &Ladder, levels: usize) {
    let mut old: Option<f64> = None;
    for level in 0..levels {
        let (_, problem, solution) = ladder.solve(level).unwrap();
        let c = match certify(&problem, &solution) { Ok(c) => c, Err(e) => { println!("{what} {level}: {e}"); continue } };
        let space = Space::<P2, 6, 3>::new(&problem.mesh);
        let contact = contact_line::assemble(&problem, &space, solution.gamma.gamma0).unwrap();
        let error = Errors::new(&space, &contact, &c.displacement, &*ladder.solution).energy;
        let own = Errors::new(&space, &contact, &solution.displacement, &*ladder.solution).energy;
        let osc: f64 = c.certificate.pieces.iter().map(|p| p.oscillation * p.oscillation).sum::<f64>().sqrt();
        println!("{what} {level}: error {error:.3e} own {own:.3e} bound {:.3e} eff {:.3} of_field/own {:.3} clip {:.1e} lift {:.1e} osc {osc:.1e} hint {:.2} cuts {} rate {:.2} {:?}",
            c.bound, c.bound / error, c.of_field / own, c.clipping, c.lift, c.effectivity_hint.unwrap_or(0.0), c.certificate.cuts.len(), old.map_or(0.0, |o| (o / c.bound).log2()), c.reason);
        old = Some(c.bound);
    }
}
#[test]
fn zz() {
    for (what, solution) in [("(a) 3 2", smooth(3.0, 2.0, 1.0 / 3.0)), ("(a) 4 3", smooth(4.0, 3.0, 1.0 / 3.0)), ("(a) gap", smooth_with_gap())] {
        go(what, &on_square(&solution, Degree::Two, 8), 4);
    }
    for c in [0.5, 1.0 / 3.0] {
        let ladder = on_square(&singular(c), Degree::Two, 8);
        go(&format!("(b) {c:.2}"), &ladder, 4);
        go(&format!("(b) {c:.2} moved"), &moved(ladder), 3);
    }
    let (solution, _) = corner(0.75);
    go("(c)", &on_trapezoid(&solution, 0.75, Degree::Two, 8), 4);
}
