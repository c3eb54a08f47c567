//! A scene for Mitsuba, and what Mitsuba made of it.

use std::path::PathBuf;

use serde_json::json;

use super::ChartFolder;
use crate::error::{Error, Location, Result};
use crate::formats::{npz, ply};
use crate::geometry::{FrameCamera, MaterialId};
use crate::scene::Scene;
use crate::study::chart::Outside;

/// The script that renders what is exported.
const SCRIPT: &str = include_str!("../../../adapters/mitsuba/render.py");
/// Samples a pixel.
const RAYS: [u32; 6] = [1, 4, 16, 64, 256, 1024];

/// The part of a folder that Mitsuba reads and writes.
const FOLDER: &str = "mitsuba";

impl ChartFolder {
    /// Writes what [`lambert_sunlight`](crate::study::chart::lambert_sunlight) is, and the script, into the part `mitsuba`, where they stay.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a camera that Mitsuba has not; [`Error::Io`].
    pub fn export_mitsuba(&self, known: &Scene) -> Result<PathBuf> {
        let camera = &known.exposure.camera;
        if !camera.is_centred() {
            let feature = "Mitsuba with pixels that are not square, a boresight beside the image's middle, or a lens that distorts".into();
            return Err(Error::Unsupported { at: Location::item("sensor"), feature });
        }
        let folder = self.path().join(FOLDER);
        std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, "making this folder", e))?;
        let um = known.exposure.bands[0].centre_um;
        let mut materials = Vec::new();
        for (i, material) in known.body.materials.iter().enumerate() {
            let id = MaterialId(u16::try_from(i).unwrap_or(u16::MAX));
            if !known.body.mesh.material.contains(&id) {
                continue;
            }
            let name = format!("material{i}.ply");
            self.put(&folder.join(&name), |out| ply::write(out, &known.body.mesh, id))?;
            materials.push(json!({ "name": material.name, "ply": name, "reflectance": material.reflectance.at(um) }));
        }
        let scene = json!({
            "band_um": um,
            "rays": RAYS,
            "towards_sun": known.sky.sun.direction.vec().to_array(),
            "irradiance": known.sky.sun.irradiance_w_m2_um(um),
            "camera": camera_json(camera, known),
            "materials": materials,
        });
        self.put(&folder.join("scene.json"), |out| write_text(out, &format!("{scene:#}\n")))?;
        self.put(&folder.join("render.py"), |out| write_text(out, SCRIPT))?;
        Ok(folder)
    }

    /// The images that the script has made.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] if they are not of this scene.
    pub fn read_mitsuba(&self, known: &Scene) -> Result<Vec<Outside>> {
        let path = self.path().join(FOLDER).join("images.npz");
        let pixels = known.exposure.camera.samples as usize * known.exposure.camera.lines as usize;
        let arrays = npz::read_f64s(&path, &["rays", "cpu_s", "images"])?;
        let [Some((_, rays)), Some((_, cpu_s)), Some((_, images))] = &arrays[..] else {
            return Err(Error::invalid(Location::file(&path), "lacks `rays`, `cpu_s` or `images`"));
        };
        if cpu_s.len() != rays.len() || images.len() != rays.len() * pixels {
            return Err(Error::invalid(Location::file(&path), "does not hold the images that were asked for"));
        }
        let outside = |((rays, cpu_s), image): ((&f64, &f64), &[f64])| Outside {
            name: format!("Mitsuba {rays} {}", if *rays == 1.0 { "ray" } else { "rays" }),
            account: format!(
                "Mitsuba 3 in single precision, {rays} stratified samples a pixel; loading the scene is not counted."
            ),
            cpu_s: *cpu_s,
            image: image.to_vec(),
        };
        Ok(rays.iter().zip(cpu_s).zip(images.chunks(pixels)).map(outside).collect())
    }
}

fn camera_json(camera: &FrameCamera, known: &Scene) -> serde_json::Value {
    let axes = camera.world_from_sensor.rotation;
    let (low_m, high_m) = known.body.bounds_m().unwrap_or_default();
    let (middle_m, radius_m) = (0.5 * (low_m + high_m), 0.5 * low_m.distance(high_m));
    let range_m = camera.centre_m().distance(middle_m);
    json!({
        "position_m": camera.centre_m().to_array(),
        "h": axes.x_axis.to_array(),
        "v": axes.y_axis.to_array(),
        "u": axes.z_axis.to_array(),
        "samples": camera.samples,
        "lines": camera.lines,
        "pitch": camera.pitch[0],
        "near_m": (range_m - radius_m).max(1e-3 * range_m) * 0.99,
        "far_m": (range_m + radius_m) * 1.01,
    })
}

fn write_text(out: &mut impl std::io::Write, text: &str) -> std::io::Result<()> {
    out.write_all(text.as_bytes())
}
