//! One binary for all integration tests.

mod malformed_scene;
mod scene_files;
