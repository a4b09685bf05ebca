//! What was set by numbers or names of categories follows them when these change.

use super::settings::StudioSettings;
use vtex_studio::elements::renumbered;

/// What is set, with the numbers and names of categories after a change of their names.
pub(super) fn following(settings: &StudioSettings, before: &[String], after: &[String]) -> StudioSettings {
    let numbers = renumbered(before, after);
    let operations = settings.operations.iter().filter_map(|text| with_numbers(text, &numbers)).collect();
    let mut options = settings.options.clone();
    if let Some(names) = options.remove(EXCLUDE) {
        let place = |name: &str| before.iter().position(|known| known == name);
        let new = |name: &str| {
            place(name).map_or_else(|| Some(name.to_owned()), |k| Some(after[numbers[k]?].clone()))
        };
        let names: Vec<String> = names.split(',').filter_map(new).collect();
        if !names.is_empty() {
            options.insert(EXCLUDE.into(), names.join(","));
        }
    }
    StudioSettings { operations, options, ..settings.clone() }
}

/// The option that names categories.
const EXCLUDE: &str = "exclude";

/// An operation with new numbers of the categories that its conditions name; `None` if all that it was done to are gone.
fn with_numbers(operation: &str, numbers: &[Option<usize>]) -> Option<String> {
    let mut text = String::new();
    let mut rest = operation;
    while let Some(at) = rest.find("category") {
        let (head, tail) = rest.split_at(at + "category".len());
        let signs = tail.len() - tail.trim_start_matches([' ', '!', '=']).len();
        let (sign, tail) = tail.split_at(signs);
        let digits = tail.len() - tail.trim_start_matches(|c: char| c.is_ascii_digit() || c == '|').len();
        let (list, tail) = tail.split_at(digits);
        text += head;
        text += sign;
        rest = tail;
        if !sign.contains('=') || list.is_empty() {
            text += list;
            continue;
        }
        let new = |number: &str| {
            // A number that no category has stays.
            let index = number.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
            match index.and_then(|index| numbers.get(index)) {
                Some(new) => new.map(|new| (new + 1).to_string()),
                None => Some(number.to_owned()),
            }
        };
        let kept: Vec<String> = list.split('|').filter_map(new).collect();
        if kept.is_empty() {
            return None;
        }
        text += &kept.join("|");
    }
    Some(text + rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn operations_and_options_follow_categories() {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let operation = |text: &str| text.to_owned();
        let settings = StudioSettings {
            operations: [
                "recolor --from #111111 --to #222222 --where category=3",
                "thin 0.5 --where category=2 --where 'area>3'",
                "tint red --where 'category!=1|3'",
                "shuffle --within category",
                "flatten --where category=9",
            ]
            .map(operation)
            .to_vec(),
            options: BTreeMap::from([
                ("exclude".into(), "clay,other".into()),
                ("tile".into(), "both".into()),
            ]),
            ..StudioSettings::new(None)
        };
        // Stone goes into moss, and clay gets another name.
        let followed = following(&settings, &names(&["moss", "stone", "clay"]), &names(&["moss", "clay"]));
        let expected = [
            "recolor --from #111111 --to #222222 --where category=2",
            "tint red --where 'category!=1|2'",
            "shuffle --within category",
            "flatten --where category=9",
        ];
        assert_eq!(followed.operations, expected);
        assert_eq!((&followed.options["exclude"][..], followed.options.len()), ("clay,other", 2));
        let renamed =
            following(&settings, &names(&["moss", "stone", "clay"]), &names(&["moss", "stone", "mud"]));
        assert_eq!((renamed.operations.len(), &renamed.options["exclude"][..]), (5, "mud,other"));
        let merged = following(&settings, &names(&["moss", "stone", "clay"]), &names(&["moss", "stone"]));
        assert_eq!((merged.operations.len(), &merged.options["exclude"][..]), (4, "other"));
    }
}
