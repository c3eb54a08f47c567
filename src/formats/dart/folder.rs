//! Where the files of a simulation lie, and which of them an input may name.

use std::path::{Component, Path, PathBuf};

use crate::error::{Location, Problem};

/// A simulation's folders.
#[derive(Debug, Clone)]
pub struct Folder {
    /// The folder of the eleven input files.
    pub input: PathBuf,
    /// The simulation's folder, around `input/`; that of the input files where it is not called so.
    pub simulation: PathBuf,
    /// A folder of databases that inputs may also name files of.
    pub database: Option<PathBuf>,
    /// Inputs may name files anywhere.
    pub allow_outside: bool,
}

impl Folder {
    /// The folders of a simulation, from its own path or that of its `input/`.
    pub fn new(path: &Path, database: Option<&Path>, allow_outside: bool) -> Self {
        let below = path.join("input");
        let (simulation, input) = if below.join("maket.xml").is_file() {
            (path.to_owned(), below)
        } else {
            // `input` itself has a parent that cannot be told from its text, as in "." or "..".
            let is_input = path.file_name().is_some_and(|name| name == "input");
            let parent = path.parent().filter(|p| is_input && !p.as_os_str().is_empty());
            let around = if is_input { parent.unwrap_or(Path::new(".")) } else { path };
            (around.to_owned(), path.to_owned())
        };
        Folder { input, simulation, database: database.map(Path::to_owned), allow_outside }
    }

    /// The file that an input names, or `None` if there is none.
    ///
    /// A relative name, with `/` or `\`, is looked for as DART does: in the simulation's `input/`, in that of the
    /// simulation that a sequence was made from, then among databases. `at` is where it is named.
    ///
    /// # Errors
    /// A problem at `at` if the name, or a link in the file system, leads out of the simulation's folder and the
    /// database folder, and that is not allowed.
    pub fn locate(&self, name: &str, at: &Location) -> Result<Option<PathBuf>, Problem> {
        let outside = |what: String| {
            Problem::new(at.clone(), what)
                .with_help("copy the file into the simulation's input folder and name it without its path, or allow files outside of it")
        };
        let name = name.replace('\\', "/");
        let relative = Path::new(&name);
        if name.is_empty() || name.contains('\0') {
            return Err(Problem::new(at.clone(), "the name of a file is empty or holds a NUL"));
        }
        // C:/x is a path of Windows wherever this runs.
        let is_absolute = relative.is_absolute() || name.as_bytes().get(1) == Some(&b':');
        let climbs = relative.components().any(|c| matches!(c, Component::ParentDir));
        if (is_absolute || climbs) && !self.allow_outside {
            return Err(outside(format!("`{name}` leads out of the simulation's folder")));
        }
        let mut places = vec![self.input.clone()];
        if self.allow_outside {
            // <simulation>/sequence/<name>_<i>
            places.push(self.simulation.join("../../input"));
        }
        places.extend(self.database.clone());
        if self.allow_outside {
            places.push(self.simulation.join("../../database"));
        }
        let Some(found) = places.iter().map(|place| place.join(relative)).find(|path| path.is_file()) else {
            return Ok(None);
        };
        let within = |root: &Path| {
            let root = root.canonicalize().ok();
            root.zip(found.canonicalize().ok()).is_some_and(|(root, found)| found.starts_with(root))
        };
        if self.allow_outside || within(&self.simulation) || self.database.as_deref().is_some_and(within) {
            Ok(Some(found))
        } else {
            Err(outside(format!("`{name}` is a link that leads out of the simulation's folder")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_does_not_leave_the_folder() {
        let root = std::env::temp_dir().join(format!("mmxrt-dart-folder-{}", std::process::id()));
        let (simulation, database) = (root.join("sim"), root.join("db"));
        std::fs::create_dir_all(simulation.join("input/obj")).unwrap();
        std::fs::create_dir_all(&database).unwrap();
        for file in ["sim/input/maket.xml", "sim/input/obj/a.obj", "db/x.db", "secret"] {
            std::fs::write(root.join(file), "").unwrap();
        }
        let at = Location::item("here");
        for start in [simulation.clone(), simulation.join("input")] {
            let folder = Folder::new(&start, Some(&database), false);
            assert_eq!((&folder.simulation, &folder.input), (&simulation, &simulation.join("input")));
            assert_eq!(folder.locate("obj\\a.obj", &at).unwrap().unwrap(), simulation.join("input/obj/a.obj"));
            assert_eq!(folder.locate("x.db", &at).unwrap().unwrap(), database.join("x.db"));
            assert_eq!(folder.locate("y.db", &at).unwrap(), None);
            let absolute = root.join("secret").display().to_string();
            for name in ["../../secret", "..\\..\\secret", "obj/../../../secret", &absolute, "C:\\secret", "", "a\0b"] {
                assert!(folder.locate(name, &at).is_err(), "{name}");
            }
            let open = Folder::new(&start, None, true);
            assert!(open.locate("../../secret", &at).unwrap().is_some());
            assert!(open.locate(&absolute, &at).unwrap().is_some());
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.join("secret"), simulation.join("input/link")).unwrap();
            let folder = Folder::new(&simulation, None, false);
            assert!(folder.locate("link", &at).unwrap_err().message.contains("link"));
        }
        std::fs::remove_dir_all(&root).unwrap();
    }
}
