"""Trains the texton network on scenes.

    train.py SCENES... --minutes 120 [--resume] [--out run]

SCENES are folders written by `make_exemplars DIR --random N --packed --size 224` or by `compose.py`; one named twice
is shown twice as often. The learning rate falls as a cosine over the minutes; `--resume` goes on from the last
checkpoint with a new cosine. Checkpoints hold the weights, their exponential average (`ema`, the ones to use), the
optimiser and the step.
"""

import argparse
import io
import json
import os
import time

import numpy as np
import torch
import torch.nn.functional as F
from PIL import Image
from scipy import ndimage

from network import BORDER, CHANNELS, HEADS, TEXTON, TextonNet

SIDE = 160
PROMPTS = 20
IGNORE = 65535
LEAST = 12  # visible pixels below which a part is neither right nor wrong


class Scenes(torch.utils.data.IterableDataset):
    """Crops of scenes, scaled and disturbed, with prompts."""

    def __init__(self, folders, size, batch, seed):
        self.folders, self.size, self.batch, self.seed = folders, size, batch, seed

    def __iter__(self):
        worker = torch.utils.data.get_worker_info()
        rng = np.random.default_rng([self.seed, worker.id if worker else 0])
        s = self.size
        sets = []
        for f in self.folders:
            n = os.path.getsize(f + "/labels.u16") // (2 * s * s)
            images = np.memmap(f + "/images.rgb", np.uint8, "r", shape=(n, s, s, 3))
            sets.append((images, np.memmap(f + "/labels.u16", "<u2", "r", shape=(n, s, s))))
        while True:
            yield collate([self.crop(sets, rng) for _ in range(self.batch)])

    def crop(self, sets, rng):
        while True:
            images, labels = sets[rng.integers(len(sets))]
            i = rng.integers(len(images))
            scale = rng.choice([0.72, 1.0, 1.5, 2.0, 2.6], p=[0.08, 0.37, 0.15, 0.32, 0.08])
            c = min(int(round(SIDE / scale)), self.size)
            y, x = rng.integers(0, self.size - c + 1, 2)
            image, label = disturb(images[i, y : y + c, x : x + c], labels[i, y : y + c, x : x + c], rng)
            if c != SIDE:
                kind = Image.BICUBIC if rng.random() < 0.7 else Image.BILINEAR
                image = np.asarray(Image.fromarray(image).resize((SIDE, SIDE), kind))
                at = np.minimum((np.arange(SIDE) + 0.5) * c / SIDE, c - 1).astype(int)
                label = label[at][:, at]
            found = prompts(label, (SIDE / c) ** 2, rng)
            if found is not None:
                return (image.transpose(2, 0, 1).astype(np.float32) / 255, *found)


def disturb(image, label, rng):
    """What cameras, lenses and files do, and colours no scene has."""
    turns = rng.integers(4)
    image, label = np.rot90(image, turns), np.rot90(label, turns)
    if rng.random() < 0.5:
        image, label = image[:, ::-1], label[:, ::-1]
    a = image.astype(np.float32) / 255
    if rng.random() < 0.5:
        a = a[..., rng.permutation(3)]
    if rng.random() < 0.5:
        a = (a - 0.5) * rng.uniform(0.5, 1.3) + 0.5 + rng.uniform(-0.15, 0.15)
    if rng.random() < 0.3:
        a = np.clip(a, 0, 1) ** np.exp(rng.normal(0, 0.3))
    if rng.random() < 0.06:
        a = 1 - a
    if rng.random() < 0.12:
        a = np.repeat(a.mean(2, keepdims=True), 3, 2)
    z = rng.random()
    if z < 0.2:
        soft = ndimage.gaussian_filter(a, (1, 1, 0))
        a = a + rng.uniform(0.3, 1.2) * (a - soft)
    elif z < 0.35:
        s = rng.uniform(0.4, 1.0)
        a = ndimage.gaussian_filter(a, (s, s, 0))
    u = (np.clip(a, 0, 1) * 255 + 0.5).astype(np.uint8)
    if rng.random() < 0.4:
        file = io.BytesIO()
        Image.fromarray(u).save(file, "JPEG", quality=int(rng.integers(50, 96)))
        u = np.asarray(Image.open(file))
    return u, label


def prompts(label, enlarged, rng):
    """Cells' labels, borders, and PROMPTS cells with their labels; None without any element."""
    border = np.zeros(label.shape, bool)
    d = label[:, 1:] != label[:, :-1]
    border[:, 1:] |= d
    border[:, :-1] |= d
    d = label[1:] != label[:-1]
    border[1:] |= d
    border[:-1] |= d
    h = SIDE // 2
    border = border.reshape(h, 2, h, 2).sum((1, 3)) >= 2
    cells = label[rng.integers(2) :: 2, rng.integers(2) :: 2].astype(np.int64)
    ids, inverse, count = np.unique(cells, return_inverse=True, return_counts=True)
    inverse = inverse.reshape(-1)
    small = (ids > 0) & (count < LEAST * enlarged / 4)
    cells = np.where(small[inverse].reshape(h, h), IGNORE, cells)
    good = np.flatnonzero((ids > 0) & ~small)
    if len(good) == 0:
        return None
    weight = count[good] ** 0.5
    chosen = rng.choice(good, PROMPTS, replace=len(good) < PROMPTS, p=weight / weight.sum())
    order = np.argsort(inverse, kind="stable")
    starts = np.cumsum(count) - count
    inner = ~border.reshape(-1)
    at = []
    for k in chosen:
        pixels = order[starts[k] : starts[k] + count[k]]
        inside = pixels[inner[pixels]]
        pick = inside if len(inside) > 2 and rng.random() < 0.85 else pixels
        at.append(pick[rng.integers(len(pick))])
    ground = np.flatnonzero(cells.reshape(-1) == 0)
    none = rng.choice(ground, PROMPTS) if len(ground) else np.full(PROMPTS, -1)
    return cells, border, np.array(at), none


def collate(crops):
    return [torch.from_numpy(np.stack(x)) for x in zip(*crops)]


def losses(net, image, cells, border, at, none):
    with torch.autocast("cpu", torch.bfloat16):
        e = net.encoder(image.to(memory_format=torch.channels_last))
    e = e.float().contiguous()
    flat = e.flatten(2)
    known = (cells != IGNORE).float()
    texton = ((cells > 0) & (cells != IGNORE)).float()
    texton_loss = (F.binary_cross_entropy_with_logits(e[:, TEXTON], texton, reduction="none") * known).mean()
    border_loss = F.binary_cross_entropy_with_logits(e[:, BORDER], border.float())

    take = lambda i: torch.gather(flat, 2, i[:, None].expand(-1, CHANNELS, -1)).transpose(1, 2)
    p = take(at)
    logits = net.decode(e, p).clamp(-30, 30)
    labels = cells.flatten(1)
    truth = (labels[:, None] == torch.gather(labels, 1, at)[..., None]).float()[:, :, None]
    known = known.flatten(1)[:, None, None]
    area = truth.sum(-1)
    bce = (F.binary_cross_entropy_with_logits(logits, truth.expand_as(logits), reduction="none") * known).sum(-1)
    bce = bce / (2 * area + 30)
    share = torch.sigmoid(logits) * known
    dice = 1 - (2 * (share * truth).sum(-1) + 2) / (share.sum(-1) + area + 2)
    each = bce + dice
    with torch.no_grad():
        mask = (logits > 0) & (known > 0)
        iou = (mask & (truth > 0)).sum(-1) / ((mask | (truth > 0)).sum(-1) + 1e-6)
    weight = area[..., 0] ** 0.25
    weight = weight / weight.sum(1, keepdim=True)
    mask_loss = ((0.85 * each.min(-1).values + 0.15 * each.mean(-1)) * weight).sum(1).mean()
    quality = net.heads(p)[3]
    quality_loss = F.binary_cross_entropy_with_logits(quality, iou)
    there = (none >= 0).float()[..., None]
    empty = net.heads(take(none.clamp(min=0)))[3]
    empty_loss = (F.binary_cross_entropy_with_logits(empty, torch.zeros_like(empty), reduction="none") * there).mean()
    total = mask_loss + 0.5 * texton_loss + 0.5 * border_loss + 0.3 * (quality_loss + 0.5 * empty_loss)
    best = quality.argmax(-1, keepdim=True)
    return total, [
        total.item(),
        texton_loss.item(),
        border_loss.item(),
        each.min(-1).values.mean().item(),
        iou.max(-1).values.mean().item(),
        torch.gather(iou, 2, best).mean().item(),
        quality_loss.item(),
    ]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--minutes", type=float, default=120)
    parser.add_argument("--batch", type=int, default=8)
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--size", type=int, default=224, help="side of the scenes in pixels")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", default="run")
    parser.add_argument("--resume", action="store_true")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    path = os.path.join(options.out, "checkpoint.pt")
    torch.manual_seed(options.seed)
    net = TextonNet().to(memory_format=torch.channels_last)
    optimiser = optimiser_of(net, options.rate)
    average = {k: v.clone() for k, v in net.state_dict().items()}
    step = 0
    if options.resume:
        saved = torch.load(path)
        net.load_state_dict(saved["net"])
        optimiser.load_state_dict(saved["optimiser"])
        average, step = saved["ema"], saved["step"]
    print("parameters", sum(p.numel() for p in net.parameters()), "heads", HEADS, flush=True)
    scenes = Scenes(options.scenes, options.size, options.batch, options.seed + step)
    loader = torch.utils.data.DataLoader(scenes, batch_size=None, num_workers=1, prefetch_factor=6)
    log = open(os.path.join(options.out, "log.jsonl"), "a")
    started, first, sums = time.time(), step, []
    net.train()
    for batch in loader:
        share = (time.time() - started) / (60 * options.minutes)
        if share >= 1:
            break
        rate = options.rate * min(1, (step - first + 1) / 100) * (0.02 + 0.98 * 0.5 * (1 + np.cos(np.pi * share)))
        for group in optimiser.param_groups:
            group["lr"] = rate
        loss, parts = losses(net, *batch)
        optimiser.zero_grad()
        loss.backward()
        norm = torch.nn.utils.clip_grad_norm_(net.parameters(), 5.0)
        if torch.isfinite(norm):
            optimiser.step()
        step += 1
        sums.append(parts)
        if step % 4 == 0:
            keep = min(0.998, (1 + step) / (10 + step)) ** 4
            with torch.no_grad():
                for k, v in net.state_dict().items():
                    if v.dtype.is_floating_point:
                        average[k].mul_(keep).add_(v, alpha=1 - keep)
                    else:
                        average[k].copy_(v)
        if step % 100 == 0:
            names = ["loss", "texton", "border", "mask", "iou_best", "iou_chosen", "quality"]
            line = dict(zip(names, np.round(np.mean(sums, 0), 4).tolist()))
            line |= {"step": step, "seconds": round(time.time() - started), "rate": round(rate, 6)}
            sums = []
            log.write(json.dumps(line) + "\n")
            log.flush()
            print(line, flush=True)
        if step % 500 == 0:
            save(path, net, average, optimiser, step)
    save(path, net, average, optimiser, step)
    print("done", step, flush=True)


def optimiser_of(net, rate):
    return torch.optim.AdamW(net.parameters(), lr=rate, weight_decay=1e-4, betas=(0.9, 0.98))


def save(path, net, average, optimiser, step):
    state = {"net": net.state_dict(), "ema": average, "optimiser": optimiser.state_dict(), "step": step}
    torch.save(state, path + ".new")
    os.replace(path + ".new", path)


if __name__ == "__main__":
    main()
