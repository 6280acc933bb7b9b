#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the programs of a build are made of, as an SPDX 2.3 document: each library and each header
that a compiler or linker read for them, traced to the Debian package it came from (on this
machine, or in the sysroot of a cross build) or to CUDA's, with version and licence. The file
`licences` beside it has the licences of what is in the programs.

Example: toolchains/make_sbom.py build/jetson-thor -o sbom.spdx.json"""
import argparse
import datetime
import email.utils
import hashlib
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGETS = ("axguard", "axguard-certcheck", "axguard-hal", "axguard-lab", "axguardd",
           "axguard_stop.so", "libaxguard.so", "libaxguard.a")
# Debian's short names that SPDX spells otherwise.
SPDX_NAMES = {"Expat": "MIT", "BSD-3-clause": "BSD-3-Clause", "BSD-2-clause": "BSD-2-Clause",
              "MPL-2": "MPL-2.0", "zlib": "Zlib", "zlib/libpng": "Zlib", "GPL-3": "GPL-3.0-only",
              "BSD-3-Clause": "BSD-3-Clause", "LGPL-2.1+": "LGPL-2.1-or-later",
              "LGPL-3+": "LGPL-3.0-or-later",
              "GPL-2": "GPL-2.0-only", "GPL-2+": "GPL-2.0-or-later"}
# Whose copyright file is not in Debian's machine-readable form, or names no licence of SPDX's;
# without the version of the compiler.
READ_BY_HAND = {"libfmt-dev": "MIT WITH fmt-exception", "libfmt9": "MIT WITH fmt-exception",
                "libc6-dev": "LGPL-2.1-or-later", "libc6": "LGPL-2.1-or-later",
                "linux-libc-dev": "GPL-2.0-only WITH Linux-syscall-note",
                "libclang-common-dev": "Apache-2.0 WITH LLVM-exception",
                "libgcc-dev": "GPL-3.0-or-later WITH GCC-exception-3.1",
                "libgcc-s1": "GPL-3.0-or-later WITH GCC-exception-3.1",
                "libstdc++-dev": "GPL-3.0-or-later WITH GCC-exception-3.1",
                "libstdc++6": "GPL-3.0-or-later WITH GCC-exception-3.1"}


def output_of(*command):
    return subprocess.run(command, check=True, text=True, capture_output=True).stdout


def cached(build, name):
    match = re.search(rf"^{name}:[A-Z]+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M)
    return match.group(1) if match else ""


def files_read(build):
    """Libraries and headers outside the project that what is packed was made from."""
    known = output_of("ninja", "-C", build, "-t", "targets", "all")
    targets = [line.split(": ")[0] for line in known.splitlines()
               if line.split(": ")[0].split("/")[-1] in TARGETS or
               re.search(r"(^|/)libaxguard\.so\.[0-9.]+: ", line)]
    inputs = output_of("ninja", "-C", build, "-t", "inputs", *targets).splitlines()
    objects = {name for name in inputs if name.endswith(".o")}
    files = {name for name in inputs if re.search(r"\.(a|so)(\.[0-9.a-z]+)?$", name)}
    current, found = False, 0
    for line in output_of("ninja", "-C", build, "-t", "deps").splitlines():
        if line and not line.startswith(" "):
            current = line.split(":")[0] in objects
            found += current
        elif current and line.strip():
            files.add(line.strip())
    if found < len(objects) / 2:
        sys.exit(f"make_sbom.py: {build} knows the headers of {found} of {len(objects)} objects "
                 "alone; build axguard, axguardd and axg_c first")
    paths = {(build / name).resolve() for name in files}
    made_here = (build, *(ROOT / name for name in ("core", "config", "cuda", "firmware_if",
                                                   "hil_replay")))
    return {path for path in paths if not any(map(path.is_relative_to, made_here))}


def packages_of_host(paths):
    """{path: package} by dpkg of this machine; /lib and /usr/lib are one folder to it or not."""
    names = {form: path for path in paths
             for form in (str(path), re.sub("^/usr/lib/", "/lib/", str(path)))}
    owners = {}
    for start in range(0, len(names), 500):
        run = subprocess.run(["dpkg", "-S", *list(names)[start:start + 500]], text=True,
                             capture_output=True)
        for line in run.stdout.splitlines():
            owner, _, name = line.rpartition(": ")
            if name in names:
                owners[names[name]] = owner.split(",")[0].split(":")[0]
    return owners


def licence_of(package, copyright_file):
    """As an SPDX expression where the copyright file says so in a way that programs can read."""
    by_hand = READ_BY_HAND.get(re.sub("-[0-9]+-dev$", "-dev", package.removesuffix("-arm64-cross")))
    if by_hand:
        return by_hand
    text = copyright_file.read_text(errors="replace") if copyright_file.exists() else ""
    for paragraph in re.split(r"\n\s*\n", text):
        if re.search(r"^Files:\s*\*\s*$", paragraph, re.M):
            found = re.search(r"^License:\s*(.+)$", paragraph, re.M)
            if found:
                words = [SPDX_NAMES.get(word, word) for word in found.group(1).split()]
                return " ".join(word.upper() if word in ("and", "or") else word for word in words)
    return "NOASSERTION"


def debian_package(package, version, share):
    licence = licence_of(package, share / "doc" / package / "copyright")
    return {"name": package, "versionInfo": version, "supplier": "Organization: Debian",
            "licenseDeclared": licence}


def dependencies(build):
    """(packages as SPDX has them, files that no package owns)."""
    sysroot = pathlib.Path(cached(build, "CMAKE_SYSROOT") or
                           ROOT / "build" / "sysroot-arm64").resolve()
    paths = files_read(build)
    foreign = {path for path in paths if path.is_relative_to(sysroot)}
    cuda = {path for path in paths if re.search(r"/cuda[^/]*/", str(path))} - foreign
    found, unknown = {}, set()
    if foreign:
        index = dict(reversed(line.split(" ", 1)) for line in
                     (sysroot / "files.txt").read_text().splitlines() if " " in line)
        versions = dict(line.split(" ", 1) for line in
                        (sysroot / "packages.txt").read_text().splitlines()[1:])
        for path in foreign:
            name = "/" + str(path.relative_to(sysroot))
            package = index.get(name) or index.get(re.sub("^/usr/lib/", "/lib/", name))
            if package:
                found[package] = debian_package(package, versions[package],
                                                sysroot / "usr" / "share")
            else:
                unknown.add(path)
    own = paths - foreign - cuda
    owners = packages_of_host(own)
    unknown |= own - set(owners)
    for package in sorted(set(owners.values())):
        version = output_of("dpkg-query", "-W", "-f=${Version}", package)
        found[package] = debian_package(package, version, pathlib.Path("/usr/share"))
    packages = [found[name] for name in sorted(found)]
    if cuda:
        packages.append({"name": "cuda-runtime",
                         "versionInfo": cuda_version(build), "supplier": "Organization: NVIDIA",
                         "licenseDeclared": "LicenseRef-NVIDIA-CUDA-EULA"})
    return packages, unknown


def cuda_version(build):
    """Of the toolkit that CMake found, whose runtime is used; empty without one."""
    for found in build.glob("CMakeFiles/*/CMakeCUDACompiler.cmake"):
        match = re.search(r'CMAKE_CUDA_COMPILER_TOOLKIT_VERSION "([0-9.]+)"', found.read_text())
        if match:
            return match.group(1)
    return ""


def source_date():
    """Of the newest entry in debian/changelog: the same source says the same, also without git."""
    text = (ROOT / "debian/changelog").read_text(encoding="utf-8")
    date = email.utils.parsedate_to_datetime(re.search(r"^ -- .*>  (.+)$", text, re.M).group(1))
    return date.astimezone(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def licences_of(build, packages):
    """What Debian says of the copyright of each library whose code is in the programs: those of C
    and C++ are linked by their exceptions, and stay outside."""
    outside = {"libc6", "linux-libc-dev", "libgcc", "libgcc-s1", "libstdc++", "libstdc++6"}
    share = pathlib.Path(cached(build, "CMAKE_SYSROOT") or "/") / "usr/share/doc"
    parts = []
    for package in packages:
        name = package["name"]
        base = re.sub(r"(-[0-9]+)?(-dev)?(-arm64-cross)?$", "", name)
        file = share / name / "copyright"
        if base not in outside and file.exists():
            parts.append(f"{'=' * 72}\n{name} {package['versionInfo']}\n{'=' * 72}\n" +
                         file.read_text(errors="replace"))
    return "\n".join(parts)


def document_of(build, packages):
    version = cached(build, "CMAKE_PROJECT_VERSION")
    own = {"name": "axguard", "versionInfo": version, "licenseDeclared": "Apache-2.0",
           "supplier": "NOASSERTION"}
    for package in [own, *packages]:
        package.update({"SPDXID": "SPDXRef-" + re.sub("[^A-Za-z0-9.]", "-", package["name"]),
                        "downloadLocation": "NOASSERTION", "licenseConcluded": "NOASSERTION",
                        "copyrightText": "NOASSERTION", "filesAnalyzed": False})
    content = json.dumps(packages, sort_keys=True).encode()
    document = {
        "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"axguard-{version}",
        "documentNamespace": "https://axguard.invalid/spdx/" +
                             hashlib.sha256(content).hexdigest(),
        "creationInfo": {"created": source_date(), "creators": ["Tool: make_sbom.py"]},
        "packages": [own, *packages],
        "relationships": [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                           "relatedSpdxElement": own["SPDXID"]}],
    }
    document["relationships"] += [
        {"spdxElementId": own["SPDXID"], "relationshipType": "DEPENDS_ON",
         "relatedSpdxElement": package["SPDXID"]} for package in packages]
    if any("LicenseRef" in package["licenseDeclared"] for package in packages):
        document["hasExtractedLicensingInfos"] = [{
            "licenseId": "LicenseRef-NVIDIA-CUDA-EULA",
            "extractedText": "https://docs.nvidia.com/cuda/eula/"}]
    return document


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("-o", "--out", type=pathlib.Path, required=True)
    given = options.parse_args()
    build = given.build.resolve()
    packages, unknown = dependencies(build)
    if unknown:
        sys.exit("make_sbom.py: no package owns these; install them from packages, or add what "
                 "they are:\n  " + "\n  ".join(sorted(map(str, unknown))[:20]))
    given.out.parent.mkdir(parents=True, exist_ok=True)
    fresh = given.out.with_suffix(".tmp")
    fresh.write_text(json.dumps(document_of(build, packages), indent=1) + "\n")
    fresh.rename(given.out)
    given.out.with_name("licences").write_text(licences_of(build, packages))
    unread = [p["name"] for p in packages if p["licenseDeclared"] == "NOASSERTION"]
    print(f"{given.out}: {len(packages)} packages" +
          (f"; licence not told by a program: {', '.join(unread)}" if unread else ""))


if __name__ == "__main__":
    main()
