//! Rasters that a file names, their bands, the planes they lie on, and textures.

use std::path::PathBuf;

use glam::{DMat3, DVec3};

use super::super::located::member;
use super::super::raster::{self, Georeference, Raster};
use super::super::registry;
use super::atlas::UNCOVERED;
use super::types::{
    BandsToml, Coordinates, FactorUnitToml, MeanToml, PlaneToml, RasterToml, TexelsToml, TexturePlacementToml,
    TextureQuantityToml, TextureToml,
};
use super::{Tiling, TomlReader};
use crate::error::number;
use crate::geometry::{Camera, Direction, LonLat, MaterialId, Mesh, NO_UV, ParallelCamera, Texels, body_from_site};
use crate::product::Atlas;
use crate::report::Fate;
use crate::scene::{FARTHEST_M, Texture, TextureKind};
use crate::spectral::Band;

/// Two vectors whose angle has a smaller sine than this are taken for parallel: what they span has no direction left in f64.
const LEAST_SINE: f64 = 1e-6;
/// Georeferences that differ by no more than this of a pixel are the same.
const SAME_PLACE: f64 = 1e-3;
/// Centres that differ by no more than this, relative, are the same.
const SAME_WAVELENGTH: f64 = 1e-3;
/// Names without a unit are wavelengths if they are those of the bands to this, relative.
const ALIKE: f64 = 0.1;
/// Textures are held in memory: no more values than this (8 GiB).
pub(super) const MOST_VALUES: usize = 1 << 30;

/// The wavelengths, um, that names say without a unit, where in nm or um they are those of the bands, in whatever order.
fn um_of_numbers(names: &[&str], bands: &[Band]) -> Option<Vec<f64>> {
    let numbers: Vec<f64> = names.iter().map(|name| raster::bare_number(name)).collect::<Option<_>>()?;
    let sorted = |mut um: Vec<f64>| {
        um.sort_by(f64::total_cmp);
        um
    };
    let wanted = sorted(bands.iter().map(|band| band.centre_um).collect());
    [1e-3, 1.0].into_iter().map(|unit| numbers.iter().map(|number| unit * number).collect::<Vec<f64>>()).find(|um| {
        let own = sorted(um.clone());
        own.len() == wanted.len() && own.iter().zip(&wanted).all(|(a, b)| (a / b - 1.0).abs() <= ALIKE)
    })
}

impl TomlReader<'_> {
    /// The rasters that an item names: one or more, all of the same size.
    pub(in crate::formats) fn rasters(
        &mut self,
        item: &str,
        toml: &RasterToml,
        channels: Option<&[String]>,
    ) -> Option<Vec<Raster>> {
        let names = match toml {
            RasterToml::One(name) => vec![self.path(name)],
            RasterToml::Several(names) => names.iter().map(|name| self.path(name)).collect(),
        };
        self.opened(item, names, channels)
    }

    /// The images in the rasters at some paths: of each the channels of these names, or those that are clearly meant.
    pub(in crate::formats) fn opened(
        &mut self,
        item: &str,
        paths: Vec<PathBuf>,
        channels: Option<&[String]>,
    ) -> Option<Vec<Raster>> {
        let count = paths.len();
        let mut rasters: Vec<Raster> = Vec::new();
        for path in paths {
            let Some(mut raster) = self.taken(item, registry::image(&path)) else { continue };
            if let Err((message, help)) = raster.take_image(channels) {
                let of_channels = item.strip_suffix("raster").map(|before| format!("{before}channels"));
                let item = of_channels.filter(|_| channels.is_some()).unwrap_or_else(|| item.to_owned());
                self.helped(&item, format!("{} {message}", path.display()), help);
                continue;
            }
            for note in &raster.report.notes {
                match note.fate {
                    Fate::Defaulted | Fate::Carried => self.taken_of_raster(&note.at.to_string(), &note.message),
                    Fate::Dropped => self.notes.push(format!("{}: left out: {}", note.at, note.message)),
                    Fate::Approximated => self.notes.push(format!("{}: {}", note.at, note.message)),
                }
            }
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
            let names: Vec<&str> = of_raster.iter().map(|band| band.name.as_str()).collect();
            let own_um: Vec<Option<f64>> = of_raster.iter().map(|band| band.centre_um).collect();
            self.compare_bands(item, &bands, &own_um, &names)?;
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

    /// Compares the wavelengths that a text gives with those that the raster says. Nearer to that of another band than to its own is a
    /// mistake; else it is reported.
    fn compare_bands(&mut self, item: &str, given: &[Band], own_um: &[Option<f64>], names: &[&str]) -> Option<()> {
        let colours: Option<Vec<usize>> = names.iter().map(|name| raster::colour(name)).collect();
        if let Some(colours) = colours
            && colours.windows(2).any(|w| w[0] < w[1])
            && given.windows(2).all(|w| w[0].centre_um < w[1].centre_um)
        {
            let pairs = names.iter().zip(given).map(|(name, band)| format!("{name} is {} um", band.centre_um));
            let pairs = pairs.collect::<Vec<_>>().join(", ");
            self.notes.push(format!("{item}: bands are laid over red, green and blue in this order: {pairs}"));
        }
        let stated = own_um.iter().copied().collect::<Option<Vec<f64>>>();
        let Some(own_um) = stated.or_else(|| um_of_numbers(names, given)) else { return Some(()) };
        let differs = |a: f64, b: f64| (a / b - 1.0).abs() > SAME_WAVELENGTH;
        let Some(first) = (0..given.len()).find(|i| differs(given[*i].centre_um, own_um[*i])) else { return Some(()) };
        let away = |i: usize, um: f64| (given[i].centre_um - um).abs();
        let other = (0..given.len()).find_map(|i| {
            let other = (0..own_um.len()).find(|k| away(i, own_um[*k]) < away(i, own_um[i]))?;
            Some((i, other))
        });
        let wrong = given.iter().zip(&own_um).position(|(band, um)| !(0.5..=2.0).contains(&(band.centre_um / um)));
        let i = other.map(|(i, _)| i).or(wrong).unwrap_or(first);
        let message =
            format!("band {} is at {} um here, but at {} um in the raster", i + 1, given[i].centre_um, own_um[i]);
        if other.is_none() && wrong.is_none() {
            self.notes.push(format!("{item}: {message}: that of this file is taken"));
            return Some(());
        }
        let of = other
            .map_or_else(String::new, |(_, k)| format!(", which is nearer to its band {}, at {} um", k + 1, own_um[k]));
        let help = "bands are laid over those of the raster in its order, by wavelength where names give it: leave `bands` out, or \
                    choose with `channels`";
        self.helped(item, format!("{message}{of}"), help);
        None
    }

    /// The camera that a raster is an image of, as the text says, compared with the raster's own georeference, or as that says.
    pub(in crate::formats) fn raster_plane(
        &mut self,
        item: &str,
        toml: Option<&PlaneToml>,
        raster: &Raster,
    ) -> Option<ParallelCamera> {
        let (east, north, up) = self.site_axes();
        match (toml, raster.georeference()) {
            (Some(plane), Some(Georeference::Plane { corner_m, along_line_m, line_to_line_m })) => {
                let level = |v: DVec3| [v.dot(east), v.dot(north)];
                let mut corner = DVec3::from_array(plane.corner_m);
                if plane.coordinates == Some(Coordinates::Body) {
                    corner -= self.origin_m;
                }
                let given =
                    [corner, DVec3::from_array(plane.along_line_m), DVec3::from_array(plane.line_to_line_m)].map(level);
                let own = [*corner_m, [*along_line_m, 0.0], [0.0, -line_to_line_m]];
                let pixel = along_line_m.min(*line_to_line_m);
                let differs =
                    given.iter().zip(&own).any(|(a, b)| (0..2).any(|k| (a[k] - b[k]).abs() > SAME_PLACE * pixel));
                if differs {
                    let shown = |[corner, along, across]: [[f64; 2]; 3]| {
                        let of = |[x, y]: [f64; 2]| format!("({}, {})", number(x + 0.0), number(y + 0.0));
                        format!("corner {}, pixels of {}, lines of {}", of(corner), of(along), of(across))
                    };
                    self.notes.push(format!(
                        "{item}: the raster's own georeference, m to the East and the North, is another: {}; here {}, which is taken",
                        shown(own),
                        shown(given)
                    ));
                }
                self.plane(item, plane, raster)
            }
            (Some(plane), _) => self.plane(item, plane, raster),
            (None, Some(Georeference::Plane { corner_m: [x, y], along_line_m, line_to_line_m })) => {
                let plane = PlaneToml {
                    corner_m: (east * *x + north * *y).to_array(),
                    along_line_m: (east * *along_line_m).to_array(),
                    line_to_line_m: (north * -line_to_line_m).to_array(),
                    towards: Some(up.to_array()),
                    coordinates: None,
                };
                let value = format!(
                    "as the raster's own georeference says: corner {} m to the East and {} m to the North of `origin_m`, pixels of {} x {} m",
                    number(*x),
                    number(*y),
                    number(*along_line_m),
                    number(*line_to_line_m)
                );
                self.taken_of_raster(item, value);
                self.plane(item, &plane, raster)
            }
            (None, Some(other)) => {
                let why = other.why_no_plane().unwrap_or_default();
                self.problem(item, format!("is missing, and the raster's own georeference is not taken: {why}"));
                None
            }
            (None, None) => {
                self.problem(item, "is missing: it says where the raster lies");
                None
            }
        }
    }

    /// East, North and up at the scene's origin; x, y and z at the body's centre.
    fn site_axes(&self) -> (DVec3, DVec3, DVec3) {
        let axes = body_from_site(self.origin_m).unwrap_or(DMat3::IDENTITY);
        (axes.x_axis, axes.y_axis, axes.z_axis)
    }

    /// The camera whose image a plane's raster is, local to the scene.
    fn plane(&mut self, item: &str, toml: &PlaneToml, raster: &Raster) -> Option<ParallelCamera> {
        let [Ok(samples), Ok(lines)] = [raster.columns, raster.rows].map(u32::try_from) else {
            self.problem(item, format!("lies under {} x {} pixels: too many in a line", raster.columns, raster.rows));
            return None;
        };
        let [along, across] = [toml.along_line_m, toml.line_to_line_m].map(DVec3::from_array);
        for (key, step) in [("along_line_m", along), ("line_to_line_m", across)] {
            // Beyond this, products of steps leave the range of f64.
            let largest = step.abs().max_element();
            if !(1.0 / FARTHEST_M..=FARTHEST_M).contains(&largest) {
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
                "is not a direction from which the plane is seen: it lies in the plane",
            );
            return None;
        };
        let mut corner_m = DVec3::from_array(toml.corner_m);
        if toml.coordinates == Some(Coordinates::Body) {
            corner_m -= self.origin_m;
        }
        // p - corner = s along + t across + d towards: s and t are rows of the inverse.
        let per_step = DMat3::from_cols(along, across, towards.vec()).inverse().transpose();
        Some(ParallelCamera {
            towards,
            samples,
            lines,
            sample_per_m: per_step.x_axis,
            line_per_m: per_step.y_axis,
            origin_m: corner_m,
            origin_px: [0.0; 2],
        })
    }

    /// The texture of a material.
    pub(super) fn texture(&mut self, material: &str, id: usize, toml: &TextureToml, mesh: &Mesh) -> Option<Texture> {
        let item = member(&member("materials", material), "texture");
        let at = |key: &str| member(&item, key);
        let mut rasters = self.rasters(&at("raster"), &toml.raster, toml.channels.as_deref())?;
        let layers: usize = rasters.iter().map(|r| r.bands.len()).sum();
        let in_file_um: Vec<f64> = if layers == 1 && toml.bands.is_none() {
            vec![]
        } else {
            if toml.bands.as_ref().is_some_and(|given| given.light.is_some()) {
                self.problem(&at("bands.light"), "is a matter of sensors and maps: a texture is of what is reflected");
                return None;
            }
            let bands = self.raster_bands(&at("bands"), toml.bands.as_ref(), &rasters)?;
            bands.iter().map(|b| b.centre_um).collect()
        };
        // Pictures have red first: layers are sorted by wavelength.
        let mut order: Vec<usize> = (0..layers).collect();
        order.sort_by(|a, b| in_file_um.get(*a).unwrap_or(&0.0).total_cmp(in_file_um.get(*b).unwrap_or(&0.0)));
        let wavelength_um = order.iter().filter_map(|i| in_file_um.get(*i).copied()).collect();
        let mut rank = vec![0; layers];
        order.iter().enumerate().for_each(|(rank_of, i)| rank[*i] = rank_of);
        let (lon_lat, (Atlas { corners, rows, columns }, tiling)) = match toml.placement {
            TexturePlacementToml::LonLat => {
                self.goes_without(&item, "plane", toml.plane.is_some())?;
                self.goes_without(&item, "wrap", toml.wrap.is_some())?;
                let (map, tiling) = self.lon_lat(&at("west_deg"), toml.west_deg, &rasters, MOST_VALUES)?;
                let [columns, rows] = map.size();
                (Some(map), (Atlas { corners: vec![], rows, columns }, Some(tiling)))
            }
            TexturePlacementToml::Atlas | TexturePlacementToml::Plane => {
                self.goes_without(&item, "west_deg", toml.west_deg.is_some())?;
                (None, self.texture_corners(&item, material, id, toml, mesh, &rasters[0])?)
            }
        };
        if (rows * columns).saturating_mul(layers) > MOST_VALUES {
            let message = format!("{columns} x {rows} texels of {layers} layers are more than can be held in memory");
            self.problem(&at("raster"), message);
            return None;
        }
        let mut values = vec![0.0; rows * columns * layers];
        let mut layer = 0;
        let (mut band, mut larger) = (Vec::new(), Vec::new());
        let scale = if toml.unit == Some(FactorUnitToml::Percent) { 0.01 } else { 1.0 };
        if let Some(message) = rasters.iter().find_map(Raster::percent_of_fractions).filter(|_| scale != 1.0) {
            self.notes.push(format!("{}: {message}", at("unit")));
        }
        for raster in &mut rasters {
            for number in 0..raster.bands.len() {
                self.taken(&at("raster"), raster.read(number, &mut band))?;
                // Before the image becomes a larger one.
                if let Some(i) = band.iter().position(|value| Texture::is_odd(*value)) {
                    let of = if layers > 1 { format!("band {} of ", number + 1) } else { String::new() };
                    let (row, column) = (i / raster.columns, i % raster.columns);
                    let message = format!(
                        "{of}{}: texel (row {row}, column {column}) is {}: expected a number of at least 0",
                        raster.path.display(),
                        crate::error::number(band[i])
                    );
                    match band[i].is_nan() {
                        true => {
                            let help = "a texture is known everywhere: fill what has no data, as with 1 (`gdal_fillnodata`, or `gdalwarp -wo INIT_DEST=1`)";
                            self.helped(&at("raster"), message, help);
                        }
                        false => _ = self.problem(&at("raster"), message),
                    }
                    return None;
                }
                if let Some(tiling) = &tiling {
                    tiling.expanded(&band, &mut larger);
                    std::mem::swap(&mut band, &mut larger);
                }
                values.iter_mut().skip(rank[layer]).step_by(layers).zip(&band).for_each(|(v, b)| *v = scale * b);
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
        // Materials beyond those that facets can have have no facet either.
        let material = MaterialId(u16::try_from(id).ok()?);
        let mut texture = Texture { material, kind, lon_lat, corners, rows, columns, wavelength_um, values, texels };
        let to_one = toml.mean.map_or(kind == TextureKind::Factor, |mean| mean == MeanToml::One);
        if to_one {
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

    /// Refuses a key that has no meaning for the placement.
    pub(super) fn goes_without(&mut self, item: &str, key: &str, is_given: bool) -> Option<()> {
        if is_given {
            self.problem(&member(item, key), "does not go with this placement");
        }
        (!is_given).then_some(())
    }

    /// A map of all longitudes and latitudes, of images of one size; and the image that is held.
    pub(in crate::formats) fn lon_lat(
        &mut self,
        item: &str,
        west_deg: Option<f64>,
        rasters: &[Raster],
        most_texels: usize,
    ) -> Option<(LonLat, Tiling)> {
        let [rows, columns] = [rasters[0].rows, rasters[0].columns];
        let mut own_deg = None;
        for raster in rasters {
            own_deg = self.own_west_deg(item, west_deg.or(own_deg), raster)?.or(own_deg);
        }
        if let (None, Some(own_deg)) = (west_deg, own_deg) {
            self.taken_of_raster(item, format!("{}, as the raster says", number(own_deg)));
        }
        let Some(west_deg) = west_deg.or(own_deg) else {
            let help = "0 if it goes from 0 to 360, -180 if from -180 to 180";
            self.helped(item, "is missing: it says at which longitude the map's first column begins", help);
            return None;
        };
        if !(-360.0..=360.0).contains(&west_deg) {
            self.problem(item, format!("is {} deg: expected -360 to 360", number(west_deg)));
            return None;
        }
        if rows.saturating_mul(columns.saturating_add(2)) > most_texels {
            self.problem(item, format!("a map of {columns} x {rows} texels is more than can be held in memory"));
            return None;
        }
        let map = LonLat { centre_m: -self.origin_m, west_deg, columns, rows };
        Some((map, Tiling::around([rows, columns])))
    }

    /// Where the first column of a map of all longitudes and latitudes begins, as the raster says, deg; the inner none if it does not say. It must not
    /// be half a column from what is given, and the raster must be of the whole body.
    fn own_west_deg(&mut self, item: &str, given_deg: Option<f64>, raster: &Raster) -> Option<Option<f64>> {
        let file = raster.path.display();
        let (corner_deg, pixel_deg) = match raster.georeference() {
            Some(Georeference::Degrees { corner_deg, pixel_deg }) => (*corner_deg, *pixel_deg),
            Some(Georeference::Turned(how)) => {
                self.helped(item, format!("{file}: {how}"), "`gdalwarp IN.tif OUT.tif` turns it");
                return None;
            }
            // The whole body in metres of a cylindrical projection is twice as wide as it is high.
            Some(Georeference::Plane { along_line_m, line_to_line_m, .. }) => {
                let size_m = [raster.columns as f64 * along_line_m, raster.rows as f64 * line_to_line_m];
                let [wide, high] = size_m.map(number);
                if (size_m[0] - 2.0 * size_m[1]).abs() > 2.0 * along_line_m.max(*line_to_line_m) {
                    let message = format!(
                        "{file} is {wide} x {high} m, as it says itself: a map of the whole body by longitude and latitude is twice as wide as it is high"
                    );
                    self.helped(item, message, "of a part of the ground: `placement = \"plane\"`");
                    return None;
                }
                self.note(
                    item,
                    format!("{file} is {wide} x {high} m: taken for the whole body, by longitude and latitude"),
                );
                return Some(None);
            }
            _ => return Some(None),
        };
        let [[west, east], [south, north]] = raster.covered_deg(corner_deg, pixel_deg);
        let whole = [(east - west - 360.0, 0), (north - 90.0, 1), (south + 90.0, 1)];
        let off_px = whole.map(|(off, axis)| (off / pixel_deg[axis]).abs());
        let covers = format!(
            "{file} covers longitudes {} to {} deg and latitudes {} to {} deg",
            number(west),
            number(east),
            number(south),
            number(north)
        );
        if !off_px.iter().all(|off| *off < 0.5) {
            let first = if west < 0.0 { -180 } else { 0 };
            let help = format!(
                "`gdalwarp -te {first} -90 {} 90 -dstnodata nan -ot Float32 IN.tif OUT.tif` makes it one of the whole body, without data beyond; \
                 of a texture, which must be known everywhere, `-wo INIT_DEST=1` instead of `-dstnodata nan` makes it 1 beyond",
                first + 360
            );
            self.helped(item, format!("{covers}, and the map must be of the whole body"), help);
            return None;
        }
        if off_px.iter().any(|off| *off > SAME_PLACE) {
            self.note(item, format!("{covers}: taken for the whole body"));
        }
        let turns = |deg: f64| deg - 360.0 * (deg / 360.0).round();
        let Some(given_deg) = given_deg else {
            return Some(Some(if west.abs() <= 360.0 { west } else { turns(west) }));
        };
        let off_px = turns(given_deg - west).abs() / pixel_deg[0];
        let message = format!("{} deg here, and {} deg in {file}", number(given_deg), number(west));
        if off_px >= 0.5 {
            self.helped(item, message, "leave it out: the raster says where its first column begins");
            return None;
        }
        if off_px > SAME_PLACE {
            self.note(item, format!("{message}: that of this file is taken"));
        }
        Some(Some(given_deg))
    }

    /// Texel coordinates of all facets' corners.
    fn texture_corners(
        &mut self,
        item: &str,
        material: &str,
        id: usize,
        toml: &TextureToml,
        mesh: &Mesh,
        raster: &Raster,
    ) -> Option<(Atlas, Option<Tiling>)> {
        let most = MOST_VALUES;
        match (toml.placement, &toml.plane) {
            (TexturePlacementToml::Plane, plane) => {
                let camera = self.raster_plane(&member(item, "plane"), plane.as_ref(), raster)?;
                let projection = Camera::Parallel(camera).projection();
                if toml.wrap.is_some() {
                    self.problem(
                        &member(item, "wrap"),
                        "does not go with a plane: only texture coordinates are repeated",
                    );
                    return None;
                }
                let facets = 0..mesh.facets.len();
                let corners = facets.map(|f| mesh.facet(f).corners_m.map(|p| projection.at(p))).collect();
                Some((Atlas { corners, rows: raster.rows, columns: raster.columns }, None))
            }
            (TexturePlacementToml::Atlas, Some(_)) => {
                self.problem(&member(item, "plane"), "does not go with texture coordinates");
                None
            }
            (TexturePlacementToml::Atlas, None) => {
                let own = (0..mesh.facets.len()).filter(|f| mesh.material[*f].0 as usize == id);
                let uv = own.map(|f| mesh.uv.get(f));
                let help = "an OBJ has them as `vt` lines, and its faces as `f 1/1 2/2 3/3`";
                let lacks =
                    |uv: Option<&[[f64; 2]; 3]>| uv.is_none_or(|uv| uv.as_flattened().iter().any(|x| x.is_nan()));
                let (facets, lacking) = (uv.clone().count(), uv.filter(|uv| lacks(*uv)).count());
                if lacking == facets && facets > 0 {
                    self.helped(
                        &member(item, "placement"),
                        format!("facets of {material:?} have no texture coordinates"),
                        help,
                    );
                    return None;
                }
                if lacking > 0 {
                    let message = format!(
                        "{lacking} of the {facets} facets of {material:?} have no texture coordinates: the texture is not on them"
                    );
                    self.note(&member(item, "placement"), message);
                }
                // Those of other materials are of no meaning.
                let is_own = |facet: usize| mesh.material[facet].0 as usize == id;
                let own = |(facet, uv): (usize, &[[f64; 2]; 3])| if is_own(facet) { *uv } else { NO_UV };
                let uv = mesh.uv.iter().enumerate().map(own).collect();
                let (mut atlas, tiling) =
                    self.atlas(&member(item, "placement"), uv, [raster.rows, raster.columns], toml.wrap, most)?;
                let of_own = atlas.corners.iter_mut().enumerate().filter(|(facet, _)| is_own(*facet));
                of_own.filter(|(_, corners)| lacks(Some(corners))).for_each(|(_, corners)| *corners = UNCOVERED);
                Some((atlas, tiling))
            }
            // It has no coordinates of corners.
            (TexturePlacementToml::LonLat, _) => None,
        }
    }
}
