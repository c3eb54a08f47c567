"""Blender's materials as entries of a scene's dictionary. Reads `bpy` data, changes nothing.

Custom properties of a material: `spectral_material` is its name in the dictionary where that is not its own, as in glTF; `mmxrt_KEY` is the key KEY of its
entry, where a text may be the path of a table or, in braces, a table of TOML; `mmxrt_vertex_colours` is a colour attribute whose colours become materials, `#rrggbb`.
"""

import os

import bpy
import numpy as np

from . import obj
from .scene_toml import Table, unique
from .toml_text import Raw

# Keys whose text is the path of a table.
PATHS = ("reflectance", "emissivity", "table", "hapke", "rpv")
# Custom properties that say something else than a key.
OWN = ("vertex_colours",)
# What faces without a material look like in Blender.
UNNAMED, UNNAMED_REFLECTANCE = "default", 0.8


def name_of(material):
    """A material's name in the dictionary."""
    if material is None:
        return UNNAMED
    stated = material.get("spectral_material")
    return obj.plain_name(stated if isinstance(stated, str) and stated else material.name) or UNNAMED


def of_colour(name):
    """The material that says what a colour `#rrggbb` is made of, if one of this name says anything."""
    material = bpy.data.materials.get(name)
    return material if material is not None and any(key.startswith("mmxrt_") for key in material.keys()) else None


class Look:
    """Where a material's colour comes from: one colour, an image, or a colour attribute."""

    def __init__(self):
        self.colour = None
        self.image = None  # the node
        self.uv_map = ""
        self.attribute = None


def look(material, note):
    """How a material looks, as far as one colour, image or attribute says it."""
    found = Look()
    found.colour = list(material.diffuse_color)[:3]
    stated = material.get("mmxrt_vertex_colours")
    if isinstance(stated, str):
        found.attribute = stated
    tree = material.node_tree
    # In versions before 5.0 nodes may be switched off.
    if tree is None or (bpy.app.version < (5, 0, 0) and not material.use_nodes):
        return found
    output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL")
    shader = _source(output.inputs["Surface"]) if output else None
    socket = shader and {"BSDF_PRINCIPLED": "Base Color", "BSDF_DIFFUSE": "Color"}.get(shader.type)
    item = f"material {material.name!r}"
    if not socket:
        note("approximated", item, "its shader is neither Diffuse nor Principled: the colour of its viewport display is taken")
        return found
    if shader.type == "BSDF_PRINCIPLED":
        note("approximated", item, "Principled BSDF: only its base colour is taken, as a Lambert surface; Diffuse BSDF is one")
    elif shader.inputs["Roughness"].default_value != 0.0:
        note("approximated", item, "a rough Diffuse BSDF (Oren and Nayar): a Lambert surface, which has roughness 0")
    for unread, what in (("Displacement", "displacement"), ("Volume", "volume")):
        if output.inputs[unread].is_linked:
            note("dropped", item, f"its {what} by nodes")
    if shader.inputs["Normal"].is_linked:
        note("dropped", item, "its bumps: facets are flat")
    colour = shader.inputs[socket]
    source = _source(colour)
    found.colour = list(colour.default_value)[:3]
    if source is None:
        return found
    if source.type == "TEX_IMAGE" and source.image is not None:
        found.image = source
        found.uv_map = _uv_map(source, item, note)
    elif source.type == "VERTEX_COLOR" or (source.type == "ATTRIBUTE" and source.attribute_type == "GEOMETRY"):
        if found.attribute is None:
            found.attribute = source.layer_name if source.type == "VERTEX_COLOR" else source.attribute_name
    elif source.type == "RGB":
        found.colour = list(source.outputs[0].default_value)[:3]
    else:
        note("approximated", item, f"its colour is made by nodes ({source.name}): the colour of its viewport display is taken")
        found.colour = list(material.diffuse_color)[:3]
    return found


def _source(socket):
    """The node that feeds a socket, past reroutes; `None` if none does."""
    while socket.is_linked:
        node = socket.links[0].from_node
        if node.type != "REROUTE":
            return node
        socket = node.inputs[0]
    return None


def _uv_map(node, item, note):
    """The name of the UV map that an image follows; empty for the one that renders take."""
    source = _source(node.inputs["Vector"])
    if source is None or (source.type == "TEX_COORD" and node.inputs["Vector"].links[0].from_socket.name == "UV"):
        return ""
    if source.type == "UVMAP":
        return source.uv_map
    note("approximated", item, f"where its image lies is made by nodes ({source.name}): it is taken to follow the UV map")
    return ""


def entry(material, found, scene):
    """The entry of a material that looks like this; adds textures and tables to `scene`."""
    if material is None:
        why = f"a Lambert surface of reflectance {UNNAMED_REFLECTANCE}; Cycles adds a specular part to that grey"
        scene.note("defaulted", "what has no material", why)
        return {"reflectance": UNNAMED_REFLECTANCE}
    item = f"material {material.name!r}"
    keys = {}
    for property_name in material.keys():
        if not property_name.startswith("mmxrt_") or property_name[6:] in OWN:
            continue
        key, given = property_name[6:], plain(material[property_name])
        if isinstance(given, str) and given.strip().startswith("{"):
            given = Raw(given.strip())
        elif isinstance(given, str) and key in PATHS:
            given = _table(given, material, item, scene)
        keys[key] = given
    stated = any(key in keys for key in ("reflectance", "mixture", "preset", "table"))
    if found.image is not None and "mixture" not in keys:
        image, texture = _texture(found.image, item, scene)
        # With a spectrum the image varies it; alone it is the reflectance.
        texture["quantity"] = "factor" if stated else "reflectance"
        if not stated:
            keys["reflectance"] = float(np.clip(image.mean(), 0.0, 1.0))
        scene.textures[name_of(material)] = (image, texture)
    elif not stated:
        keys["reflectance"] = float(np.clip(obj.luminance(found.colour), 0.0, 1.0))
        scene.note("defaulted", item, f"reflectance {keys['reflectance']:.4f} at all wavelengths: the luminance of its colour")
    return keys


def plain(of):
    """A custom property as numbers, texts, lists and dictionaries."""
    if hasattr(of, "to_dict"):
        return {key: plain(value) for key, value in of.to_dict().items()}
    if hasattr(of, "to_list"):
        return of.to_list()
    return of


def _table(path, material, item, scene):
    """Takes a file of a table along; its name beside the scene."""
    found = bpy.path.abspath(path, library=material.library)
    if not os.path.isfile(found):
        raise FileNotFoundError(f"{item}: the table {found} is not there")
    _within(found, item, scene)
    stem, ending = os.path.splitext(os.path.basename(found))
    # Names that all systems have; instances have tables of their own.
    known = [name for name, source in scene.tables.items() if source == found]
    name = known[0] if known else f"table_{unique(stem, {os.path.splitext(n)[0].lower()[6:] for n in scene.tables})}{ending}"
    scene.tables[name] = found
    return Table(name)


def _within(path, item, scene):
    """Refuses a file outside of the folder to which an export is kept, if it is to one."""
    if scene.inside is None:
        return
    inside = os.path.realpath(scene.inside)
    if not os.path.realpath(path).startswith(os.path.join(inside, "")):
        raise ValueError(f"{item}: {path} lies outside of the file's folder: --allow-outside takes it all the same")


def _texture(node, item, scene):
    """A picture's luminance, linear, [line, sample] from the top, and the keys that say how it is read."""
    image, note = node.image, scene.note
    if image.source != "GENERATED" and image.packed_file is None and image.filepath:
        _within(bpy.path.abspath(image.filepath, library=image.library), item, scene)
    width, height = image.size
    if width == 0 or height == 0:
        raise FileNotFoundError(f"{item}: the image {image.name!r} has no pixels: is its file there?")
    if image.source == "TILED":
        note("approximated", item, "of the tiles of its image only the first is taken")
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)[::-1].astype(float)
    colours = pixels[..., :3] if image.channels >= 3 else np.repeat(pixels[..., :1], 3, axis=-1)
    space = image.colorspace_settings.name
    if space == "sRGB" and not image.is_float:
        colours = obj.linear(colours)
        note("approximated", item, f"the image {image.name!r} is sRGB: its luminance is taken as reflectance; data should be Non-Color")
    elif space not in ("Non-Color", "Raw", "Linear", "Linear Rec.709", "sRGB"):
        note("approximated", item, f"the colours of {image.name!r} are {space}: taken as linear")
    keys = {"placement": "atlas", "texels": "nearest" if node.interpolation == "Closest" else "bilinear"}
    if node.extension == "REPEAT":
        keys["wrap"] = "repeat"
    if node.interpolation in ("Cubic", "Smart"):
        note("approximated", item, f"interpolation {node.interpolation}: bilinear")
    return obj.luminance(colours), {"quantity": "", **keys}
