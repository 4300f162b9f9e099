"""python3 reference/getfem_pair.py [--check | --time SIGNORINI]

A pair of bodies by GetFEM's brick for contact between meshes that do not match (integral contact with multipliers on the first body, by the
augmented Lagrangian): the blocks of reference/pairs/apart.msh, pressed on each other without a clearance, quadratic displacements and affine
multipliers. It is another discrete problem than method (8), so what is compared is the force between the bodies, the reactions and the
displacements, to the error of the mesh. The result is in reference/results/getfem/apart.json, stored by this program and solved again with --check; the test
`a_pair_agrees_with_getfem_to_the_error_of_the_mesh` reads it. With --time both programs solve on the mesh whose triangles Gmsh has cut in four
twice, and a line of JSON has the unknowns and, as the least of three runs, the seconds of `model.solve`, which assembles and factors, and
those from the mesh in memory to the proved result of `SIGNORINI solve`.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import getfem as gf
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from fenicsx import gmsh
from fenicsx.store import sha256
from fenicsx.write import text_of

HERE = Path(__file__).resolve().parent
STORED = HERE / "results" / "getfem" / "apart.json"
MESH = HERE / "pairs" / "apart.msh"
# Young's modulus and Poisson's ratio, in plane strain, as in apart-p2.toml.
MATERIALS = {"lower": (1.0, 0.4), "upper": (20.0, 0.3)}
CONTACT, HELD = 1, 2
# Newton's method ends with a residual below 1e-12, beside forces of 0.1.
TOLERANCE = 1e-9


def bodies(file):
    """The meshes of the two bodies, with their edges of contact and those that are held."""
    plane = gmsh.read(file)
    found = {}
    for name, contact, held in (("lower", "low", "base"), ("upper", "up", "top")):
        mesh = gf.Mesh("empty", 2)
        triangles = np.array(plane.triangles)[plane.surfaces[name]]
        points = np.array(plane.points)
        mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), points[triangles].transpose(2, 1, 0))
        for region, boundary in ((CONTACT, contact), (HELD, held)):
            ends = [mesh.pid_from_coords(points[list(pair)].T) for pair in plane.boundaries[boundary]]
            outer = mesh.outer_faces()
            of = {tuple(face) for face in outer.T.tolist()}
            # The faces that have both ends of an edge of the boundary.
            on = []
            for pair in ends:
                want = set(np.array(pair).tolist())
                for face in mesh.faces_from_pid(pair).T.tolist():
                    own = set(mesh.pid_in_faces(np.array(face).reshape(2, 1)).tolist())
                    if tuple(face) in of and own == want and face not in on:
                        on.append(face)
            assert len(on) == len(ends), (boundary, len(on), len(ends))
            mesh.set_region(region, np.array(on).T)
        found[name] = mesh
    return found


def model_of(file):
    """The problem on a mesh, and the spaces and rules of its bodies."""
    gf.util_trace_level(0)
    model = gf.Model("real")
    spaces, rules = {}, {}
    for name, mesh in bodies(file).items():
        young, poisson = MATERIALS[name]
        spaces[name] = gf.MeshFem(mesh, 2)
        spaces[name].set_classical_fem(2)
        rules[name] = gf.MeshIm(mesh, gf.Integ("IM_STRUCTURED_COMPOSITE(IM_TRIANGLE(6),6)"))
        u = f"u_{name}"
        model.add_fem_variable(u, spaces[name])
        model.add_initialized_data(f"lambda_{name}", young * poisson / ((1 + poisson) * (1 - 2 * poisson)))
        model.add_initialized_data(f"mu_{name}", young / (2 * (1 + poisson)))
        model.add_isotropic_linearized_elasticity_brick(rules[name], u, f"lambda_{name}", f"mu_{name}")
        data = gf.MeshFem(mesh, 2)
        data.set_classical_fem(2)
        x, y = data.basic_dof_nodes()[:, ::2]
        given = np.zeros((2, len(x))) if name == "lower" else np.array([0.01 + 0 * x, -0.03 - 0.02 * x])
        model.add_initialized_fem_data(f"given_{name}", data, given.T.ravel())
        model.add_Dirichlet_condition_with_multipliers(rules[name], u, spaces[name], HELD, f"given_{name}")
    x, y = spaces["lower"].basic_dof_nodes()[:, ::2]
    model.add_initialized_fem_data("body", spaces["lower"], np.array([0.02 * x, -0.01 + 0 * x]).T.ravel())
    model.add_source_term_brick(rules["lower"], "u_lower", "body")
    # The multiplier of the first body, which is the finer one.
    pressure = gf.MeshFem(spaces["upper"].linked_mesh(), 1)
    pressure.set_classical_fem(1)
    model.add_filtered_fem_variable("p", pressure, CONTACT)
    model.add_initialized_data("r", 100.0)
    model.add_integral_contact_between_nonmatching_meshes_brick(rules["upper"], "u_upper", "u_lower", "p", "r", CONTACT, CONTACT)
    return model, spaces, rules


def newton(model):
    model.solve("max_res", 1e-9, "max_iter", 60)
    if not np.abs(model.rhs()).max() < 1e-12:
        raise SystemExit("Newton's method does not converge")


def solve():
    model, spaces, rules = model_of(MESH)
    newton(model)
    u = {name: np.array(model.variable(f"u_{name}")).reshape(-1, 2) for name in spaces}
    integral = lambda name, form, region: float(gf.asm_generic(rules[name], 0, form, region, model))
    strain = "(Grad_u_{0} + Grad_u_{0}')/2"
    energies = [integral(n, f"lambda_{n}*sqr(Div_u_{n}) + 2*mu_{n}*Norm_sqr({strain.format(n)})", -1) for n in spaces]
    largest = max(float(np.hypot(*np.reshape(model.variable(f"u_{name}"), (-1, 2)).T).max()) for name in spaces)
    return {"a_uu": sum(energies), "work": integral("lower", "body.u_lower", -1), "force": -integral("upper", "p", CONTACT),
            "max_displacement": largest}


def timed(program):
    """The seconds of both programs on a finer mesh."""
    with tempfile.TemporaryDirectory() as folder:
        file, out = MESH, Path(folder) / "out"
        for level in ("once.msh", "twice.msh"):
            fine = Path(folder) / level
            subprocess.run(["gmsh", file, "-refine", "-format", "msh41", "-o", fine], capture_output=True, check=True)
            file = fine
        command = [program, "solve", MESH.with_name("apart-p2.toml"), "--set", f"mesh.gmsh={file}", "--set", "output.probes=[]", "--out", out]
        own, other = [], []
        for _ in range(3):
            subprocess.run(command, capture_output=True, check=True)
            result = json.loads((out / "result.json").read_text())
            own.append(sum(result["seconds"][part] for part in ("assemble", "solve", "certify")))
            model, *_ = model_of(file)
            start = time.perf_counter()
            newton(model)
            other.append(time.perf_counter() - start)
    print(json.dumps({"unknowns": result["mesh"]["dofs"], "getfem": min(other), "signorini": min(own)}))


def check(stored, fresh):
    """What is wrong with the stored result."""
    old = json.loads(stored.read_text())
    off = {key: abs(old[key] / value - 1) for key, value in fresh.items()}
    return [f"{key}: differs by {value:.1e}, expected at most {TOLERANCE:.0e}" for key, value in off.items() if not value <= TOLERANCE]


def run(program, stored, source, solve):
    """Stores a result, or checks it with --check; `source` is the file that it is made from."""
    fresh = solve()
    if sys.argv[1:] == ["--check"]:
        wrong = check(stored, fresh)
        # The control: another energy is noticed.
        if not check(stored, fresh | {"a_uu": fresh["a_uu"] * (1 + 10 * TOLERANCE)}):
            wrong.append("control: an energy that is off is not noticed")
        print("\n".join(wrong) or f"the stored result {stored.name} of GetFEM agrees with a fresh one to {TOLERANCE:.0e}")
        return 1 if wrong else 0
    if sys.argv[1:]:
        raise SystemExit(sys.modules["__main__"].__doc__)
    stored.parent.mkdir(exist_ok=True)
    version = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", "python3-getfem"], capture_output=True, text=True, check=True).stdout
    kind = "mesh" if source.suffix == ".msh" else "case"
    provenance = {"GetFEM": version, kind: source.relative_to(HERE.parent).as_posix(), f"{kind}_sha256": sha256(source),
                  "command": f"python3 reference/{program}"}
    stored.write_text(text_of(fresh | {"provenance": provenance}))
    return 0


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--time":
        sys.exit(timed(sys.argv[2]))
    sys.exit(run("getfem_pair.py", STORED, MESH, solve))
