"""The class CMA of the package cmaes, see the folder above."""
