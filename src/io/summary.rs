//! The summaries that the command prints.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::case::{MaterialEcho, Units};
use super::certificate::Audit;
use super::convergence::Study;
use super::result::{
    Adaptation, ContinuousCertificate, DiscreteCertificate, GammaChoice, MeshSizes, NewtonHistory,
    Results, Seconds, StressPeak,
};
use super::sweep::Sweep;
use super::{Case, numbers};
use crate::certify::Continuous;
use crate::certify::adapt::AdaptedLevel;
use crate::fem::solvability::Play;
use crate::quote;
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

/// The summary of a solved case.
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
    let largest = r.quantities.max_displacement;
    lines.line("displacement", format!("up to {}{}", short(largest), shown.length));
    for remark in &r.remarks {
        lines.line("remark", remark);
    }
    for play in &r.play {
        lines.line("remark", free(play, &shown));
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
    if let Some(errors) = &r.errors {
        lines.line(
            "errors",
            format!(
                "energy {}, H1 {}, L2 {}, contact pressure {}, normal stress {}",
                short(errors.energy),
                short(errors.h1),
                short(errors.l2),
                short(errors.contact_residual),
                short(errors.normal_stress)
            ),
        );
    }
    how_it_was_solved(r, &shown, verbose, &mut lines);
    lines.0
}

/// The format of quantities: each with its unit, those per unit of thickness times the thickness.
struct QuantityFormat {
    length: String,
    stress: String,
    force: String,
    moment: String,
    thickness: f64,
    /// Components of forces below this are rounding.
    no_force: f64,
}

impl QuantityFormat {
    fn of(r: &Results) -> QuantityFormat {
        let unit = |of: &dyn Fn(&Units) -> String| {
            r.units.as_ref().map_or(String::new(), |units| format!(" {}", of(units)))
        };
        QuantityFormat {
            length: unit(&|units| units.length.clone()),
            stress: unit(&Units::stress),
            force: unit(&|units| units.force(r.thickness)),
            moment: unit(&|units| units.moment(r.thickness)),
            thickness: r.thickness.unwrap_or(1.0),
            no_force: (1e-10 * r.all_forces()).max(rounding(r)),
        }
    }

    /// The components of a force, without the unit.
    fn components(&self, f: [f64; 2]) -> String {
        let [x, y] = f.map(|c| if c.abs() > self.no_force { c * self.thickness } else { 0.0 });
        vector([x, y])
    }

    fn moment(&self, m: f64) -> String {
        format!("{}{}", short(m * self.thickness), self.moment)
    }

    fn stress(&self, s: f64) -> String {
        format!("{}{}", short(s), self.stress)
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
    let size = |force: f64| format!("{}{}", short(force * shown.thickness), shown.force);
    if r.contact.is_empty() {
        let q = &r.quantities;
        let length = format!("{}{}", short(q.contact_length), shown.length);
        let peak = shown.stress(q.peak_pressure);
        let force = size(q.contact_force);
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
        let length = format!("{}{}", short(part.length), shown.length);
        let [force, components] = [size(part.force), shown.components(part.resultant)];
        let peak = format!("{}{}", shown.stress(part.peak_pressure), at(part.peak_at));
        let components = match proved_force(r, &part.boundary, shown.thickness) {
            Some(proved) => format!(", {proved}; components {components}"),
            None => format!(" {components}"),
        };
        lines.line(name, format!("{boundary}: force {force}{components}, length {length}"));
        lines.line("", format!("peak pressure {peak}"));
        if verbose {
            let mut words = format!("{boundary}: moment {}", shown.moment(part.moment));
            if part.penetration.is_finite() {
                let depth = format!("{}{}", short(part.penetration), shown.length);
                words += &format!(", penetration {depth}{}", at(part.penetration_at));
            }
            lines.line("", words);
        }
    }
}

/// The interval in which the true contact force of a boundary is proved to lie, rounded outwards.
fn proved_force(r: &Results, boundary: &str, thickness: f64) -> Option<String> {
    let continuous = r.certificate.as_ref()?.continuous.as_ref()?;
    let [low, high] = continuous.contact_force(boundary)?;
    let proved = if continuous.rigorous { "proved" } else { "with a reservation" };
    Some(format!("{proved} {}", between([low * thickness, high * thickness])))
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
        format!("{} at {}{surface}", shown.stress(peak.value), vector(peak.at))
    };
    lines.line("stress", format!("von Mises up to {}", value(&stress.von_mises)));
    let [low, high] = [&stress.principal_min, &stress.principal_max].map(value);
    lines.line("", format!("principal from {low} to {high}"));
}

fn reactions(r: &Results, shown: &QuantityFormat, verbose: bool, lines: &mut Lines) {
    for (i, (boundary, reaction)) in r.quantities.reactions.iter().enumerate() {
        let name = if i == 0 { "reactions" } else { "" };
        let moment = match r.reaction_moments.get(boundary).filter(|_| verbose) {
            Some(moment) => format!(", moment {}", shown.moment(*moment)),
            None => String::new(),
        };
        let force = format!("{}{}", shown.components(*reaction), shown.force);
        lines.line(name, format!("{}: {force}{moment}", quote::cut(boundary)));
    }
}

fn how_it_was_solved(r: &Results, shown: &QuantityFormat, verbose: bool, lines: &mut Lines) {
    if verbose {
        mesh_and_materials(r, lines);
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
        let [energy, work] = [r.quantities.energy, r.quantities.work].map(|e| shown.moment(e));
        lines.line("energy", format!("a(u,u) = {energy}, L(u) = {work}"));
    }
    if let Some(balance) = &r.balance {
        let parts = [balance.loads, balance.supports, balance.contact];
        let imbalance = balance.imbalance.abs();
        let no_energy = rounding(r) * r.quantities.max_displacement;
        let is_balanced =
            imbalance < WORTH_SHOWING || parts.into_iter().all(|energy| energy.abs() <= no_energy);
        if verbose || !is_balanced {
            let [loads, supports, contact] = parts.map(|e| shown.moment(e));
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

fn mesh_and_materials(r: &Results, lines: &mut Lines) {
    lines.line("mesh", sizes(&r.mesh));
    for material in &r.materials {
        let of = if material.surfaces.is_empty() {
            "the whole body".to_owned()
        } else {
            quote::names(material.surfaces.iter().map(String::as_str))
        };
        lines.line("material", format!("{of}: {}, plane {}", moduli(material), material.plane));
    }
}

fn times(s: &Seconds) -> String {
    let mut steps = vec![
        ("read", s.read),
        ("assemble", s.assemble),
        ("solve", s.solve),
        ("certify", s.certify),
    ];
    // A report is finished before it is written.
    if s.write > 0.0 {
        steps.push(("write", s.write));
    }
    let step = |(name, seconds): (&str, f64)| format!("{name} {}", time(seconds));
    steps.into_iter().map(step).collect::<Vec<_>>().join(", ")
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
    lines.line(
        "problem",
        match case {
            Some((case, _)) => format!(
                "that of {}: its mesh, materials, supports, loads and obstacles",
                quote::path(case)
            ),
            None => "that of the numbers in this file; --case CASE.toml compares them with a case"
                .to_owned(),
        },
    );
    let relative = 100.0 * header.bound / proof.norm;
    let size = if relative.is_finite() {
        format!(", {} % of |v|_a", numbers::short(relative, 2))
    } else {
        String::new()
    };
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
    lines.line(
        "rigorous",
        match reservation {
            Some(reservation) => format!("with a reservation: {reservation}{problem}"),
            None => format!("yes, rounding included{problem}"),
        },
    );
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

/// The summary of a case that was only checked.
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

/// The table of a case on finer and finer meshes.
pub fn studied(case: &Case, studies: &[Study], files: &[PathBuf]) -> String {
    let tables: Vec<String> = studies.iter().map(Study::table).collect();
    format!("{}\n\n{}\nwritten: {}\n", quote::line(&case.title), tables.join("\n"), written(files))
}

/// The table of a sweep.
pub fn swept(sweep: &Sweep, files: &[PathBuf]) -> String {
    format!("{}\n\n{}\nwritten: {}\n", quote::line(&sweep.title), sweep.table(), written(files))
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
    let error = method.forward_error;
    let error =
        if error.is_finite() { format!("{error:.0e} (energy norm)") } else { "unknown".to_owned() };
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
    let (motion, unit) = match (play.about, play.along) {
        (Some(about), _) => (format!("turn about {}", vector(about)), " rad"),
        (_, Some(along)) => (format!("move along {}", vector(along)), &*shown.length),
        _ => return String::new(),
    };
    let end = |end: f64| format!("{}{unit}", short(end));
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

/// Four significant digits.
fn short(x: f64) -> String {
    numbers::short(x, 4)
}

fn time(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.1} ms", 1e3 * seconds) } else { format!("{seconds:.2} s") }
}

/// folder/{a, b, c}
fn written(files: &[PathBuf]) -> String {
    let folder = files.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
    let names: Vec<_> =
        files.iter().flat_map(|f| f.file_name()).map(|n| n.to_string_lossy()).collect();
    format!("{}: {}", quote::path(folder), names.join(", "))
}
