//! The content of a picture as data: that of a solved case, and by how much it is magnified.

use super::contact::{FURTHEST_WHERE_BENT, turns};
use super::draw::{Point, distance, moved, quantile, short};
use super::loads;
use crate::certificates::quantities::Zone;
use crate::io::case::{Case, Measure};
use crate::io::numbers::round_below;
use crate::io::result::{ContinuousCertificate, Results};
use crate::model::mesh::ROUNDED;
use crate::model::tree::Bounds;
use crate::model::{BoundaryEdge, Condition, Degree, Obstacle};
use crate::quote;
use crate::results::solution::{ContactEdge, ContactPoint};
use crate::results::{ContactBoundary, Solution, Verdict};

/// The content of the picture of a solved case.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    /// The headline, and a line below it.
    pub(super) title: String,
    pub(super) subtitle: String,
    /// The vertices of the undeformed body, and their displacements.
    pub(super) points: Vec<Point>,
    pub(super) displacement: Vec<Point>,
    /// The triangles by their vertices, and the von Mises stress in each.
    pub(super) triangles: Vec<[usize; 3]>,
    pub(super) von_mises: Vec<f64>,
    /// The units of stress and of length, if the case has units.
    pub(super) units: Option<[String; 2]>,
    /// The amount by which displacement and gap are magnified; chosen here if it is not given.
    pub(super) stretch: Option<f64>,
    /// The largest initial gap, or overlap, between bodies where they press on each other: magnifying the deformation alone makes it
    /// seen where there is none left.
    pub(super) apart: f64,
    /// The edges between triangles of different materials.
    pub(super) interfaces: Vec<[usize; 2]>,
    /// The edges of the whole boundary, from start to end, the body on their left.
    pub(super) outline: Vec<[usize; 2]>,
    pub(super) contact: Vec<ContactSurface>,
    /// The supports of the body: lines along its boundary, or single points, each with whether both components are held.
    pub(super) supports: Vec<(Vec<usize>, bool)>,
    /// Loads and prescribed displacements: at a point of the body, with its direction and its size beside the largest of its kind.
    pub(super) loads: Vec<Load>,
    /// Where the largest von Mises stress is, as a point of the body.
    pub(super) most_stressed: Option<usize>,
    /// The body is one of revolution about x = 0: its other half is drawn, too.
    pub(super) of_revolution: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Load {
    pub(super) at: usize,
    /// The arrow as a share of the longest one.
    pub(super) arrow: Point,
    /// The way of a prescribed displacement; else a force.
    pub(super) is_motion: bool,
}

#[derive(Clone, Debug)]
pub(super) struct ContactSurface {
    pub(super) name: String,
    /// The obstacle has a shape of its own (a plane, a circle), which a magnified gap would bend.
    pub(super) rigid: bool,
    /// There is friction.
    pub(super) rough: bool,
    /// Its connected parts with the sizes of the shear stress, without the gap of a pair; each from start to end, the body on its left. Where the pressure jumps there are two samples at
    /// one place.
    pub(super) parts: Vec<Vec<ContactPoint>>,
    /// The zones of its certificate, if it has one.
    pub(super) zones: Option<Vec<Zone>>,
    /// The certificate has a reservation, or is one of another problem than is meant.
    pub(super) reserved: bool,
}

/// A pressure this many times that of all but this share of the length in contact is a spike.
const SPIKES: f64 = 3.0;
const SPIKE: f64 = 1.0 / 50.0;

/// An obstacle is bent if it is drawn off its place by more than this share of the body's size.
const BENT: f64 = 0.01;

impl ContactSurface {
    /// The highest pressure that is drawn: below the peak where most of the plot would otherwise be spent on next to nothing of the
    /// boundary, as at a corner, where the pressure tells of the mesh.
    pub(super) fn top(&self) -> f64 {
        let parts = self.parts.iter().flat_map(|part| part.windows(2));
        let mut pressed: Vec<(f64, f64)> = parts
            .map(|pair| (pair[0].pressure.max(pair[1].pressure), pair[1].arc - pair[0].arc))
            .filter(|(pressure, length)| *pressure > 0.0 && *length > 0.0)
            .collect();
        let peak = self.peak().map_or(0.0, |peak| peak.pressure);
        match quantile(&mut pressed, SPIKE) {
            Some(quantile) if peak > SPIKES * quantile => quantile,
            _ => peak,
        }
    }

    /// The sample with the largest pressure, if that is positive.
    pub(super) fn peak(&self) -> Option<&ContactPoint> {
        let largest = self.parts.iter().flatten().max_by(|a, b| a.pressure.total_cmp(&b.pressure));
        largest.filter(|sample| sample.pressure > 0.0)
    }
}

impl Scene {
    /// The content of the picture of a solved case. A quadratic triangle is drawn as four, its edges as two.
    pub(crate) fn of(case: &Case, s: &Solution, results: &Results) -> Scene {
        let mesh = &case.problem.mesh;
        let linear = s.degree == Degree::One;
        let parts = |edge: BoundaryEdge| {
            let [a, b] = mesh.ends(edge);
            if linear {
                return vec![[a, b]];
            }
            let middle = s.elements[6 * edge.triangle + 3 + edge.local];
            vec![[a, middle], [middle, b]]
        };
        let quarters =
            |&[a, b, c, d, e, f]: &[usize; 6]| [[a, f, e], [f, b, d], [e, d, c], [d, e, f]];
        let (triangles, von_mises) = if linear {
            (mesh.triangles().to_vec(), s.von_mises.clone())
        } else {
            let elements = s.elements.as_chunks().0.iter();
            (
                elements.flat_map(quarters).collect(),
                s.von_mises.iter().flat_map(|&v| [v; 4]).collect(),
            )
        };
        let length =
            case.units.as_ref().map_or(String::new(), |units| format!(" {}", units.length));
        let not_proved = match s.verdict {
            Verdict::Proved => "",
            Verdict::NotProved(_) => "NOT PROVED (result.json says why): ",
        };
        Scene {
            title: case.title.clone(),
            subtitle: format!(
                "{not_proved}displacement up to {}{length}; {} {} triangles, {} unknowns",
                short(s.quantities.max_displacement),
                mesh.triangles().len(),
                if linear { "linear" } else { "quadratic" },
                2 * s.nodes.len(),
            ),
            points: s.nodes.clone(),
            displacement: s.displacement.clone(),
            triangles,
            von_mises,
            units: case.units_of([Measure::Stress, Measure::Length]),
            stretch: case.stretch,
            apart: apart(s),
            interfaces: interfaces(case).into_iter().flat_map(parts).collect(),
            outline: mesh.outline().iter().copied().flat_map(parts).collect(),
            contact: contact_surfaces(case, s, results),
            supports: loads::supports(case, s),
            loads: loads::loads(case, s),
            most_stressed: results
                .stress
                .as_ref()
                .and_then(|stress| s.nodes.iter().position(|&place| place == stress.von_mises.at)),
            of_revolution: case.problem.material.are_of_revolution(),
        }
    }

    /// The larger of the body's extents along x and y.
    pub(super) fn size(&self) -> f64 {
        Bounds::around(self.points.iter().copied()).size()
    }

    /// Returns whether an obstacle with a shape of its own would be drawn with another one where the gap is magnified: a flat
    /// floor below a round body as a hill.
    fn bends(&self, factor: f64) -> bool {
        let (size, rigid) = (self.size(), |surface: &&ContactSurface| surface.rigid);
        self.contact.iter().filter(rigid).flat_map(|surface| &surface.parts).any(|part| {
            let shown = |s: &&ContactPoint| (factor * s.gap).abs() <= FURTHEST_WHERE_BENT * size;
            let most = part.iter().filter(shown).fold(0.0, |most: f64, s| most.max(s.gap.abs()));
            turns(part) && (factor - 1.0).abs() * most > BENT * size
        })
    }

    pub(super) fn deformed(&self, factor: f64) -> Vec<Point> {
        self.points.iter().zip(&self.displacement).map(|(&x, &u)| moved(x, u, factor)).collect()
    }

    pub(crate) fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Returns whether the body moves by more than rounding.
    pub(super) fn moves(&self) -> bool {
        self.largest_move() > 1e-12 * self.size()
    }

    fn largest_move(&self) -> f64 {
        self.displacement.iter().map(|&u| distance(u, [0.0; 2])).fold(0.0, f64::max)
    }

    /// The amount by which displacement and gap are magnified. True scale if the largest displacement is
    /// between 1% and 30% of the body, so that one sees it and the body keeps its shape, or if it is mere rounding; else the
    /// largest round factor that keeps it within 10%, and what is left between bodies that touch within [`HARDLY_SEEN`].
    pub(super) fn magnification(&self) -> f64 {
        if let Some(factor) = self.stretch {
            return factor;
        }
        let part = self.largest_move() / self.size();
        if (0.01..=0.3).contains(&part) || !self.moves() {
            return 1.0;
        }
        let most = 1.0 + HARDLY_SEEN * self.size() / self.apart;
        let factor = round_below((0.1 / part).min(most));
        if self.bends(factor) { 1.0 } else { factor }
    }
}

/// Takes the wave out of a pressure of quadratic triangles that rises and falls from node to node: each value inside a stretch of
/// contact becomes the mean of itself and of the mean of its neighbours, but the largest, which the summary names.
fn smooth(part: &mut [ContactPoint]) {
    let before = part.to_vec();
    let largest = before.iter().map(|sample| sample.pressure).fold(0.0, f64::max);
    for (i, sample) in part.iter_mut().enumerate() {
        let is_other = |other: &&ContactPoint| other.arc != before[i].arc;
        let neighbours =
            [before[..i].iter().rev().find(is_other), before[i..].iter().find(is_other)];
        if let [Some(a), Some(b)] = neighbours
            && a.pressure.min(b.pressure).min(sample.pressure) > 0.0
            && sample.pressure < largest
        {
            sample.pressure = sample.pressure / 2.0 + (a.pressure + b.pressure) / 4.0;
        }
    }
}

/// A share of the body's size that does not strike the eye: about the width of a line.
const HARDLY_SEEN: f64 = 0.002;

/// The largest initial distance of bodies where they press on each other.
fn apart(s: &Solution) -> f64 {
    let between = s.contact.iter().filter(|edge| edge.partner.is_some());
    let points = between.flat_map(|edge| &edge.points);
    let pressed = points.filter(|point| point.pressure > 0.0);
    pressed.map(|point| point.gap.abs()).fold(0.0, f64::max)
}

fn interfaces(case: &Case) -> Vec<BoundaryEdge> {
    let (mesh, materials) = (&case.problem.mesh, &case.problem.material);
    let mut material_at = vec![None; mesh.edge_count()];
    let mut found = Vec::new();
    for (triangle, edges) in mesh.triangle_edges().iter().enumerate() {
        let material = materials.place_of(triangle);
        for (local, &edge) in edges.iter().enumerate() {
            if material_at[edge].replace(material).is_some_and(|other| other != material) {
                found.push(BoundaryEdge { triangle, local });
            }
        }
    }
    found
}

/// The contact boundaries by their connected parts, those of pairs on the first body and without an obstacle. A pressure that is mere
/// rounding is none.
fn contact_surfaces(case: &Case, s: &Solution, results: &Results) -> Vec<ContactSurface> {
    let certificate = results.certificate.as_ref().and_then(|c| c.continuous.as_ref());
    let proved = certificate.filter(|certificate| certificate.bound.is_some());
    let mut surfaces: Vec<ContactSurface> = Vec::new();
    for edges in s.contact.chunk_by(|a, b| names(a) == names(b)) {
        let is_this =
            |part: &&ContactBoundary| names(&edges[0]) == (&part.boundary, part.partner.as_deref());
        // The second side of a pair has no entry of its own.
        let Some(part) = results.contact.iter().find(is_this) else { continue };
        let (name, presses) = (&part.boundary, results.is_in_contact(part));
        let of_obstacle = part.partner.is_none();
        let sample = |p: &ContactPoint| ContactPoint {
            gap: if of_obstacle { p.gap } else { f64::INFINITY },
            pressure: if presses { p.pressure } else { 0.0 },
            shear: p.shear.abs(),
            ..*p
        };
        let mut parts: Vec<Vec<ContactPoint>> = edges
            .chunk_by(|a, b| meet(a.points.last(), b.points.first()))
            .map(|part| part.iter().flat_map(|edge| &edge.points).map(sample).collect())
            .collect();
        if s.degree == Degree::Two {
            parts.iter_mut().for_each(|part| smooth(part));
        }
        let zones = |c: &ContinuousCertificate| {
            c.zones.iter().filter(|zone| zone.boundary == *name).cloned().collect()
        };
        let proved = proved.filter(|_| of_obstacle);
        surfaces.push(ContactSurface {
            name: part.label(),
            rigid: matches!(
                case.problem.conditions.get(name),
                Some(Condition::Obstacle(_, Obstacle::Plane { .. } | Obstacle::Circle { .. }))
            ),
            rough: part.friction.is_some(),
            parts,
            zones: proved.map(zones),
            reserved: proved.is_some_and(|c| !c.rigorous || c.problem.is_some()),
        });
    }
    surfaces.sort_by(|a, b| quote::natural(&a.name, &b.name));
    surfaces
}

/// The boundary that an edge is of, and the other one of a pair.
fn names(edge: &ContactEdge) -> (&str, Option<&str>) {
    (&edge.boundary, edge.partner.as_deref())
}

/// Returns whether the end of one edge and the start of the next are one place, up to rounding.
fn meet(end: Option<&ContactPoint>, start: Option<&ContactPoint>) -> bool {
    let [Some([x, y]), Some([p, q])] = [end, start].map(|p| p.map(|p| p.place)) else {
        return false;
    };
    (x - p).hypot(y - q) <= ROUNDED * (x.hypot(y) + p.hypot(q))
}
