//! The numbers of docs/figures/revolution.csv: `cargo test --test suite revolution::measured -- --ignored --nocapture`.

use signorini::model::Degree;

use super::answers::{hollow_ball, sleeve, with_an_end_of_contact};
use super::half_space::{beside_hertz, flat_punch, off_hertz};
use super::pairs::{shrink_fit, two_spheres};
use super::*;

fn off(ratio: f64) -> String {
    format!("{:.1e}", ratio - 1.0)
}

fn row(what: &str, numbers: [Vec<String>; 2]) {
    println!("\"{what}\",{}", numbers.map(|of| format!("\"{}\"", of.join(", "))).join(","));
}

/// One list for P1 and one for P2.
fn each<T: Copy>(of: [&[T]; 2], f: impl Fn(T, Degree) -> String) -> [Vec<String>; 2] {
    [0, 1].map(|k| of[k].iter().map(|&n| f(n, DEGREES[k])).collect())
}

fn orders(what: &str, sizes: [&[usize]; 2], f: impl Fn(usize, Degree) -> (f64, [f64; 2])) {
    let found = [0, 1].map(|k| sizes[k].iter().map(|&n| f(n, DEGREES[k])).collect::<Vec<_>>());
    for (name, c) in [("energy", 0), ("L2", 1)] {
        let of = found.each_ref().map(|runs| {
            let order =
                |pair: &[(f64, [f64; 2])]| format!("{:.2}", (pair[0].1[c] / pair[1].1[c]).log2());
            runs.windows(2).map(order).collect()
        });
        row(&format!("{what}: orders, {name}"), of);
    }
    row(
        &format!("{what}: force or pressure"),
        found.map(|runs| runs.iter().map(|(off, _)| format!("{off:.1e}")).collect()),
    );
}

#[test]
#[ignore = "prints a table; the bounds are in the tests beside this one"]
fn the_table_of_bodies_of_revolution_is_near_the_formulas() {
    println!("body,P1,P2");
    orders(
        "smooth, n = 8, 16, 32, 64; 4, 8, 16, 32",
        [&[8, 16, 32, 64], &[4, 8, 16, 32]],
        with_an_end_of_contact,
    );
    orders("sleeve, n = 8, 16, 32", [&[8, 16, 32], &[8, 16, 32]], sleeve);
    row(
        "hollow ball, n = 8, 16, 32: largest displacement / Lame's - 1",
        each([&[8, 16, 32]; 2], |n, degree| format!("{:.1e}", hollow_ball(n, degree))),
    );
    let fit = each([&[1, 2, 4], &[1, 2, 4]], |m, degree| {
        off(shrink_fit(degree, m, [20, 10][degree.number() - 1] * m)[0])
    });
    row("shrink fit, m = 1, 2, 4; 20 m and 10 m cells along r: p / exact - 1", fit);
    let sizes: [&[usize]; 2] = [&[8, 16, 32], &[4, 8, 16]];
    row(
        "half space, a / h = 8, 16, 32; 4, 8, 16: F / Hertz - 1",
        each(sizes, |n, degree| off(beside_hertz(n, degree)[0])),
    );
    row(
        "the same: peak of the recovered pressure / p0",
        each(sizes, |n, degree| format!("{:.4}", beside_hertz(n, degree)[1])),
    );
    row(
        "the same: -lambda^h at r = 0 / p0",
        each(sizes, |n, degree| format!("{:.4}", beside_hertz(n, degree)[2])),
    );
    row(
        "the same: [P]+ / gamma less Hertz's pressure in L2 (weight r), over it",
        each(sizes, |n, degree| format!("{:.3}", off_hertz(n, degree))),
    );
    row(
        "flat punch, the same a / h: F / (2 a E* depth) - 1",
        each(sizes, |n, degree| off(flat_punch(n, degree))),
    );
    let sizes: [&[usize]; 2] = [&[6, 12, 24], &[6, 12]];
    let spheres = |n: usize, degree| two_spheres(degree, [n, n * 7 / 6]);
    row(
        "two spheres, a / h = 6, 12, 24; 6, 12: peak / p0",
        each(sizes, |n, degree| format!("{:.4}", spheres(n, degree).peak)),
    );
    row(
        "the same: contact radius / a",
        each(sizes, |n, degree| format!("{:.4}", spheres(n, degree).radius)),
    );
    row("the same: F / Hertz - 1", each(sizes, |n, degree| off(spheres(n, degree).force)));
}
