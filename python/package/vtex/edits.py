"""Edits of a scene: one class for each operation, for `Scene.edit`.

Edits are plain values. You can compare, print and pickle them, and apply them to any number of scenes. Lengths are in
pixels of the canvas. Angles are in degrees, clockwise on the screen. You can write and read ``color`` and ``colors``
for ``colour`` and ``colours``. All edits have two more parameters, which you give by name:

layer : str, optional
    Change only the elements of this layer. Give its name or its role: ``"primary"`` or ``"secondary"``, or
    ``"background"`` for edits of colours. Default: the elements of all layers.
where : str or sequence of str, default ()
    Change only the elements that meet all of these conditions: ``"category=3"`` (or ``3|5``, ``!=3``, or a name),
    ``"library=1"``, ``"id=17"``, ``"motif=4"``, ``"area>200"``, ``"elongation>1.5"``, ``"x<500"``, ``"y>=20"`` (with
    ``>``, ``<``, ``>=`` or ``<=``), ``"inside=shape.svg"``, ``"outside=mask.png"``. Default: no condition.

vtex stretches pictures over the canvas. A picture is a path, bytes, an open file, an image of Pillow or an array. A
grey array is height x width of uint8, or of floats from 0 to 1. A colour array is height x width x 3 or 4 of uint8.
"""

from __future__ import annotations

import inspect
import itertools
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import Field, dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeAlias, TypeGuard, Union

import numpy as np

from vtex import _inputs, _library, _spelling, _vtex
from vtex._errors import InputError, InputTypeError

#: Red, green and blue, 0 to 255; or ``"#rrggbb"``, ``"#rgb"`` or a CSS colour name.
Colour: TypeAlias = Union[str, tuple[int, int, int]]
Color: TypeAlias = Colour


class _Files:
    """The files that operations name, with their content."""

    def __init__(self) -> None:
        self.contents: dict[str, bytes] = {}

    def add(self, source: _inputs.Picture, role: str) -> str:
        named = _inputs.picture(source, role)
        if named is None:
            raise InputTypeError(f"{role} is None", "give a path, or what it holds")
        return self.put(named)

    def put(self, named: _inputs.Named) -> str:
        name, data = named
        # Different contents never share a name.
        while self.contents.get(name, data) != data:
            name = f"+{name}"
        self.contents[name] = data
        return name

    def number(self, value: float | _inputs.Picture | None, role: str) -> Any:
        if value is None or _inputs.is_number(value):
            return value
        return self.add(value, role)  # type: ignore[arg-type]


def _colour(value: object, role: str) -> str:
    if isinstance(value, str):
        text = _vtex.colour(value)
        if text is None:
            raise InputError(f"{role} = '{value[:24]}' is no colour", "colours are #rrggbb, #rgb or a name of CSS")
        return text
    try:
        parts = [_inputs.whole(role, part, 0, 255) for part in value]  # type: ignore[attr-defined]
    except TypeError:
        parts = []
    if len(parts) != 3:
        raise InputTypeError(f"{role} = {value!r} is no colour", "give '#rrggbb', a name of CSS, or (r, g, b)")
    return "#{:02x}{:02x}{:02x}".format(*parts)


def _colour_or_picture(value: Any, role: str, files: _Files) -> str:
    # Text is a colour if it names one, else the path of a picture.
    if isinstance(value, str):
        is_colour = _vtex.colour(value) is not None or not _inputs.names_file(value)
    else:
        is_colour = isinstance(value, (tuple, list))
    return _colour(value, role) if is_colour else files.add(value, role)


#: How a value is read, by the declared type of its field. The program checks ranges.
_READERS: dict[str, Callable[[Any, str, _Files], Any]] = {
    "bool": lambda value, role, files: bool(value),
    "int": lambda value, role, files: _inputs.whole(role, value, 0, 2**32 - 1),
    "Colour": lambda value, role, files: _colour(value, role),
    "Colour | _inputs.Picture": _colour_or_picture,
    "_inputs.Picture": lambda value, role, files: files.add(value, role),
    "float | _inputs.Picture": lambda value, role, files: files.number(value, role),
}


def _read(value: Any, field: Field[Any], files: _Files) -> Any:
    declared = str(field.type)
    if value is None and declared.endswith(" | None"):
        return None
    read = _READERS.get(declared.removesuffix(" | None"))
    return read(value, field.name, files) if read else value


_SHARED = """layer : str, optional
    Change only the elements of this layer, by its name or role. Default: the elements of all layers.
where : str or sequence of str, default ()
    Change only the elements that meet all of these conditions, such as ``"area>200"``. See `vtex.edits`. Default: no
    condition.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class Edit(metaclass=_spelling.Spelled):
    """Base class of all edits. Use one of its subclasses.

    Parameters
    ----------
    layer : str, optional
        Change only the elements of this layer, by its name or role. Default: the elements of all layers.
    where : str or sequence of str, default ()
        Change only the elements that meet all of these conditions. Default: no condition.
    """

    layer: str | None = None
    where: str | Sequence[str] = ()

    #: Name of the operation in scenes.
    _word: ClassVar[str] = ""

    def _action(self, files: _Files) -> dict[str, Any]:
        """Return the fields of the operation, each read by its declared type, and add its files to `files`."""
        own = [field for field in fields(self) if field.name not in ("layer", "where")]
        return {field.name.rstrip("_"): _read(getattr(self, field.name), field, files) for field in own}

    def _asked(self, files: _Files) -> dict[str, Any]:
        if not self._word:
            raise InputTypeError("vtex.Edit says nothing to do", "use one of its classes, such as vtex.Tint")
        if self.layer is not None and not isinstance(self.layer, str):
            raise InputTypeError(f"layer = {self.layer!r} is no name")
        where = self.where.split(",") if isinstance(self.where, str) else list(self.where)
        conditions = [condition for condition in where if condition.strip()]
        action = self._action(files)
        return {"action": {self._word: action} if action else self._word, "layer": self.layer, "conditions": conditions}

    def __init_subclass__(cls) -> None:
        """Document the parameters that all edits share."""
        doc = inspect.cleandoc(cls.__doc__ or "")
        if "Parameters\n---" not in doc:
            doc += "\n\nParameters\n----------"
        cls.__doc__ = f"{doc}\n{_SHARED}"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            # Python calls this only for attributes that it does not find.
            field = _spelling.other(name)
            if field != name and field in self.__dataclass_fields__:
                return getattr(self, field)
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'", name=name, obj=self)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        pairs = [(getattr(self, f.name), getattr(other, f.name)) for f in fields(self)]
        return all(
            np.array_equal(a, b) if isinstance(a, np.ndarray) or isinstance(b, np.ndarray) else a == b for a, b in pairs
        )


@dataclass(frozen=True, eq=False)
class Thin(Edit):
    """Remove elements: first the small ones, then a share of the others in each layer.

    Give `keep`, `minimum_area` or both.

    Parameters
    ----------
    keep : float, optional
        Share of the elements of each layer that remains, 0 to 1. Default: all.
    order : {"blue-noise", "random", "area"}, default "blue-noise"
        Which elements vtex removes first:

        * ``"blue-noise"``: those with the nearest neighbours, so that the rest stays evenly spread
        * ``"random"``: any
        * ``"area"``: the smallest
    minimum_area : float, optional
        Remove smaller elements, and smaller details of the other elements, 0 to 10**9 square pixels. Default: none.
    """

    keep: float | None = None
    order: Literal["blue-noise", "random", "area"] = "blue-noise"
    minimum_area: float | None = None

    _word: ClassVar[str] = "thin"


@dataclass(frozen=True, eq=False)
class Density(Edit):
    """Keep each element with the probability that a grey picture gives at its position.

    Parameters
    ----------
    map : picture
        Grey picture: white (1.0) keeps all elements, black (0.0) keeps none.
    """

    map: _inputs.Picture

    _word: ClassVar[str] = "density"


@dataclass(frozen=True, eq=False)
class Orient(Edit):
    """Turn the longer axis of each element towards a direction. Round elements do not change.

    Parameters
    ----------
    direction : float or picture
        Direction, clockwise from the right, -360 to 360 degrees: 0 = horizontal, 90 = vertical. Or a grey picture:
        black = 0, white = 180.
    strength : float, default 1.0
        Share of the turn, 0 to 1: 0 = no change, 1 = turned fully.
    """

    direction: float | _inputs.Picture
    strength: float = 1.0

    _word: ClassVar[str] = "orient"

    def _action(self, files: _Files) -> dict[str, Any]:
        action = super()._action(files)
        direction = action["direction"]
        return {**action, "direction": {"map" if isinstance(direction, str) else "angle": direction}}


@dataclass(frozen=True, eq=False)
class Tint(Edit):
    """Mix one colour into the colours of elements, in Oklab.

    Parameters
    ----------
    colour : colour or picture
        The colour: ``"#rrggbb"``, ``"#rgb"``, a CSS colour name, or (r, g, b) with numbers from 0 to 255. Or a picture:
        each element gets the colour at its position, and does not change where the picture is transparent. vtex reads
        text with a dot as a path, unless it is a colour.
    amount : float, default 0.5
        Share of the colour in the mixture, 0 to 1.
    share : float, default 1.0
        Share of the elements to tint, chosen at random, 0 to 1.
    """

    colour: Colour | _inputs.Picture
    amount: float = 0.5
    share: float = 1.0

    _word: ClassVar[str] = "tint"


@dataclass(frozen=True, eq=False)
class Recolor(Edit):
    """Shift one colour to another; similar colours follow partly, and shading stays.

    Parameters
    ----------
    from_ : colour
        Colour to replace.
    to : colour
        New colour.
    reach : float, default 0.2
        Oklab distance up to which colours follow, 0.01 to 2. Black and white have a distance of 1.
    keep : {"nothing", "details"}, default "nothing"
        ``"details"`` keeps the colours that differ from the main colour of their element, such as the hearts of
        flowers.
    """

    from_: Colour
    to: Colour
    reach: float = 0.2
    keep: Literal["nothing", "details"] = "nothing"

    _word: ClassVar[str] = "recolor"


@dataclass(frozen=True, eq=False)
class Palette(Edit):
    """Replace the main colours of the texture by those of a palette.

    vtex weighs colours by the area that they cover. It matches dark with dark and light with light. Shading stays.
    Without ``layer``, the background changes too.

    Parameters
    ----------
    colours : sequence of colours, or path
        1 to 256 colours. Or a file: any text that contains ``#rrggbb``, or a GIMP palette.
    """

    colours: Sequence[Colour] | _inputs.Path

    _word: ClassVar[str] = "palette"

    def _action(self, files: _Files) -> dict[str, Any]:
        if isinstance(self.colours, (str, os.PathLike)):
            name = _inputs.path_of(self.colours)
            return {"colours": _vtex.palette((name, _vtex.read(name))), "file": name}
        return {"colours": [_colour(colour, "colours") for colour in self.colours]}


@dataclass(frozen=True, eq=False)
class Shadow(Edit):
    """Put a shadow under each element. It falls on everything below, and on nothing above.

    Parameters
    ----------
    angle : float, default 45.0
        Direction of the shadow, clockwise from the right, -360 to 360 degrees.
    length : float, default 5.0
        Distance by which the shadow is shifted, 0 to 1000 pixels.
    opacity : float, default 0.4
        Opacity of the shadow, 0 to 1. 0 removes shadows.
    blur : float, default 5.0
        Width of the soft edge, 0 to 200 pixels.
    """

    angle: float = 45.0
    length: float = 5.0
    opacity: float = 0.4
    blur: float = 5.0

    _word: ClassVar[str] = "shadow"


@dataclass(frozen=True, eq=False)
class Flatten(Edit):
    """Remove the details: each element gets the mean of its colours."""

    _word: ClassVar[str] = "flatten"


@dataclass(frozen=True, eq=False)
class Simplify(Edit):
    """Draw outlines with fewer points, and remove very small details.

    Parameters
    ----------
    tolerance : float
        Maximum distance that an outline may move, 0.01 to 100 pixels. vtex removes details that are smaller than a
        square with this side.
    """

    tolerance: float

    _word: ClassVar[str] = "simplify"


@dataclass(frozen=True, eq=False)
class Outline(Edit):
    """Draw a line along the outline of each element.

    Parameters
    ----------
    width : float
        Width of the line, 0 to 1000 pixels. 0 removes lines.
    colour : colour
        Colour of the line.
    """

    width: float
    colour: Colour

    _word: ClassVar[str] = "outline"


@dataclass(frozen=True, eq=False)
class Hatch(Edit):
    """Draw each element in ink: an outline on paper, with hatching that is denser where the element is darker.

    Small dark elements become dots. Small light elements are left out.

    Parameters
    ----------
    spacing : float, default 4.0
        Distance between the lines in the lightest tone, 0.5 to 1000 pixels. In darker tones, lines are closer, and then
        they cross.
    angle : float, default -45.0
        Direction of the lines, clockwise from the right, -360 to 360 degrees.
    width : float, default 0.7
        Width of lines and outlines, 0.01 to 1000 pixels.
    colour : colour, default "#202020"
        Colour of the ink.
    paper : colour, default "white"
        Colour of the paper, inside the outlines.
    """

    spacing: float = 4.0
    angle: float = -45.0
    width: float = 0.7
    colour: Colour = "#202020"
    paper: Colour = "white"

    _word: ClassVar[str] = "hatch"


@dataclass(frozen=True, eq=False)
class Replace(Edit):
    """Replace each element by the element of another library whose shape fits best.

    The new element gets the position, size and direction of the old one.

    Parameters
    ----------
    library : Library or path
        Library that gives the new elements.
    """

    library: _library.Library | _inputs.Path

    _word: ClassVar[str] = "replace"

    def _action(self, files: _Files) -> dict[str, Any]:
        if isinstance(self.library, _library.Library):
            named = (f"{self.library.file}.lib.json.gz", self.library.to_bytes())
            return {"library": files.put(named)}
        return {"library": files.add(self.library, "library")}


@dataclass(frozen=True, eq=False)
class Move(Edit):
    """Move elements.

    Parameters
    ----------
    x, y : float
        Distance to the right and distance down, -10**6 to 10**6 pixels each.
    """

    x: float
    y: float

    _word: ClassVar[str] = "move"


@dataclass(frozen=True, eq=False)
class Scale(Edit):
    """Make elements larger or smaller, each about its own centre.

    Parameters
    ----------
    factor : float or picture
        Factor of the size, 0.01 to 100. Or a grey picture: black = almost nothing, middle grey = 1, white = 2.
    """

    factor: float | _inputs.Picture

    _word: ClassVar[str] = "scale"


@dataclass(frozen=True, eq=False)
class Rotate(Edit):
    """Turn elements, each about its own centre.

    Parameters
    ----------
    angle : float or picture
        Angle, clockwise, -360 to 360 degrees. Or a grey picture: black = 0, white = 360.
    """

    angle: float | _inputs.Picture

    _word: ClassVar[str] = "rotate"


@dataclass(frozen=True, eq=False)
class Transform(Edit):
    """Scale, turn and move elements in one operation.

    Parameters
    ----------
    by : float or (float, float), default 0.0
        Distance to the right, or distances to the right and down, -10**6 to 10**6 pixels each.
    scale : float or (float, float), default 1.0
        Factor of the size, or factors along x and y, 0.01 to 100 each.
    angle : float, default 0.0
        Angle, clockwise, after scaling, -360 to 360 degrees.
    about : {"each", "selection"}, default "each"
        Centre of scaling and turning. ``"each"`` = the centre of each element. ``"selection"`` = the mean of the
        centres of all selected elements.
    """

    by: float | tuple[float, float] = 0.0
    scale: float | tuple[float, float] = 1.0
    angle: float = 0.0
    about: Literal["each", "selection"] = "each"

    _word: ClassVar[str] = "transform"

    def _action(self, files: _Files) -> dict[str, Any]:
        pairs = {"by": _inputs.pair("by", self.by, 0.0), "scale": _inputs.pair("scale", self.scale)}
        return {**super()._action(files), **pairs}


@dataclass(frozen=True, eq=False)
class Jitter(Edit):
    """Move, turn, scale, stretch, mirror and recolour each element at random.

    Give at least one change. All changes are 0 by default.

    Parameters
    ----------
    distance : float, default 0.0
        Maximum distance to move, 0 to 10**6 pixels.
    angle : float, default 0.0
        Maximum turn in either direction, 0 to 180 degrees.
    scale : float, default 0.0
        Maximum change of size, larger or smaller, 0 to 90 per cent.
    stretch : float, default 0.0
        Maximum change of the ratio of length to width, larger or smaller, 0 to 90 per cent. Areas do not change.
    flip : float, default 0.0
        Share of the elements to mirror, left to right, 0 to 1.
    hue : float, default 0.0
        Maximum turn of the hue in either direction, 0 to 180 degrees.
    chroma : float, default 0.0
        Maximum change of chroma, more or less, 0 to 100 per cent.
    lightness : float, default 0.0
        Maximum change of lightness, lighter or darker, 0 to 100 per cent of the lightness of white.
    distribution : {"uniform", "normal"}, default "uniform"
        Distribution of the changes. ``"uniform"`` = evenly between the limits. ``"normal"`` = normally, with the limits
        at two standard deviations.
    steps : int, default 0
        Number of equal steps from no change to each limit, 0 to 1000. Every change is a whole number of steps. 0 = any
        change.
    """

    distance: float = 0.0
    angle: float = 0.0
    scale: float = 0.0
    stretch: float = 0.0
    flip: float = 0.0
    hue: float = 0.0
    chroma: float = 0.0
    lightness: float = 0.0
    distribution: Literal["uniform", "normal"] = "uniform"
    steps: int = 0

    _word: ClassVar[str] = "jitter"


@dataclass(frozen=True, eq=False)
class Shuffle(Edit):
    """Exchange colours and details at random between elements of similar size.

    Parameters
    ----------
    within : {"layer", "category"}, default "layer"
        Exchange between the elements of each layer, or of each category in a layer.
    share : float, default 1.0
        Share of the elements that take part, 0 to 1.
    outlines : bool, default False
        Whether to exchange the outlines too. vtex fits each outline to the size and direction of the other element.
    """

    within: Literal["layer", "category"] = "layer"
    share: float = 1.0
    outlines: bool = False

    _word: ClassVar[str] = "shuffle"


@dataclass(frozen=True, eq=False)
class Vary(Edit):
    """Make the colours and shapes of elements more alike or more varied, about their mean.

    Give `colour`, `shape` or both.

    Parameters
    ----------
    colour : float or picture, optional
        How much the median colours of elements differ, 0 to 4: 0 = all have the same, 1 = no change, 2 = they differ
        twice as much. Or a grey picture: black = 0, middle grey = 1, white = 2. Default: no change.
    shape : float or picture, optional
        How much elements differ in size, elongation and direction, 0 to 4, or a grey picture as for `colour`. Default:
        no change.
    within : {"layer", "category"}, default "layer"
        One mean for the elements of each layer, or for each category in a layer.
    """

    colour: float | _inputs.Picture | None = None
    shape: float | _inputs.Picture | None = None
    within: Literal["layer", "category"] = "layer"

    _word: ClassVar[str] = "vary"


@dataclass(frozen=True, eq=False)
class Relax(Edit):
    """Move crowded elements apart, so that distances become even.

    Parameters
    ----------
    rounds : int, default 20
        Maximum number of rounds, 1 to 1000. vtex stops earlier if no element moves.
    strength : float, default 0.5
        Share of the missing distance by which elements move in each round, 0 to 1.
    minimum_distance : float, optional
        Minimum distance between the centres of elements, 0 to 1000 pixels. Default: the distance in a regular lattice
        of the same number of elements.
    """

    rounds: int = 20
    strength: float = 0.5
    minimum_distance: float | None = None

    _word: ClassVar[str] = "relax"


@dataclass(frozen=True, eq=False)
class Propagate(Edit):
    """Draw on one element, and repeat the drawing on all similar elements.

    vtex fits the drawing to the position, size and direction of each element. Give one of `drawing`, `element` and
    `fill`.

    Parameters
    ----------
    drawing : path, bytes or file, optional
        SVG as large as the canvas. The element under the drawing is the one that you drew on.
    element : path, bytes or file, optional
        SVG of any size to put on every similar element. vtex fits it by its largest shape.
    fill : colour, optional
        Colour that fills every similar element.
    of : int, optional
        Id of the element that the others are compared with. Default: the element under `drawing`. Without `drawing`,
        all selected elements are similar.
    similar : float, optional
        Maximum Oklab distance between the median colours of similar elements, 0 to 2. Default: elements of the same
        category are similar.
    replace : bool, optional
        Whether the drawing replaces the shapes of elements. If False, vtex draws it over them. Default: True with
        `element`, else False.
    """

    drawing: _inputs.Picture | None = None
    element: _inputs.Picture | None = None
    fill: Colour | None = None
    of: int | None = None
    similar: float | None = None
    replace: bool | None = None

    _word: ClassVar[str] = "propagate"

    def _action(self, files: _Files) -> dict[str, Any]:
        given = {"drawing": self.drawing, "element": self.element, "fill": self.fill}
        if sum(value is not None for value in given.values()) != 1:
            raise InputError("Propagate needs one of drawing, element and fill", "give one of them by name")
        action = super()._action(files)
        if self.replace is None:
            action["replace"] = self.element is not None
        return action


@dataclass(frozen=True, eq=False)
class Order(Edit):
    """Sort the painting order within each layer.

    Parameters
    ----------
    by : {"x", "y", "area", "lightness", "random"}
        Property to sort by: position from the left, position from the top, area, lightness, or at random. vtex paints
        the element with the smallest value first.
    reverse : bool, default False
        Whether to paint the element with the largest value first, below the others.
    """

    by: Literal["x", "y", "area", "lightness", "random"]
    reverse: bool = False

    _word: ClassVar[str] = "order"


@dataclass(frozen=True, eq=False)
class Delete(Edit):
    """Remove elements."""

    _word: ClassVar[str] = "delete"


@dataclass(frozen=True, eq=False)
class Mask(Edit):
    """Keep the elements whose centre is inside a shape, or outside.

    Parameters
    ----------
    shape : picture or SVG
        SVG with one path, fitted to the canvas. Or a picture, in which white (1.0) is inside.
    inside : bool, default True
        Whether to keep the elements inside the shape. If False, vtex keeps those outside.
    """

    shape: _inputs.Picture
    inside: bool = True

    _word: ClassVar[str] = "mask"


def _asked(edits: Iterable[Edit | Iterable[Edit]]) -> tuple[list[dict[str, Any]], dict[str, bytes]]:
    """Return edits, one by one or in lists, as plain data, and the files that they name."""
    files = _Files()
    asked = []
    several = (list(given) if _is_list(given) else [given] for given in edits)
    for edit in itertools.chain.from_iterable(several):
        if not isinstance(edit, Edit):
            message = f"{edit if isinstance(edit, type) else type(edit).__name__} is no edit"
            raise InputTypeError(message, "give objects such as vtex.Tint('red')")
        asked.append(edit._asked(files))
    return asked, files.contents


def _is_list(given: object) -> TypeGuard[Iterable[Edit]]:
    """Return whether an object contains edits. Text and classes do not."""
    return isinstance(given, Iterable) and not isinstance(given, (str, bytes, type))
