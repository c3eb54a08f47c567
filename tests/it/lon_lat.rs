//! Maps of longitudes and latitudes on bodies: each place has the texel that it lies in, about the poles and across the seam.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::{DQuat, DVec3};
use mmxrt::geometry::{LonLat, MaterialId, Mesh, Texels};
use mmxrt::scene::{Texture, TextureKind};

use crate::cli::run;
use crate::scenes::{SQUARE, replaced};
use crate::scratch::Scratch;

/// Of corners at 4 m on the axes; each face is an octant.
pub(crate) const OCTAHEDRON: &str = "v 4 0 0\nv 0 4 0\nv -4 0 0\nv 0 -4 0\nv 0 0 4\nv 0 0 -4\n\
    f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n";

/// From 1 km above the North pole: each of 2 x 2 pixels of 4 m has one face in half of it.
pub(crate) fn prepared(more: &[(&str, &str)]) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("octahedron.obj", OCTAHEDRON);
    let scene = replaced(
        SQUARE,
        &[
            ("[0, 0, 11000]\n[[mesh]]", "[0, 0, 0]\n[[mesh]]"),
            ("square.obj", "octahedron.obj"),
            ("12000", "1000"),
            ("11000", "0"),
        ],
    );
    scratch.write("scene.toml", replaced(&scene, more));
    scratch
}

pub(crate) fn cube(scratch: &Scratch) -> Vec<f64> {
    let bytes = std::fs::read(scratch.join("out/cube.img")).unwrap();
    bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
}

/// What is seen of the quarters from longitude 0, 90, 180 and 270 on, of values of columns that begin at a longitude: a quarter's face fills half a pixel.
pub(crate) fn assert_quarters(image: &[f64], expected: [f64; 4], what: &str) {
    let found = [image[1], image[0], image[2], image[3]];
    let off = found.iter().zip(expected).map(|(a, b)| (a - 0.5 * b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-3, "{what}: {found:?}, expected half of {expected:?}");
}

#[test]
fn radiance_maps_begin_at_the_longitude_that_they_say() {
    let scratch = prepared(&[]);
    let integrate = |map: &str, west: &str| {
        scratch.write("map.csv", map);
        scratch.write(
            "map.map.toml",
            format!(
                "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = {{ centres_um = [1.0] }}\nplacement = \"lonlat\"\n{west}"
            ),
        );
        let (scene, map, out) = (scratch.argument("scene.toml"), scratch.argument("map.csv"), scratch.argument("out"));
        run(&["integrate", &scene, "--radiance", &map, "-o", &out, "--dtype", "f64", "--force", "--unknown", "0"])
    };
    for (map, west_deg, expected) in [
        ("1,2,3,4\n", 0, [1.0, 2.0, 3.0, 4.0]),
        ("1,2,3,4\n", -180, [3.0, 4.0, 1.0, 2.0]),
        ("1,2,3,4\n", 90, [4.0, 1.0, 2.0, 3.0]),
        // The middle of each face is a border of columns.
        ("1,2,3,4\n", 45, [2.5, 1.5, 2.5, 3.5]),
        // The South is not seen, and what is not known is 0.
        ("1,2,3,4\n9,9,9,9\n", 0, [1.0, 2.0, 3.0, 4.0]),
        ("1,nan,3,4\n", 0, [1.0, 0.0, 3.0, 4.0]),
        ("1,nan,3,4\n", 45, [2.5, 0.5, 1.5, 3.5]),
        ("7\n", 12, [7.0; 4]),
    ] {
        let (code, out, err) = integrate(map, &format!("west_deg = {west_deg}\n"));
        assert_eq!(code, 0, "{out}{err}");
        assert_quarters(&cube(&scratch), expected, &format!("{map} from {west_deg}"));
    }
    let (code, _, err) = integrate("1,2\n", "");
    assert!(code == 1 && err.contains("west_deg") && err.contains("0 if it goes from 0 to 360"), "{err}");
    let (code, _, err) = integrate("1,2\n", "west_deg = 500\n");
    assert!(code == 1 && err.contains("expected -360 to 360"), "{err}");
    let (code, _, err) = integrate("1,2\n", "west_deg = 0\nwrap = \"repeat\"\n");
    assert!(code == 1 && err.contains("does not go with this placement"), "{err}");
}

#[test]
fn maps_in_metres_are_of_a_whole_body_only_if_they_can_be() {
    let scratch = prepared(&[]);
    scratch.write(
        "map.map.toml",
        "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [1.0] }\nplacement = \"lonlat\"\nwest_deg = 0\n",
    );
    let integrate = |lines: usize| {
        scratch.write("map.img", [1.0_f32, 2.0, 3.0, 4.0].map(f32::to_le_bytes).concat().repeat(lines));
        let place = "map info = {Cylindrical, 1, 1, 0, 6, 6, 6, units=Meters}";
        let head =
            format!("ENVI\nsamples = 4\nlines = {lines}\nbands = 1\ndata type = 4\nbyte order = 0\ninterleave = bsq\n");
        scratch.write("map.hdr", format!("{head}{place}\n"));
        let (scene, map, out) = (scratch.argument("scene.toml"), scratch.argument("map.img"), scratch.argument("out"));
        run(&["integrate", &scene, "--radiance", &map, "-o", &out, "--dtype", "f64", "--force"])
    };
    // 24 x 12 m, around a body; and 24 x 24 m, as no cylindrical map of a whole body is.
    let (code, _, err) = integrate(2);
    assert!(code == 0 && err.contains("24 x 12 m: taken for the whole body"), "{err}");
    assert_quarters(&cube(&scratch), [1.0, 2.0, 3.0, 4.0], "metres");
    let (code, _, err) = integrate(4);
    assert!(code == 1 && err.contains("twice as wide as it is high"), "{err}");
}

#[test]
fn textures_lie_by_longitude_and_latitude() {
    let texture = "reflectance = 0.1, texture = { raster = \"map.csv\", quantity = \"reflectance\", placement = \"lonlat\", west_deg = -180 }";
    let scratch =
        prepared(&[("[materials.default]\nreflectance = 0.1", &format!("[materials]\ndefault = {{ {texture} }}"))]);
    scratch.write("map.csv", "0.1,0.2,0.3,0.4\n");
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let (code, said, err) = run(&["simulate", &scene, "-o", &out, "--dtype", "f64", "--model", "sunlight"]);
    assert_eq!(code, 0, "{said}{err}");
    let image = cube(&scratch);
    // All faces stand alike in the light: radiances are as reflectances.
    let sum = image.iter().sum::<f64>();
    let shares: Vec<f64> = image.iter().map(|v| 2.0 * v / sum).collect();
    assert_quarters(&shares, [0.3, 0.4, 0.1, 0.2].map(|r| 2.0 * 2.0 * r), "texture");
}

/// An octahedron of a sphere, divided four times, turned so that poles and seam lie anywhere in facets.
fn sphere() -> Mesh {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let corner = |i: usize| [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z][i];
    let faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
    let mut triangles: Vec<[DVec3; 3]> = faces.iter().map(|face| face.map(corner)).collect();
    for _ in 0..4 {
        let quarters = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(quarters).collect();
    }
    let mut mesh = Mesh::default();
    for triangle in triangles {
        let first = mesh.vertices_m.len() as u32;
        mesh.vertices_m.extend(triangle.map(|corner| turn * corner + DVec3::new(5.0, -7.0, 9.0)));
        mesh.facets.push([first, first + 1, first + 2]);
        mesh.material.push(MaterialId(0));
    }
    mesh
}

#[test]
fn means_over_a_sphere_are_those_of_its_integrals() {
    let mesh = sphere();
    // Of cos(latitude) over a sphere: pi / 4. Of a hemisphere about longitude 180: half.
    let (columns, rows) = (36, 90);
    let latitude = |row: usize| PI * (0.5 - (row as f64 + 0.5) / rows as f64);
    let cosine = |row: usize, _: usize| latitude(row).cos();
    // From 0 on, columns 9 to 26 are from 90 to 270 deg.
    let far = |_: usize, column: usize| f64::from(u8::from((9..27).contains(&column)));
    let map = LonLat { centre_m: DVec3::new(5.0, -7.0, 9.0), west_deg: 0.0, columns, rows };
    for texels in [Texels::Nearest, Texels::Bilinear] {
        let mean = |value: &dyn Fn(usize, usize) -> f64| {
            let held = (0..rows).flat_map(|row| (0..columns + 2).map(move |c| (row, (c + columns - 1) % columns)));
            let texture = Texture {
                material: MaterialId(0),
                kind: TextureKind::Factor,
                lon_lat: Some(map),
                corners: vec![],
                rows,
                columns: columns + 2,
                wavelength_um: vec![],
                values: held.map(|(row, column)| value(row, column)).collect(),
                texels,
            };
            texture.means(&mesh)[0]
        };
        assert!((mean(&cosine) - FRAC_PI_4).abs() < 2e-3, "{texels:?}: {}", mean(&cosine));
        assert!((mean(&far) - 0.5).abs() < 1e-3, "{texels:?}: {}", mean(&far));
        assert!((mean(&|_, _| 3.0) - 3.0).abs() < 1e-9);
    }
}
