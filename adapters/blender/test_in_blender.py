"""The add-on in a real Blender: a scene with all that can go wrong is made, exported, simulated, and compared with Blender's own numbers and with Cycles.

    python test_in_blender.py MMXRT FOLDER                               with PyPI's `bpy`
    blender -b --factory-startup --python test_in_blender.py -- MMXRT FOLDER

`MMXRT` is the program. Prints a line for each check, with the number that it is about, and ends with code 1 if one fails.
"""

import math
import os
import subprocess
import sys
import traceback

import bpy
import mathutils
import numpy as np
from bpy_extras.object_utils import world_to_camera_view

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import mmxrt  # noqa: E402
from mmxrt import cube_image, engine, envi  # noqa: E402

MMXRT, FOLDER = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
ORIGIN = [-2743.5946, 11860.036, 0.51269]
FAILED = []


def check(what, off, limit):
    """Says how far off something is, and whether that is within its limit."""
    good = off <= limit
    print(f"{'ok    ' if good else 'FAILED'} {what}: {off:.3g} (at most {limit:.3g})", flush=True)
    if not good:
        FAILED.append(what)


# The scene.

def material(name, grey, **properties):
    """A Lambert surface."""
    made = bpy.data.materials.new(name)
    # Parts of mixtures, and entries of colours, are used by no mesh.
    made.use_fake_user = True
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    output, diffuse = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (grey, grey, grey, 1.0)
    diffuse.inputs["Roughness"].default_value = 0.0
    links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    for key, value in properties.items():
        made[key] = value
    return made


def add(name, mesh, place=(0, 0, 0), turn=(0, 0, 0), scale=(1, 1, 1), of=None, collection=None):
    """An object, with a material of its mesh."""
    made = bpy.data.objects.new(name, mesh)
    made.location, made.rotation_euler, made.scale = place, turn, scale
    if of is not None and not mesh.materials:
        mesh.materials.append(of)
    (collection or bpy.context.scene.collection).objects.link(made)
    return made


def mesh_of(name, make, **how):
    """A primitive as a mesh."""
    import bmesh
    shape = bmesh.new()
    getattr(bmesh.ops, make)(shape, calc_uvs=True, **how) if make != "create_icosphere" else bmesh.ops.create_icosphere(shape, **how)
    made = bpy.data.meshes.new(name)
    shape.to_mesh(made)
    shape.free()
    return made


def grid(name, size, count, height):
    """A sheet of quads with texture coordinates over all of it."""
    steps = np.linspace(-size / 2, size / 2, count + 1)
    vertices = [(x, y, height(x, y)) for y in steps for x in steps]
    faces = [
        (row * (count + 1) + i, row * (count + 1) + i + 1, (row + 1) * (count + 1) + i + 1, (row + 1) * (count + 1) + i)
        for row in range(count) for i in range(count)
    ]
    made = bpy.data.meshes.new(name)
    made.from_pydata(vertices, [], faces)
    layer = made.uv_layers.new(name="UVMap")
    for loop in made.loops:
        x, y, _ = vertices[loop.vertex_index]
        layer.data[loop.index].uv = (x / size + 0.5, y / size + 0.5)
    return made


def scatter(target, rock):
    """Geometry nodes that put a rock on each vertex."""
    group = bpy.data.node_groups.new("scatter", "GeometryNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        group.inputs.new("NodeSocketGeometry", "Geometry")
        group.outputs.new("NodeSocketGeometry", "Geometry")
    node = group.nodes.new
    source, sink, put, info = node("NodeGroupInput"), node("NodeGroupOutput"), node("GeometryNodeInstanceOnPoints"), node("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = rock
    put.inputs["Scale"].default_value = (0.4, 0.4, 0.4)
    group.links.new(source.outputs[0], put.inputs["Points"])
    group.links.new(info.outputs["Geometry"], put.inputs["Instance"])
    group.links.new(put.outputs["Instances"], sink.inputs[0])
    target.modifiers.new("scatter", "NODES").node_group = group


def make_scene():
    """A terrain, rocks in all the ways that Blender has them, and what must not be seen."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    # A table of a reflectance that is the same at all wavelengths, which Cycles can have too.
    with open(os.path.join(FOLDER, "blue unit.csv"), "w", encoding="utf-8") as file:
        file.write("wavelength_um,reflectance\n0.2,0.3\n50,0.3\n")
    ground = material("regolith", 0.3, spectral_material="blue unit", mmxrt_reflectance=os.path.join(FOLDER, "blue unit.csv"))
    rock = material("red rock", 0.5)
    rock["mmxrt_mixture"] = {"dark": 0.5, "light": 0.5}
    material("dark", 0.2, mmxrt_reflectance=0.2)
    light = material("light", 0.8, mmxrt_reflectance=0.8, mmxrt_emissivity=0.5, mmxrt_thermal_inertia=50)

    terrain = add("terrain", grid("terrain", 20.0, 12, lambda x, y: 0.6 * math.sin(0.7 * x) * math.cos(0.5 * y)), of=ground)
    subsurf = terrain.modifiers.new("subsurf", "SUBSURF")
    subsurf.levels, subsurf.render_levels, subsurf.subdivision_type = 0, 2, "CATMULL_CLARK"

    # Linked rocks, one mirrored, with a scale of their own on each axis.
    stone = mesh_of("stone", "create_icosphere", subdivisions=1, radius=0.6)
    random = np.random.default_rng(1)
    for i in range(24):
        x, y = random.uniform(-8, 8, 2)
        scale = random.uniform(0.3, 1.2, 3) * (1, 1, -1 if i == 5 else 1)
        add(f"rock {i}", stone, (x, y, 0.4), random.uniform(0, 6, 3), scale, of=rock)
    # Another material on the object goes before that of the shared mesh.
    other = add("rock in light", stone, (3, 3, 1.2))
    other.material_slots[0].link = "OBJECT"
    other.material_slots[0].material = light

    # A modifier, below a parent that shears it.
    box = mesh_of("box", "create_cube", size=1.0)
    parent = add("parent", mesh_of("post", "create_cube", size=0.8), (-5, 4, 1), (0.2, 0.1, 0.5), (1.5, 0.5, 1.0), of=light)
    child = add("child", box, (1.5, 0, 0), (0.3, 0.7, 0.2), (0.6, 1.4, 0.8), of=rock)
    child.parent = parent
    array = child.modifiers.new("array", "ARRAY")
    array.count, array.relative_offset_displace = 3, (1.3, 0.0, 0.2)

    # Instances of a collection, and of geometry nodes.
    pile = bpy.data.collections.new("pile")
    add("pile rock", stone, (0, 0, 0), collection=pile)
    add("pile box", box, (1.0, 0, 0.2), scale=(0.5, 0.5, 0.5), collection=pile)
    for i, place in enumerate([(5, -5, 1), (6, 5, 1)]):
        empty = bpy.data.objects.new(f"pile {i}", None)
        empty.instance_type, empty.instance_collection, empty.location, empty.rotation_euler = "COLLECTION", pile, place, (0, 0, i)
        scene.collection.objects.link(empty)
    pebble = add("pebble", mesh_of("pebble", "create_icosphere", subdivisions=1, radius=0.5), (0, 0, 0), of=rock)
    pebble.hide_render = True
    scatter(add("field", grid("field", 4.0, 4, lambda x, y: 0.0), (-5, -5, 1.5), (0.1, 0.2, 0.3)), pebble)

    # Colours of faces as materials, in steps of sRGB; one of them has an entry.
    coloured = mesh_of("coloured", "create_cube", size=1.5)
    colours = coloured.color_attributes.new("paint", "BYTE_COLOR", "CORNER")
    greys = [0x30, 0x60, 0x90, 0xb0, 0xd0, 0xf0]
    for polygon in coloured.polygons:
        grey = greys[polygon.index] / 255.0
        for loop in polygon.loop_indices:
            colours.data[loop].color_srgb = (grey, grey, grey, 1.0)
    paint = material("paint", 0.5)
    source = paint.node_tree.nodes.new("ShaderNodeVertexColor")
    source.layer_name = "paint"
    paint.node_tree.links.new(source.outputs["Color"], next(n for n in paint.node_tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
    add("coloured", coloured, (4, 0, 1.6), (0.3, 0.2, 0.6), of=paint)
    material("#b0b0b0", 0.5, mmxrt_reflectance=float(((0xb0 / 255 + 0.055) / 1.055) ** 2.4))

    # An image on a sheet.
    picture = bpy.data.images.new("chart", 8, 8, float_buffer=True)
    picture.colorspace_settings.name = "Non-Color"
    values = 0.1 + 0.8 * np.random.default_rng(2).random((8, 8))
    picture.pixels.foreach_set(np.repeat(values[..., None], 4, axis=2).astype(np.float32).ravel())
    picture.pack()
    chart = material("chart", 0.5)
    node = chart.node_tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation, node.extension = picture, "Closest", "REPEAT"
    chart.node_tree.links.new(node.outputs["Color"], next(n for n in chart.node_tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
    add("chart", grid("chart", 5.0, 1, lambda x, y: 0.0), (1, -6, 1.5), (0.2, -0.1, 0.3), of=chart)

    # A curve, and a mesh without a material.
    curve = bpy.data.curves.new("tube", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution, curve.use_fill_caps = "3D", 0.2, 1, True
    spline = curve.splines.new("POLY")
    spline.points.add(2)
    for point, co in zip(spline.points, [(-2, 6, 1.5, 1), (0, 7, 2.0, 1), (2, 6, 1.5, 1)]):
        point.co = co
    spline.use_smooth = False
    curve.materials.append(light)
    scene.collection.objects.link(bpy.data.objects.new("tube", curve))
    add("bare", mesh_of("bare", "create_cube", size=1.0), (-2, 2, 2.0), (0.4, 0.5, 0.1))

    # Hidden from renders, and hidden from viewports alone.
    add("hidden", mesh_of("hidden", "create_cube", size=6.0), (0, 0, 5)).hide_render = True
    shown = add("shown", mesh_of("shown", "create_cube", size=1.0), (7, -1, 1.2), of=rock)
    shown.hide_viewport = True

    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 2.5, 0.0
    lamp = bpy.data.objects.new("sun", sun)
    lamp.rotation_euler = (0.6, 0.3, 0.5)
    scene.collection.objects.link(lamp)
    eye = bpy.data.cameras.new("eye")
    eye.lens, eye.shift_x, eye.shift_y, eye.clip_end = 35.0, 0.1, -0.05, 1000.0
    own = bpy.data.objects.new("eye", eye)
    own.location = (9.0, -16.0, 24.0)
    own.rotation_euler = mathutils.Vector((-9.0, 16.0, -24.0)).to_track_quat("-Z", "Y").to_euler()
    own.scale = (2.0, 2.0, 2.0)
    scene.collection.objects.link(own)
    scene.camera = own
    scene["origin_m"] = ORIGIN
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 96, 72, 100
    return scene


# What Blender itself has.

def rendered_triangles(scene):
    """Corners of all triangles that are rendered [n, 3, 3], by Blender's own matrices and vertices, each product in f64; materials' names."""
    def read(graph):
        corners, names = [], []
        for instance in graph.object_instances:
            own = instance.object
            # As Cycles does: the surface of a curve stands beside it, as a mesh.
            if not instance.show_self or own.type != "MESH":
                continue
            mesh = own.to_mesh()
            mesh.calc_loop_triangles()
            matrix = np.array([list(row) for row in instance.matrix_world], float)
            is_mirrored = instance.matrix_world.determinant() < 0
            for triangle in mesh.loop_triangles:
                order = (0, 2, 1) if is_mirrored else (0, 1, 2)
                local = [mesh.vertices[triangle.vertices[k]].co for k in order]
                corners.append([[sum(matrix[i][k] * co[k] for k in range(3)) + matrix[i][3] for i in range(3)] for co in local])
                slot = own.material_slots[triangle.material_index].material if len(own.material_slots) else None
                names.append(slot.name if slot else "")
            own.to_mesh_clear()
        return np.array(corners), names
    return engine.of_render(scene, read)


# What was written.

def written_triangles(folder):
    """The same of a folder, by an OBJ reader of a few lines; texture coordinates too."""
    import re
    text = open(os.path.join(folder, "scene.toml"), encoding="utf-8").read()
    corners, names, places = [], [], 0
    for block in text.split("[[mesh]]")[1:]:
        block = block.split("\n[")[0]
        mesh = re.search(r'file = "(.*)"', block).group(1)
        instances = re.search(r'instances = "(.*)"', block)
        matrices = [np.eye(4)]
        if instances:
            rows = np.loadtxt(os.path.join(folder, instances.group(1)), delimiter=",", skiprows=1, ndmin=2)
            matrices = [np.vstack([np.column_stack([row[3:].reshape(3, 3), row[:3]]), [0, 0, 0, 1]]) for row in rows]
            places += len(matrices)
        vertices, faces, own, current = [], [], [], ""
        for line in open(os.path.join(folder, mesh), encoding="utf-8"):
            word, _, rest = line.rstrip("\n").partition(" ")
            if word == "v":
                vertices.append([float(x) for x in rest.split()])
            elif word == "usemtl":
                current = rest
            elif word == "f":
                faces.append([int(corner.split("/")[0]) - 1 for corner in rest.split()])
                own.append(current)
        local = np.array(vertices)[np.array(faces)]
        for matrix in matrices:
            world = local @ matrix[:3, :3].T + matrix[:3, 3]
            corners.append(world[:, [0, 2, 1]] if np.linalg.det(matrix[:3, :3]) < 0 else world)
            names += own
    return np.concatenate(corners), names, places


def check_geometry(scene, folder):
    theirs, their_names = rendered_triangles(scene)
    ours, our_names, places = written_triangles(folder)
    check(f"triangles, of {len(theirs)} that are rendered, too many or too few", abs(len(theirs) - len(ours)), 0)
    check("instances that are not kept as such, of 24 rocks, 25 pebbles, 2 x 2 of a pile, and 1", abs(places - (24 + 25 + 2 + 3)), 4)
    # The same triangles in another order: by their middles.
    def sorted_by_place(triangles):
        return np.lexsort(np.round(triangles.reshape(len(triangles), 9) * 1e5).T)
    a, b = sorted_by_place(theirs), sorted_by_place(ours)
    check("positions, m, against the dependency graph of a render", float(np.abs(theirs[a] - ours[b]).max()), 1e-9)
    wanted = {"regolith": "blue unit", "": "default"}
    paint = {"paint"}
    wrong = [
        (t, o) for t, o in zip((their_names[i] for i in a), (our_names[i] for i in b))
        if not (o.startswith("#") if t in paint else o == wanted.get(t, t))
    ]
    check("triangles of another material", len(wrong), 0)


def mmxrt_run(*arguments):
    run = subprocess.run([MMXRT, *arguments], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"mmxrt {' '.join(arguments)}: {run.stdout}{run.stderr}")
    return run.stdout


def check_camera(scene):
    """Markers' pixels by `mmxrt locate` against world_to_camera_view, for three fits and three shapes of the image, with shifts."""
    worst, worst_ours = 0.0, 0.0
    own, data, render = scene.camera, scene.camera.data, scene.render
    kept = (data.sensor_fit, render.resolution_x, render.resolution_y)
    # `world_to_camera_view` takes pixels for square.
    for fit in ("AUTO", "HORIZONTAL", "VERTICAL"):
        for size in ((96, 72), (64, 64), (60, 90)):
            data.sensor_fit, render.resolution_x, render.resolution_y = fit, *size
            data.sensor_width, data.sensor_height = 32.0, 18.0
            bpy.context.view_layer.update()
            folder = os.path.join(FOLDER, "camera")
            engine.export(scene, folder)
            points = [mathutils.Vector(p) for p in ((0, 0, 0), (3, -2, 1), (-4, 5, 0.5))]
            asked = os.path.join(FOLDER, "points.csv")
            with open(asked, "w", encoding="utf-8") as file:
                file.write("x_m,y_m,z_m\n")
                for point in points:
                    file.write(",".join(repr(o + p) for o, p in zip(ORIGIN, point)) + "\n")
            found = os.path.join(FOLDER, "pixels.csv")
            mmxrt_run("locate", os.path.join(folder, "scene.toml"), "--points", asked, "-o", found, "--force")
            lines = [line.split(",") for line in open(found, encoding="utf-8").read().splitlines() if not line.startswith("#")]
            columns = [lines[0].index(name) for name in ("sample", "line")]
            for row, point in zip(lines[1:], points):
                u, v, _ = world_to_camera_view(scene, own, point)
                sample, line = (float(row[i]) for i in columns)
                worst = max(worst, abs(sample - u * size[0]), abs(line - (1 - v) * size[1]))
    data.sensor_fit, render.resolution_x, render.resolution_y = kept
    data.sensor_width, data.sensor_height = 36.0, 24.0
    bpy.context.view_layer.update()
    check("markers, pixels, against world_to_camera_view: 3 fits x 3 shapes, shifted", worst, 1e-3)


def cycles(scene, samples, seed):
    """An image of Cycles, top line first."""
    render = scene.render
    render.engine = "CYCLES"
    own = scene.cycles
    own.samples, own.seed, own.use_adaptive_sampling, own.use_denoising = samples, seed, False, False
    own.max_bounces, own.light_sampling_threshold, own.sample_clamp_direct, own.sample_clamp_indirect = 0, 0.0, 0.0, 0.0
    own.pixel_filter_type, own.filter_width = "BOX", 1.0
    own.device = "CPU"
    render.filter_size = 1.0
    render.film_transparent = True
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = os.path.join(FOLDER, f"cycles_{seed}.exr")
    bpy.ops.render.render(write_still=True)
    return pixels_of(render.filepath)


def pixels_of(path):
    """The pixels of a file, top line first [line, sample, RGBA]."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1].astype(float)


def check_image(scene, folder):
    product = os.path.join(FOLDER, "product")
    mmxrt_run("simulate", os.path.join(folder, "scene.toml"), "-o", product, "--force", "--quiet", "--model", "sunlight")
    ours = np.asarray(envi.Cube(os.path.join(product, "cube.hdr")).bands[0], float)
    # What has no material is no Lambert surface in Cycles, but a Principled one.
    planes = envi.Cube(os.path.join(product, "backplanes.hdr"))
    is_lambert = np.asarray(planes.bands[planes.names.index("ABUNDANCE default")]) == 0.0
    check("share of the image without a material", float(1.0 - is_lambert.mean()), 0.01)
    # Two halves tell the noise of their mean.
    samples = int(os.environ.get("MMXRT_CYCLES_SAMPLES", "2048"))
    one, two = (np.where(is_lambert, cycles(scene, samples, seed)[..., 0], 0.0) for seed in (1, 2))
    theirs, whole, ours = 0.5 * (one + two), ours, np.where(is_lambert, ours, 0.0)
    mean = theirs.mean()
    noise = float(np.sqrt(np.mean((one - two) ** 2))) / 2 / mean
    rms = float(np.sqrt(np.mean((ours - theirs) ** 2))) / mean
    check("sum of the image over that of Cycles, less 1", abs(float(ours.sum() / theirs.sum()) - 1), 1e-4)
    check(f"rms of the difference from Cycles over the mean, whose own noise is {noise:.3g}", rms, 1.5 * noise)
    worst = np.unravel_index(np.abs(ours - theirs).argmax(), ours.shape)
    print(f"       worst pixel {worst}: {ours[worst]:.6g}, Cycles {theirs[worst]:.6g}", flush=True)
    return product, whole


def check_engine(scene, folder):
    """The engine's render is the cube of what it would export."""
    product = os.path.join(FOLDER, "product_of_engine")
    mmxrt_run("simulate", os.path.join(folder, "scene.toml"), "-o", product, "--force", "--quiet")
    cube = np.asarray(envi.Cube(os.path.join(product, "cube.hdr")).bands[0], float)
    scene.render.engine = "MMXRT"
    scene.render.filepath = os.path.join(FOLDER, "engine.exr")
    bpy.ops.render.render(write_still=True)
    check("pixels of the engine's render, against the cube", float(np.abs(pixels_of(scene.render.filepath)[..., 0] - cube).max()), 0.0)


def check_import(scene, product, ours):
    """The cube as an image, and cast onto the terrain: the camera then sees again what it saw."""
    picture = cube_image.image(os.path.join(product, "cube.hdr"))
    pixels = np.empty(ours.size * 4, np.float32)
    picture.pixels.foreach_get(pixels)
    back = pixels.reshape(*ours.shape, 4)[::-1, :, 0]
    check("pixels of the imported image, against the cube", float(np.abs(back - ours).max()), 0.0)
    # The same by what users press.
    product = os.path.join(FOLDER, "of_operator")
    result = bpy.ops.mmxrt.simulate(options="--model sunlight", folder=product)
    cube = np.asarray(envi.Cube(os.path.join(product, "product", "cube.hdr")).bands[0], float)
    check("pixels of the operator's cube, against the cube", float(np.abs(cube - ours).max()) + (result != {"FINISHED"}), 0.0)
    for own in bpy.data.objects:
        own.select_set(own.name == "chart")
    result = bpy.ops.mmxrt.import_cube(filepath=os.path.join(product, "product", "cube.hdr"), bands=(1, 1, 1), as_texture=True)
    cast = bpy.data.objects["chart"].data
    check("cubes that are not cast by the operator", int(result != {"FINISHED"} or "mmxrt" not in cast.uv_layers or "mmxrt" not in cast.materials[0].name), 0)
    terrain = bpy.data.objects["terrain"]
    cube_image.cast(picture, [terrain], scene)
    layer = terrain.data.uv_layers["mmxrt"]
    worst = 0.0
    for loop in list(terrain.data.loops)[::17]:
        point = terrain.matrix_world @ terrain.data.vertices[loop.vertex_index].co
        u, v, _ = world_to_camera_view(scene, scene.camera, point)
        uv = layer.data[loop.index].uv
        worst = max(worst, abs(uv[0] - u), abs(uv[1] - v))
    check("texture coordinates of a cast image, against world_to_camera_view", worst, 1e-5)


def nearest(a, b):
    """The largest distance of the points of one list from the nearest of another."""
    from mathutils.kdtree import KDTree
    tree = KDTree(len(b))
    for i, point in enumerate(b):
        tree.insert(point, i)
    tree.balance()
    return max(tree.find(point)[2] for point in a)


def check_gltf(scene, folder):
    """glTF there and back by Blender's own importer and exporter: places, texture coordinates, names, origin."""
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    # Debian's importer wants a name that its NumPy has no longer.
    if not hasattr(np, "bool"):
        np.bool = bool
    # Blender's objects of one primitive each: base meshes, without modifiers.
    chosen = [bpy.data.objects[name] for name in ("terrain", "chart", "shown")]
    bpy.data.objects["shown"].hide_viewport = False
    for own in bpy.data.objects:
        own.select_set(own in chosen)
    path = os.path.join(FOLDER, "of_blender.glb")
    bpy.ops.export_scene.gltf(filepath=path, use_selection=True, export_extras=True, export_apply=False)
    mmxrt_run("convert", path, os.path.join(FOLDER, "of_gltf", "scene.toml"), "--force")
    text = open(os.path.join(FOLDER, "of_gltf", "scene.toml"), encoding="utf-8").read()
    # Floats of custom properties are f64 there.
    check("origins of a glTF that are not the scene's", int(f"origin_m = {ORIGIN}" not in text), 0)
    names = ["blue unit", "chart", "red rock"]
    check("materials of a glTF without their spectral name", sum(f'[materials."{n}"]' not in text and f"[materials.{n}]" not in text for n in names), 0)
    lines = [line.split() for line in open(os.path.join(FOLDER, "of_gltf", "scene.obj"), encoding="utf-8")]
    ours = [[float(x) for x in line[1:]] for line in lines if line[:1] == ["v"]]
    theirs = [own.matrix_world @ vertex.co for own in chosen for vertex in own.data.vertices]
    check("places of Blender's glTF, m", max(nearest(ours, theirs), nearest(theirs, ours)), 20 * 2**-24)
    uv = sorted({tuple(float(x) for x in line[1:]) for line in lines if line[:1] == ["vt"]})
    wanted = sorted({tuple(loop.uv) for own in chosen for layer in own.data.uv_layers for loop in layer.data})
    check("texture coordinates of Blender's glTF", max(nearest([(*x, 0) for x in uv], [(*x, 0) for x in wanted]),
                                                       nearest([(*x, 0) for x in wanted], [(*x, 0) for x in uv])), 2e-7)
    # Ours, in Blender.
    path = os.path.join(FOLDER, "of_mmxrt.glb")
    mmxrt_run("convert", os.path.join(folder, "scene.toml"), path, "--force")
    before = set(bpy.data.objects)
    del scene["origin_m"]
    bpy.ops.import_scene.gltf(filepath=path)
    came = [own for own in bpy.data.objects if own not in before and own.type == "MESH"]
    points = [own.matrix_world @ vertex.co for own in came for vertex in own.data.vertices]
    corners, names, _ = written_triangles(folder)
    flat = corners.reshape(-1, 3)
    check("places of our glTF in Blender, m", max(nearest(points, flat), nearest(flat, points)), 20 * 2**-24)
    spectral = {slot.material.get("spectral_material") for own in came for slot in own.material_slots}
    check("spectral names of our glTF that are not in Blender", len(set(names) - spectral), 0)
    # Blender before 3.6 keeps no properties of scenes.
    kept = materials_plain(scene.get("origin_m"))
    check("origins of our glTF that are not in Blender", int(kept != ORIGIN and bpy.app.version >= (3, 6, 0)), 0)
    for own in came:
        bpy.data.objects.remove(own)
    scene["origin_m"] = ORIGIN


def materials_plain(of):
    return of.to_list() if hasattr(of, "to_list") else of


def check_sun(folder):
    import re
    text = open(os.path.join(folder, "scene.toml"), encoding="utf-8").read()
    block = text.split("[sun]")[1].split("\n[")[0]
    direction = np.array([float(x) for x in re.search(r"direction = \[(.*)\]", block).group(1).split(",")])
    # By its angles: z turned about x, y and z in turn.
    towards = mathutils.Euler((0.6, 0.3, 0.5)).to_matrix() @ mathutils.Vector((0, 0, 1))
    check("direction to the Sun", float(np.abs(direction / np.linalg.norm(direction) - np.array(towards)).max()), 1e-6)
    check("irradiance of the Sun", abs(float(re.search(r"irradiance = (.*)", block).group(1)) - 2.5), 0.0)


def check_installed():
    """The folder, where users have their add-ons, can be switched on and off: as an extension, or before 4.2 as an add-on."""
    name = "bl_ext.user_default.mmxrt" if bpy.app.version >= (4, 2, 0) else "mmxrt_installed"
    for _ in range(2):
        result = bpy.ops.preferences.addon_enable(module=name)
        good = result == {"FINISHED"} and name in bpy.context.preferences.addons and bpy.ops.mmxrt.export.poll()
        check(f"add-ons {name} that cannot be switched on", int(not good), 0)
        if good:
            bpy.context.preferences.addons[name].preferences.program = "/nowhere"
        bpy.ops.preferences.addon_disable(module=name)


def main():
    os.makedirs(FOLDER, exist_ok=True)
    print(f"Blender {bpy.app.version_string}, Python {sys.version.split()[0]}", flush=True)
    scene = make_scene()
    mmxrt.register()
    bpy.ops.preferences.addon_enable(module="cycles")
    # Where the engine looks for the program.
    os.environ["PATH"] = os.pathsep.join([os.path.dirname(os.path.abspath(MMXRT)), os.environ["PATH"]])
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "scene.blend"))
    folder = os.path.join(FOLDER, "scene")
    result = bpy.ops.mmxrt.export(filepath=folder)
    check("exports that ended in anything but FINISHED", int(result != {"FINISHED"}), 0)
    check_geometry(scene, folder)
    check_sun(folder)
    check_camera(scene)
    product, ours = check_image(scene, folder)
    check_engine(scene, folder)
    check_gltf(scene, folder)
    check_import(scene, product, ours)
    mmxrt.unregister()
    check_installed()
    print(f"{len(FAILED)} failed", flush=True)
    return 1 if FAILED else 0


if __name__ == "__main__":
    try:
        CODE = main()
    except Exception:
        traceback.print_exc()
        CODE = 1
    # Blender ends with 0 whatever a script does.
    sys.stdout.flush()
    os._exit(CODE)
