//! What the residual r of (8) at a point u~ says of the distance e = u~ - u^h to the one solution, in exact arithmetic
//! (docs/a-posteriori.md, section 7):
//!
//! ```text
//! A(e, e) + int ([P(u~)]+ - [P(u^h)]+)^2/gamma <= r(e)                        (C0)
//! |e|_a <= |r|_a*/(1 - kappa)                                                (C1)
//! |e|_A <= rho = |r|_A*,  int ([P(u~)]+ - [P(u^h)]+)^2/gamma <= rho^2/4       (C2)
//! ```
//!
//! with |r|_A*^2 = r.A^-1 r, |r|_a*^2 = r.K^-1 r. Where u^h is rational (`props::claims::one_solution`) these are compared with the
//! error itself. Where an edge is cut, u^h is irrational; one step makes a much better point u', whose own enclosure is so small
//! that |u~ - u'| stands for the error.

use signorini::contact::residual;
use signorini::kernel::{Material, Plane};
use signorini::nalgebra::Vector2;

use props::bodies::sum;
use props::claim::Outcome;
use props::claims::one_solution::{
    Certifier, Draw, IRRATIONAL, NARROW, P1, P2_BY_POINTS, Point, Rule, of_solved, on_small_meshes,
    power, problems,
};
use props::discrete::{Discrete, cut, exactly};
use props::elimination::{dot, solve_definite, square};
use props::numbers::Exact;
use props::verdict::Verdict;
use props::{draws, ensure};

/// int (1/gamma) (\[P(u)\]+ - \[P(v)\]+)^2, where that needs no root: by points, or with no edge cut at u and v.
pub fn pressures_apart(
    discrete: &Discrete<'_>,
    u: &[[Exact; 2]],
    v: &[[Exact; 2]],
) -> Option<Exact> {
    let zero = Exact::from(0);
    let mut sum = zero;
    for e in 0..discrete.edges.len() {
        let (p, q) = (discrete.p(e, u), discrete.p(e, v));
        let part = |value: Exact| if value > zero { value } else { zero };
        let square = match &discrete.rule {
            Some(points) => points.iter().fold(zero, |sum, &[s, weight]| {
                let [p, q] = [&p, &q].map(|p| discrete.d.space.degree().value_at(p, s));
                let d = part(p) - part(q);
                sum + weight * d * d
            }),
            None if p.len() == 2 && !cut(&p) && !cut(&q) => {
                let [start, end] = [0, 1].map(|a| part(p[a]) - part(q[a]));
                (start * start + start * end + end * end) / Exact::from(3)
            }
            None => return None,
        };
        sum += discrete.edges[e].weight() * square;
    }
    Some(sum)
}

/// kappa, for unit normals.
pub fn kappa(discrete: &Discrete<'_>) -> Exact {
    // The bodies of the claims have one material. lambda is the coefficient that acts in the plane, also in plane stress.
    let of = discrete.d.problem.material.of(0);
    let [lambda, mu] = [of.lambda(), of.mu()].map(Exact::of_double);
    let material = Material::lame(lambda, mu, Plane::Strain);
    let stiffness = material.normal_stiffness(Vector2::y());
    let mesh = discrete.d.space.mesh();
    let owner = |e: usize| discrete.d.contact[e].edge().triangle;
    (0..discrete.edges.len()).fold(Exact::from(0), |kappa, e| {
        let t = owner(e);
        let area = residual::exactly::<Exact>(mesh.triangle(t)).double_area() / Exact::from(2);
        let owned = (0..discrete.edges.len()).filter(|&other| owner(other) == t);
        let length = sum(owned, |other| discrete.edges[other].length);
        let gamma = discrete.edges[e].gamma;
        let degree = discrete.d.space.degree();
        let of_t = degree.coercivity_constant(stiffness, gamma, length, area);
        if of_t > kappa { of_t } else { kappa }
    })
}

/// int \[P(u)\]+/gamma: the force of contact.
pub fn contact_force(discrete: &Discrete<'_>, u: &[[Exact; 2]]) -> Exact {
    sum(0..discrete.edges.len(), |e| {
        discrete.edges[e].weight() * sum(discrete.integrals(&discrete.p(e, u)).0, |g| g)
    })
}

/// a(u, u)
pub fn energy(discrete: &Discrete<'_>, u: &[[Exact; 2]]) -> Exact {
    let forces = discrete.internal_forces(u);
    sum(u.iter().zip(&forces), |(u, f)| dot(u, f))
}

/// The enclosure of u^h around a point.
#[derive(Clone, Copy)]
pub struct Certificate {
    /// rho^2 = r . A^-1 r
    pub rho_squared: Exact,
    /// r . K^-1 r
    pub dual_squared: Exact,
}

/// The certificate at a point.
///
/// # Errors
/// That A or K is not positive definite.
pub fn certify(certifier: &Certifier<'_>, point: &Point) -> Result<Certificate, &'static str> {
    let r = &point.residual;
    let riesz = solve_definite(&certifier.a, r).ok_or("A is not positive definite")?;
    let in_a = solve_definite(&certifier.k, r).ok_or("K is not positive definite")?;
    Ok(Certificate { rho_squared: dot(r, &riesz), dual_squared: dot(r, &in_a) })
}

/// The inequalities of Theorem 7.1.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// (C0)
    Monotone,
    /// (C1)
    Energy,
    /// (C2)
    Displacement,
    /// (C2)
    Pressure,
}

/// What is asked of the certificate.
#[derive(Clone, Copy)]
pub struct Asked {
    /// rho is at most 2^-share |u~|_a.
    pub share: i32,
    /// A planted mistake: a tenth of the right side of this bound.
    pub tenth: Option<Bound>,
}

impl Asked {
    /// The factor of a right side.
    fn factor(self, bound: Bound) -> Exact {
        if self.tenth == Some(bound) { Exact::ratio(1, 10) } else { Exact::from(1) }
    }
}

/// Compares the certificate of u~ with u^h, or with a point whose own enclosure is a thousand times smaller than it and than
/// `radii`; and whatever stands `beside` it with that point, which is u^h up to so many times each of these.
///
/// # Errors
/// What the certificate lacks.
pub fn compared(
    certifier: &Certifier<'_>,
    found: &[[Exact; 2]],
    asked: Asked,
    by_contact: bool,
    radii: &[Exact],
    beside: impl Fn(&[[Exact; 2]], Exact) -> Verdict,
) -> Result<Verdict, &'static str> {
    let scale = square(&certifier.k, &certifier.problem.free(found));
    let mut start = found.to_vec();
    certifier.problem.prescribe(&mut start);
    let start = certifier.point(start);
    // Where contact alone holds the body A is not definite: only a rational solution will do.
    let certified = |point: &Point| (!by_contact).then(|| certify(certifier, point)).transpose();
    let certificate = certified(&start)?;
    if certificate
        .is_some_and(|of| of.rho_squared > power(asked.share) * power(asked.share) * scale)
    {
        return Err("rho <= 2^-share |u~|_a");
    }
    let millionth = Exact::ratio(1, 1_000_000);
    let kept = Exact::from(1) - kappa(&certifier.problem);
    let mut point = Point { u: start.u.clone(), residual: start.residual.clone() };
    for step in 0..=8 {
        let is_solution = point.is_solution();
        let refined = if is_solution { None } else { certified(&point)? };
        let is_better = step > 0
            && certificate.zip(refined).is_some_and(|(of, refined)| {
                refined.rho_squared <= millionth * of.rho_squared
                    && refined.dual_squared <= millionth * of.dual_squared
                    && radii.iter().all(|&r| refined.rho_squared <= kept * millionth * r * r)
            });
        if !is_solution && !is_better {
            point = certifier.newton_step(&point)?;
            continue;
        }
        let slack = Exact::ratio(i64::from(is_better), 1000);
        if let Some(certificate) = &certificate {
            let verdict = inside(certifier, certificate, &start, &point, slack, asked);
            if verdict.fails() {
                return Ok(verdict);
            }
        }
        let verdict = beside(&point.u, slack);
        if verdict.fails() {
            return Ok(verdict);
        }
        let class = if is_solution { certifier.problem.class(&point.u) } else { IRRATIONAL };
        return Ok(Verdict::Holds(class));
    }
    if by_contact {
        return Ok(Verdict::Vacuous);
    }
    Err("Newton's steps settle on no better point")
}

/// |e|_A <= rho and |e|_a <= |r|_a*/(1 - kappa), kappa < 1, where e is known up to `slack` times these; and all bounds where it
/// is known exactly.
fn inside(
    certifier: &Certifier<'_>,
    certificate: &Certificate,
    found: &Point,
    point: &Point,
    slack: Exact,
    asked: Asked,
) -> Verdict {
    let error = certifier.difference(&found.u, &point.u);
    let kept = Exact::from(1) - kappa(&certifier.problem);
    ensure!(kept > Exact::from(0));
    let factor = asked.factor(Bound::Displacement) + slack;
    ensure!(square(&certifier.a, &error) <= factor * factor * certificate.rho_squared);
    let factor = asked.factor(Bound::Energy) + slack;
    let in_energy = square(&certifier.k, &error);
    ensure!(kept * kept * in_energy <= factor * factor * certificate.dual_squared);
    if slack == Exact::from(0)
        && let Some(apart) = pressures_apart(&certifier.problem, &found.u, &point.u)
    {
        let left = square(&certifier.a, &error) + apart;
        ensure!(left <= asked.factor(Bound::Monotone) * dot(&found.residual, &error));
        let half = asked.factor(Bound::Pressure) / Exact::from(2);
        ensure!(apart <= half * half * certificate.rho_squared);
    }
    Verdict::Holds("inside")
}

/// The solver's result on a drawn problem, certified: A is positive definite, and u^h is as near as (C0) to (C2) say.
fn certified(draw: &Draw, rule: Rule, tenth: Option<Bound>) -> Verdict {
    of_solved(draw, rule, |d, u| {
        let (asked, nothing) =
            (Asked { share: 40, tenth }, |_: &[[Exact; 2]], _| Verdict::Holds(""));
        compared(&Certifier::new(d), &exactly(u), asked, false, &[], nothing)
    })
}

/// A tenth of the right side of each bound in turn, in full contact, where u^h is rational.
fn a_tenth() -> Outcome {
    let mut text = Vec::new();
    for bound in [Bound::Monotone, Bound::Energy, Bound::Displacement, Bound::Pressure] {
        for (rule, most) in [(P1, [2, 1]), (P2_BY_POINTS, [1, 1])] {
            let drawn = problems(most, NARROW);
            text.push(draws::reject(drawn, |draw| certified(draw, rule, Some(bound)))?);
        }
    }
    Ok(text.join("; "))
}

checks! {
    the_residual_bounds_the_distance_to_the_one_solution => on_small_meshes(|draw, rule| certified(draw, rule, None));
    control_a_tenth_of_the_radius_encloses => a_tenth();
}
