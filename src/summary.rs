//! What the command says on the terminal: the result in five seconds.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use signorini::certify::Continuous;
use signorini::io::case::Units;
use signorini::io::certificate::Audit;
use signorini::io::convergence::Study;
use signorini::io::result::{
    Adaptation, ContinuousCertificate, DiscreteCertificate, GammaChoice, NewtonHistory, Results,
};
use signorini::io::sweep::Sweep;
use signorini::io::{Case, numbers};
use signorini::quote;
use signorini::solve::accuracy::ACCEPTABLE;
use signorini::solve::{ContactQuadrature, MethodReport, Outline, RouteName, history};

/// Lines of a name and a text.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn titled(title: &str) -> Self {
        Lines(format!("{}\n", quote::line(title)))
    }

    fn line(&mut self, name: &str, text: impl AsRef<str>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "  {name:<11} {}", text.as_ref());
    }
}

/// Of a solved case, whoever solved it.
pub fn solved(r: &Results, files: &[PathBuf]) -> String {
    let (q, seconds) = (&r.quantities, &r.seconds);
    // P1 has its nodes at the vertices alone.
    let degree = if r.mesh.dofs == 2 * r.mesh.vertices { 1 } else { 2 };
    let mut lines = Lines::titled(&r.title);
    lines.line(
        "mesh",
        sizes(r.mesh.triangles, degree, r.mesh.dofs, r.mesh.contact_edges, r.mesh.h_max),
    );
    lines.line("coercivity", coercivity(&r.gamma));
    lines.line("newton", newton(&r.newton));
    lines.line("", history(&r.newton.residuals));
    if let Some(method) = &r.method {
        lines.line("accuracy", accuracy(method));
        if method.slides > 0 {
            lines.line("", format!(
                "contact holds the body; {} along the obstacles is stopped by nothing: the displacement of least norm is given, friction would be needed to know more",
                count(method.slides, "motion")
            ));
        }
    }
    for material in &r.materials {
        let of = if material.surfaces.is_empty() {
            "the whole body".to_owned()
        } else {
            quote::names(material.surfaces.iter().map(String::as_str))
        };
        let (young, poisson) = (short(material.young), short(material.poisson));
        lines.line(
            "material",
            format!("{of}: E = {young}, nu = {poisson}, plane {}", material.plane),
        );
    }
    let unit = |of: fn(&Units) -> String| {
        r.units.as_ref().map_or(String::new(), |units| format!(" {}", of(units)))
    };
    let (length, stress) = (unit(|units| units.length.clone()), unit(Units::stress));
    let (force, moment) = (unit(Units::force_across), unit(Units::moment_across));
    if r.contact.is_empty() {
        lines.line(
            "contact",
            format!(
                "force {}{force}, length {}{length}, peak pressure {}{stress}",
                short(q.contact_force),
                short(q.contact_length),
                short(q.peak_pressure)
            ),
        );
    }
    for contact in &r.contact {
        lines.line(
            "contact",
            format!(
                "{}: force {} {}{force}, moment {}{moment}, length {}{length}",
                quote::cut(&contact.boundary),
                short(contact.force),
                vector(contact.resultant),
                short(contact.moment),
                short(contact.length)
            ),
        );
        if contact.length > 0.0 {
            let place = |place: [f64; 2]| match place {
                [x, y] if x.is_finite() && y.is_finite() => format!(" at {}", vector(place)),
                // The reference in FEniCSx does not say.
                _ => String::new(),
            };
            let mut words = format!("peak pressure {}{stress}", short(contact.peak_pressure));
            words += &place(contact.peak_at);
            if contact.penetration.is_finite() {
                words += &format!(", penetration {}{length}", short(contact.penetration));
                words += &place(contact.penetration_at);
            }
            lines.line("", words);
        }
    }
    for (i, (boundary, reaction)) in q.reactions.iter().enumerate() {
        let name = if i == 0 { "reactions" } else { "" };
        let turning = match r.reaction_moments.get(boundary) {
            Some(turning) => format!(", moment {}{moment}", short(*turning)),
            None => String::new(),
        };
        let reaction = vector(*reaction);
        lines.line(name, format!("{}: {reaction}{force}{turning}", quote::cut(boundary)));
    }
    lines.line(
        "energy",
        format!(
            "a(u,u) = {}{moment}, L(u) = {}{moment}, largest displacement {}{length}",
            short(q.energy),
            short(q.work),
            short(q.max_displacement)
        ),
    );
    if let Some(balance) = &r.balance {
        lines.line(
            "balance",
            format!(
                "a(u,u) = loads {} + supports {} + contact {}{moment}, relative imbalance {:.0e}",
                short(balance.loads),
                short(balance.supports),
                short(balance.contact),
                balance.imbalance.abs()
            ),
        );
    }
    let certificates = r.certificate.as_ref();
    if let Some(discrete) = certificates.and_then(|c| c.discrete.as_ref()) {
        lines.line("certified", enclosed(discrete));
    }
    if let Some(continuous) = certificates.and_then(|c| c.continuous.as_ref()) {
        distance(continuous, &mut lines);
    }
    if let Some(adapt) = &r.adapt {
        lines.line("adapted", adapted(adapt));
    }
    for remark in &r.remarks {
        lines.line("remark", remark);
    }
    lines.line(
        "time",
        format!(
            "read {}, assemble {}, solve {}, certify {}, write {}",
            time(seconds.read),
            time(seconds.assemble),
            time(seconds.solve),
            time(seconds.certify),
            time(seconds.write)
        ),
    );
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
    lines.line("written", written(files));
    lines.0
}

/// Of a displacement from elsewhere.
pub fn certified(case: &Case, field: &Path, c: &Continuous, files: &[PathBuf]) -> String {
    let mut lines = Lines::titled(&case.title);
    lines.line("field", field.display().to_string());
    let norm = c.proof.norm;
    let size = |bound: f64| {
        let percent = 100.0 * bound / norm;
        if percent.is_finite() {
            format!("{} ({} % of its energy norm)", short(bound), numbers::short(percent, 3))
        } else {
            short(bound)
        }
    };
    let proved = if c.rigorous {
        "proved".to_owned()
    } else {
        format!("with a reservation ({})", c.reason.as_deref().unwrap_or_default())
    };
    lines.line(
        "admissible",
        format!(
            "a displacement that satisfies the conditions is at most {} away (energy norm)",
            short(c.clipping)
        ),
    );
    lines.line("error", format!("at most {} of that one: {proved}", size(c.bound)));
    lines.line("", format!("at most {} as it is", size(c.of_field)));
    lines.line("written", written(files));
    lines.0
}

/// Of a certificate that was verified.
pub fn audited(audit: &Audit) -> String {
    let Audit { header, proof, .. } = audit;
    let mut lines = Lines::titled(&header.title);
    let counts = header.counts;
    lines.line(
        "certificate",
        format!("accepted: {} triangles, {} edges", counts.triangles, counts.edges),
    );
    lines.line("statement", &header.statement);
    let relative = 100.0 * header.bound / proof.norm;
    let size = if relative.is_finite() {
        format!(", {} % of |v|_a", numbers::short(relative, 2))
    } else {
        String::new()
    };
    lines.line("bound", format!("{}{size}", short(header.bound)));
    lines.line(
        "rigorous",
        match &header.reason {
            None if header.rigorous => "yes, rounding included".to_owned(),
            reason => {
                format!("with a reservation: {}", reason.as_deref().unwrap_or("no reason given"))
            }
        },
    );
    lines.0
}

/// How far the solution can be from the exact solution of (8), and whether there is one.
fn enclosed(certificate: &DiscreteCertificate) -> String {
    let reason = certificate.reason.as_deref().unwrap_or_default();
    let one = match (certificate.unique, certificate.radius) {
        (true, _) => "(8) has exactly one solution",
        (false, Some(_)) => "(8) has one solution but for motions along the obstacles",
        (false, None) => "",
    };
    let Some(radius) = certificate.radius else {
        let one = if one.is_empty() { String::new() } else { format!("; {one}") };
        return format!("no: {reason}{one}");
    };
    let size = match certificate.relative {
        Some(relative) => format!("{relative:.0e} of the energy norm"),
        None => short(radius),
    };
    let within = format!("{one}, within {size} of this: proved, rounding included");
    if certificate.relative.is_some_and(|relative| relative > ACCEPTABLE) {
        format!("not to six digits: {within}")
    } else {
        within
    }
}

/// Whether the target was met, and how the bound fell.
fn adapted(adapt: &Adaptation) -> String {
    let percent = |relative: f64| format!("{} %", numbers::short(100.0 * relative, 2));
    let bounds: Vec<String> = adapt.levels.iter().map(|level| percent(level.relative)).collect();
    let verdict = if adapt.met {
        "met"
    } else {
        "not met: the next mesh has more unknowns than adapt.max_unknowns allows"
    };
    format!(
        "target {} {verdict}; {}: {}",
        percent(adapt.target),
        count(adapt.levels.len(), "level"),
        bounds.join(" ")
    )
}

/// How far the solution can be from the true one: as it is, and pushed out of the obstacle, where that is another number.
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
    let proved = if certificate.rigorous {
        ": proved".to_owned()
    } else {
        format!(", with a reservation ({reason})")
    };
    lines.line("error", format!("energy error at most {as_it_is}{proved}"));
    if as_it_is != pushed_out {
        let of = "for the displacement pushed out of the obstacle, as in certificate.json";
        lines.line("", format!("at most {pushed_out} {of}"));
    }
}

/// Of a case that was only checked.
pub fn checked(case: &Case, outline: &Outline) -> String {
    let mesh = &case.problem.mesh;
    let triangles = mesh.triangles().len();
    let h_max = (0..triangles).map(|t| mesh.diameter(t)).fold(0.0, f64::max);
    let degree = case.method.degree.number();
    let mut lines = Lines::titled(&case.title);
    lines.line("mesh", sizes(triangles, degree, 2 * outline.nodes, outline.contact_edges, h_max));
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
    lines.0
}

/// Of a case on finer and finer meshes.
pub fn studied(case: &Case, studies: &[Study], files: &[PathBuf]) -> String {
    let tables: Vec<String> = studies.iter().map(Study::table).collect();
    format!("{}\n\n{}\nwritten: {}\n", quote::line(&case.title), tables.join("\n"), written(files))
}

/// Of a case along some axes.
pub fn swept(sweep: &Sweep, files: &[PathBuf]) -> String {
    format!("{}\n\n{}\nwritten: {}\n", quote::line(&sweep.title), sweep.table(), written(files))
}

fn sizes(triangles: usize, degree: usize, dofs: usize, contact_edges: usize, h: f64) -> String {
    let contact = count(contact_edges, "contact edge");
    format!("{triangles} P{degree} triangles, {dofs} unknowns, {contact}, h = {}", short(h))
}

fn coercivity(gamma: &GammaChoice) -> String {
    let [a, b] = gamma.limiting_edge;
    let verdict = if gamma.kappa < 1.0 { "< 1: coercive" } else { ">= 1: no promise" };
    let truth = match (gamma.true_limit, gamma.true_limiting_edge, &gamma.no_true_limit) {
        (Some(limit), Some([c, d]), _) if [c, d] != [a, b] => {
            format!("; true limit {} at the edge {}-{}", short(limit), vector(c), vector(d))
        }
        (Some(limit), ..) => format!("; true limit {}", short(limit)),
        (None, _, Some(why)) => format!("; true limit not known: {why}"),
        _ => String::new(),
    };
    format!(
        "gamma0 = {}{} (limit {} at the edge {}-{}), kappa = {} {verdict}{truth}",
        if gamma.local { "on each edge its own, from " } else { "" },
        short(gamma.gamma0),
        short(gamma.limit),
        vector(a),
        vector(b),
        short(gamma.kappa)
    )
}

fn newton(newton: &NewtonHistory) -> String {
    format!(
        "{} in {}, {}, relative residual {:.1e}",
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
        RouteName::Twofold => "twofold",
    };
    format!(
        "{route} route, condition number at least {:.0e}, relative error of iteration and rounding {:.0e} (energy norm)",
        method.condition, method.forward_error
    )
}

fn vector([x, y]: [f64; 2]) -> String {
    format!("({}, {})", short(x), short(y))
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
