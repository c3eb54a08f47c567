"""Rasters by other programs, for the tests: python rasters.py FOLDER

A made-up piece of Phobos of 24 columns and 16 rows, a bowl in a slope, whose height in quarters of a metre is `quarters` below; three pixels have
no data. Written by GDAL (`gdal_translate`), except that the file of PDS3, which GDAL does not write, is by planetaryimage (with numpy < 2.3 and pvl < 1).
"""

import collections.abc
import os
import subprocess
import sys
import tempfile

import numpy as np

for name in ("Mapping", "MutableMapping", "MutableSequence", "Sequence"):
    # pvl is older than their removal from there
    setattr(collections, name, getattr(collections.abc, name))
from planetaryimage import PDS3Image

ROWS, COLUMNS, NO_DATA = 16, 24, -9999
row, column = np.mgrid[:ROWS, :COLUMNS]
from_centre = (row - 8) ** 2 + (column - 12) ** 2
quarters = 3 * column - 2 * row + np.where(from_centre < 36, 4 * (from_centre - 36), 0) + row * column % 5
has_none = (row == 2) & (column >= 5) & (column < 8)

folder = os.path.abspath(sys.argv[1])
scratch = tempfile.mkdtemp()
SPHERE = "+proj=eqc +R=11100 +units=m +no_defs"
# Pixels of 50 m x 50 m, from 1000 m to the East and 2000 m to the North.
PLACE = ["-a_srs", SPHERE, "-a_ullr", "1000", "2000", str(1000 + 50 * COLUMNS), str(2000 - 50 * ROWS)]
TYPES = {"u1": 1, "i2": 2, "i4": 3, "f4": 4, "f8": 5, "u2": 12, "u4": 13}


def raw(name, kind, bands):
    """An ENVI image, which GDAL reads."""
    path = os.path.join(scratch, name)
    np.asarray(bands).astype("<" + kind).tofile(path)
    with open(path + ".hdr", "w") as file:
        file.write(
            f"ENVI\nsamples = {COLUMNS}\nlines = {ROWS}\nbands = {len(bands)}\nheader offset = 0\nfile type = ENVI Standard\n"
            f"data type = {TYPES[kind]}\ninterleave = bsq\nbyte order = 0\n"
        )
    return path


def translate(source, name, driver, *options):
    command = ["gdal_translate", "-q", "-of", driver, *options, source, os.path.join(folder, name)]
    subprocess.run(command, check=True, env={**os.environ, "GDAL_PAM_ENABLED": "NO"})


def creation(*options):
    return [word for option in options for word in ("-co", option)]


metres = raw("metres", "f4", [np.where(has_none, NO_DATA, quarters / 4)])
counts = raw("counts", "i2", [np.where(has_none, NO_DATA, quarters)])
none = ["-a_nodata", str(NO_DATA)]
scaled = ["-a_scale", "0.25", "-a_offset", "0"]
# From 1 on, so that 0 can stand for no data.
positive = [np.where(has_none, 0, quarters + 1000)]

tiled = creation("TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16")
translate(metres, "tiles.tif", "GTiff", *PLACE, *none, *tiled, *creation("COMPRESS=DEFLATE", "PREDICTOR=3"))
translate(counts, "strips.tif", "GTiff", *PLACE, *none, *scaled, *creation("COMPRESS=LZW", "PREDICTOR=2", "ENDIANNESS=BIG", "BLOCKYSIZE=5"))
bytes_ = raw("bytes", "u1", [(quarters + 200) // 2, row * 10, column * 9])
translate(bytes_, "planes.tif", "GTiff", *creation("INTERLEAVE=BAND", "COMPRESS=PACKBITS", "PHOTOMETRIC=RGB"))
three = raw("three", "u4", [quarters + 1000, row * 100000, column * 90000])
translate(three, "pixels.tif", "GTiff", *PLACE, *creation("INTERLEAVE=PIXEL", "BIGTIFF=YES", "COMPRESS=DEFLATE", "PREDICTOR=2"))
doubles = raw("doubles", "f8", [quarters / 3])
translate(doubles, "doubles.tif", "GTiff", *PLACE, "-mo", "AREA_OR_POINT=Point", *creation("COMPRESS=LZW", "PREDICTOR=3"))
degrees = ["-a_srs", "+proj=longlat +R=11100 +no_defs", "-a_ullr", "10", "5", "12.4", "3.4"]
translate(raw("words", "u2", positive), "degrees.tif", "GTiff", *degrees, "-a_nodata", "0")
empty = np.where((row < 8) & (column < 8), quarters, NO_DATA)
sparse = raw("sparse", "i4", [empty])
translate(sparse, "sparse.tif", "GTiff", *none, *tiled, *creation("SPARSE_OK=TRUE"))

translate(counts, "square.asc", "AAIGrid", *PLACE, *none)
wide = ["-a_ullr", "1000", "2000", str(1000 + 50 * COLUMNS), str(2000 - 25 * ROWS)]
translate(metres, "wide.asc", "AAIGrid", *wide, *none, *creation("DECIMAL_PRECISION=2"))

translate(raw("pgm", "u2", positive), "grey.pgm", "PNM")
translate(bytes_, "colours.ppm", "PNM")
translate(raw("png", "u2", positive), "grey16.png", "PNG")

phobos = ["VAR_TARGET=Phobos", "VAR_TARGET_TYPE=Satellite", "VAR_LOGICAL_IDENTIFIER=urn:x:y", "VAR_TITLE=made_up"]
translate(counts, "pds4.xml", "PDS4", *PLACE, *none, *scaled, *creation("UNIT=m", *phobos))
translate(three, "interleaved.xml", "PDS4", *creation("INTERLEAVE=BIL", *phobos))

beside = creation("DATA_LOCATION=EXTERNAL", "TARGET_NAME=Phobos")
translate(metres, "bands.lbl", "ISIS3", *PLACE, *none, *beside)
translate(counts, "tiled.lbl", "ISIS3", *PLACE, *none, *scaled, *beside, *tiled)
for name in os.listdir(folder):
    if name.endswith(".History.IsisCube"):
        os.remove(os.path.join(folder, name))

PDS3Image(np.where(has_none, NO_DATA, quarters).astype(">i2")).save(os.path.join(folder, "pds3.img"))
