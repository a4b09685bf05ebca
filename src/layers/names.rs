//! Plain names for colours.

use super::map::Layer;
use crate::raster::colour::Colour;

/// Layers with these colours, from bottom to top: names differ, and so do colours.
pub(super) fn named(colours: &[Colour]) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::with_capacity(colours.len());
    for &colour in colours {
        let mut colour = colour;
        while layers.iter().any(|l| l.colour == colour) {
            // One step of blue is not seen, and tells two equal colours apart in a file.
            colour.0[2] = colour.0[2].checked_add(1).unwrap_or(colour.0[2] - 8);
        }
        layers.push(Layer { name: name(colour), colour });
    }
    for i in 0..layers.len() {
        let mut twins: Vec<usize> = (0..layers.len()).filter(|&j| layers[j].name == layers[i].name).collect();
        // Told apart by lightness, or by number where there are many.
        let lightness = |k: &usize| layers[*k].colour.to_oklab()[0];
        twins.sort_by(|a, b| lightness(a).total_cmp(&lightness(b)));
        let word = layers[i].name.clone();
        if let [dark, .., light] = twins[..]
            && twins.len() < 4
        {
            layers[dark].name = format!("darker {word}");
            layers[light].name = format!("lighter {word}");
        } else if twins.len() > 3 {
            for (n, &k) in twins.iter().enumerate() {
                layers[k].name = format!("{word} {}", n + 1);
            }
        }
    }
    layers
}

/// A plain name for a colour, by its lightness, chroma and hue in Oklab.
pub(super) fn name(colour: Colour) -> String {
    let [lightness, a, b] = colour.to_oklab();
    let chroma = libm::sqrtf(a * a + b * b);
    if chroma < 0.02 {
        let greys = [(0.25, "black"), (0.45, "dark grey"), (0.72, "grey"), (0.9, "light grey")];
        return greys.iter().find(|g| lightness < g.0).map_or("white", |g| g.1).into();
    }
    let hue = libm::atan2f(b, a).to_degrees().rem_euclid(360.0);
    let dull = chroma < 0.055;
    let word = match hue {
        18.0..40.0 if lightness < 0.55 => {
            if dull {
                "reddish brown"
            } else {
                "dark red"
            }
        }
        0.0..40.0 => {
            if dull {
                "greyish pink"
            } else {
                "red"
            }
        }
        40.0..78.0 if dull => {
            if lightness > 0.7 {
                "beige"
            } else {
                "greyish brown"
            }
        }
        40.0..62.0 if lightness < 0.66 => "rust brown",
        62.0..78.0 if lightness < 0.66 => "brown",
        40.0..78.0 => "orange",
        78.0..112.0 if dull => {
            if lightness > 0.7 {
                "sand"
            } else {
                "khaki"
            }
        }
        78.0..112.0 if lightness < 0.66 => "olive",
        78.0..112.0 => {
            if chroma > 0.13 {
                "yellow"
            } else {
                "ochre"
            }
        }
        112.0..165.0 => {
            if dull {
                "greyish green"
            } else if lightness < 0.5 {
                "moss green"
            } else {
                "green"
            }
        }
        165.0..215.0 => {
            if dull {
                "greyish teal"
            } else {
                "teal"
            }
        }
        215.0..285.0 => {
            if dull {
                "greyish blue"
            } else {
                "blue"
            }
        }
        285.0..330.0 => {
            if dull {
                "mauve"
            } else {
                "violet"
            }
        }
        _ => {
            if dull {
                "greyish pink"
            } else {
                "pink"
            }
        }
    };
    let known = word.starts_with("dark") || word == "moss green";
    match lightness {
        ..0.36 if !known => format!("dark {word}"),
        0.82.. => format!("pale {word}"),
        _ => word.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_what_people_say() {
        let of = |rgb: [u8; 3]| name(Colour(rgb));
        assert_eq!(of([155, 105, 80]), "rust brown");
        assert_eq!(of([128, 128, 128]), "grey");
        assert_eq!(of([250, 250, 250]), "white");
        assert_eq!(of([10, 10, 10]), "black");
        assert_eq!(of([220, 30, 30]), "red");
        assert_eq!(of([30, 70, 200]), "blue");
        assert_eq!(of([240, 210, 20]), "pale yellow");
        assert_eq!(of([100, 95, 30]), "olive");
        assert_eq!(of([40, 140, 50]), "green");
    }

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
