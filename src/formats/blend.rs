//! Files of Blender: what they render, by Blender itself, which runs the add-on of `adapters/blender` without a window.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::format::{Format, Holds, ending};
use crate::error::{Error, Location, Problem, Result};
use crate::progress::{Watch, tell};
use crate::report::{Fate, Report};

/// Scenes of Blender.
pub(in crate::formats) static BLEND: Format = Format {
    name: "blend",
    extensions: &["blend"],
    reads: "what Blender renders of it, by Blender (--blender): meshes, instances, materials, textures, Sun, camera",
    writes: "",
    // Most are compressed, in one of several ways.
    mark: &[],
    told: Some(|path, beginning| (ending(path) == "blend" && !beginning.is_empty()).then(|| path.to_owned())),
    holds: Holds::Blend,
};

/// The modules of the add-on that an export takes.
const MODULES: [(&str, &str); 11] = [
    ("__init__.py", include_str!("../../adapters/blender/mmxrt/__init__.py")),
    ("camera.py", include_str!("../../adapters/blender/mmxrt/camera.py")),
    ("engine.py", include_str!("../../adapters/blender/mmxrt/engine.py")),
    ("envi.py", include_str!("../../adapters/blender/mmxrt/envi.py")),
    ("gather.py", include_str!("../../adapters/blender/mmxrt/gather.py")),
    ("headless.py", include_str!("../../adapters/blender/mmxrt/headless.py")),
    ("materials.py", include_str!("../../adapters/blender/mmxrt/materials.py")),
    ("obj.py", include_str!("../../adapters/blender/mmxrt/obj.py")),
    ("program.py", include_str!("../../adapters/blender/mmxrt/program.py")),
    ("scene_toml.py", include_str!("../../adapters/blender/mmxrt/scene_toml.py")),
    ("toml_text.py", include_str!("../../adapters/blender/mmxrt/toml_text.py")),
];
/// What a line of the add-on's begins with.
const MARK: &str = "MMXRT\t";
/// Whether Blender has ended is asked so often.
const OFTEN: Duration = Duration::from_millis(20);
/// Lines of Blender's that are told where it fails without a word of the add-on's.
const TOLD: usize = 5;

/// How Blender is run.
pub(super) struct How<'a> {
    /// The program.
    pub(super) blender: &'a Path,
    /// Where the folder is made.
    pub(super) scratch: &'a Path,
    /// Whether tables and images may lie outside of the file's folder.
    pub(super) outside: bool,
}

/// The scene of a file, in a folder that goes with this value.
#[derive(Debug)]
pub(super) struct Exported {
    /// Goes with all that is in it.
    folder: PathBuf,
    /// The scene file.
    pub(super) scene: PathBuf,
    /// What was not carried over as it was.
    pub(super) report: Report,
}

impl Drop for Exported {
    fn drop(&mut self) {
        // What cannot be removed is in a folder of temporary files.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl Exported {
    /// Has Blender export a file to a new folder, as `stem.toml` and files that begin with `stem`.
    ///
    /// # Errors
    /// [`Error::Invalid`] where there is no such program, it cannot open the file, or the scene is none that can be exported; [`Error::Io`];
    /// [`Error::Interrupted`].
    pub(super) fn new(file: &Path, stem: &str, how: &How<'_>, watch: Watch<'_>) -> Result<Self> {
        // Blender opens nothing and exits well where there is no file.
        File::open(file).map_err(|e| Error::io(file, "reading", e))?;
        let folder = new_folder(how.scratch)?;
        let mut exported =
            Exported { scene: folder.join("scene").join(format!("{stem}.toml")), folder, report: Report::default() };
        let package = exported.folder.join("mmxrt");
        let writing = |path: &Path| {
            let path = path.to_owned();
            move |e| Error::io(path, "writing", e)
        };
        fs::create_dir(&package).map_err(writing(&package))?;
        for (name, text) in MODULES {
            let path = package.join(name);
            fs::write(&path, text).map_err(writing(&path))?;
        }
        let said = exported.run(file, stem, how, watch)?;
        exported.hear(file, &said)?;
        Ok(exported)
    }

    /// Runs Blender; what it said.
    fn run(
        &self,
        file: &Path,
        stem: &str,
        &How { blender, outside, .. }: &How<'_>,
        watch: Watch<'_>,
    ) -> Result<String> {
        let log = self.folder.join("said.txt");
        let logging = |e| Error::io(&log, "writing", e);
        let out = File::create(&log).map_err(logging)?;
        let mut command = Command::new(blender);
        // Scripts in the file are not run.
        command.args(["--background", "--factory-startup", "--disable-autoexec"]).arg(absolute(file));
        command.arg("--python").arg(absolute(&self.folder.join("mmxrt").join("headless.py")));
        command.arg("--").arg(absolute(&self.folder.join("scene"))).arg(stem).args(outside.then_some("outside"));
        command.env("PYTHONDONTWRITEBYTECODE", "1");
        command.stdin(Stdio::null()).stderr(out.try_clone().map_err(logging)?).stdout(out);
        let mut child = command.spawn().map_err(|e| match e.kind() {
            ErrorKind::NotFound | ErrorKind::PermissionDenied => {
                let message = format!("Blender is needed to read it, and `{}` cannot be run: {e}", blender.display());
                let help = "install Blender (Debian: apt install blender), or say where it is with --blender PATH";
                Error::Invalid(vec![Problem::new(Location::file(file), message).with_help(help)])
            }
            _ => Error::io(blender, "running", e),
        })?;
        let ended = wait(&mut child, blender, watch);
        if ended.is_err() {
            // Whatever it was about to do, nobody waits for it.
            let _ = child.kill();
            let _ = child.wait();
        }
        ended?;
        let said = fs::read(&log).map_err(|e| Error::io(&log, "reading", e))?;
        Ok(String::from_utf8_lossy(&said).into_owned())
    }

    /// Takes what the add-on said of the export.
    fn hear(&mut self, file: &Path, said: &str) -> Result<()> {
        let mut done = false;
        for line in said.lines().filter_map(|line| line.strip_prefix(MARK)) {
            let words: Vec<&str> = line.split('\t').collect();
            match words[..] {
                ["DONE"] => done = true,
                ["NOTE", fate, what, why] => {
                    let fate = match fate {
                        "dropped" => Fate::Dropped,
                        "defaulted" => Fate::Defaulted,
                        _ => Fate::Approximated,
                    };
                    self.report.note(fate, Location::file(file).with_item(what), why);
                }
                ["ERROR", ref why @ ..] => {
                    return Err(Error::invalid(Location::file(file), format!("cannot be exported: {}", why.join(" "))));
                }
                _ => {}
            }
        }
        if done && self.scene.is_file() {
            return Ok(());
        }
        let lines: Vec<&str> = said.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        let last = lines[lines.len().saturating_sub(TOLD)..].join("; ");
        let message = format!("Blender ended without having exported it; its last words: {last}");
        Err(Error::invalid(Location::file(file), message))
    }
}

/// Waits until a process has ended.
fn wait(child: &mut Child, blender: &Path, watch: Watch<'_>) -> Result<()> {
    loop {
        tell(watch, "exporting by Blender", 0, 1)?;
        match child.try_wait() {
            Ok(Some(_)) => return tell(watch, "exporting by Blender", 1, 1),
            Ok(None) => sleep(OFTEN),
            Err(e) => return Err(Error::io(blender, "running", e)),
        }
    }
}

/// A folder that was not there before.
fn new_folder(scratch: &Path) -> Result<PathBuf> {
    const ATTEMPTS: u32 = 10_000;
    for number in 0..ATTEMPTS {
        let folder = scratch.join(format!("mmxrt-blend-{}-{number}", std::process::id()));
        match fs::create_dir(&folder) {
            Ok(()) => return Ok(folder),
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
            Err(e) => return Err(Error::io(folder, "making this folder", e)),
        }
    }
    Err(Error::io(scratch, "making a folder in it", ErrorKind::AlreadyExists.into()))
}

/// A path that means the same in another program, whose arguments may begin with a dash.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
