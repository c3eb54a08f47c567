//! The ground of a DART scene: heights on a grid, or a plane, alone or with copies of the scene around it, and what stands on it.
//!
//! All in DART's frame.

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::formats::input::InputFile;
use crate::geometry::cell::{self, cell_at, cut};
use crate::geometry::{MaterialId, Mesh, index_u32};
use crate::report::{Fate, Report};

use super::folder::Folder;
use super::read::terrain;
use super::{Object, Simulation, Topography};

/// Facets, or vertices, that a scene with its copies may have: some 3 GB of them.
const MOST_REPEATED: u64 = 1 << 26;

/// Where the ground is, for one scene and its copies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ground {
    /// Extent of one scene along x and y, m.
    size_m: [f64; 2],
    /// Cells of one scene along x and y.
    cells: [usize; 2],
    /// Heights of the cells' corners, m, line after line along y: the outer ones lie on the scene's edges.
    heights_m: Vec<f64>,
    /// What the ground rises by from one scene to the next along x and y, m; `None` if nothing lies beside the scene.
    rise_m: Option<[f64; 2]>,
    /// Copies on each side.
    repeat: u32,
    /// There is a raster: a plane needs no inference.
    pub(super) is_terrain: bool,
}

impl Ground {
    /// The ground of a simulation with `repeat` copies of its scene on each side; what was inferred, and the files read.
    ///
    /// # Errors
    /// [`Error::Invalid`] if an isolated scene is to be repeated, or the raster does not span the scene; and as [`terrain`].
    pub(super) fn of(simulation: &Simulation, folder: &Folder, repeat: u32) -> Result<(Self, Report, Vec<InputFile>)> {
        let maket = &simulation.maket;
        let at = maket.at.clone().with_item("Maket/@exactlyPeriodicScene");
        if repeat > 0 && maket.boundary == 0 {
            let message =
                "the scene is isolated (0): nothing goes on beyond its edges. Leave `--repeat` out, or write 1 here";
            return Err(Error::invalid(at, message));
        }
        let mut report = Report::default();
        let mut ground = Ground {
            size_m: maket.size_m,
            cells: [1; 2],
            heights_m: vec![0.0; 4],
            rise_m: (maket.boundary > 0).then_some([0.0; 2]),
            repeat,
            is_terrain: false,
        };
        let mut files = Vec::new();
        if let Some(topography) = &maket.topography {
            let file = &topography.file;
            let found = match terrain(simulation, folder) {
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                // It is made again anyway.
                Err(error) if topography.generated => {
                    Err(error.to_string().lines().next().unwrap_or_default().to_owned())
                }
                found => Ok(found?),
            };
            match found {
                Ok(Some((raster, of_raster))) => {
                    ground.cells = [raster.rows - 1, raster.columns - 1];
                    ground.heights_m = raster.values;
                    ground.is_terrain = true;
                    files = of_raster;
                    ground.tell(topography, &mut report);
                    ground.close(maket.boundary, topography, &mut report);
                }
                found => {
                    let (why, help) = match found.err() {
                        Some(error) => (
                            format!("cannot be read ({error}), but DART makes it before it runs"),
                            "Run DART's generator first",
                        ),
                        None if topography.generated => {
                            ("is not there, because DART makes it before it runs".into(), "Run DART's generator first")
                        }
                        None => {
                            ("is not there".into(), "Put it into the input folder, or the one that `--databases` names")
                        }
                    };
                    let message = format!("the terrain {file:?} {why}: the ground is a plane at z = 0. {help}");
                    report.note(Fate::Dropped, topography.at.clone(), message);
                }
            }
        }
        if maket.boundary > 0 && repeat == 0 {
            let message =
                "the scene goes on beyond its edges: only one of it is taken. `--repeat N` takes N more on each side";
            report.note(Fate::Dropped, at, message);
        }
        Ok((ground, report, files))
    }

    /// Says how the raster is understood.
    fn tell(&self, topography: &Topography, report: &mut Report) {
        let [rows, columns] = self.cells.map(|n| n + 1);
        let [dx, dy] = [0, 1].map(|axis| short(self.size_m[axis] / self.cells[axis] as f64));
        let message = format!(
            "{rows} x {columns} heights over z = 0, {dx} x {dy} m apart, the outer ones on the scene's edges, cells cut along the \
             shorter diagonal: DART does not say. Were they those of pixels' centres, the ground would be off by at most half a pixel"
        );
        report.note(Fate::Defaulted, topography.at.clone(), message);
    }

    /// Makes the ground fit a copy of itself beside it, as DART does: its last line and column become the first ones, in an
    /// infinite slope as much higher as the edges lie on average.
    fn close(&mut self, boundary: u32, topography: &Topography, report: &mut Report) {
        let ([last_x, last_y], width) = (self.cells, self.cells[1] + 1);
        let mean = |differences: &mut dyn ExactSizeIterator<Item = f64>| {
            let count = differences.len() as f64;
            differences.sum::<f64>() / count
        };
        let h = &self.heights_m;
        let rise_m = match boundary {
            0 => return,
            1 => [0.0; 2],
            _ => [
                mean(&mut (0..width).map(|j| h[last_x * width + j] - h[j])),
                mean(&mut (0..last_x + 1).map(|i| h[i * width + last_y] - h[i * width])),
            ],
        };
        let before = self.heights_m.clone();
        for j in 0..width {
            self.heights_m[last_x * width + j] = self.heights_m[j] + rise_m[0];
        }
        for i in 0..=last_x {
            self.heights_m[i * width + last_y] = self.heights_m[i * width] + rise_m[1];
        }
        self.rise_m = Some(rise_m);
        let moved_m = short(before.iter().zip(&self.heights_m).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
        let at = topography.at.clone();
        if boundary == 1 && moved_m > 0.0 {
            let message = format!(
                "the last line and column of heights: in a repeated scene DART puts the first ones there, and so does this; they \
                 move by up to {moved_m} m"
            );
            report.note(Fate::Dropped, at, message);
        } else if boundary > 1 {
            let [x, y] = rise_m.map(short);
            let message = format!(
                "an infinite slope: the ground rises by {x} m along x and {y} m along y from scene to scene, as its edges do on \
                 average. Its last line and column move by up to {moved_m} m; DART bends several, how is not documented"
            );
            report.note(Fate::Approximated, at, message);
        }
    }

    /// Cuts a plane into so many cells along x and y.
    pub(super) fn cut_into(&mut self, [x, y, _]: [usize; 3]) {
        if !self.is_terrain {
            self.cells = [x, y];
            self.heights_m = vec![0.0; (x + 1) * (y + 1)];
        }
    }

    /// Height of the ground at a place, m. An isolated scene's continues level beyond its edges.
    pub(super) fn height_m(&self, x_m: f64, y_m: f64) -> f64 {
        let mut rise_m = 0.0;
        let mut place = |axis: usize, at_m: f64| {
            let mut scenes = at_m / self.size_m[axis];
            match self.rise_m {
                Some(rise) => {
                    rise_m += scenes.floor() * rise[axis];
                    scenes -= scenes.floor();
                }
                None => scenes = scenes.clamp(0.0, 1.0),
            }
            let cells = scenes * self.cells[axis] as f64;
            cell_at(cells, self.cells[axis])
        };
        let ((i, u), (j, v)) = (place(0, x_m), place(1, y_m));
        rise_m + cell::height_m(self.corners(i, j).map(|corner| self.heights_m[corner]), u, v)
    }

    /// Indices in `heights_m` of a cell's corners: counter-clockwise seen from above, from its corner at the smallest x and y.
    fn corners(&self, i: usize, j: usize) -> [usize; 4] {
        let width = self.cells[1] + 1;
        [i * width + j, (i + 1) * width + j, (i + 1) * width + j + 1, i * width + j + 1]
    }

    /// The ground of the scene and of all its copies, in one sheet.
    pub(super) fn mesh(&self, material: MaterialId) -> Mesh {
        let scenes = 2 * self.repeat as usize + 1;
        let [cells_x, cells_y] = self.cells;
        let (lines, columns) = (scenes * cells_x + 1, scenes * cells_y + 1);
        let rise_m = self.rise_m.unwrap_or_default();
        // Scene, counted from the middle one, and cell in it. The last line of heights counts where no scene follows.
        let split = |n: usize, cells: usize| {
            let scene = (n / cells).min(scenes - 1);
            (scene as f64 - f64::from(self.repeat), n - scene * cells)
        };
        // A scene's far edge is the near one of the next, bit by bit, so that copies of objects join there too.
        let along_m = |scene: f64, n: usize, cells: usize, size_m: f64| match n == cells {
            true => (scene + 1.0) * size_m,
            false => scene * size_m + size_m * n as f64 / cells as f64,
        };
        let mut mesh = Mesh::default();
        for line in 0..lines {
            let (k, i) = split(line, cells_x);
            let x_m = along_m(k, i, cells_x, self.size_m[0]);
            for column in 0..columns {
                let (l, j) = split(column, cells_y);
                let z_m = self.heights_m[i * (cells_y + 1) + j] + k * rise_m[0] + l * rise_m[1];
                mesh.vertices_m.push(DVec3::new(x_m, along_m(l, j, cells_y, self.size_m[1]), z_m));
            }
        }
        for line in 0..lines - 1 {
            for column in 0..columns - 1 {
                let heights_m = self.corners(line % cells_x, column % cells_y).map(|corner| self.heights_m[corner]);
                let near = line * columns + column;
                let [a, b, c, d] = [near, near + columns, near + columns + 1, near + 1].map(index_u32);
                mesh.facets.extend(cut([a, b, c, d], heights_m));
            }
        }
        let cells = index_u32(mesh.facets.len()) / 2;
        mesh.face_of_facet = (0..cells).flat_map(|cell| [cell, cell]).collect();
        mesh.material = vec![material; mesh.facets.len()];
        mesh
    }

    /// The objects of the scene and of all its copies.
    pub(super) fn copies(&self, objects: Mesh) -> Mesh {
        if self.repeat == 0 || objects.facets.is_empty() {
            return objects;
        }
        let rise_m = self.rise_m.unwrap_or_default();
        // As for the ground: what lies on the far edge lies on the near one of the next copy.
        let along_m = |scene: f64, at_m: f64, size_m: f64| match at_m == size_m {
            true => (scene + 1.0) * size_m,
            false => scene * size_m + at_m,
        };
        let faces = objects.face_of_facet.iter().max().map_or(0, |last| last + 1);
        let mut all = Mesh::default();
        let scenes = || (-i64::from(self.repeat)..=i64::from(self.repeat)).map(|scene| scene as f64);
        for (copy, (k, l)) in scenes().flat_map(|k| scenes().map(move |l| (k, l))).enumerate() {
            let first = index_u32(all.vertices_m.len());
            all.vertices_m.extend(objects.vertices_m.iter().map(|v| {
                let (x, y) = (along_m(k, v.x, self.size_m[0]), along_m(l, v.y, self.size_m[1]));
                DVec3::new(x, y, v.z + k * rise_m[0] + l * rise_m[1])
            }));
            all.facets.extend(objects.facets.iter().map(|facet| facet.map(|v| v + first)));
            all.material.extend_from_slice(&objects.material);
            all.face_of_facet.extend(objects.face_of_facet.iter().map(|face| face + index_u32(copy) * faces));
        }
        all
    }

    /// Whether the copies of these objects and of the ground, if it is `seen`, are not too many.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the most copies that fit.
    pub(super) fn fits(&self, objects: &Mesh, seen: bool, at: &Location) -> Result<()> {
        let faces = objects.face_of_facet.iter().max().map_or(0, |last| u64::from(*last) + 1);
        let of_objects = (objects.facets.len() as u64).max(objects.vertices_m.len() as u64).max(faces);
        let facets = of_objects + if seen { 2 * self.cells.iter().map(|n| *n as u64).product::<u64>() } else { 0 };
        let scenes = 2 * u64::from(self.repeat) + 1;
        let all = u128::from(facets) * u128::from(scenes) * u128::from(scenes);
        if self.repeat == 0 || all <= u128::from(MOST_REPEATED) {
            return Ok(());
        }
        let most = (MOST_REPEATED / facets).isqrt().saturating_sub(1) / 2;
        let advice = if most == 0 { "leave it out".into() } else { format!("`--repeat {most}` is the most that fits") };
        let message = format!(
            "`--repeat {}` makes {scenes} x {scenes} scenes of {facets} facets or vertices, more than {MOST_REPEATED} together: {advice}",
            self.repeat
        );
        Err(Error::invalid(at.clone(), message))
    }
}

/// In four digits, for people.
fn short(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// Objects that stand on the terrain, reported together.
#[derive(Debug, Default)]
pub(super) struct Standing {
    first: Option<(Location, String)>,
    count: usize,
    /// What the ground below one of them differs by, m.
    relief_m: f64,
    /// The last that stays where it stands: a model of a field is told once.
    kept: Option<Location>,
}

impl Standing {
    /// Moves an object to where DART puts it, by `objectDEMMode`.
    pub(super) fn settle(&mut self, object: &Object, mesh: &mut Mesh, ground: &Ground, report: &mut Report) {
        let Some((low_m, high_m)) = mesh.bounds_m() else { return };
        let kept = match object.dem_mode {
            0 => {
                let middle_m = 0.5 * (low_m + high_m);
                let ground_m = ground.height_m(middle_m.x, middle_m.y);
                if ground.is_terrain {
                    let below_m = mesh.used_vertices_m().map(|v| ground.height_m(v.x, v.y));
                    let (low, high) = below_m.fold((ground_m, ground_m), |(lo, hi), h| (lo.min(h), hi.max(h)));
                    self.first.get_or_insert_with(|| (object.at.clone(), object.name.clone()));
                    self.count += 1;
                    self.relief_m = self.relief_m.max(high - low);
                }
                mesh.vertices_m.iter_mut().for_each(|v| v.z += ground_m - low_m.z);
                return;
            }
            1 => "is part of the terrain (`objectDEMMode` 1): it stays where it stands, and no object is put on it",
            2 => return,
            _ => "says for each group whether it stands on the ground (`objectDEMMode` 3): it stays where it stands",
        };
        if self.kept.as_ref() != Some(&object.at) {
            self.kept = Some(object.at.clone());
            report.note(Fate::Approximated, object.at.clone(), format!("{:?} {kept}", object.name));
        }
    }

    /// Says where objects were put.
    pub(super) fn tell(self, report: &mut Report) {
        let Some((at, name)) = self.first else { return };
        let others = if self.count > 1 { format!(" and {} more", self.count - 1) } else { String::new() };
        let message = format!(
            "{name:?}{others} on the terrain (`objectDEMMode` 0): the lowest point is put at the ground's height below the middle. \
             Where DART looks is not documented: the ground below one object differs by up to {} m",
            short(self.relief_m)
        );
        report.note(Fate::Approximated, at, message);
    }
}
