"""How operators are made of functions, and what they report.

A report is one line in the status bar, whatever the input was.
"""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import bpy

from .. import signals
from ..engine import pe, text
from ..panel_text import typeset
from ..preferences.english import DEFERRED

USER_ERRORS = (pe.InputError, MemoryError)
"""Errors that end an operator with one line: wrong input, and too little memory."""
MAX_LETTERS = 400
OperatorResult = set[Literal["RUNNING_MODAL", "CANCELLED", "FINISHED", "PASS_THROUGH", "INTERFACE"]]
"""What ``execute``, ``invoke`` and ``modal`` return."""
UNDO = frozenset({"REGISTER", "UNDO"})
INTERNAL = frozenset({"INTERNAL"})
CLASSES: list[type] = []
"""All operators, and what has to be registered before them."""

# Blender registers the subclasses of Operator alone. What several operators have in common is a
# plain class for Blender, and an Operator for the checker of types.
if TYPE_CHECKING:
    OperatorMixin: TypeAlias = bpy.types.Operator
else:
    OperatorMixin = object


class Refused(Exception):
    """An operator did nothing; the user is told why in one line."""

    level: Literal["INFO", "WARNING", "ERROR"] = "WARNING"


class Failed(Refused):
    """As `Refused`, but an error: for scripts an exception."""

    level = "ERROR"


class Stopped(Refused):
    """As `Refused`, because the user wanted it so."""

    level = "INFO"


class Report(NamedTuple):
    """What an operator reports: warnings, then a line. Blender shows only the last report."""

    text: str
    warnings: tuple[str, ...] = ()
    level: Literal["INFO", "WARNING"] = "INFO"


Answer: TypeAlias = str | Report | OperatorResult | None
"""What a function of an operator returns: a report, nothing to report, or Blender's own result."""
PollReason: TypeAlias = Callable[[bpy.types.Context], str | None]
"""Why an operator is not possible now; an empty text gives no reason, None: it is possible."""


def declared(cls: type) -> type:
    """Decorate a class of Blender's so that it is registered."""
    CLASSES.append(cls)
    return cls


def operator(
    label: str,
    *,
    mode: str = "",
    unless: PollReason | None = None,
    signal: signals.Signal | None = None,
    options: frozenset[str] = UNDO,
    tooltip: Callable[[str, Any], str] | None = None,
    bases: tuple[type, ...] = (),
    **members: Any,
) -> Callable[[Callable[..., Answer]], type[bpy.types.Operator]]:
    """Return what makes an operator of a function, whose name and docstring the operator takes.

    The function takes the context, and properties of the operator by their names; as `operator`
    it takes the operator itself.

    `mode` says why the operator needs Object Mode; without a text it works in all modes. `unless`
    says why it is not possible in a context. `signal` is emitted after the function, `options` are
    `bl_options`. `tooltip` makes the tooltip of docstring and properties. `members` are properties,
    and other attributes of the class, such as `invoke`, `draw` and `bl_property`.
    """

    def make(function: Callable[..., Answer]) -> type[bpy.types.Operator]:
        names = list(inspect.signature(function).parameters)[1:]

        def execute(self: Any, context: bpy.types.Context) -> OperatorResult:
            try:
                given = {n: self if n == "operator" else getattr(self, n) for n in names}
                answer = function(context, **given)
            except (Refused, *USER_ERRORS) as error:
                return report_error(self, error)
            if signal is not None and answer != {"CANCELLED"}:
                signal.emit()
            return report_answer(self, answer)

        def poll(cls: Any, context: bpy.types.Context) -> bool:
            reason = mode if mode and context.mode != "OBJECT" else unless and unless(context)
            if reason:
                cls.poll_message_set(typeset(reason))
            return reason is None

        def description(cls: Any, _context: bpy.types.Context, chosen: Any) -> str:
            about = typeset(str(cls.__doc__))
            return about if tooltip is None else tooltip(about, chosen)

        members_of_class: dict[str, Any] = {
            "__doc__": function.__doc__,
            "__module__": function.__module__,
            "__annotations__": {n: m for n, m in members.items() if isinstance(m, DEFERRED)},
            "bl_idname": f"pe.{function.__name__}",
            "bl_label": label,
            "bl_options": set(options),
            "execute": execute,
            "poll": classmethod(poll),
        }
        if tooltip is not None:
            members_of_class["description"] = classmethod(description)

        members_of_class |= {n: m for n, m in members.items() if not isinstance(m, DEFERRED)}
        bl_bases = (*bases, bpy.types.Operator)
        return declared(type(f"PE_OT_{function.__name__}", bl_bases, members_of_class))

    return make


def report_error(operator: bpy.types.Operator, error: Exception) -> OperatorResult:
    """Report an error; the operator has changed nothing."""
    line = str(error)
    if isinstance(error, MemoryError):
        line = f"Not enough memory for this many voxels or candidates: {line}".rstrip(": ")
    report(operator, error.level if isinstance(error, Refused) else "ERROR", line)
    return {"CANCELLED"}


def report_answer(operator: bpy.types.Operator, answer: Answer) -> OperatorResult:
    """Report what a function of an operator answered; return the operator's result."""
    if isinstance(answer, set):
        return answer
    told = Report(answer) if isinstance(answer, str) else answer or Report("")
    for line in told.warnings:
        report(operator, "WARNING", line)
    if told.text:
        report(operator, told.level, told.text)
    return {"FINISHED"}


def report(
    operator: bpy.types.Operator, level: Literal["INFO", "WARNING", "ERROR"], text: str
) -> None:
    """Report one line. Characters that would break or reverse the line
    are escaped."""
    text = typeset(text[:MAX_LETTERS])
    printable = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
    operator.report({level}, printable)


def chosen_sensor(context: bpy.types.Context, name: str) -> bpy.types.Object:
    """Return the sensor of that name; the active one when the name is empty. `InputError` when
    there is no such sensor."""
    obj = context.scene.objects.get(name) if name else context.active_object
    if obj is None or not obj.perception_entropy.is_sensor:
        raise pe.InputError("scene", "active object", "a sensor", obj.name if obj else "none")
    return obj


def chosen_file(filepath: str) -> Path:
    """Return the chosen file. `InputError` when no file was chosen, or its name cannot be one."""
    path = text.named_path("export", "file", bpy.path.abspath(filepath))
    if not path.name:
        raise pe.InputError("export", "file", "the name of a file", repr(filepath))
    return path
