"""A scene of Blender as it is rendered: from the dependency graph of a render to plain numbers. Reads `bpy` data, changes nothing.

`engine.py` gets such a graph: others, that scripts can have, are those of the viewport, with its levels of modifiers and its visibility.
"""

import hashlib

import bpy
import numpy as np

from . import camera, materials, obj, scene_toml

# Objects whose surface comes into the graph as a mesh of its own, beside them.
WITH_MESH = ("CURVE", "SURFACE", "FONT", "META")
# Objects that are nothing that is seen.
UNSEEN = ("EMPTY", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE")


def gather(graph, collection=None, inside=None):
    """What a graph renders; of a collection, its objects alone, with the Sun and camera of all. Tables and images are taken from the folder `inside` alone, if one is said.

    Raises ValueError for what makes no scene.
    """
    source = graph.scene_eval
    scene = scene_toml.Scene()
    scene.inside = inside
    unit_m = float(source.unit_settings.scale_length) if source.unit_settings.system != "NONE" else 1.0
    if unit_m != 1.0:
        scene.note("approximated", "scene", f"its unit is {unit_m:g} m: all lengths are in metres, as Blender shows them")
    _properties(source, scene)
    _camera(graph, source, scene, unit_m)
    _meshes(graph, collection, scene, unit_m)
    _lights(graph, source, scene)
    return scene


def _properties(source, scene):
    """What the scene's custom properties, and the text `mmxrt.toml`, say."""
    origin = materials.plain(source.get("origin_m"))
    if origin is not None:
        if not isinstance(origin, list) or len(origin) != 3:
            raise ValueError("the scene's property `origin_m` is not three numbers, m")
        scene.origin_m = [float(x) for x in origin]
    frame = source.get("mmxrt_frame", "body")
    if frame not in ("body", "site"):
        raise ValueError(f"the scene's property `mmxrt_frame` is {frame!r}: it is \"body\", or \"site\" (x east, y north, z the zenith)")
    scene.is_site = frame == "site"
    bands = materials.plain(source.get("mmxrt_bands"))
    if isinstance(bands, str):
        scene.bands = bands
    elif bands is not None:
        scene.bands = scene_toml.toml_text.value({"centres_um": [float(x) for x in (bands if isinstance(bands, list) else [bands])]})
    more = bpy.data.texts.get("mmxrt.toml")
    scene.more = more.as_string() if more else ""


def _camera(graph, source, scene, unit_m):
    """The camera that renders."""
    if source.camera is None:
        raise ValueError("the scene has no camera")
    own = source.camera.evaluated_get(graph)
    data = own.data
    if data.type != "PERSP":
        raise ValueError(f"the camera is {data.type}: only perspective cameras are carried over")
    matrix = [list(row) for row in own.matrix_world]
    if camera.is_mirrored(matrix):
        scene.note("approximated", "camera", "its object is mirrored: the image is not, as with a scale of 1")
    scene.camera_to_world = camera.unscaled(matrix)
    for row in scene.camera_to_world[:3]:
        row[3] *= unit_m
    if data.dof.use_dof:
        scene.note("dropped", "camera", "its depth of field")
    render = source.render
    samples, lines = camera.resolution(render.resolution_x, render.resolution_y, render.resolution_percentage)
    aspect = float(render.pixel_aspect_y) / float(render.pixel_aspect_x)
    scene.sensor = camera.lens(
        samples, lines, float(data.lens), float(data.sensor_width), float(data.sensor_height), data.sensor_fit,
        (float(data.shift_x), float(data.shift_y)), aspect,
    )
    if render.use_border:
        scene.note("dropped", "render", "its border: all of the image is taken")


def _lights(graph, source, scene):
    """The brightest Sun, further ones as lamps; what else lights is told."""
    suns = []
    for instance in graph.object_instances:
        own = instance.object
        if own.type != "LIGHT" or not instance.show_self:
            continue
        light = own.data
        if light.type != "SUN":
            scene.note("dropped", f"lamp {own.name!r}", f"a {light.type.lower()} lamp: light comes from a Sun, in parallel")
            continue
        irradiance = float(light.energy) * 2.0 ** float(getattr(light, "exposure", 0.0)) * float(obj.luminance(list(light.color)))
        # Light goes along -z.
        direction = [float(instance.matrix_world[i][2]) for i in range(3)]
        distance = light.get("mmxrt_distance_au", own.get("mmxrt_distance_au"))
        if len(set(light.color)) > 1:
            scene.note("approximated", f"lamp {own.name!r}", "its colour: only its luminance counts")
        suns.append((distance is not None, irradiance, own.name, direction, float(light.angle), distance))
    if not suns:
        raise ValueError("the scene has no Sun: add a lamp of that kind")
    suns.sort(key=lambda sun: sun[:2], reverse=True)
    _, irradiance, _, direction, angle, distance = suns[0]
    scene.sun = scene_toml.sun(direction, irradiance, angle, distance)
    taken = set()
    for _, irradiance, name, direction, angle, _ in suns[1:]:
        if angle > 0.0:
            scene.note("approximated", f"lamp {name!r}", "its disc: a point far away")
        scene.lamps.append({"name": scene_toml.unique(name, taken), "direction": direction, "irradiance": irradiance})
    world = source.world
    if world is not None and _is_lit(world):
        scene.note("dropped", "world", "its light: the sky is black")


def _is_lit(world):
    """Whether a world sends any light."""
    tree = world.node_tree
    if tree is None or (bpy.app.version < (5, 0, 0) and not world.use_nodes):
        return max(world.color) > 0.0
    for node in tree.nodes:
        if node.type == "BACKGROUND":
            colour, strength = node.inputs["Color"], node.inputs["Strength"]
            is_dark = not colour.is_linked and max(list(colour.default_value)[:3]) == 0.0
            if not is_dark and (strength.is_linked or strength.default_value > 0.0):
                return True
        elif node.type not in ("OUTPUT_WORLD", "FRAME", "REROUTE"):
            return True
    return False


class Shared:
    """A mesh, and where it stands."""

    def __init__(self, name, mesh):
        self.name, self.mesh, self.matrices = name, mesh, []


def _meshes(graph, collection, scene, unit_m):
    """All that renders as triangles; the same mesh in several places once, with a list of them."""
    shared = {}
    chosen = None if collection is None else {own.name_full for own in collection.all_objects}
    known_materials, known = {}, {}
    for instance in graph.object_instances:
        own = instance.object
        if not instance.show_self or own.type == "LIGHT":
            continue
        if own.type != "MESH":
            if own.type not in UNSEEN and own.type not in WITH_MESH:
                scene.note("dropped", f"object {own.name!r}", f"{own.type.lower()}: it has no triangles")
            continue
        if chosen is not None and (instance.parent or own).name_full not in chosen and own.name_full not in chosen:
            continue
        if getattr(own, "is_holdout", False) or getattr(own, "is_shadow_catcher", False) or not getattr(own, "visible_camera", True):
            scene.note("approximated", f"object {own.name!r}", "a holdout, shadow catcher, or hidden from the camera: it is seen as any other")
        seen = _glance(own)
        if seen not in known:
            key, mesh = _triangles(own, known_materials, scene)
            known[seen] = key
            if mesh is not None:
                shared.setdefault(key, Shared(own.name, mesh))
        key = known[seen]
        if key is None:
            continue
        matrix = np.array([list(row) for row in instance.matrix_world], float)
        if np.linalg.det(matrix[:3, :3]) == 0.0:
            scene.note("dropped", f"object {own.name!r}", "is flattened by a scale of 0")
            continue
        matrix[:3] *= unit_m
        shared[key].matrices.append(matrix)
    eye = [row[3] for row in scene.camera_to_world[:3]]
    for one in shared.values():
        if len(one.matrices) == 1:
            mesh = one.mesh.placed(one.matrices[0])
            scene.objects.append((one.name, mesh))
            if obj.is_seen_from_behind(mesh, eye):
                scene.note("approximated", f"object {one.name!r}", "an open sheet, seen from behind: its inner side is black")
        elif one.matrices:
            scene.instanced.append((one.name, one.mesh, np.array(one.matrices)))
    _dictionary(known_materials, scene)


def _glance(own):
    """What tells meshes apart at little cost: tens of thousands of rocks share one. Its place in memory alone does not, as a mesh may be gone by the next instance."""
    mesh = own.data
    vertices = _read(mesh.vertices, "co", np.empty(3 * len(mesh.vertices), np.float32))
    names = [slot.material.name_full if slot.material else "" for slot in own.material_slots]
    return mesh.as_pointer(), len(mesh.polygons), len(mesh.loops), tuple(names), hashlib.sha1(vertices.tobytes()).digest()


def _triangles(own, known_materials, scene):
    """A key that is the same for what looks the same, and the mesh; `None` twice of nothing."""
    mesh = own.to_mesh()
    if mesh is None:
        return None, None
    try:
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        if count == 0:
            return None, None
        read = lambda of, name, dtype, size: _read(of, name, np.empty(size, dtype))
        vertices = read(mesh.vertices, "co", np.float32, 3 * len(mesh.vertices)).reshape(-1, 3)
        triangles = read(mesh.loop_triangles, "vertices", np.int32, 3 * count).reshape(-1, 3)
        loops = read(mesh.loop_triangles, "loops", np.int32, 3 * count).reshape(-1, 3)
        slots = read(mesh.loop_triangles, "material_index", np.int32, count)
        if read(mesh.loop_triangles, "use_smooth", bool, count).any():
            scene.note("approximated", f"object {own.name!r}", "shaded smooth: facets are flat")
        # What an object's slots hold goes before what its mesh has.
        given = [slot.material for slot in own.material_slots] or list(mesh.materials) or [None]
        names, index = [], np.zeros(len(given), np.int64)
        for i, material in enumerate(given):
            name = materials.name_of(material)
            if name not in known_materials:
                original = None if material is None else material.original
                known_materials[name] = (original, None if original is None else materials.look(original, scene.note))
            elif known_materials[name][0] != (None if material is None else material.original):
                scene.note("approximated", f"material {name!r}", "several materials have this name: one entry serves all")
            if name not in names:
                names.append(name)
            index[i] = names.index(name)
        slots = np.clip(slots, 0, len(given) - 1)
        material = index[slots]
        uv = _uv(mesh, names, known_materials, material, loops)
        for i, name in enumerate(list(names)):
            found = known_materials[name][1]
            if found is not None and found.attribute is not None:
                colours = _colours(mesh, found.attribute, triangles, loops, material == i)
                if colours is None:
                    scene.note("approximated", f"object {own.name!r}", f"has no colour attribute {found.attribute!r}: the colour of {name!r}")
                    continue
                own_index, keys = obj.colour_keys(colours)
                material[material == i] = own_index + len(names)
                names += keys
                for key in keys:
                    known_materials.setdefault(key, (materials.of_colour(key), None))
        hashed = hashlib.sha256(repr(names).encode())
        for array in (vertices, triangles, material, uv):
            hashed.update(b"" if array is None else np.ascontiguousarray(array).tobytes())
        return hashed.digest(), obj.Mesh(vertices, triangles, material, names, uv)
    finally:
        own.to_mesh_clear()


def _read(of, name, array):
    of.foreach_get(name, array)
    return array


def _uv(mesh, names, known_materials, material, loops):
    """Texture coordinates of triangles' corners: of each material by the UV map that its image follows, else by the one that renders take."""
    if not mesh.uv_layers:
        return None
    of_layer = {}

    def of(name):
        layer = mesh.uv_layers.get(name) if name else None
        layer = layer or next((layer for layer in mesh.uv_layers if layer.active_render), mesh.uv_layers[0])
        if layer.name not in of_layer:
            of_layer[layer.name] = _read(layer.data, "uv", np.empty(2 * len(mesh.loops), np.float32)).reshape(-1, 2)[loops]
        return of_layer[layer.name]

    uv = of("").copy()
    for i, name in enumerate(names):
        found = known_materials[name][1]
        if found is not None and found.uv_map:
            uv[material == i] = of(found.uv_map)[material == i]
    return uv


def _colours(mesh, name, triangles, loops, chosen):
    """Linear colours of triangles, the mean of their corners'; `None` if the mesh has no such attribute."""
    layers = mesh.color_attributes
    layer = layers.get(name) if name else None
    if layer is None and not name and len(layers):
        layer = layers[max(layers.render_color_index, 0)]
    if layer is None:
        return None
    colours = _read(layer.data, "color", np.empty(4 * len(layer.data), np.float32)).reshape(-1, 4)[:, :3]
    corners = triangles if layer.domain == "POINT" else loops
    return colours[corners[chosen]].astype(float).mean(axis=1)


def _dictionary(known, scene):
    """Entries of all materials that are used, and of those that their mixtures name."""
    used = set()
    for mesh in [mesh for _, mesh in scene.objects] + [mesh for _, mesh, _ in scene.instanced]:
        used.update(mesh.names[i] for i in np.unique(mesh.material))
    by_name = {materials.name_of(material): material for material in bpy.data.materials}
    open_names = sorted(used)
    while open_names:
        name = open_names.pop(0)
        if name in scene.materials:
            continue
        material, found = known.get(name) or (by_name.get(name), None)
        if material is None and name not in known:
            raise ValueError(f"a mixture has {name!r}, which no material in the file is called: Blender saves those that no mesh uses only with a fake user")
        if material is None and name.startswith("#"):
            scene.materials[name] = {"reflectance": float(np.clip(obj.luminance(obj.colour_of_key(name)), 0.0, 1.0))}
            continue
        if material is not None and found is None:
            found = materials.look(material, scene.note)
        scene.materials[name] = materials.entry(material, found, scene)
        mixture = scene.materials[name].get("mixture")
        if isinstance(mixture, dict):
            open_names += sorted(mixture)
    if len([name for name in scene.materials if name.startswith("#")]) > 256:
        scene.note("approximated", "vertex colours", f"{len(scene.materials)} colours are as many materials")
