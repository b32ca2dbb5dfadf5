#!/usr/bin/env bash
# libraries.sh FOLDER [headers]: compiles goingrate's libraries from Debian's sources to WebAssembly, into
# FOLDER/prefix: zlib, libzip, libsndfile, ERFA, FFTW, Ceres. Header-only libraries are linked there from
# /usr/include one by one, because its other headers are for another system. A library that is already there is
# not built again. The system's own list of package sources is not changed. With "headers" nothing is compiled.
set -euo pipefail
form=${2:-whole}
here=$(realpath "$(dirname "$0")")
mkdir -p "$1"
cd "$1"
folder=$PWD prefix=$PWD/prefix
mkdir -p "$prefix/include" "$prefix/lib" "$prefix/done"
export GOINGRATE_WEB_PREFIX=$prefix

fetch_sources() { # PACKAGE ...
  local package release missing=
  for package in "$@"; do
    [ -d "sources/$package" ] || missing=$package
  done
  [ ! -e sources/done ] || [ -n "$missing" ] || return 0
  rm -rf sources
  mkdir -p sources/lists/partial
  release=$(. /etc/os-release && echo "$VERSION_CODENAME")
  echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian $release main" \
    > sources/sources.list
  local apt=(apt-get -qq -o "Dir::Etc::SourceList=$PWD/sources/sources.list" -o Dir::Etc::SourceParts=-
    -o "Dir::State::Lists=$PWD/sources/lists" -o APT::Sandbox::User=root)
  "${apt[@]}" update > /dev/null
  (cd sources && "${apt[@]}" source --download-only "$@" > /dev/null)
  for package in "$@"; do
    dpkg-source --no-check -x sources/"${package}"_*.dsc "sources/$package" > /dev/null
  done
  touch sources/done
}

# once NAME COMMAND ...: runs it unless it has succeeded before; its output is shown if it fails.
once() {
  local name=$1 stamp=$prefix/done/$1.$form
  shift
  [ ! -e "$stamp" ] && [ ! -e "${stamp%.*}.whole" ] || return 0
  echo "  $name" >&2
  "$@" > "$folder/$name.log" 2>&1 & # in the background: inside a condition, bash would not stop at a failure
  wait $! || { tail -n 30 "$folder/$name.log" >&2; return 1; }
  touch "$stamp"
}

# Sizes in bytes on 32-bit WebAssembly; stating them is less work than running a program to find them.
sizes=()
for size in OFF_T=8 SIZE_T=4 SSIZE_T=4 PTRDIFF_T=4 WCHAR_T=4 INT=4 LONG=4 LONG_LONG=8 INT64_T=8 UNSIGNED_INT=4 \
  UNSIGNED_LONG=4 UNSIGNED_LONG_LONG=8 FLOAT=4 DOUBLE=8; do
  sizes+=("-DSIZEOF_$size" "-DHAVE_SIZEOF_${size%=*}=ON")
done

# Checks for headers and functions only compile, because linking takes Emscripten a second. They therefore find
# functions that do not exist here; the options have to name these.
by_cmake() { # PACKAGE OPTION ...
  local package=$1
  shift
  cmake -G Ninja -S "sources/$package" -B "$package" -DCMAKE_TOOLCHAIN_FILE="$here/toolchain.cmake" \
    -DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE="-O2 -DNDEBUG" -DCMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG" \
    -DCMAKE_INSTALL_PREFIX="$prefix" -DBUILD_SHARED_LIBS=OFF -Wno-dev "${sizes[@]}" "$@"
  [ "$form" = headers ] || cmake --build "$package" -j "$(nproc)"
}

# Keeps a library that was compiled; does nothing with "headers".
keep() { # LIBRARY
  [ "$form" = headers ] || cp "$1" "$prefix/lib"
}

zlib() {
  cp sources/zlib/zlib.h sources/zlib/zconf.h "$prefix/include"
  [ "$form" = whole ] || return 0
  mkdir -p zlib
  local source
  for source in sources/zlib/*.c; do
    "$here/cc" -O2 -DHAVE_UNISTD_H -c "$source" -o "zlib/$(basename "$source" .c).o"
  done
  emar rcs "$prefix/lib/libz.a" zlib/*.o
}

libzip() {
  local missing=() name
  for name in _CLOSE _DUP _FDOPEN _FILENO _SETMODE _SNPRINTF _STRDUP _STRICMP _STRTOI64 _STRTOUI64 _UNLINK \
    ARC4RANDOM CLONEFILE EXPLICIT_MEMSET GETPROGNAME SETMODE STRICMP; do
    missing+=("-DHAVE_$name=OFF")
  done
  by_cmake libzip "${missing[@]}" -DENABLE_COMMONCRYPTO=OFF -DENABLE_GNUTLS=OFF -DENABLE_MBEDTLS=OFF \
    -DENABLE_OPENSSL=OFF -DENABLE_WINDOWS_CRYPTO=OFF -DENABLE_BZIP2=OFF -DENABLE_LZMA=OFF -DENABLE_ZSTD=OFF \
    -DBUILD_TOOLS=OFF -DBUILD_REGRESS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_DOC=OFF \
    -DZLIB_INCLUDE_DIR="$prefix/include" -DZLIB_LIBRARY="$prefix/lib/libz.a"
  keep libzip/lib/libzip.a
  cp sources/libzip/lib/zip.h libzip/zipconf.h "$prefix/include"
}

# Without FLAC, Ogg Vorbis, Opus and MPEG, which need further libraries.
libsndfile() {
  by_cmake libsndfile -DHAVE_LSEEK64=OFF -DHAVE_IMMINTRIN_H=OFF -DCPU_CLIPS_POSITIVE=OFF -DCPU_CLIPS_NEGATIVE=OFF \
    -DENABLE_EXTERNAL_LIBS=OFF -DENABLE_MPEG=OFF -DBUILD_PROGRAMS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_TESTING=OFF \
    -DENABLE_CPACK=OFF -DENABLE_PACKAGE_CONFIG=OFF -DINSTALL_PKGCONFIG_MODULE=OFF
  keep libsndfile/libsndfile.a
  cp sources/libsndfile/include/sndfile.h "$prefix/include"
}

# ERFA's sources need no configuring except for a version number, which goingrate does not use.
erfa() {
  cp sources/erfa/src/*.h "$prefix/include"
  [ "$form" = whole ] || return 0
  mkdir -p erfa
  local source
  for source in sources/erfa/src/*.c; do
    case $source in */t_erfa_c.c | */t_erfa_c_extra.c | */erfaversion.c) continue ;; esac
    "$here/cc" -O2 -c "$source" -o "erfa/$(basename "$source" .c).o"
  done
  emar rcs "$prefix/lib/liberfa.a" erfa/*.o
}

fftw() {
  by_cmake fftw3 -DHAVE_MACH_ABSOLUTE_TIME=OFF -DHAVE_SYSCTL=OFF -DBUILD_TESTS=OFF
  keep fftw3/libfftw3.a
  basename sources/fftw3_*.dsc | sed 's/^fftw3_//; s/-.*//' > "$prefix/lib/fftw3.version"
  cp sources/fftw3/api/fftw3.h "$prefix/include"
}

# goingrate uses only its dense QR solver and Jet.
ceres() {
  by_cmake ceres-solver -DMINIGLOG=ON -DGFLAGS=OFF -DSUITESPARSE=OFF -DCXSPARSE=OFF -DLAPACK=OFF -DCUDA=OFF \
    -DEIGENSPARSE=OFF -DSCHUR_SPECIALIZATIONS=OFF -DCERES_THREADING_MODEL=NO_THREADS -DBUILD_TESTING=OFF \
    -DBUILD_EXAMPLES=OFF -DBUILD_BENCHMARKS=OFF -DPROVIDE_UNINSTALL_TARGET=OFF -DEigen3_DIR=/usr/share/eigen3/cmake
  local public=$prefix/include/ceres
  mkdir -p "$public/internal"
  cp -r sources/ceres-solver/include/ceres/. "$public"
  cp -r ceres-solver/include/ceres/. "$public" # how it is configured
  cp -r sources/ceres-solver/internal/ceres/miniglog "$public/internal"
  keep ceres-solver/lib/libceres.a
}

headers() {
  local name
  for name in boost fmt fast_float toml++ nlohmann CLI; do
    ln -sfn "/usr/include/$name" "$prefix/include/$name"
  done
}

fetch_sources zlib libzip libsndfile erfa fftw3 ceres-solver
once headers headers
once zlib zlib
once libzip libzip
once libsndfile libsndfile
once erfa erfa
once fftw fftw
once ceres ceres
