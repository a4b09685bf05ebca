//! Texts of operations are parsed, or refused with a correction.

use super::line::{Line, parse};
use clap::CommandFactory;
use vtex::edit::{
    About, Action, ColourOrMap, Comparison, Condition, Direction, Distribution, Identity, Jitter, Keep,
    NumberOrMap, Operation, OrderBy, Quantity, ThinOrder, Within,
};
use vtex::raster::colour::Colour;
use vtex::scene::InstanceId;

fn palette(_: &str) -> vtex::Result<Vec<u8>> {
    Ok(b"#ffe0a0 #203040".to_vec())
}

fn operation(text: &str) -> Operation {
    parse(text, palette).unwrap_or_else(|e| panic!("{text}: {e}")).operation
}

fn fault(text: &str) -> [String; 2] {
    let (message, hint, exit) = crate::cli::failure::explain(&parse(text, palette).unwrap_err());
    assert_eq!(exit, crate::cli::exit::Exit::Usage);
    [message, hint.unwrap_or_default()]
}

#[test]
fn texts_mean_operations() {
    let colour = |hex| Colour::from_hex(hex).unwrap();
    for (text, action) in [
        ("thin 0.5", Action::Thin { keep: Some(0.5), order: ThinOrder::BlueNoise, minimum_area: None }),
        (
            "thin --min-area 9 0.2 --order area",
            Action::Thin { keep: Some(0.2), order: ThinOrder::Area, minimum_area: Some(9.0) },
        ),
        ("density 'a b.png'", Action::Density { map: "a b.png".into() }),
        ("orient -30", Action::Orient { direction: Direction::Angle(-30.0), strength: 1.0 }),
        (
            "orient C:\\x.png --strength=0.5",
            Action::Orient { direction: Direction::Map("C:\\x.png".into()), strength: 0.5 },
        ),
        ("tint #f00", Action::Tint { colour: colour("#ff0000").into(), amount: 0.5, share: 1.0 }),
        ("tint Red", Action::Tint { colour: colour("#ff0000").into(), amount: 0.5, share: 1.0 }),
        (
            "recolor --to #102030 --from #fff",
            Action::Recolor {
                from: colour("#ffffff"),
                to: colour("#102030"),
                reach: 0.2,
                keep: Keep::Nothing,
            },
        ),
        (
            "palette two.txt",
            Action::Palette {
                colours: vec![colour("#ffe0a0"), colour("#203040")],
                file: Some("two.txt".into()),
            },
        ),
        ("shadow --blur 2", Action::Shadow { angle: 45.0, length: 5.0, opacity: 0.4, blur: 2.0 }),
        ("flatten", Action::Flatten),
        ("simplify 1", Action::Simplify { tolerance: 1.0 }),
        ("outline 1.5 #202020", Action::Outline { width: 1.5, colour: colour("#202020") }),
        (
            "hatch --spacing 5 --paper #ffeedd",
            Action::Hatch {
                spacing: 5.0,
                angle: -45.0,
                width: 0.7,
                colour: colour("#202020"),
                paper: colour("#ffeedd"),
            },
        ),
        ("replace b.lib.json", Action::Replace { library: "b.lib.json".into() }),
        ("move 20 -5", Action::Move { x: 20.0, y: -5.0 }),
        ("scale 1.3", Action::Scale { factor: 1.3.into() }),
        ("rotate -90", Action::Rotate { angle: (-90.0).into() }),
        ("jitter --move 4", Action::Jitter(Jitter { distance: 4.0, ..Jitter::default() })),
        (
            "tint photo.png",
            Action::Tint { colour: ColourOrMap::Map("photo.png".into()), amount: 0.5, share: 1.0 },
        ),
        ("scale grow.png", Action::Scale { factor: NumberOrMap::Map("grow.png".into()) }),
        (
            "transform --move -20,5 --scale 2 --about selection",
            Action::Transform { by: [-20.0, 5.0], scale: [2.0; 2], angle: 0.0, about: About::Selection },
        ),
        (
            "transform --move -3 --scale 0.5,2 --rotate -9",
            Action::Transform { by: [-3.0, 0.0], scale: [0.5, 2.0], angle: -9.0, about: About::Each },
        ),
        (
            "jitter --hue 20 --flip 0.5 --distribution normal --steps 4",
            Action::Jitter(Jitter {
                hue: 20.0,
                flip: 0.5,
                distribution: Distribution::Normal,
                steps: 4,
                ..Jitter::default()
            }),
        ),
        (
            "shuffle --within category --outlines exchange",
            Action::Shuffle { within: Within::Category, share: 1.0, outlines: true },
        ),
        (
            "vary --color 2 --shape flat.png",
            Action::Vary {
                colour: Some(2.0.into()),
                shape: Some(NumberOrMap::Map("flat.png".into())),
                within: Within::Layer,
            },
        ),
        ("relax --min-distance 9", Action::Relax { rounds: 20, strength: 0.5, minimum_distance: Some(9.0) }),
        (
            "propagate veins.svg --similar 0.1 --mode replace",
            Action::Propagate {
                drawing: Some("veins.svg".into()),
                element: None,
                fill: None,
                of: None,
                similar: Some(0.1),
                replace: true,
            },
        ),
        (
            "propagate --element star.svg --of p7",
            Action::Propagate {
                drawing: None,
                element: Some("star.svg".into()),
                fill: None,
                of: Some(InstanceId(7)),
                similar: None,
                replace: true,
            },
        ),
        (
            "propagate --fill red --of 7",
            Action::Propagate {
                drawing: None,
                element: None,
                fill: Some(Colour([255, 0, 0])),
                of: Some(InstanceId(7)),
                similar: None,
                replace: false,
            },
        ),
        ("order y --first most", Action::Order { by: OrderBy::Y, reverse: true }),
        ("delete", Action::Delete),
        ("mask disc.svg", Action::Mask { shape: "disc.svg".into(), inside: true }),
        ("mask disc.svg --keep outside", Action::Mask { shape: "disc.svg".into(), inside: false }),
    ] {
        assert_eq!(operation(text), action.into(), "{text}");
    }
    let all =
        operation("delete --layer secondary --where 'category!=3|5, area>=20,x<9' --where outside=a.svg");
    assert_eq!(all.layer.as_deref(), Some("secondary"));
    let compare = |quantity, comparison, limit| Condition::Compare { quantity, comparison, limit };
    assert_eq!(
        all.conditions,
        [
            Condition::Among { identity: Identity::Category, numbers: vec![2, 4], wanted: false },
            compare(Quantity::Area, Comparison::AtLeast, 20.0),
            compare(Quantity::X, Comparison::Less, 9.0),
            Condition::Place { shape: "a.svg".into(), inside: false },
        ]
    );
}

#[test]
fn every_example_can_be_parsed_and_every_parameter_is_explained() {
    let mut line = Line::command();
    line.build();
    line.clone().debug_assert();
    for verb in line.get_subcommands() {
        let example = verb.get_after_help().unwrap().to_string();
        assert!(example.starts_with(verb.get_name()), "{example}");
        operation(&example);
        for argument in verb.get_arguments() {
            let help = argument.get_help().unwrap().to_string();
            assert!(help.ends_with(']'), "{} {help}", verb.get_name());
            let defaults = argument.get_default_values();
            let default = defaults.first().map(|d| format!("default: {}", d.to_string_lossy()));
            assert!(default.is_none_or(|d| help.contains(&d)), "{} {help}", verb.get_name());
        }
    }
}

#[test]
fn faults_are_told_with_what_would_be_right() {
    for (text, message, hint) in [
        ("", "it is empty", "thin, density"),
        ("tnit #fff", "there is no operation 'tnit'", "did you mean 'tint'? the operations are thin,"),
        ("tint", "COLOUR is missing", "tint COLOUR [--amount NUMBER]"),
        ("tint reddish", "COLOUR = reddish: expected #rrggbb, #rgb or a name of CSS", "such as: tint"),
        ("tint #fff --amout 1", "'tint' has no flag '--amout'", "did you mean '--amount'?"),
        ("tint #fff --amount", "--amount needs a value", "[--amount NUMBER]"),
        ("tint #fff --amount 1.5", "--amount = 1.5: expected 0 to 1", "such as: tint"),
        ("tint #fff --amount NaN", "--amount = NaN: expected 0 to 1", ""),
        ("tint #fff #000", "'#000' is one word too many", "tint COLOUR"),
        ("thin", "nothing says how much to keep", "such as: thin 0.5"),
        ("thin 2", "KEEP = 2: expected 0 to 1", "such as: thin 0.5"),
        ("thin 0.5 --order bluenoise", "is none of blue-noise, random, area", "did you mean 'blue-noise'?"),
        ("thin 0.5 --layer background", "'thin' cannot be done to the background", "tint, recolor, palette"),
        ("vary --within layer", "nothing says what to change", "vary --color 1.5"),
        ("vary --color 9", "--color = 9: expected 0 to 4", "such as: vary"),
        ("orient 400", "DEGREES = 400: expected -360 to 360 degrees", "such as: orient"),
        ("transform --move 3,x", "--move = 3,x: expected -1000000 to 1000000 px each", "such as: transform"),
        ("order z", "none of x, y, area, lightness, random", "did you mean"),
        ("jitter --move 0", "nothing says what to change", "jitter --move 4"),
        ("delete --where colour=3", "'colour' is nothing that elements have", "did you mean"),
        ("delete --where area=3", "'area' is not compared by '='", "area>200"),
        ("delete --where area>x", "'x' is no number", "area>200"),
        ("delete --where category=1.5", "neither the name nor the number of a category", "category=3"),
        ("delete --where id=1.5", "is no whole number", "category=3"),
        ("delete --where inside=", "names no file", "inside=FILE"),
        ("delete --where category", "is no condition", "category=3"),
        ("tint #fff --amount 0.2 --amount=0.3", "--amount is given twice", "once"),
        ("thin --min-area 9 --order area", "--order says which go first", "such as: thin 0.5"),
        ("tint #fff --layer background --where x<9,area>3", "has no categories", "told apart by x"),
        ("delete --where 'area>3", "a quote ' is not closed", "close it"),
    ] {
        let [found, advice] = fault(text);
        assert!(found.contains(message), "{text}: {found}");
        assert!(advice.contains(hint), "{text}: {advice}");
    }
}

proptest::proptest! {
    #[test]
    fn any_text_is_an_operation_or_a_fault(text in "\\PC*|(tint|thin|move|jitter) [a-z0-9#.=<>|,' -]{0,60}") {
        if let Ok(asked) = parse(&text, palette) {
            // The recorded text of an operation parses to the same operation.
            proptest::prop_assert_eq!(&parse(text.trim(), palette).unwrap(), &asked);
            let record = serde_json::to_string(&asked.operation).unwrap();
            proptest::prop_assert_eq!(serde_json::from_str::<Operation>(&record).unwrap(), asked.operation);
        }
    }
}
