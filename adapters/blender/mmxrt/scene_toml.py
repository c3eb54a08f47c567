"""`scene.toml` of what was gathered, and its files. NumPy, no `bpy`."""

import os
import shutil
import tempfile

import numpy as np

from . import obj, toml_text
from .toml_text import Raw, key, table

# The Sun's radius (IAU 2015), m, and the astronomical unit, m: what makes a distance of a lamp's angle.
SUN_RADIUS_M = 695_700_000.0
AU_M = 149_597_870_700.0

# One band, where nothing is said.
BANDS = "{ centres_um = [1.0] }"


class Table(str):
    """The name of a table that goes with the scene, without its stem."""


class Scene:
    """What a scene of Blender holds, in m, in the axes that it has there."""

    def __init__(self):
        # Meshes that stand where they are: names and meshes in the world's axes.
        self.objects = []
        # Meshes that stand in several places: name, mesh in its own axes, and 4 x 4 matrices [n, 4, 4].
        self.instanced = []
        # Entries of the dictionary: keys as values of TOML.
        self.materials = {}
        # Of an entry: an array [line, sample] and the keys of its texture.
        self.textures = {}
        # Files of tables that entries name, by the names that they get.
        self.tables = {}
        # Keys of `[sun]`, and of each of `[[lamps]]`.
        self.sun = {}
        self.lamps = []
        # Rows of the camera's matrix, and keys of `[sensor]`.
        self.camera_to_world = None
        self.sensor = {}
        self.bands = BANDS
        self.origin_m = [0.0, 0.0, 0.0]
        # Whether x is east, y north and z the zenith at the origin; else the axes are the body's.
        self.is_site = False
        # Tables that are added as they are.
        self.more = ""
        # The only folder from which files are taken; None: any.
        self.inside = None
        # What became of what has no place in a scene: ("dropped", what, why).
        self.notes = []

    def note(self, fate, what, why):
        """Says once what is lost, "dropped" or "approximated", or "defaulted"."""
        if (fate, what, why) not in self.notes:
            self.notes.append((fate, what, why))


def sun(direction, irradiance, angle, distance_au=None):
    """Keys of `[sun]` of a lamp: towards it, its irradiance on a plane that faces it, and the angle that its disc spans, rad.

    With a distance it is the Sun itself, whose irradiance then follows from its spectrum; else it is a lamp of constant irradiance, as far away as
    the Sun has that angle.
    """
    keys = {"direction": [float(x) for x in direction]}
    if distance_au is not None:
        keys["distance_au"] = float(distance_au)
        return keys
    keys["irradiance"] = float(irradiance)
    if angle > 0.0:
        keys["distance_au"] = SUN_RADIUS_M / float(np.sin(0.5 * angle)) / AU_M
    else:
        keys["points"] = 1
    return keys


def text(scene, stem="scene"):
    """The text of `scene.toml`; the files that it names begin with the stem, and are `stem.obj` for the surface, `stem.NAME.obj` and so on."""
    frame = "site" if scene.is_site else None
    parts = ["mmxrt_scene = 1\n" + f"origin_m = {toml_text.value([float(x) for x in scene.origin_m])}\n"]
    pose = "radial" if scene.is_site else None
    if scene.objects:
        parts.append(table("mesh", {"file": f"{stem}.obj", "pose": pose}, is_array=True))
    for name, *_ in named(scene):
        parts.append(table("mesh", {"file": f"{stem}.{name}.obj", "instances": f"{stem}.{name}.csv", "pose": pose}, is_array=True))
    files = {name: file for file, name in texture_files(scene, stem)}
    for name, keys in scene.materials.items():
        # Tables lie beside it.
        keys = {k: f"{stem}.{v}" if isinstance(v, Table) else v for k, v in keys.items()}
        if name in scene.textures:
            keys["texture"] = {"raster": files[name], **scene.textures[name][1]}
        parts.append(table(f"materials.{key(name)}", keys))
    parts.append(table("sun", {"frame": frame, **scene.sun}))
    parts += [table("lamps", {**lamp, "frame": frame}, is_array=True) for lamp in scene.lamps]
    rows = [[float(x) for x in row] for row in scene.camera_to_world]
    # The site's frame starts at the origin anyway.
    where = {"frame": "site"} if scene.is_site else {"coordinates": "local"}
    parts.append(table("observer", {"camera_to_world": rows, "convention": "blender", **where}))
    parts.append(table("sensor", {"name": "Blender", **scene.sensor, "bands": Raw(scene.bands)}))
    if scene.more.strip():
        parts.append(scene.more.strip() + "\n")
    return "\n".join(parts)


def write(scene, folder, stem="scene"):
    """Writes a folder with `stem.toml`. What is there is replaced, file by file, only once all is written, and only if it is a scene's folder."""
    folder = os.path.abspath(folder)
    if os.path.isdir(folder) and os.listdir(folder) and not os.path.isfile(os.path.join(folder, f"{stem}.toml")):
        raise FileExistsError(f"{folder} holds something else than a scene: choose another folder")
    if os.path.exists(folder) and not os.path.isdir(folder):
        raise FileExistsError(f"{folder} is a file: choose the name of a folder")
    parent = os.path.dirname(folder)
    os.makedirs(parent, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".mmxrt-", dir=parent) as staged:
        write_parts(scene, staged, stem)
        os.makedirs(folder, exist_ok=True)
        # The scene file comes last: it names the others.
        for name in sorted(os.listdir(staged), key=lambda name: name == f"{stem}.toml"):
            os.replace(os.path.join(staged, name), os.path.join(folder, name))


def write_parts(scene, folder, stem="scene"):
    """Writes all files into an empty folder that is there; their names begin with the stem."""
    path = lambda name: os.path.join(folder, name)
    if not scene.objects and not scene.instanced:
        raise ValueError("the scene renders no mesh: is everything hidden from renders?")
    if scene.objects:
        with open(path(f"{stem}.obj"), "w", encoding="utf-8", newline="\n") as file:
            obj.write(file, scene.objects)
    for name, mesh, matrices in named(scene):
        with open(path(f"{stem}.{name}.obj"), "w", encoding="utf-8", newline="\n") as file:
            obj.write(file, [(name, mesh)])
        with open(path(f"{stem}.{name}.csv"), "w", encoding="utf-8", newline="\n") as file:
            obj.write_instances(file, matrices)
    for file, name in texture_files(scene, stem):
        np.save(path(file), np.asarray(scene.textures[name][0], np.float32))
    for name, source in scene.tables.items():
        shutil.copyfile(source, path(f"{stem}.{name}"))
    with open(path(f"{stem}.toml"), "w", encoding="utf-8", newline="\n") as file:
        file.write(text(scene, stem))


def named(scene):
    """Meshes in several places, with names that files can have, each once, beside those of tables."""
    taken = {os.path.splitext(name)[0].lower() for name in scene.tables}
    for name, mesh, matrices in scene.instanced:
        yield unique(name, taken), mesh, matrices


def texture_files(scene, stem):
    """Names of the textures' files, and whose they are."""
    taken = set()
    return [(f"{stem}.{unique(name, taken)}.npy", name) for name in scene.textures]


def unique(name, taken):
    """A name that files can have on every system, which is not among those taken, and is then."""
    plain = "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "_" for c in name)[:80] or "_"
    found, number = plain, 2
    while found.lower() in taken:
        found, number = f"{plain}_{number}", number + 1
    taken.add(found.lower())
    return found
