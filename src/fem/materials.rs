//! The materials of a body: one, or one for each part of it. A triangle has exactly one.

use crate::kernel::Material;

/// The material of each triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Materials {
    distinct: Vec<Material<f64>>,
    /// The material of each triangle by its place in `distinct`; empty where the whole body is made of the first.
    of_triangle: Vec<usize>,
}

impl From<Material<f64>> for Materials {
    /// One material for the whole body.
    fn from(material: Material<f64>) -> Self {
        Materials { distinct: vec![material], of_triangle: Vec::new() }
    }
}

impl Materials {
    /// The materials of a body of `triangles` triangles: `rest`, and on the triangles of each of `parts` that part's own.
    /// Numbers beyond the last triangle are passed over.
    pub fn in_parts<'a>(
        rest: Material<f64>,
        triangles: usize,
        parts: impl IntoIterator<Item = (Material<f64>, &'a [usize])>,
    ) -> Self {
        let mut materials = Materials { distinct: vec![rest], of_triangle: vec![0; triangles] };
        for (material, members) in parts {
            for &t in members {
                if let Some(of) = materials.of_triangle.get_mut(t) {
                    *of = materials.distinct.len();
                }
            }
            materials.distinct.push(material);
        }
        materials
    }

    /// That of triangle `t`.
    pub fn of(&self, t: usize) -> &Material<f64> {
        &self.distinct[self.of_triangle.get(t).copied().unwrap_or(0)]
    }

    /// The place of triangle `t`'s material among the materials: two triangles with the same place share theirs.
    pub fn place_of(&self, t: usize) -> usize {
        self.of_triangle.get(t).copied().unwrap_or(0)
    }

    /// Replaces every material by `f` of it.
    #[must_use]
    pub fn map(&self, f: impl FnMut(&Material<f64>) -> Material<f64>) -> Self {
        let distinct = self.distinct.iter().map(f).collect();
        Materials { distinct, of_triangle: self.of_triangle.clone() }
    }

    /// The materials on parts of these triangles: part i is one of triangle `origin[i]`.
    #[must_use]
    pub fn on_parts(&self, origin: &[usize]) -> Self {
        let one = self.of_triangle.is_empty();
        let of_triangle =
            if one { Vec::new() } else { origin.iter().map(|&t| self.place_of(t)).collect() };
        Materials { distinct: self.distinct.clone(), of_triangle }
    }

    /// Each material once, whether a triangle is made of it or not.
    pub fn distinct(&self) -> &[Material<f64>] {
        &self.distinct
    }

    /// The one material, if the whole body is made of it.
    pub fn only(&self) -> Option<&Material<f64>> {
        if self.of_triangle.is_empty() { self.distinct.first() } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Plane;

    #[test]
    fn each_triangle_has_the_material_of_its_part() {
        let [a, b, c] = [1.0, 2.0, 3.0].map(|mu| Material::lame(1.0, mu, Plane::Strain));
        let materials = Materials::in_parts(a, 5, [(b, &[0, 3][..]), (c, &[4])]);
        assert_eq!([0, 1, 2, 3, 4].map(|t| materials.of(t).mu()), [2.0, 1.0, 1.0, 2.0, 3.0]);
        assert_eq!(materials.only(), None);
        assert_eq!(Materials::from(a).only(), Some(&a));
        assert_eq!(Materials::from(a).of(17), &a);
    }
}
