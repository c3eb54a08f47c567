//! Where rasters lie as they say themselves: lines in any order, turned maps, and maps of the whole body in degrees.

use crate::cli::run;
use crate::elevation_files::{assert_band, has_none, open, path, quarters, said};
use crate::lon_lat::{assert_quarters, cube, prepared};
use crate::raster_masks::{Directory, Kind, image, tiff};
use crate::scratch::Scratch;

/// A TIFF of bytes with tags of a place: the matrix, or scale and tie point; angles or metres.
fn placed(columns: u16, strip: &[u8], matrix: &[f64], (scale, tie): (&[f64], &[f64]), model: u16) -> Vec<u8> {
    let mut tags = image(columns, strip.len() as u16 / columns, 1, 8);
    for (tag, numbers) in [(33550, scale), (33922, tie), (34264, matrix)] {
        if !numbers.is_empty() {
            tags.push((tag, Kind::Double(numbers.to_vec())));
        }
    }
    tags.push((34735, Kind::Short(vec![1, 1, 0, 1, 1024, 0, 1, model])));
    tiff(&[Directory { tags, strip }])
}

/// The same, north up in degrees.
fn in_degrees(columns: u16, strip: &[u8], [west, north]: [f64; 2], [width, height]: [f64; 2]) -> Vec<u8> {
    placed(columns, strip, &[], (&[width, height, 0.0], &[0.0, 0.0, 0.0, west, north, 0.0]), 2)
}

fn refused_landscape(file: &str) -> String {
    let folder = Scratch::new();
    let text = format!(
        "version = 2\nseed = 1\nsize_m = 400.0\nfacets = 1000\nrelief = [{{ kind = \"elevation\", file = {file:?} }}]\n"
    );
    let recipe = folder.write("r.toml", text).to_string_lossy().into_owned();
    let (code, out, err) = run(&["landscape", &recipe, "-o", &folder.argument("l.obj")]);
    assert_eq!(code, 1, "{out}{err}");
    err
}

#[test]
fn what_lies_south_up_or_mirrored_is_read_from_the_north_west() {
    for (name, told) in [("south_up.tif", "read from the North"), ("mirrored.tif", "read from the West")] {
        let mut raster = open(&path(name));
        let is_hole = |row, column| name == "mirrored.tif" && has_none(row, column);
        assert_band(&mut raster, 0, |row, column| if is_hole(row, column) { f64::NAN } else { quarters(row, column) });
        assert_eq!(raster.spacing_m(), Some([50.0, 50.0]), "{name}");
        assert!(said(&raster).contains(told), "{}", said(&raster));
    }
    // What is turned stays as it is, and serves nothing that needs the North.
    let mut turned = open(&path("turned.tif"));
    assert_band(&mut turned, 0, quarters);
    assert_eq!(turned.spacing_m(), None);
    assert!(said(&turned).contains("lines are turned"), "{}", said(&turned));
    let error = refused_landscape(&path("turned.tif").to_string_lossy());
    assert!(error.contains("lines are turned") && error.contains("gdalwarp"), "{error}");
    // Pixels of degrees have no width.
    let folder = Scratch::new();
    let file = folder.write("deg.tif", in_degrees(4, &[7; 16], [10.0, 20.0], [0.001, 0.002]));
    let error = refused_landscape(&file.to_string_lossy());
    assert!(error.contains("has pixels of 0.001 x 0.002 deg") && error.contains("give `pixel_m`"), "{error}");
}

#[test]
fn labels_say_when_a_map_is_turned() {
    let folder = Scratch::new();
    let label = std::fs::read_to_string(path("bands.lbl")).unwrap();
    for data in ["bands.cub", "pds4.img", "pds3.img"] {
        folder.write(data, std::fs::read(path(data)).unwrap());
    }
    let isis = |rotation: &str| {
        let mapping = format!("Group = Mapping\n    Rotation = {rotation}");
        let text = label.replace("Group = Mapping", &mapping);
        assert_ne!(text, label);
        folder.write("a.lbl", text)
    };
    assert_eq!(open(&isis("360.0")).spacing_m(), Some([50.0, 50.0]));
    let turned = open(&isis("90.0"));
    assert!(turned.spacing_m().is_none() && said(&turned).contains("turned by 90 deg"), "{}", said(&turned));

    let pds3 = |image: &str, map: &str| {
        folder.write(
            "b.lbl",
            format!(
                "PDS_VERSION_ID = PDS3\r\nRECORD_BYTES = 48\r\n^IMAGE = (\"pds3.img\", 529 <BYTES>)\r\nOBJECT = IMAGE\r\nLINES = 16\r\nLINE_SAMPLES = 24\r\n\
                 SAMPLE_TYPE = SUN_INTEGER\r\nSAMPLE_BITS = 16\r\n{image}END_OBJECT\r\nOBJECT = IMAGE_MAP_PROJECTION\r\nMAP_SCALE = 0.05 <KM/PIXEL>\r\n{map}END_OBJECT\r\nEND\r\n"
            ),
        )
    };
    assert_eq!(open(&pds3("", "MAP_PROJECTION_ROTATION = 0.0\r\n")).spacing_m(), Some([50.0, 50.0]));
    for (image, map, told) in [
        ("", "MAP_PROJECTION_ROTATION = 90.0\r\n", "turned by 90 deg"),
        ("LINE_DISPLAY_DIRECTION = RIGHT\r\n", "", "follow one another to the right"),
    ] {
        let raster = open(&pds3(image, map));
        assert!(raster.spacing_m().is_none() && said(&raster).contains(told), "{}", said(&raster));
    }

    let label = std::fs::read_to_string(path("pds4.xml")).unwrap();
    let from_above =
        |row: usize, column: usize| if has_none(row, column) { f64::NAN } else { 0.25 * quarters(row, column) };
    let direction = "<disp:vertical_display_direction>Top to Bottom</disp:vertical_display_direction>";
    assert!(label.contains(direction));
    folder.write("c.xml", label.replace("Top to Bottom", "Bottom to Top"));
    let mut up = open(&folder.join("c.xml"));
    assert_band(&mut up, 0, |row, column| from_above(15 - row, column));
    assert_eq!(up.spacing_m(), Some([50.0, 50.0]));
    let axis = "<disp:vertical_display_axis>Line<";
    assert!(label.contains(axis));
    folder.write("c.xml", label.replace(axis, "<disp:vertical_display_axis>Sample<"));
    let turned = open(&folder.join("c.xml"));
    assert!(turned.spacing_m().is_none() && said(&turned).contains("to the side"), "{}", said(&turned));
}

const MAP: &str = "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [1.0] }\nplacement = \"lonlat\"\n";

#[test]
fn maps_in_degrees_say_where_they_begin_and_must_be_of_the_whole_body() {
    let scratch = prepared(&[]);
    let integrate = |file: Vec<u8>, west: &str| {
        scratch.write("m.tif", file);
        scratch.write("m.map.toml", format!("{MAP}{west}"));
        let (scene, map, out) = (scratch.argument("scene.toml"), scratch.argument("m.tif"), scratch.argument("out"));
        let (code, said, err) =
            run(&["integrate", &scene, "--radiance", &map, "-o", &out, "--dtype", "f64", "--force", "--unknown", "0"]);
        (code, format!("{said}{err}"))
    };
    let four = |west: f64| in_degrees(4, &[1, 2, 3, 4], [west, 90.0], [90.0, 180.0]);
    // Lines and pixels in the other order; the South is not seen.
    let matrix = |a: f64, x: f64, d: f64, y: f64| [a, 0.0, 0.0, x, 0.0, d, 0.0, y];
    let south_up = placed(4, &[9, 9, 9, 9, 1, 2, 3, 4], &matrix(90.0, -180.0, 90.0, -90.0), (&[], &[]), 2);
    let mirrored = placed(4, &[4, 3, 2, 1, 9, 9, 9, 9], &matrix(-90.0, 180.0, -90.0, 90.0), (&[], &[]), 2);
    for (file, west, expected) in [
        (four(-180.0), "", [3.0, 4.0, 1.0, 2.0]),
        (four(0.0), "", [1.0, 2.0, 3.0, 4.0]),
        (four(540.0), "", [3.0, 4.0, 1.0, 2.0]),
        (four(-180.0), "west_deg = 180", [3.0, 4.0, 1.0, 2.0]),
        (four(-180.0), "west_deg = -180", [3.0, 4.0, 1.0, 2.0]),
        (south_up.clone(), "", [3.0, 4.0, 1.0, 2.0]),
        (mirrored, "west_deg = -180.0", [3.0, 4.0, 1.0, 2.0]),
        // Within half a column, that of the map file.
        (four(-160.0), "west_deg = -180", [3.0, 4.0, 1.0, 2.0]),
        (four(200.0), "west_deg = -180", [3.0, 4.0, 1.0, 2.0]),
        // Sizes in decimals.
        (in_degrees(4, &[1, 2, 3, 4], [0.0, 90.0], [90.02, 179.97]), "", [1.0, 2.0, 3.0, 4.0]),
    ] {
        let (code, said) = integrate(file, west);
        assert_eq!(code, 0, "{said}");
        assert_quarters(&cube(&scratch), expected, west);
        assert_eq!(said.contains("that of this file is taken"), said.contains("deg here"), "{said}");
    }
    let (_, said) = integrate(four(-160.0), "west_deg = -180");
    assert!(said.contains("west_deg: -180 deg here, and -160 deg in"), "{said}");
    let (_, said) = integrate(in_degrees(4, &[1, 2, 3, 4], [0.0, 90.0], [90.05, 180.0]), "");
    assert!(said.contains("longitudes 0 to 360.2 deg") && said.contains("taken for the whole body"), "{said}");
    let turned = [0.0, 90.0, 0.0, -180.0, -90.0, 0.0, 0.0, 90.0];
    for (file, west, message) in [
        (four(-180.0), "west_deg = 0", "0 deg here, and -180 deg in"),
        (four(-135.0), "west_deg = -180", "-180 deg here, and -135 deg in"),
        (
            in_degrees(4, &[1; 8], [0.0, 9.0], [4.5, 4.5]),
            "west_deg = 0",
            "longitudes 0 to 18 deg and latitudes 0 to 9 deg",
        ),
        // Columns whose middles are at both ends; the North alone.
        (in_degrees(5, &[1; 10], [-225.0, 90.0], [90.0, 90.0]), "", "longitudes -225 to 225 deg"),
        (in_degrees(4, &[1; 4], [0.0, 90.0], [90.0, 90.0]), "", "latitudes 0 to 90 deg"),
        (placed(4, &[1; 8], &turned, (&[], &[]), 2), "west_deg = 0", "lines are turned"),
    ] {
        let (code, said) = integrate(file, west);
        assert!(code == 1 && said.contains(message), "{message}: {said}");
        assert!(said.contains("gdalwarp") || said.contains("leave it out"), "{said}");
    }
}

#[test]
fn textures_and_material_maps_in_degrees_say_where_they_begin() {
    let texture = "reflectance = 0.1, texture = { raster = \"m.tif\", quantity = \"reflectance\", placement = \"lonlat\", unit = \"%\"WEST }";
    let map = "material_map = { raster = \"m.tif\", placement = \"lonlat\", materials = { 10 = \"a\", 20 = \"b\", 30 = \"c\", 40 = \"d\" }WEST }";
    let four = "[materials]\na = { reflectance = 0.1 }\nb = { reflectance = 0.2 }\nc = { reflectance = 0.3 }\nd = { reflectance = 0.4 }";
    let (of_texture, of_mesh) =
        (format!("[materials]\ndefault = {{ {texture} }}"), format!("octahedron.obj\"\n{map}\n#\""));
    let default = "[materials.default]\nreflectance = 0.1";
    for more in [vec![(default, of_texture.as_str())], vec![("octahedron.obj\"", of_mesh.as_str()), (default, four)]] {
        for (west, is_taken) in [("", true), (", west_deg = -180", true), (", west_deg = 90", false)] {
            let more: Vec<(&str, String)> = more.iter().map(|(from, to)| (*from, to.replace("WEST", west))).collect();
            let more: Vec<(&str, &str)> = more.iter().map(|(from, to)| (*from, to.as_str())).collect();
            let scratch = prepared(&more);
            scratch.write("m.tif", in_degrees(4, &[10, 20, 30, 40], [-180.0, 90.0], [90.0, 180.0]));
            let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
            let (code, said, err) =
                run(&["simulate", &scene, "-o", &out, "--dtype", "f64", "--model", "sunlight", "--force"]);
            assert_eq!(code == 0, is_taken, "{said}{err}");
            if !is_taken {
                assert!(err.contains("90 deg here, and -180 deg in"), "{err}");
                continue;
            }
            // Each face is seen alike: what is seen of it goes with its reflectance.
            let image = cube(&scratch);
            let sum: f64 = image.iter().sum();
            let found: Vec<f64> = image.iter().map(|value| 0.5 * value / sum).collect();
            assert_quarters(&found, [0.3, 0.4, 0.1, 0.2], west);
        }
    }
}

#[test]
fn a_texel_is_told_by_its_place_in_the_file() {
    for (grid, told) in [
        ("1,1,nan,1\n", "texel (row 0, column 2) is NaN"),
        ("1,1,1,1\n-2,1,1,1\n", "texel (row 1, column 0) is -2"),
        ("1,1,1,inf\n", "texel (row 0, column 3) is inf"),
    ] {
        let texture = "reflectance = 0.1, texture = { raster = \"t.csv\", quantity = \"factor\", placement = \"lonlat\", west_deg = 0 }";
        let scratch =
            prepared(&[("[materials.default]\nreflectance = 0.1", &format!("[materials]\ndefault = {{ {texture} }}"))]);
        scratch.write("t.csv", grid);
        let (code, said, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("out")]);
        assert!(code == 1 && err.contains(told), "{said}{err}");
    }
}

#[test]
fn a_grid_of_esri_without_nodata_value_has_that_of_the_format() {
    let folder = Scratch::new();
    let mut values = Vec::new();
    let mut read = |head: &str, numbers: &str| {
        let text = format!("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 10\n{head}{numbers}\n");
        let mut raster = open(&folder.write("a.asc", text));
        raster.read(0, &mut values).unwrap();
        (values.iter().map(|v| if v.is_nan() { None } else { Some(*v) }).collect::<Vec<_>>(), said(&raster))
    };
    let (found, told) = read("", "-9999 3");
    assert!(found == [None, Some(3.0)] && told.contains("-9999, as the format has it, which 1 pixels have"), "{told}");
    let (found, told) = read("", "-9998 3");
    assert!(found == [Some(-9998.0), Some(3.0)] && !told.contains("-9999"), "{told}");
    let (found, told) = read("NODATA_value 3\n", "-9999 3");
    assert!(found == [Some(-9999.0), None] && !told.contains("as the format has it"), "{told}");
}
