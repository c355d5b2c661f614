//! The SVG painter: frames as embedded PNG, marks as shapes, words as the outlines of their glyphs or as text.

use std::fmt::Write;
use std::io::Write as _;

use ::svg::Document;
use ::svg::node::element::{Circle, ClipPath, Definitions, Description, Group, Image, Path, Rectangle, Title};
use ::svg::node::{Blob, Node};
use motionscope_core::base::Error;
use motionscope_core::choices;
use motionscope_core::geometry::Grid;
use tiny_skia::PathSegment;

use super::primitive::{Anchor, Arrow, Line, Point, Primitive, Rect, Stroke};
use super::raster::{HALO_SHARE, outlines};
use super::script::{self, Script};
use super::{Color, Face, Figure};

const SANS: &str = "Inter, Helvetica, Arial, sans-serif";
const MONO: &str = " font-family=\"JetBrains Mono, Menlo, Consolas, monospace\"";

choices! {
    /// How words and formulas are written into an SVG file.
    pub enum SvgText {
        /// Outlines of the glyphs, which look the same everywhere.
        Outlines = "outlines" "Outlines",
        /// Text, which can be searched and edited and needs the fonts of the program.
        Live = "live" "Live text",
    }
}

/// `figure` as an SVG file that browsers and drawing programs open, with words and formulas as `words`. The same figure gives the same
/// bytes.
///
/// # Errors
/// If a frame cannot be encoded.
pub fn export_svg(figure: &Figure, words: SvgText) -> Result<String, Error> {
    let [width, height] = figure.size;
    let paper = Rectangle::new().set("width", width).set("height", height);
    let mut clips = Definitions::new();
    let mut groups = Vec::new();
    for (i, layer) in figure.layers.iter().enumerate() {
        let mut group = Group::new();
        if let Some(clip) = layer.clip {
            let id = format!("panel{i}");
            group = group.set("clip-path", format!("url(#{id})"));
            clips = clips.add(ClipPath::new().set("id", id).add(rectangle(clip)));
        }
        for primitive in &layer.primitives {
            draw(&mut group, primitive, words)?;
        }
        groups.push(group);
    }
    let mut document = Document::new()
        .set("viewBox", (0, 0, width, height))
        .set("width", width)
        .set("height", height)
        .set("xmlns:xlink", "http://www.w3.org/1999/xlink")
        .set("style", "font-variant-numeric:tabular-nums")
        .add(Title::new("Motionscope"))
        .add(Description::new().add(::svg::node::Text::new(&figure.description)))
        .add(clips)
        .add(fill(paper, figure.background));
    for group in groups {
        document = document.add(group);
    }
    Ok(format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{document}\n"))
}

fn draw(group: &mut Group, primitive: &Primitive, words: SvgText) -> Result<(), Error> {
    match primitive {
        Primitive::Polygon { points, color } => group.append(fill(shape(points, true), *color)),
        Primitive::Polyline { points, closed, stroke } => group.append(stroked(shape(points, *closed), stroke)),
        Primitive::Disc { center, radius, color } => group.append(disc(*center, *radius, *color)),
        Primitive::Trails(trails) => trails.primitives().try_for_each(|primitive| draw(group, &primitive, words))?,
        Primitive::Arrows(arrows) => {
            for arrow in arrows.iter() {
                if arrow.pen.halo_width > 0.0 {
                    silhouette(group, &arrow, arrow.pen.halo_width, arrow.pen.halo);
                }
                silhouette(group, &arrow, 0.0, arrow.pen.color);
            }
        }
        Primitive::Text(line) => {
            match words {
                SvgText::Outlines => group.append(outlined(line)),
                SvgText::Live => group.append(text(line)),
            }
            line.underlines().try_for_each(|underline| draw(group, &underline, words))?;
        }
        Primitive::Image { pixels, rect } => group.append(image(pixels, *rect)?),
    }
    Ok(())
}

/// Two digits after the point are finer than any screen or printer.
fn short(v: f32) -> f32 {
    // Adding zero turns −0 into 0.
    (v * 100.0).round() / 100.0 + 0.0
}

fn shape(points: &[Point], closed: bool) -> Path {
    let mut data = String::new();
    trace(&mut data, points, closed);
    Path::new().set("d", data)
}

fn trace(data: &mut String, points: &[Point], closed: bool) {
    for (i, &[x, y]) in points.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(data, "{}{} {}", if i == 0 { "M" } else { "L" }, short(x), short(y));
    }
    if closed {
        data.push('Z');
    }
}

fn silhouette(group: &mut Group, arrow: &Arrow, grow: f32, color: Color) {
    if let Some(outline) = arrow.outline(grow) {
        group.append(fill(shape(&outline, true), color));
    }
    group.append(disc(arrow.from, arrow.dot() + grow, color));
}

fn disc([x, y]: Point, radius: f32, color: Color) -> Circle {
    fill(Circle::new().set("cx", short(x)).set("cy", short(y)).set("r", short(radius)), color)
}

fn rectangle(rect: Rect) -> Rectangle {
    let ([x, y], [width, height]) = (rect.min, rect.size());
    Rectangle::new().set("x", short(x)).set("y", short(y)).set("width", short(width)).set("height", short(height))
}

fn hex(color: Color) -> String {
    let [r, g, b, _] = color.0;
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn opacity(color: Color) -> Option<f32> {
    (color.0[3] < 255).then(|| (f32::from(color.0[3]) / 255.0 * 1000.0).round() / 1000.0)
}

/// The opacity of a color under this name, written by hand; nothing for an opaque one.
fn attribute(name: &str, color: Color) -> String {
    opacity(color).map_or_else(String::new, |opacity| format!(" {name}=\"{opacity}\""))
}

fn fill<N: Node>(mut node: N, color: Color) -> N {
    node.assign("fill", hex(color));
    if let Some(opacity) = opacity(color) {
        node.assign("fill-opacity", opacity);
    }
    node
}

fn stroked(path: Path, stroke: &Stroke) -> Path {
    let mut path = path.set("fill", "none").set("stroke", hex(stroke.color)).set("stroke-width", short(stroke.width));
    if let Some(opacity) = opacity(stroke.color) {
        path = path.set("stroke-opacity", opacity);
    }
    if !stroke.dash.is_empty() {
        path = path.set("stroke-dasharray", stroke.dash.to_vec());
    }
    path
}

/// The glyphs of a line as paths, the halo below all of them. Its words are the label, for screen readers and searches.
fn outlined(line: &Line) -> Group {
    let label: String = line.runs.iter().map(|run| run.text.as_str()).collect();
    let mut group = Group::new().set("role", "img").set("aria-label", label);
    let glyphs: Vec<_> = outlines(line).into_iter().map(|(path, color)| (path_data(&path), color)).collect();
    if let Some(color) = line.halo {
        let all: String = glyphs.iter().map(|(data, _)| data.as_str()).collect();
        let stroke = Stroke { width: line.size * HALO_SHARE, color, dash: &[] };
        group.append(stroked(Path::new().set("d", all), &stroke).set("stroke-linejoin", "round"));
    }
    for (data, color) in glyphs {
        group.append(fill(Path::new().set("d", data), color));
    }
    group
}

/// The outlines of glyphs in the notation of SVG.
fn path_data(path: &tiny_skia::Path) -> String {
    let mut data = String::new();
    for segment in path.segments() {
        let (letter, points) = match segment {
            PathSegment::MoveTo(a) => ("M", vec![a]),
            PathSegment::LineTo(a) => ("L", vec![a]),
            PathSegment::QuadTo(a, b) => ("Q", vec![a, b]),
            PathSegment::CubicTo(a, b, c) => ("C", vec![a, b, c]),
            PathSegment::Close => ("Z", Vec::new()),
        };
        let numbers: Vec<String> = points.iter().flat_map(|p| [p.x, p.y]).map(|c| short(c).to_string()).collect();
        data += letter;
        data += &numbers.join(" ");
    }
    data
}

/// Written by hand: white space between the spans of a line would be seen.
fn text(line: &Line) -> Blob {
    let anchor = match line.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let [x, y, size, rim] = [line.at[0], line.at[1], line.size, line.size * HALO_SHARE].map(short);
    let mut text = format!(
        "<text xml:space=\"preserve\" x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\" font-family=\"{SANS}\""
    );
    if let Some(halo) = line.halo {
        let rim = format!(" stroke=\"{}\"{} stroke-width=\"{rim}\"", hex(halo), attribute("stroke-opacity", halo));
        text += &format!("{rim} stroke-linejoin=\"round\" paint-order=\"stroke\"");
    }
    text.push('>');
    let mut risen = 0.0;
    for run in &line.runs {
        let style = match run.face {
            Face::Sans => "",
            Face::Bold => " font-weight=\"600\"",
            Face::Italic => " font-style=\"italic\"",
            Face::Mono => MONO,
        };
        let opacity = attribute("fill-opacity", run.color);
        for (words, script) in script::parts(&run.text) {
            // The mark of a mean belongs to the letter before it.
            if let Some(end) = text.rfind("</tspan>").filter(|_| script == Script::Over) {
                text.insert(end, script::MEAN);
                continue;
            }
            let words = ::svg::node::Text::new(words);
            let rise = script.rise() * line.size;
            // A shift counts for all that follows.
            let place = match short(risen - rise) {
                0.0 => String::new(),
                down => format!(" dy=\"{down}\""),
            };
            let smaller = match script {
                Script::Baseline | Script::Over => String::new(),
                _ => format!(" font-size=\"{}\"", short(script.share() * line.size)),
            };
            risen = rise;
            text += &format!("<tspan fill=\"{}\"{opacity}{style}{place}{smaller}>{words}</tspan>", hex(run.color));
        }
    }
    Blob::new(text + "</text>")
}

fn image(pixels: &Grid<[u8; 4]>, rect: Rect) -> Result<Image, Error> {
    let png = encoded(pixels).map_err(|e| Error::new(format!("a picture could not be embedded: {e}")))?;
    let ([x, y], [width, height]) = (rect.min, rect.size());
    // The attribute and `xlink:href` are for older programs, the style is for browsers.
    Ok(Image::new()
        .set("x", short(x))
        .set("y", short(y))
        .set("width", short(width))
        .set("height", short(height))
        .set("preserveAspectRatio", "none")
        .set("image-rendering", "optimizeSpeed")
        .set("style", "image-rendering:pixelated")
        .set("xlink:href", format!("data:image/png;base64,{}", base64(&png))))
}

/// A small PNG file of `pixels`, without alpha if all are opaque.
fn encoded(pixels: &Grid<[u8; 4]>) -> Result<Vec<u8>, ::png::EncodingError> {
    let side = |n: usize| u32::try_from(n).unwrap_or(0);
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, side(pixels.width()), side(pixels.height()));
    let is_opaque = pixels.cells().iter().all(|p| p[3] == 255);
    let is_gray = is_opaque && pixels.cells().iter().all(|p| p[0] == p[1] && p[1] == p[2]);
    let (color, channels) = match (is_gray, is_opaque) {
        (true, _) => (::png::ColorType::Grayscale, 1),
        (false, true) => (::png::ColorType::Rgb, 3),
        (false, false) => (::png::ColorType::Rgba, 4),
    };
    encoder.set_color(color);
    encoder.set_compression(::png::Compression::Balanced);
    let mut writer = encoder.write_header()?;
    let samples: Vec<u8> = pixels.cells().iter().flat_map(|p| p[..channels].iter().copied()).collect();
    writer.stream_writer()?.write_all(&samples).map_err(::png::EncodingError::from)?;
    writer.finish()?;
    Ok(bytes)
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().enumerate().fold(0u32, |word, (i, &byte)| word | u32::from(byte) << (16 - 8 * i));
        for i in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * i)) as usize & 63];
            text.push(if i <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        let pairs = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in pairs {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    /// A figure with words in a color.
    fn written(words: &str, color: Color, halo: Option<Color>) -> String {
        let runs = vec![super::super::primitive::Run::new(words, color)];
        let line = Line { at: [0.0; 2], anchor: Anchor::Start, size: 12.0, runs, halo };
        let figure = Figure {
            size: [10.0, 10.0],
            background: Color::WHITE,
            layers: vec![super::super::Layer { clip: None, primitives: vec![Primitive::Text(line)] }],
            panels: Vec::new(),
            description: "a < b & c".into(),
        };
        export_svg(&figure, SvgText::Live).expect("a small figure")
    }

    #[test]
    fn words_are_as_translucent_as_their_color() {
        let svg = written("a", Color::BLACK.alpha(51), Some(Color::WHITE.alpha(102)));
        assert!(svg.contains("<tspan fill=\"#000000\" fill-opacity=\"0.2\">a</tspan>"), "{svg}");
        assert!(svg.contains("stroke=\"#ffffff\" stroke-opacity=\"0.4\""), "{svg}");
        assert!(!written("a", Color::BLACK, Some(Color::WHITE)).contains("opacity"));
    }

    #[test]
    fn an_index_is_small_and_low_and_what_follows_is_not() {
        let svg = written("I_x u", Color::BLACK, None);
        let spans = [">I</tspan>", "dy=\"2.16\" font-size=\"8.88\">x</tspan>", "dy=\"-2.16\"> u</tspan>"];
        assert!(spans.iter().all(|span| svg.contains(span)), "{svg}");
    }

    #[test]
    fn words_are_escaped() {
        let svg = written("<&>", Color::BLACK, None);
        assert!(svg.contains("a &lt; b &amp; c") && svg.contains("<tspan fill=\"#000000\">&lt;&amp;&gt;</tspan>"));
    }
}
