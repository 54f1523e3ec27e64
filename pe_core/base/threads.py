"""Threads and locks: imported by `lazy_threads` alone."""

from concurrent.futures import ThreadPoolExecutor as ThreadPoolExecutor
from threading import RLock as RLock
from threading import Thread as Thread
from threading import local as local
