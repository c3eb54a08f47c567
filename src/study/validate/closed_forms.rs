//! Closed forms that the product does not use: only what it is checked with.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::{Direction, angle_rad};
use crate::physics::{GaussLegendre, blackbody, form_factor};

/// Temperature of the black body that has this radiance, K: Planck's law solved for T.
pub(super) fn brightness_temperature_k(lambda_um: f64, radiance_w_m2_sr_um: f64) -> f64 {
    let c1 = blackbody::C1_W_M2_SR_UM4 * lambda_um.powi(-5);
    blackbody::C2_UM_K / (lambda_um * (c1 / radiance_w_m2_sr_um).ln_1p())
}

/// Phase function of a Lambert sphere, 1 at 0: \[sin a + (pi - a) cos a\] / pi, in d = pi - a: (sin d - d cos d) / pi.
pub(super) fn lambert_sphere_phase(phase_deg: f64) -> f64 {
    let d = (180.0 - phase_deg).to_radians();
    if d > 0.5 {
        return (d.sin() - d * d.cos()) / PI;
    }
    // sum of (-1)^(k+1) 2k d^(2k+1) / (2k+1)!: the two terms above cancel.
    let (mut power, mut sum) = (d, 0.0);
    for k in 1..12 {
        let k = f64::from(k);
        power *= -d * d / (2.0 * k * (2.0 * k + 1.0));
        sum -= 2.0 * k * power;
    }
    sum / PI
}

/// Phase function of a Lommel-Seeliger sphere, 1 at 0: 1 - sin(a/2) tan(a/2) ln cot(a/4).
///
/// With t = tan((pi - a) / 4): 1 - (1 - c) (1 + r), c = (3 t^2 - t^4) / (1 + t^2), r = atanh(t) / t - 1.
pub(super) fn lommel_seeliger_sphere_phase(phase_deg: f64) -> f64 {
    if phase_deg == 0.0 {
        return 1.0;
    }
    let t = (0.25 * (180.0 - phase_deg).to_radians()).tan();
    let t2 = t * t;
    // Near pi the difference loses digits; its series does not.
    let r = if t < 0.1 {
        t2 * (1.0 / 3.0 + t2 * (0.2 + t2 * (1.0 / 7.0 + t2 * (1.0 / 9.0 + t2 * (1.0 / 11.0 + t2 / 13.0)))))
    } else {
        t.atanh() / t - 1.0
    };
    let c = t2 * (3.0 - t2) / (1.0 + t2);
    c + c * r - r
}

/// Phase integral of a sphere: 2 times the integral of its phase function (of degrees) times sine.
pub(super) fn phase_integral(phase_function: impl Fn(f64) -> f64) -> f64 {
    GaussLegendre::new(64).integral(0.0, PI, |a| 2.0 * phase_function(a.to_degrees()) * a.sin())
}

/// Mean over an orbit in the Sun's plane of a function of phase angle, deg: even about 0, and smooth but where light goes out.
pub(super) fn mean_over_orbit(of_phase_deg: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 2000;
    let at = |i| of_phase_deg(180.0 * f64::from(i) / f64::from(STEPS));
    let inner: f64 = (1..STEPS).map(at).sum();
    (inner + 0.5 * (at(0) + at(STEPS))) / f64::from(STEPS)
}

/// Directional-hemispherical albedo of a Lommel-Seeliger surface of isotropic particles: (w / 2) (1 - mu0 ln(1 + 1 / mu0)).
pub(super) fn lommel_seeliger_albedo(single_scattering_albedo: f64, cos_incidence: f64) -> f64 {
    0.5 * single_scattering_albedo * (1.0 - cos_incidence * cos_incidence.recip().ln_1p())
}

/// Radiosity of a cube's faces of which one emits 1: that face's, the opposite's, one of the others'. Each face has one radiosity.
///
/// Of the sum and the difference of the first two: s = 1 + rho (p s + 8 a b), d = 1 - rho p d, and b (1 - rho (p + 2 a)) = rho a s, with
/// p and a the form factors of opposite and adjacent faces.
pub(super) fn cube_radiosity(reflectance: f64) -> [f64; 3] {
    let (p, a) =
        (form_factor::parallel_rectangles(1.0, 1.0, 1.0), form_factor::perpendicular_rectangles(1.0, 1.0, 1.0));
    let per_sum = reflectance * a / (1.0 - reflectance * (p + 2.0 * a));
    let sum = 1.0 / (1.0 - reflectance * (p + 8.0 * a * per_sum));
    let difference = 1.0 / (1.0 + reflectance * p);
    [0.5 * (sum + difference), 0.5 * (sum - difference), per_sum * sum]
}

/// A bowl that is a cap of a sphere, in level ground under the Sun (Ingersoll, Svitek & Murray 1992): every point of it gets the same light
/// from the rest. Lengths in diameters of the rim.
pub(super) struct Bowl {
    pub(super) depth: f64,
    pub(super) reflectance: f64,
    pub(super) emissivity: f64,
    /// Sunlight on level ground, W m-2.
    pub(super) irradiance: f64,
}

impl Bowl {
    /// Radius of the sphere.
    pub(super) fn radius(depth: f64) -> f64 {
        (0.25 + depth * depth) / (2.0 * depth)
    }

    /// Where the shadow of the rim at -1/2 ends, on the sphere, towards +1/2; beyond that nothing of the bowl is lit.
    pub(super) fn shadow_end(depth: f64, elevation_rad: f64) -> f64 {
        let centre_height = Self::radius(depth) - depth;
        let (sin, cos) = elevation_rad.sin_cos();
        -0.5 + (cos - 2.0 * centre_height * sin) * cos
    }

    /// Form factor of the bowl from any point in it.
    pub(super) fn form_factor(&self) -> f64 {
        1.0 / (1.0 + 0.25 / (self.depth * self.depth))
    }

    /// Sunlight that the bowl gets, over its area.
    pub(super) fn mean_direct(&self) -> f64 {
        self.irradiance * (1.0 - self.form_factor())
    }

    /// Sunlight that a point gets from the rest of it, W m-2.
    pub(super) fn scattered(&self) -> f64 {
        let f = self.form_factor();
        f * self.reflectance * self.mean_direct() / (1.0 - self.reflectance * f)
    }

    /// What a black body would emit at the temperature of a shadow, W m-2.
    pub(super) fn shadow_exitance(&self) -> f64 {
        let f = self.form_factor();
        let absorbed = self.irradiance * f * (1.0 - self.reflectance) / (1.0 - self.reflectance * f);
        absorbed * (1.0 + self.reflectance * (1.0 - f) / self.emissivity)
    }

    /// Heat that a point gets from the rest of it, W m-2: what is emitted there less sunlight absorbed.
    pub(super) fn heat(&self) -> f64 {
        self.shadow_exitance() - (1.0 - self.reflectance) * self.scattered() / self.emissivity
    }

    /// Light that leaves it over light that comes in.
    pub(super) fn apparent_albedo(&self) -> f64 {
        let f = self.form_factor();
        self.reflectance * (1.0 - f) / (1.0 - self.reflectance * f)
    }
}

/// Area of an ellipsoid's outline in parallel projection: pi abc sqrt(sum of (u_i / radius_i)^2).
pub(super) fn ellipsoid_projected_area(radii: DVec3, view: DVec3) -> f64 {
    PI * radii.element_product() * (view.normalize() / radii).length()
}

/// The part of that area which is lit: (A / 2) (1 + s.C o / sqrt(s.C s o.C o)), C = diag(1 / radius^2).
pub(super) fn ellipsoid_lit_projected_area(radii: DVec3, sun: DVec3, view: DVec3) -> f64 {
    let (s, o) = (sun / radii, view / radii);
    0.5 * ellipsoid_projected_area(radii, view) * (1.0 + s.dot(o) / (s.length() * o.length()))
}

/// Integrals of mu0 mu and of mu0 mu / (mu0 + mu) over the lit and visible surface of an ellipsoid.
///
/// On the unit sphere that scales to the ellipsoid, with g = m / radii: mu = g.o / |g|, dA = abc |g| dm, and the
/// surface is a lune between two great circles, whose poles the latitude here is counted from.
pub(super) fn ellipsoid_disc_integrals(radii: DVec3, sun: DVec3, view: DVec3) -> (f64, f64) {
    let (s, o) = (sun.normalize() / radii, view.normalize() / radii);
    let middle = s.normalize();
    let pole = s.cross(o).try_normalize().unwrap_or_else(|| middle.any_orthonormal_vector());
    let east = pole.cross(middle);
    let opening = angle_rad(s, o);
    let rule = GaussLegendre::new(64);
    let integral = |f: &dyn Fn(f64, f64, f64) -> f64| {
        rule.integral(opening - 0.5 * PI, 0.5 * PI, |longitude| {
            rule.integral(-0.5 * PI, 0.5 * PI, |latitude| {
                let (sin_lat, cos_lat) = latitude.sin_cos();
                let m = cos_lat * (longitude.cos() * middle + longitude.sin() * east) + sin_lat * pole;
                f(m.dot(s), m.dot(o), (m / radii).length()) * cos_lat
            })
        }) * radii.element_product()
    };
    (integral(&|s, o, g| s * o / g), integral(&|s, o, _| s * o / (s + o)))
}

/// Pinhole image of a sphere of angular radius `a_rad` whose centre is `b_rad` off axis: distance of the ellipse's centre, semi axes along and across.
pub(super) fn pinhole_image_of_sphere(a_rad: f64, b_rad: f64, focal_length: f64) -> (f64, f64, f64) {
    let ((sin_a, cos_a), (sin_b, cos_b)) = (a_rad.sin_cos(), b_rad.sin_cos());
    let k = cos_b * cos_b - sin_a * sin_a;
    (focal_length * sin_b * cos_b / k, focal_length * sin_a * cos_a / k, focal_length * sin_a / k.sqrt())
}

/// What a pinhole projection (17) to (19) from the Sun's place loses to rounding, sideways and in depth, in f64 and f32.
pub(super) struct SunCameraRounding {
    pub(super) lateral_f64_m: f64,
    pub(super) lateral_f32_m: f64,
    pub(super) depth_f64_m: f64,
    pub(super) depth_f32_m: f64,
    /// Distance from the Sun's place to the target, m.
    pub(super) depth_m: f64,
}

/// Largest rounding over 4000 points within 1 km of `target_m` about each axis, against sums without rounding.
pub(super) fn sun_camera_rounding(sun_m: DVec3, target_m: DVec3) -> Option<SunCameraRounding> {
    let boresight = Direction::new(target_m - sun_m)?;
    let (u, (h, _)) = (boresight.vec(), boresight.frame());
    let mut worst = SunCameraRounding {
        lateral_f64_m: 0.0,
        lateral_f32_m: 0.0,
        depth_f64_m: 0.0,
        depth_f32_m: 0.0,
        depth_m: (target_m - sun_m).length(),
    };
    for i in 0..4000 {
        // A sequence that fills the cube evenly: multiples of powers of the plastic number's kin.
        let i = f64::from(i);
        let share = DVec3::new(i * 0.819_172_513_4, i * 0.671_043_606_7, i * 0.549_700_477_9).fract();
        let p_m = target_m + 1000.0 * (2.0 * share - 1.0);
        let (true_lateral_m, true_depth_m) = (dot_of_difference(p_m, sun_m, h), dot_of_difference(p_m, sun_m, u));
        let depth_m = (p_m - sun_m).dot(u);
        let x = (p_m - sun_m).dot(h) / depth_m;
        let p_32 = p_m.as_vec3() - sun_m.as_vec3();
        let depth_32 = p_32.dot(u.as_vec3());
        let x_32 = p_32.dot(h.as_vec3()) / depth_32;
        let lateral_m = |x: f64| (x * true_depth_m - true_lateral_m).abs();
        worst.lateral_f64_m = worst.lateral_f64_m.max(lateral_m(x));
        worst.lateral_f32_m = worst.lateral_f32_m.max(lateral_m(f64::from(x_32)));
        worst.depth_f64_m = worst.depth_f64_m.max((depth_m - true_depth_m).abs());
        worst.depth_f32_m = worst.depth_f32_m.max((f64::from(depth_32) - true_depth_m).abs());
    }
    Some(worst)
}

/// (p - o).axis, rounded once: error-free sums and products (Ogita, Rump & Oishi 2005).
fn dot_of_difference(p: DVec3, o: DVec3, axis: DVec3) -> f64 {
    fn two_sum(a: f64, b: f64) -> (f64, f64) {
        let sum = a + b;
        let b_part = sum - a;
        (sum, (a - (sum - b_part)) + (b - b_part))
    }
    let (mut sum, mut rest) = (0.0, 0.0);
    for ((p, o), a) in p.to_array().into_iter().zip(o.to_array()).zip(axis.to_array()) {
        let (difference, difference_rest) = two_sum(p, -o);
        let product = difference * a;
        let product_rest = difference.mul_add(a, -product);
        let (next, sum_rest) = two_sum(sum, product);
        sum = next;
        rest += sum_rest + product_rest + difference_rest * a;
    }
    sum + rest
}
