"""Builds networks with the architectures of Segment Anything and random weights, and exports them to ONNX
as their users do: for shapes, memory and speed, not for masks. Nothing is downloaded.

    python tools/sam/random_networks.py FOLDER [NAME...]

Needs the packages torch, transformers 4.56, timm and onnx. The figures are in docs/measurements/networks.md, measured by

    cargo bench --bench networks -- FOLDER/NAME_encoder.onnx FOLDER/NAME_decoder.onnx
"""

import pathlib
import sys

import timm
import torch
from torch import nn
from transformers import Sam2Config, Sam2Model, SamConfig, SamModel

torch.manual_seed(0)
torch.set_grad_enabled(False)


def export(module, inputs, path, outputs, dynamic=None):
    module.eval()
    torch.onnx.export(
        module,
        tuple(inputs.values()),
        str(path),
        input_names=list(inputs),
        output_names=outputs,
        dynamic_axes=dynamic or {},
        opset_version=17,
        dynamo=False,
    )
    print(path.name, f"{path.stat().st_size / 1e6:.1f} MB", flush=True)


class Encoder(nn.Module):
    """SAM's image encoder as Optimum exports it."""

    def __init__(self, sam):
        super().__init__()
        self.sam = sam

    def forward(self, pixel_values):
        return self.sam.get_image_embeddings(pixel_values), self.sam.get_image_wide_positional_embeddings()


class Decoder(nn.Module):
    """SAM's prompt decoder as Optimum exports it."""

    def __init__(self, sam):
        super().__init__()
        self.sam = sam

    def forward(self, input_points, input_labels, image_embeddings, image_positional_embeddings):
        sparse, dense = self.sam.prompt_encoder(input_points, input_labels, None, None)
        masks, scores = self.sam.mask_decoder(
            image_embeddings=image_embeddings,
            image_positional_embeddings=image_positional_embeddings,
            sparse_prompt_embeddings=sparse,
            dense_prompt_embeddings=dense,
            multimask_output=True,
        )[:2]
        return scores, masks


class MetaDecoder(nn.Module):
    """The same decoder with the signature of Meta's export."""

    def __init__(self, sam):
        super().__init__()
        self.sam = sam

    def forward(self, image_embeddings, point_coords, point_labels, mask_input, has_mask_input, orig_im_size):
        # The padding point is given by the caller.
        sparse = self.sam.prompt_encoder._embed_points(point_coords[None], point_labels[None], pad=False)
        dense = self.sam.prompt_encoder.no_mask_embed.weight.reshape(1, -1, 1, 1).expand(1, -1, 64, 64)
        dense = dense + 0.0 * (mask_input.mean() * has_mask_input + orig_im_size.mean())
        low, scores = self.sam.mask_decoder(
            image_embeddings=image_embeddings,
            image_positional_embeddings=self.sam.get_image_wide_positional_embeddings(),
            sparse_prompt_embeddings=sparse,
            dense_prompt_embeddings=dense,
            multimask_output=True,
        )[:2]
        masks = nn.functional.interpolate(low[0], (1024, 1024), mode="bilinear", align_corners=False)
        return masks, scores[0], low[0]


class TinyEncoder(nn.Module):
    """An encoder of MobileSAM's size: TinyViT to a sixteenth of the side, and SAM's neck."""

    def __init__(self):
        super().__init__()
        self.body = timm.create_model(
            "tiny_vit_5m_224", pretrained=False, features_only=True, out_indices=(2,)
        )
        channels = self.body.feature_info.channels()[-1]
        self.neck = nn.Sequential(
            nn.Conv2d(channels, 256, 1, bias=False),
            nn.GroupNorm(1, 256),
            nn.Conv2d(256, 256, 3, padding=1, bias=False),
            nn.GroupNorm(1, 256),
        )

    def forward(self, images):
        return self.neck(self.body(images)[-1])


class Encoder2(nn.Module):
    """SAM 2's image encoder as samexporter exports it."""

    def __init__(self, sam):
        super().__init__()
        self.sam = sam

    def forward(self, image):
        embeddings = self.sam.get_image_embeddings(image)
        return embeddings[0], embeddings[1], embeddings[2]


class Decoder2(nn.Module):
    """SAM 2's prompt decoder as samexporter exports it."""

    def __init__(self, sam):
        super().__init__()
        self.sam = sam

    def forward(self, image_embed, high_res_feats_0, high_res_feats_1, point_coords, point_labels, mask_input, has_mask_input):
        sparse, dense = self.sam.prompt_encoder(point_coords[None], point_labels[None].long(), None, None)
        dense = dense + 0.0 * (mask_input.mean() * has_mask_input.mean())
        masks, scores = self.sam.mask_decoder(
            image_embeddings=image_embed,
            image_positional_embeddings=self.sam.get_image_wide_positional_embeddings(),
            sparse_prompt_embeddings=sparse,
            dense_prompt_embeddings=dense,
            multimask_output=True,
            high_resolution_features=[high_res_feats_0, high_res_feats_1],
        )[:2]
        return masks[0], scores[0]


def prompts(count, points):
    return torch.rand(count, points, 2) * 1024, torch.ones(count, points)


def optimum(folder, name, sam):
    export(
        Encoder(sam),
        {"pixel_values": torch.randn(1, 3, 1024, 1024)},
        folder / f"{name}_encoder.onnx",
        ["image_embeddings", "image_positional_embeddings"],
    )
    points, labels = prompts(3, 1)
    embedding = torch.randn(1, 256, 64, 64)
    axes = {1: "point_batch_size", 2: "nb_points_per_image"}
    export(
        Decoder(sam),
        {
            "input_points": points[None],
            "input_labels": labels[None].long(),
            "image_embeddings": embedding,
            "image_positional_embeddings": embedding,
        },
        folder / f"{name}_decoder.onnx",
        ["iou_scores", "pred_masks"],
        {"input_points": axes, "input_labels": axes},
    )


def sam_b(folder):
    optimum(folder, "sam_b", SamModel(SamConfig()))


def mobile(folder):
    sam = SamModel(SamConfig(vision_config={"num_hidden_layers": 1}))
    export(
        TinyEncoder(),
        {"images": torch.randn(1, 3, 1024, 1024)},
        folder / "mobile_encoder.onnx",
        ["image_embeddings"],
    )
    points, labels = prompts(1, 2)
    export(
        MetaDecoder(sam),
        {
            "image_embeddings": torch.randn(1, 256, 64, 64),
            "point_coords": points,
            "point_labels": labels,
            "mask_input": torch.zeros(1, 1, 256, 256),
            "has_mask_input": torch.zeros(1),
            "orig_im_size": torch.tensor([1024.0, 1024.0]),
        },
        folder / "mobile_decoder.onnx",
        ["masks", "iou_predictions", "low_res_masks"],
        {"point_coords": {1: "num_points"}, "point_labels": {1: "num_points"}},
    )


def sam2_t(folder):
    sam = Sam2Model(Sam2Config())
    names = ["high_res_feats_0", "high_res_feats_1", "image_embed"]
    image = torch.randn(1, 3, 1024, 1024)
    features = Encoder2(sam.eval())(image)
    print([tuple(f.shape) for f in features])
    export(Encoder2(sam), {"image": image}, folder / "sam2_t_encoder.onnx", names)
    points, labels = prompts(3, 1)
    both = {0: "num_labels", 1: "num_points"}
    inputs = {
        "image_embed": features[2],
        "high_res_feats_0": features[0],
        "high_res_feats_1": features[1],
        "point_coords": points,
        "point_labels": labels,
        "mask_input": torch.zeros(3, 1, 256, 256),
        "has_mask_input": torch.zeros(1),
    }
    dynamic = {
        "point_coords": both,
        "point_labels": both,
        "mask_input": {0: "num_labels"},
        "has_mask_input": {0: "num_labels"},
    }
    export(Decoder2(sam), inputs, folder / "sam2_t_decoder.onnx", ["masks", "iou_predictions"], dynamic)


KNOWN = {"mobile": mobile, "sam_b": sam_b, "sam2_t": sam2_t}

if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or KNOWN:
        KNOWN[name](folder)
