#include "memory.hpp"

#include <algorithm>
#include <sanitizer/allocator_interface.h>

namespace {

std::size_t now = 0, peak = 0;

void allocated(const volatile void*, std::size_t size) {
  now += size;
  peak = std::max(peak, now);
}

void freed(const volatile void* block) {
  if (block == nullptr) return;
  now -= std::min(now, __sanitizer_get_allocated_size(const_cast<const void*>(block)));
}

const int installed = __sanitizer_install_malloc_and_free_hooks(allocated, freed);

} // namespace

namespace goingrate::fuzz {
std::size_t peak_bytes() { return installed == 0 ? 0 : peak; }
void reset_peak() { peak = now; }
} // namespace goingrate::fuzz
