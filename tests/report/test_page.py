"""The report of a small build: one file, nothing fetched, what it says is what the build found; a browser finds no fault."""

import json
import re
import shutil
import subprocess
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from queue import Empty, Queue
from threading import Thread
from typing import Any

import pytest
from typer.testing import CliRunner

from floorplan.build import Job, build
from floorplan.cli import app
from floorplan.simulate import simulate

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
MOST_BYTES = 10_000_000
ANSWER_S = 120  # a page that has not answered by then never will
PROBE = """<script>
document.querySelector('[data-id^="R"]').dispatchEvent(new MouseEvent('click', {bubbles: true}));
document.getElementById('in').click(); document.getElementById('dims').click();
requestAnimationFrame(() => requestAnimationFrame(() => fetch('/found', {method: 'POST', body: JSON.stringify({
  faults: window.faults, chosen: document.querySelector('#told h3').textContent,
  same_view: document.getElementById('drawing').getAttribute('viewBox') === window.first,
  dims: document.getElementById('dims').getAttribute('aria-pressed'),
  fits: document.documentElement.scrollWidth <= window.innerWidth,
  named: [...document.querySelectorAll('button,[role=button],[role=img]')]
    .every(e => (e.getAttribute('aria-label') || e.textContent).trim())
})})));
</script>"""
WATCH = "<script>window.faults = []; window.onerror = m => { window.faults.push(m); };</script>"
FIRST = "<script>window.first = document.getElementById('drawing').getAttribute('viewBox');</script>"


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished build of a flat, small images."""
    folder = tmp_path_factory.mktemp("report")
    simulate(folder / "flat", "flat", 1, rate_hz=4.0, image_scale=0.3)
    assert build(Job(folder / "flat", folder / "work")) is not None
    return folder / "work"


@pytest.fixture(scope="module")
def page(work: Path) -> str:
    """The page, with a table of measured distances."""
    plan = json.loads((work / "plan.json").read_text("utf-8"))
    rows = [f"{d['id']},{d['distance_m'] + 0.004:.4f}" for d in plan["dimensions"][:3]]
    (work.parent / "laser.csv").write_text("id,measured_m\n" + "\n".join([*rows, "D999,1.0"]) + "\n", "utf-8")
    result = CliRunner().invoke(app, ["report", str(work), str(work.parent / "r.html"), "--laser", str(work.parent / "laser.csv")])
    assert result.exit_code == 0, result.output
    assert "D999" in result.stderr
    return (work.parent / "r.html").read_text("utf-8")


def test_it_is_one_file_that_fetches_nothing(page: str) -> None:
    assert 20_000 < len(page.encode()) < MOST_BYTES
    assert not re.findall(r"""(?:src|href)\s*=\s*["'](?!#|data:,)""", page)
    assert "http://" not in page
    assert "https://" not in page
    assert "@import" not in page


def test_every_thing_of_the_plan_can_be_clicked_and_has_its_numbers(work: Path, page: str) -> None:
    plan = json.loads((work / "plan.json").read_text("utf-8"))
    told = json.loads(page.split('id="details">')[1].split("</script>")[0])
    drawn = set(re.findall(r'data-id="([A-Z]\d+)"', page))
    for kind in ("rooms", "walls", "openings", "dimensions"):
        ids = {one["id"] for one in plan[kind] if one.get("role") != "height"}
        assert ids <= set(told)
        assert ids & drawn == ids
    assert drawn <= set(told)
    first = plan["dimensions"][0]
    assert f"{first['distance_m']:.3f} m" in told[first["id"]][1]
    assert "frames" in told[first["id"]][-1]


def test_all_sections_are_there(page: str) -> None:
    for id in ("plan", "steps", "accuracy", "check", "merges", "residuals", "coverage", "made"):
        assert f'<h2 id="{id}"' in page
    assert page.count("<figure>") == 4
    assert "LOA" in page
    assert "D999" in page
    assert "returns_to_start" in page


def test_a_hostile_name_stays_text(work: Path, tmp_path: Path) -> None:
    out = tmp_path / "r.html"
    result = CliRunner().invoke(app, ["report", str(work), str(out), "--set", "project.name=</script><b>x</b>"])
    assert result.exit_code == 0
    assert "<b>x</b>" not in out.read_text("utf-8")


@pytest.mark.parametrize("size", ["1280,900", "500,800"])
def test_a_browser_finds_no_fault_and_clicks_work(page: str, tmp_path: Path, size: str) -> None:
    browser = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if browser is None:
        pytest.skip("no Chromium on this machine: the page was not tried in a browser")
    data = '<script type="application/json"'
    probed = page.replace("<head>", "<head>" + WATCH, 1).replace(data, FIRST + data, 1)
    found = _told_by_browser(browser, probed.replace("</body>", PROBE + "</body>"), size, tmp_path / "profile")
    assert re.match(r"(Room|Corridor) R\d+", found.pop("chosen"))
    assert found == {"faults": [], "same_view": False, "dims": "false", "fits": True, "named": True}


def _told_by_browser(browser: str, page: str, size: str, profile: Path) -> dict[str, Any]:
    """What the probe in `page` posts back: waited for in real time, for a busy machine draws its first frame late."""
    told: Queue[dict[str, Any]] = Queue()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            content = page.encode() if self.path == "/" else b""
            self.send_response(200 if content else 404)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            self.wfile.write(content)

        def do_POST(self) -> None:
            told.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, format: str, *args: object) -> None:
            """Nothing on stderr."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    Thread(target=server.serve_forever, daemon=True).start()
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-proxy-server", "--no-first-run"]
    options += [f"--window-size={size}", f"--user-data-dir={profile}"]
    with subprocess.Popen([browser, *options, f"http://127.0.0.1:{server.server_port}/"], stderr=subprocess.PIPE) as process:
        try:
            return told.get(timeout=ANSWER_S)
        except Empty:
            process.kill()
            pytest.fail(f"the page did not answer within {ANSWER_S} s; the browser said: {process.stderr.read().decode()[-2000:]}")
        finally:
            process.kill()
            server.shutdown()
            server.server_close()
