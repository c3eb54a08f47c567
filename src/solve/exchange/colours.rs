//! The colours that light takes on its way from facet to facet: a source's spectrum, times the reflectances of what it met.

use crate::geometry::MaterialId;

/// Light of one spectrum.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Colour {
    /// The source, by its place in the list.
    pub(super) source: usize,
    /// The materials whose reflectances are in the spectrum, ascending.
    pub(super) by: Vec<MaterialId>,
}

/// All colours, bounce by bounce. Which surface came first makes no difference.
///
/// Their number grows with every bounce. After the last that is told apart, light keeps its colour, and a surface takes its grey albedo's share.
#[derive(Debug)]
pub(super) struct Colours {
    /// Those of light that has been reflected so many times; the first are the sources' own.
    levels: Vec<Vec<Colour>>,
    /// The albedo of each material where its colour is not kept.
    grey: Vec<f64>,
}

/// What becomes of light of some colours when surfaces reflect it.
#[derive(Debug)]
pub(super) struct Bounce {
    /// How many colours there were before, and how many there are after it.
    pub(super) before: usize,
    pub(super) after: usize,
    /// [material, colour before]: the colour after it, and by what it is multiplied.
    pub(super) becomes: Vec<(usize, f64)>,
}

impl Colours {
    /// Of some sources and of materials with these grey albedos; at most so many colours are told apart, or else those of the sources.
    pub(super) fn new(sources: usize, grey: Vec<f64>, most: usize, bounces: u32) -> Self {
        let own = |source| Colour { source, by: vec![] };
        let mut levels: Vec<Vec<Colour>> = vec![(0..sources).map(own).collect()];
        let mut all = 0;
        while levels.len() <= bounces as usize {
            let next = reflected(&levels[levels.len() - 1], grey.len());
            all += next.len();
            if all > most || next.is_empty() {
                break;
            }
            levels.push(next);
        }
        Colours { levels, grey }
    }

    /// How many times light may be reflected until its colour is kept.
    pub(super) fn told_apart(&self) -> usize {
        self.levels.len() - 1
    }

    /// Colours of light after a bounce, from 1.
    pub(super) fn after(&self, bounce: usize) -> &[Colour] {
        &self.levels[bounce.min(self.told_apart())]
    }

    /// What a bounce does, from 1.
    pub(super) fn bounce(&self, bounce: usize) -> Bounce {
        let (before, after) = (self.after(bounce - 1), self.after(bounce));
        let is_told_apart = bounce <= self.told_apart();
        let becomes = |(material, grey): (usize, &f64)| -> Vec<(usize, f64)> {
            let of = |(c, colour): (usize, &Colour)| match is_told_apart {
                true => (after.iter().position(|after| *after == colour.reflected_by(material)).unwrap_or(c), 1.0),
                false => (c, *grey),
            };
            before.iter().enumerate().map(of).collect()
        };
        let becomes = self.grey.iter().enumerate().flat_map(becomes).collect();
        Bounce { before: before.len(), after: after.len(), becomes }
    }
}

impl Colour {
    fn reflected_by(&self, material: usize) -> Colour {
        let mut by = self.by.clone();
        by.push(MaterialId(u16::try_from(material).unwrap_or(u16::MAX)));
        by.sort_unstable();
        Colour { source: self.source, by }
    }
}

/// The colours after one more bounce.
fn reflected(before: &[Colour], materials: usize) -> Vec<Colour> {
    let mut after: Vec<Colour> = Vec::new();
    for colour in before {
        for material in 0..materials {
            let colour = colour.reflected_by(material);
            if !after.contains(&colour) {
                after.push(colour);
            }
        }
    }
    after
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_surfaces_makes_no_difference() {
        // Two materials: 2, 3 and 4 products; three of them are told apart below 10.
        let colours = Colours::new(1, vec![0.1, 0.2], 9, 5);
        assert_eq!(colours.told_apart(), 3);
        assert_eq!((1..=3).map(|n| colours.after(n).len()).collect::<Vec<_>>(), [2, 3, 4]);
        let second = colours.bounce(2);
        let named = |(c, _): &(usize, f64)| colours.after(2)[*c].by.iter().map(|m| m.0).collect::<Vec<_>>();
        // [material, colour before].
        let by: Vec<Vec<u16>> = second.becomes.iter().map(named).collect();
        assert_eq!(by, [vec![0, 0], vec![0, 1], vec![0, 1], vec![1, 1]]);
        assert!(second.becomes.iter().all(|(_, factor)| *factor == 1.0));
        // Then light keeps its colour.
        let fourth = colours.bounce(4);
        assert_eq!((fourth.before, fourth.after), (4, 4));
        let kept: Vec<(usize, f64)> = (0..4).map(|c| (c, 0.1)).chain((0..4).map(|c| (c, 0.2))).collect();
        assert_eq!(fourth.becomes, kept);
    }

    #[test]
    fn with_very_many_materials_light_keeps_the_colour_of_its_source() {
        let colours = Colours::new(2, vec![0.07; 50], 32, 3);
        assert_eq!((colours.told_apart(), colours.after(1).len()), (0, 2));
        assert_eq!(colours.bounce(1).becomes[99], (1, 0.07));
    }
}
