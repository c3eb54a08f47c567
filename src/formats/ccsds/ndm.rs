//! Messages as XML: one alone, or several in an `<ndm>`.

use super::message::{Block, Entry, Kind, Message, Place, Reading, local};
use crate::error::Result;
use crate::formats::xml::Element;
use crate::report::Fate;

/// The messages of a document. Of an `<ndm>`, those that are not ephemerides are left out, and noted.
///
/// # Errors
/// [`Unsupported`](crate::Error::Unsupported) if none is an ephemeris.
pub(super) fn messages<'a>(root: &'a Element, reading: &mut Reading<'a>) -> Result<Vec<Message<'a>>> {
    let kind = Kind::named(local(&root.name));
    let roots: Vec<&Element> = if kind == Some(Kind::Ndm) { root.children.iter().collect() } else { vec![root] };
    let kinds = || roots.iter().filter_map(|root| Some((*root, Kind::named(local(&root.name))?)));
    let other = kinds().find(|(_, kind)| matches!(kind, Kind::Other(..)));
    let found: Vec<_> = kinds().filter(|(_, kind)| matches!(kind, Kind::Oem | Kind::Aem)).collect();
    if let (true, Some((element, kind))) = (found.is_empty(), other) {
        return Err(kind.refused(element.at()));
    }
    for (element, kind) in kinds() {
        if let Kind::Other(name, what) = kind {
            reading.note(Fate::Dropped, Place::Element(element), format!("a message of kind {name}: {what}"));
        }
    }
    if found.is_empty() {
        reading.wrong(Place::Element(root), "holds neither <oem> nor <aem>");
    }
    Ok(found.into_iter().map(|(element, kind)| message(element, kind)).collect())
}

fn message(root: &Element, kind: Kind) -> Message<'_> {
    let mut comments = Vec::new();
    comments_of(root, &mut comments);
    let header = child(root, "header").map(entries).unwrap_or_default();
    let version = root.get("version").unwrap_or_default();
    let version = Entry { key: "version", value: version.trim(), at: Place::Element(root) };
    let body = child(root, "body").unwrap_or(root);
    let blocks = body.children.iter().filter(|element| local(&element.name) == "segment").map(segment).collect();
    Message { kind, version, header, comments, blocks }
}

fn segment(element: &Element) -> Block<'_> {
    let metadata = child(element, "metadata");
    let within = child(element, "data").map_or(&[][..], |data| &data.children);
    let of = |name: &'static str| within.iter().filter(move |row| local(&row.name) == name).map(Place::Element);
    Block {
        at: Place::Element(metadata.unwrap_or(element)),
        meta: metadata.map(entries).unwrap_or_default(),
        rows: of("stateVector").chain(of("attitudeState")).collect(),
        covariance: of("covarianceMatrix").next(),
    }
}

/// The first element within of this name, whatever its prefix.
fn child<'a>(element: &'a Element, name: &str) -> Option<&'a Element> {
    element.children.iter().find(|child| local(&child.name) == name)
}

fn entries(element: &Element) -> Vec<Entry<'_>> {
    let said = element.children.iter().filter(|child| local(&child.name) != "COMMENT");
    said.map(|child| Entry { key: local(&child.name), value: &child.text, at: Place::Element(child) }).collect()
}

fn comments_of<'a>(element: &'a Element, comments: &mut Vec<&'a str>) {
    for child in &element.children {
        match local(&child.name) {
            "COMMENT" => comments.push(&child.text),
            _ => comments_of(child, comments),
        }
    }
}
