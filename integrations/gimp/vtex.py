#!/usr/bin/env python3
# Part of the plug-in of vtex for GIMP.
"""GIMP 3 plug-in: textures, filled holes and paths, made by the program vtex."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import gi

gi.require_version("Gimp", "3.0")
gi.require_version("GimpUi", "3.0")
from gi.repository import Gimp, GimpUi, Gio, GLib, GObject  # noqa: E402
from vtex_commands import (  # noqa: E402
    VtexError,
    find_program,
    hole_command,
    path_command,
    paths_svg,
    run,
    texture_command,
)

TEXTURE, HOLE, PATH = "vtex-texture", "vtex-fill-hole", "vtex-outline"
MENU = "<Image>/Filters/Texture (vtex)"
FLAGS = GObject.ParamFlags.READWRITE
LARGEST = 16384

Area = tuple[int, int, int, int]
"""Left, top, width and height of a part of the image."""


class Vtex(Gimp.PlugIn):
    """The three entries of the menu."""

    def do_query_procedures(self) -> list[str]:
        """Return the names of the procedures."""
        return [TEXTURE, HOLE, PATH]

    def do_set_i18n(self, name: str) -> bool:
        """Say that there are no translations."""
        return False

    def do_create_procedure(self, name: str) -> Gimp.Procedure:
        """Describe one procedure and its parameters."""
        label, text, work = {
            TEXTURE: ("_Make a texture...", "Make a texture of the layer or the selection", self.make_texture),
            HOLE: ("_Fill the selection like its surroundings...", "Make the selected part again", self.fill_hole),
            PATH: ("_Outline elements as a path...", "Find elements and outline them as a path", self.outline),
        }[name]
        procedure = Gimp.ImageProcedure.new(self, name, Gimp.PDBProcType.PLUGIN, self.run, work)
        procedure.set_image_types("*")
        procedure.set_sensitivity_mask(Gimp.ProcedureSensitivityMask.DRAWABLE)
        procedure.set_menu_label(label)
        procedure.add_menu_path(MENU)
        procedure.set_documentation(text, f"{text}, with the program vtex", name)
        procedure.set_attribution("vtex", "vtex", "2026")
        if name == TEXTURE:
            add_choice(procedure, "method", "_Made of", {"elements": "Elements", "pixels": "Pixels"})
            add_choice(procedure, "quality", "_Quality", {"default": "Default", "draft": "Draft", "fine": "Fine"})
            tiles = {"none": "No", "both": "In both directions", "x": "From left to right", "y": "From top to bottom"}
            add_choice(procedure, "tile", "Repeat without a sea_m", tiles)
            for side in ("width", "height"):
                text = f"{side.capitalize()} in pixels; 0: twice that of the layer or selection"
                procedure.add_int_argument(side, f"_{side.capitalize()}", text, 0, LARGEST, 0, FLAGS)
            procedure.add_boolean_argument("new-image", "As a new _image", "Otherwise, as a layer", True, FLAGS)
        if name == PATH:
            procedure.add_int_argument("smallest", "_Smallest element", "Area in pixels", 1, 1000000, 30, FLAGS)
            procedure.add_boolean_argument("merge", "_One path", "Otherwise, a path for each shape", True, FLAGS)
        procedure.add_int_argument(
            "seed", "_Variant (seed)", "Another number gives another result", 0, 2**31 - 1, 1, FLAGS
        )
        text = "Path of the program; empty: the one in VTEX, in PATH or in a usual folder"
        procedure.add_string_argument("program", "_Program", text, "", FLAGS)
        procedure.add_int_argument("limit", "_Time limit (s)", "The program may take this long", 5, 3600, 300, FLAGS)
        return procedure

    def run(self, procedure, run_mode, image, drawables, config, work):
        """Show the dialog if wanted, and work in one step of undo."""
        if len(drawables) != 1:
            return failed(procedure, "Select exactly one layer.", Gimp.PDBStatusType.CALLING_ERROR)
        self.interactive = run_mode == Gimp.RunMode.INTERACTIVE
        if self.interactive:
            GimpUi.init("vtex")
            dialog = GimpUi.ProcedureDialog.new(procedure, config, "vtex")
            dialog.fill(None)
            accepted = dialog.run()
            dialog.destroy()
            if not accepted:
                return procedure.new_return_values(Gimp.PDBStatusType.CANCEL, GLib.Error())
        Gimp.progress_init("vtex")
        image.undo_group_start()
        try:
            with tempfile.TemporaryDirectory(prefix="vtex-") as folder:
                work(image, drawables[0], config, Path(folder))
        except VtexError as error:
            return failed(procedure, str(error), Gimp.PDBStatusType.EXECUTION_ERROR)
        finally:
            image.undo_group_end()
            Gimp.displays_flush()
        return procedure.new_return_values(Gimp.PDBStatusType.SUCCESS, GLib.Error())

    def make_texture(self, image, drawable, config, folder: Path) -> None:
        """Make a texture of the layer, or of the selected part of it."""
        area = selected_area(image, drawable)
        export(drawable, area, folder / "in.png", Gimp.ImageBaseType.RGB)
        names = ("method", "quality", "tile", "seed")
        settings = {name: config.get_property(name) for name in names}
        settings["width"] = config.get_property("width") or min(2 * area[2], LARGEST)
        settings["height"] = config.get_property("height") or min(2 * area[3], LARGEST)
        call(config, texture_command(str(folder / "in.png"), str(folder / "out.png"), settings))
        target = image
        if config.get_property("new-image"):
            target = Gimp.Image.new(settings["width"], settings["height"], Gimp.ImageBaseType.RGB)
            target.undo_disable()
        layer = load_layer(target, folder / "out.png", f"Texture of {drawable.get_name()}")
        if target is image:
            layer.set_offsets(area[0], area[1])
        else:
            target.undo_enable()
            if self.interactive:
                Gimp.Display.new(target)

    def fill_hole(self, image, drawable, config, folder: Path) -> None:
        """Make the selected part again, as a layer that shows only this part."""
        area = layer_area(drawable)
        if Gimp.Selection.is_empty(image):
            raise VtexError("Select the part to fill.")
        export(drawable, area, folder / "in.png", Gimp.ImageBaseType.RGB)
        export(image.get_selection(), area, folder / "hole.png", Gimp.ImageBaseType.GRAY)
        paths = (str(folder / name) for name in ("in.png", "hole.png", "out.png"))
        call(config, hole_command(*paths, config.get_property("seed")))
        layer = load_layer(image, folder / "out.png", f"{drawable.get_name()}, filled")
        layer.set_offsets(area[0], area[1])
        layer.add_mask(layer.create_mask(Gimp.AddMaskType.SELECTION))

    def outline(self, image, drawable, config, folder: Path) -> None:
        """Outline the elements that vtex finds in the layer, or in the selected part of it."""
        area = selected_area(image, drawable)
        export(drawable, area, folder / "in.png", Gimp.ImageBaseType.RGB)
        settings = {name: config.get_property(name) for name in ("smallest", "seed")}
        call(config, path_command(str(folder / "in.png"), str(folder / "out.svg"), settings))
        svg = (folder / "out.svg").read_text("utf-8")
        outlines = folder / "paths.svg"
        outlines.write_text(paths_svg(svg, area[:2], (image.get_width(), image.get_height())), "utf-8")
        file = Gio.File.new_for_path(str(outlines))
        done, paths = image.import_paths_from_file(file, config.get_property("merge"), False)
        if not done or not paths:
            raise VtexError("GIMP could not read the paths.")
        for path in paths:
            path.set_visible(True)


def add_choice(procedure, name: str, label: str, options: dict[str, str]) -> None:
    """Add a parameter with some values; the first is the default."""
    choice = Gimp.Choice.new()
    for number, (value, text) in enumerate(options.items()):
        choice.add(value, number, text, "")
    procedure.add_choice_argument(name, label, "", choice, next(iter(options)), FLAGS)


def failed(procedure, message: str, status):
    """Return an error, which GIMP shows."""
    return procedure.new_return_values(status, GLib.Error.new_literal(Gimp.PlugIn.error_quark(), message, 0))


def call(config, arguments: list[str]) -> None:
    """Run vtex with the program and the time limit of the dialog."""
    program = find_program(config.get_property("program") or "")
    run(program, arguments, config.get_property("limit"), Gimp.progress_pulse)


def layer_area(drawable) -> Area:
    """Return the part of the image that a layer covers."""
    _, x, y = drawable.get_offsets()
    return x, y, drawable.get_width(), drawable.get_height()


def selected_area(image, drawable) -> Area:
    """Return the selected part of the layer; without a selection, the whole layer."""
    left, top, width, height = layer_area(drawable)
    _, selected, x1, y1, x2, y2 = Gimp.Selection.bounds(image)
    if not selected:
        return left, top, width, height
    x1, y1 = max(x1, left), max(y1, top)
    x2, y2 = min(x2, left + width), min(y2, top + height)
    if x2 <= x1 or y2 <= y1:
        raise VtexError("The selection is outside the layer.")
    return x1, y1, x2 - x1, y2 - y1


def export(drawable, area: Area, path: Path, kind) -> None:
    """Write a part of a drawable as a PNG."""
    left, top, width, height = area
    copy = Gimp.Image.new(width, height, kind)
    try:
        layer = Gimp.Layer.new_from_drawable(drawable, copy)
        copy.insert_layer(layer, None, 0)
        _, x, y = drawable.get_offsets()
        layer.set_offsets(x - left, y - top)
        layer.set_visible(True)
        layer.set_opacity(100)
        layer.resize_to_image_size()
        if not Gimp.file_save(Gimp.RunMode.NONINTERACTIVE, copy, Gio.File.new_for_path(str(path)), None):
            raise VtexError("GIMP could not export the layer.")
    finally:
        copy.delete()


def load_layer(image, path: Path, name: str):
    """Add a picture as the topmost layer."""
    layer = Gimp.file_load_layer(Gimp.RunMode.NONINTERACTIVE, image, Gio.File.new_for_path(str(path)))
    if layer is None:
        raise VtexError("GIMP could not read the result of vtex.")
    layer.set_name(name)
    image.insert_layer(layer, None, 0)
    return layer


Gimp.main(Vtex.__gtype__, sys.argv)
