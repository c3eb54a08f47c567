//! What an instrument makes of the radiance before it, and how it is undone: optics blur it (`optics.rs`, `blur.rs`), a detector counts it (`detector.rs`).
//!
//! What a band responds to belongs to the band ([`Band::response`](crate::spectral::Band::response)), and is not applied here again.

mod blur;
mod detector;
mod optics;

pub use blur::Blur;
pub use detector::{Counting, Detector, Element, Measured};
pub use optics::{Lens, Optics, PointSpread};

/// From radiance to what is delivered: each part may be missing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chain {
    /// What blurs an image.
    pub optics: Option<Optics>,
    /// What counts it.
    pub detector: Option<Detector>,
}

impl Chain {
    /// Whether it leaves an image as it is.
    pub fn is_ideal(&self) -> bool {
        self.optics.is_none() && self.detector.is_none()
    }
}
