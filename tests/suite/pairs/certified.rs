//! Certificates of two bodies.

use signorini::certify::certify;

use super::*;
use crate::common::DEGREES;

fn tilted(cells: [usize; 2], modulus: f64) -> Problem {
    let (lower, upper) = (rectangle([0.0, 0.0], [1.0, 1.0]), rectangle([0.0, 1.0], [1.0, 2.0]));
    let block =
        |name, n, modulus, map| Block { name, cells: [n, n], material: young(modulus, 0.3), map };
    bodies(
        &[block("lower", cells[0], 1.0, &lower), block("upper", cells[1], modulus, &upper)],
        &[Pair::new("lower.top", "upper.bottom")],
    )
    .with("lower.bottom", Condition::displacement(|_| 0.0, |[x, _]| 0.05 + 0.1 * (x - 0.5)))
    .with("upper.top", Condition::clamped())
}

#[test]
fn trial() {
    for degree in DEGREES {
        for cells in [[4, 4], [7, 11], [14, 22]] {
            let problem = tilted(cells, 1.0);
            let solution = proved(&problem, &method(degree));
            match certify(&problem, &solution) {
                Ok(c) => {
                    println!(
                        "{degree:?} {cells:?}: {} relative {} rigorous {} {:?} {:?} clipping {}",
                        c.bound, c.relative, c.rigorous, c.reason, c.problem, c.clipping
                    );
                    for q in &c.quantities.list {
                        println!("   {:?} {} {} {:?}", q.name, q.boundary, q.value, q.interval);
                    }
                    println!("   {} zones", c.quantities.zones.len());
                }
                Err(error) => println!("{degree:?} {cells:?}: {error}"),
            }
        }
    }
}
