//! What breaks renderers: from the camera and from the Sun.

use crate::shapes::*;
use glam::DVec3;

fn assert_near(what: &str, got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "{what}: {got}, expected {expected} within {tolerance:e}");
}

#[test]
fn a_triangle_covers_pixels_by_exact_fractions() {
    // Exact rational clipping of (0.3, 0.2) (3.7, 1.1) (1.4, 3.6) on 4 x 4 pixels.
    let expected = [
        [2663.0 / 6800.0, 41.0 / 85.0, 37.0 / 170.0, 841.0 / 61200.0],
        [19.0 / 68.0, 1.0, 14247.0 / 14375.0, 13141.0 / 41400.0],
        [4.0 / 187.0, 10034661.0 / 10752500.0, 11881.0 / 28750.0, 0.0],
        [0.0, 9513.0 / 42500.0, 0.0, 0.0],
    ];
    let at = |x: f64, y: f64| [x - 2.0, y - 2.0, 1.0];
    let m = mesh(&[at(0.3, 0.2), at(3.7, 1.1), at(1.4, 3.6)], &[[0, 2, 1]]);
    let seen = see(&m, direction([0.0, 0.0, -1.0]), &unit_camera(4, 4));
    for (row, line) in expected.iter().enumerate() {
        for (column, fraction) in line.iter().enumerate() {
            let got = seen.footprints.coverage(4 * row + column);
            assert_near(&format!("pixel {column}, {row}"), got, *fraction, 1e-14);
        }
    }
    assert_eq!(totals(&seen, |_| true).0, totals(&seen, |_| true).1);
}

#[test]
fn a_sliver_of_1e_9_keeps_six_digits() {
    let at = |x: f64, y: f64| [x - 4.0, y - 4.0, 1.0];
    let m = mesh(&[at(0.125, 0.5), at(7.875, 0.500000001), at(7.875, 0.500000002)], &[[0, 2, 1]]);
    let seen = see(&m, direction([0.0, 0.0, -1.0]), &unit_camera(8, 8));
    assert_near("area", totals(&seen, |_| true).0 / 3.875e-9, 1.0, 1e-6);
}

#[test]
fn crossing_quads_show_half_each() {
    // Two quads that cross along the vertical through the image centre: each is nearer on one side.
    let tilted = |s: f64| {
        let m = quad([-1.0, -1.0, 10.0 - s], [-1.0, 1.0, 10.0 - s], [1.0, 1.0, 10.0 + s], [1.0, -1.0, 10.0 + s]);
        of_material(m, if s > 0.0 { 0 } else { 1 })
    };
    let both = joined(&[tilted(1.0), tilted(-1.0)]);
    let cam = camera([0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], 16, 0.02);
    let seen = see(&both, direction([0.0, 0.0, -1.0]), &cam);
    let (first, _) = totals(&seen, |f| f < 2);
    let (second, _) = totals(&seen, |f| f >= 2);
    assert_near("halves", first, second, 1e-10);
    // The nearer half of a quad: x from -1 at depth 9 to 0 at depth 10, |y| <= 1: a trapezoid in the image.
    let px = 1.0 / 0.02;
    let trapezoid = 0.5 * (2.0 / 9.0 + 2.0 / 10.0) * (1.0 / 9.0) * px * px;
    assert_near("half", first, trapezoid, 1e-9);
    for pixel in 0..256 {
        let left = pixel % 16 < 8;
        for (facet, fraction, _) in seen.footprints.pixel(pixel) {
            assert!((facet < 2) == left || fraction < 1e-12, "pixel {pixel}, facet {facet}, {fraction}");
        }
    }
}

#[test]
fn three_strips_in_a_cycle_have_no_order_and_need_none() {
    // Each strip passes over the next and under the one before: by symmetry all three show the same area.
    let strip = |k: u16| {
        let turn = |x: f64, y: f64, z: f64| {
            let a = std::f64::consts::TAU / 3.0 * f64::from(k);
            [a.cos() * x - a.sin() * y, a.sin() * x + a.cos() * y, z]
        };
        let m = quad(turn(-6.0, -3.0, 1.0), turn(6.0, -3.0, -1.0), turn(6.0, -1.0, -1.0), turn(-6.0, -1.0, 1.0));
        of_material(m, k)
    };
    let all = joined(&[strip(0), strip(1), strip(2)]);
    let cam = nadir(1e6, 16.0, 32);
    let seen = see(&all, sun(0.0, 0.0), &cam);
    let area: Vec<f64> = (0..3).map(|k| totals(&seen, |f| f / 2 == k).0 * 0.25).collect();
    // A strip of 12 x 2 m; each overlap is a parallelogram 2 / sin 60 deg wide and 2 m high: one of its two is lost.
    let expected = 24.0 - 4.0 / (60f64).to_radians().sin();
    for a in area {
        assert_near("strip", a, expected, 1e-4);
    }
    // From above, what the camera sees is what the Sun sees.
    let (seen_area, lit_area) = totals(&seen, |_| true);
    assert_near("lit", lit_area, seen_area, 1e-3);
    for k in 0..3 {
        let lit: f64 = (2 * k..2 * k + 2).map(|f| 12.0 * seen.sunlit.fraction(f)).sum();
        assert_near("sunlit area", lit * (4f64 + 144.0).sqrt() / 12.0, expected * (148f64).sqrt() / 12.0, 1e-9);
    }
}

#[test]
fn coplanar_duplicates_of_two_materials_give_one_of_them_everywhere() {
    let pair = joined(&[of_material(plane(1.0, 0.0), 1), of_material(plane(1.0, 0.0), 0)]);
    let seen = see(&pair, sun(40.0, 20.0), &nadir(100.0, 2.5, 16));
    let (kept, lit) = totals(&seen, |f| f >= 2);
    assert_near("material 0", kept, 16.0 * 16.0 * 4.0 / 6.25, 1e-9);
    assert_near("lit", lit, kept, 1e-9);
    assert_near("material 1", totals(&seen, |f| f < 2).0, 0.0, 1e-12);
}

#[test]
fn three_triangulations_of_one_plane_leave_no_hole() {
    let tilt = |x: f64, y: f64| 0.3 * x - 0.7 * y;
    let a = of_material(grid(1.0, 7, tilt), 0);
    let b = of_material(grid(1.0, 5, tilt), 1);
    let c = of_material(grid(1.0, 3, tilt), 2);
    let all = joined(&[c, a, b]);
    let cam = nadir(50.0, 1.5, 24);
    let seen = see(&all, sun(60.0, 100.0), &cam);
    for pixel in 0..24 * 24 {
        assert_near("coverage", seen.footprints.coverage(pixel), 1.0, 1e-12);
        assert_near("lit", seen.lit(pixel), 1.0, 1e-9);
    }
}

#[test]
fn a_lid_beside_its_hole_leaves_neither_gap_nor_overlap() {
    // A ring of four quads around a square hole, and a lid of the same corners as the hole but its own vertices.
    let r = |s: f64, z: f64| [[-s, -s, z], [s, -s, z], [s, s, z], [-s, s, z]];
    let (o, i) = (r(3.0, 0.0), r(1.0, 0.0));
    let ring: Vec<_> = (0..4).map(|k| quad(o[k], o[(k + 1) % 4], i[(k + 1) % 4], i[k])).collect();
    let lid = plane(1.0, 0.0);
    let all = joined(&[ring, vec![lid]].concat());
    let seen = see(&all, sun(75.0, 10.0), &nadir(80.0, 5.0, 20));
    for pixel in 0..400 {
        assert_near("coverage", seen.footprints.coverage(pixel), 1.0, 1e-12);
        assert_near("lit", seen.lit(pixel), 1.0, 1e-9);
    }
}

#[test]
fn a_plate_lit_from_behind_is_black() {
    let seen = see(&plane(1.0, 0.0), direction([0.3, 0.1, -1.0]), &nadir(10.0, 1.0, 4));
    assert_near("coverage", totals(&seen, |_| true).0, 16.0, 1e-12);
    assert_eq!(totals(&seen, |_| true).1, 0.0);
}

#[test]
fn an_open_sheet_with_the_sun_below_its_horizon_is_black() {
    // Waves whose far sides face a Sun 5 degrees below the horizon: the sheet's underside is in the way.
    let hills = grid(50.0, 100, |x, y| 0.5 * (0.4 * x).sin() * (0.3 * y).cos());
    let seen = see(&hills, sun(95.0, 30.0), &nadir(1000.0, 60.0, 16));
    assert_near("coverage", totals(&seen, |_| true).0, 256.0, 1e-9);
    // 20 m from the rim towards the Sun its rays come from 1.7 m below: more than the waves are high.
    for pixel in 0..256 {
        assert_near("lit", seen.lit(pixel), 0.0, 1e-12);
    }
}

#[test]
fn a_flipped_facet_shows_no_sky() {
    let mut m = grid(1.0, 4, |_, _| 0.0);
    m.facets[13].swap(0, 1);
    let topology = mmxrt::visibility::Topology::new(&m);
    assert_eq!(topology.flipped_facets, 1);
    let seen = see(&m, sun(30.0, 0.0), &nadir(10.0, 1.5, 12));
    for pixel in 0..144 {
        assert_near("coverage", seen.footprints.coverage(pixel), 1.0, 1e-12);
    }
    let (area, lit) = totals(&seen, |f| f == 13);
    assert!(area > 0.0 && lit == 0.0);
}

#[test]
fn the_inside_of_a_closed_body_shows_no_sky() {
    let ball = sphere([0.0; 3], 1.0, 3);
    // Seen from outside: where the sphere inscribed in the mesh is, there is no sky.
    let cam = camera([30.0, 20.0, 10.0], [0.0; 3], [0.0, 0.0, 1.0], 64, 0.05 / 64.0);
    let seen = see(&ball, direction([1.0, -1.0, 0.2]), &cam);
    let mut inside = 0;
    for pixel in 0..64 * 64 {
        let (x, y) = (f64::from(pixel % 64) + 0.5, f64::from(pixel / 64) + 0.5);
        let off = cam.ray(x, y).normalize();
        let axis = cam.ray(32.0, 32.0).normalize();
        if axis.cross(off).length() < 0.024 {
            inside += 1;
            assert_near("coverage", seen.footprints.coverage(pixel as usize), 1.0, 1e-12);
        }
    }
    assert!(inside > 1000);
}

#[test]
fn half_of_a_half_sunk_ball_is_seen() {
    // A ball around a point of a plane: from above its upper half hides as much plane as its equator encloses.
    let ball = of_material(sphere([0.0; 3], 1.0, 4), 1);
    let ground = plane(3.0, 0.0);
    let both = joined(&[ground.clone(), ball]);
    let cam = nadir(1e5, 4.0, 40);
    let seen = see(&both, sun(0.0, 0.0), &cam);
    let (ground_area, ground_lit) = totals(&seen, |f| f < 2);
    let (ball_area, ball_lit) = totals(&seen, |f| f >= 2);
    assert_near("all", ground_area + ball_area, 1600.0, 1e-9);
    assert_near("ball", ball_area * 0.01, std::f64::consts::PI, 0.02);
    // From very far the Sun at the zenith and the camera see the same, but for the ring that perspective shows less of.
    assert_near("lit ball", ball_lit, ball_area, 1e-2);
    assert_near("lit ground", ground_lit, ground_area, 1e-3);
}

#[test]
fn a_facet_through_the_camera_plane_is_cut_there() {
    // The ground reaches from behind the camera to far ahead; the camera looks at the horizon: half the image is ground.
    let ground = mesh(&[[-1e5, -1e6, 0.0], [1e5, -1e6, 0.0], [0.0, 1e7, 0.0]], &[[0, 1, 2]]);
    let cam = camera([0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0], 8, 0.01);
    let seen = see(&ground, sun(10.0, 0.0), &cam);
    for pixel in 0..64usize {
        // The horizon is 1e-7 below the middle of the image; the sides are seen up to |x| = 0.04.
        let expected = if pixel < 32 { 0.0 } else { 1.0 };
        assert_near("coverage", seen.footprints.coverage(pixel), expected, 1e-4);
        assert_near("lit", seen.lit(pixel), seen.footprints.coverage(pixel), 1e-9);
    }
}

#[test]
fn a_camera_close_to_the_ground_sees_no_point_twice() {
    // Facets beside, below and behind the camera are cut; boxes stand before and among them.
    let hills = grid(100.0, 60, |x, y| (0.3 * x).sin() + (0.23 * y + 0.2 * x).cos());
    let boxes: Vec<_> = (0..12)
        .map(|k| {
            let (x, y) = (7.0 * f64::from(k) - 40.0, 3.0 * f64::from(k % 5) - 4.0);
            of_material(cuboid([x, y, -3.0], [x + 2.0, y + 1.5, 4.0]), 1)
        })
        .collect();
    let all = joined(&[vec![hills], boxes].concat());
    let mut below = 0;
    for (from, pitch) in [([0.3, -1.0, 2.5], 0.3), ([-5.2, 6.0, 3.0], 1.0), ([20.0, 20.0, 2.2], 5.0)] {
        let cam = camera(from, [from[0] + 3.0, from[1] + 1.0, from[2]], [0.0, 0.0, 1.0], 24, pitch);
        // `see` refuses pixels that add up to more than 1.
        let seen = see(&all, sun(50.0, 120.0), &cam);
        for pixel in 0..24 * 24 {
            // More than 7 deg below the horizontal every ray meets ground 20 m away or nearer, from 3 m up.
            let (x, y) = (f64::from(pixel % 24) + 0.5, f64::from(pixel / 24));
            if cam.ray(x, y).normalize().z < -0.12 {
                below += 1;
                let got = seen.footprints.coverage(pixel as usize);
                assert_near(&format!("pitch {pitch}, pixel {pixel}"), got, 1.0, 1e-12);
            }
        }
    }
    assert!(below > 500, "{below}");
}

#[test]
fn a_hundred_thousand_facets_in_one_pixel_add_up() {
    let hills = grid(1.0, 224, |x, y| 0.2 * (7.0 * x).sin() * (5.0 * y).cos());
    assert!(hills.facets.len() > 100_000);
    let seen = see(&hills, sun(60.0, 45.0), &nadir(1e3, 2.0 * 8.0, 1));
    // One pixel 16 m wide holds the whole square of 2 m: its image is that of the rim, at height 0.2 sin 7x cos 5y / 1000 m.
    assert_near("coverage", seen.footprints.coverage(0), 4.0 / 256.0, 1e-6);
    let eight = see(&hills, sun(60.0, 45.0), &nadir(1e3, 16.0, 8));
    assert_near("coverage of 64 pixels", totals(&eight, |_| true).0 / 64.0, seen.footprints.coverage(0), 1e-14);
    assert_near("lit", totals(&eight, |_| true).1 / 64.0, totals(&seen, |_| true).1, 1e-12);
}

/// The common part of two convex polygons, both counter-clockwise: written apart from the product, on purpose.
fn common(a: &[[f64; 2]], b: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut p = a.to_vec();
    for i in 0..b.len() {
        let (s, e) = (b[i], b[(i + 1) % b.len()]);
        let d = |q: &[f64; 2]| (e[0] - s[0]) * (q[1] - s[1]) - (e[1] - s[1]) * (q[0] - s[0]);
        let mut next = vec![];
        for k in 0..p.len() {
            let (u, v) = (p[k], p[(k + 1) % p.len()]);
            let (du, dv) = (d(&u), d(&v));
            if du >= 0.0 {
                next.push(u);
            }
            if du * dv < 0.0 {
                let t = du / (du - dv);
                next.push([u[0] + t * (v[0] - u[0]), u[1] + t * (v[1] - u[1])]);
            }
        }
        p = next;
    }
    p
}

fn area(p: &[[f64; 2]]) -> f64 {
    (0..p.len()).map(|k| p[k][0] * p[(k + 1) % p.len()][1] - p[(k + 1) % p.len()][0] * p[k][1]).sum::<f64>() / 2.0
}

/// Convex hull, counter-clockwise.
fn hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut p = points.to_vec();
    p.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let chain = |points: Vec<[f64; 2]>| {
        let mut c: Vec<[f64; 2]> = vec![];
        for q in points {
            while c.len() > 1 {
                let (a, b) = (c[c.len() - 2], c[c.len() - 1]);
                if (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]) > 0.0 {
                    break;
                }
                c.pop();
            }
            c.push(q);
        }
        c.pop();
        c
    };
    let mut h = chain(p.clone());
    p.reverse();
    h.extend(chain(p));
    h
}

#[test]
fn the_shadow_of_a_box_is_exact_in_every_pixel() {
    let (lo, hi) = ([-3.0, -2.0, -1.0], [2.0, 4.0, 5.0]);
    let scene = joined(&[plane(1000.0, 0.0), of_material(cuboid(lo, hi), 1)]);
    let pixels = 32usize;
    let mut shadowed_pixels = 0;
    for incidence in [24.0, 60.0, 85.0, 89.0] {
        let sun = sun(incidence, 33.0);
        let s = sun.vec();
        let cam = camera(
            [3.0, -5.0, 400.0],
            [-10.0, -8.0, 0.0],
            [0.1, 1.0, 0.0],
            pixels as u32,
            60.0 / 400.0 / pixels as f64,
        );
        let seen = see(&scene, sun, &cam);
        let image = |p: DVec3| {
            let q = cam.world_from_sensor.inverse().point(p);
            [q.x / q.z / cam.pitch[0] + 16.0, q.y / q.z / cam.pitch[1] + 16.0]
        };
        let corner = |n: usize, z: Option<f64>| {
            DVec3::new([lo[0], hi[0]][n & 1], [lo[1], hi[1]][n >> 1 & 1], z.unwrap_or([0.0, hi[2]][n >> 2]))
        };
        // Shadow on z = 0: the hull of the box's foot and of its top, moved along the Sun's rays. Silhouette: hull of its corners.
        let shadow = hull(
            &(0..8)
                .map(|n| {
                    let p = corner(n, None);
                    image(p - s * (p.z / s.z))
                })
                .collect::<Vec<_>>(),
        );
        let silhouette = hull(&(0..8).map(|n| image(corner(n, None))).collect::<Vec<_>>());
        let shadowed_silhouette = common(&shadow, &silhouette);
        for pixel in 0..pixels * pixels {
            let (x, y) = ((pixel % pixels) as f64, (pixel / pixels) as f64);
            let cell = [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
            let (in_shadow, hidden) = (area(&common(&cell, &shadow)), area(&common(&cell, &silhouette)));
            let both = area(&common(&cell, &shadowed_silhouette));
            let lit: f64 = seen.footprints.pixel(pixel).filter(|p| p.0 < 2).map(|p| p.2).sum();
            let visible: f64 = seen.footprints.pixel(pixel).filter(|p| p.0 < 2).map(|p| p.1).sum();
            assert_near(&format!("{incidence} deg, pixel {pixel}: visible ground"), visible, 1.0 - hidden, 1e-9);
            assert_near(
                &format!("{incidence} deg, pixel {pixel}: lit ground"),
                lit,
                1.0 - (in_shadow + hidden - both),
                1e-9,
            );
            shadowed_pixels += usize::from(in_shadow - both > 0.01);
        }
    }
    assert!(shadowed_pixels > 200, "{shadowed_pixels}");
}

#[test]
fn order_and_subdivision_of_facets_change_nothing() {
    let hills = |n| grid(20.0, n, |x, y| 3.0 * (0.5 * x).sin() + 2.0 * (0.4 * y + 0.1 * x).cos());
    let coarse = joined(&[hills(16), of_material(cuboid([-4.0, -4.0, -3.0], [1.0, 2.0, 7.0]), 1)]);
    let cam = camera([20.0, -30.0, 90.0], [0.0; 3], [0.0, 1.0, 0.0], 24, 0.015);
    let sun = sun(70.0, 200.0);
    let seen = see(&coarse, sun, &cam);
    // Reversed order of facets.
    let mut reversed = coarse.clone();
    reversed.facets.reverse();
    reversed.material.reverse();
    let other = see(&reversed, sun, &cam);
    let n = coarse.facets.len() as u32;
    for pixel in 0..24 * 24 {
        let mut back: Vec<_> = other.footprints.pixel(pixel).map(|(f, a, l)| (n - 1 - f, a, l)).collect();
        back.sort_by_key(|e| e.0);
        let here: Vec<_> = seen.footprints.pixel(pixel).collect();
        let value =
            |list: &[(u32, f64, f64)], f: u32| list.iter().find(|e| e.0 == f).map_or((0.0, 0.0), |e| (e.1, e.2));
        for f in here.iter().chain(&back).map(|e| e.0) {
            let (a, b) = (value(&here, f), value(&back, f));
            assert_near("fraction", a.0, b.0, 1e-12);
            assert_near("lit", a.1, b.1, 1e-12);
        }
    }
    // Every facet cut into four at the middles of its edges.
    let mut fine = coarse.clone();
    fine.facets.clear();
    fine.material.clear();
    for (f, m) in coarse.facets.iter().zip(&coarse.material) {
        let [a, b, c] = f.map(|v| coarse.vertices_m[v as usize]);
        let base = fine.vertices_m.len() as u32;
        fine.vertices_m.extend([(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0]);
        let (d, e, g) = (base, base + 1, base + 2);
        fine.facets.extend([[f[0], d, g], [f[1], e, d], [f[2], g, e], [d, e, g]]);
        fine.material.extend([*m; 4]);
    }
    let cut = see(&fine, sun, &cam);
    for pixel in 0..24 * 24 {
        for f in 0..n {
            let whole =
                seen.footprints.pixel(pixel).filter(|e| e.0 == f).fold((0.0, 0.0), |s, e| (s.0 + e.1, s.1 + e.2));
            let parts =
                cut.footprints.pixel(pixel).filter(|e| e.0 / 4 == f).fold((0.0, 0.0), |s, e| (s.0 + e.1, s.1 + e.2));
            assert_near("fraction", whole.0, parts.0, 1e-12);
            assert_near("lit", whole.1, parts.1, 1e-12);
        }
    }
}
