//! Facet tables: written and read back bit for bit.
//!
//! Version 2 names its sources in the header, and has the arrays of each under its name: `sun_direction`, `sun_irradiance`,
//! `mars_position_m` ... Version 1 has the Sun and Mars alone, and of Mars the direction. Version 3 has the shares of lit polygons that
//! overlap, of a Sun that is a disc, and the light that facets send each other, `reflected_0` ...; a table without either is written as version 2.

use std::path::Path;

use glam::DVec3;

use super::archive::Npz;
use super::write::{About, Column, Values, write};
use super::{Header, ReflectedBy, TABLE, TABLE_VERSIONS};
use crate::error::{Error, Location, Problem, Result, number};
use crate::product::{FacetTable, Lighting, Reflected, Sees};
use crate::scene::{DirectionField, Sky};
use crate::visibility::{Seen, Shown};

/// The first version with shares of polygons, and with light that facets send each other.
const EXTENDED_SINCE: u32 = 3;

/// Writes a facet table. `scene` says which scene it belongs to; it comes back from [`read_table`].
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write_table(path: &Path, table: &FacetTable, scene: &str) -> Result<()> {
    let mut columns: Vec<Column> = table.sources.iter().flat_map(of_source).collect();
    let temperatures = [
        ("temperature_lit_k", "temperature of each facet's lit part", &table.temperature_lit_k),
        ("temperature_shaded_k", "temperature of each facet's shaded part", &table.temperature_shaded_k),
    ];
    for (name, meaning, values) in temperatures {
        if !values.is_empty() {
            columns.push(Column::new(name, "K", meaning, Values::F64(values)));
        }
    }
    let sources: Vec<String> = table.sources.iter().map(|lighting| lighting.source.clone()).collect();
    let named = |i: usize| format!("reflected_{i}");
    let mut reflected = Vec::new();
    for (i, Reflected { um, light, sources, reflectance, parts, irradiance }) in table.reflected.iter().enumerate() {
        let meaning = format!(
            "irradiance at {um} um on each facet by light of the others, before it is reflected; its spectrum: in the header"
        );
        columns.push(Column::new(named(i), "W m-2 um-1", meaning, Values::F64(irradiance)));
        reflected.push(ReflectedBy {
            array: named(i),
            um: *um,
            light: *light,
            sources: sources.clone(),
            reflectance: reflectance.clone(),
            parts: parts.clone(),
        });
    }
    let has_shares = table.sources.iter().filter_map(Lighting::seen).any(|seen| !seen.polygon_share.is_empty());
    // A program that knows neither can read what has none.
    let version = if has_shares || !reflected.is_empty() { EXTENDED_SINCE } else { EXTENDED_SINCE - 1 };
    let (models, sampling) = (Some(table.models), table.sampling);
    write(path, (TABLE, version), scene, About { sources: &sources, models, sampling, reflected, seen: None }, &columns)
}

fn of_source(lighting: &Lighting) -> Vec<Column<'_>> {
    let Lighting { source, field, irradiance, sees } = lighting;
    let (what, of_irradiance) = match source.as_str() {
        Sky::SUN => ("the Sun", "over that normal to the beam: cos i, or 0".to_owned()),
        Sky::MARS => ("Mars", "over Mars' reflectance times the solar irradiance normal to the beam".to_owned()),
        body if matches!(field, DirectionField::Near(_)) && !body.ends_with("-heat") => {
            (body, format!("over the reflectance of {body} times the solar irradiance there, normal to the beam"))
        }
        other => (other, "over that normal to the beam: cos i, or 0".to_owned()),
    };
    let mut columns = Vec::new();
    let mut put = |name: &str, unit, meaning: String, values| {
        columns.push(Column::new(format!("{source}_{name}"), unit, meaning, values));
    };
    if let Some(direction) = field.direction() {
        let meaning = format!("unit vector from the scene's origin to {what}, body-fixed axes");
        put("direction", "1", meaning, Values::Vector(direction.vec().to_array()));
    }
    if let DirectionField::Near(centre_m) = field {
        let meaning = format!("centre of {what}, from the scene's origin, body-fixed axes");
        put("position_m", "m", meaning, Values::Vector(centre_m.to_array()));
    }
    let where_lit = if matches!(sees, Sees::All) { "" } else { "'s lit part" };
    let meaning = format!("irradiance by {what} on each facet{where_lit} {of_irradiance}");
    put("irradiance", "1", meaning, Values::F64(irradiance));
    match sees {
        Sees::All => {}
        Sees::Shares(shares) => {
            put("share", "1", format!("share of each facet that {what} sees"), Values::F64(shares));
        }
        Sees::Polygons(seen) => {
            let meaning = "each facet: 0 dark, 1 lit all over, 2 lit in the polygons below";
            put("lit", "1", meaning.into(), Values::Shown(&seen.shown));
            let meaning = "facet of each lit polygon, ascending";
            put("polygon_facet", "1", meaning.into(), Values::U32(&seen.polygon_facet));
            let meaning = "first vertex of each lit polygon, and the number of vertices as the last element";
            put("polygon_start", "1", meaning.into(), Values::Ends(&seen.polygon_start));
            let meaning = "vertices (u, v) of the lit polygons: the point a + u (b - a) + v (c - a) of the facet";
            put("polygon_uv", "1", meaning.into(), Values::Uv(&seen.uv));
            if !seen.polygon_share.is_empty() {
                let meaning = "share of the source's light on the facet that each lit polygon has; polygons overlap, and shares add up";
                put("polygon_share", "1", meaning.into(), Values::F64(&seen.polygon_share));
            }
        }
    }
    columns
}

/// Reads a facet table: the one written, bit for bit, and its header.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] naming the array that is damaged; [`Error::Unsupported`] for a newer format or a
/// compressed file; [`Error::Invalid`] with everything that is missing, of the wrong size, or out of range.
pub fn read_table(path: &Path) -> Result<(FacetTable, Header)> {
    let mut file = Npz::open(path)?;
    let header = file.header(TABLE, TABLE_VERSIONS)?;
    let mut problems = Vec::new();
    let (sun, mars) = (Sky::SUN, Sky::MARS);
    let names: Vec<String> = match header.format_version {
        1 => {
            let has_mars = ["direction", "irradiance"].iter().any(|what| file.has(&format!("{mars}_{what}")));
            [sun].into_iter().chain(has_mars.then_some(mars)).map(str::to_owned).collect()
        }
        _ => header.sources.clone(),
    };
    if names.first().is_none_or(|name| name != sun) {
        problems.push(Problem::new(Location::file(path).with_item("header"), "the first source is not the Sun"));
    }
    if let Some(i) = (1..names.len()).find(|i| names[..*i].contains(&names[*i])) {
        let message = format!("names {:?} twice", names[i]);
        problems.push(Problem::new(Location::file(path).with_item("header"), message));
        return Err(Error::Invalid(problems));
    }
    let mut sources = Vec::new();
    for name in names {
        sources.extend(read_source(&mut file, &name, &mut problems)?);
    }
    let temperature_lit_k = file.f64s("temperature_lit_k", 1, false, &mut problems)?;
    let temperature_shaded_k = file.f64s("temperature_shaded_k", 1, false, &mut problems)?;
    let mut reflected = Vec::new();
    for ReflectedBy { array, um, light, sources: w_m2_um, reflectance, parts } in &header.reflected {
        let irradiance = file.f64s(array, 1, true, &mut problems)?;
        if let Some(part) = parts.iter().find(|part| part.source >= sources.len()) {
            problems.push(Problem::new(file.at(array), format!("is of source {} of {}", part.source, sources.len())));
        }
        reflected.push(Reflected {
            um: *um,
            light: *light,
            sources: w_m2_um.clone(),
            reflectance: reflectance.clone(),
            parts: parts.clone(),
            irradiance,
        });
    }
    // What may be there or not is there if the header says so.
    let is_told = |name: &str, problems: &[Problem]| problems.iter().any(|p| p.at.item.as_deref() == Some(name));
    for name in header.fields.keys().filter(|name| !file.has(name)) {
        if !is_told(name, &problems) {
            problems.push(Problem::new(file.at(name), "is missing"));
        }
    }
    let models = header.models.unwrap_or_default();
    let sampling = header.sampling;
    let table = FacetTable { sources, temperature_lit_k, temperature_shaded_k, reflected, sampling, models };
    // If the Sun's cannot be used, that has been reported, and all others would be of another length.
    let is_comparable = table.facets() > 0 || problems.is_empty();
    let at = |item: String| Location::file(path).with_item(item);
    check(&table, is_comparable, |item, message| problems.push(Problem::new(at(item), message)));
    if problems.is_empty() { Ok((table, header)) } else { Err(Error::Invalid(problems)) }
}

/// One source's arrays; `None` if its direction is missing, which has been reported.
fn read_source(file: &mut Npz, source: &str, problems: &mut Vec<Problem>) -> Result<Option<Lighting>> {
    let named = |what: &str| format!("{source}_{what}");
    let irradiance = file.f64s(&named("irradiance"), 1, true, problems)?;
    let sees = if file.has(&named("share")) {
        Sees::Shares(file.f64s(&named("share"), 1, true, problems)?)
    } else if file.has(&named("lit")) || source == Sky::SUN {
        let codes = file.bytes(&named("lit"), problems)?;
        if let Some(i) = codes.iter().position(|code| *code > 2) {
            let at = file.at(&format!("{}[{i}]", named("lit")));
            problems.push(Problem::new(at, format!("{} is not one of 0, 1, 2", codes[i])));
        }
        let shown = |code: &u8| [Shown::Nothing, Shown::Whole, Shown::Part][usize::from(*code).min(2)];
        let uv = file.f64s(&named("polygon_uv"), 2, true, problems)?;
        Sees::Polygons(Seen {
            shown: codes.iter().map(shown).collect(),
            polygon_facet: file.u32s(&named("polygon_facet"), problems)?,
            polygon_start: file.ends(&named("polygon_start"), problems)?,
            uv: uv.chunks_exact(2).map(|p| [p[0], p[1]]).collect(),
            polygon_share: file.f64s(&named("polygon_share"), 1, false, problems)?,
        })
    } else {
        Sees::All
    };
    let direction = file.direction(&named("direction"), !file.has(&named("position_m")), problems)?;
    let position_m = file.f64s(&named("position_m"), 1, false, problems)?;
    let field = match <[f64; 3]>::try_from(position_m) {
        Ok(position_m) if position_m.iter().all(|x| x.is_finite()) => {
            Some(DirectionField::Near(DVec3::from_array(position_m)))
        }
        Err(none) if none.is_empty() => direction.map(DirectionField::Afar),
        _ => {
            let message = "is not three finite components";
            problems.push(Problem::new(file.at(&named("position_m")), message));
            None
        }
    };
    Ok(field.map(|field| Lighting { source: source.to_owned(), field, irradiance, sees }))
}

/// What is refused as out of range is so by more than numbers of far or thin facets are by rounding: finer bounds are those of the product.
const ROUNDING: f64 = 1e-3;

/// Lists what does not fit together in a table or is out of range: (item, message). Lengths are compared only on request.
fn check(table: &FacetTable, is_comparable: bool, mut problem: impl FnMut(String, String)) {
    let facets = table.facets();
    let mut columns: Vec<(String, &[f64])> = Vec::new();
    for lighting in &table.sources {
        let Lighting { source, field: _, irradiance, sees } = lighting;
        columns.push((format!("{source}_irradiance"), irradiance));
        match sees {
            Sees::All => {}
            Sees::Shares(shares) => columns.push((format!("{source}_share"), shares)),
            Sees::Polygons(seen) if is_comparable && seen.shown.len() != facets => {
                let message = format!("has {} values, but sun_irradiance has {facets}", seen.shown.len());
                problem(format!("{source}_lit"), message);
            }
            Sees::Polygons(_) => {}
        }
    }
    let heat = [("temperature_lit_k", &table.temperature_lit_k), ("temperature_shaded_k", &table.temperature_shaded_k)];
    for (name, values) in &columns {
        if is_comparable && values.len() != facets {
            problem(name.clone(), format!("has {} values, but sun_irradiance has {facets}", values.len()));
        }
    }
    for (name, values) in heat {
        if is_comparable && values.len() != facets && !values.is_empty() {
            problem(name.into(), format!("has {} values, but sun_irradiance has {facets}", values.len()));
        }
    }
    for (i, reflected) in table.reflected.iter().enumerate() {
        let (name, values) = (format!("reflected_{i}"), &reflected.irradiance);
        if is_comparable && values.len() != facets {
            problem(name.clone(), format!("has {} values, but sun_irradiance has {facets}", values.len()));
        }
        if let Some(i) = values.iter().position(|v| !(*v >= 0.0 && v.is_finite())) {
            problem(format!("{name}[{i}]"), format!("{} is not a number of at least 0", number(values[i])));
        }
    }
    if table.temperature_lit_k.len() != table.temperature_shaded_k.len() {
        problem("temperature_lit_k".into(), "lit and shaded parts need a temperature, or neither".into());
    }
    let all = columns.iter().map(|(name, values)| (name.as_str(), *values));
    for (name, values) in all.chain(heat.map(|(name, values)| (name, values.as_slice()))) {
        if let Some(i) = values.iter().position(|v| !(*v >= 0.0 && v.is_finite())) {
            problem(format!("{name}[{i}]"), format!("{} is not a number of at least 0", number(values[i])));
        }
    }
    for (name, values) in &columns {
        if let Some(i) = values.iter().position(|v| *v > 1.0 + ROUNDING) {
            let what = match name.as_str() {
                "mars_irradiance" => "a share of what Mars could send",
                name if name.ends_with("_share") => "a share of a facet",
                _ => "the cosine of an angle",
            };
            problem(format!("{name}[{i}]"), format!("{} is above 1: it is {what}", number(values[i])));
        }
    }
    for lighting in &table.sources {
        if let Some(seen) = lighting.seen() {
            check_polygons(&lighting.source, seen, &mut problem);
        }
    }
}

fn check_polygons(source: &str, seen: &Seen, problem: &mut impl FnMut(String, String)) {
    let is_inside = |[u, v]: &[f64; 2]| [*u, *v, 1.0 - u - v].iter().all(|x| *x >= -ROUNDING && x.is_finite());
    if let Some(i) = seen.uv.iter().position(|uv| !is_inside(uv)) {
        let [u, v] = seen.uv[i];
        let message = format!("{} {} is not a point of the facet", number(u), number(v));
        problem(format!("{source}_polygon_uv[{i}]"), message);
    }
    if let Some(i) = seen.polygon_share.iter().position(|share| !(0.0..=1.0 + ROUNDING).contains(share)) {
        let message = format!("{} is not a share: 0 to 1", number(seen.polygon_share[i]));
        problem(format!("{source}_polygon_share[{i}]"), message);
    }
    if let Err(message) = seen.validate() {
        problem(format!("{source}_polygon_start"), message);
    } else if let Some(i) = seen.polygon_start.windows(2).position(|w| w[1] - w[0] < 3) {
        problem(format!("{source}_polygon_start[{i}]"), "a polygon needs three vertices".into());
    } else if let Some((facet, share)) = seen.overfull(1.0 + ROUNDING) {
        let message = format!("the lit polygons of facet {facet} are {} of it", number(share));
        problem(format!("{source}_polygon_uv"), message);
    }
}
