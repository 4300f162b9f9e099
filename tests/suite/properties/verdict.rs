//! The verdict on what a solve ends with.

use signorini::results::{Status, Verdict};
use signorini::solve::accuracy::Outcome as Solved;
use signorini::solve::{Method, Settings, SolveError, solve};

use super::bodies::loaded_bodies;
use super::{Outcome, properties, text};

/// The verdict: what is proved is a result, whatever else is said of it; without a proof a residual within the tolerance makes
/// one that is not proved, and anything else none. `proof` is the relative radius that is asked for.
fn verdict_is_honest(proof: f64) -> Outcome {
    let sizes = [0.0, 1e-14, 1e-10, 1.1e-10, 1e-6, 1.1e-6, 1.0, f64::INFINITY, f64::NAN];
    let problem = loaded_bodies()?.swap_remove(0).1;
    let (solution, _) = solve(&problem, &Method::default(), &Settings::default()).map_err(text)?;
    let enclosure = solution.enclosure.map_err(text)?;
    let settings = Settings { max_iterations: 50, ..Settings::default() };
    for residual in sizes {
        for relative in sizes {
            for steps in [1, 50] {
                let mut enclosure = enclosure.clone();
                (enclosure.radius, enclosure.relative) = (1.0, Some(relative));
                let solved = Solved {
                    u: Vec::new(),
                    forces: Vec::new(),
                    p: Vec::new(),
                    residuals: vec![1.0; steps + 1],
                    residual,
                    enclosure: Ok(enclosure),
                    forward_error: 0.0,
                    condition: 1.0,
                    factorizations: 0,
                };
                let expected = match (residual <= 1e-10, relative <= proof) {
                    (true, true) => "converged, proved",
                    (true, false) => "converged, not proved",
                    (false, true) => "converged to rounding, proved",
                    (false, false) if steps == 50 => "not converged",
                    (false, false) => "ill conditioned",
                };
                let verdict = Verdict::new(&solved.enclosure, settings.proof);
                let found = match solved.status(&settings) {
                    Ok(Status::Converged) => format!("converged, {}", verdict.name()),
                    Ok(Status::ConvergedToRounding) => {
                        format!("converged to rounding, {}", verdict.name())
                    }
                    Err(SolveError::NotConverged { .. }) => "not converged".to_owned(),
                    Err(SolveError::IllConditioned { .. }) => "ill conditioned".to_owned(),
                    Err(_) => "another error".to_owned(),
                };
                if found != expected {
                    return Err(format!(
                        "residual {residual:e}, relative radius {relative:e}, {steps} steps: {found}, expected {expected}"
                    ));
                }
            }
        }
    }
    Ok(())
}

properties! {
    the_verdict_is_the_proof: verdict_is_honest(Settings::default().proof); not verdict_is_honest(f64::INFINITY);
}
