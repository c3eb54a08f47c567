//! Many vectors, column by column, so that a loop over them computes several at once.

use glam::DVec3;

/// Vectors in three columns of the same length.
#[derive(Debug, Clone, Default)]
pub struct Vectors {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl Vectors {
    /// Replaces all of them.
    pub fn set(&mut self, vectors: impl ExactSizeIterator<Item = DVec3>) {
        for column in [&mut self.x, &mut self.y, &mut self.z] {
            column.clear();
            column.resize(vectors.len(), 0.0);
        }
        let columns = self.x.iter_mut().zip(&mut self.y).zip(&mut self.z);
        columns.zip(vectors).for_each(|(((x, y), z), vector)| (*x, *y, *z) = vector.into());
    }

    /// One of them.
    ///
    /// # Panics
    /// If there are no more than `k`.
    pub fn get(&self, k: usize) -> DVec3 {
        DVec3::new(self.x[k], self.y[k], self.z[k])
    }

    /// All of them.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = DVec3> {
        self.x.iter().zip(&self.y).zip(&self.z).map(|((x, y), z)| DVec3::new(*x, *y, *z))
    }

    /// Makes all of them unit vectors, as [`DVec3::normalize_or_zero`] does.
    pub fn normalize_or_zero(&mut self) {
        for ((x, y), z) in self.x.iter_mut().zip(&mut self.y).zip(&mut self.z) {
            (*x, *y, *z) = DVec3::new(*x, *y, *z).normalize_or_zero().into();
        }
    }
}
