//! Which facets face each other, found by bundles of parallel lines.
//!
//! Space is filled with lines, evenly in place and direction: a bundle of parallel ones for each of some directions. Where a line leaves a
//! facet on its outer side and next meets another on its outer side, the two exchange light, in both directions by the same amount: each line carries as much.
//! A facet sends and receives along as many lines as meet it, and that is its area, times pi, over the amount of a line.
//!
//! No line is an estimate of what another is; what facets exchange is estimated by how many there are. The error falls with their number, and with
//! that of directions.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::blocks::Blocks;
use super::detail::detail;
use super::meetings::{Frame, Meeting, Scratch, meetings};
use crate::geometry::{Direction, Mesh};
use crate::units::GOLDEN;

/// A smaller area, over the square of the mesh's extent, is rounding.
const NO_AREA: f64 = f64::EPSILON * f64::EPSILON;
/// From this ratio of vector area to area (a hemisphere's) on a mesh is ground, with a way up.
const GROUND: f64 = 0.5;
/// A mesh of few facets has at least this many lines.
const LEAST_LINES: f64 = (1 << 20) as f64;
/// A bundle's lattice has at most this many cells for each facet of its mesh.
const MOST_CELLS: f64 = 64.0;

/// The bundles of a mesh.
#[derive(Debug, Clone)]
pub struct Bundles<'a> {
    mesh: &'a Mesh,
    blocks: Arc<Blocks>,
    /// Of which facets all lines are among these; none of the bundles of all facets.
    members: Option<Arc<[bool]>>,
    /// How many these are.
    facets: usize,
    /// The middle of them, half their extent along the axes, and the largest magnitude of the mesh's coordinates, m.
    middle_m: DVec3,
    half_m: DVec3,
    magnitude_m: f64,
    /// Two horizontal directions and the way up.
    axes: [DVec3; 3],
    is_ground: bool,
    /// Of all facets; 0 if it is rounding.
    area_m2: f64,
    count: u32,
    /// What a line carries: area across it, times the solid angle that it stands for, m2 sr.
    line_m2_sr: f64,
    most_cells: f64,
}

impl<'a> Bundles<'a> {
    /// `count` bundles; of their lines `lines_per_facet` meet a facet, on average. None of a mesh without area.
    pub fn new(mesh: &'a Mesh, count: u32, lines_per_facet: u32) -> Self {
        let (low_m, high_m) = mesh.bounds_m().unwrap_or_default();
        let blocks = Arc::new(Blocks::new(mesh, low_m, high_m));
        Self::of(mesh, blocks, None).with(count, lines_per_facet)
    }

    /// Bundles of which each facet [is one's](Self::is_of): of all; or, where a part of the mesh is made in detail, of that part and of the rest. By area, most of the
    /// lines of all would be those of large facets around it.
    pub fn levels(mesh: &'a Mesh, count: u32, lines_per_facet: u32) -> Vec<Self> {
        let all = Self::new(mesh, count, lines_per_facet);
        let Some(fine) = detail(mesh) else { return vec![all] };
        let coarse: Vec<bool> = fine.iter().map(|is_fine| !is_fine).collect();
        let of = |members: Vec<bool>| {
            Self::of(mesh, Arc::clone(&all.blocks), Some(members.into())).with(count, lines_per_facet)
        };
        vec![of(fine), of(coarse)]
    }

    fn of(mesh: &'a Mesh, blocks: Arc<Blocks>, members: Option<Arc<[bool]>>) -> Self {
        let own = |f: &usize| members.as_ref().is_none_or(|members| members[*f]);
        let (mut low_m, mut high_m) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (mut vector_m2, mut area_m2, mut facets) = (DVec3::ZERO, 0.0, 0);
        for facet in (0..mesh.facets.len()).filter(own).map(|f| mesh.facet(f)) {
            facets += 1;
            (vector_m2, area_m2) = (vector_m2 + 0.5 * facet.cross_m2(), area_m2 + facet.area_m2());
            for corner_m in facet.corners_m {
                (low_m, high_m) = (low_m.min(corner_m), high_m.max(corner_m));
            }
        }
        let is_ground = vector_m2.length() >= GROUND * area_m2;
        let up = Direction::new(vector_m2).filter(|_| is_ground).unwrap_or(Direction::Z);
        let (east, north) = up.frame();
        let half_m = 0.5 * (high_m - low_m);
        let magnitude_m = mesh.bounds_m().map_or(0.0, |(low_m, high_m)| low_m.abs().max(high_m.abs()).max_element());
        Bundles {
            mesh,
            blocks,
            members,
            facets,
            middle_m: 0.5 * (low_m + high_m),
            half_m,
            magnitude_m,
            axes: [east, north, up.vec()],
            is_ground,
            area_m2: if area_m2 > NO_AREA * half_m.length_squared() { area_m2 } else { 0.0 },
            count: 0,
            line_m2_sr: 0.0,
            most_cells: (MOST_CELLS * facets as f64).max(LEAST_LINES),
        }
    }

    /// Others of the same mesh.
    #[must_use]
    pub fn with(&self, count: u32, lines_per_facet: u32) -> Self {
        let lines = (f64::from(lines_per_facet) * self.facets as f64).max(LEAST_LINES);
        let line_m2_sr = PI * self.area_m2 / lines;
        Bundles { count: if line_m2_sr.is_normal() { count } else { 0 }, line_m2_sr, ..self.clone() }
    }

    /// The mesh whose facets meet.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// Number of bundles.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Whether all lines that meet a facet are among these: of others only some are.
    pub fn is_of(&self, facet: u32) -> bool {
        self.members.as_ref().is_none_or(|members| members[facet as usize])
    }

    /// What of a facet's hemisphere one line stands for: the light of a surface of exitance 1 along it, over all that the facet receives.
    pub fn share_of_line(&self, area_m2: f64) -> f64 {
        self.line_m2_sr / (PI * area_m2)
    }

    /// Calls `visit` with the facets that meet along the lines of a bundle, and gives how many lines each of these stands for: 1, unless the mesh
    /// fills little of its surroundings.
    pub fn meetings(&self, bundle: u32, scratch: &mut Scratch, visit: impl FnMut(&Frame, Meeting)) -> f64 {
        let (frame, lines) = self.frame(bundle);
        meetings(self.mesh, &self.blocks, &frame, scratch, visit);
        lines
    }

    /// A bundle's direction, and where its lines are.
    fn frame(&self, bundle: u32) -> (Frame, f64) {
        // Sines of elevation are even in a body's bundles. Ground faces itself at small ones: there they are the squares of even numbers.
        let even = (f64::from(bundle) + 0.5) / f64::from(self.count);
        let (sin, stands_for) = if self.is_ground { (even * even, 2.0 * even) } else { (even, 1.0) };
        let solid_angle_sr = 2.0 * PI / f64::from(self.count) * stands_for;
        let turn = |step: f64| (f64::from(bundle) * step).fract();
        let (sin_azimuth, cos_azimuth) = (2.0 * PI * turn(GOLDEN)).sin_cos();
        let [east, north, up] = self.axes;
        let cos = (1.0 - sin * sin).sqrt();
        let (level, across) = (cos_azimuth * east + sin_azimuth * north, cos_azimuth * north - sin_azimuth * east);
        let (towards, rising) = (cos * level + sin * up, cos * up - sin * level);
        // Ground is seen as flat as it is.
        let flat = if self.is_ground { sin.max(FLATTEST) } else { 1.0 };
        let extent_m = [across, rising].map(|axis| self.half_m.dot(axis.abs()));
        let cell_m2 = self.line_m2_sr / solid_angle_sr;
        let size_m = |coarser: f64| [(coarser * cell_m2 / flat).sqrt(), (coarser * cell_m2 * flat).sqrt()];
        // Where a mesh fills little of its surroundings, lines are fewer, and each carries more.
        let mut coarser = 1.0;
        let cells = |size_m: [f64; 2]| (2.0 * extent_m[0] / size_m[0] + 8.0) * (2.0 * extent_m[1] / size_m[1] + 8.0);
        while cells(size_m(coarser)) > self.most_cells {
            coarser *= 2.0;
        }
        let phase = [turn(PLASTIC[0]), turn(PLASTIC[1])];
        let axes = [across, rising, towards];
        (Frame::new(self.middle_m, axes, size_m(coarser), extent_m, phase, self.magnitude_m), coarser)
    }
}

/// Multiples of the pair, modulo 1, are evenly spread in a square, as those of [`GOLDEN`] are on a line.
const PLASTIC: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
/// Cells are not flatter than this.
const FLATTEST: f64 = 0.1;
