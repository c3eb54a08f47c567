#!/usr/bin/env python3
"""Every number that mmxrt gives, as hashes: for changes that must move none.

    python3 .ci/all_numbers.py make PROGRAM FOLDER --model MODEL   # all products, and FOLDER/numbers.json
    python3 .ci/all_numbers.py compare FOLDER FOLDER               # of the program before and the one after

MODEL is what `simulate` and `solve` are asked for, such as sunlight,mars-light,heat, so that two programs whose plans differ are
compared by the same effects; left out: each program's own default.

`make` runs what is shipped: the scenes and benches, scenes of tests, variants of them that use what they do not, what the
examples run, and conversions between all formats. Hashed are arrays of numbers (of .npz each by itself) and reports, as JSON
without free text; of other files all bytes. Left out is run.json, which holds dates and times. `compare` says what differs, and of
arrays by how much: the largest difference over the largest magnitude. Exit code 1 if anything does.

Needs Python 3.9 or later alone.
"""

import argparse
import array
import hashlib
import importlib.util
import json
import math
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SITE = ROOT / "scenes" / "phobos_site"


def bench():
    """benches/speed.py, whose scenes are used here too."""
    sys.dont_write_bytecode = True
    spec = importlib.util.spec_from_file_location("speed", ROOT / "benches" / "speed.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Maker:
    """Runs commands in a folder."""

    def __init__(self, program, folder, model):
        self.program, self.folder = str(pathlib.Path(program).resolve()), folder
        self.asked = ["--model", model] if model else []

    def run(self, *arguments, codes=(0,)):
        """Runs a command, whose exit code must be one of these: 3 if it lost something that was told."""
        command = [self.program, "--quiet", *map(str, arguments)]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        if done.returncode not in codes:
            sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr}")
        return done.stdout

    def write(self, name, text):
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / name).write_text(text)
        return name

    def products(self, scene, name):
        """All products of a scene: at once, and with its table between, seen by another camera's bands."""
        self.run("simulate", scene, *self.asked, "-o", name, "--exr", "--footprints", "--table", "--split")
        table = next((self.folder / name).glob("*.npz"), None)
        assert table, f"{name}: no table"
        self.run("solve", scene, *self.asked, "-o", f"{name}.npz")
        self.run(
            "integrate", scene, "--table", f"{name}.npz", "-o", f"{name}_of_table", "--dtype", "f64", "--interleave", "bip"
        )
        self.write(f"{name}.inspect.json", self.run("--json", "inspect", scene))
        self.write(f"{name}.product.json", self.run("--json", "inspect", name))


def variants(text):
    """Scenes like one that is shipped, with what it does not use; small, so that they are many."""
    small = text.replace('"site.toml"', "{ version = 1, seed = 2, facets = 6000 }").replace(
        'preset = "macromega"', "samples = 48\nlines = 40\nbands = { centres_um = [1.0, 2.2, 3.4] }"
    )
    many = small.replace("centres_um = [1.0, 2.2, 3.4]", "start_um = 0.95, stop_um = 3.6, count = 40, fwhm_um = 0.02")
    yield "small", small
    yield "many_bands", many
    yield "without_mars", re.sub(r"\[mars\]\nposition_m = .*\n", "", small)
    yield "without_heat", small + '\n[thermal]\nmodel = "off"\n'
    yield "heat_of_the_thesis", many + '\n[thermal]\nmodel = "thesis"\n'
    yield "mars_of_the_thesis", small.replace("[mars]\n", '[mars]\nmodel = "thesis"\n')
    yield "emissivity_apart", many.replace('"blue_unit.csv" }', '"blue_unit.csv", emissivity = 0.9, bond_albedo = 0.05 }')
    yield "oblique", re.sub(r"position_m = \[84308.*\n", "position_m = [40000.0, 60000.0, 20000.0]\n", small)
    yield "amid_the_facets", re.sub(r"position_m = \[84308.*\n", "position_m = [12300.0, 4476.0, 20.0]\n", small).replace(
        'fit = "scene"', "fov_deg = 60.0"
    )
    yield "of_broad_bands", small.replace("centres_um = [1.0, 2.2, 3.4]", "centres_um = [1.2, 2.5], fwhm_um = 0.8")


def textured(plane, quantity):
    return f"texture = {{ raster = 'texture.img', quantity = '{quantity}', placement = 'plane', plane = {plane} }}"


def make(program, folder, model):
    speed = bench()
    folder.mkdir(parents=True)
    maker = Maker(program, folder, model)
    spectra = [SITE / "blue_unit.csv", SITE / "red_unit.csv"]
    for path in spectra:
        shutil.copy(path, folder)

    for path in sorted((ROOT / "scenes").glob("*/scene.toml")):
        maker.products(path, path.parent.name)
    for name, text in variants((ROOT / "scenes/phobos_mars_side/scene.toml").read_text()):
        maker.products(maker.write(f"{name}.toml", text), name)
    for path in sorted((ROOT / "tests/data/geometry").glob("*/s.toml")):
        maker.products(path, f"geometry/{path.parent.name}")

    # Benches, textures and maps, smaller.
    maker.run("landscape", ROOT / "benches/landscape_2e5.toml", "-o", "landscape_2e5.obj")
    for incidence_deg, bands in [(24, 1), (60, 1), (60, 300), (85, 1)]:
        scene = speed.scene("landscape_2e5", incidence_deg, bands)
        maker.products(maker.write(f"bench_{incidence_deg}_{bands}.toml", scene), f"bench_{incidence_deg}_{bands}")
    speed.raster(folder / "texture.img", 500, 1)
    step = 2004 / 500
    plane = f"{{ corner_m = [-1002, 1002, 0], along_line_m = [{step!r}, 0, 0], line_to_line_m = [0, {-step!r}, 0] }}"
    scene = speed.scene("landscape_2e5", 60, 3)
    text = scene.replace("_unit.csv' }", f"_unit.csv', {textured(plane, 'factor')} }}")
    maker.products(maker.write("textured.toml", text), "textured")
    speed.raster(folder / "map.img", 500, 3)
    for name, more in [("map", ""), ("heat", 'light = "thermal"\n')]:
        map_file = f'mmxrt_map = 1\nraster = "map.img"\nquantity = "radiance"\nunit = "W m-2 sr-1 um-1"\n{more}placement = "plane"\nplane = {plane}\n'
        maker.write(f"{name}.map.toml", map_file)
    scene = maker.write("mapped.toml", speed.scene("landscape_2e5", 60, 3).replace(
        "start_um = 0.95, stop_um = 3.6, count = 3", "centres_um = [1.0, 1.1, 1.2]"
    ))
    for name, how in [("nearest", []), ("bilinear", ["--texels", "bilinear"]), ("filled", ["--unknown", "solve"])]:
        maker.run("integrate", scene, "--radiance", "map.img", "-o", f"map_{name}", *how)
    maker.run("integrate", scene, "--radiance", "map.img+map.img*0.5", "-o", "map_sum")

    # DART: what its output would be, into an image; scenes into simulations and back.
    dart = folder / "dart_output"
    subprocess.run(
        [sys.executable, ROOT / "adapters/dart/synthetic_output.py", dart, "--view", "0", "0", "--view", "36.87", "90"],
        check=True, capture_output=True,
    )
    example = (ROOT / "examples/6_radiance_maps.sh").read_text()
    texts = re.findall(r"<<'(SCENE|MAP)'\n(.*?)\n\1\n", example, re.S)
    maker.write("dart_output/scene.toml", texts[0][1])
    maker.write("dart_output/dart.toml", texts[1][1])
    for views in ["nearest", "interpolated"]:
        maker.run(
            "integrate", "dart_output/scene.toml", "--radiance", "dart_output/dart.toml", "--unknown", "solve",
            "--views", views, "-o", f"dart_{views}",
        )
    for name in ["small", "many_bands", "without_mars", "textured"]:
        for version in ["5.7.4", "5.11.0"]:
            simulation = f"converted/{name}_{version}_dart"
            maker.run("convert", f"{name}.toml", simulation, "--dart-version", version)
            maker.run("convert", simulation, f"converted/{name}_{version}/scene.toml")
    for simulation in sorted((ROOT / "tests/data/dart").iterdir()):
        maker.run("convert", simulation, f"converted/{simulation.name}/scene.toml")

    # Meshes, spectra, images.
    for to in ["obj", "glb", "gltf"]:
        maker.run("convert", "small.toml", f"converted/site.{to}")
        maker.run("convert", f"converted/site.{to}", f"converted/of_{to}/scene.toml")
    for path in sorted((ROOT / "tests/data/gltf").glob("*.gltf")):
        maker.run("convert", path, f"converted/{path.stem}/scene.toml")
    maker.run("convert", "small.toml", "converted/spectra.db")
    maker.run("convert", "converted/spectra.db", "converted/spectra.sli")
    maker.run("convert", "converted/spectra.sli", "converted/resampled.csv", "--bands", "1:3:21:0.01")
    for to in ["bsq", "bil", "bip", "npy", "exr"]:
        maker.run("convert", "phobos_mars_side/cube.img", f"converted/{to}/cube.{to}")
        maker.run("convert", f"converted/{to}/cube.{to}", f"converted/back_from_{to}.npy")
    maker.run("convert", "phobos_mars_side/cube.img", "converted/band.mpr", "--band", "7")
    maker.run("convert", "converted/band.mpr", "converted/band.npy")

    (folder / "numbers.json").write_text(json.dumps(numbers(folder), indent=1, sort_keys=True) + "\n")


# What the machine has free, and the size of files with dates in them.
OF_THE_MACHINE = {"disk_bytes", "memory_bytes", "bytes"}


def without_text(value):
    """JSON without what people read, strings of several words, and what another run finds otherwise."""
    if isinstance(value, dict):
        return {key: without_text(v) for key, v in value.items() if key not in OF_THE_MACHINE}
    if isinstance(value, list):
        return [without_text(v) for v in value]
    return "" if isinstance(value, str) and " " in value else value


def content(path):
    """What of a file is compared: names, each with bytes."""
    data = path.read_bytes()
    if path.suffix == ".json":
        return {"": json.dumps(without_text(json.loads(data)), sort_keys=True).encode()}
    if path.suffix == ".npz":
        with zipfile.ZipFile(path) as archive:
            return {f":{name}": archive.read(name) for name in archive.namelist() if name.endswith(".npy")}
    if path.suffix in (".hdr", ".toml"):
        # Descriptions and comments are text.
        return {"": re.sub(rb"(?m)^description = .*$|#.*$", b"", data)}
    return {"": data}


def files(folder):
    """The files to compare: made ones, not what they are made of."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name not in ("run.json", "numbers.json"):
            yield path.relative_to(folder).as_posix(), path


def numbers(folder):
    return {
        name + part: hashlib.sha256(data).hexdigest()
        for name, path in files(folder)
        for part, data in content(path).items()
    }


def values(name, path, part):
    """The numbers of an array that differs, or None."""
    data = content(path)[part]
    if data[:6] == b"\x93NUMPY" and b"'descr': '<U" not in data[:64]:
        length, start = (struct.unpack("<H", data[8:10])[0], 10) if data[6] == 1 else (struct.unpack("<I", data[8:12])[0], 12)
        kind = re.search(rb"'descr': '[<|]([a-z]\d)'", data[start : start + length]).group(1).decode()
        data = data[start + length :]
    elif path.suffix in (".img", ".bsq", ".bil", ".bip"):
        header = path.with_suffix(".hdr").read_text()
        kind = {"1": "u1", "4": "f4", "5": "f8", "3": "i4", "13": "u4"}[re.search(r"data type = (\d+)", header).group(1)]
    else:
        return None
    code = {"f4": "f", "f8": "d", "u1": "B", "u2": "H", "u4": "I", "i4": "i", "u8": "Q"}.get(kind)
    if code is None:
        return None
    return array.array(code, data)


def compare(one, two):
    before, after = (json.loads((folder / "numbers.json").read_text()) for folder in (one, two))
    differ = sorted(key for key in before.keys() | after.keys() if before.get(key) != after.get(key))
    for key in differ:
        if key not in before or key not in after:
            print(f"{key}: only {'before' if key in before else 'after'}")
            continue
        name, _, part = key.partition(".npz:")
        name, part = (name + ".npz", ":" + part) if part else (key, "")
        a, b = (values(name, folder / name, part) for folder in (one, two))
        if a is None or b is None or len(a) != len(b):
            print(f"{key}: differs")
            continue
        finite = [(x, y) for x, y in zip(a, b) if math.isfinite(x) and math.isfinite(y)]
        largest = max((abs(x) for x, _ in finite), default=0) or 1
        worst = max((abs(x - y) for x, y in finite), default=0)
        others = sum(repr(x) != repr(y) for x, y in zip(a, b) if not (math.isfinite(x) and math.isfinite(y)))
        moved = sum(x != y for x, y in finite)
        print(f"{key}: {moved + others} of {len(a)} numbers differ, by up to {worst / largest:.1e} of the largest; {others} that are not finite")
    print(f"{len(before)} before, {len(after)} after, {len(differ)} differ")
    return 1 if differ or not before else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, dest="what")
    making = commands.add_parser("make", help="all products of a program, and their numbers")
    making.add_argument("program")
    making.add_argument("folder", type=pathlib.Path)
    making.add_argument("--model", help="what simulate and solve are asked for")
    comparing = commands.add_parser("compare", help="say what differs")
    comparing.add_argument("before", type=pathlib.Path)
    comparing.add_argument("after", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.what == "compare":
        sys.exit(compare(arguments.before, arguments.after))
    if arguments.folder.exists():
        sys.exit(f"{arguments.folder}: exists")
    make(arguments.program, arguments.folder.resolve(), arguments.model)


if __name__ == "__main__":
    main()
