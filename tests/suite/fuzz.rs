//! Fuzzers that run as tests, with a fixed budget and always the same inputs: mutated cases, expressions and meshes, and
//! mutated cases that are solved. No input may end in a panic, take longer than a few seconds, or get a message that is long
//! or holds control characters; and what is accepted keeps its promises (see each target).
//!
//! A long run, on other inputs each time: `FUZZ_SECONDS=3600 cargo test --release --test suite fuzz::`, so many seconds for
//! each of the four targets. An input that fails is kept in the folder that the message names.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use signorini::io::Expression;
use signorini::io::gmsh;
use signorini::io::raw_mesh::Made;
use signorini::model::Function;

use crate::common::{Random, root};

/// One of the seeds with a few changes: bytes, words of the format, parts of it or of another seed, an end too soon.
fn mutated(dice: &mut Random, seeds: &[Vec<u8>], words: &[&[u8]]) -> Vec<u8> {
    const LONGEST: usize = 1 << 16;
    let mut input = dice.pick(seeds);
    // Half of the inputs differ in a number alone: they get further.
    if dice.below(2) == 0 {
        replace_a_number(dice, &mut input, &in_lists(&[NUMBERS]));
        return input;
    }
    for _ in 0..=dice.below(4) {
        let at = dice.below(input.len() + 1);
        let end = (at + dice.below(24)).min(input.len());
        match dice.below(8) {
            0 => input.truncate(at),
            1 => drop(input.drain(at..end)),
            2 if at < input.len() => input[at] ^= 1 << dice.below(8),
            3 if at < input.len() => input[at] = dice.below(256) as u8,
            4 => {
                let part = input[at..end].to_vec();
                let times = dice.below(40);
                input.splice(at..at, part.repeat(times));
            }
            5 => {
                let other = dice.pick(seeds);
                let from = dice.below(other.len() + 1);
                let to = (from + dice.below(200)).min(other.len());
                input.splice(at..end, other[from..to].iter().copied());
            }
            6 => replace_a_number(dice, &mut input, words),
            _ => drop(input.splice(at..end, dice.pick(words).iter().copied())),
        }
    }
    input.truncate(LONGEST);
    input
}

/// Another word where a number stands: what is read is then most often a case or a mesh, if a strange one.
fn replace_a_number(dice: &mut Random, input: &mut Vec<u8>, words: &[&[u8]]) {
    let is_part = |b: &u8| b.is_ascii_digit() || *b == b'.';
    let starts: Vec<usize> = (0..input.len())
        .filter(|&i| is_part(&input[i]) && (i == 0 || !is_part(&input[i - 1])))
        .collect();
    let Some(&start) = starts.get(dice.below(starts.len())) else { return };
    let length = input[start..].iter().take_while(|b| is_part(b)).count();
    input.splice(start..start + length, dice.pick(words).iter().copied());
}

/// Runs a target on mutated seeds: `runs` times, or as long as FUZZ_SECONDS says.
fn fuzz(
    name: &str,
    runs: usize,
    seeds: &[Vec<u8>],
    words: &[&[u8]],
    target: impl Fn(&[u8]) -> bool,
) {
    const SLOW: Duration = Duration::from_secs(20);
    let seconds =
        std::env::var("FUZZ_SECONDS").ok().map(|s| s.parse().expect("FUZZ_SECONDS is a number"));
    let start = Instant::now();
    let seed = match seconds {
        None => 0,
        Some(_) => SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos() as u64,
    };
    let mut dice = Random(seed);
    let (mut done, mut accepted) = (0, 0);
    let more = |done: usize| match seconds {
        None => done < runs,
        Some(seconds) => start.elapsed() < Duration::from_secs(seconds),
    };
    while more(done) {
        // The seeds themselves come first.
        let input = seeds.get(done).cloned().unwrap_or_else(|| mutated(&mut dice, seeds, words));
        let begin = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| target(&input)));
        if outcome.is_err() || begin.elapsed() > SLOW {
            let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
            fs::create_dir_all(&folder).unwrap();
            let file = folder.join(format!("{name}-{seed}-{done}"));
            fs::write(&file, &input).unwrap();
            panic!(
                "{name}: run {done} failed or took {:?}; its input is {}",
                begin.elapsed(),
                file.display()
            );
        }
        accepted += usize::from(outcome.unwrap_or(false));
        done += 1;
    }
    println!(
        "{name}: {done} runs, {accepted} inputs accepted, {:.0} s",
        start.elapsed().as_secs_f64()
    );
    // A target that accepts nothing, or everything, tests nothing.
    assert!(accepted > done / 100 && accepted < done, "{name}: {accepted} of {done} accepted");
}

fn check_message(message: &str) {
    assert!(message.len() < 3000, "a message of {} bytes", message.len());
    assert!(!message.chars().any(char::is_control), "{message:?}");
}

fn files(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let folder = root().join(folder);
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == ending));
    paths.sort();
    assert!(!paths.is_empty());
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

const NUMBERS: &[u8] = b"0|1|-1|2|0.5|-0.0|1e-3|1e300|-1e300|1e-300|1e308|5e-324|1e999|nan|inf|-inf|3.0000000000000004|\
    1e16|1_000|0x7f|99999999999999999999|-9223372036854775808";

const EXPRESSION: &[u8] = b"x|y|pi|+|-|*|/|^|(|)|,| |sqrt(|sin(|cos(|exp(|abs(|min(|max(|x^2|y^-3|1/x|(x|2^|-x^-y|1e|.5|e9|\
    \xc3\xa9|\0";

const EXPRESSIONS: [&str; 10] = [
    "-4 + 10*x",
    "0.2*(x - 0.3)^2",
    "min(x, y)^2 - max(-x, 1)",
    "sqrt(abs(x)) + exp(-y)/(1 + y^2)",
    "-x^2 + 2^3^2 - 2^-1",
    "sin(pi*x)*cos(pi*y)",
    "((x + 1)*(x - 1))^16",
    "1e-3*x - .5e+1",
    "x - (y - (x - (y - 1)))",
    "+-+x^0.5",
];

/// The words of lists, in which `|` separates them.
fn in_lists(lists: &[&'static [u8]]) -> Vec<&'static [u8]> {
    lists.iter().flat_map(|list| list.split(|&b| b == b'|')).collect()
}

/// An expression that is read has a value everywhere; parentheses around it and two signs before it change no bit of it.
#[test]
fn an_expression_that_is_read_has_a_value_everywhere() {
    let seeds: Vec<Vec<u8>> = EXPRESSIONS.iter().map(|e| e.as_bytes().to_vec()).collect();
    fuzz("expressions", 20_000, &seeds, &in_lists(&[NUMBERS, EXPRESSION]), |input| {
        let text = String::from_utf8_lossy(input);
        let expression = match text.parse::<Expression>() {
            Ok(expression) => expression,
            Err(error) => {
                check_message(&error.to_string());
                return false;
            }
        };
        let _ = (expression.degree(), expression.constant(), expression.polynomial_in_x());
        // Nested as deep as it may be, it leaves no room for more.
        let around = ["(", "--("].map(|open| format!("{open}{text}\n)").parse::<Expression>());
        for x in [[0.0, 0.0], [0.3, -1.7], [1e300, 1e-300], [f64::NAN, 1.0]] {
            let value = expression.at(x);
            for around in around.iter().flatten() {
                let same = around.at(x);
                assert!(
                    same.to_bits() == value.to_bits() || (same.is_nan() && value.is_nan()),
                    "{text:?} at {x:?}"
                );
            }
        }
        true
    });
}

const MESH: &[u8] =
    b"$Nodes\n|$EndNodes\n|$Elements\n|$EndElements\n|$Entities\n|$EndEntities\n|$PhysicalNames\n|\
    $EndPhysicalNames\n|$MeshFormat\n4.1 0 8\n$EndMeshFormat\n|\n| |\"floor\"|18446744073709551615|\
    \xff\xff\xff\xff\xff\xff\xff\xff|\0\0\0\0\0\0\xf0\x7f|1 1 2\n";

/// A mesh that is read is one: its triangles have areas, and its boundary is closed.
#[test]
fn a_mesh_that_is_read_has_areas_and_a_closed_boundary() {
    let seeds = files("tests/meshes", "msh");
    let small: Vec<Vec<u8>> = seeds.into_iter().filter(|seed| seed.len() < 1 << 15).collect();
    fuzz("meshes", 4000, &small, &in_lists(&[NUMBERS, MESH]), |input| {
        match gmsh::from_bytes(input, Path::new("fuzzed.msh"), None, &[]) {
            Ok(Made { mesh, .. }) => {
                assert!((0..mesh.triangles().len()).all(|t| mesh.triangle(t).double_area() > 0.0));
                let mut starts: Vec<usize> =
                    mesh.outline().iter().map(|&e| mesh.ends(e)[0]).collect();
                let mut ends: Vec<usize> =
                    mesh.outline().iter().map(|&e| mesh.ends(e)[1]).collect();
                starts.sort_unstable();
                ends.sort_unstable();
                assert_eq!(starts, ends);
                true
            }
            Err(error) => {
                check_message(&error.to_string());
                false
            }
        }
    });
}

mod cases {
    use signorini::io::Case;
    use signorini::io::outputs::{self, Extra};
    use signorini::io::result::result_json;
    use signorini::solve::solve;

    use super::super::bad_input::CASE;
    use super::*;

    const WORDS: &[u8] = b"[mesh]\n|[material]\n|[load]\n|[boundary.left]\n|[boundary.top]\n|[method]\n|[solver]\n|[output]\n|\
        [exact]\n|displacement = |traction = |contact = {}\n|[\"0\", \"free\"]|[\"x\", \"-y\"]|\"0\"|\"1/x\"|degree = 2\n|\
        gamma0 = \"auto\"\n|gamma0 = |allow_noncoercive = true\n|contact_quadrature = { gauss = 4 }\n|\
        diagonal = \"crossed\"|plane = \"stress\"\n|perturb = { amount = 0.2, seed = 1 }\n|probes = [[0.5, 0.5]]\n|\
        \"|\"\"\"|{|}|[|]|=|#|\n";

    /// Small ones: what is fuzzed are the doors, not the patience.
    fn small() -> String {
        let loads = "[boundary.right]\ntraction = [\"0\", \"0.5\"]\n[boundary.bottom]";
        CASE.replace("gamma0 = 0.1", "gamma0 = \"auto\"")
            .replace("[\"0\", \"free\"]", "[\"0\", \"0\"]")
            .replace("gap = \"0\"", "gap = \"0.01*x\"")
            .replace("[boundary.bottom]", loads)
    }

    fn seeds() -> Vec<Vec<u8>> {
        let quadratic = small().replace("degree = 1", "degree = 2");
        let gauss =
            small().replace("\"exact\"", "{ gauss = 3 }").replace("right\" }", "crossed\" }");
        let mut seeds = [small(), quadratic, gauss].map(String::into_bytes).to_vec();
        for seed in files("cases", "toml") {
            let text = String::from_utf8(seed).unwrap();
            seeds.push(text.replace("= 32", "= 4").replace("= 16", "= 4").into_bytes());
        }
        seeds
    }

    /// A number of cells with more than two digits is left alone.
    fn is_large(text: &str) -> bool {
        let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '+' | '-');
        let counts =
            text.lines().filter(|line| ["nx", "ny", "n ", "n="].iter().any(|k| line.contains(k)));
        counts.flat_map(|line| line.split(|c| !is_part(c))).any(|word| {
            word.starts_with(|c: char| c.is_ascii_digit() || c == '+')
                && word.len() > 2
                && !word.contains('.')
        })
    }

    fn read(input: &[u8]) -> Option<Case> {
        let text = String::from_utf8_lossy(input);
        if is_large(&text) {
            return None;
        }
        // Beside the meshes that the cases name.
        let file = root().join("cases/fuzzed.toml");
        match Case::parse(&file, &text, &[]) {
            Ok(case) => Some(case),
            Err(error) => {
                check_message(&error.to_string());
                None
            }
        }
    }

    #[test]
    fn a_case_is_read_or_refused() {
        let words = in_lists(&[NUMBERS, EXPRESSION, WORDS]);
        fuzz("cases", 2000, &seeds(), &words, |input| read(input).is_some());
    }

    /// A case that is solved has results that can be written: all numbers are finite, and contact pushes.
    #[test]
    fn a_case_that_is_solved_has_finite_results_and_contact_that_pushes() {
        let small: Vec<Vec<u8>> = seeds().into_iter().take(3).collect();
        let words = in_lists(&[NUMBERS, WORDS]);
        fuzz("solved cases", 300, &small, &words, |input| {
            let Some(mut case) = read(input) else { return false };
            if case.problem.mesh.triangles().len() > 1000 {
                return false;
            }
            case.settings.max_iterations = case.settings.max_iterations.min(100);
            let solved = match solve(&case.problem, &case.method, &case.settings) {
                Ok(solved) => solved.into(),
                Err(error) => {
                    // The history of the residuals stands on a line of its own.
                    check_message(&error.to_string().replace("\nresiduals: ", " residuals: "));
                    return false;
                }
            };
            match outputs::results(&case, &solved, Duration::ZERO, Extra::default()) {
                Ok(results) => {
                    assert!(solved.solution.quantities.contact_force >= 0.0);
                    match result_json(&results) {
                        Ok(_) => true,
                        Err(error) => {
                            check_message(&error.to_string());
                            false
                        }
                    }
                }
                Err(error) => {
                    check_message(&error.to_string());
                    false
                }
            }
        });
    }
}
