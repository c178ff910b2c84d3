#pragma once

#include <cstddef>

namespace cycloid::solver {

/// Asks memory for a record that is read soon, and goes on without it. No bit depends on it, only
/// time: worlds that are stepped in turn find little of themselves in a core's own caches.
template <class Record>
void fetch_ahead(const Record& record) {
  constexpr std::size_t kLine = 64;  // Where lines are longer, some are asked for twice.
  const char* bytes = static_cast<const char*>(static_cast<const void*>(&record));
  for (std::size_t at = 0; at < sizeof(Record); at += kLine) __builtin_prefetch(bytes + at);
  __builtin_prefetch(bytes + sizeof(Record) - 1);  // A record begins anywhere in a line.
}

}  // namespace cycloid::solver
