"""Writes encoder.onnx and decoder.onnx from a checkpoint, in single precision.

    export.py run/checkpoint.pt OUT_DIR

The split is SAM's: the encoder is run once an image, the decoder for points. The decoder takes a
window of the embedding a prompt, so that a mask costs what it covers and not what the image has:

    encoder   image (1, 3, H, W), RGB in 0..1, H and W multiples of 16
              -> image_embeddings (1, 32, H/2, W/2)
    decoder   image_embeddings (N, 32, h, w), point_coords (N, 1, 2): x and y in cells of the window
              -> low_res_masks (N, 3, h, w), iou_predictions (N, 3)
"""

import os
import sys

import numpy as np
import onnx
import onnxruntime
import torch

from network import APPEARANCE, CENTRE, CHANNELS, TEXTON, TextonNet


class Decoder(torch.nn.Module):
    def __init__(self, net):
        super().__init__()
        self.net = net

    def forward(self, image_embeddings, point_coords):
        e = image_embeddings
        n, h, w = e.shape[0], e.shape[2], e.shape[3]
        x = e.reshape(n, CHANNELS, -1)
        cell = torch.floor(point_coords[:, 0])
        at = (cell[:, 1] * w + cell[:, 0]).to(torch.int64)
        p = torch.gather(x, 2, at[:, None, None].expand(n, CHANNELS, 1))
        # The square of the difference: the expanded square loses digits in single precision.
        apart = (x[:, : CENTRE.stop] - p[:, : CENTRE.stop]) ** 2
        look = apart[:, :APPEARANCE].sum(1, keepdim=True)
        place = apart[:, CENTRE].sum(1, keepdim=True)
        a, s, b, quality = (t.transpose(1, 2) for t in self.net.heads(p.transpose(1, 2)))
        texton = self.net.ground * torch.tanh(x[:, TEXTON : TEXTON + 1] / 3)
        masks = b - a * look - s * place + texton
        return masks.reshape(n, -1, h, w), torch.sigmoid(quality[:, :, 0])


def main(checkpoint, out):
    os.makedirs(out, exist_ok=True)
    net = TextonNet()
    saved = torch.load(checkpoint, map_location="cpu")
    net.load_state_dict(saved["ema"])
    net.eval()
    encoder, decoder = os.path.join(out, "encoder.onnx"), os.path.join(out, "decoder.onnx")
    image = torch.rand(1, 3, 96, 128)
    points = torch.tensor([[[10.3, 20.9]], [[40.0, 7.0]]])
    with torch.no_grad():
        torch.onnx.export(
            net.encoder, image, encoder, opset_version=17, input_names=["image"],
            output_names=["image_embeddings"],
            dynamic_axes={"image": {2: "H", 3: "W"}, "image_embeddings": {2: "h", 3: "w"}},
        )
        e = net.encoder(image)
        window = e.expand(2, -1, -1, -1).contiguous()
        torch.onnx.export(
            Decoder(net), (window, points), decoder, opset_version=17,
            input_names=["image_embeddings", "point_coords"],
            output_names=["low_res_masks", "iou_predictions"],
            dynamic_axes={
                "image_embeddings": {0: "N", 2: "h", 3: "w"}, "point_coords": {0: "N"},
                "low_res_masks": {0: "N", 2: "h", 3: "w"}, "iou_predictions": {0: "N"},
            },
        )
        cells = points[:, 0].floor().long()
        p = e.flatten(2)[:, :, cells[:, 1] * e.shape[3] + cells[:, 0]].transpose(1, 2)
        want = net.decode(e, p)[0].reshape(2, 3, *e.shape[2:]).numpy()
    for path in (encoder, decoder):
        onnx.checker.check_model(onnx.load(path))
    run = onnxruntime.InferenceSession(encoder).run(None, {"image": image.numpy()})[0]
    masks, _ = onnxruntime.InferenceSession(decoder).run(
        None, {"image_embeddings": window.numpy(), "point_coords": points.numpy()}
    )
    print("step", saved["step"], "bytes", os.path.getsize(encoder), os.path.getsize(decoder))
    print(f"TEXTON_WEIGHT {float(net.ground):.4f}")
    print("encoder differs by", np.abs(run - e.numpy()).max(), "decoder by", np.abs(masks - want).max())


if __name__ == "__main__":
    main(*sys.argv[1:])
