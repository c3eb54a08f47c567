//! What this program computes for an oracle, group by group.

use glam::{DMat3, DVec3};
use serde_json::{Value, json};

use super::{Oracle, closed_forms, scene_cases};
use crate::geometry::{Direction, Pose, angle_rad};
use crate::physics::reflectance::{Brdf, PhotometricAngles};
use crate::physics::{blackbody, bounds, heat, mars, sun};
use crate::spectral::{Band, solar_e490};
use crate::units::AU_M;

impl Oracle<'_> {
    /// An input, or what the name says of it.
    fn input(&self, key: &str) -> Option<f64> {
        let in_name = || {
            let (_, rest) = self.name.split_once(&format!("{key}="))?;
            rest.split([',', ')']).next()?.parse().ok()
        };
        self.inputs.get(key).and_then(Value::as_f64).or_else(in_name)
    }

    fn vector(&self, key: &str) -> Option<DVec3> {
        vector(self.inputs.get(key)?)
    }

    /// Distance from the Sun: an input, or as in "(rho=0.07,1.5AU)".
    fn distance_m(&self) -> Option<f64> {
        let in_name = || self.name.split(['(', ',', ')']).find_map(|part| part.strip_suffix("AU")?.parse::<f64>().ok());
        Some(self.input("d_au").or_else(in_name)? * AU_M)
    }

    /// What it asks for; `None` for what this version does not compute.
    pub(super) fn value(&self) -> Option<Value> {
        let kind = self.name.split(['(', '=']).next().unwrap_or("");
        match self.group {
            "blackbody" => self.blackbody(kind),
            "sun" => self.sun(kind),
            "marsshine" => self.marsshine(kind),
            "formfactor" => self.form_factor(kind),
            "coverage" => self.coverage(),
            "camera" => self.camera(kind),
            "scene" => self.scene(kind),
            "numerics" => self.numerics(kind),
            "disc" => self.disc(kind),
            "geometry" => self.geometry(kind),
            "thermal" => self.thermal(kind),
            "ils" => self.response(kind),
            _ => None,
        }
    }

    fn blackbody(&self, kind: &str) -> Option<Value> {
        let input = |key| self.input(key);
        Some(json!(match kind {
            "planck_L" => blackbody::radiance_w_m2_sr_um(input("lambda_um")?, input("T_K")?),
            "band_L" => blackbody::band_radiance_w_m2_sr(input("l1_um")?, input("l2_um")?, input("T_K")?),
            "brightness_T" => closed_forms::brightness_temperature_k(input("lambda_um")?, input("L")?),
            _ => return None,
        }))
    }

    fn sun(&self, kind: &str) -> Option<Value> {
        Some(json!(match kind {
            "TSI" => sun::irradiance_at(self.input("S0")?, self.distance_m()?),
            "angular_radius" => sun::angular_radius_rad(self.distance_m()?),
            "solid_angle" => sun::solid_angle_sr(self.distance_m()?),
            "light_time" => sun::light_time_s(self.distance_m()?),
            "E490_integral" if self.is_e490() => solar_e490().integral(self.input("l1")?, self.input("l2")?)?,
            "E490" | "E490_at" | "E490_value" | "E490_irradiance" if self.is_e490() => {
                let irradiance_1au = solar_e490().at(self.input("lambda_um")?)?;
                self.distance_m().map_or(irradiance_1au, |d_m| sun::irradiance_at(irradiance_1au, d_m))
            }
            _ => return None,
        }))
    }

    /// Whether the table of sunlight that is asked about, if it is named, is the one built in.
    fn is_e490(&self) -> bool {
        self.inputs.get("file").and_then(Value::as_str).is_none_or(|file| file.to_lowercase().contains("e490_00a"))
    }

    fn marsshine(&self, kind: &str) -> Option<Value> {
        let (radius, distance) = (self.input("R")?, self.input("D")?);
        let q2 = (radius / distance).powi(2);
        let rho = || if kind.ends_with("_per_rho") { Some(1.0) } else { self.input("rho") };
        let phase_deg = self.input("phase_deg");
        // Mars towards +Z, the Sun and azimuth 0 on the side of +X.
        let near = |phase_deg: f64| {
            let (sin_phase, cos_phase) = phase_deg.to_radians().sin_cos();
            let (sin_tilt, cos_tilt) = self.input("tilt_deg").unwrap_or(0.0).to_radians().sin_cos();
            let (sin_az, cos_az) = self.input("azimuth_deg").unwrap_or(0.0).to_radians().sin_cos();
            let normal = DVec3::new(sin_tilt * cos_az, sin_tilt * sin_az, cos_tilt);
            mars::irradiance(distance * DVec3::Z, radius, normal, DVec3::new(sin_phase, 0.0, -cos_phase))
        };
        Some(json!(match kind {
            "uniform_full_disc_upper_bound" => bounds::mars_light(rho()?, radius / distance, 1.0),
            "isotropic_mean_far_field" => 0.25 * rho()? * q2,
            "mean_over_coplanar_orbit_far_field" => 2.0 / 3.0 * rho()? * q2 * (2.0 / std::f64::consts::PI).powi(2),
            _ if kind.starts_with("thesis") => {
                let cos_tilt = self.input("tilt_deg").unwrap_or(0.0).to_radians().cos();
                mars::thesis_irradiance(1.0, rho()?, radius / distance, cos_tilt)
            }
            "lambert_full_phase_far_field" | "lambert_far_field" | "lambert_far_field_per_rho" => {
                2.0 / 3.0 * rho()? * q2 * closed_forms::lambert_sphere_phase(phase_deg.unwrap_or(0.0))
            }
            "mean_over_coplanar_orbit_near_field" | "mean_over_coplanar_orbit_near_field_per_rho" => {
                rho()? * closed_forms::mean_over_orbit(near)
            }
            "lambert_full_phase_near_field_per_rho"
            | "lambert_near_field_facing_per_rho"
            | "lambert_near_field_tilted_per_rho" => near(phase_deg?),
            _ => return None,
        }))
    }

    fn form_factor(&self, kind: &str) -> Option<Value> {
        let input = |key| self.input(key);
        Some(json!(match kind {
            "plane_to_sphere_F" => {
                mars::uniform_sphere_form_factor(input("R")? / input("D")?, input("tilt_deg")?.to_radians().cos())
            }
            "mars_angular_diameter_from_phobos_deg" => 2.0 * (input("R")? / input("D")?).asin().to_degrees(),
            "parallel_rectangles" => closed_forms::parallel_rectangles(input("a")?, input("b")?, input("distance")?),
            "perpendicular_rectangles" => {
                closed_forms::perpendicular_rectangles(input("common")?, input("w1")?, input("h2")?)
            }
            "element_to_coaxial_disc" => {
                let (radius, height) = (input("R")?, input("h")?);
                radius * radius / (radius * radius + height * height)
            }
            "coaxial_discs" | "coaxial_parallel_discs" | "parallel_coaxial_discs" => {
                let of = |keys: [&str; 2]| keys.iter().find_map(|key| self.input(key));
                let height = of(["h", "distance"])?;
                closed_forms::coaxial_discs(of(["r1", "R1"])?, of(["r2", "R2"])?, height)
            }
            "strips_at_right_angles" | "perpendicular_strips" => {
                let of = |key| self.input(key).unwrap_or(1.0);
                closed_forms::perpendicular_strips(of("w1"), of("h2"))
            }
            "cube_closure" => {
                closed_forms::parallel_rectangles(1.0, 1.0, 1.0)
                    + 4.0 * closed_forms::perpendicular_rectangles(1.0, 1.0, 1.0)
            }
            "element_to_triangle_clipped" => {
                let triangle = self.inputs.get("triangle")?.as_array()?;
                let polygon = triangle.iter().map(vector).collect::<Option<Vec<_>>>()?;
                closed_forms::element_to_polygon(self.vector("normal")?, &polygon)
            }
            _ => return None,
        }))
    }

    fn coverage(&self) -> Option<Value> {
        let point = |v: &Value| Some([v.get(0)?.as_f64()?, v.get(1)?.as_f64()?]);
        let corners = self.inputs.get("vertices")?.as_array()?;
        let polygon = corners.iter().map(point).collect::<Option<Vec<[f64; 2]>>>()?;
        let grid = self.inputs.get("grid")?;
        let (columns, rows) = (grid.get(0)?.as_u64()?, grid.get(1)?.as_u64()?);
        // As many pixels as are expected, so that no file can ask for more memory than it is long.
        let expected = self.expected.as_array()?;
        let same = expected.len() as u64 == rows
            && expected.iter().all(|row| row.as_array().is_some_and(|row| row.len() as u64 == columns));
        same.then(|| json!(scene_cases::coverage(&polygon, columns as u32, rows as u32)))
    }

    fn camera(&self, kind: &str) -> Option<Value> {
        Some(match kind {
            "eq17_18_19" => {
                let axes = [self.vector("h")?, self.vector("v")?, self.vector("u")?];
                let world_from_sensor = Pose {
                    rotation: DMat3::from_cols_array_2d(&axes.map(|a| a.to_array())),
                    translation_m: self.vector("O")?,
                };
                let p = world_from_sensor.inverse().point(self.vector("P")?);
                json!({"X": p.x / p.z, "Y": p.y / p.z, "Z": p.z})
            }
            _ if kind.starts_with("eq22") => {
                let [h, v, u, o] = [self.vector("h")?, self.vector("v")?, self.vector("u")?, self.vector("O")?];
                let z = self.input("Z")?;
                let p = o + z * (self.input("X")? * h + self.input("Y")? * v + u);
                match self.expected {
                    Value::Array(_) => json!(p.to_array()),
                    _ => json!({"P": p.to_array(), "point": p.to_array(), "x": p.x, "y": p.y, "z": p.z}),
                }
            }
            "perspective_correct_midpoint" => {
                let (z0, z1, s) = (self.input("Z0")?, self.input("Z1")?, self.input("s_image")?);
                json!({"t_3d": s * z0 / (s * z0 + (1.0 - s) * z1)})
            }
            "near_plane_clip" => {
                let (a, b, near) = (self.vector("A")?, self.vector("B")?, self.input("near")?);
                json!({"point": (a + (b - a) * ((near - a.z) / (b.z - a.z))).to_array()})
            }
            _ => return None,
        })
    }

    fn scene(&self, kind: &str) -> Option<Value> {
        Some(match kind {
            "table_I_geometry" => {
                let (observer, sun_m, target) = (self.vector("MMX")?, self.vector("Sun")?, self.vector("target")?);
                let radii = self.vector("ellipsoid_m")?;
                let to_sun = sun_m - target;
                let to_observer = observer - target;
                let ellipsoid_normal = target / (radii * radii);
                let degrees = |a, b| angle_rad(a, b).to_degrees();
                json!({
                    "range_MMX_target_m": to_observer.length(),
                    "range_MMX_centre_m": observer.length(),
                    "target_radius_m": target.length(),
                    "sun_distance_m": sun_m.length(),
                    "sun_distance_AU": sun_m.length() / AU_M,
                    "phase_deg": degrees(to_sun, to_observer),
                    "incidence_radial_deg": degrees(to_sun, target),
                    "emission_radial_deg": degrees(to_observer, target),
                    "incidence_ellipsoid_deg": degrees(to_sun, ellipsoid_normal),
                    "emission_ellipsoid_deg": degrees(to_observer, ellipsoid_normal),
                    "target_lon_deg": target.y.atan2(target.x).to_degrees(),
                    "light_time_s": sun::light_time_s(sun_m.length()),
                })
            }
            "thermal_over_reflected" => {
                json!(
                    self.thermal_over_reflected(
                        self.input("lambda_um")?,
                        self.input("T_K").or_else(|| self.input("T"))?
                    )?
                )
            }
            "wavelength_where_thermal" => {
                let (t_k, ratio) = (self.input("T_K").or_else(|| self.input("T"))?, self.input("ratio")?);
                // The ratio rises with wavelength.
                let (mut low_um, mut high_um) = (1.0, 10.0);
                for _ in 0..60 {
                    let middle_um = 0.5 * (low_um + high_um);
                    if self.thermal_over_reflected(middle_um, t_k)? < ratio {
                        low_um = middle_um;
                    } else {
                        high_um = middle_um;
                    }
                }
                json!(low_um)
            }
            "eclipse_by_mars_central_duration" => {
                // Where nothing else is said: at the mean distance of Mars.
                let sun_rad = sun::angular_radius_rad(self.distance_m().unwrap_or(1.523_679 * AU_M));
                let mars_rad = (self.input("R")? / self.input("D")?).asin();
                let s_per_rad = self.input("period_s")? / std::f64::consts::PI;
                json!({"total_s": (mars_rad - sun_rad) * s_per_rad, "partial_each_s": sun_rad * s_per_rad})
            }
            _ if kind.starts_with("flat_lambert_radiance") => {
                // E490 at the wavelength in its name, as E490_1um.
                let (_, irradiance_1au) = self.inputs.as_object()?.iter().find(|(key, _)| key.starts_with("E490"))?;
                let cos_incidence = self.input("i_deg")?.to_radians().cos();
                json!(lambert_radiance(self.input("rho")?, irradiance_1au.as_f64()?, self.distance_m()?, cos_incidence))
            }
            _ => return None,
        })
    }

    /// Thermal over reflected radiance of a facet under the Sun.
    fn thermal_over_reflected(&self, lambda_um: f64, t_k: f64) -> Option<f64> {
        let reflected = lambert_radiance(self.input("rho")?, solar_e490().at(lambda_um)?, self.distance_m()?, 1.0);
        Some(blackbody::radiance_w_m2_sr_um(lambda_um, t_k) / reflected)
    }

    fn numerics(&self, kind: &str) -> Option<Value> {
        // Table I of Domagala (2020).
        let sun_m = self.vector("Sun").unwrap_or(DVec3::new(3.992e10, 2.1812e11, 1.1501e10));
        let target_m = self.vector("target").unwrap_or(DVec3::new(-2743.5946, 11860.036, 0.51269));
        Some(match kind {
            "ulp" => {
                let x = self.input("x")?;
                let x_32 = x as f32;
                json!({"f32": f64::from(x_32.next_up() - x_32), "f64": x.next_up() - x})
            }
            "sun_position_divided_by" => {
                let scaled_m = sun_m / self.input("factor")?;
                let up = Direction::new(target_m)?.vec();
                let east_m = 1000.0 * Direction::new(DVec3::Z.cross(up))?.vec();
                json!({
                    "sun_dist_m": scaled_m.length(),
                    "direction_error_deg": angle_rad(sun_m - target_m, scaled_m - target_m).to_degrees(),
                    "divergence_2km_deg":
                        angle_rad(scaled_m - (target_m + east_m), scaled_m - (target_m - east_m)).to_degrees(),
                    "height_above_target_m": (scaled_m - target_m).dot(up),
                })
            }
            "sun_perspective_rounding" => {
                let lost = closed_forms::sun_camera_rounding(sun_m / self.input("factor")?, target_m)?;
                json!({
                    "lateral_err_f64_m": lost.lateral_f64_m,
                    "lateral_err_f32_m": lost.lateral_f32_m,
                    "depth_err_f64_m": lost.depth_f64_m,
                    "depth_err_f32_m": lost.depth_f32_m,
                    "metres_per_1e_minus_9": 1e-9 * lost.depth_m,
                })
            }
            _ => return None,
        })
    }

    fn disc(&self, kind: &str) -> Option<Value> {
        Some(json!(match kind {
            "lambert_sphere_phase" => closed_forms::lambert_sphere_phase(self.input("phase_deg")?),
            "lommel_seeliger_sphere_phase" => closed_forms::lommel_seeliger_sphere_phase(self.input("phase_deg")?),
            "lambert_phase_integral" => closed_forms::phase_integral(closed_forms::lambert_sphere_phase),
            "lommel_seeliger_phase_integral" => {
                closed_forms::phase_integral(closed_forms::lommel_seeliger_sphere_phase)
            }
            _ => return None,
        }))
    }

    fn geometry(&self, kind: &str) -> Option<Value> {
        Some(match kind {
            "ellipsoid_projected_area" => {
                json!(closed_forms::ellipsoid_projected_area(self.vector("radii_km")?, self.vector("view")?))
            }
            "ellipsoid_lit_visible_projected_area" => {
                let (radii, sun, view) = (self.vector("radii_km")?, self.vector("sun")?, self.vector("view")?);
                json!(closed_forms::ellipsoid_lit_projected_area(radii, sun, view))
            }
            "ellipsoid_disc_integrated" => {
                let (radii, sun, view) = (self.vector("radii_km")?, self.vector("sun")?, self.vector("view")?);
                let (lambert, lommel_seeliger) = closed_forms::ellipsoid_disc_integrals(radii, sun, view);
                json!({"int_mu0_mu_dA": lambert, "int_mu0_mu_over_sum_dA": lommel_seeliger})
            }
            "pinhole_image_of_sphere" => {
                let (a_rad, b_rad) =
                    (self.input("angular_radius_deg")?.to_radians(), self.input("offaxis_deg")?.to_radians());
                let (centre, along, across) =
                    closed_forms::pinhole_image_of_sphere(a_rad, b_rad, self.input("f").unwrap_or(1.0));
                let area = std::f64::consts::PI * along * across;
                json!({"centre": centre, "semi_radial": along, "semi_tangential": across, "area": area})
            }
            _ => return None,
        })
    }

    fn response(&self, kind: &str) -> Option<Value> {
        let (um, width_um, t_k) = (self.input("l0_um")?, self.input("dl_um")?, self.input("T_K")?);
        let in_band =
            Band { centre_um: um, fwhm_um: Some(width_um) }.in_band_w_m2_sr(blackbody::radiance_w_m2_sr_um(um, t_k))?;
        let exact = blackbody::band_radiance_w_m2_sr(um - 0.5 * width_um, um + 0.5 * width_um, t_k);
        (kind == "eq16_midpoint_error").then(|| json!(in_band / exact - 1.0))
    }

    fn thermal(&self, kind: &str) -> Option<Value> {
        Some(json!(match kind {
            "radiative_equilibrium_T" => {
                let normal = sun::irradiance_at(self.input("S0")?, self.distance_m()?);
                let absorbed = (1.0 - self.input("A")?) * sun::irradiance_on_facet(normal, self.input("cos_i")?);
                heat::equilibrium_temperature_k(absorbed, self.input("eps")?)
            }
            "thesis_eq9_T" => heat::thesis_temperature_k(self.input("cos_i")?),
            _ => return None,
        }))
    }
}

/// Radiance of a Lambert facet under the Sun alone, in the unit of the irradiance per sr.
fn lambert_radiance(reflectance: f64, irradiance_1au: f64, distance_m: f64, cos_incidence: f64) -> f64 {
    let angles = PhotometricAngles { cos_incidence, cos_emission: 1.0, phase_rad: cos_incidence.acos() };
    Brdf::Lambert { reflectance }.eval(&angles)
        * sun::irradiance_on_facet(sun::irradiance_at(irradiance_1au, distance_m), cos_incidence)
}

fn vector(value: &Value) -> Option<DVec3> {
    let [x, y, z] = value.as_array()?.as_slice() else { return None };
    Some(DVec3::new(x.as_f64()?, y.as_f64()?, z.as_f64()?))
}
