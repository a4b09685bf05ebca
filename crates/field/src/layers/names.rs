//! Plain names for layers.

use super::map::MapLayer;
use vtex_base::raster::colour::Colour;
use vtex_base::raster::colour_names;

/// Layers with these colours, from bottom to top. Names and colours are made unique.
pub(super) fn named(colours: &[Colour]) -> Vec<MapLayer> {
    let mut distinct: Vec<Colour> = Vec::with_capacity(colours.len());
    for &colour in colours {
        let mut colour = colour;
        while distinct.contains(&colour) {
            // One step of blue is invisible and distinguishes two equal colours in a file.
            colour.0[2] = colour.0[2].checked_add(1).unwrap_or(colour.0[2] - 8);
        }
        distinct.push(colour);
    }
    let names = colour_names::distinct(&distinct);
    names.into_iter().zip(distinct).map(|(name, colour)| MapLayer { name, colour }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_colours_of_a_map_differ() {
        let layers = named(&[Colour([90; 3]), Colour([200, 30, 30]), Colour([120; 3]), Colour([120; 3])]);
        for (i, a) in layers.iter().enumerate() {
            assert!(layers[..i].iter().all(|b| a.name != b.name && a.colour != b.colour), "{layers:?}");
        }
        let layers = named(&[Colour([140; 3]), Colour([120; 3])]);
        assert_eq!([&layers[0].name[..], &layers[1].name[..]], ["lighter grey", "darker grey"]);
        let three = named(&[130, 120, 140].map(|v| Colour([v; 3])));
        assert_eq!([0, 1, 2].map(|k| &three[k].name[..]), ["grey", "darker grey", "lighter grey"]);
        let four = named(&[130, 120, 140, 110].map(|v| Colour([v; 3])));
        assert_eq!(four[3].name, "grey 1");
    }
}
