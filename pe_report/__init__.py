"""The paper's experiments, reproduced and drawn: built on `pe_core` and matplotlib.

`paper` says what the paper prints, `tasks` what is computed, `runner` computes it, `claims` judges
it, `page` and `figures` show it. Every number on the page comes from results.json.
"""
