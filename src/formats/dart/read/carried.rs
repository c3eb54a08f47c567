//! Which attributes of DART's inputs a [`Simulation`](super::Simulation) carries.

/// Attributes whose values a simulation carries: they are compared by what they mean.
pub(super) const CARRIED: [(&str, &str); 53] = [
    ("Maket", "exactlyPeriodicScene"),
    ("CellDimensions", "x z"),
    ("SceneDimensions", "x y"),
    ("Soil", "groundEnabled"),
    ("OpticalPropertyLink", "indexFctPhase type"),
    ("ThermalPropertyLink", "indexTemperature"),
    ("Topography", "presenceOfTopography"),
    ("TopographyProperties", "fileName"),
    ("LatLon", "latitude longitude altitude"),
    ("LambertianMulti", "ModelName databaseName fileName"),
    ("Lambertian", "ModelName databaseName"),
    ("HapkeSpecularMulti", "ModelName databaseName transmittanceDatabaseName transmittanceModelName"),
    ("RPVMulti", "ModelName databaseName transmittanceDatabaseName transmittanceModelName"),
    ("ThermalFunction", "deltaT meanT override3DMatrix"),
    ("Object", "file_src hasGroups hidden objectDEMMode repeatedOnBorder"),
    ("PositionProperties", "xpos ypos zpos"),
    ("ScaleProperties", "xscale yscale zscale"),
    ("RotationProperties", "xrot yrot zrot"),
    ("ObjectOpticalProperties", "doubleFace sameExitanceObject sameOPObject"),
    ("Group", "hidden"),
    ("GroupOpticalProperties", "doubleFace"),
    ("SurfaceOpticalProperties", "doubleFace"),
    ("SpectralIntervalsProperties", "bandNumber deltaLambda meanLambda spectralDartMode"),
    ("SpectralDomainTir", "temperatureMode"),
    ("TemperatureFile", "temperatureFileName"),
    ("nodeIlluminationMode", "irradianceMode"),
    ("CommonParameters", "commonIrradianceCheckBox commonSkylCheckBox"),
    ("SpectralIrradianceValue", "Skyl bandNumber irradiance"),
    ("Pinhole", "defCameraOrientation fieldOfViewDefinition setImageSize"),
    ("OrientationDef", "orientDefType"),
    ("CameraOrientation", "cameraPhi cameraRotation cameraTheta"),
    ("CamImageFOV", "defNbPixels definitionFOV"),
    ("CamImageDim", "sizeImageX sizeImageY"),
    ("CamImageAOV", "aovX aovY"),
    ("NbPixels", "nbPixelsX nbPixelsY"),
    ("SensorCentralPosition", "sensorPosX sensorPosY sensorPosZ"),
    ("Sensor", "sensorPosX sensorPosY sensorPosZ"),
    ("SensorPosition", "sensorPosX sensorPosY sensorPosZ"),
    ("SensorView", "viewDefinition"),
    ("SensorViewDirection", "sensorDirectionX sensorDirectionY sensorDirectionZ"),
    ("SensorAngleDirection", "sensorDirectionPhi sensorDirectionTetha sensorDirectionTheta"),
    ("SensorOrientation", "orientationAngle tethaOrientation"),
    ("SensorDimensions", "height width"),
    ("FocaleDistance", "focaleDistance"),
    ("FieldOfView", "aovHeight aovWidth"),
    ("ImageResolution", "nbPixelsHeight nbPixelsWidth"),
    ("Directions", "exactDate"),
    ("Sun", "sunAzimuthAngle sunZenithAngle"),
    ("SunViewingAngles", "sunViewingAzimuthAngle sunViewingZenithAngle"),
    ("ExactDateHour", "year month day hour minute second localTime timezone daylightSavingTime"),
    ("AzimuthalOffset", "sunAzimuthalOffset"),
    ("AddedDirections", "directionType ifPhaseOnly imageDirection"),
    ("ZenithAzimuth", "directionAzimuthalAngle directionZenithalAngle"),
];
/// Of multiplicative factors, beside all that are factors.
pub(super) const FACTORS: &str = "useSameFactorForAllBands";
/// What tells entries of a list apart, whatever their order.
pub(super) const KEYS: [&str; 2] = ["ident", "idTemperature"];

/// Whether what an attribute says, or whom it names, is in a simulation.
pub(super) fn is_carried(element: &str, attribute: &str) -> bool {
    let is_named = |(name, names): &&(&str, &str)| *name == element && names.split_whitespace().any(|n| n == attribute);
    KEYS.contains(&attribute)
        || CARRIED.iter().any(|carried| is_named(&carried))
        || is_factors(element) && (attribute == FACTORS || is_factor(attribute))
}

/// An element of multiplicative factors, of all bands or of one.
pub(super) fn is_factors(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with("multiplicativefactorforlut")
}

pub(super) fn is_factor(attribute: &str) -> bool {
    !attribute.starts_with("use") && attribute != "diffuseTransmittanceAcceleration"
}
