//! Makes meshes: a landscape of relief, craters and boulders from a seed and a few numbers.

mod boulder;
mod crater;
mod division;
mod random;
mod recipe;
mod relief;
mod sheet;

use glam::DVec3;

pub use recipe::{Boulders, Craters, FACETS, Recipe, Relief};

use crate::error::{Error, Result};
use crate::geometry::{MaterialId, Mesh, index_u32};
use crate::progress::{Watch, tell};
use boulder::Ball;

/// Names and colours (linear RGB, as `Kd` in an MTL file) of the two materials, by their index in the mesh:
/// 0 the ground, 1 the boulders.
pub const MATERIALS: [(&str, [f64; 3]); 2] = [("phobos_blue", [0.28, 0.30, 0.34]), ("phobos_red", [0.40, 0.28, 0.20])];

const GROUND: MaterialId = MaterialId(0);
const BOULDER: MaterialId = MaterialId(1);

/// Relief and craters less than this many grid steps wide are left out: a triangle grid would only alias them.
const FINEST_STEPS: f64 = 3.0;

/// The stage, as reported to the watch.
const STAGE: &str = "making the landscape";

/// A generated landscape.
#[derive(Debug, Clone)]
pub struct Landscape {
    /// The ground (one open sheet, first) and the boulders (closed bodies that stick in it), m; x east, y north, z up.
    /// Coordinates are whole multiples of 1e-5 m, so that text with five decimals holds them exactly. Material indices are
    /// those of [`MATERIALS`].
    pub mesh: Mesh,
    /// Craters that were made; the rest of the recipe's are too small for the grid.
    pub craters: usize,
    /// Boulders that were made; the rest of the recipe's are too small for the grid.
    pub boulders: usize,
}

/// Makes the landscape of a recipe: the same bytes at any thread count.
///
/// # Errors
/// [`Error::Invalid`] with all that [`Recipe::check`] finds; [`Error::Interrupted`] if `watch` asks to stop.
pub fn generate(recipe: &Recipe, watch: Watch<'_>) -> Result<Landscape> {
    let division = division::divide(recipe).map_err(Error::Invalid)?;
    let shortest_m = FINEST_STEPS * division::step_m(recipe);
    let octaves = relief::octaves(&recipe.relief, recipe.seed, shortest_m);
    let craters: Vec<_> = crater::craters(&recipe.craters, recipe.seed, recipe.size_m)
        .filter(|crater| crater.diameter_m >= shortest_m)
        .collect();

    let sheet = sheet::Sheet::new(recipe.size_m, division.columns, division.rows, &octaves, &craters, watch)?;
    let mut mesh = sheet.mesh();
    let balls: Vec<Ball> = (1..=division::FINEST).map(Ball::new).collect();
    for (boulder, frequency) in &division.boulders {
        let ball = &balls[*frequency as usize - 1];
        let vertices_m = boulder.vertices_m(ball);
        let height_m = vertices_m.iter().fold(0.0, |h, v| v.z.max(h));
        let foot_m = sheet.height_m(boulder.x_m, boulder.y_m) - recipe.boulders.sunk * height_m;
        let foot_m = DVec3::new(boulder.x_m, boulder.y_m, foot_m);
        let base = index_u32(mesh.vertices_m.len());
        mesh.vertices_m.extend(vertices_m.iter().map(|v| rounded_m(v + foot_m)));
        mesh.facets.extend(ball.facets.iter().map(|f| f.map(|v| v + base)));
        mesh.material.resize(mesh.facets.len(), BOULDER);
    }
    tell(watch, STAGE, sheet.points() as u64, sheet.points() as u64)?;
    Ok(Landscape { mesh, craters: craters.len(), boulders: division.boulders.len() })
}

/// The nearest whole multiple of 1e-5 m, as the f64 that reading its decimal text gives: a whole number over a whole
/// number is rounded once, as the text is. Adding zero makes -0 into 0.
fn rounded_m(v: DVec3) -> DVec3 {
    (v * 1e5).round() / 1e5 + DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn made(recipe: &Recipe) -> Landscape {
        generate(recipe, &|_| true).unwrap()
    }

    fn small() -> Recipe {
        Recipe { facets: 20_000, size_m: 500.0, ..Recipe::new(11) }.with_boulders(200)
    }

    impl Recipe {
        fn with_boulders(mut self, count: u32) -> Self {
            self.boulders.count = count;
            self
        }
    }

    /// The facets of each connected component.
    fn components(mesh: &Mesh) -> Vec<Vec<usize>> {
        let mut parent: Vec<usize> = (0..mesh.vertices_m.len()).collect();
        fn root(parent: &mut [usize], mut v: usize) -> usize {
            while parent[v] != v {
                parent[v] = parent[parent[v]];
                v = parent[v];
            }
            v
        }
        for facet in &mesh.facets {
            for pair in facet.windows(2) {
                let (a, b) = (root(&mut parent, pair[0] as usize), root(&mut parent, pair[1] as usize));
                parent[a] = b;
            }
        }
        let mut of_root: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, facet) in mesh.facets.iter().enumerate() {
            of_root.entry(root(&mut parent, facet[0] as usize)).or_default().push(i);
        }
        of_root.into_values().collect()
    }

    /// Directed edges whose opposite is missing. Panics if a directed edge is there twice.
    fn open_edges(mesh: &Mesh, facets: &[usize]) -> Vec<[u32; 2]> {
        let mut edges = BTreeMap::new();
        for &i in facets {
            let [a, b, c] = mesh.facets[i];
            for edge in [[a, b], [b, c], [c, a]] {
                assert!(edges.insert(edge, ()).is_none(), "edge {edge:?} twice in one direction");
            }
        }
        edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a])).copied().collect()
    }

    #[test]
    fn ground_is_one_open_sheet_and_boulders_are_closed() {
        let landscape = made(&small());
        let mesh = &landscape.mesh;
        let parts = components(mesh);
        assert_eq!(parts.len(), 1 + 200);
        let (mut boulders, mut grounds) = (0, 0);
        for part in &parts {
            let open = open_edges(mesh, part);
            let material = mesh.material[part[0]];
            assert!(part.iter().all(|&i| mesh.material[i] == material && mesh.facet(i).area_m2() > 1e-4));
            if material == BOULDER {
                assert_eq!(open, [[0; 2]; 0]);
                let volume_m3: f64 =
                    part.iter().map(|&i| mesh.facet(i).corners_m).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
                // Boxes of 0.24 to 0.63 cubic diameters of 2 to 12 m, filled to 0.2 (a cut icosahedron) to 0.65.
                assert!((0.05 * 8.0..0.41 * 1728.0).contains(&volume_m3), "{volume_m3}");
                boulders += 1;
            } else {
                assert!(part.iter().all(|&i| mesh.facet(i).normal().z > 0.0));
                let border = |v: u32| {
                    let p = mesh.vertices_m[v as usize];
                    p.x.abs() == 250.0 || p.y.abs() == 250.0
                };
                assert!(open.iter().flatten().all(|&v| border(v)));
                let (lo, hi) = mesh.bounds_m().unwrap();
                assert_eq!((lo.x, lo.y, hi.x, hi.y), (-250.0, -250.0, 250.0, 250.0));
                // As many as a grid of part.len() / 2 cells, square or nearly so, has around it.
                assert!((open.len() as f64 / (4.0 * (part.len() as f64 / 2.0).sqrt()) - 1.0).abs() < 0.01);
                grounds += 1;
            }
        }
        assert_eq!((boulders, grounds), (200, 1));
        assert_eq!(landscape.boulders, 200);
        assert!((mesh.facets.len() as f64 / 20_000.0 - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_seed_is_a_landscape_at_any_thread_count() {
        let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let [one, three] = [1, 3].map(|threads| on(threads).install(|| made(&small())).mesh);
        assert!(one == three);
        let other = made(&Recipe { seed: 12, ..small() }).mesh;
        assert!(one.vertices_m.len() > 9000 && one != other);
    }

    #[test]
    fn coordinates_survive_five_decimals_of_text() {
        let mesh = made(&small()).mesh;
        let mut seen = 0;
        for x in mesh.vertices_m.iter().flat_map(|v| v.to_array()) {
            assert_eq!(format!("{x:.5}").parse::<f64>().unwrap().to_bits(), x.to_bits());
            seen += 1;
        }
        assert!(seen > 27_000);
    }

    #[test]
    fn more_facets_are_the_same_place() {
        // Grids of 50 and of 100 cells share every other point; steps of 20 and 10 m leave out what is below 60 and 30 m.
        let mut recipe = Recipe { facets: 5000, size_m: 1000.0, ..Recipe::new(5) }.with_boulders(0);
        recipe.relief = Relief { rms_m: 20.0, longest_m: 640.0, hurst: 0.9 };
        recipe.craters = Craters { count: 100, min_diameter_m: 60.0, ..Craters::default() };
        let coarse = made(&recipe).mesh;
        recipe.facets = 20_000;
        let fine = made(&recipe).mesh;
        assert_eq!((coarse.facets.len(), fine.facets.len()), (5000, 20_000));
        // Wavelengths 640, 320, 160, 80 in both; 40 in the fine one alone, with 20 sqrt(1 - 4^-0.9) 2^(-4 0.9) m.
        let rms_m = 20.0 * (1.0 - 4f64.powf(-0.9)).sqrt() * 2f64.powf(-3.6);
        let bound_m = rms_m * (6.0 * 2_081_079.0 / 193_670.0f64).sqrt() + 1e-5;
        let mut squares_m2 = 0.0;
        let mut heights_m2 = 0.0;
        for j in 0..=50 {
            for i in 0..=50 {
                let (a, b) = (coarse.vertices_m[j * 51 + i], fine.vertices_m[2 * j * 101 + 2 * i]);
                assert_eq!((a.x, a.y), (b.x, b.y));
                assert!((a.z - b.z).abs() < bound_m, "{a} {b}");
                squares_m2 += (a.z - b.z).powi(2);
                heights_m2 += a.z.powi(2);
            }
        }
        let [difference_m, height_m] = [squares_m2, heights_m2].map(|sum: f64| (sum / 51.0 / 51.0).sqrt());
        assert!((difference_m / rms_m - 1.0).abs() < 0.2, "{difference_m} {rms_m}");
        assert!(height_m > 5.0 * difference_m);
    }

    #[test]
    fn a_crater_on_flat_ground_is_a_fifth_as_deep_as_wide() {
        let mut recipe = Recipe { facets: 500_000, size_m: 1000.0, ..Recipe::new(3) }.with_boulders(0);
        recipe.relief.rms_m = 0.0;
        recipe.craters =
            Craters { count: 1, min_diameter_m: 200.0, max_diameter_m: 200.0, softness: 0.0, ..Craters::default() };
        let (lo, hi) = made(&recipe).mesh.bounds_m().unwrap();
        // Grid points miss centre and crest by at most 1.42 m: 40 m (1.42 / 100)^2 and the inner wall's slope of 0.8.
        assert!((lo.z + 32.0).abs() < 0.01, "{lo}");
        assert!(hi.z <= 8.0 && hi.z > 8.0 - 0.2, "{hi}");
    }

    #[test]
    fn boulders_are_sunk_as_asked() {
        let mut recipe = small();
        recipe.relief.rms_m = 0.0;
        recipe.craters.count = 0;
        for sunk in [0.0, 0.3, 0.5, 1.0] {
            recipe.boulders.sunk = sunk;
            let mesh = made(&recipe).mesh;
            let mut seen = 0;
            for part in components(&mesh).iter().filter(|part| mesh.material[part[0]] == BOULDER) {
                let heights_m = || part.iter().flat_map(|&i| mesh.facet(i).corners_m).map(|p| p.z);
                let (lo, hi) = (heights_m().fold(f64::MAX, f64::min), heights_m().fold(f64::MIN, f64::max));
                assert!((-lo - sunk * (hi - lo)).abs() < 3e-5, "{lo} {hi}");
                seen += 1;
            }
            assert_eq!(seen, 200);
        }
    }

    #[test]
    fn stopping_makes_nothing() {
        for stop_at in [0.0, 0.3, 1.0] {
            let result = generate(&small(), &|p| (p.done as f64) < stop_at * p.total as f64);
            assert!(matches!(result, Err(Error::Interrupted)), "{stop_at}");
        }
    }

    #[test]
    fn bad_values_are_refused_before_anything_is_made() {
        let recipe = Recipe { facets: 4_100_000, ..small() };
        let Err(Error::Invalid(problems)) = generate(&recipe, &|_| unreachable!()) else { panic!("accepted") };
        assert_eq!(problems, recipe.check());
        assert_eq!(problems.len(), 1);
    }
}
