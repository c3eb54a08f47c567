"""What is wrong is told as by the command: all of it, with its place; nothing is left behind."""

import copy
import pickle
import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mmxrt
import numpy as np
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


def test_what_is_refused_here_has_its_items_too(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    refused: list[tuple[Callable[[], object], set[str]]] = [
        (lambda: scene.solve(radiance="camera", force=True), {"radiance", "force"}),
        (lambda: scene.solve(folder / "t.npz", radiance="sideways"), {"radiance"}),
        (lambda: scene.simulate(footprints=True, force=True), {"footprints", "force"}),
        (lambda: scene.locate(), {"pixels"}),
        (lambda: scene.locate(pixels=[[0, 0]], ground_m=[[0, 0, 0]]), {"pixels"}),
        (lambda: scene.locate(pixels=[1.0, 2.0, 3.0]), {"pixels"}),
        (lambda: scene.locate(ground_m=[1.0, 2.0]), {"ground_m"}),
        (lambda: scene.locate(pixels=[[0, 0]], band=0), {"band"}),
        (lambda: scene.locate(pixels=[[0, 0]], band=3), {"band"}),
        (lambda: scene.set("[0].x", 1), {"[0].x"}),
        (lambda: scene.set("", 1), {""}),
        (lambda: scene.set(r'materials."a\q"', 1), {r'materials."a\q"'}),
        (lambda: scene.set("absent", None), {"absent"}),
        (lambda: scene.set("absent.too", None), {"absent.too"}),
        (lambda: scene.set("sensor[0]", 1), {"sensor[0]"}),
        (lambda: scene.set("sensor.samples.x", 1), {"sensor.samples.x"}),
        (lambda: scene.set("mesh[7].file", "x"), {"mesh[7].file"}),
        (lambda: scene.set("mesh[1].file", "x"), {"mesh[1].file"}),
        (lambda: mmxrt.integrate(scene, folder / "o", table=folder / "t.npz", views="all"), {"views"}),
        (lambda: mmxrt.integrate(scene, folder / "o", table=folder / "t.npz", texels="cubic"), {"texels"}),
        (lambda: mmxrt.integrate(scene, folder / "o", table=folder / "t.npz", unknown=-1.0), {"unknown"}),
    ]
    for i, (ask, items) in enumerate(refused):
        with pytest.raises(mmxrt.InvalidError) as caught:
            ask()
        assert {problem.item for problem in caught.value.problems} == items, i
        assert all(problem.message in str(caught.value) for problem in caught.value.problems)


def test_a_cube_that_no_memory_holds_is_refused_at_once(folder: Path) -> None:
    # 1e6 pixels x 1e5 bands: 0.4 TB in single precision, and weights of some 0.4 GB.
    sensor = {"samples": 1000, "lines": 1000, "ifov_mrad": 0.1, "bands": {"start_um": 1.0, "stop_um": 3.6, "count": 100_000}}
    scene = mmxrt.Scene(plate(sensor=sensor), folder=folder)
    with pytest.raises(mmxrt.InvalidError, match="100000 bands take some 400") as caught:
        scene.simulate()
    assert caught.value.problems[0].item == "sensor" and "folder" in str(caught.value.problems[0].help)


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
    scene["mesh"][-1]["unit_m"] = 2.5
    assert scene.settings[-1] == "mesh[0].unit_m=2.5"
    scene["mesh"][np.int64(0)]["unit_m"] = 2.0
    assert [s for s in scene.settings if s.startswith("mesh[0].unit_m")] == ["mesh[0].unit_m=2.0"] * 2
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


def test_what_is_set_again_is_said_once(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    one = scene["mesh"][0].to_plain()
    (folder / "far.obj").write_text("v 200 0 0\nv 201 0 0\nv 200 1 0\nusemtl grey\nf 1 2 3\n")
    two = [one, one | {"file": "far.obj"}]
    scene.set("mesh", two).set("mesh[1].unit_m", 2.0).set("mesh", two)
    assert len(scene.settings) == 1
    scene.simulate()
    scene.set("sun.distance_au", 2.0).set("sun", scene["sun"].to_plain()).set("sun.distance_au", 3.0)
    assert [setting.partition("=")[0] for setting in scene.settings] == ["mesh", "sun", "sun.distance_au"]
    scene.set("sun_of_another_name.x", 1).set("sun", None)
    assert [setting.partition("=")[0] for setting in scene.settings] == ["mesh", "sun_of_another_name.x", "sun"]
    for i in range(3):
        scene["mesh"][0]["unit_m"] = 1.0 + i
    assert scene.settings[-1] == "mesh[0].unit_m=3.0" and len(scene.settings) == 4


def test_what_is_refused_changes_nothing(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    before = scene.to_plain()
    for steps in [("a", "b", 0), ("a", "b", 0, "c"), ("sensor", "samples", "x"), ("mesh", 1, "x"), ("mesh", 2), ("mesh", "x")]:
        with pytest.raises((LookupError, TypeError)):
            scene._set(steps, 1)
    for steps in [("a",), ("a", "b"), ("sensor", "a"), ("mesh", 1), ("mesh", -2), ("mesh", 0, "a", "b")]:
        with pytest.raises(LookupError):
            scene._set(steps, None)
    with pytest.raises(TypeError):
        scene["mesh"][0:1] = []
    assert scene.to_plain() == before and scene.settings == []


def replayed(tree: Any, settings: list[str]) -> Any:
    """What the command makes of settings, by its rules and another reader of TOML."""
    tomllib = pytest.importorskip("tomllib")
    for setting in settings:
        name, value = re.fullmatch(r'((?:"(?:[^"\\]|\\.)*"|[^="])*)=(.*)', setting, re.DOTALL).groups()  # type: ignore[union-attr]
        steps = [step for step in re.findall(r'"(?:[^"\\]|\\.)*"|\[\d+\]|[\w-]+', name)]
        place, last = tree, None
        for i, step in enumerate(steps):
            last = int(step[1:-1]) if step[0] == "[" else tomllib.loads(f"x={step}")["x"] if step[0] == '"' else step
            if i + 1 < len(steps):
                place = place[last] if isinstance(place, list) else place.setdefault(last, {})
        if isinstance(place, list):
            assert isinstance(last, int) and last <= len(place) - (not value), (setting, place)
            place[last : last + 1] = [tomllib.loads(f"x={value}")["x"]] if value else []
        elif value:
            place[last] = tomllib.loads(f"x={value}")["x"]
        else:
            place.pop(last, None)
    return tree


@pytest.mark.parametrize("seed", range(40))
def test_settings_make_the_scene_that_is_read(folder: Path, seed: int) -> None:
    chance = random.Random(seed)
    names = ["a", "b", 'c "d"', "e\\f", "g=[h].i"]

    def some(depth: int) -> Any:
        kind = chance.randrange(4 if depth < 3 else 1)
        if kind == 3:
            return [some(depth + 1) for _ in range(chance.randrange(4))]
        return {name: some(depth + 1) for name in names if chance.random() < 0.5} if kind else chance.randrange(100)

    scene = mmxrt.Scene({name: some(0) for name in names}, folder=folder)
    first = scene.to_plain()
    for _ in range(100):
        steps: tuple[str | int, ...] = ()
        place: Any = scene.to_plain()
        while not steps or (isinstance(place, dict | list) and chance.random() < 0.6):
            step = chance.randrange(-1, len(place) + 1) if isinstance(place, list) else chance.choice(names)
            steps += (step,)
            try:
                place = place[step]
            except LookupError:
                break
        try:
            scene._set(steps, None if chance.random() < 0.3 else some(1))
        except LookupError:
            continue
        assert replayed(copy.deepcopy(first), scene.settings) == scene.to_plain(), scene.settings


def test_names_with_quotation_marks_reach_the_library(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    scene["materials"]['grey "old" \\ (2), 3'] = {"reflectance": 0.14}
    scene["mesh"][0]["material"] = 'grey "old" \\ (2), 3'
    product = scene.simulate(folder / "out")
    assert product.report["settings"] == scene.settings
    np.testing.assert_allclose(product.cube, 2 * mmxrt.Scene(plate(), folder=folder).simulate().cube, rtol=1e-6)
