#!/usr/bin/env bash
# Installs sections of scripts/packages.txt (Debian 12). Safe to run again: when all is there it only looks.
# Usage: scripts/install-dependencies.sh [--list] [build] [test] [bench]
# Without a section: build. --list prints the packages in place of installing them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

list=0
sections=()
for argument in "$@"; do
  case "$argument" in
    --list) list=1 ;;
    build | test | bench) sections+=("$argument") ;;
    *)
      echo "install-dependencies: there is no section '$argument' in packages.txt: give build, test or bench" >&2
      exit 2
      ;;
  esac
done
if ((${#sections[@]} == 0)); then sections=(build); fi

# packages_of <section>
packages_of() {
  sed 's/#.*//; s/[ \t]*$//' packages.txt | awk -v wanted="[$1]" '/^\[/ { inside = $0 == wanted; next } inside && NF { print $1 }'
}

packages=()
for section in "${sections[@]}"; do
  mapfile -t -O "${#packages[@]}" packages < <(packages_of "$section")
done
if ((list)); then
  printf '%s\n' "${packages[@]}"
  exit 0
fi

if ! command -v dpkg-query > /dev/null; then
  echo "install-dependencies: this is not Debian; install the counterparts of scripts/packages.txt by hand" >&2
  exit 1
fi

installed=$(dpkg-query -W -f '${binary:Package} ${db:Status-Status}\n' "${packages[@]}" 2> /dev/null |
  sed -n 's/^\([^ :]*\).* installed$/\1/p' || true)
missing=()
for package in "${packages[@]}"; do
  grep -qx -- "$package" <<< "$installed" || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "install-dependencies: all ${#packages[@]} packages are there (${sections[*]})"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo > /dev/null; then
    echo "install-dependencies: run as root, or install sudo; missing: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "install-dependencies: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
