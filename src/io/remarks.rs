//! Remarks beside the numbers of a result: on data that are probably mistaken, on what the mesh does not resolve, on motions
//! that are too large for the theory, and on boundaries that touch nothing. Each says where, gives both numbers, and what to
//! change.

mod model;
mod motion;
mod resolution;

use super::numbers::short;
use super::summary::vector as place;
use crate::contact::contact_line::{ContactLine, Gamma};
use crate::contact::piece::{Piece, PieceGeometry, Stretch};
use crate::model::space::Space;
use crate::model::tree::Bounds;
use crate::model::{Degree, Problem};
use crate::quote;
use crate::results::solution::ContactEdge;
use crate::results::{ContactBoundary, Solution};

/// The largest strain that small-strain theory is for.
const LARGE_STRAIN: f64 = 0.05;

/// The largest displacement, beside the body's size, that small-strain theory is for.
const LARGE_DISPLACEMENT: f64 = 0.1;

/// The length, beside the body's size, that is rounding: mesh files have nine digits or more.
const NO_LENGTH: f64 = 1e-9;

/// The factor below the median of its line at which a triangle's limit of gamma0 spoils the line.
const SLIVER: f64 = 8.0;

/// The ratio of shear moduli from which one gamma0 for two bodies is far from what each of them allows.
const UNLIKE: f64 = 10.0;

/// Units for labels, and facts beside the solution.
#[derive(Clone, Debug, Default)]
pub(super) struct Words {
    /// The units of lengths and of stresses, if the case has any.
    pub(super) units: Option<[String; 2]>,
    /// The contact boundary whose force is proved to be as near to the true one as was asked for.
    pub(super) known_force: Option<String>,
    /// The case is one of several load steps.
    pub(super) is_step: bool,
}

impl Solution {
    /// Remarks that a reader should know before the numbers are used: what the mesh does not resolve, motions that are too large
    /// for the theory, data that are probably mistaken.
    pub fn remarks(&self, problem: &Problem) -> Vec<String> {
        remarks(problem, self, &Words::default())
    }
}

/// As [`Solution::remarks`], with units.
pub(super) fn remarks(problem: &Problem, solution: &Solution, words: &Words) -> Vec<String> {
    let line: Vec<&PieceGeometry> = solution.pieces.iter().map(|piece| &*piece.geometry).collect();
    let mut remarks = Vec::new();
    remarks.extend(model::separate_bodies(problem, Some(solution)));
    remarks.extend(resolution::short_stretches(problem, solution, words));
    remarks.extend(resolution::gaps(problem, solution.degree, Some(solution), &line, words));
    remarks.extend(motion::off_the_obstacle(problem, solution, words));
    remarks.extend(motion::beside_the_line(problem, solution, words));
    remarks.extend(model::locking(problem, solution.degree));
    remarks.extend(model::unbounded_peaks(problem, solution, words));
    remarks.extend(sliver(solution));
    remarks.extend(unlike_bodies(problem, solution));
    let strain = solution.largest_strain;
    if strain > LARGE_STRAIN {
        remarks.push(format!(
            "the largest strain is {} %, at {}: strains are taken to be small (below {} %); check load, modulus and units",
            short(100.0 * strain, 3),
            place(solution.largest_strain_at),
            short(100.0 * LARGE_STRAIN, 3)
        ));
    }
    remarks.extend(model::overlap(problem, &line, words));
    remarks.extend(model::interference(problem, solution, words));
    remarks.extend(friction(solution, words));
    let (largest, size) = (solution.quantities.max_displacement, size(problem));
    if largest > LARGE_DISPLACEMENT * size {
        remarks.push(format!(
            "the largest displacement is {}, the body is {} long: displacements are taken to be small; check load, modulus and units",
            words.length(largest),
            words.length(size)
        ));
    }
    let boundaries = &solution.boundaries;
    let is_open = |part: &&ContactBoundary| !solution.quantities.presses(part, boundaries);
    let open = boundaries.iter().filter(is_open);
    remarks.extend(open.filter_map(|part| nearest(problem, solution, words, &part.boundary)));
    remarks
}

/// The remarks that need no solution.
pub(super) fn before(problem: &Problem, degree: Degree, words: &Words) -> Vec<String> {
    let line = ContactLine::new(problem, &Space::new(&problem.mesh, degree)).ok();
    let line: Vec<&PieceGeometry> = line.iter().flat_map(ContactLine::pieces).collect();
    let mut remarks: Vec<String> = model::separate_bodies(problem, None).into_iter().collect();
    remarks.extend(resolution::gaps(problem, degree, None, &line, words));
    remarks.extend(model::locking(problem, degree));
    remarks.extend(model::overlap(problem, &line, words));
    remarks
}

/// A share of what friction bears at most that acts across open gaps, above which that is said.
const ACROSS_GAPS: f64 = 0.01;

/// Remarks on friction that may surprise a reader.
fn friction(solution: &Solution, words: &Words) -> Vec<String> {
    let mut remarks = Vec::new();
    for boundary in &solution.boundaries {
        let Some(friction) = &boundary.friction else { continue };
        if friction.across_gaps > ACROSS_GAPS {
            remarks.push(format!(
                "{} % of the friction that {} can bear acts across an open gap: Tresca's slip bound does not depend on the pressure; give a bound that is 0 there, or a coefficient (friction = {{ coulomb = 0.3 }})",
                short(100.0 * friction.across_gaps, 2),
                quote::quoted(&boundary.boundary, '\'')
            ));
        }
    }
    let slides = |b: &ContactBoundary| b.friction.is_some_and(|friction| friction.slides > 0.0);
    if !words.is_step && solution.boundaries.iter().any(slides) {
        remarks.push(
            "one step: friction is as if the loads grew in proportion, with slip in one direction; loads one after the other are [[step]] tables"
                .to_owned(),
        );
    }
    remarks
}

/// Says which triangle sets gamma0 for a whole line that would allow more, if one does.
fn sliver(solution: &Solution) -> Option<String> {
    let coercivity = solution.gamma.coercivity;
    let uniform = matches!(solution.gamma.gamma, Gamma::Uniform(_));
    let spoils = uniform && coercivity.constant > SLIVER * coercivity.typical;
    let [[a, b], [c, d]] = coercivity.limiting_edge;
    spoils.then(|| {
        format!(
            "the triangle at the contact edge from ({}, {}) to ({}, {}) sets gamma0 for the whole line, {:.0} times below what half of its triangles allow; method.kappa = 0.5 lets each edge have its own",
            short(a, 3), short(b, 3), short(c, 3), short(d, 3), coercivity.constant / coercivity.typical
        )
    })
}

/// Says that one gamma0 is too stiff for the softer of two bodies that touch each other, if their moduli differ by more than
/// [`UNLIKE`].
fn unlike_bodies(problem: &Problem, solution: &Solution) -> Option<String> {
    let modulus = |stretch: &Stretch| problem.material.of(stretch.edge.triangle).mu();
    let unlike = |piece: &Piece| match &piece.geometry.stretches[..] {
        [first, second] => {
            let [a, b] = [modulus(first), modulus(second)];
            a > UNLIKE * b || b > UNLIKE * a
        }
        _ => false,
    };
    let uniform = matches!(solution.gamma.gamma, Gamma::Uniform(_));
    (uniform && solution.pieces.iter().any(unlike)).then(|| {
        "gamma0 is one number for a stiff and a soft body, whose springs of contact become too stiff for the soft one; method.kappa = 0.5 gives each its own"
            .to_owned()
    })
}

/// Says where a contact boundary that touches nothing is nearest to its obstacle.
fn nearest(
    problem: &Problem,
    solution: &Solution,
    words: &Words,
    boundary: &str,
) -> Option<String> {
    let to_obstacle = |edge: &&ContactEdge| edge.partner.is_none() && &*edge.boundary == boundary;
    let edges = solution.contact.iter().filter(to_obstacle);
    let points = edges.flat_map(|edge| &edge.points).map(|p| (p.gap - p.u_n, p.place));
    let (gap, at) = points.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "{} touches nothing: it is nearest to {} at {}, where a gap of {} is left",
        quote::quoted(boundary, '\''),
        named_obstacle(problem, boundary).unwrap_or_else(|| "its obstacle".to_owned()),
        place(at),
        words.length(gap.max(0.0))
    ))
}

/// The longer side of the box around the body.
fn size(problem: &Problem) -> f64 {
    Bounds::around(problem.mesh.vertices().iter().copied()).size()
}

/// The name of the obstacle of a contact boundary, if it has one.
fn named_obstacle(problem: &Problem, boundary: &str) -> Option<String> {
    problem.obstacle_of(boundary).map(|name| quote::quoted(name, '\''))
}

/// The name of the obstacle of a contact boundary, or words for it.
fn obstacle_of(problem: &Problem, boundary: &str) -> String {
    let unnamed = || format!("the obstacle of {}", quote::quoted(boundary, '\''));
    named_obstacle(problem, boundary).unwrap_or_else(unnamed)
}

impl Words {
    fn length(&self, x: f64) -> String {
        self.with_unit(x, 0)
    }

    fn stress(&self, x: f64) -> String {
        self.with_unit(x, 1)
    }

    fn with_unit(&self, x: f64, unit: usize) -> String {
        let unit = self.units.as_ref().map_or("", |units| &units[unit]);
        format!("{} {unit}", short(x, 3)).trim_end().to_owned()
    }
}
