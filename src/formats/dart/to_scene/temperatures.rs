//! Temperatures of a simulation: a thermal function without a range, and a cell of a file of temperatures, hold what they warm; the rest is
//! up to the scene's thermal model.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::error::{Error, Result, number};
use crate::geometry::{MaterialId, Mesh, whole};
use crate::report::Fate;
use crate::scene::{Body, Material, Models, Setup, Surface, Thermal};

use super::super::from_scene::{intervals, thermal_functions};
use super::super::place::same;
use super::super::simulation::{CellTemperatures, Links, SpectralInterval, ThermalFunction};
use super::{SceneBuilder, light};

/// So many materials a scene may have once those of cells are told apart by their temperatures.
const MOST_MATERIALS: usize = 1024;
/// Facets wider than this many cells have a part in others: what exceeds 1 is rounding.
const ROUNDED: f64 = 1.0 + 1e-9;

/// What is known of the temperature of what links make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Warmth {
    /// The scene's thermal model has it.
    Modelled,
    /// That of the cell which a facet is in.
    OfCell,
    /// Held, K.
    Held(f64),
}

/// The scene's materials by what links lead to.
#[derive(Default)]
pub(super) struct LinkedMaterials(Vec<(usize, Warmth, usize)>);

impl LinkedMaterials {
    pub(super) fn put(&mut self, property: usize, warmth: Warmth, material: usize) {
        self.0.push((property, warmth, material));
    }

    /// The material of a property with this warmth; `None` if nothing is to be seen of it.
    pub(super) fn of(&self, property: usize, warmth: Warmth) -> Option<usize> {
        self.0.iter().find(|(p, w, _)| (*p, *w) == (property, warmth)).map(|(.., material)| *material)
    }
}

impl SceneBuilder<'_> {
    /// Whether any band sees heat.
    fn glows(&self) -> bool {
        self.simulation.phase.bands.iter().any(|band| band.mode != 0)
    }

    /// What is known of the temperature of what these links, to this property, make.
    pub(super) fn warmth(&self, links: &Links, property: usize) -> Result<Warmth> {
        let ident = &self.simulation.optical[property].ident;
        let kept = self.sidecar.as_ref().and_then(|s| s.material(ident));
        // Without heat in any band, temperatures in DART's files say nothing but that they are as they were.
        if !self.glows() && kept.is_none_or(|material| material.temperature_k.is_none()) {
            return Ok(Warmth::Modelled);
        }
        let Some(function) = self.simulation.thermal.get(links.thermal_index as usize) else {
            let message = format!(
                "the link leads to temperature {}, which coeff_diff.xml does not have ({:?}): DART would stop, or take another",
                links.thermal_index, links.thermal_ident
            );
            return Err(Error::invalid(links.at.clone(), message));
        };
        Ok(match function {
            ThermalFunction { overrides_cells: false, .. } if self.simulation.phase.cells.is_some() => Warmth::OfCell,
            ThermalFunction { mean_k, range_k: 0.0, .. } => Warmth::Held(*mean_k),
            _ => Warmth::Modelled,
        })
    }

    /// The thermal model: the one that these temperatures were made of, or the one that is nearest.
    ///
    /// # Errors
    /// As [`Body::new`].
    pub(super) fn with_thermal(&mut self, mut scene: Setup) -> Result<Setup> {
        let simulation = self.simulation;
        if let Some(sidecar) = &self.sidecar {
            // How Mars lights the scene is told by its own files.
            let kept = sidecar.models();
            let conduction = kept.conduction.filter(|_| scene.sky.rotation.is_some());
            scene.models = Models { mars_light: scene.models.mars_light, conduction, ..kept };
            // What was written without a range need not have been held: a Sun below the horizon leaves none.
            let was_k = |m: &Material| sidecar.material(&m.name).map_or(m.temperature_k, |kept| kept.temperature_k);
            let mut modes = None;
            if scene.body.materials.iter().any(|m| was_k(m) != m.temperature_k) {
                let mut surface = Surface::clone(&scene.body);
                surface.materials.iter_mut().for_each(|m| m.temperature_k = was_k(m));
                let as_it_was = Setup { body: Body::new(surface)?, ..scene.clone() };
                modes = self.as_written(&as_it_was);
                if modes.is_some() {
                    scene = as_it_was;
                }
            }
            modes = modes.or_else(|| self.as_written(&scene));
            if let Some(modes) = modes {
                // What a band with both is written as is what matters of them; another mode was put there by hand.
                for ((band, written), given) in scene.exposure.bands.iter_mut().zip(modes).zip(&simulation.phase.bands)
                {
                    if written.mode != given.mode {
                        band.light = light(given.mode);
                    }
                }
                return Ok(scene);
            }
        }
        for (band, given) in scene.exposure.bands.iter_mut().zip(&simulation.phase.bands) {
            band.light = light(given.mode);
        }
        if !self.glows() {
            scene.models.thermal = Thermal::Off;
            return Ok(scene);
        }
        scene.models.thermal = Thermal::Equilibrium;
        let counts = |function: &&ThermalFunction| function.overrides_cells || simulation.phase.cells.is_none();
        if let Some(spread) = simulation.thermal.iter().filter(counts).find(|function| function.range_k > 0.0) {
            let message = "temperatures are spread between two ends by sunlight: taken to be those of equilibrium. With a `deltaT` of 0 they are \
                           held at `meanT`";
            self.note(Fate::Approximated, &spread.at, message);
        }
        Ok(scene)
    }

    /// The bands as they would be written, if the temperatures of this scene would be written as they stand here.
    fn as_written(&self, scene: &Setup) -> Option<Vec<SpectralInterval>> {
        let (functions, given) = (thermal_functions(scene), &self.simulation.thermal);
        let is_same = |(a, b): (&ThermalFunction, &ThermalFunction)| {
            same(a.mean_k, b.mean_k) && same(a.range_k, b.range_k) && a.overrides_cells == b.overrides_cells
        };
        let are_same = functions.len() == given.len() && functions.iter().zip(given).all(is_same);
        are_same.then(|| intervals(scene, &functions))
    }

    /// Gives facets of a mesh in DART's frame that have the temperature of a cell a material of that temperature.
    ///
    /// `low_m` is the lowest point of the scene: the bottom of the first layer.
    ///
    /// # Errors
    /// [`Error::Invalid`] if that makes more materials than a scene may have.
    pub(super) fn warm_by_cells(
        &mut self,
        mesh: &mut Mesh,
        low_m: f64,
        materials: &mut Vec<Material>,
        linked: &LinkedMaterials,
    ) -> Result<()> {
        let simulation = self.simulation;
        let Some(cells) = &simulation.phase.cells else { return Ok(()) };
        let is_of_cell: Vec<bool> = (0..materials.len())
            .map(|m| linked.0.iter().any(|(_, warmth, material)| (*warmth, *material) == (Warmth::OfCell, m)))
            .collect();
        let ([x, y], [cell_m, layer_m]) = (simulation.maket.size_m, simulation.maket.cell_m);
        let mut made: BTreeMap<(usize, u64), MaterialId> = BTreeMap::new();
        let (mut wide, mut above) = (0_usize, 0_usize);
        for f in 0..mesh.facets.len() {
            let plain = mesh.material[f].0 as usize;
            if !is_of_cell.get(plain).copied().unwrap_or(false) {
                continue;
            }
            let corners_m = mesh.facet(f).corners_m;
            let extent_m =
                corners_m[0].max(corners_m[1]).max(corners_m[2]) - corners_m[0].min(corners_m[1]).min(corners_m[2]);
            let is_wide = extent_m.x.max(extent_m.y) > cell_m * ROUNDED || extent_m.z > layer_m * ROUNDED;
            wide += usize::from(is_wide);
            let centre_m = mesh.facet(f).centroid_m();
            let within = |at_m: f64, size_m: f64| match self.options.repeat {
                0 => at_m,
                _ => at_m.rem_euclid(size_m),
            };
            let at = DVec3::new(within(centre_m.x, x), within(centre_m.y, y), centre_m.z - low_m);
            let (t_k, is_above) = cells.at(at / DVec3::new(cell_m, cell_m, layer_m));
            above += usize::from(is_above);
            let next = materials.len();
            let id = match made.get(&(plain, t_k.to_bits())) {
                Some(id) => *id,
                None if next >= MOST_MATERIALS => return Err(too_many(cells)),
                None => {
                    let like = materials[plain].clone();
                    let mixture = if like.mixture == [(plain, 1.0)] { vec![(next, 1.0)] } else { like.mixture.clone() };
                    let name = named(|name| materials.iter().any(|m| m.name == name), &like.name, Some(t_k));
                    materials.push(Material { name, temperature_k: Some(t_k), mixture, ..like });
                    // Fewer than MOST_MATERIALS.
                    let id = MaterialId(u16::try_from(next).unwrap_or(u16::MAX));
                    made.insert((plain, t_k.to_bits()), id);
                    id
                }
            };
            mesh.material[f] = id;
        }
        let [nx, ny, nz] = cells.count;
        let message = format!(
            "temperatures of {nx} x {ny} x {nz} cells, layers counted from the scene's lowest point, z = {low_m} m (which is inferred, not \
             documented): each facet has that of its centre's cell; {wide} facets are larger than a cell, {above} lie above all of them"
        );
        self.note(Fate::Approximated, &cells.at, message);
        Ok(())
    }
}

fn too_many(cells: &CellTemperatures) -> Error {
    let message = format!(
        "with the temperatures of `{}` the scene would have more than {MOST_MATERIALS} materials, one for each temperature: round them, as to \
         whole kelvins; or write `temperatureMode` 0 for those of the thermal functions",
        cells.file
    );
    Error::invalid(cells.at.clone(), message)
}

/// A name that is not taken, for a material of this name that is held at a temperature, or has those of cells.
pub(super) fn named(is_taken: impl Fn(&str) -> bool, name: &str, t_k: Option<f64>) -> String {
    let wanted = match t_k {
        Some(t_k) => format!("{name} at {} K", number(t_k)),
        None => format!("{name} of cells"),
    };
    let mut names = std::iter::once(wanted.clone()).chain((2..).map(|i: u64| format!("{wanted} ({i})")));
    names.find(|name| !is_taken(name)).unwrap_or(wanted)
}

impl CellTemperatures {
    /// The temperature at a place counted in cells from the first one's corner, K, or that of the nearest cell; and whether it lies above all
    /// of them.
    fn at(&self, place: DVec3) -> (f64, bool) {
        let [nx, ny, nz] = self.count;
        // What lies below 0 is 0.
        let index = |at: f64, count: usize| whole(at).min(count - 1);
        let (i, j, k) = (index(place.x, nx), index(place.y, ny), index(place.z, nz));
        (self.values_k[(k * nx + i) * ny + j], place.z > nz as f64)
    }
}
