"""What is wrong is told as by the command: all of it, with its place; nothing is left behind."""

import pickle
from pathlib import Path
from typing import Any

import mmxrt
import pytest
from conftest import plate


def changed(folder: Path, item: str, value: Any) -> mmxrt.Scene:
    return mmxrt.Scene(plate(), folder=folder).set(item, value)


@pytest.mark.parametrize(
    ("item", "value", "named"),
    [
        ("sensor.samples", 0, "sensor.samples"),
        ("sensor.samples", "many", "sensor.samples"),
        ("sensor.samlpes", 8, "sensor.samlpes"),
        ("sensor.bands.centres_um", [], "sensor.bands"),
        ("sensor.bands.centres_um", [-1.0], "sensor.bands"),
        ("materials.grey.reflectance", 1.5, "materials.grey.reflectance"),
        ("materials.grey.reflectance", float("nan"), "reflectance"),
        ("sun.direction", [0.0, 0.0, 0.0], "sun.direction"),
        ("sun.distance_au", -1.0, "sun.distance_au"),
        ("mesh[0].file", "none.obj", "none.obj"),
        ("observer.up", [0.0, 0.0, 1.0], "observer"),
        ("observer", None, "observer"),
        ("mesh", None, "mesh"),
    ],
)
def test_wrong_scenes_say_what_and_where(folder: Path, item: str, value: Any, named: str) -> None:
    scene = changed(folder, item, value)
    with pytest.raises(mmxrt.Error) as caught:
        scene.simulate(folder / "out")
    problems = caught.value.problems
    assert problems and all(problem.message for problem in problems)
    assert any(named in f"{p.item} {p.file} {p.message}" for p in problems), problems
    assert not (folder / "out").exists() and not [p for p in folder.iterdir() if p.name.startswith(".")]
    with pytest.raises(mmxrt.Error):
        scene.validate()


def test_all_problems_are_told_at_once(folder: Path) -> None:
    scene = changed(folder, "sensor.samples", -1).set("sun.distance_au", "far").set("colour", "red")
    with pytest.raises(mmxrt.InvalidError) as caught:
        scene.validate()
    items = {problem.item for problem in caught.value.problems}
    assert items == {"sensor.samples", "sun.distance_au", "colour"}
    assert "--set" not in str(caught.value)
    assert str(caught.value).count("\n") >= 2


def test_a_files_problems_have_their_lines(folder: Path) -> None:
    (folder / "scene.toml").write_text("mmxrt_scene = 1\nsensor = 5\n")
    with pytest.raises(mmxrt.InvalidError) as caught:
        mmxrt.Scene.load(folder / "scene.toml").validate()
    at = [p for p in caught.value.problems if p.item == "sensor"]
    assert at and (at[0].line, at[0].column) == (2, 10) and str(at[0].file).endswith("scene.toml")
    (folder / "broken.toml").write_text("a = [1,\n")
    with pytest.raises(mmxrt.TextError) as broken:
        mmxrt.Scene.load(folder / "broken.toml")
    assert broken.value.problems[0].line is not None
    with pytest.raises(mmxrt.IoError) as missing:
        mmxrt.Scene.load(folder / "none.toml")
    assert isinstance(missing.value, OSError) and "none.toml" in str(missing.value)


def test_a_dictionarys_problems_have_lines_too(folder: Path) -> None:
    scene = mmxrt.Scene(plate(sensor={"samples": 0, "lines": 6}), folder=folder)
    with pytest.raises(mmxrt.InvalidError) as caught:
        scene.validate()
    assert all(str(p.file).endswith("<dict>") and p.line for p in caught.value.problems if p.item == "sensor.samples")


def test_arguments_are_checked(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    wrong: list[dict[str, Any]] = [
        {"model": "everything"},
        {"tolerance": 0.0},
        {"tolerance": float("nan")},
        {"quantity": "colour"},
        {"dtype": "f16"},
        {"out": folder / "o", "format": "tiff"},
        {"out": folder / "o", "interleave": "bsp"},
        {"out": folder / "o", "planes_of": [0]},
        {"format": "netcdf"},
        {"footprints": True},
    ]
    for arguments in wrong:
        with pytest.raises(mmxrt.InvalidError) as caught:
            scene.simulate(**arguments)
        assert caught.value.problems, arguments
        assert not (folder / "o").exists()
    with pytest.raises(mmxrt.InvalidError) as both:
        scene.simulate(folder / "o", dtype="f16", quantity="colour")
    assert {p.item for p in both.value.problems} == {"dtype", "quantity"}
    with pytest.raises(TypeError):
        mmxrt.Scene({"sun": object()})
    with pytest.raises(mmxrt.InvalidError):
        scene.set("[0].x", 1)
    with pytest.raises((KeyError, IndexError)):
        scene["mesh"][7]["file"] = "x"


def test_a_product_is_not_replaced_unless_forced(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    scene.simulate(folder / "out")
    with pytest.raises(mmxrt.Error):
        scene.simulate(folder / "out")
    scene.simulate(folder / "out", force=True)
    with pytest.raises(mmxrt.IoError):
        mmxrt.open(folder)


def test_errors_can_be_sent_to_another_process(folder: Path) -> None:
    with pytest.raises(mmxrt.InvalidError) as caught:
        changed(folder, "sensor.samples", 0).validate()
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is mmxrt.InvalidError and again.problems == caught.value.problems and str(again) == str(caught.value)


def test_scenes_read_as_they_are_set(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    other = scene.copy()
    scene["sensor"]["samples"] = 4
    scene["mesh"][0]["unit_m"] = 2.0
    scene.set('materials."a b".reflectance', 0.2)
    assert (scene["sensor"]["samples"], other["sensor"]["samples"]) == (4, 8)
    assert scene["mesh"][0]["unit_m"] == 2.0 and "a b" in scene["materials"]
    assert scene.settings[-1] == 'materials."a b".reflectance=0.2'
    scene.set("sensor.samples", 5)
    assert [s for s in scene.settings if s.startswith("sensor.samples=")] == ["sensor.samples=5"]
    scene["mesh"][1] = {"recipe": "rugged"}
    scene["mesh"][2] = {"recipe": "dunes"}
    assert len(scene["mesh"]) == 3
    del scene["mesh"][1]
    del scene["mesh"][1]
    assert len(scene["mesh"]) == 1 and scene.settings.count("mesh[1]=") == 2
    del scene["mesh"][0]["unit_m"]
    assert "unit_m" not in scene["mesh"][0]
    assert other.simulate().cube.shape == (2, 6, 8) and scene.simulate().cube.shape == (2, 6, 5)
    assert mmxrt.Scene(plate(materials={"grey": {"reflectance": "a\"b\\c\x7f\n.csv"}}))["materials"]["grey"]
