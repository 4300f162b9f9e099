"""What the Python module promises. Run by pytest, with the module, meshio and mypy installed."""

import json
import pickle
import subprocess
import sys
import typing
from pathlib import Path

import meshio
import numpy as np
import pytest

import signorini

CASES = Path(__file__).resolve().parents[2] / "cases"


def square(n):
    """The unit square in n x n cells with diagonals right, as the case files have it."""
    x = np.linspace(0, 1, n + 1)
    points = np.array([(a, b) for b in x for a in x])
    corner = lambda i, j: j * (n + 1) + i
    triangles = []
    for j in range(n):
        for i in range(n):
            a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
            triangles += [(a, b, c), (a, c, d)]
    bottom = [(corner(i, 0), corner(i + 1, 0)) for i in range(n)]
    top = [(corner(i, n), corner(i + 1, n)) for i in range(n)]
    return points, np.array(triangles), {"bottom": np.array(bottom), "top": np.array(top)}


BLOCK = {
    "material": {"lambda": 1.0, "mu": 1.0},
    "load": {"body": [0, "-4 + 10*x"]},
    "boundary": {"top": {"displacement": [0, 0]}, "bottom": {"contact": {"gap": 0}}},
    "method": {"gamma0": "auto"},
}


def test_a_case_file_gives_arrays_that_fit_together():
    solution = signorini.solve_case(CASES / "block.toml", set={"mesh.rectangle.nx": 8, "mesh.rectangle.ny": 8})
    mesh = solution.results["mesh"]
    assert solution.nodes.shape == solution.displacement.shape == (81, 2)
    assert solution.elements.shape == (128, 3) == (mesh["triangles"], 3)
    assert solution.stress.shape == (128, 4) and solution.von_mises.shape == (128,)
    assert solution.contact.arc.shape == solution.contact.pressure.shape == (16,)
    assert (solution.contact.pressure >= 0).all() and solution.contact.pressure.max() > 1
    # The pressure is the recovered one, of the summary and contact.csv; lambda^h is beside it.
    assert solution.contact.pressure.max() == solution.results["contact"][0]["peak_pressure"]
    assert -solution.contact.lambda_h.min() == solution.results["quantities"]["peak_pressure"] != solution.contact.pressure.max()
    largest = np.hypot(*solution.displacement.T).max()
    assert largest == pytest.approx(solution.results["quantities"]["max_displacement"], rel=1e-15)
    # The contact line is the bottom, from left to right.
    assert (solution.nodes[solution.contact.node][:, 1] == 0).all()
    assert (np.diff(solution.contact.arc) >= 0).all()
    assert solution.contact.boundary.tolist() == 16 * ["bottom"]


def test_a_mesh_of_arrays_gives_the_same_as_the_case_file_to_the_bit():
    ours = signorini.solve(*square(8), **BLOCK)
    theirs = signorini.solve_case(
        CASES / "block.toml",
        set={"mesh.rectangle.nx": 8, "mesh.rectangle.ny": 8, "method.gamma0": "auto"},
    )
    assert (ours.displacement == theirs.displacement).all()
    assert ours.results["quantities"] == theirs.results["quantities"]


def test_degree_2_has_nodes_on_the_edges():
    solution = signorini.solve(*square(4), **{**BLOCK, "method": {"degree": 2}})
    assert solution.elements.shape == (32, 6)
    a, b, c, d, e, f = (solution.nodes[solution.elements[:, i]] for i in range(6))
    for middle, ends in [(d, (b, c)), (e, (c, a)), (f, (a, b))]:
        assert np.abs(middle - sum(ends) / 2).max() < 1e-15


def test_a_meshio_mesh_is_taken_as_it_is_with_physical_names():
    mesh = meshio.read(CASES / "disk.msh")
    solution = signorini.solve(
        mesh,
        material={"young": 1000.0, "poisson": 0.3},
        obstacle={"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
        boundary={"top": {"displacement": [0, -0.015]}, "contact": {"contact": {"obstacle": "floor"}}},
    )
    theirs = signorini.solve_case(CASES / "disk.toml")
    force = solution.results["quantities"]["contact_force"]
    # The vertices may have other numbers, so the sums are rounded otherwise.
    assert force == pytest.approx(theirs.results["quantities"]["contact_force"], rel=1e-9)


def test_clockwise_triangles_stray_points_and_cell_sets_of_meshio_are_understood():
    points, triangles, boundaries = square(4)
    lines = np.concatenate([boundaries["bottom"], boundaries["top"]])
    k = len(boundaries["bottom"])
    mesh = meshio.Mesh(
        np.vstack([points, [[9.0, 9.0]]]),
        [("triangle", triangles[:, ::-1]), ("line", lines)],
        cell_sets={"bottom": [[], list(range(k))], "top": [[], list(range(k, 2 * k))]},
    )
    ours, theirs = signorini.solve(mesh, **BLOCK), signorini.solve(*square(4), **BLOCK)
    assert np.abs(ours.displacement - theirs.displacement).max() < 1e-12


@pytest.mark.parametrize(
    "change, message",
    [
        ({"material": {"lambda": 1.0, "mu": -1.0}}, r"\[material\] mu = -1.0; expected a positive number"),
        ({"materiel": {}}, "unknown key 'materiel'"),
        ({"mesh": {"gmsh": "x"}}, "mesh"),
        ({"method": {"gamma0": 1e9}}, "coercivity needs kappa < 1"),
        ({"load": {"body": [float("nan"), 0]}}, "body"),
    ],
)
def test_a_wrong_case_is_a_value_error_with_the_message_of_the_command(change, message):
    with pytest.raises(signorini.CaseError, match=message) as caught:
        signorini.solve(*square(2), **{**BLOCK, **change})
    assert isinstance(caught.value, ValueError)


def test_wrong_arrays_are_refused_by_name():
    points, triangles, boundaries = square(2)
    for arguments, message in [
        ((points[:, :1], triangles, boundaries), r"points has shape \(9, 1\); expected \(n, 2\)"),
        ((points, triangles[:, :2], boundaries), r"triangles has shape \(8, 2\); expected \(n, 3\)"),
        ((points, triangles + 0.5, boundaries), "triangles is of float64; expected whole numbers"),
        ((points, triangles - 1, boundaries), "found point number -1; expected one from 0 on"),
        ((points, triangles + 1, boundaries), "names vertex 9"),
        ((points, triangles[:, ::-1], boundaries), "list its vertices counter-clockwise"),
    ]:
        with pytest.raises(signorini.CaseError, match=message):
            signorini.solve(*arguments, **BLOCK)
    with pytest.raises(TypeError):
        signorini.solve(points)


def test_a_case_that_does_not_converge_is_a_runtime_error():
    with pytest.raises(signorini.SolveError, match="no convergence") as caught:
        signorini.solve(*square(8), **BLOCK, solver={"max_iterations": 1})
    assert isinstance(caught.value, RuntimeError)


def test_an_error_is_shown_by_the_name_that_catches_it():
    for error in (signorini.CaseError, signorini.SolveError):
        assert getattr(signorini, error.__name__) is error and error.__module__ == "signorini"


def test_a_missing_file_is_named():
    with pytest.raises(signorini.CaseError, match="nowhere.toml: there is no such file"):
        signorini.solve_case("nowhere.toml")


def test_surfaces_and_points_of_a_meshio_mesh_keep_their_names():
    steel, rubber = {"young": 210000.0, "poisson": 0.3}, {"young": 10.0, "poisson": 0.45}
    solution = signorini.solve(
        meshio.read(CASES / "bracket.msh"),
        material={"steel": steel, "rubber": rubber},
        load={"steel": {"body": [0, -7.7e-5]}},
        obstacle={
            "ground": {"plane": {"point": [0, -4], "normal": [0, 1]}},
            "masonry": {"plane": {"point": [0, 0], "normal": [1, 0]}},
        },
        boundary={
            "hole": {"displacement": [-0.03, -0.08]},
            "floor": {"contact": {"obstacle": "ground"}},
            "wall": {"contact": {"obstacle": "masonry"}},
        },
        method={"degree": 2},
    )
    theirs = signorini.solve_case(CASES / "bracket.toml")
    assert solution.results["stress"]["von_mises"]["surface"] == "steel"
    force = solution.results["quantities"]["contact_force"]
    assert force == pytest.approx(theirs.results["quantities"]["contact_force"], rel=1e-9)


def test_named_points_hold_a_body():
    points, triangles, boundaries = square(2)
    case = {**BLOCK, "boundary": {"bottom": {"contact": {"gap": 0}}, "top": {"traction": [0, -0.01]}}}
    held = signorini.solve(
        points, triangles, boundaries, named_points={"pivot": 0}, point={"pivot": {"displacement": [0, "free"]}},
        **{**case, "load": {}},
    )
    assert held.displacement[0, 0] == 0 and held.results["method"]["slides"] == 0
    with pytest.raises(signorini.CaseError, match="surface 'part' has shape"):
        signorini.solve(points, triangles, boundaries, surfaces={"part": [[0]]}, **BLOCK)


def test_a_solution_is_shown_compared_pickled_and_written(tmp_path):
    solution, other = (signorini.solve(*square(4), **BLOCK) for _ in range(2))
    assert repr(solution).startswith("case\n  contact      bottom: force ") and "written" not in repr(solution)
    assert solution._repr_svg_().startswith("<svg") and "peak" in solution._repr_svg_()
    assert solution == solution and solution != other and solution.contact != other.contact
    assert solution.verdict == "proved" and solution.certified == {}
    written = solution.write(tmp_path / "out", report=True)
    names = {"solution.vtu", "contact.vtu", "contact.csv", "picture.svg", "report.html", "result.json"}
    assert {Path(path).name for path in written} == names
    assert (tmp_path / "out" / "picture.svg").read_text() == solution._repr_svg_()
    again = pickle.loads(pickle.dumps(solution))
    assert (again.displacement == solution.displacement).all() and repr(again) == repr(solution)
    with pytest.raises(RuntimeError, match="pickle"):
        again.write(tmp_path / "again")
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="cannot make the folder"):
        solution.write(tmp_path / "file" / "out")


def missing(value, declared, path=""):
    """The keys of a result that its type does not declare."""
    if not isinstance(value, dict) or not hasattr(declared, "__annotations__"):
        return []
    hints = typing.get_type_hints(declared)
    found = [f"{path}{key}" for key in value if key not in hints]
    for key in value.keys() & hints.keys():
        hint, inner = hints[key], value[key]
        if typing.get_origin(hint) is list and inner:
            hint, inner = typing.get_args(hint)[0], inner[0]
        found += missing(inner, hint, f"{path}{key}.")
    return found


def test_the_types_of_the_results_declare_every_key():
    for case, settings in [
        ("bracket", {"body.thickness": 2, "output.probes": [[20, 10]]}),
        ("singular", {"mesh.rectangle.nx": 2, "mesh.rectangle.ny": 2}),
    ]:
        results = signorini.solve_case(CASES / f"{case}.toml", set=settings).results
        assert missing(results, signorini.Results) == []
        required = signorini.Results.__required_keys__
        assert required <= results.keys(), required - results.keys()


def test_the_design_study_of_the_readme_runs(tmp_path, monkeypatch):
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    readme = (Path(__file__).resolve().parents[1] / "README.md").read_text()
    program = readme.split("## A design study")[1].split("```python\n")[1].split("```")[0]
    space = {}
    exec(program.replace("np.geomspace(5, 100, 30)", "np.geomspace(5, 100, 3)"), space)
    assert (tmp_path / "cam.png").stat().st_size > 1000
    assert space["peaks"] == sorted(space["peaks"], reverse=True)


def test_the_types_are_what_mypy_expects(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(
        "import numpy as np\nimport signorini\n"
        "s = signorini.solve_case('a.toml', set={'method.degree': 2})\n"
        "reveal_type(s.displacement)\nx: int = s.nodes\n"
        "peak: float = max(part['peak_pressure'] for part in s.results['contact'])\n"
        "print(s.certified, s.write('out'), s.results['quantities']['contact_force'])\n"
    )
    run = subprocess.run([sys.executable, "-m", "mypy", "--strict", str(program)], capture_output=True, text=True)
    assert "floating" in run.stdout or "float64" in run.stdout, run.stdout
    assert "Found 1 error" in run.stdout and "Incompatible types in assignment" in run.stdout, run.stdout


def test_results_are_plain_json():
    solution = signorini.solve(*square(2), **BLOCK)
    assert json.loads(json.dumps(solution.results)) == solution.results


def test_an_adapted_solution_has_forces_between_two_numbers():
    solution = signorini.solve_case(
        CASES / "block.toml", set={"mesh.rectangle.nx": 4, "mesh.rectangle.ny": 4, "method.gamma0": "auto", "adapt.target": "15 %"}
    )
    low, high = solution.certified["contact force", "bottom"]
    assert 0 <= low <= solution.results["quantities"]["contact_force"] <= high
    low, high = solution.certified["peak pressure", "bottom"]
    assert low > 0 and high == float("inf")
    assert solution.certified["reaction y", "top"][0] < 0
    assert signorini.solve_case(CASES / "block.toml").certified == {}
