//! The results of a body of revolution: energies, forces along the axis and contact forces are those of the whole revolution, 2
//! pi times those of a radian. Radial forces, which cancel all round, stay those of a radian.

use std::f64::consts::TAU;

use super::solution::Solution;
use crate::kernel::ball::up;
use crate::proof::intervals::{Intervals, Range};

/// A solution with the results of a radian as one with those of the whole revolution.
pub(super) fn of_the_whole(mut s: Solution) -> Solution {
    let q = &mut s.quantities;
    for number in [&mut q.energy, &mut q.elastic_energy, &mut q.work, &mut q.contact_force] {
        *number *= TAU;
    }
    q.contact_resultant[1] *= TAU;
    q.reactions.values_mut().for_each(|force| force[1] *= TAU);
    // Moments about the origin of the meridian have no meaning for the body.
    q.reaction_moments.values_mut().for_each(|moment| *moment = 0.0);
    for part in &mut s.boundaries {
        part.force *= TAU;
        part.resultant[1] *= TAU;
        part.moment = 0.0;
    }
    let b = &mut s.balance;
    for number in [&mut b.strain, &mut b.loads, &mut b.supports, &mut b.contact] {
        *number *= TAU;
    }
    if let Ok(enclosure) = &mut s.enclosure {
        // Both are roots of energies.
        for norm in [&mut enclosure.radius, &mut enclosure.pressure] {
            *norm = up(*norm * TAU.sqrt());
        }
        enclosure.if_strained *= TAU.sqrt();
        whole(&mut enclosure.intervals);
    }
    s
}

fn whole(of: &mut Intervals) {
    let Intervals { energy, contact, reactions, .. } = of;
    let forces = contact.iter_mut().flat_map(|part| [&mut part.force, &mut part.resultant[1]]);
    let reactions = reactions.values_mut().map(|reaction| &mut reaction[1]);
    forces.chain(reactions).chain([energy]).for_each(|range| *range = times(*range));
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
    fn an_interval_of_the_whole_contains_twice_pi_of_that_of_a_radian() {
        let [low, high] = times([-1.0, 3.0]);
        assert!(low < -TAU && high > 3.0 * TAU);
        assert!(high - 3.0 * TAU < 1e-13 && -TAU - low < 1e-13);
        assert_eq!(times([0.0, 0.0]), [0.0, 0.0]);
    }
}
