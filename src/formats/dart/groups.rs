//! How DART numbers the groups of an OBJ file.

use super::Version;

/// The first build that orders groups by name.
const ALPHABETICAL_FROM: u32 = 1111;

/// The order DART gives groups: indices into `names`, the group with number 1 first.
///
/// `names` are the groups that own faces, each once, in the order of the OBJ file. From build v1111 they are sorted by
/// name; builds before it, and files without a build, take the order of a Java 8 `HashMap` with these keys: that of
/// the hash table's buckets, and of insertion within one.
pub fn order<S: AsRef<str>>(names: &[S], version: &Version) -> Vec<usize> {
    let mut order: Vec<usize> = (0..names.len()).collect();
    let name = |i: usize| names[i].as_ref();
    if build_number(version).is_some_and(|build| build >= ALPHABETICAL_FROM) {
        // Java compares UTF-16 units, not characters.
        order.sort_by(|&a, &b| name(a).encode_utf16().cmp(name(b).encode_utf16()));
    } else {
        let mut buckets: u32 = 16;
        while names.len() * 4 > buckets as usize * 3 {
            buckets *= 2;
        }
        order.sort_by_key(|&i| {
            let hash = java_hash(name(i));
            (hash ^ (hash >> 16)) & (buckets - 1)
        });
    }
    order
}

/// The number in a build such as "v1091".
pub(crate) fn build_number(version: &Version) -> Option<u32> {
    version.build.trim().trim_start_matches(['v', 'V']).parse().ok()
}

/// `String.hashCode` of Java: over UTF-16 units, h = 31 h + unit, modulo 2^32.
fn java_hash(text: &str) -> u32 {
    text.encode_utf16().fold(0, |hash: u32, unit| hash.wrapping_mul(31).wrapping_add(u32::from(unit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ordered<'a>(names: &[&'a str], build: &str) -> Vec<&'a str> {
        let version = Version { version: "5".into(), build: build.into() };
        order(names, &version).into_iter().map(|i| names[i]).collect()
    }

    #[test]
    fn the_hash_is_javas() {
        // From the Java documentation's formula, by hand: 'a' = 97; 97 x 31 + 98 = 3105; 3105 x 31 + 99 = 96354.
        assert_eq!([java_hash(""), java_hash("a"), java_hash("ab"), java_hash("abc")], [0, 97, 3105, 96354]);
        // Beyond 2^32 it wraps; this pair is known to have the same hash in Java.
        assert_eq!(java_hash("Aa"), java_hash("BB"));
        assert_eq!(java_hash("polygenelubricants"), 0x8000_0000);
    }

    #[test]
    fn builds_before_v1111_take_the_order_of_a_hash_map() {
        // "lid": ((108 x 31) + 105) x 31 + 100 = 107143, 107143 ^ (107143 >> 16 = 1) = 107142, mod 16 = 6.
        // "body": 'b' 98, 'o' 111, 'd' 100, 'y' 121: 3029410, ^ 46 = 3029388, mod 16 = 12.
        assert_eq!(java_hash("lid"), 107_143);
        assert_eq!(java_hash("body"), 3_029_410);
        assert_eq!(ordered(&["body", "lid"], "v1110"), ["lid", "body"]);
        assert_eq!(ordered(&["body", "lid"], ""), ["lid", "body"]);
        assert_eq!(ordered(&["lid", "body"], "v1111"), ["body", "lid"]);
        // The same bucket: the order of the file. "Aa" and "BB" have one hash.
        assert_eq!(ordered(&["BB", "Aa"], "v1091"), ["BB", "Aa"]);
        assert_eq!(ordered(&["Aa", "BB"], "v1091"), ["Aa", "BB"]);
    }

    #[test]
    fn the_table_grows_with_more_than_three_quarters() {
        // "a" is 97 = 6 x 16 + 1 = 3 x 32 + 1, "q" is 113 = 7 x 16 + 1 = 3 x 32 + 17: one bucket of 16, two of 32.
        let mut names = vec!["q", "a"];
        names.extend(["b", "c", "d", "e", "f", "g", "h", "i", "j", "k"]);
        assert_eq!(ordered(&names, "")[..3], ["q", "a", "b"]);
        names.push("l");
        assert_eq!(ordered(&names, "")[..2], ["a", "b"]);
        assert_eq!(ordered(&names, "").last(), Some(&"q"));
    }
}
