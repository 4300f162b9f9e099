(** The headline statements of the paper over the real numbers, written by hand.

    F. Chouly, P. Hild, A Nitsche-based method for unilateral contact problems, SIAM J. Numer. Anal. 51 (2013).
    n is the outward normal, sigma_n < 0 in compression, g a gap (the paper has g = 0), P(v) = v_n - g - gamma sigma_n(v).

    [cargo run -p props -- export --rocq DIR] writes this file with a proof in place of each comment [paths of NAME]: the
    case distinctions and the certificates that the proof engine found for the predicate NAME of [props/src/claims], as
    products of hypotheses given one by one and linear arithmetic. The variables have the names of the predicate's unknowns.
    What Rocq accepts rests on this file and on Rocq: neither on the engine nor on the predicate.

    A comment [false: OLD => NEW] makes a false statement of the theorem before it, which the same proof must not prove. *)

Require Import Reals Lra.
Open Scope R_scope.

(** [a]+ *)
Definition pos (a : R) : R := Rmax 0 a.

(** Where (2)(i)-(iii) hold at a point of Gamma_C. *)
Definition contact (u_n g sigma_n : R) : Prop := u_n <= g /\ sigma_n <= 0 /\ sigma_n * (u_n - g) = 0.

(** (5): sigma_n = -(1/gamma) [u_n - g - gamma sigma_n]+ *)
Definition equation_5 (u_n g sigma_n gamma : R) : Prop :=
  sigma_n = - (1 / gamma) * pos (u_n - g - gamma * sigma_n).

(** lambda^h = -(1/gamma) [P]+ *)
Definition multiplier (u_n g sigma_n gamma : R) : R := - (1 / gamma) * pos (u_n - g - gamma * sigma_n).

(** The tactics of the proofs. *)
Lemma pos_of_nonnegative (a : R) : 0 <= a -> pos a = a.
Proof. intro; unfold pos; apply Rmax_right; lra. Qed.

Lemma pos_of_nonpositive (a : R) : a <= 0 -> pos a = 0.
Proof. intro; unfold pos; apply Rmax_left; lra. Qed.

Lemma square_nonnegative (a : R) : 0 <= a * a.
Proof. apply Rle_0_sqr. Qed.

(** Where the sign of [p] leads: the goal is a disjunction of relations of [p] to 0. *)
Ltac one_of := first [left; lra | right; one_of | lra].
Ltac of_sign p := destruct (Rtotal_order p 0) as [? | [? | ?]]; one_of.

(** A product of hypotheses and of squares. *)
Ltac product :=
  first
    [ assumption
    | apply Rlt_le; assumption
    | apply square_nonnegative
    | apply Rmult_lt_0_compat; product
    | apply Rmult_le_pos; product ].

(** What [pos] is on this path. *)
Ltac parts :=
  repeat match goal with
    | |- context [pos ?a] =>
        first [rewrite (pos_of_nonnegative a) by lra | rewrite (pos_of_nonpositive a) by lra]
    | _ : context [pos ?a] |- _ =>
        first [rewrite (pos_of_nonnegative a) in * by lra | rewrite (pos_of_nonpositive a) in * by lra]
    end.

(** The inverse [v] of [p], where [product : p * v = 1]: every other inverse in the goal is a multiple of it. *)
Ltac other_inverse q v c := replace (/ q) with (c * v) in *
  by (apply (Rmult_eq_reg_l q); [rewrite Rinv_r by lra; lra | lra]).
Ltac other_inverses v :=
  repeat match goal with
    | |- context [/ ?q] =>
        first [other_inverse q v 1 | other_inverse q v (-1) | other_inverse q v (/ 2) | other_inverse q v (/ 4)]
    end.

(** The end of a path. *)
Ltac settle :=
  unfold Rabs in *; repeat destruct Rcase_abs;
  parts;
  repeat match goal with
    | |- _ /\ _ => split
    | |- _ <-> _ => split
    | |- _ -> _ => intro
    | H : _ /\ _ |- _ => destruct H
    end;
  lra.

(** * Section 2 *)

(** (4) *)
Theorem item_4 : forall a : R, a <= pos a /\ a * pos a = pos a * pos a.
Proof.
  intros a.
  (* paths of positive_part_satisfies_4 *)
Qed.
(* false: a <= pos a => pos a <= a *)

(** Proposition 2.1, with a gap *)
Theorem proposition_2_1 : forall u_n g sigma_n gamma : R,
  0 < gamma -> (contact u_n g sigma_n <-> equation_5 u_n g sigma_n gamma).
Proof.
  intros u_n g sigma_n gamma positive; unfold contact, equation_5.
  (* paths of conditions_2_are_equation_5 *)
Qed.
(* false: 0 < gamma => gamma < 0 *)

(** Remark 2.2: Proposition 2.1 on any set Gamma_C, with a function gamma *)
Theorem remark_2_2 : forall (Gamma_C : Type) (u_n g sigma_n gamma : Gamma_C -> R),
  (forall x, 0 < gamma x) ->
  ((forall x, contact (u_n x) (g x) (sigma_n x)) <-> (forall x, equation_5 (u_n x) (g x) (sigma_n x) (gamma x))).
Proof.
  intros Gamma_C u_n g sigma_n gamma positive; split; intros all x;
    apply (proposition_2_1 _ _ _ (gamma x) (positive x)); apply all.
Qed.

(** Remark 2.2: (5) with one gamma is (5) with any other *)
Theorem equation_5_for_every_gamma : forall u_n g sigma_n gamma other : R,
  0 < gamma -> 0 < other -> (equation_5 u_n g sigma_n gamma <-> equation_5 u_n g sigma_n other).
Proof.
  intros u_n g sigma_n gamma other positive too; unfold equation_5.
  (* paths of equation_5_does_not_depend_on_gamma *)
Qed.
(* false: 0 < other => 0 <= other *)

(** (3), the integrand: at an admissible u, sigma_n (v_n - u_n) >= 0 for every admissible v is (2) *)
Theorem item_3_from_2 : forall u_n g sigma_n v_n : R,
  contact u_n g sigma_n -> v_n <= g -> 0 <= sigma_n * (v_n - u_n).
Proof.
  intros u_n g sigma_n v_n [admissible [pressure complementary]] test.
  (* paths of conditions_2_give_the_sign_of_3 *)
Qed.
(* false: v_n <= g => g <= v_n *)

Theorem item_2_from_3 : forall u_n g sigma_n : R,
  u_n <= g -> (forall v_n, v_n <= g -> 0 <= sigma_n * (v_n - u_n)) -> contact u_n g sigma_n.
Proof.
  intros u_n g sigma_n admissible all; unfold contact.
  pose proof (all (u_n - 1) ltac:(lra)) as below; pose proof (all g ltac:(lra)) as touching; clear all.
  (* paths of the_sign_of_3_gives_conditions_2 *)
Qed.
(* false: forall v_n, v_n <= g -> 0 <= sigma_n => forall v_n, v_n <= g -> 0 >= sigma_n *)

(** (6), the integrand of Gamma_C: -sigma_n(u) v_n as Nitsche's method has it; tau_n is sigma_n(v) *)
Theorem item_6 : forall u_n g sigma_n gamma v_n tau_n : R,
  0 < gamma -> contact u_n g sigma_n ->
  - (sigma_n * v_n) = - (gamma * sigma_n * tau_n) + 1 / gamma * pos (u_n - g - gamma * sigma_n) * (v_n - gamma * tau_n).
Proof.
  intros u_n g sigma_n gamma v_n tau_n positive [admissible [pressure complementary]].
  (* paths of green_terms_rearrange_to_6 *)
Qed.
(* false: (v_n - gamma * tau_n) => (v_n + gamma * tau_n) *)

(** (9) and (10) at a point: lambda^h is the projection of -P/gamma on the nonpositive numbers *)
Theorem item_9_and_10 : forall u_n g sigma_n gamma mu : R,
  0 < gamma -> mu <= 0 ->
  let lambda := multiplier u_n g sigma_n gamma in
  lambda <= 0 /\
  (mu - lambda) * (- (1 / gamma) * (u_n - g - gamma * sigma_n) - lambda) <= 0 /\
  0 <= (mu - lambda) * (u_n - g) + gamma * (mu - lambda) * (lambda - sigma_n).
Proof.
  intros u_n g sigma_n gamma mu positive negative lambda; unfold lambda, multiplier.
  (* paths of contact_pressure_is_the_projection *)
Qed.
(* false: mu <= 0 => 0 <= mu *)

(** (9) for every mu <= 0 leaves only lambda^h *)
Theorem item_9_is_unique : forall u_n g sigma_n gamma l : R,
  0 < gamma -> l <= 0 ->
  (forall mu, mu <= 0 -> (mu - l) * (- (1 / gamma) * (u_n - g - gamma * sigma_n) - l) <= 0) ->
  l = multiplier u_n g sigma_n gamma.
Proof.
  intros u_n g sigma_n gamma l positive negative all; unfold multiplier.
  pose proof (all 0 ltac:(lra)) as zero; pose proof (all (l + l) ltac:(lra)) as twice;
    pose proof (all (l - 1) ltac:(lra)) as less; clear all.
  (* paths of condition_9_leaves_only_the_contact_pressure *)
Qed.
(* false: l = multiplier => 2 * l = multiplier *)

(** (9) and (10) are one condition, for any multiplier l *)
Theorem item_9_is_10 : forall u_n g sigma_n gamma mu l : R,
  0 < gamma ->
  ((mu - l) * (- (1 / gamma) * (u_n - g - gamma * sigma_n) - l) <= 0 <->
   0 <= (mu - l) * (u_n - g) + gamma * (mu - l) * (l - sigma_n)).
Proof.
  intros u_n g sigma_n gamma mu l positive.
  (* paths of conditions_9_and_10_are_equivalent *)
Qed.
(* false: 0 < gamma => gamma < 0 *)

(** (8) is its mixed form, the integrand of Gamma_C: v, t are v_n and sigma_n of the test function *)
Theorem mixed_form : forall u g s gamma v t : R,
  0 < gamma ->
  let lambda := multiplier u g s gamma in
  - (gamma * s * t) + 1 / gamma * pos (u - g - gamma * s) * (v - gamma * t) = gamma * (lambda - s) * t - lambda * v.
Proof.
  intros u g s gamma v t positive lambda; unfold lambda, multiplier.
  (* paths of method_is_its_mixed_form_at_a_point *)
Qed.
(* false: gamma * (lambda - s) * t => gamma * (lambda + s) * t *)

(** * Section 3: existence, uniqueness *)

(** (11), Lemma 3.2 at a point: sigma_n^2 <= (lambda + 2 mu) sigma:eps, for a normal of any length; grad u has the entries
    xx, xy, yx, yy *)
Theorem stress_inequality : forall xx xy yx yy nx ny lambda mu : R,
  0 < mu -> 0 < lambda + mu ->
  let sxx := lambda * (xx + yy) + 2 * mu * xx in
  let syy := lambda * (xx + yy) + 2 * mu * yy in
  let sxy := mu * (xy + yx) in
  let sigma_n := sxx * nx * nx + 2 * sxy * nx * ny + syy * ny * ny in
  let energy := sxx * xx + syy * yy + sxy * (xy + yx) in
  sigma_n * sigma_n <= (lambda + 2 * mu) * ((nx * nx + ny * ny) * (nx * nx + ny * ny)) * energy.
Proof.
  intros xx xy yx yy nx ny lambda mu shear bulk sxx syy sxy sigma_n energy; unfold energy, sigma_n, sxx, syy, sxy.
  clear sxx syy sxy sigma_n energy.
  (* paths of normal_stress_is_bounded_by_the_energy *)
Qed.
(* false: <= (lambda + 2 * mu) => <= (lambda + mu) *)

(** Lemma 3.2 and (12) from (11) and Korn's inequality: s = |gamma^(1/2) sigma_n|^2, n = |v|_1^2, and what contact adds *)
Theorem lemma_3_2_from_11_and_korn : forall n a s contact gamma0 limit c alpha most : R,
  0 <= n -> 0 <= a -> 0 <= contact -> 0 < gamma0 -> 0 <= limit -> 0 < alpha ->
  alpha * n <= a -> a <= most * n -> s <= gamma0 * limit * a -> limit <= c -> 2 * gamma0 * c <= 1 ->
  s <= gamma0 * c * most * n /\ a - s >= alpha / 2 * n /\ a - s + contact >= alpha / 2 * n.
Proof.
  intros n a s contact gamma0 limit c alpha most; intros.
  (* paths of lemma_3_2_holds_with_constants_without_h *)
Qed.
(* false: 2 * gamma0 * c <= 1 => gamma0 * c <= 1 *)

(** Theorem 3.3: ([a]+ - [b]+)(a - b) >= ([a]+ - [b]+)^2 >= 0, so B^h is monotone *)
Theorem theorem_3_3_monotone : forall a b : R,
  (pos a - pos b) * (a - b) >= (pos a - pos b) * (pos a - pos b) /\ (pos a - pos b) * (pos a - pos b) >= 0.
Proof.
  intros a b.
  (* paths of positive_parts_are_monotone *)
Qed.
(* false: (pos a - pos b) * (a - b) >= => (pos a - pos b) * (a + b) >= *)

(** Theorem 3.3: |[a]+ - [b]+| <= |a - b| *)
Theorem theorem_3_3_lipschitz : forall a b : R, Rabs (pos a - pos b) <= Rabs (a - b).
Proof.
  intros a b.
  (* paths of positive_part_is_lipschitz *)
Qed.
(* false: <= Rabs (a - b) => <= / 2 * Rabs (a - b) *)

(** Theorem 3.3: phi(t) = (B^h(v - t w), w) is Lipschitz, the integrand of Gamma_C with P(v - t w) = p - t q *)
Theorem theorem_3_3_hemicontinuous : forall p q s t : R,
  Rabs ((pos (p - t * q) - pos (p - s * q)) * q) <= Rabs (s - t) * (q * q).
Proof.
  intros p q s t.
  (* paths of phi_is_lipschitz_at_a_point *)
Qed.
(* false: <= Rabs (s - t) => <= / 2 * Rabs (s - t) *)

(** * Section 3: the error estimate *)

(** (14): from ellipticity and continuity of a, Green's formula for u and (8) for u^h, with the integrals as numbers *)
Theorem item_14 : forall alpha big n m b c l i j p q r : R,
  0 < alpha -> 0 <= big -> 0 <= n -> 0 <= m ->
  alpha * (n * n) <= b + c -> b <= big * n * m ->
  c = (l + i) - (l + j - p) -> p = q - r ->
  alpha / 2 * (n * n) <= big * big / (2 * alpha) * (m * m) + i - j + q - r.
Proof.
  intros alpha big n m b c l i j p q r; intros.
  (* paths of estimate_14_holds *)
Qed.
(* false: big * big / (2 * alpha) => big * big / (4 * alpha) *)

(** (14), its last step at a point: a [a]+ = [a]+^2; the primes are u^h and v^h *)
Theorem item_14_at_a_point : forall gamma uh sh v sv : R,
  0 < gamma ->
  let part := pos (uh - gamma * sh) in
  1 / gamma * part * ((v - uh) - gamma * (sv - sh)) = 1 / gamma * part * (v - gamma * sv) - 1 / gamma * (part * part).
Proof.
  intros gamma uh sh v sv positive part; unfold part.
  (* paths of step_14_holds *)
Qed.
(* false: - 1 / gamma * (part * part) => + 1 / gamma * (part * part) *)

(** (15): u_n <= 0 is used *)
Theorem item_15 : forall gamma u su uh sh v : R,
  0 < gamma -> u <= 0 ->
  let part := 1 / gamma * pos (uh - gamma * sh) in
  su * (v - uh) + part * v <= (su + part) * (v - u) + su * (u - uh).
Proof.
  intros gamma u su uh sh v positive admissible part; unfold part.
  (* paths of step_15_holds *)
Qed.
(* false: u <= 0 => 0 <= u *)

(** (16): Young's inequality with beta_1 *)
Theorem item_16 : forall z d gamma beta : R,
  0 < gamma -> 0 < beta -> z * d <= gamma * z * z / (2 * beta) + beta * d * d / (2 * gamma).
Proof.
  intros z d gamma beta positive weight.
  (* paths of step_16_holds *)
Qed.
(* false: gamma * z * z / (2 * beta) => gamma * z * z / (4 * beta) *)

(** (17), at a point, with the factor gamma that the printed one lacks *)
Theorem item_17 : forall gamma u su uh sh sv : R,
  0 < gamma -> contact u 0 su ->
  let part := pos (uh - gamma * sh) in
  let z := su + 1 / gamma * part in
  su * (u - uh) - gamma * sh * (sv - sh) - part * sv - 1 / gamma * (part * part) + gamma * z * z
  <= gamma * z * (su - sv) + gamma * (su - sh) * (sv - sh).
Proof.
  intros gamma u su uh sh sv positive [admissible [pressure complementary]] part z; unfold z, part.
  (* paths of step_17_holds_with_the_factor_gamma *)
Qed.
(* false: <= gamma * z * (su - sv) => <= z * (su - sv) *)

(** (18): Young's inequality with beta_2, with the factor gamma that the printed one lacks *)
Theorem item_18 : forall z d gamma beta : R,
  0 < gamma -> 0 < beta -> gamma * z * d <= gamma * z * z / (2 * beta) + beta * gamma * d * d / 2.
Proof.
  intros z d gamma beta positive weight.
  (* paths of step_18_holds_with_the_factor_gamma *)
Qed.
(* false: gamma * z * d <= => z * d <= *)

(** (19), with its constants: a, s, r are norms of sigma_n(e), sigma_n(eta), sigma_n(w); kappa = k^2 *)
Theorem item_19 : forall a s r w e h k : R,
  0 <= a -> 0 <= s -> 0 <= r -> 0 <= w -> 0 <= e -> 0 <= h -> 0 <= k ->
  r <= k * w -> a <= s + r -> w <= e + h ->
  2 * a * r <= 3 * (k * k) * (w * w) + s * s /\ w * w <= 2 * (e * e + h * h).
Proof.
  intros a s r w e h k; intros.
  (* paths of step_19_holds_with_its_constants *)
Qed.
(* false: <= 3 * (k * k) * (w * w) => <= 2 * (k * k) * (w * w) *)

(** (20): (18) and (19) in (17) *)
Theorem item_20 : forall t z first second s e h c beta : R,
  0 < beta -> t + z <= first + second -> first <= z / (2 * beta) + beta / 2 * s -> second <= c * (e + h + s) ->
  t + (1 - 1 / (2 * beta)) * z <= c * (e + h) + (c + beta / 2) * s.
Proof.
  intros t z first second s e h c beta; intros.
  (* paths of step_20_is_the_sum_of_17_18_and_19 *)
Qed.
(* false: (1 - 1 / (2 * beta)) * z => (1 + 1 / (2 * beta)) * z *)

(** The estimate after (20): (16) and (20) in (15) *)
Theorem last_estimate : forall alpha big gamma0 n m z s d i t b1 b2 : R,
  0 < alpha -> 0 <= big -> 0 < gamma0 -> 0 < b1 -> 0 < b2 ->
  alpha / 2 * n <= big * big / (2 * alpha) * m + i + t ->
  i <= z / (2 * b1) + b1 / 2 * d ->
  t + (1 - 1 / (2 * b2)) * z <= big * gamma0 * n + big * gamma0 * m + (big + b2 / 2) * s ->
  (alpha / 2 - big * gamma0) * n + (1 - 1 / (2 * b1) - 1 / (2 * b2)) * z
  <= (big * big / (2 * alpha) + big * gamma0) * m + b1 / 2 * d + (big + b2 / 2) * s.
Proof.
  intros alpha big gamma0 n m z s d i t b1 b2; intros.
  (* paths of the_last_estimate_follows_from_15_16_and_20 *)
Qed.
(* false: (1 - 1 / (2 * b1) - 1 / (2 * b2)) * z => (1 - 1 / (2 * b1)) * z *)

(** z (P(u) - P(u^h)) <= -gamma z^2, from (5) for the exact solution *)
Theorem contact_term : forall gamma g u su uh sh : R,
  0 < gamma -> equation_5 u g su gamma ->
  let z := su + 1 / gamma * pos (uh - g - gamma * sh) in
  z * ((u - g - gamma * su) - (uh - g - gamma * sh)) <= - (gamma * z * z).
Proof.
  intros gamma g u su uh sh positive exact z; unfold z; unfold equation_5 in exact.
  assert (scaled : gamma * su = - pos (u - g - gamma * su)) by (rewrite exact at 1; field; lra); clear exact z.
  (* paths of z_times_the_difference_of_p_is_at_most_minus_gamma_z_squared *)
Qed.
(* false: <= - (gamma * z * z) => <= - (2 * gamma * z * z) *)

(** Theorem 3.4 (docs/theory.md, Theorem 9.1) from [9.4]: e = |e|_a, h = |eta|_a, z = |z|_gamma, s = |sigma_n(eta)|_gamma,
    r = |gamma^(-1/2) P0(eta)|, kappa = k^2, delta = 1 - kappa *)
Theorem theorem_9_1 : forall e h z s r k : R,
  0 <= e -> 0 <= h -> 0 <= z -> 0 <= s -> 0 <= r -> 0 <= k -> k < 1 ->
  let delta := 1 - k * k in
  delta * (e * e) + z * z <= e * h + k * k * (h * h) + k * (e + h) * s + z * r ->
  e * e + z * z / delta
  <= 2 / delta * ((1 / delta + k * k + 1 / 2) * (h * h) + k * k * (1 / delta + 1 / 2) * (s * s) + 1 / 2 * (r * r)).
Proof.
  intros e h z s r k He Hh Hz Hs Hr Hk less delta given.
  assert (factors : 0 < (1 - k) * (1 + k)) by (apply Rmult_lt_0_compat; lra).
  assert (positive : 0 < delta) by (unfold delta; lra); clear factors.
  apply (Rmult_le_reg_l (delta * delta)); [apply Rmult_lt_0_compat; assumption |].
  match goal with |- _ * ?left <= _ * ?right =>
    let left := constr:(delta * delta * left) in
    let right := constr:(delta * delta * right) in
    field_simplify left; [field_simplify right; [| lra] | lra]
  end.
  unfold delta in *; clear delta.
  (* paths of theorem_3_4_holds_with_its_constant *)
Qed.
(* false: <= 2 / delta => <= 1 / delta *)

(** Corollary 3.6 with its constant *)
Theorem corollary_3_6 : forall x s r w e h k : R,
  0 <= k -> 0 <= e -> 0 <= h -> x <= s + r -> r <= k * w -> w <= e + h -> x <= s + k * (e + h).
Proof.
  intros x s r w e h k; intros.
  (* paths of corollary_3_6_holds_with_its_constant *)
Qed.
(* false: x <= s + k * (e + h) => x <= k * (e + h) *)

