//! Meshes that stand in many places: `instances` of a scene's mesh.

use mmxrt::error::Error;
use mmxrt::formats::scene_toml::{self, SceneFile};
use mmxrt::progress::unwatched;

use crate::scratch::Scratch;

/// A tetrahedron on three unit axes, of volume 1/6, in two materials.
const ROCK: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl dark\nf 1 3 2\nf 1 2 4\nusemtl light\nf 1 4 3\nf 2 3 4\n";

const SCENE: &str = "mmxrt_scene = 1\norigin_m = [0, 0, 11000]\n[[mesh]]\nfile = \"ground.obj\"\nmaterial = \"dark\"\n\
    [[mesh]]\nfile = \"rock.obj\"\ninstances = \"rocks.csv\"\n\
    [materials]\ndark = { reflectance = 0.1 }\nlight = { reflectance = 0.3 }\n\
    [sun]\ndirection = [0.6, 0, 0.8]\ndistance_au = 1.0\n[thermal]\nmodel = \"off\"\n\
    [observer]\nposition_m = [0, 0, 11070]\ntarget_m = [0, 0, 11000]\nup = [0, 1, 0]\n\
    [sensor]\nsamples = 24\nlines = 16\nfov_deg = 14\nbands = { centres_um = [1.0] }\n";

fn prepared(rocks: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("ground.obj", "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n");
    scratch.write("rock.obj", ROCK);
    scratch.write("rocks.csv", rocks);
    scratch
}

fn read(scratch: &Scratch, text: &str) -> Result<SceneFile, Error> {
    scene_toml::read(&scratch.write("scene.toml", text), &unwatched)
}

#[test]
fn rocks_stand_where_the_table_says() {
    // A half turn about z is (0, 0, 1, 0); the second mirrors x and is 2, 3 and 4 times as large along its own axes.
    let rocks =
        "# rocks\nx_m,y_m,z_m,scale_x,scale_y,scale_z,qx,qy,qz,qw\n1,2,3,1,1,1,0,0,1,0\n-4,5,0.5,-2,3,4,0,0,0,1\n";
    let scratch = prepared(rocks);
    let file = read(&scratch, SCENE).unwrap();
    let mesh = &file.scene.body.mesh;
    assert_eq!((mesh.vertices_m.len(), mesh.facets.len()), (4 + 8, 2 + 8));
    let expected = [
        [1.0, 2.0, 3.0],
        [0.0, 2.0, 3.0],
        [1.0, 1.0, 3.0],
        [1.0, 2.0, 4.0],
        [-4.0, 5.0, 0.5],
        [-6.0, 5.0, 0.5],
        [-4.0, 8.0, 0.5],
        [-4.0, 5.0, 4.5],
    ];
    for (vertex, expected) in mesh.vertices_m[4..].iter().zip(expected) {
        assert!((*vertex - glam::DVec3::from_array(expected)).length() < 1e-15, "{vertex} {expected:?}");
    }
    // Rocks of their volumes, 1/6 and 24/6, with their outer sides outside.
    let [copies] = &file.copies[..] else { panic!("{:?}", file.copies) };
    assert_eq!((copies.facets.clone(), copies.places.len()), (2..10, 2));
    let rocks = mesh.part(&[2, 3, 4, 5, 6, 7, 8, 9]);
    assert!((rocks.enclosed_m3().unwrap() - 25.0 / 6.0).abs() < 1e-13);
    let names: Vec<&str> =
        mesh.material[2..].iter().map(|m| file.scene.body.materials[m.0 as usize].name.as_str()).collect();
    assert_eq!(names, ["dark", "dark", "light", "light"].repeat(2));
    assert!(file.inputs.iter().any(|input| input.path.ends_with("rocks.csv")));
    // The model is as its file has it.
    assert_eq!(copies.model.vertices_m[1], glam::DVec3::X);
    assert_eq!(copies.model.copied(&copies.places).vertices_m, rocks.vertices_m);
}

#[test]
fn a_matrix_says_the_same_as_scale_and_turn() {
    // A quarter turn about z, times 2: x becomes y, y becomes -x.
    let root = 0.5_f64.sqrt();
    let turned = prepared(&format!("x_m,y_m,z_m,scale,qx,qy,qz,qw\n1,2,3,2,0,0,{root},{root}\n"));
    let matrix = prepared("zz,xx,xy,xz,yx,yy,yz,zx,zy,x_m,y_m,z_m\n2,0,-2,0,2,0,0,0,0,1,2,3\n");
    let [a, b] = [turned, matrix].map(|scratch| read(&scratch, SCENE).unwrap().scene.body.mesh.vertices_m.clone());
    assert_eq!(b[5].to_array(), [1.0, 4.0, 3.0]);
    assert!(a.iter().zip(&b).all(|(a, b)| (*a - *b).length() < 1e-15), "{a:?} {b:?}");
}

#[test]
fn places_are_in_the_coordinates_that_the_mesh_has() {
    // The file is in km with y up, and stands in the site's frame: at this origin x is east (+y of the body), y north (-x), z up.
    let scratch = prepared("x_m,y_m,z_m\n10,20,30\n");
    let text = SCENE.replace("\"rocks.csv\"", "\"rocks.csv\"\nunit_m = 1000\nup = \"y\"\npose = \"radial\"");
    let vertices = read(&scratch, &text).unwrap().scene.body.mesh.vertices_m.clone();
    // v 0 0 1: to the south by 1000 m.
    for (vertex, site) in
        vertices[4..].iter().zip([[10., 20., 30.], [1010., 20., 30.], [10., 20., 1030.], [10., -980., 30.]])
    {
        let [east, north, up] = site;
        assert!((*vertex - glam::DVec3::new(-north, east, up)).length() < 1e-12, "{vertex} {site:?}");
    }
}

#[test]
fn tables_that_say_nothing_are_refused_with_all_their_rows() {
    let cases = [
        ("", "columns x_m, y_m, z_m are missing"),
        ("x_m,y_m,z_m\n", "has no rows"),
        ("x_m,y_m\n1,2\n", "columns x_m, y_m, z_m belong together"),
        ("x_m,y_m,z_m,size\n1,2,3,4\n", "column `size` is not known"),
        ("x_m,y_m,z_m,x_m\n1,2,3,4\n", "column `x_m` is there twice"),
        ("x_m,y_m,z_m,scale,scale_x,scale_y,scale_z\n1,2,3,4,1,1,1\n", "give either `scale` or"),
        ("x_m,y_m,z_m,scale,xx,xy,xz,yx,yy,yz,zx,zy,zz\n1,2,3,4,1,0,0,0,1,0,0,0,1\n", "leave scale and q out"),
        ("x_m,y_m,z_m,qx,qy,qz,qw\n1,2,3,0,0,0,2\n", "have length 2"),
        ("x_m,y_m,z_m,scale\n1,2,3,0\n", "nothing is left of it"),
        ("x_m,y_m,z_m,scale\n1,2,3,1e200\n", "nothing is left of it"),
        ("x_m,y_m,z_m\n1,2,nan\n", "z_m is not a finite number: `nan`"),
        ("x_m,y_m,z_m\n1,2\n", "2 cells for 3 columns"),
        ("x_m,y_m,z_m\n1,2,3,4\n", "4 cells for 3 columns"),
    ];
    for (rocks, message) in cases {
        let told = read(&prepared(rocks), SCENE).unwrap_err().to_string();
        assert!(told.contains(message) && told.contains("rocks.csv"), "{rocks}: {told}");
    }
    let told = read(&prepared("x_m,y_m,z_m\n1,2,x\n1,2,3\ny,2,3\n"), SCENE).unwrap_err().to_string();
    assert!(told.contains("rocks.csv:2") && told.contains("rocks.csv:4"), "{told}");
    // More facets than there may be: 4 of each of 40 million rocks.
    let told = read(&prepared("x_m,y_m,z_m\n1,2,3\n"), &SCENE.replace("rocks.csv", "nowhere.csv")).unwrap_err();
    assert!(told.to_string().contains("nowhere.csv"), "{told}");
}

#[test]
fn a_recipe_may_stand_in_several_places_too() {
    let scratch = prepared("x_m,y_m,z_m\n0,0,0\n5000,0,0\n");
    let text = SCENE.replace("file = \"rock.obj\"", "recipe = { version = 1, seed = 1, facets = 1000 }");
    let text = text
        .replace("[materials]", "[materials]\nphobos_blue = { reflectance = 0.1 }\nphobos_red = { reflectance = 0.1 }");
    let file = read(&scratch, &text).unwrap();
    let [copies] = &file.copies[..] else { panic!() };
    assert_eq!(copies.facets.len(), 2 * copies.model.facets.len());
}

/// The corners of all facets in a fixed order, and their materials' names.
fn triangles(scene: &mmxrt::scene::Scene) -> Vec<([f64; 9], String)> {
    let body = &scene.body;
    let corners = |f: usize| {
        let corners = body.mesh.facet(f).corners_m.map(|p| p.to_array());
        // From the corner that comes first, as the way round is what counts.
        let least = (0..3).min_by(|a, b| corners[*a].partial_cmp(&corners[*b]).unwrap()).unwrap();
        let mut flat = [0.0; 9];
        (0..3).for_each(|k| flat[3 * k..3 * k + 3].copy_from_slice(&corners[(least + k) % 3]));
        flat
    };
    let name = |f: usize| body.materials[usize::from(body.mesh.material[f].0)].name.clone();
    let mut all: Vec<_> = (0..body.mesh.facets.len()).map(|f| (corners(f), name(f))).collect();
    let rounded = |of: &[f64; 9]| of.map(|x| (x * 1e4).round() as i64);
    all.sort_by_key(|(corners, name)| (rounded(corners), name.clone()));
    all
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn rocks_go_to_dart_as_a_field_and_come_back() {
    // Turned about an oblique axis and stretched; mirrored; sheared, so that it is part of the surface; beyond the ground on one side, and so too.
    let rocks = "x_m,y_m,z_m,xx,xy,xz,yx,yy,yz,zx,zy,zz\n\
        1,2,3,0,-2,0,1,0,0,0,0,3\n\
        -4,5,0.5,-1.2,0,0,0,0.6,-0.8,0,0.8,0.6\n\
        3,-3,1,1,0.1,0,0,1,0,0,0,1\n\
        12,-3,1,-4,0,0,0,-1,0,0,0,1\n";
    // The last reaches back to x = 8 of a ground that ends at 9: the scene is as large as what it holds, so that none is outside.
    let scratch = prepared(rocks);
    let file = read(&scratch, SCENE).unwrap();
    let out = scratch.argument("dart");
    let (code, said, err) = crate::cli::run(&["convert", &scratch.argument("scene.toml"), &out, "--cell-m", "0.5"]);
    assert_eq!(code, 0, "{err}");
    assert!(said.contains("3 instances are in 1 object fields") && said.contains("1 instances are sheared"), "{said}");
    let text = std::fs::read_to_string(scratch.join("dart/input/field_1.txt")).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!((rows.len(), rows[0]), (4, "complete transformation"));
    // Scales along the rock's own axes, x of which a mirror turns round: columns of length 1, 2 and 3.
    assert!(rows[1].contains(" 1 2 3 "), "{text}");
    assert!(rows[2].split(' ').nth(4).unwrap().starts_with("-1.2"), "{text}");
    let objects = std::fs::read_to_string(scratch.join("dart/input/object_3d.xml")).unwrap();
    assert!(objects.contains("fieldDescriptionFileName=\"field_1.txt\""), "{objects}");
    let model = std::fs::read_to_string(scratch.join("dart/input/obj/field_1.obj")).unwrap();
    assert_eq!(model.lines().filter(|line| line.starts_with("v ")).count(), 4, "{model}");
    // What is written is by our own schema, and lacks nothing.
    let schema = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas/dart/object_3d.xsd");
    let valid = std::process::Command::new("xmllint")
        .args(["--noout", "--nonet", "--schema"])
        .args([schema, scratch.join("dart/input/object_3d.xml")])
        .output();
    match valid {
        Ok(valid) => assert!(valid.status.success(), "{}", String::from_utf8_lossy(&valid.stderr)),
        Err(_) => println!("SKIPPED: xmllint is not installed"),
    }
    let (code, said, _) = crate::cli::run(&["convert", "--check", &out]);
    assert_eq!(code, 0, "{said}");
    let (code, _, err) = crate::cli::run(&["convert", &out, &scratch.argument("back/scene.toml")]);
    assert_eq!(code, 0, "{err}");
    let back = scene_toml::read(&scratch.join("back/scene.toml"), &unwatched).unwrap().scene;
    let (ours, theirs) = (triangles(&file.scene), triangles(&back));
    assert_eq!(ours.len(), theirs.len());
    for ((a, of_a), (b, of_b)) in ours.iter().zip(&theirs) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12) && of_a == of_b, "{a:?} {of_a} {b:?} {of_b}");
    }
    // Of 5.11 fields are not known: all is surface there.
    let newer = scratch.argument("newer");
    let arguments = ["convert", &scratch.argument("scene.toml"), &newer, "--dart-version", "5.11.0", "--cell-m", "0.5"];
    let (code, said, err) = crate::cli::run(&arguments);
    assert!(code == 0 && !said.contains("object field"), "{said}{err}");
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn rocks_alone_are_the_surface() {
    let scratch = prepared("x_m,y_m,z_m\n1,2,3\n4,5,6\n");
    let ground = "[[mesh]]\nfile = \"ground.obj\"\nmaterial = \"dark\"\n";
    scratch.write("scene.toml", SCENE.replace(ground, ""));
    let (code, said, err) = crate::cli::run(&["convert", &scratch.argument("scene.toml"), &scratch.argument("dart")]);
    assert!(code == 0 && !said.contains("object field"), "{said}{err}");
}
