"""Runs inside GIMP 3: call the three procedures, and write what came back as JSON."""

import json
import os

import gi

gi.require_version("Gimp", "3.0")
from gi.repository import Gimp, Gio  # noqa: E402

FOLDER = os.environ["VTEX_TEST_FOLDER"]
PHOTOGRAPH = os.environ["VTEX_TEST_PHOTOGRAPH"]
report = {}


def call(name, image, **properties):
    """Run a procedure without a dialog; return its status and message."""
    procedure = Gimp.get_pdb().lookup_procedure(name)
    config = procedure.create_config()
    config.set_property("run-mode", Gimp.RunMode.NONINTERACTIVE)
    config.set_property("image", image)
    config.set_core_object_array("drawables", [image.get_layers()[-1]])
    for key, value in properties.items():
        config.set_property(key.replace("_", "-"), value)
    status = procedure.run(config).index(0)
    return int(status), Gimp.get_pdb().get_last_error()


def saved(image, name):
    """Write an image as a PNG."""
    Gimp.file_save(Gimp.RunMode.NONINTERACTIVE, image, Gio.File.new_for_path(f"{FOLDER}/{name}.png"), None)


def layers(image):
    """Describe the layers of an image, from top to bottom."""
    return [
        [layer.get_name(), *layer.get_offsets()[1:], layer.get_width(), layer.get_height(), bool(layer.get_mask())]
        for layer in image.get_layers()
    ]


image = Gimp.file_load(Gimp.RunMode.NONINTERACTIVE, Gio.File.new_for_path(PHOTOGRAPH))
report["size"] = [image.get_width(), image.get_height()]
before = {made.get_id() for made in Gimp.get_images()}
report["texture"] = call("vtex-texture", image, quality="draft", width=240, height=160, tile="both")
(made,) = [other for other in Gimp.get_images() if other.get_id() not in before]
report["texture image"] = [made.get_width(), made.get_height(), len(made.get_layers())]
saved(made, "texture")

image.select_rectangle(Gimp.ChannelOps.REPLACE, 20, 30, 100, 80)
report["layer"] = call("vtex-texture", image, method="pixels", width=120, height=90, new_image=False)
report["layer layers"] = layers(image)

image.select_ellipse(Gimp.ChannelOps.REPLACE, 60, 60, 40, 40)
saved(image, "before")
report["hole"] = call("vtex-fill-hole", image)
report["hole layers"] = layers(image)
image.get_layers()[1].set_visible(False)
saved(image, "hole")

Gimp.Selection.none(image)
report["no selection"] = call("vtex-fill-hole", image)
image.select_rectangle(Gimp.ChannelOps.REPLACE, 50, 40, 150, 150)
report["outline"] = call("vtex-outline", image, merge=True)
report["outline paths"] = [path.get_name() for path in image.get_paths()]
Gimp.Selection.none(image)
for path in image.get_paths():
    image.select_item(Gimp.ChannelOps.REPLACE, path)
report["outline bounds"] = list(Gimp.Selection.bounds(image))[1:]
report["missing program"] = call("vtex-outline", image, program="/no/vtex")

grey = Gimp.file_load(Gimp.RunMode.NONINTERACTIVE, Gio.File.new_for_path(PHOTOGRAPH))
grey.convert_indexed(Gimp.ConvertDitherType.NONE, Gimp.ConvertPaletteType.GENERATE, 32, False, False, "")
report["indexed"] = call("vtex-texture", grey, quality="draft", width=100, height=100, new_image=False)
report["indexed layers"] = layers(grey)
with open(f"{FOLDER}/report.json", "w") as stream:
    json.dump(report, stream)
