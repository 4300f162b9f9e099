//! Certificates of Tresca's problem: the bound is above the error and near it, bodies at random are certified and audited, and what is
//! tampered with is refused.

use signorini::certificates::binding::compare;
use signorini::certificates::proof::{Claim, Edge, Law, Role};
use signorini::certificates::quantities::{Limit, Name, Zone};
use signorini::certificates::{Certificate, Continuous, Rejection, Target, adapt, certify, format};
use signorini::contact::Friction;
use signorini::kernel::Ball;
use signorini::model::{Condition, Degree, Problem};
use signorini::results::Solution;
use signorini::solve::{Settings, solve};

use crate::bodies::number_from;
use crate::common::exact::{slip_tip, stick_slip, with_friction};
use crate::common::*;
use crate::friction::with_random_friction;

fn solved(problem: &Problem, degree: Degree) -> Solution {
    let (solution, _) = solve(problem, &method(degree, EXACT), &Settings::default()).unwrap();
    assert_eq!(solution.verdict.name(), "proved");
    solution
}

/// What the shear lacks of its bound at least, on the edges of the floor between two places.
fn margin(certificate: &Certificate, [from, to]: [f64; 2]) -> f64 {
    let x = |p: usize| match p.checked_sub(certificate.vertices.len()) {
        None => certificate.vertices[p][0],
        Some(cut) => {
            let cut = certificate.cuts[cut];
            let [a, b] = cut.ends.map(|end| certificate.vertices[end][0]);
            a + cut.at * (b - a)
        }
    };
    let of = |edge: &Edge| {
        let Role::Contact { law: Law::Friction { shear, bound }, .. } = edge.role else {
            return f64::INFINITY;
        };
        let inside = edge.ends.iter().all(|&p| (from - 1e-12..=to + 1e-12).contains(&x(p)));
        let at = |k: usize| if inside { bound[k] - shear[k].abs() } else { f64::INFINITY };
        at(0).min(at(1))
    };
    certificate.edges.iter().map(of).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_bound_is_above_the_error_of_exact_solutions_and_falls_with_the_mesh() {
    for (exact, tip, degree, first, limit, rate) in [
        (slip_tip(), 0.5, Degree::One, 8, 1.5, 1.7),
        (slip_tip(), 0.5, Degree::Two, 4, 2.5, 2.2),
        (stick_slip(), 1.0 / 3.0, Degree::One, 8, 1.5, 1.7),
        (stick_slip(), 1.0 / 3.0, Degree::Two, 8, 2.5, 2.5),
    ] {
        let ladder = with_friction(&exact, degree, first);
        let mut last = f64::INFINITY;
        for level in 0..3 {
            let (_, problem, s) = ladder.solve(level).unwrap();
            let c = certify(&problem, &s).unwrap();
            let error = error_of(&problem, &exact, &c.displacement);
            let found = c.bound / error;
            println!("{degree:?} {level}: {found} {}", c.relative);
            assert!((1.0..=limit).contains(&found), "{found}");
            assert!(c.bound * rate <= last, "{} {last}", c.bound);
            last = c.bound;
            // What is proved to stick is where the exact solution does: (f) for x < 1/2, (e) for x < 1/3.
            let is_slip = |zone: &&Zone| matches!(zone.limit, Limit::Slip(_));
            let stuck: Vec<&Zone> = c.quantities.zones.iter().filter(is_slip).collect();
            for zone in &stuck {
                let Limit::Slip(most) = zone.limit else { continue };
                // M^2 over the least that the shear lacks of its bound, known to the balls in which it is found.
                let margin = margin(&c.certificate, zone.ends.map(|x| x[0]));
                let expected = c.quantities.mean_stress.powi(2) / margin;
                approx::assert_relative_eq!(most, expected, max_relative = 1e-9);
            }
            assert!(stuck.iter().all(|zone| zone.to <= tip + 1e-9), "{stuck:?}");
            assert!(
                level < 2 || degree == Degree::One || !stuck.is_empty(),
                "{:?}",
                c.quantities.zones
            );
        }
    }
}

#[test]
fn the_shear_of_exact_solutions_lies_between_its_numbers_which_near_each_other() {
    // int sigma_xy on the floor: of (f) by quadrature of its closed form, of (e) s - b c^4 / 4.
    for (exact, value, degree, first, rate) in [
        (stick_slip(), 0.05 - 0.2 / 4.0 / 81.0, Degree::One, 8, 1.5),
        (stick_slip(), 0.05 - 0.2 / 4.0 / 81.0, Degree::Two, 4, 1.5),
    ] {
        let ladder = with_friction(&exact, degree, first);
        let mut last = f64::INFINITY;
        for level in 0..3 {
            let (_, problem, s) = ladder.solve(level).unwrap();
            let c = certify(&problem, &s).unwrap();
            let of = |name| c.quantities.list.iter().find(|q| q.name == name).unwrap();
            // The floor pulls the body back.
            let [low, high] = of(Name::ContactComponent(0)).interval.clone().unwrap();
            println!("{degree:?} {level}: {low} <= {} <= {high}", -value);
            assert!(low <= -value && -value <= high, "{low} {high}");
            assert!((high - low) * rate <= last, "{low} {high}");
            last = high - low;
            // The floor presses where walls hold the body.
            let why = of(Name::ContactForce).interval.clone().unwrap_err();
            assert!(why.contains("the force of one alone has no bound"), "{why}");
        }
        println!("{last}");
    }
}

/// A block of n x n cells on a rough floor, moved by its top; all data are affine.
fn block(n: usize, [turn, drag, bound]: [f64; 3]) -> Problem {
    let top = [format!("{drag} + {turn}*x/2"), format!("-0.05 - {turn}*x")];
    let top = [0, 1].map(|c| Some(expression(&top[c])));
    let bound = expression(&format!("{bound}*(1 + x)"));
    let problem = Problem::of(unit_square(n).mesh().unwrap(), unit_material());
    Problem { body_force: [expression("0"), expression("0")], ..problem }
        .with("top", Condition::Displacement(top))
        .with("bottom", Condition::Contact { gap: expression("0") })
        .with_friction("bottom", Friction::Tresca(bound))
}

/// J(v) with the energy of friction, int s |v_t|, at least and at most: by the values of the edges' ends, of v itself where it is affine.
fn energy(c: &Continuous) -> [f64; 2] {
    let (v, points) = (c.certificate.shape::<Ball>(), c.certificate.places::<Ball>());
    let mut work = [0.0; 2];
    for (e, edge) in c.certificate.edges.iter().enumerate() {
        let Role::Contact { law: Law::Friction { bound, .. }, .. } = edge.role else { continue };
        let [x, y] = edge.ends.map(|p| points[p].x.centre());
        let [a, b] = edge.ends.map(|p| v.points[p].x.centre());
        let bulge = v.bulges.as_ref().map_or(0.0, |bulges| bulges[e].x.centre());
        let count = 1000;
        let rule = (0..count).map(|i| {
            let s = (f64::from(i) + 0.5) / f64::from(count);
            let slip = (1.0 - s) * a + s * b + 4.0 * s * (1.0 - s) * bulge;
            ((1.0 - s) * bound[0] + s * bound[1]) * slip.abs()
        });
        let mean = rule.sum::<f64>() / f64::from(count);
        // The midpoint rule is off by less than this part.
        work[0] += (y - x).abs() * mean * (1.0 - 1e-5);
        work[1] += (y - x).abs() * mean * (1.0 + 1e-5);
    }
    [c.proof.energy[0] + work[0], c.proof.energy[1] + work[1]]
}

/// int |v_t| on the floor between two places, by the ends of edges.
fn slip_between(c: &Continuous, [from, to]: [f64; 2]) -> f64 {
    let (v, points) = (c.certificate.shape::<f64>(), c.certificate.places::<f64>());
    let of = |edge: &Edge| {
        let [a, b] = edge.ends.map(|p| (points[p].x, v.points[p].x.abs()));
        let inside = a.0.min(b.0) >= from - 1e-9 && a.0.max(b.0) <= to + 1e-9;
        if inside { (b.0 - a.0).abs() * (a.1 + b.1) / 2.0 } else { 0.0 }
    };
    let rough = |edge: &&Edge| matches!(edge.role, Role::Contact { .. });
    c.certificate.edges.iter().filter(rough).map(of).sum()
}

#[test]
fn a_mesh_is_adapted_to_a_bound_of_a_problem_with_friction() {
    for (degree, relative) in [(Degree::One, 0.05), (Degree::Two, 0.01)] {
        let problem = block(4, [0.01, 0.02, 0.016]);
        let target = Target { relative, max_unknowns: 20_000 };
        let how = (&method(degree, EXACT), &Settings::default());
        let (problem, adapted) = adapt(problem, how.0, how.1, target, &|_| {}).unwrap();
        let c = adapted.certified.unwrap();
        println!("{degree:?}: {:?}", adapted.levels.iter().map(|l| l.relative).collect::<Vec<_>>());
        assert!(adapted.unmet.is_none() && c.relative <= relative, "{:?}", adapted.unmet);
        assert_eq!(compare(problem, &c.certificate, &c.quantities.evidence), Ok(None));
    }
}

#[test]
fn no_certificate_of_a_block_at_random_is_false_beside_one_on_a_finer_mesh() {
    let (mut both, mut telling, mut stuck, mut far) = (0, 0, 0, 0);
    for seed in 1..=40 {
        let mut random = Random(seed);
        random.next();
        let data =
            [random.between(-0.03, 0.03), random.between(-0.04, 0.04), random.decades(-3.5, -1.0)];
        let (n, degree) = (random.whole(2, 6), DEGREES[random.below(2)]);
        let certified = |n: usize| {
            let problem = block(n, data);
            let s = solved(&problem, degree);
            let slides = s.boundaries[0].friction.unwrap();
            let c = certify(&problem, &s).unwrap();
            assert!(c.rigorous, "{:?}", c.reason);
            // Half the square of the bound is about J without the work of friction.
            assert_eq!((c.energy, c.compliance), (None, None));
            let (header, bytes) = encoded(&c);
            let audit = format::audit(header, &bytes).unwrap();
            assert_eq!(compare(problem, &audit.certificate, &audit.forces), Ok(None));
            (c, slides)
        };
        let ((coarse, slides), (fine, _)) = (certified(n), certified(4 * n));
        // Normal force, shear and moment lie between their numbers on both meshes; a fifth of the width is not always enough.
        for (of, finer) in coarse.quantities.list.iter().zip(&fine.quantities.list) {
            let [[low, high], [least, most]] = [of, finer].map(|q| q.interval.clone().unwrap());
            assert!(low <= most && least <= high, "seed {seed}: {:?}", of.name);
            if most < f64::INFINITY {
                let off = 0.05 * (high - low);
                assert!(
                    low - off <= finer.value && finer.value <= high + off,
                    "seed {seed}: {:?}: {low} {} {high}",
                    of.name,
                    finer.value
                );
                let middle = (low + high) / 2.0;
                far += usize::from((finer.value - middle).abs() > 0.1 * (high - low));
            }
        }
        both += usize::from(slides.sticks > 0.05 && slides.slides > 0.05);
        // J(v) - J(u) is at least half the square of the distance and at most half that of the bound.
        let below = |c: &Continuous| energy(c)[0] - c.bound * c.bound / 2.0;
        assert!(below(&coarse) <= energy(&fine)[1], "seed {seed}");
        assert!(below(&fine) <= energy(&coarse)[1], "seed {seed}");
        for Zone { from, to, limit, .. } in &coarse.quantities.zones {
            if let Limit::Slip(most) = limit {
                stuck += 1;
                let slip = slip_between(&fine, [*from, *to]);
                assert!(slip <= *most, "seed {seed}: {slip} {most}");
            }
        }
        // The control: half the bound is false on many.
        let half = energy(&coarse)[0] - coarse.bound * coarse.bound / 8.0;
        telling += usize::from(half > energy(&fine)[1]);
        assert!(fine.bound < 0.7 * coarse.bound, "seed {seed}: {} {}", fine.bound, coarse.bound);
    }
    println!(
        "{both} stick and slide, {telling} with half the bound, {stuck} stretches, {far} forces"
    );
    assert!(both >= 5 && telling >= 20 && stuck >= 1, "{both} {telling} {stuck}");
    assert!(far >= 8, "{far}");
}

#[test]
fn bodies_at_random_with_friction_have_certificates_and_these_are_of_their_problems() {
    let from = number_from("SIGNORINI_BODIES_FROM", 1);
    let count = number_from("SIGNORINI_BODIES", 20);
    let (mut certified, mut missed) = (0, Vec::new());
    for seed in from..from + count {
        let body = with_random_friction(seed);
        let Ok((solution, _)) = solve(&body.problem, &body.method, &Settings::default()) else {
            continue;
        };
        if solution.verdict.name() != "proved" {
            continue;
        }
        certified += 1;
        let outcome = certify(&body.problem, &solution).map_err(|error| error.to_string());
        let outcome = outcome.and_then(|c| {
            let (header, bytes) = encoded(&c);
            let audit = format::audit(header, &bytes).map_err(|error| error.to_string())?;
            compare(body.problem.clone(), &audit.certificate, &audit.forces)
                .map_err(|error| error.to_string())
        });
        if let Err(error) = outcome {
            missed.push(format!("seed {seed}: {}: {error} [{}]", body.kind, body.said));
        }
    }
    println!("{certified} certificates\n{}", missed.join("\n"));
    assert!(2 * certified >= count, "{certified}");
    assert!(20 * missed.len() as u64 <= certified, "{}", missed.join("\n"));
}

#[test]
fn a_certificate_with_friction_that_is_tampered_with_is_refused() {
    for degree in DEGREES {
        let problem = block(6, [0.01, 0.02, 0.016]);
        let s = solved(&problem, degree);
        let of = s.boundaries[0].friction.unwrap();
        assert!(of.sticks > 0.1 && of.slides > 0.1, "{of:?}");
        let c = certify(&problem, &s).unwrap();
        let claim =
            Claim { shares: c.proof.shares.clone(), bound: c.bound, forces: Default::default() };
        assert!(c.certificate.audit(&claim).is_ok());
        let law = |edge: &Edge| match edge.role {
            Role::Contact { law: Law::Friction { shear, bound }, .. } => Some((shear, bound)),
            _ => None,
        };
        // An edge on which it slides from end to end.
        let slides = |e: &usize| {
            law(&c.certificate.edges[*e]).is_some_and(|(shear, bound)| shear == bound.map(|s| -s))
        };
        let e = (0..c.certificate.edges.len()).find(slides).unwrap();
        let with = |change: fn(&mut [f64; 2], &mut [f64; 2])| {
            let mut certificate = c.certificate.clone();
            if let Role::Contact { law: Law::Friction { shear, bound }, .. } =
                &mut certificate.edges[e].role
            {
                change(shear, bound);
            }
            certificate
        };
        // One unit in the last place over the bound.
        let over = with(|shear, _| shear[0] = shear[0].next_down());
        assert!(matches!(over.prove(), Err(Rejection::Friction { .. })));
        let nan = with(|_, bound| bound[1] = f64::NAN);
        assert!(matches!(nan.prove(), Err(Rejection::Wrong { .. })));
        // Where the direction turns the shear is the same at both ends, as the pressure is.
        let turning = |given: [f64; 2]| {
            let mut certificate = c.certificate.clone();
            let Role::Contact { pressure: [p, _], law: Law::Friction { bound, .. }, .. } =
                certificate.edges[e].role
            else {
                panic!("friction")
            };
            certificate.edges[e].role = Role::Contact {
                pressure: [p; 2],
                gap: [0.01; 2],
                along: Some([[0.0, -1.0], [1e-6, -1.0]]),
                law: Law::Friction { shear: given, bound },
            };
            certificate.prove()
        };
        assert!(matches!(turning([0.0, 1e-9]), Err(Rejection::Wrong { what: "edge", .. })));
        let control = turning([1e-9; 2]);
        assert!(control.is_ok(), "{control:?}");
        // With the wrong sign it is not in balance; made so, it costs what it does to slide.
        let sign = with(|shear, _| *shear = shear.map(|q| -q));
        assert!(matches!(sign.audit(&claim), Err(Rejection::OutOfBalance { .. })));
        assert!(sign.prove().unwrap().bound > 1.01 * c.proof.bound);
        // A larger bound is one of another problem: sliding is not at the bound.
        let larger = with(|_, bound| *bound = bound.map(|s| 1.1 * s));
        assert!(larger.prove().unwrap().bound > c.proof.bound);
        let evidence = &c.quantities.evidence;
        let difference = compare(problem.clone(), &larger, evidence).unwrap_err().to_string();
        assert!(difference.contains("the bound of friction"), "{difference}");
        let without: Certificate = {
            let mut certificate = c.certificate.clone();
            for edge in &mut certificate.edges {
                if let Role::Contact { law, .. } = &mut edge.role {
                    *law = Law::Contact;
                }
            }
            certificate
        };
        let difference = compare(problem, &without, evidence).unwrap_err().to_string();
        assert!(difference.contains("another law of contact"), "{difference}");
        assert!(matches!(without.audit(&claim), Err(Rejection::OutOfBalance { .. })));
    }
}
