//! The thesis's own test scene (its Figure 22): a plane and two boulders, the larger one red, the rest green; the Sun from the left and the right,
//! high and low, and obliquely (Figures 23 and 24).

use glam::{DMat3, DVec3};

use super::painter::{painted_image, painted_sunlight};
use super::scenes::{ball, by_rays, camera, cells, exact, joined, lit_by, rms, scene};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::geometry::{Direction, Mesh};
use crate::scene::Scene;
use crate::study::chart::{facing_the_sun, lit_at_centroid};
use crate::visibility::RayTree;

const RED: f64 = 0.3;
const GREEN: f64 = 0.6;

/// Elevation and azimuth of the Sun, deg.
const SUNS: [[f64; 2]; 7] =
    [[60.0, 135.0], [45.0, 0.0], [45.0, 180.0], [30.0, 45.0], [25.0, 0.0], [25.0, 180.0], [10.0, 225.0]];

fn mesh() -> Mesh {
    let ground = cells([-10.0; 2], [10.0; 2], [10; 2], |_, _| 1);
    let large = ball(DVec3::new(-1.5, 0.5, 0.9), DVec3::new(2.6, 2.1, 2.0), 6, 0);
    let small = ball(DVec3::new(4.5, -3.0, 0.4), DVec3::new(1.2, 1.4, 1.0), 5, 1);
    joined([ground, large, small])
}

/// The scene, turned as a whole.
fn turned(turn: DMat3, [elevation_deg, azimuth_deg]: [f64; 2]) -> Result<Scene> {
    let mesh = mesh();
    let mesh = Mesh { vertices_m: mesh.vertices_m.iter().map(|v| turn * *v).collect(), ..mesh };
    let towards = super::scenes::sun(90.0 - elevation_deg, azimuth_deg)?;
    let towards = Direction::new(turn * towards.vec()).unwrap_or(towards);
    let camera = camera(turn * (60.0 * DVec3::Z), DVec3::ZERO, turn * DVec3::Y, 32, 18.0 / 60.0 / 32.0)?;
    scene(mesh, &[RED, GREEN], towards, camera)
}

pub(super) fn hazard() -> Result<Hazard> {
    type Way = fn(&Scene) -> Result<Vec<f64>>;
    const WAYS: [(&str, bool, &str, Way); 5] = [
        ("exact", true, "Agrees with itself in any orientation, and with rays to within their noise.", exact),
        ("64 rays per pixel", false, "Noise at edges of shadows and boulders.", |scene| by_rays(scene, 64)),
        ("shadow by facet centroid", false, "With few facets whole ground cells turn dark or bright.", |scene| {
            lit_by(scene, lit_at_centroid(scene, &RayTree::new(&scene.body.mesh)))
        }),
        ("no shadows", false, "What the boulders hide from the Sun is bright.", |scene| {
            lit_by(scene, facing_the_sun(scene))
        }),
        (
            "painter's algorithm, image and shadows",
            false,
            "Half-sunk boulders cross the ground: facets there have no order, in the image and in shadows.",
            |scene| {
                let sunlit = painted_sunlight(&scene.body.mesh, scene.sky.sun.direction);
                Ok(painted_image(scene, &sunlit, &[RED, GREEN]))
            },
        ),
    ];
    let turn = DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(1.1) * DMat3::from_rotation_y(-0.4);
    let mut sweeps: Vec<Sweep> = WAYS
        .iter()
        .map(|(method, is_ours, then, _)| Sweep { method, is_ours: *is_ours, then, points: vec![] })
        .collect();
    for sun in SUNS {
        let (scene, truth) = (turned(DMat3::IDENTITY, sun)?, exact(&turned(turn, sun)?)?);
        for (sweep, (.., way)) in sweeps.iter_mut().zip(&WAYS) {
            sweep.points.push(Point { at: 90.0 - sun[0], error: rms(&way(&scene)?, &truth) });
        }
    }
    Ok(Hazard {
        name: "the thesis's test scene",
        parameter: "incidence on the plane, deg (seven Suns)",
        truth: "A plane, a large red and a small green half-sunk boulder from above, 32 x 32 pixels, against the exact image of the same scene turned as a whole; error is \
                the root mean square over the brightest pixel.",
        sweeps,
    })
}
