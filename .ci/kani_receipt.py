#!/usr/bin/env python3
"""Keeps what `cargo kani` printed as a receipt, the only writer of such a receipt.

    cargo kani 2>&1 | tee LOG          at the root, with Kani installed, of the commit that is checked out
    .ci/kani_receipt.py LOG            writes props/receipts/kani-DATE.tsv; VERIFY.md follows it

The receipt says at which commit which harness got which verdict, in how many seconds and by which versions, and has the hash of
each file that the answers hang on, as it is in that commit (`props/src/receipt.rs` reads it).
"""

import datetime
import hashlib
import pathlib
import platform
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# `SHARED` of props/src/receipt.rs.
SHARED = ("src/kernel/", "props/src/harness.rs", "props/src/verdict.rs", "props/src/numbers/whole.rs")
NO_ANSWER = ("timed out", "CBMC failed", "Status: ERROR", "out of memory")


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, check=True, text=True).stdout


def run(block):
    """What Kani printed about one harness: its path, what is expected, the verdict, seconds and conditions."""
    harness = block.splitlines()[0].rstrip(".")
    verdict = re.search(r"^VERIFICATION:- (\w+)", block, re.M)
    if verdict is None or any(sign in block for sign in NO_ANSWER):
        answer = "no answer"
    else:
        answer = "verified" if verdict[1] == "SUCCESSFUL" else "failed"
    seconds = re.search(r"^Verification Time: ([0-9.e-]+)s", block, re.M)
    conditions = re.search(r"^ *\*\* \d+ of (\d+)", block, re.M)
    expected = "should_panic" if harness.rsplit("::")[-1].startswith("control_") else "success"
    return [harness, expected, answer, f"{float(seconds[1]):.2f}" if seconds else "", conditions[1] if conditions else ""]


def file_of(harness):
    return f"props/src/{'/'.join(harness.split('::')[:-1]) or 'lib'}.rs"


def receipt(log, commit, shown, listed):
    """The text of the receipt; `shown` answers the text of a file of the commit, which has the files that are `listed`."""
    if re.search(r"^Thread ", log, re.M):
        raise ValueError("the log of several threads is mixed up: run cargo kani without -j")
    runs = [run(block) for block in log.split("Checking harness ")[1:]]
    if not runs:
        raise ValueError("no line begins with 'Checking harness': it is the output of cargo kani that is needed")
    versions = [re.search(rf"^\s*({start}.*)$", log, re.M) for start in ("Kani Rust Verifier ", "CBMC ")]
    seconds = sum(float(seconds) for *_, seconds, _ in runs if seconds)
    head = [version[1] for version in versions if version]
    head += [f"{platform.system().lower()} {platform.machine()}, {len(runs)} harnesses in {seconds:.0f} s", f"commit {commit}"]
    of_harnesses = {file_of(harness) for harness, *_ in runs}
    for name in (name for name in listed if name.startswith(SHARED) or name in of_harnesses):
        head.append(f"file {name} {hashlib.sha256(shown(name).encode()).hexdigest()[:16]}")
    rows = [["harness", "expected", "verdict", "seconds", "conditions"], *runs]
    return "".join(f"# {line}\n" for line in head) + "".join("\t".join(row) + "\n" for row in rows)


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    log = pathlib.Path(sys.argv[1])
    if changed := git("status", "--porcelain", "--", "src/kernel", "props/src"):
        sys.exit(f"these files are not those of the commit; commit them and run cargo kani again:\n{changed}")
    written, commit = log.stat().st_mtime, git("rev-parse", "HEAD").strip()
    if int(git("log", "-1", "--format=%ct")) > written:
        sys.exit(f"{log} is older than the commit {commit}: run cargo kani again")
    listed = git("ls-tree", "-r", "--name-only", commit, "src/kernel", "props/src").splitlines()
    try:
        text = receipt(log.read_text(), commit, lambda name: git("show", f"{commit}:{name}"), listed)
    except ValueError as why:
        sys.exit(f"{log}: {why}")
    date = datetime.datetime.fromtimestamp(written, datetime.timezone.utc).date()
    path = ROOT / f"props/receipts/kani-{date}.tsv"
    path.write_text(text)
    print(f"written: {path}\nVERIFY.md follows it: cargo run -p props -- ledger > VERIFY.md")


if __name__ == "__main__":
    main()
