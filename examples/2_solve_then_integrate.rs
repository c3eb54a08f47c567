//! Two steps: what reaches the facets, then what a camera sees: `cargo run --profile quick --example 2_solve_then_integrate`.
//!
//! `solve` is the part that depends on the Sun, `integrate` the part that depends on the camera. Between them lies the
//! facet table: as a value, or as a file that NumPy opens and that another solver may write.

#![allow(clippy::print_stdout)]

use std::path::Path;

use mmxrt::formats::{npz, scene_toml};
use mmxrt::integrate::Wanted;
use mmxrt::integrate::integrate;
use mmxrt::product::{Cube, CubeAxes};
use mmxrt::progress::unwatched;
use mmxrt::solve::solve;
use mmxrt::spectral::Band;
use mmxrt::study::table_id;
use mmxrt::{Error, Result};

fn main() -> Result<()> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/phobos_site/scene.toml");
    let file = scene_toml::read(&path, &unwatched)?;
    println!("{} facets; values the file leaves open:", file.scene.body.mesh.facets.len());
    file.defaults.iter().for_each(|d| println!("  {} = {}", d.item, d.value));

    let table = solve(&file.scene, &unwatched)?;
    let sunlit = table.sunlit().expect("what is solved has the Sun");
    let lit = (0..).take(table.facets()).map(|f| sunlit.fraction(f)).sum::<f64>();
    println!("the Sun sees {lit:.2} facets' worth of it");

    // The table keeps every bit on its way through a file.
    let table_path = std::env::temp_dir().join(format!("mmxrt_example_{}.npz", std::process::id()));
    npz::write_table(&table_path, &table, &table_id(&file.scene))?;
    let (read, header) = npz::read_table(&table_path)?;
    assert_eq!(read, table);
    println!("{}: {}", header.format, header.fields.keys().cloned().collect::<Vec<_>>().join(", "));
    std::fs::remove_file(&table_path).map_err(|e| Error::io(&table_path, "removing", e))?;

    // Two cameras look at the same body and solution: the one of the file, and one with a narrower view and other bands.
    let mut narrow = file.scene.exposure.clone();
    narrow.camera.pitch.iter_mut().for_each(|pitch| *pitch /= 4.0);
    narrow.bands = [2.0, 3.6].map(|centre_um| Band::new(centre_um, Some(0.02))).into();
    let narrow = file.scene.seen_by(narrow)?;
    for scene in [file.scene, narrow] {
        let image = integrate(&scene, &table, Wanted::default(), &unwatched)?;
        let last = scene.exposure.bands.len() - 1;
        let radiance = Cube::new(CubeAxes::of(&scene.exposure), vec![image.slab])?.band(last);
        println!(
            "{} bands, {:.3} mrad: mean at {:.2} um is {:.6} W m-2 sr-1 um-1",
            scene.exposure.bands.len(),
            1e3 * scene.exposure.camera.ifov_rad(),
            scene.exposure.bands[last].centre_um,
            radiance.iter().sum::<f64>() / radiance.len() as f64
        );
    }
    Ok(())
}
