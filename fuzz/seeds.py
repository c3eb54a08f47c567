#!/usr/bin/env python3
"""Makes the corpora that fuzzing starts from: seeds.py MMXRT, where MMXRT is the program to convert with."""

import pathlib
import random
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile

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
    plate, materials = ((FUZZ / "scene" / f"plate.{e}").read_bytes() for e in ["obj", "mtl"])
    add("obj", "plate", plate + b"\0" + materials)
    for path in DATA.glob("dart/**/*.obj"):
        add("obj", path.name, path.read_bytes())
    add("obj", "forms", b"v 0 0 0 1.0\r\nv 1 0 0 # c\nv 1e0 \\\n1 0\nvt 0 0\ng x\nf 1/1/1 2//1 -1\ng x y\nusemtl a\nf 1 2 3\ncurv 1\n")
    corners = b"".join(b"v %d %d 0\n" % xy for xy in [(0, 0), (4, 0), (4, 4), (2, 1), (0, 4), (1, 2), (-3, 7)])
    add("obj", "concave", corners + b"f 1 2 3 4 5\nf 1 2 4 3\nf 7 6 5 4 3 2 1\n")


def scene():
    found = files(FUZZ / "scene")
    for i, path in enumerate(found):
        add("scene", path.name, pieces([(i, path.read_bytes())]))
    add("scene", "all", pieces([(i, path.read_bytes()) for i, path in enumerate(found)]))
    for path in FUZZ.parent.glob("scenes/*/scene.toml"):
        add("scene", path.parent.name, pieces([(4, path.read_bytes())]))
    good = (FUZZ / "scene" / "scene.toml").read_text()
    recipe = "version = 1\nseed = 1\nfacets = 1000\nsize_m = 100\n"
    add("scene", "recipe", pieces([(4, recipe.encode())]))
    for i, (old, new) in enumerate([
        ("start_um = 1.0\nstop_um = 2.0\ncount = 3", "centres_um = [1.0, 1.5]\nfwhm_um = [0.1, 0.2]"),
        ("fov_deg = 1.0", 'fit = "scene"'),
        ("target_m = [0, 0, 10000]\nup = [0, 1, 0]", "h = [1, 0, 0]\nv = [0, -1, 0]\nu = [0, 0, -1]"),
        ("target_m = [0, 0, 10000]\nup = [0, 1, 0]", "world_from_sensor_xyzw = [1, 0, 0, 0]"),
        ("direction = [0, 0, 1]\ndistance_au = 1.5", 'position_m = [0, 0, 2.2e11]\nspectrum = "sun.csv"\ntotal_irradiance_w_m2 = 1361'),
        ('hapke = "hapke.csv"', 'rpv = "hapke.csv", extend = "hold", bond_albedo = 0.1'),
        ("samples = 8\nlines = 4\nfov_deg = 1.0\n[sensor.bands]\nstart_um = 1.0\nstop_um = 2.0\ncount = 3", 'preset = "mirs"'),
    ]):
        assert old in good, old
        add("scene", f"other_{i}", pieces([(4, good.replace(old, new).encode())]))


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
        dart_simulation(ours)
        database()
        gltf(convert, source)
        ilwis()
        spectra(convert)
        obj()
        scene()
        products(mmxrt, convert.folder)


main()
