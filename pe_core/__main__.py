"""``python -m pe_core``: the command ``pe``, of the tools around the engine.

Nothing is imported on top that takes long: Ctrl-C is answered from the start.
"""

from importlib import import_module

if __name__ == "__main__":
    import_module("pe_tools.__main__").main()
