//! Recipes that come with the program.

/// A recipe with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// The name.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// The recipe, as TOML.
    pub text: &'static str,
}

macro_rules! presets {
    ($($name:literal: $about:literal),* $(,)?) => {
        &[$(Preset { name: $name, about: $about, text: include_str!(concat!("presets/", $name, ".toml")) }),*]
    };
}

/// All of them: the three scenes of Domagala (2020), section II, and kinds of relief after its Figure 9.
pub const PRESETS: &[Preset] = presets! {
    "phobos-1": "many craters and boulders, a few of them of the red material",
    "phobos-2": "few craters and boulders, the red material in a few craters",
    "phobos-3": "many craters, boulders and a big structure with steep flanks, partly red",
    "rugged": "rugged ground with sharp crests",
    "many-craters": "craters up to saturation",
    "few-craters": "rolling ground with a few craters",
    "dunes": "rugged dunes",
    "highland": "old ground of overlapping large craters, as on the Moon's highlands",
    "mare": "smooth ground with scattered craters and a wrinkle ridge, as on the Moon's maria",
    "groove": "Phobos' grooves: rows of pits in cratered ground",
    "rim": "the rim of a crater that is larger than the site",
    "photo": "ground as from an image that is taken for heights: patches and speckles",
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::Recipe;

    #[test]
    fn presets_can_be_made() {
        assert_eq!(PRESETS.len(), 12);
        for preset in PRESETS {
            let recipe: Recipe = toml::from_str(preset.text).unwrap_or_else(|e| panic!("{}: {e}", preset.name));
            assert_eq!(recipe.check(), [], "{}", preset.name);
            assert_eq!(recipe.files(), [], "{}: a preset needs no file", preset.name);
        }
    }
}
