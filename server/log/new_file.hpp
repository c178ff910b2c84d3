#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "server/log/disk.hpp"

namespace cycloid::server {

/// Makes a file of these bytes: whole and on the disk, or not there. Any thread.
/// @returns 0 or an errno value: EEXIST where the name is taken, and then that file is as it was.
[[nodiscard]] int write_new_file(Disk& disk, const std::string& path,
                                 std::span<const std::byte> bytes);

}  // namespace cycloid::server
