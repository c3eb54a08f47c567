//! What stands in the light of facets: the body that they are, or of which they are a part.

use crate::error::Result;
use crate::geometry::Direction;
use crate::progress::Watch;
use crate::scene::{Body, Scene};
use crate::visibility::{FacetGroups, Seen};

/// The body that hides light from a scene's facets.
#[derive(Debug)]
pub struct Terrain<'a> {
    body: &'a Body,
    /// Which of its facets the scene has; `None`: all.
    part: Option<Part<'a>>,
}

#[derive(Debug)]
struct Part<'a> {
    groups: &'a FacetGroups,
    of: &'a [bool],
    /// Those of the groups, ascending.
    facets: &'a [u32],
}

impl<'a> Terrain<'a> {
    /// The scene's own body.
    pub(super) fn of(scene: &'a Scene) -> Self {
        Terrain { body: &scene.body, part: None }
    }

    /// A body of which a scene has the facets of some groups, ascending.
    pub fn around(body: &'a Body, groups: &'a FacetGroups, of: &'a [bool], facets: &'a [u32]) -> Self {
        Terrain { body, part: Some(Part { groups, of, facets }) }
    }

    pub(super) fn body(&self) -> &Body {
        self.body
    }

    /// What an eye at infinity sees of the scene's facets; `stage` is the name reported to `watch`.
    pub(super) fn seen(&self, towards: Direction, stage: &'static str, watch: Watch<'_>) -> Result<Seen> {
        let (mesh, topology) = (&self.body.mesh, self.body.topology());
        match &self.part {
            None => Seen::from_afar(mesh, topology, towards, stage, watch),
            Some(Part { groups, of, facets }) => {
                let drawn = groups.facets(&groups.with_hiding(of, towards));
                Seen::of_facets_from_afar(mesh, topology, towards, (facets, &drawn), stage, watch)
            }
        }
    }
}
