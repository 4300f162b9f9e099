from typing import Callable, Dict, List, Tuple, TypedDict

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
    place: bytes
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

class PlaneMesh(TypedDict):
    points: bytes
    triangles: bytes
    boundaries: Dict[str, bytes]
    surfaces: Dict[str, bytes]
    named_points: Dict[str, int]
    remarks: List[str]

def solve_case(path: str, settings: List[str], certificate: bool) -> Solved: ...
def solve(
    text: str,
    arrays: Tuple[bytes, bytes, List[Tuple[str, bytes]], List[Tuple[str, bytes]], List[Tuple[str, int]]],
    functions: List[Callable[[float, float], float]],
    remarks: List[str],
    certificate: bool,
) -> Solved: ...
def plane_mesh(
    nodes: bytes, blocks: List[Tuple[int, bytes, bytes]], names: List[List[Tuple[int, List[str]]]], pairs: List[List[str]]
) -> PlaneMesh: ...
