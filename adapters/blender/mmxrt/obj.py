"""Meshes as OBJ, tables of where their instances stand, and colours. NumPy, no `bpy`."""

import numpy as np


def plain_name(name):
    """The nearest name that a line of OBJ can hold, which is the one that its reader makes."""
    name = "".join("_" if ord(c) < 32 or 127 <= ord(c) < 160 else c for c in name.strip())
    return name + "_" if name.endswith("\\") else name


class Mesh:
    """Triangles as Blender renders them.

    `vertices` [n, 3] f64; `triangles` [m, 3]; `material` [m], index into `names`; `uv` [m, 3, 2] or None.
    """

    def __init__(self, vertices, triangles, material, names, uv=None):
        self.vertices = np.asarray(vertices, float).reshape(-1, 3)
        self.triangles = np.asarray(triangles, np.int64).reshape(-1, 3)
        self.material = np.asarray(material, np.int64)
        self.names = list(names)
        self.uv = None if uv is None else np.asarray(uv, float).reshape(-1, 3, 2)

    def placed(self, matrix):
        """The mesh where a 4 x 4 matrix puts it; outer sides stay outside where that mirrors."""
        matrix = np.asarray(matrix, float)
        vertices = self.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) >= 0.0:
            return Mesh(vertices, self.triangles, self.material, self.names, self.uv)
        uv = None if self.uv is None else self.uv[:, [0, 2, 1]]
        return Mesh(vertices, self.triangles[:, [0, 2, 1]], self.material, self.names, uv)


def write(file, objects):
    """Writes named meshes to a text file: vertices with all digits, `usemtl` before each run of faces of a material.

    There is no MTL: names say all, and colours that nearly agree would fit several entries of a scene's dictionary.
    """
    first_vertex, first_texture = 1, 1
    for name, mesh in objects:
        file.write(f"o {plain_name(name)}\n")
        file.write("".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist()))
        textures = None
        if mesh.uv is not None and len(mesh.uv):
            known, textures = np.unique(mesh.uv.reshape(-1, 2), axis=0, return_inverse=True)
            textures = textures.reshape(-1, 3) + first_texture
            file.write("".join(f"vt {u!r} {v!r}\n" for u, v in known.tolist()))
            first_texture += len(known)
        # Faces by material, otherwise in their order.
        order = np.argsort(mesh.material, kind="stable")
        corners = mesh.triangles + first_vertex
        for material in np.unique(mesh.material):
            file.write(f"usemtl {plain_name(mesh.names[material])}\n")
            own = order[mesh.material[order] == material]
            if textures is None:
                lines = (f"f {a} {b} {c}\n" for a, b, c in corners[own].tolist())
            else:
                both = np.stack([corners[own], textures[own]], axis=2).reshape(-1, 6).tolist()
                lines = (f"f {a}/{i} {b}/{j} {c}/{k}\n" for a, i, b, j, c, k in both)
            file.write("".join(lines))
        first_vertex += len(mesh.vertices)


# Columns of a table of instances: where the mesh's origin is, and the rows of the matrix that turns and scales it.
INSTANCES = ["x_m", "y_m", "z_m", "xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"]


def write_instances(file, matrices):
    """Writes 4 x 4 matrices [n, 4, 4] as a table of instances, with all digits."""
    matrices = np.asarray(matrices, float)
    rows = np.concatenate([matrices[:, :3, 3], matrices[:, :3, :3].reshape(-1, 9)], axis=1)
    file.write(",".join(INSTANCES) + "\n")
    file.write("".join(",".join(map(repr, row)) + "\n" for row in rows.tolist()))


def srgb_bytes(linear):
    """Linear colours [n, 3] as sRGB bytes (IEC 61966-2-1)."""
    linear = np.clip(np.asarray(linear, float), 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, 1.0 / 2.4) - 0.055)
    return np.rint(255.0 * encoded).astype(np.int64)


def linear(srgb):
    """Linear values of sRGB ones, both 0 to 1."""
    srgb = np.asarray(srgb, float)
    return np.where(srgb <= 0.04045, srgb / 12.92, np.power((srgb + 0.055) / 1.055, 2.4))


def luminance(rgb):
    """Luminance of linear colours [..., 3], ITU-R BT.709: the reflectance of a colour where no spectrum is given."""
    return np.asarray(rgb, float)[..., :3] @ np.array([0.2126, 0.7152, 0.0722])


def colour_keys(colours):
    """Names of materials, `#rrggbb`, of linear colours [n, 3]; index of each colour's name, and the names."""
    rgb = srgb_bytes(colours)
    packed, index = np.unique(rgb @ np.array([1 << 16, 1 << 8, 1]), return_inverse=True)
    return index.reshape(-1), [f"#{number:06x}" for number in packed.tolist()]


def colour_of_key(name):
    """The linear colour of `#rrggbb`."""
    return linear([int(name[i:i + 2], 16) / 255.0 for i in (1, 3, 5)])


def is_seen_from_behind(mesh, eye):
    """Whether a mesh with open edges shows more of its inner sides to an eye, than of its outer ones: those are black, and Blender shows both."""
    edges = np.sort(np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]]), axis=1)
    if len(edges) == 0:
        return False
    _, uses = np.unique(edges[:, 0] * np.int64(len(mesh.vertices)) + edges[:, 1], return_counts=True)
    if not (uses == 1).any():
        return False
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] - np.asarray(eye, float) for k in range(3))
    # Six times the volumes of tetrahedra to the eye: positive where the outer side is turned away from it.
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) / np.maximum(np.einsum("ij,ij->i", a, a), 1e-300) ** 1.5
    return bool(np.nansum(away) > 0.0)
