"""Scenes: from files or dictionaries, changed item by item, checked exactly as files are."""

from __future__ import annotations

import copy
import json
import operator
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _native, _toml
from ._errors import Problem, refused
from ._product import Product, held, numpy, open, table_of
from ._progress import Progress, telling

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_StrPath = str | os.PathLike[str]
Steps = tuple[str | int, ...]

_STEP = re.compile(r'(?P<quoted>"(?:[^"\\]|\\.)*")|\[(?P<index>\d+)\]|(?P<bare>[^."\[\]]+)')
TOLERANCE = 1e-3
"""The largest error of a pixel that all that is left out may add up to, unless another is asked for: 0.1 %."""


class Item:
    """A table or list of a scene, whose items can be read and set: `scene["mesh"][0]["recipe"] = "dunes"`."""

    def __init__(self, scene: Scene, steps: Steps) -> None:
        self._scene = scene
        self._steps = steps

    def __getitem__(self, step: str | int) -> Any:
        return self._scene._get((*self._steps, step))

    def __setitem__(self, step: str | int, value: Any) -> None:
        self._scene._set((*self._steps, step), value)

    def __delitem__(self, step: str | int) -> None:
        self._scene._set((*self._steps, step), None)

    def __iter__(self) -> Iterator[Any]:
        return iter(self._scene._at(self._steps))

    def __len__(self) -> int:
        return len(self._scene._at(self._steps))

    def __contains__(self, step: object) -> bool:
        return step in self._scene._at(self._steps)

    def __eq__(self, other: object) -> bool:
        here = self._scene._at(self._steps)
        return bool(here == (other._scene._at(other._steps) if isinstance(other, Item) else other))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(self._scene._at(self._steps))

    def to_plain(self) -> Any:
        """A copy, as dictionaries and lists."""
        return copy.deepcopy(self._scene._at(self._steps))


class Scene(Item):
    """All that a simulation needs, as a scene file says it (`schemas/scene.schema.json`).

    Nothing is checked before it is needed: `validate` does so, and whatever simulates.
    """

    def __init__(
        self, items: Mapping[str, Any], *, folder: _StrPath = ".", cache: _StrPath | None = None
    ) -> None:
        """Of a dictionary as a scene file has it; paths in it are relative to `folder`. In the folder `cache` prepared bodies are kept for the next time.

        Raises `TypeError` for what no file could hold.
        """
        super().__init__(self, ())
        self._tree: dict[str, Any] = _toml.plain(items)
        self._tree.setdefault("mmxrt_scene", 1)
        self._path = os.path.join(os.fspath(folder), "<dict>")
        self._text: str | None = _toml.document(self._tree)
        self._changes: list[tuple[Steps, str]] = []
        self._cache = None if cache is None else os.fspath(cache)

    @classmethod
    def from_dict(
        cls, items: Mapping[str, Any], *, folder: _StrPath = ".", cache: _StrPath | None = None
    ) -> Scene:
        """The same as `Scene(items, folder=folder, cache=cache)`."""
        return cls(items, folder=folder, cache=cache)

    @classmethod
    def load(cls, path: _StrPath, *, cache: _StrPath | None = None) -> Scene:
        """Of a scene file. In the folder `cache` prepared bodies (landscapes that were made, meshes that were read) are kept for the next time.

        Raises `IoError` if it cannot be read, `TextError` if it is not TOML. What it says is checked by `validate`.
        """
        scene = cls.__new__(cls)
        Item.__init__(scene, scene, ())
        scene._path, scene._text, scene._changes = os.fspath(path), None, []
        scene._cache = None if cache is None else os.fspath(cache)
        scene._tree = json.loads(_native.tree(path))
        return scene

    def __repr__(self) -> str:
        return f"<mmxrt.Scene {self._path}{''.join(f', {setting}' for setting in self.settings)}>"

    def copy(self) -> Scene:
        """Another scene that says the same."""
        scene = type(self).__new__(type(self))
        Item.__init__(scene, scene, ())
        scene._path, scene._text, scene._changes = self._path, self._text, list(self._changes)
        scene._cache = self._cache
        scene._tree = copy.deepcopy(self._tree)
        return scene

    def set(self, item: str, value: Any) -> Scene:
        """Sets an item by its name, as in `scene.set("sensor.samples", 64)` or `scene.set("mesh[0].recipe", "dunes")`; `None` takes it away.

        Returns the scene. Raises `InvalidError` for a name that is none, or that has no place in the scene; then nothing is changed.
        """
        steps, plain = _steps(item), None if value is None else _toml.plain(value)
        try:
            self._put(steps, plain)
        except (LookupError, TypeError) as error:
            message = "is not there" if isinstance(error, KeyError) else str(error)
            raise refused(Problem(message, item=item)) from error
        return self

    @property
    def settings(self) -> list[str]:
        """What has been changed, as `--set` of the command says it."""
        return [f"{_named(steps)}={value}" for steps, value in self._changes]

    def _at(self, steps: Steps) -> Any:
        place: Any = self._tree
        for step in steps:
            place = place[step]
        return place

    def _get(self, steps: Steps) -> Any:
        found = self._at(steps)
        return Item(self, steps) if isinstance(found, dict | list) else found

    def _set(self, steps: Steps, value: Any) -> None:
        self._put(steps, None if value is None else _toml.plain(value))

    def _put(self, steps: Steps, value: Any) -> None:
        """Changes the tree here, for reading, and says so to the library, which checks it when it reads the scene.

        Raises `KeyError`, `IndexError` or `TypeError` for an item that has no place; then nothing is changed.
        """
        place: Any = self._tree
        way: Steps = ()
        for step in steps[:-1]:
            way += (_into(place, way, step),)
            # A table that is not there is made below, when all of the way is known.
            place = {} if isinstance(place, dict) and way[-1] not in place else place[way[-1]]
        last = _into(place, way, steps[-1])
        if value is None:
            # Raises if there is nothing to take away.
            place[last]
        place = self._tree
        for step in way:
            place = place.setdefault(step, {}) if isinstance(place, dict) else place[step]
        if value is None:
            del place[last]
        elif isinstance(place, list) and last == len(place):
            place.append(value)
        else:
            place[last] = value
        self._say((*way, last), "" if value is None else _toml.value(value))

    def _say(self, steps: Steps, value: str) -> None:
        """Adds a change, and drops those before it that it replaces: of the same item, or of what is in it."""

        def is_replaced(change: tuple[Steps, str]) -> bool:
            return change[0][: len(steps)] == steps

        if all(isinstance(step, str) for step in steps):
            self._changes = [change for change in self._changes if not is_replaced(change)]
        elif value:
            # Elements come and go, and their numbers come to mean others: only what was said just before is sure to be of this one.
            while self._changes and is_replaced(self._changes[-1]) and self._changes[-1] != (steps, ""):
                self._changes.pop()
        self._changes.append((steps, value))

    def validate(self, *, progress: Progress = None) -> Scene:
        """Checks all of it: its text, values, files and meshes. Returns the scene.

        Raises `InvalidError` and others with all problems; `UnsupportedError` if it is right, but more than this version can simulate.
        """
        told = self.inspect(progress=progress)
        if not told["begins"]:
            self.plan(progress=progress)
        return self

    def inspect(self, *, progress: Progress = None) -> dict[str, Any]:
        """What a simulation would be about and take, and its warnings, as `mmxrt inspect --json` says; nothing is computed or written."""
        with telling(progress) as tell:
            told: dict[str, Any] = json.loads(_native.inspect(self, tell))
        return told

    def plan(
        self,
        *,
        model: str | Sequence[str] = "auto",
        tolerance: float = TOLERANCE,
        progress: Progress = None,
    ) -> dict[str, Any]:
        """Which effects a simulation would model (`plan`) and what it would take (`expects`), as `mmxrt plan --json` says."""
        with telling(progress) as tell:
            told: dict[str, Any] = json.loads(_native.plan(self, _model(model), tolerance, tell))
        return told

    def simulate(
        self,
        out: _StrPath | None = None,
        *,
        model: str | Sequence[str] = "auto",
        tolerance: float = TOLERANCE,
        quantity: str = "radiance",
        dtype: str = "f32",
        split: bool = False,
        table: bool = False,
        ideal: bool = False,
        format: str | Sequence[str] = "envi",
        interleave: str = "bsq",
        footprints: bool = False,
        planes_of: Sequence[int] = (),
        force: bool = False,
        progress: Progress = None,
    ) -> Product:
        """Simulates the scene.

        Without `out` the product is in memory only, and `format`, `interleave`, `footprints` and `planes_of`, which are of files, must not be given;
        with `out` it is a folder, byte for byte as `mmxrt simulate` writes it, which is then opened.

        `model`: "auto", "thesis", "full", or effects such as `["sunlight", "mars-light", "heat"]`. `tolerance`: the largest error of a pixel
        that all that is left out may add up to, over its radiance or 0.01 of the median sunlit one. `quantity`: "radiance" (W m-2 sr-1 um-1),
        "band_radiance" (W m-2 sr-1), "radiance_factor" (I/F), "reflectance_factor", or "brightness_temperature" (K). `dtype`: "f32" or "f64".
        `split`: the thermal part as well; `table`: the facet table as well; `ideal`: without the sensor's optics and detector. `force`: replace a product
        that is there. `progress`: True, or a function of stage, steps done and steps in all.

        Raises `InvalidError` and others with all problems, `KeyboardInterrupt` on Ctrl-C; then nothing is left half-written.
        """
        options = _options(format, interleave, dtype, quantity, table, split, footprints, planes_of)
        if out is None:
            ours = {"format": options["format"] != ["envi"], "interleave": interleave != "bsq"}
            ours |= {"footprints": footprints, "planes_of": bool(planes_of), "force": force}
            of_files = [name for name, is_given in ours.items() if is_given]
            if of_files:
                raise refused(*(Problem("belongs to a product in a folder", item=name, help="give `out`") for name in of_files))
            numpy()
            with telling(progress) as tell:
                return held(_native.hold(self, _model(model), tolerance, ideal, options, tell))
        with telling(progress) as tell:
            _native.simulate(self, out, force, _model(model), tolerance, ideal, options, tell)
        return open(out)

    def solve(
        self,
        out: _StrPath | None = None,
        *,
        model: str | Sequence[str] = "auto",
        tolerance: float = TOLERANCE,
        radiance: str | None = None,
        force: bool = False,
        progress: Progress = None,
    ) -> dict[str, NDArray[Any]]:
        """What light and heat reach each facet: arrays with a number for each facet, [facet].

        `NAME_irradiance` of each source, relative (of the Sun: cos i), on the part that it sees; `NAME_share`, the share of each facet that it sees, 1 of a
        source that casts no shadows here; `temperature_lit_k`, `temperature_shaded_k` (K), unless heat is left out; and `reflected_N` (W m-2 um-1), light of
        other facets, unless that is left out. With `out` (`*.npz`) the table is written, byte for byte as `mmxrt solve` does, and what else it has is
        returned as well (directions, polygons that are lit); `radiance` ("camera", "at:X,Y,Z", "towards:X,Y,Z") then writes what each facet sends
        there, too, beside it.

        Raises `InvalidError` and others with all problems.
        """
        numpy()
        with telling(progress) as tell:
            if out is None:
                of_files = [name for name, is_given in (("radiance", radiance is not None), ("force", force)) if is_given]
                if of_files:
                    raise refused(*(Problem("belongs to a table in a file", item=name, help="give `out`") for name in of_files))
                columns: dict[str, NDArray[Any]] = _native.hold_table(self, _model(model), tolerance, tell)
                return columns
            _native.solve(self, out, radiance, force, _model(model), tolerance, tell)
        return table_of(out)

    def locate(
        self,
        *,
        pixels: ArrayLike | None = None,
        ground_m: ArrayLike | None = None,
        band: int | None = None,
        progress: Progress = None,
    ) -> dict[str, NDArray[Any]]:
        """Where on the ground pixels look, or in which pixels points of the ground lie.

        `pixels`: [n, 2], sample and line; the middle of the first pixel is 0.5, 0.5. Gives `x_m`, `y_m`, `z_m` (body-fixed), `latitude_deg`, `longitude_deg`
        (planetocentric, east), `range_m`, `local_emission_deg` and `facet`, [n] each; NaN and -1 where there is no ground.
        `ground_m`: [n, 3], body-fixed, m. Gives `sample`, `line`, `range_m`, `inside` (the image) and `hidden` (by other ground).
        `band`: of a scene that moves, whose exposure, from 1; by default the one in the middle.

        Raises `InvalidError` and others with all problems.
        """
        np = numpy()
        if (pixels is None) == (ground_m is None):
            raise refused(Problem("either this or ground_m has to be given, and not both", item="pixels"))
        wide = 2 if ground_m is None else 3
        places = np.asarray(pixels if ground_m is None else ground_m, dtype=float)
        if places.shape[-1:] != (wide,):
            item, help = "pixels" if ground_m is None else "ground_m", f"give {wide} numbers of each point: [n, {wide}]"
            raise refused(Problem(f"has the shape {places.shape}", item=item, help=help))
        rows = [tuple(row) for row in places.reshape(-1, wide).tolist()]
        with telling(progress) as tell:
            ask = _native.ground if ground_m is None else _native.place
            found: dict[str, NDArray[Any]] = ask(self, rows, band, tell)
        return {name: column.reshape(places.shape[:-1]) for name, column in found.items()}


def integrate(
    scene: Scene,
    out: _StrPath,
    *,
    table: _StrPath | None = None,
    radiance: str | Sequence[str] = (),
    views: str = "nearest",
    texels: str = "nearest",
    unknown: str | float = "error",
    quantity: str = "radiance",
    dtype: str = "f32",
    format: str | Sequence[str] = "envi",
    interleave: str = "bsq",
    footprints: bool = False,
    force: bool = False,
    progress: Progress = None,
) -> Product:
    """Makes a product folder of a scene and its facet table (`Scene.solve`) or radiance maps, as `mmxrt integrate` does, and opens it.

    `radiance`: maps, each as "MAP" or a sum "MAP+MAP*W". `unknown`: what to do where no map knows the radiance: "error", "solve", "nan", or a radiance,
    W m-2 sr-1 um-1. All else as `Scene.simulate`.
    """
    options = _options(format, interleave, dtype, quantity, False, False, footprints, ())
    maps = [radiance] if isinstance(radiance, str) else list(radiance)
    with telling(progress) as tell:
        _native.integrate(scene, table, maps, out, force, (views, texels, str(unknown)), options, tell)
    return open(out)


def _options(
    format: str | Sequence[str],
    interleave: str,
    dtype: str,
    quantity: str,
    table: bool,
    split: bool,
    footprints: bool,
    planes_of: Sequence[int],
) -> dict[str, Any]:
    return {
        "format": format.split(",") if isinstance(format, str) else list(format),
        "interleave": interleave,
        "dtype": dtype,
        "quantity": quantity,
        "table": table,
        "split": split,
        "footprints": footprints,
        "planes_of": list(planes_of),
    }


def _model(model: str | Sequence[str]) -> str:
    return model if isinstance(model, str) else ",".join(model)


def _named(steps: Steps) -> str:
    """Steps as an item's name."""
    name = ""
    for step in steps:
        name += f"[{step}]" if isinstance(step, int) else f"{'.' if name else ''}{_toml.key(step)}"
    return name


def _steps(item: str) -> Steps:
    """An item's name as steps."""
    steps: list[str | int] = []
    for found in _STEP.finditer(item):
        quoted, bare, index = found.group("quoted", "bare", "index")
        try:
            steps.append(int(index) if index is not None else _toml.unquoted(quoted) if quoted is not None else bare)
        except ValueError:
            steps = []
            break
    if not steps or _named(tuple(steps)) != item or isinstance(steps[0], int):
        raise refused(Problem("is no item's name", item=item, help="expected is one such as sensor.samples or mesh[0].recipe"))
    return tuple(steps)


def _into(place: Any, way: Steps, step: Any) -> str | int:
    """A step into what is there, or to what may be added: of lists, -1 is the last element.

    Raises `TypeError`, `IndexError`.
    """
    if isinstance(place, dict) and isinstance(step, str):
        return str(step)
    if isinstance(place, list) and hasattr(step, "__index__"):
        index = operator.index(step)
        index += len(place) if index < 0 else 0
        if not 0 <= index <= len(place):
            raise IndexError(f"{_named(way)} has {len(place)} elements, counted from 0")
        return index
    raise TypeError(f"there is no {step!r} in {_named(way) or 'a scene'}")
