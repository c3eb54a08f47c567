"""A render engine: it exports what it is asked to render, or shows what mmxrt makes of it.

Only an engine gets the dependency graph of a render; that of a script is the viewport's.
"""

import os
import tempfile

import bpy
import numpy as np

from . import envi, gather, program, scene_toml

ID = "MMXRT"


class MmxrtEngine(bpy.types.RenderEngine):
    """Renders by mmxrt: one band as grey, or the first, middle and last as blue, green and red."""

    bl_idname = ID
    bl_label = "mmxrt"
    bl_use_preview = False
    bl_use_postprocess = True

    # What an export waits for: a function of the graph, and what came of it.
    task = None

    def render(self, depsgraph):
        task = MmxrtEngine.task
        if task is not None:
            task(depsgraph)
            return
        try:
            self._show(depsgraph)
        except Exception as error:  # whatever it is, the user sees it
            self.report({"ERROR"}, str(error))

    def _show(self, depsgraph):
        with tempfile.TemporaryDirectory(prefix="mmxrt-") as folder:
            self.update_stats("mmxrt", "exporting")
            scene = gather.gather(depsgraph)
            scene_toml.write(scene, os.path.join(folder, "scene"))
            self.update_stats("mmxrt", "simulating")
            product = os.path.join(folder, "product")
            program.simulate(program.find(stated_program()), os.path.join(folder, "scene", "scene.toml"), product)
            cube = envi.Cube(os.path.join(product, "cube.hdr"))
            count = len(cube.bands)
            image = cube.image(0 if count < 3 else (count - 1, count // 2, 0))
        lines, samples = image.shape[:2]
        result = self.begin_result(0, 0, samples, lines)
        result.layers[0].passes["Combined"].rect = image.reshape(-1, 4).tolist()
        self.end_result(result)


def stated_program():
    """The path of mmxrt in the preferences; empty where nothing is said."""
    add_on = bpy.context.preferences.addons.get(__package__)
    return add_on.preferences.program if add_on else ""


def view_layer(scene):
    """The view layer that is exported: the one at hand, as renders have all of them one after the other."""
    at_hand = bpy.context.view_layer
    return at_hand if at_hand is not None and at_hand.name in scene.view_layers and bpy.context.scene == scene else scene.view_layers[0]


def of_render(scene, work):
    """What `work` makes of the dependency graph with which `scene` renders. Its engine is exchanged for a moment."""
    outcome = {}

    def task(graph):
        try:
            outcome["result"] = work(graph)
        except Exception as error:  # it would be lost in the render
            outcome["error"] = error

    render = scene.render
    kept = {name: getattr(render, name) for name in ("engine", "use_compositing", "use_sequencer", "use_lock_interface")}
    # A render before stays in its slot.
    result = bpy.data.images.get("Render Result")
    slots = result.render_slots if result and len(result.render_slots) > 1 else None
    slot = slots.active_index if slots else 0
    MmxrtEngine.task = task
    try:
        if slots:
            slots.active_index = 0 if slot > 0 else len(slots) - 1
        render.engine, render.use_compositing, render.use_sequencer = ID, False, False
        bpy.ops.render.render(scene=scene.name, layer=view_layer(scene).name)
    finally:
        MmxrtEngine.task = None
        if slots:
            slots.active_index = slot
        for name, value in kept.items():
            setattr(render, name, value)
    if "error" in outcome:
        raise outcome["error"]
    if "result" not in outcome:
        raise RuntimeError("Blender rendered nothing: is a render running already?")
    return outcome["result"]


def export(scene, folder, collection=None, stem="scene", inside=None):
    """Writes the folder of a scene, with `stem.toml`; what became of what has no place in it, as (fate, what, why)."""
    gathered = of_render(scene, lambda graph: gather.gather(graph, collection, inside))
    if sum(layer.use for layer in scene.view_layers) > 1:
        gathered.note("dropped", "view layers", f"all but {view_layer(scene).name!r}")
    scene_toml.write(gathered, folder, stem)
    return gathered.notes


def register():
    bpy.utils.register_class(MmxrtEngine)
    for panel in _panels():
        panel.COMPAT_ENGINES.add(ID)


def unregister():
    for panel in _panels():
        panel.COMPAT_ENGINES.discard(ID)
    bpy.utils.unregister_class(MmxrtEngine)


def _panels():
    """Panels of Blender that any engine has: size of the image, lens, surface, lamp."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is not None and "CYCLES" not in panel.__module__ and "BLENDER_RENDER" in engines:
            yield panel
