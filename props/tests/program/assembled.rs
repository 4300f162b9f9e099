//! The numbers of the discretization that `signorini solve` builds, its matrix, its load, its residual and what it reports, near the
//! definitions of method (8) over rationals, on the random problems of `props::claims::assembled`.
//!
//! Every double of the data is a rational number; the definitions (`naive`, `Definition`) are evaluated on these numbers without
//! error, and each number of the solver must be as near to its definition as its own roundings allow: |double - exact| <=
//! c 2^-53 m. Here m is the sum of the magnitudes of the terms of the definition (`Magnitude`: the definition once more, with
//! differences that add), and c is the number of roundings on the longest way from the data to the number, counted by hand for P2
//! and listed in `roundings`. This is the usual bound to first order, with the terms of the definition in the place of the
//! solver's, which are about as large. A bound that no draw comes near to is no test: the largest ratios of error and bound are
//! reported, and those of `BOUNDS` must exceed `SHARP`.
//!
//! Square roots are given data: the solver's h_T, |E| and n are first compared with the exact squares and normals, then both
//! sides use them.

use std::cell::RefCell;
use std::collections::BTreeMap;

use signorini::contact::Discretization;
use signorini::kernel::Triangle;
use signorini::linear::matrix;
use signorini::linear::matrix::{LowerTriangle, Neighbours, Numbering};
use signorini::model::{BoundaryEdge, Mesh};
use signorini::nalgebra::Vector2;
use study::unsolved;

use props::bodies::{Body, Definition, Rule, Side, combined, contact_class, sum};
use props::claim::Outcome;
use props::claims::assembled::compare::{UNIT, discretized, roundings, share};
use props::claims::assembled::definition::{Mistake, Setting, unit};
use props::claims::assembled::draw::{Contact, Draw, owner, problems};
use props::claims::assembled::given::{Given, read};
use props::claims::assembled::roots::{close, longest};
use props::claims::assembled::{Kind, P1_KINDS, P2_KINDS};
use props::naive::{Hooke, Line};
use props::numbers::{Exact, Magnitude};
use props::verdict::{Ordered, Verdict};
use props::{draws, ensure};

/// A planted mistake, in the definitions.
#[derive(Clone, Copy, Debug)]
enum Planted {
    In(Mistake),
    ShortestEdgeForDiameter,
    DiameterOfAnotherTriangle,
    ContactEdgeForgotten,
    PlaneStrainForStress,
    ReactionWithTheWrongSign,
}

const NONE: Planted = Planted::In(Mistake::None);

fn plant<S: Given>(planted: Planted, setting: &mut Setting<S>, draw: &Draw) {
    let body = &mut setting.body;
    let length = |body: &Body<S>, t: usize, i: usize| {
        let corners = body.triangles[t];
        let [a, b] = [1, 2].map(|k| draw.parts().0[corners[(i + k) % 3]]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    match planted {
        Planted::In(mistake) => setting.plant(mistake),
        Planted::ShortestEdgeForDiameter => {
            for t in 0..body.triangles.len() {
                let lengths = [0, 1, 2].map(|i| length(body, t, i));
                body.diameters[t] = S::given(lengths.into_iter().fold(f64::MAX, f64::min));
            }
        }
        Planted::DiameterOfAnotherTriangle => body.diameters.rotate_left(1),
        Planted::ContactEdgeForgotten => {
            let owners: Vec<usize> = body.contact.iter().map(|side| side.triangle).collect();
            let twice = |t: usize| owners.iter().filter(|&&o| o == t).count() == 2;
            if let Some(at) = owners.iter().position(|&t| twice(t)) {
                body.contact[at].length = S::from(0);
            }
        }
        Planted::PlaneStrainForStress => {
            if draw.tensor.is_none() {
                let (lambda, mu) = (S::given(draw.lambda), S::given(draw.mu));
                body.hooke = Hooke::Isotropic { lambda, mu };
            }
        }
        Planted::ReactionWithTheWrongSign => {}
    }
}

/// A list of numbers under one name.
type Named<S> = (&'static str, Vec<S>);

/// A functional, given at the basis functions, at v.
fn inner<S: Ordered>(functional: &[S], v: &[[S; 2]]) -> S {
    sum(functional.iter().zip(v.as_flattened()), |(&f, &v)| f * v)
}

/// The largest value on \[0, 1\] of a polynomial of degree <= 2.
fn maximum<S: Ordered>(line: &Line<S>) -> S {
    let ends = [S::from(0), S::from(1)].into_iter();
    let values = ends.chain(line.turn()).map(|s| line.at(s));
    values.reduce(|a, b| if b > a { b } else { a }).unwrap_or(line.0[0])
}

/// J_h(u), given L(u)
fn energy<S: Given, const N: usize>(setting: &Setting<S>, u: &[[S; 2]], work: S) -> S {
    let definition = Definition::<N, S>(&setting.body);
    let positive = definition.contact(setting.rule(), u, |side| definition.traces(side, u).p);
    (definition.big_a(u, u) + positive) / S::from(2) - work
}

/// Every number by its definition, at u; with the matrices if asked for (in the given order of the free degrees of freedom).
fn defined<S: Given, const N: usize>(
    setting: &Setting<S>,
    nodes: usize,
    u: &[[S; 2]],
    order: &[(usize, usize)],
    reaction_sign: i32,
) -> Vec<Named<S>> {
    let body = &setting.body;
    let definition = Definition::<N, S>(body);
    let dofs: Vec<(usize, usize)> = (0..nodes).flat_map(|node| [(node, 0), (node, 1)]).collect();
    let each = |f: &dyn Fn(usize, usize) -> S| dofs.iter().map(|&(k, c)| f(k, c)).collect();
    let load: Vec<S> = each(&|k, c| setting.load::<N>(k, c));
    let bump = |(k, c): (usize, usize)| body.bump(k, unit(c));
    let internal: Vec<S> = each(&|k, c| definition.a(u, &bump((k, c))));
    let stress: Vec<S> = each(&|k, c| definition.stress_product(u, &bump((k, c))));
    let big: Vec<S> = internal.iter().zip(&stress).map(|(&a, &s)| a - s).collect();
    let contact: Vec<S> = each(&|k, c| setting.contact::<N>(u, &bump((k, c))));
    let linear: Vec<S> = big.iter().zip(&load).map(|(&a, &l)| a - l).collect();
    let residual: Vec<S> = linear.iter().zip(&contact).map(|(&a, &p)| a + p).collect();
    let work = inner(&load, u);
    let half = S::from(1) / S::from(2);
    let traces: Vec<_> = body.contact.iter().map(|side| definition.traces(side, u)).collect();
    let (zero, one) = (S::from(0), S::from(1));
    let along = if N == 3 { vec![zero, one] } else { vec![zero, half, one] };
    let on_edges = |f: &dyn Fn(usize, S) -> S| -> Vec<S> {
        (0..traces.len()).flat_map(|e| along.iter().map(move |&s| f(e, s))).collect()
    };
    let positive_part = |p: S| if p > zero { p } else { zero };
    let pressure = |e: usize, p: S| positive_part(p) / body.gamma(&body.contact[e]);
    let forces: Vec<S> = body
        .contact
        .iter()
        .map(|side| definition.contact_on(setting.rule(), side, u, &Line(vec![one])))
        .collect();
    let along_normals =
        [0, 1].map(|c| -sum(forces.iter().zip(&body.contact), |(&force, side)| force * side.n[c]));
    let peaks = traces.iter().enumerate().map(|(e, traces)| pressure(e, maximum(&traces.p)));
    let peak = peaks.fold(zero, |most, p| if p > most { p } else { most });
    let mut reactions: BTreeMap<&str, [S; 2]> = BTreeMap::new();
    for (&(node, c), (_, name)) in &setting.prescribed {
        let reaction = reactions.entry(name).or_insert([zero; 2]);
        reaction[c] += S::from(reaction_sign) * residual[2 * node + c];
    }
    let mean = |t: usize| {
        let field = body.field::<N>(t, u);
        let at = [0, 1, 2].map(|k| body.hooke.stress(field.strain(k)));
        [0, 1, 2].map(|c| (at[0][c] + at[1][c] + at[2][c]) / S::from(3))
    };
    let prescribed = |k, c| setting.prescribed.get(&(k, c)).map_or(zero, |&(value, _)| value);
    let constant = definition.coercivity();
    let mut all = vec![
        ("prescribed data", each(&prescribed)),
        ("C_h", vec![constant]),
        ("kappa", vec![body.gamma0 * constant]),
        ("limit", vec![one / constant]),
        (
            "sigma_n(u)",
            traces.iter().flat_map(|t| [t.sigma_n.at(zero), t.sigma_n.at(one)]).collect(),
        ),
        ("P(u)", on_edges(&|e, s| traces[e].p.at(s))),
        ("u_n", on_edges(&|e, s| traces[e].v_n.at(s))),
        ("gap", on_edges(&|e, s| traces[e].p0.minus(&traces[e].p).at(s))),
        ("sigma_n(u^h)", on_edges(&|e, s| traces[e].sigma_n.at(s))),
        (
            "arc",
            on_edges(&|e, s| {
                // From zero on each boundary: where a side does not start where the one before it ends.
                let corner =
                    |side: &Side<S>, k| body.triangles[side.triangle][(side.local + k) % 3];
                let joined =
                    |i: usize| corner(&body.contact[i], 2) == corner(&body.contact[i + 1], 1);
                let first = (0..e).rev().find(|&i| !joined(i));
                let before = &body.contact[first.map_or(0, |i| i + 1)..e];
                sum(before, |side| side.length) + s * body.contact[e].length
            }),
        ),
        ("lambda^h", on_edges(&|e, s| -pressure(e, traces[e].p.at(s)))),
        ("peak pressure", vec![peak]),
        ("contact force", vec![sum(&forces, |&force| force)]),
        ("contact resultant", along_normals.to_vec()),
        ("mean stress", (0..body.triangles.len()).flat_map(mean).collect()),
        ("a(u, v)", internal),
        ("a(u, u)", vec![definition.a(u, u)]),
        ("L(v)", load),
        ("L(u)", vec![work]),
        ("A(u, v) - L(v)", linear),
        ("residual", residual),
        ("J_h", vec![energy::<S, N>(setting, u, work)]),
        ("reactions", reactions.into_values().flatten().collect()),
    ];
    // The entries of a symmetric matrix, now in this order, now in that.
    let bumps: Vec<_> = order.iter().map(|&dof| bump(dof)).collect();
    let pairs = (0..bumps.len()).flat_map(|j| (j..bumps.len()).map(move |i| (i, j)));
    let ordered = pairs.map(|(i, j)| if (i + j) % 2 == 0 { (i, j) } else { (j, i) });
    let entries: Vec<[S; 2]> = ordered
        .map(|(i, j)| {
            let a = definition.a(&bumps[i], &bumps[j]);
            [a, a - definition.stress_product(&bumps[i], &bumps[j])]
        })
        .collect();
    all.push(("a(., .)", entries.iter().map(|entry| entry[0]).collect()));
    all.push(("A(., .)", entries.iter().map(|entry| entry[1]).collect()));
    all
}

/// The same numbers by the solver, in the same order.
fn assembled(
    d: &Discretization<'_>,
    u: &[[f64; 2]],
    numbering: Option<&Numbering>,
) -> Vec<Named<f64>> {
    let flat = |field: &[[f64; 2]]| field.as_flattened().to_vec();
    let solution = unsolved(d, u.to_vec());
    let q = &solution.quantities;
    // In order along the edge.
    let sorted =
        |p: Vec<f64>| [0, 2, 1].into_iter().filter_map(|a| p.get(a).copied()).collect::<Vec<_>>();
    let line = || d.contact.iter();
    let points = || solution.contact.iter().flat_map(|edge| &edge.points);
    let mut all = vec![
        ("prescribed data", flat(&d.constraints.lift())),
        ("C_h", vec![d.coercivity.constant]),
        ("kappa", vec![d.kappa()]),
        ("limit", vec![d.coercivity.limit()]),
        ("sigma_n(u)", line().flat_map(|e| e.sigma_n(u)).collect()),
        ("P(u)", line().flat_map(|e| sorted(e.p(u))).collect()),
        ("u_n", points().map(|point| point.u_n).collect()),
        ("gap", points().map(|point| point.gap).collect()),
        ("sigma_n(u^h)", points().map(|point| point.sigma_n).collect()),
        ("arc", points().map(|point| point.arc).collect()),
        ("lambda^h", points().map(|point| point.lambda).collect()),
        ("peak pressure", vec![q.peak_pressure]),
        ("contact force", vec![q.contact_force]),
        ("contact resultant", q.contact_resultant.to_vec()),
        ("mean stress", solution.stress.iter().flat_map(|(s, _)| s.components()).collect()),
        ("a(u, v)", flat(&d.internal_forces(u).values)),
        ("a(u, u)", vec![q.energy]),
        ("L(v)", flat(&d.load)),
        ("L(u)", vec![q.work]),
        ("A(u, v) - L(v)", flat(&d.linear_residual(u).values)),
        ("residual", flat(&d.residual(u).values)),
        ("J_h", vec![d.energy(u)]),
        ("reactions", q.reactions.values().flatten().copied().collect()),
    ];
    let matrices = numbering.map(|numbering| {
        let neighbours = Neighbours::new(&d.space);
        let assembled = [
            matrix::assemble_stiffness(d, numbering, &neighbours),
            matrix::assemble(d, numbering, &neighbours),
        ];
        // A matrix that is not assembled is not what it should be.
        assembled.map(|matrix| matrix.map_or(Vec::new(), |m| entries(&m, numbering.count)))
    });
    let [stiffness, matrix] = matrices.unwrap_or_default();
    all.extend([("a(., .)", stiffness), ("A(., .)", matrix)]);
    all
}

/// All entries of the lower triangle, column by column, zeros included; NaN if its rows are not in increasing order from
/// the diagonal on.
fn entries(matrix: &LowerTriangle, count: usize) -> Vec<f64> {
    let mut all = Vec::new();
    for column in 0..count {
        let range = matrix.starts[column]..matrix.starts[column + 1];
        let rows = &matrix.rows[range.clone()];
        let mut values = vec![0.0; count - column];
        for (row, value) in rows.iter().zip(&matrix.values[range]) {
            values[row - column] = *value;
        }
        if rows.first() != Some(&column) || rows.windows(2).any(|w| w[0] >= w[1]) {
            values.fill(f64::NAN);
        }
        all.extend(values);
    }
    all
}

/// The free degrees of freedom in the order of their numbers.
fn numbered(numbering: &Numbering) -> Vec<(usize, usize)> {
    let mut order = vec![(0, 0); numbering.count];
    for (node, numbers) in numbering.of.iter().enumerate() {
        for (c, number) in numbers.iter().enumerate() {
            if let Some(number) = number {
                order[*number] = (node, c);
            }
        }
    }
    order
}

/// The largest share of its bound that an error used up, by name.
type Shares = RefCell<BTreeMap<&'static str, f64>>;

/// The whole comparison for one problem.
fn compared<const N: usize>(
    draw: &Draw,
    planted: Planted,
    matrices: bool,
    shares: &Shares,
) -> Verdict {
    let problem = draw.problem();
    let Some(d) = discretized::<N>(draw, &problem) else {
        return Verdict::Fails("the problem is refused");
    };
    Exact::scope(|| {
        let settings =
            (Setting::<Exact>::new::<N>(draw, &d), Setting::<Magnitude>::new::<N>(draw, &d));
        let (Some(mut exact), Some(mut magnitude)) = settings else {
            return Verdict::Fails("nodes and contact edges are those of the mesh");
        };
        plant(planted, &mut exact, draw);
        plant(planted, &mut magnitude, draw);
        let nodes = d.space.nodes().len();
        ensure!(nodes == exact.body.node_count(N / 3));
        for (node, values) in d.constraints.values().iter().enumerate() {
            for c in 0..2 {
                ensure!(values[c].is_some() == exact.prescribed.contains_key(&(node, c)));
            }
        }
        let numbering = Numbering::under(&draw.order(nodes), &d.constraints);
        ensure!(numbering.count == 2 * nodes - exact.prescribed.len());
        let order = if matrices { numbered(&numbering) } else { Vec::new() };
        let [u, step] = draw.fields(nodes);
        let doubles = assembled(&d, &u, matrices.then_some(&numbering));
        let sign = if let Planted::ReactionWithTheWrongSign = planted { -1 } else { 1 };
        let exactly = defined::<_, N>(&exact, nodes, &read(&u), &order, sign);
        let magnitudes = defined::<_, N>(&magnitude, nodes, &read(&u), &order, sign);
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

/// Every double is within its bound. All names and lengths are the same on the three sides.
fn all_near(
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
fn contact_edges_follow_each_other(draw: &Draw, d: &Discretization<'_>) -> bool {
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
fn limiting_edge_attains_the_constant<const N: usize>(d: &Discretization<'_>, body: &Body) -> bool {
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
fn contact_length_is_the_measure_of_the_pressed_part<const N: usize>(
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
            let size = maximum(&sizes.traces(&magnitude.body.contact[e], &read(u)).p).sum();
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
    let length = unsolved(d, u.to_vec()).quantities.contact_length;
    let length = Exact::of_double(length);
    measure(-1.0) - slack <= length && length <= measure(1.0) + slack
}

/// J_h(u + v) - J_h(u) - R(u; v) lies between 1/2 A(v, v) and 1/2 A(v, v) + 1/2 int P0(v)^2/gamma, up to the bounds of
/// the three: the residual is the derivative of the energy.
fn residual_is_the_gradient_of_the_energy<const N: usize>(
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
    let of = |u: &[[f64; 2]]| {
        let u = read(u);
        energy::<Magnitude, N>(magnitude, &u, inner(&load, &u))
    };
    let terms = of(&moved)
        + of(u)
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

/// Some number under each of these names must use up this share of its bound. (One number that is a sum of many terms of
/// either sign, such as J_h, is better than its bound by chance.)
const SHARP: f64 = 1.0 / 1000.0;
const BOUNDS: [&str; 5] = ["A(., .)", "A(u, v) - L(v)", "L(v)", "P(u)", "residual"];

fn all_of<const N: usize>(kinds: &[Kind]) -> Outcome {
    let shares = Shares::default();
    let mut found = Vec::new();
    for &(contact, two_sides, cases, class) in kinds {
        let problems = problems(contact, two_sides);
        found.push(draws::hold(cases, problems, class.as_slice(), |draw| {
            // The matrices do not know of the contact.
            compared::<N>(draw, NONE, class.is_none(), &shares)
        })?);
    }
    let shares = shares.into_inner();
    let listed: Vec<String> = shares.iter().map(|(name, s)| format!("{name} {s:.4}")).collect();
    let found = format!("{}; error/bound at most: {}", found.join("; "), listed.join(", "));
    match BOUNDS.iter().find(|name| shares[*name] < SHARP) {
        None => Ok(found),
        Some(name) => Err(format!("no draw comes near to the bound of {name}: {found}")),
    }
}

fn rejected(mistakes: &[Planted]) -> Outcome {
    let one = |&planted: &Planted| {
        let said = draws::reject(problems(Contact::Any, true), |draw| {
            compared::<3>(draw, planted, false, &Shares::default())
        })?;
        Ok(format!("{planted:?} {said}"))
    };
    mistakes.iter().map(one).collect::<Result<Vec<String>, String>>().map(|all| all.join("; "))
}

/// The square roots of one mesh: h_T is the longest edge, |E| and n are those of the edge. `diameter` is h_T, or a planted
/// mistake.
fn geometry(draw: &Draw, diameter: impl Fn(&Mesh, usize) -> f64) -> Verdict {
    let problem = draw.problem();
    let mesh = &problem.mesh;
    let (vertices, triangles, sides) = draw.parts();
    Exact::scope(|| {
        let exact = |t: usize| Triangle {
            vertices: triangles[t].map(|v| Vector2::from(vertices[v]).map(Exact::of_double)),
        };
        for t in 0..triangles.len() {
            let squares = [0, 1, 2].map(|i| {
                let [x, y] = exact(t).edge(i).into();
                x * x + y * y
            });
            ensure!(close(diameter(mesh, t), longest(squares)));
        }
        for edge in sides.into_values().flatten().map(|edge| owner(&triangles, edge)) {
            let [x, y] = exact(edge.triangle).scaled_normal(edge.local).into();
            let (length, n) = mesh.length_and_normal(edge);
            ensure!(close(length, x * x + y * y));
            for (c, exact) in [x, y].into_iter().enumerate() {
                // A difference and a quotient.
                let scaled = Exact::of_double(n[c]) * Exact::of_double(length);
                ensure!((scaled - exact).abs() <= exact.abs() * Exact::of_double(3.0 * UNIT));
            }
        }
        Verdict::Holds("always")
    })
}

checks! {
    diameters_lengths_and_normals_of_the_solver_are_those_of_the_edges => draws::hold(60, problems(Contact::Any, false), &["always"], |draw| {
        geometry(draw, |mesh, t| mesh.diameter(t))
    });
    control_an_edge_of_the_solver_for_the_longest => draws::reject(problems(Contact::Any, false), |draw| {
        geometry(draw, |mesh, t| {
            let [x, y]: [f64; 2] = mesh.triangle(t).edge(0).into();
            x.hypot(y)
        })
    });
    every_number_of_the_solver_is_near_its_definition_for_p1 => all_of::<3>(&P1_KINDS);
    every_number_of_the_solver_is_near_its_definition_for_p2 => all_of::<6>(&P2_KINDS);
    control_the_diameter_of_the_solver_taken_wrong => rejected(&[
        Planted::In(Mistake::EdgeLengthForDiameter),
        Planted::ShortestEdgeForDiameter,
        Planted::DiameterOfAnotherTriangle,
    ]);
    control_gamma_edges_or_material_of_the_solver_taken_wrong => rejected(&[
        Planted::In(Mistake::GammaInverted),
        Planted::ContactEdgeForgotten,
        Planted::PlaneStrainForStress,
    ]);
    control_theta_or_the_gap_of_the_solver_taken_wrong => rejected(&[
        Planted::In(Mistake::Theta(-1)),
        Planted::In(Mistake::Theta(0)),
        Planted::In(Mistake::GapWithTheWrongSign),
    ]);
    control_loads_or_reactions_of_the_solver_taken_wrong => rejected(&[
        Planted::In(Mistake::TractionOnAnotherSide),
        Planted::In(Mistake::LoadWithTheWrongSign),
        Planted::ReactionWithTheWrongSign,
    ]);
}
