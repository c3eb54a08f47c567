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
