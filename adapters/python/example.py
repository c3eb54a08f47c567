"""From a scene to the spectrum of a pixel: for notebooks, cell by cell, or `python adapters/python/example.py [PICTURE]`.

Needs the wheel and Matplotlib. Run it at the root of the repository.
"""

# %% The scene: a site on Phobos, coarser than it is shipped so that this takes seconds.
import sys

import matplotlib.pyplot as plt
import mmxrt

scene = mmxrt.Scene.load("scenes/phobos_mars_side/scene.toml")
scene.set("sensor.samples", 64).set("sensor.lines", 64).set("mesh[0].recipe", "rugged")
product = scene.simulate(model=["sunlight", "mars-light", "heat"], split=True, progress=True)
product

# %% A band, and where two pixels are: the brightest one, and one in shadow.
band = int(abs(product.wavelength_um - 1.5).argmin())
image, lit = product.cube[band], product.backplanes["LIT_FRACTION"]
pixels = {"brightest": divmod(int(image.argmax()), 64), "in shadow": divmod(int((lit == 0).argmax()), 64)}
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
shown = left.imshow(image, cmap="gray", vmax=0.6 * image.max())
figure.colorbar(shown, label=f"radiance at {product.wavelength_um[band]:.2f} um, {product.unit}")

# %% Their spectra, and what of them is heat.
for (name, (line, sample)), colour in zip(pixels.items(), ("tab:orange", "tab:blue"), strict=True):
    left.plot(sample, line, "o", markerfacecolor="none", color=colour)
    right.semilogy(product.wavelength_um, product.cube[:, line, sample], color=colour, label=name)
    right.semilogy(product.wavelength_um, product.thermal[:, line, sample], ":", color=colour)
right.set(xlabel="wavelength, um", ylabel=product.unit, ylim=(1e-5, None), title="dotted: thermal emission")
right.legend()

# %% As xarray, with coordinates and units: `pip install xarray`.
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=100)
else:
    print(product.to_xarray())
    plt.show()
