//! Small certificates with one thing changed, whatever it is: what `audit` answers was recorded in `tests/recorded/forged.txt`, and no
//! bound that is accepted is below the error that is there.
//!
//! A forger makes the claim fit: where shares, bound or forces are not those of the changed numbers, these are what is claimed next.
//! `SIGNORINI_RECORD=1 cargo test --test suite forged` records anew. Each line has an array, the word of its entries and what was done
//! to it, the answer without its digits, how often it was that, and the sum of the logarithms of the bounds, or of the places that
//! the answer names.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use approx::abs_diff_eq;
use signorini::certificates::binding::compare;
use signorini::certificates::forces::Evidence;
use signorini::certificates::format::{self, Refused};
use signorini::certificates::proof::{Claim, Rejection, Role};
use signorini::certificates::{Certificate, Continuous, Proof, certify};
use signorini::io::certificate::{Header, decode, hash};
use signorini::io::{Case, run};
use signorini::model::Problem;

use crate::common::{encoded, root, turned};

/// Each with its name; `N` is a number of cells.
const CASES: &str = r#"=== block
mesh.rectangle = { width = 1, height = 1, nx = N, ny = N, diagonal = "right" }
material = { lambda = 1, mu = 1 }
load.body = ["0", "-4 + 10*x"]
boundary.bottom.contact.gap = "0"
boundary.top.displacement = [0, 0]
certify.quantities = ["force bottom", "force bottom x 0 0.5 ramp 0.2"]
=== stress
mesh.rectangle = { width = 2, height = 1, nx = N, ny = N, diagonal = "crossed" }
body = { plane = "stress", thickness = 0.3 }
material = { young = 2, poisson = 0.3 }
load.body = ["0.1*y", "-0.2"]
boundary.right.pressure = "0.3*y^2"
boundary.top.traction = ["0.05", "-0.3*x"]
boundary.left.normal = 0
boundary.bottom.contact.gap = "0.02*(x - 1)^2"
=== wood
mesh.rectangle = { width = 1.5, height = 1, nx = N, ny = N, diagonal = "left" }
material.orthotropic = { e1 = 9, e2 = 1, e3 = 2, nu12 = 0.3, nu13 = 0.35, nu23 = 0.4, g12 = 0.8, angle = 30 }
load.body = ["0.05", "-0.4"]
boundary.right.pressure = "0.1"
boundary.left.displacement = ["0.01*y", "free"]
boundary.bottom.contact.obstacle = "floor"
obstacle.floor.plane = { point = [0, -0.01], normal = [0.1, 1] }
=== tresca
mesh.rectangle = { width = 2, height = 1, nx = N, ny = N, diagonal = "right" }
material = { young = 1, poisson = 0.3 }
load.body = ["0.1", "-0.3"]
boundary.top.displacement = ["0.05", "-0.08"]
boundary.bottom.contact = { gap = "0", friction.tresca = "0.02 + 0.01*x" }
=== round
mesh.trapezoid = { omega = 2.0, n = N }
material = { young = 1, poisson = 0.3 }
boundary.top.displacement = ["0.02", "-0.06"]
boundary.left.traction = [0.02, 0.01]
boundary.bottom.contact.obstacle = "roll"
obstacle.roll.circle = { center = [0.5, -1.5], radius = 1.5, side = "outside" }
=== kink
mesh.rectangle = { width = 1, height = 1, nx = N, ny = N, diagonal = "right" }
material = { young = 1, poisson = 0.3 }
load.body = ["max(x - 0.4, 0)", "-0.3*exp(x)*sqrt(1 + y)"]
boundary.top.displacement = ["0.01*sin(3*x)", "-0.02*cos(x)"]
boundary.right.traction = ["abs(y - 0.5)", "min(y, 0.3)"]
boundary.bottom.contact.gap = "0.01*sin(2*x)"
=== slanted
mesh.trapezoid = { omega = 2.2, n = N }
material = { young = 1, poisson = 0.3 }
boundary.bottom.contact.gap = "0.01*(x - 0.3)^2"
boundary.right.traction = ["-0.1", "0.05*y"]
boundary.top.displacement = ["free", "-0.05 - 0.01*x"]
boundary.left.tangential = "0.01*y"
=== contact
mesh.gmsh = "flat-N.msh"
material = { young = 1, poisson = 0.3 }
load.body = ["0", "-0.02"]
boundary.base.displacement = [0, 0]
boundary.top.displacement = ["0.02", "-0.05 + 0.01*x"]
[[pair]]
boundaries = ["foot", "table"]
clearance = "0.01*x"
=== bonded
mesh.gmsh = "flat-N.msh"
material = { young = 1, poisson = 0.3 }
load.body = ["0.03", "-0.05*y"]
boundary.base.displacement = ["free", 0]
boundary.top.displacement = ["0.02", "-0.05 + 0.01*x"]
[[pair]]
boundaries = ["foot", "table"]
law = "bonded"
=== sliding
mesh.gmsh = "round-N.msh"
material = { young = 1, poisson = 0.3 }
load.body = ["0.05", "0.02"]
boundary.base.displacement = [0, 0]
boundary.top.displacement = ["0.01", "0.02"]
[[pair]]
boundaries = ["foot", "table"]
law = "sliding"
clearance = 0
=== rubbed
mesh.gmsh = "round-N.msh"
material = { young = 1, poisson = 0.3 }
boundary.base.displacement = [0, 0]
boundary.sides.normal = 0
boundary.top.pressure = "0.1 + 0.05*y"
[[pair]]
boundaries = ["foot", "table"]
clearance = "0.0005"
friction.tresca = "0.001 + 0.001*y"
"#;

/// Two bodies on `2 n` and `3 n` cells, one above the other or one around the other.
fn two_bodies(n: usize, is_round: bool) -> String {
    let place = |low: f64, [s, t]: [f64; 2]| {
        let [x, y] = [s, low + t];
        if is_round { turned(0.8 * (1.0 - x), [1.0 + 0.6 * y, 0.0]) } else { [1.5 * x, y] }
    };
    let (mut nodes, mut elements) = (Vec::new(), Vec::new());
    for (body, low, across) in [(0, 0.0, 3 * n), (1, 1.0, 2 * n)] {
        let first = nodes.len() + 1;
        let at = |i: usize, j: usize| first + j * (across + 1) + i;
        for j in 0..=n {
            let local = |i: usize| [i as f64 / across as f64, j as f64 / n as f64];
            nodes.extend((0..=across).map(|i| place(low, local(i))));
        }
        let mut line = |group: usize, a: usize, b: usize| {
            elements.push(format!("1 2 {group} {group} {a} {b}"));
        };
        for i in 0..across {
            line(1 + 2 * body, at(i, 0), at(i + 1, 0));
            line(2 + 2 * body, at(i, n), at(i + 1, n));
        }
        for j in 0..n {
            line(5, at(0, j), at(0, j + 1));
            line(5, at(across, j), at(across, j + 1));
        }
        for (i, j) in (0..n).flat_map(|j| (0..across).map(move |i| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let body = 6 + body;
            elements.push(format!("2 2 {body} {body} {a} {b} {c}"));
            elements.push(format!("2 2 {body} {body} {a} {c} {d}"));
        }
    }
    let numbered = |lines: Vec<String>| -> String {
        let line = |(k, line): (usize, &String)| format!("{} {line}\n", k + 1);
        format!("{}\n{}", lines.len(), lines.iter().enumerate().map(line).collect::<String>())
    };
    let names = ["base", "table", "foot", "top", "sides", "lower", "upper"];
    let name = |(k, name): (usize, &&str)| format!("{} {} \"{name}\"\n", 1 + k / 5, k + 1);
    let nodes = nodes.iter().map(|[x, y]| format!("{x} {y} 0")).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n7\n{}$EndPhysicalNames\n$Nodes\n{}$EndNodes\n$Elements\n{}$EndElements\n",
        names.iter().enumerate().map(name).collect::<String>(),
        numbered(nodes),
        numbered(elements),
    )
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("forged")
}

/// The case of a text on `n` cells, its elements of this degree.
fn read(text: &str, n: usize, degree: usize) -> Case {
    let text = text.replace('N', &n.to_string());
    let settings = [format!("method.degree={degree}")];
    Case::parse(&folder().join("case.toml"), &text, &settings).unwrap()
}

fn certified(case: Case) -> (Problem, Continuous) {
    let (case, solved) = run::solve(case, None, &|_| {}).unwrap();
    let certified = match solved.certified {
        Some(certified) => certified.unwrap(),
        None => certify(&case.problem, &solved.solution).unwrap(),
    };
    (case.problem, certified)
}

/// A certificate as it was made, and what is known of its problem.
struct Honest {
    problem: Problem,
    header: Header,
    bytes: Vec<u8>,
    bound: f64,
    /// J(u) is at most this; `None` where friction or data leave J(u) open.
    energy: Option<f64>,
}

/// Answers: how often each was given, and the sum of its numbers.
type Answers = BTreeMap<String, (usize, f64)>;

/// Words without digits, and a number by which the digits count.
fn words(text: &str) -> (String, f64) {
    let is_of_number = |c: &char| c.is_ascii_digit() || ".-+".contains(*c);
    let letters: String = text.chars().filter(|c| !is_of_number(c)).collect();
    let words: Vec<&str> = letters.split_whitespace().filter(|word| *word != "e").collect();
    let numbers = text.split(|c: char| !is_of_number(&c) && c != 'e');
    let numbers = numbers.filter_map(|number| number.parse::<f64>().ok());
    let size = |x: f64| if x.is_finite() { (1e4 * x).asinh() } else { 1.0 };
    (words.join(" "), numbers.map(size).sum())
}

impl Honest {
    /// The answer to files, and to the same numbers with the claim that fits them.
    fn answer(&self, header: &Header, bytes: &[u8]) -> (String, f64) {
        let error = match format::audit(header.clone(), bytes) {
            Ok(audit) => {
                let (text, times) =
                    self.of_case((&audit.certificate, &audit.forces), &audit.proof, header.bound);
                return (format!("accepted, {text}"), times);
            }
            Err(error) => error,
        };
        let (kind, place) = match &error {
            Refused::Rejected(Rejection::Share { triangle, .. }) => ("share", *triangle),
            Refused::Rejected(Rejection::Bound { .. }) => ("bound", 0),
            Refused::Rejected(Rejection::Force { force, .. }) => ("force", *force),
            _ => return words(&error.to_string()),
        };
        let (certificate, Claim { forces, .. }) = decode(header, bytes).unwrap();
        let proof = certificate.prove().unwrap();
        let bound = certificate.with_lifts(proof.bound);
        let (text, mut number) = self.of_case((&certificate, &forces), &proof, bound);
        number += place as f64;
        let mut found = BTreeSet::new();
        let mut failed = |error: String| found.insert(format!("; {}", words(&error).0));
        match certificate.prove_forces(&forces) {
            _ if forces.between.is_none() => {}
            Err(error) => {
                failed(error.to_string());
            }
            Ok(all) => {
                for (k, force) in all.into_iter().enumerate() {
                    match force {
                        Ok([low, high]) => number += low.atan() + (2.0 + k as f64) * high.atan(),
                        Err(error) => {
                            failed(error.to_string());
                        }
                    }
                }
            }
        }
        let failed: String = found.into_iter().collect();
        (format!("{kind}; then accepted, {text}{failed}"), number)
    }

    /// Whether numbers that are accepted are those of the case: then their bound is above the error.
    fn of_case(
        &self,
        (certificate, forces): (&Certificate, &Evidence),
        proof: &Proof,
        bound: f64,
    ) -> (String, f64) {
        let times = (bound / self.bound).log10();
        match compare(self.problem.clone(), certificate, forces) {
            Err(other) => (format!("not the case: {}", words(&other.to_string()).0), times),
            Ok(reason) => {
                let is_below = reason.is_none() && self.is_below_the_error(proof, bound);
                assert!(!is_below, "{bound} is said to be above the error of v");
                ("the case's".to_owned(), times)
            }
        }
    }

    /// |u - v|_a^2 <= 2 (J(v) - J(u)), which is no more than the right side of the theorem.
    fn is_below_the_error(&self, proof: &Proof, bound: f64) -> bool {
        self.energy.is_some_and(|energy| bound * bound < 2.0 * (proof.energy[0] - energy))
    }
}

/// Where the words of an array begin, the letters of an entry, and the number of entries.
struct Layout<'a> {
    name: &'a str,
    start: usize,
    words: &'a [u8],
    entries: usize,
}

impl Layout<'_> {
    fn at(&self, entry: usize, word: usize) -> usize {
        8 * (self.start + entry * self.words.len() + word)
    }
}

fn layouts(header: &Header) -> Vec<Layout<'_>> {
    let mut start = 0;
    let mut all = Vec::new();
    for format::Array { name, words, entries } in &header.arrays {
        all.push(Layout { name, start, words: words.as_bytes(), entries: *entries });
        start += words.len() * entries;
    }
    all
}

fn word(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

/// The kind of an entry: the role of an edge, the law, the motion.
fn kind(layout: &Layout, bytes: &[u8], entry: usize) -> String {
    let place = match layout.name {
        "edges" => 2,
        "laws" => 1,
        "forces" | "dual edges" => 0,
        _ => return String::new(),
    };
    format!(" {}", word(bytes, layout.at(entry, place)))
}

/// The displacements that prove forces: the longest arrays.
fn is_displacement(name: &str) -> bool {
    name.starts_with('w') || name.starts_with("dual w")
}

/// A place among some, and the first one of these unless `one` is enough.
fn some(places: &[usize], one: bool) -> Vec<usize> {
    let between = places[places.len() * 2 / 3];
    if one || between == places[0] { vec![between] } else { vec![places[0], between] }
}

/// Changes of a word.
fn changes(letter: u8, old: u64, next: u64, largest: f64) -> Vec<(&'static str, u64)> {
    let mut all = vec![("next", next)];
    if letter == b'f' {
        let x = f64::from_bits(old);
        let size = if x == 0.0 { largest.max(1.0) } else { x.abs() };
        all.extend(
            [
                ("little", x + 1e-3 * size),
                ("minus", -x),
                ("zero", 0.0),
                ("twice", 2.0 * x),
                ("nan", f64::NAN),
            ]
            .map(|(how, x)| (how, x.to_bits())),
        );
        all.retain(|&(_, new)| f64::from_bits(new) != x);
    } else {
        all.extend([("little", old.wrapping_add(1)), ("zero", 0), ("nan", u64::MAX)]);
        all.retain(|&(_, new)| new != old);
    }
    all
}

/// Forges each word of each array, and each array as a whole.
fn forge(honest: &Honest, answers: &mut Answers) {
    let Honest { header, bytes, .. } = honest;
    let mut tell = |what: String, header: &Header, bytes: &[u8]| {
        let header = Header { hash: hash(bytes), ..header.clone() };
        let (text, number) = honest.answer(&header, bytes);
        let (count, sum) = answers.entry(format!("{what}: {text}")).or_default();
        *count += 1;
        *sum += number;
    };
    let is_large = header.arrays.iter().any(|array| array.name == "shares" && array.entries > 40);
    for (k, layout) in layouts(header).iter().enumerate() {
        let mut kinds: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for entry in 0..layout.entries {
            kinds.entry(kind(layout, bytes, entry)).or_default().push(entry);
        }
        for (column, &letter) in layout.words.iter().enumerate() {
            for (kind, places) in &kinds {
                let at = |entry: usize| layout.at(entry, column);
                let size = |&entry: &usize| match letter {
                    b'f' => f64::from_bits(word(bytes, at(entry))).abs(),
                    _ => 0.0,
                };
                let largest = places.iter().map(size).fold(0.0, f64::max);
                // Numbers that rounding leaves differ from processor to processor.
                let is_sure = |entry: &&usize| size(entry) == 0.0 || size(entry) > 1e-6 * largest;
                let sure: Vec<usize> = places.iter().filter(is_sure).copied().collect();
                for entry in some(&sure, is_large || is_displacement(layout.name)) {
                    let next = sure.iter().position(|e| *e == entry).unwrap() + 1;
                    let next = sure[next % sure.len()];
                    let [old, other] = [entry, next].map(|entry| word(bytes, at(entry)));
                    for (how, new) in changes(letter, old, other, largest) {
                        // Linear data need no more.
                        if matches!(how, "minus" | "twice") && is_displacement(layout.name) {
                            continue;
                        }
                        let mut bytes = bytes.clone();
                        let mut set = |entry: usize, word: u64| {
                            bytes[at(entry)..at(entry) + 8].copy_from_slice(&word.to_le_bytes());
                        };
                        set(entry, new);
                        if how == "next" {
                            set(next, old);
                        }
                        tell(format!("{}{kind} {column} {how}", layout.name), header, &bytes);
                    }
                }
            }
        }
        let with = |change: &dyn Fn(&mut format::Array)| {
            let mut header = header.clone();
            change(&mut header.arrays[k]);
            header
        };
        let name = layout.name;
        let [start, second, end] = [0, 1, layout.entries].map(|entry| layout.at(entry, 0));
        let each = second - start;
        let without = |bytes: &[u8], range| {
            let mut left = bytes.to_vec();
            left.drain(range);
            left
        };
        let last = without(bytes, end - each..end);
        tell(format!("{name} shorter"), &with(&|array| array.entries -= 1), &last);
        let mut others = header.clone();
        others.arrays.remove(k);
        tell(format!("{name} gone"), &others, &without(bytes, start..end));
        tell(format!("{name} renamed"), &with(&|array| array.name += " "), bytes);
        let other = |array: &mut format::Array| {
            let first = if array.words.starts_with('f') { "n" } else { "f" };
            array.words.replace_range(..1, first);
        };
        tell(format!("{name} of other words"), &with(&other), bytes);
        if layout.entries > 1 {
            let mut exchanged = bytes.clone();
            exchanged[start..start + 2 * each].rotate_left(each);
            tell(format!("{name} exchanged"), header, &exchanged);
        }
    }
    let mut claim = |what: &str, change: &dyn Fn(&mut Header)| {
        let mut header = header.clone();
        change(&mut header);
        tell(format!("{what} changed"), &header, bytes);
    };
    claim("format", &|header| header.format -= 1);
    claim("statement", &|header| header.statement.push('.'));
    claim("degree", &|header| header.degree = 3 - header.degree);
    claim("degree to 3", &|header| header.degree = 3);
    claim("bound, smaller", &|header| header.bound *= 1.0 - 1e-12);
    claim("bound, none", &|header| header.bound = f64::NAN);
    claim("bound, larger", &|header| header.bound *= 2.0);
    claim("boundaries, order", &|header| header.boundaries.reverse());
    claim("boundaries, fewer", &|header| header.boundaries.truncate(1));
}

/// The arrays of what is computed to prove forces: zeros of theirs are rounding, which decides what a few forgeries of them are
/// (at most two of a kind where a factor added its products up in another order).
const COMPUTED: [&str; 3] = ["w ", "lifts ", "forces "];

/// Answers that differ from the recorded ones by more than rounding.
fn changed(recorded: &Answers, found: &Answers) -> Vec<String> {
    let all: BTreeSet<&String> = recorded.keys().chain(found.keys()).collect();
    let count = |of: &Answers, key: &str| of.get(key).map_or(0, |(count, _)| *count);
    let same = |key: &str| match (recorded.get(key), found.get(key)) {
        _ if COMPUTED.iter().any(|array| key.starts_with(array)) => {
            count(recorded, key).abs_diff(count(found, key)) <= 3
        }
        (Some((n, a)), Some((m, b))) => {
            n == m && abs_diff_eq!(a, b, epsilon = 1e-6 * (1.0 + a.abs()))
        }
        _ => false,
    };
    let told = |key: &String| format!("{key}: {:?}, now {:?}", recorded.get(key), found.get(key));
    all.into_iter().filter(|key| !same(key)).map(told).collect()
}

#[test]
fn what_is_forged_is_answered_as_was_recorded() {
    fs::create_dir_all(folder()).unwrap();
    for n in [1, 4] {
        for (name, is_round) in [("flat", false), ("round", true)] {
            fs::write(folder().join(format!("{name}-{n}.msh")), two_bodies(n, is_round)).unwrap();
        }
    }
    let (mut answers, mut too_small) = (Answers::new(), 0);
    for text in CASES.split("=== ").filter_map(|case| Some(case.split_once('\n')?.1)) {
        let best = certified(read(text, 4, 2)).1;
        for degree in [1, 2] {
            let (problem, certified) = certified(read(text, 1, degree));
            let (header, bytes) = encoded(&certified);
            let energy = certified.energy.and(best.energy).map(|_| best.proof.energy[1]);
            let honest = Honest { problem, header, bytes, bound: certified.bound, energy };
            assert_eq!(honest.answer(&honest.header, &honest.bytes).0, "accepted, the case's");
            // Control: of bounds that are a third too small some are known to be.
            let smaller = certified.bound / 1.5;
            too_small += usize::from(honest.is_below_the_error(&certified.proof, smaller));
            forge(&honest, &mut answers);
        }
    }
    assert!(too_small > 3, "control: {too_small}");
    let file = root().join("tests/recorded/forged.txt");
    if std::env::var_os("SIGNORINI_RECORD").is_some() {
        let mut text = String::new();
        let line = |(key, (count, sum)): (&String, &(usize, f64))| {
            writeln!(text, "{key} | {count} {sum:.7}").unwrap();
        };
        answers.iter().for_each(line);
        fs::write(&file, text).unwrap();
    }
    let text = fs::read_to_string(&file).unwrap();
    let line = |line: &str| {
        let (key, numbers) = line.rsplit_once(" | ").unwrap();
        let (count, sum) = numbers.split_once(' ').unwrap();
        (key.to_owned(), (count.parse().unwrap(), sum.parse().unwrap()))
    };
    let mut recorded: Answers = text.lines().map(line).collect();
    let changes = changed(&recorded, &answers);
    let first = changes[..changes.len().min(20)].join("\n");
    assert!(changes.is_empty(), "{} answers, the first:\n{first}", changes.len());
    // Controls: a bound by 1e-4 of it, and an answer.
    let key = "bulges exchanged: share; then accepted, the case's";
    let sum = &mut recorded.get_mut(key).unwrap().1;
    *sum += 1e-4_f64.ln_1p() / 10.0_f64.ln();
    assert_eq!(changed(&recorded, &answers).len(), 1, "control");
    let key = "vertices 0 nan: rejected: vertex : a number is not finite";
    recorded.remove(key).unwrap();
    assert_eq!(changed(&recorded, &answers).len(), 2, "control");
}

/// The lower body first: the upper one, whose pressures are held by it, needs no more than it does.
#[test]
fn of_bodies_that_slide_on_each_other_each_has_one_support() {
    fs::create_dir_all(folder()).unwrap();
    fs::write(folder().join("flat-2.msh"), two_bodies(2, false)).unwrap();
    let text = r#"
mesh.gmsh = "flat-N.msh"
material = { young = 1, poisson = 0.3 }
boundary.base.normal = 0
boundary.top.pressure = "0.1 + 0.02*x"
[[pair]]
boundaries = ["foot", "table"]
"#;
    let (_, certified) = certified(read(text, 2, 1));
    assert!(certified.proof.stop < 1e-10 && certified.relative < 1.0, "{certified:?}");
    // Triangles balance though there is a support elsewhere: beside an inner edge there is one that the support is not on.
    let audited = |certificate: &Certificate| {
        let claim = Claim {
            shares: certified.proof.shares.clone(),
            bound: certified.bound,
            forces: Evidence::default(),
        };
        certificate.audit(&claim).map(|_| ())
    };
    assert_eq!(audited(&certified.certificate), Ok(()));
    for e in 0..certified.certificate.edges.len() {
        let mut moved = certified.certificate.clone();
        if let Role::Inner(force) = &mut moved.edges[e].role {
            force.iter_mut().for_each(|f| f[0] += 1e-9);
            let found = audited(&moved);
            assert!(matches!(found, Err(Rejection::OutOfBalance { .. })), "{e}: {found:?}");
        }
    }
    // Control: a force along them that no rounding leaves is taken by no support.
    let mut pushed = certified.certificate;
    for edge in &mut pushed.edges {
        if let Role::Pressed(pressure) = edge.role {
            let turned = pressure.map(|p| [1e-6 * p, -p]);
            edge.role = Role::Loaded(turned);
        }
    }
    assert!(matches!(pushed.prove(), Err(Rejection::Unbalanced(_))), "{:?}", pushed.prove());
}
