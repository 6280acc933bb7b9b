#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens the Debian packages of a build and checks what a board would notice: hardened programs of
the right machine, no library but those that the package wants, no symbol newer than the oldest
system it is for, kernels for the devices of the preset, every linked library in the list of
dependencies, no dead link in a page, and nothing that lintian warns of. Prints sizes, the kinds of
the files and the kernels.

Example: toolchains/check_packages.py build/jetson-thor"""
import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

from make_sbom import cached, cuda_version, output_of

# JetPack 6 is Ubuntu 22.04, JetPack 7 is 24.04: glibc 2.35 and the libstdc++ of GCC 12 suffice.
NEWEST = {"GLIBC": (2, 35), "GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13)}
# Which package has a library of which name.
LIBRARIES = {"libc.so.6": "libc6", "libm.so.6": "libc6", "ld-linux-aarch64.so.1": "libc6",
             "ld-linux-x86-64.so.2": "libc6", "libgcc_s.so.1": "libgcc-s1",
             "libstdc++.so.6": "libstdc++6", "libz.so.1": "zlib1g", "libgmp.so.10": "libgmp10",
             "libgmpxx.so.4": "libgmpxx4ldbl", "libyaml-cpp.so.0.7": "libyaml-cpp0.7",
             "libcudart.so.12": "cuda-cudart-12-6",
             "libfmt.so.9": "libfmt9", "libmd.so.0": "libmd0",
             "libmeshoptimizer.so.2d": "libmeshoptimizer2d",
             "libmicrohttpd.so.12": "libmicrohttpd12", "libtinyxml2.so.9": "libtinyxml2-9",
             "liblinuxcnchal.so.0": "linuxcnc-uspace"}
DEV_OF = {"libc6": "libc6-dev", "libgcc-s1": "libgcc-12-dev", "libstdc++6": "libstdc++-12-dev",
          "zlib1g": "zlib1g-dev", "libgmp10": "libgmp-dev", "libgmpxx4ldbl": "libgmp-dev",
          "libyaml-cpp0.7": "libyaml-cpp-dev", "libfmt9": "libfmt-dev", "libmd0": "libmd-dev",
          "libmeshoptimizer2d": "libmeshoptimizer-dev", "libmicrohttpd12": "libmicrohttpd-dev",
          "libtinyxml2-9": "libtinyxml2-dev", "linuxcnc-uspace": "linuxcnc-uspace-dev"}
LINUXCNC = {"axguard-hal", "axguard_stop.so"}  # the engine is in libaxguard
PACKAGES = {"axguard", "axguardd", "axguard-board-dev", "axguard-doc", "axguard-lab", "libaxguard0",
            "libaxguard-dev"}


def needed_by(path):
    return re.findall(r"NEEDED.*\[(.+)\]", output_of("readelf", "-dW", path))


def symbols_newer(path, newest):
    """Versions of symbols that are wanted and that the oldest system does not have."""
    wanted = set(re.findall(r"Name: (GLIBC|GLIBCXX|CXXABI)_([0-9.]+)",
                            output_of("readelf", "-VW", path)))
    return sorted(f"{kind}_{number}" for kind, number in wanted
                  if tuple(map(int, number.split("."))) > newest[kind])


def kernels_in(path):
    """The devices whose machine code the file holds, one entry a compiled source. CUDA's containers
    are a head (magic, version 1, 16 bytes, size) and entries (kind: 2 is machine code; bytes of
    head and body; at byte 28 the device), as the files of nvcc 13.0 show."""
    data, kernels, at = path.read_bytes(), [], 0
    while (at := data.find(b"\x50\xed\x55\xba", at)) >= 0:
        version, head, size = struct.unpack_from("<HHQ", data, at + 4)
        entry, end = at + head, at + head + size
        at += 4
        while version == 1 and head == 16 and entry + 32 <= end <= len(data):
            kind, _, own, body = struct.unpack_from("<HHIQ", data, entry)
            kernels.append(("ptx_" if kind == 1 else "sm_") +
                           str(struct.unpack_from("<I", data, entry + 28)[0]))
            entry += own + body
    return kernels


def missing_hardening(path, is_cross):
    """What AXG_HARDENING (toolchains/flags.cmake) leaves in a file, and this one lacks. A small one
    has a mark at each of its few functions, and may call nothing that can be fortified."""
    dynamic = output_of("readelf", "-dW", path)
    segments = output_of("readelf", "-lW", path)
    symbols = set(re.findall(r" UND (\w+)", output_of("readelf", "--dyn-syms", "-W", path)))
    flags = " ".join(re.findall(r"\((?:FLAGS|FLAGS_1)\)\s+(.*)", dynamic))
    is_library = "(SONAME)" in dynamic or path.suffix == ".so"  # a module has no name
    is_small = path.name in LINUXCNC
    stack = re.search(r"GNU_STACK\s.*", segments)
    has = {
        "position-independent code": is_library or "PIE" in flags.split(),
        "RELRO": "GNU_RELRO" in segments,
        "BIND_NOW": "NOW" in flags.split(),
        "a stack that does not execute": stack is not None and "RWE" not in stack.group(),
        "stack protectors": "__stack_chk_fail" in symbols,
        "fortified calls": is_small or any(re.fullmatch(r"__\w+_chk", name) for name in symbols),
    }
    # The property of the whole file needs start files of the C library that have it, and those of
    # Debian 12 do not; so the marks at the functions are counted: paciasp, endbr64.
    mark = b"\x3f\x23\x03\xd5" if is_cross else b"\xf3\x0f\x1e\xfa"
    has["marks of control flow"] = path.read_bytes().count(mark) > (3 if is_small else 100)
    return [name for name, holds in has.items() if not holds]


def unhardened_sources(build):
    """Sources of the packaged files that were compiled without a flag which leaves no trace."""
    commands = json.loads((build / "compile_commands.json").read_text())
    return sorted(entry["file"] for entry in commands
                  if entry["file"].endswith((".cpp", ".c")) and
                  not re.search("/tests/|/example/", entry["file"]) and
                  not {"-fstack-clash-protection", "-fstack-protector-strong"} <=
                  set(entry["command"].split()))


def open_symbols(archive, is_cross):
    """Functions of the project that its archive wants and does not have: nobody could link it."""
    tool = "aarch64-linux-gnu-nm" if is_cross else "nm"
    def names(option):
        return set(re.findall(r"\b(_ZNK?3axg\w+)", output_of(tool, option, "-P", archive)))
    return sorted(names("--undefined-only") - names("--defined-only"))


class Checks:
    def __init__(self):
        self.faults = []

    def expect(self, holds, message):
        if not holds:
            self.faults.append(message)


def check_program(checks, path, build, depends, listed, own_files):
    name = path.name
    is_cross = "jetson" in build.name
    machine = "AArch64" if is_cross else "X86-64"
    header = output_of("readelf", "-hW", path)
    checks.expect(machine in header, f"{name}: not a program for {machine}")
    for library in needed_by(path):
        if library in own_files:
            continue
        package = LIBRARIES.get(library)
        checks.expect(package, f"{name}: links {library}, which this script does not know")
        checks.expect(package is None or package in depends,
                      f"{name}: links {library}, and the package does not depend on {package}")
    for library in needed_by(path):
        dev = DEV_OF.get(LIBRARIES.get(library))
        checks.expect(dev is None or {dev, f"{dev}-arm64-cross"} & listed,
                      f"{name}: {library} is missing in the list of dependencies")
    if "axguard" in name:
        missing = missing_hardening(path, is_cross)
        checks.expect(not missing, f"{name}: without {', '.join(missing)}")
    if is_cross:
        newer = symbols_newer(path, NEWEST)
        checks.expect(not newer, f"{name}: wants {', '.join(newer)}: not on JetPack 6")
    architectures = cached(build, "AXG_CUDA_ARCHITECTURES") if cuda_version(build) else ""
    kernels = kernels_in(path)
    # Machine code for exactly the devices of the preset, and nothing that a board would compile.
    wanted = {f"sm_{number}" for number in re.findall(r"(\d+)-real", architectures)}
    has_engine = "axguard" in name and name not in LINUXCNC
    checks.expect(set(kernels) == (wanted if has_engine else set()),
                  f"{name}: kernels for {sorted(set(kernels))}, wanted {sorted(wanted)}")
    print(f"  {name}: kernels: " + (", ".join(
        f"{arch} x {kernels.count(arch)}" for arch in sorted(set(kernels))) or "none"))
    print(f"  {name}: {path.stat().st_size} bytes; needs {' '.join(needed_by(path))}")
    print("  " + output_of("file", "-b", path).strip())


def check_package(checks, package, build, listed, folder):
    into = folder / package.stem
    subprocess.run(["dpkg-deb", "-x", package, into], check=True)
    field = {name: output_of("dpkg-deb", "-f", package, name).strip()
             for name in ("Package", "Version", "Architecture", "Depends")}
    print(f"{package.name}: {package.stat().st_size} bytes; depends: {field['Depends']}")
    wanted = "arm64" if "jetson" in build.name else output_of(
        "dpkg", "--print-architecture").strip()
    if field["Package"] == "axguard-doc":
        wanted = "all"
    checks.expect(field["Architecture"] == wanted,
                  f"{package.name}: for {field['Architecture']}, wanted {wanted}")
    depends = {item.split()[0] for item in field["Depends"].split(",") if item.strip()}
    is_pages = field["Package"] == "axguard-doc"
    for name in ("copyright", "changelog.gz", "changelog.Debian.gz",
                 *(() if is_pages else ("sbom.spdx.json", "licences.gz"))):
        names = {name, name.removesuffix(".gz"), f"{name}.gz"}
        checks.expect(any((into / "usr/share/doc" / field["Package"] / each).is_file()
                          for each in names), f"{package.name}: no {name}")
    if field["Package"] in ("axguard", "axguardd", "axguard-lab"):
        completion = into / "usr/share/bash-completion/completions" / field["Package"]
        checks.expect(completion.is_file(), f"{package.name}: no completion for bash")
    for page in into.rglob("*.md"):
        for link in re.findall(r"\]\((?!\w+:|#)([^)#\s]+)(?:#[^)]*)?\)",
                               page.read_text(encoding="utf-8")):
            checks.expect((page.parent / link).exists(),
                          f"{package.name}: {page.relative_to(into)}: dead link {link}")
    return into, field["Package"], depends


def lintian(checks, packages):
    """Debian's own checks; debian/*.lintian-overrides have what is accepted, and why."""
    if shutil.which("lintian") is None:
        checks.expect(False, "no lintian: ./setup.sh --all installs it")
        return
    run = subprocess.run(["lintian", "--allow-root", "--no-cfg", "--profile", "debian",
                          "--fail-on", "error,warning", *packages],
                         text=True, capture_output=True)
    for line in (run.stdout + run.stderr).splitlines():
        checks.expect(not re.match(r"[EW]: ", line), f"lintian: {line}")
    checks.expect(run.returncode in (0, 2) and not run.stderr, f"lintian failed: {run.stderr}")


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    packages = sorted((build / "packages").glob("*.deb"))
    document = json.loads((build / "packaged/sbom.spdx.json").read_text())
    listed = {package["name"] for package in document["packages"]}
    checks = Checks()
    for source in unhardened_sources(build):
        checks.expect(False, f"{source}: compiled without the flags of AXG_HARDENING")
    with tempfile.TemporaryDirectory() as temporary:
        opened = [check_package(checks, package, build, listed, pathlib.Path(temporary))
                  for package in packages]
        names = {name for _, name, _ in opened}
        is_amd64 = any(package.stem.endswith("_amd64") for package in packages)
        wanted = PACKAGES | ({"axguard-linuxcnc"} if is_amd64 else set())  # debian/control
        checks.expect(names == wanted, f"packages: {sorted(names)}")
        own = {path.name for into, _, _ in opened for path in into.rglob("*.so*")}
        programs = 0
        for into, name, depends in opened:
            for path in sorted(into.rglob("*")):
                if not path.is_file() or path.is_symlink() or path.suffix in (".o", ".a"):
                    continue
                with open(path, "rb") as file:
                    if file.read(4) == b"\x7fELF":
                        programs += 1
                        check_program(checks, path, build, depends, listed, own)
        checks.expect(programs >= 4, f"{programs} programs and libraries, wanted axguard, "
                      "axguard-lab, axguardd and libaxguard")
        for archive in (path for into, _, _ in opened for path in into.rglob("libaxguard.a")):
            names = open_symbols(archive, "jetson" in build.name)
            checks.expect(not names, f"libaxguard.a: {len(names)} missing, such as {names[:1]}")
            programs += 1
        checks.expect(programs >= 5, "no libaxguard.a")
    lintian(checks, packages)
    for fault in checks.faults:
        print(f"FAULT {fault}")
    sys.exit(1 if checks.faults else 0)


if __name__ == "__main__":
    main()
