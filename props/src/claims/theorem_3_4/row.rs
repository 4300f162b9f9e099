//! The row of Theorem 3.4: the steps of its proof run over symbols, rationals, quantities with dimensions and doubles.

use super::*;
use crate::claim::{Claim, Outcome};
use crate::numbers::Exact;

/// The exact points that refute (17) and (18) as printed; with the factor gamma both hold there.
fn errata_points() -> Outcome {
    Exact::scope(|| {
        let of = |v: &[i64]| -> Vec<Exact> { v.iter().map(|&n| Exact::ratio(n, 4)).collect() };
        let array = |v: &[i64]| -> [Exact; 6] { of(v).try_into().expect("six numbers") };
        let v = array(&[8, 0, -4, 0, 0, 0]);
        if !control_step_17_as_printed(v).fails() || step_17_holds_with_the_factor_gamma(v).fails()
        {
            return Err("(17) at gamma = 2, sigma_n(u) = -1".to_owned());
        }
        let v: [Exact; 4] = of(&[4, 4, 1, 4]).try_into().expect("four numbers");
        if !control_step_18_as_printed(v).fails() || step_18_holds_with_the_factor_gamma(v).fails()
        {
            return Err("(18) at z = 1, d = 1, gamma = 1/4, beta = 1".to_owned());
        }
        Ok("(17): gamma = 2, sigma_n(u) = -1, the rest 0: 2 <= 1 as printed, 2 <= 2 corrected; \
            (18): z = d = beta = 1, gamma = 1/4: 1 <= 1/4 as printed, 1/4 <= 1/4 corrected"
            .to_owned())
    })
}

/// W on its equation: collinear e and eta, c = e h, W = |e - h|, and r, t within their bounds.
fn onto_raw_facts(v: &mut [Exact]) {
    let one = Exact::from(1);
    for i in [0, 1, 4] {
        v[i] = v[i].abs();
    }
    v[7] = v[7].abs() / (one + v[7].abs());
    let sign = if v[3] > Exact::from(0) { one } else { -one };
    v[3] = sign * v[0] * v[1];
    v[2] = (v[0] - sign * v[1]).abs();
    v[5] = v[7] * v[2] / (one + v[5].abs());
    v[6] = v[5] * v[4] - v[6].abs();
}

/// The row of Theorem 3.4.
pub fn claim() -> Claim {
    Claim {
        id: "11",
        title: "The abstract error estimate, with its constant",
        paper: "",
        limits: "",
        checks: [
            statements! {
                proved + tested error_identity_holds_at_a_point[gamma, g, u, su, uh, sh, v, sv]: "pressed", "open"
                    about "Theorem 3.4";
                proved + tested z_times_the_difference_of_p_is_at_most_minus_gamma_z_squared[gamma, g, u, su, uh, sh]
                    : "pressed", "open" about "Theorem 3.4";
                proved + tested raw_facts_give_the_inequality_between_norms[e, h, w, c, s, r, t, k]
                    about "Theorem 3.4" prepared(onto_raw_facts);
                proved + tested theorem_3_4_holds_with_its_constant[e, h, z, s, r, k] about "Theorem 3.4", "(13)";
                proved corollary_3_6_holds_with_its_constant[x, s, r, w, e, h, k] about "Corollary 3.6";
                proved + tested step_14_holds[gamma, uh, sh, v, sv]: "pressed", "open" about "(14)";
                proved + tested step_15_holds[gamma, u, su, uh, sh, v]: "pressed", "open" about "(15)";
                proved + tested step_16_holds[z, d, gamma, beta] about "(16)"
                    hints(|v| vec![v[2] * v[0] - v[3] * v[1]]);
                proved + tested step_17_holds_with_the_factor_gamma[gamma, u, su, uh, sh, sv]: "pressed", "open"
                    about "(17)";
                proved + tested step_18_holds_with_the_factor_gamma[z, d, gamma, beta] about "(18)";
                proved step_19_holds_with_its_constants[a, s, r, w, e, h, k] about "(19)";
                proved step_20_is_the_sum_of_17_18_and_19[t, z, first, second, s, e, h, c, beta] about "(20)";
                proved three_facts_give_the_hypothesis_of_theorem_3_4[e, h, z, s, big, k, c, d, q, r, t]
                    about "Theorem 3.4";
                proved estimate_14_holds[alpha, big, n, m, b, c, l, i, j, p, q, r] about "(14)"
                    hints(|v| vec![v[0] * v[2] - v[1] * v[3]]);
                proved the_last_estimate_follows_from_15_16_and_20[alpha, big, gamma0, n, m, z, s, d, i, t, b1, b2]
                    about "(20)";
                proved the_last_estimate_bounds_both_errors[alpha, big, gamma0, n, z, right] about "(20)";
                refuted control_three_facts_without_the_square_of_z[e, h, z, s, big, k, c, d, q, r, t]
                    fails "combined([e, h, z, s, big, k]) >= zero";
                refuted control_last_estimate_without_beta_2[alpha, big, gamma0, n, m, z, s, d, i, t, b1, b2]
                    fails "left <= (first + second) * m + b1 / two * d + (big + b2 / two) * s";
                refuted control_step_17_as_printed[gamma, u, su, uh, sh, sv]
                    fails "t + gamma * z * z <= factor * z * (su - sv) + gamma * (su - sh) * (sv - sh)";
                refuted control_step_18_as_printed[z, d, gamma, beta]
                    fails "factor * z * d <= gamma * z * z / (two * beta) + beta * gamma * d * d / two";
                refuted control_z_inequality_without_5[gamma, g, u, su, uh, sh]
                    fails "z * (point.exact.p() - point.discrete.p()) <= -gamma * z * z";
                refuted control_half_the_constant_of_theorem_3_4[e, h, z, s, r, k] fails "left <= factor * bracket";
                refuted control_step_15_with_penetration[gamma, u, su, uh, sh, v]
                    fails "before <= kept";
            },
            vec![
                exact!("control_17_and_18_as_printed_at_exact_points", in errata_points => errata_points()),
            ],
        ]
        .concat(),
    }
}
