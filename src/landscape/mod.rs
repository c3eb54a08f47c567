//! Makes meshes: a landscape of relief, craters and boulders from a seed and a few numbers.
//!
//! Heights and what they rest on are apart: `relief` and `cratering` say how high the ground is at any place, `base` what it is above, `layout` where the
//! mesh has its vertices, and `sheet` puts them together; boulders rest on the sheet.

mod area;
mod base;
mod body;
mod boulder;
mod check;
mod crater;
mod cratering;
mod division;
mod layout;
mod lookup;
mod material;
mod noise;
mod paint;
mod power_law;
mod preset;
mod random;
mod recipe;
mod relief;
mod sheet;
mod sources;
mod texture;
mod version_1;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub use body::WrapReport;
pub use check::FACETS;
pub use material::LandscapeMaterial;
pub use preset::{PRESETS, Preset};
pub use recipe::{
    BodyRecipe, Boulders, Craters, Detail, Height, MaterialRecipe, NearCraters, Overlap, Paint, Painted, Patches,
    PlacedBoulder, PlacedCrater, Recipe, Relief, Shape, ShapeName, Span, Surroundings, Texture, Where,
};
pub use sources::{Source, Sources};
pub use texture::Grain;
pub use version_1::RecipeOne;

use crate::error::{Error, Result};
use crate::geometry::{MaterialId, Mesh, index_u32};
use crate::progress::{Watch, tell};
use area::Lie;
use base::{Base, ON_BODY_PER_M, rounded_m};
use body::Wrap;
use boulder::{Ball, rest};
use cratering::Ground;
use material::index;
use noise::presence;
use paint::Areas;

/// Names of the materials that the ground and boulders have if a recipe says nothing.
const GROUND: &str = "phobos_blue";
const BOULDERS: &str = "phobos_red";

/// A target that is farther from its body's surface than this is told, m.
const FAR_FROM_BODY_M: f64 = 10.0;

/// The stage, as reported to the watch.
const STAGE: &str = "making the landscape";

/// A generated landscape.
#[derive(Debug, Clone)]
pub struct Landscape {
    /// The ground (one open sheet, first) and the boulders (closed bodies that stick in it), m; x east, y north, z up.
    /// Coordinates are whole multiples of 1e-5 m, so that text with five decimals holds them exactly. Material indices are
    /// those of [`materials`](Self::materials).
    ///
    /// Of a site on a body: axes of the body, whole multiples of 1e-7 m from [`origin_m`](Self::origin_m).
    pub mesh: Mesh,
    /// Where the mesh's coordinates start, body axes, m, if the site is on a body.
    pub origin_m: Option<DVec3>,
    /// What the wrap onto the body did.
    pub wrap: Option<WrapReport>,
    /// Vertices beyond the site's border, ascending: those of its surroundings.
    pub beyond: Vec<u32>,
    /// The materials, by their index in the mesh.
    pub materials: Vec<LandscapeMaterial>,
    /// All craters that the recipe asks for, in the order of their groups: the production, of which later craters erase some. Placed ones may lie beyond the site.
    pub craters: Vec<MadeCrater>,
    /// All boulders that the recipe asks for, in the order of their groups.
    pub boulders: Vec<MadeBoulder>,
    /// The texture, if the recipe asks for one.
    pub grain: Option<Grain>,
    /// Facets of the ground that face the body they lie on.
    pub folded: usize,
    /// Side of the site, m.
    pub size_m: f64,
    /// From the lowest to the highest point of the site's ground, over what it lies on, m.
    pub relief_m: f64,
}

impl Landscape {
    /// Coordinates of a site on a body from the body's centre on, still whole multiples of 1e-7 m; of another nothing changes.
    pub fn start_at_centre(&mut self) {
        let Some(origin_m) = &mut self.origin_m else { return };
        let from_m = std::mem::take(origin_m);
        self.mesh.vertices_m.par_iter_mut().for_each(|v| *v = rounded_m(*v + from_m, ON_BODY_PER_M));
    }

    /// Warnings about how it lies on its body.
    pub fn doubts(&self) -> Vec<String> {
        let far = self.wrap.filter(|wrap| wrap.target_above_m.abs() > FAR_FROM_BODY_M);
        let told = far.map(|wrap| {
            let side = if wrap.target_above_m > 0.0 { "above" } else { "below" };
            format!("the target lies {:.1} m {side} the body's surface", wrap.target_above_m.abs())
        });
        let folded = (self.folded > 0).then(|| {
            format!(
                "{} of the ground's facets face the body: relief is too high for how the body is curved there, and the mesh is folded",
                self.folded
            )
        });
        let high = (self.relief_m > self.size_m).then(|| {
            format!(
                "the ground is {:.0} m from its lowest to its highest point, on a site of {:.0} m: does a raster have numbers for no data that it does not state, or another unit?",
                self.relief_m, self.size_m
            )
        });
        told.into_iter().chain(folded).chain(high).collect()
    }
}

/// A crater of a landscape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MadeCrater {
    /// Number of its group.
    pub group: usize,
    /// Centre, east and north of the site's middle, m.
    pub centre_m: [f64; 2],
    /// Rim-to-rim diameter when it was fresh, m. Wear moves the crest outward: by up to 29 % where everything is worn away that can be.
    pub diameter_m: f64,
    /// From 0 (now) to 1 (the oldest).
    pub age: f64,
    /// Rim to floor, m, with the rim where it was: from the worn crest it is up to a tenth less.
    pub depth_m: f64,
    /// Whether the mesh is fine enough to show it.
    pub shown: bool,
}

/// A boulder of a landscape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MadeBoulder {
    /// Number of its group.
    pub group: usize,
    /// Where it lies, east and north of the site's middle, m.
    pub place_m: [f64; 2],
    /// Longest axis, m.
    pub diameter_m: f64,
    /// Share of its height that is below the ground.
    pub buried: f64,
    /// Its facets in the mesh, first and number; none if the mesh is too coarse to have it.
    pub facets: Option<[usize; 2]>,
}

/// Makes the landscape of a recipe: the same bytes at any thread count. `sources` holds the rasters that it names.
///
/// # Errors
/// [`Error::Invalid`] with all that [`Recipe::check`] finds, or with what is wrong with the rasters, or if there are too few facets for its boulders;
/// [`Error::Interrupted`] if `watch` asks to stop.
pub fn generate(recipe: &Recipe, sources: &Sources, watch: Watch<'_>) -> Result<Landscape> {
    let problems = recipe.check();
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    tell(watch, STAGE, 0, 1)?;
    let (ground, produced) = dug(recipe, sources)?;
    let areas = Areas::new(recipe, &produced, sources)?;
    let share = |group: usize, x_m: f64, y_m: f64| {
        let lie = || Lie::of(&ground, [x_m, y_m], recipe.boulders[group].min_diameter_m);
        areas.boulders[group].as_ref().map_or(1.0, |area| area.share([x_m, y_m], lie))
    };
    let boulders = boulder::all(recipe, &share).map_err(|problem| Error::Invalid(vec![problem]))?;
    let division = division::divide(recipe, &boulders).map_err(|problem| Error::Invalid(vec![problem]))?;
    let wrap = recipe.body.as_ref().map(|body| Wrap::new(body, recipe, sources)).transpose()?;
    let (origin_m, report) = (wrap.as_ref().map(|wrap| wrap.origin_m), wrap.as_ref().map(Wrap::report));
    let base = wrap.map_or(Base::Plane, |wrap| Base::Body(Box::new(wrap)));
    let sheet = sheet::Sheet::new(&division, &ground, base, watch)?;
    let wrap = report.map(|report| WrapReport { seam_m: sheet.seam_m(), ..report });
    let folded = sheet.folded();
    let relief_m = sheet.relief_m(0.5 * recipe.size_m);

    let materials = material::materials(recipe);
    let balls: Vec<Ball> = (1..=division::FINEST).map(Ball::new).collect();
    let rested: Vec<_> = (boulders.par_iter().zip(&division.frequencies))
        .map(|(boulder, frequency)| {
            let ball = balls.get((*frequency as usize).checked_sub(1)?)?;
            Some((rest(boulder, ball, &sheet), ball))
        })
        .collect();
    let mut mesh = Mesh { material: areas.of_ground(recipe, &materials, &sheet), ..Mesh::default() };
    let mut places_m = sheet.places_m().to_vec();
    let is_beyond = |place: &&[f64; 2]| place.iter().any(|p_m| p_m.abs() > 0.5 * recipe.size_m);
    let beyond = (0..).zip(&places_m).filter(|(_, place)| is_beyond(place)).map(|(v, _)| v).collect();
    mesh.facets = sheet.facets;
    mesh.vertices_m = sheet.vertices_m;
    let mut made = Vec::with_capacity(boulders.len());
    for (i, (boulder, rested)) in boulders.iter().zip(rested).enumerate() {
        let first = mesh.facets.len();
        if let Some((rested, ball)) = &rested {
            let base = index_u32(mesh.vertices_m.len());
            mesh.vertices_m.extend(&rested.vertices_m);
            places_m.extend(&rested.places_m);
            mesh.facets.extend(ball.facets.iter().map(|f| f.map(|v| v + base)));
            let of_group = index(&materials, &recipe.boulders[boulder.group].material);
            let painted = areas.of_boulder(recipe, &materials, i, boulder, &ground);
            mesh.material.resize(mesh.facets.len(), painted.unwrap_or(of_group));
        }
        made.push(MadeBoulder {
            group: boulder.group,
            place_m: [boulder.x_m, boulder.y_m],
            diameter_m: boulder.diameter_m,
            buried: boulder.buried,
            facets: rested.is_some().then_some([first, mesh.facets.len() - first]),
        });
    }
    on_body(&mesh, &places_m)?;
    let grain = recipe.texture.as_ref().map(|texture| Grain::new(texture, recipe.seed, recipe.size_m));
    if grain.is_some() {
        mesh.uv = texture::coordinates(&mesh.facets, &places_m, recipe.size_m);
    }
    tell(watch, STAGE, 1, 1)?;
    let craters = produced.iter().map(|c| MadeCrater {
        group: c.group,
        centre_m: [c.x_m, c.y_m],
        diameter_m: c.diameter_m,
        age: c.age,
        depth_m: c.depth_m,
        shown: presence(c.diameter_m, division.grading.step_at_m(c.x_m, c.y_m)) > 0.0,
    });
    Ok(Landscape {
        mesh,
        beyond,
        origin_m,
        wrap,
        materials,
        craters: craters.collect(),
        boulders: made,
        grain,
        folded,
        size_m: recipe.size_m,
        relief_m,
    })
}

/// The built-in Phobos as a mesh of 20 `frequency`^2 facets, m from its centre, body-fixed: the ellipsoid of 12.95 x 11.30 x 9.16 km with Stickney and further craters.
pub fn phobos(frequency: u32) -> Mesh {
    let ball = Ball::new(frequency.max(1));
    let material = vec![MaterialId(0); ball.facets.len()];
    Mesh { vertices_m: body::of_phobos_m(&ball.vertices), facets: ball.facets, material, ..Mesh::default() }
}

/// Refuses a mesh of which a vertex has no place, because the body under it has no surface there, or several.
fn on_body(mesh: &Mesh, places_m: &[[f64; 2]]) -> Result<()> {
    let off: Vec<usize> = (0..places_m.len()).filter(|&v| !mesh.vertices_m[v].is_finite()).collect();
    let Some(&first) = off.first() else { return Ok(()) };
    let message = format!(
        "under {} of the mesh's {} vertices the body has no surface, or several over one another, first {:.0} m east and {:.0} m north of the target",
        off.len(),
        places_m.len(),
        places_m[first][0],
        places_m[first][1]
    );
    let help = "close the shape, part what intersects, or let the site and its surroundings reach less far";
    Err(Error::Invalid(vec![check::at("body", message).with_help(help)]))
}

/// The ground of a recipe, and the craters that it asks for on its site.
fn dug(recipe: &Recipe, sources: &Sources) -> Result<(Ground, Vec<crater::Crater>)> {
    let [layers, cover] = ["relief", "cover"].map(|list| relief::layers(recipe, list, sources));
    let (layers, cover) = (layers.map_err(Error::Invalid)?, cover.map_err(Error::Invalid)?);
    let expected = cratering::expected_around(recipe);
    if expected > check::MOST_CRATERS {
        let message = format!("around the site would be {expected:.2e} craters: more than {}", check::MOST_CRATERS);
        let help = "let the surroundings reach less far or grow faster, or ask for fewer craters";
        return Err(Error::Invalid(vec![check::at("surroundings.reach_m", message).with_help(help)]));
    }
    let produced = cratering::produced(recipe);
    let mut craters = cratering::around(recipe);
    craters.splice(0..0, produced.iter().cloned());
    let reach_m = recipe.surroundings.as_ref().map_or(0.0, |s| s.reach_m);
    let half_m = 0.5 * recipe.size_m;
    Ok((Ground::new(layers, craters, cover, half_m, half_m + reach_m), produced))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::geometry::MaterialId;

    fn made(recipe: &Recipe) -> Landscape {
        generate(recipe, &Sources::default(), &|_| true).unwrap()
    }

    fn small() -> Recipe {
        Recipe { facets: 20_000, size_m: 500.0, ..Recipe::new(11) }.with_boulders(200)
    }

    impl Recipe {
        fn with_boulders(mut self, count: u32) -> Self {
            self.boulders[0].count = count;
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
            if material == MaterialId(1) {
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
        assert_eq!(landscape.boulders.iter().filter(|b| b.facets.is_some()).count(), 200);
        assert!((mesh.facets.len() as f64 / 20_000.0 - 1.0).abs() < 0.01);
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
        // Grids of 50 and of 100 cells share every other point; on steps of 20 and 10 m all is there that is at least 80 and 40 m wide.
        let mut recipe = Recipe { facets: 5000, size_m: 1000.0, ..Recipe::new(5) }.with_boulders(0);
        recipe.relief = vec![Relief::Rolling { rms_m: 20.0, longest_m: 640.0, hurst: 0.9 }];
        recipe.craters =
            vec![Craters { count: 100, min_diameter_m: 80.0, overlap: Overlap::Add, ..Craters::default() }];
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
        recipe.relief = vec![];
        let placed = vec![PlacedCrater { x_m: 31.0, y_m: -7.0, diameter_m: 200.0, age: 0.0 }];
        recipe.craters = vec![Craters { placed, ..Craters::default() }];
        let (lo, hi) = made(&recipe).mesh.bounds_m().unwrap();
        // Grid points miss centre and crest by at most 1.42 m: 40 m (1.42 / 100)^2 and the inner wall's slope of 0.8.
        assert!((lo.z + 32.0).abs() < 0.01, "{lo}");
        assert!(hi.z <= 8.0 && hi.z > 8.0 - 0.2, "{hi}");
    }

    /// Heights of a boulder's vertices over the ground's facets, by a search through all of them.
    fn heights_m(mesh: &Mesh, ground: usize, boulder: &MadeBoulder) -> Vec<f64> {
        let [first, count] = boulder.facets.unwrap();
        let mut vertices: Vec<u32> = mesh.facets[first..first + count].iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let above = |v: u32| {
            let p = mesh.vertices_m[v as usize];
            let below = mesh.facets[..ground].iter().find_map(|f| {
                let [a, b, c] = f.map(|v| mesh.vertices_m[v as usize]);
                let side = |a: glam::DVec3, b: glam::DVec3| (b - a).truncate().perp_dot((p - a).truncate());
                let [ab, bc, ca] = [side(a, b), side(b, c), side(c, a)];
                (ab >= -1e-9 && bc >= -1e-9 && ca >= -1e-9).then(|| (a.z * bc + b.z * ca + c.z * ab) / (ab + bc + ca))
            });
            p.z - below.unwrap()
        };
        vertices.into_iter().map(above).collect()
    }

    #[test]
    fn boulders_are_buried_as_asked_and_none_floats() {
        let detail = Some(Detail { x_m: 40.0, y_m: -30.0, size_m: 60.0, growth: 0.1 });
        let mut seen = 0;
        for (shape, buried, detail) in [
            (Shape::Angular, Span::One(0.0), None),
            (Shape::Slab, Span::One(0.3), None),
            (Shape::Any, Span::Range([0.1, 0.9]), detail),
            (Shape::Lumpy, Span::One(1.0), None),
        ] {
            let mut recipe = Recipe { facets: 6000, size_m: 200.0, detail, ..Recipe::new(11) };
            recipe.relief = vec![Relief::Ridged { rms_m: 8.0, longest_m: 80.0, hurst: 0.9 }];
            recipe.craters = vec![Craters { count: 30, max_diameter_m: 100.0, ..Craters::default() }];
            recipe.boulders = vec![Boulders { count: 40, shape, buried, ..Boulders::default() }];
            let made = made(&recipe);
            let ground = made.boulders[0].facets.unwrap()[0];
            for boulder in &made.boulders {
                let heights_m = heights_m(&made.mesh, ground, boulder);
                let (lo, hi) = heights_m.iter().fold((f64::MAX, f64::MIN), |(lo, hi), h| (lo.min(*h), hi.max(*h)));
                // Coordinates are rounded to 1e-5 m, on slopes of up to 2.
                assert!(
                    (-lo - boulder.buried * (hi - lo)).abs() < 1e-4,
                    "{shape:?}: {lo} to {hi}, not {}",
                    boulder.buried
                );
                assert!(lo < 1e-3, "a gap of {lo} m");
                seen += 1;
            }
        }
        assert_eq!(seen, 160);
    }

    #[test]
    fn stopping_makes_nothing() {
        for stop_at in [0.0, 0.3, 1.0] {
            let result = generate(&small(), &Sources::default(), &|p| (p.done as f64) < stop_at * p.total as f64);
            assert!(matches!(result, Err(Error::Interrupted)), "{stop_at}");
        }
    }

    #[test]
    fn bad_values_are_refused_before_anything_is_made() {
        let recipe = Recipe { facets: 4_100_000, ..small() };
        let Err(Error::Invalid(problems)) = generate(&recipe, &Sources::default(), &|_| unreachable!()) else {
            panic!("accepted")
        };
        assert_eq!(problems, recipe.check());
        assert_eq!(problems.len(), 1);
    }
}
