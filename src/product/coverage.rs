//! What many acquisitions have seen of the surface: how often, how finely and under which angles each facet.
//!
//! All of it is counts, smallest and largest numbers: it does not depend on the order in which acquisitions are added.

use super::Sights;

/// Which sights count.
#[derive(Debug, Clone, PartialEq)]
pub struct CoverageRule {
    /// Only what is in sunlight.
    pub in_sunlight: bool,
    /// Emission up to here, deg.
    pub most_emission_deg: f64,
    /// Incidence up to here, deg.
    pub most_incidence_deg: f64,
    /// Samplings of which it is asked how much of the surface is seen so finely or more so, m.
    pub within_m: Vec<f64>,
}

impl Default for CoverageRule {
    /// All that is in sunlight.
    fn default() -> Self {
        CoverageRule {
            in_sunlight: true,
            most_emission_deg: 90.0,
            most_incidence_deg: 90.0,
            within_m: vec![1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0],
        }
    }
}

/// What sights have added up to.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// Which sights count.
    pub rule: CoverageRule,
    /// Of each facet, in how many acquisitions it counts as seen.
    pub sights: Vec<u32>,
    /// The finest sampling, m; infinite where it is never seen.
    pub sampling_m: Vec<f64>,
    /// Smallest and largest incidence, deg; the first is larger where it is never seen.
    pub incidence_deg: Vec<[f64; 2]>,
    /// Smallest and largest emission, deg.
    pub emission_deg: Vec<[f64; 2]>,
    /// The largest share of its area that one acquisition has seen.
    pub part: Vec<f64>,
    /// The same of acquisitions that sample it so finely, for each sampling of the rule.
    pub part_within: Vec<Vec<f64>>,
}

/// How much of a surface has been seen, m2 over m2.
///
/// Parts of a facet that different acquisitions see are not told apart: what all of them see together is between the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceShare {
    /// Of each facet the largest part that one acquisition has seen.
    pub at_least: f64,
    /// All of each facet of which some has been seen.
    pub at_most: f64,
}

impl Coverage {
    /// Of so many facets, of which nothing has been seen.
    pub fn new(facets: usize, rule: CoverageRule) -> Self {
        let never = [f64::INFINITY, f64::NEG_INFINITY];
        Coverage {
            sights: vec![0; facets],
            sampling_m: vec![f64::INFINITY; facets],
            incidence_deg: vec![never; facets],
            emission_deg: vec![never; facets],
            part: vec![0.0; facets],
            part_within: vec![vec![0.0; facets]; rule.within_m.len()],
            rule,
        }
    }

    /// Adds what an acquisition sees.
    pub fn add(&mut self, sights: &Sights) {
        let CoverageRule { in_sunlight, most_emission_deg, most_incidence_deg, within_m } = &self.rule;
        for sight in sights.iter() {
            let part = if *in_sunlight { sight.sunlit } else { sight.seen };
            if part <= 0.0 || sight.emission_deg > *most_emission_deg || sight.incidence_deg > *most_incidence_deg {
                continue;
            }
            let facet = sight.facet as usize;
            self.sights[facet] += 1;
            self.sampling_m[facet] = self.sampling_m[facet].min(sight.sampling_m);
            for (ends, angle) in [
                (&mut self.incidence_deg[facet], sight.incidence_deg),
                (&mut self.emission_deg[facet], sight.emission_deg),
            ] {
                *ends = [ends[0].min(angle), ends[1].max(angle)];
            }
            self.part[facet] = self.part[facet].max(part);
            for (parts, within_m) in self.part_within.iter_mut().zip(within_m) {
                if sight.sampling_m <= *within_m {
                    parts[facet] = parts[facet].max(part);
                }
            }
        }
    }

    /// How much of a surface whose facets have these areas, m2, has been seen at all.
    pub fn seen(&self, area_m2: &[f64]) -> SurfaceShare {
        share(&self.part, area_m2)
    }

    /// How much has been seen within each sampling of the rule, m.
    pub fn within(&self, area_m2: &[f64]) -> impl Iterator<Item = (f64, SurfaceShare)> {
        self.rule.within_m.iter().zip(&self.part_within).map(|(within_m, parts)| (*within_m, share(parts, area_m2)))
    }
}

fn share(parts: &[f64], area_m2: &[f64]) -> SurfaceShare {
    let [mut all, mut least, mut most] = [0.0; 3];
    for (part, area) in parts.iter().zip(area_m2) {
        all += area;
        least += part * area;
        most += if *part > 0.0 { *area } else { 0.0 };
    }
    let over_all = |sum: f64| if all > 0.0 { (sum / all).min(1.0) } else { 0.0 };
    SurfaceShare { at_least: over_all(least), at_most: over_all(most) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::product::Sight;

    fn sight(facet: u32, seen: f64, sunlit: f64, sampling_m: f64, angles: [f64; 2]) -> Sight {
        Sight { facet, seen, sunlit, sampling_m, incidence_deg: angles[0], emission_deg: angles[1] }
    }

    fn of(all: &[Sight]) -> Sights {
        let mut sights = Sights::default();
        all.iter().for_each(|sight| sights.push(*sight));
        sights.validate(4).unwrap();
        sights
    }

    /// Three facets of 1, 2 and 5 m2, by hand.
    #[test]
    fn counts_ends_and_shares_are_those_of_all_sights_in_any_order() {
        let area_m2 = [1.0, 2.0, 5.0];
        let looks = [
            of(&[sight(0, 1.0, 0.5, 8.0, [30.0, 10.0]), sight(1, 0.25, 0.25, 20.0, [40.0, 5.0])]),
            of(&[sight(0, 0.75, 0.75, 12.0, [60.0, 50.0]), sight(2, 1.0, 0.0, 3.0, [95.0, 1.0])]),
        ];
        let rule = CoverageRule { within_m: vec![10.0, 20.0], ..CoverageRule::default() };
        let mut coverage = Coverage::new(3, rule.clone());
        looks.iter().for_each(|look| coverage.add(look));
        assert_eq!(coverage.sights, [2, 1, 0]);
        assert_eq!(coverage.sampling_m, [8.0, 20.0, f64::INFINITY]);
        assert_eq!((coverage.incidence_deg[0], coverage.emission_deg[0]), ([30.0, 60.0], [10.0, 50.0]));
        // 0.75 x 1 + 0.25 x 2 of 8; all of the first two.
        assert_eq!(coverage.seen(&area_m2), SurfaceShare { at_least: 1.25 / 8.0, at_most: 3.0 / 8.0 });
        let within: Vec<_> = coverage.within(&area_m2).collect();
        assert_eq!(within[0], (10.0, SurfaceShare { at_least: 0.5 / 8.0, at_most: 1.0 / 8.0 }));
        assert_eq!(within[1], (20.0, SurfaceShare { at_least: 1.25 / 8.0, at_most: 3.0 / 8.0 }));
        let mut backwards = Coverage::new(3, rule.clone());
        looks.iter().rev().for_each(|look| backwards.add(look));
        assert_eq!(backwards, coverage);
        // In the dark too, but not from the side.
        let mut warm = Coverage::new(
            3,
            CoverageRule { in_sunlight: false, most_emission_deg: 20.0, most_incidence_deg: 180.0, ..rule },
        );
        looks.iter().for_each(|look| warm.add(look));
        assert_eq!(warm.sights, [1, 1, 1]);
    }

    #[test]
    fn what_cannot_be_is_said() {
        let mut sights = of(&[sight(2, 1.0, 0.5, 8.0, [30.0, 10.0])]);
        assert!(sights.validate(2).unwrap_err().contains("facet 2 of 2"));
        sights.sunlit[0] = 1.5;
        assert!(sights.validate(4).unwrap_err().contains("cannot be"));
        sights.sunlit.clear();
        assert!(sights.validate(4).unwrap_err().contains("1 facets, but 0 values"));
    }
}
