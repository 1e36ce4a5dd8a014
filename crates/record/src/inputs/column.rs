//! Sequences of numbers as what each is off the polynomial through those before it, without loss.
//!
//! A hand moves smoothly: from one millisecond to the next, a polynomial of high order leaves one or
//! two of the eight bytes of a number.

use palpate_proto::recording as pb;
use prost::encoding::encoded_len_varint;

/// Largest order: beyond, rounding of the values themselves grows more than the rest shrinks.
const MOST: u32 = 12;

/// A number with a place among the integers, in its order.
pub(super) trait Number: Copy {
    fn place(self) -> i64;
    fn at(place: i64) -> Self;
    /// Place of the sum of these, with their factors.
    fn sum(terms: impl Iterator<Item = (i64, Self)>) -> i64;
}

impl Number for u64 {
    fn place(self) -> i64 {
        self as i64
    }

    fn at(place: i64) -> Self {
        place as u64
    }

    fn sum(terms: impl Iterator<Item = (i64, Self)>) -> i64 {
        terms.fold(0, |sum, (factor, x)| {
            sum.wrapping_add(factor.wrapping_mul(x.place()))
        })
    }
}

impl Number for f64 {
    fn place(self) -> i64 {
        let bits = self.to_bits() as i64;
        if bits < 0 { bits ^ i64::MAX } else { bits }
    }

    fn at(place: i64) -> Self {
        let bits = if place < 0 { place ^ i64::MAX } else { place };
        Self::from_bits(bits as u64)
    }

    fn sum(terms: impl Iterator<Item = (i64, Self)>) -> i64 {
        let sum = terms.fold(0.0, |sum, (factor, x)| sum + factor as f64 * x);
        // The bits of a NaN depend on the processor.
        if sum.is_finite() { sum.place() } else { 0 }
    }
}

/// Where the polynomial through the last `order` values puts the next one.
fn extrapolated<T: Number>(before: &[T], order: u32) -> i64 {
    let most = before.len().min(order as usize) as i64;
    let mut factor = -1;
    T::sum(before.iter().rev().zip(1..=most).map(|(&x, j)| {
        // Binomial coefficients with alternating signs.
        factor = -factor * (most - j + 1) / j;
        (factor, x)
    }))
}

fn residuals<T: Number>(values: &[T], order: u32) -> impl Iterator<Item = i64> {
    let off = move |k: usize| {
        let (before, value): (_, T) = (&values[..k], values[k]);
        value.place().wrapping_sub(extrapolated(before, order))
    };
    (0..values.len()).map(off)
}

/// The sequence, with the order that needs least.
pub(super) fn packed<T: Number>(values: &[T]) -> pb::Column {
    let len = |order: &u32| -> usize {
        let zigzag = |off: i64| ((off << 1) ^ (off >> 63)) as u64;
        residuals(values, *order)
            .map(|off| encoded_len_varint(zigzag(off)))
            .sum()
    };
    let order = (0..=MOST).min_by_key(len).unwrap_or(0);
    pb::Column {
        order,
        residuals: residuals(values, order).collect(),
    }
}

/// The sequence again.
///
/// # Errors
/// An order that is too large.
pub(super) fn unpacked<T: Number>(column: &pb::Column) -> Result<Vec<T>, String> {
    if column.order > MOST {
        return Err(format!("a column of order {}, above {MOST}", column.order));
    }
    let mut values = Vec::with_capacity(column.residuals.len());
    for off in &column.residuals {
        let place = off.wrapping_add(extrapolated(&values, column.order));
        values.push(T::at(place));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_back_at_every_order() {
        let mut floats = vec![
            0.0,
            -0.0,
            f64::MIN_POSITIVE / 8.0,
            -f64::MAX,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::from_bits(0x7ff8_dead_beef_0001),
            f64::from_bits(0xfff0_0000_0000_0001),
            1.0 / 3.0,
        ];
        floats.extend((0..60).map(|k| 0.05 + 1e-4 * libm::sin(0.06 * f64::from(k))));
        let integers: Vec<u64> = [0, u64::MAX, 1, 1 << 63, 7]
            .into_iter()
            .chain((0..40).map(|k| 1_000_000 * k))
            .collect();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        for order in 0..=MOST {
            let column = pb::Column {
                order,
                residuals: residuals(&floats, order).collect(),
            };
            let back: Vec<f64> = unpacked(&column).unwrap();
            assert_eq!(bits(&back), bits(&floats), "order {order}");
            let column = pb::Column {
                order,
                residuals: residuals(&integers, order).collect(),
            };
            assert_eq!(unpacked(&column), Ok(integers.clone()), "order {order}");
        }
        let column = pb::Column {
            order: MOST + 1,
            residuals: vec![0],
        };
        assert!(unpacked::<f64>(&column).is_err());
    }

    // A polynomial is predicted exactly once enough points are known; a smooth motion takes two bytes of eight.
    #[test]
    fn what_is_smooth_is_small() {
        let squares: Vec<u64> = (0..50).map(|k| 100 * k * k).collect();
        let column = packed(&squares);
        assert_eq!(column.order, 3);
        assert!(column.residuals[3..].iter().all(|off| *off == 0));
        let hand: Vec<f64> = (0..1_000)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| 0.05 - 0.004 * t + 1e-4 * libm::sin(60.0 * t) + 3e-5 * libm::cos(45.0 * t))
            .collect();
        let column = packed(&hand);
        let bytes = prost::Message::encoded_len(&column);
        assert!(
            column.order > 5 && bytes < 2_100,
            "{bytes} bytes, order {}",
            column.order
        );
        assert_eq!(unpacked(&column), Ok(hand));
    }
}
