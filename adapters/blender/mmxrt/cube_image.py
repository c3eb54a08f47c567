"""Cubes of mmxrt in Blender: as images, beside Blender's own render, and as textures that the camera casts onto meshes."""

import os

import bpy
import numpy as np

from . import camera, envi


def image(path, bands=None, name=None):
    """An image of one band or three (numbers from 0) of a cube, in its own unit; by default the first, or the last, middle and first of three and more."""
    cube = envi.Cube(path)
    count = len(cube.bands)
    if bands is None:
        bands = 0 if count < 3 else (count - 1, count // 2, 0)
    pixels = cube.image(bands)
    lines, samples = pixels.shape[:2]
    made = bpy.data.images.new(name or os.path.splitext(os.path.basename(path))[0], samples, lines, alpha=True, float_buffer=True)
    made.colorspace_settings.name = "Non-Color"
    made.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    made.update()
    made.pack()
    made["mmxrt_unit"] = cube.unit
    if cube.wavelength_um:
        chosen = [bands] if isinstance(bands, int) else list(bands)
        made["mmxrt_wavelength_um"] = [cube.wavelength_um[band] for band in chosen]
    return made


def cast(picture, objects, scene):
    """Puts an image onto meshes as the scene's camera sees them: a UV map `mmxrt`, and a material that shines with it.

    Points behind the camera, and what the image does not reach, have coordinates outside of it, where it is black.
    """
    own = scene.camera
    if own is None or own.data.type != "PERSP":
        raise ValueError("an image is cast by the scene's camera, in perspective")
    matrix = camera.unscaled([list(row) for row in own.matrix_world])
    data, render = own.data, scene.render
    samples, lines = camera.resolution(render.resolution_x, render.resolution_y, render.resolution_percentage)
    keys = camera.lens(
        samples, lines, float(data.lens), float(data.sensor_width), float(data.sensor_height), data.sensor_fit,
        (float(data.shift_x), float(data.shift_y)), float(render.pixel_aspect_y) / float(render.pixel_aspect_x),
    )
    material = _shining(picture)
    for target in objects:
        if target.type != "MESH":
            continue
        mesh = target.data
        layer = mesh.uv_layers.get("mmxrt") or mesh.uv_layers.new(name="mmxrt", do_init=False)
        if layer is None:
            raise ValueError(f"{target.name!r} has no room for another UV map")
        local = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", local)
        to_world = np.array([list(row) for row in target.matrix_world], float)
        world = local.reshape(-1, 3).astype(float) @ to_world[:3, :3].T + to_world[:3, 3]
        uv = np.full((len(world), 2), -1.0)
        for i, point in enumerate(world):
            sample, line, depth = camera.pixel(matrix, keys, point)
            if depth > 0.0:
                uv[i] = sample / samples, 1.0 - line / lines
        corners = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        layer.data.foreach_set("uv", uv[corners].astype(np.float32).ravel())
        mesh.materials.clear()
        mesh.materials.append(material)


def _shining(picture):
    """A material that shows an image by the UV map `mmxrt`, as it is, unlit."""
    material = bpy.data.materials.new(f"mmxrt {picture.name}")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output, shine = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeEmission")
    texture, map_ = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeUVMap")
    texture.image, texture.extension, texture.interpolation = picture, "CLIP", "Closest"
    map_.uv_map = "mmxrt"
    links.new(map_.outputs["UV"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], shine.inputs["Color"])
    links.new(shine.outputs["Emission"], output.inputs["Surface"])
    for i, node in enumerate((map_, texture, shine, output)):
        node.location = (300 * i, 0)
    return material
