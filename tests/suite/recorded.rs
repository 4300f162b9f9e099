//! What the command printed and wrote of small cases (`tests/recorded/cases.txt`) when that was recorded: no number changes
//! unnoticed. Which numbers are right, other tests say.
//!
//! `SIGNORINI_RECORD=1 cargo test --test suite recorded` records anew; the change is then read in `tests/recorded/numbers.txt`. Each line
//! has a case, a part of what it gave, and one number that any change of the numbers there changes but for that of their last digits.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Map, Value};

use crate::command::{signorini, with_files};
use crate::common::root;

/// What differs from run to run or from processor to processor: times, steps, and what rounding leaves.
const PASSED_OVER: [&str; 9] = [
    "version",
    "seconds",
    "newton",
    "condition",
    "forward_error",
    "threads",
    "predicted_operations",
    "imbalance",
    "isolated",
];

/// The labels of lines that tell of them.
const LINES_PASSED_OVER: [&str; 7] =
    ["newton", "accuracy", "balance", "time", "proved", "solved", "written"];

/// Numbers and texts in their order, as one number.
#[derive(Clone, Copy, Default)]
struct Fold {
    sum: f64,
    count: u32,
}

impl Fold {
    /// A factor from 1 to 2, other from place to place: numbers that change places change the sum.
    fn weight(&mut self) -> f64 {
        self.count += 1;
        1.0 + (f64::from(self.count) * 0.618_033_988_749_895).fract()
    }

    /// A number of any size by its digits; what is far below 1e-4 counts for nothing.
    fn number(&mut self, x: f64) {
        self.sum += self.weight() * (1e4 * x).asinh();
    }

    /// A text without its digits, some of which are those of numbers that are rounded.
    fn text(&mut self, text: &str) {
        let letters = text.chars().filter(|c| !c.is_ascii_digit() && !".e-+".contains(*c));
        letters.for_each(|c| self.sum += self.weight() * f64::from(u32::from(c)) / 64.0);
    }

    fn json(&mut self, value: &Value) {
        match value {
            Value::Null => self.number(1e-3),
            Value::Bool(is) => self.number(if *is { 1.0 } else { -1.0 }),
            Value::Number(number) => self.number(number.as_f64().unwrap()),
            Value::String(text) => self.text(text),
            Value::Array(values) => values.iter().for_each(|value| self.json(value)),
            Value::Object(values) => kept(values).for_each(|(_, value)| self.json(value)),
        }
    }

    fn size(&mut self, x: f64) {
        self.sum += self.weight() * x.ln();
    }

    /// The widths of intervals, and numbers that stand alone, in `unit`.
    fn widths(&mut self, value: &Value, unit: f64) {
        let ends = |values: &[Value]| match values {
            [from, to] => from.as_f64().zip(to.as_f64()),
            _ => None,
        };
        match value {
            Value::Number(number) => self.size((number.as_f64().unwrap() / unit).max(1e-6)),
            Value::Array(values) => match ends(values) {
                Some((from, to)) => self.size(((to - from) / unit).max(1e-6)),
                None => values.iter().for_each(|value| self.widths(value, unit)),
            },
            Value::Object(values) => values.values().for_each(|value| self.widths(value, unit)),
            _ => {}
        }
    }

    fn of(value: &Value) -> Self {
        let mut sum = Fold::default();
        sum.json(value);
        sum
    }
}

/// The entries but those that are passed over.
fn kept(values: &Map<String, Value>) -> impl Iterator<Item = (&String, &Value)> {
    values.iter().filter(|(key, _)| !PASSED_OVER.contains(&&***key))
}

/// One number for each part of what a case gave.
type Numbers = BTreeMap<String, f64>;

fn add(numbers: &mut Numbers, part: String, of: Fold) {
    if of.count > 0 {
        numbers.insert(part.replace(' ', "_"), of.sum);
    }
}

/// The lines that the command printed, but for some, as texts.
fn printed(text: &str, numbers: &mut Numbers, part: &str) {
    let kept = |line: &&str| {
        let label = line.split_whitespace().next().unwrap_or_default();
        !LINES_PASSED_OVER.contains(&label)
    };
    let mut sum = Fold::default();
    text.lines().filter(kept).for_each(|line| sum.text(line));
    add(numbers, part.to_owned(), sum);
}

/// Columns of a table.
fn table(text: &str, numbers: &mut Numbers, part: &str) {
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    for (k, name) in rows[0].iter().enumerate() {
        if *name == "newton_steps" || *name == "solve_seconds" {
            continue;
        }
        let mut sum = Fold::default();
        for cell in rows.iter().skip(1).filter_map(|row| row.get(k)) {
            match cell.parse() {
                Ok(number) => sum.number(number),
                Err(_) => sum.text(cell),
            }
        }
        add(numbers, format!("{part} {name}"), sum);
    }
}

/// The arrays of a VTU file of this program; those of contact.vtu, which contact.csv has, too, together.
fn arrays(text: &str, numbers: &mut Numbers, part: &str) {
    let mut all = Fold::default();
    for array in text.split("<DataArray ").skip(1) {
        let value = |key: &str| array.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next();
        let (kind, name) = (value("type").unwrap(), value("Name").unwrap());
        let bytes = BASE64.decode(array.lines().nth(1).unwrap()).unwrap();
        let mut own = Fold::default();
        let sum = if part == "contact.vtu" { &mut all } else { &mut own };
        match kind {
            "Float64" => {
                let all = bytes[8..].as_chunks().0;
                all.iter().for_each(|number| sum.number(f64::from_le_bytes(*number)));
            }
            _ => bytes[8..].iter().for_each(|byte| sum.number(f64::from(*byte))),
        }
        add(numbers, format!("{part} {name}"), own);
    }
    add(numbers, part.to_owned(), all);
}

/// The numbers of a picture, in its units.
fn drawn(text: &str, numbers: &mut Numbers, part: &str) {
    let is_of_number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let mut sum = Fold::default();
    for number in text.split(|c| !is_of_number(c)).filter_map(|word| word.parse::<f64>().ok()) {
        sum.sum += sum.weight() * number * 1e-3;
    }
    add(numbers, part.to_owned(), sum);
}

/// The radius around the discrete solution, and all that is enclosed by it as multiples of it: logarithms, as rounding has a part in
/// the radius, and most quantities are wider by the same factor.
fn enclosed(discrete: &Value, numbers: &mut Numbers, part: &str) {
    let Some(radius) = discrete["radius"].as_f64().filter(|radius| *radius > 0.0) else { return };
    let mut own = Fold::default();
    own.size(radius);
    add(numbers, format!("{part} radius"), own);
    let mut all = Fold::default();
    ["intervals", "pressure", "probes"].iter().for_each(|key| all.widths(&discrete[key], radius));
    let isolated = &discrete["isolated"];
    let limits = &isolated["limits"];
    let alone = [&isolated["unique_below"], &limits[0], &limits[1]];
    alone.iter().for_each(|value| all.widths(value, 1.0));
    add(numbers, format!("{part} widths"), all);
}

fn of_file(path: &Path, numbers: &mut Numbers, part: &str) {
    let name = path.file_name().unwrap().to_str().unwrap();
    let Ok(text) = fs::read_to_string(path) else { return };
    let part = format!("{part}{name}");
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("csv") => table(&text, numbers, &part),
        Some("vtu") => arrays(&text, numbers, &part),
        Some("svg") => drawn(&text, numbers, &part),
        Some("json") if name == "result.json" => {
            let result: Value = serde_json::from_str(&text).unwrap();
            enclosed(&result["certificate"]["discrete"], numbers, &part);
            for (key, value) in kept(result.as_object().unwrap()) {
                let inner = value.as_object().into_iter().flat_map(kept);
                for (inner, value) in inner {
                    add(numbers, format!("{part} {key}.{inner}"), Fold::of(value));
                }
                if !value.is_object() {
                    add(numbers, format!("{part} {key}"), Fold::of(value));
                }
            }
        }
        _ => {}
    }
}

/// What a case gives: `about` is its name and how the command is called, the first line of its text.
fn given(about: &str, case: &str, folder: &Path) -> Numbers {
    let (name, arguments) = about.split_once(": ").unwrap();
    let file = format!("{name}.toml");
    fs::write(folder.join(&file), case).unwrap();
    let (task, options) = arguments.split_once(' ').unwrap_or((arguments, ""));
    let out = folder.join(name);
    let run = |arguments: &[&str]| {
        let output = signorini(folder, arguments);
        String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap()
    };
    let mut arguments = vec![task, &*file];
    arguments.extend(options.split_whitespace());
    if task != "check" {
        arguments.extend(["--out", out.to_str().unwrap()]);
    }
    let mut numbers = Numbers::new();
    printed(&run(&arguments).replace(out.to_str().unwrap(), ""), &mut numbers, "printed");
    if out.join("certificate.json").is_file() {
        let certificate = format!("{name}/certificate.json");
        printed(&run(&["audit", &certificate]), &mut numbers, "audit");
    }
    for step in ["", "1", "2", "3"] {
        let Ok(files) = fs::read_dir(out.join(step)) else { continue };
        let part = if step.is_empty() { String::new() } else { format!("{step}/") };
        files.for_each(|file| of_file(&file.unwrap().path(), &mut numbers, &part));
    }
    numbers
}

/// What differs from the recorded numbers by more than rounding.
fn changed(recorded: &BTreeMap<String, f64>, found: &BTreeMap<String, f64>) -> Vec<String> {
    let mut all: Vec<&String> = recorded.keys().chain(found.keys()).collect();
    all.sort();
    all.dedup();
    let differs = |key: &&&String| match (recorded.get(**key), found.get(**key)) {
        (Some(a), Some(b)) => {
            // Pictures have a few digits, the last of which may be either of two; enclosures are as wide as rounding makes them.
            // Where a factor added its products up in another order, logarithms of widths differed by up to 0.36, one of a radius by 0.8.
            let tolerance = match key.rsplit(['.', '_', ' ']).next() {
                Some("svg" | "discrete") => 1e-3 * (1.0 + a.abs()),
                Some("widths") => 0.6,
                Some("radius") => 1.5,
                _ => 1e-7 * (1.0 + a.abs()),
            };
            !approx::abs_diff_eq!(a, b, epsilon = tolerance)
        }
        _ => true,
    };
    let told = |key: &&String| {
        format!("{key}: recorded {:?}, found {:?}", recorded.get(*key), found.get(*key))
    };
    all.iter().filter(differs).map(told).collect()
}

#[test]
fn what_small_cases_give_is_what_was_recorded() {
    let folder = root().join("tests/recorded");
    let mesh = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let room = with_files(
        "recorded",
        &[
            ("blocks.msh", &*mesh("tests/recorded/blocks.msh")),
            ("ring.msh", &*mesh("tests/recorded/ring.msh")),
            ("disk.msh", &*mesh("tests/recorded/disk.msh")),
            ("bowl.msh", &*mesh("tests/recorded/bowl.msh")),
            ("stack.msh", &*mesh("cases/stack.msh")),
            ("triangle.msh", &*mesh("cases/triangle.msh")),
            ("pivot.msh", &*mesh("tests/meshes/pivot.msh")),
        ],
    );
    let cases = fs::read_to_string(folder.join("cases.txt")).unwrap();
    let mut found = BTreeMap::new();
    for (about, case) in cases.split("=== ").filter_map(|case| case.split_once('\n')) {
        let name = about.split(':').next().unwrap();
        let numbers = given(about, case, &room);
        found.extend(numbers.into_iter().map(|(part, sum)| (format!("{name} {part}"), sum)));
    }
    let file = folder.join("numbers.txt");
    if std::env::var_os("SIGNORINI_RECORD").is_some() {
        let mut text = String::new();
        found.iter().for_each(|(key, sum)| writeln!(text, "{key} {sum:.8}").unwrap());
        fs::write(&file, text).unwrap();
    }
    let text = fs::read_to_string(&file).unwrap();
    let line = |line: &str| {
        let (key, sum) = line.rsplit_once(' ').unwrap();
        (key.to_owned(), sum.parse().unwrap())
    };
    let recorded: BTreeMap<String, f64> = text.lines().map(line).collect();
    let changes = changed(&recorded, &found);
    assert!(
        changes.is_empty(),
        "{} parts, the first:\n{}",
        changes.len(),
        changes[..changes.len().min(20)].join("\n")
    );
    // Controls: a digit, two numbers in each other's place, a word; not the last digits.
    let fold = |value: &str| Fold::of(&serde_json::from_str(value).unwrap()).sum;
    let one = fold(r#"[0.5, 2.0, "proved"]"#);
    let off = |value: &str| (fold(value) - one).abs();
    assert!(off(r#"[0.5, 2.0000000001, "proved"]"#) < 1e-9);
    for other in
        [r#"[0.5, 2.0001, "proved"]"#, r#"[2.0, 0.5, "proved"]"#, r#"[0.5, 2.0, "bounded"]"#]
    {
        assert!(off(other) > 4e-5, "control: {other}");
    }
    let width = |value: &str| {
        let mut sum = Fold::default();
        sum.widths(&serde_json::from_str(value).unwrap(), 1e-13);
        sum.sum
    };
    assert!(width("[[1.0, 1.000000000002]]") - width("[[1.0, 1.000000000001]]") > 0.6, "control");
    // Control: of a number that a part is the sum of, a change by 1e-4 is noticed.
    let mut other = found.clone();
    let key = "block-p1 result.json_quantities.peak_pressure";
    *other.get_mut(key).unwrap() += 1e-4;
    assert_eq!(changed(&recorded, &other).len(), 1, "control");
}
