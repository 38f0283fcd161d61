//! Axes of the plots.

use super::super::svg::Svg;
use super::{HIGH, LEFT, RIGHT, WIDTH};

/// Vertical axis of a plot whose upper edge is `top`. `y` is the height of a value.
pub fn values(svg: &mut Svg, top: f64, name: &str, marks: &[f64], y: impl Fn(f64) -> f64) {
    let middle = top + 0.5 * HIGH;
    svg.element("text")
        .with(
            "transform",
            format_args!("translate(24,{middle:.1}) rotate(-90)"),
        )
        .with("text-anchor", "middle")
        .text(name);
    for mark in marks {
        let at = y(*mark);
        svg.across(at, LEFT, format_args!("{:.1}", WIDTH - RIGHT))
            .stroke("#999", 0.6)
            .end();
        svg.element("text")
            .xy(LEFT - 3.0, at + 3.0)
            .with("text-anchor", "end")
            .text(mark);
    }
}

/// Axis of time below all plots.
pub fn time(svg: &mut Svg, seconds: f64, top: f64) {
    let step = [1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 1800.0]
        .into_iter()
        .find(|step| seconds / step <= 12.0)
        .unwrap_or(3600.0);
    let width = WIDTH - LEFT - RIGHT;
    let mut at = 0.0;
    while at <= seconds {
        svg.element("text")
            .xy(LEFT + width * at / seconds, top + 12.0)
            .with("text-anchor", "middle")
            .text(format_args!("{at} s"));
        at += step;
    }
}
