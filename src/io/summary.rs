//! The summaries that the command prints.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::case::{MaterialEcho, Measure, Units};
use super::certificate::Audit;
use super::convergence::Study;
use super::result::{
    Adaptation, ContinuousCertificate, DiscreteCertificate, GammaChoice, MeshSizes, NewtonHistory,
    Results, Seconds, StressPeak,
};
use super::{Case, numbers};
use crate::certify::Continuous;
use crate::certify::adapt::AdaptedLevel;
use crate::fem::solvability::Play;
use crate::quote;
use crate::solve::answers::BoundaryFriction;
use crate::solve::{ContactQuadrature, MethodReport, Outline, RouteName, Status};

/// Lines of a name and a text; one without a name goes on with what the one before it is about.
#[derive(Default)]
struct Lines(Vec<(String, String)>);

impl Lines {
    fn line(&mut self, name: &str, text: impl Into<String>) {
        self.0.push((name.to_owned(), text.into()));
    }

    fn under(&self, title: &str) -> String {
        let mut text = format!("{}\n", quote::line(title));
        for (name, line) in &self.0 {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {name:<12} {}", quote::unbroken(line));
        }
        text
    }
}

/// A contact residual, a relative error or an imbalance above this is shown without being asked for.
const WORTH_SHOWING: f64 = 1e-8;

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
    for remark in r.remarks.iter().cloned().chain(r.play.iter().map(|play| free(play, &shown))) {
        lines.line("remark", remark);
    }
    let certificates = r.certificate.as_ref();
    if let Some(discrete) = certificates.and_then(|c| c.discrete.as_ref()) {
        lines.line("proved", enclosed(discrete));
    }
    if let Some(continuous) = certificates.and_then(|c| c.continuous.as_ref()) {
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
    lines.0
}

/// The format of quantities: each with its unit, those per unit of thickness times the thickness.
struct QuantityFormat {
    units: Option<Units>,
    thickness: Option<f64>,
    /// Components of forces below this are rounding.
    no_force: f64,
}

impl QuantityFormat {
    fn of(r: &Results) -> QuantityFormat {
        let no_force = (1e-10 * r.all_forces()).max(rounding(r));
        QuantityFormat { units: r.units.clone(), thickness: r.thickness, no_force }
    }

    fn whole(&self, per_thickness: f64) -> f64 {
        per_thickness * self.thickness.unwrap_or(1.0)
    }

    fn with_unit(&self, shown: String, measure: Measure) -> String {
        match &self.units {
            Some(units) => format!("{shown} {}", units.of(measure, self.thickness)),
            None => shown,
        }
    }

    fn number(&self, x: f64, measure: Measure) -> String {
        let per_thickness = matches!(measure, Measure::Force | Measure::Moment);
        self.with_unit(short(if per_thickness { self.whole(x) } else { x }), measure)
    }

    /// The components of a force, without the unit.
    fn components(&self, f: [f64; 2]) -> String {
        vector(f.map(|c| if c.abs() > self.no_force { self.whole(c) } else { 0.0 }))
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

/// The force, per unit of thickness, that is one rounding error of the displacement times the stiffest modulus.
fn rounding(r: &Results) -> f64 {
    let stiffest = r.materials.iter().fold(0.0, |most: f64, of| most.max(of.stiffest()));
    f64::EPSILON * stiffest * r.quantities.max_displacement
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
    for (i, part) in r.contact.iter().enumerate() {
        let name = if i == 0 { "contact" } else { "" };
        let boundary = quote::cut(&part.boundary);
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
                between(ends.map(|end| shown.whole(end)))
            ),
            None => format!(" {components}"),
        };
        lines.line(name, format!("{boundary}: force {force}{components}, length {length}"));
        let peak = shown.number(part.peak_pressure, Measure::Stress);
        lines.line("", format!("peak pressure {peak}{}", at(part.peak_at)));
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

/// Says what friction does.
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
    let [low, high] = [(low, -0.5), (high, 0.5)].map(|(end, half)| {
        numbers::short(end + half * 10_f64.powi(1 - digits) * end.abs(), digits as usize)
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
        format!("{} at {}{surface}", shown.number(peak.value, Measure::Stress), vector(peak.at))
    };
    lines.line("stress", format!("von Mises up to {}", value(&stress.von_mises)));
    let [low, high] = [&stress.principal_min, &stress.principal_max].map(value);
    lines.line("", format!("principal from {low} to {high}"));
}

fn reactions(r: &Results, shown: &QuantityFormat, verbose: bool, lines: &mut Lines) {
    for (i, (boundary, reaction)) in r.quantities.reactions.iter().enumerate() {
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
    if verbose || r.newton.status != Status::Converged {
        lines.line("newton", newton(&r.newton));
    }
    if let Some(method) = &r.method
        && (verbose || !(method.forward_error < WORTH_SHOWING))
    {
        lines.line("accuracy", accuracy(method));
    }
    if verbose {
        let [energy, work] =
            [r.quantities.energy, r.quantities.work].map(|e| shown.number(e, Measure::Moment));
        lines.line("energy", format!("a(u,u) = {energy}, L(u) = {work}"));
    }
    if let Some(balance) = &r.balance {
        let parts = [balance.loads, balance.supports, balance.contact];
        let imbalance = balance.imbalance.abs();
        let no_energy = rounding(r) * r.quantities.max_displacement;
        let is_balanced =
            imbalance < WORTH_SHOWING || parts.into_iter().all(|energy| energy.abs() <= no_energy);
        if verbose || !is_balanced {
            let [loads, supports, contact] = parts.map(|e| shown.number(e, Measure::Moment));
            lines.line(
                "balance",
                format!(
                    "a(u,u) = loads {loads} + supports {supports} + contact {contact}, relative imbalance {imbalance:.0e}"
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
pub fn certified(case: &Case, field: &Path, c: &Continuous, files: &[PathBuf]) -> String {
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

/// The summary of a certificate that was verified.
pub fn audited(audit: &Audit, case: Option<(&Path, Option<&str>)>) -> String {
    let Audit { header, certificate, proof, reservations, .. } = audit;
    let mut lines = Lines::default();
    let (triangles, edges) = (certificate.pieces.len(), certificate.edges.len());
    lines.line("certificate", format!("accepted: {triangles} triangles, {edges} edges"));
    lines.line("statement", &header.statement);
    let problem = match case {
        Some((case, _)) => {
            format!(
                "that of {}: its mesh, materials, supports, loads and obstacles",
                quote::path(case)
            )
        }
        None => "that of the numbers in this file; --case CASE.toml compares them with a case"
            .to_owned(),
    };
    lines.line("problem", problem);
    let relative = 100.0 * header.bound / proof.norm;
    let size = Some(relative).filter(|r| r.is_finite());
    let size = size.map_or(String::new(), |r| format!(", {} % of |v|_a", numbers::short(r, 2)));
    lines.line("bound", format!("{}{size}", short(header.bound)));
    for (i, (name, ends)) in audit.forces().enumerate() {
        let heading = if i == 0 { "forces" } else { "" };
        lines.line(heading, format!("{}: {}", quote::line(&name), between(ends)));
    }
    let problem = of_problem(certificate.problem(proof).as_deref());
    let reservation = match case {
        Some((_, reason)) => reason.map(str::to_owned),
        None => (!reservations.is_empty()).then(|| reservations.to_string()),
    };
    let rigorous = match reservation {
        Some(reservation) => format!("with a reservation: {reservation}{problem}"),
        None => format!("yes, rounding included{problem}"),
    };
    lines.line("rigorous", rigorous);
    lines.under(&header.title)
}

/// Says how far the solution can be from the exact solution of the discrete equations (8), and whether there is one.
fn enclosed(certificate: &DiscreteCertificate) -> String {
    let reason = certificate.reason.as_deref().unwrap_or_default();
    let solutions = match (certificate.unique, certificate.radius) {
        (true, _) => "the discrete equations have exactly one solution",
        (false, Some(_)) => "the discrete equations have one solution but for sliding",
        (false, None) => "",
    };
    let Some(radius) = certificate.radius else {
        return match solutions {
            "" => format!("nothing: {reason}"),
            _ => format!("{solutions}; how far this one is from it is not known: {reason}"),
        };
    };
    // The power of ten above: what rounding leaves differs from processor to processor.
    let size = match certificate.relative.filter(|relative| *relative > 0.0) {
        Some(relative) => {
            format!("1e{} of it (relative, in the energy norm)", relative.log10().ceil())
        }
        None => format!("{} of it (in the energy norm)", short(radius)),
    };
    let of = certificate.problem.as_deref().map_or(String::new(), |what| format!(", with {what}"));
    if let Some(within) = certificate.isolated {
        let near = format!("1e{}", within.log10().floor());
        let elsewhere = if certificate.unique { ", and no other anywhere" } else { "" };
        return format!(
            "with Coulomb's friction, exactly one solution of the discrete equations within {near} of this one (relative, in the energy norm){elsewhere}; this is within {size}, rounding included{of}"
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
        None => percent(level.relative),
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
    format!(
        "{target}{} {verdict}; {}: {}",
        percent(adapt.target),
        count(adapt.levels.len(), "level"),
        bounds.join(" ")
    )
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
        let of = "for the displacement pushed out of the obstacle, as in certificate.json";
        lines.line("", format!("at most {pushed_out} {of}"));
    }
}

pub fn checked(case: &Case, outline: &Outline) -> String {
    let mut lines = Lines::default();
    let mesh = MeshSizes::new(&case.problem.mesh, outline.nodes, outline.contact_edges);
    lines.line("mesh", sizes(&mesh));
    lines.line("prescribed", format!("{} of the unknowns", outline.prescribed));
    lines.line("coercivity", coercivity(&GammaChoice::from(&outline.gamma)));
    lines.line(
        "quadrature",
        match case.method.quadrature {
            ContactQuadrature::Exact => "exact: contact edges are cut at the roots of P".to_owned(),
            ContactQuadrature::Gauss(1) => "1 Gauss point on each contact edge".to_owned(),
            ContactQuadrature::Gauss(n) => format!("{n} Gauss points on each contact edge"),
        },
    );
    if let Some(overlap) = super::remarks::overlap(case) {
        lines.line("remark", overlap);
    }
    lines.under(&case.title)
}

pub fn studied(case: &Case, studies: &[Study], files: &[PathBuf]) -> String {
    let tables: Vec<String> = studies.iter().map(Study::table).collect();
    format!("{}\n\n{}\nwritten: {}\n", quote::line(&case.title), tables.join("\n"), written(files))
}

pub fn swept(title: &str, table: &str, files: &[PathBuf]) -> String {
    format!("{}\n\n{table}\nwritten: {}\n", quote::line(title), written(files))
}

fn sizes(mesh: &MeshSizes) -> String {
    let MeshSizes { vertices, triangles, dofs, contact_edges, h_max } = *mesh;
    // P1 has its nodes at the vertices alone.
    let degree = if dofs == 2 * vertices { 1 } else { 2 };
    let contact = count(contact_edges, "contact edge");
    format!("{triangles} P{degree} triangles, {dofs} unknowns, {contact}, h = {}", short(h_max))
}

fn coercivity(gamma: &GammaChoice) -> String {
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
    let first = newton.residuals.first().copied().unwrap_or(newton.residual);
    format!(
        "{} in {}, {}, relative residual from {first:.0e} to {:.1e}",
        newton.verdict(),
        count(newton.iterations, "step"),
        count(newton.factorizations, "factorisation"),
        newton.residual
    )
}

fn count(n: usize, what: &str) -> String {
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
        "the body can still {motion}, {range}: no support and no obstacle that it presses on stops it. The displacement given is the one of least norm; in reality friction would decide"
    )
}

fn short(x: f64) -> String {
    numbers::short(x, 4)
}

/// folder/{a, b, c}
fn written(files: &[PathBuf]) -> String {
    let folder = files.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
    let names: Vec<_> =
        files.iter().flat_map(|f| f.file_name()).map(|n| n.to_string_lossy()).collect();
    format!("{}: {}", quote::path(folder), names.join(", "))
}
