//! Small statistics over samples in time.

/// The mean of a sampled signal between two times, by the trapezoidal rule over the samples inside: every sample
/// counts by the time it stands for, so uneven sampling does no harm. `None` when fewer than two samples lie inside.
#[must_use]
pub fn mean_between(time_s: &[f64], values: &[f64], from_s: f64, to_s: f64) -> Option<f64> {
    let inside = window(time_s, from_s, to_s);
    let (time_s, values) = (&time_s[inside.clone()], &values[inside]);
    let length_s = time_s.last()? - time_s.first()?;
    if length_s <= 0.0 {
        return None;
    }
    let area: f64 = (1..time_s.len()).map(|i| 0.5 * (values[i] + values[i - 1]) * (time_s[i] - time_s[i - 1])).sum();
    Some(area / length_s)
}

/// The indices of the samples between two times, both included, with a tolerance of a nanosecond for times that were
/// printed and read back.
#[must_use]
pub fn window(time_s: &[f64], from_s: f64, to_s: f64) -> std::ops::Range<usize> {
    let start = time_s.partition_point(|&t| t < from_s - 1e-9);
    let end = time_s.partition_point(|&t| t <= to_s + 1e-9);
    start..end.max(start)
}

/// The standard error of the mean of samples that may be correlated with their neighbours, from the spread of the
/// means of `batches` consecutive parts. `None` when there are fewer samples than parts, or fewer than two parts.
#[must_use]
pub fn standard_error(values: &[f64], batches: usize) -> Option<f64> {
    let size = values.len() / batches;
    if size < 1 || batches < 2 {
        return None;
    }
    let means: Vec<f64> =
        values.chunks_exact(size).take(batches).map(|part| part.iter().sum::<f64>() / size as f64).collect();
    let mean = means.iter().sum::<f64>() / batches as f64;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (batches - 1) as f64;
    Some((variance / batches as f64).sqrt())
}

/// The smallest change between neighbouring samples that is not zero: the quantum of a coarse sensor, next to nothing of a
/// fine one. Zero when nothing changes.
#[must_use]
pub fn resolution(values: &[f64]) -> f64 {
    let changes = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|&change| change > 0.0);
    changes.reduce(f64::min).unwrap_or(0.0)
}

/// The difference between the greatest and the least value; zero of none.
#[must_use]
pub fn range(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    (high - low).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_weighs_uneven_samples_by_their_time() {
        let time_s = [0.0, 1.0, 1.5, 2.0, 4.0];
        let line: Vec<f64> = time_s.iter().map(|t| 3.0 * t).collect();
        assert_eq!(mean_between(&time_s, &line, 0.0, 4.0), Some(6.0));
        assert_eq!(mean_between(&time_s, &line, 1.0, 2.0), Some(4.5));
        assert_eq!(mean_between(&time_s, &line, 2.1, 3.9), None);
    }

    #[test]
    fn the_standard_error_of_white_noise_falls_with_the_square_root_of_its_length() {
        use rand_distr::{Distribution, StandardNormal};
        let mut rng = crate::numeric::rng::Seed(7).stream("test", 0);
        let noise: Vec<f64> = StandardNormal.sample_iter(&mut rng).take(40_000).collect();
        let error = standard_error(&noise, 40).unwrap();
        assert!((error - 0.005).abs() < 0.002, "{error}");
        assert_eq!(standard_error(&noise[..5], 10), None);
        assert_eq!(standard_error(&[1.0, 3.0], 2), Some(1.0));
    }
}
