//! What rasters say of where there is nothing beside their numbers: masks within and beside a file, and coverage. Files by GDAL
//! (`referees/masks.py`), and TIFFs of a few bytes.

use mmxrt::formats::raster::Raster;
use mmxrt::formats::registry;

use crate::cli::run;
use crate::elevation_files::{assert_band, has_none, open, path, quarters, refused, said};
use crate::scratch::Scratch;

/// A directory of a little-endian TIFF but for its strip's place: tags with their numbers; and the bytes of its one strip.
pub(crate) struct Directory<'a> {
    pub(crate) tags: Vec<(u16, Kind)>,
    pub(crate) strip: &'a [u8],
}

pub(crate) enum Kind {
    Short(Vec<u16>),
    Double(Vec<f64>),
}

/// The file of some directories, one behind the other.
pub(crate) fn tiff(directories: &[Directory<'_>]) -> Vec<u8> {
    let mut bytes = b"II*\0".to_vec();
    // Where the place of the next directory stands.
    let mut link = bytes.len();
    bytes.extend([0; 4]);
    for directory in directories {
        let (strip_at, strip_length) = (bytes.len(), directory.strip.len());
        bytes.extend(directory.strip);
        let mut entries: Vec<(u16, u16, u32, Vec<u8>)> = vec![
            (273, 4, 1, (strip_at as u32).to_le_bytes().to_vec()),
            (279, 4, 1, (strip_length as u32).to_le_bytes().to_vec()),
        ];
        for (tag, kind) in &directory.tags {
            let (kind, count, value) = match kind {
                Kind::Short(all) => (3, all.len(), all.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>()),
                Kind::Double(all) => (12, all.len(), all.iter().flat_map(|n| n.to_le_bytes()).collect()),
            };
            let value = if value.len() <= 4 {
                value
            } else {
                let at = bytes.len() as u32;
                bytes.extend(value);
                at.to_le_bytes().to_vec()
            };
            entries.push((*tag, kind, count as u32, value));
        }
        entries.sort();
        let at = bytes.len() as u32;
        bytes[link..link + 4].copy_from_slice(&at.to_le_bytes());
        bytes.extend((entries.len() as u16).to_le_bytes());
        for (tag, kind, count, mut value) in entries {
            value.resize(4, 0);
            bytes.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
            bytes.extend(count.to_le_bytes());
            bytes.extend(value);
        }
        link = bytes.len();
        bytes.extend([0; 4]);
    }
    bytes
}

/// Size, samples of a pixel, bits of a sample.
pub(crate) fn image(columns: u16, rows: u16, samples: u16, bits: u16) -> Vec<(u16, Kind)> {
    let one = |n: u16| Kind::Short(vec![n]);
    vec![(256, one(columns)), (257, one(rows)), (258, Kind::Short(vec![bits; samples.into()])), (277, one(samples))]
}

fn with(mut tags: Vec<(u16, Kind)>, more: &[(u16, u16)]) -> Vec<(u16, Kind)> {
    tags.extend(more.iter().map(|(tag, n)| (*tag, Kind::Short(vec![*n]))));
    tags
}

fn values(raster: &mut Raster, band: usize) -> Vec<f64> {
    let mut values = Vec::new();
    raster.read(band, &mut values).unwrap();
    values
}

fn stored(row: usize, column: usize) -> f64 {
    if has_none(row, column) { f64::NAN } else { quarters(row, column) }
}

#[test]
fn what_gdal_masks_has_no_data() {
    for name in ["mask_within.tif", "mask_beside.tif"] {
        let mut raster = open(&path(name));
        assert_eq!(raster.bands.len(), 1, "{name}");
        assert_band(&mut raster, 0, stored);
        assert!(said(&raster).contains("a mask: where it is 0 there is no data"), "{}", said(&raster));
        // Whether a pixel is valid does not say what share of it is covered.
        assert_eq!(raster.coverage().unwrap(), None, "{name}");
    }
    assert_eq!(open(&path("mask_beside.tif")).files().len(), 2);
    let mut raster = open(&path("alpha.tif"));
    assert_eq!(raster.bands.len(), 1);
    assert_band(&mut raster, 0, |row, column| stored(row, column) + 1000.0);
    let covered = (0..16 * 24).map(|i| f64::from(u8::from(!has_none(i / 24, i % 24)))).collect::<Vec<f64>>();
    assert_eq!(raster.coverage().unwrap(), Some(&covered[..]));
    // What is converted keeps the holes, though integers have no number for them.
    let folder = Scratch::new();
    let (source, target) = (path("mask_within.tif").to_string_lossy().into_owned(), folder.argument("a.img"));
    let (code, out, err) = run(&["convert", &source, &target]);
    assert_eq!(code, 0, "{out}{err}");
    assert_band(&mut open(&folder.join("a.img")), 0, stored);
    // An elevation model with holes is refused as one is whose holes are numbers.
    let recipe = folder.write(
        "r.toml",
        format!("version = 2\nseed = 1\nsize_m = 400.0\nfacets = 1000\nrelief = [{{ kind = \"elevation\", file = {source:?} }}]\n"),
    );
    let (code, out, err) = run(&["landscape", &recipe.to_string_lossy(), "-o", &folder.argument("l.obj")]);
    assert!(code == 1 && err.contains("3 of 384 pixels") && err.contains("column 5, line 2"), "{out}{err}");
}

#[test]
fn masks_are_bits_or_bytes_and_are_taken_whole_or_refused() {
    let folder = Scratch::new();
    let write = |directories: &[Directory<'_>]| folder.write("a.tif", tiff(directories));
    let main = || Directory {
        tags: image(9, 2, 1, 8),
        strip: &[1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15, 16, 17, 18, 19],
    };
    let small = || Directory { tags: with(image(1, 1, 1, 8), &[(254, 1)]), strip: &[7] };
    let small_mask = || Directory { tags: with(image(1, 1, 1, 1), &[(254, 5)]), strip: &[0] };
    // Nine bits take two bytes of each line; the last seven of them are of no meaning.
    let bits =
        Directory { tags: with(image(9, 2, 1, 1), &[(254, 4), (262, 4)]), strip: &[0b0111_1111, 0x7f, 0xff, 0xff] };
    let expected = |hidden: &[usize]| -> Vec<f64> {
        let all = (1..=9).chain(11..=19).map(f64::from);
        all.enumerate().map(|(i, value)| if hidden.contains(&i) { f64::NAN } else { value }).collect()
    };
    let same = |a: &[f64], b: &[f64]| a.iter().map(|v| v.to_bits()).eq(b.iter().map(|v| v.to_bits()));
    // Behind a smaller copy and its mask, which are passed over.
    let mut raster = open(&write(&[main(), small(), small_mask(), bits]));
    assert!(same(&values(&mut raster, 0), &expected(&[0, 8])), "{:?}", values(&mut raster, 0));
    assert!(!said(&raster).contains("further images"), "{}", said(&raster));
    let bytes = |strip| Directory { tags: with(image(9, 2, 1, 8), &[(254, 4)]), strip };
    let mut one = [255; 18];
    one[10] = 0;
    assert!(same(&values(&mut open(&write(&[main(), bytes(&one)])), 0), &expected(&[10])));
    assert!(same(&values(&mut open(&write(&[main(), bytes(&[0; 18])])), 0), &[f64::NAN; 18]));
    // The mask of a further image is not that of the first.
    let mut raster = open(&write(&[main(), main(), bytes(&[0; 18])]));
    assert!(same(&values(&mut raster, 0), &expected(&[])) && said(&raster).contains("further images"));

    let of_size = |tags| Directory { tags, strip: &[255; 18] };
    for (mask, message) in [
        (of_size(with(image(2, 2, 1, 8), &[(254, 4)])), "the mask has 2 x 2 pixels, and the image 9 x 2"),
        (of_size(with(image(2, 9, 1, 8), &[(254, 4)])), "the mask has 2 x 9 pixels, and the image 9 x 2"),
        (of_size(with(image(3, 2, 3, 8), &[(254, 4)])), "a mask of 3 bands"),
        (of_size(with(image(9, 2, 1, 8), &[(254, 4), (259, 7)])), "packed by JPEG"),
        (of_size(with(image(9, 2, 1, 4), &[(254, 4)])), "integers of 4 bits"),
        (of_size(with(image(9, 2, 1, 1), &[(254, 4), (266, 2)])), "bits in another order"),
    ] {
        let error = refused(&write(&[main(), mask]));
        assert!(error.contains(message) && error.contains("gdalwarp -dstnodata"), "{message}: {error}");
    }
    let error = refused(&write(&[main(), bytes(&one), bytes(&one)]));
    assert!(error.contains("a second mask"), "{error}");
    // A mask that is cut off is not passed over.
    let whole = tiff(&[main(), bytes(&one)]);
    let error = refused(&folder.write("a.tif", &whole[..whole.len() - 20]));
    assert!(error.contains("a further image or mask"), "{error}");
    // One within, and one beside.
    write(&[main(), bytes(&one)]);
    folder.write("a.tif.msk", tiff(&[main()]));
    assert!(refused(&folder.join("a.tif")).contains("a second mask"));
    // Of any format.
    folder.write("b.pgm", "P2\n2 1\n10\n1 2\n");
    folder.write("b.pgm.msk", tiff(&[Directory { tags: image(2, 1, 1, 8), strip: &[0, 255] }]));
    let found = values(&mut open(&folder.join("b.pgm")), 0);
    assert!(found[0].is_nan() && found[1] == 0.2, "{found:?}");
}

#[test]
fn coverage_in_tiff_is_divided_out_only_where_it_was_multiplied_in() {
    let folder = Scratch::new();
    // A colour, and coverage of none, a fifth and all.
    let file = |extra: u16, samples: u16, strip: &[u8]| {
        let columns = strip.len() as u16 / samples;
        tiff(&[Directory { tags: with(image(columns, 1, samples, 8), &[(338, extra)]), strip }])
    };
    let strip = [9, 0, 10, 51, 30, 255];
    let read = |extra| {
        let mut raster =
            registry::image(&folder.write("a.tif", file(extra, 2, &strip))).unwrap_or_else(|e| panic!("{e}"));
        let all: Vec<Vec<f64>> = (0..raster.bands.len()).map(|band| values(&mut raster, band)).collect();
        (all, raster.coverage().unwrap().map(<[f64]>::to_vec))
    };
    let (multiplied, coverage) = read(1);
    assert!(multiplied.len() == 1 && multiplied[0][0].is_nan() && multiplied[0][1..] == [50.0, 30.0], "{multiplied:?}");
    assert_eq!(coverage, Some(vec![0.0, 0.2, 1.0]));
    let (apart, coverage) = read(2);
    assert!(apart.len() == 1 && apart[0][0].is_nan() && apart[0][1..] == [10.0, 30.0], "{apart:?}");
    assert_eq!(coverage, Some(vec![0.0, 0.2, 1.0]));
    // A further band of no stated meaning is a band.
    let (bands, coverage) = read(0);
    assert_eq!((bands, coverage), (vec![vec![9.0, 10.0, 30.0], vec![0.0, 51.0, 255.0]], None));
    // Alone it is what the image is of.
    let mut alone = open(&folder.write("a.tif", file(2, 1, &strip)));
    assert_eq!(values(&mut alone, 0), [9.0, 0.0, 10.0, 51.0, 30.0, 255.0]);
    let mut tags = image(1, 1, 3, 8);
    tags.push((338, Kind::Short(vec![2, 2])));
    let two = tiff(&[Directory { tags, strip: &[1, 2, 3] }]);
    let error = refused(&folder.write("a.tif", two));
    assert!(error.contains("2 of 3 bands are said to be coverage") && error.contains("gdal_translate -b 1"), "{error}");
}
