//! `knowledge.toml`: uncertainties of pointing, orbit, clock, lens and shape. Its JSON Schema is in `schemas/`.

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;

use super::InputFile;
use super::coloured_mesh::Placing;
use super::input;
use super::located::Document;
use super::mesh_file::{NamedPose, Up};
use super::registry;
use super::scene_toml::Coordinates;
use crate::error::{Error, Problem, Result};
use crate::geometry::{Mesh, body_from_site};
use crate::study::knowledge::{Deviation, Knowledge, PositionAxes, Scatter, factor};

/// Default number of draws.
const DRAWS: u32 = 0;
/// An angle in these units, rad.
const RAD: [f64; 3] = [1.0, 1e-3, std::f64::consts::PI / 648_000.0];

/// Uncertainties of what places pixels on the ground. What is left out is exact.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct KnowledgeToml {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    #[allow(dead_code, reason = "the schema checks it")]
    mmxrt_knowledge: u32,
    /// Attitude, about the sensor's axes x (sample), y (line), z (boresight), right-handed.
    attitude: Option<AttitudeToml>,
    /// Position of the camera.
    position: Option<PositionToml>,
    /// Clock: positive if the believed time is later than the true one.
    clock: Option<ClockToml>,
    /// Focal length, relative to the true one.
    focal_length: Option<FocalLengthToml>,
    /// Shape.
    shape: Option<ShapeToml>,
    /// Monte Carlo draws that check the linear propagation.
    monte_carlo: Option<MonteCarloToml>,
}

/// At most one bias (believed minus true), and at most one of `sd` and `covariance`, in one unit each.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AttitudeToml {
    /// About x, y, z, rad. Default 0.
    bias_rad: Option<[f64; 3]>,
    /// The same, mrad.
    bias_mrad: Option<[f64; 3]>,
    /// The same, arcsec.
    bias_arcsec: Option<[f64; 3]>,
    /// Standard deviations about x, y, z, independent of each other, rad. Default 0.
    sd_rad: Option<[f64; 3]>,
    /// The same, mrad.
    sd_mrad: Option<[f64; 3]>,
    /// The same, arcsec.
    sd_arcsec: Option<[f64; 3]>,
    /// Covariance of the rotations about x, y, z, rad^2.
    covariance_rad2: Option<[[f64; 3]; 3]>,
    /// The same, mrad^2.
    covariance_mrad2: Option<[[f64; 3]; 3]>,
    /// The same, arcsec^2.
    covariance_arcsec2: Option<[[f64; 3]; 3]>,
}

/// A bias (believed minus true), and at most one of `sd_m` and `covariance_m2`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PositionToml {
    /// Axes of the three numbers. Default "track".
    axes: Option<AxesToml>,
    /// m. Default 0.
    bias_m: Option<[f64; 3]>,
    /// Standard deviations, independent of each other, m. Default 0.
    sd_m: Option<[f64; 3]>,
    /// Covariance, m^2.
    covariance_m2: Option<[[f64; 3]; 3]>,
}

/// Axes of a position.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum AxesToml {
    /// Along-track (over the turning body), cross-track (radial x along), radial.
    Track,
    /// The body's x, y, z.
    Body,
}

/// An error of time.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ClockToml {
    /// Believed minus true, s. Default 0.
    bias_s: Option<f64>,
    /// Standard deviation, s. Default 0.
    #[schemars(range(min = 0))]
    sd_s: Option<f64>,
}

/// An error of the focal length.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FocalLengthToml {
    /// Believed over true, minus 1. Default 0.
    #[schemars(extend("exclusiveMinimum" = -1))]
    bias: Option<f64>,
    /// Standard deviation of that. Default 0.
    #[schemars(range(min = 0, max = 1))]
    sd: Option<f64>,
}

/// Errors of the surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ShapeToml {
    /// Believed height too large by, along the radius, m. Default 0.
    height_bias_m: Option<f64>,
    /// Standard deviation of that, m. Default 0.
    #[schemars(range(min = 0))]
    height_sd_m: Option<f64>,
    /// Path of the believed mesh: OBJ or glTF. Default: the scene's.
    mesh: Option<String>,
    /// Its unit of length, m. Default 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    unit_m: Option<f64>,
    /// Its axis that points up. Default "z" for OBJ, "y" for glTF.
    up: Option<Up>,
    /// Whether its coordinates are local to the scene's `origin_m`, or start at the body's centre. Default "local".
    coordinates: Option<Coordinates>,
    /// Orientation of local coordinates on the body. Default "body".
    pose: Option<NamedPose>,
}

/// Draws.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MonteCarloToml {
    /// Number of draws. Default 0: none.
    #[schemars(range(max = 1_000_000))]
    draws: Option<u32>,
    /// Seed. Default 1.
    seed: Option<u64>,
}

/// The contents of a file.
#[derive(Debug)]
pub struct KnowledgeFile {
    /// The uncertainties.
    pub knowledge: Knowledge,
    /// Number of draws; 0: none.
    pub draws: u32,
    /// Their seed.
    pub seed: u64,
    /// Input files: this one first.
    pub inputs: Vec<InputFile>,
    document: Document,
}

impl KnowledgeFile {
    /// An error of a study that names items of this file: adds their places in it.
    #[must_use]
    pub fn placed(&self, error: Error) -> Error {
        let Error::Invalid(mut problems) = error else { return error };
        for problem in &mut problems {
            let item = problem.at.item.as_deref().filter(|_| problem.at.file.is_none());
            let known = item.filter(|item| self.document.has(item.split('.').next().unwrap_or(item)));
            if let Some(at) = known.map(|item| self.document.at(item)) {
                problem.at = at;
            }
        }
        Error::Invalid(problems)
    }
}

/// The JSON Schema of a knowledge file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(KnowledgeToml)
}

/// Reads the uncertainties for a scene with this origin, m.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`]; [`Error::Invalid`] with all that is wrong in the file, or with the mesh that it names.
pub fn read(path: &Path, origin_m: DVec3) -> Result<KnowledgeFile> {
    let (document, input) = Document::open(path)?;
    let toml: KnowledgeToml = document.read()?;
    let mut reader = Reader { path, document: &document, problems: Vec::new(), inputs: vec![input] };
    let (turn, attitude) = reader.attitude(&toml.attitude.unwrap_or_default());
    let (way_m, position_m, axes) = match &toml.position {
        Some(position) => reader.position(position),
        None => (DVec3::ZERO, DMat3::ZERO, PositionAxes::default()),
    };
    let (clock, focal) = (toml.clock.as_ref(), toml.focal_length.as_ref());
    let shape = toml.shape.as_ref();
    let bias = Deviation {
        attitude_rad: turn,
        position_m: way_m,
        clock_s: clock.and_then(|clock| clock.bias_s).unwrap_or(0.0),
        focal_length: focal.and_then(|focal| focal.bias).unwrap_or(0.0),
        height_m: shape.and_then(|shape| shape.height_bias_m).unwrap_or(0.0),
    };
    let scatter = Scatter {
        attitude_rad: attitude,
        position_m,
        clock_s: clock.and_then(|clock| clock.sd_s).unwrap_or(0.0),
        focal_length: focal.and_then(|focal| focal.sd).unwrap_or(0.0),
        height_m: shape.and_then(|shape| shape.height_sd_m).unwrap_or(0.0),
    };
    let mesh = match shape {
        Some(shape) => match reader.mesh(shape, origin_m) {
            Err(Error::Invalid(more)) => {
                reader.problems.extend(more);
                None
            }
            read => read?,
        },
        None => None,
    };
    let Reader { problems, inputs, .. } = reader;
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let drawn = toml.monte_carlo.unwrap_or_default();
    let knowledge = Knowledge { bias, scatter, axes, mesh };
    if knowledge.sources().is_empty() {
        let problem = Problem::new(document.at(""), "states no uncertainty: everything would be known exactly");
        let help = "give one, e.g. `[attitude]` with `sd_mrad = [0.1, 0.1, 0.5]`, or `[clock]` with `bias_s = 0.02`";
        return Err(Error::Invalid(vec![problem.with_help(help)]));
    }
    let draws = drawn.draws.unwrap_or(DRAWS);
    Ok(KnowledgeFile { knowledge, draws, seed: drawn.seed.unwrap_or(1), inputs, document })
}

struct Reader<'a> {
    path: &'a Path,
    document: &'a Document,
    problems: Vec<Problem>,
    inputs: Vec<InputFile>,
}

impl Reader<'_> {
    /// The given one of these keys, and its index.
    fn one<T: Copy>(&mut self, table: &str, keys: &[(&str, Option<T>)]) -> Option<(usize, T)> {
        let given: Vec<(usize, &str, T)> =
            keys.iter().enumerate().filter_map(|(i, (key, value))| Some((i, *key, (*value)?))).collect();
        if let [_, (_, second, _), ..] = given.as_slice() {
            let names: Vec<String> = given.iter().map(|(_, key, _)| format!("`{key}`")).collect();
            let message = format!("only one of {} may be given", names.join(", "));
            self.problems.push(Problem::new(self.document.at(&format!("{table}.{second}")), message));
        }
        given.first().map(|(i, _, value)| (*i, *value))
    }

    /// The Cholesky factor of a covariance, from standard deviations or itself, in units of the first key.
    fn factor(
        &mut self,
        table: &str,
        sd: &[(&str, Option<[f64; 3]>)],
        covariance: &[(&str, Option<[[f64; 3]; 3]>)],
        units: &[f64],
    ) -> DMat3 {
        let found = (self.one(table, sd), self.one(table, covariance));
        match found {
            (None, None) => DMat3::ZERO,
            (Some((i, sd_of)), None) => {
                if sd_of.iter().any(|sd| *sd < 0.0) {
                    let at = self.document.at(&format!("{table}.{}", sd[i].0));
                    self.problems.push(Problem::new(at, "must not be negative"));
                }
                DMat3::from_diagonal(units[i] * DVec3::from_array(sd_of))
            }
            (None, Some((i, rows))) => match factor(rows) {
                Some(factor) => factor * units[i],
                None => {
                    let at = self.document.at(&format!("{table}.{}", covariance[i].0));
                    let message = "must be symmetric and positive semidefinite";
                    self.problems.push(Problem::new(at, message));
                    DMat3::ZERO
                }
            },
            (Some((i, _)), Some((j, _))) => {
                let message = format!("only one of `{}` and this may be given", sd[i].0);
                let at = self.document.at(&format!("{table}.{}", covariance[j].0));
                self.problems.push(Problem::new(at, message));
                DMat3::ZERO
            }
        }
    }

    fn attitude(&mut self, toml: &AttitudeToml) -> (DVec3, DMat3) {
        let bias = [("bias_rad", toml.bias_rad), ("bias_mrad", toml.bias_mrad), ("bias_arcsec", toml.bias_arcsec)];
        let sd = [("sd_rad", toml.sd_rad), ("sd_mrad", toml.sd_mrad), ("sd_arcsec", toml.sd_arcsec)];
        let covariance = [
            ("covariance_rad2", toml.covariance_rad2),
            ("covariance_mrad2", toml.covariance_mrad2),
            ("covariance_arcsec2", toml.covariance_arcsec2),
        ];
        let bias_rad = self.one("attitude", &bias).map(|(i, turn)| RAD[i] * DVec3::from_array(turn));
        (bias_rad.unwrap_or_default(), self.factor("attitude", &sd, &covariance, &RAD))
    }

    fn position(&mut self, toml: &PositionToml) -> (DVec3, DMat3, PositionAxes) {
        let axes = match toml.axes {
            None | Some(AxesToml::Track) => PositionAxes::Track,
            Some(AxesToml::Body) => PositionAxes::Body,
        };
        let bias_m = toml.bias_m.map_or(DVec3::ZERO, DVec3::from_array);
        let (sd, covariance) = ([("sd_m", toml.sd_m)], [("covariance_m2", toml.covariance_m2)]);
        (bias_m, self.factor("position", &sd, &covariance, &[1.0]), axes)
    }

    /// The believed mesh, local to the scene's origin.
    fn mesh(&mut self, toml: &ShapeToml, origin_m: DVec3) -> Result<Option<Mesh>> {
        let Some(name) = &toml.mesh else {
            let placed = [
                ("unit_m", toml.unit_m.is_some()),
                ("up", toml.up.is_some()),
                ("coordinates", toml.coordinates.is_some()),
                ("pose", toml.pose.is_some()),
            ];
            for (key, _) in placed.iter().filter(|(_, given)| *given) {
                let at = self.document.at(&format!("shape.{key}"));
                self.problems.push(Problem::new(at, "needs `mesh`"));
            }
            return Ok(None);
        };
        let file = registry::mesh(&self.beside(name), true)?;
        self.inputs.extend(file.inputs);
        let placing = Placing { unit_m: toml.unit_m, up: toml.up, ..Placing::default() };
        let mut mesh = file.surface.placed(&placing, (file.up, file.unit_m)).mesh;
        let is_radial = toml.pose == Some(NamedPose::Radial);
        let is_of_body = toml.coordinates == Some(Coordinates::Body);
        let axes = if is_radial { body_from_site(origin_m) } else { Some(DMat3::IDENTITY) };
        match axes {
            Some(_) if is_radial && is_of_body => {
                let message = "coordinates of the body have the body's pose: leave this out";
                self.problems.push(Problem::new(self.document.at("shape.pose"), message));
            }
            None => {
                let message = "the scene's `origin_m` is the body's centre, where nothing is up: give \"body\"";
                self.problems.push(Problem::new(self.document.at("shape.pose"), message));
            }
            Some(axes) => {
                let shift_m = if is_of_body { -origin_m } else { DVec3::ZERO };
                mesh.vertices_m.iter_mut().for_each(|vertex_m| *vertex_m = axes * *vertex_m + shift_m);
            }
        }
        Ok(Some(mesh))
    }

    fn beside(&self, name: &str) -> PathBuf {
        input::home(self.path, Path::new(name)).join(name)
    }
}
