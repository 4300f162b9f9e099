"""python3 reference/getfem_friction.py [--check]

Coulomb's friction by GetFEM: Nitsche's method in its weak form language with its own operator for Coulomb's law, Coulomb_friction_coupled_projection,
and its derivative of it, for the dragged pad of reference/cases/friction-drag-p1-exact.toml. gamma is gamma0 times GetFEM's element_size, which is the longest
edge; gamma0 is the case's limit halved. Where its integrals are exact the discrete problem is that of method (8); the kinks of friction and contact fall between
the points of its rule. The result is in reference/results/getfem/drag.json, stored by this program and solved again with --check; the test
`a_dragged_pad_agrees_with_getfem` reads it.
"""

import sys
import tomllib

import getfem as gf
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
from getfem_pair import CONTACT, HELD, HERE, run

from fenicsx.expression import Expression
from fenicsx.mesh import rectangle

STORED = HERE / "results" / "getfem" / "drag.json"
CASE = HERE / "cases" / "friction-drag-p1-exact.toml"
STEPS = 5  # to the coefficient


def solve():
    gf.util_trace_level(0)
    case = tomllib.loads(CASE.read_text())
    shape = case["mesh"]["rectangle"]
    plane = rectangle(shape["width"], shape["height"], shape["nx"], shape["ny"], shape["diagonal"])
    mesh = gf.Mesh("empty", 2)
    mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), np.array(plane.points)[np.array(plane.triangles)].transpose(2, 1, 0))
    outer = mesh.outer_faces()
    normal = np.array([mesh.normal_of_face(*face)[1] for face in outer.T.tolist()])
    mesh.set_region(CONTACT, outer[:, normal < -0.9])
    mesh.set_region(HELD, outer[:, normal > 0.9])
    space = gf.MeshFem(mesh, 2)
    space.set_classical_fem(case["method"]["degree"])
    rule = gf.MeshIm(mesh, gf.Integ("IM_STRUCTURED_COMPOSITE(IM_TRIANGLE(6),8)"))
    young, poisson = case["material"]["young"], case["material"]["poisson"]
    model = gf.Model("real")
    model.add_fem_variable("u", space)
    model.add_initialized_data("lam", young * poisson / ((1 + poisson) * (1 - 2 * poisson)))
    model.add_initialized_data("mu", young / (2 * (1 + poisson)))
    model.add_isotropic_linearized_elasticity_brick(rule, "u", "lam", "mu")
    x, y = space.basic_dof_nodes()[:, ::2]
    given = np.array([Expression(str(e)).values(x, y) + 0 * x for e in case["boundary"]["top"]["displacement"]])
    model.add_initialized_fem_data("given", space, given.T.ravel())
    model.add_Dirichlet_condition_with_multipliers(rule, "u", space, HELD, "given")
    # kappa = 1/2: gamma0 = |T| / (2 h_T (lambda + 2 mu) |E|), all triangles being alike.
    dx, dy = shape["width"] / shape["nx"], shape["height"] / shape["ny"]
    modulus = float(model.variable("lam")[0] + 2 * model.variable("mu")[0])
    model.add_initialized_data("gamma0", dy / (4 * np.hypot(dx, dy) * modulus))
    model.add_initialized_data("friction", 0.0)
    traction = lambda w: f"((lam*Div_{w}*Id(2)+mu*(Grad_{w}+Grad_{w}'))*Normal)"
    gamma = "(gamma0*element_size)"
    # The floor is y = 0.
    stress = f"Coulomb_friction_coupled_projection({traction('u')},Normal,u,X(2)-u.Normal,friction,1/{gamma})"
    model.add_nonlinear_term(rule, f"-{gamma}*({traction('u')}.{traction('Test_u')})-{stress}.(Test_u-{gamma}*{traction('Test_u')})", CONTACT)
    unknowns = np.zeros(model.nbdof())
    coefficient = case["boundary"]["bottom"]["contact"]["friction"]["coulomb"]
    for share in np.linspace(0, 1, STEPS + 1):
        model.set_variable("friction", coefficient * share)
        unknowns = newton(model, unknowns)
    u = np.array(model.variable("u")).reshape(-1, 2)
    energy = float(gf.asm_generic(rule, 0, "lam*sqr(Div_u)+2*mu*Norm_sqr((Grad_u+Grad_u')/2)", -1, model))
    start, count = model.interval_of_variable("u")
    forces = gf.asm_generic(rule, 1, "(lam*Div_u*Id(2)+mu*(Grad_u+Grad_u')):Grad_Test_u", -1, model)[start : start + count]
    top = space.basic_dof_on_region(HELD)
    shear, pressure = (float(sum(forces[d] for d in top if d % 2 == c)) for c in (0, 1))
    return {"a_uu": energy, "shear": shear, "force": -pressure, "slip": float(np.abs(u[y == 0, 0]).max())}


def newton(model, x):
    """The solution from x, with steps that make the residual smaller where there are such."""

    def residual(x):
        model.to_variables(x)
        model.assembly("build_rhs")
        return np.array(model.rhs())

    for _ in range(100):
        r = residual(x)
        size = np.linalg.norm(r)
        if size < 1e-13:
            return x
        model.assembly("build_matrix")
        tangent = gf.Spmat("copy", model.tangent_matrix())
        tangent.to_csc()
        starts, rows = tangent.csc_ind()
        step = scipy.sparse.linalg.spsolve(sparse.csc_matrix((tangent.csc_val(), rows, starts), shape=tangent.size()), r)
        shares = 0.5 ** np.arange(10)
        x = x + next((t for t in shares if np.linalg.norm(residual(x + t * step)) < size), shares[-1]) * step
    raise SystemExit("Newton's method does not converge")


if __name__ == "__main__":
    sys.exit(run("getfem_friction.py", STORED, CASE, solve))
