"""Renders a scene that `mmxrt chart --mitsuba` exported, with 1 to 1024 samples a pixel, and saves images and times.

    python render.py FOLDER

FOLDER holds scene.json and one PLY file for each material; images.npz is written there: `rays` [n], `cpu_s` [n] (of all threads, fastest of up
to three runs; reading the scene is not in it), `load_s`, and `images` [n, line, sample], W m-2 sr-1 um-1. Needs `pip install mitsuba`.
"""

import json
import os
import sys
import time

import numpy as np

import mitsuba as mi

folder = sys.argv[1]
with open(os.path.join(folder, "scene.json"), encoding="utf-8") as file:
    given = json.load(file)

# Scalar variants trace in compiled C++ on all cores; others compile kernels first, which would count as rendering.
mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)


def grey(value):
    return {"type": "rgb", "value": value}


def scene_of(rays):
    camera = given["camera"]
    h, v, u = (np.array(camera[axis]) for axis in "hvu")
    to_world = np.eye(4)
    # Mitsuba's sensor has +x to the left, +y up, +z along the boresight.
    to_world[:3, 0], to_world[:3, 1], to_world[:3, 2], to_world[:3, 3] = -h, -v, u, camera["position_m"]
    samples, lines = camera["samples"], camera["lines"]
    scene = {
        "type": "scene",
        # Sunlight alone: what is seen, and whether the Sun sees it.
        "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
        "sun": {"type": "directional", "direction": [-x for x in given["towards_sun"]], "irradiance": grey(given["irradiance"])},
        "sensor": {
            "type": "perspective",
            "fov": 2.0 * np.degrees(np.arctan(0.5 * samples * camera["pitch"])),
            "fov_axis": "x",
            "near_clip": camera["near_m"],
            "far_clip": camera["far_m"],
            "to_world": mi.ScalarTransform4f(to_world),
            "sampler": {"type": "multijitter", "sample_count": rays},
            "film": {
                "type": "hdrfilm", "width": samples, "height": lines, "pixel_format": "luminance",
                "component_format": "float32", "rfilter": {"type": "box"},
            },
        },
    }
    for i, material in enumerate(given["materials"]):
        scene[f"mesh{i}"] = {
            "type": "ply", "filename": os.path.join(folder, material["ply"]), "face_normals": True,
            "bsdf": {"type": "diffuse", "reflectance": grey(material["reflectance"])},
        }
    return scene


images, times = [], []
began = time.process_time()
mi.load_dict(scene_of(1))
load_s = time.process_time() - began
for rays in given["rays"]:
    scene = mi.load_dict(scene_of(rays))
    least = float("inf")
    for _ in range(3):
        began = time.process_time()
        image = np.array(mi.render(scene, seed=1, spp=rays))
        least = min(least, time.process_time() - began)
        if least > 3.0:
            break
    images.append(image.reshape(image.shape[0], image.shape[1]).astype(np.float64))
    times.append(least)
    print(f"{rays} samples a pixel: {least:.2f} CPU s", flush=True)

np.savez(
    os.path.join(folder, "images.npz"),
    rays=np.array(given["rays"], dtype=np.float64), cpu_s=np.array(times), load_s=np.array([load_s]), images=np.array(images),
)
