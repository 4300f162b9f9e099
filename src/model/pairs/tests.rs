use std::f64::consts::{FRAC_PI_2, PI, TAU};

use approx::assert_abs_diff_eq;

use super::*;
use crate::kernel::{Material, Plane};
use crate::model::Condition;

/// A hundred operations on numbers of size 1 to 10.
const ROUNDING: f64 = 1e-13;

/// The distance of the curve between two nodes of a circle of radius 1 from the circle, for edges of this angle: 9e-6 of its sixth
/// power, measured in `boundary_normals`, with room for both boundaries and for the radius.
fn off_circles(angle: f64) -> f64 {
    1e-4 * angle.powi(6)
}

/// A body of nx x ny cells, the image of the square (0, 1)^2; its sides are NAME.bottom, .right, .top, .left, or NAME.bottom and
/// NAME.top where the left one is joined to the right one.
struct Body<'a> {
    name: &'static str,
    cells: [usize; 2],
    closed: bool,
    map: &'a dyn Fn([f64; 2]) -> [f64; 2],
}

fn mesh(bodies: &[Body]) -> Mesh {
    let (mut vertices, mut triangles, mut named) = (Vec::new(), Vec::new(), Vec::new());
    for &Body { name, cells: [nx, ny], closed, map } in bodies {
        let (first, columns) = (vertices.len(), if closed { nx } else { nx + 1 });
        let at = |i: usize, j: usize| first + j * columns + i % columns;
        for j in 0..=ny {
            let row = (0..columns).map(|i| map([i as f64 / nx as f64, j as f64 / ny as f64]));
            vertices.extend(row);
        }
        for j in 0..ny {
            for i in 0..nx {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        let side = |what: &str, edges: Vec<[usize; 2]>| (format!("{name}.{what}"), edges);
        named.push(side("bottom", (0..nx).map(|i| [at(i, 0), at(i + 1, 0)]).collect()));
        named.push(side("top", (0..nx).map(|i| [at(i, ny), at(i + 1, ny)]).collect()));
        if !closed {
            named.push(side("left", (0..ny).map(|j| [at(0, j), at(0, j + 1)]).collect()));
            named.push(side("right", (0..ny).map(|j| [at(nx, j), at(nx, j + 1)]).collect()));
        }
    }
    Mesh::of_edges(vertices, triangles, named, &|_, _| true).unwrap()
}

fn block(low: [f64; 2], high: [f64; 2]) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |x| [0, 1].map(|c| low[c] + (high[c] - low[c]) * x[c])
}

/// A part of a ring around (0, y), from one angle to another, clockwise so that triangles are not: bottom is the smaller radius.
fn ring(
    radii: [f64; 2],
    [from, to]: [f64; 2],
    y: f64,
    uneven: f64,
) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |[s, t]| {
        let s = s + uneven * (TAU * s).sin();
        let (angle, r) = (to + (from - to) * s, radii[0] + (radii[1] - radii[0]) * t);
        [r * angle.cos(), y + r * angle.sin()]
    }
}

fn found(mesh: &Mesh, pair: &Pair, degree: Degree) -> Result<Vec<PairPiece>, DataError> {
    pieces(mesh, &SmoothBoundary::new(mesh), pair, degree)
}

/// The share of each edge of boundary `i` that pieces cover, by the pieces in order; they do not overlap.
fn covered(mesh: &Mesh, name: &str, pieces: &[PairPiece], i: usize) -> Vec<f64> {
    let of = |edge: &BoundaryEdge| {
        let on = pieces.iter().map(|piece| &piece.sides[i]).filter(|side| side.edge == *edge);
        let mut parts: Vec<[f64; 2]> =
            on.map(|side| [side.places[i], side.places[1 - i]]).collect();
        parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert!(parts.iter().all(|[from, to]| from < to), "a piece runs the wrong way");
        assert!(parts.windows(2).all(|two| two[0][1] <= two[1][0] + ROUNDING), "pieces overlap");
        parts.iter().map(|[from, to]| to - from).sum()
    };
    mesh.edges_of(name).unwrap().iter().map(of).collect()
}

/// The places of the nodes of a piece on the chord of a side.
fn on_chord(mesh: &Mesh, side: &PairSide) -> Vec<Vector2<f64>> {
    let [a, b] = mesh.places_of_ends(side.edge).map(Vector2::from);
    side.places.iter().map(|s| a + (b - a) * *s).collect()
}

fn pin_in_hole(cells: [usize; 2]) -> Mesh {
    let pin = ring([0.4, 1.0], [0.0, TAU], -0.08, 0.02);
    let plate = ring([1.1, 2.0], [0.0, TAU], 0.0, 0.03);
    let body = |name, n, map| Body { name, cells: [n, 2], closed: true, map };
    mesh(&[body("pin", cells[0], &pin), body("plate", cells[1], &plate)])
}

#[test]
fn between_flat_boundaries_the_gap_is_exact_and_pieces_end_where_the_shorter_one_does() {
    let (lower, upper) = (block([0.0, 0.0], [3.0, 1.0]), block([1.0, 1.1], [2.0, 2.0]));
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let mesh = mesh(&[body("lower", 7, &lower), body("upper", 11, &upper)]);
    for degree in [Degree::One, Degree::Two] {
        let pieces = found(&mesh, &Pair::new("lower.top", "upper.bottom"), degree).unwrap();
        // Twelve nodes above, and those below between 1 and 2, at 9/7 and 12/7.
        assert_eq!(pieces.len(), 13);
        for piece in &pieces {
            let nodes = degree.nodes_per_edge();
            assert_eq!(piece.directions, vec![Vector2::y(); nodes]);
            let expected = vec![0.1; nodes];
            assert_abs_diff_eq!(&piece.gap[..], &expected[..], epsilon = ROUNDING);
            piece.sides.iter().for_each(|side| {
                assert_abs_diff_eq!(side.ratio, 1.0, epsilon = ROUNDING);
            });
        }
        let length: f64 = pieces.iter().map(|piece| piece.length).sum();
        assert_abs_diff_eq!(length, 1.0, epsilon = ROUNDING);
        let share = covered(&mesh, "upper.bottom", &pieces, 1);
        assert_abs_diff_eq!(&share[..], &[1.0; 11][..], epsilon = ROUNDING);
    }
}

#[test]
fn rings_of_unequal_edges_have_the_gap_of_the_circles_where_polygons_have_another() {
    for (radii, gap) in [([2.0, 2.1], 0.1), ([2.002, 1.998], -0.004), ([2.0, 2.0], 0.0)] {
        let inner = ring([1.0, radii[0]], [0.0, TAU], 0.0, 0.0);
        let outer = ring([radii[1], 3.0], [0.0, TAU], 0.0, 0.02);
        let body = |name, nx, map| Body { name, cells: [nx, 1], closed: true, map };
        let mesh = mesh(&[body("inner", 31, &inner), body("outer", 44, &outer)]);
        for degree in [Degree::One, Degree::Two] {
            let pieces = found(&mesh, &Pair::new("inner.top", "outer.bottom"), degree).unwrap();
            let mut worst: f64 = 0.0;
            for piece in &pieces {
                let sides = piece.sides.each_ref().map(|side| on_chord(&mesh, side));
                for (a, d) in piece.directions.iter().enumerate() {
                    let off = 3.0 * off_circles(1.2 * TAU / 31.0);
                    assert_abs_diff_eq!(piece.gap[a], gap, epsilon = off);
                    let on_chords = (sides[1][a] - sides[0][a]).dot(d);
                    worst = worst.max((on_chords - gap).abs());
                    // The normal of the curve is off by the fifth power; the line through a middle is none of partners.
                    let outward = unit(sides[0][a]);
                    let turned = length(d - outward) / (1.2 * TAU / 31.0_f64).powi(5);
                    assert!(a == 2 || turned < 2e-3, "{turned:e}");
                }
            }
            // Control: between the chords the gap is off by their sagitta, h^2 / 8 r.
            assert!(worst > 2.0 * (TAU / 31.0).powi(2) / 8.0 / 2.0, "{worst}");
            for (i, name) in ["inner.top", "outer.bottom"].into_iter().enumerate() {
                for share in covered(&mesh, name, &pieces, i) {
                    assert_abs_diff_eq!(share, 1.0, epsilon = ROUNDING);
                }
            }
        }
    }
}

#[test]
fn a_pin_in_a_hole_has_the_gap_of_two_circles_that_are_not_concentric() {
    let (r, hole, centre) = (1.0, 1.1, Vector2::new(0.0, -0.08));
    for cells in [[40, 56], [57, 40]] {
        let mesh = pin_in_hole(cells);
        for degree in [Degree::One, Degree::Two] {
            let pieces = found(&mesh, &Pair::new("pin.top", "plate.bottom"), degree).unwrap();
            for piece in &pieces {
                // The edges are uneven by a fifth.
                let off = off_circles(1.3 * TAU / 40.0);
                let x = on_chord(&mesh, &piece.sides[0]);
                for (a, d) in piece.directions.iter().enumerate() {
                    // From the chord to the circle around c with this radius, along d.
                    let to = |c: Vector2<f64>, radius: f64| {
                        let (along, across) = ((x[a] - c).dot(d), (x[a] - c).perp(d));
                        (radius * radius - across * across).sqrt() - along
                    };
                    let expected = to(Vector2::zeros(), hole) - to(centre, r);
                    assert_abs_diff_eq!(piece.gap[a], expected, epsilon = off);
                    if a < 2 {
                        // Normals e(m - t) and -e(m + t): their points differ by a multiple of d = e(m) where
                        // (R + r) sin t = d x c.
                        let sine = d.perp(&centre) / (hole + r);
                        let expected = (hole - r) * (1.0 - sine * sine).sqrt() - centre.dot(d);
                        assert_abs_diff_eq!(piece.gap[a], expected, epsilon = off);
                    }
                }
            }
            for (i, name) in ["pin.top", "plate.bottom"].into_iter().enumerate() {
                for share in covered(&mesh, name, &pieces, i) {
                    assert_abs_diff_eq!(share, 1.0, epsilon = ROUNDING);
                }
            }
        }
    }
}

#[test]
fn the_points_of_a_node_differ_by_a_multiple_of_its_direction() {
    let mesh = pin_in_hole([23, 31]);
    for degree in [Degree::One, Degree::Two] {
        let pieces = found(&mesh, &Pair::new("pin.top", "plate.bottom"), degree).unwrap();
        for piece in pieces {
            let [first, second] = piece.sides.each_ref().map(|side| on_chord(&mesh, side));
            for ((x, y), d) in first.iter().zip(&second).zip(&piece.directions) {
                assert_abs_diff_eq!((y - x).perp(d), 0.0, epsilon = ROUNDING);
                assert_abs_diff_eq!(length(*d), 1.0, epsilon = ROUNDING);
            }
            // Control: an end of one side and the middle of the other do not.
            assert!((second[1] - first[0]).perp(&piece.directions[0]).abs() > 1e-3 * piece.length);
        }
    }
}

#[test]
fn the_pieces_are_the_same_if_the_boundaries_are_named_in_the_other_order() {
    let mesh = pin_in_hole([23, 31]);
    let pair = Pair::new("pin.top", "plate.bottom");
    let turned = Pair::new("plate.bottom", "pin.top");
    for degree in [Degree::One, Degree::Two] {
        let pieces = found(&mesh, &pair, degree).unwrap();
        let other = found(&mesh, &turned, degree).unwrap();
        assert_eq!(pieces.len(), other.len());
        let reversed = |values: &[f64]| {
            let mut values = values.to_vec();
            values.swap(0, 1);
            values
        };
        let mut one_sided: f64 = 0.0;
        for piece in &pieces {
            let same = other.iter().find(|other| {
                let edges = [1, 0].map(|i| other.sides[i].edge);
                edges == [0, 1].map(|i| piece.sides[i].edge)
                    && (other.sides[1].places[1] - piece.sides[0].places[0]).abs() < 1e-6
            });
            let same = same.unwrap();
            assert_abs_diff_eq!(piece.length, same.length, epsilon = ROUNDING);
            let gaps = reversed(&same.gap);
            assert_abs_diff_eq!(&piece.gap[..], &gaps[..], epsilon = ROUNDING);
            for i in [0, 1] {
                let (side, theirs) = (&piece.sides[i], &same.sides[1 - i]);
                let places = reversed(&theirs.places);
                // A place is told to a hundred roundings of a coordinate, beside edges of 0.2.
                assert_abs_diff_eq!(&side.places[..], &places[..], epsilon = 10.0 * ROUNDING);
                assert_abs_diff_eq!(side.ratio, theirs.ratio, epsilon = 10.0 * ROUNDING);
            }
            let mut directions = same.directions.clone();
            directions.swap(0, 1);
            for (a, (d, theirs)) in piece.directions.iter().zip(&directions).enumerate() {
                assert_abs_diff_eq!(d, &-theirs, epsilon = 10.0 * ROUNDING);
                let x = Vector2::new(0.0, -0.08);
                let from = on_chord(&mesh, &piece.sides[0])[a] - x;
                one_sided = one_sided.max(length(unit(from) - d));
            }
            if degree == Degree::Two {
                // Control: the line through the middle of one side alone is another one.
                let middle = (piece.sides[0].places[0] + piece.sides[0].places[1]) / 2.0;
                assert!((middle - piece.sides[0].places[2]).abs() < 0.1);
            }
        }
        // Control: the normal of one body alone is another direction.
        assert!(one_sided > 1e-2, "{one_sided}");
    }
}

#[test]
fn a_clearance_takes_the_place_of_the_gap_of_the_mesh() {
    let (lower, upper) = (block([0.0, 0.0], [1.0, 1.0]), block([0.0, 1.1], [1.0, 2.0]));
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let mesh = mesh(&[body("lower", 2, &lower), body("upper", 3, &upper)]);
    let pair = Pair::new("lower.top", "upper.bottom").with_clearance(|[x, y]| x + y);
    for piece in found(&mesh, &pair, Degree::Two).unwrap() {
        let x = on_chord(&mesh, &piece.sides[0]);
        for (x, gap) in x.iter().zip(piece.gap) {
            assert_abs_diff_eq!(gap, x[0] + 1.05, epsilon = ROUNDING);
        }
    }
    let pair = Pair::new("lower.top", "upper.bottom").with_clearance(|[x, _]| 1.0 / (x - 0.5));
    let error = found(&mesh, &pair, Degree::One).unwrap_err();
    let said = "the clearance between 'lower.top' and 'upper.bottom' is inf at (0.5, 1.05); expected a finite number at every point of the mesh";
    assert_eq!(error.to_string(), said);
}

#[test]
fn in_a_valley_the_pieces_of_the_two_slopes_meet_where_these_are_equally_near() {
    // A block above the valley y = |x| / 2: only the valley's corner and its ends are nodes there, and the two slopes overlap as seen
    // from the block by the share of a cell.
    let valley = |[s, t]: [f64; 2]| {
        let x = 4.0 * s - 2.0;
        [x, x.abs() / 2.0 - 3.0 * (1.0 - t)]
    };
    let above = |[s, t]: [f64; 2]| [3.0 * s - 1.4, 1.4 + 0.9 * t];
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let mesh = mesh(&[body("valley", 2, &valley), body("above", 1, &above)]);
    for pair in [["valley.top", "above.bottom"], ["above.bottom", "valley.top"]] {
        let pieces =
            found(&mesh, &Pair::new(pair[0], pair[1]).with_reach(3.0), Degree::One).unwrap();
        let i = usize::from(pair[1] == "above.bottom");
        let share = covered(&mesh, "above.bottom", &pieces, i);
        assert_eq!(pieces.len(), 2, "{pieces:?}");
        let ends: Vec<f64> =
            pieces.iter().flat_map(|piece| on_chord(&mesh, &piece.sides[i])).map(|x| x.x).collect();
        // Equally near is the middle of the valley; the block is as wide as from -1.4 to 1.6.
        let middle = ends.iter().map(|x| x.abs()).fold(f64::INFINITY, f64::min);
        assert!(middle < 1e-8, "{ends:?}");
        assert!(share[0] > 0.9, "{share:?}");
    }
}

#[test]
fn many_edges_that_face_each_other_across_little_are_looked_at_a_few_times() {
    let n = 3000;
    let (lower, upper) = (block([0.0, 0.0], [1.0, 1.0]), block([0.0, 1.0], [1.0, 2.0]));
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let mesh = mesh(&[body("lower", n, &lower), body("upper", n + 1, &upper)]);
    let pieces = found(&mesh, &Pair::new("lower.top", "upper.bottom"), Degree::Two).unwrap();
    assert_eq!(pieces.len(), 2 * n);
}

fn refused(bodies: &[Body], pair: Pair) -> String {
    found(&mesh(bodies), &pair, Degree::One).unwrap_err().to_string()
}

#[test]
fn what_is_no_pair_is_refused_with_its_place() {
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let lower = block([0.0, 0.0], [1.0, 1.0]);
    let pair = || Pair::new("lower.top", "upper.bottom");
    let upper = block([0.0, 2.0], [1.0, 3.0]);
    let two = [body("lower", 2, &lower), body("upper", 3, &upper)];
    assert_eq!(
        refused(&two, pair()),
        "the boundaries of the pair of 'lower.top' and 'upper.bottom' face each other nowhere within the reach of 0.25: they come closest at (0, 1) and (0, 2), 1 apart; expected outward normals that are opposite there, and a reach above the gap"
    );
    assert_eq!(found(&mesh(&two), &pair().with_reach(1.5), Degree::One).unwrap().len(), 4);
    assert_eq!(
        refused(&two, Pair::new("lower.top", "lower.top")),
        "the pair of 'lower.top' with itself; expected two boundaries"
    );
    assert_eq!(
        refused(&two, pair().with_reach(-1.0)),
        "the reach of the pair of 'lower.top' and 'upper.bottom' is -1; expected a positive length"
    );
    assert_eq!(
        refused(&two, Pair::new("lower.top", "lower.right")),
        "the boundaries of the pair of 'lower.top' and 'lower.right' share the vertex at (1, 1): there the bodies are one; expected a mesh in which each body has vertices of its own (surfaces = [..] in place of boundaries splits the mesh along the curve between two surfaces)"
    );
    // Two wedges, tip to tip.
    let below = |[s, t]: [f64; 2]| {
        let x = 2.0 * s - 1.0;
        [x, -2.0 * x.abs() * t - 4.0 * (1.0 - t)]
    };
    let above = |[s, t]: [f64; 2]| {
        let x = 2.0 * s - 1.0;
        [x, 0.1 + 2.0 * x.abs() * (1.0 - t) + 4.0 * t]
    };
    let wedges = [body("lower", 2, &below), body("upper", 2, &above)];
    assert_eq!(
        refused(&wedges, pair()),
        "in the pair of 'lower.top' and 'upper.bottom' the corner at (0, 0) meets the corner at (0, 0.1): neither faces a side of the other, and contact between them has no direction; expected a corner that is rounded, or a boundary that goes on beside it"
    );
}

/// One side of each of two corners faces the other corner, whatever the second side does.
#[test]
fn a_corner_one_side_of_which_faces_the_other_body_is_not_alone() {
    let squares =
        [[[0.0, -1.0], [1.0, 0.0]], [[-1.0, 0.1], [0.0, 1.1]], [[-1.0, -0.5], [-0.5, 0.0]]];
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for [[left, low], [right, high]] in squares {
        let k = vertices.len();
        vertices.extend([[left, low], [right, low], [right, high], [left, high]]);
        triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    }
    // The top and the left side of the first square, the bottom and the right side of the second one, the top of the third.
    let pieces = |below: &[[usize; 2]]| {
        let named = [("below", below.to_vec()), ("above", vec![[4, 5], [5, 6]])];
        let named = named.map(|(name, edges)| (name.to_owned(), edges));
        let mesh = Mesh::of_edges(vertices.clone(), triangles.clone(), named.into(), &|_, _| true);
        let pair = Pair::new("below", "above").with_reach(0.2);
        found(&mesh.unwrap(), &pair, Degree::One).map(|pieces| pieces.len())
    };
    assert_eq!(pieces(&[[2, 3], [3, 0], [10, 11]]).unwrap(), 1);
    // The control: without the side that faces it the corner is alone.
    let alone = pieces(&[[3, 0], [10, 11]]).unwrap_err().to_string();
    assert!(alone.contains("the corner at (0, 0) meets the corner at (0, 0.1)"), "{alone}");
}

#[test]
fn the_reach_is_bounded_by_the_curvature_and_by_the_bodies() {
    let inner = ring([0.1, 0.5], [0.0, PI], 0.0, 0.0);
    let outer = ring([0.6, 5.0], [0.0, PI], 0.0, 0.0);
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let mesh = mesh(&[body("inner", 20, &inner), body("outer", 24, &outer)]);
    let smooth = SmoothBoundary::new(&mesh);
    let pair = Pair::new("inner.top", "outer.bottom");
    let reach = pair.reach_on(&mesh, &smooth).unwrap();
    assert_abs_diff_eq!(reach, 0.25, epsilon = ROUNDING);
    let small = Pair::new("inner.bottom", "outer.bottom");
    let reach = small.reach_on(&mesh, &smooth).unwrap();
    assert_abs_diff_eq!(reach, 0.1, epsilon = ROUNDING);
    assert!(pair.clone().with_reach(0.74).reach_on(&mesh, &smooth).is_ok());
    let error = pair.with_reach(0.76).reach_on(&mesh, &smooth).unwrap_err().to_string();
    assert!(
        error.starts_with(
            "the reach of the pair of 'inner.top' and 'outer.bottom' is 0.76, and the boundary at ("
        ) && error.contains("has a radius of 0.5")
            && error.contains("expected a smaller reach"),
        "{error}"
    );
    // One and a half times the radius.
    let Err(DataError::Pair(PairError::TooFar { most, .. })) =
        Pair::new("inner.top", "outer.bottom").with_reach(0.76).reach_on(&mesh, &smooth)
    else {
        panic!("too far");
    };
    assert_abs_diff_eq!(most, 0.75, epsilon = ROUNDING);
}

#[test]
fn the_scale_of_a_pair_is_the_narrower_side_or_the_least_radius() {
    let (lower, upper) = (block([0.0, 0.0], [3.0, 0.5]), block([0.0, 0.5], [2.0, 2.0]));
    let body = |name, map| Body { name, cells: [4, 2], closed: false, map };
    let blocks = mesh(&[body("lower", &lower), body("upper", &upper)]);
    let scale = |mesh: &Mesh, pair: &Pair| pair.scale(mesh, &SmoothBoundary::new(mesh)).unwrap();
    let pair = Pair::new("lower.top", "upper.bottom");
    assert_abs_diff_eq!(scale(&blocks, &pair), 0.5, epsilon = ROUNDING);
    let inner = ring([0.1, 0.3], [0.0, PI], 0.0, 0.0);
    let outer = ring([0.35, 5.0], [0.0, PI], 0.0, 0.0);
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let rings = mesh(&[body("inner", 20, &inner), body("outer", 24, &outer)]);
    let pair = Pair::new("inner.bottom", "outer.bottom");
    assert_abs_diff_eq!(scale(&rings, &pair), 0.1, epsilon = ROUNDING);
}

#[test]
fn boundaries_at_an_angle_face_each_other_below_sixty_degrees_only() {
    // The lower side of the upper body leans by the angle.
    let faces = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let lower = block([0.0, 0.0], [1.0, 1.0]);
        let upper =
            move |[s, t]: [f64; 2]| [0.1 + cosine * s - sine * t, 1.02 + sine * s + cosine * t];
        let body = |name, map| Body { name, cells: [3, 3], closed: false, map };
        let mesh = mesh(&[body("lower", &lower), body("upper", &upper)]);
        let pair = Pair::new("lower.top", "upper.bottom").with_reach(1.0);
        found(&mesh, &pair, Degree::One).is_ok_and(|pieces| !pieces.is_empty())
    };
    assert!(faces(0.0) && faces(30.0) && faces(55.0));
    assert!(!faces(65.0) && !faces(80.0));
}

#[test]
fn bodies_touch_where_they_are_no_further_apart_nor_overlap_further_than_edges_are_long() {
    let touches = |low: f64| {
        let lower = block([0.0, 0.0], [4.0, 4.0]);
        let upper = block([0.0, low], [4.0, low + 4.0]);
        let body = |name, map| Body { name, cells: [8, 8], closed: false, map };
        let mesh = mesh(&[body("lower", &lower), body("upper", &upper)]);
        !touching(&mesh, &[Pair::new("lower.top", "upper.bottom")]).is_empty()
    };
    // Edges are 1/2 long, the reach is 1.
    assert!(touches(4.0) && touches(4.4) && touches(3.6));
    assert!(!touches(4.6) && !touches(3.4) && !touches(3.1));
}

#[test]
fn quarters_of_rings_face_each_other_up_to_their_ends() {
    let inner = ring([1.0, 2.002], [0.0, FRAC_PI_2], 0.0, 0.0);
    let outer = ring([1.998, 3.0], [0.0, FRAC_PI_2], 0.0, 0.0);
    // Nodes at the same angle are one: both ends, and each eighth of 32 and each eleventh of 44.
    for ([m, n], count) in [([8, 11], 18), ([32, 32], 32), ([32, 44], 72)] {
        let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
        let mesh = mesh(&[body("inner", m, &inner), body("outer", n, &outer)]);
        let pieces = found(&mesh, &Pair::new("inner.top", "outer.bottom"), Degree::Two).unwrap();
        assert_eq!(pieces.len(), count, "{m}, {n}");
        for (i, name) in ["inner.top", "outer.bottom"].into_iter().enumerate() {
            for share in covered(&mesh, name, &pieces, i) {
                assert_abs_diff_eq!(share, 1.0, epsilon = ROUNDING);
            }
        }
    }
}

#[test]
fn pairs_are_given_once_and_their_boundaries_have_no_other_condition() {
    let (lower, upper) = (block([0.0, 0.0], [1.0, 1.0]), block([0.0, 1.1], [1.0, 2.0]));
    let body = |name, nx, map| Body { name, cells: [nx, 1], closed: false, map };
    let mesh = mesh(&[body("lower", 2, &lower), body("upper", 3, &upper)]);
    let material = Material::young_poisson(1.0, 0.3, Plane::Strain);
    let problem =
        || Problem::of(mesh.clone(), material).with_pair(Pair::new("lower.top", "upper.bottom"));
    let all =
        |problem: &Problem| of_problem(problem, &SmoothBoundary::new(&problem.mesh), Degree::One);
    assert_eq!(all(&problem()).unwrap()[0].len(), 4);
    let twice = problem().with_pair(Pair::new("upper.bottom", "lower.top"));
    assert_eq!(
        all(&twice).unwrap_err().to_string(),
        "the pair of 'upper.bottom' and 'lower.top' is given twice; expected each pair once"
    );
    let occupied = problem().with("lower.top", Condition::clamped());
    assert_eq!(
        all(&occupied).unwrap_err().to_string(),
        "the boundary 'lower.top' has a condition and is in the pair of 'lower.top' and 'upper.bottom'; expected one of the two (contact is what the pair says)"
    );
}
