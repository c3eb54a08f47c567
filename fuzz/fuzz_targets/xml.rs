//! Any text is a tree or an error with a place; a tree that is written is read back as the same text.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::xml::{self, Element};

fuzz_target!(|text: &str| {
    match xml::parse(text, Path::new("a.xml")) {
        Ok(root) => {
            places(&root, text);
            let written = root.write();
            assert_eq!(xml::parse(&written, Path::new("b.xml")).unwrap().write(), written);
        }
        Err(error) => {
            assert!(error.to_string().starts_with("a.xml:"), "{error}");
            for problem in error.problems() {
                let (start, end) = problem.at.span.unwrap();
                assert!(text.get(start..end).is_some(), "{start}..{end}: {error}");
            }
        }
    }
});

/// Every place is a part of the text.
fn places(element: &Element, text: &str) {
    let names = element.attributes.iter().map(|attribute| element.at_attribute(&attribute.name));
    for at in names.chain([element.at()]) {
        let (start, end) = at.span.unwrap();
        assert!(text.get(start..end).is_some_and(|part| !part.is_empty()), "{start}..{end}: {at}");
    }
    element.children.iter().for_each(|child| places(child, text));
}
