"""Writes the files of this folder by other programs: make.py FOLDER (pip install numpy netCDF4 scipy astropy zarr; made with netCDF4 1.7, SciPy 1.17, astropy 7, zarr 3.1).

What they hold is reckoned again in tests/it/containers.rs: number (band, row, column) is 100 band + 10 row + column, in units of 0.5 where it is packed.
"""

import pathlib
import sys

import astropy.io.fits as fits
import netCDF4
import numpy as np
import scipy.io
import zarr

folder = pathlib.Path(sys.argv[1])
bands, rows, columns = 4, 5, 7
band, row, column = np.meshgrid(np.arange(bands), np.arange(rows), np.arange(columns), indexing="ij")
numbers = 100 * band + 10 * row + column

# NetCDF-4: packed, compressed in chunks, with a fill value, and an array of two axes beside it.
with netCDF4.Dataset(folder / "packed.nc", "w") as file:
    for name, length in [("wavelength", bands), ("y", rows), ("x", columns)]:
        file.createDimension(name, length)
    wavelength = file.createVariable("wavelength", "f4", ("wavelength",))
    wavelength.units = "nm"
    wavelength[:] = [1000, 1100, 1200, 1300]
    packed = file.createVariable("rad", "i2", ("wavelength", "y", "x"), zlib=True, chunksizes=(2, 3, 4), fill_value=-1)
    packed.units = "W m-2 sr-1 um-1"
    packed.scale_factor = 0.5
    packed.add_offset = 0.0
    packed.set_auto_maskandscale(False)
    stored = numbers.astype("i2")
    stored[2, 1, 3] = -1
    packed[:] = stored
    file.createVariable("angle", "f8", ("y", "x"))[:] = 1.0

# NetCDF-4: bands in the last axis, wavelengths in a group, as EMIT has them.
with netCDF4.Dataset(folder / "groups.nc", "w") as file:
    for name, length in [("downtrack", rows), ("crosstrack", columns), ("bands", bands)]:
        file.createDimension(name, length)
    file.createVariable("radiance", "f4", ("downtrack", "crosstrack", "bands"))[:] = np.moveaxis(numbers, 0, -1)
    group = file.createGroup("sensor_band_parameters")
    for name, values in [("wavelengths", [0.9, 1.0, 1.1, 1.2]), ("fwhm", [0.01, 0.01, 0.02, 0.02])]:
        variable = group.createVariable(name, "f4", ("bands",))
        variable.units = "um"
        variable[:] = values

# NetCDF-3: two maps of heights from the South to the North, along an axis of records.
with scipy.io.netcdf_file(folder / "classic.nc", "w") as file:
    file.createDimension("lat", None)
    file.createDimension("lon", columns)
    for name, axis, unit, values in [
        ("lat", "lat", "degrees_north", np.linspace(-2, 2, rows)),
        ("lon", "lon", "degrees_east", np.linspace(10, 16, columns)),
    ]:
        variable = file.createVariable(name, "f8", (axis,))
        variable.units = unit
        variable[:] = values
    for name in ["height", "other"]:
        variable = file.createVariable(name, "f4", ("lat", "lon"))
        variable.units = "m"
        variable[:] = numbers[1 if name == "height" else 2]

# FITS: whole numbers without a sign, a linear axis of wavelengths, another image beside it.
header = fits.Header()
header["CTYPE3"], header["CUNIT3"], header["CRPIX3"], header["CRVAL3"], header["CDELT3"] = "WAVE", "nm", 1, 1000, 100
header["BUNIT"] = "DN"
units = [fits.PrimaryHDU(numbers.astype("u2"), header), fits.ImageHDU(np.ones((rows, columns)), name="MASK")]
fits.HDUList(units).writeto(folder / "cube.fits", overwrite=True)
# Images in extensions alone, one of them scaled.
scaled = fits.ImageHDU(numbers[1].astype("i2"), name="SCALED")
scaled.header["BSCALE"], scaled.header["BZERO"] = 0.5, 3.0
units = [fits.PrimaryHDU(), fits.ImageHDU(numbers[0].astype("f8"), name="REAL"), scaled]
fits.HDUList(units).writeto(folder / "extensions.fits", overwrite=True, output_verify="ignore")
fits.HDUList([fits.PrimaryHDU(), fits.CompImageHDU(numbers[0].astype("i4"))]).writeto(folder / "compressed.fits", overwrite=True)

# Zarr: chunks that do not fit, by gzip and with a checksum; and shards of which one is not there.
group = zarr.open_group(folder / "chunks.zarr", mode="w", zarr_format=3)
array = group.create_array(
    "rad", shape=numbers.shape, dtype=">i4", chunks=(3, 2, 4), fill_value=7, dimension_names=("wl", "y", "x"),
    compressors=[zarr.codecs.GzipCodec(), zarr.codecs.Crc32cCodec()],
)
array[:] = numbers
array.attrs["units"] = "DN"
wavelength = group.create_array("wl", shape=(bands,), dtype="f8", chunks=(bands,), compressors=None, dimension_names=("wl",))
wavelength[:] = [1.0, 1.1, 1.2, 1.3]
wavelength.attrs["units"] = "um"
array = zarr.create_array(
    folder / "shards.zarr", shape=numbers.shape, dtype="f4", shards=(2, 4, 8), chunks=(1, 2, 4), compressors=None,
    fill_value=-5, zarr_format=3, overwrite=True,
)
array[:2] = numbers[:2]
array = zarr.create_array(folder / "zstd.zarr", shape=(rows, columns), dtype="f4", zarr_format=3, overwrite=True)
array[:] = numbers[0]
