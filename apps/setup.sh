#!/usr/bin/env bash
# goingrate_setup [EXTRA PACKAGE ...]: installs what goingrate is built with, on Debian and its kin;
# elsewhere says what is needed. Meant to be sourced. Silent if everything is there.
goingrate_setup() {
  local packages=(g++ cmake ninja-build pkg-config libboost-dev libeigen3-dev libceres-dev libfftw3-dev
    libfmt-dev libfast-float-dev libtomlplusplus-dev nlohmann-json3-dev libcli11-dev zlib1g-dev libzip-dev libsndfile1-dev liberfa-dev
    libcpp-httplib-dev libsqlite3-dev "$@")
  # The report's page draws with plotly.js, which npm fetches; npm may have come without a package.
  command -v npm > /dev/null || packages+=(nodejs npm)
  if ! command -v dpkg-query > /dev/null || ! command -v apt-get > /dev/null; then
    echo "This is no Debian system. goingrate needs (Debian's names): ${packages[*]}" >&2
    echo "Going on; CMake will say what it does not find." >&2
    return 0
  fi
  local missing=() package
  for package in "${packages[@]}"; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2> /dev/null | grep -qx installed \
      || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "Installing Debian packages (a few minutes): ${missing[*]}" >&2
  local as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  "${as_root[@]}" apt-get update -qq > /dev/null \
    && "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null && return 0
  echo "The packages could not be installed; going on in case CMake finds what it needs." >&2
}
