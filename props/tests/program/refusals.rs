//! Certificates that are wrong in one thing, which the checker must refuse for its own reason.

use signorini::certificates::Rejection;
use signorini::certificates::Rejection::{
    Length, NotPrescribed, Orientation, OutOfBalance, Penetration, Tension, Unbalanced, Wrong,
};
use signorini::certificates::proof::{Certificate, Claim as Said, Edge, Law, Prescribed, Role};
use signorini::kernel::{Ball, Material, Plane, PreciseBall};

use super::by_hand::{Draw, supported};
use props::claim::{Outcome, text};

/// One thing that the theorem does not allow, how it is planted, and whether this is the reason.
type Tampering = (&'static str, fn(&mut Certificate), fn(&Rejection) -> bool);

/// `"what" => reason, how it is planted;` for each.
macro_rules! tamperings {
    ($($what:literal => $reason:pat, $change:expr;)*) => {
        &[$(($what, $change, |why| matches!(why, $reason))),*]
    };
}

const IS_HELD: fn(&Role) -> bool = |role| matches!(role, Role::Held(..));
const IS_INNER: fn(&Role) -> bool = |role| matches!(role, Role::Inner(_));
const IS_CONTACT: fn(&Role) -> bool = |role| matches!(role, Role::Contact { .. });

/// Changes the pressure and the gap of the first edge of Gamma_C.
fn of_contact(c: &mut Certificate, change: impl Fn(&mut [f64; 2], &mut [f64; 2])) {
    let first = c.edges.iter_mut().find(|edge| IS_CONTACT(&edge.role));
    if let Some(Role::Contact { pressure, gap, .. }) = first.map(|edge| &mut edge.role) {
        change(pressure, gap);
    }
}

/// Makes the direction of contact turn along the first edge of Gamma_C, under a pressure and over a gap.
fn turn_contact(c: &mut Certificate, pressure: [f64; 2], gap: f64, end: [f64; 2]) {
    if let Some(edge) = c.edges.iter_mut().find(|edge| IS_CONTACT(&edge.role)) {
        edge.role = Role::Contact {
            pressure,
            gap: [gap; 2],
            along: Some([[0.0, -1.0], end]),
            law: Law::Contact,
        };
    }
}

/// The vertices of the first edge of Gamma_C.
fn ends_on_contact(c: &Certificate) -> [usize; 2] {
    c.edges.iter().find(|edge| IS_CONTACT(&edge.role)).map_or([0; 2], |edge| edge.ends)
}

/// What is wrong with a force in a direction that is free.
const NOT_HELD: &str = "a force where nothing is held";

/// Lets all held edges go but for one component, in which they stay held, and puts a force on the first of them.
fn hold_one(c: &mut Certificate, component: usize, force: [[f64; 2]; 2]) {
    let mut first = Some(force);
    for edge in &mut c.edges {
        if let Role::Held(held, old) = &mut edge.role {
            held[1 - component] = false;
            old.iter_mut().for_each(|f| f[1 - component] = 0.0);
            *old = first.take().unwrap_or(*old);
        }
    }
    c.prescribed.iter_mut().for_each(|data| data[1 - component] = None);
    release_bulges(c, 1 - component);
}

/// Takes the bulges of u_D in a component away.
fn release_bulges(c: &mut Certificate, component: usize) {
    let Some(curved) = &mut c.curved else { return };
    for (data, edge) in curved.data.iter_mut().zip(&c.edges) {
        if !IS_CONTACT(&edge.role) {
            data[component] = 0.0;
        }
    }
}

/// Lets the body go where it is held, without pressure on Gamma_C.
fn hold_nothing(c: &mut Certificate) {
    for edge in &mut c.edges {
        match &mut edge.role {
            Role::Held(_, force) => edge.role = Role::Loaded(*force),
            Role::Contact { pressure, .. } => *pressure = [0.0; 2],
            _ => {}
        }
    }
    c.prescribed.fill([None; 2]);
    (0..2).for_each(|component| release_bulges(c, component));
}

/// Moves v through the obstacle at the start of Gamma_C.
fn penetrate(c: &mut Certificate) {
    let [a, _] = ends_on_contact(c);
    let first = c.edges.iter().find(|edge| IS_CONTACT(&edge.role));
    if let Some(Role::Contact { gap, .. }) = first.map(|edge| edge.role) {
        c.displacement[a][1] = -gap[0] - 1e-6;
    }
}

/// v . d is 0 at both ends of an edge and positive between them; on the next edge v stays below its gap.
fn penetrate_between_turning_ends(c: &mut Certificate) {
    let [a, b] = ends_on_contact(c);
    c.displacement[a] = [0.0625, 0.0];
    c.displacement[b] = [0.0, -0.0625];
    turn_contact(c, [-1.0; 2], 0.0, [1.0, 0.0]);
}

/// Calls an inner edge loaded.
fn open_an_inner_edge(c: &mut Certificate) {
    if let Some(edge) = c.edges.iter_mut().find(|edge| IS_INNER(&edge.role)) {
        edge.role = Role::Loaded([[0.0; 2]; 2]);
    }
}

/// The last prescribed vector.
fn of_prescribed(c: &mut Certificate, change: impl Fn(&mut [Option<f64>; 2])) {
    c.prescribed.last_mut().into_iter().for_each(change);
}

const TAMPERINGS: &[Tampering] = tamperings! {
    "a tension at one end" => Tension { .. }, |c| of_contact(c, |pressure, _| pressure[1] = 1e-3);
    "a pressure that is no number" => _, |c| of_contact(c, |pressure, _| pressure[0] = f64::NAN);
    "v through the obstacle by 1e-6" => Penetration { .. }, penetrate;
    "a gap that is smaller than v takes" => Penetration { .. }, |c| of_contact(c, |_, gap| *gap = [-3.0; 2]);
    "v through the obstacle between ends along which the direction turns" => Penetration { .. },
        penetrate_between_turning_ends;
    "a pressure that varies along a direction that turns" => Wrong { .. },
        |c| turn_contact(c, [-1.0, -2.0], 9.0, [0.6, -0.8]);
    "a prescribed value that v misses by a rounding error" => NotPrescribed { at: Prescribed { is_between: false, component: Some(_), .. }, .. },
        |c| of_prescribed(c, |u| u[0].iter_mut().for_each(|u| *u = u.next_up()));
    "an end of Gamma_D without a prescribed value" => Wrong { .. }, |c| of_prescribed(c, |u| u[1] = None);
    "a prescribed value off Gamma_D" => Wrong { .. },
        |c| c.prescribed[0] = [Some(c.displacement[0][0]), None];
    "a force where nothing is held, at the start" => Wrong { what: "edge", problem: NOT_HELD, .. },
        |c| hold_one(c, 0, [[0.0, 1.0], [0.0, 0.0]]);
    "a force where nothing is held, at the end" => Wrong { what: "edge", problem: NOT_HELD, .. },
        |c| hold_one(c, 1, [[0.0, 0.0], [1.0, 0.0]]);
    "a body that nothing holds" => Unbalanced(_), hold_nothing;
    "a triangle that is clockwise" => Orientation { .. }, |c| c.vertices[0] = [5.0, 5.0];
    "a triangle without area" => Orientation { .. }, |c| c.vertices[0] = c.vertices[1];
    "a shear modulus of zero" => Wrong { .. },
        |c| c.pieces[0].material = Material::lame(1.0, 0.0, Plane::Strain);
    "lambda + mu that is not positive" => Wrong { .. }, |c| {
        let mu = c.pieces[0].material.mu();
        c.pieces[0].material = Material::lame(-mu, mu, Plane::Strain);
    };
    "a negative oscillation" => Wrong { .. }, |c| c.pieces[0].oscillation = -1e-3;
    "a place that is no number" => Wrong { .. }, |c| c.vertices[1][0] = f64::NAN;
    "a displacement that is missing" => Length { .. }, |c| {
        c.displacement.pop();
    };
    "a triangle with an edge of other vertices" => Wrong { .. }, |c| c.pieces[0].edges.swap(0, 1);
    "an inner edge with one triangle" => Wrong { .. }, |c| {
        c.pieces.pop();
    };
    "an inner edge that is called loaded, where tractions may jump" => Wrong { .. }, open_an_inner_edge;
};

/// v_n - g on the first edge of Gamma_C with the values 0, 0 and -1 at its start, middle and end: 1/8 at a quarter.
fn through_between_the_nodes(c: &mut Certificate) {
    let [a, b] = ends_on_contact(c);
    c.displacement[a] = [0.0; 2];
    c.displacement[b] = [0.0, 1.0];
    of_contact(c, |_, gap| *gap = [0.0; 2]);
    of_bulges(c, IS_CONTACT, |bulge, data| (*bulge, *data) = ([0.0, -0.5], [0.0; 2]));
}

/// A change of the bulges of the first edge of a kind.
fn of_bulges(
    c: &mut Certificate,
    of: impl Fn(&Role) -> bool,
    change: impl Fn(&mut [f64; 2], &mut [f64; 2]),
) {
    let first = c.edges.iter().position(|edge| of(&edge.role));
    if let (Some(e), Some(curved)) = (first, &mut c.curved) {
        change(&mut curved.bulges[e], &mut curved.data[e]);
    }
}

/// What else the theorem does not allow of a v that is quadratic.
const QUADRATIC_TAMPERINGS: &[Tampering] = tamperings! {
    "v through the obstacle between the three nodes of an edge" => Penetration { .. },
        through_between_the_nodes;
    "a gap that bulges into v" => Penetration { .. }, |c| of_bulges(c, IS_CONTACT, |_, data| data[0] = -9.0);
    "v through the obstacle between ends along which the direction turns" => Penetration { .. }, |c| {
        turn_contact(c, [-1.0; 2], 9.0, [0.6, -0.8]);
        of_bulges(c, IS_CONTACT, |bulge, _| *bulge = [0.0, -30.0]);
    };
    "a prescribed bulge that v misses by a rounding error" => NotPrescribed { at: Prescribed { is_between: true, component: Some(0), .. }, .. },
        |c| of_bulges(c, IS_HELD, |bulge, _| bulge[0] = bulge[0].next_up());
    "a bulge of data inside the body" => Wrong { .. }, |c| of_bulges(c, IS_INNER, |_, data| data[1] = 0.125);
    "a second bulge of a gap" => Wrong { .. }, |c| of_bulges(c, IS_CONTACT, |_, data| data[1] = 0.125);
    "a bulge that is no number" => Wrong { .. },
        |c| of_bulges(c, IS_INNER, |bulge, _| bulge[0] = f64::NAN);
    "a bulge that is missing" => Length { .. },
        |c| c.curved.iter_mut().for_each(|curved| curved.bulges.truncate(3));
    "a value at a cut that is not there" => Length { .. },
        |c| c.curved.iter_mut().for_each(|curved| curved.at_cuts.push([0.0; 2]));
};

/// What is claimed of a certificate that is as it was made.
fn claimed(certificate: &Certificate) -> Result<Said, String> {
    let proof = certificate.evaluate::<Ball>().map_err(text)?;
    Ok(Said { shares: proof.shares, bound: proof.bound, forces: Default::default() })
}

/// A body of 2 x 2 cells that the draws may be.
fn example() -> Draw {
    let v = (0..16).map(|k| [(k * 7) % 11 - 5, (k * 5) % 13 - 6]).collect();
    let (cells, lame, tau) = ([2, 2], [12, 16], [3, -4, 5, -6, -2, 1, 2]);
    Draw { cells, left: true, lame, v, tau, gap: [2, 1], oscillation: 0, curve: Vec::new() }
}

/// The example with a v that is quadratic.
fn quadratic_example() -> Draw {
    Draw { curve: (0..5).map(|k| [(k * 7) % 11 - 5, (k * 5) % 9 - 4]).collect(), ..example() }
}

/// Each of these changes, or none, of a certificate that is accepted as it was made, is refused for its own reason.
fn refused(good: &Certificate, tamperings: &[Tampering], tamper: bool) -> Result<(), String> {
    good.evaluate::<Ball>().map_err(|e| format!("refused as it was made: {e}"))?;
    for (what, change, reason) in tamperings {
        let mut certificate = good.clone();
        if tamper {
            change(&mut certificate);
        }
        for found in [certificate.evaluate::<Ball>(), certificate.evaluate::<PreciseBall>()] {
            match found {
                Ok(proof) => return Err(format!("{what}: accepted with {}", proof.bound)),
                Err(why) if !reason(&why) => return Err(format!("{what}: refused, but: {why}")),
                Err(_) => {}
            }
        }
    }
    Ok(())
}

/// A traction that is off by 1e-9 is out of balance.
fn refused_out_of_balance(unbalanced: &Certificate) -> Result<(), String> {
    match unbalanced.audit(&claimed(unbalanced)?) {
        Err(OutOfBalance { .. }) => Ok(()),
        other => Err(format!("a traction that is off by 1e-9: {other:?}")),
    }
}

/// Every tampering is refused, for its own reason; without one the certificate is accepted.
pub fn refusals(tamper: bool) -> Outcome {
    let good = example().certificate();
    refused(&good, TAMPERINGS, tamper)?;
    let quadratic = quadratic_example().certificate();
    refused(&quadratic, TAMPERINGS, tamper)?;
    refused(&quadratic, QUADRATIC_TAMPERINGS, tamper)?;
    // What is claimed must follow, and the certificate be as it was made.
    let said = claimed(&good)?;
    good.audit(&said).map_err(|e| format!("refused as it was made: {e}"))?;
    let smaller = Said { bound: said.bound.next_down(), ..said.clone() };
    let mut other = said.clone();
    other.shares[0] = other.shares[0].next_up();
    let fewer = Said { shares: said.shares[1..].to_vec(), ..said };
    if [smaller, other, fewer].iter().any(|wrong| good.audit(wrong).is_ok()) {
        return Err("a claim that does not follow is accepted".to_owned());
    }
    let mut unbalanced = good;
    let inner = unbalanced.edges.iter_mut().find(|edge| IS_INNER(&edge.role));
    if let Some(Edge { role: Role::Inner(force), .. }) = inner {
        force[0][0] += 1e-9;
    }
    refused_out_of_balance(&unbalanced)?;
    let count = 2 * TAMPERINGS.len() + QUADRATIC_TAMPERINGS.len();
    Ok(format!("{count} tamperings and 4 claims"))
}

/// Changes the direction and the traction of the first edge that is held along a direction.
fn of_support(c: &mut Certificate, change: impl Fn(&mut [f64; 2], &mut [f64; 2])) {
    for edge in &mut c.edges {
        if let Role::Supported { along, traction, .. } = &mut edge.role {
            return change(along, traction);
        }
    }
}

/// A point that is held along a direction alone.
fn framed(c: &Certificate) -> usize {
    c.frames.keys().next_back().copied().unwrap_or_default()
}

/// Gives a point where nothing is prescribed a direction.
fn frame_a_free_point(c: &mut Certificate) {
    let free = |k: &usize| c.prescribed[*k] == [None; 2];
    let k = (0..c.vertices.len()).find(free).unwrap_or_default();
    c.frames.insert(k, [0.6, 0.8]);
}

/// What the theorem does not allow where bodies are held along directions.
const SUPPORT_TAMPERINGS: &[Tampering] = tamperings! {
    "v . d off what is prescribed by 1e-12" => NotPrescribed { at: Prescribed { is_between: false, component: None, .. }, .. }, |c| {
        let k = framed(c);
        c.displacement[k][0] += 1e-12;
    };
    "a value along a support that v misses by 1e-12" => NotPrescribed { at: Prescribed { is_between: false, component: None, .. }, .. }, |c| {
        let k = framed(c);
        c.prescribed[k][0].iter_mut().for_each(|w| *w += 1e-12);
    };
    "a support that is turned at one end" => Wrong { .. }, |c| {
        c.frames.insert(framed(c), [0.6, 0.8]);
    };
    "a support that is turned along an edge" => Wrong { .. }, |c| of_support(c, |d, _| *d = [0.6, 0.8]);
    "a support along nothing" => Wrong { .. }, |c| of_support(c, |d, _| *d = [0.0; 2]);
    "a traction beside a support that is no number" => Wrong { .. },
        |c| of_support(c, |_, traction| traction[1] = f64::NAN);
    "a frame where nothing is prescribed" => Wrong { .. }, frame_a_free_point;
};

/// Every tampering with supports is refused, and a bulge and a traction that are off by 1e-9.
pub fn refusals_of_supports(tamper: bool) -> Outcome {
    for draw in [example(), quadratic_example()] {
        let mut pulled = supported(&draw);
        refused(&pulled, SUPPORT_TAMPERINGS, tamper)?;
        pulled.audit(&claimed(&pulled)?).map_err(|e| format!("refused as it was made: {e}"))?;
        of_support(&mut pulled, |_, traction| traction[0] += 1e-9);
        refused_out_of_balance(&pulled)?;
    }
    let mut bulging = supported(&quadratic_example());
    let supported = |role: &Role| matches!(role, Role::Supported { .. });
    of_bulges(&mut bulging, supported, |bulge, _| bulge[0] += 1e-9);
    match bulging.evaluate::<Ball>() {
        Err(NotPrescribed { at: Prescribed { is_between: true, component: None, .. }, .. }) => {}
        other => return Err(format!("a bulge that is off by 1e-9: {other:?}")),
    }
    Ok(format!("{} tamperings", 2 * SUPPORT_TAMPERINGS.len() + 3))
}
