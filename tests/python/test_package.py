"""What is installed: one version, the libraries that it needs, and sources that are enough to build it."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

import mottle

ROOT = Path(__file__).resolve().parents[2]


def output(*command):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True).stdout


def test_the_version_is_the_commands(command):
    assert mottle.__version__ == command("--version").stdout.split()[1]
    assert f"VERSION {mottle.__version__}" in (ROOT / "CMakeLists.txt").read_text()


def test_the_libraries_that_a_wheel_needs_are_named():
    if not (shutil.which("readelf") and shutil.which("dpkg")):
        pytest.skip("needs readelf and dpkg")
    module = next(Path(mottle.__file__).parent.glob("_engine*.so"))
    needed = re.findall(r"\(NEEDED\).*\[(.+)\]", output("readelf", "-d", module))
    places = dict(re.findall(r"^\s+(\S+) => (\S+)", output("ldd", module), re.M))
    packages = set()
    for name in needed:
        place = places.get(name)
        if place is None or re.match(r"lib(c|m|gcc_s|stdc\+\+|asan|ubsan)\.", name):
            continue  # of Debian's base, or of a sanitizer
        found = subprocess.run(["dpkg", "-S", os.path.realpath(place)], capture_output=True, text=True, check=False).stdout
        if found:
            packages.add(found.split(":")[0])
    assert packages
    page = (ROOT / "docs" / "howto" / "python.md").read_text()
    missing = {each for each in packages if not re.search(rf"\b{re.escape(each.removesuffix('-pthread'))}\b", page)}
    assert not missing, f"docs/howto/python.md does not name {missing}"


def test_the_source_distribution_has_all_that_cmake_needs(tmp_path):
    pytest.importorskip("build")
    if not (ROOT / ".git").exists() or not shutil.which("git"):
        pytest.skip("needs the clone")
    clone = tmp_path / "clone"
    files = output("git", "-C", ROOT, "ls-files").splitlines()
    for name in files:
        if (ROOT / name).is_file():
            (clone / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, clone / name)
    subprocess.run([sys.executable, "-m", "build", "--sdist", "--no-isolation", "--outdir", tmp_path / "dist", clone],
                   capture_output=True, check=True, cwd=tmp_path)
    with tarfile.open(next((tmp_path / "dist").glob("mottle-*.tar.gz"))) as archive:
        there = {name.partition("/")[2] for name in archive.getnames()}
    wanted = {name for name in files if name == "CMakeLists.txt" or name.split("/")[0] in
              ("cmake", "include", "src", "web", "apps", "modules", "bindings")}
    assert wanted <= there, sorted(wanted - there)[:5]


def results(script, **environment):
    """Lines that a Python of its own prints, and its warnings."""
    inherited = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    done = subprocess.run([sys.executable, "-c", f"import sys\nsys.path.insert(0, {os.environ['MOTTLE_PYTHON']!r})\n" + script],
                          capture_output=True, text=True, check=True, env=inherited | environment)
    return done.stdout.splitlines(), done.stderr


# Products of sizes with and without a remainder in the kernels' blocks.
PRODUCTS = """
import hashlib
def digest():
    random = numpy.random.default_rng(3)
    digest = hashlib.sha256()
    for size in (7, 64, 250):
        a = random.normal(size=(size, size))
        digest.update((a @ a).tobytes() + numpy.linalg.eigh(a + a.T)[1].tobytes())
    return digest.hexdigest()
"""


def test_kernels_of_blas_are_those_of_the_processor():
    (kernels, outdated, variable, bits), warnings = results(PRODUCTS + """
import os
import numpy
digest()  # by the kernels that the library has chosen
import mottle
print(mottle.about()["blas_kernels"], mottle.about()["blas_kernels_outdated"], os.environ.get("OPENBLAS_CORETYPE"), digest(), sep="\\n")
""")
    assert not warnings
    assert outdated == "False"
    assert variable == "None"
    if not kernels:
        pytest.skip("BLAS is not OpenBLAS")
    assert results(PRODUCTS + "import numpy\nprint(digest())", OPENBLAS_CORETYPE=kernels)[0] == [bits]


def test_kernels_are_changed_beside_threads_that_wait_or_start_short_products():
    (outdated, is_right), warnings = results("""
import threading
import numpy
end = threading.Event()
a = numpy.random.default_rng(3).normal(size=(200, 200))
expected, products = a @ a, []
def compute():
    while not end.is_set():
        products.append(a @ a)
threads = [threading.Thread(target=end.wait), threading.Thread(target=compute)]
for thread in threads:
    thread.start()
import mottle
count = len(products)
while len(products) < count + 3:
    pass
end.set()
for thread in threads:
    thread.join()
print(mottle.about()["blas_kernels_outdated"],
      all(numpy.allclose(product, expected, rtol=1e-10, atol=1e-10) for product in products), sep="\\n")
""")
    assert not warnings
    assert outdated == "False"
    assert is_right == "True"


def test_kernels_stay_while_another_thread_computes():
    (kernels, outdated, is_still_computing), warnings = results("""
import os
import threading
import numpy
a = numpy.ones((6000, 6000))
thread = threading.Thread(target=lambda: a @ a, daemon=True)
thread.start()
threading.Event().wait(0.05)  # let it come to the product, where it lets go of the interpreter's lock
import mottle
print(mottle.about()["blas_kernels"], mottle.about()["blas_kernels_outdated"], thread.is_alive(), sep="\\n")
sys.stdout.flush()
os._exit(0)  # without waiting for the product
""")
    if is_still_computing == "False":
        pytest.skip("the product ended before the import did")
    assert outdated == "False" or kernels == "Prescott"
    assert (outdated == "True") == ("RuntimeWarning: OpenBLAS does not know" in warnings)
