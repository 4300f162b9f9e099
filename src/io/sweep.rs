//! The command `signorini sweep`: one case, solved for every combination of the values that some of its keys are given, as
//! a table for people and as CSV.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use toml::de::{DeTable, DeValue};

use super::case::Case;
use super::csv;
use super::files::Output;
use super::input::Failure;
use super::numbers::short;
use super::outputs::{self, Extra};
use super::result::Results;
use super::run;
use crate::quote;
use crate::solve::Solution;
use crate::solve::answers::label;

/// The most runs of a sweep: more are a mistake of the person who asks for them.
pub const MOST_RUNS: usize = 10_000;

/// A key of the case file and the values that it takes, such as `method.gamma0=1e-3,1e-2`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterAxis {
    /// The key with its dots.
    pub key: String,
    /// The values as TOML has them; at least one.
    pub values: Vec<String>,
}

impl FromStr for ParameterAxis {
    type Err = Failure;

    fn from_str(text: &str) -> Result<ParameterAxis, Failure> {
        let no_axis =
            || Failure::wrong("expected KEY=VALUE,VALUE,..., such as method.gamma0=1e-3,1e-2");
        let (key, values) = text.split_once('=').ok_or_else(no_axis)?;
        // Commas inside texts, lists and tables separate nothing; bare words are no TOML, and have no commas.
        let values = items(values)
            .unwrap_or_else(|| values.split(',').map(|value| value.trim().to_owned()).collect());
        if key.trim().is_empty() || values.is_empty() || values.iter().any(String::is_empty) {
            return Err(no_axis());
        }
        Ok(ParameterAxis { key: key.trim().to_owned(), values })
    }
}

/// The texts of the items of a TOML list, without its brackets.
fn items(list: &str) -> Option<Vec<String>> {
    let line = format!("list = [{list}]");
    let table = DeTable::parse(&line).ok()?;
    match table.get_ref().get("list")?.get_ref() {
        DeValue::Array(items) => {
            items.iter().map(|item| Some(line.get(item.span())?.to_owned())).collect()
        }
        _ => None,
    }
}

/// The entry of a run that is still to come when a sweep is stopped.
const NOT_SOLVED: &str = "not solved";

pub const FILE: &str = "sweep.csv";

/// The name of the file that ParaView opens, where the runs have files.
pub(crate) const COLLECTION: &str = "sweep.pvd";

/// A case and its results for the combinations of the values of some keys.
#[derive(Clone, Debug)]
pub struct Sweep {
    pub title: String,
    pub keys: Vec<String>,
    /// The values of the keys in each run; those of the last key change first.
    pub values: Vec<Vec<String>>,
    /// The results of the runs so far, or why there are none.
    pub results: Vec<Result<Results, Failure>>,
    /// The files of each run are written, too.
    pub with_files: bool,
}

/// The number of runs that these axes make.
pub fn count(axes: &[ParameterAxis]) -> Result<usize, Failure> {
    let twice = |(i, axis): (usize, &ParameterAxis)| axes[..i].iter().any(|a| a.key == axis.key);
    if let Some(axis) = axes.iter().enumerate().find(|&axis| twice(axis)).map(|(_, axis)| axis) {
        let key = &axis.key;
        return Err(Failure::wrong(format!(
            "--set {key} is there twice; expected each key once, with all its values"
        )));
    }
    let runs = axes.iter().fold(1_usize, |runs, axis| runs.saturating_mul(axis.values.len()));
    if runs > MOST_RUNS {
        let said = format!("--set makes {runs} runs; expected at most {MOST_RUNS}");
        return Err(Failure::wrong(said));
    }
    Ok(runs)
}

/// Solves the case with this text (see [`Case::parse`]) for each combination of the axes' values, each from the solution of
/// the one before where the nodes are the same, and calls `done` with the sweep so far after each. With `files`, those of run i
/// (from 1) are written into the folder i of `folder`; those that an earlier sweep wrote there go before the first run.
///
/// # Errors
/// A mistake in the case or in one of the values, found before anything is solved; files that can't be written; what `done`
/// gives. A run that has no solution is none: its entry in [`Sweep::results`] says why.
pub fn run(
    file: &Path,
    text: &str,
    axes: &[ParameterAxis],
    folder: &Path,
    files: bool,
    mut done: impl FnMut(&Sweep) -> Result<(), Failure>,
) -> Result<Sweep, Failure> {
    count(axes)?;
    let values = combinations(axes);
    let read = |values: &[String]| {
        let setting = |(axis, value): (&ParameterAxis, &String)| format!("{}={value}", axis.key);
        let settings: Vec<String> = axes.iter().zip(values).map(setting).collect();
        Case::parse(file, text, &settings)
    };
    let mut title = String::new();
    for values in &values {
        title = read(values)?.title;
    }
    clear(folder);
    let keys = axes.iter().map(|axis| axis.key.clone()).collect();
    let mut sweep = Sweep { title, keys, values, results: Vec::new(), with_files: files };
    let mut last = None;
    for i in 0..sweep.values.len() {
        let case = read(&sweep.values[i])?;
        let folder = files.then(|| of_run(folder, i));
        sweep.results.push(solve(case, folder.as_deref(), &mut last)?);
        done(&sweep)?;
    }
    Ok(sweep)
}

fn of_run(folder: &Path, i: usize) -> PathBuf {
    folder.join((i + 1).to_string())
}

/// Removes the files that an earlier sweep into `folder` has written of its runs, result.json first, and the folders of runs
/// that are empty then. What can't be removed stays.
fn clear(folder: &Path) {
    for run in (0..MOST_RUNS).map(|i| of_run(folder, i)).filter(|run| run.is_dir()) {
        for name in outputs::FILES.iter().rev() {
            let _ = fs::remove_file(run.join(name));
        }
        let _ = fs::remove_dir(run);
    }
}

/// The values of each run; those of the last axis change first.
fn combinations(axes: &[ParameterAxis]) -> Vec<Vec<String>> {
    axes.iter().fold(vec![Vec::new()], |runs, axis| {
        let with = |run: &Vec<String>| {
            let run = run.clone();
            axis.values.iter().map(move |value| [&run[..], std::slice::from_ref(value)].concat())
        };
        runs.iter().flat_map(with).collect()
    })
}

/// Solves from the `last` solution, and leaves its own there.
fn solve(
    case: Case,
    folder: Option<&Path>,
    last: &mut Option<Solution>,
) -> Result<Result<Results, Failure>, Failure> {
    let (case, mut solved) = match run::solve(case, last.as_ref(), &|_| {}) {
        Ok(solved) => solved,
        Err(error) => return Ok(Err(error)),
    };
    let results = match folder {
        Some(folder) => {
            solved.certify(&case);
            outputs::write(folder, &case, &solved, Duration::ZERO, Extra::default())?.1
        }
        None => outputs::results(&case, &solved, Duration::ZERO, Extra::default())?,
    };
    *last = Some(solved.solution);
    Ok(Ok(results))
}

type NumberFormat<'a> = &'a dyn Fn(f64) -> String;

/// The numbers of a run by their names: forces, moments and energies times the thickness, if the case has one. Those whose
/// name has no point stand in the table for people, too.
fn cells(r: &Results, shown: NumberFormat) -> Vec<(String, String)> {
    let (q, thickness) = (&r.quantities, r.thickness.unwrap_or(1.0));
    // That of the summary: the recovered one.
    let peak = r.contact.iter().map(|part| part.peak_pressure).reduce(f64::max);
    let brief = [
        ("verdict", Some(r.outcome().unwrap_or_default())),
        ("gamma0", Some(shown(r.gamma.gamma0))),
        ("kappa", Some(shown(r.gamma.kappa))),
        ("newton_steps", Some(r.newton.iterations.to_string())),
        ("contact_force", Some(shown(q.contact_force * thickness))),
        ("contact_length", Some(shown(q.contact_length))),
        ("peak_pressure", peak.map(shown)),
        ("max_von_mises", r.stress.as_ref().map(|stress| shown(stress.von_mises.value))),
        ("max_displacement", Some(shown(q.max_displacement))),
        ("energy", Some(shown(q.energy * thickness))),
        ("energy_error", r.errors.as_ref().map(|errors| shown(errors.energy))),
    ];
    let brief = brief.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let mut cells: Vec<(String, String)> = brief.collect();
    let mut add = |of: &str, what: &str, x: f64| cells.push((format!("{of}.{what}"), shown(x)));
    for part in &r.contact {
        let name = part.label();
        add(&name, "force", part.force * thickness);
        add(&name, "length", part.length);
        add(&name, "peak_pressure", part.peak_pressure);
    }
    // Outwards, should the product be rounded.
    let outwards =
        |[low, high]: [f64; 2]| [(low * thickness).next_down(), (high * thickness).next_up()];
    let proved = r.certificate.as_ref().and_then(|c| c.discrete.as_ref()?.intervals.as_ref());
    for part in proved.iter().flat_map(|intervals| &intervals.contact) {
        let (name, [low, high]) =
            (label(&part.boundary, part.partner.as_deref()), outwards(part.force));
        add(&name, "force_low", low);
        add(&name, "force_high", high);
    }
    let certified = r.certificate.as_ref().and_then(|c| c.continuous.as_ref());
    for part in &r.contact {
        let proved = certified.and_then(|c| c.contact_force(&part.boundary));
        let Some([low, high]) = proved.map(outwards) else { continue };
        add(&part.boundary, "true_force_low", low);
        add(&part.boundary, "true_force_high", high);
    }
    for (boundary, [x, y]) in &q.reactions {
        add(boundary, "reaction_x", x * thickness);
        add(boundary, "reaction_y", y * thickness);
    }
    for (i, [_, _, u_x, u_y]) in (1..).zip(&r.probes) {
        add(&format!("probe_{i}"), "u_x", *u_x);
        add(&format!("probe_{i}"), "u_y", *u_y);
    }
    cells
}

impl Sweep {
    /// The heading and a line for each run: the values, the numbers of any run in the order of [`cells`], and how it ended.
    fn lines(&self, brief: bool, shown: NumberFormat) -> Vec<Vec<String>> {
        let of_run = |result: &Result<Results, Failure>| match result {
            Ok(results) => (cells(results, shown), results.newton.verdict().to_owned()),
            Err(error) => (Vec::new(), error.to_string()),
        };
        let mut runs: Vec<(Vec<(String, String)>, String)> =
            self.results.iter().map(of_run).collect();
        runs.resize_with(self.values.len(), || (Vec::new(), NOT_SOLVED.to_owned()));
        // gamma0 as a key stands there already.
        let is_new = |name: &str| !self.keys.iter().any(|key| key == &format!("method.{name}"));
        let mut columns: Vec<&str> = Vec::new();
        for (name, _) in runs.iter().flat_map(|(cells, _)| cells) {
            let is_shown = !brief || !name.contains('.');
            if is_new(name) && is_shown && !columns.contains(&&**name) {
                columns.push(name);
            }
        }
        let heading = self.keys.iter().map(String::as_str).chain(columns.iter().copied());
        let mut lines = vec![heading.chain(["status"]).map(str::to_owned).collect()];
        for (values, (cells, status)) in self.values.iter().zip(&runs) {
            let value = |name: &&str| {
                let cell = cells.iter().find(|(other, _)| other == *name);
                cell.map_or(String::new(), |(_, value)| value.clone())
            };
            let numbers = columns.iter().map(value);
            lines.push(values.iter().cloned().chain(numbers).chain([status.clone()]).collect());
        }
        lines
    }

    /// The table for people: columns with four digits, aligned.
    pub fn table(&self) -> String {
        let mut lines = self.lines(true, &|x| short(x, 4));
        for line in &mut lines {
            let status = line.len() - 1;
            line[..status].iter_mut().for_each(|value| *value = quote::line(value));
        }
        let columns = lines[0].len() - 1;
        let width = |c: usize| lines.iter().map(|line| line[c].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let line = |line: &Vec<String>| {
            let cells = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}  "));
            // What was expected instead is in the CSV; here it would make the line too long.
            let status = line[columns].split(": expected").next().unwrap_or_default();
            cells.collect::<String>() + status + "\n"
        };
        lines.iter().map(line).collect()
    }

    /// The text of sweep.csv: each number the shortest decimal that reads back to the same double.
    pub fn csv(&self) -> String {
        self.lines(false, &csv::number).into_iter().map(csv::line).collect()
    }

    /// The text of sweep.pvd: the solutions of the runs as the steps of one animation, for ParaView.
    fn pvd(&self) -> String {
        let step = |(i, results): (i32, &Result<Results, Failure>)| match results {
            Ok(_) => format!("<DataSet timestep=\"{i}\" file=\"{i}/solution.vtu\"/>\n"),
            Err(_) => String::new(),
        };
        let steps: String = (1..).zip(&self.results).map(step).collect();
        format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n{steps}</Collection>\n</VTKFile>\n"
        )
    }

    /// Writes sweep.csv into `folder`, and sweep.pvd where the runs have files; returns their paths.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
        let mut output = Output::new(folder)?.replacing(&[COLLECTION]);
        if self.with_files {
            output.stage(COLLECTION, self.pvd().as_bytes())?;
        }
        output.stage(FILE, self.csv().as_bytes())?;
        output.publish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(text: &str) -> ParameterAxis {
        text.parse().unwrap()
    }

    #[test]
    fn an_axis_is_a_key_and_the_items_of_a_list() {
        for (text, key, values) in [
            ("method.gamma0=1e-3,1e-2", "method.gamma0", &["1e-3", "1e-2"][..]),
            ("method.gamma0=auto, 0.1", "method.gamma0", &["auto", "0.1"]),
            (
                "load.body=[\"0\", \"-1\"],[\"0\", \"-2\"]",
                "load.body",
                &["[\"0\", \"-1\"]", "[\"0\", \"-2\"]"],
            ),
            ("title=\"a,b\"", "title", &["\"a,b\""]),
            ("a={gauss = 4},\"exact\"", "a", &["{gauss = 4}", "\"exact\""]),
        ] {
            let ParameterAxis { key: found, values: list } = axis(text);
            assert_eq!((&*found, list), (key, values.iter().map(|v| (*v).to_owned()).collect()));
        }
        for text in ["method.gamma0", "=1", "a=", "a=x,,y"] {
            assert!(text.parse::<ParameterAxis>().is_err(), "{text}");
        }
    }

    #[test]
    fn the_last_axis_changes_first() {
        let axes = [axis("a=1,2"), axis("b=3,4,5")];
        assert_eq!(count(&axes).unwrap(), 6);
        let runs: Vec<String> = combinations(&axes).iter().map(|values| values.join("")).collect();
        assert_eq!(runs, ["13", "14", "15", "23", "24", "25"]);
        assert_eq!(combinations(&[]), [Vec::<String>::new()]);
    }

    #[test]
    fn too_many_runs_and_a_key_on_two_axes_are_refused() {
        let many = axis(&format!("a={}", ["1"; 101].join(",")));
        let axes = [many.clone(), ParameterAxis { key: "b".to_owned(), ..many }];
        let said = count(&axes).unwrap_err().to_string();
        assert_eq!(said, "--set makes 10201 runs; expected at most 10000");
        let said = count(&[axis("a=1"), axis("a=2")]).unwrap_err().to_string();
        assert_eq!(said, "--set a is there twice; expected each key once, with all its values");
    }
}
