"""Exports a scene without Blender's window: `blender -b FILE.blend --python headless.py -- FOLDER STEM [outside]`. Files in FOLDER begin with STEM; with
`outside` tables and images may lie outside of FILE's folder.

`mmxrt convert FILE.blend OUT` runs it from a folder `mmxrt` with the modules of the add-on, which need not be installed. Each line of output that begins
with MMXRT is for it: NOTE, a fate, what and why, with tabs between; or ERROR and why; or DONE.
"""

import os
import sys


def line(*words):
    print("\t".join(" ".join(str(word).split()) for word in ("MMXRT", *words)), flush=True)


def main(folder, stem, outside=None):
    sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    import bpy

    from mmxrt import engine

    # In the stead of an installed add-on's, which another module has.
    bpy.utils.register_class(engine.MmxrtEngine)
    try:
        inside = None if outside else os.path.dirname(bpy.data.filepath)
        for note in engine.export(bpy.context.scene, folder, stem=stem, inside=inside):
            line("NOTE", *note)
        line("DONE")
    except Exception as error:  # a traceback would tell its reader nothing
        line("ERROR", error if str(error) else type(error).__name__)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[sys.argv.index("--") + 1:]))
