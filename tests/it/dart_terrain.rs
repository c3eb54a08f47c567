//! Terrains and repeated scenes of DART: heights, areas and places worked out by hand, and rasters that cannot be.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::DVec3;

use mmxrt::formats::convert::{Content, differences};
use mmxrt::formats::dart::{self, Converted, Finding, ReadOptions, SceneOptions, Severity, no_summary};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;

use crate::cli::run;
use crate::scratch::Scratch;

/// 12 m South by 9 m East: lines of heights 4 m apart, columns 3 m. The ground rises by a half to the South; on its East edge, 4 m from
/// the North, stands a peak.
const HEIGHTS: [f64; 16] = [0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 8.0, 4.0, 4.0, 4.0, 4.0, 6.0, 6.0, 6.0, 6.0];

/// A peg: a tetrahedron from -1 to 1 m of z, 1 m along x and y. An OBJ has y z x.
const PEG: &str = "v -0.5 -1 -0.5\nv -0.5 -1 0.5\nv 0.5 -1 0\nv 0 1 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn header(rows: usize, columns: usize, bounds: &str) -> String {
    format!(
        "[Ilwis]\n[BaseMap]\nCoordBounds={bounds}\n[Map]\nSize={rows} {columns}\n[MapStore]\nType=Real\nRowLength={columns}\n"
    )
}

fn bytes(heights_m: &[f64]) -> Vec<u8> {
    heights_m.iter().flat_map(|h| h.to_le_bytes()).collect()
}

/// Pegs, as an ObjectList: place and `objectDEMMode`.
fn pegs(places: &[(DVec3, u32)]) -> String {
    let object = |(i, (at, mode)): (usize, &(DVec3, u32))| {
        format!(
            r#"<Object name="peg {i}" file_src="peg.obj" hasGroups="0" hidden="0" objectDEMMode="{mode}" repeatedOnBorder="1">
            <GeometricProperties><PositionProperties xpos="{}" ypos="{}" zpos="{}"/>
            <ScaleProperties xscale="1" yscale="1" zscale="1"/><RotationProperties xrot="0" yrot="0" zrot="0"/></GeometricProperties>
            <ObjectOpticalProperties doubleFace="0"><OpticalPropertyLink type="0" indexFctPhase="0" ident="rock"/>
            <ThermalPropertyLink indexTemperature="0" idTemperature="warm"/></ObjectOpticalProperties></Object>"#,
            at.x, at.y, at.z
        )
    };
    places.iter().enumerate().map(object).collect()
}

/// A simulation with this terrain, in `sim` of a scratch folder.
struct Simulation(Scratch);

impl Simulation {
    fn new(places: &[(DVec3, u32)]) -> Self {
        let scratch = Scratch::new();
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dart/boulder_574/input");
        std::fs::create_dir_all(scratch.join("sim/input")).unwrap();
        for file in std::fs::read_dir(from).unwrap().map(|f| f.unwrap().path()).filter(|f| f.is_file()) {
            std::fs::copy(&file, scratch.join("sim/input").join(file.file_name().unwrap())).unwrap();
        }
        scratch.write("sim/input/peg.obj", PEG);
        let root = r#"<DartFile version="5.7.4" build="v1083"><object_3d><ObjectList>"#;
        let end = "</ObjectList></object_3d></DartFile>";
        scratch.write("sim/input/object_3d.xml", format!("{root}{}{end}", pegs(places)));
        let simulation = Simulation(scratch);
        simulation.raster(&header(4, 4, "0 -9 12 0"), &bytes(&HEIGHTS));
        // The Sun of E490, at 1 au.
        simulation.replace("phase.xml", r#"irradianceMode="1""#, r#"irradianceMode="0""#);
        simulation
    }

    fn raster(&self, header: &str, values: &[u8]) {
        self.0.write("sim/input/DEM.mpr", header);
        self.0.write("sim/input/DEM.mp#", values);
    }

    fn maket(&self, from: &str, to: &str) {
        self.replace("maket.xml", from, to);
    }

    fn replace(&self, file: &str, from: &str, to: &str) {
        self.0.edit(&format!("sim/input/{file}"), from, to);
    }

    fn boundary(self, boundary: u32) -> Self {
        self.maket(r#"exactlyPeriodicScene="0""#, &format!(r#"exactlyPeriodicScene="{boundary}""#));
        self
    }

    fn repeated(&self, repeat: u32) -> mmxrt::Result<Converted> {
        let path = self.0.join("sim");
        let (simulation, report, _) = dart::read(&path, &ReadOptions::default())?;
        let options = SceneOptions { repeat, ..SceneOptions::default() };
        let mut converted = dart::to_scene(&simulation, &dart::Folder::new(&path, None, false), &options, &unwatched)?;
        converted.report.notes.extend(report.notes);
        Ok(converted)
    }

    fn converted(&self) -> Converted {
        self.repeated(0).unwrap_or_else(|e| panic!("{e}"))
    }

    fn error(&self, repeat: u32) -> String {
        self.repeated(repeat).map(|_| ()).unwrap_err().to_string().replace(&format!("{}/", self.0.path().display()), "")
    }

    fn findings(&self) -> Vec<Finding> {
        let mut found = dart::check(&self.0.join("sim"), &ReadOptions::default(), &no_summary);
        // The simulation holds what is read, and not all that version 5.7.4 wants.
        found.retain(|f| !(f.what.starts_with('`') && f.what.ends_with("` is missing")));
        found
    }
}

/// Notes of terrains and of what stands on them, as "fate file:line message".
fn told(converted: &Converted) -> Vec<String> {
    let words = ["terrain", "heights", "slope", "beyond", "stays where"];
    let notes = converted.report.notes.iter().filter(|n| words.iter().any(|word| n.message.contains(word)));
    notes
        .map(|n| {
            let file = n.at.file.as_ref().map_or("", |f| f.file_name().unwrap().to_str().unwrap());
            format!("{} {file}:{} {}", n.fate, n.at.line.unwrap_or(0), n.message)
        })
        .collect()
}

/// DART's coordinates of the scene's: from x East, y North of the middle of 12 x 9 m.
fn in_dart_m(v: DVec3) -> DVec3 {
    DVec3::new(6.0 - v.y, v.x + 4.5, v.z)
}

/// The vertices of facets of a material, in DART's frame.
fn vertices_m(scene: &Scene, material: &str) -> Vec<DVec3> {
    let id = scene.body.materials.iter().position(|m| m.name == material).unwrap();
    let facets = (0..scene.body.mesh.facets.len()).filter(|f| usize::from(scene.body.mesh.material[*f].0) == id);
    facets.flat_map(|f| scene.body.mesh.facet(f).corners_m).map(in_dart_m).collect()
}

/// Whether a point is among these, to within rounding of sums of a few metres.
fn has(vertices_m: &[DVec3], x: f64, y: f64, z: f64) -> bool {
    vertices_m.iter().any(|v| (*v - DVec3::new(x, y, z)).length() < 1e-13 * 30.0)
}

/// Edges that belong to one facet only, by their ends' coordinates.
fn open_edges(scene: &Scene) -> usize {
    let bits = |v: u32| scene.body.mesh.vertices_m[v as usize].to_array().map(f64::to_bits);
    let mut edges = BTreeMap::new();
    for [a, b, c] in &scene.body.mesh.facets {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from, to) = (bits(*from), bits(*to));
            *edges.entry((from.min(to), from.max(to))).or_insert(0) += 1;
        }
    }
    edges.values().filter(|count| **count == 1).count()
}

#[test]
fn a_raster_becomes_the_ground() {
    let simulation = Simulation::new(&[]);
    let converted = simulation.converted();
    let scene = &converted.scene;
    assert_eq!((scene.body.mesh.facets.len(), scene.body.mesh.vertices_m.len()), (18, 16));
    // Made of the soil's property, two facets to a face.
    let ground = vertices_m(scene, "dust");
    assert_eq!(ground.len(), 54);
    assert!((0..18).all(|f| scene.body.mesh.face(f) == f as u32 / 2));
    // Line i, column j: 4 i m South and 3 j m East of the North-West corner.
    for (i, j, height) in (0..16).map(|n| (n / 4, n % 4, HEIGHTS[n])) {
        assert!(has(&ground, 4.0 * i as f64, 3.0 * j as f64, height), "{i} {j} {height}");
    }
    // The peak is East and North of the middle, the high edge South: in the scene's own axes.
    assert!(scene.body.mesh.vertices_m.contains(&DVec3::new(4.5, 2.0, 8.0)));
    assert!(scene.body.mesh.vertices_m.contains(&DVec3::new(-4.5, -6.0, 6.0)));
    assert!((0..18).all(|f| scene.body.mesh.facet(f).normal().z > 0.0));
    // Seven cells of 3 m by sqrt(4^2 + 2^2) m. The two at the peak are cut along the shorter diagonal: from 2 to 0 m, and from 2 to
    // 4 m. Half of each lies in the slope, half the cross products of the others are (-24, -24, 12) / 2 and (12, -24, 12) / 2.
    let expected = 8.0 * 3.0 * 20f64.sqrt() + 18.0 + 0.5 * 864f64.sqrt();
    let area: f64 = (0..18).map(|f| scene.body.mesh.facet(f).area_m2()).sum();
    assert!((area - expected).abs() < 1e-12 * expected, "{area} {expected}");
    let on_the_map: f64 = (0..18).map(|f| 0.5 * scene.body.mesh.facet(f).cross_m2().z).sum();
    assert!((on_the_map - 108.0).abs() < 1e-12, "{on_the_map}");
    assert_eq!(open_edges(scene), 12);
    // The raster is an input like all others, and what is inferred is said where it is named.
    assert!(["DEM.mpr", "DEM.mp#"].iter().all(|f| converted.inputs.iter().any(|i| i.path.ends_with(f))));
    let told = told(&converted);
    assert!(told[0].starts_with("Defaulted maket.xml:13 4 x 4 heights over z = 0, 4 x 3 m apart"), "{told:#?}");
    assert_eq!(told.len(), 1, "{told:#?}");
}

#[test]
fn objects_stand_on_the_terrain_where_they_are_meant_to() {
    let exact = DVec3::new(3.0, 3.0, 20.0);
    let simulation = Simulation::new(&[
        // On the slope, 6 m from the North edge: 3 m high.
        (DVec3::new(6.0, 1.5, 77.0), 0),
        // On the peak's side, in the plane through (4, 6, 2), (4, 9, 8) and (0, 9, 0): 2 + 2 (x - 4) + 2 (y - 6) = 2.
        (DVec3::new(2.0, 8.0, -5.0), 0),
        (exact, 2),
        (exact + DVec3::X, 1),
        (exact + DVec3::Y, 3),
    ]);
    let converted = simulation.converted();
    let pegs = vertices_m(&converted.scene, "rock");
    assert_eq!(pegs.len(), 5 * 12);
    // The tip is 2 m above the lowest point.
    assert!(has(&pegs, 6.0, 1.5, 5.0) && has(&pegs, 5.5, 1.0, 3.0), "{pegs:?}");
    assert!(has(&pegs, 2.0, 8.0, 4.0) && has(&pegs, 2.0, 8.5, 2.0), "{pegs:?}");
    for at in [exact, exact + DVec3::X, exact + DVec3::Y] {
        assert!(has(&pegs, at.x, at.y, 21.0) && has(&pegs, at.x, at.y + 0.5, 19.0), "{at}");
    }
    let told = told(&converted);
    assert_eq!(told.len(), 4, "{told:#?}");
    assert!(told[1].contains("is part of the terrain") && told[2].contains("for each group"), "{told:#?}");
    // Below the second one: at (1.5, 7.5) in the slope 0.75 m, at (2.5, 7.5) 2 - 3 + 3 = 2 m, at (2, 8.5) 3 m.
    assert!(told[3].starts_with("Approximated object_3d.xml:1 \"peg 0\" and 1 more on the terrain"), "{told:#?}");
    assert!(told[3].ends_with("differs by up to 2.25 m"), "{told:#?}");

    // Without a terrain the ground is at z = 0, and nothing is inferred of it.
    simulation.maket(r#"presenceOfTopography="1""#, r#"presenceOfTopography="0""#);
    let converted = simulation.converted();
    let pegs = vertices_m(&converted.scene, "rock");
    assert!(has(&pegs, 6.0, 1.5, 2.0) && has(&pegs, 2.0, 8.5, 0.0) && has(&pegs, 3.0, 3.0, 21.0));
    assert_eq!(self::told(&converted).len(), 2);
}

#[test]
fn a_repeated_scene_goes_on_beyond_its_edges() {
    // The second one stands astride the North edge.
    let simulation = Simulation::new(&[(DVec3::new(6.0, 1.5, 0.0), 0), (DVec3::new(0.0, 4.5, 9.0), 2)]).boundary(1);
    let alone = simulation.converted();
    // The last line and column are the first ones: 0 2 4 0 from North to South, all the way to the East.
    assert_eq!(alone.scene.body.mesh.facets.len(), 18 + 8);
    let ground = vertices_m(&alone.scene, "dust");
    assert!(has(&ground, 4.0, 9.0, 2.0) && has(&ground, 12.0, 9.0, 0.0) && has(&ground, 8.0, 9.0, 4.0));
    let told = told(&alone);
    assert!(told[1].starts_with("Dropped maket.xml:13 the last line and column of heights"), "{told:#?}");
    assert!(told[1].ends_with("they move by up to 6 m"), "{told:#?}");
    assert!(told[2].starts_with("Dropped maket.xml:3 ") && told[2].contains("`--repeat N`"), "{told:#?}");
    assert!(told[3].contains("\"peg 1\" reaches beyond the scene's edge"), "{told:#?}");

    let converted = simulation.repeated(1).unwrap();
    let scene = &converted.scene;
    assert_eq!(scene.body.mesh.facets.len(), 9 * 26);
    let (ground, pegs) = (vertices_m(scene, "dust"), vertices_m(scene, "rock"));
    let distinct: BTreeSet<_> = ground.iter().map(|v| v.to_array().map(f64::to_bits)).collect();
    // Scenes share their edges: 10 x 10 points, and nothing open but the outer edge of 36 and no side of a peg.
    assert_eq!((ground.len(), distinct.len(), open_edges(scene)), (9 * 54, 100, 36));
    for (k, l) in (-1..=1).flat_map(|k| (-1..=1).map(move |l| (f64::from(k), f64::from(l)))) {
        let (x, y) = (12.0 * k, 9.0 * l);
        assert!(has(&ground, x + 4.0, y + 3.0, 2.0) && has(&ground, x + 8.0, y, 4.0), "{k} {l}");
        assert!(has(&pegs, x + 6.0, y + 1.5, 5.0) && has(&pegs, x, y + 4.5, 10.0), "{k} {l}");
    }
    // What hangs over the North edge comes in from the copy in the South.
    assert!(has(&pegs, 11.5, 4.0, 8.0));
    let (low, high) = scene.body.mesh.bounds_m().unwrap();
    assert_eq!((low.x, low.y, high.x, high.y), (-13.5, -18.0, 13.5, 18.5));
    assert!((0..9 * 26).map(|f| scene.body.mesh.face(f)).collect::<BTreeSet<_>>().len() == 9 * (8 + 9));
    let told = self::told(&converted);
    assert!(!told.iter().any(|t| t.contains("beyond")), "{told:#?}");
}

#[test]
fn an_infinite_slope_rises_from_scene_to_scene() {
    let simulation = Simulation::new(&[(DVec3::new(6.0, 1.5, 0.0), 0)]).boundary(2);
    let converted = simulation.repeated(1).unwrap();
    let (ground, pegs) = (vertices_m(&converted.scene, "dust"), vertices_m(&converted.scene, "rock"));
    // From North to South by 6 m. From West to East by the mean of 0, 6, 0 and 0 m. The peak is cut down from 8 to 2 + 1.5 m.
    assert!(has(&ground, 4.0, 9.0, 3.5) && has(&ground, 12.0, 9.0, 7.5));
    assert!(has(&ground, 16.0, 0.0, 8.0) && has(&ground, 24.0, 18.0, 15.0) && has(&ground, -12.0, -9.0, -7.5));
    assert!(has(&pegs, 18.0, 1.5, 11.0) && has(&pegs, 6.0, 10.5, 6.5) && has(&pegs, -6.0, -7.5, -2.5), "{pegs:?}");
    assert_eq!(open_edges(&converted.scene), 36);
    let told = told(&converted);
    assert!(
        told[1].starts_with(
            "Approximated maket.xml:13 an infinite slope: the ground rises by 6 m along x and 1.5 m along y"
        )
    );
    assert!(told[1].contains("move by up to 4.5 m"), "{told:#?}");
}

#[test]
fn a_plane_and_an_object_repeat_too() {
    let simulation = Simulation::new(&[]).boundary(2);
    simulation.maket(r#"presenceOfTopography="1""#, r#"presenceOfTopography="0""#);
    let scene = simulation.repeated(2).unwrap().scene;
    let area: f64 = (0..scene.body.mesh.facets.len()).map(|f| scene.body.mesh.facet(f).area_m2()).sum();
    assert_eq!((scene.body.mesh.facets.len(), area, open_edges(&scene)), (50, 25.0 * 108.0, 20));
    assert!(scene.body.mesh.vertices_m.iter().all(|v| v.z == 0.0));
    // 64 x 48 m of an OBJ without a ground below it: a slope that drops by 8 m at each edge to the South, and joins to the East.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dart/crater_511");
    let (simulation, ..) = dart::read(&path, &ReadOptions::default()).unwrap();
    let options = SceneOptions { repeat: 1, ..SceneOptions::default() };
    let folder = dart::Folder::new(&path, None, false);
    let scene = dart::to_scene(&simulation, &folder, &options, &unwatched).unwrap().scene;
    let distinct: BTreeSet<_> = scene.body.mesh.vertices_m.iter().map(|v| v.to_array().map(f64::to_bits)).collect();
    assert_eq!((scene.body.mesh.facets.len(), scene.body.mesh.vertices_m.len(), distinct.len()), (18, 36, 6 * 4));
}

#[test]
fn what_cannot_be_repeated_says_what_to_do() {
    let simulation = Simulation::new(&[(DVec3::new(6.0, 1.5, 0.0), 0); 3]);
    let error = simulation.error(1);
    assert!(error.starts_with("sim/input/maket.xml:3:5 Maket/@exactlyPeriodicScene: the scene is isolated"), "{error}");
    let simulation = simulation.boundary(1);
    // 30 facets or vertices of a scene: (2 N + 1)^2 times as many fit into 2^26 up to N = 747.
    assert!(1495_u64.pow(2) * 30 <= 1 << 26 && 1497_u64.pow(2) * 30 > 1 << 26);
    for repeat in [748, 1 << 16, u32::MAX] {
        let error = simulation.error(repeat);
        assert!(error.contains("`--repeat 747` is the most that fits"), "{error}");
    }
    assert_eq!(simulation.repeated(2).unwrap().scene.body.mesh.facets.len(), 25 * 30);
    // Nothing, as often as you like.
    let nothing = Simulation::new(&[]).boundary(1);
    nothing.maket("<Soil>", r#"<Soil groundEnabled="0">"#);
    assert!(nothing.error(u32::MAX).contains("no objects and no ground that is seen"));
}

#[test]
fn a_raster_that_cannot_be_is_refused_at_its_place() {
    let good = header(4, 4, "0 -9 12 0");
    let mut hole = HEIGHTS;
    hole[6] = f64::NAN;
    let mut endless = HEIGHTS;
    endless[15] = f64::INFINITY;
    let cases: &[(&str, Vec<u8>, &str)] = &[
        (&good, bytes(&hole), "sim/input/DEM.mp#: holds heights that are not finite numbers, first in row 2, column 3"),
        (&good, bytes(&endless), "first in row 4, column 4"),
        (
            &good,
            bytes(&HEIGHTS[..15]),
            "sim/input/DEM.mp#: holds 120 bytes where 128 (4 rows x 4 columns x 8 bytes) belong",
        ),
        (&good, bytes(&HEIGHTS)[..127].to_vec(), "holds 127 bytes where 128"),
        (&good, b"DRTDB\x42\xc8".to_vec(), "sim/input/DEM.mp#: a terrain in the format of newer versions"),
        (
            &header(4, 4, "0 -9 24 0"),
            bytes(&HEIGHTS),
            "sim/input/DEM.mpr: spans 24 x 9 m by its `CoordBounds`, but the scene is 12 x 9 m",
        ),
        (&header(4, 4, "0 -12 9 0"), bytes(&HEIGHTS), "sim/input/DEM.mpr: spans 9 x 12 m"),
        (&header(1, 16, "0 -9 12 0"), bytes(&HEIGHTS), "sim/input/DEM.mpr: a terrain of 1 x 16 heights"),
        (&header(16, 1, "0 -9 12 0"), bytes(&hole), "not finite numbers, first in row 7, column 1"),
    ];
    let simulation = Simulation::new(&[]);
    for (header, values, message) in cases {
        simulation.raster(header, values);
        let error = simulation.error(0);
        assert!(error.contains(message), "{message}: {error}");
        // A check says the same, but of what may be right for DART.
        let found = simulation.findings();
        if values.starts_with(b"DRTDB") {
            assert!(!found.iter().any(|f| f.severity == Severity::Error), "{found:#?}");
            continue;
        }
        let said = message.trim_start_matches("sim/input/").split(": ").last().unwrap();
        assert!(found.iter().any(|f| f.severity == Severity::Error && f.to_string().contains(said)), "{found:#?}");
    }
    // All that is wrong is told at once.
    simulation.raster(&header(16, 1, "0 -9 1200 0"), &bytes(&hole));
    assert_eq!(
        simulation.error(0).lines().filter(|line| line.contains("DEM.mp")).count(),
        3,
        "{}",
        simulation.error(0)
    );
    // Without bounds, with those of lines and columns from the first to the last, or one pixel off, it is stretched over the scene.
    for bounds in ["undef", "0 -12 16 0", "0 -9 9.6 0"] {
        simulation.raster(&header(4, 4, bounds), &bytes(&HEIGHTS));
        assert!(has(&vertices_m(&simulation.converted().scene, "dust"), 12.0, 9.0, 6.0), "{bounds}");
    }
    for file in ["DEM.mpr", "DEM.mp#"] {
        std::fs::remove_file(simulation.0.join("sim/input").join(file)).unwrap();
    }
    // One that is not there leaves the rest: a plane, and said so.
    let told = self::told(&simulation.converted());
    let missing = "Dropped maket.xml:13 the terrain \"DEM.mp#\" is not there: the ground is a plane at z = 0";
    assert!(told.iter().any(|note| note.starts_with(missing)), "{told:#?}");
}

#[test]
fn what_dart_makes_a_terrain_of_is_told() {
    let simulation = Simulation::new(&[(DVec3::new(6.0, 1.5, 0.0), 0)]);
    let generator = |case: u32, output: &str| {
        format!(
            r#"<DEM_properties createTopography="1">
            <DEMGenerator caseDEM="{case}" outputFileName="{output}"><DEM_{case} fileName="hills.txt"/></DEMGenerator></DEM_properties>"#
        )
    };
    let mut now = r#"<DEM_properties createTopography="0"/>"#.to_owned();
    for (case, what) in
        (1..).zip(["synthetic shapes", "part of another raster", "hills", "turned", "another format", "not known"])
    {
        simulation.maket(&now, &generator(case, "DEM.mp#"));
        now = generator(case, "DEM.mp#");
        let told = self::told(&simulation.converted());
        let note = told.iter().find(|t| t.contains("DART makes")).unwrap();
        assert!(note.starts_with("Dropped maket.xml:16 DART makes a terrain of") && note.contains(what), "{note}");
    }
    for file in ["DEM.mpr", "DEM.mp#"] {
        std::fs::remove_file(simulation.0.join("sim/input").join(file)).unwrap();
    }
    // It is not made yet: a plane, and said so.
    let converted = simulation.converted();
    assert!(has(&vertices_m(&converted.scene, "rock"), 6.0, 1.5, 2.0));
    let told = told(&converted);
    assert!(
        told[0].starts_with("Dropped maket.xml:13 the terrain \"DEM.mp#\" is not there, because DART makes it"),
        "{told:#?}"
    );
    // Another one is made: then this one is missing.
    simulation.maket(&now, &generator(1, "other.mp#"));
    let told = self::told(&simulation.converted());
    assert!(told.iter().any(|note| note.contains("the terrain \"DEM.mp#\" is not there: the ground")), "{told:#?}");
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_terrain_survives_the_way_to_dart_and_back() {
    let simulation = Simulation::new(&[(DVec3::new(6.0, 1.5, 0.0), 0)]).boundary(1);
    let scratch = &simulation.0;
    let argument = |name: &str| scratch.argument(name);
    let (code, out, err) = run(&["convert", &argument("sim"), &argument("a/scene.toml"), "--repeat", "1"]);
    assert!(code == 0 && out.contains("198 facets"), "{out}{err}");
    let (code, out, err) = run(&["convert", &argument("a/scene.toml"), &argument("again")]);
    assert!(code == 0 && !out.contains("Dropped"), "{out}{err}");
    let (code, out, err) = run(&["convert", &argument("again"), &argument("b/scene.toml")]);
    assert!(code == 0 && !out.contains("Dropped") && !out.contains("Approximated"), "{out}{err}");
    let (code, out, err) = run(&["convert", "--diff", &argument("a/scene.toml"), &argument("b/scene.toml")]);
    assert!(code == 0 && out.contains("the same in meaning"), "{out}{err}");
    // What was written is isolated.
    let (code, _, err) = run(&["convert", &argument("again"), &argument("c/scene.toml"), "--repeat", "1"]);
    assert!(code == 1 && err.contains("the scene is isolated"), "{err}");
    // Nothing else than a simulation repeats.
    let (code, _, err) = run(&["convert", &argument("a/scene.toml"), &argument("c.glb"), "--repeat", "1"]);
    assert!(code == 1 && err.contains("only the scene of a DART simulation can be repeated"), "{err}");
    let (code, _, err) = run(&["convert", &argument("sim"), &argument("c.glb"), "--repeat", "-1"]);
    assert_eq!(code, 2, "{err}");
    let (code, out, err) = run(&["convert", &argument("sim"), &argument("d/scene.toml"), "--strict"]);
    assert!(code == 3 && out.contains("`--repeat N` takes N more on each side"), "{out}{err}");
}

#[test]
fn a_difference_of_terrains_is_one_of_meshes() {
    let (a, b) = (Simulation::new(&[]), Simulation::new(&[]));
    let content = |simulation: &Simulation| Content::Scene(Box::new(simulation.converted().scene), Vec::new());
    assert_eq!(differences(&content(&a), &content(&b)), [""; 0]);
    let diff = || run(&["convert", "--diff", &a.0.argument("sim"), &b.0.argument("sim")]);
    let (code, out, err) = diff();
    assert!(code == 0 && out.contains("the same in meaning"), "{out}{err}");
    let mut heights_m = HEIGHTS;
    heights_m[5] += 0.25;
    b.raster(&header(4, 4, "0 -9 12 0"), &bytes(&heights_m));
    let (code, out, err) = diff();
    assert!(code == 1 && out.starts_with("mesh"), "{out}{err}");
}

#[test]
fn a_check_knows_that_a_repeated_terrain_meets_itself() {
    let cliff = |simulation: &Simulation| {
        let found = simulation.findings();
        assert!(found.iter().all(|f| f.severity == Severity::Warning || !f.what.contains("height")), "{found:#?}");
        found.into_iter().find(|f| f.what.contains("opposite edges"))
    };
    let simulation = Simulation::new(&[]);
    assert_eq!(cliff(&simulation), None);
    let simulation = simulation.boundary(1);
    // 6 m from North to South, and from West to East at the peak.
    let found = cliff(&simulation).unwrap();
    assert!(found.what.ends_with("differ by up to 6 m") && found.at.line == Some(13), "{found}");
    simulation.raster(&header(2, 2, "0 -9 12 0"), &bytes(&[3.0; 4]));
    assert_eq!(cliff(&simulation), None);
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_black_terrain_is_no_sky() {
    // A written simulation has a ground that stands for the sky: a black table at 0 K. With hills it would hide what is behind them.
    let simulation = Simulation::new(&[(DVec3::new(6.0, 1.5, 0.0), 2)]);
    let scratch = &simulation.0;
    simulation.maket(r#"presenceOfTopography="1""#, r#"presenceOfTopography="0""#);
    let argument = |name: &str| scratch.argument(name);
    for (from, to) in [("sim", "a/scene.toml"), ("a/scene.toml", "black"), ("black", "b/scene.toml")] {
        let (code, _, err) = run(&["convert", &argument(from), &argument(to)]);
        assert_eq!(code, 0, "{err}");
    }
    let path = scratch.join("black/input/maket.xml");
    let maket = std::fs::read_to_string(&path).unwrap();
    let terrain = r#"<Topography presenceOfTopography="1"><TopographyProperties fileName="DEM.mp#"/></Topography>"#;
    let edited = maket.replace(r#"<Topography presenceOfTopography="0"/>"#, terrain);
    assert_ne!(maket, edited);
    std::fs::write(path, edited).unwrap();
    scratch.write("black/input/DEM.mpr", header(2, 2, "undef"));
    scratch.write("black/input/DEM.mp#", bytes(&[0.5; 4]));
    let (code, out, err) = run(&["convert", &argument("black"), &argument("c/scene.toml")]);
    assert!(code == 0 && out.contains(": 8 facets"), "{out}{err}");
    let (code, out, err) = run(&["convert", "--list", &argument("b/scene.toml")]);
    assert!(code == 0 && out.contains("6 facets"), "{out}{err}");
}
