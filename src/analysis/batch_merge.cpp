#include "batch_file.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <deque>
#include <fmt/format.h>

namespace goingrate {

namespace {

// The shares in order, each once.
std::vector<BatchFile*> in_order(std::deque<BatchFile>& files) {
  const BatchHeader& first = files.front().header();
  std::vector<BatchFile*> shares(first.share.n, nullptr);
  for (BatchFile& file : files) {
    expect_same(file.header(), file.path(), first);
    BatchFile*& place = shares[file.header().share.k - 1];
    if (place != nullptr)
      throw InputError({file.path(), 1, 1}, fmt::format("share {} again", file.header().share.k),
                       "each share once; it is in " + place->path() + " too");
    place = &file;
  }
  std::vector<std::size_t> missing;
  for (std::size_t k = 0; k < shares.size(); ++k)
    if (shares[k] == nullptr) missing.push_back(k + 1);
  if (!missing.empty())
    throw InputError({files.front().path()},
                     fmt::format("{} of {} shares", files.size(), shares.size()),
                     fmt::format("all; missing: {}", fmt::join(missing, ", ")));
  return shares;
}

} // namespace

void merge_batch(std::span<const std::string> shares, const std::string& output) {
  if (shares.empty()) throw ArgumentError("shares", "none", "at least one file");
  std::deque<BatchFile> files;
  for (const std::string& share : shares)
    files.emplace_back(share);
  const auto ordered = in_order(files);
  Json header = files.front().header().json;
  header["share"] = header["of"] = 1;
  StreamedFile merged(output);
  merged.text() = header.dump() + '\n';
  const std::size_t jobs = files.front().header().jobs;
  for (std::size_t job = 0; job < jobs; ++job) {
    merged.text() += ordered[job % ordered.size()]->line_of(job);
    merged.text() += '\n';
    merged.flush_if_large();
  }
  for (BatchFile* file : ordered)
    file->expect_end();
  commit_all({&merged});
}

} // namespace goingrate
