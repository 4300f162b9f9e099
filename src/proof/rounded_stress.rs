//! Forces of a displacement from stresses in doubles, off by no more than a proved norm: docs/a-posteriori.md, 7.5. They take a
//! fraction of the time of [`add_internal_forces`](crate::contact::residual::add_internal_forces) in balls.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::products::rounded_sum_with_products;
use crate::contact::Law;
use crate::contact::Piece;
use crate::contact::discretization::Discretization;
use crate::contact::residual::exactly;
use crate::kernel::axial;
use crate::kernel::ball::up;
use crate::kernel::element::displacement_gradient;
use crate::kernel::{DoubleDouble, Element, Material, PreciseBall, Stress, Triangle};
use crate::linear::on_this_processor;
use crate::model::BoundaryEdge;
use crate::model::element::with_element;
use crate::model::material::{Materials, largest_entry, least_eigenvalue};

/// Adds int s:eps(v) for every basis function v, where s is the stress of `u` that doubles give. Returns a b with
/// |int (s - sigma(u)):eps(v)| <= b |v|_a for all v: docs/a-posteriori.md, 7.5. Infinite or NaN where there is none.
pub fn add_forces(
    d: &Discretization,
    u: &[[PreciseBall; 2]],
    forces: &mut [[PreciseBall; 2]],
) -> f64 {
    each_force(
        d,
        u,
        #[inline(always)]
        |node, part| {
            part.add_to(&mut forces[node]);
        },
    )
}

/// The forces of [`add_forces`] by sums in doubles, their rounding in the radii, for very small displacements; and the bound.
pub fn small_forces(d: &Discretization, u: &[[PreciseBall; 2]]) -> (Vec<[PreciseBall; 2]>, f64) {
    let mut sums = vec![[RoundedSum::default(); 2]; u.len()];
    let bound = each_force(
        d,
        u,
        #[inline(always)]
        |node, part| match part {
            Part::Meridian { stress: [xx, yy, xy], normal } => {
                let [x, y] = normal.map(DoubleDouble::head);
                sums[node][0].add([xx * x, xy * y]);
                sums[node][1].add([xy * x, yy * y]);
            }
            // The radius of an area is far below a unit of it.
            Part::Hoop { stress, area } => sums[node][0].add([stress * area.head(), 0.0]),
        },
    );
    (sums.into_iter().map(|sum| sum.map(RoundedSum::enclosed)).collect(), bound)
}

/// A sum of products of doubles, and a bound of its error in units of roundoff.
#[derive(Clone, Copy, Debug, Default)]
struct RoundedSum {
    value: f64,
    error: f64,
}

impl RoundedSum {
    /// Adds two products, of which one factor was rounded. Each is off by two units of itself, their sum by one of its own.
    #[inline]
    fn add(&mut self, products: [f64; 2]) {
        self.value += products[0] + products[1];
        self.error += self.value.abs() + 3.0 * (products[0].abs() + products[1].abs());
    }

    fn enclosed(self) -> PreciseBall {
        let off = if self.error == 0.0 { 0.0 } else { UNIT * self.error + f64::MIN_POSITIVE };
        PreciseBall::from(self.value).widened(SAFETY * off)
    }
}

/// Half of the distance from 1 to the next double.
const UNIT: f64 = f64::EPSILON / 2.0;

/// A part of the force on a node.
enum Part {
    /// The components xx, yy, xy of a combination of the stresses on a triangle, exactly, and half of a normal of it, on which they
    /// act.
    Meridian { stress: [f64; 3], normal: [DoubleDouble; 2] },
    /// A combination of hoop stresses, exactly, and the share of the triangle's area on which it acts, along r.
    Hoop { stress: f64, area: PreciseBall },
}

impl Part {
    #[inline(always)]
    fn add_to(self, force: &mut [PreciseBall; 2]) {
        match self {
            Part::Meridian { stress: [xx, yy, xy], normal: [x, y] } => {
                for (force, products) in
                    force.iter_mut().zip([[(xx, x), (xy, y)], [(xy, x), (yy, y)]])
                {
                    let (sum, error) = rounded_sum_with_products(force.centre(), products);
                    *force = PreciseBall::around(sum, up(force.radius() + error));
                }
            }
            Part::Hoop { stress, area } => force[0] += PreciseBall::from(stress) * area,
        }
    }
}

/// Calls `add` with the parts of the forces of the stress s that doubles give for `u`. Returns the bound of [`add_forces`].
fn each_force(d: &Discretization, u: &[[PreciseBall; 2]], add: impl FnMut(usize, Part)) -> f64 {
    on_this_processor!(with_element!(d.space.degree(), E => each_force_of::<E, _, _>(d, u, add)))
}

#[inline(always)]
fn each_force_of<E: Element<N, M>, const N: usize, const M: usize>(
    d: &Discretization,
    u: &[[PreciseBall; 2]],
    mut add: impl FnMut(usize, Part),
) -> f64 {
    let (mut points, mut count) = ([([0.0; 3], 0.0); N], 0);
    E::at_stiffness_points(|l: [f64; 3], weight: f64| {
        points[count] = (l, weight);
        count += 1;
    });
    let points = &points[..E::POINTS];
    let terms = Term::all::<E, M>();
    let moduli = Moduli::of_each(&d.problem.material);
    let hoop_terms = HoopTerm::all::<E, N, M>();
    let mut stresses = [[0.0; 3]; N];
    let mut square = 0.0;
    for (t, (triangle, nodes)) in d.space.triangles::<N>().enumerate() {
        let material = d.problem.material.of(t);
        let radii = material.radii(&triangle);
        let is_still = |node: &usize| u[*node][0].magnitude() == 0.0;
        if moves_as_a_whole(nodes, u) && (radii.is_none() || nodes.iter().all(is_still)) {
            continue;
        }
        let nodal = nodes.map(|node| &u[node]);
        let rounded = RoundedStrain::new::<E, M>(Gradients::new(&triangle), nodal);
        let moduli = &moduli[d.problem.material.place_of(t)];
        if let Some(radii) = radii {
            let hoop = RoundedHoop::new::<E, N, M>(radii, nodal);
            square += rounded.error_squared_of_revolution(&hoop, moduli);
            let mut states = [(Stress::new([0.0; 3]), 0.0); 3];
            for (a, &(l, _)) in points.iter().enumerate() {
                let gradient = rounded.gradient::<E, M>(l);
                states[a] = material.stress_of_revolution(gradient, hoop.strains[a]);
            }
            for (b, at) in stresses.iter_mut().enumerate().take(E::POINTS) {
                *at = axial::weighted(&hoop.mass, &states, b, E::POINTS).components();
            }
            let mut hoops = [states.map(|(_, hoop)| hoop)];
            if E::POINTS > 1 {
                make_sums_exact(&mut hoops);
            }
            let double_area = exactly::<PreciseBall>(triangle).double_area();
            for HoopTerm { node, share, coefficients } in &hoop_terms {
                let pairs = coefficients.iter().zip(hoops[0]);
                let stress = pairs.fold(0.0, |sum, (share, stress)| sum + share * stress);
                add(nodes[*node], Part::Hoop { stress, area: double_area * *share });
            }
        } else {
            square += rounded.stress_error_squared(moduli);
            for (&(l, weight), at) in points.iter().zip(&mut stresses) {
                *at = rounded.stress::<E, M>(material, l).components().map(|s| weight * s);
            }
        }
        let stresses = &mut stresses[..E::POINTS];
        if E::POINTS > 1 {
            make_sums_exact(stresses);
        }
        each_part(&terms, stresses, (&triangle, nodes), &mut add);
    }
    SAFETY * square.sqrt()
}

/// Calls `add` with the parts of the forces on the nodes of a triangle of stresses at the points of the rule, each times its weight.
#[inline(always)]
fn each_part<const N: usize>(
    terms: &[Term<N>],
    stresses: &[[f64; 3]],
    (triangle, nodes): (&Triangle<f64>, &[usize; N]),
    add: &mut impl FnMut(usize, Part),
) {
    // The area times the gradient of a barycentric coordinate is half a normal.
    let half = triangle.vertices.map(|x| x * 0.5);
    let normal = |from: Vector2<f64>, to: Vector2<f64>| {
        [DoubleDouble::sum(from[1], -to[1]), DoubleDouble::sum(to[0], -from[0])]
    };
    let normals = [normal(half[1], half[2]), normal(half[2], half[0]), normal(half[0], half[1])];
    for Term { node, side, coefficients } in terms {
        let mut sum = [0.0; 3];
        for (coefficient, stress) in coefficients.iter().zip(stresses) {
            for (sum, s) in sum.iter_mut().zip(stress) {
                *sum += coefficient * s;
            }
        }
        add(nodes[*node], Part::Meridian { stress: sum, normal: normals[*side] });
    }
}

/// The part of the force at a node of a triangle that has the direction of one of its sides: the stresses at the points of the
/// rule, each times its coefficient, on half the normal there.
struct Term<const N: usize> {
    node: usize,
    side: usize,
    coefficients: [f64; N],
}

impl<const N: usize> Term<N> {
    /// Those that are not zero. At the points of the rules the gradients of the shape functions are sums of those of the
    /// barycentric coordinates, each once or twice, with either sign.
    fn all<E: Element<N, M>, const M: usize>() -> Vec<Term<N>> {
        let unit = [Vector3::x(), Vector3::y(), Vector3::z()];
        let mut at: Vec<[Vector3<f64>; N]> = Vec::new();
        E::at_stiffness_points(|l: [f64; 3], _: f64| at.push(E::gradients(l, unit)));
        let term = |node: usize, side: usize| {
            let mut coefficients = [0.0; N];
            for (coefficient, gradients) in coefficients.iter_mut().zip(&at) {
                *coefficient = gradients[node][side];
            }
            Term { node, side, coefficients }
        };
        let all = (0..N).flat_map(|node| (0..3).map(move |side| term(node, side)));
        all.filter(|term| term.coefficients != [0.0; N]).collect()
    }
}

/// The part of the force at a node of a triangle that its hoop stresses make: these at the points of the rule, each times its
/// coefficient, on a share of twice the area.
struct HoopTerm {
    node: usize,
    share: PreciseBall,
    coefficients: [f64; 3],
}

impl HoopTerm {
    /// The terms of all nodes. The [shares](axial::shares) of a node are small multiples of one of them.
    fn all<E: Element<N, M>, const N: usize, const M: usize>() -> Vec<Self> {
        let shares = axial::shares::<E, N, M>();
        let term = |node: usize| {
            let of = shares.map(|row| row[node]);
            let unit = of.into_iter().filter(|share| *share != 0).map(i32::abs).min().unwrap_or(1);
            let share = PreciseBall::from(unit) / PreciseBall::from(60);
            HoopTerm { node, share, coefficients: of.map(|share| f64::from(share / unit)) }
        };
        (0..N).map(term).collect()
    }
}

/// Rounds numbers to multiples of one power of two, by no more than 2^-50 of the largest: their sums are then exact, while these
/// are less than eight times the largest.
#[inline(always)]
fn make_sums_exact(numbers: &mut [[f64; 3]]) {
    let largest = numbers.iter().flatten().fold(0.0, |m: f64, s| m.max(s.abs()));
    // The power of two just below.
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    let shift = 12.0 * power;
    numbers.iter_mut().flatten().for_each(|s| *s = (*s + shift) - shift);
}

/// Returns whether a piece has one side, in the plane, and no friction: doubles tell of these whether they press, and their stress.
pub fn is_plain<S>(piece: &Piece<S>) -> bool {
    piece.sides.len() == 1 && piece.geometry.law == Law::Contact && piece.radii.is_none()
}

/// Adds -int gamma sigma_n(u) sigma_n(v) on the plain pieces for every basis function v, with the stress of `u` that doubles give. Returns
/// by how much the square of the bound of [`add_forces`] grows: the error of the stress itself counts no more than there, because
/// what is left of a(v, v) is between 0 and a(v, v) for every field of stresses, not for those of displacements alone.
pub fn add_contact_stresses(
    d: &Discretization,
    u: &[[PreciseBall; 2]],
    forces: &mut [[PreciseBall; 2]],
) -> f64 {
    with_element!(d.space.degree(), E => add_contact_stresses_of::<E, _, _>(d, u, forces))
}

fn add_contact_stresses_of<E: Element<N, M>, const N: usize, const M: usize>(
    d: &Discretization,
    u: &[[PreciseBall; 2]],
    forces: &mut [[PreciseBall; 2]],
) -> f64 {
    let terms = Term::all::<E, M>();
    let moduli = Moduli::of_each(&d.problem.material);
    let mut square = 0.0;
    for piece in d.contact.iter().filter(|piece| is_plain(piece)) {
        let on = RoundedPiece::<N>::new::<E, M>(d, piece, u, &moduli);
        let RoundedPiece { triangle, nodes, strain, traces: [start, end], size, off } = on;
        let Gradients { area, skew, .. } = strain.gradients;
        let (t, local, normal) = (piece.edge().triangle, piece.edge().local, piece.normal());
        let weight = piece.gamma * piece.length;
        let factors = [2.0 * start + end, start + 2.0 * end].map(|f| -f * weight / (6.0 * area));
        let mut stresses = [[0.0; 3]; N];
        for (a, factor) in factors.into_iter().enumerate() {
            let outer = piece.direction(a) * normal.transpose();
            let of_unit = d.problem.material.of(t).stress(outer).components();
            for (p, stress) in stresses.iter_mut().enumerate().take(E::POINTS) {
                let share = factor * at_vertex(E::POINTS, p, (local + 1 + a) % 3);
                *stress = [0, 1, 2].map(|k| stress[k] + share * of_unit[k]);
            }
        }
        let stresses = &mut stresses[..E::POINTS];
        if E::POINTS > 1 {
            make_sums_exact(stresses);
        }
        let add = &mut |node: usize, part: Part| part.add_to(&mut forces[node]);
        each_part(&terms, stresses, (&triangle, nodes), add);
        let Moduli { most, least } = moduli[d.problem.material.place_of(t)];
        let largest = E::POINTS as f64 * 2.0 * most * weight * size / area;
        let more = f64::EPSILON * (40.0 + 4.0 * skew) * largest + f64::MIN_POSITIVE;
        // Up to three edges of a triangle are on Gamma_C.
        square += more * (2.0 * off + 3.0 * more) * (area / least) + f64::MIN_POSITIVE;
    }
    SAFETY * square
}

/// The factor of the stress at point `p` of the rule with so many points in that at a vertex.
fn at_vertex(points: usize, p: usize, vertex: usize) -> f64 {
    if points > 1 && p == vertex { -1.0 } else { 1.0 }
}

/// The plain pieces on which P of `u` is certainly nowhere positive, whatever the rule: no ball is needed to know that they do not press.
/// P = n~ . u - g - gamma s at the nodes, with the stress that doubles give and what that is off by at most; the other coefficient of P2
/// is Bernstein's.
pub(crate) fn surely_open(d: &Discretization, u: &[[PreciseBall; 2]]) -> Vec<bool> {
    open_by(d, u, 1.0)
}

/// Those by a share of the bound.
fn open_by(d: &Discretization, u: &[[PreciseBall; 2]], share: f64) -> Vec<bool> {
    with_element!(d.space.degree(), E => open_of::<E, _, _>(d, u, share))
}

fn open_of<E: Element<N, M>, const N: usize, const M: usize>(
    d: &Discretization,
    u: &[[PreciseBall; 2]],
    share: f64,
) -> Vec<bool> {
    let moduli = Moduli::of_each(&d.problem.material);
    let is_open = |piece: &Piece| {
        let on = RoundedPiece::<N>::new::<E, M>(d, piece, u, &moduli);
        let RoundedPiece { nodes, traces: [start, end], size, off, .. } = on;
        // From the points to the ends.
        let of_stress = (2 * E::DEGREE - 1) as f64 * off + 16.0 * f64::EPSILON * size;
        let of_nodes = E::edge_nodes(piece.edge().local);
        let p: [[f64; 2]; M] = std::array::from_fn(|a| {
            let (at, gap, n) = (u[nodes[of_nodes[a]]], piece.gap_of(a), piece.direction(a));
            let trace = [start, end, (start + end) / 2.0][a];
            let value = n[0] * at[0].head() + n[1] * at[1].head() - gap - piece.gamma * trace;
            let sizes = at[0].head().abs() + at[1].head().abs() + gap.abs();
            let radii = at[0].radius() + at[1].radius() + f64::MIN_POSITIVE;
            let by = piece.gamma * of_stress + 8.0 * f64::EPSILON * sizes + radii;
            [value, SAFETY * share * by]
        });
        let (ends, middle) = p.split_at(2);
        let lows = ends[0][0] + ends[1][0] - (ends[0][1] + ends[1][1]);
        let below = |&[p, by]: &[f64; 2]| p + by < 0.0;
        ends.iter().all(below) && middle.iter().all(|&[p, by]| 4.0 * (p + by) < lows)
    };
    d.contact.iter().map(|piece| is_plain(piece) && is_open(piece)).collect()
}

/// The stress on a plain piece in doubles, with what bounds its rounding.
struct RoundedPiece<'d, const N: usize> {
    triangle: Triangle<f64>,
    nodes: &'d [usize; N],
    strain: RoundedStrain<N>,
    /// s at the start and at the end.
    traces: [f64; 2],
    /// The magnitudes that these were added up from.
    size: f64,
    /// A bound of what the stress at a point of the rule is off by.
    off: f64,
}

impl<'d, const N: usize> RoundedPiece<'d, N> {
    fn new<E: Element<N, M>, const M: usize>(
        d: &'d Discretization,
        piece: &Piece,
        u: &[[PreciseBall; 2]],
        moduli: &[Moduli],
    ) -> Self {
        let BoundaryEdge { triangle: t, local, .. } = piece.edge();
        let (triangle, material) = (d.space.mesh().triangle(t), d.problem.material.of(t));
        let nodes = &d.space.elements_of::<N>()[t];
        let strain =
            RoundedStrain::new::<E, M>(Gradients::new(&triangle), nodes.map(|node| &u[node]));
        let (mut p, mut size, mut traces) = (0, 0.0, [0.0; 2]);
        E::at_stiffness_points(|l: [f64; 3], _: f64| {
            let stress = strain.stress::<E, M>(material, l);
            let [xx, yy, xy] = stress.components();
            size += xx.abs() + yy.abs() + 2.0 * xy.abs();
            let traction = stress.traction(piece.normal());
            for (a, trace) in traces.iter_mut().enumerate() {
                let along = piece.direction(a).dot(&traction);
                *trace += at_vertex(E::POINTS, p, (local + 1 + a) % 3) * along;
            }
            p += 1;
        });
        let off = moduli[d.problem.material.place_of(t)].most * strain.error + f64::MIN_POSITIVE;
        RoundedPiece { triangle, nodes, strain, traces, size, off }
    }
}

/// An upper bound of |v|_a from the magnitudes of the nodal values, as sigma:eps is at most |sigma| |eps|. Used for very small
/// fields, and for fields that vanish but near a boundary.
pub(crate) fn energy_norm_at_most(d: &Discretization, v: &[[PreciseBall; 2]]) -> f64 {
    on_this_processor!(with_element!(d.space.degree(), E => energy_norm_of::<E, _, _>(d, v)))
}

#[inline(always)]
fn energy_norm_of<E: Element<N, M>, const N: usize, const M: usize>(
    d: &Discretization,
    v: &[[PreciseBall; 2]],
) -> f64 {
    let moduli = Moduli::of_each(&d.problem.material);
    // The tails are below a unit of the heads.
    let size = |v: &PreciseBall| v.head().abs() + v.radius();
    let sizes: Vec<f64> = v.iter().map(|v| v.iter().map(size).sum()).collect();
    let mut square = 0.0;
    for (t, nodes) in d.space.elements_of::<N>().iter().enumerate() {
        let size: f64 = nodes.iter().map(|&node| sizes[node]).sum();
        if size != 0.0 {
            let triangle = d.space.mesh().triangle(t);
            let gradients = Gradients::new(&triangle);
            let mut strain = E::DEGREE as f64 * gradients.slope * size;
            let mut weight = gradients.area;
            if let Some([a, b, c]) = d.problem.material.of(t).radii(&triangle) {
                strain += 7.0 * size / (a + b + c);
                weight *= a + b + c;
            }
            let most = moduli[d.problem.material.place_of(t)].most;
            square += most * strain * strain * weight + f64::MIN_POSITIVE;
            square += if gradients.skew.is_finite() { 0.0 } else { f64::INFINITY };
        }
    }
    SAFETY * square.sqrt()
}

/// Returns whether all nodes certainly have the same value.
#[inline]
fn moves_as_a_whole<const N: usize>(nodes: &[usize; N], u: &[[PreciseBall; 2]]) -> bool {
    let first = u[nodes[0]];
    first.iter().all(|c| c.radius() == 0.0) && nodes[1..].iter().all(|&node| u[node] == first)
}

/// Covers the rounding of sums and products of positive numbers, some million of them, and areas that are off by a thousandth.
const SAFETY: f64 = 1.01;

/// The largest ratio of the products whose difference is the area to the area itself, a hypothesis of the analysis: flatter
/// triangles are left to balls.
const FLAT: f64 = (1_u64 << 40) as f64;

/// Bounds of the law of a material.
struct Moduli {
    /// |A m|_F is at most this times the sum of the magnitudes of the entries of m.
    most: f64,
    /// A - this is elliptic.
    least: f64,
}

impl Moduli {
    fn of_each(materials: &Materials) -> Vec<Self> {
        materials.distinct().iter().map(Moduli::new).collect()
    }

    fn new(material: &Material<f64>) -> Self {
        let most = if material.is_isotropic() {
            2.0 * (material.lambda().abs() + material.mu())
        } else {
            4.0 * largest_entry(material)
        };
        Moduli { most, least: least_eigenvalue(material) }
    }
}

/// The gradients of the barycentric coordinates of a triangle, in doubles.
#[derive(Clone, Copy)]
struct Gradients {
    barycentric: [Vector2<f64>; 3],
    area: f64,
    /// The products that the area is the difference of, beside it; infinite for a triangle that is too flat for doubles.
    skew: f64,
    /// The sum of the magnitudes of the gradients.
    slope: f64,
}

impl Gradients {
    #[inline(always)]
    fn new(triangle: &Triangle<f64>) -> Self {
        let [a, b] = [1, 2].map(|i| triangle.edge(i));
        let double_area = triangle.double_area();
        let products = (a[0] * b[1]).abs() + (a[1] * b[0]).abs();
        let inverse = 1.0 / double_area;
        let skew = products * inverse;
        let barycentric = [0, 1, 2].map(|i| triangle.scaled_normal(i) * -inverse);
        let slope = barycentric.iter().flatten().map(|g| g.abs()).sum::<f64>();
        let sound = double_area > 1e-200 && skew <= FLAT;
        let skew = if sound { skew } else { f64::INFINITY };
        Gradients { barycentric, area: double_area / 2.0, skew, slope }
    }
}

/// The hoop strain on a triangle in doubles, with what bounds its rounding.
struct RoundedHoop {
    /// At the points of the rule.
    strains: [f64; 3],
    /// The [mass](axial::mass) of its weight.
    mass: [[f64; 3]; 3],
    /// The sum of the radii, which bounds the weight.
    radii: f64,
    /// A bound of the error of the strain.
    error: f64,
}

impl RoundedHoop {
    fn new<E: Element<N, M>, const N: usize, const M: usize>(
        radii: [f64; 3],
        nodal: [&[PreciseBall; 2]; N],
    ) -> Self {
        let radial = nodal.map(|u| u[0].head());
        let mass = axial::mass::<E, _, _, _>(radii);
        let means = axial::means::<E, _, _, _>(&radial);
        let strains = axial::projected(&mass, means, E::POINTS);
        let points = strains.iter().take(E::POINTS);
        let left = (0..E::POINTS).map(|a| {
            let product = (0..E::POINTS).fold(-means[a], |sum, b| sum + mass[a][b] * strains[b]);
            product.abs()
        });
        let (left, largest): (f64, f64) =
            (left.sum(), points.fold(0.0, |m, s| f64::max(m, s.abs())));
        let radii = radii.iter().sum::<f64>();
        let sizes: f64 = radial.iter().map(|u| u.abs()).sum();
        let off: f64 = nodal.iter().map(|u| u[0].radius() + u[0].centre().tail().abs()).sum();
        let rounding = 8.0 * f64::EPSILON * (radii * largest + sizes);
        // The least eigenvalue of the mass.
        let least = if E::POINTS == 1 { radii / 3.0 } else { radii / 20.0 };
        let error = (left + rounding + off + f64::MIN_POSITIVE) / least;
        RoundedHoop { strains, mass, radii, error: error + f64::EPSILON * largest }
    }

    /// The largest magnitude of the strain.
    fn largest(&self) -> f64 {
        self.strains.iter().fold(0.0, |most: f64, strain| most.max(strain.abs()))
    }
}

/// The differences of nodal values on a triangle in doubles, with what bounds their rounding.
struct RoundedStrain<const N: usize> {
    /// Nodal values less the first one.
    differences: [Vector2<f64>; N],
    gradients: Gradients,
    /// A bound of the sum of the magnitudes of its entries.
    size: f64,
    /// A bound of the error of the strain, the rounding of the stress beside it included; infinite for a flat triangle.
    error: f64,
}

impl<const N: usize> RoundedStrain<N> {
    #[inline(always)]
    fn new<E: Element<N, M>, const M: usize>(
        gradients: Gradients,
        nodal: [&[PreciseBall; 2]; N],
    ) -> Self {
        let first = nodal[0];
        let difference = |u: &[PreciseBall; 2], c: usize| {
            (u[c].head() - first[c].head()) + (u[c].centre().tail() - first[c].centre().tail())
        };
        let differences = nodal.map(|u| Vector2::new(difference(u, 0), difference(u, 1)));
        // The absolute part of the error of the differences: what each node adds, and the first one to each.
        let of = |u: &PreciseBall| 2.0 * f64::EPSILON * u.centre().tail().abs() + u.radius();
        let off = nodal.into_iter().flatten().map(of).sum::<f64>()
            + N as f64 * (of(&first[0]) + of(&first[1]));
        let slope = E::DEGREE as f64 * gradients.slope;
        let sizes: f64 = differences.iter().flatten().map(|d| d.abs()).sum();
        let roundings = (N + 7 * E::DEGREE - 3) as f64 + 4.0 * gradients.skew;
        let error = slope * (f64::EPSILON * roundings * sizes + off + f64::MIN_POSITIVE);
        let error = if gradients.skew.is_finite() { error } else { f64::INFINITY };
        RoundedStrain { differences, gradients, size: slope * sizes, error }
    }

    /// An upper bound of the square of the stress error in the norm dual to |v|_a on the triangle: |sigma:eps| is at most
    /// |sigma| |eps|, and the least eigenvalue of A times |eps|^2 at most sigma(v):eps(v). The rounding of the three products of an entry of
    /// sigma is no more than that of the strain.
    #[inline(always)]
    fn stress_error_squared(&self, moduli: &Moduli) -> f64 {
        let off = moduli.most * self.error + f64::MIN_POSITIVE;
        off * off * (self.gradients.area / moduli.least) + f64::MIN_POSITIVE
    }

    /// [`RoundedStrain::stress_error_squared`] in a body of revolution: the hoop strain, the weights and the roundings to multiples of
    /// a power of two have their own errors, all of them relative to the largest stress (docs/theory.md, 11.5).
    fn error_squared_of_revolution(&self, hoop: &RoundedHoop, moduli: &Moduli) -> f64 {
        let rounding = 64.0 * f64::EPSILON * (self.size + hoop.largest());
        let off = moduli.most * (self.error + hoop.error + rounding) + f64::MIN_POSITIVE;
        off * off * (self.gradients.area * hoop.radii / moduli.least) + f64::MIN_POSITIVE
    }

    /// The displacement gradient at the point with the barycentric coordinates `l`.
    #[inline(always)]
    fn gradient<E: Element<N, M>, const M: usize>(&self, l: [f64; 3]) -> Matrix2<f64> {
        let gradients = E::gradients(l, self.gradients.barycentric);
        displacement_gradient(&self.differences, &gradients)
    }

    /// The stress there.
    #[inline(always)]
    fn stress<E: Element<N, M>, const M: usize>(
        &self,
        material: &Material<f64>,
        l: [f64; 3],
    ) -> Stress<f64> {
        material.stress(self.gradient::<E, M>(l))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::model::{Condition, Degree, Diagonal, Problem, Rectangle};
    use crate::proof::balls::Lines;
    use crate::solve::{Method, discretize};

    #[test]
    fn no_piece_that_presses_by_rounding_is_open_but_without_what_is_said_of_rounding_some_are() {
        let square = Rectangle { width: 1.0, height: 1.0, nx: 9, ny: 2, diagonal: Diagonal::Right };
        let material = Material::lame(1.3, 0.7, crate::kernel::Plane::Strain);
        let mesh = square.perturbed(0.2, 5).unwrap();
        let problem = Problem::of(mesh, material)
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0));
        for degree in [Degree::One, Degree::Two] {
            let mut d = discretize(&problem, &Method { degree, ..Method::default() }).unwrap();
            let mut taken = 0;
            for k in 0..20 {
                let wave = |[x, y]: [f64; 2]| {
                    let (x, y) = (x - 0.3 * f64::from(k), y + 0.1 * f64::from(k));
                    [(3.0 * x + y).sin(), 1e-3 * (x - 2.0 * y).cos()].map(PreciseBall::from)
                };
                let u: Vec<_> = d.space.nodes().iter().map(|x| wave(*x)).collect();
                // The gap with which P is nothing but rounding, and one in which no piece presses.
                let mut is_apart = |by: f64| {
                    for e in 0..d.contact.len() {
                        let p0 = Lines::new(&d)[e].p0(&u);
                        let nodes = &mut Arc::make_mut(&mut d.contact[e].geometry).nodes;
                        nodes.iter_mut().zip(p0).for_each(|(node, p)| node.gap = p.head() + by);
                    }
                    let lines = Lines::new(&d);
                    let presses = |e: usize| lines[e].p(&u).iter().any(|p| p.lower() > 0.0);
                    let presses: Vec<bool> = (0..d.contact.len()).map(presses).collect();
                    let [open, unbounded] = [1.0, 0.0].map(|share| open_by(&d, &u, share));
                    let both = |open: &[bool]| {
                        open.iter()
                            .zip(&presses)
                            .filter(|(open, presses)| **open && **presses)
                            .count()
                    };
                    assert_eq!(both(&open), 0, "{degree:?}");
                    (open.iter().all(|open| *open), both(&unbounded))
                };
                taken += is_apart(0.0).1;
                assert!(is_apart(1e-12).0, "{degree:?}: what is said of rounding is small");
            }
            assert!(taken > 2, "control: {degree:?}, {taken}");
        }
    }

    #[test]
    fn the_energy_of_one_moved_node_is_at_most_what_its_magnitude_says_and_no_tenth_of_that() {
        let square = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 2, diagonal: Diagonal::Right };
        let material = Material::lame(1.0, 1.0, crate::kernel::Plane::Strain);
        let problem = Problem::of(square.mesh().unwrap(), material)
            .with("top", Condition::clamped())
            .with("bottom", Condition::contact(|_| 0.0));
        for (degree, times) in [(Degree::One, 10.0), (Degree::Two, 20.0)] {
            let d = discretize(&problem, &Method { degree, ..Method::default() }).unwrap();
            for node in 0..d.space.nodes().len() {
                let mut u = vec![[0.0; 2]; d.space.nodes().len()];
                u[node] = [1e-20, 0.0];
                let norm = d.strain_energy(&u).sqrt();
                let u: Vec<[PreciseBall; 2]> = u.iter().map(|u| u.map(PreciseBall::from)).collect();
                let most = energy_norm_at_most(&d, &u);
                assert!(
                    norm <= most && most < times * norm,
                    "{degree:?} {node}: {norm:e} {most:e}"
                );
            }
        }
    }

    #[test]
    fn the_rounding_of_a_stress_is_that_of_the_triangles_own_material() {
        let square = Rectangle { width: 1.0, height: 1.0, nx: 2, ny: 2, diagonal: Diagonal::Right };
        let mesh = square.mesh().unwrap();
        let all: Vec<usize> = (0..mesh.triangles().len()).collect();
        for plane in [crate::kernel::Plane::Strain, crate::kernel::Plane::Axisymmetric] {
            let [soft, stiff] = [1e-3, 1.0].map(|by| Material::lame(1.3 * by, 0.7 * by, plane));
            // No triangle is made of the first.
            let second = Materials::in_parts(soft, all.len(), [(stiff, &all[..])]);
            let bounds = |materials: Materials, degree: Degree| {
                let problem = Problem::of(mesh.clone(), materials)
                    .with("top", Condition::clamped())
                    .with("bottom", Condition::contact(|_| 0.0));
                let d = discretize(&problem, &Method { degree, ..Method::default() }).unwrap();
                let of =
                    |&[x, y]: &[f64; 2]| [(3.0 * x + y).sin() * x, x * y].map(PreciseBall::from);
                let u: Vec<[PreciseBall; 2]> = d.space.nodes().iter().map(of).collect();
                let mut forces = vec![[PreciseBall::from(0); 2]; u.len()];
                (add_forces(&d, &u, &mut forces), energy_norm_at_most(&d, &u))
            };
            for degree in [Degree::One, Degree::Two] {
                let [alone, own, other] = [stiff.into(), second.clone(), soft.into()]
                    .map(|materials| bounds(materials, degree));
                assert_eq!(own, alone, "{degree:?}");
                // The control: that of the first is another.
                assert!(other.0 < 0.1 * own.0 && other.1 < 0.1 * own.1, "{other:?} {own:?}");
            }
        }
    }
}
