"""Drives Chromium over its debugging pipe for look_at_report.sh. Python's standard library only."""

import base64
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

FLAGS = """--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
--disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars --remote-debugging-pipe""".split()

# What a person would trip over; runs in the finished page.
INSPECT = """(() => {
  const found = [];
  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth)
    found.push(`page is ${root.scrollWidth} px wide in a window of ${root.clientWidth} px`);
  for (const svg of document.querySelectorAll('svg')) {
    const frame = svg.getBoundingClientRect();
    if (frame.width === 0) continue;
    const texts = [...svg.querySelectorAll('text')].map(t => [t.textContent, t.getBoundingClientRect()]);
    texts.forEach(([a, p], i) => {
      if (p.left < frame.left - 0.5 || p.right > frame.right + 0.5 || p.top < frame.top - 0.5
          || p.bottom > frame.bottom + 0.5) found.push(`${svg.id}: "${a}" is cut off`);
      if (p.height < 10) found.push(`${svg.id}: "${a}" is ${p.height.toFixed(1)} px high`);
      for (const [b, q] of texts.slice(i + 1))
        if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 3 && q.top < p.bottom - 3)
          found.push(`${svg.id}: "${a}" lies on "${b}"`);
    });
  }
  return found;
})()"""


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

    def wait(self, method):
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.read())


def colours(png):
    """How many different colours a small PNG has."""
    place, data, header = 8, b"", None
    while place < len(png):
        length, kind = struct.unpack(">I4s", png[place:place + 8])
        chunk = png[place + 8:place + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"IDAT":
            data += chunk
        place += 12 + length
    width, height, _, kind = header[:4]
    step = {2: 3, 6: 4}[kind]
    raw, stride = zlib.decompress(data), width * step
    seen, above = set(), bytearray(stride)
    for row in range(height):
        start = row * (stride + 1)
        rule, line = raw[start], bytearray(raw[start + 1:start + 1 + stride])
        for i in range(stride):
            left = line[i - step] if i >= step else 0
            up, corner = above[i], above[i - step] if i >= step else 0
            if rule == 1:
                line[i] = (line[i] + left) & 255
            elif rule == 2:
                line[i] = (line[i] + up) & 255
            elif rule == 3:
                line[i] = (line[i] + (left + up) // 2) & 255
            elif rule == 4:
                guess = left + up - corner
                near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))
                line[i] = (line[i] + near[2]) & 255
        seen.update(bytes(line[i:i + 3]) for i in range(0, stride, step))
        above = line
    return len(seen)


def look(page, picture, width):
    wanted = pathlib.Path(page).resolve().as_uri()
    faults = []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(profile)
        try:
            target = browser.ask("Target.createTarget", url="about:blank")["targetId"]
            tab = browser.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for domain in ("Page", "Runtime", "Log", "Network"):
                browser.ask(f"{domain}.enable", tab)
            browser.ask("Emulation.setDeviceMetricsOverride", tab,
                        width=width, height=900, deviceScaleFactor=1, mobile=False)
            browser.ask("Page.navigate", tab, url=wanted)
            browser.wait("Page.loadEventFired")
            inspected = browser.ask("Runtime.evaluate", tab, expression=INSPECT, returnByValue=True)
            faults += inspected["result"].get("value", ["the page could not be inspected"])
            size = browser.ask("Page.getLayoutMetrics", tab)["cssContentSize"]
            area = {"x": 0, "y": 0, "width": width, "height": size["height"]}

            def shoot(scale):
                shot = browser.ask("Page.captureScreenshot", tab, format="png", captureBeyondViewport=True,
                                   clip={**area, "scale": scale})
                return base64.b64decode(shot["data"])

            pathlib.Path(picture).write_bytes(shoot(1))
            if colours(shoot(0.1)) < 8:
                faults.append("the picture is blank")
            browser.ask("Page.disable", tab)  # everything logged so far has arrived with this answer
            for event in browser.events:
                faults += complaints(event, wanted)
            browser.ask("Browser.close")
        finally:
            try:
                browser.process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                browser.process.kill()
    return faults


def complaints(event, wanted):
    method, params = event.get("method"), event.get("params", {})
    if method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
        yield f"{params['entry']['source']}: {params['entry']['text']}"
    elif method == "Runtime.exceptionThrown":
        yield f"script: {params['exceptionDetails']['text']}"
    elif method == "Runtime.consoleAPICalled":
        yield f"console: {params['type']}"
    elif method == "Network.requestWillBeSent" and params["request"]["url"] != wanted:
        yield f"asks for {params['request']['url'][:200]}"


def main():
    page, picture, width = sys.argv[1], sys.argv[2], int(sys.argv[3])
    faults = look(page, picture, width)
    for fault in faults:
        print(f"{page}: {fault}", file=sys.stderr)
    if faults:
        raise SystemExit(1)
    print(f"{picture}: {width} px wide, no complaint")


main()
