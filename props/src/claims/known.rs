//! The exact solutions (a), (b) and (c) of docs/theory.md, section 10, with drawn parameters, on drawn meshes: the end of contact
//! lies anywhere on an edge.

use std::f64::consts::PI;
use std::sync::Arc;

use proptest::prelude::*;
use signorini::exact::Exact;
use signorini::exact::{Corner, Kind, Singular, Smooth};
use signorini::kernel::{Material, Plane};
use signorini::model::Degree;
use signorini::model::{Diagonal, Perturbation, Problem, Rectangle, Structured, Trapezoid};
use signorini::solve::{Method, Settings};
use study::Ladder;

/// A solution with its parameters.
#[derive(Clone, Debug)]
pub(super) enum Known {
    /// (a): exponents, c, amplitudes.
    Smooth([f64; 5]),
    /// (b): c, amplitude.
    Singular([f64; 2]),
    /// (c): omega over pi.
    Corner(f64),
}

/// A solution, the mesh and the element.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub(super) known: Known,
    pub(super) lambda: f64,
    /// Cells a side.
    pub(super) n: usize,
    pub(super) moved: Option<u64>,
    pub(super) degree: Degree,
}

/// All three, P1 and P2.
pub(super) const CLASSES: [&str; 6] =
    ["smooth", "singular", "corner", "smooth, P2", "singular, P2", "corner, P2"];

pub(super) fn samples() -> impl Strategy<Value = Sample> {
    let between = |low: f64, high: f64| {
        (0_u32..=1000).prop_map(move |k| low + (high - low) * f64::from(k) / 1000.0)
    };
    let smooth = (
        between(3.0, 5.0),
        between(2.0, 4.0),
        between(0.05, 0.95),
        between(0.5, 20.0),
        between(0.5, 20.0),
    );
    let known = prop_oneof![
        smooth.prop_map(|(k, m, c, p, q)| Known::Smooth([k, m, c, p, q])),
        (between(0.02, 0.98), between(0.1, 10.0)).prop_map(|(c, a)| Known::Singular([c, a])),
        between(0.52, 0.95).prop_map(Known::Corner),
    ];
    let degree = prop::sample::select(&[Degree::One, Degree::Two]);
    (known, between(0.0, 5.0), 2_usize..=10, prop::option::of(0_u64..1000), degree)
        .prop_map(|(known, lambda, n, moved, degree)| Sample { known, lambda, n, moved, degree })
}

impl Sample {
    /// The solution on finer and finer meshes, of which this one is the first.
    pub(super) fn ladder(&self) -> Option<Ladder> {
        let material = Material::lame(self.lambda, 1.0, Plane::Strain);
        let n = self.n;
        let square = Rectangle { width: 1.0, height: 1.0, nx: n, ny: n, diagonal: Diagonal::Right };
        let square = Structured::Rectangle(square);
        let (d, t) = (Kind::Displacement, Kind::Traction);
        let (solution, body, [left, right, top]): (Exact, _, _) = match self.known {
            Known::Smooth([k, m, c, ap, aq]) => {
                let solution = Smooth { material, c, k, m, ap, aq, gap: Vec::new() };
                (Arc::new(solution), square, [t, t, d])
            }
            Known::Singular([c, amplitude]) => {
                (Arc::new(Singular { material, c, amplitude }), square, [d; 3])
            }
            Known::Corner(omega) => {
                let wedge = Trapezoid { omega: omega * PI, n };
                let solution = Corner::new(material, omega * PI)?;
                (Arc::new(solution), Structured::Trapezoid(wedge), [t, d, d])
            }
        };
        let kinds = [("left", left), ("right", right), ("top", top), ("bottom", Kind::Contact)];
        Some(Ladder {
            solution,
            kinds: kinds.map(|(name, kind)| (name.to_owned(), kind)).into(),
            body,
            perturbation: self.moved.map(|seed| Perturbation { amount: 0.2, seed }),
            method: self.method(),
            settings: Settings::default(),
        })
    }

    /// The solution, and the problem that it solves.
    pub(super) fn problem(&self) -> Option<(Exact, Problem)> {
        let ladder = self.ladder()?;
        let problem = ladder.problem(0).ok()?;
        Some((ladder.solution, problem))
    }

    pub(super) fn method(&self) -> Method {
        Method { degree: self.degree, ..Method::default() }
    }

    /// The end of contact with stresses of the other sign: a tension where there is pressure.
    pub(super) fn under_tension(&self) -> Option<Sample> {
        let Known::Singular([c, amplitude]) = self.known else { return None };
        Some(Sample { known: Known::Singular([c, -amplitude]), ..self.clone() })
    }

    pub(super) fn class(&self) -> &'static str {
        let of_p1 = match self.known {
            Known::Smooth(_) => 0,
            Known::Singular(_) => 1,
            Known::Corner(_) => 2,
        };
        CLASSES[of_p1 + if self.degree == Degree::One { 0 } else { 3 }]
    }
}
