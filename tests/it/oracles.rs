//! Every oracle of tests/data/oracles.json, and how many of them there were.

use std::collections::BTreeMap;
use std::path::Path;

use mmxrt::Error;
use mmxrt::study::validate::{By, Row, Verdict, closed_forms, count, count_simulated, oracles};

/// Rows per group: (pass, skipped).
fn tally(rows: &[Row]) -> BTreeMap<&str, (usize, usize)> {
    let mut tally = BTreeMap::new();
    for row in rows {
        let (pass, skipped): &mut (usize, usize) = tally.entry(row.group.as_str()).or_default();
        match row.verdict {
            Verdict::Pass => *pass += 1,
            Verdict::Skipped => *skipped += 1,
            Verdict::Fail => panic!("{row:?}"),
        }
    }
    tally
}

#[test]
fn all_oracles_hold() {
    let rows = closed_forms().unwrap();
    let expected = BTreeMap::from([
        ("albedo", (20, 0)),
        ("blackbody", (47, 0)),
        ("brdf", (80, 0)),
        ("brdf_property", (7, 0)),
        ("camera", (7, 0)),
        ("coverage", (24, 0)),
        ("crater", (46, 0)),
        ("disc", (13, 0)),
        ("formfactor", (18, 0)),
        ("furnace", (8, 0)),
        ("geometry", (21, 0)),
        ("hapke_parts", (32, 0)),
        ("iau", (72, 0)),
        // Light of Mars near at hand twice: by its integral, and by the table that `simulate` uses.
        ("marsshine", (32, 0)),
        ("numerics", (35, 0)),
        ("penumbra", (28, 0)),
        ("product", (6, 0)),
        ("qso", (30, 0)),
        // Skipped: two need ephemerides.
        ("scene", (30, 2)),
        ("sun", (12, 0)),
        ("thermal", (32, 0)),
        ("time", (2, 0)),
    ]);
    assert_eq!(tally(&rows), expected);
    // What is said to be computed as `simulate` does: a patch of ground under Table I, Mars' table, footprints, temperatures.
    let by = |name: &str| rows.iter().find(|row| row.name.starts_with(name)).unwrap().by;
    for name in
        ["flat_lambert_radiance", "radiative_equilibrium_T", "thesis_eq9_T", "plane_to_sphere_F", "thermal_over"]
    {
        assert_eq!(by(name), Some(By::Simulate), "{name}");
    }
    for name in ["parallel_rectangles", "lommel_seeliger_sphere_phase", "sun_perspective_rounding", "light_time"] {
        assert_eq!(by(name), Some(By::Reference), "{name}");
    }
    let near = |row: &&Row| row.name == "lambert_near_field_tilted_per_rho(phase=90,tilt=100,az=0)";
    assert_eq!(
        rows.iter().filter(near).map(|row| row.by).collect::<Vec<_>>(),
        [Some(By::Reference), Some(By::Simulate)]
    );
    assert!(count_simulated(&rows) > 100 && count_simulated(&rows) < count(&rows, Verdict::Pass));
}

fn one(record: &str) -> Vec<Row> {
    oracles(&format!(r#"{{"oracles": [{record}]}}"#), Path::new("x.json"), None).unwrap()
}

#[test]
fn another_file_of_the_same_kind_is_understood() {
    // B(10 um, 290 K) by hand: x = 14387.77 / 2900 = 4.9613, e^x = 142.78, 1191.04 / 141.78 = 8.4007.
    let rows = one(
        r#"{"group": "blackbody", "name": "planck_L(mine)", "inputs": {"lambda_um": 10, "T_K": 290}, "expected": "84007/10000", "tol_rel": 1e-4}"#,
    );
    assert_eq!((rows.len(), rows[0].verdict), (1, Verdict::Pass), "{rows:?}");
    let rows = one(r#"{"group": "thermal", "name": "thesis_eq9_T(cos_i=0.5)", "expected": 240, "tol_abs": 0}"#);
    assert_eq!(rows[0].verdict, Verdict::Pass, "{rows:?}");
}

#[test]
fn oracles_that_are_not_in_the_file_are_known_too() {
    // Values computed independently: by hand, or from the closed forms in 40 digits.
    let records = [
        r#""camera", "name": "eq22", "inputs": {"O": [1, 2, 3], "h": [1, 0, 0], "v": [0, -1, 0], "u": [0, 0, -1], "X": 0.5, "Y": 0.25, "Z": 8}, "expected": [5, 0, -5], "tol_rel": 1e-15"#,
        r#""camera", "name": "eq22_back", "inputs": {"O": [1, 2, 3], "h": [1, 0, 0], "v": [0, -1, 0], "u": [0, 0, -1], "X": 0.5, "Y": 0.5, "Z": 8}, "expected": {"x": 5, "y": -2, "z": -5}, "tol_rel": 1e-15"#,
        r#""coverage", "name": "quad", "inputs": {"vertices": [[0.5, 0.5], [2, 0.5], [2, 1.5], [0.5, 1]], "grid": [2, 2]}, "expected": [["1/4", "1/2"], ["1/24", "1/3"]], "tol_abs": 1e-14"#,
        r#""disc", "name": "lommel_seeliger_phase_integral", "expected": 1.6365483703468, "tol_rel": 1e-9"#,
        r#""disc", "name": "lommel_seeliger_sphere_phase(179.99)", "inputs": {"phase_deg": 179.99}, "expected": 5.07695699128081e-9, "tol_rel": 1e-11"#,
        r#""formfactor", "name": "coaxial_discs(r1=1,r2=1,h=1)", "expected": 0.38196601125010515, "tol_rel": 1e-13"#,
        r#""formfactor", "name": "cube_closure", "expected": 1, "tol_rel": 1e-14"#,
        r#""formfactor", "name": "strips_at_right_angles", "expected": 0.2928932188134525, "tol_rel": 1e-13"#,
        r#""marsshine", "name": "thesis_eq8", "inputs": {"rho": 0.25, "R": 3389.5, "D": 9389}, "expected": 0.06516322993, "tol_rel": 1e-9"#,
        r#""marsshine", "name": "mean_over_coplanar_orbit_near_field_per_rho", "inputs": {"R": 3389.5, "D": 9376}, "expected": 0.0382091, "tol_rel": 2e-6"#,
        r#""scene", "name": "flat_lambert_radiance_table_I_3um", "inputs": {"rho": 0.07, "E490_3um": 26.12, "d_au": 2, "i_deg": 60}, "expected": 0.0727497245, "tol_rel": 1e-8"#,
        r#""scene", "name": "thermal_over_reflected(mine)", "inputs": {"lambda_um": 3.0, "rho": 0.07, "T_K": 316, "d_au": 1.5237}, "expected": 0.50, "tol_rel": 0.01"#,
        r#""sun", "name": "E490(1.0um)", "inputs": {"file": "solar/e490_00a.dat", "lambda_um": 1}, "expected": 747.9, "tol_rel": 1e-12"#,
        // A Lambert BRDF is rho / pi, and the same both ways; a cosine through a Gaussian keeps exp(-2 pi^2 s^2 nu^2).
        r#""brdf", "name": "lambert(rho=0.2)@(i=50,e=35,psi=120)", "inputs": {"i_deg": 50, "e_deg": 35, "psi_deg": 120}, "expected": 0.0636619772367581, "tol_rel": 1e-12"#,
        r#""brdf_property", "name": "reciprocity lambert(rho=0.2)", "inputs": {"i": 50, "e": 20, "psi": 30}, "expected": 0, "tol_abs": 1e-12"#,
        r#""ils", "name": "gaussian_on_cosine(fwhm=0.02um,nu=25/um)", "inputs": {"fwhm_um": 0.02, "cycles_per_um": 25}, "expected": 0.410685800378362, "tol_rel": 1e-6"#,
        r#""penumbra", "name": "edge_shadow_width(mine)", "inputs": {"h_m": 10, "i_deg": 45, "d_au": 1}, "expected": {"hard_edge_m": 10, "approx_2hs_over_cos2_m": 0.186019360945}, "tol_rel": 1e-10"#,
        r#""blackbody", "name": "stefan_boltzmann(T=300)", "inputs": {"T_K": 300}, "expected": 459.300327939, "tol_rel": 1e-10"#,
        r#""pushbroom", "name": "pixel_size", "inputs": {"ifov_mrad": 0.5, "alt_km": 20}, "expected": 10, "tol_rel": 1e-14"#,
        r#""formfactor", "name": "mars_solid_angle", "inputs": {"R": 3, "D": 5}, "expected": 1.25663706143592, "tol_rel": 1e-13"#,
    ];
    for record in records {
        let rows = one(&format!(r#"{{"group": {record}}}"#));
        assert!(!rows.is_empty() && rows.iter().all(|row| row.verdict == Verdict::Pass), "{rows:?}");
    }
    // Another table of sunlight is not the built-in one.
    let rows = one(
        r#"{"group": "sun", "name": "E490_integral", "inputs": {"file": "other.csv", "l1": 1, "l2": 2}, "expected": 1}"#,
    );
    assert_eq!(rows[0].verdict, Verdict::Skipped);
}

#[test]
fn a_wrong_number_fails_and_an_unknown_one_is_skipped() {
    let rows = one(
        r#"{"group": "thermal", "name": "thesis_eq9_T", "inputs": {"cos_i": 0.5}, "expected": 241, "tol_rel": 1e-3}"#,
    );
    assert_eq!((rows[0].verdict, rows[0].got), (Verdict::Fail, Some(240.0)));
    let rows = one(r#"{"group": "hearsay", "name": "x", "expected": {"a": 1, "b": 2}}"#);
    assert_eq!((rows.len(), count(&rows, Verdict::Skipped), rows[0].by), (1, 1, None));
    // Nearly the right order of magnitude will do where no tolerance is given, more will not.
    for (expected, verdict) in [("25", Verdict::Pass), ("23", Verdict::Fail)] {
        let rows = one(&format!(
            r#"{{"group": "thermal", "name": "thesis_eq9_T", "inputs": {{"cos_i": 0.5}}, "expected": {expected}, "tolerance": "order of magnitude"}}"#
        ));
        assert_eq!((rows[0].verdict, rows[0].tolerance.as_str()), (verdict, "factor 10"));
    }
}

#[test]
fn a_broken_file_is_told_where() {
    let run = |text| oracles(text, Path::new("x.json"), None).unwrap_err();
    let error = run("{\n \"oracles\": [}");
    assert!(matches!(&error, Error::Syntax { .. }) && error.to_string().starts_with("x.json:2:14"), "{error}");
    let error = run(r#"{"oracles": [{"name": "a", "expected": 1}, {"group": "sun", "name": "b"}]}"#);
    let told = "x.json oracles[0]: has no text \"group\"\nx.json oracles[1]: has no \"expected\"";
    assert_eq!(error.to_string(), told);
    assert!(matches!(run("{}"), Error::Invalid(_)));
    assert!(matches!(run(r#"{"oracles": []}"#), Error::Invalid(_)));
}
