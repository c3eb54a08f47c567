//! Images of other programs as radiance maps: which channel is which band, where the pixels lie, what the numbers are.

use mmxrt::formats::registry;

use crate::cli::run;
use crate::scenes::{SQUARE, SQUARE_OBJ, replaced};
use crate::scratch::Scratch;

/// An OpenEXR file of f32 scan lines: channels by name with the numbers of their pixels, in the order in which they are given (that of
/// OpenEXR is alphabetical); windows are first x, y and last x, y.
struct Exr<'a> {
    channels: &'a [(&'a str, &'a [f32])],
    data: [i32; 4],
    display: [i32; 4],
    aspect: f32,
    unit: Option<&'a str>,
}

impl Exr<'_> {
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
        let mut attribute = |name: &str, kind: &str, value: &[u8]| {
            let length = (value.len() as i32).to_le_bytes();
            bytes.extend([name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &length, value].concat());
        };
        let mut sorted = self.channels.to_vec();
        sorted.sort_by_key(|channel| channel.0);
        let mut list = Vec::new();
        for (name, _) in &sorted {
            list.extend([name.as_bytes(), b"\0", &2_i32.to_le_bytes(), &[0; 4], &[1, 0, 0, 0, 1, 0, 0, 0]].concat());
        }
        list.push(0);
        let window = |of: [i32; 4]| of.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        attribute("channels", "chlist", &list);
        attribute("compression", "compression", &[0]);
        attribute("dataWindow", "box2i", &window(self.data));
        attribute("displayWindow", "box2i", &window(self.display));
        attribute("lineOrder", "lineOrder", &[0]);
        attribute("pixelAspectRatio", "float", &self.aspect.to_le_bytes());
        if let Some(unit) = self.unit {
            attribute("radianceUnits", "string", unit.as_bytes());
        }
        attribute("screenWindowCenter", "v2f", &[0; 8]);
        attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
        bytes.push(0);
        let [x0, y0, x1, y1] = self.data;
        let (columns, rows) = ((x1 - x0 + 1) as usize, (y1 - y0 + 1) as usize);
        let line_bytes = 4 * columns * sorted.len();
        let first = bytes.len() + 8 * rows;
        (0..rows).for_each(|row| bytes.extend(((first + row * (8 + line_bytes)) as u64).to_le_bytes()));
        for row in 0..rows {
            bytes.extend([(y0 + row as i32).to_le_bytes(), (line_bytes as i32).to_le_bytes()].concat());
            for (_, numbers) in &sorted {
                bytes.extend(numbers[row * columns..][..columns].iter().flat_map(|v| v.to_le_bytes()));
            }
        }
        bytes
    }
}

/// 2 x 2 pixels.
fn exr(channels: &[(&str, &[f32])]) -> Vec<u8> {
    Exr { channels, data: [0, 0, 1, 1], display: [0, 0, 1, 1], aspect: 1.0, unit: None }.bytes()
}

const HEAD: &str = "mmxrt_map = 1\nquantity = \"radiance\"\n";
const PER_UM: &str = "unit = \"W m-2 sr-1 um-1\"\n";
const ATLAS: &str = "placement = \"atlas\"\n";
const PLANE: &str =
    "placement = \"plane\"\nplane = { corner_m = [-4, 4, 0], along_line_m = [4, 0, 0], line_to_line_m = [0, -4, 0] }\n";

/// The square around the body's centre, where the North is up, in bands at these wavelengths.
fn scene(centres_um: &[f64]) -> String {
    replaced(SQUARE, &[("11000", "0"), ("12000", "1000"), ("[1.0]", &format!("{centres_um:?}"))])
}

struct Bench(Scratch);

impl Bench {
    /// With a scene of bands at these wavelengths.
    fn new(centres_um: &[f64]) -> Self {
        let bench = Bench(Scratch::new());
        bench.0.write("square.obj", SQUARE_OBJ);
        bench.0.write("scene.toml", scene(centres_um));
        bench
    }

    /// Exit code and what was said.
    fn try_to(&self, file: &str, map: &str) -> (i32, String) {
        let stem = file.split('.').next().unwrap();
        self.0.write(&format!("{stem}.map.toml"), map);
        let (scene, file, out) = (self.0.argument("scene.toml"), self.0.argument(file), self.0.argument("out"));
        let (code, out, err) =
            run(&["integrate", &scene, "--radiance", &file, "-o", &out, "--dtype", "f64", "--force", "--unknown", "0"]);
        (code, out + &err)
    }

    /// The image, band after band, and what was said.
    fn integrate(&self, file: &str, map: &str) -> (Vec<f64>, String) {
        let (code, said) = self.try_to(file, map);
        assert_eq!(code, 0, "{said}");
        let bytes = std::fs::read(self.0.join("out/cube.img")).unwrap();
        (bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect(), said)
    }
}

fn assert_near(image: &[f64], expected: &[f64]) {
    let worst = image.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(image.len() == expected.len() && worst < 1e-9, "{image:?}, expected {expected:?}");
}

/// Four pixels of one value, for each value.
fn uniform(values: &[f64]) -> Vec<f64> {
    values.iter().flat_map(|v| [*v; 4]).collect()
}

#[test]
fn names_of_channels_order_bands_not_the_alphabet() {
    let bench = Bench::new(&[0.45, 0.55, 0.65]);
    bench.0.write("rgb.exr", exr(&[("R", &[1.0; 4]), ("G", &[2.0; 4]), ("B", &[3.0; 4])]));
    let rgb = format!("{HEAD}{PER_UM}bands = {{ centres_um = [0.65, 0.55, 0.45] }}\n{ATLAS}");
    let (image, said) = bench.integrate("rgb.exr", &rgb);
    assert_near(&image, &uniform(&[3.0, 2.0, 1.0]));
    assert!(!said.contains("warning"), "{said}");
    // Bands from blue to red, over red to blue: as the file says, but told.
    let bgr = format!("{HEAD}{PER_UM}bands = {{ centres_um = [0.45, 0.55, 0.65] }}\n{ATLAS}");
    let (image, said) = bench.integrate("rgb.exr", &bgr);
    assert_near(&image, &uniform(&[1.0, 2.0, 3.0]));
    assert!(said.contains("R is 0.45 um, G is 0.55 um, B is 0.65 um"), "{said}");
    let chosen = bgr.replace("bands", "channels = [\"B\", \"g\", \"R\"]\nbands");
    assert_near(&bench.integrate("rgb.exr", &chosen).0, &uniform(&[3.0, 2.0, 1.0]));

    let bench = Bench::new(&[0.9, 1.0, 1.1]);
    for names in [["900nm", "1000nm", "1100nm"], ["0.9um", "1um", "1,1\u{b5}m"], ["L.900 nm", "L.1000 nm", "L.1100 nm"]]
    {
        let channels = names.iter().zip([&[1.0; 4], &[2.0; 4], &[3.0; 4]]).map(|(n, v)| (*n, v.as_slice()));
        bench.0.write("nm.exr", exr(&channels.collect::<Vec<_>>()));
        assert_near(&bench.integrate("nm.exr", &format!("{HEAD}{PER_UM}{ATLAS}")).0, &uniform(&[1.0, 2.0, 3.0]));
        let given = format!("{HEAD}{PER_UM}bands = {{ centres_um = [0.9, 1.0, 1.1] }}\n{ATLAS}");
        assert_near(&bench.integrate("nm.exr", &given).0, &uniform(&[1.0, 2.0, 3.0]));
        // In the order in which the file keeps them.
        let (code, said) = bench.try_to("nm.exr", &given.replace("0.9, 1.0, 1.1", "1.0, 1.1, 0.9"));
        assert!(code == 1 && said.contains("band 1 is at 1 um here, but at 0.9 um in the raster"), "{said}");
    }
    let numbers = [("band 2", &[1.0_f32; 4][..]), ("band 10", &[2.0; 4]), ("band 11", &[3.0; 4])];
    bench.0.write("n.exr", exr(&numbers));
    let given = format!("{HEAD}{PER_UM}bands = {{ centres_um = [0.9, 1.0, 1.1] }}\n{ATLAS}");
    assert_near(&bench.integrate("n.exr", &given).0, &uniform(&[1.0, 2.0, 3.0]));
    // Names that say nothing.
    bench.0.write("n.exr", exr(&[("far", &[3.0; 4]), ("middle", &[2.0; 4]), ("near", &[1.0; 4])]));
    let (code, said) = bench.try_to("n.exr", &given);
    assert!(code == 1 && said.contains("\"far\", \"middle\", \"near\"") && said.contains("channels = ["), "{said}");
    let chosen = given.replace("bands", "channels = [\"near\", \"middle\", \"far\"]\nbands");
    assert_near(&bench.integrate("n.exr", &chosen).0, &uniform(&[1.0, 2.0, 3.0]));
    let (code, said) = bench.try_to("n.exr", &given.replace("bands", "channels = [\"nearr\"]\nbands"));
    assert!(code == 1 && said.contains("did you mean \"near\"?"), "{said}");
}

#[test]
fn coverage_divides_and_passes_beside_the_image_are_told() {
    let folder = Scratch::new();
    let half = &[0.5, 0.25, 1.0, 0.0][..];
    let channels = [
        ("V.Combined.R", &[1.0, 1.0, 3.0, 0.0][..]),
        ("V.Combined.G", &[2.0; 4]),
        ("V.Combined.B", &[3.0; 4]),
        ("V.Combined.A", half),
        ("V.Depth.Z", &[9.0; 4]),
    ];
    let path = folder.write("v.exr", exr(&channels));
    let mut image = registry::image(&path).unwrap();
    let names: Vec<&str> = image.bands.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Depth.Z", "V.Combined.A"]);
    image.take_image(None).unwrap();
    assert_eq!(image.bands.len(), 3);
    let mut values = Vec::new();
    image.read(0, &mut values).unwrap();
    assert_eq!(values[..3], [2.0, 4.0, 3.0]);
    assert!(values[3].is_nan());
    assert_eq!(image.coverage().unwrap(), Some(&[0.5, 0.25, 1.0, 0.0][..]));
    let notes: String = image.report.notes.iter().map(|note| note.to_string()).collect();
    assert!(
        notes.contains("channels beside the image: V.Depth.Z") && notes.contains("V.Combined.A: coverage"),
        "{notes}"
    );
}

#[test]
fn pixels_outside_of_the_data_window_are_not_known() {
    let bench = Bench::new(&[1.0]);
    let file = |data, display| {
        Exr { channels: &[("Y", &[1.0, 2.0, 3.0, 4.0])], data, display, aspect: 1.0, unit: None }.bytes()
    };
    let map = format!("{HEAD}{PER_UM}bands = {{ centres_um = [1.0] }}\n{ATLAS}");
    let read = |bytes| {
        let mut image = registry::image(&bench.0.write("w.exr", bytes)).unwrap();
        let mut values = Vec::new();
        image.read(0, &mut values).unwrap();
        let notes: String = image.report.notes.iter().map(|note| note.to_string()).collect();
        ([image.rows, image.columns], values, notes)
    };
    let (size, values, notes) = read(file([1, 1, 2, 2], [0, 0, 3, 3]));
    assert_eq!(size, [4, 4]);
    assert_eq!([values[5], values[6], values[9], values[10]], [1.0, 2.0, 3.0, 4.0]);
    assert!(values.iter().filter(|v| v.is_nan()).count() == 12 && notes.contains("the others have no data"), "{notes}");
    // The image's own corner may be anywhere; what lies beyond it is cut off.
    let (size, values, notes) = read(file([10, -5, 11, -4], [11, -5, 12, -5]));
    assert!(
        size == [1, 2] && values[0] == 2.0 && values[1].is_nan() && notes.contains("beyond the display window"),
        "{notes}"
    );
    assert!(registry::image(&bench.0.write("w.exr", file([4, 0, 5, 1], [0, 0, 3, 3]))).is_err());
    // Each texel of a 4 x 4 image is 2 m wide: of a pixel's four, one is known.
    bench.0.write("w.exr", file([1, 1, 2, 2], [0, 0, 3, 3]));
    let (code, said) = bench.try_to("w.exr", &map);
    assert_eq!(code, 0, "{said}");
    // Twice as wide as high: no frame camera's image, but a texture like any other.
    let wide =
        Exr { channels: &[("Y", &[1.0; 4])], data: [0, 0, 1, 1], display: [0, 0, 1, 1], aspect: 2.0, unit: None };
    bench.0.write("w.exr", wide.bytes());
    assert_near(&bench.integrate("w.exr", &map).0, &uniform(&[1.0]));
    let camera = map.replace(ATLAS, "placement = \"camera\"\nscene = \"scene.toml\"\n");
    let (code, said) = bench.try_to("w.exr", &camera);
    assert!(code == 1 && said.contains("2 times as wide as high, those of the camera 1 times"), "{said}");
    // Those of a camera whose focal length across the lines is twice that along them, each in its pixels.
    let camera = map.replace(
        ATLAS,
        "placement = \"camera\"\nobserver = { position_m = [0, 0, 12000], target_m = [0, 0, 11000], up = [0, 1, 0] }\n\
         sensor = { focal_px = [250, 500] }\n",
    );
    let (code, said) = bench.try_to("w.exr", &camera);
    assert_eq!(code, 0, "{said}");
    let (code, said) = bench.try_to("w.exr", &camera.replace("[250, 500]", "[500, 250]"));
    assert!(code == 1 && said.contains("those of the camera 0.5 times"), "{said}");
}

#[test]
fn no_data_is_that_of_the_type() {
    let bench = Bench::new(&[1.0]);
    // 1e20 as f32 is 100000002004087734272.
    bench.0.write("f.exr", exr(&[("Y", &[1e20, 1.0, 1.0, f32::NAN])]));
    let map = format!("{HEAD}{PER_UM}no_data = 1e20\nbands = {{ centres_um = [1.0] }}\n{ATLAS}");
    assert_near(&bench.integrate("f.exr", &map).0, &[0.0, 1.0, 1.0, 0.0]);
    // A number of the file is meant also where the values are scaled.
    let header = "ENVI\nsamples = 2\nlines = 2\nbands = 1\ndata type = 2\ndata gain values = {0.5}\n";
    bench.0.write("g.hdr", header);
    bench.0.write("g.img", [-99_i16, 2, 4, 6].map(i16::to_le_bytes).concat());
    assert_near(&bench.integrate("g.img", &map.replace("1e20", "-99")).0, &[0.0, 1.0, 2.0, 3.0]);
}

#[test]
fn the_rasters_unit_is_used_or_compared() {
    let bench = Bench::new(&[1.0]);
    let file = |unit| {
        let one: &[f32] = &[1.0; 4];
        Exr { channels: &[("S0.1000nm", one)], data: [0, 0, 1, 1], display: [0, 0, 1, 1], aspect: 1.0, unit }.bytes()
    };
    bench.0.write("u.exr", file(Some("W.m^-2.sr^-1.nm^-1")));
    assert_near(&bench.integrate("u.exr", &format!("{HEAD}{ATLAS}")).0, &uniform(&[1000.0]));
    let (image, said) = bench.integrate("u.exr", &format!("{HEAD}{PER_UM}{ATLAS}"));
    assert_near(&image, &uniform(&[1.0]));
    assert!(said.contains("states \"W.m^-2.sr^-1.nm^-1\", 1000 times as much"), "{said}");
    let (_, said) = bench.integrate("u.exr", &format!("{HEAD}unit = \"W m-2 sr-1 nm-1\"\n{ATLAS}"));
    assert!(!said.contains("states"), "{said}");
    for (unit, message) in
        [(Some("DN"), "is not understood"), (None, "states none"), (Some("K"), "must be one of spectral radiance")]
    {
        bench.0.write("u.exr", file(unit));
        let (code, said) = bench.try_to("u.exr", &format!("{HEAD}{ATLAS}"));
        assert!(code == 1 && said.contains(message), "{said}");
    }
}

#[test]
fn the_rasters_georeference_is_used_or_compared() {
    let bench = Bench::new(&[1.0]);
    bench.0.write("m.img", [1_f32, 2.0, 3.0, 4.0].map(f32::to_le_bytes).concat());
    let header = |info: &str| {
        let text = format!(
            "ENVI\nsamples = 2\nlines = 2\nbands = 1\ndata type = 4\nmap info = {{{info}}}\nwavelength = {{1}}\n"
        );
        bench.0.write("m.hdr", text)
    };
    let own = format!("{HEAD}{PER_UM}placement = \"plane\"\n");
    for info in [
        "Arbitrary, 1, 1, -4, 4, 4, 4, units=Meters",
        "UTM, 1.5, 1.5, -0.002, 0.002, 0.004, 0.004, 33, North, units=km",
    ] {
        header(info);
        assert_near(&bench.integrate("m.img", &own).0, &[1.0, 2.0, 3.0, 4.0]);
        let (_, said) = bench.integrate("m.img", &format!("{HEAD}{PER_UM}{PLANE}"));
        assert!(!said.contains("georeference"), "{said}");
    }
    header("Arbitrary, 1, 1, 5000, 5000, 1, 1, units=Meters");
    let (image, said) = bench.integrate("m.img", &format!("{HEAD}{PER_UM}{PLANE}"));
    assert_near(&image, &[1.0, 2.0, 3.0, 4.0]);
    assert!(said.contains("corner (5000, 5000)") && said.contains("corner (-4, 4)"), "{said}");
    for (info, message) in [
        ("Geographic Lat/Lon, 1, 1, 10, 20, 0.1, 0.1, WGS-84", "pixels of 0.1 x 0.1 deg"),
        ("Arbitrary, 1, 1, -4, 4, 4, 4, units=Meters, rotation=30", "turned by 30 deg"),
        ("Arbitrary, 1, 1, -4", "no six numbers"),
    ] {
        header(info);
        let (code, said) = bench.try_to("m.img", &own);
        assert!(code == 1 && said.contains(message), "{said}");
    }
}

#[test]
fn a_plane_from_the_south_names_towards() {
    let bench = Bench::new(&[1.0]);
    bench.0.write("b.csv", "3,4\n1,2\n");
    let map = |more: &str| {
        format!(
            "{HEAD}{PER_UM}bands = {{ centres_um = [1.0] }}\nplacement = \"plane\"\n\
             plane = {{ corner_m = [-4, -4, 0], along_line_m = [4, 0, 0], line_to_line_m = [0, 4, 0]{more} }}\n"
        )
    };
    let (code, said) = bench.try_to("b.csv", &map(""));
    assert!(code == 1 && said.contains("`towards = [0.0, 0.0, 1.0]` in `plane`"), "{said}");
    assert_near(&bench.integrate("b.csv", &map(", towards = [0, 0, 1]")).0, &[1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn an_openexr_file_is_read_once() {
    let folder = Scratch::new();
    let path = folder.write("a.exr", exr(&[("1nm", &[1.0; 4]), ("2nm", &[2.0; 4]), ("3nm", &[3.0; 4])]));
    let mut image = registry::image(&path).unwrap();
    let mut values = Vec::new();
    image.read(0, &mut values).unwrap();
    // All bands came with the first.
    std::fs::remove_file(&path).unwrap();
    for band in [1, 2, 0] {
        image.read(band, &mut values).unwrap();
        assert_eq!(values, [band as f64 + 1.0; 4]);
    }
}

/// A picture's bytes that Pillow 12 wrote: 16 x 8 pixels, the left half (200, 100, 50), the right one (20, 40, 240), to 1 of 255.
const JPEG: &[u8] = include_bytes!("../data/pictures/two_colours.jpg");
/// The same in grey: 51 and 204.
const GREY: &[u8] = include_bytes!("../data/pictures/two_greys.jpg");

/// The reflectances that a texture makes of the square's pixels, band after band.
fn reflectances(bench: &Bench, centres_um: &[f64], texture: &str) -> Vec<f64> {
    let scene = scene(centres_um).replace("[sun]", &format!("texture = {{ {texture} }}\n[sun]"));
    bench.0.write("t.toml", scene);
    let (scene, out) = (bench.0.argument("t.toml"), bench.0.argument("out"));
    let (code, out, err) = run(&["simulate", &scene, "-o", &out, "--dtype", "f64", "--force"]);
    assert_eq!(code, 0, "{out}{err}");
    let bytes = std::fs::read(bench.0.join("out/cube.img")).unwrap();
    let radiance = bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b));
    // White sends E / pi, from the zenith at 1.5 au.
    let white = |um: f64| mmxrt::spectral::solar_e490().at(um).unwrap() / 2.25 / std::f64::consts::PI;
    radiance.enumerate().map(|(i, l)| l / white(centres_um[i / 4])).collect()
}

#[test]
fn jpeg_and_the_order_of_a_pictures_bands() {
    let bench = Bench::new(&[1.0]);
    bench.0.write("c.jpg", JPEG);
    let texture = |bands: &str| {
        let more = if bands.is_empty() { String::new() } else { format!(", bands = {{ centres_um = {bands} }}") };
        format!("raster = \"c.jpg\", quantity = \"reflectance\", placement = \"atlas\"{more}")
    };
    let found = reflectances(&bench, &[0.45, 0.55, 0.65], &texture("[0.65, 0.55, 0.45]"));
    let expected = [[50.0, 240.0], [100.0, 40.0], [200.0, 20.0]].map(|[a, b]| [a, b, a, b].map(|v| v / 255.0));
    for (found, expected) in found.iter().zip(expected.as_flattened()) {
        assert!((found - expected).abs() < 1.01 / 255.0, "{found} {expected}");
    }
    let one = format!("channels = [\"red\"], {}", texture(""));
    let red = reflectances(&bench, &[1.0], &one);
    assert!((red[0] - 200.0 / 255.0).abs() < 1.01 / 255.0 && (red[1] - 20.0 / 255.0).abs() < 1.01 / 255.0);
    bench.0.write("c.jpg", GREY);
    let grey = reflectances(&bench, &[1.0], &texture(""));
    assert!((grey[0] - 0.2).abs() < 1e-12 && (grey[1] - 0.8).abs() < 1e-12, "{grey:?}");
    for length in 0..GREY.len() {
        let path = bench.0.write("d.jpg", &GREY[..length]);
        assert!(registry::image(&path).is_err(), "{length}");
    }
    let (code, out, _) = run(&["inspect", &bench.0.argument("c.jpg")]);
    assert!(code == 0 && out.contains("grey"), "{out}");
}

#[test]
fn an_image_is_repeated_on_request() {
    let bench = Bench::new(&[1.0]);
    bench.0.write("t.csv", "0.1,0.3\n");
    let with = |u: [f64; 2], more: &str| {
        let square = SQUARE_OBJ.replace("vt 0 ", &format!("vt {} ", u[0])).replace("vt 1 ", &format!("vt {} ", u[1]));
        bench.0.write("square.obj", square);
        let texture = format!("raster = \"t.csv\", quantity = \"reflectance\", placement = \"atlas\"{more}");
        reflectances(&bench, &[1.0], &texture)
    };
    let near = |found: Vec<f64>, [a, b]: [f64; 2]| assert_near(&found, &[a, b, a, b]);
    // Rounding of an exporter: on the border.
    near(with([-1e-7, 1.0000002], ""), [0.1, 0.3]);
    for wrap in ["repeat", "repeat_u"] {
        near(with([0.5, 1.5], &format!(", wrap = \"{wrap}\"")), [0.3, 0.1]);
        near(with([-41.5, -40.5], &format!(", wrap = \"{wrap}\"")), [0.3, 0.1]);
        near(with([0.0, 2.0], &format!(", wrap = \"{wrap}\"")), [0.2, 0.2]);
        // Linear between 0.1 at u = 0.25 and 0.3 at u = 0.75, and back to 0.1 at 1.25.
        let bilinear = format!(", texels = \"bilinear\", wrap = \"{wrap}\"");
        near(with([0.5, 1.5], &bilinear), [0.25, 0.15]);
        near(with([0.0, 1.0], &bilinear), [0.15, 0.25]);
    }
    // Without, it is level beyond the outer centres.
    near(with([0.0, 1.0], ", texels = \"bilinear\""), [0.125, 0.275]);

    let square = SQUARE_OBJ.replace("vt 0 ", "vt 0.5 ").replace("vt 1 ", "vt 1.5 ");
    bench.0.write("square.obj", square);
    bench.0.write("m.csv", "1,3\n");
    let map = format!("{HEAD}{PER_UM}bands = {{ centres_um = [1.0] }}\n{ATLAS}");
    let (code, said) = bench.try_to("m.csv", &map);
    assert!(code == 1 && said.contains("outside 0 to 1: 1.5") && said.contains("wrap = \"repeat\""), "{said}");
    assert_near(&bench.integrate("m.csv", &format!("{map}wrap = \"repeat\"\n")).0, &[3.0, 1.0, 3.0, 1.0]);
    let (code, said) = bench.try_to("m.csv", &format!("{map}wrap = \"repeat_v\"\n"));
    assert!(code == 1 && said.contains("outside 0 to 1"), "{said}");
    bench.0.write("square.obj", SQUARE_OBJ.replace("vt 1 ", "vt 1e9 "));
    let (code, said) = bench.try_to("m.csv", &format!("{map}wrap = \"repeat\"\n"));
    assert!(code == 1 && said.contains("images"), "{said}");
}

/// A `.npy` file of f64, and a `.npz` file of some, deflated.
fn npy(shape: &str, numbers: &[f64]) -> Vec<u8> {
    let numbers: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
    crate::raster::npy("<f8", false, shape, &numbers)
}

fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    use std::io::Write;
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    for (name, bytes) in arrays {
        zip.start_file(format!("{name}.npy"), options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn compressed_arrays_are_read_and_say_how_many_bands_they_have() {
    let bench = Bench::new(&[1.0, 2.0, 3.0]);
    bench.0.write("square.obj", SQUARE_OBJ.replace("f 1/1 2/2 3/3 4/4", "f 1/1 2/2 3/3\nf 1/1 3/3 4/4"));
    let wavelength_um = || ("wavelength_um", npy("(3,)", &[1.0, 2.0, 3.0]));
    // [facet, band]: the south-eastern facet first; the other pixels are halved by the diagonal.
    bench.0.write("n.npz", npz(&[("raster", npy("(2, 3)", &[2.0, 4.0, 6.0, 8.0, 8.0, 8.0])), wavelength_um()]));
    let facets = format!("{HEAD}{PER_UM}placement = \"facets\"\n");
    let expected = [[8.0, 5.0, 5.0, 2.0], [8.0, 6.0, 6.0, 4.0], [8.0, 7.0, 7.0, 6.0]];
    assert_near(&bench.integrate("n.npz", &facets).0, expected.as_flattened());
    // [row, column, band], and as far as the wavelengths tell [band, row, column].
    let pixels: Vec<f64> = (0..12).map(f64::from).collect();
    bench.0.write("b.npz", npz(&[("raster", npy("(2, 2, 3)", &pixels)), wavelength_um()]));
    let atlas = format!("{HEAD}{PER_UM}{ATLAS}");
    let interleaved: Vec<f64> = (0..3).flat_map(|band| (0..4).map(move |i| f64::from(3 * i + band))).collect();
    assert_near(&bench.integrate("b.npz", &atlas).0, &interleaved);
    bench.0.write("b.npz", npz(&[("raster", npy("(3, 2, 2)", &pixels)), wavelength_um()]));
    let (image, said) = bench.integrate("b.npz", &atlas);
    assert_near(&image, &pixels);
    assert!(said.contains("taken as [band, row, column]"), "{said}");
    // A table of facets' radiance that says all of itself.
    let table = [("radiance_w_m2_sr_um", npy("(2, 3)", &[2.0, 4.0, 6.0, 8.0, 8.0, 8.0])), wavelength_um()];
    bench.0.write("t.npz", npz(&table));
    let (scene, file, out) = (bench.0.argument("scene.toml"), bench.0.argument("t.npz"), bench.0.argument("out"));
    assert_eq!(run(&["integrate", &scene, "--radiance", &file, "-o", &out, "--force", "--quiet"]).0, 0);
    // A promise of more than deflate can keep.
    let mut bomb = npz(&[("raster", npy("(2, 2)", &[0.0; 4]))]);
    let at = bomb.windows(4).rposition(|w| w == b"PK\x01\x02").unwrap() + 24;
    bomb[at..at + 4].copy_from_slice(&[0xff, 0xff, 0xff, 0x7f]);
    assert!(registry::image(&bench.0.write("c.npz", bomb)).is_err());
}

#[test]
fn other_formats_are_named_with_the_line_that_converts_them() {
    let folder = Scratch::new();
    for (name, bytes, what) in [
        ("t.nitf", &b"NITF02.10"[..], "NITF"),
        ("t.jp2", b"\0\0\0\x0cjP  \r\n\x87\n", "JPEG 2000"),
        ("t.img", b"EHFA_HEADER_TAG\0", "ERDAS Imagine"),
        ("t.vic", b"LBLSIZE=512", "VICAR"),
        ("nameless", b"\x0e\x03\x13\x01\0\0\0\0", "HDF4"),
    ] {
        folder.write(name, bytes);
        for command in [&["inspect"][..], &["convert"]] {
            let file = folder.argument(name);
            let out = folder.argument("o.npy");
            let mut all = command.to_vec();
            all.push(&file);
            if command[0] == "convert" {
                all.push(&out);
            }
            let (code, _, err) = run(&all);
            assert!(code == 1 && err.contains(what) && err.contains("gdal_translate -of ENVI"), "{name}: {err}");
        }
    }
}

/// Raw numbers may begin like anything: a header beside them with just as many says what they are.
#[test]
fn numbers_that_begin_like_another_format_are_numbers() {
    let bench = Bench::new(&[1.0]);
    let header = |more: &str| {
        format!("ENVI\nsamples = 16\nlines = 1\nbands = 1\ninterleave = bsq\nbyte order = 0\ndata type = 1\n{more}")
    };
    let marks: [&[u8]; 12] = [
        &[0xff, 0xd8, 0xff, 0xe0],
        &[0xff, 0x0a],
        &[0xff, 0x4f, 0xff, 0x51],
        &[0xff, 0xfe],
        b"II*\0",
        b"BM\x10\0\0\0\0\0\0\0",
        b"CDF\x01",
        b"PK\x03\x04",
        b"\x1f\x8b",
        b"\x89PNG\r\n\x1a\n",
        b"P5 ",
        b"{\"asset\":{}}",
    ];
    for (mark, name) in marks.iter().flat_map(|mark| ["a.img", "a.bil", "a"].map(|name| (mark, name))) {
        let mut bytes = [7_u8; 16];
        bytes[..mark.len()].copy_from_slice(mark);
        bench.0.write("a.hdr", header(""));
        let path = bench.0.write(name, bytes);
        let (code, out, err) = run(&["inspect", path.to_str().unwrap(), "--json"]);
        assert_eq!(code, 0, "{name}, {mark:?}: {err}");
        let facts: serde_json::Value = serde_json::from_str(&out).unwrap();
        let mean = bytes.iter().map(|b| f64::from(*b)).sum::<f64>() / 16.0;
        assert!((facts["statistics"][0]["mean"].as_f64().unwrap() - mean).abs() < 1e-9, "{mark:?}: {facts}");
        let (code, _, err) =
            run(&["convert", path.to_str().unwrap(), &bench.0.argument("b.npy"), "--dtype", "f64", "--force"]);
        assert_eq!(code, 0, "{name}, {mark:?}: {err}");
        let written = std::fs::read(bench.0.join("b.npy")).unwrap();
        let expected: Vec<u8> = bytes.iter().flat_map(|b| f64::from(*b).to_le_bytes()).collect();
        assert_eq!(written[written.len() - 128..], expected, "{mark:?}");
        std::fs::remove_file(path).unwrap();
    }
    // An image of another length is not of this header.
    bench.0.write("a.hdr", header(""));
    let path = bench.0.write("a.img", b"GIF89a and so on, as no header says");
    let (code, _, err) = run(&["inspect", path.to_str().unwrap()]);
    assert!(code == 1 && err.contains("GIF"), "{err}");
}
