//! What a DART folder says otherwise than expected is read right, or told: nothing is replaced in silence.

use std::path::{Path, PathBuf};

use mmxrt::formats::dart::{self, TargetVersion, database};
use mmxrt::scene::{Material, Scene, Thermal};
use mmxrt::spectral::{Band, Column, Extend, SpectralLibrary, Spectrum, solar_e490};
use mmxrt::units::AU_M;

use crate::cli::run;
use crate::dart_sim::{Sim, told};
use crate::dart_write::{options, rich, tetrahedron};
use crate::scenes::edited;
use crate::scratch::Scratch;

fn grey(name: &str, reflectance: f64) -> Material {
    let reflectance = Spectrum::constant(reflectance);
    Material {
        name: name.into(),
        emissivity: reflectance.map(|r| 1.0 - r),
        reflectance,
        ..tetrahedron().body.materials[0].clone()
    }
}

/// One material, monochromatic bands, no heat.
fn plain(centres_um: &[f64], reflectance: f64) -> Scene {
    edited(&tetrahedron(), |scene| {
        scene.surface.materials = vec![grey("a", reflectance)];
        scene.surface.mesh.material.iter_mut().for_each(|m| m.0 = 0);
        scene.models.thermal = Thermal::Off;
        scene.sky.sun.irradiance_1au = solar_e490().clone();
        scene.exposure.bands = centres_um.iter().map(|&centre_um| Band::new(centre_um, None)).collect();
    })
}

fn table(name: &str, um: &[f64], rows: &[[f64; 3]]) -> SpectralLibrary {
    let names = ["reflectance", "direct_transmittance", "diffuse_transmittance"];
    let column =
        |(i, name): (usize, &&str)| Column { name: (*name).into(), values: rows.iter().map(|r| r[i]).collect() };
    SpectralLibrary {
        name: name.into(),
        comment: String::new(),
        wavelength_um: um.to_vec(),
        columns: names.iter().enumerate().map(column).collect(),
    }
}

fn put(sim: &Sim, tables: &[SpectralLibrary]) {
    database::create(&sim.folder.join("input/mmxrt_lambertian.db"), tables, true).unwrap();
}

#[test]
fn factors_by_band_multiply_what_is_held_beyond_a_table() {
    let sim = Sim::bare(&plain(&[1.0, 3.5], 0.3));
    let black = [[0.0; 3]; 2];
    put(&sim, &[table("mmxrt_a", &[0.4, 2.5], &[[0.3, 0.0, 0.0]; 2]), table("mmxrt_space", &[0.4, 5.0], &black)]);
    let factor = |f: f64| {
        format!(
            "<lambertianMultiplicativeFactorForLUT diffuseTransmittanceFactor=\"1\" directTransmittanceFactor=\"1\" \
             reflectanceFactor=\"{f}\" specularIntensityFactor=\"1\" useOpticalFactorMatrix=\"0\"/>"
        )
    };
    let factors = format!(
        "<lambertianNodeMultiplicativeFactorForLUT diffuseTransmittanceAcceleration=\"0\" diffuseTransmittanceFactor=\"1\" \
         directTransmittanceFactor=\"1\" reflectanceFactor=\"1\" specularIntensityFactor=\"1\" useSameFactorForAllBands=\"0\" \
         useSameOpticalFactorMatrixForAllBands=\"0\">{}{}</lambertianNodeMultiplicativeFactorForLUT></LambertianMulti>",
        factor(0.5),
        factor(0.4)
    );
    let path = sim.folder.join("input/coeff_diff.xml");
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replacen("useMultiplicativeFactorForLUT=\"0\"", "useMultiplicativeFactorForLUT=\"1\"", 1);
    std::fs::write(&path, text.replacen("</LambertianMulti>", &factors, 1)).unwrap();
    let (scene, report) = sim.read();
    let a = scene.body.materials.iter().find(|m| m.name == "a").unwrap();
    assert!((a.reflectance.at(1.0).unwrap() - 0.15).abs() < 1e-15);
    // 30 % is held from 2.5 um on, times 0.4.
    assert!((a.reflectance.at(3.5).unwrap() - 0.12).abs() < 1e-15, "{:?}", a.reflectance);
    assert!(told(&report, "known from 0.4 to 2.5 um"), "{report:#?}");
}

#[test]
fn irradiance_that_is_given_for_some_bands_stays() {
    let scene = plain(&[0.5, 1.0, 2.0], 0.3);
    let given = mmxrt::physics::sun::irradiance_at(solar_e490().at(1.0).unwrap(), scene.sky.sun.distance_m);
    // The first, the middle, the last, and two of them are not there.
    for missing in [&[0][..], &[1], &[2], &[0, 2]] {
        let sim = Sim::bare(&scene);
        for band in missing {
            let beginning = format!("<SpectralIrradianceValue bandNumber=\"{band}\"");
            sim.without("input/phase.xml", &beginning, "/>");
        }
        let (back, report) = sim.read();
        assert!(told(&report, "no irradiance of the bands"), "{report:#?}");
        let in_bands =
            |s: &Scene| dart::from_scene(s, &options(TargetVersion::V5_7_4)).unwrap().0.simulation.phase.irradiance;
        for (i, (is, was)) in in_bands(&back).iter().zip(in_bands(&scene)).enumerate() {
            // DART's bands are 0.001 um wide, over which sunlight varies a little.
            let (off, least) = (is.unwrap().0 / was.unwrap().0 - 1.0, if missing.contains(&i) { 3e-3 } else { 1e-9 });
            assert!(off.abs() < least, "{missing:?} {i}: {off}");
        }
        assert!(sim.check().1.contains("values of irradiance for 3 bands"));
    }
    // Twice the sunlight in one band, of which alone it is known: the Sun is nearer by the square root of 2.
    let sim = Sim::bare(&scene);
    sim.without("input/phase.xml", "<SpectralIrradianceValue bandNumber=\"0\"", "/>");
    sim.without("input/phase.xml", "<SpectralIrradianceValue bandNumber=\"2\"", "/>");
    sim.without("input/phase.xml", "<SpectralIrradianceValue bandNumber=\"1\"", "/>");
    let value = "</SpectralIrradiance>";
    let twice =
        format!("<SpectralIrradianceValue bandNumber=\"1\" irradiance=\"{}\" Skyl=\"0.0\"/>{value}", 2.0 * given);
    sim.edit("input/phase.xml", value, &twice);
    let (back, _) = sim.read();
    assert!((back.sky.sun.distance_m / (1.5 * AU_M / 2f64.sqrt()) - 1.0).abs() < 1e-3);
    // One more than there are bands is not taken for one of them.
    let sim = Sim::bare(&scene);
    let more = format!("<SpectralIrradianceValue bandNumber=\"3\" irradiance=\"9\" Skyl=\"0.0\"/>{value}");
    sim.edit("input/phase.xml", value, &more);
    let (back, report) = sim.read();
    assert!(
        told(&report, "an irradiance of band 3: there are 3 bands")
            && (back.sky.sun.distance_m / scene.sky.sun.distance_m - 1.0).abs() < 1e-3
    );
}

#[test]
fn mars_is_what_its_simulation_says() {
    // As it was written.
    let scene = rich();
    let sim = Sim::of(&scene);
    let (back, report) = sim.read();
    assert!(back.sky.mars == scene.sky.mars && !told(&report, "Mars"), "{report:#?}");
    assert!(!sim.check().1.contains("Mars"));
    // Without what says which Mars it was, its light is not read, and that is told.
    std::fs::remove_file(sim.folder.join("mmxrt.toml")).unwrap();
    let (back, report) = sim.read();
    assert!(
        back.sky.mars.is_none() && told(&report, "the simulation in mars/ and its light are not read"),
        "{report:#?}"
    );
    assert!(sim.check().1.contains("its light are not read"));
    // Other irradiances, another direction, a mesh, nothing at all: the edited file wins.
    let edits: [(&str, &dyn Fn(&Sim)); 4] = [
        ("irradiance", &|sim| _ = sim.edit("mars/input/phase.xml", "irradiance=\"0.", "irradiance=\"7.")),
        ("directions.xml Sun", &|sim| {
            sim.edit("mars/input/directions.xml", "sunViewingZenithAngle=\"2", "sunViewingZenithAngle=\"3");
        }),
        ("surface.obj is another file", &|sim| {
            let path = sim.folder.join("mars/input/obj/surface.obj");
            let text = std::fs::read_to_string(&path).unwrap();
            // The file has two names.
            std::fs::remove_file(&path).unwrap();
            std::fs::write(&path, format!("{text}# edited\n")).unwrap();
        }),
        ("is not there", &|sim| std::fs::remove_dir_all(sim.folder.join("mars")).unwrap()),
    ];
    for (what, edit) in edits {
        let sim = Sim::of(&scene);
        edit(&sim);
        let (back, report) = sim.read();
        assert!(
            back.sky.mars.is_none() && told(&report, what) && told(&report, "the scene has no Mars"),
            "{what}: {report:#?}"
        );
        let out = sim.check().1;
        assert!(out.contains(what) && out.contains("sim/mars"), "{what}: {out}");
        // Two folders that differ there differ.
        let same = Sim::of(&scene);
        let (code, out, _) = run(&["convert", "--diff", same.folder.to_str().unwrap(), sim.folder.to_str().unwrap()]);
        assert!(code == 1 && out.contains("mars"), "{what}: {out}");
    }
    // A mistake that is made there alone is found.
    let sim = Sim::of(&scene);
    sim.edit("mars/input/phase.xml", "meanLambda=\"1.0\"", "meanLambda=\"1000.0\"");
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("mars/input/phase.xml") && out.contains("a band at 1000 um"), "{out}");
}

#[test]
fn spectra_of_old_versions_are_texts() {
    let old = "*Name: a *\n*Number of Lambda pertinent values : * 2\n*Lambda_min - Lambda_max : * 0.4 3.0\n\
               *Lambda - Ro - Refraction index - T_Direct - T_Diffus*\n0.4\t30\t1.4\t0\t0\n3.0\t30\t1.4\t0\t0\n";
    let new = "wavelength;reflectance;direct_transmittance;diffuse_transmittance\n0.4;30;0;0\n3.0;30;0;0\n";
    for text in [old, new] {
        let sim = Sim::bare(&plain(&[1.0, 2.0], 0.3));
        sim.scratch.write("sim/input/2D_a.txt", text);
        for model in ["mmxrt_a", "mmxrt_space"] {
            let table = format!("ModelName=\"{model}\" databaseName=\"mmxrt_lambertian.db\" useSpecular=\"0\"");
            sim.edit("input/coeff_diff.xml", &table, "fileName=\"2D_a.txt\"");
        }
        sim.edit("input/coeff_diff.xml", "version=\"5.7.4\" build=\"v1083\"", "version=\"5.4.3\"");
        let (scene, report) = sim.read();
        let a = scene.body.materials.iter().find(|m| m.name == "a").unwrap();
        assert_eq!(a.reflectance.at(1.3), Some(0.3), "{report:#?}");
        let (_, out) = sim.check();
        assert!(!out.contains("NUL") && !out.contains("error: "), "{out}");
        // Bands beyond the text, fractions, and a text that is not there.
        sim.scratch.write("sim/input/2D_a.txt", text.replace("3.0", "1.5").replace("30", "0.3"));
        let out = sim.check().1;
        assert!(out.contains("bands 1 reach beyond it") && out.contains("fractions"), "{out}");
        std::fs::remove_file(sim.folder.join("input/2D_a.txt")).unwrap();
        let (scene, report) = sim.read();
        assert!(told(&report, "the text \"2D_a.txt\" of \"a\" is not there"), "{report:#?}");
        assert_eq!(scene.body.materials[0].reflectance.at(1.0), Some(0.1));
    }
}

#[test]
fn a_terrain_that_dart_makes_again_stops_nothing() {
    let scene = plain(&[1.0], 0.3);
    let made = |sim: &Sim, fresh: &str| {
        sim.edit(
            "input/maket.xml",
            "<Topography presenceOfTopography=\"0\"/>",
            "<Topography presenceOfTopography=\"1\"><TopographyProperties fileName=\"DEM.mp#\"/></Topography>",
        );
        let generator = format!(
            "<DEM_properties createTopography=\"{fresh}\"><DEMGenerator caseDEM=\"5\" outputFileName=\"DEM.mp#\"><DEM_5 \
             dataEncoding=\"0\" dataFormat=\"8\" fileName=\"dem.img\"/></DEMGenerator></DEM_properties>"
        );
        sim.edit("input/maket.xml", "<DEM_properties createTopography=\"0\"/>", &generator);
    };
    let header = "[Ilwis]\nType=BaseMap\n\n[BaseMap]\nCoordBounds=0 -2 2 0\nDomain=value.dom\nType=Map\n\n[Map]\nSize=2 2\nType=MapStore\n\n\
                  [MapStore]\nData=DEM.mp#\nType=Real\nStructure=Line\nStartOffset=0\nRowLength=2\n";
    let files: [&[(&str, &[u8])]; 4] = [
        &[],
        &[("DEM.mp#", &[0; 32])],
        &[("DEM.mp#", &[0; 32]), ("DEM.mpr", header.as_bytes())],
        &[("DEM.mp#", b"DRTDB and more"), ("DEM.mpr", header.as_bytes())],
    ];
    for files in files {
        let sim = Sim::bare(&scene);
        made(&sim, "1");
        for (name, bytes) in files {
            std::fs::write(sim.folder.join("input").join(name), bytes).unwrap();
        }
        let (back, report) = sim.read();
        assert!(told(&report, "DART makes it before it runs: the ground is a plane"), "{report:#?}");
        assert!(back.body.mesh.facets.len() >= 4);
        let (code, out) = sim.check();
        assert_eq!(code, 0, "{out}");
    }
    // One that is not made again is missed.
    let sim = Sim::bare(&scene);
    made(&sim, "0");
    let (simulation, _, _) = dart::read(&sim.folder, &dart::ReadOptions::default()).unwrap();
    assert!(simulation.maket.topography.is_some());
    let (back, report) = sim.read();
    assert!(told(&report, "the terrain \"DEM.mp#\" is not there: the ground is a plane at z = 0"), "{report:#?}");
    assert!(back.body.mesh.facets.len() >= 4);
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("the terrain `DEM.mp#` is not there"), "{out}");
}

#[test]
fn nanometres_are_found() {
    let sim = Sim::of(&plain(&[0.55], 0.3));
    sim.edit("input/phase.xml", "meanLambda=\"0.55\"", "meanLambda=\"550\"");
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("a band at 550 um") && out.contains("write 0.55"), "{out}");
    let to = sim.scratch.argument("out/scene.toml");
    let (code, _, err) = run(&["convert", sim.folder.to_str().unwrap(), &to]);
    assert!(code != 0 && err.contains("write 0.55"), "{err}");
    // In a table.
    let sim = Sim::bare(&plain(&[0.55], 0.3));
    put(&sim, &["mmxrt_a", "mmxrt_space"].map(|name| table(name, &[400.0, 2500.0], &[[0.3, 0.0, 0.0]; 2])));
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("runs from 400 to 2500 um") && out.contains("nanometres"), "{out}");
    assert!(told(&sim.read().1, "are these nanometres?"));
}

#[test]
fn a_sun_by_date_in_the_south_is_told() {
    let date = "<ExactDateHour year=\"2020\" month=\"1\" day=\"10\" hour=\"0\" minute=\"30\" second=\"0\" localTime=\"0\" \
                daylightSavingTime=\"0\" timezone=\"0\"/>";
    for (latitude, is_southern) in [("-43.0", true), ("43.0", false)] {
        let sim = Sim::bare(&plain(&[1.0], 0.3));
        sim.without("input/directions.xml", "<SunViewingAngles", "/>");
        sim.edit("input/directions.xml", "<HotSpotProperties", &format!("{date}<HotSpotProperties"));
        sim.edit("input/directions.xml", "exactDate=\"2\"", "exactDate=\"1\"");
        sim.without("input/maket.xml", "<LatLon", "/>");
        sim.edit(
            "input/maket.xml",
            "</Maket>",
            &format!("<LatLon latitude=\"{latitude}\" longitude=\"172.0\" altitude=\"0.0\"/></Maket>"),
        );
        let (_, report) = sim.read();
        assert_eq!(told(&report, "South of the equator"), is_southern, "{report:#?}");
        assert_eq!(sim.check().1.contains("south of the equator"), is_southern);
    }
}

#[test]
fn objects_beyond_the_scene_are_told() {
    let scene = plain(&[1.0], 0.3);
    let sim = Sim::bare(&scene);
    assert!(!told(&sim.read().1, "beyond the scene's edge") && !sim.check().1.contains("the scene:"));
    for (x, how) in [("10.5", "reaches beyond"), ("900.0", "lies outside")] {
        let sim = Sim::bare(&scene);
        let text = std::fs::read_to_string(sim.folder.join("input/object_3d.xml")).unwrap();
        let old = text.split("xpos=\"").nth(1).unwrap().split('"').next().unwrap();
        sim.edit("input/object_3d.xml", &format!("xpos=\"{old}\""), &format!("xpos=\"{x}\""));
        let (_, report) = sim.read();
        assert!(
            told(&report, "\"surface\" reaches beyond the scene's edge, where DART may leave it out"),
            "{report:#?}"
        );
        let out = sim.check().1;
        assert!(out.contains(how), "{how}: {out}");
    }
}

#[test]
fn a_check_of_tables_minds_energy_and_does_not_doubt_what_was_written() {
    // One percent, as the scene has it.
    let sim = Sim::of(&plain(&[1.0, 2.0], 0.01));
    let (code, out) = sim.check();
    assert!(code == 0 && !out.contains("fraction"), "{out}");
    // A third, divided by a hundred by somebody.
    let sim = Sim::of(&plain(&[1.0, 2.0], 0.3));
    let black = table("mmxrt_space", &[0.9, 2.1], &[[0.0; 3]; 2]);
    put(&sim, &[table("mmxrt_a", &[0.9, 2.1], &[[0.003, 0.0, 0.0]; 2]), black.clone()]);
    assert!(sim.check().1.contains("they look like fractions"));
    // More light than there is.
    for row in [[0.7, 0.0, 0.4], [0.7, 0.31, 0.0], [0.5, 0.3, 0.3]] {
        let sim = Sim::of(&plain(&[1.0, 2.0], 0.3));
        put(&sim, &[table("mmxrt_a", &[0.9, 2.1], &[[0.1, 0.0, 0.0], row]), black.clone()]);
        let (code, out) = sim.check();
        assert!(code == 1 && out.contains("reflects and lets through up to 1"), "{out}");
        let (code, out, _) =
            run(&["convert", "--check", sim.folder.join("input/mmxrt_lambertian.db").to_str().unwrap()]);
        assert!(code == 1 && out.contains("reflects and lets through up to 1"), "{out}");
    }
}

#[test]
fn a_check_sees_normals_that_are_turned() {
    let obj = |sim: &Sim, change: &dyn Fn(&str) -> String| {
        let path = sim.folder.join("input/obj/surface.obj");
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, change(&text)).unwrap();
    };
    let swapped = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        format!("f {} {} {}\n", words[1], words[3], words[2])
    };
    let all = |text: &str| -> String {
        text.lines().map(|l| if l.starts_with("f ") { swapped(l) } else { format!("{l}\n") }).collect()
    };
    let sim = Sim::of(&tetrahedron());
    assert!(!sim.check().1.contains("turned against"));
    obj(&sim, &all);
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("inside out"), "{out}");
    // A mirror turns facets over, and DART with it: what was right stays right, as `convert` has it.
    let sim = Sim::of(&tetrahedron());
    sim.edit("input/object_3d.xml", "xscale=\"1.0\"", "xscale=\"-1.0\"");
    let (code, out) = sim.check();
    assert!(code == 0 && !out.contains("inside out"), "{out}");
    obj(&sim, &all);
    assert!(sim.check().1.contains("inside out"));
    // One facet alone: its three edges.
    let sim = Sim::of(&tetrahedron());
    obj(&sim, &|text| {
        let line = text.lines().find(|line| line.starts_with("f ")).unwrap();
        text.replacen(&format!("{line}\n"), &swapped(line), 1)
    });
    let out = sim.check().1;
    assert!(out.contains("turned against those beside them, along 3 of 6 edges"), "{out}");
}

#[test]
fn two_faces_need_properties_of_the_back() {
    let sim = Sim::of(&tetrahedron());
    sim.edit(
        "input/object_3d.xml",
        "<GroupOpticalProperties sameOPGroup=\"1\" doubleFace=\"0\"",
        "<GroupOpticalProperties sameOPGroup=\"1\" doubleFace=\"1\"",
    );
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("has two faces (`doubleFace`), but no properties of the back"), "{out}");
}

#[test]
fn minus_one_in_an_image_of_dart_is_no_data() {
    let scratch = Scratch::new();
    let map = |name: &str, values: &[f64]| {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        scratch.write(&format!("{name}.mp#"), bytes);
        let header = format!(
            "[Ilwis]\nType=BaseMap\n\n[BaseMap]\nCoordBounds=0 -{0} 1 0\nDomain=value.dom\nType=Map\n\n[Map]\nSize=1 {0}\nType=MapStore\n\n\
             [MapStore]\nData={name}.mp#\nType=Real\nStructure=Line\nStartOffset=0\nRowLength={0}\n",
            values.len()
        );
        scratch.write(&format!("{name}.mpr"), header);
        scratch.argument(&format!("{name}.mpr"))
    };
    let image = map("ima01_VZ=000_0_VA=000_0", &[-1.0, 0.25, 0.75, -1.0, f64::NAN]);
    let (code, out, _) = run(&["inspect", &image]);
    assert!(
        code == 0 && out.contains("no_data 3") && out.contains("mean 0.5") && out.contains("no_data_value: -1"),
        "{out}"
    );
    let (code, _, err) = run(&["convert", &image, &scratch.argument("x.img")]);
    assert_eq!(code, 0, "{err}");
    assert!(std::fs::read_to_string(scratch.join("x.hdr")).unwrap().contains("data ignore value = nan"));
    let numbers = std::fs::read(scratch.join("x.img")).unwrap();
    let numbers: Vec<f64> = numbers.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    assert!(numbers[0].is_nan() && numbers[1] == 0.25 && numbers[3].is_nan(), "{numbers:?}");
    // As DART writes it, it is written again.
    run(&["convert", &image, &scratch.argument("y.mpr")]);
    let again = std::fs::read(scratch.join("y.mp#")).unwrap();
    assert_eq!(again[..8], (-1.0_f64).to_le_bytes());
    // Where something is less, -1 is a value; so it is in a terrain.
    for (name, values) in [("ima02_VZ=000_0_VA=000_0", [-2.0, -1.0]), ("DEM", [-1.0, 3.0])] {
        let (_, out, _) = run(&["inspect", &map(name, &values)]);
        assert!(out.contains("no_data 0"), "{out}");
    }
}

#[test]
fn names_of_any_length_and_versions_in_names_of_folders() {
    let mut scene = plain(&[1.0, 2.0], 0.3).into_parts();
    let long = "ä".repeat(400);
    let spectrum = Spectrum::new(vec![0.5, 3.0], vec![0.1, 0.3], Extend::Error).unwrap();
    for (i, end) in ["one", "two"].iter().enumerate() {
        let name = format!("{long}{end}");
        let mut material = Material { reflectance: spectrum.clone(), name, ..scene.surface.materials[0].clone() };
        material.emissivity = spectrum.map(|r| 1.0 - r);
        material.mixture = vec![(i, 1.0)];
        if i == 0 { scene.surface.materials = vec![material] } else { scene.surface.materials.push(material) }
    }
    scene.surface.mesh.material[0].0 = 1;
    let scene = scene.check().unwrap();
    let sim = Sim::of(&scene);
    let from = sim.folder.to_str().unwrap();
    let (code, _, err) = run(&["convert", from, &sim.scratch.argument("out/scene.toml")]);
    assert_eq!(code, 0, "{err}");
    let back =
        mmxrt::formats::scene_toml::read(&sim.scratch.join("out/scene.toml"), &mmxrt::progress::unwatched).unwrap();
    assert_eq!(back.scene.body.materials.iter().map(|m| m.reflectance.at(3.0)).collect::<Vec<_>>(), [Some(0.3); 2]);
    for name in ["sim_5.7.4", "run.v2", "site.5.11.0-b"] {
        let (code, _, err) = run(&["convert", &sim.scratch.argument("out/scene.toml"), &sim.scratch.argument(name)]);
        assert_eq!(code, 0, "{name}: {err}");
        assert!(sim.scratch.join(name).join("input/maket.xml").is_file());
        let to = format!("scene_of_{name}");
        let (code, _, err) =
            run(&["convert", &sim.scratch.argument(name), &sim.scratch.argument(&to), "--to", "scene"]);
        assert_eq!(code, 0, "{to}: {err}");
        assert!(sim.scratch.join(&to).join("scene.toml").is_file());
    }
    let (code, _, err) = run(&["convert", from, &sim.scratch.argument("x.unknown")]);
    assert!(code != 0 && err.contains("no format's names end like this"), "{err}");
}

#[test]
fn what_is_not_read_of_two_simulations_is_compared_too() {
    let scene = plain(&[1.0], 0.3);
    let (a, b) = (Sim::of(&scene), Sim::of(&scene));
    let diff = |a: &Path, b: &Path| run(&["convert", "--diff", a.to_str().unwrap(), b.to_str().unwrap()]);
    assert_eq!(diff(&a.folder, &b.folder).0, 0);
    for (file, from, to, told) in [
        ("phase.xml", "TOAtoBOA=\"0\"", "TOAtoBOA=\"1\"", "the atmosphere"),
        ("atmosphere.xml", "co2MixRate=\"365.0\"", "co2MixRate=\"400.0\"", "@co2MixRate: 365.0 | 400.0"),
        ("directions.xml", "numberOfPropagationDirections=\"100\"", "numberOfPropagationDirections=\"50\"", "100 | 50"),
        ("coeff_diff.xml", "useSpecular=\"0\"", "useSpecular=\"1\"", "specular reflection"),
    ] {
        let c = Sim::of(&scene);
        c.edit(&format!("input/{file}"), from, to);
        let (code, out, _) = diff(&a.folder, &c.folder);
        assert!(code == 1 && out.contains(told), "{told}: {out}");
    }
    // Written otherwise, it is the same.
    b.edit("input/atmosphere.xml", "co2MixRate=\"365.0\"", "co2MixRate=\"3.65E2\"");
    let (code, out, _) = diff(&a.folder, &b.folder);
    assert_eq!(code, 0, "{out}");
    // What DART has no place for.
    b.edit("mmxrt.toml", "name = \"seeker\"", "name = \"other\"");
    let (code, out, _) = diff(&a.folder, &b.folder);
    assert!(code == 1 && out.contains("sensor.name: \"seeker\", \"other\""), "{out}");
}

/// Of each attribute in a folder's inputs the file, the element's name and its own, and another value.
fn edits(folder: &Path) -> Vec<(PathBuf, String, String)> {
    let mut edits = Vec::new();
    let mut files: Vec<PathBuf> = folder
        .join("input")
        .read_dir()
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "xml"))
        .collect();
    files.sort();
    for file in files {
        let mut root = mmxrt::formats::xml::read(&file).unwrap().0;
        let mut count = 0;
        walk(&mut root.children[0], &mut |_| count += 1);
        for nth in 0..count {
            let (mut i, mut what) = (0, String::new());
            let mut edited = root.clone();
            walk(&mut edited.children[0], &mut |(name, attribute)| {
                if i == nth {
                    what = format!("{name}/@{}", attribute.name);
                    attribute.value = match attribute.value.trim().parse::<f64>() {
                        Ok(0.0) => "1".into(),
                        Ok(1.0) => "0".into(),
                        Ok(number) => (number + 1.0).to_string(),
                        Err(_) => format!("{}x", attribute.value),
                    };
                }
                i += 1;
            });
            edits.push((file.clone(), what, edited.write()));
        }
    }
    edits
}

fn walk(
    element: &mut mmxrt::formats::xml::Element,
    each: &mut impl FnMut((&str, &mut mmxrt::formats::xml::Attribute)),
) {
    let name = element.name.clone();
    element.attributes.iter_mut().for_each(|attribute| each((&name, attribute)));
    element.children.iter_mut().for_each(|child| walk(child, each));
}

#[test]
fn no_edit_of_an_input_is_called_the_same_in_meaning() {
    // Every kind of material is on a facet.
    let materials = [3, 5, 6, 1].map(mmxrt::geometry::MaterialId);
    let scene = edited(&rich(), |scene| scene.surface.mesh.material = materials.to_vec());
    let (sim, other) = (Sim::of(&scene), Sim::of(&scene));
    let options = dart::ReadOptions::default();
    assert_eq!(dart::differences(&sim.folder, &other.folder, &options).unwrap(), [""; 0]);
    let same = [
        // Names and colours.
        "ident",
        "idTemperature",
        "name",
        "num",
        "objectColor",
        "isDisplayed",
        "typeColor",
        "indexOT",
        "identOType",
        "sameOTObject",
        "sameOTGroup",
        // All bands have the same.
        "commonIrradianceCheckBox",
        "commonSkylCheckBox",
    ];
    // An attribute counts where something links to its element.
    let (mut told, mut silent) = (std::collections::BTreeSet::new(), std::collections::BTreeSet::new());
    for (file, what, text) in edits(&other.folder) {
        let before = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text).unwrap();
        match dart::differences(&sim.folder, &other.folder, &options) {
            Ok(lines) if lines.is_empty() => silent.insert(what),
            // Refused is told.
            _ => told.insert(what),
        };
        std::fs::write(&file, before).unwrap();
    }
    silent.retain(|what| !told.contains(what) && !same.iter().any(|name| what.ends_with(&format!("/@{name}"))));
    assert!(silent.is_empty(), "{silent:?}");
    assert!(told.len() > 200, "{}", told.len());
}

#[test]
fn what_is_not_read_of_a_camera_or_a_temperature_is_compared_as_it_is_written() {
    let sim = Sim::of(&rich());
    let other = Sim::of(&rich());
    let pushbroom = |height: f64| {
        format!(
            "<Pushbroom ifImportAsc=\"0\"><PushbroomSensor pitchLookAngle=\"10.0\" platformAzimuth=\"0.0\"/>\
             <SensorCentralPosition sensorPosX=\"1\" sensorPosY=\"1\" sensorPosZ=\"{height}\"/></Pushbroom></SensorImageSimulation>"
        )
    };
    for (sim, height) in [(&sim, 500.0), (&other, 900.0)] {
        sim.edit("input/phase.xml", "</SensorImageSimulation>", &pushbroom(height));
    }
    let lines = dart::differences(&sim.folder, &other.folder, &dart::ReadOptions::default()).unwrap();
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].contains("sensorPosZ: 500 | 900 (not read here)"), "{lines:?}");
}
