"""What a space camera sees of a small body: exact facet-to-pixel hyperspectral image simulation.

A `Scene` is loaded from a file or made of a dictionary, changed item by item, and simulated::

    import mmxrt
    scene = mmxrt.Scene.load("scene.toml")
    scene["sensor"]["samples"] = 64
    product = scene.simulate()
    product.cube.shape            # (band, line, sample)
    product.to_xarray()

All that goes wrong is a `mmxrt.Error`, whose `problems` say where and what to do.
"""

from ._convert import convert
from ._errors import (
    Error,
    InternalError,
    InvalidError,
    IoError,
    Problem,
    StoppedError,
    TextError,
    UnsupportedError,
)
from ._native import version as __version__
from ._product import Product, open
from ._scene import Item, Scene, integrate

__all__ = [
    "Error",
    "InternalError",
    "InvalidError",
    "IoError",
    "Item",
    "Problem",
    "Product",
    "Scene",
    "StoppedError",
    "TextError",
    "UnsupportedError",
    "__version__",
    "convert",
    "integrate",
    "open",
]
