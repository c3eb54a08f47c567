//! A folder with an image as a map: `ortho.img` (what is seen of each cell, and its value in each band), `lookup.npz`, `ortho.json`.

use std::borrow::Cow;
use std::path::Path;

use serde_json::json;

use super::envi::{self, MapPlace, Precision};
use super::folder::FolderKind;
use super::npz;
use crate::error::{Error, Result};
use crate::product::{CellPart, MapGrid, Plane, Projection};

/// Such a folder.
pub const FOLDER: FolderKind =
    FolderKind { marks: &["ortho.json"], parts: &["ortho.json", "ortho.img", "ortho.hdr", "lookup.npz"], holds: None };

/// A band of the map: its values, and its centre and full width at half maximum, um, where it has a wavelength.
pub type MappedBand = (Plane, Option<[Option<f64>; 2]>);

/// Where a map lies on a body of this radius: pixel coordinates are 1 at the outer corner of the first cell.
fn place(grid: &MapGrid, radius_m: f64) -> MapPlace {
    let ([west, north], cell) = (grid.west_north, grid.cell);
    let (name, units) = match grid.projection {
        Projection::Tangent { .. } => ("Arbitrary", "Meters"),
        Projection::PlateCarree { .. } => ("Geographic Lat/Lon", "Degrees"),
    };
    // Without it, readers take the Earth for the body.
    let coordinate_system = match grid.projection {
        Projection::Tangent { .. } => r#"LOCAL_CS["plane that touches the body",UNIT["Meter",1.0]]"#.to_owned(),
        Projection::PlateCarree { .. } => format!(
            r#"GEOGCS["planetocentric",DATUM["D_body",SPHEROID["sphere",{radius_m:.3},0.0]],PRIMEM["Reference_Meridian",0.0],UNIT["Degree",{:?}]]"#,
            1f64.to_radians()
        ),
    };
    MapPlace { map_info: format!("{name}, 1, 1, {west}, {north}, {cell}, {cell}, units={units}"), coordinate_system }
}

/// Fills the folder; `bands` are the values of cells by name, NaN where nothing is seen. `radius_m` is the body's, as far as a sphere stands for it.
///
/// # Errors
/// [`Error::Io`].
pub fn write(
    folder: &Path,
    (grid, radius_m): (&MapGrid, f64),
    parts: &[CellPart],
    bands: Vec<MappedBand>,
    scene: &str,
) -> Result<()> {
    let coverage = Plane { name: "COVERAGE".into(), unit: "1".into(), values: grid.coverage(parts) };
    let mut planes = vec![(coverage, None)];
    planes.extend(bands);
    let description = "Means of the pixels that see each cell, by area; NaN where none does";
    let all = planes.iter().map(|(plane, spectral)| (Cow::Borrowed(plane), *spectral));
    let size = [grid.columns, grid.rows];
    envi::write_map(&folder.join("ortho.img"), size, all, Precision::F64, (description, &place(grid, radius_m)))?;
    npz::write_lookup(&folder.join("lookup.npz"), grid, parts, scene)?;
    let projection = match grid.projection {
        Projection::Tangent { origin_m, axes } => json!({
            "name": "tangent", "origin_m": origin_m.to_array(),
            "east": axes.x_axis.to_array(), "north": axes.y_axis.to_array(), "up": axes.z_axis.to_array(),
        }),
        Projection::PlateCarree { middle_deg } => json!({ "name": "plate-carree", "middle_deg": middle_deg }),
    };
    let about = json!({
        "mmxrt": env!("CARGO_PKG_VERSION"), "scene": scene, "projection": projection, "west": grid.west_north[0], "north": grid.west_north[1],
        "cell": grid.cell, "columns": grid.columns, "rows": grid.rows, "planes": planes.iter().map(|(plane, _)| &plane.name).collect::<Vec<_>>(),
    });
    let path = folder.join("ortho.json");
    std::fs::write(&path, format!("{about:#}\n")).map_err(|e| Error::io(&path, "writing", e))
}
