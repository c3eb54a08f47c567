//! What a facet sends towards an observer: a few weights on spectra that many facets share.
//!
//! Radiance = sum over rows of weight x spectrum. Rows belong to families: a material's reflectance under each incoming spectrum, the
//! same under a texture, and heat. Each knows its rows, their spectra, and its weights for what is seen of a facet.

mod between;
mod by_band;
mod constant;
mod globes;
mod heat;
mod light;
mod modelled;
mod temperature_grid;
mod variation;
mod fragment_angles;

use crate::geometry::{SphereShown, index_u32};
use crate::physics::reflectance::lambert_radiance;
use crate::product::FacetTable;
use crate::scene::{DirectionField, Incoming, Material, Scene, Texture};
use crate::spectral::{Band, Spectrum};

use between::Between;
use by_band::{ByBand, Sample};
use constant::Constant;
use fragment_angles::FragmentAngles;
use globes::Globes;
use heat::Heat;
use light::{Angles, SourceLight};
use modelled::Modelled;
use variation::Variation;

pub use fragment_angles::Observer;
pub use light::{Fragment, ImagePart, Modulation};
pub use temperature_grid::interpolation_error;

/// What some rows are.
#[derive(Debug)]
enum Family<'a> {
    /// The reflectance of a material that is the same in all directions, plain or under a texture.
    Constant(Constant<'a>),
    /// That of a model whose albedo alone is a spectrum.
    Modelled(Modelled<'a>),
    /// That of a model of which more depends on wavelength.
    ByBand(ByBand<'a>),
    /// Thermal emission of all materials.
    Heat(Heat<'a>),
}

/// Answers what a facet sends towards an observer.
#[derive(Debug)]
pub struct Emission<'a> {
    scene: &'a Scene,
    angles: FragmentAngles<'a>,
    lights: Vec<SourceLight<'a>>,
    /// Each with its first row, ascending.
    families: Vec<(usize, Family<'a>)>,
    rows: usize,
    first_thermal_row: usize,
    of_material: Vec<OfMaterial>,
    /// Of each material; `None`: the same in all directions.
    variations: Vec<Option<Variation>>,
    heat: Option<usize>,
    between: Between<'a>,
    globes: Globes<'a>,
    /// The first of their rows of light, and of heat.
    globe_rows: [usize; 2],
}

/// The families of a material, by their place in the list.
#[derive(Debug, Clone, Copy)]
struct OfMaterial {
    plain: usize,
    textured: Option<usize>,
}

impl<'a> Emission<'a> {
    /// For the facets of a scene and the table solved for them, which fits the scene.
    pub fn new(scene: &'a Scene, table: &'a FacetTable) -> Self {
        let lights = between::lights(table);
        let materials = &scene.body.materials;
        let mut of_material: Vec<OfMaterial> =
            (0..materials.len()).map(|plain| OfMaterial { plain, textured: None }).collect();
        for (i, texture) in scene.body.textures.iter().enumerate() {
            of_material[texture.material.0 as usize].textured = Some(materials.len() + i);
        }
        let variation = |material: &Material| {
            let varies = material.photometry.key().is_some();
            varies.then(|| Variation::of(material.photometry.to_model().map(|model| model.shape).as_ref()))
        };
        let mut emission = Emission {
            scene,
            angles: FragmentAngles::of(scene),
            lights,
            families: vec![],
            rows: 0,
            first_thermal_row: 0,
            of_material,
            variations: materials.iter().map(variation).collect(),
            heat: None,
            between: Between::new(scene, table),
            globes: Globes::new(scene),
            globe_rows: [0; 2],
        };
        for material in materials {
            emission.push(emission.reflecting(material, None));
        }
        for texture in &scene.body.textures {
            emission.push(emission.reflecting(&materials[texture.material.0 as usize], Some(texture)));
        }
        emission.globe_rows[0] = emission.rows;
        emission.rows += emission.globes.light_rows();
        emission.first_thermal_row = emission.rows;
        if let Some(heat) = Heat::new(scene, table, |band| emission.quadrature(band)) {
            emission.heat = Some(emission.families.len());
            emission.push(Family::Heat(heat));
        }
        emission.globe_rows[1] = emission.rows;
        emission.rows += emission.globes.heat_rows();
        emission
    }

    /// The same, for whole facets that another observer sees than the scene's camera.
    #[must_use]
    pub(super) fn seen_by(self, observer: Observer) -> Self {
        Emission { angles: self.angles.seen_by(observer), ..self }
    }

    /// The reflectance of a material, plain or under a texture.
    fn reflecting(&self, material: &'a Material, texture: Option<&'a Texture>) -> Family<'a> {
        if material.photometry.key().is_none() {
            return Family::Constant(Constant { material, texture });
        }
        let modelled = material.photometry.to_model().map(|model| Modelled::new(model, texture));
        let bands = || self.scene.exposure.bands.iter().filter(|band| band.light.is_lit());
        match modelled {
            // A wavelength takes one row, and a model of several products one for each.
            Some(modelled)
                if modelled.terms() == 1
                    || bands().map(|band| self.quadrature(band).len()).sum::<usize>() >= modelled.terms() =>
            {
                Family::Modelled(modelled)
            }
            _ => Family::ByBand(ByBand::new(self.samples(material), texture)),
        }
    }

    /// A material's surface, and the light on it, at the wavelengths of each band.
    fn samples(&self, material: &Material) -> Vec<Vec<Sample>> {
        let sample = |band: &Band, (um, weight): (f64, f64)| {
            let incoming = |[light, on_the_way]: [f64; 2]| light * on_the_way * weight;
            let brdf = material.photometry.brdf(um)?;
            let reflectance = at(&material.reflectance, um);
            Some(Sample {
                um,
                brdf,
                reflectance,
                incoming: self.all_incoming(band, um).into_iter().map(incoming).collect(),
            })
        };
        let of_band = |band: &Band| match band.light.is_lit() {
            true => self.quadrature(band).into_iter().filter_map(|at| sample(band, at)).collect(),
            false => vec![],
        };
        self.scene.exposure.bands.iter().map(of_band).collect()
    }

    /// Whether weights depend on where in a pixel a fragment is lit.
    pub(crate) fn wants_moments(&self) -> bool {
        self.families.iter().any(|(_, family)| matches!(family, Family::Modelled(_) | Family::ByBand(_)))
    }

    /// Into how many parts along each side what a pixel shows of a facet is to be split: its angles are those of the middle. `extent` is the size
    /// of what is shown, pixels of the diagonal.
    pub(crate) fn parts(&self, fragment: &Fragment, extent: f64) -> u32 {
        let facet = fragment.facet as usize;
        let OfMaterial { plain, textured } = self.of_material[self.scene.body.mesh.material[facet].0 as usize];
        // What a texture is over each part would have to be found, too.
        let Some(variation) = self.variations[plain].filter(|_| textured.is_none()) else { return 1 };
        let angle_rad = self.angles.pixel_rad() * extent.min(1.0);
        let (cos_emission, to_viewer) = self.angles.view(fragment);
        let parts = |light: &SourceLight| match light.field {
            _ if light.irradiance(fragment.facet) <= 0.0 => 1.0,
            // Its irradiance is the cosine.
            Some(DirectionField::Afar(towards)) => {
                let cos_phase = towards.vec().dot(to_viewer);
                variation.parts(light.irradiance(fragment.facet), cos_emission, cos_phase, angle_rad)
            }
            // What goes into a direction of light from everywhere varies little with it.
            None => 1.0,
            Some(field @ DirectionField::Near(_)) => {
                let centroid_m = self.scene.body.mesh.facet(facet).centroid_m();
                let cos_phase = field.towards(centroid_m).normalize_or_zero().dot(to_viewer);
                // A surge is spread over the disc.
                let sin_radius = self.angles.sin_radius(light, centroid_m);
                let cos_phase = cos_phase.min((1.0 - sin_radius * sin_radius).max(0.0).sqrt());
                variation.parts(0.0, cos_emission, cos_phase, angle_rad)
            }
        };
        let most = self.lights.iter().map(parts).fold(1.0, f64::max);
        index_u32(crate::geometry::whole(most))
    }

    fn push(&mut self, family: Family<'a>) {
        let rows = match &family {
            Family::Constant(constant) => constant.rows(self.lights.len()),
            Family::Modelled(modelled) => modelled.rows(self.lights.len()),
            Family::ByBand(by_band) => by_band.rows(),
            Family::Heat(heat) => heat.rows(),
        };
        self.families.push((self.rows, family));
        self.rows += rows;
    }

    /// Whether so few bands take a row each for thermal emission.
    pub(crate) fn has_row_per_band(bands: &[Band]) -> bool {
        heat::has_row_per_band(bands.len())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The first row of emitted radiance; those before it are reflected.
    pub fn first_thermal_row(&self) -> usize {
        self.first_thermal_row
    }

    /// Adds to `add(row, weight)` what a facet sends towards the observer that sees this fragment of it; weights are for the
    /// pixel's mean. `texture` is its material's texture there, if it has one.
    pub fn send(&self, fragment: &Fragment, texture: Option<&Modulation>, mut add: impl FnMut(u32, f64)) {
        let material = self.scene.body.mesh.material[fragment.facet as usize].0 as usize;
        let OfMaterial { plain, textured } = self.of_material[material];
        let rest = match (texture, textured) {
            (Some(texture), Some(textured)) => {
                self.reflect(textured, |light| light.of_texture(fragment, texture), texture, fragment, &mut add);
                Some(texture)
            }
            _ => None,
        };
        let amount = |light: &SourceLight| match rest {
            Some(texture) => light.of(fragment) - light.of_texture(fragment, texture),
            None => light.of(fragment),
        };
        self.reflect(plain, amount, &Modulation::default(), fragment, &mut add);
        if let (Some(heat), [sun, ..]) = (self.heat, &self.lights[..])
            && let (first, Family::Heat(heat)) = &self.families[heat]
        {
            let cos_emission = || self.angles.cos_emission(fragment);
            let add = |row: usize, weight| add(index_u32(first + row), weight);
            heat.weights(material, fragment, sun.of(fragment), cos_emission, add);
        }
    }

    /// Adds to `add(row, weight)` what a pixel shows of a body of the sky, of those in view.
    pub fn send_globe(&self, globe: usize, shown: &SphereShown, mut add: impl FnMut(u32, f64)) {
        let [light, heat] = self.globe_rows;
        let (of_light, of_heat) = self.globes.weights(shown);
        add(index_u32(light + globe), of_light);
        for (side, weight) in of_heat.into_iter().flatten().enumerate() {
            add(index_u32(heat + 2 * globe + side), weight);
        }
    }

    fn reflect(
        &self,
        family: usize,
        amount: impl Fn(&SourceLight) -> f64,
        texture: &Modulation,
        fragment: &Fragment,
        add: &mut impl FnMut(u32, f64),
    ) {
        let (first, family) = &self.families[family];
        let mut add = |row: usize, weight| add(index_u32(first + row), weight);
        match family {
            Family::Constant(constant) => constant.weights(fragment.facet, &self.lights, amount, texture, add),
            _ => self.reflect_by_angles(family, &amount, texture, fragment, &mut add),
        }
    }

    /// Apart, so that what costs some 200 ns a fragment does not crowd the few instructions that one without angles takes.
    #[inline(never)]
    fn reflect_by_angles(
        &self,
        family: &Family,
        amount: &dyn Fn(&SourceLight) -> f64,
        texture: &Modulation,
        fragment: &Fragment,
        add: &mut dyn FnMut(usize, f64),
    ) {
        let angles = |light: &SourceLight, put: &mut dyn FnMut(f64, Angles)| match light.field {
            Some(field) => self.angles.each(fragment, light, field, put),
            None => put(1.0, Angles::Diffuse { cos_emission: self.angles.cos_emission(fragment) }),
        };
        match family {
            Family::Modelled(modelled) => {
                modelled.weights(fragment.facet, &self.lights, amount, angles, texture, add);
            }
            Family::ByBand(by_band) => by_band.weights(fragment.facet, &self.lights, amount, angles, texture, add),
            Family::Constant(_) | Family::Heat(_) => {}
        }
    }

    /// The spectra of the rows, [row, band], W m-2 sr-1 um-1 for a weight of 1.
    pub fn spectra(&self) -> Vec<f64> {
        let bands = &self.scene.exposure.bands;
        let mut spectra = vec![0.0; self.rows * bands.len()];
        for (b, band) in bands.iter().enumerate().filter(|(_, band)| band.light.is_lit()) {
            for (um, weight) in self.quadrature(band) {
                let incoming = self.all_incoming(band, um);
                for (first, family) in &self.families {
                    let add = |row: usize, value: f64| spectra[(first + row) * bands.len() + b] += value;
                    match family {
                        Family::Constant(constant) => constant.spectra(um, weight, &incoming, add),
                        Family::Modelled(modelled) => modelled.spectra(um, weight, &incoming, add),
                        Family::ByBand(_) | Family::Heat(_) => {}
                    }
                }
            }
        }
        self.globe_spectra(&mut spectra);
        for (first, family) in &self.families {
            if let Family::ByBand(by_band) = family {
                by_band.spectra(&mut spectra[first * bands.len()..]);
            }
        }
        if let Some((first, Family::Heat(heat))) = self.heat.map(|heat| &self.families[heat]) {
            heat.spectra(bands, &mut spectra[first * bands.len()..]);
        }
        spectra
    }

    /// Writes the rows of bodies in view: of a Lambert sphere's radiance the cosine of incidence is in the weight.
    fn globe_spectra(&self, spectra: &mut [f64]) {
        let (bands, sky) = (&self.scene.exposure.bands, &self.scene.sky);
        let [light_row, heat_row] = self.globe_rows;
        for (b, band) in bands.iter().enumerate().filter(|_| self.globes.light_rows() > 0) {
            for (um, weight) in self.quadrature(band) {
                for (i, globe) in self.globes.globes.iter().enumerate().filter(|_| band.light.is_lit()) {
                    let strength = sky.sun_on(globe).strength;
                    let incoming = Incoming::Reflected(&globe.reflectance, strength);
                    let [light, on_the_way] = self.scene.incoming_w_m2_um(incoming, band.light, um);
                    spectra[(light_row + i) * bands.len() + b] += weight * lambert_radiance(light) * on_the_way;
                }
                if band.light.glows() {
                    let add = |row: usize, value: f64| spectra[(heat_row + row) * bands.len() + b] += value;
                    self.globes.heat(um, weight, add);
                }
            }
        }
    }

    /// Of each source, and then of what facets send each other.
    fn all_incoming(&self, band: &Band, um: f64) -> Vec<[f64; 2]> {
        let sources: Vec<[f64; 2]> = self
            .scene
            .sources()
            .iter()
            .map(|source| self.scene.incoming_w_m2_um(source.incoming, band.light, um))
            .collect();
        let between: Vec<[f64; 2]> = self.between.incoming(um, &sources).collect();
        [sources, between].concat()
    }

    /// Wavelengths and weights of a band, which ends where the spectra do.
    fn quadrature(&self, band: &Band) -> Vec<(f64, f64)> {
        let known_um = self.scene.known_um(band.light);
        band.quadrature(&self.knots_um(band.support_within_um(known_um)), known_um)
    }

    /// Where the spectra that meet in a band have corners, um, ascending.
    fn knots_um(&self, (lo, hi): (f64, f64)) -> Vec<f64> {
        let body = &self.scene.body;
        let materials = body.materials.iter().flat_map(|m| [&m.reflectance, &m.emissivity]);
        let parameters = body.materials.iter().flat_map(|m| m.photometry.parameters()).map(|(_, spectrum)| spectrum);
        let all = materials.chain(parameters).chain(self.scene.sky.spectra());
        let layers = body.textures.iter().flat_map(|t| &t.wavelength_um);
        let mut knots: Vec<f64> =
            all.flat_map(|s| s.wavelength_um()).chain(layers).copied().filter(|um| lo < *um && *um < hi).collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
    }
}

/// A spectrum within its coverage, which a scene's check has compared with the bands.
fn at(spectrum: &Spectrum, um: f64) -> f64 {
    spectrum.at(um).unwrap_or(f64::NAN)
}
