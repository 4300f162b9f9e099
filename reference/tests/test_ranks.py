"""The command on 1, 2 and 4 processes, and its exit codes."""

import json
import os
import subprocess
import sys

from fenicsx.store import differences

from .support import BLOCK, CASES, ROOT, TestCase


def command(*arguments):
    environment = os.environ | {"PYTHONPATH": str(ROOT / "reference"), "OMP_NUM_THREADS": "1"}
    return subprocess.run([sys.executable, "-m", "fenicsx", *map(str, arguments)], env=environment, capture_output=True, text=True, timeout=300)


class Ranks(TestCase):
    def test_1_2_and_4_processes_give_the_same_numbers(self):
        runs = (("cantilever-p2-gauss4-n8", []), ("gap-p1-exact-n8", []), ("smooth-p2-exact-n8", ["--iterative"]), ("friction-stay-p1-exact", []),
                ("friction-drag-p2-gauss11", []))
        for name, option in runs:
            results = {}
            for ranks in (1, 2, 4):
                out = self.folder / f"{name}{ranks}"
                done = command(CASES / f"{name}.toml", "--out", out, "--ranks", ranks, *option)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(f"{ranks} process(es)", done.stdout)
                results[ranks] = json.loads((out / "result.json").read_text())
            for ranks in (2, 4):
                with self.subTest(f"{name} {option} {ranks}"):
                    self.assertLess(max(value for _, value in differences(results[1], results[ranks])), 1e-11)


class Codes(TestCase):
    def test_more_processes_than_triangles_are_refused(self):
        text = BLOCK.replace("nx = 4, ny = 4", "nx = 1, ny = 1")
        done = command(self.file(text), "--out", self.folder / "nothing", "--ranks", 4)
        self.assertEqual(done.returncode, 2)
        self.assertIn("mesh: a process has no triangle, expected fewer processes", done.stderr)

    def test_a_wrong_case_ends_with_2_and_writes_nothing(self):
        out = self.folder / "nothing"
        for ranks in (1, 2):
            done = command(self.file(BLOCK.replace("degree = 1", "degree = 3")), "--out", out, "--ranks", ranks)
            self.assertEqual(done.returncode, 2)
            self.assertIn("method.degree: found 3, expected 1 or 2", done.stderr)
            self.assertFalse(out.exists())

    def test_a_case_that_cannot_be_solved_ends_with_1_and_writes_nothing(self):
        out = self.folder / "nothing"
        done = command(self.file(BLOCK.replace("degree = 1", "[solver]\nmax_iterations = 1")), "--out", out)
        self.assertEqual(done.returncode, 1)
        self.assertIn("after 1 iterations", done.stderr)
        self.assertFalse(out.exists())

    def test_an_output_folder_that_cannot_be_made_ends_with_1(self):
        self.file("", "file")
        for ranks in (1, 2):
            done = command(self.file(BLOCK), "--out", self.folder / "file" / "inside", "--ranks", ranks)
            self.assertEqual(done.returncode, 1)
            self.assertIn("Not a directory", done.stderr)

    def test_nx_refines_in_proportion(self):
        out = self.folder / "finer"
        self.assertEqual(command(CASES / "cantilever-p1-exact-n8.toml", "--nx", 12, "--out", out).returncode, 0)
        self.assertEqual(json.loads((out / "result.json").read_text())["mesh"]["triangles"], 2 * 12 * 6)
        done = command(CASES / "cantilever-p1-exact-n8.toml", "--nx", 5, "--out", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--nx 5: expected a rectangle whose ny = 4 scales with it to an integer", done.stderr)
