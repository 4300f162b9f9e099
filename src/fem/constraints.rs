//! Gamma_D: which degrees of freedom are prescribed, with what values, and whether they hold the body.
//!
//! Where boundaries meet at a node, displacement wins; two displacements that meet must agree. Prescribed values are
//! interpolated at the nodes.

use std::collections::BTreeMap;

use super::problem::{Condition, DataError, Problem, finite};
use super::rigid::{self, Parts};
use super::space::Space;
use crate::kernel::Element;

/// The prescribed components of the displacement.
#[derive(Clone, Debug)]
pub struct Constraints {
    values: Vec<[Option<f64>; 2]>,
    holders: BTreeMap<String, Vec<(usize, usize)>>,
}

/// Two prescribed values that differ by no more than this share of the largest one agree: expressions that mean the same
/// may differ by their rounding errors.
const AGREEMENT: f64 = 1e-12;

impl Constraints {
    /// The constraints of a problem.
    ///
    /// # Errors
    /// A value that is not finite, two that disagree, or a rigid body motion that stays free.
    pub fn new<E: Element<N, M>, const N: usize, const M: usize>(
        problem: &Problem,
        space: &Space<E, N, M>,
    ) -> Result<Self, DataError> {
        let mut demands: BTreeMap<(usize, usize), Vec<(&str, f64)>> = BTreeMap::new();
        for (name, condition) in &problem.conditions {
            let Condition::Displacement(functions) = condition else { continue };
            for &edge in space.mesh().edges_of(name)? {
                for node in space.edge_nodes(edge) {
                    for (c, function) in functions.iter().enumerate() {
                        let Some(function) = function else { continue };
                        let demand = demands.entry((node, c)).or_default();
                        if demand.last().is_none_or(|(last, _)| last != name) {
                            let what = || format!("[boundary.{name}] displacement[{c}]");
                            let value = finite(&**function, space.nodes()[node], what)?;
                            demand.push((name, value));
                        }
                    }
                }
            }
        }
        let largest = demands.values().flatten().fold(0.0, |max: f64, (_, v)| max.max(v.abs()));
        let mut values = vec![[None; 2]; space.nodes().len()];
        let mut holders: BTreeMap<String, Vec<(usize, usize)>> = BTreeMap::new();
        for ((node, component), demand) in demands {
            let (first, value) = demand[0];
            for &(second, other) in &demand[1..] {
                if !((other - value).abs() <= AGREEMENT * largest) {
                    let [x, y] = space.nodes()[node];
                    let (first, second) = (first.to_owned(), second.to_owned());
                    let values = [value, other];
                    return Err(DataError::Disagree { first, second, x, y, component, values });
                }
            }
            values[node][component] = Some(value);
            holders.entry(first.to_owned()).or_default().push((node, component));
        }
        let motions = rigid::free_motions(&Parts::new(space.mesh()), space, &values);
        if motions.is_empty() {
            Ok(Constraints { values, holders })
        } else {
            Err(DataError::RigidMotion { motions })
        }
    }

    /// The prescribed components at each node.
    pub fn values(&self) -> &[[Option<f64>; 2]] {
        &self.values
    }

    /// The prescribed data as a field, zero where nothing is prescribed.
    pub fn lift(&self) -> Vec<[f64; 2]> {
        self.values.iter().map(|v| v.map(Option::unwrap_or_default)).collect()
    }

    /// The (node, component) pairs that each displacement boundary holds; a pair that two boundaries prescribe counts for
    /// the one that is first in alphabetical order.
    pub fn holders(&self) -> &BTreeMap<String, Vec<(usize, usize)>> {
        &self.holders
    }
}
