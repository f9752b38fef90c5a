"""A process forked after OpenCL was used answers at once; one forked before works, and so does a spawned one."""

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

import pytest

import pylmc

pytestmark = pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="needs fork")

CODE = """
import multiprocessing, sys
import pylmc

def draw(seed):
    try:
        box = pylmc.load("box", width=8, height=8)
        picture = pylmc.render(box, progress=False, mutations_per_pixel=32, max_depth=2, seed=seed, chains=64, candidates=512)
        return float(picture.image.mean())
    except pylmc.PylmcError as error:
        return str(error)

def go_on(old):
    said = []
    for use in (lambda: old[0].step(1), lambda: old[0].image(), lambda: old[1].any_hit([0, 0, 1], [0, 0, -1])):
        try:
            use()
            said.append("it works")
        except pylmc.PylmcError as error:
            said.append(str(error))
    return said

def ask(connection, function, given):
    connection.send(function(given))

def in_child(how, function, given):
    context = multiprocessing.get_context(how)
    here, there = context.Pipe()
    child = context.Process(target=ask, args=(there, function, given))
    child.start()
    assert here.poll(60), "no answer"
    answer = here.recv()
    child.join(60)
    assert child.exitcode == 0
    return answer

def main():
    assert in_child("fork", draw, 1) > 0, "forked before"
    assert draw(1) > 0
    assert "spawn" in in_child("fork", draw, 1)
    sampler = pylmc.Sampler(pylmc.load("box", width=8, height=8), max_depth=2, chains=64, candidates=512)
    sampler.init(seed=1)
    tracer = pylmc.RayTracer([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    said = in_child("fork", go_on, (sampler, tracer))
    assert all("spawn" in sentence for sentence in said), said
    assert in_child("spawn", draw, 1) > 0
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert all("spawn" in answer for answer in pool.map_async(draw, [1, 2]).get(timeout=60))
    print("done")

if __name__ == "__main__":
    main()
"""


def test_forked_processes_answer(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(CODE, encoding="utf-8")
    command = [sys.executable, str(tmp_path / "program.py")]
    environ = {**os.environ, "PYTHONPATH": str(Path(pylmc.__file__).parents[1])}
    done = subprocess.run(command, capture_output=True, text=True, env=environ, timeout=240, check=False)
    assert done.returncode == 0 and done.stdout == "done\n", done.stderr
