//! Scenes in one ink: all elements have one colour, on a paper.
//!
//! Shapes in the colour of the paper hide what is below them, as the inside of a drawn stone does. They belong to the
//! paper.

use super::Scene;
use crate::element::Shape;
use vtex_base::error::{Error, Result};
use vtex_base::raster::colour::Colour;

/// The colours of a scene in one ink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink {
    /// The colour of the elements.
    pub colour: Colour,
    /// The colour of the background, if it has exactly one.
    pub paper: Option<Colour>,
    /// Whether shapes in the colour of the paper hide what is below them.
    pub hides: bool,
}

impl Scene {
    /// The ink of the elements; `None` if they have several colours, gradients, soft shading or shadows, or if there
    /// are none.
    pub fn ink(&self) -> Option<Ink> {
        self.find_ink().ok().flatten()
    }

    /// The scene in another ink; opacities stay. `paper` replaces the background: `Some(None)` makes it transparent,
    /// `None` leaves it as it is.
    ///
    /// # Errors
    /// [`Error::Inks`] for elements that have more than one ink; [`Error::Paper`] for a transparent paper under shapes
    /// in its colour.
    pub fn with_ink(mut self, ink: Colour, paper: Option<Option<Colour>>) -> Result<Self> {
        if let Some(old) = self.find_ink().map_err(Error::Inks)? {
            let Some(hiding) = paper.unwrap_or(old.paper).or((!old.hides).then_some(ink)) else {
                return Err(Error::Paper);
            };
            let new = |colour: Colour| if old.paper == Some(colour) { hiding } else { ink };
            for element in &mut self.elements {
                element.shapes = element.shapes.iter().map(|shape| shape.recoloured(new)).collect();
            }
            for instance in self.instances_mut() {
                instance.colour = instance.colour.map(new);
                if let Some(stroke) = &mut instance.stroke {
                    stroke.colour = new(stroke.colour);
                }
            }
        }
        Ok(match paper {
            Some(colour) => self.with_background(colour),
            None => self,
        })
    }

    /// The ink of the elements, if there are any; or what they have instead of one ink, for a message.
    fn find_ink(&self) -> Result<Option<Ink>, String> {
        let paper = self.paper();
        let mut colour = None;
        let mut hides = false;
        for found in self.element_colours() {
            let found = found.ok_or("gradients, soft shading or shadows")?;
            match colour {
                _ if paper == Some(found) => hides = true,
                None => colour = Some(found),
                Some(first) if first == found => (),
                Some(first) => return Err(format!("several colours, such as {first} and {found}")),
            }
        }
        Ok(colour.or(paper.filter(|_| hides)).map(|colour| Ink { colour, paper, hides }))
    }

    /// The colour of the background, if it has exactly one.
    fn paper(&self) -> Option<Colour> {
        let mut fields = self.layers.iter().filter_map(|layer| layer.field.as_ref());
        let colour = fields.clone().next()?.fallback;
        fields.all(|field| field.points.is_empty() && field.fallback == colour).then_some(colour)
    }

    /// The colours that elements show; `None` for what has no single colour.
    fn element_colours(&self) -> impl Iterator<Item = Option<Colour>> {
        let of_shape = |shape: &Shape| {
            let single = shape.gradient.is_none() && !shape.is_soft();
            let rim = shape.rim.as_ref().map(|rim| Some(rim.colour));
            [Some(single.then_some(shape.colour)), rim].into_iter().flatten()
        };
        let of_elements = self.elements.iter().flat_map(move |element| {
            let rim = element.base().rim.as_ref().map(|rim| Some(rim.colour));
            rim.into_iter().chain(element.details().iter().flat_map(of_shape))
        });
        let of_instances = self.instances().flat_map(|instance| {
            let element = self.element(instance);
            let (colour, gradient) = element.paint(instance.colour);
            let single = gradient.is_none() && !element.base().is_soft() && instance.shadow.is_none();
            let stroke = instance.stroke.map(|stroke| Some(stroke.colour));
            [Some(single.then_some(colour)), stroke].into_iter().flatten()
        });
        of_instances.chain(of_elements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::testing;
    use crate::scene::{ElementId, Instance, InstanceId, Shadow, Stroke};
    use vtex_base::geometry::{Outline, parse_path};

    const BLACK: Colour = Colour([0; 3]);
    const WHITE: Colour = Colour([255; 3]);
    const RED: Colour = Colour([200, 0, 0]);
    const CREAM: Colour = Colour([250, 240, 220]);

    fn square() -> Outline {
        Outline::new(&parse_path("M-2-2h4v4h-4z").unwrap()).unwrap()
    }

    /// Two black elements, the first of them twice, on white paper.
    fn black() -> Scene {
        let element = |source| testing::element(source, Some(0), square(), BLACK);
        let instance = |id, element| Instance::new(InstanceId(id), ElementId(element));
        let placed = vec![instance(0, 0), instance(1, 0), instance(2, 1)];
        testing::scene([20, 20], vec![element(0), element(1)], Vec::new(), placed, testing::flat(WHITE))
    }

    fn colours(scene: &Scene) -> Vec<Colour> {
        let mut all: Vec<Colour> = scene.element_colours().flatten().collect();
        all.sort();
        all.dedup();
        all
    }

    #[test]
    fn ink_and_paper_are_replaced() {
        let scene = black();
        assert_eq!(scene.ink(), Some(Ink { colour: BLACK, paper: Some(WHITE), hides: false }));
        let red = scene.clone().with_ink(RED, None).unwrap();
        assert_eq!(red.ink(), Some(Ink { colour: RED, paper: Some(WHITE), hides: false }));
        assert_eq!(colours(&red), [RED]);
        let bare = scene.clone().with_ink(RED, Some(None)).unwrap();
        assert!(bare.layers.iter().all(|layer| layer.field.is_none()));
        // Ink and paper may change places.
        let negative = scene.clone().with_ink(WHITE, Some(Some(BLACK))).unwrap();
        assert_eq!(negative.ink(), Some(Ink { colour: WHITE, paper: Some(BLACK), hides: false }));
        assert_eq!(negative.with_ink(BLACK, Some(Some(WHITE))).unwrap(), scene);
    }

    #[test]
    fn shapes_in_the_colour_of_the_paper_follow_it() {
        let mut scene = black();
        let instance = scene.instances_mut().next().unwrap();
        instance.colour = Some(WHITE);
        instance.stroke = Some(Stroke { width: 1.0, colour: BLACK });
        assert_eq!(scene.ink(), Some(Ink { colour: BLACK, paper: Some(WHITE), hides: true }));
        let printed = scene.clone().with_ink(RED, Some(Some(CREAM))).unwrap();
        assert_eq!(colours(&printed), [RED, CREAM]);
        let first = printed.instances().next().unwrap();
        assert_eq!((first.colour, first.stroke.map(|s| s.colour)), (Some(CREAM), Some(RED)));
        // A second time changes nothing.
        assert_eq!(printed.clone().with_ink(RED, Some(Some(CREAM))).unwrap(), printed);
        assert!(matches!(scene.with_ink(RED, Some(None)), Err(Error::Paper)));
    }

    #[test]
    fn several_inks_are_refused() {
        let mut scene = black();
        scene.instances_mut().next().unwrap().colour = Some(RED);
        assert_eq!(scene.ink(), None);
        let refused = scene.with_ink(CREAM, None).unwrap_err().to_string();
        assert!(refused.contains("#c80000 and #000000"), "{refused}");
        let mut shaded = black();
        shaded.instances_mut().next().unwrap().shadow =
            Some(Shadow { offset: [1.0; 2], opacity: 0.5, blur: 2.0 });
        let refused = shaded.with_ink(CREAM, None).unwrap_err().to_string();
        assert!(refused.contains("shadows"), "{refused}");
    }

    #[test]
    fn a_scene_without_elements_has_no_ink() {
        let mut scene = black();
        scene.layers.iter_mut().for_each(|layer| layer.instances.clear());
        scene.elements.clear();
        assert_eq!(scene.ink(), None);
        let painted = scene.with_ink(RED, Some(Some(CREAM))).unwrap();
        assert_eq!(painted.paper(), Some(CREAM));
    }
}
