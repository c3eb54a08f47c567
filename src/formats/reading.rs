//! How a scene file is read, beyond what it says itself.

use super::cache::Cache;
use super::setting::Setting;

/// How a scene file is read: by default as it stands, from the files that it names.
#[derive(Debug, Clone, Default)]
pub struct Reading {
    /// Items that are replaced.
    pub settings: Vec<Setting>,
    /// Where prepared bodies are kept.
    pub cache: Option<Cache>,
}

impl From<Vec<Setting>> for Reading {
    fn from(settings: Vec<Setting>) -> Self {
        Reading { settings, cache: None }
    }
}
