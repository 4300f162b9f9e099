"""python3 -m fenicsx.store [--check] [NAME ...]

Solves the cases in cases/ and reference/cases/ (or those named) and stores each result in reference/results/NAME.json: the content of
result.json without times, and its provenance. With --check it stores nothing and compares: code 1 if a stored result is missing, was made
from another case file, or differs.
"""

import argparse
import datetime
import hashlib
import json
import logging
import sys
import tomllib
from pathlib import Path

from mpi4py import MPI

from . import compat
from .case import Gmsh
from .solve import solve
from .write import text_of

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "reference" / "results"
COMMAND = "PYTHONPATH=reference python3 -m fenicsx.store"

# Agreement asked of a fresh and a stored result, relative to the scales in `differences`.
TOLERANCE = 1e-11


def cases():
    """{name: case file}, without those with pairs of boundaries, which pair.py solves."""
    files = [*sorted((ROOT / "cases").glob("*.toml")), *sorted((ROOT / "reference" / "cases").glob("*.toml"))]
    return {file.stem: file for file in files if "pair" not in tomllib.loads(file.read_text(encoding="utf-8"))}


def fresh(file):
    """The entry for one case file, as it is stored."""
    content, problem, _, _ = solve(file, MPI.COMM_SELF)
    del content["seconds"]
    provenance = {"versions": compat.versions(), "case": file.relative_to(ROOT).as_posix(), "case_sha256": sha256(file)}
    if isinstance(problem.case.mesh, Gmsh):
        provenance["mesh_sha256"] = sha256(problem.case.mesh.path)
    return content | {"provenance": provenance | {"command": COMMAND, "date": datetime.date.today().isoformat()}}


def sha256(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def differences(a, b):
    """[(place, difference relative to its scale)] for each number of two results. A force is measured against the largest force (energy
    over displacement is one), an error against the energy norm, a displacement against the largest: numbers that are 0 in exact arithmetic
    then need no rule of their own."""
    quantities = a["quantities"]
    energy, displacement = quantities["a_uu"], quantities["max_displacement"]
    forces = [quantities["contact_force"], *(component for pair in quantities["reactions"].values() for component in pair)]
    force = max([energy / displacement if displacement > 0 else 0.0, *map(abs, forces)])
    scales = {"contact_force": force, "contact_resultant": force, "reactions": force, "work": max(abs(quantities["work"]), energy),
              "errors": energy**0.5, "probes": displacement, "force": force, "resultant": force, "moment": force * a["mesh"]["h_max"]}
    found = []

    def walk(place, x, y, scale):
        if isinstance(x, dict):
            if x.keys() != y.keys():
                found.append((place, float("inf")))
                return
            for key in x:
                walk(f"{place}.{key}" if place else key, x[key], y[key], scales.get(key, scale))
        elif isinstance(x, list):
            if len(x) != len(y):
                found.append((place, float("inf")))
                return
            for i, (p, q) in enumerate(zip(x, y)):
                walk(f"{place}[{i}]", p, q, scale)
        elif isinstance(x, str):
            found.append((place, 0.0 if x == y else float("inf")))
        elif x != y:
            found.append((place, abs(x - y) / max(abs(x) if scale is None else scale, sys.float_info.min)))
        else:
            found.append((place, 0.0))

    for part in ("title", "mesh", "gamma", "quantities", "contact", "probes", "errors"):
        if part in a or part in b:
            walk(part, a.get(part, {}), b.get(part, {}), scales.get(part))
    return found


def check(name, file):
    """What is wrong with a stored result, one line each."""
    stored = RESULTS / f"{name}.json"
    if not stored.exists():
        return [f"{name}: not stored"]
    old = json.loads(stored.read_text())
    if old["provenance"]["case_sha256"] != sha256(file):
        return [f"{name}: {old['provenance']['case']} has changed since its result was stored"]
    worst = sorted(((value, place) for place, value in differences(old, fresh(file)) if not value <= TOLERANCE), reverse=True)
    return [f"{name}: {place} differs by {value:.1e}, expected at most {TOLERANCE:.0e}" for value, place in worst]


def main():
    parser = argparse.ArgumentParser(prog="python3 -m fenicsx.store", description="Stores or checks the reference results.")
    parser.add_argument("--check", action="store_true", help="compare with the stored results, store nothing")
    parser.add_argument("names", nargs="*", metavar="NAME", help="case names; default: all")
    options = parser.parse_args()
    logging.disable(logging.INFO)
    known = cases()
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"unknown case {unknown[0]!r}; known: {', '.join(known)}")
    names = options.names or list(known)
    if options.check:
        wrong = [line for name in names for line in check(name, known[name])]
        if not options.names:
            wrong += [f"{file.stem}: stored, and no such case" for file in sorted(RESULTS.glob("*.json")) if file.stem not in known]
        print("\n".join(wrong) or f"{len(names)} stored results agree with fresh ones to {TOLERANCE:.0e}")
        return 1 if wrong else 0
    RESULTS.mkdir(exist_ok=True)
    for name in names:
        (RESULTS / f"{name}.json").write_text(text_of(fresh(known[name])))
        print(f"stored {name}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
