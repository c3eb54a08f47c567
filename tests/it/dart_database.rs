//! DART's optical databases: read, written, and refused when damaged.

use std::path::{Path, PathBuf};
use std::time::Instant;

use mmxrt::Error;
use mmxrt::formats::dart::database::{self, Database, TableKind, model_name};
use mmxrt::formats::spectra;
use mmxrt::report::Fate;
use mmxrt::spectral::{Column, SpectralLibrary};
use rusqlite::Connection;

use crate::scratch::Scratch;
use crate::spectra::{called, library, paint};

/// Makes a database by SQL.
fn by_sql(scratch: &Scratch, name: &str, statements: &str) -> PathBuf {
    let path = scratch.path().join(name);
    Connection::open(&path).unwrap().execute_batch(statements).unwrap();
    path
}

/// What SQLite keeps of statements, in the order of their making.
fn schema(path: &Path) -> Vec<String> {
    let connection = Connection::open(path).unwrap();
    let mut statement = connection.prepare("SELECT sql FROM sqlite_master WHERE sql NOT NULL ORDER BY rowid").unwrap();
    statement.query_map([], |row| row.get(0)).unwrap().collect::<Result<_, _>>().unwrap()
}

fn hapke() -> SpectralLibrary {
    let names = ["w", "c1", "c2", "c3", "c4", "h1", "h2"];
    let values = [[0.317, 0.5], [1.549, 0.3], [0.878, -0.2], [0.163, 0.1], [0.047, 0.0], [1.0, 1.0], [0.101, 0.1]];
    let columns: Vec<(&str, &[f64])> = names.iter().zip(&values).map(|(n, v)| (*n, &v[..])).collect();
    library("gravel", &[0.538, 2.5], &columns)
}

fn rpv() -> SpectralLibrary {
    library("pad", &[0.1], &[("reflectance", &[0.05]), ("k", &[0.8]), ("g", &[-0.1]), ("h", &[0.05])])
}

#[test]
fn a_database_comes_back_as_it_was() {
    let scratch = Scratch::new();
    let path = scratch.path().join("a.db");
    let index = library("quartz", &[0.3], &[("n", &[1.5]), ("k", &[0.0])]);
    let fluid = library("haze", &[0.3], &["sigma", "albedo", "a", "g1", "g2"].map(|n| (n, &[1.0][..])));
    let sun = library("TOASolar", &[0.3, 0.4], &[("irradiance", &[514.0, 1743.0])]);
    let all = [paint(), hapke(), rpv(), index, fluid, sun];
    let report = spectra::write(&path, called("db"), &all, false).unwrap();
    assert!(report.notes.is_empty(), "{report:?}");
    let (back, report) = spectra::read(&path).unwrap();
    assert_eq!(back, all);
    assert!(report.notes.is_empty(), "{report:?}");

    let models = database::models(&path).unwrap();
    let kinds: Vec<(&str, TableKind)> = models.iter().map(|m| (m.name.as_str(), m.kind)).collect();
    let expected = [
        ("inner_paint", TableKind::Lambertian),
        ("gravel", TableKind::Hapke),
        ("pad", TableKind::Rpv),
        ("quartz", TableKind::RefractiveIndex),
        ("haze", TableKind::FluidHenyeyGreenstein),
        ("TOASolar", TableKind::SolarIrradiance),
    ];
    assert_eq!(kinds, expected);
    assert_eq!(models[0].comment, "demo spectrum\nPERCENT");
    assert_eq!(models[3].columns, ["lambda", "n", "k"]);

    // Names are the same in any case.
    let (reflectance, report) = database::lambertian(&path, "Inner_Paint").unwrap();
    assert_eq!(reflectance.value(), paint().columns[0].values);
    assert_eq!(report.notes.len(), 1, "{report:?}");
    assert!(report.notes[0].to_string().contains("diffuse_transmittance of up to 2.6215 %: taken to be opaque"));
    assert_eq!(database::hapke(&path, "gravel").unwrap().0, all[1]);
    assert_eq!(database::rpv(&path, "pad").unwrap().0, all[2]);
    assert_eq!(database::coverage(&path, "gravel").unwrap(), (0.538, 2.5));
    let told = database::hapke(&path, "pad").unwrap_err().to_string();
    assert!(told.contains("a.db table pad: is not a Hapke model: it has no w, c1"), "{told}");
    let told = database::lambertian(&path, "paint").unwrap_err().to_string();
    assert!(told.contains("table paint: there is no such table (help: its tables are inner_paint, gravel,"), "{told}");
}

#[test]
fn tables_are_made_as_darts_own_tools_make_them() {
    let scratch = Scratch::new();
    let path = scratch.path().join("a.db");
    let digit = library("2nd one", &[1.0], &[("reflectance", &[0.2])]);
    let report = database::create(&path, &[paint(), hapke(), rpv(), digit], false).unwrap();
    let lambertian = "( Id INTEGER PRIMARY KEY AUTOINCREMENT, wavelength DOUBLE, reflectance DOUBLE, \
                      direct_transmittance DOUBLE, diffuse_transmittance DOUBLE)";
    let expected = [
        "CREATE TABLE _comments (model , Comments)".to_owned(),
        "CREATE UNIQUE INDEX comments_index on _comments (model)".to_owned(),
        format!("CREATE TABLE inner_paint {lambertian}"),
        "CREATE TABLE sqlite_sequence(name,seq)".to_owned(),
        "CREATE TABLE gravel ( Id INTEGER PRIMARY KEY AUTOINCREMENT, wavelength DOUBLE, w DOUBLE, c1 DOUBLE, c2 DOUBLE, \
         c3 DOUBLE, c4 DOUBLE, h1 DOUBLE, h2 DOUBLE)"
            .to_owned(),
        "CREATE TABLE pad ( Id INTEGER PRIMARY KEY AUTOINCREMENT, wavelength DOUBLE, reflectance DOUBLE, k DOUBLE, \
         g DOUBLE, h DOUBLE)"
            .to_owned(),
        format!("CREATE TABLE _2nd_one {lambertian}"),
    ];
    assert_eq!(schema(&path), expected);
    let told: Vec<String> = report.notes.iter().map(|n| n.message.clone()).collect();
    assert_eq!(
        told,
        [
            "the name \"2nd one\" is written as _2nd_one",
            "no direct_transmittance or diffuse_transmittance given: 0, as of an opaque surface"
        ]
    );
    // Percent, in the first row of the first table.
    let connection = Connection::open(&path).unwrap();
    let row: (i64, f64, f64, f64) = connection
        .query_row("SELECT Id, wavelength, reflectance, diffuse_transmittance FROM inner_paint WHERE Id = 4", [], |r| {
            Ok((r.get(0)?, r.get(1)?, r.get(2)?, r.get(3)?))
        })
        .unwrap();
    assert_eq!(row, (4, 12.0, 2.9582, 2.6215));
    let check: String = connection.query_row("PRAGMA integrity_check", [], |r| r.get(0)).unwrap();
    assert_eq!(check, "ok");
}

#[test]
fn names_are_mangled_as_darts_own_tools_do() {
    for (name, table) in [("2nd one", "_2nd_one"), ("a-b.c", "a_b_c"), ("_x9", "_x9"), ("", ""), ("é!", "é_")] {
        assert_eq!(model_name(name), table);
    }
    let scratch = Scratch::new();
    let path = scratch.path().join("a.db");
    let one = |name: &str| library(name, &[1.0], &[("reflectance", &[0.2])]);
    let told = |models: &[SpectralLibrary]| database::create(&path, models, false).unwrap_err().to_string();
    assert!(told(&[one("a b"), one("A_b")]).contains("table A_b: \"a b\" and \"A_b\" become the same name"));
    assert!(told(&[one("a"), one("a")]).contains("appears twice"));
    assert!(told(&[one("")]).contains("has no name"));
    // DART names tables without quotes: what is a word of SQL could not be read there.
    for word in ["select", "_comments", "sqlite_x"] {
        assert!(told(&[one(word)]).contains("cannot be made"), "{word}: {}", told(&[one(word)]));
    }
    assert!(told(&[library("a", &[1.0], &[("reflectance", &[1.2])])]).contains("reflectance: 1.2 is outside 0 to 1"));
    assert_eq!(scratch.path().read_dir().unwrap().count(), 0, "something was left behind");
}

#[test]
fn the_same_content_gives_the_same_bytes() {
    let scratch = Scratch::new();
    let (a, b) = (scratch.path().join("a.db"), scratch.path().join("b.db"));
    database::create(&a, &[paint(), hapke()], false).unwrap();
    database::create(&b, &[paint(), hapke()], false).unwrap();
    assert_eq!(std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap());
    for path in [&a, &b] {
        database::append(path, &[rpv()]).unwrap();
    }
    assert_eq!(std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap());
    assert_eq!(spectra::read(&a).unwrap().0, [paint(), hapke(), rpv()]);
    assert!(database::create(&a, &[paint()], false).unwrap_err().to_string().contains("exists"));
    database::create(&a, &[paint()], true).unwrap();
    assert_eq!(spectra::read(&a).unwrap().0, [paint()]);
}

#[test]
fn what_is_appended_leaves_the_rest_as_it_was() {
    let scratch = Scratch::new();
    // A foreign database: other names and types, no comments, a write-ahead log, a view and a trigger.
    let path = by_sql(
        &scratch,
        "a.db",
        "PRAGMA journal_mode = WAL;
         CREATE TABLE \"hc123\" (\"id\" INTEGER, \"Wavelength\" REAL, \"Reflectance\" REAL, \"direct_transmittance\" REAL,
           \"diffuse_transmittance\" REAL);
         INSERT INTO hc123 VALUES(0, 0.4, 4.5, 0, 0.1), (1, 0.401, 4.6, 0, 0.2);
         CREATE INDEX ix ON hc123 (id);
         CREATE TABLE _prospect_v6_parameters (model, N);
         CREATE VIEW wavelengths AS SELECT wavelength FROM hc123;
         CREATE TABLE log (said);
         CREATE TRIGGER t AFTER INSERT ON hc123 BEGIN INSERT INTO log VALUES('x'); END;",
    );
    let before = schema(&path);
    database::append(&path, &[paint()]).unwrap();
    let after = schema(&path);
    assert_eq!(after[..before.len()], before);
    assert_eq!(after.len(), before.len() + 4, "{after:?}");
    let (all, report) = spectra::read(&path).unwrap();
    let names: Vec<&str> = all.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["hc123", "inner_paint"]);
    assert_eq!(all[0].column("reflectance").unwrap(), [0.045, 0.046]);
    assert_eq!(all[1], paint());
    assert_eq!(report.notes.iter().filter(|n| n.fate == Fate::Dropped).count(), 2, "{report:?}");

    let bytes = std::fs::read(&path).unwrap();
    let told = database::append(&path, &[rpv(), paint()]).unwrap_err().to_string();
    assert!(told.contains("table inner_paint: is there already"), "{told}");
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    assert!(matches!(database::append(&scratch.path().join("none.db"), &[rpv()]), Err(Error::Io { .. })));
}

#[test]
fn columns_and_rows_are_checked() {
    let scratch = Scratch::new();
    let create = "CREATE TABLE m (Id INTEGER PRIMARY KEY, wavelength DOUBLE, reflectance DOUBLE, direct_transmittance DOUBLE, \
                  diffuse_transmittance DOUBLE);";
    let rows = |rows: &str| format!("{create} INSERT INTO m VALUES {rows};");
    let cases = [
        (create.to_owned(), "table m: has no rows"),
        (
            create.replace("reflectance DOUBLE, direct_transmittance", "direct_transmittance DOUBLE, reflectance"),
            "silence",
        ),
        ("CREATE TABLE m (reflectance, wavelength, direct_transmittance, diffuse_transmittance);".into(), "silence"),
        (
            "CREATE TABLE m (wavelength, k, reflectance, g, h);".into(),
            "help: put them in the order wavelength, reflectance, k",
        ),
        ("CREATE TABLE m (reflectance);".into(), "no column `wavelength`"),
        (rows("(1,1,2,0,0),(2,0.5,2,0,0)"), "table m, row 2, wavelength: 0.5 is less than 1 before it"),
        (rows("(1,1,2,0,0),(2,1,2,0,0)"), "row 2, wavelength: 1 appears twice"),
        (rows("(1,NULL,2,0,0)"), "row 1, wavelength: is empty (NULL)"),
        (rows("(1,-1,2,0,0)"), "row 1, wavelength: -1 is not a wavelength"),
        (rows("(1,9e999,2,0,0)"), "inf is not a wavelength"),
        (rows("(1,1,NULL,0,0)"), "row 1, reflectance: is empty (NULL)"),
        (rows("(1,1,'bright',0,0)"), "row 1, reflectance: is the text \"bright\""),
        (rows("(1,1,x'0102',0,0)"), "row 1, reflectance: is 2 bytes of binary data"),
        (rows("(1,1,-9e999,0,0)"), "row 1, reflectance: -inf is not a number"),
        (rows("(1,1,-2,0,0)"), "row 1, reflectance: -2 is outside 0 to 100"),
        (rows("(1,1,2,0,101)"), "row 1, diffuse_transmittance: 101 is outside 0 to 100"),
        ("CREATE TABLE m (lambda, n, k); INSERT INTO m VALUES (1, -1, 0);".into(), "row 1, n: -1 is negative"),
    ];
    for (i, (statements, expected)) in cases.iter().enumerate() {
        let path = by_sql(&scratch, &format!("{i}.db"), statements);
        let told = Database::open(&path).unwrap().read("m").unwrap_err();
        assert!(matches!(told, Error::Invalid(_)), "{told}");
        let told = told.to_string();
        assert!(told.contains(&format!("{i}.db table m")) && told.contains(expected), "{statements}\n{told}");
    }
    // All at once, and no more than can be read.
    let many: Vec<String> = (1..100).map(|i| format!("({i},{i},-1,0,0)")).collect();
    let path = by_sql(&scratch, "many.db", &rows(&many.join(",")));
    let told = spectra::read(&path).unwrap_err().to_string();
    assert!(told.lines().count() == 21 && told.ends_with("and 79 more problems"), "{told}");

    // What is right, but looks wrong: fractions; whole numbers; a model without a table.
    let statements = rows("(1,1,1,0,0),(2,2,0.4,0,0)")
        + "CREATE TABLE _comments (model, Comments);
        INSERT INTO _comments VALUES ('m', NULL), ('lost', 'x');";
    let (all, report) = spectra::read(&by_sql(&scratch, "fractions.db", &statements)).unwrap();
    assert_eq!(all[0].column("reflectance").unwrap(), [0.01, 0.004]);
    let told: Vec<String> = report.notes.iter().map(ToString::to_string).collect();
    assert!(told[0].contains("table m: no reflectance is above 1: probably fractions"), "{told:?}");
    assert!(told[1].contains("table _comments: names \"lost\"") && told.len() == 2, "{told:?}");
}

#[test]
fn damaged_files_are_errors() {
    let scratch = Scratch::new();
    let path = scratch.path().join("good.db");
    let long: Vec<f64> = (1..=2000).map(|i| 0.3 + 1e-3 * f64::from(i)).collect();
    database::create(&path, &[paint(), library("long", &long, &[("reflectance", &vec![0.3; 2000])])], false).unwrap();
    let good = std::fs::read(&path).unwrap();
    let read = |bytes: &[u8]| Database::of(bytes.to_vec(), Path::new("x.db")).and_then(|db| db.read_all());
    assert_eq!(read(&good).unwrap().0.len(), 2);

    let mut noise = 88_172_645_463_325_252_u64;
    let mut random = move || {
        noise ^= noise << 13;
        noise ^= noise >> 7;
        noise ^= noise << 17;
        noise as usize
    };
    let with = |at: usize, value: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + value.len()].copy_from_slice(value);
        bytes
    };
    let random_page: Vec<u8> = good[..100].iter().copied().chain((100..good.len()).map(|_| random() as u8)).collect();
    let name = good.windows(11).position(|w| w == b"reflectance").unwrap();
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("empty", Vec::new(), "is not a SQLite database"),
        ("text", b"wavelength;reflectance\n1;2\n".repeat(100), "is not a SQLite database"),
        ("random", (0..9000).map(|_| random() as u8).collect(), "is not a SQLite database"),
        ("magic alone", good[..16].to_vec(), "is cut off"),
        ("header alone", good[..100].to_vec(), "is cut off"),
        ("a page", good[..4096].to_vec(), "is cut off: 4096 of"),
        ("a byte less", good[..good.len() - 1].to_vec(), "is cut off"),
        ("a byte less, and its length with it", with(28, &[0, 0, 0, 2])[..8192].to_vec(), "damaged"),
        ("random behind the header", random_page, "damaged"),
        ("zeros behind the header", good[..100].iter().copied().chain(vec![0; good.len() - 100]).collect(), "damaged"),
        ("page size 3", with(16, &[0, 3]), "x.db"),
        ("version 9", with(18, &[9, 9]), "x.db"),
        ("room for a cipher", with(20, &[255]), ""),
        ("text encoding 7", with(56, &[0, 0, 0, 7]), "x.db"),
        ("a table's page that is not there", with(28, &[0, 0, 0, 3]), "damaged"),
        ("schema's page turned into data", with(100, &[2]), "damaged"),
        ("cells that point at the header", with(108, &[0, 0]), "damaged"),
        ("a column's name that is not text", with(name, &[0xff]), "damaged"),
        ("cells that point beyond", with(108, &[255, 255]), "damaged"),
    ];
    assert!(cases.len() >= 15);
    for (name, bytes, expected) in &cases {
        match read(bytes) {
            Err(error) => {
                let told = error.to_string();
                assert!(told.starts_with("x.db") && told.contains(expected), "{name}: {told}");
            }
            Ok(_) => assert!(expected.is_empty(), "{name} was read"),
        }
        // Nothing is added to it either, and it stays as it is.
        let path = scratch.path().join("bad.db");
        std::fs::write(&path, bytes).unwrap();
        if database::append(&path, &[rpv()]).is_err() {
            assert_eq!(std::fs::read(&path).unwrap(), *bytes, "{name}");
        }
    }
    // Any damage is an error or is not seen; nothing panics or hangs.
    let heavy = crate::scratch::is_heavy();
    let mut refused = 0;
    for _ in 0..if heavy { 20_000 } else { 500 } {
        let mut bytes = good.clone();
        for _ in 0..1 + random() % 8 {
            let at = if random() % 2 == 0 { random() % 512 } else { random() % bytes.len() };
            bytes[at] = random() as u8;
        }
        if random() % 8 == 0 {
            bytes.truncate(random() % good.len());
        }
        refused += usize::from(read(&bytes).is_err());
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn what_files_define_is_not_run() {
    let scratch = Scratch::new();
    let told = |name: &str, statements: &str| {
        let path = by_sql(&scratch, name, statements);
        spectra::read(&path).unwrap_err().to_string()
    };
    // Functions in generated columns.
    let bomb = "CREATE TABLE m (wavelength DOUBLE, reflectance AS (hex(zeroblob(wavelength * 100000))));
                INSERT INTO m VALUES (1), (2);";
    assert!(told("function.db", bomb).contains("table m: a table with computed columns is not supported"));
    // Values, tables and statements of any length.
    let blob = "CREATE TABLE m (wavelength, reflectance); INSERT INTO m VALUES (1, zeroblob(50000000));";
    assert!(told("blob.db", blob).contains("too big"));
    let names: Vec<String> = (0..1900).map(|i| format!("c{i}")).collect();
    assert!(told("wide.db", &format!("CREATE TABLE m (wavelength, {});", names.join(","))).contains("1901 columns"));
    let rows = "CREATE TABLE m (wavelength, reflectance);
                INSERT INTO m WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c WHERE x < 200001) SELECT x, 1 FROM c;";
    assert!(told("rows.db", rows).contains("more than 200000 rows"));
    // Views and virtual tables are no models; names are quoted.
    let strange = "CREATE TABLE \"a\"\" --;\" (\"wave length\", wavelength, \"x\"\"\");
                   CREATE VIEW v AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x FROM c) SELECT x AS wavelength FROM c;
                   CREATE VIRTUAL TABLE f USING fts5(wavelength);";
    let models = database::models(&by_sql(&scratch, "strange.db", strange)).unwrap();
    assert_eq!(
        models.iter().filter(|m| !m.name.starts_with("f_")).map(|m| m.name.as_str()).collect::<Vec<_>>(),
        ["a\" --;"]
    );
    // Another program is writing.
    let path = by_sql(
        &scratch,
        "open.db",
        "PRAGMA journal_mode = WAL; CREATE TABLE m (wavelength); INSERT INTO m VALUES (1);",
    );
    let writer = Connection::open(&path).unwrap();
    writer.execute_batch("BEGIN IMMEDIATE; INSERT INTO m VALUES (2); COMMIT;").unwrap();
    let told = spectra::read(&path).unwrap_err().to_string();
    assert!(told.contains("open.db: a program is writing to it") && told.contains("open.db-wal"), "{told}");
    drop(writer);
    assert_eq!(spectra::read(&path).unwrap().0[0].wavelength_um, [1.0, 2.0]);
    // A lock does not matter to who reads a copy.
    let locked = by_sql(&scratch, "locked.db", "CREATE TABLE m (wavelength, x); INSERT INTO m VALUES (1, 2);");
    let writer = Connection::open(&locked).unwrap();
    writer.execute_batch("BEGIN EXCLUSIVE").unwrap();
    assert_eq!(spectra::read(&locked).unwrap().0.len(), 1);
}

#[test]
fn a_hundred_spectra_of_300_bands_take_less_than_a_second() {
    let scratch = Scratch::new();
    let path = scratch.path().join("a.db");
    let wavelength_um: Vec<f64> = (0..300).map(|i| 0.95 + f64::from(i) * 2.65 / 299.0).collect();
    let spectrum = |i: usize| {
        let reflectance: Vec<f64> =
            wavelength_um.iter().map(|um| (0.05 + 0.01 * um).powf(1.0 + i as f64 / 100.0)).collect();
        library(&format!("material_{i}"), &wavelength_um, &[("reflectance", &reflectance)])
    };
    let all: Vec<SpectralLibrary> = (0..100).map(spectrum).collect();
    let began = Instant::now();
    database::create(&path, &all, false).unwrap();
    let written = began.elapsed();
    let (back, _) = spectra::read(&path).unwrap();
    let read = began.elapsed() - written;
    for (a, b) in all.iter().zip(&back) {
        assert_eq!(a.wavelength_um, b.wavelength_um);
        for (a, b) in a.columns[0].values.iter().zip(b.column("reflectance").unwrap()) {
            assert!((a - b).abs() <= 1e-15 * a, "{a} {b}");
        }
    }
    // Time is only counted where nothing else runs.
    if crate::scratch::is_heavy() {
        assert!(written.as_secs_f64() < 1.0 && read.as_secs_f64() < 1.0, "{written:?} {read:?}");
    }
}

#[test]
fn columns_that_are_not_darts_do_not_take_the_place_of_its_own() {
    let scratch = Scratch::new();
    let path = scratch.join("a.db");
    let column = |name: &str, values: [f64; 2]| Column { name: name.into(), values: values.to_vec() };
    let library = |columns: Vec<Column>| SpectralLibrary {
        name: "rock".into(),
        comment: String::new(),
        wavelength_um: vec![1.0, 2.0],
        columns,
    };
    // DART would read the standard deviation as a transmittance: the third column.
    let measured = library(vec![column("reflectance", [0.1, 0.2]), column("sigma", [0.01, 0.02])]);
    let report = database::create(&path, &[measured], false).unwrap();
    assert!(report.notes.iter().any(|n| n.fate == Fate::Dropped && n.message.starts_with("sigma: ")), "{report:#?}");
    let (back, _) = Database::open(&path).unwrap().read("rock").unwrap();
    assert_eq!(
        back.columns,
        [
            column("reflectance", [0.1, 0.2]),
            column("direct_transmittance", [0.0; 2]),
            column("diffuse_transmittance", [0.0; 2])
        ]
    );
    // A reflectance with some of RPV's parameters is no Lambert surface.
    let half = library(vec![column("reflectance", [0.1, 0.2]), column("k", [0.8, 0.8])]);
    let report = database::create(&path, &[half], true).unwrap();
    assert!(
        report.notes.iter().any(|n| n.message.contains("not known to have tables of reflectance, k")),
        "{report:#?}"
    );
}
