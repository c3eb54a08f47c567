//! The pages of the book that list the keys of our own files are made of the JSON Schemas, which are made of the types that read them.

use std::collections::BTreeSet;
use std::fmt::Write;

use serde_json::{Map, Value};

use super::markdown::anchor;
use super::root;

/// A page: its name, its title, which schema it is of, and what its file is for.
const PAGES: [(&str, &str, &str, &str); 11] = [
    (
        "scene",
        "Scene",
        "scene",
        "A scene says what there is and where: surface, materials, Sun, Mars, camera. `mmxrt inspect` checks one, `mmxrt simulate` makes its image. \
         [The first image](../tutorial/first-image.md) begins with one, and [Changing the scene](../tutorial/change.md) goes through its parts.",
    ),
    (
        "recipe",
        "Recipe of a landscape",
        "recipe",
        "A recipe makes a mesh: `mmxrt landscape`, or `recipe` under `[[mesh]]` of a scene. [Landscapes](../howto/landscapes.md) has examples.",
    ),
    (
        "campaign",
        "Campaign",
        "campaign",
        "A campaign lists acquisitions of a scene that moves, for `mmxrt campaign`. [Many acquisitions](../tutorial/campaign.md) has an example.",
    ),
    (
        "instrument",
        "Instrument",
        "instrument",
        "What `mmxrt instrument` reads a cube with. In a scene the same keys are under `[sensor]`. [An instrument](../tutorial/instrument.md) has an example.",
    ),
    (
        "knowledge",
        "Uncertainties",
        "knowledge",
        "How well position, attitude, clock and shape are known, for `mmxrt locate --knowledge`. [Flight files and geolocation](../howto/flight.md) has an example.",
    ),
    (
        "map",
        "Radiance map",
        "map",
        "What a raster of radiances is and where it lies, for `mmxrt integrate --radiance`. [Radiance from elsewhere](../howto/radiance-maps.md) has an example.",
    ),
    (
        "dart_map",
        "Radiance map of DART's output",
        "dart_map",
        "The same for what DART computed, where its inputs are not there. [Radiance from elsewhere](../howto/radiance-maps.md) says when that is.",
    ),
    (
        "flight_table",
        "Table of positions and attitudes",
        "flight",
        "Positions and attitudes over time as TOML. The same as CSV is described under \
         [Tables of positions and attitudes](../../CONVENTIONS.md#tables-of-positions-and-attitudes).",
    ),
    ("report", "report.json", "report", "What a product folder says of itself. The same inputs give the same report."),
    (
        "run",
        "run.json",
        "run",
        "When and on what machine a product was made, and how long it took: the only file that differs between two runs.",
    ),
    ("manifest", "manifest.json", "manifest", "What a campaign's folder holds."),
];

/// The unit that the end of a key's name states.
fn unit(key: &str) -> Option<&'static str> {
    const UNITS: [(&str, &str); 33] = [
        ("_w_m2_sr_um", "W m-2 sr-1 um-1"),
        ("_w_m2_um", "W m-2 um-1"),
        ("_w_m2", "W m-2"),
        ("_km_s", "km/s"),
        ("_m_s", "m/s"),
        ("per_km2", "km-2"),
        ("_cm_1", "cm-1"),
        ("_e_dn", "electrons per DN"),
        ("_e_s", "electrons/s"),
        ("_e", "electrons"),
        ("_dn", "DN"),
        ("_mrad", "mrad"),
        ("_arcsec", "arcsec"),
        ("_rad", "rad"),
        ("_deg", "deg"),
        ("_px", "pixels"),
        ("_texels", "texels"),
        ("_um", "um"),
        ("_nm", "nm"),
        ("_mm", "mm"),
        ("_km", "km"),
        ("_au", "au"),
        ("_m", "m"),
        ("_hz", "Hz"),
        ("_days", "days"),
        ("_s", "s"),
        ("_k", "K"),
        ("_gb", "GB"),
        ("_bytes", "bytes"),
        ("lines", "pixels"),
        ("samples", "pixels"),
        ("thermal_inertia", "J m-2 K-1 s-1/2"),
        ("inertia", "J m-2 K-1 s-1/2"),
    ];
    UNITS.iter().find(|(end, _)| key.ends_with(end)).map(|(_, unit)| *unit)
}

/// The heading of a type: the words of its name, with what it is of where a recipe has a type of that name, too.
fn heading(full_name: &str, defs: &Map<String, Value>) -> String {
    let name = full_name.strip_suffix("Toml").unwrap_or(full_name);
    let mut words = String::new();
    for (i, c) in name.chars().enumerate() {
        if i > 0 && c.is_uppercase() {
            words.push(' ');
            words.extend(c.to_lowercase());
        } else {
            words.push(c);
        }
    }
    if name != full_name && defs.contains_key(name) {
        words.push_str(" (scene)");
    }
    words
}

fn described(schema: &Value) -> String {
    let text = schema.get("description").and_then(Value::as_str).unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|").replace('<', "&lt;")
}

/// The types that a schema refers to, in the order in which a reader meets them.
fn named(schema: &Value, defs: &Map<String, Value>, met: &mut Vec<String>) {
    match schema {
        Value::Object(object) => {
            if let Some(name) = object.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix("#/$defs/"))
                && !met.iter().any(|m| m == name)
            {
                met.push(name.to_owned());
                named(&defs[name], defs, met);
            }
            object.iter().filter(|(key, _)| *key != "$defs").for_each(|(_, value)| named(value, defs, met));
        }
        Value::Array(items) => items.iter().for_each(|item| named(item, defs, met)),
        _ => {}
    }
}

/// What a value may be, in a few words.
fn kind(schema: &Value, defs: &Map<String, Value>) -> String {
    if let Some(name) = schema.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix("#/$defs/")) {
        let heading = heading(name, defs);
        return format!("[{}](#{})", heading.to_lowercase(), anchor(&heading));
    }
    if let Some(value) = schema.get("const") {
        return format!("`{value}`");
    }
    if let Some(values) = schema.get("enum").and_then(Value::as_array) {
        return values.iter().map(|v| format!("`{v}`")).collect::<Vec<_>>().join(", ");
    }
    if let Some(choices) = schema.get("anyOf").or_else(|| schema.get("oneOf")).and_then(Value::as_array) {
        let kinds: Vec<String> =
            choices.iter().filter(|c| c.get("type") != Some(&"null".into())).map(|c| kind(c, defs)).collect();
        return kinds.join(" or ");
    }
    let types: Vec<&str> = match schema.get("type") {
        Some(Value::String(one)) => vec![one],
        Some(Value::Array(several)) => several.iter().filter_map(Value::as_str).filter(|t| *t != "null").collect(),
        _ => return "any".to_owned(),
    };
    types.into_iter().map(|one| of_type(one, schema, defs)).collect::<Vec<_>>().join(" or ")
}

fn of_type(name: &str, schema: &Value, defs: &Map<String, Value>) -> String {
    let bound = |key: &str| schema.get(key).map(Value::to_string);
    match name {
        "array" => {
            let items = schema.get("items").map_or_else(|| "any".to_owned(), |items| kind(items, defs));
            match (bound("minItems"), bound("maxItems")) {
                (Some(least), Some(most)) if least == most => format!("{least} x {items}"),
                _ => format!("list of {items}"),
            }
        }
        "object" => schema
            .get("additionalProperties")
            .filter(|more| more.is_object())
            .map_or_else(|| "table".to_owned(), |more| format!("table, by name, of {}", kind(more, defs))),
        "string" => "text".to_owned(),
        "boolean" => "true or false".to_owned(),
        other => {
            let what = if other == "integer" { "whole number" } else { "number" };
            if let (Some(from), Some(to)) = (bound("minimum"), bound("maximum"))
                && from == to
            {
                return from;
            }
            let from = bound("minimum")
                .map(|b| format!("from {b}"))
                .or_else(|| bound("exclusiveMinimum").map(|b| format!("above {b}")));
            let to = bound("maximum")
                .map(|b| format!("to {b}"))
                .or_else(|| bound("exclusiveMaximum").map(|b| format!("below {b}")));
            [Some(what.to_owned()), from, to].into_iter().flatten().collect::<Vec<_>>().join(" ")
        }
    }
}

/// A table of the keys of an object.
fn keys(schema: &Value, defs: &Map<String, Value>, out: &mut String) {
    let Some(properties) = schema.get("properties").and_then(Value::as_object).filter(|p| !p.is_empty()) else {
        return;
    };
    let required: BTreeSet<&str> =
        schema.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str).collect();
    out.push_str("| key | value | unit | meaning |\n|---|---|---|---|\n");
    for (key, value) in properties {
        let mut meaning = described(value);
        if let Some(default) = value.get("default").filter(|d| !d.is_null() && !meaning.contains("efault")) {
            write!(meaning, "{}Default `{default}`.", if meaning.is_empty() { "" } else { " " }).unwrap();
        }
        let name = if required.contains(key.as_str()) { format!("**`{key}`**") } else { format!("`{key}`") };
        writeln!(out, "| {name} | {} | {} | {meaning} |", kind(value, defs), unit(key).unwrap_or_default()).unwrap();
    }
    out.push('\n');
}

/// All of a type: what it is, its keys or its choices.
fn body(schema: &Value, defs: &Map<String, Value>, out: &mut String) {
    let says = described(schema);
    if !says.is_empty() {
        writeln!(out, "{says}\n").unwrap();
    }
    keys(schema, defs, out);
    let Some(choices) = schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Value::as_array) else {
        if schema.get("properties").is_none() {
            writeln!(out, "{}.\n", kind(schema, defs)).unwrap();
        }
        return;
    };
    if choices.iter().all(|choice| choice.get("properties").is_none()) {
        out.push_str("| value | meaning |\n|---|---|\n");
        for choice in choices {
            writeln!(out, "| {} | {} |", kind(choice, defs), described(choice)).unwrap();
        }
        out.push('\n');
        return;
    }
    for choice in choices {
        let names = choice.get("properties").and_then(Value::as_object);
        // A choice is known by the one value that one of its keys has, or by its keys.
        let by_value = names.into_iter().flatten().find_map(|(k, v)| v.get("const").map(|c| format!("`{k} = {c}`")));
        writeln!(out, "{}: {}\n", by_value.unwrap_or_else(|| "Either".to_owned()), described(choice)).unwrap();
        if names.is_none() {
            writeln!(out, "{}.\n", kind(choice, defs)).unwrap();
        }
        keys(choice, defs, out);
    }
}

fn page(title: &str, schema_name: &str, what: &str, schema: &Value) -> String {
    let mut out = format!(
        "# {title}\n\n<!-- Made of schemas/{schema_name}.schema.json by tests/it/book/reference.rs: changes here would be lost. -->\n\n{what}\n\n\
         Keys in bold must be there. Editors check and complete these files by [the schema](../../schemas/{schema_name}.schema.json), of which this page is made.\n\n"
    );
    let none = Map::new();
    let defs = schema.get("$defs").and_then(Value::as_object).unwrap_or(&none);
    body(schema, defs, &mut out);
    let mut met = Vec::new();
    named(schema, defs, &mut met);
    for name in met {
        writeln!(out, "## {}\n", heading(&name, defs)).unwrap();
        body(&defs[&name], defs, &mut out);
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

/// Every key that a schema knows, of all its types.
fn all_keys(schema: &Value, keys: &mut BTreeSet<String>) {
    match schema {
        Value::Object(object) => {
            let named = object.get("properties").and_then(Value::as_object);
            keys.extend(named.into_iter().flat_map(Map::keys).cloned());
            object.values().for_each(|value| all_keys(value, keys));
        }
        Value::Array(items) => items.iter().for_each(|item| all_keys(item, keys)),
        _ => {}
    }
}

#[test]
fn reference_pages_are_those_of_the_schemas() {
    let mut old = Vec::new();
    for (name, title, schema_name, what) in PAGES {
        let text = std::fs::read_to_string(root().join(format!("schemas/{schema_name}.schema.json"))).unwrap();
        let schema: Value = serde_json::from_str(&text).unwrap();
        let made = page(title, schema_name, what, &schema);
        let path = root().join(format!("docs/reference/{name}.md"));
        if std::env::var_os("MMXRT_WRITE_BOOK").is_some() {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, &made).unwrap();
        }
        if std::fs::read_to_string(&path).ok().as_ref() != Some(&made) {
            old.push(name);
        }
        let mut all = BTreeSet::new();
        all_keys(&schema, &mut all);
        let missing: Vec<_> = all.iter().filter(|key| !made.contains(&format!("`{key}`"))).collect();
        assert!(missing.is_empty() && all.len() > 5, "{name}: {missing:?}");
    }
    assert!(
        old.is_empty(),
        "docs/reference/ is out of date in {old:?}: MMXRT_WRITE_BOOK=1 cargo test --profile quick book"
    );
    let schemas = std::fs::read_dir(root().join("schemas")).unwrap();
    let files = schemas.filter(|f| f.as_ref().unwrap().path().extension().is_some_and(|e| e == "json")).count();
    assert_eq!(files, PAGES.len(), "a schema has no page");
}
