//! What small cases print for people, word by word and number by number, when that was recorded (`tests/recorded/printed.txt`): the
//! summary, what `audit`, `certify`, `check`, `sweep` and `new` say, the rows of a report, and of a picture the words and the lines in their
//! order. `tests/suite/recorded.rs` has the numbers of the files.
//!
//! `SIGNORINI_RECORD=1 cargo test --test suite printed` records anew.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::command::{signorini, with_files};
use crate::common::root;

/// The cases of `tests/recorded/cases.txt` whose text is kept; with the picture of those after which a `*` stands.
const KEPT: [&str; 101] = [
    "block-p1*",
    "coulomb-p1*",
    "steps-p1",
    "blocks-tresca-p1*",
    "ring-fit-p1",
    "solid-p1*",
    "hollow-p1",
    "play",
    "driven",
    "on-the-verge",
    "driven-coulomb",
    "driven-along",
    "play-along",
    "play-about",
    "adapt",
    "adapt-force",
    "check",
    "check-pair",
    "steps-left",
    "steps-right",
    "ramp-along",
    "sweep",
    "sweep-short",
    "sweep-short-failed",
    "sweep-failed",
    "sweep-short-wrong",
    "sweep-wrong",
    "oblique-p1*",
    "steel-p1",
    "halves-p1",
    "corner",
    "report",
    "mixed*",
    "overlap",
    "adapt-unmet",
    "adapt-known",
    "round-p2*",
    "ring-contact-p2*",
    "arm*",
    "strip",
    "passing",
    "unlike",
    "inside",
    "loose",
    "loose-pair",
    "disagree",
    "disagree-left",
    "disagree-oblique",
    "incoercive",
    "no-promise",
    "all-conditions",
    "wrong-side",
    "pull",
    "check-revolution",
    "bowl*",
    "no-moduli",
    "moduli-beside",
    "other-plane",
    "no-surface",
    "pair-twice",
    "pair-occupied",
    "pair-third",
    "pair-misspelt",
    "pair-itself",
    "pair-far",
    "gap-and-obstacle",
    "curve-of-none",
    "curve-two-ways",
    "curve-without-side",
    "perturbed-file",
    "gamma-twice",
    "exact-of-surfaces",
    "long-title*",
    "beside-p1",
    "beside-p2",
    "coulomb-proof",
    "adapt-none",
    "adapt-rest",
    "adapt-rest-force",
    "adapt-bent",
    "post",
    "gauss-one",
    "gauss-five",
    "exact-pair",
    "exact-round",
    "exact-wood",
    "radius-of-plane",
    "friction-of-revolution",
    "no-obstacle",
    "broken-load",
    "sweep-part",
    "steps-lost",
    "adapt-table",
    "engine-within",
    "steps-proof",
    "steps-first",
    "friction-across",
    "three-places",
    "two-places",
    "locks",
    "fibres",
];

/// The labels of lines of which the words are kept and no numbers, which differ from processor to processor.
const WORDS_ALONE: [&str; 5] = ["newton", "accuracy", "balance", "proved", "solved"];

/// The lines that are kept.
fn kept(said: &str) -> impl Iterator<Item = String> {
    let label = |line: &str| line.split_whitespace().next().unwrap_or_default().to_owned();
    said.lines().filter(move |line| label(line) != "time").map(move |line| {
        // A row of load steps has a number of Newton's steps.
        let alone = WORDS_ALONE.contains(&&*label(line)) || line.ends_with("  converged");
        let words = pieces(line).filter(|piece| !alone || piece.parse::<f64>().is_err());
        words.collect::<String>().trim_end().to_owned()
    })
}

/// The numbers of a line and what is between them.
fn pieces(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        let first = rest.chars().next()?;
        let part = |c: char| c.is_ascii_digit() || c == '.';
        // An exponent has a digit before it and its own behind it.
        let mut end = rest.find(|c| part(c) != part(first)).unwrap_or(rest.len());
        if part(first) && rest[end..].starts_with('e') {
            let exponent = rest[end + 1..].trim_start_matches('-');
            let digits = exponent.find(|c: char| !c.is_ascii_digit()).unwrap_or(exponent.len());
            if digits > 0 {
                end = rest.len() - exponent.len() + digits;
            }
        }
        let piece;
        (piece, rest) = rest.split_at(end);
        Some(piece)
    })
}

/// Whether two lines have the same words, and numbers that differ by rounding to a few digits, and by `off`.
fn is_same(a: &str, b: &str, off: f64) -> bool {
    let near = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 2e-3 * a.abs().max(b.abs()) + off,
        _ => a == b,
    };
    pieces(a).count() == pieces(b).count() && pieces(a).zip(pieces(b)).all(near)
}

/// The words and the lines of a picture in their order, but for the surface of the body; long lines by the sums of their numbers.
fn drawn(svg: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in svg.split('<').skip(1).filter(|part| !part.starts_with('/')) {
        let (tag, text) = part.split_once('>').unwrap();
        let value = |key: &str| tag.split_once(key).and_then(|(_, rest)| rest.split('"').next());
        let is_of_body = value("fill=\"#").is_some() && value("fill=\"#") == value("stroke=\"#");
        let name = tag.split(' ').next().unwrap();
        if is_of_body || ["stop", "linearGradient", "svg", "defs"].contains(&name) {
            continue;
        }
        let mut tag = tag.to_owned();
        if let Some(path) = value(" d=\"").filter(|path| path.len() > 200) {
            let numbers: Vec<f64> = pieces(path).filter_map(|piece| piece.parse().ok()).collect();
            let sums = format!("{} {:.1}", numbers.len(), numbers.iter().sum::<f64>());
            tag = tag.replace(path, &sums);
        }
        lines.push(format!("{tag} {}", text.trim()).replace('"', ""));
    }
    lines
}

/// The rows of a report beside its picture.
fn rows(html: &str) -> Vec<String> {
    let after = html.split_once("</svg>").unwrap().1;
    let row = |line: &str| {
        let texts = line.split('<').filter_map(|part| part.split_once('>')).map(|(_, text)| text);
        texts.filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" | ")
    };
    after
        .lines()
        .filter(|line| line.starts_with("<t") || line.starts_with("<h2"))
        .map(row)
        .collect()
}

/// All that the cases print, in one text: a heading for each part.
fn all(room: &Path) -> String {
    let mut text = String::new();
    let mut add = |heading: &str, lines: &mut dyn Iterator<Item = String>| {
        writeln!(text, "=== {heading}").unwrap();
        lines.for_each(|line| writeln!(text, "{line}").unwrap());
    };
    let said = |arguments: &[&str]| {
        let output = signorini(room, arguments);
        let [out, errors] = [output.stdout, output.stderr].map(|b| String::from_utf8(b).unwrap());
        format!("{out}{errors}exit code {}\n", output.status.code().unwrap())
    };
    let cases = fs::read_to_string(root().join("tests/recorded/cases.txt")).unwrap();
    for name in KEPT {
        let (name, has_picture) = (name.trim_end_matches('*'), name.ends_with('*'));
        let begin = format!("=== {name}: ");
        let case = cases.split_once(&begin).unwrap_or_else(|| panic!("no case {name}")).1;
        let (about, case) = case.split("=== ").next().unwrap().split_once('\n').unwrap();
        fs::write(room.join(format!("{name}.toml")), case).unwrap();
        let (task, options) = about.split_once(' ').unwrap_or((about, ""));
        let file = format!("{name}.toml");
        let mut arguments = vec![task, &*file];
        arguments.extend(options.split_whitespace());
        add(&format!("{about}: {name}"), &mut kept(&said(&arguments)));
        let out = room.join("out").join(name);
        if out.join("certificate.json").is_file() {
            let certificate = format!("out/{name}/certificate.json");
            add(&format!("audit: {name}"), &mut kept(&said(&["audit", &certificate])));
            let with_case = ["audit", &certificate, "--case", &file];
            add(&format!("audit --case: {name}"), &mut kept(&said(&with_case)));
        }
        if has_picture {
            let svg = fs::read_to_string(out.join("picture.svg")).unwrap();
            add(&format!("picture: {name}"), &mut drawn(&svg).into_iter());
        }
        for curves in ["sweep.svg", "steps.svg"] {
            if let Ok(svg) = fs::read_to_string(out.join(curves)) {
                add(&format!("picture: {name}, {curves}"), &mut drawn(&svg).into_iter());
            }
        }
        if let Ok(html) = fs::read_to_string(out.join("report.html")) {
            add(&format!("report: {name}"), &mut kept(&rows(&html).join("\n")));
        }
    }
    // A body with a certificate, and one of revolution, which has none.
    for (name, size, cells) in [("steel-p1", [40.0, 20.0], [6, 3]), ("solid-p1", [1.0; 2], [4; 2])]
    {
        let mut field = "x,y,ux,uy\n".to_owned();
        for (i, j) in (0..=cells[1]).flat_map(|j| (0..=cells[0]).map(move |i| (i, j))) {
            let [x, y] =
                [(i, 0), (j, 1)].map(|(k, c)| size[c] * f64::from(k) / f64::from(cells[c]));
            writeln!(field, "{x},{y},0,-0.15").unwrap();
        }
        fs::write(room.join("field.csv"), field).unwrap();
        let certify = ["certify", &format!("{name}.toml"), "--displacement", "field.csv"];
        add(&format!("certify: {name}"), &mut kept(&said(&certify)));
    }
    // A certificate of a body without a thickness, and of one with another.
    for name in ["block-p1", "steel-p1"] {
        let [certificate, case] = [format!("out/{name}/certificate.json"), format!("{name}.toml")];
        let thick = ["audit", &certificate, "--case", &case, "--set", "body.thickness=2"];
        add(&format!("audit of another thickness: {name}"), &mut kept(&said(&thick)));
    }
    for mesh in ["blocks", "ring", "stack"] {
        add(&format!("new: {mesh}"), &mut kept(&said(&["new", &format!("{mesh}.msh")])));
        let draft = fs::read_to_string(room.join(format!("{mesh}.toml"))).unwrap();
        add(&format!("draft: {mesh}"), &mut draft.lines().map(str::to_owned));
    }
    text
}

#[test]
fn what_is_printed_for_people_is_what_was_recorded() {
    let mesh = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let [blocks, ring, bowl, disk] =
        ["blocks", "ring", "bowl", "disk"].map(|name| mesh(&format!("tests/recorded/{name}.msh")));
    let stack = mesh("cases/stack.msh");
    let meshes = [
        ("blocks.msh", &*blocks),
        ("ring.msh", &*ring),
        ("bowl.msh", &*bowl),
        ("disk.msh", &*disk),
        ("stack.msh", &*stack),
    ];
    let found = all(&with_files("printed", &meshes));
    let file = root().join("tests/recorded/printed.txt");
    if std::env::var_os("SIGNORINI_RECORD").is_some() {
        fs::write(&file, &found).unwrap();
    }
    let recorded = fs::read_to_string(&file).unwrap();
    let mut heading = "";
    let mut changes = Vec::new();
    for (a, b) in recorded.lines().zip(found.lines()) {
        heading = if a.starts_with("===") { a } else { heading };
        let off = if heading.contains(" picture") { 0.05 } else { 1e-12 };
        if !is_same(a, b, off) {
            changes.push(format!("{heading}\nrecorded {a}\nfound    {b}"));
        }
    }
    assert!(changes.is_empty(), "{}", changes[..changes.len().min(10)].join("\n"));
    assert_eq!(recorded.lines().count(), found.lines().count());
    // Controls: a word, a digit, an exponent, a sign; not the last digit.
    let line = "force 22.57 N/mm (0, -22.57), within 1.5e-7";
    assert!(is_same(line, &line.replace("22.57", "22.58"), 1e-12));
    for [old, new] in [["force", "length"], ["22.57", "22.87"], ["e-7", "e-6"], ["-22", "22"]] {
        assert!(!is_same(line, &line.replace(old, new), 1e-12), "control: {new}");
    }
}
