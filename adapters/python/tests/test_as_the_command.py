"""The same bytes as the command, and its own entry point."""

import filecmp
import json
import subprocess
import sys
from pathlib import Path

import mmxrt
import numpy as np
import pytest
from conftest import plate, run

SCENE = """mmxrt_scene = 1
origin_m = [0.0, 0.0, 12000.0]
[[mesh]]
file = "plate.obj"
pose = "radial"
[materials]
grey = { reflectance = 0.07 }
[sun]
direction = [0.866, 0.0, 0.5]
distance_au = 1.5
[observer]
position_m = [0.0, 0.0, 13000.0]
target_m = [0.0, 0.0, 12000.0]
up = [0.0, 1.0, 0.0]
[sensor]
samples = 8
lines = 6
ifov_mrad = 20.0
bands = { start_um = 1.0, stop_um = 3.6, count = 12, fwhm_um = 0.01 }
"""


def written(folder: Path) -> Path:
    text = SCENE.replace("[0.866, 0.0, 0.5]", f"[{0.75**0.5!r}, 0.0, 0.5]")
    (folder / "scene.toml").write_text(text)
    return folder / "scene.toml"


def assert_same(ours: Path, theirs: Path) -> None:
    names = sorted(path.name for path in theirs.iterdir())
    assert names == sorted(path.name for path in ours.iterdir())
    assert len(names) > 5
    # Date, threads and timings are in run.json, and nowhere else.
    same, other, failed = filecmp.cmpfiles(ours, theirs, [n for n in names if n != "run.json"], shallow=False)
    assert (other, failed) == ([], []) and same
    keys = [json.loads((folder / "run.json").read_text()).keys() for folder in (ours, theirs)]
    assert keys[0] == keys[1]


def test_a_product_is_that_of_the_command(folder: Path, program: str) -> None:
    scene = mmxrt.Scene.load(written(folder))
    scene["sensor"]["samples"] = 5
    scene.set("materials.grey.reflectance", 0.1)
    assert scene.settings == ["sensor.samples=5", "materials.grey.reflectance=0.1"]
    product = scene.simulate(folder / "ours", table=True, split=True, format=["envi", "netcdf"], footprints=True)
    settings = [part for setting in scene.settings for part in ("--set", setting)]
    options = ["--table", "--split", "--footprints", "--format", "envi,netcdf"]
    done = run(program, "simulate", folder / "scene.toml", *settings, *options, "-o", folder / "theirs")
    assert done.returncode == 0, done.stderr
    assert_same(folder / "ours", folder / "theirs")
    assert product.cube.shape == (12, 6, 5) and product.table is not None


@pytest.mark.parametrize("interleave", ["bsq", "bil", "bip"])
def test_memory_and_folder_hold_the_same_numbers(folder: Path, interleave: str) -> None:
    scene = mmxrt.Scene.load(written(folder))
    # A name that looks like one with a unit, and that a header of ENVI cannot hold.
    odd = "grey (old), 2"
    scene["materials"][odd] = {"reflectance": 0.07}
    scene["mesh"][0]["material"] = odd
    scene["mars"] = {"position_m": [0.0, 0.0, 9.376e6]}
    held = scene.simulate(split=True, table=True)
    opened = scene.simulate(folder / "out", split=True, table=True, interleave=interleave)
    np.testing.assert_array_equal(held.cube, opened.cube)
    np.testing.assert_array_equal(held.thermal, opened.thermal)
    assert (held.thermal > 0).any()
    np.testing.assert_array_equal(held.wavelength_um, opened.wavelength_um)
    np.testing.assert_array_equal(held.fwhm_um, opened.fwhm_um)
    assert list(held.units.items()) == list(opened.units.items())
    assert (held.units["RANGE"], held.units[f"ABUNDANCE {odd}"], held.units[f"ABUNDANCE_LIT {odd}"]) == ("m", "1", "1")
    assert list(held.backplanes) == list(opened.backplanes)
    for name, values in held.backplanes.items():
        np.testing.assert_array_equal(values, opened.backplanes[name], err_msg=name)
    assert held.report == opened.report
    assert opened.table is not None and held.table is not None
    for name, values in held.table.items():
        np.testing.assert_array_equal(values, opened.table[name], err_msg=name)
    assert {"sun_irradiance", "sun_share", "mars_irradiance", "mars_share", "temperature_lit_k"} <= held.table.keys()
    solved, filed = scene.solve(), scene.solve(folder / "table.npz")
    assert solved.keys() == held.table.keys() and solved.keys() < filed.keys()
    assert all(values.shape == (2,) for values in solved.values())
    for name, values in solved.items():
        np.testing.assert_array_equal(values, filed[name], err_msg=name)
    # A level plate hides nothing from itself.
    np.testing.assert_array_equal(filed["sun_share"], 1.0)
    np.testing.assert_array_equal(filed["mars_share"], 1.0)


def test_memory_has_the_detectors_numbers(folder: Path) -> None:
    scene = mmxrt.Scene.load(written(folder))
    detector = {"throughput": 0.2, "read_e": 100, "gain_e_dn": 64, "full_well_e": 1e6, "bits": 14}
    for name, value in {"f_number": 4.0, "pixel_um": 30.0, "exposure_s": 0.1, "detector": detector}.items():
        scene["sensor"][name] = value
    held, opened = scene.simulate(), scene.simulate(folder / "out")
    assert held.dn is not None and held.dn.dtype == np.uint32
    np.testing.assert_array_equal(held.dn, opened.dn)
    np.testing.assert_array_equal(held.cube, opened.cube)
    assert held.report == opened.report and held.report["signal"]["bands"]
    assert scene.simulate(ideal=True).dn is None


def test_tables_serve_integrate(folder: Path, program: str) -> None:
    scene = mmxrt.Scene.load(written(folder))
    table = scene.solve(folder / "ours.npz")
    assert len(table["sun_irradiance"]) == 2
    assert run(program, "solve", folder / "scene.toml", "-o", folder / "theirs.npz").returncode == 0
    assert (folder / "ours.npz").read_bytes() == (folder / "theirs.npz").read_bytes()
    product = mmxrt.integrate(scene, folder / "by_table", table=folder / "ours.npz")
    np.testing.assert_array_equal(product.cube, scene.simulate().cube)
    by_command = run(program, "integrate", folder / "scene.toml", "--table", folder / "ours.npz", "-o", folder / "by_command")
    assert by_command.returncode == 0, by_command.stderr
    assert_same(folder / "by_table", folder / "by_command")


def test_accounts_are_those_of_the_command(folder: Path, program: str) -> None:
    scene = mmxrt.Scene.load(written(folder))
    for ours, command in [(scene.inspect(), "inspect"), (scene.plan(), "plan")]:
        theirs = json.loads(run(program, command, folder / "scene.toml", "--json").stdout)
        # Free memory is another one at each call.
        ours.pop("free", None), theirs.pop("free", None)
        assert ours == theirs


def test_conversions_are_those_of_the_command(folder: Path, program: str) -> None:
    account = mmxrt.convert(folder / "plate.obj", folder / "ours.glb")
    assert account["written"] and account["to"] == "glb"
    assert run(program, "convert", folder / "plate.obj", folder / "theirs.glb").returncode == 0
    assert (folder / "ours.glb").read_bytes() == (folder / "theirs.glb").read_bytes()
    with pytest.raises(mmxrt.IoError):
        mmxrt.convert(folder / "none.obj", folder / "x.glb")
    with pytest.raises(mmxrt.InvalidError, match="formats are"):
        mmxrt.convert(folder / "plate.obj", folder / "x.glb", to_format="word")


def test_a_dictionary_is_the_same_scene_as_a_file(folder: Path) -> None:
    of_dict = mmxrt.Scene.from_dict(plate(), folder=folder)
    again = mmxrt.Scene(of_dict.to_plain(), folder=folder)
    np.testing.assert_array_equal(of_dict.simulate().cube, again.simulate().cube)
    assert of_dict.simulate().report["inputs"][0]["path"].endswith("<dict>")
    product = of_dict.simulate(folder / "out")
    assert product.path == folder / "out"


def test_the_wheels_command_is_the_command(folder: Path) -> None:
    command = [sys.executable, "-c", "import sys; from mmxrt._command import main; sys.exit(main())"]
    done = subprocess.run([*command, "-h"], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "Usage: mmxrt " in done.stdout
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    assert version.stdout == f"mmxrt {mmxrt.__version__}\n"
    assert subprocess.run([*command, "simulate"], capture_output=True, check=False).returncode == 2
    missing = subprocess.run([*command, "inspect", "none"], capture_output=True, text=True, check=False)
    assert missing.returncode == 1 and "none" in missing.stderr
    lost = subprocess.run([*command, "convert", "--list", folder / "plate.obj"], capture_output=True, text=True, check=False)
    assert lost.returncode == 0 and "facets" in lost.stdout
