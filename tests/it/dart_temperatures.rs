//! Temperatures to DART and from there: those that are held, by materials and by cells, and those that are not.

use mmxrt::formats::dart::{self, ReadOptions, SceneOptions};
use mmxrt::geometry::MaterialId;
use mmxrt::progress::unwatched;
use mmxrt::report::Fate;
use mmxrt::scene::{Scene, Thermal};
use mmxrt::spectral::{Band, Light, Spectrum};

use crate::cli::run;
use crate::dart_sim::{Sim, told};
use crate::dart_write::{read, tetrahedron};
use crate::scenes::{edited, lambert};
use crate::shapes::direction;

/// A tetrahedron of two materials, in light and in heat; its base is of the second.
fn warm() -> Scene {
    edited(&tetrahedron(), |scene| {
        scene.surface.materials = [("rock", 0.2), ("heater", 0.1)]
            .iter()
            .enumerate()
            .map(|(i, (name, r))| lambert(i, name, Spectrum::constant(*r)))
            .collect();
        scene.surface.mesh.material = [0, 0, 0, 1].map(MaterialId).to_vec();
        scene.models.thermal = Thermal::Equilibrium;
        scene.exposure.bands = vec![Band { light: Light::Heat, ..Band::new(10.0, Some(0.5)) }];
    })
}

fn with_held(scene: &Scene, held_k: f64) -> Scene {
    edited(scene, |scene| scene.surface.materials[1].temperature_k = Some(held_k))
}

/// Temperatures of materials that facets have.
fn held_k(scene: &Scene) -> Vec<Option<f64>> {
    let body = &scene.body;
    body.mesh.material.iter().map(|m| body.materials[usize::from(m.0)].temperature_k).collect()
}

#[test]
fn what_is_held_is_isothermal_in_dart_and_comes_back() {
    let scene = with_held(&warm(), 287.25);
    let sim = Sim::of(&scene);
    let text = std::fs::read_to_string(sim.folder.join("input/coeff_diff.xml")).unwrap();
    assert!(text.contains("idTemperature=\"T_heater\" meanT=\"287.25\" deltaT=\"0.0\""), "{text}");
    let (back, report) = sim.read();
    assert_eq!((back.models, &back.body.materials), (scene.models, &scene.body.materials));
    assert!(!told(&report, "temperatures are spread"), "{report:#?}");
    // Somebody else's, of which the file alone tells it: in facets' order the base is the last.
    let (back, report) = Sim::bare(&scene).read();
    assert_eq!(held_k(&back), [None, None, None, Some(287.25)]);
    assert!(back.models.thermal == Thermal::Equilibrium && told(&report, "temperatures are spread"), "{report:#?}");
    // With all of them held nothing is spread.
    let all = edited(&scene, |scene| scene.surface.materials[0].temperature_k = Some(150.0));
    let (back, report) = Sim::bare(&all).read();
    assert_eq!(held_k(&back), [Some(150.0), Some(150.0), Some(150.0), Some(287.25)]);
    assert!(!told(&report, "temperatures are spread"), "{report:#?}");
    // An edited temperature wins over what was written beside it.
    let sim = Sim::of(&scene);
    sim.edit("input/coeff_diff.xml", "meanT=\"287.25\"", "meanT=\"300.5\"");
    assert_eq!(held_k(&sim.read().0)[3], Some(300.5));
    sim.edit("input/coeff_diff.xml", "meanT=\"300.5\" deltaT=\"0.0\"", "meanT=\"300.5\" deltaT=\"10.0\"");
    let (back, report) = sim.read();
    assert!(held_k(&back)[3].is_none() && told(&report, "temperatures are spread"), "{report:#?}");
    // As scenes and as simulations these are another.
    let (a, b) = (Sim::of(&scene), Sim::of(&with_held(&scene, 288.0)));
    let (code, out, _) = run(&["convert", "--diff", a.folder.to_str().unwrap(), b.folder.to_str().unwrap()]);
    assert!(code == 1 && out.contains("temperature, mean and range, K: [287.25, 0.0] | [288.0, 0.0]"), "{out}");
    assert!(out.contains("temperature_k: 287.25, 288"), "{out}");
}

#[test]
fn what_has_no_range_for_want_of_sunlight_is_not_held() {
    // The Sun below the horizon, or no heat in the scene's models: without a word of it in the scene nothing is held.
    let night = edited(&warm(), |scene| scene.sky.sun.direction = direction([0.0, -1.0, 0.2]));
    let off = edited(&warm(), |scene| scene.models.thermal = Thermal::Off);
    for scene in [night, off] {
        let (back, _) = Sim::of(&scene).read();
        assert_eq!((held_k(&back), back.models), (vec![None; 4], scene.models));
    }
    // In sunlight alone temperatures of DART's files are of no account, but those of a scene written here stay.
    let lit = edited(&with_held(&warm(), 300.0), |scene| {
        scene.exposure.bands = vec![Band { light: Light::Sunlight, ..Band::new(1.0, Some(0.1)) }]
    });
    assert_eq!(held_k(&Sim::of(&lit).read().0)[3], Some(300.0));
    assert_eq!(held_k(&Sim::bare(&lit).read().0), [None; 4]);
}

#[test]
fn one_property_at_two_temperatures_is_two_materials() {
    // Both groups are of the first optical property, and keep their own temperatures.
    let sim =
        Sim::bare(&edited(&with_held(&warm(), 250.0), |scene| scene.surface.materials[0].temperature_k = Some(200.0)));
    sim.edit("input/object_3d.xml", "indexFctPhase=\"1\" ident=\"heater\"", "indexFctPhase=\"0\" ident=\"rock\"");
    let (back, _) = sim.read();
    assert_eq!(held_k(&back), [Some(200.0), Some(200.0), Some(200.0), Some(250.0)]);
    let names: Vec<&str> = back.body.materials.iter().map(|m| m.name.as_str()).collect();
    assert!(names.contains(&"rock") && names.contains(&"rock at 250 K"), "{names:?}");
    for material in back.body.materials.iter().filter(|m| m.name.starts_with("rock")) {
        assert_eq!(material.reflectance.at(10.0), Some(0.2));
    }
}

#[test]
fn a_link_to_no_temperature_is_refused_where_heat_counts() {
    let wrong =
        ("indexTemperature=\"1\" idTemperature=\"T_heater\"", "indexTemperature=\"9\" idTemperature=\"T_heater\"");
    let sim = Sim::bare(&with_held(&warm(), 250.0));
    sim.edit("input/object_3d.xml", wrong.0, wrong.1);
    let error = sim.error();
    assert!(error.contains("object_3d.xml:") && error.contains("temperature 9"), "{error}");
    let lit = edited(&warm(), |scene| {
        scene.exposure.bands = vec![Band { light: Light::Sunlight, ..Band::new(1.0, Some(0.1)) }]
    });
    let sim = Sim::bare(&lit);
    sim.edit("input/object_3d.xml", wrong.0, wrong.1);
    assert_eq!(held_k(&sim.read().0), [None; 4]);
    assert!(sim.check().1.contains("temperature 9"));
}

/// 2 x 2 x 2 cells of 1 x 1 x 2 m, and a small triangle that faces up in each, the lowest at the bottom.
fn of_cells(temperatures: &str) -> Sim {
    let one = edited(&warm(), |scene| {
        scene.surface.mesh.material.fill(MaterialId(0));
        scene.surface.materials.truncate(1);
    });
    let sim = Sim::bare(&one);
    let maket = sim.folder.join("input/maket.xml");
    let text = std::fs::read_to_string(&maket).unwrap();
    let start = text.find("<CellDimensions").unwrap();
    let end = text.find("</Scene>").unwrap();
    let scene = "<CellDimensions x=\"1\" z=\"2\"/><SceneDimensions x=\"2\" y=\"2\"/>";
    std::fs::write(&maket, format!("{}{scene}{}", &text[..start], &text[end..])).unwrap();
    let objects = sim.folder.join("input/object_3d.xml");
    let text = std::fs::read_to_string(&objects).unwrap();
    let start = text.find("<PositionProperties").unwrap();
    let end = start + text[start..].find("/>").unwrap() + 2;
    let place = "<PositionProperties xpos=\"0\" ypos=\"0\" zpos=\"0\"/>";
    std::fs::write(&objects, format!("{}{place}{}", &text[..start], &text[end..])).unwrap();
    let (mut obj, mut facets) = (String::new(), String::new());
    let mut n = 0;
    for k in 0..2 {
        for i in 0..2 {
            for j in 0..2 {
                let z = 2.25 * f64::from(k);
                for (x, y) in [(0.2, 0.2), (0.8, 0.2), (0.2, 0.8)] {
                    obj += &format!("v {} {z} {}\n", f64::from(j) + y, f64::from(i) + x);
                }
                facets += &format!("f {} {} {}\n", n + 1, n + 2, n + 3);
                n += 3;
            }
        }
    }
    std::fs::write(sim.folder.join("input/obj/surface.obj"), obj + &facets).unwrap();
    sim.edit(
        "input/phase.xml",
        "<SpectralDomainTir temperatureMode=\"0\">",
        "<SpectralDomainTir temperatureMode=\"1\"><TemperatureFile temperatureFileName=\"temperatures.txt\"/>",
    );
    // The ground keeps its 0 K, and so stands for the sky.
    sim.edit(
        "input/coeff_diff.xml",
        "idTemperature=\"T_space\" meanT=\"0.0\" deltaT=\"0.0\" useOpticalFactorMatrix=\"0\" override3DMatrix=\"0\"",
        "idTemperature=\"T_space\" meanT=\"0.0\" deltaT=\"0.0\" useOpticalFactorMatrix=\"0\" override3DMatrix=\"1\"",
    );
    std::fs::write(sim.folder.join("input/temperatures.txt"), temperatures).unwrap();
    sim
}

/// 100 + 100 (layer from below) + 10 x + y.
const CELLS: &str = "100 101\n110 111\n\n200.000\t201.000\r\n210.000 211.000";

#[test]
fn facets_have_the_temperatures_of_their_cells() {
    let sim = of_cells(CELLS);
    let (scene, report) = sim.read();
    let expected = [100.0, 101.0, 110.0, 111.0, 200.0, 201.0, 210.0, 211.0].map(Some);
    assert_eq!(held_k(&scene), expected);
    assert!(
        told(&report, "temperatures of 2 x 2 x 2 cells")
            && told(&report, "0 facets are larger than a cell, 0 lie above"),
        "{report:#?}"
    );
    assert!(!told(&report, "temperatures are spread"), "{report:#?}");
    assert_eq!(sim.check().0, 0, "{}", sim.check().1);
    // Written as a scene, and read.
    let to = sim.folder.join("../scene/scene.toml");
    let (code, _, err) = run(&["convert", sim.folder.to_str().unwrap(), to.to_str().unwrap()]);
    assert_eq!(code, 0, "{err}");
    let back = mmxrt::formats::scene_toml::read(&to, &unwatched).unwrap().scene;
    assert_eq!(held_k(&back), expected);
    // Which share their table, if they need one.
    let names = to.parent().unwrap().read_dir().unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    assert!(names.filter(|name| name.contains("reflectance")).count() <= 1);
    // Cells of one temperature share a material; the one that is not in use any more stays.
    let (scene, _) = of_cells("5 5 5 5 5 5 5 6").read();
    assert_eq!(scene.body.materials.len(), 3);
    // One layer: what stands above it has the nearest cell's.
    let (scene, report) = of_cells("1 2 3 4").read();
    assert_eq!(held_k(&scene), [1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0].map(Some));
    assert!(told(&report, "4 lie above all of them"), "{report:#?}");
    // Layers begin at the ground plane, though it stands for the sky: what begins 1.9 m above it ends 0.15 m above the second layer.
    let sim = of_cells(CELLS);
    sim.edit("input/object_3d.xml", "zpos=\"0\"", "zpos=\"1.9\"");
    let (scene, report) = sim.read();
    assert_eq!(held_k(&scene), expected);
    assert!(told(&report, "4 lie above all of them"), "{report:#?}");
    // A function that overrides them, and a scene without heat, do not ask.
    let sim = of_cells("what");
    sim.edit("input/coeff_diff.xml", "override3DMatrix=\"0\"", "override3DMatrix=\"1\"");
    assert_eq!(held_k(&sim.read().0), [None; 8]);
    let sim = of_cells("what");
    sim.edit("input/phase.xml", "spectralDartMode=\"2\"", "spectralDartMode=\"0\"");
    assert_eq!(held_k(&sim.read().0), [None; 8]);
}

#[test]
fn the_ground_has_the_temperatures_of_cells_too() {
    let sim = of_cells(CELLS);
    sim.edit("input/coeff_diff.xml", "override3DMatrix=\"1\"", "override3DMatrix=\"0\"");
    let (scene, _) = sim.read();
    let body = &scene.body;
    assert_eq!(body.mesh.facets.len(), 8 + 8);
    for f in 8..16 {
        // East, north, up from the middle of the scene's ground; x is South.
        let centre_m = body.mesh.facet(f).centroid_m();
        let (i, j) = (f64::from(centre_m.y < 0.0), f64::from(centre_m.x > 0.0));
        assert_eq!(held_k(&scene)[f], Some(100.0 + 10.0 * i + j), "{centre_m}");
    }
}

#[test]
fn temperatures_that_are_none_are_refused_at_their_place() {
    let cases = [
        ("", "holds 0 temperatures: of a scene of 2 x 2 cells each layer has 4"),
        ("1 2 3", "holds 3 temperatures"),
        ("1 2 3 4 5", "holds 5 temperatures"),
        ("1 2\n3 0", "temperatures.txt:2:1: `0`: temperatures are numbers above 0"),
        ("1 -2 3 4", "temperatures.txt:1:1: `-2`"),
        ("1 nan 3 4", "`nan`"),
        ("1 inf 3 4", "`inf`"),
        ("1 2 3 4,5", "`4,5`"),
        ("1 2 3 x4444444444444444444444444444", "`x4444444444444444444`"),
    ];
    for (text, message) in cases {
        let sim = of_cells(text);
        let error = sim.error();
        assert!(error.contains(message) && error.contains("temperatures.txt"), "{text}: {error}");
        let (code, out) = sim.check();
        assert!(code == 1 && out.contains(message), "{text}: {out}");
    }
    // All at once.
    let error = of_cells("a b\nc d\n").error();
    assert!(["`a`", "`b`", "`c`", "`d`"].iter().all(|word| error.contains(word)), "{error}");
    // More temperatures than there may be materials.
    let sim = of_cells(CELLS);
    let text: String = (0..40_000).map(|i| format!("{} ", 200.0 + 0.01 * f64::from(i))).collect();
    std::fs::write(sim.folder.join("input/temperatures.txt"), text).unwrap();
    // Cells of a centimetre along x and y, of which facets of a grid see all.
    let mut obj = String::new();
    for i in 0..200 {
        for j in 0..200 {
            let (x, y) = (0.01 * f64::from(i), 0.01 * f64::from(j));
            obj += &format!("v {} 0 {}\nv {} 0 {}\nv {} 0 {}\nf -3 -2 -1\n", y, x, y, x + 0.009, y + 0.009, x);
        }
    }
    std::fs::write(sim.folder.join("input/obj/surface.obj"), obj).unwrap();
    sim.edit("input/maket.xml", "<CellDimensions x=\"1\" z=\"2\"/>", "<CellDimensions x=\"0.01\" z=\"2\"/>");
    let error = sim.error();
    assert!(error.contains("more than 1024 materials") && error.contains("round them"), "{error}");
}

#[test]
fn other_ways_to_temperatures_are_told_in_a_line() {
    let missing = of_cells(CELLS);
    std::fs::remove_file(missing.folder.join("input/temperatures.txt")).unwrap();
    let (scene, report) = missing.read();
    assert!(held_k(&scene) == [None; 8] && told(&report, "which is not in the input folder"), "{report:#?}");
    let (code, out) = missing.check();
    assert!(code == 1 && out.contains("`temperatures.txt` is not in the input folder"), "{out}");
    for (mode, message) in
        [("2", "layers from a file (`temperatureMode` 2)"), ("3", "its atmosphere (`temperatureMode` 3)")]
    {
        let sim = of_cells(CELLS);
        sim.edit("input/phase.xml", "temperatureMode=\"1\"", &format!("temperatureMode=\"{mode}\""));
        let (scene, report) = sim.read();
        let lines: Vec<_> = report.notes.iter().filter(|note| note.message.contains(message)).collect();
        assert!(lines.len() == 1 && lines[0].fate == Fate::Dropped && held_k(&scene) == [None; 8], "{report:#?}");
    }
    let sim = of_cells(CELLS);
    sim.edit("input/phase.xml", "temperatureMode=\"1\"", "temperatureMode=\"4\"");
    assert!(sim.error().contains("`temperatureMode` is 4: known are 0 to 3"));
    // Copies of the scene have its temperatures; on a slope it is not known which.
    let sim = of_cells(CELLS);
    sim.edit("input/maket.xml", "exactlyPeriodicScene=\"0\"", "exactlyPeriodicScene=\"1\"");
    let repeated = SceneOptions { repeat: 1, ..SceneOptions::default() };
    let (scene, _) = read(&sim.folder, &repeated);
    let once = [100.0, 101.0, 110.0, 111.0, 200.0, 201.0, 210.0, 211.0].map(Some);
    assert_eq!(held_k(&scene), once.repeat(9));
    sim.edit("input/maket.xml", "exactlyPeriodicScene=\"1\"", "exactlyPeriodicScene=\"2\"");
    let options = ReadOptions::default();
    let (simulation, ..) = dart::read(&sim.folder, &options).unwrap();
    let error =
        dart::to_scene(&simulation, &options.folder(&sim.folder), &repeated, &unwatched).unwrap_err().to_string();
    assert!(error.contains("on a slope that goes on"), "{error}");
    // Cells that differ are a difference.
    let (a, b) = (of_cells(CELLS), of_cells(&CELLS.replace("211", "212")));
    let (code, out, _) = run(&["convert", "--diff", a.folder.to_str().unwrap(), b.folder.to_str().unwrap()]);
    assert!(code == 1 && out.contains("1 temperatures, the first, K: 211 | 212"), "{out}");
}
