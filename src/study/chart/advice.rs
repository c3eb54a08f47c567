//! Which methods are worth their time, in a sentence.

use super::{Chart, Entry, Family};

/// Errors that advice is given for.
pub const TARGETS: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// What to use for an error of at most `target`.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// The error: of all but 1 % of the pixels, in the worst band.
    pub target: f64,
    /// In a sentence.
    pub said: String,
}

/// Marks what nothing beats in both time and error.
pub(super) fn mark_best(entries: &mut [Entry]) {
    let known: Vec<(f64, f64)> = entries.iter().map(|entry| (entry.cpu_s, entry.p99())).collect();
    for (entry, (cpu_s, error)) in entries.iter_mut().zip(known.clone()) {
        let beats =
            |&(other_s, other): &(f64, f64)| other_s <= cpu_s && other <= error && (other_s < cpu_s || other < error);
        entry.is_best = !known.iter().any(beats);
    }
}

impl Chart {
    /// For each of [`TARGETS`] what to use on this scene.
    pub fn advice(&self) -> Vec<Advice> {
        TARGETS.iter().map(|target| Advice { target: *target, said: self.advised(*target) }).collect()
    }

    fn advised(&self, target: f64) -> String {
        let full = self.truth();
        // Other programs are told less: their errors are of another kind.
        let ours = self.entries.iter().filter(|entry| entry.family != Family::Other);
        let good = ours.filter(|entry| entry.p99() <= target);
        let percent = percent_of(target);
        let cheapest = good.min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s)).unwrap_or(full);
        if cheapest.family == Family::Full {
            return format!(
                "For {percent} use the full exact method ({}): on this scene nothing that is as good is faster.",
                seconds(full.cpu_s)
            );
        }
        format!(
            "For {percent} use \"{}\": {} x faster than full ({} instead of {}); its worst pixel is off by {}.",
            cheapest.name,
            two_digits(full.cpu_s / cheapest.cpu_s),
            seconds(cheapest.cpu_s),
            seconds(full.cpu_s),
            percent_of(cheapest.errors.iter().map(|band| band.all.max).fold(0.0, f64::max))
        )
    }
}

/// A share as percent, with two digits that count.
fn percent_of(share: f64) -> String {
    format!("{} %", two_digits(100.0 * share))
}

fn seconds(s: f64) -> String {
    format!("{} CPU s", two_digits(s))
}

/// A positive number with two digits that count.
fn two_digits(x: f64) -> String {
    if !(x > 0.0 && x.is_finite()) {
        return format!("{x}");
    }
    let decimals = crate::geometry::whole((1.0 - x.log10().floor()).max(0.0));
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let told = [0.01, 0.001, 1e-4, 1.0].map(percent_of);
        assert_eq!(told, ["1 %", "0.1 %", "0.01 %", "100 %"]);
        assert_eq!([0.0123, 12.34, 1.04].map(two_digits), ["0.012", "12", "1"]);
    }
}
