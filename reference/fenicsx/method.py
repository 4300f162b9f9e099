"""Method (8) of section 2.2 (theta = 1), with a gap g: find u^h, equal to the prescribed data at their nodes, such that

    A(u, v) + int_{Gamma_C} (1/gamma) [P(u)]+ P0(v) = L(v)   for all v in V^h that vanish there,

    A(u, v) = a(u, v) - int_{Gamma_C} gamma sigma_n(u) sigma_n(v),    gamma = gamma0 h_T   (7),
    P(v) = v_n - g - gamma sigma_n(v),    P0(v) = v_n - gamma sigma_n(v).

With { gauss = n } the integral of [.]+ takes n Gauss points per edge, here in UFL; with "exact" it is taken edge by edge between
the roots of P, in edges.py. The integrals in A are polynomials' and exact in both. Where n turns along the line of contact or belongs to
an obstacle, n~ and s(v) = n~ . sigma(v) n take the places of n and sigma_n: all integrals on Gamma_C are then those of edges.py.
"""

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc
from ufl import dot, dx, grad, inner, sym, tr

from .edges import ContactEdges


def positive_part(a):
    """[a]+"""
    return ufl.conditional(ufl.gt(a, 0), a, 0)


def slope(a):
    """The derivative of [a]+ that Newton uses: 1 for a > 0, else 0 (a choice at 0)."""
    return ufl.conditional(ufl.gt(a, 0), 1, 0)


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
        self.u = fem.Function(problem.V)
        self.edges = ContactEdges(problem, gamma0)
        v, w = ufl.TestFunction(problem.V), ufl.TrialFunction(problem.V)
        residual, tangent = self.A(self.u, v), self.A(w, v)
        self.linear_part = fem.form(residual)
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
        return self.a(u, v) - sum(self.gamma() * self.sigma_n(u) * self.sigma_n(v) * ds for ds, g in self.Gamma_C(exact))

    def contact(self, u, v):
        return sum(1 / self.gamma() * positive_part(self.P(u, g)) * self.P0(v) * ds for ds, g in self.Gamma_C(self.gauss_degree))

    def contact_slope(self, u, w, v):
        return sum(1 / self.gamma() * slope(self.P(u, g)) * self.P0(w) * self.P0(v) * ds for ds, g in self.Gamma_C(self.gauss_degree))

    @property
    def gauss_degree(self):
        """n Gauss points are exact to degree 2n - 1, and are what UFL takes for that degree."""
        return 2 * self.case.gauss - 1

    def Gamma_C(self, degree):
        """(measure, gap) of each contact boundary; none where edges.py integrates."""
        return [(self.problem.ds(self.problem.number[name], metadata={"quadrature_degree": degree}), gap)
                for name, gap in self.problem.gaps.items()]

    # What Newton's method asks for.

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
        matrix = fem.petsc.assemble_matrix(self.tangent_form)
        if not self.contact_in_ufl:
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
