//! The unknowns and the pattern of the matrix: which nodes share a triangle, which number each free component of the
//! displacement has, and where the entries of the lower triangle stand, column by column. Not in the paper.
//!
//! ```text
//! triangles --> triangles of each node --> neighbours of each node --+
//!                                                                    +--> rows of each column --> entries
//! order of the nodes, prescribed components --> numbers, and back ---+
//! ```
//!
//! Lists are made from the back: first the members of each list are counted, `ends` turns the counts into the ends of
//! the lists, and each member is put in front of those that are there. Members that come in decreasing order stand in
//! increasing order then; nothing is sorted.
//!
//! All functions write into slices of the caller and are total: a number that names no node, no triangle or no column
//! counts for nothing, and a member for which a slice has no room is left out.
//!
//! Loops count, and what there are two of is written as a loop of two: a model checker unrolls the iterators of `Option`,
//! `zip`, `flatten` and `rev` far beyond their ends.

use std::ops::{Add, Range};

/// Lists of numbers: list i is `members[starts[i]..starts[i + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct Lists<'a> {
    /// Where each list starts, and where the last one ends.
    pub starts: &'a [usize],
    /// All of them, one list after the other.
    pub members: &'a [usize],
}

impl<'a> Lists<'a> {
    /// Where list `i` stands; nowhere if there is none.
    pub fn range(self, i: usize) -> Range<usize> {
        match self.starts.get(i..) {
            Some(&[start, end, ..]) => start..end,
            _ => 0..0,
        }
    }

    /// List `i`.
    pub fn of(self, i: usize) -> &'a [usize] {
        self.members.get(self.range(i)).unwrap_or_default()
    }
}

/// One more member for list `i`.
fn count(counts: &mut [usize], i: usize) {
    // What comes after the last list is no list.
    if let Some([count, _, ..]) = counts.get_mut(i..) {
        *count += 1;
    }
}

/// From how many members each list has to where it ends.
fn ends(counts: &mut [usize]) {
    let mut end = 0;
    for count in counts {
        end += *count;
        *count = end;
    }
}

/// Puts a member in front of those of list `i`.
fn put(starts: &mut [usize], members: &mut [usize], i: usize, member: usize) {
    if let Some([start, _, ..]) = starts.get_mut(i..)
        && let Some(place) = start.checked_sub(1)
        && let Some(slot) = members.get_mut(place)
    {
        *slot = member;
        *start = place;
    }
}

/// The triangles of each node, in increasing order. `starts` is one longer than there are nodes, and `triangles` as long
/// as there are nodes on all triangles.
pub fn triangles_of_nodes<const N: usize>(
    elements: &[[usize; N]],
    starts: &mut [usize],
    triangles: &mut [usize],
) {
    starts.fill(0);
    for element in elements {
        for i in 0..N {
            count(starts, element[i]);
        }
    }
    ends(starts);
    let mut t = elements.len();
    while t > 0 {
        t -= 1;
        for i in 0..N {
            put(starts, triangles, elements[t][i], t);
        }
    }
}

/// The neighbours of each node: itself, and those that share a triangle with it, each once. `seen_by` is as long as there
/// are nodes, `starts` one longer; N (N - 1) `neighbours` for each triangle and one for each node are always room enough.
pub fn neighbours<const N: usize>(
    elements: &[[usize; N]],
    triangles: Lists,
    seen_by: &mut [usize],
    starts: &mut [usize],
    neighbours: &mut [usize],
) {
    seen_by.fill(usize::MAX);
    let mut end = 0;
    for (node, start) in starts.iter_mut().enumerate() {
        *start = end;
        let mut meet = |other: usize| {
            if let (Some(by), Some(slot)) = (seen_by.get_mut(other), neighbours.get_mut(end))
                && *by != node
            {
                *by = node;
                *slot = other;
                end += 1;
            }
        };
        meet(node);
        for &t in triangles.of(node) {
            if let Some(element) = elements.get(t) {
                for i in 0..N {
                    meet(element[i]);
                }
            }
        }
    }
}

/// The numbers of the free components, and back.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<'a> {
    /// The number of each node's components; `None` for a prescribed one.
    pub of: &'a [[Option<usize>; 2]],
    /// The node to which each number belongs.
    pub nodes: &'a [usize],
}

/// Numbers the components that are not `prescribed`, the nodes taken in `order`, and says how many they are. A node that
/// comes a second time has its numbers already; one that doesn't come gets none. There are at most two for each of the
/// `nodes`.
pub fn number<T>(
    order: &[usize],
    prescribed: &[[Option<T>; 2]],
    of: &mut [[Option<usize>; 2]],
    nodes: &mut [usize],
) -> usize {
    of.fill([None; 2]);
    let mut count = 0;
    for &node in order {
        let (Some(numbers), Some(values)) = (of.get_mut(node), prescribed.get(node)) else {
            continue;
        };
        if numbers[0].is_some() || numbers[1].is_some() {
            continue;
        }
        for c in 0..2 {
            if let (None, Some(slot)) = (&values[c], nodes.get_mut(count)) {
                numbers[c] = Some(count);
                *slot = node;
                count += 1;
            }
        }
    }
    count
}

/// A vector over the numbers from a field.
pub fn gather<T: Copy>(of: &[[Option<usize>; 2]], field: &[[T; 2]], vector: &mut [T]) {
    for node in 0..of.len().min(field.len()) {
        for c in 0..2 {
            if let Some(number) = of[node][c]
                && let Some(slot) = vector.get_mut(number)
            {
                *slot = field[node][c];
            }
        }
    }
}

/// Writes a vector over the numbers into a field, and leaves the prescribed components as they are.
pub fn scatter<T: Copy>(of: &[[Option<usize>; 2]], vector: &[T], field: &mut [[T; 2]]) {
    for node in 0..of.len().min(field.len()) {
        for c in 0..2 {
            if let Some(number) = of[node][c]
                && let Some(value) = vector.get(number)
            {
                field[node][c] = *value;
            }
        }
    }
}

/// Calls `f` with each row and the columns of each neighbour of its node, as far as they are in the lower triangle: the
/// last row first.
fn entries(numbers: Numbers, neighbours: Lists, mut f: impl FnMut(usize, usize)) {
    let mut row = numbers.nodes.len();
    while row > 0 {
        row -= 1;
        for &other in neighbours.of(numbers.nodes[row]) {
            if let Some(columns) = numbers.of.get(other) {
                for c in 0..2 {
                    if let Some(column) = columns[c]
                        && column <= row
                    {
                        f(row, column);
                    }
                }
            }
        }
    }
}

/// Where each column of the lower triangle ends, and last how many entries there are. `counts` is one longer than there
/// are numbers.
pub fn column_ends(numbers: Numbers, neighbours: Lists, counts: &mut [usize]) {
    counts.fill(0);
    entries(numbers, neighbours, |_, column| count(counts, column));
    ends(counts);
}

/// The rows of each column in increasing order, the diagonal first. `starts` are the ends of the columns before, and their
/// starts after.
pub fn column_rows(numbers: Numbers, neighbours: Lists, starts: &mut [usize], rows: &mut [usize]) {
    entries(numbers, neighbours, |row, column| put(starts, rows, column, row));
}

/// Where in a list a number stands.
fn place(list: &[usize], number: usize) -> Option<usize> {
    let mut i = 0;
    while i < list.len() && list[i] != number {
        i += 1;
    }
    (i < list.len()).then_some(i)
}

/// Adds to the `values` of the lower triangle with these `columns` the 2 x 2 blocks of an element matrix: `block(i, j)`
/// belongs to the rows of `nodes[i]` and the columns of `nodes[j]`. What is above the diagonal is left out.
pub fn add<T: Copy + Add<Output = T>, const N: usize>(
    of: &[[Option<usize>; 2]],
    columns: Lists,
    values: &mut [T],
    nodes: &[usize; N],
    block: impl Fn(usize, usize) -> [[T; 2]; 2],
) {
    let mut numbers = [[None; 2]; N];
    for i in 0..N {
        if let Some(own) = of.get(nodes[i]) {
            numbers[i] = *own;
        }
    }
    for j in 0..N {
        // The numbers of a node follow each other.
        let Some(first_column) = numbers[j][0].or(numbers[j][1]) else { continue };
        let rows = columns.of(first_column);
        for i in 0..N {
            // A pair stands in the columns of the node that comes first.
            let Some(first_row) = numbers[i][0].or(numbers[i][1]) else { continue };
            if first_row < first_column {
                continue;
            }
            let Some(place) = place(rows, first_row) else { continue };
            let block = block(i, j);
            for d in 0..2 {
                let Some(column) = numbers[j][d] else { continue };
                // The second column has one row less at the top. What would be above the diagonal is at place -1, which
                // there is not.
                let top = place.wrapping_sub(column.wrapping_sub(first_column));
                let Some(values) = values.get_mut(columns.range(column)) else { continue };
                for c in 0..2 {
                    let Some(row) = numbers[i][c] else { continue };
                    let place = top.wrapping_add(row.wrapping_sub(first_row));
                    if let Some(value) = values.get_mut(place) {
                        *value = *value + block[c][d];
                    }
                }
            }
        }
    }
}
