"""mmxrt in Blender: scenes as they are rendered go out as `scene.toml`, cubes come in as images and textures.

The same folder is an extension (Blender 4.2 and later, by blender_manifest.toml) and a classic add-on (before, by `bl_info`).
Modules without `bpy` are camera, toml_text, obj, scene_toml, envi and program.
"""

bl_info = {
    "name": "mmxrt",
    "author": "The mmxrt authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import, Export; Properties > Output; render engine mmxrt",
    "description": "What a space camera sees of this scene, as a hyperspectral cube",
    "category": "Import-Export",
}


# Parts that need Blender are imported with it, so that the others can be tested without.
def register():
    from . import engine, interface

    engine.register()
    interface.register()


def unregister():
    from . import engine, interface

    interface.unregister()
    engine.unregister()
