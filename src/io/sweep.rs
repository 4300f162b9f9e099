//! The command `signorini sweep`: one case, solved for every combination of the values that some of its keys are given, as
//! a table for people and as CSV.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use super::case::Case;
use super::csv;
use super::files::Output;
use super::input::{Failure, reason};
use super::numbers::short;
use super::outputs::{self, Extra, Series};
use super::picture::Scene;
use super::picture::plot::{COLOURS, Figure, Panel, Style, figure};
use super::result::Results;
use super::run::{self, Earlier};
use super::summary;
use crate::quote;
use crate::results::answers::label;

/// The most runs of a sweep: more are a mistake of the person who asks for them.
const MOST_RUNS: usize = 10_000;

/// The largest number of remarks below the table.
const MOST_REMARKS: usize = 20;

/// A key of the case file and the values that it takes, such as `method.gamma0=1e-3,1e-2`, or `material.young=1000:3000:5`: five
/// values from 1000 to 3000, as far from one to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ParameterAxis {
    /// The key with its dots.
    pub(crate) key: String,
    /// The values as TOML has them; at least one.
    pub(crate) values: Vec<String>,
}

impl FromStr for ParameterAxis {
    type Err = Failure;

    fn from_str(text: &str) -> Result<ParameterAxis, Failure> {
        let no_axis = || {
            Failure::wrong(
                "expected KEY=VALUE,VALUE,..., such as method.gamma0=1e-3,1e-2, or a range with the number of its values, such as material.young=1000:3000:5",
            )
        };
        let (key, values) = text.split_once('=').ok_or_else(no_axis)?;
        let values: Vec<String> = items(values).into_iter().flat_map(expanded).collect();
        if key.trim().is_empty() || values.is_empty() || values.iter().any(String::is_empty) {
            return Err(no_axis());
        }
        Ok(ParameterAxis { key: key.trim().to_owned(), values })
    }
}

/// The texts between the commas of a list; commas inside texts, lists and tables separate nothing.
fn items(list: &str) -> Vec<&str> {
    let (mut items, mut start, mut depth, mut quote) = (Vec::new(), 0, 0_i32, None);
    for (i, c) in list.char_indices() {
        match (quote, c) {
            (Some(mark), c) if c == mark => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth -= 1,
            (None, ',') if depth == 0 => {
                items.push(list[start..i].trim());
                start = i + 1;
            }
            _ => {}
        }
    }
    items.push(list[start..].trim());
    items
}

/// The values that an item with a range `from:to:count` stands for, alone or as an entry of a list; any other item stands for itself.
fn expanded(item: &str) -> Vec<String> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, ':' | '.' | '+' | '-' | '_');
    let tokens = item.split(|c: char| !is_part(c)).filter(|token| token.matches(':').count() == 2);
    let range = |token: &str| -> Option<Vec<f64>> {
        let mut parts = token.split(':');
        let ends = [parts.next()?, parts.next()?].map(|end| end.parse::<f64>().ok());
        let (from, to, count) = (ends[0]?, ends[1]?, parts.next()?.parse::<usize>().ok()?);
        let counts = (2..=MOST_RUNS).contains(&count) && from.is_finite() && to.is_finite();
        let step = |i: usize| from + (to - from) * (i as f64 / (count - 1) as f64);
        counts.then(|| (0..count).map(step).collect())
    };
    let found = tokens.filter(|_| !item.contains(['"', '\''])).find_map(|t| Some((t, range(t)?)));
    match found {
        Some((token, values)) => {
            values.iter().map(|&x| item.replacen(token, &short(x, 12), 1)).collect()
        }
        None => vec![item.to_owned()],
    }
}

/// The entry of a run that is still to come when a sweep is stopped.
const NOT_SOLVED: &str = "not solved";

/// The names of the files of a table of runs: the table, force and peak over what varies, and what ParaView opens, where the runs have
/// files.
pub(crate) type Names = [&'static str; 3];

pub(crate) const FILES: &Names = &["sweep.csv", "sweep.svg", "sweep.pvd"];

/// A case and its results for the combinations of the values of some keys.
#[derive(Clone, Debug)]
pub(crate) struct Sweep {
    pub(crate) title: String,
    pub(crate) keys: Vec<String>,
    /// The values of the keys in each run; those of the last key change first.
    pub(crate) values: Vec<Vec<String>>,
    /// The results of the runs so far, or why there are none.
    pub(crate) results: Vec<Result<Results, Failure>>,
    /// The files of each run are written, too.
    pub(crate) with_files: bool,
    pub(crate) names: &'static Names,
}

/// The number of runs that these axes make.
pub(crate) fn count(axes: &[ParameterAxis]) -> Result<usize, Failure> {
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

/// Options of a sweep beside the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// The files of each run are written, too.
    pub(crate) files: bool,
    /// The number of runs that are solved at the same time, at least 1.
    pub(crate) jobs: usize,
}

/// The stack of a run: that of the first thread of a program.
const STACK: usize = 8 << 20;

/// Solves the case with this text (see [`Case::parse`]) for each combination of the axes' values, and calls `done` with the sweep
/// so far after each. Each run starts from the solution of the one before where the nodes are the same; with several jobs, each
/// has as many runs in a row. With files, those of run i (from 1) are written into the folder i of `folder`; those that an earlier
/// sweep wrote there go before the first run.
///
/// # Errors
/// A mistake in the case or in one of the values, found before anything is solved; files that can't be written; what `done`
/// gives. A run that has no solution is none: its entry in [`Sweep::results`] says why.
pub(crate) fn run(
    file: &Path,
    text: &str,
    axes: &[ParameterAxis],
    folder: &Path,
    Extent { files, jobs }: Extent,
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
        let case = read(values)?;
        if !case.steps.is_empty() {
            return Err(Failure::wrong(
                "found [[step]] in the case, whose load steps are solved one after the other; expected a case without, or 'signorini solve'",
            ));
        }
        title = case.title;
    }
    clear(folder);
    let keys = axes.iter().map(|axis| axis.key.clone()).collect();
    let mut sweep =
        Sweep { title, keys, values, results: Vec::new(), with_files: files, names: FILES };
    let all = sweep.values.clone();
    let one = |i: usize, last: &mut Earlier| {
        let folder = files.then(|| of_run(folder, i));
        solve(read(&all[i])?, folder.as_deref(), last)
    };
    let mut series = Series::default();
    each_in_order(all.len(), jobs, &one, |(results, scene)| {
        if let Some(scene) = scene {
            series.add(of_run(folder, sweep.results.len()), scene);
        }
        sweep.results.push(results);
        done(&sweep)
    })?;
    series.draw()?;
    Ok(sweep)
}

/// Hands the results of the runs to `take` in their order, made by jobs that each do as many runs in a row, from one solution to the
/// next. A failure stops all.
fn each_in_order<T: Send>(
    runs: usize,
    jobs: usize,
    one: &(impl Fn(usize, &mut Earlier) -> Result<T, Failure> + Sync),
    mut take: impl FnMut(T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let in_a_row = runs.div_ceil(jobs.clamp(1, runs.max(1)));
    let stopped = &AtomicBool::new(false);
    let stop = |_: &Failure| stopped.store(true, Ordering::Relaxed);
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for first in (0..runs).step_by(in_a_row) {
            let sender = sender.clone();
            let work = move || {
                let mut last = Earlier::default();
                for i in first..runs.min(first + in_a_row) {
                    let ended = stopped.load(Ordering::Relaxed)
                        || sender.send((i, one(i, &mut last))).is_err();
                    if ended {
                        break;
                    }
                }
            };
            let started = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
            let failed = |error| format!("cannot start a job: {}", reason(&error));
            started.map_err(|error| Failure::failed(failed(error))).inspect_err(stop)?;
        }
        drop(sender);
        // Runs that ended before one that comes before them in the table.
        let (mut early, mut next) = (BTreeMap::new(), 0);
        for (i, result) in receiver {
            early.insert(i, result);
            while let Some(result) = early.remove(&next) {
                next += 1;
                result.and_then(&mut take).inspect_err(stop)?;
            }
        }
        Ok(())
    })
}

pub(crate) fn of_run(folder: &Path, i: usize) -> PathBuf {
    folder.join((i + 1).to_string())
}

/// Removes the files that an earlier sweep into `folder` has written of its runs, result.json first, and the folders of runs
/// that are empty then. What can't be removed stays.
pub(crate) fn clear(folder: &Path) {
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

/// The results of a run or why there are none, and the content of its picture if it has files.
type Ended = (Result<Results, Failure>, Option<Scene>);

/// Solves from what the `last` run has left, and leaves its own there.
fn solve(case: Case, folder: Option<&Path>, last: &mut Earlier) -> Result<Ended, Failure> {
    let (case, mut solved) = match run::solve(case, Some(last), &|_| {}) {
        Ok(solved) => solved,
        Err(error) => return Ok((Err(error), None)),
    };
    let (results, scene) = match folder {
        Some(folder) => {
            solved.certify(&case);
            let extra = Extra::default();
            let written = outputs::write(folder, &case, &solved, Duration::ZERO, extra)?;
            (written.results, Some(written.scene))
        }
        None => (outputs::results(&case, &solved, Duration::ZERO, Extra::default())?, None),
    };
    last.start = Some(solved.solution);
    Ok((Ok(results), scene))
}

/// The values of each name, the names in the order in which they come first.
fn grouped<T>(named: impl Iterator<Item = (String, T)>) -> Vec<(String, Vec<T>)> {
    let mut groups: Vec<(String, Vec<T>)> = Vec::new();
    for (name, value) in named {
        match groups.iter_mut().find(|(other, _)| *other == name) {
            Some((_, values)) => values.push(value),
            None => groups.push((name, vec![value])),
        }
    }
    groups
}

/// The numbers in the value of a key, in their order.
fn numbers(value: &str) -> Vec<f64> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '+' | '-' | '_');
    value.split(|c: char| !is_part(c)).filter_map(|word| word.parse().ok()).collect()
}

type NumberFormat<'a> = &'a dyn Fn(f64) -> String;

/// The numbers of a run by their names. Those whose name has no point stand in the table for people, too. Stresses and energies
/// that are rounding are 0.
fn cells(r: &Results, shown: NumberFormat) -> Vec<(String, String)> {
    let q = &r.quantities;
    // The recovered pressure, as in the summary.
    let peak = r.contact.iter().map(|part| part.peak_pressure).reduce(f64::max);
    let von_mises = r.stress.as_ref().map(|stress| stress.von_mises.value);
    let is_rounding = von_mises.is_some_and(|stress| summary::is_no_stress(r, stress));
    let brief = [
        ("verdict", Some(r.outcome().unwrap_or_default())),
        ("gamma0", Some(shown(r.gamma.gamma0))),
        ("kappa", Some(shown(r.gamma.kappa))),
        ("newton_steps", Some(r.newton.iterations.to_string())),
        ("contact_force", Some(shown(q.contact_force))),
        ("contact_length", Some(shown(q.contact_length))),
        ("peak_pressure", peak.map(shown)),
        ("max_von_mises", von_mises.map(|stress| shown(if is_rounding { 0.0 } else { stress }))),
        ("max_displacement", Some(shown(q.max_displacement))),
        ("elastic_energy", Some(shown(if is_rounding { 0.0 } else { q.energy / 2.0 }))),
        ("energy_error", r.errors.as_ref().map(|errors| shown(errors.energy))),
        ("remarks", Some(summary::remarks(r).len().to_string())),
    ];
    let brief = brief.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let mut cells: Vec<(String, String)> = brief.collect();
    let mut add = |of: &str, what: &str, x: f64| cells.push((format!("{of}.{what}"), shown(x)));
    for part in &r.contact {
        let name = part.label();
        add(&name, "force", part.force);
        add(&name, "length", part.length);
        add(&name, "peak_pressure", part.peak_pressure);
        if let Some(friction) = &part.friction {
            let [x, y] = part.resultant;
            add(&name, "force_x", x);
            add(&name, "force_y", y);
            add(&name, "slip", friction.slip);
            add(&name, "dissipated", friction.dissipated);
        }
    }
    let proved = r.certificate.as_ref().and_then(|c| c.discrete.as_ref()?.intervals.as_ref());
    for part in proved.iter().flat_map(|intervals| &intervals.contact) {
        let (name, [low, high]) = (label(&part.boundary, part.partner.as_deref()), part.force);
        add(&name, "force_low", low);
        add(&name, "force_high", high);
    }
    let certified = r.certificate.as_ref().and_then(|c| c.continuous.as_ref());
    for part in &r.contact {
        let proved = certified.and_then(|c| c.contact_force(&part.boundary));
        let Some([low, high]) = proved else { continue };
        add(&part.boundary, "true_force_low", low);
        add(&part.boundary, "true_force_high", high);
    }
    for (boundary, [x, y]) in &q.reactions {
        add(boundary, "reaction_x", *x);
        add(boundary, "reaction_y", *y);
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
            Ok(results) => (cells(results, shown), results.newton.report.status.name().to_owned()),
            Err(error) => (Vec::new(), error.to_string()),
        };
        let mut runs: Vec<(Vec<(String, String)>, String)> =
            self.results.iter().map(of_run).collect();
        runs.resize_with(self.values.len(), || (Vec::new(), NOT_SOLVED.to_owned()));
        // gamma0 as a swept key has a column already.
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
    fn table(&self) -> String {
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

    /// The remarks on the runs, a line each: those that several runs share once, with the numbers of these; empty if there are none.
    fn remarks(&self) -> String {
        let of_run = |(i, results): (i32, &Result<Results, Failure>)| {
            let remarks: Vec<String> = results.iter().flat_map(summary::remarks).collect();
            remarks.into_iter().map(move |text| (text, i.to_string()))
        };
        let remarks = grouped((1..).zip(&self.results).flat_map(of_run));
        let line = |(text, runs): &(String, Vec<String>)| {
            let of = quote::names(runs.iter().map(String::as_str));
            format!("remark on row {of}: {}\n", quote::unbroken(text))
        };
        let rest = remarks.len().saturating_sub(MOST_REMARKS);
        let more =
            format!("and {rest} more remarks: solve the row alone, or --files, shows them\n");
        let shown: String = remarks.iter().take(MOST_REMARKS).map(line).collect();
        if rest > 0 { shown + &more } else { shown }
    }

    /// The table, the remarks and the names of the `files` that were written, as the command prints them.
    pub(crate) fn summary(&self, files: &[PathBuf]) -> String {
        let (title, remarks) = (quote::line(&self.title), self.remarks());
        let remarks = if remarks.is_empty() { remarks } else { format!("\n{remarks}") };
        let written = summary::written(files);
        format!("{title}\n\n{}{remarks}\nwritten: {written}\n", self.table())
    }

    /// The text of the table: each number the shortest decimal that reads back to the same double.
    fn csv(&self) -> String {
        self.lines(false, &csv::number).into_iter().map(csv::line).collect()
    }

    /// The text of the collection: the solutions of the runs as the steps of one animation, for ParaView.
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

    /// The key along the curves of sweep.svg, and the number in its value of each run: the first number that differs from run to
    /// run, of the key of which it takes the most values.
    fn abscissa(&self) -> Option<(usize, Vec<f64>)> {
        let varying = |key: usize| {
            let of_runs: Vec<Vec<f64>> = self.values.iter().map(|run| numbers(&run[key])).collect();
            let entries = of_runs.iter().map(Vec::len).min()?;
            let entry =
                (0..entries).find(|&e| of_runs.iter().any(|run| run[e] != of_runs[0][e]))?;
            Some((key, of_runs.iter().map(|run| run[entry]).collect::<Vec<f64>>()))
        };
        let distinct = |(_, numbers): &(usize, Vec<f64>)| {
            let mut sorted = numbers.clone();
            sorted.sort_by(f64::total_cmp);
            sorted.dedup();
            sorted.len()
        };
        (0..self.keys.len()).filter_map(varying).max_by_key(distinct)
    }

    /// Force and peak over what varies, a curve for each combination of the other keys; `None` where no number varies.
    fn curves(&self) -> Option<Figure> {
        let (key, numbers) = self.abscissa()?;
        let others = |run: &Vec<String>| {
            let other = |(k, value): (&String, &String)| {
                (*k != self.keys[key]).then(|| format!("{k} = {value}"))
            };
            self.keys.iter().zip(run).filter_map(other).collect::<Vec<String>>().join(", ")
        };
        let names = self.values.iter().map(others).take(self.results.len());
        let curves = grouped(names.zip(0..));
        let panel = |name: &str| Panel {
            title: name.replace('_', " "),
            lines: curves
                .iter()
                .map(|(_, runs)| {
                    let point = |&i: &usize| {
                        let results = self.results[i].as_ref().ok()?;
                        let cells = cells(results, &csv::number);
                        let (_, value) = cells.into_iter().find(|(cell, _)| cell == name)?;
                        Some([numbers[i], value.parse().ok()?])
                    };
                    let mut points: Vec<[f64; 2]> = runs.iter().filter_map(point).collect();
                    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
                    points
                })
                .collect(),
            slopes: Vec::new(),
        };
        let panels = vec![panel("contact_force"), panel("peak_pressure")];
        let is_drawn = panels.iter().flat_map(|panel| &panel.lines).any(|line| line.len() > 1);
        let style = |(i, (name, _)): (usize, &(String, Vec<usize>))| Style {
            name: if name.is_empty() { "solved".to_owned() } else { quote::line(name) },
            colour: COLOURS[i % COLOURS.len()],
            dashed: i / COLOURS.len() % 2 == 1,
        };
        is_drawn.then(|| Figure {
            title: self.title.clone(),
            x_label: self.keys[key].clone(),
            logarithmic: false,
            panels,
            styles: curves.iter().enumerate().map(style).collect(),
        })
    }

    /// Writes the table into `folder`, the curves where a number varies, and the collection where the runs have files; returns their
    /// paths.
    pub(crate) fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
        let &[table, curves, collection] = self.names;
        let mut output = Output::new(folder)?;
        if let Some(drawn) = self.curves() {
            output.stage_made(curves, figure(&drawn))?;
        }
        if self.with_files {
            output.stage(collection, self.pvd())?;
        }
        output.stage(table, self.csv())?;
        output.publish(&self.names[1..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::result::tests::everything;
    use crate::results::ContactBoundary;

    #[test]
    fn each_cell_has_the_number_of_its_column() {
        let mut results = everything();
        let second = ContactBoundary {
            boundary: "wall".to_owned(),
            peak_pressure: 1.5,
            ..results.contact[0].clone()
        };
        results.contact.push(second);
        let found: Vec<String> = cells(&results, &csv::number)
            .into_iter()
            .map(|(name, value)| format!("{name} {value}"))
            .collect();
        assert_eq!(found, CELLS);
    }

    const CELLS: [&str; 34] = [
        "verdict proved",
        "gamma0 0.0111",
        "kappa 0.127",
        "newton_steps 11",
        "contact_force 179.0",
        "contact_length 19.3",
        "peak_pressure 26.9",
        "max_von_mises 359.0",
        "max_displacement 0.173",
        "elastic_energy 8.15",
        "energy_error 7.19",
        "remarks 1",
        "floor.force 22.3",
        "floor.length 2.39",
        "floor.peak_pressure 26.9",
        "floor.force_x 22.7",
        "floor.force_y 22.9",
        "floor.slip 0.0331",
        "floor.dissipated 34.9",
        "wall.force 22.3",
        "wall.length 2.39",
        "wall.peak_pressure 1.5",
        "wall.force_x 22.7",
        "wall.force_y 22.9",
        "wall.slip 0.0331",
        "wall.dissipated 34.9",
        "floor.force_low 22.2",
        "floor.force_high 22.4",
        "floor.true_force_low 21.01",
        "floor.true_force_high 23.99",
        "top.reaction_x 19.9",
        "top.reaction_y -211.0",
        "probe_1.u_x 0.0491",
        "probe_1.u_y 0.0499",
    ];

    #[test]
    fn curves_are_drawn_over_the_key_that_takes_most_values() {
        let values = |rows: &[[&str; 2]]| -> Vec<Vec<String>> {
            rows.iter().map(|row| row.map(str::to_owned).to_vec()).collect()
        };
        let sweep = |rows: &[[&str; 2]]| Sweep {
            title: String::new(),
            keys: vec!["load".to_owned(), "gap".to_owned()],
            values: values(rows),
            results: Vec::new(),
            with_files: false,
            names: FILES,
        };
        let rows = [["[0, -1]", "1"], ["[0, -1]", "2"], ["[0, -1]", "3"], ["[0, -2]", "1"]];
        assert_eq!(sweep(&rows).abscissa(), Some((1, vec![1.0, 2.0, 3.0, 1.0])));
        let rows = [["[0, -1]", "1"], ["[0, -2]", "1"], ["[0, -4]", "2"]];
        assert_eq!(sweep(&rows).abscissa(), Some((0, vec![-1.0, -2.0, -4.0])));
        assert_eq!(sweep(&[["a", "1"], ["b", "1"]]).abscissa(), None);
    }

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
            ("a=max(x,y),1", "a", &["max(x,y)", "1"]),
            ("a=1000:3000:5", "a", &["1000", "1500", "2000", "2500", "3000"]),
            ("a=1,0.1:0.3:3", "a", &["1", "0.1", "0.2", "0.3"]),
            ("a=[0,-0.01:-0.03:3]", "a", &["[0,-0.01]", "[0,-0.02]", "[0,-0.03]"]),
            // No ranges.
            ("a=\"1:2:3\"", "a", &["\"1:2:3\""]),
            ("a=1:2", "a", &["1:2"]),
            ("a=1:2:1", "a", &["1:2:1"]),
        ] {
            let ParameterAxis { key: found, values: list } = axis(text);
            assert_eq!((&*found, list), (key, values.iter().map(|v| (*v).to_owned()).collect()));
        }
        for text in ["method.gamma0", "=1", "a=", "a=x,,y"] {
            assert!(text.parse::<ParameterAxis>().is_err(), "{text}");
        }
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
