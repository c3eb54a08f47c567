//! Where DART would not do what its user expects: checks a simulation's inputs without converting them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::formats::ilwis::Raster;
use crate::formats::obj::{self, ObjFile};
use crate::formats::scene_toml::USUAL_UM;
use crate::formats::xml::Element;
use crate::geometry::{Mesh, index_u32};
use crate::physics::reflectance::ALL_LIGHT;

use super::folder::Folder;
use super::frame;
use super::groups;
use super::mandatory::{self, MissingKind};
use super::object::{is_outside, reaches_beyond, seen_facets, standing};
use super::read::coeff_diff::{factor_node, factors_of_bands, uses_factors};
use super::read::object_3d::first_exponent;
use super::read::sequence::count;
use super::read::{FILES, Inputs, ReadOptions, read, terrain};
use super::sidecar::{self, Sidecar};
use super::to_scene::nanometres;
use super::{FieldInstance, Links, Object, OpticalKind, OpticalProperty, Simulation, Version};
use crate::formats::input;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The simulation may not be what is meant.
    Warning,
    /// It cannot be what is meant.
    Error,
}

/// Something in the inputs that is wrong, or looks wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// Where it is.
    pub at: Location,
    /// What it is.
    pub what: String,
    /// What DART does with it, as far as that is known.
    pub effect: String,
    /// What to do about it.
    pub fix: String,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let severity = match self.severity {
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        write!(f, "{severity}: {}: {}", self.at, self.what)?;
        if !self.effect.is_empty() {
            write!(f, ". DART: {}", self.effect)?;
        }
        if !self.fix.is_empty() {
            write!(f, ". Fix: {}", self.fix)?;
        }
        Ok(())
    }
}

/// What a check needs to know of a table in a database of optical properties.
#[derive(Debug, Clone, PartialEq)]
pub struct TableSummary {
    /// First and last wavelength, um.
    pub range_um: (f64, f64),
    /// Of a table that holds them in percent, for each wavelength: reflectance, direct and diffuse transmittance, fractions.
    pub shares: Vec<[f64; 3]>,
}

/// The summary of a table, by the path of its database and its name (empty for a text file); `None` if it is not known.
pub type SummaryOf<'a> = &'a dyn Fn(&Path, &str) -> Option<TableSummary>;

/// For checks that open no database.
pub fn no_summary(_database: &Path, _table: &str) -> Option<TableSummary> {
    None
}

/// Checks a simulation, given its folder or its `input/`. Findings are in the order of the checks, read errors first.
pub fn check(path: &Path, options: &ReadOptions, summary_of: SummaryOf<'_>) -> Vec<Finding> {
    let folder = options.folder(path);
    let inputs = match Inputs::read(&folder) {
        Ok(inputs) => inputs,
        Err(error) => return unreadable(error),
    };
    let missing = missing(&inputs);
    // A date is not a mistake: that its Sun is only nearly known here is for a conversion to say.
    let simulation = match read(path, options) {
        Ok((simulation, _, _)) => simulation,
        Err(error) => return [missing, unreadable(error)].concat(),
    };
    let mut check = Checker { simulation: &simulation, inputs: &inputs, folder: &folder, findings: missing };
    check.files();
    check.date();
    check.bands();
    check.properties(summary_of);
    check.links();
    check.objects();
    check.fields();
    check.terrain();
    check.temperatures();
    check.cameras();
    for sequence in &simulation.sequences {
        check.findings.extend(count(sequence).err().map(unreadable).unwrap_or_default());
    }
    check.findings
}

/// Elements and attributes that DART wants and that are not there.
fn missing(inputs: &Inputs) -> Vec<Finding> {
    let finding = |missing: mandatory::Missing| {
        let mandatory::Missing { path, at, kind } = missing;
        let (what, named, fix) = match kind {
            MissingKind::Element { found: 0, least: 1 } => {
                (format!("`{path}` is missing"), "element", "write it with all its attributes")
            }
            MissingKind::Element { found, least } => {
                let what = format!("`{path}` is there {found} times: at least {least} are required");
                (what, "element", "write it with all its attributes")
            }
            MissingKind::Attribute { places: 1, .. } => (format!("`{path}` is missing"), "attribute", "write it"),
            MissingKind::Attribute { places, .. } => {
                (format!("`{path}` is missing in {places} places"), "attribute", "write it in each of them")
            }
        };
        let effect = format!("wants this {named}: what it does without it is not documented");
        Finding { severity: Severity::Error, at, what, effect, fix: fix.into() }
    };
    mandatory::missing(inputs).into_iter().map(finding).collect()
}

fn unreadable(error: Error) -> Vec<Finding> {
    let finding = |at, what, fix: Option<String>| Finding {
        severity: Severity::Error,
        at,
        what,
        effect: String::new(),
        fix: fix.unwrap_or_default(),
    };
    match error {
        Error::Invalid(problems) => problems.into_iter().map(|p| finding(p.at, p.message, p.help)).collect(),
        Error::Syntax { at, message } => vec![finding(at, message, None)],
        Error::Unsupported { at, feature } => vec![finding(at, format!("{feature} is not supported"), None)],
        Error::Io { path, action, source } => vec![finding(Location::file(path), format!("{action}: {source}"), None)],
        Error::Interrupted => Vec::new(),
    }
}

struct Checker<'a> {
    simulation: &'a Simulation,
    inputs: &'a Inputs,
    folder: &'a Folder,
    findings: Vec<Finding>,
}

impl<'a> Checker<'a> {
    fn error(&mut self, at: &Location, what: impl Into<String>, effect: &str, fix: impl Into<String>) {
        self.add(Severity::Error, at, what.into(), effect, fix.into());
    }

    fn warning(&mut self, at: &Location, what: impl Into<String>, effect: &str, fix: impl Into<String>) {
        self.add(Severity::Warning, at, what.into(), effect, fix.into());
    }

    fn add(&mut self, severity: Severity, at: &Location, what: String, effect: &str, fix: String) {
        self.findings.push(Finding { severity, at: at.clone(), what, effect: effect.into(), fix });
    }

    /// All eleven are there, and of one version.
    fn files(&mut self) {
        for (name, section, _) in FILES {
            if self.inputs.section(section).is_none() {
                let at = Location::file(self.folder.input.join(name));
                self.warning(
                    &at,
                    "is missing",
                    "expects all eleven input files",
                    "write one in which nothing is in use",
                );
            }
        }
        let version = &self.simulation.version;
        let others: Vec<(Location, String)> = self
            .inputs
            .roots()
            .filter(|r| r.get("version") != Some(&version.version) || r.get("build").unwrap_or("") != version.build)
            .map(|r| (r.at_attribute("version"), r.get("version").unwrap_or("none").to_owned()))
            .collect();
        for (at, other) in others {
            let what = format!("is of version {other}, maket.xml of {} {}", version.version, version.build);
            self.warning(&at, what, "upgrades each file by its version", "write all files for one version and build");
        }
        let scene = &self.simulation.maket;
        for (axis, size) in ["x", "y"].iter().zip(scene.size_m) {
            let cells = size / scene.cell_m[0];
            if (cells - cells.round()).abs() > 1e-6 * cells {
                let at = Location::file(self.folder.input.join("maket.xml")).with_item("Scene/SceneDimensions");
                let what = format!(
                    "the scene's extent along {axis}, {size} m, is not a multiple of the cell, {} m",
                    scene.cell_m[0]
                );
                self.warning(&at, what, "works in whole cells", "change the extent or the cell");
            }
        }
    }

    /// South of the equator a Sun by date may be turned.
    fn date(&mut self) {
        let is_dated = |d: &&Element| d.get("exactDate").is_some_and(|mode| mode.trim() == "1");
        let dated = self.inputs.section("Directions").filter(is_dated);
        if dated.is_some() && self.simulation.maket.latitude_longitude_altitude[0] < 0.0 {
            let at = self.simulation.directions.at.clone();
            let effect =
                "is said to count its azimuth from North there, half a turn different from north of it: not confirmed";
            self.warning(&at, "a Sun by date south of the equator", effect, "give the Sun's angles");
        }
    }

    /// Wavelengths in um; one irradiance and factor per band.
    fn bands(&mut self) {
        let simulation = self.simulation;
        for band in simulation.phase.bands.iter().filter(|band| band.mean_um > USUAL_UM) {
            let what = format!("a band at {} um", band.mean_um);
            self.error(&band.at, what, "takes wavelengths in micrometres", nanometres(band));
        }
        let bands = simulation.phase.bands.len();
        let inputs = self.inputs;
        if let Some(list) = inputs.section("Phase").and_then(|p| p.descendant("SpectralIrradiance")) {
            let n = list.all("SpectralIrradianceValue").count();
            if n != bands {
                let fix = "write one `SpectralIrradianceValue` for each band, numbered from 0";
                let effect = "takes one irradiance for each band";
                if self.simulation.phase.irradiance_mode == 1 {
                    self.error(&list.at(), format!("{n} values of irradiance for {bands} bands"), effect, fix);
                } else {
                    self.warning(&list.at(), format!("{n} values of irradiance for {bands} bands"), effect, fix);
                }
            }
        }
        let lists = ["LambertianMultiFunctions", "HapkeSpecularMultiFunctions", "RPVMultiFunctions"];
        let coeff_diff = inputs.section("Coeff_diff");
        for property in lists.iter().filter_map(|l| coeff_diff?.descendant(l)).flat_map(|l| &l.children) {
            let Some(node) = factor_node(property) else {
                if uses_factors(property) {
                    let what = "factors are switched on, but there are none";
                    let fix = "set `useMultiplicativeFactorForLUT` to 0";
                    self.error(&property.at(), what, "may take its defaults, which are not 1 for every model", fix);
                }
                continue;
            };
            let n = factors_of_bands(node).count();
            if n != bands {
                let fix = "write factors for each band, or set `useMultiplicativeFactorForLUT` to 0";
                let effect = "takes factors for each band, even where all are to be the same";
                if node.get("useSameFactorForAllBands") == Some("1") {
                    self.warning(&node.at(), format!("{n} sets of factors for {bands} bands"), effect, fix);
                } else {
                    self.error(&node.at(), format!("{n} sets of factors for {bands} bands"), effect, fix);
                }
            }
        }
    }

    /// Factors, transmittance, spectra.
    fn properties(&mut self, summary_of: SummaryOf<'_>) {
        let mut idents: BTreeSet<String> = BTreeSet::new();
        for property in &self.simulation.optical {
            if !idents.insert(property.ident.to_lowercase()) {
                let what = format!("a second property called `{}`", property.ident);
                self.warning(
                    &property.at,
                    what,
                    "follows numbers; people and tools follow names",
                    "give it a name of its own",
                );
            }
            self.factors(property);
            self.transparency(property);
            self.spectrum(property, summary_of);
        }
    }

    fn factors(&mut self, property: &OpticalProperty) {
        // Transmittance is switched off by 0: the model has its own check.
        let is_neutral = |name: &str, value: f64| value == 1.0 || (value == 0.0 && name.contains("ransmittance"));
        let mut odd: BTreeMap<&str, f64> = BTreeMap::new();
        for (name, value) in property.factors.iter().flatten() {
            if !is_neutral(name, *value) {
                odd.entry(name).or_insert(*value);
            }
        }
        if !odd.is_empty() {
            let listed: Vec<String> = odd.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            let what = format!("`{}` is multiplied: {}", property.ident, listed.join(", "));
            let effect = "multiplies what the database holds; its own defaults are not 1 for RPV";
            self.warning(&property.at, what, effect, "set `useMultiplicativeFactorForLUT` to 0 if that is not meant");
        }
    }

    fn transparency(&mut self, property: &OpticalProperty) {
        let Some((_, table)) = &property.transmittance else { return };
        let shut = |factors: &Vec<(String, f64)>| {
            let mut of_transmittance = factors.iter().filter(|(name, _)| name.contains("ransmittance")).peekable();
            of_transmittance.peek().is_some() && of_transmittance.all(|(_, value)| *value == 0.0)
        };
        let is_shut = !property.factors.is_empty() && property.factors.iter().all(shut);
        if table.contains("trans_equal_1") && !is_shut {
            let what =
                format!("`{}` takes its transmittance from `{table}`, and no factor of 0 stops it", property.ident);
            let fix = "take `reflect_equal_1_trans_equal_0_0`";
            self.error(&property.at, what, "lets light through the surface: this table is its default", fix);
        }
    }

    fn spectrum(&mut self, property: &OpticalProperty, summary_of: SummaryOf<'_>) {
        let path = match self.folder.locate(&property.database, &property.at) {
            Ok(Some(path)) => path,
            // A database that DART ships is not expected in the folder.
            Ok(None) => return,
            Err(problem) => {
                let fix = problem.help.unwrap_or_default();
                return self.warning(&property.at, problem.message, "looks there", fix);
            }
        };
        let Some(TableSummary { range_um: (first, last), shares }) = summary_of(&path, &property.model) else {
            return;
        };
        if first > USUAL_UM {
            let what = format!("`{}` of {} runs from {first} to {last} um", property.model, property.database);
            let effect = "takes wavelengths in micrometres";
            return self.error(&property.at, what, effect, "if these are nanometres, divide them by 1000");
        }
        let outside = |mean: f64, width: f64| mean - width / 2.0 < first || mean + width / 2.0 > last;
        let bands = &self.simulation.phase.bands;
        let bare: Vec<String> = bands
            .iter()
            .enumerate()
            .filter(|(_, b)| outside(b.mean_um, b.width_um))
            .map(|(i, _)| i.to_string())
            .collect();
        if !bare.is_empty() {
            let shown = if bare.len() > 8 { format!("{}, ...", bare[..8].join(", ")) } else { bare.join(", ") };
            let what = format!(
                "`{}` of {} runs from {first} to {last} um: bands {shown} reach beyond it",
                property.model, property.database
            );
            self.error(
                &property.at,
                what,
                "does something there that is not known",
                "extend the spectrum over all bands",
            );
        }
        let largest = 100.0 * shares.iter().map(|row| row[0]).fold(0.0, f64::max);
        if (0.0..=1.0).contains(&largest) && largest > 0.0 && !self.is_as_written(property, largest) {
            let what =
                format!("the reflectances of `{}` reach only {largest}: they look like fractions", property.model);
            self.warning(&property.at, what, "takes them as percent: 0.3 is 0.3 %", "multiply them by 100");
        }
        self.energy(property, &shares);
    }

    /// Whether a scene that was written here has a material as dark as that, of this largest reflectance in percent.
    fn is_as_written(&self, property: &OpticalProperty, largest: f64) -> bool {
        let around = self.folder.simulation.parent().map(Path::to_owned).unwrap_or_default();
        // Beside the simulation, and beside that of which this is the one lit by Mars.
        let folders = [self.folder.simulation.clone(), around];
        let sidecar = folders.iter().find_map(|folder| Sidecar::read(&folder.join(sidecar::FILE)).ok().flatten());
        let material = sidecar.and_then(|(sidecar, _)| sidecar.material(&property.ident));
        let value = material.map(|m| 100.0 * m.reflectance.value().iter().copied().fold(0.0, f64::max));
        value.is_some_and(|value| (value - largest).abs() <= 1e-9 * largest)
    }

    /// What is reflected and let through is not more than what comes in.
    fn energy(&mut self, property: &OpticalProperty, shares: &[[f64; 3]]) {
        const NAMES: [&str; 3] = ["reflectanceFactor", "directTransmittanceFactor", "diffuseTransmittanceFactor"];
        let of = |set: &Vec<(String, f64)>| NAMES.map(|name| set.iter().find(|f| f.0 == name).map_or(1.0, |f| f.1));
        let mut sets: Vec<[f64; 3]> = property.factors.iter().map(of).collect();
        if sets.is_empty() {
            sets.push([1.0; 3]);
        }
        let sum =
            |row: &[f64; 3], set: &[f64; 3]| row.iter().zip(set).map(|(share, factor)| share * factor).sum::<f64>();
        let all = shares.iter().flat_map(|row| sets.iter().map(|set| sum(row, set)));
        let most = 100.0 * all.fold(0.0, f64::max);
        if most > 100.0 * ALL_LIGHT {
            let what = format!(
                "`{}` ({}) reflects and lets through up to {most} % of the light",
                property.ident, property.model
            );
            self.error(
                &property.at,
                what,
                "does not check it: light comes from nowhere",
                "lower one of them to 100 % in all",
            );
        }
    }

    /// Links lead to what they name.
    fn links(&mut self) {
        let simulation = self.simulation;
        let mut links: Vec<&Links> = vec![&simulation.maket.ground];
        let models = simulation.fields.iter().flat_map(|f| &f.models);
        for object in simulation.objects.iter().chain(models).filter(|o| !o.hidden) {
            links.extend(object.links.iter().chain(&object.back));
            links.extend(object.groups.iter().filter(|g| !g.hidden).flat_map(|g| g.links.iter().chain(&g.back)));
        }
        for link in links {
            self.link(link);
        }
        let models = simulation.fields.iter().flat_map(|f| &f.models);
        for object in simulation.objects.iter().chain(models).filter(|o| o.links.is_none() && !o.hidden) {
            for group in object.groups.iter().filter(|g| g.links.is_none() && !g.hidden) {
                let what = format!("the group `{}` has no optical property", group.name);
                self.error(&group.at, what, "has nothing to make it of", "link it to one");
            }
        }
        let models = simulation.fields.iter().flat_map(|f| &f.models);
        for object in simulation.objects.iter().chain(models).filter(|o| !o.hidden) {
            let of_object = object.links.is_some() && object.double_face && object.back.is_none();
            let bare = |g: &&super::Group| !g.hidden && g.links.is_some() && g.double_face && g.back.is_none();
            let groups = object.groups.iter().filter(bare).map(|g| (&g.name, &g.at));
            for (name, at) in of_object.then_some((&object.name, &object.at)).into_iter().chain(groups) {
                let what = format!("`{name}` has two faces (`doubleFace`), but no properties of the back");
                let fix = "link `BackFaceOpticalProperty` and `BackFaceThermalProperty`, or set `doubleFace` to 0";
                // From 5.10 on it is not known how they are said.
                if simulation.version.is_before(5, 10) {
                    self.error(at, what, "has nothing to make the back of", fix);
                } else {
                    self.warning(at, what, "has nothing to make the back of", fix);
                }
            }
        }
    }

    fn link(&mut self, link: &Links) {
        let simulation = self.simulation;
        let kinds = [(0, OpticalKind::Lambertian), (2, OpticalKind::Hapke), (4, OpticalKind::Rpv)];
        if let Some((_, kind)) = kinds.iter().find(|(code, _)| *code == link.kind) {
            let list: Vec<&OpticalProperty> = simulation.optical.iter().filter(|p| p.kind == *kind).collect();
            let names: Vec<&str> = list.iter().map(|p| p.ident.as_str()).collect();
            self.leads(&link.at, "optical property", "type and index", &link.ident, link.index, &names);
        }
        let names: Vec<&str> = simulation.thermal.iter().map(|t| t.ident.as_str()).collect();
        self.leads(&link.at, "temperature", "the index", &link.thermal_ident, link.thermal_index, &names);
    }

    fn leads(&mut self, at: &Location, what: &str, by: &str, ident: &str, index: u32, names: &[&str]) {
        let place = names.iter().position(|name| name.eq_ignore_ascii_case(ident));
        let fix = match place {
            Some(i) => format!("write index {i}, where `{ident}` is"),
            None => "link to an entry that is there".into(),
        };
        match names.get(index as usize) {
            None => {
                let what = format!("the {what} {index} (`{ident}`) is not there: the list has {}", names.len());
                self.error(at, what, "follows the index out of the list", fix);
            }
            Some(name) if !ident.is_empty() && !name.eq_ignore_ascii_case(ident) => {
                let what = format!("the {what} is called `{ident}`, but index {index} is `{name}`");
                self.error(at, what, &format!("takes `{name}`: it follows {by}, not the name"), fix);
            }
            Some(_) => {}
        }
    }

    /// Groups, placement and meshes.
    fn objects(&mut self) {
        let simulation = self.simulation;
        let list = self.inputs.section("object_3d").and_then(|o| o.child("ObjectList"));
        let elements: Vec<&Element> = list.iter().flat_map(|l| l.all("Object")).collect();
        for (object, element) in simulation.objects.iter().zip(elements).filter(|(o, _)| !o.hidden) {
            let Some((_, mesh)) = self.mesh(object, element) else { continue };
            if let Some(bounds_m) = mesh.bounds_m() {
                self.ground(object, element, bounds_m);
                self.edges(object, bounds_m);
            }
            self.normals(object, &mesh);
        }
    }

    /// An object's file, and its facets where the object stands; `None` if it cannot be read, which is said.
    fn mesh(&mut self, object: &Object, element: &Element) -> Option<(ObjFile, Mesh)> {
        let obj = match load(self.folder, object) {
            Ok(Some(obj)) => obj,
            Ok(None) => {
                let what = format!("`{}` is not in the input folder", object.file);
                let at = element.at_attribute("file_src");
                self.error(&at, what, "looks there, then among its 3D objects", "copy the file there");
                return None;
            }
            Err(error) => {
                self.findings.extend(unreadable(error));
                return None;
            }
        };
        self.groups(object, &obj);
        self.axes(object, element, &obj);
        let mesh = standing(&object.place(), &obj, &seen_facets(object, &obj, &self.simulation.version));
        Some((obj, mesh))
    }

    /// Objects that reach beyond the scene.
    fn edges(&mut self, object: &Object, (low, high): (DVec3, DVec3)) {
        let [x, y] = self.simulation.maket.size_m;
        if !reaches_beyond((low, high), [x, y]) {
            return;
        }
        let is_outside = low.x > x || low.y > y || high.x < 0.0 || high.y < 0.0;
        let how = if is_outside { "lies outside" } else { "reaches beyond" };
        let what = format!(
            "`{}` {how} the scene: it spans x {} to {} and y {} to {} m of 0 to {x} and 0 to {y}",
            object.name, low.x, high.x, low.y, high.y
        );
        self.warning(&object.at, what, beyond_edge(object), "move it, or make the scene larger");
    }

    /// The texts of object fields, the meshes of their models, and where these stand.
    fn fields(&mut self) {
        let simulation = self.simulation;
        let size_m = simulation.maket.size_m;
        let list = self.inputs.section("object_3d").and_then(|o| o.child("ObjectFields"));
        let elements: Vec<&Element> = list.iter().flat_map(|l| l.all("Field")).collect();
        for (field, element) in simulation.fields.iter().zip(elements) {
            match self.folder.locate(&field.file, &field.at) {
                Ok(None) => {
                    let what = format!("`{}` is not in the input folder", field.file);
                    self.error(&field.at, what, "looks there", "copy the file there");
                }
                Ok(Some(path)) => self.text(&path),
                // Told by what has been read.
                Err(_) => {}
            }
            let outside = field.places.iter().filter(|place| is_outside(place, size_m)).count();
            if outside > 0 {
                let what = format!("{outside} of {} places lie outside of the scene", field.places.len());
                self.warning(&field.at, what, "leaves them out", "move them, or make the scene larger");
            }
            let list = element.child("ModelList");
            let elements: Vec<&Element> = list.iter().flat_map(|l| l.all("Object")).collect();
            for (number, (model, element)) in field.models.iter().zip(elements).enumerate() {
                if model.hidden {
                    continue;
                }
                let Some((obj, mesh)) = self.mesh(model, element) else { continue };
                self.normals(model, &mesh);
                let facets = seen_facets(model, &obj, &simulation.version);
                let (mut beyond, mut dropped) = (0_usize, 0_usize);
                let within = field.places.iter().filter(|place| !is_outside(place, size_m));
                for place in within.filter(|place| place.model as usize == number) {
                    let Some(bounds_m) = standing(place, &obj, &facets).bounds_m() else { continue };
                    beyond += usize::from(reaches_beyond(bounds_m, size_m));
                    dropped += usize::from(self.is_dropped(model, bounds_m));
                }
                if dropped > 0 {
                    let what = format!("`{}` is dropped to the ground at {dropped} of its places", model.name);
                    self.warning(&element.at_attribute("objectDEMMode"), what, DROPPED, KEEP_Z);
                }
                if beyond > 0 {
                    let what = format!("`{}` reaches beyond the scene at {beyond} of its places", model.name);
                    self.warning(&model.at, what, beyond_edge(model), "move them, or make the scene larger");
                }
            }
        }
    }

    /// Numbers of a field's text that DART does not read.
    fn text(&mut self, path: &Path) {
        // What cannot be read has been told.
        let Ok(Some(at)) = first_exponent(path) else { return };
        let what = "a number with an exponent";
        self.warning(&at, what, "wants plain decimal numbers here, by its manual", "write its digits out");
    }

    /// The numbers of groups, which alone bind them to those of the OBJ file.
    fn groups(&mut self, object: &Object, obj: &ObjFile) {
        if object.groups.is_empty() {
            return;
        }
        let owning: Vec<&str> = obj.groups.iter().map(String::as_str).collect();
        let count = owning.len().max(1);
        if object.groups.len() != count {
            let what = format!("{} groups, but `{}` has {count} that own faces", object.groups.len(), object.file);
            self.error(
                &object.at,
                what,
                "binds groups by their numbers",
                "write one `Group` for each group with faces",
            );
            return;
        }
        let mut numbers: Vec<u32> = object.groups.iter().map(|g| g.number).collect();
        numbers.sort_unstable();
        if !numbers.iter().copied().eq(1..=index_u32(count)) {
            let what = format!("the numbers of the groups are not 1 to {count}, each once");
            self.error(&object.at, what, "binds groups by their numbers", "number them in DART's order");
            return;
        }
        let version = &self.simulation.version;
        let order = groups::order(&owning, version);
        for group in &object.groups {
            // A name that is none of the file's is a label only.
            let Some(wanted) = order.iter().position(|&i| owning[i] == group.name) else { continue };
            let taken = owning[order[group.number as usize - 1]];
            if taken != group.name {
                let what = format!("the group `{}` has number {}, which is `{taken}`", group.name, group.number);
                let effect = format!("gives these properties to `{taken}`: it binds by number");
                self.error(&group.at, what, &effect, format!("write num=\"{}\"", wanted + 1));
            }
        }
        let later = Version { version: version.version.clone(), build: "v1111".into() };
        if order != groups::order(&owning, &later) {
            let what = format!("the groups of `{}` have another order from build v1111 on", object.file);
            let effect = "may bind them otherwise once the files are upgraded";
            self.warning(&object.at, what, effect, "name groups so that both orders agree, as in a, b, c");
        }
    }

    /// OBJ files stand upright on y.
    fn axes(&mut self, object: &Object, element: &Element, obj: &ObjFile) {
        // All that is in the file, as it lies there.
        let mesh = standing(&FieldInstance::default(), obj, &Vec::from_iter(0..obj.facets.len()));
        let Some((low, high)) = mesh.bounds_m() else { return };
        let size = high - low;
        let given = element.descendant("Dimension3D").and_then(|d| {
            let of = |name: &str| d.get(name)?.trim().parse::<f64>().ok();
            Some((d, DVec3::new(of("xdim")?, of("ydim")?, of("zdim")?)))
        });
        let alike = |a: DVec3, b: DVec3| (a - b).abs().max_element() <= 1e-3 * a.abs().max_element();
        if let Some((dimension, given)) = given {
            let at = dimension.at();
            if alike(given, frame::obj_from_dart(size)) && !alike(given, size) {
                let what = format!("the dimensions of `{}` are those of its own x, y, z", object.file);
                let effect = format!("{}: the object lies on its side", frame::OBJ_AXES);
                return self.warning(&at, what, &effect, frame::WRITE_OBJ_AXES);
            }
            if !alike(given, size) {
                let what = format!("dimensions {given}, but those of `{}` are {size} along DART's axes", object.file);
                self.warning(&at, what, "measures the file itself", "write these dimensions");
            }
        }
        // A sheet whose facets all look along one side of the scene: a terrain with z upwards in its OBJ file.
        let (sum, area) = mesh.vector_area_m2();
        if area > 0.0 && sum.x.abs() > 0.8 * area {
            let what = format!("`{}` stands on edge: its facets look along x", object.file);
            let fix = format!("{} if its third number is the height", frame::WRITE_OBJ_AXES);
            self.warning(&object.at, what, frame::OBJ_AXES, fix);
        }
    }

    /// Whether DART moves an object that spans this to the ground, and by more than rounding.
    fn is_dropped(&self, object: &Object, (low, high): (DVec3, DVec3)) -> bool {
        let is_on_plane = || low.z.abs() <= 1e-6 * (high - low).max_element();
        object.dem_mode == 0 && (self.simulation.maket.topography.is_some() || !is_on_plane())
    }

    fn ground(&mut self, object: &Object, element: &Element, bounds_m: (DVec3, DVec3)) {
        if self.is_dropped(object, bounds_m) {
            let z_m = bounds_m.0.z;
            let what = format!("`{}` is dropped to the ground: its lowest point is at z = {z_m} m", object.name);
            self.warning(&element.at_attribute("objectDEMMode"), what, DROPPED, KEEP_Z);
        }
    }

    /// The raster can be read, spans the scene, and fits its own copy where the scene is repeated.
    fn terrain(&mut self) {
        let (simulation, maket) = (self.simulation, &self.simulation.maket);
        let raster = match terrain(simulation, self.folder) {
            Ok(None) if maket.topography.as_ref().is_some_and(|t| !t.generated) => {
                let Some(topography) = &maket.topography else { return };
                let what = format!("the terrain `{}` is not there", topography.file);
                return self.error(&topography.at, what, "cannot run without it", "put it into the input folder");
            }
            Ok(raster) => raster,
            // What is not read here need not be wrong.
            Err(Error::Unsupported { .. }) => return,
            Err(error) if maket.topography.as_ref().is_some_and(|t| t.generated) => {
                for finding in unreadable(error) {
                    let effect = "makes the terrain again before it runs (`createTopography`)";
                    self.warning(&finding.at, finding.what, effect, "run its generator to see it");
                }
                return;
            }
            Err(error) => return self.findings.extend(unreadable(error)),
        };
        let (Some((raster, _)), Some(topography), 1) = (raster, &maket.topography, maket.boundary) else { return };
        let Raster { rows, columns, values: h, .. } = raster;
        let along_x = (0..columns).map(|j| h[(rows - 1) * columns + j] - h[j]);
        let along_y = (0..rows).map(|i| h[(i + 1) * columns - 1] - h[i * columns]);
        let step_m = along_x.chain(along_y).map(f64::abs).fold(0.0, f64::max);
        if step_m > 0.0 {
            let what = format!("heights on opposite edges of `{}` differ by up to {step_m} m", topography.file);
            let effect =
                "puts the first line and column in place of the last ones, so that the repeated scene meets itself";
            let fix = "set `exactlyPeriodicScene` to 2 for a slope that goes on or to 0 for nothing beside it, or make the edges alike";
            self.warning(&topography.at, what, effect, fix);
        }
    }

    /// The file of cells' temperatures is there.
    fn temperatures(&mut self) {
        let Simulation { phase, thermal, .. } = self.simulation;
        let glows = phase.bands.iter().any(|band| band.mode != 0);
        let is_used = phase.temperature_mode == 1 && glows && thermal.iter().any(|function| !function.overrides_cells);
        let node = self.inputs.section("Phase").and_then(|section| section.descendant("TemperatureFile"));
        if let Some(node) = node.filter(|_| is_used && phase.cells.is_none()) {
            let what = format!("`{}` is not in the input folder", node.get("temperatureFileName").unwrap_or_default());
            self.error(&node.at_attribute("temperatureFileName"), what, "looks there", "copy the file there");
        }
    }

    /// Facets show their backs.
    fn normals(&mut self, object: &Object, mesh: &Mesh) {
        let is_same = |front: &Option<Links>, back: &Option<Links>| match (front, back) {
            (Some(a), Some(b)) => (a.kind, a.index, a.thermal_index) == (b.kind, b.index, b.thermal_index),
            _ => false,
        };
        // Both sides of what is alike on both may look anywhere.
        let of_object = object.double_face && is_same(&object.links, &object.back);
        let of_group = |g: &super::Group| g.double_face && is_same(&g.links, &g.back);
        if of_object || (!object.groups.is_empty() && object.groups.iter().all(of_group)) {
            return;
        }
        self.turned(object, mesh);
        let (sum, area) = mesh.vector_area_m2();
        let effect = "stops light at the back of a facet: it is black";
        let fix = "turn the order of the corners round, or give both faces properties (`doubleFace`)";
        match mesh.enclosed_m3() {
            Some(volume_m3) if volume_m3 < 0.0 => {
                let what = format!("`{}` is inside out: its facets face inwards", object.name);
                self.error(&object.at, what, effect, fix);
            }
            Some(_) => {}
            // The sum over an open sheet is the way that it faces.
            None if sum.z < -0.2 * area => {
                self.warning(&object.at, format!("`{}` faces downwards", object.name), effect, fix);
            }
            None => {}
        }
    }

    /// Facets turned against their neighbours.
    fn turned(&mut self, object: &Object, mesh: &Mesh) {
        // Corners at one place are one, whatever their number.
        let place = |v: u32| mesh.vertices_m[v as usize].to_array().map(|x| (x + 0.0).to_bits());
        let mut edges: BTreeMap<([u64; 3], [u64; 3]), [u32; 2]> = BTreeMap::new();
        for facet in &mesh.facets {
            let corners = facet.map(place);
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b])) {
                if a != b {
                    edges.entry((a.min(b), a.max(b))).or_default()[usize::from(a > b)] += 1;
                }
            }
        }
        // Two facets at an edge go along it in opposite senses.
        let odd = edges.values().filter(|senses| matches!(senses, [2, 0] | [0, 2])).count();
        if odd > 0 {
            let what = format!(
                "facets of `{}` are turned against those beside them, along {odd} of {} edges",
                object.name,
                edges.len()
            );
            let effect = "sees the backs of some where it sees the fronts of others";
            self.warning(
                &object.at,
                what,
                effect,
                "give the corners of all facets one sense, counter-clockwise from outside",
            );
        }
    }

    fn cameras(&mut self) {
        for camera in &self.simulation.phase.cameras {
            if camera.roll_deg != 0.0 {
                let what = format!("a turn of {} deg about the line of sight", camera.roll_deg);
                let effect = "turns the image, which way is not documented";
                self.warning(&camera.at, what, effect, "turn the scene instead, or look at a first image");
            }
        }
    }
}

/// What DART does with an object that stands on the ground.
const DROPPED: &str = "moves it until its lowest point lies on the ground, which is its default";
const KEEP_Z: &str = "set `objectDEMMode` to 2 to keep its z";

/// What DART does with an object's part beyond the scene's edge.
fn beyond_edge(object: &Object) -> &'static str {
    match object.repeated_on_border {
        true => "lets it come in at the other side (`repeatedOnBorder`)",
        false => "may leave out what is beyond: it is not documented",
    }
}

/// The mesh of an object, without materials: DART takes none from the file. `None` if the file is missing.
fn load(folder: &Folder, object: &Object) -> Result<Option<ObjFile>> {
    let found = folder.locate(&object.file, &object.at).map_err(|problem| Error::Invalid(vec![problem]))?;
    let Some(path) = found else { return Ok(None) };
    let mut file = input::open(&path).map_err(|e| Error::io(&path, "reading", e))?;
    obj::parse(&mut file, &path, &mut |_| Ok(Vec::new())).map(Some)
}
