//! Decimal numbers as exchange files write them.

/// The shortest decimal that reads back as the same bits, with a decimal point and the format's
/// exponent letter: `0.1`, `1.0`, `1.E-7`, `1.D-7`.
pub(super) fn real(value: f64, exponent: char) -> String {
    let text = format!("{value:?}");
    match text.split_once('e') {
        None => text,
        Some((mantissa, power)) => {
            let point = if mantissa.contains('.') { "" } else { "." };
            format!("{mantissa}{point}{exponent}{power}")
        }
    }
}

/// A finite number with `E` or `D` before its exponent. `None` for anything else: words such as `inf`, and what is
/// beyond the largest number there is.
pub(super) fn parse(text: &[u8]) -> Option<f64> {
    // Longer than any decimal of an f64: such a token is not a number.
    if text.is_empty() || text.len() > 400 {
        return None;
    }
    let mut plain = String::with_capacity(text.len());
    for &byte in text {
        plain.push(match byte {
            b'0'..=b'9' | b'+' | b'-' | b'.' => char::from(byte),
            b'E' | b'e' | b'D' | b'd' => 'e',
            _ => return None,
        });
    }
    plain.parse().ok().filter(|x: &f64| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::testing::Random;

    #[test]
    fn numbers_read_back_bit_for_bit() {
        let mut random = Random(3);
        let some = [
            0.0,
            -0.0,
            1.0,
            0.1,
            1e-7,
            -2.5e300,
            f64::MIN_POSITIVE,
            5e-324,
            f64::MAX,
            1e16,
            123_456_789.125,
        ];
        let more = (0..10_000)
            .map(|_| f64::from_bits(random.word()))
            .filter(|x| x.is_finite());
        for value in some.into_iter().chain(more.collect::<Vec<_>>()) {
            for letter in ['E', 'D'] {
                let text = real(value, letter);
                assert!(text.contains('.'), "{text} has no decimal point");
                assert_eq!(
                    parse(text.as_bytes()).map(f64::to_bits),
                    Some(value.to_bits()),
                    "{text}"
                );
            }
        }
    }

    #[test]
    fn words_are_no_numbers() {
        for text in [
            "", "inf", "nan", "1.0x", "--1", "1e", ".", "1.2.3", "E5", "1e400", "-1D309",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
        assert_eq!(
            (parse(b"1."), parse(b".5D1"), parse(b"+3")),
            (Some(1.0), Some(5.0), Some(3.0))
        );
    }
}
