//! What `audit` concludes from the files of a certificate and from nothing else: the bound, the reservations, whose problem it
//! is; and what it shows of their text.

use std::fs;
use std::path::{Path, PathBuf};

use approx::{abs_diff_eq, assert_relative_eq};
use signorini::certificates::binding::compare;
use signorini::certificates::forces::Evidence;
use signorini::certificates::proof::{Claim, Role};
use signorini::certificates::{Continuous, Rejection, certify, certify_field};
use signorini::io::certificate::{self, Header};
use signorini::io::run;

use crate::common::{case, case_of, encoded};

const LOADED: &str = r#"
mesh.rectangle = { width = 1, height = 1, nx = 4, ny = 4 }
material = { lambda = 1, mu = 1 }
load.body = ["0.1", "-1 + 3*x"]
boundary.top.displacement = ["0.02", "-0.1 + 0.01*x"]
boundary.left.traction = ["0.1*y", "0"]
boundary.right.pressure = "0.05"
boundary.bottom.contact = { gap = "0.01*x" }
"#;

const CURVED_DATA: &str = r#"
mesh.rectangle = { width = 1, height = 1, nx = 4, ny = 4 }
material = { lambda = 1, mu = 1 }
load.body = ["0", "-sin(3*x)"]
boundary.top.displacement = ["0", "-0.1 + 0.01*sin(x)"]
boundary.left.traction = ["0.1*sin(y)", "0"]
boundary.bottom.contact = { gap = "0.01*sin(x)" }
"#;

const OBLIQUE: &str = r#"
mesh.trapezoid = { omega = 2.2, n = 4 }
material = { lambda = 1, mu = 1 }
boundary.left.normal = 0
boundary.bottom.displacement = ["0", "0"]
boundary.top.traction = ["0.1", "-0.02*x"]
boundary.right.contact = { gap = "0.005" }
"#;

const QUADRATIC: &[&str] = &["method.degree=2", "method.gamma0=auto"];
const ADAPTED: &[&str] =
    &["method.degree=2", "method.gamma0=auto", "adapt.target=\"0.1 %\"", "adapt.max_unknowns=900"];

fn certified(text: &str, settings: &[&str]) -> Continuous {
    let (case, solved) = run::solve(case_of(text, settings), None, &|_| {}).unwrap();
    match solved.certified {
        Some(certified) => certified.unwrap(),
        None => certify(&case.problem, &solved.solution).unwrap(),
    }
}

/// Writes a certificate into a folder of its own.
fn written(name: &str, header: &str, arrays: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("audit").join(name);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(certificate::FILES[1]), arrays).unwrap();
    let file = folder.join(certificate::FILES[0]);
    fs::write(&file, header).unwrap();
    file
}

#[test]
fn reservations_and_the_whole_bound_come_from_the_arrays() {
    let certified = certified(CURVED_DATA, &[]);
    let (header, arrays) = encoded(&certified);
    let json = |header: &Header| serde_json::to_string(header).unwrap();
    let audit = certificate::audit(&written("honest", &json(&header), &arrays)).unwrap();
    assert!(audit.header.bound >= certified.bound);
    // All triangles have the body force; four edges of the top and four of the floor are not affine, two of them at one triangle.
    let said = audit.reservations;
    assert_eq!((said.measured, said.turning), (certified.certificate.pieces.len(), 0));
    assert!((7..=8).contains(&said.lifted), "{said}");

    // The bound of the arrays without their lifts.
    let smaller = Header { bound: certified.proof.bound * (1.0 + 1e-9), ..header.clone() };
    assert!(smaller.bound < header.bound);
    let error = certificate::audit(&written("smaller", &json(&smaller), &arrays)).unwrap_err();
    assert!(error.to_string().contains("rejected: the claimed bound is"), "{error}");

    let rigorous = json(&header).replacen('{', "{\"rigorous\":true,", 1);
    let error = certificate::audit(&written("rigorous", &rigorous, &arrays)).unwrap_err();
    assert!(error.to_string().contains("unknown field `rigorous`"), "{error}");
}

/// Of a v that is outside the obstacle, so that nothing is pushed out.
#[test]
fn the_squares_of_the_indicators_are_those_of_the_bound_with_what_lifts_cost() {
    let bent = CURVED_DATA.replace("0.01*sin(x)", "0.02*sin(9*x)");
    let (case, solved) = run::solve(case_of(&bent, &[]), None, &|_| {}).unwrap();
    let v = certify(&case.problem, &solved.solution).unwrap().displacement;
    let certified = certify_field(&case.problem, &solved.solution, &v).unwrap();
    let squares: f64 = certified.indicators.iter().map(|x| x * x).sum();
    assert_relative_eq!(squares.sqrt(), certified.bound, max_relative = 1e-9);
    assert!(certified.bound > 1.0001 * certified.proof.bound, "control");
}

#[test]
fn the_corner_that_a_triangle_is_numbered_from_does_not_matter() {
    for (text, settings) in [(LOADED, &[][..]), (LOADED, QUADRATIC), (CURVED_DATA, QUADRATIC)] {
        let Continuous { mut certificate, proof, .. } = certified(text, settings);
        for _ in 0..2 {
            for piece in &mut certificate.pieces {
                piece.vertices.rotate_left(1);
                piece.edges.rotate_left(1);
                piece.body.rotate_left(1);
            }
            let turned = certificate.prove().unwrap();
            assert_relative_eq!(turned.bound, proof.bound, max_relative = 1e-9);
        }
        // Control: another body force at the same corners.
        certificate.pieces.iter_mut().for_each(|piece| piece.body.rotate_left(1));
        let other = certificate.prove().unwrap();
        assert!((other.bound / proof.bound - 1.0).abs() > 1e-6);
    }
}

#[test]
fn what_a_support_prescribes_along_itself_is_looked_at() {
    let prescribed = "boundary.top.displacement = [\"0.02\", \"-0.1 + 0.01*x\"]";
    for (tangential, is_affine) in [("0.02", true), ("0.02*sin(x)", false)] {
        let support = format!("boundary.top = {{ normal = -0.1, tangential = \"{tangential}\" }}");
        let found = certified(&LOADED.replace(prescribed, &support), &[]).reason;
        let said = "the displacement of 'top' is not known to be affine";
        assert_eq!(found.is_none_or(|reason| !reason.contains(said)), is_affine);
    }
}

#[test]
fn a_certificate_is_one_of_its_case() {
    for text in [LOADED, CURVED_DATA, OBLIQUE] {
        for settings in [&[][..], QUADRATIC, ADAPTED] {
            let certified = certified(text, settings);
            let adapted = certified.certificate.vertices.len()
                > case_of(text, &[]).problem.mesh.vertices().len();
            assert_eq!(adapted, settings == ADAPTED);
            let reason = compare(
                case_of(text, &[]).problem,
                &certified.certificate,
                &certified.quantities.evidence,
            )
            .unwrap();
            assert_eq!(reason.is_none(), certified.rigorous, "{text}{settings:?}: {reason:?}");
        }
    }
}

#[test]
fn a_certificate_is_not_one_of_another_case() {
    for settings in [&[][..], QUADRATIC, ADAPTED] {
        for (text, changes) in [
            (
                LOADED,
                &[
                    ("mu = 1 ", "mu = 1.0001 ", "stiffness"),
                    ("-1 + 3*x", "-1 + 3.0001*x", "body force"),
                    ("0.02\"", "0.020001\"", "displacement"),
                    ("0.1*y", "0.1001*y", "traction"),
                    ("\"0.05\"", "\"0.050001\"", "pressure"),
                    ("right.pressure = \"0.05\"", "right.traction = [\"-0.05\", \"0\"]", "acts"),
                    ("boundary.right.pressure = \"0.05\"", "", "nothing acts"),
                    ("0.01*x\" }", "0.009*x\" }", "gap"),
                    ("width = 1,", "width = 1.01,", "triangle"),
                    ("height = 1,", "height = 0.9,", "triangle"),
                ][..],
            ),
            (
                CURVED_DATA,
                &[
                    ("-sin(3*x)", "-sin(3.01*x)", "body force"),
                    ("0.1*sin(y)", "0.1*sin(1.01*y)", "traction"),
                    ("gap = \"0.01*sin(x)\"", "gap = \"0.01*sin(1.01*x)\"", "edge"),
                ],
            ),
            (
                OBLIQUE,
                &[
                    ("left.normal", "left.tangential", "direction"),
                    ("boundary.left.normal = 0", "", "displacement"),
                    ("omega = 2.2", "omega = 2.2001", "triangle"),
                ],
            ),
        ] {
            let certificate = certified(text, settings).certificate;
            for (from, to, difference) in changes {
                let other = text.replacen(from, to, 1);
                assert_ne!(other, text, "{from}");
                let found =
                    compare(case_of(&other, &[]).problem, &certificate, &Evidence::default())
                        .unwrap_err();
                assert!(found.to_string().contains(difference), "{from} -> {to}: {found}");
            }
        }
    }
}

#[test]
fn forces_have_the_names_of_their_boundaries() {
    let certified = certified(LOADED, &[]);
    let mut forces = certified.quantities.evidence;
    assert!(forces.names.len() > 1);
    forces.names.reverse();
    let certificate = &certified.certificate;
    let differs = |forces: &Evidence| {
        let found = compare(case_of(LOADED, &[]).problem, certificate, forces);
        found.is_err_and(|e| e.to_string().contains("boundary that it is said to be on"))
    };
    assert!(differs(&forces));
    forces.names.reverse();
    assert!(!differs(&forces), "control");
    // Each edge on each boundary that it is not on; inside the body there is none.
    for e in (0..certificate.edges.len()).step_by(3) {
        for k in (0..forces.names.len()).filter(|&k| forces.of[e] != Some(k)) {
            let mut wrong = forces.clone();
            wrong.of[e] = Some(k);
            assert!(differs(&wrong), "edge {e}, {}", forces.names[k]);
        }
    }
}

#[test]
fn what_is_measured_by_quadrature_is_measured_again_for_a_case() {
    for settings in [&[][..], QUADRATIC] {
        let whole = certified(CURVED_DATA, settings).certificate;
        let mut halved = whole.clone();
        halved.pieces[7].oscillation /= 2.0;
        let mut without = whole.clone();
        without.lifts.pop();
        let mut smaller = whole.clone();
        smaller.lifts[0].norm *= 0.99;
        for (certificate, difference) in
            [(halved, "the oscillation"), (without, "lacks its lift"), (smaller, "the lift")]
        {
            let found =
                compare(case_of(CURVED_DATA, &[]).problem, &certificate, &Evidence::default())
                    .unwrap_err();
            assert!(found.to_string().contains(difference), "{found}");
        }
    }
}

#[test]
fn what_is_measured_is_compared_to_nine_digits() {
    let whole = certified(CURVED_DATA, &[]).certificate;
    let found = |by: f64| {
        let mut of_loads = whole.clone();
        of_loads.pieces[7].oscillation *= 1.0 - by;
        let mut of_lifts = whole.clone();
        of_lifts.lifts[0].norm *= 1.0 - by;
        [of_loads, of_lifts].map(|certificate| {
            compare(case_of(CURVED_DATA, &[]).problem, &certificate, &Evidence::default()).is_ok()
        })
    };
    assert_eq!(found(5e-10), [true; 2]);
    assert_eq!(found(2e-9), [false; 2]);
}

/// d twice as long, and p half of that: the same traction.
#[test]
fn directions_are_from_half_as_long_as_a_unit_to_twice_that() {
    let whole = certified(OBLIQUE, &[]).certificate;
    let found = |by: f64| {
        let mut other = whole.clone();
        for edge in &mut other.edges {
            if let Role::Supported { along, force, .. } = &mut edge.role {
                *along = along.map(|d| d * by);
                *force = force.map(|p| p / by);
            }
        }
        other.frames.values_mut().for_each(|d| *d = d.map(|d| d * by));
        other.prove().map(|proof| proof.bound)
    };
    for (inside, outside) in [(1.999, 2.001), (0.501, 0.499)] {
        assert_relative_eq!(found(inside).unwrap(), found(1.0).unwrap(), max_relative = 1e-9);
        let refused = found(outside);
        assert!(
            matches!(refused, Err(Rejection::Wrong { what: "edge" | "point", .. })),
            "{outside}"
        );
    }
}

/// Moved by a part of the forces on its edges: 128 units of the last digit are allowed, and those of rounding are a few.
#[test]
fn a_triangle_may_be_out_of_balance_by_128_units_of_its_forces() {
    let honest = certified(OBLIQUE, &[]);
    let Continuous { certificate, proof, .. } = honest;
    let is_inner = |role: &Role| matches!(role, Role::Inner(_));
    let e = certificate.edges.iter().position(|edge| is_inner(&edge.role)).unwrap();
    let balances = |units: f64| {
        let mut moved = certificate.clone();
        let mut least = f64::INFINITY;
        for piece in certificate.pieces.iter().filter(|piece| piece.edges.contains(&e)) {
            let forces = piece.edges.map(|e| match certificate.edges[e].role {
                Role::Inner(f) | Role::Held(_, f) => f.as_flattened().iter().map(|f| f.abs()).sum(),
                _ => f64::NAN,
            });
            least = least.min(forces.iter().sum());
        }
        if let Role::Inner(force) = &mut moved.edges[e].role {
            force.iter_mut().for_each(|f| f[0] += units * f64::EPSILON * least);
        }
        let claim = Claim { shares: proof.shares.clone(), bound: 1.0, forces: Evidence::default() };
        !matches!(moved.audit(&claim), Err(Rejection::OutOfBalance { .. }))
    };
    assert!(balances(0.0) && balances(96.0));
    assert!(!balances(192.0));
}

#[test]
fn a_claimed_share_is_the_very_number_that_the_data_give() {
    let Continuous { certificate, proof, bound, .. } = certified(OBLIQUE, &[]);
    let audited = |shares: Vec<f64>| {
        let claim = Claim { shares, bound, forces: Evidence::default() };
        certificate.audit(&claim).map(|_| ())
    };
    assert_eq!(audited(proof.shares.clone()), Ok(()));
    let of = proof.shares.iter().position(|&share| share > 0.0).unwrap();
    for other in [proof.shares[of].next_up(), proof.shares[of].next_down()] {
        let mut shares = proof.shares.clone();
        shares[of] = other;
        let found = audited(shares);
        assert!(
            matches!(found, Err(Rejection::Share { triangle, .. }) if triangle == of),
            "{found:?}"
        );
    }
}

#[test]
fn the_text_of_a_file_is_shown_on_one_short_line() {
    let (header, arrays) = encoded(&certified(LOADED, &[]));
    let forged = "x\n  rigorous    yes\u{1b}[2J".repeat(10_000);
    let quoted = serde_json::to_string(&forged).unwrap();
    let json = serde_json::to_string(&header).unwrap();
    let key = json.replacen('{', &format!("{{{quoted}:1,"), 1);
    let mut renamed = header.clone();
    renamed.arrays[0].name = forged;
    for (name, json) in [("key", key), ("array", serde_json::to_string(&renamed).unwrap())] {
        let error = certificate::audit(&written(name, &json, &arrays)).unwrap_err().to_string();
        assert!(error.len() < 1000 && !error.contains(char::is_control), "{error}");
    }
}

#[test]
fn data_that_cancel_are_a_reservation_of_the_case() {
    let text = LOADED.replacen("-1 + 3*x", "((10*x + 1e18) - 1e18) - 4", 1);
    let certified = certified(&text, &[]);
    let reason = compare(
        case_of(&text, &[]).problem,
        &certified.certificate,
        &certified.quantities.evidence,
    )
    .unwrap();
    assert_eq!(reason, certified.reason);
    assert!(reason.unwrap().contains("cancel"));
}

#[test]
fn a_polygon_in_place_of_a_round_body_says_so() {
    let of_disk = || case("disk.toml", &[]);
    let (_, solved) = run::solve(of_disk(), None, &|_| {}).unwrap();
    let mut certificate = certify(&of_disk().problem, &solved.solution).unwrap().certificate;
    assert!(!certificate.polygon.is_empty() && certificate.reservations().is_empty());
    assert_eq!(compare(of_disk().problem, &certificate, &Evidence::default()), Ok(None));
    certificate.polygon.pop();
    let found =
        compare(of_disk().problem, &certificate, &Evidence::default()).unwrap_err().to_string();
    assert!(found.contains("part of a curved boundary"), "{found}");
}

#[test]
fn vertices_are_those_of_the_case_to_eleven_digits() {
    let certificate = certified(LOADED, &[]).certificate;
    let found = |by: f64| {
        let mut moved = certificate.clone();
        // One on the right side, along it.
        let vertex = moved.vertices.iter().position(|x| *x == [1.0, 0.5]).unwrap();
        moved.vertices[vertex][1] += by;
        compare(case_of(LOADED, &[]).problem, &moved, &Evidence::default())
    };
    assert!(found(0.0).is_ok() && found(1e-13).is_ok());
    assert!(found(1e-10).is_err());
}

#[test]
fn boundaries_without_forces_are_refused() {
    let (header, arrays) = encoded(&certified(LOADED, &[]));
    assert!(certificate::decode(&header, &arrays).is_ok());
    let plain =
        Header { boundaries: vec!["bottom".to_owned()], ..without_forces(&header, &arrays).0 };
    let (bare, bytes) = without_forces(&header, &arrays);
    assert!(certificate::decode(&bare, &bytes).is_ok(), "control: a bound alone");
    let error = certificate::decode(&plain, &bytes).unwrap_err();
    assert!(error.contains("boundaries without forces"), "{error}");
}

/// The files without the arrays that prove forces.
fn without_forces(header: &Header, arrays: &[u8]) -> (Header, Vec<u8>) {
    let first = header.arrays.iter().position(|array| array.name == "boundaries").unwrap();
    let words: usize = header.arrays[..first].iter().map(|a| a.words.len() * a.entries).sum();
    let bytes = arrays[..8 * words].to_vec();
    let kept = header.arrays[..first].to_vec();
    let hash = certificate::hash(&bytes);
    (Header { arrays: kept, boundaries: Vec::new(), hash, ..header.clone() }, bytes)
}

/// Of `[adapt]`, whose vertices lie between chord and curve of the round contact; a vertex off the curve by as much again is noticed.
#[test]
fn a_certificate_on_an_adapted_pin_is_one_of_its_case() {
    let of_pin = || case("pin.toml", &["adapt.target=\"0.5 %\""]);
    let (_, solved) = run::solve(of_pin(), None, &|_| {}).unwrap();
    let mut certificate = solved.certified.unwrap().unwrap().certificate;
    let of_case = |certificate: &_| compare(of_pin().problem, certificate, &Evidence::default());
    assert!(of_case(&certificate).is_ok());
    let radius = |x: &[f64; 2]| x[0].hypot(x[1]);
    let first = of_pin().problem.mesh.vertices().len();
    let moved = certificate.vertices.iter().enumerate().skip(first);
    let k = moved
        .map(|(k, x)| (k, radius(x)))
        .find(|(_, r)| abs_diff_eq!(*r, 20.0, epsilon = 1e-4))
        .unwrap()
        .0;
    let away = 20.05 / radius(&certificate.vertices[k]);
    certificate.vertices[k] = certificate.vertices[k].map(|x| x * away);
    assert!(of_case(&certificate).is_err());
}
