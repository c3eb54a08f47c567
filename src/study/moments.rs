//! Solution epochs: how often a moving scene is solved, and tables interpolated between.

use std::rc::Rc;

use super::block::{BLOCK, Block};
use super::effects::Given;
use super::extremes::Extremes;
use super::moving::Moving;
use crate::error::{Error, Result};
use crate::geometry::whole_u32;
use crate::integrate::{self, Wanted};
use crate::product::{CubeAxes, FacetTable};
use crate::progress::Watch;
use crate::scene::{Scene, Setup, Take};
use crate::solve;
use crate::visibility::FacetGroups;

/// Interval for rates, s.
const BESIDE_S: f64 = 1.0;
/// Epochs at which the Sun's rate is sampled.
const RATES: u32 = 65;
/// Largest motion of the Sun between solutions, rad.
const MOST_RAD: f64 = 0.02;
/// Fewer exposures are all solved, if no bound says otherwise.
const WORTH_A_LOOK: usize = 16;
/// Lines sampled for the error of an image taken by lines.
const LINES: u32 = 64;

/// Longest acquisition, s.
const LONGEST_S: f64 = 1e9;

/// Tables at the solution epochs, and between them.
pub(super) struct Solved<'a> {
    moving: Moving<'a>,
    /// Groups of the body's facets, if a block may be a part of it.
    pub(super) groups: Option<&'a FacetGroups>,
    /// Time for which illumination is constant within the tolerance everywhere, s.
    steady_s: f64,
    /// The table for all epochs, if it is given.
    pub(super) given: Option<Rc<FacetTable>>,
    /// Interval of solutions, s; `None`: every exposure is solved.
    step_s: Option<f64>,
    /// The solutions around the last epoch asked for at which the whole body was solved, s after the start.
    around: Vec<(f64, Rc<FacetTable>)>,
}

impl<'a> Solved<'a> {
    /// Tables that are solved for as often as the tolerance needs.
    ///
    /// # Errors
    /// As [`solve::solve`].
    pub(super) fn within(
        moving: Moving<'a>,
        groups: Option<&'a FacetGroups>,
        (extremes, tolerance): (&Extremes, f64),
        watch: Watch<'_>,
    ) -> Result<Self> {
        let steady_s = moving.steady_s(extremes, tolerance)?;
        let mostly_s = moving.mostly_steady_s(steady_s, groups, tolerance, watch)?;
        // If nearly every exposure needs a solution, each is solved.
        let step_s = (mostly_s > 2.0 * moving.timing.period_s).then_some(mostly_s.min(LONGEST_S));
        Ok(Solved { moving, groups, steady_s: steady_s[0], given: None, step_s, around: vec![] })
    }

    /// One table for all epochs.
    pub(super) fn given(moving: Moving<'a>, groups: Option<&'a FacetGroups>, table: &FacetTable) -> Self {
        let given = Some(Rc::new(table.clone()));
        Solved { moving, groups, steady_s: f64::NAN, given, step_s: None, around: vec![] }
    }

    /// Exposures that share a block, for lines those between the same solved moments; larger blocks carry more unseen
    /// facets.
    pub(super) fn blocks<'t>(&self, takes: &'t [Take]) -> Vec<&'t [Take]> {
        if self.groups.is_none() {
            return takes.chunks(1).collect();
        }
        let of_step = takes.chunk_by(|a, b| self.step_at(a.middle_s) == self.step_at(b.middle_s));
        of_step.flat_map(|takes| takes.chunks(takes.len().div_ceil(takes.len().div_ceil(BLOCK)))).collect()
    }

    /// The warning about interpolation between solutions.
    pub(super) fn remark(&self, tolerance: f64) -> Option<String> {
        let step_s = self.step_s?;
        let of_sure = step_s / self.steady_s;
        let every = if step_s < 0.1 * LONGEST_S {
            format!("{step_s:.3} s")
        } else {
            "time from the first exposure to the last".to_owned()
        };
        let off = match of_sure > 1.0 {
            true => format!(
                "999 of 1000 pixels are off by at most {tolerance} of the median sunlit radiance, by what images of three moments say, and none at a shadow's edge by more than {:.1e}",
                (of_sure * tolerance).min(1.0)
            ),
            false => format!("the error at their edges is at most {tolerance} of the median sunlit radiance"),
        };
        Some(format!("shadows are solved every {every} and interpolated between: {off}"))
    }

    /// Index of the solution epoch before a time, from 0.
    fn step_at(&self, s: f64) -> f64 {
        self.step_s.map_or(0.0, |step_s| ((s - self.moving.timing.middle_s(0)) / step_s).floor())
    }

    /// The table at the moment of a part of the cube, of which the scene is given: of the block's part of the body.
    pub(super) fn at(
        &mut self,
        take: &Take,
        then: &Scene,
        block: &mut Block,
        watch: Watch<'_>,
    ) -> Result<Rc<FacetTable>> {
        if let Some(table) = &self.given {
            let table = table.clone();
            return block.table(f64::NEG_INFINITY, |block| Ok(block.of(&table)));
        }
        let Some(step_s) = self.step_s else {
            block.tables.clear();
            return self.solved(take.middle_s, block, &[take.middle_s], watch);
        };
        // Not beyond the last exposure, where positions may be unknown.
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

impl Moving<'_> {
    /// Intervals, s, for which shadows, and everything else, may be interpolated within the tolerance.
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
}
