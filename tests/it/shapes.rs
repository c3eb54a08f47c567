//! Small meshes and cameras that the tests share.

use glam::{DMat3, DVec3};
use mmxrt::geometry::FrameCamera;
use mmxrt::geometry::{Direction, MaterialId, Mesh, Pose};
use mmxrt::integrate::footprints;
use mmxrt::product::Footprints;
use mmxrt::visibility::Topology;

pub(crate) fn mesh(vertices: &[[f64; 3]], facets: &[[u32; 3]]) -> Mesh {
    Mesh {
        vertices_m: vertices.iter().map(|v| DVec3::from_array(*v)).collect(),
        facets: facets.to_vec(),
        material: vec![MaterialId(0); facets.len()],
        face_of_facet: vec![],
        uv: vec![],
    }
}

pub(crate) fn of_material(mut mesh: Mesh, material: u16) -> Mesh {
    mesh.material.fill(MaterialId(material));
    mesh
}

pub(crate) fn joined(meshes: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    meshes.iter().for_each(|m| all.append(m.clone()));
    all
}

/// A flat quad, counter-clockwise seen from its front.
pub(crate) fn quad(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> Mesh {
    mesh(&[a, b, c, d], &[[0, 1, 2], [0, 2, 3]])
}

/// A horizontal square of half width `r` at height `z`, facing up.
pub(crate) fn plane(r: f64, z: f64) -> Mesh {
    quad([-r, -r, z], [r, -r, z], [r, r, z], [-r, r, z])
}

/// A horizontal square cut into n x n cells of two facets, facing up.
pub(crate) fn grid(r: f64, n: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
    let at = |i: u32| -r + 2.0 * r * f64::from(i) / f64::from(n);
    let mut m = Mesh::default();
    for j in 0..=n {
        for i in 0..=n {
            m.vertices_m.push(DVec3::new(at(i), at(j), height(at(i), at(j))));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
            m.facets.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    m.material = vec![MaterialId(0); m.facets.len()];
    m
}

/// A box, closed, outward.
pub(crate) fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Mesh {
    let p = |i: usize, j: usize, k: usize| [[lo[0], hi[0]][i], [lo[1], hi[1]][j], [lo[2], hi[2]][k]];
    let v: Vec<[f64; 3]> = (0..8).map(|n| p(n & 1, n >> 1 & 1, n >> 2)).collect();
    mesh(
        &v,
        &[
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ],
    )
}

/// A sphere from an icosahedron split `n` times: 20 x 4^n facets.
pub(crate) fn sphere(centre: [f64; 3], radius: f64, n: u32) -> Mesh {
    let t = (1.0 + 5f64.sqrt()) / 2.0;
    let mut v: Vec<DVec3> = [
        [-1.0, t, 0.0],
        [1.0, t, 0.0],
        [-1.0, -t, 0.0],
        [1.0, -t, 0.0],
        [0.0, -1.0, t],
        [0.0, 1.0, t],
        [0.0, -1.0, -t],
        [0.0, 1.0, -t],
        [t, 0.0, -1.0],
        [t, 0.0, 1.0],
        [-t, 0.0, -1.0],
        [-t, 0.0, 1.0],
    ]
    .map(DVec3::from_array)
    .to_vec();
    let mut f: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..n {
        let mut middle = std::collections::BTreeMap::new();
        let mut between = |a: u32, b: u32, v: &mut Vec<DVec3>| {
            *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                v.push((v[a as usize].normalize() + v[b as usize].normalize()).normalize());
                v.len() as u32 - 1
            })
        };
        f = f
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (d, e, g) = (between(a, b, &mut v), between(b, c, &mut v), between(c, a, &mut v));
                [[a, d, g], [b, e, d], [c, g, e], [d, e, g]]
            })
            .collect();
    }
    Mesh {
        vertices_m: v.iter().map(|p| DVec3::from_array(centre) + radius * p.normalize()).collect(),
        material: vec![MaterialId(0); f.len()],
        facets: f,
        face_of_facet: vec![],
        uv: vec![],
    }
}

/// A camera at `from` looking at `at`, image top towards `up`.
pub(crate) fn camera(from: [f64; 3], at: [f64; 3], up: [f64; 3], pixels: u32, pitch: f64) -> FrameCamera {
    let from = DVec3::from_array(from);
    let u = (DVec3::from_array(at) - from).normalize();
    let h = u.cross(DVec3::from_array(up)).normalize();
    let pose = Pose { rotation: DMat3::from_cols(h, u.cross(h), u), translation_m: from };
    FrameCamera::centred(pose, pixels, pixels, pitch)
}

/// A camera above the origin looking down that sees `width` metres of the plane z = 0; x to the right, y up.
pub(crate) fn nadir(height: f64, width: f64, pixels: u32) -> FrameCamera {
    camera([0.0, 0.0, height], [0.0; 3], [0.0, 1.0, 0.0], pixels, width / height / f64::from(pixels))
}

/// A camera at the origin that sees (x, y, 1) at (x + columns / 2, y + rows / 2) in an image of columns x rows pixels.
pub(crate) fn unit_camera(columns: u32, rows: u32) -> FrameCamera {
    FrameCamera::centred(
        camera([0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], 1, 1.0).world_from_sensor,
        columns,
        rows,
        1.0,
    )
}

/// Numbers without a pattern, the same in every run: splitmix64 (Steele, Lea & Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// The next 64 bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Evenly from 0 to 1, 1 excluded.
    pub(crate) fn share(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly from the whole numbers of a range, both ends included.
    pub(crate) fn whole(&mut self, from: i64, to: i64) -> i64 {
        from + (self.share() * (to - from + 1) as f64) as i64
    }
}

pub(crate) fn direction(v: [f64; 3]) -> Direction {
    Direction::new(DVec3::from_array(v)).expect("a direction")
}

/// Towards a Sun at an incidence on a horizontal plane and an azimuth from x towards y.
pub(crate) fn sun(incidence_deg: f64, azimuth_deg: f64) -> Direction {
    let (i, a) = (incidence_deg.to_radians(), azimuth_deg.to_radians());
    direction([i.sin() * a.cos(), i.sin() * a.sin(), i.cos()])
}

pub(crate) struct Seen {
    pub(crate) sunlit: mmxrt::visibility::Seen,
    pub(crate) footprints: Footprints,
}

impl Seen {
    /// Share of a pixel that sees sunlit surface.
    pub(crate) fn lit(&self, pixel: usize) -> f64 {
        self.footprints.pixel(pixel).map(|(_, _, lit)| lit).sum()
    }
}

/// Shadows and footprints, checked for inner consistency.
pub(crate) fn see(mesh: &Mesh, sun: Direction, camera: &FrameCamera) -> Seen {
    let topology = Topology::new(mesh);
    let sunlit = mmxrt::visibility::Seen::from_afar(mesh, &topology, sun, "sunlight", &mmxrt::progress::unwatched)
        .expect("not interrupted");
    sunlit.validate().expect("sunlit polygons are consistent");
    let footprints = footprints(mesh, &topology, &sunlit, camera);
    footprints.validate().expect("footprints are consistent");
    Seen { sunlit, footprints }
}

/// Sum of fractions, and of lit fractions, over an image of the facets that `which` selects, pixels.
pub(crate) fn totals(seen: &Seen, which: impl Fn(u32) -> bool) -> (f64, f64) {
    let f = &seen.footprints;
    (0..f.facet.len())
        .filter(|i| which(f.facet[*i]))
        .fold((0.0, 0.0), |s, i| (s.0 + f.fraction[i], s.1 + f.lit_fraction[i]))
}
