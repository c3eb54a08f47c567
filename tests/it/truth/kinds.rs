//! Kinds of scenes that have little but corner cases: a few facets each, most of them with small whole numbers.

use glam::{DMat3, DVec3};
use mmxrt::formats::obj;
use mmxrt::geometry::FrameCamera;
use mmxrt::geometry::{Direction, MaterialId, Mesh, Pose};

use crate::shapes::*;

pub(super) struct Scene {
    pub(super) mesh: Mesh,
    /// The mesh before its vertices were moved by little more than rounding: what ties are decided by may be either.
    pub(super) before: Option<Mesh>,
    pub(super) towards_sun: Direction,
    pub(super) camera: FrameCamera,
}

/// Of the materials 0, 1 and 2.
pub(super) const REFLECTANCE: [f64; 3] = [0.9, 0.5, 0.3];

fn chance(r: &mut Random, share: f64) -> bool {
    r.share() < share
}

fn pick<T: Copy>(r: &mut Random, from: &[T]) -> T {
    from[r.whole(0, from.len() as i64 - 1) as usize]
}

fn between(r: &mut Random, from: i64, to: i64) -> f64 {
    r.whole(from, to) as f64
}

fn point(r: &mut Random, reach: i64) -> [f64; 3] {
    [(); 3].map(|()| between(r, -reach, reach))
}

fn material(r: &mut Random, mesh: Mesh) -> Mesh {
    let material = r.whole(0, 2) as u16;
    of_material(mesh, material)
}

fn turned(mut mesh: Mesh) -> Mesh {
    mesh.facets.iter_mut().for_each(|f| f.swap(0, 1));
    mesh
}

/// Along an axis, in a coordinate plane, of small whole numbers, or any; `above`: not from below.
fn sun_towards(r: &mut Random, above: bool) -> Direction {
    loop {
        let mut v = match r.whole(0, 4) {
            0 => pick(r, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]]),
            1 => {
                let mut v = point(r, 3);
                v[r.whole(0, 2) as usize] = 0.0;
                v
            }
            2 | 3 => point(r, 4),
            _ => [(); 3].map(|()| r.share() - 0.5),
        };
        if above {
            v[2] = f64::abs(v[2]);
        }
        if let Some(towards) = Direction::new(DVec3::from_array(v)) {
            return towards;
        }
    }
}

/// Looks from a place along an axis, with axes that are exact.
fn along(from: [f64; 3], axis: usize, back: bool, size: [u32; 2], pitch: f64) -> FrameCamera {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let u = if back { -axes[axis] } else { axes[axis] };
    let h = axes[(axis + 1) % 3];
    let rotation = DMat3::from_cols(h, u.cross(h), u);
    let pose = Pose { rotation, translation_m: DVec3::from_array(from) };
    FrameCamera::centred(pose, size[0], size[1], pitch)
}

fn image_size(r: &mut Random) -> [u32; 2] {
    [r.whole(2, 6) as u32, r.whole(2, 5) as u32]
}

/// A view of what lies within `reach` of the origin: along an axis, or from anywhere; `above`: from above.
fn view(r: &mut Random, reach: f64, above: bool) -> FrameCamera {
    let size = image_size(r);
    let distance = reach * pick(r, &[1.5, 2.0, 4.0]);
    // Tangents so that corners come to lie on the borders of pixels, or any.
    let pitch = if chance(r, 0.5) {
        reach / distance * pick(r, &[0.25, 0.5, 1.0])
    } else {
        reach / distance * (0.2 + r.share())
    };
    if chance(r, 0.6) {
        let (axis, back) = if above { (2, true) } else { (r.whole(0, 2) as usize, chance(r, 0.5)) };
        let mut from = point(r, 2);
        from[axis] = if back { distance } else { -distance };
        return along(from, axis, back, size, pitch);
    }
    let mut v = DVec3::from_array([(); 3].map(|()| r.share() - 0.5));
    if above {
        v.z = v.z.abs() + 0.1;
    }
    let from = distance * v.normalize_or(DVec3::Z);
    let target = [(); 3].map(|()| 0.3 * reach * (r.share() - 0.5));
    let camera = camera(from.to_array(), target, [0.1, 0.3, 0.9], 1, pitch);
    FrameCamera::centred(camera.world_from_sensor, size[0], size[1], pitch)
}

/// Triangles around a centre, the ring in whole numbers.
fn fan(r: &mut Random) -> Mesh {
    let mut ring: Vec<[i64; 2]> = (0..r.whole(4, 9)).map(|_| [r.whole(-5, 5), r.whole(-5, 5)]).collect();
    ring.retain(|p| *p != [0, 0]);
    let angle = |p: &[i64; 2]| (p[1] as f64).atan2(p[0] as f64);
    ring.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    ring.dedup_by(|a, b| a[0] * b[1] == a[1] * b[0] && a[0] * b[0] + a[1] * b[1] > 0);
    let [x, y] = [(); 2].map(|()| between(r, -2, 2));
    let steep = r.whole(0, 2);
    let mut vertices = vec![[x, y, between(r, -steep, steep)]];
    vertices.extend(ring.iter().map(|p| [x + p[0] as f64, y + p[1] as f64, between(r, -steep, steep)]));
    let n = ring.len() as u32;
    let mut facets: Vec<[u32; 3]> = (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect();
    // Where the ring leaves a gap of half a turn the facet would face down.
    facets.retain(|f| {
        let [a, b] = [f[1] as usize - 1, f[2] as usize - 1].map(|k| ring[k]);
        a[0] * b[1] - a[1] * b[0] > 0
    });
    mesh(&vertices, &facets)
}

fn ground(r: &mut Random, half: f64, z: f64) -> Mesh {
    let plane = if chance(r, 0.5) { plane(half, z) } else { grid(half, 2, |_, _| z) };
    material(r, plane)
}

pub(super) fn fans(r: &mut Random) -> Scene {
    let mut parts = vec![];
    for _ in 0..r.whole(1, 3) {
        let fan = fan(r);
        parts.push(material(r, fan));
    }
    if chance(r, 0.5) {
        parts.push(ground(r, 6.0, -3.0));
    }
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, true), camera: view(r, 6.0, true) }
}

/// Faces of many corners, in planes of whole numbers, cut as the OBJ reader cuts them.
pub(super) fn polygons(r: &mut Random) -> Scene {
    let mut parts = vec![];
    for _ in 0..r.whole(1, 4) {
        let mut ring: Vec<[i64; 2]> = (0..r.whole(5, 10)).map(|_| [r.whole(-6, 6), r.whole(-6, 6)]).collect();
        ring.retain(|p| *p != [0, 0]);
        let angle = |p: &[i64; 2]| (p[1] as f64).atan2(p[0] as f64);
        ring.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        ring.dedup_by(|a, b| a[0] * b[1] == a[1] * b[0] && a[0] * b[0] + a[1] * b[1] > 0);
        if ring.len() < 4 {
            continue;
        }
        let [a, b, z] = [between(r, -1, 1), between(r, -1, 1), between(r, -3, 3)];
        let mut text = String::new();
        for [x, y] in ring.iter().map(|p| p.map(|x| x as f64)) {
            text += &format!("v {x} {y} {}\n", z + a * x + b * y);
        }
        let corners: Vec<String> = (1..=ring.len()).map(|k| k.to_string()).collect();
        text += &format!("f {}\n", corners.join(" "));
        let mut no_materials = |_: &str| Ok(vec![]);
        let file = obj::parse(&mut text.as_bytes(), std::path::Path::new("ring.obj"), &mut no_materials).unwrap();
        let face = Mesh {
            vertices_m: file.vertices,
            material: vec![MaterialId(0); file.facets.len()],
            facets: file.facets,
            ..Mesh::default()
        };
        parts.push(material(r, face));
    }
    parts.push(ground(r, 7.0, -8.0));
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, true), camera: view(r, 8.0, true) }
}

fn block(r: &mut Random, reach: i64, floor: Option<f64>) -> Mesh {
    let mut lo = point(r, reach);
    let size = [(); 3].map(|()| between(r, 1, 3));
    if let Some(z) = floor {
        lo[2] = z;
    }
    cuboid(lo, [0, 1, 2].map(|k| lo[k] + size[k]))
}

/// Bodies that stand on the ground, are sunk into it, touch and overlap one another.
pub(super) fn boxes(r: &mut Random) -> Scene {
    let mut parts = vec![ground(r, 6.0, 0.0)];
    for _ in 0..r.whole(1, 3) {
        let floor = if chance(r, 0.6) { Some(0.0) } else { None };
        let block = block(r, 3, floor);
        parts.push(material(r, block));
    }
    let above = chance(r, 0.7);
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, true), camera: view(r, 6.0, above) }
}

/// Triangles 1e-3 to 1e-12 as wide as they are long, alone and as strips of a plane or between planes.
pub(super) fn slivers(r: &mut Random) -> Scene {
    let mut parts = vec![ground(r, 6.0, 0.5)];
    for _ in 0..r.whole(2, 6) {
        // A power of 2, and fractions that are, so that strips of a plane lie in it to the last bit.
        let thin = 0.5f64.powi(r.whole(10, 36) as i32);
        let (a, b) = (DVec3::from_array(point(r, 4)), DVec3::from_array(point(r, 4)));
        let aside = DVec3::from_array(point(r, 3));
        let up = DVec3::Z * between(r, 1, 2);
        let c = a.lerp(b, pick(r, &[0.0, 0.25, 0.5, 0.875])) + thin * aside;
        let [a, b, c] = [a + up, b + up, c + up].map(|p| p.to_array());
        let sliver = if chance(r, 0.5) {
            mesh(&[a, b, c], &[[0, 1, 2]])
        } else {
            // A strip between two triangles.
            let [d, e] = [point(r, 4), point(r, 4)];
            mesh(&[a, b, c, d, e], &[[0, 1, 2], [1, 0, 3], [0, 2, 4], [2, 1, 4]])
        };
        parts.push(material(r, sliver));
    }
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, true), camera: view(r, 6.0, true) }
}

/// Rectangles in few planes that overlap one another, facing either way, and faces with their reverse. One material a plane.
pub(super) fn sheets(r: &mut Random) -> Scene {
    let mut parts = vec![];
    let planes: Vec<([usize; 3], f64)> = (0..r.whole(1, 2))
        .map(|_| (pick(r, &[[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 1, 2]]), between(r, -1, 1)))
        .collect();
    for _ in 0..r.whole(2, 5) {
        let (axes, at) = pick(r, &planes);
        let [x, y] = [(); 2].map(|()| between(r, -4, 2));
        let [w, d] = [(); 2].map(|()| between(r, 1, 5));
        let corner = |s: f64, t: f64| {
            let mut p = [0.0; 3];
            p[axes[0]] = x + w * s;
            p[axes[1]] = y + d * t;
            p[axes[2]] = at;
            p
        };
        let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let first = r.whole(0, 3) as usize;
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| corners[(first + k) % 4]);
        let sheet = of_material(quad(a, b, c, d), axes[2] as u16);
        let reverse = of_material(quad(d, c, b, a), axes[2] as u16);
        match r.whole(0, 3) {
            0 => parts.push(sheet),
            1 => parts.push(reverse),
            2 => parts.extend([sheet, reverse]),
            // The same vertices, as modellers do it.
            _ => {
                let mut both = sheet.clone();
                both.facets.extend(sheet.facets.iter().map(|f| [f[2], f[1], f[0]]));
                both.material.extend(sheet.material);
                parts.push(both);
            }
        }
    }
    if chance(r, 0.4) {
        parts.push(of_material(plane(6.0, -2.0), 0));
    }
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, false), camera: view(r, 5.0, false) }
}

/// Walls that face inward around the eye, closed or without some faces, and bodies in them.
pub(super) fn rooms(r: &mut Random) -> Scene {
    let half = between(r, 4, 6);
    let mut room = turned(cuboid([-half; 3], [half; 3]));
    for _ in 0..r.whole(0, 2) {
        let face = r.whole(0, 5) as u32;
        if room.facets.len() > 8 {
            let kept: Vec<_> = (0..room.facets.len() as u32).filter(|f| f / 2 != face).collect();
            room.facets = kept.iter().map(|f| room.facets[*f as usize]).collect();
            room.material.truncate(room.facets.len());
        }
    }
    let mut parts = vec![material(r, room)];
    for _ in 0..r.whole(0, 2) {
        let floor = if chance(r, 0.5) { Some(-half) } else { None };
        let block = block(r, 3, floor);
        parts.push(material(r, block));
    }
    let camera = inside_view(r, half);
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, false), camera }
}

/// A wide view from a place with halves for coordinates.
fn inside_view(r: &mut Random, half: f64) -> FrameCamera {
    let reach = half as i64 - 1;
    let from = point(r, reach).map(|x| x + 0.5);
    let size = image_size(r);
    if chance(r, 0.7) {
        return along(from, r.whole(0, 2) as usize, chance(r, 0.5), size, pick(r, &[0.25, 0.5, 0.3]));
    }
    let at = [(); 3].map(|()| 10.0 * (r.share() - 0.5));
    let pose = camera(from, at, [0.1, 0.3, 0.9], 1, 0.4).world_from_sensor;
    FrameCamera::centred(pose, size[0], size[1], 0.4)
}

/// The eye on a face, an edge or a corner of a body, or inside one of several bodies, which may overlap and be in a room.
pub(super) fn eyes(r: &mut Random) -> Scene {
    let bodies: Vec<([f64; 3], [f64; 3])> = (0..r.whole(1, 3))
        .map(|_| {
            let lo = point(r, 3);
            let size = [(); 3].map(|()| 2.0 * between(r, 1, 2));
            (lo, [0, 1, 2].map(|k| lo[k] + size[k]))
        })
        .collect();
    let (lo, hi) = bodies[0];
    let inside = [0, 1, 2].map(|k| pick(r, &[lo[k], hi[k], 0.5 * (lo[k] + hi[k]), 0.75 * lo[k] + 0.25 * hi[k]]));
    let mut parts = vec![];
    for (lo, hi) in bodies {
        parts.push(material(r, cuboid(lo, hi)));
    }
    if chance(r, 0.3) {
        parts.push(material(r, turned(cuboid([-10.0; 3], [10.0, 10.0, 9.0]))));
    }
    if chance(r, 0.4) {
        parts.push(ground(r, 12.0, -4.0));
    }
    let camera = along(inside, r.whole(0, 2) as usize, chance(r, 0.5), image_size(r), pick(r, &[0.25, 0.5, 0.3]));
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, false), camera }
}

/// Facets that know nothing of one another, facing anywhere.
pub(super) fn scattered(r: &mut Random) -> Scene {
    let whole = chance(r, 0.6);
    let parts: Vec<Mesh> = (0..r.whole(5, 25))
        .map(|_| {
            let middle = DVec3::from_array(point(r, 4));
            let corners = [(); 3].map(|()| {
                let p = if whole { point(r, 2) } else { [(); 3].map(|()| 4.0 * (r.share() - 0.5)) };
                (middle + DVec3::from_array(p)).to_array()
            });
            material(r, mesh(&corners, &[[0, 1, 2]]))
        })
        .collect();
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, false), camera: view(r, 6.0, false) }
}

/// Large facets and bodies through one another.
pub(super) fn piercing(r: &mut Random) -> Scene {
    let whole = chance(r, 0.6);
    let mut parts = vec![];
    for _ in 0..r.whole(3, 8) {
        let mut corner = || if whole { point(r, 4) } else { [(); 3].map(|()| 8.0 * (r.share() - 0.5)) };
        let [a, b, c, d] = [(); 4].map(|()| corner());
        let body = match r.whole(0, 2) {
            0 => {
                let [a, b, c, d] = [a, b, c, d].map(DVec3::from_array);
                let (b, c) = if (b - a).cross(c - a).dot(d - a) > 0.0 { (c, b) } else { (b, c) };
                let corners = [a, b, c, d].map(|p| p.to_array());
                mesh(&corners, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
            }
            1 => block(r, 3, None),
            _ => mesh(&[a, b, c], &[[0, 1, 2]]),
        };
        parts.push(material(r, body));
    }
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, false), camera: view(r, 6.0, false) }
}

/// The same facets several times over, turned or not, in other orders of corners. One material.
pub(super) fn copies(r: &mut Random) -> Scene {
    let first = mesh(&[point(r, 4), point(r, 4), point(r, 4), point(r, 4)], &[[0, 1, 2], [0, 2, 3]]);
    let mut parts = vec![];
    for _ in 0..r.whole(2, 5) {
        let mut copy = first.clone();
        if chance(r, 0.4) {
            copy = turned(copy);
        }
        copy.facets.iter_mut().for_each(|f| f.rotate_left(r.whole(0, 2) as usize));
        parts.push(copy);
    }
    parts.push(of_material(plane(5.0, between(r, -4, 0)), 1));
    Scene { mesh: joined(&parts), before: None, towards_sun: sun_towards(r, true), camera: view(r, 5.0, true) }
}

/// Scenes of another kind, some vertices moved by one unit in the last place to 1e-14: by what turning a mesh leaves of its planes.
pub(super) fn nudged(r: &mut Random) -> Scene {
    let of = pick(r, &[fans, polygons, boxes, piercing, scattered]);
    let mut scene = of(r);
    scene.mesh = of_material(scene.mesh, 0);
    scene.before = Some(scene.mesh.clone());
    let share = pick(r, &[0.1, 0.5, 1.0]);
    let step = 10f64.powi(-r.whole(14, 16) as i32);
    for v in &mut scene.mesh.vertices_m {
        for k in 0..3 {
            if chance(r, share) {
                v[k] = if chance(r, 0.5) { v[k] + step * (r.share() - 0.5) } else { v[k].next_up() };
            }
        }
    }
    scene
}

/// Scattered or piercing facets from 1e3 to 1e8 m, in pixels about as large as they are.
pub(super) fn far(r: &mut Random) -> Scene {
    let mut scene = if chance(r, 0.5) { scattered(r) } else { boxes(r) };
    let camera = &mut scene.camera;
    let distance = 10f64.powi(r.whole(3, 8) as i32);
    let back = camera.world_from_sensor.rotation.z_axis * distance;
    camera.world_from_sensor.translation_m -= back;
    camera.pitch = [12.0 / (distance * f64::from(camera.samples)); 2];
    scene
}
