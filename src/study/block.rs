//! Blocks: consecutive exposures that see the same part of a body, which is then all that is computed.

use std::rc::Rc;

use super::moving::Moving;
use super::through_optics::refined;
use crate::error::Result;
use crate::geometry::whole;
use crate::product::{Backplanes, FacetTable, Footprints};
use crate::scene::{Body, Exposure, Take};
use crate::visibility::FacetGroups;

/// Planes of lines, and which facets their pixels see, if that is wanted.
pub(super) type Ground = (Backplanes, Option<Footprints>);

/// Most push-broom lines in a block.
pub(super) const BLOCK: usize = 16;

/// Some exposures, and the part of the body they may see.
pub(super) struct Block {
    pub(super) body: Body,
    /// Its facets' numbers in the body, ascending, and the groups that they are; `None`: it is all of the body.
    pub(super) part: Option<(Vec<u32>, Vec<bool>)>,
    /// The tables around, of this part, each with its moment.
    pub(super) tables: Vec<(f64, Rc<FacetTable>)>,
}

impl Block {
    /// The number in the body of a facet of this part.
    pub(super) fn facet_of_body(&self, facet: u32) -> u32 {
        self.part.as_ref().map_or(facet, |(facets, _)| facets[facet as usize])
    }

    /// Facets in planes and footprints have the numbers that they have in the body.
    pub(super) fn rename_facets(&self, (planes, footprints): &mut Ground) {
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
    pub(super) fn table(
        &mut self,
        s: f64,
        made: impl FnOnce(&Block) -> Result<Rc<FacetTable>>,
    ) -> Result<Rc<FacetTable>> {
        if let Some((_, table)) = self.tables.iter().find(|(of, _)| *of == s) {
            return Ok(table.clone());
        }
        let table = made(self)?;
        self.tables.push((s, table.clone()));
        Ok(table)
    }

    /// A table of the whole body, of this part.
    pub(super) fn of(&self, table: &Rc<FacetTable>) -> Rc<FacetTable> {
        self.part.as_ref().map_or_else(|| table.clone(), |(facets, _)| Rc::new(table.part(facets)))
    }
}

impl Moving<'_> {
    /// Groups of the body's facets, where exposures may each see a small part of it.
    pub(super) fn groups(&self) -> Option<FacetGroups> {
        self.timing.readout.is_along_the_way().then(|| FacetGroups::new(&self.scene.body.mesh))
    }

    /// Some exposures, with the part of the body they may see, if groups of its facets tell.
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

    /// The part of the body in some groups of its facets, if smaller enough.
    pub(super) fn in_view(&self, groups: Option<(&FacetGroups, Vec<bool>)>) -> Block {
        let all = Block { body: self.scene.body.clone(), part: None, tables: vec![] };
        let Some((groups, seen)) = groups else { return all };
        let facets = groups.facets(&seen);
        // A body has facets: where nothing is in view, that is seen of the whole one.
        if facets.is_empty() || 2 * facets.len() > self.scene.body.mesh.facets.len() {
            return all;
        }
        Block { body: self.scene.body.part(&facets), part: Some((facets, seen)), ..all }
    }
}
