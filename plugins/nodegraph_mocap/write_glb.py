"""Write a head, or its animation, for programs that show 3D scenes."""

from __future__ import annotations

from nodegraph import Files, node
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.glb.writing import animation_bytes, head_bytes
from nodegraph_mocap.head import Head


@node("write.glb")
def write_glb(animation: Animation | None = None, head: Head | None = None) -> Files:
    """Write an animation, a head or both as GLB files, which most 3D programs open.

    Lengths are in metres, in single precision. Morph targets keep their names, and ``read.head``
    finds the markers again. A missing weight repeats the last known one, with a warning.

    Parameters
    ----------
    animation
        Becomes ``animation.glb``: the head with its weights and motion, a key per frame.
    head
        Becomes ``head.glb``: a head at rest.

    Returns
    -------
    Files

    Raises
    ------
    ValueError
        If neither is fed, a head has no faces, or an animation has no frames or a frame that is a
        reflection.
    """
    files = {}
    if animation is not None:
        files["animation.glb"] = animation_bytes(animation)
    if head is not None:
        files["head.glb"] = head_bytes(head)
    if not files:
        raise ValueError("feed an animation or a head: there is nothing to write")
    return Files(files)
