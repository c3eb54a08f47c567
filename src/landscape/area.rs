//! Parts of a site: what is in them, and to what share.

use super::crater::Crater;
use super::cratering::Ground;
use super::lookup::Lookup;
use super::noise::{Form, Octaves};
use super::random::{Purpose, key, key_in};
use super::recipe::{NearCraters, Patches, Recipe, Where};
use super::sources::{Source, Sources};
use crate::geometry::{index_u32, whole};
use crate::random::{Draws, mix};

/// Places along a side of the site at which patches of noise are counted.
const COUNTED: usize = 256;

/// A part of the site.
#[derive(Debug, Clone)]
pub(super) struct Area<'a> {
    area: &'a Where,
    size_m: f64,
    craters: Option<Chosen>,
    /// The noise, and from where on it is a patch.
    noise: Option<(Octaves, f64)>,
    map: Option<&'a Source>,
}

/// The craters that an area refers to.
#[derive(Debug, Clone)]
struct Chosen {
    /// Centre and rim radius, m.
    circles_m: Vec<[f64; 3]>,
    from: f64,
    to: f64,
    ejecta: bool,
    lookup: Lookup,
}

/// What the ground is like at a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lie {
    pub(super) height_m: f64,
    pub(super) slope_deg: f64,
}

impl Lie {
    /// At a place of the ground as seen on steps of this width.
    pub(super) fn of(ground: &Ground, [x_m, y_m]: [f64; 2], step_m: f64) -> Self {
        let at = |dx: f64, dy: f64| ground.height_m(x_m + dx * step_m, y_m + dy * step_m, step_m);
        let (east, north) = (at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5));
        Lie { height_m: at(0.0, 0.0), slope_deg: (east.hypot(north) / step_m).atan().to_degrees() }
    }
}

impl<'a> Area<'a> {
    /// An area of a recipe; `number` tells it from its other areas.
    ///
    /// # Errors
    /// The key that cannot be used, and why.
    pub(super) fn new(
        area: &'a Where,
        number: usize,
        recipe: &Recipe,
        craters: &[Crater],
        sources: &'a Sources,
    ) -> Result<Self, (&'static str, String)> {
        let map = match &area.map {
            Some(file) => {
                let source = sources.rasters.get(file).ok_or_else(|| ("map", format!("{file} has not been read")))?;
                let full = source.full_scale.unwrap_or(1.0);
                let wrong = source.values.iter().position(|v| !(0.0..=full).contains(v));
                if let Some(wrong) = wrong {
                    let (column, row) = (wrong % source.columns, wrong / source.columns);
                    let value = crate::error::number(source.values[wrong]);
                    return Err((
                        "map",
                        format!(
                            "{file} has {value} in column {column}, line {row} (counted from 0): shares are from 0 to {full}"
                        ),
                    ));
                }
                Some(source)
            }
            None => None,
        };
        let noise = area
            .noise
            .as_ref()
            .map(|patches| patches_of(patches, key(recipe.seed, Purpose::Mask, number as u64), recipe.size_m));
        let craters = match &area.craters {
            Some(near) => {
                let chosen = Chosen::new(near, number, recipe, craters);
                if chosen.circles_m.is_empty() {
                    return Err(("craters", "no crater on the site fits".into()));
                }
                Some(chosen)
            }
            None => None,
        };
        Ok(Area { area, size_m: recipe.size_m, craters, noise, map })
    }

    /// The share, 0 to 1, of what would be at a place, m; what the ground is like there is asked only if that matters.
    pub(super) fn share(&self, [x_m, y_m]: [f64; 2], lie: impl FnOnce() -> Lie) -> f64 {
        let mut share = 1.0;
        let mut also = |holds: bool| share *= f64::from(u8::from(holds));
        if let Some([cx_m, cy_m, radius_m]) = self.area.circle_m {
            also((x_m - cx_m).hypot(y_m - cy_m) <= radius_m);
        }
        if let Some(corners_m) = &self.area.polygon_m {
            also(holds(corners_m, x_m, y_m));
        }
        if let Some((octaves, least)) = &self.noise {
            also(octaves.height_m(Form::Rolling, x_m, y_m, 0.0) >= *least);
        }
        if let Some(map) = self.map {
            let place = |p_m: f64, count: usize| whole(((p_m / self.size_m + 0.5) * count as f64).max(0.0));
            share *= map.at(place(x_m, map.columns), place(-y_m, map.rows)) / map.full_scale.unwrap_or(1.0);
        }
        if let Some(chosen) = &self.craters
            && share > 0.0
        {
            share *= chosen.share(x_m, y_m);
        }
        if (self.area.slope_deg.is_some() || self.area.height_m.is_some()) && share > 0.0 {
            let Lie { height_m, slope_deg } = lie();
            let is_in =
                |range: Option<[f64; 2]>, value: f64| range.is_none_or(|[from, to]| (from..=to).contains(&value));
            share *= f64::from(u8::from(is_in(self.area.slope_deg, slope_deg) && is_in(self.area.height_m, height_m)));
        }
        if self.area.outside { 1.0 - share } else { share }
    }
}

impl Chosen {
    fn new(near: &NearCraters, number: usize, recipe: &Recipe, craters: &[Crater]) -> Self {
        let fits = |c: &&Crater| {
            near.group.as_ref().is_none_or(|name| recipe.craters[c.group].name.as_ref() == Some(name))
                && c.diameter_m >= near.min_diameter_m
                && near.max_diameter_m.is_none_or(|most_m| c.diameter_m <= most_m)
                && c.age <= near.max_age
        };
        let by_chance = |c: &Crater| {
            // By what the crater is, so that others do not change it.
            let key =
                key_in(recipe.seed, Purpose::Choice, number, mix(c.x_m.to_bits() ^ c.y_m.to_bits().rotate_left(32)));
            Draws::new(key).unit() < near.share
        };
        let mut chosen: Vec<&Crater> = craters.iter().filter(fits).filter(|c| by_chance(c)).collect();
        if let Some(most) = near.largest {
            chosen.sort_by(|a, b| b.diameter_m.total_cmp(&a.diameter_m));
            chosen.truncate(most as usize);
        }
        let mut lookup = Lookup::new(0.5 * recipe.size_m);
        for (i, c) in chosen.iter().enumerate() {
            lookup.insert([c.x_m, c.y_m], 0.5 * c.diameter_m * near.to, index_u32(i));
        }
        let circles_m = chosen.iter().map(|c| [c.x_m, c.y_m, 0.5 * c.diameter_m]).collect();
        Chosen { circles_m, from: near.from, to: near.to, ejecta: near.ejecta, lookup }
    }

    /// The largest share that one of the craters gives.
    fn share(&self, x_m: f64, y_m: f64) -> f64 {
        let share = |[cx_m, cy_m, radius_m]: [f64; 3]| {
            let r = (x_m - cx_m).hypot(y_m - cy_m) / radius_m;
            match (self.from..=self.to).contains(&r) {
                false => 0.0,
                true if self.ejecta => r.max(1.0).powi(-3),
                true => 1.0,
            }
        };
        match self.lookup.at(x_m, y_m) {
            Some(numbers) => numbers.iter().map(|&i| share(self.circles_m[i as usize])).fold(0.0, f64::max),
            None => self.circles_m.iter().map(|&circle| share(circle)).fold(0.0, f64::max),
        }
    }
}

/// Noise, and the value above which a share of the site lies.
fn patches_of(patches: &Patches, key: u64, size_m: f64) -> (Octaves, f64) {
    let octaves = Octaves::new(|k| mix(key ^ k), 1.0, patches.longest_m, patches.hurst, 1e-3 * patches.longest_m);
    let place = |i: usize| size_m * ((i as f64 + 0.5) / COUNTED as f64 - 0.5);
    let mut values: Vec<f64> = (0..COUNTED * COUNTED)
        .map(|i| octaves.height_m(Form::Rolling, place(i % COUNTED), place(i / COUNTED), 0.0))
        .collect();
    values.sort_by(f64::total_cmp);
    let below = whole(((1.0 - patches.share) * values.len() as f64).round());
    let least = values.get(below).copied().unwrap_or(f64::INFINITY);
    (octaves, least)
}

/// Whether a polygon holds a place, by the even-odd rule; the south and west borders of a box belong to it.
fn holds(corners_m: &[[f64; 2]], x_m: f64, y_m: f64) -> bool {
    let edges = corners_m.iter().zip(corners_m.iter().cycle().skip(1));
    let crossed = edges.filter(|([ax, ay], [bx, by])| {
        // Half-open, so that a corner at the place's own height is met once.
        (*ay <= y_m) != (*by <= y_m) && x_m < ax + (y_m - ay) / (by - ay) * (bx - ax)
    });
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::cratering::produced;
    use crate::landscape::recipe::Craters;

    const LIE: Lie = Lie { height_m: 5.0, slope_deg: 20.0 };

    fn at(x_m: f64, y_m: f64) -> ([f64; 2], Lie) {
        ([x_m, y_m], LIE)
    }

    fn of(area: &Area, (place_m, lie): ([f64; 2], Lie)) -> f64 {
        area.share(place_m, || lie)
    }

    fn parsed(text: &str) -> Where {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn what_is_given_must_all_hold() {
        let recipe = Recipe::plane(1);
        for (text, inside, outside) in [
            ("circle_m = [10.0, 0.0, 5.0]", at(14.0, 0.0), at(4.0, 0.0)),
            ("polygon_m = [[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]]", at(4.0, 4.0), at(6.0, 6.0)),
            ("polygon_m = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]", at(0.0, 0.0), at(10.0, 10.0)),
            ("slope_deg = [10.0, 20.0]", at(0.0, 0.0), ([0.0, 0.0], Lie { slope_deg: 21.0, ..LIE })),
            ("height_m = [5.0, 9.0]", at(0.0, 0.0), ([0.0, 0.0], Lie { height_m: 4.9, ..LIE })),
            ("circle_m = [10.0, 0.0, 5.0]\noutside = true", at(4.0, 0.0), at(14.0, 0.0)),
            (
                "circle_m = [0.0, 0.0, 5.0]\nheight_m = [0.0, 9.0]",
                at(1.0, 0.0),
                ([1.0, 0.0], Lie { height_m: -1.0, ..LIE }),
            ),
            ("", at(999.0, 0.0), at(f64::NAN, 0.0)),
        ] {
            let sources = Sources::default();
            let area = parsed(text);
            let area = Area::new(&area, 0, &recipe, &[], &sources).unwrap();
            assert_eq!(of(&area, inside), 1.0, "{text}");
            assert!(text.is_empty() || of(&area, outside) == 0.0, "{text}");
        }
    }

    #[test]
    fn patches_cover_their_share() {
        let recipe = Recipe::plane(1);
        for share in [0.0, 0.1, 0.5, 1.0] {
            let area = parsed(&format!("noise = {{ longest_m = 150.0, share = {share:?} }}"));
            let sources = Sources::default();
            let area = Area::new(&area, 3, &recipe, &[], &sources).unwrap();
            let places = (0..90_000).map(|i| at(f64::from(i % 300) * 6.6 - 990.0, f64::from(i / 300) * 6.6 - 990.0));
            let covered = places.map(|spot| of(&area, spot)).sum::<f64>() / 90_000.0;
            assert!((covered - share).abs() < 0.01, "{share}: {covered}");
        }
    }

    #[test]
    fn maps_lie_north_up_and_tell_bad_shares() {
        let recipe = Recipe::plane(1);
        let mut source = Source {
            columns: 2,
            rows: 2,
            values: vec![0.0, 255.0, 51.0, 0.0],
            pixel_m: None,
            pixel_deg: None,
            full_scale: Some(255.0),
        };
        let area = parsed("map = \"m\"");
        let sources = Sources { rasters: [("m".into(), source.clone())].into(), ..Sources::default() };
        let map = Area::new(&area, 0, &recipe, &[], &sources).unwrap();
        assert_eq!(
            [at(-1.0, 1.0), at(1.0, 1.0), at(-1.0, -1.0), at(1.0, -1.0)].map(|s| of(&map, s)),
            [0.0, 1.0, 0.2, 0.0]
        );
        assert_eq!(of(&map, at(1e9, 1e9)), 1.0);
        source.full_scale = None;
        let sources = Sources { rasters: [("m".into(), source)].into(), ..Sources::default() };
        let (key, message) = Area::new(&area, 0, &recipe, &[], &sources).unwrap_err();
        assert!(key == "map" && message.contains("255 in column 1, line 0"), "{message}");
    }

    #[test]
    fn craters_are_chosen_and_reach_as_asked() {
        let group =
            |name: &str, count| Craters { name: Some(name.into()), count, min_diameter_m: 50.0, ..Craters::default() };
        let recipe = Recipe { craters: vec![group("old", 40), group("new", 40)], ..Recipe::plane(1) };
        let craters = produced(&recipe);
        let sources = Sources::default();
        let chosen = |text: &str| {
            let area = parsed(text);
            let area = Area::new(&area, 0, &recipe, &craters, &sources).unwrap();
            area.craters.unwrap().circles_m
        };
        assert_eq!(chosen("craters = {}").len(), 80);
        assert_eq!(chosen("craters = { group = \"new\" }").len(), 40);
        let largest = chosen("craters = { group = \"old\", largest = 3 }");
        let mut radii: Vec<f64> = craters[..40].iter().map(|c| 0.5 * c.diameter_m).collect();
        radii.sort_by(|a, b| b.total_cmp(a));
        assert_eq!(largest.iter().map(|c| c[2]).collect::<Vec<_>>(), radii[..3]);
        let some = chosen("craters = { share = 0.5 }").len();
        assert!((25..55).contains(&some), "{some}");

        let c = &craters[7];
        let east = |r: f64| at(c.x_m + 0.5 * r * c.diameter_m, c.y_m);
        let text = format!(
            "craters = {{ min_diameter_m = {0:?}, max_diameter_m = {0:?}, from = 0.5, to = 3.0, ejecta = true }}",
            c.diameter_m
        );
        let area = parsed(&text);
        let area = Area::new(&area, 0, &recipe, &craters, &sources).unwrap();
        for (r, share) in [(0.4, 0.0), (0.6, 1.0), (2.0, 0.125), (3.1, 0.0)] {
            assert!((of(&area, east(r)) - share).abs() < 1e-12, "{r}");
        }
        let none = parsed("craters = { min_diameter_m = 1e6 }");
        assert_eq!(Area::new(&none, 0, &recipe, &craters, &sources).unwrap_err().0, "craters");
    }
}
