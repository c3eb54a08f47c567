"""Types hold within the package, and its stubs say what the native half has."""

import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent.parent


def test_types_hold() -> None:
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--config-file", HERE / "pyproject.toml", HERE / "python" / "mmxrt"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_stubs_are_those_of_the_module(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    # Elsewhere, so that what is installed is looked at.
    command = [sys.executable, "-m", "mypy.stubtest", "mmxrt._native"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_public_is_explained() -> None:
    import mmxrt

    for name in mmxrt.__all__:
        thing = getattr(mmxrt, name)
        assert name.startswith("__") or thing.__doc__, name
    for kind in (mmxrt.Scene, mmxrt.Product):
        for name, member in vars(kind).items():
            assert name.startswith("_") or member.__doc__, name
