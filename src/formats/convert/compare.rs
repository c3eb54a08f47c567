//! What two contents differ in, by meaning: not by the order of facets or materials, nor by how a spectrum is tabulated.
//!
//! Every struct is taken apart with all its fields named: one that is new does not compile before it is compared here.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;

use glam::DVec3;

use crate::flight::{Orientation, Span, Trajectory};
use crate::formats::dart::{Pinhole, Step};
use crate::formats::flight_file::FlightFile;
use crate::formats::mesh_file::ColouredMesh;
use crate::formats::mtl::ObjMaterial;
use crate::geometry::{BrownConrady, FrameCamera, Lens, MaterialId, Mesh, Pose};
use crate::scene::{
    Beam, Exposure, Fixed, Globe, Hapke, Material, Model, Models, Photometry, Rotation, Rpv, Scene, Setup, Sky, Sun,
    Surface, Texture,
};
use crate::spectral::{Band, Column, Extend, SpectralLibrary, Spectrum};

use super::Content;
use super::dart::Flown;

/// Positions are the same within this, m, or within rounding of far ones.
const POSITION_M: f64 = 1e-9;
/// Numbers of spectra and parts of directions are the same within this, or this share of them.
const SHARE: f64 = 1e-12;
/// Colours are the same within the digits of an f32, in which some formats have them.
const COLOUR: f64 = 1e-6;
/// At most this many facets, materials or tables are reported one by one.
const TOLD: usize = 10;

/// One line for each difference: where, and both values. Empty: the same in meaning.
pub fn differences(a: &Content, b: &Content) -> Vec<String> {
    let mut lines = Lines(Vec::new());
    if let (Some((a, flights_a)), Some((b, flights_b))) = (scene(a), scene(b)) {
        lines.scenes(a, b);
        lines.flights(flights_a, flights_b);
        return lines.0;
    }
    match (a, b) {
        (Content::Mesh(a), Content::Mesh(b)) => lines.coloured_meshes(a, b),
        // One spectrum's name is its file's.
        (Content::Spectra(a), Content::Spectra(b)) if a.len() == 1 && b.len() == 1 => {
            lines.libraries("spectra", &a[0], &b[0]);
        }
        (Content::Spectra(a), Content::Spectra(b)) => {
            let names = |l: &[SpectralLibrary]| l.iter().map(|l| l.name.clone()).collect::<Vec<_>>();
            lines.each("spectra", &names(a), &names(b), |lines, at, i, j| lines.libraries(at, &a[i], &b[j]));
        }
        (Content::Flight(a), Content::Flight(b)) => lines.flight_files(a, b),
        _ => lines.0.push(format!("the first holds {}, the second {}: convert one of them", a.kind(), b.kind())),
    }
    lines.0
}

/// A scene, one that moves too, and what flies over it.
fn scene(content: &Content) -> Option<(&Scene, &[Flown])> {
    match content {
        Content::Scene(scene, flights) => Some((scene, flights)),
        Content::Moving(moving) => Some((&moving.0, &[])),
        _ => None,
    }
}

struct Lines(Vec<String>);

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SHARE * a.abs().max(b.abs())
}

fn near(a: DVec3, b: DVec3) -> bool {
    // A few ulp of positions that are far from the body's centre.
    (a - b).abs().max_element() <= POSITION_M.max(8.0 * f64::EPSILON * a.abs().max_element())
}

impl Lines {
    fn push(&mut self, at: &str, a: impl std::fmt::Display, b: impl std::fmt::Display) {
        self.0.push(format!("{at}: {a}, {b}"));
    }

    fn numbers(&mut self, at: &str, a: f64, b: f64) {
        if !same(a, b) {
            self.push(at, a, b);
        }
    }

    fn words(&mut self, at: &str, a: &str, b: &str) {
        if a != b {
            self.push(at, format!("{a:?}"), format!("{b:?}"));
        }
    }

    fn places(&mut self, at: &str, a: DVec3, b: DVec3) {
        if !near(a, b) {
            self.push(at, a, b);
        }
    }

    fn directions(&mut self, at: &str, a: DVec3, b: DVec3) {
        if (a - b).abs().max_element() > SHARE {
            self.push(at, a, b);
        }
    }

    fn debugged<T: Debug + PartialEq>(&mut self, at: &str, a: &T, b: &T) {
        if a != b {
            self.push(at, format!("{a:?}"), format!("{b:?}"));
        }
    }

    fn lists(&mut self, at: &str, a: &[f64], b: &[f64]) {
        if a.len() != b.len() || !a.iter().zip(b).all(|(a, b)| same(*a, *b)) {
            self.push(at, format!("{a:?}"), format!("{b:?}"));
        }
    }

    /// Compares what has the same name, the second of a name with the second, and reports what has no counterpart.
    fn each(&mut self, at: &str, a: &[String], b: &[String], mut compare: impl FnMut(&mut Self, &str, usize, usize)) {
        let known = self.0.len();
        let mut is_met = vec![false; b.len()];
        for (i, name) in a.iter().enumerate() {
            match (0..b.len()).find(|&j| !is_met[j] && b[j] == *name) {
                Some(j) => {
                    is_met[j] = true;
                    compare(self, &format!("{at}.{name:?}"), i, j);
                }
                None => self.push(&format!("{at}.{name:?}"), "is there", "is not"),
            }
        }
        let others = b.iter().zip(is_met).filter(|(_, is_met)| !is_met);
        others.for_each(|(name, _)| self.push(&format!("{at}.{name:?}"), "is not", "is there"));
        if self.0.len() > known + TOLD {
            let more = self.0.len() - known - TOLD;
            self.0.truncate(known + TOLD);
            self.0.push(format!("{at}: {more} more differences"));
        }
    }

    fn spectra(&mut self, at: &str, a: &Spectrum, b: &Spectrum) {
        let all = a.wavelength_um().iter().chain(b.wavelength_um()).copied();
        let differs = |um: &f64| match (a.at(*um), b.at(*um)) {
            (Some(a), Some(b)) => !same(a, b),
            (a, b) => a.is_some() != b.is_some(),
        };
        let shown = |value: Option<f64>| value.map_or("unknown".into(), |v| v.to_string());
        if let Some(um) = all.clone().find(differs) {
            let count = all.filter(differs).count();
            self.push(&format!("{at} at {um} um (of {count})"), shown(a.at(um)), shown(b.at(um)));
        } else if a.extend() != b.extend() {
            self.push(&format!("{at} beyond its ends"), format!("{:?}", a.extend()), format!("{:?}", b.extend()));
        }
    }

    fn libraries(&mut self, at: &str, a: &SpectralLibrary, b: &SpectralLibrary) {
        // Names were compared; a comment means nothing; wavelengths go with each column.
        let SpectralLibrary { name: _, comment: _, wavelength_um: _, columns } = a;
        let names = |columns: &[Column]| columns.iter().map(|c| c.name.to_lowercase()).collect::<Vec<_>>();
        self.each(at, &names(columns), &names(&b.columns), |lines, at, i, j| {
            let spectrum = |l: &SpectralLibrary, column: &Column| {
                let Column { name: _, values } = column;
                Spectrum::new(l.wavelength_um.clone(), values.clone(), Extend::Error)
            };
            match spectrum(a, &columns[i]).zip(spectrum(b, &b.columns[j])) {
                Some((a, b)) => lines.spectra(at, &a, &b),
                None => lines.push(at, "is not a table", "or the other is none"),
            }
        });
    }

    fn coloured_meshes(&mut self, a: &ColouredMesh, b: &ColouredMesh) {
        let ColouredMesh { mesh, materials, origin_m, sun } = a;
        self.places("origin_m", origin_m.unwrap_or_default(), b.origin_m.unwrap_or_default());
        if *sun != b.sun {
            self.push("sun.direction", format!("{sun:?}"), format!("{:?}", b.sun));
        }
        let names = |m: &[ObjMaterial]| m.iter().map(|m| m.name.clone()).collect::<Vec<_>>();
        let (names_a, names_b) = (names(materials), names(&b.materials));
        self.meshes((mesh, &names_a), (&b.mesh, &names_b));
        // Names of materials that no facet has say nothing, nor their order.
        for (i, material) in materials.iter().enumerate() {
            let ObjMaterial { name, kd } = material;
            let Some(other) = b.materials.iter().filter(|m| m.name == *name).nth(nth(&names_a, i)) else { continue };
            let off = match (kd, other.kd) {
                (Some(a), Some(b)) => a.iter().zip(b).any(|(a, b)| (a - b).abs() > COLOUR),
                (a, b) => a.is_some() != b.is_some(),
            };
            if off {
                self.push(&format!("materials.{name:?} colour"), format!("{kd:?}"), format!("{:?}", other.kd));
            }
        }
    }

    fn scenes(&mut self, a: &Scene, b: &Scene) {
        let Setup {
            body,
            sky: Sky { sun, mars, bodies, beams, rotation, past },
            exposure,
            models:
                Models {
                    thermal,
                    mars_light,
                    sun: sun_model,
                    eclipses,
                    mars_shadows,
                    mars_heat,
                    conduction,
                    exchange,
                    floor_k,
                    bodies: _,
                    fixed: _,
                },
        } = &**a;
        let Surface { origin_m, mesh, materials, textures } = &**body;
        self.places("origin_m", *origin_m, b.body.origin_m);
        let names = |scene: &Scene| scene.body.materials.iter().map(|m| m.name.clone()).collect::<Vec<_>>();
        let (names_a, names_b) = (names(a), names(b));
        let pairs = self.meshes((mesh, &names_a), (&b.body.mesh, &names_b));
        self.each("materials", &names_a, &names_b, |lines, at, i, j| {
            lines.materials(at, (&materials[i], materials), (&b.body.materials[j], &b.body.materials));
        });
        let of = |textures: &[Texture], names: &[String]| {
            textures
                .iter()
                .map(|t| names.get(usize::from(t.material.0)).cloned().unwrap_or_default())
                .collect::<Vec<_>>()
        };
        self.each("textures", &of(textures, &names_a), &of(&b.body.textures, &names_b), |lines, at, i, j| {
            lines.textures(at, (&textures[i], mesh), (&b.body.textures[j], &b.body.mesh), &pairs);
        });
        self.suns(sun, &b.sky.sun);
        match (mars, &b.sky.mars) {
            (Some(mars), Some(other)) => {
                self.globes("mars", mars, other);
                self.debugged("mars.model", mars_light, &b.models.mars_light);
            }
            (None, None) => {}
            (a, _) => self.push("mars", if a.is_some() { "is there" } else { "is not" }, "the other way round"),
        }
        let names = |bodies: &[Globe]| bodies.iter().map(|body| body.name.clone()).collect::<Vec<_>>();
        self.each("bodies", &names(bodies), &names(&b.sky.bodies), |lines, at, i, j| {
            lines.globes(at, &bodies[i], &b.sky.bodies[j]);
        });
        let names = |beams: &[Beam]| beams.iter().map(|beam| beam.name.clone()).collect::<Vec<_>>();
        self.each("beams", &names(beams), &names(&b.sky.beams), |lines, at, i, j| {
            let (Beam { name: _, direction, irradiance, total_irradiance_w_m2 }, b) = (&beams[i], &b.sky.beams[j]);
            lines.directions(&format!("{at}.direction"), direction.vec(), b.direction.vec());
            lines.spectra(&format!("{at}.irradiance"), irradiance, &b.irradiance);
            lines.numbers(&format!("{at}.total_irradiance_w_m2"), *total_irradiance_w_m2, b.total_irradiance_w_m2);
        });
        self.debugged("thermal.model", thermal, &b.models.thermal);
        self.debugged("thermal.steps", conduction, &b.models.conduction);
        self.numbers("thermal.floor_k", *floor_k, b.models.floor_k);
        match (rotation, &b.sky.rotation) {
            (Some(Rotation { axis, period_s }), Some(other)) => {
                self.directions("thermal.axis", axis.vec(), other.axis.vec());
                self.numbers("thermal.period_s", *period_s, other.period_s);
            }
            (None, None) => {}
            (a, _) => {
                self.push("thermal.period_s", if a.is_some() { "is there" } else { "is not" }, "the other way round")
            }
        }
        if past.is_some() != b.sky.past.is_some() {
            let known = if past.is_some() { "is known" } else { "is not known" };
            self.push("the day before", known, "the other way round");
        }
        self.debugged("sun.points", sun_model, &b.models.sun);
        self.debugged("mars.eclipse", eclipses, &b.models.eclipses);
        self.debugged("mars.points", mars_shadows, &b.models.mars_shadows);
        self.debugged("mars.heat", mars_heat, &b.models.mars_heat);
        self.stated(&a.models.to_state(), &b.models.to_state());
        self.debugged("light between facets", exchange, &b.models.exchange);
        self.exposures(exposure, &b.exposure);
    }

    /// What one of them leaves to a plan.
    fn stated(&mut self, a: &Fixed, b: &Fixed) {
        for ((key, a), (_, b)) in a.by_key().into_iter().zip(b.by_key()) {
            let said = |is: bool| if is { "is stated" } else { "is left to the plan" };
            if a != b {
                self.push(key, said(a), said(b));
            }
        }
    }

    fn materials(&mut self, at: &str, (a, all_a): (&Material, &[Material]), (b, all_b): (&Material, &[Material])) {
        let Material {
            name: _,
            reflectance,
            photometry,
            emissivity,
            bond_albedo,
            emissivity_bolometric,
            thermal_inertia,
            temperature_k,
            mixture,
        } = a;
        match (temperature_k, b.temperature_k) {
            (Some(a), Some(b)) => self.numbers(&format!("{at}.temperature_k"), *a, b),
            (a, b) => {
                let said = |t_k: Option<f64>| t_k.map_or("as the model has it".to_owned(), |t_k| format!("{t_k:?}"));
                if *a != b {
                    self.push(&format!("{at}.temperature_k"), said(*a).as_str(), said(b).as_str());
                }
            }
        }
        self.numbers(&format!("{at}.thermal_inertia"), *thermal_inertia, b.thermal_inertia);
        self.spectra(&format!("{at}.reflectance"), reflectance, &b.reflectance);
        self.spectra(&format!("{at}.emissivity"), emissivity, &b.emissivity);
        self.numbers(&format!("{at}.bond_albedo"), *bond_albedo, b.bond_albedo);
        self.numbers(&format!("{at}.emissivity_bolometric"), *emissivity_bolometric, b.emissivity_bolometric);
        // What is mixed, by name; shares of one material are one.
        let parts = |mixture: &[(usize, f64)], all: &[Material]| {
            let mut parts: Vec<(String, f64)> = Vec::new();
            for (i, share) in mixture {
                let name = all.get(*i).map_or("", |m| &m.name);
                match parts.iter_mut().find(|p| p.0 == name) {
                    Some(part) => part.1 += share,
                    None => parts.push((name.to_owned(), *share)),
                }
            }
            parts.sort_by(|a, b| a.0.cmp(&b.0));
            parts
        };
        let (parts_a, parts_b) = (parts(mixture, all_a), parts(&b.mixture, all_b));
        let alike = |(a, b): (&(String, f64), &(String, f64))| a.0 == b.0 && same(a.1, b.1);
        if parts_a.len() != parts_b.len() || !parts_a.iter().zip(&parts_b).all(alike) {
            self.push(&format!("{at}.mixture"), format!("{parts_a:?}"), format!("{parts_b:?}"));
        }
        match (photometry, &b.photometry) {
            (Photometry::Lambert, Photometry::Lambert) => {}
            (Photometry::Model(a), Photometry::Model(b)) => {
                let Model { shape, albedo, preset } = a.as_ref();
                self.debugged(&format!("{at} photometry"), shape, &b.shape);
                self.debugged(&format!("{at} preset"), preset, &b.preset);
                self.spectra(&format!("{at} albedo"), albedo, &b.albedo);
            }
            (Photometry::Hapke(a), Photometry::Hapke(b)) => {
                let Hapke { w, c1, c2, c3, c4, h1, h2 } = a.as_ref();
                let of_b = [&b.w, &b.c1, &b.c2, &b.c3, &b.c4, &b.h1, &b.h2];
                for ((name, a), b) in Hapke::NAMES.iter().zip([w, c1, c2, c3, c4, h1, h2]).zip(of_b) {
                    self.spectra(&format!("{at}.{name}"), a, b);
                }
            }
            (Photometry::Rpv(a), Photometry::Rpv(b)) => {
                let Rpv { rho0, k, g, h } = a.as_ref();
                for ((name, a), b) in Rpv::NAMES.iter().zip([rho0, k, g, h]).zip([&b.rho0, &b.k, &b.g, &b.h]) {
                    self.spectra(&format!("{at}.{name}"), a, b);
                }
            }
            (Photometry::Table(a), Photometry::Table(b)) => {
                self.debugged(&format!("{at} table"), &a.tables(), &b.tables());
                self.spectra(&format!("{at}.table"), a.albedo(), b.albedo());
                self.spectra(&format!("{at}.factor"), a.factor(), b.factor());
            }
            (
                Photometry::Lambert
                | Photometry::Model(_)
                | Photometry::Hapke(_)
                | Photometry::Rpv(_)
                | Photometry::Table(_),
                _,
            ) => {
                let shown = |p: &Photometry| p.key().unwrap_or("lambert");
                self.words(&format!("{at} photometry"), shown(photometry), shown(&b.photometry));
            }
        }
    }

    /// `pairs`: facets of both that are the same.
    fn textures(
        &mut self,
        at: &str,
        (a, mesh_a): (&Texture, &Mesh),
        (b, mesh_b): (&Texture, &Mesh),
        pairs: &[(usize, usize)],
    ) {
        // Materials were compared by their names.
        let Texture { material, kind, lon_lat, corners, rows, columns, wavelength_um, values, texels } = a;
        self.debugged(&format!("{at} longitudes and latitudes"), lon_lat, &b.lon_lat);
        self.debugged(&format!("{at} quantity"), kind, &b.kind);
        self.debugged(&format!("{at} between texels"), texels, &b.texels);
        self.lists(&format!("{at} wavelengths, um"), wavelength_um, &b.wavelength_um);
        let size = |t: &Texture| format!("{} rows x {} columns x {} layers", t.rows, t.columns, t.layers());
        if (*rows, *columns, a.layers(), values.len()) != (b.rows, b.columns, b.layers(), b.values.len()) {
            return self.push(&format!("{at} texels"), size(a), size(b));
        }
        let differs = |i: &usize| !same(values[*i], b.values[*i]);
        if let Some(first) = (0..values.len()).find(differs) {
            let count = (0..values.len()).filter(differs).count();
            let (texel, layer) = (first / a.layers(), first % a.layers());
            let (row, column) = (texel / columns, texel % columns);
            let mean = |t: &Texture| t.values.iter().sum::<f64>() / t.values.len() as f64;
            let place = format!(
                "{at} values ({count} of {}), the first in row {row}, column {column}, layer {layer}",
                values.len()
            );
            let shown = |t: &Texture| format!("{} (mean {})", t.values[first], mean(t));
            self.push(&place, shown(a), shown(b));
        }
        let of_texture = |f: &usize| mesh_a.material.get(*f) == Some(material);
        let elsewhere = |&&(i, j): &&(usize, usize)| {
            let (Some(on_a), Some(on_b), Some(turn)) = (corners.get(i), b.corners.get(j), turn(mesh_a, i, mesh_b, j))
            else {
                return true;
            };
            !alike_turned(on_a, on_b, turn)
        };
        let placed = if lon_lat.is_some() { &[] } else { pairs };
        let off: Vec<&(usize, usize)> = placed.iter().filter(|(i, _)| of_texture(i)).filter(elsewhere).collect();
        if let Some(&&(i, j)) = off.first() {
            let place = format!("{at} on {} facets, the first", off.len());
            let shown = |t: &Texture, f: usize| format!("facet {f} at texels {:?}", t.corners.get(f));
            self.push(&place, shown(a, i), shown(b, j));
        }
    }

    fn suns(&mut self, a: &Sun, b: &Sun) {
        let Sun { direction, distance_m, irradiance_1au, total_irradiance_1au_w_m2, limb_darkening } = a;
        self.directions("sun.direction", direction.vec(), b.direction.vec());
        self.numbers("sun.distance_m", *distance_m, b.distance_m);
        self.spectra("sun.spectrum", irradiance_1au, &b.irradiance_1au);
        self.numbers("sun.total_irradiance_w_m2", *total_irradiance_1au_w_m2, b.total_irradiance_1au_w_m2);
        self.numbers("sun.limb_darkening", *limb_darkening, b.limb_darkening);
    }

    fn exposures(&mut self, a: &Exposure, b: &Exposure) {
        let Exposure { instrument, camera, bands, spectrometer } = a;
        if *spectrometer != b.spectrometer {
            self.push("sensor.smile_um", format!("{spectrometer:?}"), format!("{:?}", b.spectrometer));
        }
        let FrameCamera {
            world_from_sensor: Pose { rotation, translation_m },
            samples,
            lines,
            pitch,
            boresight_px,
            lens,
        } = camera;
        self.places("observer.position_m", *translation_m, b.camera.world_from_sensor.translation_m);
        for (axis, i) in [("h", 0), ("v", 1), ("u", 2)] {
            let of_b = b.camera.world_from_sensor.rotation.col(i);
            self.directions(&format!("observer.{axis}"), rotation.col(i), of_b);
        }
        self.words("sensor.name", instrument, &b.instrument);
        self.numbers("sensor.samples", f64::from(*samples), f64::from(b.camera.samples));
        self.numbers("sensor.lines", f64::from(*lines), f64::from(b.camera.lines));
        if !(0..2).all(|k| same(pitch[k] / b.camera.pitch[k], 1.0)) {
            let shown = |[across, down]: [f64; 2]| {
                if across == down { format!("{across}") } else { format!("{across} x {down}") }
            };
            self.push("sensor pitch", shown(*pitch), shown(b.camera.pitch));
        }
        // Where the boresight is counts in pixels, and may be 0.
        if !(0..2).all(|k| same(1.0 + boresight_px[k] - b.camera.boresight_px[k], 1.0)) {
            self.push("sensor.boresight_px", format!("{boresight_px:?}"), format!("{:?}", b.camera.boresight_px));
        }
        // Of a lens all that counts is in its coefficients, or in its table.
        if *lens != b.camera.lens {
            let shown = |lens: &Option<std::sync::Arc<Lens>>| match lens.as_deref().map(Lens::coefficients) {
                None => "none".to_owned(),
                Some(Some(BrownConrady { radial: [k1, k2, k3], tangential: [p1, p2] })) => {
                    format!("k1 {k1}, k2 {k2}, k3 {k3}, p1 {p1}, p2 {p2}")
                }
                Some(None) => "a table of directions".to_owned(),
            };
            self.push("sensor.distortion", shown(lens), shown(&b.camera.lens));
        }
        if bands.len() != b.bands.len() {
            return self.push("sensor.bands", bands.len(), b.bands.len());
        }
        let differ = |a: &Band, b: &Band| {
            // Shapes and lights are compared separately.
            let Band { name: _, centre_um, fwhm_um, response: _, light: _ } = a;
            !same(*centre_um, b.centre_um) || !same(fwhm_um.unwrap_or(0.0), b.fwhm_um.unwrap_or(0.0))
        };
        let off: Vec<usize> = (0..bands.len()).filter(|&i| differ(&bands[i], &b.bands[i])).collect();
        if let Some(&i) = off.first() {
            let shown = |b: &Band| match b.fwhm_um {
                Some(fwhm_um) => format!("{} um wide {fwhm_um} um", b.centre_um),
                None => format!("{} um", b.centre_um),
            };
            let more = if off.len() > 1 { format!(" and {} more", off.len() - 1) } else { String::new() };
            self.push(&format!("sensor.bands[{i}]{more}"), shown(&bands[i]), shown(&b.bands[i]));
        }
        // A response without a width has no shape.
        let shape = |b: &Band| b.fwhm_um.map_or("monochromatic", |_| b.response.name());
        let pairs = || bands.iter().zip(&b.bands).enumerate();
        if let Some((i, (a, b))) = pairs().find(|(_, (a, b))| shape(a) != shape(b)) {
            self.push(&format!("sensor.bands[{i}] response"), shape(a), shape(b));
        }
        if let Some((i, (a, b))) = pairs().find(|(_, (a, b))| a.light != b.light) {
            self.push(&format!("sensor.bands[{i}] light"), a.light.name(), b.light.name());
        }
        for (i, (a, b)) in pairs() {
            if let (Some(a), Some(b)) = (a.response.table(), b.response.table()) {
                self.spectra(&format!("sensor.bands[{i}] response"), a, b);
            }
        }
    }

    fn globes(&mut self, at: &str, a: &Globe, b: &Globe) {
        let Globe { name: _, centre_m, radius_m, reflectance, bond_albedo, thermal_exitance_w_m2, day_night_k } = a;
        self.places(&format!("{at}.position_m"), *centre_m, b.centre_m);
        self.numbers(&format!("{at}.radius_m"), *radius_m, b.radius_m);
        self.spectra(&format!("{at}.albedo"), reflectance, &b.reflectance);
        self.numbers(&format!("{at}.bond_albedo"), *bond_albedo, b.bond_albedo);
        self.numbers(&format!("{at}.thermal_exitance_w_m2"), *thermal_exitance_w_m2, b.thermal_exitance_w_m2);
        for ((name, a), b) in ["day_k", "night_k"].iter().zip(day_night_k).zip(b.day_night_k) {
            self.numbers(&format!("{at}.{name}"), *a, b);
        }
    }

    /// Trajectories and orientations: not who wrote them, when and with which comments.
    fn flight_files(&mut self, a: &FlightFile, b: &FlightFile) {
        let FlightFile { trajectories, orientations, scale: _, made: _, comments: _, report: _, input: _ } = a;
        self.counted("trajectories", trajectories, &b.trajectories, |lines, at, (name, a), (other, b)| {
            let Trajectory { target, centre, frame, source: _, segments } = a;
            lines.debugged(&format!("{at} object"), name, other);
            lines.words(&format!("{at} target"), target, &b.target);
            lines.words(&format!("{at} centre"), centre, &b.centre);
            lines.words(&format!("{at} frame"), frame, &b.frame);
            lines.counted(&format!("{at} segments"), segments, &b.segments, |lines, at, a, b| {
                lines.words(&format!("{at} span"), &a.span.to_string(), &b.span.to_string());
                lines.told_if(a.path != b.path, at, "states or their interpolation differ");
            });
        });
        self.counted("orientations", orientations, &b.orientations, |lines, at, (name, a), (other, b)| {
            let Orientation { frame, base, source: _, turns } = a;
            lines.debugged(&format!("{at} object"), name, other);
            lines.words(&format!("{at} frame"), frame, &b.frame);
            lines.words(&format!("{at} base"), base, &b.base);
            lines.counted(&format!("{at} turns"), turns, &b.turns, |lines, at, a, b| {
                let span = |of: Option<Span>| of.map_or_else(|| "at all times".to_owned(), |span| span.to_string());
                lines.words(&format!("{at} span"), &span(a.span), &span(b.span));
                lines.told_if(a.turning != b.turning, at, "attitudes or their interpolation differ");
            });
        });
    }

    /// Compares lists item by item, if they are as long.
    fn counted<T>(&mut self, at: &str, a: &[T], b: &[T], each: impl Fn(&mut Lines, &str, &T, &T)) {
        if a.len() != b.len() {
            return self.push(at, a.len(), b.len());
        }
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            each(self, &format!("{at}[{i}]"), a, b);
        }
    }

    fn told_if(&mut self, differs: bool, at: &str, what: &str) {
        if differs {
            self.0.push(format!("{at}: {what}"));
        }
    }

    /// What flies over a scene: the Sun and cameras of a sequence's simulations.
    fn flights(&mut self, a: &[Flown], b: &[Flown]) {
        let names = |flights: &[Flown]| flights.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        self.each("sequence", &names(a), &names(b), |lines, at, i, j| {
            let (a, b) = (&a[i].1, &b[j].1);
            if a.len() != b.len() {
                return lines.push(at, format!("{} simulations", a.len()), format!("{} simulations", b.len()));
            }
            for (n, (a, b)) in a.iter().zip(b).enumerate() {
                let Step { sun_deg, views_deg, cameras } = a;
                let at = format!("{at} simulation {n}");
                lines.lists(&format!("{at} Sun, deg"), sun_deg, &b.sun_deg);
                lines.lists(&format!("{at} views, deg"), views_deg.as_flattened(), b.views_deg.as_flattened());
                if cameras.len() != b.cameras.len() {
                    lines.push(&at, format!("{} cameras", cameras.len()), format!("{} cameras", b.cameras.len()));
                }
                for (a, b) in cameras.iter().zip(&b.cameras) {
                    let Pinhole { position_m, look_deg, roll_deg, field_of_view_deg, pixels, at: _ } = a;
                    lines.places(&format!("{at} camera, m"), *position_m, b.position_m);
                    lines.lists(&format!("{at} camera looks to, deg"), look_deg, &b.look_deg);
                    lines.numbers(&format!("{at} camera turned by, deg"), *roll_deg, b.roll_deg);
                    lines.lists(&format!("{at} camera sees, deg"), field_of_view_deg, &b.field_of_view_deg);
                    lines.debugged(&format!("{at} camera pixels"), pixels, &b.pixels);
                }
            }
        });
    }

    /// Compares facets in their order; if they differ so, in the order of their corners. Returns which facets are the same.
    fn meshes(&mut self, a: (&Mesh, &[String]), b: (&Mesh, &[String])) -> Vec<(usize, usize)> {
        // Vertices, and how facets refer to them, are compared as corners.
        let Mesh { vertices_m: _, facets, material, face_of_facet: _, uv } = a.0;
        let (facets_a, facets_b) = (facets.len(), b.0.facets.len());
        if facets_a != facets_b {
            self.push("mesh", format!("{facets_a} facets"), format!("{facets_b} facets"));
            return Vec::new();
        }
        let name = |names: &'_ [String], id: MaterialId| names.get(usize::from(id.0)).cloned().unwrap_or_default();
        let differ =
            |i: usize, j: usize| turn(a.0, i, b.0, j).is_none() || name(a.1, material[i]) != name(b.1, b.0.material[j]);
        let pairs: Vec<(usize, usize)> = if (0..facets_a).any(|i| differ(i, i)) {
            let sorted = |(mesh, names): (&Mesh, &[String])| {
                let mut order: Vec<usize> = (0..facets_a).collect();
                let key = |f: usize| first_corner_first(mesh, f).map(|c| c.to_array());
                // Coincident facets are distinguished by their materials.
                order.sort_by(|&x, &y| {
                    let (x_m, y_m) = (key(x), key(y));
                    let corners = x_m.as_flattened().iter().zip(y_m.as_flattened()).map(|(p, q)| p.total_cmp(q));
                    let by_corners = corners.fold(Ordering::Equal, Ordering::then);
                    by_corners.then_with(|| name(names, mesh.material[x]).cmp(&name(names, mesh.material[y])))
                });
                order
            };
            sorted(a).into_iter().zip(sorted(b)).collect()
        } else {
            (0..facets_a).map(|i| (i, i)).collect()
        };
        let (off, pairs): (Vec<_>, Vec<_>) = pairs.into_iter().partition(|(i, j)| differ(*i, *j));
        if let Some(&(i, j)) = off.first() {
            let shown = |(mesh, names): (&Mesh, &[String]), f: usize| {
                format!(
                    "facet {f} of {:?} with its centre at {}",
                    name(names, mesh.material[f]),
                    mesh.facet(f).centroid_m()
                )
            };
            self.push(&format!("mesh, {} facets, the first", off.len()), shown(a, i), shown(b, j));
        }
        let shown = |uv: &[[[f64; 2]; 3]]| if uv.is_empty() { "are none" } else { "are there" };
        if uv.is_empty() != b.0.uv.is_empty() {
            self.push("mesh texture coordinates", shown(uv), shown(&b.0.uv));
        } else if !uv.is_empty() {
            let elsewhere = |&&(i, j): &&(usize, usize)| match turn(a.0, i, b.0, j) {
                Some(turn) => !alike_turned(&uv[i], &b.0.uv[j], turn),
                None => true,
            };
            let off: Vec<&(usize, usize)> = pairs.iter().filter(elsewhere).collect();
            if let Some(&&(i, j)) = off.first() {
                let at = format!("mesh texture coordinates of {} facets, the first", off.len());
                self.push(&at, format!("facet {i} {:?}", uv[i]), format!("facet {j} {:?}", b.0.uv[j]));
            }
        }
        self.faces(a.0, b.0, &pairs);
        pairs
    }

    /// Which facets were cut from one face.
    fn faces(&mut self, a: &Mesh, b: &Mesh, pairs: &[(usize, usize)]) {
        let (mut of_a, mut of_b) = (BTreeMap::new(), BTreeMap::new());
        let differs = |&&(i, j): &&(usize, usize)| {
            let (face_a, face_b) = (a.face(i), b.face(j));
            *of_a.entry(face_a).or_insert(face_b) != face_b || *of_b.entry(face_b).or_insert(face_a) != face_a
        };
        if let Some(&(i, j)) = pairs.iter().find(differs) {
            let count = |mesh: &Mesh| (0..mesh.facets.len()).map(|f| mesh.face(f)).collect::<BTreeSet<_>>().len();
            let at = format!("mesh, faces that facets were cut from (the first: facets {i} and {j})");
            self.push(&at, format!("{} faces", count(a)), format!("{} faces", count(b)));
        }
    }
}

/// How many of the same name come before.
fn nth(names: &[String], i: usize) -> usize {
    names[..i].iter().filter(|name| **name == names[i]).count()
}

/// By how many corners a facet of `b` must be rotated to match one of `a`: which corner comes first means nothing.
fn turn(a: &Mesh, i: usize, b: &Mesh, j: usize) -> Option<usize> {
    let (corners_a, corners_b) = (a.facet(i).corners_m, b.facet(j).corners_m);
    (0..3).find(|turn| (0..3).all(|k| near(corners_a[k], corners_b[(k + turn) % 3])))
}

/// Whether two facets have the same values at their corners, after rotating the second.
fn alike_turned(a: &[[f64; 2]; 3], b: &[[f64; 2]; 3], turn: usize) -> bool {
    let alike = |a: f64, b: f64| same(a, b) || a.is_nan() && b.is_nan();
    (0..3).all(|k| (0..2).all(|axis| alike(a[k][axis], b[(k + turn) % 3][axis])))
}

/// The corners of a facet in their sense, from the one with the least coordinates.
fn first_corner_first(mesh: &Mesh, facet: usize) -> [DVec3; 3] {
    let [a, b, c] = mesh.facet(facet).corners_m;
    let less = |p: DVec3, q: DVec3| p.to_array() < q.to_array();
    if less(a, b) && less(a, c) {
        [a, b, c]
    } else if less(b, c) {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
