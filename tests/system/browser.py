"""A headless Chromium for tests: it opens a page, and tells what the page asked the network for, what it complained about,
and what is on it. Spoken to by the DevTools protocol over two pipes, so nothing but Chromium and Python is needed."""
import base64
import json
import os
import select
import shutil
import signal
import subprocess
import time

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-dev-shm-usage", "--no-first-run",
         "--no-default-browser-check", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-default-apps", "--disable-extensions", "--mute-audio", "--hide-scrollbars"]


def program():
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    """One page. `requests` are the addresses it asked for, `complaints` its errors, both since the last open()."""

    def __init__(self, folder, patience=30.0):
        self.patience, self.last, self.rest = patience, 0, b""
        self.requests, self.complaints, self.seen = [], [], []
        to_browser, from_browser = os.pipe(), os.pipe()
        keep = [os.dup2(to_browser[0], 193), os.dup2(from_browser[1], 194)]   # out of the way of 3 and 4
        command = [program(), *FLAGS, f"--user-data-dir={folder}", "--remote-debugging-pipe", "about:blank"]
        self.process = subprocess.Popen(["bash", "-c", 'exec "$@" 3<&193 4>&194 193<&- 194>&-', "bash", *command], pass_fds=keep,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        for end in (*keep, to_browser[0], from_browser[1]):
            os.close(end)
        self.writer, self.reader = to_browser[1], from_browser[0]
        self.session = None
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.ask(f"{domain}.enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.writer)   # Chromium ends when its pipe does
        os.close(self.reader)
        try:
            self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def receive(self, until):
        """The next message, noted if it is an event."""
        while b"\0" not in self.rest:
            if not select.select([self.reader], [], [], max(0.0, until - time.monotonic()))[0]:
                raise TimeoutError(f"Chromium was silent for {self.patience} s")
            more = os.read(self.reader, 1 << 20)
            if not more:
                raise RuntimeError("Chromium has ended")
            self.rest += more
        one, self.rest = self.rest.split(b"\0", 1)
        message = json.loads(one)
        self.note(message.get("method", ""), message.get("params", {}))
        return message

    def note(self, method, told):
        self.seen.append(method)
        if method == "Network.requestWillBeSent":
            self.requests.append(told["request"]["url"])
        elif method == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
            self.complaints.append(told["entry"]["text"])
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(told["exceptionDetails"]["text"])
        elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.complaints.append(" ".join(str(part.get("value")) for part in told["args"]))

    def ask(self, method, **parameters):
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.writer, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + self.patience
        while True:
            answer = self.receive(until)
            if answer.get("id") == self.last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def open(self, address):
        """Loads a page with all that belongs to it."""
        self.requests, self.complaints, self.seen = [], [], []
        self.ask("Page.navigate", url=address)
        until = time.monotonic() + self.patience
        while "Page.loadEventFired" not in self.seen:
            self.receive(until)
        self.value("new Promise(done => setTimeout(done, 100))")   # what comes late, comes now

    def value(self, script):
        """What a piece of JavaScript gives on the page."""
        answer = self.ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"])
        return answer["result"].get("value")

    def look(self, width, height=900, dark=False):
        """How wide the window is, and whether the reader likes it dark."""
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def screenshot(self, path):
        """The whole page as a PNG."""
        shot = self.ask("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot["data"]))
