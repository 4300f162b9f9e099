//! From the units that a problem is solved in back to those of its case: every number of a solution times the power of two
//! that its quantity has. Numbers that leave the range of doubles on the way are an error, not numbers.

use std::f64::consts::SQRT_2;

use super::answers::{ContactBoundary, EnergyBalance};
use super::enclosure::{Certificate, Enclosure, Unproved};
use super::intervals::{ContactIntervals, Intervals, Range};
use super::solution::{ContactValues, GammaReport, Quantities, Solution};
use super::{Gamma0, Method, Outline, SolveError};
use crate::fem::contact_line::{Coercivity, Gamma};
use crate::fem::units::{Units, scaled};
use crate::kernel::Stress;

impl Method {
    /// The same method for a problem in these units.
    #[must_use]
    pub(super) fn in_units(&self, units: Units) -> Method {
        let gamma0 = match self.gamma0 {
            Gamma0::Value(gamma0) => Gamma0::Value(scaled(gamma0, -units.gamma0())),
            other => other,
        };
        Method { gamma0, ..self.clone() }
    }
}

/// Multiplies numbers by powers of two, and knows whether all numbers of a kind were lost by it.
#[derive(Default)]
struct Back {
    lost: bool,
}

impl Back {
    /// Numbers of one kind.
    fn all<'a>(&mut self, exponent: i32, numbers: impl IntoIterator<Item = &'a mut f64>) {
        let (mut before, mut after) = (0.0, 0.0);
        for x in numbers {
            before = f64::max(before, x.abs());
            *x = scaled(*x, exponent);
            after = f64::max(after, x.abs());
        }
        self.lost |= before > 0.0 && !after.is_normal();
    }

    /// `found`, if nothing was lost.
    fn unless_lost<T>(self, found: T) -> Result<T, SolveError> {
        if self.lost { Err(SolveError::OutOfRange) } else { Ok(found) }
    }

    fn gamma(&mut self, units: Units, report: &mut GammaReport) {
        let GammaReport { gamma, gamma0, coercivity, kappa: _ } = report;
        let Coercivity { constant, typical, limiting_edge } = coercivity;
        let uniform = match gamma {
            Gamma::Uniform(gamma0) => Some(gamma0),
            Gamma::Local(_) => None,
        };
        self.all(units.gamma0(), uniform.into_iter().chain([gamma0]));
        self.all(units.modulus(), [constant, typical]);
        self.all(units.length(), limiting_edge.as_flattened_mut());
    }
}

/// An outline in the units of the case.
///
/// # Errors
/// [`SolveError::OutOfRange`].
pub(super) fn outline(units: Units, mut outline: Outline) -> Result<Outline, SolveError> {
    let mut back = Back::default();
    back.gamma(units, &mut outline.gamma);
    back.unless_lost(outline)
}

/// A solution in the units of the case.
///
/// # Errors
/// [`SolveError::OutOfRange`].
pub(super) fn solution(units: Units, mut solution: Solution) -> Result<Solution, SolveError> {
    let mut back = Back::default();
    back.gamma(units, &mut solution.gamma);
    let Solution {
        nodes,
        displacement,
        stress,
        von_mises,
        contact,
        enclosure,
        quantities,
        boundaries,
        balance,
        largest_strain,
        ..
    } = &mut solution;
    for (tensor, zz) in stress {
        *tensor = Stress::new(tensor.components().map(|s| scaled(s, units.stress())));
        *zz = scaled(*zz, units.stress());
    }
    let (mut lengths, mut displacements, mut stresses) = (vec![], vec![], vec![]);
    let (mut forces, mut moments) = (vec![], vec![]);
    lengths.extend(nodes.as_flattened_mut());
    displacements.extend(displacement.as_flattened_mut());
    stresses.extend(von_mises);
    for point in contact.iter_mut().flat_map(|edge| &mut edge.points) {
        let ContactValues { arc, u_n, gap, sigma_n, lambda, pressure, node: _, direction: _ } =
            point;
        lengths.push(arc);
        displacements.extend([u_n, gap]);
        stresses.extend([sigma_n, lambda, pressure]);
    }
    let Quantities {
        energy,
        work,
        max_displacement,
        contact_force,
        contact_resultant,
        contact_length,
        peak_pressure,
        reactions,
        reaction_moments,
    } = quantities;
    displacements.push(max_displacement);
    lengths.push(contact_length);
    stresses.push(peak_pressure);
    forces.push(contact_force);
    forces.extend(contact_resultant);
    forces.extend(reactions.values_mut().flatten());
    moments.extend(reaction_moments.values_mut());
    for boundary in boundaries {
        let ContactBoundary {
            force,
            resultant,
            moment,
            length,
            stretches,
            peak_pressure,
            peak_at,
            penetration,
            penetration_at,
            boundary: _,
        } = boundary;
        forces.push(force);
        forces.extend(resultant);
        moments.push(moment);
        lengths.push(length);
        lengths.extend(stretches.as_flattened_mut().as_flattened_mut());
        lengths.extend(peak_at.iter_mut().chain(penetration_at));
        stresses.push(peak_pressure);
        displacements.push(penetration);
    }
    let EnergyBalance { strain, loads, supports, contact, imbalance: _ } = balance;
    back.all(units.length(), lengths);
    back.all(units.displacement(), displacements);
    back.all(units.stress(), stresses);
    back.all(units.force(), forces);
    back.all(units.moment(), moments);
    back.all(units.energy(), [energy, work, strain, loads, supports, contact]);
    back.all(units.strain(), [largest_strain]);
    *enclosure = certificate(units, enclosure.clone());
    back.unless_lost(solution)
}

/// An upper bound, times 2^exponent.
fn up(bound: f64, exponent: i32) -> f64 {
    let there = scaled(bound, exponent);
    if scaled(there, -exponent) < bound { there.next_up() } else { there }
}

/// An upper bound of an energy norm, the root of an energy.
fn up_norm(bound: f64, units: Units) -> f64 {
    let exponent = units.energy();
    let odd = exponent.rem_euclid(2) == 1;
    // This constant is above the root of 2.
    let bound = if odd { (bound * SQRT_2).next_up() } else { bound };
    up(bound, exponent.div_euclid(2))
}

fn range([low, high]: Range, exponent: i32) -> Range {
    [-up(-low, exponent), up(high, exponent)]
}

fn certificate(units: Units, found: Certificate) -> Certificate {
    let Enclosure { kappa, radius, relative, pressure, nodes, intervals } = found?;
    let Intervals { energy, max_displacement, contact, reactions } = intervals;
    let force = |interval: Range| range(interval, units.force());
    let of_contact = |ContactIntervals { boundary, force: f, resultant }| ContactIntervals {
        boundary,
        force: force(f),
        resultant: resultant.map(force),
    };
    let intervals = Intervals {
        energy: range(energy, units.energy()),
        max_displacement: range(max_displacement, units.displacement()),
        contact: contact.into_iter().map(of_contact).collect(),
        reactions: reactions.into_iter().map(|(name, r)| (name, r.map(force))).collect(),
    };
    let [radius, pressure] = [radius, pressure].map(|bound| up_norm(bound, units));
    let nodes: Vec<f64> = nodes.into_iter().map(|n| up(n, units.displacement())).collect();
    let bounds = nodes.iter().chain([&radius, &pressure]);
    if !(intervals.are_finite() && bounds.into_iter().all(|b| b.is_finite())) {
        return Err(Unproved::OutOfRange);
    }
    Ok(Enclosure { kappa, radius, relative, pressure, nodes, intervals })
}
