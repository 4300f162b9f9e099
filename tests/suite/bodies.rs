//! Families of bodies at random, each against an independent answer: the same method assembled and solved a second time in
//! double-double arithmetic (`assembled`), equilibrium of all forces, and beam theory. And families of problems that
//! are none, each refused with its reason.
//!
//! A number in the environment variable SIGNORINI_BODIES sets how many bodies of each kind are drawn (the default keeps
//! `cargo test` short); SIGNORINI_BODIES_FROM sets the first seed. A failure prints its seed, so that
//! `SIGNORINI_BODIES=1 SIGNORINI_BODIES_FROM=seed` draws that body alone.

use std::collections::BTreeMap;

use signorini::fem::{Condition, DataError, Materials, Mesh, MeshError, Problem};
use signorini::kernel::{Material, Plane};
use signorini::solve::{
    ContactQuadrature, Degree, Gamma0, Method, Settings, SolveError, Unproved, solve,
};

use crate::assembled::{Assembled, Circle};
use crate::common::{clamped, constant, function};

fn number_from(variable: &str, default: u64) -> u64 {
    std::env::var(variable).ok().map_or(default, |text| text.parse().unwrap())
}

/// The seeds to draw.
fn seeds(default: u64) -> std::ops::Range<u64> {
    let from = number_from("SIGNORINI_BODIES_FROM", 1);
    from..from + number_from("SIGNORINI_BODIES", default)
}

/// Draws that depend on the seed alone (splitmix64).
struct Dice(u64);

impl Dice {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// 10^x with x between `low` and `high`.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10.0_f64.powf(self.between(low, high))
    }

    fn whole(&mut self, low: usize, high: usize) -> usize {
        low + (self.unit() * (high - low + 1) as f64) as usize
    }

    fn one_in(&mut self, n: usize) -> bool {
        self.whole(1, n) == 1
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.whole(0, of.len() - 1)]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Cut {
    Left,
    Right,
    Crossed,
}

/// Cells of a grid, cut into triangles; corner (i, j) lies at `place`. The boundary has the names of the sides of the grid
/// where the cells of its outermost rows and columns end.
struct Grid<'a> {
    cells: [usize; 2],
    cut: Cut,
    solid: &'a dyn Fn(usize, usize) -> bool,
    place: &'a dyn Fn([f64; 2]) -> [f64; 2],
}

type Pieces = (Vec<[f64; 2]>, Vec<[usize; 3]>, BTreeMap<String, Vec<[usize; 2]>>);

impl Grid<'_> {
    fn pieces(&self) -> Pieces {
        let [nx, ny] = self.cells;
        let mut number: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut vertices = Vec::new();
        let mut at = |i2: usize, j2: usize| {
            *number.entry([i2, j2]).or_insert_with(|| {
                vertices.push((self.place)([i2 as f64 / 2.0, j2 as f64 / 2.0]));
                vertices.len() - 1
            })
        };
        let mut triangles = Vec::new();
        let mut sides: BTreeMap<String, Vec<[usize; 2]>> = BTreeMap::new();
        for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
            if !(self.solid)(i, j) {
                continue;
            }
            let [a, b] = [at(2 * i, 2 * j), at(2 * i + 2, 2 * j)];
            let [c, d] = [at(2 * i + 2, 2 * j + 2), at(2 * i, 2 * j + 2)];
            match self.cut {
                Cut::Right => triangles.extend([[a, b, c], [a, c, d]]),
                Cut::Left => triangles.extend([[a, b, d], [b, c, d]]),
                Cut::Crossed => {
                    let m = at(2 * i + 1, 2 * j + 1);
                    triangles.extend([[a, b, m], [b, c, m], [c, d, m], [d, a, m]]);
                }
            }
            for (outer, name, edge) in [
                (j == 0, "bottom", [a, b]),
                (j == ny - 1, "top", [c, d]),
                (i == 0, "left", [d, a]),
                (i == nx - 1, "right", [b, c]),
            ] {
                if outer {
                    sides.entry(name.to_owned()).or_default().push(edge);
                }
            }
        }
        (vertices, triangles, sides)
    }

    fn mesh(&self) -> Result<Mesh, MeshError> {
        let (vertices, triangles, sides) = self.pieces();
        Mesh::new(vertices, triangles, sides)
    }
}

fn everywhere(_: usize, _: usize) -> bool {
    true
}

/// A well-posed problem, and what the independent answers need to know of it.
struct Body {
    kind: &'static str,
    said: String,
    problem: Problem,
    method: Method,
    gamma0: f64,
    force: [f64; 2],
    /// What its contact line lies on, if it is no straight line.
    circle: Option<Circle>,
}

impl Body {
    /// The independent solver of it.
    fn again(&self) -> Assembled {
        Assembled::new(&self.problem, self.method.degree, self.gamma0, self.force, self.circle)
    }
}

/// What all kinds of bodies have in common: element, material, units, gamma0.
struct Choice {
    degree: Degree,
    cut: Cut,
    material: Material<f64>,
    share: f64,
    /// Lengths and moduli in units of these.
    length: f64,
    modulus: f64,
    offset: f64,
    said: String,
}

impl Choice {
    fn new(dice: &mut Dice) -> Self {
        let degree = dice.pick(&[Degree::One, Degree::Two]);
        let cut = dice.pick(&[Cut::Left, Cut::Right, Cut::Crossed]);
        let plane = dice.pick(&[Plane::Strain, Plane::Strain, Plane::Stress]);
        let poisson =
            if dice.one_in(3) { 0.5 - dice.decades(-7.0, -1.0) } else { dice.between(-0.3, 0.45) };
        let share =
            if dice.one_in(3) { dice.decades(-8.0, -0.3) } else { dice.between(0.05, 0.95) };
        let length = if dice.one_in(4) { dice.decades(-30.0, 30.0) } else { 1.0 };
        let modulus = if length == 1.0 && dice.one_in(3) { dice.decades(-30.0, 30.0) } else { 1.0 };
        let offset = if dice.one_in(4) { dice.decades(0.0, 8.0) } else { 0.0 };
        let material = Material::young_poisson(modulus, poisson, plane);
        let said = format!(
            "{degree:?} {cut:?} {plane:?} nu = {poisson}, gamma0 = {share:e} of the limit, length {length:e}, modulus {modulus:e}, offset {offset:e}"
        );
        Choice { degree, cut, material, share, length, modulus, offset, said }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x + self.offset) * self.length, (y - self.offset) * self.length]
    }

    /// A grid of cells, of which corner (i, j) lies where `shape` moves the point (i / nx, j / ny) of the unit square, if its
    /// triangles are any.
    fn grid(
        &self,
        cells: [usize; 2],
        solid: &dyn Fn(usize, usize) -> bool,
        shape: &dyn Fn([f64; 2]) -> [f64; 2],
    ) -> Option<Mesh> {
        let [nx, ny] = cells.map(|n| n as f64);
        let place = |[i, j]: [f64; 2]| self.place(shape([i / nx, j / ny]));
        Grid { cells, cut: self.cut, solid, place: &place }.mesh().ok()
    }

    /// A block of length 1. At a large offset a flat one may have no triangles left.
    fn block(&self, cells: [usize; 2], height: f64) -> Option<Mesh> {
        self.grid(cells, &everywhere, &|[x, y]| [x, height * y])
    }

    /// The body with a force in units of modulus / length, and the boundaries that hold.
    fn body(
        &self,
        kind: &'static str,
        said: &str,
        mesh: Mesh,
        force: [f64; 2],
        conditions: Vec<(&str, Condition)>,
    ) -> Body {
        self.body_of(self.material.into(), kind, said, mesh, force, conditions)
    }

    /// The same, of these materials.
    fn body_of(
        &self,
        materials: Materials,
        kind: &'static str,
        said: &str,
        mesh: Mesh,
        force: [f64; 2],
        conditions: Vec<(&str, Condition)>,
    ) -> Body {
        let force = force.map(|f| f * self.modulus / self.length);
        let conditions: BTreeMap<String, Condition> =
            conditions.into_iter().map(|(name, c)| (name.to_owned(), c)).collect();
        let gamma0 = self.share * limit(&mesh, &materials, self.degree, &conditions);
        let load = force.map(constant);
        let problem = Problem::new(mesh, materials, load, conditions);
        let method = Method {
            degree: self.degree,
            gamma0: Gamma0::Value(gamma0),
            quadrature: ContactQuadrature::Exact,
            ..Method::default()
        };
        let said = format!("{said}; {}", self.said);
        Body { kind, said, problem, method, gamma0, force, circle: None }
    }

    /// Contact with a floor at a gap that is affine along x, in units of the length.
    fn floor(&self, gap: f64, slope: f64) -> Condition {
        let (length, offset) = (self.length, self.offset);
        Condition::Contact {
            gap: function(move |[x, _]| length * (gap + slope * (x / length - offset))),
        }
    }
}

/// The gamma0 at which kappa = 1, from the definition.
fn limit(
    mesh: &Mesh,
    materials: &Materials,
    degree: Degree,
    conditions: &BTreeMap<String, Condition>,
) -> f64 {
    let mut lengths: BTreeMap<usize, f64> = BTreeMap::new();
    for (name, condition) in conditions {
        if matches!(condition, Condition::Contact { .. }) {
            for &edge in mesh.edges_of(name).unwrap() {
                let [a, b] = mesh.ends(edge).map(|v| mesh.vertices()[v]);
                *lengths.entry(edge.triangle).or_default() += (a[0] - b[0]).hypot(a[1] - b[1]);
            }
        }
    }
    let p = if degree == Degree::One { 1.0 } else { 3.0 };
    let worst = lengths.iter().fold(0.0, |worst: f64, (&t, length)| {
        let [a, b, c] = mesh.triangles()[t].map(|v| mesh.vertices()[v]);
        let area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0;
        let side = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        let h = side(a, b).max(side(b, c)).max(side(c, a));
        let material = materials.of(t);
        worst.max((material.lambda() + 2.0 * material.mu()) * (h / area * length))
    });
    1.0 / (p * worst)
}

fn slides(c: usize) -> Condition {
    let held = |k| (k == c).then(|| constant(0.0));
    Condition::Displacement([held(0), held(1)])
}

/// Beams and strips: 1 x 1/s, held at one end or both, over a floor or lying on it.
fn beam(dice: &mut Dice) -> Body {
    let choice = Choice::new(dice);
    let slenderness = dice.decades(0.0, 4.0);
    let cells = [dice.whole(4, 40), dice.whole(1, 3)];
    let height = 1.0 / slenderness;
    let Some(mesh) = choice.block(cells, height) else { return beam(dice) };
    let gap = if dice.one_in(3) { 0.0 } else { height * dice.decades(-3.0, 1.0) };
    // A force whose free deflection is so many gaps (heights, on the floor).
    let reach = dice.decades(-1.0, 1.5) * if gap > 0.0 { gap } else { height };
    let force = reach * height * height / 1.5;
    let slope = if dice.one_in(3) { gap * dice.between(-0.5, 0.5) } else { 0.0 };
    let mut conditions = vec![("left", clamped()), ("bottom", choice.floor(gap, slope))];
    match dice.whole(0, 2) {
        0 => conditions.push(("right", clamped())),
        1 => conditions.push(("right", slides(0))),
        _ => {}
    }
    let said = format!("1 x 1/{slenderness:.1}, {cells:?} cells, gap {gap:e}, slope {slope:e}");
    choice.body("beam", &said, mesh, [0.0, -force], conditions)
}

/// Sheets with holes, of which what hangs on the clamped top by edges is left.
fn sheet(dice: &mut Dice) -> Body {
    let choice = Choice::new(dice);
    let cells = [dice.whole(4, 10), dice.whole(3, 8)];
    let share = dice.between(0.6, 0.95);
    let solid: Vec<bool> = (0..cells[0] * cells[1]).map(|_| dice.unit() < share).collect();
    let mut kept = vec![false; solid.len()];
    let mut waiting: Vec<[usize; 2]> = (0..cells[0]).map(|i| [i, cells[1] - 1]).collect();
    while let Some([i, j]) = waiting.pop() {
        let at = j * cells[0] + i;
        if i < cells[0] && j < cells[1] && solid[at] && !std::mem::replace(&mut kept[at], true) {
            let (left, down) = (i.wrapping_sub(1), j.wrapping_sub(1));
            waiting.extend([[left, j], [i + 1, j], [i, down], [i, j + 1]]);
            waiting.retain(|&[i, j]| i < cells[0] && j < cells[1]);
        }
    }
    if !(0..cells[0]).any(|i| kept[i]) {
        return sheet(dice);
    }
    let is_solid = |i: usize, j: usize| kept[j * cells[0] + i];
    let skew = dice.between(-0.1, 0.1);
    let skewed = |[x, y]: [f64; 2]| [x + skew * (5.0 * y).sin(), y + skew * y * (4.0 * x).cos()];
    // Two pieces that hang on the top may meet in a corner.
    let Some(mesh) = choice.grid(cells, &is_solid, &skewed) else { return sheet(dice) };
    let force = [dice.between(-0.1, 0.1), -dice.decades(-3.0, -1.0)];
    let gap = if dice.one_in(2) { 0.0 } else { dice.decades(-4.0, -2.0) };
    let conditions = vec![("top", clamped()), ("bottom", choice.floor(gap, 0.0))];
    let said = format!("{cells:?} cells, {share:.2} of them solid, gap {gap:e}");
    choice.body("sheet", &said, mesh, force, conditions)
}

/// Blocks with cells that grow away from the floor by a factor up to 1e6 in all, or towards an end of it.
fn graded(dice: &mut Dice) -> Body {
    let choice = Choice::new(dice);
    let cells = [dice.whole(4, 20), dice.whole(3, 10)];
    let (along, up) = (dice.decades(0.0, 2.0), dice.decades(0.0, 6.0));
    let grow = |t: f64, by: f64| if by < 1.01 { t } else { (by.powf(t) - 1.0) / (by - 1.0) };
    let grown = |[x, y]: [f64; 2]| [grow(x, along), grow(y, up)];
    let Some(mesh) = choice.grid(cells, &everywhere, &grown) else { return graded(dice) };
    let slope = dice.between(-0.05, 0.05);
    let conditions = vec![("top", clamped()), ("bottom", choice.floor(0.0, slope))];
    let said = format!("{cells:?} cells, graded {along:.1e} along and {up:.1e} up");
    choice.body("graded", &said, mesh, [0.0, -dice.decades(-3.0, 0.0)], conditions)
}

/// Blocks and beams of two materials, in layers, in columns or mixed cell by cell.
fn layered(dice: &mut Dice) -> Body {
    let choice = Choice::new(dice);
    let slenderness = dice.decades(0.0, 1.5);
    let cells = [dice.whole(4, 24), dice.whole(2, 6)];
    let Some(mesh) = choice.block(cells, 1.0 / slenderness) else { return layered(dice) };
    let (ratio, poisson) = (dice.decades(-6.0, 6.0), dice.between(-0.2, 0.49));
    let other = Material::young_poisson(choice.modulus * ratio, poisson, choice.material.plane());
    let order = dice.whole(0, 2);
    let per_cell = if choice.cut == Cut::Crossed { 4 } else { 2 };
    let is_other = |t: &usize| {
        let (i, j) = (t / per_cell % cells[0], t / per_cell / cells[0]);
        match order {
            0 => j % 2 == 1,
            1 => i % 3 == 1,
            _ => (7 * i + 5 * j) % 4 < 2,
        }
    };
    let members: Vec<usize> = (0..mesh.triangles().len()).filter(is_other).collect();
    let materials =
        Materials::in_parts(choice.material, mesh.triangles().len(), [(other, &members[..])]);
    let soft = ratio.min(1.0);
    let force = -soft * dice.decades(-3.0, -1.0) / slenderness;
    let gap = if dice.one_in(2) { 0.0 } else { dice.decades(-4.0, -2.0) / slenderness };
    let held = dice.pick(&["top", "left"]);
    let conditions = vec![(held, clamped()), ("bottom", choice.floor(gap, 0.0))];
    let order = ["layers", "columns", "cells"][order];
    let said = format!(
        "1 x 1/{slenderness:.1}, {cells:?} cells, {order} of {ratio:.1e} times the stiffness, held {held}, gap {gap:e}"
    );
    choice.body_of(materials, "layered", &said, mesh, [0.0, force], conditions)
}

/// Arches: a part of a ring, from a thick one to a strip, that stands on its back over a floor or lies over a hill. Contact is
/// along a circle.
fn arch(dice: &mut Dice) -> Body {
    let mut choice = Choice::new(dice);
    // On the circle to the last bits of a double.
    choice.offset = 0.0;
    let thickness = dice.decades(-2.0, -0.3);
    let cells = [dice.whole(6, 40), dice.whole(1, 4)];
    let span = dice.between(0.3, 3.0);
    let stands = dice.one_in(2);
    let bent = |[x, y]: [f64; 2]| {
        let (angle, across) = (span * (x - 0.5), thickness * y);
        let (r, up) = if stands { (1.0 - across, -1.0) } else { (1.0 + across, 1.0) };
        [r * angle.sin(), up * r * angle.cos()]
    };
    // A cell may be thinner than its arc is high.
    let Some(mesh) = choice.grid(cells, &everywhere, &bent) else { return arch(dice) };
    let near = thickness * dice.decades(-3.0, -1.0);
    let length = choice.length;
    let gap = function(move |[x, y]| {
        let [x, y] = [x / length, y / length];
        length * (near + if stands { y + 1.0 } else { 0.3 * x * x })
    });
    let force = -thickness * dice.decades(-3.0, -0.5);
    let mut conditions = vec![("left", clamped()), ("bottom", Condition::Contact { gap })];
    match dice.whole(0, 2) {
        0 => conditions.push(("right", clamped())),
        1 => conditions.push(("right", slides(0))),
        _ => {}
    }
    // What the direction of contact turns by along an edge takes of the limit (docs/theory.md, Lemma 2.1b).
    if choice.degree == Degree::Two {
        choice.share /= 2.0 - (span / cells[0] as f64).cos();
    }
    let said = format!(
        "{thickness:.1e} thick, {span:.2} wide, {cells:?} cells, {near:e} over {}",
        if stands { "a floor" } else { "a hill" }
    );
    let body = choice.body("arch", &said, mesh, [0.0, force], conditions);
    Body { circle: Some(Circle { center: [0.0; 2], radius: length, is_around: stands }), ..body }
}

/// Blocks that only their weight holds on the floor: a side is guided.
fn resting(dice: &mut Dice) -> Body {
    let (along, gap) = (dice.between(-0.05, 0.05), dice.between(0.0, 0.01));
    on_the_floor("resting", dice, along, gap, &|_| vec![("left", slides(0))])
}

/// Blocks that nothing but contact holds: pushed into a corner of a floor and a wall, which may lean against each other.
fn cornered(dice: &mut Dice) -> Body {
    let (along, gap) = (-dice.decades(-3.0, -0.5), dice.between(0.0, 0.01));
    let far = dice.between(-0.01, 0.01);
    on_the_floor("cornered", dice, along, gap, &|length| vec![("left", wall(length * far))])
}

/// Blocks that are pressed between two walls and pushed to the floor.
fn squeezed(dice: &mut Dice) -> Body {
    let (along, depth) = (dice.between(-0.01, 0.01), dice.decades(-4.0, -1.0));
    let walls = |length: f64| ["left", "right"].map(|side| (side, wall(-depth * length))).into();
    on_the_floor("squeezed", dice, along, 0.0, &walls)
}

fn wall(gap: f64) -> Condition {
    Condition::Contact { gap: constant(gap) }
}

/// A block that is pushed to the floor and `along` it, `beside` telling what else it meets in the unit of length.
fn on_the_floor(
    kind: &'static str,
    dice: &mut Dice,
    along: f64,
    gap: f64,
    beside: &dyn Fn(f64) -> Vec<(&'static str, Condition)>,
) -> Body {
    let choice = Choice::new(dice);
    let slenderness = dice.decades(-1.0, 1.0);
    let cells = [dice.whole(2, 16), dice.whole(2, 16)];
    let Some(mesh) = choice.block(cells, 1.0 / slenderness) else {
        return on_the_floor(kind, dice, along, gap, beside);
    };
    let force = [along, -dice.decades(-3.0, -0.5)];
    let slope = dice.between(-0.01, 0.01);
    let mut conditions = beside(choice.length);
    conditions.push(("bottom", choice.floor(gap, slope)));
    let said = format!(
        "1 x 1/{slenderness:.1}, {cells:?} cells, gap {gap:e}, slope {slope:e}, force {force:?}"
    );
    choice.body(kind, &said, mesh, force, conditions)
}

fn well_posed(seed: u64) -> Body {
    let mut dice = Dice(seed);
    let kinds = [beam, sheet, graded, sheet, layered, arch, resting];
    kinds[(seed % 7) as usize](&mut dice)
}

/// All families, those that contact alone holds too; one body in four has the Gauss points of its degree on its contact edges.
fn of_all_families(seed: u64) -> Body {
    let kinds = [beam, sheet, graded, layered, arch, resting, cornered, squeezed];
    let body = kinds[(seed % 8) as usize](&mut Dice(seed));
    let quadrature = match seed / 8 % 4 {
        0 => ContactQuadrature::Gauss(body.method.degree.number() + 1),
        _ => body.method.quadrature,
    };
    Body { method: Method { quadrature, ..body.method }, ..body }
}

/// Beyond this condition number no solution need be proved; nor where the matrix has no factor.
const ILL_CONDITIONED: f64 = 1e14;

/// What comes of a body, and whether that is as it should be.
fn verdict_on(body: &Body, steps: &mut Vec<usize>) -> (&'static str, bool) {
    let settings = Settings { max_iterations: 200, ..Settings::default() };
    match solve(&body.problem, &body.method, &settings) {
        Ok((solution, _)) => {
            steps.push(solution.newton.iterations());
            let ill_conditioned = solution.method.condition > ILL_CONDITIONED
                || solution.enclosure == Err(Unproved::NoFactor);
            match (&solution.enclosure, solution.verdict.reason()) {
                (_, None) => ("proved", true),
                (_, Some(_)) if ill_conditioned => ("not proved, ill-conditioned", true),
                (Ok(_), Some(_)) => ("not proved, radius too large", false),
                (Err(_), Some(_)) => ("not proved, no enclosure", false),
            }
        }
        Err(SolveError::IllConditioned { .. } | SolveError::Singular) => {
            ("refused, ill-conditioned", true)
        }
        Err(SolveError::OutOfRange) => ("refused, out of range", true),
        Err(_) => ("refused", false),
    }
}

#[test]
fn forty_nine_of_fifty_bodies_of_all_families_are_proved_or_ill_conditioned() {
    let seeds = seeds(80);
    let count = (seeds.end - seeds.start) as usize;
    let mut table: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let (mut failures, mut steps) = (0, Vec::new());
    for seed in seeds {
        let body = of_all_families(seed);
        let (what, right) = verdict_on(&body, &mut steps);
        *table.entry((body.kind, what)).or_default() += 1;
        if !right {
            println!("seed {seed}: {}: {what} [{}]", body.kind, body.said);
            failures += 1;
        }
    }
    for ((kind, what), bodies) in table {
        println!("{kind:9} {bodies:5} {what}");
    }
    steps.sort_unstable();
    let at = |share: usize| steps[(steps.len() - 1) * share / 10];
    let all: usize = steps.iter().sum();
    println!("{all} steps: median {}, nine of ten at most {}, most {}", at(5), at(9), at(10));
    assert!(50 * failures <= count, "{failures} of {count} bodies, shown above");
}

/// How far the solver's answer may be off, in the energy norm.
const CLOSE: f64 = 1e-8;

/// Where rounding the exact displacement to doubles takes more than this away in the energy norm, it may be refused.
const BEYOND_DOUBLES: f64 = 1e-7;

/// The share of |u|_a that the two solvers' problems may differ by: they integrate the same load by other rules, in doubles.
const SAME_LOAD: f64 = 1e-15;

/// On a circle, also by the normals: vertices that are rounded to doubles know them to 1e-16 over the length of a facet.
const SAME_CIRCLE: f64 = 1e-12;

/// What is wrong with the solver's answer to this body, if anything is; `radii` gets the relative radius of its enclosure, if
/// there is one.
fn wrong(body: &Body, radii: &mut Vec<f64>) -> Option<String> {
    let again = body.again();
    let (solution, _) = match solve(
        &body.problem,
        &body.method,
        &Settings { max_iterations: 200, ..Settings::default() },
    ) {
        Ok(solution) => solution,
        Err(SolveError::IllConditioned { .. })
            if again.solve(None).is_some_and(|u| again.rounding(&u) > BEYOND_DOUBLES) =>
        {
            return None;
        }
        Err(SolveError::OutOfRange)
            if again.solve(None).is_some_and(|u| !again.energy(&u).is_normal()) =>
        {
            return None;
        }
        Err(error) => return Some(format!("refused: {error}")),
    };
    let Some(answer) = again.solve(Some(&solution.displacement)) else {
        return Some("the independent solver does not converge".to_owned());
    };
    let error = again.error(&answer, &solution.displacement);
    if !(error <= CLOSE.max(2.0 * again.rounding(&answer))) {
        return Some(format!("off by {error:.1e} in the energy norm"));
    }
    match &solution.enclosure {
        Ok(enclosure) => {
            let bound = enclosure.relative.unwrap_or(0.0);
            radii.push(bound);
            let same = if body.circle.is_some() { SAME_CIRCLE } else { SAME_LOAD };
            if !(error <= bound + same) {
                return Some(format!("error {error:.1e}, bound {bound:.1e}"));
            }
        }
        // Its numbers leave the range of doubles, A alone has no factor in them, or no edge is surely pressed enough to hold it.
        Err(
            Unproved::NoKappa | Unproved::OutOfRange | Unproved::NoFactor | Unproved::HeldByContact,
        ) => {}
        Err(why) => return Some(why.to_string()),
    }
    let quantities = &solution.quantities;
    // Where P2 touches in less than a 1e-5 of an edge, P in doubles knows its forces to less, and the residual says so.
    let known = CLOSE.max(solution.newton.residual);
    out_of_balance(body, known, &quantities.contact_resultant, &quantities.reactions)
}

/// Body force, reactions and contact must balance to this share of their sizes.
fn out_of_balance(
    body: &Body,
    share: f64,
    contact: &[f64; 2],
    reactions: &BTreeMap<String, [f64; 2]>,
) -> Option<String> {
    let mesh = &body.problem.mesh;
    let area: f64 = (0..mesh.triangles().len()).map(|t| mesh.triangle(t).double_area() / 2.0).sum();
    for c in 0..2 {
        let forces = reactions.values().map(|r| r[c]).chain([contact[c], body.force[c] * area]);
        let (sum, size) = forces.fold((0.0, 0.0), |(s, m): (f64, f64), f| (s + f, m + f.abs()));
        let weight = body.force[0].hypot(body.force[1]) * area;
        if !(sum.abs() <= share * size.max(weight)) {
            return Some(format!("forces along {} add up to {sum:e} of {size:e}", ["x", "y"][c]));
        }
    }
    None
}

fn report(failures: &[(u64, String)], count: u64) {
    for (seed, failure) in failures {
        println!("seed {seed}: {failure}");
    }
    assert!(failures.is_empty(), "{} of {count} bodies, shown above", failures.len());
}

#[test]
fn well_posed_bodies_are_solved_and_enclosed_as_an_independent_assembled_newton_solves_them() {
    let seeds = seeds(140);
    let count = seeds.end - seeds.start;
    let mut radii = Vec::new();
    let failures: Vec<(u64, String)> = seeds
        .filter_map(|seed| {
            let body = well_posed(seed);
            let why = wrong(&body, &mut radii)?;
            Some((seed, format!("{}: {why} [{}]", body.kind, body.said)))
        })
        .collect();
    report(&failures, count);
    let enclosed = radii.len() as u64;
    assert!(20 * enclosed >= 19 * count, "{enclosed} of {count} enclosed");
}

#[test]
fn control_the_independent_answer_notices_a_displacement_that_is_off_by_1e_7() {
    let body = well_posed(7);
    let (solution, _) = solve(&body.problem, &body.method, &Settings::default()).unwrap();
    let again = body.again();
    let off: Vec<[f64; 2]> =
        solution.displacement.iter().map(|u| u.map(|c| c * (1.0 + 1e-7))).collect();
    let answer = again.solve(Some(&off)).unwrap();
    let error = again.error(&answer, &off);
    assert!((error / 1e-7 - 1.0).abs() < 0.1, "{error:e}");
}

#[test]
fn the_independent_solver_ends_at_the_same_answer_from_wherever_it_starts() {
    for seed in 7..13 {
        let body = well_posed(seed);
        let again = body.again();
        let from_zero = again.solve(None).unwrap();
        let (solution, _) = solve(&body.problem, &body.method, &Settings::default()).unwrap();
        assert!(again.error(&from_zero, &solution.displacement) < CLOSE, "{}", body.said);
    }
}

/// Clamped beams that bend freely: w = q L^4 / (8 E I), q = f h, I = h^3 / 12; shear adds O((h/L)^2).
#[test]
fn free_beams_bend_as_beam_theory_has_it() {
    for slenderness in [20.0, 1e2, 1e3] {
        for cut in [Cut::Left, Cut::Right, Cut::Crossed] {
            let height = 1.0 / slenderness;
            let cells = [60, 2];
            let place = |[i, j]: [f64; 2]| [i / 60.0, height * j / 2.0];
            let mesh = Grid { cells, cut, solid: &everywhere, place: &place }.mesh().unwrap();
            let force = height * height;
            let conditions = [
                ("left".to_owned(), clamped()),
                ("bottom".to_owned(), Condition::Contact { gap: constant(1e12) }),
            ];
            let problem = Problem::new(
                mesh,
                Material::young_poisson(1.0, 0.0, Plane::Strain),
                [constant(0.0), constant(-force)],
                BTreeMap::from(conditions),
            );
            let method = Method { degree: Degree::Two, ..Method::default() };
            let (solution, _) = solve(&problem, &method, &Settings::default()).unwrap();
            let deflection = solution.quantities.max_displacement;
            let expected = 12.0 * force / (8.0 * height * height);
            let off = (deflection / expected - 1.0).abs();
            assert!(
                off < 4.0 * height * height + 2e-3,
                "1:{slenderness} {cut:?}: {deflection} {expected}"
            );
        }
    }
}

/// A problem that is none, and whether an error is its true reason.
struct IllPosed {
    said: String,
    outcome: Result<(), SolveError>,
    reason: fn(&SolveError) -> bool,
}

fn attempt(
    mesh: Result<Mesh, MeshError>,
    problem: impl FnOnce(Mesh) -> Problem,
    method: &Method,
) -> Result<(), SolveError> {
    let mesh = mesh.map_err(DataError::Mesh)?;
    solve(&problem(mesh), method, &Settings::default()).map(|_| ())
}

fn is_free(error: &SolveError) -> bool {
    matches!(error, SolveError::Data(DataError::RigidMotion { .. }))
}

fn is_joined_at_a_vertex(error: &SolveError) -> bool {
    matches!(error, SolveError::Data(DataError::Mesh(MeshError::JoinedAtVertex { .. })))
}

fn is_torn(error: &SolveError) -> bool {
    matches!(
        error,
        SolveError::Data(DataError::Mesh(MeshError::Near { .. } | MeshError::Hanging { .. }))
    )
}

fn is_overlap(error: &SolveError) -> bool {
    matches!(error, SolveError::Data(DataError::Mesh(MeshError::Overlapping { .. })))
}

fn is_no_material(error: &SolveError) -> bool {
    matches!(error, SolveError::Data(DataError::Material(_)))
}

fn is_not_coercive(error: &SolveError) -> bool {
    matches!(error, SolveError::NotCoercive { .. })
}

fn is_a_value(error: &SolveError) -> bool {
    matches!(error, SolveError::Data(DataError::Value { .. }))
}

fn is_disagreement(error: &SolveError) -> bool {
    matches!(error, SolveError::Data(DataError::Disagree { .. }))
}

fn is_not_finite(error: &SolveError) -> bool {
    matches!(error, SolveError::Data(DataError::NotFinite { .. }))
}

fn ill_posed(seed: u64) -> IllPosed {
    let mut dice = Dice(seed);
    let choice = Choice::new(&mut dice);
    let cells = [2 * dice.whole(2, 5), 2 * dice.whole(2, 5)];
    let [nx, ny] = cells.map(|n| n as f64);
    let plain = |[i, j]: [f64; 2]| choice.place([i / nx, j / ny]);
    let block = || Grid { cells, cut: choice.cut, solid: &everywhere, place: &plain }.mesh();
    let with = |mesh, conditions| choice.body("", "", mesh, [0.01, 0.01], conditions).problem;
    let floor = || ("bottom", choice.floor(0.01, 0.0));
    let method = Method { degree: choice.degree, ..Method::default() };
    let (said, outcome, reason): (&str, _, fn(&SolveError) -> bool) = match seed % 10 {
        0 if dice.one_in(3) => {
            // The force drives the body along its roller; contact is on the other side.
            let (sin, cos) = dice.between(-3.0, 3.0).sin_cos();
            let place = |[i, j]: [f64; 2]| {
                let [x, y] = [i / nx, j / ny];
                choice.place([cos * x - sin * y, sin * x + cos * y])
            };
            let mesh = Grid { cells, cut: choice.cut, solid: &everywhere, place: &place }.mesh();
            let roller = Condition::Support { normal: Some(constant(0.0)), tangential: None };
            let side = ("right", choice.floor(0.01, 0.0));
            let problem = |mesh| with(mesh, vec![("left", roller), side]);
            ("a body on one roller", attempt(mesh, problem, &method), is_free)
        }
        0 => {
            // The force lifts the body and pushes it along the floor.
            let held = dice.whole(0, 2);
            let problem = |mesh| {
                let mut conditions = vec![floor()];
                match held {
                    0 => {}
                    c => conditions.push(("top", slides(c - 1))),
                }
                with(mesh, conditions)
            };
            (
                "a body that nothing or one component holds",
                attempt(block(), problem, &method),
                is_free,
            )
        }
        1 => {
            let solid = |i: usize, j: usize| (2 * i < cells[0]) == (2 * j < cells[1]);
            let mesh = Grid { cells, cut: choice.cut, solid: &solid, place: &plain }.mesh();
            let side = || ("right", choice.floor(0.01, 0.0));
            let problem = |mesh| with(mesh, vec![("top", clamped()), side()]);
            (
                "a block that hangs on another in a corner",
                attempt(mesh, problem, &method),
                is_joined_at_a_vertex,
            )
        }
        2 => {
            // One cell that touches the body above it in its upper left corner only.
            let (a, b) = (dice.whole(1, cells[0] - 2), dice.whole(0, cells[1] - 3));
            let solid = |i: usize, j: usize| {
                (i, j) == (a, b) || j > b + 1 || (j == b + 1 && i != a && i != a + 1)
            };
            let mesh = Grid { cells, cut: choice.cut, solid: &solid, place: &plain }.mesh();
            let problem =
                |mesh| with(mesh, vec![("top", clamped()), ("left", choice.floor(0.01, 0.0))]);
            (
                "a cell that hangs on the body in a corner",
                attempt(mesh, problem, &method),
                is_joined_at_a_vertex,
            )
        }
        3 | 4 => {
            // A seam of which one side was written with few digits, or is finer.
            let size = 1.0 + choice.offset;
            let shift = (size * dice.decades(-9.0, -5.0)).min(5e-4 / nx.max(ny));
            let shift = if dice.one_in(2) { shift } else { -shift };
            let finer = if seed % 10 == 3 { 0 } else { 1 };
            let at = |[x, y]: [f64; 2]| choice.place([0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y]);
            let right_cells = [cells[0], cells[1] + finer];
            let right_ny = right_cells[1] as f64;
            let left = |[i, j]: [f64; 2]| at([i / nx, j / ny]);
            let right = |[i, j]: [f64; 2]| at([1.0 + i / nx + shift, j / right_ny + shift / 3.0]);
            let [left, right]: [Grid; 2] = [
                Grid { cells, cut: choice.cut, solid: &everywhere, place: &left },
                Grid { cells: right_cells, cut: choice.cut, solid: &everywhere, place: &right },
            ];
            let problem = |mesh| with(mesh, vec![("top", clamped()), floor()]);
            ("a seam that is torn", attempt(both(&left, &right), problem, &method), is_torn)
        }
        5 => {
            let by = [dice.between(0.1, 0.9), dice.between(-0.9, 0.9)];
            let other = |[i, j]: [f64; 2]| choice.place([by[0] + 0.97 * i / nx, by[1] + j / ny]);
            let first = Grid { cells, cut: choice.cut, solid: &everywhere, place: &plain };
            let second = Grid { place: &other, ..first };
            let problem = |mesh| with(mesh, vec![("top", clamped()), floor()]);
            let outcome = attempt(both(&first, &second), problem, &method);
            // A vertex of one may lie on an edge of the other.
            ("bodies that overlap", outcome, |error| is_overlap(error) || is_torn(error))
        }
        6 => {
            let bad = dice.pick(&[
                Material::young_poisson(1.0, 0.5, Plane::Strain),
                Material::young_poisson(-1.0, 0.3, Plane::Stress),
                Material::lame(-0.7, 1.0, Plane::Strain),
                Material::lame(f64::NAN, 1.0, Plane::Strain),
            ]);
            let problem = |mesh| {
                let good = with(mesh, vec![("top", clamped()), floor()]);
                Problem::new(good.mesh, bad, good.body_force, good.conditions)
            };
            ("a material that is none", attempt(block(), problem, &method), is_no_material)
        }
        7 => {
            let problem = |mesh| with(mesh, vec![("top", clamped()), floor()]);
            let mesh = block().unwrap();
            let conditions = BTreeMap::from([("bottom".to_owned(), choice.floor(0.0, 0.0))]);
            let most = limit(&mesh, &choice.material.into(), choice.degree, &conditions);
            let gamma0 = Gamma0::Value(most * dice.decades(0.01, 6.0));
            let method = Method { gamma0, ..method };
            ("gamma0 beyond the limit", attempt(Ok(mesh), problem, &method), is_not_coercive)
        }
        8 => {
            let method = match dice.whole(0, 3) {
                0 => Method { gamma0: Gamma0::Value(0.0), ..method },
                1 => Method { gamma0: Gamma0::Value(-1.0), ..method },
                2 => Method { gamma0: Gamma0::Value(f64::NAN), ..method },
                _ => Method { quadrature: ContactQuadrature::Gauss(0), ..method },
            };
            let problem = |mesh| with(mesh, vec![("top", clamped()), floor()]);
            (
                "a method that no case file could ask for",
                attempt(block(), problem, &method),
                is_a_value,
            )
        }
        _ => {
            let clash = dice.one_in(2);
            let problem = |mesh| {
                let value = if clash { 0.1 } else { f64::INFINITY };
                let left = Condition::Displacement([Some(constant(value)), None]);
                with(mesh, vec![("top", clamped()), floor(), ("left", left)])
            };
            let reason = if clash { is_disagreement } else { is_not_finite };
            ("displacements that disagree or are none", attempt(block(), problem, &method), reason)
        }
    };
    IllPosed { said: format!("{said}: {cells:?} cells; {}", choice.said), outcome, reason }
}

/// Two grids in one mesh, nothing joined; the sides keep their names.
fn both(first: &Grid, second: &Grid) -> Result<Mesh, MeshError> {
    let (mut vertices, mut triangles, mut sides) = first.pieces();
    let (more, others, _) = second.pieces();
    let shift = vertices.len();
    vertices.extend(more);
    triangles.extend(others.into_iter().map(|t| t.map(|v| v + shift)));
    sides.retain(|name, _| name != "right");
    Mesh::new(vertices, triangles, sides)
}

#[test]
fn ill_posed_problems_are_refused_for_their_true_reason() {
    let seeds = seeds(200);
    let count = seeds.end - seeds.start;
    let failures: Vec<(u64, String)> = seeds
        .filter_map(|seed| {
            let IllPosed { said, outcome, reason } = ill_posed(seed);
            match outcome {
                Err(error) if reason(&error) => None,
                Err(error) => Some((seed, format!("{said}: {error}"))),
                Ok(()) => Some((seed, format!("{said}: solved"))),
            }
        })
        .collect();
    report(&failures, count);
}
