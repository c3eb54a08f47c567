//! The eleven input files of a simulation, as XML trees.
//!
//! 5.7.4 (v1083) holds every element and attribute of that version's schema whose condition is true, in the schema's order.
//! 5.11.0 (v1449) follows files that DART itself wrote; anything it was never seen to write is refused.

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::xml::Element;
use crate::geometry::FrameCamera;

use super::frame;
use super::simulation::{
    Group, Links, Object, OpticalKind, OpticalProperty, Pinhole, Simulation, SpectralInterval, ThermalFunction,
    Topography, Version,
};

/// Versions that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TargetVersion {
    /// 5.7.4, build v1083: its schema is known in full. Later versions upgrade it.
    #[default]
    V5_7_4,
    /// 5.11.0, build v1449: cameras have a line of sight, the ground plane can be switched off. Known by examples only.
    V5_11_0,
}

impl TargetVersion {
    /// As the root elements state it.
    pub fn version(self) -> Version {
        let (version, build) = match self {
            TargetVersion::V5_7_4 => ("5.7.4", "v1083"),
            TargetVersion::V5_11_0 => ("5.11.0", "v1449"),
        };
        Version { version: version.into(), build: build.into() }
    }

    /// The target whose root elements are these.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for other versions.
    pub fn of(version: &Version) -> Result<Self> {
        [TargetVersion::V5_7_4, TargetVersion::V5_11_0].into_iter().find(|t| t.version() == *version).ok_or_else(|| {
            Error::Unsupported {
                at: Location::item("version"),
                feature: format!(
                    "writing DART {} {} (5.7.4 v1083 and 5.11.0 v1449 are)",
                    version.version, version.build
                ),
            }
        })
    }
}

/// What has its own colour in DART's display, as its default object type has.
const COLOUR: &str = "125 0 125";
/// Focal length of a 5.11 camera, which is given by its angles: the width of its chip follows, m.
const FOCAL_LENGTH_M: f64 = 0.05;

/// The files: name and root element. `boxes_m` are the lowest and highest coordinates of each object's OBJ, then of each field's model's, in DART's axes.
///
/// # Errors
/// [`Error::Unsupported`] for a version that is not written; [`Error::Invalid`] with all that is not known of that version.
pub fn inputs(simulation: &Simulation, boxes_m: &[(DVec3, DVec3)]) -> Result<Vec<(&'static str, Element)>> {
    let writer = Writer { simulation, boxes_m, target: TargetVersion::of(&simulation.version)? };
    let mut problems = unknown(&simulation.optical, writer.target);
    let fields = simulation.fields.iter().filter(|_| writer.is_5_11());
    problems.extend(fields.map(|field| not_known(&field.at, "objects that stand in many places", "write")));
    if simulation.phase.temperature_mode != 0 {
        let message = "temperatures of cells, layers or the atmosphere are read, and not written";
        problems.push(Problem::new(Location::item("temperatureMode"), message));
    }
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let files = [
        ("maket.xml", writer.maket()),
        ("coeff_diff.xml", writer.coeff_diff()),
        ("object_3d.xml", writer.object_3d()),
        ("phase.xml", writer.phase()?),
        ("directions.xml", writer.directions()),
        ("atmosphere.xml", writer.atmosphere()),
        ("plots.xml", plots()),
        ("trees.xml", writer.trees()),
        ("urban.xml", urban()),
        ("water.xml", water()),
        ("inversion.xml", writer.linked(Element::new("DartInversion").with("runInversion", false), "linkInversion")),
    ];
    let Version { version, build } = &simulation.version;
    let root = |content| Element::new("DartFile").with("version", version).with("build", build).and(content);
    Ok(files.into_iter().map(|(name, content)| (name, root(content))).collect())
}

/// What of these optical properties is not known in a version: a problem for each.
pub(super) fn unknown(optical: &[OpticalProperty], target: TargetVersion) -> Vec<Problem> {
    let of = |property: &OpticalProperty| {
        let OpticalProperty { kind, ident, model, factors, at, .. } = property;
        if model.is_empty() {
            let message = format!("the spectrum of {ident:?} as a text is read, and not written");
            return Some(Problem::new(at.clone(), message).with_help("put it into a database"));
        }
        let what = match kind {
            _ if target == TargetVersion::V5_7_4 => return None,
            OpticalKind::Hapke => "Hapke's reflectance",
            OpticalKind::Rpv => "the RPV reflectance",
            OpticalKind::Lambertian if factors.is_empty() => return None,
            OpticalKind::Lambertian => "multiplicative factors",
        };
        Some(not_known(at, what, "make the material a Lambert surface, or write"))
    };
    optical.iter().filter_map(of).collect()
}

/// Something that 5.11 was never seen to write.
fn not_known(at: &Location, what: &str, instead: &str) -> Problem {
    let message = format!("how DART 5.11.0 has {what} is not known");
    Problem::new(at.clone(), message).with_help(format!(
        "{instead} for DART 5.7.4 (`--dart-version 5.7.4`): its upgrader takes that to later versions"
    ))
}

/// What of the inputs depends on the moment: the Sun and views, then bands, irradiances and cameras.
///
/// # Errors
/// As [`inputs`].
pub(super) fn of_a_moment(simulation: &Simulation) -> Result<[Element; 2]> {
    let writer = Writer { simulation, boxes_m: &[], target: TargetVersion::of(&simulation.version)? };
    Ok([writer.directions(), writer.phase()?])
}

struct Writer<'a> {
    simulation: &'a Simulation,
    boxes_m: &'a [(DVec3, DVec3)],
    target: TargetVersion,
}

impl Writer<'_> {
    fn is_5_11(&self) -> bool {
        self.target == TargetVersion::V5_11_0
    }

    /// The element with an attribute that only 5.11 has.
    fn new_in_5_11(&self, element: Element, name: &str, value: impl crate::formats::xml::Value) -> Element {
        if self.is_5_11() { element.with(name, value) } else { element }
    }

    /// 5.11 lets every file name another one that it is linked to.
    fn linked(&self, element: Element, name: &str) -> Element {
        self.new_in_5_11(element, name, "")
    }

    fn unsupported<T>(&self, at: &Location, feature: &str) -> Result<T> {
        let Version { version, .. } = &self.simulation.version;
        Err(Error::Unsupported { at: at.clone(), feature: format!("{feature}, in a simulation for DART {version},") })
    }

    fn maket(&self) -> Element {
        let maket = &self.simulation.maket;
        let mut root = Element::new("Maket")
            .with("dartZone", false)
            .with("exactlyPeriodicScene", maket.boundary)
            .with("useRandomGenerationSeed", false);
        root = self.linked(self.new_in_5_11(root, "hideRB", false), "linkEarthScene");
        let [cell_x, cell_z] = maket.cell_m;
        let cells = self.new_in_5_11(Element::new("CellDimensions"), "roundToExact", false);
        let [x, y] = maket.size_m;
        let scene = Element::new("Scene")
            .and(cells.with("x", cell_x).with("z", cell_z))
            .and(Element::new("SceneDimensions").with("x", x).with("y", y));
        let mut topography = Element::new("Topography").with("presenceOfTopography", maket.topography.is_some());
        if let Some(Topography { file, .. }) = &maket.topography {
            topography = topography.and(Element::new("TopographyProperties").with("fileName", file));
        }
        let soil = self
            .new_in_5_11(Element::new("Soil"), "groundEnabled", maket.ground_enabled)
            .and(optical_link(&maket.ground))
            .and(thermal_link(&maket.ground))
            .and(topography)
            .and(Element::new("DEM_properties").with("createTopography", false));
        let [latitude, longitude, altitude] = maket.latitude_longitude_altitude;
        let place =
            Element::new("LatLon").with("latitude", latitude).with("longitude", longitude).with("altitude", altitude);
        root = root
            .and(scene)
            .and(Element::new("RandomGenerationParameters").with("generationSeed", 733_426_921))
            .and(soil)
            .and(place);
        if maket.boundary == 2 {
            let slope = Element::new("InfiniteSlopeProperties");
            root = root.and(slope.with("connectionPercentageX", 5.0).with("connectionPercentageY", 5.0));
        }
        root
    }

    fn coeff_diff(&self) -> Element {
        let list = |kind, name: &str| {
            let of_kind = self.simulation.optical.iter().filter(|p| p.kind == kind);
            Element::new(name).and_all(of_kind.map(|p| self.optical_property(p)))
        };
        let surfaces = [
            list(OpticalKind::Lambertian, "LambertianMultiFunctions"),
            list(OpticalKind::Hapke, "HapkeSpecularMultiFunctions"),
            list(OpticalKind::Rpv, "RPVMultiFunctions"),
        ];
        let volumes = [
            Element::new("UnderstoryMultiFunctions")
                .with("integrationStepOnTheta", 1)
                .with("integrationStepOnPhi", 10)
                .with("outputLADFile", false),
            Element::new("AirMultiFunctions"),
        ];
        let temperatures =
            Element::new("Temperatures").and_all(self.simulation.thermal.iter().map(|t| self.thermal_function(t)));
        let root = Element::new("Coeff_diff").with("fluorescenceFile", false).with("fluorescenceProducts", false);
        if !self.is_5_11() {
            return root.and_all(surfaces).and_all(volumes).and(temperatures);
        }
        let surfaces = Element::new("Surfaces").and_all(surfaces).and(Element::new("PhaseExternMultiFunctions"));
        root.with("useCombinedYield", false)
            .with("linkOpticalTemperatures", "")
            .and(surfaces)
            .and(Element::new("Volumes").and_all(volumes))
            .and(temperatures)
    }

    fn optical_property(&self, property: &OpticalProperty) -> Element {
        let OpticalProperty { ident, database, model, .. } = property;
        let has_factors = !property.factors.is_empty();
        if property.kind == OpticalKind::Lambertian {
            let leaf = Element::new("ProspectExternalModule")
                .with("useProspectExternalModule", false)
                .with("isFluorescent", false);
            let entry = Element::new("LambertianMulti").with("ident", ident).with("roStDev", 0.0);
            let entry = entry.with("useMultiplicativeFactorForLUT", has_factors);
            let of_model =
                |e: Element| e.with("ModelName", model).with("databaseName", database).with("useSpecular", false);
            return match self.target {
                TargetVersion::V5_7_4 => of_model(entry).and(leaf).and_all(factors(property)),
                TargetVersion::V5_11_0 => entry
                    .with("lambertianDefinition", 0)
                    .with("useDirectionalDirectTransmittance", false)
                    .and(of_model(Element::new("Lambertian")).and(leaf)),
            };
        }
        let mut entry = Element::new(match property.kind {
            OpticalKind::Rpv => "RPVMulti",
            _ => "HapkeSpecularMulti",
        });
        let opaque = ("Lambertian_vegetation.db".to_owned(), "reflect_equal_1_trans_equal_0_0".to_owned());
        let (transmittance_database, transmittance_model) = property.transmittance.as_ref().unwrap_or(&opaque);
        entry = entry
            .with("ModelName", model)
            .with("databaseName", database)
            .with("transmittanceModelName", transmittance_model)
            .with("transmittanceDatabaseName", transmittance_database)
            .with("ident", ident)
            .with("useMultiplicativeFactorForLUT", has_factors)
            .with("useSpecular", false);
        if property.kind == OpticalKind::Hapke {
            entry = entry.with("useExternalModule", false);
        }
        entry.and_all(factors(property))
    }

    fn thermal_function(&self, function: &ThermalFunction) -> Element {
        let element = Element::new("ThermalFunction")
            .with("idTemperature", &function.ident)
            .with("meanT", function.mean_k)
            .with("deltaT", function.range_k)
            .with("useOpticalFactorMatrix", false)
            .with("override3DMatrix", function.overrides_cells)
            .with("singleTemperatureSurface", true);
        self.new_in_5_11(element, "usePrecomputedIPARs", false)
    }

    fn object_3d(&self) -> Element {
        let kinds = [(101, "Default_Object", COLOUR), (102, "Leaf", "0 175 0"), (103, "Trunk", "71 55 25")];
        let kinds = kinds.into_iter().take(if self.is_5_11() { 3 } else { 2 }).map(|(index, name, colour)| {
            Element::new("DefaultType").with("indexOT", index).with("name", name).with("typeColor", colour)
        });
        let types =
            Element::new("Types").and(Element::new("DefaultTypes").and_all(kinds)).and(Element::new("CustomTypes"));
        let objects = self.simulation.objects.iter().enumerate().map(|(i, object)| self.object(i, i, object));
        let first_box = self.simulation.objects.len();
        let fields = self.simulation.fields.iter().scan(first_box, |of_box, field| {
            let first = *of_box;
            *of_box += field.models.len();
            let models = field.models.iter().enumerate().map(|(i, model)| self.object(i, first + i, model));
            let element = Element::new("Field")
                .with("name", &field.name)
                .with("fieldDescriptionFileName", &field.file)
                .with("showObjectPositions", false);
            Some(element.and(Element::new("ModelList").and_all(models)))
        });
        Element::new("object_3d")
            .with("generateTriangleFileXML", false)
            .and(types)
            .and(Element::new("ObjectList").and_all(objects))
            .and(Element::new("ObjectFields").and_all(fields))
    }

    /// An object of a list, by its number in it and that of its box.
    fn object(&self, number: usize, of_box: usize, object: &Object) -> Element {
        let has_groups = !object.groups.is_empty();
        let element = Element::new("Object")
            .with("name", &object.name)
            .with("num", number)
            .with("file_src", &object.file)
            .with("hasGroups", has_groups)
            .with("objectDEMMode", object.dem_mode)
            .with("repeatedOnBorder", object.repeated_on_border)
            .with("hidden", object.hidden)
            .with("isDisplayed", true)
            .with("objectColor", COLOUR);
        let mut element = self.new_in_5_11(element, "hideRB", false).and(self.geometry(of_box, object));
        let mut optical = Element::new("ObjectOpticalProperties")
            .with("sameOPObject", has_groups && object.links.is_some())
            .with("isLAICalc", false)
            .with("isSingleGlobalLai", false);
        optical = match self.target {
            TargetVersion::V5_7_4 => optical.with("doubleFace", object.double_face),
            TargetVersion::V5_11_0 => {
                optical.with("sameExitanceObject", has_groups && object.links.is_some()).with("transparent", false)
            }
        };
        if let Some(links) = &object.links {
            optical = optical.and_all(self.links(links, object.double_face, object.back.as_ref()));
        }
        let mut types = Element::new("ObjectTypeProperties").with("sameOTObject", !has_groups);
        if !has_groups {
            types = types.and(default_type());
        }
        element = element.and(optical).and(types);
        if has_groups {
            element = element.and(Element::new("Groups").and_all(object.groups.iter().map(|g| self.group(g))));
        }
        element
    }

    fn geometry(&self, of_box: usize, object: &Object) -> Element {
        let (low_m, high_m) = self.boxes_m.get(of_box).copied().unwrap_or_default();
        let xyz =
            |name: &str, [x, y, z]: [&str; 3], v: DVec3| Element::new(name).with(x, v.x).with(y, v.y).with(z, v.z);
        let deviations = |e: Element, [x, y, z]: [&str; 3]| e.with(x, 0.0).with(y, 0.0).with(z, 0.0);
        let scale = xyz("ScaleProperties", ["xscale", "yscale", "zscale"], object.scale);
        let rotation = xyz("RotationProperties", ["xrot", "yrot", "zrot"], object.rotation_deg);
        let centre = xyz("Center3D", ["xCenter", "yCenter", "zCenter"], 0.5 * (low_m + high_m));
        Element::new("GeometricProperties")
            .and(xyz("PositionProperties", ["xpos", "ypos", "zpos"], object.position_m))
            .and(xyz("Dimension3D", ["xdim", "ydim", "zdim"], high_m - low_m))
            .and_all(self.is_5_11().then_some(centre))
            .and(deviations(scale, ["xScaleDeviation", "yScaleDeviation", "zScaleDeviation"]))
            .and(deviations(rotation, ["xRotDeviation", "yRotDeviation", "zRotDeviation"]))
    }

    fn group(&self, group: &Group) -> Element {
        let mut element = Element::new("Group")
            .with("num", group.number)
            .with("name", &group.name)
            .with("groupDEMMode", 0)
            .with("hidden", group.hidden)
            .with("isLAICalc", false);
        let mut optical = Element::new("GroupOpticalProperties");
        let mut types = Element::new("GroupTypeProperties");
        match self.target {
            TargetVersion::V5_7_4 => {
                element = element.with("hasElements", false);
                optical = optical.with("sameOPGroup", true).with("doubleFace", group.double_face);
                types = types.with("sameOTGroup", true);
            }
            TargetVersion::V5_11_0 => element = element.with("hideRB", false).with("transparent", false),
        }
        if let Some(links) = &group.links {
            optical = optical.and_all(self.links(links, group.double_face, group.back.as_ref()));
        }
        element.and(optical).and(types.and(default_type()))
    }

    /// Links of a surface; its back is as its front unless stated otherwise.
    fn links(&self, links: &Links, double_face: bool, back: Option<&Links>) -> Vec<Element> {
        let back = back.unwrap_or(links);
        let back_optical = Element::new("BackFaceOpticalProperty").and(optical_link(back));
        let back_thermal = Element::new("BackFaceThermalProperty").and(thermal_link(back));
        let back = |e| double_face.then_some(e);
        match self.target {
            TargetVersion::V5_7_4 => {
                let mut elements = vec![optical_link(links), thermal_link(links)];
                elements.extend(back(back_optical));
                elements.extend(back(back_thermal));
                elements
            }
            TargetVersion::V5_11_0 => vec![
                Element::new("SurfaceOpticalProperties")
                    .with("doubleFace", double_face)
                    .and(optical_link(links))
                    .and_all(back(back_optical)),
                Element::new("SurfaceExitanceProperties")
                    .with("doubleFace", double_face)
                    .with("useTemperaturePerTriangle", false)
                    .and(thermal_link(links))
                    .and_all(back(back_thermal)),
            ],
        }
    }

    fn phase(&self) -> Result<Element> {
        let mut root = Element::new("Phase").with("calculatorMethod", 0);
        root = self.new_in_5_11(root, "accelerationEngine", 2);
        root = root.and(Element::new("AtmosphereRadiativeTransfer").with("TOAtoBOA", 0)).and(self.expert_mode());
        root = root.and(self.input_parameters()?);
        if self.is_5_11() {
            root = root.and(self.engine());
        }
        let cameras = self.simulation.phase.cameras.iter().enumerate().map(|(i, c)| match self.target {
            TargetVersion::V5_7_4 => pinhole(c),
            TargetVersion::V5_11_0 => sensor(i, c),
        });
        let cameras = Element::new("SensorImageSimulation").with("importMultipleSensors", false).and_all(cameras);
        Ok(root.and(self.products()).and(cameras))
    }

    fn expert_mode(&self) -> Element {
        let zone = Element::new("ExpertModeZone").with("expertMode", false).with("nbThreads", 4);
        let zone = zone.with("useExternalScripts", false);
        if self.is_5_11() {
            return zone;
        }
        zone.with("isInterceptedPowerPerDirectionForSpecularCheck", false)
            .with("lightPropagationThreshold", 1e-7)
            .with("nbRandomPointsPerInteceptionAtmosphere", 1)
            .with("illuminationRepartitionMode", 2)
            .with("albedoThreshold", 1e-3)
            .with("surfaceBarycenterEnabled", true)
            .with("sparseVoxelAcceleration", true)
            .with("maxNbSceneCrossing", 1000)
            .with("subFaceBarycenterEnabled", true)
            .with("accelerationEngine", 0)
            .with("nbTrianglesWithinVoxelAcceleration", 10)
            .with("distanceBetweenIlluminationSubCenters", 0.1)
            .with("subFaceBarycenterSubdivision", 1)
            .with("thermalEmissionSurfaceSubdivision", 0.01)
            .with("nbSubcenterVolume", 2)
            .with("nbSubSubcenterTurbidEmission", 40)
            .with("triangleStorageMode", 0)
    }

    fn input_parameters(&self) -> Result<Element> {
        let phase = &self.simulation.phase;
        let mut parameters = self.linked(Element::new("DartInputParameters"), "linkPassiveRsRb");
        if !self.is_5_11() {
            let tracking = Element::new("nodefluxtracking").with("numberOfIteration", 5);
            parameters = parameters.and(tracking.with("gaussSiedelAcceleratingTechnique", false));
        }
        let from_light = Element::new("skylTemperature")
            .with("distanceBetweenIlluminationSubCenters", 0.1)
            .with("histogramThreshold", 5.0)
            .with("SKYLForTemperatureAssignation", 0.0);
        let side = Element::new("ImageSideIllumination")
            .with("disableThermalEmission", false)
            .with("sideIlluminationEnabled", false)
            .with("disableSolarIllumination", false);
        parameters = parameters
            .and(Element::new("SpectralDomainTir").with("temperatureMode", 0).and(from_light))
            .and(Element::new("SpectralIntervals").and_all(phase.bands.iter().enumerate().map(band)))
            // A black sky.
            .and(Element::new("temperatureAtmosphere").with("atmosphericApparentTemperature", 0.0))
            .and(side);
        let mut illumination = Element::new("nodeIlluminationMode").with("irradianceMode", phase.irradiance_mode);
        match phase.irradiance_mode {
            0 => {
                let table = Element::new("irradianceDatabaseNode")
                    .with("irradianceTable", "TOASolar_THKUR")
                    .with("irradianceColumn", "irradiance")
                    .with("databaseName", "Solar_constant.db")
                    .with("weightAtmosphereParameters", true)
                    .with("weightReflectanceParameters", true);
                let weights = Element::new("WeightingParameters").with("sceneAverageTemperatureForPonderation", 300.0);
                illumination = illumination.and(table.and(weights));
            }
            1 => {}
            mode => {
                return self.unsupported(&Location::item("irradianceMode"), &format!("irradiance by mode {mode}"));
            }
        }
        let given = phase.irradiance.iter().enumerate().filter_map(|(number, value)| Some((number, (*value)?)));
        let values = given.map(|(number, (irradiance, diffuse))| {
            Element::new("SpectralIrradianceValue")
                .with("bandNumber", number)
                .with("irradiance", irradiance)
                .with("Skyl", diffuse)
        });
        let common = Element::new("CommonParameters")
            // Normal to the beam.
            .with("irraDef", 0)
            .with("commonIrradianceCheckBox", false)
            .with("commonSkylCheckBox", false);
        let irradiance = Element::new("SpectralIrradiance").and(common).and_all(values);
        Ok(parameters.and(illumination.and(irradiance)))
    }

    fn engine(&self) -> Element {
        let cell_m = self.simulation.maket.cell_m[0];
        let execution = Element::new("LuxCoreRenderExecutionParameters")
            .with("checkFrequency", 1000)
            .with("lightPropagationThreshold", 1e-5)
            .with("maximumScatteringOrder", 30)
            .with("russianRouletteEnable", false)
            .with("sampler", 1)
            .and(Element::new("SamplerProperties").with("adaptativeStrength", 0.0));
        let save = Element::new("PeriodicSave")
            .with("periodicSaveMethod", 1)
            .and(Element::new("PeriodicSaveByTime").with("periodicSaveTime", 60));
        let budget = Element::new("RadiativeBudget")
            .with("meshGridXY", cell_m)
            .with("meshGridZ", self.simulation.maket.cell_m[1])
            .with("nbIncidentDirections", 50)
            .with("subZoneRB", false);
        let hybrid = Element::new("HybridAtmosphereBRFMap").with("brfResolution", 1);
        let parameters = Element::new("LuxCoreRenderEngineParameters")
            .with("atmosphericRadiativeTransfer", false)
            .with("linkDartLux", "")
            .with("maximumRenderingTime", 60)
            .with("nbSceneRepetition", 1)
            .with("pixelSize", cell_m)
            .with("targetRayDensityPerPixel", 200)
            .and(execution)
            .and(save)
            .and(budget)
            .and(hybrid.with("targetRayDensityPerDirection", 50));
        Element::new("EngineParameter").and(parameters)
    }

    fn products(&self) -> Element {
        let radiance = self.simulation.phase.radiance_products;
        let mut common =
            Element::new("CommonProducts").with("polarizationProducts", false).with("radiativeBudgetProducts", false);
        let mut tracking = Element::new("FluxTrackingModeProducts")
            .with("brfProducts", true)
            .with("temperaturePerTrianglePerCell", false);
        let brf = Element::new("BrfProductsProperties")
            .with("luminanceProducts", radiance)
            // Nadir, and the directions that are asked for.
            .with("maximalThetaImages", 0.0)
            .with("projection", 0)
            .with("sensorPlaneprojection", true)
            .with("transmittanceImages", false);
        let mut maket = Element::new("maketModuleProducts").with("laiProducts", false).with("areaMaketProducts", false);
        maket = self.linked(maket.with("objectGeneration", false), "linkMaketProducts");
        match self.target {
            TargetVersion::V5_7_4 => {
                let spreading = Element::new("ExpertModeZone_Etalement")
                    .with("etalement", 2)
                    .and(Element::new("ExpertModeZone_Projection").with("keepNonProjectedImage", false))
                    .and(Element::new("ExpertModeZone_PerTypeProduct").with("generatePerTypeProduct", false));
                let brf = brf
                    .with("image", 1)
                    .with("brfProduct", true)
                    .with("centralizedBrfProduct", true)
                    .with("extrapolation", true)
                    .with("horizontalOversampling", 1)
                    .with("nb_scene", 1)
                    .with("sensorOversampling", 1)
                    .and(spreading);
                tracking = tracking.with("allIterationsProducts", false).with("order1Products", false).and(brf);
                maket = maket.with("MNEProducts", false).with("coverRateProducts", false);
            }
            TargetVersion::V5_11_0 => {
                common = common.with("JacobianProducts", false).with("perLightSource", false);
                let text =
                    Element::new("BRFTextParameters").with("brfProduct", true).with("centralizedBrfProduct", true);
                let map = Element::new("BRFBiDirParameters")
                    .with("brfMap", true)
                    .with("brfResolution", 1.0)
                    .with("targetRayDensityPerDirection", 50);
                let brf = brf
                    .with("image", 2)
                    .with("generatePerTypeProduct", false)
                    .with("pixelDirectionImageGeneration", false)
                    .with("pixelToSceneCorrespondences", false)
                    .with("writeBrf", true)
                    .and(Element::new("BRFParameters").with("brfFileType", 2).and(text).and(map));
                let sunlit = Element::new("FluxTrackingBiDirectionalProducts")
                    .with("sunlitPerCell", false)
                    .with("sunlitPerTrianglePerCell", false);
                tracking = tracking.and(sunlit).and(brf);
            }
        }
        let products = Element::new("dartModuleProducts").and(common).and(tracking);
        Element::new("DartProduct").and(products).and(maket)
    }

    fn directions(&self) -> Element {
        let directions = &self.simulation.directions;
        let root = Element::new("Directions")
            .with("ifCosWeighted", false)
            .with("numberOfPropagationDirections", 100)
            .with("exactDate", 2);
        let views = directions.views_deg.iter().map(|[zenith_deg, azimuth_deg]| {
            let towards = Element::new("ZenithAzimuth")
                .with("directionZenithalAngle", *zenith_deg)
                .with("directionAzimuthalAngle", *azimuth_deg);
            let cone =
                Element::new("Square").with("widthDefinition", 0).and(Element::new("DefineOmega").with("omega", 0.001));
            Element::new("AddedDirections")
                .with("imageDirection", true)
                .with("ifSquareShape", true)
                .with("directionType", 0)
                .with("ifPhaseOnly", false)
                .and(towards)
                .and(cone)
        });
        let [zenith_deg, azimuth_deg] = directions.sun_deg;
        let sun = Element::new("SunViewingAngles")
            .with("sunViewingZenithAngle", zenith_deg)
            .with("sunViewingAzimuthAngle", azimuth_deg)
            // Irradiances are those at the body: nothing is scaled by the date.
            .with("dayOfTheYear", -1);
        let hot_spot = Element::new("HotSpotProperties")
            .with("oversampleDownwardRegion", false)
            .with("hotSpotPerpendicularPlane", false)
            .with("hotSpotParallelPlane", false)
            .with("oversampleUpwardRegion", false);
        let offset =
            Element::new("AzimuthalOffset").with("directionalAzimuthalOffset", 0.0).with("sunAzimuthalOffset", 0.0);
        self.linked(root, "linkDirection")
            .and_all(views)
            .and(sun)
            .and(hot_spot)
            .and(Element::new("Penumbra").with("mode", 0))
            .and(offset)
            .and(Element::new("ExpertModeZone").with("numberOfAngularSector", 10).with("numberOfLayers", 0))
    }

    /// There is none, but the file must be there: DART's own defaults.
    fn atmosphere(&self) -> Element {
        let database = "dart_atmosphere.db";
        let aerosol = Element::new("AerosolProperties")
            .with("aerosolsModelName", "USSTD76_RURALV23")
            .with("aerosolCumulativeModelName", "RURALV23")
            .with("hgParametersModelName", "RURALV23")
            .with("databaseName", database)
            .with("aerosolOptDepthFactor", 1.0);
        let model = Element::new("AtmosphericOpticalPropertyModel")
            .with("precipitableWaterAmountCkeckbox", false)
            .with("databaseName", database)
            .with("correctionBandModel", true)
            .with("temperatureModelName", "USSTD76")
            .with("redefTemperature", false)
            .with("gasModelName", "USSTD76")
            .with("gasGroup", 1)
            .with("gasCumulativeModelName", "USSTD76")
            .with("ignoreGasForExtrapolation", false)
            .with("co2MixRate", 365.0)
            .with("scaleOtherGases", false);
        let transfer = Element::new("AtmosphereTransfertFunctions")
            .with("inputOutputTransfertFunctions", 0)
            .and(Element::new("ComputedTransferFunctions").with("writeTransferFunctions", false));
        let products = Element::new("AtmosphereProducts")
            .with("atmosphereRadiance_BOA_avantCouplage", false)
            .with("atmosphereRadiance_BOA_apresCouplage", false)
            .with("ordreUnAtmos", false)
            .with("atmosphereBRF_TOA", false);
        let iterations = Element::new("AtmosphereIterations")
            .and(transfer)
            .and(self.new_in_5_11(products, "atmosphereReport", true))
            .and(Element::new("AtmosphereComponents").with("upwardingFluxes", false).with("downwardingFluxes", false))
            .and(
                Element::new("AtmosphereExpertModeZone")
                    .with("threshold_Atmos_scattering", 0.0001)
                    .with("number_iterationMax", 100)
                    .with("extrapol_atmos", true),
            );
        let layers = Element::new("discretisationAtmosAuto")
            .with("epsilon_atmos", 0.003)
            .with("xAI", 400.0)
            .with("gamma_atmos", 0.95)
            .with("yAI", 400.0);
        let geometry = Element::new("AtmosphereGeometry")
            .with("minimumNumberOfDivisions", 4)
            .with("discretisationAtmos", true)
            .with("heightOfSensor", 3000.0)
            .and(layers);
        let is_atmosphere = Element::new("IsAtmosphere").with("typeOfAtmosphere", 1);
        let root = Element::new("Atmosphere").with("isRadiativeTransfertInBottomAtmosphereDefined", false);
        self.linked(root, "linkAtmosphere")
            .and(Element::new("Aerosol").and(aerosol))
            .and(is_atmosphere.and(model).and(iterations).and(geometry))
    }

    fn trees(&self) -> Element {
        let trees = Element::new("Trees").with("sceneModelCharacteristic", 1).with("hidden", false);
        self.new_in_5_11(trees.with("isTrees", false), "hideRB", false)
    }
}

fn optical_link(links: &Links) -> Element {
    Element::new("OpticalPropertyLink")
        .with("indexFctPhase", links.index)
        .with("ident", &links.ident)
        .with("type", links.kind)
}

fn thermal_link(links: &Links) -> Element {
    Element::new("ThermalPropertyLink")
        .with("indexTemperature", links.thermal_index)
        .with("idTemperature", &links.thermal_ident)
}

fn default_type() -> Element {
    Element::new("ObjectTypeLink").with("indexOT", 101).with("identOType", "Default_Object")
}

/// Multiplicative factors, band by band; those that are not given are neutral, which DART's own defaults are not.
fn factors(property: &OpticalProperty) -> Option<Element> {
    let (node, entry, names): (_, _, &[&str]) = match property.kind {
        OpticalKind::Lambertian => (
            "lambertianNodeMultiplicativeFactorForLUT",
            "lambertianMultiplicativeFactorForLUT",
            &[
                "diffuseTransmittanceFactor",
                "reflectanceFactor",
                "directTransmittanceFactor",
                "specularIntensityFactor",
            ],
        ),
        OpticalKind::Hapke => (
            "hapkeNodeMultiplicativeFactorForLUT",
            "hapkeMultiplicativeFactorForLUT",
            &[
                "diffuseTransmittanceFactor",
                "directTransmittanceFactor",
                "hapkeParameterH1",
                "hapkeParameterH2",
                "specularIntensityFactor",
                "hapkeParameterC4",
                "hapkeParameterC1",
                "hapkeParameterC3",
                "hapkeParameterC2",
                "hapkeParameterW",
            ],
        ),
        OpticalKind::Rpv => (
            "RPVNodeMultiplicativeFactorForLUT",
            "RPVMultiplicativeFactorForLUT",
            &[
                "g_RPVMultiplicativeFactor",
                "diffuseTransmittanceFactor",
                "directTransmittanceFactor",
                "k_RPVMultiplicativeFactor",
                "h_RPVMultiplicativeFactor",
                "rhoZero_RPVMultiplicativeFactor",
                "specularIntensityFactor",
            ],
        ),
    };
    let with_factors = |element: Element, given: &[(String, f64)]| {
        names.iter().fold(element, |element, &name| {
            element.with(name, given.iter().find(|(n, _)| n == name).map_or(1.0, |(_, factor)| *factor))
        })
    };
    let first = property.factors.first()?;
    let mut parent = with_factors(Element::new(node), first);
    if property.kind == OpticalKind::Lambertian {
        parent = parent.with("diffuseTransmittanceAcceleration", 0.0);
    }
    let same = property.factors.iter().all(|f| f == first);
    parent = parent.with("useSameFactorForAllBands", same).with("useSameOpticalFactorMatrixForAllBands", false);
    let bands =
        property.factors.iter().map(|f| with_factors(Element::new(entry), f).with("useOpticalFactorMatrix", false));
    Some(parent.and_all(bands))
}

fn band((number, band): (usize, &SpectralInterval)) -> Element {
    let mut element = Element::new("SpectralIntervalsProperties")
        .with("bandNumber", number)
        .with("meanLambda", band.mean_um)
        .with("deltaLambda", band.width_um)
        .with("spectralDartMode", band.mode);
    if band.mode == 2 {
        // By Planck.
        element = element.and(Element::new("emissionLawNode").with("emissionLaw", 1));
    }
    element
}

/// A camera of 5.7: its angles lead from the scene to the camera.
fn pinhole(camera: &Pinhole) -> Element {
    let [theta, phi] = frame::reversed(camera.look_deg);
    let orientation = Element::new("CameraOrientation")
        .with("cameraTheta", theta)
        .with("cameraPhi", phi)
        .with("cameraRotation", camera.roll_deg);
    let [width, height] = camera.field_of_view_deg;
    let [samples, lines] = camera.pixels;
    let field = Element::new("CamImageFOV")
        .with("definitionFOV", 1)
        .with("defNbPixels", true)
        .and(Element::new("CamImageAOV").with("aovX", width).with("aovY", height))
        .and(Element::new("NbPixels").with("nbPixelsX", samples).with("nbPixelsY", lines));
    Element::new("Pinhole")
        .with("setImageSize", true)
        .with("defCameraOrientation", true)
        .with("ifFishEye", false)
        .and(Element::new("OrientationDef").with("orientDefType", 0).and(orientation))
        .and(position(Element::new("Sensor"), camera.position_m))
        .and(field)
}

/// A camera of 5.11: its angles lead from the camera to the scene.
fn sensor(number: usize, camera: &Pinhole) -> Element {
    let [zenith_deg, azimuth_deg] = camera.look_deg;
    let look = Element::new("SensorAngleDirection")
        .with("sensorDirectionTheta", zenith_deg)
        .with("sensorDirectionPhi", azimuth_deg);
    let common = Element::new("SensorCommonConfiguration")
        .with("directionDefinition", 0)
        .and(Element::new("SensorOrientation").with("orientationAngle", camera.roll_deg))
        .and(position(Element::new("SensorPosition"), camera.position_m).with("sensorPositionDefinition", 0))
        .and(Element::new("SensorView").with("viewDefinition", 1).and(look));
    let [width_deg, height_deg] = camera.field_of_view_deg;
    let chip_m = |angle_deg: f64| FOCAL_LENGTH_M * FrameCamera::pitch_of_angle(angle_deg.to_radians(), 1);
    let [samples, lines] = camera.pixels;
    let optics = Element::new("Pinhole")
        .with("fieldOfViewDefinition", 1)
        .and(Element::new("SensorDimensions").with("width", chip_m(width_deg)).with("height", chip_m(height_deg)))
        .and(Element::new("FocaleDistance").with("focaleDistance", FOCAL_LENGTH_M))
        .and(Element::new("FieldOfView").with("aovWidth", width_deg).with("aovHeight", height_deg))
        .and(Element::new("ImageResolution").with("nbPixelsWidth", samples).with("nbPixelsHeight", lines));
    Element::new("Sensor")
        .with("autoCropImage", false)
        .with("autoFOV", false)
        .with("customImageName", false)
        .with("defineRandomSeed", false)
        .with("keepOnlyCentralScene", false)
        .with("sensorConfiguration", 0)
        .with("sensorDisabled", false)
        .with("sensorName", format!("camera{}", number + 1))
        .and(common)
        .and(Element::new("SensorLuxCoreParameters").with("targetRayDensityPerPixel", 200))
        .and(optics)
}

fn position(element: Element, at_m: DVec3) -> Element {
    element.with("sensorPosX", at_m.x).with("sensorPosY", at_m.y).with("sensorPosZ", at_m.z)
}

fn plots() -> Element {
    let plots = Element::new("Plots").with("isVegetation", false).with("addExtraPlotsTextFile", false);
    plots.and(Element::new("ImportationFichierRaster"))
}

fn urban() -> Element {
    Element::new("Urban").and_all(["Buildings", "Roads", "SmallWalls"].map(Element::new))
}

fn water() -> Element {
    let water = Element::new("Water").with("waterPriorityOnTrees", false).with("waterPriorityOnPlots", false);
    water.and_all(["Lakes", "Rivers"].map(Element::new))
}
