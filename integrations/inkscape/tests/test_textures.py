# ruff: noqa: D103, RUF100
"""Tests of whole runs: a document, vtex, and the picture that Inkscape draws of the result."""

from __future__ import annotations

import stat
import sys
import time
from pathlib import Path

import inkex
import numpy
import pytest
from lxml import etree
from vtex_boxes import reference, tag
from vtex_extension import textures
from vtex_fill import Fill
from vtex_recolour import Recolour
from vtex_repaint import find_categories
from vtex_swatch import Swatch
from vtex_texture import CATEGORY, LABEL, SVG, URL, TextureLayer, read_texture

MM_PAGE = 'width="100mm" height="80mm" viewBox="0 0 100 80"'
RECTANGLE = '<rect id="r" x="10" y="20" width="40" height="30" fill="#d0d0d0"/>'
DRAFT = ["--quality", "draft"]


def document(path: Path, content: str, page: str = MM_PAGE) -> Path:
    spaces = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    path.write_text(
        f'<svg id="document" {spaces} xmlns:inkscape="{inkex.NSS["inkscape"]}" {page}>{content}</svg>', "utf-8"
    )
    return path


def run(extension: type, source: Path, ids: str, *options: str) -> tuple[Path, inkex.SvgDocumentElement]:
    result = source.with_name(f"{source.stem}-{extension.__name__.lower()}.svg")
    chosen = [word for name in ids.split() for word in ("--id", name)]
    extension().run([*chosen, *options, str(source)], output=str(result))
    return result, inkex.load_svg(str(result)).getroot()


def fill(source: Path, ids: str, photograph: Path, *options: str) -> tuple[Path, inkex.SvgDocumentElement]:
    return run(Fill, source, ids, "--source", str(photograph), *DRAFT, *options)


def plain(root: etree._Element, path: Path, group: bool, merge: bool = False) -> Path:
    """Write a texture as a document of its own."""
    made = TextureLayer(root, "vtex1", group, merge)
    svg = etree.Element(f"{SVG}svg", {name: root.get(name) for name in ("width", "height", "viewBox")}, root.nsmap)
    definitions = etree.SubElement(svg, f"{SVG}defs")
    definitions.extend(made.definitions)
    svg.append(made.layer)
    etree.ElementTree(svg).write(str(path))
    return path


def check_document(svg: etree._Element) -> None:
    """All ids are unique, all references have a target, and nothing of vtex's own classes remains."""
    ids = [element.attrib["id"] for element in svg.iter() if tag(element) and "id" in element.attrib]
    assert len(ids) == len(set(ids))
    for element in svg.iter():
        if tag(element):
            names = [name for value in element.attrib.values() for name in URL.findall(value)]
            names += [reference(element)] if tag(element) == "use" else []
            assert set(names) <= set(ids)
            assert "category-" not in element.attrib.get("class", "")


@pytest.mark.parametrize("shading", ["flat", "gradient", "soft"])
def test_groups_do_not_change_the_picture(texture, render, tmp_path: Path, shading: str) -> None:
    source = texture("--shading", shading)
    original = render(source)
    for group, merge in ((False, False), (True, False), (True, True)):
        path = plain(read_texture(source), tmp_path / f"{group}{merge}.svg", group, merge)
        difference = numpy.abs(render(path) - original)
        # Merged neighbours may differ by a shade at their smooth borders.
        assert difference.mean() < (0.15 if merge else 0.01)
        assert (difference.max(axis=2) > 12).mean() < 0.001


def test_groups_are_small_and_named(texture, tmp_path: Path) -> None:
    source = texture("--shading", "flat")
    svg = etree.parse(str(plain(read_texture(source), tmp_path / "grouped.svg", True))).getroot()
    check_document(svg)
    layer = svg[-1]
    groups = [
        group for group in layer.iter(f"{SVG}g") if group.get(LABEL) and group.get(CATEGORY) not in (None, "small")
    ]
    assert layer.get(LABEL) is None and layer[0].get(LABEL) == "Background"
    assert layer[1].get(LABEL) == "Small elements"
    # Names as in the SVG of vtex, where each element has the name of its category and a number.
    names = {
        g.get(LABEL).rpartition(" ")[0]
        for g in read_texture(source).iter(f"{SVG}g")
        if "category-" in g.get("class", "")
    }
    found = {group.get(LABEL).partition(" (")[0] for group in layer[2:]}
    assert names and found == names
    assert groups and max(len(group) for group in layer.iter(f"{SVG}g")) <= 200


def test_merging_makes_fewer_objects(texture) -> None:
    source = texture("--shading", "flat")
    counts = []
    for merge in (False, True):
        made = TextureLayer(read_texture(source), "a", True, merge).layer
        small = next(group for group in made if group.get(LABEL) == "Small elements")
        counts.append(sum(len(group) for group in small))
    assert counts[1] < 0.75 * counts[0]


def test_a_clone_takes_another_colour(texture, render, tmp_path: Path) -> None:
    path = plain(read_texture(texture("--shading", "flat")), tmp_path / "clones.svg", True)
    before = render(path)
    tree = etree.parse(str(path))
    uses = list(tree.getroot()[-1].iter(f"{SVG}use"))
    # Elements drawn once have several shapes; the main one takes the fill of its clone.
    drawn = {element.get("id") for element in tree.getroot()[0] if tag(element) == "g" and len(element) > 1}
    assert any(reference(use) in drawn for use in uses)
    assert all(use.get("fill", "").startswith("#") for use in uses)
    for use in uses:
        use.set("fill", "#ff00ff")
    tree.write(str(path))
    pink = (numpy.abs(render(path) - (255, 0, 255)).max(axis=2) < 8).mean()
    assert pink > 0.001 and (numpy.abs(before - (255, 0, 255)).max(axis=2) < 8).mean() == 0


@pytest.mark.parametrize(
    "page, content, expected",
    [
        (MM_PAGE, RECTANGLE, (10, 20, 50, 50)),
        (
            'width="378" height="302"',
            '<rect id="r" x="37.8" y="75.6" width="151.18" height="113.39"/>',
            (37.8, 75.6, 188.98, 188.99),
        ),
        (MM_PAGE, f'<g transform="translate(5,1) scale(2)">{RECTANGLE}</g>', (25, 41, 105, 101)),
        (
            'width="4in" height="4in" viewBox="-2 -2 4 4"',
            '<path id="r" d="M-1-1h1.5v1z" transform="rotate(180)"/>',
            (-0.5, 0, 1, 1),
        ),
    ],
)
def test_the_texture_has_the_size_of_the_shape(
    vtex: str, photograph: Path, tmp_path: Path, page: str, content: str, expected: tuple[float, ...]
) -> None:
    _, svg = fill(document(tmp_path / "a.svg", content, page), "r", photograph)
    check_document(svg)
    (layer,) = textures(svg)
    clip = svg.getElementById(URL.match(layer.get("clip-path"))[1])
    box = inkex.Path(clip[0].get("d")).transform(layer.composed_transform()).bounding_box()
    # Coordinates have one decimal of a pixel.
    slack = 0.12 * svg.unittouu("1px")
    assert (box.left, box.top, box.right, box.bottom) == pytest.approx(expected, abs=slack)


def test_the_scale_sets_the_size_of_elements(vtex: str, photograph: Path, tmp_path: Path) -> None:
    source = document(tmp_path / "a.svg", RECTANGLE)
    scales = []
    for percent in ("100", "50"):
        _, svg = fill(source, "r", photograph, "--scale", percent)
        scales.append(textures(svg)[0].transform.a)
    # One pixel is 25.4 / 96 mm.
    assert scales == pytest.approx([25.4 / 96, 25.4 / 192], rel=1e-4)


def test_shapes_of_all_kinds(vtex: str, photograph: Path, render, tmp_path: Path) -> None:
    content = (
        '<g id="layer" inkscape:groupmode="layer" transform="translate(3,3)">'
        '<ellipse id="e" cx="15" cy="15" rx="12" ry="8" fill="#00f" transform="rotate(10)"/>'
        '<g id="g" fill="#00f"><rect x="35" y="5" width="10" height="10"/><circle cx="55" cy="10" r="5"/></g>'
        '<use id="u" xlink:href="#e" x="5" y="20"/>'
        '<path id="hole" fill-rule="evenodd" fill="#00f" d="M50 30h30v30h-30zM60 40h10v10h-10z"/>'
        '<text id="t" x="5" y="70" font-size="20" font-family="DejaVu Sans" fill="#00f">ab</text></g>'
    )
    source = document(tmp_path / "a.svg", content)
    result, svg = fill(source, "e g u hole t", photograph)
    check_document(svg)
    assert len(textures(svg)) == 5
    layer = svg.getElementById("layer")
    order = [child.get("id") if not child.get("data-vtex-texture") else "texture" for child in layer]
    assert order == ["e", "texture", "g", "texture", "u", "texture", "hole", "texture", "t", "texture"]
    blue = lambda picture: numpy.abs(picture - (0, 0, 255)).max(axis=2) < 60  # noqa: E731
    white = lambda picture: picture.min(axis=2) > 250  # noqa: E731
    before, after = render(source), render(result)
    assert blue(before).mean() > 0.1
    # The shapes are covered, but for smooth borders, and nothing else is.
    assert (blue(after) & blue(before)).mean() < 0.002
    assert (white(before) & ~white(after)).mean() < 0.005


def test_shapes_together_share_one_texture(vtex: str, photograph: Path, tmp_path: Path) -> None:
    content = RECTANGLE + '<circle id="c" cx="80" cy="40" r="10"/>'
    _, svg = fill(document(tmp_path / "a.svg", content), "r c", photograph, "--together", "true")
    (layer,) = textures(svg)
    assert layer.getprevious().get("id") == "c"


def test_a_second_texture_replaces_the_first(vtex: str, photograph: Path, tmp_path: Path) -> None:
    first, _ = fill(document(tmp_path / "a.svg", RECTANGLE), "r", photograph)
    _, svg = fill(first, "r", photograph, "--seed", "5")
    assert len(textures(svg)) == 1
    assert len(textures(fill(first, "r", photograph, "--replace", "false")[1])) == 2
    check_document(svg)
    kept = {element.get("id").partition("-")[0] for element in svg.defs}
    assert kept == {textures(svg)[0].get("data-vtex-texture")}


def test_styles_of_the_document_do_not_change_the_texture(vtex: str, photograph: Path, render, tmp_path: Path) -> None:
    pictures = []
    for number, style in enumerate(("", "<style>path,use{fill:red;stroke:blue} .category-1{opacity:0}</style>")):
        result, _ = fill(document(tmp_path / f"{number}.svg", style + RECTANGLE), "r", photograph)
        pictures.append(render(result))
    assert numpy.abs(pictures[0] - pictures[1]).mean() < 0.01


def test_a_category_gets_a_colour_and_the_others_stay(vtex: str, photograph: Path, tmp_path: Path) -> None:
    filled, svg = fill(document(tmp_path / "a.svg", RECTANGLE), "r", photograph, "--shading", "gradient")
    before = find_categories(svg, textures(svg))
    key = next(key for key in before if key.isdigit())
    options = ["--tab", "category", "--category", before[key].name.upper(), "--colour", "#2050c0", "--keep", "false"]
    _, svg = run(Recolour, filled, "r", *options)
    check_document(svg)
    after = find_categories(svg, textures(svg))
    assert set(after) == set(before)
    target = inkex.Color("#2050c0").to_rgb()
    from vtex_colour import from_lab

    changed = inkex.Color(from_lab(after[key].main)).to_rgb()
    assert max(abs(one - other) for one, other in zip(changed, target, strict=True)) < 40
    for other in set(before) - {key}:
        assert after[other].main == pytest.approx(before[other].main, abs=1e-6)
    # What nothing uses any more is gone.
    used = {name for element in svg.iter() if tag(element) for v in element.attrib.values() for name in URL.findall(v)}
    gradients = {element.get("id") for element in svg.defs if tag(element).endswith("Gradient")}
    assert gradients <= used


def test_only_the_selected_objects_change(vtex: str, photograph: Path, tmp_path: Path) -> None:
    filled, svg = fill(document(tmp_path / "a.svg", RECTANGLE), "r", photograph)
    group = next(group for group in textures(svg)[0] if (group.get(CATEGORY) or "").isdigit())
    group.set("id", "chosen")
    etree.ElementTree(svg).write(str(filled))
    options = ["--tab", "category", "--category", group.get(CATEGORY), "--colour", "#00ff00", "--only", "true"]
    _, changed = run(Recolour, filled, "chosen", *options)
    check_document(changed)

    def shape(root: etree._Element, name: str) -> bytes:
        return etree.tostring(root.getElementById(name))

    assert shape(changed, "chosen") != shape(svg, "chosen")
    before, after = find_categories(svg, [svg]), find_categories(changed, [changed])
    assert after["background"].main == before["background"].main


def test_a_palette_reaches_all_categories(vtex: str, photograph: Path, tmp_path: Path, capsys) -> None:
    filled, svg = fill(document(tmp_path / "a.svg", RECTANGLE), "r", photograph)
    palette = tmp_path / "sea.gpl"
    palette.write_text("GIMP Palette\nName: sea\n#\n 29  53  87 deep\n168 218 220 light\n", "utf-8")
    _, changed = run(Recolour, filled, "r", "--tab", "palette", "--palette_file", str(palette), "--keep", "false")
    mains = [entry.main for entry in find_categories(changed, textures(changed)).values()]
    # Both colours are blue: all main colours moved from red towards blue.
    assert all(main[2] < 0.005 for main in mains)
    assert any(entry.main[2] > 0.01 for entry in find_categories(svg, textures(svg)).values())
    run(Recolour, filled, "r", "--tab", "list")
    assert "Categories: number, name, colour" in capsys.readouterr().err


def test_an_svg_of_vtex_can_be_recoloured(texture, tmp_path: Path, render) -> None:
    source = tmp_path / "opened.svg"
    source.write_bytes(texture("--shading", "soft").read_bytes())
    options = ["--tab", "category", "--category", "background", "--colour", "#00ff00"]
    result, _ = run(Recolour, source, "", *options)
    difference = numpy.abs(render(result) - render(source)).max(axis=2)
    assert 0.05 < (difference > 20).mean() < 0.95


SWATCH = (
    '<rect id="page" x="5" y="5" width="30" height="30" fill="#fdf3d8"/>'
    '<path id="a" class="leaf" d="M8 10q5-4 10 4q-6 4-10-4z"/>'
    '<use id="b" xlink:href="#a" transform="translate(12,12)"/>'
    '<circle id="c" cx="28" cy="12" r="3" fill="url(#fade)"/><text id="t" x="10" y="30" font-size="8">x</text>'
)
SWATCH_STYLE = (
    "<style>.leaf{fill:#2f7d32}</style>"
    '<defs><linearGradient id="fade"><stop stop-color="#f00"/>'
    '<stop offset="1" stop-color="#fa0"/></linearGradient></defs>'
)


def test_a_swatch_becomes_a_texture_beside_it(vtex: str, tmp_path: Path, render) -> None:
    source = document(tmp_path / "a.svg", SWATCH_STYLE + SWATCH, 'width="150mm" height="100mm" viewBox="0 0 150 100"')
    result, svg = run(Swatch, source, "page a b c t", "--page", "lowest")
    check_document(svg)
    (layer,) = textures(svg)
    picture = render(result, 1500)
    # Beside the swatch, three times as wide and high: from 38 mm to 128 mm, 10 pixels each.
    inside, outside = picture[60:940, 390:1270], picture[:, 1295:]
    assert (numpy.abs(inside - (0xFD, 0xF3, 0xD8)).max(axis=2) < 12).mean() > 0.5
    assert (numpy.abs(inside - (0x2F, 0x7D, 0x32)).max(axis=2) < 12).mean() > 0.01
    assert outside.min() > 250
    assert float(layer.transform.a) == pytest.approx(25.4 / 96, rel=0.01)


def test_a_swatch_fills_a_shape_and_the_page(vtex: str, tmp_path: Path) -> None:
    content = SWATCH_STYLE + SWATCH + '<ellipse id="s" cx="70" cy="50" rx="25" ry="20"/>'
    source = document(tmp_path / "a.svg", content)
    _, svg = run(Swatch, source, "page a b c s", "--page", "lowest", "--place", "shape")
    assert textures(svg)[0].getprevious().get("id") == "s"
    _, svg = run(Swatch, source, "page a b c", "--page", "lowest", "--place", "page")
    assert textures(svg)[0].getnext().get("id") == "page"
    check_document(svg)


def stopped(capsys, extension: type, *arguments: object) -> str:
    with pytest.raises(SystemExit):
        run(extension, *arguments)
    return capsys.readouterr().err


def test_messages(vtex: str, photograph: Path, tmp_path: Path, capsys, monkeypatch) -> None:
    source = document(tmp_path / "a.svg", RECTANGLE + '<image id="i" width="5" height="5"/><path id="p" d="M0 0h5"/>')
    photo = ["--source", str(photograph)]
    assert "Select the shape" in stopped(capsys, Fill, source, "", *photo)
    assert "Choose what the texture" in stopped(capsys, Fill, source, "r")
    assert "is not a file" in stopped(capsys, Fill, source, "r", "--source", "/no/photo.jpg")
    assert "hint: draw a rectangle" in stopped(capsys, Fill, source, "i", *photo)
    assert "no area" in stopped(capsys, Fill, source, "p", *photo)
    assert "raise the scale" in stopped(capsys, Fill, source, "r", *photo, "--scale", "0.01", *DRAFT)
    broken = tmp_path / "broken.png"
    broken.write_text("no picture")
    message = stopped(capsys, Fill, source, "r", "--source", str(broken))
    assert "broken.png" in message and "error:" in message and "Traceback" not in message
    assert "no texture" in stopped(capsys, Recolour, source, "r")
    monkeypatch.setenv("VTEX", "")
    monkeypatch.setenv("PATH", "")
    monkeypatch.setenv("HOME", str(tmp_path))
    if not Path("/usr/local/bin/vtex").exists():
        assert "was not found" in stopped(capsys, Fill, source, "r", *photo)
    assert "/no/vtex" in stopped(capsys, Fill, source, "r", *photo, "--program", "/no/vtex")


def script(path: Path, content: str) -> str:
    path.write_text(f"#!{sys.executable}\n{content}\n", "utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script with #!")
def test_a_program_that_hangs_is_stopped(photograph: Path, tmp_path: Path, capsys) -> None:
    program = script(tmp_path / "slow", "import time; time.sleep(60)")
    start = time.monotonic()
    options = ["--source", str(photograph), "--program", program, "--limit", "1"]
    message = stopped(capsys, Fill, document(tmp_path / "a.svg", RECTANGLE), "r", *options)
    assert "longer than 1 s" in message and time.monotonic() - start < 20


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script with #!")
def test_the_same_settings_start_no_program_again(vtex: str, photograph: Path, tmp_path: Path) -> None:
    log = tmp_path / "calls"
    program = script(
        tmp_path / "logged",
        f"import os, sys\nopen({str(log)!r}, 'a').write(sys.argv[1] + ' ')\n"
        f"os.execv({vtex!r}, [{vtex!r}, *sys.argv[1:]])",
    )
    source = document(tmp_path / "a.svg", RECTANGLE)
    results = []
    for seed in ("1", "1", "2"):
        result, _ = fill(source, "r", photograph, "--program", program, "--seed", seed)
        results.append(result.read_bytes())
    assert log.read_text().split() == ["analyze", "synth", "synth"]
    assert results[0] == results[1] != results[2]
    # Only the cache remains of the temporary files.
    assert not list(tmp_path.glob("vtex-[!i]*"))
