//! What this program computes for an oracle, group by group: where it can, by the functions that `simulate` goes through.

use glam::{DMat3, DVec3};
use serde_json::{Value, json};

use super::closed_forms::{self, Bowl};
use super::patch::Patch;
use super::{Answer, By, Oracle, scene_cases};
use crate::geometry::{Direction, Pose, angle_rad, whole};
use crate::physics::mars_light::MARS_LIGHT_ERROR;
use crate::physics::reflectance::albedo::Measure;
use crate::physics::{blackbody, bounds, conduction, form_factor, heat, mars, mtf, signal, sun, sun_disc};
use crate::scene::Thermal;
use crate::spectral::{ALL_UM, Band, sinc_squared, solar_e490};
use crate::units::{AU_M, STEFAN_BOLTZMANN_W_M2_K4};

/// What `simulate` computes in the same way.
pub(super) fn simulate(value: impl Into<Value>) -> Vec<Answer> {
    vec![Answer { by: By::Simulate, value: value.into(), own_tolerance: None }]
}

/// What only says that the expected number is right.
pub(super) fn reference(value: impl Into<Value>) -> Vec<Answer> {
    vec![Answer { by: By::Reference, value: value.into(), own_tolerance: None }]
}

impl Oracle<'_> {
    /// An input, or what the name says of it.
    pub(super) fn input(&self, key: &str) -> Option<f64> {
        let in_name = || {
            let (_, rest) = self.name.split_once(&format!("{key}="))?;
            rest.split([',', ')']).next()?.trim_end_matches("deg").parse().ok()
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

    /// This version's answer; nothing if it does not compute that.
    pub(super) fn answers(&self) -> Vec<Answer> {
        let kind = self.name.split(['(', '=']).next().unwrap_or("").trim();
        let answers = match self.group {
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
            "brdf" => self.brdf(kind),
            "brdf_property" => self.brdf_property(kind),
            "hapke_parts" => self.hapke_parts(kind),
            "albedo" => self.albedo(kind),
            "furnace" => self.furnace(kind),
            "crater" => self.crater(kind),
            "penumbra" => self.penumbra(kind),
            "pushbroom" => self.pushbroom(kind),
            "mtf" => self.mtf(kind),
            "psf" => self.psf(),
            "snr" => self.snr(),
            "time" => self.time(kind),
            "iau" => self.iau(),
            "qso" => self.qso(kind),
            "spk" => self.spk(),
            "spice" => self.spice(kind),
            "ccsds" => self.ephemeris(),
            "shape" => self.shape(kind),
            _ => None,
        };
        answers.unwrap_or_default()
    }

    fn blackbody(&self, kind: &str) -> Option<Vec<Answer>> {
        let input = |key| self.input(key);
        Some(match kind {
            "planck_L" => simulate(blackbody::radiance_w_m2_sr_um(input("lambda_um")?, input("T_K")?)),
            "band_L" => reference(blackbody::band_radiance_w_m2_sr(input("l1_um")?, input("l2_um")?, input("T_K")?)),
            "brightness_T" => reference(closed_forms::brightness_temperature_k(input("lambda_um")?, input("L")?)),
            // The exitance over all wavelengths: the constant that temperatures are found with.
            _ if kind.to_lowercase().contains("stefan_boltzmann") || kind.starts_with("sigma") => {
                simulate(match input("T_K").or_else(|| input("T")) {
                    Some(t_k) => heat::emitted_w_m2(t_k, input("eps").unwrap_or(1.0)),
                    None => STEFAN_BOLTZMANN_W_M2_K4,
                })
            }
            _ => return None,
        })
    }

    fn sun(&self, kind: &str) -> Option<Vec<Answer>> {
        Some(match kind {
            "TSI" => simulate(sun::irradiance_at(self.input("S0")?, self.distance_m()?)),
            "angular_radius" => simulate(sun::angular_radius_rad(self.distance_m()?)),
            "solid_angle" => reference(sun::solid_angle_sr(self.distance_m()?)),
            "light_time" => reference(sun::light_time_s(self.distance_m()?)),
            "E490_integral" if self.is_e490() => {
                reference(solar_e490().integral(self.input("l1")?, self.input("l2")?)?)
            }
            "E490" | "E490_at" | "E490_value" | "E490_irradiance" if self.is_e490() => {
                let irradiance_1au = solar_e490().at(self.input("lambda_um")?)?;
                simulate(self.distance_m().map_or(irradiance_1au, |d_m| sun::irradiance_at(irradiance_1au, d_m)))
            }
            _ => return None,
        })
    }

    /// Whether the table of sunlight that is asked about, if it is named, is the one built in.
    fn is_e490(&self) -> bool {
        self.inputs.get("file").and_then(Value::as_str).is_none_or(|file| file.to_lowercase().contains("e490_00a"))
    }

    fn marsshine(&self, kind: &str) -> Option<Vec<Answer>> {
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
            (normal, DVec3::new(sin_phase, 0.0, -cos_phase))
        };
        let by_integral = |phase_deg: f64| {
            let (normal, sun) = near(phase_deg);
            mars::irradiance(distance * DVec3::Z, radius, normal, sun)
        };
        Some(match kind {
            "uniform_full_disc_upper_bound" => simulate(bounds::mars_light(rho()?, radius / distance, 1.0)),
            "isotropic_mean_far_field" => reference(0.25 * rho()? * q2),
            "mean_over_coplanar_orbit_far_field" => {
                reference(2.0 / 3.0 * rho()? * q2 * (2.0 / std::f64::consts::PI).powi(2))
            }
            _ if kind.starts_with("thesis") => {
                let cos_tilt = self.input("tilt_deg").unwrap_or(0.0).to_radians().cos();
                simulate(mars::thesis_irradiance(1.0, rho()?, radius / distance, cos_tilt))
            }
            "lambert_full_phase_far_field" | "lambert_far_field" | "lambert_far_field_per_rho" => {
                reference(2.0 / 3.0 * rho()? * q2 * closed_forms::lambert_sphere_phase(phase_deg.unwrap_or(0.0)))
            }
            "mean_over_coplanar_orbit_near_field" | "mean_over_coplanar_orbit_near_field_per_rho" => {
                reference(rho()? * closed_forms::mean_over_orbit(by_integral))
            }
            "lambert_full_phase_near_field_per_rho"
            | "lambert_near_field_facing_per_rho"
            | "lambert_near_field_tilted_per_rho" => {
                let mut answers = reference(by_integral(phase_deg?));
                let (normal, sun) = near(phase_deg?);
                // A site of 2 km, Mars at its true size whatever the unit of R and D.
                let m = crate::units::MARS_RADIUS_M / radius;
                let mars_m = Some((m * distance * DVec3::Z, m * radius));
                let table = Patch { normal, sun, mars_m, observer_m: 1000.0 * normal, ..Patch::default() }.table()?;
                let facing_full = mars::irradiance(distance * DVec3::Z, radius, DVec3::Z, DVec3::NEG_Z);
                answers.push(Answer {
                    by: By::Simulate,
                    value: json!(table.of("mars")?.irradiance.first()?),
                    own_tolerance: Some(MARS_LIGHT_ERROR * facing_full),
                });
                answers
            }
            _ => return None,
        })
    }

    fn form_factor(&self, kind: &str) -> Option<Vec<Answer>> {
        let input = |key| self.input(key);
        let q = || Some(input("R")? / input("D")?);
        Some(reference(match kind {
            "plane_to_sphere_F" => {
                let cos_tilt = input("tilt_deg")?.to_radians().cos();
                return Some(simulate(mars::uniform_sphere_form_factor(q()?, cos_tilt)));
            }
            "mars_angular_diameter_from_phobos_deg" => 2.0 * q()?.asin().to_degrees(),
            // 2 pi (1 - cos a), a its angular radius.
            _ if kind.contains("solid_angle") => 4.0 * std::f64::consts::PI * (0.5 * q()?.asin()).sin().powi(2),
            "parallel_rectangles" => form_factor::parallel_rectangles(input("a")?, input("b")?, input("distance")?),
            "perpendicular_rectangles" => {
                form_factor::perpendicular_rectangles(input("common")?, input("w1")?, input("h2")?)
            }
            "element_to_coaxial_disc" => form_factor::element_to_coaxial_disc(input("R")?, input("h")?),
            "coaxial_discs" | "coaxial_parallel_discs" | "parallel_coaxial_discs" => {
                let of = |keys: [&str; 2]| keys.iter().find_map(|key| self.input(key));
                let height = of(["h", "distance"])?;
                form_factor::coaxial_discs(of(["r1", "R1"])?, of(["r2", "R2"])?, height)
            }
            "strips_at_right_angles" | "perpendicular_strips" => {
                let of = |key| self.input(key).unwrap_or(1.0);
                form_factor::perpendicular_strips(of("w1"), of("h2"))
            }
            "cube_closure" => {
                form_factor::parallel_rectangles(1.0, 1.0, 1.0)
                    + 4.0 * form_factor::perpendicular_rectangles(1.0, 1.0, 1.0)
            }
            "element_to_triangle_clipped" => {
                let triangle = self.inputs.get("triangle")?.as_array()?;
                let polygon = triangle.iter().map(vector).collect::<Option<Vec<_>>>()?;
                form_factor::element_to_polygon(self.vector("normal")?, &polygon)
            }
            _ => return None,
        }))
    }

    fn coverage(&self) -> Option<Vec<Answer>> {
        let point = |v: &Value| Some([v.get(0)?.as_f64()?, v.get(1)?.as_f64()?]);
        let corners = self.inputs.get("vertices")?.as_array()?;
        let polygon = corners.iter().map(point).collect::<Option<Vec<[f64; 2]>>>()?;
        let grid = self.inputs.get("grid")?;
        let (columns, rows) = (grid.get(0)?.as_u64()?, grid.get(1)?.as_u64()?);
        // As many pixels as are expected, so that no file can ask for more memory than it is long.
        let expected = self.expected.as_array()?;
        let same = expected.len() as u64 == rows
            && expected.iter().all(|row| row.as_array().is_some_and(|row| row.len() as u64 == columns));
        let (columns, rows) = (u32::try_from(columns).ok()?, u32::try_from(rows).ok()?);
        same.then(|| simulate(json!(scene_cases::coverage(&polygon, columns, rows))))
    }

    fn camera(&self, kind: &str) -> Option<Vec<Answer>> {
        Some(match kind {
            "eq17_18_19" => {
                let axes = [self.vector("h")?, self.vector("v")?, self.vector("u")?];
                let world_from_sensor = Pose {
                    rotation: DMat3::from_cols_array_2d(&axes.map(|a| a.to_array())),
                    translation_m: self.vector("O")?,
                };
                let p = world_from_sensor.inverse().point(self.vector("P")?);
                reference(json!({"X": p.x / p.z, "Y": p.y / p.z, "Z": p.z}))
            }
            _ if kind.starts_with("eq22") => {
                let [h, v, u, o] = [self.vector("h")?, self.vector("v")?, self.vector("u")?, self.vector("O")?];
                let z = self.input("Z")?;
                let p = o + z * (self.input("X")? * h + self.input("Y")? * v + u);
                reference(match self.expected {
                    Value::Array(_) => json!(p.to_array()),
                    _ => json!({"P": p.to_array(), "point": p.to_array(), "x": p.x, "y": p.y, "z": p.z}),
                })
            }
            "perspective_correct_midpoint" => {
                let (z0, z1, s) = (self.input("Z0")?, self.input("Z1")?, self.input("s_image")?);
                reference(json!({"t_3d": s * z0 / (s * z0 + (1.0 - s) * z1)}))
            }
            "near_plane_clip" => {
                let (a, b, near) = (self.vector("A")?, self.vector("B")?, self.input("near")?);
                reference(json!({"point": (a + (b - a) * ((near - a.z) / (b.z - a.z))).to_array()}))
            }
            _ => return None,
        })
    }

    fn scene(&self, kind: &str) -> Option<Vec<Answer>> {
        Some(match kind {
            "table_I_geometry" => {
                let (observer, sun_m, target) = (self.vector("MMX")?, self.vector("Sun")?, self.vector("target")?);
                let radii = self.vector("ellipsoid_m")?;
                let mut answers = reference(json!({
                    "range_MMX_centre_m": observer.length(),
                    "target_radius_m": target.length(),
                    "sun_distance_m": sun_m.length(),
                    "sun_distance_AU": sun_m.length() / AU_M,
                    "light_time_s": sun::light_time_s(sun_m.length()),
                }));
                // Two patches at the target: one that faces away from the centre, one level on the ellipsoid.
                let level = Patch {
                    origin_m: target,
                    normal: target / (radii * radii),
                    sun: sun_m - target,
                    sun_distance_m: (sun_m - target).length(),
                    observer_m: observer - target,
                    ..Patch::default()
                };
                let radial = Patch { normal: target, ..level.clone() }.backplanes()?;
                let level = level.backplanes()?;
                let at = |planes: &crate::product::Backplanes, name| Some(planes.plane(name)?.values[0]);
                answers.extend(simulate(json!({
                    "range_MMX_target_m": at(&radial, "RANGE")?,
                    "phase_deg": at(&radial, "PHASE")?,
                    "incidence_radial_deg": at(&radial, "INCIDENCE")?,
                    "emission_radial_deg": at(&radial, "EMISSION")?,
                    "incidence_ellipsoid_deg": at(&level, "LOCALINCIDENCE")?,
                    "emission_ellipsoid_deg": at(&level, "LOCALEMISSION")?,
                    "target_lon_deg": at(&radial, "LONGITUDE")?,
                })));
                answers
            }
            "thermal_over_reflected" => {
                let t_k = self.input("T_K").or_else(|| self.input("T"))?;
                simulate(self.thermal_over_reflected(self.input("lambda_um")?, t_k)?)
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
                simulate(low_um)
            }
            "eclipse_by_mars_central_duration" => {
                // Where nothing else is said: at the mean distance of Mars.
                let sun_rad = sun::angular_radius_rad(self.distance_m().unwrap_or(1.523_679 * AU_M));
                let mars_rad = (self.input("R")? / self.input("D")?).asin();
                let s_per_rad = self.input("period_s")? / std::f64::consts::PI;
                reference(json!({"total_s": (mars_rad - sun_rad) * s_per_rad, "partial_each_s": sun_rad * s_per_rad}))
            }
            _ if kind.starts_with("flat_lambert_radiance") => {
                // E490 at the wavelength in its name, as E490_1um.
                let (_, irradiance_1au) = self.inputs.as_object()?.iter().find(|(key, _)| key.starts_with("E490"))?;
                simulate(
                    Patch {
                        sun: from_zenith(self.input("i_deg")?, 0.0),
                        sun_distance_m: self.distance_m()?,
                        irradiance_1au: irradiance_1au.as_f64()?,
                        reflectance: self.input("rho")?,
                        ..Patch::default()
                    }
                    .radiance()?,
                )
            }
            _ => return None,
        })
    }

    /// Thermal over reflected radiance of a facet under the Sun.
    fn thermal_over_reflected(&self, lambda_um: f64, t_k: f64) -> Option<f64> {
        let patch = Patch {
            sun_distance_m: self.distance_m()?,
            irradiance_1au: solar_e490().at(lambda_um)?,
            reflectance: self.input("rho")?,
            wavelength_um: lambda_um,
            ..Patch::default()
        };
        Some(patch.radiance_at(t_k)? / patch.radiance()?)
    }

    /// What single precision and a Sun among the metres would lose: nothing that `simulate` does.
    fn numerics(&self, kind: &str) -> Option<Vec<Answer>> {
        // Table I of Domagala (2020).
        let sun_m = self.vector("Sun").unwrap_or(DVec3::new(3.992e10, 2.1812e11, 1.1501e10));
        let target_m = self.vector("target").unwrap_or(DVec3::new(-2743.5946, 11860.036, 0.51269));
        Some(reference(match kind {
            "ulp" => {
                let x = self.input("x")?;
                #[expect(clippy::cast_possible_truncation, reason = "single precision is what is asked for")]
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
        }))
    }

    fn disc(&self, kind: &str) -> Option<Vec<Answer>> {
        Some(reference(match kind {
            "lambert_sphere_phase" => closed_forms::lambert_sphere_phase(self.input("phase_deg")?),
            "lommel_seeliger_sphere_phase" => closed_forms::lommel_seeliger_sphere_phase(self.input("phase_deg")?),
            "lambert_phase_integral" => closed_forms::phase_integral(closed_forms::lambert_sphere_phase),
            "lommel_seeliger_phase_integral" => {
                closed_forms::phase_integral(closed_forms::lommel_seeliger_sphere_phase)
            }
            _ if kind.starts_with("geometric_albedo_sphere_") => Measure::Geometric.of(&self.model(kind)?),
            _ => return None,
        }))
    }

    fn geometry(&self, kind: &str) -> Option<Vec<Answer>> {
        Some(reference(match kind {
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
        }))
    }

    /// What a band makes of a spectrum.
    fn response(&self, kind: &str) -> Option<Vec<Answer>> {
        if kind.starts_with("gauss") && kind.contains("cos") {
            let (width_um, per_um) =
                (self.input("fwhm_um")?, self.input("cycles_per_um").or_else(|| self.input("nu"))?);
            // A wavelength that is a whole number of cycles, so that the contrast is the mean itself.
            let band = Band::new((10.0 * per_um).round() / per_um, Some(width_um));
            let wave = |um: f64| (2.0 * std::f64::consts::PI * per_um * um).cos();
            return Some(simulate(
                band.quadrature(&[], ALL_UM).iter().map(|(um, weight)| weight * wave(*um)).sum::<f64>(),
            ));
        }
        if kind == "sinc2_half_width" {
            return Some(simulate(sinc_squared::HALF_WIDTH));
        }
        if kind == "sinc2_on_cosine" {
            let cycles = self.input("cycles_per_um")? * 0.5 * self.input("fwhm_um")? / sinc_squared::HALF_WIDTH;
            return Some(reference(sinc_squared::contrast(cycles)));
        }
        if kind.starts_with("sinc2_energy_within") {
            return Some(simulate(sinc_squared::energy_within(u32::try_from(whole(self.input("N")?)).ok()?)));
        }
        if kind != "eq16_midpoint_error" {
            return None;
        }
        let (um, width_um, t_k) = (self.input("l0_um")?, self.input("dl_um")?, self.input("T_K")?);
        let in_band = Band::new(um, Some(width_um)).in_band_w_m2_sr(blackbody::radiance_w_m2_sr_um(um, t_k))?;
        let exact = blackbody::band_radiance_w_m2_sr(um - 0.5 * width_um, um + 0.5 * width_um, t_k);
        Some(reference(in_band / exact - 1.0))
    }

    /// By the functions that make the image chain's transfer.
    fn mtf(&self, kind: &str) -> Option<Vec<Answer>> {
        let f = || self.input("f");
        let edge = |key| self.input(key);
        Some(match kind {
            "linear_smear_nyquist" | "linear_smear" => simulate(mtf::mean(f()?, edge("smear_px")?)),
            "pixel" => simulate(mtf::mean(f()?, 1.0)),
            "diffraction_circular" => simulate(mtf::diffraction(edge("nu")?)),
            "jitter_gaussian" => simulate(mtf::gaussian(f()?, edge("sigma_px")?)),
            // A pixel, and what drifts through it: 0.6 pixels in its second (Domagala 2020).
            "macromega_total_nyquist" => simulate(mtf::mean(f()?, 1.0) * mtf::mean(f()?, 0.6)),
            "smeared_edge_pixel_value" => reference(mtf::smeared_edge(edge("edge_start")?, edge("edge_end")?)),
            _ => return None,
        })
    }

    fn psf(&self) -> Option<Vec<Answer>> {
        let (x_px, sigma_px) = (self.input("x_px")?, self.input("sigma_px")?);
        Some(reference(json!({
            "point": mtf::gaussian_edge(x_px, sigma_px),
            "pixel_integrated": mtf::gaussian_edge_mean(x_px, sigma_px),
        })))
    }

    fn snr(&self) -> Option<Vec<Answer>> {
        let input = |key| self.input(key);
        let etendue_m2_sr = signal::etendue_m2_sr(input("pixel_m")?, input("f_number")?);
        let (um, width_um, t_s) = (input("lambda_um")?, input("dlambda_um")?, input("t_s")?);
        let per_radiance = signal::electrons_per_radiance(um, width_um, etendue_m2_sr, input("throughput_x_qe")?, t_s);
        let signal_e = input("L_W_m2_sr_um")? * per_radiance;
        Some(simulate(json!({
            "signal_e": signal_e,
            "snr": signal::snr(signal_e, input("dark_e")?, input("read_noise_e")?, 0.0, 0.0),
        })))
    }

    fn thermal(&self, kind: &str) -> Option<Vec<Answer>> {
        let patch = |thermal| {
            let cos_incidence = self.input("cos_i")?;
            Some(Patch {
                sun: DVec3::new((1.0 - cos_incidence * cos_incidence).sqrt(), 0.0, cos_incidence),
                thermal,
                ..Patch::default()
            })
        };
        let lit_k = |patch: Patch| patch.table()?.temperature_lit_k.first().copied();
        Some(match kind {
            "radiative_equilibrium_T" => simulate(lit_k(Patch {
                sun_distance_m: self.distance_m()?,
                total_irradiance_1au_w_m2: self.input("S0")?,
                bond_albedo: self.input("A")?,
                emissivity_bolometric: self.input("eps")?,
                ..patch(Thermal::Equilibrium)?
            })?),
            "thesis_eq9_T" => simulate(lit_k(patch(Thermal::Thesis)?)?),
            "conduction_equator" => reference(self.day_at_the_equator()?),
            "linear_wave_amplitude" => {
                let (ratio, lag_rad) =
                    conduction::wave_at_depth(self.input("z_m")?, self.input("kappa")?, self.input("period_s")?);
                reference(json!({"amplitude_ratio": ratio, "phase_lag_rad": lag_rad}))
            }
            "constant_flux_surface_rise" => {
                let (inertia, flux_w_m2, time_s) = (self.input("Gamma")?, self.input("F")?, self.input("t_s")?);
                reference(conduction::rise_by_constant_flux_k(inertia, flux_w_m2, time_s))
            }
            "viking_thermal_inertia_SI" => {
                let cgs = self.inputs.get("cgs")?.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<_>>>()?;
                reference(cgs.into_iter().map(conduction::thermal_inertia_from_cgs).collect::<Vec<_>>())
            }
            _ => return None,
        })
    }

    /// A day at the equator of a body without slopes, the Sun over it.
    fn day_at_the_equator(&self) -> Option<Value> {
        const STEPS: usize = 1440;
        let noon_w_m2 = (1.0 - self.input("A")?) * sun::irradiance_at(self.input("S0")?, self.distance_m()?);
        let turn_rad = |k: usize| 2.0 * std::f64::consts::PI * k as f64 / STEPS as f64;
        let absorbed: Vec<f64> = (0..STEPS).map(|k| sun::irradiance_on_facet(noon_w_m2, turn_rad(k).cos())).collect();
        let ground = conduction::Ground {
            thermal_inertia: self.input("Gamma")?,
            emissivity_bolometric: self.input("eps")?,
            period_s: self.input("period_s")?,
        };
        let day = ground.periodic_temperature_k(&absorbed);
        // The highest point of the parabola through the warmest time and its neighbours, after noon.
        let (warmest, &at) = day.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let (before, after) = (day[(warmest + STEPS - 1) % STEPS], day[(warmest + 1) % STEPS]);
        let aside = 0.5 * (before - after) / (before - 2.0 * at + after);
        Some(json!({
            "Tmax": at - 0.25 * (before - after) * aside,
            "Tmin": day.iter().copied().fold(f64::INFINITY, f64::min),
            "Tnoon": day[0],
            "T_mean": day.iter().sum::<f64>() / STEPS as f64,
            "T_midnight": day[STEPS / 2],
            "T_sunrise": day[3 * STEPS / 4],
            "T_sunset": day[STEPS / 4],
            "lag_of_max_deg": (turn_rad(warmest) + aside * turn_rad(1)).to_degrees(),
        }))
    }

    fn penumbra(&self, kind: &str) -> Option<Vec<Answer>> {
        let sun_rad = || Some(sun::angular_radius_rad(self.distance_m()?));
        Some(match kind {
            "straight_edge_visible_fraction" | "straight_edge_visible_fraction_limb_darkened" => {
                reference(sun_disc::share_beyond_edge(self.input("x")?, self.input("u").unwrap_or(0.0)))
            }
            "two_disc_visible_fraction" => {
                let (sun, other, apart) = (self.input("r_sun")?, self.input("r_occ")?, self.input("d")?);
                reference(sun_disc::share_beside_disc(other / sun, apart / sun, self.input("u").unwrap_or(0.0)))
            }
            "edge_shadow_width" => {
                let sun_rad = sun_rad()?;
                let (height_m, i_rad) = (self.input("h_m")?, self.input("i_deg")?.to_radians());
                let edge_m = |i_rad: f64| height_m * i_rad.tan();
                let cos = i_rad.cos();
                let mut answers = reference(json!({
                    "umbra_edge_m": edge_m(i_rad - sun_rad),
                    "penumbra_edge_m": edge_m(i_rad + sun_rad),
                    "width_m": edge_m(i_rad + sun_rad) - edge_m(i_rad - sun_rad),
                    "hard_edge_m": edge_m(i_rad),
                }));
                // The width that the report's bound takes: the ray is h / cos i long.
                let width_m = bounds::penumbra_width_m(height_m / cos, sun_rad, cos);
                answers.extend(simulate(json!({"approx_2hs_over_cos2_m": width_m})));
                answers
            }
            // A uniform disc over a flat horizon, over what a point at its centre gives at normal incidence.
            "flat_horizon_sun_irradiance_ratio" => {
                let sun_rad = sun_rad()?;
                let elevation_rad = self.input("elevation_in_sun_radii")? * sun_rad;
                reference(sun_disc::irradiance_on_facet(elevation_rad.sin(), sun_rad.sin(), 0.0))
            }
            _ => return None,
        })
    }

    /// Light between surfaces that enclose it.
    fn furnace(&self, kind: &str) -> Option<Vec<Answer>> {
        let reflectance = self.input("rho")?;
        Some(reference(match kind {
            "closed_cavity_radiosity" => json!(self.input("M")? / (1.0 - reflectance)),
            "bounces_for_1e-6" => json!((1e-6_f64.ln() / reflectance.ln()).ceil()),
            "cube_one_face_emits" => json!(closed_forms::cube_radiosity(reflectance)),
            _ => return None,
        }))
    }

    /// A bowl under the Sun.
    fn crater(&self, kind: &str) -> Option<Vec<Answer>> {
        let depth = self.input("depth_over_diameter")?;
        let elevation_rad = || Some(self.input("sun_elevation_deg")?.to_radians());
        Some(reference(match kind {
            "ingersoll" => {
                let bowl = Bowl {
                    depth,
                    reflectance: self.input("A")?,
                    emissivity: self.input("eps")?,
                    irradiance: self.input("F")? * elevation_rad()?.sin(),
                };
                json!({
                    "f": bowl.form_factor(),
                    "E_scattered": bowl.scattered(),
                    "E_ir": bowl.heat(),
                    "T_shadow": heat::equilibrium_temperature_k(bowl.shadow_exitance(), 1.0),
                    "apparent_albedo": bowl.apparent_albedo(),
                    "mean_direct": bowl.mean_direct(),
                })
            }
            "bowl_radius_over_diameter" => json!(Bowl::radius(depth)),
            "bowl_shadow_edge_x" => json!(Bowl::shadow_end(depth, elevation_rad()?)),
            _ => return None,
        }))
    }

    fn pushbroom(&self, kind: &str) -> Option<Vec<Answer>> {
        if kind.contains("parallax_of_relief") {
            // What is higher lies further out in the view from one point; straight below a slit it stays where it is.
            let (height_m, along_m, up_m) = (1e3 * self.input("h_km")?, self.input("along_m")?, self.input("dz_m")?);
            let shift_m = |along_m: f64| along_m * (height_m / (height_m - up_m) - 1.0);
            return Some(reference(json!({ "frame_shift_m": shift_m(along_m), "pushbroom_shift_m": shift_m(0.0) })));
        }
        let ifov_rad = 1e-3 * self.input("ifov_mrad")?;
        let pixel_m = 1e3 * self.input("alt_km").or_else(|| self.input("h_km"))? * ifov_rad;
        Some(match kind {
            "line_period_for_square_pixels" => reference(pixel_m / self.input("v_ground_m_s")?),
            _ if kind.contains("pixel_size") || kind.contains("pixel_m") => reference(pixel_m),
            _ => return None,
        })
    }
}

/// A unit vector at an angle from the zenith, azimuth from +X towards +Y.
pub(super) fn from_zenith(angle_deg: f64, azimuth_deg: f64) -> DVec3 {
    let ((sin, cos), (sin_az, cos_az)) = (angle_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
    DVec3::new(sin * cos_az, sin * sin_az, cos)
}

pub(super) fn vector(value: &Value) -> Option<DVec3> {
    let [x, y, z] = value.as_array()?.as_slice() else { return None };
    Some(DVec3::new(x.as_f64()?, y.as_f64()?, z.as_f64()?))
}
