//! The comparison: every double within the bound of its own roundings, and what holds between the numbers of one problem.

use std::cell::RefCell;
use std::collections::BTreeMap;

use num_traits::ToPrimitive;
use signorini::contact::{Discretization, Piece, residual};
use signorini::linear::matrix::Numbering;
use signorini::model::{BoundaryEdge, Degree};
use signorini::results::Solution;
use signorini::solve::iterate::Evaluated;

use super::definition::{Mistake, Named, Setting, defined, inner, unit};
use super::draw::{Draw, owner};
use super::given::read;
use super::solver::{assembled, numbered, unsolved};
use crate::bodies::{Body, Definition, Rule, combined, contact_class, sum};
use crate::discrete::Discrete;
use crate::elimination::dot;
use crate::ensure;
use crate::naive::Line;
use crate::numbers::{Exact, Magnitude};
use crate::verdict::Verdict;

/// 2^-53
pub(super) const UNIT: f64 = f64::EPSILON / 2.0;

/// The roundings on the longest way to these numbers, for P2: an edge takes 1, the double area 4, a barycentric gradient 6,
/// the gradient of a shape function 9, lambda of plane stress 4, a point of a Gauss rule or its weight some 4.
pub(super) fn roundings(name: &str) -> f64 {
    f64::from(match name {
        "prescribed data" => 8,
        "u_n" => 3,
        "arc" => 5,
        // lambda + 2 mu, h_T, area.
        "C_h" | "kappa" | "limit" => 14,
        // Gradient, sigma_n of a shape function 11, gamma 2, sum over 12 products.
        "sigma_n(u)" | "sigma_n(u^h)" | "mean stress" => 36,
        "P(u)" | "gap" | "lambda^h" | "peak pressure" => 42,
        // Place 6, value 8, shape 8, weight 10, sum over 16 points of 8 triangles.
        "L(v)" | "L(u)" => 48,
        // Two gradients, the material, the area, sums.
        "a(., .)" | "A(., .)" | "a(u, v)" | "a(u, u)" | "A(u, v) - L(v)" => 64,
        // P, the integral over an edge, P0.
        _ => 96,
    })
}

/// The error of a double as a share of its bound; infinite where it is no number, or wrong where there is nothing to round.
pub(super) fn share(double: f64, exact: Exact, bound: f64) -> f64 {
    if !double.is_finite() {
        return f64::INFINITY;
    }
    let error = (Exact::of_double(double) - exact).abs().value().to_f64();
    match error {
        Some(0.0) => 0.0,
        Some(error) => error / bound,
        None => f64::INFINITY,
    }
}

/// The largest share of its bound that an error used up, by name.
pub(super) type Shares = RefCell<BTreeMap<&'static str, f64>>;

/// The whole comparison for one problem.
pub(super) fn compared<const N: usize>(
    draw: &Draw,
    mistake: Mistake,
    matrices: bool,
    shares: &Shares,
) -> Verdict {
    let problem = draw.problem();
    let discretized =
        Discretization::new(&problem, degree(N), |c| draw.kappa * c.limit(), draw.rule());
    let Ok(d) = discretized else { return Verdict::Fails("the problem is refused") };
    Exact::scope(|| {
        let settings =
            (Setting::<Exact>::new::<N>(draw, &d), Setting::<Magnitude>::new::<N>(draw, &d));
        let (Some(mut exact), Some(mut magnitude)) = settings else {
            return Verdict::Fails("nodes and contact edges are those of the mesh");
        };
        exact.plant(mistake, draw);
        magnitude.plant(mistake, draw);
        let nodes = d.space.nodes().len();
        ensure!(nodes == exact.body.node_count(N / 3));
        for (node, values) in d.constraints.values().iter().enumerate() {
            for c in 0..2 {
                ensure!(values[c].is_some() == exact.prescribed.contains_key(&(node, c)));
            }
        }
        let numbering = Numbering::new(&draw.order(nodes), d.constraints.values());
        ensure!(numbering.count == 2 * nodes - exact.prescribed.len());
        let order = if matrices { numbered(&numbering) } else { Vec::new() };
        let [u, step] = draw.fields(nodes);
        let doubles = assembled(&d, &u, matrices.then_some(&numbering));
        let exactly = defined::<_, N>(&exact, nodes, &read(&u), &order);
        let magnitudes = defined::<_, N>(&magnitude, nodes, &read(&u), &order);
        let near = all_near(&doubles, &exactly, &magnitudes, shares);
        if near.fails() {
            return near;
        }
        ensure!(contact_edges_follow_each_other(draw, &d));
        ensure!(limiting_edge_attains_the_constant::<N>(&d, &exact.body));
        ensure!(contact_length_is_the_measure_of_the_pressed_part::<N>(&d, &exact, &magnitude, &u));
        ensure!(residual_is_the_gradient_of_the_energy::<N>(&d, &exact, &magnitude, [&u, &step]));
        Verdict::Holds(contact_class::<N>(&exact.body, &read(&u)))
    })
}

/// The solver's loops over rationals, with the doubles of its discretization for data, are their definitions: A(u, v) - L(v), P(u) at
/// the ends of the contact edges, and where they need no root the left side of (8) and its derivative along a field. Nothing is
/// rounded: the normal is a unit vector of rational numbers, another one than the edge has, for none of the sums depends on that.
pub(super) fn loops<const N: usize>(draw: &Draw, mistake: Mistake) -> Verdict {
    // lambda of plane stress is a quotient that doubles round.
    if draw.stress && draw.tensor.is_none() {
        return Verdict::Vacuous;
    }
    let problem = draw.problem();
    let discretized =
        Discretization::new(&problem, degree(N), |c| draw.kappa * c.limit(), draw.rule());
    let Ok(d) = discretized else { return Verdict::Fails("the problem is refused") };
    let Some(mut setting) = Setting::<Exact>::new::<N>(draw, &d) else {
        return Verdict::Fails("nodes and contact edges are those of the mesh");
    };
    setting.plant(mistake, draw);
    let n = [Exact::ratio(5, 13), Exact::ratio(-12, 13)];
    setting.body.contact.iter_mut().for_each(|side| side.n = n);
    let edge = |edge: &Piece| {
        let diameter = d.problem.mesh.diameter(edge.edge().triangle);
        let gamma = Exact::of_double(d.gamma0) * Exact::of_double(diameter);
        residual::piece_with(&d, edge, |side, _| (Exact::of_double(side.length), n.into(), gamma))
    };
    let edges: Vec<Piece<Exact>> = d.contact.iter().map(edge).collect();
    let nodes = d.space.nodes().len();
    let [u, v] = draw.fields(nodes).map(|field| read::<Exact>(&field));
    let definition = Definition::<N>(&setting.body);
    // The gap of the solver is the double next to that of the definitions.
    for (edge, side) in edges.iter().zip(&setting.body.contact) {
        let p0 = definition.traces(side, &u).p0;
        let found = edge.p0(&u);
        ensure!([0, 1].iter().all(|&s| found[s as usize] == p0.at(Exact::from(s))));
    }
    for (edge, side) in edges.iter().zip(&mut setting.body.contact) {
        let gap = |a: usize| edge.geometry.nodes.get(a).map(|node| Exact::of_double(node.gap));
        let solvers = [0, 1, 2].map(|a| gap(a).unwrap_or(side.gap[a]));
        ensure!((0..3).all(|a| (solvers[a] - side.gap[a]).abs() <= Exact::of_double(1e-9)));
        side.gap = solvers;
    }
    let definition = Definition::<N>(&setting.body);
    let needs_roots = N == 6 && setting.points.is_none();
    let forces = residual::linear_residual(&d, &edges, &u);
    let discrete = Discrete::on(&d, edges);
    let forces = if needs_roots { forces } else { discrete.reactions(&u) };
    for (node, (found, load)) in forces.iter().zip(&d.load).enumerate() {
        for c in 0..2 {
            let bump = setting.body.bump(node, unit(c));
            let zero = Exact::from(0);
            let contact = if needs_roots { zero } else { setting.contact::<N>(&u, &bump) };
            let expected = definition.big_a(&u, &bump) + contact;
            ensure!(found[c] + Exact::of_double(load[c]) == expected);
        }
    }
    if !needs_roots {
        let tangent = discrete.tangent(&u);
        let free: Vec<Exact> = discrete.free(&v);
        let v = discrete.less(&vec![[Exact::from(0); 2]; nodes], &free);
        let rows = (0..nodes).flat_map(|node| [0, 1].map(|c| (node, c)));
        let rows = rows.filter(|key| !setting.prescribed.contains_key(key));
        for (i, (node, c)) in rows.enumerate() {
            let bump = setting.body.bump(node, unit(c));
            let slope = definition.slope(setting.rule(), &u, &v, &bump);
            ensure!(dot(&tangent[i], &free) == -(definition.big_a(&v, &bump) + slope));
            ensure!((0..i).all(|j| tangent[i][j] == tangent[j][i]));
        }
    }
    Verdict::Holds(contact_class::<N>(&setting.body, &u))
}

/// The degree of the element with so many nodes on a triangle.
fn degree(nodes: usize) -> Degree {
    if nodes == 3 { Degree::One } else { Degree::Two }
}

/// Every double is within its bound. All names and lengths are the same on the three sides.
pub(super) fn all_near(
    doubles: &[Named<f64>],
    exact: &[Named<Exact>],
    magnitudes: &[Named<Magnitude>],
    shares: &Shares,
) -> Verdict {
    ensure!(doubles.len() == exact.len());
    for (((name, doubles), (defined, exact)), (_, magnitudes)) in
        doubles.iter().zip(exact).zip(magnitudes)
    {
        ensure!(name == defined && doubles.len() == exact.len());
        for ((&double, &exact), magnitude) in doubles.iter().zip(exact).zip(magnitudes) {
            let share = share(double, exact, roundings(name) * UNIT * magnitude.sum());
            if !(share <= 1.0) {
                return Verdict::Fails(name);
            }
            let mut shares = shares.borrow_mut();
            let largest = shares.entry(name).or_insert(0.0);
            *largest = largest.max(share);
        }
    }
    Verdict::Holds("near")
}

/// On one side of the body, each contact edge starts where the one before it ends.
pub(super) fn contact_edges_follow_each_other(draw: &Draw, d: &Discretization<'_>) -> bool {
    let (_, triangles, sides) = draw.parts();
    let ends = |edge: BoundaryEdge| [1, 2].map(|k| triangles[edge.triangle][(edge.local + k) % 3]);
    let side = |edge: BoundaryEdge| {
        sides.values().position(|edges| edges.iter().any(|&e| owner(&triangles, e) == edge))
    };
    d.contact.windows(2).all(|pair| {
        let [a, b] = [pair[0].edge(), pair[1].edge()];
        side(a) != side(b) || ends(a)[1] == ends(b)[0]
    })
}

/// The edge that is said to limit gamma0 belongs to a triangle where the maximum C_h is attained, up to its bound.
pub(super) fn limiting_edge_attains_the_constant<const N: usize>(
    d: &Discretization<'_>,
    body: &Body,
) -> bool {
    let definition = Definition::<N>(body);
    let most = definition.coercivity();
    // Equal up to 1e-12, the first is named, and its ends are sorted.
    let least = most * (Exact::from(1) - Exact::of_double(2e-12));
    let edge = d.coercivity.limiting_edge.map(|x| x.map(Exact::of_double));
    body.contact.iter().any(|side| {
        let corners = body.triangles[side.triangle];
        let ends = [1, 2].map(|k| body.vertices[corners[(side.local + k) % 3]]);
        let turned = [ends[1], ends[0]];
        (ends == edge || turned == edge) && definition.coercivity_of(side.triangle) >= least
    })
}

/// The contact length is monotone in P, and P is known to some delta: it lies between the measures of {P > delta} and of
/// {P > -delta}. (It is no continuous function of P where P touches zero.)
pub(super) fn contact_length_is_the_measure_of_the_pressed_part<const N: usize>(
    d: &Discretization<'_>,
    exact: &Setting<Exact>,
    magnitude: &Setting<Magnitude>,
    u: &[[f64; 2]],
) -> bool {
    let (definition, sizes) =
        (Definition::<N>(&exact.body), Definition::<N, Magnitude>(&magnitude.body));
    let measure = |sign: f64| {
        sum(0..exact.body.contact.len(), |e| {
            let side = &exact.body.contact[e];
            let size = sizes.traces(&magnitude.body.contact[e], &read(u)).p.maximum().sum();
            let delta = Exact::of_double(sign * roundings("P(u)") * UNIT * size);
            let p = definition.traces(side, &read(u)).p.plus(&Line(vec![delta]));
            let zero = Exact::from(0);
            side.length
                * match exact.rule() {
                    Rule::Exact => sum(
                        p.pieces(),
                        |([start, end], positive)| {
                            if positive { end - start } else { zero }
                        },
                    ),
                    Rule::Points(points) => {
                        sum(points, |&[s, w]| if p.at(s) > zero { w } else { zero })
                    }
                }
        })
    };
    let lengths = sum(&exact.body.contact, |side| side.length);
    // Root, difference, product, sum.
    let slack = lengths * Exact::of_double(12.0 * UNIT);
    let length =
        Solution::new(d, Evaluated::new(d, u.to_vec()), unsolved()).quantities.contact_length;
    let length = Exact::of_double(length);
    measure(-1.0) - slack <= length && length <= measure(1.0) + slack
}

/// J_h(u + v) - J_h(u) - R(u; v) lies between 1/2 A(v, v) and 1/2 A(v, v) + 1/2 int P0(v)^2/gamma, up to the bounds of
/// the three: the residual is the derivative of the energy.
pub(super) fn residual_is_the_gradient_of_the_energy<const N: usize>(
    d: &Discretization<'_>,
    exact: &Setting<Exact>,
    magnitude: &Setting<Magnitude>,
    [u, step]: [&[[f64; 2]]; 2],
) -> bool {
    let nodes = u.len();
    let moved: Vec<[f64; 2]> =
        u.iter().zip(step).map(|(u, v)| [u[0] + v[0], u[1] + v[1]]).collect();
    // The sum is rounded; the step is what it came to.
    let one = Exact::from(1);
    let v = combined(one, &read(&moved), -one, &read(u));
    let size: Vec<[Magnitude; 2]> = read(step);
    let residual = d.residual(u).values;
    let along = sum(0..nodes, |k| {
        let [x, y] = residual[k].map(Exact::of_double);
        x * v[k][0] + y * v[k][1]
    });
    let above = Exact::of_double(d.energy(&moved)) - Exact::of_double(d.energy(u)) - along;
    let sizes = Definition::<N, Magnitude>(&magnitude.body);
    let load: Vec<Magnitude> = (0..2 * nodes).map(|k| magnitude.load::<N>(k / 2, k % 2)).collect();
    let energy = |u: &[[f64; 2]]| {
        let u = read(u);
        magnitude.energy::<N>(&u, inner(&load, &u))
    };
    let terms = energy(&moved)
        + energy(u)
        + sizes.big_a(&read(u), &size)
        + magnitude.contact::<N>(&read(u), &size)
        + inner(&load, &size);
    let slack = Exact::of_double(roundings("residual") * UNIT * terms.sum());
    let definition = Definition::<N>(&exact.body);
    let half = Exact::ratio(1, 2);
    let least = half * definition.big_a(&v, &v);
    let most = least + half * definition.squares(exact.rule(), &v);
    least - slack <= above && above <= most + slack
}
