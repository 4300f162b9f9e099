//! What refuses a certificate, a force or a case says why, each in its own words: one change for each reason.

use std::collections::BTreeSet;

use signorini::certificates::binding::compare;
use signorini::certificates::forces::{Evidence, Lifting};
use signorini::certificates::format::{self, hash, read_header};
use signorini::certificates::proof::{Certificate, Cut, Edge, Role};
use signorini::certificates::{Continuous, certify};
use signorini::contact::Friction;
use signorini::io::certificate::Header;
use signorini::io::run;
use signorini::kernel::{Material, Plane};
use signorini::model::material::stable;
use signorini::model::{Condition, Mesh, Problem};
use signorini::solve::{Gamma0, Method, Settings, solve};

use crate::common::{case_of, encoded, unit_material, unit_square};

/// Held along an oblique direction, on an edge that is fixed at one of its ends.
const OBLIQUE: &str = r#"
mesh.trapezoid = { omega = 2.2, n = 3 }
material = { lambda = 1, mu = 1 }
boundary.left.normal = 0
boundary.bottom.displacement = ["0", "0"]
boundary.top.traction = ["0.1", "-0.02*x"]
boundary.right.contact = { gap = "0.005" }
"#;

/// Two bodies, the lower one wider than the upper one.
const BLOCKS: &str = r#"
mesh.gmsh = "../tests/recorded/blocks.msh"
material.lower = { young = 1, poisson = 0.3 }
material.upper = { young = 3, poisson = 0.2 }
boundary.base.displacement = [0, 0]
boundary.top.displacement = ["0.02", "-0.05 + 0.01*x"]
[[pair]]
boundaries = ["table", "foot"]
"#;

/// Loaded on one side, with forces to second order.
const FLOOR: &str = r#"
mesh.rectangle = { width = 1, height = 1, nx = 3, ny = 3 }
material = { lambda = 1, mu = 1 }
load.body = ["0", "-1 + 3*x"]
boundary.top.displacement = ["0", "-0.1"]
boundary.left.traction = ["0.1*y", "0"]
boundary.bottom.contact.gap = "0.01*x"
certify.quantities = ["force bottom"]
"#;

const DEGREES: [&str; 2] = ["method.degree=1", "method.degree=2"];

fn certified(text: &str, degree: &str) -> (Problem, Continuous) {
    let (case, solved) = run::solve(case_of(text, &[degree]), None, &|_| {}).unwrap();
    let certified = match solved.certified {
        Some(certified) => certified.unwrap(),
        None => certify(&case.problem, &solved.solution).unwrap(),
    };
    (case.problem, certified)
}

#[test]
fn what_is_no_file_of_a_certificate_is_refused_in_words_of_its_own() {
    let (header, bytes) = encoded(&certified(BLOCKS, "method.degree=1").1);
    let of_json = |json: &str| read_header(json.as_bytes()).unwrap_err().to_string();
    assert_eq!(
        of_json("{}"),
        "this is no certificate: missing field `format` at line 1 column 2; expected certificate.json, as signorini solve --certificate writes it"
    );
    assert_eq!(
        of_json(r#"{"format": 1}"#),
        format!(
            "the certificate is of format 1; expected {}, the one that this program writes and verifies",
            header.format
        )
    );
    assert_eq!(read_header(&serde_json::to_vec(&header).unwrap()).unwrap(), header, "control");
    let refused = |header: &Header, bytes: &[u8]| {
        format::audit(header.clone(), bytes)
            .map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
    };
    // The hash of other bytes.
    let forged = |change: &dyn Fn(&mut Header, &mut Vec<u8>)| {
        let (mut header, mut bytes) = (header.clone(), bytes.clone());
        change(&mut header, &mut bytes);
        header.hash = hash(&bytes);
        refused(&header, &bytes)
    };
    assert_eq!(forged(&|_, _| {}), "accepted", "control");
    let other = Header { hash: "0".repeat(16), ..header.clone() };
    let words = format!("its hash is {}; certificate.json says \"0000000000000000\"", header.hash);
    assert_eq!(refused(&other, &bytes), words);
    for more in [&[0; 8][..], &[1], &[2]] {
        let found = forged(&|_, bytes| bytes.extend(more));
        assert_eq!(found, "it has more bytes than the arrays");
        // The bytes after the last word count.
        let longer = [&bytes[..], more].concat();
        assert!(refused(&header, &longer).starts_with("its hash is "), "{more:?}");
    }
    let last = header.arrays.last().unwrap();
    for entries in [last.entries + 1, usize::MAX] {
        let found = forged(&|header, _| header.arrays.last_mut().unwrap().entries = entries);
        assert_eq!(found, format!("it ends before the last word of {:?}", last.name));
    }
    let name = &header.arrays[0].name;
    let found = forged(&|header, _| header.arrays[1].name.clone_from(name));
    assert_eq!(found, format!("two arrays are called {name:?}"));
    // Of the second pair the first edge is that of the first pair.
    let before = header.arrays.iter().take_while(|array| array.name != "pairs");
    let start = 8 * before.map(|array| array.words.len() * array.entries).sum::<usize>();
    let first = u64::from_le_bytes(bytes[start..start + 8].try_into().unwrap());
    let found = forged(&|_, bytes| bytes.copy_within(start..start + 8, start + 16));
    assert_eq!(found, format!("edge {first} faces two edges"));
}

/// What is said of a certificate after a change.
fn after(certificate: &Certificate, change: impl Fn(&mut Certificate)) -> String {
    let mut changed = certificate.clone();
    change(&mut changed);
    changed.prove().map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

#[test]
fn what_the_theorem_does_not_allow_is_refused_in_words_of_its_own() {
    for degree in DEGREES {
        let certificate = &certified(OBLIQUE, degree).1.certificate;
        assert_eq!(after(certificate, |_| {}), "accepted", "control");
        let edge = certificate.pieces[0].edges[0];
        let twice = after(certificate, |c| c.pieces.push(c.pieces[0]));
        assert_eq!(twice, format!("edge {edge}: two triangles on the same side"));
        let infinite = after(certificate, |c| c.pieces[0].oscillation = 1e200);
        assert_eq!(infinite, "the bound is not a finite number");
        let first = |is: &dyn Fn(&Role) -> bool, point: usize| {
            let has = |edge: &Edge| is(&edge.role) && edge.ends.contains(&point);
            certificate.edges.iter().position(has).unwrap()
        };
        // The same direction, but longer.
        let (&point, _) = certificate.frames.first_key_value().unwrap();
        let longer = after(certificate, |c| {
            c.frames.values_mut().for_each(|d| *d = d.map(|d| 1.5 * d));
        });
        let edges = certificate.edges.iter().position(|e| matches!(e.role, Role::Supported { .. }));
        let words = "an end without a value along the direction that is held";
        assert_eq!(longer, format!("edge {}: {words}", edges.unwrap()));
        let without = after(certificate, |c| c.frames.clear());
        assert!(without.ends_with(": a prescribed value off Gamma_D"), "{without}");
        assert!(certificate.prescribed[point][1].is_none(), "control");
        // A point that is fixed has a value along a direction alone.
        let held = |role: &Role| matches!(role, Role::Held([true, true], _));
        let fixed = certificate.edges.iter().find(|edge| held(&edge.role)).unwrap().ends[0];
        let framed = after(certificate, |c| {
            c.prescribed[fixed] = [Some(0.0), None];
            c.frames.insert(fixed, [0.6, 0.8]);
        });
        let words = "an end without a prescribed value";
        assert_eq!(framed, format!("edge {}: {words}", first(&held, fixed)));
    }
}

/// Each cut is moved by itself: the edges beside it face the right place at their other ends.
#[test]
fn a_cut_that_is_moved_faces_another_place_than_in_the_case() {
    let (problem, Continuous { certificate, .. }) = certified(BLOCKS, "method.degree=2");
    let of_case = |certificate: &_| compare(problem.clone(), certificate, &Evidence::default());
    assert!(of_case(&certificate).is_ok(), "control");
    let ends = certificate.facing.keys().flat_map(|&edge| certificate.edges[edge].ends);
    let on_pair: BTreeSet<usize> =
        ends.filter_map(|end| end.checked_sub(certificate.vertices.len())).collect();
    assert!(on_pair.len() >= 8);
    for k in on_pair {
        let mut moved = certificate.clone();
        moved.cuts[k].at += 0.01;
        let found = of_case(&moved).map_err(|error| error.to_string());
        let words = ["does not face what it faces", "is in contact in part, or with several"];
        assert!(found.is_err_and(|error| words.iter().any(|words| error.contains(words))), "{k}");
    }
}

#[test]
fn a_point_that_is_tied_has_no_other_direction_and_no_other_value() {
    let words = "is tied to another place than what is prescribed";
    for law in ["sliding", "bonded"] {
        let text = format!("{BLOCKS}law = \"{law}\"\n");
        let certificate = &certified(&text, "method.degree=2").1.certificate;
        assert_eq!(after(certificate, |_| {}), "accepted", "control");
        let ties = |edge: &Edge| matches!(edge.role, Role::Contact { .. });
        let tied = certificate.edges.iter().filter(|edge| ties(edge)).flat_map(|edge| edge.ends);
        let vertices = certificate.vertices.len();
        let tied: BTreeSet<usize> = tied.filter(|&point| point < vertices).collect();
        assert!(tied.len() > 2);
        for point in tied {
            // A value across the direction, which no support asks for.
            let framed = after(certificate, |c| {
                c.prescribed[point] = [Some(0.0), None];
                c.frames.insert(point, [0.6, 0.8]);
            });
            assert_eq!(framed, format!("point {point}: {words}"), "{law}");
            // A value along it that is not that of the other body.
            let held = after(certificate, |c| c.prescribed[point] = [None, Some(1e-3)]);
            assert_eq!(held, format!("point {point}: {words}"), "{law}");
        }
    }
}

#[test]
fn what_is_not_that_of_the_case_is_told_in_words_of_its_own() {
    let answer =
        |problem: &Problem, certificate: &Certificate, change: &dyn Fn(&mut Certificate)| {
            let mut changed = certificate.clone();
            change(&mut changed);
            compare(problem.clone(), &changed, &Evidence::default())
                .map_or_else(|error| error.to_string(), |_| "the case's".to_owned())
        };
    let (problem, Continuous { certificate, .. }) = certified(FLOOR, "method.degree=1");
    let of_floor = |change: &dyn Fn(&mut Certificate)| answer(&problem, &certificate, change);
    assert_eq!(of_floor(&|_| {}), "the case's", "control");
    let no_part = of_floor(&|c| {
        c.cuts.push(Cut { ends: [0, 15], at: 0.5 });
        c.pieces[3].vertices[0] = c.vertices.len() + c.cuts.len() - 1;
    });
    assert_eq!(no_part, "triangle 3 is no part of one between three vertices");
    let beyond = of_floor(&|c| c.vertices[0] = [-0.1, -0.1]);
    let first = certificate.pieces.iter().position(|piece| piece.vertices.contains(&0)).unwrap();
    assert_eq!(beyond, format!("triangle {first} lies in no triangle of the case's mesh"));
    // A crack from a vertex inside the body: the triangle beside it has another one at the same place.
    let inside = (0..certificate.vertices.len())
        .find(|&k| certificate.vertices[k].iter().all(|x| (0.1..0.9).contains(x)))
        .unwrap();
    let cracked = of_floor(&|c| {
        let copy = c.vertices.len();
        let place = c.vertices[inside];
        c.vertices.push(place);
        // Cuts are numbered after the vertices.
        let points = c.pieces.iter_mut().flat_map(|piece| &mut piece.vertices);
        points.filter(|p| **p >= copy).for_each(|p| *p += 1);
        let piece = c.pieces.iter_mut().find(|piece| piece.vertices.contains(&inside)).unwrap();
        piece.vertices.iter_mut().filter(|p| **p == inside).for_each(|p| *p = copy);
    });
    let words = "begins an edge that is on no boundary of the case";
    assert!(cracked.starts_with("vertex ") && cracked.ends_with(words), "{cracked}");
    let inner = certificate.edges.iter().position(|e| matches!(e.role, Role::Inner(_))).unwrap();
    let loaded = of_floor(&|c| c.edges[inner].role = Role::Loaded([[0.0; 2]; 2]));
    assert_eq!(loaded, format!("edge {inner} is on no boundary of the case"));

    let (problem, Continuous { certificate, .. }) = certified(BLOCKS, "method.degree=1");
    let of_blocks = |change: &dyn Fn(&mut Certificate)| answer(&problem, &certificate, change);
    assert_eq!(of_blocks(&|_| {}), "the case's", "control");
    // The end of contact is a cut between an edge of contact and one where nothing acts.
    let of_contact = |role: &Role| matches!(role, Role::Contact { .. } | Role::Facing);
    let is_end = |p: usize| {
        let has = |edge: &&Edge| edge.ends.contains(&p);
        let own = || certificate.edges.iter().filter(has).map(|edge| edge.role);
        own().any(|role| of_contact(&role)) && own().any(|role| matches!(role, Role::Loaded(_)))
    };
    let cut = (0..certificate.cuts.len()).find(|k| is_end(certificate.vertices.len() + k)).unwrap();
    let moved = of_blocks(&|c| c.cuts[cut].at += 0.25 * (0.5 - c.cuts[cut].at));
    assert!(moved.ends_with(" is in contact in part, or with several"), "{moved}");
}

#[test]
fn what_proves_no_force_is_refused_in_words_of_its_own() {
    let Continuous { certificate, quantities, .. } = certified(FLOOR, "method.degree=2").1;
    let whole = quantities.evidence;
    assert!(!whole.liftings.is_empty() && !whole.pairs.is_empty(), "control");
    let answer = |change: &dyn Fn(&mut Evidence)| {
        let mut changed = whole.clone();
        change(&mut changed);
        let found = certificate.prove_forces(&changed);
        let first = found.map(|all| all.into_iter().find_map(Result::err));
        match first {
            Ok(None) => "accepted".to_owned(),
            Ok(Some(error)) => error.to_string(),
            Err(error) => error.to_string(),
        }
    };
    assert_eq!(answer(&|_| {}), "accepted", "control");
    let [vertices, edges] = [certificate.vertices.len(), certificate.edges.len()];
    let entries =
        |found: usize, expected: usize| format!("w has {found} entries; expected {expected}");
    let of_w = |change: fn(&mut Lifting)| {
        answer(&|evidence: &mut Evidence| change(&mut evidence.liftings[0].1))
    };
    let fewer = of_w(|w| {
        w.vertices.pop();
    });
    assert_eq!(fewer, entries(vertices - 1, vertices));
    let at_cuts = of_w(|w| w.beyond.iter_mut().for_each(|[cuts, _]| cuts.push([0.0; 2])));
    assert_eq!(at_cuts, entries(certificate.cuts.len() + 1, certificate.cuts.len()));
    let between = of_w(|w| w.beyond.iter_mut().for_each(|[_, bulges]| bulges.push([0.0; 2])));
    assert_eq!(between, entries(edges + 1, edges));
    // A dual pair with an edge more, and with a load of its own.
    let of_dual = |e: usize| {
        format!("edge {e} of the dual pair is not that of the certificate, without its data")
    };
    let more = answer(&|evidence| evidence.pairs[0].1.roles.push(Role::Facing));
    let words = format!(
        "the number of edges {} of the dual pair is not that of the certificate, without its data",
        edges + 1
    );
    assert_eq!(more, words);
    let is_free = |role: &Role| matches!(role, Role::Loaded(_));
    let free = whole.pairs[0].1.roles.iter().position(is_free).unwrap();
    let loaded = answer(&|evidence| {
        evidence.pairs[0].1.roles[free] = Role::Loaded([[0.0, 1e-9], [0.0; 2]]);
    });
    assert_eq!(loaded, of_dual(free));
}

#[test]
fn what_the_library_is_given_wrongly_is_told_in_words_of_its_own() {
    let square = || unit_square(2).mesh().unwrap();
    let floor = || {
        Problem::of(square(), unit_material())
            .with("top", Condition::displacement(|_| 0.0, |_| -0.01))
            .with("bottom", Condition::contact(|_| 0.0))
    };
    let solved = |problem: &Problem, gamma0: Gamma0| {
        let method = Method { gamma0, ..Method::default() };
        solve(problem, &method, &Settings::default()).map_err(|error| error.to_string()).err()
    };
    assert_eq!(solved(&floor(), Gamma0::Auto), None, "control");
    let without = Problem::of(square(), unit_material()).with("top", Condition::clamped());
    let words = "no boundary has contact; expected one with contact = { gap = ... }";
    assert_eq!(solved(&without, Gamma0::Auto).unwrap(), words);
    for x in [0.0, -0.5, f64::NAN, f64::INFINITY] {
        let words = |what: &str| format!("{what} is {x}; expected a positive number");
        assert_eq!(solved(&floor(), Gamma0::Value(x)).unwrap(), words("gamma0"));
        assert_eq!(Gamma0::local(x).unwrap_err().to_string(), words("kappa"));
    }
    let round = Problem::of(square(), Material::lame(1.0, 1.0, Plane::Axisymmetric))
        .with("top", Condition::displacement(|_| 0.0, |_| -0.01))
        .with("bottom", Condition::contact(|_| 0.0))
        .with_friction("bottom", Friction::tresca(|_| 0.1));
    let found = solved(&round, Gamma0::Auto).unwrap();
    let words = "the body is one of revolution: friction there is not computed by this program";
    assert!(found.contains(words), "{found}");

    let corners = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let made = |triangles: &[[usize; 3]], edge: [usize; 2]| {
        let named = [("side".to_owned(), vec![edge])];
        Mesh::new(corners.clone(), triangles.to_vec(), named).map_err(|error| error.to_string())
    };
    let mesh = made(&[[0, 1, 2]], [0, 1]).unwrap();
    assert_eq!(made(&[], [0, 1]).unwrap_err(), "the mesh has no triangle; expected at least one");
    let beyond = |of: &str, name: &str, what: &str, number: usize, count: &str| {
        format!(
            "{of} '{name}' names {what} {number}; expected numbers from 0 on of the {count} of this mesh"
        )
    };
    let words = beyond("boundary", "side", "vertex", 3, "3 vertices");
    assert_eq!(made(&[[0, 1, 2]], [0, 3]).unwrap_err(), words);
    let with = |surface: usize, point: usize| {
        let of = |name: &str, number| [(name.to_owned(), vec![number])].into();
        let named = mesh.clone().with_names(of("body", surface), of("foot", point));
        named.map_err(|error| error.to_string()).err()
    };
    assert_eq!(with(0, 2), None, "control");
    assert_eq!(with(1, 2).unwrap(), beyond("surface", "body", "triangle", 1, "1 triangles"));
    assert_eq!(with(0, 3).unwrap(), beyond("point", "foot", "vertex", 3, "3 vertices"));

    let tensor = |across: f64, hoop: f64| {
        let law = Material::tensor([3.0, 1.0, 0.0, 3.0, 0.0, 1.0], Some([across, 0.0, 0.0]));
        stable(if hoop == 1.0 { law } else { law.of_revolution(hoop) })
            .map_err(|error| error.to_string())
            .err()
    };
    assert_eq!([tensor(0.1, 1.0), tensor(0.1, 2.0)], [None, None], "control");
    let words = "the stiffness across the plane is not finite";
    assert_eq!(tensor(f64::INFINITY, 1.0).unwrap(), words);
    let found = tensor(0.1, -2.0).unwrap();
    assert!(found.starts_with("Young's modulus along the hoops"), "{found}");
}
