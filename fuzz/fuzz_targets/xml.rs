//! Any text is a tree or an error with a place; a tree that is written is read back as the same text.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::xml;

fuzz_target!(|text: &str| {
    match xml::parse(text, Path::new("a.xml")) {
        Ok(root) => {
            let written = root.write();
            assert_eq!(xml::parse(&written, Path::new("b.xml")).unwrap().write(), written);
        }
        Err(error) => assert!(error.to_string().starts_with("a.xml:"), "{error}"),
    }
});
