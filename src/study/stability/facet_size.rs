//! Facets much larger and much smaller than pixels.

use super::scenes::{above, by_rays, cells, exact, scene, sun, worst};
use super::{Hazard, Point, Sweep};
use crate::error::Result;

/// Pixels in a line and lines, strips across the image, and cells along each strip: from 10^4 pixels a facet to 10^4 facets a pixel.
const CASES: [(u32, u32, u32); 9] = [
    (100, 1, 1),
    (60, 3, 3),
    (40, 9, 9),
    (32, 22, 24),
    (16, 11, 12),
    (16, 36, 36),
    (8, 57, 57),
    (4, 90, 90),
    (4, 283, 283),
];

/// Mean reflectance over a pixel's columns of strips that are dark and bright in turn.
fn striped(strips: u32, [from, to]: [f64; 2]) -> f64 {
    let (from, to) = (from * f64::from(strips), to * f64::from(strips));
    let bright = |i: u32| {
        (to.min(f64::from(i) + 1.0) - from.max(f64::from(i))).max(0.0) * if i.is_multiple_of(2) { DARK } else { BRIGHT }
    };
    (0..strips).map(bright).sum::<f64>() / (to - from)
}

const DARK: f64 = 0.1;
const BRIGHT: f64 = 1.0;

pub(super) fn hazard() -> Result<Hazard> {
    let mut sweeps = [
        ("exact", true, "No size is special: sums of areas to rounding.", vec![]),
        (
            "16 rays per pixel",
            false,
            "A pixel's mean of many facets by few rays: aliasing where strips are near a pixel wide.",
            vec![],
        ),
    ];
    for (pixels, strips, along) in CASES {
        let ground = cells([-1.0; 2], [1.0; 2], [strips, along], |i, _| u16::from(i % 2 == 1));
        let scene = scene(ground, &[DARK, BRIGHT], sun(0.0, 0.0)?, above(1000.0, 2.0, pixels)?)?;
        let share = |i: u32| f64::from(i) / f64::from(pixels);
        let line: Vec<f64> = (0..pixels).map(|i| striped(strips, [share(i), share(i + 1)])).collect();
        let truth: Vec<f64> = (0..pixels).flat_map(|_| line.iter().copied()).collect();
        let at = f64::from(pixels * pixels) / f64::from(2 * strips * along);
        for (sweep, image) in sweeps.iter_mut().zip([exact(&scene)?, by_rays(&scene, 16)?]) {
            sweep.3.push(Point { at, error: worst(&image, &truth) });
        }
    }
    let sweeps =
        sweeps.into_iter().map(|(method, is_ours, then, points)| Sweep { method, is_ours, then, points }).collect();
    Ok(Hazard {
        name: "size of facets",
        parameter: "size of a facet, pixels",
        truth: "Level ground in dark and bright strips of cells; a pixel is the mean of the strips in it, which is known. Error of the worst pixel.",
        sweeps,
    })
}
