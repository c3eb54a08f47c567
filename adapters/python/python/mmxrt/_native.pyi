import os
from collections.abc import Sequence
from typing import Any

from ._progress import Tell
from ._scene import Scene

__all__ = [
    "command",
    "convert",
    "ground",
    "hold",
    "hold_table",
    "inspect",
    "integrate",
    "place",
    "plan",
    "read_table",
    "simulate",
    "solve",
    "tree",
    "version",
]

_Path = str | os.PathLike[str]

version: str

def command(arguments: Sequence[str]) -> int: ...
def tree(path: _Path) -> str: ...
def inspect(source: Scene, tell: Tell | None) -> str: ...
def plan(source: Scene, model: str, tolerance: float, tell: Tell | None) -> str: ...
def simulate(
    source: Scene,
    out: _Path,
    force: bool,
    model: str,
    tolerance: float,
    ideal: bool,
    options: dict[str, Any],
    tell: Tell | None,
) -> None: ...
def hold(
    source: Scene, model: str, tolerance: float, ideal: bool, options: dict[str, Any], tell: Tell | None
) -> dict[str, Any]: ...
def integrate(
    source: Scene,
    table: _Path | None,
    radiance: Sequence[str],
    out: _Path,
    force: bool,
    how: tuple[str, str, str],
    options: dict[str, Any],
    tell: Tell | None,
) -> None: ...
def solve(
    source: Scene,
    out: _Path,
    radiance: str | None,
    force: bool,
    model: str,
    tolerance: float,
    tell: Tell | None,
) -> None: ...
def hold_table(source: Scene, model: str, tolerance: float, tell: Tell | None) -> dict[str, Any]: ...
def read_table(path: _Path) -> dict[str, Any]: ...
def ground(
    source: Scene, pixels: Sequence[tuple[float, float]], band: int | None, tell: Tell | None
) -> dict[str, Any]: ...
def place(
    source: Scene, points_m: Sequence[tuple[float, float, float]], band: int | None, tell: Tell | None
) -> dict[str, Any]: ...
def convert(input: _Path, output: _Path, choices: dict[str, Any], tell: Tell | None) -> str: ...
