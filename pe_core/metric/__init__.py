"""Equations 4 to 9: from a measurement to perception entropy."""

from ..lazy_faces import lazy_face

with lazy_face(__name__):
    from .entropy import (
        AP_MAX,
        AP_MIN,
        BLIND_PRECISION,
        H_BEST,
        H_BLIND,
        POINTPILLARS,
        RTM3D,
        ApCurve,
        average_precision,
        entropy_of,
        perception_entropy,
        precision_of,
        sigma_of,
    )
    from .fusion import early_fusion, late_fusion
