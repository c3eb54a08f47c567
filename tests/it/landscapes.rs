//! Landscapes: that sizes follow their laws, that sites lie on bodies where the formula puts them, and what files of others give.

use glam::DVec3;
use mmxrt::Error;
use mmxrt::formats::registry;
use mmxrt::geometry::Mesh;
use mmxrt::landscape::{self, Boulders, Craters, Landscape, Recipe, Sources, Span};

use crate::cli::run;
use crate::scratch::Scratch;

fn made(recipe: &Recipe) -> Landscape {
    landscape::generate(recipe, &Sources::default(), &|_| true).unwrap()
}

fn parsed(text: &str) -> Recipe {
    toml::from_str(&format!("version = 2\nseed = 5\n{text}")).unwrap()
}

/// The probability that numbers which follow a distribution function differ from it as much as these do, or more (Kolmogorov and Smirnov; for finite numbers
/// as M. A. Stephens 1970, J. R. Stat. Soc. B 32, 115).
fn kolmogorov_smirnov(mut numbers: Vec<f64>, distribution: impl Fn(f64) -> f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let n = numbers.len() as f64;
    let off = |(i, x): (usize, &f64)| {
        let expected = distribution(*x);
        (expected - i as f64 / n).max((i + 1) as f64 / n - expected)
    };
    let largest = numbers.iter().enumerate().map(off).fold(0.0, f64::max);
    let lambda = (n.sqrt() + 0.12 + 0.11 / n.sqrt()) * largest;
    let terms = (1..100).map(|k| {
        let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
        sign * (-2.0 * f64::from(k * k) * lambda * lambda).exp()
    });
    terms.sum::<f64>().clamp(0.0, 1.0)
}

/// Smaller sizes' share of a truncated power law of larger ones.
fn power_law(lo: f64, hi: f64, exponent: f64) -> impl Fn(f64) -> f64 {
    move |d: f64| (1.0 - (d / lo).powf(-exponent)) / (1.0 - (hi / lo).powf(-exponent))
}

#[test]
fn the_probability_of_a_difference_is_kolmogorovs() {
    // One number in the middle: D = 0.5; by Stephens' formula lambda = 0.615, Q = 0.844 by tables of Q.
    let p = kolmogorov_smirnov(vec![0.5], |x| x);
    assert!((p - 0.8438).abs() < 1e-3, "{p}");
    // Evenly spread numbers fit, numbers in one half do not.
    let even: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).collect();
    assert!(kolmogorov_smirnov(even.clone(), |x| x) > 0.999);
    assert!(kolmogorov_smirnov(even.iter().map(|x| 0.5 * x).collect(), |x| x) < 1e-12);
}

#[test]
fn craters_and_boulders_follow_their_laws() {
    for block in [1..=20, 21..=40] {
        let (mut of_craters, mut of_boulders, mut of_places) = (Vec::new(), Vec::new(), Vec::new());
        for seed in block {
            let craters = Craters {
                count: 1500,
                min_diameter_m: 10.0,
                max_diameter_m: 300.0,
                exponent: 2.0,
                ..Craters::default()
            };
            let boulders = Boulders {
                count: 1500,
                min_diameter_m: 1.0,
                max_diameter_m: 9.0,
                exponent: 3.0,
                buried: Span::Range([0.2, 0.8]),
                ..Boulders::default()
            };
            let recipe = Recipe {
                seed,
                facets: 1000,
                relief: vec![],
                craters: vec![craters],
                boulders: vec![boulders],
                ..Recipe::new(1)
            };
            let made = made(&recipe);
            assert_eq!((made.craters.len(), made.boulders.len()), (1500, 1500));
            let diameters = made.craters.iter().map(|c| c.diameter_m).collect();
            of_craters.push(kolmogorov_smirnov(diameters, power_law(10.0, 300.0, 2.0)));
            let diameters = made.boulders.iter().map(|b| b.diameter_m).collect();
            of_boulders.push(kolmogorov_smirnov(diameters, power_law(1.0, 9.0, 3.0)));
            let places = made.craters.iter().map(|c| c.centre_m[0]).collect();
            of_places.push(kolmogorov_smirnov(places, |x| x / 2000.0 + 0.5));
        }
        for all in [of_craters, of_boulders, of_places] {
            assert!(all.len() == 20 && all.iter().all(|p| *p > 1e-3), "{all:?}");
            assert!(kolmogorov_smirnov(all.clone(), |p| p) > 0.01, "{all:?}");
        }
    }
}

#[test]
fn later_craters_erase_and_densities_count_as_counts() {
    // 4 km2: 25 a km2 are 100; a share s of geometric saturation is s 1.54 A / D^2, less those over 80 m: s = 0.02 at 20 m, exponent 2: 308 (1 - 1/16).
    let number = |text: &str| {
        made(&parsed(&format!(
            "facets = 1000\n[[craters]]\nmin_diameter_m = 20.0\nmax_diameter_m = 80.0\nexponent = 2.0\n{text}"
        )))
        .craters
        .len()
    };
    assert_eq!((number("count = 7"), number("per_km2 = 25.0"), number("saturation = 0.02")), (7, 100, 289));
}

/// Where the recipe's formula puts a place of a site on a sphere: by angles, from the text of the convention.
fn on_sphere(up: DVec3, east: DVec3, north: DVec3, radius_m: f64, [x_m, y_m]: [f64; 2]) -> DVec3 {
    let rho_m = x_m.hypot(y_m);
    if rho_m == 0.0 {
        return up * radius_m;
    }
    let angle = 2.0 * (rho_m / (2.0 * radius_m)).asin();
    let flat = (x_m * east + y_m * north) / rho_m;
    radius_m * (angle.sin() * flat + angle.cos() * up)
}

#[test]
fn a_site_on_a_sphere_lies_where_the_formula_puts_it() {
    let terrain = "size_m = 600.0\nfacets = 4000\nsurroundings = { reach_m = 2000.0, growth = 0.3 }\nrelief = [{ kind = \"rolling\", rms_m = 15.0, longest_m = 300.0 }]\nboulders = [{ count = 20, min_diameter_m = 8.0, buried = 0.0 }]\n";
    let flat = made(&parsed(terrain));
    let body = "[body]\nellipsoid_m = [11000.0, 11000.0, 11000.0]\nlonlat_deg = [30.0, 20.0]\nazimuth_deg = 40.0\n";
    let wrapped = made(&parsed(&format!("{terrain}{body}")));
    assert_eq!(wrapped.mesh.facets, flat.mesh.facets);
    let (longitude, latitude) = (30f64.to_radians(), 20f64.to_radians());
    let up = DVec3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin());
    let east = DVec3::new(-longitude.sin(), longitude.cos(), 0.0);
    let north = up.cross(east);
    let (sin, cos) = 40f64.to_radians().sin_cos();
    let (y, x) = (cos * north + sin * east, cos * east - sin * north);
    let origin_m = wrapped.origin_m.unwrap();
    assert!((origin_m - 11_000.0 * up).length() < 1e-6);
    let ground = flat.boulders.iter().find_map(|b| b.facets).unwrap()[0];
    let vertices = flat.mesh.facets[..ground].iter().flatten().max().unwrap() + 1;
    let mut seen = 0;
    for (a, b) in flat.mesh.vertices_m.iter().zip(&wrapped.mesh.vertices_m).take(vertices as usize) {
        let foot_m = on_sphere(up, x, y, 11_000.0, [a.x, a.y]);
        // Relief goes up along the sphere's normals, and fades where the surroundings end: from 300 + 0.6 x 2000 m on.
        let t = (1.0 - ((a.x.abs().max(a.y.abs()) - 300.0) / 2000.0 - 0.6) / 0.4).clamp(0.0, 1.0);
        let height_m = a.z * t * t * (3.0 - 2.0 * t);
        let expected_m = foot_m + foot_m.normalize() * height_m;
        let off_m = (*b + origin_m - expected_m).length();
        // All coordinates of the plane's mesh are rounded to 1e-5 m.
        assert!(off_m < 9e-6, "{a}: {off_m}");
        seen += 1;
    }
    assert!(seen > 1500);
    let wrap = wrapped.wrap.unwrap();
    // A sphere has one radius, areas stay, and the plane lies 300^2 2 / (2 R) above its corners.
    assert!(wrap.curvature_m.iter().all(|r| (r / 11_000.0 - 1.0).abs() < 1e-3), "{wrap:?}");
    assert!(wrap.area.iter().all(|a| (a - 1.0).abs() < 1e-5), "{wrap:?}");
    assert!((wrap.below_m[1] - 90_000.0 / 11_000.0).abs() < 0.01 && wrap.below_m[0].abs() < 1e-9);
    assert!(wrap.relief_at_end == 0.0 && wrap.target_above_m.abs() < 1e-6);
    // The end of the mesh: chords of the last ring's facets, 2300 m 0.3 wide at most.
    assert!(wrap.seam_m < 800.0f64.powi(2) / (8.0 * 11_000.0), "{}", wrap.seam_m);
}

/// A grid whose coordinates are whole metres, and a mound with a formula: nothing is rounded but the result, to 1e-7 m.
#[test]
fn vertices_on_a_sphere_are_the_formulas_to_a_micrometre() {
    let text = "size_m = 600.0\nfacets = 1800\nrelief = [{ kind = \"mound\", height_m = 50.0, flank_deg = 30.0, top_m = 40.0 }]\n[body]\nellipsoid_m = [11000.0, 11000.0, 11000.0]\nlonlat_deg = [0.0, 0.0]\n";
    let made = made(&parsed(text));
    let flank_m = 75.0 / 30f64.to_radians().tan();
    assert_eq!((made.mesh.facets.len(), made.mesh.vertices_m.len()), (1800, 961));
    for (k, v) in made.mesh.vertices_m.iter().enumerate() {
        let (x_m, y_m) = (20.0 * (k % 31) as f64 - 300.0, 20.0 * (k / 31) as f64 - 300.0);
        let foot_m = on_sphere(DVec3::X, DVec3::Y, DVec3::Z, 11_000.0, [x_m, y_m]);
        let t = (1.0 - (x_m.hypot(y_m) - 40.0) / flank_m).clamp(0.0, 1.0);
        let expected_m = foot_m + foot_m.normalize() * 50.0 * t * t * (3.0 - 2.0 * t);
        let off_m = (*v + made.origin_m.unwrap() - expected_m).length();
        assert!(off_m < 2e-7, "{x_m} {y_m}: {off_m}");
    }
}

#[test]
fn boulders_on_a_body_touch_its_facets() {
    let wrapped = made(&parsed(
        "size_m = 400.0\nfacets = 3000\nrelief = [{ kind = \"ridged\", rms_m = 8.0, longest_m = 100.0 }]\nboulders = [{ count = 40, min_diameter_m = 6.0, shape = \"any\", buried = 0.0 }]\n[body]\nshape = \"phobos\"\nlonlat_deg = [300.0, 10.0]\n",
    ));
    let (mesh, origin_m) = (&wrapped.mesh, wrapped.origin_m.unwrap());
    let ground = wrapped.boulders[0].facets.unwrap()[0];
    let mut seen = 0;
    for boulder in &wrapped.boulders {
        let [first, count] = boulder.facets.unwrap();
        // The lowest vertex over the facet below it, on the line to the body's centre.
        let least_m = mesh.facets[first..first + count]
            .iter()
            .flatten()
            .map(|&v| above_m(mesh, ground, origin_m, mesh.vertices_m[v as usize]))
            .fold(f64::MAX, f64::min);
        assert!(least_m.abs() < 1e-3, "a gap of {least_m} m");
        seen += 1;
    }
    assert_eq!(seen, 40);
}

/// How far a point lies above the ground's facets on the line from the body's centre, m.
fn above_m(mesh: &Mesh, ground: usize, origin_m: DVec3, p_m: DVec3) -> f64 {
    let towards = p_m + origin_m;
    let met = mesh.facets[..ground].iter().find_map(|f| {
        let [a, b, c] = f.map(|v| mesh.vertices_m[v as usize] + origin_m);
        let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|n| towards.dot(n));
        let normal = (b - a).cross(c - a);
        weights.iter().all(|w| *w >= -1e-9 * towards.length().powi(3)).then(|| a.dot(normal) / towards.dot(normal))
    });
    (1.0 - met.unwrap()) * towards.length()
}

#[test]
fn the_target_of_table_i_lies_804_m_above_the_ellipsoid() {
    let site = |height: &str| {
        parsed(&format!(
            "facets = 1000\nsize_m = 100.0\n[body]\nellipsoid_m = [12950.0, 11300.0, 9160.0]\ntarget_m = [-2743.5946, 11860.0360, 0.51269]\nheight = \"{height}\""
        ))
    };
    let target_m = DVec3::new(-2743.5946, 11860.0360, 0.51269);
    // The ellipsoid's radius along the target's direction, by hand.
    let d = target_m.normalize();
    let radius_m = 1.0 / ((d.x / 12_950.0).powi(2) + (d.y / 11_300.0).powi(2) + (d.z / 9160.0).powi(2)).sqrt();
    for height in ["target", "body"] {
        let made = made(&site(height));
        let above_m = made.wrap.unwrap().target_above_m;
        assert!((above_m - (target_m.length() - radius_m)).abs() < 1e-6 && (above_m - 804.0).abs() < 1.0, "{above_m}");
        let at_m = if height == "target" { target_m } else { radius_m * d };
        assert!((made.origin_m.unwrap() - at_m).length() < 1e-6);
        // The range from Table I's observer.
        let observer_m = DVec3::new(-20159.4581, 87145.4911, 3.7671);
        let range_m = (observer_m - made.origin_m.unwrap()).length();
        assert_eq!((range_m - 77_273.6).abs() < 0.1, height == "target", "{range_m}");
        assert!(made.doubts()[0].contains("804"), "{:?}", made.doubts());
    }
}

/// The kernel that CSPICE wrote: 320 plates on an ellipsoid, of 3 to 4 km, in km.
fn kernel_of_spice() -> Mesh {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/meshes/ellipsoid.bds");
    let mut mesh = registry::mesh(std::path::Path::new(path), true).unwrap().surface.mesh;
    mesh.vertices_m.iter_mut().for_each(|v| *v *= 1000.0);
    mesh
}

/// A smooth site on a mesh, at longitude 40, latitude 20 deg.
fn on(mesh: Mesh, site: &str) -> Result<Landscape, String> {
    let recipe = parsed(&format!("{site}\n[body]\nfiles = [\"b\"]\nlonlat_deg = [40.0, 20.0]\n"));
    let sources = Sources { meshes: [("b".to_owned(), mesh)].into(), ..Sources::default() };
    match landscape::generate(&recipe, &sources, &|_| true) {
        Ok(made) => Ok(made),
        Err(Error::Invalid(problems)) => Err(problems[0].to_string()),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn a_site_on_a_shape_that_cspice_wrote_is_smooth_and_near_the_ellipsoid() {
    // 6 km, over some five plates.
    let made = on(kernel_of_spice(), "size_m = 6000.0\nfacets = 20_000").unwrap();
    let origin_m = made.origin_m.unwrap();
    let level = |p_m: DVec3| (p_m / DVec3::new(12_950.0, 11_300.0, 9160.0)).length();
    // Plates lie up to 1.3 % below the ellipsoid: the smooth surface a tenth of that, and its facets have no edges of the plates' 13 deg.
    let off = made.mesh.vertices_m.iter().map(|v| (level(*v + origin_m) - 1.0).abs()).fold(0.0, f64::max);
    assert!(off < 0.002, "{off}");
    let normals: Vec<DVec3> = (0..made.mesh.facets.len()).map(|f| made.mesh.facet(f).normal()).collect();
    let mut of_edge = std::collections::BTreeMap::new();
    let mut sharpest = 1.0f64;
    for (f, &[a, b, c]) in made.mesh.facets.iter().enumerate() {
        for edge in [[a, b], [b, c], [c, a]] {
            let key = [edge[0].min(edge[1]), edge[0].max(edge[1])];
            if let Some(other) = of_edge.insert(key, f) {
                sharpest = sharpest.min(normals[f].dot(normals[other]));
            }
        }
    }
    // Facets of 60 m on a body of 10 km: 0.35 deg, and more where it bends more than the ellipsoid does.
    assert!(sharpest.acos().to_degrees() < 1.0, "{}", sharpest.acos().to_degrees());
}

#[test]
fn shapes_with_holes_folds_and_second_shells_are_refused_wherever_the_mesh_lies() {
    let whole = kernel_of_spice();
    let towards = DVec3::new(0.72, 0.604, 0.342);
    let mut near: Vec<usize> = (0..whole.facets.len()).collect();
    near.sort_by(|&a, &b| {
        let angle = |f: usize| whole.facet(f).centroid_m().normalize().dot(towards);
        angle(b).total_cmp(&angle(a))
    });
    let edited = |edit: &dyn Fn(&mut Mesh)| {
        let mut mesh = kernel_of_spice();
        edit(&mut mesh);
        on(mesh, "size_m = 600.0\nfacets = 4000\nsurroundings = { reach_m = 2000.0, growth = 0.3 }").err()
    };
    // The plate under the target, and one beside it.
    for k in [0, 1] {
        let hole = edited(&|mesh| {
            mesh.facets.remove(near[k]);
        })
        .unwrap();
        assert!(hole.contains("body") && hole.contains("no surface"), "{hole}");
        let fold = edited(&|mesh| mesh.facets[near[k]].swap(1, 2)).unwrap();
        assert!(fold.contains("do not face away") || fold.contains("meets no surface"), "{fold}");
    }
    // A hole of 40 m in it, about 500 m from the target: smaller than what any grid of samples finds.
    let small = edited(&|mesh| {
        let [a, b, c] = mesh.facets[near[0]];
        let [pa, pb, pc] = [a, b, c].map(|v| mesh.vertices_m[v as usize]);
        let middle_m = towards * (pa.dot((pb - pa).cross(pc - pa)) / towards.dot((pb - pa).cross(pc - pa)));
        let corner = |t: DVec3| middle_m + (t - middle_m) * 0.006 + (pb - pa).normalize() * 250.0;
        let first = u32::try_from(mesh.vertices_m.len()).unwrap();
        mesh.vertices_m.extend([pa, pb, pc].map(corner));
        let [d, e, f] = [first, first + 1, first + 2];
        mesh.facets[near[0]] = [a, b, e];
        mesh.facets.extend([[a, e, d], [b, c, f], [b, f, e], [c, a, d], [c, d, f]]);
    })
    .unwrap();
    assert!(small.contains("no surface") && small.contains("of the mesh's"), "{small}");
    // A second shell over a part of it.
    let shell = edited(&|mesh| {
        let mut part = mesh.part(&near[..6].iter().map(|f| u32::try_from(*f).unwrap()).collect::<Vec<_>>());
        part.vertices_m.iter_mut().for_each(|v| *v *= 1.01);
        mesh.append(part);
    })
    .unwrap();
    assert!(shell.contains("more than one") || shell.contains("several"), "{shell}");
    // On the far side none of it matters.
    let far = near[near.len() - 1];
    let hole = edited(&|mesh| {
        mesh.facets.remove(far);
    });
    assert_eq!(hole, None);
    assert_eq!(edited(&|mesh| mesh.facets[far].swap(1, 2)), None);
}

#[test]
fn saturation_of_craters_of_one_size_is_that_of_all_of_them() {
    // 0.02 x 1.54 x 4 km2 / (0.05 km)^2: 49.3.
    let text = "facets = 1000\n[[craters]]\nmin_diameter_m = 50.0\nmax_diameter_m = 50.0\nsaturation = 0.02\n";
    assert_eq!(made(&parsed(text)).craters.len(), 49);
}

#[test]
fn what_a_body_cannot_carry_is_refused() {
    for (text, key, words) in [
        (
            "[body]\nshape = \"phobos\"\nlonlat_deg = [0.0, 0.0]\n[surroundings]\nreach_m = 25000.0",
            "surroundings.reach_m",
            "too far around the body",
        ),
        (
            "[body]\nellipsoid_m = [3000.0, 2500.0, 900.0]\nlonlat_deg = [0.0, 90.0]",
            "body.ellipsoid_m",
            "900 is not from 2000",
        ),
        (
            "[body]\nshape = \"phobos\"\nlonlat_deg = [0.0, 0.0]\noffset_m = [20000.0, 0.0, 0.0]",
            "body.lonlat_deg",
            "meets no surface",
        ),
        ("[body]\nshape = \"phobos\"\ntarget_m = [0.0, 0.0, 0.0]", "body.target_m", "no direction"),
        ("[body]\nshape = \"phobos\"", "body", "target_m, lonlat_deg"),
        ("[body]\nfiles = [\"none.obj\"]\nlonlat_deg = [0.0, 0.0]", "body.files[0]", "has not been read"),
    ] {
        let Err(Error::Invalid(problems)) = landscape::generate(&parsed(text), &Sources::default(), &|_| true) else {
            panic!("{text}: accepted")
        };
        let told = problems[0].to_string();
        assert!(told.starts_with(&format!("recipe.{key}: ")) && told.contains(words), "{text}: {told}");
    }
}

#[test]
fn recipes_that_would_take_for_ever_are_refused() {
    for (text, key, words) in [
        // 3000 craters of 700 to 1000 m, whose ejecta reach three radii, on 2 x 2 km: (3000 / 4 km2) pi 1.5^2 0.7 km2, some 3700 over each place.
        (
            "[[craters]]\ncount = 3000\nmin_diameter_m = 700.0\nmax_diameter_m = 1000.0\n",
            "craters[0].count",
            "each place",
        ),
        (
            "surroundings = { reach_m = 1000000.0, growth = 0.01 }\n[[craters]]\ncount = 100000\nmin_diameter_m = 20.0\n",
            "surroundings.reach_m",
            "craters: more than",
        ),
    ] {
        let Err(Error::Invalid(problems)) = landscape::generate(&parsed(text), &Sources::default(), &|_| true) else {
            panic!("{text}: accepted")
        };
        let told = problems[0].to_string();
        assert!(told.starts_with(&format!("recipe.{key}: ")) && told.contains(words), "{told}");
    }
    // Craters of one size are around a site, too.
    let of_one_size = "facets = 20000\nsurroundings = { reach_m = 2000.0 }\n[[craters]]\ncount = 40\nmin_diameter_m = 500.0\nmax_diameter_m = 500.0\n";
    let heights = made(&parsed(of_one_size)).mesh.vertices_m.into_iter().filter(|v| v.x.abs().max(v.y.abs()) > 2200.0);
    assert!(heights.filter(|v| v.z < -1.0).count() > 5);
}

#[test]
fn recipes_of_both_versions_and_presets_are_made_and_errors_have_places() {
    let scratch = Scratch::new();
    let file = |name: &str, text: &str| {
        std::fs::write(scratch.join(name), text).unwrap();
        scratch.argument(name)
    };
    let (code, out, err) = run(&["landscape", "many-craters", "-o", &scratch.argument("a"), "--facets", "2000"]);
    assert!(code == 0 && out.contains("craters"), "{out} {err}");
    assert!(scratch.join("a/landscape_craters.csv").is_file() && !scratch.join("a/landscape_boulders.csv").exists());
    let (code, out, _) = run(&["landscape", "--list"]);
    assert!(code == 0 && out.lines().count() == 12 && out.contains("phobos-3"), "{out}");
    let (code, shown, _) = run(&["landscape", "dunes", "--show"]);
    assert!(code == 0);
    let again = file("again.toml", &shown);
    let both = ["dunes", &again].map(|recipe| {
        let out = scratch.argument("b.obj");
        assert_eq!(run(&["landscape", recipe, "-o", &out, "--facets", "1000", "--force"]).0, 0);
        std::fs::read(out).unwrap()
    });
    assert!(both[0] == both[1]);

    for (text, line, words) in [
        ("version = 3\nseed = 1\n", 1, "expected 2 or 1"),
        ("seed = 1\n", 0, "`version` is missing (help: it is 2 or 1)"),
        (
            "version = 2\nseed = 1\nrelief = [{ kind = \"rolling\", rms_m = 3.0, longest_m = 100.0, hust = 1.0 }]\n",
            3,
            "unknown key `hust`",
        ),
        ("version = 2\nseed = 1\nrelief = [{ kind = \"duens\" }]\n", 3, "did you mean \"dunes\"?"),
        ("version = 2\nseed = 1\nrelief = [{ rms_m = 3.0 }]\n", 3, "`kind` is missing"),
        ("version = 2\nseed = 1\n[[craters]]\ncount = 3\nrim = 0.5\n", 5, "0.5 is not from 0 to 0.2"),
        ("version = 1\nseed = 1\n[craters]\nrim = 0.5\n", 4, "0.5 is not from 0 to 0.2"),
        ("version = 1\nseed = 1\n[boulders]\ncount = 60000\n", 4, "more than half"),
        ("version = 2\nseed = 1\n[[relief]]\nkind = \"elevation\"\nfile = \"none.png\"\n", 5, "none.png"),
        ("version = 2\nseed = 1\n[body]\nshape = \"deimos\"\nlonlat_deg = [0.0, 0.0]\n", 4, "phobos"),
        ("version = 2\nseed = 1\n[detail]\nsize_m = 500.0\nx_m = 900.0\n", 3, "beyond the site's border"),
        ("version = 2\nseed = 1\n[materials.half]\nmixture = { a = 0.5, b = 0.4 }\n", 4, "add up to 0.9"),
    ] {
        let recipe = file("bad.toml", text);
        let (code, _, err) = run(&["landscape", &recipe, "-o", &scratch.argument("bad.obj")]);
        assert!(
            code == 1 && (line == 0 || err.contains(&format!("bad.toml:{line}"))) && err.contains(words),
            "{text}: {err}"
        );
    }
    let (code, _, err) = run(&["landscape", "phobos-4", "-o", &scratch.argument("x.obj")]);
    assert!(code == 1 && err.contains("neither a file nor a preset") && err.contains("phobos-"), "{err}");
    assert!(!scratch.join("bad.obj").exists() && !scratch.join("x.obj").exists());
}

/// Heights of a grid that GDAL wrote (24 x 16 pixels of 50 m), read here by hand, against those of the mesh at the middles of its pixels.
#[test]
fn elevation_models_come_back_at_their_pixels() {
    let scratch = Scratch::new();
    let grid = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/rasters/square.asc");
    let text = std::fs::read_to_string(grid).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(6).map(|line| line.split_whitespace().map(|x| x.parse().unwrap()).collect()).collect();
    // The file has a pixel without data: with it there is no landscape, and the message says where it is.
    let hole = rows.iter().enumerate().find_map(|(j, row)| Some((row.iter().position(|h| *h == -9999.0)?, j))).unwrap();
    let recipe = |crop: &str| {
        let text = format!(
            "version = 2\nseed = 1\nsize_m = 350.0\nfacets = 1568\nrelief = [{{ kind = \"elevation\", file = '{grid}', {crop} width_m = 400.0 }}]\n"
        );
        std::fs::write(scratch.join("r.toml"), text).unwrap();
        run(&["landscape", &scratch.argument("r.toml"), "-o", &scratch.argument("m.obj"), "--force"])
    };
    let (code, _, err) = recipe("");
    let at = format!("column {}, line {}", hole.0, hole.1);
    assert!(code == 1 && err.contains("no height") && err.contains(&at) && err.contains("r.toml:5"), "{err}");

    // Eight by eight pixels without it, on a site from the middles of the outermost ones: every other vertex is on a pixel.
    let (first_column, first_row) = (if hole.0 < 12 { 14 } else { 2 }, 4);
    let (code, _, err) = recipe(&format!("crop = [{first_column}, {first_row}, 8, 8],"));
    assert_eq!((code, err.as_str()), (0, ""));
    let part: Vec<f64> = (0..64).map(|i| rows[first_row + i / 8][first_column + i % 8]).collect();
    let mean = part.iter().sum::<f64>() / 64.0;
    let obj = std::fs::read_to_string(scratch.join("m.obj")).unwrap();
    let mut seen = 0;
    for line in obj.lines().filter_map(|line| line.strip_prefix("v ")) {
        let v: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
        let (column, row) = ((v[0] + 175.0) / 50.0, (175.0 - v[1]) / 50.0);
        if column.fract() == 0.0 && row.fract() == 0.0 {
            let expected_m = part[8 * row as usize + column as usize] - mean;
            assert!((v[2] - expected_m).abs() < 1e-5, "{line}: {expected_m}");
            seen += 1;
        }
    }
    assert_eq!(seen, 64);
}

#[test]
fn a_site_on_a_body_is_the_same_at_any_thread_count() {
    let recipe = parsed(
        "size_m = 300.0\nfacets = 3000\nsurroundings = { reach_m = 900.0 }\ncraters = [{ count = 50, max_diameter_m = 90.0 }]\nboulders = [{ count = 30 }]\n[body]\nshape = \"phobos\"\nlonlat_deg = [100.0, -40.0]\n",
    );
    let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let [one, three] = [1, 3].map(|threads| on(threads).install(|| made(&recipe)).mesh);
    assert!(one == three && one.facets.len() > 2900);
}
