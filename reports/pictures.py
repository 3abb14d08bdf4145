#!/usr/bin/env python3
"""The README's pictures: its first commands as they stand there, and what their pages show of it.

pictures.py PROGRAM     runs the commands in an empty folder and writes reports/pictures/*.webp. Needs chromium."""
import base64
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
WIDTH = 780
# Heading of the README, name of the picture, and which figures of the page are shown below its first sentence.
PICTURES = (("Is this simulation right?", "run", "figure:nth-of-type(1)"),
            ("It disagrees with the measurement: why?", "diagnosis", "figure:nth-of-type(2)"),
            ("Is it fast enough for 10 kHz?", "budget", "figure:nth-of-type(1)"))
SHOW = """(async (chosen) => {
  const keep = [...document.querySelectorAll(chosen)], main = document.querySelector('main'), lead = main.querySelector('.lead');
  for (const host of keep) host.querySelector('.plot').drawNow();
  document.getElementById('theme').remove();
  const pictures = document.createElement('div');
  pictures.className = 'pictures';
  pictures.append(...keep);
  main.replaceChildren(lead, pictures);
  document.querySelector('footer').remove();
  await new Promise((done) => setTimeout(done, 500));
  return document.body.getBoundingClientRect().height;
})"""


class Browser:
    """Chromium without a window, asked through its DevTools pipe."""

    def __init__(self, profile):
        to_browser, self.write = os.pipe()
        self.read, from_browser = os.pipe()
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$0" "$@" 3<&{to_browser} 4>&{from_browser}', os.environ.get("DYNOPROOF_BROWSER", "/usr/bin/chromium"),
             "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run",
             "--disable-background-networking", "--remote-debugging-pipe", f"--user-data-dir={profile}", "about:blank"],
            pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.count, self.rest, self.session = 0, b"", {}
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = {"sessionId": self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]}

    def call(self, method, **parameters):
        self.count += 1
        os.write(self.write, json.dumps({"id": self.count, "method": method, "params": parameters, **self.session}).encode() + b"\0")
        while True:
            while b"\0" not in self.rest:
                self.rest += os.read(self.read, 1 << 20)
            text, self.rest = self.rest.split(b"\0", 1)
            answer = json.loads(text)
            if answer.get("id") == self.count:
                return answer["result"]

    def ask(self, expression):
        return self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)["result"].get("value")

    def picture(self, page, chosen):
        self.call("Emulation.setDeviceMetricsOverride", width=WIDTH, height=900, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
        self.call("Page.navigate", url=page.as_uri())
        while self.ask("document.readyState") != "complete":
            pass
        height = self.ask(f"{SHOW}({json.dumps(chosen)})")
        clip = {"x": 0, "y": 0, "width": WIDTH, "height": height, "scale": 1}
        return base64.b64decode(self.call("Page.captureScreenshot", format="webp", quality=90, captureBeyondViewport=True, clip=clip)["data"])


def main(program):
    text = (ROOT / "README.md").read_text()
    folder_of_pictures = ROOT / "reports/pictures"
    folder_of_pictures.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        (pathlib.Path(folder) / "build").symlink_to(pathlib.Path(program).resolve().parent)
        browser = Browser(profile)
        for heading, name, chosen in PICTURES:
            (script,) = re.findall(r"```sh\n(.*?)```", text.split(f"## {heading}\n")[1].split("\n## ")[0], re.S)
            subprocess.run(["bash", "-c", script], cwd=folder, stdout=subprocess.DEVNULL)  # one of them is to fail
            page = pathlib.Path(folder) / re.findall(r"--html (\S+)", script)[-1]
            picture = folder_of_pictures / f"{name}.webp"
            picture.write_bytes(browser.picture(page, chosen))
            print(picture.relative_to(ROOT), picture.stat().st_size, "bytes")
        browser.process.kill()
        browser.process.wait()


if len(sys.argv) != 2:
    sys.exit(__doc__)
main(sys.argv[1])
