//! Texels of an image that show the scene in part, and sky beside it: whether what they hold is a mean over all of the texel.

use crate::geometry::Camera;
use crate::product::{Placement, SkyShare, ViewImage};

/// Texels around the scene that are less bright than this, over those of the scene, are dark: what a filter spreads there is less.
const DARK: f64 = 0.5;

/// Whether values of partly seen texels are means over all of the texel, so that they have to be divided by the share that is seen.
///
/// `seen` is that share, `values` a band's radiances: [texel]. Where it is not stated, the texels around the scene decide: if they are dark,
/// sky is in the means. If there are none with a value, as in DART's images, those at the rim tell, by how much darker they are than
/// what they border on. If that is not enough, a camera's image has sky in its means; a map of a plane, which may well be cut along the
/// scene, has not.
pub(super) fn is_in_means(sky: SkyShare, placement: &Placement, seen: &[f64], values: &[f64]) -> bool {
    let Placement::View(image) = placement else { return false };
    match sky {
        SkyShare::Included => return true,
        SkyShare::LeftOut => return false,
        SkyShare::Guessed => {}
    }
    let [columns, _] = image.size();
    let beside = |i: usize| {
        let column = i % columns;
        let left = (column > 0).then(|| seen[i - 1]);
        let right = (column + 1 < columns).then(|| seen[i + 1]);
        let above = i.checked_sub(columns).map(|i| seen[i]);
        let below = seen.get(i + columns).copied();
        seen[i] == 0.0 && [left, right, above, below].into_iter().flatten().any(|share| share > 0.0)
    };
    let mean = |wanted: &dyn Fn(usize) -> bool| {
        let values = (0..values.len()).filter(|i| !values[*i].is_nan() && wanted(*i)).map(|i| values[i]);
        let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
        if count > 0.0 { Some(sum / count) } else { None }
    };
    match (mean(&beside), mean(&|i| seen[i] > 0.5)) {
        (Some(around), Some(scene)) => around < DARK * scene,
        _ => is_dark_at_rim(columns, seen, values).unwrap_or(matches!(image.camera, Camera::Frame(_))),
    }
}

/// If less of an image's border than this is dark, that is not sky around a scene.
const LEAST_BORDER: f64 = 0.05;
/// Texels that are darker than this share of the mean of all are dark as the sky.
const DARK_AS_SKY: f64 = 1e-3;

/// Whether it is worth to find out in how much of each texel the scene is seen: sky around a scene reaches the border of its image, and
/// there is dark, or without a value.
pub(super) fn may_be_in_means(sky: SkyShare, image: &ViewImage, values: &[f64]) -> bool {
    match (sky, &image.camera) {
        (SkyShare::Included, _) | (SkyShare::Guessed, Camera::Frame(_)) => return true,
        (SkyShare::LeftOut, _) => return false,
        (SkyShare::Guessed, Camera::Parallel(_)) => {}
    }
    let [columns, rows] = image.size();
    if values.len() != columns * rows {
        return false;
    }
    let (sum, count) = values.iter().filter(|v| !v.is_nan()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    let is_dark = |i: usize| values[i].is_nan() || values[i] * count <= DARK_AS_SKY * sum;
    let sides = (0..rows).flat_map(|row| [row * columns, (row + 1) * columns - 1]);
    let border = (0..columns).chain((rows - 1) * columns..rows * columns).chain(sides);
    let (dark, all) = border.fold((0.0, 0.0), |(dark, all), i| (dark + f64::from(u8::from(is_dark(i))), all + 1.0));
    dark >= LEAST_BORDER * all
}

/// Fewer texels at the rim are not evidence.
const FEW: usize = 8;
/// Texels at the rim that show less or more of the scene than these tell little: what they would be either way is too much alike, or
/// too faint.
const TELLING: std::ops::Range<f64> = 0.1..0.9;
/// A texel at the rim that is brighter than this many times its neighbours counts as that: a glint must not outweigh the others.
const GLINT: f64 = 2.0;

/// Whether texels at the rim are darker than the whole ones beside them, by about the share that they show: nearer to that than to
/// as bright. `None` if there are too few.
fn is_dark_at_rim(columns: usize, seen: &[f64], values: &[f64]) -> Option<bool> {
    let rows = seen.len() / columns;
    let whole_beside = |i: usize| {
        let (row, column) = (i / columns, i % columns);
        let (mut sum, mut count) = (0.0, 0.0);
        for r in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
            for c in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                let j = r * columns + c;
                if seen[j] == 1.0 && values[j] > 0.0 {
                    (sum, count) = (sum + values[j], count + 1.0);
                }
            }
        }
        (count > 0.0).then(|| sum / count)
    };
    let at_rim = (0..seen.len()).filter(|i| TELLING.contains(&seen[*i]) && !values[*i].is_nan());
    let pairs: Vec<(f64, f64)> =
        at_rim.filter_map(|i| whole_beside(i).map(|whole| (seen[i], (values[i] / whole).min(GLINT)))).collect();
    let [shares, ratios] = [0, 1].map(|k| pairs.iter().map(|p| if k == 0 { p.0 } else { p.1 }).sum::<f64>());
    // Halfway between the shares and as bright.
    let halfway = 0.5 * (shares + pairs.len() as f64);
    (pairs.len() >= FEW).then_some(ratios < halfway)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Direction, FrameCamera, ParallelCamera, Pose};
    use crate::product::ViewImage;
    use glam::DVec3;

    fn image(camera: Camera) -> Placement {
        Placement::View(Box::new(ViewImage { camera, occlusion: true }))
    }

    fn eye() -> Placement {
        image(Camera::Frame(FrameCamera::centred(Pose::IDENTITY, 4, 1, 1.0)))
    }

    fn plane() -> Placement {
        let towards = Direction::new(DVec3::Z).unwrap();
        let (sample_per_m, line_per_m, origin_m) = (DVec3::X, DVec3::Y, DVec3::ZERO);
        image(Camera::Parallel(ParallelCamera {
            towards,
            samples: 4,
            lines: 1,
            sample_per_m,
            line_per_m,
            origin_m,
            origin_px: [0.0; 2],
        }))
    }

    #[test]
    fn where_nothing_lies_around_the_rim_tells() {
        // Two rows: a rim of half-seen texels above whole ones of various brightness.
        let columns = 12;
        let seen: Vec<f64> = (0..24).map(|i| if i < columns { 0.5 } else { 1.0 }).collect();
        let whole = |i: usize| 3.0 + (i % 5) as f64;
        for (share, is_dark) in [(0.5, true), (1.0, false), (0.62, true), (0.9, false)] {
            let values: Vec<f64> = (0..24).map(|i| if i < columns { share * whole(i) } else { whole(i) }).collect();
            assert_eq!(is_dark_at_rim(columns, &seen, &values), Some(is_dark), "{share}");
        }
        assert_eq!(is_dark_at_rim(2, &[0.5, 0.5, 1.0, 1.0], &[1.0; 4]), None);
    }

    #[test]
    fn what_lies_around_the_scene_tells() {
        let (eye, plane) = (eye(), plane());
        let seen = [0.0, 0.25, 1.0, 0.0];
        let nan = f64::NAN;
        for (values, of_eye, of_plane) in [
            ([0.0, 1.0, 4.0, 0.3], true, true),
            ([4.0, 4.0, 4.0, 3.0], false, false),
            ([nan, 4.0, 4.0, nan], true, false),
            // Dark all over: nothing to divide.
            ([0.0, 0.0, 0.0, 0.0], false, false),
        ] {
            assert_eq!(is_in_means(SkyShare::Guessed, &eye, &seen, &values), of_eye, "{values:?}");
            assert_eq!(is_in_means(SkyShare::Guessed, &plane, &seen, &values), of_plane, "{values:?}");
            assert!(is_in_means(SkyShare::Included, &plane, &seen, &values));
            assert!(!is_in_means(SkyShare::LeftOut, &eye, &seen, &values));
        }
        assert!(!is_in_means(SkyShare::Included, &Placement::Facets(4), &seen, &[1.0; 4]));
    }
}
