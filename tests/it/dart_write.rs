//! A scene as a DART simulation, and back.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use glam::{DMat3, DVec3};

use mmxrt::Error;
use mmxrt::formats::dart::{self, SceneOptions, SimulationOptions, TargetVersion};
use mmxrt::formats::{scene_toml, xml};
use mmxrt::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose};
use mmxrt::progress::unwatched;
use mmxrt::report::{Fate, Report};
use mmxrt::scene::{Globe, Hapke, Material, Photometry, Readout, Rpv, Scene, Thermal, Timing};
use mmxrt::spectral::{Band, Extend, Light, Spectrum};
use mmxrt::units::AU_M;

use crate::scenes::{self, edited, lambert};
use crate::scratch::Scratch;
use crate::shapes::{direction, mesh, nadir, plane, sun};

/// On the equator at longitude 90 deg: up is +y of the body, East -x, North +z, so South -z.
///
/// A tetrahedron: A 20 m South and 10 m East, B 20 m North and 10 m East, C 30 m West, D 15 m up. The Sun 3 parts South, 4 West
/// and 5 up. The camera 100 m East and 100 m up, looking at the origin: its right is North.
pub(crate) fn tetrahedron() -> Scene {
    let slant = 0.5f64.sqrt();
    let mesh = Mesh {
        material: (0..4).map(MaterialId).collect(),
        ..mesh(
            &[[-10.0, 0.0, -20.0], [-10.0, 0.0, 20.0], [30.0, 0.0, 0.0], [0.0, 15.0, 0.0]],
            &[[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]],
        )
    };
    let axes = [DVec3::Z, DVec3::new(-slant, -slant, 0.0), DVec3::new(slant, -slant, 0.0)];
    let pose =
        Pose { rotation: DMat3::from_cols(axes[0], axes[1], axes[2]), translation_m: DVec3::new(-100.0, 100.0, 0.0) };
    let camera = FrameCamera::centred(pose, 300, 200, 0.002);
    let mut parts = scenes::parts(mesh, camera, direction([4.0, 5.0, -3.0]));
    parts.surface.origin_m = DVec3::new(0.0, 11_000.0, 0.0);
    parts.surface.materials = [("east", 0.1), ("north west", 0.2), ("south west", 0.3), ("base", 0.4)]
        .iter()
        .enumerate()
        .map(|(i, (name, reflectance))| lambert(i, name, Spectrum::constant(*reflectance)))
        .collect();
    parts.exposure.instrument = "seeker".into();
    parts.exposure.bands = vec![Band::new(1.0, Some(0.02)), Band::new(2.0, None)];
    parts.check().unwrap()
}

/// The same with all that DART has no place for.
pub(crate) fn rich() -> Scene {
    let mut scene = tetrahedron().into_parts();
    let spectrum = |values: &[f64]| Spectrum::new(vec![0.5, 1.1, 2.5], values.to_vec(), Extend::Error).unwrap();
    scene.surface.materials = vec![
        lambert(0, "Grey & <dark>", spectrum(&[0.05, 0.0612345678901, 0.07])),
        lambert(1, "grey", spectrum(&[0.1, 1.0 / 3.0, 0.2])),
        Material { emissivity: Spectrum::constant(0.9), ..lambert(2, "select", Spectrum::constant(0.123)) },
        Material { mixture: vec![(0, 0.25), (1, 0.75)], ..lambert(3, "mixed", spectrum(&[0.0, 0.0, 0.0])) },
        lambert(4, "unused", spectrum(&[0.7, 0.8, 0.9])),
        Material {
            photometry: Photometry::Hapke(Box::new(Hapke::from(
                [0.3, 0.4, 0.2, 0.1, 0.0, 1.0, 0.05].map(|v| spectrum(&[v, 0.9 * v, 1.1 * v])),
            ))),
            ..lambert(5, "hapke", spectrum(&[0.05, 0.06, 0.07]))
        },
        Material {
            photometry: Photometry::Rpv(Box::new(Rpv::from([0.05, 0.8, -0.1, 0.05].map(Spectrum::constant)))),
            ..lambert(6, "rpv", Spectrum::constant(0.05))
        },
    ];
    // Two faces of two facets each.
    scene.surface.mesh.face_of_facet = vec![0, 0, 1, 1];
    scene.surface.mesh.material = [3, 1, 3, 2].map(MaterialId).to_vec();
    scene.sky.mars =
        Some(Globe { reflectance: spectrum(&[0.2, 0.25, 0.31]), ..scenes::mars(DVec3::new(3e6, 8e6, 1e6)) });
    scene.models.thermal = Thermal::Equilibrium;
    scene.exposure.camera.world_from_sensor.rotation *= DMat3::from_rotation_z(0.3);
    scene.exposure.bands.push(Band::new(2.2, Some(0.05)));
    scene.check().unwrap()
}

pub(crate) fn options(target: TargetVersion) -> SimulationOptions {
    SimulationOptions { target, cell_m: Some(2.0), ..SimulationOptions::default() }
}

/// Writes a scene's simulation below a folder.
pub(crate) fn written(scene: &Scene, options: &SimulationOptions, folder: &Path) -> Report {
    let (package, report) = dart::from_scene(scene, options).unwrap();
    dart::write(&package, folder, false, &unwatched).unwrap();
    report
}

pub(crate) fn read(folder: &Path, options: &SceneOptions) -> (Scene, Report) {
    let (simulation, mut report, _) = dart::read(folder, &dart::ReadOptions::default()).unwrap();
    let folder = dart::Folder::new(folder, None, false);
    let converted = dart::to_scene(&simulation, &folder, options, &unwatched).unwrap();
    report.notes.extend(converted.report.notes);
    (converted.scene, report)
}

fn text(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The number that an attribute has in the n-th element of a name: looked for in the text.
fn number(text: &str, element: &str, n: usize, attribute: &str) -> f64 {
    let tag = text.split(&format!("<{element} ")).nth(n + 1).unwrap_or_else(|| panic!("no {element} {n}"));
    let tag = tag.split('>').next().unwrap();
    let value = tag.split(&format!("{attribute}=\"")).nth(1).unwrap_or_else(|| panic!("{element}: {tag}"));
    value.split('"').next().unwrap().parse().unwrap()
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn axes_and_azimuths_are_those_worked_out_by_hand() {
    let scratch = Scratch::new();
    let (old, new) = (scratch.path().join("old"), scratch.path().join("new"));
    written(&tetrahedron(), &options(TargetVersion::V5_7_4), &old);
    written(&tetrahedron(), &options(TargetVersion::V5_11_0), &new);

    // x South, y East, z up: A (20, 10, 0), B (-20, 10, 0), C (0, -30, 0), D (0, 0, 15). An OBJ has y z x.
    let obj = text(&old, "input/obj/surface.obj");
    let lines: Vec<&str> = obj.lines().collect();
    let vertices = [[10.0, 0.0, 20.0], [10.0, 0.0, -20.0], [-30.0, 0.0, 0.0], [0.0, 15.0, 0.0]];
    for (line, expected) in lines.iter().zip(vertices) {
        let values: Vec<f64> = line.strip_prefix("v ").unwrap().split(' ').map(|v| v.parse().unwrap()).collect();
        assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{line}");
    }
    assert_eq!(lines[4..], ["g aa", "f 1 2 4", "g ab", "f 2 3 4", "g ac", "f 3 1 4", "g ad", "f 1 3 2"]);

    // 40 m by 40 m by 15 m in cells of 2 m: 21, 21 and 8 of them, and half a cell or less on all sides.
    let maket = text(&old, "input/maket.xml");
    let near =
        |got: f64, expected: f64| assert!((got - expected).abs() < 1e-12 * expected.abs().max(1.0), "{got} {expected}");
    near(number(&maket, "SceneDimensions", 0, "x"), 42.0);
    near(number(&maket, "SceneDimensions", 0, "y"), 42.0);
    let object = text(&old, "input/object_3d.xml");
    for (name, expected) in [("xpos", 21.0), ("ypos", 31.0), ("zpos", 0.5)] {
        near(number(&object, "PositionProperties", 0, name), expected);
    }
    for (name, expected) in [("xdim", 40.0), ("ydim", 40.0), ("zdim", 15.0)] {
        near(number(&object, "Dimension3D", 0, name), expected);
    }

    // The Sun at (3, -4, 5): 45 deg from the zenith, counter-clockwise from South -atan(4 / 3), all the way round 306.87 deg.
    for folder in [&old, &new] {
        let directions = text(folder, "input/directions.xml");
        near(number(&directions, "SunViewingAngles", 0, "sunViewingZenithAngle"), 45.0);
        near(number(&directions, "SunViewingAngles", 0, "sunViewingAzimuthAngle"), 306.869_897_645_844_05);
        // 700 at 1 au, at 1.5 au; normal to the beam.
        near(number(&text(folder, "input/phase.xml"), "SpectralIrradianceValue", 0, "irradiance"), 700.0 / 2.25);
    }

    // The camera at (0, 100, 100) from the origin. From the scene it is in the East, 45 deg up; it looks West and down.
    let phase = text(&old, "input/phase.xml");
    near(number(&phase, "CameraOrientation", 0, "cameraTheta"), 45.0);
    near(number(&phase, "CameraOrientation", 0, "cameraPhi"), 90.0);
    assert_eq!(number(&phase, "CameraOrientation", 0, "cameraRotation"), 0.0);
    let latest = text(&new, "input/phase.xml");
    near(number(&latest, "SensorAngleDirection", 0, "sensorDirectionTheta"), 135.0);
    near(number(&latest, "SensorAngleDirection", 0, "sensorDirectionPhi"), 270.0);
    for (text, element) in [(&phase, "Sensor"), (&latest, "SensorPosition")] {
        for (name, expected) in [("sensorPosX", 21.0), ("sensorPosY", 131.0), ("sensorPosZ", 100.5)] {
            near(number(text, element, 0, name), expected);
        }
    }
    // 300 x 200 pixels of 0.002 of the focal length: 2 atan 0.3 and 2 atan 0.2.
    for (text, element, names) in
        [(&phase, "CamImageAOV", ["aovX", "aovY"]), (&latest, "FieldOfView", ["aovWidth", "aovHeight"])]
    {
        near(number(text, element, 0, names[0]), 33.398_488_467_987_18);
        near(number(text, element, 0, names[1]), 22.619_864_948_040_43);
    }
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn the_sun_shines_on_the_faces_that_it_should() {
    // Cosines of incidence from DART's own numbers: OBJ v y z x, Sun by zenith angle and azimuth.
    let scratch = Scratch::new();
    let folder = scratch.path().join("out");
    written(&tetrahedron(), &options(TargetVersion::V5_7_4), &folder);
    let obj = text(&folder, "input/obj/surface.obj");
    let rows = |key: &str| -> Vec<Vec<f64>> {
        let of = obj.lines().filter_map(|l| l.strip_prefix(key));
        of.map(|l| l.split_whitespace().map(|v| v.parse().unwrap()).collect()).collect()
    };
    let vertices: Vec<DVec3> = rows("v ").iter().map(|v| DVec3::new(v[2], v[0], v[1])).collect();
    let directions = text(&folder, "input/directions.xml");
    let angle = |name: &str| number(&directions, "SunViewingAngles", 0, name) * PI / 180.0;
    let (zenith, azimuth) = (angle("sunViewingZenithAngle"), angle("sunViewingAzimuthAngle"));
    let sun = DVec3::new(zenith.sin() * azimuth.cos(), zenith.sin() * azimuth.sin(), zenith.cos());
    let scene = tetrahedron();
    for (f, face) in rows("f ").iter().enumerate() {
        let [a, b, c] = [0, 1, 2].map(|i| vertices[face[i] as usize - 1]);
        let cosine = (b - a).cross(c - a).normalize().dot(sun);
        let expected = scene.body.mesh.facet(f).normal().dot(scene.sky.sun.direction.vec());
        assert!((cosine - expected).abs() < 1e-14, "face {f}: {cosine} {expected}");
    }
}

/// Every attribute of the elements that are written for 5.7.4.
const ATTRIBUTES: &str = include_str!("dart_5_7_4_attributes.txt");

#[test]
fn every_attribute_of_the_schema_is_written_and_no_other() {
    let mut known = BTreeMap::new();
    for line in ATTRIBUTES.lines().filter(|l| !l.starts_with('#') && !l.is_empty()) {
        let mut words = line.split(' ');
        known.insert(words.next().unwrap(), words.collect::<Vec<_>>());
    }
    fn check(element: &xml::Element, path: &str, known: &BTreeMap<&str, Vec<&str>>, seen: &mut usize) {
        let mut names: Vec<&str> = element.attributes.iter().map(|a| a.name.as_str()).collect();
        names.sort_unstable();
        assert_eq!(Some(&names), known.get(path), "{path}");
        *seen += 1;
        for child in &element.children {
            check(child, &format!("{path}/{}", child.name), known, seen);
        }
    }
    let mut seen = 0;
    for scene in [tetrahedron(), rich()] {
        let (package, _) = dart::from_scene(&scene, &options(TargetVersion::V5_7_4)).unwrap();
        let files = dart::inputs(&package.simulation, &[(DVec3::ZERO, DVec3::ONE)]).unwrap();
        assert_eq!(files.len(), 11);
        for (_, root) in &files {
            assert_eq!((root.get("version"), root.get("build")), (Some("5.7.4"), Some("v1083")));
            check(&root.children[0], &root.children[0].name, &known, &mut seen);
        }
    }
    assert!(seen > 200, "{seen}");
}

fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(a.body.origin_m, b.body.origin_m);
    assert_eq!((&a.body.mesh.facets, &a.body.mesh.material), (&b.body.mesh.facets, &b.body.mesh.material));
    assert_eq!(a.body.mesh.face_of_facet, b.body.mesh.face_of_facet);
    let apart =
        a.body.mesh.vertices_m.iter().zip(&b.body.mesh.vertices_m).map(|(p, q)| (*p - *q).length()).fold(0.0, f64::max);
    assert!(a.body.mesh.vertices_m.len() == b.body.mesh.vertices_m.len() && apart < 1e-9, "{apart:e} m");
    assert_eq!(a.body.materials, b.body.materials);
    assert!(a.sky.sun.direction.angle_rad(b.sky.sun.direction) < 1e-12);
    assert_eq!((a.sky.sun.distance_m, &a.sky.sun.irradiance_1au), (b.sky.sun.distance_m, &b.sky.sun.irradiance_1au));
    assert_eq!(a.sky.sun.total_irradiance_1au_w_m2, b.sky.sun.total_irradiance_1au_w_m2);
    assert_eq!((&a.sky.mars, a.models.thermal), (&b.sky.mars, b.models.thermal));
    assert_eq!((&a.exposure.instrument, &a.exposure.bands), (&b.exposure.instrument, &b.exposure.bands));
    let (x, y) = (&a.exposure.camera, &b.exposure.camera);
    assert_eq!((x.samples, x.lines), (y.samples, y.lines));
    assert!((x.pitch[0] / y.pitch[0] - 1.0).abs() < 1e-12);
    assert!((x.centre_m() - y.centre_m()).length() < 1e-9);
    let turn = x.world_from_sensor.rotation - y.world_from_sensor.rotation;
    assert!((0..3).all(|i| turn.col(i).length() < 1e-12), "{turn}");
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_scene_comes_back_whole() {
    for target in [TargetVersion::V5_7_4, TargetVersion::V5_11_0] {
        let mut full = rich();
        if target == TargetVersion::V5_11_0 {
            // Other models of reflectance are not known there.
            full = edited(&full, |scene| scene.surface.materials.truncate(5));
        }
        for (name, scene) in [("plain", tetrahedron()), ("rich", full)] {
            let scratch = Scratch::new();
            let folder = scratch.path().join("out");
            let report = written(&scene, &options(target), &folder);
            let losses: Vec<_> = report.notes.iter().filter(|n| n.fate <= Fate::Approximated).collect();
            // An emissivity, and a Mars that is no beam.
            assert_eq!(losses.len(), 2 * usize::from(name == "rich"), "{losses:#?}");
            let (back, report) = read(&folder, &SceneOptions::default());
            assert!(report.notes.is_empty(), "{target:?} {name}: {:#?}", report.notes);
            assert_same(&scene, &back);
        }
    }
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn without_the_sidecar_what_is_missing_is_told() {
    let scratch = Scratch::new();
    let folder = scratch.path().join("out");
    let scene = rich();
    written(&scene, &options(TargetVersion::V5_7_4), &folder);
    std::fs::remove_file(folder.join("mmxrt.toml")).unwrap();
    let (back, report) = read(&folder, &SceneOptions::default());
    let told: Vec<(Fate, &str)> =
        report.notes.iter().map(|n| (n.fate, n.message.split([':', ',', '(']).next().unwrap().trim())).collect();
    assert_eq!(
        told,
        [
            (Fate::Defaulted, "DART does not say where on the body the scene is"),
            (Fate::Defaulted, "DART has irradiances of bands only"),
            (Fate::Defaulted, "Bond albedo"),
            (Fate::Approximated, "a turn about the line of sight"),
            (Fate::Dropped, "no mmxrt.toml has a Mars that can be used"),
            (Fate::Approximated, "temperatures are spread between two ends by sunlight"),
        ],
        "{:#?}",
        report.notes
    );
    // What DART does hold is the same: shape, reflectance where it was known, irradiance in the bands, angles.
    let side = |s: &Scene| {
        [(0, 1), (1, 2), (2, 3)].map(|(i, j)| (s.body.mesh.vertices_m[i] - s.body.mesh.vertices_m[j]).length())
    };
    assert!(side(&scene).iter().zip(side(&back)).all(|(a, b)| (a - b).abs() < 1e-9));
    let spectra = |m: &Material| -> Vec<Spectrum> {
        let parameters = m.photometry.parameters().into_iter().map(|(_, s)| s.clone());
        if m.photometry == Photometry::Lambert { vec![m.reflectance.clone()] } else { parameters.collect() }
    };
    for (a, b) in scene.body.materials.iter().zip(&back.body.materials) {
        assert_eq!((&a.name, a.photometry.key()), (&b.name, b.photometry.key()));
        for (x, y) in spectra(a).iter().zip(&spectra(b)) {
            for um in [1.0, 1.5, 2.2] {
                assert!((x.at(um).unwrap() - y.at(um).unwrap()).abs() < 1e-12, "{} {um}", a.name);
            }
        }
    }
    let in_the_bands =
        |s: &Scene| dart::from_scene(s, &options(TargetVersion::V5_7_4)).unwrap().0.simulation.phase.irradiance;
    assert!(
        in_the_bands(&scene)
            .iter()
            .zip(in_the_bands(&back))
            .all(|(a, b)| (a.unwrap().0 / b.unwrap().0 - 1.0).abs() < 1e-9)
    );
    let between = |s: &Scene| s.exposure.camera.world_from_sensor.rotation.z_axis.dot(s.sky.sun.direction.vec());
    assert!((between(&scene) - between(&back)).abs() < 1e-12);
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn an_edited_file_wins() {
    let scratch = Scratch::new();
    let folder = scratch.path().join("out");
    written(&tetrahedron(), &options(TargetVersion::V5_7_4), &folder);
    let edit = |name: &str, from: &str, to: &str| {
        let before = text(&folder, name);
        assert!(before.contains(from), "{from}: {before}");
        std::fs::write(folder.join(name), before.replacen(from, to, 1)).unwrap();
    };
    edit("input/phase.xml", "irradiance=\"311.11", "irradiance=\"411.11");
    edit("input/phase.xml", "deltaLambda=\"0.02\"", "deltaLambda=\"0.04\"");
    edit("input/directions.xml", "sunViewingAzimuthAngle=\"306.", "sunViewingAzimuthAngle=\"206.");
    let (back, report) = read(&folder, &SceneOptions::default());
    let (again, _) = dart::from_scene(&back, &options(TargetVersion::V5_7_4)).unwrap();
    let in_the_band = again.simulation.phase.irradiance[0].unwrap().0;
    assert!((in_the_band - 411.111_111_111_111_1).abs() < 1e-9, "{in_the_band}");
    assert_eq!(back.exposure.bands, [Band { light: Light::Sunlight, ..Band::boxed(1.0, 0.04) }, Band::new(2.0, None)]);
    let turned = back.sky.sun.direction.angle_rad(tetrahedron().sky.sun.direction);
    assert!(turned > 1.0, "{turned}");
    // What was not edited is as it was.
    assert_eq!(back.body.materials, tetrahedron().body.materials);
    assert_eq!(report.notes.len(), 1, "{:#?}", report.notes);
}

#[test]
fn mars_lights_a_second_simulation() {
    let scene = rich();
    let (package, report) = dart::from_scene(&scene, &options(TargetVersion::V5_7_4)).unwrap();
    let mars = package.mars.unwrap();
    // (3, 8, 1) 10^6 m from the origin: South -1, East -3, up 8.
    let [zenith, azimuth] = mars.directions.sun_deg;
    assert!((zenith - 10f64.sqrt().atan2(8.0).to_degrees()).abs() < 1e-12, "{zenith}");
    assert!((azimuth - (360.0 - (-3f64).atan2(-1.0).abs().to_degrees())).abs() < 1e-12, "{azimuth}");
    // A facet that faces Mars gets its light: compare with the light on one, band by band.
    let light = mmxrt::physics::mars::irradiance(
        scene.sky.mars.as_ref().unwrap().centre_m,
        3_389_500.0,
        DVec3::new(3.0, 8.0, 1.0).normalize(),
        scene.sky.sun.direction.vec(),
    );
    let at_2_um = 0.25 + (0.31 - 0.25) * 0.9 / 1.4;
    assert!((mars.phase.irradiance[1].unwrap().0 / (light * at_2_um * 700.0 / 2.25) - 1.0).abs() < 1e-12);
    assert!(mars.phase.bands.iter().all(|b| b.mode == 0));
    assert_eq!(package.simulation.phase.bands.iter().map(|b| b.mode).collect::<Vec<_>>(), [1, 1, 1]);
    assert!(report.notes.iter().any(|n| n.fate == Fate::Approximated && n.message.contains("parallel")));
    // Below the horizon there is none.
    let night = edited(&rich(), |scene| scene.sky.mars.as_mut().unwrap().centre_m = DVec3::new(3e6, -8e6, 1e6));
    assert!(dart::from_scene(&night, &options(TargetVersion::V5_7_4)).unwrap().0.mars.is_none());
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn the_same_scene_gives_the_same_bytes() {
    let scratch = Scratch::new();
    let mut listings = Vec::new();
    for name in ["one", "two"] {
        let folder = scratch.path().join(name);
        written(&rich(), &options(TargetVersion::V5_7_4), &folder);
        let mut files = BTreeMap::new();
        let mut open = vec![folder.clone()];
        while let Some(next) = open.pop() {
            for entry in next.read_dir().unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    open.push(path);
                } else {
                    let inside = path.strip_prefix(&folder).unwrap().to_owned();
                    files.insert(inside, std::fs::read(&path).unwrap());
                }
            }
        }
        listings.push(files);
    }
    assert_eq!(listings[0], listings[1]);
    for name in
        ["README.md", "mmxrt.toml", "input/maket.xml", "mars/input/obj/surface.obj", "check/input/object_3d.xml"]
    {
        assert!(listings[0].contains_key(Path::new(name)), "{name}");
    }
}

#[test]
fn what_a_version_is_not_known_to_have_is_refused() {
    // Each material in a line that says what to do, with all else that is wrong.
    let options_11 = SimulationOptions { cell_m: Some(-1.0), ..options(TargetVersion::V5_11_0) };
    let error = dart::from_scene(&rich(), &options_11).unwrap_err();
    let Error::Invalid(problems) = &error else { panic!("{error}") };
    let lines: Vec<String> = problems.iter().map(|problem| format!("{}: {}", problem.at, problem.message)).collect();
    assert_eq!(
        lines,
        [
            "materials.\"hapke\": how DART 5.11.0 has Hapke's reflectance is not known",
            "materials.\"rpv\": how DART 5.11.0 has the RPV reflectance is not known",
            "cell: -1 m is not a positive length",
        ]
    );
    for problem in &problems[..2] {
        let help = problem.help.as_deref().unwrap();
        assert!(help.contains("make the material a Lambert surface") && help.contains("5.7.4"), "{help}");
    }
    // Nothing is written of a package that somebody says to be of another version.
    let (mut package, _) = dart::from_scene(&rich(), &options(TargetVersion::V5_7_4)).unwrap();
    package.simulation.version = TargetVersion::V5_11_0.version();
    let scratch = Scratch::new();
    let error = dart::write(&package, &scratch.path().join("out"), false, &unwatched).unwrap_err().to_string();
    assert!(error.contains("\"hapke\"") && error.contains("\"rpv\"") && error.contains("5.11.0"), "{error}");
    assert_eq!(scratch.path().read_dir().unwrap().count(), 0, "something was left behind");
}

#[test]
fn groups_are_numbered_alike_by_all_versions() {
    for count in [1, 5, 12, 13, 24, 25, 100, 192, 193, 676] {
        let names = dart::group_names(count).unwrap();
        for build in ["v1083", "v1449"] {
            let version = dart::Version { version: "5".into(), build: build.into() };
            assert!(dart::groups::order(&names, &version).into_iter().eq(0..count), "{count} {build}");
        }
    }
}

#[test]
fn differences_are_told_by_meaning() {
    let (a, _) = dart::from_scene(&rich(), &options(TargetVersion::V5_7_4)).unwrap();
    let mut b = a.simulation.clone();
    assert!(dart::diff(&a.simulation, &b).is_empty());
    // Names mean nothing; nor does the place of a property, if the links follow.
    b.objects[0].name = "other".into();
    b.optical[0].ident = "other".into();
    b.optical.swap(0, 1);
    // Nor does rounding, nor an azimuth in the zenith.
    b.directions.sun_deg[1] += 1e-13;
    for links in b.objects[0].groups.iter_mut().filter_map(|g| g.links.as_mut()) {
        links.index = [1, 0, 2, 3, 4, 5][links.index as usize];
    }
    assert_eq!(dart::diff(&a.simulation, &b), [""; 0]);
    b.directions.sun_deg[0] += 1e-9;
    b.objects[0].groups[1].links.as_mut().unwrap().index = 4;
    b.phase.bands.pop();
    let lines = dart::diff(&a.simulation, &b);
    let starts = [
        "object_3d.xml Object[0] Group[1] table: ",
        "phase.xml SpectralIntervalsProperties, number of them: 3 | 2",
        "directions.xml Sun, zenith angle and azimuth, deg: ",
    ];
    assert_eq!(lines.len(), starts.len(), "{lines:#?}");
    assert!(lines.iter().zip(starts).all(|(line, start)| line.starts_with(start)), "{lines:#?}");
}

#[test]
fn what_does_not_fit_gets_a_proposal() {
    let scene = tetrahedron();
    let said = |options: &SimulationOptions| {
        let (_, report) = dart::from_scene(&scene, options).unwrap();
        report.notes.into_iter().find(|n| n.at.item.as_deref() == Some("size")).unwrap().message
    };
    let fine = SimulationOptions { cell_m: Some(0.05), memory_bytes: 100 << 20, ..options(TargetVersion::V5_7_4) };
    // 801 x 801 x 301 cells at 64 B are 12 GB; twice as large ones an eighth of it, and so on.
    assert!(said(&fine).contains("801 x 801 x 301 cells of 0.05 m"), "{}", said(&fine));
    assert!(said(&fine).ends_with("cells of 0.4 m would fit"), "{}", said(&fine));
    let tiny = SimulationOptions { memory_bytes: 1000, ..fine };
    assert!(said(&tiny).contains("whatever the cells"));
    let wrong = SimulationOptions { cell_m: Some(-1.0), ..options(TargetVersion::V5_7_4) };
    assert!(dart::from_scene(&scene, &wrong).unwrap_err().to_string().contains("not a positive length"));
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn the_shipped_sites_come_back() {
    let sites = ["phobos_site", "phobos_mars_side"];
    for (name, file) in sites.iter().flat_map(|name| [(*name, "scene.toml"), (*name, "thesis.toml")]) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).join(file);
        let scene = scene_toml::read(&path, &unwatched).unwrap().scene;
        let scratch = Scratch::new();
        let folder = scratch.path().join("out");
        let report = written(&scene, &SimulationOptions::default(), &folder);
        // Of the one Mars is 42 deg across, and no beam; at the other its centre is 13 deg below the horizon, and many facets
        // see some of it.
        let lost: Vec<_> =
            report.notes.iter().filter(|n| [Fate::Approximated, Fate::Dropped].contains(&n.fate)).collect();
        let (fate, message) = match name {
            "phobos_site" => (Fate::Dropped, "of the facets see some of it"),
            _ => (Fate::Approximated, "right on a facet that faces it"),
        };
        // Both surfaces are Hapke's, of which DART has the Lambert ones of the same reflectance.
        let (lambert, lost): (Vec<_>, Vec<_>) =
            lost.into_iter().partition(|note| note.message.contains("a Lambert surface of the same hemispherical"));
        let is_lambert = file == "thesis.toml";
        assert_eq!(lambert.len(), if is_lambert { 0 } else { 2 });
        assert!(lost.len() == 1 && lost[0].fate == fate && lost[0].message.contains(message), "{:#?}", report.notes);
        assert_eq!(folder.join("mars").exists(), name == "phobos_mars_side");
        let (back, report) = read(&folder, &SceneOptions::default());
        assert!(report.notes.is_empty(), "{:#?}", report.notes);
        let mut expected = scene.into_parts();
        if !is_lambert {
            expected.surface.materials.iter_mut().for_each(|material| material.photometry = Photometry::Lambert);
        }
        assert_same(&expected.check().unwrap(), &back);
    }
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_sun_below_the_horizon_gives_no_light() {
    let scratch = Scratch::new();
    let folder = scratch.path().join("out");
    // Up is +y: 3 parts down for 4 across are asin(3/5) = 36.870 deg below the horizon.
    let below = Direction::new(DVec3::new(4.0, -3.0, 0.0)).unwrap();
    let scene = edited(&rich(), |scene| scene.sky.sun.direction = below);
    let report = written(&scene, &options(TargetVersion::V5_7_4), &folder);
    assert!(report.notes.iter().any(|n| n.message.starts_with("the Sun stands 36.870 deg below")), "{report:#?}");
    let directions = text(&folder, "input/directions.xml");
    assert_eq!(number(&directions, "SunViewingAngles", 0, "sunViewingZenithAngle"), 0.0);
    let phase = text(&folder, "input/phase.xml");
    assert!((0..3).all(|i| number(&phase, "SpectralIrradianceValue", i, "irradiance") == 0.0));
    // Only heat is left, and no sunlight to spread it by.
    assert!((0..3).all(|i| number(&phase, "SpectralIntervalsProperties", i, "spectralDartMode") == 2.0));
    assert_eq!(number(&text(&folder, "input/coeff_diff.xml"), "ThermalFunction", 0, "deltaT"), 0.0);
    // Mars does not care for the horizon of the Sun.
    assert!(folder.join("mars").exists());
    let (back, report) = read(&folder, &SceneOptions::default());
    assert!(report.notes.is_empty(), "{:#?}", report.notes);
    assert_same(&scene, &back);
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn e490_is_recognized_by_its_irradiances() {
    let scratch = Scratch::new();
    let folder = scratch.path().join("out");
    let scene = edited(&tetrahedron(), |scene| {
        scene.sky.sun.irradiance_1au = mmxrt::spectral::solar_e490().clone();
        scene.exposure.bands = [1.0, 2.0].map(|centre_um| Band::new(centre_um, None)).to_vec();
    });
    written(&scene, &options(TargetVersion::V5_7_4), &folder);
    std::fs::remove_file(folder.join("mmxrt.toml")).unwrap();
    // The standard: 747.9 W m-2 um-1 at 1 um and 117 at 2 um; at 1.5 au they are divided by 2.25.
    let path = folder.join("input/phase.xml");
    let phase = std::fs::read_to_string(&path).unwrap();
    for (i, at_1_au) in [747.9, 117.0].into_iter().enumerate() {
        let given = number(&phase, "SpectralIrradianceValue", i, "irradiance");
        assert!((given - at_1_au / 2.25).abs() < 1e-9, "{given}");
    }
    let (back, _) = read(&folder, &SceneOptions::default());
    // Bands are 0.001 um wide in DART, and the table has lines about 1 um: the mean is not quite the value there.
    assert!((back.sky.sun.distance_m / AU_M - 1.5).abs() < 2e-3, "{}", back.sky.sun.distance_m / AU_M);
    assert!(
        (back.sky.sun.total_irradiance_1au_w_m2 - 1366.09).abs() < 3.0,
        "{}",
        back.sky.sun.total_irradiance_1au_w_m2
    );
    // One band twice as bright: the other one tells the distance or this one, and between them the factor is linear.
    let second = phase.match_indices("irradiance=\"").nth(1).unwrap().0 + "irradiance=\"".len();
    let end = second + phase[second..].find('"').unwrap();
    std::fs::write(&path, format!("{}104{}", &phase[..second], &phase[end..])).unwrap();
    let (back, _) = read(&folder, &SceneOptions::default());
    let at_the_body = |um: f64| back.sky.sun.irradiance_1au.at(um).unwrap() * (AU_M / back.sky.sun.distance_m).powi(2);
    assert!((at_the_body(1.0) / (747.9 / 2.25) - 1.0).abs() < 3e-3 && (at_the_body(2.0) / 104.0 - 1.0).abs() < 3e-3);
    let e490_at = |um: f64| mmxrt::spectral::solar_e490().at(um).unwrap();
    assert!((at_the_body(1.5) / (1.5 * e490_at(1.5) / 2.25) - 1.0).abs() < 3e-3);
    // The sum of all wavelengths stays that of a sun: 1366 to 2 x 1366 at the same distance.
    let total = back.sky.sun.total_irradiance_1au_w_m2 * (1.5 * AU_M / back.sky.sun.distance_m).powi(2);
    assert!((1366.0..2732.2).contains(&total), "{total}");
    // Boxes come back as they were, and so does the Sun.
    let boxes = [1.0, 2.0].map(|centre_um| Band::boxed(centre_um, 0.02));
    let scene = edited(&scene, |scene| scene.exposure.bands = boxes.to_vec());
    let folder = scratch.path().join("wide");
    written(&scene, &options(TargetVersion::V5_7_4), &folder);
    std::fs::remove_file(folder.join("mmxrt.toml")).unwrap();
    let (back, _) = read(&folder, &SceneOptions::default());
    assert!((back.sky.sun.distance_m / AU_M - 1.5).abs() < 1e-12);
    assert_eq!(&back.sky.sun.irradiance_1au, mmxrt::spectral::solar_e490());
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn more_materials_than_groups_take_more_files() {
    let scratch = Scratch::new();
    let folder = scratch.path().join("out");
    let mut scene = tetrahedron().into_parts();
    // 700 triangles side by side, each of another material but for one that no facet has.
    let materials = 701;
    let reflectance = |i: usize| 0.001 * i as f64;
    scene.surface.materials =
        (0..materials).map(|i| lambert(i, &format!("m{i}"), Spectrum::constant(reflectance(i)))).collect();
    let corner = |i: usize| DVec3::new((i % 30) as f64, 0.25 * (i % 7) as f64, (i / 30) as f64);
    let facet = |i: usize| [corner(i), corner(i) + 0.9 * DVec3::Z, corner(i) + 0.9 * DVec3::X];
    scene.surface.mesh = Mesh {
        vertices_m: (0..700).flat_map(facet).collect(),
        facets: (0..700).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        material: (0..701).filter(|m| *m != 5).map(MaterialId).collect(),
        face_of_facet: vec![],
        uv: vec![],
    };
    let scene = scene.check().unwrap();
    for target in [TargetVersion::V5_7_4, TargetVersion::V5_11_0] {
        let folder = folder.join(format!("{target:?}"));
        let report = written(&scene, &options(target), &folder);
        assert!(!report.has_losses(), "{:#?}", report.notes);
        let count = |name: &str, what: &str| text(&folder, name).matches(what).count();
        // A group for each material, 676 of them in the first file and 24 in the second, and a triangle in each.
        for (file, groups) in [("surface", 676), ("surface_2", 24)] {
            let file = format!("input/obj/{file}.obj");
            assert_eq!([count(&file, "g "), count(&file, "f "), count(&file, "v ")], [groups, groups, 3 * groups]);
        }
        assert_eq!([count("input/object_3d.xml", "<Object "), count("input/object_3d.xml", "<Group ")], [2, 700]);
        let (back, report) = read(&folder, &SceneOptions::default());
        assert!(report.notes.is_empty(), "{:#?}", report.notes);
        // Facet by facet: where it is, and what it is made of, which its reflectance tells.
        assert_eq!(back.body.mesh.facets.len(), 700);
        for i in 0..700 {
            let expected = if i < 5 { i } else { i + 1 };
            let material = &back.body.materials[usize::from(back.body.mesh.material[i].0)];
            assert!((material.reflectance.value()[0] - reflectance(expected)).abs() < 1e-15);
            let corners = back.body.mesh.facet(i).corners_m;
            assert!(corners.iter().zip(facet(i)).all(|(a, b)| (*a - b).length() < 1e-9), "{i}");
        }
    }
}

#[test]
fn an_emissivity_that_dart_does_not_have_is_told() {
    let scene = rich();
    let (package, report) = dart::from_scene(&scene, &options(TargetVersion::V5_7_4)).unwrap();
    assert_eq!(package.simulation.phase.bands[0].mode, 1);
    let told: Vec<String> = (report.notes.iter().filter(|n| n.fate == Fate::Approximated))
        .map(|n| format!("{} {}", n.at.item.as_deref().unwrap_or_default(), n.message))
        .collect();
    // 0.9, where 1 - 0.123 = 0.877.
    assert_eq!(
        told.iter().filter(|note| !note.starts_with("mars ")).collect::<Vec<_>>(),
        ["materials.\"select\".emissivity in DART it is 1 - reflectance: up to 0.0230 off in the bands with heat"]
    );
}

#[test]
fn a_box_that_reaches_where_surfaces_glow_has_heat() {
    // At 2.5 um, 300 K sends some 6e-3 W m-2 sr-1 um-1; in the middle of the box, at 1.4 um, less than 1e-8.
    let scene = edited(&tetrahedron(), |scene| {
        scene.models.thermal = Thermal::Equilibrium;
        scene.exposure.bands = vec![Band::boxed(1.425, 2.15), Band::boxed(1.425, 0.1)];
    });
    let (package, _) = dart::from_scene(&scene, &options(TargetVersion::V5_7_4)).unwrap();
    assert_eq!(package.simulation.phase.bands.iter().map(|b| b.mode).collect::<Vec<_>>(), [1, 0]);
}

#[test]
fn filter_curves_that_become_rectangles_are_told_with_what_that_costs() {
    // A response of two peaks at the ends of a rectangle, under a reflectance that is 0.1 there and 0.3 amid them.
    let mut scene = tetrahedron().into_parts();
    let spectrum = |um: &[f64], values: &[f64]| Spectrum::new(um.to_vec(), values.to_vec(), Extend::Error).unwrap();
    scene.surface.materials = vec![lambert(0, "peaked", spectrum(&[0.5, 1.0, 1.5], &[0.1, 0.3, 0.1]))];
    scene.surface.mesh.material = vec![MaterialId(0); 4];
    let peaks = spectrum(&[0.6, 0.65, 0.7, 1.3, 1.35, 1.4], &[0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    scene.exposure.bands = vec![Band::tabulated(&peaks).unwrap()];
    let (_, report) = dart::from_scene(&scene.check().unwrap(), &options(TargetVersion::V5_7_4)).unwrap();
    let note = report.notes.iter().find(|n| n.message.contains("tabulated responses")).unwrap();
    // Means: 0.1 + 0.2 x 0.15 / 0.5 = 0.16 over the peaks; 0.3 - 0.4 x 0.05 / 2 = 0.29 over 0.1 um about 1 um: 0.8125 more.
    assert!(note.fate == Fate::Approximated && note.message.contains("up to 8.1e-1 off"), "{note:?}");
}

/// A push-broom over a site on the equator, straight down: three lines 10 s apart, 12 m/s towards the South; the Sun sinks in the West by 0.013065 deg/s.
#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn exposures_become_a_sequence() {
    let timing = Timing { readout: Readout::Line, period_s: 10.0, exposure_s: 0.0, poses: 1 };
    let motion = crate::past::over(DVec3::new(0.0, 0.0, -12.0), 40.0);
    let mut parts = edited_parts(&motion);
    parts.exposure.camera.lines = 3;
    parts.exposure.camera.boresight_px[1] = 1.5;
    let scene = parts.check().unwrap();
    let middle_s = timing.middle_s(timing.reference(&scene.exposure));
    let scene = motion.at(&scene, scene.exposure.clone(), motion.start.after_s(middle_s)).unwrap();
    for target in [TargetVersion::V5_7_4, TargetVersion::V5_11_0] {
        let (mut package, mut report) = dart::from_scene(&scene, &options(target)).unwrap();
        dart::add_flight(&mut package, &scene, (&motion, &timing), &mut report).unwrap();
        let told: Vec<String> = report.notes.iter().map(ToString::to_string).collect();
        assert!(told.iter().any(|note| note.contains("3 exposures are the sequence `flight.xml`")), "{told:#?}");
        let scratch = Scratch::new();
        let folder = scratch.join("sim");
        dart::write(&package, &folder, false, &unwatched).unwrap();
        let (simulation, ..) = dart::read(&folder, &dart::ReadOptions::default()).unwrap();
        let [sequence] = &simulation.sequences[..] else { panic!("{:?}", simulation.sequences) };
        assert_eq!((sequence.name.as_str(), dart::rows(sequence).unwrap().len()), ("flight", 3));
        let (steps, report) = dart::flight(&folder, sequence, &dart::ReadOptions::default()).unwrap();
        assert!(report.notes.iter().all(|note| note.fate != Fate::Dropped), "{report:?}");
        let middle = package.simulation.phase.cameras[0].position_m;
        for (k, step) in steps.iter().enumerate() {
            let since_s = 10.0 * (k as f64);
            // 40 deg after noon at the start, and 360 deg in a day of 27553.843872 s; West is the azimuth of 270 deg, from South by East.
            let zenith_deg = 40.0 + 360.0 * since_s / 27_553.843_872;
            assert!((step.sun_deg[0] - zenith_deg).abs() < 1e-5, "{:?} {zenith_deg}", step.sun_deg);
            assert!((step.sun_deg[1] - 270.0).abs() < 1e-5, "{:?}", step.sun_deg);
            let [camera] = &step.cameras[..] else { panic!("{step:?}") };
            // DART's x is South.
            let expected = middle + DVec3::new(12.0 * (since_s - 10.0), 0.0, 0.0);
            assert!((camera.position_m - expected).length() < 1e-6, "{camera:?} {expected}");
            assert!((camera.look_deg[0] - 180.0).abs() < 1e-9 && camera.pixels[1] == 1, "{camera:?}");
            let pitch = scene.exposure.camera.pitch[1];
            let of_line = 2.0 * (0.5 * pitch).atan().to_degrees();
            assert!((camera.field_of_view_deg[1] / of_line - 1.0).abs() < 1e-9, "{camera:?}");
        }
        // Its place and the Sun's are what changes, and its height of three lines that is one now; nothing else.
        let properties: Vec<&str> = sequence.groups[0].entries.iter().map(|entry| entry.property.as_str()).collect();
        assert!(properties.contains(&"Directions.SunViewingAngles.sunViewingZenithAngle"), "{properties:?}");
        assert!(properties.iter().all(|p| !p.contains("irradiance") && !p.contains("meanLambda")), "{properties:?}");
        assert!(properties.iter().filter(|p| p.starts_with("Phase.SensorImageSimulation.")).count() >= 3);
    }
}

/// A grey site at longitude 0, as others are, under the sky of a motion and with a camera of 4 x 3 pixels.
fn edited_parts(motion: &mmxrt::scene::Motion) -> mmxrt::scene::SceneParts {
    let mut parts = scenes::parts(plane(10.0, 0.0), nadir(1000.0, 20.0, 4), sun(40.0, 0.0));
    parts.surface.origin_m = motion.origin_m;
    // Facing outwards, which is +x there.
    parts.surface.mesh.vertices_m.iter_mut().for_each(|v| *v = DVec3::new(v.z, v.x, v.y));
    parts
}
