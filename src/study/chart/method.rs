//! Ways to make an image of a scene: each is a value that says what it is, and runs.

use rayon::prelude::*;

use super::case::{Case, Planned, Seconds};
use super::sampled;
use super::shading::{Shading, Share};
use crate::error::Result;
use crate::geometry::SphereShown;
use crate::integrate;
use crate::physics::sun_disc::DiscRule;
use crate::product::FacetTable;
use crate::progress::Watch;
use crate::scene::{Body, Models, Scene, Setup, SunModel};
use crate::solve::{self, ImagePart};
use crate::study::plan::decide;
use crate::visibility::RayTree;

/// What methods of a kind vary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// Nothing: all effects, each as fine as there is time for.
    Full,
    /// Which effects are computed.
    Models,
    /// Nothing: direct light and heat, exactly.
    Exact,
    /// How pixels are filled.
    Image,
    /// How shadows are found.
    Shadows,
    /// How many facets the mesh has.
    Facets,
    /// Another program.
    Other,
}

/// What a method answers, and what it is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Which effects: against all of them.
    Effects,
    /// How pixels, shadows and surfaces are computed: against the same effects, exactly.
    Geometry,
}

impl Question {
    /// Both.
    pub const ALL: [Question; 2] = [Question::Effects, Question::Geometry];

    /// The family of what its methods are compared with.
    pub fn truth(self) -> Family {
        match self {
            Question::Effects => Family::Full,
            Question::Geometry => Family::Exact,
        }
    }
}

impl Family {
    /// What is varied, in a few words.
    pub fn title(self) -> &'static str {
        match self {
            Family::Full => "all effects, finest",
            Family::Models => "as --model and --tolerance choose",
            Family::Exact => "exact areas and shadows",
            Family::Image => "by rays",
            Family::Shadows => "shadows otherwise",
            Family::Facets => "coarser mesh",
            Family::Other => "other programs",
        }
    }

    /// What its methods answer.
    pub fn question(self) -> Question {
        match self {
            Family::Full | Family::Models => Question::Effects,
            _ => Question::Geometry,
        }
    }
}

/// How shadows are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shadows {
    /// Not at all: what faces the Sun is lit.
    Absent,
    /// One ray from each facet's centroid: a facet is lit or dark all over.
    Centroid,
    /// The share of each facet that is sunlit, spread evenly over it.
    Share,
    /// The parts of each facet that a point Sun sees, exactly.
    Pieces,
    /// The same of each of some points that stand for the Sun's disc.
    Disc(DiscRule),
}

/// A way to make an image.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// All effects, each as fine as there is time for.
    Full,
    /// The effects of a plan.
    Planned(Planned),
    /// Direct light and heat: exact areas, shadows of the Sun's disc by many points. The methods below compute the same effects.
    Exact,
    /// As many rays in each pixel, and from where each ends one to the Sun.
    Rays(u32),
    /// Exact areas, coarser shadows.
    Shadows(Shadows),
    /// Exact on a mesh whose vertices are merged in cubes of so many mean edges.
    Facets(f64),
}

/// Radiance of every pixel, `[band, pixel]`, W m-2 sr-1 um-1.
pub type Bands = Vec<Vec<f64>>;

impl Method {
    /// All that differ in geometry alone, the exact one first, each family from coarse to fine.
    pub fn of_geometry() -> Vec<Method> {
        let rays = [1, 4, 16, 64, 256, 1024].map(Method::Rays);
        let disc = [DiscRule::G3, DiscRule::G7].map(Shadows::Disc);
        let shadows = [&[Shadows::Absent, Shadows::Centroid, Shadows::Share, Shadows::Pieces], &disc[..]].concat();
        let shadows: Vec<Method> = shadows.into_iter().map(Method::Shadows).collect();
        let facets = [8.0, 4.0, 2.0].map(Method::Facets);
        [&[Method::Exact][..], &rays, &shadows, &facets].concat()
    }

    /// What it varies.
    pub fn family(&self) -> Family {
        match self {
            Method::Full => Family::Full,
            Method::Planned(_) => Family::Models,
            Method::Exact => Family::Exact,
            Method::Rays(_) => Family::Image,
            Method::Shadows(_) => Family::Shadows,
            Method::Facets(_) => Family::Facets,
        }
    }

    /// A short name.
    pub fn name(&self) -> String {
        match self {
            Method::Full => "all effects, finest".into(),
            Method::Planned(planned) => planned.name(),
            Method::Exact => "exact".into(),
            Method::Rays(1) => "1 ray a pixel".into(),
            Method::Rays(rays) => format!("{rays} rays"),
            Method::Shadows(Shadows::Absent) => "no shadows".into(),
            Method::Shadows(Shadows::Centroid) => "one shadow ray a facet".into(),
            Method::Shadows(Shadows::Share) => "sunlit share of facets".into(),
            Method::Shadows(Shadows::Pieces) => "exact shadows of a point Sun".into(),
            Method::Shadows(Shadows::Disc(rule)) => format!("Sun's disc by {} points", rule.count()),
            Method::Facets(edges) => format!("mesh {edges} x coarser"),
        }
    }

    /// What it does, in a sentence or two.
    pub fn account(&self, case: &Case) -> String {
        match self {
            Method::Full => case.full_account.clone(),
            Method::Planned(planned) => format!("Exact areas and shadows. {}", planned.account),
            Method::Exact => "Areas of facets in pixels are exact, and so is what of each facet each of 37 points of the Sun's disc sees. Light that comes \
                              straight from sources, Mars cut by each facet's own horizon alone, and heat. The methods below compute the same effects, and are compared with this."
                .into(),
            Method::Rays(rays) => format!(
                "Point sampling: {rays} {} through each pixel, evenly spread, and from where each ends a ray to a point of the Sun's disc.",
                if *rays == 1 { "ray" } else { "rays" }
            ),
            Method::Shadows(Shadows::Absent) => "Exact areas in pixels; every facet that faces the Sun is lit.".into(),
            Method::Shadows(Shadows::Centroid) => {
                "Exact areas in pixels; a facet is lit or dark all over, by one ray from its centroid to the Sun.".into()
            }
            Method::Shadows(Shadows::Share) => {
                "Exact areas in pixels; the sunlit share of each facet is exact, but spread evenly over the facet.".into()
            }
            Method::Shadows(Shadows::Pieces) => {
                "Exact areas in pixels, and exactly what of each facet a point Sun sees: shadows have sharp edges.".into()
            }
            Method::Shadows(Shadows::Disc(rule)) => {
                format!("Exact areas in pixels, and exactly what of each facet each of {} points of the Sun's disc sees.", rule.count())
            }
            Method::Facets(edges) => format!(
                "Everything exact, on a coarser mesh: vertices in one cube of {edges} mean edge lengths are merged (Rossignac and Borrel 1993). The \
                 time to make the mesh is not counted."
            ),
        }
    }

    /// What a simulation is asked for to compute the same effects.
    pub fn model(&self) -> String {
        match self {
            Method::Full => "full, finest".into(),
            Method::Planned(planned) => planned.asked(),
            _ => "direct light and heat".into(),
        }
    }

    /// About what it takes, CPU s.
    pub(super) fn cpu_s(&self, case: &Case) -> f64 {
        let Seconds { point_sun, disc_point, ray_a_pixel, full } = case.seconds;
        match self {
            Method::Full => full,
            Method::Planned(planned) => point_sun + planned.cost_s,
            Method::Rays(rays) => point_sun + f64::from(*rays) * ray_a_pixel,
            Method::Shadows(Shadows::Disc(rule)) => point_sun + disc_point * rule.count() as f64,
            Method::Shadows(_) => point_sun,
            Method::Exact | Method::Facets(_) => point_sun + disc_point * DiscRule::E37.count() as f64,
        }
    }

    /// What a run starts from: nothing has been computed for it yet but the scene.
    ///
    /// # Errors
    /// Those of [`Scene::new`].
    pub fn prepared(&self, case: &Case) -> Result<Scene> {
        let Setup { body, sky, exposure, models } = (*case.scene).clone();
        let mut surface = (*body).clone();
        if let Method::Facets(edges) = self {
            surface.mesh = surface.mesh.clustered(edges * mean_edge_m(&body));
        }
        let body = Body::new(surface)?;
        let models = match self {
            // It begins with the plan, for all bands.
            Method::Planned(_) => return Scene::new(Setup { body, sky, exposure, models }),
            Method::Full => case.full,
            Method::Shadows(Shadows::Disc(rule)) => Models { sun: SunModel::Disc(*rule), ..case.direct },
            Method::Shadows(_) => Models { sun: SunModel::Point, ..case.direct },
            Method::Exact | Method::Rays(_) | Method::Facets(_) => case.direct,
        };
        Scene::new(Setup { body, sky, exposure: case.exposure.clone(), models })
    }

    /// Makes the image of a scene that it has [prepared](Method::prepared).
    ///
    /// # Errors
    /// Those of [`decide`], [`solve`](solve::solve) and [`radiance`](integrate::radiance).
    pub fn image(&self, case: &Case, scene: &Scene, watch: Watch<'_>) -> Result<Bands> {
        match self {
            Method::Planned(Planned { requests, .. }) => {
                let (models, ..) = decide(scene, &requests[0], watch)?;
                let planned =
                    Setup { models: case.within(models), exposure: case.exposure.clone(), ..(**scene).clone() };
                exact(&Scene::new(planned)?, watch)
            }
            Method::Rays(rays) => sampled::by_rays(scene, *rays, watch),
            Method::Shadows(Shadows::Share) => by_share(scene, watch),
            Method::Shadows(Shadows::Absent) => {
                exact_image(scene, &solve::solve_sunlit(scene, sampled::facing_the_sun(scene), watch)?, watch)
            }
            Method::Shadows(Shadows::Centroid) => {
                let sunlit = sampled::lit_at_centroid(scene, &RayTree::new(&scene.body.mesh));
                exact_image(scene, &solve::solve_sunlit(scene, sunlit, watch)?, watch)
            }
            Method::Full | Method::Exact | Method::Facets(_) | Method::Shadows(Shadows::Pieces | Shadows::Disc(_)) => {
                exact(scene, watch)
            }
        }
    }
}

/// The image by what this program does.
pub(super) fn exact(scene: &Scene, watch: Watch<'_>) -> Result<Bands> {
    exact_image(scene, &solve::solve(scene, watch)?, watch)
}

/// The image by exact areas.
fn exact_image(scene: &Scene, table: &FacetTable, watch: Watch<'_>) -> Result<Bands> {
    let slab = integrate::radiance(scene, table, watch)?;
    let pixels = slab.row_start.len() - 1;
    let mut radiance = vec![vec![0.0; pixels]; slab.bands.len()];
    slab.expand(0..pixels, 0..slab.bands.len(), |pixel, first, values| {
        values.iter().enumerate().for_each(|(k, value)| radiance[first + k][pixel] = *value);
    });
    Ok(radiance)
}

/// The image where each facet is lit by its sunlit share, anywhere on it.
fn by_share(scene: &Scene, watch: Watch<'_>) -> Result<Bands> {
    let table = solve::solve(scene, watch)?;
    let lights: Vec<_> = table.sources.iter().filter_map(|lighting| lighting.seen()).collect();
    let facets = crate::geometry::index_u32(scene.body.mesh.facets.len());
    let of = |light: &&crate::visibility::Seen| -> Vec<f64> {
        (0..facets).into_par_iter().map(|f| light.fraction(f)).collect()
    };
    let lit_share: Vec<Vec<f64>> = lights.iter().map(of).collect();
    let Some(sunlit) = table.sunlit() else { return exact_image(scene, &table, watch) };
    let camera = &scene.exposure.camera;
    let drawn = camera.drawn();
    let (footprints, globes) = integrate::footprints_among_globes(scene, sunlit);
    let globes_in_view = scene.globes_in_view().len();
    let shading = Shading::new(scene, &table);
    let samples = camera.samples as usize;
    let of_pixel = |pixel: usize| {
        // Footprints have no centroids: angles are those at the pixel's centre.
        let [x, y] = drawn.at([pixel % samples, pixel / samples].map(|i| i as f64 + 0.5));
        let faces = |facet: u32| {
            let facet = scene.body.mesh.facet(facet as usize);
            facet.cross_m2().dot(camera.centre_m() - facet.corners_m[0]) > 0.0
        };
        let part = |area: f64| ImagePart { area, moment: [x * area, y * area] };
        let share = |(facet, area, _): (u32, f64, f64)| Share {
            facet,
            shown: part(area),
            lit: lit_share.iter().map(|shares| part(area * shares[facet as usize])).collect(),
        };
        let shares: Vec<Share> = footprints.pixel(pixel).filter(|(facet, ..)| faces(*facet)).map(share).collect();
        let mut shown = vec![SphereShown::default(); globes_in_view];
        globes[pixel].iter().for_each(|(globe, of)| shown[*globe] = *of);
        shading.pixel(&shares, &shown)
    };
    let pixels: Vec<Vec<f64>> = (0..samples * camera.lines as usize).into_par_iter().map(of_pixel).collect();
    Ok((0..scene.exposure.bands.len()).map(|band| pixels.iter().map(|p| p[band]).collect()).collect())
}

/// Mean length of the edges of a mesh, m.
fn mean_edge_m(body: &Body) -> f64 {
    let mesh = &body.mesh;
    let of = |facet: usize| {
        let [a, b, c] = mesh.facet(facet).corners_m;
        (a.distance(b) + b.distance(c) + c.distance(a)) / 3.0
    };
    let (sum_m, count) = mesh.spread(10_000).fold((0.0, 0.0), |(sum, n), facet| (sum + of(facet), n + 1.0));
    sum_m / count
}
