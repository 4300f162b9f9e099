//! Gauss rules on \[0, 1\] and on a triangle.

/// The Gauss-Legendre rule with `n` points on \[0, 1\], exact for polynomials of degree 2n - 1: points with weights that
/// add up to 1. The nodes are the roots of the Legendre polynomial, by Newton's method from Tricomi's estimate.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let mut rule = vec![(0.0, 0.0); n];
    for i in 0..n.div_ceil(2) {
        let angle = std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5);
        let mut x = angle.cos();
        let mut slope = 1.0;
        // Quadratic convergence from an estimate that is good to O(n^-2): a fixed number of steps is enough.
        for _ in 0..10 {
            let (value, derivative) = legendre(n, x);
            slope = derivative;
            x -= value / derivative;
        }
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        rule[i] = (0.5 - x / 2.0, weight);
        rule[n - 1 - i] = (0.5 + x / 2.0, weight);
    }
    rule
}

/// The Legendre polynomial of degree n and its derivative at x, by the three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (0.0, 1.0);
    for k in 1..=n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

/// A rule on a triangle, exact for polynomials of degree 2n - 2: barycentric points with weights that add up to 1. It is
/// the product of two Gauss rules on the square, collapsed onto the triangle.
pub fn triangle(n: usize) -> Vec<([f64; 3], f64)> {
    collapsed(n, 1)
}

/// The rule with its points drawn towards the first vertex: the distance from it is rho = s^grading with the Gauss points s.
/// A power of rho there becomes a higher power of s.
pub(crate) fn collapsed(n: usize, grading: i32) -> Vec<([f64; 3], f64)> {
    let rule = gauss(n);
    let mut points = Vec::with_capacity(n * n);
    for &(s, ws) in &rule {
        let rho = s.powi(grading);
        // 2 rho d(rho)
        let weight = 2.0 * f64::from(grading) * s.powi(2 * grading - 1) * ws;
        for &(t, wt) in &rule {
            points.push(([1.0 - rho, rho * (1.0 - t), rho * t], weight * wt));
        }
    }
    points
}
