"""Calls `mmxrt`. No `bpy`."""

import os
import shutil
import subprocess


def find(stated=""):
    """The program: where the preferences say, else on the path, else where cargo puts it."""
    if stated:
        if os.path.isfile(stated):
            return stated
        raise FileNotFoundError(f"{stated} is not there: set the path of mmxrt in the add-on's preferences")
    name = "mmxrt.exe" if os.name == "nt" else "mmxrt"
    beside = os.path.join(os.path.expanduser("~"), ".cargo", "bin", name)
    found = shutil.which("mmxrt") or (beside if os.path.isfile(beside) else None)
    if found is None:
        raise FileNotFoundError("mmxrt is neither on the path nor in ~/.cargo/bin: set its path in the add-on's preferences")
    return found


def simulate(program, scene, product, options=()):
    """Makes the product folder of a scene file; what the program said. What it refuses is an error with its words."""
    arguments = [program, "simulate", scene, "-o", product, "--force", "--quiet", *options]
    run = subprocess.run(arguments, capture_output=True, text=True, errors="replace", check=False)
    if run.returncode != 0:
        raise RuntimeError((run.stderr or run.stdout).strip() or f"mmxrt ended with code {run.returncode}")
    return run.stdout + run.stderr
