//! FITS, as it is written: the first array in the primary unit, each other one in an image extension with its name, texts in tables of one row.
//!
//! Source: "Definition of the Flexible Image Transport System", version 4.0 (2018). The first line of an image comes first, as in all other files here, so
//! that indices are the same; programs that draw FITS draw it at the bottom.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use super::dataset::{Attributes, Dataset, Slot, Value};
use super::number::DataType;
use crate::error::{Error, Result};

/// Units are written in blocks of so many bytes.
const BLOCK: usize = 2880;
/// A card of a header.
const CARD: usize = 80;
/// Characters of a text that a card holds beside its keyword, quotes and the mark that more follow.
const OF_TEXT: usize = 66;

/// The type in which numbers are written: FITS has whole numbers with a sign, and bytes without.
pub(super) fn type_of(data_type: DataType) -> DataType {
    match data_type {
        DataType::I8 => DataType::I16,
        DataType::U16 => DataType::I32,
        DataType::U32 => DataType::I64,
        DataType::U64 => DataType::F64,
        other => other,
    }
}

/// BITPIX of a type.
fn bitpix(data_type: DataType) -> i64 {
    let bits = 8 * data_type.bytes() as i64;
    if data_type.is_integer() { bits } else { -bits }
}

/// A header in the making.
#[derive(Default)]
struct Header(String);

impl Header {
    fn card(&mut self, text: &str) {
        let _ = write!(self.0, "{text:CARD$}");
    }

    fn fixed(&mut self, keyword: &str, value: impl std::fmt::Display) {
        self.card(&format!("{keyword:8}= {value:>20}"));
    }

    /// A text, in as many cards as it takes. What is not ASCII is a question mark.
    fn text(&mut self, keyword: &str, text: &str) {
        let plain: String =
            text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect::<String>();
        let quoted: Vec<char> = plain.replace('\'', "''").chars().collect();
        let mut rest = &quoted[..];
        let mut keyword = format!("{keyword:8}= ");
        loop {
            let mut end = rest.len().min(OF_TEXT);
            // A quote is two characters, which stay together.
            if end < rest.len() && rest[..end].iter().rev().take_while(|c| **c == '\'').count() % 2 == 1 {
                end -= 1;
            }
            let (some, more) = rest.split_at(end);
            let some: String = some.iter().collect();
            let mark = if more.is_empty() { "" } else { "&" };
            self.card(&format!("{keyword}'{some:8}{mark}'"));
            if more.is_empty() {
                return;
            }
            (rest, keyword) = (more, format!("{:10}", "CONTINUE"));
        }
    }

    /// Attributes by the keywords that FITS has for them, or by the first eight letters of their names.
    fn attributes(&mut self, attributes: &Attributes) {
        for (name, value) in attributes {
            let keyword = match *name {
                "units" => "BUNIT".to_owned(),
                "source" => "CREATOR".to_owned(),
                "instrument" => "INSTRUME".to_owned(),
                // What FITS says by its own means, or has no use for.
                "Conventions" | "coordinates" | "_FillValue" => continue,
                other => other.chars().filter(char::is_ascii_alphanumeric).take(8).collect::<String>().to_uppercase(),
            };
            match value {
                Value::Text(text) => self.text(&keyword, text),
                Value::Sample(number) => self.fixed(&keyword, format!("{number:E}")),
            }
        }
    }

    fn ended(mut self) -> Vec<u8> {
        self.card("END");
        let mut bytes = self.0.into_bytes();
        bytes.resize(bytes.len().next_multiple_of(BLOCK), b' ');
        bytes
    }
}

/// A unit: its header, and how many bytes of data follow.
struct Unit {
    header: Vec<u8>,
    data: u64,
}

fn units(data: &Dataset<'_>) -> Vec<Unit> {
    let mut units = Vec::new();
    for (i, variable) in data.variables.iter().enumerate() {
        let mut header = Header::default();
        if i == 0 {
            header.fixed("SIMPLE", "T");
        } else {
            header.text("XTENSION", "IMAGE");
        }
        let shape = data.shape(variable);
        header.fixed("BITPIX", bitpix(variable.data_type));
        header.fixed("NAXIS", shape.len());
        for (axis, length) in shape.iter().rev().enumerate() {
            header.fixed(&format!("NAXIS{}", axis + 1), length);
        }
        if i == 0 {
            header.fixed("EXTEND", "T");
        } else {
            header.fixed("PCOUNT", 0);
            header.fixed("GCOUNT", 1);
        }
        header.text("EXTNAME", &variable.name.to_uppercase());
        // NAXIS1 is the last of the axes here.
        for (axis, number) in variable.axes.iter().rev().enumerate() {
            header.text(&format!("AXIS{}", axis + 1), data.axes[*number].name);
        }
        header.attributes(&variable.attributes);
        let blank = variable.attributes.iter().find(|(name, _)| *name == "_FillValue");
        if let (true, Some((_, Value::Sample(number)))) = (variable.data_type.is_integer(), blank) {
            header.fixed("BLANK", number);
        }
        if i == 0 {
            header.attributes(&data.attributes);
        }
        units.push(Unit { header: header.ended(), data: data.bytes(variable) });
    }
    for text in &data.texts {
        let mut header = Header::default();
        header.text("XTENSION", "BINTABLE");
        header.fixed("BITPIX", 8);
        header.fixed("NAXIS", 2);
        header.fixed("NAXIS1", text.text.len());
        header.fixed("NAXIS2", 1);
        header.fixed("PCOUNT", 0);
        header.fixed("GCOUNT", 1);
        header.fixed("TFIELDS", 1);
        header.text("TTYPE1", &text.name.to_uppercase());
        header.text("TFORM1", &format!("{}A", text.text.len()));
        header.text("EXTNAME", &text.name.to_uppercase());
        header.text("LONGNAME", text.about);
        units.push(Unit { header: header.ended(), data: text.text.len() as u64 });
    }
    units
}

/// Where each unit begins, and the end of the last.
fn starts(units: &[Unit]) -> Vec<u64> {
    let mut at = 0u64;
    let mut starts = vec![0];
    for unit in units {
        let data = unit.data.checked_next_multiple_of(BLOCK as u64).unwrap_or(u64::MAX);
        at = at.saturating_add(unit.header.len() as u64).saturating_add(data);
        starts.push(at);
    }
    starts
}

/// Where the numbers of each variable go.
pub(super) fn slots(path: &Path, data: &Dataset<'_>) -> Vec<Slot> {
    let units = units(data);
    let behind = |(unit, start): (&Unit, u64)| start + unit.header.len() as u64;
    let starts = units.iter().zip(starts(&units)).map(behind).take(data.variables.len());
    starts.map(|start| Slot { path: path.to_owned(), start, big_endian: true }).collect()
}

/// Writes the headers and the texts: the file is then whole.
///
/// # Errors
/// [`Error::Io`].
pub(super) fn finish(path: &Path, data: &Dataset<'_>) -> Result<()> {
    let units = units(data);
    let starts = starts(&units);
    let write = || {
        let mut file = File::options().write(true).open(path)?;
        for (i, (unit, start)) in units.iter().zip(&starts).enumerate() {
            file.seek(SeekFrom::Start(*start))?;
            file.write_all(&unit.header)?;
            if let Some(text) = i.checked_sub(data.variables.len()).map(|i| &data.texts[i]) {
                file.write_all(text.text.as_bytes())?;
            }
        }
        // What follows the numbers of a unit are zeros.
        file.set_len(starts[units.len()])
    };
    write().map_err(|e| Error::io(path, "writing", e))
}
