//! How much of each texel of an image shows the scene to the image's own eye: exactly, by the engine that looks at scenes.

use crate::error::Result;
use crate::geometry::{Camera, FrameCamera};
use crate::integrate::detector::draw;
use crate::integrate::pixel::Pixel;
use crate::integrate::sweep::{Line, sweep};
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
    const STAGE: &str = "outline of a map";
    if let Camera::Frame(camera) = &image.camera
        && camera.drawn().is_distorted()
    {
        return by_pixels(camera, scene, share, (STAGE, watch)).map(Some);
    }
    let Some((view, grid, is_mirrored)) = View::of_camera(&image.camera, scene.body.bounds_m()) else {
        return Ok(None);
    };
    let drawing = Drawing::new(&scene.body.mesh, scene.body.topology(), view, grid);
    let mut shares = covered(&drawing, STAGE, share, watch)?;
    if is_mirrored {
        shares = shares.chunks(image.size()[0]).rev().flatten().copied().collect();
    }
    Ok(Some(shares))
}

/// What `share` makes of the shares of outer and inner sides in each pixel of a camera whose pixels are not the cells of its drawing.
fn by_pixels(
    camera: &FrameCamera,
    scene: &Scene,
    share: impl Fn([f64; 2]) -> f64 + Sync + Send,
    stage: (&'static str, Watch<'_>),
) -> Result<Vec<f64>> {
    let (drawing, detector) = draw(&scene.body.mesh, scene.body.topology(), scene.body.bounds_m(), camera);
    let start = || Pixel::new(&drawing, vec![]);
    let look = |pixel: &mut Pixel, line: &mut Line, ()| {
        let mut shares = Vec::with_capacity(camera.samples as usize);
        line.each(
            pixel,
            |_| false,
            |pixel| {
                let side = |front: bool| pixel.entries.iter().filter(|e| e.front == front).map(|e| e.shown.area).sum();
                shares.push(share([side(true), side(false)].map(|share: f64| share.clamp(0.0, 1.0))));
            },
        )?;
        Ok(shares)
    };
    Ok(sweep((&drawing, &detector), vec![(); camera.lines as usize], stage, start, look)?.concat())
}
