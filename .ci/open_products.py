"""Opens a product with another program's library and compares what it says: open_products.py numpy|spectral|OpenEXR|xarray|zarr|astropy|pds4_tools FOLDER.

The same with the cube that was converted: `converted.npy`, `converted.bip`, `converted.exr`, .. beside it. Each number is compared with the bytes of the ENVI cube, read here without any library.
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
elif reader == "xarray":
    import xarray

    def numbers(file):
        with xarray.open_dataset(folder / file, engine="netcdf4") as data:
            assert data.radiance.dims == ("band", "line", "sample") and data.radiance.units == "W m-2 sr-1 um-1"
            assert data.wavelength.values[0] == report["image"]["first_band_um"] and data.wavelength.units == "um"
            return [data.radiance[band, line, sample].item() for line, sample, band in places]

    found, converted = numbers("cube.nc"), numbers("converted.nc")
    with xarray.open_dataset(folder / "cube.nc", engine="netcdf4") as data:
        assert json.loads(data.report.item()) == report
        assert data.LATITUDE.units == "degrees_north" and "LATITUDE" in data.radiance.coords and 0.5 < data.COVERAGE.mean() <= 1
elif reader == "zarr":
    import zarr

    def numbers(file):
        group = zarr.open_group(folder / file, mode="r")
        assert group["radiance"].metadata.dimension_names == ("band", "line", "sample")
        return [group["radiance"][band, line, sample].item() for line, sample, band in places]

    found, converted = numbers("cube.zarr"), numbers("converted.zarr")
    assert zarr.open_group(folder / "cube.zarr", mode="r").attrs["report"] == report
elif reader == "astropy":
    from astropy.io import fits

    def numbers(file):
        with fits.open(folder / file) as units:
            units.verify("exception")
            assert units[0].header["BUNIT"] == "W m-2 sr-1 um-1"
            assert units["WAVELENGTH"].data[0] == report["image"]["first_band_um"]
            return [units["RADIANCE"].data[band, line, sample].item() for line, sample, band in places]

    found, converted = numbers("cube.fits"), numbers("converted.fits")
    with fits.open(folder / "cube.fits") as units:
        assert json.loads(units["REPORT"].data["REPORT"][0]) == report and 0.5 < units["COVERAGE"].data.mean() <= 1
elif reader == "pds4_tools":
    import pds4_tools

    cube = pds4_tools.read(str(folder / "cube.xml"), quiet=True)[0]
    assert cube.type == "Array_3D_Spectrum" and cube.data.shape == (bands, lines, samples)
    assert cube.meta_data["Element_Array"]["unit"] == "W m-2 sr-1 um-1"
    found = converted = [cube.data[band, line, sample].item() for line, sample, band in places]
else:
    sys.exit(f"no check for {reader}")

assert found == expected, (found, expected)
assert converted == expected, (converted, expected)
print(f"{reader}: {len(found)} numbers of the cube are the same")
