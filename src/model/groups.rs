//! The groups into which pairs join items: union-find.

/// The number of each item's group when the items of each pair are in one; groups are numbered in the order of their first items.
pub(crate) fn groups(count: usize, pairs: impl IntoIterator<Item = [usize; 2]>) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..count).collect();
    for pair in pairs {
        let [a, b] = pair.map(|item| root(&mut parent, item));
        parent[a.max(b)] = a.min(b);
    }
    // A root is the first item of its group, so it is numbered before the others ask for its number.
    let mut group = vec![0; count];
    let mut found = 0;
    for item in 0..count {
        let root = root(&mut parent, item);
        if root == item {
            group[item] = found;
            found += 1;
        } else {
            group[item] = group[root];
        }
    }
    group
}

fn root(parent: &mut [usize], mut item: usize) -> usize {
    while parent[item] != item {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    item
}
