"""The files of a solution: result.json, and solution.xdmf (with solution.h5) for ParaView."""

import json
import os
import time

import ufl
from dolfinx import fem
from dolfinx.io import XDMFFile

from . import compat


def write(content, problem, method, folder):
    """Writes both; result.json (with the time that solution.xdmf took) last and under a temporary name first: it is there only if all
    went well."""
    comm, start = problem.comm, time.perf_counter()
    make_folder(folder, comm)
    with XDMFFile(comm, str(folder / "solution.xdmf"), "w") as file:
        file.write_mesh(problem.mesh)
        file.write_function(displacement(problem, method))
        file.write_function(von_mises(problem, method))
    content["seconds"]["write"] = time.perf_counter() - start
    if comm.rank == 0:
        temporary = folder / f".result.json.{os.getpid()}"
        temporary.write_text(text_of(content))
        temporary.rename(folder / "result.json")


def make_folder(folder, comm):
    """Makes the folder; where process 0 cannot, all processes raise its OSError."""
    error = None
    if comm.rank == 0:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as found:
            error = found
    error = comm.bcast(error)
    if error:
        raise error


def text_of(content):
    """JSON with each double in the fewest digits that read back to it; a NaN or infinity is an error, not a null."""
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def displacement(problem, method):
    """u^h at the vertices: XDMF holds no more."""
    function = fem.Function(compat.vector_space(problem.mesh, 1), name="displacement")
    function.interpolate(method.u)
    return function


def von_mises(problem, method):
    """The von Mises stress at each triangle's centre."""
    sigma = method.sigma(method.u)
    xx, yy, xy = sigma[0, 0], sigma[1, 1], sigma[0, 1]
    zz = method.sigma_zz(method.u)
    squared = ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2
    function = fem.Function(compat.scalar_space(problem.mesh, "DG", 0), name="von_mises")
    function.interpolate(compat.expression(ufl.sqrt(squared), function.function_space))
    return function
