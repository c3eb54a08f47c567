//! Sums over texels, handed out in the order in which the texels came.

#[derive(Debug, Default)]
pub(super) struct TexelSums {
    /// Open addressing; a power of two, at most half full.
    slots: Vec<(u32, f64)>,
    used: Vec<u32>,
}
const EMPTY: u32 = u32::MAX;

impl TexelSums {
    pub(super) fn add(&mut self, texel: u32, weight: f64) {
        if 2 * (self.used.len() + 1) > self.slots.len() {
            self.grow();
        }
        let slot = self.slot(texel);
        if self.slots[slot].0 == EMPTY {
            self.slots[slot].0 = texel;
            self.used.push(texel);
        }
        self.slots[slot].1 += weight;
    }

    fn slot(&self, texel: u32) -> usize {
        let mask = self.slots.len() - 1;
        // Fibonacci hashing: neighbours in a line or column spread.
        let mut slot = ((u64::from(texel) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize & mask;
        while self.slots[slot].0 != EMPTY && self.slots[slot].0 != texel {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let old = std::mem::take(&mut self.slots);
        self.slots = vec![(EMPTY, 0.0); (2 * old.len()).max(64)];
        for (texel, weight) in old.into_iter().filter(|s| s.0 != EMPTY) {
            let slot = self.slot(texel);
            self.slots[slot] = (texel, weight);
        }
    }

    pub(super) fn drain(&mut self, mut put: impl FnMut(u32, f64)) {
        for i in 0..self.used.len() {
            let texel = self.used[i];
            let slot = self.slot(texel);
            put(texel, self.slots[slot].1);
        }
        if self.used.len() * 8 < self.slots.len() {
            // All slots first: an emptied one would hide what was pushed past it.
            let slots: Vec<usize> = self.used.iter().map(|t| self.slot(*t)).collect();
            slots.into_iter().for_each(|s| self.slots[s] = (EMPTY, 0.0));
        } else {
            self.slots.fill((EMPTY, 0.0));
        }
        self.used.clear();
    }
}
