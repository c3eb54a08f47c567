//! Which facets a camera may see, and which may stand in the light of others, found for groups of them: so that a narrow view costs what is near it, and not all
//! of the mesh.

use glam::DVec3;

use crate::geometry::{Camera, Direction, FrameCamera, Mesh, index_u32, whole};

/// Facets of a group.
const GROUP: usize = 64;
/// Groups that are looked at together first: they follow one another as they lie.
const FEW: usize = 16;
/// A sum of a few products is rounded by less than this, relative to the sum of their sizes.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Heights are kept for at most so many squares of a side.
const MOST_SQUARES: f64 = 1024.0;

/// Facets in groups that lie near each other.
#[derive(Debug)]
pub struct FacetGroups {
    /// Middle of each group's box, and half its size, m.
    boxes: Vec<(DVec3, DVec3)>,
    /// The same of each [`FEW`] groups together.
    few: Vec<(DVec3, DVec3)>,
    /// First facet of each group in `facets`, and their number as the last element.
    start: Vec<usize>,
    facets: Vec<u32>,
}

impl FacetGroups {
    /// Of a mesh: halved along its longest side until groups are small.
    pub fn new(mesh: &Mesh) -> Self {
        let middle = |facet: u32| mesh.facet(facet as usize).centroid_m();
        let mut facets: Vec<(u32, DVec3)> =
            (0..index_u32(mesh.facets.len())).map(|facet| (facet, middle(facet))).collect();
        let mut start = Vec::new();
        halve(&mut facets, 0, &mut start);
        start.push(facets.len());
        let facets: Vec<u32> = facets.into_iter().map(|(facet, _)| facet).collect();
        let box_of = |group: &[usize]| {
            let corners = facets[group[0]..group[1]].iter().flat_map(|facet| mesh.facet(*facet as usize).corners_m);
            let (low, high) =
                corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
            (0.5 * (low + high), 0.5 * (high - low))
        };
        let boxes: Vec<(DVec3, DVec3)> = start.windows(2).map(box_of).collect();
        let around = |boxes: &[(DVec3, DVec3)]| {
            let (low, high) =
                boxes.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (middle, half)| {
                    (low.min(*middle - *half), high.max(*middle + *half))
                });
            (0.5 * (low + high), 0.5 * (high - low))
        };
        FacetGroups { few: boxes.chunks(FEW).map(around).collect(), boxes, start, facets }
    }

    /// Which groups a camera may see some of; adds to what others may.
    pub fn add_seen(&self, camera: &FrameCamera, seen: &mut [bool]) {
        let camera = camera.drawn().pinhole;
        let projection = Camera::Frame(camera.clone()).projection();
        let rows = projection.linear.transpose();
        let (x, y, z) = (rows.x_axis, rows.y_axis, rows.z_axis);
        // Where each of these is below 0, nothing is in view.
        let planes = [z, x, y, f64::from(camera.samples) * z - x, f64::from(camera.lines) * z - y];
        let may_show = |(middle, half): &(DVec3, DVec3)| {
            let from = *middle - projection.origin_m;
            planes.iter().all(|plane| {
                let size = plane.abs().dot(from.abs() + *half + projection.origin_m.abs());
                plane.dot(from) + plane.abs().dot(*half) >= -ROUNDING * size
            })
        };
        let together = seen.chunks_mut(FEW).zip(self.boxes.chunks(FEW)).zip(&self.few);
        for ((seen, boxes), _) in together.filter(|(_, few)| may_show(few)) {
            seen.iter_mut().zip(boxes).filter(|(seen, _)| !**seen).for_each(|(seen, of)| *seen = may_show(of));
        }
    }

    /// Some groups, and which others may hide some of them from an eye at infinity: what overlaps them there and is not below all of them.
    #[must_use]
    pub fn with_hiding(&self, of: &[bool], towards: Direction) -> Vec<bool> {
        let (right, down) = towards.frame();
        let axes = [right, down, towards.vec()];
        // Along each axis from where to where a group is at most.
        let extents = |(middle, half): &(DVec3, DVec3)| {
            axes.map(|axis| {
                let reach = axis.abs().dot(*half + ROUNDING * (middle.abs() + *half));
                [axis.dot(*middle) - reach, axis.dot(*middle) + reach]
            })
        };
        let asked = || self.boxes.iter().zip(of).filter(|(_, of)| **of).map(|(of_group, _)| extents(of_group));
        let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for extent in asked() {
            low = [0, 1].map(|k| low[k].min(extent[k][0]));
            high = [0, 1].map(|k| high[k].max(extent[k][1]));
        }
        // About as many squares as groups, laid over what they cover.
        let sides = [0, 1].map(|k| high[k] - low[k]);
        let size =
            (sides[0] * sides[1] / asked().count().max(1) as f64).sqrt().max(sides[0].max(sides[1]) / MOST_SQUARES);
        let count = sides.map(|side| if size > 0.0 { whole((side / size).floor()) + 1 } else { 1 });
        let squares = |extent: &[[f64; 2]; 3]| {
            let [columns, rows] = [0, 1].map(|k| {
                if extent[k][1] < low[k] || extent[k][0] > high[k] {
                    return 0..0;
                }
                let square =
                    |x: f64| if size > 0.0 { whole(((x - low[k]) / size).max(0.0)).min(count[k] - 1) } else { 0 };
                square(extent[k][0])..square(extent[k][1]) + 1
            });
            rows.flat_map(move |row| columns.clone().map(move |column| row * count[0] + column))
        };
        let mut lowest = vec![f64::INFINITY; count[0] * count[1]];
        for extent in asked() {
            squares(&extent).for_each(|square| lowest[square] = lowest[square].min(extent[2][0]));
        }
        let hides = |of_group: &(DVec3, DVec3)| {
            let extent = extents(of_group);
            squares(&extent).any(|square| lowest[square] <= extent[2][1])
        };
        self.boxes.iter().map(hides).collect()
    }

    /// Number of groups.
    pub fn count(&self) -> usize {
        self.boxes.len()
    }

    /// The facets of some groups, ascending.
    pub fn facets(&self, seen: &[bool]) -> Vec<u32> {
        let groups = self.start.windows(2).zip(seen).filter(|(_, seen)| **seen);
        let mut facets: Vec<u32> = groups.flat_map(|(group, _)| &self.facets[group[0]..group[1]]).copied().collect();
        facets.sort_unstable();
        facets
    }
}

/// Sorts facets into groups, and notes where each begins.
fn halve(facets: &mut [(u32, DVec3)], first: usize, start: &mut Vec<usize>) {
    if facets.len() <= GROUP {
        start.extend((!facets.is_empty()).then_some(first));
        return;
    }
    let ends = |by: fn(DVec3, DVec3) -> DVec3| facets.iter().map(|(_, p)| *p).reduce(by).unwrap_or_default();
    let size = ends(DVec3::max) - ends(DVec3::min);
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let middle = facets.len() / 2;
    facets.select_nth_unstable_by(middle, |(a, p), (b, q)| p[axis].total_cmp(&q[axis]).then(a.cmp(b)));
    let (low, high) = facets.split_at_mut(middle);
    halve(low, first, start);
    halve(high, first + middle, start);
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;
    use crate::geometry::{MaterialId, Pose};

    /// A square of small facets, and a camera straight above that sees a slit.
    #[test]
    fn what_a_slit_sees_is_in_its_groups_and_little_else() {
        let n = 100_u32;
        let mut mesh = Mesh::default();
        for j in 0..=n {
            mesh.vertices_m.extend((0..=n).map(|i| DVec3::new(f64::from(i), f64::from(j), 0.0)));
        }
        for j in 0..n {
            for i in 0..n {
                let a = j * (n + 1) + i;
                mesh.facets.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
            }
        }
        mesh.material = vec![MaterialId(0); mesh.facets.len()];
        let groups = FacetGroups::new(&mesh);
        let rotation = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
        let pose = Pose { rotation, translation_m: DVec3::new(50.0, 40.0, 1000.0) };
        // A pixel is 1 m on the ground: y from 39.5 to 40.5, x from 40 to 60.
        let camera = FrameCamera::centred(pose, 20, 1, 1e-3);
        let mut seen = vec![false; groups.count()];
        groups.add_seen(&camera, &mut seen);
        let facets = groups.facets(&seen);
        for facet in 0..index_u32(mesh.facets.len()) {
            let corners = mesh.facet(facet as usize).corners_m;
            let low = corners.iter().copied().reduce(DVec3::min).unwrap();
            let high = corners.iter().copied().reduce(DVec3::max).unwrap();
            let in_view = high.x > 40.0 && low.x < 60.0 && high.y > 39.5 && low.y < 40.5;
            assert!(!in_view || facets.binary_search(&facet).is_ok(), "{facet}");
        }
        assert!(facets.len() < mesh.facets.len() / 10, "{}", facets.len());
        let behind = FrameCamera { world_from_sensor: Pose { rotation: DMat3::IDENTITY, ..pose }, ..camera };
        let mut seen = vec![false; groups.count()];
        groups.add_seen(&behind, &mut seen);
        assert!(groups.facets(&seen).is_empty());
    }
}
