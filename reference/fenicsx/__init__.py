"""Method (8) of Chouly & Hild, SIAM J. Numer. Anal. 51 (2013) 1295-1307, in FEniCSx: an independent reference.

The package reads the project's case files, solves them with DOLFINx and PETSc and writes the project's result.json.
It shares no code with the solver that it is compared with.
"""
