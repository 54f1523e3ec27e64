"""The network of pictures: features of each picture lifted to the ground, then the same trunk."""

from __future__ import annotations

import tensorflow as tf

from ..detector import (
    OFFSETS,
    STRIDE,
    WIDTH,
    Network,
    Tensor,
    Weights,
    conv,
    first_weights,
    trunk,
    trunk_shapes,
)
from .lifting import CELL_VALUES, HEIGHTS_M, Lifting

COLORS = 3
PICTURE = "picture_"
"""Begins the names of the weights that work on pictures."""


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
