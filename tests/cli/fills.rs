//! Swatches of one ink, and tiles for the fills of other programs.

use super::support::Folder;

/// A swatch that repeats: a filled square, lines of which one crosses the border, and a white disc on it.
const SWATCH: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="40.25" height="40" viewBox="0 0 40.25 40">
<path d="M8 8h6v6h-6z"/>
<path d="M18 31l7 3M-3 20h6M37.25 20h6" fill="none" stroke="#000"/>
<circle cx="30" cy="9" r="4" fill="#fff" stroke="#000"/>
</svg>"##;

const SPOTTED: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="40">
<path d="M8 8h6v6h-6z"/><path d="M28 8h6v6h-6z" fill="#c00"/><path d="M8 28h6v6h-6z"/><path d="M28 28h6v6h-6z"/>
</svg>"##;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("swatch.svg", SWATCH);
    folder.write("spotted.svg", SPOTTED);
    folder.run("analyze swatch.svg --wrap=on").succeeds();
    folder
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).unwrap()
}

/// The colour of a pixel of a PNG.
fn pixel(folder: &Folder, name: &str, [x, y]: [u32; 2]) -> [u8; 4] {
    image::load_from_memory(&folder.read(name)).unwrap().to_rgba8().get_pixel(x, y).0
}

#[test]
fn ink_and_paper_of_a_swatch_are_chosen() {
    let folder = folder();
    let synth = "synth swatch.lib.json --size 40 --variation 0 --seed 1";
    folder.run(&format!("{synth} -o plain.svg")).succeeds();
    assert!(text(&folder, "plain.svg").contains(r##"class="ink" color="#000" fill="currentColor""##));
    folder.run(&format!("{synth} --ink crimson --paper navy -o red.svg -o red.png")).succeeds();
    let red = text(&folder, "red.svg");
    assert!(red.contains(r##"color="#dc143c""##) && !red.contains("#fff\""), "{red}");
    assert_eq!(pixel(&folder, "red.png", [11, 11]), [220, 20, 60, 255]);
    // What was white is paper.
    assert_eq!([[30, 9], [2, 2]].map(|at| pixel(&folder, "red.png", at)), [[0, 0, 128, 255]; 2]);
    // A finished scene can be drawn in any ink.
    folder.run(&format!("{synth} -o a.scene.json")).succeeds();
    folder.run("render a.scene.json --ink crimson --paper navy -o again.png").succeeds();
    assert_eq!(folder.read("again.png"), folder.read("red.png"));
    folder.run(&format!("{synth} --ink red --paper none -o b.svg")).fails(1, "cannot be transparent");
    folder.run("texture spotted.svg --ink red -o b.svg").fails(1, "several colours, such as #");
    folder
        .run("texture photo.png --ink red -o b.svg --size 60 --seed 1 --quiet")
        .fails(1, "gradients, soft shading or shadows");
    assert!(!folder.names().iter().any(|name| name == "b.svg"));
}

#[test]
fn a_pattern_is_one_page_in_plain_shapes() {
    let folder = folder();
    folder.run("synth swatch.lib.json --as pattern -o px.svg --seed 1").succeeds();
    let tile = text(&folder, "px.svg");
    assert!(tile.contains(r#"width="40" height="40" viewBox="0 0 40 40""#), "{tile}");
    assert!(tile.contains(r#"<pattern id="texture" patternUnits="userSpaceOnUse" width="40" height="40""#));
    assert!(!tile.contains("<symbol") && !tile.contains("clip-path") && tile.contains("<use"));
    let tile_uses = tile.matches("<use").count();
    folder.run("synth swatch.lib.json --as pattern --size 15mm -o mm.svg --seed 1").succeeds();
    let tile = text(&folder, "mm.svg");
    assert!(tile.contains(r#"width="15mm" height="15mm" viewBox="0 0 40 40""#), "{tile}");
    // A scene that repeats can be written as a tile later, another cannot.
    folder.run("synth swatch.lib.json --as pattern -o a.scene.json --seed 1").succeeds();
    folder.run("render a.scene.json --as pattern -o again.svg").succeeds();
    let again = text(&folder, "again.svg");
    assert!(again.contains("<pattern id=") && again.matches("<use").count() == tile_uses, "{again}");
    folder.run("synth swatch.lib.json --size 40 -o b.scene.json").succeeds();
    folder.run("render b.scene.json --as pattern -o c.svg").fails(1, "--tile");
    folder.run("synth swatch.lib.json --as pattern --tile=x -o c.svg").fails(2, "--as pattern needs");
    folder
        .run("texture photo.png --as pattern --size 60 -o c.svg --quiet --seed 1")
        .fails(1, "a tile for fills has no masks and clip paths");
    assert!(!folder.names().iter().any(|name| name == "c.svg"));
}
