//! Named arrays over shared axes, with attributes: what NetCDF and Zarr hold, and FITS in its way.
//!
//! Where the numbers of each array lie follows from names and lengths, so that those of an image are written piece by piece.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::PathBuf;

use super::number::DataType;

/// What an attribute says.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Text(String),
    /// One of the numbers that the array may hold, in its type.
    Sample(f64),
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Value::Text(text.to_owned())
    }
}

/// Attributes, in the order in which they are written.
pub(super) type Attributes = Vec<(&'static str, Value)>;

/// An axis that arrays have in common.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Axis {
    pub(super) name: &'static str,
    pub(super) length: usize,
}

/// An array of numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable<'a> {
    /// Letters, digits and low lines; see [`Names`].
    pub(super) name: String,
    /// Its axes, slowest first, by their number in the dataset.
    pub(super) axes: Vec<usize>,
    pub(super) data_type: DataType,
    pub(super) attributes: Attributes,
    /// Its numbers; `None` where they come piece by piece.
    pub(super) values: Option<Cow<'a, [f64]>>,
}

/// A text of many lines, such as a report; never empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Text {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    pub(super) text: String,
}

/// What a file or folder holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Dataset<'a> {
    pub(super) axes: Vec<Axis>,
    pub(super) variables: Vec<Variable<'a>>,
    pub(super) texts: Vec<Text>,
    pub(super) attributes: Attributes,
}

impl Dataset<'_> {
    /// Lengths of a variable's axes, slowest first.
    pub(super) fn shape(&self, variable: &Variable<'_>) -> Vec<usize> {
        variable.axes.iter().map(|axis| self.axes[*axis].length).collect()
    }

    /// Bytes of a variable's numbers; more than any file has, if they are.
    pub(super) fn bytes(&self, variable: &Variable<'_>) -> u64 {
        let numbers = self.shape(variable).iter().fold(1u64, |all, length| all.saturating_mul(*length as u64));
        numbers.saturating_mul(variable.data_type.bytes() as u64)
    }
}

/// Where the numbers of a variable go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Slot {
    pub(super) path: PathBuf,
    /// The first byte of the numbers in that file.
    pub(super) start: u64,
    pub(super) big_endian: bool,
}

/// Names that all of these formats, and Python, take for names: letters, digits and low lines, each once.
#[derive(Debug, Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// The name for something that is called like this.
    pub(super) fn of(&mut self, called: &str) -> String {
        let plain: String = called.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let begun = if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("v_{plain}") };
        let mut name = begun.clone();
        let mut count = 1;
        // FITS knows no small letters.
        while !self.0.insert(name.to_ascii_uppercase()) {
            count += 1;
            name = format!("{begun}_{count}");
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_differ() {
        let mut names = Names::default();
        let made: Vec<String> =
            ["GLOBE Mars", "globe mars", "INCIDENCE", "1 um", "", "é"].iter().map(|called| names.of(called)).collect();
        assert_eq!(made, ["GLOBE_Mars", "globe_mars_2", "INCIDENCE", "v_1_um", "v_", "v__"]);
    }
}
