//! Cubes of several slabs: a tunable filter, a push-broom, several poses; and how slabs are written one by one.

use mmxrt::Error;
use mmxrt::formats::envi::{self, Interleave, Precision};
use mmxrt::formats::exr_cube;
use mmxrt::geometry::Direction;
use mmxrt::product::{Added, Cube, CubeAxes, Filling, Quantity, ShownBands, Slab};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Exposure, Scene, Sky, Sun, Thermal};
use mmxrt::spectral::Band;
use mmxrt::study;

use crate::scenes::{edited, scene};
use crate::scratch::Scratch;
use crate::shapes::{Random, camera, cuboid, grid, joined, of_material};

/// A warm site with shadows in three bands.
fn site() -> Scene {
    let hills = grid(10.0, 20, |x, y| (0.7 * x).sin() * (0.5 * y).cos());
    let mesh = of_material(joined(&[hills, cuboid([-3.0, -2.0, -1.0], [0.0, 1.0, 4.0])]), 0);
    let view = camera([20.0, -30.0, 40.0], [0.0; 3], [0.0, 0.0, 1.0], 12, 0.04);
    edited(&scene(mesh, view, [1.0, 0.2, 0.4]), |parts| {
        parts.models.thermal = Thermal::Equilibrium;
        parts.exposure.bands = [1.0, 2.5, 3.6].map(|centre_um| Band::new(centre_um, Some(0.1))).to_vec();
    })
}

/// Axes of bands at 1, 2, 3 ... um.
fn axes(samples: usize, lines: usize, bands: usize) -> CubeAxes {
    let bands = (0..bands).map(|i| Band::new(1.0 + i as f64, None)).collect();
    CubeAxes { samples, lines, bands, quantity: Quantity::Radiance }
}

fn added(start: &[usize], values: usize) -> Added {
    Added { start: start.to_vec(), radiance: vec![1.0; values] }
}

fn cube(scene: &Scene) -> Cube {
    study::simulate(scene, &unwatched).unwrap().1.cube
}

fn only_slab(scene: &Scene) -> Slab {
    let [slab] = <[Slab; 1]>::try_from(cube(scene).into_slabs()).unwrap();
    slab
}

/// Of all bands the values, and how they are written.
fn bands_and_bytes(cube: &Cube, interleave: Interleave) -> (Vec<Vec<f64>>, Vec<u8>) {
    let scratch = Scratch::new();
    let path = scratch.join("cube.img");
    envi::write_cube(&path, cube, interleave, Precision::F64, "", &unwatched).unwrap();
    ((0..cube.axes.bands.len()).map(|band| cube.band(band)).collect(), std::fs::read(&path).unwrap())
}

#[test]
fn a_tunable_filter_has_a_sky_for_each_band() {
    let first = site();
    let bands = first.exposure.bands.clone();
    // The Sun moves by 2 degrees from band to band.
    let under = |band: usize| {
        let turn = glam::DMat3::from_rotation_z((2.0 * band as f64).to_radians());
        let direction = Direction::new(turn * first.sky.sun.direction.vec()).unwrap();
        let sky = Sky { sun: Sun { direction, ..first.sky.sun.clone() }, ..first.sky.clone() };
        first.under(sky).unwrap()
    };
    let slab = |band: usize| {
        let exposure = Exposure { bands: vec![bands[band].clone()], ..first.exposure.clone() };
        Slab { bands: band..band + 1, ..only_slab(&under(band).seen_by(exposure).unwrap()) }
    };
    // In any order.
    let all = Cube::new(CubeAxes::of(&first.exposure), [2, 0, 1].map(slab).to_vec()).unwrap();
    let (values, bytes) = bands_and_bytes(&all, Interleave::Bsq);
    for (band, values) in values.iter().enumerate() {
        // Few bands have a row of heat each, as one alone has: the same numbers.
        assert_eq!(*values, cube(&under(band)).band(band), "band {band}");
    }
    assert_ne!(values[2], cube(&first).band(2));
    let written: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(written, values.concat());
}

#[test]
fn a_push_broom_has_a_slab_for_each_line() {
    let frame = site();
    let slab = |line: u32| {
        let camera = frame.exposure.camera.window(0..12, line..line + 1);
        let at = line as usize;
        Slab { lines: at..at + 1, ..only_slab(&frame.seen_by(Exposure { camera, ..frame.exposure.clone() }).unwrap()) }
    };
    let lines = Cube::new(CubeAxes::of(&frame.exposure), (0..12).map(slab).collect()).unwrap();
    let whole = cube(&frame);
    for interleave in [Interleave::Bsq, Interleave::Bil, Interleave::Bip] {
        let ((ours, _), (theirs, _)) = (bands_and_bytes(&lines, interleave), bands_and_bytes(&whole, interleave));
        for (ours, theirs) in ours.iter().zip(&theirs) {
            let largest = theirs.iter().copied().fold(0.0, f64::max);
            assert!(largest > 0.0 && ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 1e-11 * largest));
        }
    }
    // Reflected and emitted parts stay apart.
    assert!(lines.thermal().band(2).iter().zip(whole.thermal().band(2)).all(|(a, b)| (a - b).abs() < 1e-11));
}

#[test]
fn several_poses_add_up_with_their_weights() {
    let still = site();
    let moved = |by_px: f64| {
        let mut exposure = still.exposure.clone();
        exposure.camera.boresight_px[0] += by_px;
        still.seen_by(exposure).unwrap()
    };
    let poses = [(0.25, -0.3), (0.5, 0.0), (0.25, 0.3)];
    let parts = poses.map(|(share, by_px)| (share, only_slab(&moved(by_px))));
    let smeared = Cube::new(CubeAxes::of(&still.exposure), vec![Slab::sum(&parts).unwrap()]).unwrap();
    let each = poses.map(|(share, by_px)| (share, cube(&moved(by_px))));
    for band in 0..3 {
        let values = smeared.band(band);
        let largest = values.iter().copied().fold(0.0, f64::max);
        for (pixel, value) in values.iter().enumerate() {
            let sum: f64 = each.iter().map(|(share, cube)| share * cube.band(band)[pixel]).sum();
            assert!((value - sum).abs() < 1e-14 * largest, "{band} {pixel}: {value} {sum}");
        }
    }
    let (one, other) = (parts[0].1.clone(), Slab { lines: 1..13, ..parts[1].1.clone() });
    assert!(Slab::sum(&[(0.5, one), (0.5, other)]).is_none() && Slab::sum(&[]).is_none());
}

#[test]
fn slabs_that_do_not_fill_a_cube_once_are_refused() {
    let slab = |lines: std::ops::Range<usize>, bands: std::ops::Range<usize>| Slab {
        row_start: vec![0; 2 * lines.len() + 1],
        lines,
        bands,
        ..Slab::default()
    };
    let made = |slabs: Vec<Slab>| Cube::new(axes(2, 3, 2), slabs).map_err(|e| e.to_string());
    assert_eq!(made(vec![slab(0..3, 1..2), slab(0..1, 0..1), slab(1..3, 0..1)]).unwrap().band(1), [0.0; 6]);
    for (slabs, told) in [
        (vec![], "slabs hold 0 of 6"),
        (vec![slab(0..2, 0..2)], "slabs hold 4 of 6"),
        (
            vec![slab(0..3, 0..2), slab(2..3, 1..2)],
            "slab of lines 2..3, bands 1..2 (from 0): overlaps slab of lines 0..3, bands 0..2",
        ),
        (vec![slab(0..4, 0..2)], "reaches beyond 3 lines and 2 bands"),
        (vec![Slab { row: vec![0], ..slab(0..3, 0..2) }], "are not those of 6 pixels"),
        (vec![Slab { added: added(&[0, 1, 2, 3], 6), ..slab(0..3, 0..2) }], "has not 2 bands of 6 pixels"),
        (vec![Slab { added: added(&[0, 0, 0, 1, 1, 1, 1], 3), ..slab(0..3, 0..2) }], "has not 2 bands of 6 pixels"),
        (vec![Slab { added: added(&[0, 0, 0, 2, 2, 2, 2], 4), ..slab(0..3, 0..2) }], "has not 2 bands of 6 pixels"),
        (vec![Slab { added: added(&[0, 1, 0, 1, 1, 1, 1], 2), ..slab(0..3, 0..2) }], "has not 2 bands of 6 pixels"),
        (vec![Slab { added: added(&[], 2), ..slab(0..3, 0..2) }], "has not 2 bands of 6 pixels"),
    ] {
        let error = made(slabs).unwrap_err();
        assert!(error.contains(told), "{error}");
    }
}

/// Cuts of a range into some parts.
fn parts(r: &mut Random, range: std::ops::Range<usize>) -> Vec<std::ops::Range<usize>> {
    let mut ends: Vec<usize> = (range.start + 1..range.end).filter(|_| r.share() < 0.3).collect();
    ends.push(range.end);
    let starts = [range.start].into_iter().chain(ends.clone());
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

/// Slabs of any shape, in any order, against an array that is filled value by value.
#[test]
fn slabs_of_any_shape_and_order_are_the_array_they_were_cut_from() {
    let mut r = Random(7);
    let (mut slabs_seen, mut out_of_order) = (0, 0);
    for _ in 0..60 {
        let (samples, lines, bands) =
            (1 + (r.bits() % 5) as usize, 1 + (r.bits() % 7) as usize, 1 + (r.bits() % 23) as usize);
        let mut array = vec![vec![0.0; samples * lines]; bands];
        let mut slabs = Vec::new();
        for of_bands in parts(&mut r, 0..bands) {
            for of_lines in parts(&mut r, 0..lines) {
                let pixels = samples * of_lines.len();
                let rows = 1 + (r.bits() % 4) as usize;
                let mut slab =
                    Slab { lines: of_lines.clone(), bands: of_bands.clone(), row_start: vec![0], ..Slab::default() };
                // Whole numbers: sums are exact in any order.
                slab.spectra = (0..rows * of_bands.len()).map(|_| (r.bits() % 100) as f64).collect();
                for pixel in 0..pixels {
                    for row in 0..rows as u32 {
                        if r.share() > 0.7 {
                            continue;
                        }
                        let weight = (r.bits() % 10) as f64;
                        slab.row.push(row);
                        slab.weight.push(weight);
                        for (k, band) in of_bands.clone().enumerate() {
                            let value = weight * slab.spectra[row as usize * of_bands.len() + k];
                            array[band][of_lines.start * samples + pixel] += value;
                        }
                    }
                    slab.row_start.push(slab.row.len());
                }
                if r.share() < 0.3 {
                    let is_reached: Vec<bool> = (0..pixels).map(|_| r.share() < 0.4).collect();
                    slab.added = Added::zeros(is_reached.iter().copied(), of_bands.len());
                    let mut radiance = slab.added.radiance.iter_mut();
                    for band in of_bands.clone() {
                        for pixel in (0..pixels).filter(|pixel| is_reached[*pixel]) {
                            let value = (r.bits() % 50) as f64;
                            *radiance.next().unwrap() = value;
                            array[band][of_lines.start * samples + pixel] += value;
                        }
                    }
                    assert!(radiance.next().is_none());
                }
                slabs.push(slab);
            }
        }
        for i in (1..slabs.len()).rev() {
            slabs.swap(i, (r.bits() % (i as u64 + 1)) as usize);
        }
        slabs_seen += slabs.len();
        out_of_order += usize::from(slabs.windows(2).any(|w| w[0].lines.start > w[1].lines.start));
        let cube = Cube::new(axes(samples, lines, bands), slabs).unwrap();
        let of_cube: Vec<Vec<f64>> = (0..bands).map(|band| cube.band(band)).collect();
        assert_eq!(of_cube, array);
        let by_pixel = cube.to_array();
        for interleave in [Interleave::Bsq, Interleave::Bil, Interleave::Bip] {
            let (_, bytes) = bands_and_bytes(&cube, interleave);
            let written = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap()));
            for (i, value) in written.enumerate() {
                let (line, sample, band) = match interleave {
                    Interleave::Bsq => (i / samples % lines, i % samples, i / samples / lines),
                    Interleave::Bil => (i / samples / bands, i % samples, i / samples % bands),
                    Interleave::Bip => (i / bands / samples, i / bands % samples, i % bands),
                };
                assert_eq!(value, array[band][line * samples + sample], "{interleave:?} {i}");
                assert_eq!(value, by_pixel[[line, sample, band]]);
            }
        }
    }
    assert!(slabs_seen > 300 && out_of_order > 20, "{slabs_seen} {out_of_order}");
}

#[test]
fn damaged_slabs_are_told_and_never_looked_into() {
    let good = Slab {
        lines: 0..1,
        bands: 0..1,
        row_start: vec![0, 1],
        row: vec![0],
        weight: vec![1.0],
        spectra: vec![2.0],
        ..Slab::default()
    };
    assert_eq!(Cube::new(axes(1, 1, 1), vec![good.clone()]).unwrap().band(0), [2.0]);
    // More pixels than can be counted.
    assert!(Cube::new(axes(usize::MAX / 4, 8, 1), vec![Slab { lines: 0..8, ..good.clone() }]).is_err());
    let damaged = [
        Slab { row_start: vec![], ..good.clone() },
        Slab { row_start: vec![0, 9], ..good.clone() },
        Slab { row_start: vec![1, 1], ..good.clone() },
        Slab { row: vec![7], ..good.clone() },
        Slab { weight: vec![], ..good.clone() },
        Slab { spectra: vec![], ..good.clone() },
        Slab { lines: 0..usize::MAX, ..good.clone() },
        Slab { lines: std::ops::Range { start: usize::MAX, end: 0 }, ..good.clone() },
        Slab { added: added(&[0, 1], 2), ..good.clone() },
        Slab { lines: usize::MAX - 1..usize::MAX, bands: 5..6, ..good.clone() },
    ];
    for slab in damaged {
        assert!(Cube::new(axes(usize::MAX / 4, 1, 1), vec![slab.clone()]).is_err(), "{slab:?}");
        assert!(Cube::new(axes(1, 1, 1), vec![slab.clone()]).is_err(), "{slab:?}");
        assert!(slab == good || Slab::sum(&[(0.5, slab.clone()), (0.5, good.clone())]).is_none(), "{slab:?}");
    }
}

/// Radiance that is another in each pixel and band, exactly, also in single precision.
fn radiance(sample: usize, line: usize, band: usize) -> f64 {
    (1 + sample + 100 * line + 10_000 * band) as f64
}

/// A slab of it: sample and line come by weights, the band by what is added, in every other pixel; elsewhere by a row of its own.
fn numbered(samples: usize, lines: std::ops::Range<usize>, bands: std::ops::Range<usize>) -> Slab {
    let pixels = lines.clone().flat_map(|line| (0..samples).map(move |sample| (sample, line)));
    let is_reached = |(sample, line): (usize, usize)| (sample + line) % 2 == 0;
    let mut slab = Slab { row_start: vec![0], ..Slab::default() };
    for (sample, line) in pixels.clone() {
        slab.row.push(0);
        slab.weight.push(radiance(sample, line, 0));
        if !is_reached((sample, line)) {
            slab.row.push(1);
            slab.weight.push(1.0);
        }
        slab.row_start.push(slab.row.len());
    }
    let of_band = |band: usize| (10_000 * band) as f64;
    slab.spectra = bands.clone().map(|_| 1.0).chain(bands.clone().map(of_band)).collect();
    slab.added = Added::zeros(pixels.map(is_reached), bands.len());
    let reached = slab.added.reached();
    for (i, band) in bands.clone().enumerate() {
        slab.added.radiance[i * reached..][..reached].fill(of_band(band));
    }
    Slab { lines, bands, ..slab }
}

/// Blocks of at most so many lines and bands, which fill a cube, in an order of their own.
fn blocks(axes: &CubeAxes, lines: usize, bands: usize, r: &mut Random) -> Vec<[std::ops::Range<usize>; 2]> {
    let cut = |all: usize, step: usize| (0..all).step_by(step).map(move |first| first..all.min(first + step));
    let of_lines = |of_lines: std::ops::Range<usize>| cut(axes.bands.len(), bands).map(move |b| [of_lines.clone(), b]);
    let mut blocks: Vec<_> = cut(axes.lines, lines).flat_map(of_lines).collect();
    for i in (1..blocks.len()).rev() {
        blocks.swap(i, (r.bits() % (i as u64 + 1)) as usize);
    }
    blocks
}

#[test]
fn slabs_that_are_written_in_turn_are_the_file_that_their_numbers_are() {
    let mut r = Random(3);
    let scratch = Scratch::new();
    let path = scratch.join("cube.img");
    let mut written_blocks = 0;
    // More pixels than are expanded at a time in one of them, lines and bands that divide by nothing, single pixels.
    for [samples, lines, bands] in [[7, 37, 19], [131, 35, 5], [1, 1, 1], [1, 40, 3], [9, 1, 33]] {
        let axes = axes(samples, lines, bands);
        // A frame camera, a push-broom, a tunable filter, tiles of one by one, tiles that do not divide.
        for (block_lines, block_bands) in [(lines, bands), (1, bands), (lines, 1), (1, 1), (3, 2), (17, 16)] {
            let blocks = blocks(&axes, block_lines, block_bands, &mut r);
            written_blocks += blocks.len();
            for interleave in [Interleave::Bsq, Interleave::Bil, Interleave::Bip] {
                let mut file = envi::EnviCube::create(&path, axes.clone(), interleave, Precision::F64, "x").unwrap();
                for [lines, bands] in &blocks {
                    // Made, written and dropped.
                    file.put(&numbered(samples, lines.clone(), bands.clone()), &unwatched).unwrap();
                }
                assert!(!scratch.join("cube.hdr").exists());
                file.end().unwrap();
                let bytes = std::fs::read(&path).unwrap();
                assert_eq!(bytes.len(), samples * lines * bands * 8);
                for (i, value) in bytes.chunks_exact(8).enumerate() {
                    let (line, sample, band) = match interleave {
                        Interleave::Bsq => (i / samples % lines, i % samples, i / samples / lines),
                        Interleave::Bil => (i / samples / bands, i % samples, i / samples % bands),
                        Interleave::Bip => (i / bands / samples, i / bands % samples, i % bands),
                    };
                    let value = f64::from_le_bytes(value.try_into().unwrap());
                    assert_eq!(value, radiance(sample, line, band), "{interleave:?} {i}");
                }
                std::fs::remove_file(scratch.join("cube.hdr")).unwrap();
            }
        }
    }
    assert!(written_blocks > 1000);
}

#[test]
fn open_exr_takes_slabs_in_any_order_of_lines_and_wavelengths() {
    use exr::prelude::*;
    let mut r = Random(4);
    let scratch = Scratch::new();
    let path = scratch.join("cube.exr");
    let mut axes = axes(5, 21, 6);
    // Channels are in the order of wavelength.
    let um = [3.0, 0.5, 2.0, 1.0, 2.5, 0.9];
    axes.bands.iter_mut().zip(um).for_each(|(band, um)| band.centre_um = um);
    for (block_lines, block_bands) in [(21, 6), (1, 6), (21, 1), (1, 1), (4, 5)] {
        let mut file = exr_cube::ExrCube::create(&path, &axes, "x").unwrap();
        for [lines, bands] in blocks(&axes, block_lines, block_bands, &mut r) {
            file.put(&numbered(5, lines, bands), &unwatched).unwrap();
        }
        file.end().unwrap();
        let image = read_first_flat_layer_from_file(&path).unwrap();
        let channels = &image.layer_data.channel_data.list;
        assert_eq!(channels.len(), 6);
        for (channel, band) in channels.iter().zip([1, 5, 3, 2, 4, 0]) {
            let expected: Vec<f32> = (0..105).map(|pixel| radiance(pixel % 5, pixel / 5, band) as f32).collect();
            assert_eq!(channel.sample_data.values_as_f32().collect::<Vec<f32>>(), expected);
        }
    }
}

#[test]
fn a_slab_that_is_missing_or_comes_twice_is_no_file() {
    let scratch = Scratch::new();
    let path = scratch.join("cube.img");
    for interleave in [Interleave::Bsq, Interleave::Bil, Interleave::Bip] {
        let begun = || envi::EnviCube::create(&path, axes(3, 4, 2), interleave, Precision::F32, "x").unwrap();
        let mut file = begun();
        file.put(&numbered(3, 0..4, 1..2), &unwatched).unwrap();
        let twice = file.put(&numbered(3, 2..3, 0..2), &unwatched).unwrap_err().to_string();
        assert!(twice.contains("lines 2..3, bands 0..2 (from 0): overlaps slab of lines 0..4, bands 1..2"), "{twice}");
        let beyond = file.put(&numbered(3, 3..5, 0..1), &unwatched).unwrap_err().to_string();
        assert!(beyond.contains("bands 0..1 (from 0): reaches beyond 4 lines and 2 bands"), "{beyond}");
        let narrow = file.put(&numbered(2, 0..4, 0..1), &unwatched).unwrap_err().to_string();
        assert!(narrow.contains("bands 0..1 (from 0): 12 weights of 2 rows are not those of 12 pixels"), "{narrow}");
        // One that was refused, or in whose middle writing ended, does not count.
        let stop = |_| false;
        assert!(matches!(file.put(&numbered(3, 0..4, 0..1), &stop), Err(Error::Interrupted)));
        let missing = file.end().unwrap_err().to_string();
        assert!(missing.contains("cube: slabs hold 4 of 8 lines of bands"), "{missing}");
        let mut file = begun();
        file.put(&numbered(3, 0..4, 1..2), &unwatched).unwrap();
        file.put(&numbered(3, 0..3, 0..1), &unwatched).unwrap();
        let missing = file.end().unwrap_err().to_string();
        assert!(missing.contains("cube: slabs hold 7 of 8 lines of bands"), "{missing}");
        // What tells readers of the numbers was never written.
        assert!(!scratch.join("cube.hdr").exists());
    }
    let mut file = exr_cube::ExrCube::create(&scratch.join("cube.exr"), &axes(3, 4, 2), "x").unwrap();
    file.put(&numbered(3, 0..4, 1..2), &unwatched).unwrap();
    assert!(file.put(&numbered(3, 0..4, 1..2), &unwatched).is_err());
    assert!(exr_cube::ExrCube::create(&scratch.join("cube.exr"), &axes(3, 4, 2), "x").unwrap().end().is_err());
    let mut shown = ShownBands::new(axes(3, 4, 2), [1, 7]);
    shown.take(&numbered(3, 0..4, 0..2)).unwrap();
    assert_eq!((shown.band(1)[11], shown.band(0).len(), shown.band(7).len()), (radiance(2, 3, 1), 0, 0));
    assert!(shown.take(&numbered(3, 0..4, 0..2)).is_err());
}

/// A cube of 1e15 numbers counts its slabs as any other.
#[test]
fn what_fills_a_cube_is_counted_not_held() {
    let huge = axes(0, 1_000_000_000_000, 1000);
    let mut filling = Filling::new(&huge);
    let slab = |lines, bands| Slab { lines, bands, row_start: vec![0], ..Slab::default() };
    filling.add(&slab(0..1_000_000_000_000, 1..1000));
    filling.add(&slab(5..1_000_000_000_000, 0..1));
    assert!(filling.end().unwrap_err().to_string().contains("999999999999995 of 1000000000000000"));
    assert!(filling.admits(&slab(0..5, 0..1)).is_ok() && filling.admits(&slab(4..6, 0..1)).is_err());
}

#[test]
fn a_sum_of_poses_adds_what_maps_add_where_any_of_them_reaches() {
    let slab = |start: &[usize], radiance: &[f64]| Slab {
        lines: 0..1,
        bands: 0..2,
        row_start: vec![0; 4],
        added: Added { start: start.to_vec(), radiance: radiance.to_vec() },
        ..Slab::default()
    };
    let parts = [
        (0.5, slab(&[0, 1, 1, 1], &[8.0, 80.0])),
        (0.25, slab(&[0, 1, 2, 2], &[4.0, 16.0, 40.0, 160.0])),
        (0.25, slab(&[], &[])),
    ];
    let sum = Slab::sum(&parts).unwrap();
    // Pixel 2 is reached by none.
    assert_eq!(sum.added, Added { start: vec![0, 1, 2, 2], radiance: vec![5.0, 4.0, 50.0, 40.0] });
    assert_eq!(Slab::sum(&[(1.0, slab(&[], &[]))]).unwrap().added, Added::default());
}
