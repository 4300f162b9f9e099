"""What the Python module promises. Run by pytest, with the module, meshio and mypy installed."""

import json
import pickle
import signal
import subprocess
import sys
import time
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
    for middle, ends in [(d, (a, b)), (e, (b, c)), (f, (c, a))]:
        assert np.abs(middle - sum(ends) / 2).max() < 1e-15


def test_a_body_of_revolution_has_forces_of_the_whole_and_hoop_stresses():
    """A cylinder under a pressure of 0.01: u_r = nu p r / E, u_z = -p z / E, and the force pi p."""
    case = {
        "material": {"young": 2.0, "poisson": 0.3},
        "body": {"plane": "axisymmetric"},
        "boundary": {"top": {"pressure": 0.01}, "bottom": {"contact": {"gap": 0}}},
    }
    for degree in (1, 2):
        solution = signorini.solve(*square(4), **case, method={"degree": degree})
        r, z = solution.nodes.T
        expected = np.stack([0.3 * 0.01 * r / 2, -0.01 * z / 2], axis=1)
        assert np.abs(solution.displacement - expected).max() < 1e-13
        assert solution.results["quantities"]["contact_force"] == pytest.approx(0.01 * np.pi, rel=1e-12)
        assert solution.verdict == "proved" and solution.results["stress"]["hoop_max"]["value"] < 1e-13
        # sigma_rr, sigma_zz, the hoop stress and sigma_rz.
        assert np.abs(solution.stress - [0, -0.01, 0, 0]).max() < 1e-13
        assert "scale(-1" in solution._repr_svg_() and "of the whole revolution" in repr(solution)
    # The control: a plate of that section.
    plate = signorini.solve(*square(4), **{**case, "body": {"plane": "strain"}})
    assert plate.results["quantities"]["contact_force"] == pytest.approx(0.01, rel=1e-12)
    beyond = square(4)[0] - [0.5, 0]
    with pytest.raises(signorini.CaseError, match="the axis, which is x = 0"):
        signorini.solve(beyond, *square(4)[1:], **case)


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
        ((points, triangles - 1, boundaries), "triangles: found the number -1; expected one from 0 on"),
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
    assert repr(solution).startswith("Contact problem\n  contact      bottom: force ") and "written" not in repr(solution)
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
        ("hub", {}),
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


def meshio_square(change=lambda triangles: triangles, top=None, kind="triangle"):
    points, triangles, boundaries = square(4)
    lines = [boundaries["bottom"], boundaries["top"] if top is None else top]
    count = [len(line) for line in lines]
    return meshio.Mesh(
        np.c_[points, np.zeros(len(points))],
        [(kind, change(triangles)), ("line", lines[0]), ("line", lines[1])],
        cell_sets={"bottom": [[], list(range(count[0])), []], "top": [[], [], list(range(count[1]))]},
    )


def test_wrong_meshes_are_refused_as_the_command_refuses_them():
    points, triangles, boundaries = square(4)
    half = list(range(16))
    both = {"a": {"lambda": 1.0, "mu": 1.0}, "b": {"lambda": 1.0, "mu": 100.0}}
    whole = list(range(32))
    arrays = lambda **more: signorini.solve(points, triangles, boundaries, **{**BLOCK, **more})
    top = square(4)[2]["top"]
    for solve, message in [
        (lambda: arrays(surfaces={"a": whole, "b": half}, material=both), "share a triangle"),
        (lambda: arrays(surfaces={"b": half, "a": whole}, material=both), "share a triangle"),
        (lambda: arrays(surfaces={"a": whole + [99]}, material={"a": both["a"]}), "surface 'a' names triangle 99; expected numbers from 0 on of the 32"),
        (lambda: arrays(surfaces={"a": np.ones(32, dtype=bool)}, material={"a": both["a"]}), "surface 'a' is of bool; expected whole numbers"),
        (lambda: arrays(named_points={"p": 1.9}), "point 'p' is 1.9; expected the number of a point"),
        (lambda: arrays(named_points={"p": True}), "point 'p' is True"),
        (lambda: arrays(named_points={"p": 99}), "point 'p' names vertex 99"),
        (lambda: arrays(named_points={"p": -1}), "point 'p': found the number -1"),
        (lambda: signorini.solve(points, triangles, {**boundaries, "x": [[0, 99]]}, **BLOCK), "boundary 'x' names vertex 99"),
        (lambda: signorini.solve(np.ma.masked_array(points, points > 0.5), triangles, boundaries, **BLOCK), "^points has masked entries"),
        (lambda: signorini.solve(points + 0j, triangles, boundaries, **BLOCK), "points is of complex128; expected real numbers"),
        (lambda: signorini.solve([[0, 0], [1]], triangles, boundaries, **BLOCK), "points is no array of numbers"),
        (lambda: signorini.solve(meshio_square(lambda t: np.where(t == 24, -1, t)), **BLOCK), "names points from -1 to 23; expected 0 to 24"),
        (lambda: signorini.solve(meshio_square(top=np.where(top == 24, -1, top)), **BLOCK), "names points from -1 to 23"),
        (lambda: signorini.solve(meshio_square(lambda t: t + 0.5), **BLOCK), "is of float64; expected whole numbers"),
        (lambda: signorini.solve(meshio_square(lambda t: t + 1), **BLOCK), "names points from 1 to 25; expected 0 to 24"),
        (lambda: signorini.solve(meshio.Mesh(np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])]), **BLOCK), "3D is not solved"),
    ]:
        with pytest.raises(signorini.CaseError, match=message):
            solve()
    solution = signorini.solve(meshio_square(), **BLOCK)
    assert solution.verdict == "proved", "control"


def test_quadrangles_second_order_and_sets_that_no_table_names_are_read():
    points, triangles, boundaries = square(4)
    corner = np.arange(25).reshape(5, 5)
    quads = np.column_stack([corner[:-1, :-1].ravel(), corner[:-1, 1:].ravel(), corner[1:, 1:].ravel(), corner[1:, :-1].ravel()])
    theirs = signorini.solve(points, triangles, boundaries, **BLOCK)
    with pytest.warns(UserWarning, match="16 quadrangles of the mesh are split"):
        ours = signorini.solve(meshio_square(lambda _: quads, kind="quad"), **BLOCK)
    assert np.abs(ours.displacement - theirs.displacement).max() < 1e-12
    # The same with a middle on each edge, and with a set of all lines and one of lines inside the body.
    flat = meshio_square()
    middles = [(points[triangles[:, i]] + points[triangles[:, (i + 1) % 3]]) / 2 for i in range(3)]
    six = np.column_stack([triangles] + [25 + 32 * i + np.arange(32) for i in range(3)])
    lines = [block.data for block in flat.cells[1:]]
    cells = [("triangle6", six), ("line", lines[0]), ("line", lines[1]), ("line", [[0, 6]])]
    sets = {"bottom": [[], range(4), [], []], "top": [[], [], range(4), []], "all": [[], range(4), range(4), [0]], "Line9": [[], [], [], [0]]}
    mesh = meshio.Mesh(np.vstack([points] + middles), cells, cell_sets={name: [list(part) for part in parts] for name, parts in sets.items()})
    ours = signorini.solve(mesh, **BLOCK)
    assert np.abs(ours.displacement - theirs.displacement).max() < 1e-12
    for unusable in ("all", "Line9"):
        # Curves with an edge inside the body are no boundaries.
        with pytest.raises(signorini.CaseError, match=f"no boundary named '{unusable}'; this mesh has: bottom, top"):
            signorini.solve(mesh, **{**BLOCK, "boundary": {**BLOCK["boundary"], unusable: {"traction": [0, 0]}}})


def test_a_gap_may_be_an_array_or_a_function():
    points, triangles, boundaries = square(8)
    contact = lambda gap: {"top": {"displacement": [0, -0.1]}, "bottom": {"contact": {"gap": gap}}}
    case = {**BLOCK, "load": {}, "method": {"degree": 2}}
    solved = lambda mesh, gap: signorini.solve(*mesh, **{**case, "boundary": contact(gap)}).displacement
    mesh = (points, triangles, boundaries)
    expected = solved(mesh, "0.1*x")
    assert np.abs(solved(mesh, lambda x, y: 0.1 * x) - expected).max() < 1e-12
    assert np.abs(solved(mesh, 0.1 * points[:, 0]) - expected).max() < 1e-12, "linear between the points"
    assert np.abs(solved(mesh, 0.05 * points[:, 0]) - expected).max() > 1e-4, "control"
    shifted = meshio_square()
    assert np.abs(solved((shifted,), 0.1 * shifted.points[:, 0]) - solved(square(4), "0.1*x")).max() < 1e-12
    with pytest.raises(signorini.CaseError, match="has 3 values; expected one for each of the 81 points"):
        solved(mesh, [0, 1, 2])
    with pytest.raises(ZeroDivisionError):
        solved(mesh, lambda x, y: 1 / 0)


def test_a_certificate_is_made_where_it_is_asked_for():
    solution = signorini.solve(*square(4), **BLOCK, certificate=True)
    low, high = solution.certified["contact force", "bottom"]
    assert low <= solution.results["quantities"]["contact_force"] <= high
    asked = signorini.solve(*square(4), **BLOCK, certify={"quantities": ["force bottom"]})
    assert asked.certified["contact force", "bottom"][1] <= high, "the table alone asks for it"
    assert signorini.solve(*square(4), **BLOCK).certified == {}, "control"


def test_a_solution_becomes_a_mesh_of_meshio(tmp_path):
    solution = signorini.solve(*square(4), **{**BLOCK, "method": {"degree": 2}}, title="Block")
    assert repr(solution).startswith("Block\n")
    mesh = solution.to_meshio()
    assert mesh.cells[0].type == "triangle6"
    mesh.write(tmp_path / "block.vtu")
    again = meshio.read(tmp_path / "block.vtu")
    assert np.abs(again.point_data["displacement"][:, :2] - solution.displacement).max() == 0
    a, b, middle = (again.points[again.cells[0].data[:, i]] for i in (0, 1, 3))
    assert np.abs(middle - (a + b) / 2).max() < 1e-15, "in the order of VTK"


def test_remarks_are_warnings():
    large = {**BLOCK, "boundary": {"top": {"displacement": [0, -0.5]}, "bottom": {"contact": {}}}}
    with pytest.warns(UserWarning, match="strains are taken to be small"):
        solution = signorini.solve(*square(4), **large)
    assert solution.results["remarks"]


def test_ctrl_c_ends_a_solve(tmp_path):
    program = tmp_path / "long.py"
    program.write_text(
        "import signorini, sys\nprint('ready', flush=True)\n"
        f"signorini.solve_case({str(CASES / 'block.toml')!r}, set={{'mesh.rectangle.nx': 1200, 'mesh.rectangle.ny': 1200}})\n"
    )
    # What a shell has started in the background ignores the signal, and hands that on.
    listens = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    run = subprocess.Popen(
        [sys.executable, str(program)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=listens
    )
    assert run.stdout.readline() == "ready\n"
    time.sleep(1)
    run.send_signal(signal.SIGINT)
    # A solve of this size takes a minute and more.
    _, errors = run.communicate(timeout=50)
    assert "KeyboardInterrupt" in errors


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


def test_a_pair_of_bodies_is_given_as_tables_and_has_the_points_of_both_sides():
    # Two unit squares, one on the other, 4 and 6 cells wide.
    (lower, below, names), (upper, above, others) = square(4), square(6)
    points = np.vstack((lower, upper + [0, 1]))
    triangles = np.vstack((below, above + len(lower)))
    boundaries = {"floor": names["bottom"], "low": names["top"], "up": others["bottom"] + len(lower), "load": others["top"] + len(lower)}
    tables = {"material": {"young": 1.0, "poisson": 0.0}, "boundary": {"floor": {"displacement": [0, 0]}, "load": {"displacement": ["free", -0.02]}}}
    solution = signorini.solve(points, triangles, boundaries, pairs=[{"boundaries": ["low", "up"]}], **tables)
    assert solution.verdict == "proved"
    contact = solution.contact
    # The stress is 0.01 everywhere, on the 8 pieces between the nodes of both, which are no nodes.
    assert contact.boundary.tolist() == 16 * ["low"] + 16 * ["up"]
    np.testing.assert_allclose(contact.pressure, 0.01, rtol=1e-10)
    assert (contact.node == -1).all() and contact.place.shape == (32, 2)
    np.testing.assert_allclose(contact.place[:, 1], 1, atol=1e-14)
    # The control: bodies that touch are refused without a pair.
    with pytest.raises(signorini.CaseError, match="pair"):
        signorini.solve(points, triangles, boundaries, **tables)
