//! Plain names for colours.

use super::colour::Colour;

/// A different name for each colour. Where several have the same plain name, they are distinguished by
/// lightness, or by numbers from the darkest on if there are more than three.
pub fn distinct(colours: &[Colour]) -> Vec<String> {
    let mut names: Vec<String> = colours.iter().map(|&colour| name(colour)).collect();
    for i in 0..names.len() {
        let word = names[i].clone();
        let mut twins: Vec<usize> = (0..names.len()).filter(|&j| names[j] == word).collect();
        let lightness = |k: &usize| colours[*k].to_oklab()[0];
        twins.sort_by(|a, b| lightness(a).total_cmp(&lightness(b)));
        if let [dark, .., light] = twins[..]
            && twins.len() < 4
        {
            names[dark] = format!("darker {word}");
            names[light] = format!("lighter {word}");
        } else if twins.len() > 3 {
            for (n, &k) in twins.iter().enumerate() {
                names[k] = format!("{word} {}", n + 1);
            }
        }
    }
    names
}

/// A plain name for a colour, by its lightness, chroma and hue in Oklab.
pub fn name(colour: Colour) -> String {
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
    fn names_of_a_list_differ() {
        let of = |greys: &[u8]| distinct(&greys.iter().map(|&v| Colour([v; 3])).collect::<Vec<_>>());
        assert_eq!(of(&[140, 120]), ["lighter grey", "darker grey"]);
        assert_eq!(of(&[130, 120, 140]), ["grey", "darker grey", "lighter grey"]);
        assert_eq!(of(&[130, 120, 140, 110]), ["grey 3", "grey 2", "grey 4", "grey 1"]);
        assert_eq!(of(&[130, 130]), ["darker grey", "lighter grey"]);
    }
}
