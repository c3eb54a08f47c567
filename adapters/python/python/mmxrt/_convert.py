"""Conversions between formats."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any

from . import _native
from ._progress import Progress, telling


def convert(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    *,
    from_format: str | None = None,
    to_format: str | None = None,
    dart_version: str | None = None,
    origin_m: Sequence[float] | None = None,
    unit_m: float | None = None,
    flip: bool = False,
    allow_outside: bool = False,
    strict: bool = False,
    force: bool = False,
    models: Sequence[str] = (),
    bands: Sequence[int] = (),
    progress: Progress = None,
) -> dict[str, Any]:
    """Converts a scene, mesh, spectra, image or DART's inputs into another format, as `mmxrt convert` does.

    Formats are recognised by their names and contents unless `from_format` and `to_format` state them. `origin_m`: where a mesh's origin is,
    body-fixed, m; `unit_m`: its unit of length, m; `models`: only spectra of these names; `bands`: only these bands of an image, from 1.
    With `strict` nothing is written if something would be lost.

    Returns an account: `output`, `written`, `from`, `to`, `size`, and `notes` on all that was not carried over as it was.

    Raises `IoError`, `TextError`, `InvalidError`, and `UnsupportedError` if one format does not hold what the other needs.
    """
    choices = {
        "from": from_format,
        "to": to_format,
        "dart_version": dart_version,
        "origin_m": None if origin_m is None else [float(x) for x in origin_m],
        "unit_m": unit_m,
        "flip": flip,
        "allow_outside": allow_outside,
        "strict": strict,
        "force": force,
        "models": list(models),
        "bands": list(bands),
    }
    with telling(progress) as tell:
        account: dict[str, Any] = json.loads(_native.convert(source, target, choices, tell))
    return account
