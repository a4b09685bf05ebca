//! The tables of `docs/papers.md`: the program knows what their commands ask for, files are made before they are used,
//! and each paper has a sheet of pictures. The commands themselves are run by `tools/paper_figures.py`.
#![cfg(all(unix, feature = "cli", feature = "clustered", feature = "curves"))]

use super::cli::support::{vtex, words};
use super::pages::{files, read, root};
use std::collections::BTreeSet;

/// Largest size of a sheet, in bytes.
const LARGEST: u64 = 200_000;

fn page() -> String {
    read(&root().join("docs/papers.md"))
}

/// The commands of a part of the page, in order: lines of blocks, and texts in backticks.
fn commands(part: &str) -> Vec<String> {
    let blocks = part.split("```sh\n").skip(1).flat_map(|block| block.split("```").next().unwrap().lines());
    let cells =
        part.lines().filter(|line| line.starts_with('|')).flat_map(|row| row.split('`').skip(1).step_by(2));
    blocks.chain(cells).filter(|text| text.starts_with("vtex ")).map(Into::into).collect()
}

fn run(arguments: &[String]) -> std::process::Output {
    vtex().args(arguments).output().unwrap()
}

#[test]
fn options_and_operations_exist() {
    let list = run(&["edit".into(), "--list".into()]);
    let list = String::from_utf8(list.stdout).unwrap();
    let operations: BTreeSet<&str> = list
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_lowercase()))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(operations.contains("thin"), "{operations:?}");
    let commands = commands(&page());
    assert!(commands.len() > 100, "{} commands", commands.len());
    for command in commands {
        let mut words = words(&command);
        for pair in words.windows(2).filter(|pair| pair[0] == "--op") {
            let verb = pair[1].split_whitespace().next().unwrap();
            assert!(operations.contains(verb), "{command}: no {verb}");
        }
        words.remove(0);
        // With this the program reads its options and does nothing else.
        words.push("--dump-config".into());
        let output = run(&words);
        assert!(output.status.success(), "{command}\n{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn files_are_there_or_made_before() {
    let mut known: BTreeSet<String> = BTreeSet::new();
    let mut found = Vec::new();
    for (folder, extension) in [("exemplars", "png"), ("drawings", "svg"), ("maps", "svg")] {
        files(&root().join("examples").join(folder), extension, &mut found);
    }
    known.extend(found.iter().map(|path| path.file_name().unwrap().to_string_lossy().into_owned()));
    let is_file = |word: &&str| {
        [".png", ".svg", ".gif", ".lib.json", ".scene.json"].iter().any(|ending| word.ends_with(ending))
    };
    for part in page().split("\n## ") {
        for command in commands(part) {
            let words = words(&command);
            let (mut made, mut used) = (Vec::new(), Vec::new());
            let words: Vec<&str> = words.iter().flat_map(|w| w.split(['=', ' '])).collect();
            for (k, word) in words.iter().enumerate().filter(|(_, word)| is_file(word)) {
                let is_made = k > 0 && ["-o", "--save-layers"].contains(&words[k - 1]);
                if is_made { &mut made } else { &mut used }.push((*word).to_owned());
            }
            if words[1] == "analyze" && !words.contains(&"-o") {
                made.push(format!("{}.lib.json", words[2].rsplit_once('.').unwrap().0));
            }
            for file in used {
                assert!(known.contains(&file), "{command}: no {file}");
            }
            known.extend(made);
        }
    }
}

#[test]
fn rows_are_numbered_and_papers_have_sheets() {
    let page = page();
    let papers: Vec<&str> = page.split("\n## ").filter(|part| part.contains("\n| no. |")).collect();
    assert_eq!(papers.len(), 6);
    for paper in papers {
        let rows = paper.lines().filter(|l| l.starts_with("| ") && !l.starts_with("| no. |"));
        let numbers: Vec<&str> = rows.map(|row| row[2..].split(' ').next().unwrap()).collect();
        let letter = &numbers[0][..1];
        let wanted: Vec<String> = (1..=numbers.len()).map(|k| format!("{letter}{k}")).collect();
        assert_eq!(numbers, wanted);
        let sheet = paper.split("](images/").nth(1).unwrap().split(')').next().unwrap();
        assert!(
            paper.contains(&format!("![pictures {letter}1 to {letter}{}, by row]", numbers.len())),
            "{sheet}"
        );
        let size = std::fs::metadata(root().join("docs/images").join(sheet)).unwrap().len();
        assert!(size < LARGEST, "{sheet}: {size} bytes");
    }
}
