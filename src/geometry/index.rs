//! Indices into lists and grids: in the 32 bits that meshes use, and as whole parts of numbers.

/// A place in a list, in 32 bits.
///
/// It is for lists that are known to be shorter than 2^32: of a mesh, whose vertices and facets its readers and makers count, and a scene checks
/// (2^29 facets at the most); of what is in one pixel or cell, at 16 bytes a point and more; of materials, bands, rows and the texels of an image. Ends of
/// lists over all pixels or facets are `usize`.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "lists that are longer are refused before, or fill no memory that there is"
)]
pub(crate) fn index_u32(place: usize) -> u32 {
    debug_assert!(u32::try_from(place).is_ok(), "{place}");
    place as u32
}

/// The whole part of a number, as an index or a count: 0 for negative numbers and NaN, and the largest count for anything beyond.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "what `as` does is meant")]
pub(crate) fn whole(number: f64) -> usize {
    number as usize
}

/// [`whole`] in 32 bits.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "what `as` does is meant")]
pub(crate) fn whole_u32(number: f64) -> u32 {
    number as u32
}
