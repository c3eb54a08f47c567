//! Geometry of each pixel: where it looks, from what angle, at what.
//!
//! Names without `_MEAN` are the centre ray's values, as ISIS `phocube` gives them; `_MEAN` are means over the covered area
//! of the pixel, each fragment taken at the ray through its image centroid. Latitude, longitude, and the angles that know no
//! facet (phase, incidence and emission on the radial) are those of the mean position: they are never averaged themselves.

use glam::DVec3;

use super::detector::PixelSite;
use super::pixel::Pixel;
use crate::geometry::planetocentric_deg;
use crate::geometry::polygon::Point;
use crate::geometry::{FrameCamera, angle_rad, body_from_site};
use crate::product::{Backplanes, Plane};
use crate::scene::{Material, Scene};

/// A slope below this, rad, is rounding.
const LEVEL: f64 = 16.0 * f64::EPSILON;

/// A plane that every product has.
struct PlaneKind {
    name: &'static str,
    unit: &'static str,
    /// Its value in a pixel that sees something; NaN where it has none.
    value: fn(&Sums) -> f64,
}

const fn plane(name: &'static str, unit: &'static str, value: fn(&Sums) -> f64) -> PlaneKind {
    PlaneKind { name, unit, value }
}

/// Planes that every product has, in their order.
const KINDS: &[PlaneKind] = &[
    plane("COVERAGE", "1", |of| of.coverage),
    plane("LIT_FRACTION", "1", |of| of.lit / of.coverage),
    plane("FACET", "index from 0", |of| f64::from(of.largest.1)),
    plane("FACE", "index from 0", |of| of.face),
    plane("MATERIAL", "index from 0", |of| of.material),
    plane("LATITUDE", "deg", |of| of.centre.latitude_deg),
    plane("LONGITUDE", "deg", |of| of.centre.longitude_deg),
    plane("RADIUS", "m", |of| of.centre.body_m.length()),
    plane("BODYFIXEDX", "m", |of| of.centre.body_m.x),
    plane("BODYFIXEDY", "m", |of| of.centre.body_m.y),
    plane("BODYFIXEDZ", "m", |of| of.centre.body_m.z),
    plane("RANGE", "m", |of| of.centre.range_m),
    plane("PHASE", "deg", |of| of.centre.phase_rad.to_degrees()),
    plane("INCIDENCE", "deg", |of| of.centre.incidence_rad.to_degrees()),
    plane("EMISSION", "deg", |of| of.centre.emission_rad.to_degrees()),
    plane("LOCALINCIDENCE", "deg", |of| of.centre.local_incidence_rad.to_degrees()),
    plane("LOCALEMISSION", "deg", |of| of.centre.local_emission_rad.to_degrees()),
    plane("PIXELRESOLUTION", "m", |of| of.resolution_m),
    plane("OBLIQUEDETECTORRESOLUTION", "m", |of| of.resolution_m / of.centre.local_emission_rad.cos().abs()),
    plane("GSD_SAMPLE", "m", |of| of.gsd_m[0]),
    plane("GSD_LINE", "m", |of| of.gsd_m[1]),
    plane("SLOPE", "deg", |of| of.centre.slope_rad.to_degrees()),
    plane("SLOPEAZIMUTH", "deg", |of| of.centre.slope_azimuth_deg),
    plane("SUNILLUMINATIONMASK", "1", |of| of.centre_is_lit),
    plane("LATITUDE_MEAN", "deg", |of| of.mean.latitude_deg),
    plane("LONGITUDE_MEAN", "deg", |of| of.mean.longitude_deg),
    plane("RADIUS_MEAN", "m", |of| of.mean.body_m.length()),
    plane("BODYFIXEDX_MEAN", "m", |of| of.mean.body_m.x),
    plane("BODYFIXEDY_MEAN", "m", |of| of.mean.body_m.y),
    plane("BODYFIXEDZ_MEAN", "m", |of| of.mean.body_m.z),
    plane("RANGE_MEAN", "m", |of| of.mean.range_m),
    plane("PHASE_MEAN", "deg", |of| of.mean.phase_rad.to_degrees()),
    plane("INCIDENCE_MEAN", "deg", |of| of.mean.incidence_rad.to_degrees()),
    plane("EMISSION_MEAN", "deg", |of| of.mean.emission_rad.to_degrees()),
    plane("LOCALINCIDENCE_MEAN", "deg", |of| of.mean.local_incidence_rad.to_degrees()),
    plane("LOCALEMISSION_MEAN", "deg", |of| of.mean.local_emission_rad.to_degrees()),
    plane("SLOPE_MEAN", "deg", |of| of.mean.slope_rad.to_degrees()),
    plane("SLOPEAZIMUTH_MEAN", "deg", |of| of.mean.slope_azimuth_deg),
];

/// What a pixel's planes are made from.
struct Sums {
    /// Area that shows a surface, and what of it is lit, pixels.
    coverage: f64,
    lit: f64,
    /// The largest area of a facet, and the facet.
    largest: (f64, u32),
    /// The face that it was cut from.
    face: f64,
    /// The material with the largest area.
    material: f64,
    /// Where the centre ray meets the surface.
    centre: SurfacePoint,
    centre_is_lit: f64,
    /// Width of a pixel there, square to the ray, m.
    resolution_m: f64,
    /// From the middle of a pixel to that of the next one along a line, and to that of the next line, on the facet's plane there, m.
    gsd_m: [f64; 2],
    /// The mean of all that is seen.
    mean: SurfacePoint,
}

/// A place on the surface, and how it is lit and seen; NaN if there is none.
struct SurfacePoint {
    latitude_deg: f64,
    longitude_deg: f64,
    body_m: DVec3,
    range_m: f64,
    phase_rad: f64,
    /// On the radial.
    incidence_rad: f64,
    emission_rad: f64,
    /// On the facet.
    local_incidence_rad: f64,
    local_emission_rad: f64,
    /// Of the facet's normal from the radius.
    slope_rad: f64,
    /// Where it goes down, from north by east; 0 where it is level.
    slope_azimuth_deg: f64,
}

impl SurfacePoint {
    const NONE: SurfacePoint = SurfacePoint {
        latitude_deg: f64::NAN,
        longitude_deg: f64::NAN,
        body_m: DVec3::NAN,
        range_m: f64::NAN,
        phase_rad: f64::NAN,
        incidence_rad: f64::NAN,
        emission_rad: f64::NAN,
        local_incidence_rad: f64::NAN,
        local_emission_rad: f64::NAN,
        slope_rad: f64::NAN,
        slope_azimuth_deg: f64::NAN,
    };
}

/// Computes the planes.
pub(super) struct Planes<'a> {
    scene: &'a Scene,
    /// The pinhole of the drawing.
    camera: FrameCamera,
    towards_sun: DVec3,
    /// Names of the dictionary entries that are not mixtures: each has a plane of area fractions, and one of lit area fractions.
    entries: Vec<String>,
    /// For each material its shares of these entries.
    shares: Vec<Vec<(usize, f64)>>,
    /// Names of the bodies of the sky that may be in view: each has a plane of what the pixel shows of it.
    globes: Vec<String>,
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

    fn slope_rad(&self, planes: &Planes) -> f64 {
        angle_rad(self.normal, self.point_m + planes.scene.body.origin_m)
    }
}

/// Where a plane goes down at a place of the body: the azimuth of its normal, from north by east, 0 to 360 deg; 0 where it is level.
fn downhill_deg(normal: DVec3, body_m: DVec3) -> f64 {
    let site = body_from_site(body_m).map_or(DVec3::ZERO, |axes| axes.transpose() * normal);
    // Rounding of the axes does not tilt what is level.
    let is_level = site.x.hypot(site.y) <= LEVEL * site.z.abs();
    let azimuth_deg = site.x.atan2(site.y).to_degrees().rem_euclid(360.0);
    if is_level { 0.0 } else { azimuth_deg }
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
    KINDS.len() + 2 * entries_used(scene).len() + scene.globes_in_view().len()
}

impl<'a> Planes<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
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
        let globes = scene.globes_in_view().into_iter().map(|(globe, _)| globe.name.clone()).collect();
        let camera = scene.exposure.camera.drawn().pinhole;
        Planes { scene, camera, towards_sun: scene.sky.sun.direction.vec(), entries, shares, globes }
    }

    pub(super) fn count(&self) -> usize {
        KINDS.len() + 2 * self.entries.len() + self.globes.len()
    }

    /// Writes one pixel's values into its line of each plane.
    pub(super) fn gather(&self, pixel: &Pixel, planes: &mut [&mut [f64]]) {
        let sample = pixel.site.sample as usize;
        let (fixed, others) = planes.split_at_mut(KINDS.len());
        let (abundance, globes) = others.split_at_mut(2 * self.entries.len());
        pixel.globes.shown().iter().for_each(|(globe, shown)| globes[*globe][sample] = shown.area);
        // From 0: a sum of nothing would be -0.
        let coverage = pixel.entries.iter().map(|e| e.shown.area).fold(0.0, |sum, area| sum + area);
        if coverage > 0.0 {
            let sums = self.sums(pixel, coverage, |entry, area| abundance[entry][sample] += area);
            fixed.iter_mut().zip(KINDS).for_each(|(plane, kind)| plane[sample] = (kind.value)(&sums));
        } else {
            fixed.iter_mut().for_each(|plane| plane[sample] = f64::NAN);
            fixed[0][sample] = coverage;
        }
    }

    /// Adds areas, and lit areas, of dictionary entries to their planes by `add(plane, area)` on the way.
    fn sums(&self, pixel: &Pixel, coverage: f64, mut add: impl FnMut(usize, f64)) -> Sums {
        let mesh = &self.scene.body.mesh;
        let (mut position_m, mut range_m, mut lit) = (DVec3::ZERO, 0.0, 0.0);
        let (mut local_incidence, mut local_emission, mut slope, mut normals) = (0.0, 0.0, 0.0, DVec3::ZERO);
        let mut area_of_material = [0.0; 8];
        let mut more_materials = std::collections::BTreeMap::new();
        let mut largest = (0.0, 0);
        for e in &pixel.entries {
            let area = e.shown.area;
            let [x, y] = e.centroid(&pixel.site.rect);
            let hit = self.hit(e.facet, x, y);
            position_m += area * hit.point_m;
            range_m += area * hit.range_m;
            local_incidence += area * hit.local_incidence_rad(self);
            local_emission += area * hit.local_emission_rad();
            slope += area * hit.slope_rad(self);
            normals += area * hit.normal.normalize_or_zero();
            lit += e.lit.area;
            if area > largest.0 {
                largest = (area, e.facet);
            }
            let material = mesh.material[e.facet as usize].0 as usize;
            match area_of_material.get_mut(material) {
                Some(sum) => *sum += area,
                None => *more_materials.entry(material).or_insert(0.0) += area,
            }
            for (entry, share) in &self.shares[material] {
                add(2 * entry, share * area);
                add(2 * entry + 1, share * e.lit.area);
            }
        }
        let most = area_of_material.iter().copied().enumerate().chain(more_materials);
        let material = most.fold((0, 0.0), |m, (i, area)| if area > m.1 { (i, area) } else { m }).0;
        let mean_m = position_m / coverage;
        let to_observer = self.camera.centre_m() - mean_m;
        let mean = SurfacePoint {
            range_m: range_m / coverage,
            local_incidence_rad: local_incidence / coverage,
            local_emission_rad: local_emission / coverage,
            slope_rad: slope / coverage,
            slope_azimuth_deg: downhill_deg(normals, mean_m + self.scene.body.origin_m),
            ..self.place(mean_m, to_observer)
        };
        // Of a square pixel of the same area.
        let pitch = self.camera.mean_pitch() / pixel.site.per_cell.sqrt();
        let [x, y] = pixel.site.centre;
        let centre = pixel.centre.map(|facet| self.hit(facet, x, y));
        let of_centre = |hit: &Hit| SurfacePoint {
            range_m: hit.range_m,
            local_incidence_rad: hit.local_incidence_rad(self),
            local_emission_rad: hit.local_emission_rad(),
            slope_rad: hit.slope_rad(self),
            slope_azimuth_deg: downhill_deg(hit.normal, hit.point_m + self.scene.body.origin_m),
            ..self.place(hit.point_m, -hit.ray)
        };
        Sums {
            coverage,
            lit,
            largest,
            face: f64::from(mesh.face(largest.1 as usize)),
            material: material as f64,
            resolution_m: centre.as_ref().map_or(f64::NAN, |hit| hit.range_m * pitch),
            gsd_m: centre.as_ref().map_or([f64::NAN; 2], |hit| self.gsd_m(hit, &pixel.site)),
            centre_is_lit: centre.as_ref().map_or(f64::NAN, |_| f64::from(u8::from(pixel.centre_is_lit))),
            centre: centre.as_ref().map_or(SurfacePoint::NONE, of_centre),
            mean,
        }
    }

    /// A point of the scene, m, by itself: no facet and no range.
    fn place(&self, point_m: DVec3, to_observer: DVec3) -> SurfacePoint {
        let body_m = point_m + self.scene.body.origin_m;
        let [latitude_deg, longitude_deg] = planetocentric_deg(body_m);
        SurfacePoint {
            latitude_deg,
            longitude_deg,
            body_m,
            phase_rad: angle_rad(self.towards_sun, to_observer),
            incidence_rad: angle_rad(body_m, self.towards_sun),
            emission_rad: angle_rad(body_m, to_observer),
            ..SurfacePoint::NONE
        }
    }

    /// Where the ray through an image point meets the plane of a facet.
    fn hit(&self, facet: u32, x_px: f64, y_px: f64) -> Hit {
        let camera = &self.camera;
        let facet = self.scene.body.mesh.facet(facet as usize);
        let ray = camera.ray(x_px, y_px);
        let away = facet.met_by(camera.centre_m(), ray);
        let point_m = camera.centre_m() + away * ray;
        Hit { point_m, range_m: away * ray.length(), ray, normal: facet.cross_m2() }
    }

    /// How far a hit moves on its facet's plane if the ray moves by a pixel, along a line and from line to line, m.
    fn gsd_m(&self, hit: &Hit, site: &PixelSite) -> [f64; 2] {
        let away = hit.range_m / hit.ray.length();
        let [a, b, c, d] = site.corners();
        // Between the middles of opposite sides.
        let moved_m = |[from, to]: [[Point; 2]; 2]| {
            let middle =
                |side: [Point; 2]| self.camera.ray(0.5 * (side[0][0] + side[1][0]), 0.5 * (side[0][1] + side[1][1]));
            let way_m = away * (middle(to) - middle(from));
            let across_m = hit.normal.dot(way_m);
            // A facet that is seen edge on has no sampling across; along it nothing is divided by nothing.
            let along = if across_m == 0.0 { 0.0 } else { across_m / hit.normal.dot(hit.ray) };
            (way_m - hit.ray * along).length()
        };
        [[[a, d], [b, c]], [[a, b], [d, c]]].map(moved_m)
    }

    /// Puts names to the planes.
    pub(super) fn name(&self, values: Vec<Vec<f64>>, samples: usize, lines: usize) -> Backplanes {
        let fixed = KINDS.iter().map(|kind| (kind.name.to_owned(), kind.unit.to_owned()));
        let abundance = self
            .entries
            .iter()
            .flat_map(|entry| ["ABUNDANCE", "ABUNDANCE_LIT"].map(|kind| (format!("{kind} {entry}"), "1".to_string())));
        let globes = self.globes.iter().map(|name| (format!("{}{name}", Backplanes::GLOBE), "1".to_owned()));
        let named = fixed.chain(abundance).chain(globes).zip(values);
        let planes = named.map(|((name, unit), values)| Plane { name, unit, values }).collect();
        Backplanes { samples, lines, planes }
    }
}
