"""python3 .ci/faults.py PROGRAM [--rounds N]

What a command meets in the open: it is killed at any moment, finds the disk full, and gets much of everything. The program must leave
sets of files that are whole or not there, and end with a documented exit code, never by a panic. Races of two runs are tested in
`src/io/files.rs`, folders that somebody else has prepared in `tests/suite/doors.rs`. A small disk needs leave to mount one (root); without it
that part says so.
"""

import argparse
import hashlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CASE = """title = "{title}"
[mesh]
rectangle = {{ width = 1.0, height = 1.0, nx = {n}, ny = {n} }}
[material]
lambda = 1.0
mu = 1.0
[load]
body = ["0", "{load} + 10*x"]
[boundary.top]
displacement = ["0", "0"]
[boundary.bottom]
contact = {{ gap = "0" }}
"""
FILES = {"contact.csv", "contact.vtu", "picture.svg", "result.json", "solution.vtu"}

# Seconds of processor time for a large input, at most; a quadratic one takes minutes.
PATIENCE = 10


class Fault(Exception):
    pass


def expect(true, message):
    if not true:
        raise Fault(message)


def digest(folder):
    """{name: hash} of the files of a set; of result.json without the times, which no two runs share."""
    found = {}
    for name in FILES:
        content = (folder / name).read_bytes()
        if name == "result.json":
            content = content[: content.index(b'"seconds"')]
        found[name] = hashlib.sha256(content).hexdigest()
    return found


def temporary(folder):
    """The names of temporary folders in a folder."""
    here = folder.iterdir() if folder.exists() else []
    return {path.name for path in here if path.name.startswith(".signorini-") and path.name.endswith(".tmp")}


def processor_time():
    """Of all processes started here that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def strip(squares):
    """A strip of unit squares as a mesh of Gmsh, each edge of its long sides a boundary with a name of its own: b0, b1, .. below
    from left to right, and on above them."""
    n = squares + 1
    names = "".join(f'1 {i + 1} "b{i}"\n' for i in range(2 * squares))
    curves = "".join(f"{i + 1} 0 0 0 1 1 0 1 {i + 1} 0\n" for i in range(2 * squares))
    tags = "".join(f"{i + 1}\n" for i in range(2 * n))
    places = "".join(f"{i} {j} 0\n" for j in (0, 1) for i in range(n))
    ends = [(i + 1, i + 2) for i in range(squares)] + [(n + i + 2, n + i + 1) for i in range(squares)]
    lines = "".join(f"1 {i + 1} 1 1\n{i + 1} {a} {b}\n" for i, (a, b) in enumerate(ends))
    corners = [c for i in range(1, n) for c in ((i, i + 1, n + i + 1), (i, n + i + 1, n + i))]
    triangles = "".join(f"{2 * squares + 1 + t} {a} {b} {c}\n" for t, (a, b, c) in enumerate(corners))
    return (
        f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{2 * squares}\n{names}$EndPhysicalNames\n"
        f"$Entities\n0 {2 * squares} 1 0\n{curves}1 0 0 0 {squares} 1 0 0 0\n$EndEntities\n"
        f"$Nodes\n1 {2 * n} 1 {2 * n}\n2 1 0 {2 * n}\n{tags}{places}$EndNodes\n"
        f"$Elements\n{2 * squares + 1} {4 * squares} 1 {4 * squares}\n{lines}2 1 2 {2 * squares}\n{triangles}$EndElements\n"
    )


class Bench:
    def __init__(self, program, rounds):
        self.program, self.rounds = program, rounds
        self.random = random.Random(20130701)
        self.room = Path(tempfile.mkdtemp(prefix="signorini-faults-"))

    def cases(self, n):
        """Two cases on one mesh whose files differ, and {digest: case}."""
        known = {}
        for k, load in enumerate((-4, -3)):
            case = self.room / f"case{k}.toml"
            case.write_text(CASE.format(title=f"Case {k}", n=n, load=load))
            out = self.room / f"good{k}"
            run = self.run("solve", case, "--quiet", "--out", out)
            expect(run.returncode == 0, f"a good case: {run.stderr}")
            known[frozenset(digest(out).items())] = k
        expect(len(known) == 2, "the two cases should have different files")
        return [self.room / f"case{k}.toml" for k in (0, 1)], known

    def run(self, *arguments, **options):
        return subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)

    def start(self, *arguments):
        return subprocess.Popen([self.program, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def whole(self, out, known, what):
        """A set that has its result.json is one of the known ones; what else is there is a temporary folder."""
        names = {path.name for path in out.iterdir()} if out.exists() else set()
        left = temporary(out)
        expect(names - left <= FILES, f"{what}: unexpected files {sorted(names - left - FILES)}")
        if "result.json" in names:
            expect(FILES <= names, f"{what}: a result.json without {sorted(FILES - names)}")
            found = frozenset(digest(out).items())
            origin = {name: [k for good, k in known.items() if (name, value) in good] for name, value in found}
            expect(found in known, f"{what}: files of two runs are mixed: {origin}")
        return "result.json" in names, left

    def kills(self):
        """A run over an earlier one is stopped at a random moment."""
        cases, known = self.cases(40)
        out = self.room / "kills" / "case"
        start = time.monotonic()
        self.run("solve", cases[0], "--quiet", "--out", out)
        usual = time.monotonic() - start
        counts = {"killed": 0, "whole": 0, "left": 0}
        left = set()
        for i in range(self.rounds):
            how = self.random.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
            if self.random.random() < 0.2:
                shutil.rmtree(out.parent, ignore_errors=True)
            before = temporary(out)
            run = self.start("solve", cases[i % 2], "--quiet", "--out", out)
            time.sleep(self.random.uniform(0, 1.2 * usual))
            run.send_signal(how)
            code = run.wait()
            expect(code in (0, -how), f"kills: {how.name} gave {code}: {run.stderr.read()}")
            whole, left = self.whole(out, known, f"kills: {how.name}")
            expect(before <= left, f"kills: {how.name} removed {sorted(before - left)}, which is not its own")
            expect(len(left - before) <= (code != 0), f"kills: {how.name}, code {code} left {sorted(left - before)}")
            counts["killed"] += code != 0
            counts["whole"] += whole
            counts["left"] += len(left - before)
        expect(self.run("solve", cases[0], "--quiet", "--out", out).returncode == 0, "kills: the last run")
        expect(self.whole(out, known, "kills: the last run") == (True, left), "kills: the last run is not whole, or left something")
        return f"{self.rounds} runs, {counts['killed']} of them stopped, {counts['whole']} whole sets, none mixed; {counts['left']} times a temporary folder stayed"

    def small_disk(self):
        """Disks on which a set does not fit: the earlier one stays."""
        disk = self.room / "disk"
        disk.mkdir()
        cases, known = self.cases(24)
        refused = 0
        for size in (16, 64, 128, 256, 300, 400, 512, 700, 1000, 4000):
            mount = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", disk], capture_output=True, text=True)
            if mount.returncode:
                return f"not run: no leave to mount a small disk ({mount.stderr.strip()})"
            try:
                for case in (cases[0], cases[1], cases[0]):
                    out = disk / "case"
                    before = digest(out) if (out / "result.json").exists() else None
                    run = self.run("solve", case, "--quiet", "--out", out)
                    expect(run.returncode in (0, 1), f"disk of {size} k: {run.returncode}: {run.stderr}")
                    whole, left = self.whole(out, known, f"disk of {size} k")
                    expect(not left, f"disk of {size} k: left {sorted(left)}")
                    if run.returncode == 1:
                        refused += 1
                        expect("No space left on device" in run.stderr, run.stderr)
                        expect(whole == (before is not None), f"disk of {size} k: the earlier set is gone")
                        expect(before is None or digest(out) == before, f"disk of {size} k: the earlier set has changed")
            finally:
                subprocess.run(["umount", disk], check=True)
        expect(refused > 3, "the disks were not small enough")
        return f"{refused} runs refused for lack of space, the earlier set as it was"

    def large_inputs(self):
        """Many of everything: the time grows like the number, not like its square."""
        folder = self.room / "large"
        folder.mkdir()
        head, rest = CASE.format(title="Large", n=128, load=-4).split("[material]")
        case = "[material]" + rest
        points = [[self.random.random(), self.random.random()] for _ in range(10_000)]
        small = CASE.format(title="Large", n=4, load=-4)
        middling = CASE.format(title="Large", n=32, load=-4)
        inputs = {
            "10,000 probes": f"{head}{case}[output]\nprobes = {points}\n",
            "5,000 terms": middling.replace("-4 + 10*x", "-4" + " + 1e-4*x" * 4_999),
            "3,000 terms that are no polynomial": middling.replace("-4 + 10*x", "-4" + " + 1e-4*sin(x)" * 3_000),
            "32,000 boundaries that are not there": small + "".join(f"[boundary.b{i}]\ntraction = [\"0\", \"0\"]\n" for i in range(32_000)),
            "32,000 boundaries": '[mesh]\ngmsh = "strip.msh"\n' + case.split("[boundary.top]")[0].replace("-4 + 10*x", "-1e-6")
            + "".join(f"[boundary.b{i}]\n" + ("contact = {}\n" if i < 100 else 'displacement = ["0", "0"]\n' if i >= 16_000 else 'traction = ["0", "0"]\n')
                      for i in range(32_000)),
        }
        (folder / "strip.msh").write_text(strip(16_000))
        said = []
        for name, text in inputs.items():
            file = folder / "case.toml"
            file.write_text(text)
            # What else the machine does lengthens a run: the quickest of up to three counts.
            for _ in range(3):
                before = processor_time()
                run = self.run("solve", file, "--quiet", "--out", folder / "out")
                seconds = processor_time() - before
                if seconds <= PATIENCE:
                    break
            expected = 2 if "not there" in name else 0
            expect(run.returncode == expected, f"large inputs: {name}: {run.returncode}: {run.stderr[:2000]}")
            expect(len(run.stderr) < 3000, f"large inputs: {name}: a message of {len(run.stderr)} characters")
            expect(seconds < PATIENCE, f"large inputs: {name} took {seconds:.1f} s, expected at most {PATIENCE} s")
            said.append(f"{name} {seconds:.1f} s")
        return ", ".join(said)


def main():
    parser = argparse.ArgumentParser(prog="python3 .ci/faults.py")
    parser.add_argument("program", help="the command signorini, built")
    parser.add_argument("--rounds", type=int, default=100, help="random kills")
    options = parser.parse_args()
    bench = Bench(str(Path(options.program).resolve()), options.rounds)
    failed = False
    try:
        for part in (bench.kills, bench.small_disk, bench.large_inputs):
            start = time.monotonic()
            try:
                said = part()
            except Fault as fault:
                failed, said = True, f"FAULT: {fault}"
            print(f"{part.__name__}: {said} ({time.monotonic() - start:.0f} s)", flush=True)
    finally:
        shutil.rmtree(bench.room, ignore_errors=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
