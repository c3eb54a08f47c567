//! A radiance map that lies beside where it says.

use super::scenes::{above, ground, scene, sun, worst};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::geometry::{Camera, Texels};
use crate::product::{Placement, RadianceMap, SkyShare, TexelSource, ViewImage};
use crate::progress::unwatched;
use crate::solve;
use crate::spectral::Band;
use crate::study::{Fill, MapOptions, observe_maps};

/// Texels in memory.
#[derive(Debug)]
struct Held(Vec<Band>, Vec<f64>);

impl TexelSource for Held {
    fn bands(&self) -> &[Band] {
        &self.0
    }

    fn read(&mut self, _: usize, values: &mut Vec<f64>) -> Result<()> {
        values.clone_from(&self.1);
        Ok(())
    }
}

const TEXELS: u32 = 32;

/// The image of a map of ripples, five texels long and more, that lies `off` texels to the right.
fn image(off: f64, texels: Texels) -> Result<Vec<f64>> {
    let scene = scene(ground(10.0, 0), &[1.0], sun(0.0, 0.0)?, above(1000.0, 10.0, 20)?)?;
    let mut camera = above(500.0, 16.0, TEXELS)?;
    camera.boresight_px[0] += off;
    let ripple = |i: u32| {
        let [x, y] = [i % TEXELS, i / TEXELS].map(f64::from);
        1.0 + 0.5 * (1.2 * x + 0.3 * y).sin() * (0.7 * y - 0.2 * x).cos()
    };
    let map = RadianceMap {
        name: "map".into(),
        placement: Placement::View(Box::new(ViewImage { camera: Camera::Frame(camera), occlusion: true })),
        source: Box::new(Held(vec![Band::new(1.0, None)], (0..TEXELS * TEXELS).map(ripple).collect())),
        weight: 1.0,
        light: vec![],
        sky: SkyShare::LeftOut,
        registration: None,
    };
    let table = solve::lit(&scene, &unwatched)?;
    let options = MapOptions { texels, fill: Fill::Value(0.0), ..MapOptions::default() };
    let (seen, _) = observe_maps(&scene, &table, vec![vec![map]], &options, &unwatched)?;
    Ok(seen.cube.band(0))
}

pub(super) fn hazard() -> Result<Hazard> {
    let offs: Vec<f64> = (0..=6).rev().map(|power| 10f64.powi(-power)).collect();
    let sweep = |method, texels| -> Result<Sweep> {
        let truth = image(0.0, texels)?;
        let point = |off: &f64| Ok(Point { at: *off, error: worst(&image(*off, texels)?, &truth) });
        let then = "The error is the map's contrast from one texel to the next times the shift, however small: place maps to a thousandth of a texel for 1e-3.";
        Ok(Sweep { method, is_ours: true, then, points: offs.iter().map(point).collect::<Result<_>>()? })
    };
    Ok(Hazard {
        name: "a radiance map beside its place",
        parameter: "shift, texels",
        truth: "A map of ripples over five texels and more on level ground, against the same without the shift: an error of the input, which no method can see; worst pixel.",
        sweeps: vec![sweep("constant texels", Texels::Nearest)?, sweep("bilinear texels", Texels::Bilinear)?],
    })
}
