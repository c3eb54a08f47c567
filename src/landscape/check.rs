//! What a recipe may ask for.

use std::ops::RangeInclusive;

use super::crater::REACH;
use super::recipe::{BodyRecipe, Boulders, Craters, Height, NearCraters, Recipe, Relief, Span, Where};
use crate::error::{Location, Problem, number};

/// The facet counts that a recipe may ask for.
pub const FACETS: RangeInclusive<u32> = 1_000..=4_000_000;

/// Least and largest side of a site, m.
const SIZE_M: (f64, f64) = (10.0, 1e5);

/// Largest distance that surroundings reach, m.
const REACH_M: f64 = 1e6;

/// The number of boulders that half of the largest number of facets can make.
const MOST_BOULDERS: f64 = 100_000.0;

/// A bound on the time a recipe can take.
pub(super) const MOST_CRATERS: f64 = 1_000_000.0;

/// The same: a place is changed by so many craters at most, on average.
const MOST_OVER_A_PLACE: f64 = 1000.0;

/// A bound on the memory that a texture takes.
const MOST_TEXELS: u32 = 8192;

/// Most layers, groups, and rules of each kind.
const MOST_ITEMS: usize = 64;

/// The narrowest gap between the fine part and the end of the mesh, as a share of the widest: narrower ones make slivers.
const NARROWEST: f64 = 0.1;

/// No point of a boulder is farther from its middle, in longest axes: what stands out of its box when it is turned is less.
pub(super) const FARTHEST: f64 = 0.65;

/// A problem with an item of a recipe.
pub(super) fn at(key: &str, message: impl Into<String>) -> Problem {
    Problem::new(Location::item(format!("recipe.{key}")), message)
}

/// Collects problems.
struct Found(Vec<Problem>);

impl Found {
    fn say(&mut self, key: &str, message: impl Into<String>) {
        self.0.push(at(key, message));
    }

    /// A value that must lie in a range. Written so that NaN fails; a limit that is NaN gives no range.
    fn range(&mut self, key: &str, value: f64, lo: f64, hi: f64) {
        if !(lo..=hi).contains(&value) && hi >= lo {
            self.say(key, format!("{} is not from {} to {}", number(value), number(lo), number(hi)));
        }
    }

    fn finite(&mut self, key: &str, values: &[f64]) {
        if values.iter().any(|v| !v.is_finite()) {
            self.say(key, "holds a value that is no number");
        }
    }

    /// Two diameters, the smaller first.
    fn diameters(&mut self, group: &str, min_m: f64, max_m: f64, largest_m: f64) {
        self.range(&format!("{group}.min_diameter_m"), min_m, 0.1, largest_m);
        self.range(&format!("{group}.max_diameter_m"), max_m, 0.1, largest_m);
        if min_m > max_m {
            let message = format!("{} is more than max_diameter_m = {}", number(min_m), number(max_m));
            self.say(&format!("{group}.min_diameter_m"), message);
        }
    }

    /// Only one of several ways to say how many.
    fn one_number(&mut self, group: &str, given: &[(&str, bool)]) {
        let given: Vec<&str> = given.iter().filter(|g| g.1).map(|g| g.0).collect();
        if given.len() > 1 {
            self.say(&format!("{group}.{}", given[1]), format!("say how many by one of {}", given.join(", ")));
        }
    }
}

impl Recipe {
    /// Everything that [`generate`](super::generate) would refuse of the recipe itself, each problem at `recipe.key`. What is wrong with files that it names,
    /// and whether there are facets enough for its boulders, only making it says.
    pub fn check(&self) -> Vec<Problem> {
        let mut found = Found(Vec::new());
        if self.version != 2 {
            found.say("version", format!("version {} is not known: this program makes version 2", self.version));
        }
        if i64::try_from(self.seed).is_err() {
            found.say("seed", format!("{} is more than {}, the largest number TOML holds", self.seed, i64::MAX));
        }
        if !FACETS.contains(&self.facets) {
            found.say("facets", format!("{} is not from {} to {}", self.facets, FACETS.start(), FACETS.end()));
        }
        found.range("size_m", self.size_m, SIZE_M.0, SIZE_M.1);
        for (key, count) in [
            ("relief", self.relief.len()),
            ("craters", self.craters.len()),
            ("cover", self.cover.len()),
            ("boulders", self.boulders.len()),
            ("paint", self.paint.len()),
        ] {
            if count > MOST_ITEMS {
                found.say(key, format!("{count} are more than {MOST_ITEMS}"));
            }
        }
        // A range that depends on a bad size is not worth telling.
        let size_m = if (SIZE_M.0..=SIZE_M.1).contains(&self.size_m) { self.size_m } else { f64::NAN };
        self.check_extent(&mut found, size_m);
        for (i, relief) in self.relief.iter().enumerate() {
            check_relief(&mut found, &format!("relief[{i}]"), relief, size_m);
        }
        for (i, relief) in self.cover.iter().enumerate() {
            check_relief(&mut found, &format!("cover[{i}]"), relief, size_m);
        }
        for (i, craters) in self.craters.iter().enumerate() {
            check_craters(&mut found, &format!("craters[{i}]"), craters, size_m);
        }
        let area_km2 = if size_m.is_nan() { 0.0 } else { self.area_km2() };
        let of_all = [
            ("craters", self.craters.iter().map(|c| c.number(area_km2)).sum::<f64>(), MOST_CRATERS),
            ("boulders", self.boulders.iter().map(|b| b.number(area_km2)).sum(), MOST_BOULDERS),
        ];
        for (key, count, most) in of_all {
            if count > most {
                found.say(key, format!("{} in all groups together are more than {most}", number(count)));
            }
        }
        for (i, boulders) in self.boulders.iter().enumerate() {
            self.check_boulders(&mut found, &format!("boulders[{i}]"), boulders, size_m);
        }
        for (i, paint) in self.paint.iter().enumerate() {
            self.check_name(&mut found, &format!("paint[{i}].material"), &paint.material);
            if let Some(area) = &paint.area {
                self.check_area(&mut found, &format!("paint[{i}].where"), area);
            }
        }
        if let Some(body) = &self.body {
            check_body(&mut found, body, size_m);
        }
        self.check_name(&mut found, "ground", &self.ground);
        self.check_materials(&mut found);
        if let Some(texture) = &self.texture {
            if !(2..=MOST_TEXELS).contains(&texture.texels) {
                found.say("texture.texels", format!("{} is not from 2 to {MOST_TEXELS}", texture.texels));
            }
            found.range("texture.rms", texture.rms, 0.0, 0.5);
            found.range("texture.hurst", texture.hurst, 0.05, 2.0);
            if let Some(longest_m) = texture.longest_m {
                found.range("texture.longest_m", longest_m, 1e-4 * size_m, 10.0 * size_m);
            }
        }
        found.0
    }

    fn check_extent(&self, found: &mut Found, size_m: f64) {
        let growths = [
            ("detail.growth", self.detail.as_ref().map(|d| d.growth)),
            ("surroundings.growth", self.surroundings.as_ref().map(|s| s.growth)),
        ];
        for (key, growth) in growths {
            if let Some(growth) = growth {
                found.range(key, growth, 0.01, 1.0);
            }
        }
        let reach_m = self.surroundings.as_ref().map_or(0.0, |s| s.reach_m);
        if self.surroundings.is_some() {
            found.range("surroundings.reach_m", reach_m, 0.01 * size_m, REACH_M.max(size_m));
        }
        let Some(detail) = &self.detail else { return };
        found.range("detail.size_m", detail.size_m, 0.01 * size_m, 0.99 * size_m);
        found.finite("detail", &[detail.x_m, detail.y_m]);
        let (core_m, end_m) = (0.5 * detail.size_m, 0.5 * size_m + reach_m);
        let gaps_m = [detail.x_m, -detail.x_m, detail.y_m, -detail.y_m].map(|c| end_m - core_m - c);
        let (narrowest_m, widest_m) =
            gaps_m.iter().fold((f64::MAX, 0.0), |(lo, hi): (f64, f64), g| (lo.min(*g), hi.max(*g)));
        let outside = detail.x_m.abs().max(detail.y_m.abs()) + core_m > 0.5 * size_m;
        if outside {
            found.say("detail", "it reaches beyond the site's border");
        } else if narrowest_m < NARROWEST * widest_m {
            let message = format!(
                "between it and the mesh's border are {} m on one side and {} m on another: facets on the narrow side would be slivers",
                number(narrowest_m),
                number(widest_m)
            );
            found.0.push(
                at("detail", message)
                    .with_help("move it to the middle, make it smaller, or give the site surroundings"),
            );
        }
    }

    fn check_boulders(&self, found: &mut Found, group: &str, boulders: &Boulders, size_m: f64) {
        let key = |key: &str| format!("{group}.{key}");
        if let Some(per_km2) = boulders.per_km2 {
            found.range(&key("per_km2"), per_km2, 0.0, f64::MAX);
        }
        let count = boulders.number(if size_m.is_nan() { 0.0 } else { self.area_km2() }).max(0.0);
        if !(0.0..=MOST_BOULDERS).contains(&count) {
            found.say(&key("count"), format!("{} is more than {MOST_BOULDERS}", number(count)));
        }
        found.one_number(group, &[("count", boulders.count > 0), ("per_km2", boulders.per_km2.is_some())]);
        found.diameters(group, boulders.min_diameter_m, boulders.max_diameter_m, 0.1 * size_m);
        found.range(&key("exponent"), boulders.exponent, 0.1, 10.0);
        let [least, most] = boulders.buried.ends();
        for end in if least == most { vec![least] } else { vec![least, most] } {
            found.range(&key("buried"), end, 0.0, 1.0);
        }
        if let Span::Range([least, most]) = boulders.buried
            && least > most
        {
            found.say(&key("buried"), format!("{} is more than {}", number(least), number(most)));
        }
        self.check_name(found, &key("material"), &boulders.material);
        for (i, placed) in boulders.placed.iter().enumerate() {
            let half_m = 0.5 * size_m;
            found.range(&key(&format!("placed[{i}].diameter_m")), placed.diameter_m, 0.1, 0.1 * size_m);
            let inside_m = half_m - FARTHEST * placed.diameter_m;
            found.range(&key(&format!("placed[{i}].x_m")), placed.x_m, -inside_m, inside_m);
            found.range(&key(&format!("placed[{i}].y_m")), placed.y_m, -inside_m, inside_m);
        }
        if let Some(area) = &boulders.area {
            self.check_area(found, &key("where"), area);
        }
    }

    fn check_area(&self, found: &mut Found, item: &str, area: &Where) {
        let key = |key: &str| format!("{item}.{key}");
        if let Some(NearCraters { group, min_diameter_m, max_diameter_m, max_age, share, from, to, .. }) = &area.craters
        {
            if let Some(name) = group
                && !self.craters.iter().any(|c| c.name.as_deref() == Some(name))
            {
                let names: Vec<&str> = self.craters.iter().filter_map(|c| c.name.as_deref()).collect();
                let known = if names.is_empty() {
                    "no group has a name".into()
                } else {
                    format!("there are {}", names.join(", "))
                };
                found.say(&key("craters.group"), format!("no group of craters is called {name:?}: {known}"));
            }
            found.range(&key("craters.min_diameter_m"), *min_diameter_m, 0.0, f64::MAX);
            found.range(&key("craters.max_diameter_m"), max_diameter_m.unwrap_or(f64::MAX), *min_diameter_m, f64::MAX);
            found.range(&key("craters.max_age"), *max_age, 0.0, 1.0);
            found.range(&key("craters.share"), *share, 0.0, 1.0);
            found.range(&key("craters.from"), *from, 0.0, 100.0);
            found.range(&key("craters.to"), *to, *from, 100.0);
        }
        if let Some([x_m, y_m, radius_m]) = area.circle_m {
            found.finite(&key("circle_m"), &[x_m, y_m]);
            found.range(&key("circle_m"), radius_m, f64::MIN_POSITIVE, f64::MAX);
        }
        if let Some(corners_m) = &area.polygon_m {
            if corners_m.len() < 3 {
                found.say(&key("polygon_m"), format!("{} corners: a polygon has three or more", corners_m.len()));
            }
            found.finite(&key("polygon_m"), corners_m.as_flattened());
        }
        if let Some(noise) = &area.noise {
            found.range(&key("noise.longest_m"), noise.longest_m, 1e-3 * self.size_m, 10.0 * self.size_m);
            found.range(&key("noise.share"), noise.share, 0.0, 1.0);
            found.range(&key("noise.hurst"), noise.hurst, 0.05, 2.0);
        }
        for (name, range) in [("slope_deg", area.slope_deg), ("height_m", area.height_m)] {
            let Some([from, to]) = range else { continue };
            // Of NaN neither.
            let is_range = from <= to;
            if !is_range {
                found.say(&key(name), format!("{} to {} is no range", number(from), number(to)));
            }
        }
    }

    /// A material's name that a line of an OBJ or MTL file can hold.
    fn check_name(&self, found: &mut Found, key: &str, name: &str) {
        if name.trim() != name || name.is_empty() || name.chars().any(char::is_control) {
            found.say(key, format!("{name:?} is no name of a material"));
        }
    }

    fn check_materials(&self, found: &mut Found) {
        for (name, material) in &self.materials {
            let item = format!("materials.{name}");
            self.check_name(found, &item, name);
            for channel in material.colour.into_iter().flatten() {
                found.range(&format!("{item}.colour"), channel, 0.0, 1.0);
            }
            let Some(mixture) = &material.mixture else { continue };
            for (part, share) in mixture {
                found.range(&format!("{item}.mixture"), *share, 0.0, 1.0);
                if self.materials.get(part).is_some_and(|m| m.mixture.is_some()) {
                    found.say(
                        &format!("{item}.mixture"),
                        format!("{part:?} is a mixture itself: name what it is made of"),
                    );
                }
            }
            let sum: f64 = mixture.values().sum();
            if !((1.0 - 1e-6)..=(1.0 + 1e-6)).contains(&sum) {
                found.say(&format!("{item}.mixture"), format!("the shares add up to {}, not to 1", number(sum)));
            }
        }
    }
}

fn check_body(found: &mut Found, body: &BodyRecipe, size_m: f64) {
    let shapes = [
        ("shape", body.shape.is_some()),
        ("ellipsoid_m", body.ellipsoid_m.is_some()),
        ("files", body.files.as_ref().is_some_and(|files| !files.is_empty())),
    ];
    let only_one = |found: &mut Found, given: &[(&str, bool)]| {
        if given.iter().filter(|g| g.1).count() != 1 {
            let names: Vec<&str> = given.iter().map(|g| g.0).collect();
            found.say("body", format!("give one of {}", names.join(", ")));
        }
    };
    only_one(found, &shapes);
    only_one(found, &[("target_m", body.target_m.is_some()), ("lonlat_deg", body.lonlat_deg.is_some())]);
    if body.azimuth_deg.is_some() && body.along.is_some() {
        found.say("body.along", "the same as azimuth_deg: give one of them");
    }
    if body.lonlat_deg.is_some() && body.height == Some(Height::Target) {
        found.say("body.height", "a target by longitude and latitude has no height of its own: give target_m");
    }
    for axis in body.ellipsoid_m.into_iter().flatten() {
        found.range("body.ellipsoid_m", axis, size_m, 1e9);
    }
    if let Some(unit_m) = body.unit_m {
        found.range("body.unit_m", unit_m, 1e-6, 1e9);
        if body.files.is_none() {
            found.say("body.unit_m", "is for `files`");
        }
    }
    let lengths = [("body.offset_m", body.offset_m), ("body.target_m", body.target_m), ("body.along", body.along)];
    for (key, vector) in lengths {
        found.finite(key, vector.as_ref().map_or(&[], |v| v.as_slice()));
        if key != "body.offset_m" && vector == Some([0.0; 3]) {
            found.say(key, "has no direction");
        }
    }
    if let Some([longitude_deg, latitude_deg]) = body.lonlat_deg {
        found.range("body.lonlat_deg", longitude_deg, -360.0, 360.0);
        found.range("body.lonlat_deg", latitude_deg, -90.0, 90.0);
    }
    if let Some(azimuth_deg) = body.azimuth_deg {
        found.range("body.azimuth_deg", azimuth_deg, -360.0, 360.0);
    }
}

fn check_relief(found: &mut Found, item: &str, relief: &Relief, size_m: f64) {
    let key = |key: &str| format!("{item}.{key}");
    match *relief {
        Relief::Rolling { rms_m, longest_m, hurst } | Relief::Ridged { rms_m, longest_m, hurst } => {
            found.range(&key("rms_m"), rms_m, 0.0, 0.5 * size_m);
            found.range(&key("longest_m"), longest_m, 0.001 * size_m, 10.0 * size_m);
            found.range(&key("hurst"), hurst, 0.05, 2.0);
        }
        Relief::Dunes { height_m, wavelength_m, towards_deg, rise, wander } => {
            found.range(&key("height_m"), height_m, 0.0, 0.5 * size_m);
            found.range(&key("wavelength_m"), wavelength_m, 0.001 * size_m, 10.0 * size_m);
            found.range(&key("towards_deg"), towards_deg, -360.0, 360.0);
            found.range(&key("rise"), rise, 0.05, 0.95);
            found.range(&key("wander"), wander, 0.0, 2.0);
        }
        Relief::Mound { x_m, y_m, height_m, flank_deg, length_m, along_deg, top_m, ragged } => {
            found.range(&key("x_m"), x_m, -10.0 * size_m, 10.0 * size_m);
            found.range(&key("y_m"), y_m, -10.0 * size_m, 10.0 * size_m);
            found.range(&key("height_m"), height_m, -size_m, size_m);
            found.range(&key("flank_deg"), flank_deg, 0.1, 85.0);
            found.range(&key("length_m"), length_m, 0.0, 100.0 * size_m);
            found.range(&key("along_deg"), along_deg, -360.0, 360.0);
            found.range(&key("top_m"), top_m, 0.0, 10.0 * size_m);
            found.range(&key("ragged"), ragged, 0.0, 1.0);
        }
        Relief::Elevation { pixel_m, width_m, height_m, amplify, repeat, ratio, hurst, turn_deg, .. } => {
            for (name, value) in [("pixel_m", pixel_m), ("width_m", width_m)] {
                if let Some(value) = value {
                    found.range(&key(name), value, 1e-6, 1e9);
                }
            }
            if let Some(height_m) = height_m {
                found.range(&key("height_m"), height_m, 0.0, size_m);
            }
            found.range(&key("amplify"), amplify, -1e3, 1e3);
            if repeat > 8 {
                found.say(&key("repeat"), format!("{repeat} is more than 8"));
            }
            found.range(&key("ratio"), ratio, 1.5, 100.0);
            found.range(&key("hurst"), hurst, 0.0, 3.0);
            found.range(&key("turn_deg"), turn_deg, -360.0, 360.0);
        }
    }
}

fn check_craters(found: &mut Found, group: &str, craters: &Craters, size_m: f64) {
    let key = |key: &str| format!("{group}.{key}");
    for (name, value) in [("per_km2", craters.per_km2), ("saturation", craters.saturation)] {
        if let Some(value) = value {
            found.range(&key(name), value, 0.0, f64::MAX);
        }
    }
    let count = craters.number(if size_m.is_nan() { 0.0 } else { 1e-6 * size_m * size_m }).max(0.0);
    if !(0.0..=MOST_CRATERS).contains(&count) {
        found.say(&key("count"), format!("{} is more than {MOST_CRATERS}", number(count)));
    }
    // Mean square of diameters, m2, over even shares of the population.
    let is_range = craters.min_diameter_m <= craters.max_diameter_m;
    let diameter_m = |share: f64| if is_range { craters.law().size(share) } else { f64::NAN };
    let mean_m2 = (0..100).map(|i| diameter_m(f64::from(i) / 100.0 + 0.005).powi(2)).sum::<f64>() / 100.0;
    let over_a_place = count * REACH * REACH * std::f64::consts::FRAC_PI_4 * mean_m2 / (size_m * size_m);
    if over_a_place > MOST_OVER_A_PLACE {
        let message = format!(
            "each place would be changed by {over_a_place:.0} craters on average: more than {MOST_OVER_A_PLACE}"
        );
        found.0.push(
            at(&key("count"), message)
                .with_help("ask for fewer, or for smaller ones: later craters erase earlier ones anyway"),
        );
    }
    let given = [
        ("count", craters.count > 0),
        ("per_km2", craters.per_km2.is_some()),
        ("saturation", craters.saturation.is_some()),
    ];
    found.one_number(group, &given);
    found.diameters(group, craters.min_diameter_m, craters.max_diameter_m, 2.0 * size_m);
    found.range(&key("exponent"), craters.exponent, 0.1, 10.0);
    found.range(&key("depth"), craters.depth, 0.0, 1.0);
    found.range(&key("rim"), craters.rim, 0.0, craters.depth.clamp(0.0, 1.0));
    found.range(&key("softness"), craters.softness, 0.0, 1.0);
    found.range(&key("creep_m"), craters.creep_m, 0.0, 1e6);
    for (i, placed) in craters.placed.iter().enumerate() {
        let item = |name: &str| key(&format!("placed[{i}].{name}"));
        found.range(&item("x_m"), placed.x_m, -10.0 * size_m, 10.0 * size_m);
        found.range(&item("y_m"), placed.y_m, -10.0 * size_m, 10.0 * size_m);
        found.range(&item("diameter_m"), placed.diameter_m, 0.1, 2.0 * size_m);
        found.range(&item("age"), placed.age, 0.0, 1.0);
    }
}
