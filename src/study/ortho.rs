//! Orthorectification: the exact overlap of pixels and map cells, and so each cell's value.

use crate::error::{Error, Location, Result};
use crate::geometry::polygon::{Point, Rect};
use crate::geometry::{body_from_site, index_u32, whole};
use crate::integrate::{GroundPiece, ground_pieces};
use crate::product::{CellPart, MapGrid, Projection};
use crate::progress::Watch;
use crate::scene::{Motion, Readout, Scene, Timing};

/// Largest number of cells.
const MOST_CELLS: f64 = (1_u64 << 26) as f64;

/// Borders that are this part of a cell off whole cells are so by rounding.
const PART_OF_CELL: f64 = 1e-6;

/// A requested map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapWish {
    /// Longitudes and latitudes, deg; else the tangent plane at the scene's origin, m.
    pub plate_carree: bool,
    /// Cell size, in that unit.
    pub cell: f64,
    /// West, south, east and north borders, in that unit; `None`: the image's extent, rounded outwards to whole cells.
    pub borders: Option<[f64; 4]>,
}

/// The scenes of an image in a band, from 0, each with its first sample and line: for a push-broom one for each line, for a whisk-broom for each sample of a sweep, else one.
fn looks(scene: &Scene, motion: Option<(&Motion, Timing)>, band: usize) -> Result<Vec<(Scene, [u32; 2])>> {
    let Some((motion, timing)) = motion.filter(|(_, timing)| timing.is_in_parts()) else {
        return Ok(vec![(scene.clone(), [0, 0])]);
    };
    let of_band = |bands: &std::ops::Range<usize>| timing.readout != Readout::Band || bands.contains(&band);
    let takes = timing.takes(&scene.exposure).filter(|take| of_band(&take.bands));
    takes
        .map(|take| {
            let epoch = motion.start.after_s(take.middle_s);
            let mut exposure = take.exposure(&scene.exposure);
            exposure.camera.world_from_sensor = take.pose(motion.pose(epoch)?, take.middle_s);
            let then = motion.at(scene, exposure.clone(), epoch)?.seen_by(exposure)?;
            Ok((then, [take.samples.start, take.lines.start].map(index_u32)))
        })
        .collect()
}

/// The grid of a map.
fn grid(scene: &Scene, looks: &[(Scene, [u32; 2])], wish: MapWish, watch: Watch<'_>) -> Result<MapGrid> {
    let origin_m = scene.body.origin_m;
    let refused = |message: &str| Err(Error::invalid(Location::item("--ortho"), message.to_owned()));
    let projection = if wish.plate_carree {
        let eye_m = scene.exposure.camera.centre_m() + origin_m;
        Projection::PlateCarree { middle_deg: eye_m.y.atan2(eye_m.x).to_degrees() }
    } else {
        let Some(axes) = body_from_site(origin_m) else {
            return refused("the tangent plane is undefined at the body's centre (`origin_m`): use plate-carree");
        };
        Projection::Tangent { origin_m, axes }
    };
    let [west, south, east, north] = match wish.borders {
        Some(borders) => borders,
        None => {
            let mut bounds: Option<Rect> = None;
            for (then, _) in looks {
                let put = |bounds: &mut Option<Rect>, piece: GroundPiece<'_>| {
                    let points = projection.at(piece.outline_m.iter().map(|p| *p + origin_m));
                    *bounds = Some(joined(*bounds, &points));
                };
                let lines = ground_pieces(then, watch, || None, put)?;
                for rect in lines.into_iter().flatten() {
                    bounds = Some(joined(bounds, &rect.corners()));
                }
            }
            let Some(Rect { min, max }) = bounds else { return refused("the image shows no ground") };
            let out = |x: f64, round: fn(f64) -> f64| round(x / wish.cell) * wish.cell;
            [out(min[0], f64::floor), out(min[1], f64::floor), out(max[0], f64::ceil), out(max[1], f64::ceil)]
        }
    };
    let (columns, rows) = (((east - west) / wish.cell).round(), ((north - south) / wish.cell).round());
    if !(columns >= 1.0 && rows >= 1.0) {
        return refused("borders must be west, south, east, north, at least one cell apart");
    }
    let is_whole = |extent: f64, cells: f64| (extent / wish.cell - cells).abs() <= PART_OF_CELL;
    if !is_whole(east - west, columns) || !is_whole(north - south, rows) {
        let (east, north) = (west + columns * wish.cell, south + rows * wish.cell);
        return refused(&format!(
            "from border to border there are whole cells of {}: with {columns} x {rows} of them the borders are {west}, {south}, {east} and {north}",
            wish.cell
        ));
    }
    if columns * rows > MOST_CELLS {
        return refused(&format!("{columns} x {rows} cells are too many: take larger ones, or state borders"));
    }
    Ok(MapGrid { projection, west_north: [west, north], cell: wish.cell, columns: whole(columns), rows: whole(rows) })
}

fn joined(bounds: Option<Rect>, points: &[Point]) -> Rect {
    let of = Rect::of(points);
    bounds.map_or(of, |Rect { min, max }| Rect {
        min: [0, 1].map(|k| min[k].min(of.min[k])),
        max: [0, 1].map(|k| max[k].max(of.max[k])),
    })
}

/// The grid of a map of an image in a band, from 0, and the area of each pixel in each cell: by pixel, cells ascending.
///
/// # Errors
/// [`Error::Invalid`] if no such map can be made, or where something is, is not known; [`Error::Interrupted`] if `watch` asks to stop.
pub fn ortho(
    scene: &Scene,
    motion: Option<(&Motion, Timing)>,
    band: usize,
    wish: MapWish,
    watch: Watch<'_>,
) -> Result<(MapGrid, Vec<CellPart>)> {
    let looks = looks(scene, motion, band)?;
    let grid = grid(scene, &looks, wish, watch)?;
    let origin_m = scene.body.origin_m;
    let mut parts = Vec::new();
    for (then, [left, top]) in &looks {
        let put = |line: &mut Vec<CellPart>, piece: GroundPiece<'_>| {
            let outline = grid.projection.at(piece.outline_m.iter().map(|p| *p + origin_m));
            grid.fill(&outline, |cell, area| {
                line.push(CellPart {
                    cell,
                    sample: left + piece.sample,
                    line: top + piece.line,
                    area: piece.sign * area,
                });
            });
        };
        for mut line in ground_pieces(then, watch, Vec::new, put)? {
            // Stable: parts of a cell are added in order of arrival.
            line.sort_by_key(|part| (part.sample, part.cell));
            for part in line {
                match parts.last_mut() {
                    Some(CellPart { cell, sample, line, area })
                        if (*cell, *sample, *line) == (part.cell, part.sample, part.line) =>
                    {
                        *area += part.area;
                    }
                    _ => parts.push(part),
                }
            }
        }
    }
    // If one part hides another completely, rounding may leave a negative area.
    parts.retain(|part| part.area > 0.0);
    Ok((grid, parts))
}
