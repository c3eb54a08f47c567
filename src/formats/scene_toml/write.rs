//! Writing a scene: the scene file, its mesh as OBJ and MTL, and a CSV table for each spectrum, all beside one another.
//!
//! Read again, it is the same scene, bit for bit but for a scaled solar spectrum and positions that no sum with the origin gives,
//! which are so to rounding. What is a default elsewhere is stated.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::formats::folder::Staged;
use crate::formats::mtl::{self, ObjMaterial};
use crate::formats::{obj, photometry_csv};
use crate::physics::reflectance::kirchhoff_emissivity;
use crate::report::{Fate, Report};
use crate::scene::{MarsModel, Material, Scene, Thermal};
use crate::spectral::{Extend, Spectrum, solar_e490};
use crate::units::AU_M;

use super::irradiances;
use super::materials::linear_from_hex;
use super::view::pitch_of_ifov;

/// A larger pixel is written by its line's field of view, mrad.
const WIDEST_PIXEL_MRAD: f64 = 1000.0;
/// Spectra are the same if no value differs by more.
const SAME: f64 = 1e-12;

/// Writes a scene to `path`, which ends in `.toml`, and what it refers to beside it, in files whose names begin with its own.
///
/// Gives the files, not yet under their final names, in the order to [commit](Staged::commit) them, and what is not said in
/// them as the scene has it.
///
/// # Errors
/// [`Error::Invalid`] if one of the files exists and `replace` is false; [`Error::Io`].
pub fn write(scene: &Scene, path: &Path, replace: bool) -> Result<(Vec<Staged>, Report)> {
    // Claimed first, so that what cannot be written is told before the work, and given up last: the folders made for it go with it.
    let main = Staged::file(path, replace)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut writer = Writer {
        scene,
        folder,
        stem,
        replace,
        names: names(scene),
        taken: BTreeSet::new(),
        files: Vec::new(),
        report: Report::default(),
    };
    let text = writer.scene()?;
    put(&main, |out| out.write_all(text.as_bytes()))?;
    // Committed last, because it refers to the others.
    writer.files.push(main);
    Ok((writer.files, writer.report))
}

/// Names of materials that OBJ, MTL and this format can all carry, and that are all different.
fn names(scene: &Scene) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let plain = |name: &str| {
        let name = mtl::plain_name(name);
        match name.strip_prefix('#') {
            _ if name.is_empty() => "_".into(),
            // Here, only a colour begins so.
            Some(rest) if linear_from_hex(&name).is_none() => format!("_{rest}"),
            _ => name,
        }
    };
    let unique = |mut name: String| {
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        name
    };
    scene.materials.iter().map(|material| plain(&material.name)).map(unique).collect()
}

struct Writer<'a> {
    scene: &'a Scene,
    folder: PathBuf,
    /// What all names of files begin with.
    stem: String,
    replace: bool,
    /// Of the materials, as they are written.
    names: Vec<String>,
    /// Names of files, in small letters: some disks do not tell the cases apart.
    taken: BTreeSet<String>,
    files: Vec<Staged>,
    report: Report,
}

fn put(staged: &Staged, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    let io = |e| staged.named(Error::io(staged.path(), "writing", e));
    let mut out = BufWriter::with_capacity(1 << 20, File::create(staged.path()).map_err(io)?);
    write(&mut out).and_then(|()| out.flush()).map_err(io)
}

/// A TOML string, or key: of its four kinds of strings the one that a key may be whatever stands in it.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04X}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

fn list(v: DVec3) -> String {
    format!("{:?}", v.to_array())
}

/// The body-fixed position whose difference to the origin is `local_m` to the last bit, if there is one.
fn absolute(local_m: DVec3, origin_m: DVec3) -> String {
    let component = |i: usize| exact(local_m[i] + origin_m[i], |sum| sum - origin_m[i], local_m[i]);
    list(DVec3::from_array([0, 1, 2].map(component)))
}

/// The number at or beside `near` that reading makes `wanted` of, to the last bit; `near` if there is none.
fn exact(near: f64, read: impl Fn(f64) -> f64, wanted: f64) -> f64 {
    let (mut below, mut above) = (near, near);
    for _ in 0..8 {
        if let Some(exact) = [below, above].into_iter().find(|x| read(*x) == wanted) {
            return exact;
        }
        (below, above) = (below.next_down(), above.next_up());
    }
    near
}

/// Whether a spectrum is the same at all wavelengths, so that a number says it.
fn constant(spectrum: &Spectrum) -> Option<f64> {
    match (spectrum.extend(), spectrum.value()) {
        (Extend::Hold, &[value]) => Some(value),
        _ => None,
    }
}

impl Writer<'_> {
    fn note(&mut self, fate: Fate, item: impl Into<String>, message: impl Into<String>) {
        self.report.note(fate, Location::item(item), message);
    }

    /// Writes a file beside the scene file; gives its name.
    fn file(
        &mut self,
        name: &str,
        extension: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<String> {
        let plain = |c: char| if c.is_alphanumeric() || ".-".contains(c) { c } else { '_' };
        let mut name: String = name.chars().map(plain).collect();
        while !self.taken.insert(format!("{name}.{extension}").to_lowercase()) {
            name.push('_');
        }
        let name = format!("{}{name}.{extension}", self.stem);
        let staged = Staged::file(&self.folder.join(&name), self.replace)?;
        put(&staged, write)?;
        self.files.push(staged);
        Ok(name)
    }

    /// A spectrum as a value: a number, or the quoted name of a table.
    fn values(&mut self, name: &str, column: &str, spectrum: &Spectrum) -> Result<String> {
        if let Some(value) = constant(spectrum) {
            return Ok(format!("{value:?}"));
        }
        let file = self.file(name, "csv", |out| photometry_csv::write(out, &[(column, spectrum)]))?;
        Ok(quoted(&file))
    }

    fn scene(&mut self) -> Result<String> {
        let scene = self.scene;
        let mut text = String::new();
        // Writing to a string does not fail.
        let _ = writeln!(text, "mmxrt_scene = 1\norigin_m = {}\n", list(scene.origin_m));
        let obj = self.mesh()?;
        let _ = writeln!(text, "[[mesh]]\nobj = {}", quoted(&obj));
        for (i, material) in scene.materials.iter().enumerate() {
            text += &self.material(i, material)?;
        }
        text += &self.sun()?;
        text += &self.mars()?;
        let model = match scene.thermal {
            Thermal::Equilibrium => "equilibrium",
            Thermal::Thesis => "thesis",
            Thermal::Off => "off",
        };
        let _ = writeln!(text, "\n[thermal]\nmodel = \"{model}\"");
        let pose = &scene.sensor.camera.world_from_sensor;
        let _ = writeln!(text, "\n[observer]\nposition_m = {}", absolute(pose.translation_m, scene.origin_m));
        let axes = [("h", pose.rotation.x_axis), ("v", pose.rotation.y_axis), ("u", pose.rotation.z_axis)];
        for (name, axis) in axes {
            let _ = writeln!(text, "{name} = {}", list(axis));
        }
        text += &self.sensor();
        Ok(text)
    }

    /// The mesh and the names of its materials; gives the name of the OBJ.
    fn mesh(&mut self) -> Result<String> {
        let mesh = &self.scene.mesh;
        let lost = obj::faces_lost(mesh);
        if lost > 0 {
            let message = format!("{lost} faces of more than three corners become triangles");
            self.note(Fate::Dropped, "mesh", message);
        }
        for (material, name) in self.scene.materials.iter().zip(self.names.clone()) {
            if material.name != name {
                let message = format!("is called {name:?}: such names must be different, and can have no other signs");
                self.note(Fate::Approximated, format!("materials.{:?}", material.name), message);
            }
        }
        let entry = |name: &String| ObjMaterial { name: name.clone(), kd: None };
        let materials: Vec<ObjMaterial> = self.names.iter().map(entry).collect();
        let mtl = self.file("", "mtl", |out| mtl::write(out, &materials))?;
        self.file("", "obj", |out| obj::write(out, mesh, &materials, Some(&mtl)))
    }

    fn material(&mut self, i: usize, material: &Material) -> Result<String> {
        let name = self.names[i].clone();
        let item = format!("materials.{:?}", material.name);
        let file = |what: &str| format!(".{name}.{what}");
        let mut text = format!("\n[materials.{}]\n", quoted(&name));
        let mut tables: Vec<&Spectrum> = Vec::new();
        match self.shares(i, material) {
            Some(shares) => _ = writeln!(text, "mixture = {{ {shares} }}"),
            None => {
                let values = self.values(&file("reflectance"), "reflectance", &material.reflectance)?;
                _ = writeln!(text, "reflectance = {values}");
                tables.extend(Some(&material.reflectance).filter(|s| constant(s).is_none()));
            }
        }
        if material.emissivity != material.reflectance.map(kirchhoff_emissivity) {
            let values = self.values(&file("emissivity"), "emissivity", &material.emissivity)?;
            let _ = writeln!(text, "emissivity = {values}");
            tables.extend(Some(&material.emissivity).filter(|s| constant(s).is_none()));
        }
        if let Some(key) = material.photometry.key() {
            let columns = self.columns(&item, material);
            let named: Vec<(&str, &Spectrum)> = columns.iter().map(|(name, column)| (*name, column)).collect();
            let table = self.file(&file(key), "csv", |out| photometry_csv::write(out, &named))?;
            let _ = writeln!(text, "{key} = {}", quoted(&table));
            tables.extend(material.photometry.parameters().iter().map(|(_, column)| *column));
        }
        if tables.iter().any(|s| s.extend() == Extend::Hold) {
            text.push_str("extend = \"hold\"\n");
            if tables.iter().any(|s| s.extend() == Extend::Error) {
                let message = "all its tables are held beyond their ends, where some were unknown";
                self.note(Fate::Approximated, item, message);
            }
        }
        let (bond, bolometric) = (material.bond_albedo, material.emissivity_bolometric);
        let _ = writeln!(text, "bond_albedo = {bond:?}\nemissivity_bolometric = {bolometric:?}");
        Ok(text)
    }

    /// The shares of a mixture; `None` for an entry with a reflectance of its own.
    fn shares(&mut self, i: usize, material: &Material) -> Option<String> {
        if material.mixture == [(i, 1.0)] {
            return None;
        }
        let of = |&(part, share): &(usize, f64)| Some((share, &self.scene.materials.get(part)?.reflectance));
        let parts: Option<Vec<_>> = material.mixture.iter().map(of).collect();
        let mixed = parts.and_then(|parts| Spectrum::mixture(&parts)).filter(|mixed| {
            mixed.wavelength_um() == material.reflectance.wavelength_um()
                && mixed.value().iter().zip(material.reflectance.value()).all(|(a, b)| (a - b).abs() <= SAME)
        });
        if mixed.is_none() || material.photometry.key().is_some() {
            let message = "its shares of other entries, whose reflectances do not add up to its own";
            self.note(Fate::Dropped, format!("materials.{:?}.mixture", material.name), message);
            return None;
        }
        let share = |(part, share): &(usize, f64)| format!("{} = {share:?}", quoted(&self.names[*part]));
        Some(material.mixture.iter().map(share).collect::<Vec<_>>().join(", "))
    }

    /// The parameters of a photometry on wavelengths that all of them have.
    fn columns(&mut self, item: &str, material: &Material) -> Vec<(&'static str, Spectrum)> {
        let columns = material.photometry.parameters();
        let first = columns.first().map(|(_, column)| column.wavelength_um());
        if columns.iter().all(|(_, column)| Some(column.wavelength_um()) == first) {
            return columns.into_iter().map(|(name, column)| (name, column.clone())).collect();
        }
        let message = "its parameters are written at the wavelengths of all of them, where all are known";
        self.note(Fate::Approximated, item, message);
        // Nothing of the others, but their wavelengths.
        let on_all = |i: usize| {
            let parts: Vec<_> =
                columns.iter().enumerate().map(|(j, (_, c))| (f64::from(u8::from(i == j)), *c)).collect();
            Spectrum::mixture(&parts)
        };
        (0..columns.len()).filter_map(|i| Some((columns[i].0, on_all(i)?))).collect()
    }

    fn sun(&mut self) -> Result<String> {
        let sun = &self.scene.sun;
        let au = exact(sun.distance_m / AU_M, |au| au * AU_M, sun.distance_m);
        let direction = list(sun.direction.vec());
        let mut text = format!("\n[sun]\ndirection = {direction}\ndistance_au = {au:?}\n");
        let e490 = solar_e490();
        if sun.irradiance_1au == *e490 {
            text.push_str("spectrum = \"e490\"\n");
            self.total_irradiance(None);
            return Ok(text);
        }
        // Beyond a table's ends E490 is added to the total, and a total that is given scales the table: s (table / s + E490 beyond)
        // is the total, and with s known both are as they were.
        let table = self.known(&sun.irradiance_1au, "sun.spectrum");
        let total = sun.total_irradiance_1au_w_m2;
        let (within, beyond) = irradiances(&table);
        let scale = (total - within) / beyond;
        let is_scaled = (scale - 1.0).abs() > SAME && scale > 0.0 && scale.is_finite();
        let written = if is_scaled { table.map(|v| v / scale) } else { table };
        let name = self.file(".sun", "csv", |out| photometry_csv::write(out, &[("irradiance_w_m2_um", &written)]))?;
        let _ = writeln!(text, "spectrum = {}", quoted(&name));
        if is_scaled {
            let _ = writeln!(text, "total_irradiance_w_m2 = {total:?}");
        } else {
            self.total_irradiance(Some(within + beyond));
        }
        Ok(text)
    }

    /// Notes a total that is not that of the spectrum as it is written.
    fn total_irradiance(&mut self, written: Option<f64>) {
        let written = written.unwrap_or_else(|| irradiances(solar_e490()).0);
        let total = self.scene.sun.total_irradiance_1au_w_m2;
        if (written / total - 1.0).abs() > SAME {
            let message = format!("{written} W m-2, the integral of the spectrum, instead of {total}");
            self.note(Fate::Approximated, "sun.total_irradiance_w_m2", message);
        }
    }

    /// A spectrum as a table that is unknown beyond its ends: one that was held gets the ends that the bands look at.
    fn known(&mut self, spectrum: &Spectrum, item: &str) -> Spectrum {
        if spectrum.extend() == Extend::Error {
            return spectrum.clone();
        }
        self.note(Fate::Approximated, item, "is known where the bands look, instead of everywhere");
        let supports = self.scene.sensor.bands.iter().map(|band| band.support_um());
        let ends = supports.fold((f64::INFINITY, 0.0_f64), |(a, b), (low, high)| (a.min(low), b.max(high)));
        let mut um = spectrum.wavelength_um().to_vec();
        um.extend([ends.0, ends.1]);
        um.sort_by(f64::total_cmp);
        um.dedup();
        let value = um.iter().filter_map(|&um| spectrum.at(um)).collect();
        Spectrum::new(um, value, Extend::Error).unwrap_or_else(|| spectrum.clone())
    }

    fn mars(&mut self) -> Result<String> {
        let Some(mars) = &self.scene.mars else { return Ok(String::new()) };
        let albedo = match constant(&mars.reflectance) {
            Some(value) => format!("{value:?}"),
            None => {
                let table = self.known(&mars.reflectance, "mars.albedo");
                self.values(".mars", "albedo", &table)?
            }
        };
        let model = match mars.model {
            MarsModel::NearField => "near_field",
            MarsModel::Thesis => "thesis",
        };
        Ok(format!(
            "\n[mars]\nposition_m = {}\nradius_m = {:?}\nalbedo = {albedo}\nbond_albedo = {:?}\nthermal_exitance_w_m2 = {:?}\nmodel = \"{model}\"\n",
            absolute(mars.centre_m, self.scene.origin_m),
            mars.radius_m,
            mars.bond_albedo,
            mars.thermal_exitance_w_m2,
        ))
    }

    fn sensor(&self) -> String {
        let sensor = &self.scene.sensor;
        let camera = &sensor.camera;
        let mut text = format!("\n[sensor]\nname = {}\n", quoted(&sensor.name));
        let _ = writeln!(text, "samples = {}\nlines = {}", camera.samples, camera.lines);
        let ifov_mrad = 1e3 * camera.ifov_rad()[0];
        let _ = if !camera.is_centred() {
            let focal_px = camera.pitch.map(|pitch| exact(1.0 / pitch, |focal_px| 1.0 / focal_px, pitch));
            writeln!(text, "focal_px = {focal_px:?}\nboresight_px = {:?}", camera.boresight_px)
        } else if ifov_mrad <= WIDEST_PIXEL_MRAD {
            let ifov_mrad = exact(ifov_mrad, pitch_of_ifov, camera.pitch[0]);
            writeln!(text, "ifov_mrad = {ifov_mrad:?}")
        } else {
            let half = 0.5 * camera.pitch[0] * f64::from(camera.samples);
            writeln!(text, "fov_deg = {:?}", (2.0 * half.atan()).to_degrees())
        };
        let centres: Vec<f64> = sensor.bands.iter().map(|band| band.centre_um).collect();
        let _ = writeln!(text, "\n[sensor.bands]\ncentres_um = {centres:?}");
        let widths: Vec<f64> = sensor.bands.iter().map(|band| band.fwhm_um.unwrap_or(0.0)).collect();
        let _ = match widths[..] {
            _ if widths.iter().all(|w| *w == 0.0) => Ok(()),
            [first, ..] if widths.iter().all(|w| *w == first) => writeln!(text, "fwhm_um = {first:?}"),
            _ => writeln!(text, "fwhm_um = {widths:?}"),
        };
        text
    }
}
