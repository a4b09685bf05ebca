"""Writes the networks of tests/networks: graphs with the very signatures of Segment Anything's exports,
and so little in them that their masks can be computed by hand.

    python tools/sam/make_test_networks.py     (needs the packages onnx and numpy)

Encoders average each cell of 16 x 16 pixels. Decoders give, at each point of the square of 1024 px,

    min(radius^2 - squared distance to the prompt, 100 * red)

where red is the normalised red of the cell; masks 1 to 3 have radii of 60, 120 and 240 px and predicted
intersections over union of .7, .8 and 1.25. Mask 0, where there is one, is everywhere -1.
"""

import pathlib

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

FOLDER = pathlib.Path(__file__).parents[2] / "tests" / "networks"
MEAN = np.array([123.675, 116.28, 103.53], np.float32)
DEVIATION = np.array([58.395, 57.12, 57.375], np.float32)
RADII = np.array([60.0, 120.0, 240.0], np.float32)
SCORES = np.array([0.7, 0.8, 1.25], np.float32)
FLOAT, INT64 = TensorProto.FLOAT, TensorProto.INT64


class Graph:
    """Nodes and constants, named as they come."""

    def __init__(self):
        self.nodes, self.constants, self.count = [], [], 0

    def name(self):
        self.count += 1
        return f"v{self.count}"

    def constant(self, values, kind=np.float32):
        name = self.name()
        self.constants.append(numpy_helper.from_array(np.array(values, kind), name))
        return name

    def add(self, operator, *inputs, output=None, **attributes):
        inputs = [i if isinstance(i, str) else self.constant(i) for i in inputs]
        output = output or self.name()
        self.nodes.append(helper.make_node(operator, inputs, [output], **attributes))
        return output

    def ints(self, *values):
        return self.constant(values, np.int64)

    def write(self, file, inputs, outputs):
        info = lambda ports: [helper.make_tensor_value_info(n, k, s) for n, k, s in ports]
        graph = helper.make_graph(self.nodes, file, info(inputs), info(outputs), self.constants)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
        onnx.checker.check_model(model, full_check=True)
        onnx.save(model, FOLDER / f"{file}.onnx")


def normalised(g, image, shape, mean=MEAN, deviation=DEVIATION):
    image = g.add("Sub", image, mean.reshape(shape))
    return g.add("Div", image, deviation.reshape(shape))


def filled_up(g, image):
    """Zeros at the right and below, up to 1024 x 1024."""
    size = g.add("Slice", g.add("Shape", image), g.ints(2), g.ints(4))
    rest = g.add("Sub", g.ints(1024, 1024), size)
    pads = g.add("Concat", g.ints(0, 0, 0, 0, 0, 0), rest, axis=0)
    return g.add("Pad", image, pads, np.float32(0))


def cells(g, image, side, channels, output=None):
    """Mean of each cell of side x side pixels, and empty channels."""
    means = g.add("AveragePool", image, kernel_shape=[side, side], strides=[side, side])
    pads = g.ints(0, 0, 0, 0, 0, channels - 3, 0, 0)
    return g.add("Pad", means, pads, np.float32(0), output=output)


def masks(g, embedding, points, count, single=False):
    """Masks [n, k, 256, 256] of points [n, 2] in pixels of the square, 0 at its border. The embedding has
    64 or 256 cells along each side."""
    red = g.add("Slice", embedding, g.ints(0), g.ints(1), g.ints(1))
    red = g.add("Mul", red, np.float32(100))
    if count == 64:
        red = g.add("Resize", red, "", g.constant([1, 1, 4, 4]), mode="nearest", nearest_mode="floor",
                    coordinate_transformation_mode="asymmetric")
    place = np.float32((np.arange(256) + 0.5) * 4)
    x = g.add("Slice", points, g.ints(0), g.ints(1), g.ints(1))
    y = g.add("Slice", points, g.ints(1), g.ints(2), g.ints(1))
    column = g.ints(-1, 1, 1, 1)
    away = lambda p, shape: g.add("Sub", place.reshape(shape), g.add("Reshape", p, column))
    squares = [g.add("Mul", d, d) for d in (away(x, (1, 1, 1, 256)), away(y, (1, 1, 256, 1)))]
    disc = g.add("Sub", (RADII**2).reshape(1, 3, 1, 1), g.add("Add", *squares))
    found = g.add("Min", disc, red)
    if single:
        first = g.add("Slice", found, g.ints(0), g.ints(1), g.ints(1))
        first = g.add("Sub", g.add("Mul", first, np.float32(0)), np.float32(1))
        found = g.add("Concat", first, found, axis=1)
    return found


def first_of(g, points, axis):
    """The first point of each prompt, without the axis of points; 0 at the border of the square."""
    first = g.add("Gather", points, g.constant(0, np.int64), axis=axis)
    return g.add("Add", first, np.float32(0.5))


def scores(g, like, values, output, shape):
    """The same scores for each of the prompts, counted by the first axis of `like`."""
    count = g.add("Slice", g.add("Shape", like), g.ints(0), g.ints(1))
    wide = g.add("Concat", count, g.ints(len(values)), axis=0)
    found = g.add("Expand", np.array([values], np.float32), wide)
    return g.add("Reshape", found, g.ints(*shape), output=output)


def sam():
    embedding = ("image_embeddings", FLOAT, [1, 256, 64, 64])
    g = Graph()
    cells(g, "x", 16, 256, "image_embeddings")
    g.write("sam_encoder", [("x", FLOAT, [1, 3, 1024, 1024])], [embedding])

    g = Graph()
    image = normalised(g, "input_image", (1, 1, 3))
    image = g.add("Unsqueeze", g.add("Transpose", image, perm=[2, 0, 1]), g.ints(0))
    cells(g, filled_up(g, image), 16, 256, "image_embeddings")
    g.write("sam_encoder_rows", [("input_image", FLOAT, ["image_height", "image_width", 3])], [embedding])

    g = Graph()
    image = normalised(g, "images", (1, 3, 1, 1))
    cells(g, filled_up(g, image), 16, 256, "image_embeddings")
    g.write("sam_encoder_bytes", [("images", FLOAT, [1, 3, "height", "width"])], [embedding])

    for multiple in (True, False):
        g = Graph()
        points = first_of(g, "point_coords", 1)
        found = masks(g, "image_embeddings", points, 64, single=multiple)
        if not multiple:
            found = g.add("Slice", found, g.ints(1), g.ints(2), g.ints(1))
        low = g.add("Identity", found, output="low_res_masks") if multiple else found
        # Scaled to the square, without its empty part, scaled to the image.
        lead = g.add("Slice", g.add("Shape", low), g.ints(0), g.ints(2))
        to = lambda of, size, **output: g.add(
            "Resize", of, "", "", g.add("Concat", lead, size, axis=0), mode="linear", **output
        )
        longest = g.add("ReduceMax", "orig_im_size", keepdims=1)
        used = g.add("Div", g.add("Mul", "orig_im_size", np.float32(1024)), longest)
        used = g.add("Cast", g.add("Floor", g.add("Add", used, np.float32(0.5))), to=INT64)
        square = g.add("Slice", to(low, g.ints(1024, 1024)), g.ints(0, 0), used, g.ints(2, 3))
        to(square, g.add("Cast", "orig_im_size", to=INT64), output="masks")
        values = [0.1, *SCORES] if multiple else [0.8]
        scores(g, points, values, "iou_predictions", (-1, len(values)))
        # Both kinds of mask input take part, as in the export.
        for unused in ("mask_input", "has_mask_input", "point_labels"):
            g.add("Identity", unused)
        inputs = [
            embedding,
            ("point_coords", FLOAT, [1, "num_points", 2]),
            ("point_labels", FLOAT, [1, "num_points"]),
            ("mask_input", FLOAT, [1, 1, 256, 256]),
            ("has_mask_input", FLOAT, [1]),
            ("orig_im_size", FLOAT, [2]),
        ]
        outputs = [
            ("masks", FLOAT, [None] * 4),
            ("iou_predictions", FLOAT, [None] * 2),
            ("low_res_masks", FLOAT, [None] * 4),
        ][: 3 if multiple else 2]
        g.write("sam_decoder" if multiple else "sam_decoder_single", inputs, outputs)


def optimum():
    embedding = ("image_embeddings", FLOAT, ["batch_size", 256, 64, 64])
    position = ("image_positional_embeddings", FLOAT, ["batch_size", 256, 64, 64])
    g = Graph()
    found = cells(g, "pixel_values", 16, 256, "image_embeddings")
    g.add("Mul", found, np.float32(0), output="image_positional_embeddings")
    g.write("optimum_encoder", [("pixel_values", FLOAT, ["batch_size", 3, 1024, 1024])], [embedding, position])

    g = Graph()
    points = g.add("Reshape", first_of(g, "input_points", 2), g.ints(-1, 2))
    both = g.add("Add", "image_embeddings", "image_positional_embeddings")
    found = masks(g, both, points, 64)
    g.add("Unsqueeze", found, g.ints(0), output="pred_masks")
    g.add("Identity", "input_labels")
    scores(g, points, SCORES, "iou_scores", (1, -1, 3))
    inputs = [
        ("input_points", FLOAT, ["batch_size", "point_batch_size", "nb_points_per_image", 2]),
        ("input_labels", INT64, ["batch_size", "point_batch_size", "nb_points_per_image"]),
        embedding,
        position,
    ]
    g.write("optimum_decoder", inputs, [("iou_scores", FLOAT, [None] * 3), ("pred_masks", FLOAT, [None] * 5)])


def efficient():
    mean, deviation = MEAN / 255, DEVIATION / 255
    image = ("batched_images", FLOAT, ["batch", 3, "height", "width"])
    embedding = ("image_embeddings", FLOAT, ["batch", 256, 64, 64])
    prompts = [
        ("batched_point_coords", FLOAT, [1, "num_points", 1, 2]),
        ("batched_point_labels", FLOAT, [1, "num_points", 1]),
    ]
    outputs = [("output_masks", FLOAT, [None] * 5), ("iou_predictions", FLOAT, [None] * 3)]

    def embedded(g, output=None):
        sizes = g.ints(1, 3, 1024, 1024)
        image = g.add("Resize", "batched_images", "", "", sizes, mode="linear")
        return cells(g, normalised(g, image, (1, 3, 1, 1), mean, deviation), 16, 256, output)

    def decoded(g, embedding, size):
        """Size is height and width as integers: points are counted in it, masks are scaled to it."""
        width_height = g.add("Gather", g.add("Cast", size, to=FLOAT), g.ints(1, 0))
        points = g.add("Gather", "batched_point_coords", g.constant(0, np.int64), axis=2)
        points = g.add("Div", g.add("Mul", points, np.float32(1024)), width_height)
        points = g.add("Reshape", g.add("Add", points, np.float32(0.5)), g.ints(-1, 2))
        found = masks(g, embedding, points, 64)
        sizes = g.add("Concat", g.add("Slice", g.add("Shape", found), g.ints(0), g.ints(2)), size, axis=0)
        g.add("Unsqueeze", g.add("Resize", found, "", "", sizes, mode="linear"), g.ints(0), output="output_masks")
        scores(g, points, SCORES, "iou_predictions", (1, -1, 3))
        g.add("Identity", "batched_point_labels")

    g = Graph()
    embedded(g, "image_embeddings")
    g.write("efficient_encoder", [image], [embedding])
    g = Graph()
    decoded(g, "image_embeddings", "orig_im_size")
    g.write("efficient_decoder", [embedding, *prompts, ("orig_im_size", INT64, [2])], outputs)
    g = Graph()
    size = g.add("Slice", g.add("Shape", "batched_images"), g.ints(2), g.ints(4))
    decoded(g, embedded(g), size)
    g.write("efficient_both", [image, *prompts], outputs)


def sam2():
    features = [
        ("high_res_feats_0", FLOAT, [1, 32, 256, 256]),
        ("high_res_feats_1", FLOAT, [1, 64, 128, 128]),
        ("image_embed", FLOAT, [1, 256, 64, 64]),
    ]
    g = Graph()
    for (name, _, (_, channels, side, _)) in features:
        cells(g, "image", 1024 // side, channels, name)
    g.write("sam2_encoder", [("image", FLOAT, [1, 3, 1024, 1024])], features)

    # One that takes many prompts, and one whose axis for them is free but does not work.
    for works in (True, False):
        g = Graph()
        points = first_of(g, "point_coords", 1)
        if not works:
            points = g.add("Slice", points, g.ints(0), g.ints(1), g.ints(0))
        # All three features matter, and those not used for masks cancel out.
        mean = lambda of: g.add("ReduceMean", g.add("Slice", of, g.ints(0), g.ints(1), g.ints(1)), keepdims=1)
        odd = g.add("Sub", mean("high_res_feats_1"), mean("image_embed"))
        found = masks(g, g.add("Add", "high_res_feats_0", odd), points, 256)
        g.add("Identity", found, output="masks")
        scores(g, points, SCORES, "iou_predictions", (-1, 3))
        for unused in ("mask_input", "has_mask_input", "point_labels"):
            g.add("Identity", unused)
        inputs = [
            features[2],
            *features[:2],
            ("point_coords", FLOAT, ["num_labels", "num_points", 2]),
            ("point_labels", FLOAT, ["num_labels", "num_points"]),
            ("mask_input", FLOAT, ["num_labels", 1, 256, 256]),
            ("has_mask_input", FLOAT, ["num_labels"]),
        ]
        outputs = [("masks", FLOAT, [None] * 4), ("iou_predictions", FLOAT, [None] * 2)]
        g.write("sam2_decoder" if works else "sam2_decoder_alone", inputs, outputs)


def plain():
    """A network that is no part of Segment Anything: a matrix product, and how many elements it has."""
    g = Graph()
    g.add("MatMul", "a", "b", output="product")
    g.add("Size", "product", output="elements")
    inputs = [("a", FLOAT, ["rows", 300]), ("b", FLOAT, [300, "columns"])]
    g.write("product", inputs, [("product", FLOAT, ["rows", "columns"]), ("elements", INT64, [])])


FOLDER.mkdir(exist_ok=True)
for write in (sam, optimum, efficient, sam2, plain):
    write()
