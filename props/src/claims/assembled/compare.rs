//! The comparison with the loops of the solver, which are exact, and with its load, within the bound of its own roundings.

use num_traits::ToPrimitive;
use signorini::contact::{Discretization, Piece, residual};
use signorini::model::{Degree, Problem};

use super::definition::{Mistake, Setting, unit};
use super::draw::Draw;
use super::given::read;
use crate::bodies::{Definition, contact_class};
use crate::discrete::Discrete;
use crate::elimination::dot;
use crate::ensure;
use crate::naive::Hooke;
use crate::numbers::{Exact, Magnitude};
use crate::verdict::Verdict;

/// 2^-53
pub(crate) const UNIT: f64 = f64::EPSILON / 2.0;

/// The roundings on the longest way to these numbers, for P2: an edge takes 1, the double area 4, a barycentric gradient 6,
/// the gradient of a shape function 9, lambda of plane stress 4, a point of a Gauss rule or its weight some 4.
pub(crate) fn roundings(name: &str) -> f64 {
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
pub(crate) fn share(double: f64, exact: Exact, bound: f64) -> f64 {
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

/// The discretization that the solver makes of a drawn problem.
pub(crate) fn discretized<'a, const N: usize>(
    draw: &Draw,
    problem: &'a Problem,
) -> Option<Discretization<'a>> {
    let degree = if N == 3 { Degree::One } else { Degree::Two };
    Discretization::new(problem, degree, |c| draw.kappa * c.limit(), draw.rule()).ok()
}

/// The solver's loops over rationals, with the doubles of its discretization for data, are their definitions: A(u, v) - L(v), P0(u) at
/// the ends of the contact edges, and where they need no root the left side of (8) and its derivative along a field. Nothing is
/// rounded: the normal is a unit vector of rational numbers, another one than the edge has, for none of the sums depends on that.
pub(super) fn loops<const N: usize>(draw: &Draw, mistake: Mistake) -> Verdict {
    let problem = draw.problem();
    let Some(d) = discretized::<N>(draw, &problem) else {
        return Verdict::Fails("the problem is refused");
    };
    let Some(mut setting) = Setting::<Exact>::new::<N>(draw, &d) else {
        return Verdict::Fails("nodes and contact edges are those of the mesh");
    };
    // lambda of plane stress is a quotient that doubles round: it is the solver's.
    if let (true, Hooke::Isotropic { lambda, .. }) = (draw.stress, &mut setting.body.hooke) {
        *lambda = Exact::of_double(d.problem.material.of(0).lambda());
    }
    setting.plant(mistake);
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

/// L(v) of the solver is near its definition for every basis function v.
pub(super) fn loads<const N: usize>(draw: &Draw, mistake: Mistake) -> Verdict {
    let problem = draw.problem();
    let Some(d) = discretized::<N>(draw, &problem) else {
        return Verdict::Fails("the problem is refused");
    };
    let settings = (Setting::<Exact>::new::<N>(draw, &d), Setting::<Magnitude>::new::<N>(draw, &d));
    let (Some(mut exact), Some(magnitude)) = settings else {
        return Verdict::Fails("nodes and contact edges are those of the mesh");
    };
    exact.plant(mistake);
    for (node, load) in d.load.iter().enumerate() {
        for c in 0..2 {
            let bound = roundings("L(v)") * UNIT * magnitude.load::<N>(node, c).sum();
            ensure!(share(load[c], exact.load::<N>(node, c), bound) <= 1.0);
        }
    }
    Verdict::Holds("near")
}
