"""The wheel: the package with libimtet.so inside, which `make` builds from the sources around this folder."""
import os
import re
import shutil
import subprocess
from typing import Any

from setuptools import setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
with open(os.path.join(ROOT, "include", "imtet.h")) as header:
    VERSION = re.findall(r'IMTET_VERSION "(.*)"', header.read())[0]


class BuildWithLibrary(build_py):
    def run(self) -> None:
        super().run()
        name = f"build/release/libimtet.so.{VERSION}"
        reader = "imtet-opensees"  # which the library executes
        subprocess.run(["make", "-C", ROOT, f"-j{os.cpu_count()}", name, reader], check=True)
        shutil.copy(os.path.join(ROOT, name), os.path.join(self.build_lib, "imtet", "libimtet.so"))
        shutil.copy(os.path.join(ROOT, reader), os.path.join(self.build_lib, "imtet", reader))


class WheelOfThisMachine(bdist_wheel):
    def finalize_options(self) -> None:
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self) -> Any:
        return "py3", "none", super().get_tag()[2]


setup(version=VERSION, cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": WheelOfThisMachine})
