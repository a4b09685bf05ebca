//! What was set by numbers or names of categories follows them when these change.

use super::settings::StudioSettings;
use vtex::library::CategoryId;
use vtex_studio::elements::renumbered;

/// What is set, with the numbers and names of categories after a change of their names.
pub(super) fn following(settings: &StudioSettings, before: &[String], after: &[String]) -> StudioSettings {
    let numbers = renumbered(before, after);
    let following = Following { before, after, numbers };
    let operations = settings.operations.iter().filter_map(|text| following.operation(text)).collect();
    let mut options = settings.options.clone();
    if let Some(names) = options.remove(EXCLUDE) {
        let names: Vec<String> = names.split(',').filter_map(|name| following.item(name)).collect();
        if !names.is_empty() {
            options.insert(EXCLUDE.into(), names.join(","));
        }
    }
    StudioSettings { operations, options, ..settings.clone() }
}

/// The option that names categories.
const EXCLUDE: &str = "exclude";

/// Names of categories before and after a change, and the new index of each.
struct Following<'a> {
    before: &'a [String],
    after: &'a [String],
    numbers: Vec<Option<usize>>,
}

impl Following<'_> {
    /// The new name or number of a category; `None` if it is gone. What no category had stays.
    fn item(&self, item: &str) -> Option<String> {
        let Some(old) = CategoryId::find(self.before, item) else { return Some(item.to_owned()) };
        let new = self.numbers[old.index()]?;
        let is_name = self.before[old.index()].to_lowercase() == item.to_lowercase();
        Some(if is_name { self.after[new].clone() } else { (new + 1).to_string() })
    }

    /// An operation with new names and numbers of the categories in its conditions; `None` if all that it was done to
    /// are gone.
    fn operation(&self, operation: &str) -> Option<String> {
        let mut text = String::new();
        let mut rest = operation;
        let mut quote = None;
        while let Some(at) = rest.find("category") {
            let (head, tail) = rest.split_at(at + "category".len());
            quote = open_quote(head, quote);
            let signs = tail.len() - tail.trim_start_matches([' ', '!', '=']).len();
            let (sign, tail) = tail.split_at(signs);
            text += head;
            text += sign;
            rest = tail;
            if !sign.contains('=') {
                continue;
            }
            // A list in quotes of its own, else one up to the next condition or word.
            let own = tail.chars().next().filter(|c| quote.is_none() && ['"', '\''].contains(c));
            let inner = &tail[own.map_or(0, char::len_utf8)..];
            let ends = |c: char| match own.or(quote) {
                Some(open) => c == open || c == ',',
                None => c == ',' || c.is_whitespace(),
            };
            let (list, after) = inner.split_at(inner.find(ends).unwrap_or(inner.len()));
            let kept: Vec<String> = list.split('|').filter_map(|item| self.item(item.trim())).collect();
            if kept.is_empty() {
                return None;
            }
            let kept = kept.join("|");
            if let Some(open) = own {
                text.push(open);
                quote = own;
            }
            let is_bare = own.or(quote).is_none();
            text += &if is_bare && kept.contains(' ') { format!("'{kept}'") } else { kept };
            rest = after;
        }
        Some(text + rest)
    }
}

/// The quote that is open after a text, if `quote` is open before it.
fn open_quote(text: &str, quote: Option<char>) -> Option<char> {
    text.chars().fold(quote, |open, c| match open {
        Some(own) => (own != c).then_some(own),
        None => Some(c).filter(|c| ['"', '\''].contains(c)),
    })
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
                "tint blue --where 'area>3,category=Stone|CLAY|sky' --layer primary",
                "tint green --where category!='clay'",
                "delete --where category=stone",
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
            "tint blue --where 'area>3,category=clay|sky' --layer primary",
            "tint green --where category!='clay'",
        ];
        assert_eq!(followed.operations, expected);
        assert_eq!((&followed.options["exclude"][..], followed.options.len()), ("clay,other", 2));
        let renamed =
            following(&settings, &names(&["moss", "stone", "clay"]), &names(&["moss", "wet stone", "mud"]));
        assert_eq!((renamed.operations.len(), &renamed.options["exclude"][..]), (8, "mud,other"));
        assert_eq!(
            renamed.operations[5],
            "tint blue --where 'area>3,category=wet stone|mud|sky' --layer primary"
        );
        assert_eq!(renamed.operations[7], "delete --where category='wet stone'");
        let merged = following(&settings, &names(&["moss", "stone", "clay"]), &names(&["moss", "stone"]));
        assert_eq!((merged.operations.len(), &merged.options["exclude"][..]), (6, "other"));
    }
}
