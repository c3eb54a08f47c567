//! Every oracle of tests/data/oracles.json, and how many of them there were.

use std::collections::BTreeMap;
use std::path::Path;

use mmxrt::Error;
use mmxrt::study::validate::{Row, Verdict, closed_forms, count, oracles};

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
        ("blackbody", (47, 0)),
        ("camera", (7, 0)),
        ("coverage", (24, 0)),
        // Skipped: the geometric albedo of a Hapke sphere.
        ("disc", (12, 1)),
        ("formfactor", (18, 0)),
        ("geometry", (21, 0)),
        ("marsshine", (18, 0)),
        ("numerics", (35, 0)),
        ("product", (6, 0)),
        // Skipped: two need ephemerides.
        ("scene", (30, 2)),
        ("sun", (12, 0)),
        ("thermal", (11, 0)),
    ]);
    assert_eq!(tally(&rows), expected);
}

fn one(record: &str) -> Vec<Row> {
    oracles(&format!(r#"{{"oracles": [{record}]}}"#), Path::new("x.json")).unwrap()
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
fn a_wrong_number_fails_and_an_unknown_one_is_skipped() {
    let rows = one(
        r#"{"group": "thermal", "name": "thesis_eq9_T", "inputs": {"cos_i": 0.5}, "expected": 241, "tol_rel": 1e-3}"#,
    );
    assert_eq!((rows[0].verdict, rows[0].got), (Verdict::Fail, Some(240.0)));
    let rows = one(r#"{"group": "hearsay", "name": "x", "expected": {"a": 1, "b": 2}}"#);
    assert_eq!((rows.len(), count(&rows, Verdict::Skipped)), (1, 1));
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
    let run = |text| oracles(text, Path::new("x.json")).unwrap_err();
    let error = run("{\n \"oracles\": [}");
    assert!(matches!(&error, Error::Syntax { .. }) && error.to_string().starts_with("x.json:2:14"), "{error}");
    let error = run(r#"{"oracles": [{"name": "a", "expected": 1}, {"group": "sun", "name": "b"}]}"#);
    let told = "x.json oracles[0]: has no text \"group\"\nx.json oracles[1]: has no \"expected\"";
    assert_eq!(error.to_string(), told);
    assert!(matches!(run("{}"), Error::Invalid(_)));
    assert!(matches!(run(r#"{"oracles": []}"#), Error::Invalid(_)));
}
