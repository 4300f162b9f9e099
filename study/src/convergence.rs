//! A case with an exact solution on finer and finer meshes, as a table for people, as
//! CSV and as a figure.

use std::path::{Path, PathBuf};

use signorini::exact::Errors;
use signorini::io::picture::plot::{COLOURS, Figure, Panel, Style, figure};
use signorini::io::{Case, Failure, Output};
use signorini::model::{Degree, Perturbation};
use signorini::solve::Method;

use crate::ladder::{fitted_slope, rates};
use crate::{Ladder, LadderError, Level, a_priori};

/// The distance by which vertices are moved where the case doesn't say.
const PERTURBATION: Perturbation = Perturbation { amount: 0.2, seed: 1 };

/// The results on the meshes of one ladder.
#[derive(Clone, Debug)]
pub struct Study {
    /// The degree of the elements.
    pub degree: Degree,
    /// The vertices of the meshes are moved, as the case says or by up to 0.2 cells.
    pub perturbed: bool,
    /// The rate that the theory promises for all norms but L2.
    pub promised: f64,
    /// The results on each mesh, from the coarsest on.
    pub levels: Vec<Level>,
}

/// The ladder of a case, with its own degree and mesh, perturbed or not, unless told otherwise.
pub fn ladder(
    case: &Case,
    degree: Option<Degree>,
    perturbed: Option<bool>,
) -> Result<Ladder, Failure> {
    const NO_SOLUTION: &str = "[exact] is missing; errors are measured against an exact solution";
    const MESH_FILE: &str =
        "[mesh] gmsh: found a mesh file; expected rectangle or trapezoid, which can be refined";
    let exact = case.exact.as_ref().ok_or_else(|| Failure::wrong(NO_SOLUTION))?;
    let body = exact.structured.ok_or_else(|| Failure::wrong(MESH_FILE))?;
    let perturbed = perturbed.unwrap_or(exact.perturbation.is_some());
    Ok(Ladder {
        solution: exact.solution.clone(),
        kinds: exact.kinds.clone(),
        body,
        perturbation: perturbed.then(|| exact.perturbation.unwrap_or(PERTURBATION)),
        method: Method { degree: degree.unwrap_or(case.method.degree), ..case.method.clone() },
        settings: case.settings,
    })
}

/// Solves the first `levels` levels of a ladder at one gamma0.
pub fn climb(ladder: Ladder, levels: usize) -> Result<Study, Failure> {
    let (degree, perturbed) = (ladder.method.degree, ladder.perturbation.is_some());
    let failed = |level: usize| {
        move |error: LadderError| {
            let failure = match error {
                LadderError::Mesh(error) => Failure::from(error),
                LadderError::Solve(error) => Failure::from(error),
            };
            failure.map(|problem| format!("P{}, level {level}: {problem}", degree.number()))
        }
    };
    let ladder = ladder.with_one_gamma0(levels).map_err(failed(0))?;
    let mut climbed = Vec::with_capacity(levels);
    for level in 0..levels {
        climbed.push(ladder.solve(level).map_err(failed(level))?.0);
    }
    Ok(Study { degree, perturbed, promised: ladder.promised_rate(), levels: climbed })
}

/// A norm: its name, its value, and whether the theory promises a rate.
pub type Norm = (&'static str, fn(&Errors) -> f64, bool);

/// The norms in the order of the table.
pub const NORMS: [Norm; 5] = [
    ("energy", |e| e.energy, true),
    ("h1", |e| e.h1, true),
    ("l2", |e| e.l2, false),
    ("contact_residual", |e| e.contact_residual, true),
    ("normal_stress", |e| e.normal_stress, true),
];

/// The legend of the column "proved".
const PROVED: &str = "proved: (energy^2 + contact_residual^2 / (1 - kappa))^(1/2) is at most this (Theorem 3.5 with its \
                      constant), and how many times that is\n";

/// The number of finest levels to which the slope is fitted.
const FITTED: usize = 4;

impl Study {
    /// The name, such as "P2, structured".
    pub fn name(&self) -> String {
        format!("P{}, {}", self.degree.number(), self.meshes())
    }

    fn meshes(&self) -> &'static str {
        if self.perturbed { "perturbed" } else { "structured" }
    }

    /// The largest h_T of each level.
    pub fn sizes(&self) -> Vec<f64> {
        self.levels.iter().map(|level| level.h).collect()
    }

    /// One error on all levels.
    pub fn error(&self, of: fn(&Errors) -> f64) -> Vec<f64> {
        self.levels.iter().map(|level| of(&level.errors)).collect()
    }

    /// The slope over the last 4 levels; `None` if there is only one, or an error of 0.
    pub fn slope(&self, of: fn(&Errors) -> f64) -> Option<f64> {
        let first = self.levels.len().saturating_sub(FITTED);
        let slope = fitted_slope(&self.sizes()[first..], &self.error(of)[first..]);
        slope.is_finite().then_some(slope)
    }

    /// The table for people.
    pub fn table(&self) -> String {
        let gamma0 = self.levels.first().map_or(f64::NAN, |level| level.gamma0);
        let row = |first: String, cell: &dyn Fn(usize) -> String, rest: String| {
            let cells: String = (0..NORMS.len()).map(|k| format!("{:>18}", cell(k))).collect();
            format!("{first:>20}{cells}{rest}\n")
        };
        let bounded = self.levels.iter().any(|level| level.proved.is_some());
        let proved = if bounded { "            proved" } else { "" };
        let mut text = format!("{}: gamma0 = {gamma0:.4e}\n", self.name());
        let heading = format!("{:>10}{:>10}", "h", "unknowns");
        text += &row(
            heading,
            &|k| NORMS[k].0.to_owned(),
            format!("{:>8}{:>7}{proved}", "newton", "kappa"),
        );
        let rates = NORMS.map(|(_, of, _)| rates(&self.sizes(), &self.error(of)));
        for (i, level) in self.levels.iter().enumerate() {
            let mut rest = format!("{:>8}{:>7.3}", level.newton_steps, level.kappa);
            if let Some(bound) = level.proved {
                let error = a_priori::left(level.kappa, &level.errors);
                rest += &format!("{bound:>12.3e}{:>6}", shown(Some(bound / error)));
            }
            let cell = |k: usize| {
                let rate = i.checked_sub(1).and_then(|before| rates[k].get(before));
                format!("{:.3e}{:>6}", NORMS[k].1(&level.errors), shown(rate.copied()))
            };
            text += &row(format!("{:>10.3e}{:>10}", level.h, level.unknowns), &cell, rest);
        }
        let fitted = format!("slope, last {}", self.levels.len().min(FITTED));
        text += &row(fitted, &|k| shown(self.slope(NORMS[k].1)), String::new());
        let promised = |k: usize| shown(NORMS[k].2.then_some(self.promised));
        text += &row("promised".to_owned(), &promised, String::new());
        text + if bounded { PROVED } else { "" }
    }
}

fn shown(rate: Option<f64>) -> String {
    match rate {
        Some(rate) if rate.is_finite() => format!("{rate:.2}"),
        _ => "-".to_owned(),
    }
}

/// The shortest decimal that reads back to the same double.
fn number(x: f64) -> String {
    format!("{x:?}")
}

/// What [`write()`] writes.
pub const FILES: [&str; 2] = ["convergence.csv", "convergence.svg"];

/// The table of all levels as CSV.
pub fn csv(studies: &[Study]) -> String {
    let names = NORMS.map(|(name, _, _)| name).join(",");
    let mut text = format!("degree,mesh,h,unknowns,{names},newton_steps,gamma0,kappa,proved\n");
    for study in studies {
        for level in &study.levels {
            let mut cells = vec![study.degree.number().to_string(), study.meshes().to_owned()];
            cells.extend([number(level.h), level.unknowns.to_string()]);
            cells.extend(NORMS.map(|(_, of, _)| number(of(&level.errors))));
            cells.push(level.newton_steps.to_string());
            cells.extend([level.gamma0, level.kappa].map(number));
            cells.push(level.proved.map_or_else(String::new, number));
            text += &(cells.join(",") + "\n");
        }
    }
    text
}

/// The figure: energy norm, contact pressure and normal stress over h, with triangles for the promised rates.
pub fn plot(title: &str, studies: &[Study]) -> Figure {
    let panels = [
        ("energy norm of u − uʰ", NORMS[0].1),
        ("contact pressure: ‖√γ (σₙ(u) − λʰ)‖", NORMS[3].1),
        ("normal stress: ‖√γ σₙ(u − uʰ)‖", NORMS[4].1),
    ];
    Figure {
        title: title.to_owned(),
        x_label: "h".to_owned(),
        logarithmic: true,
        panels: panels.map(|(name, of)| panel(name, of, studies)).into(),
        styles: studies
            .iter()
            .map(|study| Style {
                name: study.name(),
                colour: COLOURS[usize::from(study.degree != Degree::One)],
                dashed: study.perturbed,
            })
            .collect(),
    }
}

fn panel(title: &str, of: fn(&Errors) -> f64, studies: &[Study]) -> Panel {
    let lines: Vec<Vec<[f64; 2]>> = studies
        .iter()
        .map(|study| study.sizes().into_iter().zip(study.error(of)).map(|(h, e)| [h, e]).collect())
        .collect();
    // One triangle for each promised rate, below the lowest of its lines.
    let constant = |line: usize| {
        let finest = studies[line].levels.last();
        finest.map_or(f64::INFINITY, |l| of(&l.errors) / l.h.powf(studies[line].promised))
    };
    let mut slopes: Vec<(usize, f64)> = Vec::new();
    for (line, study) in studies.iter().enumerate().filter(|(_, s)| s.promised.is_finite()) {
        match slopes.iter_mut().find(|(_, slope)| *slope == study.promised) {
            Some(known) if constant(line) < constant(known.0) => known.0 = line,
            Some(_) => {}
            None => slopes.push((line, study.promised)),
        }
    }
    Panel { title: title.to_owned(), lines, slopes }
}

/// Writes convergence.csv and convergence.svg into `folder` and returns their paths.
pub fn write(folder: &Path, title: &str, studies: &[Study]) -> Result<Vec<PathBuf>, Failure> {
    let mut output = Output::new(folder)?;
    output.stage(FILES[0], csv(studies))?;
    output.stage_made(FILES[1], figure(&plot(title, studies)))?;
    output.publish(&[])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(levels: usize) -> Study {
        let level = |i: usize| {
            let h = 0.5_f64.powi(i as i32);
            let errors = Errors {
                energy: h,
                h1: h,
                l2: h * h,
                contact_residual: h.powf(1.5),
                ..Errors::default()
            };
            let (unknowns, proved) = (8 << (2 * i), Some(5.0 * h));
            Level { h, unknowns, errors, newton_steps: 3, gamma0: 0.1, kappa: 0.5, proved }
        };
        Study {
            degree: Degree::One,
            perturbed: false,
            promised: 1.0,
            levels: (0..levels).map(level).collect(),
        }
    }

    #[test]
    fn the_table_has_rates_slopes_and_promises_and_a_dash_where_there_is_none() {
        let text = study(3).table();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 8);
        assert!(lines[1].ends_with("proved") && lines[7].starts_with("proved: "));
        // 5 over (1 + 1 / (1 - 1/2))^(1/2).
        assert!(lines[2].ends_with("5.000e0  2.89"), "{}", lines[2]);
        assert_eq!(lines[0], "P1, structured: gamma0 = 1.0000e-1");
        assert!(lines[4].contains("2.500e-1  1.00") && lines[4].contains("1.250e-1  1.50"));
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(lines[5]), ["slope,", "last", "3", "1.00", "1.00", "2.00", "1.50", "-"]);
        assert_eq!(words(lines[6]), ["promised", "1.00", "1.00", "-", "1.00", "1.00"]);
        assert!(study(1).table().contains("slope, last 1"));
    }

    #[test]
    fn the_csv_has_a_line_for_each_level() {
        let text = csv(&[study(2)]);
        assert_eq!(
            text,
            "degree,mesh,h,unknowns,energy,h1,l2,contact_residual,normal_stress,newton_steps,gamma0,kappa,proved\n\
             1,structured,1.0,8,1.0,1.0,1.0,1.0,0.0,3,0.1,0.5,5.0\n\
             1,structured,0.5,32,0.5,0.5,0.25,0.3535533905932738,0.0,3,0.1,0.5,2.5\n"
        );
    }
}
