//! Which bands of a file with channels by name are an image: renderers put coverage, depth, previews and other passes beside it.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::spelling;

use super::names::{self, Order};

/// Channels that belong together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layer {
    /// What stands before the last dot of their names; empty for most.
    name: String,
    /// Bands, in order.
    bands: Vec<usize>,
    /// The band that is their coverage.
    alpha: Option<usize>,
    /// What orders them; `None` if nothing does.
    order: Option<Order>,
    /// Whether all names give wavelengths.
    is_spectral: bool,
}

/// What of a file is an image.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chosen {
    pub(super) bands: Vec<usize>,
    pub(super) alpha: Option<usize>,
}

/// At most this many names are reported.
const TOLD: usize = 30;

/// Names of layers whose wavelengths are those of several quantities: components of polarised light, transmittance.
const QUANTITIES: [&str; 5] = ["S0", "S1", "S2", "S3", "T"];

/// The order in which the channels of these names become bands, and what belongs together, as numbers of bands. `fit` says whether
/// two channels show the same part of the image: layers of one wavelength each that do are one image.
pub(super) fn of(channels: &[&str], fit: impl Fn(usize, usize) -> bool) -> (Vec<usize>, Vec<Layer>) {
    let is_alpha =
        |i: usize| channels.len() > 1 && names::is_alpha(channels[i]) && names::wavelength(channels[i]).is_none();
    // The spectral channels of a layer are an image, and so are the others.
    let key = |i: usize| (names::layer(channels[i]), names::wavelength(channels[i]).is_some());
    // In the order in which the first of each comes.
    let mut groups: Vec<((&str, bool), Vec<usize>)> = Vec::new();
    let mut group_of: BTreeMap<(&str, bool), usize> = BTreeMap::new();
    for i in (0..channels.len()).filter(|i| !is_alpha(*i)) {
        let group = *group_of.entry(key(i)).or_insert(groups.len());
        if group == groups.len() {
            groups.push((key(i), vec![]));
        }
        groups[group].1.push(i);
    }
    let alphas: Vec<usize> = (0..channels.len()).filter(|i| is_alpha(*i)).collect();
    let spectral: Vec<&((&str, bool), Vec<usize>)> = groups.iter().filter(|group| group.0.1).collect();
    let ones: Vec<usize> = spectral.iter().filter(|group| group.1.len() == 1).map(|group| group.1[0]).collect();
    let mut um: Vec<f64> = ones.iter().filter_map(|i| Some(names::wavelength(channels[*i])?.centre_um)).collect();
    um.sort_by(f64::total_cmp);
    let are_one_image = ones.len() > 1
        && ones.len() == spectral.len()
        && um.windows(2).all(|pair| pair[0] < pair[1])
        && spectral.iter().all(|((name, _), _)| !QUANTITIES.contains(&name.rsplit('.').next().unwrap_or(name)))
        && alphas.iter().all(|i| names::layer(channels[*i]).is_empty())
        && ones.iter().all(|i| fit(ones[0], *i));
    if are_one_image {
        groups.retain(|group| !group.0.1);
        groups.push((("", true), ones));
    }
    let mut order = Vec::new();
    let mut layers = Vec::new();
    for ((name, is_spectral), members) in groups {
        let (auxiliary, others): (Vec<usize>, Vec<usize>) =
            members.iter().copied().partition(|i| names::is_auxiliary(channels[*i]));
        let is_axes = members.iter().any(|i| ["x", "y"].contains(&names::base(channels[*i]).to_lowercase().as_str()));
        let (shown, rest) = if others.is_empty() || is_axes { (members, vec![]) } else { (others, auxiliary) };
        let texts: Vec<&str> = shown.iter().map(|i| channels[*i]).collect();
        let (by, sorted) =
            names::order(&texts).map_or((None, (0..shown.len()).collect()), |(by, sorted)| (Some(by), sorted));
        let first = order.len();
        order.extend(sorted.iter().map(|i| shown[*i]));
        layers.push(Layer {
            name: name.to_owned(),
            bands: (first..order.len()).collect(),
            alpha: None,
            order: by,
            is_spectral,
        });
        order.extend(rest);
    }
    // Coverage is that of its own layer, or of the whole image.
    let mut alpha_of: BTreeMap<&str, usize> = BTreeMap::new();
    for (k, i) in alphas.iter().enumerate() {
        alpha_of.entry(names::layer(channels[*i])).or_insert(order.len() + k);
    }
    order.extend(&alphas);
    for layer in &mut layers {
        layer.alpha = alpha_of.get(layer.name.as_str()).or_else(|| alpha_of.get("")).copied();
    }
    (order, layers)
}

/// The image in a file: what is asked for by name, or the layer that is clearly meant: a spectral one, one of colours, the only one.
///
/// # Errors
/// A message and a help.
pub(super) fn choose(
    layers: &[Layer],
    all: &[&str],
    wanted: Option<&[String]>,
) -> std::result::Result<Chosen, (String, String)> {
    let list = |names: &mut dyn Iterator<Item = &str>| -> String {
        let names: Vec<&str> = names.collect();
        let more = if names.len() > TOLD { ", ..." } else { "" };
        names.iter().take(TOLD).map(|n| format!("{n:?}")).collect::<Vec<_>>().join(", ") + more
    };
    let channels = || list(&mut all.iter().copied());
    if let Some(wanted) = wanted {
        let bands = wanted.iter().map(|name| named(all, name)).collect::<std::result::Result<Vec<usize>, _>>()?;
        let mut there = BTreeSet::new();
        if let Some(i) = bands.iter().position(|band| !there.insert(*band)) {
            return Err((format!("names {:?} twice", wanted[i]), "each channel is a band".into()));
        }
        // Coverage of all of them, unless it is a band itself.
        let mut alpha_of = vec![None; all.len()];
        for layer in layers {
            layer.bands.iter().for_each(|band| alpha_of[*band] = layer.alpha);
        }
        let alpha = bands.first().and_then(|band| alpha_of[*band]);
        let alpha = alpha.filter(|alpha| bands.iter().all(|b| alpha_of[*b] == Some(*alpha)) && !there.contains(alpha));
        return Ok(Chosen { bands, alpha });
    }
    if layers.is_empty() {
        return Ok(Chosen { bands: (0..all.len()).collect(), alpha: None });
    }
    // Of the best kind: the only one, the total of polarised light, or what is in no layer.
    let rank = |layer: &Layer| if layer.is_spectral { 0 } else { 1 + u8::from(layer.order != Some(Order::Colour)) };
    let best = layers.iter().map(rank).min().unwrap_or(0);
    let of_best: Vec<&Layer> = layers.iter().filter(|layer| rank(layer) == best).collect();
    let taken = match of_best[..] {
        [one] => (best < 2 || layers.len() == 1).then_some(one),
        _ if best == 2 => None,
        _ => {
            let is_stokes = of_best.iter().all(|l| ["S0", "S1", "S2", "S3"].contains(&l.name.as_str()));
            let main = if is_stokes { "S0" } else { "" };
            of_best.into_iter().find(|layer| layer.name == main)
        }
    };
    let taken = taken.filter(|layer| layer.order.is_some());
    let Some(layer) = taken else {
        let message = match layers {
            [_] => {
                format!("does not say which of its channels comes first: OpenEXR sorts names as text: {}", channels())
            }
            _ => format!("does not say which of its channels are the image: {}", channels()),
        };
        let example: Vec<&str> = layers[0].bands.iter().take(3).map(|b| all[*b]).collect();
        return Err((message, format!("name them in the order of the bands: `channels = {example:?}`")));
    };
    Ok(Chosen { bands: layer.bands.clone(), alpha: layer.alpha })
}

/// The band of a name: its whole name, or what of it no other has.
fn named(all: &[&str], name: &str) -> std::result::Result<usize, (String, String)> {
    let only = |is: &dyn Fn(&str) -> bool| {
        let mut found = (0..all.len()).filter(|i| is(all[*i]));
        found.next().filter(|_| found.next().is_none())
    };
    only(&|other| other == name)
        .or_else(|| only(&|other| other.eq_ignore_ascii_case(name)))
        .or_else(|| only(&|other| names::base(other).eq_ignore_ascii_case(name)))
        .ok_or_else(|| {
            let help = match spelling::nearest(name, all) {
                Some(near) => format!("did you mean {near:?}?"),
                None if all.iter().all(|name| name.is_empty()) => "its bands have no names".into(),
                None => {
                    let names: Vec<String> = all.iter().take(TOLD).map(|name| format!("{name:?}")).collect();
                    format!("it has {}", names.join(", "))
                }
            };
            (format!("{name:?} is not a channel of the raster, or of several"), help)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names in the order of bands; what is taken; its coverage.
    fn taken(channels: &[&str], wanted: Option<&[&str]>) -> std::result::Result<(Vec<String>, Option<String>), String> {
        let mut channels = channels.to_vec();
        channels.sort_unstable();
        let (order, layers) = of(&channels, |_, _| true);
        let all: Vec<&str> = order.iter().map(|i| channels[*i]).collect();
        assert_eq!(all.len(), channels.len());
        let wanted: Option<Vec<String>> = wanted.map(|names| names.iter().map(|n| (*n).to_owned()).collect());
        let chosen = choose(&layers, &all, wanted.as_deref()).map_err(|(message, _)| message)?;
        let name = |band: usize| all[band].to_owned();
        Ok((chosen.bands.into_iter().map(name).collect(), chosen.alpha.map(name)))
    }

    fn image(names: &[&str], alpha: Option<&str>) -> std::result::Result<(Vec<String>, Option<String>), String> {
        Ok((names.iter().map(|n| (*n).to_owned()).collect(), alpha.map(str::to_owned)))
    }

    #[test]
    fn the_image_is_found_among_what_renderers_write() {
        assert_eq!(taken(&["R", "G", "B", "A", "Z"], None), image(&["R", "G", "B"], Some("A")));
        assert_eq!(
            taken(&["V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Combined.A", "V.Depth.Z"], None),
            image(&["V.Combined.R", "V.Combined.G", "V.Combined.B"], Some("V.Combined.A"))
        );
        // A spectral image with its preview.
        assert_eq!(
            taken(&["R", "G", "B", "S0.900,0nm", "S0.1000,0nm"], None),
            image(&["S0.900,0nm", "S0.1000,0nm"], None)
        );
        assert_eq!(taken(&["S0.500nm", "S1.500nm", "S2.500nm", "S3.500nm"], None), image(&["S0.500nm"], None));
        assert_eq!(taken(&["R", "G", "B", "nn.X", "nn.Y", "nn.Z", "dd.y"], None), image(&["R", "G", "B"], None));
        assert_eq!(taken(&["ch 10", "ch 9"], None), image(&["ch 9", "ch 10"], None));
        assert_eq!((taken(&["A"], None), taken(&["Z"], None)), (image(&["A"], None), image(&["Z"], None)));
        assert_eq!(taken(&["900nm", "1000nm", "A"], None), image(&["900nm", "1000nm"], Some("A")));
    }

    #[test]
    fn thousands_of_layers_each_with_its_coverage() {
        let names: Vec<String> = (0..10_000).flat_map(|i| [format!("l{i}.A"), format!("l{i}.R")]).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let (order, layers) = of(&names, |_, _| true);
        assert_eq!((order.len(), layers.len()), (20_000, 10_000));
        // Coverage comes last: that of the fifth layer is the fifth of them.
        assert_eq!((order[5], order[10_005], layers[5].alpha), (11, 10, Some(10_005)));
    }

    #[test]
    fn layers_of_one_wavelength_each_are_an_image() {
        assert_eq!(taken(&["a.1050nm", "b.450nm"], None), image(&["b.450nm", "a.1050nm"], None));
        assert_eq!(taken(&["a.1050nm", "b.450nm", "R", "G", "B"], None), image(&["b.450nm", "a.1050nm"], None));
        assert!(taken(&["S0.450nm", "S1.1050nm"], None).unwrap() == image(&["S0.450nm"], None).unwrap());
        for names in [&["a.450nm", "b.450nm"][..], &["a.450nm", "a.550nm", "b.650nm"], &["S0.450nm", "T.550nm"]] {
            assert!(taken(names, None).is_err(), "{names:?}");
        }
        // Parts that show other pieces of the image are not laid over one another.
        assert_eq!(of(&["a.1050nm", "b.450nm"], |_, _| false).1.len(), 2);
    }

    #[test]
    fn what_is_not_clear_is_asked_for() {
        for names in [
            &["swir", "visible"][..],
            &["left.R", "left.G", "left.B", "right.R", "right.G", "right.B"],
            &["a.X", "b.X"],
            &["S0.500nm", "T.500nm"],
            &["1000nm", "1000,0nm"],
        ] {
            let message = taken(names, None).unwrap_err();
            assert!(names.iter().all(|name| message.contains(name)), "{message}");
        }
        assert_eq!(taken(&["swir", "visible"], Some(&["visible", "SWIR"])), image(&["visible", "swir"], None));
        assert_eq!(taken(&["a.R", "a.A", "b.R"], Some(&["a.R"])), image(&["a.R"], Some("a.A")));
        assert_eq!(taken(&["V.Combined.R", "V.Depth.Z"], Some(&["z"])), image(&["V.Depth.Z"], None));
        assert!(taken(&["R", "G"], Some(&["X"])).is_err() && taken(&["R", "G"], Some(&["R", "R"])).is_err());
    }
}
