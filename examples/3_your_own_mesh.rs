//! Your own OBJ: from a mesh and a scene file to the facets of a pixel: `cargo run --profile quick --example 3_your_own_mesh`.
//!
//! A lid of 2 x 2 m, x from -1.25 to 0.75 m, floats 1 m over a floor of 8 x 8 m. The Sun stands 45 deg high in the east
//! (+x), so that its shadow lies 1 m to the west: x from -2.25 m. Every number printed can be checked with a pencil.

#![allow(clippy::print_stdout)]

use std::fs::write;

use mmxrt::formats::scene_toml;
use mmxrt::integrate::footprints;
use mmxrt::progress::unwatched;
use mmxrt::visibility::Seen;
use mmxrt::{Error, Result};

// Faces are counter-clockwise seen from outside. Quads become two facets each, along the shorter diagonal.
const MESH: &str = "mtllib lid.mtl
v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0
v -1.25 -1 1\nv 0.75 -1 1\nv 0.75 1 1\nv -1.25 1 1
usemtl floor\nf 1 2 3 4
usemtl lid\nf 5 6 7 8
";
// `Kd` is only needed where a scene names materials by colour.
const MATERIALS: &str = "newmtl floor\nnewmtl lid\nKd 0.8 0.2 0.1\n";
// From so far away a pixel is 1 m wide to five digits, on the floor as on the lid.
const SCENE: &str = r##"
mmxrt_scene = 1
origin_m = [0.0, 0.0, 0.0]
mesh = [{ obj = "lid.obj" }]
[materials]
floor = { reflectance = 0.07 }
"#e77c59" = { reflectance = "lid.csv" } # Kd 0.8 0.2 0.1 in sRGB, as a colour picker shows it
[sun]
direction = [1.0, 0.0, 1.0]
distance_au = 1.5
[observer]
position_m = [0.0, 0.0, 1e6]
target_m = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
[sensor]
samples = 8
lines = 8
ifov_mrad = 1e-3
bands = { centres_um = [1.0, 2.0] }
"##;
const REFLECTANCE: &str = "wavelength_nm,reflectance_percent\n900,20\n3600,40\n";

fn main() -> Result<()> {
    let folder = std::env::temp_dir().join(format!("mmxrt_example_{}", std::process::id()));
    let io = |e| Error::io(&folder, "writing", e);
    std::fs::create_dir_all(&folder).map_err(io)?;
    for (name, text) in [("lid.obj", MESH), ("lid.mtl", MATERIALS), ("lid.csv", REFLECTANCE), ("scene.toml", SCENE)] {
        write(folder.join(name), text).map_err(io)?;
    }
    let scene = scene_toml::read(&folder.join("scene.toml"), &unwatched)?.scene;
    std::fs::remove_dir_all(&folder).map_err(io)?;

    // Which facets are neighbours, and which parts are closed: found once for a body.
    let (mesh, topology) = (&scene.body.mesh, scene.body.topology());
    let sunlit = Seen::from_afar(mesh, topology, scene.sky.sun.direction, "sunlight", &unwatched)?;
    let footprints = footprints(mesh, topology, &sunlit, &scene.exposure.camera);

    // Line 3 is the one north of the middle; its samples go from west to east, the first from x = -4 m.
    for sample in [0, 1, 2, 3, 4] {
        println!("line 3, sample {sample}, x from {} m:", sample as f64 - 4.0);
        for (facet, fraction, lit_fraction) in footprints.pixel(3 * 8 + sample) {
            let material = &scene.body.materials[scene.body.mesh.material[facet as usize].0 as usize].name;
            println!("  facet {facet} of {material}: {fraction:.5} of the pixel, {lit_fraction:.5} lit");
        }
    }
    Ok(())
}
