#!/usr/bin/env python3
"""Makes the corpora that fuzzing starts from: seeds.py MMXRT, where MMXRT is the program to convert with."""

import io
import pathlib
import random
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import zipfile

FUZZ = pathlib.Path(__file__).resolve().parent
DATA = FUZZ.parent / "tests" / "data"
MALFORMED = DATA / "malformed"
# What parts the pieces of an input: fuzz_targets/files.rs.
MARK = b"\0\xff"


def add(target, name, data):
    folder = FUZZ / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data)


def pieces(pairs):
    return MARK.join(bytes([which]) + data for which, data in pairs)


def files(folder):
    """Files of a folder in the order in which fuzz_targets/files.rs counts them."""
    found = [p for p in folder.rglob("*") if p.is_file()]
    return sorted(found, key=lambda p: p.relative_to(folder).parts)


def folder_seeds(target, folder, prefix):
    """Each file by itself, and pairs of them."""
    found = files(folder)
    for i, path in enumerate(found):
        if path.stat().st_size < 10_000:
            add(target, f"{folder.name}_{i}", prefix + pieces([(i, path.read_bytes())]))
    small = [(i, p.read_bytes()) for i, p in enumerate(found) if p.stat().st_size < 5_000]
    for k in range(0, len(small) - 1, 2):
        add(target, f"{folder.name}_pair_{k}", prefix + pieces(small[k : k + 2]))
    return [p.relative_to(folder) for p in found]


def xml():
    for path in [*DATA.glob("dart/**/*.xml"), *MALFORMED.glob("**/*.xml")]:
        add("xml", "_".join(path.relative_to(DATA).parts), path.read_bytes())
    add("xml", "mixed", b'<?xml version="1.0"?><a x=\'&#x3bc;&lt;\' y="1"><!-- c --><b/>t&amp;<![CDATA[<]]><?p q?></a>')


def ccsds():
    for path in files(DATA / "flight"):
        add("ccsds", path.name, path.read_bytes())
    for name, text in [
        ("table", "# centre = PHOBOS\nutc,a_x_km,a_y_km,a_z_km,b_q1,b_q2,b_q3,b_qc\n2026-07-01T00:00:00,1,2,3,0,0,0,1\n"),
        ("xml", "<ndm><aem version='1.0'><body><segment><metadata><OBJECT_NAME>X</OBJECT_NAME></metadata></segment></body></aem></ndm>"),
    ]:
        add("ccsds", name, text.encode())


def dart_simulation(ours):
    theirs = DATA / "dart" / "boulder_574"
    names = [str(name) for name in folder_seeds("dart_simulation", theirs, b"\0")]
    folder_seeds("dart_simulation", ours, b"\1")
    for path in MALFORMED.glob("dart/*/*"):
        kind = path.parent.name
        name = {"field": "input/pebbles.txt", "sequence": "flyby.xml", "ilwis": f"input/DEM{path.suffix}"}
        which = names.index(name.get(kind, f"input/{kind}.xml"))
        add("dart_simulation", f"{kind}_{path.name}", b"\0" + pieces([(which, path.read_bytes())]))
    for other in ["crater_511", "plain_54"]:
        found = [(names.index(f"input/{p.name}"), p.read_bytes()) for p in (DATA / "dart" / other / "input").glob("*.xml")]
        add("dart_simulation", other, b"\0" + pieces(found))


# Databases in SQL: the kinds of DART's tables, and what a table should not be.
TABLES = {
    "lambertian": "wavelength DOUBLE, reflectance DOUBLE, direct_transmittance DOUBLE, diffuse_transmittance DOUBLE",
    "hapke": "wavelength DOUBLE, w DOUBLE, c1 DOUBLE, c2 DOUBLE, c3 DOUBLE, c4 DOUBLE, h1 DOUBLE, h2 DOUBLE",
    "rpv": "wavelength DOUBLE, reflectance DOUBLE, k DOUBLE, g DOUBLE, h DOUBLE",
}
ODD = [
    "CREATE TABLE t(wavelength, reflectance AS (wavelength * 2) STORED);INSERT INTO t VALUES(1)",
    'CREATE TABLE "a""b c"(Wavelength TEXT, "reflectance"\' BLOB);INSERT INTO "a""b c" VALUES(x\'00ff\', NULL)',
    "CREATE VIEW v AS SELECT 1 AS wavelength;CREATE TRIGGER r AFTER INSERT ON _comments BEGIN SELECT 1; END",
    "CREATE TABLE w(wavelength REAL PRIMARY KEY, reflectance CHECK(reflectance < 2)) WITHOUT ROWID;INSERT INTO w VALUES(1, 1)",
    "CREATE TABLE n(wavelength, reflectance);INSERT INTO n VALUES(1, 9e999);INSERT INTO n VALUES(-1, 'x'),(2, 0.5),(2, 0.5)",
    "CREATE VIRTUAL TABLE f USING fts5(wavelength);CREATE TABLE _COMMENTS(Model);CREATE INDEX i ON f(wavelength)",
    "PRAGMA encoding='UTF-16le';CREATE TABLE u(wavelength, reflectance);INSERT INTO u VALUES(1, 1)",
    "CREATE TABLE a(wavelength, reflectance);PRAGMA writable_schema=1;UPDATE sqlite_master SET rootpage=1;"
    "UPDATE sqlite_master SET sql='CREATE TABLE a(x)'",
]


def database():
    for name, columns in TABLES.items():
        count = columns.count(",") + 1
        rows = [[0.4 + i] + [0.1 * (c + 1) for c in range(count - 1)] for i in range(3)]
        values = ",".join("(" + ",".join(["NULL", *map(repr, row)]) + ")" for row in rows)
        sql = (
            "CREATE TABLE _comments (model, Comments);INSERT INTO _comments VALUES('m', 'said');"
            f"CREATE TABLE m (Id INTEGER PRIMARY KEY AUTOINCREMENT, {columns});INSERT INTO m VALUES{values}"
        )
        add("database", f"{name}.sql", sql.encode())
        with sqlite3.connect(":memory:") as connection:
            connection.execute("PRAGMA page_size = 512")
            connection.executescript(sql)
            add("database", f"{name}.db", connection.serialize())
    for i, sql in enumerate(ODD):
        add("database", f"odd_{i}.sql", sql.encode())


def gltf(convert, scene):
    for ending in ["glb", "gltf"]:
        convert(scene, f"surface.{ending}")
    folder = convert.folder
    add("gltf", "surface.glb", (folder / "surface.glb").read_bytes())
    text, buffer = ((folder / f"surface.{e}").read_bytes() for e in ["gltf", "bin"])
    add("gltf", "surface", text + b"\0" + buffer)
    # Without the blanks between the parts of the text, in which most changes say nothing.
    add("gltf", "beside", text.replace(b"surface.bin", b"fuzz.bin") + b"\0" + buffer)
    triangle = struct.pack("<9f3H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2) + b"\0\0"
    for name, text in {
        "plain": b'{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],'
        b'"translation":[1,2,3]},{"mesh":0,"rotation":[0,0,0,1],"scale":[1,-1,1]}],"meshes":[{"primitives":[{"attributes":'
        b'{"POSITION":0},"indices":1,"mode":4,"material":0}]}],"materials":[{"name":"a","pbrMetallicRoughness":'
        b'{"baseColorFactor":[0.1,0.2,0.3,1]}}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},'
        b'{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":36},'
        b'{"buffer":0,"byteOffset":36,"byteLength":6}],"buffers":[{"byteLength":44}]}',
        "sparse": b'{"asset":{"version":"2.0"},"nodes":[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}],"meshes":'
        b'[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],"accessors":[{"bufferView":0,"componentType":5126,'
        b'"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"byteOffset":2,"componentType":5123},'
        b'"values":{"bufferView":0}}}],"bufferViews":[{"buffer":0,"byteLength":36,"byteStride":12},{"buffer":0,'
        b'"byteOffset":36,"byteLength":6}],"buffers":[{"uri":"fuzz.bin","byteLength":44}]}',
    }.items():
        add("gltf", name, text + b"\0" + triangle)
    for path in (DATA / "gltf").glob("*.gltf"):
        beside = path.with_suffix(".bin")
        text, buffer = path.read_bytes(), beside.read_bytes() if beside.exists() else b""
        add("gltf", path.name, text.replace(beside.name.encode(), b"fuzz.bin") + b"\0" + buffer)
    quantised = struct.pack("<12h", 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0) + struct.pack("<6f", 0, 0, 0, 1, 2, 3)
    add("gltf", "instances", b'{"asset":{"version":"2.0"},"extensionsUsed":["KHR_mesh_quantization","EXT_mesh_gpu_instancing"],"extensionsRequired":'
        b'["KHR_mesh_quantization"],"nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}}],"meshes":'
        b'[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5122,"normalized":true,"count":3,'
        b'"type":"VEC3"},{"bufferView":1,"componentType":5126,"count":2,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":24,'
        b'"byteStride":8},{"buffer":0,"byteOffset":24,"byteLength":24}],"buffers":[{"byteLength":48}]}\0' + quantised)
    add("gltf", "lights", b'{"asset":{"version":"2.0"},"extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional","intensity":3}]}},'
        b'"nodes":[{"extensions":{"KHR_lights_punctual":{"light":0},"KHR_node_visibility":{"visible":false}}}]}')
    add("gltf", "data", b'{"asset":{"version":"2.0"},"buffers":[{"uri":"data:application/octet-stream;base64,AAAA","byteLength":3}]}')


def ilwis():
    header = (DATA / "dart/boulder_574/input/DEM.mpr").read_bytes()
    values = (DATA / "dart/boulder_574/input/DEM.mp#").read_bytes()
    add("ilwis", "dem", header + b"\0" + values)
    add("ilwis", "bounded", header.replace(b"undef", b"0 -6 4 0") + b"\0" + values)
    for path in MALFORMED.glob("dart/ilwis/*.mpr"):
        add("ilwis", path.name, path.read_bytes() + b"\0" + values)


def spectra(convert):
    tables = convert.folder / "spectra.csv"
    tables.write_text("wavelength_um,basalt,olivine:reflectance_percent,olivine:emissivity\n0.4,0.1,20,0.9\n2.5,0.2,30,0.8\n")
    convert(tables, "spectra.sli")
    header, numbers = ((convert.folder / f"spectra.{e}").read_bytes() for e in ["hdr", "sli"])
    add("sli", "library", header + b"\0" + numbers[1:])
    add("sli", "offset", header.replace(b"header offset = 0", b"header offset = 1") + b"\0" + numbers)
    for code, size, extra in [(1, 1, ""), (2, 2, "bbl = {1,0}\n"), (3, 4, "byte order = 1\n"), (4, 4, "wavelength units = nm\n"), (12, 2, "")]:
        for kind in ["ENVI Standard", "ENVI Spectral Library"]:
            text = (
                f"ENVI\nsamples = 2\nlines = 2\nbands = 1\nheader offset = 1\nfile type = {kind}\ndata type = {code}\n"
                f"interleave = bil\n{extra}data ignore value = 7\nreflectance scale factor = 100\nspectra names = {{a, b:emissivity}}\n"
                f"{'wavelength = {1.5, 0.5}' if 'Spectral' in kind else 'band names = {x}'}\n"
            )
            add("sli", f"{kind[5:9]}_{code}".strip(), text.encode() + b"\0" + bytes(range(1, 1 + 4 * size)))
    texts = {
        "table": "# said\nwavelength;reflectance;direct_transmittance;diffuse_transmittance\n0.4;10.5;0;0\n2.5;20;0;0\n",
        "version_5_4": "*comment*\n*lambda - ro - T_direct - T_diffus*\n0.4 10.5 0 0\n2.5 20 0 0\n",
        "many": tables.read_text(),
        "fraction": "# c\nwavelength_nm,reflectance_percent,error\n400,10,1\n2500,12.5,1\n",
        "irradiance": "wavelength_um,irradiance_w_m2_um\n0.4,1700\n2.5,50\n",
        "hapke": (FUZZ / "scene" / "hapke.csv").read_text(),
        "rpv": "wavelength_nm,rho0,k,g,h\n400,0.1,0.8,-0.1,0.1\n2500,0.2,0.8,-0.1,0.1\n",
    }
    for name, text in texts.items():
        add("text_spectra", name, text.encode())


def obj():
    # Pieces of fuzz_targets/containers.rs, in its order.
    for i, name in enumerate(["packed.nc", "groups.nc", "classic.nc", "cube.fits", "extensions.fits", "compressed.fits"]):
        add("containers", name, bytes([i]) + (DATA / "containers" / name).read_bytes())
    # Pieces of fuzz_targets/rasters.rs: what replaces which file, by its number there.
    for i, path in enumerate(sorted((DATA / "rasters").glob("*"))):
        add("rasters", path.name, bytes([i]) + path.read_bytes())
    plate, materials = ((FUZZ / "scene" / f"plate.{e}").read_bytes() for e in ["obj", "mtl"])
    add("obj", "plate", plate + b"\0" + materials)
    for path in DATA.glob("dart/**/*.obj"):
        add("obj", path.name, path.read_bytes())
    add("obj", "forms", b"v 0 0 0 1.0\r\nv 1 0 0 # c\nv 1e0 \\\n1 0\nvt 0 0\ng x\nf 1/1/1 2//1 -1\ng x y\nusemtl a\nf 1 2 3\ncurv 1\n")
    add("obj", "encodings", "\ufeffmtllib a b.mtl \"c d.mtl\"\no \u00e9\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0.5\nvn 0 0 1\nvn 0 1 0\nusemtl \u00e9\n"
        "f 1//1 2//2 3//1\no b\nf 1 2 3\nf 1/".encode() + "\nusemtl \u00e9\nf 1 2 3".encode("latin-1"))
    corners = b"".join(b"v %d %d 0\n" % xy for xy in [(0, 0), (4, 0), (4, 4), (2, 1), (0, 4), (1, 2), (-3, 7)])
    add("obj", "concave", corners + b"f 1 2 3 4 5\nf 1 2 4 3\nf 7 6 5 4 3 2 1\n")


def scene():
    found = files(FUZZ / "scene")
    which = [path.name for path in found].index("scene.toml")
    for i, path in enumerate(found):
        add("scene", path.name, pieces([(i, path.read_bytes())]))
    add("scene", "all", pieces([(i, path.read_bytes()) for i, path in enumerate(found)]))
    for path in FUZZ.parent.glob("scenes/*/scene.toml"):
        add("scene", path.parent.name, pieces([(which, path.read_bytes())]))
    good = (FUZZ / "scene" / "scene.toml").read_text()
    recipe = "version = 1\nseed = 1\nfacets = 1000\nsize_m = 100\n"
    add("scene", "recipe", pieces([(which, recipe.encode())]))
    for i, (old, new) in enumerate([
        ("start_um = 1.0\nstop_um = 2.0\ncount = 3", "centres_um = [1.0, 1.5]\nfwhm_um = [0.1, 0.2]"),
        ("fov_deg = 1.0", 'fit = "scene"'),
        ("target_m = [0, 0, 10000]\nup = [0, 1, 0]", "h = [1, 0, 0]\nv = [0, -1, 0]\nu = [0, 0, -1]"),
        ("target_m = [0, 0, 10000]\nup = [0, 1, 0]", "world_from_sensor_xyzw = [1, 0, 0, 0]"),
        ("direction = [0, 0, 1]\ndistance_au = 1.5", 'position_m = [0, 0, 2.2e11]\nspectrum = "sun.csv"\ntotal_irradiance_w_m2 = 1361'),
        ('hapke = "hapke.csv"', 'rpv = "hapke.csv", extend = "hold", bond_albedo = 0.1'),
        ("start_um = 1.0\nstop_um = 2.0\ncount = 3", 'response = "filter.csv"\ncolumns = ["wide"]\nlight = ["sunlight"]'),
        ("start_um = 1.0\nstop_um = 2.0\ncount = 3", 'centres_um = [1, 1.2]\nfwhm_um = 0.1\nshape = ["box", "table"]\nresponse = ["filter.csv"]'),
        ('{ reflectance = "flat.csv" }', '{ reflectance = "flat.csv", texture = { raster = "grain.csv", quantity = "factor", texels = "bilinear", '
         'placement = "plane", plane = { corner_m = [-1, 1, 0], along_line_m = [1, 0, 0], line_to_line_m = [0, -1, 0] } } }'),
        ('{ reflectance = "flat.csv" }', '{ reflectance = "flat.csv", texture = { raster = "grain.csv", quantity = "factor", placement = "atlas", wrap = "repeat" } }'),
        ('target_m = [0, 0, 10000]\nup = [0, 1, 0]', 'target_m = [1, 2, 3]\nup = [0, 1, 0]\nframe = "site"'),
        ("[observer]\nposition_m = [0, 0, 20000]\ntarget_m = [0, 0, 10000]\nup = [0, 1, 0]", "[geometry]\nemission_deg = 20\nrange_m = 7000\n"
         'observer_azimuth_deg = 270\nframe = "site"\nnormal = [0, 0, 1]\nup = "zenith"'),
        ("direction = [0, 0, 1]\ndistance_au = 1.5", "distance_au = 1.5\n[geometry]\nincidence_deg = 60\nsun_azimuth_deg = 90"),
        ("direction = [0, 0, 1]", 'direction = [0, 0, 1]\nframe = "site"'),
        ("position_m = [0, 0, 20000]\ntarget_m = [0, 0, 10000]\nup = [0, 1, 0]", "camera_to_world = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 9], [0, 0, 0, 1]]\n"
         'convention = "blender"\ncoordinates = "local"'),
        ("fov_deg = 1.0", "focal_mm = 50\nsensor_mm = 36\nshift = [0.1, 0]\nsensor_fit = \"auto\""),
        ("fov_deg = 1.0", "focal_px = [800, 810]\nboresight_px = [3, 2]\nwindow = { samples = 16, lines = 9, sample = 1, line = 2 }"),
        ("samples = 8\nlines = 4\nfov_deg = 1.0\n[sensor.bands]\nstart_um = 1.0\nstop_um = 2.0\ncount = 3", 'preset = "mirs"'),
    ]):
        assert old in good, old
        add("scene", f"other_{i}", pieces([(which, good.replace(old, new).encode())]))


def npy(descr, shape, data):
    text = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    text += b" " * (63 - (10 + len(text)) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + data


def products(mmxrt, folder):
    header = (
        '{"format":"mmxrt facet table","format_version":1,"mmxrt":"0.1.0","scene":"s",'
        '"fields":{"sun_lit":{"unit":"1","meaning":"m"}}}'
    )
    table = [
        (0, npy(f"<U{len(header)}", "()", header.encode("utf-32-le"))),
        (1, npy("<f8", "(3,)", struct.pack("<3d", 0, 0, 1))),
        (2, npy("<f8", "(3,)", struct.pack("<3d", 0.5, 0.25, 0))),
        (3, npy("|u1", "(3,)", bytes([1, 2, 0]))),
        (4, npy("<u4", "(1,)", struct.pack("<I", 1))),
        (5, npy("<u4", "(2,)", struct.pack("<2I", 0, 3))),
        (6, npy("<f8", "(3, 2)", struct.pack("<6d", 0, 0, 1, 0, 0, 1))),
        (7, npy("<f8", "(3,)", struct.pack("<3d", 1, 0, 0))),
        (8, npy("<f8", "(3,)", struct.pack("<3d", 0.1, 0.1, 0.1))),
        (9, npy("<f8", "(3,)", struct.pack("<3d", 200, 200, 200))),
        (10, npy("<f8", "(3,)", struct.pack("<3d", 100, 100, 100))),
    ]
    add("products", "arrays", b"\0" + pieces(table))
    add("products", "arrays_fewer", b"\0" + pieces(table[:7]))
    plain = folder / "plain"
    shutil.copytree(FUZZ / "scene", plain)
    # Hapke's model is converted, not simulated.
    text = (plain / "scene.toml").read_text().replace(', hapke = "hapke.csv"', "")
    (plain / "scene.toml").write_text(text)
    simulated = folder / "simulated"
    subprocess.run([mmxrt, "--quiet", "simulate", plain / "scene.toml", "--exr", "--footprints", "--output", simulated], check=True)
    for path in simulated.iterdir():
        which = {".npz": 1, ".png": 2, ".exr": 3, ".json": 4}.get(path.suffix)
        if which:
            add("products", path.name, bytes([which]) + path.read_bytes())


def flight():
    folder_seeds("flight", FUZZ / "flight", b"")


def maps():
    found = files(FUZZ / "maps")
    chosen = [1 << k for k in range(8)] + [0x0F, 0x3F]
    for k, bits in enumerate(chosen):
        for how in [0x0C, 0x87, 0x2E, 0x70]:
            add("maps", f"good_{k}_{how}", bytes([bits, how]))
    for i, path in enumerate(found):
        for bits in [0x07, 0x08, 0x30, 0xC0]:
            add("maps", f"{path.name}_{i}_{bits}", bytes([bits, 0x0E]) + pieces([(i, path.read_bytes())]))
    which = [path.name for path in found].index
    plane, camera, views = (which(f"{name}.map.toml") for name in ["plane", "camera", "views"])
    good = {i: found[i].read_text() for i in [plane, camera, views]}
    others = [
        (plane, 'sky = "left_out"', 'occlusion = false\nsky = "included"'),
        (plane, "bands =", "channels = []\nbands ="),
        (plane, '"W m-2 sr-1 um-1"', '"uW cm-2 sr-1 nm-1"'),
        (camera, "focal_mm = 50\nsensor_mm = 0.6\nshift = [0.01, 0]", "fov_deg = 0.7\nboresight_px = [2, 2.5]"),
        (camera, 'negative = "clip"', 'negative = "error"\nsky = "included"'),
        (camera, '[observer]', '[observer]\nframe = "site"'),
        (views, '"outline"', '"forced"'),
        (views, 'registration = "outline"', "shift_texels = [0.5, -1]"),
    ]
    for k, (i, old, new) in enumerate(others):
        assert old in good[i], old
        add("maps", f"other_{k}", bytes([0x13, 0x0C]) + pieces([(i, good[i].replace(old, new).encode())]))


RESPONSES = {
    "camera": '# by hand\n"Wavelength (nm)";"Red; wide";Blue\n700;0.5;\n600;1.0;-0.001\n500;0;2\n',
    "twice": "wavelength_um,r,g\n0.5,0,nan\n0.6,1,1\n0.6,1,1\n0.7,0,2\n",
    "tabs": "\ufefflambda [\u00b5m]\tr\n0.5\t0\n0.6\t1\n0.7\t0\n",
    "blank": "wavelength_um,\n1,1\n2,1\n",
}

SPECTRA = {
    "ecostress": "Name: Basalt\nType: Rock\nX Units: Wavelength (micrometers)\nY Units: Reflectance (percentage)\nFirst Column: X\n\n"
    "14.0\t5.1\n2.5\t10.2\n0.4\t8\n",
    "aster": "Name: A\nX Units: Wavelength (nanometers)\nY Units: Reflectance (fraction)\n400, 0.1\n2500, 0.2\n",
    "usgs": " splib07a Record=1: Olivine GDS70 ASDFRa AREF\n 0.5\n -1.23e34\n 0.25\n\0 splib07a Record=2: Wavelengths in microns\n 0.35\n 0.36\n 0.37\n",
    "relab": "300 0.1 0.01\n310 0.11 0.01\n2600 0.12 0.01\n",
    "titled": "Sample: C1MB\nWavelength(micron) Reflectance\n0.3 0.1\n2.6 0.2\n",
    "commented": "# Wavelength (nm)\tReflectance (%)\n500 5\n600 6\n599 7\n",
    "many": "wavelength_um,a,b:reflectance_percent,c\n0.4,0.1,,nan\n1,0.1,20,0.5\n2.5,0.2,30,\n",
    "quoted": '"Wavelength [A]","Irradiance (W m-2 nm-1)",\n"4000","1.5",\n"5000","1.7",\n',
    "decimal": "wavelength_nm;reflectance\n400,5;0,1\n",
    "descending": "lambda,r\n2.5,0.1\n1,0.2\n",
}


def tables():
    for name, text in RESPONSES.items():
        add("responses", name, text.encode())
    add("responses", "scene", (FUZZ / "scene" / "filter.csv").read_bytes())
    for name, text in SPECTRA.items():
        add("spectral_tables", name, text.encode())
    for path in (FUZZ / "scene").glob("*.csv"):
        add("spectral_tables", path.name, path.read_bytes())


def polygons():
    draw = random.Random(1)
    for k in range(40):
        spread = draw.choice([16, 64, 255])
        corners = [draw.randrange(128 - spread // 2, 128 + spread // 2) for _ in range(2 * draw.randrange(6, 20))]
        add("polygons", f"drawn_{k}", bytes([k % 2, 128, *corners]))


IMAGES = {
    "bsq": "ENVI\nsamples = 3\nlines = 2\nbands = 2\ndata type = 4\ninterleave = bsq\nwavelength = {0.5, 0.6}\nband names = {a, b}\n"
    "map info = {Arbitrary, 1, 1, 0, 0, 2, 2, units=Meters}\ndata units = W m-2 sr-1 um-1\n",
    "bip": "ENVI\ndescription = {a } b\n c}\nsamples=3\nlines=2\nbands=2\ndata type=2\nheader offset=1\ninterleave=bip\nbyte order=1\n"
    "data gain values = {1, 2}\ndata ignore value=7\nwavelength units=Wavenumber\nwavelength={9000 8000}\nfwhm={10 10}\nbbl={1,0}\n",
    "names": "ENVI\nsamples = 3\nlines = 2\nbands = 2\ndata type = 12\ninterleave = bil\nband names = {\n L.450 nm, 360.0-380.0nm}\n",
}


def rasters(mmxrt, folder):
    """Images of all formats, made of one by the program, for `raster` and, by other numbers, for `convert`."""
    image = folder / "image"
    image.mkdir()
    numbers = struct.pack("<12f", *[0.1 * i for i in range(11)], float("nan"))
    (image / "a.img").write_bytes(numbers)
    (image / "a.hdr").write_text(IMAGES["bsq"])
    made = {"img": (numbers, IMAGES["bsq"].encode())}
    for ending in ["bip", "npy", "exr", "mpr", "csv"]:
        to = image / f"b.{ending}"
        command = [mmxrt, "--quiet", "convert", image / "a.img", to]
        subprocess.run(command + (["--band", "1"] if ending in ["mpr", "csv"] else []), check=True)
        partner = {"bip": to.with_suffix(".hdr"), "mpr": to.with_suffix(".mp#")}.get(ending)
        made[ending] = (to.read_bytes(), partner.read_bytes() if partner else b"")
    for path in (DATA / "pictures").glob("*.jpg"):
        made[path.stem] = (path.read_bytes(), b"")
    for name, method in [("npz", zipfile.ZIP_STORED), ("packed", zipfile.ZIP_DEFLATED)]:
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", method) as archive:
            archive.writestr("raster.npy", npy("<f4", "(2, 3, 2)", numbers))
            archive.writestr("wavelength_um.npy", npy("<f8", "(2,)", struct.pack("<2d", 0.5, 0.6)))
        made[name] = (packed.getvalue(), b"")
    fortran = npy("<f4", "(2, 6)", numbers).replace(b"False", b"True ")
    made["fortran"] = (fortran, b"")
    for path in folder.glob("simulated/*"):
        if path.suffix in [".png", ".exr"]:
            made[path.name] = (path.read_bytes(), b"")
    about = b'mmxrt_map = 1\nquantity = "radiance"\nunit = "W m-2 sr-1 um-1"\nplacement = "plane"\nplane = { corner_m = [-1, 1, 0], ' \
        b"along_line_m = [1, 0, 0], line_to_line_m = [0, -1, 0] }\nbands = { centres_um = [1.0] }\n"
    for name, (data, partner) in made.items():
        ending = name.split(".")[-1]
        # Names of fuzz_targets/raster.rs, and of fuzz_targets/convert.rs; in both the text comes first.
        number, of_convert = {"img": (0, 0), "bip": (0, 0), "mpr": (1, 2), "npy": (2, 6), "fortran": (2, 6), "npz": (3, 7), "packed": (3, 7),
                              "exr": (4, 8), "png": (5, 9), "csv": (6, 5)}.get(ending, (8, 10))
        parts = (data, partner) if name in ["mpr", "csv"] else (partner, data)
        add("raster", name, bytes([number]) + b"\0".join(parts))
        if not partner:
            map_file = (data, about) if name == "csv" else (about, data)
            add("raster", f"{name}_map", bytes([number]) + b"\0".join(map_file))
        for output in range(7):
            add("convert", f"{name}_{output}", bytes([of_convert, output]) + b"\0".join(parts))
    add("raster", "map", b"\7" + about.replace(b"quantity", b'raster = "a.csv"\nquantity') + b"\0001,2\n3,4\n")
    add("raster", "facets", b"\6facet,radiance_w_m2_sr_um at 1 um\n0,2\n1,6\n")
    for name, header in IMAGES.items():
        add("raster", f"header_{name}", b"\0" + header.encode() + b"\0" + numbers)
        add("sli", f"header_{name}", header.encode() + b"\0" + numbers)
    plate, materials = ((FUZZ / "scene" / f"plate.{e}").read_bytes() for e in ["obj", "mtl"])
    for output in [9, 10]:
        add("convert", f"mesh_{output}", bytes([3, output]) + plate + b"\0" + materials)
        add("convert", f"gltf_{output}", bytes([4, output]) + (FUZZ / "corpus" / "gltf" / "plain").read_bytes())
    for name, text in SPECTRA.items():
        for output in [6, 7, 8]:
            add("convert", f"{name}_{output}", bytes([5, output]) + text.split("\0")[0].encode())


class Convert:
    """Converts into a folder."""

    def __init__(self, mmxrt, folder):
        self.mmxrt, self.folder = mmxrt, folder

    def __call__(self, source, name):
        subprocess.run([self.mmxrt, "--quiet", "convert", source, self.folder / name], check=True)
        return self.folder / name


def main():
    mmxrt = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        convert = Convert(mmxrt, pathlib.Path(folder))
        source = FUZZ / "scene" / "scene.toml"
        ours = convert(source, "simulation")
        for other in ["check", "mars"]:
            shutil.rmtree(ours / other, ignore_errors=True)
        xml()
        ccsds()
        dart_simulation(ours)
        database()
        gltf(convert, source)
        ilwis()
        spectra(convert)
        obj()
        scene()
        maps()
        flight()
        tables()
        polygons()
        products(mmxrt, convert.folder)
        rasters(mmxrt, convert.folder)


main()
