//! The assembled matrices, their numbering and their pattern: with the unknowns in any order, components prescribed at random
//! and nodes in frames of their own, the product of a matrix with a vector is its bilinear form of the field.

use std::collections::BTreeMap;

use signorini::fem::matrix::{self, LowerTriangle, Neighbours, Numbering};
use signorini::fem::{Degree, Diagonal, Discretization, EdgeRule, Rectangle, Space};

use super::bodies::on_bodies;
use super::{Outcome, properties, text};
use crate::common::Random;

/// An order of the nodes, with a quarter of all components prescribed and a third of the nodes turned.
struct Unknowns {
    order: Vec<usize>,
    prescribed: Vec<[Option<f64>; 2]>,
    frames: BTreeMap<usize, [f64; 2]>,
}

impl Unknowns {
    fn any(nodes: usize, random: &mut Random) -> Unknowns {
        let mut order: Vec<usize> = (0..nodes).collect();
        for k in (1..nodes).rev() {
            order.swap(k, random.below(k + 1));
        }
        let mut component = || (random.below(4) == 0).then_some(0.0);
        let prescribed = (0..nodes).map(|_| [component(), component()]).collect();
        let mut frames = BTreeMap::new();
        for node in (0..nodes).filter(|_| random.below(3) == 0).collect::<Vec<_>>() {
            let (sin, cos) = (3.0 * random.next()).sin_cos();
            frames.insert(node, [cos, sin]);
        }
        Unknowns { order, prescribed, frames }
    }

    fn numbering(&self) -> Numbering {
        Numbering::in_frames(&self.order, &self.prescribed, self.frames.clone())
    }

    /// The free components, each with its node, in the order of elimination.
    fn free(&self) -> Vec<(usize, usize)> {
        let all = self.order.iter().flat_map(|&node| [(node, 0), (node, 1)]);
        all.filter(|&(node, c)| self.prescribed[node][c].is_none()).collect()
    }
}

/// A numbering, and a matrix with all its entries.
type Pattern = fn(&Space, &Unknowns) -> (Numbering, LowerTriangle);

fn pattern(space: &Space, unknowns: &Unknowns) -> (Numbering, LowerTriangle) {
    let numbering = unknowns.numbering();
    let zero = LowerTriangle::zero(&numbering, &Neighbours::new(space));
    (numbering, zero)
}

/// Planted: the nodes are numbered as they stand in the mesh.
fn order_forgotten(space: &Space, unknowns: &Unknowns) -> (Numbering, LowerTriangle) {
    let order = (0..unknowns.order.len()).collect();
    let (prescribed, frames) = (unknowns.prescribed.clone(), unknowns.frames.clone());
    pattern(space, &Unknowns { order, prescribed, frames })
}

/// Planted: the last row of the first column is missing.
fn an_entry_missing(space: &Space, unknowns: &Unknowns) -> (Numbering, LowerTriangle) {
    let (numbering, mut matrix) = pattern(space, unknowns);
    matrix.rows.remove(matrix.starts[1] - 1);
    matrix.starts[1..].iter_mut().for_each(|start| *start -= 1);
    (numbering, matrix)
}

/// Planted: all entries of the lower triangle.
fn all_entries(space: &Space, unknowns: &Unknowns) -> (Numbering, LowerTriangle) {
    let (numbering, _) = pattern(space, unknowns);
    let mut matrix = LowerTriangle { starts: vec![0], rows: Vec::new(), values: Vec::new() };
    for column in 0..numbering.count {
        matrix.rows.extend(column..numbering.count);
        matrix.starts.push(matrix.rows.len());
    }
    matrix.values = vec![0.0; matrix.rows.len()];
    (numbering, matrix)
}

/// On rectangles of a few cells.
fn entries_are_pairs_that_share_a_triangle(made: Pattern) -> Outcome {
    let mut random = Random(13);
    for diagonal in [Diagonal::Left, Diagonal::Right, Diagonal::Crossed] {
        for (nx, ny) in [(1, 1), (2, 1), (3, 2), (4, 3)] {
            let rectangle = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal };
            let mesh = rectangle.mesh().map_err(text)?;
            for degree in [Degree::One, Degree::Two] {
                let space = Space::new(&mesh, degree);
                let unknowns = Unknowns::any(space.nodes().len(), &mut random);
                is_numbering_with_pattern(made(&space, &unknowns), &space, &unknowns)
                    .map_err(|why| format!("{rectangle:?}, {degree:?}: {why}"))?;
            }
        }
    }
    Ok(())
}

/// Free components are numbered node by node, and the rows of a column are all that do not come before it and whose node is that
/// of the column or shares a triangle with it, in increasing order.
fn is_numbering_with_pattern(
    (numbering, matrix): (Numbering, LowerTriangle),
    space: &Space,
    unknowns: &Unknowns,
) -> Outcome {
    let free = unknowns.free();
    if numbering.count != free.len() {
        return Err(format!("{} numbers for {} components", numbering.count, free.len()));
    }
    for (node, numbers) in numbering.of.iter().enumerate() {
        let expected = [0, 1].map(|c| free.iter().position(|&other| other == (node, c)));
        if *numbers != expected {
            return Err(format!("node {node}: {numbers:?}, expected {expected:?}"));
        }
    }
    let adjacent = |a: usize, b: usize| {
        a == b || space.elements().any(|nodes| nodes.contains(&a) && nodes.contains(&b))
    };
    for (column, &(node, _)) in free.iter().enumerate() {
        let expected: Vec<usize> =
            (column..free.len()).filter(|&row| adjacent(free[row].0, node)).collect();
        let found = &matrix.rows[matrix.starts[column]..matrix.starts[column + 1]];
        if found != expected {
            return Err(format!("column {column}: {found:?}, expected {expected:?}"));
        }
    }
    Ok(())
}

/// The product with the whole symmetric matrix.
fn product(matrix: &LowerTriangle, x: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; x.len()];
    for column in 0..x.len() {
        for k in matrix.starts[column]..matrix.starts[column + 1] {
            let (row, value) = (matrix.rows[k], matrix.values[k]);
            product[row] += value * x[column];
            if row != column {
                product[column] += value * x[row];
            }
        }
    }
    product
}

fn near(what: &str, found: &[f64], expected: &[f64]) -> Outcome {
    let scale = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let off = found.iter().zip(expected).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    let near = found.len() == expected.len() && off <= 1e-12 * scale;
    near.then_some(()).ok_or(format!("{what}: off by {off:e} beside {scale:e}"))
}

/// The matrices of a and of A.
type Assemble = fn(&Discretization, &Unknowns) -> [LowerTriangle; 2];

fn assembled_over(d: &Discretization, numbering: &Numbering) -> [LowerTriangle; 2] {
    let neighbours = Neighbours::new(&d.space);
    let stiffness = matrix::assemble_stiffness(d, numbering, &neighbours);
    [stiffness, matrix::assemble(d, numbering, &neighbours)]
}

fn assembled(d: &Discretization, unknowns: &Unknowns) -> [LowerTriangle; 2] {
    assembled_over(d, &unknowns.numbering())
}

/// Planted: one contact edge is left out of A.
fn an_edge_forgotten(d: &Discretization, unknowns: &Unknowns) -> [LowerTriangle; 2] {
    let numbering = unknowns.numbering();
    let [stiffness, _] = assembled_over(d, &numbering);
    let mut whole = stiffness.clone();
    d.contact[1..].iter().for_each(|edge| whole.add_contact_stress(&numbering, edge));
    [stiffness, whole]
}

/// Planted: no node is turned.
fn frames_forgotten(d: &Discretization, unknowns: &Unknowns) -> [LowerTriangle; 2] {
    assembled_over(d, &Numbering::new(&unknowns.order, &unknowns.prescribed))
}

fn matrices_are_forms(assemble: Assemble) -> Outcome {
    let mut random = Random(14);
    on_bodies(|problem, degree| {
        let d = Discretization::new(problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact)
            .map_err(text)?;
        let nodes = d.space.nodes().len();
        let without_field = d.linear_residual(&vec![[0.0; 2]; nodes]).values;
        for _ in 0..5 {
            let unknowns = Unknowns::any(nodes, &mut random);
            let numbering = unknowns.numbering();
            let x: Vec<f64> = (0..numbering.count).map(|_| random.next()).collect();
            let mut field = vec![[0.0; 2]; nodes];
            numbering.scatter(&x, &mut field);

            let [stiffness, whole] = assemble(&d, &unknowns);
            let of_a = d.internal_forces(&field).values;
            near("a", &product(&stiffness, &x), &numbering.gather(&of_a))?;
            let linear = d.linear_residual(&field).values;
            let pairs = linear.iter().zip(&without_field);
            let of_whole: Vec<_> = pairs.map(|(r, l)| [r[0] - l[0], r[1] - l[1]]).collect();
            near("A", &product(&whole, &x), &numbering.gather(&of_whole))?;
        }
        Ok(())
    })
}

/// Writes a vector into a field.
type Scatter = fn(&Numbering, &[f64], &mut [[f64; 2]]);

/// A field has the vector at its free components, and what it had at the prescribed ones.
fn only_free_components_change(scatter: Scatter) -> Outcome {
    let mut random = Random(15);
    for nodes in 1..20 {
        let numbering = Unknowns::any(nodes, &mut random).numbering();
        let before = random.field(nodes);
        let x: Vec<f64> = (0..numbering.count).map(|_| random.next()).collect();
        let mut after = before.clone();
        scatter(&numbering, &x, &mut after);
        near("free components", &numbering.gather(&after), &x)?;
        for (node, numbers) in numbering.of.iter().enumerate() {
            let [before, after] =
                [&before, &after].map(|field| numbering.in_frame(node, field[node]));
            for c in (0..2).filter(|&c| numbers[c].is_none()) {
                near("a prescribed component", &[after[c]], &[before[c]])?;
            }
        }
    }
    Ok(())
}

/// Planted: the whole field is overwritten.
fn overwriting(numbering: &Numbering, x: &[f64], field: &mut [[f64; 2]]) {
    field.fill([0.0; 2]);
    numbering.scatter(x, field);
}

properties! {
    two_unknowns_have_an_entry_if_their_nodes_share_a_triangle:
        entries_are_pairs_that_share_a_triangle(pattern);
        not entries_are_pairs_that_share_a_triangle(order_forgotten),
            entries_are_pairs_that_share_a_triangle(an_entry_missing),
            entries_are_pairs_that_share_a_triangle(all_entries);
    assembled_matrices_are_the_bilinear_forms_in_any_order_and_any_frames:
        matrices_are_forms(assembled);
        not matrices_are_forms(an_edge_forgotten), matrices_are_forms(frames_forgotten);
    a_vector_that_is_scattered_changes_free_components_only:
        only_free_components_change(Numbering::scatter);
        not only_free_components_change(overwriting);
}
