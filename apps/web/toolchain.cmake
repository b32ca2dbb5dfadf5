# CMake's toolchain file for Emscripten, with the compiler of this folder (see `compiler`) and the libraries that
# libraries.sh leaves in GOINGRATE_WEB_PREFIX.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(CMAKE_C_COMPILER ${CMAKE_CURRENT_LIST_DIR}/cc)
set(CMAKE_CXX_COMPILER ${CMAKE_CURRENT_LIST_DIR}/c++)
set(GOINGRATE_WEB_PREFIX $ENV{GOINGRATE_WEB_PREFIX} CACHE PATH "Libraries compiled to WebAssembly")
list(APPEND CMAKE_FIND_ROOT_PATH ${GOINGRATE_WEB_PREFIX})
