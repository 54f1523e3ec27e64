"""The detectors: small networks that give a heat map of centres for each class, in TensorFlow.

Both are trained as CenterNet is (Zhou, Wang, Kraehenbuehl: Objects as Points, arXiv 1904.07850):
focal loss on the heat maps, L1 loss on the offset of the centre within its cell. One training step
takes 51 ms of one processor; in JAX, which computed four results that were replaced (`afterwards`),
118 ms, and in PyTorch 57 ms, side by side on one machine.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import tensorflow as tf

from .pictures import CELL_VALUES, HEIGHTS_M, Lifting

os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")  # no notes on processors and plugins

tf.config.threading.set_intra_op_parallelism_threads(1)  # results do not depend on the processors
tf.config.threading.set_inter_op_parallelism_threads(1)
tf.config.experimental.enable_op_determinism()

Tensor = Any
Weights = dict[str, Any]

STRIDE = 2
"""Cells of the input along a side of a cell of the output."""
FIRST_BIAS = -3.5
"""Of the heat maps: at first a centre has a probability of 3 % everywhere."""
WIDTH = 16
DEEP_WIDTH = 32
WARM_UP_STEPS = 100
OFFSETS = 2
"""Outputs besides the heat maps: the offset of the centre along x and y."""
BETAS = (0.9, 0.999)
EPSILON = 1e-8
NEAR_ZERO = 1e-4
"""Probabilities stay so far from 0 and 1."""
COLORS = 3
PICTURE = "picture_"
"""Begins the names of the weights that work on pictures."""


@dataclass(frozen=True, slots=True)
class Network:
    """A network: first weights of a seed, and outputs (B, X, Y, C + 2) from an input."""

    weights: Callable[[int], Weights]
    outputs: Callable[[Weights, Tensor], Tensor]


@dataclass(slots=True)
class TrainingState:
    """Weights, their exponential average, and the moments of Adam."""

    weights: Weights
    average: Weights
    moments: tuple[Weights, Weights]
    step: int = 0


def grid_network(layers: int, classes: int) -> Network:
    """Return the network *grid*: counts of points in voxels, two scales."""
    entry = layers * STRIDE * STRIDE

    def weights(seed: int) -> Weights:
        shapes = {"entry": (1, 1, entry, WIDTH), **trunk_shapes(WIDTH, classes + OFFSETS)}
        return first_weights(seed, shapes)

    def outputs(w: Weights, x: Tensor) -> Tensor:
        return trunk(w, tf.nn.relu(conv(tf.nn.space_to_depth(x, STRIDE), w, "entry")))

    return Network(weights, outputs)


def points_network(features: int, region: tuple[int, int], classes: int) -> Network:
    """Return the network *points*: learned features of points, their maximum in each pillar.

    `region` counts pillars along x and y, `features` are those of a point.
    """
    nx, ny = region
    entry = WIDTH * STRIDE * STRIDE

    def weights(seed: int) -> Weights:
        shapes = {
            "point_1": (features, WIDTH),
            "point_2": (WIDTH, WIDTH),
            "entry": (1, 1, entry, WIDTH),
            **trunk_shapes(WIDTH, classes + OFFSETS),
        }
        return first_weights(seed, shapes)

    def pillar_maxima(values: Tensor, pillars: Tensor) -> Tensor:
        """Return the maxima (B, X, Y, WIDTH) of values that are 0 or more; 0 in empty pillars."""
        size = nx * ny + 1  # the last pillar of a scene is for no point
        scenes = tf.range(tf.shape(pillars)[0])[:, None] * size
        count = tf.shape(pillars)[0] * size
        rows = tf.reshape(values, (-1, WIDTH))
        maxima = tf.math.unsorted_segment_max(rows, tf.reshape(pillars + scenes, (-1,)), count)
        maxima = tf.maximum(maxima, 0.0)  # of no point: the lowest number
        return tf.reshape(tf.reshape(maxima, (-1, size, WIDTH))[:, :-1], (-1, nx, ny, WIDTH))

    def outputs(w: Weights, x: Tensor) -> Tensor:
        values, pillars = x
        for name in ("point_1", "point_2"):
            values = tf.nn.relu(values @ w[name] + w[f"{name}_bias"])
        grid = pillar_maxima(values, pillars)
        return trunk(w, tf.nn.relu(conv(tf.nn.space_to_depth(grid, STRIDE), w, "entry")))

    return Network(weights, outputs)


def trunk_shapes(width: int, outputs: int) -> dict[str, tuple[int, ...]]:
    """Return the shapes of the weights of `trunk`, for features of a width."""
    return {
        "down": (3, 3, width, DEEP_WIDTH),
        "deep_1": (3, 3, DEEP_WIDTH, DEEP_WIDTH),
        "deep_2": (3, 3, DEEP_WIDTH, DEEP_WIDTH),
        "up": (1, 1, DEEP_WIDTH, WIDTH * STRIDE * STRIDE),
        "joined": (3, 3, width + WIDTH, WIDTH),
        "head": (1, 1, WIDTH, outputs),
    }


def trunk(w: Weights, fine: Tensor) -> Tensor:
    """Return outputs from features at the output's scale, by way of a coarser scale."""
    coarse = tf.nn.relu(conv(fine, w, "down", STRIDE))
    for name in ("deep_1", "deep_2"):
        coarse = tf.nn.relu(conv(coarse, w, name))
    up = tf.nn.depth_to_space(tf.nn.relu(conv(coarse, w, "up")), STRIDE)
    joined = tf.nn.relu(conv(tf.concat([fine, up], -1), w, "joined"))
    return conv(joined, w, "head")


def first_weights(seed: int, shapes: dict[str, tuple[int, ...]]) -> Weights:
    """Return He's normal weights (arXiv 1502.01852) and zero biases but for the heat maps."""
    rng = np.random.default_rng([seed, 2])
    weights = {}
    for name, shape in shapes.items():
        scale = np.sqrt(2.0 / np.prod(shape[:-1]))
        weights[name] = scale * rng.standard_normal(shape)
        weights[f"{name}_bias"] = np.zeros(shape[-1])
    weights["head_bias"][:-2] = FIRST_BIAS
    return {name: tf.constant(values, tf.float32) for name, values in weights.items()}


def conv(x: Tensor, w: Weights, name: str, stride: int = 1) -> Tensor:
    """Return a convolution with the weights and the bias of a name."""
    return tf.nn.conv2d(x, w[name], stride, "SAME") + w[f"{name}_bias"]


def loss(outputs: Tensor, heat: Tensor, offsets: Tensor, at: Tensor) -> Tensor:
    """Return the loss of a batch of outputs (B, X, Y, C + 2).

    `heat` (B, X, Y, C) is 1 at centres, falling off round them; `offsets` (B, X, Y, 2) are from the
    middle of the cell to the centre [cells]; `at` (B, X, Y) is 1 in cells with a centre, else 0.
    """
    p = tf.clip_by_value(tf.sigmoid(outputs[..., :-2]), NEAR_ZERO, 1.0 - NEAR_ZERO)
    centers = heat == 1.0
    right = tf.where(centers, (1.0 - p) ** 2 * tf.math.log(p), 0.0)
    wrong = tf.where(centers, 0.0, (1.0 - heat) ** 4 * p**2 * tf.math.log(1.0 - p))
    far = tf.reduce_sum(tf.abs(outputs[..., -2:] - offsets) * at[..., None])
    return (far - tf.reduce_sum(right + wrong)) / tf.maximum(tf.reduce_sum(at), 1.0)


class Detector:
    """A network with its compiled training step, loss and outputs.

    `rate` is Adam's, `average` the decay of the averaged weights a step.
    """

    def __init__(self, network: Network, rate: float, average: float) -> None:
        self._network = network

        def batch_loss(weights: Weights, x: Tensor, targets: tuple[Tensor, ...]) -> Tensor:
            return loss(network.outputs(weights, x), *targets)

        def step(
            weights: Weights,
            mean: Weights,
            moments: tuple[Weights, Weights],
            number: Tensor,
            x: Tensor,
            targets: tuple[Tensor, ...],
        ) -> tuple[Weights, Weights, tuple[Weights, Weights]]:
            with tf.GradientTape() as tape:
                tape.watch(weights)
                value = batch_loss(weights, x, targets)
            gradient = tape.gradient(value, weights)
            now = rate * tf.minimum(1.0, number / WARM_UP_STEPS)
            weights, moments = _adam(weights, gradient, moments, number, rate=now)
            decay = tf.minimum(average, number / (number + 10.0))
            mean = {k: decay * mean[k] + (1.0 - decay) * w for k, w in weights.items()}
            return weights, mean, moments

        self._step = tf.function(step)
        self._loss = tf.function(batch_loss)
        self._outputs = tf.function(network.outputs)

    def start(self, seed: int) -> TrainingState:
        """Return the state before the first step."""
        weights = self._network.weights(seed)
        zeros = {name: tf.zeros_like(values) for name, values in weights.items()}
        return TrainingState(weights, weights, (zeros, zeros))

    def train(self, state: TrainingState, x: Tensor, targets: tuple[Tensor, ...]) -> None:
        """Change a state by one step of Adam (arXiv 1412.6980)."""
        state.step += 1
        state.weights, state.average, state.moments = self._step(
            state.weights, state.average, state.moments, tf.constant(float(state.step)), x, targets
        )

    def loss(self, weights: Weights, x: Tensor, targets: tuple[Tensor, ...]) -> float:
        """Return the loss of a batch."""
        return float(self._loss(weights, x, targets))

    def outputs(self, weights: Weights, x: Tensor) -> tuple[np.ndarray, np.ndarray]:
        """Return probabilities (B, X, Y, C) and offsets (B, X, Y, 2) [cells]."""
        outputs = np.asarray(self._outputs(weights, x))
        return 1.0 / (1.0 + np.exp(-outputs[..., :-2])), outputs[..., -2:]


def _adam(
    weights: Weights,
    gradient: Weights,
    moments: tuple[Weights, Weights],
    number: Tensor,
    rate: Tensor,
) -> tuple[Weights, tuple[Weights, Weights]]:
    first, second = (
        {k: beta * m[k] + (1.0 - beta) * g**power for k, g in gradient.items()}
        for m, beta, power in zip(moments, BETAS, (1, 2), strict=True)
    )
    scale = rate * tf.sqrt(1.0 - BETAS[1] ** number) / (1.0 - BETAS[0] ** number)
    stepped = {k: w - scale * first[k] / (tf.sqrt(second[k]) + EPSILON) for k, w in weights.items()}
    return stepped, (first, second)


def versions() -> dict[str, str]:
    """Return what computes: TensorFlow's version and the kind of device."""
    gpus = tf.config.list_physical_devices("GPU")
    return {"tensorflow": tf.__version__, "device": "gpu" if gpus else "cpu"}


def pictures_network(lifting: Lifting, classes: int) -> Network:
    """Return the network of a rig: pictures (B, S, W, H, 3) to outputs (B, X, Y, C + 2).

    The trunk of the LiDARs' networks is used twice, with weights of its own each time: for features
    of coarse pixels, and for features of cells of the ground.
    """
    cameras, columns, rows, _ = lifting.nearness.shape
    coarse = cameras * columns * rows
    cells, heights, views = lifting.pixels.shape
    of_picture = {
        "entry": (3, 3, COLORS * STRIDE * STRIDE + 1, WIDTH),
        **trunk_shapes(WIDTH, WIDTH),
    }
    shapes = {
        **{PICTURE + name: shape for name, shape in of_picture.items()},
        "entry": (1, 1, len(HEIGHTS_M) * WIDTH + CELL_VALUES, WIDTH),
        **trunk_shapes(WIDTH, classes + OFFSETS),
    }

    def features(w: Weights, x: Tensor) -> Tensor:
        """Return features (B, coarse pixels + 1, WIDTH) of pictures; the last ones are 0."""
        own = {k.removeprefix(PICTURE): v for k, v in w.items() if k.startswith(PICTURE)}
        pixels = tf.reshape(x - 0.5, (-1, columns * STRIDE, rows * STRIDE, COLORS))
        near = tf.tile(tf.constant(lifting.nearness), (tf.shape(x)[0], 1, 1, 1))
        entry = tf.concat([tf.nn.space_to_depth(pixels, STRIDE), near], -1)
        found = tf.nn.relu(trunk(own, tf.nn.relu(conv(entry, own, "entry"))))
        return tf.pad(tf.reshape(found, (-1, coarse, WIDTH)), ((0, 0), (0, 1), (0, 0)))

    def lifted(found: Tensor) -> Tensor:
        """Return features (B, X, Y, heights * WIDTH) of the cells."""
        batch = tf.shape(found)[0]
        first = tf.range(batch)[:, None] * (coarse + 1)
        index = tf.reshape(lifting.pixels, (1, -1)) + first
        values = tf.gather(tf.reshape(found, (-1, WIDTH)), tf.reshape(index, (-1,)))
        values = tf.reshape(values, (-1, cells, heights, views, WIDTH))
        mean = tf.reduce_sum(values * lifting.shares[..., None], axis=3)
        return tf.reshape(mean, (-1, *lifting.cells.shape[:2], heights * WIDTH))

    def outputs(w: Weights, x: Tensor) -> Tensor:
        ground = lifted(features(w, x))
        geometry = tf.tile(tf.constant(lifting.cells)[None], (tf.shape(x)[0], 1, 1, 1))
        return trunk(w, tf.nn.relu(conv(tf.concat([ground, geometry], -1), w, "entry")))

    return Network(lambda seed: first_weights(seed, shapes), outputs)
