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

/// So many more members for list `i`.
fn count(counts: &mut [usize], i: usize, more: usize) {
    // What comes after the last list is no list.
    if let Some([count, _, ..]) = counts.get_mut(i..) {
        *count += more;
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
    for &node in elements.as_flattened() {
        count(starts, node, 1);
    }
    ends(starts);
    for (t, element) in elements.iter().enumerate().rev() {
        for &node in element {
            put(starts, triangles, node, t);
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
            for &other in elements.get(t).into_iter().flatten() {
                meet(other);
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
        if *numbers != [None; 2] {
            continue;
        }
        for (number, value) in numbers.iter_mut().zip(values) {
            if let (None, Some(slot)) = (value, nodes.get_mut(count)) {
                *number = Some(count);
                *slot = node;
                count += 1;
            }
        }
    }
    count
}

/// A vector over the numbers from a field.
pub fn gather<T: Copy>(of: &[[Option<usize>; 2]], field: &[[T; 2]], vector: &mut [T]) {
    for (number, value) in of.as_flattened().iter().zip(field.as_flattened()) {
        if let Some(slot) = number.and_then(|number| vector.get_mut(number)) {
            *slot = *value;
        }
    }
}

/// Writes a vector over the numbers into a field, and leaves the prescribed components as they are.
pub fn scatter<T: Copy>(of: &[[Option<usize>; 2]], vector: &[T], field: &mut [[T; 2]]) {
    for (number, slot) in of.as_flattened().iter().zip(field.as_flattened_mut()) {
        if let Some(value) = number.and_then(|number| vector.get(number)) {
            *slot = *value;
        }
    }
}

/// Calls `f` with the rows of each node in the columns of each of its neighbours, as far as they are in the lower triangle:
/// the last rows first.
fn entries(numbers: Numbers, neighbours: Lists, mut f: impl FnMut(Range<usize>, usize)) {
    let mut end = numbers.nodes.len();
    while let Some(last) = end.checked_sub(1)
        && let Some(&node) = numbers.nodes.get(last)
    {
        // The numbers of a node follow each other.
        let before = last.checked_sub(1).filter(|&i| numbers.nodes.get(i) == Some(&node));
        let first = before.unwrap_or(last);
        for &other in neighbours.of(node) {
            let Some(columns) = numbers.of.get(other) else { continue };
            for &column in columns.iter().flatten() {
                // No rows at all where the column is beyond them.
                f(first.max(column)..end, column);
            }
        }
        end = first;
    }
}

/// Where each column of the lower triangle ends, and last how many entries there are. `counts` is one longer than there
/// are numbers.
pub fn column_ends(numbers: Numbers, neighbours: Lists, counts: &mut [usize]) {
    counts.fill(0);
    entries(numbers, neighbours, |rows, column| count(counts, column, rows.len()));
    ends(counts);
}

/// The rows of each column in increasing order, the diagonal first. `starts` are the ends of the columns before, and their
/// starts after.
pub fn column_rows(numbers: Numbers, neighbours: Lists, starts: &mut [usize], rows: &mut [usize]) {
    entries(numbers, neighbours, |more, column| {
        for row in more.rev() {
            put(starts, rows, column, row);
        }
    });
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
    let numbers = nodes.map(|node| of.get(node).copied().unwrap_or_default());
    let first = numbers.map(|[x, y]| x.or(y));
    for j in 0..N {
        let Some(first_column) = first[j] else { continue };
        let rows = columns.of(first_column);
        for i in 0..N {
            // A pair stands in the columns of the node that comes first.
            let Some(first_row) = first[i] else { continue };
            if first_row < first_column {
                continue;
            }
            let Some(place) = rows.iter().position(|&row| row == first_row) else { continue };
            let block = block(i, j);
            for (d, column) in numbers[j].iter().enumerate() {
                let Some(column) = *column else { continue };
                // The numbers of a node follow each other: its second column has one row less at the top. What would be
                // above the diagonal is at place -1, which there is not.
                let top = place.wrapping_sub(column.wrapping_sub(first_column));
                let Some(values) = values.get_mut(columns.range(column)) else { continue };
                for (c, row) in numbers[i].iter().enumerate() {
                    let Some(row) = *row else { continue };
                    let place = top.wrapping_add(row.wrapping_sub(first_row));
                    if let Some(value) = values.get_mut(place) {
                        *value = *value + block[c][d];
                    }
                }
            }
        }
    }
}
