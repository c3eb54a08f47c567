//! OBJ and MTL files as they are found: names, encodings, files that are not there, units, what they say that has no place, and what they
//! probably do not mean.

use mmxrt::formats::obj;
use mmxrt::formats::scene_toml::{self, SceneFile};
use mmxrt::progress::unwatched;

use crate::cli::run;
use crate::scratch::Scratch;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Each note of an OBJ file, as text.
fn told(scratch: &Scratch, name: &str) -> Vec<String> {
    let file = obj::read(&scratch.join(name)).unwrap_or_else(|e| panic!("{e}"));
    let all = [file.report.notes, file.material_doubts, file.doubts].concat();
    all.iter().map(|n| format!("{} {}: {}", n.fate, n.at.line.unwrap_or(0), n.message)).collect()
}

fn told_of(text: &str) -> Vec<String> {
    let scratch = Scratch::new();
    scratch.write("a.obj", text);
    told(&scratch, "a.obj")
}

/// A scene of one OBJ file, seen from above.
fn scene(mesh: &str, materials: &str, height_m: f64, ifov_mrad: f64) -> String {
    format!(
        "mmxrt_scene = 1\norigin_m = [0, 0, 0]\n[[mesh]]\n{mesh}\n[materials]\n{materials}\n[sun]\ndirection = [0, 0, 1]\ndistance_au = 1.5\n\
         [observer]\nposition_m = [0, 0, {height_m}]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
         [sensor]\nsamples = 8\nlines = 8\nifov_mrad = {ifov_mrad}\nbands = {{ centres_um = [1.0] }}\n"
    )
}

fn read(scratch: &Scratch, text: &str) -> Result<SceneFile, String> {
    let path = scratch.write("scene.toml", text);
    scene_toml::read(&path, &unwatched).map_err(|e| e.to_string())
}

#[test]
fn colours_weights_and_smooth_shading_are_told() {
    let face = "usemtl a\nf 1 2 3 4\n";
    assert_eq!(told_of(&format!("{SQUARE}{face}")), [""; 0]);
    // A weight of 1, and a comment, are nothing.
    assert_eq!(told_of(&format!("v 0 0 0 1\nv 1 0 0 1.0 # 0.5\nv 1 1 0\t1e0\nv 0 1 0\r\n{face}")), [""; 0]);
    let lines = told_of(&format!("v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0 255 0 0\nv 0 1 0 1 1 1 1\n{face}"));
    assert_eq!(lines, ["Dropped 2: colours of 3 vertices: a facet has one material"]);
    let lines = told_of(&format!("v 0 0 0 2\nv 1 0 0\nv 1 1 0 0.5\nv 0 1 0\n{face}"));
    assert_eq!(lines.len(), 1);
    assert!(lines[0].starts_with("Dropped 1: a fourth coordinate (weight) other than 1, of 2 vertices"), "{lines:?}");
    // Normals that are the same at all corners are those of a flat face.
    let normals = "vn 0 0 1\nvn 0 0 2\nvn 0.6 0 0.8\nusemtl a\n";
    assert_eq!(told_of(&format!("{SQUARE}{normals}f 1//1 2//2 3//1 4//-3\n")), [""; 0]);
    let lines = told_of(&format!("{SQUARE}{normals}f 1//1 2//2 3//3\nf 1//1 3//1 4//3\n"));
    assert_eq!(lines, ["Dropped 9: smooth shading (`vn`): facets are flat"]);
    // With --strict nothing of that kind is written.
    let scratch = Scratch::new();
    scratch.write("a.obj", format!("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\n{face}"));
    let (code, out, _) = run(&["convert", "--strict", &scratch.argument("a.obj"), &scratch.argument("out/a.toml")]);
    assert!(code == 3 && out.contains("Dropped") && out.contains("colours of 2 vertices"), "{out}");
}

#[test]
fn what_materials_look_like_beyond_a_colour_is_told() {
    for (statement, part) in [
        ("map_Kd g.png", "textures"),
        ("map_kd g.png", "textures"),
        ("bump -bm 0.5 b.png", "textures"),
        ("disp d.png", "a displacement map"),
        ("Ke 5 5 5", "light of its own"),
        ("d 0.3", "transparency"),
        ("d -halo 0.3", "transparency"),
        ("Tr 0.7", "transparency"),
        ("Tf 0.5 1 1", "transparency"),
        ("Pm 1.0", "of metal"),
        ("Kd spectral grey.rfl", "a colour in another form"),
        ("Ke 0 0 0\nd 1.0\nTr 0\nPm 0\nTf 1 1 1\nKa 1 1 1\nKs 0.5 0.5 0.5\nNs 250\nNi 1.5\nillum 2", ""),
    ] {
        let scratch = Scratch::new();
        scratch.write("a.obj", format!("mtllib a.mtl\n{SQUARE}usemtl a\nf 1 2 3 4\n"));
        scratch.write("a.mtl", format!("newmtl a\nKd 1 1 1\n{statement}\nnewmtl unused\nmap_Kd h.png\n"));
        let lines = told(&scratch, "a.obj");
        assert_eq!(lines.len(), usize::from(!part.is_empty()), "{statement}: {lines:?}");
        assert!(lines.iter().all(|l| l.starts_with("Dropped 3: of material \"a\": ") && l.contains(part)), "{lines:?}");
        let strict = run(&["convert", "--strict", &scratch.argument("a.obj"), &scratch.argument("out/a.toml")]).0;
        assert_eq!(strict, if part.is_empty() { 0 } else { 3 });
        let (_, out, _) = run(&["inspect", &scratch.argument("a.obj")]);
        assert!(out.contains(part), "{out}");
    }
}

#[test]
fn names_that_are_not_utf8_stay_apart() {
    let scratch = Scratch::new();
    let both = |text: &str| text.chars().map(|c| c as u8).collect::<Vec<u8>>();
    scratch.write("a.obj", both("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl sol gr\u{fc}n\nf 1 2 3\nusemtl sol gr\u{f6}n\nf 1 2 3\nusemtl 5 \u{80}\nf 1 2 3\n"));
    scratch.write(
        "a.mtl",
        both("newmtl sol gr\u{fc}n\nKd 0.8 0.8 0.8\nnewmtl sol gr\u{f6}n\nKd 0.4 0.4 0.4\nnewmtl 5 \u{80}\n"),
    );
    let file = obj::read(&scratch.join("a.obj")).unwrap();
    let named: Vec<_> = file.materials.iter().map(|m| (m.name.as_str(), m.kd.map(|kd| kd[0]))).collect();
    assert_eq!(named, [("sol grün", Some(0.8)), ("sol grön", Some(0.4)), ("5 €", None)]);
    let lines = told(&scratch, "a.obj");
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines.iter().all(|l| l.contains("Windows-1252")), "{lines:?}");
    // A scene, which is UTF-8, calls them by their names; and so does one that `convert` makes.
    let entries =
        "\"sol grün\" = { reflectance = 0.1 }\n\"sol grön\" = { reflectance = 0.2 }\n\"5 €\" = { reflectance = 0.3 }";
    let file = read(&scratch, &scene("obj = \"a.obj\"", entries, 10.0, 50.0)).unwrap();
    assert!(file.notes.iter().any(|n| n.contains("Windows-1252")), "{:?}", file.notes);
    assert_eq!(file.scene.body.mesh.material.len(), 3);
    let (code, out, err) = run(&["convert", &scratch.argument("a.obj"), &scratch.argument("out/s.toml")]);
    assert_eq!(code, 0, "{out}{err}");
    let scene = scene_toml::read(&scratch.join("out/s.toml"), &unwatched).unwrap().scene;
    assert_eq!(
        scene.body.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(),
        ["sol grün", "sol grön", "5 €"]
    );
    // UTF-8 is UTF-8.
    scratch.write("b.obj", format!("{SQUARE}usemtl grün\nf 1 2 3 4\n"));
    assert_eq!(obj::read(&scratch.join("b.obj")).unwrap().materials[0].name, "grün");
    // UTF-16 is said to be that.
    scratch.write("c.obj", b"\xff\xfev\x00 \x00");
    assert!(obj::read(&scratch.join("c.obj")).unwrap_err().to_string().contains("UTF-16"));
}

#[test]
fn a_missing_material_file_stops_nothing_that_names_suffice_for() {
    for name in ["gone.mtl", "NONE", "C:\\Users\\me\\gone.mtl", "", "a.mtl b.mtl", "../gone.mtl", "."] {
        let scratch = Scratch::new();
        scratch.write("m.obj", format!("mtllib {name}\n{SQUARE}usemtl a\nf 1 2 3 4\n"));
        let by_name = read(&scratch, &scene("obj = \"m.obj\"", "a = { reflectance = 0.1 }", 10.0, 50.0)).unwrap();
        assert!(
            by_name.notes.iter().any(|n| n.contains("m.obj:1") && n.contains("is not read")),
            "{:?}",
            by_name.notes
        );
        // One material for all of it: what the file says of them does not matter.
        let whole = scene("obj = \"m.obj\"\nmaterial = \"b\"", "b = { reflectance = 0.1 }", 10.0, 50.0);
        assert_eq!(read(&scratch, &whole).unwrap().notes, [""; 0]);
        // Colours are what is missing, and said to be.
        let error =
            read(&scratch, &scene("obj = \"m.obj\"", "\"#b03020\" = { reflectance = 0.1 }", 10.0, 50.0)).unwrap_err();
        assert!(error.contains("is not in the dictionary") && error.contains("is not read"), "{error}");
        let (code, out, _) = run(&["convert", &scratch.argument("m.obj"), &scratch.argument("s.toml")]);
        assert!(code == 0 && out.contains("is not read"), "{out}");
        assert_eq!(run(&["inspect", &scratch.argument("m.obj")]).0, 0);
    }
}

#[test]
fn material_files_are_found_under_what_people_call_them() {
    for (text, files) in [
        ("Mat.MTL", &["mat.mtl"][..]),
        ("sub\\mat.mtl", &["sub/mat.mtl"]),
        ("sub\\mat.mtl", &["mat.mtl"]),
        ("C:\\Users\\me\\mat.mtl", &["mat.mtl"]),
        ("/home/me/mat.mtl", &["mat.mtl"]),
        ("./mat.mtl", &["mat.mtl"]),
        ("\"mat one.mtl\"", &["mat one.mtl"]),
        ("mat one.mtl", &["mat one.mtl"]),
        ("other.mtl mat.mtl", &["other.mtl", "mat.mtl"]),
        ("other.mtl \"mat one.mtl\"", &["other.mtl", "mat one.mtl"]),
        ("my other.mtl mat one.mtl", &["my other.mtl", "mat one.mtl"]),
        ("mat", &["mat"]),
    ] {
        let scratch = Scratch::new();
        scratch.write("a.obj", format!("mtllib {text}\n{SQUARE}usemtl a\nf 1 2 3 4\n"));
        std::fs::create_dir(scratch.join("sub")).unwrap();
        for file in files {
            let content = if file.contains("other") { "newmtl b\nKd 1 0 0\n" } else { "newmtl a\nKd 0.25 0.5 0.75\n" };
            scratch.write(file, content);
        }
        let file = obj::read(&scratch.join("a.obj")).unwrap();
        assert_eq!(file.materials[0].kd, Some([0.25, 0.5, 0.75]), "{text}: {:?}", file.material_doubts);
        assert_eq!(file.inputs.len(), 1 + files.len());
    }
}

#[test]
fn an_object_without_a_material_of_its_own_is_told() {
    let start = format!("{SQUARE}o one\nusemtl lava\nf 1 2 3\n");
    let lines = told_of(&format!("{start}o two\nf 1 3 4\no three\nf 1 3 4\n"));
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(
        lines[0].starts_with("Defaulted 8: object `two` (and 1 more objects) begins without `usemtl`"),
        "{lines:?}"
    );
    assert!(lines[0].contains("`lava`"), "{lines:?}");
    // The material may stand before the object's name as well.
    for good in [format!("{start}o two\nusemtl ice\nf 1 3 4\n"), format!("{start}usemtl ice\no two\nf 1 3 4\n")] {
        assert_eq!(told_of(&good), [""; 0], "{good}");
    }
    let lines = told_of(&format!("{SQUARE}f 1 2 3\nusemtl ice\nf 1 3 4\n"));
    assert!(lines.len() == 1 && lines[0].contains("5: faces before the first `usemtl`"), "{lines:?}");
    // Where the scene gives the mesh one material, none of this matters; else it is a warning.
    let scratch = Scratch::new();
    scratch.write("a.obj", format!("{start}o two\nf 1 3 4\n"));
    let notes = |mesh: &str| read(&scratch, &scene(mesh, "lava = { reflectance = 0.1 }", 10.0, 50.0)).unwrap().notes;
    assert!(notes("obj = \"a.obj\"").iter().any(|n| n.contains("object `two`")));
    assert_eq!(notes("obj = \"a.obj\"\nmaterial = \"lava\""), [""; 0]);
}

/// A ball of n x 2n quads as text, radius 1.
fn ball(n: u32) -> (Vec<String>, Vec<String>) {
    let mut vertices = Vec::new();
    for i in 0..=n {
        for j in 0..2 * n {
            let (theta, phi) = (
                f64::from(i) * std::f64::consts::PI / f64::from(n),
                f64::from(j) * std::f64::consts::PI / f64::from(n),
            );
            vertices.push(format!("v {} {} {}\n", theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()));
        }
    }
    let at = |i: u32, j: u32| 1 + i * 2 * n + j % (2 * n);
    let faces = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
    let faces = faces.map(|(i, j)| format!("f {} {} {} {}\n", at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)));
    (vertices, faces.collect())
}

#[test]
fn a_file_that_was_cut_short_is_doubted() {
    let (vertices, faces) = ball(10);
    let whole = vertices.concat() + &faces.concat();
    assert_eq!(told_of(&whole), [""; 0]);
    // At the end of a line: 80 of 200 faces are there, the first 4 of 10 belts; 11 rings of 20 vertices, of which 5 are used.
    let lines = told_of(&(vertices.concat() + &faces[..80].concat()));
    assert_eq!(lines, ["Defaulted 0: 120 of 220 vertices belong to no face: is the file cut short?"]);
    // Within the last face.
    let cut = whole.trim_end().rsplit_once(' ').unwrap().0;
    let lines = told_of(cut);
    assert!(lines.len() == 1 && lines[0].starts_with("Defaulted 420: the last line has no end"), "{lines:?}");
    let corners = "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n";
    let lines = told_of(&format!("{SQUARE}{corners}f 1/1/1 3/1/1 4/1"));
    assert!(lines.len() == 1 && lines[0].contains("is the file cut short?"), "{lines:?}");
    // A last line without an end, as many programs write it, is none.
    assert_eq!(told_of(whole.trim_end()), [""; 0]);
    // A vertex too many in the middle says nothing of the end, nor do vertices of lines.
    assert_eq!(told_of(&format!("v 9 9 9\n{SQUARE}f 2 3 4 5\n")), ["Defaulted 0: 1 of 5 vertices belong to no face"]);
    let lines = told_of(&format!("{SQUARE}v 9 9 9\nf 1 2 3 4\nl 4 5\n"));
    assert_eq!(lines, ["Defaulted 0: 1 of 5 vertices belong to no face"]);
    // `simulate` says it.
    let scratch = Scratch::new();
    scratch.write("a.obj", format!("{SQUARE}v 9 9 9\nf 1 2 3 4\n"));
    let file = read(&scratch, &scene("obj = \"a.obj\"", "default = { reflectance = 0.1 }", 10.0, 50.0)).unwrap();
    assert!(file.notes.iter().any(|n| n.contains("1 of 5 vertices belong to no face")), "{:?}", file.notes);
}

#[test]
fn a_mesh_in_kilometres_is_doubted() {
    let scratch = Scratch::new();
    let (vertices, faces) = ball(10);
    scratch.write("ball.obj", vertices.concat() + &faces.concat());
    let notes = |mesh: &str, height_m: f64, ifov_mrad: f64| {
        let text = scene(mesh, "default = { reflectance = 0.1 }", height_m, ifov_mrad);
        read(&scratch, &text).unwrap().notes.into_iter().filter(|n| n.contains("unit_m")).collect::<Vec<_>>()
    };
    // A body of 2 km from 20 km, in km: 2 m from 20 km, 5775 times its diagonal of 3.46 m.
    for ifov_mrad in [0.5, 0.001] {
        let told = notes("obj = \"ball.obj\"", 20_000.0, ifov_mrad);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].starts_with("mesh[0].obj: ") && told[0].contains("3.464 m across"), "{told:?}");
        assert!(told[0].contains("5774 times") && told[0].contains("in km it would be 1000"), "{told:?}");
    }
    // 100 sizes away, yet less than a pixel of 10 mrad, 3.46 m.
    let told = notes("obj = \"ball.obj\"", 347.0, 10.0);
    assert!(told.len() == 1 && told[0].contains("9.98e-1 pixels"), "{told:?}");
    assert_eq!(notes("obj = \"ball.obj\"\nunit_m = 1000", 20_000.0, 0.5), [""; 0]);
    assert_eq!(notes("obj = \"ball.obj\"", 20.0, 0.5), [""; 0]);
}

#[test]
fn a_body_inside_out_is_told_and_turned() {
    let scratch = Scratch::new();
    let (vertices, faces) = ball(10);
    let turned: String = faces
        .iter()
        .map(|f| {
            let mut corners: Vec<&str> = f.split_whitespace().skip(1).collect();
            corners.reverse();
            format!("f {}\n", corners.join(" "))
        })
        .collect();
    scratch.write("good.obj", vertices.concat() + &faces.concat());
    scratch.write("bad.obj", vertices.concat() + &turned);
    // A camera within the ball, so that either way something faces it.
    let text = |mesh: &str| scene(mesh, "default = { reflectance = 0.1 }", 3.0, 50.0);
    let good = read(&scratch, &text("obj = \"good.obj\"")).unwrap();
    assert!(!good.notes.iter().any(|n| n.contains("inside out")), "{:?}", good.notes);
    let flipped = read(&scratch, &text("obj = \"bad.obj\"\nflip = true")).unwrap();
    assert!(!flipped.notes.iter().any(|n| n.contains("inside out")), "{:?}", flipped.notes);
    let volume = |file: &SceneFile| file.scene.body.mesh.enclosed_m3().unwrap();
    assert!(volume(&good) > 3.5 && (volume(&good) - volume(&flipped)).abs() < 1e-12);
    let bad = read(&scratch, &text("obj = \"bad.obj\""));
    let told = bad.map_or_else(|error| error, |file| file.notes.join("\n"));
    assert!(told.contains("inside out"), "{told}");
    let twice = read(&scratch, &text("obj = \"good.obj\"\nflip = true"));
    let told = twice.map_or_else(|error| error, |file| file.notes.join("\n"));
    assert!(told.contains("inside out"), "{told}");
    // `convert` says it, and turns it.
    let (_, out, err) = run(&["convert", &scratch.argument("bad.obj"), &scratch.argument("a.toml")]);
    assert!(
        out.contains("mesh.flip: as it is: its facets face inwards") || err.contains("back of facets"),
        "{out}{err}"
    );
    let (code, out, err) = run(&["convert", "--flip", &scratch.argument("bad.obj"), &scratch.argument("b.toml")]);
    assert!(code == 0 && !out.contains("mesh.flip"), "{out}{err}");
    let facet = scene_toml::read(&scratch.join("b.toml"), &unwatched).unwrap().scene.body.mesh.facet(300);
    assert!(facet.normal().dot(facet.centroid_m()) > 0.0);
    // A recipe has no sides to turn.
    let recipe = scene(
        "recipe = { version = 1, seed = 1, facets = 1000 }\nflip = true",
        "default = { reflectance = 0.1 }",
        9e3,
        1.0,
    );
    assert!(read(&scratch, &recipe).unwrap_err().contains("mesh[0].flip"));
}
