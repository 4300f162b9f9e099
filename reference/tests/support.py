"""What the tests share: small case files in a temporary folder, and their solution on this process alone."""

import logging
import tempfile
import unittest
from pathlib import Path

from mpi4py import MPI

from fenicsx.solve import solve

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "reference" / "cases"

BLOCK = """
[mesh]
rectangle = { width = 1.0, height = 1.0, nx = 4, ny = 4, diagonal = "right" }
[material]
lambda = 1.0
mu = 1.0
[load]
body = ["0", "-4 + 10*x"]
[boundary.top]
displacement = ["0", "0"]
[boundary.bottom]
contact = { gap = "0" }
[method]
degree = 1
"""


class TestCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        logging.disable(logging.WARNING)  # the form compiler reports each C file, and leaves it open
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)

    def file(self, text, name="case.toml"):
        path = self.folder / name
        path.write_text(text)
        return path

    def solve(self, path, **options):
        return solve(path, MPI.COMM_SELF, **options)
