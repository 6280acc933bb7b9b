#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The first screen of a page as a picture, and how long it took to load.

    tests/browser/screenshot.py PAGE.html PICTURE.png [SCRIPT [WIDTH HEIGHT]]

SCRIPT runs in the page before the picture is taken, such as 'axguard.goTo(12.5)'. WIDTH and HEIGHT
of the screen, in pixels [1400 1000].
"""
import pathlib
import sys
import time

from browser import browser_or_exit, resize


def main():
    if len(sys.argv) not in (3, 4, 6):
        sys.exit(__doc__)
    page = pathlib.Path(sys.argv[1]).resolve()
    browser = browser_or_exit(1400, 1000)
    try:
        start = time.monotonic()
        browser.get(page.as_uri())
        if browser.execute_script("return window.axguard === undefined"):
            sys.exit(f"{page}: the page did not start: {browser.get_log('browser')}")
        seconds = time.monotonic() - start
        if len(sys.argv) == 6:
            resize(browser, int(sys.argv[4]), int(sys.argv[5]))
        if len(sys.argv) > 3:
            browser.execute_script(sys.argv[3])
        browser.save_screenshot(sys.argv[2])
    finally:
        browser.quit()
    print(f"{page.name}: {page.stat().st_size / 1e6:.1f} MB, loaded in {seconds:.1f} s")


if __name__ == "__main__":
    main()
