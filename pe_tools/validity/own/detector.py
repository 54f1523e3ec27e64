"""The detectors: small networks that give a heat map of centres for each class, in JAX.

Both are trained as CenterNet is (Zhou, Wang, Kraehenbuehl: Objects as Points, arXiv 1904.07850):
focal loss on the heat maps, L1 loss on the offset of the centre within its cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

JaxArray = Any
Weights = dict[str, Any]

STRIDE = 2
"""Cells of the input along a side of a cell of the output."""
FIRST_BIAS = -3.5
"""Of the heat maps: at first a centre has a probability of 3 % everywhere."""
WIDTH, DEEP_WIDTH = 16, 32
WARM_UP_STEPS = 100
BETAS, EPSILON = (0.9, 0.999), 1e-8
NEAR_ZERO = 1e-4
"""Probabilities stay so far from 0 and 1."""


@dataclass(frozen=True, slots=True)
class Network:
    """A network: `weights` makes the first weights, `outputs` maps an input to (B, X, Y, C + 2)."""

    weights: Callable[[JaxArray], Weights]
    outputs: Callable[[Weights, JaxArray], JaxArray]


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

    def weights(key: JaxArray) -> Weights:
        shapes = {"entry": (1, 1, entry, WIDTH), **_trunk_shapes(WIDTH, classes)}
        return _first_weights(key, shapes)

    def outputs(w: Weights, x: JaxArray) -> JaxArray:
        return _trunk(w, jax.nn.relu(_conv(_space_to_depth(x), w, "entry")))

    return Network(weights, outputs)


def points_network(features: int, region: tuple[int, int], classes: int) -> Network:
    """Return the network *points*: learned features of points, their maximum in each pillar.

    Parameters
    ----------
    features : int
        Of a point.
    region : (X, Y) int
        Pillars along x and y.
    classes : int
    """
    nx, ny = region
    entry = WIDTH * STRIDE * STRIDE

    def weights(key: JaxArray) -> Weights:
        shapes = {
            "point_1": (features, WIDTH),
            "point_2": (WIDTH, WIDTH),
            "entry": (1, 1, entry, WIDTH),
            **_trunk_shapes(WIDTH, classes),
        }
        return _first_weights(key, shapes)

    def pillar_maxima(values: JaxArray, pillars: JaxArray) -> JaxArray:
        empty = jnp.zeros((nx * ny + 1, WIDTH), jnp.float32)  # the last one is for no point
        return empty.at[pillars].max(values)[:-1].reshape(nx, ny, WIDTH)

    def outputs(w: Weights, x: JaxArray) -> JaxArray:
        values, pillars = x
        for name in ("point_1", "point_2"):
            values = jax.nn.relu(values @ w[name] + w[f"{name}_bias"])
        grid = jax.vmap(pillar_maxima)(values, pillars)
        return _trunk(w, jax.nn.relu(_conv(_space_to_depth(grid), w, "entry")))

    return Network(weights, outputs)


def _trunk_shapes(width: int, classes: int) -> dict[str, tuple[int, ...]]:
    return {
        "down": (3, 3, width, DEEP_WIDTH),
        "deep_1": (3, 3, DEEP_WIDTH, DEEP_WIDTH),
        "deep_2": (3, 3, DEEP_WIDTH, DEEP_WIDTH),
        "up": (1, 1, DEEP_WIDTH, WIDTH * STRIDE * STRIDE),
        "joined": (3, 3, width + WIDTH, WIDTH),
        "head": (1, 1, WIDTH, classes + 2),
    }


def _trunk(w: Weights, fine: JaxArray) -> JaxArray:
    """Return outputs from features at the output's scale, by way of a coarser scale."""
    coarse = jax.nn.relu(_conv(fine, w, "down", STRIDE))
    for name in ("deep_1", "deep_2"):
        coarse = jax.nn.relu(_conv(coarse, w, name))
    up = _depth_to_space(jax.nn.relu(_conv(coarse, w, "up")))
    joined = jax.nn.relu(_conv(jnp.concatenate([fine, up], -1), w, "joined"))
    return _conv(joined, w, "head")


def _first_weights(key: JaxArray, shapes: dict[str, tuple[int, ...]]) -> Weights:
    """Return He's normal weights (arXiv 1502.01852) and zero biases but for the heat maps."""
    weights = {}
    for (name, shape), part in zip(shapes.items(), jax.random.split(key, len(shapes)), strict=True):
        scale = np.sqrt(2.0 / np.prod(shape[:-1]))
        weights[name] = scale * jax.random.normal(part, shape, jnp.float32)
        weights[f"{name}_bias"] = jnp.zeros(shape[-1], jnp.float32)
    weights["head_bias"] = weights["head_bias"].at[:-2].set(FIRST_BIAS)
    return weights


def _conv(x: JaxArray, w: Weights, name: str, stride: int = 1) -> JaxArray:
    strides, form = (stride, stride), ("NHWC", "HWIO", "NHWC")
    result = lax.conv_general_dilated(x, w[name], strides, "SAME", dimension_numbers=form)
    return result + w[f"{name}_bias"]


def _space_to_depth(x: JaxArray) -> JaxArray:
    b, h, w, c = x.shape
    blocks = x.reshape(b, h // STRIDE, STRIDE, w // STRIDE, STRIDE, c)
    return blocks.transpose(0, 1, 3, 2, 4, 5).reshape(b, h // STRIDE, w // STRIDE, -1)


def _depth_to_space(x: JaxArray) -> JaxArray:
    b, h, w, c = x.shape
    blocks = x.reshape(b, h, w, STRIDE, STRIDE, c // STRIDE**2)
    return blocks.transpose(0, 1, 3, 2, 4, 5).reshape(b, h * STRIDE, w * STRIDE, -1)


def loss(outputs: JaxArray, heat: JaxArray, offsets: JaxArray, at: JaxArray) -> JaxArray:
    """Return the loss of a batch.

    Parameters
    ----------
    outputs : (B, X, Y, C + 2)
    heat : (B, X, Y, C)
        1 at centres, falling off round them.
    offsets : (B, X, Y, 2)
        From the middle of the cell to the centre [cells].
    at : (B, X, Y)
        1 in cells with a centre, else 0.
    """
    p = jnp.clip(jax.nn.sigmoid(outputs[..., :-2]), NEAR_ZERO, 1.0 - NEAR_ZERO)
    centers = heat == 1.0
    right = jnp.where(centers, (1.0 - p) ** 2 * jnp.log(p), 0.0)
    wrong = jnp.where(centers, 0.0, (1.0 - heat) ** 4 * p**2 * jnp.log(1.0 - p))
    far = (jnp.abs(outputs[..., -2:] - offsets) * at[..., None]).sum()
    return (far - (right + wrong).sum()) / jnp.maximum(at.sum(), 1.0)


class Detector:
    """A network with its compiled training step, loss and outputs.

    Parameters
    ----------
    network : Network
    rate : float
        Adam's.
    average : float
        Decay of the averaged weights a step.
    """

    def __init__(self, network: Network, rate: float, average: float) -> None:
        self._network = network

        def batch_loss(weights: Weights, x: JaxArray, targets: tuple[JaxArray, ...]) -> JaxArray:
            return loss(network.outputs(weights, x), *targets)

        def step(
            weights: Weights,
            mean: Weights,
            moments: tuple[Weights, Weights],
            number: JaxArray,
            x: JaxArray,
            targets: tuple[JaxArray, ...],
        ) -> tuple[Weights, Weights, tuple[Weights, Weights]]:
            gradient = jax.grad(batch_loss)(weights, x, targets)
            now = rate * jnp.minimum(1.0, number / WARM_UP_STEPS)
            weights, moments = _adam(weights, gradient, moments, number, now)
            decay = jnp.minimum(average, number / (number + 10.0))
            mean = jax.tree.map(lambda a, b: decay * a + (1.0 - decay) * b, mean, weights)
            return weights, mean, moments

        self._step = jax.jit(step)
        self._loss = jax.jit(batch_loss)
        self._outputs = jax.jit(network.outputs)

    def start(self, seed: int) -> TrainingState:
        """Return the state before the first step."""
        weights = self._network.weights(jax.random.PRNGKey(seed))
        zeros = jax.tree.map(jnp.zeros_like, weights)
        return TrainingState(weights, weights, (zeros, zeros))

    def train(self, state: TrainingState, x: JaxArray, targets: tuple[JaxArray, ...]) -> None:
        """Change a state by one step of Adam (arXiv 1412.6980)."""
        state.step += 1
        state.weights, state.average, state.moments = self._step(
            state.weights, state.average, state.moments, float(state.step), x, targets
        )

    def loss(self, weights: Weights, x: JaxArray, targets: tuple[JaxArray, ...]) -> float:
        """Return the loss of a batch."""
        return float(self._loss(weights, x, targets))

    def outputs(self, weights: Weights, x: JaxArray) -> tuple[np.ndarray, np.ndarray]:
        """Return probabilities (B, X, Y, C) and offsets (B, X, Y, 2) [cells]."""
        outputs = np.asarray(self._outputs(weights, x))
        return 1.0 / (1.0 + np.exp(-outputs[..., :-2])), outputs[..., -2:]


def _adam(
    weights: Weights,
    gradient: Weights,
    moments: tuple[Weights, Weights],
    number: JaxArray,
    rate: JaxArray,
) -> tuple[Weights, tuple[Weights, Weights]]:
    first = jax.tree.map(lambda m, g: BETAS[0] * m + (1.0 - BETAS[0]) * g, moments[0], gradient)
    second = jax.tree.map(lambda v, g: BETAS[1] * v + (1.0 - BETAS[1]) * g**2, moments[1], gradient)
    scale = rate * jnp.sqrt(1.0 - BETAS[1] ** number) / (1.0 - BETAS[0] ** number)
    weights = jax.tree.map(
        lambda w, m, v: w - scale * m / (jnp.sqrt(v) + EPSILON), weights, first, second
    )
    return weights, (first, second)


def versions() -> dict[str, str]:
    """Return what computes: JAX's version and the kind of device."""
    return {"jax": jax.__version__, "device": jax.devices()[0].platform}
