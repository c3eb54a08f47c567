//! Textures inside facets: neutral where they should be, exact where they are not.

use mmxrt::geometry::{MaterialId, Mesh, Texels};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Scene, Texture, TextureKind, Thermal};
use mmxrt::spectral::Band;
use mmxrt::study;

use crate::scenes::{SQUARE, SQUARE_OBJ, edited, mars, scene};
use crate::scratch::Scratch;
use crate::shapes::*;

fn radiance(scene: &Scene, band: usize) -> Vec<f64> {
    study::simulate(scene, &unwatched).unwrap().1.cube.band(band)
}

/// A texture of `columns` x `rows` texels on the horizontal square of half width `r`, columns along x, rows along -y.
fn on_plane(mesh: &Mesh, r: f64, columns: usize, rows: usize, values: Vec<f64>) -> Texture {
    let texel = |f: usize| {
        mesh.facet(f).corners_m.map(|p| [(p.x + r) / (2.0 * r) * columns as f64, (r - p.y) / (2.0 * r) * rows as f64])
    };
    Texture {
        material: MaterialId(0),
        kind: TextureKind::Factor,
        corners: (0..mesh.facets.len()).map(texel).collect(),
        rows,
        columns,
        wavelength_um: vec![],
        values,
        texels: Texels::Nearest,
        lon_lat: None,
    }
}

/// Ground with a post, lit from the side, warm and under Mars: lit, shadowed and half-lit pixels.
fn post() -> Scene {
    let mesh = joined(&[plane(5.0, 0.0), cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 2.0])]);
    let scene = scene(mesh, camera([6.0, -9.0, 20.0], [0.0; 3], [0.0, 1.0, 0.0], 24, 0.025), [1.0, 0.3, 0.7]);
    edited(&scene, |scene| {
        scene.models.thermal = Thermal::Equilibrium;
        scene.sky.mars = Some(mars(glam::DVec3::new(3e6, 2e6, 8.7e6)));
        scene.exposure.bands.push(Band::new(3.5, Some(0.1)));
    })
}

/// The scene with a texture.
fn with(scene: &Scene, texture: Texture) -> Scene {
    edited(scene, |scene| scene.surface.textures = vec![texture])
}

#[test]
fn a_texture_of_ones_changes_nothing() {
    let plain = post();
    for (texels, layers) in
        [(Texels::Nearest, vec![]), (Texels::Bilinear, vec![]), (Texels::Nearest, vec![1.0, 2.0, 4.0])]
    {
        let count = layers.len().max(1);
        let ones = on_plane(&plain.body.mesh, 5.0, 37, 23, vec![1.0; 37 * 23 * count]);
        let textured = with(&plain, Texture { texels, wavelength_um: layers, ..ones });
        for band in 0..2 {
            let (a, b) = (radiance(&plain, band), radiance(&textured, band));
            let largest = a.iter().copied().fold(0.0, f64::max);
            let worst = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(largest > 0.1 && worst < 1e-14 * largest, "band {band}, {texels:?}: {:e}", worst / largest);
        }
    }
}

#[test]
fn what_an_image_receives_of_a_texture_is_its_mean() {
    // All of the square is in the image; texels count alike, also bilinearly: the half of an outer texel that has no neighbour is held.
    let mesh = plane(5.0, 0.0);
    let values: Vec<f64> = (0..37 * 23).map(|i| ((i * 7919) % 101) as f64 / 40.0).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let plain = scene(mesh.clone(), nadir(1000.0, 12.0, 11), [0.4, 0.3, 1.0]);
    let sent: f64 = radiance(&plain, 0).iter().sum();
    for texels in [Texels::Nearest, Texels::Bilinear] {
        let texture = Texture { texels, ..on_plane(&mesh, 5.0, 37, 23, values.clone()) };
        assert!((texture.means(&mesh)[0] / mean - 1.0).abs() < 1e-13, "{texels:?}: {:?} {mean}", texture.means(&mesh));
        let textured = with(&plain, texture);
        let received: f64 = radiance(&textured, 0).iter().sum();
        assert!((received / sent / mean - 1.0).abs() < 1e-11, "{texels:?}: {:e}", received / sent / mean - 1.0);
    }
}

#[test]
fn a_checkerboard_halves_what_it_halves() {
    // Pixels of 0.7 m on texels of 0.1 m, factors 2 and 0: 50 or 48 of 49 of the light.
    let mesh = plane(4.2, 0.0);
    let plain = scene(mesh.clone(), nadir(1000.0, 8.4, 12), [0.0, 0.3, 1.0]);
    let values = (0..84 * 84).map(|i| if (i % 84 + i / 84) % 2 == 0 { 2.0 } else { 0.0 }).collect();
    let textured = with(&plain, on_plane(&mesh, 4.2, 84, 84, values));
    let (a, b) = (radiance(&plain, 0), radiance(&textured, 0));
    for pixel in 0..144 {
        let share = if (pixel % 12 + pixel / 12) % 2 == 0 { 50.0 / 49.0 } else { 48.0 / 49.0 };
        assert!((b[pixel] / a[pixel] - share).abs() < 1e-9, "{pixel}: {}", b[pixel] / a[pixel]);
    }
}

#[test]
fn only_light_that_is_there_is_modulated() {
    // A wall's shadow covers x from -1 to 0; the texture is 3 there and 0.5 elsewhere, seen by pixels of 2 m, half in shadow.
    let wall = quad([0.0, -4.0, 0.0], [0.0, 4.0, 0.0], [0.0, 4.0, 1.0], [0.0, -4.0, 1.0]);
    let mesh = joined(&[plane(4.0, 0.0), wall]);
    let plain = scene(mesh.clone(), nadir(1000.0, 8.0, 4), [1.0, 0.0, 1.0]);
    let values = (0..8).map(|i| if i == 3 { 3.0 } else { 0.5 }).collect();
    let textured = with(&plain, on_plane(&mesh, 4.0, 8, 1, values));
    let (a, b) = (radiance(&plain, 0), radiance(&textured, 0));
    for pixel in 0..16 {
        // Of the pixels from x = -2 to 0 only the half at x < -1 is lit, where the texture is 0.5, as everywhere that is lit.
        assert!((b[pixel] / a[pixel] - 0.5).abs() < 1e-12, "{pixel}: {} {}", b[pixel], a[pixel]);
    }
    assert!((a[5] / a[4] - 0.5).abs() < 1e-5);
}

#[test]
fn a_texture_of_layers_is_a_reflectance_at_each_wavelength() {
    // Left half 0.1 at 1 um and 0.3 at 2 um, right half 0.2 and 0.6; bands at 1, 1.25 and 2 um.
    let mesh = plane(4.0, 0.0);
    let mut scene = scene(mesh.clone(), nadir(1000.0, 8.0, 2), [0.0, 0.0, 1.0]).into_parts();
    scene.exposure.bands = [1.0, 1.25, 2.0].map(|centre_um| Band::new(centre_um, None)).to_vec();
    let texture = on_plane(&mesh, 4.0, 2, 1, vec![0.1, 0.3, 0.2, 0.6]);
    scene.surface.textures = vec![Texture { kind: TextureKind::Reflectance, wavelength_um: vec![1.0, 2.0], ..texture }];
    let scene = scene.check().unwrap();
    let white = 700.0 / 2.25 / std::f64::consts::PI;
    for (band, left) in [(0, 0.1), (1, 0.15), (2, 0.3)] {
        for (pixel, value) in radiance(&scene, band).iter().enumerate() {
            let expected = white * left * if pixel % 2 == 0 { 1.0 } else { 2.0 };
            assert!((value / expected - 1.0).abs() < 1e-12, "band {band} pixel {pixel}: {value} {expected}");
        }
    }
}

#[test]
fn a_texture_is_read_with_its_scene() {
    let folder = Scratch::new();
    folder.write("square.obj", SQUARE_OBJ);
    // Row 0 is the top of the image, v = 1: north, which is up in the image.
    folder.write("rows.csv", "3,1\n1,3\n");
    let text = |texture: &str| SQUARE.replace("[sun]", &format!("{texture}\n[sun]"));
    let plain = folder.look(&text("")).cube.band(0);
    let seen = folder.look(&text("texture = { raster = \"rows.csv\", quantity = \"factor\", placement = \"atlas\" }"));
    // Mean 2 becomes 1.
    for (value, share) in seen.cube.band(0).iter().zip([1.5, 0.5, 0.5, 1.5]) {
        assert!((value / plain[0] - share).abs() < 1e-9, "{:?} {plain:?}", seen.cube.band(0));
    }
    // The same on a plane, whose corner is in the north-west.
    let plane = "texture = { raster = \"rows.csv\", quantity = \"factor\", placement = \"plane\", mean = \"kept\", plane = \
                 { corner_m = [-4, 4, 0], along_line_m = [4, 0, 0], line_to_line_m = [0, -4, 0] } }";
    for (value, factor) in folder.look(&text(plane)).cube.band(0).iter().zip([3.0, 1.0, 1.0, 3.0]) {
        assert!((value / plain[0] - factor).abs() < 1e-9);
    }
    let refused = |texture: &str| {
        let path = folder.write("scene.toml", text(texture));
        mmxrt::formats::scene_toml::read(&path, &unwatched).unwrap_err().to_string()
    };
    folder.write("negative.csv", "3,1\n1,-3\n");
    folder.write("bright.csv", "30,1\n1,1\n");
    for (texture, message) in [
        ("texture = { raster = \"none.csv\", quantity = \"factor\", placement = \"atlas\" }", "none.csv"),
        (
            "texture = { raster = \"negative.csv\", quantity = \"factor\", placement = \"atlas\", mean = \"kept\" }",
            "texel (row 1, column 1) is -3",
        ),
        (
            "texture = { raster = \"bright.csv\", quantity = \"factor\", placement = \"atlas\", mean = \"kept\" }",
            "makes a reflectance of 3",
        ),
        ("texture = { raster = \"rows.csv\", quantity = \"factor\", placement = \"plane\" }", "plane"),
        ("texture = { raster = \"rows.csv\", quantity = \"factor\", placement = \"atlas\", unit = \"K\" }", "unit"),
    ] {
        let told = refused(texture);
        assert!(told.contains(message), "{told}");
    }
    folder.write("square.obj", "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nvt 0 0\nvt 2 0\nf 1/1 2/2 3/2 4/1\n");
    let atlas = "texture = { raster = \"rows.csv\", quantity = \"factor\", placement = \"atlas\" }";
    assert!(refused(atlas).contains("outside 0 to 1: 2"), "{}", refused(atlas));
    folder.write("square.obj", "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nf 1 2 3 4\n");
    assert!(refused(atlas).contains("have no texture coordinates"), "{}", refused(atlas));
}
