//! File names made from other names: no system accepts more than 255 bytes, of which the file itself needs some.

use std::borrow::Cow;

/// Longer names are shortened, bytes.
const LONGEST: usize = 120;
/// This much of the end is kept, which is where a name says what it is, bytes.
const END: usize = 40;

/// A name, or its beginning and its end where it is too long. Several may become the same.
pub(super) fn shortened(name: &str) -> Cow<'_, str> {
    if name.len() <= LONGEST {
        return Cow::Borrowed(name);
    }
    let at = |wanted: usize| (0..=wanted).rev().find(|&i| name.is_char_boundary(i)).unwrap_or(0);
    let (start, end) = (at(LONGEST - END - 1), at(name.len() - END));
    Cow::Owned(format!("{}_{}", &name[..start], &name[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_keep_beginning_and_end() {
        assert_eq!(shortened("regolith.reflectance"), "regolith.reflectance");
        let long = shortened(&format!(".{}.reflectance", "ä".repeat(300))).into_owned();
        assert!(long.len() <= LONGEST + 3 && long.starts_with(".ää") && long.ends_with("ä.reflectance"), "{long}");
    }
}
