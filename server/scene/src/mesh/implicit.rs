//! Functions for implicit shapes. They use `+ - * /`, square root and `libm` only, so a shape has the same bits on
//! every platform.

/// Returns the smooth minimum: a union whose seam is a fillet of about `k` (Quilez' polynomial form).
pub(crate) fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    let near = sulcus_core::math::fmax(k - (a - b).abs(), 0.0) / k;
    sulcus_core::math::fmin(a, b) - near * near * k * 0.25
}

/// Returns the smooth maximum: an intersection whose edge is rounded by about `k`.
pub(crate) fn smooth_max(a: f64, b: f64, k: f64) -> f64 {
    -smooth_min(-a, -b, k)
}

/// Returns 0 below `from`, 1 above `to`, and a smooth ramp between.
pub(crate) fn ramp(x: f64, from: f64, to: f64) -> f64 {
    let t = sulcus_core::math::fclamp((x - from) / (to - from), 0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Returns a bell of height 1 and given width.
pub(crate) fn bell(x: f64, width: f64) -> f64 {
    let t = x / width;
    libm::exp(-t * t)
}

/// Returns a smooth curve through `(knots[i], values[i])`: cubic Hermite, central slopes, constant beyond its ends.
pub(crate) fn through<const N: usize>(knots: &[f64; N], values: &[f64; N], x: f64) -> f64 {
    if x <= knots[0] {
        return values[0];
    }
    let Some(right) = (1..N).find(|&i| x < knots[i]) else {
        return values[N - 1];
    };
    let left = right - 1;
    let slope = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(N - 1));
        (values[b] - values[a]) / (knots[b] - knots[a])
    };
    let width = knots[right] - knots[left];
    let t = (x - knots[left]) / width;
    let (t2, t3) = (t * t, t * t * t);
    values[left] * (2.0 * t3 - 3.0 * t2 + 1.0)
        + slope(left) * width * (t3 - 2.0 * t2 + t)
        + values[right] * (3.0 * t2 - 2.0 * t3)
        + slope(right) * width * (t3 - t2)
}
