//! From radiance maps of elsewhere to what a camera sees of them.

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cost::has_room;
use super::extremes::Extremes;
use super::observation::{Observation, Put};
use super::simulate::account_for;
use super::warnings::enclosed;
use super::{map_light, partly_sky};
use crate::error::{Error, Location, Problem, Result, number};
use crate::geometry::{Camera, Texels};
use crate::integrate::{self, Image, MapImage, MapView, Maps, Unknown, ViewChoice, Wanted};
use crate::product::{
    Added, FacetTable, Placement, RadianceMap, Registration, SkyShare, Slab, TexelSource, TexelWeights, ViewImage,
};
use crate::progress::{Watch, tell};
use crate::scene::{Scene, Take, Timing};
use crate::spectral::{Band, Mixes, mixes};
use crate::visibility::Seen;

/// Larger radiances are refused, W m-2 sr-1 um-1: a solar surface sends less than 1e8 at any wavelength. Single-precision products
/// can hold sums of many such values, and a wrong byte order, which makes numbers of any size, is noticed.
const LARGEST: f64 = 1e30;

/// Rounding makes less than this share of a pixel's surface known where nothing is.
const NOTHING: f64 = 1e-9;

/// A smaller unknown share of what is seen is not worth reporting: rims and rounding.
const UNTOLD: f64 = 1e-6;

/// A sum below 0 by less than this share of what was added and subtracted counts as 0: maps are in single precision.
const CANCELLED: f64 = 1e-6;

/// What is shown where maps know nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fill {
    /// An error if more than this share of what is seen is unknown; below, the known part of a facet or pixel represents the rest.
    Refuse(f64),
    /// What the scene's own sources and heat send there.
    Solved,
    /// This radiance, W m-2 sr-1 um-1.
    Value(f64),
    /// The known part of a facet or pixel represents the rest, however small it is; a pixel of which nothing is known is NaN.
    Nan,
}

impl Default for Fill {
    fn default() -> Self {
        Fill::Refuse(1e-3)
    }
}

/// How maps are put onto a scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapOptions {
    /// Which of several maps serve a facet.
    pub choice: ViewChoice,
    /// What holds between texel centres.
    pub texels: Texels,
    /// What is shown where nothing is known.
    pub fill: Fill,
    /// What is solved for the scene is added, too.
    pub add_solved: bool,
    /// Which facets each pixel sees is wanted, too.
    pub footprints: bool,
}

/// What a product says of the maps it was made from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapAccount {
    /// The maps: term by term of the sum, and in each the maps of different views.
    pub maps: Vec<MapEntry>,
    /// Share of what is seen that they know nothing of.
    pub unknown_share: f64,
    /// Pixels that show a surface of which a term of the sum knows nothing at all; they are filled as asked for, else 0.
    pub unknown_pixels: u64,
    /// Largest angle between the direction of a pixel and that from which the map that serves it was seen, deg.
    pub largest_angle_deg: f64,
    /// Bound of the error by quadrature between texel centres, relative to the largest value around; 0 where texels are constant.
    pub quadrature_error: f64,
}

/// A map of a product.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapEntry {
    /// What it is called.
    pub name: String,
    /// Which term of the sum it is, from 1.
    pub term: u64,
    /// What its radiance was multiplied by.
    pub weight: f64,
    /// Its texels.
    pub texels: u64,
    /// Texels without a value.
    pub undefined_texels: u64,
    /// Its bands that were used.
    pub bands: u64,
    /// Texels that show the scene only in part, whose values (means over the whole texel) were divided by that share.
    pub divided_texels: u64,
    /// Where it was found to lie by its outline, if it was looked for.
    pub registration: Option<RegistrationEntry>,
}

/// Where an image was found to lie.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegistrationEntry {
    /// Columns and rows by which the content is shifted from its stated position.
    pub shift_texels: [f64; 2],
    /// The same along its lines and across, m.
    pub shift_m: [f64; 2],
    /// Share of the outlines' area that image and scene have in common at the stated position.
    pub overlap_as_printed: f64,
    /// The same after the shift.
    pub overlap: f64,
    /// How far from there it may lie, along its lines and across, because no outline decides, m: 0 where one does.
    pub unverified_m: [f64; 2],
}

impl From<&Registration> for RegistrationEntry {
    fn from(found: &Registration) -> Self {
        let Registration { shift_texels, shift_m, overlap: [overlap_as_printed, overlap], unverified_m } = *found;
        RegistrationEntry { shift_texels, shift_m, overlap_as_printed, overlap, unverified_m }
    }
}

/// Images a scene from radiance maps: `terms` add up, and each consists of maps of the scene from different views.
///
/// `table` says where the scene is lit, and fills gaps if requested.
///
/// # Errors
/// [`Error::Invalid`] if a map is not of this scene, lacks a band, or holds a negative or infinite radiance, or if maps know too
/// little of what is seen; whatever their sources report; [`Error::Interrupted`] if `watch` asks to stop.
pub fn observe_maps(
    scene: &Scene,
    table: &FacetTable,
    terms: Vec<Vec<RadianceMap>>,
    options: &MapOptions,
    watch: Watch<'_>,
) -> Result<(Observation, MapAccount)> {
    Observation::held(scene, |put| observe_maps_by_slabs(scene, table, terms, options, put, watch))
}

/// As [`observe_maps`], but `put` takes the slabs of the cube as they are made: for a frame camera one.
///
/// # Errors
/// As [`observe_maps`], and what `put` says.
pub fn observe_maps_by_slabs(
    scene: &Scene,
    table: &FacetTable,
    terms: Vec<Vec<RadianceMap>>,
    options: &MapOptions,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<(Observation<()>, MapAccount)> {
    table.fits(scene)?;
    has_room(scene, true, None)?;
    let mut maps = Ready::new(scene, terms, options, watch)?;
    let take = Timing::default().takes(&scene.exposure).next();
    let take = take.ok_or_else(|| Error::invalid(Location::item("sensor"), "takes nothing"))?;
    let wanted = Wanted { footprints: options.footprints, ..Wanted::default() };
    let (mut image, on_scene) = maps.look(scene, table, wanted, watch)?;
    let unknown = maps.note(&on_scene, &take);
    maps.knows_enough()?;
    maps.add(&mut image.slab, &on_scene, &take, watch)?;
    drop(on_scene);
    let (mut observation, mut slab) =
        account_for(scene, (table, &Extremes::new(scene)), image, None, maps.use_sun(), watch)?;
    // Only now: what is computed is checked for numbers that are none.
    maps.mark(&mut slab, &unknown);
    put(slab)?;
    let account = maps.account_to(scene, &mut observation)?;
    Ok((observation, account))
}

/// Maps that fit a scene, read as far as it takes to look them up, by any number of cameras; and what these found.
pub(super) struct Ready {
    terms: Vec<Term>,
    options: MapOptions,
    subtracts: bool,
    /// Whether bands are kept once they have been read, since other cameras will ask for them.
    keeps: bool,
    notes: Vec<String>,
    of_bands: Vec<String>,
    /// Samples of the cube.
    samples: usize,
    /// For each pixel of the cube whether a term knows nothing at all of what it shows.
    knows_nothing: Vec<bool>,
    area_px: f64,
    unknown_px: f64,
    largest_angle_deg: f64,
    quadrature_error: f64,
}

/// Bands of maps are kept if all of them take no more, bytes.
const KEPT_BYTES: usize = 512 << 20;

impl Ready {
    /// Maps of a scene, whose exposure is that of the whole cube.
    pub(super) fn new(
        scene: &Scene,
        terms: Vec<Vec<RadianceMap>>,
        options: &MapOptions,
        watch: Watch<'_>,
    ) -> Result<Self> {
        fit(scene, &terms)?;
        let notes = map_light::heat_counts_once(scene, &terms, options.add_solved)?;
        let subtracts = terms.iter().flatten().any(|map| map.weight < 0.0);
        if let Fill::Value(value) = options.fill
            && !(0.0..=LARGEST).contains(&value)
        {
            let message =
                format!("{} is not a radiance: give one from 0 to {LARGEST:e} W m-2 sr-1 um-1", number(value));
            return Err(Error::invalid(Location::item("unknown"), message));
        }
        if options.fill == Fill::Solved && options.add_solved {
            let message = "the scene's own light is added everywhere already: it cannot fill gaps as well";
            return Err(Error::invalid(Location::item("unknown"), message));
        }
        if options.fill == Fill::Solved && terms.len() > 1 {
            let message =
                "gaps can be filled from the scene's own sources only if all maps have their texels at the same places";
            return Err(Error::invalid(Location::item("unknown"), message));
        }
        let (mut terms, of_bands) = Term::of(scene, terms)?;
        let mut problems = Vec::new();
        for view in terms.iter_mut().flat_map(|t| &mut t.views) {
            view.read_first(&mut problems)?;
            view.find_seen(scene, options, watch)?;
            view.find_known();
            view.eye = integrate::seen_by_eye(&view.placement, scene, watch)?;
        }
        if !problems.is_empty() {
            return Err(Error::Invalid(problems));
        }
        let camera = &scene.exposure.camera;
        let (samples, lines) = (camera.samples as usize, camera.lines as usize);
        Ok(Ready {
            terms,
            options: *options,
            subtracts,
            keeps: false,
            notes,
            of_bands,
            samples,
            knows_nothing: vec![false; samples * lines],
            area_px: 0.0,
            unknown_px: 0.0,
            largest_angle_deg: 0.0,
            quadrature_error: 0.0,
        })
    }

    /// Reads each band once for all cameras that will ask for it, if memory can well hold them.
    pub(super) fn keep_bands(&mut self) {
        let views = || self.terms.iter().flat_map(|term| &term.views);
        let values: usize =
            views().flat_map(|view| view.sources.iter().map(|s| s.uses.len() * view.placement.texels())).sum();
        self.keeps = values.saturating_mul(size_of::<f64>()) <= KEPT_BYTES;
    }

    /// Whether the scene's own light is in the image, too.
    pub(super) fn use_sun(&self) -> bool {
        self.options.add_solved || self.options.fill == Fill::Solved
    }

    /// What a camera sees of the scene, as yet without their radiance, and which of their texels it sees.
    pub(super) fn look(
        &self,
        scene: &Scene,
        table: &FacetTable,
        wanted: Wanted<'_>,
        watch: Watch<'_>,
    ) -> Result<(Image, MapImage)> {
        let maps = Maps {
            terms: self.terms.iter().map(|t| t.views.iter().map(MapGroup::on_scene).collect()).collect(),
            choice: self.options.choice,
            texels: self.options.texels,
            unknown: match self.options.fill {
                Fill::Refuse(_) | Fill::Nan => Unknown::Mean,
                Fill::Solved => Unknown::Solved,
                Fill::Value(_) => Unknown::Left,
            },
            adds_solved: self.options.add_solved,
        };
        let mut image = integrate::integrate(scene, table, Wanted { maps: Some(&maps), ..wanted }, watch)?;
        let on_scene = image.maps.take().unwrap_or_default();
        Ok((image, on_scene))
    }

    /// Keeps in mind what they know of a part of the cube; the pixels of it of which they know nothing, counted in the part.
    pub(super) fn note(&mut self, on_scene: &MapImage, take: &Take) -> Vec<usize> {
        let most = |pixel: usize| on_scene.unknown.iter().map(|term| term[pixel]).fold(0.0, f64::max);
        self.area_px += on_scene.area.iter().sum::<f64>();
        self.unknown_px += (0..on_scene.area.len()).map(most).sum::<f64>();
        self.largest_angle_deg = self.largest_angle_deg.max(on_scene.largest_angle_deg);
        self.quadrature_error = self.quadrature_error.max(on_scene.quadrature_error);
        let unknown = pixels_of_nothing(on_scene);
        for pixel in &unknown {
            let (sample, line) = in_cube(take, *pixel);
            self.knows_nothing[line * self.samples + sample] = true;
        }
        unknown
    }

    /// The share of what is seen that they do not know.
    fn unknown_share(&self) -> f64 {
        if self.area_px > 0.0 { self.unknown_px / self.area_px } else { 0.0 }
    }

    /// Refuses if they know too little of what was seen.
    pub(super) fn knows_enough(&self) -> Result<()> {
        let share = self.unknown_share();
        match self.options.fill {
            Fill::Refuse(limit) if share > limit => {
                let message = format!(
                    "{:.2} % of what the camera sees is unknown: outside the maps, hidden from where they were seen, or without a value{}",
                    100.0 * share,
                    unverified(&self.terms)
                );
                let problem = Problem::new(Location::item("--radiance"), message).with_help(
                    "--unknown solve fills it from the scene's own sources, --unknown 0 with a radiance; more maps from other directions may know it",
                );
                Err(Error::Invalid(vec![problem]))
            }
            _ => Ok(()),
        }
    }

    /// Adds their radiance to a part of the cube that was looked at.
    pub(super) fn add(&mut self, slab: &mut Slab, on_scene: &MapImage, take: &Take, watch: Watch<'_>) -> Result<()> {
        let (added, magnitude) = self.add_up(on_scene, &take.bands, watch)?;
        slab.added = added;
        if self.subtracts { subtract(slab, take, &magnitude) } else { Ok(()) }
    }

    /// Makes pixels NaN of which they know nothing, if that is what marks them.
    pub(super) fn mark(&self, slab: &mut Slab, unknown: &[usize]) {
        if self.options.fill != Fill::Nan {
            return;
        }
        let places: Vec<usize> = unknown.iter().filter_map(|pixel| slab.added.place(*pixel)).collect();
        for band in bands_mut(&mut slab.added) {
            places.iter().for_each(|place| band[*place] = f64::NAN);
        }
    }

    /// What a product says of them; the account of an image of the scene learns what is worth knowing.
    pub(super) fn account_to(self, scene: &Scene, observation: &mut Observation<()>) -> Result<MapAccount> {
        self.knows_enough()?;
        let (unknown_share, unverified) = (self.unknown_share(), unverified(&self.terms));
        let unknown_pixels = self.knows_nothing.iter().filter(|knows_nothing| **knows_nothing).count();
        let views = || self.terms.iter().flat_map(|t| &t.views);
        let mut notes = self.notes;
        notes.extend(self.subtracts.then(|| subtracted(&self.terms)));
        notes.extend(told(unknown_share, unknown_pixels, &self.options, &unverified));
        notes.extend(views().flat_map(MapGroup::told));
        notes.extend(views().filter_map(|v| v.enclosed(scene)));
        notes.append(&mut observation.warnings);
        notes.extend(self.of_bands);
        observation.warnings = notes;
        if !(self.options.add_solved || self.options.fill == Fill::Solved) {
            // What maps have in them and leave out is theirs to say.
            observation.effects.clear();
        }
        Ok(MapAccount {
            maps: self.terms.iter().enumerate().flat_map(|(t, term)| term.entries(t)).collect(),
            unknown_share,
            unknown_pixels: unknown_pixels as u64,
            largest_angle_deg: self.largest_angle_deg,
            quadrature_error: self.quadrature_error,
        })
    }
}

/// Sample and line in the cube of a pixel of a part of it.
fn in_cube(take: &Take, pixel: usize) -> (usize, usize) {
    let samples = take.samples.len().max(1);
    (take.samples.start + pixel % samples, take.lines.start + pixel / samples)
}

/// A band of a map, and its weights in the sensor's bands.
type Use = (usize, Vec<(usize, f64)>);

/// A map's part that can be read.
struct MapSource {
    name: String,
    weight: f64,
    source: Box<dyn TexelSource>,
    /// For each band of the map that is needed, ascending: its weights in the sensor's bands.
    uses: Vec<Use>,
    /// Of each of these bands its values while they are held: of the first, which shows what texels have a value, until it has been used.
    held: Vec<Vec<f64>>,
    /// For each texel whether that has no value; empty if no other band is needed.
    valueless: Vec<bool>,
    /// What texels that show the scene in part hold, as far as anybody says.
    sky: SkyShare,
    /// Whether values of such texels are divided by the share that shows the scene.
    is_divided: bool,
    registration: Option<Registration>,
}

impl MapSource {
    /// The values of the first band that is needed, as long as they are held; none if no band is.
    fn first(&self) -> &[f64] {
        self.held.first().map_or(&[], Vec::as_slice)
    }

    /// Refuses a band that has a value where the first one has none: texels without a value are unknown in all bands.
    fn knows_the_same(&self, band: usize, values: &[f64], placement: &Placement) -> Result<()> {
        let odd = self.valueless.iter().zip(values).position(|(is_valueless, value)| *is_valueless && !value.is_nan());
        let Some(texel) = odd else { return Ok(()) };
        let first = self.uses.first().map_or(0, |(first, _)| *first);
        let message = format!("texel {} has a value here, and none in band {}", place(placement, texel), first + 1);
        let at = Location::item(format!("{}, band {}", self.name, band + 1));
        Err(Error::Invalid(vec![Problem::new(at, message).with_help(SAME_IN_ALL)]))
    }
}

/// What helps where bands of a map know different texels.
const SAME_IN_ALL: &str = "what a map knows must be the same in all of its bands: mark what one of them lacks as unknown in all, or make a \
                           scene for each band";

/// Maps whose texels lie at the same places.
struct MapGroup {
    placement: Placement,
    sources: Vec<MapSource>,
    known: Vec<bool>,
    /// For each texel the share of it in which its eye sees the scene; empty if not needed.
    seen: Vec<f64>,
    /// For each texel whether that share is 0; empty if every texel counts.
    sky: Vec<bool>,
    /// How many texels of each source have no value.
    undefined: Vec<u64>,
    /// What its eye sees of each facet.
    eye: Option<Seen>,
}

impl MapGroup {
    /// The warning that its eye is inside closed parts of the scene, or on them, if occlusion matters at all.
    fn enclosed(&self, scene: &Scene) -> Option<String> {
        let Placement::View(image) = &self.placement else { return None };
        let ViewImage { camera: Camera::Frame(camera), occlusion: true } = &**image else { return None };
        let name = self.sources.first().map_or("a map", |s| s.name.as_str());
        enclosed(&format!("the eye of {name}"), scene.body.topology().enclosure(&scene.body.mesh, camera.centre_m()))
    }
}

/// Maps from different views, each of the same sum.
struct Term {
    views: Vec<MapGroup>,
}

/// Says which maps cannot be of a scene.
fn fit(scene: &Scene, terms: &[Vec<RadianceMap>]) -> Result<()> {
    let facets = scene.body.mesh.facets.len();
    let mut problems = Vec::new();
    for map in terms.iter().flatten() {
        let mut problem = |message: String, help: &str| {
            problems.push(Problem::new(Location::item(&map.name), message).with_help(help));
        };
        match &map.placement {
            Placement::Facets(n) if *n != facets => problem(
                format!("has values for {n} facets, but the scene has {facets}"),
                "it was made for another mesh; facets are counted through all meshes of the scene, after faces were cut into triangles",
            ),
            Placement::Atlas(atlas) if atlas.corners.len() != facets => problem(
                format!("has texture coordinates for {} facets, but the scene has {facets}", atlas.corners.len()),
                "it was made for another mesh",
            ),
            Placement::Patches(p) if p.polygon_facet.last().is_some_and(|f| *f as usize >= facets) => {
                problem(
                    format!("has parts of facets beyond the {facets} of the scene"),
                    "it was made for another mesh",
                );
            }
            Placement::View(view) if !integrate::meets(view, scene) => problem(
                "does not overlap the scene: none of the mesh lies within the image".into(),
                "check its placement: the frame (local or body), metres, and which axis runs along lines",
            ),
            _ => {}
        }
        if u32::try_from(map.placement.texels()).is_err() {
            problem(
                format!("has {} texels", map.placement.texels()),
                "a map has fewer than 2^32 texels: cut it into several",
            );
        }
        if !map.weight.is_finite() {
            problem(format!("cannot be multiplied by {}", map.weight), "the weight must be a finite number");
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
}

impl Term {
    /// Terms with the same placements become one, whose texels are looked up once; and what to report about their bands.
    fn of(scene: &Scene, terms: Vec<Vec<RadianceMap>>) -> Result<(Vec<Term>, Vec<String>)> {
        let (mut all, mut told): (Vec<Term>, Vec<String>) = (Vec::new(), Vec::new());
        let mut problems = Vec::new();
        for maps in terms {
            let mut views = Vec::new();
            for map in maps {
                let (uses, said) = uses(&map, &scene.exposure.bands).unwrap_or_else(|wrong| {
                    problems.extend(wrong.into_iter().map(|w| Problem::new(Location::item(&map.name), w)));
                    (vec![], vec![])
                });
                // Maps of several views have the same bands.
                for said in said {
                    if !told.contains(&said) {
                        told.push(said);
                    }
                }
                let RadianceMap { name, placement, source, weight, light: _, sky, registration } = map;
                let (held, is_divided) = (vec![vec![]; uses.len()], false);
                views.push(MapGroup {
                    placement,
                    sources: vec![MapSource {
                        name,
                        weight,
                        source,
                        uses,
                        held,
                        valueless: vec![],
                        sky,
                        is_divided,
                        registration,
                    }],
                    known: vec![],
                    seen: vec![],
                    sky: vec![],
                    undefined: vec![],
                    eye: None,
                });
            }
            let same = |term: &&mut Term| {
                let pairs = term.views.iter().zip(&views);
                term.views.len() == views.len() && pairs.into_iter().all(|(a, b)| a.placement == b.placement)
            };
            match all.iter_mut().find(same) {
                Some(term) => {
                    let pairs = term.views.iter_mut().zip(views);
                    pairs.for_each(|(ours, other)| ours.sources.extend(other.sources));
                }
                None => all.push(Term { views }),
            }
        }
        if problems.is_empty() { Ok((all, told)) } else { Err(Error::Invalid(problems)) }
    }

    fn entries(&self, term: usize) -> impl Iterator<Item = MapEntry> {
        self.views.iter().flat_map(move |view| {
            view.sources.iter().zip(&view.undefined).map(move |(source, undefined)| MapEntry {
                name: source.name.clone(),
                term: term as u64 + 1,
                weight: source.weight,
                texels: view.known.len() as u64,
                undefined_texels: *undefined,
                bands: source.uses.len() as u64,
                divided_texels: if source.is_divided { view.partly_seen() } else { 0 },
                registration: source.registration.as_ref().map(RegistrationEntry::from),
            })
        })
    }
}

/// For each band of a map that is needed, ascending, its weights in the sensor's bands; and what to report about them.
fn uses(map: &RadianceMap, sensor: &[Band]) -> std::result::Result<(Vec<Use>, Vec<String>), Vec<String>> {
    let bands = map.source.bands();
    let Mixes { mixes, mut told } = mixes(bands, &map.light, sensor)?;
    told.extend(map_light::may_hold_more(map, sensor, &mixes));
    let of = |band: usize| {
        let weights = mixes
            .iter()
            .enumerate()
            .filter_map(|(s, mix)| mix.iter().find(|(m, _)| *m == band).map(|(_, weight)| (s, *weight)));
        (band, weights.collect::<Vec<_>>())
    };
    Ok(((0..bands.len()).map(of).filter(|(_, weights)| !weights.is_empty()).collect(), told))
}

impl MapGroup {
    fn on_scene(&self) -> MapView<'_> {
        MapView { placement: &self.placement, known: &self.known, sky: &self.sky, eye: self.eye.as_ref() }
    }

    /// Finds the share of each texel in which its eye sees the scene, if that matters; the first bands have been read.
    fn find_seen(&mut self, scene: &Scene, options: &MapOptions, watch: Watch<'_>) -> Result<()> {
        let Placement::View(image) = &self.placement else { return Ok(()) };
        for source in &mut self.sources {
            // Values are means over the scene already.
            if source.sky == SkyShare::Guessed && source.source.coverage()?.is_some() {
                source.sky = SkyShare::LeftOut;
            }
        }
        let is_blended = options.texels == Texels::Bilinear;
        let may_be = |source: &MapSource| partly_sky::may_be_in_means(source.sky, image, source.first());
        if is_blended || self.sources.iter().any(may_be) {
            self.seen = integrate::texels_seen(image, scene, watch)?.unwrap_or_default();
        }
        if is_blended {
            self.sky = self.seen.iter().map(|share| *share == 0.0).collect();
        }
        Ok(())
    }

    /// Texels that show the scene in part.
    fn partly_seen(&self) -> u64 {
        self.seen.iter().filter(|share| 0.0 < **share && **share < 1.0).count() as u64
    }

    /// What was done to texels at the rim of the scene, where no one stated it.
    fn told(&self) -> impl Iterator<Item = String> {
        let partly = self.partly_seen();
        let guessed = self.sources.iter().filter(move |source| source.sky == SkyShare::Guessed && partly > 0);
        guessed.filter_map(move |source| {
            let Placement::View(image) = &self.placement else { return None };
            let is_camera = matches!(image.camera, Camera::Frame(_));
            match (source.is_divided, is_camera) {
                (true, _) => Some(format!(
                    "{}: {partly} texels are partly sky and are divided by the share that shows the scene; if they are means over that share \
                     already, say `sky = \"left_out\"` in its map file",
                    source.name
                )),
                (false, true) => Some(format!(
                    "{}: what lies around the scene is as bright as the scene, so that {partly} texels at its rim are taken as they are; \
                     if the rest of them is dark sky, say `sky = \"included\"` in its map file",
                    source.name
                )),
                (false, false) => None,
            }
        })
    }

    /// Reads the first band of each source that is needed.
    fn read_first(&mut self, problems: &mut Vec<Problem>) -> Result<()> {
        let texels = self.placement.texels();
        for source in &mut self.sources {
            let (Some((band, _)), Some(values)) = (source.uses.first(), source.held.first_mut()) else { continue };
            source.source.read(*band, values)?;
            if values.len() != texels {
                let message = format!("has {} values in a band, but its placement has {texels} texels", values.len());
                problems.push(Problem::new(Location::item(&source.name), message));
                values.clear();
                continue;
            }
            self.undefined.push(values.iter().filter(|value| value.is_nan()).count() as u64);
            if source.uses.len() > 1 && values.iter().any(|value| value.is_nan()) {
                source.valueless = values.iter().map(|value| value.is_nan()).collect();
            }
        }
        Ok(())
    }

    /// Which texels have a value, by the first band of each source that is needed.
    fn find_known(&mut self) {
        self.known = vec![true; self.placement.texels()];
        for source in self.sources.iter_mut().filter(|source| !source.first().is_empty()) {
            source.is_divided = !self.seen.is_empty()
                && partly_sky::is_in_means(source.sky, &self.placement, &self.seen, source.first());
            if let Some(first) = source.held.first_mut().filter(|_| source.is_divided) {
                divide(first, &self.seen);
            }
            for (known, value) in self.known.iter_mut().zip(source.first()) {
                *known &= !value.is_nan();
            }
        }
    }
}

/// Makes means over all of each texel means over the share of it that is seen; NaN where that is nothing.
fn divide(values: &mut [f64], seen: &[f64]) {
    for (value, share) in values.iter_mut().zip(seen).filter(|(_, share)| **share < 1.0) {
        *value = if *share > 0.0 { *value / share } else { f64::NAN };
    }
}

/// Pixels that show outer sides of which some term knows nothing.
fn pixels_of_nothing(maps: &MapImage) -> Vec<usize> {
    let knows_nothing = |pixel: &usize| {
        let area = maps.area[*pixel];
        area > 0.0 && maps.unknown.iter().any(|term| term[*pixel] >= area * (1.0 - NOTHING))
    };
    (0..maps.area.len()).filter(knows_nothing).collect()
}

/// Images that may lie elsewhere, as a cause of what is unknown; empty if there are none.
fn unverified(terms: &[Term]) -> String {
    let sources = terms.iter().flat_map(|term| &term.views).flat_map(|view| &view.sources);
    let names: Vec<String> = sources
        .filter_map(|source| {
            let [along_m, across_m] = source.registration.as_ref()?.unverified_m;
            let farthest_m = along_m.max(across_m);
            (farthest_m > 0.0).then(|| format!("{} (by up to {farthest_m:.2} m)", source.name))
        })
        .collect();
    if names.is_empty() {
        return String::new();
    }
    format!(
        "; the cause may be that images lie elsewhere than assumed, which no outline can show: {}",
        names.join(", ")
    )
}

/// What is said of what maps do not know.
fn told(share: f64, pixels: usize, options: &MapOptions, unverified: &str) -> Option<String> {
    let how = match options.fill {
        Fill::Refuse(_) | Fill::Nan => "; what is known of a facet, or else of its pixel, stands for the rest of it",
        Fill::Solved => ", and is filled from the scene's own sources",
        Fill::Value(_) => ", and is filled with the radiance that was given for it",
    };
    let of_nothing = match (pixels, options.fill) {
        (0, _) | (_, Fill::Solved | Fill::Value(_)) => String::new(),
        (n, Fill::Nan) => format!("; {n} pixels of which nothing is known are NaN"),
        (n, Fill::Refuse(_)) => format!(
            "; {n} pixels of which nothing is known are 0, with MAP_COVERAGE below 1: --unknown nan marks them, --unknown solve or a \
             radiance fills them"
        ),
    };
    let percent = match 100.0 * share {
        percent if percent < 0.001 => format!("{percent:.0e}"),
        percent => format!("{percent:.3}"),
    };
    (share > UNTOLD || pixels > 0)
        .then(|| format!("{percent} % of what the camera sees is unknown to the maps{how}{of_nothing}{unverified}"))
}

/// For each pixel whether maps add something to it, or where they know nothing the fill does.
fn are_reached<'m>(on_scene: &'m MapImage, options: &MapOptions) -> impl Iterator<Item = bool> + use<'m> {
    let fills = match options.fill {
        Fill::Value(radiance) => radiance > 0.0,
        Fill::Nan => true,
        Fill::Refuse(_) | Fill::Solved => false,
    };
    let mut has_texels = vec![false; on_scene.area.len()];
    for TexelWeights { lines } in on_scene.weights.iter().flatten() {
        let pixels = lines.iter().flat_map(|line| (0..line.row_start.len()).map(|sample| line.pixel(sample)));
        has_texels.iter_mut().zip(pixels).for_each(|(has, mut texels)| *has |= texels.next().is_some());
    }
    let is_unknown = |pixel: usize| on_scene.unknown.iter().any(|term| term[pixel] > 0.0);
    has_texels.into_iter().enumerate().map(move |(pixel, has_texels)| has_texels || fills && is_unknown(pixel))
}

/// Of each band the radiance of the pixels that are reached.
fn bands_mut(added: &mut Added) -> std::slice::ChunksExactMut<'_, f64> {
    let reached = added.reached().max(1);
    added.radiance.chunks_exact_mut(reached)
}

impl Ready {
    /// Their radiance in some bands of the cube; and, if something is subtracted, for each value the sum of the magnitudes of what was added up.
    fn add_up(&mut self, on_scene: &MapImage, bands: &Range<usize>, watch: Watch<'_>) -> Result<(Added, Vec<f64>)> {
        let Ready { terms, options, subtracts, keeps, .. } = self;
        let mut added = Added::zeros(are_reached(on_scene, options), bands.len());
        let mut magnitude = vec![0.0; if *subtracts { added.radiance.len() } else { 0 }];
        // For each value of a band its pixel.
        let reached: Vec<usize> = (0..on_scene.area.len()).filter(|pixel| added.place(*pixel).is_some()).collect();
        let is_asked = |(_, shares): &&Use| shares.iter().any(|(band, _)| bands.contains(band));
        let sources = terms.iter().flat_map(|t| &t.views).flat_map(|v| &v.sources);
        let total: usize = sources.map(|s| s.uses.iter().filter(is_asked).count()).sum();
        let mut done = 0;
        for (t, term) in terms.iter_mut().enumerate() {
            let unfilled = &on_scene.unfilled[t];
            for (v, view) in term.views.iter_mut().enumerate() {
                let weights = &on_scene.weights[t][v];
                for source in &mut view.sources {
                    for (i, (band, shares)) in source.uses.iter().enumerate().filter(|(_, used)| is_asked(used)) {
                        tell(watch, "maps", done, total as u64)?;
                        done += 1;
                        let mut values = std::mem::take(&mut source.held[i]);
                        if values.is_empty() {
                            source.source.read(*band, &mut values)?;
                            source.knows_the_same(*band, &values, &view.placement)?;
                            if source.is_divided {
                                divide(&mut values, &view.seen);
                            }
                        }
                        let most = LARGEST / source.weight.abs().max(1.0);
                        let sums = weights.apply(&values, most).map_err(|texel| {
                        let texel = texel as usize;
                        let at = Location::item(format!("{}, band {}", source.name, band + 1));
                        let (place, value) = (place(&view.placement, texel), values[texel]);
                        let message = match value.is_nan() {
                            true => format!("texel {place} has no value"),
                            false => format!("texel {place} holds the radiance {}", number(value)),
                        };
                        let help = if value.is_nan() {
                            SAME_IN_ALL
                        } else if value > most {
                            "no surface sends so much: are its unit, its weight and the order of its bytes right?"
                        } else {
                            "radiance is a number of at least 0; mark unknown values by NaN, or by a `no_data` value"
                        };
                        Error::Invalid(vec![Problem::new(at, message).with_help(help)])
                    })?;
                        for (sensor_band, share) in shares.iter().filter(|(band, _)| bands.contains(band)) {
                            let first = (sensor_band - bands.start) * reached.len();
                            let out = &mut added.radiance[first..first + reached.len()];
                            for (place, (out, &pixel)) in out.iter_mut().zip(&reached).enumerate() {
                                let mut value = source.weight * share * sums[pixel];
                                let filled = on_scene.area[pixel] - unfilled[pixel];
                                let is_something = filled > NOTHING * on_scene.area[pixel];
                                if options.fill.is_by_mean() && is_something && unfilled[pixel] > 0.0 {
                                    value *= on_scene.area[pixel] / filled;
                                }
                                *out += value;
                                if let Some(sum) = magnitude.get_mut(first + place) {
                                    *sum += value.abs();
                                }
                            }
                        }
                        if *keeps {
                            source.held[i] = values;
                        }
                    }
                }
            }
        }
        if let Fill::Value(radiance) = options.fill {
            for out in bands_mut(&mut added) {
                for (out, &pixel) in out.iter_mut().zip(&reached) {
                    let most = on_scene.unknown.iter().map(|term| term[pixel]).fold(0.0, f64::max);
                    *out += radiance * most;
                }
            }
        }
        tell(watch, "maps", total as u64, total as u64)?;
        Ok((added, magnitude))
    }
}

/// Says where a sum is below 0. Below by rounding it is made 0.
fn subtract(slab: &mut Slab, take: &Take, magnitude: &[f64]) -> Result<()> {
    let (mut worst, mut count): (Option<(f64, usize, usize)>, u64) = (None, 0);
    let mut sums = vec![0.0; slab.row_start.len().saturating_sub(1)];
    for band in 0..slab.bands.len() {
        slab.expand(0..sums.len(), band..band + 1, |pixel, _, values| sums[pixel] = values[0]);
        let Slab { added, .. } = slab;
        for (pixel, &sum) in sums.iter().enumerate() {
            let at = added.place(pixel).map(|place| band * added.reached() + place);
            if sum < at.map_or(0.0, |at| -CANCELLED * magnitude[at]) {
                count += 1;
                if worst.is_none_or(|(least, ..)| sum < least) {
                    worst = Some((sum, band, pixel));
                }
            } else if let Some(at) = at.filter(|_| sum < 0.0) {
                added.radiance[at] -= sum;
            }
        }
    }
    let Some((sum, band, pixel)) = worst else { return Ok(()) };
    let (sample, line) = in_cube(take, pixel);
    let message = format!(
        "the sum is {} W m-2 sr-1 um-1 at sample {sample}, line {line} (from 0) of band {}, the least of {count} values below 0",
        number(sum),
        take.bands.start + band + 1
    );
    let problem = Problem::new(Location::item("--radiance"), message)
        .with_help("no surface sends less than nothing: a map with a weight below 0 must hold less than those that it is subtracted from");
    Err(Error::Invalid(vec![problem]))
}

/// What is said of maps that are subtracted.
fn subtracted(terms: &[Term]) -> String {
    let sources = terms.iter().flat_map(|t| &t.views).flat_map(|v| &v.sources).filter(|s| s.weight < 0.0);
    let names: Vec<String> = sources.map(|s| format!("{} times {}", s.name, s.weight)).collect();
    format!("maps are subtracted: {}; the sum is nowhere below 0", names.join(", "))
}

impl Fill {
    fn is_by_mean(&self) -> bool {
        matches!(self, Fill::Refuse(_) | Fill::Nan)
    }
}

/// What a texel is called.
fn place(placement: &Placement, texel: usize) -> String {
    let in_image = |columns: usize| format!("(row {}, column {})", texel / columns, texel % columns);
    match placement {
        Placement::View(view) => in_image(view.size()[0]),
        Placement::Atlas(atlas) => in_image(atlas.columns),
        // Of the file: without the columns that were added on both sides.
        Placement::LonLat(map) => {
            let [held, _] = map.size();
            format!("(row {}, column {})", texel / held, (texel % held + map.columns - 1) % map.columns)
        }
        Placement::Facets(_) | Placement::Patches(_) => format!("{texel} (counted from 0)"),
    }
}
