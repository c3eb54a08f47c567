//! What every mesh reader returns: a mesh, its materials' names and colours, and what to report about the file.

use std::collections::BTreeMap;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::input::InputFile;
use super::mtl::ObjMaterial;
use crate::geometry::{Direction, Mesh};
use crate::report::{Note, Report};

/// More vertices, or more facets, are refused.
pub(super) const MOST: usize = 1 << 27;
/// Normals of a face's corners that differ by more make it look round.
pub(super) const FLAT: f64 = 1e-3;

/// A mesh and what its materials are called.
#[derive(Debug, Clone, PartialEq)]
pub struct ColouredMesh {
    /// The mesh, m, z up, local to the origin if there is one.
    pub mesh: Mesh,
    /// Its materials: names and linear colours.
    pub materials: Vec<ObjMaterial>,
    /// Origin of the mesh's coordinates in the body-fixed frame, m, if the file says it.
    pub origin_m: Option<DVec3>,
    /// Towards the Sun, axes of the mesh, if the file says it.
    pub sun: Option<Direction>,
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// z up.
    Z,
    /// y up, z towards the viewer, as in many modelling programs.
    Y,
}

/// Poses with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum NamedPose {
    /// Axes of the body.
    Body,
    /// x east, y north, z along the outward radius at `origin_m`.
    Radial,
}

/// A file of a mesh, as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The mesh, and what its materials are called.
    pub surface: ColouredMesh,
    /// The axis that files of this format have up, if they do not say it; a reader that knows has turned z up already.
    pub up: Up,
    /// The unit of length that files of this format have, if their user knows no other, m.
    pub unit_m: f64,
    /// Statements that were ignored, and how many of each.
    pub ignored: BTreeMap<String, usize>,
    /// What of the file has no place in a mesh, but for what `doubts` tell: how the surface should look, most of all.
    pub report: Report,
    /// What of the mesh is left out or probably not meant, and what was taken all the same.
    pub doubts: Vec<Note>,
    /// The same of its materials.
    pub material_doubts: Vec<Note>,
    /// Whether a file was looked for in vain that would take another one's place if it came to be.
    pub may_change: bool,
    /// The files that were read: the one that was named, or all that it names too.
    pub inputs: Vec<InputFile>,
}
