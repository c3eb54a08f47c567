//! Parts of DART's outputs: images of one type of objects, and the radiative budget of cells.

use std::path::PathBuf;

use mmxrt::formats::dart::output::{self, OutputMapOptions, RegistrationMode};
use mmxrt::formats::registry;
use mmxrt::progress::unwatched;

use crate::cli::run;
use crate::dart_output::{Image, box_on_ground, oblique, options, output_with, view_map};
use crate::scratch::Scratch;

/// The image of the box, of which the ground's has no values in the first five rows.
fn of_ground(folder: &str) -> Image<'_> {
    let mut image = oblique(folder);
    image.values[..60].fill(-1.0);
    image
}

#[test]
fn images_of_one_type_of_objects_are_a_map_with_nothing_elsewhere() {
    let scratch = Scratch::new();
    let output = output_with(&scratch, &oblique("BAND0/BRF/ITER3"));
    output_with(&scratch, &of_ground("2_Ground/BAND0/BRF/ITER2"));
    let all = output::open(&output).unwrap();
    assert_eq!((all.of_type(), all.views()[0].iteration.as_str(), all.views().len()), (None, "ITER3", 1));
    assert!(all.passed_over().contains(&"2_Ground/".to_owned()), "{:?}", all.passed_over());
    for within in ["2_Ground", "2_Ground/BAND0", "2_Ground/BAND0/BRF/ITER2/IMAGES_DART"] {
        let ground = output::open(&output.join(within)).unwrap();
        assert_eq!((ground.of_type(), ground.views().len()), (Some("2_Ground"), 1), "{within}");
        assert_eq!(ground.views()[0].iteration, "ITER2");
        let (code, out, err) = run(&["inspect", output.join(within).to_str().unwrap()]);
        assert!(
            code == 0 && out.contains("type_of_objects: 2_Ground") && out.contains("iteration ITER2"),
            "{out}{err}"
        );
    }
    // Its outline is not that of the scene: it lies where it is said to, or where its corners put it.
    let ground = output::open(&output.join("2_Ground")).unwrap();
    let said = OutputMapOptions { placing: RegistrationMode::Shifted([0.0; 2]), ..options() };
    let said = view_map(&ground, 0, &box_on_ground(), &said).unwrap();
    let outlined = OutputMapOptions { placing: RegistrationMode::Outline, ..options() };
    let (mut map, note) = ground.view_map(0, &box_on_ground(), &outlined, &unwatched).unwrap();
    assert!(note.is_some_and(|note| note.contains("2_Ground alone")), "told");
    assert_eq!(format!("{:?}", map.placement), format!("{:?}", said.placement));
    let mut values = Vec::new();
    map.source.read(0, &mut values).unwrap();
    assert_eq!(values.len(), 16 * 12);
    assert!(values[..60].iter().all(|v| v.is_nan()) && values[60..].iter().all(|v| v.is_finite()));
    // Row 5, column 1: a factor of 5.01 of 852 W m-2 um-1.
    assert!((values[61] - 5.01 * 852.0 / std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn folders_that_only_look_like_those_of_a_type_are_none() {
    let scratch = Scratch::new();
    let output = output_with(&scratch, &oblique("BAND0/BRF/ITER3"));
    for name in ["Ground", "_Ground", "2-Ground", "x2_Ground"] {
        std::fs::create_dir_all(output.join(name)).unwrap();
        let error = output::open(&output.join(name)).unwrap_err().to_string();
        assert!(error.contains("holds no images"), "{error}");
    }
    std::fs::create_dir_all(output.join("101_Empty")).unwrap();
    let error = output::open(&output.join("101_Empty")).unwrap_err().to_string();
    assert!(error.contains("holds no images"), "{error}");
    assert_eq!(output::open(&output).unwrap().views().len(), 1);
}

const CELLS: &str = "3D_2_3_2_Intercepted_+ZFaceEntry.bin";

/// Two variables in two layers of 2 x 3 cells: variable v (from 1), layer k from the top (from 0), row x and column y hold
/// 1000 v + 100 k + 10 x + y.
fn cells(scratch: &Scratch, name: &str) -> PathBuf {
    let mut bytes = Vec::new();
    for v in [1, 2] {
        for k in 0..2 {
            for x in 0..2 {
                bytes.extend((0..3).flat_map(|y| f64::from(1000 * v + 100 * k + 10 * x + y).to_le_bytes()));
            }
        }
    }
    scratch.write(name, bytes)
}

#[test]
fn the_budget_of_cells_is_a_raster_of_layers() {
    let scratch = Scratch::new();
    let path = cells(&scratch, CELLS);
    let (code, out, err) = run(&["inspect", path.to_str().unwrap()]);
    assert_eq!(code, 0, "{err}");
    for wanted in [
        "radiative budget of DART's cells",
        "samples: 3",
        "lines: 2",
        "bands: 4",
        "Intercepted layer 2",
        "mean 1006",
        "+ZFaceEntry layer 1",
        "min 2100",
        "max 2112",
    ] {
        assert!(out.contains(wanted), "{wanted}: {out}");
    }
    let (code, said, err) = run(&["convert", path.to_str().unwrap(), &scratch.argument("cells.npy")]);
    assert!(code == 0, "{said}{err}");
    let mut again = registry::image(&scratch.join("cells.npy")).unwrap();
    assert_eq!([again.rows, again.columns, again.bands.len()], [2, 3, 4]);
    let (mut values, mut all) = (Vec::new(), Vec::new());
    for band in 0..4 {
        again.read(band, &mut values).unwrap();
        all.extend_from_slice(&values);
    }
    let expected = [1, 2].iter().flat_map(|v| {
        (0..2).flat_map(move |k| {
            (0..2).flat_map(move |x| (0..3).map(move |y| f64::from(1000 * v + 100 * k + 10 * x + y)))
        })
    });
    assert_eq!(all, expected.collect::<Vec<_>>());
    // Names go where there is a place for them.
    let (code, _, err) = run(&["convert", path.to_str().unwrap(), &scratch.argument("cells.img")]);
    let header = std::fs::read_to_string(scratch.join("cells.hdr")).unwrap();
    assert!(
        code == 0 && header.contains("Intercepted layer 2") && header.contains("+ZFaceEntry layer 1"),
        "{header}{err}"
    );
}

#[test]
fn budgets_whose_names_lie_are_refused() {
    let scratch = Scratch::new();
    for name in
        ["3D_2_3_2_Intercepted.bin", "3D_2_3_3_Intercepted_+ZFaceEntry.bin", "3D_2_3_2_Inter_cepted_+ZFaceEntry.bin"]
    {
        let path = cells(&scratch, name);
        let (code, _, err) = run(&["inspect", path.to_str().unwrap()]);
        assert!(code != 0 && err.contains("has 192 bytes where") && err.contains("says its name"), "{name}: {err}");
    }
    for name in ["3D_99999_99999_99999_A.bin", "3D_1_1_18446744073709551615_A_B.bin"] {
        let (code, _, err) = run(&["inspect", cells(&scratch, name).to_str().unwrap()]);
        assert!(code != 0 && !err.contains("panicked"), "{name}: {err}");
    }
    // Under another name nobody knows what it is.
    let (code, _, err) = run(&[
        "convert",
        "--from",
        "dart-cells",
        cells(&scratch, "x.bin").to_str().unwrap(),
        &scratch.argument("y.npy"),
    ]);
    assert!(code != 0 && err.contains("does not say what is in it"), "{err}");
    // It is read only.
    let (code, _, err) =
        run(&["convert", cells(&scratch, CELLS).to_str().unwrap(), &scratch.argument("out.png"), "--to", "dart-cells"]);
    assert!(code != 0 && err.contains("read only"), "{err}");
}
