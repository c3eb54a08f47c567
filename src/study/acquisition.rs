//! What a camera sees of a scene that moves: each part of the cube at its own moment.

use std::rc::Rc;

use glam::DVec2;

use super::cost::has_room;
use super::effects::Given;
use super::extremes::Extremes;
use super::maps::{MapAccount, MapOptions, Ready};
use super::observation::{Observation, Put};
use super::simulate::account_for;
use super::spectrometer;
use super::through_optics::{Blurs, Seen, other_spectra, refined, serves};
use crate::error::{Error, Location, Problem, Result};
use crate::flight::Epoch;
use crate::geometry::{FrameCamera, whole, whole_u32};
use crate::instrument::Optics;
use crate::integrate::{self, Image, Wanted};
use crate::product::{Backplanes, CubeAxes, Exposed, Exposures, FacetTable, Footprints, Plane, RadianceMap, Slab};
use crate::progress::{Progress, Watch, tell};
use crate::scene::{Body, Exposure, Motion, Readout, Scene, Setup, Take, Timing};
use crate::solve;
use crate::visibility::FacetGroups;

/// A scene at the moment of its reference exposure, and how it moves.
#[derive(Debug, Clone, Copy)]
pub struct Moving<'a> {
    /// The scene then.
    pub scene: &'a Scene,
    /// How it moves.
    pub motion: &'a Motion,
    /// When what is taken.
    pub timing: Timing,
    /// What blurs an image before it is taken.
    pub optics: Option<&'a Optics>,
}

/// Between two moments that tell a rate, s.
const BESIDE_S: f64 = 1.0;
/// Moments at which the Sun's rate is looked at.
const RATES: u32 = 65;
/// The Sun goes no farther than this, rad, from one solved moment to the next.
const MOST_RAD: f64 = 0.02;
/// Exposures whose smear is looked at, and steps in each.
const SMEARS: usize = 16;
const SMEAR_STEPS: u32 = 8;
/// A smear of fewer pixels is not worth a word.
const SMEAR_PX: f64 = 0.05;
/// Of fewer exposures each is solved for, if no bound says otherwise.
const WORTH_A_LOOK: usize = 16;
/// Lines that tell how far off an image is that is taken by lines.
const LINES: u32 = 64;
/// What a stage of progress is called here.
const STAGE: &str = "exposures";

impl Moving<'_> {
    /// The scene at the moment of a part of the cube, with what is exposed then, of a body or a part of it; under a sky that moves, or stands still.
    fn at(&self, body: &Body, take: &Take, is_still: bool) -> Result<Scene> {
        let Moving { scene, motion, .. } = *self;
        let sky = if is_still { scene.sky.clone() } else { motion.sky(&scene.sky, self.epoch(take))? };
        Scene::new(Setup { body: body.clone(), sky, exposure: self.exposure(take)?, models: scene.models })
    }

    /// What is exposed of a part of the cube, with the camera where it then is.
    pub(super) fn exposure(&self, take: &Take) -> Result<Exposure> {
        self.exposure_at(take, take.middle_s)
    }

    fn exposure_at(&self, take: &Take, s: f64) -> Result<Exposure> {
        let mut exposure = take.exposure(&self.scene.exposure);
        exposure.camera.world_from_sensor = take.pose(self.motion.pose(self.motion.start.after_s(s))?, s);
        Ok(exposure)
    }

    /// The radiance of a part of the cube: the mean of its poses, under the sky of its middle; if they are wanted also the planes and footprints of its middle.
    fn looked_at(
        &self,
        (take, with_planes): (&Take, bool),
        then: &Scene,
        table: &FacetTable,
        footprints: bool,
        (blurs, put): (Option<&Blurs>, &mut dyn FnMut(Slab) -> Result<()>),
        watch: Watch<'_>,
    ) -> Result<Option<Ground>> {
        if self.timing.poses <= 1 && self.optics.is_none() {
            let wanted =
                Wanted { radiance_alone: !with_planes, footprints: with_planes && footprints, ..Wanted::default() };
            let Image { mut slab, backplanes, footprints, .. } = integrate::integrate(then, table, wanted, watch)?;
            if !then.exposure.spectrometer.is_ideal() {
                slab = spectrometer::radiance(then, table, watch)?;
            }
            put(slab)?;
            return Ok(with_planes.then_some((backplanes, footprints)));
        }
        let ground = || {
            let wanted = Wanted { footprints, ..Wanted::default() };
            let Image { backplanes, footprints, .. } = integrate::integrate(then, table, wanted, watch)?;
            Ok::<_, Error>((backplanes, footprints))
        };
        let ground = with_planes.then(ground).transpose()?;
        if let Some(optics) = self.optics {
            let at = |s| then.seen_by(self.exposure_at(take, s)?);
            let poses: Vec<Scene> = self.timing.poses_s(take).map(at).collect::<Result<_>>()?;
            let seen = Seen { poses: &poses, table, optics };
            match blurs {
                Some(blurs) => seen.by_slabs(blurs, put, watch)?,
                None => seen.by_slabs(&Blurs::new(optics, &then.exposure), put, watch)?,
            }
            return Ok(ground);
        }
        let mut parts = Vec::new();
        let share = 1.0 / f64::from(self.timing.poses);
        for s in self.timing.poses_s(take) {
            let scene = then.seen_by(self.exposure_at(take, s)?)?;
            parts.push((share, spectrometer::radiance(&scene, table, watch)?));
        }
        put(Slab::sum(&parts).ok_or_else(other_spectra)?)?;
        Ok(ground)
    }

    /// Groups of the body's facets, where exposures may each see a small part of it.
    fn groups(&self) -> Option<FacetGroups> {
        self.timing.readout.is_along_the_way().then(|| FacetGroups::new(&self.scene.body.mesh))
    }

    /// The same by maps of radiance.
    fn shown_by_maps(
        &self,
        maps: &mut Ready,
        (take, with_planes): (&Take, bool),
        then: &Scene,
        table: &FacetTable,
        (footprints, put): (bool, &mut dyn FnMut(Slab) -> Result<()>),
        watch: Watch<'_>,
    ) -> Result<Option<Ground>> {
        let ground =
            Wanted { radiance_alone: !with_planes, footprints: with_planes && footprints, ..Wanted::default() };
        let alone = Wanted { radiance_alone: true, ..Wanted::default() };
        // One pose is that of the middle, as planes are.
        let is_one = self.timing.poses <= 1;
        let share = 1.0 / f64::from(self.timing.poses.max(1));
        let (mut parts, mut planes) = (Vec::new(), None);
        for s in self.timing.poses_s(take) {
            let scene = then.seen_by(self.exposure_at(take, s)?)?;
            let (mut image, on_scene) = maps.look(&scene, table, if is_one { ground } else { alone }, watch)?;
            let unknown = maps.note(&on_scene, take);
            maps.add(&mut image.slab, &on_scene, take, watch)?;
            maps.mark(&mut image.slab, &unknown);
            parts.push((share, image.slab));
            planes = Some((image.backplanes, image.footprints));
        }
        put(Slab::sum(&parts).ok_or_else(other_spectra)?)?;
        if with_planes && !is_one {
            let (image, _) = maps.look(then, table, ground, watch)?;
            planes = Some((image.backplanes, image.footprints));
        }
        Ok(planes.filter(|_| with_planes))
    }

    /// Some exposures, with the part of the body that they may see, if groups of its facets tell.
    pub(super) fn block(&self, takes: &[Take], groups: Option<&FacetGroups>) -> Result<Block> {
        let Some(groups) = groups else { return Ok(self.in_view(None)) };
        let mut seen = vec![false; groups.count()];
        let Exposure { spectrometer, bands, .. } = &self.scene.exposure;
        let shifts_px = &spectrometer.steps_px(bands);
        for take in takes {
            // Backplanes are those of the middle, which is the only pose if there is one.
            let middle_s = (self.timing.poses > 1).then_some(take.middle_s);
            for s in self.timing.poses_s(take).chain(middle_s) {
                let exposure = self.exposure_at(take, s)?;
                // Bands that keystone shifts look beside the slit's ends, and what is blurred comes from around, too.
                let camera = match self.optics {
                    None => exposure.camera.clone(),
                    Some(optics) => refined(&exposure, (1, optics.reach_px), 0..exposure.camera.lines)?,
                };
                for shift_px in shifts_px {
                    let mut shifted = camera.clone();
                    shifted.boresight_px[0] -= shift_px;
                    groups.add_seen(&shifted, &mut seen);
                }
            }
        }
        Ok(self.in_view(Some((groups, seen))))
    }

    /// The part of the body that is in some groups of its facets, if that is worth while.
    fn in_view(&self, groups: Option<(&FacetGroups, Vec<bool>)>) -> Block {
        let all = Block { body: self.scene.body.clone(), part: None, tables: vec![] };
        let Some((groups, seen)) = groups else { return all };
        let facets = groups.facets(&seen);
        // A body has facets: where nothing is in view, that is seen of the whole one.
        if facets.is_empty() || 2 * facets.len() > self.scene.body.mesh.facets.len() {
            return all;
        }
        Block { body: self.scene.body.part(&facets), part: Some((facets, seen)), ..all }
    }

    /// How long shadows may be taken to move steadily, s, so that no pixel is off by more than the tolerance; and how long all else may.
    fn steady_s(&self, extremes: &Extremes, tolerance: f64) -> Result<[f64; 2]> {
        let Moving { scene, motion, timing, .. } = *self;
        let duration_s = timing.middle_s(timing.count(&scene.exposure).saturating_sub(1)) - timing.middle_s(0);
        // From a moment to one beside it: further apart, a body may have turned round meanwhile.
        let beside_s = duration_s.min(BESIDE_S);
        let mut rate_rad_s = 0.0_f64;
        for i in 0..RATES {
            let s = timing.middle_s(0) + (duration_s - beside_s) * f64::from(i) / f64::from(RATES - 1);
            let towards = |s: f64| Ok::<_, Error>(motion.sky(&scene.sky, motion.start.after_s(s))?.sun.direction);
            let angle_rad = towards(s)?.angle_rad(towards(s + beside_s)?);
            rate_rad_s = rate_rad_s.max(if beside_s > 0.0 { angle_rad / beside_s } else { 0.0 });
        }
        // What is interpolated of light between facets, and of temperatures, is off by an eighth of the square of this.
        let all_else_s = MOST_RAD / rate_rad_s;
        let shadows_s = Given::new(scene, extremes, &extremes.sunlit).steady_s(rate_rad_s, tolerance);
        Ok([shadows_s.min(all_else_s), all_else_s])
    }

    /// The same for all but one in a thousand pixels: by what images between two solved moments are off by, in the middle, at the start and at the end of the acquisition.
    fn mostly_steady_s(
        &self,
        [surely_s, all_else_s]: [f64; 2],
        groups: Option<&FacetGroups>,
        tolerance: f64,
        watch: Watch<'_>,
    ) -> Result<f64> {
        let Moving { scene, timing, .. } = *self;
        let count = timing.count(&scene.exposure);
        let (first_s, last_s) = (timing.middle_s(0), timing.middle_s(count.saturating_sub(1)));
        let least_s = surely_s.max(2.0 * timing.period_s);
        let longest_s = (last_s - first_s).min(all_else_s);
        if count < WORTH_A_LOOK || surely_s >= longest_s {
            return Ok(surely_s);
        }
        let mut step_s = longest_s;
        let mut looked_at = None;
        for place in [0.5, 0.0, 1.0] {
            while step_s > least_s {
                let start_s = first_s + place * (last_s - first_s - step_s);
                // A step as long as all of the acquisition has one place.
                if looked_at == Some((start_s, step_s)) {
                    break;
                }
                looked_at = Some((start_s, step_s));
                let off = self.off_between(start_s, step_s, groups, watch)?;
                if off <= tolerance {
                    break;
                }
                step_s *= (tolerance / off).clamp(0.25, 0.8);
            }
        }
        Ok(step_s.max(surely_s))
    }

    /// What all but one in a thousand pixels are at most off by in the middle of two solved moments, over the median of what is bright: of an image, or of lines in its
    /// middle if it is taken by them.
    fn off_between(&self, start_s: f64, step_s: f64, groups: Option<&FacetGroups>, watch: Watch<'_>) -> Result<f64> {
        let Moving { scene, motion, timing, .. } = *self;
        let middle_s = start_s + 0.5 * step_s;
        let mut exposure = scene.exposure.clone();
        let band = timing.reference(&exposure).min(exposure.bands.len() - 1);
        exposure.bands = vec![exposure.bands[band].clone()];
        exposure.camera.world_from_sensor = motion.pose(motion.start.after_s(middle_s))?;
        let mut in_view = None;
        if let Some(groups) = groups {
            let camera = &exposure.camera;
            let slit = whole_u32(camera.boresight_px[1]);
            let first = slit.saturating_sub(LINES / 2).min(camera.lines.saturating_sub(LINES));
            exposure.camera = camera.window(0..camera.samples, first..(first + LINES).min(camera.lines));
            let mut seen = vec![false; groups.count()];
            groups.add_seen(&exposure.camera, &mut seen);
            in_view = Some((groups, seen));
        }
        let block = self.in_view(in_view);
        let solved = |s: f64| match self.solve_part(s, &block, groups, watch)? {
            Some(table) => Ok::<_, Error>(table),
            None => Ok(block.of(&self.solve(s, watch)?)),
        };
        let sky = motion.sky(&scene.sky, motion.start.after_s(middle_s))?;
        let then = Scene::new(Setup { body: block.body.clone(), sky, exposure, models: scene.models })?;
        let CubeAxes { samples, lines, .. } = CubeAxes::of(&then.exposure);
        let pixels = samples * lines;
        let radiance = |table: &FacetTable| {
            let wanted = Wanted { radiance_alone: true, ..Wanted::default() };
            let slab = integrate::integrate(&then, table, wanted, watch)?.slab;
            let mut values = vec![0.0; pixels];
            slab.expand(0..pixels, 0..1, |pixel, _, value| values[pixel] = value[0]);
            Ok::<_, Error>(values)
        };
        let truth = radiance(&*solved(middle_s)?)?;
        let ends = [solved(start_s)?, solved(start_s + step_s)?];
        let taken = radiance(&solve::between(&then, [&*ends[0], &*ends[1]], 0.5))?;
        let mut bright: Vec<f64> = truth.iter().copied().filter(|value| *value > 0.0).collect();
        if bright.is_empty() {
            return Ok(0.0);
        }
        let middle = bright.len() / 2;
        let median = *bright.select_nth_unstable_by(middle, f64::total_cmp).1;
        let mut off: Vec<f64> = truth.iter().zip(&taken).map(|(a, b)| (a - b).abs() / median).collect();
        let rank = off.len() - 1 - off.len() / 1000;
        Ok(*off.select_nth_unstable_by(rank, f64::total_cmp).1)
    }

    /// What reaches the facets at a moment.
    fn solve(&self, s: f64, watch: Watch<'_>) -> Result<Rc<FacetTable>> {
        let Moving { scene, motion, .. } = *self;
        let then = scene.under(motion.sky(&scene.sky, motion.start.after_s(s))?)?;
        Ok(Rc::new(solve::solve(&then, watch)?))
    }

    /// What reaches the facets of a block at a moment, if they are a part of the body and ask for no others than those that stand in their light.
    fn solve_part(
        &self,
        s: f64,
        block: &Block,
        groups: Option<&FacetGroups>,
        watch: Watch<'_>,
    ) -> Result<Option<Rc<FacetTable>>> {
        let Moving { scene, motion, .. } = *self;
        let (Some(groups), Some((facets, seen)), true) = (groups, &block.part, solve::is_local(&scene.models)) else {
            return Ok(None);
        };
        let sky = motion.sky(&scene.sky, motion.start.after_s(s))?;
        let then = Scene::new(Setup {
            body: block.body.clone(),
            sky,
            exposure: scene.exposure.clone(),
            models: scene.models,
        })?;
        let terrain = solve::Terrain::around(&scene.body, groups, seen, facets);
        Ok(Some(Rc::new(solve::solve_part(&then, &terrain, watch)?)))
    }

    /// By how many pixels what is in the middle of the mesh moves during an exposure at most, of some of them; `None` where that is not before the
    /// camera, or not known.
    fn smear_px(&self) -> Option<f64> {
        let Moving { scene, motion, timing, .. } = *self;
        if let Readout::Sample(mirror) = timing.readout {
            // The mirror is what moves.
            let turned_rad = mirror.step_rad.abs() * timing.exposure_s / mirror.sample_s;
            return Some(turned_rad / scene.exposure.camera.pitch[0]);
        }
        let (low_m, high_m) = scene.body.bounds_m()?;
        let seen = |s: f64| {
            let pose = motion.pose(motion.start.after_s(s)).ok()?;
            let camera = FrameCamera { world_from_sensor: pose, ..scene.exposure.camera.clone() };
            camera.place(0.5 * (low_m + high_m)).map(DVec2::from)
        };
        let count = timing.count(&scene.exposure);
        let of_exposure = |i: usize| {
            let at = |k: u32| timing.middle_s(i) + timing.exposure_s * (f64::from(k) / f64::from(SMEAR_STEPS) - 0.5);
            let places: Option<Vec<DVec2>> = (0..=SMEAR_STEPS).map(|k| seen(at(k))).collect();
            let places = places?;
            let end = |by: fn(DVec2, DVec2) -> DVec2| places.iter().copied().reduce(by);
            Some((end(DVec2::max)? - end(DVec2::min)?).length())
        };
        (0..count).step_by(count.div_ceil(SMEARS).max(1)).filter_map(of_exposure).reduce(f64::max)
    }

    /// What a reader of the result should know of how it was taken.
    ///
    /// `step` is the time between solved moments, s, and how many times as long as one for which no pixel is off by more than the tolerance.
    fn remarks(&self, step: Option<(f64, f64)>, tolerance: f64) -> Vec<String> {
        let smear = self.smear_px().filter(|px| *px > SMEAR_PX).map(|px| {
            let moves = format!("what is seen moves by {px:.2} pixels during an exposure");
            match self.timing.poses {
                0 | 1 => format!(
                    "{moves}, of which the middle is taken: `sensor.exposure_poses = {}` keeps errors at edges within {tolerance}",
                    Timing::poses_for(px, tolerance)
                ),
                poses => format!(
                    "{moves}, for which {poses} poses stand: at an edge a pixel is off by at most {:.1e} of the contrast",
                    self.timing.smear_error(px)
                ),
            }
        });
        let between = step.map(|(s, of_sure)| {
            let every =
                if s < 0.1 * LONGEST_S { format!("{s:.3} s") } else { "time from the first exposure to the last".to_owned() };
            let off = match of_sure > 1.0 {
                true => format!(
                    "999 of 1000 pixels are off by at most {tolerance} of the median sunlit radiance, by what images of three moments say, and none at a shadow's edge by more than {:.1e}",
                    (of_sure * tolerance).min(1.0)
                ),
                false => format!("at their edges a pixel is off by at most {tolerance} of the median sunlit radiance"),
            };
            format!("shadows are found every {every} and go steadily between: {off}")
        });
        smear.into_iter().chain(between).collect()
    }

    fn epoch(&self, take: &Take) -> Epoch {
        self.motion.start.after_s(take.middle_s)
    }
}

/// Planes of lines, and which facets their pixels see, if that is wanted.
type Ground = (Backplanes, Option<Footprints>);

/// Looks at a moving scene: `put` takes the slabs of the cube as they are made. Backplanes of a filter are those of the reference exposure, of
/// a push-broom those of its lines. The account is of the reference exposure.
///
/// # Errors
/// [`Error::Invalid`] if where something is, is not known at the moment of a part; [`Error::Interrupted`] if `watch` asks to stop.
pub fn acquire_by_slabs(
    moving: Moving<'_>,
    (extremes, tolerance): (&Extremes, f64),
    wanted: Wanted<'_>,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<(FacetTable, Observation<()>)> {
    let table = solve::solve(moving.scene, watch)?;
    let groups = moving.groups();
    let steady_s = moving.steady_s(extremes, tolerance)?;
    let mostly_s = moving.mostly_steady_s(steady_s, groups.as_ref(), tolerance, watch)?;
    let solved = Solved { steady_s: steady_s[0], ..Solved::new(moving, groups.as_ref(), mostly_s) };
    let observation = acquire((moving, solved), (&table, None), (extremes, tolerance), wanted, put, watch)?;
    Ok((table, observation))
}

/// The same by a table that is given: light, temperatures and bodies of the sky stay what they are in it, while the camera moves.
///
/// # Errors
/// As [`acquire_by_slabs`]; [`Error::Invalid`] if the table is not of this scene.
pub fn acquire_by_table(
    moving: Moving<'_>,
    table: &FacetTable,
    (extremes, tolerance): (&Extremes, f64),
    wanted: Wanted<'_>,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<Observation<()>> {
    let groups = moving.groups();
    let solved = Solved { given: Some(Rc::new(table.clone())), ..Solved::new(moving, groups.as_ref(), 0.0) };
    let mut observation = acquire((moving, solved), (table, None), (extremes, tolerance), wanted, put, watch)?;
    let message = "the facet table is of one moment: light stands still while the image is taken";
    observation.warnings.push(message.to_owned());
    Ok(observation)
}

/// The same by maps of radiance: `terms` add up, and each consists of maps of the scene from different views, as for [`observe_maps`](super::observe_maps). What they hold
/// stays what it is, while the camera moves; so does what `table` says of light.
///
/// # Errors
/// As [`acquire_by_table`] and [`observe_maps`](super::observe_maps); [`Error::Unsupported`] with smile or keystone.
pub fn acquire_by_maps(
    moving: Moving<'_>,
    (table, terms): (&FacetTable, Vec<Vec<RadianceMap>>),
    (options, tolerance): (&MapOptions, f64),
    wanted: Wanted<'_>,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<(Observation<()>, MapAccount)> {
    let scene = moving.scene;
    if !scene.exposure.spectrometer.is_ideal() {
        let feature = "maps of radiance beside smile and keystone: leave one of them out".to_owned();
        return Err(Error::Unsupported { at: Location::item("sensor"), feature });
    }
    table.fits(scene)?;
    has_room(scene, true, None)?;
    let mut maps = Ready::new(scene, terms, options, watch)?;
    // A band of a filter is one of its exposures, and asked for once; all bands are in each line.
    if moving.timing.readout != Readout::Band {
        maps.keep_bands();
    }
    let solved = Solved { given: Some(Rc::new(table.clone())), ..Solved::new(moving, None, 0.0) };
    let extremes = Extremes::new(scene);
    let wanted = Wanted { footprints: wanted.footprints || options.footprints, ..wanted };
    let of = (&extremes, tolerance);
    let mut observation = acquire((moving, solved), (table, Some(&mut maps)), of, wanted, put, watch)?;
    let account = maps.account_to(scene, &mut observation)?;
    let message = "maps of radiance are of one moment: light stands still while the image is taken";
    observation.warnings.push(message.to_owned());
    Ok((observation, account))
}

/// The same by tables as they are asked for, and one of the reference exposure; radiance is that of maps, if there are any.
fn acquire(
    (moving, mut solved): (Moving<'_>, Solved<'_>),
    (table, mut maps): (&FacetTable, Option<&mut Ready>),
    (extremes, tolerance): (&Extremes, f64),
    wanted: Wanted<'_>,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<Observation<()>> {
    let Moving { scene, timing, .. } = moving;
    let by_line = timing.readout.is_along_the_way();
    let of_band = |band: &&usize| timing.readout == Readout::Band && **band < scene.exposure.bands.len();
    if let Some(other) = wanted.planes_of.iter().find(|band| !of_band(band)) {
        let message =
            format!("band {} has no exposure of its own: each band of a tunable filter has", other.saturating_add(1));
        return Err(Error::Invalid(vec![Problem::new(Location::item("--planes-of"), message)]));
    }
    serves(moving.optics, &scene.exposure)?;
    let takes: Vec<Take> = timing.takes(&scene.exposure).collect();
    // Lines have the same bands; images of a filter each their own.
    let of_line = takes.first().filter(|_| by_line).map(|take| take.exposure(&scene.exposure));
    let blurs = of_line.zip(moving.optics).map(|(exposure, optics)| Blurs::new(optics, &exposure));
    let mut lines = Backplanes::default();
    let mut footprints = wanted.footprints.then(|| Footprints { row_start: vec![0], ..Footprints::default() });
    // Samples of a sweep that is not yet whole.
    let mut sweep: (Vec<Slab>, Vec<Ground>) = Default::default();
    let mut taken: Vec<Exposed> = Vec::new();
    let total = takes.len() as u64;
    for takes in solved.blocks(&takes) {
        let mut block = moving.block(takes, solved.groups)?;
        for take in takes {
            let done = taken.len() as u64;
            // The stages of each exposure would only flicker.
            let quiet = |_: Progress| watch(Progress { stage: STAGE, done, total });
            let then = moving.at(&block.body, take, solved.given.is_some())?;
            let table = solved.at(take, &then, &mut block, &quiet)?;
            let mut put_there = |mut slab: Slab| {
                slab.lines = take.lines.start + slab.lines.start..take.lines.start + slab.lines.end;
                slab.bands = take.bands.start + slab.bands.start..take.bands.start + slab.bands.end;
                if take.mirror.is_some() {
                    sweep.0.push(slab);
                    return Ok(());
                }
                put(slab)
            };
            let with_planes = by_line || wanted.planes_of.contains(&take.bands.start);
            let put_there = &mut put_there as &mut dyn FnMut(Slab) -> Result<()>;
            let with_footprints = by_line && wanted.footprints;
            let what = (take, with_planes);
            let ground = match &mut maps {
                Some(maps) => moving.shown_by_maps(maps, what, &then, &table, (with_footprints, put_there), &quiet)?,
                None => {
                    let to = (blurs.as_ref(), put_there);
                    moving.looked_at(what, &then, &table, with_footprints, to, &quiet)?
                }
            };
            let mut ground = ground.map(|mut ground| {
                block.rename_facets(&mut ground);
                ground
            });
            if take.mirror.is_some() {
                sweep.1.extend(ground.take());
                if take.samples.end == scene.exposure.camera.samples as usize {
                    let (slabs, parts) = std::mem::take(&mut sweep);
                    let (planes, seen): (Vec<Backplanes>, Vec<Option<Footprints>>) = parts.into_iter().unzip();
                    let seen: Option<Vec<Footprints>> = seen.into_iter().collect();
                    put(Slab::beside(&slabs))?;
                    ground = Some((
                        Backplanes::beside(&planes),
                        seen.map(|seen| Footprints::beside(&seen, take.lines.len())),
                    ));
                }
            }
            // Those of a filter's image stay its own.
            let own = ground.take_if(|_| !by_line).map(|(planes, _)| planes);
            if let Some((planes, seen)) = ground {
                add_below(&mut lines, planes);
                footprints.iter_mut().zip(&seen).for_each(|(all, seen)| all.append(seen));
            }
            taken.push(Exposed {
                take: take.clone(),
                epoch: moving.epoch(take),
                camera: then.exposure.camera.clone(),
                to_sun: then.sky.sun.direction,
                sun_m: then.sky.sun.distance_m,
                backplanes: own,
            });
            tell(watch, STAGE, done + 1, total)?;
        }
    }
    let (reference, uses_sun) = match &maps {
        Some(maps) => {
            let (image, on_scene) = maps.look(scene, table, wanted, watch)?;
            (Image { maps: Some(on_scene), ..image }, maps.use_sun())
        }
        None => (integrate::integrate(scene, table, wanted, watch)?, true),
    };
    let (mut observation, _) = account_for(scene, (table, extremes), reference, uses_sun, watch)?;
    if by_line {
        (observation.backplanes, observation.footprints) = (lines, footprints);
    }
    let reference = (timing.readout == Readout::Band).then(|| timing.reference(&scene.exposure));
    observation.warnings.extend(moving.remarks(solved.step_s.map(|s| (s, s / solved.steady_s)), tolerance));
    observation.exposures = Some(Exposures { origin_m: scene.body.origin_m, taken, reference });
    Ok(observation)
}

/// Lines of a push-broom that look at one part of the body, at most.
const BLOCK: usize = 16;

/// Some exposures, and the part of the body that they may see.
pub(super) struct Block {
    pub(super) body: Body,
    /// Its facets' numbers in the body, ascending, and the groups that they are; `None`: it is all of the body.
    part: Option<(Vec<u32>, Vec<bool>)>,
    /// The tables around, of this part, each with its moment.
    tables: Vec<(f64, Rc<FacetTable>)>,
}

impl Block {
    /// The number in the body of a facet of this part.
    pub(super) fn facet_of_body(&self, facet: u32) -> u32 {
        self.part.as_ref().map_or(facet, |(facets, _)| facets[facet as usize])
    }

    /// Facets in planes and footprints have the numbers that they have in the body.
    fn rename_facets(&self, (planes, footprints): &mut Ground) {
        let Some((facets, _)) = &self.part else { return };
        // Ascending in the part as in the body.
        footprints.iter_mut().flat_map(|of| &mut of.facet).for_each(|facet| *facet = facets[*facet as usize]);
        for value in planes.planes.iter_mut().filter(|plane| plane.name == "FACET").flat_map(|plane| &mut plane.values)
        {
            if value.is_finite() {
                *value = f64::from(facets[whole(*value)]);
            }
        }
    }

    /// The table of a moment: made when it is first asked for.
    fn table(&mut self, s: f64, made: impl FnOnce(&Block) -> Result<Rc<FacetTable>>) -> Result<Rc<FacetTable>> {
        if let Some((_, table)) = self.tables.iter().find(|(of, _)| *of == s) {
            return Ok(table.clone());
        }
        let table = made(self)?;
        self.tables.push((s, table.clone()));
        Ok(table)
    }

    /// A table of the whole body, of this part.
    fn of(&self, table: &Rc<FacetTable>) -> Rc<FacetTable> {
        self.part.as_ref().map_or_else(|| table.clone(), |(facets, _)| Rc::new(table.part(facets)))
    }
}

/// No acquisition is longer, s.
const LONGEST_S: f64 = 1e9;

/// Tables of the moments at which the scene is solved, and of those between them.
struct Solved<'a> {
    moving: Moving<'a>,
    /// Groups of the body's facets, if a block may be a part of it.
    groups: Option<&'a FacetGroups>,
    /// For how long light is steady within the tolerance everywhere, s.
    steady_s: f64,
    /// The table of all moments, if it is given.
    given: Option<Rc<FacetTable>>,
    /// From one such moment to the next, s; `None`: it is solved at each.
    step_s: Option<f64>,
    /// The moments around the last one asked for at which all of the body was solved, s after the start.
    around: Vec<(f64, Rc<FacetTable>)>,
}

impl<'a> Solved<'a> {
    fn new(moving: Moving<'a>, groups: Option<&'a FacetGroups>, steady_s: f64) -> Self {
        let period_s = moving.timing.period_s;
        Solved {
            moving,
            groups,
            steady_s: f64::NAN,
            given: None,
            step_s: (steady_s > 2.0 * period_s).then_some(steady_s.min(LONGEST_S)),
            around: vec![],
        }
    }

    /// Exposures that share a block, of lines those between the same solved moments: the more they are, the more each carries along that it does not see.
    fn blocks<'t>(&self, takes: &'t [Take]) -> Vec<&'t [Take]> {
        if self.groups.is_none() {
            return takes.chunks(1).collect();
        }
        let of_step = takes.chunk_by(|a, b| self.step_at(a.middle_s) == self.step_at(b.middle_s));
        of_step.flat_map(|takes| takes.chunks(takes.len().div_ceil(takes.len().div_ceil(BLOCK)))).collect()
    }

    /// The number of the solved moment before another one, from 0.
    fn step_at(&self, s: f64) -> f64 {
        self.step_s.map_or(0.0, |step_s| ((s - self.moving.timing.middle_s(0)) / step_s).floor())
    }

    /// The table at the moment of a part of the cube, of which the scene is given: of the block's part of the body.
    fn at(&mut self, take: &Take, then: &Scene, block: &mut Block, watch: Watch<'_>) -> Result<Rc<FacetTable>> {
        if let Some(table) = &self.given {
            let table = table.clone();
            return block.table(f64::NEG_INFINITY, |block| Ok(block.of(&table)));
        }
        let Some(step_s) = self.step_s else {
            block.tables.clear();
            return self.solved(take.middle_s, block, &[take.middle_s], watch);
        };
        // Not beyond the last exposure, where nothing may be known.
        let last = self.moving.timing.count(&self.moving.scene.exposure).saturating_sub(1);
        let [first_s, last_s] = [0, last].map(|i| self.moving.timing.middle_s(i));
        let step = self.step_at(take.middle_s);
        let ends = [step, step + 1.0].map(|i| (first_s + i * step_s).min(last_s));
        let before = self.solved(ends[0], block, &ends, watch)?;
        let after = self.solved(ends[1], block, &ends, watch)?;
        let share = if ends[1] > ends[0] { (take.middle_s - ends[0]) / (ends[1] - ends[0]) } else { 0.0 };
        Ok(Rc::new(solve::between(then, [&*before, &*after], share)))
    }

    /// The table of a block at a moment, one of those that are asked for next.
    fn solved(&mut self, s: f64, block: &mut Block, next: &[f64], watch: Watch<'_>) -> Result<Rc<FacetTable>> {
        let Solved { moving, groups, .. } = *self;
        block.table(s, |block| {
            if let Some(table) = moving.solve_part(s, block, groups, watch)? {
                return Ok(table);
            }
            if let Some((_, table)) = self.around.iter().find(|(of, _)| *of == s) {
                return Ok(block.of(table));
            }
            self.around.retain(|(of, _)| next.contains(of));
            let table = moving.solve(s, watch)?;
            self.around.push((s, table.clone()));
            Ok(block.of(&table))
        })
    }
}

/// What is known before of how a scene is taken: by how much it moves during an exposure, and what moment other commands take for all of it.
pub fn foreseen(moving: Moving<'_>, tolerance: f64) -> Vec<String> {
    let Moving { scene, timing, .. } = moving;
    let count = timing.count(&scene.exposure);
    let parts = (count > 1).then(|| {
        let reference = timing.reference(&scene.exposure);
        format!(
            "the image is taken in {count} parts over {:.1} s: bounds, and what is said of the scene, are of the middle of part {}",
            timing.duration_s(&scene.exposure),
            reference + 1
        )
    });
    parts.into_iter().chain(moving.remarks(None, tolerance)).collect()
}

/// Adds to the account of a frame that was taken at once when and from where it was.
pub fn tell_exposure(moving: Moving<'_>, tolerance: f64, observation: &mut Observation<()>) {
    let Moving { scene, timing, .. } = moving;
    let taken = timing.takes(&scene.exposure).map(|take| Exposed {
        epoch: moving.epoch(&take),
        take,
        camera: scene.exposure.camera.clone(),
        to_sun: scene.sky.sun.direction,
        sun_m: scene.sky.sun.distance_m,
        backplanes: None,
    });
    let exposures = Exposures { origin_m: scene.body.origin_m, taken: taken.collect(), reference: None };
    observation.exposures = Some(exposures);
    observation.warnings.extend(moving.remarks(None, tolerance));
}

/// Adds the planes of a line below those of the lines before.
fn add_below(all: &mut Backplanes, line: Backplanes) {
    let before = line.samples * all.lines;
    (all.samples, all.lines) = (line.samples, all.lines + line.lines);
    for Plane { name, unit, values } in line.planes {
        // A body of the sky, and a material, may be in some lines only.
        let place = all.planes.iter().position(|plane| plane.name == name).unwrap_or_else(|| {
            all.planes.push(Plane { name, unit, values: vec![0.0; before] });
            all.planes.len() - 1
        });
        all.planes[place].values.extend(values);
    }
    let pixels = all.samples * all.lines;
    all.planes.iter_mut().for_each(|plane| plane.values.resize(pixels, 0.0));
}
