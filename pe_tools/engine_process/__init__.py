"""The engine in a process of its own, for a program that has a window to keep alive."""

from .client import BEHIND, FOLLOWS_MOUSE, EngineCall, EngineEnded, EngineProcess, call_here

__all__ = ["BEHIND", "FOLLOWS_MOUSE", "EngineCall", "EngineEnded", "EngineProcess", "call_here"]
