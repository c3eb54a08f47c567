"""Products: what a camera sees, in memory or in a folder."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._errors import InvalidError, IoError, Problem

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray


def numpy() -> Any:
    """NumPy, which the command does without."""
    try:
        import numpy as np
    except ImportError as error:
        raise ImportError("arrays need NumPy: pip install numpy (the command `mmxrt` runs without)") from error
    return np


class Product:
    """What a camera sees: a cube with its backplanes and a report.

    Arrays of a folder are read when they are asked for, and mapped, not copied.
    """

    def __init__(
        self,
        report: dict[str, Any],
        load: Callable[[str], NDArray[Any] | None],
        planes: Callable[[], list[tuple[str, str, NDArray[Any]]]],
        table: Callable[[], dict[str, NDArray[Any]] | None],
        bands: Callable[[], tuple[NDArray[Any], NDArray[Any]]],
        path: Path | None,
    ) -> None:
        self.report = report
        """The report: inputs and their hashes, effects, checks, counts, warnings, statistics."""
        self.path = path
        """The folder; `None` in memory."""
        self._load, self._load_planes, self._load_table, self._load_bands = load, planes, table, bands

    def __repr__(self) -> str:
        image = self.report["image"]
        where = "in memory" if self.path is None else str(self.path)
        return f"<mmxrt.Product {where}: {image['samples']} x {image['lines']} pixels, {image['bands']} bands>"

    @cached_property
    def cube(self) -> NDArray[Any]:
        """[band, line, sample], in `unit`: by default radiance, W m-2 sr-1 um-1, averaged over pixel and band."""
        cube = self._load("cube")
        if cube is None:
            message = "has no cube.img: its cube is in another format; xarray.open_dataset reads cube.nc, xarray.open_zarr cube.zarr"
            raise IoError(f"{self.path}: {message}", [Problem(message, file=str(self.path))])
        return cube

    @cached_property
    def thermal(self) -> NDArray[Any] | None:
        """The part of the cube that is thermal emission, as `cube`; `None` unless `split` was asked for."""
        return self._load("thermal")

    @cached_property
    def dn(self) -> NDArray[Any] | None:
        """The whole numbers that a detector sends, [band, line, sample]; `None` of a sensor without one."""
        return self._load("dn")

    @cached_property
    def table(self) -> dict[str, NDArray[Any]] | None:
        """The facet table, as `Scene.solve` gives it with or without a file; `None` unless `table` was asked for."""
        return self._load_table()

    @property
    def unit(self) -> str:
        """Of the cube's numbers."""
        return str(self.report["image"]["unit"])

    @property
    def quantity(self) -> str:
        """What the cube's numbers are, as "radiance"."""
        return str(self.report["image"]["quantity"])

    @cached_property
    def wavelength_um(self) -> NDArray[Any]:
        """Centre of each band, um, [band]."""
        return self._load_bands()[0]

    @cached_property
    def fwhm_um(self) -> NDArray[Any]:
        """Width of each band, um, [band]; NaN of one without."""
        return self._load_bands()[1]

    @cached_property
    def _planes(self) -> list[tuple[str, str, NDArray[Any]]]:
        return self._load_planes()

    @property
    def backplanes(self) -> dict[str, NDArray[Any]]:
        """Images of geometry by their names, [line, sample]; NaN where there is no surface. `units` has their units."""
        return {name: values for name, _, values in self._planes}

    @property
    def units(self) -> dict[str, str]:
        """Units of backplanes by their names."""
        return {name: unit for name, unit, _ in self._planes}

    @property
    def warnings(self) -> list[str]:
        """What a reader of the product should know."""
        return list(self.report["warnings"])

    def to_xarray(self) -> xarray.Dataset:
        """All of it as one dataset: the cube under the name of its quantity, backplanes, and `wavelength`, `fwhm` (um) along `band`.

        Raises `ImportError` without xarray.
        """
        import xarray as xr

        dims, plane = ("band", "line", "sample"), ("line", "sample")
        attributes = {"units": self.unit, "long_name": self.quantity.replace("_", " ")}
        variables: dict[str, Any] = {self.quantity: (dims, self.cube, attributes)}
        if self.thermal is not None:
            variables["thermal"] = (dims, self.thermal, {**attributes, "long_name": "thermal part"})
        if self.dn is not None:
            variables["dn"] = (dims, self.dn, {"units": "1", "long_name": "numbers that are sent"})
        # Names without spaces, as in NetCDF.
        variables |= {name.replace(" ", "_"): (plane, v, {"units": unit}) for name, unit, v in self._planes}
        coordinates = {
            "wavelength": ("band", self.wavelength_um, {"units": "um", "long_name": "centre of the band"}),
            "fwhm": ("band", self.fwhm_um, {"units": "um", "long_name": "width of the band"}),
        }
        told = {"source": f"mmxrt {self.report['mmxrt']}", "scene": self.report["scene"]}
        return xr.Dataset(variables, coordinates, {**told, "report": json.dumps(self.report)})

    @property
    def dataset(self) -> xarray.Dataset:
        """The same as `to_xarray()`."""
        return self.to_xarray()


def held(made: dict[str, Any]) -> Product:
    """A product in memory, of what the native half gives: flat arrays get their shape, which copies nothing."""
    shape = made["shape"]
    cubes: dict[str, NDArray[Any]] = {name: made[name].reshape(shape) for name in ("cube", "thermal", "dn") if name in made}
    planes = [(name, unit, values.reshape(shape[1:])) for name, unit, values in made["planes"]]
    bands = made["wavelength_um"], made["fwhm_um"]
    return Product(json.loads(made["report"]), cubes.get, lambda: planes, lambda: made.get("table"), lambda: bands, None)


def open(path: str | os.PathLike[str]) -> Product:
    """Opens a product's folder, as `simulate` and `integrate` write it. Arrays are read when they are asked for.

    Raises `IoError` if there is none.
    """
    folder = Path(path)
    try:
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    except OSError as error:
        message = f"is no product: {error.strerror}"
        raise IoError(f"{folder}: {message}", [Problem(message, file=str(folder / "report.json"))]) from error
    except ValueError as error:
        message = f"report.json cannot be read: {error}"
        raise InvalidError(f"{folder}: {message}", [Problem(message, file=str(folder / "report.json"))]) from error

    def load(name: str) -> NDArray[Any] | None:
        image = folder / f"{name}.img"
        return _envi(image)[0] if image.exists() else None

    def planes() -> list[tuple[str, str, NDArray[Any]]]:
        images, _ = _envi(folder / "backplanes.img")
        # As the report has them, after bands of the cube: in a header units are part of names, and commas in names are blanks.
        told = report["statistics"][-len(images) :]
        return [(of["name"], of["unit"], image) for of, image in zip(told, images, strict=True)]

    def table() -> dict[str, NDArray[Any]] | None:
        file = folder / "table.npz"
        return table_of(file) if file.exists() else None

    def bands() -> tuple[NDArray[Any], NDArray[Any]]:
        header = _header(folder / "cube.hdr")
        np = numpy()
        centres, widths = (np.array(_listed(header.get(key, "")), dtype=float) for key in ("wavelength", "fwhm"))
        # A band without a width has 0 there; if none has one, nothing is said of widths.
        widths = np.where(widths > 0.0, widths, np.nan) if len(widths) else np.full(len(centres), np.nan)
        return centres, widths

    return Product(report, load, planes, table, bands, folder)


def table_of(path: str | os.PathLike[str]) -> dict[str, NDArray[Any]]:
    """All arrays of a facet table in a file, and what it has in memory besides: shares, which follow from polygons."""
    with numpy().load(path) as arrays:
        return {name: arrays[name] for name in arrays.files} | _native.read_table(path)


_TYPES = {"4": "<f4", "5": "<f8", "12": "<u2", "13": "<u4"}
"""Types of numbers that products have, by their numbers in ENVI."""
_ORDERS = {"bsq": ("band line sample", (0, 1, 2)), "bil": ("line band sample", (1, 0, 2)), "bip": ("line sample band", (2, 0, 1))}
"""Axes of a file, and how they become band, line, sample."""


def _envi(image: Path) -> tuple[NDArray[Any], dict[str, str]]:
    """An image of a product, mapped as [band, line, sample], and its header."""
    header = _header(image.with_suffix(".hdr"))
    sizes = {"band": int(header["bands"]), "line": int(header["lines"]), "sample": int(header["samples"])}
    axes, turned = _ORDERS[header["interleave"].lower()]
    shape = tuple(sizes[axis] for axis in axes.split())
    mapped = numpy().memmap(image, _TYPES[header["data type"]], "r", shape=shape)
    return mapped.transpose(turned), header


def _header(path: Path) -> dict[str, str]:
    """The keys of an ENVI header; of lists what is between braces."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        message = f"reading: {error.strerror}"
        raise IoError(f"{path}: {message}", [Problem(message, file=str(path))]) from error
    keys: dict[str, str] = {}
    lines = iter(text.splitlines())
    for line in lines:
        key, equals, value = line.partition("=")
        if not equals:
            continue
        value = value.strip()
        if value.startswith("{"):
            while "}" not in value:
                value += " " + next(lines, "}").strip()
            value = value[1 : value.rindex("}")]
        keys[key.strip().lower()] = value.strip()
    return keys


def _listed(text: str) -> list[str]:
    return [part.strip() for part in text.split(",")] if text.strip() else []
