"""The texton network: a fully convolutional encoder and a promptable decoder.

Encoder: RGB in 0..1, shape (B, 3, H, W), H and W multiples of 16, to an embedding of shape
(B, CHANNELS, H/2, W/2). Of its channels

    0..16   appearance
    16..18  predicted centre of the element, in units of UNIT pixels
    18..30  three heads (part, whole and what lies between are theirs to find) of four values:
            how fast the logit falls with distance in appearance and in centre, its offset, and
            the logit of the intersection over union that the mask will have
    30      logit of texton against ground
    31      logit of a border

Decoder: of the embedding e at a prompted cell p, the logit of head k at cell x is

    b_k(p) - a_k(p) |e_x - e_p|^2 - s_k(p) |c_x - c_p|^2 + g tanh(texton_x / 3)
"""

import torch
import torch.nn as nn
import torch.nn.functional as F

APPEARANCE = 16
CENTRE = slice(APPEARANCE, APPEARANCE + 2)
HEADS = 3
HEAD = APPEARANCE + 2
TEXTON = HEAD + 4 * HEADS
BORDER = TEXTON + 1
CHANNELS = BORDER + 1
UNIT = 16.0
REACH = 96.0


class Conv(nn.Sequential):
    def __init__(self, i, o, k=3, stride=1, dilation=1):
        pad = dilation * (k // 2)
        super().__init__(
            nn.Conv2d(i, o, k, stride, pad, dilation, bias=False), nn.BatchNorm2d(o), nn.ReLU()
        )


class Residual(nn.Module):
    def __init__(self, c, dilation=1):
        super().__init__()
        self.a = Conv(c, c, dilation=dilation)
        self.b = nn.Sequential(nn.Conv2d(c, c, 3, 1, 1, bias=False), nn.BatchNorm2d(c))

    def forward(self, x):
        return F.relu(x + self.b(self.a(x)))


class Encoder(nn.Module):
    def __init__(self, widths=(32, 64, 96, 128)):
        super().__init__()
        a, b, c, d = widths
        self.stem = nn.Sequential(Conv(12, a), Residual(a))
        self.down1 = nn.Sequential(Conv(a, b, stride=2), Residual(b), Residual(b))
        self.down2 = nn.Sequential(Conv(b, c, stride=2), Residual(c), Residual(c))
        self.down3 = nn.Sequential(Conv(c, d, stride=2), Residual(d), Residual(d, 2), Residual(d, 4))
        self.up3, self.join3 = Conv(d, c, 1), Residual(c)
        self.up2, self.join2 = Conv(c, b, 1), Residual(b)
        self.up1, self.join1 = Conv(b, a, 1), nn.Sequential(Residual(a), Conv(a, 48))
        self.out = nn.Conv2d(48, CHANNELS, 1)

    def forward(self, image):
        x = (image - 0.45) * 4
        # Pixel unshuffle, in operators that every runtime has.
        x = torch.cat([x[:, :, i::2, j::2] for i in (0, 1) for j in (0, 1)], 1)
        up = lambda t: F.interpolate(t, scale_factor=2.0, mode="bilinear", align_corners=False)
        x1 = self.stem(x)
        x2 = self.down1(x1)
        x3 = self.down2(x2)
        x4 = self.down3(x3)
        y = self.join3(x3 + up(self.up3(x4)))
        y = self.join2(x2 + up(self.up2(y)))
        y = self.join1(x1 + up(self.up1(y)))
        o = self.out(y).float()
        one = torch.ones_like(o[:, :1])
        here = torch.cat([torch.cumsum(one, 3), torch.cumsum(one, 2)], 1) * 2 - 1
        centre = (here + REACH * torch.tanh(o[:, CENTRE] * (8 / REACH))) / UNIT
        return torch.cat([o[:, :APPEARANCE], centre, o[:, HEAD:]], 1)


class TextonNet(nn.Module):
    def __init__(self):
        super().__init__()
        self.encoder = Encoder()
        self.ground = nn.Parameter(torch.tensor(1.0))

    def heads(self, p):
        """Slopes a and s, offsets b and logits of the IoU: each (..., HEADS), of prompts (..., CHANNELS)."""
        h = p[..., HEAD:TEXTON].unflatten(-1, (HEADS, 4))
        # The heads start apart, from tight to loose.
        spread = torch.arange(HEADS, device=p.device, dtype=p.dtype) - (HEADS - 1) / 2
        return F.softplus(h[..., 0]), F.softplus(h[..., 1] + 1), h[..., 2] + 3 + spread, h[..., 3]

    def decode(self, e, p):
        """Logits (B, N, HEADS, h*w) of prompts p (B, N, CHANNELS) in embeddings e (B, CHANNELS, h, w)."""
        x = e.flatten(2)

        def distance(part):
            q, y = p[..., part], x[:, part]
            return (q * q).sum(-1, keepdim=True) - 2 * q @ y + (y * y).sum(1, keepdim=True)

        a, s, b, _ = (t[..., None] for t in self.heads(p))
        look, place = distance(slice(0, APPEARANCE))[:, :, None], distance(CENTRE)[:, :, None]
        texton = torch.tanh(x[:, None, None, TEXTON] / 3)
        return b - a * look - s * place + self.ground * texton
