//! What stands on the disk: whole products, whatever happens to the process that writes them, and to the disk.

use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use mmxrt::formats::npz;
use mmxrt::product::Sees;
use mmxrt::visibility::{Seen, Shown};

use crate::cli::{mmxrt, run};
use crate::scenes::SITE;
use crate::scratch::{Scratch, is_heavy};
use crate::shapes::Random;

/// Two ENVI images of other sizes and numbers: a.img is 3 x 2 of 1, b.img 2 x 2 of 2.
fn two_images(scratch: &Scratch) {
    for (name, samples, value) in [("a", 3, 1.0_f64), ("b", 2, 2.0)] {
        let header = format!(
            "ENVI\nsamples = {samples}\nlines = 2\nbands = 1\ndata type = 5\ninterleave = bsq\nbyte order = 0\n"
        );
        scratch.write(&format!("{name}.hdr"), header);
        scratch.write(&format!("{name}.img"), value.to_le_bytes().repeat(2 * samples));
    }
}

/// What `inspect` finds of an image: its samples, and its mean.
fn image(scratch: &Scratch, name: &str) -> (u64, f64) {
    let (code, out, err) = run(&["inspect", &scratch.argument(name), "--json"]);
    assert_eq!(code, 0, "{err}");
    let facts: serde_json::Value = serde_json::from_str(&out).unwrap();
    (facts["samples"].as_u64().unwrap(), facts["statistics"][0]["mean"].as_f64().unwrap())
}

fn no_leftovers(scratch: &Scratch) {
    let names = scratch.names();
    assert!(names.iter().all(|name| !name.ends_with(".partial")), "{names:?}");
}

#[test]
fn a_run_that_is_killed_leaves_the_whole_old_product_or_the_whole_new_one() {
    let scratch = Scratch::new();
    let product = scratch.argument("product");
    let mut contents = Vec::new();
    for (name, reflectance) in [("dark.toml", "0.07"), ("bright.toml", "0.7")] {
        scratch.write(name, SITE.replace("0.07", reflectance));
        assert_eq!(run(&["-q", "simulate", &scratch.argument(name), "-o", &product, "--force"]).0, 0);
        contents.push(product_bytes(Path::new(&product)));
    }
    let began = Instant::now();
    assert_eq!(run(&["-q", "simulate", &scratch.argument("bright.toml"), "-o", &product, "--force"]).0, 0);
    let whole_us = began.elapsed().as_micros() as u64;
    let mut random = Random(7);
    for i in 0..if is_heavy() { 300 } else { 20 } {
        let scene = scratch.argument(["dark.toml", "bright.toml"][i % 2]);
        let mut child = mmxrt().args(["-q", "simulate", &scene, "-o", &product, "--force"]).spawn().unwrap();
        std::thread::sleep(Duration::from_micros(random.bits() % (whole_us + whole_us / 2)));
        child.kill().unwrap();
        child.wait().unwrap();
        let found = product_bytes(Path::new(&product));
        assert!(contents.contains(&found), "after kill {i} the product is neither");
    }
    assert_eq!(run(&["-q", "simulate", &scratch.argument("dark.toml"), "-o", &product, "--force"]).0, 0);
    assert!(product_bytes(Path::new(&product)) == contents[0]);
    assert_eq!(scratch.names(), ["bright.toml", "dark.toml", "product"]);
}

/// All of a product that does not depend on the time.
fn product_bytes(product: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = product.read_dir().unwrap().map(|e| e.unwrap());
    let mut all: Vec<(String, Vec<u8>)> = entries
        .filter(|e| e.file_name() != "run.json")
        .map(|e| (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap()))
        .collect();
    all.sort();
    assert_eq!(all.len(), 7, "{:?}", all.iter().map(|a| &a.0).collect::<Vec<_>>());
    all
}

#[test]
fn a_pair_of_files_is_of_one_image_whenever_its_writer_is_killed() {
    let scratch = Scratch::new();
    two_images(&scratch);
    let (x, inputs) = (scratch.argument("x.img"), ["a.img", "b.img"].map(|name| scratch.argument(name)));
    let began = Instant::now();
    assert_eq!(run(&["-q", "convert", &inputs[0], &x]).0, 0);
    let whole_us = began.elapsed().as_micros() as u64;
    let mut random = Random(11);
    for i in 0..if is_heavy() { 300 } else { 30 } {
        let mut child = mmxrt().args(["-q", "convert", &inputs[i % 2], &x, "--force"]).spawn().unwrap();
        std::thread::sleep(Duration::from_micros(random.bits() % (whole_us + whole_us / 2)));
        child.kill().unwrap();
        child.wait().unwrap();
        let found = image(&scratch, "x.img");
        assert!([(3, 1.0), (2, 2.0)].contains(&found), "after kill {i}: {found:?}");
    }
    assert_eq!(run(&["-q", "convert", &inputs[1], &x, "--force"]).0, 0);
    assert_eq!(image(&scratch, "x.img"), (2, 2.0));
    no_leftovers(&scratch);
}

#[test]
#[cfg(unix)]
fn what_a_killed_run_left_is_named_and_removed_by_the_next() {
    let scratch = Scratch::new();
    let big = scratch.write("big.toml", SITE.replace("facets = 1000", "facets = 4000000"));
    let (product, scene) = (scratch.argument("product"), scratch.write("scene.toml", SITE));
    let mut child = mmxrt().arg("-q").arg("simulate").arg(&big).args(["-o", &product]).spawn().unwrap();
    while !scratch.join(".product.partial/lock").is_file() {
        std::thread::sleep(Duration::from_millis(2));
        assert!(child.try_wait().unwrap().is_none(), "ended before it could be killed");
    }
    // While it lives it has the name.
    let (code, _, err) = run(&["simulate", scene.to_str().unwrap(), "-o", &product]);
    assert!(code == 1 && err.contains("product: another process is writing it"), "{err}");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(scratch.names().contains(&".product.partial".to_owned()));
    let (code, _, err) = run(&["simulate", scene.to_str().unwrap(), "-o", &product]);
    assert!(code == 0 && err.contains(".product.partial, which a run that was stopped had left"), "{err}");
    assert_eq!(scratch.names(), ["big.toml", "product", "scene.toml"]);
}

#[test]
fn of_several_processes_with_one_output_one_writes_it() {
    let scratch = Scratch::new();
    let scenes = [7, 8].map(|seed| {
        let path = scratch.write(&format!("{seed}.toml"), SITE.replace("seed = 7", &format!("seed = {seed}")));
        path.into_os_string().into_string().unwrap()
    });
    let recipe = scratch.write("recipe.toml", "version = 1\nseed = 7\nfacets = 1000\n");
    let recipe = recipe.to_str().unwrap();
    let solved = |scene: &str, table: &str| {
        assert_eq!(run(&["-q", "solve", scene, "-o", &scratch.argument(table)]).0, 0);
        std::fs::read(scratch.join(table)).unwrap()
    };
    let tables = [solved(&scenes[0], "7.npz"), solved(&scenes[1], "8.npz")];
    let (table, mesh) = (scratch.argument("t.npz"), scratch.argument("m.obj"));
    for round in 0..if is_heavy() { 40 } else { 4 } {
        let force = round % 2 == 1;
        let race = |arguments: &dyn Fn(usize) -> Vec<String>| {
            let start = |i: usize| {
                let mut command = mmxrt();
                command.arg("-q").args(arguments(i)).stdout(Stdio::null()).stderr(Stdio::piped());
                command.args(force.then_some("--force")).spawn().unwrap()
            };
            let children: Vec<_> = (0..8).map(start).collect();
            let mut won = 0;
            for child in children {
                let output = child.wait_with_output().unwrap();
                let err = String::from_utf8(output.stderr).unwrap();
                match output.status.code() {
                    Some(0) => won += 1,
                    Some(1) => assert!(err.contains("exists"), "{err}"),
                    other => panic!("{other:?}: {err}"),
                }
            }
            // With --force each that comes when another has ended replaces what that wrote.
            assert!(if force { won >= 1 } else { won == 1 }, "{won} of 8 have written it");
        };
        if !force {
            for name in ["t.npz", "m.obj", "m.mtl", "m_craters.csv", "m_boulders.csv"] {
                let _ = std::fs::remove_file(scratch.join(name));
            }
        }
        race(&|i| ["solve", &scenes[i % 2], "-o", &table].map(str::to_owned).to_vec());
        assert!(tables.contains(&std::fs::read(&table).unwrap()), "the table is of neither scene");
        race(&|i| {
            let seed = (i % 2 + 7).to_string();
            ["landscape", recipe, "-o", &mesh, "--seed", &seed].map(str::to_owned).to_vec()
        });
        assert_eq!(run(&["inspect", &mesh]).0, 0);
        no_leftovers(&scratch);
    }
}

#[test]
#[cfg(unix)]
fn interrupted_means_that_nothing_was_written() {
    let scratch = Scratch::new();
    let scene = scratch.write("s.toml", SITE);
    let (scene, output) = (scene.to_str().unwrap(), scratch.argument("x.toml"));
    let began = Instant::now();
    assert_eq!(run(&["-q", "convert", scene, &output]).0, 0);
    let whole_us = began.elapsed().as_micros() as u64;
    let written = |scratch: &Scratch| scratch.names().iter().filter(|name| name.contains('x')).count();
    let all = written(&scratch);
    assert!(all >= 3, "{:?}", scratch.names());
    let mut random = Random(3);
    for _ in 0..if is_heavy() { 200 } else { 20 } {
        for name in scratch.names().iter().filter(|name| name.starts_with('x')) {
            std::fs::remove_file(scratch.join(name)).unwrap();
        }
        let mut command = mmxrt();
        command.args(["convert", scene, &output]).stdout(Stdio::null()).stderr(Stdio::piped());
        let child = command.spawn().unwrap();
        std::thread::sleep(Duration::from_micros(random.bits() % (whole_us + whole_us / 4)));
        let _ = std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        match output.status.code() {
            Some(0) => assert_eq!(written(&scratch), all, "{:?}", scratch.names()),
            Some(1) => {
                assert!(written(&scratch) == 0 && err.contains("nothing was written"), "{err}{:?}", scratch.names())
            }
            // Before it could catch the signal.
            None => assert_eq!(written(&scratch), 0, "{:?}", scratch.names()),
            other => panic!("{other:?}: {err}"),
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_standard_output_fails_only_what_has_no_other_output() {
    let scratch = Scratch::new();
    let scene = scratch.write("s.toml", SITE);
    let full = |arguments: &[&str]| {
        let out = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = mmxrt().args(arguments).stdout(out).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (scene, product) = (scene.to_str().unwrap(), scratch.argument("p"));
    let (table, mesh) = (scratch.argument("t.npz"), scratch.argument("x.toml"));
    for arguments in [["simulate", scene, "-o", &product], ["solve", scene, "-o", &table]] {
        let (code, err) = full(&arguments);
        assert!(code == Some(0) && err.contains("standard output: writing") && err.contains("complete"), "{err}");
    }
    let (code, err) = full(&["convert", scene, &mesh]);
    assert!(code == Some(0) && err.contains("complete"), "{err}");
    assert_eq!(run(&["inspect", &product]).0, 0);
    let (code, err) = full(&["inspect", &product]);
    assert!(code == Some(1) && err.contains("standard output: writing"), "{err}");
}

#[test]
fn a_conversion_never_replaces_what_it_reads() {
    let scratch = Scratch::new();
    two_images(&scratch);
    scratch.write("s.toml", SITE);
    assert_eq!(run(&["-q", "convert", &scratch.argument("s.toml"), &scratch.argument("mesh.toml")]).0, 0);
    assert_eq!(run(&["-q", "convert", &scratch.argument("mesh.obj"), &scratch.argument("m.gltf")]).0, 0);
    std::fs::hard_link(scratch.join("a.img"), scratch.join("hard.npy")).unwrap();
    let mut cases = vec![
        // The header would be that of the output; so would one of another image.
        ("a.img", "a.bil", "a.hdr"),
        ("b.img", "a.bil", "a.hdr"),
        ("a.img", "a.img", "a.img"),
        ("a.hdr", "a.img", "a.img"),
        ("a.img", "hard.npy", "hard.npy"),
        // Meshes, materials and buffers that the input names.
        ("mesh.obj", "mesh.toml", "mesh.obj"),
        ("mesh.toml", "mesh.obj", "mesh.obj"),
        ("m.gltf", "m.gltf", "m.gltf"),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("a.img", scratch.join("link.npy")).unwrap();
        cases.push(("a.img", "link.npy", "a.img"));
    }
    let before: Vec<_> =
        scratch.names().iter().map(|name| (name.clone(), std::fs::read(scratch.join(name)).unwrap())).collect();
    for (input, output, kept) in cases {
        let (code, _, err) = run(&["convert", &scratch.argument(input), &scratch.argument(output), "--force"]);
        assert!(code == 1 && err.contains(kept) && err.contains("another name"), "{input} to {output}: {err}");
        let after: Vec<_> =
            scratch.names().iter().map(|name| (name.clone(), std::fs::read(scratch.join(name)).unwrap())).collect();
        assert!(before == after, "{input} to {output}: {:?}", scratch.names());
    }
}

#[test]
fn a_product_is_not_replaced_by_what_is_made_from_it() {
    let scratch = Scratch::new();
    let (scene, product) = (scratch.write("s.toml", SITE), scratch.argument("p"));
    let scene = scene.to_str().unwrap();
    assert_eq!(run(&["-q", "simulate", scene, "-o", &product, "--table"]).0, 0);
    let table = scratch.argument("p/table.npz");
    let (code, _, err) = run(&["integrate", scene, "--table", &table, "-o", &product, "--force"]);
    assert!(code == 1 && err.contains("table.npz is read for it"), "{err}");
    assert!(scratch.join("p/table.npz").is_file());
    let picture = scratch.argument("p/quicklook.png");
    let (code, _, err) = run(&["inspect", &picture, "--picture", &picture, "--force"]);
    assert!(code == 1 && err.contains("is read for it"), "{err}");
}

#[test]
fn what_other_programs_leave_in_a_product_is_kept_and_does_not_keep_it_from_being_replaced() {
    let scratch = Scratch::new();
    let (scene, product) = (scratch.write("s.toml", SITE), scratch.argument("p"));
    let simulate = ["simulate", scene.to_str().unwrap(), "-o", &product, "--force"];
    assert_eq!(run(&simulate).0, 0);
    let strays =
        [".DS_Store", "._cube.img", "Thumbs.db", "desktop.ini", "cube.img.aux.xml", "report.json~", ".run.json.swp"];
    strays.iter().for_each(|name| _ = scratch.write(&format!("p/{name}"), name));
    for _ in 0..2 {
        let (code, _, err) = run(&simulate);
        assert!(code == 0 && err.contains("kept") && err.contains("cube.img.aux.xml"), "{err}");
        for name in strays {
            assert_eq!(std::fs::read_to_string(scratch.join("p").join(name)).unwrap(), name);
        }
    }
    // What somebody has made is no stray.
    scratch.write("p/cube.img.tif", "mine");
    let (code, _, err) = run(&simulate);
    assert!(code == 1 && err.contains("cube.img.tif"), "{err}");
    // Strays alone are no reason not to write a folder, and are kept there too.
    std::fs::create_dir(scratch.join("q")).unwrap();
    scratch.write("q/.DS_Store", "x");
    assert_eq!(run(&["-q", "simulate", simulate[1], "-o", &scratch.argument("q"), "--force"]).0, 0);
    assert_eq!(std::fs::read_to_string(scratch.join("q/.DS_Store")).unwrap(), "x");
}

#[test]
fn a_product_that_no_disk_holds_is_refused_before_the_work() {
    let scratch = Scratch::new();
    // 8192 x 8192 pixels in 100000 bands of 4 bytes, and 42 planes of 8.
    let bands = "bands = { start_um = 0.9, stop_um = 3.6, count = 100000 }";
    let text = SITE.replace("= 16\n", "= 8192\n").replace("bands = { centres_um = [1.0] }", bands);
    let scene = scratch.write("s.toml", text);
    let (code, _, err) = run(&["simulate", scene.to_str().unwrap(), "-o", &scratch.argument("p")]);
    // Memory is asked for before; where there is enough of it, the disk: 26866.094 GB.
    let told = err.contains("takes 26866.") && err.contains("and the disk has") || err.contains("GB of memory");
    assert!(code == 1 && told, "{err}");
    assert_eq!(scratch.names(), ["s.toml"]);
}

/// A table with one number changed.
fn tampered(scratch: &Scratch, name: &str, change: impl FnOnce(&mut mmxrt::product::FacetTable)) -> String {
    let (mut table, header) = npz::read_table(&scratch.join("t.npz")).unwrap();
    change(&mut table);
    npz::write_table(&scratch.join(name), &table, &header.scene).unwrap();
    scratch.argument(name)
}

#[test]
fn a_table_that_was_tampered_with_is_told_at_its_place_and_makes_no_product() {
    let scratch = Scratch::new();
    let scene = scratch.write("s.toml", SITE);
    let (scene, product) = (scene.to_str().unwrap(), scratch.argument("p"));
    assert_eq!(run(&["-q", "solve", scene, "--model", "mars-light,heat", "-o", &scratch.argument("t.npz")]).0, 0);
    assert_eq!(run(&["-q", "integrate", scene, "--table", &scratch.argument("t.npz"), "-o", &product]).0, 0);
    let good = product_bytes(Path::new(&product));
    /// The last facet is lit in these triangles, and no other facet at all.
    fn lit_in(table: &mut mmxrt::product::FacetTable, triangles: &[[[f64; 2]; 3]]) {
        let f = table.facets() - 1;
        let mut shown = vec![Shown::Nothing; f + 1];
        shown[f] = Shown::Part;
        table.sources[0].sees = Sees::Polygons(Seen {
            shown,
            polygon_facet: vec![f as u32; triangles.len()],
            polygon_start: (0..=triangles.len()).map(|i| 3 * i).collect(),
            uv: triangles.concat(),
            polygon_share: vec![],
        });
    }
    const WHOLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    type Change = Box<dyn FnOnce(&mut mmxrt::product::FacetTable)>;
    let cases: [(&str, Change, &str); 7] = [
        ("sun.npz", Box::new(|t| t.sources[0].irradiance[3] *= 10.0), "sun_irradiance[3]: "),
        ("mars.npz", Box::new(|t| t.sources[1].irradiance[4] = 7.0), "mars_irradiance[4]: 7 is above 1"),
        ("warm.npz", Box::new(|t| t.temperature_lit_k[5] = 1e11), "temperature_lit_k[5]: is 100000000000 K"),
        ("cold.npz", Box::new(|t| t.temperature_shaded_k[5] = f64::NAN), "temperature_shaded_k[5]: NaN"),
        ("uv.npz", Box::new(|t| lit_in(t, &[[[0.0, 0.0], [0.8, 0.8], [0.0, 1.0]]])), "sun_polygon_uv[1]: 0.8 0.8"),
        ("twice.npz", Box::new(|t| lit_in(t, &[WHOLE, WHOLE])), "are 2 of it"),
        // In its range, and more than this Mars can send: the product's own check, and not our fault.
        ("most.npz", Box::new(|t| t.sources[1].irradiance[4] = 0.9), "what "),
    ];
    for (name, change, told) in cases {
        let table = tampered(&scratch, name, change);
        let (code, out, err) = run(&["integrate", scene, "--table", &table, "-o", &product, "--force"]);
        assert!(code == 1 && out.is_empty() && err.contains(told), "{name}: {err}");
        let is_own_check = name == "most.npz";
        assert_eq!(err.contains("a check of the product failed, so it is not written"), is_own_check, "{err}");
        assert!(product_bytes(Path::new(&product)) == good, "{name} replaced a good product");
    }
}

#[test]
#[cfg(unix)]
fn a_scene_that_a_link_leads_to_finds_its_files() {
    use std::os::unix::fs::symlink;
    let scratch = Scratch::new();
    for folder in ["real", "links"] {
        std::fs::create_dir(scratch.join(folder)).unwrap();
    }
    let table = |percent: u32| format!("wavelength_nm,reflectance_percent\n900,{percent}\n2500,{percent}\n");
    scratch.write("real/s.toml", SITE.replace("0.07", "\"blue.csv\""));
    scratch.write("real/blue.csv", table(7));
    symlink("../real/s.toml", scratch.join("links/l.toml")).unwrap();
    let inspect = || {
        let (code, out, err) = run(&["inspect", &scratch.argument("links/l.toml"), "--json"]);
        assert_eq!(code, 0, "{err}");
        let facts: serde_json::Value = serde_json::from_str(&out).unwrap();
        (facts["materials"][0]["reflectance"].as_f64().unwrap(), facts["warnings"].to_string())
    };
    let (reflectance, warnings) = inspect();
    assert!((reflectance - 0.07).abs() < 1e-12 && warnings.contains("l.toml is a link"), "{reflectance} {warnings}");
    // What is beside the link comes first.
    scratch.write("links/blue.csv", table(9));
    let (reflectance, warnings) = inspect();
    assert!((reflectance - 0.09).abs() < 1e-12 && !warnings.contains("is a link"), "{reflectance} {warnings}");
    // An image whose header is beside what the link leads to.
    two_images(&scratch);
    symlink("../a.img", scratch.join("links/l.img")).unwrap();
    assert_eq!(image(&scratch, "links/l.img"), (3, 1.0));
}

#[test]
fn names_and_folders_that_cannot_be_outputs_are_told_before_the_work() {
    let scratch = Scratch::new();
    let scene = scratch.write("s.toml", SITE);
    let scene = scene.to_str().unwrap();
    let long = scratch.argument(&"n".repeat(250));
    assert_eq!(run(&["-q", "simulate", scene, "-o", &long]).0, 0);
    assert_eq!(run(&["-q", "simulate", scene, "-o", &long, "--force"]).0, 0);
    assert_eq!(run(&["-q", "convert", scene, &format!("{long}.glb")]).0, 0);
    let (code, _, err) = run(&["simulate", scene, "-o", &scratch.argument(&"n".repeat(300))]);
    assert!(code == 1 && err.contains("too long"), "{err}");
    for here in [".", "..", "/"] {
        let output = mmxrt().args(["simulate", scene, "-o", here]).current_dir(scratch.path()).output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && (err.contains("no name") || err.contains("exists")), "{err}");
    }
    assert_eq!(scratch.names().len(), 3);
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_takes_no_files_is_told_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new();
    let scene = scratch.write("s.toml", SITE);
    let closed = scratch.join("closed");
    std::fs::create_dir(&closed).unwrap();
    std::fs::set_permissions(&closed, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::create_dir(closed.join("probe")).is_ok() {
        eprintln!("SKIPPED: this user may write anywhere");
        return;
    }
    let (code, _, err) = run(&["simulate", scene.to_str().unwrap(), "-o", &scratch.argument("closed/p")]);
    assert!(code == 1 && err.contains("closed/p: making this folder"), "{err}");
}

/// A disk of 256 kB, where this user may mount one: what does not fit leaves the old product, and nothing else.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_the_old_product() {
    let scratch = Scratch::new();
    let disk = scratch.argument("disk");
    std::fs::create_dir(&disk).unwrap();
    let mount = |arguments: &[&str]| {
        std::process::Command::new(arguments[0])
            .args(&arguments[1..])
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|s| s.success())
    };
    if !mount(&["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", &disk]) {
        eprintln!("SKIPPED: this user may mount nothing");
        return;
    }
    let scene = scratch.write("s.toml", SITE);
    let (scene, product) = (scene.to_str().unwrap(), scratch.argument("disk/p"));
    let small = run(&["simulate", scene, "-o", &product]);
    // 64 x 64 pixels of 42 planes of 8 bytes are 1.4 MB: told beforehand.
    scratch.write("big.toml", SITE.replace("= 16\n", "= 64\n"));
    let big = run(&["simulate", &scratch.argument("big.toml"), "-o", &product, "--force"]);
    let after: Vec<_> = std::fs::read_dir(&disk).unwrap().map(|e| e.unwrap().file_name()).collect();
    let good = scratch.join("disk/p/report.json").is_file();
    mount(&["umount", &disk]);
    assert_eq!(small.0, 0, "{}", small.2);
    assert!(big.0 == 1 && big.2.contains("takes 1.39") && big.2.contains("the disk has"), "{}", big.2);
    assert!(good && after == ["p"], "{after:?}");
}
