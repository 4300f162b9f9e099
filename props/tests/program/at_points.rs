//! At a point of a triangle the error of a displacement is that of the nodes.

use signorini::kernel::{Material, Plane};
use signorini::model::{Degree, Problem};
use signorini::results::Solution;
use signorini::solve::{Method, discretize_any};
use study::unsolved;

use props::claim::{Outcome, text};
use props::proof::sampler::Random;
use props::{draws, sharpness};

/// A random displacement of a block of unequal triangles as a solution.
fn anything(degree: Degree, problem: &Problem) -> Result<Solution, String> {
    let d = discretize_any(problem, &Method { degree, ..Method::default() }).map_err(text)?;
    let drawn = super::random_field(&mut Random::new(draws::seed()), d.space.nodes().len());
    Ok(unsolved(&d, drawn))
}

fn unequal() -> Result<Problem, String> {
    let material = Material::lame(1.5, 1.0, Plane::Strain);
    Ok(sharpness::clamped(sharpness::moved([3, 2], 5)?, material, &["top"]))
}

/// At points of triangles a displacement that is moved at the nodes by no more than is said there moves by no more than
/// `displacement_error_at` says, times `share`; and by that much where each node moves as the sign of its shape function has it.
pub fn errors_at_points(share: f64) -> Outcome {
    let problem = unequal()?;
    let mut count = 0;
    for degree in [Degree::One, Degree::Two] {
        let solution = anything(degree, &problem)?;
        // The nodes by their places.
        let most = |[x, y]: [f64; 2]| 1e-3 * (1.0 + x * x + y);
        let nodes: Vec<f64> = solution.nodes.iter().map(|&x| most(x)).collect();
        for l in [[0.2, 0.3, 0.5], [0.7, 0.1, 0.2], [0.05, 0.9, 0.05]] {
            for t in 0..problem.mesh.triangles().len() {
                let told = share * solution.displacement_error_at(&nodes, t, l);
                let mut moved = solution.clone();
                let own = &solution.elements[t * solution.nodes_per_triangle..];
                for &node in &own[..solution.nodes_per_triangle] {
                    let mut bump = solution.clone();
                    bump.displacement.iter_mut().for_each(|u| *u = [0.0; 2]);
                    bump.displacement[node][0] = 1.0;
                    let shape = bump.displacement_at(t, l)[0];
                    moved.displacement[node][0] += nodes[node] * shape.signum();
                }
                let by = moved.displacement_at(t, l)[0] - solution.displacement_at(t, l)[0];
                if !(by <= told && told <= by + 1e-12) {
                    return Err(format!(
                        "{degree:?}, triangle {t}: moved by {by:e}, told {told:e}"
                    ));
                }
                count += 1;
            }
        }
    }
    Ok(format!("{count} points, P1 and P2"))
}
