"""Blender's camera in the terms of `scene.toml`, and the pixels that it makes of points.

Plain numbers, no `bpy`. Matrices are rows of `matrix_world`; a camera looks along its -z, with +x to the right and +y up.
"""

import math


def unscaled(matrix):
    """A camera's pose without the scale of its object, which Blender ignores too: columns of unit length, to f64.

    Blender keeps matrices in f32. Its axes are at right angles to 1e-7 only, unless a parent shears them; so the boresight (-z) is kept and the
    others are made square to it, the vertical last.
    """
    column = lambda i: [float(matrix[row][i]) for row in range(3)]
    z = _unit(column(2))
    x = column(0)
    along = _dot(x, z)
    x = _unit([a - along * b for a, b in zip(x, z)])
    y = _cross(z, x)
    # A mirrored object shows a mirrored image in no program: Blender takes the axes as they are, and we those that make a rotation.
    position = [float(matrix[row][3]) for row in range(3)]
    return [[x[i], y[i], z[i], position[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def is_mirrored(matrix):
    """Whether a matrix turns right hands into left ones."""
    column = lambda i: [float(matrix[row][i]) for row in range(3)]
    return _dot(_cross(column(0), column(1)), column(2)) < 0.0


def resolution(x, y, percentage):
    """Samples and lines of a render: Blender cuts the percentage off to whole pixels."""
    return max(1, x * percentage // 100), max(1, y * percentage // 100)


def lens(samples, lines, focal_mm, sensor_width_mm, sensor_height_mm, sensor_fit, shift, pixel_aspect=1.0):
    """The keys of `[sensor]` that say the same. `pixel_aspect` is a pixel's height over its width; `sensor_fit` as Blender has it."""
    keys = {
        "samples": samples,
        "lines": lines,
        "focal_mm": focal_mm,
        # AUTO goes by the width of the sensor, whichever side of the image is longer.
        "sensor_mm": sensor_height_mm if sensor_fit == "VERTICAL" else sensor_width_mm,
        "sensor_fit": sensor_fit.lower(),
    }
    if tuple(shift) != (0.0, 0.0):
        keys["shift"] = list(shift)
    if pixel_aspect != 1.0:
        keys["pixel_aspect"] = pixel_aspect
    return keys


def pinhole(keys):
    """Size of a pixel over the focal length, along a line and across, and the principal point, pixels from the top left."""
    samples, lines = keys["samples"], keys["lines"]
    aspect = keys.get("pixel_aspect", 1.0)
    fit = keys["sensor_fit"]
    is_wide = fit == "horizontal" or (fit == "auto" and samples >= lines * aspect)
    size = samples if is_wide else lines * aspect
    across = keys["sensor_mm"] / (keys["focal_mm"] * size)
    right, up = keys.get("shift", (0.0, 0.0))
    return (across, across * aspect), (0.5 * samples - right * size, 0.5 * lines + up * size / aspect)


def pixel(camera_to_world, keys, point):
    """Sample and line (pixels from the top left corner of the image) where a camera sees a point, and how far along the boresight it is, m."""
    (across, down), (sample, line) = pinhole(keys)
    away = [float(point[i]) - camera_to_world[i][3] for i in range(3)]
    x, y, z = (sum(away[i] * camera_to_world[i][k] for i in range(3)) for k in range(3))
    depth = -z
    if depth == 0.0:
        return math.nan, math.nan, 0.0
    return sample + x / depth / across, line - y / depth / down, depth


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _unit(v):
    length = math.sqrt(_dot(v, v))
    if not length > 0.0:
        raise ValueError("the camera's object has no size along one of its axes: set its scale to 1")
    return [x / length for x in v]
