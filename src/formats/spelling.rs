//! What a misspelt word was meant to be.

/// The known word that a word was probably meant to be: two letters, or a third of them, differ.
pub(super) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    // Long input is not a slip of the keyboard, and the table below grows with its length.
    if word.len() > 64 {
        return None;
    }
    let all = known.iter().map(|k| (distance(word, k), *k));
    let (distance, best) = all.min_by_key(|(distance, _)| *distance)?;
    (distance <= (best.len() / 3).max(2) && distance < word.len()).then_some(best)
}

/// Levenshtein distance: insertions, deletions and exchanges of characters.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let next = (diagonal + usize::from(x != *y)).min(row[j] + 1).min(row[j + 1] + 1);
            diagonal = row[j + 1];
            row[j + 1] = next;
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_keyboard_are_near() {
        assert_eq!(nearest("reflectence", &["mixture", "reflectance"]), Some("reflectance"));
        assert_eq!(nearest("position_km", &["position_m"]), Some("position_m"));
        assert_eq!(nearest("x", &["reflectance"]), None);
        assert_eq!(distance("kitten", "sitting"), 3);
    }
}
