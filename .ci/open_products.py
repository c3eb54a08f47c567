"""Opens a product with another program's library and compares what it says: open_products.py numpy|spectral|OpenEXR FOLDER.

The same with the cube that was converted: `converted.npy`, `converted.bip`, `converted.exr` beside it. Each number is compared with the bytes of the ENVI cube, read here without any library.
"""

import importlib.metadata
import json
import pathlib
import struct
import sys

reader, folder = sys.argv[1], pathlib.Path(sys.argv[2])
print(reader, importlib.metadata.version(reader))
report = json.loads((folder / "report.json").read_text())
samples, lines, bands = (report["image"][key] for key in ("samples", "lines", "bands"))


def radiance(line, sample, band):
    """A number of the cube: f32, little-endian, band by band."""
    with open(folder / "cube.img", "rb") as file:
        file.seek(4 * ((band * lines + line) * samples + sample))
        return struct.unpack("<f", file.read(4))[0]


places = [(0, 0, 0), (lines // 2, samples // 3, bands // 2), (lines - 1, samples - 1, bands - 1), (1, 2, 3)]
expected = [radiance(*place) for place in places]
assert len(set(expected)) == len(expected), "places that all hold the same number would prove nothing"

if reader == "numpy":
    import numpy as np

    cube = np.memmap(folder / "cube.img", "<f4", "r", shape=(bands, lines, samples))
    found = [cube[band, line, sample] for line, sample, band in places]
    array = np.load(folder / "converted.npy", mmap_mode="r")
    assert array.shape == (lines, samples, bands) and array.dtype == np.dtype("<f4")
    converted = [array[place] for place in places]
    with np.load(folder / "table.npz") as table:
        header = json.loads(str(table["header"]))
        assert header["format"] == "mmxrt facet table" and set(header["fields"]) <= set(table.files)
        assert len(table["sun_irradiance"]) == report["counts"]["facets"]
        assert np.count_nonzero(table["sun_lit"] == 1) == report["counts"]["lit_facets"]
        assert table["sun_polygon_uv"].shape == (table["sun_polygon_start"][-1], 2)
    with np.load(folder / "footprints.npz") as footprints:
        assert len(footprints["row_start"]) == samples * lines + 1
        pixel = np.repeat(np.arange(samples * lines), np.diff(footprints["row_start"].astype(np.int64)))
        coverage = np.bincount(pixel, footprints["fraction"], samples * lines)
        plane = np.fromfile(folder / "backplanes.img", "<f8", samples * lines)
        assert np.abs(coverage - plane).max() < 1e-12 and coverage.max() > 0.9
elif reader == "spectral":
    import spectral

    cube = spectral.open_image(str(folder / "cube.hdr"))
    assert cube.shape == (lines, samples, bands) and cube.bands.band_unit == "Micrometers"
    assert cube.bands.centers[0] == report["image"]["first_band_um"]
    found = [cube[line, sample, band].item() for line, sample, band in places]
    image = spectral.open_image(str(folder / "converted.hdr"))
    assert image.interleave == spectral.BIP and image.bands.centers == cube.bands.centers
    converted = [image[place].item() for place in places]
    planes = spectral.open_image(str(folder / "backplanes.hdr"))
    assert planes.metadata["band names"][0] == "COVERAGE" and 0.5 < planes.read_band(0).mean() <= 1.0
elif reader == "OpenEXR":
    import OpenEXR


    def numbers(file):
        channels = OpenEXR.File(str(folder / file), separate_channels=True).channels()
        names = sorted(channels)
        assert len(names) == bands
        return [channels[names[band]].pixels[line, sample] for line, sample, band in places]

    found, converted = numbers("cube.exr"), numbers("converted.exr")
else:
    sys.exit(f"no check for {reader}")

assert found == expected, (found, expected)
assert converted == expected, (converted, expected)
print(f"{reader}: {len(found)} numbers of the cube are the same")
