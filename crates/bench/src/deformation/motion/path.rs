//! Figures of a path over time that swings about zero.

/// Root of the mean square of the difference of two paths, over the scale; of the ticks that both
/// have.
pub(super) fn rms(path: &[f64], exact: &[f64], scale: f64) -> f64 {
    let count = path.len().min(exact.len()) as f64;
    let sum: f64 = path.iter().zip(exact).map(|(a, b)| (a - b) * (a - b)).sum();
    (sum / count).sqrt() / scale.abs()
}

/// Largest difference of two paths, over the scale.
pub(super) fn largest(path: &[f64], exact: &[f64], scale: f64) -> f64 {
    let differences = path.iter().zip(exact).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / scale.abs()
}

/// Times at which a path changes its sign, in ticks.
pub(super) fn crossings(path: &[f64]) -> Vec<f64> {
    let pairs = path.windows(2).enumerate();
    pairs
        .filter(|(_, pair)| (pair[0] > 0.0) != (pair[1] > 0.0))
        .map(|(k, pair)| k as f64 + pair[0] / (pair[0] - pair[1]))
        .collect()
}

/// Swings of a path that starts at its amplitude.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Swings {
    /// From the first change of sign to the last within five swings, in ticks; `None` if it changes
    /// sign less than twice.
    pub period: Option<f64>,
    /// Amplitude after n half swings over that of the start, of those that are whole.
    pub kept: Vec<f64>,
}

impl Swings {
    pub(super) fn of(path: &[f64]) -> Self {
        let zeros = crossings(path);
        let counted = &zeros[..zeros.len().min(11)];
        let period = (counted.len() > 1)
            .then(|| 2.0 * (counted[counted.len() - 1] - counted[0]) / (counted.len() - 1) as f64);
        let start = path.first().map_or(1.0, |first| first.abs());
        let kept = zeros.windows(2).map(|pair| {
            let swing = &path[pair[0] as usize..=pair[1] as usize];
            swing.iter().fold(0.0, |most: f64, z| most.max(z.abs())) / start
        });
        Self {
            period,
            kept: [1.0].into_iter().chain(kept).collect(),
        }
    }

    /// Period and amplitude beside those of the exact path, in words.
    pub(super) fn beside(&self, exact: &Self, dt_s: f64) -> String {
        let period = match (self.period, exact.period) {
            (Some(own), Some(exact)) => format!(
                "period {:.4} s ({:+.2} % of the exact step's)",
                own * dt_s,
                (own / exact - 1.0) * 100.0
            ),
            (None, Some(exact)) => format!("no swing (exact step: {:.4} s)", exact * dt_s),
            (Some(own), None) => format!("period {:.4} s (exact step: no swing)", own * dt_s),
            (None, None) => "no swing, as the exact step".to_owned(),
        };
        // After whole swings: every second.
        let swings = (exact.kept.len() - 1).min(10) / 2;
        let (kept, right) = (self.kept.get(2 * swings), exact.kept[2 * swings]);
        let kept = kept.map_or("none".to_owned(), |kept| {
            format!("{kept:.4} ({:+.1} %)", (kept / right - 1.0) * 100.0)
        });
        format!("{period}, amplitude after {swings} swings {kept} of {right:.4}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_cosine_has_its_period_and_decrement() {
        let path: Vec<f64> = (0..1000)
            .map(f64::from)
            .map(|t| (-t / 500.0).exp() * (t * std::f64::consts::TAU / 100.0).cos())
            .collect();
        let swings = Swings::of(&path);
        assert!((swings.period.unwrap() - 100.0).abs() < 1e-3);
        // Peaks are off the tick by less than one, and the path is even there.
        for (half, kept) in swings.kept.iter().enumerate().skip(1) {
            let right = (-(half as f64) * 0.1).exp();
            assert!(
                (kept / right - 1.0).abs() < 3e-3,
                "{half}: {kept} of {right}"
            );
        }
        assert!((rms(&path, &[0.0; 10], 2.0) - 0.5).abs() < 0.1);
        assert_eq!(largest(&path, &vec![0.0; 1000], 2.0), 0.5);
        assert!(swings.beside(&swings, 1e-3).contains("after 5 swings"));
        assert_eq!(Swings::of(&[1.0, 0.5]).period, None);
    }
}
