//! Times in percentiles.

use hdrhistogram::Histogram;
use sulcus_proto::Percentiles;

/// Percentiles of a histogram of nanoseconds, in microseconds; `None` when nothing was recorded.
pub fn percentiles(nanoseconds: &Histogram<u64>) -> Option<Percentiles> {
    let at = |q: f64| nanoseconds.value_at_quantile(q) as f64 * 1e-3;
    (!nanoseconds.is_empty()).then(|| Percentiles {
        p50: at(0.5),
        p99: at(0.99),
        p999: at(0.999),
        max: nanoseconds.max() as f64 * 1e-3,
    })
}

/// An empty histogram for times up to a second.
pub fn histogram() -> Histogram<u64> {
    Histogram::new_with_bounds(1, 1_000_000_000, 3).expect("constant bounds are valid")
}
