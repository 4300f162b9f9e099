//! Bodies of revolution at random: rings, cylinders and cones on flat, conical and round obstacles, on supports or held by contact
//! alone. SIGNORINI_BODIES sets how many are drawn.

use approx::abs_diff_eq;
use signorini::model::{Condition, Obstacle, Problem, Side};
use signorini::solve::{ContactQuadrature, Gamma0, Method, solve};

use super::*;

struct Drawn {
    said: String,
    problem: Problem,
    method: Method,
    held_by_contact: bool,
}

fn draw(seed: u64) -> Drawn {
    let mut dice = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let degree = dice.pick(&DEGREES);
    let inner = if dice.one_in(2) { 0.0 } else { dice.decades(-1.5, 1.5) };
    let [width, height] = [dice.decades(-0.5, 0.5), dice.decades(-0.5, 0.5)];
    let cells = [dice.whole(2, 7), dice.whole(2, 7)];
    let lean = if inner > 0.0 { dice.between(-0.2, 0.2) } else { 0.0 };
    let flat = meridian([inner, inner + width], height, cells, dice.one_in(2));
    let mesh = moved_to(&flat, |[r, z]| {
        // A cone, and a bottom that is not flat.
        let bulge = 0.1 * height * (r - inner) / width * (1.0 - z / height);
        [r + lean * z * inner / (inner + height), z - bulge * f64::from(u8::from(lean > 0.0))]
    });
    let poisson =
        if dice.one_in(4) { 0.5 - dice.decades(-6.0, -1.0) } else { dice.between(-0.3, 0.45) };
    let material = elastic(1.0, poisson);
    let share = if dice.one_in(3) { dice.decades(-6.0, -0.3) } else { dice.between(0.05, 0.95) };
    let gamma0 = Gamma0::Local(share);
    let quadrature = if dice.one_in(3) { ContactQuadrature::Gauss(4) } else { EXACT };
    let held_by_contact = dice.one_in(3);
    let size = 0.02 * height;
    let obstacle = match dice.below(4) {
        0 => Obstacle::Plane { point: [0.0, -dice.between(0.0, 0.5) * size], normal: [0.0, 1.0] },
        1 => {
            let slope: f64 = dice.between(-0.3, 0.3);
            let far = if slope > 0.0 { inner + width } else { inner };
            let length = slope.hypot(1.0);
            Obstacle::Plane { point: [far, -0.1 * height], normal: [-slope / length, 1.0 / length] }
        }
        _ => {
            let radius = dice.decades(0.3, 1.0) * (inner + width);
            Obstacle::Circle { center: [0.0, -radius - 0.1 * height], radius, side: Side::Outside }
        }
    };
    let problem = Problem::of(mesh, material).with("bottom", Condition::obstacle("o", obstacle));
    let problem = if held_by_contact {
        problem.with("top", Condition::pressure(move |_| 0.01))
    } else {
        let down = -dice.between(1.0, 8.0) * size;
        problem.with("top", Condition::displacement(|_| 0.0, move |_| down))
    };
    let said = format!(
        "seed {seed}: {degree:?} r from {inner} by {width} x {height}, {cells:?} cells, nu {poisson}, share {share:e}, {quadrature:?}, {}",
        if held_by_contact { "held by contact" } else { "held" }
    );
    let method = Method { degree, gamma0, quadrature, allow_noncoercive: false };
    Drawn { said, problem, method, held_by_contact }
}

#[test]
fn bodies_of_revolution_at_random_are_proved_and_their_forces_balance() {
    let number = |name: &str, default| {
        std::env::var(name).ok().map_or(default, |text: String| text.parse::<u64>().unwrap())
    };
    let (from, count) = (number("SIGNORINI_BODIES_FROM", 1), number("SIGNORINI_BODIES", 40));
    let (mut unproved, mut touching) = (Vec::new(), 0);
    for seed in from..from + count {
        let Drawn { said, problem, method, held_by_contact } = draw(seed);
        let s = match solve(&problem, &method, &Settings::default()) {
            Ok((s, _)) => s,
            Err(error) => panic!("{said}: {error}"),
        };
        let proved = s.verdict == signorini::results::Verdict::Proved
            && s.enclosure.as_ref().is_ok_and(|e| e.relative.is_none_or(|r| r <= 1e-6));
        if !proved {
            unproved.push(format!("{said}: {:?}", s.enclosure.as_ref().err()));
        }
        // Contact, loads and reactions balance along the axis.
        let loads: f64 = if held_by_contact {
            let edges = problem.mesh.edges_of("top").unwrap();
            let area = edges.iter().map(|&e| {
                let [a, b] = problem.mesh.ends(e).map(|v| problem.mesh.vertices()[v]);
                std::f64::consts::PI * (a[0] + b[0]) * (b[0] - a[0]).abs()
            });
            -0.01 * area.sum::<f64>()
        } else {
            s.quantities.reactions["top"][1]
        };
        let contact = s.quantities.contact_resultant[1];
        let size = contact.abs().max(loads.abs());
        touching += u64::from(contact > 0.0);
        assert!(
            abs_diff_eq!(contact, -loads, epsilon = 1e-8 * size + 1e-14),
            "{said}: {contact} {loads}"
        );
    }
    for said in &unproved {
        println!("not proved: {said}");
    }
    assert!(2 * touching > count, "{touching} of {count} touch their obstacle");
    assert!(100 * unproved.len() as u64 <= count, "{unproved:#?}");
}
