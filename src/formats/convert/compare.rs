//! What two contents differ in, by meaning: not by the order of facets or materials, nor by how a spectrum is tabulated.

use std::cmp::Ordering;

use glam::DVec3;

use crate::geometry::{MaterialId, Mesh};
use crate::scene::{Mars, Scene};
use crate::spectral::{SpectralLibrary, Spectrum};

use super::Content;

/// Positions are the same within this, m, or within rounding of far ones.
const POSITION_M: f64 = 1e-9;
/// Numbers of spectra and parts of directions are the same within this, or this share of them.
const SHARE: f64 = 1e-12;
/// As many facets, materials or tables are told one by one.
const TOLD: usize = 10;

/// One line for each difference: where, and both values. Empty: the same in meaning.
pub fn differences(a: &Content, b: &Content) -> Vec<String> {
    let mut lines = Lines(Vec::new());
    match (a, b) {
        (Content::Scene(a, _), Content::Scene(b, _)) => lines.scenes(a, b),
        (Content::Surface(a), Content::Surface(b)) => {
            let (origin_a, origin_b) = (a.origin_m.unwrap_or_default(), b.origin_m.unwrap_or_default());
            lines.places("origin_m", origin_a, origin_b);
            let names = |m: &[crate::formats::mtl::ObjMaterial]| m.iter().map(|m| m.name.clone()).collect::<Vec<_>>();
            lines.meshes((&a.mesh, &names(&a.materials)), (&b.mesh, &names(&b.materials)));
        }
        (Content::Spectra(a), Content::Spectra(b)) => {
            let names = |l: &[SpectralLibrary]| l.iter().map(|l| l.name.clone()).collect::<Vec<_>>();
            lines.each("spectra", &names(a), &names(b), |lines, at, i, j| lines.libraries(at, &a[i], &b[j]));
        }
        _ => lines.0.push(format!("the first holds {}, the second {}: convert one of them", a.kind(), b.kind())),
    }
    lines.0
}

struct Lines(Vec<String>);

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SHARE * a.abs().max(b.abs()).max(1.0)
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

    /// Compares what has the same name, and tells what has no counterpart.
    fn each(&mut self, at: &str, a: &[String], b: &[String], mut compare: impl FnMut(&mut Self, &str, usize, usize)) {
        let known = self.0.len();
        for (i, name) in a.iter().enumerate() {
            match b.iter().position(|other| other == name) {
                Some(j) => compare(self, &format!("{at}.{name:?}"), i, j),
                None => self.push(&format!("{at}.{name:?}"), "is there", "is not"),
            }
        }
        b.iter()
            .filter(|name| !a.contains(name))
            .for_each(|name| self.push(&format!("{at}.{name:?}"), "is not", "is there"));
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
        let names = |l: &SpectralLibrary| l.columns.iter().map(|c| c.name.to_lowercase()).collect::<Vec<_>>();
        self.each(at, &names(a), &names(b), |lines, at, i, j| {
            let spectrum = |l: &SpectralLibrary, name: &str| l.spectrum(name, crate::spectral::Extend::Error);
            match spectrum(a, &a.columns[i].name).zip(spectrum(b, &b.columns[j].name)) {
                Some((a, b)) => lines.spectra(at, &a, &b),
                None => lines.push(at, "is no table", "or the other is none"),
            }
        });
    }

    fn scenes(&mut self, a: &Scene, b: &Scene) {
        self.places("origin_m", a.origin_m, b.origin_m);
        let names = |scene: &Scene| scene.materials.iter().map(|m| m.name.clone()).collect::<Vec<_>>();
        self.meshes((&a.mesh, &names(a)), (&b.mesh, &names(b)));
        self.each("materials", &names(a), &names(b), |lines, at, i, j| {
            let (a, b) = (&a.materials[i], &b.materials[j]);
            lines.spectra(&format!("{at}.reflectance"), &a.reflectance, &b.reflectance);
            lines.spectra(&format!("{at}.emissivity"), &a.emissivity, &b.emissivity);
            lines.words(
                &format!("{at} photometry"),
                a.photometry.key().unwrap_or("lambert"),
                b.photometry.key().unwrap_or("lambert"),
            );
            for ((name, a), (other, b)) in a.photometry.parameters().into_iter().zip(b.photometry.parameters()) {
                if name == other {
                    lines.spectra(&format!("{at}.{name}"), a, b);
                }
            }
            lines.numbers(&format!("{at}.bond_albedo"), a.bond_albedo, b.bond_albedo);
            lines.numbers(&format!("{at}.emissivity_bolometric"), a.emissivity_bolometric, b.emissivity_bolometric);
        });
        self.directions("sun.direction", a.sun.direction.vec(), b.sun.direction.vec());
        self.numbers("sun.distance_m", a.sun.distance_m, b.sun.distance_m);
        self.spectra("sun.spectrum", &a.sun.irradiance_1au, &b.sun.irradiance_1au);
        let (total_a, total_b) = (a.sun.total_irradiance_1au_w_m2, b.sun.total_irradiance_1au_w_m2);
        self.numbers("sun.total_irradiance_w_m2", total_a, total_b);
        match (&a.mars, &b.mars) {
            (Some(a), Some(b)) => self.mars(a, b),
            (None, None) => {}
            (a, _) => self.push("mars", if a.is_some() { "is there" } else { "is not" }, "the other way round"),
        }
        self.words("thermal.model", &format!("{:?}", a.thermal), &format!("{:?}", b.thermal));
        let (camera_a, camera_b) = (&a.sensor.camera, &b.sensor.camera);
        self.places("observer.position_m", camera_a.centre_m(), camera_b.centre_m());
        let (axes_a, axes_b) = (camera_a.world_from_sensor.rotation, camera_b.world_from_sensor.rotation);
        for (name, i) in [("h", 0), ("v", 1), ("u", 2)] {
            self.directions(&format!("observer.{name}"), axes_a.col(i), axes_b.col(i));
        }
        self.words("sensor.name", &a.sensor.name, &b.sensor.name);
        self.numbers("sensor.samples", f64::from(camera_a.samples), f64::from(camera_b.samples));
        self.numbers("sensor.lines", f64::from(camera_a.lines), f64::from(camera_b.lines));
        for (k, name) in ["sample", "line"].into_iter().enumerate() {
            self.numbers(&format!("sensor pitch, {name}"), camera_a.pitch[k], camera_b.pitch[k]);
            self.numbers(&format!("sensor.boresight_px, {name}"), camera_a.boresight_px[k], camera_b.boresight_px[k]);
        }
        let (bands_a, bands_b) = (&a.sensor.bands, &b.sensor.bands);
        if bands_a.len() != bands_b.len() {
            return self.push("sensor.bands", bands_a.len(), bands_b.len());
        }
        let width = |w: Option<f64>| w.unwrap_or(0.0);
        let differ = bands_a
            .iter()
            .zip(bands_b)
            .position(|(a, b)| !same(a.centre_um, b.centre_um) || !same(width(a.fwhm_um), width(b.fwhm_um)));
        if let Some(i) = differ {
            let shown = |b: &crate::spectral::Band| format!("{} um wide {} um", b.centre_um, width(b.fwhm_um));
            self.push(&format!("sensor.bands[{i}]"), shown(&bands_a[i]), shown(&bands_b[i]));
        }
    }

    fn mars(&mut self, a: &Mars, b: &Mars) {
        self.places("mars.position_m", a.centre_m, b.centre_m);
        self.numbers("mars.radius_m", a.radius_m, b.radius_m);
        self.spectra("mars.albedo", &a.reflectance, &b.reflectance);
        self.numbers("mars.bond_albedo", a.bond_albedo, b.bond_albedo);
        self.numbers("mars.thermal_exitance_w_m2", a.thermal_exitance_w_m2, b.thermal_exitance_w_m2);
        self.words("mars.model", &format!("{:?}", a.model), &format!("{:?}", b.model));
    }

    /// Compares facets in their order; if they differ so, in the order of their corners.
    fn meshes(&mut self, a: (&Mesh, &[String]), b: (&Mesh, &[String])) {
        let (facets_a, facets_b) = (a.0.facets.len(), b.0.facets.len());
        if facets_a != facets_b {
            return self.push("mesh", format!("{facets_a} facets"), format!("{facets_b} facets"));
        }
        let name = |names: &'_ [String], id: MaterialId| names.get(usize::from(id.0)).cloned().unwrap_or_default();
        let differ = |i: usize, j: usize| {
            let (corners_a, corners_b) = (first_corner_first(a.0, i), first_corner_first(b.0, j));
            !corners_a.iter().zip(corners_b).all(|(a, b)| near(*a, b))
                || name(a.1, a.0.material[i]) != name(b.1, b.0.material[j])
        };
        if !(0..facets_a).any(|i| differ(i, i)) {
            return;
        }
        let sorted = |(mesh, names): (&Mesh, &[String])| {
            let mut order: Vec<usize> = (0..facets_a).collect();
            let key = |f: usize| first_corner_first(mesh, f).map(|c| c.to_array());
            // Facets that coincide are told apart by their materials.
            order.sort_by(|&x, &y| {
                let (x_m, y_m) = (key(x), key(y));
                let corners = x_m.as_flattened().iter().zip(y_m.as_flattened()).map(|(p, q)| p.total_cmp(q));
                let by_corners = corners.fold(Ordering::Equal, Ordering::then);
                by_corners.then_with(|| name(names, mesh.material[x]).cmp(&name(names, mesh.material[y])))
            });
            order
        };
        let pairs: Vec<(usize, usize)> = sorted(a).into_iter().zip(sorted(b)).filter(|(i, j)| differ(*i, *j)).collect();
        if let Some(&(i, j)) = pairs.first() {
            let shown = |(mesh, names): (&Mesh, &[String]), f: usize| {
                format!(
                    "facet {f} of {:?} with its centre at {}",
                    name(names, mesh.material[f]),
                    mesh.facet(f).centroid_m()
                )
            };
            self.push(&format!("mesh, {} facets, the first", pairs.len()), shown(a, i), shown(b, j));
        }
    }
}

/// The corners of a facet in their sense, from the one with the least coordinates: which one comes first says nothing.
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
