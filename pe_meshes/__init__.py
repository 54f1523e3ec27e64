"""Meshes in formats that take a library to read: Collada and USD, of the extra ``meshes``.

`pe_core.formats` finds the readers by entry points, and loads one when a file asks for it.
"""
