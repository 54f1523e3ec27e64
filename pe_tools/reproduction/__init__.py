"""``pe reproduce``: the experiments of Ma, Liu and Li (ICRA 2021), reproduced and drawn.

`paper` has what the paper prints, `plan` and `tasks` what is computed, `task_runner` computes it,
`claims` compares it with the paper, `page` and `plots` show it.
"""
