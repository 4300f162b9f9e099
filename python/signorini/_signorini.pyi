from typing import List, Tuple, TypedDict

__version__: str

class CaseError(ValueError):
    """The case is wrong."""

class SolveError(RuntimeError):
    """The case is right, but there is no solution."""

class Raw(TypedDict):
    nodes: bytes
    elements: bytes
    nodes_per_triangle: int
    displacement: bytes
    stress: bytes
    von_mises: bytes
    arc: bytes
    node: bytes
    u_n: bytes
    gap: bytes
    sigma_n: bytes
    lambda_h: bytes
    pressure: bytes
    boundary: List[str]
    results: str

class Solved:
    def arrays(self) -> Raw: ...
    def summary(self) -> str: ...
    def picture(self) -> str: ...
    def write(self, folder: str, report: bool) -> List[str]: ...

def solve_case(path: str, settings: List[str]) -> Solved: ...
def solve(
    text: str,
    points: bytes,
    triangles: bytes,
    boundaries: List[Tuple[str, bytes]],
    surfaces: List[Tuple[str, bytes]],
    named_points: List[Tuple[str, int]],
) -> Solved: ...
