//! The material dictionary, and which of its entries a mesh's material is.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::number;
use crate::formats::mtl::ObjMaterial;
use crate::geometry::MaterialId;
use crate::physics::reflectance::albedo::Measure;
use crate::physics::reflectance::{PhotometricAngles, Preset, Shape, kirchhoff_emissivity};
use crate::physics::srgb::{hex_from_linear, linear_from_hex};
use crate::scene::{Hapke, Material, Model, Photometry, Rpv, Tabulated, model_problems};
use crate::spectral::{Extend, Spectrum, solar_mean, sunlight_share};

use super::super::located::member;
use super::super::spectrum_csv::Quantity;
use super::super::spelling;
use super::super::{photometry_csv, reflectance_csv};
use super::types::{
    ExtendToml, HapkeToml, MaterialToml, MeasuredAtToml, MeasuredNameToml, MeasuredToml, PresetToml, RpvToml,
};
use super::{ROUNDED, TomlReader};

/// The sum of numbers of three digits may exceed 1 by this much.
const EXCESS: f64 = 2e-3;

/// Bolometric emissivity of a surface that does not state one; Phobos and most powders lie between 0.9 and 1.
pub(in crate::formats) const EMISSIVITY_BOLOMETRIC: f64 = 0.95;
/// Hardly a surface radiates less: polished metals have 0.02.
const LEAST_EMISSIVITY: f64 = 1e-3;
/// Two colours are the same if no channel differs by more: one step of the 8 bits that most programs keep.
const COLOUR_STEP: f64 = 1.0 / 255.0;
/// A table that covers less of sunlight does not determine a Bond albedo; 0.4 to 2.5 um cover 0.89 of it.
const LEAST_SUNLIGHT: f64 = 0.8;
/// A table that reflects more than this of what arrives is reported: albedos of tables are good to a thousandth.
const MOST_REFLECTED: f64 = 1.002;
/// A facet's material is a number of 16 bits.
const MOST_ENTRIES: usize = 1 << 16;
/// Entry for faces without a material.
const UNNAMED: &str = "default";
/// Shares of a mixture add up to 1 to within this.
const SHARE_TOLERANCE: f64 = 1e-9;

/// The dictionary: entries in the order of the file.
pub(super) struct Dictionary {
    pub(super) names: Vec<String>,
    /// The entries; `None` if one of them cannot be used.
    pub(super) materials: Option<Vec<Material>>,
    /// Entries that a mesh uses.
    pub(super) used: BTreeSet<usize>,
    /// The entries each mixture names.
    pub(super) parts: Vec<Vec<usize>>,
}

impl TomlReader<'_> {
    pub(super) fn dictionary(&mut self, entries: &BTreeMap<String, MaterialToml>) -> Dictionary {
        let names = self.document.keys("materials");
        if names.is_empty() {
            self.problem("materials", "no materials: give an entry for each that the meshes have");
        }
        if names.len() > MOST_ENTRIES {
            self.problem("materials", format!("{} materials: at most {MOST_ENTRIES} can be told apart", names.len()));
            return Dictionary { materials: None, used: BTreeSet::new(), parts: vec![Vec::new(); names.len()], names };
        }
        let problems = self.problems.len();
        let mut parts = vec![Vec::new(); names.len()];
        for (name, parts) in names.iter().zip(&mut parts) {
            if let Some(entry) = entries.get(name) {
                *parts = self.parts_of(name, entry, &names);
            }
        }
        let order = parts_first(&parts);
        if order.len() < names.len() {
            // Mixtures that lead into a circle without being in it would be reported too: report only those that reach themselves.
            for i in (0..names.len()).filter(|&i| reaches(&parts, i)) {
                let item = member(&member("materials", &names[i]), "mixture");
                self.problem(&item, format!("{:?} is a mixture of itself", names[i]));
            }
        }
        let mut materials: Vec<Option<Material>> = vec![None; names.len()];
        for i in order {
            if let Some(entry) = entries.get(&names[i]) {
                materials[i] = self.material(i, &names, entry, &materials);
            }
        }
        let is_good = self.problems.len() == problems;
        let materials = materials.into_iter().collect::<Option<Vec<_>>>().filter(|_| is_good);
        Dictionary { names, materials, used: BTreeSet::new(), parts }
    }

    /// Checks what an entry says of itself; the entries that it is a mixture of.
    fn parts_of(&mut self, name: &str, entry: &MaterialToml, names: &[String]) -> Vec<usize> {
        let item = member("materials", name);
        if name.starts_with('#') && linear_from_hex(name).is_none() {
            let message = format!("{name:?} is not a colour");
            self.helped(&item, message, "a colour is # and six hexadecimal digits, sRGB");
        }
        let (reflectance, mixture) = (entry.reflectance.is_some(), entry.mixture.is_some());
        // A preset and a table have reflectances of their own.
        if reflectance == mixture && (reflectance || (entry.preset.is_none() && entry.table.is_none())) {
            self.problem(&item, "give either `reflectance` or `mixture`");
        }
        let models = entry.models();
        if let [first, second, ..] = models[..] {
            self.problem(&item, format!("give either `{first}` or `{second}`: a surface has one model"));
        }
        let preset = entry.preset.map(PresetToml::preset);
        if let (Some(preset), None) = (preset, &entry.mixture) {
            self.model_of_preset(&item, entry, preset, &models);
        }
        if let (Some(_), Some(_), None) = (&entry.measured, &entry.table, &entry.reflectance) {
            let message = "says nothing without a `reflectance`: the table's factors are as they stand";
            self.problem(&member(&item, "measured"), message);
        }
        let is_lambert = models.is_empty() && preset.is_none_or(|preset| preset.known().shape.is_none());
        let Some(mixture) = &entry.mixture else {
            if entry.measured.is_some() && is_lambert {
                let message =
                    "says nothing of a Lambert surface, which has one reflectance: leave it out, or give a model";
                self.problem(&member(&item, "measured"), message);
            }
            return vec![];
        };
        let more = [("measured", entry.measured.is_some()), ("preset", preset.is_some())];
        let more = more.iter().filter(|(_, is_given)| *is_given).map(|(key, _)| key);
        for key in models.iter().chain(more) {
            self.problem(&member(&item, key), "a mixture has no parameters of its own: they are those of its parts");
        }
        // From 0.0: the sum of nothing is -0.
        let sum = mixture.values().fold(0.0, |sum, share| sum + share);
        let is_percent = (sum - 100.0).abs() < 1e-6;
        let mut parts = Vec::new();
        for (part, share) in mixture {
            let at = member(&member(&item, "mixture"), part);
            match names.iter().position(|n| n == part) {
                Some(part) => parts.push(part),
                None => self.helped(&at, format!("no material {part:?} in the dictionary"), help_for(part, names)),
            }
            if !(0.0..=1.0).contains(share) {
                let problem = self.problem(&at, format!("{} is outside 0 to 1", number(*share)));
                problem.help = is_percent.then(|| format!("if this is percent, write {}", number(share / 100.0)));
            }
        }
        let off = (sum - 1.0).abs();
        if off > SHARE_TOLERANCE && off <= ROUNDED {
            let at = member(&item, "mixture");
            self.notes.push(format!("{at}: rounded shares, which add up to {sum}: they are divided by that"));
        } else if !(0.0..=SHARE_TOLERANCE).contains(&off) {
            let problem = self.problem(&member(&item, "mixture"), format!("shares add up to {sum}, not 1"));
            problem.help = match sum {
                _ if is_percent => Some("shares are fractions, not percent".into()),
                _ if sum > 0.0 => Some(format!("divide each by {}", number(sum))),
                _ => None,
            };
        }
        if entry.extend.is_some() && entry.emissivity.is_none() {
            self.problem(&member(&item, "extend"), "a mixture has no table of its own: set this for its parts");
        }
        parts
    }

    /// Says what of an entry does not fit its preset.
    fn model_of_preset(&mut self, item: &str, entry: &MaterialToml, preset: Preset, models: &[&str]) {
        let own = preset.known().shape.map(|shape| shape.key());
        for key in models.iter().filter(|key| Some(**key) != own) {
            let its = own.map_or("Lambert's surface".to_owned(), |own| format!("a `{own}` surface"));
            self.problem(&member(item, key), format!("the preset `{}` is {its}, not a `{key}` one", preset.name()));
        }
        if own == Some("hapke") && entry.hapke.as_ref().and_then(HapkeToml::file).is_some() {
            let message =
                "a table has all numbers, so that none is the preset's: leave out `preset`, or give single numbers";
            self.problem(&member(item, "hapke"), message);
        }
        if entry.measured.is_some() && own.is_some() && entry.reflectance.is_none() {
            let message = "says nothing without a `reflectance`: the albedo is the preset's own";
            self.problem(&member(item, "measured"), message);
        }
    }

    /// The albedo of a preset, where no reflectance is given.
    fn albedo_of_preset(&mut self, item: &str, preset: Preset) -> Spectrum {
        let known = preset.known();
        let at =
            known.wavelength_um.map_or(String::new(), |um| format!(", known at {um} um and taken for all wavelengths"));
        let what = if known.shape.is_some() { "the albedo" } else { "the reflectance" };
        let value = known.albedo.value;
        self.stated(&member(item, "reflectance"), format!("{value}: {what} of the preset `{}`{at}", preset.name()));
        Spectrum::constant(value)
    }

    fn material(
        &mut self,
        i: usize,
        names: &[String],
        entry: &MaterialToml,
        known: &[Option<Material>],
    ) -> Option<Material> {
        let item = member("materials", &names[i]);
        let extend = match entry.extend {
            Some(ExtendToml::Hold) => Extend::Hold,
            Some(ExtendToml::Error) | None => Extend::Error,
        };
        // Shares may be rounded.
        let sum = entry.mixture.iter().flatten().fold(0.0, |sum, (_, share)| sum + share);
        let whole = if (sum - 1.0).abs() > SHARE_TOLERANCE { sum } else { 1.0 };
        // The parts with their shares; none for an entry with a reflectance of its own.
        let mixed: Vec<(f64, &Material)> = entry
            .mixture
            .iter()
            .flatten()
            .map(|(part, share)| {
                let part = names.iter().position(|n| n == part)?;
                Some((*share / whole, known[part].as_ref()?))
            })
            .collect::<Option<_>>()?;
        let reflectance = match &entry.reflectance {
            Some(values) => {
                self.fraction_spectrum(&member(&item, "reflectance"), values, Quantity::Reflectance, extend)
            }
            None if let (Some(preset), []) = (entry.preset, &mixed[..]) => {
                Some(self.albedo_of_preset(&item, preset.preset()))
            }
            // Its table has one.
            None if entry.table.is_some() && mixed.is_empty() => None,
            None => {
                let parts: Vec<(f64, &Spectrum)> = mixed.iter().map(|(share, m)| (*share, &m.reflectance)).collect();
                let mixture = Spectrum::mixture(&parts);
                if mixture.is_none() && !mixed.is_empty() {
                    self.problem(&member(&item, "mixture"), "its parts' tables have no wavelength in common");
                }
                mixture
            }
        };
        let photometry = self.photometry(&item, entry, reflectance.as_ref(), extend);
        let reflectance = match &photometry {
            Some(Photometry::Model(model)) => Some(model.hemispherical()),
            Some(Photometry::Table(table)) => table.hemispherical(),
            _ => reflectance,
        };
        let emissivity = match &entry.emissivity {
            Some(values) => self.fraction_spectrum(&member(&item, "emissivity"), values, Quantity::Emissivity, extend),
            None if mixed.is_empty() => {
                self.stated(&member(&item, "emissivity"), "1 - reflectance");
                reflectance.as_ref().map(|r| r.map(kirchhoff_emissivity))
            }
            None => reflectance.as_ref().and_then(|reflectance| {
                let at = member(&item, "emissivity");
                let is_kirchhoff = mixed.iter().all(|(_, part)| part.has_kirchhoff_emissivity());
                let said = if is_kirchhoff { "1 - reflectance" } else { "that of its parts, by their shares" };
                let emissivity = mixed_emissivity(&mixed, reflectance);
                match emissivity {
                    Some(_) => self.stated(&at, said),
                    None => _ = self.problem(&at, "its parts' tables have no wavelength in common: give it"),
                }
                emissivity
            }),
        };
        if let (Some(reflectance), Some(emissivity), Some(_)) = (&reflectance, &emissivity, &entry.emissivity) {
            self.note_excess(&item, reflectance, emissivity);
        }
        if mixed.iter().any(|(_, part)| part.photometry != Photometry::Lambert) {
            self.problem(&member(&item, "mixture"), "has a part with a model: only Lambert surfaces are mixed");
        }
        if entry.temperature_k.is_none() && mixed.iter().any(|(_, part)| part.temperature_k.is_some()) {
            self.note(&member(&item, "mixture"), "has a part that is held at a temperature; the mixture is not");
        }
        let at = member(&item, "bond_albedo");
        let bond_albedo = self.bond_albedo(&at, entry.bond_albedo, &mixed, reflectance.as_ref());
        let at = member(&item, "emissivity_bolometric");
        let emissivity_bolometric = self.emissivity_bolometric(&at, entry.emissivity_bolometric, &mixed);
        Some(Material {
            name: names[i].clone(),
            reflectance: reflectance?,
            photometry: photometry?,
            emissivity: emissivity?,
            bond_albedo: bond_albedo?,
            emissivity_bolometric: emissivity_bolometric?,
            // That of the whole scene, if it has none of its own, comes later.
            thermal_inertia: 0.0,
            temperature_k: entry.temperature_k,
            mixture: if mixed.is_empty() { vec![(i, 1.0)] } else { shares(&mixed) },
        })
    }

    /// Says if an opaque surface reflects and emits more than there is.
    fn note_excess(&mut self, item: &str, reflectance: &Spectrum, emissivity: &Spectrum) {
        let um = reflectance.wavelength_um().iter().chain(emissivity.wavelength_um());
        let sums = um.filter_map(|&um| Some((reflectance.at(um)? + emissivity.at(um)?, um)));
        let (most, um) = sums.fold((0.0, 0.0), |most, sum| if sum.0 > most.0 { sum } else { most });
        // Tables are rounded to a few digits.
        if most > 1.0 + EXCESS {
            let is_table = reflectance.wavelength_um().len() + emissivity.wavelength_um().len() > 2;
            let place = if is_table { format!(" at {um} um") } else { String::new() };
            self.notes.push(format!(
                "{item}: reflectance and emissivity add up to {most:.3}{place}: an opaque surface has 1 at most (Kirchhoff)"
            ));
        }
    }

    fn photometry(
        &mut self,
        item: &str,
        entry: &MaterialToml,
        reflectance: Option<&Spectrum>,
        extend: Extend,
    ) -> Option<Photometry> {
        let tables = [&entry.hapke.as_ref().and_then(HapkeToml::file), &entry.rpv.as_ref().and_then(RpvToml::file)];
        if let (Some(_), Some(_)) = (&entry.measured, tables.into_iter().flatten().next()) {
            self.problem(&member(item, "measured"), "says nothing of a model by a table, which has its own albedo");
        }
        if let Some(name) = &entry.table {
            return self.table(item, name, entry, reflectance, extend).map(|table| Photometry::Table(Box::new(table)));
        }
        match tables {
            [Some(name), _] => {
                let columns = self.parameters(&member(item, "hapke"), name, Hapke::NAMES, extend)?;
                Some(Photometry::Hapke(Box::new(columns.into())))
            }
            [_, Some(name)] => {
                let columns = self.parameters(&member(item, "rpv"), name, Rpv::NAMES, extend)?;
                Some(Photometry::Rpv(Box::new(columns.into())))
            }
            _ => {
                let base = entry.preset.and_then(|preset| preset.preset().known().shape);
                for key in entry.missing(base.as_ref()) {
                    let at = key.split('.').fold(member(item, "hapke"), |at, name| member(&at, name));
                    self.problem(&at, "is not given, and there is no preset that has it");
                }
                match entry.shape(base.as_ref()) {
                    None => Some(Photometry::Lambert),
                    Some((key, shape)) => self.model(item, key, shape, entry, reflectance),
                }
            }
        }
    }

    /// Reflectance factors as they were measured, at the level that a reflectance has.
    fn table(
        &mut self,
        item: &str,
        name: &str,
        entry: &MaterialToml,
        reflectance: Option<&Spectrum>,
        extend: Extend,
    ) -> Option<Tabulated> {
        let at = member(item, "table");
        let read = reflectance_csv::read(&self.path(name), extend);
        let (table, input) = self.taken(&at, read)?;
        if !self.inputs.contains(&input) {
            self.inputs.push(input);
        }
        let table = match (reflectance, &entry.reflectance) {
            (None, None) => table,
            (None, Some(_)) => return None,
            (Some(reflectance), _) => match self.measure(item, entry)? {
                None => table.times(reflectance.clone()),
                Some(measure) => {
                    let found = table.measured(reflectance, &measure);
                    if found.is_none() {
                        let message =
                            "cannot set the level of the table: that is black there, or known at other wavelengths";
                        self.problem(&member(item, "reflectance"), message);
                    }
                    found?
                }
            },
        };
        if table.hemispherical().is_none() {
            self.problem(&at, "is known at no wavelength at which the reflectance is");
        }
        let (share, angle_rad, um) = table.brightest();
        if share > MOST_REFLECTED {
            let place = if table.tables().len() > 1 { format!(" at {um} um") } else { String::new() };
            self.note(
                &at,
                format!(
                    "reflects {share:.3} of the light from {:.1} deg{place}: more than arrives",
                    angle_rad.to_degrees()
                ),
            );
        }
        if !table.is_reciprocal() {
            self.note(&at, "light and view may not change places in it, so its emissivity is taken to be the same in all directions");
        }
        Some(table)
    }

    /// How the reflectance was measured: `None` within if it is the model's own albedo.
    fn measure(&mut self, item: &str, entry: &MaterialToml) -> Option<Option<Measure>> {
        let at = member(item, "measured");
        match &entry.measured {
            // The albedo of a preset is one.
            None if entry.reflectance.is_none() => Some(None),
            None => {
                self.stated(&at, "hemispherical");
                Some(Some(Measure::Spherical))
            }
            Some(MeasuredToml::Named(MeasuredNameToml::Hemispherical)) => Some(Some(Measure::Spherical)),
            Some(MeasuredToml::Named(MeasuredNameToml::Normal)) => {
                Some(Some(Measure::ReflectanceFactor(PhotometricAngles::ZENITH)))
            }
            Some(MeasuredToml::Named(MeasuredNameToml::Albedo)) => Some(None),
            Some(MeasuredToml::At(angles)) => self.measured_at(&at, angles).map(Some),
        }
    }

    /// A model by numbers, whose albedo gives the reflectance that was measured.
    fn model(
        &mut self,
        item: &str,
        key: &str,
        shape: Shape,
        entry: &MaterialToml,
        reflectance: Option<&Spectrum>,
    ) -> Option<Photometry> {
        let wrong = model_problems(&shape);
        for (parameter, message) in &wrong {
            let at = parameter.split('.').fold(member(item, key), |at, name| member(&at, name));
            self.problem(&at, message);
        }
        let measure = self.measure(item, entry);
        let (measure, reflectance) = (measure?, reflectance.filter(|_| wrong.is_empty())?);
        let model = match measure {
            Some(measure) => Model::measured(shape, reflectance, &measure),
            None => Ok(Model { shape, albedo: reflectance.clone(), preset: None }),
        };
        let preset = entry.preset.map(PresetToml::preset);
        match model {
            Ok(model) => Some(Photometry::Model(Box::new(Model { preset, ..model }))),
            Err(error) => {
                self.problem(&member(item, "reflectance"), error.to_string());
                None
            }
        }
    }

    fn measured_at(&mut self, item: &str, angles: &MeasuredAtToml) -> Option<Measure> {
        let MeasuredAtToml { incidence_deg, emission_deg, phase_deg } = *angles;
        let problems = self.problems.len();
        for (key, angle_deg) in [("incidence_deg", incidence_deg), ("emission_deg", emission_deg)] {
            if !(0.0..90.0).contains(&angle_deg) {
                self.problem(&member(item, key), format!("{} is outside 0 to below 90", number(angle_deg)));
            }
        }
        let [least, most] = [(incidence_deg - emission_deg).abs(), incidence_deg + emission_deg];
        if !(least..=most).contains(&phase_deg) && self.problems.len() == problems {
            let [least, most] = [least, most].map(number);
            let message = format!("{} is impossible at these angles, which leave {least} to {most}", number(phase_deg));
            self.problem(&member(item, "phase_deg"), message);
        }
        let [incidence, emission, phase] = [incidence_deg, emission_deg, phase_deg].map(|deg| deg.to_radians().cos());
        let measure = Measure::ReflectanceFactor(PhotometricAngles::of_cosines(incidence, emission, phase));
        (self.problems.len() == problems).then_some(measure)
    }

    fn parameters<const N: usize>(
        &mut self,
        item: &str,
        name: &str,
        names: [&str; N],
        extend: Extend,
    ) -> Option<[Spectrum; N]> {
        let read = photometry_csv::read(&self.path(name), names, extend);
        let (columns, input) = self.taken(item, read)?;
        if !self.inputs.contains(&input) {
            self.inputs.push(input);
        }
        Some(columns)
    }

    fn bond_albedo(
        &mut self,
        item: &str,
        given: Option<f64>,
        mixed: &[(f64, &Material)],
        reflectance: Option<&Spectrum>,
    ) -> Option<f64> {
        if let Some(value) = given {
            return self.fraction(item, value);
        }
        if !mixed.is_empty() {
            let value = mean(mixed, |m| m.bond_albedo);
            self.stated(item, format!("{value:.4}: that of its parts, by their shares"));
            return Some(value);
        }
        let reflectance = reflectance?;
        let value = solar_mean(reflectance);
        match value {
            Some(value) => {
                self.stated(item, format!("{value:.4}: mean of the reflectance, weighted with E490"));
                let (first, last) = reflectance.coverage_um();
                let share = sunlight_share(first, last);
                if share < LEAST_SUNLIGHT {
                    self.notes.push(format!(
                        "{item}: {value:.4} is the mean over {:.1} % of sunlight only, which the table of the reflectance covers ({} to {} um): \
                         temperatures follow from it; give `bond_albedo`, or a table of all sunlight",
                        100.0 * share,
                        number(first),
                        number(last)
                    ));
                }
            }
            None => {
                let doubt = self.doubt(&item.replace(".bond_albedo", ".reflectance"));
                self.problem(item, "cannot be found from the reflectance, which E490 does not overlap: give it").help =
                    doubt;
            }
        }
        value
    }

    fn emissivity_bolometric(&mut self, item: &str, given: Option<f64>, mixed: &[(f64, &Material)]) -> Option<f64> {
        match given {
            Some(value) if value <= 0.0 => {
                self.problem(item, format!("{}: nothing would cool the surface: give more than 0", number(value)));
                None
            }
            Some(value) if (0.0..LEAST_EMISSIVITY).contains(&value) => {
                self.note(item, format!("{}: next to nothing cools the surface", number(value)));
                Some(value)
            }
            Some(value) => self.fraction(item, value),
            None if !mixed.is_empty() => {
                let value = mean(mixed, |m| m.emissivity_bolometric);
                self.stated(item, format!("{value}: that of its parts, by their shares"));
                Some(value)
            }
            None => Some(self.default(item, EMISSIVITY_BOLOMETRIC)),
        }
    }

    /// The dictionary's entry of a name that `item` gives.
    pub(super) fn entry_named(&mut self, item: &str, name: &str, dictionary: &mut Dictionary) -> Option<MaterialId> {
        let Some(entry) = dictionary.names.iter().position(|n| n == name) else {
            self.helped(item, format!("no material {name:?} in the dictionary"), help_for(name, &dictionary.names));
            return None;
        };
        dictionary.used.insert(entry);
        u16::try_from(entry).ok().map(MaterialId)
    }

    /// The dictionary's entry for a mesh's material, by name or colour; `item` is the mesh.
    pub(super) fn entry_of(
        &mut self,
        item: &str,
        material: &ObjMaterial,
        dictionary: &mut Dictionary,
    ) -> Option<MaterialId> {
        let matches = |key: &str| {
            let same = |(a, b): (f64, f64)| (a - b).abs() <= COLOUR_STEP;
            let name = if material.name.is_empty() { UNNAMED } else { &material.name };
            key == name
                || material.kd.zip(linear_from_hex(key)).is_some_and(|(kd, rgb)| kd.into_iter().zip(rgb).all(same))
        };
        let found: Vec<usize> = (0..dictionary.names.len()).filter(|&i| matches(&dictionary.names[i])).collect();
        if dictionary.names.is_empty() {
            return None;
        }
        if let [entry] = found[..] {
            dictionary.used.insert(entry);
            return u16::try_from(entry).ok().map(MaterialId);
        }
        let colour = material.kd.map_or("without a colour".into(), |kd| format!("colour {}", hex_from_linear(kd)));
        let (problem, help) = match found.len() {
            0 if material.name.is_empty() => {
                let entries = quoted(&dictionary.names);
                let help =
                    format!("add an entry `{UNNAMED}`, or give the mesh `material = ...`; entries are {entries}");
                ("is not in the dictionary", help)
            }
            0 => ("is not in the dictionary", format!("entries are {}", quoted(&dictionary.names))),
            _ => {
                let several: Vec<String> = found.iter().map(|&i| dictionary.names[i].clone()).collect();
                ("fits several entries", format!("they are {}: keep one, or use names for keys", quoted(&several)))
            }
        };
        let name = match material.name.as_str() {
            "" => "material \"\" of the mesh (faces before the first `usemtl`)".into(),
            name => format!("material {name:?} of the mesh"),
        };
        self.helped(item, format!("{name}, {colour}, {problem}"), help);
        None
    }

    pub(super) fn note_unused(&mut self, dictionary: &Dictionary) {
        let mut used = dictionary.used.clone();
        let mut open: Vec<usize> = used.iter().copied().collect();
        while let Some(i) = open.pop() {
            open.extend(dictionary.parts[i].iter().filter(|p| used.insert(**p)));
        }
        for i in (0..dictionary.names.len()).filter(|i| !used.contains(i)) {
            self.notes.push(format!("{}: no mesh uses this material", member("materials", &dictionary.names[i])));
        }
    }
}

/// The emissivity of a mixture with a reflectance: that of its parts, by their shares; `None` if it is known nowhere.
pub(super) fn mixed_emissivity(mixed: &[(f64, &Material)], reflectance: &Spectrum) -> Option<Spectrum> {
    // The same except for rounding, which is not worth reporting.
    if mixed.iter().all(|(_, part)| part.has_kirchhoff_emissivity()) {
        return Some(reflectance.map(kirchhoff_emissivity));
    }
    let parts: Vec<(f64, &Spectrum)> = mixed.iter().map(|(share, part)| (*share, &part.emissivity)).collect();
    Some(Spectrum::mixture(&parts)?.map(|emissivity| emissivity.min(1.0)))
}

/// The mean over a mixture's parts, by their shares.
pub(super) fn mean(mixed: &[(f64, &Material)], of: fn(&Material) -> f64) -> f64 {
    mixed.iter().map(|(share, material)| share * of(material)).sum()
}

/// The shares of the dictionary's entries in a mixture, whose parts may be mixtures.
fn shares(mixed: &[(f64, &Material)]) -> Vec<(usize, f64)> {
    let mut shares: BTreeMap<usize, f64> = BTreeMap::new();
    for (share, part) in mixed {
        for (base, fraction) in &part.mixture {
            *shares.entry(*base).or_default() += share * fraction;
        }
    }
    shares.into_iter().collect()
}

/// Entries in an order in which parts come before mixtures of them, without those that need a mixture of itself.
fn parts_first(parts: &[Vec<usize>]) -> Vec<usize> {
    let mut order = Vec::new();
    let mut is_ready = vec![false; parts.len()];
    loop {
        let before = order.len();
        for i in 0..parts.len() {
            if !is_ready[i] && parts[i].iter().all(|p| is_ready[*p]) {
                is_ready[i] = true;
                order.push(i);
            }
        }
        if order.len() == before {
            return order;
        }
    }
}

/// What may have been meant by a name that is not an entry.
fn help_for(name: &str, entries: &[String]) -> String {
    let known: Vec<&str> = entries.iter().map(String::as_str).collect();
    match spelling::nearest(name, &known) {
        Some(near) => format!("did you mean {near:?}?"),
        None => format!("entries are {}", quoted(entries)),
    }
}

/// The first names of a list that may be long.
fn quoted(names: &[String]) -> String {
    const TOLD: usize = 20;
    let more = if names.len() > TOLD { ", ..." } else { "" };
    names.iter().take(TOLD).map(|n| format!("{n:?}")).collect::<Vec<_>>().join(", ") + more
}

/// Whether following a mixture's parts leads back to it.
fn reaches(parts: &[Vec<usize>], start: usize) -> bool {
    let mut seen = BTreeSet::new();
    let mut open = parts[start].clone();
    while let Some(i) = open.pop() {
        if i == start {
            return true;
        }
        if seen.insert(i) {
            open.extend(&parts[i]);
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_are_found() {
        let parts = [vec![1], vec![2], vec![1], vec![]];
        assert_eq!([0, 1, 2, 3].map(|i| reaches(&parts, i)), [false, true, true, false]);
        assert_eq!(parts_first(&parts), [3]);
        assert_eq!(parts_first(&[vec![1], vec![2], vec![]]), [2, 1, 0]);
    }
}
