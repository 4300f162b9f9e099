//! Row 24 where bodies are held along directions, with tractions beside them: the certificates by hand, held along (1, 1) and (1, -1), so
//! that v . d and the parts of tau N are doubles still.

use signorini::certify::Rejection;
use signorini::certify::proof::{Certificate, Role};
use signorini::kernel::Ball;

use super::{
    CLASSES, Draw, Tampering, claimed, draws_of, evaluated_of, example, of_bulges,
    quadratic_example,
};
use crate::claim::{Check, Outcome, noticed};
use crate::draws;
use crate::verdict::Verdict;

/// The same held along (1, 1) alone at the top and along (1, -1) at the left side, where tau's traction across is the one that is given.
fn supported(draw: &Draw) -> Certificate {
    // v is known as balls, which a margin keeps off the obstacle.
    let mut certificate = Draw { gap: [1, draw.gap[1].max(0)], ..draw.clone() }.turned();
    certificate.prescribed.fill([None; 2]);
    let v = certificate.displacement.clone();
    for (e, edge) in certificate.edges.iter_mut().enumerate() {
        let [p, q] = edge.ends.map(|k| certificate.vertices[k]);
        let left = p[0] == 0.0 && q[0] == 0.0;
        let length = if left { p[1] - q[1] } else { 1.0 };
        let (d, traction) = match edge.role {
            // The cells are one wide.
            Role::Held(_, force) => ([1.0, 1.0], force),
            Role::Loaded(traction) if left => ([1.0, -1.0], traction),
            _ => continue,
        };
        let along = |f: [f64; 2]| f[0] * d[0] + f[1] * d[1];
        edge.role = Role::Supported {
            along: d,
            force: traction.map(|t| length * along(t) / 2.0),
            traction: traction.map(|t| (d[0] * t[1] - d[1] * t[0]) / 2.0),
        };
        for k in edge.ends {
            let before = certificate.frames.insert(k, d);
            if before.is_some_and(|before| before != d) || certificate.prescribed[k][1].is_some() {
                certificate.frames.remove(&k);
                certificate.prescribed[k] = v[k].map(Some);
            } else {
                certificate.prescribed[k] = [Some(along(v[k])), None];
            }
        }
        if let Some(curved) = &mut certificate.curved {
            curved.data[e] = [along(curved.bulges[e]), 0.0];
        }
    }
    certificate
}

/// The checker against the definitions; `work` is the share of the work of what is given beside them that is counted.
fn evaluated_with_supports(draw: &Draw, work: f64) -> Verdict {
    evaluated_of::<Ball>(draw, supported(draw), [1.0, work])
}

/// Changes the role of the first edge that is held along a direction.
fn of_support(certificate: &mut Certificate, change: impl Fn(&mut [f64; 2], &mut [f64; 2])) {
    for edge in &mut certificate.edges {
        if let Role::Supported { along, traction, .. } = &mut edge.role {
            return change(along, traction);
        }
    }
}

/// A point that is held along a direction alone.
fn framed(certificate: &Certificate) -> usize {
    certificate.frames.keys().next_back().copied().unwrap_or_default()
}

/// What the theorem does not allow where bodies are held along directions.
const SUPPORT_TAMPERINGS: [Tampering; 7] = [
    (
        "v . d off what is prescribed by 1e-12",
        |c| {
            let k = framed(c);
            c.displacement[k][0] += 1e-12;
        },
        |why| matches!(why, Rejection::NotPrescribedAlong { .. }),
    ),
    (
        "a value along a support that v misses by 1e-12",
        |c| {
            let k = framed(c);
            c.prescribed[k][0].iter_mut().for_each(|w| *w += 1e-12);
        },
        |why| matches!(why, Rejection::NotPrescribedAlong { .. }),
    ),
    (
        "a support that is turned at one end",
        |c| {
            let k = framed(c);
            c.frames.insert(k, [0.6, 0.8]);
        },
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a support that is turned along an edge",
        |c| of_support(c, |d, _| *d = [0.6, 0.8]),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a support along nothing",
        |c| of_support(c, |d, _| *d = [0.0; 2]),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a traction beside a support that is no number",
        |c| of_support(c, |_, traction| traction[1] = f64::NAN),
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
    (
        "a frame where nothing is prescribed",
        |c| {
            let free = |k: &usize| c.prescribed[*k] == [None; 2];
            let k = (0..c.vertices.len()).find(free).unwrap_or_default();
            c.frames.insert(k, [0.6, 0.8]);
        },
        |why| matches!(why, Rejection::Wrong { .. }),
    ),
];

/// Every tampering with supports is refused, and a bulge and a traction that are off by 1e-9.
fn refusals_of_supports(tamper: bool) -> Outcome {
    for draw in [example(), quadratic_example()] {
        for (what, change, reason) in &SUPPORT_TAMPERINGS {
            let mut certificate = supported(&draw);
            if tamper {
                change(&mut certificate);
            }
            match certificate.evaluate::<Ball>() {
                Ok(proof) => return Err(format!("{what}: accepted with {}", proof.bound)),
                Err(why) if !reason(&why) => return Err(format!("{what}: refused, but: {why}")),
                Err(_) => {}
            }
        }
        let mut pulled = supported(&draw);
        pulled.audit(&claimed(&pulled)?).map_err(|e| format!("refused as it was made: {e}"))?;
        of_support(&mut pulled, |_, traction| traction[0] += 1e-9);
        match pulled.audit(&claimed(&pulled)?) {
            Err(Rejection::OutOfBalance { .. }) => {}
            other => return Err(format!("a traction that is off by 1e-9: {other:?}")),
        }
    }
    let mut bulging = supported(&quadratic_example());
    of_bulges(
        &mut bulging,
        |role| matches!(role, Role::Supported { .. }),
        |bulge, _| bulge[0] += 1e-9,
    );
    match bulging.evaluate::<Ball>() {
        Err(Rejection::NotPrescribedAlongBetween { .. }) => {}
        other => return Err(format!("a bulge that is off by 1e-9: {other:?}")),
    }
    Ok(format!("{} tamperings", 2 * SUPPORT_TAMPERINGS.len() + 3))
}

/// The checks of the row.
pub(super) fn checks() -> Vec<Check> {
    vec![
        exact!("the_checker_finds_what_the_definitions_say_of_supports" => draws::hold(60, draws_of(false), &CLASSES, |draw| evaluated_with_supports(draw, 1.0))),
        exact!("control_what_is_given_beside_supports_does_no_work" => draws::reject(draws_of(false), |draw| evaluated_with_supports(draw, 0.0))),
        doubles!("the_checker_refuses_supports_that_the_theorem_does_not_allow" => refusals_of_supports(true)),
        doubles!("control_supports_as_they_were_made_are_refused" => noticed(refusals_of_supports(false))),
    ]
}
