//! The definitions of the paper on a small mesh, transcribed without shape functions, quadrature or the kernel: the
//! other side of every comparison of an assembled quantity.
//!
//! A field of degree p on a triangle is known by its nodal values. The gradient of a polynomial of degree <= 2 is
//! affine, so its values at the vertices determine it, and they follow from the derivatives along the edges: b - a for an
//! affine function, -3a + 4m - b at the start of a quadratic one. Products of affine functions are integrated over T
//! by |T|/12 (sum f_i g_i + sum f_i sum g_i), products of quadratic ones by their monomials in the barycentric
//! coordinates, and everything along an edge is a polynomial in s.

use signorini::kernel::Scalar;

use crate::Ordered;

/// The material of the body, by what acts in the plane.
#[derive(Clone, Copy, Debug)]
pub enum Hooke<S> {
    /// lambda and mu.
    Isotropic {
        /// lambda
        lambda: S,
        /// mu
        mu: S,
    },
    /// C11, C12, C16, C22, C26, C66.
    Tensor([S; 6]),
}

/// A symmetric tensor: xx, yy, xy.
pub type Tensor<S> = [S; 3];

impl<S: Scalar> Hooke<S> {
    /// sigma = A eps of (1): lambda tr(eps) I + 2 mu eps where A is isotropic.
    pub fn stress(&self, [xx, yy, xy]: Tensor<S>) -> Tensor<S> {
        let two = S::from(2);
        match *self {
            Hooke::Isotropic { lambda, mu } => {
                let trace = lambda * (xx + yy);
                [trace + two * mu * xx, trace + two * mu * yy, two * mu * xy]
            }
            Hooke::Tensor([c11, c12, c16, c22, c26, c66]) => {
                let row = |a: S, b: S, c: S| a * xx + b * yy + c * (two * xy);
                [row(c11, c12, c16), row(c12, c22, c26), row(c16, c26, c66)]
            }
        }
    }

    /// eps that belongs to sigma: of a tensor by the cofactors of its matrix.
    pub fn strain(&self, [xx, yy, xy]: Tensor<S>) -> Tensor<S> {
        let two = S::from(2);
        match *self {
            Hooke::Isotropic { lambda, mu } => {
                let mean = lambda * (xx + yy) / (two * (lambda + mu));
                let by = |c: S| c / (two * mu);
                [by(xx - mean), by(yy - mean), by(xy)]
            }
            Hooke::Tensor([c11, c12, c16, c22, c26, c66]) => {
                let rows = [
                    [c22 * c66 - c26 * c26, c16 * c26 - c12 * c66, c12 * c26 - c16 * c22],
                    [c16 * c26 - c12 * c66, c11 * c66 - c16 * c16, c12 * c16 - c11 * c26],
                    [c12 * c26 - c16 * c22, c12 * c16 - c11 * c26, c11 * c22 - c12 * c12],
                ];
                let determinant = c11 * rows[0][0] + c12 * rows[0][1] + c16 * rows[0][2];
                let of = |[a, b, c]: [S; 3]| (a * xx + b * yy + c * xy) / determinant;
                [of(rows[0]), of(rows[1]), of(rows[2]) / two]
            }
        }
    }

    /// A_nnnn: sigma_n of the strain n (x) n.
    pub fn along(&self, n: [S; 2]) -> S {
        match *self {
            Hooke::Isotropic { lambda, mu } => lambda + S::from(2) * mu,
            Hooke::Tensor(_) => normal(self.stress([n[0] * n[0], n[1] * n[1], n[0] * n[1]]), n),
        }
    }
}

/// a : b
pub fn contract<S: Scalar>(a: Tensor<S>, b: Tensor<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + S::from(2) * a[2] * b[2]
}

/// n . s n
pub fn normal<S: Scalar>(s: Tensor<S>, n: [S; 2]) -> S {
    s[0] * n[0] * n[0] + s[1] * n[1] * n[1] + S::from(2) * s[2] * n[0] * n[1]
}

/// A field on one triangle: vertices, and the nodal values of degree 1 (three) or 2 (six: the middle of edge i is node
/// 3 + i, opposite vertex i).
#[derive(Clone, Debug)]
pub struct Field<S> {
    /// The corners, counter-clockwise.
    pub vertices: [[S; 2]; 3],
    /// u at the nodes.
    pub nodal: Vec<[S; 2]>,
}

impl<S: Scalar> Field<S> {
    /// |T| by the shoelace formula.
    pub fn area(&self) -> S {
        let [[ax, ay], [bx, by], [cx, cy]] = self.vertices;
        (ax * (by - cy) + bx * (cy - ay) + cx * (ay - by)) / S::from(2)
    }

    /// The derivative of component c at vertex k along the edge to vertex m.
    fn along(&self, k: usize, m: usize, c: usize) -> S {
        let (start, end) = (self.nodal[k][c], self.nodal[m][c]);
        match self.nodal.get(3 + (3 - k - m)) {
            None => end - start,
            Some(middle) => S::from(4) * middle[c] - S::from(3) * start - end,
        }
    }

    /// du_i/dx_j at vertex k.
    pub fn gradient(&self, k: usize) -> [[S; 2]; 2] {
        let (m, l) = ((k + 1) % 3, (k + 2) % 3);
        let to = |i: usize| [0, 1].map(|c| self.vertices[i][c] - self.vertices[k][c]);
        let ([a, b], [c, d]) = (to(m), to(l));
        let determinant = a * d - b * c;
        [0, 1].map(|i| {
            let (p, q) = (self.along(k, m, i), self.along(k, l, i));
            [(p * d - q * b) / determinant, (a * q - c * p) / determinant]
        })
    }

    /// eps(u) at vertex k.
    pub fn strain(&self, k: usize) -> Tensor<S> {
        let [[xx, xy], [yx, yy]] = self.gradient(k);
        [xx, yy, (xy + yx) / S::from(2)]
    }

    /// eps(u) at the vertices: that of an affine field is constant.
    fn strains(&self) -> [Tensor<S>; 3] {
        match self.nodal.len() {
            3 => [self.strain(0); 3],
            _ => [0, 1, 2].map(|k| self.strain(k)),
        }
    }

    /// int_T sigma(u) : eps(v)
    pub fn energy(&self, v: &Field<S>, hooke: &Hooke<S>) -> S {
        let stress = self.strains().map(|strain| hooke.stress(strain));
        integral_of_affine(self.area(), stress, v.strains())
    }

    /// The vertices, then the middles of the edges.
    pub fn places(&self) -> [[S; 2]; 6] {
        let [a, b, c] = self.vertices;
        let middle = |p: [S; 2], q: [S; 2]| [0, 1].map(|i| (p[i] + q[i]) / S::from(2));
        [a, b, c, middle(b, c), middle(c, a), middle(a, b)]
    }

    /// Component c at those places.
    fn component(&self, c: usize) -> [S; 6] {
        let at = |j: usize| self.nodal[j % 3][c];
        [0, 1, 2, 3, 4, 5].map(|k| match self.nodal.get(k) {
            Some(value) => value[c],
            None => (at(k + 1) + at(k + 2)) / S::from(2),
        })
    }

    /// int_T f v_c for a polynomial f of degree <= 2.
    pub fn load(&self, c: usize, f: impl Fn([S; 2]) -> S) -> S {
        integral_of_quadratics(self.area(), self.places().map(f), self.component(c))
    }

    /// u . n along edge i, from vertex i + 1 to vertex i + 2.
    pub fn normal_trace(&self, i: usize, n: [S; 2]) -> Line<S> {
        let at = |j: usize| self.nodal[j][0] * n[0] + self.nodal[j][1] * n[1];
        let (start, end) = (at((i + 1) % 3), at((i + 2) % 3));
        match self.nodal.len() {
            3 => Line::affine(start, end),
            _ => Line::quadratic(start, at(3 + i), end),
        }
    }

    /// sigma_n(u) along edge i.
    pub fn normal_stress(&self, i: usize, n: [S; 2], hooke: &Hooke<S>) -> Line<S> {
        let at = |k: usize| normal(hooke.stress(self.strain(k)), n);
        Line::affine(at((i + 1) % 3), at((i + 2) % 3))
    }
}

/// int_T a : b of two affine tensors by their values at the vertices.
pub fn integral_of_affine<S: Scalar>(area: S, a: [Tensor<S>; 3], b: [Tensor<S>; 3]) -> S {
    let sum = |t: [Tensor<S>; 3]| [0, 1, 2].map(|c| t[0][c] + t[1][c] + t[2][c]);
    let each = (0..3).fold(S::from(0), |s, k| s + contract(a[k], b[k]));
    area * (each + contract(sum(a), sum(b))) / S::from(12)
}

/// The monomials of degree 2 in the barycentric coordinates, by their exponents: the squares, then l_1 l_2, l_2 l_0, l_0 l_1.
const MONOMIALS: [[usize; 3]; 6] =
    [[2, 0, 0], [0, 2, 0], [0, 0, 2], [0, 1, 1], [1, 0, 1], [1, 1, 0]];

/// int_T f g of two polynomials of degree <= 2 by their values at the vertices and the middles of the edges. Such a
/// polynomial is f_0 l_0^2 + .. + (4 f_3 - f_1 - f_2) l_1 l_2 + .., and int_T l^alpha = 2 |T| alpha! / (|alpha| + 2)!.
pub fn integral_of_quadratics<S: Scalar>(area: S, f: [S; 6], g: [S; 6]) -> S {
    let coefficients = |f: [S; 6]| {
        [0, 1, 2, 3, 4, 5].map(|k| {
            let ends = || f[(k + 1) % 3] + f[(k + 2) % 3];
            if k < 3 { f[k] } else { S::from(4) * f[k] - ends() }
        })
    };
    let (f, g) = (coefficients(f), coefficients(g));
    let mut sum = S::from(0);
    for (f, a) in f.into_iter().zip(MONOMIALS) {
        for (g, b) in g.into_iter().zip(MONOMIALS) {
            let factorial = |k: usize| (1..=i32::from(k as u8)).product::<i32>();
            let weight: i32 = (0..3).map(|i| factorial(a[i] + b[i])).product();
            sum += S::from(weight) * f * g;
        }
    }
    area * sum / S::from(360)
}

/// A polynomial in s on \[0, 1\], by its coefficients.
#[derive(Clone, Debug)]
pub struct Line<S>(pub Vec<S>);

impl<S: Scalar> Line<S> {
    /// From the values at 0 and 1.
    pub fn affine(start: S, end: S) -> Line<S> {
        Line(vec![start, end - start])
    }

    /// From the values at 0, 1/2 and 1.
    pub fn quadratic(start: S, middle: S, end: S) -> Line<S> {
        let (two, three, four) = (S::from(2), S::from(3), S::from(4));
        let slope = four * middle - three * start - end;
        Line(vec![start, slope, two * start - four * middle + two * end])
    }

    /// The value at s.
    pub fn at(&self, s: S) -> S {
        self.0.iter().rev().fold(S::from(0), |sum, &c| sum * s + c)
    }

    /// factor * self
    pub fn times(&self, factor: S) -> Line<S> {
        Line(self.0.iter().map(|&c| factor * c).collect())
    }

    /// self + other
    pub fn plus(&self, other: &Line<S>) -> Line<S> {
        let at = |line: &Line<S>, i: usize| line.0.get(i).copied().unwrap_or(S::from(0));
        let length = self.0.len().max(other.0.len());
        Line((0..length).map(|i| at(self, i) + at(other, i)).collect())
    }

    /// self - other
    pub fn minus(&self, other: &Line<S>) -> Line<S> {
        self.plus(&other.times(S::from(-1)))
    }

    /// self * other
    pub fn by(&self, other: &Line<S>) -> Line<S> {
        let mut product = vec![S::from(0); self.0.len() + other.0.len() - 1];
        for (i, &a) in self.0.iter().enumerate() {
            for (j, &b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Line(product)
    }

    /// The integral from start to end.
    pub fn integral(&self, [start, end]: [S; 2]) -> S {
        let (mut sum, mut from, mut to) = (S::from(0), start, end);
        for (power, &c) in (1_i32..).zip(&self.0) {
            sum += c * (to - from) / S::from(power);
            (from, to) = (from * start, to * end);
        }
        sum
    }
}

/// A root that is no rational number is known to 2^-HALVINGS. Between it and the root a polynomial is as small as that, so
/// an integral of its positive part is off by its square at most, 2^-120 times the slope.
const HALVINGS: u32 = 60;

impl<S: Ordered> Line<S> {
    /// Where this polynomial of degree <= 2 has a root between start and end, given that its signs there are opposite and
    /// that it is monotone in between.
    fn root(&self, [mut start, mut end]: [S; 2]) -> S {
        let zero = S::from(0);
        if self.0.get(2).is_none_or(|&c| c == zero) {
            return self.0[0] / -self.0[1];
        }
        let rising = self.at(end) > zero;
        for _ in 0..HALVINGS {
            let middle = (start + end) / S::from(2);
            if (self.at(middle) > zero) == rising {
                end = middle;
            } else {
                start = middle;
            }
        }
        (start + end) / S::from(2)
    }

    /// Where the derivative of this polynomial of degree <= 2 is zero, if that is inside (0, 1).
    pub fn turn(&self) -> Option<S> {
        let (zero, one) = (S::from(0), S::from(1));
        let c = self.0.get(2).copied().filter(|&c| c != zero)?;
        let turn = -self.0[1] / (S::from(2) * c);
        (turn > zero && turn < one).then_some(turn)
    }

    /// \[0, 1\] cut where this polynomial of degree <= 2 changes its sign inside; each piece with whether it is positive
    /// there.
    pub fn pieces(&self) -> Vec<([S; 2], bool)> {
        let (zero, one) = (S::from(0), S::from(1));
        let monotone: Vec<S> = [zero].into_iter().chain(self.turn()).chain([one]).collect();
        let mut cuts = vec![zero];
        for ends in monotone.windows(2) {
            let (start, end) = (self.at(ends[0]), self.at(ends[1]));
            if (start > zero && end < zero) || (start < zero && end > zero) {
                cuts.push(self.root([ends[0], ends[1]]));
            }
        }
        cuts.push(one);
        let middle = |a: S, b: S| (a + b) / S::from(2);
        let piece = |ends: &[S]| {
            // A double root may be in the middle, but then not at the quarter.
            let half = middle(ends[0], ends[1]);
            let quarter = middle(ends[0], half);
            ([ends[0], ends[1]], self.at(half) > zero || self.at(quarter) > zero)
        };
        cuts.windows(2).map(piece).collect()
    }

    /// The integral of another polynomial over where this one is positive.
    pub fn where_positive(&self, other: &Line<S>) -> S {
        let pieces = self.pieces().into_iter().filter(|(_, positive)| *positive);
        pieces.fold(S::from(0), |sum, (piece, _)| sum + other.integral(piece))
    }

    /// int_0^1 \[self\]+ other
    pub fn positive_part_times(&self, other: &Line<S>) -> S {
        self.where_positive(&self.by(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::Exact;

    fn q(n: i64, d: i64) -> Exact {
        Exact::ratio(n, d)
    }

    #[test]
    fn the_strain_of_a_quadratic_field_is_known() {
        // u = (x^2, x y): eps = [[2x, y/2], [y/2, x]]
        let vertices = [[q(1, 1), q(1, 1)], [q(4, 1), q(2, 1)], [q(2, 1), q(5, 1)]];
        let places = Field { vertices, nodal: Vec::new() }.places();
        let field = Field { vertices, nodal: places.map(|[x, y]| [x * x, x * y]).to_vec() };
        assert_eq!(field.strain(1), [q(8, 1), q(4, 1), q(1, 1)]);
        assert_eq!(field.strain(2), [q(4, 1), q(2, 1), q(5, 2)]);
        assert_eq!(field.area(), q(11, 2));
    }

    #[test]
    fn strain_inverts_stress() {
        let tensor = [q(12, 1), q(3, 1), q(2, 1), q(5, 1), q(-1, 1), q(2, 1)];
        for hooke in [Hooke::Isotropic { lambda: q(3, 1), mu: q(7, 10) }, Hooke::Tensor(tensor)] {
            let strain = [q(1, 2), q(-2, 3), q(5, 1)];
            assert_eq!(hooke.strain(hooke.stress(strain)), strain);
        }
    }

    #[test]
    fn integrals_of_lines_are_known() {
        // (1 - 3s)(2 + 5s) on [0, 1]: 2 - 1/2 - 5
        let (a, b) = (Line::affine(q(1, 1), q(-2, 1)), Line::affine(q(2, 1), q(7, 1)));
        assert_eq!(a.by(&b).integral([q(0, 1), q(1, 1)]), q(-7, 2));
        assert_eq!(Line::quadratic(q(1, 1), q(2, 1), q(5, 1)).at(q(1, 2)), q(2, 1));
        // [1 - 3s]+ on [0, 1]: 1/6
        assert_eq!(a.positive_part_times(&Line(vec![q(1, 1)])), q(1, 6));
    }

    #[test]
    fn a_parabola_is_cut_at_its_roots() {
        // 2 - (3s - 1)^2 is positive up to s = (1 + sqrt 2)/3, where it changes its sign.
        let line = Line(vec![q(1, 1), q(6, 1), q(-9, 1)]);
        let pieces = line.pieces();
        let ([start, end], positive) = pieces[0];
        assert!(pieces.len() == 2 && positive && !pieces[1].1);
        let off = (q(3, 1) * end - q(1, 1)) * (q(3, 1) * end - q(1, 1)) - q(2, 1);
        assert!(start == q(0, 1) && off.abs() < q(1, 1 << 58));
        // A double root changes no sign: (2s - 1)^2.
        let line = Line(vec![q(1, 1), q(-4, 1), q(4, 1)]);
        assert!(line.pieces().len() == 1 && line.pieces()[0].1);
        assert!(!line.times(q(-1, 1)).pieces()[0].1);
        // Two roots, 1/4 and 3/4; no quadratic term; not the whole line.
        let line = Line(vec![q(3, 16), q(-1, 1), q(1, 1)]);
        let signs: Vec<bool> = line.pieces().iter().map(|piece| piece.1).collect();
        assert_eq!(signs, [true, false, true]);
        let line = Line(vec![q(1, 1), q(-3, 1), q(0, 1)]);
        assert_eq!(line.pieces()[0].0[1], q(1, 3));
    }

    #[test]
    fn loads_of_quadratic_fields_are_known() {
        // On the triangle (0,0), (1,0), (0,1): int x^2 y^2 = 4/720 and int x^2 (1 - x) = 1/12 - 1/20 = 1/30.
        let vertices = [[q(0, 1); 2], [q(1, 1), q(0, 1)], [q(0, 1), q(1, 1)]];
        let affine = Field { vertices, nodal: vertices.map(|[x, _]| [q(1, 1) - x; 2]).to_vec() };
        let nodal = affine.places().map(|[x, y]| [x * y, y * y]).to_vec();
        let quadratic = Field { vertices, nodal };
        assert_eq!(quadratic.load(1, |[x, _]| x * x), q(1, 180));
        assert_eq!(quadratic.load(0, |[x, y]| x * y), q(1, 180));
        assert_eq!(affine.load(0, |[x, _]| x * x), q(1, 30));
    }
}
