"""Makes a checkpoint from encoder.onnx, to train the network on.

    restore.py ../../models/texton/encoder.onnx WEIGHT run/checkpoint.pt SCENES...

The graph has its normalisation folded into the weights. Here each layer gets one again, with the statistics of some
crops of SCENES, so that the network computes the same. WEIGHT is `TEXTON_WEIGHT`; the optimiser starts anew.
"""

import sys

import onnx
import torch
from onnx import numpy_helper

from network import TextonNet
from train import Scenes, optimiser_of, save


def restored(path, weight, image):
    graph = onnx.load(path).graph
    stored = {tensor.name: torch.tensor(numpy_helper.to_array(tensor)) for tensor in graph.initializer}
    folded = [[stored[name] for name in node.input[1:]] for node in graph.node if node.op_type == "Conv"]
    net = TextonNet()
    net.ground.data = torch.tensor(weight)
    biases = {}
    convolution = None
    for layer in net.encoder.modules():
        if isinstance(layer, torch.nn.Conv2d):
            convolution = folded.pop(0)
            layer.weight.data = convolution[0]
            if layer.bias is not None:
                layer.bias.data = convolution[1]
        elif isinstance(layer, torch.nn.BatchNorm2d):
            biases[layer] = convolution[1]

    def measure(norm, inputs):
        variance, mean = torch.var_mean(inputs[0], (0, 2, 3), correction=0)
        norm.running_mean, norm.running_var = mean, variance
        norm.weight.data, norm.bias.data = torch.sqrt(variance + norm.eps), biases[norm] + mean

    hooks = [norm.register_forward_pre_hook(measure) for norm in biases]
    net.eval()
    with torch.no_grad():
        net.encoder(image)
    for hook in hooks:
        hook.remove()
    return net


def main(path, weight, out, *folders):
    image = next(iter(Scenes(folders, 224, 24, 7)))[0]
    net = restored(path, float(weight), image)
    average = {k: v.clone() for k, v in net.state_dict().items()}
    save(out, net, average, optimiser_of(net, 1e-3), 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
