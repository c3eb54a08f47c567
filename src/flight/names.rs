//! Names of bodies and frames: each has one, whatever a file calls it.

/// Numbers and names of bodies, as in SPICE.
const BODIES: [(i32, &str); 26] = [
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
    (-3, "MMX"),
    (-41, "MARS EXPRESS"),
    (-74, "MARS RECON ORBITER"),
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

/// The one name of a body that a file calls by a number of SPICE, or by some name in small or capital letters; one that is not known is
/// its own name in capitals.
pub fn body_name(called: &str) -> String {
    let plain = called.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
    if let Some((_, name)) = plain.parse::<i32>().ok().and_then(|id| BODIES.iter().find(|(of, _)| *of == id)) {
        return (*name).to_owned();
    }
    ALIASES.iter().find(|(alias, _)| *alias == plain).map_or(plain, |(_, name)| (*name).to_owned())
}

/// The number of a body in SPICE, if it has one here.
pub fn body_id(name: &str) -> Option<i32> {
    BODIES.iter().find(|(_, of)| *of == name).map(|(id, _)| *id).or_else(|| name.parse().ok())
}

/// The one name of a frame. EME2000, ICRF and GCRF are J2000: as in SPICE, the 0.02 arcsec between them are left out.
pub fn frame_name(called: &str) -> String {
    let plain = called.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
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
}
