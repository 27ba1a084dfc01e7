"""Values without pickle, and results kept on disk under the keys of the steps that made them."""

from nodegraph.store.codec import Packed, Packer
from nodegraph.store.errors import Unreadable, Unstorable
from nodegraph.store.store import About, DamagedEntry, Entry, Store, store_folder
from nodegraph.store.upkeep import Amount, EntryOnDisk, Upkeep

__all__ = [
    "About",
    "Amount",
    "DamagedEntry",
    "Entry",
    "EntryOnDisk",
    "Packed",
    "Packer",
    "Store",
    "Unreadable",
    "Unstorable",
    "Upkeep",
    "store_folder",
]
