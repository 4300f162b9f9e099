//! The picture of a solved case.

use std::collections::BTreeMap;

use super::{ContactSample, ContactSurface, Scene, picture};
use crate::fem::Degree;
use crate::io::case::Case;
use crate::io::finite::NotFinite;
use crate::io::numbers::short;
use crate::io::result::{CertifiedZone, Results};
use crate::solve::{Solution, Verdict};

/// The picture of a solved case.
///
/// # Errors
/// Numbers that are not finite.
pub fn draw(case: &Case, s: &Solution, results: &Results) -> Result<String, NotFinite> {
    let mesh = &case.problem.mesh;
    let ends = mesh.outline().iter().map(|&edge| (edge, mesh.ends(edge)));
    let (triangles, von_mises, outline): (Vec<[usize; 3]>, Vec<f64>, Vec<[usize; 2]>) =
        if s.degree == Degree::One {
            let outline = ends.map(|(_, ends)| ends).collect();
            (mesh.triangles().to_vec(), s.von_mises.clone(), outline)
        } else {
            // A quadratic triangle is drawn as four, its edges as two.
            let (elements, _) = s.elements.as_chunks::<6>();
            let quarters =
                |&[a, b, c, d, e, f]: &[usize; 6]| [[a, f, e], [f, b, d], [e, d, c], [d, e, f]];
            let halves = ends.flat_map(|(edge, [a, b])| {
                let middle = elements[edge.triangle][3 + edge.local];
                [[a, middle], [middle, b]]
            });
            (
                elements.iter().flat_map(quarters).collect(),
                s.von_mises.iter().flat_map(|&v| [v; 4]).collect(),
                halves.collect(),
            )
        };
    let units = case.units.as_ref().map(|units| [units.stress(), units.length.clone()]);
    let shape = if s.degree == Degree::One { "linear" } else { "quadratic" };
    let largest = short(s.quantities.max_displacement, 3);
    let length = units.as_ref().map_or(String::new(), |[_, length]| format!(" {length}"));
    let not_proved = match s.verdict {
        Verdict::Proved => "",
        Verdict::NotProved(_) => "NOT PROVED (result.json says why): ",
    };
    picture(&Scene {
        title: &case.title,
        subtitle: &format!(
            "{not_proved}displacement up to {largest}{length}; {} {shape} triangles, {} unknowns",
            case.problem.mesh.triangles().len(),
            2 * s.nodes.len(),
        ),
        points: &s.nodes,
        displacement: &s.displacement,
        triangles: &triangles,
        von_mises: &von_mises,
        units: units.as_ref().map(|units| units.each_ref().map(String::as_str)),
        stretch: case.stretch,
        interfaces: &interfaces(case, s),
        outline: &outline,
        contact: &contact_surfaces(s, results),
    })
}

/// The edges between triangles of different materials, for P2 in two halves.
fn interfaces(case: &Case, s: &Solution) -> Vec<[usize; 2]> {
    let (mesh, materials) = (&case.problem.mesh, &case.problem.material);
    let mut found = Vec::new();
    if materials.only().is_some() {
        return found;
    }
    let mut material_at = BTreeMap::new();
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let material = materials.place_of(t);
        for i in 0..3 {
            let [a, b] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
            match material_at.insert([a.min(b), a.max(b)], material) {
                Some(other) if other != material && s.degree == Degree::One => found.push([a, b]),
                Some(other) if other != material => {
                    let middle = s.elements[6 * t + 3 + i];
                    found.extend([[a, middle], [middle, b]]);
                }
                _ => {}
            }
        }
    }
    found
}

/// The zones that a certificate proves on a boundary.
fn zones(results: &Results, boundary: &str) -> Option<Vec<CertifiedZone>> {
    let continuous = results.certificate.as_ref()?.continuous.as_ref()?;
    continuous.bound?;
    let of = continuous.zones.iter().filter(|zone| zone.boundary == boundary);
    Some(of.cloned().collect())
}

/// The contact boundaries by their connected parts. A pressure that is mere rounding is none.
fn contact_surfaces(s: &Solution, results: &Results) -> Vec<ContactSurface> {
    let mut surfaces: Vec<ContactSurface> = Vec::new();
    let (mut end, mut presses) = (None, false);
    for edge in &s.contact {
        if surfaces.last().is_none_or(|surface| *surface.name != *edge.boundary) {
            surfaces.push(ContactSurface {
                name: edge.boundary.to_string(),
                parts: Vec::new(),
                zones: zones(results, &edge.boundary),
            });
            end = None;
            let carries = results.contact.iter().find(|part| *part.boundary == *edge.boundary);
            presses = carries.is_some_and(|part| results.is_in_contact(part));
        }
        let samples = edge.points.iter().map(|p| ContactSample {
            arc: p.arc,
            position: s.nodes[p.node],
            normal: p.direction,
            displacement: s.displacement[p.node],
            gap: p.gap,
            pressure: if presses { p.pressure } else { 0.0 },
        });
        let Some(surface) = surfaces.last_mut() else { continue };
        match surface.parts.last_mut() {
            Some(part) if end.is_some() && end == edge.points.first().map(|p| p.node) => {
                part.extend(samples)
            }
            _ => surface.parts.push(samples.collect()),
        }
        end = edge.points.last().map(|p| p.node);
    }
    surfaces
}
