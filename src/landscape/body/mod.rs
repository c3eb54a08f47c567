//! A site on a body: where the target is, which way its axes point, and where each of its places lies.
//!
//! Places of the site are directions from a centre below the target: (x, y) is the direction at the angle 2 asin(rho / 2 R) from the upright, rho = |(x, y)|,
//! which is Lambert's azimuthal equal-area projection of a sphere of radius R (J. P. Snyder 1987, "Map projections", USGS Prof. Paper 1395, equations
//! 24-3 and 24-4). The sphere touches the surface at the target: its centre lies on the normal there, at the point nearest to the body's centre. A place's
//! foot is where its direction meets the body, and heights go along the body's normal at the foot.

mod ellipsoid;
mod phobos;
mod projection;
mod report;
mod smooth;
mod split;

use glam::DVec3;
use rayon::prelude::*;

use super::check::at;
use super::noise::smooth_step;
use super::recipe::{BodyRecipe, Height, Recipe, ShapeName};
use super::sources::Sources;
use crate::error::{Error, Problem, Result, number};
use crate::geometry::{Mesh, body_from_site, direction_of_deg, planetocentric_deg};
use ellipsoid::Ellipsoid;
use phobos::Phobos;
use projection::Projection;
use smooth::Smooth;

pub use report::WrapReport;

/// From this share of the surroundings' reach on relief fades away.
const FADE: f64 = 0.6;

/// A direction whose angle with the upright has no larger sine says nothing of azimuths.
const STRAIGHT_UP: f64 = 1e-6;

/// No place of a site is farther around its body than this, rad: beyond it directions crowd.
const FARTHEST_RAD: f64 = 2.6;

/// A body's surface, as seen from points within it.
#[derive(Debug, Clone)]
enum Surface {
    Ellipsoid(Ellipsoid),
    Phobos(Phobos),
    Smooth(Smooth),
}

/// A site on a body.
#[derive(Debug, Clone)]
pub(super) struct Wrap {
    /// Where the target is, body axes, m: what the mesh's coordinates are relative to.
    pub(super) origin_m: DVec3,
    projection: Projection,
    surface: Surface,
    /// What the surface is moved by, so that it goes through the target, m.
    moved_m: DVec3,
    /// Half sides of the site and of the whole mesh, m.
    site_m: f64,
    end_m: f64,
    report: WrapReport,
}

/// Where the built-in Phobos has its surface in directions from its centre, m, to 0.1 mm.
pub(super) fn of_phobos_m(towards: &[DVec3]) -> Vec<DVec3> {
    let phobos = Phobos::new(DVec3::ZERO);
    let point_m = |towards: &DVec3| {
        // From within it every ray leaves it.
        let (point_m, _) = phobos.hit(DVec3::ZERO, *towards).unwrap_or_default();
        (1e4 * point_m).round() / 1e4
    };
    towards.par_iter().map(point_m).collect()
}

/// A target farther above or below its ground than this share of its distance from the centre is none of this body.
const MOST_OFF: f64 = 0.25;

impl Wrap {
    /// # Errors
    /// [`Error::Invalid`]: a target that misses the body, a shape with holes or folds where the site lies, surroundings that reach around it.
    pub(super) fn new(body: &BodyRecipe, recipe: &Recipe, sources: &Sources) -> Result<Self> {
        let invalid = |problem: Problem| Error::Invalid(vec![problem]);
        let offset_m = DVec3::from_array(body.offset_m.unwrap_or_default());
        let towards = body.towards();
        // The surface's point on the line from the body's centre to the target, and its normal there.
        let (exact, meshes) = match (&body.shape, &body.ellipsoid_m, &body.files) {
            (Some(ShapeName::Phobos), None, None) => (Some(Surface::Phobos(Phobos::new(offset_m))), vec![]),
            (None, Some(axes_m), None) => (Some(Surface::Ellipsoid(Ellipsoid::new(*axes_m, offset_m))), vec![]),
            (None, None, Some(names)) => (None, self::meshes(names, sources, offset_m)?),
            _ => return Err(invalid(at("body", "give one of `shape`, `ellipsoid_m` and `files`"))),
        };
        let hit = match &exact {
            Some(Surface::Ellipsoid(ellipsoid)) => ellipsoid.hit(DVec3::ZERO, towards),
            Some(Surface::Phobos(phobos)) => phobos.hit(DVec3::ZERO, towards),
            _ => smooth::hit(&meshes, towards),
        };
        let Some((ground_m, normal)) = hit else {
            let [latitude_deg, longitude_deg] = planetocentric_deg(towards);
            let message = format!(
                "the line from the body's centre to the target (latitude {}, longitude {} deg) meets no surface, or more than one",
                number(latitude_deg),
                number(longitude_deg)
            );
            return Err(invalid(
                at(body.target_key(), message)
                    .with_help("is the shape open, or inside out, or its centre not within it? `mmxrt inspect` of the shape says it; `mmxrt convert IN OUT --outward` turns facets, `offset_m` moves it"),
            ));
        };
        let depth_m = ground_m.dot(normal);
        if depth_m <= 0.0 {
            let message = "the ground at the target faces the body's centre: there is no upright";
            return Err(invalid(at(body.target_key(), message)));
        }
        if depth_m < recipe.size_m {
            let message =
                format!("the body is {} m thick under a site of {} m", number(depth_m), number(recipe.size_m));
            // Of a shape in km that is taken for m, the body is a thousand times too small.
            let help = match depth_m < 0.1 * recipe.size_m {
                true => "is the shape in km? `unit_m = 1000.0`",
                false => "a site is bent onto ground that goes on around it: make `size_m` smaller",
            };
            return Err(invalid(at("body", message).with_help(help)));
        }
        let target_m = body.target_m.map_or(ground_m, DVec3::from_array);
        // Nobody means a target a thousand times nearer to the centre than the ground.
        let is_km = |target_m: DVec3| (0.5..2.0).contains(&(1000.0 * target_m.length() / ground_m.length()));
        if is_km(target_m) {
            let message = format!(
                "the target is {} m from the body's centre, its ground {} m",
                number(target_m.length()),
                number(ground_m.length())
            );
            return Err(invalid(at(body.target_key(), message).with_help("targets are in m: is it in km?")));
        }
        let off_m = target_m.length() - ground_m.length();
        if off_m.abs() > MOST_OFF * ground_m.length() {
            let message = format!(
                "the target is {} m from the body's centre, and its ground {} m: it misses the body",
                number(target_m.length()),
                number(ground_m.length())
            );
            let help = "targets are points of the ground, m from the body's centre; `lonlat_deg` needs no distance";
            return Err(invalid(at(body.target_key(), message).with_help(help)));
        }
        let Some(axes) = body.axes(normal) else {
            let message = "it points straight up or down at the target: it says nothing of where the site points";
            return Err(invalid(at("body.along", message)));
        };
        let projection = Projection::new(ground_m, normal, depth_m, axes);
        let reach_m = recipe.surroundings.as_ref().map_or(0.0, |s| s.reach_m);
        let (site_m, end_m) = (0.5 * recipe.size_m, 0.5 * recipe.size_m + reach_m);
        // Boulders may stand out a little.
        let corner_m = 1.01 * end_m * 2f64.sqrt();
        if projection.angle(corner_m).is_none_or(|angle| angle > FARTHEST_RAD) {
            let most_m = 2.0 * depth_m * (0.5 * FARTHEST_RAD).sin() / 2f64.sqrt() / 1.01 - site_m;
            let message =
                format!("the mesh's corners are {} m from the target: too far around the body", number(corner_m));
            let help = format!("the surroundings may reach {:.0} m", most_m.max(0.0));
            return Err(invalid(
                at(if reach_m > 0.0 { "surroundings.reach_m" } else { "size_m" }, message).with_help(help),
            ));
        }
        let surface = match exact {
            Some(surface) => surface,
            None => Surface::Smooth(
                Smooth::new(&meshes, &projection, corner_m).map_err(|message| invalid(at("body.files", message)))?,
            ),
        };
        let mut wrap = Wrap {
            origin_m: ground_m,
            projection,
            surface,
            moved_m: DVec3::ZERO,
            site_m,
            end_m,
            report: WrapReport::default(),
        };
        let Some((foot_m, _)) = wrap.surface_at(0.0, 0.0) else {
            return Err(invalid(at(
                body.target_key(),
                "the body has no surface at the target, or several over one another",
            )));
        };
        let on_body = body.lonlat_deg.is_some() || body.height == Some(Height::Body);
        wrap.origin_m = if on_body { foot_m } else { target_m };
        wrap.moved_m = wrap.origin_m - foot_m;
        wrap.report = report::report(&wrap, target_m, ground_m, foot_m);
        Ok(wrap)
    }

    /// Foot and normal at a place of the site before the body is moved; none where the body has no surface, or several over one another.
    fn surface_at(&self, x_m: f64, y_m: f64) -> Option<(DVec3, DVec3)> {
        let direction = self.projection.direction(x_m, y_m);
        let centre_m = self.projection.centre_m;
        match &self.surface {
            Surface::Ellipsoid(ellipsoid) => ellipsoid.hit(centre_m, direction),
            Surface::Phobos(phobos) => phobos.hit(centre_m, direction),
            Surface::Smooth(smooth) => smooth.at(&self.projection, x_m, y_m),
        }
    }

    /// Foot of a place of the site, relative to [`origin_m`](Self::origin_m), body axes, m, and the body's unit normal there; NaN where the body has no
    /// surface, or several over one another.
    pub(super) fn foot(&self, x_m: f64, y_m: f64) -> (DVec3, DVec3) {
        let (foot_m, normal) = self.surface_at(x_m, y_m).unwrap_or((DVec3::NAN, DVec3::NAN));
        (foot_m + self.moved_m - self.origin_m, normal)
    }

    /// Whether a facet, relative to [`origin_m`](Self::origin_m), faces away from the centre that places are directions from: on the map all do.
    pub(super) fn faces_outward(&self, [a_m, b_m, c_m]: [DVec3; 3]) -> bool {
        let from_centre_m = a_m + self.origin_m - self.moved_m - self.projection.centre_m;
        from_centre_m.dot((b_m - a_m).cross(c_m - a_m)) > 0.0
    }

    /// The share of relief at a place: 1 on the site and near it, 0 where the surroundings end.
    pub(super) fn relief(&self, x_m: f64, y_m: f64) -> f64 {
        let half_m = x_m.abs().max(y_m.abs());
        if self.end_m <= self.site_m {
            return 1.0;
        }
        let t = ((half_m - self.site_m) / (self.end_m - self.site_m) - FADE) / (1.0 - FADE);
        let t = (1.0 - t).clamp(0.0, 1.0);
        smooth_step(t)
    }

    /// What the wrap did.
    pub(super) fn report(&self) -> WrapReport {
        self.report
    }
}

impl BodyRecipe {
    /// From the body's centre to the target: unit vector.
    fn towards(&self) -> DVec3 {
        let [longitude_deg, latitude_deg] = self.lonlat_deg.unwrap_or_default();
        let by_angles = || direction_of_deg([latitude_deg, longitude_deg]);
        self.target_m.map_or_else(by_angles, DVec3::from_array).normalize_or_zero()
    }

    fn target_key(&self) -> &'static str {
        if self.target_m.is_some() { "body.target_m" } else { "body.lonlat_deg" }
    }

    /// The site's x and y axes, body axes: unit vectors at right angles to the upright; none if the direction they are given by is upright itself.
    fn axes(&self, up: DVec3) -> Option<[DVec3; 2]> {
        let (east, north) = body_from_site(up).map_or((DVec3::X, DVec3::Y), |axes| (axes.x_axis, axes.y_axis));
        let (sin, cos) = self.azimuth_deg.unwrap_or(0.0).to_radians().sin_cos();
        let y = match self.along.map(DVec3::from_array) {
            None => cos * north + sin * east,
            Some(along) => {
                // Of any length.
                let along = (along / along.abs().max_element()).normalize();
                let level = along.reject_from_normalized(up);
                level.try_normalize().filter(|_| level.length() > STRAIGHT_UP)?
            }
        };
        Some([y.cross(up), y])
    }
}

/// The meshes of a body, moved by its offset, m.
fn meshes(names: &[String], sources: &Sources, offset_m: DVec3) -> Result<Vec<Mesh>> {
    let mut meshes = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let Some(mesh) = sources.meshes.get(name) else {
            return Err(Error::Invalid(vec![at(&format!("body.files[{i}]"), format!("{name} has not been read"))]));
        };
        // A mesh that covers everything would hide those before it.
        if i > 0 && mesh.enclosed_m3().is_some() {
            let message = format!("{name} is closed: those before it would not count");
            let problem = at(&format!("body.files[{i}]"), message).with_help("the coarsest is named first");
            return Err(Error::Invalid(vec![problem]));
        }
        let mut mesh = mesh.clone();
        mesh.vertices_m.iter_mut().for_each(|v| *v += offset_m);
        meshes.push(mesh);
    }
    Ok(meshes)
}
