#include "embedded.hpp"

#include <cstddef>

// The files are read by the assembler, through a directive that g++ and clang both pass on to it: a
// megabyte of text as an array in C++ would take the compiler many seconds. WebAssembly's assembler
// needs a section for each file, and its length.
#ifdef __wasm__
#define SECTION(name) ".section .rodata." name ",\"\",@\n"
#define END_OF_SECTION ""
#else
#define SECTION(name) ".pushsection .rodata\n"
#define END_OF_SECTION ".popsection\n"
#endif
#define EMBED(name, path)                                                                          \
  __asm__(SECTION("goingrate_" #name)                                                              \
          ".globl goingrate_" #name "_begin\n.globl goingrate_" #name "_end\n"                     \
          "goingrate_" #name "_begin:\n.incbin \"" path "\"\n"                                     \
          ".size goingrate_" #name "_begin, .-goingrate_" #name "_begin\n"                         \
          "goingrate_" #name "_end:\n.byte 0\n"                                                    \
          ".size goingrate_" #name "_end, 1\n" END_OF_SECTION);                                    \
  extern "C" const char goingrate_##name##_begin[];                                                \
  extern "C" const char goingrate_##name##_end[]

EMBED(plotly, GOINGRATE_PLOTLY_SCRIPT);
EMBED(series, GOINGRATE_SERIES_SCRIPT);
EMBED(page, GOINGRATE_PAGE_SCRIPT);

namespace goingrate {

namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

} // namespace

std::string_view plotly_script() { return between(goingrate_plotly_begin, goingrate_plotly_end); }

std::string_view series_script() { return between(goingrate_series_begin, goingrate_series_end); }

std::string_view page_script() { return between(goingrate_page_begin, goingrate_page_end); }

} // namespace goingrate
