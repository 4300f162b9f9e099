"""Runs a module of this package on several MPI processes, with what mpirun needs to allow it."""

import os
import subprocess
import sys


def on_ranks(ranks, module, arguments):
    """The exit code of `python3 -m module arguments` on `ranks` processes; --ranks is taken out of the arguments."""
    command = ["mpirun", "-n", str(ranks), *_allowances(), sys.executable, *_isolation(), "-m", module, *_without_ranks(arguments)]
    return subprocess.run(command).returncode


def _allowances():
    """Open MPI refuses more processes than cores, and root, unless told; other implementations don't know these options."""
    try:
        version = subprocess.run(["mpirun", "--version"], capture_output=True, text=True).stdout
    except FileNotFoundError:
        sys.exit("error: mpirun not found; it comes with the MPI that DOLFINx uses (Debian: openmpi-bin)")
    if "Open MPI" not in version:
        return []
    return ["--oversubscribe"] + (["--allow-run-as-root"] if os.geteuid() == 0 else [])


def _isolation():
    """Where this Python does not look for modules in the working folder, neither shall those that it starts."""
    return ["-P"] if getattr(sys.flags, "safe_path", False) else []


def _without_ranks(arguments):
    kept = list(arguments)
    for i, argument in enumerate(kept):
        if argument.startswith("--ranks"):
            del kept[i : i + (1 if "=" in argument else 2)]
            return kept
    return kept
