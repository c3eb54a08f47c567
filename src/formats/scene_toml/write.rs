//! Writing a scene: the scene file, its mesh as OBJ and MTL, and a CSV table for each spectrum, all in one folder.
//!
//! Read again, it is the same scene, bit for bit except for a scaled solar spectrum and positions that no sum with the origin gives,
//! which are the same to rounding. What the scene's source did not state is not written, so that it still follows from what it did state; what a
//! scene file must have is written all the same, below a comment.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::error::{Location, Result};
use crate::formats::file_name::shortened;
use crate::formats::folder::Staged;
use crate::formats::located::LONGEST_NAME;
use crate::formats::mtl::{self, ObjMaterial};
use crate::formats::number::exact;
use crate::formats::{directions, obj, photometry_csv, reflectance_csv, response_csv};
use crate::geometry::{BrownConrady, FrameCamera, Lens};
use crate::physics::srgb::linear_from_hex;
use crate::report::{Fate, Report};
use crate::scene::{
    Globe, MARS_ALBEDO, MARS_DAY_NIGHT_K, MarsModel, Material, Model, Photometry, Rotation, Scene, SunModel, Thermal,
};
use crate::spectral::{Band, Extend, Response, Spectrum, SunTotal, solar_e490, solar_mean};
use crate::units::{AU_M, MARS_RADIUS_M};

use super::super::located::member;
use super::materials::{EMISSIVITY_BOLOMETRIC, mean, mixed_emissivity};
use super::shapes;
use super::view::{SENSOR_NAME, pitch_of_ifov};
use super::{MARS_BOND_ALBEDO, MARS_THERMAL_EXITANCE_W_M2};

/// A larger pixel is written by its line's field of view, mrad.
const WIDEST_PIXEL_MRAD: f64 = 1000.0;
/// Spectra are the same if no value differs by more.
const SAME: f64 = 1e-12;

/// How a scene is written.
#[derive(Debug, Clone, Default)]
pub struct WriteOptions {
    /// What is there may be replaced.
    pub replace: bool,
    /// What the scene's source did not say.
    pub unsaid: Unsaid,
    /// What the axes of the scene that is given are.
    pub axes: Axes,
    /// Further cameras that look at the scene: each has a scene file of its own, which names the same files besides.
    pub cameras: Vec<FrameCamera>,
}

/// The scene file of a further camera: of the second one if `number` is 2.
pub fn path_of_camera(path: &Path, number: usize) -> PathBuf {
    path.with_extension(format!("camera_{number}.toml"))
}

/// What of a scene its source did not say.
#[derive(Debug, Clone, Default)]
pub enum Unsaid {
    /// Everything is stated.
    #[default]
    Nothing,
    /// These items, as [`SceneFile::defaults`](super::SceneFile) names them.
    Items(BTreeSet<String>),
    /// Everything that equals its default. The file's required tables, and the values taken for them, are stated in comments.
    Defaults(BTreeMap<String, String>),
}

/// The axes that a scene is given in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Axes {
    /// Those of the body.
    #[default]
    Body,
    /// Those of the site at its origin: x east, y north, z along the outward radius. The file says so.
    Site,
}

/// Writes a scene to `path`, which ends in `.toml`, and what it refers to beside it, in files whose names begin with its own. Everything is
/// stated.
///
/// Returns the files, which are to be [committed](Staged::commit), and a report of where they differ from the scene.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if one of the files exists and `replace` is false; [`Error::Io`](crate::Error::Io).
pub fn write(scene: &Scene, path: &Path, replace: bool) -> Result<(Staged, Report)> {
    write_with(scene, path, &WriteOptions { replace, ..WriteOptions::default() })
}

/// As [`write()`], without what was not stated.
///
/// # Errors
/// As [`write()`].
pub fn write_with(scene: &Scene, path: &Path, options: &WriteOptions) -> Result<(Staged, Report)> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut writer = Writer {
        scene,
        folder,
        stem,
        options,
        names: names(scene),
        taken: BTreeSet::new(),
        tables: Vec::new(),
        files: Staged::file(path, options.replace)?,
        report: Report::default(),
    };
    let shared = writer.scene()?;
    let bands = writer.bands()?;
    let text = writer.view(&scene.exposure.camera)?;
    writer.files.put(writer.files.path(), |out| write!(out, "{shared}{text}{bands}"))?;
    for (i, camera) in options.cameras.iter().enumerate() {
        let text = writer.view(camera)?;
        let path = writer.files.beside(&path_of_camera(path, i + 2))?;
        writer.files.put(&path, |out| write!(out, "{shared}{text}{bands}"))?;
    }
    Ok((writer.files, writer.report))
}

/// A name that is read again: very long ones are not.
fn readable(name: &str) -> Cow<'_, str> {
    if name.len() > LONGEST_NAME / 2 { shortened(name) } else { name.into() }
}

/// Names of materials that OBJ, MTL and this format can all carry, and that are all different.
fn names(scene: &Scene) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let plain = |name: &str| {
        let name = mtl::plain_name(&readable(name));
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
    scene.body.materials.iter().map(|material| plain(&material.name)).map(unique).collect()
}

struct Writer<'a> {
    scene: &'a Scene,
    folder: PathBuf,
    /// What all names of files begin with.
    stem: String,
    options: &'a WriteOptions,
    /// Of the materials, as they are written.
    names: Vec<String>,
    /// Names of files, in small letters: some disks do not tell the cases apart.
    taken: BTreeSet<String>,
    /// Tables of one column: its name, what it holds, and the file.
    tables: Vec<(String, Spectrum, String)>,
    files: Staged,
    report: Report,
}

/// A TOML string or key: of the four kinds of strings, the one that can be a key whatever its content.
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

    /// Whether an item's value is left out: it was not stated, and equals its default.
    fn is_left_out(&self, item: &str, is_default: bool) -> bool {
        let is_unsaid = match &self.options.unsaid {
            Unsaid::Nothing => false,
            Unsaid::Items(items) => items.contains(item),
            Unsaid::Defaults(_) => true,
        };
        is_unsaid && is_default
    }

    /// A comment for a table that was not stated.
    fn comment(&self, table: &str) -> String {
        match &self.options.unsaid {
            Unsaid::Defaults(taken) => {
                let line = |message: &String| {
                    format!("# Not said by the source, and taken: {}\n", quoted(message).trim_matches('"'))
                };
                taken.get(table).map_or(String::new(), line)
            }
            _ => String::new(),
        }
    }

    /// Writes a file beside the scene file; gives its name.
    fn file(
        &mut self,
        name: &str,
        extension: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<String> {
        let plain = |c: char| if c.is_alphanumeric() || ".-".contains(c) { c } else { '_' };
        let mut name: String = shortened(name).chars().map(plain).collect();
        while !self.taken.insert(format!("{name}.{extension}").to_lowercase()) {
            name.push('_');
        }
        let name = format!("{}{name}.{extension}", self.stem);
        let path = self.files.beside(&self.folder.join(&name))?;
        self.files.put(&path, write)?;
        Ok(name)
    }

    /// A spectrum as a value: a number, or the quoted name of a table.
    fn values(&mut self, name: &str, column: &str, spectrum: &Spectrum) -> Result<String> {
        if let Some(value) = constant(spectrum) {
            return Ok(format!("{value:?}"));
        }
        // Materials that differ in their temperatures alone share their tables.
        if let Some((.., file)) = self.tables.iter().find(|(of, known, _)| of == column && known == spectrum) {
            return Ok(quoted(file));
        }
        let file = self.file(name, "csv", |out| photometry_csv::write(out, &[(column, spectrum)]))?;
        self.tables.push((column.to_owned(), spectrum.clone(), file.clone()));
        Ok(quoted(&file))
    }

    fn scene(&mut self) -> Result<String> {
        let scene = self.scene;
        let mut text = String::new();
        // Writing to a string does not fail.
        let _ = writeln!(text, "mmxrt_scene = 1\norigin_m = {}\n", list(scene.body.origin_m));
        let obj = self.mesh()?;
        let _ = writeln!(text, "[[mesh]]\nobj = {}", quoted(&obj));
        if self.options.axes == Axes::Site {
            text.push_str("pose = \"radial\"\n");
        }
        for (i, material) in scene.body.materials.iter().enumerate() {
            text += &self.material(i, material)?;
        }
        text += &self.sun()?;
        text += &self.mars()?;
        text += &self.bodies()?;
        text += &self.lamps()?;
        text += &self.thermal();
        Ok(text)
    }

    /// Where a camera is, and what it is, without its bands.
    fn view(&mut self, camera: &FrameCamera) -> Result<String> {
        let (mut text, scene, pose) = (String::new(), self.scene, &camera.world_from_sensor);
        // Writing to a string does not fail.
        let _ = match self.options.axes == Axes::Site {
            true => writeln!(
                text,
                "\n{}[observer]\nframe = \"site\"\nposition_m = {}",
                self.comment("observer"),
                list(pose.translation_m)
            ),
            false => writeln!(
                text,
                "\n{}[observer]\nposition_m = {}",
                self.comment("observer"),
                absolute(pose.translation_m, scene.body.origin_m)
            ),
        };
        let axes = [("h", pose.rotation.x_axis), ("v", pose.rotation.y_axis), ("u", pose.rotation.z_axis)];
        for (name, axis) in axes {
            let _ = writeln!(text, "{name} = {}", list(axis));
        }
        text += &self.sensor(camera)?;
        Ok(text)
    }

    /// The mesh and the names of its materials; gives the name of the OBJ.
    fn mesh(&mut self) -> Result<String> {
        let mesh = &self.scene.body.mesh;
        let lost = obj::faces_lost(mesh);
        if lost > 0 {
            let message = format!("{lost} faces of more than three corners become triangles");
            self.note(Fate::Dropped, "mesh", message);
        }
        for (material, name) in self.scene.body.materials.iter().zip(self.names.clone()) {
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
        let mut text = format!("\n{}[materials.{}]\n", self.comment(&item), quoted(&name));
        let key = |key: &str| format!("{}.{key}", member("materials", &material.name));
        let mut tables: Vec<&Spectrum> = Vec::new();
        match self.shares(i, material) {
            Some(shares) => _ = writeln!(text, "mixture = {{ {shares} }}"),
            None => {
                let model = material.photometry.model();
                let reflectance = match &material.photometry {
                    Photometry::Model(model) => Some(&model.albedo),
                    Photometry::Table(table) => Some(table.factor()).filter(|factor| constant(factor) != Some(1.0)),
                    _ => Some(&material.reflectance),
                };
                if let Some(reflectance) = reflectance {
                    let values = self.values(&file("reflectance"), "reflectance", reflectance)?;
                    _ = writeln!(text, "reflectance = {values}");
                    tables.extend(Some(reflectance).filter(|s| constant(s).is_none()));
                }
                if let Photometry::Table(table) = &material.photometry {
                    if reflectance.is_some() {
                        text.push_str("measured = \"albedo\"\n");
                    }
                    let name = self.file(&file("table"), "csv", |out| reflectance_csv::write(out, table))?;
                    _ = writeln!(text, "table = {}", quoted(&name));
                    tables.extend(Some(table.albedo()).filter(|_| table.tables().len() > 1));
                }
                if let Some(Model { shape, preset, .. }) = model {
                    let (preset, base) = shapes::base(shape, *preset);
                    preset.inspect(|preset| _ = writeln!(text, "preset = {:?}", preset.name()));
                    let (key, numbers) = (shape.key(), shapes::text(shape, base.as_ref()));
                    _ = writeln!(text, "measured = \"albedo\"\n{key} = {numbers}");
                }
            }
        }
        let is_usual = self.usual_emissivity(i, material).as_ref() == Some(&material.emissivity);
        // Everything is stated by `write` but this: one table more for each material would say nothing new.
        let is_stated = matches!(self.options.unsaid, Unsaid::Nothing);
        if !(is_usual && (is_stated || self.is_left_out(&key("emissivity"), true))) {
            let values = self.values(&file("emissivity"), "emissivity", &material.emissivity)?;
            let _ = writeln!(text, "emissivity = {values}");
            tables.extend(Some(&material.emissivity).filter(|s| constant(s).is_none()));
        }
        let has_columns = matches!(material.photometry, Photometry::Hapke(_) | Photometry::Rpv(_));
        if let Some(key) = material.photometry.key().filter(|_| has_columns) {
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
        let usual = self.usual(i, material);
        let is = |value: f64, usual: Option<f64>| usual.is_some_and(|usual| (value - usual).abs() <= SAME);
        if !self.is_left_out(&key("bond_albedo"), is(bond, usual.map(|(bond, _)| bond))) {
            let _ = writeln!(text, "bond_albedo = {bond:?}");
        }
        if !self.is_left_out(&key("emissivity_bolometric"), is(bolometric, usual.map(|(_, bolometric)| bolometric))) {
            let _ = writeln!(text, "emissivity_bolometric = {bolometric:?}");
        }
        if material.thermal_inertia != 0.0 {
            let _ = writeln!(text, "thermal_inertia = {:?}", material.thermal_inertia);
        }
        if let Some(t_k) = material.temperature_k {
            let _ = writeln!(text, "temperature_k = {t_k:?}");
        }
        Ok(text)
    }

    /// How warm the surface is, and how it got there.
    fn thermal(&self) -> String {
        let scene = self.scene;
        let model = match scene.models.thermal {
            Thermal::Equilibrium if scene.models.conduction.is_some() => "conduction",
            Thermal::Equilibrium => "equilibrium",
            Thermal::Thesis => "thesis",
            Thermal::Off => "off",
        };
        let mut text = String::new();
        if scene.models.to_state().thermal {
            let _ = writeln!(text, "model = \"{model}\"");
        }
        if let Some(steps) = scene.models.conduction {
            let _ = writeln!(text, "steps = {steps}");
        }
        if scene.models.floor_k != 0.0 {
            let _ = writeln!(text, "floor_k = {:?}", scene.models.floor_k);
        }
        if let Some(Rotation { axis, period_s }) = scene.sky.rotation {
            let _ = writeln!(text, "period_s = {period_s:?}\naxis = {}", list(axis.vec()));
        }
        if text.is_empty() { text } else { format!("\n[thermal]\n{text}") }
    }

    /// Bond albedo and bolometric emissivity of a material that does not state them.
    fn usual(&self, i: usize, material: &Material) -> Option<(f64, f64)> {
        let parts = self.parts(i, material)?;
        if parts.is_empty() {
            return Some((solar_mean(&material.reflectance)?, EMISSIVITY_BOLOMETRIC));
        }
        Some((mean(&parts, |m| m.bond_albedo), mean(&parts, |m| m.emissivity_bolometric)))
    }

    /// The emissivity of a material that does not state it.
    fn usual_emissivity(&self, i: usize, material: &Material) -> Option<Spectrum> {
        mixed_emissivity(&self.parts(i, material)?, &material.reflectance)
    }

    /// What a mixture consists of, with shares; nothing for an entry of its own, `None` for parts that are not there.
    fn parts(&self, i: usize, material: &Material) -> Option<Vec<(f64, &Material)>> {
        if material.mixture == [(i, 1.0)] {
            return Some(Vec::new());
        }
        let part = |&(part, share): &(usize, f64)| Some((share, self.scene.body.materials.get(part)?));
        material.mixture.iter().map(part).collect()
    }

    /// The shares of a mixture; `None` for an entry with a reflectance of its own.
    fn shares(&mut self, i: usize, material: &Material) -> Option<String> {
        if material.mixture == [(i, 1.0)] {
            return None;
        }
        let of = |&(part, share): &(usize, f64)| Some((share, &self.scene.body.materials.get(part)?.reflectance));
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
        let sun = &self.scene.sky.sun;
        let au = exact(sun.distance_m / AU_M, |au| au * AU_M, sun.distance_m);
        let direction = list(sun.direction.vec());
        let frame = if self.options.axes == Axes::Site { "frame = \"site\"\n" } else { "" };
        let mut text =
            format!("\n{}[sun]\n{frame}direction = {direction}\ndistance_au = {au:?}\n", self.comment("sun"));
        if sun.limb_darkening != 0.0 {
            let _ = writeln!(text, "limb_darkening = {:?}", sun.limb_darkening);
        }
        if self.scene.models.to_state().sun {
            let points = match self.scene.models.sun {
                SunModel::Point => 1,
                SunModel::Disc(rule) => rule.count(),
            };
            let _ = writeln!(text, "points = {points}");
        }
        let e490 = solar_e490();
        if sun.irradiance_1au == *e490 {
            if !self.is_left_out("sun.spectrum", true) {
                text.push_str("spectrum = \"e490\"\n");
            }
            self.total_irradiance(None);
            return Ok(text);
        }
        // What has nothing beyond its ends, though it may be the Sun's, was scaled to be so: a part of it is not the Sun's, and a total
        // that is given scales it to what it was.
        let table = self.known(&sun.irradiance_1au, "sun.spectrum");
        let total = sun.total_irradiance_1au_w_m2;
        let own = SunTotal::of(&table);
        let is_same = |a: f64, b: f64| (a / b - 1.0).abs() <= SAME;
        let is_scaled = !is_same(own.w_m2(), total) && is_same(own.table_w_m2, total);
        let written = if is_scaled { table.map(|v| v / 16.0) } else { table };
        let name = self.file(".sun", "csv", |out| photometry_csv::write(out, &[("irradiance_w_m2_um", &written)]))?;
        let _ = writeln!(text, "spectrum = {}", quoted(&name));
        if is_scaled {
            let _ = writeln!(text, "total_irradiance_w_m2 = {total:?}");
        } else {
            self.total_irradiance(Some(own.w_m2()));
        }
        Ok(text)
    }

    /// Notes a total that is not that of the spectrum as it is written.
    fn total_irradiance(&mut self, written: Option<f64>) {
        let written = written.unwrap_or_else(|| SunTotal::of(solar_e490()).w_m2());
        let total = self.scene.sky.sun.total_irradiance_1au_w_m2;
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
        let supports =
            self.scene.exposure.bands.iter().map(|band| band.support_within_um(self.scene.known_um(band.light)));
        let ends = supports.fold((f64::INFINITY, 0.0_f64), |(a, b), (low, high)| (a.min(low), b.max(high)));
        let mut um = spectrum.wavelength_um().to_vec();
        um.extend([ends.0, ends.1].into_iter().filter(|um| *um > 0.0));
        um.sort_by(f64::total_cmp);
        um.dedup();
        let value = um.iter().filter_map(|&um| spectrum.at(um)).collect();
        Spectrum::new(um, value, Extend::Error).unwrap_or_else(|| spectrum.clone())
    }

    fn mars(&mut self) -> Result<String> {
        let Some(mars) = &self.scene.sky.mars else { return Ok(String::new()) };
        let mut text = format!("\n[mars]\nposition_m = {}\n", absolute(mars.centre_m, self.scene.body.origin_m));
        let albedo = constant(&mars.reflectance);
        if !self.is_left_out("mars.albedo", albedo == Some(MARS_ALBEDO)) {
            let albedo = match albedo {
                Some(value) => format!("{value:?}"),
                None => {
                    let table = self.known(&mars.reflectance, "mars.albedo");
                    self.values(".mars", "albedo", &table)?
                }
            };
            let _ = writeln!(text, "albedo = {albedo}");
        }
        let numbers = [
            ("radius_m", mars.radius_m, MARS_RADIUS_M),
            ("bond_albedo", mars.bond_albedo, MARS_BOND_ALBEDO),
            ("thermal_exitance_w_m2", mars.thermal_exitance_w_m2, MARS_THERMAL_EXITANCE_W_M2),
        ];
        for (key, value, usual) in numbers {
            if !self.is_left_out(&format!("mars.{key}"), value == usual) {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
        let model = match self.scene.models.mars_light {
            MarsModel::NearField => "near_field",
            MarsModel::Thesis => "thesis",
            MarsModel::Off => "off",
        };
        if self.scene.models.to_state().mars_light {
            let _ = writeln!(text, "model = \"{model}\"");
        }
        for (key, value, usual) in
            [("day_k", mars.day_night_k[0], MARS_DAY_NIGHT_K[0]), ("night_k", mars.day_night_k[1], MARS_DAY_NIGHT_K[1])]
        {
            if value != usual {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
        if self.scene.models.to_state().mars_heat {
            let _ = writeln!(text, "heat = {}", self.scene.models.mars_heat);
        }
        if self.scene.models.to_state().eclipses {
            let _ = writeln!(text, "eclipse = {}", self.scene.models.eclipses);
        }
        if let Some(rule) = self.scene.models.mars_shadows {
            let _ = writeln!(text, "points = {}", rule.count());
        }
        Ok(text)
    }

    fn bodies(&mut self) -> Result<String> {
        let mut text = String::new();
        for (i, body) in self.scene.sky.bodies.iter().enumerate() {
            let albedo = match constant(&body.reflectance) {
                Some(value) => format!("{value:?}"),
                None => {
                    let table = self.known(&body.reflectance, &format!("bodies.{:?}.albedo", body.name));
                    self.values(&format!(".{}", body.name), "albedo", &table)?
                }
            };
            let (name, position_m) = (quoted(&body.name), absolute(body.centre_m, self.scene.body.origin_m));
            let Globe { radius_m, bond_albedo, thermal_exitance_w_m2, day_night_k: [day_k, night_k], .. } = body;
            let _ = writeln!(
                text,
                "\n[[bodies]]\nname = {name}\nposition_m = {position_m}\nradius_m = {radius_m:?}\nalbedo = {albedo}\n\
                 bond_albedo = {bond_albedo:?}\nday_k = {day_k:?}\nnight_k = {night_k:?}\n\
                 thermal_exitance_w_m2 = {thermal_exitance_w_m2:?}"
            );
            if i == 0 && self.scene.sky.mars.is_none() && self.scene.models.to_state().eclipses {
                let _ = writeln!(text, "eclipse = {}", self.scene.models.eclipses);
            }
        }
        Ok(text)
    }

    fn lamps(&mut self) -> Result<String> {
        let mut text = String::new();
        for beam in &self.scene.sky.beams {
            let item = format!("lamps.{:?}.irradiance", beam.name);
            let irradiance = match constant(&beam.irradiance) {
                Some(value) => format!("{value:?}"),
                None => {
                    let table = self.known(&beam.irradiance, &item);
                    let column = [("irradiance_w_m2_um", &table)];
                    let name = format!(".{}", beam.name);
                    quoted(&self.file(&name, "csv", |out| photometry_csv::write(out, &column))?)
                }
            };
            let (name, direction) = (quoted(&beam.name), list(beam.direction.vec()));
            let frame = if self.options.axes == Axes::Site { "frame = \"site\"\n" } else { "" };
            let total = beam.total_irradiance_w_m2;
            let _ = writeln!(
                text,
                "\n[[lamps]]\nname = {name}\n{frame}direction = {direction}\nirradiance = {irradiance}\ntotal_irradiance_w_m2 = {total:?}"
            );
        }
        Ok(text)
    }

    fn sensor(&mut self, camera: &FrameCamera) -> Result<String> {
        let sensor = &self.scene.exposure;
        let mut text = format!("\n{}[sensor]\n", self.comment("sensor"));
        if !self.is_left_out("sensor.name", sensor.instrument == SENSOR_NAME) {
            let _ = writeln!(text, "name = {}", quoted(&sensor.instrument));
        }
        let _ = writeln!(text, "samples = {}\nlines = {}", camera.samples, camera.lines);
        let ifov_mrad = 1e3 * camera.ifov_rad();
        let lens = camera.lens.as_deref();
        let _ = if let Some((centres, size)) = lens.and_then(|lens| Some((lens.centres()?, lens.size()))) {
            let name = self.file(".directions", "npy", |out| out.write_all(&directions::array(centres, size)))?;
            writeln!(text, "directions = {}", quoted(&name))
        } else if !camera.is_centred() {
            let focal_px = camera.pitch.map(|pitch| exact(1.0 / pitch, |focal_px| 1.0 / focal_px, pitch));
            writeln!(text, "focal_px = {focal_px:?}\nboresight_px = {:?}", camera.boresight_px)
        } else if ifov_mrad <= WIDEST_PIXEL_MRAD {
            let ifov_mrad = exact(ifov_mrad, pitch_of_ifov, camera.pitch[0]);
            writeln!(text, "ifov_mrad = {ifov_mrad:?}")
        } else {
            let fov_deg = FrameCamera::angle_of_pitch(camera.pitch[0], camera.samples).to_degrees();
            writeln!(text, "fov_deg = {fov_deg:?}")
        };
        if let Some(BrownConrady { radial: [k1, k2, k3], tangential: [p1, p2] }) = lens.and_then(Lens::coefficients) {
            let _ =
                writeln!(text, "distortion = {{ k1 = {k1:?}, k2 = {k2:?}, k3 = {k3:?}, p1 = {p1:?}, p2 = {p2:?} }}");
        }
        Ok(text)
    }

    fn bands(&mut self) -> Result<String> {
        let bands = &self.scene.exposure.bands;
        let mut text = String::from("\n[sensor.bands]\n");
        let tables: Vec<(&str, &Spectrum)> =
            bands.iter().filter_map(|b| Some((b.name.as_str(), b.response.table()?))).collect();
        let shape = |band: &Band| match (&band.response, band.fwhm_um) {
            (Response::Table(_), _) => "table",
            (Response::Box, Some(_)) => "box",
            (Response::Sinc2, Some(_)) => "sinc2",
            _ => "gaussian",
        };
        let shapes: Vec<&str> = bands.iter().map(shape).collect();
        if tables.len() < bands.len() {
            let centres: Vec<f64> = bands.iter().map(|band| band.centre_um).collect();
            let _ = writeln!(text, "centres_um = {centres:?}");
            let widths: Vec<f64> = bands.iter().map(|band| band.fwhm_um.unwrap_or(0.0)).collect();
            let _ = match widths[..] {
                _ if widths.iter().all(|w| *w == 0.0) => Ok(()),
                [first, ..] if widths.iter().all(|w| *w == first) => writeln!(text, "fwhm_um = {first:?}"),
                _ => writeln!(text, "fwhm_um = {widths:?}"),
            };
            let _ = match shapes.first() {
                _ if shapes.iter().all(|s| *s == "gaussian") => Ok(()),
                Some(first) if shapes.iter().all(|s| s == first) => writeln!(text, "shape = {first:?}"),
                _ => writeln!(text, "shape = {shapes:?}"),
            };
        }
        if !tables.is_empty() {
            let name = self.file(".bands", "csv", |out| response_csv::write(out, &tables))?;
            let _ = writeln!(text, "response = {}", quoted(&name));
        }
        let lights: Vec<&str> = bands.iter().map(|band| band.light.name()).collect();
        let _ = match lights.first() {
            _ if lights.iter().all(|l| *l == "both") => Ok(()),
            Some(first) if lights.iter().all(|l| l == first) => writeln!(text, "light = {first:?}"),
            _ => writeln!(text, "light = {lights:?}"),
        };
        Ok(text)
    }
}
