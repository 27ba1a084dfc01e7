"""The parts of a glTF file's JSON that describe meshes, their places and how they move.

Source: glTF 2.0 Specification, sections 3.5 to 3.8, 3.11 and 5, The Khronos Group.
"""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.alias_generators import to_camel

Index = Annotated[int, Field(ge=0)]
Count = Annotated[int, Field(ge=1)]
Number = Annotated[float, Field(allow_inf_nan=False)]
_Item = TypeVar("_Item")

_MOST_FAULTS = 3
_COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")
_LEAVE_MESHES_ALONE = (
    "KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "KHR_mesh_quantization",
    "KHR_animation_pointer", "KHR_node_visibility", "KHR_xmp",
)  # fmt: skip


class _Part(BaseModel):
    model_config = ConfigDict(alias_generator=to_camel, frozen=True, defer_build=True)


class Asset(_Part):
    """The program that wrote the file; our files state their unit in the extras."""

    version: str
    extras: object = None


class Buffer(_Part):
    """Bytes: those of the file, or of another one."""

    byte_length: Count
    uri: str | None = None


class BufferView(_Part):
    """A part of a buffer."""

    buffer: Index
    byte_offset: Index = 0
    byte_length: Count
    byte_stride: Annotated[int, Field(ge=4, le=252)] | None = None


class SparseIndices(_Part):
    """The places of the stored values."""

    buffer_view: Index
    byte_offset: Index = 0
    component_type: Literal[5121, 5123, 5125]


class SparseValues(_Part):
    """The stored values."""

    buffer_view: Index
    byte_offset: Index = 0


class Sparse(_Part):
    """The only values of an accessor that differ from what its view says, or from zero."""

    count: Count
    indices: SparseIndices
    values: SparseValues


class Accessor(_Part):
    """The layout of numbers in a view."""

    buffer_view: Index | None = None
    byte_offset: Index = 0
    component_type: Literal[5120, 5121, 5122, 5123, 5125, 5126]
    normalized: bool = False
    count: Count
    type: Literal["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]
    sparse: Sparse | None = None


class Primitive(_Part):
    """Triangles that share their attributes."""

    attributes: dict[str, Index]
    indices: Index | None = None
    mode: Annotated[int, Field(ge=0, le=6)] = 4
    targets: list[dict[str, Index]] = []


class Mesh(_Part):
    """Primitives, all with the same morph targets."""

    name: str = ""
    primitives: Annotated[list[Primitive], Field(min_length=1)]
    weights: list[Number] = []
    extras: object = None


class SceneNode(_Part):
    """A place in the scene, which may show a mesh."""

    name: str = ""
    mesh: Index | None = None
    skin: Index | None = None
    children: list[Index] = []
    weights: list[Number] = []
    matrix: Annotated[list[Number], Field(min_length=16, max_length=16)] | None = None
    translation: tuple[Number, Number, Number] = (0.0, 0.0, 0.0)
    rotation: tuple[Number, Number, Number, Number] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[Number, Number, Number] = (1.0, 1.0, 1.0)


class Skin(_Part):
    """Nodes that pull the vertices of a mesh along."""

    joints: Annotated[list[Index], Field(min_length=1)]
    inverse_bind_matrices: Index | None = None


class Target(_Part):
    """The part of a node that moves."""

    node: Index | None = None
    path: str


class Channel(_Part):
    """A part of a node that moves, and how."""

    sampler: Index
    target: Target


class Sampler(_Part):
    """Values at the times of keys."""

    input: Index
    output: Index
    interpolation: Literal["LINEAR", "STEP", "CUBICSPLINE"] = "LINEAR"


class Animation(_Part):
    """Nodes that move together."""

    channels: list[Channel] = []
    samplers: list[Sampler] = []


class Scene(_Part):
    """The nodes that are shown."""

    nodes: list[Index] = []


class Document(_Part):
    """The whole."""

    asset: Asset
    scene: Index = 0
    scenes: list[Scene] = []
    nodes: list[SceneNode] = []
    meshes: list[Mesh] = []
    skins: list[Skin] = []
    animations: list[Animation] = []
    accessors: list[Accessor] = []
    buffer_views: list[BufferView] = []
    buffers: list[Buffer] = []
    extensions_used: list[str] = []
    extensions_required: list[str] = []


def read_document(text: bytes) -> Document:
    """Return what the JSON of a glTF file says.

    Raises
    ------
    ValueError
        If it is not such JSON, naming the places; or if its meshes are compressed, or need another
        extension that is not known here.
    """
    try:
        document = Document.model_validate_json(text)
    except ValidationError as error:
        raise ValueError(f"its JSON is wrong: {_problems(error)}") from None
    for name in (*document.extensions_used, *document.extensions_required):
        if name in _COMPRESSED:
            raise ValueError(f"its meshes are compressed ({name}); export it without compression")
    for name in document.extensions_required:
        if not name.startswith(_LEAVE_MESHES_ALONE):
            raise ValueError(f"it needs the extension {name}, which is not known here")
    return document


def entry_at(items: list[_Item], index: int, what: str, where: str) -> _Item:
    """Return an item of a list of the document.

    Raises
    ------
    ValueError
        If there is none of that number.
    """
    if index >= len(items):
        raise ValueError(f"{where}: there is no {what} {index}; the file has {len(items)}")
    return items[index]


def _problems(error: ValidationError) -> str:
    faults = error.errors(include_url=False, include_context=False, include_input=False)
    problems = [
        f"{'.'.join(map(str, fault['loc']))}: {fault['msg']}" if fault["loc"] else fault["msg"]
        for fault in faults[:_MOST_FAULTS]
    ]
    more = [f"and {len(faults) - _MOST_FAULTS} more"] if len(faults) > _MOST_FAULTS else []
    return "; ".join(problems + more)
