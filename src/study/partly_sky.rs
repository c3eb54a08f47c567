//! Texels of an image that show the scene in part, and sky beside it: whether what they hold is a mean over all of the texel.

use crate::product::{Eye, Placement, Sky};

/// Texels around the scene that are less bright than this, over those of the scene, are dark: what a filter spreads there is less.
const DARK: f64 = 0.5;

/// Whether values of partly seen texels are means over all of the texel, so that they have to be divided by the share that is seen.
///
/// `seen` is that share, `values` a band's radiances: [texel]. Where nobody says it the texels around the scene tell: if they are dark,
/// sky is in the means. If there are none with a value, a camera's image has sky in its means; a map of a plane, which may well be
/// cut along the scene, has not.
pub(super) fn is_in_means(sky: Sky, placement: &Placement, seen: &[f64], values: &[f64]) -> bool {
    let Placement::View(image) = placement else { return false };
    match sky {
        Sky::Included => return true,
        Sky::LeftOut => return false,
        Sky::Guessed => {}
    }
    let columns = image.columns;
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
        _ => matches!(image.eye, Eye::At(_)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Direction;
    use crate::product::{Projection, ViewImage};
    use glam::DVec3;

    fn image(eye: Eye) -> Placement {
        let projection = Projection::parallel(DVec3::X, DVec3::Y, DVec3::ZERO, [0.0; 2]);
        Placement::View(Box::new(ViewImage { projection, eye, rows: 1, columns: 4, occlusion: true }))
    }

    #[test]
    fn what_lies_around_the_scene_tells() {
        let (eye, plane) = (image(Eye::At(DVec3::ZERO)), image(Eye::Towards(Direction::new(DVec3::Z).unwrap())));
        let seen = [0.0, 0.25, 1.0, 0.0];
        let nan = f64::NAN;
        for (values, of_eye, of_plane) in [
            ([0.0, 1.0, 4.0, 0.3], true, true),
            ([4.0, 4.0, 4.0, 3.0], false, false),
            ([nan, 4.0, 4.0, nan], true, false),
            // Dark all over: nothing to divide.
            ([0.0, 0.0, 0.0, 0.0], false, false),
        ] {
            assert_eq!(is_in_means(Sky::Guessed, &eye, &seen, &values), of_eye, "{values:?}");
            assert_eq!(is_in_means(Sky::Guessed, &plane, &seen, &values), of_plane, "{values:?}");
            assert!(is_in_means(Sky::Included, &plane, &seen, &values));
            assert!(!is_in_means(Sky::LeftOut, &eye, &seen, &values));
        }
        assert!(!is_in_means(Sky::Included, &Placement::Facets(4), &seen, &[1.0; 4]));
    }
}
