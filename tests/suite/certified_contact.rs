//! Certificates of bodies that contact alone holds, and of v pushed out of obstacles of every kind: what balances the loads is
//! the pressure on Gamma_C, and v is as far outside as balls can see.

use approx::{abs_diff_eq, assert_relative_eq};

use crate::certify::accepts;
use crate::common::{case_of, encoded, root};
use signorini::certificates::proof::{Certificate, Role};
use signorini::certificates::quantities::Name;
use signorini::certificates::{Continuous, Rejection, certify, certify_field};
use signorini::io::Case;
use signorini::solve::solve;

fn certified(text: &str, settings: &[&str]) -> Continuous {
    let case = case_of(text, settings);
    let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
    let certified = certify(&case.problem, &solution).unwrap_or_else(|e| panic!("{e}: {text}"));
    let (header, bytes) = encoded(&certified);
    assert_eq!(accepts(&header, &bytes), Ok(()), "{text}");
    certified
}

/// The certificate of a case of the folder `cases`.
fn of_the_cases(name: &str, settings: &[&str]) -> Continuous {
    let cases = root().join("cases");
    certified(&Case::text(&cases.join(name)).unwrap(), settings)
}

const SQUARE: &str = "[mesh]\nrectangle = { width = 1.0, height = 1.0, nx = 8, ny = 8 }\n[material]\nlambda = 1.0\nmu = 1.0\n";

/// The right half of a block, on a floor.
const HALF: &str = "[boundary.left]\nnormal = 0\n[boundary.top]\ntraction = [\"0\", \"-0.05 + 0.02*x\"]\n[boundary.bottom]\ncontact = { gap = \"0\" }\n";

/// A block that is free to slide on its floor.
const SLIDING: &str = "[load]\nbody = [\"0\", \"-0.1\"]\n[boundary.top]\npressure = \"0.05 + 0.02*x\"\n[boundary.bottom]\ncontact = { gap = \"0\" }\n";

/// Two rollers, a third side that comes to rest on a wall.
const ROLLERS: &str = "[boundary.left]\nnormal = 0\n[boundary.bottom]\ncontact = { gap = \"0\" }\n[boundary.top]\npressure = \"0.05\"\n[boundary.right]\ncontact = { gap = \"0.001*y\" }\n";

#[test]
fn bodies_that_contact_alone_holds_have_certificates_that_enclose_the_potential_energy() {
    for (text, has_stop) in [(HALF, false), (SLIDING, true), (ROLLERS, false)] {
        let text = format!("{SQUARE}{text}");
        let mut before: Option<(f64, [f64; 2])> = None;
        for degree in ["1", "2"] {
            for n in ["4", "8", "16"] {
                let settings =
                    ["mesh.rectangle.nx=", "mesh.rectangle.ny="].map(|s| s.to_owned() + n);
                let degree = format!("method.degree={degree}");
                let found = certified(&text, &[&settings[0], &settings[1], &degree]);
                assert!(found.rigorous && found.relative < 0.4, "{text}: {}", found.relative);
                assert!(found.proof.stop < 1e-12 && (has_stop || found.proof.stop == 0.0));
                let [low, high] = found.energy.unwrap();
                if let Some((bound, [l, h])) = before {
                    assert!(low.max(l) <= high.min(h), "{text}: {low} {l} {high} {h}");
                    // P2 starts on a mesh four times as wide.
                    let falls = found.bound < bound || n == "4";
                    assert!(falls, "{text}: {} after {bound}", found.bound);
                }
                before = Some((found.bound, [low, high]));
            }
        }
    }
}

/// It may turn about its centre, and it is the polygon of the mesh.
#[test]
fn the_disk_under_a_force_has_a_certificate_that_names_its_polygon_and_its_support() {
    for degree in ["1", "2"] {
        let found = of_the_cases(
            "disk_force.toml",
            &[&format!("method.degree={degree}"), "method.gamma0=auto"],
        );
        assert!(found.relative < 0.1, "{}", found.relative);
        let problem = found.problem.unwrap();
        assert!(problem.starts_with("the polygon of the mesh as its body"), "{problem}");
        assert!(found.proof.stop < 1e-10, "{}", found.proof.stop);
    }
}

fn every_pressure(certificate: &mut Certificate, factor: f64) {
    for edge in &mut certificate.edges {
        if let Role::Contact { pressure, .. } = &mut edge.role {
            *pressure = pressure.map(|p| p * factor);
        }
    }
}

#[test]
fn control_pressures_that_balance_nothing_are_rejected() {
    let text = format!("{SQUARE}{HALF}");
    let found = |factor: f64| {
        let mut certificate = certified(&text, &[]).certificate;
        every_pressure(&mut certificate, factor);
        certificate.prove()
    };
    assert!(found(1.0).is_ok());
    assert!(matches!(found(0.0), Err(Rejection::Unbalanced(_))), "{:?}", found(0.0));
    // The few edges that are to take the whole load would be multiplied by more than a hundred: a bound, and a bad one.
    assert!(found(0.01).unwrap().bound > 10.0 * found(1.0).unwrap().bound);
    // Where there is too much pressure, what is taken back is a tension.
    assert!(matches!(found(100.0), Err(Rejection::Tension { .. })), "{:?}", found(100.0));
}

#[test]
fn pressures_out_of_balance_have_the_bound_of_those_that_balance() {
    let text = format!("{SQUARE}{HALF}");
    let mut raised = certified(&text, &[]).certificate;
    // Off the floor, where the pressures count.
    raised.displacement.iter_mut().for_each(|v| v[1] += 0.2);
    let bound = |of: &Certificate| of.prove().unwrap().bound;
    let bounds = [0.7, 0.6].map(|factor| {
        let mut scaled = raised.clone();
        every_pressure(&mut scaled, factor);
        let mut balanced = scaled.clone();
        let state = scaled.balanced::<f64>(scaled.topology().unwrap()).unwrap();
        for change in &state.balance.changes {
            let Role::Contact { pressure, .. } = &mut balanced.edges[change.edge].role else {
                continue;
            };
            (0..2).for_each(|k| pressure[k] *= 1.0 + change.factors[k]);
        }
        // The pressures are put in balance in doubles.
        assert_relative_eq!(bound(&scaled), bound(&balanced), max_relative = 1e-9);
        bound(&scaled)
    });
    // Control: of other pressures it is another.
    assert!((bounds[0] - bounds[1]).abs() > 1e-3 * bounds[0], "{bounds:?}");
}

#[test]
fn control_a_force_along_the_floor_is_not_a_rounding_error() {
    let text = format!("{SQUARE}{SLIDING}");
    let found = certified(&text, &[]).certificate;
    let pushed = |force: f64| {
        let mut pushed = found.clone();
        let right = pushed.edges.iter_mut().find_map(|edge| match &mut edge.role {
            Role::Loaded(traction) => Some(traction),
            _ => None,
        });
        *right.unwrap() = [[force, 0.0]; 2];
        pushed.prove()
    };
    // 1e-10 of the forces on the boundary are one.
    let share = pushed(1e-12).unwrap().stop / 1e-12;
    assert!(share > 0.0 && pushed(0.9e-10 / share).is_ok());
    let refused = pushed(1.1e-10 / share);
    assert!(matches!(refused, Err(Rejection::Unbalanced(_))), "{refused:?}");
}

/// A wedge whose slanted side is a plane of symmetry.
const WEDGE: &str = "[mesh]\ntrapezoid = { omega = 2.2, n = 4 }\n[material]\nlambda = 1.0\nmu = 1.0\n[boundary.left]\nnormal = 0\n[boundary.top]\ndisplacement = [\"free\", \"-0.05\"]\n";

#[test]
fn a_roller_at_an_angle_may_meet_the_contact_line() {
    for gap in ["0", "0.001 + 0.01*x", "0.01*x"] {
        let text = format!("{WEDGE}[boundary.bottom]\ncontact = {{ gap = \"{gap}\" }}\n");
        for degree in ["method.degree=1", "method.degree=2"] {
            for n in ["4", "7", "16"] {
                let found = certified(&text, &[degree, &format!("mesh.trapezoid.n={n}")]);
                assert!(found.rigorous && !found.certificate.frames.is_empty());
            }
        }
    }
}

/// Blocks on a floor that slopes, on two floors at an angle, and far from the origin.
#[test]
fn v_is_pushed_out_of_slopes_and_of_two_floors_at_a_time() {
    let slope = "[obstacle.f]\nplane = { point = [0.0, -0.01], normal = [-0.3, 1.0] }\n[obstacle.w]\nplane = { point = [1.01, 0.0], normal = [-1.0, 0.05] }\n";
    let load = "[boundary.top]\ndisplacement = [\"0.03\", \"-0.05 - 0.01*x\"]\n[boundary.bottom]\ncontact = { obstacle = \"f\" }\n";
    let wall = "[boundary.right]\ncontact = { obstacle = \"w\" }\n";
    for walls in ["", wall] {
        let text = format!("{SQUARE}{slope}{load}{walls}");
        let text = if walls.is_empty() {
            text.replace("[obstacle.w]", "#").replace("plane = { point = [1.01", "#")
        } else {
            text
        };
        for degree in ["method.degree=1", "method.degree=2"] {
            for n in ["5", "16"] {
                let [nx, ny] = ["nx", "ny"].map(|k| format!("mesh.rectangle.{k}={n}"));
                let found = certified(&text, &[degree, &nx, &ny]);
                assert!(found.rigorous && found.relative < 1.0, "{}", found.relative);
            }
        }
    }
}

/// The bound is of what doubles leave of it, which is not 10 x - 4.
#[test]
fn a_load_whose_terms_cancel_in_doubles_makes_the_bound_say_so() {
    let of = |load: &str| {
        let rest = "[boundary.top]\ndisplacement = [\"0\", \"0\"]\n[boundary.bottom]\ncontact = { gap = \"0\" }\n";
        certified(&format!("{SQUARE}[load]\nbody = [\"0\", \"{load}\"]\n{rest}"), &[])
    };
    let (sound, lost) = (of("10*x - 4"), of("((10*x + 1e18) - 1e18) - 4"));
    assert!(sound.rigorous && sound.reason.is_none(), "{:?}", sound.reason);
    let reason = lost.reason.unwrap();
    assert!(!lost.rigorous && reason.starts_with("the body force is known to within"), "{reason}");
    assert!(reason.contains("as its terms cancel"), "{reason}");
}

/// On a plane the bound is rigorous, and of another body than the disk.
#[test]
fn a_polygon_is_named_where_the_boundary_is_taken_for_round() {
    let disk = of_the_cases("disk.toml", &[]);
    assert!(disk.rigorous);
    assert_eq!(disk.problem.as_deref(), Some("the polygon of the mesh as its body"));
    assert_eq!(of_the_cases("block.toml", &[]).problem, None);
}

#[test]
fn a_field_that_misses_what_is_prescribed_is_measured() {
    let text = format!("{SQUARE}{SLIDING}[boundary.left]\ndisplacement = [\"0.01*y\", \"free\"]\n");
    let case = case_of(&text, &[]);
    let (solution, _) = solve(&case.problem, &case.method, &case.settings).unwrap();
    let missed = |by: f64| {
        let moved: Vec<[f64; 2]> =
            solution.displacement.iter().map(|[x, y]| [x + by, y + 7.0]).collect();
        certify_field(&case.problem, &solution, &moved).unwrap().missed
    };
    assert!(missed(0.0) < 1e-12, "{}", missed(0.0));
    // The energy norm of both is the same.
    assert!(abs_diff_eq!(missed(1e3), 1e3, epsilon = 1e-9), "{}", missed(1e3));
}

/// A place of a certificate: of a vertex, or of a cut, which is numbered after these.
fn place(certificate: &Certificate, k: usize) -> [f64; 2] {
    certificate.vertices.get(k).copied().unwrap_or_else(|| {
        let cut = certificate.cuts[k - certificate.vertices.len()];
        let [a, b] = cut.ends.map(|end| certificate.vertices[end]);
        [0, 1].map(|c| a[c] + cut.at * (b[c] - a[c]))
    })
}

/// The gap in the middle of each edge of Gamma_C as a certificate has it, less `expected` of the places of its ends, its directions and
/// its gaps there: the largest one, with the number of edges.
fn off_in_the_middle(
    certificate: &Certificate,
    expected: impl Fn([[f64; 2]; 2], Option<[[f64; 2]; 2]>) -> f64,
) -> (f64, usize) {
    let data = &certificate.curved.as_ref().expect("v is quadratic").data;
    let mut found = (0.0_f64, 0);
    for (edge, bulge) in certificate.edges.iter().zip(data) {
        let Role::Contact { gap, along, .. } = edge.role else { continue };
        let places = edge.ends.map(|k| place(certificate, k));
        let middle = (gap[0] + gap[1]) / 2.0 + bulge[0];
        found = (found.0.max((middle - expected(places, along)).abs()), found.1 + 1);
    }
    found
}

const FLOOR: &str = "[method]\ndegree = 2\n[load]\nbody = [\"0\", \"-0.1\"]\n[boundary.top]\ndisplacement = [\"0\", \"-0.05 + 0.02*x\"]\n";

#[test]
fn a_gap_of_degree_two_is_itself_on_both_parts_of_an_edge_that_is_cut() {
    let text =
        format!("{SQUARE}{FLOOR}[boundary.bottom]\ncontact = {{ gap = \"0.3*(x - 0.37)^2\" }}\n");
    let certificate = certified(&text, &[]).certificate;
    let gap = |x: f64| 0.3 * (x - 0.37).powi(2);
    let middle = |places: [[f64; 2]; 2]| (places[0][0] + places[1][0]) / 2.0;
    let (off, count) = off_in_the_middle(&certificate, |places, _| gap(middle(places)));
    assert!(off <= 1e-14 && count >= 8, "{off}, {count} edges");
    let cut = certificate.edges.iter().filter(|edge| matches!(edge.role, Role::Contact { .. }));
    let first = certificate.vertices.len();
    let lengths: Vec<f64> = (cut.filter(|edge| edge.ends.iter().any(|&k| k >= first)))
        .map(|edge| {
            let [p, q] = edge.ends.map(|k| place(&certificate, k)[0]);
            (q - p).abs()
        })
        .collect();
    // At least one is cut elsewhere than in the middle: there the two parts differ.
    assert!(lengths.iter().any(|l| (l - 0.0625).abs() > 1e-3), "{lengths:?}");
    // Control: a gap that is steeper by a hundredth.
    let (off, _) = off_in_the_middle(&certificate, |places, _| 1.01 * gap(middle(places)));
    assert!(off > 1e-5, "{off}");
}

#[test]
fn the_gap_in_the_middle_of_an_edge_along_which_the_direction_turns_is_that_along_the_mean_direction()
 {
    let (center, radius) = ([0.45, -3.0], 3.0);
    let round = "[obstacle.round]\ncircle = { center = [0.45, -3.0], radius = 3.0, side = \"outside\" }\n[boundary.bottom]\ncontact = { obstacle = \"round\" }\n";
    let certificate = certified(&format!("{SQUARE}{FLOOR}{round}"), &[]).certificate;
    // At x: the distance from the circle, and the unit vector towards its centre.
    let seen = |x: [f64; 2]| {
        let to = [center[0] - x[0], center[1] - x[1]];
        let away = to[0].hypot(to[1]);
        (away - radius, to.map(|c| c / away))
    };
    // Beside a v of degree two an edge is cut in its middle: there is the gap of both parts.
    let first = certificate.vertices.len();
    let off = |factor: f64| {
        let (mut most, mut count) = (0.0_f64, 0);
        for edge in &certificate.edges {
            let Role::Contact { gap, along: Some(_), .. } = edge.role else { continue };
            for (gap, k) in gap.into_iter().zip(edge.ends) {
                let Some(cut) = k.checked_sub(first).map(|k| certificate.cuts[k]) else { continue };
                let [p, q] = cut.ends.map(|end| place(&certificate, end));
                if cut.at != 0.5 || cut.ends.iter().any(|&end| end >= first) {
                    continue;
                }
                let ((_, d), (_, e)) = (seen(p), seen(q));
                let (there, direction) = seen(place(&certificate, k));
                let cosine = (0..2).map(|c| (d[c] + e[c]) / 2.0 * direction[c]).sum::<f64>();
                most = most.max((gap - there * (1.0 + factor * (cosine - 1.0))).abs());
                count += 1;
            }
        }
        (most, count)
    };
    // A distance of 3 is known to some roundings.
    let (most, count) = off(1.0);
    assert!(most <= 1e-14 && count >= 8, "{most}, {count} ends");
    // Control: without the cosine.
    let (most, _) = off(0.0);
    assert!(most > 1e-9, "{most}");
}

/// An obstacle by its distance, over a block: a floor, by an expression or as a plane.
fn over(obstacle: &str, degree: usize) -> Continuous {
    let text = format!(
        "{SQUARE}[boundary.top]\ndisplacement = [\"0\", \"-0.05\"]\n[obstacle.o]\n{obstacle}\n[boundary.bottom]\ncontact = {{ obstacle = \"o\" }}\n"
    );
    certified(&text, &[&format!("method.degree={degree}")])
}

#[test]
fn an_obstacle_is_a_reservation_unless_its_distance_is_shown_affine() {
    // Three smooth ridges between the vertices, where the floor looks flat.
    let ridge = |x: f64| format!("max(0, 1 - ((x - {x})/0.0624)^2)^2");
    let ridges = [0.1875, 0.4375, 0.6875].map(ridge).join(" + ");
    let bump = format!("distance = \"y + 0.01 - 0.017*({ridges})\"");
    for degree in [1, 2] {
        for obstacle in
            [&*bump, "circle = { center = [0.5, -100], radius = 100, side = \"outside\" }"]
        {
            let found = over(obstacle, degree);
            let reason = found.reason.unwrap();
            assert!(
                !found.rigorous && reason.contains("on 'bottom' a direction and a gap"),
                "{reason}"
            );
        }
        // Controls: an expression that is affine, a plane.
        for obstacle in
            ["distance = \"y + 0.01\"", "plane = { point = [0, -0.01], normal = [0, 1] }"]
        {
            let found = over(obstacle, degree);
            assert!(found.rigorous && found.reason.is_none(), "{obstacle}: {:?}", found.reason);
        }
    }
    // The distance to a plane is a sum, which may cancel.
    let far = over("plane = { point = [3e9, -4e9], normal = [0.8, 0.6] }", 1);
    let reason = far.reason.unwrap();
    assert!(reason.contains("the distance of 'bottom' is known to within"), "{reason}");
}

const CURVED: &str = "disk_force.toml";
const GAUSS: &[&str] = &["mesh.rectangle.nx=32", "mesh.rectangle.ny=16", "method.degree=2"];

#[test]
fn pressures_that_are_not_the_moments_of_lambda_h_do_not_spoil_the_bound() {
    // Along a direction that turns: with what is out of balance carried along a tree it was 8.3 % and 1.7 %.
    assert!(of_the_cases("pin.toml", &["method.degree=2"]).relative < 0.03);
    assert!(of_the_cases(CURVED, &["method.degree=2", "method.gamma0=auto"]).relative < 0.012);
    // By a Gauss rule: 19 %, where the exact rule has 5.4 %.
    let of_rule = |rule: &str| {
        let rule = format!("method.contact_quadrature={rule}");
        of_the_cases("cantilever.toml", &[GAUSS, &[&rule]].concat())
    };
    let [gauss, exact] = ["{ gauss = 4 }", "exact"].map(of_rule);
    assert!(gauss.relative < 1.1 * exact.relative, "{} {}", gauss.relative, exact.relative);
    // Control: the mean pressure on each edge has other moments, and a tree carries them to the support.
    let mut spoilt = exact.certificate;
    for edge in &mut spoilt.edges {
        if let Role::Contact { pressure, .. } = &mut edge.role {
            *pressure = [(pressure[0] + pressure[1]) / 2.0; 2];
        }
    }
    let spoilt = spoilt.prove().unwrap();
    assert!(spoilt.bound > 1.5 * exact.bound, "{} {}", spoilt.bound, exact.bound);
}

#[test]
fn a_body_that_may_turn_about_its_obstacle_has_forces_between_two_numbers() {
    for degree in ["1", "2"] {
        let found =
            of_the_cases(CURVED, &[&format!("method.degree={degree}"), "method.gamma0=auto"]);
        for quantity in &found.quantities.list {
            let [low, high] = quantity.interval.clone().unwrap_or_else(|why| panic!("{why}"));
            assert!(low <= high, "{quantity:?}");
        }
        let force = found.quantities.list.iter().find(|q| q.name == Name::ContactComponent(1));
        let [low, high] = force.unwrap().interval.clone().unwrap();
        // The load, by statics.
        assert!(
            abs_diff_eq!(low, 8.5, epsilon = 1e-6) && abs_diff_eq!(high, 8.5, epsilon = 1e-6),
            "{low} {high}"
        );
    }
}
