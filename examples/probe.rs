//! probe
#![allow(missing_docs, clippy::print_stdout, clippy::unwrap_used)]
use glam::{DMat3, DVec3};
use mmxrt::geometry::*;
use mmxrt::scene::*;
use mmxrt::spectral::*;
use std::time::Instant;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let facets: u32 = a[1].parse().unwrap();
    let inc: f64 = a[2].parse::<f64>().unwrap().to_radians();
    let n: usize = a[3].parse().unwrap();
    let text = std::fs::read_to_string("benches/landscape_2e6.toml").unwrap();
    let mut r: mmxrt::landscape::Recipe = toml::from_str(&text).unwrap();
    r.facets = facets;
    let t = Instant::now();
    let l = mmxrt::landscape::generate(&r, &|_| true).unwrap();
    println!("landscape {:?} {}", t.elapsed(), l.mesh.facets.len());
    let az = 30f64.to_radians();
    let s = DVec3::new(inc.sin() * az.cos(), inc.sin() * az.sin(), inc.cos());
    let rho = [0.07, 0.09];
    let materials = (0..2)
        .map(|i| Material {
            name: format!("m{i}"),
            reflectance: Spectrum::constant(rho[i]),
            emissivity: Spectrum::constant(1.0 - rho[i]),
            bond_albedo: 0.03,
            emissivity_bolometric: 0.95,
            mixture: vec![(i, 1.0)],
        })
        .collect();
    let bands =
        (0..n).map(|i| Band { centre_um: 0.95 + 2.65 * i as f64 / (n.max(2) - 1) as f64, fwhm_um: None }).collect();
    let pose = Pose {
        rotation: DMat3::from_cols(DVec3::X, -DVec3::Y, -DVec3::Z),
        translation_m: DVec3::new(0.0, 0.0, 77000.0),
    };
    let scene = Scene {
        origin_m: DVec3::new(-2743.5946, 11860.0360, 0.51269),
        mesh: l.mesh,
        materials,
        sun: Sun {
            direction: Direction::new(s).unwrap(),
            distance_m: 2.2e11,
            irradiance_1au: Spectrum::constant(700.0),
            total_irradiance_1au_w_m2: 1361.0,
        },
        mars: Some(Mars {
            centre_m: DVec3::new(9.3e6 * 0.3, 9.3e6 * 0.1, 9.3e6 * 0.9),
            radius_m: 3389500.0,
            reflectance: Spectrum::constant(0.25),
            bond_albedo: 0.25,
            thermal_exitance_w_m2: 110.0,
            model: MarsModel::NearField,
        }),
        thermal: Thermal::Equilibrium,
        sensor: Sensor {
            name: "x".into(),
            camera: FrameCamera { world_from_sensor: pose, samples: 256, lines: 256, pitch: 2000.0 / 77000.0 / 256.0 },
            bands,
        },
    }
    .check()
    .unwrap();
    let w = &mmxrt::progress::unwatched;
    let only = a.get(4).cloned().unwrap_or_default();
    for _ in 0..2 {
        let t = Instant::now();
        let topo = mmxrt::visibility::Topology::new(&scene.mesh);
        println!(
            "topology {:?} open {} flipped {} closed {}",
            t.elapsed(),
            topo.open_edges,
            topo.flipped_facets,
            topo.closed.iter().filter(|c| **c).count()
        );
        let t = Instant::now();
        let lit = mmxrt::solve::sunlit(&scene.mesh, &topo, scene.sun.direction, w).unwrap();
        println!(
            "sunlit {:?} polys {} uv {} full {} part {}",
            t.elapsed(),
            lit.polygon_facet.len(),
            lit.uv.len(),
            lit.lit.iter().filter(|l| **l == mmxrt::product::Lit::Full).count(),
            lit.lit.iter().filter(|l| **l == mmxrt::product::Lit::Part).count()
        );
        if only == "sun" {
            continue;
        }
        let t = Instant::now();
        let table = mmxrt::solve::solve(&scene, &topo, w).unwrap();
        println!("solve {:?}", t.elapsed());
        let t = Instant::now();
        let fp = mmxrt::integrate::footprints(&scene.mesh, &topo, &table.sunlit, &scene.sensor.camera);
        println!("footprints {:?} {}", t.elapsed(), fp.facet.len());
        let total: f64 = fp.fraction.iter().sum();
        let litf: f64 = fp.lit_fraction.iter().sum();
        println!("coverage {} lit share {}", total / 65536.0, litf / total);
        drop(fp);
        let t = Instant::now();
        let im = mmxrt::integrate::integrate(&scene, &topo, &table, w).unwrap();
        println!("integrate {:?} weights {} excess {:e}", t.elapsed(), im.cube.row.len(), im.excess_px);
    }
}
