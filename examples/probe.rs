use signorini::fem::contact_line::EdgeRule;
use signorini::fem::matrix::*;
use signorini::fem::*;
use signorini::kernel::edge_integral::ExactEdge;
use signorini::kernel::*;
use signorini::solve::{factor::Factor, ordering};
use std::collections::BTreeMap;
use std::time::Instant;
fn run<E: ExactEdge<f64, N, M>, const N: usize, const M: usize>(n: usize) {
    let t = Instant::now();
    let mesh = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right }
        .mesh()
        .unwrap();
    println!("mesh {:?}", t.elapsed());
    let zero = || -> BoxedFunction { Box::new(|_: [f64; 2]| 0.0) };
    let mut conditions = BTreeMap::new();
    conditions.insert("top".to_string(), Condition::Displacement([Some(zero()), Some(zero())]));
    conditions.insert("bottom".to_string(), Condition::Contact { gap: zero() });
    let problem = Problem {
        mesh,
        material: Material::lame(1.0, 1.0, Plane::Strain),
        body_force: [zero(), Box::new(|x: [f64; 2]| -4.0 + 10.0 * x[0])],
        conditions,
    };
    let t = Instant::now();
    let d = Discretization::<E, N, M>::new(&problem, |c| 0.5 * c.limit(), EdgeRule::Exact).unwrap();
    println!("discretize {:?}", t.elapsed());
    let t = Instant::now();
    let (u, report) =
        signorini::solve::condensed::solve(&d, &signorini::solve::Settings::default()).unwrap();
    println!(
        "contact solve {:?} {} {:?} {:e} energy {:.16}",
        t.elapsed(),
        report.residuals.len() - 1,
        report.status,
        report.residual,
        signorini::fem::discretization::inner(&d.internal_forces(&u).values, &u)
    );
    println!("{:?}", report.residuals);
    let t = Instant::now();
    let nb = neighbours(d.space.nodes().len(), d.space.elements());
    println!("neighbours {:?}", t.elapsed());
    let mut last = vec![false; d.space.nodes().len()];
    for e in &d.contact {
        for &i in &d.space.elements()[e.edge.triangle] {
            last[i] = true;
        }
    }
    for (what, last) in [("none", vec![false; last.len()]), ("contact", last)] {
        let t = Instant::now();
        let order = ordering::nested_dissection(d.space.nodes(), &nb, &last);
        println!("{what} order {:?}", t.elapsed());
        let numbering = Numbering::new(&order, d.constraints.values());
        let t = Instant::now();
        let a = matrix::assemble(&d, &numbering, &nb);
        println!("assemble {:?} dofs {}", t.elapsed(), numbering.count);
        let t = Instant::now();
        let f = Factor::new(&a).unwrap();
        println!("factor {:?} nnz {}", t.elapsed(), f.stored_entries());
        let t = Instant::now();
        let mut x = vec![1.0; numbering.count];
        f.forward(&mut x);
        f.backward(&mut x);
        println!("solve {:?}", t.elapsed());
    }
}
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    run::<P1, 3, 2>(n);
    println!("P2");
    run::<P2, 6, 3>(n);
}
