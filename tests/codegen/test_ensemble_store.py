"""Chunks on disk and clusters: nothing lost, nothing computed twice, damage found, clear errors."""

import json
import os
import signal
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen import Normal, Sampler, Statistics, Uniform
from codegen import compile as compile_system
from codegen.ensembles import ensemble as crews
from codegen.ensembles import store
from codegen.native import native
from eom.errors import InputError
from eom.system import System

pytestmark = [pytest.mark.sparse, pytest.mark.skipif(not native.compiler(), reason="runs C")]
y1, y2, k = sp.symbols("y1 y2 k", real=True)
PENDULUM = System.from_rates("pendulum", {y1: y2, y2: -k * sp.sin(y1)})
SAMPLER = Sampler({"y1": Normal(0, 1), "y2": Uniform(-1, 1), "k": Uniform(1, 2)}, 2500, seed=4)
ASKED = {"t_eval": [1.0, 3.0], "statistics": Statistics(("y1",), quantiles=True), "chunk": 512}
CHUNKS = 5


@pytest.fixture(scope="module")
def compiled():
    return compile_system(PENDULUM, "c")


@pytest.fixture(scope="module")
def expected(compiled):
    return run(compiled)


def run(compiled, **others):
    return codegen.ensemble(compiled, SAMPLER, (0, 3), **{**ASKED, **others})


@pytest.fixture(params=["zarr", "parquet"])
def kind(request):
    pytest.importorskip({"zarr": "zarr", "parquet": "pyarrow"}[request.param])
    return request.param


def same(found, expected):
    for name, values in expected.columns.items():
        np.testing.assert_array_equal(found.columns[name], values)
    one, other = found.statistics["y1"], expected.statistics["y1"]
    np.testing.assert_array_equal(one.mean, other.mean)
    np.testing.assert_array_equal(one.variance, other.variance)
    np.testing.assert_array_equal(one.quantile([0.1, 0.9]), other.quantile([0.1, 0.9]))
    assert found.counts == expected.counts
    assert found.steps == expected.steps


def records(folder):
    """Names of the records of chunks; a killed process may leave a hidden file that it had begun."""
    return sorted(p.name for p in (folder / "manifest").glob("*.json"))


@pytest.mark.sparse(1)
def test_a_run_that_broke_off_goes_on_where_it_stopped(compiled, expected, kind, tmp_path):
    class Enough(Exception):
        pass

    def stop(share):
        if share > 0.3:
            raise Enough

    asked = {"store": tmp_path / "runs", "store_format": kind, "threads": 1}
    with pytest.raises(Enough):
        run(compiled, **asked, progress=stop)
    there = records(tmp_path / "runs")
    assert 2 <= len(there) <= CHUNKS
    times = {n: (tmp_path / "runs" / "manifest" / n).stat().st_mtime_ns for n in there}
    found = run(compiled, **asked, keep=True)
    assert found.computed == CHUNKS - len(there)
    same(found, expected)
    assert len(records(tmp_path / "runs")) == CHUNKS
    for n in there:
        assert (tmp_path / "runs" / "manifest" / n).stat().st_mtime_ns == times[n]
    again = run(compiled, **asked, keep=True)
    assert again.computed == 0
    same(again, expected)


def data_files(folder):
    """Every file that holds numbers of a chunk, or its record."""
    files = [
        p for p in folder.rglob("*") if p.is_file() and p.name not in {"zarr.json", "ensemble.json"}
    ]
    return sorted(files)


@pytest.mark.slow
def test_whatever_file_is_damaged_is_computed_again(compiled, expected, kind, tmp_path):
    folder = tmp_path / "runs"
    run(compiled, store=folder, store_format=kind)
    files = data_files(folder)
    rng = np.random.default_rng(2)
    again = 0
    for number in rng.choice(len(files), 5, replace=False):
        file = files[number]
        before = file.read_bytes()
        middle = len(before) // 2
        for damaged in (
            before[:middle],
            before[:middle] + bytes([before[middle] ^ 255]) + before[middle + 1 :],
        ):
            file.write_bytes(damaged)
            found = run(compiled, store=folder, store_format=kind, keep=True)
            same(found, expected)
            assert found.computed <= 1
            again += found.computed
        assert run(compiled, store=folder, store_format=kind).computed == 0
    assert again >= 7


def test_a_missing_record_is_a_missing_chunk(compiled, expected, kind, tmp_path):
    run(compiled, store=tmp_path, store_format=kind)
    (tmp_path / "manifest" / "000000003.json").unlink()
    found = run(compiled, store=tmp_path, store_format=kind, keep=True)
    assert found.computed == 1
    same(found, expected)


def test_the_files_are_what_other_programs_read(compiled, expected, tmp_path):
    zarr, parquet = pytest.importorskip("zarr"), pytest.importorskip("pyarrow.parquet")
    run(compiled, store=tmp_path / "z")
    group = zarr.open_group(tmp_path / "z" / "data.zarr", mode="r")
    np.testing.assert_array_equal(group["y"][:], expected.y)
    assert group.attrs["rows"]["y"] == ["y1", "y2"]
    assert group.attrs["times"] == [1.0, 3.0]
    run(compiled, store=tmp_path / "p", store_format="parquet")
    table = parquet.read_table(tmp_path / "p" / "chunk-000000001.parquet")
    assert table["trajectory"].to_pylist() == list(range(512, 1024))
    assert table["y1"][3].as_py() == expected["y1"][:, 515].tolist()
    assert table["y2_stop"][7].as_py() == expected.y_stop[1, 519]


def test_a_store_of_another_ensemble_is_refused_and_left_alone(compiled, kind, tmp_path):
    run(compiled, store=tmp_path, store_format=kind)
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    for others in ({"rtol": 1e-8}, {"chunk": 256}, {"t_eval": [1.0, 2.0]}, {"method": "DOP853"}):
        with pytest.raises(InputError, match="holds another ensemble"):
            run(compiled, store=tmp_path, store_format=kind, **others)
    seeded = Sampler(SAMPLER.values, SAMPLER.count, seed=5)
    with pytest.raises(InputError, match="holds another ensemble"):
        codegen.ensemble(compiled, seeded, (0, 3), store=tmp_path, store_format=kind, **ASKED)
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before


def test_what_cannot_be_written_is_reported(compiled, kind, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="cannot be written"):
        run(compiled, store=tmp_path / "file", store_format=kind)
    with pytest.raises(InputError, match="unknown format"):
        run(compiled, store=tmp_path / "x", store_format="csv")
    assert not (tmp_path / "x").exists()
    written = []

    def full(self, number, columns):
        written.append(number)
        if len(written) > 2:
            raise OSError(28, "No space left on device")
        return put(self, number, columns)

    kinds = store.FORMATS[kind][0]
    put = kinds.put
    monkeypatch.setattr(kinds, "put", full)
    with pytest.raises(InputError, match="No space left on device"):
        run(compiled, store=tmp_path / "full", store_format=kind, threads=1)
    assert len(records(tmp_path / "full")) == 2
    monkeypatch.undo()
    assert run(compiled, store=tmp_path / "full", store_format=kind).computed == CHUNKS - 2


def test_the_window_bounds_what_is_in_memory(compiled, monkeypatch):
    """No more chunks are given out than the window holds, however many there are."""
    waiting = most = 0
    submit, finished = crews.Threads.submit, crews.Threads.finished

    def counted(self, number):
        nonlocal waiting, most
        waiting += 1
        most = max(most, waiting)
        return submit(self, number)

    def fewer(self, futures):
        nonlocal waiting
        done, rest = finished(self, futures)
        waiting -= len(done)
        return done, rest

    monkeypatch.setattr(crews.Threads, "submit", counted)
    monkeypatch.setattr(crews.Threads, "finished", fewer)
    found = codegen.ensemble(
        compiled, np.zeros((2, 256 * 60)), (0, 0.1), [1.0], keep=False, chunk=256, threads=2
    )
    assert found.counts == {"end": 256 * 60}
    assert 2 <= most <= crews.A_WORKER * 2


@pytest.mark.slow
def test_a_killed_worker_costs_nothing_but_time(compiled, expected, tmp_path):
    distributed = pytest.importorskip("distributed")
    pytest.importorskip("zarr")
    quiet = {"silence_logs": 60, "dashboard_address": None, "threads_per_worker": 1}
    killed = []

    def kill(_):
        if not killed:
            killed.append(next(iter(client.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    with (
        distributed.LocalCluster(n_workers=2, processes=True, **quiet) as cluster,
        distributed.Client(cluster) as client,
    ):
        asked = {"client": client, "chunk": 256, "store": tmp_path}
        found = run(compiled, **asked, progress=kill, keep=True)
        again = run(compiled, **asked, keep=True)
    assert killed
    same(found, expected)
    same(again, expected)
    assert again.computed == 0
    assert len(records(tmp_path)) == 10
    done = [json.loads(p.read_text()) for p in sorted((tmp_path / "manifest").glob("*.json"))]
    assert sum(r["trajectories"] for r in done) == SAMPLER.count
    assert [r["chunk"] for r in done] == list(range(10))


def test_a_store_and_its_manifest_have_no_rests_of_writing(compiled, kind, tmp_path):
    run(compiled, store=tmp_path, store_format=kind)
    assert not [p for p in Path(tmp_path).rglob("*") if p.name.endswith(".tmp")]


DAMAGES = {
    "empty": "", "cut": '{"fingerprint": "ab', "no JSON": "\x00\xff", "a list": "[1, 2]", "null": "null",
    "deep": "[" * 100_000, "another kind": '{"zarr_format": 3, "node_type": "spaceship"}',
    "another version": '{"zarr_format": 99, "node_type": "array"}', "no object": '"text"',
}  # fmt: skip
"""What a file of JSON may have become."""


@pytest.mark.sparse(4)
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_description_is_reported_and_mended_by_running_again(
    compiled, expected, kind, tmp_path, damage
):
    """Numbers with the right checksum are not computed again: no description is needed to trust them."""
    run(compiled, store=tmp_path, store_format=kind)
    files = [tmp_path / "ensemble.json"]
    if kind == "zarr":
        files += [tmp_path / "data.zarr" / p / "zarr.json" for p in ("", "y", "status")]
    for file in files:
        whole = file.read_bytes()
        file.write_text(DAMAGES[damage], encoding="latin-1")
        found = run(compiled, store=tmp_path, store_format=kind, keep=True)
        assert found.notice.endswith(
            f"damaged and written anew in the store: {file.relative_to(tmp_path)}"
        )
        assert found.computed == 0
        same(found, expected)
        assert file.read_bytes() == whole
    assert "damaged" not in run(compiled, store=tmp_path, store_format=kind).notice


def test_an_array_of_another_shape_is_no_array_of_this_store(compiled, expected, tmp_path):
    pytest.importorskip("zarr")
    run(compiled, store=tmp_path)
    file = tmp_path / "data.zarr" / "y" / "zarr.json"
    reported = json.loads(file.read_text())
    reported["chunk_grid"]["configuration"]["chunk_shape"][-1] = 500
    file.write_text(json.dumps(reported))
    found = run(compiled, store=tmp_path, keep=True)
    assert "data.zarr/y/zarr.json" in found.notice
    same(found, expected)


def test_chunks_of_another_ensemble_are_not_taken_where_nothing_else_says_whose_they_are(
    compiled, kind, tmp_path
):
    """Their checksums are right; their records say of which ensemble they are."""
    run(compiled, store=tmp_path, store_format=kind)
    for damage in (Path.unlink, lambda file: file.write_text("{")):
        damage(tmp_path / "ensemble.json")
        before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
        with pytest.raises(InputError, match="another ensemble") as caught:
            run(compiled, store=tmp_path, store_format=kind, rtol=1e-7)
        assert "ensemble.json is" in caught.value.got
        assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before


@pytest.mark.parametrize("place", ["", "manifest", "ensemble.json", "manifest/000000001.json"])
def test_a_file_where_a_folder_is_wanted_and_the_other_way_round(compiled, kind, tmp_path, place):
    folder = tmp_path / "runs"
    path = folder / place
    if path.suffix == ".json":
        path.mkdir(parents=True)
    else:
        path.parent.mkdir(exist_ok=True)
        path.write_text("")
    with pytest.raises(InputError) as caught:
        run(compiled, store=folder, store_format=kind)
    assert str(folder) in caught.value.where
