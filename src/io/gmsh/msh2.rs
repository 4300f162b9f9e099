//! The format MSH 2.2: there are no entities, each element names its physical group itself.
//!
//! `$Nodes` has a count, then tag, x, y, z of each node. `$Elements` has a count, then of each element, in a text file: tag,
//! type, the number of its labels, the labels (the first is the physical group, 0 for none, the second the entity), the nodes.
//! In a binary file elements of one type follow each other: type, how many, the number of labels, and of each tag, labels,
//! nodes; all numbers but coordinates are integers of 4 bytes. An element of two groups appears once for each.

use std::collections::BTreeMap;

use super::{ByDimension, Cursor, Elements, Form, GmshMistake, Node, Result};

const NODE: &str = "the tag of a node";
const COORDINATE: &str = "a coordinate of a node";

/// Each physical group as an entity of its own, which is what `Elements` have here in place of one; 0 is in no group.
pub(super) fn groups(elements: &Elements) -> ByDimension<BTreeMap<i32, Vec<i32>>> {
    let of = |group: i32| (group, if group == 0 { Vec::new() } else { vec![group] });
    [
        elements.points.iter().map(|piece| of(piece.entity)).collect(),
        elements.lines.iter().map(|piece| of(piece.entity)).collect(),
        elements.triangles.iter().map(|piece| of(piece.entity)).collect(),
    ]
}

/// A count on a line of its own: text in a binary file too.
fn count(cursor: &mut Cursor, expected: &str) -> Result<usize> {
    let form = std::mem::replace(&mut cursor.form, Form::Text);
    let count = cursor.size(expected);
    cursor.form = form;
    if form != Form::Text {
        cursor.line();
    }
    count
}

/// A tag, which must not be negative.
fn tag(cursor: &mut Cursor, expected: &str) -> Result<usize> {
    let start = cursor.here();
    let number = cursor.int(expected)?;
    usize::try_from(number).map_err(|_| cursor.unexpected(start, number.to_string(), expected))
}

pub(super) fn read_nodes(cursor: &mut Cursor) -> Result<Vec<Node>> {
    let mut nodes = Vec::new();
    for _ in 0..count(cursor, "the number of nodes")? {
        let node = tag(cursor, NODE)?;
        let place = [cursor.double(COORDINATE)?, cursor.double(COORDINATE)?];
        let start = cursor.here();
        let z = cursor.double(COORDINATE)?;
        if z != 0.0 {
            return Err(cursor.wrong_at(start, GmshMistake::OutOfPlane { node, z }));
        }
        nodes.push(Node { tag: node, place });
    }
    Ok(nodes)
}

pub(super) fn read_elements(cursor: &mut Cursor) -> Result<Elements> {
    let mut elements = Elements::default();
    let mut left = count(cursor, "the number of elements")?;
    while left > 0 {
        let (number, together, labels) = if cursor.form == Form::Text {
            (None, 1, None)
        } else {
            let number = cursor.int("the type of the elements")?;
            let start = cursor.here();
            let together = tag(cursor, "how many elements of this type follow")?;
            if !(1..=left).contains(&together) {
                let expected = format!("a number of elements from 1 to {left}");
                return Err(cursor.unexpected(start, together.to_string(), &expected));
            }
            (Some(number), together, Some(tag(cursor, "the number of labels")?))
        };
        for _ in 0..together {
            let start = cursor.here();
            let element = tag(cursor, "the tag of an element")?;
            let number = match number {
                Some(number) => number,
                None => cursor.int("the type of the element")?,
            };
            let labels = match labels {
                Some(labels) => labels,
                None => tag(cursor, "the number of labels")?,
            };
            let mut group = 0;
            for label in 0..labels {
                let value = cursor.int("a label of an element")?;
                if label == 0 {
                    // A negative number says that the group runs against the direction of the curve.
                    group = value.saturating_abs();
                }
            }
            elements.read(cursor, start, element, number, group, |cursor| tag(cursor, NODE))?;
        }
        left -= together;
    }
    Ok(elements)
}
