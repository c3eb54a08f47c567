//! Cubes of several slabs: a tunable filter, a push-broom, several poses.

use mmxrt::formats::envi::{self, Interleave, Precision};
use mmxrt::geometry::Direction;
use mmxrt::product::{Cube, Slab};
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
    ((0..cube.bands.len()).map(|band| cube.band(band)).collect(), std::fs::read(&path).unwrap())
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
    let all = Cube::new(12, 12, bands.clone(), [2, 0, 1].map(slab).to_vec()).unwrap();
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
    let bands = frame.exposure.bands.clone();
    let lines = Cube::new(12, 12, bands, (0..12).map(slab).collect()).unwrap();
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
    let smeared = Cube::new(12, 12, still.exposure.bands.clone(), vec![Slab::sum(&parts).unwrap()]).unwrap();
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
    let two = || vec![Band::new(1.0, None), Band::new(2.0, None)];
    let made = |slabs: Vec<Slab>| Cube::new(2, 3, two(), slabs).map_err(|e| e.to_string());
    assert_eq!(made(vec![slab(0..3, 1..2), slab(0..1, 0..1), slab(1..3, 0..1)]).unwrap().band(1), [0.0; 6]);
    for (slabs, told) in [
        (vec![], "slabs hold 0 of 6"),
        (vec![slab(0..2, 0..2)], "slabs hold 4 of 6"),
        (vec![slab(0..3, 0..2), slab(2..3, 1..2)], "slab 1: overlaps slab 0"),
        (vec![slab(0..4, 0..2)], "reaches beyond 3 lines and 2 bands"),
        (vec![Slab { row: vec![0], ..slab(0..3, 0..2) }], "are not those of 6 pixels"),
        (vec![Slab { added: vec![1.0; 3], ..slab(0..3, 0..2) }], "has not 2 bands of 6 pixels"),
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
                    slab.added = (0..pixels * of_bands.len()).map(|_| (r.bits() % 50) as f64).collect();
                    for (k, band) in of_bands.clone().enumerate() {
                        for pixel in 0..pixels {
                            array[band][of_lines.start * samples + pixel] += slab.added[k * pixels + pixel];
                        }
                    }
                }
                slabs.push(slab);
            }
        }
        for i in (1..slabs.len()).rev() {
            slabs.swap(i, (r.bits() % (i as u64 + 1)) as usize);
        }
        slabs_seen += slabs.len();
        out_of_order += usize::from(slabs.windows(2).any(|w| w[0].lines.start > w[1].lines.start));
        let all = (0..bands).map(|i| Band::new(1.0 + i as f64, None)).collect();
        let cube = Cube::new(samples, lines, all, slabs).unwrap();
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
    let one = || vec![Band::new(1.0, None)];
    assert_eq!(Cube::new(1, 1, one(), vec![good.clone()]).unwrap().band(0), [2.0]);
    let damaged = [
        Slab { row_start: vec![], ..good.clone() },
        Slab { row_start: vec![0, 9], ..good.clone() },
        Slab { row_start: vec![1, 1], ..good.clone() },
        Slab { row: vec![7], ..good.clone() },
        Slab { weight: vec![], ..good.clone() },
        Slab { spectra: vec![], ..good.clone() },
        Slab { lines: 0..usize::MAX, ..good.clone() },
        Slab { lines: usize::MAX - 1..usize::MAX, bands: 5..6, ..good.clone() },
    ];
    for slab in damaged {
        assert!(Cube::new(usize::MAX / 4, 1, one(), vec![slab.clone()]).is_err(), "{slab:?}");
        assert!(Cube::new(1, 1, one(), vec![slab.clone()]).is_err(), "{slab:?}");
        assert!(slab == good || Slab::sum(&[(0.5, slab.clone()), (0.5, good.clone())]).is_none(), "{slab:?}");
    }
}
