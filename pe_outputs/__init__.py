"""Files that take a library to write: DXF, Rerun recordings, feather tables.

`pe_core` finds them by entry points, and loads one when it is asked for.
"""
