//! What is mended in a mesh on its way, where it is asked for, and what is told of it.

use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::geometry::Mesh;
use crate::geometry::repair::{decimate, outward, t_junctions, weld};
use crate::report::{Fate, Report};

/// What to mend, in this order. If anything is, vertices at one place become one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repairs {
    /// Make one vertex of those that are at one place, or no farther apart than this, m.
    pub weld: Option<Option<f64>>,
    /// Cut facets at corners of others that lie on their edges.
    pub t_junctions: bool,
    /// Make facets of bodies face outwards, and those of sheets as most of them do.
    pub outward: bool,
    /// Leave at most so many facets.
    pub decimate: Option<usize>,
}

impl Repairs {
    /// Whether anything is to be mended.
    pub(super) fn is_any(&self) -> bool {
        *self != Repairs::default()
    }

    /// Mends a mesh that comes from a file.
    ///
    /// # Errors
    /// [`Error::Invalid`] if nothing is left of it.
    pub(super) fn mend(&self, mesh: &mut Mesh, path: &Path, report: &mut Report) -> Result<()> {
        if !self.is_any() {
            return Ok(());
        }
        let mut told = |fate: Fate, message: String| report.note(fate, Location::file(path).with_item("mesh"), message);
        let within_m = self.weld.flatten();
        let welded = weld(mesh, within_m);
        if mesh.facets.is_empty() {
            return Err(nothing_left(within_m, welded.facets, path));
        }
        if welded.vertices > 0 {
            let (fate, where_to) = match within_m {
                Some(m) => (Fate::Approximated, format!("within {} m of another", number(m))),
                None => (Fate::Defaulted, "at the place of another".to_owned()),
            };
            let gone =
                if welded.facets > 0 { format!("; {} facets are gone by that", welded.facets) } else { String::new() };
            told(fate, format!("{} vertices {where_to} became that{gone}", welded.vertices));
        }
        if self.t_junctions {
            let corners = t_junctions(mesh);
            let message = format!("facets were cut at {corners} corners that lay on their edges, into triangles");
            told(Fate::Defaulted, message);
        }
        if self.outward {
            let turned = outward(mesh);
            let parts = if turned.parts == 1 { "one part".to_owned() } else { format!("{} parts", turned.parts) };
            told(Fate::Defaulted, format!("{} facets of {parts} were turned over", turned.facets));
            if turned.twisted_edges > 0 {
                let message =
                    format!("{} edges stay where facets turn over: the surface has one side", turned.twisted_edges);
                told(Fate::Approximated, message);
            }
            if turned.at_crowded_edges > 0 {
                let message = format!(
                    "{} facets keep the side that most of their sheet has: it ends nowhere but at edges of three or more facets, where it is not known which side is \
                     outside",
                    turned.at_crowded_edges
                );
                told(Fate::Approximated, message);
            }
        }
        if let Some(wanted) = self.decimate.filter(|wanted| mesh.facets.len() > *wanted) {
            let before = mesh.facets.len();
            let had_uv = !mesh.uv.is_empty();
            let done = decimate(mesh, wanted);
            if done.facets < before {
                let message = format!(
                    "{before} facets became {}: corners and middles of facets of one surface are at most {:.3e} m from the other, both ways",
                    done.facets, done.farthest_m
                );
                told(Fate::Approximated, message);
            }
            if done.facets > wanted {
                let message = format!(
                    "{} facets remain where {wanted} were asked for: with another edge gone, a facet would turn over, or the surface would open, \
                     close or touch itself; edges of three or more facets stay",
                    done.facets
                );
                told(Fate::Approximated, message);
            }
            if had_uv && mesh.uv.is_empty() {
                told(Fate::Dropped, "texture coordinates, which decimation does not keep".into());
            }
        }
        Ok(())
    }
}

/// The error for a mesh all of whose facets a weld took away.
fn nothing_left(within_m: Option<f64>, facets: usize, path: &Path) -> Error {
    let problem = match within_m {
        Some(m) => {
            let message =
                format!("leaves nothing: of all {facets} facets two corners are within {} m, or become one", number(m));
            Problem::new(Location::file(path).with_item("--weld"), message)
                .with_help("give a distance smaller than facets, in metres after --unit-m, or --weld alone")
        }
        None => {
            let message = format!("no facet has three corners at places of their own, of {facets}");
            Problem::new(Location::file(path).with_item("mesh"), message)
        }
    };
    Error::Invalid(vec![problem])
}
