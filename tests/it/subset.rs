//! A view of some facets alone shows what the view of all shows, where it has all that may be seen.

use mmxrt::geometry::FrameCamera;
use mmxrt::geometry::Mesh;
use mmxrt::progress::unwatched;
use mmxrt::visibility::{Drawing, Topology, View, covered};

use crate::shapes::{camera, cuboid, grid, joined};

/// Facets that lie before the camera for a part, and whose image, as far as it goes, may touch the lines of its image.
pub(crate) fn near_the_lines(mesh: &Mesh, camera: &FrameCamera) -> Vec<u32> {
    let sensor_from_world = camera.world_from_sensor.inverse();
    let touches = |facet: &usize| {
        let corners = mesh.facet(*facet).corners_m.map(|p| sensor_from_world.point(p));
        let in_front = corners.iter().filter(|p| p.z > 0.0).count();
        let lines = corners.map(|p| p.y / p.z / camera.pitch[1] + camera.boresight_px[1]);
        let (low, high) = lines.iter().fold((f64::MAX, f64::MIN), |(a, b), y| (a.min(*y), b.max(*y)));
        in_front > 0 && (in_front < 3 || (high >= -1e-6 && low <= f64::from(camera.lines) + 1e-6))
    };
    (0..mesh.facets.len()).filter(touches).map(|facet| facet as u32).collect()
}

#[test]
fn a_line_of_a_push_broom_needs_the_facets_near_it_alone() {
    let hills = grid(10.0, 40, |x, y| (0.7 * x).sin() * (0.5 * y).cos());
    let boxes = [cuboid([-3.0, -2.0, -1.0], [0.0, 1.0, 4.0]), cuboid([4.0, 4.0, -1.0], [5.0, 6.0, 3.0])];
    let mesh = joined(&[hills, boxes[0].clone(), boxes[1].clone()]);
    let topology = Topology::new(&mesh);
    let cameras = [
        ("from afar", camera([200.0, -300.0, 400.0], [0.0; 3], [0.0, 0.0, 1.0], 30, 0.0015)),
        ("askance", camera([20.0, -30.0, 15.0], [0.0; 3], [0.0, 0.0, 1.0], 30, 0.02)),
        // Facets reach behind it and far beside its image.
        ("low among the hills", camera([-9.0, -9.0, 2.5], [0.0, 0.0, 0.5], [0.0, 0.0, 1.0], 30, 0.05)),
    ];
    let (mut fewest, mut compared) = (mesh.facets.len(), 0);
    for (name, frame) in &cameras {
        for line in 0..frame.lines {
            let of_line = frame.window(0..frame.samples, line..line + 1);
            let facets = near_the_lines(&mesh, &of_line);
            let (view, grid) = View::of_frame(&of_line, mesh.bounds_m());
            let shares = |drawing: &Drawing| {
                let sides = std::sync::Mutex::new(Vec::new());
                let of = |[outer, inner]: [f64; 2]| {
                    sides.lock().unwrap().push(inner);
                    outer
                };
                (covered(drawing, "line", of, &unwatched).unwrap(), sides.into_inner().unwrap())
            };
            let (all, some) = (
                shares(&Drawing::new(&mesh, &topology, view, grid)),
                shares(&Drawing::of_facets(&mesh, &topology, view, grid, &facets)),
            );
            for (all, some) in all.0.iter().chain(&all.1).zip(some.0.iter().chain(&some.1)) {
                assert!((all - some).abs() < 1e-13, "{name}, line {line}: {all} {some}");
                compared += usize::from(*all > 0.0);
            }
            fewest = fewest.min(facets.len());
        }
    }
    assert!(compared > 1000, "{compared}");
    assert!(fewest < mesh.facets.len() / 8, "{fewest} of {}", mesh.facets.len());
}

#[test]
fn a_view_of_no_facets_shows_nothing() {
    let mesh = grid(1.0, 2, |_, _| 0.0);
    let (topology, camera) = (Topology::new(&mesh), crate::shapes::nadir(10.0, 4.0, 4));
    let (view, grid) = View::of_frame(&camera, mesh.bounds_m());
    let drawing = Drawing::of_facets(&mesh, &topology, view, grid, &[]);
    assert_eq!(covered(&drawing, "nothing", |sides| sides[0] + sides[1], &unwatched).unwrap(), [0.0; 16]);
}
