"""Values without pickle, and results kept on disk under the keys of the steps that made them."""

from nodegraph.store.entries import About, Entry
from nodegraph.store.folder import store_folder
from nodegraph.store.packing import Packed, Packer, Unreadable, Unstorable
from nodegraph.store.store import DamagedEntry, Store
from nodegraph.store.upkeep import Amount, Kept, Upkeep

__all__ = [
    "About",
    "Amount",
    "DamagedEntry",
    "Entry",
    "Kept",
    "Packed",
    "Packer",
    "Store",
    "Unreadable",
    "Unstorable",
    "Upkeep",
    "store_folder",
]
