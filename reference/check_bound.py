#!/usr/bin/env python3
"""A second checker of certificates, written from docs/certificates.md, "The files", alone; numpy is all it needs.

    python3 reference/check_bound.py CERTIFICATE.json [...]

It reads certificate.json and the arrays beside it, verifies the conditions of the theorem (docs/theory.md, 7.2) in doubles
with room for rounding, and evaluates the bound with a stress of its own: on each of the three parts of a triangle of degree
2, and of all stresses with the forces of the file the one that is nearest to C eps(v). So what it finds is at most what
`signorini audit` finds, and it shares no formula of stresses with that. Exit code 0 if every certificate is accepted, else 1.
"""
import json
import pathlib
import sys

import numpy as np

WORDS = {"vertices": "ff", "displacement": "ff", "prescribed": "nfnf", "cuts": "nnf", "triangles": "nnnnnnfffffffff",
         "edges": "nnnffff", "directions": "nffff", "frames": "nff", "displacement at cuts": "ff",
         "prescribed at cuts": "nfnf", "bulges": "ffff", "lifts": "nnnf", "polygon": "n", "shares": "f"}
NEAR = 1e-11  # relative room for rounding


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
    demand(header["format"] == 7, f"format {header['format']}; expected 7")
    demand(set(header) == {"format", "title", "statement", "degree", "bound", "arrays", "hash"}, "an unknown key")
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
        demand(np.isfinite(real[name]).all(), f"{name}: a number is not finite")
    demand(at == len(words), "words that no array has")
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
        self.lame, self.body, self.oscillation = real["triangles"][:, :2], real["triangles"][:, 2:8], real["triangles"][:, 8]
        self.body = self.body.reshape(-1, 3, 2)
        self.ends, self.role = whole["edges"][:, :2], whole["edges"][:, 2]
        self.numbers = real["edges"].reshape(-1, 2, 2)
        edges = len(self.ends)
        demand(len(self.corners) > 0 and (self.corners < len(self.x)).all() and (self.sides < edges).all()
               and (self.ends < len(self.x)).all() and (self.role < 8).all(), "an index that names nothing")
        demand(self.lame[:, 1] > 0, "mu > 0 does not hold: triangle")
        demand(self.lame.sum(1) > 0, "lambda + mu > 0 does not hold: triangle")
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
        self.frames(whole, real, with_cuts)
        demand(len(real["shares"]) == len(self.corners), "shares of other triangles")
        self.shares = real["shares"][:, 0]
        demand((whole["lifts"] < count).all() and (real["lifts"] >= 0).all()
               and len({tuple(sorted(t)) for t in whole["lifts"].tolist()}) == len(whole["lifts"]), "lifts of no triangles")
        self.lift = real["lifts"][:, 0]
        demand((whole["polygon"] < edges).all(), "a polygon of no edges")
        self.polygon = whole["polygon"][:, 0]

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

    def check_edges(self):
        """Triangles run counter-clockwise and meet at their edges: inner edges have one on each side, others one on the left."""
        x = self.x[self.corners]
        self.area = cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) / 2
        demand(self.area > 0, "a triangle that does not run counter-clockwise")
        owners = np.zeros((len(self.ends), 2), int)
        self.left = np.zeros(self.sides.shape, bool)
        self.owner = np.zeros(len(self.ends), int)
        for i in range(3):
            seen = self.corners[:, [(i + 1) % 3, (i + 2) % 3]]
            ends = self.ends[self.sides[:, i]]
            self.left[:, i] = (seen == ends).all(1)
            demand(self.left[:, i] | (seen == ends[:, ::-1]).all(1), "a side that joins other points: triangle")
            np.add.at(owners, (self.sides[:, i], 1 - self.left[:, i].astype(int)), 1)
            here = self.left[:, i]
            self.owner[self.sides[here, i]] = np.flatnonzero(here)
        demand(owners == np.stack([np.ones(len(owners)), self.role == 0], 1), "triangles on the sides: edge")

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
            may = np.where((self.role <= 3)[:, None], held, np.stack([self.role >= 6, self.role < 0], 1))
            demand((may | (self.data == 0)).all(1), "a bulge of data where there are none: edge")

    def check_contact(self):
        """No tension, no penetration; 2 int tau_n (v . d - g) for each edge."""
        on = np.flatnonzero(self.role == 6)
        pressure, gap = self.numbers[on, 0], self.numbers[on, 1]
        demand(pressure <= 0, "a tension on Gamma_C: number")
        side = self.x[self.ends[on, 1]] - self.x[self.ends[on, 0]]
        length = np.sqrt(dot(side, side))
        d = np.where(self.has_direction[on, None, None], self.direction[on], (-turned(side) / length[:, None])[:, None])
        turns, varies = (d[:, 0] != d[:, 1]).any(1), pressure[:, 0] != pressure[:, 1]
        demand(~(turns & varies & self.has_direction[on]), "a pressure that varies along a direction that turns: edge")
        v = self.v[self.ends[on]]
        b, bulge = self.bulge[on], self.data[on, 0]
        # v and g by their Bernstein coefficients of degree 2, d by its two; the product is of degree 3.
        v = np.stack([v[:, 0], v.mean(1) + 2 * b, v[:, 1]], 1)
        g = np.stack([gap[:, 0], gap.mean(1) + 2 * bulge, gap[:, 1]], 1)
        beyond = np.zeros((len(on), 4))
        for i in range(3):
            for k in range(2):
                weight = [1, 2, 1][i] / [1, 3, 3, 1][i + k]
                beyond[:, i + k] += weight * (dot(v[:, i], d[:, k]) - g[:, i])
        size = np.abs(v).max((1, 2)) + np.abs(g).max(1)
        demand(beyond <= NEAR * size[:, None], "v goes through the obstacle on Gamma_C: number")
        # Bernstein coefficients of the product with the pressure, of degree 4, whose mean is its integral.
        integral = np.zeros(len(on))
        for i in range(4):
            for k in range(2):
                integral += [1, 3, 3, 1][i] / [1, 4, 6, 4, 1][i + k] * beyond[:, i] * pressure[:, k] / 5
        self.on_contact = np.zeros(len(self.corners))
        np.add.at(self.on_contact, self.owner[on], 2 * length * integral)
        self.turning = int((turns & self.has_direction[on]).sum())
        self.contact, self.contact_d = on, d

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
        force[on] = length[on] * self.numbers[on, 0, :, None] * self.contact_d
        d = self.direction[supported]
        force[supported] = (d * self.numbers[supported, 0, :, None]
                            + length[supported] * turned(d) * self.numbers[supported, 1, :, None])
        out = force[self.sides]
        return np.where(self.left[:, :, None, None], out, -out[:, :, ::-1])

    def check_balance(self, forces):
        """Forces and body force of each triangle balance, to rounding."""
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
        demand(np.abs(total).max(1) <= 1e-13 * off * size, "forces that do not balance: triangle")
        demand(np.abs(moment) <= 1e-13 * off * size * reach, "moments that do not balance: triangle")


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


def shares(body, forces):
    """The square of |C eps(v) - tau| on each triangle, for the nearest tau of degree 2."""
    reference = Reference()
    x, v = body.x[body.corners], body.v[body.corners]
    f = np.stack([x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]], -1)
    j = np.linalg.det(f)
    inverse = np.linalg.inv(f)
    data = np.concatenate([np.einsum("tab,tikb->tika", inverse, forces).reshape(-1, 12),
                           (j[:, None, None] * np.einsum("tab,tib->tia", inverse, body.body)).reshape(-1, 6)], 1)
    start = data @ reference.particular.T
    missed = np.abs(start @ reference.rows.T - data @ reference.right.T).max(1)
    off = 1 + np.abs(x).max((1, 2)) / np.sqrt(j)
    demand(missed <= 1e-10 * off * (np.abs(data).max(1) + 1e-300), "no stress with these forces: triangle")
    # (xx, yy, xy) of F t F^T / det F.
    a, b, c, d = (f[:, r, s] for r, s in ((0, 0), (0, 1), (1, 0), (1, 1)))
    push = np.array([[a * a, b * b, 2 * a * b], [c * c, d * d, 2 * c * d], [a * c, b * d, a * d + b * c]]).transpose(2, 0, 1)
    push /= j[:, None, None]
    # C eps(v) at the nodes; grad l by rows.
    gradients = np.concatenate([-inverse.sum(1, keepdims=True), inverse], 1)
    bulge = body.bulge[body.sides]
    slope = np.einsum("tia,tib->tab", v, gradients)[:, None]
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        for p, q in ((k, m), (m, k)):
            there = 4 * reference.places[:, p]
            slope = slope + there[:, None, None] * (bulge[:, i, :, None] * gradients[:, q, None, :])[:, None]
    lam, mu = body.lame.T[:, :, None]
    trace = slope[..., 0, 0] + slope[..., 1, 1]
    sigma = np.stack([2 * mu * slope[..., 0, 0] + lam * trace, 2 * mu * slope[..., 1, 1] + lam * trace,
                      mu * (slope[..., 0, 1] + slope[..., 1, 0])], -1)
    # s : C^-1 s = (xx^2 + yy^2 + 2 xy^2 - lambda / (2 (lambda + mu)) (xx + yy)^2) / (2 mu) as a sum of squares.
    mean = np.sqrt(mu / (lam + mu))[:, :, None]
    unit = np.array([[1, 1, 0], [1, -1, 0], [0, 0, 2]]) / 2
    weigh = unit[None] * np.concatenate([mean, np.ones_like(mean), np.ones_like(mean)], 1) / np.sqrt(mu)[:, :, None]
    root = np.linalg.cholesky(MASS).T
    def weighed(stress):
        stress = np.einsum("tab,tnbk->tnak", weigh, stress).reshape(len(j), 3, 6, -1)
        stress = np.einsum("mn,tpnk->tpmk", root, stress) * np.sqrt(j / 6)[:, None, None, None]
        return stress.reshape(len(j), 54, -1)
    tau = np.einsum("tab,tnb->tna", push, start.reshape(-1, 18, 3))
    apart = weighed((sigma - tau)[..., None])
    change = weighed(np.einsum("tab,nbk->tnak", push, reference.free.reshape(18, 3, -1)))
    gram = np.einsum("tnk,tnl->tkl", change, change)
    best = np.linalg.solve(gram, np.einsum("tnk,tno->tko", change, apart))
    apart = apart - np.einsum("tnk,tko->tno", change, best)
    distance = np.sqrt((apart**2).sum((1, 2)))
    return (distance + body.oscillation) ** 2 + body.on_contact


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
    found = shares(body, forces)
    total = found.sum()
    demand(found <= body.shares * (1 + 1e-8) + 1e-9 * total / len(found), "a share that is larger than the claimed one: triangle")
    bound = np.sqrt(total + (body.lift**2).sum())
    demand(bound <= header["bound"] * (1 + 1e-10), f"the bound is {bound:.6g}; {header['bound']:.6g} is claimed")
    reservations = []
    if (measured := int((body.oscillation > 0).sum())) or len(body.lift):
        reservations.append(f"quadrature in {measured} triangles and for {len(body.lift)} lifts")
    if body.turning:
        reservations.append(f"a direction of contact that turns on {body.turning} edges")
    if len(body.polygon):
        reservations.append(f"{len(body.polygon)} edges of a polygon for a curved boundary")
    words = "; ".join(reservations) or "none"
    return f"bound {bound:.6g}, {bound / header['bound']:.4f} of the claimed one; reservations: {words}"


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
