//! Which effects are computed: the full model, and others to compare with it.

use crate::physics::sun_disc::DiscRule;
use crate::scene::{MarsModel, Models, Setup, SunModel, Thermal};

/// Everything that the scene asks for, and at least heat, Mars near at hand, and the Sun as a disc.
pub(super) fn full(setup: Setup) -> Setup {
    // A scene without heat may lack what heat needs.
    let thermal = if setup.models.thermal == Thermal::Off { Thermal::Off } else { Thermal::Equilibrium };
    let models =
        Models { thermal, mars_light: MarsModel::NearField, sun: SunModel::Disc(DiscRule::E37), ..setup.models };
    Setup { models, ..setup }
}

/// Fewer or other models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// Those of Domagala (2020): equations (4) to (9) as printed.
    Thesis,
    /// Without Mars.
    WithoutMars,
    /// Sunlight that the surface reflects, and nothing else.
    SunlightAlone,
}

impl Choice {
    pub(super) fn all() -> [Choice; 3] {
        [Choice::SunlightAlone, Choice::WithoutMars, Choice::Thesis]
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Choice::Thesis => "Mars and heat as in the thesis",
            Choice::WithoutMars => "without Mars",
            Choice::SunlightAlone => "point sunlight alone",
        }
    }

    pub(super) fn model(self) -> &'static str {
        match self {
            Choice::Thesis => "thesis",
            Choice::WithoutMars => "no Mars",
            Choice::SunlightAlone => "sunlight",
        }
    }

    pub(super) fn account(self) -> &'static str {
        match self {
            Choice::Thesis => {
                "Exact geometry, a point Sun; Mars lights every facet alike, and temperature is linear in sunlight: Domagala (2020), equations (4) to (9)."
            }
            Choice::WithoutMars => {
                "Exact geometry; neither light nor heat from Mars: shadows are black in reflected light."
            }
            Choice::SunlightAlone => {
                "Exact geometry; reflected light of a point Sun, without Mars and without the surface's own heat."
            }
        }
    }

    pub(super) fn of(self, setup: Setup) -> Setup {
        let mut setup = full(setup);
        match self {
            Choice::Thesis => {
                if setup.models.thermal != Thermal::Off {
                    setup.models.thermal = Thermal::Thesis;
                }
                setup.models.mars_light = MarsModel::Thesis;
                setup.models.sun = SunModel::Point;
            }
            Choice::WithoutMars => setup.sky.mars = None,
            Choice::SunlightAlone => {
                setup.sky.mars = None;
                setup.models.thermal = Thermal::Off;
                setup.models.sun = SunModel::Point;
            }
        }
        setup
    }
}
