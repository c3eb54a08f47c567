//! A part of a body in the light that the rest of it leaves: as it is on the whole body.

use glam::DVec3;
use mmxrt::geometry::{Direction, Mesh};
use mmxrt::landscape::{Recipe, Sources, generate};
use mmxrt::physics::sun_disc::DiscRule;
use mmxrt::product::{FacetTable, Lighting, Sees};
use mmxrt::progress::unwatched;
use mmxrt::random::Draws;
use mmxrt::scene::{Scene, Setup, SunModel, Thermal};
use mmxrt::solve::{Terrain, is_local, solve, solve_part};
use mmxrt::visibility::{FacetGroups, Seen, Topology};

use crate::scenes::{edited, mars, scene};
use crate::shapes::{grid, joined, nadir, of_material, sphere};

/// Groups near one of them, the groups around a random one, and every third.
fn subsets(groups: &FacetGroups, draws: &mut Draws) -> Vec<Vec<bool>> {
    let count = groups.count();
    let from = (draws.unit() * count as f64) as usize;
    // Groups follow one another as they lie.
    let stretch = |length: usize| (0..count).map(|i| (from..from + length).contains(&i)).collect();
    vec![stretch(1), stretch(count / 8 + 1), (0..count).map(|i| i % 3 == 0).collect()]
}

#[test]
fn parts_are_lit_as_on_the_whole_body() {
    let flat = |z: f64| grid(32.0, 32, move |_, _| z);
    let meshes: [(&str, Mesh); 4] = [
        ("site", generate(&Recipe { facets: 6000, ..Recipe::new(3) }, &Sources::default(), &unwatched).unwrap().mesh),
        ("ball", sphere([1.0, -2.0, 3.0], 5.0, 4)),
        // Integer heights, one on the other, and one twice.
        ("layers", joined(&[flat(0.0), flat(1.0), flat(1.0), flat(4.0)])),
        ("waves", grid(40.0, 48, |x, y| 2.0 * (0.9 * x).sin() * (0.7 * y).cos())),
    ];
    let mut draws = Draws::new(11);
    let (mut compared, mut cut, mut left_out) = (0, 0, 0);
    for (name, mesh) in &meshes {
        let topology = Topology::new(mesh);
        let groups = FacetGroups::new(mesh);
        assert!(groups.count() > 20, "{name}");
        let random = DVec3::from_array([0; 3].map(|_| draws.normal()));
        let towards =
            [DVec3::Z, DVec3::X, DVec3::NEG_Z, DVec3::new(1.0, 1.0, 1e-3), DVec3::new(-1.0, 0.0, 1.0), random];
        for towards in towards.map(|towards| Direction::new(towards).unwrap()) {
            let whole = Seen::from_afar(mesh, &topology, towards, "sunlight", &unwatched).unwrap();
            for of in subsets(&groups, &mut draws) {
                let facets = groups.facets(&of);
                let drawn = groups.facets(&groups.with_hiding(&of, towards));
                left_out += usize::from(2 * drawn.len() < mesh.facets.len());
                assert!(facets.iter().all(|facet| drawn.binary_search(facet).is_ok()));
                let part =
                    Seen::of_facets_from_afar(mesh, &topology, towards, (&facets, &drawn), "sunlight", &unwatched)
                        .unwrap();
                part.validate().unwrap();
                assert_eq!(part.shown.len(), facets.len());
                for (place, facet) in facets.iter().enumerate() {
                    let (of_whole, of_part) = (whole.fraction(*facet), part.fraction(place as u32));
                    assert!(
                        (of_whole - of_part).abs() < 1e-9,
                        "{name} {towards:?} facet {facet}: {of_whole} {of_part}"
                    );
                    cut += usize::from(of_whole > 0.0 && of_whole < 1.0);
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 50_000 && cut > 2000 && left_out > 12, "{compared} {cut} {left_out}");
}

/// Wide sources too: half-shadows of the Sun's disc, terrain before the parts of Mars, and what is absorbed of both.
#[test]
fn wide_sources_light_parts_as_the_whole_body() {
    let hills = of_material(grid(40.0, 40, |x, y| 2.0 * (0.9 * x).sin() * (0.7 * y).cos()), 0);
    let bare = scene(hills, nadir(1000.0, 30.0, 4), [0.9, 0.2, 0.3]);
    // High beside the Sun, and with its limb before the Sun's middle: then some facets' Sun is half covered.
    let off = DVec3::new(0.8, -0.3, 0.35).normalize();
    let (to_sun, radius_rad) = (bare.sky.sun.direction.vec(), (3_389_500.0_f64 / 9_376_000.0).asin());
    let across = (off - off.dot(to_sun) * to_sun).normalize();
    let before = radius_rad.cos() * to_sun + radius_rad.sin() * across;
    for (to_mars, is_eclipsed) in [(off, false), (before, true)] {
        parts_have_light_of_the_whole(&bare, to_mars, is_eclipsed);
    }
}

fn parts_have_light_of_the_whole(bare: &Scene, to_mars: DVec3, is_eclipsed: bool) {
    let whole = edited(bare, |parts| {
        parts.sky.mars = Some(mars(9_376_000.0 * to_mars));
        parts.models.eclipses = is_eclipsed;
        parts.models.sun = SunModel::Disc(DiscRule::G7);
        parts.models.mars_shadows = Some(DiscRule::G7);
        parts.models.thermal = Thermal::Equilibrium;
    });
    let groups = FacetGroups::new(&whole.body.mesh);
    let table = solve(&whole, &unwatched).unwrap();
    let suns = |table: &FacetTable| table.sources[0].irradiance.iter().sum::<f64>();
    let free = edited(&whole, |parts| parts.models.eclipses = false);
    let left = suns(&table) / suns(&solve(&free, &unwatched).unwrap());
    assert!(if is_eclipsed { left > 0.4 && left < 0.6 } else { left == 1.0 }, "{left}");
    let of: Vec<bool> = (0..groups.count()).map(|i| i % 5 == 1).collect();
    let facets = groups.facets(&of);
    let part = Scene::new(Setup { body: whole.body.part(&facets), ..(*whole).clone() }).unwrap();
    let terrain = Terrain::around(&whole.body, &groups, &of, &facets);
    let (of_part, of_whole) = (solve_part(&part, &terrain, &unwatched).unwrap(), table.part(&facets));
    assert!(is_local(&whole.models) && of_part.sources.len() == of_whole.sources.len());
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-7 * (1.0 + b.abs());
    let mut partly = 0;
    for (a, b) in of_part.sources.iter().zip(&of_whole.sources) {
        assert_eq!(a.source, b.source);
        for (place, (a_irradiance, b_irradiance)) in a.irradiance.iter().zip(&b.irradiance).enumerate() {
            assert!(near(*a_irradiance, *b_irradiance), "{} {place}: {a_irradiance} {b_irradiance}", a.source);
            let share = |lighting: &Lighting| match &lighting.sees {
                Sees::All => 1.0,
                Sees::Shares(shares) => shares[place],
                Sees::Polygons(seen) => seen.fraction(place as u32),
            };
            assert!(near(share(a), share(b)), "{} {place}: {} {}", a.source, share(a), share(b));
            partly += usize::from(share(b) > 0.0 && share(b) < 1.0);
        }
    }
    assert!(partly > 50, "{partly}");
    let temperatures =
        |table: &FacetTable| [table.temperature_lit_k.clone(), table.temperature_shaded_k.clone()].concat();
    let pairs: Vec<(f64, f64)> = temperatures(&of_part).into_iter().zip(temperatures(&of_whole)).collect();
    assert!(pairs.len() == 2 * facets.len() && pairs.iter().all(|(a, b)| near(*a, *b)));
}
