"""What travels between nodes that process motion capture, and how files become it."""

from nodegraph_mocap.detections import Detections
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.recording import Mask, Origin, Trajectories
from nodegraph_mocap.samples import sample_folder
from nodegraph_mocap.tables import Figure, Table

__all__ = [
    "BlendshapeModel",
    "Detections",
    "Figure",
    "Head",
    "HeadMotion",
    "MarkerSet",
    "Mask",
    "Origin",
    "Table",
    "Trajectories",
    "Weights",
    "sample_folder",
]
