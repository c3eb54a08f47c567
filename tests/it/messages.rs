//! Messages say what is the matter, where, and in words that do not mislead.

use crate::cli::run;
use crate::scenes::replaced;
use crate::scratch::Scratch;

const SQUARE: &str = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl g\nf 1 2 3 4\n";
const SCENE: &str = "mmxrt_scene = 1\norigin_m = [0, 0, 0]\n[[mesh]]\nobj = \"m.obj\"\n[materials]\ng = { reflectance = 0.1 }\n\
    [sun]\ndirection = [0, 0, 1]\ndistance_au = 1.0\n[observer]\nposition_m = [0, 0, 10]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
    [sensor]\nsamples = 4\nlines = 4\nfov_deg = 10\nbands = { centres_um = [1.0] }\n";

fn prepared() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("m.obj", SQUARE);
    scratch.write("m.mtl", "newmtl g\nKd 0.5 0.5 0.5\n");
    scratch.write("s.toml", SCENE);
    scratch
}

/// What `simulate` says of the scene with such changes, and whether it made a product.
fn said(scratch: &Scratch, edits: &[(&str, &str)]) -> (i32, String) {
    scratch.write("edited.toml", replaced(SCENE, edits));
    let (scene, out) = (scratch.argument("edited.toml"), scratch.argument("out"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--force"]);
    (code, err)
}

#[test]
fn a_file_that_is_missing_is_so_in_the_same_words_everywhere() {
    let scratch = prepared();
    std::fs::create_dir(scratch.join("folder.npz")).unwrap();
    let at = |name: &str| scratch.argument(name);
    let (scene, out) = (at("s.toml"), at("out"));
    let mut seen = 0;
    for name in
        ["nope", "n.npz", "n.img", "n.exr", "n.json", "n.csv", "n.obj", "n.mtl", "n.toml", "n.glb", "n.png", "n.npy"]
    {
        for arguments in [
            vec!["inspect".to_owned(), at(name)],
            vec!["inspect".into(), at(name), "--pixel".into(), "0,0".into()],
            vec!["inspect".into(), at(name), "--picture".into(), at("p.png")],
            vec!["integrate".into(), scene.clone(), "--radiance".into(), at(name), "-o".into(), out.clone()],
            vec!["simulate".into(), at(name), "-o".into(), out.clone()],
            vec!["convert".into(), at(name), at("x.glb")],
        ] {
            let (code, _, err) = run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
            let expected = format!("{}: there is no such file or folder", at(name));
            assert!(code == 1 && err.contains(&expected) && !err.contains("os error"), "{arguments:?}: {err}");
            seen += 1;
        }
    }
    assert_eq!(seen, 72);
    for arguments in [
        ["inspect", &at("folder.npz"), "--picture", &at("p.png")],
        ["integrate", &scene, "--table", &at("folder.npz")],
        ["integrate", &scene, "--radiance", &at("folder.npz")],
    ] {
        let more = if arguments[0] == "integrate" { vec!["-o", &out] } else { vec![] };
        let (code, _, err) = run(&[arguments.to_vec(), more].concat());
        let is_told = err.contains("is a folder, but a file is needed") || err.contains("is not an image");
        assert!(code == 1 && is_told && !err.contains("os error"), "{arguments:?}: {err}");
    }
    let (code, _, err) = run(&["simulate", &scene, "-o", &at("m.obj/out")]);
    assert!(code == 1 && err.contains("m.obj: making this folder: a file with this name exists"), "{err}");
}

#[test]
fn a_suggestion_in_another_unit_has_the_number_in_that() {
    let scratch = prepared();
    for (good, bad, expected) in [
        // 0.004 rad are 4 mrad; 0.5 micrometres of light are 500 nm; a kilometre is 1000 m; half a turn is 180 deg.
        ("fov_deg = 10", "ifov_rad = 0.004", "`ifov_mrad = 4`"),
        ("fov_deg = 10", "fov_rad = 1.5707963267948966", "`fov_deg = 90`"),
        ("centres_um = [1.0]", "centres_nm = [500, 1000]", "`centres_um = [0.5, 1]`"),
        ("position_m = [0, 0, 10]", "position_km = [0, 0, 0.01]", "`position_m = [0, 0, 10]`"),
        ("distance_au = 1.0", "distance_m = 149597870700", "`distance_au = 1`"),
        ("{ reflectance = 0.1 }", "{ reflectance_percent = 10 }", "`reflectance = 0.1`"),
    ] {
        let (code, err) = said(&scratch, &[(good, bad)]);
        assert!(code == 1 && err.contains("did you mean") && err.contains(expected), "{bad}: {err}");
    }
}

/// An array in NumPy's format, version 1.
fn npy(values: &[f64], shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let header = format!("{header:117}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    bytes
}

#[test]
fn facets_that_are_there_twice_are_told_as_that() {
    let scratch = prepared();
    let mesh = |faces: &str| {
        scratch.write("m.obj", SQUARE.replace("f 1 2 3 4\n", faces));
        said(&scratch, &[])
    };
    let told = "on others, with the same side out: is a mesh, or a part of one, given twice?";
    let black = "seen from outside they are black";
    for (faces, count) in [
        ("f 1 2 3 4\nf 1 2 3 4\n", "2 facets lie"),
        ("f 1 2 3 4\nf 2 3 1\n", "1 facet lies"),
        // Along the other diagonal.
        ("f 1 2 3\nf 1 3 4\nf 1 2 4\nf 2 3 4\n", "2 facets lie"),
        ("f 1 2 3 4\nf 1 2 3 4\nf 1 2 3 4\n", "4 facets lie"),
    ] {
        let (code, err) = mesh(faces);
        assert!(code == 0 && err.contains(count) && err.contains(told) && !err.contains(black), "{faces}: {err}");
    }
    // Both sides of a sheet, and one facet turned over, are what they were.
    let (_, err) = mesh("f 1 2 3 4\nf 4 3 2 1\n");
    assert!(!err.contains(told) && !err.contains(black), "{err}");
    let (_, err) = mesh("f 1 2 3\nf 4 3 1\n");
    assert!(!err.contains(told) && err.contains(black), "{err}");
    // The same mesh twice; also where nothing of it is open: a box, whose second has vertices of its own.
    let twice = ("[materials]", "[[mesh]]\nobj = \"m.obj\"\n[materials]");
    scratch.write("m.obj", SQUARE);
    let (code, err) = said(&scratch, &[twice]);
    assert!(code == 0 && err.contains("mesh[1]: has the vertices of mesh[0]") && !err.contains(black), "{err}");
    let corners: String = (0..8).map(|i| format!("v {} {} {}\n", i & 1, i >> 1 & 1, i >> 2)).collect();
    let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    scratch.write("m.obj", format!("mtllib m.mtl\n{corners}usemtl g\n{faces}"));
    let (code, err) = said(&scratch, &[twice]);
    assert!(code == 0 && err.contains("mesh[1]: has the vertices of mesh[0]"), "{err}");
    // A box and its reverse hold no volume that could be negative.
    let reversed: String = faces
        .lines()
        .map(|f| f.split(' ').skip(1).fold(String::new(), |all, v| format!(" {v}{all}")))
        .map(|f| format!("f{f}\n"))
        .collect();
    scratch.write("m.obj", format!("mtllib m.mtl\n{corners}usemtl g\n{faces}{reversed}"));
    let (code, err) = said(&scratch, &[]);
    assert!(code == 0 && !err.contains("inside out"), "{err}");
}

#[test]
fn images_that_are_damaged_or_called_by_another_name_are_told_as_what_they_are() {
    let scratch = prepared();
    let texture = |name: &str| {
        let with = format!(
            "reflectance = 0.1, texture = {{ raster = \"{name}\", quantity = \"factor\", placement = \"plane\", plane = {{ corner_m = [-1, 1, 0], along_line_m = [1, 0, 0], line_to_line_m = [0, -1, 0] }} }}"
        );
        said(&scratch, &[("reflectance = 0.1", &with)])
    };
    for (name, bytes, told) in [
        ("a.jpg", &b"hello"[..], "begins with \"hello\", as no whole .jpg file does"),
        ("b.jpg", b"", "is empty"),
        ("c.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF", "JPEG: it is cut short"),
        ("d.png", b"\x89PNG\r\n", "not a complete PNG"),
        ("e.tif", b"II", "as no whole .tif file does"),
        ("f.tif", b"II*\0\x08\0\0\0", "not a complete TIFF"),
        ("g.webp", b"RIFF\x10\0\0\0WEBPVP8 ", "WebP"),
        ("h.gif", b"GIF89a\x01\0", "GIF"),
        ("h.png", b"GIF89a\x01\0", "GIF"),
        ("i.img", b"\x1f\x8b\x08\0\0", "is compressed by gzip"),
        ("j.pdf", b"%PDF-1.4", "is PDF"),
        ("k.xyz", b"hello", "its header is not beside it"),
        ("l.img", b"hello", "its header is not beside it"),
    ] {
        scratch.write(name, bytes);
        let (code, err) = texture(name);
        assert!(code == 1 && err.contains(name) && err.contains(told), "{name}: {err}");
        assert_eq!(err.contains("header"), told.contains("header"), "{name}: {err}");
    }
    for (bytes, told) in [
        (&b"\xff\xd8\xff\xe0\0\x10JFIF"[..], "is JPEG, but text is needed"),
        (b"a\0\xff", "is not text"),
        (b"wavelength_\xb5m,reflectance\n", "save the file as UTF-8"),
    ] {
        scratch.write("r.csv", bytes);
        let (code, err) = said(&scratch, &[("reflectance = 0.1", "reflectance = \"r.csv\"")]);
        assert!(code == 1 && err.contains("r.csv:1:") && err.contains(told), "{err}");
    }
}

#[test]
fn a_table_of_facets_says_which_array_is_missing_and_which_are_there() {
    let scratch = prepared();
    let integrate = |name: &str| {
        let (code, _, err) = run(&[
            "integrate",
            &scratch.argument("s.toml"),
            "--radiance",
            &scratch.argument(name),
            "-o",
            &scratch.argument("o"),
        ]);
        assert_eq!(code, 1);
        err
    };
    let zipped = |name: &str, arrays: &[(&str, Vec<u8>)]| {
        let mut zip = zip::ZipWriter::new(std::fs::File::create(scratch.join(name)).unwrap());
        for (array, bytes) in arrays {
            let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
            zip.start_file(format!("{array}.npy"), stored).unwrap();
            std::io::Write::write_all(&mut zip, bytes).unwrap();
        }
        zip.finish().unwrap();
    };
    zipped("a.npz", &[("rad", npy(&[1.0; 2], "(2, 1)")), ("wavelength_um", npy(&[1.0], "(1,)"))]);
    let err = integrate("a.npz");
    assert!(err.contains("has no array `radiance_w_m2_sr_um`; it has rad [2, 1], wavelength_um [1]"), "{err}");
    zipped("b.npz", &[("radiance_w_m2_sr_um", npy(&[1.0; 2], "(2, 1)")), ("wavelength_nm", npy(&[1000.0], "(1,)"))]);
    let err = integrate("b.npz");
    assert!(err.contains("wavelength_um: is missing") && err.contains("radiance_w_m2_sr_um, wavelength_nm"), "{err}");
    scratch.write("c.csv", "facet,rad\n0,1\n1,1\n");
    let err = integrate("c.csv");
    assert!(err.contains("has no column `radiance_w_m2_sr_um`; it has facet, rad"), "{err}");
}

#[test]
fn help_does_not_ask_for_what_is_given() {
    let scratch = prepared();
    let (code, err) = said(&scratch, &[("obj = \"m.obj\"", "obj = \"m.obj\"\npose = \"radial\"")]);
    assert!(code == 1 && err.contains("at which `origin_m` is") && !err.contains("give `origin_m`"), "{err}");
    for (distance, why) in
        [("0.001", "that is inside the Sun"), ("-1", "distances are positive"), ("1e9", "more than 1e18 m")]
    {
        let (code, err) = said(&scratch, &[("distance_au = 1.0", &format!("distance_au = {distance}"))]);
        assert!(code == 1 && err.contains(why), "{err}");
    }
    let mixture = |shares: &str| {
        said(
            &scratch,
            &[(
                "g = { reflectance = 0.1 }",
                &format!("a = {{ reflectance = 0.1 }}\ng = {{ mixture = {{ {shares} }} }}"),
            )],
        )
        .1
    };
    let err = mixture("a = 4");
    assert!(err.contains("divide each by 4") && !err.contains("percent"), "{err}");
    let err = mixture("a = 100");
    assert!(err.contains("if this is percent, write 1"), "{err}");
}
