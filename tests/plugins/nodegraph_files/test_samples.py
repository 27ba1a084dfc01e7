from __future__ import annotations

import pytest

from nodegraph import NodegraphError
from nodegraph_files import sample_folder


def test_an_unknown_sample_is_refused_with_the_nearest() -> None:
    with pytest.raises(
        NodegraphError, match=r"did you mean 'actor_a'.*actor_b, actor_c, face, face_1"
    ):
        sample_folder("actor_aa")


@pytest.mark.parametrize("name", ["..", "", "face/", "../samples/face"])
def test_a_path_is_not_a_sample(name: str) -> None:
    with pytest.raises(NodegraphError, match="no sample"):
        sample_folder(name)
