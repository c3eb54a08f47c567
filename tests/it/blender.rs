//! The add-on for Blender: its modules that need no Blender, and that what they write is what this program reads.
//!
//! What needs Blender is `adapters/blender/test_in_blender.sh`.

use std::path::Path;
use std::process::Command;

use crate::scratch::Scratch;

#[test]
fn what_needs_no_blender_of_the_add_on_works() {
    let python = std::env::var("MMXRT_TEST_PYTHON").unwrap_or_else(|_| "python3".into());
    let has = |module: &str| {
        Command::new(&python).args(["-c", &format!("import {module}")]).output().is_ok_and(|o| o.status.success())
    };
    if !has("unittest") {
        println!("SKIPPED: {python} is no Python 3");
        return;
    }
    if !has("numpy") {
        println!("SKIPPED: {python} has no numpy: only camera, TOML and program of the add-on are tried");
    }
    let test = Path::new(env!("CARGO_MANIFEST_DIR")).join("adapters/blender/test_pure.py");
    let run = Command::new(&python)
        .arg(test)
        .env("MMXRT", env!("CARGO_BIN_EXE_mmxrt"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// A program in the stead of Blender, which does as this script says; `$out` and `$stem` are where to export to.
#[cfg(unix)]
fn stand_in(scratch: &Scratch, script: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let head = "#!/bin/sh\nwhile [ \"$1\" != -- ]; do case \"$1\" in --python) headless=$2;; esac; shift; done\nout=$2; stem=$3\n";
    let path = scratch.write("blender", format!("{head}{script}\n"));
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    scratch.argument("blender")
}

/// What the add-on would export of a scene with one triangle.
const EXPORTS: &str = "mkdir \"$out\"\n\
    printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nusemtl a\\nf 1 2 3\\n' > \"$out/$stem.obj\"\n\
    printf 'x_m,y_m,z_m\\n1,2,3\\n4,5,6\\n' > \"$out/$stem.rock.csv\"\n\
    cat > \"$out/$stem.toml\" <<EOF\n\
    mmxrt_scene = 1\norigin_m = [1.5, 0, 0]\n[[mesh]]\nfile = \"$stem.obj\"\ninstances = \"$stem.rock.csv\"\n[materials]\na = { reflectance = 0.25 }\n\
    [sun]\ndirection = [0, 0, 1]\nirradiance = 1.0\n[observer]\nposition_m = [0, 0, 99]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
    [sensor]\nsamples = 4\nlines = 4\nfov_deg = 20\nbands = { centres_um = [1.0] }\nEOF\n\
    [ -f \"$(dirname \"$headless\")/gather.py\" ] || exit 1\n\
    printf 'Blender 9.9\\nMMXRT\\tNOTE\\tdropped\\tworld\\tits light\\nMMXRT\\tDONE\\n'";

/// Runs mmxrt, whose folders for a while are made in `scratch`, and sees to it that none is left.
#[cfg(unix)]
fn run(scratch: &Scratch, arguments: &[&str]) -> (i32, String, String) {
    let temporary = scratch.join("temporary");
    std::fs::create_dir_all(&temporary).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_mmxrt")).args(arguments).env("TMPDIR", &temporary).output().unwrap();
    assert_eq!(temporary.read_dir().unwrap().count(), 0, "{arguments:?}");
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
#[cfg(unix)]
fn files_of_blender_become_scenes_and_meshes_by_blender() {
    let scratch = Scratch::new();
    let blend = scratch.write("a scene.blend", "BLENDER-v304").into_os_string().into_string().unwrap();
    let blender = stand_in(&scratch, EXPORTS);
    let convert = |to: &str, more: &[&str]| {
        let to = scratch.argument(to);
        run(&scratch, &[&["convert", &blend, &to, "--blender", &blender][..], more].concat())
    };
    let (code, out, err) = convert("site/one.toml", &[]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("world: its light") && out.contains("2 facets, blend to scene"), "{out}");
    // Its files, with instances as they are.
    let mut names: Vec<_> = scratch.join("site").read_dir().unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["one.obj", "one.rock.csv", "one.toml"]);
    let (code, _, err) = run(&scratch, &["inspect", &scratch.argument("site/one.toml")]);
    assert_eq!(code, 0, "{err}");
    // A folder is replaced as any scene's is.
    for more in [&["--to", "scene"][..], &["--to", "scene", "--force"]] {
        assert_eq!(convert("folder", more).0, 0);
    }
    assert!(scratch.join("folder/scene.rock.csv").is_file());
    assert_eq!(convert("folder", &["--to", "scene"]).0, 1);
    // A mesh, for which the scene is only on the way.
    let (code, out, err) = convert("a.glb", &[]);
    assert!(code == 0 && out.contains("blend to glb"), "{out}{err}");
    let (surface, ..) = mmxrt::formats::gltf::read(&scratch.join("a.glb"), false).unwrap();
    assert_eq!((surface.mesh.facets.len(), surface.origin_m), (2, Some(glam::DVec3::new(1.5, 0.0, 0.0))));
    // A loss forbids to write.
    assert_eq!(convert("strict.toml", &["--strict"]).0, 3);
    assert!(!scratch.join("strict.toml").exists());
}

#[test]
#[cfg(unix)]
fn what_keeps_blender_from_exporting_is_told() {
    let scratch = Scratch::new();
    let blend = scratch.write("a.blend", "BLENDER-v304").into_os_string().into_string().unwrap();
    let out = scratch.argument("out.toml");
    let refused = |blender: &str| {
        let (code, _, err) = run(&scratch, &["convert", &blend, &out, "--blender", blender]);
        assert_eq!(code, 1, "{err}");
        assert!(!scratch.join("out.toml").exists() && err.contains("a.blend"), "{err}");
        err
    };
    let err = refused(&scratch.argument("nowhere"));
    assert!(err.contains("cannot be run") && err.contains("--blender PATH"), "{err}");
    let err = refused(&stand_in(&scratch, "printf 'MMXRT\\tERROR\\tthe scene has no camera\\n'; exit 1"));
    assert!(err.contains("cannot be exported: the scene has no camera"), "{err}");
    let err = refused(&stand_in(&scratch, "echo 'Error: File format is not supported' >&2"));
    assert!(err.contains("its last words: Error: File format is not supported"), "{err}");
    // What it says to have done and has not; and a scene that this program refuses, whose item is told, not where it was.
    refused(&stand_in(&scratch, "printf 'MMXRT\\tDONE\\n'"));
    let err = refused(&stand_in(&scratch, &EXPORTS.replace("reflectance = 0.25", "reflectance = 7")));
    assert!(err.contains("materials.a.reflectance") && !err.contains("mmxrt-blend"), "{err}");
    // An option for files of Blender alone.
    scratch.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let (code, _, err) =
        run(&scratch, &["convert", &scratch.argument("t.obj"), &scratch.argument("t.glb"), "--blender", "x"]);
    assert!(code == 1 && err.contains("--blender"), "{err}");
    let (code, _, err) = run(&scratch, &["convert", &scratch.argument("nowhere.blend"), &out]);
    assert!(code == 1 && err.contains("nowhere.blend"), "{err}");
}
