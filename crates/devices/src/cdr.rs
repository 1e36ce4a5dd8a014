//! Common Data Representation, as DDS and ROS 2 write messages: XCDR version 1.
//!
//! Four bytes name the byte order, then follow the fields in their order. A number starts at a multiple
//! of its size, counted from the fifth byte. Texts carry a length that includes a closing zero; lists
//! carry a count. Little-endian is written; both orders are read.

/// The encapsulation header of what is written: CDR, little-endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];
/// Bytes that may follow a message: some writers fill the last word.
const PADDING: usize = 7;

/// Why bytes are not the message they should be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// The bytes end before the message does.
    #[error("truncated: {need} more bytes were expected after byte {at} of {size}")]
    Truncated {
        /// Where they should be.
        at: usize,
        /// How many.
        need: usize,
        /// Bytes that there are.
        size: usize,
    },
    /// Neither little- nor big-endian CDR.
    #[error(
        "the encapsulation header is {0:02x?}; understood are 00 01 (CDR little-endian) and 00 00 (big-endian)"
    )]
    Representation([u8; 2]),
    /// A text that is not UTF-8, or does not end in zero.
    #[error("the text at byte {at} is not UTF-8 that ends in a zero byte")]
    Text {
        /// Where its length is.
        at: usize,
    },
    /// A flag that is neither 0 nor 1.
    #[error("the flag at byte {at} is {value}, not 0 or 1")]
    Flag {
        /// Where it is.
        at: usize,
        /// What it is.
        value: u8,
    },
    /// More bytes than a message has.
    #[error("{0} bytes follow the message")]
    Trailing(usize),
}

/// Bytes being written.
#[derive(Clone, Debug)]
pub struct CdrWriter {
    bytes: Vec<u8>,
}

impl Default for CdrWriter {
    fn default() -> Self {
        Self {
            bytes: HEADER.to_vec(),
        }
    }
}

impl CdrWriter {
    fn put<const N: usize>(&mut self, value: [u8; N]) {
        let past = (self.bytes.len() - HEADER.len()) % N;
        if past > 0 {
            self.bytes.resize(self.bytes.len() + N - past, 0);
        }
        self.bytes.extend_from_slice(&value);
    }

    /// The message with its header.
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

/// Bytes being read.
#[derive(Clone, Debug)]
pub struct CdrReader<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl<'a> CdrReader<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// No header, or one of another representation.
    pub fn new(bytes: &'a [u8]) -> Result<Self, CdrError> {
        let Some(header) = bytes.first_chunk::<4>() else {
            return Err(CdrError::Truncated {
                at: 0,
                need: 4,
                size: bytes.len(),
            });
        };
        let big = match header[..2] {
            [0, 0] => true,
            [0, 1] => false,
            _ => return Err(CdrError::Representation([header[0], header[1]])),
        };
        Ok(Self {
            bytes,
            at: HEADER.len(),
            big,
        })
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], CdrError> {
        let left = self.bytes.get(self.at..).unwrap_or_default();
        let taken = left.get(..count).ok_or(CdrError::Truncated {
            at: self.at,
            need: count - left.len().min(count),
            size: self.bytes.len(),
        })?;
        self.at += count;
        Ok(taken)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        let past = (self.at - HEADER.len()) % N;
        if past > 0 {
            self.take(N - past)?;
        }
        let mut value = [0; N];
        value.copy_from_slice(self.take(N)?);
        if self.big {
            value.reverse();
        }
        Ok(value)
    }

    /// Checks that nothing but padding follows.
    ///
    /// # Errors
    /// More bytes than that.
    pub fn finish(self) -> Result<(), CdrError> {
        match self.bytes.len() - self.at {
            left if left > PADDING => Err(CdrError::Trailing(left)),
            _ => Ok(()),
        }
    }
}

/// What has a place in a CDR message.
pub trait Cdr: Sized {
    /// Appends it.
    fn write(&self, out: &mut CdrWriter);
    /// Takes it.
    ///
    /// # Errors
    /// The bytes are not one.
    fn read(from: &mut CdrReader<'_>) -> Result<Self, CdrError>;
}

macro_rules! numbers {
    ($($number:ty),*) => {$(
        impl Cdr for $number {
            fn write(&self, out: &mut CdrWriter) {
                out.put(self.to_le_bytes());
            }

            fn read(from: &mut CdrReader<'_>) -> Result<Self, CdrError> {
                from.number().map(Self::from_le_bytes)
            }
        }
    )*};
}
numbers!(u8, i32, u32, f32, f64);

impl Cdr for bool {
    fn write(&self, out: &mut CdrWriter) {
        u8::from(*self).write(out);
    }

    fn read(from: &mut CdrReader<'_>) -> Result<Self, CdrError> {
        let at = from.at;
        match u8::read(from)? {
            0 => Ok(false),
            1 => Ok(true),
            value => Err(CdrError::Flag { at, value }),
        }
    }
}

impl Cdr for String {
    fn write(&self, out: &mut CdrWriter) {
        (self.len() as u32 + 1).write(out);
        out.bytes.extend_from_slice(self.as_bytes());
        out.bytes.push(0);
    }

    /// Some writers give an empty text the length 0, others 1 and a zero byte.
    fn read(from: &mut CdrReader<'_>) -> Result<Self, CdrError> {
        let at = from.at;
        let length = u32::read(from)? as usize;
        if length == 0 {
            return Ok(Self::new());
        }
        match from.take(length)?.split_last() {
            Some((0, text)) => std::str::from_utf8(text)
                .map(str::to_owned)
                .map_err(|_| CdrError::Text { at }),
            _ => Err(CdrError::Text { at }),
        }
    }
}

impl<T: Cdr> Cdr for Vec<T> {
    fn write(&self, out: &mut CdrWriter) {
        (self.len() as u32).write(out);
        self.iter().for_each(|item| item.write(out));
    }

    fn read(from: &mut CdrReader<'_>) -> Result<Self, CdrError> {
        let count = u32::read(from)? as usize;
        // A count that the bytes cannot hold must not reserve memory: every item has a byte at least.
        let left = from.bytes.len() - from.at;
        if count > left {
            return Err(CdrError::Truncated {
                at: from.at,
                need: count - left,
                size: from.bytes.len(),
            });
        }
        (0..count).map(|_| T::read(from)).collect()
    }
}

impl<T: Cdr + Copy + Default, const N: usize> Cdr for [T; N] {
    fn write(&self, out: &mut CdrWriter) {
        self.iter().for_each(|item| item.write(out));
    }

    fn read(from: &mut CdrReader<'_>) -> Result<Self, CdrError> {
        let mut items = [T::default(); N];
        for item in &mut items {
            *item = T::read(from)?;
        }
        Ok(items)
    }
}

/// A message as bytes, with the header.
pub fn encode(message: &impl Cdr) -> Vec<u8> {
    let mut out = CdrWriter::default();
    message.write(&mut out);
    out.finish()
}

/// Reads a whole message.
///
/// # Errors
/// The bytes are not one.
pub fn decode<M: Cdr>(bytes: &[u8]) -> Result<M, CdrError> {
    let mut from = CdrReader::new(bytes)?;
    let message = M::read(&mut from)?;
    from.finish()?;
    Ok(message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(length: u32, rest: &[u8]) -> Result<String, CdrError> {
        let mut bytes = HEADER.to_vec();
        bytes.extend(length.to_le_bytes());
        bytes.extend(rest);
        decode(&bytes)
    }

    #[test]
    fn an_empty_text_may_have_the_length_0_or_1() {
        assert_eq!(text_of(0, &[]).as_deref(), Ok(""));
        assert_eq!(text_of(1, &[0]).as_deref(), Ok(""));
        assert_eq!(text_of(3, b"ab\0").as_deref(), Ok("ab"));
    }

    #[test]
    fn a_text_longer_than_its_bytes_is_truncated_and_reserves_nothing() {
        for length in [2_u32, 1 << 31, u32::MAX] {
            let error = text_of(length, &[0]).unwrap_err();
            assert!(matches!(error, CdrError::Truncated { .. }), "{error}");
        }
        let error = decode::<Vec<f64>>(&[0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff]).unwrap_err();
        assert!(matches!(error, CdrError::Truncated { .. }), "{error}");
    }

    #[test]
    fn a_text_without_its_zero_or_not_utf8_is_refused() {
        for rest in [&b"abc"[..], &[0xff, 0xfe, 0]] {
            let error = text_of(rest.len() as u32, rest).unwrap_err();
            assert_eq!(error, CdrError::Text { at: 4 });
        }
    }

    #[test]
    fn big_endian_reads_as_little_endian() {
        let little = encode(&vec![0.5, -1.0]);
        let mut big = vec![0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0];
        big.extend(0.5_f64.to_be_bytes());
        big.extend((-1.0_f64).to_be_bytes());
        assert_eq!(decode::<Vec<f64>>(&big), decode::<Vec<f64>>(&little));
    }

    #[test]
    fn other_representations_are_named() {
        for header in [[0, 2], [0, 3], [0, 7], [1, 0], [0xff, 0xff]] {
            let bytes = [header[0], header[1], 0, 0, 0, 0, 0, 0];
            assert_eq!(decode::<i32>(&bytes), Err(CdrError::Representation(header)));
        }
    }

    #[test]
    fn numbers_start_at_multiples_of_their_size_from_the_fifth_byte() {
        let mut out = CdrWriter::default();
        true.write(&mut out);
        1.0_f64.write(&mut out);
        2_u8.write(&mut out);
        3_i32.write(&mut out);
        assert_eq!(out.finish().len(), 4 + 8 + 8 + 1 + 3 + 4);
    }

    #[test]
    fn padding_is_accepted_and_more_is_not() {
        let mut bytes = encode(&7_i32);
        bytes.extend([0; PADDING]);
        assert_eq!(decode::<i32>(&bytes), Ok(7));
        bytes.push(0);
        assert_eq!(decode::<i32>(&bytes), Err(CdrError::Trailing(8)));
    }

    /// A number of a seeded series (xorshift, 64 bits).
    struct Series(u64);

    impl Series {
        fn next(&mut self) -> u64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            self.0
        }

        fn below(&mut self, end: usize) -> usize {
            (self.next() % end as u64) as usize
        }

        fn list<T>(&mut self, most: usize, mut of: impl FnMut(&mut Self) -> T) -> Vec<T> {
            (0..self.below(most + 1)).map(|_| of(self)).collect()
        }
    }

    // Numbers are of any bits, so that NaN, infinities and subnormal ones are among them.
    #[test]
    fn what_is_written_is_read() {
        let mut series = Series(0x1234_5678_9abc_def1);
        for _ in 0..2_000 {
            let texts = ["", "a", "\u{0}", "é", "力", "\u{10ffff}", "\n"];
            let text = series.list(20, |s| texts[s.below(texts.len())]).concat();
            let (flag, number) = (series.below(2) == 1, series.next() as i32);
            let list = series.list(40, |s| f64::from_bits(s.next()));
            let single = f32::from_bits(series.next() as u32);
            let mut out = CdrWriter::default();
            text.write(&mut out);
            flag.write(&mut out);
            list.write(&mut out);
            number.write(&mut out);
            single.write(&mut out);
            let bytes = out.finish();
            let mut from = CdrReader::new(&bytes).unwrap();
            assert_eq!(String::read(&mut from).unwrap(), text);
            assert_eq!(bool::read(&mut from).unwrap(), flag);
            let bits = |list: &[f64]| list.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&Vec::read(&mut from).unwrap()), bits(&list));
            assert_eq!(i32::read(&mut from).unwrap(), number);
            assert_eq!(f32::read(&mut from).unwrap().to_bits(), single.to_bits());
            assert!(from.finish().is_ok());
        }
    }

    #[test]
    fn bytes_of_no_message_are_errors_and_never_panic() {
        let mut series = Series(0x0dd0_feed_5eed_0001);
        for _ in 0..20_000 {
            let mut bytes = series.list(80, |s| s.next() as u8);
            // Half of them begin as a message does.
            if series.below(2) == 1 && bytes.len() >= 4 {
                bytes[..4].copy_from_slice(&HEADER);
            }
            let _ = decode::<String>(&bytes);
            let _ = decode::<Vec<String>>(&bytes);
            let _ = decode::<[f64; 7]>(&bytes);
        }
    }
}
