"""Temperatures of ground by heat1d for the tests: python column.py FOLDER

FOLDER/column.json has what the ground is and when it is asked for; FOLDER/temperatures.f64 is [case, hour], the surface temperature, K.
"""

import json
import os
import sys
import types

import numpy as np

# heat1d 0.3.2 was written for an older NumPy, and for a module of planets that asks the net for their sizes; it needs none of them here.
np.float, np.int = float, int
sys.modules["planets"] = types.SimpleNamespace(Moon=None)
from heat1d import main  # noqa: E402

folder = sys.argv[1]
with open(os.path.join(folder, "column.json"), encoding="utf-8") as file:
    given = json.load(file)

# Its surface has a conductivity that grows with temperature, whatever the configuration says, unless this is 0.
main.thermCond.__defaults__ = (0.0,)

answers = []
for case in given:
    # Constant properties: only I = sqrt(k rho c) counts.
    density, heat = 1100.0, 600.0
    conductivity = case["inertia"] ** 2 / (density * heat)
    day = case["period_s"]
    planet = types.SimpleNamespace(
        S=case["irradiance_w_m2"], albedo=case["albedo"], albedoCoef=[0.0, 0.0], emissivity=case["emissivity"], rAU=1.0, eccentricity=0.0,
        obliquity=np.radians(case["declination_deg"]), Lp=0.5 * np.pi, Qb=0.0, day=day, year=case["days"] * day, ks=conductivity, kd=conductivity,
        rhos=density, rhod=density, H=1.0, cp0=heat, cpCoeff=[heat],
    )
    # The season stands still.
    main.orbits.GM = 0.0
    config = main.Configurator(chi=0.0, m=case["layers"], n=case["growth"], b=case["depths"], DTSURF=1e-6, NPERDAY=1)
    model = main.Model(planet=planet, lat=np.radians(case["latitude_deg"]), ndays=1, config=config)
    model.run()
    # A surface temperature is that of the flux at the beginning of a step; local times are those of its end.
    times = (np.arange(model.N_steps) * model.dt / day) % 1.0
    answers.append(np.interp(np.array(case["hours"]) / 24.0, times, model.T[:, 0], period=1.0))
np.array(answers).astype("<f8").tofile(os.path.join(folder, "temperatures.f64"))
