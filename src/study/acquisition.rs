//! Acquisition of a moving scene: each part of the cube at its own epoch.

use super::block::Ground;
use super::cost::has_room;
use super::extremes::Extremes;
use super::maps::{MapAccount, MapOptions, Ready};
use super::moments::Solved;
use super::moving::Moving;
use super::observation::{Observation, Put};
use super::simulate::account_for;
use super::spectrometer;
use super::through_optics::{Blurs, Seen, other_spectra, serves};
use crate::error::{Error, Location, Problem, Result};
use crate::integrate::{self, Image, Wanted};
use crate::product::{Backplanes, Exposed, Exposures, FacetTable, Footprints, Plane, RadianceMap, Slab};
use crate::progress::{Progress, Watch, tell};
use crate::scene::{Readout, Scene, Take};
use crate::solve;

/// What a stage of progress is called here.
const STAGE: &str = "exposures";

impl Moving<'_> {
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
}

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
    let solved = Solved::within(moving, groups.as_ref(), (extremes, tolerance), watch)?;
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
    let solved = Solved::given(moving, groups.as_ref(), table);
    let mut observation = acquire((moving, solved), (table, None), (extremes, tolerance), wanted, put, watch)?;
    let message = "the facet table is of one epoch: illumination is held fixed while the camera moves";
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
    let solved = Solved::given(moving, None, table);
    let extremes = Extremes::new(scene);
    let wanted = Wanted { footprints: wanted.footprints || options.footprints, ..wanted };
    let of = (&extremes, tolerance);
    let mut observation = acquire((moving, solved), (table, Some(&mut maps)), of, wanted, put, watch)?;
    let account = maps.account_to(scene, &mut observation)?;
    let message = "radiance maps are of one epoch: illumination is held fixed while the camera moves";
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
        let message = format!(
            "band {} has no exposure of its own, unlike each band of a tunable filter",
            other.saturating_add(1)
        );
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
    let (mut observation, _) =
        account_for(scene, (table, extremes), reference, by_line.then_some(&lines), uses_sun, watch)?;
    if by_line {
        (observation.backplanes, observation.footprints) = (lines, footprints);
    }
    let reference = (timing.readout == Readout::Band).then(|| timing.reference(&scene.exposure));
    observation.warnings.extend(
        moving.smear_remark(tolerance).into_iter().chain(moving.advance_remark()).chain(solved.remark(tolerance)),
    );
    observation.exposures = Some(Exposures { origin_m: scene.body.origin_m, taken, reference });
    Ok(observation)
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
