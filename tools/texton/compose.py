"""Makes scenes with real appearance: layouts with exact labels, filled with pixels of photographs.

    compose.py OUT --scenes SCENES... --photographs FOLDER --count 1800 --seed 100

SCENES are folders written by `make_exemplars DIR --random N --packed --size 224`; half of the layouts are theirs, the
others are stones side by side and courses of bricks or tiles, made here. Each element gets pixels of one material out
of a photograph. Then come what divides real elements without being a border: stains, two tones, highlights, shadows of
other things; and what is a border without another colour: one sheet of material, with only light and joints to tell
elements apart. OUT has images.rgb and labels.u16 as SCENES do.
"""

import argparse
import os

import numpy as np
from PIL import Image
from scipy import ndimage, sparse

SIDE = 224
LEAST = 14  # pixels of an element

# CC0 or MIT photographs and the range of scales, in their pixels for one of the scene, at which a patch shows one
# material, for elements, for the ground or both. Photographs of the second list of labels are not among them.
MATERIALS = [
    ("aerial_grass_rock", 0.6, 3, "element ground"),
    ("aerial_ground_rock", 0.6, 3, "element ground"),
    ("aerial_rocks_04", 0.5, 3, "element ground"),
    ("aerial_grass_rock", 2, 4, "ground"),
    ("aerial_ground_rock", 2, 4, "ground"),
    ("gravel", 2.5, 4, "ground"),
    ("black_painted_planks", 0.4, 2, "element ground"),
    ("blue_painted_planks", 0.4, 2, "element ground"),
    ("rust_metal053c", 0.3, 2, "element ground"),
    ("rusty_metal_05", 0.3, 2, "element ground"),
    ("blue_floor_tiles_01", 0.25, 0.6, "element"),
    ("brick_floor_003", 0.2, 0.5, "element"),
    ("brick_wall_001", 0.2, 0.5, "element"),
    ("broken_wall", 0.2, 0.5, "element"),
    ("stone_floor", 0.2, 0.6, "element"),
    ("concrete_1", 0.4, 0.9, "element"),
    ("counter_3", 0.2, 0.5, "element"),
    ("tile_1", 0.2, 0.5, "element"),
    ("ground023", 0.2, 0.5, "element"),
]


class Materials:
    """Photographs at several scales, from which patches are cut."""

    def __init__(self, folder):
        self.of = {"element": [], "ground": []}
        for name, least, most, uses in MATERIALS:
            paths = [os.path.join(folder, name + ending) for ending in (".jpg", ".png")]
            photo = Image.open(next(p for p in paths if os.path.exists(p))).convert("RGB")
            levels = []
            for scale in np.geomspace(least, most, 5):
                size = max(48, round(photo.width / scale)), max(48, round(photo.height / scale))
                levels.append(np.asarray(photo.resize(size, Image.BICUBIC if scale < 1 else Image.LANCZOS)))
            for use in uses.split():
                self.of[use].append(levels)

    def levels(self, rng, use):
        """One photograph, at one scale or at all."""
        levels = self.of[use][rng.integers(len(self.of[use]))]
        level = levels[rng.integers(len(levels))]
        return [level] if rng.random() < 0.6 else levels

    def patch(self, rng, use):
        """A patch as large as a scene."""
        return cut(self.levels(rng, use), SIDE, SIDE, rng)


def cut(levels, height, width, rng):
    """A patch anywhere in one of some pictures, turned and mirrored by chance; beyond a border the picture is mirrored."""
    picture = levels[rng.integers(len(levels))]
    if rng.random() < 0.5:
        picture = picture.transpose(1, 0, 2)
    picture = picture[:: rng.choice([-1, 1]), :: rng.choice([-1, 1])]

    def places(side, length):
        at = (rng.integers(side) + np.arange(length)) % (2 * side)
        return np.where(at < side, at, 2 * side - 1 - at)

    rows, columns = places(picture.shape[0], height), places(picture.shape[1], width)
    return picture[rows][:, columns].astype(np.float32) / 255


def noise(rng, sigma, shape=(SIDE, SIDE)):
    """Smooth noise of deviation 1."""
    values = ndimage.gaussian_filter(rng.normal(size=shape).astype(np.float32), sigma, mode="wrap")
    return values / (values.std() + 1e-6)


def step(values):
    """Values as shares between 0 and 1."""
    return 1 / (1 + np.exp(-np.clip(values, -30, 30)))


# Layouts ------------------------------------------------------------------------------------------------------------


def courses(rng):
    """Rows of bricks or tiles."""
    label = np.zeros((SIDE, SIDE), np.uint16)
    height, ratio = rng.uniform(14, 80), rng.choice([1, 1, 2, 3, 4]) * rng.uniform(0.8, 1.25)
    joint, vary = rng.choice([0, 1, 2, 3, 4, 6]), rng.choice([0, 0.05, 0.3, 0.5])
    bond = rng.choice([0, 0.5, -1])  # in line, by halves, at random
    number, row, y = 1, 0, -rng.uniform(0, height)
    while y < SIDE:
        h = height * (1 + vary * 0.6 * rng.uniform(-1, 1))
        x = -rng.uniform(0, 1) * height * ratio if bond < 0 else -height * ratio * ((row * bond) % 1) - 3
        while x < SIDE:
            w = max(8, height * ratio * (1 + vary * rng.uniform(-1, 1)))
            if bond < 0 and rng.random() < 0.15:
                w *= 0.5
            sides = np.rint([y + joint / 2, y + h - joint / 2, x + joint / 2, x + w - joint / 2]).astype(int)
            sides = np.clip(sides + rng.integers(-1, 2, 4) * (rng.random() < 0.4), 0, SIDE)
            label[sides[0] : sides[1], sides[2] : sides[3]] = number
            number, x = number + 1, x + w
        y, row = y + h, row + 1
    if rng.random() < 0.4:
        label = rounded(label, rng)
    if rng.random() < 0.7:
        label = warped(label, rng, rng.uniform(0.2, 2), rng.uniform(3, 20))
    if rng.random() < 0.35:
        label = turned(label, rng)
    return whole(label)


def stones(rng):
    """Stones of one or very different sizes, side by side or with joints: cells of a power diagram."""
    size, spread = np.exp(rng.uniform(np.log(5), np.log(55))), rng.choice([0.1, 0.3, 0.6, 0.9])
    count = int(min(1500, 1.15 * (SIDE + 60) ** 2 / (np.pi * size**2 * np.exp(spread**2) / 3.2)) + 4)
    radii = np.sort(size * np.exp(spread * rng.normal(size=count)))[::-1]
    middles = np.zeros((0, 2))
    for k in range(count):
        best, farthest = None, -np.inf
        for _ in range(8):
            at, near = rng.uniform(-20, SIDE + 20, 2), slice(max(0, k - 200), k)
            apart = np.hypot(*(middles[near] - at).T) - 0.8 * (radii[k] + radii[near])
            apart = apart.min(initial=1)
            if apart > farthest:
                best, farthest = at, apart
            if apart > 0:
                break
        middles = np.vstack([middles, best])
    y, x = np.mgrid[:SIDE, :SIDE].astype(np.float32)
    angle, stretch = (rng.uniform(0, np.pi), rng.uniform(1, 2)) if rng.random() < 0.5 else (0, 1)
    nearest, label = np.full((SIDE, SIDE), np.inf, np.float32), np.zeros((SIDE, SIDE), np.uint16)
    for k, ((my, mx), radius) in enumerate(zip(middles, radii), 1):
        along = stretch * (np.cos(angle) * (y - my) + np.sin(angle) * (x - mx))
        power = along**2 + (np.cos(angle) * (x - mx) - np.sin(angle) * (y - my)) ** 2 - radius**2
        closer = power < nearest
        nearest[closer], label[closer] = power[closer], k
    label = warped(label, rng, rng.uniform(0.3, 3.5), rng.uniform(2, 9))
    label = np.where(depth(label) > rng.choice([0, 0, 0.6, 1.2, 2, 3]), label, 0).astype(np.uint16)
    if rng.random() < 0.6:
        label = rounded(label, rng)
    if rng.random() < 0.35:
        gone = rng.random(count + 1) < rng.uniform(0.1, 0.8)
        label[gone[label]] = 0
    return whole(label)


def at_places(label, y, x):
    return label[np.clip(np.rint(y), 0, SIDE - 1).astype(int), np.clip(np.rint(x), 0, SIDE - 1).astype(int)]


def warped(label, rng, amount, sigma):
    """Labels with uneven outlines."""
    y, x = np.mgrid[:SIDE, :SIDE]
    return at_places(label, y + amount * noise(rng, sigma), x + amount * noise(rng, sigma))


def turned(label, rng):
    """Labels at another angle, larger so that they still fill the scene."""
    angle, (y, x) = rng.uniform(0, np.pi), np.mgrid[:SIDE, :SIDE] - SIDE / 2
    rows, columns = np.cos(angle) * y + np.sin(angle) * x, np.cos(angle) * x - np.sin(angle) * y
    return at_places(label, 0.7 * rows + SIDE / 2, 0.7 * columns + SIDE / 2)


def rounded(label, rng):
    """Labels without what an opening by a disc takes off."""
    radius = rng.uniform(1.5, 6)
    near, (y, x) = ndimage.distance_transform_edt(depth(label) <= radius, return_indices=True)
    return np.where((near <= radius) & (label[y, x] == label), label, 0).astype(np.uint16)


def depth(label):
    """Distance of each pixel of an element from what is another's; 0 on the ground."""
    edge = np.zeros(label.shape, bool)
    for axis in (0, 1):
        differs = np.diff(label.astype(np.int32), axis=axis) != 0
        pad = [(1, 0), (0, 0)] if axis == 0 else [(0, 0), (1, 0)]
        edge |= np.pad(differs, pad) | np.pad(differs, [p[::-1] for p in pad])
    return np.where(label > 0, ndimage.distance_transform_edt(~edge) + 0.5, 0).astype(np.float32)


def whole(label):
    """Gives each connected part its own label. Crumbs become ground."""
    index = np.arange(label.size).reshape(label.shape)
    across, down = label[:, 1:] == label[:, :-1], label[1:] == label[:-1]
    a = np.concatenate([index[:, 1:][across], index[1:][down]])
    b = np.concatenate([index[:, :-1][across], index[:-1][down]])
    joined = sparse.coo_matrix((np.ones(len(a), np.int8), (a, b)), (label.size, label.size))
    part = sparse.csgraph.connected_components(joined, directed=False)[1].reshape(label.shape)
    keep = (label > 0) & (np.bincount(part.ravel())[part] >= LEAST)
    parts, out = np.unique(np.where(keep, part + 1, 0), return_inverse=True)
    return (out.reshape(label.shape) + (parts[0] > 0)).astype(np.uint16)


# Appearance ---------------------------------------------------------------------------------------------------------


def scene(materials, sets, rng):
    """A picture, and the element of each pixel."""
    lightness = None
    z = rng.random()
    if z < 0.22:
        label = courses(rng)
    elif z < 0.5:
        label = stones(rng)
    else:
        images, labels = sets[rng.integers(len(sets))]
        i = rng.integers(len(images))
        label, lightness = np.asarray(labels[i]), images[i].astype(np.float32).mean(2) / 255
    azimuth = rng.uniform(0, 2 * np.pi)
    light = np.array([np.sin(azimuth), np.cos(azimuth)])
    image = ground(materials, rng)
    fill(image, label, materials, light, rng)
    if lightness is not None and rng.random() < 0.5:
        # Veins, petals and facets of the generated scene.
        mean = ndimage.mean(lightness, label, np.arange(label.max() + 1))
        image *= np.clip((lightness + 0.03) / (mean[label] + 0.03), 0.2, 2.2)[..., None] ** rng.uniform(0.3, 1.1)
    return photograph(lit(image, label, light, rng), rng), label.astype(np.uint16)


def ground(materials, rng):
    image = materials.patch(rng, "ground")
    if rng.random() < 0.35:
        share = step(3 * noise(rng, rng.uniform(4, 30)))[..., None]
        image = image * (1 - share) + materials.patch(rng, "ground") * share
    mean = image.mean((0, 1))
    gain = np.exp(rng.normal(0, 0.25) + rng.normal(0, 0.12, 3))
    shift = rng.normal(0, 0.08) + rng.normal(0, 0.03, 3)
    image = (image - mean) * np.exp(rng.normal(0, 0.3)) + mean * gain + shift
    return image * rng.uniform(0.35, 1) if rng.random() < 0.5 else image


def fill(image, label, materials, light, rng):
    """Gives each element pixels of a material. Elements of one family share a photograph and a tint."""
    same, sheet = rng.random() < 0.25, None
    continuous = rng.random() < 0.12
    if same or continuous:
        sheet = materials.patch(rng, "element")
    if same:
        image[:] = sheet * rng.uniform(0.55, 1)
    first, families = materials.levels(rng, "element"), []
    for k in range(rng.choice([1, 1, 2, 2, 3, 5])):
        levels = first if k == 0 or rng.random() < 0.5 else materials.levels(rng, "element")
        families.append((levels, rng.normal(0, 0.1, 3) * rng.choice([0.3, 1]) + rng.normal(0, 0.12)))
    scatter = rng.choice([0.02, 0.05, 0.1, 0.16])
    stained, two_toned, shiny = rng.random() < 0.4, rng.random() < 0.18, rng.random() < 0.15
    for value, box in enumerate(ndimage.find_objects(label.astype(np.int32)), 1):
        if box is None:  # a number without pixels
            continue
        mask = label[box] == value
        levels, tint = families[rng.integers(len(families))]
        t = sheet[box] if continuous else cut(levels, *mask.shape, rng)
        mean = t[mask].mean(0)
        t = (t - mean) * rng.uniform(0.5, 1.3) + mean
        if not continuous:
            t = t + tint + rng.normal(0, scatter) + rng.normal(0, scatter * 0.3, 3)
        if stained and rng.random() < 0.6:
            share = noise(rng, rng.uniform(0.06, 0.25) * min(max(mask.shape), 60) + 1, mask.shape)
            share = step(rng.uniform(2, 12) * (share - rng.uniform(-0.3, 1.2)))[..., None] * rng.uniform(0.4, 1)
            other = t * rng.uniform(0.5, 0.9) + rng.normal(0, 0.06, 3)
            if rng.random() < 0.5:
                other = cut(materials.levels(rng, "element"), *mask.shape, rng)
            t = t * (1 - share) + other * share
        if two_toned and mask.sum() > 20 and rng.random() < 0.7:
            t = t * (1 - half(mask, rng)[..., None] * rng.uniform(0.1, 0.5))
        if shiny and rng.random() < 0.7:
            y, x = np.nonzero(mask)
            radius = np.sqrt(len(y) / np.pi)
            at = np.array([y.mean(), x.mean()]) + light * radius * rng.uniform(0.1, 0.5)
            apart = np.square(np.mgrid[: mask.shape[0], : mask.shape[1]] - at[:, None, None]).sum(0)
            spot = np.exp(-apart / (radius * rng.uniform(0.08, 0.35)) ** 2)
            t = t + (spot * rng.uniform(0.2, 0.9))[..., None]
        image[box][mask] = t[mask]


def half(mask, rng):
    """One side of an element: of its longer axis, as a leaf's, or of any line."""
    y, x = np.nonzero(mask)
    spread, axes = np.linalg.eigh(np.cov(np.stack([y, x])))
    angle = rng.uniform(0, np.pi)
    axis = axes[:, 1] if rng.random() < 0.6 else np.array([np.sin(angle), np.cos(angle)])
    rows, columns = np.mgrid[: mask.shape[0], : mask.shape[1]]
    across = (rows - y.mean()) * axis[1] - (columns - x.mean()) * axis[0] + 1.2 * noise(rng, 3, mask.shape)
    side = across > rng.normal(0, 0.15) * np.sqrt(spread[0])
    return ndimage.gaussian_filter(side.astype(np.float32), rng.uniform(0.4, 3))


def lit(image, label, light, rng):
    """Domes, dark edges, shadows cast on what lies lower, shadows of what is not seen, light that falls off."""
    deep, count = depth(label), int(label.max())
    if rng.random() < 0.65:
        radius = np.sqrt(np.bincount(label.ravel(), minlength=count + 1) / np.pi)[label] + 1
        bevel = np.minimum(radius, rng.choice([2, 4, 8, 30]))
        height = np.sqrt(1 - (1 - np.clip(deep / bevel, 0, 1)) ** 2) * bevel
        gy, gx = np.gradient(ndimage.gaussian_filter(height, rng.uniform(0.5, 1.5)))
        facing = (gy * light[0] + gx * light[1]) / np.sqrt(1 + gy * gy + gx * gx)
        image = image * np.where(label > 0, 1 - rng.uniform(0.1, 0.7) * facing, 1)[..., None]
    if rng.random() < 0.5:
        image = image * (1 - rng.uniform(0.1, 0.6) * np.exp(-deep / rng.uniform(0.7, 2.5)) * (label > 0))[..., None]
    if rng.random() < 0.55:
        rank = np.concatenate([[-1], rng.permutation(count)])
        shadow = np.zeros(label.shape, np.float32)
        for length in np.arange(1, rng.uniform(1, 9) + 0.5):
            above = ndimage.shift(label, light * length, order=0, mode="nearest")
            shadow = np.maximum(shadow, (above != label) & (rank[above] > rank[label]))
        shadow = ndimage.gaussian_filter(shadow, rng.uniform(0.4, 1.5))
        image = image * (1 - rng.uniform(0.2, 0.75) * shadow)[..., None]
    if rng.random() < 0.3:
        share = step(rng.uniform(2, 20) * (noise(rng, rng.uniform(15, 60)) - rng.uniform(0, 1.2)))
        image = image * (1 - rng.uniform(0.2, 0.6) * share)[..., None]
    if rng.random() < 0.3:
        slope = np.mgrid[:SIDE, :SIDE][rng.integers(2)] / SIDE - 0.5
        image = image * (1 + rng.uniform(-0.3, 0.3) * slope)[..., None]
    return image


def photograph(image, rng):
    """A picture as a camera sees it: not quite sharp, exposed somehow, with noise."""
    if rng.random() < 0.8:
        sigma = rng.uniform(0.3, 0.9)
        image = ndimage.gaussian_filter(image, (sigma, sigma, 0))
    image = image * rng.uniform(0.25, 0.65) / max(image.mean(), 0.05)
    image = image + rng.normal(0, rng.choice([0, 0.008, 0.02]), image.shape)
    return (np.clip(image, 0, 1) * 255 + 0.5).astype(np.uint8)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--scenes", nargs="+", required=True)
    parser.add_argument("--photographs", required=True)
    parser.add_argument("--count", type=int, default=1800)
    parser.add_argument("--seed", type=int, default=100)
    options = parser.parse_args()
    materials, sets = Materials(options.photographs), []
    for folder in options.scenes:
        n = os.path.getsize(folder + "/labels.u16") // (2 * SIDE * SIDE)
        images = np.memmap(folder + "/images.rgb", np.uint8, "r", shape=(n, SIDE, SIDE, 3))
        sets.append((images, np.memmap(folder + "/labels.u16", "<u2", "r", shape=(n, SIDE, SIDE))))
    os.makedirs(options.out, exist_ok=True)
    with open(options.out + "/images.rgb", "wb") as images, open(options.out + "/labels.u16", "wb") as labels:
        for i in range(options.count):
            image, label = scene(materials, sets, np.random.default_rng([options.seed, i]))
            images.write(image.tobytes())
            labels.write(label.astype("<u2").tobytes())


if __name__ == "__main__":
    main()
