//! A mesh as OBJ files, whose groups are its materials.

use crate::geometry::{Mesh, index_u32};

use super::ObjectMesh;

/// An OBJ file can distinguish this many groups.
pub(super) const GROUPS: usize = 676;

/// The surface as OBJ files, each with a group for each of its materials; one file unless there are more than [`GROUPS`].
pub(super) fn surfaces(mesh: Mesh, materials: usize) -> Vec<ObjectMesh> {
    let mut is_used = vec![false; materials];
    mesh.material.iter().for_each(|m| is_used[m.0 as usize] = true);
    let used: Vec<usize> = (0..materials).filter(|m| is_used[*m]).collect();
    let groups = |batch: &[usize]| {
        let mut groups = vec![String::new(); materials];
        let names = group_names(batch.len()).unwrap_or_default();
        batch.iter().zip(names).for_each(|(material, name)| groups[*material] = name);
        groups
    };
    if used.len() <= GROUPS {
        return vec![ObjectMesh { groups: groups(&used), mesh }];
    }
    let part = |batch: &[usize]| {
        let groups = groups(batch);
        ObjectMesh { mesh: part(&mesh, |material| !groups[material].is_empty()), groups }
    };
    used.chunks(GROUPS).map(part).collect()
}

/// The facets of some materials, with the vertices that these have.
fn part(mesh: &Mesh, is_of_it: impl Fn(usize) -> bool) -> Mesh {
    let mut part = Mesh::default();
    let mut place = vec![u32::MAX; mesh.vertices_m.len()];
    for (facet, material) in mesh.facets.iter().zip(&mesh.material).filter(|(_, m)| is_of_it(usize::from(m.0))) {
        let corner = |v: u32| {
            let place = &mut place[v as usize];
            if *place == u32::MAX {
                *place = index_u32(part.vertices_m.len());
                part.vertices_m.push(mesh.vertices_m[v as usize]);
            }
            *place
        };
        let corners = facet.map(corner);
        part.facets.push(corners);
        part.material.push(*material);
    }
    part
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
