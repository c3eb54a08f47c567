//! At which angles a fragment is lit and seen.

use glam::DVec3;

use super::light::{Angles, Fragment, SourceLight};
use crate::geometry::{Direction, Facet, FrameCamera, Mesh};
use crate::physics::mars::middle_above_horizon;
use crate::physics::mars_directions::{Directions, SphereSeen, Towards};
use crate::physics::reflectance::PhotometricAngles;
use crate::scene::{DirectionField, Globe, MarsModel, Scene, Sky, Source, SourceKind, SunModel};
use crate::units::SUN_RADIUS_M;

/// Who looks at whole facets, from their centroids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Observer {
    /// At a place, local to the scene's origin, m.
    At(DVec3),
    /// So far away that it is in the same direction from everywhere.
    Towards(Direction),
}

impl Observer {
    /// The direction to it from a facet.
    pub(in crate::solve) fn seen_from(self, facet: &Facet) -> DVec3 {
        match self {
            Observer::At(place_m) => (place_m - facet.centroid_m()).normalize_or_zero(),
            Observer::Towards(direction) => direction.vec(),
        }
    }
}

/// From where fragments are seen.
#[derive(Debug, Clone)]
enum Eye {
    /// By the cells of a drawing.
    Camera(FrameCamera),
    /// As whole facets.
    Observer(Observer),
}

/// Who looks at what.
#[derive(Debug, Clone)]
pub(super) struct FragmentAngles<'a> {
    eye: Eye,
    mesh: &'a Mesh,
    /// Of each source, if it is a sphere in the near field.
    spheres: Vec<Option<Sphere<'a>>>,
    /// Of the Sun, the first source, if it is a disc: its distance, m.
    disc_distance_m: Option<f64>,
}

/// A source whose light comes from many directions.
#[derive(Debug, Clone)]
struct Sphere<'a> {
    globe: &'a Globe,
    /// Towards the Sun that lights it; `None`: all of it is as bright.
    sun: Option<DVec3>,
    directions: Directions,
}

impl<'a> Sphere<'a> {
    fn of(scene: &Scene, source: &Source<'a>) -> Option<Self> {
        let (globe, is_lit) = match source.kind {
            // That of the thesis has no phase.
            SourceKind::Sphere(globe) => {
                (globe, globe.name != Sky::MARS || scene.models.mars_light != MarsModel::Thesis)
            }
            SourceKind::Glow(globe) => (globe, false),
            SourceKind::Beam(_) => return None,
        };
        let (low_m, high_m) = scene.body.bounds_m().unwrap_or_default();
        let nearest_m = (globe.centre_m - globe.centre_m.clamp(low_m, high_m)).length();
        Some(Sphere {
            globe,
            sun: is_lit.then(|| scene.sky.sun_on(globe).direction.vec()),
            directions: Directions::for_size(globe.radius_m / nearest_m),
        })
    }
}

impl<'a> FragmentAngles<'a> {
    pub(super) fn of(scene: &'a Scene) -> Self {
        let disc_distance_m = (scene.models.sun != SunModel::Point).then_some(scene.sky.sun.distance_m);
        let eye = Eye::Camera(scene.exposure.camera.drawn().pinhole);
        let mesh = &scene.body.mesh;
        let sphere = |source: &Source<'a>| Sphere::of(scene, source);
        FragmentAngles { eye, mesh, spheres: scene.sources().iter().map(sphere).collect(), disc_distance_m }
    }

    /// The same of whole facets that another observer sees.
    pub(super) fn seen_by(self, observer: Observer) -> Self {
        FragmentAngles { eye: Eye::Observer(observer), ..self }
    }

    /// Cosine of emission at the centroid of all that is seen of a fragment.
    pub(super) fn cos_emission(&self, fragment: &Fragment) -> f64 {
        self.view(fragment).0
    }

    /// Cosine of emission there, and the direction to the viewer.
    pub(super) fn view(&self, fragment: &Fragment) -> (f64, DVec3) {
        let facet = self.mesh.facet(fragment.facet as usize);
        let [x_px, y_px] = fragment.shown.centroid_px().unwrap_or_default();
        let to_viewer = match &self.eye {
            Eye::Camera(camera) => -camera.ray(x_px, y_px).normalize_or_zero(),
            Eye::Observer(observer) => observer.seen_from(&facet),
        };
        (facet.cross_m2().normalize_or_zero().dot(to_viewer), to_viewer)
    }

    /// The angle that a pixel's diagonal takes at most, rad.
    pub(super) fn pixel_rad(&self) -> f64 {
        let Eye::Camera(camera) = &self.eye else { return 0.0 };
        let [across, down] = camera.pitch;
        (across * across + down * down).sqrt().min(std::f64::consts::PI)
    }

    /// Angular radius of a source as it is seen from a place, local, m: its sine.
    pub(super) fn sin_radius(&self, light: &SourceLight, place_m: DVec3) -> f64 {
        self.sphere(light).map_or(0.0, |of| (of.globe.radius_m / (of.globe.centre_m - place_m).length()).min(1.0))
    }

    fn sphere(&self, light: &SourceLight) -> Option<&Sphere<'a>> {
        self.spheres.get(light.source?)?.as_ref()
    }

    /// Hands over the angles at the centroid of what a source lights of a fragment, each with the share of the irradiance that has them: of the Sun's disc, to the
    /// middle of what of it is above the facet's horizon; of a sphere in the near field, several.
    pub(super) fn each(
        &self,
        fragment: &Fragment,
        light: &SourceLight,
        field: DirectionField,
        put: &mut dyn FnMut(f64, Angles),
    ) {
        let facet = self.mesh.facet(fragment.facet as usize);
        let normal = facet.cross_m2().normalize_or_zero();
        let (to_viewer, seen_along) = match &self.eye {
            Eye::Camera(camera) => {
                let [x_px, y_px] = light.centroid_px(fragment);
                let ray = camera.ray(x_px, y_px);
                (-ray.normalize_or_zero(), Some((camera.centre_m(), ray)))
            }
            Eye::Observer(observer) => (observer.seen_from(&facet), None),
        };
        let mut one = |share: f64, to_source: DVec3| {
            put(share, Angles::Of(PhotometricAngles::of_directions(normal, to_source, to_viewer)));
        };
        match field {
            DirectionField::Afar(direction) => match self.disc_distance_m.filter(|_| light.source == Some(0)) {
                None => one(1.0, direction.vec()),
                Some(distance_m) => {
                    one(1.0, middle_above_horizon(normal, distance_m * direction.vec(), SUN_RADIUS_M));
                }
            },
            DirectionField::Near(_) => {
                let met_m = |(eye_m, ray)| eye_m + facet.met_by(eye_m, ray) * ray;
                let towards = field.towards(seen_along.map_or_else(|| facet.centroid_m(), met_m));
                // Where a facet is edge-on, rays meet it anywhere.
                let to_centre_m = if towards.is_finite() { towards } else { field.towards(facet.centroid_m()) };
                match self.sphere(light) {
                    None => one(1.0, to_centre_m.normalize_or_zero()),
                    Some(Sphere { globe, sun, directions }) => {
                        let seen = SphereSeen { to_centre_m, radius_m: globe.radius_m, normal, sun: *sun };
                        let all = directions.of(&seen, Some(to_viewer));
                        all.into_iter().for_each(|Towards { direction, share }| one(share, direction));
                    }
                }
            }
        }
    }
}
