# SPDX-License-Identifier: Apache-2.0
"""Headless Chromium for a page on disk, or an exit that says skipped and why."""
import os
import sys

SKIPPED = 77
SCRIPT_SECONDS = 120  # a picture is drawn by the processor: minutes while others compile
CHROMIUM, DRIVER = "/usr/bin/chromium", "/usr/bin/chromedriver"
FLAGS = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader",
         # Without a GPU the curves of a plot take a quarter of the time when they skip ANGLE.
         "--disable-accelerated-2d-canvas")

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
except ImportError:
    # Debian's module belongs to Debian's interpreter; another one may come first on the path.
    if sys.executable != "/usr/bin/python3" and os.path.exists("/usr/bin/python3"):
        os.execv("/usr/bin/python3", ["/usr/bin/python3", "-B", *sys.argv])
    print("skipped: no python3-selenium (./setup.sh --all installs it)")
    sys.exit(SKIPPED)


def browser_or_exit(width=1400, height=900):
    for needed in (CHROMIUM, DRIVER):
        if not os.path.exists(needed):
            print(f"skipped: no {needed} (./setup.sh --all installs chromium and its driver)")
            sys.exit(SKIPPED)
    options = Options()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, f"--window-size={width},{height}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service(DRIVER), options=options)
    browser.set_script_timeout(SCRIPT_SECONDS)
    return browser


def resize(browser, width=None, height=None):
    """The screen that the page sees, narrower than a window can be; without sizes, the window's."""
    if width is None:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    else:
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})
    # Two frames: one to lay out, one for what listens to the size.
    browser.execute_async_script(
        "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done))")


def touch(browser, is_on):
    """Fingers in place of a mouse."""
    browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": is_on})


def small_targets(browser):
    """What a finger would miss: buttons, choices, sliders, and check boxes with their labels."""
    return browser.execute_script("""
        const all = document.querySelectorAll("button, select, input[type=range], label");
        return [...all].filter((e) => e.offsetParent !== null &&
            (e.tagName !== "LABEL" || e.querySelector("input[type=checkbox]")))
          .map((e) => [e.id || e.textContent.trim(), e.getBoundingClientRect()])
          .filter(([, box]) => box.width < 44 || box.height < 44)
          .map(([name, box]) => `${name}: ${box.width} x ${box.height}`);""")
