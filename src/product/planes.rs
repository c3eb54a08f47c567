//! Images of geometry that go with a cube, pixel by pixel.

/// One image: a value for every pixel, NaN where there is no surface (and nowhere else).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plane {
    /// Name: the ISIS `phocube` keyword for values of the centre ray, with `_MEAN` for area means.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Values, line by line.
    pub values: Vec<f64>,
}

/// The images of geometry of one observation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Backplanes {
    /// Pixels in a line.
    pub samples: usize,
    /// Lines.
    pub lines: usize,
    /// The images, in the order they are written.
    pub planes: Vec<Plane>,
}

impl Backplanes {
    /// Beginning of the names of planes that say how much of a pixel shows a body of the sky.
    pub const GLOBE: &'static str = "GLOBE ";

    /// Share of each pixel that shows anything: the surface, or a body of the sky.
    pub fn shown(&self) -> Vec<f64> {
        let mut shown = self.plane("COVERAGE").map(|plane| plane.values.clone()).unwrap_or_default();
        for plane in self.planes.iter().filter(|plane| plane.name.starts_with(Self::GLOBE)) {
            shown.iter_mut().zip(&plane.values).for_each(|(sum, share)| *sum += share);
        }
        shown
    }

    /// Images side by side that have the same number of lines; where one lacks a plane of another, that is 0.
    pub fn beside(parts: &[Backplanes]) -> Backplanes {
        let lines = parts.iter().map(|part| part.lines).max().unwrap_or(0);
        let samples = parts.iter().map(|part| part.samples).sum();
        let mut all = Backplanes { samples, lines, planes: vec![] };
        let mut first = 0;
        for part in parts {
            for Plane { name, unit, values } in &part.planes {
                let place = all.planes.iter().position(|plane| plane.name == *name).unwrap_or_else(|| {
                    let values = vec![0.0; samples * lines];
                    all.planes.push(Plane { name: name.clone(), unit: unit.clone(), values });
                    all.planes.len() - 1
                });
                for (line, values) in values.chunks(part.samples.max(1)).enumerate().take(lines) {
                    all.planes[place].values[line * samples + first..][..values.len()].copy_from_slice(values);
                }
            }
            first += part.samples;
        }
        all
    }

    /// The plane of a name.
    pub fn plane(&self, name: &str) -> Option<&Plane> {
        self.planes.iter().find(|p| p.name == name)
    }
}

/// What planes hold, by their names; CONVENTIONS.md defines them.
const ABOUT: &[(&str, &str)] = &[
    ("COVERAGE", "share of the pixel that sees the surface"),
    ("LIT_FRACTION", "share of what is seen that is sunlit"),
    ("FACET", "facet with the largest area in the pixel"),
    ("FACE", "face that this facet was cut from"),
    ("MATERIAL", "material with the largest area in the pixel, in the order of the scene"),
    ("LATITUDE", "planetocentric latitude of the point that the centre ray meets"),
    ("LONGITUDE", "longitude of that point, to the east"),
    ("RADIUS", "distance of that point from the body's centre"),
    ("BODYFIXEDX", "body-fixed x of that point"),
    ("BODYFIXEDY", "body-fixed y of that point"),
    ("BODYFIXEDZ", "body-fixed z of that point"),
    ("RANGE", "distance of that point from the camera"),
    ("PHASE", "angle between the directions to the Sun and the camera"),
    ("INCIDENCE", "angle of the Sun from the radius"),
    ("EMISSION", "angle of the camera from the radius"),
    ("LOCALINCIDENCE", "angle of the Sun from the facet's normal"),
    ("LOCALEMISSION", "angle of the camera from the facet's normal"),
    ("PIXELRESOLUTION", "width of the pixel at that range"),
    ("OBLIQUEDETECTORRESOLUTION", "width of the pixel on the facet"),
    ("GSD_SAMPLE", "ground sampling distance along a line"),
    ("GSD_LINE", "ground sampling distance from line to line"),
    ("SLOPE", "angle of the facet's normal from the radius"),
    ("SLOPEAZIMUTH", "where the slope goes down, from north by east"),
    ("SUNILLUMINATIONMASK", "1 where that point is sunlit, else 0"),
    ("MAP_COVERAGE", "share of what is seen that the map knows"),
    ("MAP_ANGLE", "angle between the map's direction and the camera's"),
];

impl Plane {
    /// What it holds, in words; its name where there are none.
    pub fn about(&self) -> String {
        let of = |name: &str| ABOUT.iter().find(|(known, _)| *known == name).map(|(_, about)| *about);
        let after = |mark: &str| self.name.strip_prefix(mark);
        if let Some(about) = of(&self.name) {
            about.to_owned()
        } else if let Some(about) = self.name.strip_suffix("_MEAN").and_then(of) {
            format!("{about}; over the area that the pixel sees")
        } else if let Some(entry) = after("ABUNDANCE_LIT ") {
            format!("share of the pixel that is {entry} and sunlit")
        } else if let Some(entry) = after("ABUNDANCE ") {
            format!("share of the pixel that is {entry}")
        } else if let Some(body) = after(Backplanes::GLOBE) {
            format!("share of the pixel that shows {body}")
        } else {
            self.name.clone()
        }
    }
}
