//! The chart of error against time: its methods against closed forms, and what its files hold.

use glam::DVec3;
use mmxrt::geometry::{MaterialId, Mesh};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::study::chart::{Case, Method, Question, Shadows, chart};
use mmxrt::visibility::RayTree;
use mmxrt::visibility::Topology;

use crate::cli::run;
use crate::scenes::{SITE, edited, replaced, scene};
use crate::scratch::Scratch;
use crate::shapes::*;
use crate::stability::rows;

/// Fewer pixels than the site has: a chart casts 1365 rays in each, several times.
const SMALL: [(&str, &str); 2] = [("samples = 16", "samples = 8"), ("lines = 16", "lines = 8")];

fn image(method: Method, scene: &Scene) -> Vec<f64> {
    let case = Case::new(scene, &unwatched).unwrap();
    let prepared = method.prepared(&case).unwrap();
    method.image(&case, &prepared, &unwatched).unwrap().remove(0)
}

/// Radiance of flat ground of reflectance 0.07 under a Sun of 700 W m-2 um-1 at 1.5 au, at the zenith.
fn lit() -> f64 {
    0.07 / std::f64::consts::PI * 700.0 / 2.25
}

#[test]
fn rays_converge_on_a_pixel_that_is_half_covered() {
    // A square whose diagonal edge x + y = 0.1 cuts the one pixel, 2 m wide: 0.5 + 0.1 - 0.1^2 / 8 ... of it by hand: the triangle
    // beyond x + y = 0.1 has legs 1.9, so 1 - 1.9^2 / 8 is covered.
    let covered = 1.0 - 1.9 * 1.9 / 8.0;
    let [a, b, c] = [[-50.0, -50.0, 0.0], [50.1, -50.0, 0.0], [-50.0, 50.1, 0.0]];
    let scene = scene(mesh(&[a, b, c], &[[0, 1, 2]]), nadir(1000.0, 2.0, 1), [0.0, 0.0, 1.0]);
    let off = |rays: u32| (image(Method::Rays(rays), &scene)[0] / lit() - covered).abs();
    for (rays, most) in [(1, 0.5), (16, 0.1), (256, 0.02), (4096, 0.004)] {
        assert!(off(rays) <= most, "{rays} rays: {:e}", off(rays));
    }
    assert!((image(Method::Exact, &scene)[0] / lit() - covered).abs() < 1e-12);
}

/// Ground cut into 20 x 20 cells, and a box of 2 x 2 x 2 m on it.
fn box_on_ground() -> Mesh {
    joined(&[grid(10.0, 20, |_, _| 0.0), cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0])])
}

#[test]
fn ways_to_find_shadows_differ_where_facets_are_lit_in_part() {
    // The Sun 45 deg high in the east: the shadow is the 2 x 2 m square west of the box, along edges of cells of 1 m.
    let at_edges = scene(box_on_ground(), nadir(1000.0, 20.0, 20), [1.0, 0.0, 1.0]);
    let ground = lit() * 0.5_f64.sqrt();
    let sum = |image: &[f64]| image.iter().sum::<f64>() / ground;
    // 400 pixels, 4 in shadow; of the box the top is lit like the ground.
    for method in [Method::Exact, Method::Shadows(Shadows::Centroid), Method::Shadows(Shadows::Share), Method::Rays(16)]
    {
        let got = sum(&image(method.clone(), &at_edges));
        assert!((got - 396.0).abs() < 0.01, "{method:?}: {got}");
    }
    assert!((sum(&image(Method::Shadows(Shadows::Absent), &at_edges)) - 400.0).abs() < 0.01);
    // Half a cell farther: 2.5 m of shadow. The share of each facet is exact in sum, though not in place; by centroid it is not.
    let between = scene(box_on_ground(), nadir(1000.0, 20.0, 40), [1.25, 0.0, 1.0]);
    let ground = lit() / 1.25_f64.hypot(1.0);
    // Pixels of 0.5 m.
    let sum = |image: &[f64]| 0.25 * image.iter().sum::<f64>() / ground;
    let full = image(Method::Exact, &between);
    let share = image(Method::Shadows(Shadows::Share), &between);
    let centroid = image(Method::Shadows(Shadows::Centroid), &between);
    assert!((sum(&full) - 395.0).abs() < 0.01 && (sum(&share) - 395.0).abs() < 0.01, "{} {}", sum(&full), sum(&share));
    let worst = |a: &[f64]| a.iter().zip(&full).map(|(a, b)| (a - b).abs() / ground).fold(0.0, f64::max);
    // Cells are two triangles, of which the shadow's edge cuts one to 1/4 and one to 3/4.
    assert!(worst(&share) > 0.2 && worst(&centroid) > 0.2, "{} {}", worst(&share), worst(&centroid));
    assert!((sum(&centroid) - 395.0).abs() < 2.0);
}

#[test]
fn a_ray_meets_what_is_nearest_of_all_facets() {
    let mesh = joined(&[
        box_on_ground(),
        sphere([3.0, 3.0, 1.0], 1.5, 2),
        quad([0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
    ]);
    let tree = RayTree::new(&mesh);
    let brute = |from: DVec3, ray: DVec3| {
        let meets = |f: usize| {
            let [a, b, c] = mesh.facet(f).corners_m;
            let n = (b - a).cross(c - a);
            let t = n.dot(a - from) / n.dot(ray);
            let p = from + t * ray;
            let inside = [(a, b), (b, c), (c, a)].iter().all(|(p0, p1)| (*p1 - *p0).cross(p - *p0).dot(n) >= 0.0);
            (t > 0.0 && inside).then_some(t)
        };
        (0..mesh.facets.len()).filter_map(meets).min_by(f64::total_cmp)
    };
    let mut random = Random(11);
    let mut met = 0;
    for _ in 0..3000 {
        let mut point =
            |scale: f64| DVec3::new(random.share() - 0.5, random.share() - 0.5, random.share() - 0.5) * scale;
        let (from, ray) = (point(30.0), point(2.0));
        let (ours, theirs) = (tree.nearest(from, ray).map(|hit| hit.t), brute(from, ray));
        let alike = match (ours, theirs) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * b,
            (None, None) => true,
            _ => false,
        };
        assert!(alike, "from {from} along {ray}: {ours:?}, by all facets {theirs:?}");
        met += usize::from(ours.is_some());
    }
    assert!(met > 300, "{met}");
    assert!(RayTree::new(&Mesh::default()).nearest(DVec3::ZERO, DVec3::Z).is_none());
    // A ray along an axis, in the wall of a box of the tree.
    let along = tree.nearest(DVec3::new(0.5, -20.0, 1.0), DVec3::Y).unwrap();
    assert!((along.t - 19.0).abs() < 1e-12 && along.front);
}

#[test]
fn no_ray_slips_through_where_facets_meet() {
    // A sheet of 40 x 40 squares; rays at its vertices, and at points along its edges, but for the rim's.
    let mesh = grid(50.0, 40, |x, y| 3.0 * (0.2 * x + 0.3 * y).sin());
    let tree = RayTree::new(&mesh);
    let mut random = Random(7);
    let mut through = 0;
    for from in [[0.0, 0.0, 1e3], [0.0, 0.0, 7e4], [-300.0, 200.0, 400.0], [3e6, 1e6, 5e6]].map(DVec3::from_array) {
        for facet in &mesh.facets {
            let [p, q] = [0, 1].map(|k| mesh.vertices_m[facet[k] as usize]);
            for share in [0.0, 0.5, random.share()] {
                let at = p + share * (q - p);
                if at.x.abs() < 49.0 && at.y.abs() < 49.0 {
                    through += 1;
                    assert!(tree.nearest(from, at - from).is_some(), "{from} {at}");
                }
            }
        }
    }
    assert!(through > 10_000);
}

#[test]
fn rays_along_the_middle_of_a_site_meet_it() {
    // A camera straight above the origin: rays of its middle line run along edges of the mesh's squares, and through its vertices.
    let scratch = Scratch::new();
    let path = scratch.write("s.toml", replaced(SITE, &[("samples = 16", "samples = 6"), ("lines = 16", "lines = 5")]));
    let scene = mmxrt::formats::Subject::open(&path, &unwatched).unwrap().scene;
    let (camera, tree) = (&scene.exposure.camera, RayTree::new(&scene.body.mesh));
    for (x, y) in (0..6).flat_map(|x| (0..5).map(move |y| (f64::from(x) + 0.5, f64::from(y) + 0.5))) {
        let (from, ray) = (camera.centre_m(), camera.ray(x, y));
        assert!(tree.nearest(from, ray).is_some(), "{x} {y}: {from:?} {ray:?}");
    }
}

fn area_m2(mesh: &Mesh) -> f64 {
    (0..mesh.facets.len()).map(|f| mesh.facet(f).area_m2()).sum()
}

#[test]
fn coarser_meshes_stay_closed_and_keep_their_size() {
    let fine = sphere([100.0, -40.0, 7.0], 10.0, 5);
    let mut last = fine.facets.len();
    for cell_m in [1.0, 2.0, 4.0] {
        let coarse = fine.clustered(cell_m);
        assert!(coarse.facets.len() < last && coarse.facets.len() > 20, "{cell_m}: {}", coarse.facets.len());
        last = coarse.facets.len();
        assert_eq!(Topology::new(&coarse).open_edges, 0, "{cell_m}");
        // A polyhedron on the sphere whose edges are up to twice a cube's diagonal long sags by s^2 / 8 r.
        let sphere_m3 = 4.0 / 3.0 * std::f64::consts::PI * 1000.0;
        let volume = coarse.enclosed_m3().unwrap() / sphere_m3;
        assert!(volume < 1.0 && volume > 1.0 - 0.08 * cell_m, "{cell_m}: {volume}");
        let area = area_m2(&coarse) / (4.0 * std::f64::consts::PI * 100.0);
        assert!((area - 1.0).abs() < 0.06 * cell_m, "{cell_m}: {area}");
        assert_eq!(coarse.clustered(1e-9).facets.len(), coarse.facets.len());
    }
    // Unwelded: each facet has its own corners.
    let mut apart = Mesh { material: fine.material.clone(), ..Mesh::default() };
    for facet in &fine.facets {
        let first = apart.vertices_m.len() as u32;
        apart.vertices_m.extend(facet.map(|v| fine.vertices_m[v as usize]));
        apart.facets.push([first, first + 1, first + 2]);
    }
    assert_eq!(apart.clustered(2.0).facets.len(), fine.clustered(2.0).facets.len());
}

#[test]
fn coarser_sheets_keep_their_outline_and_parts_stay_apart() {
    let ground = grid(8.0, 32, |_, _| 0.0);
    let coarse = ground.clustered(1.0);
    assert!(coarse.facets.len() < 700 && coarse.facets.len() > 300, "{}", coarse.facets.len());
    // Corners of the square are rounded off by less than half a cube each; the plane stays one layer.
    let area = area_m2(&coarse);
    assert!((256.0 - 2.0..=256.0).contains(&area), "{area}");
    assert!((coarse.vector_area_m2().0.z - area).abs() < 1e-9);
    // A small box on it vanishes, a larger one stays, and its material with it.
    let boulder = |r: f64| of_material(cuboid([-r, -r, 0.0], [r, r, 2.0 * r]), 1);
    let with = |r: f64| joined(&[grid(8.0, 32, |_, _| 0.0), boulder(r)]).clustered(1.0);
    let boulders = |mesh: &Mesh| mesh.material.iter().filter(|m| **m == MaterialId(1)).count();
    assert_eq!(boulders(&with(0.2)), 0);
    assert_eq!(boulders(&with(2.0)), 12);
    assert_eq!(with(2.0).facets.len(), coarse.facets.len() + 12);
}

#[test]
fn radiance_alone_is_that_of_the_whole_product() {
    let scratch = Scratch::new();
    let scene = mmxrt::formats::Subject::open(&scratch.write("s.toml", SITE), &unwatched).unwrap().scene;
    let table = mmxrt::solve::solve(&scene, &unwatched).unwrap();
    let whole = mmxrt::integrate::integrate(&scene, &table, mmxrt::integrate::Wanted::default(), &unwatched).unwrap();
    assert_eq!(mmxrt::integrate::radiance(&scene, &table, &unwatched).unwrap(), whole.slab);
    // Given what the Sun sees, the same table.
    let sunlit = table.sunlit().unwrap().clone();
    assert_eq!(mmxrt::solve::solve_sunlit(&scene, sunlit, &unwatched).unwrap(), table);
}

/// A clock that says that each run takes a second more.
fn counting() -> impl Fn() -> f64 + Sync {
    let count = std::sync::atomic::AtomicU32::new(0);
    move || f64::from(count.fetch_add(1, std::sync::atomic::Ordering::Relaxed))
}

#[test]
fn every_method_is_compared_with_the_full_one() {
    let scratch = Scratch::new();
    // The Sun low, so that there are shadows.
    let path = scratch.write(
        "s.toml",
        replaced(SITE, &[("direction = [0.0, 1.0, 0.5]", "direction = [0.0, 0.2, 1.0]"), SMALL[0], SMALL[1]]),
    );
    let file = mmxrt::formats::Subject::open(&path, &unwatched).unwrap();
    let chart = chart("s", &file.scene, &counting(), &unwatched).unwrap();
    let geometry = Method::of_geometry();
    assert_eq!(chart.answers(Question::Geometry).count(), geometry.len());
    for question in Question::ALL {
        let truth = chart.truth(question);
        assert!(truth.family == question.truth() && truth.errors.iter().all(|band| band.all.max == 0.0));
        assert!(chart.answers(question).filter(|entry| entry.family != truth.family).all(|entry| entry.p99() > 0.0));
    }
    assert!(chart.entries.iter().all(|entry| entry.runs == 3 && entry.cpu_s == 1.0), "a second, three times");
    let of = |name: &str| chart.entries.iter().find(|entry| entry.name == name).unwrap_or_else(|| panic!("no {name}"));
    // More rays are nearer to the truth, facets by facets too.
    let rays: Vec<f64> =
        ["1 ray a pixel", "16 rays", "256 rays", "1024 rays"].map(|name| of(name).errors[0].all.rms).to_vec();
    assert!(rays.windows(2).all(|w| w[1] < 0.7 * w[0]), "{rays:?}");
    assert!(of("no shadows").errors[0].all.max > of("sunlit share of facets").errors[0].all.max);
    assert_eq!(chart.advice().iter().filter(|advice| advice.is_main).count(), 1);
}

#[test]
fn a_chart_is_a_table_a_drawing_and_a_page() {
    let scratch = Scratch::new();
    scratch.write("s.toml", replaced(SITE, &SMALL));
    let (scene, out) = (scratch.argument("s.toml"), scratch.argument("c"));
    let (code, said, err) = run(&["chart", &scene, "-o", &out]);
    assert_eq!(code, 0, "{err}");
    assert!(said.contains("For 0.1 % use"), "{said}");
    let names = Scratch::names(&scratch);
    assert_eq!(names, ["c", "s.toml"]);
    let read = |name: &str| std::fs::read(scratch.join("c").join(name)).unwrap();
    let text = |name: &str| String::from_utf8(read(name)).unwrap();
    let csv = text("chart.csv");
    let columns = csv.lines().find(|line| !line.starts_with('#')).unwrap().split(',').count();
    let rows = rows(&csv);
    assert!(rows.iter().all(|row| row.len() == columns), "{csv}");
    for method in Method::of_geometry() {
        let row = rows.iter().find(|row| row[1] == method.name());
        let row = row.unwrap_or_else(|| panic!("no {} in {csv}", method.name()));
        // The model is named, and what it is compared with, and the time is one.
        assert!(!row[2].is_empty() && row[3] == "exact" && row[6].parse::<f64>().unwrap() > 0.0, "{row:?}");
    }
    let page = text("chart.html");
    assert!(!page.contains("http") && !page.contains("src=\"/"), "the page loads something");
    assert!(
        page.contains("Error of a pixel")
            && page.matches("data:image/png;base64,").count() >= Method::of_geometry().len()
    );
    assert!(text("chart.svg").starts_with("<svg xmlns"));
    let png = read("chart.png");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    // Something is drawn, on white.
    let dark = pixels.chunks(3).filter(|p| p.iter().all(|c| *c < 100)).count();
    assert!(dark > 2000 && dark < pixels.len() / 10, "{dark}");
    // What is there is replaced only if that is asked for, and no other folder ever is.
    let (code, _, err) = run(&["chart", &scene, "-o", &out]);
    assert!(code == 1 && err.contains("--force"), "{err}");
    let (code, ..) = run(&["chart", &scene, "-o", &out, "--force"]);
    assert_eq!(code, 0);
    scratch.write("other.txt", "mine");
    let other = scratch.path().to_str().unwrap().to_owned();
    let (code, _, err) = run(&["chart", &scene, "-o", &other, "--force"]);
    assert!(code == 1 && err.contains("not replaced"), "{err}");
}

#[test]
fn mitsuba_agrees_where_it_is_there() {
    let python = std::env::var("MMXRT_TEST_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = std::process::Command::new(&python).args(["-c", "import mitsuba"]).output();
    let scratch = Scratch::new();
    scratch.write("s.toml", replaced(SITE, &SMALL));
    let (scene, out) = (scratch.argument("s.toml"), scratch.argument("c"));
    if !there.is_ok_and(|output| output.status.success()) {
        // The chart is made all the same, and says why Mitsuba is not in it.
        let (code, _, err) = run(&["chart", &scene, "-o", &out, "--mitsuba", &python]);
        assert!(code == 0 && err.contains("Mitsuba is not in this chart"), "{err}");
        println!("SKIPPED: {python} has no mitsuba");
        return;
    }
    let (code, _, err) = run(&["chart", &scene, "-o", &out, "--mitsuba", &python]);
    assert_eq!(code, 0, "{err}");
    let csv = std::fs::read_to_string(scratch.join("c").join("chart.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().filter(|line| line.starts_with("other,")).collect();
    assert_eq!(rows.len(), 6, "{csv}");
    // 1024 samples in each of 64 pixels: the mean square error falls with their number, and single precision is far below it.
    let field = |rays: &str, column: usize| {
        let row = rows
            .iter()
            .find(|row| row.contains(&format!("Mitsuba {rays} ")))
            .unwrap_or_else(|| panic!("no {rays} in {csv}"));
        row.split(',').nth(column).unwrap().parse::<f64>().unwrap()
    };
    let rms = ["1", "64", "1024"].map(|rays| field(rays, 14));
    assert!(rms[0] > 3.0 * rms[1] && rms[1] > 1.5 * rms[2] && rms[2] < 2e-3, "{rms:?}");
}

#[test]
fn all_methods_see_bodies_of_the_sky() {
    // One before the box, which hides some of its top, and one below the ground, which shows beside it.
    let base = scene(box_on_ground(), nadir(1000.0, 24.0, 12), [1.0, 0.0, 1.0]);
    let globe = |name: &str, centre_m: DVec3, radius_m: f64| mmxrt::scene::Globe {
        name: name.into(),
        radius_m,
        ..crate::scenes::mars(centre_m)
    };
    let among = edited(&base, |parts| {
        let (near, far) = (DVec3::new(1.0, 0.5, 500.0), DVec3::new(24.0, 24.0, -900.0));
        parts.sky.bodies = vec![globe("far", far, 8.0), globe("near", near, 1.0)];
        parts.models.bodies = 0;
    });
    let full = image(Method::Full, &among);
    assert!(image(Method::Full, &base).iter().zip(&full).filter(|(a, b)| a != b).count() > 8);
    let most = |method: Method, scene: &Scene| {
        let full = image(Method::Full, scene);
        image(method, scene).iter().zip(&full).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(most(Method::Rays(4096), &among) < 0.01 * lit(), "{}", most(Method::Rays(4096), &among) / lit());
    // Shares of facets are off by as much as without them.
    let share = || Method::Shadows(Shadows::Share);
    assert!(most(share(), &among) <= most(share(), &base) + 1e-9 * lit());
}
