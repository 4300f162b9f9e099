//! Some pieces of Gamma_C whose springs, were they to pull as well as push, stop every motion that contact stops and supports leave
//! free.

use std::collections::BTreeSet;

use super::solvability::jumps;
use crate::contact::discretization::Discretization;
use crate::linear::dense::dot;
use crate::model::rigid::Parts;

/// As few pieces as hold the body, far apart, chosen one functional after the other: the one that moves most in the motions that those
/// before leave free. `acts` says of a functional of a piece whether it has a spring.
pub(crate) fn holding(d: &Discretization, acts: impl Fn(usize, usize) -> bool) -> BTreeSet<usize> {
    let Some(slides) = &d.slides else { return BTreeSet::new() };
    let parts = Parts::new(d.space.mesh());
    let mut rows = Vec::new();
    for (e, piece) in d.contact.iter().enumerate().filter(|(e, _)| !d.is_idle(*e)) {
        let springs = (0..piece.p0.len()).filter(|&i| acts(e, i));
        rows.extend(springs.map(|i| (e, jumps(&d.motions, &parts, &d.space, piece, i))));
    }
    let mut chosen = BTreeSet::new();
    for _ in slides.basis.len()..d.motions.len() {
        let square = |(_, row): &&(usize, Vec<f64>)| dot(row, row);
        let most = rows.iter().max_by(|a, b| square(a).total_cmp(&square(b)));
        let Some((e, most)) = most.filter(|row| square(row) > 0.0).cloned() else { break };
        let all = dot(&most, &most);
        for (_, row) in &mut rows {
            let share = dot(row, &most) / all;
            row.iter_mut().zip(&most).for_each(|(row, most)| *row -= share * most);
        }
        chosen.insert(e);
    }
    chosen
}
