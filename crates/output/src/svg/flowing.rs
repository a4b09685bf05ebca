//! A scene in a flow → one SVG that plays it, by SMIL animations of transforms.
//!
//! The document is that of the scene at rest. Each moving element is in a group that is animated along its
//! path, by keys with linear motion between them; where all elements turn together, each layer is one such
//! group. Programs without support for animation show the scene at rest. Shadows move and turn with their
//! elements. CSS is not used, because browsers give every element that CSS animates a layer of its own.

use super::animation::{MANY_SHAPES, SECONDS};
use super::number::{Number, list};
use super::xml::Xml;
use super::{Document, SvgOptions, SvgSummary, summed};
use std::collections::BTreeMap;
use std::io::{self, Write};
use vtex_edit::flow::{Flowing, Key};
use vtex_scene::scene::{Instance, InstanceId, Scene};

/// Decimals of shares of time: an instantaneous change takes some millionths of the loop.
const DIGITS: u8 = 6;

/// Writes a scene in a flow as one SVG that plays in browsers, again and again. `seconds` is the length of
/// the loop, 0.01 to 100 000. Same arguments: the same bytes.
///
/// # Errors
/// A parameter out of range; a failing writer.
pub fn write_flow(
    flowing: &Flowing,
    seconds: f64,
    options: &SvgOptions,
    out: impl Write,
) -> io::Result<SvgSummary> {
    SECONDS.check(seconds)?;
    let scene = flowing.scene();
    let options = &SvgOptions { fills: false, ..*options };
    let precision = options.precision;
    let rounds = flowing.rounds();
    let ways = if rounds.is_some() { Vec::new() } else { flowing.ways() };
    let ids = scene.instances().map(|instance| instance.id);
    let ways: BTreeMap<InstanceId, Vec<Key>> = ids.zip(ways).filter(|(_, keys)| !keys.is_empty()).collect();
    let many = ways.len();
    let moving = DocumentMotion { seconds, precision, rounds, ways: &ways };
    let document = Document { moving: Some(moving), ..Document::new(scene, options, 0.0)? };
    let mut summary = summed(document.textons.shared_count(), out, |xml| document.write(xml))?;
    if many > MANY_SHAPES {
        summary.warnings.push(format!(
            "{many} elements move; viewers do not play more than {MANY_SHAPES} smoothly: write a .gif or a .png, \
             or thin the scene with 'vtex edit' before"
        ));
    }
    Ok(summary)
}

/// The motion of a document's elements.
pub(super) struct DocumentMotion<'a> {
    seconds: f64,
    precision: u8,
    /// Number of rounds of all elements about the middle, if they turn together.
    rounds: Option<f64>,
    ways: &'a BTreeMap<InstanceId, Vec<Key>>,
}

/// The path of one element.
pub(super) struct AnimatedPath<'a> {
    moving: &'a DocumentMotion<'a>,
    keys: &'a [Key],
}

/// An instance moved to the origin; its group has the translation.
pub(super) fn at_origin(instance: &Instance) -> Instance {
    let [a, b, c, d, ..] = instance.transform;
    Instance { transform: [a, b, c, d, 0.0, 0.0], ..instance.clone() }
}

impl DocumentMotion<'_> {
    /// Begins the group of a layer, if all elements turn together.
    pub(super) fn begin_turn<W: Write>(&self, xml: &mut Xml<W>, scene: &Scene) -> io::Result<bool> {
        let Some(rounds) = self.rounds else { return Ok(false) };
        let middle = [scene.width, scene.height].map(|side| Number(f64::from(side) / 2.0, 1));
        let middle = list(&middle);
        let end = Number(360.0 * rounds, 2);
        xml.open("g");
        self.write(xml, "rotate", "0;1", &format!("0 {middle};{end} {middle}"))?;
        xml.line();
        Ok(true)
    }

    /// The path of an element, unless it rests.
    pub(super) fn path_of(&self, instance: &Instance) -> Option<AnimatedPath<'_>> {
        let keys = self.ways.get(&instance.id)?;
        Some(AnimatedPath { moving: self, keys })
    }

    /// One animation of the open group.
    fn write<W: Write>(&self, xml: &mut Xml<W>, kind: &str, times: &str, values: &str) -> io::Result<()> {
        xml.open("animateTransform");
        xml.attribute("attributeName", "transform");
        xml.attribute("type", kind);
        xml.attribute("additive", "sum");
        xml.attribute("dur", format_args!("{}s", Number(self.seconds, 3)));
        xml.attribute("repeatCount", "indefinite");
        xml.attribute("keyTimes", times);
        xml.attribute("values", values);
        xml.close()
    }
}

impl AnimatedPath<'_> {
    /// Writes the place and the animations of the open group.
    pub(super) fn write<W: Write>(&self, xml: &mut Xml<W>, instance: &Instance) -> io::Result<()> {
        let precision = self.moving.precision;
        let [.., x, y] = instance.transform;
        let place = [x, y].map(|v| Number(v, precision));
        xml.attribute("transform", format_args!("translate({})", list(&place)));
        let times = self.times();
        let moves = |value: &dyn Fn(&Key) -> f64, still: f64| {
            self.keys.iter().any(|key| (value(key) - still).abs() > 1e-3)
        };
        let values = |text: &dyn Fn(&Key) -> String| self.keys.iter().map(text).collect::<Vec<_>>().join(";");
        if moves(&|key| key.way.x, 0.0) || moves(&|key| key.way.y, 0.0) {
            let way = |key: &Key| list(&[key.way.x, key.way.y].map(|v| Number(v, precision.max(1))));
            self.moving.write(xml, "translate", &times, &values(&way))?;
        }
        if moves(&|key| key.angle, 0.0) {
            let angle = |key: &Key| Number(key.angle.to_degrees(), 1).to_string();
            self.moving.write(xml, "rotate", &times, &values(&angle))?;
        }
        if moves(&|key| key.size, 1.0) {
            let size = |key: &Key| Number(key.size, 3).to_string();
            self.moving.write(xml, "scale", &times, &values(&size))?;
        }
        Ok(())
    }

    /// The times of the keys, each later than the one before as written.
    fn times(&self) -> String {
        let step = libm::pow(10.0, f64::from(DIGITS));
        let mut last = -1.0;
        let count = self.keys.len() as f64;
        let rounded = self.keys.iter().enumerate().map(|(k, key)| {
            // Leaves room for the later keys.
            let most = step - (count - 1.0 - k as f64);
            last = libm::round(key.time * step).max(last + 1.0).min(most);
            Number(last / step, DIGITS).to_string()
        });
        rounded.collect::<Vec<_>>().join(";")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::{Outline, parse_path};
    use vtex_base::raster::colour::Colour;
    use vtex_edit::flow::{Flow, FlowParams};
    use vtex_scene::scene::{ElementId, testing};

    fn scene() -> Scene {
        let drop = Outline::new(&parse_path("M-6 0C-3 -6 8 -3 9 0C8 3 -3 6 -6 0z").unwrap()).unwrap();
        let element =
            |source, category| testing::element(source, category, drop.clone(), Colour([90, 60, 30]));
        let place = |id: u32| {
            // Some elements lie on the border, which they cross exactly at the ends of a loop.
            let [x, y] = [f64::from(id % 5) * 40.0, f64::from(id / 5) * 30.0 + 15.0];
            let transform = [0.8, 0.6, -0.6, 0.8, x, y];
            Instance { transform, ..Instance::new(InstanceId(id), ElementId(u32::from(id >= 10))) }
        };
        let elements = vec![element(0, None), element(1, Some(0))];
        let [small, large] = [0..10, 10..25].map(|ids| ids.map(place).collect());
        testing::scene([200, 150], elements, small, large, testing::flat(Colour([240; 3])))
    }

    fn written(flow: &Flow, options: &SvgOptions) -> String {
        let flowing = Flowing::new(&scene(), flow, &FlowParams::default()).unwrap();
        let mut bytes = Vec::new();
        let summary = write_flow(&flowing, 4.0, options, &mut bytes).unwrap();
        assert_eq!(summary.bytes, bytes.len() as u64);
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn every_element_that_moves_is_animated() {
        for (flow, options) in [Flow::Shear, Flow::Wind].into_iter().flat_map(|f| {
            [false, true].map(|expand| (f.clone(), SvgOptions { expand, ..Default::default() }))
        }) {
            let text = written(&flow, &options);
            let document = roxmltree::Document::parse(&text).unwrap();
            let animations: Vec<_> =
                document.descendants().filter(|n| n.has_tag_name("animateTransform")).collect();
            let flowing = Flowing::new(&scene(), &flow, &FlowParams::default()).unwrap();
            let moving = flowing.ways().iter().filter(|keys| !keys.is_empty()).count();
            let groups: std::collections::HashSet<_> =
                animations.iter().map(|n| n.parent().unwrap().id()).collect();
            assert_eq!(groups.len(), moving, "{flow:?}");
            for node in animations {
                let list = |name| node.attribute(name).unwrap().split(';').collect::<Vec<_>>();
                let times: Vec<f64> = list("keyTimes").iter().map(|t| t.parse().unwrap()).collect();
                assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
                assert_eq!((times[0], times[times.len() - 1]), (0.0, 1.0));
                assert_eq!(list("values").len(), times.len());
                assert!(node.parent().unwrap().attribute("transform").unwrap().starts_with("translate("));
            }
        }
    }

    /// The value of the translation of a group at a share of the loop, as a viewer finds it.
    fn translated(group: roxmltree::Node<'_, '_>, time: f64) -> [f64; 2] {
        let numbers = |text: &str| -> Vec<f64> {
            let spaced = text.replace('-', " -");
            spaced.split_whitespace().map(|v| v.parse().unwrap()).collect()
        };
        let place = group.attribute("transform").unwrap();
        let place = numbers(place.trim_start_matches("translate(").trim_end_matches(')'));
        let moves = group.children().find(|n| n.attribute("type") == Some("translate"));
        let Some(moves) = moves else { return [place[0], place[1]] };
        let list = |name| moves.attribute(name).unwrap().split(';').map(numbers).collect::<Vec<_>>();
        let (times, values) = (list("keyTimes"), list("values"));
        let after = times.iter().position(|t| t[0] >= time).unwrap().max(1);
        let [a, b] = [times[after - 1][0], times[after][0]];
        let share = (time - a) / (b - a);
        [0, 1].map(|k| place[k] + values[after - 1][k] + (values[after][k] - values[after - 1][k]) * share)
    }

    #[test]
    fn the_document_leads_elements_where_the_flow_does() {
        for flow in [Flow::Shear, Flow::Wind] {
            let flowing = Flowing::new(&scene(), &flow, &FlowParams::default()).unwrap();
            let text = written(&flow, &SvgOptions::default());
            let document = roxmltree::Document::parse(&text).unwrap();
            let mut compared = 0;
            for step in 0..331 {
                let time = f64::from(step) / 331.0;
                for instance in flowing.at(time).primary() {
                    let id = format!("p{}", instance.id);
                    let group = document.descendants().find(|n| n.attribute("id") == Some(&id)).unwrap();
                    if group.attribute("transform").is_none() {
                        continue;
                    }
                    let [x, y] = translated(group, time);
                    let off = (x - instance.transform[4]).abs().max((y - instance.transform[5]).abs());
                    assert!(off < 0.6, "{flow:?} {time} {id} {off}");
                    compared += 1;
                }
            }
            assert!(compared > 3000, "{compared}");
        }
    }

    #[test]
    fn what_turns_together_is_one_group_for_each_layer() {
        let text = written(&Flow::Vortex, &SvgOptions::default());
        assert_eq!(text.matches("<animateTransform").count(), 2);
        assert_eq!(text.matches("values=\"0 100 75;360 100 75\"").count(), 2);
    }

    #[test]
    fn at_rest_it_is_the_scene() {
        // Programs without support for animation ignore it.
        let flowing = Flowing::new(&scene(), &Flow::Wind, &FlowParams::default()).unwrap();
        let options = SvgOptions { precision: 3, ..SvgOptions::default() };
        let drawn = |text: &str| {
            let document = vtex_drawing::svg_tree::document(text).unwrap();
            let tree = vtex_drawing::svg_tree::tree(&document).unwrap();
            let mut pixels = tiny_skia::Pixmap::new(200, 150).unwrap();
            resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
            pixels
        };
        let mut still = Vec::new();
        crate::svg::write(flowing.scene(), &options, &mut still).unwrap();
        let moving = drawn(&written(&Flow::Wind, &options));
        let still = drawn(std::str::from_utf8(&still).unwrap());
        let off = moving.data().iter().zip(still.data()).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(off.unwrap() < 12, "{off:?}");
    }

    #[test]
    fn seconds_have_a_range() {
        let flowing = Flowing::new(&scene(), &Flow::Wind, &FlowParams::default()).unwrap();
        for seconds in [0.0, f64::NAN, 1e6] {
            let fault = write_flow(&flowing, seconds, &SvgOptions::default(), Vec::new()).unwrap_err();
            assert!(matches!(fault.downcast(), Ok(vtex_base::Error::Parameter { .. })));
        }
    }
}
