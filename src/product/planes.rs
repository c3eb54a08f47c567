//! Images of geometry that go with a cube, pixel by pixel.

/// One image: a value for every pixel, NaN where there is no surface (and nowhere else).
#[derive(Debug, Clone, PartialEq)]
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
    /// The plane of a name.
    pub fn plane(&self, name: &str) -> Option<&Plane> {
        self.planes.iter().find(|p| p.name == name)
    }
}
