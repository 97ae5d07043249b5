"""Generated JavaScript in one Node.js process; numbers cross as bytes, so that none is rounded."""

import json
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

NODE = shutil.which("node")

DRIVER = """\
import { readFileSync, writeFileSync } from "node:fs";
const jobs = JSON.parse(readFileSync("jobs.json", "utf8"));
const bytes = readFileSync("in.bin");
const values = new Float64Array(bytes.buffer, bytes.byteOffset, bytes.length / 8);
const results = [];
let at = 0;
const take = (n) => { at += n; return values.subarray(at - n, at); };
for (const job of jobs) {
  const module = await import("./" + job.module);
  for (let k = 0; k < job.points; ++k) {
    const [t] = take(1);
    const [x, p, u] = job.sizes.map(take);
    results.push(...module[job.group](t, x, p, u));
  }
}
writeFileSync("out.bin", Buffer.from(Float64Array.from(results).buffer));
"""


class Job(NamedTuple):
    """One function of a module, and the points (t, x, p, u) where it is evaluated."""

    text: str
    group: str
    points: list
    size: int


def run(jobs):
    """Return for each job an array of shape (points, size)."""
    described, values = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        texts = dict.fromkeys(job.text for job in jobs)
        files = {text: f"m{k}.mjs" for k, text in enumerate(texts)}
        for text, file in files.items():
            (folder / file).write_text(text, encoding="ascii")
        for text, group, points, _ in jobs:
            sizes = [len(a) for a in points[0][1:]]
            described.append(
                {"module": files[text], "group": group, "points": len(points), "sizes": sizes}
            )
            values += [[t, *x, *p, *u] for t, x, p, u in points]
        (folder / "jobs.json").write_text(json.dumps(described))
        np.concatenate(values).astype(float).tofile(folder / "in.bin")
        (folder / "driver.mjs").write_text(DRIVER)
        done = subprocess.run(
            [NODE, "driver.mjs"], cwd=folder, check=False, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        flat = np.fromfile(folder / "out.bin")
    ends = np.cumsum([len(job.points) * job.size for job in jobs])
    assert flat.size == ends[-1]
    return [
        part.reshape(len(job.points), job.size)
        for job, part in zip(jobs, np.split(flat, ends[:-1]), strict=True)
    ]
