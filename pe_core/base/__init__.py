"""Values and files: checks of input values, files read and written whole, TOML, JSON, XML, YAML."""

from .arrays import Flags, Floats, Ints, Singles
from .codec import record
from .errors import available_bytes
from .files import csv_text, decode_text, named_path, read_bytes, require_new, write_bytes
from .input_files import note_input
from .json_schema import schema_of_record, schemas_of_records
from .recent_cache import RecentCache
from .table_reader import Table, dump_json, dumps, parse_json
from .values import Name, Number
