//! Geometry of each pixel: where it looks, from what angle, at what.
//!
//! Names without `_MEAN` are the centre ray's values, as ISIS `phocube` gives them; `_MEAN` are means over the covered area
//! of the pixel, each fragment taken at the ray through its image centroid. Latitude, longitude, and the angles that know no
//! facet (phase, incidence and emission on the radial) are those of the mean position: they are never averaged themselves.

use glam::DVec3;

use super::pixel::Pixel;
use crate::geometry::angle_rad;
use crate::product::{Backplanes, FacetTable, Plane};
use crate::scene::{Material, Scene};

/// Planes that every product has: name and unit.
const FIXED: [(&str, &str); 30] = [
    ("COVERAGE", "1"),
    ("LIT_FRACTION", "1"),
    ("FACET", "index from 0"),
    ("FACE", "index from 0"),
    ("MATERIAL", "index from 0"),
    ("LATITUDE", "deg"),
    ("LONGITUDE", "deg"),
    ("BODYFIXEDX", "m"),
    ("BODYFIXEDY", "m"),
    ("BODYFIXEDZ", "m"),
    ("RANGE", "m"),
    ("PHASE", "deg"),
    ("INCIDENCE", "deg"),
    ("EMISSION", "deg"),
    ("LOCALINCIDENCE", "deg"),
    ("LOCALEMISSION", "deg"),
    ("PIXELRESOLUTION", "m"),
    ("OBLIQUEDETECTORRESOLUTION", "m"),
    ("SUNILLUMINATIONMASK", "1"),
    ("LATITUDE_MEAN", "deg"),
    ("LONGITUDE_MEAN", "deg"),
    ("BODYFIXEDX_MEAN", "m"),
    ("BODYFIXEDY_MEAN", "m"),
    ("BODYFIXEDZ_MEAN", "m"),
    ("RANGE_MEAN", "m"),
    ("PHASE_MEAN", "deg"),
    ("INCIDENCE_MEAN", "deg"),
    ("EMISSION_MEAN", "deg"),
    ("LOCALINCIDENCE_MEAN", "deg"),
    ("LOCALEMISSION_MEAN", "deg"),
];

/// Computes the planes.
pub(super) struct Planes<'a> {
    scene: &'a Scene,
    towards_sun: DVec3,
    /// Names of the dictionary entries that are no mixtures: each has a plane of area fractions, and one of lit area fractions.
    entries: Vec<String>,
    /// For each material its shares of these entries.
    shares: Vec<Vec<(usize, f64)>>,
}

/// Where a ray meets a facet's plane, and how.
struct Hit {
    /// In the scene, m.
    point_m: DVec3,
    range_m: f64,
    /// From the camera, of any length.
    ray: DVec3,
    /// Normal of the facet, of any length.
    normal: DVec3,
}

impl Hit {
    fn local_incidence_rad(&self, planes: &Planes) -> f64 {
        angle_rad(self.normal, planes.towards_sun)
    }

    fn local_emission_rad(&self) -> f64 {
        angle_rad(self.normal, -self.ray)
    }
}

/// The dictionary entries that materials are mixed of, ascending.
fn entries_used(scene: &Scene) -> Vec<usize> {
    let mut used: Vec<usize> = scene.body.materials.iter().flat_map(|m| &m.mixture).map(|part| part.0).collect();
    used.sort_unstable();
    used.dedup();
    used
}

/// How many planes an image of a scene has, apart from those of maps.
pub fn plane_count(scene: &Scene) -> usize {
    FIXED.len() + 2 * entries_used(scene).len()
}

impl<'a> Planes<'a> {
    pub(super) fn new(scene: &'a Scene, table: &FacetTable) -> Self {
        let used = entries_used(scene);
        let mut entries: Vec<String> = used.iter().map(|i| format!("entry {i}")).collect();
        let place = |entry: usize| used.partition_point(|i| *i < entry);
        for material in &scene.body.materials {
            if let [(i, _)] = material.mixture[..] {
                entries[place(i)].clone_from(&material.name);
            }
        }
        let of = |m: &Material| m.mixture.iter().map(|(entry, share)| (place(*entry), *share)).collect();
        let shares = scene.body.materials.iter().map(of).collect();
        Planes { scene, towards_sun: table.sun_direction.vec(), entries, shares }
    }

    pub(super) fn count(&self) -> usize {
        FIXED.len() + 2 * self.entries.len()
    }

    /// Writes one pixel's values into its line of each plane.
    pub(super) fn add(&self, pixel: &mut Pixel, column: u32, row: u32, planes: &mut [&mut [f64]]) {
        let mut values = [f64::NAN; FIXED.len()];
        let mut abundance = vec![0.0; 2 * self.entries.len()];
        let coverage: f64 = pixel.entries.iter().map(|e| e.area).sum();
        values[0] = coverage;
        if coverage > 0.0 {
            self.means(pixel, coverage, &mut values, &mut abundance);
            self.centre(pixel, column, row, &mut values);
        }
        for (plane, value) in planes.iter_mut().zip(values.iter().chain(&abundance)) {
            plane[column as usize] = *value;
        }
    }

    fn means(&self, pixel: &Pixel, coverage: f64, values: &mut [f64; FIXED.len()], abundance: &mut [f64]) {
        let mesh = &self.scene.body.mesh;
        let (mut position_m, mut range_m, mut lit) = (DVec3::ZERO, 0.0, 0.0);
        let (mut local_incidence, mut local_emission) = (0.0, 0.0);
        let mut area_of_material = [0.0; 8];
        let mut more_materials = std::collections::BTreeMap::new();
        let mut largest = (0.0, 0);
        for e in &pixel.entries {
            let [x, y] = e.centroid(&pixel.rect);
            let hit = self.hit(e.facet, x, y);
            position_m += e.area * hit.point_m;
            range_m += e.area * hit.range_m;
            local_incidence += e.area * hit.local_incidence_rad(self);
            local_emission += e.area * hit.local_emission_rad();
            lit += e.lit;
            if e.area > largest.0 {
                largest = (e.area, e.facet);
            }
            let material = mesh.material[e.facet as usize].0 as usize;
            match area_of_material.get_mut(material) {
                Some(area) => *area += e.area,
                None => *more_materials.entry(material).or_insert(0.0) += e.area,
            }
            for (entry, share) in &self.shares[material] {
                abundance[2 * entry] += share * e.area;
                abundance[2 * entry + 1] += share * e.lit;
            }
        }
        let most = area_of_material.iter().copied().enumerate().chain(more_materials);
        let material = most.fold((0, 0.0), |m, (i, area)| if area > m.1 { (i, area) } else { m }).0;
        values[1] = lit / coverage;
        values[2] = f64::from(largest.1);
        values[3] = f64::from(mesh.face(largest.1 as usize));
        values[4] = material as f64;
        let mean_m = position_m / coverage;
        let body_m = mean_m + self.scene.body.origin_m;
        let to_observer = self.scene.exposure.camera.centre_m() - mean_m;
        let (latitude, longitude) = planetocentric_deg(body_m);
        let degrees = |sum: f64| (sum / coverage).to_degrees();
        values[19..30].copy_from_slice(&[
            latitude,
            longitude,
            body_m.x,
            body_m.y,
            body_m.z,
            range_m / coverage,
            angle_rad(self.towards_sun, to_observer).to_degrees(),
            angle_rad(body_m, self.towards_sun).to_degrees(),
            angle_rad(body_m, to_observer).to_degrees(),
            degrees(local_incidence),
            degrees(local_emission),
        ]);
    }

    fn centre(&self, pixel: &mut Pixel, column: u32, row: u32, values: &mut [f64; FIXED.len()]) {
        let Some(facet) = pixel.centre else { return };
        let hit = self.hit(facet, f64::from(column) + 0.5, f64::from(row) + 0.5);
        let body_m = hit.point_m + self.scene.body.origin_m;
        let (latitude, longitude) = planetocentric_deg(body_m);
        let resolution_m = hit.range_m * self.scene.exposure.camera.mean_pitch();
        values[5..19].copy_from_slice(&[
            latitude,
            longitude,
            body_m.x,
            body_m.y,
            body_m.z,
            hit.range_m,
            angle_rad(self.towards_sun, -hit.ray).to_degrees(),
            angle_rad(body_m, self.towards_sun).to_degrees(),
            angle_rad(body_m, -hit.ray).to_degrees(),
            hit.local_incidence_rad(self).to_degrees(),
            hit.local_emission_rad().to_degrees(),
            resolution_m,
            resolution_m / hit.local_emission_rad().cos().abs(),
            f64::from(u8::from(pixel.centre_is_lit)),
        ]);
    }

    /// Where the ray through an image point meets the plane of a facet.
    fn hit(&self, facet: u32, x_px: f64, y_px: f64) -> Hit {
        let camera = &self.scene.exposure.camera;
        let facet = self.scene.body.mesh.facet(facet as usize);
        let ray = camera.ray(x_px, y_px);
        let away = facet.met_by(camera.centre_m(), ray);
        let point_m = camera.centre_m() + away * ray;
        Hit { point_m, range_m: away * ray.length(), ray, normal: facet.cross_m2() }
    }

    /// Puts names to the planes.
    pub(super) fn name(&self, values: Vec<Vec<f64>>, samples: usize, lines: usize) -> Backplanes {
        let fixed = FIXED.iter().map(|(name, unit)| ((*name).to_string(), (*unit).to_string()));
        let abundance = self
            .entries
            .iter()
            .flat_map(|entry| ["ABUNDANCE", "ABUNDANCE_LIT"].map(|kind| (format!("{kind} {entry}"), "1".to_string())));
        let named = fixed.chain(abundance).zip(values);
        let planes = named.map(|((name, unit), values)| Plane { name, unit, values }).collect();
        Backplanes { samples, lines, planes }
    }
}

/// Planetocentric latitude and east longitude (0 to 360) of a body-fixed position, deg.
fn planetocentric_deg(p: DVec3) -> (f64, f64) {
    let latitude = p.z.atan2((p.x * p.x + p.y * p.y).sqrt()).to_degrees();
    (latitude, p.y.atan2(p.x).to_degrees().rem_euclid(360.0))
}
