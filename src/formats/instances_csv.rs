//! Tables of where the instances of a mesh stand: a row for each.
//!
//! Columns `x_m`, `y_m`, `z_m` are where the mesh's origin is. How it is scaled and turned about that is either `scale` (or `scale_x`, `scale_y`, `scale_z`, along
//! the mesh's own axes, first) and the unit quaternion `qx`, `qy`, `qz`, `qw`, each if it is not left out; or the matrix of both, row by row: `xx`, `xy`, .. `zz`.

use std::path::Path;

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::input::{self, InputFile, Problems};
use super::table::place;
use crate::error::{Error, Location, Problem, Result, number};

/// A longer table is refused, bytes.
const LONGEST: u64 = 1 << 30;
/// Rounded quaternions are this far off a length of 1 at most.
const ROUNDED: f64 = 1e-3;

const POSITION: [&str; 3] = ["x_m", "y_m", "z_m"];
const SCALES: [&str; 3] = ["scale_x", "scale_y", "scale_z"];
const TURN: [&str; 4] = ["qx", "qy", "qz", "qw"];
const MATRIX: [&str; 9] = ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"];

/// Which columns a table has.
struct Columns {
    position: [usize; 3],
    scale: Option<usize>,
    scales: Option<[usize; 3]>,
    turn: Option<[usize; 4]>,
    matrix: Option<[usize; 9]>,
}

impl Columns {
    /// Those of a header; a problem, as a sentence, for one that says something else.
    fn of(names: &[&str]) -> std::result::Result<Self, String> {
        fn all<const N: usize>(names: &[&str], wanted: [&str; N]) -> std::result::Result<Option<[usize; N]>, String> {
            let found = wanted.map(|name| names.iter().position(|of| *of == name));
            match found.iter().flatten().count() {
                0 => Ok(None),
                n if n == N => Ok(Some(found.map(Option::unwrap_or_default))),
                _ => Err(format!("columns {} belong together, and some are missing", wanted.join(", "))),
            }
        }
        let known = || POSITION.iter().chain(&SCALES).chain(&TURN).chain(&MATRIX).chain(&["scale"]);
        for (i, name) in names.iter().enumerate() {
            if !known().any(|of| of == name) {
                let list: Vec<&str> = known().copied().collect();
                return Err(format!("column `{name}` is not known: columns are {}", list.join(", ")));
            }
            if names[..i].contains(name) {
                return Err(format!("column `{name}` is there twice"));
            }
        }
        let position = all(names, POSITION)?.ok_or("columns x_m, y_m, z_m are missing: where instances stand")?;
        let scale = names.iter().position(|name| *name == "scale");
        let (scales, turn, matrix) = (all(names, SCALES)?, all(names, TURN)?, all(names, MATRIX)?);
        if matrix.is_some() && (scale.is_some() || scales.is_some() || turn.is_some()) {
            return Err("a matrix (xx .. zz) says how instances are scaled and turned: leave scale and q out".into());
        }
        if scale.is_some() && scales.is_some() {
            return Err("give either `scale` or scale_x, scale_y, scale_z".into());
        }
        Ok(Columns { position, scale, scales, turn, matrix })
    }

    /// The place that a row says; a problem, as a sentence, for one that leaves nothing of the mesh, or turns by something that is no turn.
    fn place(&self, row: &[f64]) -> std::result::Result<DAffine3, String> {
        let translation = DVec3::from_array(self.position.map(|i| row[i]));
        let scale = match (self.scale, self.scales) {
            (Some(i), _) => DVec3::splat(row[i]),
            (None, Some(of)) => DVec3::from_array(of.map(|i| row[i])),
            (None, None) => DVec3::ONE,
        };
        let turn = match self.turn {
            None => DMat3::IDENTITY,
            Some(of) => {
                let q = DQuat::from_array(of.map(|i| row[i]));
                if (q.length() - 1.0).abs() > ROUNDED {
                    return Err(format!("qx, qy, qz, qw have length {}: a turn has length 1", number(q.length())));
                }
                DMat3::from_quat(q.normalize())
            }
        };
        let matrix3 = match self.matrix {
            Some(of) => DMat3::from_cols_array(&of.map(|i| row[i])).transpose(),
            None => turn * DMat3::from_diagonal(scale),
        };
        let volume = matrix3.determinant();
        if volume == 0.0 || !volume.is_finite() {
            return Err(format!("scales the mesh's volume by {}: nothing is left of it", number(volume)));
        }
        Ok(DAffine3 { matrix3, translation })
    }
}

/// Reads a table: the places of instances, from the mesh's axes to those that it is placed in, m.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for a header of something else, without rows, and with every cell and row that cannot be used.
pub(super) fn read(path: &Path) -> Result<(Vec<DAffine3>, InputFile)> {
    let (text, input) = input::text(path, LONGEST)?;
    let is_row = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut lines = text.lines().filter(is_row);
    let header = lines.next().unwrap_or_default();
    let names: Vec<&str> = header.split(',').map(str::trim).filter(|_| !header.is_empty()).collect();
    let columns = Columns::of(&names).map_err(|message| Error::invalid(place(path, &text, header), message))?;
    let mut problems = Problems::default();
    let mut places = Vec::new();
    for line in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let values: Vec<f64> =
            cells.iter().map_while(|cell| cell.parse::<f64>().ok().filter(|x| x.is_finite())).collect();
        if cells.len() != names.len() || values.len() != names.len() {
            let message = match cells.get(values.len()) {
                Some(cell) if values.len() < names.len() => {
                    format!("{} is not a finite number: `{cell}`", names[values.len()])
                }
                _ => format!("{} cells for {} columns", cells.len(), names.len()),
            };
            problems.push(|| Problem::new(place(path, &text, line), message));
            continue;
        }
        match columns.place(&values) {
            Ok(place) => places.push(place),
            Err(message) => problems.push(|| Problem::new(place(path, &text, line), message)),
        }
    }
    problems.finish(path)?;
    if places.is_empty() {
        return Err(Error::invalid(Location::file(path), "has no rows: a mesh that stands nowhere"));
    }
    Ok((places, input))
}
