//! Lemma 3.2 and (11) with the explicit constant kappa = gamma0 h_T c_p (lambda + 2 mu) |E| / |T|: at a point, on an edge.
//!
//! At a point sigma_n^2 <= (lambda + 2 mu) sigma:eps, because the difference is a sum of squares: with t the normal turned
//! by a right angle, and for a normal of any length,
//!
//! ```text
//! (lambda + 2 mu) |n|^4 sigma:eps - (n.sigma n)^2 = 4 mu (lambda + mu) eps_tt^2 + 4 mu (lambda + 2 mu) eps_nt^2
//! ```
//!
//! On an edge the trace inequality |w|_E^2 <= c_p (|E|/|T|) |w|_T^2 for polynomials w of degree p - 1: c_1 = 1, c_2 = 3.

use signorini::kernel::{Element, Material, P1, P2, Plane, Stress};

use crate::verdict::{Ordered, Verdict};
use crate::{ensure, given};

/// sigma:eps for the stress that belongs to a displacement gradient.
fn energy_density<S: Ordered>(stress: Stress<S>, g: [[S; 2]; 2]) -> S {
    stress.xx * g[0][0] + stress.yy * g[1][1] + stress.xy * (g[0][1] + g[1][0])
}

fn gradient<S>([xx, xy, yx, yy]: [S; 4]) -> [[S; 2]; 2] {
    [[xx, xy], [yx, yy]]
}

/// (1): sigma = lambda tr(eps) I + 2 mu eps with eps = (grad u + grad u^T)/2; sigma_n = n.sigma n; traction sigma n;
/// the normal stress of a shape function, for a unit normal.
pub fn stress_is_hookes_law<S: Ordered>([xx, xy, yx, yy, nx, ny, lambda, mu]: [S; 8]) -> Verdict {
    let two = S::from(2);
    let material = Material::lame(lambda, mu, Plane::Strain);
    ensure!(material.lambda() == lambda && material.mu() == mu);
    let stress = material.stress(gradient([xx, xy, yx, yy]));
    let (exx, eyy, exy) = (xx, yy, (xy + yx) / two);
    ensure!(stress.xx == lambda * (exx + eyy) + two * mu * exx);
    ensure!(stress.yy == lambda * (exx + eyy) + two * mu * eyy);
    ensure!(stress.xy == two * mu * exy);
    let traction = stress.traction([nx, ny]);
    ensure!(traction[0] == stress.xx * nx + stress.xy * ny);
    ensure!(traction[1] == stress.xy * nx + stress.yy * ny);
    ensure!(stress.normal([nx, ny]) == traction[0] * nx + traction[1] * ny);
    Verdict::Holds("always")
}

/// The functional sigma_n of one shape function: its value at v = N (v_x, v_y) is sigma_n of the gradient v x grad N.
pub fn normal_stress_of_a_shape_is_n_sigma_n<S: Ordered>(
    [gx, gy, vx, vy, nx, ny, lambda, mu]: [S; 8],
) -> Verdict {
    given!(nx * nx + ny * ny == S::from(1));
    let material = Material::lame(lambda, mu, Plane::Strain);
    let functional = material.normal_stress_of_shape([gx, gy], [nx, ny]);
    let stress = material.stress([[vx * gx, vx * gy], [vy * gx, vy * gy]]);
    ensure!(functional[0] * vx + functional[1] * vy == stress.normal([nx, ny]));
    Verdict::Holds("always")
}

/// eps_tt and eps_nt, times |n|^2.
fn other_strains<S: Ordered>([xx, xy, yx, yy, nx, ny]: [S; 6]) -> [S; 2] {
    let two = S::from(2);
    let exy = (xy + yx) / two;
    [
        ny * ny * xx - two * nx * ny * exy + nx * nx * yy,
        nx * ny * (yy - xx) + (nx * nx - ny * ny) * exy,
    ]
}

/// The inequality at a point for a candidate of its constant and any normal, by the identity above.
fn bounded<S: Ordered>(
    [xx, xy, yx, yy, nx, ny, lambda, mu]: [S; 8],
    constant: impl Fn(&Material<S>) -> S,
) -> Verdict {
    let (zero, two, four) = (S::from(0), S::from(2), S::from(4));
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let g = gradient([xx, xy, yx, yy]);
    let stress = material.stress(g);
    let (sigma_n, squared) = (stress.normal([nx, ny]), nx * nx + ny * ny);
    let [tt, nt] = other_strains([xx, xy, yx, yy, nx, ny]);
    let left = constant(&material) * squared * squared * energy_density(stress, g);
    let rest = left - sigma_n * sigma_n;
    ensure!(
        rest == four * mu * (lambda + mu) * tt * tt + four * mu * (lambda + two * mu) * nt * nt
    );
    ensure!(mu * (lambda + mu) > zero && mu * (lambda + two * mu) > zero);
    ensure!(mu * (lambda + mu) * (tt * tt) >= zero);
    ensure!(mu * (lambda + two * mu) * (nt * nt) >= zero);
    ensure!(sigma_n * sigma_n <= left);
    Verdict::Holds("always")
}

/// |n|^4 (lambda + 2 mu) sigma:eps >= sigma_n^2 for every n.
pub fn normal_stress_is_bounded_by_the_energy<S: Ordered>(v: [S; 8]) -> Verdict {
    bounded(v, Material::normal_stiffness)
}

/// With n = e_y, as in the paper's proof.
pub fn normal_stress_on_a_horizontal_edge_is_bounded_by_the_energy<S: Ordered>(
    [xx, xy, yx, yy, lambda, mu]: [S; 6],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let g = gradient([xx, xy, yx, yy]);
    let stress = material.stress(g);
    ensure!(stress.yy * stress.yy <= material.normal_stiffness() * energy_density(stress, g));
    Verdict::Holds("always")
}

/// A strain along the normal attains it: the constant can't be smaller.
pub fn the_constant_is_attained_by_a_strain_along_the_normal<S: Ordered>(
    [c, nx, ny, lambda, mu]: [S; 5],
) -> Verdict {
    given!(nx * nx + ny * ny == S::from(1));
    let material = Material::lame(lambda, mu, Plane::Strain);
    let g = [[c * nx * nx, c * nx * ny], [c * nx * ny, c * ny * ny]];
    let stress = material.stress(g);
    let sigma_n = stress.normal([nx, ny]);
    ensure!(sigma_n * sigma_n == material.normal_stiffness() * energy_density(stress, g));
    Verdict::Holds("always")
}

/// Plane stress is plane strain with lambda* = 2 lambda mu / (lambda + 2 mu), for which the inequality holds too: its
/// constant is 4 mu (lambda + mu)/(lambda + 2 mu), and lambda* + mu > 0 if 3 lambda + 2 mu > 0. sigma_zz and the von
/// Mises stress belong to it.
pub fn plane_stress_has_its_own_lambda<S: Ordered>([lambda, mu, xx, yy, xy]: [S; 5]) -> Verdict {
    let (zero, two) = (S::from(0), S::from(2));
    given!(mu > zero && S::from(3) * lambda + two * mu > zero);
    ensure!(lambda + two * mu > zero);
    let material = Material::lame(lambda, mu, Plane::Stress);
    let star = two * lambda * mu / (lambda + two * mu);
    ensure!(material.lambda() == star && material.mu() == mu);
    let constant = material.normal_stiffness() * (lambda + two * mu);
    ensure!(constant == S::from(4) * mu * (lambda + mu));
    ensure!((star + mu) * (lambda + two * mu) == mu * (S::from(3) * lambda + two * mu));
    ensure!((star + mu) * (lambda + two * mu) > zero);
    ensure!(star + mu > zero);
    let stress = Stress { xx, yy, xy };
    ensure!(material.stress_zz(stress) == zero);
    let mises = xx * xx - xx * yy + yy * yy + S::from(3) * xy * xy;
    ensure!(material.von_mises_squared(stress) == mises);
    Verdict::Holds("always")
}

/// Plane strain: sigma_zz = lambda tr(eps), and the von Mises stress with it is (3/2) s:s of the deviator s.
pub fn plane_strain_has_a_stress_across_the_plane<S: Ordered>(
    [lambda, mu, exx, eyy, exy]: [S; 5],
) -> Verdict {
    let (zero, two, three) = (S::from(0), S::from(2), S::from(3));
    given!(mu > zero && lambda + mu > zero);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let stress = material.stress([[exx, exy], [exy, eyy]]);
    let zz = material.stress_zz(stress);
    ensure!(zz == lambda * (exx + eyy));
    let mean = (stress.xx + stress.yy + zz) / three;
    let (a, b, c) = (stress.xx - mean, stress.yy - mean, zz - mean);
    let deviator = a * a + b * b + c * c + two * stress.xy * stress.xy;
    ensure!(two * material.von_mises_squared(stress) == three * deviator);
    Verdict::Holds("always")
}

/// Young's modulus and Poisson's ratio: the bar that is pulled along x and free across it.
pub fn young_and_poisson_are_those_of_a_bar<S: Ordered>([young, poisson, e]: [S; 3]) -> Verdict {
    let (zero, one, two) = (S::from(0), S::from(1), S::from(2));
    given!(young > zero && poisson > -one && two * poisson < one);
    let plate = Material::young_poisson(young, poisson, Plane::Strain);
    let (lambda, mu) = (plate.lambda(), plate.mu());
    // sigma = lambda tr I + 2 mu eps in three dimensions, eps = e diag(1, -nu, -nu)
    let trace = e * (one - two * poisson);
    ensure!(lambda * trace + two * mu * e == young * e);
    ensure!(lambda * trace - two * mu * poisson * e == zero);
    Verdict::Holds("always")
}

/// The trace inequality on an edge with the ends b, c of the triangle with the values a, b, c of an affine w:
/// |w|_E^2 = |E| (b^2 + b c + c^2)/3, |w|_T^2 = |T| (a^2 + b^2 + c^2 + a b + b c + c a)/6.
fn trace_inequality<S: Ordered>([a, b, c]: [S; 3], constant: S) -> Verdict {
    let edge = (b * b + b * c + c * c) / S::from(3);
    let triangle = (a * a + b * b + c * c + a * b + b * c + c * a) / S::from(6);
    ensure!(edge <= constant * triangle);
    Verdict::Holds("always")
}

/// c_2 = 3 for P2, whose stress is affine; c_1 = 1 for P1, whose stress is constant.
pub fn trace_inequality_holds_with_the_constants_of_p1_and_p2<S: Ordered>(
    [a, b, c]: [S; 3],
) -> Verdict {
    let constant = trace_inequality([a, a, a], S::from(<P1 as Element<3, 2>>::TRACE_CONSTANT));
    ensure!(!constant.fails());
    trace_inequality([a, b, c], S::from(<P2 as Element<6, 3>>::TRACE_CONSTANT))
}

/// w = 1 on the edge and -1 at the opposite vertex attains it: 3 can't be smaller.
pub fn the_trace_constant_of_p2_is_attained<S: Ordered>([b]: [S; 1]) -> Verdict {
    given!(b > S::from(0) || b < S::from(0));
    let c = S::from(<P2 as Element<6, 3>>::TRACE_CONSTANT);
    let triangle = (S::from(3) * b * b - b * b) / S::from(6);
    ensure!(b * b == c * triangle);
    Verdict::Holds("always")
}

/// Coercivity from (11), as in the proof: a - s >= (1 - kappa) a if s <= kappa a.
pub fn the_trace_bound_gives_coercivity<S: Ordered>([a, s, kappa]: [S; 3]) -> Verdict {
    given!(s <= kappa * a);
    ensure!(a - s >= (S::from(1) - kappa) * a);
    Verdict::Holds("always")
}

/// lambda + mu in place of lambda + 2 mu.
pub fn control_lambda_plus_mu_for_the_stiffness<S: Ordered>(
    [xx, xy, yx, yy, lambda, mu]: [S; 6],
) -> Verdict {
    let zero = S::from(0);
    given!(mu > zero && lambda + mu > zero);
    let g = gradient([xx, xy, yx, yy]);
    let stress = Material::lame(lambda, mu, Plane::Strain).stress(g);
    ensure!(stress.yy * stress.yy <= (lambda + mu) * energy_density(stress, g));
    Verdict::Holds("always")
}

/// c_2 = 2 in place of 3.
pub fn control_smaller_trace_constant<S: Ordered>(v: [S; 3]) -> Verdict {
    trace_inequality(v, S::from(2))
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use super::*;
    use crate::bodies::{Body, Kernel, MaybeExact, Side, bodies, positive_definite, sum};
    use crate::claim::{Claim, Engine, Outcome, by, control, proved, refuted, tested};
    use crate::draws;
    use crate::numbers::Exact;
    use crate::statement;
    use crate::statement::take;

    /// A unit vector from the first component: ((1 - t^2), 2 t)/(1 + t^2).
    fn unit(t: Exact) -> [Exact; 2] {
        let one = Exact::from(1);
        let norm = one + t * t;
        [(one - t * t) / norm, Exact::from(2) * t / norm]
    }

    fn unit_normal_at_4(v: &mut [Exact]) {
        [v[4], v[5]] = unit(v[4]);
    }

    fn unit_normal_at_1(v: &mut [Exact]) {
        [v[1], v[2]] = unit(v[1]);
    }

    /// (11) on each triangle and Lemma 3.2 on the body, for any field and for one that attains (11) on the triangles with
    /// one contact edge; `factor` multiplies the constant (1, or a planted smaller one).
    fn coercive<E, const N: usize, const M: usize>(body: &Body, factor: Exact) -> Verdict
    where
        E: MaybeExact<N, M>,
    {
        let kernel = Kernel::<N, M>::new::<E>(body);
        let on = |t: usize, v: &[[Exact; 2]]| {
            let owned = (0..body.contact.len()).filter(|&e| body.contact[e].triangle == t);
            sum(owned, |e| kernel.stress_product(e, v, v))
        };
        let v = body.drawn(0);
        for t in 0..body.triangles.len() {
            let bound = factor * kernel.kappa_of::<E>(t);
            ensure!(on(t, &v) <= bound * kernel.a_on(t, &v, &v));
        }
        let kappa = factor * kernel.kappa::<E>();
        let rest = kernel.big_a(&v, &v) - (Exact::from(1) - kappa) * kernel.a(&v, &v);
        ensure!(rest >= Exact::from(0));
        let mut attained = "two contact edges each";
        for side in &body.contact {
            let t = side.triangle;
            if body.contact.iter().filter(|other| other.triangle == t).count() == 1 {
                let v = along_the_normal::<N>(body, side);
                let bound = factor * kernel.kappa_of::<E>(t);
                ensure!(on(t, &v) == bound * kernel.a_on(t, &v, &v));
                attained = "attained";
            }
        }
        Verdict::Holds(attained)
    }

    /// A field with eps = c n x n on the triangle of a side: c = 1 for P1; for P2 c is affine, 1 on the edge and -1 at
    /// the opposite vertex.
    fn along_the_normal<const N: usize>(body: &Body, side: &Side) -> Vec<[Exact; 2]> {
        let n = side.n;
        let height = |x: [Exact; 2]| x[0] * n[0] + x[1] * n[1];
        let corners = body.triangles[side.triangle].map(|v| height(body.vertices[v]));
        let (edge, opposite) = (corners[(side.local + 1) % 3], corners[side.local]);
        body.interpolated(|x| {
            let depth = height(x) - edge;
            let v = match N {
                3 => depth,
                _ => depth - depth * depth / (opposite - edge),
            };
            n.map(|c| c * v)
        })
    }

    fn coercive_p1() -> Outcome {
        draws::hold(60, bodies(1), &["attained"], |draw| {
            Exact::scope(|| coercive::<P1, 3, 2>(&draw.body(), Exact::from(1)))
        })
    }

    fn coercive_p2() -> Outcome {
        draws::hold(20, bodies(1), &["attained"], |draw| {
            Exact::scope(|| coercive::<P2, 6, 3>(&draw.body(), Exact::from(1)))
        })
    }

    /// The constant one part in a hundred smaller.
    fn smaller_constant() -> Outcome {
        draws::reject(60, bodies(1), |draw| {
            Exact::scope(|| coercive::<P1, 3, 2>(&draw.body(), Exact::ratio(99, 100)))
        })?;
        draws::reject(60, bodies(1), |draw| {
            Exact::scope(|| coercive::<P2, 6, 3>(&draw.body(), Exact::ratio(99, 100)))
        })
    }

    /// A on the free nodes of a body with gamma0 = ratio / C_h is positive definite.
    fn definite(body: &mut Body, limit: Exact, ratio: Exact) -> bool {
        body.gamma0 = ratio * limit;
        let kernel = Kernel::<3, 2>::new::<P1>(body);
        let free = (0..body.vertices.len()).filter(|v| !body.top.contains(v));
        let unit = [[1, 0], [0, 1]].map(|d| d.map(Exact::from));
        let basis: Vec<_> = free.flat_map(|v| unit.map(|d| body.bump(v, d))).collect();
        let row = |u: &Vec<[Exact; 2]>| basis.iter().map(|v| kernel.big_a(u, v)).collect();
        positive_definite(basis.iter().map(row).collect())
    }

    /// The ratio gamma0* C_h at which A ceases to be positive definite, between 1 and 64, to 1/256 of itself.
    fn lost_at(body: &mut Body) -> Result<f64, String> {
        body.gamma0 = Exact::from(1);
        let limit = Exact::from(1) / Kernel::<3, 2>::new::<P1>(body).kappa::<P1>();
        if !definite(body, limit, Exact::ratio(255, 256)) {
            return Err("not positive definite below the limit".to_owned());
        }
        let (mut low, mut high) = (256, 256 * 64);
        if definite(body, limit, Exact::ratio(high, 256)) {
            return Err("still positive definite at 64 times the limit".to_owned());
        }
        while high - low > 1 + low / 256 {
            let middle = (low + high) / 2;
            let kept = definite(body, limit, Exact::ratio(middle, 256));
            (low, high) = if kept { (middle, high) } else { (low, middle) };
        }
        Ok(high as f64 / 256.0)
    }

    /// How sharp the limit is, on bodies clamped at the top: cells with a diagonal to the right, and the trapezoid
    /// (-3, 0), (3, 0), (0, 4), (e, 4), which attains it as e goes to 0.
    fn sharpness() -> Outcome {
        Exact::scope(|| {
            let at = |points: &[[i64; 2]], d: i64| -> Vec<[Exact; 2]> {
                points.iter().map(|p| p.map(|c| Exact::ratio(c, d))).collect()
            };
            let one = Exact::from(1);
            let square = at(&[[0, 0], [1, 0], [0, 1], [1, 1]], 1);
            let flat = at(&[[0, 0], [4, 0], [0, 1], [4, 1]], 1);
            let cells: &[[usize; 3]] = &[[0, 1, 3], [0, 3, 2]];
            let mut text = Vec::new();
            for (name, vertices, triangles) in [
                ("square", square, cells),
                ("cell 4:1", flat, cells),
                (
                    "trapezoid, e = 1/10",
                    at(&[[-30, 0], [30, 0], [0, 40], [1, 40]], 10),
                    &[[0, 1, 2], [1, 3, 2]],
                ),
                (
                    "trapezoid, e = 1/100",
                    at(&[[-300, 0], [300, 0], [0, 400], [1, 400]], 100),
                    &[[0, 1, 2], [1, 3, 2]],
                ),
            ] {
                let mut body = Body::explicit(&vertices, triangles, &[2, 3], one, one);
                text.push(format!("{name} {:.3}", lost_at(&mut body)?));
            }
            Ok(format!("gamma0* C_h: {}", text.join(", ")))
        })
    }

    /// The triangle (0, 0), (3, 0), (0, 4) with only (3, 0) free: its limit is 2/15, and with gamma0 = 8/5 A is
    /// diag(-2/3, 2/3) there.
    fn lost_beyond_the_limit() -> Outcome {
        Exact::scope(|| {
            let vertices = [[0, 0], [3, 0], [0, 4]].map(|p| p.map(Exact::from));
            let gamma0 = Exact::ratio(8, 5);
            let body = Body::explicit(&vertices, &[[0, 1, 2]], &[0, 2], Exact::from(5), gamma0);
            let kernel = Kernel::<3, 2>::new::<P1>(&body);
            let [x, y] = [[1, 0], [0, 1]].map(|d| body.bump(1, d.map(Exact::from)));
            let a = [kernel.big_a(&x, &x), kernel.big_a(&x, &y), kernel.big_a(&y, &y)];
            if kernel.kappa::<P1>() == Exact::from(12)
                && a == [Exact::ratio(-2, 3), Exact::from(0), Exact::ratio(2, 3)]
            {
                Ok("kappa = 12, A = diag(-2/3, 2/3)".to_owned())
            } else {
                Err(format!("kappa = {:?}, A = {a:?}", kernel.kappa::<P1>()))
            }
        })
    }

    /// The row of Lemma 3.2.
    pub fn claim() -> Claim {
        let hooke =
            statement!(stress_is_hookes_law, [xx, xy, yx, yy, nx, ny, lambda, mu], ["always"]);
        let shape = statement!(
            normal_stress_of_a_shape_is_n_sigma_n,
            [gx, gy, vx, vy, nx, ny, lambda, mu],
            ["always"]
        )
        .prepared(unit_normal_at_4);
        let any = statement!(
            normal_stress_is_bounded_by_the_energy,
            [xx, xy, yx, yy, nx, ny, lambda, mu],
            ["always"]
        )
        .with_hints(|v| other_strains(take(&v[..6])).to_vec());
        let horizontal = statement!(
            normal_stress_on_a_horizontal_edge_is_bounded_by_the_energy,
            [xx, xy, yx, yy, lambda, mu],
            ["always"]
        )
        .with_hints(|v| vec![v[0], v[1] + v[2]]);
        let attained = statement!(
            the_constant_is_attained_by_a_strain_along_the_normal,
            [c, nx, ny, lambda, mu],
            ["always"]
        )
        .prepared(unit_normal_at_1);
        let stress =
            statement!(plane_stress_has_its_own_lambda, [lambda, mu, xx, yy, xy], ["always"]);
        let strain = statement!(
            plane_strain_has_a_stress_across_the_plane,
            [lambda, mu, exx, eyy, exy],
            ["always"]
        );
        let bar = statement!(young_and_poisson_are_those_of_a_bar, [young, poisson, e], ["always"]);
        let trace = statement!(
            trace_inequality_holds_with_the_constants_of_p1_and_p2,
            [a, b, c],
            ["always"]
        );
        let sharp = statement!(the_trace_constant_of_p2_is_attained, [b], ["always"]);
        let coercive = statement!(the_trace_bound_gives_coercivity, [a, s, kappa], ["always"]);
        let all =
            [hooke, shape, any, horizontal, attained, stress, strain, bar, trace, sharp, coercive];
        let mut checks: Vec<_> = all.into_iter().map(proved).collect();
        checks.extend(all.into_iter().map(tested));
        checks.extend([
            refuted(statement!(
                control_lambda_plus_mu_for_the_stiffness,
                [xx, xy, yx, yy, lambda, mu],
                []
            )),
            refuted(statement!(control_smaller_trace_constant, [a, b, c], [])),
            by(Engine::Exact, "11_and_coercivity_hold_on_random_bodies_for_p1", coercive_p1),
            by(Engine::Exact, "11_and_coercivity_hold_on_random_bodies_for_p2", coercive_p2),
            by(Engine::Exact, "coercivity_is_lost_close_beyond_the_limit", sharpness),
            control(Engine::Exact, "control_constant_one_percent_smaller", smaller_constant),
            control(Engine::Exact, "control_coercivity_beyond_the_limit", lost_beyond_the_limit),
        ]);
        Claim {
            id: "9",
            items: &["(1)", "Lemma 3.2", "(11)"],
            title: "Coercivity with an explicit constant",
            paper: "Let gamma0 be sufficiently small. Then A_gamma is elliptic on V^h. In the proof: |gamma^1/2 sigma_n(v^h)|^2 <= C gamma0 |v^h|_1^2 (11).",
            statement: "sigma_n(v)^2 <= (lambda + 2 mu) sigma(v):eps(v) at every point, with equality for a strain along the normal; |w|_E^2 <= c_p (|E|/|T|) |w|_T^2 for polynomials of degree p - 1, c_1 = 1, c_2 = 3, attained. On random bodies, for P1 and P2 and with kappa_T = gamma0 h_T c_p (lambda + 2 mu) |E|/|T|: int_E gamma sigma_n(v)^2 <= kappa_T a_T(v, v), attained on every triangle with one contact edge, and A(v, v) >= (1 - kappa) a(v, v). A on the whole body is positive definite up to the limit, and on the bodies tried it ceases to be so at 1.00 to 1.14 times the limit: the limit is sharp.",
            numbers: "every ordered field (proof); rationals.",
            kernel: &[
                "contact_edge::coercivity_constant",
                "material::Material::lame",
                "material::Material::young_poisson",
                "material::Material::lambda",
                "material::Material::mu",
                "material::Material::normal_stiffness",
                "material::Material::stress",
                "material::Material::stress_zz",
                "material::Material::von_mises_squared",
                "material::Material::normal_stress_of_shape",
                "material::Stress::normal",
                "material::Stress::traction",
            ],
            preconditions: "mu > 0 and lambda + mu > 0 (in plane stress 3 lambda + 2 mu > 0), which every elastic material satisfies. The paper says 'gamma0 sufficiently small'; here the limit is a number.",
            limits: "Korn's inequality, which turns a(v, v) into |v|_1^2, is not checked.",
            single: None,
            checks,
        }
    }
}
