"""Drives headless Chromium through the DevTools protocol with nothing but Python's standard library.

Commands and events are JSON texts, each ended by a NUL byte, over the pipes that --remote-debugging-pipe opens as file
descriptors 3 (to the browser) and 4 (from it). https://chromedevtools.github.io/devtools-protocol/
"""

import base64
import fcntl
import json
import os
import select
import shutil
import struct
import subprocess
import tempfile
import time
import zlib

PROGRAMS = ["chromium-headless-shell", "chromium", "google-chrome"]
# Keys by name: code, Windows key code, text.
KEYS = {
    "ArrowLeft": ("ArrowLeft", 37, ""), "ArrowUp": ("ArrowUp", 38, ""), "ArrowRight": ("ArrowRight", 39, ""),
    "ArrowDown": ("ArrowDown", 40, ""), "Home": ("Home", 36, ""), "End": ("End", 35, ""),
    "Tab": ("Tab", 9, ""), "Escape": ("Escape", 27, ""),
    "Enter": ("Enter", 13, "\r"), " ": ("Space", 32, " "), "x": ("KeyX", 88, "x"), "i": ("KeyI", 73, "i"),
    **{str(d): (f"Digit{d}", 48 + d, str(d)) for d in range(10)},
}


def find_browser():
    """The first program that is installed, or None."""
    return next((path for path in map(shutil.which, PROGRAMS) if path), None)


def pipe_above(lowest):
    """A pipe whose two ends lie above the descriptors that the browser expects."""
    ends = os.pipe()
    moved = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, lowest) for end in ends]
    for end in ends:
        os.close(end)
    return moved


class Browser:
    """One browser process; a context manager."""

    def __init__(self, program):
        self.profile = tempfile.mkdtemp(prefix="pelage-web-")
        to_read, self.to_write = pipe_above(10)
        self.from_read, from_write = pipe_above(10)

        def connect():
            os.dup2(to_read, 3)
            os.dup2(from_write, 4)

        arguments = [program, "--headless", "--remote-debugging-pipe", f"--user-data-dir={self.profile}", "--no-first-run",
                     "--disable-gpu", "--disable-dev-shm-usage", "--force-color-profile=srgb", "--hide-scrollbars"]
        if os.geteuid() == 0:
            arguments.append("--no-sandbox")
        self.process = subprocess.Popen(arguments, preexec_fn=connect, close_fds=False, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(from_write)
        self.buffer, self.events, self.last_id = b"", [], 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close", timeout=5)
            self.process.wait(5)
        except (OSError, RuntimeError, TimeoutError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.to_write)
        os.close(self.from_read)
        shutil.rmtree(self.profile, ignore_errors=True)

    def receive(self, deadline):
        """The next message."""
        while b"\0" not in self.buffer:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.from_read], [], [], left)[0]:
                raise TimeoutError("the browser does not answer")
            part = os.read(self.from_read, 1 << 20)
            if not part:
                raise RuntimeError(f"the browser ended: exit code {self.process.poll()}")
            self.buffer += part
        message, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(message)

    def call(self, method, session=None, timeout=30, **parameters):
        """Sends a command; its result. Events that arrive meanwhile are kept."""
        self.last_id += 1
        command = {"id": self.last_id, "method": method, "params": parameters}
        if session:
            command["sessionId"] = session
        text = json.dumps(command).encode() + b"\0"
        while text:
            text = text[os.write(self.to_write, text):]
        deadline = time.monotonic() + timeout
        while True:
            answer = self.receive(deadline)
            if answer.get("id") == self.last_id:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, session, method, timeout=30):
        """Parameters of the session's next event of that name, from those kept or to come."""
        deadline = time.monotonic() + timeout
        while True:
            for event in self.events:
                if event.get("sessionId") == session and event.get("method") == method:
                    self.events.remove(event)
                    return event["params"]
            self.events.append(self.receive(deadline))


class Page:
    """A tab of its own, with what it said and asked for."""

    def __init__(self, browser, width=1280, height=900, dark=False, script=True):
        self.browser, self.script = browser, script
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setScriptExecutionDisabled", value=not script)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.resize(width, height)

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)

    def resize(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, path):
        self.call("Page.navigate", url=path.resolve().as_uri())
        self.browser.wait_for(self.session, "Page.loadEventFired")
        self.settle()

    def settle(self):
        """Until what was asked for is drawn."""
        if self.script:
            self.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def evaluate(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def press(self, x, y):
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)

    def release(self, x, y):
        self.mouse("mouseReleased", x, y, button="left", clickCount=1)
        self.settle()

    def click(self, x, y):
        self.press(x, y)
        self.release(x, y)

    def drag(self, start, end, steps=5):
        self.press(*start)
        for i in range(1, steps + 1):
            self.mouse("mouseMoved", *(a + (b - a) * i / steps for a, b in zip(start, end)), button="left", buttons=1)
        self.release(*end)

    def wheel(self, x, y, delta):
        """One notch. The mouse comes from elsewhere: Chromium takes made-up wheel events in quick succession at one place
        for one scroll, of which the page may cancel only the first."""
        self.mouse("mouseMoved", 1, 1)
        self.mouse("mouseMoved", x, y)
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=delta)
        self.settle()

    def key(self, name, shift=False):
        code, number, text = KEYS[name]
        same = {"key": name, "code": code, "windowsVirtualKeyCode": number, "modifiers": 8 if shift else 0}
        self.call("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", text=text, **same)
        self.call("Input.dispatchKeyEvent", type="keyUp", **same)
        self.settle()

    def box(self, selector):
        """left, top, width, height of an element in the window, scrolled to be seen."""
        return self.evaluate(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block: 'center'}});"
            " const r = e.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()")

    def click_on(self, selector):
        left, top, width, height = self.box(selector)
        self.click(left + width / 2, top + height / 2)

    def screenshot(self, file=None, whole=False):
        """PNG bytes, written to `file` where one is named."""
        more = {}
        if whole:
            size = self.call("Page.getLayoutMetrics")["cssContentSize"]
            more = {"captureBeyondViewport": True, "clip": {**size, "scale": 1}}
        data = base64.b64decode(self.call("Page.captureScreenshot", format="png", **more)["data"])
        if file:
            file.write_bytes(data)
        return data

    def pixels(self, left, top, width=1, height=1, scale=1):
        """Rows of (red, green, blue) of a part of the window, as it is seen."""
        clip = {"x": left + self.evaluate("scrollX"), "y": top + self.evaluate("scrollY"), "width": width, "height": height}
        data = self.call("Page.captureScreenshot", format="png", clip={**clip, "scale": scale})["data"]
        return decode_png(base64.b64decode(data))

    def pixel(self, x, y):
        return self.pixels(x, y)[0][0]

    def complaints(self):
        """What was written to the console or log as an error, exceptions, and requests that leave the page."""
        self.settle()
        found = []
        for event in [e for e in self.browser.events if e.get("sessionId") == self.session]:
            method, parameters = event["method"], event["params"]
            if method == "Runtime.exceptionThrown":
                found.append(parameters["exceptionDetails"])
            elif method == "Runtime.consoleAPICalled":
                found.append(parameters["args"])
            elif method == "Log.entryAdded":
                found.append(parameters["entry"]["text"])
            elif method == "Network.requestWillBeSent" and parameters.get("type") != "Document":
                if not parameters["request"]["url"].startswith("data:"):
                    found.append(parameters["request"]["url"])
        return found


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def decode_png(data):
    """Rows of (red, green, blue) of a PNG of 8 bits, RGB or RGBA, not interlaced [PNG specification, section 9]."""
    position, packed = 8, b""
    while position < len(data):
        size, kind = struct.unpack(">I4s", data[position:position + 8])
        body = data[position + 8:position + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            if depth != 8 or colour not in (2, 6) or interlaced:
                raise ValueError("a PNG that this reader does not know")
        elif kind == b"IDAT":
            packed += body
        position += 12 + size
    step = 3 if colour == 2 else 4
    raw, stride = zlib.decompress(packed), width * step
    rows, above = [], bytearray(stride)
    for y in range(height):
        filter_type, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up, corner = (line[x - step] if x >= step else 0), above[x], (above[x - step] if x >= step else 0)
            line[x] = (line[x] + (0, left, up, (left + up) // 2, paeth(left, up, corner))[filter_type]) & 255
        rows.append([tuple(line[x:x + 3]) for x in range(0, stride, step)])
        above = line
    return rows
