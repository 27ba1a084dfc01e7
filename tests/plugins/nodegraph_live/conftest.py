"""Lab Streaming Layer keeps to this machine, and logs no more than errors, in every test."""

from __future__ import annotations

import pylsl

# read once, when the first stream is made
pylsl.set_config_content(
    """\
[multicast]
ResolveScope = machine
ListenAddress = 127.0.0.1
[log]
level = -3
"""
)
