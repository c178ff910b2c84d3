#pragma once

#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "client/c/cycloid.h"
#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::client {

/// Notes why a call on this thread failed; `status` goes back to the caller. Needs no memory before
/// it is inside: what throws there is caught.
cycloid_status failed(cycloid_status status, std::string_view reason) noexcept;

/// CYCLOID_SCENE for what could not be loaded, with its first mistake. @pre there is one
cycloid_status no_scene(const std::string& name, const scenes::Loaded& loaded);

/// `text` with its final 0 as far as `capacity` allows; the bytes that it takes whole.
std::uint32_t copy_text(const std::string& text, char* into, std::uint32_t capacity) noexcept;

/// Runs a call of the interface: what it throws becomes a status and a reason.
template <class Call>
cycloid_status guarded(Call&& call) noexcept {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return failed(CYCLOID_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return failed(CYCLOID_FAILED, error.what());
  } catch (...) {
    return failed(CYCLOID_FAILED, "an unknown exception");
  }
}

/// Copies what both sides know of a struct that begins with its size. @pre both sizes >= 4
template <class Struct>
void copy_known(const Struct& from, Struct& into) {
  const std::uint32_t into_bytes = into.struct_bytes;
  const std::uint32_t bytes = from.struct_bytes < into_bytes ? from.struct_bytes : into_bytes;
  std::memcpy(static_cast<void*>(&into), &from, bytes);
  into.struct_bytes = into_bytes;
}

/// As many bytes or poses as there are; CYCLOID_BUFFER, and nothing written, where they do not fit.
cycloid_status copy_out(const std::vector<cycloid_pose>& all, cycloid_pose* into,
                        std::uint32_t capacity, std::uint32_t* count);
cycloid_status copy_out(const std::vector<std::byte>& all, std::uint8_t* into,
                        std::uint32_t capacity, std::uint32_t* count);

std::vector<cycloid_pose> to_c(const std::vector<scenes::Pose>& poses);
scenes::SeatInput from_c(const cycloid_input& input);

}  // namespace cycloid::client
