//! Two scenes → one animated SVG that changes the first into the second, by CSS animations of paths and
//! colours.
//!
//! A texton that becomes another is drawn once, as in the first scene, with a rule for its state at the end,
//! and at half-time if it does not move straight; the viewer interpolates. Programs without support for
//! animation show the first scene. Outlines are smooth splines: between the middles of the sides of a polygon
//! run parabolas that touch its sides. As `T` commands they need one point each, and a ring has the same
//! number of points at all times, so that viewers can interpolate its path.
//!
//! Elements that grow or shrink are animated as paths too: Chromium gives everything whose transform is
//! animated a layer of its own, and cannot paint thousands of them.
//!
//! Gradients on textons are drawn in their mean colours, shadows with a sharp edge. The painting order
//! is that half-way, because it cannot change in a document.

use super::layers::{self, LayerGroup};
use super::number::{HexColour, Number};
use super::xml::{ViewerLoad, Xml};
use super::{NamedField, SvgOptions, SvgSummary, backgrounds};
use crate::background::PreparedBackground;
use std::fmt::Write as _;
use std::io::{self, Write};
use vtex_base::Parameter;
use vtex_base::geometry::{Point, Rect, Vec2};
use vtex_edit::interpolate::{Brush, Interpolation, LayerMotion, Motion, MovingShape};
use vtex_scene::scene::{Edge, InstanceId, Scene};

/// Time windows are rounded to this share of the whole time, so that many share a rule.
const WINDOW: f64 = 0.05;
/// Progress within a window at even times.
const SMOOTH: [f64; 5] = [0.0, 0.156, 0.5, 0.844, 1.0];
/// A shape gets a keyframe at half-time if it is then further than this from the middle between its ends, in
/// pixels.
const STRAIGHT: f64 = 0.6;
/// Number of moving shapes above which viewers no longer play smoothly.
pub(super) const MANY_SHAPES: usize = 5000;

/// Seconds that an animation plays.
pub(super) const SECONDS: Parameter<f64> = Parameter::new("seconds", [0.01, 1e5], "");

/// Parameters of an animation, which plays in a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Animation {
    /// Seconds from the first scene to the second, 0.01 to 100 000.
    pub seconds: f64,
    /// Whether it plays there and back instead of starting again.
    pub back: bool,
    /// Digits after the decimal point of coordinates, 0 to 6. Default of the program: 1.
    pub precision: u8,
}

/// Writes the interpolation of two scenes as one SVG that plays in browsers. Same scenes and options: the
/// same bytes.
///
/// # Errors
/// A parameter out of range; a failing writer.
pub fn write_animation(way: &Interpolation, options: &Animation, out: impl Write) -> io::Result<SvgSummary> {
    SvgOptions::PRECISION.check(options.precision)?;
    SECONDS.check(options.seconds)?;
    let motions = way.motions();
    let writer =
        AnimationWriter { scenes: way.scenes(), domain: way.domain_motion(), precision: options.precision };
    let mut shapes = 0;
    let mut summary = super::summed(0, out, |xml| {
        shapes = writer.write(xml, &motions, options)?;
        Ok(())
    })?;
    if shapes > MANY_SHAPES {
        summary.warnings.push(format!(
            "{shapes} shapes move; viewers do not play more than {MANY_SHAPES} smoothly: write a smaller size, \
             a .gif or a .png, or thin and flatten the scenes with 'vtex edit' before"
        ));
    }
    let soft = |scene: &Scene| {
        let mut shadows = scene.instances().filter_map(|i| i.shadow);
        shadows.any(|shadow| shadow.blur > 0.0)
    };
    if way.scenes().into_iter().any(soft) {
        summary.warnings.push(
            "soft shadows have a sharp edge in an animated SVG; frames, a .gif and a .png show them soft"
                .into(),
        );
    }
    Ok(summary)
}

struct AnimationWriter<'a> {
    scenes: [&'a Scene; 2],
    domain: Option<(MovingShape, Edge)>,
    precision: u8,
}

impl AnimationWriter<'_> {
    /// Writes the whole document; returns the number of moving shapes.
    fn write<W: Write>(
        &self,
        xml: &mut Xml<W>,
        motions: &[LayerMotion<'_>],
        options: &Animation,
    ) -> io::Result<usize> {
        xml.open("svg");
        xml.attribute("xmlns", "http://www.w3.org/2000/svg");
        xml.attribute("xmlns:xlink", "http://www.w3.org/1999/xlink");
        xml.attribute("xmlns:inkscape", "http://www.inkscape.org/namespaces/inkscape");
        super::write_page(xml, self.scenes[0]);
        xml.line();
        let [from, to] = self.scenes.map(super::super::title);
        xml.open("title");
        xml.text(&format!("{from} → {to}"));
        xml.close()?;
        xml.line();
        let field = |side: usize| {
            let scene = self.scenes[side];
            motions
                .iter()
                .map(move |layer| layer.fields[side].map(|field| PreparedBackground::new(scene, field)))
        };
        let fields = [backgrounds(field(0), "b"), backgrounds(field(1), "e")];
        let named = motions.iter().map(|layer| (layer.name, layer.role, layer.region.is_some()));
        let frames = LayerGroup::of(named, self.domain.as_ref().map(|(_, edge)| *edge));
        self.write_rules(xml, motions, &frames, options)?;
        self.write_definitions(xml, &fields, motions, &frames)?;
        let mut shapes = 0;
        layers::write(xml, &frames, |xml, k| {
            write_fields(xml, [fields[0][k].as_ref(), fields[1][k].as_ref()])?;
            shapes += self.write_motions(xml, &motions[k].motions)?;
            Ok(())
        })?;
        Ok(shapes)
    }

    fn write_definitions<W: Write>(
        &self,
        xml: &mut Xml<W>,
        fields: &[Vec<NamedField>; 2],
        motions: &[LayerMotion<'_>],
        frames: &[LayerGroup],
    ) -> io::Result<()> {
        xml.open("defs");
        xml.line();
        for (background, name) in fields.iter().flatten().flatten() {
            background.write_definitions(xml, 0.0, name)?;
        }
        for (id, rule, shape) in self.clips(motions, frames) {
            xml.open("clipPath");
            xml.attribute("id", id);
            xml.open("path");
            xml.attribute("id", format_args!("{rule}-shape"));
            xml.attribute("class", "a");
            xml.attribute("style", format_args!("animation-name:{rule}"));
            xml.attribute("d", self.data(shape, 0));
            xml.close()?;
            let drawn = ViewerLoad { elements: 1, references: 0 };
            self.write_copies(xml, &format!("{rule}-shape"), shape.bounds(), drawn)?;
            xml.close()?;
            xml.line();
        }
        xml.close()?;
        xml.line();
        Ok(())
    }

    /// The clip paths: id, name of the rule, and shape.
    fn clips<'a>(
        &'a self,
        motions: &'a [LayerMotion<'_>],
        frames: &'a [LayerGroup],
    ) -> impl Iterator<Item = (&'a str, String, &'a MovingShape)> {
        let domain = self.domain.iter().map(|(shape, _)| (layers::DOMAIN, layers::DOMAIN.to_owned(), shape));
        let regions = motions.iter().zip(frames).enumerate();
        let regions = regions.filter_map(|(k, (layer, frame))| {
            Some((frame.region()?, format!("region{k}"), layer.region.as_ref()?))
        });
        domain.chain(regions)
    }

    /// Writes the textons of a layer; returns the number of their shapes.
    fn write_motions<W: Write>(&self, xml: &mut Xml<W>, motions: &[Motion]) -> io::Result<usize> {
        let mut shapes = 0;
        for motion in motions {
            shapes += self.write_motion(xml, motion)?;
            xml.line();
        }
        Ok(shapes)
    }

    /// Writes the rules of all moving shapes.
    fn write_rules<W: Write>(
        &self,
        xml: &mut Xml<W>,
        motions: &[LayerMotion<'_>],
        frames: &[LayerGroup],
        options: &Animation,
    ) -> io::Result<()> {
        let direction = if options.back { "alternate" } else { "normal" };
        xml.open("style");
        let seconds = Number(options.seconds, 3);
        xml.raw_text(&format!(
            "\n.a{{animation:{seconds}s linear infinite {direction}}}\n.e{{animation-name:e}}\n\
             @keyframes e{{from{{opacity:0}}to{{opacity:1}}}}\n"
        ))?;
        // Windows begin and end at few steps, so each occurring pair gets a rule.
        let mut windows: Vec<[u32; 2]> =
            motions.iter().flat_map(|layer| &layer.motions).filter_map(window).collect();
        windows.sort_unstable();
        windows.dedup();
        for [first, last] in windows {
            let mut pace = String::from("0");
            for (k, done) in SMOOTH.iter().enumerate() {
                let share = k as f64 / (SMOOTH.len() - 1) as f64;
                let step = f64::from(first) + f64::from(last - first) * share;
                let _ = write!(pace, ",{} {}%", Number(*done, 3), Number(step * WINDOW * 100.0, 2));
            }
            xml.raw_text(&format!(".w{first}-{last}{{animation-timing-function:linear({pace},1)}}\n"))?;
        }
        for (_, rule, shape) in self.clips(motions, frames) {
            xml.raw_text(&format!("@keyframes {rule}{{to{{d:path(\"{}\")}}}}\n", self.data(shape, 2)))?;
        }
        for motion in motions.iter().flat_map(|layer| &layer.motions) {
            let mut rules = String::new();
            for (k, shape) in motion.shapes.iter().enumerate() {
                let _ = write!(rules, "@keyframes {}{{", name(motion.id, k));
                if !straight(shape) {
                    let _ = write!(rules, "50%{{d:path(\"{}\")}}", self.data(shape, 1));
                }
                let _ = write!(rules, "to{{d:path(\"{}\")", self.data(shape, 2));
                brush_rule(&mut rules, &shape.brush);
                rules.push_str("}}\n");
            }
            xml.raw_text(&rules)?;
        }
        xml.close()?;
        xml.line();
        Ok(())
    }

    /// Writes a texton and its copies; returns the number of its shapes.
    fn write_motion<W: Write>(&self, xml: &mut Xml<W>, motion: &Motion) -> io::Result<usize> {
        let Motion { id, shapes, .. } = motion;
        let grouped = shapes.len() > 1;
        let before = xml.drawn();
        if grouped {
            xml.open("g");
            xml.attribute("id", format_args!("p{id}"));
        }
        for (k, shape) in shapes.iter().enumerate() {
            xml.open("path");
            if !grouped {
                xml.attribute("id", format_args!("p{id}"));
            }
            match window(motion) {
                Some([first, last]) => xml.attribute("class", format_args!("a w{first}-{last}")),
                None => xml.attribute("class", "a"),
            }
            xml.attribute("style", format_args!("animation-name:{}", name(*id, k)));
            write_brush(xml, &shape.brush);
            xml.attribute("d", self.data(shape, 0));
            xml.close()?;
        }
        if grouped {
            xml.close()?;
        }
        let bounds = shapes.iter().map(MovingShape::bounds).reduce(|a, b| a.union(b)).unwrap_or_default();
        self.write_copies(xml, &format!("p{id}"), bounds, xml.drawn().since(before))?;
        Ok(shapes.len())
    }

    /// Writes the copies of an element with these `bounds`, where the scenes repeat; `drawn` is the content
    /// of each.
    fn write_copies<W: Write>(
        &self,
        xml: &mut Xml<W>,
        id: &str,
        bounds: Rect,
        drawn: ViewerLoad,
    ) -> io::Result<()> {
        for shift in self.scenes[0].copies(bounds).filter(|&shift| shift != Vec2::ZERO) {
            xml.open("use");
            xml.attribute("xlink:href", format_args!("#{id}"));
            xml.attribute("x", Number(shift.x, self.precision));
            xml.attribute("y", Number(shift.y, self.precision));
            xml.follow(drawn);
            xml.close()?;
        }
        Ok(())
    }

    /// The rings of a shape at one of its three times.
    fn data(&self, shape: &MovingShape, time: usize) -> String {
        let mut text = String::new();
        for ring in &shape.rings {
            spline(&mut text, &ring[time], self.precision);
        }
        text
    }
}

/// Writes the paint of a shape in the first scene.
fn write_brush<W: Write>(xml: &mut Xml<W>, brush: &Brush) {
    match brush {
        Brush::Fill([colour, _]) => xml.attribute("fill", HexColour(*colour)),
        Brush::Shadow([opacity, _]) => xml.attribute("fill-opacity", Number(*opacity, 3)),
        Brush::Line { colours: [colour, _], widths: [width, _] } => {
            xml.attribute("fill", "none");
            xml.attribute("stroke", HexColour(*colour));
            xml.attribute("stroke-width", Number(*width, 2));
            xml.attribute("stroke-linejoin", "round");
        }
    }
}

/// Writes the field of the first scene, and over it that of the second, which fades in.
fn write_fields<W: Write>(
    xml: &mut Xml<W>,
    [from, to]: [Option<&(PreparedBackground, String)>; 2],
) -> io::Result<()> {
    match (from, to) {
        (None, None) => Ok(()),
        (Some((only, name)), None) | (None, Some((only, name))) => only.write_bands(xml, 0.0, name),
        (Some((from, from_name)), Some((to, to_name))) => {
            from.write_bands(xml, 0.0, from_name)?;
            xml.open("g");
            xml.attribute("class", "a e");
            xml.attribute("opacity", 0);
            xml.line();
            to.write_bands(xml, 0.0, to_name)?;
            xml.close()
        }
    }
}

/// The properties that differ in the second scene, as a part of a rule.
fn brush_rule(rule: &mut String, brush: &Brush) {
    // Writing into a String cannot fail.
    match brush {
        Brush::Fill([from, to]) if from != to => _ = write!(rule, ";fill:{}", HexColour(*to)),
        Brush::Shadow([from, to]) if from != to => _ = write!(rule, ";fill-opacity:{}", Number(*to, 3)),
        Brush::Line { colours, widths } => {
            if colours[0] != colours[1] {
                let _ = write!(rule, ";stroke:{}", HexColour(colours[1]));
            }
            if widths[0] != widths[1] {
                let _ = write!(rule, ";stroke-width:{}", Number(widths[1], 2));
            }
        }
        Brush::Fill(_) | Brush::Shadow(_) => {}
    }
}

/// The rule of shape `k` of a texton.
fn name(id: InstanceId, k: usize) -> String {
    if k == 0 { format!("k{id}") } else { format!("k{id}-{k}") }
}

/// The steps at which the change of a texton begins and ends; `None` if it changes all the time.
fn window(motion: &Motion) -> Option<[u32; 2]> {
    motion.window.map(|ends| ends.map(|v| libm::round(v / WINDOW) as u32))
}

/// Whether a shape changes nearly linearly.
fn straight(shape: &MovingShape) -> bool {
    shape.rings.iter().all(|[a, b, c]| {
        let mut points = a.iter().zip(b).zip(c);
        points.all(|((a, b), c)| (a.midpoint(*c) - *b).hypot2() < STRAIGHT * STRAIGHT)
    })
}

/// A closed smooth curve near the points of a ring. Ends of parabolas are rounded such that the errors of the
/// control points, each of which mirrors the previous one, do not add up.
fn spline(text: &mut String, ring: &[Point], precision: u8) {
    let n = ring.len();
    if n < 3 {
        return;
    }
    // A control polygon whose parabolas come near the points.
    let control = |i: usize| {
        let (before, here, after) = (ring[(i + n - 1) % n], ring[i % n], ring[(i + 1) % n]);
        here + ((here - before) + (here - after)) * 0.25
    };
    let scale = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6][usize::from(precision.min(6))];
    let snap = |p: Point| Point::new(libm::round(p.x * scale) / scale, libm::round(p.y * scale) / scale);
    let number = |v: f64| Number(v, precision);
    let add = |text: &mut String, p: Point, from: Point, first: bool| {
        for (k, v) in [p.x - from.x, p.y - from.y].into_iter().enumerate() {
            let shown = number(v).to_string();
            if !(first && k == 0 || shown.starts_with('-')) {
                text.push(' ');
            }
            text.push_str(&shown);
        }
    };
    let start = snap(control(0).midpoint(control(n - 1)));
    text.push('M');
    add(text, start, Point::ORIGIN, true);
    let mut at = start;
    let mut mirrored = snap(control(0));
    for i in 0..n {
        // Halfway from the rounded point to the exact next one.
        let end = if i + 1 == n { start } else { snap(mirrored.midpoint(control(i + 1))) };
        if i == 0 {
            text.push('q');
            add(text, mirrored, at, true);
            add(text, end, at, false);
            text.push('t');
        } else {
            add(text, end, at, i == 1);
        }
        mirrored = (end.to_vec2() * 2.0 - mirrored.to_vec2()).to_point();
        at = end;
    }
    text.push('z');
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;
    use std::f64::consts::TAU;
    use vtex_base::geometry::BezPath;

    fn ring(n: u32, phase: f64) -> Vec<Point> {
        let point = |i: u32| {
            let angle = TAU * f64::from(i) / f64::from(n);
            let r = 20.0 + 4.0 * libm::sin(3.0 * angle + phase);
            Point::new(700.0 + r * libm::cos(angle), 300.0 + r * libm::sin(angle))
        };
        (0..n).map(point).collect()
    }

    #[test]
    fn splines_pass_near_their_points_whatever_is_rounded() {
        for precision in [1, 2] {
            for phase in 0..8 {
                let points = ring(28, f64::from(phase));
                let mut text = String::new();
                spline(&mut text, &points, precision);
                let path = BezPath::from_svg(&text).unwrap();
                let mut drawn = Vec::new();
                kurbo_points(&path, &mut drawn);
                for p in &points {
                    let far = drawn.iter().map(|q| (*p - *q).hypot2()).fold(f64::INFINITY, f64::min);
                    assert!(far < 0.45 * 0.45, "{far} {text}");
                }
            }
        }
    }

    /// Points along a path.
    fn kurbo_points(path: &BezPath, out: &mut Vec<Point>) {
        use kurbo::ParamCurve;
        for segment in path.segments() {
            out.extend((0..20).map(|k| segment.eval(f64::from(k) / 20.0)));
        }
    }

    #[test]
    fn an_animation_has_everything_once_and_commands_that_correspond() {
        let (a, b) = (testing::scene(200, 200, 1), testing::scene(200, 200, 2));
        let way = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
        let options = Animation { seconds: 2.0, back: true, precision: 1 };
        let mut bytes = Vec::new();
        let summary = write_animation(&way, &options, &mut bytes).unwrap();
        assert_eq!(summary.bytes, bytes.len() as u64);
        let source = String::from_utf8(bytes).unwrap();
        let document = roxmltree::Document::parse(&source).unwrap();
        let with_id = |id: &str| document.descendants().filter(|n| n.attribute("id") == Some(id)).count();
        for motion in way.motions().iter().flat_map(|layer| &layer.motions) {
            assert_eq!(with_id(&format!("p{}", motion.id)), 1);
        }
        let style = document.descendants().find(|n| n.has_tag_name("style")).unwrap().text().unwrap();
        let commands = |d: &str| -> String { d.chars().filter(char::is_ascii_alphabetic).collect() };
        let numbers = |d: &str| BezPath::from_svg(d).unwrap().elements().len();
        let mut seen = 0;
        for path in document.descendants().filter(|n| n.has_tag_name("path")) {
            let Some(name) = path.attribute("style").and_then(|s| s.strip_prefix("animation-name:")) else {
                continue;
            };
            let rule = style.split(&format!("@keyframes {name}{{")).nth(1).unwrap().lines().next().unwrap();
            let d = path.attribute("d").unwrap();
            for other in rule.split("path(\"").skip(1).map(|r| r.split('"').next().unwrap()) {
                assert_eq!((commands(d), numbers(d)), (commands(other), numbers(other)));
            }
            seen += 1;
        }
        assert!(seen > 10, "{seen}");
        let mut again = Vec::new();
        write_animation(&way, &options, &mut again).unwrap();
        assert!(source.as_bytes() == again);
    }
}
