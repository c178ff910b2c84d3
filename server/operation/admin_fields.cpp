#include "server/operation/admin_fields.hpp"

namespace cycloid::server {
namespace {

constexpr std::size_t kTextBytesMax = 512;

}  // namespace

AdminFields::AdminFields(const std::string& body) {
  if (body.empty()) return;
  nlohmann::json parsed = nlohmann::json::parse(body, nullptr, /*allow_exceptions=*/false);
  if (parsed.is_discarded()) {
    complain("body: it is not JSON");
  } else if (!parsed.is_object()) {
    complain("body: it is not a JSON object");
  } else {
    // No field here is one, and what is kept is written into a line of the log: however deep it is
    // nested, nothing walks through it.
    for (auto& [name, value] : parsed.items()) {
      if (!value.is_structured()) {
        fields_[name] = std::move(value);
      } else {
        complain(name.substr(0, 64) + ": it is " + value.type_name());
      }
    }
  }
}

void AdminFields::complain(const std::string& mistake) {
  if (mistake_.empty()) mistake_ = mistake;
}

const nlohmann::json* AdminFields::find(const char* name, bool needed) {
  asked_.insert(name);
  const auto found = fields_.find(name);
  if (found != fields_.end()) return &*found;
  if (needed) complain(std::string(name) + ": it is missing");
  return nullptr;
}

std::string AdminFields::text_of(const char* name, const nlohmann::json& value) {
  if (!value.is_string()) {
    complain(std::string(name) + ": it is " + value.type_name() + ", and must be a string");
    return "";
  }
  std::string text = value.get<std::string>();
  if (text.size() > kTextBytesMax) {
    complain(std::string(name) + ": it has " + std::to_string(text.size()) + " bytes, of at most " +
             std::to_string(kTextBytesMax));
  }
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      complain(std::string(name) + ": it holds a control character");
    }
  }
  return text;
}

std::string AdminFields::text(const char* name) {
  const nlohmann::json* value = find(name, true);
  return value == nullptr ? "" : text_of(name, *value);
}

std::string AdminFields::text_or(const char* name, const char* otherwise) {
  const nlohmann::json* value = find(name, false);
  return value == nullptr ? otherwise : text_of(name, *value);
}

std::uint64_t AdminFields::number_of(const char* name, const nlohmann::json& value,
                                     std::uint64_t most) {
  if (value.is_number_unsigned() && value.get<std::uint64_t>() <= most) {
    return value.get<std::uint64_t>();
  }
  complain(std::string(name) + ": it is " + value.dump().substr(0, 40) +
           ", and must be a whole number from 0 to " + std::to_string(most));
  return 0;
}

std::uint64_t AdminFields::number(const char* name, std::uint64_t most) {
  const nlohmann::json* value = find(name, true);
  return value == nullptr ? 0 : number_of(name, *value, most);
}

std::uint64_t AdminFields::number_or(const char* name, std::uint64_t otherwise,
                                     std::uint64_t most) {
  const nlohmann::json* value = find(name, false);
  return value == nullptr ? otherwise : number_of(name, *value, most);
}

std::string AdminFields::mistake() {
  for (const auto& [name, value] : fields_.items()) {
    if (!asked_.contains(name)) complain(name.substr(0, 64) + ": there is no such field here");
  }
  return mistake_;
}

}  // namespace cycloid::server
