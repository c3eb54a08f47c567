//! Scene to facet table: what each source sends to each facet, where it is lit, how warm it is. Not radiance.

mod sunlit;

pub use sunlit::sunlit;
