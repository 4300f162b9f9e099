//! The assembled matrices and their numbering: with the unknowns in any order, components prescribed at random
//! and nodes in frames of their own, the product of a matrix with a vector is its bilinear form of the field.

use std::collections::BTreeMap;

use proptest::array::uniform2;
use proptest::collection::vec;
use proptest::option::weighted;
use proptest::strategy::{Just, Strategy};
use signorini::contact::{Discretization, EdgeRule};
use signorini::linear::matrix;
use signorini::linear::matrix::{LowerTriangle, Neighbours, Numbering};

use super::bodies::on_bodies;
use super::{Outcome, any_order, field, for_all, properties, text};

/// An order of the nodes, with a quarter of all components prescribed and a third of the nodes turned.
#[derive(Debug)]
struct Unknowns {
    order: Vec<usize>,
    prescribed: Vec<[Option<f64>; 2]>,
    frames: BTreeMap<usize, [f64; 2]>,
}

impl Unknowns {
    fn any(nodes: usize) -> impl Strategy<Value = Unknowns> {
        let component = || weighted(0.25, Just(0.0));
        let prescribed = vec(uniform2(component()), nodes);
        let angles = vec(weighted(1.0 / 3.0, -3.0..3.0), nodes);
        (any_order(nodes), prescribed, angles).prop_map(|(order, prescribed, angles)| {
            let turned = |(node, angle): (usize, Option<f64>)| {
                let (sin, cos) = angle?.sin_cos();
                Some((node, [cos, sin]))
            };
            let frames = angles.into_iter().enumerate().filter_map(turned).collect();
            Unknowns { order, prescribed, frames }
        })
    }

    fn numbering(&self) -> Numbering {
        Numbering::new(&self.order, &self.prescribed, self.frames.clone())
    }
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
    let stiffness = matrix::assemble_stiffness(d, numbering, &neighbours).unwrap();
    [stiffness, matrix::assemble(d, numbering, &neighbours).unwrap()]
}

fn assembled(d: &Discretization, unknowns: &Unknowns) -> [LowerTriangle; 2] {
    assembled_over(d, &unknowns.numbering())
}

/// Planted: one contact edge is left out of A.
fn an_edge_forgotten(d: &Discretization, unknowns: &Unknowns) -> [LowerTriangle; 2] {
    let numbering = unknowns.numbering();
    let [stiffness, _] = assembled_over(d, &numbering);
    let mut whole = stiffness.clone();
    d.contact[1..].iter().for_each(|edge| whole.add_contact_stress(&numbering, edge).unwrap());
    [stiffness, whole]
}

/// Planted: no node is turned.
fn frames_forgotten(d: &Discretization, unknowns: &Unknowns) -> [LowerTriangle; 2] {
    assembled_over(d, &Numbering::new(&unknowns.order, &unknowns.prescribed, BTreeMap::new()))
}

fn matrices_are_forms(assemble: Assemble) -> Outcome {
    on_bodies(|problem, degree| {
        let d = Discretization::new(problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact)
            .map_err(text)?;
        let nodes = d.space.nodes().len();
        let without_field = d.linear_residual(&vec![[0.0; 2]; nodes]).values;
        for_all(5, (Unknowns::any(nodes), vec(-1.0..1.0, 2 * nodes)), |(unknowns, x)| {
            let numbering = unknowns.numbering();
            let x = &x[..numbering.count];
            let mut field = vec![[0.0; 2]; nodes];
            numbering.scatter(x, &mut field);

            let [stiffness, whole] = assemble(&d, &unknowns);
            let of_a = d.internal_forces(&field).values;
            near("a", &product(&stiffness, x), &numbering.gather(&of_a))?;
            let linear = d.linear_residual(&field).values;
            let pairs = linear.iter().zip(&without_field);
            let of_whole: Vec<_> = pairs.map(|(r, l)| [r[0] - l[0], r[1] - l[1]]).collect();
            near("A", &product(&whole, x), &numbering.gather(&of_whole))
        })
    })
}

/// Writes a vector into a field.
type Scatter = fn(&Numbering, &[f64], &mut [[f64; 2]]);

/// A field has the vector at its free components, and what it had at the prescribed ones.
fn only_free_components_change(scatter: Scatter) -> Outcome {
    let data = (1_usize..20)
        .prop_flat_map(|nodes| (Unknowns::any(nodes), field(nodes), vec(-1.0..1.0, 2 * nodes)));
    for_all(20, data, |(unknowns, before, x)| {
        let numbering = unknowns.numbering();
        let x = &x[..numbering.count];
        let mut after = before.clone();
        scatter(&numbering, x, &mut after);
        near("free components", &numbering.gather(&after), x)?;
        for (node, numbers) in numbering.of.iter().enumerate() {
            let [before, after] =
                [&before, &after].map(|field| numbering.in_frame(node, field[node]));
            for c in (0..2).filter(|&c| numbers[c].is_none()) {
                near("a prescribed component", &[after[c]], &[before[c]])?;
            }
        }
        Ok(())
    })
}

/// Planted: the whole field is overwritten.
fn overwriting(numbering: &Numbering, x: &[f64], field: &mut [[f64; 2]]) {
    field.fill([0.0; 2]);
    numbering.scatter(x, field);
}

properties! {
    assembled_matrices_are_the_bilinear_forms_in_any_order_and_any_frames:
        matrices_are_forms(assembled);
        not matrices_are_forms(an_edge_forgotten), matrices_are_forms(frames_forgotten);
    a_vector_that_is_scattered_changes_free_components_only:
        only_free_components_change(Numbering::scatter);
        not only_free_components_change(overwriting);
}
