# shellcheck shell=bash disable=SC2034 # `phase` is read by ./dev
# What a build needs from the distribution. Sourced by ./dev.

packages=(
  g++ cmake ninja-build ccache git python3  # the tools
  libeigen3-dev libxxhash-dev               # solver: small matrices; hashing
  nlohmann-json3-dev libflatbuffers-dev     # scenes and protocol: JSON; binary forms
  flatbuffers-compiler
  libasio-dev libspdlog-dev libcli11-dev    # server and program: sockets; log lines; arguments
  libssl-dev libsodium-dev                  # TLS; signed tokens
  prometheus-cpp-dev libcivetweb-dev        # metrics; their HTTP server
  libtomlplusplus-dev                       # configuration files
  libgtest-dev libgmock-dev                 # tests
  librapidcheck-dev                         # tests of properties: random cases that shrink
  gnuplot-nox                               # figures of the experiments
)

is_installed() {
  [[ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]
}

as_root() {
  if [[ $(id -u) == 0 ]]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  else
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  fi
}

# setup [PACKAGE...]: installs what is missing of the list above and of the arguments.
setup() {
  phase="set up packages"
  local missing=() package removed
  for package in "${packages[@]}" "$@"; do
    if ! command -v dpkg-query >/dev/null || ! is_installed "$package"; then
      missing+=("$package")
    fi
  done
  if ((${#missing[@]} == 0)); then return; fi
  if ! command -v apt-get >/dev/null; then
    printf 'dev: not a Debian or Ubuntu; this may be missing: %s\n' "${missing[*]}" >&2
    return
  fi
  if [[ $(id -u) != 0 ]] && ! command -v sudo >/dev/null; then
    printf 'dev: packages are missing and there is no sudo; as root, type:\n  %s\n' \
      "apt-get update && apt-get install --no-install-recommends --no-remove ${missing[*]}" >&2
    return 1
  fi
  begin "install ${missing[*]}"
  # Package lists of a fresh machine are empty, and old ones name files that are gone. A source of
  # the user's own that does not answer is no reason to stop.
  as_root apt-get update -q || printf 'dev: going on with the package lists there are\n' >&2
  removed=$(apt-get -s install --no-install-recommends "${missing[@]}" | awk '/^Remv/ { print $2 }')
  if [[ -n "$removed" ]]; then
    printf 'dev: installing %s would remove: %s\n' "${missing[*]}" "$removed" >&2
    printf 'dev: nothing was changed; remove these yourself or use another machine.\n' >&2
    return 1
  fi
  # A machine that has just started may be installing updates of its own: wait for it.
  as_root apt-get -o DPkg::Lock::Timeout=300 install -y -q --no-install-recommends --no-remove \
    "${missing[@]}"
}
