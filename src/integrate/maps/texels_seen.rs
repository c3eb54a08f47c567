//! How much of each texel of an image shows the scene to the image's own eye: exactly, by the engine that looks at scenes.

use crate::error::Result;
use crate::product::ViewImage;
use crate::progress::Watch;
use crate::scene::Scene;
use crate::visibility::{Drawing, View, covered};

/// Less of a texel than this is what rounding leaves where nothing is seen, or everything.
const ROUNDING: f64 = 1e-12;

/// For each texel, line by line, the share of it that shows the scene: outer sides, or any side if the image goes through everything.
/// Exactly 0 or 1 where it is that but for rounding. `None` if the image cannot be drawn.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn texels_seen(image: &ViewImage, scene: &Scene, watch: Watch<'_>) -> Result<Option<Vec<f64>>> {
    let Some((view, grid, is_mirrored)) = View::of_camera(&image.camera, scene.body.bounds_m()) else {
        return Ok(None);
    };
    let drawing = Drawing::new(&scene.body.mesh, scene.body.topology(), view, grid);
    let share = |[outer, inner]: [f64; 2]| {
        let share = if image.occlusion { outer } else { outer + inner };
        if share < ROUNDING {
            0.0
        } else if share > 1.0 - ROUNDING {
            1.0
        } else {
            share
        }
    };
    let mut shares = covered(&drawing, "outline of a map", share, watch)?;
    if is_mirrored {
        shares = shares.chunks(image.size()[0]).rev().flatten().copied().collect();
    }
    Ok(Some(shares))
}
