//! A scene becomes a facet table, and on request the radiance of its facets.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::formats::Subject;
use crate::formats::folder::Staged;
use crate::formats::npz::{self, FacetsSeen, RadianceOfFacets};
use crate::geometry::Direction;
use crate::product::FacetTable;
use crate::progress::{Watch, tell};
use crate::scene::Scene;
use crate::solve::{self as solver, FacetRadiance, Observer};
use crate::study::{self, Request};

/// Towards whom the radiance of facets is asked for, as a user says it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Towards {
    /// The scene's own camera.
    Camera,
    /// A place in the body-fixed frame, m, as `position_m` of an observer.
    At(DVec3),
    /// A direction in the body-fixed frame, in which the observer is far away.
    Afar(Direction),
}

impl FromStr for Towards {
    type Err = String;

    /// `camera`, `at:X,Y,Z` or `towards:X,Y,Z`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let help = "give camera, at:X,Y,Z (body-fixed, m), or towards:X,Y,Z (a direction, body-fixed)";
        let numbers = |list: &str| -> Option<DVec3> {
            let numbers: Vec<f64> = list.split(',').map(|x| x.trim().parse().ok()).collect::<Option<_>>()?;
            let [x, y, z] = numbers[..] else { return None };
            Some(DVec3::new(x, y, z)).filter(|v| v.is_finite())
        };
        let found = match text.split_once(':') {
            None if text == "camera" => Some(Towards::Camera),
            Some(("at", list)) => numbers(list).map(Towards::At),
            Some(("towards", list)) => numbers(list).and_then(Direction::new).map(Towards::Afar),
            _ => None,
        };
        found.ok_or_else(|| format!("{text:?} is not an observer: {help}"))
    }
}

impl Towards {
    fn observer(self, scene: &Scene) -> Observer {
        match self {
            Towards::Camera => Observer::At(scene.exposure.camera.centre_m()),
            Towards::At(place_m) => Observer::At(place_m - scene.body.origin_m),
            Towards::Afar(direction) => Observer::Towards(direction),
        }
    }

    /// The facets of a scene, and the observer in the body-fixed frame.
    fn seen(self, scene: &Scene) -> FacetsSeen {
        let (at_m, towards) = match self.observer(scene) {
            Observer::At(place_m) => (Some((place_m + scene.body.origin_m).to_array()), None),
            Observer::Towards(direction) => (None, Some(direction.vec().to_array())),
        };
        FacetsSeen { mesh: study::mesh_id(&scene.body), at_m, towards }
    }

    fn in_words(self) -> String {
        match self {
            Towards::Camera => "the scene's camera".into(),
            Towards::At(place_m) => format!("an observer at {:?} m, body-fixed", place_m.to_array()),
            Towards::Afar(direction) => {
                format!("an observer far away in direction {:?}, body-fixed", direction.vec().to_array())
            }
        }
    }
}

/// The files that a solution goes to.
#[derive(Debug)]
pub struct TableFiles {
    staged: Staged,
    radiance: Option<(Towards, PathBuf)>,
}

impl TableFiles {
    /// Begins the files, before anything is computed: it may not be possible. The radiance of facets goes to [`radiance_path`].
    ///
    /// # Errors
    /// [`Error::Invalid`] for a name that does not end in `.npz`; those of [`Staged::file`] and [`Staged::beside`].
    pub fn stage(target: &Path, towards: Option<Towards>, replace: bool) -> Result<Self> {
        // So that no slip of the hand replaces a scene or a mesh.
        if target.extension().is_none_or(|e| e != "npz") {
            return Err(Error::invalid(Location::file(target), "a facet table's name ends in .npz"));
        }
        let mut staged = Staged::file(target, replace)?;
        let radiance = towards.map(|towards| Ok((towards, staged.beside(&radiance_path(target))?))).transpose()?;
        Ok(TableFiles { staged, radiance })
    }
}

/// Beside `site.npz`, `site_radiance.npz`.
pub fn radiance_path(table: &Path) -> PathBuf {
    let mut name = table.file_stem().unwrap_or_default().to_owned();
    name.push("_radiance.npz");
    table.with_file_name(name)
}

/// Solves a scene, by the models that are requested, and writes the table, and what else was asked for.
///
/// # Errors
/// [`Error::Invalid`] if an input would be replaced; those of [`solve`](solver::solve) and [`FacetRadiance::new`]; [`Error::Io`].
pub fn solve(subject: &mut Subject, request: &Request, files: TableFiles, watch: Watch<'_>) -> Result<FacetTable> {
    let TableFiles { staged, radiance } = files;
    staged.spares(subject.inputs.iter().map(|input| input.path.as_path()))?;
    super::plan::decide(subject, request, watch)?;
    let scene = &subject.scene;
    let table = solver::solve(scene, watch)?;
    let id = study::table_id(scene);
    tell(watch, "writing the table", 0, 1)?;
    npz::write_table(staged.path(), &table, &id).map_err(|e| staged.named(e))?;
    tell(watch, "writing the table", 1, 1)?;
    if let Some((towards, path)) = radiance {
        tell(watch, "radiance of facets", 0, 1)?;
        let of = FacetRadiance::new(scene, &table, towards.observer(scene))?;
        let all = 0..of.facets();
        let file = RadianceOfFacets {
            observer: towards.in_words(),
            seen: towards.seen(scene),
            models: table.models,
            bands: &scene.exposure.bands,
            cos_emission: &of.cos_emission(all.clone()),
            sunlit: &of.sunlit(all),
            radiance: &|facets| of.radiance(facets),
        };
        npz::write_facet_radiance(&path, &file, &id).map_err(|e| staged.named(e))?;
        tell(watch, "radiance of facets", 1, 1)?;
    }
    staged.commit()?;
    Ok(table)
}
