// Reads logs inside a ZIP, as exported by telephones.
#pragma once

#include "lines.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace goingrate {

/// Whether a regular file begins as a ZIP does.
bool is_zip(const std::string& path);

/// The files of a ZIP as "archive.zip/name", by name: those on the highest level that has any (a
/// telephone's `meta/` is left out), without hidden ones. Throws InputError if it is damaged, if an
/// entry's name leads out of it, if there are more than 100,000 entries, or if they unpack to more
/// than `unpacked_limit` bytes.
std::vector<std::string> files_in_zip(const std::string& path, std::uint64_t unpacked_limit);

/// The bytes of "archive.zip/name"; null if the path does not mean such a file, because it exists
/// itself or contains no ZIP. Throws InputError if the ZIP is damaged, or the entry is absent,
/// encrypted, or larger than it states or than `unpacked_limit` bytes; reading throws it too.
std::unique_ptr<ByteSource> open_in_zip(const std::string& path, std::uint64_t unpacked_limit);

} // namespace goingrate
