//! XML as a tree of elements that know where they stand; and such trees written.
//!
//! For formats whose content is elements, with attributes or with text. Text between elements is joined and marked
//! ([`Element::has_text`]); comments and processing instructions are ignored. Nothing is expanded or fetched: a
//! document type is refused, and so is every entity but the five that XML predefines and character references.
//! UTF-8 only, with or without a byte order mark; lines may end in CRLF.

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

use quick_xml::events::attributes::AttrError;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::input::{self, InputFile};
use crate::error::{Error, Location, Result};

/// No XML file is longer, bytes.
pub const LONGEST: u64 = 64 << 20;
/// Elements are nested no deeper.
pub const DEEPEST: usize = 64;
/// No file has more elements.
pub const ELEMENTS: usize = 1_000_000;
/// No element has more attributes.
pub const ATTRIBUTES: usize = 1_000;
/// What some editors put before UTF-8 text.
const MARK: char = '\u{feff}';

/// An element.
#[derive(Debug, Clone, Default)]
pub struct Element {
    /// Name, with its prefix if it has one.
    pub name: String,
    /// Attributes, in the order of the text.
    pub attributes: Vec<Attribute>,
    /// Elements within, in the order of the text.
    pub children: Vec<Element>,
    /// Text within, without the white space around it; written only of an element that has no elements within.
    pub text: String,
    /// Text other than white space stood within.
    pub has_text: bool,
    file: Option<Arc<Path>>,
    within: Option<Arc<Trail>>,
    mark: Mark,
}

/// An attribute of an element.
#[derive(Debug, Clone, Default)]
pub struct Attribute {
    /// Name, with its prefix if it has one.
    pub name: String,
    /// Value: references resolved, line breaks and tabs as blanks.
    pub value: String,
    mark: Mark,
}

/// The elements around one, innermost first: shared, as most elements have siblings.
#[derive(Debug)]
struct Trail {
    name: String,
    within: Option<Arc<Trail>>,
}

/// A place in the text.
#[derive(Debug, Clone, Copy, Default)]
struct Mark {
    line: u32,
    column: u32,
    start: u32,
    end: u32,
}

impl Element {
    /// An element without a place, to be written.
    pub fn new(name: impl Into<String>) -> Self {
        Element { name: name.into(), ..Default::default() }
    }

    /// The same with one more attribute.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: impl Value) -> Self {
        self.attributes.push(Attribute { name: name.into(), value: value.text(), mark: Mark::default() });
        self
    }

    /// The same with this text within.
    #[must_use]
    pub fn holding(mut self, text: impl Value) -> Self {
        self.text = text.text();
        self.has_text = !self.text.is_empty();
        self
    }

    /// The same with one more element within.
    #[must_use]
    pub fn and(mut self, child: Element) -> Self {
        self.children.push(child);
        self
    }

    /// The same with more elements within.
    #[must_use]
    pub fn and_all(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// The value of an attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|a| a.name == name).map(|a| a.value.as_str())
    }

    /// The first element within that has this name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|c| c.name == name)
    }

    /// All elements within, not deeper, that have this name.
    pub fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |c| c.name == name)
    }

    /// The first element within, at any depth, that has this name.
    pub fn descendant(&self, name: &str) -> Option<&Element> {
        self.children.iter().find_map(|c| if c.name == name { Some(c) } else { c.descendant(name) })
    }

    /// Where its tag stands. The item is its [`path`](Self::path).
    pub fn at(&self) -> Location {
        self.location(self.mark, self.path())
    }

    /// Where an attribute stands; where the element does, if it has no such attribute.
    pub fn at_attribute(&self, name: &str) -> Location {
        let mark = self.attributes.iter().find(|a| a.name == name).map_or(self.mark, |a| a.mark);
        self.location(mark, format!("{}/@{name}", self.path()))
    }

    /// The names that lead from the root to it, the root's left out: `Soil/Topography`. The root's path is its name.
    pub fn path(&self) -> String {
        let mut names = vec![self.name.as_str()];
        let mut trail = self.within.as_ref();
        while let Some(around) = trail {
            names.push(&around.name);
            trail = around.within.as_ref();
        }
        if names.len() > 1 {
            names.pop();
        }
        names.reverse();
        names.join("/")
    }

    fn location(&self, mark: Mark, item: String) -> Location {
        let Some(file) = &self.file else { return Location::item(item) };
        Location {
            line: Some(mark.line as usize),
            column: Some(mark.column as usize),
            span: Some((mark.start as usize, mark.end as usize)),
            ..Location::file(file).with_item(item)
        }
    }

    /// The document with this root: a declaration, and an element a line, four blanks a level.
    pub fn write(&self) -> String {
        let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
        self.write_at(0, &mut text);
        text
    }

    fn write_at(&self, level: usize, text: &mut String) {
        let indent = "    ".repeat(level);
        text.push_str(&indent);
        text.push('<');
        text.push_str(&self.name);
        for attribute in &self.attributes {
            text.push(' ');
            text.push_str(&attribute.name);
            text.push_str("=\"");
            escape(&attribute.value, text);
            text.push('"');
        }
        if self.children.is_empty() {
            match self.text.as_str() {
                "" => text.push_str("/>\n"),
                within => {
                    text.push('>');
                    escape(within, text);
                    text.push_str(&format!("</{}>\n", self.name));
                }
            }
            return;
        }
        text.push_str(">\n");
        for child in &self.children {
            child.write_at(level + 1, text);
        }
        text.push_str(&indent);
        text.push_str("</");
        text.push_str(&self.name);
        text.push_str(">\n");
    }
}

/// What an attribute can be given as.
pub trait Value {
    /// How it is written, before escaping.
    fn text(&self) -> String;
}

impl Value for f64 {
    /// The shortest text that is read as the same number, with a point or an exponent: `1.0`, `1e-7`.
    fn text(&self) -> String {
        format!("{self:?}")
    }
}

impl Value for bool {
    /// 1 or 0.
    fn text(&self) -> String {
        u8::from(*self).to_string()
    }
}

macro_rules! as_displayed {
    ($($t:ty),*) => { $(impl Value for $t { fn text(&self) -> String { self.to_string() } })* };
}
as_displayed!(&str, &String, String, u32, i32, usize);

fn escape(value: &str, text: &mut String) {
    for c in value.chars() {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            // As themselves they would come back as blanks.
            '\t' => text.push_str("&#9;"),
            '\n' => text.push_str("&#10;"),
            '\r' => text.push_str("&#13;"),
            c if is_char(c) => text.push(c),
            // XML has no way to write the others.
            _ => text.push('\u{fffd}'),
        }
    }
}

/// What XML 1.0 lets stand in a document.
fn is_char(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | ' '..='\u{fffd}' | '\u{10000}'..)
}

/// A name: letters, digits, `_`, `:`, `-`, `.`, the first of them a letter, `_` or `:`.
fn is_name(name: &str) -> bool {
    let letter = |c: char| c.is_alphabetic() || c == '_' || c == ':';
    name.chars().next().is_some_and(letter) && name.chars().all(|c| letter(c) || c.is_numeric() || c == '-' || c == '.')
}

/// Reads a file: its root element, and what a report says of the file.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for a file longer than [`LONGEST`]; otherwise as [`parse`].
pub fn read(path: &Path) -> Result<(Element, InputFile)> {
    let (text, input) = input::text(path, LONGEST)?;
    Ok((parse(&text, path)?, input))
}

/// Reads a text: its root element. `path` is for messages.
///
/// A byte order mark, which [`read`] passes over, does not belong to the text.
///
/// # Errors
/// [`Error::Syntax`] at the first place that is not well-formed XML, and where a limit of this module is passed.
pub fn parse(text: &str, path: &Path) -> Result<Element> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_comments = true;
    let mut tree =
        Tree { text, path, file: path.into(), cursor: Cursor::new(), open: Vec::new(), root: None, count: 0 };
    if text.len() as u64 > LONGEST {
        return Err(tree.error(0, 0, format!("longer than the {LONGEST} bytes that are read of an XML text")));
    }
    if text.starts_with(MARK) {
        // The reader of events would pass over it without counting it: its places would be others.
        let message = "a byte order mark: a file has one at most, at its very beginning";
        return Err(tree.error(0, MARK.len_utf8(), message));
    }
    if let Some((at, c)) = text.char_indices().find(|(_, c)| !is_char(*c)) {
        return Err(tree.error(at, at + c.len_utf8(), format!("the character U+{:04X} cannot stand in XML", c as u32)));
    }
    // Places in a text that is in memory.
    let place = |position: u64| usize::try_from(position).unwrap_or(usize::MAX);
    loop {
        let start = place(reader.buffer_position());
        let event = match reader.read_event() {
            Ok(event) => event,
            Err(error) => {
                let at = place(reader.error_position()).min(text.len());
                return Err(tree.error(at, place(reader.buffer_position()), error.to_string()));
            }
        };
        let end = place(reader.buffer_position());
        match event {
            Event::Start(tag) => tree.open(&tag, start, end)?,
            Event::Empty(tag) => {
                tree.open(&tag, start, end)?;
                tree.close();
            }
            Event::End(_) => tree.close(),
            Event::Text(_) if text[start..end].trim_ascii().is_empty() => {}
            Event::Text(_) => tree.holds(start, end, &text[start..end])?,
            Event::CData(within) => tree.holds(start, end, &within)?,
            Event::GeneralRef(reference) => {
                let known = match &*reference {
                    "lt" => Some('<'),
                    "gt" => Some('>'),
                    "amp" => Some('&'),
                    "apos" => Some('\''),
                    "quot" => Some('"'),
                    _ => reference.resolve_char_ref().ok().flatten().filter(|c| is_char(*c)),
                };
                let Some(known) = known else {
                    return Err(tree.error(start, end, format!("the entity `&{};` is not resolved", &*reference)));
                };
                tree.holds(start, end, known.encode_utf8(&mut [0; 4]))?;
            }
            Event::Decl(declaration) => {
                if start > 0 {
                    return Err(tree.error(start, end, "an XML declaration stands only at the very beginning"));
                }
                let encoding = declaration.encoding().and_then(|e| e.ok()).unwrap_or("UTF-8".into());
                if !["utf-8", "utf8", "us-ascii", "ascii"].contains(&encoding.to_ascii_lowercase().as_str()) {
                    let message =
                        format!("the encoding {encoding} is not read: save the file as UTF-8, and declare that");
                    return Err(tree.error(start, end, message));
                }
            }
            Event::DocType(_) => {
                let message = "a document type (DOCTYPE) is refused: nothing is expanded or fetched. Delete it";
                return Err(tree.error(start, end, message));
            }
            Event::Comment(_) | Event::PI(_) => {}
            Event::Eof => break,
        }
    }
    if let Some(open) = tree.open.last() {
        let Mark { start, end, .. } = open.mark;
        let message = format!("`<{0}>` is never closed: the file ends before `</{0}>`", open.name);
        return Err(tree.error(start as usize, end as usize, message));
    }
    match tree.root.take() {
        Some(root) => Ok(root),
        None => Err(tree.error(text.len(), text.len(), "holds no element: is it an XML file?")),
    }
}

/// Lines and columns of places that come in the order of the text.
struct Cursor {
    offset: usize,
    line: u32,
    column: u32,
}

impl Cursor {
    fn new() -> Self {
        Cursor { offset: 0, line: 1, column: 1 }
    }

    fn mark(&mut self, text: &str, start: usize, end: usize) -> Mark {
        for c in text[self.offset.min(start)..start].chars() {
            (self.line, self.column) = if c == '\n' { (self.line + 1, 1) } else { (self.line, self.column + 1) };
        }
        self.offset = start;
        // Positions beyond 32 bits are not reported.
        let short = |place: usize| u32::try_from(place).unwrap_or(u32::MAX);
        Mark { line: self.line, column: self.column, start: short(start), end: short(end) }
    }
}

/// A tree as far as it has been read.
struct Tree<'a> {
    text: &'a str,
    path: &'a Path,
    file: Arc<Path>,
    cursor: Cursor,
    /// Elements that are not closed yet, outermost first.
    open: Vec<Element>,
    root: Option<Element>,
    count: usize,
}

impl Tree<'_> {
    fn error(&self, start: usize, end: usize, message: impl Into<String>) -> Error {
        Error::syntax(Location::span(self.path, self.text, start, end.max(start)), message)
    }

    fn open(&mut self, tag: &BytesStart, start: usize, end: usize) -> Result<()> {
        let name = tag.name().into_inner();
        if !is_name(name) {
            return Err(self.error(start, end, format!("`{}` is not a valid element name", shown(name))));
        }
        if self.root.is_some() {
            let message = format!("a second root, `<{}>`: the document has ended before it", shown(name));
            return Err(self.error(start, end, message));
        }
        if self.open.len() == DEEPEST {
            return Err(self.error(start, end, format!("elements are nested more than {DEEPEST} deep")));
        }
        self.count += 1;
        if self.count > ELEMENTS {
            return Err(self.error(start, end, format!("more than {ELEMENTS} elements")));
        }
        let within = self.trail();
        let mark = self.cursor.mark(self.text, start, end);
        let attributes = self.attributes(tag, start, end)?;
        self.open.push(Element {
            name: name.to_owned(),
            attributes,
            file: Some(self.file.clone()),
            within,
            mark,
            ..Default::default()
        });
        Ok(())
    }

    /// The elements around the one that opens next. Siblings share it.
    fn trail(&self) -> Option<Arc<Trail>> {
        let parent = self.open.last()?;
        let of_sibling = parent.children.last().and_then(|sibling| sibling.within.clone());
        of_sibling.or_else(|| Some(Arc::new(Trail { name: parent.name.clone(), within: parent.within.clone() })))
    }

    fn attributes(&mut self, tag: &BytesStart, start: usize, end: usize) -> Result<Vec<Attribute>> {
        let mut attributes = Vec::new();
        let mut names = HashSet::new();
        // Where the tag's own text begins, behind `<`: positions of attributes count from there.
        let inner = start + 1;
        for attribute in tag.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| {
                let (at, what) = attribute_error(&error);
                self.error((inner + at).min(end), end, what)
            })?;
            let name = attribute.key.into_inner();
            let from = name.as_ptr().addr().saturating_sub(self.text.as_ptr().addr()).clamp(start, end);
            let to = (attribute.value.as_ptr().addr() + attribute.value.len() + 1)
                .saturating_sub(self.text.as_ptr().addr())
                .clamp(from, end);
            if attributes.len() == ATTRIBUTES {
                return Err(self.error(from, to, format!("more than {ATTRIBUTES} attributes in one element")));
            }
            if !is_name(name) {
                return Err(self.error(from, to, format!("`{}` is not a valid attribute name", shown(name))));
            }
            if !names.insert(name.to_owned()) {
                return Err(self.error(from, to, format!("the attribute `{}` stands twice", shown(name))));
            }
            if attribute.value.contains('<') {
                return Err(self.error(from, to, "`<` in the value of an attribute: write `&lt;`"));
            }
            let value = attribute.normalized_value(XmlVersion::Implicit1_0).ok().filter(|v| v.chars().all(is_char));
            let Some(value) = value else {
                let message = "a reference that is not resolved: `&` is written `&amp;`, and only &lt; &gt; &amp; &apos; \
                               &quot; and references to characters are understood";
                return Err(self.error(from, to, message));
            };
            let mark = self.cursor.mark(self.text, from, to);
            attributes.push(Attribute { name: name.to_owned(), value: value.into_owned(), mark });
        }
        Ok(attributes)
    }

    /// The innermost open element ends. That the name fits has been seen by the reader of events.
    fn close(&mut self) {
        let Some(mut element) = self.open.pop() else { return };
        element.text = element.text.trim_ascii().to_owned();
        match self.open.last_mut() {
            Some(parent) => parent.children.push(element),
            None => self.root = Some(element),
        }
    }

    /// Text stands within the innermost open element.
    fn holds(&mut self, start: usize, end: usize, text: &str) -> Result<()> {
        match self.open.last_mut() {
            Some(element) => {
                element.has_text = true;
                element.text.push_str(text);
            }
            None => {
                let lead = self.text[start..end].len() - self.text[start..end].trim_ascii_start().len();
                return Err(self.error(start + lead, end, "text outside the root element"));
            }
        }
        Ok(())
    }
}

/// Where in a tag something is wrong with an attribute, and what.
fn attribute_error(error: &AttrError) -> (usize, &'static str) {
    match error {
        AttrError::ExpectedEq(at) => (*at, "an attribute without `=` and a value"),
        AttrError::ExpectedValue(at) => (*at, "an attribute without a value"),
        AttrError::UnquotedValue(at) => (*at, "the value of an attribute stands in quotes"),
        AttrError::ExpectedQuote(at, _) => (*at, "the quotes around this value are not closed"),
        AttrError::Duplicated(at, _) => (*at, "an attribute that stands twice"),
    }
}

/// A name as a message shows it.
fn shown(name: &str) -> String {
    match name.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &name[..end]),
        None => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Element> {
        parse(text, Path::new("a.xml"))
    }

    #[test]
    fn elements_and_attributes_know_their_places() {
        let text = "<?xml version=\"1.0\"?>\r\n<!-- \u{3bc} --><a>\r\n  <b/>\r\n  <c>\u{3bc}<d x='1'\r\n y=\"a&amp;&#x3bc;\tb\"/></c>\r\n</a>\r\n";
        let root = parsed(text).unwrap();
        let c = root.child("c").unwrap();
        let d = c.child("d").unwrap();
        assert_eq!((root.name.as_str(), root.path().as_str(), d.path().as_str()), ("a", "a", "c/d"));
        assert_eq!(root.at().to_string(), "a.xml:2:11 a");
        assert_eq!(d.at().to_string(), "a.xml:4:7 c/d");
        assert_eq!(d.at_attribute("y").to_string(), "a.xml:5:2 c/d/@y");
        assert_eq!(d.get("y"), Some("a&\u{3bc} b"));
        let (start, end) = d.at_attribute("y").span.unwrap();
        assert_eq!(&text[start..end], "y=\"a&amp;&#x3bc;\tb\"");
        assert!(c.has_text && !root.has_text && root.all("b").count() == 1);
    }

    #[test]
    fn what_is_not_well_formed_has_a_place() {
        let many = format!("<a{}/>", (0..=ATTRIBUTES).map(|i| format!(" a{i}='1'")).collect::<String>());
        let deep = "<a>".repeat(DEEPEST + 1);
        for (text, place, message) in [
            ("<a/>\n<b/>", ":2:1", "a second root, `<b>`"),
            ("<a/>\n x", ":2:2", "text outside the root"),
            ("x<a/>", ":1:1", "text outside"),
            ("<a/>&amp;", ":1:5", "text outside"),
            ("<a>\n<b>\n", ":2:1", "`<b>` is never closed"),
            ("<a>\n</b>", ":2:1", "`</b>`"),
            ("</a>", ":1:1", "`</a>`"),
            ("<a x='1' y='2' x='3'/>", ":1:16", "`x` stands twice"),
            ("<a x/>", ":1:", "without `=`"),
            ("<a x=1/>", ":1:", "in quotes"),
            ("<a x='1/>", ":1:1", "not closed"),
            ("<a x='<'/>", ":1:4", "`<` in the value"),
            ("<a x='&b;'/>", ":1:4", "not resolved"),
            ("<a x='&#0;'/>", ":1:4", "not resolved"),
            ("<a x='&#1;'/>", ":1:4", "not resolved"),
            ("<a x='&'/>", ":1:4", "not resolved"),
            ("<a>&b;</a>", ":1:4", "`&b;` is not resolved"),
            ("<!DOCTYPE a [<!ENTITY b 'c'>]><a/>", ":1:1", "DOCTYPE"),
            ("<a/><?xml version='1.0'?>", ":1:5", "only at the very beginning"),
            ("<?xml version='1.0' encoding='ISO-8859-1'?><a/>", ":1:1", "ISO-8859-1 is not read"),
            ("", ":1:1", "no element"),
            ("<a \u{1}/>", ":1:4", "U+0001"),
            ("<1/>", ":1:1", "not a valid element name"),
            ("<a 1='2'/>", ":1:4", "not a valid attribute name"),
            ("<a><!-- b", ":1:4", "comment"),
            ("<a/>\u{feff}", ":1:5", "text outside"),
            ("\u{feff}<a/>", ":1:1", "byte order mark"),
            ("\u{feff}?<?xml a?>", ":1:1", "byte order mark"),
            (&many, ":1:", "more than 1000 attributes"),
            (&deep, ":1:193", "64 deep"),
        ] {
            let error = parsed(text).expect_err(text).to_string();
            assert!(error.starts_with(&format!("a.xml{place}")) && error.contains(message), "{text}: {error}");
        }
    }

    #[test]
    fn text_is_joined_and_written() {
        let text = "<a><b> 1.5&lt;<![CDATA[ x & y ]]>&#x3bc;\r\n</b><c> &#32; </c><d>u<e/> v</d></a>";
        let root = parsed(text).unwrap();
        assert_eq!(root.child("b").unwrap().text, "1.5< x & y \u{3bc}");
        assert_eq!((root.child("c").unwrap().text.as_str(), root.child("d").unwrap().text.as_str()), ("", "u v"));
        let written = root.write();
        assert!(written.contains("<b>1.5&lt; x &amp; y \u{3bc}</b>\n") && written.contains("<d>\n        <e/>\n"));
        assert_eq!(parsed(&written).unwrap().write(), written);
        assert_eq!(Element::new("f").holding(0.1).write().lines().nth(1), Some("<f>0.1</f>"));
    }

    #[test]
    fn what_is_written_is_read_back() {
        let tree = Element::new("a")
            .with("f", 1.0)
            .with("g", 1e-7)
            .with("h", 0.1 + 0.2)
            .with("n", 3_u32)
            .with("b", true)
            .with("s", "<\"&'>\n\u{3bc}")
            .and(Element::new("b").and_all([Element::new("c")]));
        let text = tree.write();
        assert_eq!(
            text,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <a f=\"1.0\" g=\"1e-7\" h=\"0.30000000000000004\" n=\"3\" b=\"1\" s=\"&lt;&quot;&amp;'&gt;&#10;\u{3bc}\">\n\
             \u{20}   <b>\n        <c/>\n    </b>\n</a>\n"
        );
        let back = parsed(&text).unwrap();
        assert_eq!(back.get("s"), Some("<\"&'>\n\u{3bc}"));
        assert_eq!(back.get("h").unwrap().parse(), Ok(0.1 + 0.2));
        assert_eq!(back.write(), text);
    }
}
