"""Research on perception entropy, beside the product: each study is a command and a page in docs/.

`paper` reproduces the experiments of Ma, Liu and Li (ICRA 2021), `published` compares the scores
with published results of detectors, `detectors` trains detectors of our own. They are run from a
checkout: ``python -m studies.paper``, with the extra ``studies`` installed.
"""
