//! The row of Lemma 3.2: the bounds over every field, and coercivity on random bodies.

use super::*;

use crate::bodies::{Body, Definition, bodies};
use crate::claim::{Claim, Outcome, model_checked, noticed};
use crate::claims::tensor;
use crate::claims::theorem_3_3::one_triangle;
use crate::draws;
use crate::elimination::{Inertia, combined, inertia};
use crate::numbers::Exact;
use crate::statement::take;

/// Puts a unit vector at a place of the data.
fn put_unit(v: &mut [Exact], at: usize) {
    [v[at], v[at + 1]] = v[at].on_circle();
}

/// The constant one part in a hundred smaller.
fn smaller_constant() -> Outcome {
    draws::reject(bodies(1), |draw| coercive_for_all::<3>(&draw.body(), Exact::ratio(99, 100)))?;
    draws::reject(bodies(1), |draw| coercive_for_all::<6>(&draw.body(), Exact::ratio(99, 100)))
}

/// kappa with lambda + 2 mu of the isotropic law nearest to the tensor.
fn nearest_law() -> Outcome {
    draws::reject(bodies(1), |draw| {
        let body = draw.body();
        given!(!body.material.is_isotropic());
        let nearest = body.material.lambda() + Exact::from(2) * body.material.mu();
        let n = Vector2::from(body.contact[0].n);
        // A constant that is too large loses the equality only: that is no mistake.
        match coercive_for_all::<3>(&body, nearest / body.material.normal_stiffness(n)) {
            Verdict::Fails("zero == 4") => Verdict::Vacuous,
            verdict => verdict,
        }
    })
}

/// (11) on each triangle and Lemma 3.2 on the body for all fields, the free nodes and all others: kappa_T K_T - S_T and
/// A - (1 - kappa) K = kappa K - S have no negative eigenvalue. Equality in (11) shows as a zero eigenvalue beside the
/// three of the rigid motions. `factor` multiplies the constant.
fn coercive_for_all<const N: usize>(body: &Body, factor: Exact) -> Verdict {
    let definition = Definition::<N>(body);
    let kappa = factor * body.gamma0 * definition.coercivity();
    let nodes = body.node_count(N / 3);
    let zero = Exact::from(0);
    let mut whole = vec![vec![zero; 2 * nodes]; 2 * nodes];
    let mut attained = "two contact edges each";
    for t in 0..body.triangles.len() {
        let numbers = body.nodes::<N>(t).map(|node| [2 * node, 2 * node + 1]);
        let numbers = numbers.as_flattened();
        let [k, s] = definition.matrices_on(t);
        for (i, &row) in numbers.iter().enumerate() {
            for (j, &column) in numbers.iter().enumerate() {
                whole[row][column] = whole[row][column] + kappa * k[i][j] - s[i][j];
            }
        }
        let edges = body.contact.iter().filter(|side| side.triangle == t).count();
        if edges > 0 {
            let bound = factor * body.gamma0 * definition.coercivity_of(t);
            let Inertia { zero, negative, .. } = inertia(&combined(bound, &k, -Exact::from(1), &s));
            ensure!(negative == 0);
            if edges == 1 {
                ensure!(zero == 4);
                attained = "attained";
            }
        }
    }
    ensure!(inertia(&whole).negative == 0);
    Verdict::Holds(attained)
}

fn coercive<const N: usize>(cases: u32) -> Outcome {
    draws::hold(cases, bodies(1), &["attained"], |draw| {
        coercive_for_all::<N>(&draw.body(), Exact::from(1))
    })
}

/// A(u, u) > 0 at u = (1, 0) on the triangle of row 10, whose limit is 2/15: u is open, and A(u, u) the first number of the left side.
fn positive_on_the_triangle(gamma0: (i64, i64)) -> Outcome {
    Exact::scope(|| {
        let [one, zero] = [1, 0].map(Exact::from);
        let [work, _] = one_triangle([one, zero], Exact::ratio(gamma0.0, gamma0.1));
        let said = format!("A(u, u) = {work:?}");
        if work > zero { Ok(said) } else { Err(said) }
    })
}

/// The row of Lemma 3.2.
pub fn claim() -> Claim {
    Claim {
        id: "9",
        title: "Coercivity with an explicit constant",
        paper: "",
        limits: "How sharp the constant is on larger meshes, but in doubles (`docs/parameters.md`, `props/tests/program/sharpness.rs`).",
        checks: [
            statements! {
                proved + tested stress_is_hookes_law[xx, xy, yx, yy, nx, ny, lambda, mu] about "(1)";
                proved + tested normal_stress_of_a_shape_is_n_sigma_n[gx, gy, vx, vy, nx, ny, lambda, mu]
                    prepared(|v| put_unit(v, 4));
                proved + tested normal_stress_is_bounded_by_the_energy[xx, xy, yx, yy, nx, ny, lambda, mu]
                    about "Lemma 3.2", "(11)" hints(|v| other_strains(take(&v[..6])).to_vec());
                proved + tested the_constant_is_attained_by_a_strain_along_the_normal[c, nx, ny, lambda, mu]
                    prepared(|v| put_unit(v, 1));
                proved + tested plane_stress_has_its_own_lambda[lambda, mu, xx, yy, xy];
                proved + tested trace_inequality_holds_with_the_constants_of_p1_and_p2[a, b, c]
                    about "Lemma 3.2", "(11)", "Remark 3.7";
                proved + tested the_trace_constant_of_p2_is_attained[b];
                proved + tested the_trace_bound_gives_coercivity[a, s, kappa] about "Lemma 3.2";
                refuted control_lambda_plus_mu_for_the_stiffness[xx, xy, yx, yy, lambda, mu]
                    fails "yy * yy <= (lambda + mu) * energy_density(stress, g)";
                refuted control_smaller_trace_constant[a, b, c] fails "edge <= constant * triangle";
            },
            vec![
                exact!("11_and_coercivity_hold_for_all_fields_for_p1", in coercive_for_all, draws 30 => coercive::<3>(30)).about(&["Lemma 3.2", "(11)"]),
                exact!("11_and_coercivity_hold_for_all_fields_for_p2", in coercive_for_all, draws 8 => coercive::<6>(8)).about(&["Lemma 3.2", "(11)", "Remark 3.7"]),
                exact!("control_constant_one_percent_smaller", in smaller_constant => smaller_constant()),
                exact!("control_the_nearest_isotropic_law_for_a_nnnn", in nearest_law => nearest_law()),
                exact!("a_gamma_is_positive_on_a_triangle_below_its_limit", in positive_on_the_triangle => positive_on_the_triangle((1, 15))),
                // With gamma0 = 8/5 it is -2/3.
                exact!("control_coercivity_beyond_the_limit", at positive_on_the_triangle => noticed(positive_on_the_triangle((8, 5)))),
            ],
            tensor::checks(),
            model_checked(HARNESSES, &["Lemma 3.2", "(11)"]),
        ]
        .concat(),
    }
}
