//! Which of several maps count for a facet.

/// Which of several maps of one scene serve a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ViewChoice {
    /// Of those that know the facet the one seen from the nearest direction.
    #[default]
    Nearest,
    /// All that know the facet, weighted by one over the squared angle to the direction of view.
    Interpolated,
}
/// How much each of some maps counts that all know the same, relative to each other.
pub(super) fn views_shares(knowing: &[usize], angles: &[f64], choice: ViewChoice) -> Vec<f64> {
    let Some(nearest) = knowing.iter().copied().min_by(|a, b| angles[*a].total_cmp(&angles[*b])) else { return vec![] };
    if choice == ViewChoice::Nearest || angles[nearest].is_nan() || angles[nearest] == 0.0 {
        return knowing.iter().map(|i| if *i == nearest { 1.0 } else { 0.0 }).collect();
    }
    // Relative to the nearest, so that small angles do not overflow.
    knowing.iter().map(|i| if angles[*i].is_finite() { (angles[nearest] / angles[*i]).powi(2) } else { 0.0 }).collect()
}
