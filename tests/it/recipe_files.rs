//! What recipes name files for: heights in other units, bands of several quantities, bodies with split vertices; and textures within a scene.

use crate::cli::run;
use crate::scratch::Scratch;

/// Heights of a landscape's vertices, m.
fn heights(scratch: &Scratch, recipe: &str) -> (Vec<f64>, String) {
    scratch.write("recipe.toml", recipe);
    let (code, out, err) =
        run(&["landscape", &scratch.argument("recipe.toml"), "-o", &scratch.argument("out.obj"), "--force"]);
    assert_eq!(code, 0, "{out}{err}");
    let obj = std::fs::read_to_string(scratch.join("out.obj")).unwrap();
    let z = |line: &str| line.strip_prefix("v ").map(|v| v.rsplit(' ').next().unwrap().parse().unwrap());
    (obj.lines().filter_map(z).collect(), err)
}

fn spread(heights: &[f64]) -> f64 {
    let (low, high) = heights.iter().fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(*z), high.max(*z)));
    high - low
}

const ELEVATION: &str = "version = 2\nseed = 1\nsize_m = 160.0\nfacets = 1568\nrelief = [{ kind = \"elevation\", file = \"heights.hdr\", pixel_m = 10.0, amplify = 1.0 }]\n";

/// An ENVI image of 16 x 16 pixels, f32: each band of one number a column.
fn envi(scratch: &Scratch, bands: &[&dyn Fn(usize) -> f32], more: &str) {
    let header = format!(
        "ENVI\nsamples = 16\nlines = 16\nbands = {}\ninterleave = bsq\ndata type = 4\nbyte order = 0\nheader offset = 0\n{more}\n",
        bands.len()
    );
    scratch.write("heights.hdr", header);
    let mut bytes = Vec::new();
    for band in bands {
        for i in 0..256 {
            bytes.extend(band(i % 16).to_le_bytes());
        }
    }
    std::fs::write(scratch.join("heights.img"), bytes).unwrap();
}

#[test]
fn heights_in_other_units_become_metres() {
    let scratch = Scratch::new();
    // A step of 0.02 in the middle.
    let step = |column: usize| if column < 8 { 0.0 } else { 0.02f32 };
    let mut of = vec![];
    for (unit, factor) in [("", 1.0), ("m", 1.0), ("km", 1000.0), ("Feet", 0.3048), ("Kilometers", 1000.0)] {
        let more = if unit.is_empty() { String::new() } else { format!("data units = {unit}") };
        envi(&scratch, &[&step], &more);
        let (z, err) = heights(&scratch, ELEVATION);
        of.push((spread(&z) / factor, err.contains("made m"), factor != 1.0));
    }
    assert!(of.iter().all(|(spread, told, due)| (spread / of[0].0 - 1.0).abs() < 2e-3 && told == due), "{of:?}");
    // Convolution overshoots a step by 2 x 7 %.
    assert!((0.02..0.025).contains(&of[0].0), "{of:?}");
    envi(&scratch, &[&step], "data units = furlongs");
    let (z, err) = heights(&scratch, ELEVATION);
    assert!(
        (spread(&z) / of[0].0 - 1.0).abs() < 2e-3 && err.contains("furlongs") && err.contains("taken as m"),
        "{err}"
    );
}

#[test]
fn bands_that_are_no_picture_are_not_averaged() {
    let scratch = Scratch::new();
    let step = |column: usize| if column < 8 { 0.0 } else { 3.0f32 };
    let other = |column: usize| 1000.0 * (column % 3) as f32;
    envi(&scratch, &[&step, &other, &|_| 90.0], "");
    let (z, err) = heights(&scratch, ELEVATION);
    assert!((3.0..3.6).contains(&spread(&z)), "{}", spread(&z));
    assert!(err.contains("the first of its 3 bands"), "{err}");
}

/// A sphere of 10 km as triangles of longitudes and latitudes; each facet with vertices of its own, or all with common ones.
fn sphere(is_split: bool) -> String {
    let at = |i: usize, j: usize| {
        let (lon, lat) = (i as f64 * 10f64.to_radians(), (j as f64 * 10.0 - 90.0).to_radians());
        if j == 0 || j == 18 {
            return [0.0, 0.0, if j == 0 { -1e4 } else { 1e4 }];
        }
        [1e4 * lat.cos() * lon.cos(), 1e4 * lat.cos() * lon.sin(), 1e4 * lat.sin()]
    };
    let mut triangles = vec![];
    for i in 0..36 {
        for j in 0..18 {
            let [a, b, c, d] = [(i, j), ((i + 1) % 36, j), ((i + 1) % 36, j + 1), (i, j + 1)];
            if j > 0 {
                triangles.push([a, b, c]);
            }
            if j < 17 {
                triangles.push([a, c, d]);
            }
        }
    }
    let mut vertices: Vec<(usize, usize)> = vec![];
    let (mut v, mut f) = (String::new(), String::new());
    for triangle in triangles {
        let mut numbers = vec![];
        for (i, j) in triangle {
            let key = (if j == 0 || j == 18 { 0 } else { i }, j);
            let known = vertices.iter().position(|k| *k == key).filter(|_| !is_split);
            numbers.push(known.unwrap_or_else(|| {
                let [x, y, z] = at(i, j);
                v += &format!("v {x:.6} {y:.6} {z:.6}\n");
                vertices.push(key);
                vertices.len() - 1
            }));
        }
        f += &format!("f {} {} {}\n", numbers[0] + 1, numbers[1] + 1, numbers[2] + 1);
    }
    v + &f
}

#[test]
fn split_vertices_of_a_body_leave_no_creases() {
    let recipe = "version = 2\nseed = 1\nsize_m = 3000.0\nfacets = 5000\n[body]\nfiles = [\"body.obj\"]\nlonlat_deg = [32.0, 13.0]\n";
    let scratch = Scratch::new();
    let made = [false, true].map(|is_split| {
        scratch.write("body.obj", sphere(is_split));
        heights(&scratch, recipe);
        std::fs::read(scratch.join("out.obj")).unwrap()
    });
    assert!(made[0] == made[1]);
    // A second file that is a whole body would hide the first.
    scratch.write("recipe.toml", recipe.replace("[\"body.obj\"]", "[\"body.obj\", \"body.obj\"]"));
    let (code, _, err) = run(&["landscape", &scratch.argument("recipe.toml"), "-o", &scratch.argument("no.obj")]);
    assert!(code == 1 && err.contains("body.files[1]") && err.contains("those before it would not count"), "{err}");
    // A direction that says nothing of azimuths, and a target in km.
    for (from, to, words) in [
        (
            "lonlat_deg = [32.0, 13.0]",
            "lonlat_deg = [30.0, 0.0]\nalong = [0.8660254037844387, 0.5, 0.0]",
            "straight up",
        ),
        ("lonlat_deg = [32.0, 13.0]", "target_m = [8.0, 5.0, 3.0]", "is it in km?"),
        ("lonlat_deg = [32.0, 13.0]", "target_m = [90000.0, 0.0, 0.0]", "it misses the body"),
    ] {
        scratch.write("recipe.toml", recipe.replace(from, to));
        let (code, _, err) = run(&["landscape", &scratch.argument("recipe.toml"), "-o", &scratch.argument("no.obj")]);
        assert!(code == 1 && err.contains(words), "{err}");
    }
    // Of any length a direction is one.
    for along in ["[1e308, 1e308, 1e308]", "[1e-300, 1e-300, 1e-300]"] {
        heights(&scratch, &format!("{recipe}along = {along}\n"));
        let other = std::fs::read(scratch.join("out.obj")).unwrap();
        heights(&scratch, &format!("{recipe}along = [1.0, 1.0, 1.0]\n"));
        assert!(std::fs::read(scratch.join("out.obj")).unwrap() == other);
    }
}

#[test]
fn ground_that_folds_is_told_and_flat_mounds_are_flat() {
    let scratch = Scratch::new();
    // At the tip of this ellipsoid the radius of curvature is 300^2 / 1000 = 90 m along a meridian: normals of a hollow 150 m deep cross.
    let tip = |height_m: f64| {
        format!(
            "version = 2\nseed = 1\nsize_m = 250.0\nfacets = 2000\nrelief = [{{ kind = \"mound\", height_m = {height_m:.1}, flank_deg = 60.0, top_m = 60.0 }}]\n[body]\nellipsoid_m = [1000.0, 1000.0, 300.0]\nlonlat_deg = [0.0, 0.0]\n"
        )
    };
    let told = |height_m: f64| heights(&scratch, &tip(height_m)).1.contains("facets face the body");
    assert_eq!([-150.0, -40.0, 150.0].map(told), [true, false, false]);
    let (z, _) = heights(
        &scratch,
        "version = 2\nseed = 1\nsize_m = 100.0\nfacets = 1000\nrelief = [{ kind = \"mound\", height_m = 0.0, flank_deg = 30.0, top_m = 10.0 }]\n",
    );
    assert!(z.iter().all(|z| *z == 0.0));
}

#[test]
fn numbers_below_none_and_above_all_are_refused_where_they_stand() {
    let scratch = Scratch::new();
    let group = "[[craters]]\ncount = 600000\nmin_diameter_m = 1.0\nmax_diameter_m = 1.0\n";
    for (text, key) in [
        ("[[craters]]\nper_km2 = -1.9\n".to_owned(), "craters[0].per_km2"),
        ("[[craters]]\nsaturation = -1.0\n".to_owned(), "craters[0].saturation"),
        ("[[boulders]]\nper_km2 = -1e-9\n".to_owned(), "boulders[0].per_km2"),
        (group.repeat(2), "in all groups together"),
        ("[[boulders]]\ncount = 60000\n".repeat(2), "in all groups together"),
    ] {
        scratch.write("recipe.toml", format!("version = 2\nseed = 1\nsize_m = 500.0\nfacets = 1000\n{text}"));
        let (code, _, err) = run(&["landscape", &scratch.argument("recipe.toml"), "-o", &scratch.argument("out.obj")]);
        assert!(code == 1 && err.contains(key), "{text}: {err}");
    }
}

#[test]
fn a_recipes_texture_is_on_its_landscape_within_a_scene() {
    // Flat ground straight below the camera and the Sun: a pixel is the mean of its 4 x 4 texels.
    let scene = |around: &str, material: &str| {
        format!(
            "mmxrt_scene = 1\norigin_m = [0, 0, 11000]\n[[mesh]]\nrecipe = {{ version = 2, seed = 3, size_m = 128.0, facets = 1000, {around}texture = {{ texels = 64, rms = 0.2 }} }}\npose = {{ world_from_mesh_xyzw = [0, 0, 0, 1] }}\n[materials]\nphobos_blue = {{ reflectance = 0.1{material} }}\n[sun]\ndirection = [0, 0, 1]\ndistance_au = 1.5\n[thermal]\nmodel = \"off\"\n[observer]\nposition_m = [0, 0, 12000]\ntarget_m = [0, 0, 11000]\nup = [0, 1, 0]\n[sensor]\nsamples = 16\nlines = 16\nifov_mrad = 8.0\nbands = {{ centres_um = [1.0] }}\n"
        )
    };
    let scratch = Scratch::new();
    scratch.write(
        "recipe.toml",
        "version = 2\nseed = 3\nsize_m = 128.0\nfacets = 1000\ntexture = { texels = 64, rms = 0.2 }\n",
    );
    let (code, _, err) = run(&["landscape", &scratch.argument("recipe.toml"), "-o", &scratch.argument("site.obj")]);
    assert_eq!(code, 0, "{err}");
    let png = std::fs::File::open(scratch.join("site_texture.png")).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    let factor = |i: usize| f64::from(u16::from_be_bytes([bytes[2 * i], bytes[2 * i + 1]])) / 65535.0;
    let expected: Vec<f64> = (0..256)
        .map(|p| (0..16).map(|k| factor((p / 16 * 4 + k / 4) * 64 + p % 16 * 4 + k % 4)).sum::<f64>() / 16.0)
        .collect();
    let image = |scene: &str| -> (Vec<f64>, String) {
        scratch.write("scene.toml", scene);
        let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
        let (code, said, err) =
            run(&["simulate", &scene, "-o", &out, "--dtype", "f64", "--model", "sunlight", "--force"]);
        assert_eq!(code, 0, "{said}{err}");
        let bytes = std::fs::read(scratch.join("out/cube.img")).unwrap();
        (bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect(), err)
    };
    for around in ["", "surroundings = { reach_m = 200.0 }, "] {
        let (found, _) = image(&scene(around, ""));
        let ratio = found.iter().sum::<f64>() / expected.iter().sum::<f64>();
        let off = found.iter().zip(&expected).map(|(f, e)| (f / ratio / e - 1.0).abs()).fold(0.0, f64::max);
        // The PNG has 16 bits.
        assert!(off < 1e-4, "{around}: {off}");
    }
    let stated = ", texture = { raster = \"site_texture.png\", quantity = \"factor\", placement = \"atlas\" }";
    let (_, err) = image(&scene("surroundings = { reach_m = 200.0 }, ", stated));
    assert!(
        err.contains("has another texture") && err.contains("have no texture coordinates: the texture is not on them"),
        "{err}"
    );
}

#[test]
fn heights_larger_than_the_site_are_warned_of() {
    let scratch = Scratch::new();
    let rows =
        (0..16).map(|row| (0..16).map(|c| if (row, c) == (5, 5) { "-9998 " } else { "1 " }).collect::<String>() + "\n");
    let grid = format!(
        "ncols 16\nnrows 16\nxllcorner 0\nyllcorner 0\ncellsize 25\nNODATA_value -1\n{}",
        rows.collect::<String>()
    );
    scratch.write("tile.asc", &grid);
    let recipe =
        "version = 2\nseed = 1\nsize_m = 400.0\nfacets = 2000\n[[relief]]\nkind = \"elevation\"\nfile = \"tile.asc\"\n";
    scratch.write("recipe.toml", recipe);
    let made = |out: &str| {
        let (code, _, err) = run(&["landscape", &scratch.argument("recipe.toml"), "-o", &scratch.argument(out)]);
        assert_eq!(code, 0, "{err}");
        err
    };
    assert!(made("a.obj").contains("from its lowest to its highest point"));
    scratch.write("tile.asc", grid.replace("-9998", "9"));
    assert!(!made("b.obj").contains("from its lowest"));
}
