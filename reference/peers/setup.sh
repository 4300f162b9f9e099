#!/bin/sh
# Installs what the other codes need (Debian 12): packages by apt, and a virtual environment in .venv beside this file.
#
# libopenblas comes first: without it MUMPS, CHOLMOD and PETSc run on the reference BLAS, several times slower.
set -eu
cd "$(dirname "$0")"

root=
[ "$(id -u)" = 0 ] || root=sudo
$root apt-get update
$root apt-get install --yes --no-install-recommends \
    libopenblas0-pthread libsuitesparse-dev gcc g++ pkg-config \
    python3-dev python3-venv python3-dolfinx python3-getfem

/usr/bin/python3 -m venv .venv
.venv/bin/pip install --quiet --upgrade pip
.venv/bin/pip install --quiet numpy scipy scikit-fem==12.0.2 ngsolve==6.2.2608
# 0.5 asks for a newer SuiteSparse than Debian 12 has.
.venv/bin/pip install --quiet scikit-sparse==0.4.16

.venv/bin/python -c 'import skfem, sksparse.cholmod, ngsolve'
/usr/bin/python3 -c 'import dolfinx, getfem'
echo "The other codes are installed."
