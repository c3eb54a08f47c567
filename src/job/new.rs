//! A folder to begin with: a commented scene of some kind, and what it names.

use std::io::Write;
use std::path::Path;

use crate::error::Result;
use crate::formats::folder::{FolderKind, Staged};
use crate::formats::mtl::ObjMaterial;
use crate::formats::obj;
use crate::landscape;

/// What to begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Template {
    /// A site on Phobos from a recipe.
    Site,
    /// A whole body from a shape.
    Body,
    /// A scene for DART.
    Dart,
    /// Radiance from elsewhere.
    Map,
    /// Many looks from an orbit.
    Campaign,
}

impl Template {
    /// What to run in the folder first.
    pub fn first_command(self) -> &'static str {
        match self {
            Template::Site | Template::Body => "mmxrt simulate scene.toml -o out",
            Template::Dart => "mmxrt convert scene.toml dart_site",
            Template::Map => "mmxrt integrate scene.toml --radiance image.csv -o out",
            Template::Campaign => "mmxrt campaign campaign.toml",
        }
    }

    /// Names and texts of its files.
    fn files(self) -> Vec<(&'static str, &'static str)> {
        let ground = ("ground.csv", include_str!("templates/ground.csv"));
        let plain = ("plain.obj", include_str!("templates/plain.obj"));
        match self {
            Template::Site => vec![
                ("scene.toml", include_str!("templates/site_scene.toml")),
                ("site.toml", include_str!("templates/site.toml")),
                ground,
            ],
            Template::Body => vec![("scene.toml", include_str!("templates/body_scene.toml")), ground],
            Template::Dart => vec![("scene.toml", include_str!("templates/dart_scene.toml")), ground, plain],
            Template::Map => vec![
                ("scene.toml", include_str!("templates/map_scene.toml")),
                ("image.csv", include_str!("templates/image.csv")),
                ("image.map.toml", include_str!("templates/image.map.toml")),
                plain,
            ],
            Template::Campaign => vec![
                ("campaign.toml", include_str!("templates/campaign.toml")),
                ("scene.toml", include_str!("templates/flight_scene.toml")),
                ("ground.toml", include_str!("templates/ground.toml")),
                ground,
            ],
        }
    }
}

/// A folder that is never replaced.
const FOLDER: FolderKind = FolderKind { marks: &[], parts: &[], holds: None };

/// The shape of the body's template: 20 times the square of this many facets.
const FREQUENCY: u32 = 32;

/// Writes a folder; its files' names.
///
/// # Errors
/// Those of [`Staged::folder_of`]; [`Error::Io`](crate::Error::Io).
pub fn new(template: Template, folder: &Path) -> Result<Vec<&'static str>> {
    let staged = Staged::folder_of(&FOLDER, folder, false)?;
    let mut names = Vec::new();
    for (name, text) in template.files() {
        staged.put(&staged.path().join(name), |out| out.write_all(text.as_bytes()))?;
        names.push(name);
    }
    if template == Template::Body {
        let mesh = landscape::phobos(FREQUENCY);
        let ground = ObjMaterial { name: "ground".to_owned(), kd: None };
        staged.put(&staged.path().join("body.obj"), |out| obj::write(out, &mesh, &[ground], None))?;
        names.push("body.obj");
    }
    staged.commit()?;
    Ok(names)
}

/// Writes a folder of texts, such as manual pages: names and texts.
///
/// # Errors
/// Those of [`Staged::folder_of`]; [`Error::Io`](crate::Error::Io).
pub fn write_pages(folder: &Path, pages: &[(String, Vec<u8>)]) -> Result<()> {
    let staged = Staged::folder_of(&FOLDER, folder, false)?;
    for (name, text) in pages {
        staged.put(&staged.path().join(name), |out| out.write_all(text))?;
    }
    staged.commit()
}
