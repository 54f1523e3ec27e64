"""``python -m studies.paper``: the experiments of Ma, Liu and Li (ICRA 2021), reproduced and drawn.

`paper` has what the paper prints, `plan` and `tasks` what is computed, `claims` compares it with
the paper, `page` and `plots` show it.
"""
