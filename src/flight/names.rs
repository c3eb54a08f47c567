//! Names of bodies and frames: one canonical name each, whatever a file calls it.

/// Numbers and names of bodies, as in SPICE: the planets, what flies about Mars, and whatever else has a rotation by the IAU.
#[rustfmt::skip]
const BODIES: [(i32, &str); 88] = [
    (0, "SOLAR SYSTEM BARYCENTER"),
    (1, "MERCURY BARYCENTER"),
    (2, "VENUS BARYCENTER"),
    (3, "EARTH BARYCENTER"),
    (4, "MARS BARYCENTER"),
    (5, "JUPITER BARYCENTER"),
    (6, "SATURN BARYCENTER"),
    (7, "URANUS BARYCENTER"),
    (8, "NEPTUNE BARYCENTER"),
    (9, "PLUTO BARYCENTER"),
    (10, "SUN"),
    (199, "MERCURY"),
    (299, "VENUS"),
    (301, "MOON"),
    (399, "EARTH"),
    (401, "PHOBOS"),
    (402, "DEIMOS"),
    (499, "MARS"),
    (599, "JUPITER"),
    (699, "SATURN"),
    (799, "URANUS"),
    (899, "NEPTUNE"),
    (999, "PLUTO"),
    (-239, "MMX"),
    (-41, "MARS EXPRESS"),
    (-74, "MARS RECON ORBITER"),
    (501, "IO"), (502, "EUROPA"), (503, "GANYMEDE"), (504, "CALLISTO"), (505, "AMALTHEA"), (514, "THEBE"), (515, "ADRASTEA"),
    (516, "METIS"), (601, "MIMAS"), (602, "ENCELADUS"), (603, "TETHYS"), (604, "DIONE"), (605, "RHEA"), (606, "TITAN"), (608, "IAPETUS"),
    (609, "PHOEBE"), (610, "JANUS"), (611, "EPIMETHEUS"), (612, "HELENE"), (613, "TELESTO"), (614, "CALYPSO"), (615, "ATLAS"),
    (616, "PROMETHEUS"), (617, "PANDORA"), (618, "PAN"), (701, "ARIEL"), (702, "UMBRIEL"), (703, "TITANIA"), (704, "OBERON"),
    (705, "MIRANDA"), (706, "CORDELIA"), (707, "OPHELIA"), (708, "BIANCA"), (709, "CRESSIDA"), (710, "DESDEMONA"), (711, "JULIET"),
    (712, "PORTIA"), (713, "ROSALIND"), (714, "BELINDA"), (715, "PUCK"), (801, "TRITON"), (803, "NAIAD"), (804, "THALASSA"),
    (805, "DESPINA"), (806, "GALATEA"), (807, "LARISSA"), (808, "PROTEUS"), (901, "CHARON"), (1000005, "BORRELLY"),
    (1000012, "CHURYUMOV-GERASIMENKO"), (1000093, "TEMPEL 1"), (2000001, "CERES"), (2000002, "PALLAS"), (2000004, "VESTA"),
    (2000021, "LUTETIA"), (2000052, "52 EUROPA"), (2000433, "EROS"), (2000511, "DAVIDA"), (2002867, "STEINS"), (2025143, "ITOKAWA"),
    (2431010, "IDA"), (9511010, "GASPRA"),
];

/// Other names of the same.
const ALIASES: [(&str, &str); 10] = [
    ("SSB", "SOLAR SYSTEM BARYCENTER"),
    ("SOLAR_SYSTEM_BARYCENTER", "SOLAR SYSTEM BARYCENTER"),
    ("MARS_BARYCENTER", "MARS BARYCENTER"),
    ("EMB", "EARTH BARYCENTER"),
    ("EARTH MOON BARYCENTER", "EARTH BARYCENTER"),
    ("EARTH-MOON BARYCENTER", "EARTH BARYCENTER"),
    ("MARTIAN MOONS EXPLORATION", "MMX"),
    ("MRO", "MARS RECON ORBITER"),
    ("MARS RECONNAISSANCE ORBITER", "MARS RECON ORBITER"),
    ("MEX", "MARS EXPRESS"),
];

/// The canonical name of a body that a file gives by NAIF number or by name in any case; an unknown one is its own name
/// in capitals.
pub fn body_name(called: &str) -> String {
    Names::default().body(called)
}

/// The number of a body in SPICE, if it has one here.
pub fn body_id(name: &str) -> Option<i32> {
    BODIES.iter().find(|(_, of)| *of == name).map(|(id, _)| *id).or_else(|| name.parse().ok())
}

/// Names of bodies from files; they override the built-in ones.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Names {
    /// Number and name, in capitals, in the order in which they were given.
    given: Vec<(i32, String)>,
}

impl Names {
    /// Adds names for numbers; where two conflict, the later one is used.
    pub fn new(given: impl IntoIterator<Item = (i32, String)>) -> Self {
        Names { given: given.into_iter().map(|(id, name)| (id, plain(&name))).collect() }
    }

    /// The canonical name of a body, as [`body_name`], with the names from files.
    pub fn body(&self, called: &str) -> String {
        let plain = plain(called);
        match plain.parse().ok().or_else(|| self.given_id(&plain)) {
            Some(id) => self.name_of(id),
            None => ALIASES.iter().find(|(alias, _)| *alias == plain).map_or(plain, |(_, name)| (*name).to_owned()),
        }
    }

    /// The number of a body by its canonical name, if it has one.
    pub fn id(&self, name: &str) -> Option<i32> {
        self.given_id(name).or_else(|| body_id(name))
    }

    fn given_id(&self, plain: &str) -> Option<i32> {
        self.given.iter().rev().find(|(_, name)| name == plain).map(|(id, _)| *id)
    }

    /// The built-in name, unless a file gave it to another body; else the one given last; else the number.
    fn name_of(&self, id: i32) -> String {
        let known = BODIES.iter().find(|(of, name)| *of == id && self.given_id(name).is_none_or(|given| given == id));
        let given = || self.given.iter().rev().find(|(of, name)| *of == id && self.given_id(name) == Some(id));
        match known {
            Some((_, name)) => (*name).to_owned(),
            None => given().map_or_else(|| id.to_string(), |(_, name)| name.clone()),
        }
    }
}

/// In capitals, with one blank between words.
fn plain(called: &str) -> String {
    called.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase()
}

/// The canonical name of a frame. EME2000, ICRF and GCRF are J2000: as in SPICE, the 0.02 arcsec between them are
/// neglected.
pub fn frame_name(called: &str) -> String {
    let plain = plain(called);
    match plain.as_str() {
        "EME2000" | "ICRF" | "GCRF" | "ICRF1" | "ICRF2" | "ICRF3" | "MEE2000" => super::J2000.to_owned(),
        "ECLIPTIC J2000" | "ECLIPTICJ2000" => super::ECLIPTIC.to_owned(),
        _ => plain,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_has_one_name() {
        assert_eq!(body_name("401"), "PHOBOS");
        assert_eq!(body_name(" phobos "), "PHOBOS");
        assert_eq!(body_name("Mars  Barycenter"), "MARS BARYCENTER");
        assert_eq!(body_name("-999"), "-999");
        assert_eq!(body_id("PHOBOS"), Some(401));
        assert_eq!(body_id("-999"), Some(-999));
        assert_eq!(frame_name("EME2000"), frame_name("J2000"));
    }

    #[test]
    fn names_that_files_give_stand_before() {
        let names = [(-999, "probe"), (-999, "Probe  B"), (401, "FEAR"), (-5, "DEIMOS")];
        let names = Names::new(names.map(|(id, name)| (id, name.to_owned())));
        assert_eq!(names.body("-999"), "PROBE B");
        assert_eq!(names.body("Probe"), "PROBE B");
        assert_eq!(names.body("fear"), "PHOBOS", "files without it call it so");
        assert_eq!(names.body("deimos"), "DEIMOS");
        assert_eq!(names.body("-5"), "DEIMOS");
        assert_eq!(names.body("402"), "402", "its name is another's");
        assert_eq!(names.id("DEIMOS"), Some(-5));
    }
}
