"""Text in files: read and written whole, cells and tables checked, TOML and JSON written."""

from .files import decode_text, read_bytes, write_bytes
from .json_text import dump_json
from .memory import available_bytes, require_memory
from .toml_reader import load_toml
from .toml_writer import dumps

__all__ = [
    "available_bytes",
    "decode_text",
    "dump_json",
    "dumps",
    "load_toml",
    "read_bytes",
    "require_memory",
    "write_bytes",
]
