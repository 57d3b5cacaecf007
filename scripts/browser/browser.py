"""Chromium over its debugging pipe, for the others. Python's standard library only."""

import json
import os
import shutil
import subprocess
import sys

FLAGS = """--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
--disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars --remote-debugging-pipe""".split()


def need(*commands):
    """Installs Debian's packages for the commands that are missing."""
    packages = {"chromium": "chromium fonts-liberation", "pdftotext": "poppler-utils"}
    missing = " ".join(packages[command] for command in commands if not shutil.which(command))
    if missing and os.geteuid() != 0:
        sys.exit(f"needs: {missing} (as root this script installs them)")
    if missing:
        install = f"(apt-get update -qq && apt-get install -y -qq --no-install-recommends {missing}) >&2"
        subprocess.run(install, shell=True, check=True, env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"})


class Browser:
    """One Chromium, spoken to in JSON messages that end with a zero byte."""

    def __init__(self, profile):
        to_browser, self.out = os.pipe()
        self.inn, from_browser = os.pipe()

        def wire():  # the browser reads from descriptor 3 and writes to 4
            os.dup2(to_browser, 103)
            os.dup2(from_browser, 104)
            os.dup2(103, 3)
            os.dup2(104, 4)

        self.process = subprocess.Popen(
            ["chromium", *FLAGS, f"--user-data-dir={profile}", "about:blank"],
            preexec_fn=wire, close_fds=False, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.number, self.events = b"", 0, []

    def read(self):
        while b"\0" not in self.buffer:
            chunk = os.read(self.inn, 1 << 20)
            if not chunk:
                raise SystemExit("chromium ended before it answered")
            self.buffer += chunk
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def ask(self, method, session=None, **params):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise SystemExit(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def run(self, tab, script):
        """What a script in a tab gives; a script that fails ends all."""
        answer = self.ask("Runtime.evaluate", tab, expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise SystemExit(f"{script}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def open(self, url, width, height):
        """A tab of this size that shows the page."""
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        tab = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable", tab)
        self.show(tab, url, width, height)
        return tab

    def show(self, tab, url, width, height):
        self.ask("Emulation.setDeviceMetricsOverride", tab,
                 width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.load(tab, "Page.navigate", url=url)

    def load(self, tab, method, **params):
        """Has a page loaded, and waits until it is."""
        is_end = lambda event: event.get("method") == "Page.loadEventFired"
        self.events = [event for event in self.events if not is_end(event)]
        self.ask(method, tab, **params)
        while not any(map(is_end, self.events)):
            self.events.append(self.read())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.ask("Browser.close")
            self.process.wait(timeout=10)
        except (subprocess.TimeoutExpired, SystemExit, OSError):
            self.process.kill()
