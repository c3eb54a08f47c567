"""Renders a scene with Mitsuba 3 for the tests: python render.py FOLDER

FOLDER/scene.json has the mesh, materials (Lambert, or Hapke's model, whose formulas are written here from the books and share nothing with the
program under test), parallel lights, a camera, and how deep and how often to sample. FOLDER/images.f64 is [seed, line, sample], radiance.
"""

import json
import math
import os
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_mono")
mi.set_log_level(mi.LogLevel.Error)
folder = sys.argv[1]
with open(os.path.join(folder, "scene.json"), encoding="utf-8") as file:
    given = json.load(file)


def chandrasekhar(w, nodes=64):
    """H of isotropic scattering at nodes + 1 even steps of cos, 0 to 1, by iterating 1 / H = sqrt(1 - w) + w / 2 int t H(t) / (mu + t) dt."""
    t, weight = np.polynomial.legendre.leggauss(nodes)
    t, weight = 0.5 * (t + 1.0), 0.5 * weight
    h = np.ones_like(t)
    for _ in range(2000):
        h = 1.0 / (np.sqrt(1.0 - w) + 0.5 * w * (t * h * weight) @ (1.0 / (t[:, None] + t[None, :])))
    mu = np.linspace(0.0, 1.0, 4097)
    return 1.0 / (np.sqrt(1.0 - w) + 0.5 * w * (1.0 / (mu[:, None] + t[None, :])) @ (t * h * weight))


class Hapke(mi.BSDF):
    """Hapke (2012), eqs. 9.47 and 12.46 to 12.55; roughness after Hapke (1984). One-sided."""

    def __init__(self, props):
        super().__init__(props)
        number = lambda key: float(props[key])
        self.w, self.b, self.c = number("w"), number("b"), number("c")
        self.b0, self.h = number("b0"), number("h")
        self.bc0, self.hc = number("bc0"), number("hc")
        self.slope = number("slope")
        self.table = mi.Float(chandrasekhar(self.w))
        flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide
        self.m_flags = flags
        self.m_components = [flags]

    def h_function(self, mu):
        x = dr.clip(mu, 0.0, 1.0) * 4096.0
        i = dr.minimum(mi.UInt32(x), 4095)
        part = x - mi.Float(i)
        low, high = dr.gather(mi.Float, self.table, i), dr.gather(mi.Float, self.table, i + 1)
        return low + part * (high - low)

    def phase_function(self, cos_g):
        lobe = lambda b: (1.0 - b * b) * dr.power(1.0 + 2.0 * b * cos_g + b * b, -1.5)
        if self.c > -1.5:
            # Two terms: b > 0, the first of which scatters back.
            return 0.5 * (1.0 + self.c) * lobe(-self.b) + 0.5 * (1.0 - self.c) * lobe(self.b)
        return lobe(self.b)

    def reflectance(self, wi, wo):
        """Bidirectional reflectance r, 1/sr: light from wo, seen from wi."""
        mu0, mu = dr.maximum(wo.z, 1e-6), dr.maximum(wi.z, 1e-6)
        cos_g = dr.clip(dr.dot(wi, wo), -1.0, 1.0)
        # tan(g / 2) from the sum and the difference of the directions, which keeps its digits at opposition.
        half = dr.norm(wi - wo) / dr.maximum(dr.norm(wi + wo), 1e-12)
        mu0e, mue, shadowing = mu0, mu, mi.Float(1.0)
        if self.slope > 0.0:
            mu0e, mue, shadowing = self.rough(wi, wo, mu0, mu)
        hiding = self.b0 / (1.0 + half / self.h) if self.b0 > 0.0 else mi.Float(0.0)
        r = self.w / (4.0 * math.pi) * mu0e / (mu0e + mue)
        r *= (1.0 + hiding) * self.phase_function(cos_g) + self.h_function(mu0e) * self.h_function(mue) - 1.0
        if self.bc0 > 0.0:
            # Hapke (2002), eq. 32.
            x = half / self.hc
            of_x = dr.select(x > 1e-3, (1.0 - dr.exp(-x)) / dr.maximum(x, 1e-3), 1.0 - 0.5 * x)
            r *= 1.0 + self.bc0 * (1.0 + of_x) / (2.0 * (1.0 + x) * (1.0 + x))
        return r * shadowing

    def rough(self, wi, wo, mu0, mu):
        tan_s = math.tan(self.slope)
        chi = 1.0 / math.sqrt(1.0 + math.pi * tan_s * tan_s)
        sin0, sin = dr.sqrt(dr.maximum(1.0 - mu0 * mu0, 1e-14)), dr.sqrt(dr.maximum(1.0 - mu * mu, 1e-14))
        cos_psi = dr.clip((wi.x * wo.x + wi.y * wo.y) / (sin0 * sin), -1.0, 1.0)
        psi = dr.acos(cos_psi)
        sin2_half = 0.5 * (1.0 - cos_psi)
        e1 = lambda c, s: dr.exp(-2.0 / math.pi / tan_s * c / s)
        e2 = lambda c, s: dr.exp(-1.0 / math.pi / (tan_s * tan_s) * (c / s) * (c / s))
        e1i, e2i, e1e, e2e = e1(mu0, sin0), e2(mu0, sin0), e1(mu, sin), e2(mu, sin)
        eta = lambda c, s, one, two: chi * (c + s * tan_s * two / (2.0 - one))
        eta_i, eta_e = eta(mu0, sin0, e1i, e2i), eta(mu, sin, e1e, e2e)
        is_high = mu0 >= mu
        below = dr.select(is_high, 2.0 - e1e - psi / math.pi * e1i, 2.0 - e1i - psi / math.pi * e1e)
        of_i = dr.select(is_high, cos_psi * e2e + sin2_half * e2i, e2i - sin2_half * e2e)
        of_e = dr.select(is_high, e2e - sin2_half * e2i, cos_psi * e2i + sin2_half * e2e)
        mu0e = chi * (mu0 + sin0 * tan_s * of_i / below)
        mue = chi * (mu + sin * tan_s * of_e / below)
        f = dr.exp(-2.0 * dr.sqrt(sin2_half / dr.maximum(1.0 - sin2_half, 1e-12)))
        of = dr.select(is_high, mu0 / eta_i, mu / eta_e)
        shadowing = mue / eta_e * mu0 / eta_i * chi / (1.0 - f + f * chi * of)
        return mu0e, mue, shadowing

    def sample(self, ctx, si, sample1, sample2, active=True):
        wo = mi.warp.square_to_cosine_hemisphere(sample2)
        found = mi.BSDFSample3f()
        found.wo = wo
        found.pdf = mi.warp.square_to_cosine_hemisphere_pdf(wo)
        found.eta = 1.0
        found.sampled_type = mi.UInt32(+mi.BSDFFlags.DiffuseReflection)
        found.sampled_component = mi.UInt32(0)
        active = active & (mi.Frame3f.cos_theta(si.wi) > 0.0) & (found.pdf > 0.0)
        value = self.reflectance(si.wi, wo) / dr.maximum(found.pdf, 1e-12)
        return found, mi.Color1f(dr.select(active, value, 0.0))

    def eval(self, ctx, si, wo, active=True):
        active = active & (mi.Frame3f.cos_theta(si.wi) > 0.0) & (mi.Frame3f.cos_theta(wo) > 0.0)
        return mi.Color1f(dr.select(active, self.reflectance(si.wi, wo), 0.0))

    def pdf(self, ctx, si, wo, active=True):
        is_up = (mi.Frame3f.cos_theta(si.wi) > 0.0) & (mi.Frame3f.cos_theta(wo) > 0.0)
        return dr.select(active & is_up, mi.warp.square_to_cosine_hemisphere_pdf(wo), 0.0)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def to_string(self):
        return "Hapke[]"


mi.register_bsdf("hapke", Hapke)


def surface(material):
    if "lambert" in material:
        return {"type": "diffuse", "reflectance": {"type": "uniform", "value": material["lambert"]}}
    return {"type": "hapke", **material["hapke"]}


def ply(path, vertices, facets):
    """Vertices that no facet uses do no harm."""
    with open(path, "wb") as out:
        out.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(facets)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        )
        out.write(vertices.astype("<f4").tobytes())
        rows = np.zeros(len(facets), dtype=[("n", "u1"), ("v", "<i4", 3)])
        rows["n"], rows["v"] = 3, facets
        out.write(rows.tobytes())


camera = given["camera"]
h, v, u = (np.array(camera[axis]) for axis in "hvu")
to_world = np.eye(4)
# Mitsuba's sensor has +x to the left, +y up, +z along the boresight.
to_world[:3, 0], to_world[:3, 1], to_world[:3, 2], to_world[:3, 3] = -h, -v, u, camera["position_m"]
scene = {
    "type": "scene",
    "integrator": {"type": "path", "max_depth": given["max_depth"], "rr_depth": 1000},
    "sensor": {
        "type": "perspective",
        "fov": 2.0 * np.degrees(np.arctan(0.5 * camera["samples"] * camera["pitch"])),
        "fov_axis": "x",
        "near_clip": 0.5 * camera["range_m"],
        "far_clip": 2.0 * camera["range_m"],
        "to_world": mi.ScalarTransform4f(to_world),
        "sampler": {"type": "multijitter", "sample_count": given["rays"]},
        "film": {
            "type": "hdrfilm", "width": camera["samples"], "height": camera["lines"], "pixel_format": "luminance",
            "component_format": "float32", "rfilter": {"type": "box"},
        },
    },
}
for i, (direction, irradiance) in enumerate(given["lights"]):
    towards = [-x for x in direction]
    scene[f"light{i}"] = {
        "type": "directional", "direction": towards, "irradiance": {"type": "uniform", "value": irradiance},
        "sampling_weight": irradiance,
    }
vertices = np.array(given["vertices_m"])
for i, material in enumerate(given["materials"]):
    if material["facets"]:
        path = os.path.join(folder, f"material{i}.ply")
        ply(path, vertices, np.array(material["facets"]))
        scene[f"mesh{i}"] = {"type": "ply", "filename": path, "face_normals": True, "bsdf": surface(material)}

loaded = mi.load_dict(scene)
images = [np.array(mi.render(loaded, seed=seed, spp=given["rays"]), dtype=np.float64) for seed in range(given["seeds"])]
np.array(images).astype("<f8").tofile(os.path.join(folder, "images.f64"))
