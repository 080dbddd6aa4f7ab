#!/bin/sh
# install_packages.sh tests|examples|bench|coverage
#
# Installs what is missing on Debian and Ubuntu, as root or with sudo; does nothing where nothing is missing. Elsewhere,
# or where it may not install, it says what to install and fails.
set -eu

# what=package: a command, a file below /usr or /usr/local, or the sanitizers of clang++.
examples="g++=g++ cmake=cmake ninja=ninja-build include/eigen3=libeigen3-dev include/boost/version.hpp=libboost-dev
          include/CLI/CLI.hpp=libcli11-dev gnuplot=gnuplot-nox include/png.h=libpng-dev
          include/OpenEXR=libopenexr-dev include/Random123=librandom123-dev include/embree3=libembree-dev
          include/assimp=libassimp-dev include/stb=libstb-dev
          share/blender/datafiles/studiolights/world=blender-data"
tests="$examples clang++=clang clang-sanitizers=libclang-rt-dev include/catch2=catch2
       include/benchmark/benchmark.h=libbenchmark-dev include/rapidcheck.h=librapidcheck-dev"
bench="$examples include/benchmark/benchmark.h=libbenchmark-dev include/gsl=libgsl-dev include/nlopt.h=libnlopt-dev"
coverage="$tests gcovr=gcovr"
case ${1-} in
  tests) wanted=$tests ;;
  coverage) wanted=$coverage ;;
  bench) wanted=$bench ;;
  examples) wanted=$examples ;;
  *) echo "usage: install_packages.sh tests|examples|bench|coverage" >&2; exit 2 ;;
esac

is_there() {
  case $1 in
    include/* | share/*) [ -e "/usr/$1" ] || [ -e "/usr/local/$1" ] ;;
    clang-sanitizers) echo 'int main() {}' | clang++ -fsanitize=address,undefined -x c++ - -o /dev/null 2>/dev/null ;;
    *) command -v "$1" >/dev/null ;;
  esac
}

missing=
for item in $wanted; do
  is_there "${item%%=*}" || missing="$missing ${item##*=}"
done

if [ -n "$missing" ]; then
  if ! command -v apt-get >/dev/null; then
    echo "phimis: no apt-get here; please install what these Debian packages hold:$missing" >&2
    exit 1
  elif [ "$(id -u)" -eq 0 ]; then
    as_root=
  elif command -v sudo >/dev/null; then
    as_root=sudo
  else
    echo "phimis: neither root nor sudo; please have these packages installed:$missing" >&2
    exit 1
  fi
  echo "phimis: installing$missing"
  apt="$as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300"
  $apt update </dev/null || echo "phimis: apt-get update failed; trying with the lists at hand" >&2
  # shellcheck disable=SC2086  # a list of packages
  if ! $apt install --no-install-recommends $missing </dev/null; then
    echo "phimis: these packages could not be installed:$missing" >&2
    exit 1
  fi
fi

# The presets are of version 6.
version=$(cmake --version | sed -n 's/^cmake version \([0-9]*\)\.\([0-9]*\).*/\1 \2/p')
# shellcheck disable=SC2086  # two numbers
set -- $version
if [ "$1" -lt 3 ] || { [ "$1" -eq 3 ] && [ "$2" -lt 25 ]; }; then
  echo "phimis: the presets need CMake 3.25 or newer; $(command -v cmake) is $1.$2" >&2
  exit 1
fi
