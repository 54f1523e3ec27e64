"""Files of other projects, unmodified, each folder with its licence.

cmaes/_cma.py: CMA-ES of the package cmaes 0.13.1 (MIT licence, CyberAgent, Inc.),
https://github.com/CyberAgentAILab/cmaes. The file is that of the released wheel: a test holds it to
its SHA-256. It is here so that panel, headless Blender and command line search alike, and nobody
has to install anything.
"""
