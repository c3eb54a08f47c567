//! Campaigns: many acquisitions of one scene, whoever makes them, however often they are stopped, and whatever is done to their folder.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use glam::DVec3;
use mmxrt::formats::{npz, scene_toml};
use mmxrt::progress::unwatched;

use crate::cli::{mmxrt, run};
use crate::scenes::replaced;
use crate::scratch::{Scratch, is_heavy};
use crate::shapes::{Random, sphere};

/// A moon of 320 facets, from the lowest orbit of the mission.
const SCENE: &str = r#"mmxrt_scene = 1
origin_m = [0.0, 0.0, 0.0]
[[mesh]]
file = "moon.obj"
coordinates = "body"
[materials]
grey = { reflectance = 0.07 }
[thermal]
model = "off"
[flight]
epoch = "2027-05-01T06:00:00 UTC"
orbit = "qso-20x27"
[sensor]
samples = 6
lines = 6
ifov_mrad = 60.0
bands = { centres_um = [1.0, 2.0] }
"#;

const CAMPAIGN: &str = r#"mmxrt_campaign = 1
scene = "scene.toml"
[[acquisitions]]
name = "map"
start = "2027-05-01T05:00:00 UTC"
stop = "2027-05-01T06:00:00 UTC"
every_s = 1800.0
[[acquisitions]]
name = "site"
offset_s = 100.0
latitude_deg = 5.0
longitude_deg = 10.0
"#;

/// All acquisitions of it.
const NAMES: [&str; 4] =
    ["map_2027-05-01T05-00-00.000", "map_2027-05-01T05-30-00.000", "map_2027-05-01T06-00-00.000", "site"];

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.obj("moon", &sphere([0.0; 3], 11_000.0, 2), &[("grey", None)]);
    scratch.write("scene.toml", SCENE);
    scratch.write("campaign.toml", CAMPAIGN);
    scratch
}

/// What a campaign says, into a folder: code, (name, state) of each line, and what is said beside them.
fn made(scratch: &Scratch, folder: &str, more: &[&str]) -> (i32, Vec<(String, String)>, String) {
    let (file, folder) = (scratch.argument("campaign.toml"), scratch.argument(folder));
    let (code, out, err) = run(&[&["campaign", &file, "-o", &folder][..], more].concat());
    let of = |line: &str| {
        let line: serde_json::Value = serde_json::from_str(line).unwrap_or_else(|_| panic!("{line}"));
        assert!(line["seconds"].is_number() && line["epoch"].as_str().unwrap().ends_with(" UTC"), "{line}");
        assert_eq!(line["state"] == "failed", line.get("errors").is_some(), "{line}");
        (line["name"].as_str().unwrap().to_owned(), line["state"].as_str().unwrap().to_owned())
    };
    (code, out.lines().map(of).collect(), err)
}

fn states(lines: &[(String, String)], state: &str) -> usize {
    lines.iter().filter(|(_, of)| of == state).count()
}

/// Every file below a folder, but `run.json`, which says how long things took.
fn tree(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(path) = folders.pop() {
        for entry in path.read_dir().unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
            if path.is_dir() {
                files.insert(format!("{name}/"), vec![]);
                folders.push(path);
            } else if !name.ends_with("run.json") {
                files.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    files
}

fn same_trees(scratch: &Scratch, a: &str, b: &str) {
    let [a, b] = [a, b].map(|name| tree(&scratch.join(name)));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in &a {
        assert!(b[name] == *bytes, "{name} differs");
    }
}

fn manifest(scratch: &Scratch, folder: &str) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(scratch.join(folder).join("manifest.json")).unwrap()).unwrap()
}

#[test]
fn a_campaign_is_made_once_and_then_kept() {
    let scratch = scratch();
    let (code, lines, err) = made(&scratch, "out", &["--threads", "1"]);
    assert_eq!((code, lines.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>()), (0, NAMES.to_vec()), "{err}");
    assert_eq!(states(&lines, "done"), 4);
    assert!(err.contains("4 done, 0 kept, 0 failed") && err.contains("of the surface seen"), "{err}");
    let before = tree(&scratch.join("out"));
    let tops: Vec<&str> =
        before.keys().map(String::as_str).filter(|name| !name[..name.len() - 1].contains('/')).collect();
    assert_eq!(
        tops,
        ["coverage.csv", "coverage_count.png", "coverage_sampling.png", "manifest.json", "products/", "sights/"]
    );
    let manifest = manifest(&scratch, "out");
    for (entry, name) in manifest["acquisitions"].as_array().unwrap().iter().zip(NAMES) {
        assert_eq!((entry["name"].as_str(), entry["state"].as_str()), (Some(name), Some("done")));
        let report = std::fs::read(scratch.join(&format!("out/products/{name}/report.json"))).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        assert_eq!(entry["product"], report["scene"]);
        let (sights, id) = npz::read_sights(&scratch.join(&format!("out/sights/{name}.npz")), 320).unwrap();
        assert!(!sights.facet.is_empty());
        assert_eq!(entry["sights"].as_str(), Some(id.as_str()));
    }
    assert_eq!(manifest["acquisitions"][2]["epoch_utc"], "2027-05-01T06:00:00.000");
    let (_, out, _) = run(&["inspect", &scratch.argument("out/manifest.json")]);
    assert!(out.starts_with("kind: campaign manifest\n") && out.contains("\nacquisitions: 4\nfailed: 0\n"), "{out}");
    assert_eq!(run(&["inspect", &scratch.argument("out")]).1, out);
    let (_, out, _) = run(&["inspect", &scratch.argument("campaign.toml")]);
    assert!(out.starts_with("kind: campaign\nacquisitions: 4\n") && out.contains("name site"), "{out}");
    // Again, with other threads: nothing is touched but the record, which is the same.
    let (code, lines, _) = made(&scratch, "out", &["--threads", "3"]);
    assert_eq!((code, states(&lines, "kept")), (0, 4));
    assert!(tree(&scratch.join("out")) == before);
    // From nothing, at another number of threads.
    made(&scratch, "other", &["--threads", "3"]);
    same_trees(&scratch, "out", "other");
}

/// Each acquisition is what a scene that says the same is.
#[test]
fn an_acquisition_is_the_image_of_a_scene_that_says_the_same() {
    let scratch = scratch();
    let sensor = "samples = 6\nlines = 6\nifov_mrad = 60.0\nbands = { centres_um = [1.0, 2.0] }";
    let other = "kind = \"push_broom\"\nperiod_s = 40.0\nsamples = 5\nlines = 7\nfov_deg = 30.0\nbands = { centres_um = [1.5] }";
    let epoch = "epoch = \"2027-05-01T06:00:00 UTC\"";
    let orbit = "orbit = \"qso-20x27\"";
    // A change of the campaign's entry, and of the scene.
    let cases: [(&str, &str, &[(&str, &str)]); 5] = [
        (
            "epoch = \"2027-05-01T07:00:00 UTC\"",
            "",
            &[(epoch, "epoch = \"2027-05-01T07:00:00 UTC\"\norbit_epoch = \"2027-05-01T06:00:00 UTC\"")],
        ),
        (
            "offset_s = 0",
            "target_m = [10900.0, 900.0, 300.0]",
            &[(orbit, "orbit = \"qso-20x27\"\npointing = { target_m = [10900.0, 900.0, 300.0] }")],
        ),
        (
            "offset_s = 0",
            "pointing = { up = \"sun\", bias_mrad = [3.0, 0.0, 1.0] }",
            &[(orbit, "orbit = \"qso-20x27\"\npointing = { up = \"sun\", bias_mrad = [3.0, 0.0, 1.0] }")],
        ),
        (
            "epochs = [\"2027-05-01T06:00:00 UTC\"]",
            "orbit = \"qso-30x49\"\norbit_epoch = \"2027-05-01T05:00:00 UTC\"",
            &[(orbit, "orbit = \"qso-30x49\"\norbit_epoch = \"2027-05-01T05:00:00 UTC\"")],
        ),
        (
            "offset_s = 0",
            &format!("pointing = {{ up = \"backward\" }}\nsensor = {{ {} }}", other.replace('\n', ", ")),
            &[(sensor, other), (orbit, "orbit = \"qso-20x27\"\npointing = { up = \"backward\" }")],
        ),
    ];
    let mut campaign = "mmxrt_campaign = 1\nscene = \"scene.toml\"\n".to_owned();
    for (i, (moment, change, _)) in cases.iter().enumerate() {
        campaign += &format!("[[acquisitions]]\nname = \"a{i}\"\n{moment}\n{change}\n");
    }
    scratch.write("campaign.toml", campaign);
    let (code, lines, err) = made(&scratch, "out", &[]);
    assert_eq!((code, states(&lines, "done")), (0, 5), "{err}{lines:?}");
    for ((name, _), (_, _, edits)) in lines.iter().zip(cases) {
        scratch.write("alone.toml", replaced(SCENE, edits));
        let alone = scratch.argument("alone");
        let (code, _, err) = run(&["-q", "simulate", &scratch.argument("alone.toml"), "-o", &alone, "--force"]);
        assert_eq!(code, 0, "{err}");
        for part in ["cube.img", "backplanes.img", "exposures.csv"] {
            let [a, b] = [&format!("out/products/{name}"), "alone"]
                .map(|folder| std::fs::read(scratch.join(folder).join(part)).unwrap());
            assert!(a == b, "{name}/{part}");
        }
    }
}

/// Whenever it is killed, what is there is whole, and the next run makes the rest: all of it as if nothing had happened.
#[test]
fn a_campaign_that_is_killed_goes_on() {
    let scratch = scratch();
    let began = Instant::now();
    assert_eq!(made(&scratch, "whole", &[]).0, 0);
    let whole_us = began.elapsed().as_micros() as u64;
    let (file, folder) = (scratch.argument("campaign.toml"), scratch.argument("out"));
    let mut random = Random(3);
    let (mut done, mut kept) = (0, 0);
    for round in 0..if is_heavy() { 60 } else { 2 } {
        for _ in 0..4 {
            let mut child = mmxrt().args(["-q", "campaign", &file, "-o", &folder]).spawn().unwrap();
            std::thread::sleep(Duration::from_micros(random.bits() % whole_us));
            child.kill().unwrap();
            child.wait().unwrap();
            for name in NAMES {
                let product = scratch.join(&format!("out/products/{name}"));
                assert!(!product.exists() || product.join("report.json").is_file(), "half of {name}");
            }
        }
        let (code, lines, err) = made(&scratch, "out", &[]);
        assert_eq!((code, lines.len()), (0, 4), "{round}: {err}");
        (done, kept) = (done + states(&lines, "done"), kept + states(&lines, "kept"));
        same_trees(&scratch, "whole", "out");
        std::fs::remove_dir_all(scratch.join("out")).unwrap();
    }
    assert_eq!(done + kept, if is_heavy() { 240 } else { 8 });
}

/// Several processes make one campaign side by side; parts beyond the number of acquisitions have none.
#[test]
fn parts_of_a_campaign_make_the_whole() {
    let scratch = scratch();
    assert_eq!(made(&scratch, "whole", &[]).0, 0);
    // One after the other: only the last knows all.
    let mut seen = Vec::new();
    for part in ["6/6", "2/6", "1/6", "5/6", "4/6", "3/6"] {
        let (code, lines, err) = made(&scratch, "parts", &["--shard", part]);
        assert_eq!(code, 0, "{err}");
        assert!(lines.len() <= 1);
        seen.extend(lines.into_iter().map(|(name, _)| name));
        assert_eq!(scratch.join("parts/manifest.json").exists(), part == "3/6");
    }
    seen.sort();
    assert_eq!(seen, NAMES);
    same_trees(&scratch, "whole", "parts");
    // Side by side.
    let (file, folder) = (scratch.argument("campaign.toml"), scratch.argument("beside"));
    for _ in 0..if is_heavy() { 50 } else { 1 } {
        let start = |part: &str| {
            let mut command = mmxrt();
            command.args(["-q", "campaign", &file, "-o", &folder, "--shard", part]);
            command.stderr(Stdio::piped()).spawn().unwrap()
        };
        for child in ["1/3", "2/3", "3/3"].map(start) {
            let output = child.wait_with_output().unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
        same_trees(&scratch, "whole", "beside");
        std::fs::remove_dir_all(&folder).unwrap();
    }
    for (part, why) in [
        ("0/3", "not from 1 to 3"),
        ("4/3", "not from 1 to 3"),
        ("1", "K/N"),
        ("-1/2", "K/N"),
        ("1/0", "not from 1 to 0"),
    ] {
        let (code, _, err) = run(&["campaign", &file, "-o", &folder, &format!("--shard={part}")]);
        assert!(code == 2 && err.contains(why), "{part}: {err}");
    }
}

/// Whole processes in one folder leave to each other what each is making, and end when all of it is there; one whose maker was killed is made.
#[test]
fn processes_in_one_folder_wait_for_each_other() {
    let scratch = scratch();
    assert_eq!(made(&scratch, "whole", &[]).0, 0);
    let start = |folder: &str| {
        let mut command = mmxrt();
        command.args(["campaign", &scratch.argument("campaign.toml"), "-o", &scratch.argument(folder)]);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    for child in [start("both"), start("both")] {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    same_trees(&scratch, "whole", "both");
    // Another process holds one product, and the sights of another, and goes away without having made them.
    let hold = |part: &str| {
        let hidden = scratch.join(&format!("held/{part}"));
        std::fs::create_dir_all(&hidden).unwrap();
        let lock = std::fs::File::create(hidden.join("lock")).unwrap();
        lock.lock().unwrap();
        lock
    };
    let locks = [hold(&format!("products/.{}.partial", NAMES[0])), hold(&format!("sights/.{}.npz.partial", NAMES[2]))];
    let mut child = start("held");
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut next = || -> serde_json::Value { serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap() };
    let first: Vec<_> = (0..4).map(|_| next()).map(|line| (line["name"].clone(), line["state"].clone())).collect();
    let expected = [(NAMES[0], "busy"), (NAMES[1], "done"), (NAMES[2], "busy"), (NAMES[3], "done")];
    assert_eq!(first, expected.map(|(name, state)| (name.into(), state.into())));
    drop(locks);
    let last: Vec<_> = (0..2).map(|_| next()).map(|line| (line["name"].clone(), line["state"].clone())).collect();
    assert_eq!(last, [(NAMES[0].into(), "done".into()), (NAMES[2].into(), "done".into())]);
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && err.contains("4 done, 0 kept, 0 failed"), "{err}");
    same_trees(&scratch, "whole", "held");
}

/// A look past the body is told of by its line and by the manifest, whether its product was made or not, now or before.
#[test]
fn warnings_of_acquisitions_are_told() {
    let scratch = scratch();
    let past = "\n[[acquisitions]]\nname = \"past\"\noffset_s = 0\npointing = { bias_mrad = [1000.0, 0.0, 0.0] }\n";
    scratch.write("campaign.toml", format!("{CAMPAIGN}{past}"));
    let file = scratch.argument("campaign.toml");
    for (folder, more) in
        [("out", "--verbose"), ("out", "--verbose"), ("seen", "--coverage-only"), ("seen", "--coverage-only")]
    {
        let (code, out, err) = run(&["campaign", &file, "-o", &scratch.argument(folder), more]);
        let line: serde_json::Value = serde_json::from_str(out.lines().last().unwrap()).unwrap();
        let entry = &manifest(&scratch, folder)["acquisitions"][4];
        for of in [&line, entry] {
            assert!(of["warnings"].as_u64().is_some_and(|count| count > 0), "{of}");
            assert!(of["first_warning"].as_str().unwrap().starts_with("nothing is in view"), "{of}");
        }
        assert!(code == 0 && err.contains("of 5 have warnings"), "{err}");
    }
}

/// What is not made from the same is made again; what people do to the folder is made good.
#[test]
fn what_has_changed_is_made_again() {
    let scratch = scratch();
    assert_eq!(made(&scratch, "out", &[]).0, 0);
    let before = tree(&scratch.join("out"));
    // An entry alone.
    scratch.edit("campaign.toml", "offset_s = 100.0", "offset_s = 101.0");
    let (_, lines, _) = made(&scratch, "out", &[]);
    assert_eq!(lines.iter().map(|(_, state)| state.as_str()).collect::<Vec<_>>(), ["kept", "kept", "kept", "done"]);
    scratch.edit("campaign.toml", "offset_s = 101.0", "offset_s = 100.0");
    // The mesh, of which the scene says only the name.
    scratch.edit("moon.mtl", "newmtl grey", "# as before\nnewmtl grey");
    let (_, lines, _) = made(&scratch, "out", &["--coverage-only"]);
    assert_eq!(states(&lines, "done"), 4);
    // Products are those of the mesh before, and no part of the campaign any more.
    assert!(manifest(&scratch, "out")["acquisitions"][0]["product"].is_null());
    scratch.edit("moon.mtl", "# as before\n", "");
    // All that people can do to it.
    let product = scratch.join("out/products/site");
    std::fs::write(scratch.join("out/manifest.json"), "{ not ours").unwrap();
    std::fs::write(product.join("cube.img"), "short").unwrap();
    std::fs::remove_file(scratch.join(&format!("out/products/{}/backplanes.hdr", NAMES[0]))).unwrap();
    std::fs::write(scratch.join(&format!("out/sights/{}.npz", NAMES[1])), "PK").unwrap();
    std::fs::remove_file(scratch.join(&format!("out/products/{}/quicklook.png", NAMES[1]))).unwrap();
    std::fs::write(scratch.join(&format!("out/products/{}/exposures.csv", NAMES[2])), "part").unwrap();
    std::fs::create_dir_all(scratch.join("out/failed")).unwrap();
    std::fs::write(scratch.join("out/failed/site.json"), "?").unwrap();
    let (code, lines, err) = made(&scratch, "out", &[]);
    assert_eq!((code, states(&lines, "done")), (0, 4), "{err}");
    let after = tree(&scratch.join("out"));
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
    assert!(before == after);
    // How products are written is one of the things they depend on; what is seen does not.
    scratch.write("campaign.toml", format!("{CAMPAIGN}[output]\ndtype = \"f64\"\n"));
    let sights = std::fs::metadata(scratch.join("out/sights/site.npz")).unwrap().modified().unwrap();
    assert_eq!(states(&made(&scratch, "out", &[]).1, "done"), 4);
    assert_eq!(std::fs::metadata(product.join("cube.img")).unwrap().len(), 6 * 6 * 2 * 8);
    assert_eq!(std::fs::metadata(scratch.join("out/sights/site.npz")).unwrap().modified().unwrap(), sights);
    // They are kept in whatever format they are.
    for (formats, there) in
        [("[\"netcdf\"]", "cube.nc"), ("[\"zarr\", \"pds4\"]", "cube.xml"), ("[\"fits\"]", "cube.fits")]
    {
        scratch.write("campaign.toml", format!("{CAMPAIGN}[output]\nformats = {formats}\n"));
        for state in ["done", "kept"] {
            let (code, lines, err) = made(&scratch, "out", &[]);
            assert!(code == 0 && states(&lines, state) == 4, "{formats}: {err}");
        }
        assert!(product.join(there).exists(), "{formats}");
        assert_eq!(manifest(&scratch, "out")["acquisitions"].as_array().unwrap().len(), 4);
    }
    // A product of another command is nobody's to replace.
    std::fs::remove_dir_all(&product).unwrap();
    let (scene, folder) = (scratch.argument("scene.toml"), product.to_str().unwrap().to_owned());
    assert_eq!(run(&["-q", "simulate", &scene, "-o", &folder]).0, 0);
    let (code, lines, _) = made(&scratch, "out", &[]);
    assert_eq!((code, states(&lines, "failed"), states(&lines, "kept")), (1, 1, 3));
}

/// A product of a campaign is of its own moment and camera, which its scene file does not say.
#[test]
fn a_product_is_mapped_by_its_campaign() {
    let scratch = scratch();
    assert_eq!(made(&scratch, "out", &[]).0, 0);
    let [product, map, campaign] = ["out/products/site", "map", "campaign.toml"].map(|name| scratch.argument(name));
    let (code, _, err) = run(&["locate", &product, "--ortho", "plate-carree:0.5", "-o", &map]);
    assert!(code != 0 && err.contains("--campaign"), "{err}");
    let ortho = ["locate", &product, "--ortho", "plate-carree:0.5", "-o", &map, "--campaign", &campaign];
    let (code, _, err) = run(&ortho);
    assert_eq!(code, 0, "{err}");
    // What the image shows lies about what it looks at.
    let header = std::fs::read_to_string(scratch.join("map/ortho.hdr")).unwrap();
    let info = header.lines().find(|line| line.starts_with("map info")).unwrap();
    let numbers: Vec<f64> = info.split([',', '{', '}']).filter_map(|part| part.trim().parse().ok()).collect();
    let [west, north] = [numbers[2], numbers[3]];
    assert!((west - 10.0).abs() < 20.0 && (north - 5.0).abs() < 20.0, "{info}");
}

/// What cannot be made does not stop the others, is told at the place that asks for it, and is tried again.
#[test]
fn one_that_fails_is_told_and_the_others_are_made() {
    let scratch = scratch();
    let never = "[[acquisitions]]\nname = \"never\"\nepoch = \"2040-05-01T00:00:00 TDB\"\n";
    scratch.write("campaign.toml", CAMPAIGN.replacen("[[acquisitions]]", &format!("{never}[[acquisitions]]"), 1));
    let (code, lines, err) = made(&scratch, "out", &[]);
    assert_eq!((code, states(&lines, "done"), states(&lines, "failed")), (1, 4, 1), "{err}");
    let entry = &manifest(&scratch, "out")["acquisitions"][0];
    assert_eq!((entry["name"].as_str(), entry["state"].as_str()), (Some("never"), Some("failed")));
    let why = entry["errors"][0].as_str().unwrap();
    assert!(why.contains("campaign.toml:5:9") && why.contains("2040-05-01"), "{why}");
    assert!(scratch.join("out/failed/never.json").is_file() && !scratch.join("out/products/never").exists());
    // Parts know of one another's failures, and each answers for its own.
    for (part, code, elsewhere) in [("1/2", 1, false), ("2/2", 0, true)] {
        let (found, _, err) = made(&scratch, "parts", &["--shard", part]);
        assert!(found == code && err.contains("1 failed in other shards") == elsewhere, "{part}: {found} {err}");
    }
    same_trees(&scratch, "out", "parts");
    scratch.edit("campaign.toml", "2040-05-01T00:00:00", "2027-05-01T09:00:00");
    let (code, lines, _) = made(&scratch, "out", &[]);
    assert_eq!((code, states(&lines, "done"), states(&lines, "kept")), (0, 1, 4));
    assert!(!scratch.join("out/failed").exists());
    // One that is no longer asked for stays, and is named.
    scratch.edit("campaign.toml", "name = \"never\"", "name = \"again\"");
    assert!(made(&scratch, "out", &["--coverage-only"]).2.contains("products/never belongs to no acquisition"));
}

#[test]
fn mistakes_are_told_where_they_are() {
    let scratch = scratch();
    let site = "offset_s = 100.0\nlatitude_deg = 5.0\nlongitude_deg = 10.0";
    let cases: [(&[(&str, &str)], &str); 19] = [
        (&[("scene = \"scene.toml\"\n", "")], "`scene` is missing"),
        (
            &[("every_s = 1800.0", "evry_s = 1800.0")],
            "campaign.toml:7:1 acquisitions[0].evry_s: unknown key `evry_s` (help: did you mean `every_s`?)",
        ),
        (&[("mmxrt_campaign = 1", "mmxrt_campaign = 2")], "campaign.toml:1:18 mmxrt_campaign: 2 is more than 1"),
        (&[("scene.toml", "none.toml")], "campaign.toml:2:9 scene: "),
        (&[("05:00:00", "07:00:00")], "campaign.toml:6:8 acquisitions[0].stop: is before `start`"),
        (&[("1800.0", "0.0")], "campaign.toml:7:11 acquisitions[0].every_s: 0 is not more than 0"),
        (&[("1800.0", "1e-6")], "acquisitions; a campaign has at most 1000000 (help: give a longer step"),
        (
            &[("1800.0", "1e-4"), ("T05:00:00", "T05:59:59.9999"), ("T06:00:00", "T06:00:00.0002")],
            "campaign.toml:5:9 acquisitions[0].start: duplicate acquisition name map_2027-05-01T06-00-00.000",
        ),
        (
            &[("every_s = 1800.0\n", "")],
            "campaign.toml:3:1 acquisitions[0]: must give its time in exactly one way (help: give one of: `epoch`",
        ),
        (
            &[("name = \"site\"", "name = \"Map_2027-05-01T05-30-00.000\"")],
            "campaign.toml:9:8 acquisitions[1].name: duplicate acquisition name",
        ),
        (&[("name = \"site\"", "name = \"../site\"")], "campaign.toml:9:8 acquisitions[1].name: \"../site\" begins"),
        (
            &[(site, "epochs = [\"2027-05-01T06:00:00 UTC\", \"2027-05-01T06:00:00 UTC\"]")],
            "campaign.toml:10:38 acquisitions[1].epochs[1]: is not later",
        ),
        (&[(site, "epochs = []")], "expected a list of at least 1, found 0"),
        (&[(site, "epoch = \"2027-05-01 06:00\"")], "campaign.toml:10:9 acquisitions[1].epoch: "),
        (&[("longitude_deg = 10.0", "target_m = [1.0, 2.0, 3.0]")], "must give its target in exactly one way"),
        (
            &[("longitude_deg = 10.0", "longitude_deg = 10.0\npointing = { target_m = [0.0, 0.0, 1.0] }")],
            "campaign.toml:13:12 acquisitions[1].pointing: conflicts with the target",
        ),
        (
            &[("longitude_deg = 10.0", "longitude_deg = 10.0\n[coverage]\nwithin_m = [5.0, 5.0]")],
            "campaign.toml:14:18 coverage.within_m[1]: ",
        ),
        (
            &[("longitude_deg = 10.0", "longitude_deg = 10.0\n[output]\nmodel = \"sunlite\"")],
            "campaign.toml:14:9 output.model: \"sunlite\" is not a model",
        ),
        (
            &[("longitude_deg = 10.0", "longitude_deg = 10.0\n[output]\ndtype = \"f16\"")],
            "expected \"f32\" or \"f64\", found \"f16\"",
        ),
    ];
    for (edits, expected) in cases {
        scratch.write("campaign.toml", replaced(CAMPAIGN, edits));
        let (code, lines, err) = made(&scratch, "out", &["--json"]);
        let error: serde_json::Value = serde_json::from_str(&err).unwrap_or_else(|_| panic!("{expected}: {err}"));
        let told = error["error"]["message"].as_str().unwrap();
        assert!(code == 1 && lines.is_empty() && told.contains(expected), "{expected}\n{told}");
        assert!(!scratch.join("out").exists());
    }
    // What only one acquisition needs fails alone, where it is asked for.
    for (change, expected) in [
        ("files = [\"none.oem\"]", "campaign.toml:13:10 acquisitions[1].files[0]: "),
        ("orbit = \"qso-20x99\"", "campaign.toml:13:9 acquisitions[1].orbit: "),
        ("spacecraft = \"MMX\"", "campaign.toml:10:12 acquisitions[1].offset_s: "),
        (
            "sensor = { samples = 4, lines = 4, fit = \"scene\", bands = { centres_um = [1.0] } }",
            "acquisitions[1].sensor.fit: `fit` would change the field of view",
        ),
        (
            "sensor = { samples = 4, lines = 4, ifov_mrad = 1.0, bands = { centres_um = [-1.0] } }",
            "campaign.toml:13:77 acquisitions[1].sensor.bands.centres_um[0]: ",
        ),
    ] {
        scratch.write("campaign.toml", format!("{CAMPAIGN}{change}\n"));
        let (code, lines, err) = made(&scratch, "failing", &["--coverage-only"]);
        assert!(code == 1 && states(&lines, "failed") == 1 && lines[3].1 == "failed", "{change}: {err}");
        let why = manifest(&scratch, "failing")["acquisitions"][3]["errors"][0].to_string();
        assert!(why.contains(&expected.replace('"', "\\\"")), "{expected}\n{why}");
    }
    scratch.write("campaign.toml", CAMPAIGN);
    // The folder.
    let file = scratch.argument("campaign.toml");
    let (code, _, err) = run(&["campaign", &file]);
    assert!(code == 1 && err.contains("output.folder") && err.contains("--output FOLDER"), "{err}");
    std::fs::create_dir(scratch.join("full")).unwrap();
    scratch.write("full/letters.txt", "");
    for (folder, expected) in [("scene.toml", "is a file"), ("full", "holds something else than a campaign")] {
        let (code, _, err) = made(&scratch, folder, &[]);
        assert!(code == 1 && err.contains(expected), "{err}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(scratch.join("nowhere"), scratch.join("dangling")).unwrap();
        let (code, _, err) = made(&scratch, "dangling", &[]);
        assert!(code == 1 && err.contains("is a link to nothing"), "{err}");
    }
    // The campaign lies where its products go.
    std::fs::create_dir_all(scratch.join("in/products/x")).unwrap();
    let inside = scratch.argument("in/products/x/campaign.toml");
    std::fs::write(&inside, CAMPAIGN.replace("scene.toml", "../../../scene.toml")).unwrap();
    let (code, _, err) = run(&["campaign", &inside, "-o", &scratch.argument("in")]);
    assert!(code == 1 && err.contains("products: would be replaced, but"), "{err}");
    // Other commands and other files say which is which.
    let (code, _, err) = run(&["simulate", &file, "-o", &scratch.argument("x")]);
    assert!(code == 1 && err.contains("is a campaign: `mmxrt campaign` takes it"), "{err}");
    let (code, _, err) = run(&["campaign", &scratch.argument("scene.toml"), "-o", &scratch.argument("x")]);
    assert!(code == 1 && err.contains("is a scene file"), "{err}");
    scratch.write("scene.toml", replaced(SCENE, &[("[flight]\nepoch = \"2027-05-01T06:00:00 UTC\"\norbit = \"qso-20x27\"", "[sun]\nposition_m = [2e11, 0.0, 0.0]\n[observer]\nposition_m = [2e4, 0.0, 0.0]\ntarget_m = [0.0, 0.0, 0.0]\nup = [0.0, 0.0, 1.0]")]));
    let (code, _, err) = run(&["campaign", &file, "-o", &scratch.argument("x")]);
    assert!(code == 1 && err.contains("has no table `flight`"), "{err}");
}

/// A point that one look of a pair shows is in the other one too, where the camera that has moved on sees it.
#[test]
fn a_point_is_found_in_both_looks_of_a_pair() {
    let scratch = scratch();
    let pair = "mmxrt_campaign = 1\nscene = \"scene.toml\"\n[[acquisitions]]\nname = \"a\"\noffset_s = 0\n[[acquisitions]]\nname = \"b\"\noffset_s = 200\n";
    let file = scratch.write("pair.toml", pair).to_str().unwrap().to_owned();
    let ask = |name: &str, what: &str, of: &str| -> Vec<String> {
        let (code, out, err) = run(&["locate", &file, "--acquisition", name, &format!("--{what}={of}")]);
        assert_eq!(code, 0, "{err}");
        out.lines().last().unwrap().split(',').map(str::to_owned).collect()
    };
    let ground = ask("a", "pixel", "2.5,3.5");
    let place = |row: &[String]| [0, 1].map(|k| row[k].parse::<f64>().unwrap());
    let [a, b] = ["a", "b"].map(|name| ask(name, "ground", &ground[4..7].join(",")));
    assert!((place(&a)[0] - 2.5).abs() < 1e-6 && (place(&a)[1] - 3.5).abs() < 1e-6);
    assert_eq!((a[12].as_str(), b[12].as_str()), ("true", "true"), "{a:?} {b:?}");
    // By hand from where the camera then is: it looks at the centre, north up, through pixels of 60 mrad.
    let later = "epoch = \"2027-05-01T06:03:20 UTC\"\norbit_epoch = \"2027-05-01T06:00:00 UTC\"";
    scratch.write("later.toml", replaced(SCENE, &[("epoch = \"2027-05-01T06:00:00 UTC\"", later)]));
    let scene = scene_toml::read(&scratch.join("later.toml"), &unwatched).unwrap().scene;
    let from_m = scene.exposure.camera.centre_m();
    let to = DVec3::from_array([4, 5, 6].map(|k| ground[k].parse().unwrap())) - from_m;
    let boresight = -from_m.normalize();
    let right = boresight.cross(DVec3::Z).normalize();
    let pixels = |axis: DVec3| 3.0 + to.dot(axis) / to.dot(boresight) / (2.0 * 0.03_f64.tan());
    let expected = [pixels(right), pixels(boresight.cross(right))];
    let off = [0, 1].map(|k| (place(&b)[k] - expected[k]).abs());
    assert!(off.iter().all(|off| *off < 1e-6), "{expected:?} {b:?}");
    assert!((place(&b)[0] - 2.5).abs() > 0.5, "{b:?}");
    let (code, _, err) = run(&["locate", &file, "--acquisition", "c", "--pixel=1,1"]);
    assert!(
        code == 1 && err.contains("there is no acquisition called \"c\"") && err.contains("acquisitions: a, b"),
        "{err}"
    );
}

/// Memory does not grow with the number of acquisitions: the most of a process, kB.
#[cfg(target_os = "linux")]
#[test]
fn memory_is_that_of_one_acquisition() {
    let scratch = Scratch::new();
    let (facets, count, bands) = if is_heavy() { (5, 1000, 10) } else { (4, 24, 2) };
    scratch.obj("moon", &sphere([0.0; 3], 11_000.0, facets), &[("grey", None)]);
    let edits: &[(&str, &str)] =
        &[("samples = 6\nlines = 6\nifov_mrad = 60.0", "samples = 64\nlines = 64\nifov_mrad = 15.0")];
    let centres: Vec<String> = (0..bands).map(|i| format!("{:.1}", 1.0 + 0.1 * f64::from(i))).collect();
    scratch.write(
        "scene.toml",
        replaced(&replaced(SCENE, edits), &[("[1.0, 2.0]", &format!("[{}]", centres.join(", ")))]),
    );
    let most_kb = |count: u32, folder: &str| {
        let stop_s = f64::from(count - 1) * 60.0;
        scratch.write(
            "campaign.toml",
            format!(
                "mmxrt_campaign = 1\nscene = \"scene.toml\"\n[[acquisitions]]\nname = \"m\"\nstart = \"2027-05-01T00:00:00 UTC\"\nstop = \"2027-05-01T{:02}:{:02}:00 UTC\"\nevery_s = 60.0\n",
                (stop_s / 3600.0).floor(),
                (stop_s / 60.0) % 60.0
            ),
        );
        let mut command = mmxrt();
        command.args(["-q", "campaign", &scratch.argument("campaign.toml"), "-o", &scratch.argument(folder)]);
        if !is_heavy() {
            command.arg("--coverage-only");
        }
        let mut child = command.args(["--threads", "1"]).spawn().unwrap();
        let status = format!("/proc/{}/status", child.id());
        let mut most = 0_u64;
        while child.try_wait().unwrap().is_none() {
            let text = std::fs::read_to_string(&status).unwrap_or_default();
            let peak = text
                .lines()
                .find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.trim().parse().ok());
            most = most.max(peak.unwrap_or(0));
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(child.wait().unwrap().success());
        most
    };
    let (few, many) = (most_kb(3, "few"), most_kb(count, "many"));
    assert!(few > 1000 && many < few + few / 5, "{few} kB for 3, {many} kB for {count}");
}

/// What a process holds at most, bytes, as Linux tells it; 0 where nobody does.
fn most_held(child: &std::process::Child) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok()).map_or(0, |kib| kib << 10)
}

/// A thousand acquisitions of a site of 20 000 facets take no more memory than forty, and killed five times they become the same files.
#[test]
fn a_thousand_acquisitions_take_the_memory_of_a_few() {
    let (few, all) = (40, 1000);
    if !is_heavy() {
        return;
    }
    let scratch = Scratch::new();
    let mesh = (
        "file = \"moon.obj\"\ncoordinates = \"body\"",
        "recipe = { version = 1, seed = 1, facets = 20_000 }\npose = \"radial\"",
    );
    let edits = [
        mesh,
        ("origin_m = [0.0, 0.0, 0.0]", "origin_m = [-2743.5946, 11860.0360, 0.51269]"),
        ("grey = { reflectance = 0.07 }", "phobos_blue = { reflectance = 0.07 }\nphobos_red = { reflectance = 0.05 }"),
        ("T06:00:00 UTC\"", "T06:37:30 UTC\"\norbit_epoch = \"2027-05-01T03:50:34 UTC\""),
        ("orbit = \"qso-20x27\"", "orbit = \"qso-20x27\"\npointing = { target_m = [-2743.5946, 11860.0360, 0.51269] }"),
        ("samples = 6\nlines = 6\nifov_mrad = 60.0", "samples = 64\nlines = 64\nifov_mrad = 2.0"),
        ("{ centres_um = [1.0, 2.0] }", "{ start_um = 1.0, stop_um = 3.4, count = 10 }"),
    ];
    scratch.write("scene.toml", replaced(SCENE, &edits));
    let write = |count: u32| {
        let last_s = count - 1;
        let stop = format!("06:{:02}:{:02}", 30 + last_s / 60, last_s % 60);
        let series = format!(
            "name = \"a\"\nstart = \"2027-05-01T06:30:00 UTC\"\nstop = \"2027-05-01T{stop} UTC\"\nevery_s = 1.0\n[output]\nmodel = \"sunlight\"\n"
        );
        scratch
            .write("campaign.toml", format!("mmxrt_campaign = 1\nscene = \"scene.toml\"\n[[acquisitions]]\n{series}"));
    };
    let start = |folder: &str| {
        let arguments = ["-q", "campaign", &scratch.argument("campaign.toml"), "-o", &scratch.argument(folder)];
        mmxrt().args(arguments).stdout(Stdio::null()).spawn().unwrap()
    };
    let watched = |folder: &str| {
        let (mut child, mut most) = (start(folder), 0);
        while child.try_wait().unwrap().is_none() {
            most = most.max(most_held(&child));
            std::thread::sleep(Duration::from_millis(20));
        }
        assert!(child.wait().unwrap().success());
        most
    };
    write(few);
    let of_few = watched("few");
    write(all);
    let began = Instant::now();
    let of_all = watched("whole");
    let whole_us = began.elapsed().as_micros() as u64;
    println!("{all} acquisitions: {} s, {} MiB; {few}: {} MiB", whole_us / 1_000_000, of_all >> 20, of_few >> 20);
    // Names and moments of all, and what allocators keep.
    assert!(of_all < of_few + (16 << 20), "{of_all} {of_few}");
    let mut random = Random(11);
    for _ in 0..5 {
        let mut child = start("cut");
        std::thread::sleep(Duration::from_micros(random.bits() % (whole_us / 4)));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(start("cut").wait().unwrap().success());
    // One by one: together they take gigabytes.
    let names = |folder: &str| {
        let (top, mut names, mut folders) = (scratch.join(folder), vec![], vec![scratch.join(folder)]);
        while let Some(folder) = folders.pop() {
            for entry in folder.read_dir().unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() { folders.push(path) } else { names.push(path.strip_prefix(&top).unwrap().to_owned()) }
            }
        }
        names.sort();
        names
    };
    let files = names("whole");
    assert_eq!(files, names("cut"));
    assert_eq!(files.iter().filter(|name| name.ends_with("cube.img")).count(), all as usize);
    for name in files.iter().filter(|name| !name.ends_with("run.json")) {
        let [a, b] = ["whole", "cut"].map(|folder| std::fs::read(scratch.join(folder).join(name)).unwrap());
        assert!(a == b, "{}", name.display());
    }
}

#[test]
fn its_scene_is_set_and_kept_prepared() {
    let scratch = scratch();
    let cache = scratch.argument("cache");
    let (code, lines, err) = made(&scratch, "plain", &[]);
    assert!(code == 0 && states(&lines, "done") == NAMES.len(), "{err}");
    // Twice from a cache, the second time with nothing left to make.
    let (code, lines, _) = made(&scratch, "cached", &["--cache", &cache]);
    assert!(code == 0 && states(&lines, "done") == NAMES.len());
    let kinds: Vec<String> = std::fs::read_dir(&cache)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter_map(|path| Some(path.extension()?.to_string_lossy().into_owned()))
        .collect();
    for kind in ["mesh", "topology", "tree"] {
        assert!(kinds.iter().any(|of| of == kind), "{kind}: {kinds:?}");
    }
    let (_, lines, _) = made(&scratch, "plain", &["--cache", &cache]);
    assert_eq!(states(&lines, "kept"), NAMES.len());
    let bytes = |folder: &str, name: &str, file: &str| {
        std::fs::read(scratch.join(folder).join("products").join(name).join(file)).unwrap()
    };
    for name in NAMES {
        for file in ["cube.img", "backplanes.img", "report.json"] {
            assert!(bytes("plain", name, file) == bytes("cached", name, file), "{name}/{file}");
        }
    }
    // Other settings are other acquisitions.
    let (code, lines, err) = made(&scratch, "plain", &["--set", "sensor.samples=5"]);
    assert_eq!(states(&lines, "kept"), 0, "{code} {err}");
    let (code, lines, err) = made(&scratch, "set", &["--set", "sensor.samples=5"]);
    assert!(code == 0 && states(&lines, "done") == NAMES.len(), "{err}");
    assert_eq!(bytes("set", "site", "cube.img").len(), 5 * 6 * 2 * 4);
    let report: serde_json::Value = serde_json::from_slice(&bytes("set", "site", "report.json")).unwrap();
    assert_eq!(report["settings"], serde_json::json!(["sensor.samples=5"]));
    // Its image is mapped by the same settings.
    let (product, campaign, map) =
        (scratch.argument("set/products/site"), scratch.argument("campaign.toml"), scratch.argument("map"));
    let (code, _, err) =
        run(&["locate", &product, "--campaign", &campaign, "--ortho", "plate-carree:1", "-o", &map, "--quiet"]);
    assert_eq!(code, 0, "{err}");
}
