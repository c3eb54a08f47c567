"""Draws docs/phobos.png, the picture at the top of README.md: three colours beside the spectra of two pixels.

    mmxrt simulate scenes/phobos_mars_side/scene.toml -o out/phobos --set sensor.samples=480 --set sensor.lines=480 --set sensor.preset= --set sensor.ideal= \
        --set 'sensor.bands={ start_um = 0.95, stop_um = 3.6, count = 107, fwhm_um = 0.025 }'
    python3 docs/phobos.py out/phobos docs/phobos.png

Needs NumPy and Matplotlib.
"""

import pathlib
import re
import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

product, picture = pathlib.Path(sys.argv[1]), sys.argv[2]


def header(name):
    """The entries of an ENVI header."""
    text = (product / name).read_text()
    return {key.strip(): value.strip("{} \n") for key, value in re.findall(r"^([^=\n]+?) = (\{[^}]*\}|[^\n]*)", text, re.M)}


cube_header, plane_header = header("cube.hdr"), header("backplanes.hdr")
samples, lines, bands = (int(cube_header[key]) for key in ("samples", "lines", "bands"))
cube = np.fromfile(product / "cube.img", "<f4").reshape(bands, lines, samples)
names = [name.split(" (")[0].strip() for name in plane_header["band names"].split(",")]
planes = np.fromfile(product / "backplanes.img", "<f8").reshape(len(names), lines, samples)
wavelength_um = np.array([float(w) for w in cube_header["wavelength"].split(",")])
lit, incidence = planes[names.index("LIT_FRACTION")], planes[names.index("LOCALINCIDENCE")]

# Ground that faces the Sun, and the middle of a wide shadow: where a square around a pixel is all lit, or all dark.
size = 9
around = np.lib.stride_tricks.sliding_window_view(lit, (size, size)).mean(axis=(2, 3))
angle = np.lib.stride_tricks.sliding_window_view(incidence, (size, size)).mean(axis=(2, 3))
dark_radiance = np.where(around == 0, cube[10, size // 2 : -(size // 2), size // 2 : -(size // 2)], np.inf)
sunny = np.unravel_index(np.argmin(np.where(around == 1, abs(angle - 60), np.inf)), around.shape)
shady = np.unravel_index(np.argmin(dark_radiance), around.shape)

figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.4), width_ratios=(1, 1))
left.imshow(plt.imread(product / "quicklook_rgb.png"))
left.set_axis_off()
right.set_yscale("log")
right.set_ylim(7e-4, 8)
for place, colour, name in ((sunny, "#e08a00", "in sunlight"), (shady, "#2a6fdb", "in shadow, lit by Mars and the ground around")):
    line, sample = (i + size // 2 for i in place)
    right.plot(wavelength_um, cube[:, line, sample], color=colour, label=name, lw=1.8)
    left.plot(sample, line, "o", ms=13, mfc="none", mec="white", mew=4)
    left.plot(sample, line, "o", ms=13, mfc="none", mec=colour, mew=2)
right.set_xlabel("wavelength, um")
right.set_ylabel("radiance, W m$^{-2}$ sr$^{-1}$ um$^{-1}$")
right.grid(alpha=0.3)
right.legend(frameon=False, loc="upper right")
figure.tight_layout()
figure.savefig(picture, dpi=100, pil_kwargs={"optimize": True})
print(f"lit pixel {sunny}, pixel in shadow {shady}")
