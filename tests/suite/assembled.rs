//! Method (8) solved a second time, independently of src/solve and of the assembly: Newton's method on the assembled
//! system, everything but the data in double-double arithmetic (106 bits), straight from the definitions. Element
//! integrals by rules that are exact for them, [P]+ cut at its roots, the matrix by an envelope Cholesky in a
//! Cuthill-McKee order, steps by a search on the derivative of the convex J_h.
//!
//! Units are scaled by powers of two, exactly, so that nothing over- or underflows.

use std::ops::{Add, Div, Mul, Neg, Sub};

use signorini::fem::{Condition, Problem};
use signorini::solve::Degree;

/// A number as the sum of two doubles that don't overlap.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct D(pub f64, pub f64);

const ZERO: D = D(0.0, 0.0);

fn two_sum(a: f64, b: f64) -> D {
    let s = a + b;
    let t = s - a;
    D(s, (a - (s - t)) + (b - t))
}

/// Dekker's product: halves of 26 bits.
fn two_product(a: f64, b: f64) -> D {
    let half = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let p = a * b;
    let ((ah, al), (bh, bl)) = (half(a), half(b));
    D(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl From<f64> for D {
    fn from(a: f64) -> D {
        D(a, 0.0)
    }
}

impl Neg for D {
    type Output = D;
    fn neg(self) -> D {
        D(-self.0, -self.1)
    }
}

impl Add for D {
    type Output = D;
    fn add(self, b: D) -> D {
        let (s, t) = (two_sum(self.0, b.0), two_sum(self.1, b.1));
        let u = two_sum(s.0, s.1 + t.0);
        two_sum(u.0, u.1 + t.1)
    }
}

impl Sub for D {
    type Output = D;
    fn sub(self, b: D) -> D {
        self + -b
    }
}

impl Mul for D {
    type Output = D;
    fn mul(self, b: D) -> D {
        let p = two_product(self.0, b.0);
        two_sum(p.0, p.1 + (self.0 * b.1 + self.1 * b.0))
    }
}

impl Div for D {
    type Output = D;
    fn div(self, b: D) -> D {
        let first = self.0 / b.0;
        let rest = self - b * D::from(first);
        let second = rest.0 / b.0;
        let rest = rest - b * D::from(second);
        two_sum(first, second) + D::from(rest.0 / b.0)
    }
}

impl D {
    fn sqrt(self) -> D {
        if self.0 <= 0.0 {
            return ZERO;
        }
        let root = D::from(self.0.sqrt());
        root + (self - root * root) / (root + root)
    }

    fn times(self, factor: f64) -> D {
        self * D::from(factor)
    }
}

type V = [D; 2];

fn dot(a: V, b: V) -> D {
    a[0] * b[0] + a[1] * b[1]
}

/// Values of the shape functions and of their gradients at barycentric coordinates `l`.
fn shapes(degree: usize, l: [D; 3], g: [V; 3]) -> Vec<(D, V)> {
    let along = |factor: D, i: usize| g[i].map(|c| factor * c);
    if degree == 1 {
        return (0..3).map(|i| (l[i], g[i])).collect();
    }
    let corner = (0..3).map(|i| {
        let slope = l[i].times(4.0) - D::from(1.0);
        (l[i] * (l[i].times(2.0) - D::from(1.0)), along(slope, i))
    });
    let middle = (0..3).map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (a, b) = (along(l[k].times(4.0), j), along(l[j].times(4.0), k));
        (l[j].times(4.0) * l[k], [a[0] + b[0], a[1] + b[1]])
    });
    corner.chain(middle).collect()
}

struct Element {
    nodes: Vec<usize>,
    stiffness: Vec<D>,
}

/// The circle that the nodes of a contact line lie on. Contact is in the direction of its radii, away from the body.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// The center.
    pub center: [f64; 2],
    /// The radius.
    pub radius: f64,
    /// The body lies within.
    pub is_around: bool,
}

/// An edge of Gamma_C in its triangle: P(s) = sum over the nodes of p0(s) . u - g(s).
struct Edge {
    element: usize,
    lambda: D,
    mu: D,
    gamma: D,
    length: D,
    normal: V,
    /// n~ at the two ends and, for P2, in the middle.
    directions: Vec<V>,
    gradients: [V; 3],
    local: usize,
    gap: Vec<D>,
}

/// The discrete problem in units of its own size.
pub struct Assembled {
    degree: usize,
    elements: Vec<Element>,
    edges: Vec<Edge>,
    load: Vec<V>,
    prescribed: Vec<[Option<D>; 2]>,
    length: f64,
    modulus: f64,
}

/// The exact discrete solution: u / length at each node.
pub struct Answer(Vec<V>);

fn power_of_two(x: f64) -> f64 {
    2.0_f64.powi(x.log2().floor() as i32)
}

impl Assembled {
    /// Method (8) of this degree with this gamma0 for a body under a constant force, its contact line straight or on a circle.
    pub fn new(
        problem: &Problem,
        degree: Degree,
        gamma0: f64,
        force: [f64; 2],
        circle: Option<Circle>,
    ) -> Self {
        let (mesh, degree) = (&problem.mesh, degree.number());
        let all = || mesh.vertices().iter();
        let extent = |c: usize| {
            let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v[c]), high.max(v[c]))
            });
            high - low
        };
        let length = power_of_two(extent(0).max(extent(1)));
        let modulus = power_of_two(problem.material.of(0).mu());
        let scaled = |x: f64, unit: f64| D::from(x / unit);
        let lame = |t: usize| {
            let material = problem.material.of(t);
            [scaled(material.lambda(), modulus), scaled(material.mu(), modulus)]
        };
        let origin = mesh.vertices()[0];
        // Differences of doubles within a factor of two are exact; the others are exact as pairs.
        let place = |v: usize| {
            let x = mesh.vertices()[v];
            [0, 1].map(|c| two_sum(x[c] / length, -origin[c] / length))
        };
        let vertices = mesh.vertices().len();
        let count = vertices + if degree == 2 { mesh.edge_count() } else { 0 };
        let mut places: Vec<[f64; 2]> = mesh.vertices().to_vec();
        places.resize(count, [0.0; 2]);
        let (mut elements, mut load) = (Vec::new(), vec![[ZERO; 2]; count]);
        let force = force.map(|f| D::from(f * length / modulus));
        for (t, (corners, middles)) in
            mesh.triangles().iter().zip(mesh.triangle_edges()).enumerate()
        {
            let mut nodes = corners.to_vec();
            if degree == 2 {
                nodes.extend(middles.iter().map(|e| vertices + e));
                for i in 0..3 {
                    let [a, b] = [1, 2].map(|k| mesh.vertices()[corners[(i + k) % 3]]);
                    places[nodes[3 + i]] = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
                }
            }
            let (area2, gradients) = geometry(corners.map(place));
            let [lambda, mu] = lame(t);
            let stiffness = stiffness(degree, lambda, mu, area2, gradients);
            let share = area2 / D::from(6.0);
            for (i, &node) in nodes.iter().enumerate() {
                if degree == 1 || i >= 3 {
                    for c in 0..2 {
                        load[node][c] = load[node][c] + share * force[c];
                    }
                }
            }
            elements.push(Element { nodes, stiffness });
        }
        let mut prescribed = vec![[None; 2]; count];
        let mut edges = Vec::new();
        for (name, condition) in &problem.conditions {
            for &at in mesh.edges_of(name).unwrap() {
                let nodes = &elements[at.triangle].nodes;
                let ends = [1, 2].map(|k| (at.local + k) % 3);
                let mut on_edge = ends.map(|k| nodes[k]).to_vec();
                if degree == 2 {
                    on_edge.push(nodes[3 + at.local]);
                }
                match condition {
                    Condition::Displacement(functions) => {
                        for &node in &on_edge {
                            for (c, f) in functions.iter().enumerate() {
                                if let Some(f) = f {
                                    prescribed[node][c] = Some(scaled(f.at(places[node]), length));
                                }
                            }
                        }
                    }
                    Condition::Contact { gap } => {
                        let corners = mesh.triangles()[at.triangle].map(place);
                        let (_, gradients) = geometry(corners);
                        let side = |i: usize| {
                            let (a, b) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
                            [b[0] - a[0], b[1] - a[1]]
                        };
                        let [dx, dy] = side(at.local);
                        let long = |i: usize| dot(side(i), side(i)).sqrt();
                        let h = (0..3).map(long).fold(ZERO, |h, l| if l > h { l } else { h });
                        let length_of_edge = long(at.local);
                        let normal = [dy / length_of_edge, -dx / length_of_edge];
                        let seen = |node: usize| on_circle(circle, places[node], normal);
                        let [lambda, mu] = lame(at.triangle);
                        edges.push(Edge {
                            element: at.triangle,
                            lambda,
                            mu,
                            gamma: D::from(gamma0 * modulus) * h,
                            length: length_of_edge,
                            normal,
                            directions: on_edge.iter().map(|&node| seen(node).1).collect(),
                            gradients,
                            local: at.local,
                            gap: on_edge
                                .iter()
                                .map(|&node| scaled(gap.at(seen(node).0), length))
                                .collect(),
                        });
                    }
                    _ => {}
                }
            }
        }
        Assembled { degree, elements, edges, load, prescribed, length, modulus }
    }

    /// n~ . sigma(v) n of each node and component of the triangle at an end of the edge.
    fn stress(&self, edge: &Edge, end: usize) -> Vec<V> {
        let mut l = [ZERO; 3];
        l[(edge.local + 1 + end) % 3] = D::from(1.0);
        let (n, d) = (edge.normal, edge.directions[end]);
        let turn = dot(n, d);
        let stress = |g: V| {
            let (across, along) = (edge.mu * dot(g, n), edge.mu * dot(g, d));
            [0, 1].map(|c| edge.lambda * turn * g[c] + across * d[c] + along * n[c])
        };
        shapes(self.degree, l, edge.gradients).into_iter().map(|(_, g)| stress(g)).collect()
    }

    /// P0 and sigma_n of each node and component of the triangle, and g, at `s` on the edge: sigma_n is affine, the rest is given
    /// by its values at the nodes.
    fn functionals(&self, edge: &Edge, s: D) -> (Vec<V>, Vec<V>, D) {
        let t = D::from(1.0) - s;
        let shapes = if self.degree == 1 {
            vec![t, s]
        } else {
            vec![t * (t - s), s * (s - t), (s * t).times(4.0)]
        };
        let affine = |(a, b): (&V, &V)| [0, 1].map(|c| t * a[c] + s * b[c]);
        let ends = [0, 1].map(|end| self.stress(edge, end));
        let sigma: Vec<V> = ends[0].iter().zip(&ends[1]).map(affine).collect();
        let mut p0: Vec<V> = sigma.iter().map(|v| v.map(|c| -(edge.gamma * c))).collect();
        let nodes = [(edge.local + 1) % 3, (edge.local + 2) % 3, 3 + edge.local];
        let mut gap = ZERO;
        for (a, &shape) in shapes.iter().enumerate() {
            for c in 0..2 {
                p0[nodes[a]][c] = p0[nodes[a]][c] + shape * edge.directions[a][c];
            }
            gap = gap + shape * edge.gap[a];
        }
        (p0, sigma, gap)
    }

    fn apply(&self, edge: &Edge, functional: &[V], u: &[V]) -> D {
        let nodes = &self.elements[edge.element].nodes;
        nodes.iter().zip(functional).fold(ZERO, |sum, (&node, &f)| sum + dot(f, u[node]))
    }

    /// The pieces of (0, 1) where P > 0.
    fn positive(&self, edge: &Edge, u: &[V]) -> Vec<[D; 2]> {
        let p = |s: f64| {
            let (p0, _, gap) = self.functionals(edge, D::from(s));
            self.apply(edge, &p0, u) - gap
        };
        let (a, b) = (p(0.0), p(1.0));
        // P = c + m t + q t^2
        let q = if self.degree == 1 { ZERO } else { (a + b).times(2.0) - p(0.5).times(4.0) };
        let m = b - a - q;
        let mut cuts = vec![ZERO];
        if q == ZERO {
            if m != ZERO {
                cuts.push(-a / m);
            }
        } else {
            let square = m * m - (q * a).times(4.0);
            if square > ZERO {
                let root = square.sqrt();
                let half = (m + if m.0 < 0.0 { -root } else { root }).times(-0.5);
                cuts.push(half / q);
                if half != ZERO {
                    cuts.push(a / half);
                }
            }
        }
        let one = D::from(1.0);
        cuts.retain(|&s| s >= ZERO && s < one);
        cuts.push(one);
        cuts.sort_by(|x, y| x.partial_cmp(y).unwrap());
        let inside = |w: &&[D]| {
            let s = (w[0] + w[1]).times(0.5);
            a + s * (m + q * s) > ZERO && w[1] > w[0]
        };
        cuts.windows(2).filter(inside).map(|w| [w[0], w[1]]).collect()
    }

    /// The residual of (8) and, added into `tangent`, its derivative.
    fn residual(&self, u: &[V], mut tangent: Option<&mut Envelope>) -> Vec<V> {
        let mut r: Vec<V> = self.load.iter().map(|l| l.map(|c| -c)).collect();
        for Element { nodes, stiffness } in &self.elements {
            let n = 2 * nodes.len();
            for i in 0..n {
                let mut sum = ZERO;
                for j in 0..n {
                    sum = sum + stiffness[i * n + j] * u[nodes[j / 2]][j % 2];
                }
                let at = &mut r[nodes[i / 2]][i % 2];
                *at = *at + sum;
            }
            if let Some(tangent) = tangent.as_deref_mut() {
                tangent.add(nodes, |i, j| stiffness[i * n + j]);
            }
        }
        for edge in &self.edges {
            let nodes = &self.elements[edge.element].nodes;
            let whole = [[ZERO, D::from(1.0)]];
            let mut term = |pieces: &[[D; 2]], points: usize, stress: bool| {
                for [from, to] in pieces {
                    for (t, weight) in gauss(points) {
                        let (p0, sigma, gap) = self.functionals(edge, *from + (*to - *from) * t);
                        let weight = weight * (*to - *from) * edge.length;
                        let (f, weight, value) = if stress {
                            let value = self.apply(edge, &sigma, u);
                            (sigma, -weight * edge.gamma, value)
                        } else {
                            let value = self.apply(edge, &p0, u) - gap;
                            (p0, weight / edge.gamma, value)
                        };
                        for (&node, f) in nodes.iter().zip(&f) {
                            for c in 0..2 {
                                r[node][c] = r[node][c] + weight * value * f[c];
                            }
                        }
                        if let Some(tangent) = tangent.as_deref_mut() {
                            tangent.add(nodes, |i, j| weight * f[i / 2][i % 2] * f[j / 2][j % 2]);
                        }
                    }
                }
            };
            term(&whole, 2, true);
            term(&self.positive(edge, u), 3, false);
        }
        for (r, prescribed) in r.iter_mut().zip(&self.prescribed) {
            for c in 0..2 {
                if prescribed[c].is_some() {
                    r[c] = ZERO;
                }
            }
        }
        r
    }

    /// a(u, v)
    fn energy_product(&self, u: &[V], v: &[V]) -> D {
        let mut sum = ZERO;
        for Element { nodes, stiffness } in &self.elements {
            let n = 2 * nodes.len();
            for i in 0..n {
                for j in 0..n {
                    let (a, b) = (u[nodes[i / 2]][i % 2], v[nodes[j / 2]][j % 2]);
                    sum = sum + stiffness[i * n + j] * a * b;
                }
            }
        }
        sum
    }

    /// Newton's method from `start` (nodal displacements; it decides how many steps are taken, not where they lead: J_h is
    /// strictly convex), until a step changes less than 1e-13 of the energy norm: the
    /// next one, which converges quadratically, would change nothing that counts here. `None` after 500 steps, or without a
    /// Cholesky factor.
    pub fn solve(&self, start: Option<&[[f64; 2]]>) -> Option<Answer> {
        let mut u: Vec<V> = match start {
            Some(start) => start.iter().map(|v| v.map(|c| D::from(c / self.length))).collect(),
            None => vec![[ZERO; 2]; self.load.len()],
        };
        for (u, prescribed) in u.iter_mut().zip(&self.prescribed) {
            for c in 0..2 {
                u[c] = prescribed[c].unwrap_or(u[c]);
            }
        }
        let mut envelope = Envelope::new(&self.elements, &self.prescribed);
        for _ in 0..500 {
            envelope.clear();
            let r = self.residual(&u, Some(&mut envelope));
            let d = envelope.solve(&r)?;
            let moved = |t: D| -> Vec<V> {
                u.iter().zip(&d).map(|(u, d)| [u[0] + t * d[0], u[1] + t * d[1]]).collect()
            };
            // J_h is convex along d: a zero of its derivative, to a tenth, by bisection.
            let slope = |u: &[V]| {
                self.residual(u, None).iter().zip(&d).fold(ZERO, |s, (r, d)| s + dot(*r, *d))
            };
            let first = r.iter().zip(&d).fold(ZERO, |s, (r, d)| s + dot(*r, *d));
            let (mut low, mut high, mut t) = (0.0, f64::INFINITY, 1.0);
            let mut next = moved(D::from(t));
            for _ in 0..40 {
                let at = slope(&next);
                if at.0.abs() <= 0.1 * first.0.abs() {
                    break;
                }
                if at.0 > 0.0 {
                    high = t
                } else {
                    low = t
                }
                t = if high.is_finite() { (low + high) / 2.0 } else { 2.0 * t };
                next = moved(D::from(t));
            }
            u = next;
            let (step, size) = (self.energy_product(&d, &d).0, self.energy_product(&u, &u).0);
            if step <= 1e-26 * size {
                return Some(Answer(u));
            }
        }
        None
    }

    /// |v - u|_a / |u|_a for the answer v rounded to doubles: no displacement in doubles can be held to less.
    pub fn rounding(&self, answer: &Answer) -> f64 {
        let rounded: Vec<[f64; 2]> =
            answer.0.iter().map(|u| u.map(|c| c.0 * self.length)).collect();
        self.error(answer, &rounded)
    }

    /// a(u, u) in the units of the problem.
    pub fn energy(&self, Answer(u): &Answer) -> f64 {
        self.energy_product(u, u).0 * self.length * self.modulus * self.length
    }

    /// |v - u|_a / |u|_a for nodal displacements `v` of another solver.
    pub fn error(&self, answer: &Answer, v: &[[f64; 2]]) -> f64 {
        let e: Vec<V> = answer
            .0
            .iter()
            .zip(v)
            .map(|(u, v)| [0, 1].map(|c| D::from(v[c] / self.length) - u[c]))
            .collect();
        let (error, size) =
            (self.energy_product(&e, &e).0, self.energy_product(&answer.0, &answer.0).0);
        if error <= 0.0 { 0.0 } else { (error / size).sqrt() }
    }
}

/// Where a node of a contact line lies behind its facet, and n~ there.
fn on_circle(circle: Option<Circle>, place: [f64; 2], normal: V) -> ([f64; 2], V) {
    let Some(Circle { center, radius, is_around }) = circle else { return (place, normal) };
    let from = [0, 1].map(|c| place[c] - center[c]);
    let out = from.map(|x| x / from[0].hypot(from[1]));
    let sign = if is_around { 1.0 } else { -1.0 };
    ([0, 1].map(|c| center[c] + radius * out[c]), out.map(|x| D::from(sign * x)))
}

/// Twice the area and the gradients of the barycentric coordinates.
fn geometry(corners: [V; 3]) -> (D, [V; 3]) {
    let [a, b, c] = corners;
    let (p, q) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let area2 = p[0] * q[1] - p[1] * q[0];
    let gradients = [0, 1, 2].map(|i| {
        let (j, k) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
        [(j[1] - k[1]) / area2, (k[0] - j[0]) / area2]
    });
    (area2, gradients)
}

/// a(.,.) of all pairs of shape functions, by a rule exact for squares of their gradients.
fn stiffness(degree: usize, lambda: D, mu: D, area2: D, gradients: [V; 3]) -> Vec<D> {
    let third = D::from(1.0) / D::from(3.0);
    let (half, zero) = (D::from(0.5), ZERO);
    let rule: Vec<([D; 3], D)> = match degree {
        1 => vec![([third; 3], half)],
        _ => [[zero, half, half], [half, zero, half], [half, half, zero]]
            .map(|l| (l, half * third))
            .to_vec(),
    };
    let n = if degree == 1 { 6 } else { 12 };
    let mut k = vec![ZERO; n * n];
    for (l, weight) in rule {
        let shapes = shapes(degree, l, gradients);
        for i in 0..n {
            for j in 0..n {
                let ((g, c), (h, d)) = ((shapes[i / 2].1, i % 2), (shapes[j / 2].1, j % 2));
                let shear = if c == d { dot(g, h) } else { ZERO };
                let entry = lambda * g[c] * h[d] + mu * (shear + g[d] * h[c]);
                k[i * n + j] = k[i * n + j] + weight * area2 * entry;
            }
        }
    }
    k
}

/// Gauss's points on (0, 1), 2 or 3 of them, with their weights.
fn gauss(points: usize) -> Vec<(D, D)> {
    let (one, half) = (D::from(1.0), D::from(0.5));
    if points == 2 {
        let offset = half * (one / D::from(3.0)).sqrt();
        return vec![(half - offset, half), (half + offset, half)];
    }
    let offset = half * (D::from(3.0) / D::from(5.0)).sqrt();
    let (outer, inner) = (D::from(5.0) / D::from(18.0), D::from(4.0) / D::from(9.0));
    vec![(half - offset, outer), (half, inner), (half + offset, outer)]
}

/// A symmetric positive definite matrix over the free unknowns, row by row from the first entry to the diagonal.
struct Envelope {
    number: Vec<[Option<usize>; 2]>,
    count: usize,
    start: Vec<usize>,
    first: Vec<usize>,
    values: Vec<D>,
}

impl Envelope {
    fn new(elements: &[Element], prescribed: &[[Option<D>; 2]]) -> Self {
        let mut number = vec![[None; 2]; prescribed.len()];
        let mut count = 0;
        for node in cuthill_mckee(elements, prescribed.len()) {
            for c in 0..2 {
                if prescribed[node][c].is_none() {
                    number[node][c] = Some(count);
                    count += 1;
                }
            }
        }
        let mut first: Vec<usize> = (0..count).collect();
        for element in elements {
            let all: Vec<usize> = element.nodes.iter().flat_map(|&v| number[v]).flatten().collect();
            let least = all.iter().copied().min().unwrap_or(0);
            all.iter().for_each(|&i| first[i] = first[i].min(least));
        }
        let mut start = vec![0; count + 1];
        for i in 0..count {
            start[i + 1] = start[i] + i - first[i] + 1;
        }
        let values = vec![ZERO; start[count]];
        Envelope { number, count, start, first, values }
    }

    fn clear(&mut self) {
        self.values.fill(ZERO);
    }

    fn add(&mut self, nodes: &[usize], entry: impl Fn(usize, usize) -> D) {
        for i in 0..2 * nodes.len() {
            let Some(row) = self.number[nodes[i / 2]][i % 2] else { continue };
            for j in 0..2 * nodes.len() {
                match self.number[nodes[j / 2]][j % 2] {
                    Some(column) if column <= row => {
                        let at = &mut self.values[self.start[row] + column - self.first[row]];
                        *at = *at + entry(i, j);
                    }
                    _ => {}
                }
            }
        }
    }

    /// -(the inverse) r, by L L^T in place; `None` without one.
    fn solve(&mut self, r: &[V]) -> Option<Vec<V>> {
        let mut x = vec![ZERO; self.count];
        for (number, r) in self.number.iter().zip(r) {
            for c in 0..2 {
                if let Some(i) = number[c] {
                    x[i] = -r[c];
                }
            }
        }
        let Envelope { start, first, values, .. } = self;
        for i in 0..x.len() {
            for j in first[i]..=i {
                let from = first[i].max(first[j]);
                let mut sum = values[start[i] + j - first[i]];
                for k in from..j {
                    let (a, b) = (values[start[i] + k - first[i]], values[start[j] + k - first[j]]);
                    sum = sum - a * b;
                }
                values[start[i] + j - first[i]] = if j < i {
                    sum / values[start[j] + j - first[j]]
                } else if sum > ZERO {
                    sum.sqrt()
                } else {
                    return None;
                };
            }
            let mut sum = x[i];
            for k in first[i]..i {
                sum = sum - values[start[i] + k - first[i]] * x[k];
            }
            x[i] = sum / values[start[i] + i - first[i]];
        }
        for i in (0..x.len()).rev() {
            x[i] = x[i] / values[start[i] + i - first[i]];
            for k in first[i]..i {
                x[k] = x[k] - values[start[i] + k - first[i]] * x[i];
            }
        }
        Some(self.number.iter().map(|n| n.map(|i| i.map_or(ZERO, |i| x[i]))).collect())
    }
}

/// The nodes in the order in which they are reached from the ends of the body.
fn cuthill_mckee(elements: &[Element], count: usize) -> Vec<usize> {
    let mut of_node: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (e, element) in elements.iter().enumerate() {
        element.nodes.iter().for_each(|&node| of_node[node].push(e));
    }
    let walk = |from: usize, seen: &mut Vec<bool>| {
        let mut order = vec![from];
        seen[from] = true;
        let mut next = 0;
        while next < order.len() {
            let mut near: Vec<usize> =
                of_node[order[next]].iter().flat_map(|&e| &elements[e].nodes).copied().collect();
            near.sort_by_key(|&node| (of_node[node].len(), node));
            for node in near {
                if !std::mem::replace(&mut seen[node], true) {
                    order.push(node);
                }
            }
            next += 1;
        }
        order
    };
    let (mut seen, mut order) = (vec![false; count], Vec::new());
    for node in 0..count {
        if !seen[node] {
            // From the far end of what hangs together here.
            let mut trial = seen.clone();
            let far = walk(node, &mut trial).last().copied().unwrap_or(node);
            order.extend(walk(far, &mut seen));
        }
    }
    order
}
