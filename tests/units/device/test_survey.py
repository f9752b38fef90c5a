"""Devices: only those count that run a kernel, and a broken driver neither crashes nor hangs us."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from pylmc import PylmcError
from pylmc.device import findings, implementations, survey, trials
from pylmc.device.survey import DeviceInfo


@pytest.fixture(autouse=True)
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """A cache folder of its own, and nothing remembered before or after."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    survey._survey.cache_clear()
    yield
    survey._survey.cache_clear()


def driver(folder: Path, name: str, body: str) -> Path:
    """A shared library whose loading runs ``body``, with an .icd file that names it."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if not compiler:
        pytest.skip("needs a C compiler to make a broken driver")
    source, library = folder / f"{name}.c", folder / f"lib{name}.so"
    source.write_text(f"#include <stdlib.h>\n#include <unistd.h>\n__attribute__((constructor)) void f(void) {{{body}}}")
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, source], check=True)
    (folder / f"{name}.icd").write_text(f"{library}\n")
    return library


def info(index: int, kind: str = "cpu", platform: str = "Portable Computing Language") -> DeviceInfo:
    return DeviceInfo(f"thing {index}", kind, platform, "OpenCL 3.0", "1", 0, 4, 2**30, True, True)


def test_a_device_works() -> None:
    found = survey.usable()
    assert found, "the tests need an OpenCL device; `make test` sets one up"
    context, queue = survey.context_and_queue(survey.select())
    assert survey.describes(found[0], queue.device) or "PYOPENCL_CTX" in os.environ
    source = "__kernel void twice(__global float *x) { x[get_global_id(0)] *= 2; }"
    numbers = np.arange(8, dtype=np.float32)
    buffer = cl.Buffer(context, cl.mem_flags.COPY_HOST_PTR, hostbuf=numbers)
    cl.Kernel(cl.Program(context, source).build(), "twice")(queue, (8,), None, buffer)
    result = np.empty_like(numbers)
    cl.enqueue_copy(queue, result, buffer)
    assert np.array_equal(result, 2 * numbers)


def test_select_by_index_kind_and_name() -> None:
    for index, found in enumerate(survey.usable()):
        assert survey.describes(found, survey.select(str(index)))
        assert survey.describes(found, survey.select(found.label.upper()))  # a name alone may be part of another's
        if found.kind in ("cpu", "gpu"):
            assert survey.select(found.kind).type & {"cpu": cl.device_type.CPU, "gpu": cl.device_type.GPU}[found.kind]


@pytest.mark.parametrize("spec", ["abacus", "99", "", " "])
def test_unknown_device_names_what_is_there(spec: str) -> None:
    with pytest.raises(PylmcError) as raised:
        survey.select(spec)
    message = str(raised.value)
    assert f"'{spec}'" in message and survey.usable()[0].name in message and "pylmc devices" in message


def test_pyopencl_ctx_is_respected(monkeypatch: pytest.MonkeyPatch) -> None:
    name = survey.usable()[0].platform[:8]
    monkeypatch.setenv("PYOPENCL_CTX", name)
    assert name in survey.select().platform.name
    monkeypatch.setenv("PYOPENCL_CTX", "no such platform")
    with pytest.raises(PylmcError, match="no such platform"):
        survey.select()
    assert survey.select("0")  # what is asked for goes first


def test_environment_stays_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    before = os.environ.get("OCL_ICD_VENDORS")
    survey.select()
    assert os.environ.get("OCL_ICD_VENDORS") == before


def test_gpu_first_and_open_source_before_proprietary() -> None:
    intel, pocl = info(0, platform="Intel(R) OpenCL"), info(1)
    other, gpu, accelerator = info(2, platform="rusticl"), info(3, "gpu", "NVIDIA CUDA"), info(4, "other")
    assert sorted([accelerator, intel, other, pocl, gpu], key=survey._merit) == [gpu, pocl, intel, other, accelerator]


def test_nothing_there(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("OCL_ICD_VENDORS", str(tmp_path))
    assert survey.usable() == []
    with pytest.raises(PylmcError, match="apt install pocl-opencl-icd") as raised:
        survey.select()
    assert "\n" not in str(raised.value)


def test_broken_icd_files_have_their_reasons(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "a_missing.icd").write_text("/nowhere/libmissing.so\n")
    (tmp_path / "b_empty.icd").write_text("")
    (tmp_path / "text.so").write_text("not a library")
    (tmp_path / "c_text.icd").write_text(f"{tmp_path}/text.so\n")
    monkeypatch.setenv("OCL_ICD_VENDORS", str(tmp_path))
    assert survey.usable() == []
    missing, empty, text = survey.rejected()
    assert "does not exist" in missing.reason
    assert "empty" in empty.reason
    assert "could not open" in text.reason
    with pytest.raises(PylmcError, match="does not exist"):
        survey.select()


def test_a_crashing_driver_harms_nobody(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    driver(tmp_path, "crash", "abort();")
    monkeypatch.setenv("OCL_ICD_VENDORS", str(tmp_path))
    assert survey.usable() == []
    assert "SIGABRT" in survey.rejected()[0].reason


def test_a_hanging_driver_harms_nobody(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    driver(tmp_path, "hang", "sleep(1000);")
    monkeypatch.setenv("OCL_ICD_VENDORS", str(tmp_path))
    monkeypatch.setattr(trials, "PROBE_TIMEOUT", 3.0)
    assert survey.usable() == []
    assert "did not answer within 3 s" in survey.rejected()[0].reason


def test_results_are_remembered_until_the_driver_changes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    library = driver(tmp_path, "odd", "_exit(3);")
    monkeypatch.setenv("OCL_ICD_VENDORS", str(tmp_path))
    tried = []
    real = trials.tried
    monkeypatch.setattr(trials, "tried", lambda implementation: tried.append(implementation) or real(implementation))
    for expected, action in ((1, None), (1, "again"), (2, "change"), (3, "refresh"), (4, "late"), (5, "damage")):
        if action == "change":
            library.write_bytes(library.read_bytes() + b"\0")
        elif action == "refresh":
            survey.refresh()
        elif action == "late":
            now = findings.time.time() + findings.BAD_FOR + 1
            monkeypatch.setattr(findings.time, "time", lambda now=now: now)
        elif action == "damage":
            findings.file().write_text('{"x": 1}')
        survey._survey.cache_clear()
        assert "exit code 3" in survey.rejected()[0].reason
        assert len(tried) == expected, action


def test_unpacked_implementation_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PYLMC_OPENCL", str(tmp_path))
    assert implementations.unpacked() == []
    (tmp_path / "implementation.json").write_text('{"library": "l/libpocl.so.2", "preload": ["l/a.so"], "path": "bin"}')
    (found,) = implementations.unpacked()
    assert found.library == f"{tmp_path}/l/libpocl.so.2" and found.preload == (f"{tmp_path}/l/a.so",)
    monkeypatch.setenv("PATH", "/usr/bin")
    assert implementations.path_with(found) == f"/usr/bin:{tmp_path}/bin"
    (tmp_path / "implementation.json").write_text("{")
    assert implementations.unpacked() == []
