//! Smile and keystone in push-broom lines: smile shifts a band's centre per sample, keystone shifts a band along the
//! slit.
//!
//! The line is rendered exactly with a few shifts of both; radiance is interpolated between them: linearly over
//! keystone, by the parabola through three over smile. Each rendering is a slab of its own, with weights by sample and
//! spectra by band.

use crate::error::Result;
use crate::integrate::{self, Wanted};
use crate::product::{FacetTable, Slab};
use crate::progress::Watch;
use crate::scene::{Exposure, Scene};

/// Renderings per pixel of keystone: at an edge the error is at most a quarter of their distance times the contrast.
const LOOKS_A_PIXEL: f64 = 32.0;
/// Up to this many different keystones are rendered one by one.
const FEW: u32 = 16;

/// Shifts with which an image is rendered, and their weights.
pub(super) struct Looks {
    /// Smile, um, and its share in each sample.
    pub(super) smiles: Vec<(f64, Vec<f64>)>,
    /// Keystone, pixels, and its share in each band.
    pub(super) keystones: Vec<(f64, Vec<f64>)>,
}

impl Looks {
    /// Those of an exposure.
    pub(super) fn of(exposure: &Exposure) -> Self {
        let Exposure { camera, bands, spectrometer, .. } = exposure;
        let pairs = |(shifts, shares): (Vec<f64>, Vec<Vec<f64>>)| shifts.into_iter().zip(shares).collect();
        Looks {
            smiles: pairs(parabolas(&spectrometer.smiles_um(camera.samples))),
            keystones: pairs(hats(&spectrometer.keystones_px(bands))),
        }
    }
}

/// The radiance of a scene's image with one smile, um, in all samples and one keystone, pixels of its camera, in all bands.
///
/// # Errors
/// As [`integrate`](integrate::integrate), and as [`Scene::seen_by`] for shifted bands.
pub(super) fn look(
    scene: &Scene,
    (smile_um, keystone_px): (f64, f64),
    table: &FacetTable,
    watch: Watch<'_>,
) -> Result<Slab> {
    let wanted = Wanted { radiance_alone: true, ..Wanted::default() };
    if scene.exposure.spectrometer.is_ideal() {
        return Ok(integrate::integrate(scene, table, wanted, watch)?.slab);
    }
    let mut exposure = scene.exposure.clone();
    exposure.camera.boresight_px[0] -= keystone_px;
    exposure.bands.iter_mut().for_each(|band| band.centre_um += smile_um);
    Ok(integrate::integrate(&scene.seen_by(exposure)?, table, wanted, watch)?.slab)
}

/// The radiance of a scene's image, with the smile and the keystone of its sensor.
///
/// # Errors
/// As [`look`].
pub(super) fn radiance(scene: &Scene, table: &FacetTable, watch: Watch<'_>) -> Result<Slab> {
    if scene.exposure.spectrometer.is_ideal() {
        return look(scene, (0.0, 0.0), table, watch);
    }
    let Looks { smiles, keystones } = Looks::of(&scene.exposure);
    let mut parts = Vec::new();
    for (keystone_px, by_band) in &keystones {
        for (smile_um, by_sample) in &smiles {
            let slab = look(scene, (*smile_um, *keystone_px), table, watch)?;
            let by_pixel: Vec<f64> = by_sample.iter().copied().cycle().take(slab.row_start.len() - 1).collect();
            parts.push(slab.scaled(&by_pixel, by_band));
        }
    }
    Ok(Slab::over(&parts))
}

/// A few shifts, and for each of them its share in each of all: of three the parabola's.
fn parabolas(all: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let (low, high) = ends(all);
    if low == high {
        return (vec![low], vec![vec![1.0; all.len()]]);
    }
    let nodes = vec![low, 0.5 * (low + high), high];
    let share = |node: usize| {
        let others = [0, 1, 2].into_iter().filter(move |k| *k != node);
        let of = |at: &f64| others.clone().map(|k| (at - nodes[k]) / (nodes[node] - nodes[k])).product();
        all.iter().map(of).collect()
    };
    let shares = (0..3).map(share).collect();
    (nodes, shares)
}

/// The same, linearly between neighbours: of a few shifts each is one.
fn hats(all: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut nodes = all.to_vec();
    nodes.sort_by(f64::total_cmp);
    nodes.dedup();
    if nodes.len() > FEW as usize {
        let (low, high) = ends(all);
        let count = crate::geometry::whole_u32(((high - low) * LOOKS_A_PIXEL).ceil()).max(FEW - 1);
        nodes = (0..=count).map(|i| low + (high - low) * f64::from(i) / f64::from(count)).collect();
    }
    let share = |node: usize, at: f64| {
        let beside = |other: Option<&f64>| other.map_or(0.0, |other| 1.0 - (at - nodes[node]) / (other - nodes[node]));
        match at.total_cmp(&nodes[node]) {
            std::cmp::Ordering::Equal => 1.0,
            std::cmp::Ordering::Less => beside(node.checked_sub(1).and_then(|k| nodes.get(k))).max(0.0),
            std::cmp::Ordering::Greater => beside(nodes.get(node + 1)).max(0.0),
        }
    };
    let shares = (0..nodes.len()).map(|node| all.iter().map(|at| share(node, *at)).collect()).collect();
    (nodes, shares)
}

fn ends(all: &[f64]) -> (f64, f64) {
    all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (x.min(low), x.max(high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_give_lines_and_parabolas() {
        let all: Vec<f64> = (0..40).map(|i| 0.3 + f64::from(i) * 0.05).collect();
        for (nodes, shares, of) in [
            {
                let (n, s) = hats(&all);
                (n, s, (|x: f64| 2.0 - 3.0 * x) as fn(f64) -> f64)
            },
            {
                let (n, s) = parabolas(&all);
                (n, s, |x: f64| 2.0 - 3.0 * x + x * x)
            },
        ] {
            for (i, at) in all.iter().enumerate() {
                let value: f64 = nodes.iter().zip(&shares).map(|(node, shares)| shares[i] * of(*node)).sum();
                assert!((value - of(*at)).abs() < 1e-12, "{at}: {value}");
                assert!((shares.iter().map(|s| s[i]).sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
        assert_eq!(hats(&[0.5, -0.5, 0.5]).0, [-0.5, 0.5]);
        assert_eq!(parabolas(&[0.0; 3]).1, [[1.0; 3]]);
    }
}
