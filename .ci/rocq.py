#!/usr/bin/env python3
"""The headline statements of the paper, checked by Rocq: what `cargo run -p props -- export --rocq DIR` writes.

    apt-get install coq
    cargo run -p props -- export --rocq target/rocq && python3 .ci/rocq.py target/rocq
    python3 .ci/rocq.py target/rocq --receipt props/receipts     keeps the answers as rocq-DATE.tsv

Fails where a theorem is not proved, rests on an axiom other than those of the classical real numbers, or where one of the
false statements in DIR/false is proved, or fails for another reason than that a path does not close.
"""

import argparse
import concurrent.futures
import datetime
import hashlib
import os
import pathlib
import re
import resource
import subprocess
import sys

AXIOMS = {
    "ClassicalDedekindReals.sig_forall_dec",
    "ClassicalDedekindReals.sig_not_dec",
    "FunctionalExtensionality.functional_extensionality_dep",
}
# What a tactic says that does not close its goal.
UNPROVED = re.compile(r"Cannot find witness|Tactic failure|No applicable tactic|No matching clauses")


def coqc(folder, path):
    command = ["coqc", "-q", "-Q", str(folder), "Signorini", str(path)]
    return subprocess.run(command, capture_output=True, text=True)


def statements():
    """By name, the hash of what a theorem says: the definitions and its statement, without proofs."""
    text = (pathlib.Path(__file__).parent.parent / "props/rocq/paper.v").read_text()
    definitions = text[: text.index("(** The tactics of the proofs.")]
    found = {}
    for theorem in re.findall(r"^Theorem .*?(?=^Proof\.)", text, re.M | re.S):
        digest = hashlib.sha256((definitions + theorem).encode()).hexdigest()[:16]
        found[re.match(r"Theorem (\w+)", theorem)[1]] = digest
    return found


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("directory", type=pathlib.Path)
    arguments.add_argument("--receipt", type=pathlib.Path, metavar="DIR", help="keep the answers in DIR")
    options = arguments.parse_args()
    folder = options.directory.resolve()
    version = subprocess.run(["coqc", "--print-version"], capture_output=True, text=True, check=True).stdout.split()[0]
    theorems = statements()
    exported = re.findall(r"^Theorem (\w+)", (folder / "paper.v").read_text(), re.M)
    if exported != list(theorems):
        sys.exit(f"{folder}/paper.v is not that of props/rocq/paper.v")
    done = coqc(folder, folder / "paper.v")
    if done.returncode:
        sys.exit(f"not proved: {done.stderr}")
    axioms = set(re.findall(r"^(\w[\w.]*)\s*$|^(\w[\w.]*) :", done.stdout, re.M))
    axioms = {one or other for one, other in axioms} - {"Axioms"}
    asked = done.stdout.count("Axioms:") + done.stdout.count("Closed under the global context")
    if asked != len(theorems) or not axioms <= AXIOMS:
        sys.exit(f"{asked} of {len(theorems)} theorems say what they rest on: {sorted(axioms)}; allowed are {sorted(AXIOMS)}")
    planted = sorted((folder / "false").glob("*.v"))
    if len(planted) < 20:
        sys.exit(f"{len(planted)} false statements, expected 20 at least")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for path, done in zip(planted, pool.map(lambda path: coqc(folder, path), planted)):
            if done.returncode == 0:
                sys.exit(f"{path.name} is false and was proved")
            if not UNPROVED.search(done.stderr):
                sys.exit(f"{path.name} fails for a reason of its own: {done.stderr}")
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"Rocq {version}: {len(theorems)} theorems proved, {len(planted)} false ones refused, axioms {', '.join(sorted(axioms))};")
    print(f"{seconds.ru_utime + seconds.ru_stime:.0f} s of processor time")
    if options.receipt:
        path = options.receipt / f"rocq-{datetime.date.today().isoformat()}.tsv"
        refused = {path.stem for path in planted}
        lines = [f"# Rocq {version}", f"#axioms: {' '.join(sorted(axioms))}", "theorem\tstatement\tfalse twin\tRocq"]
        lines += [f"{name}\t{said}\t{'refused' if name in refused else '-'}\tproved" for name, said in theorems.items()]
        path.write_text("\n".join(lines) + "\n")
        print(f"written: {path}")


if __name__ == "__main__":
    main()
