"""Tables of bad input: each row is refused in one short line that names its field."""

import pe_core as pe

MAX_LINE_LENGTH = 400


def wrongly_refused(call, rows, source=""):
    """Return the offenders of (field, input) rows: taken, of another field or source, or no line.

    `call` is given the inputs one by one. An error's source has to begin with `source`.
    """
    offenders = []
    for field, given in rows:
        try:
            call(given)
            offenders.append(f"{field}: taken: {given!r:.80}")
        except pe.InputError as error:
            line = str(error)
            is_line = line.isprintable() and len(line) < MAX_LINE_LENGTH
            if error.field != field or not error.source.startswith(str(source)) or not is_line:
                offenders.append(f"{field}: {line}")
    return offenders
