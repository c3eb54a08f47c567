//! The numbers of accessors: bytes of buffers, some of them replaced (sparse). Nothing is taken from beyond a buffer's end.

use std::ops::Deref;
use std::path::Path;
use std::rc::Rc;

use crate::error::{Error, Location, Result};
use crate::geometry::whole;

use super::json::{Accessor, Root, SparsePart};
use crate::formats::mesh_file::MOST;

/// A file's JSON and the bytes of its buffers.
pub(super) struct Data<'a> {
    pub(super) path: &'a Path,
    pub(super) root: Root,
    pub(super) buffers: Vec<Buffer>,
}

/// The bytes of a buffer: of a file that several name there is one copy.
pub(super) struct Buffer {
    pub(super) all: Rc<Vec<u8>>,
    /// As long as the JSON says it is.
    pub(super) length: usize,
}

impl Deref for Buffer {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.all[..self.length]
    }
}

/// How a number is stored.
#[derive(Clone, Copy)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// A number in its component type, and that type's maximum if it is normalised to 1.
    fn value(self, bytes: &[u8]) -> (f64, f64) {
        match (self, bytes) {
            (Component::I8, &[a]) => (f64::from(a as i8), 127.0),
            (Component::U8, &[a]) => (f64::from(a), 255.0),
            (Component::I16, &[a, b]) => (f64::from(i16::from_le_bytes([a, b])), 32767.0),
            (Component::U16, &[a, b]) => (f64::from(u16::from_le_bytes([a, b])), 65535.0),
            (Component::U32, &[a, b, c, d]) => (f64::from(u32::from_le_bytes([a, b, c, d])), f64::from(u32::MAX)),
            (_, &[a, b, c, d]) => (f64::from(f32::from_le_bytes([a, b, c, d])), 1.0),
            _ => (f64::NAN, 1.0),
        }
    }
}

impl Data<'_> {
    pub(super) fn at(&self, item: impl Into<String>) -> Location {
        Location::file(self.path).with_item(item)
    }

    pub(super) fn wrong<T>(&self, item: impl Into<String>, message: impl Into<String>) -> Result<T> {
        Err(Error::invalid(self.at(item), message))
    }

    /// An element of one of the file's lists, that `item` refers to.
    pub(super) fn element<'b, T>(&self, list: &'b [T], name: &str, index: usize, item: &str) -> Result<&'b T> {
        let count = list.len();
        list.get(index).ok_or_else(|| Error::invalid(self.at(item), format!("{name}[{index}]: there are {count}")))
    }

    /// The elements of an accessor, as rows of numbers one after the other; `expected` are the shapes that may be there.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no such accessor, if it is of another kind, or reaches beyond its bytes.
    pub(super) fn numbers(&self, index: usize, expected: &[&str], item: &str) -> Result<Vec<f64>> {
        let accessor = self.element(&self.root.accessors, "accessors", index, item)?;
        let item = format!("accessors[{index}]");
        if !expected.contains(&accessor.shape.as_str()) {
            let expected = expected.join(" or ");
            return self.wrong(item, format!("its type is {:?}, where {expected} is expected", accessor.shape));
        }
        let width = match accessor.shape.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        if accessor.count > MOST {
            return self.wrong(item, format!("{} elements: at most {MOST} are read", accessor.count));
        }
        let mut numbers = match accessor.buffer_view {
            Some(view) => self.packed(accessor, view, accessor.byte_offset, accessor.count, width, &item)?,
            None if accessor.sparse.is_some() => {
                // Zeros take no bytes of the file: their number is bounded by what else it holds.
                let held = self.buffers.iter().fold(0_usize, |sum, buffer| sum.saturating_add(buffer.len()));
                if accessor.count > held {
                    let message =
                        format!("{} elements without a `bufferView`: all buffers have {held} bytes", accessor.count);
                    return self.wrong(item, message);
                }
                vec![0.0; width * accessor.count]
            }
            None => return self.wrong(item, "has neither `bufferView` nor `sparse`"),
        };
        if let Some(sparse) = &accessor.sparse {
            let item = format!("{item}.sparse");
            if sparse.count > accessor.count {
                return self.wrong(item, format!("replaces {} of {} elements", sparse.count, accessor.count));
            }
            let SparsePart { buffer_view, byte_offset, component_type } = sparse.indices;
            let indices = Accessor { component_type, ..Accessor::default() };
            let places = format!("{item}.indices");
            let indices = self.packed(&indices, buffer_view, byte_offset, sparse.count, 1, &places)?;
            let SparsePart { buffer_view, byte_offset, .. } = sparse.values;
            let values = format!("{item}.values");
            let values = self.packed(accessor, buffer_view, byte_offset, sparse.count, width, &values)?;
            let mut next = 0;
            for (index, row) in indices.into_iter().zip(values.chunks_exact(width)) {
                let place = whole(index);
                if index < 0.0 || index.fract() != 0.0 || place >= accessor.count || place < next {
                    let message = format!("{index}: they ascend, and are below {}", accessor.count);
                    return self.wrong(places, message);
                }
                next = place + 1;
                numbers[width * place..width * next].copy_from_slice(row);
            }
        }
        Ok(numbers)
    }

    /// `count` rows of `width` numbers of an accessor's kind, at an offset in a view.
    fn packed(
        &self,
        accessor: &Accessor,
        view: usize,
        offset: usize,
        count: usize,
        width: usize,
        item: &str,
    ) -> Result<Vec<f64>> {
        let Some(component) = Component::of(accessor.component_type) else {
            return self.wrong(item, format!("`componentType` {} is not a kind of number", accessor.component_type));
        };
        let view_item = format!("bufferViews[{view}]");
        let view = self.element(&self.root.buffer_views, "bufferViews", view, item)?;
        let buffer = self.element(&self.buffers, "buffers", view.buffer, &view_item)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let Some(bytes) = end.and_then(|end| buffer.get(view.byte_offset..end)) else {
            let message =
                format!("{} bytes from byte {}: the buffer has {}", view.byte_length, view.byte_offset, buffer.len());
            return self.wrong(view_item, message);
        };
        let row_bytes = width * component.bytes();
        let stride = view.byte_stride.unwrap_or(row_bytes);
        if stride < row_bytes {
            return self.wrong(view_item, format!("a `byteStride` of {stride} for elements of {row_bytes} bytes"));
        }
        let needed = match count.checked_sub(1) {
            None => Some(offset),
            Some(last) => stride.checked_mul(last).and_then(|n| n.checked_add(row_bytes)?.checked_add(offset)),
        };
        let Some(bytes) = bytes.get(offset..).filter(|_| needed.is_some_and(|n| n <= bytes.len())) else {
            let message = format!(
                "{count} elements of {row_bytes} bytes, {stride} apart from byte {offset}: {view_item} has {}",
                bytes.len()
            );
            return self.wrong(item, message);
        };
        let mut numbers = Vec::with_capacity(width * count);
        for row in bytes.chunks(stride).take(count) {
            for number in row[..row_bytes].chunks_exact(component.bytes()) {
                let (value, one) = component.value(number);
                numbers.push(if accessor.normalized && one > 1.0 { (value / one).max(-1.0) } else { value });
            }
        }
        Ok(numbers)
    }
}
