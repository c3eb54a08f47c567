//! The instrument: optics blur the radiance (`optics.rs`, `blur.rs`), a detector counts it (`detector.rs`), and
//! calibration undoes that.
//!
//! Spectral response belongs to the band ([`Band::response`](crate::spectral::Band::response)), and is not applied here
//! again.

mod blur;
mod detector;
mod optics;

pub use blur::Blur;
pub use detector::{Counting, Detector, Element, Measured};
pub use optics::{Lens, Optics, PointSpread};

/// The chain from radiance to data; each part may be missing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chain {
    /// Optics.
    pub optics: Option<Optics>,
    /// Detector.
    pub detector: Option<Detector>,
}

impl Chain {
    /// Whether it changes nothing.
    pub fn is_ideal(&self) -> bool {
        self.optics.is_none() && self.detector.is_none()
    }
}
