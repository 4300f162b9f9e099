//! The summaries that the command prints.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::case::{MaterialEcho, Measure, Units};
use super::certificate::Audit;
use super::result::{
    Adaptation, ContinuousCertificate, DiscreteCertificate, GammaChoice, IsolatedSolution,
    MeshSizes, NewtonHistory, Results, Seconds, StressPeak,
};
use super::{Case, numbers};
use crate::certificates::Continuous;
use crate::certificates::adapt::AdaptedLevel;
use crate::held::solvability::Play;
use crate::proof::enclosure::LEAST_NORM;
use crate::quote;
use crate::results::answers::BoundaryFriction;
use crate::results::{ContactBoundary, MethodReport, RouteName, Status};

/// Lines of a name and a text; a line without a name continues the line before.
#[derive(Default)]
pub(super) struct Lines(Vec<(String, String)>);

impl Lines {
    pub(super) fn line(&mut self, name: &str, text: impl Into<String>) {
        self.0.push((name.to_owned(), text.into()));
    }

    pub(super) fn under(&self, title: &str) -> String {
        let mut text = format!("{}\n", quote::line(title));
        for (name, line) in &self.0 {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {name:<12} {}", quote::unbroken(line));
        }
        text
    }
}

/// The size from which a contact residual, a relative error or an imbalance is always shown.
const WORTH_SHOWING: f64 = 1e-8;

/// The summary of a result, which names the `files` that were written.
pub fn solved(r: &Results, files: &[PathBuf], verbose: bool) -> String {
    let mut lines = Lines(lines_of(r, verbose));
    if !files.is_empty() {
        lines.line("written", written(files));
    }
    lines.under(&match r.outcome().filter(|_| r.falls_short()) {
        Some(outcome) => format!("{}: {outcome}", r.title),
        None => r.title.clone(),
    })
}

/// The lines of the summary: what the case carries, then what is proved, then how it was solved. The last part is there if
/// it is asked for, and each of its lines where something about it is not as it should be.
pub(crate) fn lines_of(r: &Results, verbose: bool) -> Vec<(String, String)> {
    let mut lines = Lines::default();
    let shown = QuantityFormat::of(r);
    contact(r, &shown, verbose, &mut lines);
    stress(r, &shown, &mut lines);
    reactions(r, &shown, verbose, &mut lines);
    let largest = shown.number(r.quantities.max_displacement, Measure::Length);
    lines.line("displacement", format!("up to {largest}"));
    for remark in remarks(r) {
        lines.line("remark", remark);
    }
    let certificates = r.certificate.as_ref();
    let continuous = certificates.and_then(|c| c.continuous.as_ref());
    if let Some(continuous) = continuous {
        distance(continuous, &mut lines);
    }
    if let Some(adapt) = &r.adapt {
        lines.line("adapted", adapted(adapt));
    }
    if let Some(e) = &r.errors {
        let [energy, h1, l2] = [e.energy, e.h1, e.l2].map(short);
        let [pressure, normal] = [e.contact_residual, e.normal_stress].map(short);
        lines.line(
            "errors",
            format!(
                "energy {energy}, H1 {h1}, L2 {l2}, contact pressure {pressure}, normal stress {normal}"
            ),
        );
    }
    how_it_was_solved(r, &shown, verbose, &mut lines);
    if let Some(discrete) = certificates.and_then(|c| c.discrete.as_ref()) {
        if verbose {
            lines.line("proved", enclosed(discrete));
        }
        let is_plane = r.stress.as_ref().is_none_or(|stress| stress.hoop_max.is_none());
        let has_certificates = is_plane && r.contact.iter().all(ContactBoundary::may_be_certified);
        let how_far = match continuous {
            None if has_certificates => "; how far the mesh is off: --certificate",
            _ => "",
        };
        lines.line("solved", solved_exactly(discrete) + how_far);
    }
    lines.0
}

/// All remarks on a result, those on motions that nothing stops included.
pub(crate) fn remarks(r: &Results) -> Vec<String> {
    let shown = QuantityFormat::of(r);
    r.remarks.iter().cloned().chain(r.play.iter().map(|play| free(play, &shown))).collect()
}

/// The format of quantities: each with its unit.
pub(super) struct QuantityFormat {
    pub(super) units: Option<Units>,
    pub(super) thickness: Option<f64>,
    /// Components of forces below this are rounding.
    pub(super) no_force: f64,
}

impl QuantityFormat {
    fn of(r: &Results) -> QuantityFormat {
        let no_force = (1e-10 * r.quantities.all_forces(&r.contact)).max(rounding(r));
        QuantityFormat { units: r.units.clone(), thickness: r.thickness, no_force }
    }

    pub(super) fn with_unit(&self, shown: String, measure: Measure) -> String {
        match &self.units {
            Some(units) => format!("{shown} {}", units.of(measure, self.thickness)),
            None => shown,
        }
    }

    pub(super) fn number(&self, x: f64, measure: Measure) -> String {
        self.with_unit(short(x), measure)
    }

    /// The components of a force, without the unit.
    pub(super) fn components(&self, f: [f64; 2]) -> String {
        vector(f.map(|c| if c.abs() > self.no_force { c } else { 0.0 }))
    }
}

/// Young's modulus and Poisson's ratio of a material, or its stiffness.
fn moduli(material: &MaterialEcho) -> String {
    match (material.young, material.poisson, material.stiffness) {
        (Some(young), Some(poisson), _) => format!("E = {}, nu = {}", short(young), short(poisson)),
        (_, _, stiffness) => {
            let entries: Vec<String> = stiffness.iter().flatten().map(|&c| short(c)).collect();
            format!("C11, C12, C16, C22, C26, C66 = {}", entries.join(", "))
        }
    }
}

fn stiffest(r: &Results) -> f64 {
    r.materials.iter().fold(0.0, |most: f64, of| most.max(of.stiffest()))
}

/// The force that is one rounding error of the displacement times the stiffest modulus.
fn rounding(r: &Results) -> f64 {
    let thickness = r.thickness.unwrap_or(1.0);
    f64::EPSILON * stiffest(r) * r.quantities.max_displacement * thickness
}

/// The number of roundings that a stress of a triangle is made of, or more.
const ROUNDINGS: f64 = 16.0;

/// Returns whether a stress is no larger than what rounding the displacement makes of a body without strain.
pub(super) fn is_no_stress(r: &Results, stress: f64) -> bool {
    let strain = ROUNDINGS * f64::EPSILON * r.quantities.max_displacement / r.mesh.h_max;
    stress.abs() <= strain * stiffest(r)
}

fn contact(r: &Results, shown: &QuantityFormat, verbose: bool, lines: &mut Lines) {
    if r.contact.is_empty() {
        let q = &r.quantities;
        let [force, length] = [
            shown.number(q.contact_force, Measure::Force),
            shown.number(q.contact_length, Measure::Length),
        ];
        let peak = shown.number(q.peak_pressure, Measure::Stress);
        lines.line("contact", format!("force {force}, length {length}, peak pressure {peak}"));
    }
    let mut parts: Vec<&ContactBoundary> = r.contact.iter().collect();
    parts.sort_by(|a, b| quote::natural(&a.boundary, &b.boundary));
    for (i, part) in parts.into_iter().enumerate() {
        let name = if i == 0 { "contact" } else { "" };
        let boundary = quote::cut(&part.label());
        if !r.is_in_contact(part) {
            lines.line(name, format!("{boundary}: no contact"));
            continue;
        }
        let at = |place: [f64; 2]| match place {
            [x, y] if x.is_finite() && y.is_finite() => format!(" at {}", vector(place)),
            // The reference in FEniCSx does not say.
            _ => String::new(),
        };
        let [force, length] =
            [shown.number(part.force, Measure::Force), shown.number(part.length, Measure::Length)];
        let components = shown.components(part.resultant);
        // The interval in which the true contact force is proved to lie.
        let continuous = r.certificate.as_ref().and_then(|c| c.continuous.as_ref());
        let proved = continuous.and_then(|c| Some((c.contact_force(&part.boundary)?, c.rigorous)));
        let components = match proved {
            Some((ends, rigorous)) => format!(
                ", {} {}; components {components}",
                if rigorous { "proved" } else { "with a reservation" },
                between(ends)
            ),
            None => format!(" {components}"),
        };
        lines.line(name, format!("{boundary}: force {force}{components}, length {length}"));
        let peak = shown.number(part.peak_pressure, Measure::Stress);
        let opening = match part.opening.filter(|opening| *opening > part.penetration) {
            Some(opening) => format!(", opening up to {}", shown.number(opening, Measure::Length)),
            None => String::new(),
        };
        lines.line("", format!("peak pressure {peak}{}{opening}", at(part.peak_at)));
        if let Some(friction) = &part.friction {
            lines.line("", shear(friction, shown, &at(friction.slip_at)));
        }
        if verbose {
            let mut words =
                format!("{boundary}: moment {}", shown.number(part.moment, Measure::Moment));
            if part.penetration.is_finite() {
                let depth = shown.number(part.penetration, Measure::Length);
                words += &format!(", penetration {depth}{}", at(part.penetration_at));
            }
            lines.line("", words);
        }
    }
}

/// Describes sticking, sliding and friction forces.
fn shear(friction: &BoundaryFriction, shown: &QuantityFormat, at: &str) -> String {
    let force = shown.number(friction.shear, Measure::Force);
    let [sticks, slides, slip] = [friction.sticks, friction.slides, friction.slip]
        .map(|length| shown.number(length, Measure::Length));
    let mut words = format!("friction {force}, sticks on {sticks}, slides on {slides}");
    if friction.slides > 0.0 {
        words += &format!(", by up to {slip}{at}");
    }
    words
}

/// Writes two numbers, rounded outwards to two digits of their distance, and no fewer than other numbers have: by half of the
/// last digit, for a number that begins with 1.
fn between([low, high]: [f64; 2]) -> String {
    let distance = (high - low) / low.abs().max(high.abs());
    let digits =
        if distance > 0.0 { (2.0 - distance.log10()).ceil().clamp(4.0, 12.0) } else { 4.0 };
    let digits = digits as i32;
    // Adding 0.0 spares the reader a -0.
    let [low, high] = [(low, -0.5), (high, 0.5)].map(|(end, half)| {
        numbers::short(end + half * 10_f64.powi(1 - digits) * end.abs() + 0.0, digits as usize)
    });
    format!("between {low} and {high}")
}

fn stress(r: &Results, shown: &QuantityFormat, lines: &mut Lines) {
    let Some(stress) = &r.stress else { return };
    let value = |peak: &StressPeak| {
        let surface = match &peak.surface {
            Some(surface) if r.materials.len() > 1 => format!(" in {}", quote::cut(surface)),
            _ => String::new(),
        };
        let stress = if is_no_stress(r, peak.value) { 0.0 } else { peak.value };
        format!("{} at {}{surface}", shown.number(stress, Measure::Stress), vector(peak.at))
    };
    lines.line("stress", format!("von Mises up to {}", value(&stress.von_mises)));
    let [low, high] = [&stress.principal_min, &stress.principal_max].map(value);
    lines.line("", format!("principal from {low} to {high}"));
    if let (Some(low), Some(high)) = (&stress.hoop_min, &stress.hoop_max) {
        lines.line("", format!("hoop from {} to {}", value(low), value(high)));
    }
}

fn reactions(r: &Results, shown: &QuantityFormat, verbose: bool, lines: &mut Lines) {
    let mut reactions: Vec<(&String, &[f64; 2])> = r.quantities.reactions.iter().collect();
    reactions.sort_by(|a, b| quote::natural(a.0, b.0));
    for (i, (boundary, reaction)) in reactions.into_iter().enumerate() {
        let name = if i == 0 { "reactions" } else { "" };
        let moment = r.reaction_moments.get(boundary).filter(|_| verbose);
        let moment = moment
            .map_or(String::new(), |m| format!(", moment {}", shown.number(*m, Measure::Moment)));
        let force = shown.with_unit(shown.components(*reaction), Measure::Force);
        lines.line(name, format!("{}: {force}{moment}", quote::cut(boundary)));
    }
}

fn how_it_was_solved(r: &Results, shown: &QuantityFormat, verbose: bool, lines: &mut Lines) {
    if verbose {
        lines.line("mesh", sizes(&r.mesh));
        for material in &r.materials {
            let of = match material.surfaces.as_slice() {
                [] => "the whole body".to_owned(),
                surfaces => quote::names(surfaces.iter().map(String::as_str)),
            };
            lines.line("material", format!("{of}: {}, plane {}", moduli(material), material.plane));
        }
    }
    if verbose || !(r.gamma.kappa < 1.0) {
        lines.line("coercivity", coercivity(&r.gamma));
    }
    if verbose || r.newton.report.status != Status::Converged {
        lines.line("newton", newton(&r.newton));
    }
    if let Some(method) = &r.method
        && (verbose || !(method.forward_error < WORTH_SHOWING))
    {
        lines.line("accuracy", accuracy(method));
    }
    if verbose {
        let [elastic, energy, work] =
            [r.quantities.energy / 2.0, r.quantities.energy, r.quantities.work]
                .map(|e| shown.number(e, Measure::Moment));
        lines.line("energy", format!("elastic energy {elastic}, a(u,u) = {energy}, L(u) = {work}"));
    }
    if let Some(balance) = &r.balance {
        let parts = [balance.loads, balance.supports, balance.contact];
        let imbalance = balance.imbalance.abs();
        let no_energy = rounding(r) * r.quantities.max_displacement;
        let is_balanced =
            imbalance < WORTH_SHOWING || parts.into_iter().all(|energy| energy.abs() <= no_energy);
        if verbose || !is_balanced {
            let [loads, supports, contact] = parts.map(|e| shown.number(e, Measure::Moment));
            let taken = r.contact.iter().filter_map(|part| part.friction).map(|of| of.dissipated);
            let friction = taken.reduce(|a, b| a + b).map_or(String::new(), |taken| {
                format!(", of which friction takes {}", shown.number(taken, Measure::Moment))
            });
            lines.line(
                "balance",
                format!(
                    "a(u,u) = loads {loads} + supports {supports} + contact {contact}{friction}, relative imbalance {imbalance:.0e}"
                ),
            );
        }
    }
    if verbose {
        lines.line("time", times(&r.seconds));
    }
}

fn times(s: &Seconds) -> String {
    // A report is finished before it is written.
    let write = Some(("write", s.write)).filter(|_| s.write > 0.0);
    let steps =
        [("read", s.read), ("assemble", s.assemble), ("solve", s.solve), ("certify", s.certify)];
    let step = |(name, seconds): (&str, f64)| match seconds < 1.0 {
        true => format!("{name} {:.1} ms", 1e3 * seconds),
        false => format!("{name} {seconds:.2} s"),
    };
    steps.into_iter().chain(write).map(step).collect::<Vec<_>>().join(", ")
}

/// The summary of what is certified of a displacement from elsewhere.
pub(crate) fn certified(case: &Case, field: &Path, c: &Continuous, files: &[PathBuf]) -> String {
    let mut lines = Lines::default();
    lines.line("field", quote::path(field));
    let norm = c.proof.norm;
    let size = |bound: f64| {
        let percent = 100.0 * bound / norm;
        if percent.is_finite() {
            format!("{} ({} % of its energy norm)", short(bound), numbers::short(percent, 3))
        } else {
            short(bound)
        }
    };
    let proved = proved(c.rigorous, c.reason.as_deref(), c.problem.as_deref());
    lines.line(
        "admissible",
        format!(
            "a displacement that satisfies the conditions is at most {} away (energy norm)",
            short(c.clipping)
        ),
    );
    lines.line("error", format!("at most {} of that one: {proved}", size(c.bound)));
    lines.line("", format!("at most {} as it is", size(c.of_field)));
    let missed = short(c.missed);
    lines.line(
        "prescribed",
        format!("the field misses it by at most {missed}; the energy norm does not see a field that is moved as a whole"),
    );
    lines.line("written", written(files));
    lines.under(&case.title)
}

/// Says whether a bound is proved, and of which problem, where that is not the one that is meant.
fn proved(rigorous: bool, reason: Option<&str>, problem: Option<&str>) -> String {
    let of = of_problem(problem);
    if rigorous {
        format!("proved{of}")
    } else {
        format!("with a reservation ({}){of}", reason.unwrap_or_default())
    }
}

fn of_problem(problem: Option<&str>) -> String {
    problem.map_or(String::new(), |problem| format!(", of the problem with {problem}"))
}

/// The case that a certificate is of, in the summary of an audit.
pub(crate) struct AuditedCase {
    pub(crate) file: PathBuf,
    pub(crate) title: String,
    pub(crate) units: Option<Units>,
    /// The reason why the certificate is not rigorous for the case.
    pub(crate) reason: Option<String>,
}

/// The summary of a certificate that was verified, and compared with a case.
pub(crate) fn audited(audit: &Audit, case: Option<&AuditedCase>) -> String {
    let Audit { header, certificate, proof, reservations, .. } = audit;
    let mut lines = Lines::default();
    let (triangles, edges) = (certificate.pieces.len(), certificate.edges.len());
    lines.line("certificate", format!("accepted: {triangles} triangles, {edges} edges"));
    lines.line("statement", &header.statement);
    let problem = match case {
        Some(case) => {
            let file = quote::path(&case.file);
            format!("that of {file}: its mesh, thickness, materials, supports, loads and obstacles")
        }
        None => "that of the numbers in this file; --case CASE.toml compares them with a case"
            .to_owned(),
    };
    lines.line("problem", problem);
    let relative = 100.0 * header.bound / proof.norm;
    // Of a body at rest, whose norm is rounding, it says nothing.
    let size = Some(relative).filter(|r| *r < 1e8);
    let size = size.map_or(String::new(), |r| format!(", {} % of |v|_a", numbers::short(r, 2)));
    lines.line("bound", format!("{}{size}", short(header.bound)));
    let units = case.and_then(|case| case.units.clone());
    let shown = QuantityFormat { units, thickness: header.thickness, no_force: 0.0 };
    let thickness = header.thickness.unwrap_or(1.0);
    for (i, force) in audit.forces().enumerate() {
        let heading = if i == 0 { "forces" } else { "" };
        let measure = if force.is_moment { Measure::Moment } else { Measure::Force };
        let ends = shown.with_unit(between(force.between.map(|end| thickness * end)), measure);
        lines.line(heading, format!("{}: {ends}", quote::line(&force.name)));
    }
    let problem = of_problem(certificate.problem(proof).as_deref());
    let reservation = match case {
        Some(case) => case.reason.clone(),
        None => (!reservations.is_empty()).then(|| reservations.to_string()),
    };
    let rigorous = match reservation {
        Some(reservation) => format!("with a reservation: {reservation}{problem}"),
        None => format!("yes, rounding included{problem}"),
    };
    lines.line("rigorous", rigorous);
    match case {
        Some(case) => lines.under(&case.title),
        None => {
            lines.line(
                "title",
                format!("{}, as the file has it", quote::quoted(&header.title, '"')),
            );
            lines.under("A certificate")
        }
    }
}

/// The number of digits of a double.
const MOST_DIGITS: f64 = 15.0;

/// Says how many digits of the discrete solution are proved.
fn solved_exactly(certificate: &DiscreteCertificate) -> String {
    let (sliding, beside) = match (certificate.unique, certificate.isolated) {
        (true, _) => ("", ""),
        (false, None) => (", but for sliding", ""),
        (false, Some(_)) => {
            ("", "; with Coulomb's friction there may be others, far from this one")
        }
    };
    let digits = match (certificate.radius, certificate.relative) {
        (None, _) => {
            let reason = certificate.reason.as_deref().unwrap_or_default();
            return format!("for this mesh, how exactly is not proved: {reason}");
        }
        (Some(_), Some(relative)) if relative > 0.0 => (-relative.log10()).floor().min(MOST_DIGITS),
        (Some(radius), None) if radius >= LEAST_NORM && !certificate.hardly_strains => 0.0,
        _ => return format!("exactly for this mesh{sliding}, rounding included{beside}"),
    };
    match digits {
        digits if digits >= 1.0 => {
            let digits = count(digits as usize, "digit");
            format!("exactly for this mesh{sliding}, to {digits}, rounding included{beside}")
        }
        _ => format!("for this mesh{sliding}, to less than a digit, rounding included{beside}"),
    }
}

/// Says how far the solution can be from the exact solution of the discrete equations (8), and whether there is one.
fn enclosed(certificate: &DiscreteCertificate) -> String {
    let one = "the discrete equations have exactly one solution";
    let Some(radius) = certificate.radius else {
        let reason = certificate.reason.as_deref().unwrap_or_default();
        return match certificate.unique {
            true => format!("{one}; how far this one is from it is not known: {reason}"),
            false => format!("nothing: {reason}"),
        };
    };
    let solutions = match certificate.unique {
        true => one,
        false => "the discrete equations have one solution but for sliding",
    };
    // The power of ten above: what rounding leaves differs from processor to processor.
    let size = match certificate.relative.filter(|relative| *relative > 0.0) {
        Some(relative) => {
            format!("1e{} of it (relative, in the energy norm)", relative.log10().ceil())
        }
        None => format!("{} of it (in the energy norm)", short(radius)),
    };
    let at_rest = certificate.relative.is_none() && radius > 0.0 && certificate.hardly_strains;
    let size = if at_rest { format!("{size}; the body hardly strains") } else { size };
    let of = certificate.problem.as_deref().map_or(String::new(), |what| format!(", with {what}"));
    if let Some(IsolatedSolution { within, unique_below, limits }) = certificate.isolated {
        let near = match within {
            Some(within) => format!(
                "within 1e{} of this one (relative, in the energy norm)",
                within.log10().floor()
            ),
            None => "near this one".to_owned(),
        };
        let elsewhere = if certificate.unique { ", and no other anywhere" } else { "" };
        let below = unique_below.map_or(String::new(), |most| {
            let each = limits
                .map(|limits| limits.map(short_below))
                .map_or(String::new(), |[by_energy, by_coupling]| {
                    format!(" (mu_1 = {by_energy}, mu_2 = {by_coupling})")
                });
            let most = short_below(most);
            format!("; with a coefficient below {most}{each} there is one for all loads")
        });
        return format!(
            "with Coulomb's friction, exactly one solution of the discrete equations {near}{elsewhere}{below}; this is within {size}, rounding included{of}"
        );
    }
    format!("{solutions}; this is within {size}, rounding included{of}")
}

/// Says whether the target was met, and how the bound fell.
fn adapted(adapt: &Adaptation) -> String {
    let percent = |relative: f64| format!("{} %", numbers::short(100.0 * relative, 2));
    let reached = |level: &AdaptedLevel| match &adapt.force {
        Some(_) => {
            level.force.map_or("not bounded".to_owned(), |within| format!("±{}", percent(within)))
        }
        None if level.relative.is_finite() => percent(level.relative),
        None => short(level.bound),
    };
    let bounds: Vec<String> = adapt.levels.iter().map(reached).collect();
    let verdict = match &adapt.reason {
        Some(reason) => format!("not met: {reason}"),
        None => "met".to_owned(),
    };
    let target = match &adapt.force {
        Some(boundary) => format!("force of {} within ±", quote::cut(boundary)),
        None => "target ".to_owned(),
    };
    let levels = match &*bounds {
        [] => String::new(),
        bounds => format!("; {}: {}", count(bounds.len(), "level"), bounds.join(" ")),
    };
    format!("{target}{} {verdict}{levels}", percent(adapt.target))
}

/// Says how far the solution can be from the true one: as it is, and pushed out of the obstacle, where that is another number.
fn distance(certificate: &ContinuousCertificate, lines: &mut Lines) {
    let reason = certificate.reason.as_deref().unwrap_or_default();
    let (Some(bound), Some(of_solution)) = (certificate.bound, certificate.of_solution) else {
        return lines.line("error", format!("not bounded: {reason}"));
    };
    let size = |error: f64| match certificate.relative {
        Some(relative) => {
            let percent = 100.0 * relative * if bound > 0.0 { error / bound } else { 1.0 };
            format!("{} % of the energy norm", numbers::short(percent, 2))
        }
        None => short(error),
    };
    let [as_it_is, pushed_out] = [of_solution, bound].map(size);
    let proved =
        proved(certificate.rigorous, certificate.reason.as_deref(), certificate.problem.as_deref());
    lines.line("error", format!("energy error at most {as_it_is}: {proved}"));
    if as_it_is != pushed_out {
        let of = "for the displacement pushed out of the obstacle, which a certificate is about";
        lines.line("", format!("at most {pushed_out} {of}"));
    }
}

pub(super) fn sizes(mesh: &MeshSizes) -> String {
    let MeshSizes { vertices, triangles, dofs, contact_edges, h_max } = *mesh;
    // P1 has its nodes at the vertices alone.
    let degree = if dofs == 2 * vertices { 1 } else { 2 };
    let contact = count(contact_edges, "contact edge");
    format!("{triangles} P{degree} triangles, {dofs} unknowns, {contact}, h = {}", short(h_max))
}

pub(super) fn coercivity(gamma: &GammaChoice) -> String {
    let [a, b] = gamma.limiting_edge;
    let verdict = if gamma.kappa < 1.0 { "< 1: coercive" } else { ">= 1: no promise" };
    format!(
        "gamma0 = {}{} (limit {} at the edge {}-{}), kappa = {} {verdict}",
        if gamma.local { "on each edge its own, from " } else { "" },
        short(gamma.gamma0),
        short(gamma.limit),
        vector(a),
        vector(b),
        short(gamma.kappa)
    )
}

fn newton(newton: &NewtonHistory) -> String {
    let NewtonHistory { iterations, report } = newton;
    let first = report.residuals.first().copied().unwrap_or(report.residual);
    format!(
        "{} in {}, {}, relative residual from {first:.0e} to {:.1e}",
        report.status.name(),
        count(*iterations, "step"),
        count(report.factorizations, "factorisation"),
        report.residual
    )
}

pub(super) fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

fn accuracy(method: &MethodReport) -> String {
    let route = match method.route {
        RouteName::Condensed => "condensed",
        RouteName::Assembled => "assembled",
    };
    let error = match method.forward_error {
        error if error.is_finite() => format!("{error:.0e} (energy norm)"),
        _ => "unknown".to_owned(),
    };
    format!(
        "{route} route, condition number at least {:.0e}, relative error of iteration and rounding {error}",
        method.condition
    )
}

/// A place or a vector, with four digits.
pub(super) fn vector([x, y]: [f64; 2]) -> String {
    format!("({}, {})", short(x), short(y))
}

/// A motion that nothing stops, and how far it may go.
fn free(play: &Play, shown: &QuantityFormat) -> String {
    let motion = match (play.about, play.along) {
        (Some(about), _) => format!("turn about {}", vector(about)),
        (_, along) => format!("move along {}", vector(along.unwrap_or_default())),
    };
    let end = |end: f64| match play.about {
        Some(_) => format!("{} rad", short(end)),
        None => shown.number(end, Measure::Length),
    };
    let range = match (play.least, play.most) {
        (None, None) => "without limit".to_owned(),
        (Some(least), None) => format!("from {} upwards", end(least)),
        (None, Some(most)) => format!("up to {}", end(most)),
        (Some(least), Some(most)) => format!("from {} to {}", end(least), end(most)),
    };
    format!(
        "the body can still {motion}, {range}: no support and no obstacle that it presses on stops it. One displacement of many is shown, the smallest; in reality friction would decide"
    )
}

/// A positive number to three digits, rounded down.
fn short_below(x: f64) -> String {
    let unit = 10.0_f64.powf(x.log10().floor() - 2.0);
    if x > 0.0 { short((x / unit).floor() * unit) } else { short(0.0) }
}

fn short(x: f64) -> String {
    numbers::short(x, 4)
}

/// folder/{a, b, c}
pub(super) fn written(files: &[PathBuf]) -> String {
    let folder = files.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
    let names: Vec<_> =
        files.iter().flat_map(|f| f.file_name()).map(|n| n.to_string_lossy()).collect();
    format!("{}: {}", quote::path(folder), names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::result::tests::everything;

    #[test]
    fn each_number_of_the_summary_is_that_of_its_words() {
        let lines = lines_of(&everything(), true);
        let lines: Vec<String> =
            lines.into_iter().map(|(name, text)| format!("{name}: {text}")).collect();
        assert_eq!(lines, SUMMARY);
        // A stress that rounding makes of the displacement is none.
        let mut results = everything();
        results.stress.as_mut().unwrap().von_mises.value = 1e-12;
        let lines = lines_of(&results, false);
        let of_rounding = "von Mises up to 0 kN/cm^2 at (3.67, 3.73)";
        assert!(lines.iter().any(|(_, text)| text == of_rounding), "{lines:?}");
    }

    /// With the numbers of the result, to four digits.
    const SUMMARY: [&str; 24] = [
        "contact: floor: force 22.3 kN, proved between 21 and 24; components (22.7, 22.9), length 2.39 cm",
        ": peak pressure 26.9 kN/cm^2 at (2.71, 2.77), opening up to 0.0307 cm",
        ": friction 31.1 kN, sticks on 3.13 cm, slides on 3.17 cm, by up to 0.0331 cm at (3.37, 3.47)",
        ": floor: moment 23.3 kN cm, penetration 0.0281 cm at (2.83, 2.93)",
        "stress: von Mises up to 359 kN/cm^2 at (3.67, 3.73)",
        ": principal from -39.7 kN/cm^2 at (4.01, 4.09) to 37.9 kN/cm^2 at (3.83, 3.89)",
        ": hoop from -43.3 kN/cm^2 at (4.39, 4.43) to 41.9 kN/cm^2 at (4.21, 4.31)",
        "reactions: top: (19.9, -211) kN, moment 449 kN cm",
        "displacement: up to 0.173 cm",
        "remark: the body can still move along (0.6, 0.8), from -0.151 cm to 0.157 cm: no support and no obstacle that it presses on stops it. One displacement of many is shown, the smallest; in reality friction would decide",
        "error: energy error at most 2.7 % of the energy norm: proved",
        ": at most 5.4 % of the energy norm for the displacement pushed out of the obstacle, which a certificate is about",
        "adapted: target 6.6 % met; 2 levels: 6.8 % 5.4 %",
        "errors: energy 7.19, H1 7.27, L2 7.33, contact pressure 7.39, normal stress 7.43",
        "mesh: 103 P1 triangles, 202 unknowns, 107 contact edges, h = 0.109",
        "material: the whole body: E = 210.5, nu = 0.31, plane strain",
        "coercivity: gamma0 = 0.0111 (limit 0.113 at the edge (1.31, 1.37)-(1.39, 1.49)), kappa = 0.127 < 1: coercive",
        "newton: converged in 11 steps, 13 factorisations, relative residual from 3e-1 to 2.0e-12",
        "accuracy: condensed route, condition number at least 2e3, relative error of iteration and rounding 3e-13 (energy norm)",
        "energy: elastic energy 8.15 kN cm, a(u,u) = 16.3 kN cm, L(u) = 16.7 kN cm",
        "balance: a(u,u) = loads 46.1 kN cm + supports 46.3 kN cm + contact 46.7 kN cm, of which friction takes 34.9 kN cm, relative imbalance 5e-6",
        "time: read 75.1 ms, assemble 75.7 ms, solve 7.61 s, certify 76.9 ms",
        "proved: the discrete equations have exactly one solution; this is within 1e-10 of it (relative, in the energy norm), rounding included",
        "solved: exactly for this mesh, to 10 digits, rounding included",
    ];

    #[test]
    fn a_radius_that_is_not_small_beside_the_body_s_own_energy_is_no_exact_solution() {
        let of = |radius: f64, hardly_strains: bool| {
            let certificate = DiscreteCertificate {
                radius: Some(radius),
                hardly_strains,
                unique: true,
                ..Default::default()
            };
            solved_exactly(&certificate)
        };
        assert!(of(4e-7, false).contains("to less than a digit"));
        for exact in [of(4e-7, true), of(0.0, false)] {
            assert!(exact.starts_with("exactly for this mesh, rounding"), "{exact}");
        }
    }

    #[test]
    fn both_limits_of_the_coefficient_are_printed_rounded_down_and_none_where_none_is_known() {
        let with = |limits: Option<[f64; 2]>| {
            let unique_below = limits.map(|limits| limits[0].max(limits[1]));
            let isolated = IsolatedSolution { within: Some(2e-6), unique_below, limits };
            enclosed(&DiscreteCertificate {
                radius: Some(1e-12),
                relative: Some(1e-12),
                isolated: Some(isolated),
                rigorous: true,
                ..Default::default()
            })
        };
        let both = with(Some([0.13999, 0.02999]));
        let expected = "; with a coefficient below 0.139 (mu_1 = 0.139, mu_2 = 0.0299) there is one for all loads";
        assert!(both.contains(expected), "{both}");
        assert!(with(Some([0.1, 0.0])).contains("mu_1 = 0.1, mu_2 = 0)"));
        let none = with(None);
        assert!(none.contains("exactly one solution") && !none.contains("coefficient below"));
    }

    #[test]
    fn what_is_proved_of_the_discrete_solution_is_rounded_to_the_safe_side() {
        let of = |unique: bool, radius: Option<f64>, relative: Option<f64>| DiscreteCertificate {
            unique,
            radius,
            relative,
            reason: radius.is_none().then(|| "no factor".to_owned()),
            ..Default::default()
        };
        let alone = |within: Option<f64>| DiscreteCertificate {
            isolated: Some(IsolatedSolution { within, unique_below: None, limits: None }),
            ..of(false, Some(1.0), Some(3e-12))
        };
        let still = DiscreteCertificate { hardly_strains: true, ..of(true, Some(2e-9), None) };
        let (size, in_norm) = ("within 1e-11 of it", "(relative, in the energy norm)");
        let (one, slides) = ("the discrete equations have", "one solution but for sliding");
        let coulomb = "with Coulomb's friction, exactly one solution of the discrete equations";
        let rounding = "rounding included";
        for (certificate, expected) in [
            (
                alone(Some(2e-6)),
                format!(
                    "{coulomb} within 1e-6 of this one {in_norm}; this is {size} {in_norm}, {rounding}"
                ),
            ),
            (alone(None), format!("{coulomb} near this one; this is {size} {in_norm}, {rounding}")),
            (
                of(true, Some(1.0), Some(3e-12)),
                format!("{one} exactly one solution; this is {size} {in_norm}, {rounding}"),
            ),
            (
                of(false, Some(1.0), Some(3e-12)),
                format!("{one} {slides}; this is {size} {in_norm}, {rounding}"),
            ),
            (
                of(true, Some(2e-9), None),
                format!(
                    "{one} exactly one solution; this is within 2e-9 of it (in the energy norm), {rounding}"
                ),
            ),
            (
                still,
                format!(
                    "{one} exactly one solution; this is within 2e-9 of it (in the energy norm); the body hardly strains, {rounding}"
                ),
            ),
            (
                of(true, None, None),
                format!(
                    "{one} exactly one solution; how far this one is from it is not known: no factor"
                ),
            ),
            (of(false, None, None), "nothing: no factor".to_owned()),
        ] {
            assert_eq!(enclosed(&certificate), expected);
        }
        let digits = |relative: f64| solved_exactly(&of(true, Some(1.0), Some(relative)));
        for (relative, expected) in [
            (3e-12, "exactly for this mesh, to 11 digits, rounding included"),
            (0.099, "exactly for this mesh, to 1 digit, rounding included"),
            (0.11, "for this mesh, to less than a digit, rounding included"),
            (1e-30, "exactly for this mesh, to 15 digits, rounding included"),
            (0.0, "exactly for this mesh, rounding included"),
        ] {
            assert_eq!(digits(relative), expected);
        }
        let others = "; with Coulomb's friction there may be others, far from this one";
        for (certificate, expected) in [
            (alone(None), format!("exactly for this mesh, to 11 digits, {rounding}{others}")),
            (
                of(false, Some(1.0), Some(3e-12)),
                format!("exactly for this mesh, but for sliding, to 11 digits, {rounding}"),
            ),
            (of(true, Some(1.0), None), format!("for this mesh, to less than a digit, {rounding}")),
            (of(true, Some(1e-200), None), format!("exactly for this mesh, {rounding}")),
            (
                of(true, None, None),
                "for this mesh, how exactly is not proved: no factor".to_owned(),
            ),
        ] {
            assert_eq!(solved_exactly(&certificate), expected);
        }
    }

    #[test]
    fn an_audit_shows_forces_of_the_whole_thickness() {
        let text = "mesh.rectangle = { width = 1, height = 1, nx = 2, ny = 2 }\n\
                    material = { lambda = 1, mu = 1 }\n[boundary]\n\
                    top.displacement = [\"0\", \"-0.1 + 0.15*x\"]\nbottom.contact = { gap = \"0\" }\n";
        let case = Case::parse(Path::new("punch.toml"), text, &[]).unwrap();
        let (solution, _) =
            crate::solve::solve(&case.problem, &case.method, &case.settings).unwrap();
        let of = crate::certificates::certify(&case.problem, &solution).unwrap();
        let forces = &of.quantities.evidence;
        let (header, arrays) =
            crate::certificates::encode("punch", &of.certificate, &of.proof, forces);
        let shown = |thickness: Option<f64>| -> Vec<f64> {
            let header = crate::certificates::format::Header { thickness, ..header.clone() };
            let audit = crate::certificates::format::audit(header, &arrays).unwrap();
            let text = audited(&audit, None).replace('\u{2212}', "-");
            let intervals = text.lines().filter_map(|line| line.split_once(": between "));
            let ends = intervals.flat_map(|(_, ends)| ends.split(" and "));
            ends.map(|end| end.trim().parse().unwrap()).collect()
        };
        let (per_thickness, whole) = (shown(None), shown(Some(20.0)));
        assert!(per_thickness.len() >= 4 && per_thickness.iter().any(|end| *end > 0.01));
        for (one, all) in per_thickness.into_iter().zip(whole) {
            // To the digits that are printed.
            assert!((20.0 * one - all).abs() <= 0.02 * all.abs(), "{one} {all}");
        }
    }

    #[test]
    fn an_interval_is_printed_around_itself_with_two_digits_of_its_width() {
        let printed = |ends: [f64; 2]| -> [f64; 2] {
            let text = between(ends);
            let words: Vec<&str> = text.split(' ').collect();
            assert_eq!((words[0], words[2]), ("between", "and"), "{text}");
            [1, 3].map(|k| words[k].replace('\u{2212}', "-").parse().unwrap())
        };
        let mut wider = 0;
        for k in 1..400 {
            // Ends all over the decades, of either sign, near to each other and far apart.
            let low =
                f64::from(k) * 0.777 * 10_f64.powi(k % 9 - 4) * if k % 2 == 0 { 1.0 } else { -1.0 };
            let high = low + low.abs() * 10_f64.powi(-(k % 7));
            let [a, b] = printed([low, high]);
            assert!(a <= low && high <= b, "[{low}, {high}] is printed as [{a}, {b}]");
            // By half of a digit for each end and as much for its rounding, of two digits of the width or of four of the number.
            let most = (0.1 * (high - low)).max(2e-3 * low.abs().max(high.abs()));
            assert!(
                low - a <= most && b - high <= most,
                "[{low}, {high}] is printed as [{a}, {b}]"
            );
            wider += i32::from(a < low && high < b);
        }
        assert!(wider > 100, "{wider} are wider at both ends");
        assert_eq!(between([0.0, 0.0]), "between 0 and 0");
    }
}
