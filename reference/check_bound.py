#!/usr/bin/env python3
"""A second checker of certificates, written from docs/certificates.md, "The files", alone; numpy is all it needs.

    python3 reference/check_bound.py CERTIFICATE.json [...]

It reads certificate.json and the arrays beside it, verifies the conditions of the theorem (docs/a-posteriori.md, 7.2) in doubles
with room for rounding, and evaluates the bound with a stress of its own: on each of the three parts of a triangle of degree
2, and of all stresses with the forces of the file the one that is nearest to C eps(v). So what it finds is at most what
`signorini audit` finds, and it shares no formula of stresses with that. Likewise for the forces that a certificate has, which lie
between numbers that are no further apart. Exit code 0 if every certificate is accepted, else 1.
"""
import json
import pathlib
import sys

import numpy as np

WORDS = {"vertices": "ff", "displacement": "ff", "prescribed": "nfnf", "cuts": "nnf", "triangles": "nnnnnnfffffffff",
         "tensors": "ffffff",
         "edges": "nnnffff", "directions": "nffff", "laws": "nnffff", "frames": "nff", "displacement at cuts": "ff",
         "prescribed at cuts": "nfnf", "bulges": "ffff", "lifts": "nnnf", "polygon": "n", "pairs": "nn", "shares": "f",
         "boundaries": "nn", "forces": "nnnfffff", "w": "ff", "w at cuts": "ff", "w bulges": "ff",
         "dual forces": "nff", "dual w": "ff", "dual w at cuts": "ff", "dual w bulges": "ff", "dual edges": "nffff"}
STATEMENT = "|u - v|_a <= bound for the solution u of the contact problem with these data and the displacement v"
NEAR = 1e-11  # relative room for rounding
STOP = 1e-10  # what a support against a free motion may take, in parts of the forces on the boundary


class Refused(Exception):
    """Why a certificate is not accepted."""


def demand(holds, problem):
    """Refuses where `holds` is false anywhere, and says where first."""
    holds = np.asarray(holds)
    if not holds.all():
        raise Refused(f"{problem} ({np.argmin(holds)})" if holds.ndim else problem)


def hash_of(data):
    words = np.frombuffer(data, "<u8").tolist()
    found = 0xCBF29CE484222325
    for word in words:
        found = ((found ^ word) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return f"{found:016x}"


def read(path):
    """The header, and whole numbers and doubles of each array: an entry a row."""
    header = json.loads(path.read_text())
    demand(header["format"] == 10, f"format {header['format']}; expected 10")
    keys = {"format", "title", "statement", "degree", "bound", "arrays", "hash"}
    demand(keys <= set(header) <= keys | {"boundaries", "thickness"}, "an unknown key")
    demand(header["statement"] == STATEMENT, "it states something else")
    demand(header["degree"] in (1, 2), "a degree other than 1 and 2")
    data = path.with_name("certificate.bin").read_bytes()
    demand(len(data) % 8 == 0 and hash_of(data) == header["hash"], "the hash is another")
    words, at = np.frombuffer(data, "<u8"), 0
    whole = {name: np.zeros((0, kinds.count("n")), int) for name, kinds in WORDS.items()}
    real = {name: np.zeros((0, kinds.count("f"))) for name, kinds in WORDS.items()}
    seen = set()
    for array in header["arrays"]:
        name, kinds, entries = array["name"], array["words"], array["entries"]
        demand(WORDS.get(name) == kinds and name not in seen, f"an unknown or second array {name!r}")
        seen.add(name)
        block = words[at:at + entries * len(kinds)]
        demand(len(block) == entries * len(kinds), f"{name} ends too early")
        at += len(block)
        block = block.reshape(entries, len(kinds))
        n = np.array([kind == "n" for kind in kinds])
        demand((block[:, n] < 2**62).all(), f"{name}: a number that names nothing")
        whole[name] = block[:, n].astype(int)
        real[name] = np.ascontiguousarray(block[:, ~n]).view("<f8")
        demand(name == "dual forces" or np.isfinite(real[name]).all(), f"{name}: a number is not finite")
    demand(at == len(words), "words that no array has")
    of_forces = "boundaries" in header or seen & {name for name in WORDS if "w" in name.split() or name.startswith(("dual", "bound"))}
    demand("forces" in seen or not of_forces, "what proves forces, without forces")
    return header, whole, real


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def dot(a, b):
    return (a * b).sum(-1)


def turned(d):
    """d turned to the left."""
    return np.stack([-d[..., 1], d[..., 0]], -1)


def nearest(v, d, w):
    """The vector nearest to v with v . d = w."""
    return v - d * ((dot(v, d) - w) / dot(d, d))[:, None]


def along(v, d):
    """v . d on edges for v of degree 2 and d affine, by Bernstein coefficients."""
    found = np.zeros((len(v), 4))
    for i in range(3):
        for k in range(2):
            found[:, i + k] += [1, 2, 1][i] / [1, 3, 3, 1][i + k] * dot(v[:, i], d[:, k])
    return found


def stiffness(moduli, tensors):
    """C by its action on (e_xx, e_yy, 2 e_xy), of each triangle: from lambda and mu, or from a tensor where mu is 0."""
    lam, mu = moduli.T
    whole = np.zeros((len(moduli), 3, 3))
    whole[:, 0, 0] = whole[:, 1, 1] = lam + 2 * mu
    whole[:, 0, 1] = whole[:, 1, 0] = lam
    whole[:, 2, 2] = mu
    given = mu == 0
    number = lam[given].astype(int)
    demand((number == lam[given]) & (0 <= number) & (number < len(tensors)), "no such tensor: triangle")
    whole[given] = tensors[number][:, [[0, 1, 2], [1, 3, 4], [2, 4, 5]]]
    demand(np.linalg.eigvalsh(whole).min(1) > 0, "a law that is not positive definite: triangle")
    return whole


def friction(w, shear, bound):
    """int s |w| + q w over [0, 1], for w with these Bernstein coefficients of degree 3 and affine q and s with these values at the ends."""
    power = np.array([[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 3, 0, 0], [1, 0, 0, 0]]) @ w
    roots = np.roots(power) if power.any() else np.zeros(0)
    inside = roots.real[(np.abs(roots.imag) <= 1e-9) & (0 < roots.real) & (roots.real < 1)]
    breaks = np.unique(np.concatenate([[0, 1], inside]))
    x, weights = np.polynomial.legendre.leggauss(4)
    found = 0.0
    for a, b in zip(breaks, breaks[1:]):
        s = a + (b - a) * (x + 1) / 2
        values = np.polyval(power, s)
        q, most = (k[0] + (k[1] - k[0]) * s for k in (shear, bound))
        found += (b - a) / 2 * (weights * (most * np.abs(values) + q * values)).sum()
    return found


def tied(own, other, d, glued, jump, given=np.zeros(2, bool)):
    """A displacement on the first of two tied bodies, from that on the second one and what it is to be beyond that; where d is oblique
    and one component is given, the other one is moved."""
    axis = ((np.abs(d) == 1) & (d[:, ::-1] == 0)).any(1)
    along = np.where((d != 0) & axis[:, None], other + d * jump[:, :1], own)
    moved = np.where(given & ~axis[:, None], 0, d)
    step = (dot(own - other, d) - jump[:, 0]) / np.where(axis | (moved == 0).all(1), 1, dot(moved, d))
    slides = np.where(axis[:, None], along, own - moved * step[:, None])
    return np.where(glued[:, None], other + jump, slides)


def tied_between(own, other, d, glued, ends, jump, gap):
    """The bulge on the first of two tied bodies: where d turns the jump with these values at the ends has the one with which the product with
    d is the gap, with these values at the ends, and this bulge, all along the edge: two equations for its middle Bernstein coefficient."""
    found = tied(own, other, d[:, 0], glued, jump)
    on = (d[:, 0] != d[:, 1]).any(1)
    d, ends, gap, bulge = d[on], ends[on], gap[on], jump[on, 0]
    right = (gap + gap.sum(1)[:, None] + 4 * bulge[:, None] - dot(ends, d[:, ::-1])) / 2
    found[on] = other[on] + (np.linalg.solve(d, right[:, :, None])[:, :, 0] - ends.mean(1)) / 2
    return found


class Body:
    """What a certificate is of, by its arrays."""

    def __init__(self, header, whole, real):
        self.quadratic = header["degree"] == 2
        vertices, cuts = real["vertices"], whole["cuts"]
        count = len(vertices)
        demand(all(len(real[name]) == count for name in ("displacement", "prescribed")), "arrays of other lengths")
        demand((cuts < count).all() and ((0 < real["cuts"]) & (real["cuts"] < 1)).all(), "a cut that lies nowhere")

        def with_cuts(values):
            a, b = values[cuts[:, 0]], values[cuts[:, 1]]
            return np.concatenate([values, a + (b - a) * real["cuts"]])

        self.x = with_cuts(vertices)
        self.corners, self.sides = whole["triangles"][:, :3], whole["triangles"][:, 3:]
        self.body, self.oscillation = real["triangles"][:, 2:8].reshape(-1, 3, 2), real["triangles"][:, 8]
        self.stiffness = stiffness(real["triangles"][:, :2], real["tensors"])
        self.ends, self.role = whole["edges"][:, :2], whole["edges"][:, 2]
        self.numbers = real["edges"].reshape(-1, 2, 2)
        edges = len(self.ends)
        demand(len(self.corners) > 0 and (self.corners < len(self.x)).all() and (self.sides < edges).all()
               and (self.ends < len(self.x)).all() and (self.role < 9).all(), "an index that names nothing")
        demand(self.oscillation >= 0, "a negative oscillation: triangle")
        self.direction = np.zeros((edges, 2, 2))
        self.has_direction = np.zeros(edges, bool)
        along = whole["directions"][:, 0]
        demand((along < edges).all() and len(set(along)) == len(along) and np.isin(self.role[along], (6, 7)).all(),
               "a direction of no edge")
        self.direction[along] = real["directions"].reshape(-1, 2, 2)
        self.has_direction[along] = True
        supported = self.role == 7
        length = dot(self.direction[:, 0], self.direction[:, 0])
        demand(~supported | ((self.direction[:, 0] == self.direction[:, 1]).all(1) & (length >= 0.25) & (length <= 4)),
               "a direction that turns or has no length: edge")
        pairs = whole["pairs"]
        demand((pairs < edges).all() and (self.role[pairs] == [6, 8]).all() and self.has_direction[pairs[:, 0]].all()
               and len(set(pairs[:, 0])) == len(pairs) and np.array_equal(np.sort(pairs[:, 1]), np.flatnonzero(self.role == 8))
               and (self.numbers[self.role == 8] == 0).all(), "edges that do not face each other one to one")
        self.pairs, self.facing = pairs, np.full(edges, -1)
        self.facing[pairs[:, 0]] = pairs[:, 1]
        self.laws(whole["laws"], real["laws"].reshape(-1, 2, 2))
        self.frames(whole, real, with_cuts)
        demand(len(real["shares"]) == len(self.corners), "shares of other triangles")
        self.shares = real["shares"][:, 0]
        demand((whole["lifts"] < count).all() and (real["lifts"] >= 0).all()
               and len({tuple(sorted(t)) for t in whole["lifts"].tolist()}) == len(whole["lifts"]), "lifts of no triangles")
        self.lift = real["lifts"][:, 0]
        demand((whole["polygon"] < edges).all(), "a polygon of no edges")
        self.polygon = whole["polygon"][:, 0]

    def laws(self, whole, real):
        """Of each edge 1 where two bodies slide and do not open, 2 where they are glued, 3 with friction; q; and the jump across the
        direction, or the bound of friction."""
        edges, on = len(self.ends), whole[:, 0]
        demand((on < edges).all() and len(set(on)) == len(on) and (self.role[on] == 6).all() and np.isin(whole[:, 1], (1, 2, 3)).all()
               and (real[whole[:, 1] == 1] == 0).all(), "a law of no edge")
        self.law, (self.shear, self.beside) = np.zeros(edges, int), np.zeros((2, edges, 2))
        self.law[on], self.shear[on], self.beside[on] = whole[:, 1], real[:, 0], real[:, 1]
        demand((self.law != 3) | (np.abs(self.shear) <= self.beside).all(1), "friction beyond its bound: edge")
        self.tied = np.isin(self.law, (1, 2))
        d = self.direction
        demand(~self.tied | ((self.facing >= 0) & self.quadratic), "bodies that are tied in no way: edge")
        demand((self.law != 2) | (d == [1, 0]).all((1, 2)), "glue along another direction than x: edge")
        turns, length = (d[:, 0] != d[:, 1]).any(1), dot(d, d)
        demand((self.law != 1) | ~turns | (cross(d[:, 0], d[:, 1]) != 0) & ((length >= 0.25) & (length <= 4)).all(1),
               "bodies that slide along a direction that turns by nothing, or has no length: edge")

    def tie(self):
        """v on the first bodies of tied pairs, from v on the second ones."""
        on = np.flatnonzero(self.tied)
        own, other = self.ends[on].ravel(), self.ends[self.facing[on]][:, ::-1].ravel()
        d, glued = self.direction[on].reshape(-1, 2), np.repeat(self.law[on] == 2, 2)
        jump = np.stack([self.numbers[on, 1], np.where(self.law[on, None] == 2, self.beside[on], 0)], 2).reshape(-1, 2)
        rows = np.unique(np.column_stack([own, other, d, glued, jump]), axis=0)
        demand(len(rows) == len(set(own)) and not set(own) & set(other), "a point that is tied to two places")
        demand(not self.frame[own].any(), "a tied point with a frame")
        axis = (np.abs(d) == 1) & (d[:, ::-1] == 0)
        # Where a component is prescribed, the jump is exactly 0.
        moved = glued[:, None] | (d != 0)
        least = np.where(glued[:, None], jump, jump[:, :1])
        exact = ~moved | ((least == 0) & ~self.frame[other].any(1)[:, None])
        # Along an oblique direction the other component is moved, if that is not prescribed.
        across = ~(glued | axis.any(1) | self.given[own].all(1))[:, None]
        exact, same = exact | across, (self.v[other] == self.value[own]) | across
        demand((exact | ~self.given[own]).all(1), "a tied point at a place that is prescribed")
        demand(~moved | ~self.given[own] | same, "a tied point off what is prescribed: point")
        self.v = v = self.v.copy()
        v[own] = tied(v[own], v[other], d, glued, jump, self.given[own])
        bulge, facing, ends = self.bulge, self.facing[on], (v[own] - v[other]).reshape(-1, 2, 2)
        bulge[on] = tied_between(bulge[on], bulge[facing], self.direction[on], self.law[on] == 2, ends, self.data[on], self.numbers[on, 1])

    def frames(self, whole, real, with_cuts):
        """v, and what is prescribed at points, along the axes or along the direction of a frame."""
        v, given, value = real["displacement"], whole["prescribed"], real["prescribed"]
        edges = len(self.ends)
        self.bulge, self.data = np.zeros((2, edges, 2))
        if self.quadratic:
            cuts = len(whole["cuts"])
            demand(len(real["displacement at cuts"]) == len(real["prescribed at cuts"]) == cuts
                   and len(real["bulges"]) == edges, "arrays of other lengths")
            v = np.concatenate([v, real["displacement at cuts"]])
            given = np.concatenate([given, whole["prescribed at cuts"]])
            value = np.concatenate([value, real["prescribed at cuts"]])
            self.bulge, self.data = real["bulges"][:, :2].copy(), real["bulges"][:, 2:]
        demand((given <= 1).all() and (value[given == 0] == 0).all(), "a prescribed value is neither there nor not")
        self.given, self.value, self.frame = given.astype(bool), value, np.zeros_like(v)
        points, d = whole["frames"][:, 0], real["frames"]
        demand((points < len(v)).all() and len(set(points)) == len(points) and (d != 0).all()
               and (given[points] == [1, 0]).all(), "a frame of no point")
        self.frame[points] = d
        v = v.copy()
        v[points] = nearest(v[points], d, value[points, 0])
        self.v_own = v
        self.v = v if self.quadratic else with_cuts(v)
        oblique = (self.role == 7) & (self.direction[:, 0] != 0).all(1)
        if self.quadratic:
            self.bulge[oblique] = nearest(self.bulge[oblique], self.direction[oblique, 0], self.data[oblique, 0])
        if self.tied.any():
            self.tie()

    def check_edges(self):
        """Triangles run counter-clockwise and meet at their edges: inner edges have one on each side, others one on the left."""
        x = self.x[self.corners]
        self.area = cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) / 2
        demand(self.area > 0, "a triangle that does not run counter-clockwise")
        owners = np.zeros((len(self.ends), 2), int)
        self.left = np.zeros(self.sides.shape, bool)
        self.owner = np.zeros(len(self.ends), int)
        right = np.zeros(len(self.ends), int)
        for i in range(3):
            seen = self.corners[:, [(i + 1) % 3, (i + 2) % 3]]
            ends = self.ends[self.sides[:, i]]
            self.left[:, i] = (seen == ends).all(1)
            demand(self.left[:, i] | (seen == ends[:, ::-1]).all(1), "a side that joins other points: triangle")
            np.add.at(owners, (self.sides[:, i], 1 - self.left[:, i].astype(int)), 1)
            here = self.left[:, i]
            self.owner[self.sides[here, i]] = np.flatnonzero(here)
            right[self.sides[~here, i]] = np.flatnonzero(~here)
        demand(owners == np.stack([np.ones(len(owners)), self.role == 0], 1), "triangles on the sides: edge")

        # The number of the first triangle of each part that inner edges join.
        self.part, joined = np.arange(len(self.corners)), np.stack([self.owner, right])[:, self.role == 0]
        before = None
        while before is None or (self.part != before).any():
            before = self.part.copy()
            least = self.part[joined].min(0)
            for side in joined:
                np.minimum.at(self.part, side, least)
            self.part = self.part[self.part]

    def check_prescribed(self):
        """v is what is prescribed at and between the ends of edges that are held, and nothing is prescribed elsewhere."""
        held = np.stack([np.isin(self.role, (1, 3)), np.isin(self.role, (2, 3))], 1)
        axis = (self.role == 7) & (self.direction[:, 0] == 0).any(1)
        held[axis] |= self.direction[axis, 0] != 0
        oblique = (self.role == 7) & ~axis
        own = self.ends < len(self.v_own)
        demand(own.all(1) | ~(held.any(1) | oblique), "an end without a value: edge")
        at, free = np.where(own, self.ends, 0), (self.frame == 0).all(1)
        everywhere = np.zeros_like(self.given)
        for k in range(2):
            point = at[:, k]
            for c in range(2):
                here = held[:, c]
                demand(~here | (free[point] & self.given[point, c]), "an end without a prescribed value: edge")
                demand(~here | (self.v_own[point, c] == self.value[point, c]), "v is not what is prescribed at an end: edge")
                everywhere[point[here], c] = True
            same = (self.frame[point] == self.direction[:, 0]).all(1)
            full = free[point] & self.given[point].all(1)
            demand(~oblique | same | full, "an end without a value along the direction: edge")
            demand(~(oblique & full) | (self.v_own[point] == self.value[point]).all(1), "v is not what is prescribed: edge")
            everywhere[point[oblique & same], 0] = True
            # Two directions hold all.
            everywhere[point[oblique & full]] = True
        demand((everywhere | ~self.given).all(1), "a value that is prescribed off Gamma_D: point")
        if self.quadratic:
            between = (self.bulge == self.data) | ~held
            demand(between.all(1) | (self.role == 7), "v is not what is prescribed between the ends: edge")
            d, along = self.direction[:, 0], dot(self.direction[:, 0], self.bulge)
            size = np.abs(d * self.bulge).sum(1) + np.abs(self.data[:, 0])
            demand((self.role != 7) | (np.abs(along - self.data[:, 0]) <= NEAR * size), "v . d is not what is prescribed: edge")
            may = np.where((self.role <= 3)[:, None], held, np.stack([np.isin(self.role, (6, 7)), self.law == 2], 1))
            demand((may | (self.data == 0)).all(1), "a bulge of data where there are none: edge")

    def jump(self, on, points, bulge):
        """A displacement at the ends of edges of Gamma_C and its bulges: on a pair less those on the other body, whose edge runs the
        other way."""
        w, b, other = points[self.ends[on]], bulge[on], self.facing[on]
        pair = other >= 0
        w[pair] -= points[self.ends[other[pair]]][:, ::-1]
        b[pair] -= bulge[other[pair]]
        return w, b

    def check_contact(self):
        """No tension, no penetration; 2 int tau_n (v . d - g) for each edge."""
        on = np.flatnonzero(self.role == 6)
        pressure, gap = self.numbers[on, 0], self.numbers[on, 1]
        tied = self.tied[on, None]
        demand((pressure <= 0) | tied, "a tension on Gamma_C: number")
        side = self.x[self.ends[on, 1]] - self.x[self.ends[on, 0]]
        length = np.sqrt(dot(side, side))
        d = np.where(self.has_direction[on, None, None], self.direction[on], (-turned(side) / length[:, None])[:, None])
        shear = self.shear[on]
        turns, varies = (d[:, 0] != d[:, 1]).any(1), (pressure[:, 0] != pressure[:, 1]) | (shear[:, 0] != shear[:, 1])
        demand(~(turns & varies & self.has_direction[on]), "a pressure that varies along a direction that turns: edge")
        v, b = self.jump(on, self.v, self.bulge)
        bulge = self.data[on, 0]
        # v and g by their Bernstein coefficients of degree 2, d by its two; the product is of degree 3.
        v = np.stack([v[:, 0], v.mean(1) + 2 * b, v[:, 1]], 1)
        g = np.stack([gap[:, 0], gap.mean(1) + 2 * bulge, gap[:, 1]], 1)
        beyond = along(v, d) - along(g[:, :, None], np.ones((len(on), 2, 1)))
        size = np.abs(v).max((1, 2)) + np.abs(g).max(1) + (self.facing[on] >= 0) * np.abs(self.v).max()
        demand((beyond <= NEAR * size[:, None]) | tied, "v goes through the obstacle on Gamma_C: number")
        # Bernstein coefficients of the product with the pressure, of degree 4, whose mean is its integral.
        integral = np.zeros(len(on))
        for i in range(4):
            for k in range(2):
                integral += [1, 3, 3, 1][i] / [1, 4, 6, 4, 1][i + k] * beyond[:, i] * pressure[:, k] / 5
        integral[self.tied[on]] = 0
        for k in np.flatnonzero(self.law[on] == 3):
            integral[k] += friction(along(v[k:k + 1], turned(d[k:k + 1]))[0], shear[k], self.beside[on[k]])
        self.on_contact = np.zeros(len(self.corners))
        np.add.at(self.on_contact, self.owner[on], 2 * length * integral)
        self.turning = int((turns & self.has_direction[on]).sum())
        self.contact, self.contact_d, self.gap = on, d, np.maximum(-beyond, 0)

    def forces(self):
        """tau N on the sides of the triangles, towards their outside."""
        side = self.x[self.ends[:, 1]] - self.x[self.ends[:, 0]]
        length, normal = np.sqrt(dot(side, side))[:, None, None], -turned(side)[:, None]
        force = self.numbers.copy()
        free = np.stack([np.isin(self.role, (1, 3)), np.isin(self.role, (2, 3))], 1)
        demand(((force == 0).all(1) | free | ~np.isin(self.role, (1, 2, 3))[:, None]).all(1), "a force where nothing is held: edge")
        loaded, pressed, supported = (self.role == k for k in (4, 5, 7))
        force[loaded] *= length[loaded]
        demand(~pressed | (self.numbers[:, 1] == 0).all(1), "a pressure with more than two numbers: edge")
        force[pressed] = -normal[pressed] * self.numbers[pressed, 0, :, None]
        on = self.contact
        first, second = self.pairs.T
        force[on] = length[on] * self.numbers[on, 0, :, None] * self.contact_d
        force[second] = -force[first][:, ::-1]
        # The part along the direction of contact.
        self.push = force.copy()
        force[on] += length[on] * self.shear[on, :, None] * turned(self.contact_d)
        force[second] = -force[first][:, ::-1]
        d = self.direction[supported]
        force[supported] = (d * self.numbers[supported, 0, :, None]
                            + length[supported] * turned(d) * self.numbers[supported, 1, :, None])
        self.edge_forces, out = force, force[self.sides]
        return np.where(self.left[:, :, None, None], out, -out[:, :, ::-1])

    def check_balance(self, forces):
        """Forces and body force of each triangle balance, to rounding; and what a motion that nothing stops asks of a support."""
        x = self.x[self.corners]
        middle = x.mean(1)
        arm = x - middle[:, None]
        a, b = np.roll(arm, -1, 1), np.roll(arm, -2, 1)
        p, q = forces[:, :, 0], forces[:, :, 1]
        # int l_i x is |T| (middle / 3 + (x_i - middle) / 12).
        total = ((p + q) / 2).sum(1) + self.area[:, None] / 3 * self.body.sum(1)
        moment = ((cross(2 * a + b, p) + cross(a + 2 * b, q)) / 6).sum(1) + self.area / 12 * cross(arm, self.body).sum(1)
        size = np.abs(forces).sum((1, 2, 3)) + 2 * self.area * np.abs(self.body).sum((1, 2))
        # Coordinates of cuts are rounded where they are large.
        off = 1 + np.abs(x).max((1, 2)) / np.sqrt(self.area)
        reach = np.abs(arm).max((1, 2))
        force_room, moment_room = 1e-13 * off * size, 1e-13 * off * size * reach
        self.free, self.stop = 0, 0.0
        for group in self.groups():
            works, origins, lengths, pull = [], {}, {}, 0.0
            for first in group:
                here = self.part == first
                origin = origins[first] = middle[here].mean(0)
                length = lengths[first] = np.abs(middle[here] - origin).max() + reach[here].max()
                pull += np.abs(self.edge_forces[(self.role != 0) & here[self.owner]]).sum()
                turn = (moment[here] + cross(middle[here] - origin, total[here])).sum() / length
                works.append(np.append(total[here].sum(0), turn))
            motions = self.free_motions(group, origins, lengths)
            if len(motions) == 0:
                continue
            work = np.abs(motions @ np.concatenate(works))
            demand(work <= STOP * pull, f"a motion that nothing stops and the forces drive: the part of triangle {group[0]}, motion")
            self.free += len(motions)
            self.stop = max([self.stop, *work / pull] if pull > 0 else [self.stop])
            # The support is one of the first triangle.
            for first in group:
                force_room[first] += STOP * pull
                moment_room[first] += STOP * pull * lengths[first]
        demand(np.abs(total).max(1) <= force_room, "forces that do not balance: triangle")
        demand(np.abs(moment) <= moment_room, "moments that do not balance: triangle")

    def groups(self):
        """The parts that pairs join, each by the number of its first triangle."""
        label = {first: first for first in np.unique(self.part).tolist()}
        ends = self.part[self.owner[self.pairs]].tolist()
        for _ in label:
            for a, b in ends:
                label[a] = label[b] = min(label[a], label[b])
        return [[first for first in label if label[first] == least] for least in sorted(set(label.values()))]

    def free_motions(self, group, origins, lengths):
        """An orthonormal basis of the motions of some parts (of each along x, along y, the turn about its origin times its length) on which
        no force that the edges of their outlines may have more of does work."""
        slot = {first: k for k, first in enumerate(group)}
        outer = np.flatnonzero((self.role != 0) & np.isin(self.part[self.owner], group))
        of = np.array([slot[first] for first in self.part[self.owner[outer]].tolist()], int)
        origin, length = (np.array([kind[first] for first in group])[of] for kind in (origins, lengths))
        start, end = (self.x[self.ends[outer, k]] - origin for k in range(2))
        role, d, f, law = self.role[outer], self.direction[outer, 0], self.push[outer], self.law[outer]

        def wrench(force, turn):
            rows = np.zeros((len(outer), len(group), 3))
            rows[np.arange(len(outer)), of] = np.column_stack([force, turn / length])
            return rows.reshape(len(outer), -1)

        # The edges of pairs; what acts on one body acts on the other, whose edge runs the other way.
        place = np.full(len(self.ends), -1)
        place[outer] = np.arange(len(outer))
        first, second = place[self.pairs].T
        here = first >= 0
        first, second = first[here], second[here]
        both = self.direction[outer]
        both[second] = both[first][:, ::-1]
        d = both[:, 0]
        slides = (law == 1) & (both[:, 0] != both[:, 1]).any(1)
        supports = []
        axes = ((np.isin(role, (1, 3)), np.array([[1.0, 0.0]])), (np.isin(role, (2, 3)), np.array([[0.0, 1.0]])), (role == 7, d),
                (np.isin(law, (1, 2)) & ~slides, d), (law == 2, turned(d)))
        for here, along in axes:
            along = np.broadcast_to(along, start.shape)
            # The same at both ends, and opposite; between tied bodies on both.
            same, opposite = wrench(along, cross((start + end) / 2, along)), wrench(0 * along, cross(end - start, along) / 6)
            same[first], opposite[first] = same[first] - same[second], opposite[first] + opposite[second]
            supports += [same[here], opposite[here]]
        # Where they slide along a direction that turns, p d with one p.
        work = cross(2 * start + end, both[:, 0]) + cross(start + 2 * end, both[:, 1])
        along = wrench(both.mean(1), work / 6)
        along[first] -= along[second]
        supports.append(along[slides])
        at_start = wrench(f[:, 0] / 2, cross(2 * start + end, f[:, 0]) / 6)
        at_end = wrench(f[:, 1] / 2, cross(start + 2 * end, f[:, 1]) / 6)
        at_start[first], at_end[first] = at_start[first] + at_end[second], at_end[first] + at_start[second]
        along = self.direction[outer]
        turns = self.has_direction[outer] & (along[:, 0] != along[:, 1]).any(1)
        may_open = (role == 6) & ~np.isin(law, (1, 2))
        contact = [at[may_open & ~turns] for at in (at_start, at_end)]
        contact.append((at_start + at_end)[may_open & turns])
        rows = [np.zeros((3 * len(group),) * 2)]
        for kind in (np.vstack(supports), np.vstack(contact)):
            largest = np.sqrt((kind**2).sum(1)).max(initial=0)
            rows += [kind / largest] if largest > 0 else []
        _, sizes, basis = np.linalg.svd(np.vstack(rows), full_matrices=False)
        return basis[sizes <= 1e-8 * max(sizes[0], 1e-300)]


# Degree 2 on a triangle by its corners and the middles of the sides opposite them.
CORNERS_MIDDLES = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, .5, .5], [.5, 0, .5], [.5, .5, 0]])
# int of products of these over the area: /180.
MASS = np.array([[6, -1, -1, -4, 0, 0], [-1, 6, -1, 0, -4, 0], [-1, -1, 6, 0, 0, -4],
                 [-4, 0, 0, 32, 16, 16], [0, -4, 0, 16, 32, 16], [0, 0, -4, 16, 16, 32]]) / 180


def values(l):
    """The six functions at barycentric coordinates."""
    l = np.asarray(l, float)
    return np.concatenate([l * (2 * l - 1), [4 * l[1] * l[2], 4 * l[2] * l[0], 4 * l[0] * l[1]]])


def derivatives(l, gradients):
    """Their gradients."""
    rows = [(4 * l[i] - 1) * gradients[i] for i in range(3)]
    rows += [4 * (l[j] * gradients[k] + l[k] * gradients[j]) for j, k in ((1, 2), (2, 0), (0, 1))]
    return np.array(rows)


class Reference:
    """Stresses t = (xx, yy, xy), of degree 2 on each of the three parts of the triangle (0,0), (1,0), (0,1) at its centroid.
    By t -> F t F^T / det F forces tau N become F (t N), div tau = F div t / det F: the conditions are those of each triangle."""

    def __init__(self):
        x = np.array([[0, 0], [1, 0], [0, 1]], float)
        middle = x.mean(0)
        rows, right = [], []
        # Part i has the corners centroid, i + 1, i + 2.
        self.parts = [np.array([middle, x[(i + 1) % 3], x[(i + 2) % 3]]) for i in range(3)]
        # The data: forces at the starts and ends of the sides (12), the body force at the corners (6).
        data = np.eye(18)
        force = lambda i, k: data[4 * i + 2 * k:4 * i + 2 * k + 2]
        body = lambda i: data[12 + 2 * i:14 + 2 * i]

        def traction(i, l, normal):
            n = values(l)
            row = np.zeros((2, 54))
            for a in range(6):
                column = 18 * i + 3 * a
                row[0, column], row[0, column + 2] = n[a] * normal[0], n[a] * normal[1]
                row[1, column + 2], row[1, column + 1] = n[a] * normal[0], n[a] * normal[1]
            return row

        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            side = x[k] - x[j]
            for s in (0, .5, 1):
                rows.append(traction(i, [0, 1 - s, s], [side[1], -side[0]]))
                right.append((1 - s) * force(i, 0) + s * force(i, 1))
                # The cut to corner k: between part i, whose last corner it is, and part j, whose second it is.
                cut = x[k] - middle
                normal = [cut[1], -cut[0]]
                rows.append(traction(i, [1 - s, 0, s], normal) - traction(j, [1 - s, s, 0], normal))
                right.append(np.zeros((2, 18)))
            p = self.parts[i]
            gradients = np.linalg.inv(np.stack([p[1] - p[0], p[2] - p[0]], 1))
            gradients = np.vstack([-gradients.sum(0), gradients])
            for l, f in zip(np.eye(3), (sum(map(body, range(3))) / 3, body(j), body(k))):
                row = np.zeros((2, 54))
                for a, (dx, dy) in enumerate(derivatives(l, gradients)):
                    column = 18 * i + 3 * a
                    row[0, column], row[0, column + 2] = dx, dy
                    row[1, column + 2], row[1, column + 1] = dx, dy
                rows.append(row)
                right.append(-f)
        rows, right = np.vstack(rows), np.vstack(right)
        left, sizes, basis = np.linalg.svd(rows)
        rank = int((sizes > 1e-10 * sizes[0]).sum())
        self.particular = (basis[:rank].T / sizes[:rank]) @ left[:, :rank].T @ right
        self.rows, self.right, self.free = rows, right, basis[rank:].T
        # The places of the nodes in the whole triangle.
        self.places = np.array([[*(1 - y.sum(keepdims=True)), *y] for p in self.parts for y in CORNERS_MIDDLES @ p])


class Stresses:
    """Of a body with forces: C eps of displacements, and C eps(v) - tau for the nearest tau of degree 2. Each is given by numbers whose
    products are those of the energy."""

    def __init__(self, body, forces):
        reference = self.reference = Reference()
        x = body.x[body.corners]
        f = np.stack([x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]], -1)
        j = self.j = np.linalg.det(f)
        inverse = np.linalg.inv(f)
        data = np.concatenate([np.einsum("tab,tikb->tika", inverse, forces).reshape(-1, 12),
                               (j[:, None, None] * np.einsum("tab,tib->tia", inverse, body.body)).reshape(-1, 6)], 1)
        start = data @ reference.particular.T
        missed = np.abs(start @ reference.rows.T - data @ reference.right.T).max(1)
        off = 1 + np.abs(x).max((1, 2)) / np.sqrt(j)
        demand(missed <= 1e-10 * off * (np.abs(data).max(1) + 1e-300), "no stress with these forces: triangle")
        # (xx, yy, xy) of F t F^T / det F.
        a, b, c, d = (f[:, r, s] for r, s in ((0, 0), (0, 1), (1, 0), (1, 1)))
        push = np.array([[a * a, b * b, 2 * a * b], [c * c, d * d, 2 * c * d], [a * c, b * d, a * d + b * c]])
        push = push.transpose(2, 0, 1) / j[:, None, None]
        # grad l by rows.
        self.gradients = np.concatenate([-inverse.sum(1, keepdims=True), inverse], 1)
        # s . C^-1 s = |L^-1 s|^2 with C = L L^T.
        self.weigh = np.linalg.inv(np.linalg.cholesky(body.stiffness))
        self.root = np.linalg.cholesky(MASS).T
        tau = np.einsum("tab,tnb->tna", push, start.reshape(-1, 18, 3))
        apart = self.of(body, body.v, body.bulge) - self.weighed(tau[..., None])[..., 0]
        change = self.weighed(np.einsum("tab,nbk->tnak", push, reference.free.reshape(18, 3, -1)))
        gram = np.einsum("tnk,tnl->tkl", change, change)
        best = np.linalg.solve(gram, np.einsum("tnk,tn->tk", change, apart)[..., None])
        self.apart = apart - np.einsum("tnk,tko->tn", change, best)

    def weighed(self, stress):
        stress = np.einsum("tab,tnbk->tnak", self.weigh, stress).reshape(len(self.j), 3, 6, -1)
        stress = np.einsum("mn,tpnk->tpmk", self.root, stress) * np.sqrt(self.j / 6)[:, None, None, None]
        return stress.reshape(len(self.j), 54, -1)

    def of(self, body, v, bulge):
        """C eps(v) for v at the points, with bulges on the edges."""
        slope = np.einsum("tia,tib->tab", v[body.corners], self.gradients)[:, None]
        bulge = bulge[body.sides]
        for i in range(3):
            k, m = (i + 1) % 3, (i + 2) % 3
            for p, q in ((k, m), (m, k)):
                there = 4 * self.reference.places[:, p]
                slope = slope + there[:, None, None] * (bulge[:, i, :, None] * self.gradients[:, q, None, :])[:, None]
        slope = np.broadcast_to(slope, (len(self.j), 18, 2, 2))
        strain = np.stack([slope[..., 0, 0], slope[..., 1, 1], slope[..., 0, 1] + slope[..., 1, 0]], -1)
        sigma = np.einsum("tab,tnb->tna", body.stiffness, strain)
        return self.weighed(sigma[..., None])[..., 0]


def reach(eta, k, m):
    """The largest x eta + k (m^2 - x^2) for 0 <= x <= m."""
    if eta >= 2 * k * m:
        return m * eta
    return k * m * m + eta * eta / (4 * k) if np.isfinite(k) else np.inf


class Forces:
    """The forces of a certificate, from what proves them."""

    def __init__(self, header, whole, real, body, stresses):
        self.whole, self.real, self.body, self.stresses = whole, real, body, stresses
        edges, forces = len(body.ends), whole["forces"]
        demand(tuple(forces[0]) == (0, 0, 0), "w0 does not come first")
        self.motion, self.of, self.axis = forces[1:].T
        self.on = np.zeros(edges, int)
        named, boundary = whole["boundaries"].T
        held = np.isin(body.role, (1, 2, 3, 6, 7))
        demand(np.array_equal(np.sort(named), np.flatnonzero(held)), "boundaries of other edges")
        self.on[named] = boundary
        known = (0 < boundary) & (boundary <= len(header["boundaries"]))
        demand(known, "a boundary without a name")
        demand((self.motion <= 3).all() and (0 < self.of).all() and (self.of <= len(header["boundaries"])).all()
               and (self.axis <= 2).all() and (self.axis[self.motion > 0] == 0).all(), "a force of nothing")
        self.foot = real["forces"][1:, :3]
        ramps = self.axis > 0
        demand((self.foot[~ramps] == 0).all() and (self.foot[ramps, 0] <= self.foot[ramps, 1]).all()
               and (self.foot[ramps, 2] > 0).all(), "a weight is none")
        distance = np.sqrt((stresses.apart**2).sum(1)) + body.oscillation
        lift = np.sqrt((body.lift**2).sum())
        self.square = (np.sqrt((distance**2).sum()) + lift) ** 2 / 4 + body.on_contact.sum() / 2
        self.m = np.sqrt(self.square)
        self.loose = (np.sqrt((body.oscillation**2).sum()) + lift) / 2
        self.of_v = stresses.of(body, body.v, body.bulge)
        all_w = list(self.displacements("w", len(forces)))
        points, bulge = all_w[0]
        still = np.zeros((edges, 2, 2))
        points, bulge = self.tie(self.check_supports(points, bulge, still), bulge, still, np.zeros((edges, 2)))
        self.check_supports(points, bulge, still)
        w0 = self.on_contact(points, bulge)
        may_open = ~body.tied[body.contact]
        demand((w0 >= -NEAR * np.abs(points).max()) | ~may_open[:, None], "w0 pulls on Gamma_C: number")
        self.cover, self.cover_force = np.maximum(w0, 0) * may_open[:, None], 0.0
        of_w0 = self.enclose(points, bulge, np.zeros((2, 2)), self.dragged(points, bulge, still))
        self.cover_force = of_w0[1]
        self.found = []
        for force, (points, bulge) in enumerate(all_w[1:]):
            rigid, meant = self.rigid(force), self.on == self.of[force]
            glued = meant & (body.law == 2)
            demand(~(meant & body.tied) | (self.motion[force] > 0) | (~glued & (self.axis[force] == 0)),
                   "a force along the direction where bodies are tied: edge")
            along = dot(rigid, body.direction) if self.motion[force] else np.ones((edges, 2)) * meant[:, None]
            points, bulge = self.tie(self.check_supports(points, bulge, rigid), bulge, rigid, along)
            self.check_supports(points, bulge, rigid)
            dragged = self.dragged(points, bulge, rigid)
            self.found.append(self.enclose(points, bulge, self.missed(force, points, bulge), dragged))
        self.pairs()
        self.found.insert(0, of_w0)

    def displacements(self, name, count):
        """At points, and bulges on edges, of `count` displacements."""
        real, cuts = self.real, self.whole["cuts"]
        vertices, edges = len(real["vertices"]), len(self.body.ends)
        at = real[name]
        demand(len(at) == count * vertices, f"{name} of other vertices")
        curved = len(real[f"{name} bulges"]) > 0
        for key, each in ((f"{name} at cuts", len(cuts)), (f"{name} bulges", edges)):
            demand(len(real[key]) == (count * each if curved else 0), f"{key} of other places")
        for k in range(count):
            v = at[k * vertices:(k + 1) * vertices]
            a, b = v[cuts[:, 0]], v[cuts[:, 1]]
            between = a + (b - a) * real["cuts"]
            bulge = np.zeros((edges, 2))
            if curved:
                own = real[f"{name} at cuts"][k * len(cuts):(k + 1) * len(cuts)]
                between = own if name == "dual w" else between + own
                bulge = real[f"{name} bulges"][k * edges:(k + 1) * edges]
            yield np.concatenate([v, between]), bulge

    def tie(self, points, bulge, rigid, along):
        """w on the first bodies of tied pairs, from w on the second ones and the motion at both ends of the edges."""
        body = self.body
        on = np.flatnonzero(body.tied)
        points, bulge, glued, ends = points.copy(), bulge.copy(), body.law[on] == 2, []
        for k in range(2):
            own, other = body.ends[on, k], body.ends[body.facing[on], 1 - k]
            jump = np.where(glued[:, None], rigid[on, k], np.stack([along[on, k], 0 * along[on, k]], 1))
            points[own] = tied(points[own], points[other], body.direction[on, k], glued, jump, body.given[own])
            ends.append(points[own] - points[other] - rigid[on, k])
        # Beyond a motion the jump is 0 along the direction.
        gap = np.where((rigid[on] != 0).any((1, 2))[:, None], 0, along[on])
        bulge[on] = tied_between(bulge[on], bulge[body.facing[on]], body.direction[on], glued, np.stack(ends, 1), np.zeros((len(on), 2)), gap)
        return points, bulge

    def dragged(self, points, bulge, rigid):
        """int s |chi|, chi being what w misses across the direction of contact where there is friction."""
        body = self.body
        rough = body.law[body.contact] == 3
        on, e = body.contact[rough], turned(body.contact_d[rough])
        w, b = body.jump(on, points, bulge)
        off = rigid[on] - w
        across = along(np.stack([off[:, 0], off.mean(1) - 2 * b, off[:, 1]], 1), e)
        side = body.x[body.ends[on, 1]] - body.x[body.ends[on, 0]]
        works = [friction(c, np.zeros(2), s) for c, s in zip(across, body.beside[on])]
        return (np.sqrt(dot(side, side)) * works).sum() if works else 0.0

    def rigid(self, force):
        """The motion at both ends of the edges where it is meant, 0 on others."""
        x = self.body.x[self.body.ends]
        motion = self.motion[force]
        if motion == 3:
            found = turned(x)
        else:
            found = np.zeros_like(x)
            if motion:
                found[..., motion - 1] = 1
        return found * (self.on == self.of[force])[:, None, None]

    def check_supports(self, points, bulge, motion):
        """w is the affine motion where the body is held; at a point that is held along an oblique direction it is made so."""
        body = self.body
        points = points.copy()
        size = max(np.abs(points).max(), np.abs(motion).max())
        for k in range(2):
            at = body.ends[:, k]
            here = np.flatnonzero((body.role == 7) & (at < len(body.frame)))
            here = here[(body.frame[at[here]] == body.direction[here, 0]).all(1)]
            here = here[(body.frame[at[here]] != 0).any(1)]
            d = body.direction[here, 0]
            points[at[here]] = nearest(points[at[here]], d, dot(motion[here, k], d))
        for off in (points[body.ends[:, 0]] - motion[:, 0], points[body.ends[:, 1]] - motion[:, 1], bulge):
            for c in range(2):
                held = np.isin(body.role, (c + 1, 3))
                demand(~held | (np.abs(off[:, c]) <= NEAR * size), "w is not what it should be where the body is held: edge")
            there = np.abs(dot(off, body.direction[:, 0]))
            demand((body.role != 7) | (there <= NEAR * size), "w is not what it should be along a support: edge")
        return points

    def on_contact(self, points, bulge):
        """w . d on the edges of Gamma_C."""
        body, on = self.body, self.body.contact
        w, b = body.jump(on, points, bulge)
        return along(np.stack([w[:, 0], w.mean(1) + 2 * b, w[:, 1]], 1), body.contact_d)

    def weight(self, force, x):
        if not self.axis[force]:
            return np.ones(x.shape[:-1])
        start, end, width = self.foot[force]
        x = x[..., self.axis[force] - 1]
        return np.clip(np.minimum((x - start) / width + 1, (end - x) / width + 1), 0, 1)

    def missed(self, force, points, bulge):
        """What phi - w . d is at least and at most, in terms of the gap of v, and where that is not enough of w0."""
        body, on = self.body, self.body.contact
        meant = self.on[on] == self.of[force]
        x = body.x[body.ends[on]]
        beyond = np.zeros((2, len(on)))
        if self.motion[force]:
            motion = self.rigid(force)[on]
            phi = along(np.stack([motion[:, 0], motion.mean(1), motion[:, 1]], 1), body.contact_d)
        else:
            ends = self.weight(force, x) * meant[:, None]
            phi = ends @ np.array([[3, 2, 1, 0], [0, 1, 2, 3]]) / 3
            # Between the kinks of a ramp it is affine: what it is beyond its chord is largest there.
            if self.axis[force]:
                start, end, width = self.foot[force]
                a, b = (x[:, k, self.axis[force] - 1] for k in range(2))
                for kink in (start - width, start, end, end + width):
                    inside = meant & (np.minimum(a, b) < kink) & (kink < np.maximum(a, b))
                    s = (kink - a[inside]) / (b - a)[inside]
                    place = np.full((len(s), 2), kink)
                    chord = ends[inside, 0] * (1 - s) + ends[inside, 1] * s
                    off = self.weight(force, place) - chord
                    beyond[0, inside] = np.minimum(beyond[0, inside], off)
                    beyond[1, inside] = np.maximum(beyond[1, inside], off)
        omega = phi - self.on_contact(points, bulge)
        off = np.stack([-(omega + beyond[0][:, None]), omega + beyond[1][:, None]])
        off[off <= NEAR * max(np.abs(phi).max(initial=0), np.abs(points).max())] = 0
        # Between tied bodies w is exact.
        off[:, body.tied[on]] = 0
        # By multiples of the gap, and of w0, for each side; the cheaper one on each edge.
        found = np.zeros((2, 2))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = [np.where(off > 0, off / size, 0).max(2) for size in (body.gap, self.cover)]
        for side in range(2):
            gap, cover = (ratio[side] for ratio in ratios)
            demand(np.isfinite(gap) | np.isfinite(cover), "w is not what it should be on Gamma_C: number")
            with np.errstate(invalid="ignore"):
                by_gap = ~np.isfinite(cover) | (gap * self.square < cover * self.cover_force)
            found[0, side] = gap[by_gap].max(initial=0)
            found[1, side] = cover[~by_gap].max(initial=0)
        return found

    def loads(self, points, bulge):
        """The work of the loads on a displacement, that of the body force apart; and the size of its terms."""
        body = self.body
        w = points[body.corners]
        total, f = w.sum(1, keepdims=True), body.body
        inner = dot(f, total + w).sum(1) / 12 + dot(2 * f.sum(1, keepdims=True) - f, bulge[body.sides]).sum(1) / 15
        inner, size = (body.area * inner).sum(), (body.area * np.abs(inner)).sum()
        given = np.where(np.isin(body.role, (4, 5))[:, None, None], body.edge_forces, 0)
        supported = body.role == 7
        d = body.direction[supported]
        given[supported] = body.edge_forces[supported] - d * body.numbers[supported, 0, :, None]
        on_edges, of_edges = self.work(given, points, bulge)
        return inner, inner + on_edges, size + of_edges

    def work(self, force, points, bulge):
        """Of forces on the edges of the boundary, and the size of its terms."""
        w = points[self.body.ends]
        p, q = force[:, 0], force[:, 1]
        works = (dot(2 * p + q, w[:, 0]) + dot(p + 2 * q, w[:, 1])) / 6 + dot(p + q, bulge) / 3
        works = works[self.body.role > 0]
        return works.sum(), np.abs(works).sum()

    def enclose(self, points, bulge, missed, dragged):
        """Between what the force lies by L(w) - int m : eps(w), and the size of the terms."""
        inner, loads, size = self.loads(points, bulge)
        of_w = self.stresses.of(self.body, points, bulge)
        norm = np.sqrt((of_w**2).sum())
        work, of_work = self.work(self.body.edge_forces, points, bulge)
        energy = self.of_v * of_w
        middle = loads - (energy.sum() + inner + work) / 2
        size += of_work + np.abs(energy).sum()
        away = [reach(norm, missed[0, side], self.m) + missed[1, side] * self.cover_force + dragged + self.loose * norm for side in range(2)]
        return np.array([middle - away[0], middle + away[1], size])

    def pairs(self):
        """What forces lie between by dual pairs."""
        self.of_pairs = []
        forces = self.whole["dual forces"][:, 0]
        demand((forces < len(self.found)).all() and (self.motion[forces] == 0).all(), "a dual pair for no force")
        edges = len(self.body.ends)
        roles, numbers = self.whole["dual edges"][:, 0], self.real["dual edges"]
        demand(len(roles) == len(forces) * edges, "dual edges of other edges")
        for k, (force, (points, bulge)) in enumerate(zip(forces, self.displacements("dual w", len(forces)))):
            here = slice(k * edges, (k + 1) * edges)
            self.of_pairs.append(self.by_pair(force, points, bulge, roles[here], numbers[here]))

    def dual(self, points, bulge, roles, numbers):
        """The pair as a body of its own: without loads, held where the body is held, and on parts of Gamma_C along an axis in which contact acts."""
        body, whole, real = self.body, dict(self.whole), dict(self.real)
        on = np.isin(np.arange(len(roles)), body.contact)
        demand(body.law == 0, "a dual pair beside friction, or bodies that do not open: edge")
        along_axis = np.zeros((len(roles), 2), bool)
        start, end = body.contact_d[:, 0], body.contact_d[:, 1]
        along_axis[body.contact] = (np.abs(start) == 1) & (start == end).all(1)[:, None]
        pressed = on & (((roles == 1) & (along_axis == [True, False]).all(1)) | ((roles == 2) & (along_axis == [False, True]).all(1)))
        free = (roles == 4) & (on | np.isin(body.role, (4, 5)))
        demand(pressed | free | ((roles == body.role) & (roles != 4) & ~on), "a dual edge of another kind: edge")
        demand(~free | (numbers == 0).all(1), "a dual traction where there is none: edge")
        demand((roles != 7) | (numbers[:, 2:] == 0).all(1), "a dual traction across a support: edge")
        v = points if body.quadratic else points[:len(real["vertices"])]
        given, value = body.given.copy(), np.zeros_like(body.value)
        for e in np.flatnonzero(pressed):
            for p in body.ends[e]:
                if p < len(v) and not given[p, roles[e] - 1]:
                    given[p, roles[e] - 1], value[p, roles[e] - 1] = True, v[p, roles[e] - 1]
        count = len(real["vertices"])
        whole["prescribed"], whole["prescribed at cuts"] = given[:count].astype(int), given[count:].astype(int)
        real["prescribed"], real["prescribed at cuts"] = value[:count], value[count:]
        real["displacement"], real["displacement at cuts"] = points[:count], points[count:]
        real["bulges"] = np.concatenate([bulge, 0 * bulge], 1)
        real["triangles"] = np.concatenate([real["triangles"][:, :2], np.zeros((len(body.corners), 7))], 1)
        whole["edges"] = np.concatenate([body.ends, roles[:, None]], 1)
        real["edges"] = numbers
        held = np.isin(whole["directions"][:, 0], np.flatnonzero(roles == 7))
        whole["directions"], real["directions"] = whole["directions"][held], real["directions"][held]
        whole["lifts"], real["lifts"] = np.zeros((0, 3), int), np.zeros((0, 1))
        dual = Body({"degree": 2 if body.quadratic else 1}, whole, real)
        dual.check_edges()
        dual.check_prescribed()
        dual.check_contact()
        return dual, pressed

    def by_pair(self, force, points, bulge, roles, numbers):
        body = self.body
        dual, pressed = self.dual(points, bulge, roles, numbers)
        forces = dual.forces()
        dual.check_balance(forces)
        stresses = Stresses(dual, forces)
        points, bulge = dual.v, dual.bulge
        of_w = stresses.of(dual, points, bulge)
        eta, norm = np.sqrt((stresses.apart**2).sum()), np.sqrt((of_w**2).sum())
        _, loads, size = self.loads(points, bulge)
        energy, product = self.of_v * of_w, self.stresses.apart * stresses.apart
        middle = loads - energy.sum() + product.sum() / 2
        size += np.abs(energy).sum() + np.abs(product).sum()
        # |E| r at both ends of the edges of Gamma_C.
        on = body.contact
        r = dot(dual.edge_forces[on], body.contact_d) * pressed[on, None]
        middle -= (r[:, :1] * body.gap @ np.array([[4], [3], [2], [1]]) + r[:, 1:] * body.gap @ np.array([[1], [2], [3], [4]])).sum() / 20
        side = body.x[body.ends[on, 1]] - body.x[body.ends[on, 0]]
        r = r / np.sqrt(dot(side, side))[:, None]
        r[np.abs(r) <= NEAR * np.abs(r).max(initial=0)] = 0
        with np.errstate(divide="ignore", invalid="ignore"):
            most = [np.where(s * r > 0, s * r / -body.numbers[on, 0], 0).max(initial=0) for s in (-1, 1)]
        missed = self.missed(force, points, bulge)
        loose = 2 * self.loose * (norm + eta / 2)
        away = [reach(eta, max(most[s], missed[0, s]), self.m) + missed[1, s] * self.cover_force + loose for s in range(2)]
        return np.array([middle - away[0], middle + away[1], size])

    def check(self):
        """Verifies what is claimed."""
        claimed = np.concatenate([self.real["forces"][:, 3:], self.real["dual forces"]])
        found = np.array(self.found + self.of_pairs)
        demand(claimed[:, 0] <= claimed[:, 1], "a force between numbers of which the first is the larger: force")
        finite = np.where(np.isfinite(found), found, 0)
        room = 1e-8 * np.abs(finite[:, 1] - finite[:, 0]) + NEAR * finite[:, 2]
        demand((claimed[:, 0] <= found[:, 0] + room) & (found[:, 1] <= claimed[:, 1] + room),
               "a force that is not proved to lie between what is claimed: force")


def check(path):
    """What the certificate proves, in words.

    Raises Refused if it proves less than it says."""
    header, whole, real = read(path)
    body = Body(header, whole, real)
    body.check_edges()
    body.check_prescribed()
    body.check_contact()
    forces = body.forces()
    body.check_balance(forces)
    stresses = Stresses(body, forces)
    found = (np.sqrt((stresses.apart**2).sum(1)) + body.oscillation) ** 2 + body.on_contact
    total = found.sum()
    demand(found <= body.shares * (1 + 1e-8) + 1e-9 * total / len(found), "a share that is larger than the claimed one: triangle")
    bound = np.sqrt(total + (body.lift**2).sum())
    demand(bound <= header["bound"] * (1 + 1e-10), f"the bound is {bound:.6g}; {header['bound']:.6g} is claimed")
    reservations = []
    if (measured := int((body.oscillation > 0).sum())) or len(body.lift):
        reservations.append(f"quadrature in {measured} triangles and for {len(body.lift)} lifts")
    if body.turning:
        reservations.append(f"a direction of contact that turns on {body.turning} edges")
    words = "; ".join(reservations) or "none"
    problem = ["the polygon of the mesh as its body"] if len(body.polygon) else []
    if body.free:
        motions = "a motion" if body.free == 1 else f"{body.free} motions"
        problem.append(f"a support against {motions} that nothing else stops, which takes {body.stop:.0e} of the forces on the boundary")
    of = f"; of the problem with {' and '.join(problem)}" if problem else ""
    count = len(whole["forces"])
    if count:
        Forces(header, whole, real, body, stresses).check()
    return f"bound {bound:.6g}, {bound / header['bound']:.4f} of the claimed one; {count} forces; reservations: {words}{of}"


def main(paths):
    refused = False
    for path in paths:
        try:
            print(f"{path}: accepted: {check(pathlib.Path(path))}")
        except (Refused, OSError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            refused = True
            print(f"{path}: refused: {error}", file=sys.stderr)
    return 1 if refused or not paths else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
