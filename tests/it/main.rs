//! The integration tests: one binary, one module for each kind of promise.
// A test that is skipped says so; tables of cases are types of their own; an axis is a number; small numbers of cases fit any type.
#![allow(
    clippy::print_stderr,
    clippy::print_stdout,
    clippy::type_complexity,
    clippy::needless_range_loop,
    clippy::cast_possible_truncation
)]

mod afar;
mod angles;
mod bands;
mod beams;
mod blender;
mod bodies;
mod book;
mod cache;
mod cameras;
mod campaign;
mod ccsds;
mod centres;
mod chart;
mod chart_attack;
mod cli;
mod clipping;
mod conduction;
mod convert;
mod containers;
mod coregister;
#[cfg(feature = "sqlite")]
mod dart_cameras;
#[cfg(feature = "sqlite")]
mod dart_database;
mod dart_fields;
#[cfg(feature = "sqlite")]
mod dart_mandatory;
mod dart_outline;
mod dart_output;
mod dart_parts;
mod dart_read;
#[cfg(feature = "sqlite")]
mod dart_sheets;
#[cfg(feature = "sqlite")]
mod dart_silence;
mod dart_sim;
mod dart_temperatures;
mod dart_terrain;
mod dart_write;
mod determinism;
mod differences;
mod disk;
mod distortion;
mod dry_run;
mod eclipse;
mod elevation_files;
mod envi_headers;
mod exact;
mod exchange;
mod facet_radiance;
mod flat_plane;
mod flight_scene;
mod floor;
mod globes;
mod globes_in_view;
mod gltf;
mod gltf_extensions;
mod hazards;
mod held;
mod hosts;
mod inspect_pixel;
mod instances;
mod instrument;
mod isd;
mod image_files;
mod invariance;
mod knowledge;
mod labels;
mod landscapes;
mod layers;
mod locate;
mod lon_lat;
mod long_inputs;
mod malformed_scene;
mod map_files;
mod material_maps;
mod map_light;
mod map_sums;
mod maps;
mod mars_heat;
mod mars_models;
mod mars_shadows;
mod meshes;
mod messages;
mod mosaics;
mod motion;
mod optics_of_kinds;
mod new;
mod oracles;
mod ortho;
mod out_of_range;
mod old_tables;
mod part_in_light;
mod partly_sky;
mod past;
mod photometry_attack;
mod photometry_files;
mod photometry_heat;
mod photometry_image;
mod plans;
mod presets;
mod quantities;
mod products;
mod raster;
mod raster_convert;
mod raster_masks;
mod raster_places;
mod recipe_files;
mod referees;
mod renderers;
mod repairs;
mod report;
mod sampler;
mod scene_files;
mod scenes;
mod schema;
mod scratch;
mod settings;
mod shapes;
mod shared_body;
mod sides;
mod sights;
mod slabs;
mod slopes;
mod stability;
mod stated_choices;
mod subset;
mod spectra;
mod spectrometer;
mod spice;
mod spectra_from_the_wild;
mod sun_disc;
mod taken_in_parts;
mod textures;
mod told;
mod tracks;
mod truth;
mod units_of_spectra;
mod unsaid;
mod unusual;
mod view;
mod whisk_broom;
mod wild_inputs;
mod wild_obj;
