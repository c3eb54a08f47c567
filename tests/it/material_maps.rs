//! Images that say which material facets are of.

use crate::cli::run;
use crate::lon_lat::{OCTAHEDRON, assert_quarters, cube, prepared};
use crate::scratch::Scratch;

const FOUR: &str =
    "a = { reflectance = 0.1 }\nb = { reflectance = 0.2 }\nc = { reflectance = 0.3 }\nd = { reflectance = 0.4 }";

/// The octahedron with a map under `[[mesh]]`.
fn with_map(map: &str, materials: &str) -> Scratch {
    let mesh = format!("octahedron.obj\"\nmaterial_map = {map}\n#\"");
    prepared(&[
        ("octahedron.obj\"", &mesh),
        ("[materials.default]\nreflectance = 0.1", &format!("[materials]\n{materials}")),
    ])
}

/// The reflectances of the four quarters from longitude 0 on: all faces stand alike in the light.
fn assert_reflectances(scratch: &Scratch, expected: [f64; 4]) {
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let (code, said, err) = run(&["simulate", &scene, "-o", &out, "--dtype", "f64", "--model", "sunlight", "--force"]);
    assert_eq!(code, 0, "{said}{err}");
    let image = cube(scratch);
    let sum = image.iter().sum::<f64>();
    let whole: f64 = expected.iter().sum();
    let found: Vec<f64> = image.iter().map(|v| 0.5 * v / sum * whole).collect();
    assert_quarters(&found, expected, "material map");
}

#[test]
fn facets_are_of_what_the_map_has_at_their_middle() {
    let names = "materials = { 1 = \"a\", 2 = \"b\", 3 = \"c\", \"4.0\" = \"d\" }";
    let lon_lat = format!("{{ raster = \"map.csv\", placement = \"lonlat\", west_deg = -180, {names} }}");
    // No face is of the mesh's own material, which has no name and need not be known.
    let scratch = with_map(&lon_lat, FOUR);
    scratch.write("map.csv", "1,2,3,4\n");
    assert_reflectances(&scratch, [0.3, 0.4, 0.1, 0.2]);
    // The middle of a face is at 45 deg: the columns from 30 to 60, 120 to 150, ... of twelve.
    let scratch = with_map(&lon_lat.replace("-180", "0"), FOUR);
    scratch.write("map.csv", "9,1,9,9,2,9,9,4,9,9,3,9\n");
    assert_reflectances(&scratch, [0.1, 0.2, 0.4, 0.3]);
    // From above, the South's faces are not seen; where the map has nothing, the mesh's own is kept.
    let scratch = with_map(&lon_lat.replace("-180", "0"), &format!("{FOUR}\ndefault = {{ reflectance = 0.25 }}"));
    scratch.write("map.csv", "1,nan,3,4\n2,2,2,2\n");
    assert_reflectances(&scratch, [0.1, 0.25, 0.3, 0.4]);
    let (_, said, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("out"), "--force"]);
    assert!(err.contains("1 of 8 facets lie where the map has nothing"), "{said}{err}");

    // On a plane: x to the right, y up, columns of 4 m; the middles lie at 4/3 m.
    let plane = "{ corner_m = [-4, 4, 0], along_line_m = [4, 0, 0], line_to_line_m = [0, -4, 0], towards = [0, 0, 1] }";
    let scratch =
        with_map(&format!("{{ raster = \"map.csv\", placement = \"plane\", plane = {plane}, {names} }}"), FOUR);
    scratch.write("map.csv", "2,1\n3,4\n");
    assert_reflectances(&scratch, [0.1, 0.2, 0.3, 0.4]);

    // A picture's colours, by texture coordinates: the second row of texels is the lower half.
    let colours = "materials = { \"#ff0000\" = \"a\", \"#00ff00\" = \"b\", \"#0000fe\" = \"c\", \"#000000\" = \"d\" }";
    let scratch = with_map(&format!("{{ raster = \"map.ppm\", placement = \"atlas\", {colours} }}"), FOUR);
    scratch.write("map.ppm", "P3\n2 2\n255\n255 0 0  0 255 0\n0 0 254  0 0 0\n");
    let corners = "vt 0.1 0.9\nvt 0.4 0.9\nvt 0.1 0.6\nvt 0.6 0.9\nvt 0.9 0.9\nvt 0.6 0.6\nvt 0.1 0.1\nvt 0.4 0.1\nvt 0.1 0.4\nvt 0.6 0.1\nvt 0.9 0.1\nvt 0.6 0.4\n";
    let mut faces = OCTAHEDRON.replace("f 1 2 5", &format!("{corners}f 1/1 2/2 5/3"));
    for (face, with) in [
        ("f 2 3 5", "f 2/4 3/5 5/6"),
        ("f 3 4 5", "f 3/7 4/8 5/9"),
        ("f 4 1 5", "f 4/10 1/11 5/12"),
        ("f 2 1 6", "f 2/1 1/2 6/3"),
        ("f 3 2 6", "f 3/1 2/2 6/3"),
        ("f 4 3 6", "f 4/1 3/2 6/3"),
        ("f 1 4 6", "f 1/1 4/2 6/3"),
    ] {
        faces = faces.replace(face, with);
    }
    scratch.write("octahedron.obj", faces);
    assert_reflectances(&scratch, [0.1, 0.2, 0.3, 0.4]);
}

#[test]
fn what_a_material_map_cannot_mean_is_said() {
    let map = "raster = \"map.csv\", placement = \"lonlat\", west_deg = 0";
    for (map, values, words) in [
        (
            format!("{{ {map}, materials = {{ 1 = \"a\" }} }}"),
            "1,2,2,1\n",
            "says nothing of what the map has: \"2\" (4 facets)",
        ),
        (format!("{{ {map}, materials = {{ 1 = \"a\", \"1.0\" = \"b\" }} }}"), "1,1\n", "the same as another key"),
        (format!("{{ {map}, materials = {{ one = \"a\" }} }}"), "1,1\n", "neither a number nor a colour"),
        (format!("{{ {map}, materials = {{ \"#ff00\" = \"a\" }} }}"), "1,1\n", "neither a number nor a colour"),
        (
            format!("{{ {map}, materials = {{ \"#ff0000\" = \"a\" }} }}"),
            "1,1\n",
            "is a colour, and the raster has 1 bands",
        ),
        (format!("{{ {map}, materials = {{ 1 = \"aa\" }} }}"), "1,1\n", "no material \"aa\""),
        (format!("{{ {map}, materials = {{}} }}"), "1,1\n", "names no material"),
        (
            format!("{{ {map}, wrap = \"repeat\", materials = {{ 1 = \"a\" }} }}"),
            "1,1\n",
            "does not go with this placement",
        ),
        (
            "{ raster = \"map.csv\", placement = \"atlas\", materials = { 1 = \"a\" } }".to_owned(),
            "1,1\n",
            "no texture coordinates",
        ),
        (
            "{ raster = \"map.csv\", placement = \"lonlat\", materials = { 1 = \"a\" } }".to_owned(),
            "1,1\n",
            "at which longitude",
        ),
    ] {
        let scratch = with_map(&map, FOUR);
        scratch.write("map.csv", values);
        let (code, _, err) = run(&["inspect", &scratch.argument("scene.toml")]);
        assert!(code == 1 && err.contains(words) && err.contains("material_map"), "{map}: {err}");
    }
    let scratch = with_map(&format!("{{ {map}, materials = {{ 1 = \"a\" }} }}\ninstances = \"i.csv\""), FOUR);
    scratch.write("map.csv", "1,1\n");
    scratch.write("i.csv", "x_m,y_m,z_m\n0,0,0\n");
    let (code, _, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    assert!(code == 1 && err.contains("does not go with `instances`"), "{err}");
}
