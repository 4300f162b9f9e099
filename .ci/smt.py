#!/usr/bin/env python3
"""A second opinion on the proofs: decides the paths written by `cargo run -p props -- smt DIR` with z3 and cvc5.

    pip install z3-solver cvc5 bitwuzla
    cargo run -p props -- smt target/smt && python3 .ci/smt.py target/smt
    python3 .ci/smt.py target/smt --receipt props/receipts     keeps the answers as bitwuzla-DATE.tsv and reals-DATE.tsv,
                                                               and asks only what the newest of these has no answer to

Each file says what to expect: unsat (the path is impossible), sat (a planted mistake, refuted at a point), or unknown.
Floating-point problems (QF_FP) go to bitwuzla instead. Every question runs in a process of its own that is killed after
its time is up. A contradiction, or a missing solver, fails; so does an expected `unsat` that nobody confirms unless it
is listed under KNOWN_OPEN. What one solver leaves undecided is listed.
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

Z3 = "import sys, z3; s = z3.Solver(); s.from_file(sys.argv[1]); print(s.check())"
# Without the logic z3 takes another way, which decides some of what the first leaves open.
Z3_SIMPLE = """
import sys, z3
text = open(sys.argv[1]).read().replace("(set-logic QF_NRA)", "")
s = z3.SimpleSolver(); s.from_string(text); print(s.check())
"""
CVC5 = """
import sys, cvc5
s = cvc5.Solver()
p = cvc5.InputParser(s)
p.setFileInput(cvc5.InputLanguage.SMT_LIB_2_6, sys.argv[1])
m = p.getSymbolManager()
while not (c := p.nextCommand()).isNull():
    print(c.invoke(s, m).strip())
"""
BITWUZLA = """
import sys, bitwuzla
t = bitwuzla.TermManager(); o = bitwuzla.Options()
p = bitwuzla.Parser(t, o)
p.parse(sys.argv[1], True, True)
print(str(p.bitwuzla().check_sat()).rsplit(".")[-1].lower())
"""

# The receipts: by name, the solvers and the packages that they come with.
RECEIPTS = {"bitwuzla": {"bitwuzla": "bitwuzla"}, "reals": {"z3": "z3-solver", "cvc5": "cvc5"}}

# Paths that no solver confirms in time; each has a certificate.
KNOWN_OPEN = set()


def ask(program, path, seconds):
    """The answer of one solver: sat, unsat or unknown."""
    command = [sys.executable, "-c", program, str(path)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return "unknown"
    # cvc5 gives a reason with an unknown: "unknown (INCOMPLETE)".
    answers = [word for word in done.stdout.split() if word in ("sat", "unsat", "unknown")]
    if len(answers) == 1:
        return answers[0]
    raise RuntimeError(f"{path}: {done.stdout}{done.stderr}")


def decide(path, seconds):
    """(expected, {solver: answer}) for one file."""
    text = path.read_text()
    expected = next(l for l in text.splitlines() if l.startswith("; expected: "))[12:]
    if "QF_FP" in text:
        return expected, {"bitwuzla": ask(BITWUZLA, path, 6 * seconds)}
    answers = {"z3": ask(Z3, path, seconds), "cvc5": ask(CVC5, path, seconds)}
    if answers["z3"] == "unknown":
        answers["z3"] = ask(Z3_SIMPLE, path, seconds)
    return expected, answers


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("directory", type=pathlib.Path)
    arguments.add_argument("--seconds", type=float, default=10)
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--receipt", type=pathlib.Path, metavar="DIR", help="keep the answers in DIR")
    options = arguments.parse_args()
    missing = [m for m in ("z3", "cvc5", "bitwuzla") if not importable(m)]
    if missing:
        sys.exit(f"missing: {', '.join(missing)}; pip install z3-solver cvc5 bitwuzla")
    paths = sorted(options.directory.glob("*.smt2"))
    if not paths:
        sys.exit(f"no problems in {options.directory}")
    contradictions, unconfirmed, counts = [], [], {}
    doubles, reals = [], []
    known = stored(options.receipt) if options.receipt else {}
    fresh = lambda p: known.get((p.name, digest(p))) or decide(p, options.seconds)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for path, (expected, answers) in zip(paths, pool.map(fresh, paths)):
            if "bitwuzla" in answers:
                doubles.append(receipt_line(path, expected, answers))
            elif expected == "unsat":
                reals.append(receipt_line(path, expected, answers))
            for solver, answer in answers.items():
                counts[solver, expected, answer] = counts.get((solver, expected, answer), 0) + 1
                if "unknown" not in (expected, answer) and answer != expected:
                    contradictions.append(f"{path.name}: expected {expected}, {solver} says {answer}")
                elif answer == "unknown":
                    print(f"undecided by {solver}: {path.name} (expected {expected})")
            if len(set(answers.values()) - {"unknown"}) > 1:
                contradictions.append(f"{path.name}: the solvers contradict each other: {answers}")
            if expected == "unsat" and "unsat" not in answers.values():
                unconfirmed.append(path.name)
    for (solver, expected, answer), count in sorted(counts.items()):
        print(f"{solver}: {count} expected {expected}, answered {answer}")
    for name in unconfirmed:
        print(f"confirmed by nobody: {name}")
    print(f"{len(paths)} problems, {len(contradictions)} contradictions, {len(unconfirmed)} unconfirmed")
    for contradiction in contradictions:
        print(f"CONTRADICTION: {contradiction}")
    if contradictions or set(unconfirmed) - KNOWN_OPEN:
        sys.exit(1)
    if options.receipt:
        for (name, solvers), lines in zip(RECEIPTS.items(), [doubles, reals]):
            write_receipt(options.receipt, name, solvers, lines)


def receipt_line(path, expected, answers):
    """The problem, the hash of its text, what was expected, and what each solver answered."""
    return "\t".join([path.name, digest(path), expected, *answers.values()])


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def stored(directory):
    """The answers of the newest receipts, by problem and hash: those of other versions of the solvers count for nothing."""
    known = {}
    for name, solvers in RECEIPTS.items():
        newest = max(directory.glob(f"{name}-*.tsv"), default=None)
        lines = newest.read_text().splitlines() if newest else []
        if [line for line in lines if line.startswith("#")] != versions(solvers):
            continue
        for line in lines[len(solvers) + 1 :]:
            problem, digest_of_it, expected, *answers = line.split("\t")
            if "unknown" not in answers:
                known[problem, digest_of_it] = expected, dict(zip(solvers, answers))
    return known


def versions(solvers):
    return [f"# {solver} {importlib.metadata.version(package)}" for solver, package in solvers.items()]


def write_receipt(directory, name, solvers, lines):
    """One receipt: a line for each solver, with its version, then the problems."""
    path = directory / f"{name}-{datetime.datetime.now(datetime.timezone.utc).date()}.tsv"
    head = versions(solvers) + ["\t".join(["problem", "hash", "expected", *solvers])]
    path.write_text("\n".join(head + lines) + "\n")
    print(f"written: {path}")


def importable(module):
    """Whether a solver is installed, asked in another process: importing one can change this one's signals."""
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode == 0


if __name__ == "__main__":
    main()
