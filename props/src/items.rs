//! The numbered items of the paper, and for each the checks that are about it. Only these stand behind an item: that a row
//! names it does not say that each check of the row does.

use crate::claim::{Check, Claim};

/// A numbered item of the paper.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Its number, or a name for what the paper has not.
    pub name: &'static str,
    /// What it says, in a few words.
    pub says: &'static str,
    /// What stands behind it.
    pub basis: Basis,
}

/// What stands behind an item.
#[derive(Clone, Copy, Debug)]
pub enum Basis {
    /// Checks: the id of a row and names of checks in it.
    Checks(&'static [(&'static str, &'static [&'static str])]),
    /// It is taken from the literature: by whom, and where it is a hypothesis.
    Literature(&'static str),
    /// What is checked of it, and what is taken from analysis or from the literature.
    Both(&'static [(&'static str, &'static [&'static str])], &'static str),
}

impl Item {
    /// Rows and names of checks.
    pub fn checks(&self) -> &'static [(&'static str, &'static [&'static str])] {
        match self.basis {
            Basis::Checks(checks) | Basis::Both(checks, _) => checks,
            Basis::Literature(_) => &[],
        }
    }

    /// What is not checked.
    pub fn literature(&self) -> Option<&'static str> {
        match self.basis {
            Basis::Checks(_) => None,
            Basis::Literature(text) | Basis::Both(_, text) => Some(text),
        }
    }

    /// The checks themselves, controls apart, with their rows.
    pub fn found<'a>(&self, claims: &'a [Claim]) -> Vec<(&'a Claim, &'a Check)> {
        let mut found = Vec::new();
        for (row, names) in self.checks() {
            let claim = claims.iter().filter(|claim| claim.id == *row);
            let of = claim.flat_map(|claim| claim.checks.iter().map(move |check| (claim, check)));
            found.extend(of.filter(|(_, check)| !check.control && names.contains(&check.name)));
        }
        found
    }
}

/// All of them, in the order of the paper.
pub const ITEMS: &[Item] = &[
    Item {
        name: "(1)",
        says: "equilibrium, Hooke's law, boundary conditions",
        basis: Basis::Both(
            &[
                ("9", &["stress_is_hookes_law"]),
                ("4", &["green_and_6_hold_at_affine_solutions_for_p1"]),
                ("8", &["formulas_at_the_end_of_contact_satisfy_1"]),
            ],
            "Green's formula for fields that are not piecewise polynomial; the boundary conditions away from Gamma_C, but on bodies with affine fields; tensors A that are not isotropic",
        ),
    },
    Item {
        name: "(2)",
        says: "the contact conditions",
        basis: Basis::Checks(&[
            ("2", &["conditions_2_are_equation_5", "violation_is_zero_exactly_where_2_holds"]),
            ("8", &["formulas_at_the_end_of_contact_satisfy_2"]),
        ]),
    },
    Item {
        name: "(3)",
        says: "the variational inequality",
        basis: Basis::Both(
            &[(
                "16",
                &[
                    "conditions_2_give_the_sign_of_3",
                    "the_sign_of_3_gives_conditions_2",
                    "inequality_3_holds_at_affine_solutions_on_random_bodies",
                ],
            )],
            "that it has one solution (Stampacchia)",
        ),
    },
    Item {
        name: "(4)",
        says: "a <= [a]+, a [a]+ = [a]+^2",
        basis: Basis::Checks(&[("1", &["positive_part_satisfies_4"])]),
    },
    Item {
        name: "Proposition 2.1",
        says: "(2)(i)-(iii) are equivalent to (5)",
        basis: Basis::Checks(&[("2", &["conditions_2_are_equation_5"])]),
    },
    Item {
        name: "(5)",
        says: "sigma_n = -(1/gamma)[u_n - gamma sigma_n]+",
        basis: Basis::Checks(&[(
            "2",
            &[
                "conditions_2_are_equation_5",
                "contact_functions_are_their_definitions",
                "conditions_2_imply_the_scaled_equation",
                "scaled_equation_implies_2_up_to_rounding",
            ],
        )]),
    },
    Item {
        name: "Remark 2.2",
        says: "gamma may be a function",
        basis: Basis::Checks(&[(
            "3",
            &["conditions_2_are_equation_5", "equation_5_does_not_depend_on_gamma"],
        )]),
    },
    Item {
        name: "(6)",
        says: "Nitsche's form of Green's formula",
        basis: Basis::Both(
            &[(
                "4",
                &["green_terms_rearrange_to_6", "green_and_6_hold_at_affine_solutions_for_p1"],
            )],
            "Green's formula for fields that are not piecewise affine",
        ),
    },
    Item {
        name: "(7)",
        says: "gamma = gamma0 h_T",
        basis: Basis::Checks(&[(
            "5",
            &[
                "diameters_lengths_and_normals_of_the_solver_are_those_of_the_edges",
                "gamma_of_the_solver_is_gamma0_times_the_diameter",
            ],
        )]),
    },
    Item {
        name: "Remark 2.3",
        says: "(8) holds formally for the exact solution",
        basis: Basis::Both(
            &[("4", &["green_terms_rearrange_to_6"])],
            "the regularity that the formula asks for",
        ),
    },
    Item {
        name: "(8)",
        says: "the method",
        basis: Basis::Checks(&[(
            "6",
            &[
                "cut_edge_integrals_are_their_definitions",
                "residual_energy_and_hessian_on_random_bodies_are_their_definitions_for_p1",
                "the_same_by_points_for_p1",
                "the_same_by_points_for_p2",
                "every_number_of_the_solver_is_near_its_definition_for_p1",
                "every_number_of_the_solver_is_near_its_definition_for_p2",
            ],
        )]),
    },
    Item {
        name: "P_gamma, A_gamma",
        says: "v_n - gamma sigma_n(v); a(u, v) - int gamma sigma_n(u) sigma_n(v)",
        basis: Basis::Checks(&[
            ("2", &["contact_functions_are_their_definitions"]),
            (
                "6",
                &[
                    "residual_energy_and_hessian_on_random_bodies_are_their_definitions_for_p1",
                    "the_same_by_points_for_p2",
                ],
            ),
        ]),
    },
    Item {
        name: "(9)",
        says: "lambda^h is a projection",
        basis: Basis::Checks(&[(
            "7",
            &[
                "contact_pressure_is_the_projection",
                "condition_9_leaves_only_the_contact_pressure",
                "mixed_form_9_and_10_hold_on_random_bodies_for_p1",
            ],
        )]),
    },
    Item {
        name: "(10)",
        says: "(9) with the weight gamma",
        basis: Basis::Checks(&[(
            "7",
            &[
                "conditions_9_and_10_are_equivalent",
                "mixed_form_9_and_10_hold_on_random_bodies_for_p1",
            ],
        )]),
    },
    Item {
        name: "the mixed problem",
        says: "(8) as a mixed method, after (10); sigma_n(u^h) is not lambda^h",
        basis: Basis::Checks(&[(
            "7",
            &[
                "method_is_its_mixed_form_at_a_point",
                "mixed_form_9_and_10_hold_on_random_bodies_for_p1",
                "sigma_n_of_a_discrete_solution_is_not_its_multiplier",
            ],
        )]),
    },
    Item {
        name: "Lemma 3.1",
        says: "consistency",
        basis: Basis::Both(
            &[(
                "8",
                &[
                    "residual_vanishes_at_affine_solutions_for_p1",
                    "residual_vanishes_at_affine_solutions_for_p2",
                    "residual_vanishes_at_a_curved_solution_for_p1",
                    "residual_vanishes_at_a_curved_solution_for_p2",
                    "residual_is_enclosed_around_zero_at_the_end_of_contact",
                ],
            )],
            "solutions other than the affine ones, a curved one and one with an end of contact: for these it is (6)",
        ),
    },
    Item {
        name: "Lemma 3.2",
        says: "A_gamma is elliptic, C independent of gamma0 and h",
        basis: Basis::Both(
            &[
                (
                    "9",
                    &[
                        "normal_stress_is_bounded_by_the_energy",
                        "trace_inequality_holds_with_the_constants_of_p1_and_p2",
                        "the_trace_bound_gives_coercivity",
                        "11_and_coercivity_hold_for_all_fields_for_p1",
                        "11_and_coercivity_hold_for_all_fields_for_p2",
                    ],
                ),
                (
                    "15",
                    &[
                        "shape_regularity_bounds_edge_and_diameter_by_the_area",
                        "the_constant_of_11_depends_on_shape_and_material_alone",
                        "lemma_3_2_holds_with_constants_without_h",
                    ],
                ),
                (
                    "20",
                    &[
                        "traction_along_a_turning_direction_is_bounded_by_its_factor",
                        "traction_of_p1_needs_no_factor",
                        "bound_11_holds_along_turning_directions",
                    ],
                ),
            ],
            "Korn's inequality on a body of any shape; along turning directions the checks of row 20 are of this code, not of the paper",
        ),
    },
    Item {
        name: "(11)",
        says: "|gamma^1/2 sigma_n(v^h)|^2 <= C gamma0 |v^h|_1^2",
        basis: Basis::Both(
            &[
                (
                    "9",
                    &[
                        "normal_stress_is_bounded_by_the_energy",
                        "trace_inequality_holds_with_the_constants_of_p1_and_p2",
                        "11_and_coercivity_hold_for_all_fields_for_p1",
                        "11_and_coercivity_hold_for_all_fields_for_p2",
                    ],
                ),
                (
                    "15",
                    &[
                        "two_edges_are_as_long_as_the_third",
                        "shape_regularity_bounds_edge_and_diameter_by_the_area",
                        "the_constant_of_11_depends_on_shape_and_material_alone",
                        "lemma_3_2_holds_with_constants_without_h",
                    ],
                ),
                (
                    "20",
                    &[
                        "traction_along_a_turning_direction_is_bounded_by_its_factor",
                        "traction_of_p1_needs_no_factor",
                        "bound_11_holds_along_turning_directions",
                    ],
                ),
            ],
            "tensors A that are not isotropic; the checks of row 20 are of this code, not of the paper",
        ),
    },
    Item {
        name: "a(., .)",
        says: "it is continuous in |.|_1",
        basis: Basis::Checks(&[("9", &["the_energy_is_bounded_by_the_gradient"])]),
    },
    Item {
        name: "Theorem 3.3",
        says: "(8) has one solution",
        basis: Basis::Both(
            &[(
                "10",
                &[
                    "positive_parts_are_monotone",
                    "monotonicity_holds_step_by_step",
                    "positive_part_is_lipschitz",
                    "phi_is_lipschitz_at_a_point",
                    "square_of_the_positive_part_is_convex_and_smooth",
                    "one_solution_is_enclosed_around_the_result_of_the_solver_for_p1",
                ],
            )],
            "that a strongly convex function on R^N has one minimiser, where its gradient vanishes: in place of Brezis, docs/theory.md, 3.2",
        ),
    },
    Item {
        name: "(12)",
        says: "B^h is strongly monotone",
        basis: Basis::Both(
            &[
                (
                    "10",
                    &[
                        "positive_parts_are_monotone",
                        "12_and_the_bound_of_phi_hold_on_random_bodies_for_p1",
                        "12_and_the_bound_of_phi_hold_on_random_bodies_for_p2",
                    ],
                ),
                ("15", &["lemma_3_2_holds_with_constants_without_h"]),
            ],
            "Korn's inequality",
        ),
    },
    Item {
        name: "Theorem 3.4",
        says: "the abstract error estimate",
        basis: Basis::Both(
            &[
                (
                    "11",
                    &[
                        "error_identity_holds_at_a_point",
                        "z_times_the_difference_of_p_is_at_most_minus_gamma_z_squared",
                        "p0_of_w_splits",
                        "raw_facts_give_the_inequality_between_norms",
                        "three_facts_give_the_hypothesis_of_theorem_3_4",
                        "theorem_3_4_holds_with_its_constant",
                        "the_bound_holds_for_the_errors_of_the_solver",
                    ],
                ),
                (
                    "17",
                    &[
                        "plain_bound_is_that_of_theorem_3_4",
                        "three_facts_give_inequality_9_6",
                        "inequality_9_6_gives_the_sharp_bound_9_5",
                    ],
                ),
            ],
            "Green's formula for u: the proof is about the numbers that the integrals are",
        ),
    },
    Item {
        name: "(13)",
        says: "the same in |.|_1, C independent of h and u",
        basis: Basis::Both(
            &[
                ("11", &["theorem_3_4_holds_with_its_constant"]),
                ("15", &["estimate_13_holds_with_a_constant_without_h"]),
            ],
            "Korn's inequality and continuity of a(., .)",
        ),
    },
    Item {
        name: "(14)",
        says: "ellipticity, Young, (8) and Green",
        basis: Basis::Both(
            &[("11", &["estimate_14_holds", "step_14_holds"])],
            "ellipticity, continuity and Green's formula, which are its hypotheses",
        ),
    },
    Item {
        name: "(15)",
        says: "u_n <= 0 is used",
        basis: Basis::Checks(&[("11", &["step_15_holds"])]),
    },
    Item {
        name: "(16)",
        says: "Young's inequality with beta_1",
        basis: Basis::Checks(&[("11", &["step_16_holds"])]),
    },
    Item {
        name: "(17)",
        says: "the bound of T (with the factor gamma: errata)",
        basis: Basis::Checks(&[("11", &["step_17_holds_with_the_factor_gamma"])]),
    },
    Item {
        name: "(18)",
        says: "Young's inequality with beta_2 (with the factor gamma: errata)",
        basis: Basis::Checks(&[("11", &["step_18_holds_with_the_factor_gamma"])]),
    },
    Item {
        name: "(19)",
        says: "the second term of (17)",
        basis: Basis::Both(
            &[("11", &["step_19_holds_with_its_constants"])],
            "that (11) holds for w, and Korn's inequality between the norms: hypotheses",
        ),
    },
    Item {
        name: "(20)",
        says: "(18) and (19) in (17), and the last estimate",
        basis: Basis::Checks(&[(
            "11",
            &[
                "step_20_is_the_sum_of_17_18_and_19",
                "the_last_estimate_follows_from_15_16_and_20",
                "the_last_estimate_bounds_both_errors",
            ],
        )]),
    },
    Item {
        name: "Theorem 3.5",
        says: "the rate of convergence",
        basis: Basis::Both(
            &[
                ("15", &["rates_21_and_25_follow_from_13_and_22_to_24"]),
                (
                    "12",
                    &[
                        "the_wedge_converges_at_the_rate_alpha",
                        "the_end_of_contact_has_the_rates_1_and_3_2",
                    ],
                ),
            ],
            "(22)-(24): hypotheses; the rates are observed for two solutions on finitely many meshes",
        ),
    },
    Item {
        name: "(21)",
        says: "h^(1/2 + nu), C independent of h and u",
        basis: Basis::Both(
            &[
                ("15", &["rates_21_and_25_follow_from_13_and_22_to_24"]),
                ("12", &["the_wedge_converges_at_the_rate_alpha"]),
            ],
            "(22)-(24): hypotheses; the rate is observed for one solution on finitely many meshes",
        ),
    },
    Item {
        name: "(22)-(24)",
        says: "interpolation estimates",
        basis: Basis::Literature(
            "Brenner and Scott; Ern and Guermond; Hild and Renard; Fritz, Hueeber and Wohlmuth: hypotheses of row 15",
        ),
    },
    Item {
        name: "Corollary 3.6",
        says: "the rate of the normal stress",
        basis: Basis::Both(
            &[
                ("11", &["corollary_3_6_holds_with_its_constant"]),
                ("15", &["rate_25_follows_from_corollary_3_6"]),
                ("17", &["corollary_bound_is_that_of_corollary_3_6"]),
            ],
            "(22) and (24): hypotheses; that sigma_n(u) is square integrable",
        ),
    },
    Item {
        name: "(25)",
        says: "|gamma^1/2 sigma_n(u - u^h)| falls at the same rate",
        basis: Basis::Both(
            &[
                ("15", &["rate_25_follows_from_corollary_3_6"]),
                ("12", &["the_wedge_converges_at_the_rate_alpha"]),
            ],
            "(22) and (24): hypotheses; the rate is observed for one solution on finitely many meshes",
        ),
    },
    Item {
        name: "Remark 3.7",
        says: "quadratic elements",
        basis: Basis::Both(
            &[
                (
                    "9",
                    &[
                        "trace_inequality_holds_with_the_constants_of_p1_and_p2",
                        "11_and_coercivity_hold_for_all_fields_for_p2",
                    ],
                ),
                ("12", &["the_end_of_contact_has_the_rates_1_and_3_2"]),
            ],
            "(22)-(24) for quadratic elements",
        ),
    },
    Item {
        name: "floating point",
        says: "not in the paper: what the computer's numbers keep of it",
        basis: Basis::Checks(&[(
            "13",
            &[
                "operations_of_intervals_contain_the_exact_results",
                "results_of_intervals_are_as_narrow_as_stated",
                "edge_integrals_over_intervals_contain_the_exact_ones",
            ],
        )]),
    },
    Item {
        name: "sparse pattern",
        says: "not in the paper: where the entries of the matrix stand",
        basis: Basis::Checks(&[(
            "14",
            &[
                "pattern_numbers_and_sums_are_as_defined_on_random_triangles",
                "assembled_matrices_of_meshes_are_the_sums_of_their_parts",
            ],
        )]),
    },
    Item {
        name: "the solver",
        says: "not in the paper: what it refuses, the rules by which it integrates",
        basis: Basis::Checks(&[(
            "18",
            &[
                "kappa_of_1_or_more_is_refused_and_less_is_taken",
                "prescribed_displacements_that_disagree_are_refused",
                "gauss_rules_have_the_moments_of_legendre",
                "integrals_over_an_edge_scale_by_powers_of_two_without_error",
            ],
        )]),
    },
    Item {
        name: "Newton's method",
        says: "not in the paper: how (8) is solved, and the verdict",
        basis: Basis::Checks(&[(
            "19",
            &[
                "newton_ends_at_the_minimiser_where_full_steps_cycle",
                "newton_ends_at_the_minimiser_from_any_start",
                "the_verdict_accepts_small_forward_errors_only",
            ],
        )]),
    },
    Item {
        name: "the error bound",
        says: "not in the paper: |u - v|_a without an unknown constant, by certificate",
        basis: Basis::Both(
            &[
                (
                    "24",
                    &[
                        "the_square_of_the_bound_splits_at_a_point",
                        "what_contact_adds_is_not_negative",
                        "the_checker_finds_what_the_definitions_say",
                        "the_checker_refuses_what_the_theorem_does_not_allow",
                        "the_bound_of_the_solvers_displacement_is_above_its_error",
                    ],
                ),
                (
                    "25",
                    &[
                        "the_checker_in_balls_is_above_the_same_checker_in_rationals",
                        "a_stress_of_the_wrong_sign_is_rejected",
                        "the_contact_term_makes_it_a_bound",
                        "potential_energy_and_compliance_lie_in_their_intervals",
                        "the_bound_is_above_the_true_error_of_drawn_solutions",
                    ],
                ),
            ],
            "Green's formula",
        ),
    },
    Item {
        name: "the proof engine",
        says: "not in the paper: what is false is refused",
        basis: Basis::Both(
            &[("23", &["true_neighbours_of_false_statements_are_proved"])],
            "that nothing false is proved: 60 false statements are refused, more is not known; for the rest there is the checker of certificates",
        ),
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims;

    #[test]
    fn every_check_named_for_an_item_is_evidence_of_its_row() {
        let claims = claims::all();
        for item in ITEMS {
            for (row, names) in item.checks() {
                let claim = claims.iter().find(|claim| claim.id == *row).expect("a row");
                for name in *names {
                    let evidence = |check: &&Check| check.name == *name && !check.control;
                    let found = claim.checks.iter().find(evidence);
                    assert!(found.is_some(), "{}: row {row} has no check {name}", item.name);
                }
            }
            assert!(
                item.literature().is_some() || !item.found(&claims).is_empty(),
                "{}",
                item.name
            );
        }
    }

    #[test]
    fn an_item_and_a_row_name_each_other() {
        for claim in claims::all() {
            let of = |item: &&Item| item.checks().iter().any(|(row, _)| *row == claim.id);
            let mut by_item: Vec<&str> = ITEMS.iter().filter(of).map(|item| item.name).collect();
            let mut by_row = claim.items.to_vec();
            by_item.sort_unstable();
            by_row.sort_unstable();
            assert_eq!(by_item, by_row, "row {}", claim.id);
        }
    }
}
