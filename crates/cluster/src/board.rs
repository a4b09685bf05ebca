//! Elements on the canvas, one by one: which are near, and which clash.

use crate::relations::PlaceRelations;
use crate::standing::{StandingElement, StandingElements};
use std::cmp::Reverse;
use vtex_base::error::Result;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, length};
use vtex_base::parallel;

/// An element on the canvas: one of the exemplar's places, moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoardElement {
    /// The place of the exemplar.
    pub(crate) place: u32,
    /// Its reference point on the canvas.
    pub(crate) at: [f64; 2],
}

/// Difference of support below which places fit about as well.
const ABOUT: f64 = 0.1;
/// Difference of offsets that are the same.
pub(crate) const SAME_OFFSET: f64 = 2.0;
/// Least share of its neighbours' fit that an element needs to be made, and how near to an equal one it may be.
pub(crate) const FITTING: f64 = 0.1;
pub(crate) const BESIDE: f64 = 0.75;
/// Operations on elements between two questions whether to go on.
pub(crate) const OPERATIONS: usize = 64;
/// Most cells along an axis.
const MOST_CELLS: f64 = 512.0;

pub(crate) struct Board<'a> {
    pub(crate) plane: PeriodicPlane,
    pub(crate) relations: &'a PlaceRelations<'a>,
    /// The elements; `None` where one was removed.
    pub(crate) elements: Vec<Option<BoardElement>>,
    cells: [usize; 2],
    lists: Vec<Vec<u32>>,
    /// Farthest point of any figure from its reference point.
    pub(crate) largest: f64,
    /// Sum of the areas of all elements, in pixels.
    pub(crate) area: f64,
    /// Whether elements are made in the region alone, and not around it.
    within_region: bool,
}

impl<'a> Board<'a> {
    pub(crate) fn new(plane: PeriodicPlane, relations: &'a PlaceRelations<'a>) -> Self {
        let cells = plane.size.map(|v| (v / relations.spacing.max(1e-6)).clamp(1.0, MOST_CELLS) as usize);
        let largest = relations.reach.iter().copied().fold(0.0, f64::max);
        let lists = vec![Vec::new(); cells[0] * cells[1]];
        let (elements, area, within_region) = (Vec::new(), 0.0, false);
        let mut made = Self { plane, relations, elements, cells, lists, largest, area, within_region };
        let first = relations.exemplar.places.len() as u32;
        for (e, place) in relations.standing_elements().iter().zip(first..) {
            made.add(BoardElement { place, at: e.at });
        }
        made
    }

    /// Number of the elements that stand, which are the first.
    pub(crate) fn given(&self) -> usize {
        self.relations.standing_elements().len()
    }

    /// For each element that stands the place of the exemplar with its figure, or the one like it, whose neighbours are
    /// the most like its own; of about equally good ones that which lies from it as those of most other elements do.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn like_places(&self, go_on: &dyn Fn() -> Result<()>) -> Result<Vec<u32>> {
        let (standing, places) = (self.relations.standing_elements(), &self.relations.exemplar.places);
        let all: Vec<usize> = (0..standing.len()).collect();
        let good_places = |&id: &usize| {
            let StandingElement { figure, like, at } = standing[id];
            let of = |figure: u32| (0..places.len()).filter(move |k| places[*k].figure == figure);
            let known = if of(figure).next().is_some() { figure } else { like };
            let fit = |k: usize| (self.support(BoardElement { place: k as u32, at }, Some(id)), k);
            let fits: Vec<(f64, usize)> = of(known).map(fit).collect();
            let best = fits.iter().map(|f| f.0).fold(f64::NEG_INFINITY, f64::max);
            fits.into_iter().filter(|f| f.0 >= best - ABOUT).map(|f| f.1).collect::<Vec<usize>>()
        };
        let mut good = Vec::with_capacity(all.len());
        for some in all.chunks(OPERATIONS) {
            go_on()?;
            good.extend(parallel::map(some, good_places));
        }
        let page = self.relations.exemplar.page;
        let offset = |id: usize, k: usize| {
            let (at, from) = (standing[id].at, places[k].at);
            page.wrapped([at[0] - from[0], at[1] - from[1]])
        };
        let of_all =
            |(id, good): (usize, &Vec<usize>)| good.iter().map(|k| offset(id, *k)).collect::<Vec<_>>();
        let offsets: Vec<[f64; 2]> = good.iter().enumerate().flat_map(of_all).collect();
        let index = PointIndex::new(page, SAME_OFFSET, &offsets);
        Ok(parallel::map(&all, |&id| {
            let votes = |k: usize| {
                let mut count = 0u32;
                index.within(offset(id, k), SAME_OFFSET, |_, _| count += 1);
                count
            };
            let most = good[id].iter().map(|k| (votes(*k), *k)).max_by_key(|v| (v.0, Reverse(v.1)));
            most.map_or(0, |v| v.1 as u32)
        }))
    }

    /// The figure of a place.
    pub(crate) fn figure(&self, place: u32) -> u32 {
        self.relations.figure(place)
    }

    /// Area of the figure of a place, in pixels.
    pub(crate) fn size(&self, place: u32) -> f64 {
        f64::from(self.relations.area(self.figure(place)))
    }

    /// Category of the figure of a place.
    pub(crate) fn category(&self, place: u32) -> usize {
        self.relations.exemplar.figures[self.figure(place) as usize].category as usize
    }

    /// Whether elements are made about a place.
    pub(crate) fn is_free(&self, at: [f64; 2]) -> bool {
        let here = |s: &StandingElements| if self.within_region { s.is_inside(at) } else { s.is_free(at) };
        self.relations.standing.as_ref().is_none_or(here)
    }

    /// Whether an element may be made at a place.
    pub(crate) fn is_open(&self, at: [f64; 2]) -> bool {
        self.is_free(at) && self.relations.standing.as_ref().is_none_or(|s| !s.is_taken(at))
    }

    /// Area in which elements are made.
    pub(crate) fn free_area(&self) -> f64 {
        let area = |s: &StandingElements| if self.within_region { s.inside_area } else { s.free_area };
        self.relations.standing.as_ref().map_or(self.plane.area(), area)
    }

    /// The area that the elements of each category of the exemplar cover, for the canvas; beside elements that stand, what
    /// they cover and what is to be covered. What is only cut by the border of the page is shared out among the others.
    pub(crate) fn wanted_areas(&self) -> Vec<f64> {
        let relations = self.relations;
        let figures = &relations.exemplar.figures;
        let count = figures.iter().map(|f| f.category as usize + 1).max().unwrap_or(0);
        let (mut areas, mut placeable) = (vec![0.0; count], vec![false; count]);
        for (place, area) in relations.exemplar.places.iter().zip(&relations.visible) {
            let category = figures[place.figure as usize].category as usize;
            areas[category] += area;
            placeable[category] |= place.placeable;
        }
        let all: f64 = areas.iter().sum();
        let kept: f64 = areas.iter().zip(&placeable).filter(|a| *a.1).map(|a| a.0).sum();
        let share = all / kept.max(1e-9) * self.free_area() / relations.exemplar.page.area();
        let mut areas: Vec<f64> =
            areas.iter().zip(placeable).map(|(area, is)| if is { area * share } else { 0.0 }).collect();
        for element in relations.standing_elements().iter().filter(|e| !self.is_free(e.at)) {
            areas[figures[element.figure as usize].category as usize] +=
                f64::from(relations.area(element.figure));
        }
        areas
    }

    /// The area that all elements together should cover.
    pub(crate) fn wanted(&self) -> f64 {
        self.wanted_areas().iter().sum()
    }

    /// Covered area as a share of what is wanted.
    pub(crate) fn fullness(&self) -> f64 {
        self.area / self.wanted().max(1.0)
    }

    /// Removes the elements that were made around a region, and lets none be made there.
    pub(crate) fn keep_region(&mut self) {
        self.within_region = true;
        for id in self.given()..self.elements.len() {
            if self.elements[id].is_some_and(|e| !self.is_free(e.at)) {
                self.remove(id);
            }
        }
    }

    fn cell(&self, p: [f64; 2]) -> usize {
        let along = |k: usize| {
            let cell = (p[k] / self.plane.size[k] * self.cells[k] as f64).max(0.0) as usize;
            cell.min(self.cells[k] - 1)
        };
        along(1) * self.cells[0] + along(0)
    }

    pub(crate) fn add(&mut self, element: BoardElement) -> usize {
        let element = BoardElement { at: self.plane.wrapped(element.at), ..element };
        let id = self.elements.len();
        let cell = self.cell(element.at);
        self.lists[cell].push(id as u32);
        self.area += self.size(element.place);
        self.elements.push(Some(element));
        id
    }

    pub(crate) fn remove(&mut self, id: usize) {
        if let Some(element) = self.elements[id].take() {
            let cell = self.cell(element.at);
            self.lists[cell].retain(|e| *e as usize != id);
            self.area -= self.size(element.place);
        }
    }

    /// Puts another element in the place of one.
    pub(crate) fn exchange(&mut self, id: usize, by: BoardElement) {
        if let Some(element) = self.elements[id].as_mut() {
            let from = std::mem::replace(&mut element.place, by.place);
            self.area += self.size(by.place) - self.size(from);
            self.shift(id, by.at);
        }
    }

    /// Moves an element.
    pub(crate) fn shift(&mut self, id: usize, to: [f64; 2]) {
        if let Some(element) = self.elements[id] {
            let moved = BoardElement { at: self.plane.wrapped(to), ..element };
            let (from, cell) = (self.cell(element.at), self.cell(moved.at));
            if from != cell {
                self.lists[from].retain(|e| *e as usize != id);
                self.lists[cell].push(id as u32);
            }
            self.elements[id] = Some(moved);
        }
    }

    /// The elements whose reference points are closer than `radius`, with the ways to them, by number.
    pub(crate) fn near(&self, at: [f64; 2], radius: f64) -> Vec<(usize, BoardElement, [f64; 2])> {
        let mut found = Vec::new();
        self.any_near(at, radius, |id, element, way| {
            found.push((id, element, way));
            false
        });
        found.sort_by_key(|f| f.0);
        found
    }

    /// Whether one of the elements of [`Board::near`], in any order, `is` something.
    fn any_near(
        &self,
        at: [f64; 2],
        radius: f64,
        mut is: impl FnMut(usize, BoardElement, [f64; 2]) -> bool,
    ) -> bool {
        let at = self.plane.wrapped(at);
        let side = [0, 1].map(|k| self.plane.size[k] / self.cells[k] as f64);
        let range = |k: usize| {
            let (low, high) =
                (libm::floor((at[k] - radius) / side[k]), libm::floor((at[k] + radius) / side[k]));
            let last = self.cells[k] as i64;
            if self.plane.wraps[k] {
                let count = ((high - low) as i64 + 1).min(last);
                (low as i64..low as i64 + count).map(|c| c.rem_euclid(last) as usize).collect::<Vec<_>>()
            } else {
                ((low as i64).clamp(0, last - 1)..=(high as i64).clamp(0, last - 1))
                    .map(|c| c as usize)
                    .collect()
            }
        };
        let (columns, rows) = (range(0), range(1));
        for row in rows {
            for column in &columns {
                for &id in &self.lists[row * self.cells[0] + column] {
                    let Some(element) = self.elements[id as usize] else { continue };
                    let way = self.plane.between(at, element.at);
                    if length(way) < radius && is(id as usize, element, way) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// The elements that may clash with one at a place: number, figure, and the way there.
    fn within_reach(&self, element: BoardElement) -> impl Iterator<Item = (usize, u32, [f64; 2])> + '_ {
        let near = self.near(element.at, self.reach_of(element)).into_iter();
        near.map(|(id, other, way)| (id, self.figure(other.place), way))
    }

    /// Distance up to which others may clash with an element.
    fn reach_of(&self, element: BoardElement) -> f64 {
        let figure = self.figure(element.place);
        self.relations.reach[figure as usize] + self.largest + self.relations.clearance + 1.0
    }

    /// The elements that clash with one at a place, but for `own`, and by how many pixels.
    pub(crate) fn clashes(&self, element: BoardElement, own: Option<usize>) -> Vec<(usize, f64)> {
        let figure = self.figure(element.place);
        let near = self.within_reach(element).filter(|n| Some(n.0) != own);
        let clash = near.map(|(id, other, way)| (id, self.relations.clash(figure, other, way)));
        clash.filter(|c| c.1 > 0.0).collect()
    }

    /// Whether an element may be made where it is, and would clash with no other.
    pub(crate) fn fits(&self, element: BoardElement) -> bool {
        let figure = self.figure(element.place);
        self.is_open(element.at)
            && !self.any_near(element.at, self.reach_of(element), |_, other, way| {
                self.relations.clash(figure, self.figure(other.place), way) > 0.0
            })
    }

    /// How much nearer an element of the same class is than in the exemplar, 0 to 1.
    pub(crate) fn twins(&self, element: BoardElement, own: Option<usize>) -> f64 {
        let figure = self.figure(element.place);
        let class = |figure: u32| self.relations.class[figure as usize];
        let wanted = self.relations.twin_distance[class(figure) as usize];
        let mut nearest = 0.0;
        self.any_near(element.at, 0.98 * wanted, |id, other, way| {
            if Some(id) != own && class(self.figure(other.place)) == class(figure) {
                nearest = f64::max(nearest, 1.0 - length(way) / wanted);
            }
            false
        });
        nearest
    }

    /// How well an element fits among its neighbours: the mean over the neighbours that it has in the exemplar, 1 for
    /// one that is there, 0 for one that is missing; less the surplus of neighbours.
    pub(crate) fn support(&self, element: BoardElement, own: Option<usize>) -> f64 {
        let partners = &self.relations.partners[element.place as usize];
        let Some(last) = partners.last() else { return 0.5 };
        let radius = length(last.way) + 0.25 * self.relations.spacing;
        let near = self.near(element.at, radius);
        let near: Vec<_> = near.into_iter().filter(|n| Some(n.0) != own).collect();
        let exemplar = self.relations.exemplar;
        let tolerance = 0.5 * self.relations.spacing;
        let mut sum = 0.0;
        for partner in partners {
            let wanted = exemplar.places[partner.place as usize].figure;
            let fit = near.iter().map(|(_, other, way)| {
                let off = length([way[0] - partner.way[0], way[1] - partner.way[1]]) / tolerance;
                let figure = self.figure(other.place);
                (1.0 - 2.0 * self.relations.strangeness(figure, wanted)) * (1.0 - off).max(0.0)
            });
            sum += fit.fold(0.0, f64::max);
        }
        let surplus = (near.len() as f64 - partners.len() as f64).max(0.0);
        (sum - 0.5 * surplus) / partners.len() as f64 - 0.5 * self.twins(element, own)
    }

    /// The elements, those removed left out.
    pub(crate) fn standing(&self) -> Vec<BoardElement> {
        self.elements.iter().flatten().copied().collect()
    }
}
