"""The grammar of expressions, in numpy and in UFL."""

import math

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenicsx import compat
from fenicsx.expression import Expression, ExpressionError

from .support import TestCase

X, Y = 0.3, -0.7
TABLE = [
    ("-x^2", -(X**2)),
    ("(-x)^2", X**2),
    ("2^3^2", 512.0),
    ("2^-3", 0.125),
    ("2^-x^2", 2 ** -(X**2)),
    ("-2^-2", -0.25),
    ("2*-3", -6.0),
    ("2--3", 5.0),
    ("--x", X),
    ("+x - +-y", X + Y),
    ("1-2-3", -4.0),
    ("8/4/2", 1.0),
    ("6/2*3", 9.0),
    ("1e-3*x", 1e-3 * X),
    ("1.5E+2", 150.0),
    (".5 + 2.", 2.5),
    ("(x)", X),
    ("  x\t*\ny ", X * Y),
    ("pi", math.pi),
    ("sqrt(x) + sin(y)*cos(x)", math.sqrt(X) + math.sin(Y) * math.cos(X)),
    ("exp(-y)", math.exp(-Y)),
    ("abs(y)^3", abs(Y) ** 3),
    ("min(x, y) - max(x, y^2)", Y - max(X, Y**2)),
    ("max(x, min(y, -1))", X),
    ("y^3", Y**3),
    ("+".join(["x"] * 3000), 3000 * X),
    ("(" * 190 + "x" + ")" * 190, X),
]
REFUSED = [
    ("", "column 1: found the end, expected a number, x, y, pi, a function or '('"),
    ("2x", "column 2: found 'x', expected an operator or the end"),
    ("x +", "column 4: found the end, expected a number, x, y, pi, a function or '('"),
    ("2**3", "column 3: found '*', expected a number, x, y, pi, a function or '('"),
    ("z", "column 1: unknown name 'z'; known: x, y, pi, sqrt, sin, cos, exp, abs, min, max"),
    ("__import__('os')", "column 1: unknown name '__import__'; known: x, y, pi, sqrt, sin, cos, exp, abs, min, max"),
    ("x.real", "column 2: unexpected character '.'"),
    ("sin x", "column 5: found 'x', expected '(' after sin"),
    ("min(x)", "column 1: min takes 2 argument(s), found 1"),
    ("sin(x, y)", "column 1: sin takes 1 argument(s), found 2"),
    ("(x", "column 3: found the end, expected ')'"),
    ("x)", "column 2: found ')', expected an operator or the end"),
    ("1e999", "column 1: 1e999 is too large for a double"),
    ("x; y", "column 2: unexpected character ';'"),
    ("\N{MINUS SIGN}x", "column 1: unexpected character '\N{MINUS SIGN}'"),
    ("\N{ARABIC-INDIC DIGIT ONE}", "column 1: unexpected character '\N{ARABIC-INDIC DIGIT ONE}'"),
    ("(" * 2**20 + "x", "column 201: nested deeper than 200 levels"),
    ("-" * 201 + "x", "column 201: nested deeper than 200 levels"),
]


class Expressions(TestCase):
    def test_table_has_the_values_of_the_grammar(self):
        for text, value in TABLE:
            with self.subTest(text[:40]):
                self.assertAlmostEqual(float(Expression(text).values(X, Y)), value, delta=1e-13 * max(1, abs(value)))

    def test_ufl_has_the_values_of_numpy(self):
        points = np.array([[0.0, -1.0], [0.6, -0.7], [0.3, -0.4]])  # its centre is (X, Y), its area A
        triangle = compat.create_mesh(MPI.COMM_SELF, np.array([[0, 1, 2]]), points)
        area = 0.5 * (0.6 * 0.6 - 0.3 * 0.3)
        for text, value in TABLE:
            if len(text) < 100:  # one integration point, the centre
                x = ufl.SpatialCoordinate(triangle)
                form = fem.form((1 + x[0] + Expression(text).ufl(x)) * ufl.dx(metadata={"quadrature_degree": 1}))
                with self.subTest(text):
                    self.assertAlmostEqual(fem.assemble_scalar(form) / area - 1 - X, value, delta=1e-12 * max(1, abs(value)))

    def test_refusals_name_the_column(self):
        for text, message in REFUSED:
            with self.subTest(text[:40]), self.assertRaises(ExpressionError) as caught:
                Expression(text)
            self.assertEqual(str(caught.exception), message)

    def test_what_is_not_finite_is_visible(self):
        self.assertEqual(float(Expression("1/x").values(0.0, 0.0)), np.inf)
        self.assertTrue(np.isnan(Expression("sqrt(x)").values(-1.0, 0.0)))
        self.assertTrue(np.isnan(Expression("max(sqrt(x), 1)").values(-1.0, 0.0)))
