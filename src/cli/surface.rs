//! What `mmxrt inspect` reports about a surface: a scene's material, or a preset.

use std::path::Path;

use mmxrt::Result;
use mmxrt::job::SurfaceFacts;
use mmxrt::study::{FactorEntry, NumberEntry, SurfaceEntry};
use serde_json::json;

use super::Outcome;
use super::console::Console;
use super::dry_run::short;

/// Where its phase curve goes.
pub(super) struct Written<'a> {
    pub(super) csv: Option<&'a Path>,
    pub(super) svg: Option<&'a Path>,
    pub(super) replace: bool,
}

/// How a surface reflects: printed, and on request its phase curve written and drawn.
pub(super) fn run(facts: &SurfaceFacts, written: Written<'_>, console: &Console) -> Result<Outcome> {
    for target in written.csv.iter().chain(&written.svg) {
        super::settle(target, console)?;
    }
    facts.sheet.write(written.csv, written.svg, written.replace)?;
    let text: String = facts.entries.iter().map(surface_text).collect();
    let json = json!({ "kind": "surface", "surfaces": facts.entries });
    match written.csv.is_some() || written.svg.is_some() {
        true => console.done(&text, &json),
        false => console.result(&text, &json)?,
    }
    Ok(Outcome::Done)
}

fn surface_text(entry: &SurfaceEntry) -> String {
    let mut text = format!("{}: {} at {} um\n", entry.name, entry.model, short(entry.wavelength_um));
    text.push_str("  reflectance factor, by incidence, emission and phase, deg:\n");
    for factor in &entry.reflectance_factors {
        let FactorEntry { incidence_deg, emission_deg, phase_deg, value } = factor;
        text.push_str(&format!("    {incidence_deg:>2} {emission_deg:>2} {phase_deg:>5.1}  {value:.6}\n"));
    }
    for (name, value) in [
        ("geometric", entry.geometric_albedo),
        ("hemispherical", entry.hemispherical_albedo),
        ("Bond", entry.bond_albedo),
    ] {
        text.push_str(&format!("  {name} albedo: {value:.6}\n"));
    }
    let Some(preset) = &entry.preset else { return text };
    text.push_str(&format!("  preset {}:\n", preset.name));
    for number in &preset.numbers {
        let NumberEntry { key, value, origin, source, sigma, worth } = number;
        let sigma = if *sigma > 0.0 { format!(" +- {sigma}") } else { String::new() };
        let worth = if *worth > 0.0 { format!(", worth {:.1} %", 100.0 * worth) } else { String::new() };
        text.push_str(&format!("    {key} {value}{sigma}: {origin}{worth}; {source}\n"));
    }
    text.push_str(&format!("    assumed: {}\n", preset.assumed));
    let percent = 100.0 * preset.uncertainty;
    text.push_str(&format!(
        "    together worth {percent:.1} % of the radiance at {}, with the same normal reflectance\n",
        preset.at
    ));
    text
}
