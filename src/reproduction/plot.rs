//! A figure as SVG. Its colours are classes, which follow the reader's light or dark scheme; where a viewer knows no style
//! sheets, attributes of the same colours stand.

use std::fmt::Write;

use super::figure::{Figure, Line, Look};
use super::text::escaped;

/// Width and height, in units of a pixel on a desk.
const SIZE: (f64, f64) = (460.0, 312.0);
/// What the frame leaves free at the left, the right and below.
const MARGINS: (f64, f64, f64) = (58.0, 20.0, 44.0);
/// The height of a line of letters, and the width of an average one.
const LETTERS: (f64, f64) = (21.0, 7.6);
/// How far a drawn line may be from its points.
const TOLERANCE: f64 = 0.12;
/// The least number of labels on an axis.
const LABELS_MIN: f64 = 4.0;

/// The colours of the levels, in a light and in a dark scheme, and their dashes.
const LEVELS: [(&str, &str, &str); 5] = [
    ("#123f9c", "#79a8ff", ""),
    ("#6d28a8", "#b793ff", "10 3"),
    ("#b52a80", "#f386bd", "6 3"),
    ("#d9502f", "#ff9d76", "7 3 2 3"),
    ("#a06a00", "#ffd35c", "2.5 2.5"),
];
/// The other colours: paper, ink, grid and axis.
const OTHERS: [(&str, &str, &str); 4] = [
    ("paper", "#ffffff", "#14181f"),
    ("ink", "#1c2430", "#e4e8ee"),
    ("grid", "#dfe3e9", "#2b323d"),
    ("axis", "#8a94a3", "#7d8797"),
];

/// The colours and strokes of every figure, for a style sheet.
#[must_use]
pub fn style() -> String {
    let (mut light, mut dark, mut classes) = (String::new(), String::new(), String::new());
    for (name, in_light, in_dark) in OTHERS {
        let _ = write!(light, "--{name}:{in_light};");
        let _ = write!(dark, "--{name}:{in_dark};");
    }
    for (level, (in_light, in_dark, _)) in LEVELS.iter().enumerate() {
        let _ = write!(light, "--l{level}:{in_light};");
        let _ = write!(dark, "--l{level}:{in_dark};");
        let _ = writeln!(classes, ".plot .l{level} {{ stroke: var(--l{level}); }}");
    }
    format!(
        ":root {{ color-scheme: light dark; {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n{}{classes}",
        include_str!("plot.css")
    )
}

/// The level whose colour a line has, and its dashes.
const fn look(look: Look) -> (usize, &'static str) {
    match look {
        Look::Level(level) => (level, LEVELS[level].2),
        Look::Model(0) => (0, ""),
        Look::Model(_) => (3, "6 3"),
        Look::LevelOfModel(level, 0) => (level, ""),
        Look::LevelOfModel(level, _) => (level, "5 3"),
    }
}

/// Draws a figure for a page that has [`style`].
#[must_use]
pub fn inline(figure: &Figure) -> String {
    drawn(figure, "", "")
}

/// Draws a figure for a file of its own.
#[must_use]
pub fn standalone(figure: &Figure) -> String {
    let paper = format!("<rect width=\"100%\" height=\"100%\" fill=\"{0}\" style=\"fill:var(--paper)\"/>", OTHERS[0].1);
    drawn(figure, " xmlns=\"http://www.w3.org/2000/svg\"", &format!("<style>{}</style>\n{paper}\n", style()))
}

fn drawn(figure: &Figure, attributes: &str, first: &str) -> String {
    let (legend, top) = legend(figure);
    let x = Scale::new(figure.abscissae.iter().map(|v| v * figure.x.factor), 0.0, (MARGINS.0, SIZE.0 - MARGINS.1));
    let all = || figure.lines.iter().flat_map(|line| line.values.iter().map(|v| v * figure.y.factor));
    let down = (SIZE.1 - MARGINS.2, top + 13.0);
    let y = match figure.y_limits {
        None => Scale::new(all(), 0.05, down),
        Some((low, high)) => Scale::new([low, high].into_iter().map(|v| v * figure.y.factor), 0.0, down),
    };
    let mut svg = format!(
        "<svg{attributes} viewBox=\"0 0 {} {}\" class=\"plot\" role=\"img\" aria-label=\"{}\" font-family=\"sans-serif\" \
         font-size=\"14\">\n{first}",
        SIZE.0,
        SIZE.1,
        escaped(&figure.caption)
    );
    svg += &legend;
    svg += &axes(figure, &x, &y);
    // Of a scale of levels the last is drawn first: where they grow, it would hide the others.
    let is_scale = figure.lines.iter().all(|line| matches!(line.look, Look::Level(_)));
    let mut lines: Vec<&Line> = figure.lines.iter().collect();
    if is_scale {
        lines.reverse();
    }
    // An inner drawing cuts off what lies beyond its limits.
    let (width, height) = (x.pixels.1 - x.pixels.0, y.pixels.0 - y.pixels.1);
    let place = format!("x=\"{0}\" y=\"{1}\" width=\"{width}\" height=\"{height}\"", x.pixels.0, y.pixels.1);
    let seen = format!("viewBox=\"{} {} {width} {height}\"", x.pixels.0, y.pixels.1);
    if figure.y_limits.is_some() {
        let _ = writeln!(svg, "<svg {place} {seen}>");
    }
    for line in lines {
        let points = figure.abscissae.iter().zip(&line.values);
        let points: Vec<(f64, f64)> =
            points.map(|(a, b)| (x.at(a * figure.x.factor), y.at(b * figure.y.factor))).collect();
        let pieces = points.split(|point| point.1.is_nan()).map(|piece| path(&simplified(piece)));
        let _ = writeln!(svg, "<path {} d=\"{}\"/>", stroke(line.look), pieces.collect::<String>());
    }
    if figure.y_limits.is_some() {
        svg += "</svg>\n";
    }
    svg + "</svg>\n"
}

fn stroke(of: Look) -> String {
    let (level, dashes) = look(of);
    let dashes = if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
    format!("class=\"line l{level}\" stroke=\"{}\" fill=\"none\"{dashes}", LEVELS[level].0)
}

/// The quantity, under it the lines' names beside a piece of each, and how far down they reach.
fn legend(figure: &Figure) -> (String, f64) {
    let mut svg = format!("<text x=\"4\" y=\"15\">{}, {}</text>\n", escaped(figure.y.label), figure.y.unit);
    let width = |text: &str| text.chars().count() as f64 * LETTERS.1;
    let (mut x, mut y) = (4.0, 15.0 + LETTERS.0);
    if !figure.legend.is_empty() {
        let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y}\">{}</text>", escaped(figure.legend));
        x += width(figure.legend) + 18.0;
    }
    for line in figure.lines.iter().filter(|line| !line.label.is_empty()) {
        let wide = 28.0 + width(&line.label);
        if x + wide > SIZE.0 && x > 4.0 {
            (x, y) = (4.0, y + LETTERS.0);
        }
        let (middle, text) = (y - 5.0, x + 28.0);
        let _ = writeln!(svg, "<path {} d=\"M{x:.1},{middle:.1}H{:.1}\"/>", stroke(line.look), x + 24.0);
        let _ = writeln!(svg, "<text x=\"{text:.1}\" y=\"{y}\">{}</text>", escaped(&line.label));
        x += wide + 12.0;
    }
    (svg, y)
}

fn axes(figure: &Figure, x: &Scale, y: &Scale) -> String {
    let mut svg = String::new();
    let (left, right, bottom) = (x.pixels.0, x.pixels.1, y.pixels.0);
    let [grid, axis] =
        [("grid", OTHERS[2].1), ("axis", OTHERS[3].1)].map(|(c, colour)| format!("class=\"{c}\" stroke=\"{colour}\""));
    let (step, values) = y.ticks();
    for value in values {
        let at = y.at(value);
        let _ = writeln!(svg, "<path {grid} d=\"M{left},{at:.1}H{right}\"/>");
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 6.0,
            at + 5.0,
            tick(value, step)
        );
    }
    let (step, values) = x.ticks();
    for value in values {
        let at = x.at(value);
        let _ = writeln!(svg, "<path {axis} d=\"M{at:.1},{bottom}v4\"/>");
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            bottom + 19.0,
            tick(value, step)
        );
    }
    let _ = writeln!(svg, "<path {axis} d=\"M{left},{bottom}H{right}\"/>");
    let middle = f64::midpoint(left, right);
    let (label, unit) = (escaped(figure.x.label), figure.x.unit);
    let _ = writeln!(svg, "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{label}, {unit}</text>", SIZE.1 - 6.0);
    svg
}

/// From values to pixels.
struct Scale {
    values: (f64, f64),
    pixels: (f64, f64),
}

impl Scale {
    /// A scale over the values, with this part of their range free at both ends. It is never without length.
    fn new(values: impl Iterator<Item = f64>, free: f64, pixels: (f64, f64)) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let range = (high - low).max(1e-9);
        Self { values: (low - free * range, low + range * (1.0 + free)), pixels }
    }

    fn at(&self, value: f64) -> f64 {
        let part = (value - self.values.0) / (self.values.1 - self.values.0);
        self.pixels.0 + part * (self.pixels.1 - self.pixels.0)
    }

    /// Round values on the scale, and the step between them: 1, 2 or 5 times a power of ten.
    fn ticks(&self) -> (f64, Vec<f64>) {
        let (low, high) = self.values;
        let coarse = (high - low) / LABELS_MIN;
        let power = 10f64.powf(coarse.log10().floor());
        let step = [5.0, 2.0, 1.0].map(|m| m * power).into_iter().find(|step| *step <= coarse).unwrap_or(power);
        let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
        (step, (first..=last).map(|k| k as f64 * step).collect())
    }
}

/// A number beside a tick, with as many decimals as the step asks for.
fn tick(value: f64, step: f64) -> String {
    let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
    format!("{value:.decimals$}").replace('-', "−")
}

fn path(points: &[(f64, f64)]) -> String {
    let mut d = String::new();
    for (i, (x, y)) in points.iter().enumerate() {
        let _ = write!(d, "{}{x:.1},{y:.1}", if i == 0 { "M" } else { " " });
    }
    d
}

/// The same line with fewer points: of every stretch the furthest point stays, until none is further off than can be seen
/// (the algorithm of Ramer, Douglas and Peucker).
fn simplified(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut stays = vec![false; points.len()];
    (stays[0], stays[points.len() - 1]) = (true, true);
    let mut open = vec![(0, points.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let off = |i: &usize| distance(points[*i], points[from], points[to]);
        let Some(furthest) = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
        if off(&furthest) > TOLERANCE {
            stays[furthest] = true;
            open.extend([(from, furthest), (furthest, to)]);
        }
    }
    points.iter().zip(stays).filter_map(|(point, stays)| stays.then_some(*point)).collect()
}

/// How far a point is from the straight line through two others.
fn distance(point: (f64, f64), from: (f64, f64), to: (f64, f64)) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (px, py) = (point.0 - from.0, point.1 - from.1);
    let length = dx.hypot(dy);
    if length == 0.0 { px.hypot(py) } else { (px * dy - py * dx).abs() / length }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::figure::tests::example;

    #[test]
    fn ticks_are_round_short_and_inside() {
        let scale = |low: f64, high: f64| Scale::new([low, high].into_iter(), 0.0, (0.0, 100.0));
        let told = |low, high| {
            let (step, values) = scale(low, high).ticks();
            values.into_iter().map(|value| tick(value, step)).collect::<Vec<_>>()
        };
        assert_eq!(told(0.0, 2.0), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(told(-23.0, 41.0), ["−20", "−10", "0", "10", "20", "30", "40"]);
        assert_eq!(told(9.41, 9.44), ["9.410", "9.415", "9.420", "9.425", "9.430", "9.435", "9.440"]);
        assert!(!told(3.0, 3.0).is_empty(), "a line without height has a scale too");
    }

    #[test]
    fn a_simplified_line_keeps_its_ends_and_its_peaks() {
        let mut points: Vec<(f64, f64)> = (0..5000).map(|i| (f64::from(i) * 0.1, 0.0)).collect();
        points[1234].1 = 7.0;
        points[4001].1 = -3.0;
        let kept = simplified(&points);
        assert!(kept.len() < 12 && [0, 1234, 4001, 4999].iter().all(|&i| kept.contains(&points[i])), "{kept:?}");
    }

    #[test]
    fn a_line_has_a_gap_where_there_is_no_value_and_limits_cut_it_off() {
        let values = [0.0, 1.0, f64::NAN, 2.0, 3.0];
        let figure = Figure { y_limits: Some((0.0, 2.5)), ..example(&values) };
        let svg = inline(&figure);
        let line = svg.lines().rfind(|line| line.contains("class=\"line ")).unwrap();
        assert_eq!(line.matches('M').count(), 2, "{line}");
        assert!(!svg.contains("NaN"));
        assert_eq!((svg.matches("<svg").count(), svg.matches("</svg>").count()), (2, 2));
    }

    #[test]
    fn every_line_is_drawn_inside_the_frame_and_every_text_is_escaped() {
        let svg = standalone(&example(&[0.0, 3.0, -1.0, 2.0]));
        assert_eq!(svg.matches("class=\"line ").count(), 2 * 4, "lines and pieces of them in the legend");
        assert!(svg.contains("Cor &amp; &lt;XS&gt;") && svg.contains("&lt;0&gt;") && !svg.contains("<XS>"));
        let line = svg.lines().rfind(|line| line.contains("class=\"line ")).unwrap();
        let numbers = line.split("d=\"M").nth(1).unwrap().trim_end_matches("\"/>");
        for pair in numbers.split(' ') {
            let (x, y) = pair.split_once(',').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!((MARGINS.0..=SIZE.0).contains(&x) && (0.0..=SIZE.1 - MARGINS.2).contains(&y), "{pair}");
        }
    }
}
