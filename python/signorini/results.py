"""The types of `Solution.results`: what result.json has (docs/result.md). A key that a run may leave out is not required."""

from __future__ import annotations

from typing import Any, Dict, List, TypedDict


class Units(TypedDict):
    length: str
    force: str


class _Material(TypedDict):
    surfaces: List[str]
    plane: str


class Material(_Material, total=False):
    young: float
    poisson: float
    stiffness: List[float]


class Choices(TypedDict):
    degree: int
    gamma0_auto: bool
    contact_quadrature: str
    allow_noncoercive: bool


class Mesh(TypedDict):
    vertices: int
    triangles: int
    dofs: int
    contact_edges: int
    h_max: float


class Gamma(TypedDict):
    gamma0: float
    local: bool
    limit: float
    kappa: float
    limiting_edge: List[List[float]]


class Newton(TypedDict):
    iterations: int
    residuals: List[float]
    residual: float
    factorizations: int
    status: str


class _Method(TypedDict):
    route: str
    predicted_operations: float
    condition: float
    threads: int
    slides: int


class Method(_Method, total=False):
    forward_error: float


class Quantities(TypedDict):
    a_uu: float
    elastic_energy: float
    work: float
    max_displacement: float
    contact_force: float
    contact_resultant: List[float]
    contact_length: float
    peak_pressure: float
    reactions: Dict[str, List[float]]


class ContactBoundary(TypedDict):
    boundary: str
    force: float
    resultant: List[float]
    moment: float
    length: float
    stretches: List[List[List[float]]]
    peak_pressure: float
    peak_at: List[float]
    penetration: float
    penetration_at: List[float]


class _Peak(TypedDict):
    value: float
    at: List[float]


class StressPeak(_Peak, total=False):
    surface: str


class _Stress(TypedDict):
    von_mises: StressPeak
    principal_max: StressPeak
    principal_min: StressPeak


class Stress(_Stress, total=False):
    hoop_max: StressPeak
    hoop_min: StressPeak


class Balance(TypedDict):
    strain: float
    loads: float
    supports: float
    contact: float
    imbalance: float


class Certificate(TypedDict, total=False):
    discrete: Dict[str, Any]
    continuous: Dict[str, Any]


class Errors(TypedDict):
    energy: float
    h1: float
    l2: float
    contact_residual: float
    normal_stress: float


class Seconds(TypedDict):
    read: float
    assemble: float
    solve: float
    certify: float
    write: float


class _Results(TypedDict):
    version: str
    case: str
    schema: int
    title: str
    verdict: str
    mesh: Mesh
    gamma: Gamma
    newton: Newton
    quantities: Quantities
    contact: List[ContactBoundary]
    stress: Stress
    seconds: Seconds


class Results(_Results, total=False):
    reason: str
    missing: List[str]
    units: Units
    thickness: float
    materials: List[Material]
    choices: Choices
    remarks: List[str]
    method: Method
    reaction_moments: Dict[str, float]
    balance: Balance
    probes: List[List[float]]
    certificate: Certificate
    adapt: Dict[str, Any]
    errors: Errors
