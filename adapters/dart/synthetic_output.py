#!/usr/bin/env python3
"""A made-up output folder in DART's layout: a Lambert box on Lambert ground under a point Sun, by closed forms.

DART did not compute it: its `simulation.properties.txt` says so. There is no interreflection, no sky and no heat; a shadow is where the line to the Sun
meets the box. A pixel is the mean of a grid of lines of sight. It serves to try what reads such folders on something whose answer is known.

    python3 synthetic_output.py out/box --view 0 0 --view 36.87 90

Axes are DART's: x South (rows), y East (columns), z up, metres, from the scene's corner; azimuths from x to y. Beside `output/`, `box.obj` is the same
surface with x East, y North, z up, from the middle of the ground. Standard library only.
"""

import argparse
import math
import struct
from pathlib import Path


def direction(zenith_deg, azimuth_deg):
    zenith, azimuth = math.radians(zenith_deg), math.radians(azimuth_deg)
    return (math.sin(zenith) * math.cos(azimuth), math.sin(zenith) * math.sin(azimuth), math.cos(zenith))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def enters_box(origin, towards, low, high):
    """Distance at which a line enters a box, and the axis of the face; None if it does not."""
    first, last, axis = -math.inf, math.inf, None
    for k in range(3):
        if towards[k] == 0.0:
            if not low[k] < origin[k] < high[k]:
                return None
            continue
        a, b = sorted(((low[k] - origin[k]) / towards[k], (high[k] - origin[k]) / towards[k]))
        if a > first:
            first, axis = a, k
        last = min(last, b)
    return (first, axis) if first < last else None


class Scene:
    def __init__(self, size, low, high, sun):
        self.size, self.low, self.high, self.sun = size, low, high, sun

    def corners(self):
        return [(x, y, z) for x in (0.0, self.size[0]) for y in (0.0, self.size[1]) for z in (0.0, self.high[2])]

    def seen(self, ground, towards):
        """What a line of sight from a viewer in direction `towards` to a point of the ground plane sees: material (0 ground, 1 box) and cosine of
        incidence, 0 in the shadow; None beside the scene."""
        back = tuple(-t for t in towards)
        # From above everything.
        far = (self.high[2] + 1.0) / towards[2]
        eye = tuple(g + far * t for g, t in zip(ground, towards))
        hit = enters_box(eye, back, self.low, self.high)
        if hit:
            distance, axis = hit
            normal = tuple((1.0 if towards[k] > 0.0 else -1.0) if k == axis else 0.0 for k in range(3))
            # A box does not shade its own faces but by turning them away.
            return 1, max(0.0, dot(normal, self.sun))
        if not (0.0 <= ground[0] < self.size[0] and 0.0 <= ground[1] < self.size[1]):
            return None
        shade = enters_box(ground, self.sun, self.low, self.high)
        return 0, 0.0 if shade and shade[0] >= 0.0 else self.sun[2]


def number_of_name(degrees):
    return f"{degrees:05.1f}".replace(".", "_")


def image(scene, zenith_deg, azimuth_deg, pixel, samples):
    """Rows, columns, corners on the ground, and for each pixel the mean cosine of incidence by material, or None."""
    towards = direction(zenith_deg, azimuth_deg)
    cos_z, sin_z = towards[2], math.sin(math.radians(zenith_deg))
    azimuth = math.radians(azimuth_deg)
    along, across = (math.cos(azimuth), math.sin(azimuth)), (-math.sin(azimuth), math.cos(azimuth))
    # Coordinates in the plane that faces the viewer.
    rows = [cos_z * dot(along, p[:2]) - sin_z * p[2] for p in scene.corners()]
    columns = [dot(across, p[:2]) for p in scene.corners()]
    first_row, first_column = min(rows), min(columns)

    def count(values):
        # A hair more than a whole number is rounding.
        return math.ceil((max(values) - min(values)) / pixel - 1e-9)

    size = count(rows), count(columns)

    def ground(row, column):
        r, c = (first_row + row * pixel) / cos_z, first_column + column * pixel
        return (r * along[0] + c * across[0], r * along[1] + c * across[1], 0.0)

    corners = [ground(*p)[:2] for p in ((0, 0), (size[0], 0), size, (0, size[1]))]
    pixels = []
    for row in range(size[0]):
        for column in range(size[1]):
            steps = [(k + 0.5) / samples for k in range(samples)]
            seen = [scene.seen(ground(row + i, column + j), towards) for i in steps for j in steps]
            seen = [s for s in seen if s]
            if not seen:
                pixels.append(None)
                continue
            pixels.append([sum(cos for m, cos in seen if m == material) / len(seen) for material in (0, 1)])
    return size, corners, pixels


def write_image(folder, name, size, corners, pixel, values):
    rows, columns = size
    (folder / f"{name}.mpr").write_text(
        f"[Ilwis]\nDescription=Raster Map {name}\nTime=0\nType=BaseMap\n\n[BaseMap]\nCoordSystem=unknown.csy\n"
        f"CoordBounds=0 -{columns * pixel:.12g} {rows * pixel:.12g} 0\nDomain=value.dom\n"
        f"Range=-1e+300:1e+300:0.000000:offset=0\nType=Map\nMinMax={min(values):g}:{max(values):g}\n\n"
        f"[Map]\nGeoRef={name}.grf\nSize={rows} {columns}\nType=MapStore\n\n"
        f"[MapStore]\nData={name}.mp#\nType=Real\nStructure=Line\nStartOffset=0\nRowLength={columns}\n"
    )
    (folder / f"{name}.mp#").write_bytes(struct.pack(f"<{len(values)}d", *values))
    (folder / f"{name}.grf").write_text(
        f"[Ilwis]\nType=GeoRef\n\n[TableStore]\nData={name}.gr#\nType=TableBinary\n\n"
        f"[GeoRef]\nCoordSystem=unknown.csy\nlines={rows}\ncolumns={columns}\nType=GeoRefCTP\n\n"
        f"[GeoRefCTP]\nTransformation=Affine\nReference Map={name}.mpr\n"
    )
    table = b"ILWIS 2.00 Table\r\n\x1a".ljust(128, b"\0")
    for corner, row, column in ((0, 1, 1), (3, 1, columns), (1, rows, 1), (2, rows, columns)):
        table += struct.pack("<2d3i", *corners[corner], row, column, 2)
    (folder / f"{name}.gr#").write_bytes(table)


def write_obj(path, size, low, high):
    def local(x, y, z):
        return y - size[1] / 2, size[0] / 2 - x, z

    (x0, y0, _), (x1, y1, z1) = low, high
    ground = [(0, 0, 0), (size[0], 0, 0), (size[0], size[1], 0), (0, size[1], 0)]
    box = [(x, y, z) for z in (0.0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    faces = [(1, 2, 3, 4)]
    # Counter-clockwise from outside; the box stands on the ground without a bottom.
    faces += [(9, 10, 11, 12), (5, 6, 10, 9), (6, 7, 11, 10), (7, 8, 12, 11), (8, 5, 9, 12)]
    lines = ["# x East, y North, z up, from the middle of the ground"]
    lines += ["v {:.17g} {:.17g} {:.17g}".format(*local(*p)) for p in ground + box]
    for i, face in enumerate(faces):
        lines.append("usemtl " + ("ground" if i == 0 else "box"))
        lines.append("f " + " ".join(map(str, face)))
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="simulation's folder to make")
    parser.add_argument("--size", type=float, nargs=2, default=(12.0, 16.0), metavar=("X", "Y"), help="scene, m")
    parser.add_argument("--box", type=float, nargs=5, default=(2.0, 4.0, 6.0, 12.0, 4.0), metavar=("X0", "Y0", "X1", "Y1", "HEIGHT"))
    parser.add_argument("--sun", type=float, nargs=2, default=(30.0, 225.0), metavar=("ZENITH", "AZIMUTH"), help="seen from the ground, deg")
    parser.add_argument("--view", type=float, nargs=2, action="append", metavar=("ZENITH", "AZIMUTH"), help="towards the viewer, deg")
    parser.add_argument("--pixel", type=float, default=0.5, help="m")
    parser.add_argument("--samples", type=int, default=8, help="lines of sight along an edge of a pixel")
    parser.add_argument("--band", type=float, nargs=5, action="append", metavar=("FROM", "TO", "IRRADIANCE", "GROUND", "BOX"),
                        help="um; W m-2 um-1 normal to the beam; reflectances")
    arguments = parser.parse_args()
    views = arguments.view or [(0.0, 0.0), (36.87, 90.0)]
    bands = arguments.band or [(0.6, 0.7, 700.0, 0.07, 0.2), (1.0, 1.1, 300.0, 0.1, 0.15)]
    x0, y0, x1, y1, height = arguments.box
    scene = Scene(arguments.size, (x0, y0, 0.0), (x1, y1, height), direction(*arguments.sun))

    output = arguments.folder / "output"
    output.mkdir(parents=True, exist_ok=True)
    write_obj(arguments.folder / "box.obj", scene.size, scene.low, scene.high)
    properties = ["synthetic:made by synthetic_output.py from closed forms; DART did not compute this"]
    properties += [f"dart.maket.scene.size.{a}:{v:.6f}" for a, v in zip("xyz", (*scene.size, height))]
    properties += ["maket.lowerCorner.x:0", "maket.lowerCorner.y:0", "maket.lowerCorner.z:0", f"phase.nbSpectralBands:{len(bands)}"]
    for b, (first, last, irradiance, _, _) in enumerate(bands):
        properties += [f"dart.band{b}.lambdaMin:{first:.14f}", f"dart.band{b}.lambdaMax:{last:.14f}", f"dart.band{b}.mode:R"]
        properties += [f"dart.band{b}.BOA.irradiance:{irradiance * scene.sun[2]:.12f}"]
    images = []
    for i, (zenith, azimuth) in enumerate(views):
        name = f"ima{i + 1:02d}_VZ={number_of_name(zenith)}_VA={number_of_name(azimuth)}"
        properties += [f"dart.products.image{i}.teta:{zenith:.6f}", f"dart.products.image{i}.phi:{azimuth:.6f}"]
        properties += [f"dart.products.image{i}.imageNamePrefix:ima{i + 1:02d}", f"dart.products.image{i}.isSensorImage:0"]
        images.append((name, image(scene, zenith, azimuth, arguments.pixel, arguments.samples)))
    (output / "simulation.properties.txt").write_text("\n".join(properties) + "\n")
    for b, (_, _, _, ground, box) in enumerate(bands):
        folder = output / f"BAND{b}" / "BRF" / "ITERX" / "IMAGES_DART"
        folder.mkdir(parents=True, exist_ok=True)
        georef = ["Ima  X1      Y1      X2      Y2      X3      Y3      X4      Y4", "\t(same size as original image)"]
        for i, (name, (size, corners, pixels)) in enumerate(images):
            # Reflectance factor: of a Lambert surface, its reflectance times cos i over that of level ground.
            values = [-1.0 if p is None else (ground * p[0] + box * p[1]) / scene.sun[2] for p in pixels]
            write_image(folder, name, size, corners, arguments.pixel, values)
            numbers = " ".join(f"{n:.6f}" for corner in corners for n in corner)
            georef += [f"{i + 1} {numbers}", f"   {numbers}"]
        (folder / "georef").write_text("\n".join(georef) + "\n")
    x, y = scene.size
    print(f"{len(views)} views in {len(bands)} bands: {output}")
    print(f"scene_from_dart: rotation columns [[0, -1, 0], [1, 0, 0], [0, 0, 1]], translation_m [{-y / 2}, {x / 2}, 0]")


if __name__ == "__main__":
    main()
