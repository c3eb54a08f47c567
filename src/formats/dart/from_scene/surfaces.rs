//! A mesh as OBJ files, whose groups are its materials, and those of its backs.

use crate::geometry::{MaterialId, Mesh, index_u32};

use super::sheets::sheets;
use super::{ObjectGroup, ObjectMesh};

/// An OBJ file can distinguish this many groups.
pub(super) const GROUPS: usize = 676;

/// The surface as OBJ files, each with a group for each of its materials, and for each pair of them on the two sides of sheets; one
/// file unless there are more than [`GROUPS`].
pub(super) fn surfaces(mesh: Mesh) -> Vec<ObjectMesh> {
    let pairs = sheets(&mesh);
    let mut back_of = vec![None; if pairs.is_empty() { 0 } else { mesh.facets.len() }];
    let mut is_back = vec![false; back_of.len()];
    for (front, back) in pairs {
        back_of[front as usize] = Some(usize::from(mesh.material[back as usize].0));
        is_back[back as usize] = true;
    }
    let sides = |f: usize| (usize::from(mesh.material[f].0), back_of.get(f).copied().flatten());
    let is_front = |f: &usize| !is_back.get(*f).copied().unwrap_or(false);
    let fronts = || (0..mesh.facets.len()).filter(is_front);
    let mut kinds: Vec<(usize, Option<usize>)> = fronts().map(sides).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let group_of = |f: usize| kinds.partition_point(|kind| *kind < sides(f));
    let batches = kinds.chunks(GROUPS).enumerate().map(|(number, batch)| {
        let first = number * GROUPS;
        let is_of_it = |f: &usize| (first..first + batch.len()).contains(&group_of(*f));
        let facets: Vec<u32> = fronts().filter(is_of_it).map(index_u32).collect();
        // All of it stays as it is, with vertices that no facet has.
        let part = if facets.len() == mesh.facets.len() { mesh.clone() } else { mesh.part(&facets) };
        let material = facets.iter().map(|f| group_id(group_of(*f as usize) - first)).collect();
        let names = group_names(batch.len()).unwrap_or_default();
        let group = |(&(front, back), name)| ObjectGroup { name, front, back };
        let groups = batch.iter().zip(names).map(group).collect();
        ObjectMesh { mesh: Mesh { material, face_of_facet: Vec::new(), ..part }, groups }
    });
    batches.collect()
}

/// A group within a file, of which there are at most [`GROUPS`].
fn group_id(group: usize) -> MaterialId {
    MaterialId(u16::try_from(group).unwrap_or(u16::MAX))
}

/// So many names of groups whose order DART's versions agree about: alphabetical, and that of a Java hash map.
///
/// A map of n names has a table of 16 places, doubled until n fills at most three quarters, and goes through the places h mod size.
/// The hash of two letters, 31 a + b, grows in alphabetical order and stays below 2^16; so names whose hashes lie between
/// two multiples of the table's size are in the same order both ways. `None` if there are not that many.
pub fn group_names(count: usize) -> Option<Vec<String>> {
    let mut places = 16;
    while 4 * count > 3 * places {
        places *= 2;
    }
    let letters = || b'a'..=b'z';
    let pairs: Vec<[u8; 2]> = letters().flat_map(|a| letters().map(move |b| [a, b])).collect();
    let block = |[a, b]: &[u8; 2]| (31 * usize::from(*a) + usize::from(*b)) / places;
    let run = pairs.chunk_by(|x, y| block(x) == block(y)).find(|run| run.len() >= count)?;
    Some(run[..count].iter().map(|[a, b]| [*a as char, *b as char].iter().collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `String.hashCode` and the place in a `HashMap` of Java, written from their documentation.
    fn place(name: &str, places: u32) -> u32 {
        let hash = name.encode_utf16().fold(0u32, |h, c| h.wrapping_mul(31).wrapping_add(u32::from(c)));
        (hash ^ (hash >> 16)) & (places - 1)
    }

    #[test]
    fn groups_are_in_the_same_order_both_ways() {
        for count in 0..=676 {
            let names = group_names(count).unwrap_or_else(|| panic!("{count}"));
            assert_eq!(names.len(), count);
            assert!(names.is_sorted());
            let mut places = 16;
            while f64::from(places) * 0.75 < count as f64 {
                places *= 2;
            }
            assert!(names.windows(2).all(|w| place(&w[0], places) < place(&w[1], places)), "{count}");
        }
        assert!(group_names(677).is_none());
    }
}
