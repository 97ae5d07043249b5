"""Generated MATLAB text in one process of GNU Octave; numbers cross as bytes, so that none is rounded."""

import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

OCTAVE = shutil.which("octave-cli") or shutil.which("octave")

AT_EXIT = "error: ignoring const execution_exception& while preparing to exit"
"""What version 7 says in every run."""
DRIVER = """\
source = fopen("in.bin", "r");
target = fopen("out.bin", "w");
jobs = {JOBS};
for k = 1:size(jobs, 1)
    [folder, name, group, sizes] = jobs{k, :};
    addpath(folder);
    made = feval(name);
    count = sizes(1);
    values = cell(1, 4);
    for j = 1:4
        values{j} = zeros(sizes(j + 1), count);
        values{j}(:) = fread(source, numel(values{j}), "double");
    end
    together = made.(group)(values{:});
    alone = zeros(size(together));
    for n = 1:count
        one = cellfun(@(v) v(:, min(n, end)), values, "UniformOutput", false);
        alone(:, n) = made.(group)(one{:});
    end
    assert(isreal(together) && isreal(alone), [name " is not real"]);
    rmpath(folder);
    clear(name);
    fwrite(target, [together(:); alone(:)], "double");
end
"""


class Job(NamedTuple):
    """One function of a file, and the points (t, x, p, u) where it is evaluated."""

    text: str
    group: str
    points: list
    size: int


def run(jobs):
    """Return for each job the results, (points, size), of all points together and one by one."""
    with tempfile.TemporaryDirectory() as name:
        folder, rows, values = Path(name), [], []
        for k, job in enumerate(jobs):
            stem = job.text.split("(")[0].split()[-1]
            (folder / f"m{k}").mkdir()
            (folder / f"m{k}" / f"{stem}.m").write_text(job.text, encoding="ascii")
            sizes = [len(job.points), 1, *(len(a) for a in job.points[0][1:])]
            rows.append(f"'m{k}', '{stem}', '{job.group}', {sizes}")
            values += [np.ravel([t for t, *_ in job.points])]
            values += [np.ravel([point[j] for point in job.points]) for j in (1, 2, 3)]
        np.concatenate(values).astype(float).tofile(folder / "in.bin")
        (folder / "driver.m").write_text(DRIVER.replace("JOBS", "; ".join(rows)))
        command = [OCTAVE, "--no-gui", "--quiet", "--no-init-file", "driver.m"]
        done = subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)
        said = done.stderr.replace(AT_EXIT, "").strip()
        assert not said, said  # a warning is one too many
        flat = np.fromfile(folder / "out.bin")
    results = []
    for job in jobs:
        count = len(job.points) * job.size
        parts = flat[:count], flat[count : 2 * count]
        results.append(tuple(part.reshape(len(job.points), job.size) for part in parts))
        flat = flat[2 * count :]
    assert not flat.size
    return results
