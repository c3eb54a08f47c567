//! Which methods are worth their time, in sentences.

use super::{Chart, Entry, Family, Question};

/// Errors that advice is given for.
pub const TARGETS: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// The one that matters most.
const MAIN: f64 = 1e-3;
/// A coarser mesh is worth a word if it is as near as this.
const COARSE: f64 = 1e-2;

/// What to use.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// In a sentence.
    pub said: String,
    /// Whether it is the one that most will want.
    pub is_main: bool,
}

/// Marks what nothing beats in both time and error, of each question by itself.
pub(super) fn mark_best(entries: &mut [Entry]) {
    let known: Vec<(Question, f64, f64)> =
        entries.iter().map(|entry| (entry.family.question(), entry.cpu_s, entry.p99())).collect();
    for (entry, (question, cpu_s, error)) in entries.iter_mut().zip(known.clone()) {
        let beats = |&(of, other_s, other): &(Question, f64, f64)| {
            of == question && other_s <= cpu_s && other <= error && (other_s < cpu_s || other < error)
        };
        entry.is_best = !known.iter().any(beats);
    }
}

impl Chart {
    /// What to use on this scene: which effects for each of [`TARGETS`], and what sampling and coarser meshes come to.
    pub fn advice(&self) -> Vec<Advice> {
        if self
            .entries
            .iter()
            .filter(|entry| is_truth(entry))
            .all(|entry| entry.image.iter().flatten().all(|l| *l == 0.0))
        {
            let said = "The camera sees no light at all: there is nothing to compare.".to_owned();
            return vec![Advice { said, is_main: true }];
        }
        let is_good = |target: &&f64| self.plan_for(**target).is_some();
        let (good, missed): (Vec<&f64>, Vec<&f64>) = TARGETS.iter().partition(is_good);
        let effects = good.iter().filter_map(|target| {
            Some(Advice { said: self.effects_for(**target, self.plan_for(**target)?), is_main: **target == MAIN })
        });
        let missed = (!missed.is_empty())
            .then(|| Advice { said: self.missed(&missed), is_main: missed.iter().any(|target| **target == MAIN) });
        let effects = effects.chain(missed);
        let more = [self.about_rays(), self.about_meshes()].into_iter().flatten();
        effects.chain(more.map(|said| Advice { said, is_main: false })).collect()
    }

    /// The fastest plan that is as good as this.
    fn plan_for(&self, target: f64) -> Option<&Entry> {
        let full_s = self.truth(Question::Effects).cpu_s;
        let plans = self.entries.iter().filter(|entry| entry.family == Family::Models);
        let good = plans.filter(|entry| entry.p99() <= target && entry.cpu_s < full_s);
        good.min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s))
    }

    fn effects_for(&self, target: f64, plan: &Entry) -> String {
        let full = self.truth(Question::Effects);
        format!(
            "For {} use {}: {} x faster than all effects at their finest ({} instead of {}); its worst pixel is off by {}.",
            percent_of(target),
            plan.model,
            two_digits(full.cpu_s / plan.cpu_s),
            seconds(plan.cpu_s),
            seconds(full.cpu_s),
            percent_of(worst(plan))
        )
    }

    /// Where no plan is as good as these.
    fn missed(&self, targets: &[&f64]) -> String {
        let percents: Vec<String> = targets.iter().map(|target| percent_of(**target)).collect();
        let plans = self.entries.iter().filter(|entry| entry.family == Family::Models);
        let nearest = plans.min_by(|a, b| a.p99().total_cmp(&b.p99()).then(a.cpu_s.total_cmp(&b.cpu_s)));
        let nearest = nearest.map_or(String::new(), |entry| {
            format!(
                "; the nearest is {}: all but 1 % of the pixels are within {}, for {}",
                entry.model,
                percent_of(entry.p99()),
                seconds(entry.cpu_s)
            )
        });
        let why = match self.has_exchange {
            true => " Light between facets is found to a tolerance of its own, whatever --tolerance says.",
            false => "",
        };
        format!("For {} no plan is good enough on this scene{nearest}.{why}", percents.join(" or "))
    }

    /// How rays compare with exact areas and shadows.
    fn about_rays(&self) -> Option<String> {
        let of = |family: Family| self.entries.iter().filter(move |entry| entry.family == family);
        let most = of(Family::Image).max_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s))?;
        let exact = of(Family::Shadows).filter(|entry| entry.p99() <= most.p99());
        let exact = exact.min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s))?;
        Some(format!(
            "Sampling instead of exact areas and shadows: {} are off by {} after {}; \"{}\" takes {} and is off by {}.",
            most.name,
            percent_of(most.p99()),
            seconds(most.cpu_s),
            exact.name,
            seconds(exact.cpu_s),
            percent_of(exact.p99())
        ))
    }

    /// Whether a coarser mesh would do.
    fn about_meshes(&self) -> Option<String> {
        let exact = self.truth(Question::Geometry);
        let coarser = || self.entries.iter().filter(|entry| entry.family == Family::Facets);
        let good = coarser().filter(|entry| entry.p99() <= COARSE && entry.cpu_s < exact.cpu_s);
        Some(match good.min_by_key(|entry| entry.facets) {
            Some(best) => format!(
                "The mesh is finer than this image needs: {} facets instead of {} change all but 1 % of the pixels by less than {}, and take {} instead of {}.",
                best.facets,
                exact.facets,
                percent_of(best.p99()),
                seconds(best.cpu_s),
                seconds(exact.cpu_s)
            ),
            None => {
                let least = coarser().min_by(|a, b| a.p99().total_cmp(&b.p99()))?;
                format!(
                    "The image needs all of its mesh: with {} facets instead of {}, 1 % of the pixels are off by {} or more.",
                    least.facets,
                    exact.facets,
                    percent_of(least.p99())
                )
            }
        })
    }
}

fn is_truth(entry: &Entry) -> bool {
    entry.family == entry.family.question().truth()
}

/// The worst pixel.
fn worst(entry: &Entry) -> f64 {
    entry.errors.iter().map(|band| band.all.max).fold(0.0, f64::max)
}

/// A share as percent, with two digits that count.
fn percent_of(share: f64) -> String {
    match 100.0 * share {
        percent if percent > 0.0 && percent < 1e-4 => "less than 0.0001 %".to_owned(),
        percent => format!("{} %", two_digits(percent)),
    }
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
