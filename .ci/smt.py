#!/usr/bin/env python3
"""Statements in doubles, decided over all finite doubles: the paths written by `cargo run -p props -- smt DIR`, by bitwuzla.

    pip install bitwuzla
    cargo run -p props -- smt target/smt && python3 .ci/smt.py target/smt
    python3 .ci/smt.py target/smt --receipt props/receipts     keeps the answers as bitwuzla-DATE.tsv, and asks only what the
                                                               newest of these has no answer to

Each file says what to expect: unsat (the path is impossible), or unknown (of a planted mistake: one of its paths must be sat).
Every question runs in a process of its own that is killed after its time is up. An expected `unsat` that is not answered, or a
mistake without a `sat`, fails.
"""

import argparse
import concurrent.futures
import datetime
import hashlib
import importlib.metadata
import os
import pathlib
import subprocess
import sys

BITWUZLA = """
import sys, bitwuzla
t = bitwuzla.TermManager(); o = bitwuzla.Options()
p = bitwuzla.Parser(t, o)
p.parse(sys.argv[1], True, True)
print(str(p.bitwuzla().check_sat()).rsplit(".")[-1].lower())
"""


def ask(path, seconds):
    """The answer to one problem: sat, unsat or unknown."""
    command = [sys.executable, "-c", BITWUZLA, str(path)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return "unknown"
    if done.stdout.strip() in ("sat", "unsat", "unknown"):
        return done.stdout.strip()
    raise RuntimeError(f"{path}: {done.stdout}{done.stderr}")


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def stored(directory, head):
    """The answers of the newest receipt, by problem and hash: those of another version count for nothing."""
    newest = max(directory.glob("bitwuzla-*.tsv"), default=None) if directory else None
    lines = newest.read_text().splitlines() if newest else []
    rows = [line.split("\t") for line in lines[2:]] if lines[:1] == [head] else []
    return {(name, known): answer for name, known, _, answer in rows if answer != "unknown"}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("directory", type=pathlib.Path)
    arguments.add_argument("--seconds", type=float, default=60)
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--receipt", type=pathlib.Path, metavar="DIR", help="keep the answers in DIR")
    options = arguments.parse_args()
    try:
        head = f"# bitwuzla {importlib.metadata.version('bitwuzla')}"
    except importlib.metadata.PackageNotFoundError:
        sys.exit("missing: bitwuzla; pip install bitwuzla")
    paths = sorted(options.directory.glob("*.smt2"))
    if not paths:
        sys.exit(f"no problems in {options.directory}")
    known = stored(options.receipt, head)
    wrong, mistakes, rows = [], {}, []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        fresh = lambda path: known.get((path.name, digest(path))) or ask(path, options.seconds)
        for path, answer in zip(paths, pool.map(fresh, paths)):
            expected = next(l for l in path.read_text().splitlines() if l.startswith("; expected: "))[12:]
            rows.append(f"{path.name}\t{digest(path)}\t{expected}\t{answer}")
            if expected == "unsat" and answer != "unsat":
                wrong.append(f"{path.name}: expected unsat, answered {answer}")
            if expected == "unknown":
                mistakes.setdefault(path.name.split(".")[0], []).append(answer)
    wrong += [f"{name}: a planted mistake, and no path is possible" for name, answers in mistakes.items() if "sat" not in answers]
    print(f"{len(paths)} problems, {len(mistakes)} planted mistakes, {len(wrong)} wrong", *wrong, sep="\n")
    if wrong:
        sys.exit(1)
    if options.receipt:
        path = options.receipt / f"bitwuzla-{datetime.datetime.now(datetime.timezone.utc).date()}.tsv"
        path.write_text("\n".join([head, "problem\thash\texpected\tbitwuzla", *rows]) + "\n")
        print(f"written: {path}")


if __name__ == "__main__":
    main()
