//! directions.xml: the Sun, and directions in which images are asked for.

use crate::error::Location;
use crate::formats::xml::Element;
use crate::report::Fate;

use super::super::frame::{self, full_turn};
use super::super::{Directions, Maket};
use super::reading::Reading;

pub(super) fn read(directions: &Element, maket: &Maket, reading: &mut Reading) -> Directions {
    let (sun_deg, at) = sun(directions, maket, reading);
    let mut views_deg = Vec::new();
    for view in directions.all("AddedDirections") {
        let Some(angles) = view.child("ZenithAzimuth").filter(|_| reading.integer_or(view, "directionType", 0) == 0)
        else {
            let message = "a direction by the place of a satellite: give it as zenith angle and azimuth";
            reading.note(Fate::Dropped, view.at(), message);
            continue;
        };
        let has_image = view.get("imageDirection").is_none() || reading.flag(view, "imageDirection");
        if has_image && !reading.flag(view, "ifPhaseOnly") {
            let zenith = reading.number(angles, "directionZenithalAngle");
            let azimuth = reading.number(angles, "directionAzimuthalAngle");
            if !(0.0..=180.0).contains(&zenith) {
                reading
                    .problem(angles.at_attribute("directionZenithalAngle"), format!("a zenith angle of {zenith} deg"));
            }
            views_deg.push([zenith, full_turn(azimuth)]);
        } else {
            reading.note(Fate::Dropped, view.at(), "a direction without an image");
        }
    }
    Directions { sun_deg, views_deg, at }
}

/// Zenith angle and azimuth of the Sun as seen from the ground, deg, and where they stand.
fn sun(directions: &Element, maket: &Maket, reading: &mut Reading) -> ([f64; 2], Location) {
    let mode = reading.integer_or(directions, "exactDate", 2);
    let name = match mode {
        0 => "Sun",
        1 => "ExactDateHour",
        2 => "SunViewingAngles",
        _ => {
            let message = format!(
                "`exactDate` is {mode}: known are 0 (downward angles), 1 (a date) and 2 (angles from the ground)"
            );
            reading.problem(directions.at_attribute("exactDate"), message);
            return ([0.0, 0.0], directions.at());
        }
    };
    let Some(element) = reading.child(directions, name) else { return ([0.0, 0.0], directions.at()) };
    let offset = directions.child("AzimuthalOffset").map_or(0.0, |o| match o.get("sunAzimuthalOffset") {
        Some(_) => reading.number_or(o, "sunAzimuthalOffset", 0.0),
        None => 0.0,
    });
    if offset != 0.0 && mode != 1 {
        let message =
            "an offset of the Sun's azimuth: taken to turn a Sun by date only, as angles are given as they are meant";
        reading.note(Fate::Approximated, directions.at(), message);
    }
    let angles = match mode {
        1 => return (by_date(element, maket, offset, reading), element.at()),
        0 => {
            // The way light travels: from the Sun, downwards.
            let zenith = reading.number(element, "sunZenithAngle");
            let azimuth = reading.number(element, "sunAzimuthAngle");
            frame::reversed([zenith, full_turn(azimuth)])
        }
        _ => {
            let zenith = reading.number(element, "sunViewingZenithAngle");
            let azimuth = reading.number(element, "sunViewingAzimuthAngle");
            [zenith, full_turn(azimuth)]
        }
    };
    if !(0.0..=90.0).contains(&angles[0]) {
        let (attribute, range) = match mode {
            0 => ("sunZenithAngle", "90 to 180: it is that of light travelling downwards"),
            _ => ("sunViewingZenithAngle", "0 to 90: the Sun stands above the ground"),
        };
        let message = format!("the Sun's zenith angle lies in {range}");
        reading.problem(element.at_attribute(attribute), message);
    }
    if element.get("dayOfTheYear").is_some_and(|day| day.trim() != "-1") {
        let message = "a day of the year: DART scales sunlight to the Earth's distance on it; the distance is that of the scene here";
        reading.note(Fate::Dropped, element.at_attribute("dayOfTheYear"), message);
    }
    (angles, element.at())
}

/// The Sun at a place and time on the Earth, as seen from the ground: zenith angle, and azimuth from South over East, deg.
///
/// Mean elements of the Sun's orbit as in the Astronomical Almanac's low precision formulae (page C24; 0.01 deg from
/// 1950 to 2050), without refraction and parallax.
fn by_date(date: &Element, maket: &Maket, offset_deg: f64, reading: &mut Reading) -> [f64; 2] {
    if let Some([zenith, azimuth]) = reading.options.sun_deg {
        return [zenith, full_turn(azimuth)];
    }
    let [year, month, day, hour] = ["year", "month", "day", "hour"].map(|name| f64::from(reading.integer(date, name)));
    let [minute, second] = ["minute", "second"].map(|name| f64::from(reading.integer_or(date, name, 0)));
    for (name, value, first, last) in [
        ("month", month, 1.0, 12.0),
        ("day", day, 1.0, 31.0),
        ("hour", hour, 0.0, 24.0),
        ("year", year, 1900.0, 2100.0),
    ] {
        if !(first..=last).contains(&value) {
            reading.problem(date.at_attribute(name), format!("`{name}` is {value}: {first} to {last} belongs here"));
        }
    }
    let mut hours = hour + minute / 60.0 + second / 3600.0;
    if reading.flag(date, "localTime") {
        let summer = f64::from(u8::from(reading.flag(date, "daylightSavingTime")));
        hours -= reading.number_or(date, "timezone", 0.0) + summer;
    }
    // Days since J2000.0, by the day number of the Gregorian calendar (Fliegel and Van Flandern 1968, valid 1901 to 2099).
    let day_number = 367.0 * year - (7.0 * (year + ((month + 9.0) / 12.0).floor()) / 4.0).floor()
        + (275.0 * month / 9.0).floor()
        + day
        - 730_531.5;
    let days = day_number + hours / 24.0;
    let mean_longitude = 280.460 + 0.985_647_4 * days;
    let anomaly = (357.528 + 0.985_600_3 * days).to_radians();
    let longitude = (mean_longitude + 1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
    let obliquity = (23.439 - 4e-7 * days).to_radians();
    let right_ascension = (obliquity.cos() * longitude.sin()).atan2(longitude.cos());
    let declination = (obliquity.sin() * longitude.sin()).asin();
    let [latitude, east, _] = maket.latitude_longitude_altitude.map(f64::to_radians);
    // Greenwich mean sidereal time.
    let sidereal = (280.460_618_37 + 360.985_647_366_29 * days).to_radians();
    let hour_angle = sidereal + east - right_ascension;
    // Components towards the south, east and zenith.
    let south = latitude.sin() * declination.cos() * hour_angle.cos() - latitude.cos() * declination.sin();
    let to_east = -declination.cos() * hour_angle.sin();
    let up = latitude.sin() * declination.sin() + latitude.cos() * declination.cos() * hour_angle.cos();
    let angles = [up.clamp(-1.0, 1.0).acos().to_degrees(), full_turn(to_east.atan2(south).to_degrees() + offset_deg)];
    let message = format!(
        "the Sun by a date on the Earth: zenith angle {:.3}, azimuth {:.3} deg, to some 0.02 deg. \
         Give the angles that are meant, or those that DART prints, to have them exactly",
        angles[0], angles[1]
    );
    let south = format!(
        ". South of the equator DART is said to count azimuths from North, which is not confirmed: it would be {:.3} deg there",
        full_turn(angles[1] + 180.0)
    );
    reading.note(Fate::Approximated, date.at(), message + if latitude < 0.0 { &south } else { "" });
    if angles[0] > 90.0 {
        reading.problem(date.at(), "the Sun is below the horizon on this date");
    }
    angles
}
