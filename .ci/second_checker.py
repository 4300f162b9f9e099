#!/usr/bin/env python3
"""Certificates of degree 1 and 2, with circles, oblique supports and adapted meshes, checked by reference/check_bound.py; and tampered
ones, with their hashes, which it must refuse: second_checker.py PROGRAM FOLDER."""
import json
import pathlib
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
ADAPTED = ["--set", 'adapt.target="10 %"', "--set", "adapt.max_unknowns=2000"]
P2 = ["--set", "method.degree=2", "--set", "method.gamma0=auto"]
CASES = {
    "block 1": ["cases/block.toml"], "block 2": ["cases/block.toml", *P2],
    "gap 1": ["cases/gap.toml"], "gap 2": ["cases/gap.toml", *P2],
    "pin 1": ["cases/pin.toml"], "pin 2": ["cases/pin.toml", *P2],
    "disk": ["cases/disk.toml"], "bracket": ["cases/bracket.toml"], "cantilever": ["cases/cantilever.toml"],
    "oblique 1": ["oblique"], "oblique 2": ["oblique", *P2],
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


TAMPERINGS = {
    "a bound that is smaller": lambda h, a: h.update(bound=0.9 * h["bound"]),
    "a share that is smaller": lambda h, a: number(a("shares")[0], 0, lambda x: 0.5 * x),
    "a force that is larger": lambda h, a: number(first(a("edges"), 0), 3, lambda f: 1.001 * f + 1e-6),
    "a tension": lambda h, a: number(first(a("edges"), 6), 3, lambda p: 1e-9),
    "a gap that is smaller": lambda h, a: [number(row, k, lambda g: g - 0.5) for row in a("edges") if row[2] == 6 for k in (5, 6)],
    "a displacement off what is prescribed": lambda h, a: number(
        a("displacement")[np.flatnonzero(a("prescribed")[:, 0])[0]], 0, lambda v: v + 1e-12),
    "a stiffer material": lambda h, a: number(a("triangles")[3], 7, lambda mu: 2 * mu),
    "a body force": lambda h, a: number(a("triangles")[2], 9, lambda f: f + 0.1),
    "a triangle turned round": lambda h, a: a("triangles")[0, :2].__setitem__(slice(None), a("triangles")[0, 1::-1].copy()),
    "a triangle with another edge": lambda h, a: a("triangles")[0, 3:4].__iadd__(np.uint64(1)),
    "a lift that is negative": lambda h, a: number(a("lifts")[0], 3, lambda z: -1),
    "an array of another name": lambda h, a: h["arrays"][-1].update(name="w"),
    "a reservation in the header": lambda h, a: h.update(rigorous=True),
}


def tampered(folder, out, change):
    """Writes a certificate with a change and a hash that fits; whether there is anything to change."""
    header = json.loads((folder / "certificate.json").read_text())
    words = np.frombuffer((folder / "certificate.bin").read_bytes(), "<u8").copy()
    try:
        change(header, lambda name: array(header, words, name))
    except (KeyError, StopIteration):
        return False
    header["hash"] = check_bound.hash_of(words.tobytes())
    out.mkdir(parents=True, exist_ok=True)
    (out / "certificate.json").write_text(json.dumps(header))
    (out / "certificate.bin").write_bytes(words.tobytes())
    return True


def main(program, folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "oblique.toml").write_text(OBLIQUE)
    good = []
    for name, (case, *settings) in CASES.items():
        case = folder / "oblique.toml" if case == "oblique" else case
        out = folder / name.replace(" ", "_")
        # With a target that is not met the certificate is written all the same.
        subprocess.run([program, "--quiet", "solve", case, "--certificate", "--out", out, *settings], check=False)
        good.append(out)
    wrong = check_bound.main([str(out / "certificate.json") for out in good])
    refused = 0
    for what, change in TAMPERINGS.items():
        for out in good:
            if not tampered(out, folder / "tampered", change):
                continue
            try:
                check_bound.check(folder / "tampered" / "certificate.json")
                print(f"{out}: accepted with {what}", file=sys.stderr)
                wrong = 1
            except check_bound.Refused:
                refused += 1
    print(f"{refused} tampered certificates refused")
    return wrong or refused < 100


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
