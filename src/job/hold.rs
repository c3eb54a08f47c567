//! A scene becomes a product in memory.

use crate::error::Result;
use crate::formats::product_folder::{self, Product};
use crate::formats::report_json::{ProductReport, SignalEntry};
use crate::formats::{Subject, machine};
use crate::integrate::Wanted;
use crate::product::{Conversion, Cube, CubeAxes, Quantity};
use crate::progress::Watch;
use crate::study::{self, Reader, Request};

/// What a product folder would hold.
#[derive(Debug, Clone)]
pub struct Held {
    /// What it was made from, and all but the cube.
    pub product: Product,
    /// Its cube, in the quantity that was asked for: a number for each pixel, line by line, in each band of its axes, as [`Cube::expand`] hands them out.
    pub cube: Cube,
    /// The whole numbers that a detector sends, DN, if the sensor has one: as many as the cube has.
    pub numbers: Option<Cube>,
    /// Its report.
    pub report: ProductReport,
}

/// Bytes of a number of a slab without weights.
const NUMBER_BYTES: u64 = 8;

/// As [`simulate`](super::simulate()), without a folder: the same numbers, in double precision.
///
/// `number_bytes` is what the caller is going to make of each pixel in each band, bytes; there has to be room for that, too.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if there is no room in memory, if the scene has not the quantity, or if a check of the product does not hold;
/// [`Error::Unsupported`](crate::Error::Unsupported); [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn hold(
    mut subject: Subject,
    request: &Request,
    quantity: Quantity,
    number_bytes: u64,
    watch: Watch<'_>,
) -> Result<Held> {
    let chain = subject.chain.as_ref();
    let (is_blurred, is_read) = chain.map_or((false, false), |of| (of.optics.is_some(), of.detector.is_some()));
    // What is blurred, read or not proportional to radiance has a number for each pixel in each band, and no weights; what is read has two.
    let cubes = u64::from(is_blurred || is_read || !quantity.is_proportional()) + u64::from(is_read);
    let number_bytes = number_bytes.saturating_add(NUMBER_BYTES * cubes);
    study::has_room_for(&subject.scene, false, number_bytes, machine::memory_bytes())?;
    let (extremes, plan) = super::plan::decide(&mut subject, request, watch)?;
    let conversion = Conversion::new(quantity, &subject.scene)?;
    let radiance = CubeAxes::of(&subject.scene.exposure);
    let axes = CubeAxes { quantity, ..radiance.clone() };
    let detector = subject.chain.as_ref().and_then(|chain| chain.detector.as_ref());
    let reader = |detector| Reader::new(detector, radiance.clone(), (subject.readout(), subject.occasion()));
    let mut reader = detector.map(reader).transpose()?;
    let mut shown = product_folder::shown(axes.clone());
    let (mut slabs, mut sent) = (Vec::new(), Vec::new());
    let mut keep = |slab| {
        conversion.slabs(slab, |slab| {
            shown.take(&slab)?;
            slabs.push(slab);
            Ok(())
        })
    };
    let mut put = |slab| match &mut reader {
        None => keep(slab),
        Some(reader) => reader.read(&slab, |reading| {
            sent.push(reading.numbers);
            keep(reading.radiance)
        }),
    };
    let of = (&extremes, request.tolerance);
    let (table, observation) = super::simulate::look(&subject, of, Wanted::default(), &mut put, watch)?;
    product_folder::verify(&observation.checks, None)?;
    let mut product = Product { subject, table, table_from: None, observation, plan: Some(plan), maps: None };
    product.tell(reader.as_ref());
    let cube = Cube::new(axes, slabs)?;
    let numbers = reader.as_ref().map(|_| Cube::new(CubeAxes { quantity: Quantity::Counts, ..radiance }, sent));
    let numbers = numbers.transpose()?;
    let report = product_folder::report(&product, &shown, reader.as_ref().map(SignalEntry::of));
    Ok(Held { product, cube, numbers, report })
}
