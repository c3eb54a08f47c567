//! Further sources: light adds up, each with its own shadows, spectrum and heat.

use glam::DVec3;
use mmxrt::geometry::{Direction, Mesh, Texels};
use mmxrt::integrate::Wanted;
use mmxrt::product::Sees;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Beam, Scene, Sky, Sun, Texture, TextureKind, Thermal};
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::units::AU_M;
use mmxrt::{Error, solve, study};

use crate::maps::observe;
use crate::scenes::{edited, scene};
use crate::shapes::{camera, cuboid, direction, grid, joined, nadir, of_material, plane};

const SUN_W_M2: f64 = 1361.0 / 2.25;

fn beam(name: &str, towards: [f64; 3], irradiance: Spectrum) -> Beam {
    Beam { name: name.into(), direction: direction(towards), irradiance, total_irradiance_w_m2: SUN_W_M2 }
}

/// Hills and two boxes, seen askance, in three bands, 40 % of the ground under a texture.
fn site(towards_sun: [f64; 3]) -> Scene {
    let hills = grid(10.0, 30, |x, y| (0.7 * x).sin() * (0.5 * y).cos());
    let mesh = joined(&[hills, cuboid([-3.0, -2.0, -1.0], [0.0, 1.0, 4.0]), cuboid([2.0, 3.0, -1.0], [3.0, 6.0, 3.0])]);
    let view = camera([20.0, -30.0, 40.0], [0.0; 3], [0.0, 0.0, 1.0], 24, 0.02);
    let plain = scene(of_material(mesh, 0), view, towards_sun);
    edited(&plain, |parts| {
        parts.exposure.bands = [1.0, 1.5, 2.0].map(|centre_um| Band::new(centre_um, Some(0.1))).to_vec();
        parts.surface.materials[0].reflectance =
            Spectrum::new(vec![0.5, 1.4, 3.0], vec![0.05, 0.2, 0.1], mmxrt::spectral::Extend::Error).unwrap();
        let mesh = &parts.surface.mesh;
        let texel = |p: DVec3| [2.0 * p.x + 8.0, 2.0 * p.y + 9.0];
        let corners = (0..mesh.facets.len()).map(|f| mesh.facet(f).corners_m.map(texel)).collect();
        parts.surface.textures = vec![Texture {
            material: mmxrt::geometry::MaterialId(0),
            kind: TextureKind::Factor,
            corners,
            rows: 20,
            columns: 16,
            wavelength_um: vec![],
            values: (0..320).map(|i| f64::from((i * 7) % 11) / 11.0).collect(),
            texels: Texels::Nearest,
            lon_lat: None,
        }];
    })
}

fn cube(scene: &Scene) -> Vec<Vec<f64>> {
    let (_, seen) = study::simulate(scene, &unwatched).unwrap();
    (0..seen.cube.axes.bands.len()).map(|band| seen.cube.band(band)).collect()
}

/// Two suns light what each of them lights: the second has the first one's spectrum at 1.5 au, or a share of it.
#[test]
fn light_of_several_sources_adds_up() {
    let (one, other) = ([1.0, 0.2, 0.4], [-0.3, -1.0, 0.5]);
    let (first, second) = (cube(&site(one)), cube(&site(other)));
    let at_the_scene = |share: f64| Spectrum::constant(share * 700.0 / 2.25);
    let both = edited(&site(one), |parts| {
        parts.sky.beams = vec![beam("second", other, at_the_scene(0.75)), beam("third", other, at_the_scene(0.25))];
    });
    let both = cube(&both);
    let largest = both.iter().flatten().copied().fold(0.0, f64::max);
    let mut compared = 0;
    for band in 0..3 {
        for pixel in 0..24 * 24 {
            let sum = first[band][pixel] + second[band][pixel];
            assert!((both[band][pixel] - sum).abs() < 1e-13 * largest, "{band} {pixel}: {} {sum}", both[band][pixel]);
            compared += usize::from(first[band][pixel] > 0.0 && second[band][pixel] > 0.0);
        }
    }
    assert!(compared > 300, "{compared}");
}

#[test]
fn what_maps_do_not_know_has_the_light_of_all_sources() {
    // A map that knows nothing at all: the image is the scene's own.
    let lit = edited(&site([1.0, 0.2, 0.4]), |parts| {
        parts.surface.textures.clear();
        parts.exposure.bands.truncate(1);
        parts.exposure.bands[0] = Band::new(1.0, None);
        parts.sky.beams = vec![beam("second", [-0.3, -1.0, 0.5], Spectrum::constant(200.0))];
    });
    let own = cube(&lit).remove(0);
    let facets = lit.body.mesh.facets.len();
    let map = crate::maps::map(mmxrt::product::Placement::Facets(facets), vec![f64::NAN; facets]);
    let options = study::MapOptions { fill: study::Fill::Solved, ..study::MapOptions::default() };
    let (filled, _) = observe(&lit, vec![vec![map]], &options).unwrap();
    crate::partly_sky::assert_near(&filled.cube.band(0), &own, 1e-13 * own.iter().copied().fold(0.0, f64::max));
}

#[test]
fn a_table_may_say_shares_and_knows_its_sources() {
    let ground = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), [0.0, 0.6, 0.8]);
    let lit = edited(&ground, |parts| parts.sky.beams = vec![beam("lamp", [0.6, 0.0, 0.8], Spectrum::constant(100.0))]);
    let mut table = solve::solve(&lit, &unwatched).unwrap();
    assert_eq!(table.sources.iter().map(|s| s.source.as_str()).collect::<Vec<_>>(), ["sun", "lamp"]);
    assert!(table.of("lamp").unwrap().irradiance.iter().all(|cos| (cos - 0.8).abs() < 1e-15));
    table.sources[1].sees = Sees::Shares(vec![0.25; 2]);
    let seen = study::observe(&lit, &table, Wanted::default(), &unwatched).unwrap();
    let expected = 0.07 / std::f64::consts::PI * (0.8 * 700.0 / 2.25 + 0.25 * 0.8 * 100.0);
    assert!(seen.cube.band(0).iter().all(|l| (l / expected - 1.0).abs() < 1e-13), "{:?}", seen.cube.band(0));
    // A sky without the lamp has no use for its column.
    let error = study::observe(&ground, &table, Wanted::default(), &unwatched).unwrap_err().to_string();
    assert!(error.contains("lamp_irradiance: has 2 values, but the scene needs 0"), "{error}");
    let mut doubled = table.clone();
    doubled.sources.push(table.sources[1].clone());
    let error = study::observe(&lit, &doubled, Wanted::default(), &unwatched).unwrap_err().to_string();
    assert!(error.contains("lamp: appears twice"), "{error}");
    let scratch = crate::scratch::Scratch::new();
    mmxrt::formats::npz::write_table(&scratch.join("t.npz"), &doubled, "s").unwrap_err();
    let mut torn = table.clone();
    let Sees::Polygons(sunlit) = &mut torn.sources[0].sees else { panic!() };
    sunlit.polygon_start.push(7);
    let error = study::observe(&lit, &torn, Wanted::default(), &unwatched).unwrap_err().to_string();
    assert!(error.contains("sun_polygon_start: "), "{error}");
    table.sources.pop();
    let error = study::observe(&lit, &table, Wanted::default(), &unwatched).unwrap_err().to_string();
    assert!(error.contains("lamp_irradiance: has 0 values, but the scene needs 2"), "{error}");
    assert_ne!(study::table_id(&lit), study::table_id(&ground));
}

#[test]
fn beams_warm_what_they_light() {
    // Bond albedo 0.07, emissivity 0.95: sigma T^4 0.95 = 0.93 (sunlight cos i + the lamp's), in the Sun's shadow without the first.
    let wall = crate::shapes::quad([0.0, -9.0, 0.0], [0.0, 9.0, 0.0], [0.0, 9.0, 5.0], [0.0, -9.0, 5.0]);
    let ground: Mesh = joined(&[plane(3.0, 0.0), wall]);
    let lit = edited(&scene(of_material(ground, 0), nadir(1000.0, 4.0, 2), [1.0, 0.0, 1.0]), |parts| {
        parts.models.thermal = Thermal::Equilibrium;
        parts.sky.beams = vec![beam("lamp", [0.0, 0.0, 1.0], Spectrum::constant(1.0))];
    });
    let table = solve::solve(&lit, &unwatched).unwrap();
    // Ten digits of it.
    let sigma = 5.670_374_419e-8;
    let warm = |w_m2: f64| (0.93 * w_m2 / (0.95 * sigma)).powf(0.25);
    let (lit_k, shaded_k) = (table.temperature_lit_k[0], table.temperature_shaded_k[0]);
    assert!((lit_k / warm(SUN_W_M2 * (0.5f64.sqrt() + 1.0)) - 1.0).abs() < 1e-10, "{lit_k}");
    assert!((shaded_k / warm(SUN_W_M2) - 1.0).abs() < 1e-10, "{shaded_k}");
}

#[test]
fn a_night_with_a_lamp_is_not_black() {
    let night = edited(&scene(plane(5.0, 0.0), nadir(1000.0, 4.0, 2), [0.0, 0.0, -1.0]), |parts| {
        parts.sky.beams = vec![beam("lamp", [0.0, 0.0, 1.0], Spectrum::constant(1.0))];
    });
    let (_, seen) = study::simulate(&night, &unwatched).unwrap();
    assert!(seen.warnings.iter().any(|w| w.ends_with("what the image shows is other beams")), "{:?}", seen.warnings);
    assert!(seen.cube.band(0).iter().all(|l| (l / (0.07 / std::f64::consts::PI) - 1.0).abs() < 1e-14));
}

#[test]
fn beams_that_cannot_be_are_refused_all_at_once() {
    let ground = scene(plane(5.0, 0.0), nadir(1000.0, 4.0, 2), [0.0, 0.0, 1.0]);
    let short = Spectrum::new(vec![2.0, 3.0], vec![1.0, -1.0], mmxrt::spectral::Extend::Error).unwrap();
    let mut odd = beam("a b", [0.0, 0.0, 1.0], short);
    odd.total_irradiance_w_m2 = f64::NAN;
    let twins = ["sun", "lamp", "lamp"].map(|name| beam(name, [0.0, 0.0, 1.0], Spectrum::constant(1.0)));
    let beams = [vec![odd], twins.to_vec()].concat();
    let Err(Error::Invalid(problems)) = ground.under(Sky { beams, ..ground.sky.clone() }) else { panic!() };
    let items: Vec<&str> = problems.iter().filter_map(|p| p.at.item.as_deref()).collect();
    let of = |what: &str| items.iter().filter(|item| **item == what).count();
    // Its name; a value and a reach of its table; its total.
    assert_eq!((of("lamps[0].name"), of("lamps[0].irradiance"), of("lamps[0].total_irradiance_w_m2")), (1, 2, 1));
    assert_eq!((of("lamps[1].name"), of("lamps[3].name"), items.len()), (1, 1, 6), "{items:?}");
}

/// The Sun's own part of a table is the same whatever else lights the scene.
#[test]
fn a_beam_changes_nothing_of_the_suns() {
    let alone = site([1.0, 0.2, 0.4]);
    let together = edited(&alone, |parts| parts.sky.beams = vec![beam("b", [0.0, 1.0, 1.0], Spectrum::constant(1.0))]);
    let [a, b] = [&alone, &together].map(|scene| solve::solve(scene, &unwatched).unwrap());
    assert_eq!(a.sources[0], b.sources[0]);
    let Sun { distance_m, .. } = alone.sky.sun;
    assert_eq!((distance_m, Direction::new(DVec3::new(1.0, 0.2, 0.4)).unwrap()), (1.5 * AU_M, alone.sky.sun.direction));
}

/// DART's files have no place for a beam, and say so; a scene file has.
#[test]
fn a_beam_that_is_not_carried_is_told() {
    let lamp = edited(&crate::dart_write::tetrahedron(), |parts| {
        let table = Spectrum::new(vec![0.3, 1.0, 4.0], vec![1.5, 0.1, 0.7], mmxrt::spectral::Extend::Error).unwrap();
        let with_table = Beam { total_irradiance_w_m2: 1.25, ..beam("lamp-2", [1.0, 0.0, 0.3], table) };
        parts.sky.beams = vec![beam("lamp", [0.0, 1.0, 1.0], Spectrum::constant(1.0)), with_table];
    });
    let (_, of_dart) = mmxrt::formats::dart::from_scene(&lamp, &Default::default()).unwrap();
    let told = of_dart.notes.iter().filter(|note| note.at.item.as_deref() == Some("beams.\"lamp\""));
    assert!(told.count() == 1 && of_dart.has_losses(), "{:#?}", of_dart.notes);
    let scratch = crate::scratch::Scratch::new();
    let path = scratch.join("scene.toml");
    let (staged, written) = mmxrt::formats::scene_toml::write(&lamp, &path, false).unwrap();
    assert!(written.notes.iter().all(|note| !format!("{note:?}").contains("lamp")), "{:#?}", written.notes);
    staged.commit().unwrap();
    let back = mmxrt::formats::scene_toml::read(&path, &unwatched).unwrap().scene;
    assert_eq!(back.sky.beams, lamp.sky.beams);
}

fn of_text(lights: &str) -> Result<Scene, Error> {
    let scratch = crate::scratch::Scratch::new();
    scratch.write("square.obj", crate::scenes::SQUARE_OBJ);
    scratch.write("lamp.csv", "wavelength_um,irradiance_w_m2_um\n0.5,2\n1.5,6\n2.5,2\n");
    let text = format!(
        "mmxrt_scene = 1\norigin_m = [0.0, 0.0, 11000.0]\n[[mesh]]\nobj = \"square.obj\"\n[materials]\ndefault = {{ reflectance = 0.07 }}\n\
         [thermal]\nmodel = \"off\"\n[observer]\nposition_m = [0.0, 0.0, 12000.0]\ntarget_m = [0.0, 0.0, 11000.0]\nup = [0.0, 1.0, 0.0]\n\
         [sensor]\nsamples = 2\nlines = 2\nifov_mrad = 1.0\nbands = {{ centres_um = [1.0, 1.5], fwhm_um = [0.0, 0.0] }}\n{lights}"
    );
    let path = scratch.write("scene.toml", text);
    Ok(mmxrt::formats::scene_toml::read(&path, &unwatched)?.scene)
}

/// A plane of reflectance 0.07 under lamps of stated irradiance: 0.07 / pi times its cosine.
#[test]
fn lamps_and_a_sun_of_stated_irradiance() {
    let unit = "[sun]\ndirection = [0.0, 0.6, 0.8]\nirradiance = 1.0\n";
    for (lights, expected) in [
        (unit.to_owned(), [0.8, 0.8]),
        // Whatever the distance.
        (format!("{unit}distance_au = 1.7\n"), [0.8, 0.8]),
        ("[sun]\ndirection = [0.0, 0.6, 0.8]\nirradiance = \"lamp.csv\"\n".to_owned(), [3.2, 4.8]),
        (
            format!(
                "{unit}[[lamps]]\nname = \"a\"\ndirection = [3.0, 0.0, 4.0]\nirradiance = 10.0\n\
                     [[lamps]]\nname = \"b\"\ndirection = [0.0, 0.0, 1.0]\nirradiance = \"lamp.csv\"\n"
            ),
            [0.8 + 8.0 + 4.0, 0.8 + 8.0 + 6.0],
        ),
    ] {
        let scene = of_text(&lights).unwrap_or_else(|e| panic!("{lights}: {e}"));
        for (band, expected) in cube(&scene).iter().zip(expected) {
            let l = 0.07 / std::f64::consts::PI * expected;
            assert!(band.iter().all(|got| (got / l - 1.0).abs() < 1e-14), "{lights}: {band:?} {l}");
        }
    }
    // Totals: of a table its integral, 2 * 4 W m-2; of a number nothing, unless they are stated.
    let lit = "[sun]\ndirection = [0.0, 0.6, 0.8]\nirradiance = \"lamp.csv\"\n[[lamps]]\nname = \"a\"\ndirection = [0.0, 0.0, 1.0]\nirradiance = 1.0\n";
    let scene = of_text(lit).unwrap();
    assert!(
        (scene.sky.sun.total_irradiance_w_m2() - 8.0).abs() < 1e-12 && scene.sky.beams[0].total_irradiance_w_m2 == 0.0
    );
    let stated = of_text(&format!("{lit}total_irradiance_w_m2 = 77.0\n")).unwrap();
    assert_eq!(stated.sky.beams[0].total_irradiance_w_m2, 77.0);
    for (lights, told) in [
        ("[sun]\ndirection = [0.0, 0.6, 0.8]\nirradiance = -1.0\n", "sun.irradiance: -1 is not a number of at least 0"),
        (
            "[sun]\ndirection = [0.0, 0.6, 0.8]\nirradiance = 1.0\nspectrum = \"e490\"\n",
            "sun.spectrum: `irradiance` says",
        ),
        (
            &format!("{unit}[[lamps]]\nname = \"a\"\ndirection = [0.0, 0.0, 0.0]\nirradiance = 1.0\n"),
            "lamps[0].direction: has no length",
        ),
        (
            &format!("{unit}[[lamps]]\nname = \"sun\"\ndirection = [0.0, 0.0, 1.0]\nirradiance = 1.0\n"),
            "another source has this name",
        ),
    ] {
        let error = of_text(lights).unwrap_err().to_string();
        assert!(error.contains(told), "{lights}: {error}");
    }
}
