"""Drives the dashboard in a real browser over the DevTools protocol: tests/browser.py PAGE FOLDER.

What it asserts is what a person would see and do: at a phone's width and a desk's, light and dark, with keys and clicks.
Screenshots are left in FOLDER. Only Python's own library is used.
"""

import base64
import fcntl
import json
import os
import select
import subprocess
import sys
import time
import urllib.request

PAGE, FOLDER = sys.argv[1:3]
WAIT_S = 20
SIZES = [(375, 812), (1440, 1000)]


class Browser:
    """One page of a headless browser, driven through a pipe."""

    def __init__(self):
        # The browser reads from 3 and writes to 4: the ends of the pipes stay clear of both.
        low = (*os.pipe(), *os.pipe())
        read, self.out, self.into, write = [fcntl.fcntl(fd, fcntl.F_DUPFD, 10) for fd in low]
        for end in low:
            os.close(end)
        flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-pipe"]
        command = ["chromium", *flags, f"--user-data-dir={FOLDER}/driven", "about:blank"]
        redirected = f'exec "$@" 3<&{read} 4>&{write} {read}<&- {write}>&-'
        self.log = open(f"{FOLDER}/driven.log", "wb")
        self.process = subprocess.Popen(
            ["bash", "-c", redirected, "browser", *command], pass_fds=(read, write), stdout=self.log, stderr=self.log
        )
        os.close(read)
        os.close(write)
        self.buffer, self.last, self.session, self.errors = b"", 0, None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call("Page.bringToFront")
        self.call("Emulation.setFocusEmulationEnabled", enabled=True)

    def call(self, method, **params):
        """The result of a command."""
        self.last += 1
        message = {"id": self.last, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.last:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            if answer.get("method") == "Runtime.exceptionThrown":
                self.errors.append(answer["params"]["exceptionDetails"])
            if answer.get("method") == "Log.entryAdded" and answer["params"]["entry"]["level"] == "error":
                self.errors.append(answer["params"]["entry"])

    def receive(self):
        """The next message of the browser."""
        while b"\0" not in self.buffer:
            assert select.select([self.into], [], [], WAIT_S)[0], f"the browser said nothing for {WAIT_S} s"
            more = os.read(self.into, 1 << 16)
            assert more, "the browser ended"
            self.buffer += more
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def eval(self, expression):
        """The value of an expression in the page."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in result, f"{expression}: {result['exceptionDetails']}"
        return result["result"].get("value")

    def wait(self, expression, what):
        """Waits until an expression holds, and returns its value."""
        end = time.monotonic() + WAIT_S
        while time.monotonic() < end:
            try:
                if value := self.eval(expression):
                    return value
            except AssertionError:
                pass  # Between two pages there is nothing to evaluate in.
            time.sleep(0.05)
        raise AssertionError(f"{what}: not within {WAIT_S} s; the page says: {self.eval('document.body.innerText')[:2000]}")

    def press(self, key):
        """Presses and releases a key."""
        code = {"Tab": 9, "ArrowLeft": 37, "Enter": 13}[key]
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)

    def show(self, size, scheme, path, ready):
        """Opens a page at a size in a colour scheme, and waits until something is there."""
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=size[0] < 500)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=PAGE + path)
        self.wait(f"document.querySelector({json.dumps(ready)}) !== null", f"{path} at {size[0]} px")

    def picture(self, name):
        """A screenshot of the whole page."""
        data = self.call("Page.captureScreenshot", captureBeyondViewport=True)["data"]
        with open(f"{FOLDER}/{name}.png", "wb") as file:
            file.write(base64.b64decode(data))

    def close(self):
        """Ends the browser."""
        self.process.terminate()
        self.process.wait(20)


def api(path):
    """A document of the service."""
    with urllib.request.urlopen(f"{PAGE}v1{path}", timeout=20) as answer:
        return json.load(answer)


def text(selector):
    """An expression: the text of every element that a selector finds."""
    return f"[...document.querySelectorAll({json.dumps(selector)})].map((each) => each.textContent).join('|')"


def no_sideways(browser, where):
    """The page does not scroll to the side."""
    wide, room = browser.eval("[document.documentElement.scrollWidth, document.documentElement.clientWidth]")
    assert wide <= room, f"{where}: the page is {wide} px wide on a screen of {room} px"


def fleet(browser, size, scheme):
    """Every row and every alert that is not cleared is there, and the count leads to the list."""
    browser.show(size, scheme, "", ".rows .row")
    browser.wait("document.querySelectorAll('.rows .row').length === 8", "eight rows")
    alerts = [alert for state in ("open", "acknowledged") for alert in api(f"/alerts?state={state}")["items"]]
    alerts.sort(key=lambda alert: alert["raised_at"], reverse=True)
    assert alerts, "the demo has no alert that is not cleared"
    listed = browser.eval("[...document.querySelectorAll('#alerts .alert-link')].map((each) => each.hash)")
    expected = [f"#/actuators/{alert['actuator_id']}" for alert in alerts]
    assert listed == expected, f"alerts: found {listed}, expected {expected}"
    flagged = browser.eval("document.querySelectorAll('.row .flag').length")
    assert flagged == len({alert["actuator_id"] for alert in alerts}), f"rows with alerts: found {flagged}"
    browser.eval("document.getElementById('alarm').click()")
    browser.wait("document.activeElement.id === 'alerts'", "the count of alerts leads to their list")
    no_sideways(browser, f"the fleet at {size[0]} px")
    browser.picture(f"fleet-{size[0]}-{scheme}")


def actuator(browser, size, scheme, id, name):
    """The answer comes first, with when to act; the trend is drawn, told in words, and follows the keys."""
    browser.show(size, scheme, f"#/actuators/{id}", "[data-key=trend] .plot .trend")
    act_by = api(f"/actuators/{id}/remaining-life")["act_by"]
    said = browser.eval(text(".act-by"))
    assert act_by["date"][:10] in said and "for a risk of 5 %" in said, f"{name}: when to act: found {said}"
    dated = browser.eval(text(".dates"))
    assert all(word in dated for word in ("5 % quantile", "Median", "95 % quantile")), f"{name}: dates: found {dated}"
    rows = api(f"/actuators/{id}/remaining-life/trend")["items"]
    lives = len({row["life_started_at"] for row in rows})
    drawn = browser.eval("document.querySelectorAll('[data-key=trend] .plot .trend').length")
    assert drawn == lives, f"{name}: lives in the trend: found {drawn}, expected {lives}"
    told = browser.eval("document.querySelector('[data-key=trend] .plot svg').getAttribute('aria-label')")
    assert f"{len(rows)} forecasts in {lives} li" in told, f"{name}: the trend in words: found {told}"
    table = browser.eval("document.querySelectorAll('[data-key=trend] tbody tr').length")
    assert table == len(rows), f"{name}: rows of the trend's table: found {table}, expected {len(rows)}"
    browser.eval("document.querySelector('[data-focus=scrub-trend]').focus()")
    browser.press("ArrowLeft")
    read = browser.eval("document.activeElement.getAttribute('aria-valuetext')")
    assert f"at {rows[-2]['usage']:.0f} flight hours" in read, f"{name}: the trend's read-out: found {read}"
    browser.eval("document.activeElement.blur()")
    no_sideways(browser, f"{name} at {size[0]} px")
    browser.picture(f"{name}-{size[0]}-{scheme}")


def acknowledge(browser, id):
    """A failed acknowledgement says so and keeps the note; one that works is kept by the service."""
    browser.show(SIZES[0], "light", f"#/actuators/{id}", ".answering button")
    browser.eval("document.querySelector('.answering input').focus()")
    browser.call("Input.insertText", text="part ordered")
    browser.press("Tab")
    assert browser.eval("document.activeElement.textContent") == "Acknowledge", "the key Tab does not reach the button"
    browser.eval("window.kept = fetch; window.fetch = () => Promise.reject(new TypeError('cut off')); null")
    browser.eval("document.activeElement.click()")
    browser.wait("document.querySelector('.answering .failure')?.textContent.includes('cannot be reached')", "the failure")
    browser.eval("window.fetch = window.kept; null")
    assert browser.eval("document.querySelector('.answering input').value") == "part ordered", "the note is lost"
    browser.eval("document.querySelector('.answering button').click()")
    browser.wait("document.querySelector('.alert[data-state=acknowledged]') !== null", "the acknowledgement")
    kept = api(f"/actuators/{id}/alerts?state=acknowledged")["items"]
    assert [alert["note"] for alert in kept] == ["part ordered"], f"acknowledged alerts: found {kept}"


def main():
    ids = {row["serial_number"]: row["id"] for row in api("/actuators")["items"]}
    browser = Browser()
    try:
        for size, scheme in [(SIZES[0], "light"), (SIZES[0], "dark"), (SIZES[1], "light"), (SIZES[1], "dark")]:
            fleet(browser, size, scheme)
            actuator(browser, size, scheme, ids["EHSA-2001"], "alerted")
            actuator(browser, size, scheme, ids["EHSA-2003"], "replaced")
        assert "Cleared" in browser.eval(text(".alert")), "the cleared alert of the replaced part is not shown"
        actuator(browser, SIZES[0], "light", ids["EHSA-1002"], "healthy")
        assert browser.eval(text("[data-key=alerts]")).startswith("No open alert"), "the healthy one has an alert"
        actuator(browser, SIZES[0], "light", ids["EHSA-1003"], "outlier")
        noted = browser.eval(text("[data-key=fdj_n] .noted"))
        assert "usage 640 lies" in noted, f"the outlier is not told: found {noted}"
        assert browser.eval("document.querySelectorAll('.observations .outlier').length") == 1, "the outlier is not marked"
        acknowledge(browser, ids["EHSA-2001"])
        assert not browser.errors, f"the page has errors: {browser.errors}"
    finally:
        browser.close()


main()
