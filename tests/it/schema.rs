//! The JSON Schemas in `schemas/` are those of the types that read and write the files.

use std::path::Path;

use mmxrt::formats::{
    campaign_toml, flight_table, instrument_toml, knowledge_toml, manifest_json, radiance_map, recipe_toml,
    report_json, scene_toml,
};

#[test]
fn schemas_are_those_of_the_types() {
    let generated = [
        ("instrument.schema.json", instrument_toml::schema()),
        ("campaign.schema.json", campaign_toml::schema()),
        ("flight.schema.json", flight_table::schema()),
        ("manifest.schema.json", manifest_json::schema()),
        ("knowledge.schema.json", knowledge_toml::schema()),
        ("map.schema.json", radiance_map::schema()),
        ("dart_map.schema.json", radiance_map::dart_schema()),
        ("report.schema.json", report_json::report_schema()),
        ("run.schema.json", report_json::run_schema()),
        ("scene.schema.json", scene_toml::schema()),
        ("recipe.schema.json", recipe_toml::schema()),
    ];
    for (name, schema) in generated {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas").join(name);
        let text = format!("{}\n", serde_json::to_string_pretty(&schema).unwrap());
        if std::env::var_os("MMXRT_WRITE_SCHEMAS").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        assert!(
            std::fs::read_to_string(&path).is_ok_and(|stored| stored == text),
            "schemas/{name} is out of date: MMXRT_WRITE_SCHEMAS=1 cargo test --profile quick schemas"
        );
    }
}
