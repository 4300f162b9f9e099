//! The figure of Theorem 7.2 in docs/a-posteriori.md: three points of a plane for which the theorem holds.

use approx::{abs_diff_eq, assert_abs_diff_eq};

/// Centre and radius of each circle of a drawing.
fn circles(drawing: &str) -> Vec<([f64; 2], f64)> {
    let number = |circle: &str, name: &str| -> f64 {
        let (_, rest) = circle.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    let circles = drawing.split("<circle").skip(1);
    circles.map(|c| (["cx", "cy"].map(|name| number(c, name)), number(c, "r"))).collect()
}

fn distance([a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    (a - x).hypot(b - y)
}

#[test]
fn the_figure_of_theorem_7_2_is_of_points_for_which_it_holds() {
    let page = crate::common::root().join("docs/figures/hypercircle.svg");
    let circles = circles(&std::fs::read_to_string(page).unwrap());
    // The ball and the sphere without contact; then C eps(v), tau, their mean and sigma(u).
    let [(ball, radius), (sphere, half), (v, _), (tau, _), (mean, _), (sigma, _)] = circles[..]
    else {
        panic!("{circles:?}")
    };
    let apart = distance(v, tau);
    assert!(ball == mean && sphere == mean && abs_diff_eq!(half, apart / 2.0, epsilon = 0.1));
    assert_abs_diff_eq!(distance(v, mean), distance(tau, mean), epsilon = 1e-9);
    // M^2 is a quarter of |C eps(v) - tau|^2 and int tau_n (v_n - g) over Gamma_C.
    let work = radius * radius - apart * apart / 4.0;
    let squares = distance(sigma, v).powi(2) + distance(sigma, tau).powi(2);
    assert!(work > 0.0 && squares <= apart * apart + 2.0 * work);
    assert!(distance(sigma, mean) <= radius);
    // With the point on the page the bound without contact is too small.
    assert!(squares > apart * apart);
}
