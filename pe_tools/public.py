"""The names of the tools that other programs use."""

from . import advice, plot
from .advice import Advice
from .exchange import export_rig, import_rig
from .formats import read_boxes, read_mesh, write_boxes, write_mesh
from .jobs import (
    Design,
    FrontJob,
    Job,
    OptimizeJob,
    Outcome,
    Progress,
    ScoreJob,
    TradeOff,
    export_study,
    prepare_folder,
    result_dict,
    write_front,
    write_outcome,
)

__all__ = ["Advice", "Design", "FrontJob", "Job", "OptimizeJob", "Outcome", "Progress"]
__all__ += ["ScoreJob", "TradeOff", "advice", "export_rig", "export_study", "import_rig", "plot"]
__all__ += ["prepare_folder", "read_boxes", "read_mesh", "result_dict", "write_boxes"]
__all__ += ["write_front", "write_mesh", "write_outcome"]
