//! Object fields of DART: objects that stand where the lines of a text say, ours and those of other writers.

use glam::DVec3;
use mmxrt::formats::dart::{self, ReadOptions};
use mmxrt::formats::scene_toml;
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;

use crate::cli::run;
use crate::dart_sim::{Sim, told};
use crate::dart_write::tetrahedron;
use crate::scratch::{Scratch, is_heavy};
use crate::shapes::Random;

/// A model of an OBJ file, of the first material, or of two groups of the first and the third.
fn model(file: &str, groups: bool, edits: &[(&str, &str)]) -> String {
    let link = |name: &str, index: u32| {
        format!(
            "<OpticalPropertyLink indexFctPhase=\"{index}\" ident=\"{name}\" type=\"0\"/><ThermalPropertyLink \
             indexTemperature=\"{index}\" idTemperature=\"T_{name}\"/>"
        )
    };
    let group = |number: u32, name: &str, link: &str| {
        format!(
            "<Group num=\"{number}\" name=\"{name}\" groupDEMMode=\"0\" hasElements=\"0\" hidden=\"0\" isLAICalc=\"0\">\
             <GroupOpticalProperties doubleFace=\"0\" sameOPGroup=\"1\">{link}</GroupOpticalProperties>\
             <GroupTypeProperties sameOTGroup=\"1\"><ObjectTypeLink indexOT=\"101\" identOType=\"Default_Object\"/></GroupTypeProperties></Group>"
        )
    };
    let (of_object, of_groups) = match groups {
        false => (link("east", 0), String::new()),
        true => (
            String::new(),
            format!("<Groups>{}{}</Groups>", group(1, "a", &link("east", 0)), group(2, "b", &link("south west", 2))),
        ),
    };
    let text = format!(
        "<Object name=\"rock\" num=\"0\" file_src=\"{file}\" hasGroups=\"{}\" objectDEMMode=\"2\" repeatedOnBorder=\"0\" hidden=\"0\" \
         isDisplayed=\"1\" objectColor=\"1 2 3\"><GeometricProperties><PositionProperties xpos=\"0\" ypos=\"0\" zpos=\"7\"/>\
         <Dimension3D xdim=\"1\" ydim=\"1\" zdim=\"1\"/><ScaleProperties xscale=\"3\" yscale=\"3\" zscale=\"3\" xScaleDeviation=\"0\" \
         yScaleDeviation=\"0\" zScaleDeviation=\"0\"/><RotationProperties xrot=\"0\" yrot=\"0\" zrot=\"0\" xRotDeviation=\"0\" \
         yRotDeviation=\"0\" zRotDeviation=\"0\"/></GeometricProperties><ObjectOpticalProperties sameOPObject=\"0\" isLAICalc=\"0\" \
         isSingleGlobalLai=\"0\" doubleFace=\"0\">{of_object}</ObjectOpticalProperties><ObjectTypeProperties sameOTObject=\"0\"/>{of_groups}</Object>",
        u32::from(groups)
    );
    edits.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from} {text}");
        text.replace(from, to)
    })
}

/// A unit tetrahedron on DART's axes, its corner at the origin, in two groups of two facets; outside counter-clockwise. DART reads
/// `v a b c` as x = c, y = a, z = b.
const ROCK: &str = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\ng a\nf 1 3 2\nf 1 2 4\ng b\nf 1 4 3\nf 2 3 4\n";

/// Somebody's simulation with a field of these models, whose places are in `rocks.txt`.
fn field(models: &str, text: impl AsRef<[u8]>) -> Sim {
    let sim = Sim::bare(&tetrahedron());
    let field = format!(
        "<ObjectFields><Field name=\"rocks\" fieldDescriptionFileName=\"rocks.txt\" showObjectPositions=\"0\"><ModelList>{models}\
         </ModelList></Field></ObjectFields>"
    );
    sim.edit("input/object_3d.xml", "<ObjectFields/>", &field);
    std::fs::write(sim.folder.join("input/rock.obj"), ROCK).unwrap();
    std::fs::write(sim.folder.join("input/rocks.txt"), text).unwrap();
    sim
}

/// Corners of the field's facets in DART's frame; the scene's own object has four.
fn corners_m(sim: &Sim) -> Vec<[DVec3; 3]> {
    let options = ReadOptions::default();
    let (simulation, ..) = dart::read(&sim.folder, &options).unwrap();
    let [x, y] = simulation.maket.size_m;
    let (scene, _) = sim.read();
    let mesh = &scene.body.mesh;
    // From East, North and up of the scene's middle.
    let in_dart = |v: DVec3| DVec3::new(0.5 * x - v.y, 0.5 * y + v.x, v.z);
    (4..mesh.facets.len()).map(|f| mesh.facet(f).corners_m.map(in_dart)).collect()
}

fn rock() -> String {
    model("rock.obj", true, &[])
}

/// Where the model's corner at the origin, and its corners on x, y and z, are.
fn assert_stands(corners_m: &[[DVec3; 3]], expected: [[f64; 3]; 4]) {
    let [o, x, y, z] = expected.map(DVec3::from_array);
    for (facet, expected) in corners_m.iter().zip([[o, y, x], [o, x, z], [o, z, y], [x, y, z]]) {
        for (is, wanted) in facet.iter().zip(expected) {
            assert!((*is - wanted).length() < 1e-12, "{facet:?} {expected:?}");
        }
    }
}

#[test]
fn an_object_stands_where_its_line_says() {
    // Scaled along DART's axes, moved; then turned by a quarter about z; tipped over by a quarter, z towards x; and both.
    let text = "complete transformation\n0 2 3 1 2 3 4 0 0 0\n0 2 3 1 2 3 4 90 0 0\n0 2 3 1 1 1 1 0 90 0\n0 2 3 1 1 1 1 0 90 90\n";
    let sim = field(&rock(), text);
    let corners_m = corners_m(&sim);
    assert_eq!(corners_m.len(), 16);
    assert_stands(&corners_m, [[2., 3., 1.], [4., 3., 1.], [2., 6., 1.], [2., 3., 5.]]);
    // x to y, y to -x.
    assert_stands(&corners_m[4..], [[2., 3., 1.], [2., 5., 1.], [-1., 3., 1.], [2., 3., 5.]]);
    assert_stands(&corners_m[8..], [[2., 3., 1.], [2., 3., 0.], [2., 4., 1.], [3., 3., 1.]]);
    assert_stands(&corners_m[12..], [[2., 3., 1.], [2., 3., 0.], [1., 3., 1.], [2., 4., 1.]]);
    let (scene, report) = sim.read();
    assert!(told(&report, "rotations about more than the vertical"), "{report:#?}");
    let names: Vec<&str> =
        scene.body.mesh.material[4..8].iter().map(|m| scene.body.materials[usize::from(m.0)].name.as_str()).collect();
    assert_eq!(names, ["east", "east", "south west", "south west"]);
    // A turn about the vertical needs no inference.
    let (_, report) = field(&rock(), "complete transformation\n0 2 3 1 1 1 1 30 0 40\n").read();
    assert!(!told(&report, "rotations"), "{report:#?}");
}

#[test]
fn a_mirrored_object_keeps_its_outside_outside() {
    for scale in ["-2 3 4", "2 3 -4", "-2 -3 -4", "-2 -3 4"] {
        let (scene, _) = field(&rock(), format!("complete transformation\n0 3 3 5 {scale} 0 0 0\n")).read();
        let volume_m3 = scene.body.mesh.part(&[4, 5, 6, 7]).enclosed_m3().unwrap();
        // 2 x 3 x 4 / 6.
        assert!((volume_m3 - 4.0).abs() < 1e-12, "{scale}: {volume_m3}");
    }
}

#[test]
fn a_model_without_groups_is_of_one_material() {
    let (scene, _) = field(&model("rock.obj", false, &[]), "complete transformation\n0 2 3 1 1 1 1 0 0 0\n").read();
    let of = |f: usize| scene.body.materials[usize::from(scene.body.mesh.material[f].0)].name.as_str();
    assert_eq!([4, 5, 6, 7].map(of), ["east"; 4]);
    // Lines name models by their place in the list.
    let two = rock() + &model("rock.obj", false, &[]);
    let (scene, _) =
        field(&two, "complete transformation\n1 2 3 1 1 1 1 0 0 0\n0 3 3 1 1 1 1 0 0 0\n1 1 1 1 1 1 1 0 0 0\n").read();
    let south_west = scene.body.materials.iter().position(|m| m.name == "south west").unwrap();
    assert_eq!(scene.body.mesh.material[4..].iter().filter(|m| usize::from(m.0) == south_west).count(), 2);
}

#[test]
fn texts_of_other_writers_say_the_same() {
    let plain = corners_m(&field(&rock(), "complete transformation\n0 2 3 1 2 3 4 0 0 30\n0 1 1 0.5 1 1 1 0 0 0\n"));
    let texts = [
        "complete transformation\r\n0 2 3 1 2 3 4 0 0 30\r\n0 1 1 .5 1 1 1 0 0 0\r\n",
        "Complete\tTransformation  // all of it\n\n0\t2\t3\t1\t2\t3\t4\t0\t0\t30\n  0 1.0 1.00 0.5 1 1 1 0 0 0   ",
        "/* rocks\n 0 9 9 9 9 9 9 9 9 9 */ complete transformation\n0 2 3 /* x y */ 1 2 3 4 0 0 30 // é ü\n// 0 5 5 5\n0 1 1 0.5 1 1 1 0 0 0",
        "\u{feff}complete transformation\n0 +2 3e0 1 2 3 4 0 0 30\n0 1 1 0.5 1 1 1 0 0 0\n/* open",
        "complete transformation\r0 2 3 1 2 3 4 0 0 30\r0 1 1 0.5 1 1 1 0 0 0\r",
    ];
    for text in texts {
        let sim = field(&rock(), text);
        assert_eq!(corners_m(&sim), plain, "{text:?}");
        let (code, out) = sim.check();
        assert_eq!((code, out.contains("a number with an exponent")), (0, text.contains("3e0")), "{text:?} {out}");
    }
}

#[test]
fn places_without_a_transformation_are_told_to_be_as_the_model() {
    // z and scale are the model's, 7 m and 3.
    let sim = field(&rock(), "0 2 3\n");
    assert_stands(&corners_m(&sim), [[2., 3., 7.], [5., 3., 7.], [2., 6., 7.], [2., 3., 10.]]);
    let (_, report) = sim.read();
    assert!(told(&report, "places without a transformation"), "{report:#?}");
}

#[test]
fn damaged_texts_are_refused_with_all_that_is_wrong() {
    let complete = "complete transformation\n";
    let cases: &[(&str, &[&str])] = &[
        (
            "0 1 1 1 1 1 1 0 0 0\n1 1 1 1 1 1 1 0 0 0\n",
            &["rocks.txt:3:1: model 1: the field has 1 models, counted from 0"],
        ),
        ("-1 1 1 1 1 1 1 0 0 0\n", &["rocks.txt:2:1: model -1"]),
        ("0.5 1 1 1 1 1 1 0 0 0\n", &["rocks.txt:2:1: model 0.5"]),
        ("4294967296 1 1 1 1 1 1 0 0 0\n", &["rocks.txt:2:1: model 4294967296"]),
        (
            "0 1 1 1 0 1 1 0 0 0\n0 1 1 1 1 1 -0.0 0 0 0\n",
            &["rocks.txt:2:1: a scale of 0", "rocks.txt:3:1: a scale of 0"],
        ),
        ("0 1 nan 1 1 1 1 0 0 0\n0 1 inf 1 1 1 1 0 0 0\n", &["rocks.txt:2:1: a line of", "rocks.txt:3:1: a line of"]),
        ("0 1 1\n", &["rocks.txt:2:1: a line of `index x y z sx sy sz xrot yrot zrot`"]),
        ("0,1,1,1,1,1,1,0,0,0\n", &["rocks.txt:2:1"]),
        ("0 1 1 1 1 1 1 0 0 0 7\n", &["rocks.txt:2:1"]),
        ("complete transformation\n", &["rocks.txt:2:1"]),
    ];
    for (text, messages) in cases {
        let sim = field(&rock(), complete.to_owned() + text);
        let error = sim.error();
        assert!(messages.iter().all(|message| error.contains(message)), "{text}: {error}");
        let (code, out) = sim.check();
        assert!(code == 1 && messages.iter().all(|message| out.contains(message)), "{text}: {out}");
    }
    for text in [&b"\x00\x01\x02"[..], b"complete transformation\n0 \xff 1 1 1 1 1 0 0 0\n"] {
        assert!(field(&rock(), text).error().contains("rocks.txt"));
    }
    // What is so small that nothing is to be seen of it stays where it is.
    let small = corners_m(&field(&rock(), "complete transformation\n0 1 1 1 1e-300 1e-300 1e-300 0 0 0\n"));
    assert!(small.len() == 4 && small.as_flattened().iter().all(|v| (*v - DVec3::ONE).length() < 1e-12));
    assert!(field("", "0 1 1\n").error().contains("model 0: the field has 0 models"));
    // Of the model.
    let cases = [
        (model("rock.obj", true, &[("num=\"2\"", "num=\"5\"")]), "object_3d.xml:", "the OBJ has 2 groups"),
        (model("none.obj", true, &[]), "object_3d.xml:", "none.obj"),
        (model("../../x.obj", true, &[]), "object_3d.xml:", "leads out of"),
        (model("rock.obj", true, &[("xscale=\"3\"", "xscale=\"0\"")]), "object_3d.xml:", "a scale of 0"),
        (model("rock.obj", true, &[("indexFctPhase=\"2\"", "indexFctPhase=\"77\"")]), "object_3d.xml:", "entry 77"),
    ];
    for (model, place, message) in cases {
        let sim = field(&model, "complete transformation\n0 1 1 1 1 1 1 0 0 0\n");
        let error = sim.error();
        assert!(error.contains(place) && error.contains(message), "{error}");
        assert_eq!(sim.check().0, 1, "{message}");
    }
}

#[test]
fn a_field_of_nothing_is_told() {
    for text in ["", "\n\n", "complete transformation", "// nothing\n/* nor here */"] {
        let sim = field(&rock(), text);
        let (scene, report) = sim.read();
        assert!(scene.body.mesh.facets.len() == 4 && told(&report, "has no places"), "{text}: {report:#?}");
    }
    let sim = field(&rock(), "0 1 1\n");
    std::fs::remove_file(sim.folder.join("input/rocks.txt")).unwrap();
    let (scene, report) = sim.read();
    assert!(scene.body.mesh.facets.len() == 4 && told(&report, "whose text `rocks.txt` is not in"), "{report:#?}");
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("`rocks.txt` is not in the input folder"), "{out}");
    // A hidden model is told once.
    let sim =
        field(&model("rock.obj", true, &[("hidden=\"0\" isDisplayed", "hidden=\"1\" isDisplayed")]), "0 1 1\n0 2 2\n");
    let (scene, report) = sim.read();
    let hidden = report.notes.iter().filter(|note| note.message.contains("is hidden")).count();
    assert_eq!((scene.body.mesh.facets.len(), hidden), (4, 1));
}

#[test]
fn what_stands_outside_is_left_out_and_a_check_tells() {
    let sim = field(
        &rock(),
        "complete transformation\n0 2 3 1 1 1 1 0 0 0\n0 -0.1 3 1 1 1 1 0 0 0\n0 2 1000 1 1 1 1 0 0 0\n0 2 3 1 99 1 1 0 0 0\n",
    );
    let (scene, report) = sim.read();
    assert!(scene.body.mesh.facets.len() == 4 + 8 && told(&report, "2 objects of the field \"rocks\""), "{report:#?}");
    let (code, out) = sim.check();
    assert!(code == 0 && out.contains("2 of 4 places lie outside of the scene"), "{out}");
    assert!(out.contains("`rock` reaches beyond the scene at 1 of its places"), "{out}");
    // On the ground, by DART's default, whatever its z; what lies there already is not moved.
    let on_ground = model("rock.obj", true, &[("objectDEMMode=\"2\"", "objectDEMMode=\"0\"")]);
    let sim = field(&on_ground, "complete transformation\n0 2 3 5 1 1 1 0 0 0\n0 2 3 0 1 1 1 0 0 0\n");
    assert!(corners_m(&sim).as_flattened().iter().all(|v| (0.0..=1.0).contains(&v.z)));
    let (code, out) = sim.check();
    assert!(code == 0 && out.contains("`rock` is dropped to the ground at 1 of its places"), "{out}");
    // A file inside out, which every object is then.
    let sim = field(&model("inverse.obj", true, &[]), "complete transformation\n0 2 3 1 1 1 1 0 0 0\n");
    let inverse = ROCK
        .replace("f 1 3 2", "f 1 2 3")
        .replace("f 1 2 4", "f 1 4 2")
        .replace("f 1 4 3", "f 1 3 4")
        .replace("f 2 3 4", "f 2 4 3");
    std::fs::write(sim.folder.join("input/inverse.obj"), inverse).unwrap();
    let (code, out) = sim.check();
    assert!(code == 1 && out.contains("`rock` is inside out"), "{out}");
}

#[test]
fn places_that_differ_are_differences_and_not_all_of_them_lines() {
    let rows = |x: f64| -> String {
        let row = |i: u32| format!("0 {} 3 1 1 1 1 0 0 0\n", x + 0.001 * f64::from(i));
        "complete transformation\n".to_owned() + &(0..500).map(row).collect::<String>()
    };
    let (a, b, c) = (field(&rock(), rows(1.0)), field(&rock(), rows(1.25)), field(&rock(), rows(1.0)));
    let diff = |a: &Sim, b: &Sim| run(&["convert", "--diff", a.folder.to_str().unwrap(), b.folder.to_str().unwrap()]);
    assert_eq!(diff(&a, &c).1, "the same in meaning\n");
    let (code, out, _) = diff(&a, &b);
    assert!(
        code == 1 && out.contains("place[0] position, m") && out.contains("and 490 more differences of places"),
        "{out}"
    );
    assert!(out.lines().count() < 60, "{out}");
}

#[test]
fn many_places_take_one_pass_and_one_note() {
    let count = if is_heavy() { 1_000_000 } else { 50_000 };
    let row = |i: u32| format!("0 {} {} 1 0.01 0.01 0.01 10 20 30\n", 1.0 + 1e-6 * f64::from(i), 2.0);
    let text = "complete transformation\n".to_owned() + &(0..count).map(row).collect::<String>();
    let sim = field(&model("rock.obj", true, &[("objectDEMMode=\"2\"", "objectDEMMode=\"3\"")]), text);
    let start = std::time::Instant::now();
    let (scene, report) = sim.read();
    println!("{count} places: {:.2} s", start.elapsed().as_secs_f64());
    assert_eq!(scene.body.mesh.facets.len(), 4 + 4 * count as usize);
    assert!(report.notes.len() < 30, "{} notes", report.notes.len());
    assert!(sim.scratch.path().exists());
}

/// The corners of all facets and their materials, in an order that does not depend on that of the facets.
fn facets(scene: &Scene) -> Vec<(String, [f64; 9])> {
    let body = &scene.body;
    let of = |f: usize| {
        let corners = body.mesh.facet(f).corners_m.map(|v| v.to_array());
        // The way round counts, not where it begins.
        let first = (0..3).min_by(|a, b| corners[*a].partial_cmp(&corners[*b]).unwrap()).unwrap();
        let turned = [0, 1, 2].map(|k| corners[(first + k) % 3]);
        let name = body.materials[usize::from(body.mesh.material[f].0)].name.clone();
        (name, std::array::from_fn(|i| turned[i / 3][i % 3]))
    };
    let mut all: Vec<_> = (0..body.mesh.facets.len()).map(of).collect();
    let rounded = |(name, corners): &(String, [f64; 9])| (name.clone(), corners.map(|x| (x * 1e5).round() as i64));
    all.sort_by_key(rounded);
    all
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn rocks_at_random_come_back_to_the_last_digits() {
    let mut random = Random(11);
    for origin_m in ["[0, 0, 11000]", "[7000, -6000, 3000]", "[0, 9000, 0]"] {
        let scratch = Scratch::new();
        let mut table = |rows: u32| {
            let mut text = String::from("x_m,y_m,z_m,scale_x,scale_y,scale_z,qx,qy,qz,qw\n");
            for _ in 0..rows {
                let place = [8.0, 8.0, 1.0].map(|most| most * (2.0 * random.share() - 1.0));
                let scale = [0.3, 0.5, 0.7]
                    .map(|most| most * (0.1 + random.share()) * if random.share() < 0.3 { -1.0 } else { 1.0 });
                let q = [0; 4].map(|_| 2.0 * random.share() - 1.0);
                let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
                let row: Vec<String> =
                    place.into_iter().chain(scale).chain(q.map(|x| x / length)).map(|x| x.to_string()).collect();
                text += &(row.join(",") + "\n");
            }
            text
        };
        scratch.write("stones.csv", table(40));
        scratch.write("pebbles.csv", table(60));
        scratch.write("ground.obj", "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n");
        scratch.write(
            "rock.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl dark\nf 1 3 2\nf 1 2 4\nusemtl light\nf 1 4 3\nf 2 3 4\n",
        );
        scratch.write(
            "pebble.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nusemtl light\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
        );
        let text = format!(
            "mmxrt_scene = 1\norigin_m = {origin_m}\n[[mesh]]\nfile = \"ground.obj\"\nmaterial = \"dark\"\npose = \"radial\"\n\
             [[mesh]]\nfile = \"rock.obj\"\ninstances = \"stones.csv\"\npose = \"radial\"\n\
             [[mesh]]\nfile = \"pebble.obj\"\ninstances = \"pebbles.csv\"\npose = \"radial\"\n\
             [materials]\ndark = {{ reflectance = 0.1 }}\nlight = {{ reflectance = 0.3 }}\n\
             [sun]\ndirection = {origin_m}\ndistance_au = 1.0\n[thermal]\nmodel = \"off\"\n\
             [observer]\nposition_m = [20000, 20000, 20000]\ntarget_m = {origin_m}\nup = [0, 0, 1]\n\
             [sensor]\nsamples = 4\nlines = 4\nfov_deg = 1\nbands = {{ centres_um = [1.0] }}\n"
        );
        let scene = scene_toml::read(&scratch.write("scene.toml", text), &unwatched).unwrap().scene;
        let dart = scratch.argument("dart");
        let (code, out, err) = run(&["convert", &scratch.argument("scene.toml"), &dart, "--cell-m", "0.5"]);
        assert!(code == 0 && out.contains("100 instances are in 2 object fields"), "{out}{err}");
        let (code, out, _) = run(&["convert", "--check", &dart]);
        assert_eq!(code, 0, "{out}");
        let (code, _, err) = run(&["convert", &dart, &scratch.argument("back/scene.toml")]);
        assert_eq!(code, 0, "{err}");
        let back = scene_toml::read(&scratch.join("back/scene.toml"), &unwatched).unwrap().scene;
        let (was, is) = (facets(&scene), facets(&back));
        assert_eq!(was.len(), is.len());
        let mut worst_m = 0.0_f64;
        for ((name, a), (of_b, b)) in was.iter().zip(&is) {
            assert_eq!(name, of_b);
            worst_m = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(worst_m, f64::max);
        }
        assert!(worst_m < 1e-12, "{worst_m:e}");
    }
}
