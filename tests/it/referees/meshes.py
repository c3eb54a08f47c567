"""Meshes by other programs, for the tests: python meshes.py FOLDER

A box of 2 x 3 x 5 with its lowest corner at (10.5, -20.25, 1000.125), by trimesh, meshio, plyfile and numpy-stl; and an ellipsoid of 12.95 x 11.3 x 9.16 km as a
kernel by CSPICE (spiceypy), of which it prints the volume.
"""

import os
import sys

import meshio
import numpy as np
import spiceypy as sp
import stl
import trimesh
from plyfile import PlyData, PlyElement

folder = sys.argv[1]


def path(name):
    return os.path.join(folder, name)


corners = np.array([[x, y, z] for z in (0, 5) for x, y in ((0, 0), (2, 0), (2, 3), (0, 3))], float)
corners += [10.5, -20.25, 1000.125]
quads = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
triangles = np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])

box = trimesh.Trimesh(corners, triangles, process=False)
box.export(path("trimesh.stl"))
with open(path("trimesh_text.stl"), "w") as file:
    file.write(trimesh.exchange.stl.export_stl_ascii(box))
box.export(path("trimesh.ply"))
with open(path("trimesh_text.ply"), "wb") as file:
    file.write(trimesh.exchange.ply.export_ply(box, encoding="ascii"))
red_and_blue = [[255, 0, 0, 255]] * 6 + [[0, 0, 255, 255]] * 6
trimesh.Trimesh(corners, triangles, process=False, face_colors=red_and_blue).export(path("trimesh_colours.ply"))
for name, binary in (("meshio_text.ply", False), ("meshio.ply", True)):
    meshio.write(path(name), meshio.Mesh(corners, [("quad", quads)]), binary=binary)
kinds = [("x", "f8"), ("y", "f8"), ("z", "f8"), ("red", "u1"), ("green", "u1"), ("blue", "u1")]
vertices = np.array([tuple(corner) + (10, 200, 30) for corner in corners], dtype=kinds)
faces = np.array([(t,) for t in triangles.astype("i4")], dtype=[("vertex_indices", "i4", (3,))])
elements = [PlyElement.describe(vertices, "vertex"), PlyElement.describe(faces, "face")]
PlyData(elements, byte_order=">").write(path("plyfile_big.ply"))
solid = stl.mesh.Mesh(np.zeros(len(triangles), dtype=stl.mesh.Mesh.dtype))
for i, triangle in enumerate(triangles):
    solid.vectors[i] = corners[triangle]
solid.save(path("numpy_stl.stl"))

ball = trimesh.creation.icosphere(subdivisions=2)
ball.apply_scale([12.95, 11.3, 9.16])
plates = np.ascontiguousarray(ball.faces + 1, dtype=np.int32)
points = np.ascontiguousarray(ball.vertices)
if os.path.exists(path("ellipsoid.bds")):
    os.remove(path("ellipsoid.bds"))
handle = sp.dskopn(path("ellipsoid.bds"), "ELLIPSOID", 0)
doubles, integers = sp.dskmi2(points, plates, 2.0, 4, 200000, 200000, 200000, False, 1000000)
low, high = sp.dskrb2(points, plates, 1, [0.0] * 10)
limits = [-np.pi, np.pi, -np.pi / 2, np.pi / 2, low, high]
sp.dskw02(handle, 401, 1, 2, "J2000", 1, [0.0] * 10, *limits, 0.0, 1e9, points, plates, doubles, integers)
sp.dskcls(handle, True)
print(len(points), len(plates), repr(float(ball.volume)), repr([float(x) for x in points[7]]), list(map(int, plates[100])))
