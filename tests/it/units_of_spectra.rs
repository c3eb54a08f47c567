//! What spectra are of and in: quantities, units and scales, by hand.

use mmxrt::formats::{scene_toml, sli};
use mmxrt::progress::unwatched;

use crate::scratch::Scratch;

/// A plate under the Sun, with materials, a table `[sun]` and a band at 10 um.
fn scene(materials: &str, sun: &str) -> String {
    format!(
        "mmxrt_scene = 1\norigin_m = [0, 0, 10000]\n[[mesh]]\nobj = \"plate.obj\"\n[materials]\n{materials}\n\
         [sun]\ndirection = [0, 0, 1]\ndistance_au = 1.0\n{sun}\n\
         [observer]\nposition_m = [0, 0, 10100]\ntarget_m = [0, 0, 10000]\nup = [0, 1, 0]\n\
         [sensor]\nsamples = 3\nlines = 3\nfov_deg = 0.5\nbands = {{ centres_um = [10.0] }}\n"
    )
}

fn prepared() -> Scratch {
    let scratch = Scratch::new();
    scratch.write(
        "plate.obj",
        "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl ground\nf 1/1 2/2 3/3 4/4\n",
    );
    scratch
}

fn opened(scratch: &Scratch, materials: &str, sun: &str) -> scene_toml::SceneFile {
    let path = scratch.write("scene.toml", scene(materials, sun));
    scene_toml::read(&path, &unwatched).unwrap_or_else(|e| panic!("{e}"))
}

fn defaults(opened: &scene_toml::SceneFile) -> String {
    opened.defaults.iter().map(|stated| format!("{} = {}\n", stated.item, stated.value)).collect()
}

#[test]
fn a_mixture_emits_what_its_parts_emit() {
    let scratch = prepared();
    let materials = "metal = { reflectance = 0.5, emissivity = 0.2 }\ndust = { reflectance = 0.1 }\n\
                     inner = { mixture = { metal = 0.5, dust = 0.5 } }\nground = { mixture = { metal = 0.25, dust = 0.75 } }\n\
                     outer = { mixture = { inner = 0.5, metal = 0.5 } }\nstated = { mixture = { metal = 1.0 }, emissivity = 0.6 }\n\
                     plain = { mixture = { dust = 1.0 } }";
    let opened = opened(&scratch, materials, "");
    let emissivity = |name: &str| {
        let material = opened.scene.materials.iter().find(|m| m.name == name).unwrap();
        material.emissivity.at(10.0).unwrap()
    };
    // 0.25 x 0.2 + 0.75 x 0.9; 0.5 x 0.55 + 0.5 x 0.2.
    for (name, expected) in
        [("ground", 0.725), ("inner", 0.55), ("outer", 0.375), ("stated", 0.6), ("plain", 0.9), ("metal", 0.2)]
    {
        assert!((emissivity(name) - expected).abs() < 1e-15, "{name}: {}", emissivity(name));
    }
    let told = defaults(&opened);
    assert!(told.contains("ground.emissivity = that of its parts"), "{told}");
    assert!(told.contains("plain.emissivity = 1 - reflectance"), "{told}");
}

#[test]
fn a_bond_albedo_from_little_sunlight_is_warned_of() {
    let scratch = prepared();
    let warned = |ends: [f64; 2]| {
        scratch.write("ground.csv", format!("wavelength_um,reflectance\n{},0.02\n{},0.02\n", ends[0], ends[1]));
        let opened = opened(&scratch, "ground = { reflectance = \"ground.csv\" }", "");
        opened.notes.join("\n")
    };
    // E490: 2.016 W m-2 from 7 to 14 um, of 1366.09.
    assert!(warned([7.0, 14.0]).contains("0.0200 is the mean over 0.1 % of sunlight only"), "{}", warned([7.0, 14.0]));
    assert!(!warned([0.2, 14.0]).contains("sunlight"), "{}", warned([0.2, 14.0]));
}

#[test]
fn the_total_says_what_is_of_the_table_and_what_is_beyond() {
    let scratch = prepared();
    // E = 20 (um - 0.2): 20 x 13 x 13 / 2.
    scratch.write("sun.csv", "wavelength_um,irradiance_w_m2_um\n0.2,0\n13.2,260\n");
    let told = defaults(&opened(&scratch, "ground = { reflectance = 0.1 }", "spectrum = \"sun.csv\""));
    assert!(told.contains("1690.00 W m-2 in the table + ") && told.contains("of E490 beyond its ends"), "{told}");
    let told = defaults(&opened(&scratch, "ground = { reflectance = 0.1 }", ""));
    assert!(told.contains("1366.09: the spectrum as it is, not scaled") && !told.contains("beyond its ends"), "{told}");
}

#[test]
fn a_librarys_gains_offsets_and_scale_all_count() {
    let scratch = Scratch::new();
    let values: Vec<u8> = [1.0f64, 2.0, 3.0, 4.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let path = scratch.write("a.sli", values);
    let read = |more: &str| {
        scratch.write(
            "a.hdr",
            format!(
                "ENVI\nsamples = 2\nlines = 2\nbands = 1\nfile type = ENVI Spectral Library\ndata type = 5\nbyte order = 0\n\
                 wavelength units = Micrometers\nwavelength = {{1, 0.5}}\nspectra names = {{a, b}}\n{more}"
            ),
        );
        sli::read(&path).map(|(spectra, _)| spectra)
    };
    // One for all: (1 x 0.25 + 0.5) / 2 and so on. Wavelengths descend in the file.
    let spectra =
        read("data gain values = {0.25}\ndata offset values = {0.5}\nreflectance scale factor = 2\n").unwrap();
    assert_eq!(spectra[0].column("reflectance"), Some(&[0.5, 0.375][..]));
    assert_eq!(spectra[1].column("reflectance"), Some(&[0.75, 0.625][..]));
    // One for each channel.
    let spectra = read("data gain values = {0.25, 0.125}\n").unwrap();
    assert_eq!(spectra[0].column("reflectance"), Some(&[0.25, 0.25][..]));
    assert_eq!(spectra[1].column("reflectance"), Some(&[0.5, 0.75][..]));
    let told = read("data gain values = {0.25, 0.125, 1}\n").unwrap_err().to_string();
    assert!(told.contains("data gain values") && told.contains("one for each channel, or a single one"), "{told}");
}

#[test]
fn percent_of_what_a_header_made_fractions_is_told() {
    let scratch = prepared();
    scratch.write("t.img", 50.0f64.to_le_bytes());
    let header = "ENVI\nsamples = 1\nlines = 1\nbands = 1\ndata type = 5\nbyte order = 0\ninterleave = bsq\n";
    let warned = |more: &str, unit: &str| {
        scratch.write("t.hdr", format!("{header}{more}"));
        let texture =
            format!("{{ raster = \"t.img\", quantity = \"reflectance\", placement = \"atlas\", unit = \"{unit}\" }}");
        opened(&scratch, &format!("ground = {{ reflectance = 0.5, texture = {texture} }}"), "").notes.join("\n")
    };
    assert!(warned("reflectance scale factor = 100\n", "%").contains("divides by 100 once more"));
    assert!(!warned("reflectance scale factor = 100\n", "1").contains("once more"));
    assert!(!warned("", "%").contains("once more"));
}
