"""Method (8) of section 2.2 (theta = 1), with a gap g: find u^h, equal to the prescribed data at their nodes, such that

    A(u, v) + int_{Gamma_C} (1/gamma) [P(u)]+ P0(v) = L(v)   for all v in V^h that vanish there,

    A(u, v) = a(u, v) - int_{Gamma_C} gamma sigma_n(u) sigma_n(v),    gamma = gamma0 h_T   (7),
    P(v) = v_n - g - gamma sigma_n(v),    P0(v) = v_n - gamma sigma_n(v).

With { gauss = n } the integral of [.]+ takes n Gauss points per edge, here in UFL; with "exact" it is taken edge by edge between
the roots of P, in edges.py. The integrals in A are polynomials' and exact in both. Where n turns along the line of contact or belongs to
an obstacle, n~ and s(v) = n~ . sigma(v) n take the places of n and sigma_n: all integrals on Gamma_C are then those of edges.py.

On boundaries with friction (docs/theory.md, 13), t being n turned left,

    A also has  - int gamma sigma_t(u) sigma_t(v),    and the equations  + int (1/gamma) clip(P_t(u); m) P0_t(v),
    P_t(v) = P0_t(v) = v_t - gamma sigma_t(v),    m = gamma s for Tresca's slip bound s,    m = mu [P(u)]+ for Coulomb's coefficient mu.
"""

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc
from ufl import dot, dx, grad, inner, sym, tr

from .edges import ContactEdges
from .friction import GLUED


def positive_part(a):
    """[a]+"""
    return ufl.conditional(ufl.gt(a, 0), a, 0)


def slope(a):
    """The derivative of [a]+ that Newton uses: 1 for a > 0, else 0 (a choice at 0)."""
    return ufl.conditional(ufl.gt(a, 0), 1, 0)


def clip(a, m):
    """a, cut off at -m and m."""
    return ufl.conditional(ufl.gt(a, m), m, ufl.conditional(ufl.lt(a, -m), -m, a))


def side(a, m):
    """1 and -1 where a is cut off, else 0."""
    return ufl.conditional(ufl.gt(a, m), 1, ufl.conditional(ufl.lt(a, -m), -1, 0))


class Method:
    """The method on one problem. `u` is the current iterate; vectors are arrays over the owned dofs, prescribed ones included."""

    def __init__(self, problem, gamma0):
        self.problem, self.case = problem, problem.case
        material = self.case.material
        self.gamma0, *self.law = (fem.Constant(problem.mesh, PETSc.ScalarType(value))
                                  for value in (gamma0, *(self._moduli(material))))
        if len(self.case.materials) > 1:
            cells = range(len(problem.original))
            moduli = problem.lame(cells) if self.case.is_isotropic else np.hstack((problem.stiffness(cells), problem.across(cells))).T
            self.law = list(map(problem.on_triangles, moduli))
        self.contact_in_ufl = bool(self.case.gauss) and problem.straight
        self.n = ufl.FacetNormal(problem.mesh)
        self.t = ufl.as_vector((-self.n[1], self.n[0]))
        self.u = fem.Function(problem.V)
        # Coulomb's bound is that of u itself, or while it is frozen that of another displacement, and so much more.
        self.u_of_bound, self.live, self.more = fem.Function(problem.V), fem.Constant(problem.mesh, 1.0), fem.Constant(problem.mesh, 0.0)
        self.edges = ContactEdges(problem, gamma0)
        v, w = ufl.TestFunction(problem.V), ufl.TrialFunction(problem.V)
        residual, tangent = self.A(self.u, v), self.A(w, v)
        self.linear_part, self.linear_tangent = fem.form(residual), fem.form(tangent)
        if self.contact_in_ufl:
            residual += self.contact(self.u, v)
            tangent += self.contact_slope(self.u, w, v)
        self.residual_form, self.tangent_form = fem.form(residual), fem.form(tangent)
        self.energy_form = fem.form(self.a(self.u, self.u))

    # The method as the paper states it.

    def eps(self, v):
        return sym(grad(v))

    def _moduli(self, material):
        """lambda and mu; where a material of the case is a tensor, its entries and what sigma_zz is."""
        if self.case.is_isotropic:
            return material.plane_lam, material.mu
        return *material.in_plane, *material.zz

    def sigma(self, v):
        eps = self.eps(v)
        if self.case.is_isotropic:
            lam, mu = self.law
            return lam * tr(eps) * ufl.Identity(2) + 2 * mu * eps
        c11, c12, c16, c22, c26, c66 = self.law[:6]
        a, b, c = eps[0, 0], eps[1, 1], 2 * eps[0, 1]
        xy = c16 * a + c26 * b + c66 * c
        return ufl.as_matrix([[c11 * a + c12 * b + c16 * c, xy], [xy, c12 * a + c22 * b + c26 * c]])

    def sigma_zz(self, v):
        """lambda tr eps in plane strain, 0 in plane stress; of a tensor as the case says."""
        if not self.case.is_isotropic:
            sigma, (p, q, r) = self.sigma(v), self.law[6:]
            return p * sigma[0, 0] + q * sigma[1, 1] + r * sigma[0, 1]
        return self.law[0] * tr(self.eps(v)) if self.case.material.plane == "strain" else 0

    def v_n(self, v):
        return dot(v, self.n)

    def sigma_n(self, v):
        return dot(self.n, dot(self.sigma(v), self.n))

    def v_t(self, v):
        return dot(v, self.t)

    def sigma_t(self, v):
        return dot(self.t, dot(self.sigma(v), self.n))

    def P_t(self, v):
        return self.v_t(v) - self.gamma() * self.sigma_t(v)

    def gamma(self):
        h_T = ufl.CellDiameter(self.problem.mesh)
        return self.gamma0 * h_T

    def P0(self, v):
        return self.v_n(v) - self.gamma() * self.sigma_n(v)

    def P(self, v, g):
        return self.v_n(v) - g - self.gamma() * self.sigma_n(v)

    def a(self, u, v):
        return inner(self.sigma(u), self.eps(v)) * dx

    def A(self, u, v):
        exact = 2 * (self.case.degree - 1)
        pulls = sum(self.gamma() * self.sigma_n(u) * self.sigma_n(v) * ds for ds, g in self.Gamma_C(exact))
        shears = sum(self.gamma() * self.sigma_t(u) * self.sigma_t(v) * ds for ds, *_ in self.with_friction(exact))
        return self.a(u, v) - pulls - shears

    def contact(self, u, v):
        pressure = sum(1 / self.gamma() * positive_part(self.P(u, g)) * self.P0(v) * ds for ds, g in self.Gamma_C(self.gauss_degree))
        friction = sum(1 / self.gamma() * clip(self.P_t(u), self.bound(u, *law)) * self.P_t(v) * ds
                       for ds, *law in self.with_friction(self.gauss_degree))
        return pressure + friction

    def bound(self, u, g, mu, s):
        """m"""
        given = positive_part(self.P(self.u_of_bound, g)) + self.more
        return self.gamma() * s + mu * ufl.conditional(ufl.gt(self.live, 0), positive_part(self.P(u, g)), given)

    def contact_slope(self, u, w, v):
        pressure = sum(1 / self.gamma() * slope(self.P(u, g)) * self.P0(w) * self.P0(v) * ds for ds, g in self.Gamma_C(self.gauss_degree))
        return pressure + sum(1 / self.gamma() * self.friction_slope(u, w, *law) * self.P_t(v) * ds
                              for ds, *law in self.with_friction(self.gauss_degree))

    def friction_slope(self, u, w, g, mu, s):
        """P_t(w) where it sticks; where it slides the bound's own slope."""
        slides = side(self.P_t(u), self.bound(u, g, mu, s))
        return (1 - slides**2) * self.P_t(w) + slides * mu * self.live * slope(self.P(u, g)) * self.P0(w)

    @property
    def gauss_degree(self):
        """n Gauss points are exact to degree 2n - 1, and are what UFL takes for that degree."""
        return 2 * self.case.gauss - 1

    def Gamma_C(self, degree):
        """(measure, gap) of each contact boundary; none where edges.py integrates."""
        return [(self.problem.ds(self.problem.number[name], metadata={"quadrature_degree": degree}), gap)
                for name, gap in self.problem.gaps.items()]

    def with_friction(self, degree):
        """(measure, gap, coefficient, slip bound) of each boundary with friction; none where edges.py integrates."""
        zero = fem.Constant(self.problem.mesh, 0.0)
        return [(self.problem.ds(self.problem.number[name], metadata={"quadrature_degree": degree}), self.problem.gaps[name],
                 zero if name in self.problem.slip_bounds else law, self.problem.slip_bounds.get(name, zero))
                for name, law in self.problem.rough.items() if name in self.problem.gaps]

    # What Newton's method asks for.

    @property
    def has_coulomb(self):
        return any(isinstance(law, float) for law in self.problem.rough.values())

    def freeze(self, owned=None):
        """Makes the bound of Coulomb's friction that of this displacement, or without one a bound that nothing reaches."""
        self.set(self.u.x.array[: self.problem.owned_dofs].copy() if owned is None else owned)
        self.live.value, self.more.value = 0.0, GLUED if owned is None else 0.0
        self.u_of_bound.x.array[:] = self.u.x.array
        self.edges.friction.freeze(self.edges.P(self.u.x.array), glued=owned is None)

    def release(self):
        """Makes the bound that of the iterate itself again."""
        self.live.value, self.more.value = 1.0, 0.0
        self.edges.friction.release()

    def set(self, owned):
        """Makes `owned` the current iterate."""
        self.u.x.array[: len(owned)] = owned
        self.u.x.scatter_forward()

    def functional(self):
        """A(u, .) + int (1/gamma) [P(u)]+ P0(.): the residual of (8) is this minus L."""
        u = self.u.x.array
        contact = None if self.contact_in_ufl else self.edges.functional(u)
        return self.problem.assemble(self.residual_form, contact if self.problem.straight else contact + self.edges.stress_functional(u))

    def linear_functional(self):
        """A(u, .)"""
        return self.problem.assemble(self.linear_part, None if self.problem.straight else self.edges.stress_functional(self.u.x.array))

    def tangent(self, everywhere=False):
        """The derivative of (8) at u on all dofs, or with contact everywhere; its caller treats the prescribed ones and destroys it."""
        in_ufl = self.contact_in_ufl and not everywhere
        matrix = fem.petsc.assemble_matrix(self.tangent_form if in_ufl else self.linear_tangent)
        if not in_ufl:
            for dofs, block in self.edges.tangent(self.u.x.array, everywhere):
                matrix.setValuesLocal(dofs, dofs, block, addv=PETSc.InsertMode.ADD)
        if not self.problem.straight:
            for dofs, block in zip(self.edges.dofs, self.edges.stress_blocks()):
                matrix.setValuesLocal(dofs, dofs, block, addv=PETSc.InsertMode.ADD)
        matrix.assemble()
        return matrix

    def energy(self):
        """a(u, u)"""
        return self.problem.comm.allreduce(fem.assemble_scalar(self.energy_form))
