//! A plot as SVG: curves over two axes.

use std::fmt::Write;

use super::experiments::Curve;

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 44.0;
const COLOURS: [&str; 4] = ["#1b6ca8", "#d1495b", "#3a7d44", "#8d5a97"];
/// Points of a curve closer than this to the line through their neighbours are left out, in pixels.
const STRAIGHT: f64 = 0.15;

/// A picture of curves with names; names that are empty have no entry in the legend.
pub fn svg(title: &str, [x_label, y_label]: [&str; 2], curves: &[(&str, Curve)]) -> String {
    let all = || curves.iter().flat_map(|(_, curve)| curve);
    let range = |axis: usize| {
        let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point[axis]), high.max(point[axis]))
        });
        let room = 0.04 * (high - low).max(1e-12);
        (low - room, high + room)
    };
    let ((x0, x1), (y0, y1)) = (range(0), range(1));
    let to_x = |x: f64| LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT);
    let to_y = |y: f64| HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM);
    let mut out = String::new();
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" \
         height=\"{HEIGHT}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n\
         <text x=\"{LEFT}\" y=\"18\" font-size=\"13\">{title}</text>\n"
    );
    for x in ticks(x0, x1) {
        let at = to_x(x);
        let _ = writeln!(
            out,
            "<path d=\"M{at:.1} {TOP}V{:.1}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 14.0,
            short(x)
        );
    }
    for y in ticks(y0, y1) {
        let at = to_y(y);
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT} {at:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" \
             text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 5.0,
            at + 4.0,
            short(y)
        );
    }
    let _ = write!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_label}</text>\n\
         <text transform=\"translate(14 {:.1}) rotate(-90)\" text-anchor=\"middle\">{y_label}</text>\n",
        0.5 * (LEFT + WIDTH - RIGHT),
        HEIGHT - 10.0,
        0.5 * (TOP + HEIGHT - BOTTOM)
    );
    let mut legend = LEFT + 8.0;
    for ((name, curve), colour) in curves.iter().zip(COLOURS.iter().cycle()) {
        let points: Vec<[f64; 2]> = curve.iter().map(|[x, y]| [to_x(*x), to_y(*y)]).collect();
        let _ = write!(out, "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.4\" points=\"");
        for [x, y] in thinned(&points) {
            let _ = write!(out, "{x:.1},{y:.1} ");
        }
        out.push_str("\"/>\n");
        if !name.is_empty() {
            let _ = writeln!(
                out,
                "<path d=\"M{legend:.1} 28h16\" stroke=\"{colour}\" stroke-width=\"2\"/><text x=\"{:.1}\" \
                 y=\"32\">{name}</text>",
                legend + 20.0
            );
            legend += 32.0 + 6.2 * name.len() as f64;
        }
    }
    out.push_str("</svg>\n");
    out
}

/// Round numbers within an interval, about five.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let raw = (high - low) / 5.0;
    let power = 10_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * power).into_iter().find(|s| *s >= raw).unwrap_or(raw);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

fn short(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// The points that a line needs to look the same.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut start = 0;
    for end in 1..points.len() {
        let ([ax, ay], [bx, by]) = (points[start], points[end]);
        let length = (bx - ax).hypot(by - ay).max(1e-9);
        let off = points[start..end].iter().any(|[x, y]| {
            let across = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)).abs() / length;
            let along = ((bx - ax) * (x - ax) + (by - ay) * (y - ay)) / length;
            across > STRAIGHT || along > length + STRAIGHT
        });
        if off {
            kept.push(points[start]);
            start = end - 1;
        }
    }
    kept.extend(points.get(start));
    kept.extend(points.last());
    kept
}
