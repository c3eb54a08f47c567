//! What a camera sees of a scene that moves: each part of the cube at its own moment.

use std::rc::Rc;

use super::effects::Given;
use super::extremes::Extremes;
use super::observation::{Observation, Put};
use super::simulate::account_for;
use crate::error::{Error, Location, Problem, Result};
use crate::flight::Epoch;
use crate::integrate::{self, Image, Wanted};
use crate::product::{Backplanes, Exposed, Exposures, FacetTable, Plane};
use crate::progress::{Progress, Watch, tell};
use crate::scene::{Motion, Readout, Scene, Take, Timing};
use crate::solve;

/// A scene at the moment of its reference exposure, and how it moves.
#[derive(Debug, Clone, Copy)]
pub struct Moving<'a> {
    /// The scene then.
    pub scene: &'a Scene,
    /// How it moves.
    pub motion: &'a Motion,
    /// When what is taken.
    pub timing: Timing,
}

/// What a stage of progress is called here.
const STAGE: &str = "exposures";

impl Moving<'_> {
    /// The scene at the moment of a part of the cube, with what is exposed then.
    ///
    /// # Errors
    /// As [`Motion::at`].
    pub fn at(&self, take: &Take) -> Result<Scene> {
        self.motion.at(self.scene, take.exposure(&self.scene.exposure), self.epoch(take))
    }

    /// How long shadows may be taken to move steadily, s.
    fn steady_s(&self, extremes: &Extremes, tolerance: f64) -> Result<f64> {
        let Moving { scene, motion, timing } = *self;
        let duration_s = timing.middle_s(timing.count(&scene.exposure).saturating_sub(1)) - timing.middle_s(0);
        let mut towards = Vec::new();
        // The Sun's way is so even that its ends and its middle tell its rate.
        for share in [0.0, 0.5, 1.0] {
            let epoch = motion.start.after_s(timing.middle_s(0) + share * duration_s);
            towards.push(motion.sky(&scene.sky, epoch)?.sun.direction);
        }
        let most_rad = towards.windows(2).map(|two| two[0].angle_rad(two[1])).fold(0.0, f64::max);
        let rate_rad_s = if duration_s > 0.0 { most_rad / (0.5 * duration_s) } else { 0.0 };
        Ok(Given::new(scene, extremes, &extremes.sunlit).steady_s(rate_rad_s, tolerance))
    }

    fn epoch(&self, take: &Take) -> Epoch {
        self.motion.start.after_s(take.middle_s)
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
    let Moving { scene, timing, .. } = moving;
    let by_line = timing.readout == Readout::Line;
    if by_line && wanted.footprints {
        let message = "footprints of a push-broom are not written by this version";
        return Err(Error::Invalid(vec![Problem::new(Location::item("--footprints"), message)]));
    }
    let table = solve::solve(scene, watch)?;
    let mut solved = Solved::new(moving, moving.steady_s(extremes, tolerance)?);
    let takes: Vec<Take> = timing.takes(&scene.exposure).collect();
    let mut lines: Vec<Image> = Vec::new();
    let mut taken: Vec<Exposed> = Vec::new();
    tell(watch, STAGE, 0, takes.len() as u64)?;
    for (i, take) in takes.iter().enumerate() {
        let then = moving.at(take)?;
        // The stages of each exposure would only flicker.
        let quiet = |_: Progress| watch(Progress { stage: STAGE, done: i as u64, total: takes.len() as u64 });
        let table = solved.at(take, &then, &quiet)?;
        let mut image = integrate::integrate(&then, &table, Wanted::default(), &quiet)?;
        let mut slab = std::mem::take(&mut image.slab);
        (slab.lines, slab.bands) = (take.lines.clone(), take.bands.clone());
        put(slab)?;
        if by_line {
            lines.push(image);
        }
        taken.push(Exposed {
            take: take.clone(),
            epoch: moving.epoch(take),
            camera: then.exposure.camera.clone(),
            to_sun: then.sky.sun.direction,
            sun_m: then.sky.sun.distance_m,
        });
        tell(watch, STAGE, i as u64 + 1, takes.len() as u64)?;
    }
    let reference = integrate::integrate(scene, &table, wanted, watch)?;
    let (mut observation, _) = account_for(scene, (&table, extremes), reference, true, watch)?;
    if by_line {
        observation.backplanes = below_each_other(lines);
    }
    let reference = (!by_line).then(|| timing.reference(&scene.exposure));
    observation.exposures = Some(Exposures { origin_m: scene.body.origin_m, taken, reference });
    Ok((table, observation))
}

/// Tables of the moments at which the scene is solved, and of those between them.
struct Solved<'a> {
    moving: Moving<'a>,
    /// From one such moment to the next, s; `None`: it is solved at each.
    step_s: Option<f64>,
    /// The moments around the last one asked for, s after the start.
    around: Option<[(f64, Rc<FacetTable>); 2]>,
}

impl<'a> Solved<'a> {
    fn new(moving: Moving<'a>, steady_s: f64) -> Self {
        let period_s = moving.timing.period_s;
        Solved { moving, step_s: (steady_s > 2.0 * period_s).then_some(steady_s), around: None }
    }

    /// The table at the moment of a part of the cube, of which the scene is given.
    fn at(&mut self, take: &Take, then: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
        let Some(step_s) = self.step_s else { return solve::solve(then, watch) };
        let first_s = (take.middle_s / step_s).floor() * step_s;
        // Not beyond the last exposure, where nothing may be known.
        let last_s =
            self.moving.timing.middle_s(self.moving.timing.count(&self.moving.scene.exposure).saturating_sub(1));
        let ends = [first_s, first_s + step_s].map(|s| s.clamp(self.moving.timing.middle_s(0), last_s));
        let before = match &self.around {
            Some([(s, table), _]) if *s == ends[0] => table.clone(),
            Some([_, (s, table)]) if *s == ends[0] => table.clone(),
            _ => self.solve(ends[0], watch)?,
        };
        let after = match &self.around {
            Some([_, (s, table)]) if *s == ends[1] => table.clone(),
            _ => self.solve(ends[1], watch)?,
        };
        let share = if ends[1] > ends[0] { (take.middle_s - ends[0]) / (ends[1] - ends[0]) } else { 0.0 };
        let table = solve::between(then, [&before, &after], share);
        self.around = Some([(ends[0], before), (ends[1], after)]);
        Ok(table)
    }

    fn solve(&self, s: f64, watch: Watch<'_>) -> Result<Rc<FacetTable>> {
        let Moving { scene, motion, .. } = self.moving;
        let epoch = motion.start.after_s(s);
        let then = scene.under(motion.sky(&scene.sky, epoch)?)?;
        Ok(Rc::new(solve::solve(&then, watch)?))
    }
}

/// Planes of lines as those of one image.
fn below_each_other(lines: Vec<Image>) -> Backplanes {
    let mut all = Backplanes::default();
    for Image { backplanes, .. } in lines {
        if all.planes.is_empty() {
            all = backplanes;
            continue;
        }
        all.lines += backplanes.lines;
        let before = all.samples * (all.lines - backplanes.lines);
        for Plane { name, unit, values } in backplanes.planes {
            // A body of the sky may be in view of some lines only.
            let plane = match all.planes.iter().position(|plane| plane.name == name) {
                Some(i) => &mut all.planes[i],
                None => {
                    all.planes.push(Plane { name, unit, values: vec![0.0; before] });
                    let last = all.planes.len() - 1;
                    &mut all.planes[last]
                }
            };
            plane.values.extend(values);
        }
        let pixels = all.samples * all.lines;
        all.planes.iter_mut().for_each(|plane| plane.values.resize(pixels, 0.0));
    }
    all
}
