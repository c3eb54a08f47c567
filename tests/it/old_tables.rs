//! Facet tables that earlier versions wrote.

use std::path::PathBuf;

use mmxrt::formats::{npz, scene_toml};
use mmxrt::integrate::Wanted;
use mmxrt::progress::unwatched;
use mmxrt::scene::DirectionField;
use mmxrt::study;

/// `tests/data/table_v1/table.npz` was written by `mmxrt solve scene.toml -o table.npz` before tables named their sources.
#[test]
fn a_table_of_version_1_is_of_the_sun_and_mars() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/table_v1");
    let scene = scene_toml::read(&folder.join("scene.toml"), &unwatched).unwrap().scene;
    let (table, header) = npz::read_table(&folder.join("table.npz")).unwrap();
    assert_eq!((header.format_version, header.sources.len(), header.scene), (1, 0, study::table_id(&scene)));
    let [sun, mars] = &table.sources[..] else { panic!("{} sources", table.sources.len()) };
    assert_eq!((sun.source.as_str(), mars.source.as_str()), ("sun", "mars"));
    // Of Mars there is the direction alone.
    let towards = scene.sky.mars.as_ref().unwrap().centre_m.normalize();
    let DirectionField::Afar(direction) = mars.field else { panic!("{:?}", mars.field) };
    assert!((direction.vec() - towards).length() < 1e-15);
    // The wall's shadow, 4 m long, reaches 1 m to the west and 1/7 m to the south, there beyond the ground by a triangle of 1/14 m2.
    let sunlit = table.sunlit().unwrap();
    let lit_m2 = 8.0 * (sunlit.fraction(0) + sunlit.fraction(1));
    assert!((lit_m2 - (16.0 - 4.0 + 1.0 / 14.0)).abs() < 1e-13, "{lit_m2}");

    let own = study::simulate(&scene, &unwatched).unwrap().1;
    let seen = study::observe(&scene, &table, Wanted::default(), &unwatched).unwrap();
    for band in 0..2 {
        let (own, seen) = (own.cube.band(band), seen.cube.band(band));
        assert!(own.iter().any(|l| *l > 0.0) && own == seen, "{band}");
    }
}
