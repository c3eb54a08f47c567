//! Items sorted into numbered groups, by counting: first how many each will have, then the items.

/// How many items each group will have.
#[derive(Debug)]
pub(crate) struct GroupSizes(Vec<usize>);

/// Items by group, those of a group in the order in which they came.
#[derive(Debug)]
pub(crate) struct Groups<T> {
    start: Vec<usize>,
    item: Vec<T>,
}

impl GroupSizes {
    /// All groups are empty.
    pub(crate) fn new(groups: usize) -> Self {
        // Counted two places to the right: the running sum then stands one place to the right of each group's start, and every item
        // that is put in moves it on, until it is the next group's.
        GroupSizes(vec![0; groups + 2])
    }

    /// Counts an item.
    #[inline]
    pub(crate) fn count(&mut self, group: usize) {
        self.0[group + 2] += 1;
    }

    /// Room for the items that were counted: each must now be [`put`](Groups::put) in, once.
    pub(crate) fn into_groups<T: Copy + Default>(self) -> Groups<T> {
        let mut start = self.0;
        let mut sum = 0;
        for start in &mut start {
            sum += *start;
            *start = sum;
        }
        start.pop();
        Groups { start, item: vec![T::default(); sum] }
    }
}

impl<T> Groups<T> {
    /// Puts an item into its group.
    #[inline]
    pub(crate) fn put(&mut self, group: usize, item: T) {
        let at = &mut self.start[group + 1];
        self.item[*at] = item;
        *at += 1;
    }

    /// The items of a group, once all are in.
    #[inline]
    pub(crate) fn of(&self, group: usize) -> &[T] {
        &self.item[self.start[group]..self.start[group + 1]]
    }

    /// The same, to be put in another order.
    pub(crate) fn of_mut(&mut self, group: usize) -> &mut [T] {
        &mut self.item[self.start[group]..self.start[group + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_keep_their_order_within_a_group() {
        let items = [(3, 'a'), (0, 'b'), (3, 'c'), (1, 'd'), (3, 'e'), (0, 'f')];
        let mut sizes = GroupSizes::new(5);
        items.iter().for_each(|(group, _)| sizes.count(*group));
        let mut groups = sizes.into_groups();
        items.iter().for_each(|(group, item)| groups.put(*group, *item));
        let all: Vec<&[char]> = (0..5).map(|group| groups.of(group)).collect();
        assert_eq!(all, [&['b', 'f'][..], &['d'], &[], &['a', 'c', 'e'], &[]]);
    }

    #[test]
    fn no_groups_have_no_items() {
        let groups = GroupSizes::new(0).into_groups::<u32>();
        assert!(groups.item.is_empty() && groups.start == [0]);
    }
}
