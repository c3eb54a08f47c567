//! What inputs hold that mmxrt has no counterpart for, or does not know: reported once for each kind.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::Location;
use crate::formats::xml::Element;
use crate::report::Fate;

use super::Inputs;
use super::reading::Reading;

/// A feature of DART that mmxrt has no counterpart for.
struct Feature {
    section: &'static str,
    /// The element; `*` for any.
    element: &'static str,
    /// Attributes, any of which switches it on; none if the element's presence does.
    attributes: &'static [&'static str],
    /// Values that leave it off.
    off: &'static [&'static str],
    what: &'static str,
}

const fn switch(
    section: &'static str,
    element: &'static str,
    attributes: &'static [&'static str],
    what: &'static str,
) -> Feature {
    Feature { section, element, attributes, off: &["0"], what }
}

const PRODUCTS: &str = "products other than images (radiative budget, polarization, areas and the like)";
const RANDOM: &str = "values that vary at random: all are as their mean";
const OTHER_MODE: &str = "another mode than images by sunlight and heat (Monte Carlo, lidar)";
const SPECULAR: &str = "specular reflection";
const OTHER_OPTICS: &str = "an optical property that is neither Lambertian nor Hapke's nor RPV";

/// What is reported if it is in use. The same words are reported once, at the first place.
const FEATURES: &[Feature] = &[
    switch("Maket", "Maket", &["dartZone"], "the part of the scene that DART would simulate: all of it is read"),
    Feature {
        section: "Maket",
        element: "OpticalPropertyLink",
        attributes: &["type"],
        off: &["0", "2", "4"],
        what: OTHER_OPTICS,
    },
    switch("Coeff_diff", "Coeff_diff", &["fluorescenceProducts", "fluorescenceFile"], "fluorescence"),
    switch("Coeff_diff", "LambertianMulti", &["roStDev"], RANDOM),
    switch(
        "Coeff_diff",
        "LambertianMulti",
        &["lambertianDefinition"],
        "a Lambertian property that is not a table of a database",
    ),
    switch("Coeff_diff", "LambertianMulti", &["useDirectionalDirectTransmittance"], "transmittance by direction"),
    switch("Coeff_diff", "LambertianMulti", &["useSpecular"], SPECULAR),
    switch("Coeff_diff", "Lambertian", &["useSpecular"], SPECULAR),
    switch("Coeff_diff", "HapkeSpecularMulti", &["useSpecular"], SPECULAR),
    switch("Coeff_diff", "RPVMulti", &["useSpecular"], SPECULAR),
    switch(
        "Coeff_diff",
        "HapkeSpecularMulti",
        &["useExternalModule"],
        "parameters of Hapke's model from an outside module",
    ),
    switch(
        "Coeff_diff",
        "ProspectExternalModule",
        &["useProspectExternalModule", "isFluorescent"],
        "leaves modelled by PROSPECT",
    ),
    switch(
        "Coeff_diff",
        "*",
        &["useOpticalFactorMatrix", "useSameOpticalFactorMatrixForAllBands"],
        "factors that vary over the scene",
    ),
    switch("Coeff_diff", "ThermalFunction", &["usePrecomputedIPARs"], "temperatures from light computed before"),
    Feature {
        section: "object_3d",
        element: "OpticalPropertyLink",
        attributes: &["type"],
        off: &["0", "2", "4"],
        what: OTHER_OPTICS,
    },
    switch("object_3d", "*", &["isLAICalc"], "an object as a turbid medium: read are its triangles"),
    switch(
        "object_3d",
        "Group",
        &["hasElements"],
        "elements of a group with properties of their own: read are those of the group",
    ),
    switch("object_3d", "*", &["transparent"], "objects that light passes through"),
    switch("object_3d", "SurfaceExitanceProperties", &["useTemperaturePerTriangle"], "a temperature for each triangle"),
    switch("object_3d", "ScaleProperties", &["xScaleDeviation", "yScaleDeviation", "zScaleDeviation"], RANDOM),
    switch("object_3d", "RotationProperties", &["xRotDeviation", "yRotDeviation", "zRotDeviation"], RANDOM),
    switch("Phase", "Phase", &["calculatorMethod"], OTHER_MODE),
    switch("Phase", "DartInputParameters", &["calculatorMethod"], OTHER_MODE),
    switch("Phase", "AtmosphereRadiativeTransfer", &["TOAtoBOA"], "the atmosphere"),
    // Before 5.5.
    switch("Atmosphere", "Atmosphere", &["atmosphereType"], "the atmosphere"),
    switch("Phase", "ImageSideIllumination", &["sideIlluminationEnabled"], "light from the sides of the scene"),
    switch(
        "Phase",
        "ImageSideIllumination",
        &["disableSolarIllumination", "disableThermalEmission"],
        "sunlight or heat switched off",
    ),
    switch("Phase", "InsideSensorConfiguration", &["nbSceneRepetition"], "the scene repeated around a camera"),
    switch("Phase", "Sensor", &["autoFOV", "autoCropImage"], "an image that DART cuts to the scene"),
    switch("Phase", "ExpertModeZone", &["useExternalScripts"], "outside scripts"),
    switch(
        "Phase",
        "CommonProducts",
        &["radiativeBudgetProducts", "polarizationProducts", "JacobianProducts", "perLightSource"],
        PRODUCTS,
    ),
    switch("Phase", "FluxTrackingModeProducts", &["order1Products", "temperaturePerTrianglePerCell"], PRODUCTS),
    switch(
        "Phase",
        "maketModuleProducts",
        &["MNEProducts", "areaMaketProducts", "coverRateProducts", "laiProducts"],
        PRODUCTS,
    ),
    switch(
        "Phase",
        "BrfProductsProperties",
        &["projection", "transmittanceImages"],
        "images other than those of parallel views and cameras",
    ),
    switch("Directions", "Penumbra", &["mode"], "the Sun's disc"),
    Feature { section: "Directions", element: "Region", attributes: &[], off: &[], what: "regions of more directions" },
    Feature {
        section: "Directions",
        element: "OversampledPlane",
        attributes: &[],
        off: &[],
        what: "planes of more directions",
    },
    switch(
        "Directions",
        "HotSpotProperties",
        &["hotSpotParallelPlane", "hotSpotPerpendicularPlane", "oversampleDownwardRegion", "oversampleUpwardRegion"],
        "more directions about the hot spot",
    ),
    switch("Directions", "AzimuthalOffset", &["directionalAzimuthalOffset"], "an offset of all directions' azimuths"),
    switch("Plots", "Plots", &["isVegetation"], "land cover from a raster"),
    switch("Plots", "Plots", &["addExtraPlotsTextFile"], "plots from a text file"),
    Feature {
        section: "Plots",
        element: "Plot",
        attributes: &[],
        off: &[],
        what: "plots (other ground, vegetation, fluids)",
    },
    switch("Trees", "Trees", &["isTrees"], "trees"),
    Feature { section: "Urban", element: "Building", attributes: &[], off: &[], what: "buildings" },
    Feature { section: "Urban", element: "Road", attributes: &[], off: &[], what: "roads" },
    Feature { section: "Urban", element: "SmallWall", attributes: &[], off: &[], what: "walls" },
    Feature { section: "Water", element: "Lake", attributes: &[], off: &[], what: "lakes" },
    Feature { section: "Water", element: "River", attributes: &[], off: &[], what: "rivers" },
    switch("DartInversion", "DartInversion", &["runInversion"], "inversion of images"),
];

/// What each element of a section is known to hold. `*`: how DART computes, shows or lays out its products, or part of
/// a feature above; not looked into.
pub(super) const KNOWN: &[(&str, &str)] = &[
    ("Maket", "dartZone exactlyPeriodicScene useRandomGenerationSeed hideRB"),
    ("Scene", ""),
    ("CellDimensions", "x z roundToExact"),
    ("SceneDimensions", "x y"),
    ("DartZoneProperties", "*"),
    ("RandomGenerationParameters", "*"),
    ("InfiniteSlopeProperties", "*"),
    ("Soil", "groundEnabled"),
    ("OpticalPropertyLink", "ident indexFctPhase type"),
    ("ThermalPropertyLink", "idTemperature indexTemperature"),
    ("Topography", "presenceOfTopography"),
    ("TopographyProperties", "fileName meshStrategy"),
    ("DEM_properties", "*"),
    ("LatLon", "latitude longitude altitude"),
    ("Coeff_diff", "fluorescenceFile fluorescenceProducts useCombinedYield"),
    ("FluorescenceProductsProperties", "*"),
    ("Surfaces", ""),
    ("Volumes", "*"),
    ("LambertianMultiFunctions", ""),
    (
        "LambertianMulti",
        "ModelName databaseName fileName ident roStDev useMultiplicativeFactorForLUT useSpecular lambertianDefinition \
         useDirectionalDirectTransmittance",
    ),
    ("Lambertian", "ModelName databaseName useSpecular useMultiplicativeFactorForLUT"),
    ("ProspectExternalModule", "*"),
    ("SpecularData", "*"),
    ("nodeMultiplicativeFactorForLUT", "*"),
    ("LambertianSpecularMultiFunctions", "*"),
    ("opticalFactorMatrix", "*"),
    ("lambertianNodeMultiplicativeFactorForLUT", "*"),
    ("HapkeSpecularMultiFunctions", ""),
    (
        "HapkeSpecularMulti",
        "ModelName databaseName ident transmittanceDatabaseName transmittanceModelName useExternalModule \
         useMultiplicativeFactorForLUT useSpecular",
    ),
    ("HapkeExternalModules", "*"),
    ("hapkeNodeMultiplicativeFactorForLUT", "*"),
    ("RPVMultiFunctions", ""),
    (
        "RPVMulti",
        "ModelName databaseName ident transmittanceDatabaseName transmittanceModelName useMultiplicativeFactorForLUT \
         useSpecular",
    ),
    ("RPVNodeMultiplicativeFactorForLUT", "*"),
    ("PhaseExternMultiFunctions", "*"),
    ("SpecularMultiFunctions", "*"),
    ("MixedMultiFunctions", "*"),
    ("UnderstoryMultiFunctions", "*"),
    ("AirMultiFunctions", "*"),
    ("Temperatures", ""),
    (
        "ThermalFunction",
        "deltaT idTemperature meanT override3DMatrix singleTemperatureSurface useOpticalFactorMatrix usePrecomputedIPARs",
    ),
    ("object_3d", "generateTriangleFileXML"),
    ("Types", "*"),
    ("ObjectList", ""),
    ("Object", "file_src hasGroups hidden hideRB isDisplayed name num objectColor objectDEMMode repeatedOnBorder"),
    ("GeometricProperties", ""),
    ("PositionProperties", "xpos ypos zpos"),
    ("Dimension3D", "xdim ydim zdim"),
    ("Center3D", "xCenter yCenter zCenter"),
    ("ScaleProperties", "xscale yscale zscale xScaleDeviation yScaleDeviation zScaleDeviation"),
    ("RotationProperties", "xrot yrot zrot xRotDeviation yRotDeviation zRotDeviation"),
    ("ObjectOpticalProperties", "doubleFace isLAICalc isSingleGlobalLai sameExitanceObject sameOPObject transparent"),
    ("ObjectTypeProperties", "*"),
    ("Groups", ""),
    ("Group", "groupDEMMode hasElements hidden hideRB isLAICalc name num transparent"),
    ("GroupOpticalProperties", "doubleFace sameOPGroup sameExitanceGroup"),
    ("SurfaceOpticalProperties", "doubleFace"),
    ("SurfaceExitanceProperties", "doubleFace useTemperaturePerTriangle"),
    ("BackFaceOpticalProperty", ""),
    ("BackFaceThermalProperty", ""),
    ("GroupTypeProperties", "*"),
    ("Elements", "*"),
    ("LAIPropertyNode", "*"),
    ("PropertiesForObject3DTurbid", "*"),
    ("PropertiesForObject3DTurbidWithLAD", "*"),
    ("SingleGlobalLAIPropertyNode", "*"),
    ("ObjectFields", ""),
    ("Field", "fieldDescriptionFileName name showObjectPositions"),
    ("ModelList", ""),
    ("Phase", "calculatorMethod accelerationEngine expertMode"),
    ("AtmosphereRadiativeTransfer", "*"),
    ("ExpertModeZone", "*"),
    ("EngineParameter", "*"),
    ("ExternalScripts", "*"),
    ("DartInputParameters", "calculatorMethod"),
    ("MonteCarlo", "*"),
    ("Lidar", "*"),
    ("nodefluxtracking", "*"),
    ("SpectralDomainTir", "temperatureMode"),
    ("TemperatureFile", "temperatureFileName"),
    ("skylTemperature", "*"),
    // Before 5.7.
    ("Atmosphere_1", "*"),
    ("SpectralIntervals", ""),
    ("SpectralIntervalsProperties", "bandNumber deltaLambda meanLambda spectralDartMode radiativeBudgetProducts"),
    ("emissionLawNode", "emissionLaw"),
    ("temperatureAtmosphere", "atmosphericApparentTemperature"),
    ("ImageSideIllumination", "*"),
    ("nodeIlluminationMode", "irradianceMode illuminationMode"),
    ("irradianceDatabaseNode", "*"),
    ("BandIrradianceFileNode", "*"),
    ("illumination", "*"),
    ("ftiImportation", "*"),
    ("SpectralIrradiance", ""),
    ("CommonParameters", "commonIrradianceCheckBox commonSkylCheckBox irraDef"),
    ("SpectralIrradianceValue", "Skyl bandNumber irradiance"),
    ("DartProduct", "*"),
    ("SensorImageSimulation", "importMultipleSensors"),
    ("SensorsImportation", "*"),
    // Told as a whole.
    ("Pushbroom", "*"),
    ("Pinhole", "defCameraOrientation fieldOfViewDefinition ifFishEye setImageSize"),
    ("OrientationDef", "orientDefType"),
    ("CameraOrientation", "cameraPhi cameraRotation cameraTheta"),
    ("CameraOrientYPR", "*"),
    ("FishEye", "*"),
    ("FishEyeFOV", "*"),
    ("Radiometer", "*"),
    ("CamImageFOV", "defNbPixels definitionFOV"),
    ("CamImageDim", "sizeImageX sizeImageY"),
    ("CamImageAOV", "aovX aovY"),
    ("NbPixels", "nbPixelsX nbPixelsY"),
    ("InsideSensor", "sensorConfiguration"),
    ("InsideSensorConfiguration", "nbSceneRepetition"),
    ("SensorCentralPosition", "sensorPosX sensorPosY sensorPosZ"),
    ("Image", ""),
    // Before 5.10 the camera's place, from there on the camera: its name, random seed and crop change nothing that is read.
    (
        "Sensor",
        "autoCropImage autoFOV customImageName defineRandomSeed keepOnlyCentralScene sensorConfiguration sensorDisabled \
         sensorName sensorPosX sensorPosY sensorPosZ",
    ),
    ("SensorCommonConfiguration", "directionDefinition"),
    ("SensorPosition", "sensorPosX sensorPosY sensorPosZ sensorPositionDefinition"),
    ("SensorView", "viewDefinition"),
    ("SensorViewDirection", "sensorDirectionX sensorDirectionY sensorDirectionZ"),
    ("SensorAngleDirection", "sensorDirectionPhi sensorDirectionTetha sensorDirectionTheta"),
    ("SensorOrientation", "orientationAngle tethaOrientation"),
    ("SensorLuxCoreParameters", "*"),
    ("SensorDimensions", "height width"),
    ("FocaleDistance", "focaleDistance"),
    ("FieldOfView", "aovHeight aovWidth"),
    ("ImageResolution", "nbPixelsHeight nbPixelsWidth"),
    ("Hemisphere", "*"),
    ("Orthographic", "*"),
    ("Directions", "exactDate ifCosWeighted numberOfPropagationDirections"),
    ("AddedDirections", "*"),
    ("Region", "*"),
    ("OversampledPlane", "*"),
    ("Sun", "sunAzimuthAngle sunZenithAngle dayOfTheYear"),
    ("ExactDateHour", "year month day hour minute second localTime timezone daylightSavingTime"),
    ("SunViewingAngles", "sunViewingAzimuthAngle sunViewingZenithAngle dayOfTheYear"),
    ("HotSpotProperties", "*"),
    ("Penumbra", "*"),
    ("AzimuthalOffset", "directionalAzimuthalOffset sunAzimuthalOffset"),
];

/// Elements that may appear several times; of all others only the first is read.
pub(super) const LISTED: &[&str] = &[
    "LambertianMulti",
    "HapkeSpecularMulti",
    "RPVMulti",
    "ThermalFunction",
    "Object",
    "Group",
    "Field",
    "SpectralIntervalsProperties",
    "SpectralIrradianceValue",
    "AddedDirections",
    "Region",
    "OversampledPlane",
    "Pinhole",
    "Pushbroom",
    "InsideSensor",
    "Sensor",
];

/// Names that are not known are reported one by one up to this number.
const UNKNOWN: usize = 50;

/// Notes the parts of the inputs that are not read.
pub(super) fn tell(inputs: &Inputs, reading: &mut Reading) {
    let known: BTreeMap<&str, &str> = KNOWN.iter().copied().collect();
    for (root, (_, name, _)) in inputs.roots.iter().zip(super::FILES) {
        let beside = root.iter().flat_map(|root| &root.children).filter(|child| child.name != name);
        for other in beside {
            reading.note(Fate::Dropped, other.at(), format!("`<{}>` is not known here", other.name));
        }
        let Some(section) = inputs.section(name) else { continue };
        let mut told = Told::default();
        for feature in FEATURES.iter().filter(|f| f.section == name) {
            in_use(section, feature, &mut told);
        }
        let mut unknown = Told::default();
        // Sections without a counterpart are reported as a whole.
        if known.contains_key(name) {
            strangers(section, &known, &mut unknown);
        }
        let rest = unknown.kinds.len().saturating_sub(UNKNOWN);
        for (what, at, count) in told.kinds.into_iter().chain(unknown.kinds.into_iter().take(UNKNOWN)) {
            let message = if count > 1 { format!("{what} (in {count} places)") } else { what };
            reading.note(Fate::Dropped, at, message);
        }
        if rest > 0 {
            reading.note(Fate::Dropped, section.at(), format!("and {rest} more names that are not known"));
        }
    }
}

/// Kinds of losses in the order of their first place, and how often there are.
#[derive(Default)]
struct Told {
    kinds: Vec<(String, Location, usize)>,
    index: BTreeMap<String, usize>,
}

impl Told {
    fn add(&mut self, what: String, at: impl FnOnce() -> Location) {
        match self.index.get(&what) {
            Some(&i) => self.kinds[i].2 += 1,
            None => {
                self.index.insert(what.clone(), self.kinds.len());
                self.kinds.push((what, at(), 1));
            }
        }
    }
}

fn in_use(element: &Element, feature: &Feature, told: &mut Told) {
    // What is hidden is ignored by DART.
    if element.get("hidden").is_some_and(|h| h.trim() == "1") {
        return;
    }
    if feature.element == "*" || feature.element == element.name {
        let is_off = |value: &str| {
            feature.off.contains(&value.trim()) || feature.off == ["0"] && super::reading::number(value) == Some(0.0)
        };
        let on = feature.attributes.iter().find(|name| element.get(name).is_some_and(|v| !is_off(v)));
        match on {
            Some(attribute) => told.add(feature.what.into(), || element.at_attribute(attribute)),
            None if feature.attributes.is_empty() => told.add(feature.what.into(), || element.at()),
            None => {}
        }
    }
    for child in &element.children {
        in_use(child, feature, told);
    }
}

/// Elements, attributes and text that are not known.
fn strangers(element: &Element, known: &BTreeMap<&str, &str>, told: &mut Told) {
    let Some(attributes) = known.get(element.name.as_str()) else {
        return told.add(format!("`<{}>` is not known here", element.path()), || element.at());
    };
    if *attributes == "*" {
        return;
    }
    for attribute in &element.attributes {
        // From 5.11 elements have empty attributes that link them to others.
        let is_empty_link = attribute.name.starts_with("link") && attribute.value.is_empty();
        if !is_empty_link && !attributes.split_whitespace().any(|name| name == attribute.name) {
            let what = format!("the attribute `{}` of `<{}>` is not known", attribute.name, element.path());
            told.add(what, || element.at_attribute(&attribute.name));
        }
    }
    if element.has_text {
        told.add(format!("text within `<{}>`", element.path()), || element.at());
    }
    let mut before = BTreeSet::new();
    for child in &element.children {
        let name = child.name.as_str();
        let is_single = known.contains_key(name) && !LISTED.contains(&name);
        if !before.insert(name) && is_single {
            told.add(format!("another `<{}>`: the first is read", child.path()), || child.at());
            continue;
        }
        strangers(child, known, told);
    }
}
