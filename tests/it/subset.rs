//! A view of some facets alone shows what the view of all shows, where it has all that may be seen.

use mmxrt::geometry::FrameCamera;
use mmxrt::geometry::Mesh;
use mmxrt::progress::unwatched;
use mmxrt::visibility::{Drawing, Topology, View, covered};

use crate::shapes::{Seen, camera, cuboid, direction, grid, joined, nadir, see};

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
    let (topology, camera) = (Topology::new(&mesh), nadir(10.0, 4.0, 4));
    let (view, grid) = View::of_frame(&camera, mesh.bounds_m());
    let drawing = Drawing::of_facets(&mesh, &topology, view, grid, &[]);
    assert_eq!(covered(&drawing, "nothing", |sides| sides[0] + sides[1], &unwatched).unwrap(), [0.0; 16]);
}

/// Integer corners under a camera whose pixels are units of the ground: edges lie on the windows' borders, and corners on their corners.
#[test]
fn a_window_shows_what_the_frame_shows_there() {
    let steps = joined(&[
        grid(6.0, 12, |_, _| 0.0),
        cuboid([-2.0, -1.0, -1.0], [1.0, 2.0, 3.0]),
        cuboid([1.0, -1.0, -1.0], [3.0, 0.0, 1.0]),
        // Coincident with the top of the first, and upright on a border of pixels.
        grid(1.0, 2, |_, _| 3.0),
        cuboid([-5.0, -5.0, 0.0], [-5.0, 5.0, 8.0]),
    ]);
    let frames = [
        ("from above", nadir(1e6, 12.0, 12)),
        ("askance", camera([20.0, -30.0, 15.0], [0.0; 3], [0.0, 0.0, 1.0], 12, 0.05)),
        // Half of all facets are behind it.
        ("within", camera([0.5, 0.5, 3.5], [5.5, 0.5, 0.5], [0.0, 0.0, 1.0], 12, 0.2)),
    ];
    let mut compared = 0;
    for (name, frame) in &frames {
        let whole = see(&steps, direction([0.3, 0.2, 1.0]), frame);
        let (samples, lines) = (frame.samples, frame.lines);
        let mut windows = vec![(3..9, 4..7), (0..1, 0..1), (11..12, 11..12)];
        windows.extend((0..lines).map(|line| (0..samples, line..line + 1)));
        windows.extend((0..samples).map(|sample| (sample..sample + 1, 0..lines)));
        for (columns, rows) in windows {
            let part = see(&steps, direction([0.3, 0.2, 1.0]), &frame.window(columns.clone(), rows.clone()));
            for (place, (line, sample)) in rows.flat_map(|y| columns.clone().map(move |x| (y, x))).enumerate() {
                let pixel = (line * samples + sample) as usize;
                let facets = |seen: &Seen, pixel| -> Vec<(u32, f64, f64)> { seen.footprints.pixel(pixel).collect() };
                let sums = |of: &[(u32, f64, f64)]| of.iter().fold((0.0, 0.0), |sum, f| (sum.0 + f.1, sum.1 + f.2));
                let (whole, part) = (sums(&facets(&whole, pixel)), sums(&facets(&part, place)));
                assert!(
                    (whole.0 - part.0).abs() < 1e-12 && (whole.1 - part.1).abs() < 1e-12,
                    "{name} {line} {sample}: {whole:?} {part:?}"
                );
                compared += usize::from(whole.1 > 0.0);
            }
        }
    }
    assert!(compared > 500, "{compared}");
}
