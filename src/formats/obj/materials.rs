//! Materials that faces use, and what material files say of them.

use std::collections::HashMap;

use crate::formats::mtl::ObjMaterial;

#[derive(Default)]
pub(super) struct Materials {
    /// Names in the order of their first use.
    used: Vec<String>,
    index_of_name: HashMap<String, u16>,
    /// Colours by name.
    defined: HashMap<String, Option<[f64; 3]>>,
}

impl Materials {
    /// This many can be told apart.
    pub(super) const MOST: usize = u16::MAX as usize + 1;

    /// The index of a name that faces use; `None` for a new one beyond [`Materials::MOST`].
    pub(super) fn index(&mut self, name: &str) -> Option<u16> {
        if let Some(&index) = self.index_of_name.get(name) {
            return Some(index);
        }
        let index = u16::try_from(self.used.len()).ok()?;
        self.used.push(name.to_owned());
        self.index_of_name.insert(name.to_owned(), index);
        Some(index)
    }

    /// The name of an index that [`Materials::index`] gave.
    pub(super) fn name(&self, index: u16) -> &str {
        self.used.get(usize::from(index)).map_or("", String::as_str)
    }

    /// How many faces use.
    pub(super) fn count(&self) -> usize {
        self.used.len()
    }

    /// Takes what a material file defines; `false` if the name has another colour already.
    pub(super) fn define(&mut self, material: &ObjMaterial) -> bool {
        *self.defined.entry(material.name.clone()).or_insert(material.kd) == material.kd
    }

    /// The used materials with their colours.
    pub(super) fn into_list(self) -> Vec<ObjMaterial> {
        let with_colour = |name: String| ObjMaterial { kd: self.defined.get(&name).copied().flatten(), name };
        self.used.into_iter().map(with_colour).collect()
    }
}
