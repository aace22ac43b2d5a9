"""Builds the shared library of RAI with cargo, into the package."""

import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import setup
from setuptools.command.build_py import build_py

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # setuptools before version 70
    from wheel.bdist_wheel import bdist_wheel

HERE = pathlib.Path(__file__).resolve().parent
NAME = {"darwin": "librai.dylib", "win32": "rai.dll"}.get(sys.platform, "librai.so")


class WithLibrary(build_py):
    """Adds the library to the package."""

    def run(self):
        super().run()
        command = ["cargo", "rustc", "--locked", "--release", "--package", "rai-capi", "--lib", "--crate-type", "cdylib"]
        command += ["--features", "gsv,cnav,osnma,watcher"]
        if shutil.which("cargo") is None:
            sys.exit("raim is compiled from Rust: install Rust from https://rustup.rs first")
        subprocess.run(command, cwd=HERE, check=True)
        target = pathlib.Path(self.build_lib, "raim")
        built = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", HERE.parent.parent / "target"), "release", NAME)
        shutil.copy(built, target / NAME.replace("rai.dll", "librai.dll"))


class ForAnyPython(bdist_wheel):
    """Names the wheel by its system alone, because ctypes needs no particular version of Python."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return ("py3", "none", super().get_tag()[2])


setup(cmdclass={"build_py": WithLibrary, "bdist_wheel": ForAnyPython})
