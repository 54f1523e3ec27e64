"""Opens pages in a headless Chromium: Debian's package, driven by Playwright."""

from __future__ import annotations

import shutil
import subprocess
import sys
from contextlib import contextmanager

from tests.limits import HANG_S, patience
from tests.needed import unavailable

try:
    from playwright.sync_api import Browser, Page, sync_playwright
except ImportError:
    Browser = Page = sync_playwright = None

PACKAGE = "chromium"
FLAGS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""WebGL in software: the same picture on every machine."""
PATIENCE_MS = 10_000
"""Timeout for a browser that hangs."""
DESKTOP = (1280, 900)
PHONE = (390, 844)
WITHOUT_WEBGL = """
  const real = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    return kind.startsWith("webgl") ? null : real.call(this, kind, ...more);
  };"""
SETTLED = """() => new Promise((done) => {
  setTimeout(done, 2000);
  requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)));
})"""
"""A busy machine may never draw a page that it takes for hidden; Playwright waits for ever then."""


@contextmanager
def started():
    """Yield Chromium; skip where it or Playwright is missing, or does not start."""
    program = browser_program()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
        yield browser
        browser.close()


def browser_program() -> str:
    """Return the path of Chromium, or skip: Playwright is started only where all is there."""
    if sync_playwright is None:
        unavailable("there is no Playwright: install the extra test")
    program = shutil.which(PACKAGE)
    if program is None:
        unavailable(f"there is no {PACKAGE}: install Debian's package of that name")
    command = [sys.executable, "-m", "playwright", "--version"]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=HANG_S)
    if answer.returncode != 0:
        reason = answer.stderr.strip().partition("\n")[0]
        unavailable(f"Playwright does not start: {reason}; Debian has libatomic1")
    return program


class Heard:
    """Records the warnings and errors of a page, and the addresses that it requests."""

    def __init__(self, page: Page) -> None:
        self.complaints: list[str] = []
        self.asked: list[str] = []
        page.on("console", lambda message: self._said(message.type, message.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.asked.append(request.url))

    def _said(self, kind: str, text: str) -> None:
        if kind in ("error", "warning"):
            self.complaints.append(text)


@contextmanager
def opened(browser: Browser, path, size=DESKTOP, script: str | None = None):
    """Open a file in the browser; yield the page and the record of its messages and requests."""
    phone = size == PHONE
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, has_touch=phone, is_mobile=phone
    )
    try:
        context.set_default_timeout(patience(PATIENCE_MS))
        page = context.new_page()
        if script:
            page.add_init_script(script)
        heard = Heard(page)
        page.goto(path.as_uri())
        settle(page)
        yield page, heard
    finally:
        context.close()


def settle(page: Page) -> None:
    """Wait until pending changes are rendered."""
    page.evaluate(SETTLED)
