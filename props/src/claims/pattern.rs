//! The numbers of the unknowns and the pattern of the matrix, over whole numbers: a component of the displacement has a
//! number exactly if it is free, two numbers have an entry exactly if their nodes share a triangle, and an element matrix
//! adds to its own entries.
//!
//! | what | for which data | how |
//! | --- | --- | --- |
//! | each step of `kernel::pattern` | all data of a very small size, wrong ones included | harnesses |
//! | all of them together, as `fem::matrix` calls them | random triangles and orders, wrong ones included; all pairs of triangles on four nodes; rectangles and trapezoids, P1 and P2 | sets and dense matrices |

use signorini::kernel::pattern::{
    Lists, Numbers, add, column_ends, column_rows, gather, neighbours, number, scatter,
    triangles_of_nodes,
};

use crate::harness::{any, assume};
use crate::harnesses;

/// Any number below `bound`.
fn below(bound: u8) -> usize {
    usize::from(any::<u8>() % bound)
}

/// Any number, a small one often where it is drawn.
fn wild() -> usize {
    if any() { below(4) } else { any() }
}

/// How often `k` stands in a list.
fn times(list: &[usize], k: usize) -> usize {
    list.iter().filter(|&&member| member == k).count()
}

/// Two triangles on nodes 0 to 3; node 4 does not exist.
fn two_triangles() -> [[usize; 3]; 2] {
    [(); 2].map(|()| [(); 3].map(|()| below(5)))
}

/// Four nodes with two of two triangles listed for each, which may be the same.
const TWO_EACH: [usize; 5] = [0, 2, 4, 6, 8];

/// Whether `b` is `a` or stands on a triangle that is listed for `a`.
fn meet(elements: &[[usize; 3]], triangles: Lists, a: usize, b: usize) -> bool {
    a == b || triangles.of(a).iter().any(|&t| elements[t].contains(&b))
}

/// Any choice of prescribed components.
fn prescribed<const NODES: usize>() -> [[Option<()>; 2]; NODES] {
    [(); NODES].map(|()| [any::<bool>(), any::<bool>()].map(|fixed| fixed.then_some(())))
}

fn free(values: [Option<()>; 2]) -> usize {
    usize::from(values[0].is_none()) + usize::from(values[1].is_none())
}

/// What the number of component `c` of the node at place `p` of the order must be: how many components are free before it.
fn expected(order: &[usize], prescribed: &[[Option<()>; 2]], p: usize, c: usize) -> Option<usize> {
    let values = prescribed[order[p]];
    let before = |q: usize| {
        let counts = order[q] < prescribed.len() && times(&order[..q], order[q]) == 0;
        if counts { free(prescribed[order[q]]) } else { 0 }
    };
    let earlier: usize = (0..p).map(before).sum();
    values[c].is_none().then_some(earlier + usize::from(c == 1 && values[0].is_none()))
}

/// The numbers of the free components of some nodes, and back.
struct Numbered<const NODES: usize> {
    of: [[Option<usize>; 2]; NODES],
    nodes: [usize; 6],
    count: usize,
}

impl<const NODES: usize> Numbered<NODES> {
    fn new(order: &[usize], prescribed: &[[Option<()>; 2]; NODES]) -> Self {
        let mut numbered = Numbered { of: [[Some(9); 2]; NODES], nodes: [9; 6], count: 0 };
        numbered.count = number(order, prescribed, &mut numbered.of, &mut numbered.nodes);
        numbered
    }

    fn numbers(&self) -> Numbers<'_> {
        Numbers { of: &self.of, nodes: &self.nodes[..self.count] }
    }
}

/// Three nodes in any order, each component free or not.
fn three_numbered() -> Numbered<3> {
    let order = [below(3), below(3), below(3)];
    Numbered::new(&order, &prescribed())
}

/// For each of three nodes: itself, then any of the two others or none (3 is no node), in any order.
fn three_lists() -> [usize; 9] {
    let mut members = [3; 9];
    for node in 0..3 {
        let [a, b] = [(node + 1) % 3, (node + 2) % 3].map(|other| if any() { other } else { 3 });
        let (a, b) = if any() { (a, b) } else { (b, a) };
        members[3 * node] = node;
        members[3 * node + 1] = a;
        members[3 * node + 2] = b;
    }
    members
}

const THREE_EACH: [usize; 4] = [0, 3, 6, 9];

/// The lower triangle over at most six numbers.
struct Columns {
    starts: [usize; 7],
    ends: [usize; 7],
    rows: [usize; 21],
    count: usize,
}

impl Columns {
    fn new(numbers: Numbers, neighbours: Lists) -> Columns {
        let count = numbers.nodes.len();
        let mut ends = [9; 7];
        column_ends(numbers, neighbours, &mut ends[..=count]);
        let (mut starts, mut rows) = (ends, [9; 21]);
        column_rows(numbers, neighbours, &mut starts[..=count], &mut rows);
        Columns { starts, ends, rows, count }
    }

    fn lists(&self) -> Lists<'_> {
        Lists { starts: &self.starts[..=self.count], members: &self.rows }
    }
}

harnesses! {
    /// A list is what stands between its start and its end, if there is such a place.
    holds a_list_is_between_its_ends_or_empty_for_three_starts_and_members_of_any_value() {
        let starts: [usize; 3] = [any(), any(), any()];
        let members: [usize; 3] = [any(), any(), any()];
        let (i, k): (usize, usize) = (any(), below(3));
        let list = Lists { starts: &starts, members: &members }.of(i);
        if i < 2 && starts[i] <= starts[i + 1] && starts[i + 1] <= 3 {
            assert!(list.len() == starts[i + 1] - starts[i]);
            assert!(k >= list.len() || list[k] == members[starts[i] + k]);
        } else {
            assert!(list.is_empty());
        }
    }
    /// The false twin: the last start has a list too.
    fails control_a_list_is_between_its_start_and_the_last_member_for_three_starts([0.0; 5]) {
        let starts = [0, below(4), below(4)];
        let members: [usize; 3] = [any(), any(), any()];
        assume(starts[1] <= starts[2]);
        let list = Lists { starts: &starts, members: &members }.of(2);
        assert!(list.len() == members.len() - starts[2]);
    }
    /// Starts begin at 0, do not decrease, and end at how many there are.
    holds starts_of_lists_of_triangles_do_not_decrease_for_two_triangles_on_four_nodes_or_none() {
        let elements = two_triangles();
        let (mut starts, mut triangles) = ([9; 5], [9; 6]);
        triangles_of_nodes(&elements, &mut starts, &mut triangles);
        let i = below(4);
        assert!(starts[0] == 0 && starts[i] <= starts[i + 1]);
        assert!(starts[4] == 6 - times(elements.as_flattened(), 4));
    }
    /// The false twin: they increase.
    fails control_starts_of_lists_of_triangles_increase_for_two_triangles_on_four_nodes([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]) {
        let elements = two_triangles();
        let (mut starts, mut triangles) = ([9; 5], [9; 6]);
        triangles_of_nodes(&elements, &mut starts, &mut triangles);
        let i = below(4);
        assert!(starts[i] < starts[i + 1]);
    }
    /// A triangle is listed for a node as often as the node stands on it, and triangles come in increasing order.
    holds triangles_are_listed_for_their_nodes_for_two_triangles_on_four_nodes_or_none() {
        let elements = two_triangles();
        let (mut starts, mut triangles) = ([9; 5], [9; 6]);
        triangles_of_nodes(&elements, &mut starts, &mut triangles);
        let (node, t) = (below(4), below(2));
        let list = Lists { starts: &starts, members: &triangles }.of(node);
        assert!(times(list, t) == times(&elements[t], node));
        assert!(list.len() <= 6 && list.windows(2).all(|pair| pair[0] <= pair[1]));
    }
    /// The false twin: at most once.
    fails control_triangles_are_listed_once_for_their_nodes_for_two_triangles_on_four_nodes([0.0, 0.0, 1.0, 1.0, 2.0, 3.0, 0.0, 0.0]) {
        let elements = two_triangles();
        let (mut starts, mut triangles) = ([9; 5], [9; 6]);
        triangles_of_nodes(&elements, &mut starts, &mut triangles);
        let (node, t) = (below(4), below(2));
        let list = Lists { starts: &starts, members: &triangles }.of(node);
        assert!(times(list, t) <= 1);
    }
    /// The neighbours of a node are itself and the nodes of the triangles that are listed for it, each once.
    holds neighbours_are_complete_and_unique_for_any_two_of_two_triangles_on_four_nodes_or_none() {
        let elements = two_triangles();
        let members = [(); 4].map(|()| [below(2), below(2)]);
        let triangles = Lists { starts: &TWO_EACH, members: members.as_flattened() };
        let (mut seen_by, mut starts, mut around) = ([9; 4], [9; 5], [9; 28]);
        neighbours(&elements, triangles, &mut seen_by, &mut starts, &mut around);
        let (a, b) = (below(4), below(5));
        assert!(starts[0] == 0 && starts[a] <= starts[a + 1] && starts[4] <= 16);
        let list = Lists { starts: &starts, members: &around }.of(a);
        assert!(times(list, b) == usize::from(b < 4 && meet(&elements, triangles, a, b)));
    }
    /// The false twin: a neighbour is listed for each triangle that they share.
    fails control_neighbours_are_listed_for_each_triangle_for_any_two_triangles_on_four_nodes([
        0.0, 1.0, 2.0, 0.0, 1.0, 3.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0,
    ]) {
        let elements = two_triangles();
        let members = [(); 4].map(|()| [below(2), below(2)]);
        let triangles = Lists { starts: &TWO_EACH, members: members.as_flattened() };
        let (mut seen_by, mut starts, mut around) = ([9; 4], [9; 5], [9; 28]);
        neighbours(&elements, triangles, &mut seen_by, &mut starts, &mut around);
        let (a, b) = (below(4), below(4));
        assume(a != b);
        let list = Lists { starts: &starts, members: &around }.of(a);
        let shared = triangles.of(a).iter().filter(|&&t| elements[t].contains(&b)).count();
        assert!(times(list, b) == shared);
    }
    /// A free component has the number of free components before it; a prescribed one has none.
    holds numbers_follow_the_order_for_three_nodes_in_any_list_of_four() {
        let order = [below(4), below(4), below(4), below(4)];
        let prescribed = prescribed::<3>();
        let numbered = Numbered::new(&order, &prescribed);
        let (p, c) = (below(4), below(2));
        assume(order[p] < 3 && times(&order[..p], order[p]) == 0);
        assert!(numbered.of[order[p]][c] == expected(&order, &prescribed, p, c));
    }
    /// The false twin: prescribed components are counted.
    fails control_numbers_count_all_components_for_three_nodes_in_any_order([
        0.0, 1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0,
    ]) {
        let order = [below(3), below(3), below(3)];
        let prescribed = prescribed::<3>();
        let numbered = Numbered::new(&order, &prescribed);
        let (p, c) = (below(3), below(2));
        assume(times(&order[..p], order[p]) == 0 && prescribed[order[p]][c].is_none());
        assert!(numbered.of[order[p]][c] == Some(2 * p + c));
    }
    /// Each number below the count leads to the one node that has it, and what is not in the order has none.
    holds numbers_and_nodes_invert_each_other_for_three_nodes_in_any_list_of_four() {
        let order = [below(4), below(4), below(4), below(4)];
        let numbered = Numbered::new(&order, &prescribed::<3>());
        let (node, c, k) = (below(3), below(2), below(6));
        if let Some(k) = numbered.of[node][c] {
            assert!(k < numbered.count && numbered.nodes[k] == node && order.contains(&node));
        }
        assert!(numbered.count <= 6);
        if k < numbered.count {
            let numbers = numbered.of[numbered.nodes[k]];
            assert!((numbers[0] == Some(k)) != (numbers[1] == Some(k)));
        }
    }
    /// The false twin: they are six.
    fails control_all_components_are_numbered_for_three_nodes_in_any_order([
        0.0, 1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]) {
        let order = [below(3), below(3), below(3)];
        assert!(Numbered::new(&order, &prescribed::<3>()).count == 6);
    }
    /// Gather, then scatter: the free components are back, the prescribed ones are left alone. Scatter, then gather: the
    /// vector is back.
    holds gather_and_scatter_invert_each_other_for_three_nodes_in_any_order() {
        let numbered = three_numbered();
        let field = [(); 3].map(|()| [any::<i8>(), any::<i8>()]);
        let old = [(); 3].map(|()| [any::<i8>(), any::<i8>()]);
        let (mut vector, mut back, mut again) = ([0; 6], old, [0; 6]);
        gather(&numbered.of, &field, &mut vector[..numbered.count]);
        scatter(&numbered.of, &vector[..numbered.count], &mut back);
        gather(&numbered.of, &back, &mut again[..numbered.count]);
        let (node, c, k) = (below(3), below(2), below(6));
        let free = numbered.of[node][c].is_some();
        assert!(back[node][c] == if free { field[node][c] } else { old[node][c] });
        assert!(vector[k] == again[k]);
    }
    /// The false twin: the prescribed components are back too.
    fails control_gather_and_scatter_restore_all_for_three_nodes_in_any_order([
        0.0, 1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]) {
        let numbered = three_numbered();
        let field = [(); 3].map(|()| [any::<i8>(), any::<i8>()]);
        let (mut vector, mut back) = ([0; 6], [[0; 2]; 3]);
        gather(&numbered.of, &field, &mut vector[..numbered.count]);
        scatter(&numbered.of, &vector[..numbered.count], &mut back);
        let (node, c) = (below(3), below(2));
        assert!(back[node][c] == field[node][c]);
    }
    /// Columns end where the next ones start, one after the other, and have as many rows as the neighbours say.
    holds columns_follow_each_other_for_three_nodes_with_any_neighbours_in_any_order() {
        let (numbered, members) = (three_numbered(), three_lists());
        let neighbours = Lists { starts: &THREE_EACH, members: &members };
        let columns = Columns::new(numbered.numbers(), neighbours);
        let column = below(6);
        assume(column < columns.count);
        let length = (column..columns.count)
            .filter(|&r| times(neighbours.of(numbered.nodes[r]), numbered.nodes[column]) == 1)
            .count();
        assert!(columns.starts[0] == 0 && columns.starts[column + 1] == columns.ends[column]);
        assert!(columns.ends[column] - columns.starts[column] == length);
        assert!(columns.ends[columns.count] == columns.ends[columns.count - 1]);
    }
    /// The false twin: the whole matrix in place of the lower triangle.
    fails control_columns_have_a_row_for_each_neighbour_for_three_nodes_in_any_order([
        0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]) {
        let (numbered, members) = (three_numbered(), three_lists());
        let neighbours = Lists { starts: &THREE_EACH, members: &members };
        let columns = Columns::new(numbered.numbers(), neighbours);
        let column = below(6);
        assume(column < columns.count);
        let length = (0..columns.count)
            .filter(|&r| times(neighbours.of(numbered.nodes[r]), numbered.nodes[column]) == 1)
            .count();
        assert!(columns.ends[column] - columns.starts[column] == length);
    }
    /// Two numbers have one entry in the lower triangle if the nodes are neighbours, else none.
    holds columns_are_complete_for_three_nodes_with_any_neighbours_in_any_order() {
        let (numbered, members) = (three_numbered(), three_lists());
        let neighbours = Lists { starts: &THREE_EACH, members: &members };
        let columns = Columns::new(numbered.numbers(), neighbours);
        let (row, column) = (below(6), below(6));
        assume(row < columns.count && column < columns.count);
        let near = times(neighbours.of(numbered.nodes[row]), numbered.nodes[column]);
        let expected = if row >= column { near } else { 0 };
        assert!(times(columns.lists().of(column), row) == expected);
    }
    /// The false twin: all pairs have one.
    fails control_columns_are_full_for_three_nodes_with_any_neighbours_in_any_order([
        0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0,
    ]) {
        let (numbered, members) = (three_numbered(), three_lists());
        let neighbours = Lists { starts: &THREE_EACH, members: &members };
        let columns = Columns::new(numbered.numbers(), neighbours);
        let (row, column) = (below(6), below(6));
        assume(column <= row && row < columns.count);
        assert!(times(columns.lists().of(column), row) == 1);
    }
    /// Rows increase, and the diagonal is first.
    holds rows_are_sorted_and_the_diagonal_is_first_for_three_nodes_with_any_neighbours() {
        let (numbered, members) = (three_numbered(), three_lists());
        let neighbours = Lists { starts: &THREE_EACH, members: &members };
        let columns = Columns::new(numbered.numbers(), neighbours);
        let (column, k) = (below(6), below(6));
        assume(column < columns.count);
        let rows = columns.lists().of(column);
        assert!(rows[0] == column);
        assert!(k + 1 >= rows.len() || rows[k] < rows[k + 1]);
    }
    /// The false twin: rows follow each other without gaps.
    fails control_rows_follow_each_other_for_three_nodes_with_any_neighbours([
        0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0,
    ]) {
        let (numbered, members) = (three_numbered(), three_lists());
        let neighbours = Lists { starts: &THREE_EACH, members: &members };
        let columns = Columns::new(numbered.numbers(), neighbours);
        let (column, k) = (below(6), below(6));
        assume(column < columns.count);
        let rows = columns.lists().of(column);
        assume(k + 1 < rows.len());
        assert!(rows[k] + 1 == rows[k + 1]);
    }
    /// What is added to an entry is the sum over the element matrix of what belongs to its row and column.
    holds blocks_are_added_to_their_entries_for_an_element_of_two_of_two_nodes() {
        let numbered = Numbered::new(&[below(2), below(2)], &prescribed::<2>());
        let around = Lists { starts: &[0, 2, 4], members: &[0, 1, 1, 0] };
        let columns = Columns::new(numbered.numbers(), around);
        let nodes = [below(3), below(3)];
        let block = [(); 2].map(|()| [(); 2].map(|()| [(); 2].map(|()| [(); 2].map(|()| any::<i8>()))));
        let mut values = [1_i32; 21];
        add(&numbered.of, columns.lists(), &mut values, &nodes, |i, j| {
            block[i][j].map(|row| row.map(i32::from))
        });
        let (row, column) = (below(4), below(4));
        assume(column <= row && row < columns.count);
        let mut sum = 1;
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            for (c, d) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                if nodes[i] < 2
                    && nodes[j] < 2
                    && numbered.of[nodes[i]][c] == Some(row)
                    && numbered.of[nodes[j]][d] == Some(column)
                {
                    sum += i32::from(block[i][j][c][d]);
                }
            }
        }
        let start = columns.starts[column];
        let Some(k) = columns.lists().of(column).iter().position(|&r| r == row) else {
            panic!("two nodes that are neighbours have all entries");
        };
        assert!(values[start + k] == sum);
    }
    /// The false twin: rows and columns of the element matrix exchanged.
    fails control_transposed_blocks_are_added_for_an_element_of_two_nodes([
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]) {
        let numbered = Numbered::new(&[0, 1], &prescribed::<2>());
        let around = Lists { starts: &[0, 2, 4], members: &[0, 1, 1, 0] };
        let columns = Columns::new(numbered.numbers(), around);
        assume(columns.count == 4);
        let block = [(); 2].map(|()| [(); 2].map(|()| [(); 2].map(|()| [(); 2].map(|()| any::<i8>()))));
        let mut values = [0_i32; 21];
        add(&numbered.of, columns.lists(), &mut values, &[0, 1], |i, j| {
            block[i][j].map(|row| row.map(i32::from))
        });
        assert!(values[columns.starts[0] + 3] == i32::from(block[0][1][0][1]));
    }
    /// Whatever the numbers are, nothing panics, and nothing is added where there is no entry.
    holds wrong_data_are_taken_without_a_panic_for_lists_of_two_of_any_value() {
        let of = [[any::<bool>().then(wild), any::<bool>().then(wild)]];
        let nodes: [usize; 2] = [wild(), wild()];
        let starts: [usize; 3] = [wild(), wild(), wild()];
        let members: [usize; 2] = [wild(), wild()];
        let lists = Lists { starts: &starts, members: &members };
        let (mut new_starts, mut rows, mut seen) = (starts, members, [wild()]);
        let elements = [[wild(), wild()]];
        triangles_of_nodes(&elements, &mut new_starts, &mut rows);
        neighbours(&elements, lists, &mut seen, &mut new_starts, &mut rows);
        column_ends(Numbers { of: &of, nodes: &nodes }, lists, &mut new_starts);
        column_rows(Numbers { of: &of, nodes: &nodes }, lists, &mut new_starts, &mut rows);
        let (mut values, mut field) = ([0_u8; 2], [[0_u8; 2]]);
        add(&of, lists, &mut values, &nodes, |_, _| [[1; 2]; 2]);
        assert!(lists.of(0).len() + lists.of(1).len() > 0 || (values[0] == 0 && values[1] == 0));
        gather(&of, &[[1, 1]], &mut values);
        scatter(&of, &values, &mut field);
        let (mut numbers, mut short) = (of, [0]);
        assert!(number(&nodes, &[[None::<()>; 2]], &mut numbers, &mut short) <= 1);
    }
    /// The false twin: wrong data have room for all numbers.
    fails control_wrong_data_are_numbered_all_the_same_for_two_of_any_value([0.0, 0.0]) {
        let nodes: [usize; 2] = [any(), any()];
        let (mut of, mut short) = ([[None; 2]], [0]);
        assert!(number(&nodes, &[[None::<()>; 2]], &mut of, &mut short) == 2);
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row {
    use std::collections::{BTreeMap, BTreeSet};

    use proptest::prelude::*;
    use signorini::fem::contact_line::EdgeRule;
    use signorini::fem::matrix::{LowerTriangle, Neighbours, Numbering, assemble};
    use signorini::fem::{
        BoxedFunction, Condition, Diagonal, Discretization, Problem, Rectangle, Trapezoid,
    };
    use signorini::kernel::edge_integral::ExactEdge;
    use signorini::kernel::element::stiffness;
    use signorini::kernel::{Material, P1, P2, Plane};
    use signorini::nalgebra::Matrix2;

    use crate::claim::{Claim, Engine, Outcome, by, control, model_checked};
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
            Neighbours::new(self.nodes(), &self.elements)
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

    fn random_triangles() -> Outcome {
        draws::hold(3000, draws::<3>(), &CLASSES, |draw| draw.judge(&draw.made()))
    }

    fn random_elements_of_six() -> Outcome {
        draws::hold(1000, draws::<6>(), &CLASSES, |draw| draw.judge(&draw.made()))
    }

    /// The data of all pairs of triangles on four nodes: the triangles leave out one node each.
    fn all_pairs() -> impl Iterator<Item = Draw<3>> {
        const LEFT_OUT: [[usize; 3]; 4] = [[1, 2, 3], [3, 2, 0], [0, 1, 3], [2, 1, 0]];
        let pairs = (0..4).flat_map(|a| (0..4).map(move |b| vec![LEFT_OUT[a], LEFT_OUT[b]]));
        let orders = (0..256_usize).map(|n| [n % 4, n / 4 % 4, n / 16 % 4, n / 64]);
        let permutations: Vec<[usize; 4]> =
            orders.filter(|o| (0..4).all(|node| o.contains(&node))).collect();
        pairs.flat_map(move |elements| {
            permutations.clone().into_iter().flat_map(move |order| {
                let elements = elements.clone();
                // Components 2 i + c whose bit is set are prescribed.
                (0..256_usize).map(move |mask| Draw {
                    elements: elements.clone(),
                    order: order.to_vec(),
                    prescribed: (0..4)
                        .map(|i| [0, 1].map(|c| (mask >> (2 * i + c) & 1 == 1).then_some(0.0)))
                        .collect(),
                })
            })
        })
    }

    fn pairs_of_triangles() -> Outcome {
        let mut cases = 0;
        for draw in all_pairs() {
            cases += 1;
            if let Verdict::Fails(why) = draw.judge(&draw.made()) {
                return Err(format!("{why} fails for {draw:?}"));
            }
        }
        Ok(format!("all {cases} cases: 16 pairs, 24 orders, 256 sets of prescribed components"))
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
        let zero = || -> BoxedFunction { Box::new(|_: [f64; 2]| 0.0) };
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
    fn on_mesh<E, const N: usize, const M: usize>(
        mesh: Mesh,
        made: impl Fn(&Draw<N>) -> Made,
        edges: impl Fn(f64) -> f64,
    ) -> Verdict
    where
        E: ExactEdge<f64, N, M>,
    {
        let problem = problem(mesh);
        let d = Discretization::<E, N, M>::new(&problem, |c| c.limit() / 2.0, EdgeRule::Exact)
            .expect("a problem");
        let draw = shuffled(d.space.nodes().len(), d.space.elements(), mesh.3);
        if let Verdict::Fails(why) = draw.judge(&made(&draw)) {
            return Verdict::Fails(why);
        }
        let numbering = draw.numbering();
        let assembled = assemble(&d, &numbering, &draw.neighbours());
        let n = numbering.count;
        let mut dense = vec![vec![0.0; n]; n];
        let mut add = |nodes: &[usize; N], k: &dyn Fn(usize, usize) -> Matrix2<f64>| {
            for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
                for (c, d) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let of = (numbering.of[nodes[i]][c], numbering.of[nodes[j]][d]);
                    if let (Some(row), Some(column)) = of {
                        dense[row][column] += k(i, j)[(c, d)];
                    }
                }
            }
        };
        for (triangle, nodes) in d.space.triangles() {
            let k = stiffness::<E, f64, N, M>(&triangle, problem.material.of(0));
            add(nodes, &|i, j| k[i][j]);
        }
        for edge in &d.contact {
            let weight = edges(edge.gamma * edge.length);
            let nodes = &d.space.elements()[edge.edge.triangle];
            add(nodes, &|i, j| edge.functionals.stress_product(weight, i, j));
        }
        for column in 0..n {
            let range = assembled.starts[column]..assembled.starts[column + 1];
            for (&row, value) in assembled.rows[range.clone()].iter().zip(&assembled.values[range])
            {
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

    fn real_meshes() -> Outcome {
        draws::hold(150, meshes(), MESHES.as_flattened(), |&mesh| either(mesh, |weight| -weight))
    }

    /// The contact terms with the other sign.
    fn contact_added() -> Outcome {
        draws::reject(10, meshes(), |&mesh| either(mesh, |weight| weight))
    }

    /// Neighbours along two of the three sides of each triangle only: in a cell the nodes across the diagonal are
    /// forgotten.
    fn third_side_forgotten() -> Outcome {
        draws::reject(10, meshes(), |&mesh| {
            let forget = |draw: &Draw<3>| {
                let sides: Vec<[usize; 2]> =
                    draw.elements.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]).collect();
                let neighbours = Neighbours::new(draw.nodes(), &sides);
                draw.made_with(&neighbours, &draw.numbering(), block)
            };
            on_mesh::<P1, 3, 2>(mesh, forget, |weight| -weight)
        })
    }

    fn rejects(spoil: fn(&mut Made)) -> Outcome {
        draws::reject(200, draws::<3>(), |draw| {
            let mut made = draw.made();
            spoil(&mut made);
            draw.judge(&made)
        })
    }

    /// A neighbour listed twice.
    fn neighbour_twice() -> Outcome {
        rejects(|made| made.neighbours[0].extend_from_within(..1))
    }

    /// A number that no component has.
    fn number_skipped() -> Outcome {
        rejects(|made| {
            for number in made.of.as_flattened_mut().iter_mut().flatten() {
                *number += usize::from(*number > 0);
            }
        })
    }

    /// The first two rows of a column exchanged.
    fn rows_unsorted() -> Outcome {
        rejects(|made| {
            if made.matrix.starts.get(1).is_some_and(|&end| end > 1) {
                made.matrix.rows.swap(0, 1);
                made.matrix.values.swap(0, 1);
            }
        })
    }

    /// The last row of the last but one column counted to the last column.
    fn start_too_early() -> Outcome {
        rejects(|made| {
            let [.., start, _] = &mut made.matrix.starts[..] else { return };
            *start = start.saturating_sub(1);
        })
    }

    /// Prescribed components numbered like free ones.
    fn prescribed_numbered() -> Outcome {
        draws::reject(200, draws::<3>(), |draw| {
            let numbering = Numbering::new(&draw.order, &vec![[None; 2]; draw.nodes()]);
            draw.judge(&draw.made_with(&draw.neighbours(), &numbering, block))
        })
    }

    /// Rows and columns of the element matrices exchanged.
    fn blocks_transposed() -> Outcome {
        draws::reject(200, draws::<3>(), |draw| {
            let transposed = |e, i, j| {
                let [[a, b], [c, d]] = block(e, j, i);
                [[a, c], [b, d]]
            };
            draw.judge(&draw.made_with(&draw.neighbours(), &draw.numbering(), transposed))
        })
    }

    /// A vector scattered onto the prescribed components too.
    fn prescribed_overwritten() -> Outcome {
        rejects(|made| made.scattered = field(made.of.len()))
    }

    /// The row of the pattern.
    pub fn claim() -> Claim {
        use Engine::Exact;
        let mut checks = vec![
            by(
                Exact,
                "pattern_numbers_and_sums_are_as_defined_on_random_triangles",
                random_triangles,
            ),
            by(
                Exact,
                "pattern_numbers_and_sums_are_as_defined_on_random_elements_of_six_nodes",
                random_elements_of_six,
            ),
            by(
                Exact,
                "pattern_numbers_and_sums_are_as_defined_for_all_pairs_of_triangles_on_four_nodes",
                pairs_of_triangles,
            ),
            by(Exact, "assembled_matrices_of_meshes_are_the_sums_of_their_parts", real_meshes),
            control(Exact, "control_contact_terms_with_the_other_sign", contact_added),
            control(Exact, "control_pairs_across_the_diagonal_forgotten", third_side_forgotten),
            control(Exact, "control_neighbour_listed_twice", neighbour_twice),
            control(Exact, "control_number_skipped", number_skipped),
            control(Exact, "control_rows_unsorted", rows_unsorted),
            control(Exact, "control_column_starts_one_too_early", start_too_early),
            control(Exact, "control_prescribed_components_numbered", prescribed_numbered),
            control(Exact, "control_element_matrices_transposed", blocks_transposed),
            control(Exact, "control_prescribed_components_overwritten", prescribed_overwritten),
        ];
        checks.extend(HARNESSES.iter().copied().map(model_checked));
        Claim {
            id: "14",
            items: &["sparse pattern"],
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
            limits: "Random data of up to seven nodes (ten for elements of six) and eight elements, all pairs of triangles on four nodes, meshes of up to 3 x 3 cells. A harness is about one step for data of its size: lists of neighbours are any lists there, and that the steps fit together is checked by the exact engine. An arrangement of numbers in which those of a node do not follow each other is not the dof map's, and then only the absence of panics is said.",
            single: Some(
                "Whole numbers: there is nothing to prove over an ordered field, and nothing is rounded. The harnesses for the model checker, which are the other engine, have no receipt yet.",
            ),
            checks,
        }
    }
}
