"""Published camera rigs: do the scores rank them, and which curve do their pixels follow?

The plan is docs/validity/cameras/plan.md. ``python -m studies.cameras FILE`` repeats its figures.
"""
