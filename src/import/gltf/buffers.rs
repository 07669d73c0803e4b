//! Buffers of a glTF file and the numbers in them; every length is checked before it is used.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::json::Json;
use crate::import::job::Job;
use crate::import::place::ImportError;

/// Most elements of an accessor without a buffer view, which takes no bytes of the file.
const MOST_ZEROS: u64 = 1 << 24;

/// The buffers of a file.
pub(super) struct Buffers<'a> {
    pub(super) root: Json<'a>,
    /// In the order of the file.
    buffers: Vec<Vec<u8>>,
}

/// Reads one number from its bytes.
type Read = fn(&[u8]) -> f64;

/// What an accessor's numbers are.
#[derive(Clone, Copy)]
struct Component {
    bytes: usize,
    read: Read,
    /// What stands for 1, if whole numbers stand for shares.
    one: f64,
}

impl<'a> Buffers<'a> {
    /// Reads all buffers; the first may be the binary part of a GLB file.
    pub(super) fn read(
        job: &Job<'_>,
        root: &Json<'a>,
        binary: Option<&[u8]>,
    ) -> Result<Buffers<'a>, ImportError> {
        let mut buffers = Vec::new();
        for (index, buffer) in root.list("buffers")?.iter().enumerate() {
            let length = buffer.need("byteLength")?.whole()?;
            let bytes = match (buffer.get("uri"), binary) {
                (Some(uri), _) => uri_bytes(job, &uri)?,
                (None, Some(binary)) if index == 0 => binary.to_vec(),
                (None, _) => return Err(buffer.error("the buffer has no `uri`")),
            };
            if (bytes.len() as u64) < length {
                let found = bytes.len();
                return Err(buffer.error(format!("{length} bytes are promised, {found} are there")));
            }
            buffers.push(bytes);
        }
        Ok(Buffers { root: root.clone(), buffers })
    }

    /// The bytes of a buffer view, and their stride if it has one.
    pub(super) fn view(&self, view: &Json<'a>) -> Result<(&[u8], Option<usize>), ImportError> {
        let buffer = view.need("buffer")?;
        buffer.follow(&self.root, "buffers")?;
        let bytes = &self.buffers[buffer.whole()? as usize];
        let (start, length) = (view.whole_or("byteOffset", 0)?, view.need("byteLength")?.whole()?);
        let end = start.checked_add(length).filter(|end| *end <= bytes.len() as u64);
        let end = end.ok_or_else(|| {
            let size = bytes.len();
            view.error(format!("bytes {start} … +{length} are not in the buffer of {size} bytes"))
        })?;
        let stride = match view.get("byteStride") {
            Some(stride) => Some(stride.whole()? as usize).filter(|stride| *stride > 0),
            None => None,
        };
        Ok((&bytes[start as usize..end as usize], stride))
    }

    /// The elements of an accessor, each of `N` numbers.
    pub(super) fn elements<const N: usize>(
        &self,
        accessor: &Json<'a>,
    ) -> Result<Vec<[f64; N]>, ImportError> {
        let kind = accessor.need("type")?;
        let expected = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][N];
        if kind.text()? != expected {
            return Err(kind.error(format!("{expected} is needed, found {}", kind.text()?)));
        }
        let count = accessor.need("count")?.whole()?;
        let component = component(&accessor.need("componentType")?)?;
        let normalized = accessor.get("normalized").is_some_and(|flag| flag.is_true());
        let mut elements = match accessor.get("bufferView") {
            Some(view) => {
                let view = view.follow(&self.root, "bufferViews")?;
                let offset = accessor.whole_or("byteOffset", 0)?;
                self.decode(accessor, (&view, offset), component, count)?
            }
            None if count <= MOST_ZEROS => vec![[0.0; N]; count as usize],
            None => return Err(accessor.error(format!("{count} elements have no bytes"))),
        };
        if let Some(sparse) = accessor.get("sparse") {
            self.replace(&sparse, component, &mut elements)?;
        }
        for (index, element) in elements.iter_mut().enumerate() {
            if element.iter().any(|x| !x.is_finite()) {
                return Err(accessor.error(format!("element {index} is not finite")));
            }
            if normalized && component.one > 1.0 {
                // Both -127 and -128 stand for -1.
                *element = element.map(|x| (x / component.one).max(-1.0));
            }
        }
        Ok(elements)
    }

    /// `count` elements from a byte of a view on.
    fn decode<const N: usize>(
        &self,
        place: &Json<'a>,
        (view, offset): (&Json<'a>, u64),
        component: Component,
        count: u64,
    ) -> Result<Vec<[f64; N]>, ImportError> {
        let (bytes, stride) = self.view(view)?;
        let size = component.bytes * N;
        let stride = stride.unwrap_or(size);
        // The last element needs no stride behind it.
        let end = count.checked_sub(1).map_or(Some(0), |last| {
            last.checked_mul(stride as u64)?.checked_add(size as u64)?.checked_add(offset)
        });
        if end.is_none_or(|end| end > bytes.len() as u64) {
            let has = bytes.len();
            let cause = format!(
                "{count} elements are promised, more than the {has} bytes of {} hold",
                view.key()
            );
            return Err(place.error(cause));
        }
        let element = |i: usize| {
            let start = offset as usize + i * stride;
            std::array::from_fn(|k| {
                let at = start + k * component.bytes;
                (component.read)(&bytes[at..at + component.bytes])
            })
        };
        Ok((0..count as usize).map(element).collect())
    }

    /// Puts the elements of `sparse` in the place of others.
    fn replace<const N: usize>(
        &self,
        sparse: &Json<'a>,
        component: Component,
        elements: &mut [[f64; N]],
    ) -> Result<(), ImportError> {
        let count = sparse.need("count")?.whole()?;
        let part = |key: &str| -> Result<(Json<'a>, Json<'a>, u64), ImportError> {
            let part = sparse.need(key)?;
            let view = part.need("bufferView")?.follow(&self.root, "bufferViews")?;
            let offset = part.whole_or("byteOffset", 0)?;
            Ok((part, view, offset))
        };
        let (indices, view, offset) = part("indices")?;
        let kind = self::component(&indices.need("componentType")?)?;
        let places: Vec<[f64; 1]> = self.decode(&indices, (&view, offset), kind, count)?;
        let (values, view, offset) = part("values")?;
        let new: Vec<[f64; N]> = self.decode(&values, (&view, offset), component, count)?;
        for ([place], value) in places.into_iter().zip(new) {
            let slot = elements.get_mut(place.max(0.0) as usize);
            *slot.ok_or_else(|| indices.error(format!("there is no element {place}")))? = value;
        }
        Ok(())
    }
}

/// What a `componentType` stands for.
fn component(kind: &Json<'_>) -> Result<Component, ImportError> {
    fn bytes<const N: usize>(bytes: &[u8]) -> [u8; N] {
        let mut own = [0; N];
        own.copy_from_slice(bytes);
        own
    }
    let (bytes, one, read): (usize, f64, Read) = match kind.whole()? {
        5120 => (1, 127.0, |b| f64::from(i8::from_le_bytes(bytes(b)))),
        5121 => (1, 255.0, |b| f64::from(b[0])),
        5122 => (2, 32_767.0, |b| f64::from(i16::from_le_bytes(bytes(b)))),
        5123 => (2, 65_535.0, |b| f64::from(u16::from_le_bytes(bytes(b)))),
        5125 => (4, 4_294_967_295.0, |b| f64::from(u32::from_le_bytes(bytes(b)))),
        5126 => (4, 1.0, |b| f64::from(f32::from_le_bytes(bytes(b)))),
        other => return Err(kind.error(format!("there is no component type {other}"))),
    };
    Ok(Component { bytes, read, one })
}

/// What a `uri` leads to: bytes in the text itself, or a file.
pub(super) fn uri_bytes(job: &Job<'_>, uri: &Json<'_>) -> Result<Vec<u8>, ImportError> {
    let text = uri.text()?;
    if let Some(data) = text.strip_prefix("data:") {
        let (kind, body) = data.split_once(',').ok_or_else(|| uri.error("the data has no `,`"))?;
        if !kind.ends_with(";base64") {
            return Err(uri.error("the data is not base64"));
        }
        return STANDARD
            .decode(body)
            .map_err(|error| uri.error(format!("the data is broken: {error}")));
    }
    let name = file_of(text).map_err(|cause| uri.error(cause))?;
    job.read(&job.path_of(&name))
        .map_err(|error| uri.error(format!("`{name}` cannot be read: {error}")))
}

/// The file that a `uri` names, with `%20` and the like decoded.
pub(super) fn file_of(uri: &str) -> Result<String, String> {
    if uri.contains("://") {
        return Err(format!("`{uri}` is not on this machine"));
    }
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|hex| str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()).filter(|_| first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).map_err(|_| format!("`{uri}` is no name in UTF-8"))
}
