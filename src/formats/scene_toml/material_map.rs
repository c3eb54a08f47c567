//! Which material each facet of a mesh is of, as an image says it.

use std::collections::BTreeMap;

use super::super::located::member;
use super::TomlReader;
use super::atlas::Tiling;
use super::materials::Dictionary;
use super::rasters::MOST_VALUES;
use super::types::{MaterialMapToml, TexturePlacementToml};
use crate::error::number;
use crate::geometry::{Camera, MaterialId, Mesh, Pose, whole};
use crate::product::Atlas;

/// What an image has at a texel: a number, or red, green and blue of a picture, 0 to 255.
type Class = Vec<f64>;

/// A number, or `#rrggbb`, as a key says it.
fn class(key: &str) -> Option<Class> {
    if let Some(digits) = key.strip_prefix('#') {
        let is_hex = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
        let all = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex)?;
        return Some([all >> 16, all >> 8 & 255, all & 255].map(f64::from).to_vec());
    }
    key.parse().ok().filter(|number: &f64| number.is_finite()).map(|number| vec![number])
}

/// A class as a key says it.
fn key_of(class: &[f64]) -> String {
    match class {
        [number_] => number(*number_),
        bands => {
            let hex: Vec<String> = bands.iter().map(|band| format!("{:02x}", whole(*band))).collect();
            format!("#{}", hex.concat())
        }
    }
}

impl TomlReader<'_> {
    /// The dictionary's entry for each facet of a mesh, by what the map has at the facet's middle; none where it has nothing.
    ///
    /// `pose` puts the mesh where it stands.
    pub(super) fn material_map(
        &mut self,
        item: &str,
        toml: &MaterialMapToml,
        (mesh, pose): (&Mesh, &Pose),
        dictionary: &mut Dictionary,
    ) -> Option<Vec<Option<MaterialId>>> {
        let at = |key: &str| member(item, key);
        let entries = self.classes(&at("materials"), &toml.materials, dictionary);
        let rasters = self.opened(&at("raster"), vec![self.path(&toml.raster)], toml.channels.as_deref())?;
        let [mut raster] = <[_; 1]>::try_from(rasters).ok()?;
        let entries = entries?;
        let bands = raster.bands.len();
        if let Some((class, _)) = entries.iter().find(|(class, _)| class.len() != bands) {
            let message = format!(
                "{:?} is a {}, and the raster has {bands} bands",
                key_of(class),
                if class.len() == 1 { "number" } else { "colour" }
            );
            self.helped(
                &at("materials"),
                message,
                "numbers are for one band, \"#rrggbb\" for three; `channels` chooses bands",
            );
            return None;
        }
        let (middles, tiling) = self.middles(item, toml, (mesh, pose), &raster)?;
        let columns = tiling.as_ref().map_or(raster.columns, |tiling| tiling.size[1]);

        let mut classes: Vec<Class> = vec![Vec::new(); mesh.facets.len()];
        let (mut band, mut larger) = (Vec::new(), Vec::new());
        for number in 0..bands {
            self.taken(&at("raster"), raster.read(number, &mut band))?;
            if let Some(tiling) = &tiling {
                tiling.expanded(&band, &mut larger);
                std::mem::swap(&mut band, &mut larger);
            }
            for (class, middle) in classes.iter_mut().zip(&middles) {
                let value = middle.map_or(f64::NAN, |[column, row]| band[row * columns + column]);
                // Of a picture: what is stored.
                class.push(raster.full_scale.map_or(value, |scale| (value * scale).round()));
            }
        }

        let mut unknown: BTreeMap<String, usize> = BTreeMap::new();
        let of_class = |class: Class| {
            if class.iter().any(|value| value.is_nan()) {
                return None;
            }
            let entry = entries.iter().find(|(known, _)| *known == class);
            if entry.is_none() {
                *unknown.entry(key_of(&class)).or_default() += 1;
            }
            entry.map(|(_, entry)| *entry)
        };
        let found: Vec<Option<MaterialId>> = classes.into_iter().map(of_class).collect();
        if !unknown.is_empty() {
            let listed: Vec<String> = unknown.iter().take(5).map(|(key, n)| format!("{key:?} ({n} facets)")).collect();
            let more = if unknown.len() > 5 { format!(" and {} more", unknown.len() - 5) } else { String::new() };
            self.helped(
                &at("materials"),
                format!("says nothing of what the map has: {}{more}", listed.join(", ")),
                "add each as a key with the name of a material",
            );
            return None;
        }
        let left = found.iter().filter(|entry| entry.is_none()).count();
        if left > 0 {
            self.note(
                item,
                format!(
                    "{left} of {} facets lie where the map has nothing: they keep the mesh's own material, which must then be one of `[materials]`",
                    found.len()
                ),
            );
        }
        Some(found)
    }

    /// What each class is made of.
    fn classes(
        &mut self,
        item: &str,
        materials: &BTreeMap<String, String>,
        dictionary: &mut Dictionary,
    ) -> Option<Vec<(Class, MaterialId)>> {
        let mut all = Some(Vec::new());
        for (key, name) in materials {
            let at = member(item, key);
            let class = class(key);
            if class.is_none() {
                self.helped(&at, format!("{key:?} is neither a number nor a colour"), "as 3 or \"#aa907c\"");
            }
            match (class, self.entry_named(&at, name, dictionary), &mut all) {
                (Some(class), Some(entry), Some(all)) if !all.iter().any(|(other, _)| *other == class) => {
                    all.push((class, entry))
                }
                (Some(class), Some(_), Some(_)) => {
                    self.problem(&at, format!("stands for the same as another key, {}", key_of(&class)));
                    all = None;
                }
                _ => all = None,
            }
        }
        if materials.is_empty() {
            self.problem(item, "names no material");
            all = None;
        }
        all
    }

    /// The texel (column, row) at the middle of each facet, none beyond the image; and the image that texels are of, where it is a larger one.
    #[expect(clippy::type_complexity, reason = "one value for each facet, and how to read them")]
    fn middles(
        &mut self,
        item: &str,
        toml: &MaterialMapToml,
        (mesh, pose): (&Mesh, &Pose),
        raster: &super::super::raster::Raster,
    ) -> Option<(Vec<Option<[usize; 2]>>, Option<Tiling>)> {
        let facets = 0..mesh.facets.len();
        let middle_m = |f: usize| pose.point(mesh.facet(f).centroid_m());
        let of_image = [raster.rows, raster.columns];
        let within = |[column, row]: [f64; 2], [rows, columns]: [usize; 2]| {
            let is_there = (0.0..=columns as f64).contains(&column) && (0.0..=rows as f64).contains(&row);
            is_there.then(|| [whole(column).min(columns - 1), whole(row).min(rows - 1)])
        };
        let others = [
            ("plane", toml.plane.is_some(), TexturePlacementToml::Plane),
            ("wrap", toml.wrap.is_some(), TexturePlacementToml::Atlas),
            ("west_deg", toml.west_deg.is_some(), TexturePlacementToml::LonLat),
        ];
        for (key, is_given, placement) in others {
            self.goes_without(item, key, is_given && placement != toml.placement)?;
        }
        match toml.placement {
            TexturePlacementToml::LonLat => {
                let (map, tiling) =
                    self.lon_lat(&member(item, "west_deg"), toml.west_deg, std::slice::from_ref(raster), MOST_VALUES)?;
                let texels = facets.map(|f| within(map.texel(middle_m(f) - map.centre_m), tiling.size)).collect();
                Some((texels, Some(tiling)))
            }
            TexturePlacementToml::Plane => {
                let camera = self.raster_plane(&member(item, "plane"), toml.plane.as_ref(), raster)?;
                let projection = Camera::Parallel(camera).projection();
                Some((facets.map(|f| within(projection.at(middle_m(f)), of_image)).collect(), None))
            }
            TexturePlacementToml::Atlas => {
                if mesh.uv.is_empty() {
                    let help = "an OBJ has them as `vt` lines, and its faces as `f 1/1 2/2 3/3`";
                    self.helped(&member(item, "placement"), "the mesh has no texture coordinates", help);
                    return None;
                }
                let at = member(item, "placement");
                let (Atlas { corners, rows, columns }, tiling) =
                    self.atlas(&at, mesh.uv.clone(), of_image, toml.wrap, MOST_VALUES)?;
                let middle = |[a, b, c]: &[[f64; 2]; 3]| [0, 1].map(|k| (a[k] + b[k] + c[k]) / 3.0);
                Some((corners.iter().map(|corners| within(middle(corners), [rows, columns])).collect(), tiling))
            }
        }
    }
}
