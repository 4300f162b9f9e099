//! The results of the whole body: forces, moments and energies of a slice one unit thick times the thickness; in a body of revolution
//! energies, forces along the axis and contact forces of a radian times 2 pi. Radial forces, which cancel all round, stay those of a
//! radian.

use std::f64::consts::TAU;

use super::solution::{Quantities, Solution};
use super::{ContactBoundary, EnergyBalance};
use crate::kernel::ball::up;
use crate::proof::enclosure::Enclosure;
use crate::proof::intervals::{Intervals, Range};

/// By what the results of the whole are larger.
pub(crate) struct Times {
    /// Energies, moments, contact forces and friction.
    pub(crate) all: f64,
    /// The components of forces.
    pub(crate) force: [f64; 2],
}

impl Times {
    /// The factors of a body of this thickness.
    pub(crate) fn thickness(thickness: f64) -> Times {
        Times { all: thickness, force: [thickness; 2] }
    }

    fn force<'f>(&self, forces: impl IntoIterator<Item = &'f mut [f64; 2]>) {
        for force in forces {
            (0..2).for_each(|c| force[c] *= self.force[c]);
        }
    }

    pub(crate) fn quantities(&self, q: &mut Quantities) {
        let numbers = [&mut q.energy, &mut q.elastic_energy, &mut q.work, &mut q.contact_force];
        numbers.into_iter().for_each(|number| *number *= self.all);
        self.force(q.reactions.values_mut().chain([&mut q.contact_resultant]));
    }

    pub(crate) fn boundaries(&self, boundaries: &mut [ContactBoundary]) {
        for part in boundaries {
            [&mut part.force, &mut part.moment].into_iter().for_each(|number| *number *= self.all);
            self.force([&mut part.resultant]);
            if let Some(friction) = &mut part.friction {
                friction.shear *= self.all;
                friction.dissipated *= self.all;
            }
        }
    }

    pub(crate) fn balance(&self, b: &mut EnergyBalance) {
        let energies = [&mut b.strain, &mut b.loads, &mut b.supports, &mut b.contact];
        energies.into_iter().for_each(|energy| *energy *= self.all);
    }

    /// Multiplies intervals, by a product that is rounded outwards.
    pub(crate) fn intervals(&self, of: &mut Intervals, product: impl Fn(Range, f64) -> Range) {
        of.energy = product(of.energy, self.all);
        for part in &mut of.contact {
            part.force = product(part.force, self.all);
        }
        let resultants = of.contact.iter_mut().map(|part| &mut part.resultant);
        for force in resultants.chain(of.reactions.values_mut()) {
            (0..2).for_each(|c| force[c] = product(force[c], self.force[c]));
        }
    }
}

/// A solution with the results of a radian as one with those of the whole revolution.
pub(super) fn of_the_whole(mut s: Solution) -> Solution {
    let whole = Times { all: TAU, force: [1.0, TAU] };
    whole.quantities(&mut s.quantities);
    whole.boundaries(&mut s.boundaries);
    whole.balance(&mut s.balance);
    // Moments about the origin of the meridian have no meaning for the body.
    s.quantities.reaction_moments.values_mut().for_each(|moment| *moment = 0.0);
    s.boundaries.iter_mut().for_each(|part| part.moment = 0.0);
    if let Ok(enclosure) = &mut s.enclosure {
        enclosed(enclosure, &whole);
    }
    s
}

/// Multiplies what is said of where the exact solution is.
fn enclosed(enclosure: &mut Enclosure, whole: &Times) {
    // All three are roots of energies.
    for norm in [&mut enclosure.radius, &mut enclosure.pressure] {
        *norm = up(*norm * TAU.sqrt());
    }
    enclosure.if_strained *= TAU.sqrt();
    let product = |range, factor: f64| if factor == 1.0 { range } else { times(range) };
    whole.intervals(&mut enclosure.intervals, product);
}

/// 2 pi times an interval, rounded outwards: the double is off by less than half a unit.
fn times([low, high]: Range) -> Range {
    let off = |end: f64| 4.0 * f64::EPSILON * (TAU * end).abs();
    [TAU * low - off(low), TAU * high + off(high)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norms_of_the_whole_are_those_of_a_radian_times_one_root() {
        let interval = [1.0, 2.0];
        let mut enclosure = Enclosure {
            kappa: 0.5,
            radius: 1e-9,
            relative: Some(1e-8),
            hardly_strains: false,
            if_strained: 3.0,
            pressure: 2e-9,
            nodes: vec![1e-10],
            intervals: Intervals {
                energy: interval,
                max_displacement: interval,
                contact: Vec::new(),
                reactions: [("top".to_owned(), [interval; 2])].into(),
            },
            isolation: None,
        };
        enclosed(&mut enclosure, &Times { force: [1.0, TAU], all: TAU });
        let root = TAU.sqrt();
        let norms = [enclosure.radius, enclosure.pressure, enclosure.if_strained];
        for (norm, before) in norms.into_iter().zip([1e-9, 2e-9, 3.0]) {
            assert!(norm >= root * before && norm <= root * before * (1.0 + 1e-14), "{norm}");
        }
        // What is relative, and lengths, are the same.
        assert_eq!((enclosure.relative, &enclosure.nodes[..]), (Some(1e-8), &[1e-10][..]));
        let Intervals { energy, max_displacement, reactions, .. } = enclosure.intervals;
        assert_eq!((energy, max_displacement), (times(interval), interval));
        assert_eq!(reactions["top"], [interval, times(interval)]);
    }

    #[test]
    fn an_interval_of_the_whole_contains_twice_pi_of_that_of_a_radian() {
        let [low, high] = times([-1.0, 3.0]);
        assert!(low < -TAU && high > 3.0 * TAU);
        assert!(high - 3.0 * TAU < 1e-13 && -TAU - low < 1e-13);
        assert_eq!(times([0.0, 0.0]), [0.0, 0.0]);
    }
}
