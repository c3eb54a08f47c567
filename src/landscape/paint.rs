//! What is where: areas of boulders, and facets of other materials.

use rayon::prelude::*;

use super::area::{Area, Lie};
use super::boulder::Boulder;
use super::check::at;
use super::crater::Crater;
use super::cratering::Ground;
use super::material::{LandscapeMaterial, index};
use super::random::{Purpose, key_in};
use super::recipe::{Paint, Painted, Recipe, Where};
use super::sheet::Sheet;
use super::sources::Sources;
use crate::error::{Error, Result};
use crate::geometry::MaterialId;
use crate::random::Draws;

/// The areas of a recipe's groups of boulders, and of what it paints.
pub(super) struct Areas<'a> {
    pub(super) boulders: Vec<Option<Area<'a>>>,
    paint: Vec<Option<Area<'a>>>,
}

impl<'a> Areas<'a> {
    /// # Errors
    /// [`Error::Invalid`] with what cannot be used of each.
    pub(super) fn new(recipe: &'a Recipe, craters: &[Crater], sources: &'a Sources) -> Result<Self> {
        let mut problems = Vec::new();
        let mut area = |item: String, area: &'a Option<Where>, number: usize| {
            let area = area.as_ref()?;
            match Area::new(area, number, recipe, craters, sources) {
                Ok(area) => Some(area),
                Err((key, message)) => {
                    problems.push(at(&format!("{item}.where.{key}"), message));
                    None
                }
            }
        };
        // Numbers that stay when a group or a rule of the other kind is added.
        let boulders: Vec<_> =
            recipe.boulders.iter().enumerate().map(|(i, b)| area(format!("boulders[{i}]"), &b.area, 2 * i)).collect();
        let paint: Vec<_> =
            recipe.paint.iter().enumerate().map(|(i, p)| area(format!("paint[{i}]"), &p.area, 2 * i + 1)).collect();
        if problems.is_empty() { Ok(Areas { boulders, paint }) } else { Err(Error::Invalid(problems)) }
    }

    /// The rules for the ground or for boulders, the last first, each with its number.
    fn rules(&self, recipe: &'a Recipe, on: Painted) -> impl Iterator<Item = (usize, &'a Paint, Option<&Area<'a>>)> {
        let rules = recipe.paint.iter().zip(&self.paint).enumerate().rev();
        rules.filter(move |(_, (p, _))| p.on == on || p.on == Painted::All).map(|(i, (p, area))| (i, p, area.as_ref()))
    }

    /// The material that the last rule which holds gives to thing number `index`; where a rule holds to a share, it is by chance.
    fn painted(
        &self,
        recipe: &'a Recipe,
        materials: &[LandscapeMaterial],
        on: Painted,
        number: usize,
        place_m: [f64; 2],
        lie: impl Fn() -> Lie,
    ) -> Option<MaterialId> {
        let kind = usize::from(on == Painted::Boulders);
        let holds = |&(i, _, area): &(usize, &Paint, Option<&Area>)| {
            let share = area.map_or(1.0, |area| area.share(place_m, &lie));
            let chance = || Draws::new(key_in(recipe.seed, Purpose::Paint, 2 * i + kind, number as u64)).unit();
            share >= 1.0 || (share > 0.0 && chance() < share)
        };
        self.rules(recipe, on).find(holds).map(|(_, paint, _)| index(materials, &paint.material))
    }

    /// The material of each facet of the ground, by its middle.
    pub(super) fn of_ground(
        &self,
        recipe: &'a Recipe,
        materials: &[LandscapeMaterial],
        sheet: &Sheet,
    ) -> Vec<MaterialId> {
        let ground = index(materials, &recipe.ground);
        if self.rules(recipe, Painted::Ground).next().is_none() {
            return vec![ground; sheet.facets.len()];
        }
        let of = |facet: usize| {
            let (place_m, lie) = sheet.lie(facet);
            self.painted(recipe, materials, Painted::Ground, facet, place_m, || lie).unwrap_or(ground)
        };
        (0..sheet.facets.len()).into_par_iter().with_min_len(1 << 12).map(of).collect()
    }

    /// The material that boulder number `number` is painted with.
    pub(super) fn of_boulder(
        &self,
        recipe: &'a Recipe,
        materials: &[LandscapeMaterial],
        number: usize,
        boulder: &Boulder,
        ground: &Ground,
    ) -> Option<MaterialId> {
        let place_m = [boulder.x_m, boulder.y_m];
        let lie = || Lie::of(ground, place_m, boulder.diameter_m);
        self.painted(recipe, materials, Painted::Boulders, number, place_m, lie)
    }
}
