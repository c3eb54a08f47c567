//! What one acquisition sees of the surface, facet by facet.

/// Facets that an acquisition sees, ascending, and how it sees them. Angles and sampling are those at the middle of what is seen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sights {
    /// The facet.
    pub facet: Vec<u32>,
    /// Share of its area that is seen.
    pub seen: Vec<f64>,
    /// Share of its area that is seen and from which the middle of the Sun is seen.
    pub sunlit: Vec<f64>,
    /// Size of a pixel on the ground, m: the root of the area of the facet's plane that a pixel shows.
    pub sampling_m: Vec<f64>,
    /// Angle between the facet's normal and the Sun, deg.
    pub incidence_deg: Vec<f64>,
    /// Angle between the facet's normal and the camera, deg.
    pub emission_deg: Vec<f64>,
}

/// How one facet is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The facet.
    pub facet: u32,
    /// See [`Sights`].
    pub seen: f64,
    /// See [`Sights`].
    pub sunlit: f64,
    /// See [`Sights`].
    pub sampling_m: f64,
    /// See [`Sights`].
    pub incidence_deg: f64,
    /// See [`Sights`].
    pub emission_deg: f64,
}

impl Sights {
    /// Adds a facet after those that are there.
    pub fn push(&mut self, sight: Sight) {
        let Sight { facet, seen, sunlit, sampling_m, incidence_deg, emission_deg } = sight;
        self.facet.push(facet);
        self.seen.push(seen);
        self.sunlit.push(sunlit);
        self.sampling_m.push(sampling_m);
        self.incidence_deg.push(incidence_deg);
        self.emission_deg.push(emission_deg);
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Sight> {
        (0..self.facet.len()).map(|i| Sight {
            facet: self.facet[i],
            seen: self.seen[i],
            sunlit: self.sunlit[i],
            sampling_m: self.sampling_m[i],
            incidence_deg: self.incidence_deg[i],
            emission_deg: self.emission_deg[i],
        })
    }

    /// Says what is inconsistent with a mesh of so many facets; `Ok` if nothing is.
    ///
    /// # Errors
    /// The first thing that does not hold, as a sentence.
    pub fn validate(&self, facets: usize) -> Result<(), String> {
        let Sights { facet, seen, sunlit, sampling_m, incidence_deg, emission_deg } = self;
        for column in [seen, sunlit, sampling_m, incidence_deg, emission_deg] {
            if column.len() != facet.len() {
                return Err(format!("{} facets, but {} values of one column", facet.len(), column.len()));
            }
        }
        if facet.windows(2).any(|two| two[0] >= two[1]) {
            return Err("facets are not ascending".into());
        }
        if let Some(last) = facet.last().filter(|last| **last as usize >= facets) {
            return Err(format!("facet {last} of {facets}"));
        }
        let is_wrong = |sight: &Sight| {
            let shares = (0.0..=1.0).contains(&sight.seen) && (0.0..=sight.seen).contains(&sight.sunlit);
            let angles = [sight.incidence_deg, sight.emission_deg].iter().all(|angle| (0.0..=180.0).contains(angle));
            !(shares && angles && sight.sampling_m > 0.0)
        };
        match self.iter().find(is_wrong) {
            Some(sight) => Err(format!("{sight:?} cannot be")),
            None => Ok(()),
        }
    }
}
