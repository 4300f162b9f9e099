"""Expressions of x and y, as case files have them: one parser, two meanings (numpy values, UFL expressions).

    expr  = term  { ("+" | "-") term }
    term  = unary { ("*" | "/") unary }
    unary = ("+" | "-") unary | power
    power = atom [ "^" unary ]                 right-associative; -x^2 = -(x^2), 2^-3 and 2*-3 are allowed
    atom  = number | "x" | "y" | "pi" | name "(" expr { "," expr } ")" | "(" expr ")"
    name  = sqrt | sin | cos | exp | abs (one argument) | min | max (two arguments)
"""

import math
import operator
import re
import sys

import numpy as np
import ufl

FUNCTIONS = {"sqrt": 1, "sin": 1, "cos": 1, "exp": 1, "abs": 1, "min": 2, "max": 2}
ARGUMENTS = {"+": 2, "-": 2, "*": 2, "/": 2, "^": 2, "negative": 1, **FUNCTIONS}
DEEPEST = 200  # nesting allowed in an expression
sys.setrecursionlimit(max(sys.getrecursionlimit(), 20 * DEEPEST))  # five calls a level
TOKEN = re.compile(r"(?P<number>(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>[-+*/^(),])", re.ASCII)
SPACES = re.compile(r"\s*")


class ExpressionError(Exception):
    """What is wrong with an expression, and at which column (counted from 1)."""


class Expression:
    """A parsed expression: a program in postfix order, of floats, the variables "x" and "y", and operations."""

    def __init__(self, text):
        self.text = text
        self.program = _Parser(text).program

    def __repr__(self):
        return f"Expression({self.text!r})"

    def values(self, x, y):
        """The values at the points (x, y): floats or arrays. 1/0 gives inf and sqrt(-1) NaN; callers must look."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        with np.errstate(all="ignore"):
            return self.run({"x": x, "y": y}, _NUMPY, np.float64) + np.zeros(np.broadcast(x, y).shape)

    def ufl(self, point):
        """The UFL expression at `point`, a ufl.SpatialCoordinate."""
        return self.run({"x": point[0], "y": point[1]}, _UFL, ufl.as_ufl)

    def run(self, variables, operations, number):
        """The value with the given meaning of variables, operations and numbers."""
        stack = []
        for step in self.program:
            if isinstance(step, float):
                stack.append(number(step))
            elif step in variables:
                stack.append(variables[step])
            else:
                first = len(stack) - ARGUMENTS[step]
                stack[first:] = [operations[step](*stack[first:])]
        return stack.pop()


_NUMPY = {"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "^": np.power, "negative": np.negative,
          "sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "exp": np.exp, "abs": np.abs, "min": np.minimum, "max": np.maximum}
_UFL = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "^": operator.pow, "negative": operator.neg,
        "sqrt": ufl.sqrt, "sin": ufl.sin, "cos": ufl.cos, "exp": ufl.exp, "abs": abs, "min": ufl.min_value, "max": ufl.max_value}


class _Parser:
    """Recursive descent that appends to `program`; the grammar stands at the head of this file."""

    def __init__(self, text):
        self.text = text
        self.position = 0
        self.depth = 0
        self.program = []
        self.advance()
        self.expr()
        if self.kind != "end":
            self.fail("an operator or the end")

    def advance(self):
        spaces = SPACES.match(self.text, self.position)
        self.column = spaces.end() + 1
        if spaces.end() == len(self.text):
            self.token, self.kind = "the end", "end"
            return
        match = TOKEN.match(self.text, spaces.end())
        if not match:
            raise ExpressionError(f"column {self.column}: unexpected character {self.text[spaces.end()]!r}")
        self.token, self.kind, self.position = match.group(), match.lastgroup, match.end()

    def fail(self, expected):
        found = self.token if self.kind == "end" else repr(self.token)
        raise ExpressionError(f"column {self.column}: found {found}, expected {expected}")

    def take(self, *signs):
        """Consumes and returns the current token if it is one of `signs`, else returns None."""
        if self.kind == "sign" and self.token in signs:
            sign = self.token
            self.advance()
            return sign
        return None

    def expr(self):
        self.term()
        while sign := self.take("+", "-"):
            self.term()
            self.program.append(sign)

    def term(self):
        self.unary()
        while sign := self.take("*", "/"):
            self.unary()
            self.program.append(sign)

    def unary(self):
        self.depth += 1
        if self.depth > DEEPEST:
            raise ExpressionError(f"column {self.column}: nested deeper than {DEEPEST} levels")
        if self.take("-"):
            self.unary()
            self.program.append("negative")
        elif self.take("+"):
            self.unary()
        else:
            self.power()
        self.depth -= 1

    def power(self):
        self.atom()
        if self.take("^"):
            self.unary()
            self.program.append("^")

    def atom(self):
        if self.kind == "number":
            value = float(self.token)
            if not math.isfinite(value):
                raise ExpressionError(f"column {self.column}: {self.token} is too large for a double")
            self.advance()
            self.program.append(value)
        elif self.kind == "name":
            self.name()
        elif self.take("("):
            self.expr()
            if not self.take(")"):
                self.fail("')'")
        else:
            self.fail("a number, x, y, pi, a function or '('")

    def name(self):
        name, column = self.token, self.column
        self.advance()
        if name in ("x", "y"):
            self.program.append(name)
        elif name == "pi":
            self.program.append(math.pi)
        elif name in FUNCTIONS:
            self.call(name, column)
        else:
            raise ExpressionError(f"column {column}: unknown name {name!r}; known: x, y, pi, {', '.join(FUNCTIONS)}")

    def call(self, name, column):
        if not self.take("("):
            self.fail(f"'(' after {name}")
        self.expr()
        count = 1
        while self.take(","):
            self.expr()
            count += 1
        if not self.take(")"):
            self.fail("')'")
        if count != FUNCTIONS[name]:
            raise ExpressionError(f"column {column}: {name} takes {FUNCTIONS[name]} argument(s), found {count}")
        self.program.append(name)
