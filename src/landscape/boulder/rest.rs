//! How a boulder rests: upright on the ground's normal, and as deep in it as asked.

use glam::{DQuat, DVec3};

use super::Boulder;
use super::shape::{Ball, vertices_m};
use crate::landscape::sheet::Sheet;

/// A boulder in its place.
#[derive(Debug, Clone)]
pub(in crate::landscape) struct Rested {
    /// Its vertices, one for each of the ball's, m.
    pub(in crate::landscape) vertices_m: Vec<DVec3>,
    /// Where they lie on the map, m.
    pub(in crate::landscape) places_m: Vec<[f64; 2]>,
}

/// Puts a boulder on the ground.
///
/// Heights are measured along the ground's upright, from the facet below (or above) each vertex. From the lowest to the highest of them is the boulder's
/// height, which moving it up or down does not change: so one move puts as much of it below the ground as asked.
pub(in crate::landscape) fn rest(boulder: &Boulder, ball: &Ball, sheet: &Sheet) -> Rested {
    let normal = sheet.normal(boulder.x_m, boulder.y_m, 0.5 * boulder.diameter_m);
    let turn = DQuat::from_rotation_arc(DVec3::Z, normal);
    let foot_m = DVec3::new(boulder.x_m, boulder.y_m, sheet.height_m(boulder.x_m, boulder.y_m));
    let site_m: Vec<DVec3> =
        vertices_m(ball, boulder.shape, boulder.diameter_m, boulder.key).iter().map(|v| foot_m + turn * *v).collect();
    let (lowest_m, highest_m) = site_m
        .iter()
        .map(|&v| sheet.above_m(v))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), h| (lo.min(h), hi.max(h)));
    let move_m = DVec3::Z * (-lowest_m - boulder.buried * (highest_m - lowest_m));
    Rested {
        vertices_m: site_m.iter().map(|&v| sheet.placed_m(v + move_m)).collect(),
        places_m: site_m.iter().map(|v| [v.x, v.y]).collect(),
    }
}
