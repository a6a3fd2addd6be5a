#!/usr/bin/env python3
"""Does scripts/packages.txt hold what the build uses?

Takes every system header that the compiler opened (ninja -t deps) and every shared library that the programs name
(readelf, NEEDED), finds the Debian packages that own them (dpkg-query -S), and fails for each package that is neither in
the list, nor a dependency of one in it, nor part of the C and C++ toolchain. What the programs use must be in the section
[build] alone, which is all that the demo installs. Works offline; exit 77 where there is no dpkg.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PROGRAMS = ["pelage", "pelage-bake"]
TOOLCHAIN = ["g++", "gcc", "libc6-dev", "libstdc++6", "libgcc-s1", "libc6"]


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def included_headers(build):
    """System headers in ninja's dependency log: those of the programs, and those of tests and benches."""
    of_programs, of_tests = set(), set()
    for line in output_of("ninja", "-C", str(build), "-t", "deps").splitlines():
        path = line.strip()
        if line and not line.startswith(" "):
            headers = of_tests if line.startswith("tests/") else of_programs
        elif path.startswith("/usr/"):
            headers.add(os.path.normpath(path))
    return of_programs, of_tests


def linked_libraries(build):
    """Files of the shared libraries that a program names itself (not what these name in turn)."""
    libraries = set()
    for name in PROGRAMS:
        for program in [p for p in Path(build).rglob(name) if p.is_file() and os.access(p, os.X_OK)]:
            resolved = dict(re.findall(r"(\S+) => (/\S+)", output_of("ldd", str(program))))
            needed = re.findall(r"\(NEEDED\).*\[(.+)\]", output_of("readelf", "-d", str(program)))
            libraries.update(resolved[library] for library in needed if library in resolved)
    return libraries


def spellings(path):
    """A file's names: as given, resolved, and with /lib for /usr/lib, which dpkg may have recorded."""
    for name in (path, os.path.realpath(path)):
        yield name
        if name.startswith("/usr/lib"):
            yield name[len("/usr"):]
        elif name.startswith("/lib"):
            yield "/usr" + name


def owners(paths):
    """Package that owns each path, or None."""
    names = {spelling: path for path in paths for spelling in spellings(path)}
    answer = subprocess.run(["xargs", "-0", "dpkg-query", "-S"], input="\0".join(sorted(names)), capture_output=True, text=True)
    owner = dict.fromkeys(paths)
    for line in answer.stdout.splitlines():
        if line.startswith("diversion "):
            continue
        packages, _, path = line.partition(": ")
        if path in names:
            owner[names[path]] = packages.split(",")[0].split(":")[0]
    return owner


def dependency_table():
    """Package -> packages it depends on, and virtual name -> providers, of all that is installed."""
    depends, provides = {}, {}
    fields = "${Package}\t${Depends}, ${Pre-Depends}\t${Provides}\n"
    for line in output_of("dpkg-query", "-W", "-f", fields).splitlines():
        package, needs, offers = line.split("\t")
        strip = lambda text: {re.sub(r"[ (:\[].*", "", part.strip()) for part in re.split(r"[,|]", text)} - {""}
        depends.setdefault(package, set()).update(strip(needs))
        for name in strip(offers):
            provides.setdefault(name, set()).add(package)
    return depends, provides


def closure(packages):
    depends, provides = dependency_table()
    seen, waiting = set(), list(packages)
    while waiting:
        package = waiting.pop()
        if package in seen:
            continue
        seen.add(package)
        waiting.extend(depends.get(package, ()))
        waiting.extend(provides.get(package, ()))
    return seen


def report_missing(paths, listed, sections):
    """Prints the packages that own these paths and that these sections lack. Returns how many."""
    allowed = closure(listed + TOOLCHAIN)
    missing = {}
    for path, package in owners(paths).items():
        if package not in allowed:
            missing.setdefault(package or "no package", []).append(path)
    for package, of_it in sorted(missing.items()):
        print(f"{package}: {sorted(of_it)[0]} and {len(of_it) - 1} more: add it to scripts/packages.txt, [{sections[-1]}]")
    print(f"{', '.join(sections)}: {len(paths)} files, {len(listed)} packages listed, {len(missing)} missing")
    return len(missing)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True)
    parser.add_argument("--source", required=True)
    parser.add_argument("--without", nargs="*", default=[], help="leave these out of the list, to test this test")
    options = parser.parse_args()
    if not shutil.which("dpkg-query"):
        print("no dpkg here: skipped")
        return 77

    of_programs, of_tests = included_headers(options.build)
    libraries = linked_libraries(options.build)
    if len(of_programs) < 100:
        print(f"only {len(of_programs)} system headers found: is {options.build} built?")
        return 1
    missing = 0
    for sections, paths in ((["build"], of_programs | libraries), (["build", "test", "bench"], of_tests)):
        listed = output_of("bash", f"{options.source}/scripts/install-dependencies.sh", "--list", *sections).split()
        missing += report_missing(paths, [p for p in listed if p not in options.without], sections)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
