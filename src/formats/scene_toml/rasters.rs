//! Rasters that a file names, their bands, the planes they lie on, and textures.

use std::path::PathBuf;

use glam::{DMat3, DVec3};

use super::super::located::member;
use super::super::raster::{self, Raster};
use super::Reader;
use super::types::{
    BandsToml, Coordinates, FactorUnitToml, MeanToml, PlaneToml, RasterToml, TexelsToml, TexturePlacementToml,
    TextureQuantityToml, TextureToml,
};
use crate::error::number;
use crate::geometry::{Direction, MaterialId, Mesh, Texels};
use crate::product::{Atlas, Projection};
use crate::scene::{Texture, TextureKind};
use crate::spectral::Band;

/// Two vectors whose angle has a smaller sine than this are taken for parallel: what they span has no direction left in f64.
const LEAST_SINE: f64 = 1e-6;
/// Textures are held in memory: no more values than this (8 GiB).
const MOST_VALUES: usize = 1 << 30;

impl Reader<'_> {
    /// The rasters that an item names: one or more, all of the same size.
    pub(in crate::formats) fn rasters(&mut self, item: &str, toml: &RasterToml) -> Option<Vec<Raster>> {
        let names = match toml {
            RasterToml::One(name) => vec![self.path(name)],
            RasterToml::Several(names) => names.iter().map(|name| self.path(name)).collect(),
        };
        self.opened(item, names)
    }

    /// The rasters at some paths.
    pub(in crate::formats) fn opened(&mut self, item: &str, paths: Vec<PathBuf>) -> Option<Vec<Raster>> {
        let count = paths.len();
        let mut rasters: Vec<Raster> = Vec::new();
        for path in paths {
            let Some(raster) = self.taken(item, raster::open(&path)) else { continue };
            let inputs = self.taken(item, raster.inputs())?;
            self.inputs.extend(inputs);
            rasters.push(raster);
        }
        if count == 0 {
            self.problem(item, "names no raster");
        }
        let first = rasters.first()?;
        if let Some(other) = rasters.iter().find(|r| (r.rows, r.columns) != (first.rows, first.columns)) {
            let [a, b] = [first, other].map(|r| format!("{} has {} x {}", r.path.display(), r.columns, r.rows));
            self.problem(item, format!("{b} pixels, but {a}"));
            return None;
        }
        (rasters.len() == count).then_some(rasters)
    }

    /// The bands of rasters: those that the text gives, or their own.
    pub(in crate::formats) fn raster_bands(
        &mut self,
        item: &str,
        given: Option<&BandsToml>,
        rasters: &[Raster],
    ) -> Option<Vec<Band>> {
        let of_raster: Vec<_> = rasters.iter().flat_map(|r| &r.bands).collect();
        if let Some(given) = given {
            if given.light.is_some() {
                self.problem(&format!("{item}.light"), "is a matter of a scene's sensor: the raster has what it has");
                return None;
            }
            let bands = self.bands(item, given)?;
            if bands.len() != of_raster.len() {
                let message = format!(
                    "{} bands, but the raster has {}, each of {} rows x {} columns",
                    bands.len(),
                    of_raster.len(),
                    rasters[0].rows,
                    rasters[0].columns
                );
                self.problem(item, message);
                return None;
            }
            return Some(bands);
        }
        let known = of_raster.iter().map(|b| Some(Band::new(b.centre_um?, b.fwhm_um)));
        match known.collect::<Option<Vec<Band>>>() {
            Some(bands) if bands.iter().all(|b| b.centre_um > 0.0) => Some(bands),
            _ => {
                self.helped(
                    item,
                    "is missing: the raster does not say the wavelengths of its bands",
                    "give them as `bands = { centres_um = [1.0, 1.1] }`",
                );
                None
            }
        }
    }

    /// How points come onto a plane's raster, local to the scene, and the direction towards the viewer along which they do.
    pub(in crate::formats) fn plane(&mut self, item: &str, toml: &PlaneToml) -> Option<(Projection, Direction)> {
        let [along, across] = [toml.along_line_m, toml.line_to_line_m].map(DVec3::from_array);
        for (key, step) in [("along_line_m", along), ("line_to_line_m", across)] {
            // Beyond this, products of steps leave the range of f64.
            let largest = step.abs().max_element();
            if !(1e-18..=1e18).contains(&largest) {
                let message = format!("is a step of {} m: give that from a pixel to the next", number(largest));
                self.problem(&member(item, key), message);
                return None;
            }
        }
        // Seen from there, lines run to the right and follow one another downwards.
        let normal = Direction::new(across.cross(along));
        let Some(normal) =
            normal.filter(|_| along.cross(across).length() > LEAST_SINE * along.length() * across.length())
        else {
            self.problem(&member(item, "line_to_line_m"), "runs along the lines: the two steps do not span a plane");
            return None;
        };
        let towards = match toml.towards {
            Some(towards) => Direction::new(DVec3::from_array(towards)),
            None => Some(normal),
        };
        let Some(towards) = towards.filter(|t| t.vec().dot(normal.vec()).abs() > LEAST_SINE) else {
            self.problem(
                &member(item, "towards"),
                "is no direction from which the plane is seen: it lies in the plane",
            );
            return None;
        };
        let mut corner_m = DVec3::from_array(toml.corner_m);
        if toml.coordinates == Some(Coordinates::Body) {
            corner_m -= self.origin_m;
        }
        // p - corner = s along + t across + d towards: s and t are rows of the inverse.
        let per_step = DMat3::from_cols(along, across, towards.vec()).inverse().transpose();
        Some((Projection::parallel(per_step.x_axis, per_step.y_axis, corner_m, [0.0; 2]), towards))
    }

    /// The texture of a material.
    pub(super) fn texture(&mut self, material: &str, id: usize, toml: &TextureToml, mesh: &Mesh) -> Option<Texture> {
        let item = member(&member("materials", material), "texture");
        let at = |key: &str| member(&item, key);
        let mut rasters = self.rasters(&at("raster"), &toml.raster)?;
        let layers: usize = rasters.iter().map(|r| r.bands.len()).sum();
        let (rows, columns) = (rasters[0].rows, rasters[0].columns);
        let wavelength_um = if layers == 1 && toml.bands.is_none() {
            vec![]
        } else {
            let bands = self.raster_bands(&at("bands"), toml.bands.as_ref(), &rasters)?;
            bands.iter().map(|b| b.centre_um).collect()
        };
        let corners = self.texture_corners(&item, material, id, toml, mesh, [rows, columns])?;
        if (rows * columns).saturating_mul(layers) > MOST_VALUES {
            let message = format!("{columns} x {rows} texels of {layers} layers are more than can be held in memory");
            self.problem(&at("raster"), message);
            return None;
        }
        let mut values = vec![0.0; rows * columns * layers];
        let mut layer = 0;
        let mut band = Vec::new();
        let scale = if toml.unit == Some(FactorUnitToml::Percent) { 0.01 } else { 1.0 };
        for raster in &mut rasters {
            for number in 0..raster.bands.len() {
                self.taken(&at("raster"), raster.read(number, &mut band))?;
                values.iter_mut().skip(layer).step_by(layers).zip(&band).for_each(|(v, b)| *v = scale * b);
                layer += 1;
            }
        }
        let kind = match toml.quantity {
            TextureQuantityToml::Factor => TextureKind::Factor,
            TextureQuantityToml::Reflectance => TextureKind::Reflectance,
        };
        let texels = match toml.texels {
            Some(TexelsToml::Bilinear) => Texels::Bilinear,
            Some(TexelsToml::Nearest) | None => Texels::Nearest,
        };
        let material = MaterialId(id as u16);
        let mut texture = Texture { material, kind, corners, rows, columns, wavelength_um, values, texels };
        let to_one = toml.mean.map_or(kind == TextureKind::Factor, |mean| mean == MeanToml::One);
        // A texel that is no number is told as that, not as its mean.
        if to_one && texture.odd_texel().is_none() {
            let means = texture.means(mesh);
            if let Some(mean) = means.iter().find(|m| !(**m > 0.0 && m.is_finite())) {
                let (message, help) = if !mesh.material.contains(&material) {
                    (
                        "cannot be made 1: no facet is of this material".to_owned(),
                        "facets of a mixture have the mixture's own texture, not those of what it is mixed of: put the texture there",
                    )
                } else if mean.is_nan() {
                    (
                        "cannot be made 1: the texture covers none of the material's facets".to_owned(),
                        "check its placement: the frame (local or body), metres, and which axis runs along lines",
                    )
                } else {
                    (
                        format!("cannot be made 1: it is {} over the material's facets", number(*mean)),
                        "`mean = \"kept\"` leaves factors as they are",
                    )
                };
                self.helped(&at("mean"), message, help);
                return None;
            }
            texture.values.chunks_exact_mut(layers).for_each(|v| v.iter_mut().zip(&means).for_each(|(v, m)| *v /= m));
            let means: Vec<String> = means.iter().take(3).map(|m| format!("{m:.6}")).collect();
            self.stated(
                &at("mean"),
                format!("factors are divided by their mean over the material's facets, {}", means.join(", ")),
            );
        }
        Some(texture)
    }

    /// Says if texture coordinates lie beside the image.
    pub(in crate::formats) fn within_image<'m>(
        &mut self,
        item: &str,
        mut uv: impl Iterator<Item = &'m [[f64; 2]; 3]>,
    ) -> Option<()> {
        // A border that rounding moved is still the border; NaN is none at all.
        let outside = |x: &f64| !(x.is_nan() || (-1e-9..=1.0 + 1e-9).contains(x));
        let odd = uv.find_map(|uv| uv.iter().flatten().copied().find(outside));
        if let Some(x) = odd {
            self.helped(
                item,
                format!("facets have texture coordinates outside 0 to 1: {}", number(x)),
                "images are not repeated: scale the coordinates, or make the image as large as they reach",
            );
            return None;
        }
        Some(())
    }

    /// Texel coordinates of all facets' corners.
    fn texture_corners(
        &mut self,
        item: &str,
        material: &str,
        id: usize,
        toml: &TextureToml,
        mesh: &Mesh,
        [rows, columns]: [usize; 2],
    ) -> Option<Vec<[[f64; 2]; 3]>> {
        match (toml.placement, &toml.plane) {
            (TexturePlacementToml::Plane, Some(plane)) => {
                let (projection, _) = self.plane(&member(item, "plane"), plane)?;
                let facets = 0..mesh.facets.len();
                Some(facets.map(|f| mesh.facet(f).corners_m.map(|p| projection.texel(p))).collect())
            }
            (TexturePlacementToml::Plane, None) => {
                self.problem(&member(item, "plane"), "is missing: it says where the raster lies");
                None
            }
            (TexturePlacementToml::Atlas, Some(_)) => {
                self.problem(&member(item, "plane"), "does not go with texture coordinates");
                None
            }
            (TexturePlacementToml::Atlas, None) => {
                let own = (0..mesh.facets.len()).filter(|f| mesh.material[*f].0 as usize == id);
                let uv = own.map(|f| mesh.uv.get(f));
                let help = "an OBJ has them as `vt` lines, and its faces as `f 1/1 2/2 3/3`";
                if uv.clone().any(|uv| uv.is_none_or(|uv| uv.iter().flatten().any(|x| x.is_nan()))) {
                    self.helped(
                        &member(item, "placement"),
                        format!("facets of {material:?} have no texture coordinates"),
                        help,
                    );
                    return None;
                }
                self.within_image(&member(item, "placement"), uv.flatten())?;
                Some(Atlas::of_uv(&mesh.uv, rows, columns).corners)
            }
        }
    }
}
