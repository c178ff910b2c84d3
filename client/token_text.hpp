#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace cycloid::client {

/// The bytes of a token that is written in base64url without padding, as `cycloid token` writes it;
/// nothing where the text is none, or empty, or longer than a hello carries.
std::optional<std::vector<std::byte>> token_from_text(std::string_view text);

}  // namespace cycloid::client
