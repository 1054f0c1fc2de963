"""A mission has one digest, whichever instructions the processor has."""

import json
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from tests.onehop.scenes import field

LIKE_AN_OLD_PROCESSOR = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "NUMBA_CPU_NAME": "generic",
    "OPENBLAS_CORETYPE": "Nehalem",
}
"""Takes FMA and AVX2 from the C library, NumPy, the compiler of the kernels, and BLAS."""


def _digest(folder: Path, environment: dict[str, str]) -> str:
    command = [
        sys.executable, "-m", "onehop", "run", "field.toml", "--driver", "inline", "--json",
        "--out", "run",
    ]  # fmt: skip
    caches = {"NUMBA_CACHE_DIR": str(folder / "cache")}
    ended = subprocess.run(
        command, cwd=folder, env=os.environ | caches | environment, capture_output=True, check=True
    )
    digest: str = json.loads(ended.stdout)["digest"]
    return digest


@pytest.mark.slow
@pytest.mark.skipif(
    platform.machine() != "x86_64" or platform.libc_ver()[0] != "glibc",
    reason="glibc on x86-64 can be told to do without instructions",
)
def test_a_mission_has_the_same_digest_without_fma_and_avx(tmp_path: Path) -> None:
    field(tmp_path)
    assert _digest(tmp_path, {}) == _digest(tmp_path, LIKE_AN_OLD_PROCESSOR)
