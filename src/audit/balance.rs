//! Equilibrium made exact. The tractions of a certificate are doubles, so every triangle is out of balance by some
//! rounding errors: a force and a moment. They are carried along the edges of a tree, from the leaves to the root, each
//! edge getting the affine traction that balances the triangle behind it; what all triangles together are out of balance
//! by is taken by three components of traction on Gamma_D, where tractions are free. The additional tractions exist as
//! real numbers, and intervals contain them.

use nalgebra::Vector2;
use thiserror::Error;

use super::certificate::{Certificate, Owner, Role, exactly};
use crate::kernel::Enclosing;
use crate::kernel::composite::Wrench;

/// Why there is no equilibrium to be had.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Unbalanced {
    /// Loads that nothing takes.
    #[error(
        "nothing balances the loads on the part of the body with triangle {triangle}; expected, for each part that edges join, displacement boundaries whose forces can"
    )]
    Free {
        /// A triangle of the part.
        triangle: usize,
    },
}

/// A traction on Gamma_D: `direction` times 1 or 2 s - 1 along the edge.
#[derive(Clone, Copy)]
struct Hold {
    edge: usize,
    direction: [f64; 2],
    linear: bool,
}

/// The tree over the triangles of each connected part: an order from the root on, and the edge towards the root.
pub(super) struct Tree {
    pub order: Vec<usize>,
    pub towards_root: Vec<Option<usize>>,
    /// Where in `order` each part begins.
    pub parts: Vec<usize>,
}

impl Tree {
    /// Breadth first; edges inside a triangle that was cut, elsewhere than in the middle of an edge, come before all others.
    pub fn new(certificate: &Certificate, owners: &[[Option<Owner>; 2]]) -> Tree {
        let vertices = certificate.vertices.len();
        let count = certificate.pieces.len();
        let mut tree = Tree {
            order: Vec::with_capacity(count),
            towards_root: vec![None; count],
            parts: Vec::new(),
        };
        let mut seen = vec![false; count];
        let is_cut = |e: usize| {
            let cut = |p: &usize| p.checked_sub(vertices).map(|cut| certificate.cuts[cut].at);
            certificate.edges[e].ends.iter().filter_map(cut).any(|at| at != 0.5)
        };
        let beyond = |t: usize, e: usize| {
            let [left, right] = owners[e];
            [left, right].into_iter().flatten().map(|owner| owner.piece).find(|&piece| piece != t)
        };
        let mut reached = Vec::new();
        for root in 0..count {
            if seen[root] {
                continue;
            }
            tree.parts.push(tree.order.len());
            seen[root] = true;
            tree.order.push(root);
            let mut next = tree.order.len() - 1;
            while next < tree.order.len() {
                let t = tree.order[next];
                next += 1;
                reached.push(t);
                while let Some(from) = reached.pop() {
                    for e in certificate.pieces[from].edges {
                        // From t everywhere; from a triangle just found only to the rest of a cut one.
                        if from != t && !is_cut(e) {
                            continue;
                        }
                        if let Some(to) = beyond(from, e)
                            && !seen[to]
                        {
                            seen[to] = true;
                            tree.towards_root[to] = Some(e);
                            tree.order.push(to);
                            reached.push(to);
                        }
                    }
                }
            }
        }
        tree
    }
}

/// Adds to the forces on the edges of the triangles, `outward`, those that put every one in equilibrium; `wrenches` are their
/// resultants, with the loads.
///
/// # Errors
/// A connected part that Gamma_D doesn't hold.
pub(super) fn close<S: Enclosing>(
    certificate: &Certificate,
    tree: &Tree,
    owners: &[[Option<Owner>; 2]],
    points: &[Vector2<S>],
    wrenches: &mut [Wrench<S>],
    outward: &mut [[[Vector2<S>; 2]; 3]],
) -> Result<(), Unbalanced> {
    for (k, &first) in tree.parts.iter().enumerate() {
        let end = tree.parts.get(k + 1).copied().unwrap_or(tree.order.len());
        let part = &tree.order[first..end];
        let root = part[0];
        let mut total = wrenches[root];
        for &t in &part[1..] {
            total = total.plus(wrenches[t]);
        }
        let holds = choose(certificate, owners, part, points);
        let Some(holds) = holds else { return Err(Unbalanced::Free { triangle: root }) };
        let unit = holds.map(|hold| {
            let [start, end] = certificate.edges[hold.edge].ends.map(|p| points[p]);
            unit_wrench(hold, start, end).about(total.about)
        });
        for (hold, factor) in holds.into_iter().zip(solve(unit, total)) {
            let Some(owner) = owners[hold.edge][0] else { continue };
            let [start, end] = certificate.edges[hold.edge].ends.map(|p| points[p]);
            let force = profile(hold).map(|f| exactly::<S>(f) * factor);
            add(&mut outward[owner.piece][owner.local], force);
            let wrench = unit_wrench(hold, start, end);
            let wrench =
                Wrench { force: wrench.force * factor, moment: wrench.moment * factor, ..wrench };
            wrenches[owner.piece] = wrenches[owner.piece].plus(wrench);
        }
        for &t in part[1..].iter().rev() {
            let Some(e) = tree.towards_root[t] else { continue };
            let [Some(left), Some(right)] = owners[e] else { continue };
            let [start, end] = certificate.edges[e].ends.map(|p| points[p]);
            let wrench = wrenches[t];
            let force = wrench.on_edge(start, end);
            let minus = force.map(|f| -f);
            // The triangle behind the edge gets minus its resultant, the one before it the resultant; its edge runs the
            // other way round.
            let (behind, before) = if left.piece == t { (left, right) } else { (right, left) };
            let (here, there) = if left.piece == t {
                (minus, [force[1], force[0]])
            } else {
                ([minus[1], minus[0]], force)
            };
            add(&mut outward[behind.piece][behind.local], here);
            add(&mut outward[before.piece][before.local], there);
            wrenches[before.piece] = wrenches[before.piece].plus(wrench);
        }
    }
    Ok(())
}

fn add<S: Enclosing>(to: &mut [Vector2<S>; 2], force: [Vector2<S>; 2]) {
    for (to, force) in to.iter_mut().zip(force) {
        *to += force;
    }
}

/// The traction of a hold at both ends of its edge.
fn profile(hold: Hold) -> [[f64; 2]; 2] {
    let d = hold.direction;
    [if hold.linear { d.map(|d| -d) } else { d }, d]
}

/// Its wrench, about the middle of the edge.
fn unit_wrench<S: Enclosing>(hold: Hold, start: Vector2<S>, end: Vector2<S>) -> Wrench<S> {
    let about = (start + end) / S::from(2);
    let d = exactly::<S>(hold.direction);
    if hold.linear {
        // int (s - 1/2) E x (2 s - 1) d = E x d / 6
        let along = end - start;
        let turn = along[0] * d[1] - along[1] * d[0];
        return Wrench { force: Vector2::zeros(), moment: turn / S::from(6), about };
    }
    Wrench { force: d, moment: S::from(0), about }
}

/// Three holds of a part whose wrenches are as independent as any: greedily, by what is left after those before.
fn choose<S: Enclosing>(
    certificate: &Certificate,
    owners: &[[Option<Owner>; 2]],
    part: &[usize],
    points: &[Vector2<S>],
) -> Option<[Hold; 3]> {
    let double = |p: usize| points[p].map(|c| (c.lower() + c.upper()) / 2.0);
    let origin = double(certificate.pieces[part[0]].vertices[0]);
    let mut candidates = Vec::new();
    let mut size = 0.0_f64;
    for &t in part {
        for e in certificate.pieces[t].edges {
            let edge = &certificate.edges[e];
            let axes = [[1.0, 0.0], [0.0, 1.0]];
            let held = match edge.role {
                Role::Held(held, _) => [0, 1].map(|c| held[c].then_some(axes[c])),
                Role::Supported { along, .. } => [Some(along), None],
                _ => continue,
            };
            if owners[e][0].is_none_or(|owner| owner.piece != t) {
                continue;
            }
            let [start, end] = edge.ends.map(double);
            for x in [start - origin, end - origin] {
                size = size.max(x.x.hypot(x.y));
            }
            for direction in held.into_iter().flatten() {
                for linear in [false, true] {
                    let hold = Hold { edge: e, direction, linear };
                    let wrench = unit_wrench(hold, start, end).about(origin);
                    candidates.push((hold, [wrench.force[0], wrench.force[1], wrench.moment]));
                }
            }
        }
    }
    for (_, row) in &mut candidates {
        row[2] /= size;
    }
    let mut chosen = Vec::with_capacity(3);
    for _ in 0..3 {
        let norm = |row: &[f64; 3]| row.iter().map(|x| x * x).sum::<f64>();
        let best = candidates.iter().max_by(|a, b| norm(&a.1).total_cmp(&norm(&b.1)))?;
        let (hold, row) = *best;
        // Below this, three rows in the plane of size 1 are dependent up to rounding.
        if !(norm(&row) > 1e-16) {
            return None;
        }
        chosen.push(hold);
        for (_, other) in &mut candidates {
            let along = (0..3).map(|c| other[c] * row[c]).sum::<f64>() / norm(&row);
            *other = [0, 1, 2].map(|c| other[c] - along * row[c]);
        }
    }
    Some([chosen[0], chosen[1], chosen[2]])
}

/// The factors with which three wrenches about one point add up to minus `total`, by Cramer's rule.
fn solve<S: Enclosing>(unit: [Wrench<S>; 3], total: Wrench<S>) -> [S; 3] {
    let column = |w: &Wrench<S>| [w.force[0], w.force[1], w.moment];
    let columns = [column(&unit[0]), column(&unit[1]), column(&unit[2])];
    let right = column(&total).map(|x| -x);
    let determinant = |[a, b, c]: [[S; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1])
            + c[0] * (a[1] * b[2] - a[2] * b[1])
    };
    let whole = determinant(columns);
    [0, 1, 2].map(|k| {
        let mut with = columns;
        with[k] = right;
        determinant(with) / whole
    })
}
