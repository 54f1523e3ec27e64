"""AP curves of single sensors and groups, in place of their kind's."""

import pytest

import pe_core as pe
from pe_core.study import study_from_dict, study_to_dict
from tests.engine import shapes

BETTER = pe.ApCurve(0.2, 0.8)
SPACE = pe.PerceptionSpace((-6, 10), (-5, 5), (0, 2), 0.5)


def rig(curve, kind_wide=False):
    """Two LiDARs that fuse early and a camera, the LiDARs with a curve of their own."""
    own = None if kind_wide else curve
    lidar = shapes.small_lidar()
    return pe.Rig(
        [
            pe.Sensor("a", lidar, pe.Pose((0.0, 0.0, 1.9)), None, own),
            pe.Sensor("b", lidar, pe.Pose((1.0, 0.5, 1.9)), None, own),
            shapes.camera(),
        ]
    )


@pytest.mark.parametrize("samples", [0, 1024])
@pytest.mark.parametrize("blind", ["floor", "literal"])
def test_a_curve_of_all_of_a_kind_is_that_kind_s(samples, blind):
    def score(some, **curves):
        model = pe.PerceptionModel(blind, **curves)
        prior, car = pe.Prior.uniform(), shapes.box_car()
        return pe.Evaluator(SPACE, prior, car, samples=samples, model=model).score(some)

    one, other = score(rig(BETTER)), score(rig(BETTER, kind_wide=True), lidar=BETTER)
    assert one.to_dict() == other.to_dict()
    assert one.entropy < score(rig(None)).entropy


@pytest.mark.parametrize("samples", [0, 1024])
def test_sensors_of_one_kind_with_two_curves_are_fused_late(samples):
    """Of two LiDARs in one place each counts by its own curve: alone as that curve scores it."""
    lidar, pose = shapes.small_lidar(), pe.Pose((0.0, 0.0, 1.9))
    two = pe.Rig([pe.Sensor("a", lidar, pose, "a", BETTER), pe.Sensor("b", lidar, pose, "b")])
    evaluator = pe.Evaluator(SPACE, pe.Prior.uniform(), None, samples=samples)
    own = evaluator.score(two).per_sensor
    plain = evaluator.entropy(pe.Rig([two["b"]]))
    assert own["b"].entropy == plain
    assert own["a"].entropy == evaluator.entropy(pe.Rig([two["a"]])) < plain


def test_a_group_has_one_curve():
    lidar = shapes.small_lidar()
    with pytest.raises(pe.InputError, match="'lidar': expected one AP curve, found two"):
        pe.Rig([pe.Sensor("a", lidar, curve=BETTER), pe.Sensor("b", lidar)])


def test_a_study_holds_it():
    sensor = {"name": "a", "model": "Pandar64", "position": [0, 0, 2], "ap": {"a": 0.2, "b": 0.8}}
    study = study_from_dict({"sensor": [sensor]})
    assert study.rig["a"].curve == BETTER
    assert study_to_dict(study)["sensor"][0]["ap"] == {"a": 0.2, "b": 0.8}
    with pytest.raises(pe.InputError, match=r"ap\.b"):
        study_from_dict({"sensor": [sensor | {"ap": {"a": 0.2}}]})


def test_curves_of_objects_are_by_kind_and_class():
    model = pe.PerceptionModel(objects={"lidar": {"tram": BETTER}})
    assert model.object_curve("lidar", "tram") == BETTER
    with pytest.raises(pe.InputError, match=r"\[ap.lidar.objects.bus\]: expected a and b of 'bus'"):
        model.object_curve("lidar", "bus")
    with pytest.raises(pe.InputError, match=r"lidar.objects.tram: expected an ApCurve, found 5"):
        pe.PerceptionModel(objects={"lidar": {"tram": 5}})
