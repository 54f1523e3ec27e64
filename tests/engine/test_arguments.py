"""Arguments from Python: each one of another type ends in one line, where it is given."""

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from tests.engine import shapes

SPACE = pe.PerceptionSpace((-10, 10), (-6, 6), (0, 2), 0.5)
EYE = pe.Sensor("eye", pe.catalog.load("Camera 60 deg"), pe.Pose((1.0, 0.0, 1.5)))
TOP = pe.Sensor("top", pe.catalog.load("Velodyne VLP-16 Puck"), pe.Pose((0.0, 0.0, 1.9)))
RIG = pe.Rig([TOP, EYE])
CAR = shapes.box_car()
PRIOR = pe.Prior.road()
STUDY = pe.Study(RIG, CAR, SPACE, PRIOR, samples=1024)
BOXES = pe.Boxes.of([("car", 5.0, 0.0, 0.75, 4.5, 1.8, 1.5, 0.0)])
CALLS = (
    (pe.Sensor, {"name": "a", "model": TOP.model, "pose": TOP.pose}),
    (pe.Rig, {"sensors": [TOP]}),
    (pe.Slot, {"name": "a", "pose": TOP.pose}),
    (pe.Prior, {"model": "road", "classes": PRIOR.classes, "focus": [pe.Focus(2.0)]}),
    (pe.Prior, {"model": "boxes", "boxes": BOXES}),
    (pe.Search, {"mounting": pe.Mounting(), "goals": pe.Goals(), "tolerance": pe.Tolerance()}),
    (pe.Goals, {"stop": pe.Stop(), "front": pe.Front(), "starts": []}),
    (pe.Start, {"name": "a", "poses": {"top": TOP.pose}}),
    (pe.SearchSpace, {"bounds": {}, "housings": {}}),
    (pe.Study, {"rig": RIG, "vehicle": CAR, "space": SPACE, "prior": PRIOR}),
    (pe.Evaluator, {"space": SPACE, "prior": PRIOR, "vehicle": CAR}),
    (pe.ObjectEvaluator, {"space": SPACE, "prior": PRIOR, "vehicle": CAR}),
    (pe.Sight, {"space": SPACE, "prior": PRIOR, "vehicle": CAR}),
    (pt.ScoreJob, {"study": STUDY}),
    (pt.OptimizeJob, {"study": STUDY}),
    (pt.FrontJob, {"study": STUDY}),
    (pt.plot.ground, {"study": STUDY}),
    (pt.plot.rig, {"study": STUDY}),
    (pt.plot.beams, {"study": STUDY, "sensor": TOP}),
)
WRONG = ("x", 3, ["x"], object(), EYE)
COLUMNS = ("class", "x", "y", "z", "length", "width", "height", "yaw")
ROWS = [("car", 5.0, 1.0, 0.75, 4.5, 1.8, 1.5, 0.3), ("cone", -4.0, 2.0, 0.3, 0.4, 0.4, 0.6, 0.0)]


@pytest.mark.parametrize(("call", "given"), CALLS, ids=lambda each: getattr(each, "__name__", ""))
def test_an_argument_of_another_type_is_refused_where_it_is_given(call, given):
    taken = []
    for name in given.keys() - {"name"}:
        for wrong in WRONG:
            try:
                call(**given | {name: wrong})
                taken.append((name, wrong))
            except pe.InputError:
                pass
    assert not taken


@pytest.mark.parametrize("model", ["road", "highway", "boxes", "grid"])
def test_the_name_of_a_prior_alone_is_refused_and_says_what_makes_one(model):
    """`Prior.road()` has the shipped classes; without classes there is nothing to expect."""
    with pytest.raises(pe.InputError) as told:
        pe.Prior(model)
    if model in ("road", "highway"):
        assert f"Prior.{model}()" in str(told.value)


def test_beams_are_those_of_a_lidar():
    with pytest.raises(pe.InputError, match="camera"):
        pt.plot.beams(STUDY, "eye")


def test_boxes_are_the_same_from_every_table():
    """So also from a data frame with its columns in another order and others beside them."""
    import pandas

    frame = pandas.DataFrame(ROWS, columns=list(COLUMNS), index=[7, 3])
    frame.insert(2, "track", ["a", "b"])
    records = frame.to_dict("records")
    dtype = [(name, "U8" if name == "class" else float) for name in COLUMNS]
    tables = (
        frame[["track", *reversed(COLUMNS)]],
        dict(frame),
        frame.to_records(),
        records,
        np.array(ROWS, dtype=dtype),
        list(map(list, ROWS)),
    )
    own = pe.Prior.from_boxes(ROWS)
    assert [pe.Prior.from_boxes(table) == own for table in tables] == [True] * len(tables)
    for wrong, name in ((frame.drop(columns="yaw"), "yaw"), ([{"class": "car"}], "x")):
        with pytest.raises(pe.InputError, match=name):
            pe.Prior.from_boxes(wrong)
