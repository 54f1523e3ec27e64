"""``python -m studies.road FOLDER``: predicted beams against points that were measured.

`logs` reads what was recorded, `models` has the steps of the plan and their fit, `statistics` what
is compared.
"""
