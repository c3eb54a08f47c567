//! An instrument applied to a cube of pixel means instead of a scene: optics blur whole pixels, for lack of finer
//! detail.

use crate::instrument::{Blur, Chain, Optics};

/// A band of a cube, line by line, blurred by an instrument's optics, taking radiance as uniform within pixels and
/// repeating border pixels outwards. NaN counts as no light, and stays NaN.
pub fn blurred(optics: &Optics, lambda_um: f64, values: &[f64], size: [usize; 2]) -> Vec<f64> {
    let [samples, lines] = size;
    let light: Vec<f64> = values.iter().map(|value| if value.is_finite() { *value } else { 0.0 }).collect();
    let mean = light.iter().sum::<f64>() / light.len().max(1) as f64;
    let spread = if optics.blurs() {
        let blur = Blur::new(optics, lambda_um, size);
        let [width, height] = blur.fine_size();
        let (reach, parts) = (optics.reach_px as usize, optics.subpixels as usize);
        let at = |part: usize, count: usize| (part / parts).saturating_sub(reach).min(count - 1);
        let fine: Vec<f64> =
            (0..width * height).map(|i| light[at(i / width, lines) * samples + at(i % width, samples)]).collect();
        blur.pixels(&fine)
    } else {
        light
    };
    let veiled = |value: f64| value + optics.stray * (mean - value);
    spread.into_iter().zip(values).map(|(to, from)| if from.is_nan() { f64::NAN } else { veiled(to) }).collect()
}

/// The warning for such a cube.
pub fn remark(chain: &Chain) -> Option<String> {
    chain.optics.as_ref().filter(|optics| optics.blurs()).map(|_| {
        "an approximation: the optics blur means of pixels, which hold no detail below a pixel; waves near and above half a cycle per pixel pass otherwise than they should. \
         `simulate` with these optics in the scene blurs before the means are taken"
            .to_owned()
    })
}
