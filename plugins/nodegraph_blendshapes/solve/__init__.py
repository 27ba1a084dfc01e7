"""Find the weights with which a blendshape model explains a recording."""
