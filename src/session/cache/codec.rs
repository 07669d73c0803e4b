//! Values and arrays as little-endian bytes, and back with every length checked.

/// Why bytes do not hold what they should: a few words.
pub(in crate::session) type Unsound = &'static str;

/// A value of a fixed number of bytes.
pub(in crate::session) trait Item: Copy {
    /// How many.
    const BYTES: usize;
    /// Writes it into that many bytes.
    fn put(self, bytes: &mut [u8]);
    /// Reads it from that many bytes, which are sound.
    fn take(bytes: &[u8]) -> Self;
    /// Whether that many bytes are a value of this type.
    #[inline(always)]
    fn sound(_bytes: &[u8]) -> bool {
        true
    }
}

macro_rules! number {
    ($($number:ty),*) => { $(
        impl Item for $number {
            const BYTES: usize = size_of::<$number>();
            #[inline(always)]
            fn put(self, bytes: &mut [u8]) {
                bytes.copy_from_slice(&self.to_le_bytes());
            }
            #[inline(always)]
            fn take(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<$number>()];
                own.copy_from_slice(bytes);
                <$number>::from_le_bytes(own)
            }
        }
    )* };
}
number!(u8, u16, u32, u64, u128, f32, f64);

impl Item for bool {
    const BYTES: usize = 1;
    #[inline(always)]
    fn put(self, bytes: &mut [u8]) {
        bytes[0] = u8::from(self);
    }
    #[inline(always)]
    fn take(bytes: &[u8]) -> bool {
        bytes[0] != 0
    }
    #[inline(always)]
    fn sound(bytes: &[u8]) -> bool {
        bytes[0] <= 1
    }
}

/// Makes a struct an [`Item`]: its fields one after the other. All fields must be named.
macro_rules! record {
    ($name:ident { $($field:ident: $type:ty),* $(,)? }) => {
        impl $crate::session::cache::codec::Item for $name {
            const BYTES: usize =
                0 $(+ <$type as $crate::session::cache::codec::Item>::BYTES)*;
            #[inline(always)]
            fn put(self, bytes: &mut [u8]) {
                use $crate::session::cache::codec::Item;
                let $name { $($field),* } = self;
                let rest = bytes;
                $( let (own, rest) = rest.split_at_mut(<$type as Item>::BYTES);
                   Item::put($field, own); )*
                debug_assert!(rest.is_empty());
            }
            #[inline(always)]
            fn take(bytes: &[u8]) -> Self {
                use $crate::session::cache::codec::Item;
                let rest = bytes;
                $( let (own, rest) = rest.split_at(<$type as Item>::BYTES);
                   let $field = <$type as Item>::take(own); )*
                debug_assert!(rest.is_empty());
                $name { $($field),* }
            }
            #[inline(always)]
            fn sound(bytes: &[u8]) -> bool {
                use $crate::session::cache::codec::Item;
                let rest = bytes;
                let mut all = true;
                $( let (own, rest) = rest.split_at(<$type as Item>::BYTES);
                   all &= <$type as Item>::sound(own); )*
                all & rest.is_empty()
            }
        }
    };
}
pub(super) use record;

/// Bytes in the making.
#[derive(Default)]
pub(in crate::session) struct Section {
    /// What was written so far.
    pub(in crate::session) bytes: Vec<u8>,
    /// Bytes of memory that the arrays written so far take when they are read.
    pub(in crate::session) held: u64,
}

impl Section {
    /// Empties it and keeps its memory.
    pub(in crate::session) fn clear(&mut self) {
        self.bytes.clear();
        self.held = 0;
    }

    /// Appends one value.
    pub(in crate::session) fn value<T: Item>(&mut self, value: T) {
        let at = self.bytes.len();
        self.bytes.resize(at + T::BYTES, 0);
        value.put(&mut self.bytes[at..]);
    }

    /// Appends the length and the items of an array.
    pub(in crate::session) fn array<T: Item>(&mut self, items: &[T]) {
        self.value(items.len() as u64);
        self.held += size_of_val(items) as u64;
        let at = self.bytes.len();
        self.bytes.resize(at + items.len() * T::BYTES, 0);
        for (bytes, item) in self.bytes[at..].chunks_exact_mut(T::BYTES).zip(items) {
            item.put(bytes);
        }
    }
}

/// Bytes being read.
pub(in crate::session) struct Source<'a> {
    rest: &'a [u8],
    /// Bytes of memory that the arrays read so far take.
    pub(in crate::session) held: u64,
}

impl<'a> Source<'a> {
    /// From the first byte on.
    pub(in crate::session) fn new(bytes: &'a [u8]) -> Source<'a> {
        Source { rest: bytes, held: 0 }
    }

    /// The next value.
    pub(in crate::session) fn value<T: Item>(&mut self) -> Result<T, Unsound> {
        let (bytes, rest) = self.rest.split_at_checked(T::BYTES).ok_or("it ends too early")?;
        self.rest = rest;
        if T::sound(bytes) { Ok(T::take(bytes)) } else { Err("a value is not of its kind") }
    }

    /// The next array, in memory of exactly its size.
    pub(in crate::session) fn array<T: Item>(&mut self) -> Result<Vec<T>, Unsound> {
        let count = usize::try_from(self.value::<u64>()?).unwrap_or(usize::MAX);
        let bytes = count.checked_mul(T::BYTES).and_then(|n| self.rest.split_at_checked(n));
        let (bytes, rest) = bytes.ok_or("an array is longer than what is there")?;
        self.rest = rest;
        self.held += (count * size_of::<T>()) as u64;
        let items = bytes.chunks_exact(T::BYTES);
        if !items.clone().all(T::sound) {
            return Err("an item of an array is not of its kind");
        }
        Ok(items.map(T::take).collect())
    }

    /// Whether all was read.
    pub(in crate::session) fn end(self) -> Result<(), Unsound> {
        if self.rest.is_empty() { Ok(()) } else { Err("something follows its end") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Pair {
        wide: u32,
        small: bool,
    }
    record!(Pair { wide: u32, small: bool });

    #[test]
    fn what_was_written_is_read() {
        let pairs = [Pair { wide: 0x0102_0304, small: true }, Pair { wide: 7, small: false }];
        let mut section = Section::default();
        section.value(-0.0f64);
        section.array(&pairs);
        section.array::<f32>(&[]);
        section.value(u128::MAX - 1);
        assert_eq!(section.held, 16);
        assert_eq!(section.bytes[16..21], [4, 3, 2, 1, 1]);
        let mut source = Source::new(&section.bytes);
        assert_eq!(source.value::<f64>().map(f64::to_bits), Ok(1 << 63));
        assert_eq!(source.array::<Pair>().unwrap(), pairs);
        assert_eq!(source.array::<f32>(), Ok(Vec::new()));
        assert_eq!(source.held, 16);
        assert_eq!(source.value::<u128>(), Ok(u128::MAX - 1));
        assert_eq!(source.end(), Ok(()));
    }

    #[test]
    fn bytes_that_are_no_values_and_lengths_beyond_the_end_are_refused() {
        let mut section = Section::default();
        section.array(&[Pair { wide: 1, small: true }]);
        let sound = section.bytes;
        assert!(Source::new(&sound).array::<Pair>().is_ok());
        for cut in 0..sound.len() {
            assert!(Source::new(&sound[..cut]).array::<Pair>().is_err(), "{cut} bytes");
        }
        let mut other = sound.clone();
        other[12] = 2;
        assert_eq!(
            Source::new(&other).array::<Pair>(),
            Err("an item of an array is not of its kind")
        );
        for (at, byte) in [(0, 2), (3, 1), (7, 255), (6, 128)] {
            let mut longer = sound.clone();
            longer[at] = byte;
            assert!(Source::new(&longer).array::<Pair>().is_err(), "{byte} at {at}");
        }
        let mut source = Source::new(&sound);
        assert_eq!(source.value::<u64>(), Ok(1));
        assert_eq!(source.end(), Err("something follows its end"));
    }
}
