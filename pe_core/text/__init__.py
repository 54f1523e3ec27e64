"""Text in files: read and written whole, cells and tables checked, TOML and JSON written."""

from .files import decode_text, read_bytes, write_bytes
from .json_text import dump_json
from .toml_writer import dumps

__all__ = ["decode_text", "dump_json", "dumps", "read_bytes", "write_bytes"]
