//! A folder of prepared bodies changes nothing but the time: whatever is in it, and whoever else writes there.

use std::collections::BTreeMap;
use std::path::Path;

use mmxrt::formats::Cache;

use crate::cli::{mmxrt, run};
use crate::scratch::Scratch;
use crate::shapes::sphere;

/// A boulder of a file over a landscape that is made, with a texture of its own, so that each kind of entry is there.
const SCENE: &str = r##"mmxrt_scene = 1
origin_m = [0.0, 0.0, 11000.0]
[[mesh]]
recipe = "site.toml"
[[mesh]]
file = "ball.obj"
[materials]
phobos_blue = { reflectance = 0.05 }
phobos_red = { reflectance = 0.1 }
"#808080" = { reflectance = 0.2 }
[sun]
direction = [0.8660254037844386, 0.0, 0.5]
distance_au = 1.5
[observer]
frame = "site"
position_m = [0.0, 0.0, 1000.0]
target_m = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
[sensor]
samples = 8
lines = 8
ifov_mrad = 12.0
bands = { centres_um = [1.0, 2.0] }
"##;

const RECIPE: &str = "version = 2\nseed = 7\nsize_m = 100.0\nfacets = 3000\n[[craters]]\nmin_diameter_m = 8.0\nmax_diameter_m = 30.0\nper_km2 = 2000.0\n\
     [[boulders]]\nmin_diameter_m = 2.0\nmax_diameter_m = 6.0\nper_km2 = 2000.0\n[texture]\ntexels = 16\nrms = 0.1\n";

/// One entry of each: a mesh that was read, a landscape that was made, how all of it hangs together.
const KINDS: [&str; 3] = ["landscape", "mesh", "topology"];

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.obj("ball", &sphere([10.0, 0.0, 20.0], 8.0, 2), &[("grey", Some([0.2159, 0.2159, 0.2159]))]);
    scratch.write("site.toml", RECIPE);
    scratch.write("scene.toml", SCENE);
    scratch
}

/// All files of a folder but that of times, by their names.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
    let named = entries.map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), path));
    named.filter(|(name, _)| name != "run.json").map(|(name, path)| (name, std::fs::read(path).unwrap())).collect()
}

/// The product of the scene, and how many bodies were taken from the cache, if there is one.
fn product(scratch: &Scratch, cached: bool) -> (BTreeMap<String, Vec<u8>>, usize) {
    let (scene, out, cache) = (scratch.argument("scene.toml"), scratch.argument("out"), scratch.argument("cache"));
    let mut arguments = vec!["simulate", &scene, "-o", &out, "--force", "--verbose", "--model", "sunlight,heat"];
    if cached {
        arguments.extend(["--cache", &cache]);
    }
    let (code, _, err) = run(&arguments);
    assert_eq!(code, 0, "{err}");
    (files(&scratch.join("out")), err.matches("taken from").count())
}

fn entries(scratch: &Scratch) -> BTreeMap<String, Vec<u8>> {
    files(&scratch.join("cache"))
}

#[test]
fn what_is_made_from_it_is_the_same() {
    let scratch = scratch();
    let (truth, _) = product(&scratch, false);
    assert!(truth.len() > 5);
    assert!(product(&scratch, true) == (truth.clone(), 0), "the first fills it");
    let kept = entries(&scratch);
    let kinds: Vec<&str> = kept.keys().map(|name| name.rsplit_once('.').unwrap().1).collect();
    assert_eq!(
        {
            let mut kinds = kinds.clone();
            kinds.sort_unstable();
            kinds
        },
        KINDS
    );
    assert!(product(&scratch, true) == (truth, KINDS.len()), "the second takes all from it");
    assert!(entries(&scratch) == kept);
}

#[test]
fn an_entry_that_is_damaged_is_made_anew() {
    let scratch = scratch();
    let (truth, _) = product(&scratch, true);
    let kept = entries(&scratch);
    let names: Vec<&String> = kept.keys().collect();
    assert_eq!(names.len(), 3);
    for (i, name) in names.iter().enumerate() {
        let whole = &kept[*name];
        let flipped = |at: usize| {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x10;
            bytes
        };
        let damaged = [
            vec![],
            b"not an entry".to_vec(),
            whole[..whole.len() / 2].to_vec(),
            whole[..whole.len() - 1].to_vec(),
            [whole.as_slice(), &[0]].concat(),
            flipped(0),
            flipped(20),
            flipped(whole.len() / 3),
            flipped(whole.len() - 1),
            // Whole, but something else.
            kept[names[(i + 1) % names.len()]].clone(),
        ];
        for (case, bytes) in damaged.into_iter().enumerate() {
            scratch.write(&format!("cache/{name}"), bytes);
            let (made, taken) = product(&scratch, true);
            assert!(made == truth, "{name}, {case}");
            assert_eq!(taken, 2, "{name}, {case}");
            assert!(entries(&scratch) == kept, "{name}, {case}: it is whole again");
        }
    }
}

#[test]
fn what_a_body_is_made_of_may_change() {
    let scratch = scratch();
    product(&scratch, true);
    let changes: [(&str, &dyn Fn(&str) -> String); 4] = [
        // Another seed, a vertex, a colour, which is only in the file that the mesh names, and the unit, which only the scene says.
        ("site.toml", &|text| text.replace("seed = 7", "seed = 8")),
        ("ball.obj", &|text| text.replacen("v 5", "v 6", 1)),
        ("ball.mtl", &|text| text.replace("0.2159", "0.2160")),
        ("scene.toml", &|text| text.replace("file = \"ball.obj\"", "file = \"ball.obj\"\nunit_m = 0.9")),
    ];
    for (name, change) in changes {
        let before = std::fs::read_to_string(scratch.join(name)).unwrap();
        let after = change(&before);
        assert_ne!(before, after, "{name}");
        scratch.write(name, after);
        let (truth, _) = product(&scratch, false);
        assert!(product(&scratch, true).0 == truth, "{name}");
        assert!(product(&scratch, true).0 == truth, "{name}, again");
    }
}

#[test]
fn a_file_of_materials_that_appears_is_read() {
    let scratch = scratch();
    let text = std::fs::read_to_string(scratch.join("scene.toml")).unwrap();
    // By name, so that the colour is not needed.
    scratch.write("scene.toml", text.replace("\"#808080\"", "grey"));
    let mtl = std::fs::read(scratch.join("ball.mtl")).unwrap();
    std::fs::remove_file(scratch.join("ball.mtl")).unwrap();
    let report = |files: &BTreeMap<String, Vec<u8>>| String::from_utf8(files["report.json"].clone()).unwrap();
    for _ in 0..2 {
        assert!(report(&product(&scratch, true).0).contains("is not read"));
    }
    scratch.write("ball.mtl", mtl);
    let (truth, _) = product(&scratch, false);
    assert!(!report(&truth).contains("is not read"));
    assert!(product(&scratch, true).0 == truth);
}

#[test]
fn what_a_killed_process_left_is_removed_and_what_another_writes_is_not() {
    let scratch = scratch();
    std::fs::create_dir(scratch.join("cache")).unwrap();
    let key = "0a".repeat(32);
    let (left, busy) = (format!("{key}.1.0.partial"), format!("{key}.2.0.partial"));
    scratch.write(&format!("cache/{left}"), "half");
    scratch.write(&format!("cache/{busy}"), "half");
    scratch.write("cache/probe.1.0.partial", "");
    // A folder of other things may be named, too: what downloads leave ends like this.
    let foreign = ["0a.1.0.partial", "film.mp4.partial", "notes.txt"];
    foreign.iter().for_each(|name| drop(scratch.write(&format!("cache/{name}"), "mine")));
    let written = std::fs::File::open(scratch.join("cache").join(&busy)).unwrap();
    written.try_lock().unwrap();
    product(&scratch, true);
    let names: Vec<String> =
        entries(&scratch).into_keys().filter(|name| !KINDS.iter().any(|kind| name.ends_with(kind))).collect();
    assert_eq!(names, ["0a.1.0.partial".to_owned(), busy, "film.mp4.partial".into(), "notes.txt".into()]);
}

/// The whole of a `mtllib` is one name, and only if there is no such file, several.
#[test]
fn a_material_file_that_comes_to_be_is_taken() {
    let scratch = scratch();
    scratch.edit("ball.obj", "mtllib ball.mtl", "mtllib ball.mtl other.mtl");
    scratch.write("other.mtl", "newmtl other\nKd 1 0 0\n");
    let (before, _) = product(&scratch, true);
    scratch.write("ball.mtl other.mtl", "newmtl grey\nKd 0.05 0.05 0.05\n");
    scratch.edit("scene.toml", "\"#808080\"", "\"#3f3f3f\"");
    let (truth, _) = product(&scratch, false);
    assert!(product(&scratch, true).0 == truth && truth != before);
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_passed_over() {
    let scratch = scratch();
    let (truth, _) = product(&scratch, true);
    for (name, _) in entries(&scratch) {
        let path = scratch.join("cache").join(name);
        std::fs::remove_file(&path).unwrap();
        // A pipe, which nobody writes to.
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    }
    assert!(product(&scratch, true) == (truth, 0));
}

#[test]
fn processes_share_it() {
    let scratch = scratch();
    let (truth, _) = product(&scratch, false);
    let started: Vec<_> = (0..4)
        .map(|i| {
            let out = format!("out{i}");
            let arguments = ["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument(&out), "--quiet"]
                .map(str::to_owned);
            let child = mmxrt()
                .args(arguments)
                .args(["--model", "sunlight,heat", "--cache", &scratch.argument("cache")])
                .spawn()
                .unwrap();
            (out, child)
        })
        .collect();
    for (out, mut child) in started {
        assert!(child.wait().unwrap().success());
        assert!(files(&scratch.join(&out)) == truth, "{out}");
    }
    assert_eq!(entries(&scratch).len(), KINDS.len());
}

#[test]
fn a_place_is_found_by_a_tree_from_it() {
    let scratch = scratch();
    let (scene, cache) = (scratch.argument("scene.toml"), scratch.argument("cache"));
    let ask = ["locate", &scene, "--pixel", "4.5,4.25", "--pixel", "0.1,7.9", "--ground", "10,0,11028"];
    let (code, truth, err) = run(&ask);
    assert_eq!(code, 0, "{err}");
    assert_eq!(truth.lines().count(), 4, "a heading and three answers");
    for _ in 0..2 {
        assert_eq!(run(&[&ask[..], &["--cache", &cache]].concat()).1, truth);
    }
    let tree = entries(&scratch).into_keys().find(|name| name.ends_with(".tree")).expect("it is kept");
    let whole = std::fs::read(scratch.join("cache").join(&tree)).unwrap();
    scratch.write(&format!("cache/{tree}"), &whole[..whole.len() - 5]);
    assert_eq!(run(&[&ask[..], &["--cache", &cache]].concat()).1, truth);
    assert!(std::fs::read(scratch.join("cache").join(&tree)).unwrap() == whole);
}

#[test]
fn threads_that_open_one_at_once_may_all_write() {
    let scratch = Scratch::new();
    let folder = scratch.join("cache");
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| (0..200).for_each(|_| assert_eq!(Cache::open(&folder).unwrap().warning(), None)));
        }
    });
    assert_eq!(folder.read_dir().unwrap().count(), 0);
}

#[test]
fn a_place_that_can_hold_none_is_an_error() {
    let scratch = scratch();
    let scene = scratch.argument("scene.toml");
    for (place, says) in
        [("scene.toml", "is a file, and no folder that could hold a cache"), ("scene.toml/cache", "making this folder")]
    {
        let (code, _, err) = run(&["inspect", &scene, "--cache", &scratch.argument(place)]);
        assert_eq!(code, 1, "{place}");
        assert!(err.contains(says), "{err}");
    }
}

/// A folder of the system, in which nobody makes files.
#[cfg(target_os = "linux")]
#[test]
fn one_that_cannot_be_written_to_is_told_and_read() {
    let scratch = scratch();
    let (truth, _) = product(&scratch, false);
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let arguments =
        ["simulate", &scene, "-o", &out, "--force", "--model", "sunlight,heat", "--cache", "/proc/self/task"];
    let (code, _, err) = run(&arguments);
    assert!(code == 0 && err.contains("nothing is added"), "{err}");
    assert!(files(&scratch.join("out")) == truth);
}
