"""Cubes of mmxrt (ENVI, with a header beside the numbers) as arrays. NumPy, no `bpy`."""

import os
import re

import numpy as np

TYPES = {1: "u1", 2: "i2", 3: "i4", 4: "f4", 5: "f8", 12: "u2", 13: "u4", 14: "i8", 15: "u8"}


def header(path):
    """The keys of a header, as text, in small letters; values in braces without them."""
    with open(path, encoding="utf-8", errors="replace") as file:
        text = file.read()
    if not text.startswith("ENVI"):
        raise ValueError(f"{path} is not a header of ENVI: its first line is ENVI")
    keys = {}
    for found in re.finditer(r"^\s*([^=\n{}]+?)\s*=\s*(\{[^}]*\}|[^\n]*)", text, re.MULTILINE):
        keys[found.group(1).lower()] = found.group(2).strip().strip("{}").strip()
    return keys


def pair(path):
    """The header and the file of numbers of either."""
    stem, ending = os.path.splitext(path)
    if ending.lower() == ".hdr":
        candidates = [stem] + [stem + e for e in (".img", ".bsq", ".bil", ".bip", ".dat")]
        numbers = next((c for c in candidates if os.path.isfile(c)), None)
        if numbers is None:
            raise FileNotFoundError(f"{path}: its numbers (.img, .bsq, .bil, .bip, .dat) are not beside it")
        return path, numbers
    for candidate in (stem + ".hdr", path + ".hdr"):
        if os.path.isfile(candidate):
            return candidate, path
    raise FileNotFoundError(f"{path}: its header (.hdr) is not beside it")


class Cube:
    """A cube on the disk: `bands` [band, line, sample], read as they are asked for; wavelengths in um, or None; names of bands; the unit."""

    def __init__(self, path):
        header_path, numbers = pair(path)
        keys = header(header_path)
        try:
            samples, lines, bands, code = (int(keys[k]) for k in ("samples", "lines", "bands", "data type"))
        except KeyError as missing:
            raise ValueError(f"{header_path}: the key {missing} is missing") from None
        if code not in TYPES:
            raise ValueError(f"{header_path}: data type {code} is not read")
        dtype = np.dtype(TYPES[code]).newbyteorder(">" if keys.get("byte order", "0") == "1" else "<")
        shapes = {
            "bsq": ((bands, lines, samples), (0, 1, 2)),
            "bil": ((lines, bands, samples), (1, 0, 2)),
            "bip": ((lines, samples, bands), (2, 0, 1)),
        }
        interleave = keys.get("interleave", "bsq").lower()
        if interleave not in shapes:
            raise ValueError(f"{header_path}: interleave {interleave} is not read")
        shape, axes = shapes[interleave]
        offset = int(keys.get("header offset", "0"))
        expected = offset + int(np.prod(shape)) * dtype.itemsize
        if os.path.getsize(numbers) != expected:
            raise ValueError(f"{numbers} has {os.path.getsize(numbers)} bytes, and its header says {expected}")
        self.bands = np.memmap(numbers, dtype, "r", offset, shape).transpose(axes)
        self.names = [name.strip() for name in keys.get("band names", "").split(",") if name.strip()]
        per_um = 1000.0 if keys.get("wavelength units", "").lower() == "nanometers" else 1.0
        given = [float(x) for x in keys.get("wavelength", "").replace("\n", " ").split(",") if x.strip()]
        self.wavelength_um = [x / per_um for x in given] if len(given) == bands else None
        self.unit = keys.get("data units", "")

    def image(self, chosen):
        """Bands (numbers from 0; one, or three for red, green and blue) as Blender has images: [line from below, sample, RGBA], f32.

        Pixels without a number are transparent, as sky is in Blender with a transparent film.
        """
        chosen = [chosen] * 3 if isinstance(chosen, int) else list(chosen)
        if len(chosen) != 3 or not all(0 <= band < len(self.bands) for band in chosen):
            raise ValueError(f"one band or three, from 1 to {len(self.bands)}")
        colours = np.stack([np.asarray(self.bands[band], np.float32) for band in chosen], axis=-1)[::-1]
        known = np.isfinite(colours).all(axis=-1, keepdims=True)
        return np.concatenate([np.where(known, colours, 0.0), known], axis=-1).astype(np.float32)
