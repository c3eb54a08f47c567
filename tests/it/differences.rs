//! A comparison names every part of a scene that is not alike.

use glam::{DMat3, DVec3};

use mmxrt::formats::convert::{Content, differences};
use mmxrt::geometry::{Direction, MaterialId, Texels};
use mmxrt::physics::sun_disc::DiscRule;
use mmxrt::scene::{Hapke, MarsModel, Photometry, Rpv, Scene, SceneParts, SunModel, TextureKind, Thermal};
use mmxrt::spectral::{Extend, Spectrum};

use crate::cli::run;
use crate::scenes::edited;
use crate::scratch::Scratch;

const SCENE: &str = r#"
mmxrt_scene = 1
origin_m = [0.0, 0.0, 11000.0]
[[mesh]]
obj = "t.obj"
[materials.a]
reflectance = 0.1
texture = { raster = "dark.csv", quantity = "reflectance", placement = "atlas" }
[materials.b]
reflectance = 0.3
[sun]
direction = [0.0, 0.5, 0.8]
distance_au = 1.5
[mars]
position_m = [9.4e6, 0.0, 2.0e6]
[[bodies]]
name = "moon"
position_m = [-2.3e7, 0.0, 1.0e5]
radius_m = 6200
albedo = 0.07
[observer]
position_m = [0.3, 0.3, 11010.0]
target_m = [0.3, 0.3, 11000.0]
up = [0.0, 1.0, 0.0]
[sensor]
samples = 8
lines = 8
fov_deg = 5.0
bands = { centres_um = [1.0, 2.0] }
"#;
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                   usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4/4\n";

fn prepared() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("t.obj", OBJ);
    scratch.write("dark.csv", "0.1,0.2\n");
    scratch.write("bright.csv", "0.9,0.8\n");
    scratch
}

fn differ(a: &Scene, b: &Scene) -> Vec<String> {
    let content = |scene: &Scene| Content::Scene(Box::new(scene.clone()), Vec::new());
    differences(&content(a), &content(b))
}

#[test]
fn a_texture_is_a_difference() {
    let scratch = prepared();
    let name = |name: &str, text: &str| {
        scratch.write(name, text);
        scratch.argument(name)
    };
    let dark = name("dark.toml", SCENE);
    let bright = name("bright.toml", &SCENE.replace("dark.csv", "bright.csv"));
    let none: String = SCENE.lines().filter(|line| !line.starts_with("texture")).map(|l| format!("{l}\n")).collect();
    let none = name("none.toml", &none);
    let (code, out, _) = run(&["convert", "--diff", &dark, &dark]);
    assert_eq!((code, out.contains("the same in meaning")), (0, true), "{out}");
    let (code, out, _) = run(&["convert", "--diff", &dark, &bright]);
    assert!(code == 1 && out.contains("textures.\"a\" values (2 of 2)") && out.contains("0.1 (mean 0.15"), "{out}");
    let (code, out, _) = run(&["convert", "--diff", &dark, &none]);
    assert!(code == 1 && out.contains("textures.\"a\": is there, is not"), "{out}");
}

#[test]
fn every_part_of_a_scene_is_compared() {
    let scratch = prepared();
    let scene = scratch.scene(SCENE);
    assert_eq!(differ(&scene, &scene), [""; 0]);
    let constant = Spectrum::constant;
    let hapke = |c4: f64| {
        let all = [0.3, 0.4, 0.2, 0.1, c4, 1.0, 0.05].map(constant);
        Photometry::Hapke(Box::new(Hapke::from(all)))
    };
    let rpv = |h: f64| Photometry::Rpv(Box::new(Rpv::from([0.05, 0.8, -0.1, h].map(constant))));
    type Change<'a> = (&'a str, &'a dyn Fn(&mut SceneParts));
    let changes: &[Change] = &[
        ("origin_m", &|s| s.surface.origin_m.x += 1.0),
        ("mesh, ", &|s| s.surface.mesh.vertices_m[1].x += 0.1),
        ("mesh, ", &|s| s.surface.mesh.material[0] = MaterialId(1)),
        ("mesh texture coordinates of 1 facets", &|s| s.surface.mesh.uv[0][1] = [0.5, 0.0]),
        ("mesh texture coordinates", &|s| s.surface.mesh.uv = vec![]),
        ("mesh, faces", &|s| s.surface.mesh.face_of_facet = vec![0, 0]),
        ("materials.\"a\".reflectance", &|s| s.surface.materials[0].reflectance = constant(0.2)),
        ("materials.\"a\".emissivity", &|s| s.surface.materials[0].emissivity = constant(0.5)),
        ("materials.\"b\".bond_albedo", &|s| s.surface.materials[1].bond_albedo += 0.01),
        ("materials.\"b\".emissivity_bolometric", &|s| s.surface.materials[1].emissivity_bolometric -= 0.01),
        ("materials.\"b\".mixture", &|s| s.surface.materials[1].mixture = vec![(0, 0.5), (1, 0.5)]),
        ("materials.\"b\" photometry", &|s| s.surface.materials[1].photometry = hapke(0.0)),
        ("materials.\"b\" photometry", &|s| s.surface.materials[1].photometry = rpv(0.0)),
        ("materials.\"c\"", &|s| s.surface.materials[1].name = "c".into()),
        ("textures.\"a\" quantity", &|s| s.surface.textures[0].kind = TextureKind::Factor),
        ("textures.\"a\" values", &|s| s.surface.textures[0].values[1] = 0.7),
        ("textures.\"a\" texels", &|s| {
            (s.surface.textures[0].rows, s.surface.textures[0].columns) =
                (s.surface.textures[0].columns, s.surface.textures[0].rows);
        }),
        ("textures.\"a\" wavelengths", &|s| s.surface.textures[0].wavelength_um = vec![1.0]),
        ("textures.\"a\" between texels", &|s| s.surface.textures[0].texels = Texels::Bilinear),
        ("textures.\"a\" on 1 facets", &|s| s.surface.textures[0].corners[0][2] = [0.5, 0.5]),
        ("textures.\"b\"", &|s| {
            s.surface.textures[0].material = MaterialId(1);
            s.surface.textures[0].corners[1] = s.surface.textures[0].corners[0];
        }),
        ("sun.direction", &|s| s.sky.sun.direction = Direction::new(DVec3::Z).unwrap()),
        ("sun.distance_m", &|s| s.sky.sun.distance_m *= 1.01),
        ("sun.spectrum", &|s| s.sky.sun.irradiance_1au = constant(700.0)),
        ("sun.total_irradiance_w_m2", &|s| s.sky.sun.total_irradiance_1au_w_m2 += 1.0),
        ("sun.limb_darkening", &|s| s.sky.sun.limb_darkening = 0.5),
        ("sun.points", &|s| s.models.sun = SunModel::Disc(DiscRule::G3)),
        ("mars: ", &|s| s.sky.mars = None),
        ("mars.day_k", &|s| s.sky.mars.as_mut().unwrap().day_night_k[0] += 1.0),
        ("mars.night_k", &|s| s.sky.mars.as_mut().unwrap().day_night_k[1] += 1.0),
        ("mars.eclipse", &|s| s.models.eclipses = true),
        ("mars.points", &|s| s.models.mars_shadows = Some(DiscRule::G7)),
        ("mars.heat", &|s| s.models.mars_heat = true),
        ("mars.position_m", &|s| s.sky.mars.as_mut().unwrap().centre_m.x += 1.0),
        ("mars.radius_m", &|s| s.sky.mars.as_mut().unwrap().radius_m += 1.0),
        ("mars.albedo", &|s| s.sky.mars.as_mut().unwrap().reflectance = constant(0.5)),
        ("mars.bond_albedo", &|s| s.sky.mars.as_mut().unwrap().bond_albedo += 0.01),
        ("mars.thermal_exitance_w_m2", &|s| s.sky.mars.as_mut().unwrap().thermal_exitance_w_m2 += 1.0),
        ("bodies", &|s| s.sky.bodies.clear()),
        ("bodies.\"moon\"", &|s| s.sky.bodies[0].name = "luna".into()),
        ("bodies.\"moon\".radius_m", &|s| s.sky.bodies[0].radius_m += 1.0),
        ("bodies.\"moon\".albedo", &|s| s.sky.bodies[0].reflectance = constant(0.5)),
        ("bodies.\"moon\".day_k", &|s| s.sky.bodies[0].day_night_k[0] += 1.0),
        ("mars.model", &|s| s.models.mars_light = MarsModel::Thesis),
        ("thermal.model", &|s| s.models.thermal = Thermal::Off),
        ("sensor.name", &|s| s.exposure.instrument = "other".into()),
        ("observer.position_m", &|s| s.exposure.camera.world_from_sensor.translation_m.z += 1.0),
        ("observer.h", &|s| s.exposure.camera.world_from_sensor.rotation *= DMat3::from_rotation_z(0.1)),
        ("sensor.samples", &|s| s.exposure.camera.samples += 1),
        ("sensor.lines", &|s| s.exposure.camera.lines += 1),
        ("sensor pitch", &|s| s.exposure.camera.pitch[1] *= 1.0 + 1e-9),
        ("sensor.boresight_px", &|s| s.exposure.camera.boresight_px[0] += 1e-6),
        ("sensor.bands", &|s| s.exposure.bands.truncate(1)),
        ("sensor.bands[1]", &|s| s.exposure.bands[1].centre_um = 2.1),
        ("sensor.bands[0]", &|s| s.exposure.bands[0].fwhm_um = Some(0.1)),
    ];
    for (name, change) in changes {
        let other = edited(&scene, change);
        for lines in [differ(&scene, &other), differ(&other, &scene)] {
            assert!(lines.iter().any(|line| line.starts_with(name)), "{name}: {lines:#?}");
        }
    }
    let with = |photometry: Photometry| edited(&scene, |scene| scene.surface.materials[1].photometry = photometry);
    assert!(differ(&with(hapke(0.0)), &with(hapke(0.1)))[0].starts_with("materials.\"b\".c4"));
    assert!(differ(&with(rpv(0.0)), &with(rpv(0.1)))[0].starts_with("materials.\"b\".h"));
    // What a table holds beyond its ends.
    let table = |extend| Spectrum::new(vec![0.5, 3.0], vec![0.1, 0.1], extend).unwrap();
    let with = |extend| edited(&scene, |scene| scene.surface.materials[0].reflectance = table(extend));
    let (a, b) = (with(Extend::Hold), with(Extend::Error));
    assert!(differ(&a, &b)[0].starts_with("materials.\"a\".reflectance beyond its ends"));
}

#[test]
fn what_means_the_same_is_no_difference() {
    let scratch = prepared();
    let scene = scratch.scene(SCENE);
    // Facets in another order, each from another corner, and other numbers of materials.
    let mut other = scene.clone().into_parts();
    other.surface.mesh.facets.reverse();
    other.surface.mesh.uv.reverse();
    other.surface.textures[0].corners.reverse();
    other.surface.mesh.facets[0].rotate_left(1);
    other.surface.mesh.uv[0].rotate_left(1);
    other.surface.textures[0].corners[0].rotate_left(1);
    other.surface.materials.reverse();
    other.surface.mesh.material = other.surface.mesh.material.iter().rev().map(|m| MaterialId(1 - m.0)).collect();
    other.surface.textures[0].material = MaterialId(1);
    for material in &mut other.surface.materials {
        material.mixture.iter_mut().for_each(|(part, _)| *part = 1 - *part);
    }
    let other = other.check().unwrap();
    assert_eq!(differ(&scene, &other), [""; 0]);
}

#[test]
fn one_spectrum_is_compared_with_one_whatever_the_files_are_called() {
    let scratch = Scratch::new();
    scratch.write("a.csv", "wavelength_um,reflectance\n0.5,0.1\n1.0,0.2\n");
    scratch.write("b.csv", "wavelength_um,reflectance\n0.5,0.1\n1.0,0.2\n");
    scratch.write("c.csv", "wavelength_um,reflectance\n0.5,0.1\n1.0,0.3\n");
    let [a, b, c] = ["a.csv", "b.csv", "c.csv"].map(|name| scratch.argument(name));
    let (code, out, _) = run(&["convert", "--diff", &a, &b]);
    assert_eq!((code, out.as_str()), (0, "the same in meaning\n"));
    let (code, out, _) = run(&["convert", "--diff", &a, &c]);
    assert!(code == 1 && out.contains("at 1 um") && out.contains("0.2, 0.3"), "{out}");
    // Of several, names tell which is which.
    scratch.write("two.csv", "wavelength_um,x,y\n0.5,0.1,0.2\n1.0,0.2,0.3\n");
    scratch.write("other.csv", "wavelength_um,x,z\n0.5,0.1,0.2\n1.0,0.2,0.3\n");
    let (code, out, _) = run(&["convert", "--diff", &scratch.argument("two.csv"), &scratch.argument("other.csv")]);
    assert!(code == 1 && out.contains("\"y\": is there, is not"), "{out}");
}
