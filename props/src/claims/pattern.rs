//! The numbers of the unknowns and the pattern of the matrix, over whole numbers: a component of the displacement has a
//! number exactly if it is free, two numbers have an entry exactly if their nodes share a triangle, and an element matrix
//! adds to its own entries.
//!
//! | what | for which data | how |
//! | --- | --- | --- |
//! | each step of `kernel::pattern` alone | numbers of any value among the data | harnesses |
//! | all of them together, as `fem::matrix` calls them | all pairs of triangles on four nodes in any order; all lists of four of three nodes | enumeration |
//! | the same | random triangles and orders, wrong ones included; rectangles and trapezoids, P1 and P2 | sets and dense matrices |
//!
//! A harness has either the numbers of the unknowns free or the lists, never both: what a model checker has to follow
//! through both takes it hours. That the steps fit together is enumerated.

use signorini::kernel::pattern::{
    Lists, Numbers, add, column_ends, column_rows, gather, neighbours, number, scatter,
    triangles_of_nodes,
};

use crate::harness::{any, assume};
use crate::harnesses;

fn bit() -> usize {
    usize::from(any::<bool>())
}

/// 0 to 3: where there are two nodes, 2 and 3 are none.
fn two_bits() -> usize {
    2 * bit() + bit()
}

/// Any number at all, or none.
fn perhaps() -> Option<usize> {
    any::<bool>().then(any)
}

fn two<T>(one: impl Fn() -> T) -> [T; 2] {
    [one(), one()]
}

/// How often `k` stands in the first `B` members of a list.
fn times<const B: usize>(list: &[usize], k: usize) -> usize {
    let mut times = 0;
    for i in 0..B {
        times += usize::from(i < list.len() && list[i] == k);
    }
    times
}

/// The neighbours of nodes 0, 1 and 2 with one element listed for each; the elements are \[0, 1\] and \[1, 2\].
fn neighbours_of_three(listed: &[usize; 3]) -> ([usize; 4], [usize; 9]) {
    let lists = Lists { starts: &[0, 1, 2, 3], members: listed };
    let (mut seen_by, mut starts, mut around) = ([9; 3], [9; 4], [9; 9]);
    neighbours(&[[0, 1], [1, 2]], lists, &mut seen_by, &mut starts, &mut around);
    (starts, around)
}

/// Any choice of prescribed components of two nodes.
fn prescribed() -> [[Option<()>; 2]; 2] {
    let any = || any::<bool>().then_some(());
    [[any(), any()], [any(), any()]]
}

fn free(values: [Option<()>; 2]) -> usize {
    usize::from(values[0].is_none()) + usize::from(values[1].is_none())
}

/// Three nodes of two, or none, in any order and any number of times.
fn order() -> [usize; 3] {
    [two_bits(), two_bits(), two_bits()]
}

/// Where in the order a node comes first; 3 if it doesn't.
fn first(order: &[usize; 3], node: usize) -> usize {
    if order[0] == node {
        0
    } else if order[1] == node {
        1
    } else if order[2] == node {
        2
    } else {
        3
    }
}

/// The numbers of the free components of two nodes, and back.
struct Numbered {
    of: [[Option<usize>; 2]; 2],
    nodes: [usize; 4],
    count: usize,
}

impl Numbered {
    fn new(order: &[usize], prescribed: &[[Option<()>; 2]; 2]) -> Numbered {
        let mut numbered = Numbered { of: [[Some(9); 2]; 2], nodes: [9; 4], count: 0 };
        numbered.count = number(order, prescribed, &mut numbered.of, &mut numbered.nodes);
        numbered
    }
}

/// Node 0 has the numbers 1 and 2, node 1 has 0 for its second component.
const OF: [[Option<usize>; 2]; 2] = [[Some(1), Some(2)], [None, Some(0)]];
const NODES: [usize; 3] = [1, 0, 0];
/// The lower triangle over these numbers when the two nodes are neighbours.
const FULL: Lists = Lists { starts: &[0, 3, 5, 6], members: &[0, 1, 2, 1, 2, 2] };

/// The lower triangle over these numbers for any two neighbours of each node, which may be none.
struct Columns {
    ends: [usize; 4],
    starts: [usize; 4],
    rows: [usize; 8],
}

impl Columns {
    fn new(members: &[usize; 4]) -> Columns {
        let numbers = Numbers { of: &OF, nodes: &NODES };
        let lists = Lists { starts: &[0, 2, 4], members };
        let mut ends = [9; 4];
        column_ends(numbers, lists, &mut ends);
        let (mut starts, mut rows) = (ends, [9; 8]);
        column_rows(numbers, lists, &mut starts, &mut rows);
        Columns { ends, starts, rows }
    }

    fn of(&self, column: usize) -> &[usize] {
        Lists { starts: &self.starts, members: &self.rows }.of(column)
    }
}

harnesses! {
    /// A list is what stands between its start and its end, if there is such a place.
    holds a_list_is_between_its_ends_or_empty_for_three_starts_and_members_of_any_value() {
        let starts: [usize; 3] = [any(), any(), any()];
        let members: [usize; 3] = [any(), any(), any()];
        let (i, k): (usize, usize) = (any(), two_bits());
        let list = Lists { starts: &starts, members: &members }.of(i);
        if i < 2 && starts[i] <= starts[i + 1] && starts[i + 1] <= 3 {
            assert!(list.len() == starts[i + 1] - starts[i]);
            assert!(k >= list.len() || list[k] == members[starts[i] + k]);
        } else {
            assert!(list.is_empty());
        }
    }
    /// The false twin: the last start has a list too.
    fails control_a_list_is_between_its_start_and_the_last_member_for_three_starts([0.0; 7]) {
        let starts = [0, two_bits(), two_bits()];
        let members: [usize; 3] = [any(), any(), any()];
        assume(starts[1] <= starts[2]);
        let list = Lists { starts: &starts, members: &members }.of(2);
        assert!(list.len() == members.len() - starts[2]);
    }
    /// The same on two given elements, for lists with members of any value: what is no element counts for nothing.
    holds neighbours_come_from_listed_elements_for_three_nodes_and_lists_of_any_value() {
        let listed = [any(), any(), any()];
        let (starts, around) = neighbours_of_three(&listed);
        let (a, b) = (two_bits(), two_bits());
        assume(a < 3 && b < 3);
        let list = Lists { starts: &starts, members: &around }.of(a);
        let met = match listed[a] {
            0 => b == 0 || b == 1,
            1 => b == 1 || b == 2,
            _ => false,
        };
        assert!(list.len() <= 3 && times::<3>(list, b) == usize::from(a == b || met));
    }
    /// The false twin: b is around a where a is around b, whatever the lists are.
    fails control_neighbours_are_mutual_for_three_nodes_and_lists_of_any_value([0.0, 9.0, 9.0, 0.0, 0.0, 0.0, 1.0]) {
        let (starts, around) = neighbours_of_three(&[any(), any(), any()]);
        let (a, b) = (two_bits(), two_bits());
        assume(a < 3 && b < 3);
        let lists = Lists { starts: &starts, members: &around };
        assert!(times::<3>(lists.of(a), b) == times::<3>(lists.of(b), a));
    }
    /// A free component has the number of free components before it; a prescribed one has none.
    holds numbers_follow_the_order_for_two_nodes_in_any_list_of_three() {
        let (order, prescribed) = (order(), prescribed());
        let numbered = Numbered::new(&order, &prescribed);
        let (node, c) = (bit(), bit());
        let place = first(&order, node);
        let before = if first(&order, 1 - node) < place { free(prescribed[1 - node]) } else { 0 };
        let own = usize::from(c == 1 && prescribed[node][0].is_none());
        let numbered_at_all = place < 3 && prescribed[node][c].is_none();
        assert!(numbered.of[node][c] == numbered_at_all.then_some(before + own));
    }
    /// The false twin: prescribed components are counted.
    fails control_numbers_count_all_components_for_two_nodes_in_any_order([
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
    ]) {
        let (order, prescribed) = (order(), prescribed());
        let numbered = Numbered::new(&order, &prescribed);
        assume(order[0] < 2 && prescribed[order[0]][1].is_none());
        assert!(numbered.of[order[0]][1] == Some(1));
    }
    /// Gather, then scatter: the free components are back, the prescribed ones are left alone.
    holds scatter_restores_what_gather_took_for_two_nodes_and_any_i8() {
        let numbered = Numbered::new(&[1, 0], &prescribed());
        let field: [[i8; 2]; 2] = [[any(), any()], [any(), any()]];
        let old: [[i8; 2]; 2] = [[any(), any()], [any(), any()]];
        let (mut vector, mut back) = ([0; 4], old);
        gather(&numbered.of, &field, &mut vector);
        scatter(&numbered.of, &vector, &mut back);
        let (node, c) = (bit(), bit());
        let free = numbered.of[node][c].is_some();
        assert!(back[node][c] == if free { field[node][c] } else { old[node][c] });
    }
    /// The false twin: the prescribed components are back too.
    fails control_scatter_restores_prescribed_components_for_two_nodes([
        1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]) {
        let numbered = Numbered::new(&[1, 0], &prescribed());
        let field: [[i8; 2]; 2] = [[any(), any()], [any(), any()]];
        let (mut vector, mut back) = ([0; 4], [[0; 2]; 2]);
        gather(&numbered.of, &field, &mut vector);
        scatter(&numbered.of, &vector, &mut back);
        let (node, c) = (bit(), bit());
        assert!(back[node][c] == field[node][c]);
    }
    /// Scatter, then gather: the vector is back.
    holds gather_restores_what_scatter_wrote_for_two_nodes_and_any_i8() {
        let numbered = Numbered::new(&[1, 0], &prescribed());
        let vector: [i8; 4] = [any(), any(), any(), any()];
        let (mut field, mut back) = ([[0; 2]; 2], [0; 4]);
        scatter(&numbered.of, &vector, &mut field);
        gather(&numbered.of, &field, &mut back);
        let k = two_bits();
        assert!(k >= numbered.count || back[k] == vector[k]);
    }
    /// The false twin: what is beyond the count is back too.
    fails control_gather_restores_all_numbers_for_two_nodes([
        1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0,
    ]) {
        let numbered = Numbered::new(&[1, 0], &prescribed());
        let vector: [i8; 4] = [any(), any(), any(), any()];
        let (mut field, mut back) = ([[0; 2]; 2], [0; 4]);
        scatter(&numbered.of, &vector, &mut field);
        gather(&numbered.of, &field, &mut back);
        let k = two_bits();
        assert!(back[k] == vector[k]);
    }
    /// Columns end where the next ones start, one after the other, from 0 on.
    holds columns_follow_each_other_for_three_numbers_and_neighbours_of_any_value() {
        let Columns { ends, starts, .. } = Columns::new(&[any(), any(), any(), any()]);
        assert!(starts[0] == 0 && starts[1] == ends[0] && starts[2] == ends[1]);
        assert!(starts[3] == ends[2] && ends[3] == ends[2]);
    }
    /// The false twin: none of them is empty.
    fails control_columns_have_a_row_for_three_numbers_and_neighbours_of_any_value([9.0; 4]) {
        let Columns { starts, .. } = Columns::new(&[any(), any(), any(), any()]);
        assert!(starts[0] < starts[1]);
    }
    /// Two numbers have an entry in the lower triangle for each time that the node of the column is listed around that of
    /// the row, and no other.
    holds columns_are_complete_for_three_numbers_and_neighbours_of_any_value() {
        let members = [any(), 0, 1, any()];
        let columns = Columns::new(&members);
        let (row, column) = (two_bits(), two_bits());
        assume(row < 3 && column < 3);
        let listed = Lists { starts: &[0, 2, 4], members: &members }.of(NODES[row]);
        let expected = if row >= column { times::<2>(listed, NODES[column]) } else { 0 };
        assert!(times::<6>(columns.of(column), row) == expected);
    }
    /// The false twin: the whole matrix in place of the lower triangle.
    fails control_columns_are_those_of_the_whole_matrix_for_three_numbers([9.0, 0.0, 0.0, 0.0, 0.0, 1.0]) {
        let members = [any(), 0, 1, any()];
        let columns = Columns::new(&members);
        let (row, column) = (two_bits(), two_bits());
        assume(row < 3 && column < 3);
        let listed = Lists { starts: &[0, 2, 4], members: &members }.of(NODES[row]);
        assert!(times::<6>(columns.of(column), row) == times::<2>(listed, NODES[column]));
    }
    /// Rows do not decrease, and the diagonal is first where each node is around itself.
    holds rows_are_sorted_and_the_diagonal_is_first_for_three_numbers_and_neighbours_of_any_value() {
        let columns = Columns::new(&[any(), 0, 1, any()]);
        let (column, k) = (two_bits(), two_bits());
        assume(column < 3);
        let rows = columns.of(column);
        assert!(!rows.is_empty() && rows[0] == column);
        assert!(k + 1 >= rows.len() || rows[k] <= rows[k + 1]);
    }
    /// The false twin: a row is there once, whatever the lists are.
    fails control_rows_increase_for_three_numbers_and_neighbours_of_any_value([0.0, 9.0, 0.0, 1.0, 0.0, 0.0]) {
        let columns = Columns::new(&[any(), 0, 1, any()]);
        let (column, k) = (two_bits(), two_bits());
        assume(column < 3);
        let rows = columns.of(column);
        assert!(k + 1 >= rows.len() || rows[k] < rows[k + 1]);
    }
    /// What is added to an entry is what belongs to its row and column in the element matrix.
    holds blocks_are_added_to_their_entries_for_an_element_of_two_nodes_and_any_i8() {
        let b = two(|| two(|| two(|| two(|| i32::from(any::<i8>())))));
        let mut values = [1_i32; 6];
        add(&OF, FULL, &mut values, &[1, 0], |i, j| b[i][j]);
        assert!(values[0] == 1 + b[0][0][1][1]);
        assert!(values[1] == 1 + b[1][0][0][1] && values[2] == 1 + b[1][0][1][1]);
        assert!(values[3] == 1 + b[1][1][0][0] && values[4] == 1 + b[1][1][1][0]);
        assert!(values[5] == 1 + b[1][1][1][1]);
    }
    /// The false twin: rows and columns of the element matrix exchanged.
    fails control_transposed_blocks_are_added_for_an_element_of_two_nodes([
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]) {
        let b = two(|| two(|| two(|| two(|| i32::from(any::<i8>())))));
        let mut values = [1_i32; 6];
        add(&OF, FULL, &mut values, &[1, 0], |i, j| b[i][j]);
        assert!(values[1] == 1 + b[0][1][1][0]);
    }
    /// A node that is none adds nothing, and the other one what it has.
    holds nodes_that_are_none_add_nothing_for_an_element_on_numbers_of_any_value() within 4 {
        let (node, none): (usize, usize) = (any(), any());
        assume(none > 1);
        let mut values = [0_i32; 6];
        add(&OF, FULL, &mut values, &[node, none], |i, j| if i + j == 0 { [[1, 2], [3, 4]] } else { [[5; 2]; 2] });
        assert!(values[0] == if node == 1 { 4 } else { 0 } && values[1] == 0 && values[2] == 0);
        assert!(values[3] == if node == 0 { 1 } else { 0 } && values[4] == if node == 0 { 3 } else { 0 });
        assert!(values[5] == if node == 0 { 4 } else { 0 });
    }
    /// The false twin: then the element adds nothing at all.
    fails control_an_element_on_a_node_that_is_none_adds_nothing([0.0, 2.0]) within 4 {
        let (node, none): (usize, usize) = (any(), any());
        assume(none > 1);
        let mut values = [0_i32; 6];
        add(&OF, FULL, &mut values, &[node, none], |_, _| [[1; 2]; 2]);
        assert!(values[3] == 0);
    }
    /// Wrong nodes, and slices that are too short or hold anything: no panic, and no more members than there are nodes on
    /// the elements.
    holds wrong_elements_are_listed_without_a_panic_for_numbers_of_any_value() within 4 {
        let mut starts: [usize; 2] = [any(), any()];
        let mut members: [usize; 1] = [any()];
        triangles_of_nodes(&[[any(), any()]], &mut starts, &mut members);
        assert!(starts[1] <= 2);
    }
    /// The false twin: all of them are members.
    fails control_wrong_elements_are_listed_all_the_same([9.0; 5]) within 4 {
        let mut starts: [usize; 2] = [any(), any()];
        let mut members: [usize; 1] = [any()];
        triangles_of_nodes(&[[any(), any()]], &mut starts, &mut members);
        assert!(starts[1] == 2);
    }
    /// Wrong elements, lists and slices: no panic, and no more neighbours than there is room for.
    holds neighbours_of_wrong_elements_are_found_without_a_panic_for_numbers_of_any_value() within 4 {
        let members: [usize; 2] = [any(), any()];
        let (mut seen_by, mut around): ([usize; 1], [usize; 2]) = ([any()], [any(), any()]);
        let mut starts: [usize; 3] = [any(), any(), any()];
        let lists = Lists { starts: &[0, 1, 2], members: &members };
        neighbours(&[[any(), any()]], lists, &mut seen_by, &mut starts, &mut around);
        assert!(starts[0] == 0 && starts[1] <= 2 && starts[2] <= 2);
    }
    /// The false twin: the room is used.
    fails control_neighbours_of_wrong_elements_fill_the_room([9.0; 10]) within 4 {
        let members: [usize; 2] = [any(), any()];
        let (mut seen_by, mut around): ([usize; 1], [usize; 2]) = ([any()], [any(), any()]);
        let mut starts: [usize; 3] = [any(), any(), any()];
        let lists = Lists { starts: &[0, 1, 2], members: &members };
        neighbours(&[[any(), any()]], lists, &mut seen_by, &mut starts, &mut around);
        assert!(starts[2] == 2);
    }
    /// Wrong nodes in the order, and no room: no panic, and no more numbers than there is room for.
    holds wrong_orders_are_numbered_without_a_panic_for_numbers_of_any_value() within 4 {
        let (mut of, mut short) = ([[perhaps(), perhaps()]], [0]);
        assert!(number(&[any(), any()], &[[None::<()>; 2]], &mut of, &mut short) <= 1);
    }
    /// The false twin: there is room for all numbers.
    fails control_wrong_orders_are_numbered_all_the_same([0.0, 0.0]) within 4 {
        let (mut of, mut short) = ([[None; 2]], [0]);
        assert!(number(&[any(), any()], &[[None::<()>; 2]], &mut of, &mut short) == 2);
    }
    /// Wrong numbers and lists: no panic in columns and rows, and no more entries than two rows can have.
    holds wrong_numbers_have_columns_without_a_panic_for_numbers_of_any_value() within 4 {
        let of = [[perhaps(), perhaps()]];
        let nodes: [usize; 2] = [any(), any()];
        let members: [usize; 1] = [any()];
        let numbers = Numbers { of: &of, nodes: &nodes };
        let lists = Lists { starts: &[0, 1], members: &members };
        let (mut counts, mut rows): ([usize; 3], [usize; 2]) = ([any(), any(), any()], [any(), any()]);
        column_ends(numbers, lists, &mut counts);
        assert!(counts[2] <= 4);
        let mut starts: [usize; 3] = [any(), any(), any()];
        column_rows(numbers, lists, &mut starts, &mut rows);
    }
    /// The false twin: they have no entries at all.
    fails control_wrong_numbers_have_no_entries([1.0, 0.0, 0.0, 0.0, 9.0, 0.0, 9.0, 9.0, 9.0]) within 4 {
        let of = [[perhaps(), perhaps()]];
        let nodes: [usize; 2] = [any(), any()];
        let members: [usize; 1] = [any()];
        let lists = Lists { starts: &[0, 1], members: &members };
        let mut counts: [usize; 3] = [any(), any(), any()];
        column_ends(Numbers { of: &of, nodes: &nodes }, lists, &mut counts);
        assert!(counts[2] == 0);
    }
    /// Wrong numbers, nodes and rows: no panic, and no entry gets more than the element has.
    holds elements_are_added_to_wrong_columns_without_a_panic_for_numbers_of_any_value() within 4 {
        let of = [[perhaps(), perhaps()]];
        let rows: [usize; 2] = [any(), any()];
        let mut values = [0_u8; 2];
        let columns = Lists { starts: &[0, 1, 2], members: &rows };
        add(&of, columns, &mut values, &[any()], |_, _| [[1; 2]; 2]);
        assert!(values[0] <= 4 && values[1] <= 4);
    }
    /// The false twin: nothing is added.
    fails control_nothing_is_added_to_wrong_columns([1.0, 0.0, 0.0, 0.0, 9.0, 0.0]) within 4 {
        let of = [[perhaps(), perhaps()]];
        let rows: [usize; 2] = [any(), any()];
        let mut values = [0_u8; 2];
        let columns = Lists { starts: &[0, 1, 2], members: &rows };
        add(&of, columns, &mut values, &[any()], |_, _| [[1; 2]; 2]);
        assert!(values[0] == 0);
    }
    /// Wrong numbers: what there is no place for is neither gathered nor scattered.
    holds wrong_numbers_are_gathered_and_scattered_without_a_panic_for_numbers_of_any_value() within 4 {
        let of = [[perhaps(), perhaps()]];
        let (mut vector, mut field) = ([0_u8], [[0_u8; 2]]);
        gather(&of, &[[1, 2]], &mut vector);
        let expected = if of[0][1] == Some(0) { 2 } else { u8::from(of[0][0] == Some(0)) };
        assert!(vector[0] == expected);
        scatter(&of, &[3], &mut field);
        assert!(field[0][0] == if of[0][0] == Some(0) { 3 } else { 0 });
    }
    /// The false twin: nothing is gathered.
    fails control_wrong_numbers_are_not_gathered([1.0, 0.0, 0.0]) within 4 {
        let of = [[perhaps(), perhaps()]];
        let mut vector = [0_u8];
        gather(&of, &[[1, 2]], &mut vector);
        assert!(vector[0] == 0);
    }
}

#[cfg(not(kani))]
pub use row::claim;

#[cfg(not(kani))]
mod row;
