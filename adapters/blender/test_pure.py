"""The add-on's modules that need no Blender: `python3 test_pure.py`, with NumPy. With MMXRT, a path of the program, what they write is simulated too."""

import io
import math
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from mmxrt import camera, program, toml_text  # noqa: E402

try:
    import numpy as np

    from mmxrt import envi, obj, scene_toml
except ImportError:
    np = None

try:
    import tomllib
except ImportError:
    tomllib = None

needs_numpy = unittest.skipIf(np is None, "there is no NumPy, which Blender brings")
LOOKS_DOWN = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


class Camera(unittest.TestCase):
    def test_pixels_by_hand(self):
        # 36 mm over 96 pixels at 35 mm; 1 m aside at 10 m is 0.1 focal lengths.
        keys = camera.lens(96, 72, 35.0, 36.0, 24.0, "AUTO", (0.0, 0.0))
        sample, line, depth = camera.pixel(LOOKS_DOWN, keys, (1.0, 0.5, -10.0))
        self.assertAlmostEqual(sample, 48 + 0.1 * 35 * 96 / 36, places=12)
        self.assertAlmostEqual(line, 36 - 0.05 * 35 * 96 / 36, places=12)
        self.assertEqual(depth, 10.0)
        self.assertEqual(camera.pixel(LOOKS_DOWN, keys, (0.0, 0.0, 5.0))[2], -5.0)

    def test_the_fit_says_which_side_the_sensor_is(self):
        for fit, size, sensor in [("AUTO", 96, 36.0), ("HORIZONTAL", 96, 36.0), ("VERTICAL", 72, 24.0)]:
            (across, down), _ = camera.pinhole(camera.lens(96, 72, 50.0, 36.0, 24.0, fit, (0, 0)))
            self.assertAlmostEqual(across, sensor / 50 / size, places=15)
            self.assertEqual(across, down)
        # Upright, AUTO goes by the height, and still by the width of the sensor.
        (across, _), _ = camera.pinhole(camera.lens(72, 96, 50.0, 36.0, 24.0, "AUTO", (0, 0)))
        self.assertAlmostEqual(across, 36.0 / 50 / 96, places=15)

    def test_shifts_count_in_sizes_of_the_sensor(self):
        keys = camera.lens(96, 72, 50.0, 36.0, 24.0, "VERTICAL", (0.25, -0.5))
        self.assertEqual(camera.pinhole(keys)[1], (48 - 0.25 * 72, 36 - 0.5 * 72))
        # Pixels twice as high as wide: the image is 96 x 144 widths of a pixel, upright.
        keys = camera.lens(96, 72, 50.0, 36.0, 24.0, "AUTO", (0.0, 0.5), 2.0)
        (across, down), (_, line) = camera.pinhole(keys)
        self.assertAlmostEqual(across, 36 / 50 / 144, places=15)
        self.assertEqual((down, line), (2 * across, 36 + 0.5 * 144 / 2))

    def test_scales_of_the_object_go(self):
        turned = [[0, -3, 0, 7], [2, 0, 0, 8], [0, 0, 5, 9], [0, 0, 0, 1]]
        self.assertEqual(camera.unscaled(turned), [[0, -1, 0, 7], [1, 0, 0, 8], [0, 0, 1, 9], [0, 0, 0, 1]])
        self.assertFalse(camera.is_mirrored(turned))
        self.assertTrue(camera.is_mirrored([[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]))
        self.assertRaises(ValueError, camera.unscaled, [[0, 0, 0, 0]] * 4)

    def test_percentages_are_cut_off(self):
        self.assertEqual(camera.resolution(1921, 1081, 50), (960, 540))
        self.assertEqual(camera.resolution(10, 1, 1), (1, 1))


class Toml(unittest.TestCase):
    @unittest.skipIf(tomllib is None, "Python before 3.11 reads no TOML")
    def test_values_come_back(self):
        keys = {
            "plain": 0.1, "whole": 3, "yes": True, 'with "quotes" \\ and\nlines\x01\x7f': "a\tb\"", "list": [1.5, -2e-300],
            "#b03020": {"deep er": {"x": 1e22}}, "empty": {}, "none": [],
        }
        self.assertEqual(tomllib.loads(toml_text.table("a", keys))["a"], keys)
        self.assertEqual(tomllib.loads(toml_text.table("a", {"b": toml_text.Raw("{ c = 1 }"), "d": None})), {"a": {"b": {"c": 1}}})

    def test_what_is_no_number_is_refused(self):
        self.assertRaises(ValueError, toml_text.value, math.nan)
        self.assertRaises(ValueError, toml_text.value, [math.inf])


def tetrahedron():
    """On three unit axes: volume 1/6, outer sides outside."""
    return obj.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], [0, 1, 1, 0], ["red rock", "b"])


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


@needs_numpy
class Meshes(unittest.TestCase):
    def test_outside_stays_outside_where_a_matrix_mirrors(self):
        matrix = np.diag([2.0, -3.0, 1.0, 1.0])
        matrix[:3, 3] = 1e4, -2e4, 5.0
        placed = tetrahedron().placed(matrix)
        moved = obj.Mesh(placed.vertices - [1e4, -2e4, 5], placed.triangles, placed.material, placed.names)
        self.assertAlmostEqual(volume(moved), 1.0, places=12)
        self.assertEqual(placed.vertices[1].tolist(), [10002.0, -20000.0, 5.0])

    def test_digits_names_and_texture_coordinates_are_written(self):
        mesh = tetrahedron()
        mesh.vertices = mesh.vertices * 0.1 + [12345.678901234567, 1e-9, -1 / 3]
        mesh.uv = np.random.default_rng(0).random((4, 3, 2))
        file = io.StringIO()
        obj.write(file, [("one\n", mesh), ("two", mesh)])
        lines = [line.split(" ", 1) for line in file.getvalue().splitlines()]
        vertices = [[float(x) for x in rest.split()] for word, rest in lines if word == "v"]
        self.assertEqual(vertices, mesh.vertices.tolist() * 2)
        textures = [[float(x) for x in rest.split()] for word, rest in lines if word == "vt"]
        current, faces = None, []
        for word, rest in lines:
            current = rest if word == "usemtl" else current
            if word == "f":
                corners = [[int(i) - 1 for i in corner.split("/")] for corner in rest.split()]
                faces.append((current, [vertices[v] for v, _ in corners], [textures[t] for _, t in corners]))
        self.assertEqual(len(faces), 8)
        self.assertEqual({name for name, *_ in faces}, {"red rock", "b"})
        wanted = [
            (mesh.names[mesh.material[i]], mesh.vertices[mesh.triangles[i]].tolist(), mesh.uv[i].tolist()) for i in (0, 3, 1, 2)
        ]
        self.assertEqual(faces, wanted * 2)

    def test_instances_keep_all_digits(self):
        matrices = np.random.default_rng(1).random((3, 4, 4))
        file = io.StringIO()
        obj.write_instances(file, matrices)
        rows = [line.split(",") for line in file.getvalue().splitlines()]
        for row, matrix in zip(rows[1:], matrices):
            cells = {name: float(cell) for name, cell in zip(rows[0], row)}
            self.assertEqual([cells[k] for k in ("x_m", "y_m", "z_m")], matrix[:3, 3].tolist())
            self.assertEqual([cells[a + b] for a in "xyz" for b in "xyz"], matrix[:3, :3].ravel().tolist())

    def test_colours_are_srgb(self):
        # IEC 61966-2-1: 0x80 is 0.2158605, 10 of 255 lies on the straight part.
        self.assertAlmostEqual(float(obj.linear(128 / 255)), 0.2158605, places=7)
        self.assertAlmostEqual(float(obj.linear(10 / 255)), 10 / 255 / 12.92, places=15)
        index, names = obj.colour_keys(obj.linear(np.array([[176, 48, 32], [0, 0, 255], [176, 48, 32]]) / 255))
        self.assertEqual([names[i] for i in index], ["#b03020", "#0000ff", "#b03020"])
        self.assertTrue(np.allclose(obj.colour_of_key("#b03020"), obj.linear(np.array([176, 48, 32]) / 255), atol=1e-15))
        self.assertAlmostEqual(float(obj.luminance([1, 1, 1])), 1.0, places=15)

    def test_only_sheets_are_seen_from_behind(self):
        sheet = obj.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [0], ["a"])
        self.assertFalse(obj.is_seen_from_behind(sheet, (0.2, 0.2, 9)))
        self.assertTrue(obj.is_seen_from_behind(sheet, (0.2, 0.2, -9)))
        for eye in ((9, 9, 9), (-9, -9, -9)):
            self.assertFalse(obj.is_seen_from_behind(tetrahedron(), eye))

    def test_names_are_those_that_readers_make(self):
        self.assertEqual([obj.plain_name(n) for n in (" a b ", "a\nb", "a\\", "#b03020")], ["a b", "a_b", "a\\_", "#b03020"])


@needs_numpy
class Scenes(unittest.TestCase):
    def scene(self):
        """A square sheet, 2 m wide, in two places, and one of another material where it is."""
        sheet = obj.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], [0, 0], ["red rock"])
        other = obj.Mesh(sheet.vertices, sheet.triangles, [0, 0], ["grey"])
        scene = scene_toml.Scene()
        places = np.array([np.eye(4)] * 2)
        # The second is mirrored, which turns it over, and turned over again by half a turn about x.
        places[0, 0, 3], places[1] = -4.0, np.diag([-1.0, -1.0, -1.0, 1.0]) @ np.diag([1.0, 1.0, -1.0, 1.0])
        scene.instanced = [("a sheet", sheet, places)]
        scene.objects = [("other", other.placed([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]))]
        scene.materials = {"red rock": {"reflectance": 0.3}, "grey": {"reflectance": 0.6}}
        scene.sun = scene_toml.sun([0.6, 0.0, 0.8], 2.5, 0.0)
        scene.camera_to_world = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 20], [0, 0, 0, 1]]
        scene.sensor = camera.lens(120, 40, 50.0, 36.0, 24.0, "AUTO", (0.0, 0.0))
        return scene

    def test_a_disc_of_the_suns_size_is_at_one_au(self):
        # 2 asin(695 700 km / 149 597 870.7 km).
        keys = scene_toml.sun([0, 0, 1], 3.0, 2 * math.asin(695_700.0 / 149_597_870.7))
        self.assertAlmostEqual(keys["distance_au"], 1.0, places=12)
        self.assertEqual(scene_toml.sun([0, 0, 1], 3.0, 0.0)["points"], 1)
        self.assertNotIn("irradiance", scene_toml.sun([0, 0, 1], 3.0, 0.1, 1.5))

    def test_a_folder_of_something_else_is_left_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "thesis.txt"), "w", encoding="utf-8") as file:
                file.write("mine")
            self.assertRaises(FileExistsError, scene_toml.write, self.scene(), folder)
            self.assertEqual(os.listdir(folder), ["thesis.txt"])
            target = os.path.join(folder, "scene")
            for _ in range(2):
                scene_toml.write(self.scene(), target)
            self.assertEqual(sorted(os.listdir(target)), ["scene.a_sheet.csv", "scene.a_sheet.obj", "scene.obj", "scene.toml"])
            # Nothing is left of a scene that cannot be written.
            self.assertRaises(ValueError, scene_toml.write, scene_toml.Scene(), os.path.join(folder, "none"))
            self.assertEqual(sorted(os.listdir(folder)), ["scene", "thesis.txt"])

    @unittest.skipIf(tomllib is None, "Python before 3.11 reads no TOML")
    def test_a_site_has_its_own_axes(self):
        scene = self.scene()
        scene.is_site, scene.origin_m = True, [0.0, 11e3, 0.0]
        scene.lamps = [{"name": "lamp", "direction": [0.0, 0.0, 1.0], "irradiance": 0.5}]
        scene.more = "[thermal]\nmodel = \"off\""
        said = tomllib.loads(scene_toml.text(scene, "one"))
        self.assertEqual([mesh["pose"] for mesh in said["mesh"]], ["radial", "radial"])
        self.assertEqual([mesh["file"] for mesh in said["mesh"]], ["one.obj", "one.a_sheet.obj"])
        self.assertEqual([said[k]["frame"] for k in ("sun", "observer")] + [said["lamps"][0]["frame"]], ["site"] * 3)
        self.assertNotIn("coordinates", said["observer"])
        self.assertEqual((said["thermal"], said["origin_m"]), ({"model": "off"}, [0.0, 11e3, 0.0]))
        if "MMXRT" not in os.environ:
            return
        with tempfile.TemporaryDirectory() as folder:
            scene_toml.write(scene, folder)
            run = subprocess.run([os.environ["MMXRT"], "inspect", os.path.join(folder, "scene.toml")], capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertRegex(run.stdout, "warnings: none")

    def test_names_of_files_are_each_once(self):
        taken = {"surface"}
        self.assertEqual([scene_toml.unique(n, taken) for n in ("Surface", "a b", "a/b", "")], ["Surface_2", "a_b", "a_b_2", "_"])

    @unittest.skipIf("MMXRT" not in os.environ, "MMXRT does not say where the program is")
    def test_the_program_sees_what_was_written(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = self.scene()
            scene.textures = {"grey": (np.full((2, 2), 0.5), {"quantity": "reflectance", "placement": "atlas", "wrap": "repeat"})}
            uv = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)
            scene.objects[0][1].uv = uv
            scene_toml.write(scene, os.path.join(folder, "scene"))
            product = os.path.join(folder, "product")
            program.simulate(os.environ["MMXRT"], os.path.join(folder, "scene", "scene.toml"), product, ["--model", "sunlight"])
            cube = envi.Cube(os.path.join(product, "cube.hdr"))
            # In the middles of the three sheets, at x = -4, 0 and 4: rho E cos i / pi. A pixel is 36 / 50 / 120 x 20 m = 0.12 m.
            for x, reflectance in ((-4, 0.3), (0, 0.3), (4, 0.5)):
                found = float(cube.bands[0, 20, int(60 + x / 0.12)])
                self.assertAlmostEqual(found / (reflectance * 2.5 * 0.8 / math.pi), 1.0, places=6)
            self.assertEqual(float(cube.bands[0, 20, 42]), 0.0)
            # What it refuses is said in its own words.
            with self.assertRaisesRegex(RuntimeError, "nowhere.toml"):
                program.simulate(os.environ["MMXRT"], os.path.join(folder, "nowhere.toml"), product)


@needs_numpy
class Envi(unittest.TestCase):
    def test_all_orders_are_read(self):
        # [band, line, sample]
        values = np.arange(24, dtype=float).reshape(2, 3, 4)
        with tempfile.TemporaryDirectory() as folder:
            for interleave, axes in (("bsq", (0, 1, 2)), ("bil", (1, 0, 2)), ("bip", (1, 2, 0))):
                for code, kind in ((4, "<f4"), (5, ">f8"), (2, ">i2")):
                    stem = os.path.join(folder, f"cube_{interleave}_{code}")
                    with open(stem + ".img", "wb") as file:
                        file.write(b"head" + values.transpose(axes).astype(kind).tobytes())
                    with open(stem + ".hdr", "w", encoding="utf-8") as file:
                        file.write(
                            f"ENVI\nsamples = 4\nlines = 3\nbands = 2\nheader offset = 4\ndata type = {code}\ninterleave = {interleave}\n"
                            f"byte order = {int(kind[0] == '>')}\nwavelength units = Nanometers\nwavelength = {{\n 950,\n 1000}}\n"
                            "band names = {a, b = c}\n"
                        )
                    for path in (stem + ".img", stem + ".hdr"):
                        cube = envi.Cube(path)
                        self.assertTrue((np.asarray(cube.bands, float) == values).all(), stem)
                        self.assertEqual((cube.wavelength_um, cube.names), ([0.95, 1.0], ["a", "b = c"]))
            image = envi.Cube(stem + ".img").image((1, 0, 0))
            # The first line of Blender's images is the lowest one.
            self.assertEqual(image[0, 0].tolist(), [20.0, 8.0, 8.0, 1.0])
            self.assertRaises(ValueError, envi.Cube(stem + ".img").image, 2)
            os.truncate(stem + ".img", 20)
            self.assertRaises(ValueError, envi.Cube, stem + ".hdr")
            os.remove(stem + ".img")
            self.assertRaises(FileNotFoundError, envi.Cube, stem + ".hdr")

    def test_what_is_no_number_is_transparent(self):
        with tempfile.TemporaryDirectory() as folder:
            np.array([1.0, np.nan], "<f4").tofile(os.path.join(folder, "a.img"))
            with open(os.path.join(folder, "a.hdr"), "w", encoding="utf-8") as file:
                file.write("ENVI\nsamples = 2\nlines = 1\nbands = 1\ndata type = 4\n")
            image = envi.Cube(os.path.join(folder, "a.hdr")).image(0)
            self.assertEqual(image.tolist(), [[[1, 1, 1, 1], [0, 0, 0, 0]]])


class Program(unittest.TestCase):
    def test_a_program_that_is_not_there_is_told(self):
        self.assertRaisesRegex(FileNotFoundError, "preferences", program.find, "/nowhere/mmxrt")


class Modules(unittest.TestCase):
    def test_all_of_the_add_on_is_python(self):
        folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "mmxrt")
        names = [name for name in os.listdir(folder) if name.endswith(".py")]
        self.assertIn("headless.py", names)
        for name in names:
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                compile(file.read(), name, "exec")


if __name__ == "__main__":
    unittest.main()
