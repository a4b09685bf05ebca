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

/// Least ratio of sizes that names mention, and the difference of lightness in Oklab that is as clear.
const SIZE_STEP: f64 = 2.0;
const LIGHTNESS_STEP: f64 = 0.1;

/// A different name for each thing of a colour and a size, above 0. Where several have the same plain name, two or three
/// are distinguished by size if it is clear and clearer than lightness, else as by [`distinct`]; more are numbered in
/// their order.
pub fn distinct_sized(things: &[(Colour, f64)]) -> Vec<String> {
    let words: Vec<String> = things.iter().map(|thing| name(thing.0)).collect();
    let mut names = words.clone();
    for word in &words {
        let twins: Vec<usize> = (0..words.len()).filter(|&i| words[i] == *word).collect();
        let mut by_size = twins.clone();
        by_size.sort_by(|&a, &b| things[b].1.total_cmp(&things[a].1));
        let sizes: &[&str] = match twins.len() {
            1 => continue,
            2 => &["large", "small"],
            3 => &["large", "medium", "small"],
            _ => &[],
        };
        let mut lightness: Vec<f64> = twins.iter().map(|&i| things[i].0.to_oklab()[0].into()).collect();
        lightness.sort_by(f64::total_cmp);
        let least = |steps: &mut dyn Iterator<Item = f64>| steps.fold(f64::INFINITY, f64::min);
        let ratio = least(&mut by_size.windows(2).map(|pair| things[pair[0]].1 / things[pair[1]].1));
        let shade = least(&mut lightness.windows(2).map(|pair| (pair[1] - pair[0]) / LIGHTNESS_STEP));
        if !sizes.is_empty() && ratio >= SIZE_STEP && libm::log(ratio) / libm::log(SIZE_STEP) >= shade {
            by_size.iter().zip(sizes).for_each(|(&i, size)| names[i] = format!("{size} {word}"));
        } else if sizes.is_empty() {
            twins.iter().enumerate().for_each(|(n, &i)| names[i] = format!("{word} {}", n + 1));
        } else {
            let colours: Vec<Colour> = twins.iter().map(|&i| things[i].0).collect();
            twins.iter().zip(distinct(&colours)).for_each(|(&i, name)| names[i] = name);
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

    #[test]
    fn names_of_things_differ_by_size_first() {
        let of = |things: &[(u8, f64)]| {
            distinct_sized(&things.iter().map(|&(v, size)| (Colour([v; 3]), size)).collect::<Vec<_>>())
        };
        assert_eq!(of(&[(120, 10.0), (130, 90.0), (250, 1.0)]), ["small grey", "large grey", "white"]);
        assert_eq!(of(&[(120, 9.0), (120, 3.0), (120, 1.0)]), ["large grey", "medium grey", "small grey"]);
        assert_eq!(of(&[(140, 10.0), (120, 11.0)]), ["lighter grey", "darker grey"]);
        assert_eq!(of(&[(150, 21.0), (90, 10.0)]), ["lighter grey", "darker grey"]);
        assert_eq!(
            of(&[(140, 9.0), (120, 1.0), (130, 3.0), (135, 5.0)]),
            ["grey 1", "grey 2", "grey 3", "grey 4"]
        );
        assert!(of(&[]).is_empty());
    }
}
