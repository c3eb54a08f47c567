//! Double-faced facets of DART: two sheets in one place with opposite sides out, as images see them and on the way back.

use std::f64::consts::PI;
use std::path::Path;

use glam::{DMat3, DVec3};
use mmxrt::Error;
use mmxrt::formats::convert::{Content, differences};
use mmxrt::formats::dart::{self, ReadOptions, SceneOptions, TargetVersion};
use mmxrt::geometry::{FrameCamera, MaterialId, Mesh, Pose};
use mmxrt::progress::unwatched;
use mmxrt::report::Fate;
use mmxrt::scene::Scene;
use mmxrt::spectral::Spectrum;
use mmxrt::study::{Observation, simulate};

use crate::dart_write::{options, read, written};
use crate::scenes::{edited, lambert, parts};
use crate::scratch::{Scratch, edit};
use crate::shapes::{cuboid, direction, joined, of_material, plane, quad};

/// The site's axes in those of the body: above longitude 90 deg, where up is +y.
const EAST: DVec3 = DVec3::NEG_X;
const NORTH: DVec3 = DVec3::Z;
const UP: DVec3 = DVec3::Y;
const RADIUS_M: f64 = 11_000.0;
const FRONT: f64 = 0.6;
const BACK: f64 = 0.2;

/// A mesh that was made with x East, y North and z up.
fn standing(mut mesh: Mesh) -> Mesh {
    let body_from_site = DMat3::from_cols(EAST, NORTH, UP);
    mesh.vertices_m.iter_mut().for_each(|v| *v = body_from_site * *v);
    mesh
}

/// What the site's axes say, in those of the body.
fn site(v: [f64; 3]) -> DVec3 {
    v[0] * EAST + v[1] * NORTH + v[2] * UP
}

/// 16 x 16 pixels, each 1 m wide at 1 m: at a height over the site's middle, looking down or up, East to the right.
fn camera(height_m: f64, looks_up: bool) -> FrameCamera {
    let (down, ahead) = if looks_up { (NORTH, UP) } else { (-NORTH, -UP) };
    let pose = Pose { rotation: DMat3::from_cols(EAST, down, ahead), translation_m: height_m * UP };
    FrameCamera::centred(pose, 16, 16, 1.0)
}

/// A scene of two materials, with the Sun in this direction.
fn scene(mesh: Mesh, towards_sun: [f64; 3]) -> Scene {
    let towards = site(towards_sun).to_array();
    let mut parts = parts(standing(mesh), camera(1.0, false), direction(towards));
    parts.surface.origin_m = DVec3::new(0.0, RADIUS_M, 0.0);
    parts.surface.materials =
        vec![lambert(0, "front", Spectrum::constant(FRONT)), lambert(1, "back", Spectrum::constant(BACK))];
    parts.check().unwrap()
}

/// A sheet of two sides: `front` looks where the quad does, `back` the other way.
fn sheet(front: Mesh) -> Mesh {
    let mut back = of_material(front.clone(), 1);
    back.flip();
    joined(&[front, back])
}

/// Six metres along East, four along North, at a height.
fn plate(z: f64) -> Mesh {
    quad([-3.0, -2.0, z], [3.0, -2.0, z], [3.0, 2.0, z], [-3.0, 2.0, z])
}

fn object_3d(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("input/object_3d.xml")).unwrap()
}

fn differ(a: &Scene, b: &Scene) -> Vec<String> {
    let content = |scene: &Scene| Content::Scene(Box::new(scene.clone()), Vec::new());
    differences(&content(a), &content(b))
}

/// The scene by way of DART.
fn by_dart(scene: &Scene, target: TargetVersion) -> Scene {
    let scratch = Scratch::new();
    written(scene, &options(target), &scratch.join("sim"));
    read(&scratch.join("sim"), &SceneOptions::default()).0
}

fn seen(scene: &Scene) -> Observation {
    let (_, observation) = simulate(scene, &unwatched).unwrap();
    for check in &observation.checks {
        assert!(check.passed(), "{check:?}");
    }
    observation
}

/// What a Lambert surface sends back of the Sun's light, which stands at this cosine over it.
fn radiance(scene: &Scene, reflectance: f64, cosine: f64) -> f64 {
    let sun = &scene.sky.sun;
    let au = sun.distance_m / mmxrt::units::AU_M;
    reflectance / PI * cosine * sun.irradiance_1au.at(1.0).unwrap() / (au * au)
}

#[test]
fn a_sheet_shows_its_front_from_above_and_its_back_from_below() {
    for target in [TargetVersion::V5_7_4, TargetVersion::V5_11_0] {
        let scene = by_dart(&scene(sheet(plane(100.0, 0.0)), [0.6, 0.0, 0.8]), target);
        assert_eq!(scene.body.mesh.facets.len(), 4);
        // The Sun above, and below: the camera above sees the front, the one below the back.
        for (towards_sun, looks_up, expected) in [
            ([0.6, 0.0, 0.8], false, radiance(&scene, FRONT, 0.8)),
            ([0.6, 0.0, 0.8], true, 0.0),
            ([0.6, 0.0, -0.8], true, radiance(&scene, BACK, 0.8)),
            ([0.6, 0.0, -0.8], false, 0.0),
        ] {
            let scene = edited(&scene, |parts| {
                parts.sky.sun.direction = direction(site(towards_sun).to_array());
                parts.exposure.camera = camera(if looks_up { -1.0 } else { 1.0 }, looks_up);
            });
            let seen = seen(&scene);
            assert!(seen.backplanes.plane("COVERAGE").unwrap().values.iter().all(|c| (c - 1.0).abs() < 1e-12));
            let band = seen.cube.band(0);
            assert!(
                band.len() == 256 && band.iter().all(|l| (l - expected).abs() <= 1e-9 * (expected + 1.0)),
                "{target:?} {towards_sun:?} {looks_up}: {expected}, not {band:?}"
            );
        }
        assert!(radiance(&scene, BACK, 0.8) > 1.0);
    }
}

#[test]
fn a_sheet_throws_the_shadow_of_one() {
    // The Sun half as far East as it is up: what is 2 m high throws its shadow 1 m to the West. Between the sheet and the ground a
    // camera sees the ground's square metres, of which columns 4 to 9 (4 m West to 2 m East) and rows 6 to 9 are in the shadow.
    let both = joined(&[sheet(plate(2.0)), plane(100.0, 0.0)]);
    let cosine = 2.0 / 5f64.sqrt();
    let scene = by_dart(&scene(both, [1.0, 0.0, 2.0]), TargetVersion::V5_7_4);
    let image = seen(&scene);
    let lit = radiance(&scene, FRONT, cosine);
    for (i, l) in image.cube.band(0).iter().enumerate() {
        let (row, column) = (i / 16, i % 16);
        let is_dark = (4..10).contains(&column) && (6..10).contains(&row);
        let expected = if is_dark { 0.0 } else { lit };
        assert!((l - expected).abs() < 1e-6 * lit, "{row} {column}: {l}, not {expected}");
    }
    // Its own lower side is in that shadow as well: 1 m above a camera at 1 m, it is 6 by 4 pixels wide and dark.
    let below = edited(&scene, |parts| parts.exposure.camera = camera(1.0, true));
    let below = seen(&below);
    assert!(below.cube.band(0).iter().all(|l| l.abs() < 1e-6 * lit));
    let covered: f64 = below.backplanes.plane("COVERAGE").unwrap().values.iter().sum();
    assert!((covered - 24.0).abs() < 1e-6, "{covered}");
    // From above its front is lit whole, whatever lies in the same place the other way round: 1 m below the camera it is as large.
    let above = edited(&scene, |parts| parts.exposure.camera = camera(3.0, false));
    let above = seen(&above);
    for (row, column) in [(7, 5), (7, 7), (7, 8), (8, 6), (8, 10)] {
        let l = above.cube.band(0)[row * 16 + column];
        assert!((l - lit).abs() < 1e-6 * lit, "{row} {column}: {l}, not {lit}");
    }
}

#[test]
fn pairs_become_groups_with_two_faces() {
    let scratch = Scratch::new();
    let folder = scratch.join("sim");
    // The sheet's front and the ground are of one material: a group with a back, and one without.
    let both = scene(joined(&[sheet(plate(2.0)), plane(10.0, 0.0)]), [1.0, 0.0, 2.0]);
    let report = written(&both, &options(TargetVersion::V5_7_4), &folder);
    assert!(report.notes.iter().any(|note| note.message.starts_with("2 facets are another one turned round")));
    assert!(!report.has_losses(), "{:#?}", report.notes);
    let obj = std::fs::read_to_string(folder.join("input/obj/surface.obj")).unwrap();
    assert_eq!([obj.matches("\nf ").count(), obj.matches("v ").count(), obj.matches("\ng ").count()], [4, 8, 2]);
    let (simulation, ..) = dart::read(&folder, &ReadOptions::default()).unwrap();
    let [object] = &simulation.objects[..] else { panic!() };
    let sides = |g: &dart::Group| (g.double_face, g.links.clone().unwrap().ident, g.back.clone().map(|b| b.ident));
    let groups: Vec<_> = object.groups.iter().map(sides).collect();
    assert_eq!(groups, [(false, "front".into(), None), (true, "front".into(), Some("back".into()))]);
    // A surface of one group has no list of them.
    let alone = scratch.join("alone");
    written(&scene(sheet(plate(2.0)), [0.0, 0.0, 1.0]), &options(TargetVersion::V5_7_4), &alone);
    let text = object_3d(&alone);
    assert!(text.contains("hasGroups=\"0\"") && text.contains("doubleFace=\"1\""), "{text}");
    assert!(text.contains("<BackFaceOpticalProperty>") && text.contains("<BackFaceThermalProperty>"), "{text}");
    // How 5.11 says it is inferred, and told to be.
    let newer = scratch.join("newer");
    let report = written(&both, &options(TargetVersion::V5_11_0), &newer);
    assert!(report.notes.iter().any(|n| n.fate == Fate::Approximated && n.message.contains("of a back is inferred")));
}

#[test]
fn sheets_go_to_dart_and_back_the_same_again_and_again() {
    let mut box_of_two = sheet(cuboid([-1.0, -2.0, 1.0], [2.0, 3.0, 4.0]));
    // A side whose back is of the front's material, and one without a back.
    box_of_two.material[13] = MaterialId(0);
    let last = box_of_two.facets.len() - 1;
    box_of_two.facets.truncate(last);
    box_of_two.material.truncate(last);
    for target in [TargetVersion::V5_7_4, TargetVersion::V5_11_0] {
        let first = scene(joined(&[box_of_two.clone(), plane(10.0, 0.0)]), [0.3, 0.1, 1.0]);
        let second = by_dart(&first, target);
        assert_eq!(differ(&first, &second), [""; 0], "{target:?}");
        let third = by_dart(&second, target);
        assert_eq!(differ(&second, &third), [""; 0], "{target:?}");
        // Facet by facet, now that fronts come before backs.
        let fourth = by_dart(&third, target);
        assert_eq!(third.body.mesh.facets.len(), 12 + 11 + 2);
        assert_eq!(third.body.mesh.material, fourth.body.mesh.material);
    }
}

#[test]
fn hidden_mirrored_and_faulty_backs() {
    let both = scene(joined(&[sheet(plate(2.0)), plane(10.0, 0.0)]), [1.0, 0.0, 2.0]);
    let with = |from: &str, to: &str| {
        let scratch = Scratch::new();
        let folder = scratch.join("sim");
        written(&both, &options(TargetVersion::V5_7_4), &folder);
        // Whoever edits the inputs does not know of it.
        std::fs::remove_file(folder.join("mmxrt.toml")).unwrap();
        edit(&folder.join("input/object_3d.xml"), from, to);
        let (simulation, ..) = dart::read(&folder, &ReadOptions::default()).unwrap();
        let converted = dart::to_scene(
            &simulation,
            &dart::Folder::new(&folder, None, false),
            &SceneOptions { origin_m: Some(DVec3::new(0.0, RADIUS_M, 0.0)), repeat: 0 },
            &unwatched,
        );
        (converted, dart::check(&folder, &ReadOptions::default(), &dart::no_summary))
    };
    // A mirror along South: outside stays outside, so the front still looks up.
    let (mirrored, _) = with("xscale=\"1.0\"", "xscale=\"-1.0\"");
    let mirrored = mirrored.unwrap().scene;
    let up = |f: usize| mirrored.body.mesh.facet(f).normal().dot(UP);
    let name = |f: usize| mirrored.body.materials[usize::from(mirrored.body.mesh.material[f].0)].name.clone();
    let sides: Vec<(String, f64)> = (0..6).map(|f| (name(f), up(f).round())).collect();
    assert_eq!(sides.iter().filter(|s| **s == ("back".to_owned(), -1.0)).count(), 2, "{sides:?}");
    assert_eq!(sides.iter().filter(|s| **s == ("front".to_owned(), 1.0)).count(), 4, "{sides:?}");
    // A hidden group has no back either.
    let (hidden, _) = with(
        "num=\"2\" name=\"ab\" groupDEMMode=\"0\" hidden=\"0\"",
        "num=\"2\" name=\"ab\" groupDEMMode=\"0\" hidden=\"1\"",
    );
    assert_eq!(hidden.unwrap().scene.body.mesh.facets.len(), 2);
    // A link of the back that leads nowhere is refused at its place, and found by a check.
    let back = "<BackFaceOpticalProperty>\n";
    let text = {
        let scratch = Scratch::new();
        written(&both, &options(TargetVersion::V5_7_4), &scratch.join("sim"));
        object_3d(&scratch.join("sim"))
    };
    let start = text.find(back).unwrap();
    let link = &text[start..start + text[start..].find("/>").unwrap()];
    let (faulty, findings) = with(link, &link.replace("indexFctPhase=\"1\"", "indexFctPhase=\"7\""));
    let Err(Error::Invalid(problems)) = faulty else { panic!() };
    assert!(problems[0].message.contains("entry 7 of type 0"), "{problems:?}");
    assert!(problems[0].at.line.is_some());
    assert!(findings.iter().any(|f| f.at.line == problems[0].at.line), "{findings:?}");
}

#[test]
fn a_thousand_pairs_of_materials_are_told_apart() {
    // 30 materials on either side in all combinations: 900 groups, of which a file has 676.
    let small = |i: u16| {
        let (x, y) = (3.0 * f64::from(i % 30), 3.0 * f64::from(i / 30));
        let front = crate::shapes::mesh(&[[x, y, 0.0], [x + 1.0, y, 0.0], [x, y + 1.0, 0.0]], &[[0, 1, 2]]);
        let (front, mut back) = (of_material(front.clone(), i % 30), of_material(front, i / 30));
        back.flip();
        [front, back]
    };
    let all: Vec<Mesh> = (0..900).flat_map(small).collect();
    let scene = edited(&scene(plate(0.0), [0.0, 0.0, 1.0]), |parts| {
        parts.surface.mesh = standing(joined(&all));
        let grey = |i: usize| lambert(i, &format!("m{i:02}"), Spectrum::constant(0.01 * (i + 1) as f64));
        parts.surface.materials = (0..30).map(grey).collect();
    });
    let scratch = Scratch::new();
    let report = written(&scene, &options(TargetVersion::V5_7_4), &scratch.join("sim"));
    assert!(!report.has_losses(), "{:#?}", report.notes);
    let text = object_3d(&scratch.join("sim"));
    assert_eq!([text.matches("<Object ").count(), text.matches("<Group ").count()], [2, 900]);
    assert_eq!(text.matches("<BackFaceOpticalProperty>").count(), 900);
    let back = read(&scratch.join("sim"), &SceneOptions::default()).0;
    assert_eq!(differ(&scene, &back), [""; 0]);
}
