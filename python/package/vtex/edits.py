"""What can be done to a scene: a class for each operation, for `Scene.edit`.

Edits are plain values: they can be compared, printed, pickled, and done to any number of scenes. Lengths
are pixels of the canvas, angles degrees, clockwise on the screen. ``color`` and ``colors`` are taken and read
like ``colour`` and ``colours``. All have two more parameters, given by name:

layer : str, optional
    Only the elements of this layer, by its name or role (``"primary"``, ``"secondary"``; ``"background"``
    for colours). Default: the elements of all layers.
where : str or sequence of str, default ()
    Only the elements that fulfil all of these conditions: ``"category=3"`` (or ``3|5``, ``!=3``, or a name),
    ``"library=1"``, ``"id=17"``, ``"motif=4"``, ``"area>200"``, ``"elongation>1.5"``, ``"x<500"``,
    ``"y>=20"`` (with ``>``, ``<``, ``>=`` or ``<=``), ``"inside=shape.svg"``, ``"outside=mask.png"``.

Pictures are stretched over the canvas. They are paths, bytes, open files, images of Pillow, or arrays
height x width of uint8 or of floats from 0 to 1; colours are height x width x 3 or 4 of uint8.
"""

from __future__ import annotations

import inspect
import itertools
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeAlias, TypeGuard, Union

import numpy as np

from vtex import _inputs, _library, _spelling, _vtex
from vtex._errors import InputError, InputTypeError

#: Red, green and blue, 0 to 255; or ``"#rrggbb"``, ``"#rgb"`` or a name of CSS.
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


_SHARED = """layer : str, optional
    Only the elements of this layer, by its name or role. Default: the elements of all layers.
where : str or sequence of str, default ()
    Only the elements that fulfil all of these conditions, such as ``"area>200"``; see `vtex.edits`.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class Edit(metaclass=_spelling.Spelled):
    """Any of the edits; not made itself.

    Parameters
    ----------
    layer : str, optional
        Only the elements of this layer, by its name or role.
    where : str or sequence of str, default ()
        Only the elements that fulfil all of these conditions.
    """

    layer: str | None = None
    where: str | Sequence[str] = ()

    #: What scenes call the operation.
    _word: ClassVar[str] = ""

    def _action(self, files: _Files) -> dict[str, Any]:
        """Give the fields of the operation, its files put among `files`."""
        return {}

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
        """Document the parameters that all share."""
        doc = inspect.cleandoc(cls.__doc__ or "")
        if "Parameters\n---" not in doc:
            doc += "\n\nParameters\n----------"
        cls.__doc__ = f"{doc}\n{_SHARED}"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            # Only what is not found is asked for here.
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
    """Take elements away: the small ones go, and of what is left a share of each layer is kept.

    Parameters
    ----------
    keep : float, optional
        Share kept, 0 to 1.
    order : {"blue-noise", "random", "area"}, default "blue-noise"
        Which go first: those with the nearest neighbours, so that what is left stays even; any; or the
        smallest.
    minimum_area : float, optional
        Smaller elements go, and smaller details of those that stay; 0 to 10**9 square pixels.
    """

    keep: float | None = None
    order: Literal["blue-noise", "random", "area"] = "blue-noise"
    minimum_area: float | None = None

    _word: ClassVar[str] = "thin"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"keep": self.keep, "order": self.order, "minimum_area": self.minimum_area}


@dataclass(frozen=True, eq=False)
class Density(Edit):
    """Keep each element with the probability of a grey picture where it stands.

    Parameters
    ----------
    map : picture
        White (1.0) keeps all, black (0.0) none.
    """

    map: _inputs.Picture

    _word: ClassVar[str] = "density"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"map": files.add(self.map, "map")}


@dataclass(frozen=True, eq=False)
class Orient(Edit):
    """Turn the longer axis of each element towards a direction. Round ones stay as they are.

    Parameters
    ----------
    direction : float or picture
        Clockwise from the right, -360 to 360 degrees: 0 lies, 90 stands. Of a grey picture black is 0,
        white 180.
    strength : float, default 1.0
        Share of the way, 0 to 1.
    """

    direction: float | _inputs.Picture
    strength: float = 1.0

    _word: ClassVar[str] = "orient"

    def _action(self, files: _Files) -> dict[str, Any]:
        direction = files.number(self.direction, "direction")
        return {"direction": {"map" if isinstance(direction, str) else "angle": direction}, "strength": self.strength}


@dataclass(frozen=True, eq=False)
class Tint(Edit):
    """Mix colours with one, in Oklab.

    Parameters
    ----------
    colour : colour or picture
        The colour: ``"#rrggbb"``, ``"#rgb"``, a name of CSS, or (r, g, b) of 0 to 255. Or a picture that
        gives each element the colour it has where the element stands, and none where it is transparent;
        text with a dot that is no colour is a path.
    amount : float, default 0.5
        Its share in the mixture, 0 to 1.
    share : float, default 1.0
        Share of the elements tinted, chosen at random, 0 to 1.
    """

    colour: Colour | _inputs.Picture
    amount: float = 0.5
    share: float = 1.0

    _word: ClassVar[str] = "tint"

    def _action(self, files: _Files) -> dict[str, Any]:
        colour: Any = self.colour
        is_path = isinstance(colour, str) and _vtex.colour(colour) is None and _inputs.names_file(colour)
        if is_path or not isinstance(colour, (str, tuple, list)):
            colour = files.add(colour, "colour")
        else:
            colour = _colour(colour, "colour")
        return {"colour": colour, "amount": self.amount, "share": self.share}


@dataclass(frozen=True, eq=False)
class Recolor(Edit):
    """Move colours like one to another, and those less like it less far; shading stays.

    Parameters
    ----------
    from_ : colour
        The colour sought.
    to : colour
        The colour that it becomes.
    reach : float, default 0.2
        Oklab distance up to which colours are alike, 0.01 to 2; black and white are 1 apart.
    keep : {"nothing", "details"}, default "nothing"
        ``"details"`` leaves colours unlike the main one of their element, such as the hearts of flowers.
    """

    from_: Colour
    to: Colour
    reach: float = 0.2
    keep: Literal["nothing", "details"] = "nothing"

    _word: ClassVar[str] = "recolor"

    def _action(self, files: _Files) -> dict[str, Any]:
        colours = {"from": _colour(self.from_, "from_"), "to": _colour(self.to, "to")}
        return {**colours, "reach": self.reach, "keep": self.keep}


@dataclass(frozen=True, eq=False)
class Palette(Edit):
    """Replace the main colours, by the area that they cover, with those of a palette.

    Both from dark to light; shading stays. Without ``layer`` the background changes, too.

    Parameters
    ----------
    colours : sequence of colours, or path
        1 to 256 colours; or a file with ``#rrggbb`` in any text, or a GIMP palette.
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
    """Put a shadow under each element; it falls on what lies below and on nothing above.

    Parameters
    ----------
    angle : float, default 45.0
        Where it falls, clockwise from the right, -360 to 360 degrees.
    length : float, default 5.0
        How far, 0 to 1000 pixels.
    opacity : float, default 0.4
        How dark, 0 to 1; 0 takes shadows away.
    blur : float, default 5.0
        Width of its soft edge, 0 to 200 pixels.
    """

    angle: float = 45.0
    length: float = 5.0
    opacity: float = 0.4
    blur: float = 5.0

    _word: ClassVar[str] = "shadow"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"angle": self.angle, "length": self.length, "opacity": self.opacity, "blur": self.blur}


@dataclass(frozen=True, eq=False)
class Flatten(Edit):
    """Drop the details: each element gets the mean of its colours."""

    _word: ClassVar[str] = "flatten"


@dataclass(frozen=True, eq=False)
class Simplify(Edit):
    """Draw outlines again with fewer points, and drop the details that are smaller than that.

    Parameters
    ----------
    tolerance : float
        How far an outline may move, 0.01 to 100 pixels.
    """

    tolerance: float

    _word: ClassVar[str] = "simplify"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"tolerance": self.tolerance}


@dataclass(frozen=True, eq=False)
class Outline(Edit):
    """Draw a line along each element's outline.

    Parameters
    ----------
    width : float
        Width of the line, 0 to 1000 pixels; 0 takes lines away.
    colour : colour
        Its colour.
    """

    width: float
    colour: Colour

    _word: ClassVar[str] = "outline"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"width": self.width, "colour": _colour(self.colour, "colour")}


@dataclass(frozen=True, eq=False)
class Hatch(Edit):
    """Draw each element in ink: an outline on paper, and hatching that is the denser the darker it is.

    Dark spots become dots.

    Parameters
    ----------
    spacing : float, default 4.0
        Distance of the lines of the lightest tone, 0.5 to 1000 pixels; darker ones have them closer, then crossed.
    angle : float, default -45.0
        Their direction, -360 to 360 degrees clockwise from the right.
    width : float, default 0.7
        Their width, and that of outlines, 0.01 to 1000 pixels.
    colour : colour, default "#202020"
        The ink.
    paper : colour, default "white"
        The paper, within outlines.
    """

    spacing: float = 4.0
    angle: float = -45.0
    width: float = 0.7
    colour: Colour = "#202020"
    paper: Colour = "white"

    _word: ClassVar[str] = "hatch"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {
            "spacing": self.spacing,
            "angle": self.angle,
            "width": self.width,
            "colour": _colour(self.colour, "colour"),
            "paper": _colour(self.paper, "paper"),
        }


@dataclass(frozen=True, eq=False)
class Replace(Edit):
    """Replace each element by the one of another library whose shape fits best.

    It takes the place, size and direction of what it replaces.

    Parameters
    ----------
    library : Library or path
        The library.
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
        To the right and down, -10**6 to 10**6 pixels.
    """

    x: float
    y: float

    _word: ClassVar[str] = "move"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"x": self.x, "y": self.y}


@dataclass(frozen=True, eq=False)
class Scale(Edit):
    """Make elements larger or smaller, each about its own centre.

    Parameters
    ----------
    factor : float or picture
        The factor, 0.01 to 100. Of a grey picture black is almost nothing, middle grey 1, white 2.
    """

    factor: float | _inputs.Picture

    _word: ClassVar[str] = "scale"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"factor": files.number(self.factor, "factor")}


@dataclass(frozen=True, eq=False)
class Rotate(Edit):
    """Turn elements, each about its own centre.

    Parameters
    ----------
    angle : float or picture
        Clockwise, -360 to 360 degrees. Of a grey picture black is 0, white 360.
    """

    angle: float | _inputs.Picture

    _word: ClassVar[str] = "rotate"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"angle": files.number(self.angle, "angle")}


@dataclass(frozen=True, eq=False)
class Transform(Edit):
    """Scale, turn and move elements in one go, each about its own centre or all about theirs.

    Parameters
    ----------
    by : float or (float, float), default 0.0
        Way to the right, or to the right and down, -10**6 to 10**6 pixels each.
    scale : float or (float, float), default 1.0
        The factor, or those along x and y, 0.01 to 100 each.
    angle : float, default 0.0
        Clockwise, after scaling, -360 to 360 degrees.
    about : {"each", "selection"}, default "each"
        The point that stays: the centre of each, or the mean of the centres of all selected.
    """

    by: float | tuple[float, float] = 0.0
    scale: float | tuple[float, float] = 1.0
    angle: float = 0.0
    about: Literal["each", "selection"] = "each"

    _word: ClassVar[str] = "transform"

    def _action(self, files: _Files) -> dict[str, Any]:
        by, scale = _inputs.pair("by", self.by, 0.0), _inputs.pair("scale", self.scale)
        return {"by": by, "scale": scale, "angle": self.angle, "about": self.about}


@dataclass(frozen=True, eq=False)
class Jitter(Edit):
    """Move, turn, scale, stretch, mirror and recolour each element at random.

    Parameters
    ----------
    distance : float, default 0.0
        Largest way, 0 to 10**6 pixels.
    angle : float, default 0.0
        Largest turn either way, 0 to 180 degrees.
    scale : float, default 0.0
        Largest change of size either way, 0 to 90 per cent.
    stretch : float, default 0.0
        Largest change of the ratio of length to width either way, 0 to 90 per cent; areas stay.
    flip : float, default 0.0
        Share of the elements that are mirrored, left to right, 0 to 1.
    hue : float, default 0.0
        Largest turn of hues either way, 0 to 180 degrees.
    chroma : float, default 0.0
        Largest change of chroma either way, 0 to 100 per cent.
    lightness : float, default 0.0
        Largest change of lightness either way, 0 to 100 per cent of that of white.
    distribution : {"uniform", "normal"}, default "uniform"
        Evenly between the bounds, or normally, with the bounds at two standard deviations.
    steps : int, default 0
        Number of equal steps either way that changes are made of, up to 1000; 0 for any change.
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

    def _action(self, files: _Files) -> dict[str, Any]:
        return {
            "distance": self.distance,
            "angle": self.angle,
            "scale": self.scale,
            "stretch": self.stretch,
            "flip": self.flip,
            "hue": self.hue,
            "chroma": self.chroma,
            "lightness": self.lightness,
            "distribution": self.distribution,
            "steps": _inputs.whole("steps", self.steps, 0, 1000),
        }


@dataclass(frozen=True, eq=False)
class Shuffle(Edit):
    """Let appearances, colours and details, change places at random among elements of like size.

    Parameters
    ----------
    within : {"layer", "category"}, default "layer"
        Among the elements of a layer, or of each category in it.
    share : float, default 1.0
        Share of the elements that take part, 0 to 1.
    outlines : bool, default False
        Whether outlines change places too, each fitted to the size and direction of the other.
    """

    within: Literal["layer", "category"] = "layer"
    share: float = 1.0
    outlines: bool = False

    _word: ClassVar[str] = "shuffle"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"within": self.within, "share": self.share, "outlines": bool(self.outlines)}


@dataclass(frozen=True, eq=False)
class Vary(Edit):
    """Make colours and shapes more alike or more varied, about their mean.

    Parameters
    ----------
    colour : float or picture, optional
        0 gives all the same median colour, 1 changes nothing, 2 makes them vary twice as much, up to 4.
        Of a grey picture black is 0, white 2.
    shape : float or picture, optional
        As much for size, elongation and direction.
    within : {"layer", "category"}, default "layer"
        One mean for the elements of a layer, or for each category in it.
    """

    colour: float | _inputs.Picture | None = None
    shape: float | _inputs.Picture | None = None
    within: Literal["layer", "category"] = "layer"

    _word: ClassVar[str] = "vary"

    def _action(self, files: _Files) -> dict[str, Any]:
        colour, shape = files.number(self.colour, "colour"), files.number(self.shape, "shape")
        return {"colour": colour, "shape": shape, "within": self.within}


@dataclass(frozen=True, eq=False)
class Relax(Edit):
    """Move elements apart where they are close, so that distances become even.

    Parameters
    ----------
    rounds : int, default 20
        How often they move, 1 to 1000; it ends sooner if none moves any more.
    strength : float, default 0.5
        Share of the way each time, 0 to 1.
    minimum_distance : float, optional
        No centres nearer than this, 0 to 1000 pixels. Default: the distance in a regular lattice of as
        many elements.
    """

    rounds: int = 20
    strength: float = 0.5
    minimum_distance: float | None = None

    _word: ClassVar[str] = "relax"

    def _action(self, files: _Files) -> dict[str, Any]:
        rounds = _inputs.whole("rounds", self.rounds, 1, 1000)
        return {"rounds": rounds, "strength": self.strength, "minimum_distance": self.minimum_distance}


@dataclass(frozen=True, eq=False)
class Propagate(Edit):
    """Draw on one element, and it appears on all like it, fitted to their place, size and direction.

    One of `drawing`, `element` and `fill` is given.

    Parameters
    ----------
    drawing : path, bytes or file, optional
        An SVG of the canvas's size; the element under it is the one that is drawn on.
    element : path, bytes or file, optional
        An SVG of any size that every element becomes, fitted by its largest shape.
    fill : colour, optional
        The colour that every element is filled with.
    of : int, optional
        Id of the element that the others are like. Default: the one under `drawing`; without that all
        that are selected are alike.
    similar : float, optional
        Alike are elements whose median colours are no further apart in Oklab, 0 to 2. Default: those of
        the same category.
    replace : bool, optional
        Whether it is drawn in place of what elements show, else on it. Default: in place with `element`.
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
        return {
            "drawing": None if self.drawing is None else files.add(self.drawing, "drawing"),
            "element": None if self.element is None else files.add(self.element, "element"),
            "fill": None if self.fill is None else _colour(self.fill, "fill"),
            "of": None if self.of is None else _inputs.whole("of", self.of, 0, 2**32 - 1),
            "similar": self.similar,
            "replace": self.element is not None if self.replace is None else bool(self.replace),
        }


@dataclass(frozen=True, eq=False)
class Order(Edit):
    """Sort the painting order within each layer.

    Parameters
    ----------
    by : {"x", "y", "area", "lightness", "random"}
        Place from the left or the top, size, lightness, or nothing.
    reverse : bool, default False
        Whether the most of it is painted first, and lies undermost.
    """

    by: Literal["x", "y", "area", "lightness", "random"]
    reverse: bool = False

    _word: ClassVar[str] = "order"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"by": self.by, "reverse": bool(self.reverse)}


@dataclass(frozen=True, eq=False)
class Delete(Edit):
    """Take elements away."""

    _word: ClassVar[str] = "delete"


@dataclass(frozen=True, eq=False)
class Mask(Edit):
    """Keep the elements whose centre lies inside a shape, or outside.

    Parameters
    ----------
    shape : picture or SVG
        An SVG with one path, fitted to the canvas, or a picture, white (1.0) inside.
    inside : bool, default True
        Whether those inside are kept, else those outside.
    """

    shape: _inputs.Picture
    inside: bool = True

    _word: ClassVar[str] = "mask"

    def _action(self, files: _Files) -> dict[str, Any]:
        return {"shape": files.add(self.shape, "shape"), "inside": bool(self.inside)}


def _asked(edits: Iterable[Edit | Iterable[Edit]]) -> tuple[list[dict[str, Any]], dict[str, bytes]]:
    """Give edits, and those of lists among them, as plain data, and the files that they name."""
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
    """Tell whether something holds edits; text and classes hold none."""
    return isinstance(given, Iterable) and not isinstance(given, (str, bytes, type))
