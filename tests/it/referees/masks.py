"""GeoTIFFs by GDAL (rasterio) that say beside their numbers where there are none, or whose lines are not from the West to the East and from the
North to the South, for the tests: python masks.py FOLDER

The heights are those of `rasters.py`, in quarters of a metre; where there are none, 0 is stored.
"""

import os
import sys

import numpy as np
import rasterio
from rasterio.transform import Affine

ROWS, COLUMNS = 16, 24
row, column = np.mgrid[:ROWS, :COLUMNS]
from_centre = (row - 8) ** 2 + (column - 12) ** 2
quarters = 3 * column - 2 * row + np.where(from_centre < 36, 4 * (from_centre - 36), 0) + row * column % 5
has_none = (row == 2) & (column >= 5) & (column < 8)
shown = np.where(has_none, 0, quarters)

os.chdir(sys.argv[1])
SPHERE = "+proj=eqc +R=11100 +units=m +no_defs"
NORTH_UP = Affine(50, 0, 1000, 0, -50, 2000)


def write(name, kind, bands, transform=NORTH_UP, mask=None, inside=True, **more):
    options = dict(driver="GTiff", width=COLUMNS, height=ROWS, count=len(bands), dtype=kind, crs=SPHERE, transform=transform)
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=inside), rasterio.open(name, "w", **options, **more) as file:
        for i, band in enumerate(bands):
            file.write(band.astype(kind), i + 1)
        if mask is not None:
            file.write_mask(mask)


write("mask_within.tif", "int16", [shown], mask=~has_none, compress="lzw")
write("mask_beside.tif", "int16", [shown], mask=~has_none, inside=False, compress="lzw")
alpha = np.where(has_none, 0, 65535)
write("alpha.tif", "uint16", [np.where(has_none, 0, quarters + 1000), alpha], compress="lzw", photometric="minisblack")
with rasterio.open("alpha.tif", "r+") as file:
    file.colorinterp = [rasterio.enums.ColorInterp.gray, rasterio.enums.ColorInterp.alpha]
south_up = Affine(50, 0, 1000, 0, 50, 2000 - 50 * ROWS)
write("south_up.tif", "int16", [quarters[::-1]], transform=south_up, compress="lzw")
mirrored = Affine(-50, 0, 1000 + 50 * COLUMNS, 0, -50, 2000)
write("mirrored.tif", "int16", [quarters[:, ::-1]], transform=mirrored, mask=~has_none[:, ::-1], compress="lzw")
write("turned.tif", "int16", [quarters], transform=NORTH_UP @ Affine.rotation(30), compress="lzw")
