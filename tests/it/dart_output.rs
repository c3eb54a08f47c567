//! DART's outputs as radiance maps: where texels lie and what they hold, against numbers worked out by hand, and damaged
//! outputs.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use mmxrt::formats::dart::output::{self, ImageQuantity, Output, OutputMapOptions, RegistrationMode};
use mmxrt::formats::dart::{self, ReadOptions, SceneOptions, SimulationOptions};
use mmxrt::geometry::{Eye, FrameCamera, Mesh, Pose};
use mmxrt::product::{Placement, RadianceMap, ViewImage};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::units::AU_M;

use crate::scenes::{self, edited, lambert};
use crate::scratch::{Scratch, edit};
use crate::shapes::{cuboid, direction, joined, quad};

/// A scene of a mesh, with what else there must be.
pub(crate) fn scene(mesh: Mesh, origin_m: DVec3) -> Scene {
    let rotation = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
    let world_from_sensor = Pose { rotation, translation_m: DVec3::new(0.0, 0.0, 1000.0) };
    let camera = FrameCamera::centred(world_from_sensor, 4, 4, 5e-3);
    let mut parts = scenes::parts(mesh, camera, direction([1.0, 0.0, 1.0]));
    parts.surface.origin_m = origin_m;
    parts.surface.materials = vec![lambert(0, "grey", Spectrum::constant(0.1))];
    parts.sky.sun.distance_m = AU_M;
    parts.check().unwrap()
}

/// DART's frame where x is South, y East, and the scene's origin is at (6, 8, 0).
fn pose() -> Pose {
    let rotation = DMat3::from_cols(DVec3::NEG_Y, DVec3::X, DVec3::Z);
    Pose { rotation, translation_m: rotation * DVec3::new(-6.0, -8.0, 0.0) }
}

/// Ground of 12 m (South) by 16 m (East), and a box 4 m high on it from (2, 4) to (6, 12) in DART's frame.
pub(crate) fn box_on_ground() -> Scene {
    let ground = quad([-8.0, -6.0, 0.0], [8.0, -6.0, 0.0], [8.0, 6.0, 0.0], [-8.0, 6.0, 0.0]);
    scene(joined(&[ground, cuboid([-4.0, 0.0, 0.0], [4.0, 4.0, 4.0])]), DVec3::ZERO)
}

/// A view as a map, without what is told of its place.
pub(crate) fn view_map(
    output: &Output,
    view: usize,
    scene: &Scene,
    options: &OutputMapOptions,
) -> mmxrt::Result<RadianceMap> {
    output.view_map(view, scene, options, &unwatched).map(|(map, _)| map)
}

pub(crate) fn options() -> OutputMapOptions {
    OutputMapOptions { scene_from_dart: Some(pose()), ..OutputMapOptions::default() }
}

/// An image as DART writes it.
pub(crate) struct Image<'a> {
    pub(crate) folder: &'a str,
    pub(crate) name: &'a str,
    pub(crate) number: u32,
    pub(crate) size: [usize; 2],
    pub(crate) pixel_m: f64,
    /// (first row, first column), (last, first), (last, last), (first, last), in DART's x and y.
    pub(crate) corners_m: [[f64; 2]; 4],
    pub(crate) values: Vec<f64>,
}

impl Image<'_> {
    fn write(&self, output: &Path) -> PathBuf {
        let folder = output.join(self.folder).join("IMAGES_DART");
        std::fs::create_dir_all(&folder).unwrap();
        let ([rows, columns], name) = (self.size, self.name);
        let (height_m, width_m) = (rows as f64 * self.pixel_m, columns as f64 * self.pixel_m);
        let header = format!(
            "[Ilwis]\nType=BaseMap\n\n[BaseMap]\nCoordBounds=0 -{width_m} {height_m} 0\nType=Map\n\n[Map]\nGeoRef={name}.grf\n\
             Size={rows} {columns}\nType=MapStore\n\n[MapStore]\nData={name}.mp#\nType=Real\nStructure=Line\nStartOffset=0\nRowLength={columns}\n"
        );
        std::fs::write(folder.join(format!("{name}.mpr")), header).unwrap();
        let bytes: Vec<u8> = self.values.iter().flat_map(|v| v.to_le_bytes()).collect();
        std::fs::write(folder.join(format!("{name}.mp#")), bytes).unwrap();
        let mut table = b"ILWIS 2.00 Table\r\n\x1a".to_vec();
        table.resize(128, 0);
        let last = [rows as i32, columns as i32];
        for (corner, [row, column]) in [(0, [1, 1]), (3, [1, last[1]]), (1, [last[0], 1]), (2, last)] {
            table.extend(self.corners_m[corner].iter().flat_map(|x| x.to_le_bytes()));
            table.extend([row, column, 2].iter().flat_map(|n: &i32| n.to_le_bytes()));
        }
        std::fs::write(folder.join(format!("{name}.gr#")), table).unwrap();
        let mut text = String::from("Ima  X1      Y1\n\t(same size as original image)\n");
        let numbers = self.corners_m.iter().flatten().fold(String::new(), |mut all, n| {
            write!(all, " {n:.6}").unwrap();
            all
        });
        write!(text, "{}{numbers}\n  {numbers}\n", self.number).unwrap();
        std::fs::write(folder.join("georef"), text).unwrap();
        folder
    }
}

const NAME: &str = "ima02_VZ=036_9_VA=090_0";

/// The box seen from the East, 36.87 deg from the zenith: sine 0.6, cosine 0.8. Its height displaces its top by 4 x 0.75 = 3 m,
/// so that the image begins at y = -3 m and has, with 16 rows of 1 m / 0.8, 20 m on the ground; columns run from x = 12 m to 0.
/// The value of row r, column c is r + c / 100.
pub(crate) fn oblique(folder: &str) -> Image<'_> {
    Image {
        folder,
        name: NAME,
        number: 2,
        size: [16, 12],
        pixel_m: 1.0,
        corners_m: [[12.0, -3.0], [12.0, 17.0], [0.0, 17.0], [0.0, -3.0]],
        values: (0..16 * 12).map(|i| f64::from(i / 12) + f64::from(i % 12) / 100.0).collect(),
    }
}

const PROPERTIES: &str = "maket.lowerCorner.z:0\nphase.nbSpectralBands:2\ndart.products.image0.teta:36.869898\ndart.products.image0.phi:90.000000\n\
     dart.products.image0.imageNamePrefix:ima02\ndart.products.image0.isSensorImage:0\ndart.band0.lambdaMin:0.62000000000000\n\
     dart.band0.lambdaMax:0.75000000000000\ndart.band0.BOA.irradiance:852.000000\nphase.band1.lambdamin:9\nphase.band1.lambdamax:11\n\
     dart.band1.equivalentWavelength:9.9\n";

/// A simulation's `output` with an oblique image in a folder.
pub(crate) fn output_with(scratch: &Scratch, image: &Image<'_>) -> PathBuf {
    let output = scratch.join("output");
    std::fs::create_dir_all(&output).unwrap();
    std::fs::write(output.join("simulation.properties.txt"), PROPERTIES).unwrap();
    image.write(&output);
    output
}

fn view_of(map: &RadianceMap) -> &ViewImage {
    match &map.placement {
        Placement::View(view) => view,
        other => panic!("{other:?}"),
    }
}

fn near(a: [f64; 2], b: [f64; 2]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
}

#[test]
fn an_oblique_image_lands_on_the_faces_that_it_shows() {
    let scratch = Scratch::new();
    output_with(&scratch, &oblique("BAND0/BRF/ITER3"));
    let output = output::open(scratch.path()).unwrap();
    let [view] = output.views() else { panic!("{:?}", output.views()) };
    assert_eq!((view.name.as_str(), view.quantity, view.iteration.as_str()), (NAME, ImageQuantity::Brf, "ITER3"));
    assert_eq!(view.towards_deg, [36.869898, 90.0]);
    let scene = box_on_ground();
    let mut map = view_map(&output, 0, &scene, &options()).unwrap();
    let image = view_of(&map).clone();
    assert_eq!((image.size(), image.occlusion, map.weight), ([12, 16], true, 1.0));
    // y of DART is East, the scene's x.
    let Eye::Towards(towards) = image.camera.eye() else { panic!("{:?}", image.camera) };
    assert!((towards.vec() - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-8);
    // Row: 0.8 (y + 3) - 0.6 z; column: 12 - x.
    for (dart_m, column, row) in [
        ([12.0, -3.0, 0.0], 0.0, 0.0),
        ([0.0, 0.0, 0.0], 12.0, 2.4),
        // The top: its far edge, then the near one, where the front face begins.
        ([2.0, 4.0, 4.0], 10.0, 3.2),
        ([6.0, 12.0, 4.0], 6.0, 9.6),
        // The front face's lower edge.
        ([6.0, 12.0, 0.0], 6.0, 12.0),
        ([2.0, 12.0, 0.0], 10.0, 12.0),
    ] {
        let at = image.camera.projection().at(pose().point(DVec3::from_array(dart_m)));
        assert!(near(at, [column, row]), "{dart_m:?}: {at:?}");
    }
    // What lies on one line of sight is at one place: the far corner of the top, and the ground 3 m behind it.
    let [top, ground] =
        [[2.0, 4.0, 4.0], [2.0, 1.0, 0.0]].map(|p| image.camera.projection().at(pose().point(DVec3::from_array(p))));
    assert!(near(top, ground));

    assert_eq!(map.source.bands()[0].centre_um, 0.685);
    assert!((map.source.bands()[0].fwhm_um.unwrap() - 0.13).abs() < 1e-15);
    let mut values = vec![1.0; 3];
    map.source.read(0, &mut values).unwrap();
    assert_eq!(values.len(), 16 * 12);
    // The middle of the top, (4, 8, 4): row 6.4, column 8: BRF 6.08, on 852 W m-2 um-1.
    let [column, row] =
        image.camera.projection().at(pose().point(DVec3::new(4.0, 8.0, 4.0))).map(|x| (x + 1e-6).floor() as usize);
    assert_eq!((row, column), (6, 8));
    assert!((values[row * 12 + column] - 6.08 * 852.0 / PI).abs() < 1e-12);
    assert!((values[row * 12 + column] - 1_648.896_140_013_8).abs() < 1e-6);
}

#[test]
fn a_scene_11_m_high_is_displaced_by_4_53_m() {
    // 30 m by 33 m, 11 m high, seen at 22.404906 deg from azimuth 90 deg: 11 tan = 4.534975; 36 / cos = 38.939403 m of ground
    // in 36 rows.
    let scratch = Scratch::new();
    let image = Image {
        folder: "BAND0/BRF/ITERX",
        name: "ima002_VZ=022_4_VA=090_0",
        number: 2,
        size: [36, 31],
        pixel_m: 1.0,
        corners_m: [[30.0, -4.534_975], [30.0, 34.404_428], [-1.0, 34.404_428], [-1.0, -4.534_975]],
        values: vec![0.5; 36 * 31],
    };
    let output = output_with(&scratch, &image);
    let properties = output.join("simulation.properties.txt");
    edit(&properties, "36.869898", "22.404906");
    edit(&properties, "products.image0", "product.image17");
    edit(&properties, "ima02", "ima002");
    let pose = Pose { translation_m: DVec3::ZERO, ..pose() };
    let scene = scene(cuboid([4.0, -16.0, 0.0], [29.0, -2.0, 10.0]), DVec3::ZERO);
    let map = output::open(&output).unwrap();
    let map =
        view_map(&map, 0, &scene, &OutputMapOptions { scene_from_dart: Some(pose), ..OutputMapOptions::default() })
            .unwrap();
    let texel = |dart_m: [f64; 3]| view_of(&map).camera.projection().at(pose.point(DVec3::from_array(dart_m)));
    assert!(near(texel([30.0, 0.0, 11.0]), [0.0, 0.0]), "{:?}", texel([30.0, 0.0, 11.0]));
    assert!(near(texel([30.0, -4.534_975, 0.0]), [0.0, 0.0]));
    assert!(near(texel([-1.0, 34.404_428, 0.0]), [31.0, 36.0]));
    assert!(near(texel([9.0, 33.0, 0.0]), [21.0, (33.0 + 4.534_975) * 22.404_906_f64.to_radians().cos()]));
}

#[test]
fn temperatures_and_radiances_are_radiance() {
    let scratch = Scratch::new();
    let nothing = |i: usize, v: f64| {
        if i == 0 {
            -1.0
        } else if i == 1 {
            f64::NAN
        } else {
            v
        }
    };
    let filled = |folder, value: f64| {
        let mut image = oblique(folder);
        image.values = (0..16 * 12).map(|i| nothing(i, value)).collect();
        image
    };
    let output = output_with(&scratch, &filled("BAND1/Tapp/ITER2", 300.0));
    filled("BAND0/Radiance/ITER2", 3.25).write(&output);
    filled("BAND1/Radiance/ITER2", 4.5).write(&output);
    let output = output::open(&output).unwrap();
    let found: Vec<_> =
        output.views().iter().map(|v| (v.quantity, v.bands.iter().map(|b| b.number).collect())).collect();
    assert_eq!(found, [(ImageQuantity::Tapp, vec![1]), (ImageQuantity::Radiance, vec![0, 1])]);
    let mut values = Vec::new();
    let scene = box_on_ground();
    // What has no value here is no outline.
    let printed = OutputMapOptions { placing: RegistrationMode::Shifted([0.0; 2]), ..options() };
    let mut map = view_map(&output, 0, &scene, &printed).unwrap();
    map.source.read(0, &mut values).unwrap();
    assert!(values[0].is_nan() && values[1].is_nan());
    // Planck at 9.9 um and 300 K: 2 h c^2 / l^5 / (exp(14387.768775 / 2970) - 1) = 1.191042972e8 / 9.9^5 / 126.0336.
    let exponential = (14_387.768_775_f64 / 2970.0).exp() - 1.0;
    assert!((values[2] / (1.191_042_972e8 / 9.9_f64.powi(5) / exponential) - 1.0).abs() < 1e-9, "{}", values[2]);
    let mut map = view_map(&output, 1, &scene, &printed).unwrap();
    assert_eq!(map.source.bands()[1], Band::boxed(10.0, 2.0));
    map.source.read(1, &mut values).unwrap();
    assert!(values[0].is_nan() && values[2] == 4.5);
}

#[test]
fn modes_tell_what_light_bands_hold() {
    let scratch = Scratch::new();
    let output = output_with(&scratch, &oblique("BAND0/Radiance/ITER2"));
    oblique("BAND1/Radiance/ITER2").write(&output);
    let light = |modes: &str| {
        std::fs::write(output.join("simulation.properties.txt"), format!("{PROPERTIES}{modes}")).unwrap();
        let opened = output::open(&output).unwrap();
        let map = view_map(&opened, 0, &box_on_ground(), &options()).unwrap();
        (map.light.iter().map(|l| (l.sunlight, l.heat)).collect::<Vec<_>>(), map.heat())
    };
    let (yes, no) = (Some(true), Some(false));
    assert_eq!(light("dart.band0.mode:T\ndart.band1.mode:R+T\n"), (vec![(no, yes), (yes, yes)], yes));
    assert_eq!(light("dart.band0.mode:R\ndart.band1.mode:R\n"), (vec![(yes, no), (yes, no)], no));
    assert_eq!(light("dart.band0.mode:R\n"), (vec![(yes, no), (None, None)], None));
}

#[test]
fn the_last_iteration_is_taken_unless_another_is_named() {
    let scratch = Scratch::new();
    let output = output_with(&scratch, &oblique("BAND0/BRF/ITER9"));
    let images = oblique("BAND0/BRF/ITER10").write(&output);
    let iteration = |path: &Path| output::open(path).unwrap().views()[0].iteration.clone();
    assert_eq!(iteration(scratch.path()), "ITER10");
    assert_eq!(iteration(&output.join("BAND0/BRF/ITER9")), "ITER9");
    assert_eq!(iteration(&images), "ITER10");
    assert_eq!(iteration(&images.join(format!("{NAME}.mpr"))), "ITER10");
    oblique("BAND0/BRF/ITERX").write(&output);
    assert_eq!(iteration(&output), "ITERX");
    // Another band without it.
    oblique("BAND1/BRF/ITER10").write(&output);
    let error = output::open(&output).unwrap_err().to_string();
    assert!(error.contains("BAND1") && error.contains("has no ITERX"), "{error}");
    let error = output::open(&scratch.join("nothing")).unwrap_err();
    assert!(matches!(error, mmxrt::Error::Io { .. }));
    std::fs::create_dir_all(output.join("BAND0/BRF/ITER1")).unwrap();
    let error = output::open(&output.join("BAND0/BRF/ITER1")).unwrap_err().to_string();
    assert!(error.contains("holds no images"), "{error}");
    std::fs::remove_file(output.join("simulation.properties.txt")).unwrap();
    let error = output::open(scratch.path()).unwrap_err().to_string();
    assert!(error.contains("holds simulation.properties.txt") && error.contains("help"), "{error}");
}

#[test]
fn the_name_tells_the_direction_if_the_properties_do_not() {
    let scratch = Scratch::new();
    let output = output_with(&scratch, &oblique("BAND0/BRF/ITER3"));
    edit(&output.join("simulation.properties.txt"), ":ima02", ":ima77");
    let opened = output::open(&output).unwrap();
    assert_eq!(opened.views()[0].towards_deg, [36.9, 90.0]);
    // 0.0301 deg more than the corners were made for: within what a name tells.
    view_map(&opened, 0, &box_on_ground(), &options()).unwrap();
    // A camera's image is none of ours.
    let mut camera = oblique("BAND0/BRF/ITER3");
    camera.name = "ima_camera001";
    camera.write(&output);
    let opened = output::open(&output).unwrap();
    assert_eq!((opened.views().len(), opened.passed_over()), (1, &["ima_camera001".to_owned()][..]));
    // What else lies there is told by name: of all bands as one.
    for folder in ["2_Ground/BRF", "BAND0/BRF/ITER1/IMAGES_DART", "BAND0/Tau"] {
        std::fs::create_dir_all(output.join(folder)).unwrap();
    }
    std::fs::write(output.join("brf_Iter3"), "").unwrap();
    let opened = output::open(&output).unwrap();
    assert_eq!(opened.passed_over(), ["ima_camera001", "2_Ground/", "BAND*/BRF/ITER1/", "BAND*/Tau/", "brf_Iter3"]);
    let mut nameless = oblique("BAND0/BRF/ITER3");
    nameless.name = "ima05";
    nameless.write(&output);
    let error = output::open(&output).unwrap_err().to_string();
    assert!(error.contains("ima05.mpr: from where it was seen is not known"), "{error}");
}

#[test]
fn damaged_images_are_told_at_their_place() {
    let scene = box_on_ground();
    let folder = "BAND0/BRF/ITER3";
    let error = |damage: &dyn Fn(&Path, &Path)| {
        let scratch = Scratch::new();
        let output = output_with(&scratch, &oblique(folder));
        damage(&output, &output.join(folder).join("IMAGES_DART").join(NAME));
        let output = output::open(&output).unwrap();
        match view_map(&output, 0, &scene, &options()) {
            Err(error) => error.to_string(),
            Ok(mut map) => map.source.read(0, &mut Vec::new()).unwrap_err().to_string(),
        }
    };
    let says = |error: String, wanted: &[&str]| {
        assert!(wanted.iter().all(|w| error.contains(w)), "{error}");
    };
    let with = |image: &Path, extension: &str| image.with_file_name(format!("{NAME}.{extension}"));
    let delete = |image: &Path, extension: &str| std::fs::remove_file(with(image, extension)).unwrap();
    let delete_georef = |image: &Path| std::fs::remove_file(image.with_file_name("georef")).unwrap();
    says(
        error(&|_, image| {
            std::fs::write(with(image, "mp#"), [0; 100]).unwrap();
            delete_georef(image);
            delete(image, "gr#");
        }),
        &["mp#: holds 100 bytes where 1536 (16 rows x 12 columns x 8 bytes)"],
    );
    says(
        error(&|_, image| {
            delete_georef(image);
            delete(image, "gr#");
        }),
        &["gr#: the image's corners are not known", "IMAGES_DART"],
    );
    // Rows and columns exchanged in the header.
    let swap = |image: &Path| {
        edit(&with(image, "mpr"), "Size=16 12", "Size=12 16");
        edit(&with(image, "mpr"), "RowLength=12", "RowLength=16");
        edit(&with(image, "mpr"), "0 -12 16 0", "0 -16 12 0");
    };
    says(error(&|_, image| swap(image)), &["gr#: a corner at row 1, column 12 where row 1, column 16 belongs"]);
    says(
        error(&|_, image| {
            swap(image);
            delete(image, "gr#");
        }),
        &["georef:3: the corners span 20.000000 m by 12.000000 m", "12 rows and 16 columns"],
    );
    // Corners in another order.
    says(
        error(&|_, image| {
            delete(image, "gr#");
            let line = " 12.000000 17.000000 0.000000 17.000000 0.000000 -3.000000";
            edit(&image.with_file_name("georef"), line, " 0.000000 -3.000000 0.000000 17.000000 12.000000 17.000000");
        }),
        &["georef:3: the corners span 12.000000 m by 20.000000 m", "rows and columns are swapped"],
    );
    // Seen from elsewhere than the corners were made for.
    says(
        error(&|output, _| edit(&output.join("simulation.properties.txt"), "phi:90", "phi:91")),
        &["gr#: the corners span", "azimuth 91 deg"],
    );
    says(
        error(&|output, _| edit(&output.join("simulation.properties.txt"), "dart.band0.BOA", "dart.band0.BOB")),
        &["simulation.properties.txt: has no `dart.band<n>.BOA.irradiance` of bands 0", "irradiance_w_m2_um"],
    );
    says(
        error(&|output, _| edit(&output.join("simulation.properties.txt"), "852.000000", "bright")),
        &["simulation.properties.txt:9 dart.band0.BOA.irradiance: `bright` is not a finite number"],
    );
    for (bad, text) in [(-0.5, "-0.5 is not a value"), (f64::INFINITY, "inf is not a value"), (-1.5, "(one of 2)")] {
        says(
            error(&|output, _| {
                let mut image = oblique(folder);
                (image.values[12 + 5], image.values[100]) = (bad, if bad == -1.5 { bad } else { 0.0 });
                image.write(output);
            }),
            &["mp# row 1, column 5: ", text],
        );
    }
    says(
        error(&|output, image| {
            delete(image, "gr#");
            delete_georef(image);
            edit(&output.join("simulation.properties.txt"), "852.000000", "-3");
        }),
        &["corners are not known", "an irradiance of -3"],
    );
}

#[test]
fn a_map_that_is_elsewhere_is_refused() {
    let scratch = Scratch::new();
    let output = output::open(&output_with(&scratch, &oblique("BAND0/BRF/ITER3"))).unwrap();
    let scene = box_on_ground();
    let mut far = options();
    far.scene_from_dart.as_mut().unwrap().translation_m.x += 40.0;
    let error = view_map(&output, 0, &scene, &far).unwrap_err().to_string();
    assert!(error.contains("does not overlap the scene") && error.contains("scene_from_dart"), "{error}");
    // Without inputs beside it, where it lies must be said.
    let error = view_map(&output, 0, &scene, &OutputMapOptions::default()).unwrap_err().to_string();
    assert!(error.contains("is not next to its `output`") && error.contains("origin_in_dart_m"), "{error}");
    assert!(view_map(&output, 1, &scene, &options()).unwrap_err().to_string().contains("no view 1"));
    for wrong in [vec![], vec![1.0, 2.0], vec![-1.0], vec![f64::NAN]] {
        let options = OutputMapOptions { irradiance_w_m2_um: Some(wrong), ..options() };
        assert!(view_map(&output, 0, &scene, &options).unwrap_err().to_string().contains("1 irradiances belong"));
    }
    // Given irradiances, and a shift.
    let given = OutputMapOptions {
        irradiance_w_m2_um: Some(vec![PI]),
        placing: RegistrationMode::Shifted([1.0, 0.5]),
        ..options()
    };
    let mut map = view_map(&output, 0, &scene, &given).unwrap();
    assert!(near(view_of(&map).camera.projection().at(pose().point(DVec3::new(6.0, 12.0, 0.0))), [7.0, 12.5]));
    let mut values = Vec::new();
    map.source.read(0, &mut values).unwrap();
    assert!((values[13] - 1.01).abs() < 1e-15);
}

/// A box of 11 m (South), 7 m (East) and 4 m (up), at longitude 90 deg on the equator: South is -z, East -x, up +y. In whole
/// cells of 1 m that is 12 m by 8 m by 5 m: half a metre of margin, so that the box's corner (4, 4, 6) is at (0.5, 0.5, 4.5) in
/// DART's frame.
fn made() -> Scene {
    scene(cuboid([-3.0, 0.0, -5.0], [4.0, 4.0, 6.0]), DVec3::new(0.0, 11e3, 0.0))
}

fn write_simulation(folder: &Path) {
    let (package, _) =
        dart::from_scene(&made(), &SimulationOptions { cell_m: Some(1.0), ..SimulationOptions::default() }).unwrap();
    dart::write(&package, folder, false, &unwatched).unwrap();
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_scene_that_was_made_of_the_simulation_lies_where_it_was_read() {
    let scratch = Scratch::new();
    let folder = scratch.join("simulation");
    write_simulation(&folder);
    std::fs::remove_file(folder.join("mmxrt.toml")).unwrap();
    let reading = ReadOptions::default();
    let (simulation, _, _) = dart::read(&folder, &reading).unwrap();
    // The middle of the ground, (6, 4, 0), is the origin: at the body's centre x is East, y North; at longitude 90 deg as
    // above.
    for (origin_m, corner_m) in
        [(None, DVec3::new(-3.5, 5.5, 4.5)), (Some(DVec3::new(0.0, 11e3, 0.0)), DVec3::new(3.5, 4.5, 5.5))]
    {
        let options = SceneOptions { origin_m, ..SceneOptions::default() };
        let read = dart::to_scene(&simulation, &reading.folder(&folder), &options, &unwatched).unwrap().scene;
        let pose = dart::scene_from_dart(&simulation, &reading.folder(&folder), &read).unwrap();
        assert!((pose.point(DVec3::new(0.5, 0.5, 4.5)) - corner_m).length() < 1e-12, "{pose:?}");
        assert!(read.body.mesh.vertices_m.iter().any(|v| (*v - corner_m).length() < 1e-12));
    }
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_simulation_that_was_made_of_the_scene_lies_where_it_was_written() {
    let scratch = Scratch::new();
    let (made, folder) = (made(), scratch.join("simulation"));
    write_simulation(&folder);
    let reading = ReadOptions::default();
    let (simulation, _, _) = dart::read(&folder, &reading).unwrap();
    let pose = dart::scene_from_dart(&simulation, &reading.folder(&folder), &made).unwrap();
    // The corner (4, 4, 6) of the box is at (0.5, 0.5, 4.5): it minus the origin, turned.
    assert!((pose.point(DVec3::ZERO) - DVec3::new(4.5, -0.5, 6.5)).length() < 1e-12, "{:?}", pose.point(DVec3::ZERO));
    assert!((pose.vector(DVec3::new(1.0, 2.0, 3.0)) - DVec3::new(-2.0, 3.0, -1.0)).length() < 1e-12);
    // Another scene is not silently put there.
    let other = edited(&made, |scene| scene.surface.origin_m = DVec3::new(0.0, 12e3, 0.0));
    let error = dart::scene_from_dart(&simulation, &reading.folder(&folder), &other).unwrap_err().to_string();
    assert!(error.contains("mmxrt.toml") && error.contains("origin"), "{error}");

    // The scene from above, 12 rows South by 8 columns East: what is at the scene's corner is at the image's.
    let image = Image {
        folder: "BAND0/Radiance/ITER1",
        name: "ima01_VZ=000_0_VA=000_0",
        number: 1,
        size: [12, 8],
        pixel_m: 1.0,
        corners_m: [[0.0, 0.0], [12.0, 0.0], [12.0, 8.0], [0.0, 8.0]],
        values: vec![1.0; 96],
    };
    std::fs::create_dir_all(folder.join("output")).unwrap();
    std::fs::write(folder.join("output/simulation.properties.txt"), PROPERTIES).unwrap();
    image.write(&folder.join("output"));
    let map = view_map(&output::open(&folder).unwrap(), 0, &made, &OutputMapOptions::default()).unwrap();
    assert!(near(view_of(&map).camera.projection().at(DVec3::new(4.0, 4.0, 6.0)), [0.5, 0.5]));
    assert!(near(view_of(&map).camera.projection().at(DVec3::new(-3.0, 0.0, -5.0)), [7.5, 11.5]));
}

/// A triangle, or a parallelogram, of DART's, by three corners.
fn record(is_quad: bool, corners_m: [[f64; 3]; 3]) -> Vec<u8> {
    let mut bytes = vec![u8::from(is_quad)];
    bytes.extend(corners_m.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes.resize(102, 0);
    bytes
}

/// DART's surfaces: the ground, the western and the eastern half of the box's top, and a triangle of 2 m2 in the air.
fn records() -> [Vec<u8>; 4] {
    [
        record(true, [[0.0, 16.0, 0.0], [0.0, 0.0, 0.0], [12.0, 0.0, 0.0]]),
        record(true, [[2.0, 8.0, 4.0], [2.0, 4.0, 4.0], [6.0, 4.0, 4.0]]),
        record(true, [[2.0, 12.0, 4.0], [2.0, 8.0, 4.0], [6.0, 8.0, 4.0]]),
        record(false, [[0.0, 2.0, 9.0], [0.0, 0.0, 9.0], [2.0, 0.0, 9.0]]),
    ]
}

const FIGURES: &str =
    "* Intercepted\tScattered\tEmitted\tAbsorbed\n10\t3\t0.5\t7\n10\t2\t0\t8\n20\t4\t0\t16\n1\t0.5\t0\t0.5\n";

fn output_with_budget(scratch: &Scratch, units: &str) -> PathBuf {
    let output = scratch.join("output");
    let folder = output.join("BAND0/RADIATIVE_BUDGET/ITERX");
    std::fs::create_dir_all(&folder).unwrap();
    let properties = format!("{PROPERTIES}maket.nbOfTriangles:4\ndart.products.RadiativeBudget.units:{units}\n");
    std::fs::write(output.join("simulation.properties.txt"), properties).unwrap();
    std::fs::write(output.join("triangles.txt"), records().concat()).unwrap();
    std::fs::write(folder.join("RadiativeBudgetFigures.txt"), FIGURES).unwrap();
    output
}

#[test]
fn the_budget_of_triangles_is_on_the_facets_they_lie_on() {
    let scene = box_on_ground();
    // Exitances 3.5, 2, 4, 0.5, over pi: as they are, times the irradiance, or over areas of 192, 16, 16 and 2 m2.
    for (units, factor) in [("0", [852.0; 4]), ("1", [1.0; 4]), ("2", [1.0 / 192.0, 1.0 / 16.0, 1.0 / 16.0, 0.5])] {
        let scratch = Scratch::new();
        let output = output::open(&output_with_budget(&scratch, units)).unwrap();
        assert!(output.views().is_empty() && output.budget()[0].number == 0);
        let (mut map, mismatch) = output.budget_map(&scene, &options()).unwrap();
        let mut values = Vec::new();
        map.source.read(0, &mut values).unwrap();
        let expected: Vec<f64> = [3.5, 2.0, 4.0, 0.5].iter().zip(factor).map(|(m, f)| m * f / PI).collect();
        assert!(values.iter().zip(&expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-15), "{values:?} {expected:?}");
        // Ground 192, top 32, sides 96, bottom 32 m2, of which DART has ground and top.
        let found = [mismatch.facets_m2, mismatch.all_facets_m2, mismatch.triangles_m2, mismatch.all_triangles_m2];
        assert!(found.iter().zip([128.0, 352.0, 2.0, 226.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        let Placement::Patches(patches) = &map.placement else { panic!("{:?}", map.placement) };
        let mut area_m2 = [0.0; 4];
        for (i, polygon) in patches.polygon_start.windows(2).enumerate() {
            let facet = scene.body.mesh.facet(patches.polygon_facet[i] as usize);
            let uv = &patches.uv[polygon[0]..polygon[1]];
            let twice: f64 =
                (0..uv.len()).map(|k| (uv[k], uv[(k + 1) % uv.len()])).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
            area_m2[patches.polygon_texel[i] as usize] += twice * facet.area_m2();
            // West of the box's middle, x = 0 of the scene, is texel 1.
            let middle: f64 = uv.iter().map(|[u, v]| facet.point_m(*u, *v).x).sum();
            assert!(facet.centroid_m().z < 4.0 || (middle < 0.0) == (patches.polygon_texel[i] == 1));
        }
        assert_eq!(patches.texels, 4);
        assert!(area_m2.iter().zip([192.0, 16.0, 16.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{area_m2:?}");
    }
}

#[test]
fn damaged_budgets_are_told_at_their_place() {
    let scene = box_on_ground();
    let error = |damage: &dyn Fn(&Path, &Path)| {
        let scratch = Scratch::new();
        let output = output_with_budget(&scratch, "1");
        damage(&output, &output.join("BAND0/RADIATIVE_BUDGET/ITERX/RadiativeBudgetFigures.txt"));
        match output::open(&output).unwrap().budget_map(&scene, &options()) {
            Err(error) => error.to_string(),
            Ok((mut map, _)) => map.source.read(0, &mut Vec::new()).unwrap_err().to_string(),
        }
    };
    let triangles = |output: &Path, bytes: Vec<u8>| std::fs::write(output.join("triangles.txt"), bytes).unwrap();
    let says = |error: String, wanted: &str| assert!(error.contains(wanted), "{error}");
    says(error(&|output, _| triangles(output, vec![0; 103])), "triangles.txt: holds 103 bytes, no whole number");
    says(error(&|output, _| triangles(output, records()[..3].concat())), "triangles.txt: holds 3 triangles");
    says(
        error(&|output, _| {
            let mut nan = records();
            nan[2][9..17].fill(0xff);
            triangles(output, nan.concat());
        }),
        "triangle 2 (from 0): no corners",
    );
    says(
        error(&|output, _| {
            let [a, b, c, _] = records();
            triangles(output, [a, b.clone(), b, c].concat());
        }),
        "facets of the scene are covered more often than once",
    );
    says(
        error(&|_, figures| edit(figures, "\n20\t4\t0\t16", "")),
        "Figures.txt: holds 3 triangles, triangles.txt has 4",
    );
    says(error(&|_, figures| edit(figures, "20\t4", "20\t-4")), "Figures.txt:4: 4 numbers, not negative");
    says(error(&|_, figures| edit(figures, "10\t2\t0\t8", "10\t2\t0")), "Figures.txt:3: 4 numbers");
    says(error(&|_, figures| edit(figures, "Emitted", "Sent")), "Figures.txt:2: no column Emitted");
    says(error(&|_, figures| edit(figures, "* Inter", "Inter")), "Figures.txt:1: no line `* ... Scattered");
    says(error(&|_, figures| edit(figures, "10\t2", "ObjectName object0_0_0\n10\t2")), "grouped by objects (DART-Lux)");
    let properties = "simulation.properties.txt";
    says(error(&|output, _| edit(&output.join(properties), "units:1", "units:7")), "`7` is not a known unit");
    says(
        error(&|output, _| edit(&output.join(properties), "units:", "unit:")),
        "unit of the radiative budget is not said",
    );
    says(
        error(&|output, _| {
            edit(&output.join(properties), "units:1", "units:0");
            edit(&output.join(properties), "BOA", "BOB");
        }),
        "has no `dart.band0.BOA.irradiance`",
    );
    // Sunlight only: there is no emission to miss.
    let scratch = Scratch::new();
    let output = output_with_budget(&scratch, "1");
    edit(&output.join(properties), "units:1", "units:1\ndart.band0.mode:R");
    edit(&output.join("BAND0/RADIATIVE_BUDGET/ITERX/RadiativeBudgetFigures.txt"), "Emitted", "Sent");
    let opened = output::open(&output).unwrap();
    let mut values = Vec::new();
    opened.budget_map(&scene, &options()).unwrap().0.source.read(0, &mut values).unwrap();
    assert_eq!(values[0], 3.0 / PI);
    let mut far = options();
    far.scene_from_dart.as_mut().unwrap().translation_m.z += 1.0;
    says(opened.budget_map(&scene, &far).unwrap_err().to_string(), "do not overlap");
    let scratch = Scratch::new();
    let images = output::open(&output_with(&scratch, &oblique("BAND0/BRF/ITER3"))).unwrap();
    says(images.budget_map(&scene, &options()).unwrap_err().to_string(), "holds no radiative budget");
}

#[test]
fn inspecting_an_output_lists_views_and_bands() {
    let scratch = Scratch::new();
    output_with(&scratch, &oblique("BAND0/BRF/ITER3"));
    let (code, out, err) = crate::cli::run(&["inspect", scratch.path().to_str().unwrap()]);
    assert_eq!(code, 0, "{err}");
    for wanted in ["kind: DART output", NAME, "bands [0]", "iteration ITER3", "quantity BRF", "um 0.685"] {
        assert!(out.contains(wanted), "{wanted}: {out}");
    }
}
