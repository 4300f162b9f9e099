//! How fast the contact solve is: beside one linear elastic solve, beside other codes, beside the machine's limits.
//!
//! ```text
//! cargo bench --bench speed                         our own tables
//! cargo bench --bench speed -- --peers              all of docs/speed.md
//! cargo bench --bench speed -- --large              squares with up to 2 10^6 unknowns, too
//! cargo bench --bench speed -- --huge               a square with 10^7 unknowns alone, printed: some 20 GB
//! cargo bench --bench speed -- --bodies             the table of bodies alone, printed
//! cargo bench --bench speed -- --quick              small sizes, nothing written: does it run?
//! ```
//!
//! Prints Markdown, and writes it to docs/speed.md with docs/speed.svg. Times are minima of runs that take turns; memory is
//! the peak of a process that does nothing else.

#![allow(missing_docs, reason = "a program")]

mod child;
mod figure;
mod limits;
mod own;
mod peers;
mod problem;
mod provenance;
mod table;

use std::fs;
use std::path::Path;

use problem::Size;

/// What the command line asks for.
struct Plan {
    quick: bool,
    peers: bool,
    large: bool,
}

impl Plan {
    /// The most cells along a side of a square, for P1 and P2.
    fn most(&self) -> [usize; 2] {
        if self.quick { [64, 64] } else { [512, 256] }
    }

    fn repetitions(&self) -> usize {
        if self.quick { 2 } else { 5 }
    }

    /// Those of other codes, which start slowly.
    fn peer_repetitions(&self) -> usize {
        if self.quick { 1 } else { 2 }
    }

    /// The size at which details are shown.
    fn detail(&self) -> usize {
        if self.quick { 32 } else { 256 }
    }

    fn peer_bodies(&self) -> &'static [(&'static str, usize)] {
        if self.quick {
            &[("square-16", 1), ("square-16", 2), ("disk", 1)]
        } else {
            &[
                ("square-64", 1),
                ("square-128", 1),
                ("square-256", 1),
                ("strip", 1),
                ("beam", 1),
                ("graded", 1),
                ("disk", 1),
                ("square-128", 2),
                ("strip", 2),
                ("beam", 2),
                ("graded", 2),
            ]
        }
    }
}

const LARGE: [Size; 2] = [Size { degree: 1, n: 1024 }, Size { degree: 2, n: 512 }];

const HUGE: [Size; 1] = [Size { degree: 2, n: 1118 }];

fn main() {
    // Cargo adds --bench.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    if arguments.first().is_some_and(|a| a == child::FLAG) {
        return child::run(&arguments[1..]);
    }
    let known = ["--quick", "--peers", "--large", "--bodies", "--huge"];
    if let Some(unknown) = arguments.iter().find(|a| !known.contains(&a.as_str())) {
        eprintln!("unknown argument {unknown}; expected {}", known.join(", "));
        std::process::exit(2);
    }
    let has = |name: &str| arguments.iter().any(|a| a == name);
    let plan = Plan { quick: has("--quick"), peers: has("--peers"), large: has("--large") };
    if has("--huge") {
        return print!("{}", own::large(&HUGE));
    }
    let [linear, quadratic] = plan.most();
    let measure = || -> Vec<own::Measured> {
        let bodies = own::bodies(linear, quadratic);
        let one = |(name, degree): (String, usize)| own::measure(&name, degree, plan.repetitions());
        bodies.into_iter().map(one).collect()
    };
    if has("--bodies") {
        return print!("{}", own::ratio_table(&measure()));
    }
    let others = provenance::Others::start();
    let own = measure();
    let mut text = vec![
        own::ratio_table(&own),
        own::phases(plan.detail(), plan.repetitions()),
        limits::table_of_limits(plan.detail(), plan.repetitions(), &own),
        limits::LEFT_OUT.to_owned(),
    ];
    let rivals = plan.peers.then(|| peers::measure(plan.peer_bodies(), plan.peer_repetitions()));
    text.push(match &rivals {
        Some(rivals) => peers::tables(rivals),
        None => "## Other codes\n\nNot measured in this run: `--peers` does.\n".to_owned(),
    });
    let beside = plan.peers.then(peers::two_bodies);
    text.push(own::two_bodies(beside.as_deref().unwrap_or("GetFEM beside it: with `--peers`.")));
    text.push(if plan.large { own::large(&LARGE) } else { own::NOT_LARGE.to_owned() });
    text.insert(0, provenance::head(&arguments, others.share()));
    let text = text.join("\n");
    print!("{text}");
    if !plan.quick {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
        let figure = figure::draw(&own, rivals.as_deref().unwrap_or(&[]));
        fs::write(docs.join("speed.md"), text).expect("docs/ is writable");
        fs::write(docs.join("speed.svg"), figure).expect("docs/ is writable");
    }
}
