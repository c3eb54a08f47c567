"""A flat plate under a given Sun, and scratch folders."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

PLATE = """v -50 -50 0
v 50 -50 0
v 50 50 0
v -50 50 0
usemtl grey
f 1 2 3 4
"""


def plate(**changes: Any) -> dict[str, Any]:
    """A level Lambert plate of reflectance 0.07 at 12 km, the Sun 60 deg from the zenith at 1.5 au, the camera above, no heat."""
    scene: dict[str, Any] = {
        "mmxrt_scene": 1,
        "origin_m": [0.0, 0.0, 12000.0],
        "mesh": [{"file": "plate.obj", "pose": "radial"}],
        "materials": {"grey": {"reflectance": 0.07}},
        "sun": {"direction": [0.75**0.5, 0.0, 0.5], "distance_au": 1.5},
        "observer": {"position_m": [0.0, 0.0, 13000.0], "target_m": [0.0, 0.0, 12000.0], "up": [0.0, 1.0, 0.0]},
        "sensor": {"samples": 8, "lines": 6, "ifov_mrad": 10.0, "bands": {"centres_um": [1.0, 2.0]}},
        "thermal": {"model": "off"},
    }
    return scene | changes


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "plate.obj").write_text(PLATE)
    return tmp_path


@pytest.fixture(scope="session")
def program() -> str:
    """The binary to compare with, by MMXRT; without it, the wheel's own command."""
    return os.environ.get("MMXRT") or shutil.which("mmxrt", path=os.path.dirname(sys.executable)) or "mmxrt"


def run(program: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
