"""What users see: operators, a panel, file handlers, the program's path in the preferences."""

import os
import tempfile

import bpy
from bpy.props import BoolProperty, IntVectorProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import cube_image, engine, program

# Errors of files, of what the scene lacks, and of the program: told in Blender, where others are mistakes of this add-on.
EXPECTED = (OSError, ValueError, RuntimeError)


def tell(operator, notes):
    """Reports what was not carried over as it is."""
    for fate, what, why in notes:
        operator.report({"WARNING"}, f"{fate}: {what}: {why}")


class MmxrtPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(name="mmxrt", description="Path of the program; empty: the one on the path", subtype="FILE_PATH")

    def draw(self, context):
        self.layout.prop(self, "program")


class MMXRT_OT_export(bpy.types.Operator, ExportHelper):
    """Write the scene as it is rendered, as a folder with scene.toml for mmxrt"""

    bl_idname = "mmxrt.export"
    bl_label = "Export to mmxrt"
    bl_options = {"PRESET"}

    filename_ext = ""
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})
    collection: StringProperty(name="Collection", description="Write only the objects of this collection", options={"HIDDEN"})

    def execute(self, context):
        folder = self.filepath
        if os.path.basename(folder) == "scene.toml":
            folder = os.path.dirname(folder)
        try:
            chosen = bpy.data.collections[self.collection] if self.collection else None
            tell(self, engine.export(context.scene, folder, chosen))
        except EXPECTED as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{folder}/scene.toml")
        return {"FINISHED"}


class MMXRT_OT_simulate(bpy.types.Operator):
    """Export the scene, run mmxrt on it, and show its cube as an image"""

    bl_idname = "mmxrt.simulate"
    bl_label = "Simulate with mmxrt"

    options: StringProperty(name="Options", description="Further options of `mmxrt simulate`, e.g. --model sunlight")
    folder: StringProperty(name="Folder", description="Where scene and product stay; empty: nowhere", subtype="DIR_PATH")

    def execute(self, context):
        try:
            # An image is packed into the file: what it was read from may go.
            with tempfile.TemporaryDirectory(prefix="mmxrt-") as temporary:
                folder = bpy.path.abspath(self.folder) if self.folder else temporary
                tell(self, engine.export(context.scene, os.path.join(folder, "scene")))
                product = os.path.join(folder, "product")
                scene = os.path.join(folder, "scene", "scene.toml")
                program.simulate(program.find(engine.stated_program()), scene, product, self.options.split())
                made = cube_image.image(os.path.join(product, "cube.hdr"), name="mmxrt")
        except EXPECTED as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        _show(context, made)
        return {"FINISHED"}


class MMXRT_OT_import(bpy.types.Operator, ImportHelper):
    """Show bands of a cube as an image, or cast them onto the selected meshes"""

    bl_idname = "mmxrt.import_cube"
    bl_label = "Import a cube of mmxrt"
    bl_options = {"UNDO"}

    filename_ext = ".hdr"
    filter_glob: StringProperty(default="*.hdr;*.img", options={"HIDDEN"})
    bands: IntVectorProperty(name="Bands", description="Bands shown as red, green and blue, from 1; 0: chosen by themselves", size=3, min=0)
    as_texture: BoolProperty(name="Cast onto the selection", description="Also put it onto the selected meshes, as the camera sees them")

    def execute(self, context):
        bands = None if 0 in self.bands[:] else [band - 1 for band in self.bands]
        try:
            made = cube_image.image(self.filepath, bands)
            if self.as_texture:
                cube_image.cast(made, context.selected_objects, context.scene)
        except EXPECTED as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        _show(context, made)
        return {"FINISHED"}


def _show(context, made):
    """Shows an image in image editors that are open, but for the one with the render."""
    for area in context.screen.areas if context.screen else ():
        if area.type == "IMAGE_EDITOR" and (area.spaces.active.image is None or area.spaces.active.image.type != "RENDER_RESULT"):
            area.spaces.active.image = made


class MMXRT_OT_property(bpy.types.Operator):
    """Add this custom property, which mmxrt reads"""

    bl_idname = "mmxrt.add_property"
    bl_label = "Add"
    bl_options = {"UNDO", "INTERNAL"}

    name: StringProperty()
    on_scene: BoolProperty()

    def execute(self, context):
        target = context.scene if self.on_scene else context.object.active_material
        defaults = {"origin_m": [0.0, 0.0, 0.0], "mmxrt_frame": "body", "mmxrt_bands": "{ centres_um = [1.0] }"}
        target[self.name] = defaults.get(self.name, "")
        return {"FINISHED"}


class MMXRT_PT_panel(bpy.types.Panel):
    bl_label = "mmxrt"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "output"

    def draw(self, context):
        layout = self.layout
        row = layout.row(align=True)
        row.operator("mmxrt.export", text="Export")
        row.operator("mmxrt.simulate", text="Simulate")
        row.operator("mmxrt.import_cube", text="Import")
        _properties(layout, context.scene, ("origin_m", "mmxrt_frame", "mmxrt_bands"), True)


class MMXRT_PT_material(bpy.types.Panel):
    bl_label = "mmxrt"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.active_material is not None

    def draw(self, context):
        names = ("spectral_material", "mmxrt_reflectance", "mmxrt_emissivity", "mmxrt_vertex_colours")
        _properties(self.layout, context.object.active_material, names, False)


def _properties(layout, of, names, on_scene):
    """Rows of custom properties, or of what adds them."""
    for name in names:
        if name in of.keys():
            layout.prop(of, f'["{name}"]', text=name.replace("mmxrt_", ""))
        else:
            add = layout.operator("mmxrt.add_property", text=f"Add {name.replace('mmxrt_', '')}", icon="ADD")
            add.name, add.on_scene = name, on_scene


def _in_export_menu(self, _context):
    self.layout.operator("mmxrt.export", text="mmxrt (folder with scene.toml)")


def _in_import_menu(self, _context):
    self.layout.operator("mmxrt.import_cube", text="Cube of mmxrt (.hdr)")


CLASSES = [
    MmxrtPreferences, MMXRT_OT_export, MMXRT_OT_simulate, MMXRT_OT_import, MMXRT_OT_property, MMXRT_PT_panel, MMXRT_PT_material,
]

# Blender before 4.1 has no handlers: menus serve there.
if hasattr(bpy.types, "FileHandler"):

    class MMXRT_FH_scene(bpy.types.FileHandler):
        bl_idname = "MMXRT_FH_scene"
        bl_label = "mmxrt scene"
        bl_export_operator = "mmxrt.export"
        bl_file_extensions = ".toml"

    class MMXRT_FH_cube(bpy.types.FileHandler):
        bl_idname = "MMXRT_FH_cube"
        bl_label = "mmxrt cube"
        bl_import_operator = "mmxrt.import_cube"
        bl_file_extensions = ".hdr"

        @classmethod
        def poll_drop(cls, context):
            return context.area is not None and context.area.type in ("VIEW_3D", "IMAGE_EDITOR")

    CLASSES += [MMXRT_FH_scene, MMXRT_FH_cube]


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_file_export.append(_in_export_menu)
    bpy.types.TOPBAR_MT_file_import.append(_in_import_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(_in_import_menu)
    bpy.types.TOPBAR_MT_file_export.remove(_in_export_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
