"""Work goes on without Python's lock, tells of itself, and can be stopped."""

import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mmxrt
import numpy as np
import pytest
from conftest import plate, run


def slow(folder: Path) -> mmxrt.Scene:
    """A scene that takes some seconds: a landscape of many facets, in many bands."""
    sensor = {"samples": 400, "lines": 400, "ifov_mrad": 0.2, "bands": {"start_um": 1.0, "stop_um": 3.6, "count": 300}}
    return mmxrt.Scene(plate(sensor=sensor, mesh=[{"recipe": "rugged", "material": "grey"}]), folder=folder)


def test_another_thread_counts_on(folder: Path) -> None:
    scene, counted, stop = slow(folder), [0], threading.Event()

    def count() -> None:
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    scene.simulate(model=["sunlight"])
    took = time.monotonic() - began
    stop.set()
    thread.join()
    assert took > 0.5, "too fast to tell"
    # An idle machine counts some 900 a second, and one that waits for the work none.
    assert counted[0] > 10 * took


def test_progress_is_told(folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mmxrt._progress._PATIENCE_S", 0.0)
    told: list[tuple[str, int, int]] = []
    slow(folder).simulate(model=["sunlight"], progress=lambda *now: told.append(now))
    assert len({stage for stage, _, _ in told}) > 1 and all(0 <= done <= total for _, done, total in told)
    slow(folder).simulate(model=["sunlight"], progress=True)
    said = capsys.readouterr()
    assert "%" in said.err and said.out == ""
    slow(folder).inspect()
    assert capsys.readouterr() == ("", "")


def test_a_landscape_is_kept_for_the_next_time(folder: Path) -> None:
    items = plate(mesh=[{"recipe": "rugged", "material": "grey"}])
    plain = mmxrt.Scene(items, folder=folder).simulate(model="sunlight")
    first = mmxrt.Scene(items, folder=folder, cache=folder / "cache").simulate(model="sunlight")
    kept = sorted(path.name for path in (folder / "cache").iterdir())
    assert any(name.endswith(".landscape") for name in kept), kept
    again = mmxrt.Scene(items, folder=folder, cache=folder / "cache").copy().simulate(model="sunlight")
    assert kept == sorted(path.name for path in (folder / "cache").iterdir())
    assert plain.cube.tobytes() == first.cube.tobytes() == again.cube.tobytes()


def test_a_tree_is_kept_for_the_next_time(folder: Path) -> None:
    items, pixels = plate(mesh=[{"recipe": "rugged", "material": "grey"}]), [[4.0, 3.0], [0.5, 5.5]]
    plain = mmxrt.Scene(items, folder=folder).locate(pixels=pixels)
    for _ in range(2):
        found = mmxrt.Scene(items, folder=folder, cache=folder / "cache").locate(pixels=pixels)
        assert all(found[name].tobytes() == plain[name].tobytes() for name in plain)
        assert any(path.suffix == ".tree" for path in (folder / "cache").iterdir())


def test_locating_tells_and_stops(folder: Path) -> None:
    scene, pixels = mmxrt.Scene(plate(), folder=folder), np.random.default_rng(1).uniform(0.0, 6.0, (300_000, 2))
    told: list[tuple[str, int, int]] = []
    found = scene.locate(pixels=pixels, progress=lambda *now: told.append(now))
    # At every point of the plate the camera looks down on, the place is where it was asked.
    back = scene.locate(ground_m=np.stack([found["x_m"], found["y_m"], found["z_m"]], axis=1))
    np.testing.assert_allclose(np.stack([back["sample"], back["line"]], axis=1), pixels, atol=1e-6)
    assert any(stage == "answers" and total == 300_000 for stage, _, total in told)

    def refuse(stage: str, done: int, total: int) -> None:
        if stage == "answers":
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        scene.locate(pixels=pixels, progress=refuse)


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="a folder that nobody can write to")
def test_a_cache_that_keeps_nothing_is_warned_of(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder, cache="/proc/self")
    with pytest.warns(UserWarning, match="/proc/self cannot be written to") as caught:
        product = scene.simulate()
    assert [warning.filename for warning in caught] == [__file__]
    np.testing.assert_array_equal(product.cube, mmxrt.Scene(plate(), folder=folder).simulate().cube)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning):
            scene.locate(pixels=[[0.5, 0.5]])


def test_threads_share_a_cache(folder: Path) -> None:
    def work() -> None:
        mmxrt.Scene(plate(), folder=folder, cache=folder / "cache").locate(pixels=[[0.5, 0.5]])

    with warnings.catch_warnings(), ThreadPoolExecutor(8) as pool:
        warnings.simplefilter("error")
        for done in [pool.submit(work) for _ in range(200)]:
            done.result()


def test_what_progress_raises_stops_the_work(folder: Path) -> None:
    def refuse(stage: str, done: int, total: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        slow(folder).simulate(folder / "out", progress=refuse)
    assert not (folder / "out").exists() and not [p for p in folder.iterdir() if p.name.startswith(".")]


STOPPED = """
import signal, sys, mmxrt
sys.path.insert(0, {tests!r})
from test_work import slow
from pathlib import Path
scene = slow(Path({folder!r}))
def tell(stage, done, total):
    print(stage, flush=True)
try:
    scene.simulate(Path({folder!r}) / "out", progress=tell)
except KeyboardInterrupt:
    print("stopped", flush=True)
    raise SystemExit(7)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_stops_the_work_and_leaves_nothing(folder: Path) -> None:
    code = STOPPED.format(tests=os.path.dirname(__file__), folder=str(folder))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline(), "nothing was told"
        process.send_signal(signal.SIGINT)
        began = time.monotonic()
        rest, _ = process.communicate(timeout=60)
        assert time.monotonic() - began < 20
    assert process.returncode == 7 and rest.endswith("stopped\n")
    assert sorted(path.name for path in folder.iterdir()) == ["plate.obj"]


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_stops_the_wheels_command(folder: Path, program: str) -> None:
    assert run(program, "new", folder / "scene").returncode == 0
    code = "import sys; from mmxrt._command import main; sys.exit(main())"
    arguments = ["simulate", folder / "scene" / "scene.toml", "--set", "sensor.samples=1000", "--set", "sensor.lines=1000"]
    arguments += ["-o", folder / "out"]
    with subprocess.Popen([sys.executable, "-c", code, *map(str, arguments)], stderr=subprocess.PIPE, text=True) as process:
        time.sleep(2.0)
        assert process.poll() is None, process.communicate()
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 1 and "interrupted: nothing was written" in said
    assert not [p for p in folder.iterdir() if p.name not in ("plate.obj", "scene")]


def test_work_in_threads_gives_the_same(folder: Path) -> None:
    scene, results = mmxrt.Scene(plate(), folder=folder), []
    threads = [threading.Thread(target=lambda: results.append(scene.simulate().cube.tobytes())) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8 and len(set(results)) == 1
