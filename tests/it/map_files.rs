//! `mmxrt integrate --radiance`: map files, tables of facets, and what is wrong with them.

use crate::cli::run;
use crate::scenes::SQUARE;
use crate::scratch::Scratch;

/// A square of 8 x 8 m, of two facets: its north-west (above the diagonal), then its south-east... counted as the OBJ has them.
/// The square of [`crate::scenes::SQUARE_OBJ`], cut in two.
const TRIANGLES_OBJ: &str =
    "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
/// 2 x 2 pixels of 4 m, north up, seen from 1 km.
const HEAD: &str =
    "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [1.0] }\n";
const PLANE: &str =
    "placement = \"plane\"\nplane = { corner_m = [-4, 4, 0], along_line_m = [4, 0, 0], line_to_line_m = [0, -4, 0] }\n";

pub(crate) struct Bench(pub(crate) Scratch);

impl Bench {
    pub(crate) fn new() -> Self {
        let bench = Bench(Scratch::new());
        bench.0.write("square.obj", TRIANGLES_OBJ);
        bench.0.write("scene.toml", SQUARE);
        bench.0.write("m.csv", "1,2\n3,4\n");
        bench.map(&format!("{HEAD}{PLANE}"));
        bench
    }

    pub(crate) fn map(&self, text: &str) {
        self.0.write("m.map.toml", text);
    }

    /// Exit code and what was said on standard error.
    pub(crate) fn try_to(&self, more: &[&str]) -> (i32, String) {
        let (scene, out) = (self.0.argument("scene.toml"), self.0.argument("out"));
        let arguments: Vec<String> = more
            .iter()
            .map(|a| if a.starts_with("--") { (*a).to_owned() } else { a.replace("{}", &self.0.argument("")) })
            .collect();
        let mut all = vec!["integrate", &scene, "-o", &out, "--dtype", "f64", "--quiet", "--force"];
        all.extend(arguments.iter().map(String::as_str));
        let (code, _, err) = run(&all);
        (code, err)
    }

    /// The image.
    pub(crate) fn integrate(&self, more: &[&str]) -> Vec<f64> {
        let (code, err) = self.try_to(more);
        assert_eq!(code, 0, "{err}");
        let bytes = std::fs::read(self.0.join("out/cube.img")).unwrap();
        bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
    }
}

fn assert_near(image: &[f64], expected: &[f64]) {
    let worst = image.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(image.len() == expected.len() && worst < 1e-9, "{image:?}, expected {expected:?}");
}

#[test]
fn a_raster_lies_where_its_map_file_says() {
    let bench = Bench::new();
    assert_near(&bench.integrate(&["--radiance", "{}m.csv"]), &[1.0, 2.0, 3.0, 4.0]);
    // Named by its map file, which names the raster; in the body's frame; lines from north to south, from east to west.
    bench.0.write(
        "east.toml",
        format!(
            "raster = \"m.csv\"\n{HEAD}placement = \"plane\"\nplane = {{ corner_m = [4, 4, 11000], along_line_m = [0, -4, 0], \
             line_to_line_m = [-4, 0, 0], coordinates = \"body\" }}\n"
        ),
    );
    assert_near(&bench.integrate(&["--radiance", "{}east.toml"]), &[3.0, 1.0, 4.0, 2.0]);
    // By texture coordinates: row 0 is v = 1, north.
    bench.map(&format!("{HEAD}placement = \"atlas\"\n"));
    assert_near(&bench.integrate(&["--radiance", "{}m.csv"]), &[1.0, 2.0, 3.0, 4.0]);
    // As the image of the scene's own camera, and of one that is given by its own numbers, turned by 90 deg: its top is east.
    bench.map(&format!("{HEAD}placement = \"camera\"\nscene = \"scene.toml\"\n"));
    assert_near(&bench.integrate(&["--radiance", "{}m.csv"]), &[1.0, 2.0, 3.0, 4.0]);
    bench.map(&format!(
        "{HEAD}placement = \"camera\"\nobserver = {{ position_m = [0, 0, 12000], target_m = [0, 0, 11000], up = [1, 0, 0] }}\n\
         sensor = {{ fov_deg = 0.45836379150820084 }}\n"
    ));
    assert_near(&bench.integrate(&["--radiance", "{}m.csv"]), &[3.0, 1.0, 4.0, 2.0]);
}

#[test]
fn tables_of_facets_need_no_map_file() {
    let bench = Bench::new();
    bench.0.write("t.csv", "facet,radiance_w_m2_sr_um at 1 um\n0,2\n1,6\n");
    // The diagonal from south-west to north-east halves the pixels there.
    assert_near(&bench.integrate(&["--radiance", "{}t.csv"]), &[6.0, 4.0, 4.0, 2.0]);
    let facets = ["--radiance", "{}m.csv + {}t.csv*0.5"];
    assert_near(&bench.integrate(&facets), &[4.0, 4.0, 5.0, 5.0]);
    // A raster of one column, a facet in each line.
    bench.0.write("m.csv", "2\n6\n");
    bench.map(&format!("{HEAD}placement = \"facets\"\n"));
    assert_near(&bench.integrate(&["--radiance", "{}m.csv"]), &[6.0, 4.0, 4.0, 2.0]);
}

#[test]
fn the_scenes_own_table_is_a_map_too() {
    let bench = Bench::new();
    let (scene, table) = (bench.0.argument("scene.toml"), bench.0.argument("table.npz"));
    assert_eq!(run(&["solve", &scene, "-o", &table, "--quiet"]).0, 0);
    let own = bench.integrate(&["--radiance", "{}table.npz"]);
    assert_near(&own, &bench.integrate(&["--table", "{}table.npz"]));
    let both = bench.integrate(&["--radiance", "{}m.csv+{}table.npz"]);
    assert_near(&both, &[1.0, 2.0, 3.0, 4.0].map(|l| l + own[0]));
    assert!(bench.try_to(&["--radiance", "{}table.npz*2"]).1.contains("counts once"));
    assert!(bench.try_to(&["--table", "{}table.npz", "--radiance", "{}table.npz"]).1.contains("counts once"));
    let gaps = bench.try_to(&["--radiance", "{}m.csv+{}table.npz", "--unknown", "solve"]);
    assert!(gaps.0 == 1 && gaps.1.contains("cannot fill gaps as well"), "{}", gaps.1);
    // A second view is another view of the first term, wherever the table stands.
    let views = bench.integrate(&["--radiance", "{}table.npz+{}m.csv", "--radiance", "{}m.csv"]);
    assert_near(&views, &both);
}

#[test]
fn views_have_the_same_terms() {
    let bench = Bench::new();
    bench.0.write("t.csv", "facet,radiance_w_m2_sr_um at 1 um\n0,2\n1,6\n");
    // The second view lacks the second term: the first view's would be added to it.
    let (code, err) = bench.try_to(&["--radiance", "{}m.csv+{}t.csv", "--radiance", "{}m.csv"]);
    assert!(code == 1 && err.contains("names [2, 1] maps: each time as many"), "{err}");
}

#[test]
fn what_is_not_known_is_an_error_or_filled() {
    let bench = Bench::new();
    bench.0.write("m.csv", "1,-1\n3,nan\n");
    bench.map(&format!("no_data = -1\n{HEAD}{PLANE}"));
    let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
    assert!(code == 1 && err.contains("50.00 % of what the camera sees is unknown"), "{err}");
    assert!(!bench.0.join("out").exists());
    assert_near(&bench.integrate(&["--radiance", "{}m.csv", "--unknown", "7.5"]), &[1.0, 7.5, 3.0, 7.5]);
    // 0.1 / pi of E490 at 1 um, at 1.5 au, from the zenith.
    let solved = 0.1 / std::f64::consts::PI * mmxrt::spectral::solar_e490().at(1.0).unwrap() / 2.25;
    assert_near(&bench.integrate(&["--radiance", "{}m.csv", "--unknown", "solve"]), &[1.0, solved, 3.0, solved]);
    let report = std::fs::read_to_string(bench.0.join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["maps"]["unknown_share"], 0.5);
    assert_eq!(report["maps"]["maps"][0]["undefined_texels"], 2);
    assert!(report["inputs"].as_array().unwrap().iter().any(|i| i["path"].as_str().unwrap().ends_with("m.csv")));
}

#[test]
fn a_number_for_no_data_is_that_of_the_rasters_type() {
    // 1e20 as f32 is 100000002004087734272.
    let bench = Bench::new();
    std::fs::remove_file(bench.0.join("m.csv")).unwrap();
    let bytes: Vec<u8> = [1.0_f32, 1e20, 3.0, 4.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    bench.0.write("m.img", bytes);
    let header =
        "ENVI\nsamples = 2\nlines = 2\nbands = 1\ndata type = 4\ninterleave = bsq\nbyte order = 0\nheader offset = 0\n";
    bench.0.write("m.hdr", header);
    bench.map(&format!("no_data = 1e20\n{HEAD}{PLANE}"));
    assert_near(&bench.integrate(&["--radiance", "{}m.img", "--unknown", "7.5"]), &[1.0, 7.5, 3.0, 4.0]);
}

#[test]
fn what_is_wrong_with_a_map_is_told_at_its_place() {
    let plane = |head: &str| format!("{head}{PLANE}");
    let of_unit = |unit: &str| HEAD.replace("W m-2 sr-1 um-1", unit);
    let cases: Vec<(String, &str)> = vec![
        (plane("quantity = \"radiance\"\n"), "mmxrt_map"),
        (plane(&HEAD.replace("mmxrt_map = 1", "mmxrt_map = 2")), "mmxrt_map"),
        (plane(&format!("{HEAD}colour = 1\n")), "colour"),
        (plane(&of_unit("K")), "must be one of spectral radiance"),
        (plane(&of_unit("furlong")), "unit"),
        (
            plane(&HEAD.replace("\"radiance\"", "\"reflectance_factor\"").replace("W m-2 sr-1 um-1", "1")),
            "irradiance_w_m2_um",
        ),
        (plane(&HEAD.replace("\"radiance\"", "\"band_radiance\"").replace("W m-2 sr-1 um-1", "W m-2 sr-1")), "width"),
        (plane(&HEAD.replace("[1.0]", "[1.0, 2.0]")), "2 bands, but the raster has 1"),
        (plane(&HEAD.replace("bands = { centres_um = [1.0] }\n", "")), "does not say the wavelengths"),
        (plane(&HEAD.replace("[1.0]", "[2.0]")), "at 1 um, is not among the map's"),
        (format!("{HEAD}placement = \"plane\"\n"), "plane: is missing"),
        (format!("{HEAD}placement = \"camera\"\n"), "needs `observer` and `sensor`"),
        (format!("{HEAD}placement = \"camera\"\nscene = \"none.toml\"\n"), "none.toml"),
        (format!("{HEAD}placement = \"facets\"\n"), "4 facets, but the scene has 2"),
        (format!("{HEAD}{PLANE}").replace("[0, -4, 0]", "[8, 0, 0]"), "do not span a plane"),
        (format!("{HEAD}{PLANE}").replace("[-4, 4, 0]", "[400, 4, 0]"), "does not overlap the scene"),
        (format!("{HEAD}{PLANE}scene = \"scene.toml\"\n"), "scene: does not go with this placement"),
        (format!("raster = \"none.img\"\n{HEAD}{PLANE}"), "none.img"),
        (format!("raster = [\"m.csv\", \"long.csv\"]\n{HEAD}{PLANE}"), "long.csv has 3 x 1 pixels"),
    ];
    let bench = Bench::new();
    bench.0.write("long.csv", "1,2,3\n");
    for (text, message) in cases {
        bench.map(&text);
        let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
        assert!(code == 1 && err.contains(message), "{message}\n{text}\n{err}");
        assert!(!bench.0.join("out").exists() && !bench.0.names().iter().any(|n| n.starts_with('.')), "{text}");
    }
    // The raster's own faults.
    bench.map(&plane(HEAD));
    for (raster, message) in
        [("1,-2\n3,4\n", "row 0, column 1"), ("1,2\n3\n", "m.csv"), ("", "m.csv"), ("1,x\n3,4\n", "m.csv")]
    {
        bench.0.write("m.csv", raster);
        let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
        assert!(code == 1 && err.contains(message), "{raster}: {err}");
    }
    bench.0.write("t.img", [0_u8; 12]);
    bench
        .0
        .write("t.hdr", "ENVI\nsamples = 2\nlines = 2\nbands = 1\ndata type = 4\ninterleave = bsq\nbyte order = 0\n");
    bench.0.write("t.map.toml", plane(HEAD));
    assert!(bench.try_to(&["--radiance", "{}t.img"]).1.contains("t.img"));
    // No map file, nothing there, tables that are not of this scene.
    bench.0.write("bare.csv", "1,2\n3,4\n");
    assert!(bench.try_to(&["--radiance", "{}bare.csv"]).1.contains("bare.map.toml"));
    assert!(bench.try_to(&["--radiance", "{}nothing.img"]).1.contains("nothing.img"));
    bench.0.write("u.csv", "facet,radiance_w_m2_sr_um at 1 um\n0,2\n1,6\n2,1\n");
    let told = bench.try_to(&["--radiance", "{}u.csv"]).1;
    assert!(told.contains("has values for 3 facets, but the scene has 2"), "{told}");
    assert_eq!(bench.try_to(&["--radiance", "{}m.csv", "--unknown", "-1"]).0, 2);
    assert_eq!(bench.try_to(&[]).0, 2);
    bench.0.write("square.obj", TRIANGLES_OBJ.replace("/1", "").replace("/2", "").replace("/3", "").replace("/4", ""));
    bench.0.write("m.csv", "1,2\n3,4\n");
    bench.map(&format!("{HEAD}placement = \"atlas\"\n"));
    assert!(bench.try_to(&["--radiance", "{}m.csv"]).1.contains("no texture coordinates"));
    bench.0.write("square.obj", TRIANGLES_OBJ.replace("vt 1 1", "vt 1 1.5"));
    assert!(bench.try_to(&["--radiance", "{}m.csv"]).1.contains("outside 0 to 1: 1.5"));
}

#[test]
fn a_map_file_can_be_inspected() {
    let bench = Bench::new();
    let (code, out, _) = run(&["inspect", &bench.0.argument("m.map.toml")]);
    assert!(code == 0 && out.contains("radiance map file") && out.contains("\"W m-2 sr-1 um-1\""), "{out}");
    bench.map("mmxrt_map = 1\ncolour = 2\n");
    let (code, _, err) = run(&["inspect", &bench.0.argument("m.map.toml")]);
    assert!(code == 1 && err.contains("colour") && err.contains("quantity"), "{err}");
}

#[test]
fn an_output_of_dart_without_inputs_lies_where_the_map_file_says() {
    let bench = Bench::new();
    // A scene of 8 x 8 m, whose origin is in the middle, 2 x 2 pixels of 4 m from the zenith: rows run South, columns East. That is +x and
    // +y at the North pole, where the scene's image has +x on its right and +y on top.
    let images = "output/BAND0/Radiance/ITERX/IMAGES_DART";
    std::fs::create_dir_all(bench.0.join(images)).unwrap();
    bench.0.write(
        "output/simulation.properties.txt",
        "phase.nbSpectralBands:1\nphase.band0.lambdamin:0.9\nphase.band0.lambdamax:1.1\ndart.band0.lambdaMin:0.9\ndart.band0.lambdaMax:1.1\n\
         maket.lowerCorner.z:0\ndart.products.image0.teta:0\ndart.products.image0.phi:0\ndart.products.image0.imageNamePrefix:ima01\n",
    );
    let name = format!("{images}/ima01_VZ=000_0_VA=000_0");
    bench.0.write(
        &format!("{name}.mpr"),
        "[Ilwis]\nType=BaseMap\n[BaseMap]\nCoordBounds=0 -8 8 0\nType=Map\n[Map]\nSize=2 2\n[MapStore]\nType=Real\nStructure=Line\nStartOffset=0\nRowLength=2\n",
    );
    bench.0.write(&format!("{name}.mp#"), [1.0_f64, 2.0, 3.0, 4.0].map(f64::to_le_bytes).concat());
    bench.0.write(&format!("{images}/georef"), "a\nb\n1 0 0 8 0 8 8 0 8\n");
    bench.0.write("dart.toml", "mmxrt_map = 1\ndart = \"output\"\norigin_in_dart_m = [4, 4, 0]\n");
    assert_near(&bench.integrate(&["--radiance", "{}dart.toml"]), &[2.0, 4.0, 1.0, 3.0]);
    let (code, err) = bench.try_to(&["--radiance", "{}output"]);
    assert!(code == 1 && err.contains("origin_in_dart_m"), "{err}");
    // With thermal emission in it, it must not be added to another that has it.
    let twice = bench.integrate(&["--radiance", "{}dart.toml+{}dart.toml"]);
    assert_near(&twice, &[4.0, 8.0, 2.0, 6.0]);
    let properties = std::fs::read_to_string(bench.0.join("output/simulation.properties.txt")).unwrap();
    bench.0.write("output/simulation.properties.txt", format!("{properties}dart.band0.mode:R+T\n"));
    let (code, err) = bench.try_to(&["--radiance", "{}dart.toml+{}dart.toml"]);
    assert!(code == 1 && err.contains("thermal emission would count 2 times"), "{err}");
}

#[test]
fn what_does_not_go_together_is_told_at_its_key() {
    let bench = Bench::new();
    let told = |map: &str, parts: &[&str]| {
        bench.map(map);
        let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
        assert!(code == 1 && parts.iter().all(|part| err.contains(part)), "{map}{err}");
        assert!(!bench.0.join("out").exists());
    };
    told(
        &format!("irradiance_w_m2_um = 3\n{HEAD}{PLANE}"),
        &["m.map.toml:1:22", "irradiance_w_m2_um: does not go with this quantity"],
    );
    let factor = HEAD.replace("\"radiance\"", "\"reflectance_factor\"").replace("W m-2 sr-1 um-1", "1");
    told(
        &format!("irradiance_w_m2_um = -2\n{factor}{PLANE}"),
        &["m.map.toml:1:22", "irradiance_w_m2_um: -2 is negative"],
    );
    told(&format!("irradiance_w_m2_um = [-2]\n{factor}{PLANE}"), &["irradiance_w_m2_um: -2 is negative"]);
    told(
        &format!("occlusion = false\n{HEAD}placement = \"atlas\"\n"),
        &["m.map.toml:1:13", "occlusion: does not go with this placement"],
    );
    told(
        &format!("{HEAD}{PLANE}").replace("[1.0]", "[1.0, 1.1]"),
        &["bands: 2 bands, but the raster has 1, each of 2 rows x 2 columns"],
    );
    for (step, told_as) in [("[0, 0, 0]", "0"), ("[1e200, 0, 0]", "1e200")] {
        told(
            &format!("{HEAD}{}", PLANE.replace("along_line_m = [4, 0, 0]", &format!("along_line_m = {step}"))),
            &[&format!("plane.along_line_m: is a step of {told_as} m")],
        );
    }
    let observer = "observer = { position_m = [0, 0, 12000], target_m = [0, 0, 11000], up = [0, 1, 0] }\n";
    told(
        &format!("{HEAD}placement = \"camera\"\n{observer}sensor = {{ ifov_mrad = 4000 }}\n"),
        &["sensor.ifov_mrad: a pixel of 4000 mrad"],
    );
}

#[test]
fn no_radiance_is_beyond_what_a_product_can_hold() {
    let bench = Bench::new();
    // As of bytes in the wrong order; 1e200 is infinite in single precision.
    bench.0.write("m.csv", "1,2\n1e200,4\n");
    let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
    assert!(code == 1 && err.contains("texel (row 1, column 0) holds the radiance 1e200"), "{err}");
    assert!(err.contains("the order of its bytes"), "{err}");
    bench.0.write("m.csv", "1,2\n3,4\n");
    let (code, err) = bench.try_to(&["--radiance", "{}m.csv*1e308"]);
    assert!(code == 1 && err.contains("holds the radiance 1") && err.contains("its weight"), "{err}");
    let (code, err) = bench.try_to(&["--radiance", "{}m.csv", "--unknown", "1e39"]);
    assert!(code == 1 && err.contains("1e39 is not a radiance"), "{err}");
    assert!(!bench.0.join("out").exists());
    assert_near(&bench.integrate(&["--radiance", "{}m.csv*1e-3"]), &[0.001, 0.002, 0.003, 0.004]);
}

#[test]
fn sums_say_what_is_wrong_in_them() {
    let bench = Bench::new();
    for (text, message) in
        [("", "a map has no name"), ("{}m.csv+", "a map has no name"), ("{}m.csv*two", "\"two\" is not a weight")]
    {
        let (code, err) = bench.try_to(&["--radiance", text]);
        assert!(code == 1 && err.contains(message), "{text}: {err}");
    }
    let (code, err) = bench.try_to(&[]);
    assert!(code == 2 && err.contains("--table <TABLE.npz>|--radiance <"), "{err}");
}

#[test]
fn widths_of_a_table_are_widths() {
    let bench = Bench::new();
    let array = |values: &[f64], shape: &str| {
        let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        header += &" ".repeat(117 - header.len());
        let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        bytes.extend(header.bytes().chain([b'\n']).chain(values.iter().flat_map(|v| v.to_le_bytes())));
        bytes
    };
    for (width, is_good) in
        [(0.0, true), (0.1, true), (-0.1, false), (f64::NAN, false), (f64::INFINITY, false), (2.5, false)]
    {
        let file = std::fs::File::create(bench.0.join("t.npz")).unwrap();
        let mut zip = zip::ZipWriter::new(file);
        let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        for (name, bytes) in [
            ("radiance_w_m2_sr_um.npy", array(&[2.0, 6.0], "(2, 1)")),
            ("wavelength_um.npy", array(&[1.0], "(1,)")),
            ("fwhm_um.npy", array(&[width], "(1,)")),
        ] {
            zip.start_file(name, stored).unwrap();
            std::io::Write::write_all(&mut zip, &bytes).unwrap();
        }
        zip.finish().unwrap();
        let (code, err) = bench.try_to(&["--radiance", "{}t.npz"]);
        let told = err.contains("t.npz fwhm_um: a width of ") && err.contains("um for a band at 1 um");
        assert!(if is_good { code == 0 } else { code == 1 && told }, "{width}: {err}");
    }
}

#[test]
fn a_texture_that_serves_no_facet_says_why() {
    let bench = Bench::new();
    let told = |grid: &str, materials: &str, part: &str| {
        bench.0.write("t.csv", grid);
        bench.0.write("scene.toml", SQUARE.replace("[materials.default]\nreflectance = 0.1\n", materials));
        let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
        assert!(code == 1 && err.contains(part), "{err}");
    };
    let texture = "texture = { raster = \"t.csv\", quantity = \"factor\", placement = \"atlas\" }";
    let plain = format!("[materials.default]\nreflectance = 0.1\n{texture}\n");
    told("1,nan\n1,1\n", &plain, "texel (row 0, column 1) is NaN: expected a number of at least 0");
    told("1,1\ninf,1\n", &plain, "texel (row 1, column 0) is inf: expected a number of at least 0");
    told("0,0\n0,0\n", &plain, "cannot be made 1: it is 0 over the material's facets");
    let mixed = format!(
        "[materials]\na = {{ reflectance = 0.1, {texture} }}\nb = {{ reflectance = 0.2 }}\ndefault = {{ mixture = {{ a = 0.5, b = 0.5 }} }}\n"
    );
    told("1,2\n3,4\n", &mixed, "materials.a.texture.mean: cannot be made 1: no facet is of this material");
    let beside = plain.replace(
        "placement = \"atlas\"",
        "placement = \"plane\", plane = { corner_m = [400, 4, 0], along_line_m = [4, 0, 0], line_to_line_m = [0, -4, 0] }",
    );
    told("1,2\n3,4\n", &beside, "the texture covers none of the material's facets");
}
