"""The page of the manual runs as it is written, and so does the example."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


def test_the_page_runs(tmp_path: Path) -> None:
    blocks = re.findall(r"```py\n(.*?)```", (ROOT / "docs/howto/python.md").read_text(), re.DOTALL)
    assert len(blocks) >= 4
    code = "\n".join(blocks).replace('"out/', f'"{tmp_path}/')
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "sensor.samples" in done.stdout and (tmp_path / "from_python" / "cube.nc").exists()


def test_the_example_draws(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    command = [sys.executable, "adapters/python/example.py", str(tmp_path / "example.png")]
    done = subprocess.run(command, cwd=ROOT, env=os.environ | {"MPLBACKEND": "Agg"}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "example.png").stat().st_size > 20_000
