#!/usr/bin/env python3
"""How fast mmxrt is: whole processes, from an OBJ file on the disk to a complete product folder.

    cargo build --release
    python3 benches/speed.py            # five runs of each row; --runs 1 for a first look

Needs Python 3 on Linux or macOS, and nothing else. Each row is one scene of benches/landscape_*.toml: 2 x 2 km seen
from 77 km straight above in 256 x 256 pixels, Sun 30 deg from x (east) to y (north), Mars in the sky, by the model that MODEL names: a point
Sun with exact shadows, Mars-light, thermal emission, Lambert surfaces. The last rows put a texture on the facets, with texels as large as they are, and
integrate radiance maps of 4096 x 4096 texels, of which the files take up to 1.1 GB. Measured is the process as the system
accounts for it: CPU time (user + system) and peak memory. The table is the median of the runs, in Markdown.
"""

import argparse
import array
import math
import os
import pathlib
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent

# Machines differ, and others may be busy with the same one, which only adds: a row fails the check if its fastest run is over its limit by
# more than this factor.
TOO_MUCH = 1.3

# name, landscape, incidence in deg, bands
CASES = [
    ("2e5 facets, 60 deg, 1 band", "landscape_2e5", 60, 1),
    ("2e6 facets, 60 deg, 1 band", "landscape_2e6", 60, 1),
    ("2e6 facets, 85 deg, 1 band", "landscape_2e6", 85, 1),
    ("2e6 facets, 60 deg, 300 bands", "landscape_2e6", 60, 300),
]

MODEL = "sunlight,mars-light,heat"

TEXTURED = "2e6 facets, 60 deg, texels as large as facets"
# name, bands
MAPS = [("2e6 facets, map of 4096 x 4096 x 16", 16), ("2e6 facets, map of 4096 x 4096 x 4", 4)]


def raster(path, side, bands):
    """An ENVI file of side x side texels, f4: smooth, and another number in each of the texels around."""
    rows = [array.array("f", (1 + 0.3 * math.sin(0.37 * (side * r + c)) for c in range(side))).tobytes() for r in range(64)]
    with path.open("wb") as out:
        for band in range(bands):
            for row in range(side):
                out.write(rows[(row + band) % 64])
    centres = ", ".join(f"{1 + 0.1 * band:.1f}" for band in range(bands))
    path.with_suffix(".hdr").write_text(
        f"ENVI\nsamples = {side}\nlines = {side}\nbands = {bands}\ndata type = 4\ninterleave = bsq\nbyte order = 0\n"
        f"wavelength units = Micrometers\nwavelength = {{{centres}}}\n"
    )


def plane(side):
    """A raster over the 2 x 2 km of the scene, seen from above."""
    step = 2004 / side
    return f"{{ corner_m = [-1002, 1002, 0], along_line_m = [{step!r}, 0, 0], line_to_line_m = [0, {-step!r}, 0] }}"


def textured(text):
    """A scene with a texture on both of its materials."""
    texture = f"texture = {{ raster = 'texture.img', quantity = 'factor', placement = 'plane', plane = {plane(1430)} }}"
    return text.replace("_unit.csv' }", f"_unit.csv', {texture} }}")


def map_command(folder, program, bands):
    """What integrates a map, after its files were made."""
    image = folder / f"map_{bands}.img"
    if not image.exists():
        print(f"making {image.name}", file=sys.stderr)
        raster(image, 4096, bands)
    image.with_suffix(".map.toml").write_text(
        'mmxrt_map = 1\nquantity = "radiance"\nunit = "W m-2 sr-1 um-1"\nplacement = "plane"\n' f"plane = {plane(4096)}\n"
    )
    path = folder / f"map_{bands}.toml"
    centres = ", ".join(f"{1 + 0.1 * band:.1f}" for band in range(bands))
    path.write_text(scene("landscape_2e6", 60, 1).replace("[1.0]", f"[{centres}]"))
    return [program, "--quiet", "integrate", str(path), "--radiance", str(image), "-o", str(path.with_suffix(""))]


def scene(landscape, incidence_deg, bands):
    """A scene file: local axes x east, y north, z up, with the origin as the body's centre, so that nothing is rotated."""
    incidence, azimuth = math.radians(incidence_deg), math.radians(30)
    sun = (math.sin(incidence) * math.cos(azimuth), math.sin(incidence) * math.sin(azimuth), math.cos(incidence))
    centres = "{ centres_um = [1.0] }" if bands == 1 else f"{{ start_um = 0.95, stop_um = 3.6, count = {bands} }}"
    spectra = HERE.parent / "scenes" / "phobos_site"
    return f"""mmxrt_scene = 1
origin_m = [0.0, 0.0, 0.0]
mesh = [{{ obj = "{landscape}.obj" }}]

[materials]
phobos_blue = {{ reflectance = '{spectra / "blue_unit.csv"}' }}
phobos_red = {{ reflectance = '{spectra / "red_unit.csv"}' }}

[sun]
direction = [{sun[0]!r}, {sun[1]!r}, {sun[2]!r}]
distance_au = 1.5237

[mars]
position_m = [2.8e6, 0.9e6, 8.9e6]

[observer]
position_m = [0.0, 0.0, 77000.0]
target_m = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]

[sensor]
samples = 256
lines = 256
fit = "scene"
bands = {centres}
"""


def run(command):
    """Runs a command; its CPU seconds, wall seconds and peak memory in GB."""
    began = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    wall_s = time.monotonic() - began
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {process.returncode}")
    # ru_maxrss is in bytes on macOS, in KiB elsewhere.
    unit = 1 if sys.platform == "darwin" else 1024
    return usage.ru_utime + usage.ru_stime, wall_s, usage.ru_maxrss * unit / 1e9


def machine():
    """The processor's name and the number of cores."""
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        name = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        name = platform.processor() or platform.machine()
    return f"{os.cpu_count()} cores, {name}"


def verdict(value, limit):
    return "yes" if value <= limit else "**no**"


def asked_for(cpu_s, peak_gb):
    """What the program is asked for: name, measured, limit, unit."""
    small, large, grazing, many = (case[0] for case in CASES)
    return [
        ("2e5 facets, 60 deg, 1 band", cpu_s[small], 0.4, "CPU s"),
        ("2e6 facets, 60 deg, 1 band", cpu_s[large], 3.0, "CPU s"),
        ("the same: peak memory", peak_gb[large], 0.8, "GB"),
        ("2e6 facets, 85 deg, 1 band", cpu_s[grazing], 5.0, "CPU s"),
        ("300 bands instead of 1, at 2e6 facets", cpu_s[many] - cpu_s[large], 0.6, "CPU s"),
        ("2e6 against 2e5 facets", cpu_s[large] / cpu_s[small], 11.0, "x"),
        ("texture against none, at 2e6 facets", cpu_s[TEXTURED] / cpu_s[large], 3.0, "x"),
        ("map of 4096 x 4096 x 16", cpu_s[MAPS[0][0]], 10.0, "CPU s"),
        ("the same: peak memory, of which the map's file is no part", peak_gb[MAPS[0][0]], 2.0, "GB"),
        ("the same against 4 bands: peak memory", peak_gb[MAPS[0][0]] - peak_gb[MAPS[1][0]], 0.02, "GB"),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5, help="runs of each row, of which the median is printed (5); 0: run each once and measure nothing")
    parser.add_argument("--check", action="store_true", help=f"fail if the fastest run of a row is over {TOO_MUCH} x its limit")
    parser.add_argument("--program", default=str(HERE.parent / "target/release/mmxrt"), help="the program to measure")
    parser.add_argument("--keep", metavar="FOLDER", help="keep meshes, scenes and products in this folder")
    arguments = parser.parse_args()
    if not os.access(arguments.program, os.X_OK):
        sys.exit(f"{arguments.program}: no such program; build it first: cargo build --release")

    folder = pathlib.Path(arguments.keep or tempfile.mkdtemp(prefix="mmxrt_bench_"))
    folder.mkdir(parents=True, exist_ok=True)
    try:
        for landscape in sorted({case[1] for case in CASES}):
            if not (folder / f"{landscape}.obj").exists():
                print(f"making {landscape}.obj", file=sys.stderr)
                recipe, mesh = HERE / f"{landscape}.toml", folder / f"{landscape}.obj"
                run([arguments.program, "--quiet", "landscape", str(recipe), "-o", str(mesh)])
        commands = {}
        for name, landscape, incidence_deg, bands in CASES:
            path = folder / f"{landscape}_{incidence_deg}deg_{bands}.toml"
            path.write_text(scene(landscape, incidence_deg, bands))
            commands[name] = [arguments.program, "--quiet", "simulate", str(path), "--model", MODEL, "-o", str(path.with_suffix(""))]
        raster(folder / "texture.img", 1430, 1)
        path = folder / "textured.toml"
        path.write_text(textured(scene("landscape_2e6", 60, 1)))
        commands[TEXTURED] = [arguments.program, "--quiet", "simulate", str(path), "--model", MODEL, "-o", str(path.with_suffix(""))]
        for name, bands in MAPS:
            commands[name] = map_command(folder, arguments.program, bands)
        cpu_s, wall_s, peak_gb, least_s = {}, {}, {}, {}
        for name, command in commands.items():
            seen = []
            # Once without counting: the files are then in the system's cache, as they are for whoever just made them.
            for i in range(-1, arguments.runs):
                shutil.rmtree(command[-1], ignore_errors=True)
                measured = run(command)
                if i < 0:
                    continue
                seen.append(measured)
                print(f"{name}: run {i + 1}: {seen[-1][0]:.2f} CPU s, {seen[-1][1]:.2f} s", file=sys.stderr)
            if seen:
                cpu_s[name], wall_s[name], peak_gb[name] = (statistics.median(s[k] for s in seen) for k in range(3))
                least_s[name] = min(s[0] for s in seen)
    finally:
        if not arguments.keep:
            shutil.rmtree(folder)
    if arguments.runs == 0:
        return

    print(f"Machine: {machine()}. Median of {arguments.runs}; CPU seconds are user + system.\n")
    print("| whole process, 256 x 256 pixels, nadir | model | CPU s | wall s | peak GB |")
    print("|---|---|---|---|---|")
    of_maps = [name for name, _ in MAPS]
    for name in cpu_s:
        model = "the map's radiance" if name in of_maps else MODEL
        print(f"| {name} | {model} | {cpu_s[name]:.2f} | {wall_s[name]:.2f} | {peak_gb[name]:.2f} |")

    print("\n| asked for | at most | measured | kept |")
    print("|---|---|---|---|")
    for name, value, limit, unit in asked_for(cpu_s, peak_gb):
        print(f"| {name} | {limit:g} {unit} | {value:.2f} {unit} | {verdict(value, limit)} |")
    far_over = [name for name, value, limit, _ in asked_for(least_s, peak_gb) if value > TOO_MUCH * limit]
    if arguments.check and far_over:
        sys.exit(f"over {TOO_MUCH} x the limit in the fastest run: {'; '.join(far_over)}")


if __name__ == "__main__":
    main()
