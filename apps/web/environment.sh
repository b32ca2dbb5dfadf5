# environment.sh: to be sourced; sets what the compiler of this folder needs (see `compiler`).
# Emscripten's linker needs acorn, which Debian installs where only Debian's own node looks for it.
export NODE_PATH=/usr/share/nodejs${NODE_PATH:+:$NODE_PATH}
# The clang that Emscripten would call, and its flags; ccache, if installed, saves compiling a second time.
GOINGRATE_WEB_FLAGS=$(em++ -fexceptions --cflags)
GOINGRATE_WEB_CLANG=$(em-config LLVM_ROOT)/clang GOINGRATE_WEB_VERSION=-$(em-config CLANG_ADD_VERSION)
GOINGRATE_WEB_LAUNCHER=$(command -v ccache || true)
export GOINGRATE_WEB_FLAGS GOINGRATE_WEB_CLANG GOINGRATE_WEB_VERSION GOINGRATE_WEB_LAUNCHER
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
unset CMAKE_C_COMPILER_LAUNCHER CMAKE_CXX_COMPILER_LAUNCHER
