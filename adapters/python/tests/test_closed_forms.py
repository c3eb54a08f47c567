"""Numbers that a page of paper gives."""

import math
from pathlib import Path

import mmxrt
import numpy as np
import pytest
from conftest import plate


def of_flat_sun(folder: Path) -> mmxrt.Scene:
    """The plate under a Sun of 700 W m-2 um-1 at 1 au at all wavelengths, so that no table of the Sun is needed."""
    (folder / "sun.csv").write_text("wavelength_um,irradiance_w_m2_um\n0.2,700\n5.0,700\n")
    return mmxrt.Scene(plate(sun=plate()["sun"] | {"spectrum": "sun.csv"}), folder=folder)


def test_a_lambert_plate_sends_its_reflectance_times_cos_i_over_pi(folder: Path) -> None:
    product = of_flat_sun(folder).simulate(model="sunlight", dtype="f64")
    # L = r / pi x F / d^2 x cos i
    radiance = 0.07 / math.pi * 700.0 / 1.5**2 * 0.5
    assert product.cube.shape == (2, 6, 8)
    np.testing.assert_allclose(product.cube, radiance, rtol=1e-9)
    assert product.unit == "W m-2 sr-1 um-1"
    np.testing.assert_array_equal(product.wavelength_um, [1.0, 2.0])
    assert np.isnan(product.fwhm_um).all()
    np.testing.assert_allclose(product.backplanes["COVERAGE"], 1.0, atol=1e-12)
    np.testing.assert_allclose(product.backplanes["LOCALINCIDENCE"], 60.0, atol=1e-9)
    np.testing.assert_allclose(product.backplanes["LATITUDE"], 90.0, atol=0.5)


def test_radiance_factor_is_pi_i_over_f(folder: Path) -> None:
    product = of_flat_sun(folder).simulate(model="sunlight", quantity="radiance_factor", dtype="f64")
    np.testing.assert_allclose(product.cube, 0.07 * 0.5, rtol=1e-9)


def test_radiance_goes_with_reflectance_and_one_over_squared_distance(folder: Path) -> None:
    scene = of_flat_sun(folder)
    before = scene.simulate(dtype="f64").cube
    scene["materials"]["grey"]["reflectance"] = 0.14
    scene.set("sun.distance_au", 3.0)
    np.testing.assert_allclose(scene.simulate(dtype="f64").cube, before * 2 / 4, rtol=1e-12)


def test_the_table_has_cos_i_of_each_facet(folder: Path) -> None:
    table = of_flat_sun(folder).solve(model="sunlight")
    np.testing.assert_allclose(table["sun_irradiance"], [0.5, 0.5], rtol=1e-12)
    np.testing.assert_allclose(table["sun_share"], [1.0, 1.0], rtol=1e-12)
    assert "temperature_lit_k" not in table


@pytest.mark.parametrize("in_file", [False, True])
def test_shares_are_those_of_a_shadow_on_paper(folder: Path, in_file: bool) -> None:
    # A wall of 20 m stands across the middle of the plate, and the Sun comes 60 deg from the zenith along +x: its shadow is 20 tan 60 = 34.64 m
    # long and as wide as the plate. Behind it (x from -50 to 0) and before it are two facets each.
    wall = """v -50 -50 0
v 0 -50 0
v 50 -50 0
v 50 50 0
v 0 50 0
v -50 50 0
v 0 -50 20
v 0 50 20
usemtl grey
f 1 2 5 6
f 2 3 4 5
f 2 5 8 7
"""
    (folder / "wall.obj").write_text(wall)
    scene = of_flat_sun(folder)
    scene["mesh"] = [{"file": "wall.obj"}]
    table = scene.solve(folder / "table.npz" if in_file else None, model="sunlight")
    shares = table["sun_share"]
    shadow = 20.0 * math.tan(math.radians(60.0)) / 50.0
    # Of what is behind the wall that share is dark; of its two halves, cut along a diagonal, the one keeps a tip in the light, the other a tip in the dark.
    np.testing.assert_allclose(shares[:2].mean(), 1.0 - shadow, rtol=1e-9)
    np.testing.assert_allclose(sorted(shares[:2]), sorted([(1.0 - shadow) ** 2, 1.0 - shadow**2]), rtol=1e-9)
    np.testing.assert_allclose(shares[2:4], 1.0, rtol=1e-12)


def test_a_black_plate_has_the_temperature_of_stefan_and_boltzmann(folder: Path) -> None:
    scene = of_flat_sun(folder)
    scene["thermal"] = {"model": "equilibrium"}
    scene["materials"]["grey"] = {"reflectance": 0.1, "bond_albedo": 0.1, "emissivity_bolometric": 0.9}
    table = scene.solve(model=["sunlight", "heat"])
    # (1 - A) S cos i / d^2 = eps sigma T^4, and S is all of the spectrum from 0.2 to 5 um.
    kelvin = (0.9 * 700.0 * 4.8 * 0.5 / 1.5**2 / (0.9 * 5.670374419e-8)) ** 0.25
    np.testing.assert_allclose(table["temperature_lit_k"], kelvin, rtol=1e-6)


def test_the_middle_of_the_image_is_the_target(folder: Path) -> None:
    scene = mmxrt.Scene(plate(), folder=folder)
    ground = scene.locate(pixels=[[4.0, 3.0], [4.5, 3.0], [4000.0, 3.0]])
    # A pixel at the middle is 10 mrad wide: half of it ends at tan(5 mrad).
    x_m = 1000.0 * math.tan(0.005)
    np.testing.assert_allclose(ground["x_m"][:2], [0.0, x_m], atol=1e-9)
    np.testing.assert_allclose(ground["z_m"][:2], 12000.0, atol=1e-9)
    assert ground["facet"][2] == -1 and math.isnan(ground["range_m"][2])
    back = scene.locate(ground_m=[[0.0, 0.0, 12000.0], [x_m, 0.0, 12000.0]])
    np.testing.assert_allclose(back["sample"], [4.0, 4.5], atol=1e-9)
    np.testing.assert_allclose(back["line"], [3.0, 3.0], atol=1e-9)
    assert back["inside"].all() and not back["hidden"].any()


def test_a_dataset_has_coordinates_and_units(folder: Path) -> None:
    pytest.importorskip("xarray")
    product = of_flat_sun(folder).simulate(dtype="f64", split=True)
    dataset = product.to_xarray()
    assert dataset.radiance.dims == ("band", "line", "sample")
    assert dataset.radiance.attrs["units"] == "W m-2 sr-1 um-1"
    assert dataset.RANGE.attrs["units"] == "m"
    assert float(dataset.wavelength[1]) == 2.0
    assert np.shares_memory(dataset.radiance.values, product.cube)
    np.testing.assert_array_equal(dataset.thermal, 0.0)
