"""``python -m studies.detectors``: our own study of placements and detectors.

`plan` has what was fixed beforehand, `posed_sensors` and `placements` the rigs; `scenes` and
`casting` give points, `detector`, `training` and `precision` are a run, `runs` and `result_files`
keep the results; `rank_tests` and `analysis` are the statistics, `study_page` and `study_plots`
show them. `cameras` is the study of cameras, with the same scenes.
"""
