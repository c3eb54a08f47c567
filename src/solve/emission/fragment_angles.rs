//! At which angles a fragment is lit and seen.

use glam::DVec3;

use super::light::{Fragment, SourceLight};
use crate::geometry::{Direction, Facet, FrameCamera, Mesh};
use crate::physics::mars::middle_above_horizon;
use crate::physics::reflectance::PhotometricAngles;
use crate::scene::{DirectionField, Scene, Sky, SunModel};
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
#[derive(Debug, Clone, Copy)]
enum Eye<'a> {
    /// By the pixels of an image.
    Camera(&'a FrameCamera),
    /// As whole facets.
    Observer(Observer),
}

/// Who looks at what.
#[derive(Debug, Clone, Copy)]
pub(super) struct FragmentAngles<'a> {
    eye: Eye<'a>,
    mesh: &'a Mesh,
    /// Whose globes are the sources in the near field.
    sky: &'a Sky,
    /// Of the Sun, the first source, if it is a disc: its distance, m.
    disc_distance_m: Option<f64>,
}

impl<'a> FragmentAngles<'a> {
    pub(super) fn of(scene: &'a Scene) -> Self {
        let disc_distance_m = (scene.models.sun != SunModel::Point).then_some(scene.sky.sun.distance_m);
        let eye = Eye::Camera(&scene.exposure.camera);
        FragmentAngles { eye, mesh: &scene.body.mesh, sky: &scene.sky, disc_distance_m }
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
        let to_viewer = match self.eye {
            Eye::Camera(camera) => -camera.ray(x_px, y_px).normalize_or_zero(),
            Eye::Observer(observer) => observer.seen_from(&facet),
        };
        (facet.cross_m2().normalize_or_zero().dot(to_viewer), to_viewer)
    }

    /// The angle that a pixel's diagonal takes at most, rad.
    pub(super) fn pixel_rad(&self) -> f64 {
        let Eye::Camera(camera) = self.eye else { return 0.0 };
        let [across, down] = camera.pitch;
        (across * across + down * down).sqrt().min(std::f64::consts::PI)
    }

    /// The angles at the centroid of what a source lights of a fragment; of a source in the near field, and of the Sun's disc, to the
    /// middle of what of it is above the facet's horizon.
    pub(super) fn angles(&self, fragment: &Fragment, light: &SourceLight, field: DirectionField) -> PhotometricAngles {
        let facet = self.mesh.facet(fragment.facet as usize);
        let normal = facet.cross_m2().normalize_or_zero();
        let (to_viewer, seen_along) = match self.eye {
            Eye::Camera(camera) => {
                let [x_px, y_px] = light.centroid_px(fragment);
                let ray = camera.ray(x_px, y_px);
                (-ray.normalize_or_zero(), Some((camera.centre_m(), ray)))
            }
            Eye::Observer(observer) => (observer.seen_from(&facet), None),
        };
        let to_source = match field {
            DirectionField::Afar(direction) => match self.disc_distance_m.filter(|_| light.is_first) {
                None => direction.vec(),
                Some(distance_m) => middle_above_horizon(normal, distance_m * direction.vec(), SUN_RADIUS_M),
            },
            DirectionField::Near(centre_m) => {
                let met_m = |(eye_m, ray)| eye_m + facet.met_by(eye_m, ray) * ray;
                let towards = field.towards(seen_along.map_or_else(|| facet.centroid_m(), met_m));
                // Where a facet is edge-on, rays meet it anywhere.
                let towards = if towards.is_finite() { towards } else { field.towards(facet.centroid_m()) };
                let radius_m =
                    self.sky.globes().find(|globe| globe.centre_m == centre_m).map_or(0.0, |globe| globe.radius_m);
                middle_above_horizon(normal, towards, radius_m)
            }
        };
        PhotometricAngles::of_directions(normal, to_source, to_viewer)
    }
}
