//! Spectral OpenEXR: a radiance cube as one channel for each band.
//!
//! Layout: Fichet, Pacanowski and Wilkie (2021), "An OpenEXR layout for spectral images", JCGT 10(3): channels
//! `S0.<wavelength>nm` with a decimal comma, attributes `spectralLayoutVersion` and `emissiveUnits`. The layout's unit,
//! W.m^-2.sr^-1, leaves open per which wavelength; ours is in the attribute `radianceUnits`: W.m^-2.sr^-1.um^-1.
//! Full widths at half maximum, um, are in the attribute `bandWidths`, names of bands, where they have any, in `bandNames`: in the order of channels.
//! Wavelengths have leading zeros, so that OpenEXR's alphabetical order of channels is the order of wavelength.
//!
//! The file is uncompressed and written line by line, without the crate `exr`: that holds all channels in memory and
//! writes attributes in hash order, another one at each run. (It reads what is written here.)

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::product::{Cube, CubeAxes, Filling, Quantity, Slab};
use crate::progress::Watch;
use crate::spectral::Band;

use super::envi::{self, DataType, SoFar};
use super::flat::{AxisOrder, Flat, FlatFile};

/// The name of a band's channel, to 1e-6 nm.
pub fn channel_name(band: &Band) -> String {
    // 950 nm is 0950,000000.
    format!("S0.{}nm", format!("{:011.6}", band.centre_um * 1000.0).replace('.', ","))
}

/// A radiance cube that is written slab by slab, in any order, as f32 scan lines. No slab is kept.
#[derive(Debug)]
pub struct ExrCube {
    path: PathBuf,
    file: FlatFile,
    samples: usize,
    /// The channel of each band.
    channel: Vec<usize>,
    filling: Filling,
}

impl ExrCube {
    /// Begins a file.
    ///
    /// # Errors
    /// [`Error::Invalid`] if two bands would have the same channel name or the image is larger than OpenEXR can hold;
    /// [`Error::Io`].
    pub fn create(path: &Path, axes: &CubeAxes, description: &str) -> Result<Self> {
        let CubeAxes { samples, lines, bands, quantity } = axes;
        let names: Vec<String> = bands.iter().map(channel_name).collect();
        let mut order: Vec<usize> = (0..names.len()).collect();
        order.sort_by(|a, b| names[*a].cmp(&names[*b]));
        if *samples == 0 || *lines == 0 || bands.is_empty() {
            return Err(Error::invalid(Location::file(path), "an image without pixels or bands has no OpenEXR file"));
        }
        if let Some(pair) = order.windows(2).find(|w| names[w[0]] == names[w[1]]) {
            let message = format!("bands {} and {} both have the centre {}", pair[0] + 1, pair[1] + 1, names[pair[0]]);
            let problem = Problem::new(Location::file(path), message)
                .with_help("OpenEXR knows bands by their wavelength, here to 1e-6 nm: move one, or leave out --exr");
            return Err(Error::Invalid(vec![problem]));
        }
        let channels: Vec<&str> = order.iter().map(|band| names[*band].as_str()).collect();
        let about = About {
            description,
            spectral: true,
            unit: Some(exr_unit(*quantity)),
            widths: widths(order.iter().map(|band| bands[*band].fwhm_um)),
            names: band_names(order.iter().map(|band| bands[*band].name.as_str())),
        };
        let head = head(path, &channels, [*samples, *lines], &about)?;
        let flat = flat([*lines, *samples, bands.len()]);
        let file = FlatFile::create(path, flat, &head).map_err(|e| Error::io(path, "writing", e))?;
        let mut channel = vec![0; order.len()];
        order.iter().enumerate().for_each(|(at, band)| channel[*band] = at);
        Ok(ExrCube { path: path.into(), file, samples: *samples, channel, filling: Filling::new(axes) })
    }

    /// Writes a slab.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written, [`Error::Interrupted`] if `watch` asks to stop, and those of [`Filling::admits`].
    pub fn put(&mut self, slab: &Slab, watch: Watch<'_>) -> Result<()> {
        self.filling.admits(slab)?;
        let so_far = SoFar::new(&self.filling, watch);
        let ExrCube { path, file, samples, channel, .. } = self;
        let of_slab = &channel[slab.bands.clone()];
        let mut order: Vec<usize> = (0..of_slab.len()).collect();
        order.sort_by_key(|band| of_slab[*band]);
        let band_bytes = 4 * *samples;
        let mut sorted = Vec::new();
        let mut put = |lines: Range<usize>, bytes: &[u8]| {
            // Bands whose channels follow one another lie in one piece.
            order.chunk_by(|a, b| of_slab[*a] + 1 == of_slab[*b]).try_for_each(|run| {
                sorted.clear();
                for line in bytes.chunks_exact((band_bytes * order.len()).max(1)) {
                    run.iter().for_each(|band| sorted.extend_from_slice(&line[band_bytes * band..][..band_bytes]));
                }
                let first = of_slab[run[0]];
                let written = file.bytes(lines.clone(), first..first + run.len(), &sorted);
                written.map_err(|e| Error::io(path.as_path(), "writing", e))
            })
        };
        envi::stream_lines_f32(slab, *samples, &mut put, &so_far)?;
        self.filling.add(slab);
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`Error::Invalid`] if slabs have not filled it.
    pub fn end(self) -> Result<()> {
        self.filling.end()
    }
}

/// Writes all slabs of a cube with [`ExrCube`].
///
/// # Errors
/// Those of [`ExrCube::create`] and [`ExrCube::put`].
pub fn write(path: &Path, cube: &Cube, description: &str, watch: Watch<'_>) -> Result<()> {
    let mut file = ExrCube::create(path, &cube.axes, description)?;
    cube.slabs().iter().try_for_each(|slab| file.put(slab, watch))?;
    file.end()
}

/// A quantity's unit as OpenEXR files have it.
fn exr_unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Radiance => "W.m^-2.sr^-1.um^-1",
        Quantity::BandRadiance => "W.m^-2.sr^-1",
        Quantity::RadianceFactor | Quantity::ReflectanceFactor | Quantity::BrightnessTemperature | Quantity::Counts => {
            quantity.unit()
        }
    }
}

/// How the numbers of a file lie behind its [`head`]: rows, columns and channels.
pub(super) fn flat(size: [usize; 3]) -> Flat {
    Flat { has_heads: true, ..Flat::new(size, DataType::F32, AxisOrder::RowBandColumn) }
}

/// What a file says of itself.
pub(super) struct About<'a> {
    pub(super) description: &'a str,
    /// Whether channels are called by their wavelength.
    pub(super) spectral: bool,
    /// Unit of the values.
    pub(super) unit: Option<&'a str>,
    /// What [`widths`] says.
    pub(super) widths: Option<String>,
    /// What [`band_names`] says.
    pub(super) names: Option<String>,
}

/// Widths of bands, um, in the order of channels, 0 where a band has none; `None` if none has one.
pub(super) fn widths(widths_um: impl Iterator<Item = Option<f64>> + Clone) -> Option<String> {
    let texts = widths_um.clone().map(|width| width.unwrap_or(0.0).to_string());
    widths_um.flatten().next().map(|_| texts.collect::<Vec<_>>().join(" "))
}

/// Reads what [`widths`] wrote, if it has this many bands.
pub(super) fn read_widths(text: &str, count: usize) -> Option<Vec<Option<f64>>> {
    let width = |text: &str| text.parse().ok().filter(|um: &f64| *um >= 0.0 && um.is_finite());
    let widths_um: Vec<f64> = text.split_whitespace().map(width).collect::<Option<_>>()?;
    (widths_um.len() == count).then(|| widths_um.into_iter().map(|um| (um > 0.0).then_some(um)).collect())
}

/// Names of bands in the order of channels; `None` if none has one.
pub(super) fn band_names<'a>(names: impl Iterator<Item = &'a str> + Clone) -> Option<String> {
    names.clone().any(|name| !name.is_empty()).then(|| names.collect::<Vec<_>>().join(", "))
}

/// The attribute that holds [`widths`].
pub(super) const WIDTHS: &str = "bandWidths";

/// All before the first of the scan lines, each of which then takes 8 bytes and its numbers, f32, channel by channel.
/// `size` is columns and rows.
///
/// # Errors
/// [`Error::Invalid`] if the image is larger than OpenEXR can hold.
pub(super) fn head(path: &Path, names: &[&str], size: [usize; 2], about: &About<'_>) -> Result<Vec<u8>> {
    let [columns, rows] = size;
    let line_bytes = columns.saturating_mul(4).saturating_mul(names.len());
    let (Ok(last_x), Ok(last_y), Ok(_)) = (i32::try_from(columns), i32::try_from(rows), i32::try_from(line_bytes))
    else {
        return Err(Error::invalid(Location::file(path), "the image is too large for OpenEXR"));
    };
    let mut head = header(names, [0, 0, last_x - 1, last_y - 1], about);
    // Where each scan line begins.
    let first = head.len() as u64 + 8 * rows as u64;
    for line in 0..rows as u64 {
        head.extend((first + line * (8 + line_bytes as u64)).to_le_bytes());
    }
    Ok(head)
}

/// Magic number, version and attributes, the latter in the order of their names; `window` is first x, y and last x, y.
fn header(names: &[&str], window: [i32; 4], about: &About<'_>) -> Vec<u8> {
    let mut header: Vec<u8> = Vec::new();
    header.extend(20_000_630_i32.to_le_bytes());
    // Version 2, single-part scan lines; names are shorter than 32 bytes.
    header.extend(2_i32.to_le_bytes());
    let mut channels: Vec<u8> = Vec::new();
    for name in names {
        channels.extend(name.as_bytes());
        channels.push(0);
        // FLOAT; linear 0 and three reserved bytes; sampling 1 x 1.
        [2_i32, 0, 1, 1].iter().for_each(|v| channels.extend(v.to_le_bytes()));
    }
    channels.push(0);
    let window: Vec<u8> = window.iter().flat_map(|v| v.to_le_bytes()).collect();
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        [name, kind].iter().for_each(|text| {
            header.extend(text.as_bytes());
            header.push(0);
        });
        // Lists of names and widths, of a few bytes a band.
        header.extend(i32::try_from(value.len()).unwrap_or(i32::MAX).to_le_bytes());
        header.extend(value);
    };
    for (name, text) in [("bandNames", &about.names), (WIDTHS, &about.widths)] {
        if let Some(text) = text {
            attribute(name, "string", text.as_bytes());
        }
    }
    attribute("channels", "chlist", &channels);
    if !about.description.is_empty() {
        attribute("comments", "string", about.description.as_bytes());
    }
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    if about.spectral && about.unit.is_some_and(|unit| unit.starts_with('W')) {
        attribute("emissiveUnits", "string", b"W.m^-2.sr^-1");
    }
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    if let Some(unit) = about.unit {
        attribute("radianceUnits", "string", unit.as_bytes());
    }
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    if about.spectral {
        attribute("spectralLayoutVersion", "string", b"1.0");
    }
    header.push(0);
    header
}

/// What the reader of OpenEXR files says of one.
pub(super) fn failed(path: &Path, error: exr::error::Error) -> Error {
    match error {
        exr::error::Error::Io(e) if e.kind() != std::io::ErrorKind::UnexpectedEof => Error::io(path, "reading", e),
        exr::error::Error::NotSupported(what) => {
            Error::Unsupported { at: Location::file(path), feature: format!("OpenEXR with {what}") }
        }
        e => Error::syntax(Location::file(path), format!("not a complete OpenEXR file: {e}")),
    }
}

/// What the header of an OpenEXR file says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Info {
    /// Pixels in a line.
    pub samples: usize,
    /// Lines.
    pub lines: usize,
    /// Names of the channels, in the order of the file.
    pub channels: Vec<String>,
    /// Text attributes, by name.
    pub attributes: Vec<(String, String)>,
}

/// Reads the header of the first part.
///
/// # Errors
/// [`Error::Io`], [`Error::Syntax`] if it is not an OpenEXR file, [`Error::Unsupported`] for what the reader does not know.
pub fn read_info(path: &Path) -> Result<Info> {
    use exr::meta::attribute::AttributeValue;
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|e| failed(path, e))?;
    let Some(header) = meta.headers.first() else {
        return Err(Error::syntax(Location::file(path), "an OpenEXR file without a part"));
    };
    let texts = header.own_attributes.other.iter().chain(&header.shared_attributes.other);
    let mut attributes: Vec<(String, String)> = texts
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            _ => None,
        })
        .collect();
    attributes.sort();
    Ok(Info {
        samples: header.layer_size.width(),
        lines: header.layer_size.height(),
        channels: header.channels.list.iter().map(|c| c.name.to_string()).collect(),
        attributes,
    })
}
