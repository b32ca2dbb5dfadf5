#include "source_head.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace goingrate::apps {

SourceHead::SourceHead(const std::string& folder, std::string source)
    : path_(folder + "/.head"), source_(std::move(source)) {
  std::ifstream file(path_);
  std::string of_source;
  if (std::getline(file, of_source) && of_source == source_)
    text_.assign(std::istreambuf_iterator<char>(file), {});
}

void SourceHead::keep(const std::string& text) {
  constexpr std::size_t most_bytes = 4096;
  if (text.empty() || text == text_ || text.size() > most_bytes) return;
  try {
    write_whole_file(path_, fmt::format("{}\n{}", source_, text));
    text_ = text;
  } catch (const OutputError&) { // only the names of columns would be missing after a start
  }
}

} // namespace goingrate::apps
