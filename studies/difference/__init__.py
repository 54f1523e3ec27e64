"""What a difference in score is worth: how often the rig with the better score has the higher AP.

The plan is docs/validity/difference/plan.md. ``python -m studies.difference`` repeats its figures.
"""
