//! Which scenes a facet table serves, and radiance of facets.

use blake3::Hasher;
use glam::DVec3;

use crate::geometry::Mesh;
use crate::scene::{Exchange, Globe, MarsModel, Models, Rotation, Scene, Setup, Sky, SunModel, Surface, Thermal};

/// A name for everything that [`solve`](crate::solve::solve) reads of a scene: BLAKE3 of the resolved values, 64 hexadecimal digits.
///
/// Scenes that differ in camera, bands or spectra only share their table; so do files that say the same in a different form. Of light between facets a table itself
/// knows its spectra ([`FacetTable::fits`](crate::product::FacetTable::fits)).
pub fn table_id(scene: &Scene) -> String {
    let mut hasher = Hasher::new();
    let mut put = |values: &[f64]| values.iter().for_each(|v| _ = hasher.update(&v.to_le_bytes()));
    let Setup {
        body,
        sky: Sky { sun, mars, bodies, beams, rotation, past },
        exposure: _,
        models:
            Models {
                thermal,
                mars_light,
                sun: sun_model,
                eclipses,
                mars_shadows,
                mars_heat,
                conduction,
                exchange,
                floor_k,
                bodies: _,
                fixed: _,
            },
    } = &**scene;
    let Surface { origin_m, mesh, materials, textures: _ } = &**body;
    put(&origin_m.to_array());
    put(&sun.direction.vec().to_array());
    put(&[sun.distance_m, sun.total_irradiance_1au_w_m2]);
    if let Some(mars) = mars {
        put(&mars.centre_m.to_array());
        put(&[mars.radius_m, mars.bond_albedo, mars.thermal_exitance_w_m2]);
    }
    for beam in beams {
        put(&beam.direction.vec().to_array());
        put(&[beam.total_irradiance_w_m2]);
    }
    materials.iter().for_each(|m| put(&[m.bond_albedo, m.emissivity_bolometric]));
    for (i, t_k) in materials.iter().enumerate().filter_map(|(i, m)| Some((i, m.temperature_k?))) {
        put(&[i as f64, t_k]);
    }
    // Which of the above there are, so that no two scenes are the same row of numbers.
    let mars_model = mars.as_ref().map_or(0, |_| match mars_light {
        MarsModel::NearField => 1,
        MarsModel::Thesis => 2,
        MarsModel::Off => 3,
    });
    let thermal = match thermal {
        Thermal::Equilibrium => 0,
        Thermal::Thesis => 1,
        Thermal::Off => 2,
    };
    for number in [mars_model, thermal, materials.len(), mesh.vertices_m.len(), mesh.facets.len()] {
        hasher.update(&(number as u64).to_le_bytes());
    }
    if let SunModel::Disc(rule) = sun_model {
        hasher.update(b"disc");
        hasher.update(&(rule.count() as u64).to_le_bytes());
        hasher.update(&sun.limb_darkening.to_le_bytes());
    }
    if let (Some(steps), Some(Rotation { axis, period_s })) = (conduction, rotation) {
        hasher.update(b"conduction");
        hasher.update(&steps.to_le_bytes());
        let [x, y, z] = axis.vec().to_array();
        let inertias = materials.iter().map(|material| material.thermal_inertia);
        [x, y, z, *period_s].into_iter().chain(inertias).for_each(|v| _ = hasher.update(&v.to_le_bytes()));
        if past.is_some() {
            hasher.update(b"past");
            for step in 1..*steps {
                // Where nothing is known, nothing is solved either.
                let Ok(then) = scene.sky.ago(period_s * f64::from(step) / f64::from(*steps)) else { break };
                let places_m = then.globes().map(|globe| globe.centre_m);
                let all = [then.sun.direction.vec() * then.sun.distance_m].into_iter().chain(places_m);
                all.flat_map(|v| v.to_array()).for_each(|v| _ = hasher.update(&v.to_le_bytes()));
            }
        }
    }
    if let Some(rule) = mars_shadows {
        hasher.update(b"mars_shadows");
        hasher.update(&(rule.count() as u64).to_le_bytes());
    }
    if *mars_heat {
        hasher.update(b"mars_heat");
    }
    if *eclipses {
        hasher.update(b"eclipses");
        let bodies = bodies.iter().flat_map(|body| [body.centre_m.x, body.centre_m.y, body.centre_m.z, body.radius_m]);
        bodies.for_each(|v| _ = hasher.update(&v.to_le_bytes()));
        hasher.update(&sun.limb_darkening.to_le_bytes());
    }
    if let Some(Exchange { bounces, directions, lines_per_facet }) = exchange {
        hasher.update(b"exchange");
        [bounces, directions, lines_per_facet].iter().for_each(|n| _ = hasher.update(&n.to_le_bytes()));
    }
    if *floor_k > 0.0 {
        hasher.update(b"floor");
        hasher.update(&floor_k.to_le_bytes());
    }
    for Globe { name, centre_m, radius_m, reflectance: _, bond_albedo, thermal_exitance_w_m2, day_night_k } in
        scene.lighting_bodies()
    {
        hasher.update(b"body");
        hasher.update(name.as_bytes());
        hasher.update(&[0, u8::from(*day_night_k != [0.0; 2])]);
        let numbers = [*radius_m, *bond_albedo, *thermal_exitance_w_m2];
        centre_m.to_array().into_iter().chain(numbers).for_each(|v| _ = hasher.update(&v.to_le_bytes()));
    }
    for beam in beams {
        hasher.update(beam.name.as_bytes());
        hasher.update(&[0]);
    }
    update_by_mesh(&mut hasher, mesh);
    update_in_pieces(&mut hasher, &mesh.material, |m, bytes| bytes.extend(m.0.to_le_bytes()));
    hasher.finalize().to_hex().to_string()
}

/// A name for facets and where they are: BLAKE3 of the mesh and of its origin, 64 hexadecimal digits.
pub fn mesh_id(surface: &Surface) -> String {
    let mut hasher = Hasher::new();
    surface.origin_m.to_array().iter().for_each(|x| _ = hasher.update(&x.to_le_bytes()));
    for count in [surface.mesh.vertices_m.len(), surface.mesh.facets.len()] {
        hasher.update(&(count as u64).to_le_bytes());
    }
    update_by_mesh(&mut hasher, &surface.mesh);
    hasher.finalize().to_hex().to_string()
}

fn update_by_mesh(hasher: &mut Hasher, mesh: &Mesh) {
    update_in_pieces(hasher, &mesh.vertices_m, |v: &DVec3, bytes| {
        v.to_array().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    });
    update_in_pieces(hasher, &mesh.facets, |f, bytes| f.iter().for_each(|v| bytes.extend(v.to_le_bytes())));
}

/// Hashes a long list through a buffer.
fn update_in_pieces<T>(hasher: &mut Hasher, values: &[T], mut put: impl FnMut(&T, &mut Vec<u8>)) {
    let mut bytes = Vec::new();
    for piece in values.chunks(4096) {
        bytes.clear();
        piece.iter().for_each(|value| put(value, &mut bytes));
        hasher.update(&bytes);
    }
}
