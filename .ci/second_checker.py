#!/usr/bin/env python3
"""Certificates of degree 1 and 2, with circles, oblique supports, two bodies, motions that nothing stops and adapted meshes, checked by reference/check_bound.py; and tampered
ones, with their hashes, which it must refuse: second_checker.py PROGRAM FOLDER."""
import json
import pathlib
import re
import subprocess
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "reference"))
import check_bound

OBLIQUE = """
mesh.trapezoid = { omega = 2.2, n = 4 }
material = { lambda = 1, mu = 1 }
boundary.left.normal = 0
boundary.bottom.displacement = ["0", "0"]
boundary.top.traction = ["0.1", "-0.02*x"]
boundary.right.contact = { gap = "0.01" }
"""
SLIDE = """
mesh.rectangle = { width = 1, height = 1, nx = 8, ny = 8 }
material = { lambda = 1, mu = 1 }
load.body = ["0", "-0.1"]
boundary.top.pressure = "0.05 + 0.02*x"
boundary.bottom.contact = { gap = "0" }
"""
SMALL = """
mesh.rectangle = { width = 1, height = 1, nx = 6, ny = 6 }
material = { lambda = 1e-12, mu = 1e-12 }
boundary.top.displacement = ["0", "-0.1 + 0.15*x"]
boundary.bottom.contact = {}
"""
ROUGH = """
mesh.rectangle = { width = 1, height = 1, nx = 6, ny = 6 }
material = { lambda = 1, mu = 1 }
boundary.top.displacement = ["0.02 + 0.005*x", "-0.05 - 0.01*x"]
boundary.bottom.contact = { gap = "0", friction = { tresca = "0.013*(1 + x)" } }
"""
CASE_FILES = pathlib.Path(__file__).parents[1] / "cases"


def tied(name, *laws):
    """A case with these laws between its bodies, and no point held."""
    text = re.sub(r"\[point.*\n.*\n", "", (CASE_FILES / f"{name}.toml").read_text())
    text = text.replace('gmsh = "', f'gmsh = "{CASE_FILES.resolve()}/')
    first, *pairs = text.split("[[pair]]\n")
    return first + "".join(f'[[pair]]\nlaw = "{law}"\n{pair}' for law, pair in zip(laws, pairs))


OWN = {"oblique": OBLIQUE, "slide": SLIDE, "small": SMALL, "rough": ROUGH,
       "glued": tied("press_fit", "bonded"), "round": tied("press_fit", "sliding"), "tied": tied("stack", "bonded", "sliding")}
FORCES = ["--set", 'certify.quantities=["force bottom", "force bottom x 0 0.25 ramp 0.1"]']
ADAPTED = ["--set", 'adapt.target="10 %"', "--set", "adapt.max_unknowns=2000"]
P2 = ["--set", "method.degree=2", "--set", "method.gamma0=auto"]
CASES = {
    "block 1": ["cases/block.toml"], "block 2": ["cases/block.toml", *P2],
    "forces 1": ["cases/block.toml", *FORCES], "forces 2": ["cases/block.toml", *P2, *FORCES],
    "small 1": ["small"], "small 2": ["small", *P2], "wood 1": ["cases/wood.toml"], "wood 2": ["cases/wood.toml", *P2],
    "gap 1": ["cases/gap.toml"], "gap 2": ["cases/gap.toml", *P2],
    "pin 1": ["cases/pin.toml"], "pin 2": ["cases/pin.toml", *P2],
    "disk": ["cases/disk.toml"], "bracket": ["cases/bracket.toml"], "cantilever": ["cases/cantilever.toml"],
    "oblique 1": ["oblique"], "oblique 2": ["oblique", *P2],
    "slide 1": ["slide"], "slide 2": ["slide", *P2], "shaft": ["cases/disk_force.toml", *P2],
    "cylinders 1": ["cases/cylinders.toml", "--set", "method.degree=1"], "cylinders 2": ["cases/cylinders.toml", "--set", "method.degree=2"],
    "lug 1": ["cases/pin_lug.toml", "--set", "method.degree=1"], "lug 2": ["cases/pin_lug.toml", "--set", "method.degree=2"],
    "rough 1": ["rough"], "rough 2": ["rough", *P2], "tied 1": ["tied"], "tied 2": ["tied", "--set", "method.degree=2"],
    "glued 1": ["glued", "--set", "method.degree=1"], "glued 2": ["glued"],
    "round 1": ["round", "--set", "method.degree=1"], "round 2": ["round"],
    "adapted 1": ["cases/corner.toml", *ADAPTED], "adapted 2": ["cases/corner.toml", *ADAPTED, *P2],
}


def array(header, words, name):
    """An array of the file, to be changed in place."""
    at = 0
    for entry in header["arrays"]:
        count = entry["entries"] * len(entry["words"])
        if entry["name"] == name:
            return words[at:at + count].reshape(entry["entries"], -1)
        at += count
    raise KeyError(name)


def number(row, k, change):
    """Changes a double of an entry."""
    row[k:k + 1] = np.frombuffer(np.array([change(row[k:k + 1].view("<f8")[0])]), "<u8")


def first(rows, role):
    """The first edge of a role that has a force."""
    return next(row for row in rows if row[2] == role and row[3:].any())


def slides(a):
    """The direction of an edge on which bodies slide without opening, and it turns."""
    on = {row[0] for row in a("laws") if row[1] == 1}
    return next(row for row in a("directions") if row[0] in on and (row[1:3] != row[3:]).any())


def shifted(rows):
    """Moves the widest interval of a force by three times its width, twice its end and 0.001: all are 0 to rounding where symmetry says so."""
    row = sorted(rows, key=lambda row: np.ptp(row[6:8].view("<f8")))[-1]
    low, high = row[6:8].view("<f8").tolist()
    for k in (6, 7):
        number(row, k, lambda end: end + 3 * (high - low) + 2 * abs(high) + 1e-3)


def pushed(force):
    """Pushes the first triangle along x: what balances a motion that nothing stops is left there."""
    return lambda h, a: [number(a("triangles")[0], k, lambda f: f + force) for k in (8, 10, 12)]


TAMPERINGS = {
    "a force in the first triangle": pushed(1e-3),
    "a bound that is smaller": lambda h, a: h.update(bound=0.9 * h["bound"]),
    "a share that is smaller": lambda h, a: number(a("shares")[0], 0, lambda x: 0.5 * x),
    "a force that is larger": lambda h, a: number(first(a("edges"), 0), 3, lambda f: 1.001 * f + 1e-6),
    "a tension": lambda h, a: number(first(a("edges"), 6), 3, lambda p: 1e-9),
    "a second traction between two bodies": lambda h, a: number(next(row for row in a("edges") if row[2] == 8), 3, lambda f: 5e-324),
    "an edge that two others face": lambda h, a: a("pairs")[0, 1:].__setitem__(slice(None), a("pairs")[1, 1:]),
    "friction beyond its bound": lambda h, a: number(next(row for row in a("laws") if row[1] == 3), 2, lambda q: 2 * abs(q) + 1),
    "friction with a larger bound": lambda h, a: [number(row, k, lambda s: 2 * s) for row in a("laws") if row[1] == 3 for k in (4, 5)],
    "glue for friction": lambda h, a: a("laws")[:, 1].__setitem__(slice(None), np.where(a("laws")[:, 1] == 3, 2, 3).astype(np.uint64)),
    "a pressure that varies along a direction that turns": lambda h, a: number(
        a("edges")[int(slides(a)[0])], 4, lambda p: 1.001 * p + 1e-6),
    "a direction of its own": lambda h, a: [number(slides(a), k, lambda d: d + 1e-6) for k in (1, 3)],
    "glue that slides": lambda h, a: [row[1:2].__isub__(np.uint64(1)) for row in a("laws") if row[1] == 2],
    "a jump of its own": lambda h, a: number(next(row for row in a("laws") if row[1] == 2), 4, lambda g: g + 1e-3),
    "a gap that is smaller": lambda h, a: [number(row, k, lambda g: g - 0.5) for row in a("edges") if row[2] == 6 for k in (5, 6)],
    "a displacement off what is prescribed": lambda h, a: number(
        a("displacement")[np.flatnonzero(a("prescribed")[:, 0])[0]], 0, lambda v: v + 1e-12),
    "a stiffer material": lambda h, a: number(a("triangles")[3], 7, lambda mu: 2 * mu),
    "a body force": lambda h, a: number(a("triangles")[2], 9, lambda f: f + 0.1),
    "a triangle turned round": lambda h, a: a("triangles")[0, :2].__setitem__(slice(None), a("triangles")[0, 1::-1].copy()),
    "a triangle with another edge": lambda h, a: a("triangles")[0, 3:4].__iadd__(np.uint64(1)),
    "a lift that is negative": lambda h, a: number(a("lifts")[0], 3, lambda z: -1),
    "a force between nearer numbers": lambda h, a: number(a("forces")[1], 6, lambda low: low + 0.05 * abs(low) + 1e-9),
    "a force that is far larger": lambda h, a: shifted(a("forces")[1:]),
    "a force whose first end is the larger": lambda h, a: a("forces")[1, 6:].__setitem__(slice(None), a("forces")[1, :5:-1].copy()),
    "another statement": lambda h, a: h.update(statement="the body is safe"),
    "a tensor that is stiffer": lambda h, a: number(a("tensors")[0], 0, lambda c: 2 * c),
    "a tensor that is none": lambda h, a: number(a("tensors")[0], 5, lambda c: -c),
    "a triangle of another tensor": lambda h, a: (a("tensors"), number(a("triangles")[0], 6, lambda k: k + 7)),
    "a force of a smaller patch": lambda h, a: number(next(row for row in a("forces") if row[2] > 0), 4, lambda to: to - 0.2),
    "a w that is off on the boundary": lambda h, a: [number(row, k, lambda w: w + 1e-3) for row in a("w") for k in (0, 1)],
    "a w that does not begin with 0": lambda h, a: number(a("w")[0], 1, lambda w: w - 1),
    "a force of another motion": lambda h, a: a("forces")[1, 0:1].__iadd__(np.uint64(1)),
    "a force on a boundary without a name": lambda h, a: (a("forces")[1], h.update(boundaries=[])),
    "edges of another boundary": lambda h, a: [
        row[1:2].__iadd__(np.uint64(1)) for row in a("boundaries") if row[1] == a("forces")[1, 1]],
    "a dual w": lambda h, a: number(a("dual w")[7], 1, lambda w: w + 0.1),
    "a dual force": lambda h, a: number(next(row for row in a("dual edges") if row[0] == 0 and row[1:].any()), 1, lambda f: f + 0.1),
    "a dual traction on Gamma_N": lambda h, a: number(next(row for row in a("dual edges") if row[0] == 4), 1, lambda t: 1e-9),
    "a dual edge of another role": lambda h, a: next(row for row in a("dual edges") if row[0] == 2)[0:1].__imul__(np.uint64(2)),
    "an array of another name": lambda h, a: h["arrays"][-1].update(name="z"),
    "a reservation in the header": lambda h, a: h.update(rigorous=True),
}


def tampered(folder, out, change):
    """Writes a certificate with a change and a hash that fits; whether there is anything to change."""
    header = json.loads((folder / "certificate.json").read_text())
    words = np.frombuffer((folder / "certificate.bin").read_bytes(), "<u8").copy()
    before = json.dumps(header), words.tobytes()
    try:
        change(header, lambda name: array(header, words, name))
    except (IndexError, KeyError, StopIteration):
        return False
    # Twice the stiffness of a triangle that has a tensor, or a larger force that is 0, is no change.
    if before == (json.dumps(header), words.tobytes()):
        return False
    header["hash"] = check_bound.hash_of(words.tobytes())
    out.mkdir(parents=True, exist_ok=True)
    (out / "certificate.json").write_text(json.dumps(header))
    (out / "certificate.bin").write_bytes(words.tobytes())
    return True


def without_forces(folder, out):
    """Writes a certificate without the array of forces, but with what proves them."""
    header = json.loads((folder / "certificate.json").read_text())
    words, at = np.frombuffer((folder / "certificate.bin").read_bytes(), "<u8"), 0
    for entry in header["arrays"]:
        count = entry["entries"] * len(entry["words"])
        if entry["name"] == "forces":
            words = np.delete(words, slice(at, at + count))
            header["arrays"].remove(entry)
            header["hash"] = check_bound.hash_of(words.tobytes())
            out.mkdir(parents=True, exist_ok=True)
            (out / "certificate.json").write_text(json.dumps(header))
            (out / "certificate.bin").write_bytes(words.tobytes())
            return True
        at += count
    return False


def main(program, folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, case in OWN.items():
        (folder / f"{name}.toml").write_text(case)
    good = []
    for name, (case, *settings) in CASES.items():
        case = folder / f"{case}.toml" if case in OWN else case
        out = folder / name.replace(" ", "_")
        # With a target that is not met the certificate is written all the same.
        subprocess.run([program, "--quiet", "solve", case, "--certificate", "--out", out, *settings], check=False)
        good.append(out)
    wrong = check_bound.main([str(out / "certificate.json") for out in good])
    refused = 0
    changes = {what: lambda out, to, change=change: tampered(out, to, change) for what, change in TAMPERINGS.items()}
    for what, change in {**changes, "what proves forces, but no forces": without_forces}.items():
        for out in good:
            if not change(out, folder / "tampered"):
                continue
            try:
                check_bound.check(folder / "tampered" / "certificate.json")
                print(f"{out}: accepted with {what}", file=sys.stderr)
                wrong = 1
            except check_bound.Refused:
                refused += 1
    for name in ("slide_1", "slide_2"):
        words = check_bound.check(folder / name / "certificate.json")
        tampered(folder / name, folder / "tampered", pushed(1e-14))
        if not words.count("a motion that nothing else stops") or check_bound.main([str(folder / "tampered" / "certificate.json")]):
            print(f"{name}: a support is not named, or does not take a rounding error: {words}", file=sys.stderr)
            wrong = 1
    print(f"{refused} tampered certificates refused")
    return wrong or refused < 100


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
