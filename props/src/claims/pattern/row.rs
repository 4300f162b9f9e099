//! The row of the pattern: the solver's numbering and matrices against sets and dense matrices, on random data, on all data
//! of a small size, and on meshes.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use proptest::prelude::*;
use signorini::fem::matrix::{LowerTriangle, Neighbours, Numbering, assemble};
use signorini::fem::{
    Condition, Degree, Diagonal, Discretization, EdgeRule, Problem, Rectangle, SharedFunction,
    Trapezoid,
};
use signorini::kernel::element::stiffness;
use signorini::kernel::{Element, Material, P1, P2, Plane};
use signorini::nalgebra::Matrix2;

use crate::claim::{Claim, Engine, Outcome, by, model_checked};
use crate::verdict::Verdict;
use crate::{draws, ensure};

use super::*;

/// Elements on nodes, and an order of elimination with prescribed components.
#[derive(Clone, Debug)]
struct Draw<const N: usize> {
    elements: Vec<[usize; N]>,
    order: Vec<usize>,
    prescribed: Vec<[Option<f64>; 2]>,
}

/// What the solver makes of it.
struct Made {
    neighbours: Vec<Vec<usize>>,
    of: Vec<[Option<usize>; 2]>,
    count: usize,
    matrix: LowerTriangle,
    gathered: Vec<f64>,
    scattered: Vec<[f64; 2]>,
}

/// A different whole number for each entry of each element matrix, so that a wrong place or factor shows; sums of
/// these are exact in doubles.
fn block(element: usize, i: usize, j: usize) -> [[f64; 2]; 2] {
    let entry = |c: usize, d: usize| {
        let name = ((element * 6 + i) * 6 + j) * 4 + 2 * c + d;
        ((name * 7919 + 13) % 100_003) as f64
    };
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}

/// A different number for each component.
fn field(nodes: usize) -> Vec<[f64; 2]> {
    (0..nodes).map(|node| [node as f64 + 0.25, node as f64 + 0.5]).collect()
}

const OLD: f64 = -1.0;

impl<const N: usize> Draw<N> {
    fn nodes(&self) -> usize {
        self.prescribed.len()
    }

    fn neighbours(&self) -> Neighbours {
        Neighbours::of_elements(self.nodes(), &self.elements)
    }

    fn numbering(&self) -> Numbering {
        Numbering::new(&self.order, &self.prescribed)
    }

    fn made(&self) -> Made {
        self.made_with(&self.neighbours(), &self.numbering(), block)
    }

    fn made_with(
        &self,
        neighbours: &Neighbours,
        numbering: &Numbering,
        block: impl Fn(usize, usize, usize) -> [[f64; 2]; 2],
    ) -> Made {
        let mut matrix = LowerTriangle::zero(numbering, neighbours);
        for (e, nodes) in self.elements.iter().enumerate() {
            matrix.add(numbering, nodes, |i, j| Matrix2::from(block(e, i, j)).transpose());
        }
        let gathered = numbering.gather(&field(self.nodes()));
        let mut scattered = vec![[OLD; 2]; self.nodes()];
        numbering.scatter(&gathered, &mut scattered);
        let around = |node| neighbours.of(node).to_vec();
        Made {
            neighbours: (0..self.nodes()).map(around).collect(),
            of: numbering.of.clone(),
            count: numbering.count,
            matrix,
            gathered,
            scattered,
        }
    }

    /// The definition: b is around a if it is a, or if they share a triangle.
    fn around(&self) -> Vec<BTreeSet<usize>> {
        let mut sets: Vec<_> = (0..self.nodes()).map(|node| BTreeSet::from([node])).collect();
        for element in &self.elements {
            let nodes = || element.iter().copied().filter(|&node| node < self.nodes());
            for a in nodes() {
                sets[a].extend(nodes());
            }
        }
        sets
    }

    /// The definition: the free components of the nodes in the order in which they first come.
    fn free(&self) -> Vec<(usize, usize)> {
        let mut free = Vec::new();
        for (p, &node) in self.order.iter().enumerate() {
            if node < self.nodes() && !self.order[..p].contains(&node) {
                free.extend(
                    (0..2).filter(|&c| self.prescribed[node][c].is_none()).map(|c| (node, c)),
                );
            }
        }
        free
    }

    fn class(&self) -> &'static str {
        let nodes = self.nodes();
        let sorted: BTreeSet<usize> = self.order.iter().copied().collect();
        let permutation = self.order.len() == nodes && sorted.into_iter().eq(0..nodes);
        let alone = |node: &usize| !self.elements.as_flattened().contains(node);
        let twice = |e: &[usize; N]| e.iter().collect::<BTreeSet<_>>().len() < N;
        let free = self.prescribed.as_flattened().iter().filter(|v| v.is_none()).count();
        if self.elements.as_flattened().iter().any(|&node| node >= nodes) {
            "a node that is none"
        } else if !permutation {
            "an order with gaps or repetitions"
        } else if (0..nodes).any(|node| alone(&node)) {
            "a node without triangle"
        } else if self.elements.iter().any(twice) {
            "a triangle with a node twice"
        } else if free == 0 {
            "all prescribed"
        } else if free == 2 * nodes {
            "all free"
        } else {
            "some prescribed"
        }
    }

    /// Whether that is what the definitions say.
    fn judge(&self, made: &Made) -> Verdict {
        let around = self.around();
        for (list, set) in made.neighbours.iter().zip(&around) {
            ensure!(list.len() == set.len());
            ensure!(list.iter().all(|node| set.contains(node)));
        }
        let free = self.free();
        let mut of = vec![[None; 2]; self.nodes()];
        for (k, &(node, c)) in free.iter().enumerate() {
            of[node][c] = Some(k);
        }
        ensure!(made.count == free.len());
        ensure!(made.of == of);
        let values = field(self.nodes());
        ensure!(made.gathered.len() == free.len());
        ensure!(free.iter().zip(&made.gathered).all(|(&(node, c), v)| *v == values[node][c]));
        for (node, (numbers, back)) in of.iter().zip(&made.scattered).enumerate() {
            for c in 0..2 {
                ensure!(back[c] == if numbers[c].is_some() { values[node][c] } else { OLD });
            }
        }
        let sums = self.sums(&of);
        let LowerTriangle { starts, rows, values } = &made.matrix;
        ensure!(starts.len() == free.len() + 1 && starts[0] == 0);
        ensure!(starts.windows(2).all(|pair| pair[0] <= pair[1]));
        ensure!(starts[free.len()] == rows.len() && rows.len() == values.len());
        for (column, (node, _)) in free.iter().enumerate() {
            let range = starts[column]..starts[column + 1];
            let (rows, values) = (&rows[range.clone()], &values[range]);
            ensure!(rows.first() == Some(&column));
            ensure!(rows.windows(2).all(|pair| pair[0] < pair[1]));
            let expected: Vec<usize> =
                (column..free.len()).filter(|&r| around[*node].contains(&free[r].0)).collect();
            ensure!(rows == expected);
            for (row, value) in rows.iter().zip(values) {
                ensure!(*value == sums.get(&(*row, column)).copied().unwrap_or(0.0));
            }
        }
        Verdict::Holds(self.class())
    }

    /// The definition: all element matrices, added up over all pairs of free components.
    fn sums(&self, of: &[[Option<usize>; 2]]) -> BTreeMap<(usize, usize), f64> {
        let mut sums = BTreeMap::new();
        for (e, nodes) in self.elements.iter().enumerate() {
            for (i, row_node) in nodes.iter().enumerate() {
                for (j, column_node) in nodes.iter().enumerate() {
                    let block = block(e, i, j);
                    let pair = (of.get(*row_node), of.get(*column_node));
                    let (Some(rows), Some(columns)) = pair else { continue };
                    for (c, row) in rows.iter().enumerate() {
                        for (d, column) in columns.iter().enumerate() {
                            if let (Some(row), Some(column)) = (row, column) {
                                *sums.entry((*row, *column)).or_insert(0.0) += block[c][d];
                            }
                        }
                    }
                }
            }
        }
        sums
    }
}

const CLASSES: [&str; 7] = [
    "a node that is none",
    "an order with gaps or repetitions",
    "a node without triangle",
    "a triangle with a node twice",
    "all prescribed",
    "all free",
    "some prescribed",
];

/// Up to four nodes more than an element has, and up to eight elements, proper ones or any; all components prescribed,
/// none or some; mostly in an order that is one.
fn draws<const N: usize>() -> impl Strategy<Value = Draw<N>> {
    let sizes = (prop_oneof![1 => 1..N, 3 => N..=N + 4], 0_usize..=8);
    (sizes, 0_u8..4, 0_u8..4, prop::bool::ANY).prop_flat_map(
        |((nodes, elements), wrong, fixed, proper)| {
            let all = || Just((0..nodes).collect::<Vec<_>>()).prop_shuffle();
            let element = if proper && nodes >= N {
                all().boxed()
            } else {
                prop::collection::vec(0..nodes + usize::from(wrong == 0), N).boxed()
            };
            let component = prop::bool::weighted([0.0, 1.0, 0.3, 0.3][usize::from(fixed)]);
            let components = prop::collection::vec([component, component], nodes);
            let order = if wrong == 1 {
                prop::collection::vec(0..=nodes, 0..=nodes + 1).boxed()
            } else {
                all().boxed()
            };
            let elements = prop::collection::vec(element, elements);
            (elements, components, order).prop_map(|(elements, components, order)| Draw {
                elements: elements.iter().map(|e| std::array::from_fn(|i| e[i])).collect(),
                order,
                prescribed: components
                    .iter()
                    .map(|c| c.map(|fixed| fixed.then_some(0.0)))
                    .collect(),
            })
        },
    )
}

/// Components 2 i + c of which the bit is set in `mask` are prescribed.
fn prescribed_by(mask: usize, nodes: usize) -> Vec<[Option<f64>; 2]> {
    let component = |k: usize| (mask >> k & 1 == 1).then_some(0.0);
    (0..nodes).map(|i| [component(2 * i), component(2 * i + 1)]).collect()
}

/// The data of all lists of four of the nodes 0 to 3.
fn lists() -> impl Iterator<Item = Vec<usize>> {
    (0..256_usize).map(|n| vec![n % 4, n / 4 % 4, n / 16 % 4, n / 64])
}

/// Whether all data with these elements, orders, and any components of as many nodes prescribed are judged to hold.
fn all(elements: &[Vec<[usize; 3]>], orders: &[Vec<usize>], nodes: usize) -> Outcome {
    let sets = 1 << (2 * nodes);
    for elements in elements {
        for order in orders {
            for mask in 0..sets {
                let (elements, order) = (elements.clone(), order.clone());
                let draw = Draw { elements, order, prescribed: prescribed_by(mask, nodes) };
                if let Verdict::Fails(why) = draw.judge(&draw.made()) {
                    return Err(format!("{why} fails for {draw:?}"));
                }
            }
        }
    }
    let cases = elements.len() * orders.len() * sets;
    let [elements, orders] = [elements.len(), orders.len()];
    Ok(format!(
        "all {cases} cases: {elements} meshes, {orders} orders, {sets} sets of prescribed components"
    ))
}

/// All pairs of triangles on four nodes, which leave out one node each, in all orders.
fn pairs_of_triangles() -> Outcome {
    const LEFT_OUT: [[usize; 3]; 4] = [[1, 2, 3], [3, 2, 0], [0, 1, 3], [2, 1, 0]];
    let pairs = LEFT_OUT.iter().flat_map(|&a| LEFT_OUT.map(|b| vec![a, b])).collect::<Vec<_>>();
    let permutation = |order: &Vec<usize>| (0..4).all(|node| order.contains(&node));
    all(&pairs, &lists().filter(permutation).collect::<Vec<_>>(), 4)
}

/// All orders of four of three nodes, or of none (3), with repetitions and gaps, on one triangle.
fn lists_of_nodes() -> Outcome {
    all(&[vec![[0, 1, 2]]], &lists().collect::<Vec<_>>(), 3)
}

/// A mesh as drawn: which one, cells, degree, a seed for order and constraints.
type Mesh = (usize, [usize; 2], bool, u64);

const MESHES: [[&str; 2]; 4] = [
    ["P1, left", "P2, left"],
    ["P1, right", "P2, right"],
    ["P1, crossed", "P2, crossed"],
    ["P1, trapezoid", "P2, trapezoid"],
];

fn meshes() -> impl Strategy<Value = Mesh> {
    (0..MESHES.len(), [1_usize..=3, 1_usize..=3], prop::bool::ANY, prop::num::u64::ANY)
}

fn problem((which, [nx, ny], _, _): Mesh) -> Problem {
    let rectangle = |diagonal| Rectangle { width: 3.0, height: 2.0, nx, ny, diagonal }.mesh();
    let mesh = match which {
        0 => rectangle(Diagonal::Left),
        1 => rectangle(Diagonal::Right),
        2 => rectangle(Diagonal::Crossed),
        _ => Trapezoid { omega: 2.0, n: nx }.mesh(),
    };
    let zero = || -> SharedFunction { Arc::new(|_: [f64; 2]| 0.0) };
    let conditions = BTreeMap::from([
        ("top".to_owned(), Condition::Displacement([Some(zero()), Some(zero())])),
        ("bottom".to_owned(), Condition::Contact { gap: zero() }),
    ]);
    let material = Material::lame(1.3, 0.7, Plane::Strain);
    Problem::new(mesh.expect("a mesh"), material, [zero(), zero()], conditions)
}

/// The data of a mesh with a random order and random constraints.
fn shuffled<const N: usize>(nodes: usize, elements: &[[usize; N]], seed: u64) -> Draw<N> {
    let mut random = crate::proof::sampler::Random::new(seed);
    let mut order: Vec<usize> = (0..nodes).collect();
    for k in (1..nodes).rev() {
        order.swap(k, random.below(k + 1));
    }
    let mut component = || (random.below(4) == 0).then_some(0.0);
    let prescribed = (0..nodes).map(|_| [component(), component()]).collect();
    Draw { elements: elements.to_vec(), order, prescribed }
}

/// The pattern of a mesh is as defined, and the matrix of A(.,.) is the sum of the matrices of the triangles and of
/// the contact edges, bit for bit: both sides add in the same order.
fn on_mesh<E: Element<N, M>, const N: usize, const M: usize>(
    mesh: Mesh,
    made: impl Fn(&Draw<N>) -> Made,
    edges: impl Fn(f64) -> f64,
) -> Verdict {
    let problem = problem(mesh);
    let degree = if N == 3 { Degree::One } else { Degree::Two };
    let d = Discretization::new(&problem, degree, |c| c.limit() / 2.0, EdgeRule::Exact)
        .expect("a problem");
    let (elements, _) = d.space.connectivity().as_chunks::<N>();
    let draw = shuffled(d.space.nodes().len(), elements, mesh.3);
    if let Verdict::Fails(why) = draw.judge(&made(&draw)) {
        return Verdict::Fails(why);
    }
    let numbering = draw.numbering();
    let assembled = assemble(&d, &numbering, &draw.neighbours());
    let n = numbering.count;
    let mut dense = vec![vec![0.0; n]; n];
    let mut add = |nodes: &[usize], k: &dyn Fn(usize, usize) -> Matrix2<f64>| {
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            for (c, d) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let of = (numbering.of[nodes[i]][c], numbering.of[nodes[j]][d]);
                if let (Some(row), Some(column)) = of {
                    dense[row][column] += k(i, j)[(c, d)];
                }
            }
        }
    };
    for (triangle, nodes) in d.space.triangles::<N>() {
        let k = stiffness::<E, f64, N, M>(&triangle, problem.material.of(0));
        add(nodes, &|i, j| k[i][j]);
    }
    for edge in &d.contact {
        let weight = edges(edge.gamma * edge.length);
        add(&edge.nodes, &|i, j| edge.functionals.stress_product(weight, i, j));
    }
    for column in 0..n {
        let range = assembled.starts[column]..assembled.starts[column + 1];
        for (&row, value) in assembled.rows[range.clone()].iter().zip(&assembled.values[range]) {
            ensure!(*value == dense[row][column]);
            dense[row][column] = 0.0;
        }
        ensure!((column..n).all(|row| dense[row][column] == 0.0));
    }
    Verdict::Holds(MESHES[mesh.0][usize::from(N > 3)])
}

fn either(mesh: Mesh, edges: fn(f64) -> f64) -> Verdict {
    if mesh.2 {
        on_mesh::<P2, 6, 3>(mesh, Draw::made, edges)
    } else {
        on_mesh::<P1, 3, 2>(mesh, Draw::made, edges)
    }
}

/// Neighbours along two of the three sides of each triangle only: in a cell the nodes across the diagonal are forgotten.
fn third_side_forgotten(draw: &Draw<3>) -> Made {
    let sides: Vec<[usize; 2]> =
        draw.elements.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]).collect();
    draw.made_with(&Neighbours::of_elements(draw.nodes(), &sides), &draw.numbering(), block)
}

/// Prescribed components numbered like free ones.
fn prescribed_numbered(draw: &Draw<3>) -> Made {
    let numbering = Numbering::new(&draw.order, &vec![[None; 2]; draw.nodes()]);
    draw.made_with(&draw.neighbours(), &numbering, block)
}

/// Rows and columns of the element matrices exchanged.
fn blocks_transposed(draw: &Draw<3>) -> Made {
    let transposed = |e, i, j| {
        let [[a, b], [c, d]] = block(e, j, i);
        [[a, c], [b, d]]
    };
    draw.made_with(&draw.neighbours(), &draw.numbering(), transposed)
}

/// A mistake in what is made.
fn rejects(mistake: impl Fn(&Draw<3>) -> Made) -> Outcome {
    draws::reject(draws::<3>(), |draw| draw.judge(&mistake(draw)))
}

/// The same, planted after it is made.
fn rejects_spoiled(spoil: fn(&mut Made)) -> Outcome {
    rejects(|draw| {
        let mut made = draw.made();
        spoil(&mut made);
        made
    })
}

/// A number that no component has.
fn skip_a_number(made: &mut Made) {
    for number in made.of.as_flattened_mut().iter_mut().flatten() {
        *number += usize::from(*number > 0);
    }
}

/// The first two rows of a column exchanged.
fn exchange_rows(made: &mut Made) {
    if made.matrix.starts.get(1).is_some_and(|&end| end > 1) {
        made.matrix.rows.swap(0, 1);
        made.matrix.values.swap(0, 1);
    }
}

/// The last row of the last but one column counted to the last column.
fn start_too_early(made: &mut Made) {
    if let [.., start, _] = &mut made.matrix.starts[..] {
        *start = start.saturating_sub(1);
    }
}

/// The row of the pattern.
pub fn claim() -> Claim {
    let of_three = || draws::hold(3000, draws::<3>(), &CLASSES, |draw| draw.judge(&draw.made()));
    let of_six = || draws::hold(1000, draws::<6>(), &CLASSES, |draw| draw.judge(&draw.made()));
    let mut checks = vec![
        by(Engine::Exact, "pattern_numbers_and_sums_are_as_defined_on_random_triangles", of_three).about(&["sparse pattern"]),
        by(Engine::Exact, "pattern_numbers_and_sums_are_as_defined_on_random_elements_of_six_nodes", of_six),
        exact!("pattern_numbers_and_sums_are_as_defined_for_all_pairs_of_triangles_on_four_nodes" => pairs_of_triangles()),
        exact!("pattern_numbers_and_sums_are_as_defined_for_all_lists_of_four_of_three_nodes" => lists_of_nodes()),
        exact!("assembled_matrices_of_meshes_are_the_sums_of_their_parts" => draws::hold(150, meshes(), MESHES.as_flattened(), |&mesh| either(mesh, |weight| -weight))).about(&["sparse pattern"]),
        exact!("control_contact_terms_with_the_other_sign" => draws::reject(meshes(), |&mesh| either(mesh, |weight| weight))),
        exact!("control_pairs_across_the_diagonal_forgotten" => draws::reject(meshes(), |&mesh| on_mesh::<P1, 3, 2>(mesh, third_side_forgotten, |weight| -weight))),
        exact!("control_neighbour_listed_twice" => rejects_spoiled(|made| made.neighbours[0].extend_from_within(..1))),
        exact!("control_number_skipped" => rejects_spoiled(skip_a_number)),
        exact!("control_rows_unsorted" => rejects_spoiled(exchange_rows)),
        exact!("control_column_starts_one_too_early" => rejects_spoiled(start_too_early)),
        exact!("control_prescribed_components_numbered" => rejects(prescribed_numbered)),
        exact!("control_element_matrices_transposed" => rejects(blocks_transposed)),
        exact!("control_prescribed_components_overwritten" => rejects_spoiled(|made| made.scattered = field(made.of.len()))),
    ];
    checks.extend(HARNESSES.iter().copied().map(model_checked));
    Claim {
        id: "14",
        title: "The numbers of the unknowns and the pattern of the matrix",
        paper: "Nothing: the paper has no matrix.",
        statement: "Neighbours of a node: itself and the nodes that share a triangle with it, each once. Numbers: the free components of the nodes have 0, 1, 2, ... in the given order, each one number, the prescribed ones none, and each number leads back to its node; gather and scatter invert each other there and leave the rest alone. Columns of the lower triangle: one after the other, starts not decreasing from 0 to the number of entries; the rows of a column increase, the diagonal first, and are those numbers from its own on whose nodes are neighbours of its node, no other. Adding element matrices: each entry is the sum over the triangles of what belongs to its row and its column. On meshes: the matrix of A(.,.) is the sum of the element matrices and of the contact terms. Wrong data do not panic: what names no node counts for nothing, a node that comes a second time in the order keeps its numbers.",
        numbers: "whole numbers; on meshes doubles, bit for bit, for both sides add in the same order.",
        kernel: &[
            "pattern::Lists::range",
            "pattern::Lists::of",
            "pattern::triangles_of_nodes",
            "pattern::neighbours",
            "pattern::number",
            "pattern::gather",
            "pattern::scatter",
            "pattern::column_ends",
            "pattern::column_rows",
            "pattern::add",
        ],
        preconditions: "Slices as long as the functions ask for; `fem::matrix`, which the first three checks and the meshes go through, allocates them.",
        limits: "Random data of up to ten nodes and eight elements, meshes of up to 3 x 3 cells; all cases of two triangles on four nodes, and all lists of four of three nodes on one triangle. The harnesses are about one step each, on data of any value.",
        single: Some(
            "Whole numbers: there is nothing to prove over an ordered field, and nothing is rounded.",
        ),
        checks,
    }
}
