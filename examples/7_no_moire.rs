//! Texels finer than pixels: point samples beside exact areas, as a picture.
//! `cargo run --profile quick --example 7_no_moire [PICTURE.png]`.
//!
//! A checkerboard of 1 m runs to the horizon. A point sample takes whatever texel its ray meets, so that far away, where
//! many texels share a pixel, patterns appear that are not there; more samples push them away and add noise. The integral over the
//! area of each texel in each pixel has neither.

#![allow(clippy::print_stdout)]

use glam::{DMat3, DVec3};
use mmxrt::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose, Texels};
use mmxrt::progress::unwatched;
use mmxrt::scene::{
    Exposure, Material, Models, Photometry, Scene, SceneParts, Sky, Spectrometer, Sun, Surface, Texture, TextureKind,
    Thermal,
};
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::units::AU_M;
use mmxrt::{Error, Result, study};

/// Half width of the ground, m; and as many texels on either side.
const HALF: usize = 150;
/// Pixels of an image.
const SAMPLES: u32 = 192;
const LINES: u32 = 128;

fn main() -> Result<()> {
    // 5 m above the ground, looking north and a little down; the horizon is near the top.
    let (sin, cos) = 0.22_f64.sin_cos();
    let rotation = DMat3::from_cols(DVec3::X, DVec3::new(0.0, -sin, -cos), DVec3::new(0.0, cos, -sin));
    let eye_m = DVec3::new(0.3, -140.0, 5.0);
    let camera = FrameCamera::centred(Pose { rotation, translation_m: eye_m }, SAMPLES, LINES, 0.6 / f64::from(LINES));
    let exact = study::simulate(&scene(camera.clone())?, &unwatched)?.1.cube.band(0);
    let white = exact.iter().copied().fold(0.0, f64::max);
    let exact: Vec<f64> = exact.iter().map(|l| l / white).collect();

    // Where a ray meets the ground, white or black; nothing beside it.
    let texel = |x: f64, y: f64| {
        let ray = camera.ray(x, y);
        let [column, row] = [0, 1].map(|k| (eye_m[k] - ray[k] * eye_m.z / ray.z + HALF as f64).floor());
        let is_inside = ray.z < 0.0 && [column, row].iter().all(|c| (0.0..2.0 * HALF as f64).contains(c));
        if is_inside && (column + row) % 2.0 == 0.0 { 1.0 } else { 0.0 }
    };
    let sampled = |side: u32| -> Vec<f64> {
        let step = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
        let pixel = |p: u32| {
            let at = |k: u32| texel(f64::from(p % SAMPLES) + step(k % side), f64::from(p / SAMPLES) + step(k / side));
            (0..side * side).map(at).sum::<f64>() / f64::from(side * side)
        };
        (0..SAMPLES * LINES).map(pixel).collect()
    };
    let mut panels = Vec::new();
    for side in [1, 2, 4] {
        let image = sampled(side);
        let squares: f64 = image.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum();
        println!("{:2} samples a pixel: {:.4} rms of white", side * side, (squares / exact.len() as f64).sqrt());
        panels.push(image);
    }
    // What many samples agree on.
    let many = sampled(64);
    let squares: f64 = many.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum();
    println!("4096 samples a pixel: {:.4} rms of white", (squares / exact.len() as f64).sqrt());
    panels.push(exact);
    if let Some(path) = std::env::args().nth(1) {
        picture(&path, &panels)?;
        println!("{path}: 1, 4 and 16 samples a pixel, and exact areas");
    }
    Ok(())
}

/// Ground with a checkerboard of factors 1 and 0, under a Sun at the zenith.
fn scene(camera: FrameCamera) -> Result<Scene> {
    let half = HALF as f64;
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    let facets = vec![[0, 1, 2], [0, 2, 3]];
    // Texels count from the south-west here: any corner will do, as long as columns and rows follow the coordinates.
    let texel = |v: u32| corners[v as usize].map(|c| c + half);
    let texture = Texture {
        material: MaterialId(0),
        kind: TextureKind::Factor,
        corners: facets.iter().map(|f: &[u32; 3]| f.map(texel)).collect(),
        rows: 2 * HALF,
        columns: 2 * HALF,
        wavelength_um: vec![],
        values: (0..4 * HALF * HALF)
            .map(|i| if (i % (2 * HALF) + i / (2 * HALF)).is_multiple_of(2) { 1.0 } else { 0.0 })
            .collect(),
        texels: Texels::Nearest,
        lon_lat: None,
    };
    let grey = Material {
        name: "ground".into(),
        reflectance: Spectrum::constant(0.07),
        photometry: Photometry::Lambert,
        emissivity: Spectrum::constant(0.93),
        bond_albedo: 0.07,
        emissivity_bolometric: 0.95,
        thermal_inertia: 0.0,
        temperature_k: None,
        mixture: vec![(0, 1.0)],
    };
    SceneParts {
        surface: Surface {
            origin_m: DVec3::new(0.0, 0.0, 11_000.0),
            mesh: Mesh {
                vertices_m: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
                facets,
                material: vec![MaterialId(0); 2],
                face_of_facet: vec![],
                uv: vec![],
            },
            materials: vec![grey],
            textures: vec![texture],
        },
        sky: Sky {
            sun: Sun {
                direction: Direction::new(DVec3::Z).expect("has a length"),
                distance_m: AU_M,
                irradiance_1au: Spectrum::constant(700.0),
                total_irradiance_1au_w_m2: 1361.0,
                limb_darkening: 0.0,
            },
            mars: None,
            bodies: vec![],
            beams: vec![],
            rotation: None,
            past: None,
        },
        exposure: Exposure {
            instrument: "walker".into(),
            camera,
            bands: vec![Band::new(1.0, None)],
            spectrometer: Spectrometer::default(),
        },
        models: Models { thermal: Thermal::Off, ..Models::default() },
    }
    .check()
}

/// Two by two panels.
#[expect(clippy::cast_possible_truncation, reason = "255 shares of grey, rounded")]
fn picture(path: &str, panels: &[Vec<f64>]) -> Result<()> {
    let (width, height) = (SAMPLES as usize, LINES as usize);
    let grey = |x: usize, y: usize| {
        let panel = &panels[2 * (y / height) + x / width];
        (255.0 * panel[y % height * width + x % width]).round() as u8
    };
    let pixels: Vec<u8> = (0..4 * width * height).map(|i| grey(i % (2 * width), i / (2 * width))).collect();
    let file = std::fs::File::create(path).map_err(|e| Error::io(path, "writing", e))?;
    let mut encoder = png::Encoder::new(file, 2 * SAMPLES, 2 * LINES);
    encoder.set_color(png::ColorType::Grayscale);
    let write = |e: png::EncodingError| Error::io(path, "writing", e.into());
    encoder.write_header().map_err(write)?.write_image_data(&pixels).map_err(write)
}
