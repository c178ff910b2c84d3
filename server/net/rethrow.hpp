#pragma once

#include <exception>

namespace cycloid::server {

/// Ends a coroutine: what it threw is no event of the network and leaves io_context::run, where
/// `detached` would swallow it.
inline constexpr auto rethrow = [](const std::exception_ptr& thrown) {
  if (thrown) std::rethrow_exception(thrown);
};

}  // namespace cycloid::server
