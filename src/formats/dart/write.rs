//! A simulation's folder: inputs, OBJ files, databases, what mmxrt keeps beside them, and how to run it.
//!
//! ```text
//! README.md   what this is, how to run it, what to check first
//! mmxrt.toml  what DART has no place for
//! input/      the eleven XML files, obj/, databases
//! flight.xml  the exposures of a scene that moves, as a sequence
//! mars/       the same surface lit by Mars, where it is
//! check/      a tetrahedron whose radiances the README gives
//! ```

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use glam::{DMat3, DVec3};

use crate::error::{Error, Result};
use crate::formats::folder::{FolderKind, Staged};
use crate::formats::obj;
use crate::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose};
use crate::progress::{Watch, tell};
use crate::scene::{Exposure, Material, Models, Photometry, SceneParts, Sky, Spectrometer, Sun, Surface, Thermal};
use crate::spectral::{Band, Spectrum};
use crate::units::AU_M;

use super::database;
use super::frame;
use super::from_scene::{ObjectMesh, Package, SimulationOptions, from_scene, places_text};
use super::inputs::{TargetVersion, inputs};
use super::sequencer;
use super::sidecar;
use super::simulation::{Object, Simulation};

/// A folder written here; DART's own output beside it keeps it from being replaced.
const SIMULATION: FolderKind = FolderKind {
    marks: &[sidecar::FILE, "input"],
    parts: &["README.md", sidecar::FILE, "input", "flight.xml", "mars", "check"],
    holds: None,
};

/// Writes a simulation's folder. It appears whole or not at all.
///
/// # Errors
/// [`Error::Invalid`] if the folder exists and is not to be, or cannot be, replaced; [`Error::Unsupported`] for what the version of
/// DART is not known to have, and for databases without the feature `sqlite`; [`Error::Io`]; [`Error::Interrupted`].
pub fn write(package: &Package, target: &Path, replace: bool, watch: Watch<'_>) -> Result<()> {
    let staged = Staged::folder_of(&SIMULATION, target, replace)?;
    fill(package, staged.path(), watch).map_err(|e| staged.named(e))?;
    staged.commit()
}

fn fill(package: &Package, folder: &Path, watch: Watch<'_>) -> Result<()> {
    tell(watch, "writing the simulation", 0, 1)?;
    write_inputs(&package.simulation, package, folder)?;
    let input = folder.join("input");
    for (surface, object) in files(package) {
        let path = input.join(&object.file);
        let writing = |e| Error::io(&path, "writing", e);
        make_folder(path.parent().unwrap_or(folder))?;
        let mut out = BufWriter::new(File::create(&path).map_err(writing)?);
        let group = |place: usize| surface.groups.get(place).map_or("", |group| group.name.as_str());
        obj::write_by(&mut out, &surface.mesh, "g", group, frame::obj_from_dart).map_err(writing)?;
        out.into_inner().map_err(|e| writing(e.into_error()))?;
        tell(watch, "writing the simulation", 0, 1)?;
    }
    for field in &package.simulation.fields {
        write_text(&input.join(&field.file), &places_text(&field.places))?;
    }
    for (name, tables) in &package.databases {
        database::create(&input.join(name), tables, false)?;
    }
    if let Some(mars) = &package.mars {
        let folder = folder.join("mars");
        write_inputs(mars, package, &folder)?;
        let texts = package.simulation.fields.iter().map(|field| field.file.as_str());
        let files = files(package).map(|(_, object)| object.file.as_str()).chain(texts);
        for name in files.chain(package.databases.iter().map(|(name, _)| name.as_str())) {
            share(&input.join(name), &folder.join("input").join(name))?;
        }
    }
    if let Some(sidecar) = &package.sidecar {
        write_text(&folder.join(sidecar::FILE), &sidecar.text())?;
        let target = TargetVersion::of(&package.simulation.version)?;
        let (check, expected) = tetrahedron(target)?;
        fill(&check, &folder.join("check"), watch)?;
        write_text(&folder.join("README.md"), &readme(package, target, &expected))?;
    }
    tell(watch, "writing the simulation", 1, 1)
}

/// The OBJ files: those of the objects, then those of the fields' models.
fn files(package: &Package) -> impl Iterator<Item = (&ObjectMesh, &Object)> {
    let simulation = &package.simulation;
    let models = simulation.fields.iter().flat_map(|field| &field.models);
    package.surfaces.iter().zip(&simulation.objects).chain(package.fields.iter().zip(models))
}

fn write_inputs(simulation: &Simulation, package: &Package, folder: &Path) -> Result<()> {
    let boxes_m: Vec<_> = files(package).map(|(surface, _)| surface.mesh.bounds_m().unwrap_or_default()).collect();
    let input = folder.join("input");
    make_folder(&input)?;
    for (name, root) in inputs(simulation, &boxes_m)? {
        write_text(&input.join(name), &root.write())?;
    }
    for sequence in &simulation.sequences {
        let root = sequencer::file(sequence, &simulation.version);
        write_text(&folder.join(format!("{}.xml", sequence.name)), &root.write())?;
    }
    Ok(())
}

fn make_folder(path: &Path) -> Result<()> {
    fs::create_dir_all(path).map_err(|e| Error::io(path, "making this folder", e))
}

fn write_text(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).map_err(|e| Error::io(path, "writing", e))
}

/// The same file under a second name; a copy where the disk has no such thing.
fn share(from: &Path, to: &Path) -> Result<()> {
    make_folder(to.parent().unwrap_or(to))?;
    fs::hard_link(from, to).or_else(|_| fs::copy(from, to).map(drop)).map_err(|e| Error::io(to, "writing", e))
}

/// Irradiance in the check, W m-2 um-1.
const CHECK_IRRADIANCE: f64 = 1000.0;

/// A face of the check: name, reflectance, cosine of incidence, whether it is seen from above.
struct Face {
    name: &'static str,
    reflectance: f64,
    cos_incidence: f64,
    is_seen: bool,
}

/// A tetrahedron with four different faces under a Sun in the East, 30 deg from the zenith: convex, so that each face has
/// sunlight alone, and what is wrong with an axis, an azimuth, an order of groups or a unit shows at once.
fn tetrahedron(target: TargetVersion) -> Result<(Package, [Face; 4])> {
    // East, north, up: base corners South, north-east and north-west of the middle, and the top.
    let (half, long) = (5.0, 5.0 * 3f64.sqrt());
    let corners = [[0.0, -10.0, 0.0], [long, half, 0.0], [-long, half, 0.0], [0.0, 0.0, half]].map(DVec3::from_array);
    let facets = [
        ("south-east", 0.4, [0, 1, 3]),
        ("north", 0.2, [1, 2, 3]),
        ("south-west", 0.3, [2, 0, 3]),
        ("base", 0.1, [0, 2, 1]),
    ];
    let mesh = Mesh {
        vertices_m: corners.to_vec(),
        facets: facets.map(|f| f.2).to_vec(),
        material: (0..4).map(MaterialId).collect(),
        face_of_facet: vec![],
        uv: vec![],
    };
    let material = |(i, (name, reflectance, _)): (usize, &(&str, f64, [u32; 3]))| Material {
        name: (*name).into(),
        reflectance: Spectrum::constant(*reflectance),
        emissivity: Spectrum::constant(1.0 - reflectance),
        photometry: Photometry::Lambert,
        bond_albedo: *reflectance,
        emissivity_bolometric: 0.95,
        thermal_inertia: 0.0,
        temperature_k: None,
        mixture: vec![(i, 1.0)],
    };
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let towards_sun = DVec3::new(sin, 0.0, cos);
    let faces = [0, 1, 2, 3].map(|f| {
        let normal = mesh.facet(f).normal();
        let (name, reflectance, _) = facets[f];
        Face { name, reflectance, cos_incidence: normal.dot(towards_sun).max(0.0), is_seen: normal.z > 0.0 }
    });
    let parts = SceneParts {
        surface: Surface {
            origin_m: DVec3::ZERO,
            materials: facets.iter().enumerate().map(material).collect(),
            textures: vec![],
            mesh,
        },
        sky: Sky {
            sun: Sun {
                direction: Direction::new(towards_sun)
                    .ok_or_else(|| Error::invalid(crate::error::Location::item("check"), "the Sun has no direction"))?,
                distance_m: AU_M,
                irradiance_1au: Spectrum::constant(CHECK_IRRADIANCE),
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
            instrument: "check".into(),
            camera: FrameCamera::centred(
                Pose {
                    rotation: DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z),
                    translation_m: DVec3::new(0.0, 0.0, 1000.0),
                },
                200,
                200,
                1.25e-4,
            ),
            bands: vec![Band::new(1.0, Some(0.02))],
            spectrometer: Spectrometer::default(),
        },
        models: Models { thermal: Thermal::Off, ..Models::default() },
    };
    let scene = parts.check()?;
    let options = SimulationOptions { target, cell_m: Some(0.125), ..SimulationOptions::default() };
    let (package, _) = from_scene(&scene, &options)?;
    Ok((Package { sidecar: None, ..package }, faces))
}

fn readme(package: &Package, target: TargetVersion, expected: &[Face; 4]) -> String {
    let version = target.version();
    let mut text = format!(
        "# A DART simulation written by mmxrt\n\n\
         For DART {} ({}). `input` holds the eleven input files, the surface (`obj`) and its optical database.\n\
         {}`mmxrt.toml` keeps what DART has no place for, so that `mmxrt convert` brings the scene back; DART does not read it.\n\n\
         ## Run it\n\n\
         1. Copy this folder to `user_data/simulations/NAME` of your DART. If DART says that it does not find a database, copy\n   \
         `input/*.db` to `user_data/database`.\n\
         2. A newer DART upgrades the inputs: `tools/<system>/dart-XMLUpgrader NAME`, or open the simulation in its window.\n\
         3. Run `NAME/check` first, and compare it with the table below. Then run `NAME`{}.\n\
         4. Radiances are in `output/BAND<n>/Radiance`, W m-2 sr-1 um-1; band n is band n + 1 of the scene.\n\n",
        version.version,
        version.build,
        if package.mars.is_some() {
            "`mars` is the same surface lit by Mars alone, in the Sun's place: its radiances are to be added.\n"
        } else {
            ""
        },
        if package.mars.is_some() { " and `NAME/mars`" } else { "" },
    );
    for sequence in &package.simulation.sequences {
        let count = super::rows(sequence).map_or(0, |rows| rows.len());
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "`{}.xml` is a sequence of {count} simulations, one for each exposure of the scene, with its Sun and camera: run it by DART's\n\
             sequencer; simulation i is then in `sequence/{}_i`. Which of its modules run is said in `DartSequencerPreferences`.\n",
            sequence.name, sequence.name
        );
    }
    text.push_str(
        "## What to check first\n\n\
         `check` is a tetrahedron with four different faces, the Sun in the East at a zenith angle of 30 deg, 1000 W m-2 um-1 normal\n\
         to the beam. In the nadir image rows go South and columns go East. It is convex: each face has sunlight and nothing else.\n\n\
         | face | reflectance | cos i | BRF at nadir | radiance, W m-2 sr-1 um-1 |\n|---|---|---|---|---|\n",
    );
    let cos_zenith = 30f64.to_radians().cos();
    for face in expected {
        let (brf, radiance) = match face.is_seen {
            true => (
                format!("{:.6}", face.reflectance * face.cos_incidence / cos_zenith),
                format!("{:.4}", face.reflectance / PI * CHECK_IRRADIANCE * face.cos_incidence),
            ),
            false => ("not seen".into(), "not seen".into()),
        };
        // Writing to a string does not fail.
        let _ =
            writeln!(text, "| {} | {} | {:.6} | {brf} | {radiance} |", face.name, face.reflectance, face.cos_incidence);
    }
    text.push_str(
        "| ground | 0 | 0.866025 | 0 | 0 |\n\n\
         If radiances are all 1.1547 times too large, your DART takes the irradiance for that on a horizontal surface\n\
         (`CommonParameters@irraDef`). If faces have each other's values, groups are numbered in another order; if the bright face\n\
         is not in the South-East, axes or azimuths differ. Tell us, with your version of DART.\n\n\
         ## What differs from mmxrt\n\n\
         - DART follows light from facet to facet; mmxrt takes what comes from the Sun and Mars alone.\n\
         - A band is a rectangle of `deltaLambda`, over which DART weights with the irradiance.\n\
         - Temperatures are spread between two ends by sunlight.\n\
         - The sign of `cameraRotation` / `orientationAngle` and the meaning of `irraDef` are inferred, not documented.\n",
    );
    text
}
